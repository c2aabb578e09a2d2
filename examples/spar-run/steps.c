/* The run: steps under the loads of the case file or in the wind of its blade elements. */
#if !defined(_XOPEN_SOURCE) && !defined(_POSIX_C_SOURCE)
#define _POSIX_C_SOURCE 200809L
#endif
#include "run.h"

#include <math.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

static double now(void) {
    struct timespec t;
    (void)clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* A line on stderr once the run takes longer than two seconds: in place on a terminal, else now and then. */
static void show_progress(const run *r, double t, double begun, double *shown) {
    int terminal = isatty(STDERR_FILENO);
    double wall = now() - begun, part = t / r->duration;
    if (r->quiet || wall < 2 || wall - *shown < (terminal ? 0.2 : 10)) {
        return;
    }
    *shown = wall;
    (void)fprintf(stderr, "%sspar-run: %3.0f %%  t = %.3f s  %.0f s to go%s", terminal ? "\r" : "", 100 * part, t,
                  wall / part - wall, terminal ? "   " : "\n");
    (void)fflush(stderr);
}

/* ---- history ---- */

/* A wing has none, and no figures of a rotor; to be asked after its loads were solved once. */
static int has_shaft(const spar_aero *aero) {
    double thrust, torque, power;
    return spar_aero_get_rotor(aero, &thrust, &torque, &power) == SPAR_OK;
}

static void write_heading(const run *r, FILE *file) {
    (void)fprintf(file, "t_s,iterations");
    for (int64_t i = 0; i < spar_case_member_count(r->scene); i++) {
        const char *name = spar_member_get_name(spar_case_member_at(r->scene, i));
        (void)fprintf(file, ",%s_ux_m,%s_uy_m,%s_uz_m,%s_Fx_N,%s_Fy_N,%s_Fz_N,%s_Mx_Nm,%s_My_Nm,%s_Mz_Nm", name, name,
                      name, name, name, name, name, name, name);
    }
    for (int64_t i = 0; i < spar_case_aero_count(r->scene); i++) {
        const char *name = "";
        if (!has_shaft(spar_case_aero_at(r->scene, i, &name))) {
            continue;
        }
        (void)fprintf(file, ",%s_thrust_N,%s_torque_Nm,%s_power_W", name, name, name);
    }
    (void)fprintf(file, "\n");
}

/* x turned back by the unit quaternion q. */
static void turn_back(const double q[4], double x[3]) {
    const double *a = q + 1;
    double t[3];
    for (int i = 0; i < 3; i++) { /* 2 x cross a */
        int j = (i + 1) % 3, k = (i + 2) % 3;
        t[i] = 2 * (x[j] * a[k] - x[k] * a[j]);
    }
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        x[i] += q[0] * t[i] + t[j] * a[k] - t[k] * a[j];
    }
}

/* Displacement of the last node: global; of a driven root's member as seen from the root, in the axes of t = 0. */
static int find_displacement(const spar_member *member, int64_t nodes, double *q, double *x, double u[3]) {
    int root = 0;
    const double *last = q + 7 * (nodes - 1), *end = x + 3 * (nodes - 1);
    RUN_TRY(spar_member_get_root(member, &root));
    RUN_TRY(spar_member_get_motion(member, q, NULL, NULL));
    RUN_TRY(spar_member_get_reference(member, x, NULL));
    for (int k = 0; k < 3; k++) {
        u[k] = root == SPAR_ROOT_DRIVEN ? end[k] + last[k] - x[k] - q[k] : last[k];
    }
    if (root == SPAR_ROOT_DRIVEN) {
        turn_back(q + 3, u);
    }
    for (int k = 0; root == SPAR_ROOT_DRIVEN && k < 3; k++) {
        u[k] -= end[k] - x[k];
    }
    return SPAR_OK;
}

