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
    const char *loaded = saturne_text("loaded", "");
    saturne_mesh_begin();
    report.span = saturne_number("span", &metre);
    if (*loaded != '\0') {
        report.n_loaded = saturne_faces("loaded", loaded, &report.loaded);
        return;
    }
    const saturne_body *first = saturne_body_at(0);
    report.n_loaded = first->n_faces;
    BFT_MALLOC(report.loaded, first->n_faces, cs_lnum_t);
    memcpy(report.loaded, first->faces, (size_t)first->n_faces * sizeof *first->faces);
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

/* Displacement and velocity of the last node, and the force on the member by the slab's span. Collective. */
static void watch(const saturne_body *body, double row[9]) {
    double *q, *rate;
    int64_t n;
    saturne_check(spar_member_get_count(body->member, &n));
    BFT_MALLOC(q, 7 * n, double);
    BFT_MALLOC(rate, 6 * n, double);
    saturne_check(spar_member_get_motion(body->member, q, rate, NULL));
    memcpy(row, q + 7 * (n - 1), 3 * sizeof(double));
    memcpy(row + 3, rate + 6 * (n - 1), 3 * sizeof(double));
    row[6] = row[7] = row[8] = 0;
    for (cs_lnum_t i = 0; i < 3 * body->n_faces; i++) {
        row[6 + i % 3] += body->force[i] / report.span;
    }
    cs_parall_sum(3, CS_DOUBLE, row + 6);
    BFT_FREE(q);
    BFT_FREE(rate);
}

static void open_history(double t) {
    static const char *const columns[9] = {"ux_m",   "uy_m",   "uz_m",   "vx_m_s", "vy_m_s",
                                           "vz_m_s", "fx_N_m", "fy_N_m", "fz_N_m"};
    const int n = saturne_body_count();
    size_t used, size = 200;
    char *all;
    for (int b = 1; b < n; b++) {
        size += 9 * (strlen(saturne_body_at(b)->name) + 10);
    }
    BFT_MALLOC(all, size, char);
    used = (size_t)snprintf(all, size,
                            "time_s,ux_m,uy_m,uz_m,vx_m_s,vy_m_s,vz_m_s,fx_N_m,fy_N_m,fz_N_m,iterations,"
                            "added_mass,least_cell_m3");
    for (int i = 9; i < 9 * n; i++) {
        used += (size_t)snprintf(all + used, size - used, ",%s.%s", columns[i % 9], saturne_body_at(i / 9)->name);
    }
    report.history = saturne_open_history(t, all);
    BFT_FREE(all);
}

static void write_columns(const double row[9]) {
    for (int c = 0; c < 9; c++) {
        fprintf(report.history, c < 3 ? ",%.12e" : ",%.9e", row[c]);
    }
}

void saturne_report_step(void) {
    const int n = saturne_body_count();
    double t, *row, out = 0, entry[SPAR_REPORT_COUNT];
    int iterations;
    BFT_MALLOC(row, 9 * n, double);
    for (int b = 0; b < n; b++) {
        watch(saturne_body_at(b), row + 9 * b);
        keep_errors(saturne_body_at(b)->surface);
        out = CS_MAX(out, cs_math_3_norm(row + 9 * b));
    }
    total_force(row + 6);
    saturne_check(spar_session_get_time(saturne_session(), &t, NULL, &iterations));
    saturne_check(spar_session_get_report(saturne_session(), SPAR_REPORT_COUNT, entry));
    saturne_mesh_step(out);
    report.steps++;
    report.iterations += iterations;
    report.most = CS_MAX(report.most, iterations);
    if (cs_glob_rank_id < 1) {
        if (report.history == NULL) {
            open_history(t);
        }
        fprintf(report.history, "%.9g", t);
        write_columns(row);
        fprintf(report.history, ",%d,%.3g,%.6e", iterations, entry[SPAR_REPORT_ADDED_MASS],
                cs_glob_mesh_quantities->min_vol);
        for (int b = 1; b < n; b++) {
            write_columns(row + 9 * b);
        }
        fprintf(report.history, "\n");
        fflush(report.history);
    }
    BFT_FREE(row);
}

void saturne_report_run(void) {
    double seconds[2];
    saturne_clock_read(seconds);
    double volume;
    const double corner = saturne_mesh_end(&volume);
    BFT_FREE(report.loaded);
    if (cs_glob_rank_id > 0 || report.steps == 0) {
        return;
    }
    FILE *f = fopen("summary.txt", "w");
    if (f == NULL) {
        bft_error(__FILE__, __LINE__, 0, "spar: summary.txt cannot be written here");
    }
    fprintf(f, "steps %ld\niterations_mean %.3f\niterations_most %d\n", report.steps,
            (double)report.iterations / (double)report.steps, report.most);
    fprintf(f, "force_error %.1e\nmoment_error %.1e\npower_error %.1e\n", report.errors[0], report.errors[1],
            report.errors[2]);
    fprintf(f, "seconds %.3f\nspar_seconds %.3f\nspar_share %.5f\n", seconds[1], seconds[0], seconds[0] / seconds[1]);
    fprintf(f, "least_corner %.4f\nleast_volume %.4f\n", corner, volume);
    fclose(f);
    if (report.history != NULL) {
        fclose(report.history);
    }
}
