/* history.csv by step, summary.txt at the end: motion, forces, iterations, and spar's share of the processor time. */
#include "cs_base.h"
#include "cs_headers.h"
#include "cs_prototypes.h"
#include "spar_saturne.h"
#include <stdio.h>
#include <string.h>

static struct {
    FILE *history;
    double errors[3]; /* most so far: force, moment, power */
    long steps, iterations;
    int most;
    cs_lnum_t n_loaded, *loaded; /* faces whose force the history has */
    double span;                 /* m, that force is divided by */
} report;

void saturne_report_begin(void) {
    const double metre = 1;
    saturne_mesh_begin();
    report.span = saturne_number("span", &metre);
    report.n_loaded = saturne_faces(saturne_text("loaded", saturne_text("wetted", NULL)), &report.loaded);
}

/* The whole force on the loaded faces, by the slab's span. */
static void total_force(double total[3]) {
    double *force;
    BFT_MALLOC(force, 3 * report.n_loaded, double);
    saturne_wall_forces(report.n_loaded, report.loaded, force);
    total[0] = total[1] = total[2] = 0;
    for (cs_lnum_t i = 0; i < 3 * report.n_loaded; i++) {
        total[i % 3] += force[i] / report.span;
    }
    BFT_FREE(force);
    cs_parall_sum(3, CS_DOUBLE, total);
}

static void keep_errors(const spar_fluid *surface) {
    double audit[SPAR_AUDIT_COUNT];
    saturne_check(spar_fluid_get_audit(surface, SPAR_AUDIT_COUNT, audit));
    cs_parall_max(3, CS_DOUBLE, audit + SPAR_AUDIT_FORCE_ERROR);
    for (int i = 0; i < 3; i++) {
        report.errors[i] = CS_MAX(report.errors[i], audit[SPAR_AUDIT_FORCE_ERROR + i]);
    }
}

/* Displacement and velocity of the last node. */
static void watch(const spar_member *wet, double u[3], double v[3]) {
    double *q, *rate;
    int64_t n;
    saturne_check(spar_member_get_count(wet, &n));
    BFT_MALLOC(q, 7 * n, double);
    BFT_MALLOC(rate, 6 * n, double);
    saturne_check(spar_member_get_motion(wet, q, rate, NULL));
    memcpy(u, q + 7 * (n - 1), 3 * sizeof(double));
    memcpy(v, rate + 6 * (n - 1), 3 * sizeof(double));
    BFT_FREE(q);
    BFT_FREE(rate);
}

void saturne_report_step(spar_member *wet, spar_fluid *surface) {
    double t, u[3], v[3], force[3], entry[SPAR_REPORT_COUNT];
    int iterations;
    total_force(force);
    keep_errors(surface);
    watch(wet, u, v);
    saturne_check(spar_session_get_time(saturne_session(), &t, NULL, &iterations));
    saturne_check(spar_session_get_report(saturne_session(), SPAR_REPORT_COUNT, entry));
    saturne_mesh_step(cs_math_3_norm(u));
    report.steps++;
    report.iterations += iterations;
    report.most = CS_MAX(report.most, iterations);
    if (cs_glob_rank_id > 0) {
        return;
    }
    if (report.history == NULL) {
        report.history = fopen("history.csv", "w");
        if (report.history == NULL) {
            bft_error(__FILE__, __LINE__, 0, "history.csv cannot be written here");
        }
        fprintf(report.history, "time_s,ux_m,uy_m,uz_m,vx_m_s,vy_m_s,vz_m_s,fx_N_m,fy_N_m,fz_N_m,iterations,"
                                "added_mass,least_cell_m3\n");
    }
    fprintf(report.history, "%.9g,%.12e,%.12e,%.12e,%.9e,%.9e,%.9e,%.9e,%.9e,%.9e,%d,%.3g,%.6e\n", t, u[0], u[1], u[2],
            v[0], v[1], v[2], force[0], force[1], force[2], iterations, entry[SPAR_REPORT_ADDED_MASS],
            cs_glob_mesh_quantities->min_vol);
    fflush(report.history);
}

void saturne_report_run(void) {
    double seconds[2];
    saturne_clock_read(seconds);
    const double corner = saturne_mesh_end();
    BFT_FREE(report.loaded);
    if (cs_glob_rank_id > 0 || report.steps == 0) {
        return;
    }
    FILE *f = fopen("summary.txt", "w");
    if (f == NULL) {
        bft_error(__FILE__, __LINE__, 0, "summary.txt cannot be written here");
    }
    fprintf(f, "steps %ld\niterations_mean %.3f\niterations_most %d\n", report.steps,
            (double)report.iterations / (double)report.steps, report.most);
    fprintf(f, "force_error %.1e\nmoment_error %.1e\npower_error %.1e\n", report.errors[0], report.errors[1],
            report.errors[2]);
    fprintf(f, "seconds %.3f\nspar_seconds %.3f\nspar_share %.5f\n", seconds[1], seconds[0], seconds[0] / seconds[1]);
    fprintf(f, "least_corner %.4f\n", corner);
    fclose(f);
    if (report.history != NULL) {
        fclose(report.history);
    }
}