/* The last node's displacement, and the reaction at the root. q: room for 10 doubles a node */
static int write_member(FILE *file, const spar_member *member, double *q) {
    int64_t nodes;
    double load[6] = {0}, u[3];
    RUN_TRY(spar_member_get_count(member, &nodes));
    RUN_TRY(find_displacement(member, nodes, q, q + 7 * nodes, u));
    RUN_TRY(spar_member_get_reaction(member, load));
    for (int k = 0; k < 3; k++) {
        (void)fprintf(file, ",%.15g", u[k]);
    }
    for (int k = 0; k < 6; k++) {
        (void)fprintf(file, ",%.15g", load[k]);
    }
    return SPAR_OK;
}

static int write_row(const run *r, FILE *file, double t, int iterations, double *q) {
    (void)fprintf(file, "%.15g,%d", t, iterations);
    for (int64_t i = 0; i < spar_case_member_count(r->scene); i++) {
        RUN_TRY(write_member(file, spar_case_member_at(r->scene, i), q));
    }
    for (int64_t i = 0; i < spar_case_aero_count(r->scene); i++) {
        const spar_aero *aero = spar_case_aero_at(r->scene, i, NULL);
        double thrust, torque, power;
        if (!has_shaft(aero)) {
            continue;
        }
        RUN_TRY(spar_aero_get_rotor(aero, &thrust, &torque, &power));
        (void)fprintf(file, ",%.15g,%.15g,%.15g", thrust, torque, power);
    }
    (void)fprintf(file, "\n");
    return SPAR_OK;
}

/* ---- steps ---- */

static int make_steps(run *r, FILE *file, double *q) {
    int64_t steps = (int64_t)ceil(r->duration / r->dt - 1e-9), step = 0;
    double begun = now(), shown = 0, t = 0;
    RUN_TRY(spar_session_get_time(r->session, &t, &step, NULL));
    const double start = t;
    RUN_TRY(write_row(r, file, t, 0, q));
    for (int64_t i = 1; i <= steps; i++) {
        int iterations = 0;
        double next = i == steps ? start + r->duration : start + (double)i * r->dt;
        RUN_TRY(run_drive(r, r->speed * next, r->speed));
        RUN_TRY(spar_step(r->session, next - t, run_blow, r, &iterations));
        t = next;
        RUN_TRY(write_row(r, file, t, iterations, q));
        RUN_TRY(spar_case_output(r->scene, 0, 0, NULL));
        show_progress(r, t - start, begun, &shown);
    }
    if (shown > 0 && isatty(STDERR_FILENO)) {
        (void)fprintf(stderr, "\n");
    }
    if (!r->quiet) {
        (void)printf("Run: %lld steps of %g s to t = %g s in %.2f s\n", (long long)steps, r->dt, t, now() - begun);
    }
    return SPAR_OK;
}

static int plot_history(const run *r) {
    char script[1024];
    (void)snprintf(
        script, sizeof script,
        "set xlabel 't, s'\nset ylabel 'displacement of the last node, m'\n"
        "plot for [m=0:%lld] for [k=3:5] 'history.csv' using 1:(column(k+9*m)) with lines title columnheader(k+9*m) "
        "noenhanced\n",
        (long long)spar_case_member_count(r->scene) - 1);
    return run_plot(r, "history", script);
}

int run_steps(run *r) {
    int64_t most = 1, nodes;
    for (int64_t i = 0; i < spar_case_member_count(r->scene); i++) {
        RUN_TRY(spar_member_get_count(spar_case_member_at(r->scene, i), &nodes));
        most = nodes > most ? nodes : most;
    }
    double *q = calloc(10 * (size_t)most, sizeof *q);
    if (!q) {
        return run_fail(SPAR_ERR_MEMORY, "no memory for %lld nodes", (long long)most);
    }
    FILE *file = run_open(r, "history.csv");
    int status = !file ? SPAR_ERR_IO : r->speed != 0 ? run_spin(r, r->speed) : SPAR_OK;
    status = status == SPAR_OK ? spar_case_blow(r->scene) : status; /* the loads of t = 0 */
    if (status == SPAR_OK) {
        write_heading(r, file);
        status = make_steps(r, file, q);
    }
    int closed = file ? run_close(file, "history.csv") : SPAR_OK;
    free(q);
    RUN_TRY(status);
    RUN_TRY(closed);
    return plot_history(r);
}
