/* Static solution, modes and Campbell diagram. */
#if !defined(_XOPEN_SOURCE) && !defined(_POSIX_C_SOURCE)
#define _POSIX_C_SOURCE 200809L
#endif
#include "run.h"

#include <math.h>
#include <spar/spar_output.h>
#include <stdlib.h>
#include <string.h>

static const double two_pi = 6.283185307179586;

/* ---- static solution ---- */

typedef struct motion {
    int64_t nodes;
    double *x, *q; /* [nodes][3] reference, [nodes][7] */
} motion;

static int read_motion(const spar_member *member, motion *m) {
    *m = (motion){0};
    RUN_TRY(spar_member_get_count(member, &m->nodes));
    m->x = calloc(10 * (size_t)m->nodes, sizeof *m->x);
    if (!m->x) {
        return run_fail(SPAR_ERR_MEMORY, "no memory for %lld nodes", (long long)m->nodes);
    }
    m->q = m->x + 3 * m->nodes;
    RUN_TRY(spar_member_get_reference(member, m->x, NULL));
    return spar_member_get_motion(member, m->q, NULL, NULL);
}

/* Rotation vector of a unit quaternion, scalar first. */
static void rotation_vector(const double q[4], double r[3]) {
    double sine = sqrt(q[1] * q[1] + q[2] * q[2] + q[3] * q[3]), sign = q[0] < 0 ? -1 : 1;
    double part = sine > 0 ? sign * 2 * atan2(sine, sign * q[0]) / sine : 2;
    for (int i = 0; i < 3; i++) {
        r[i] = part * q[1 + i];
    }
}

static void write_nodes(FILE *file, const char *name, const motion *m) {
    for (int64_t i = 0; i < m->nodes; i++) {
        const double *x = m->x + 3 * i, *q = m->q + 7 * i;
        double r[3];
        rotation_vector(q + 3, r);
        (void)fprintf(file, "%s,%lld,%.15g,%.15g,%.15g,%.15g,%.15g,%.15g,%.15g,%.15g,%.15g\n", name, (long long)i, x[0],
                      x[1], x[2], q[0], q[1], q[2], r[0], r[1], r[2]);
    }
}

static int tell_static(const run *r, const spar_member *member, const motion *m) {
    double load[6] = {0};
    const double *q = m->q + 7 * (m->nodes - 1);
    if (r->quiet) {
        return SPAR_OK;
    }
    RUN_TRY(spar_member_get_reaction(member, load));
    (void)printf("  %-16s %11.4g %11.4g %11.4g   %11.4g %11.4g %11.4g %11.4g %11.4g %11.4g\n",
                 spar_member_get_name(member), q[0], q[1], q[2], load[0], load[1], load[2], load[3], load[4], load[5]);
    return SPAR_OK;
}

static int report_static(const run *r, FILE *file, const spar_member *member) {
    char path[2048];
    motion m;
    int status = read_motion(member, &m);
    if (status == SPAR_OK) {
        write_nodes(file, spar_member_get_name(member), &m);
        status = tell_static(r, member, &m);
    }
    free(m.x);
    (void)snprintf(path, sizeof path, "%.1000s/static_%.200s.vtp", r->out, spar_member_get_name(member));
    return status == SPAR_OK ? spar_member_write_vtk(member, path) : status;
}

/* Equilibrium at a speed; the members then turn at it (the solution itself ends their velocities). */
static int balance(run *r, double speed, int *iterations) {
    RUN_TRY(run_spin(r, speed));
    RUN_TRY(spar_session_solve_static(r->session, (int)r->load_steps, run_blow, r, iterations));
    return run_spin(r, speed);
}

int run_static(run *r) {
    int iterations = 0;
    RUN_TRY(balance(r, r->speed, &iterations));
    FILE *file = run_open(r, "static.csv");
    if (!file) {
        return SPAR_ERR_IO;
    }
    (void)fprintf(file, "member,node,x_m,y_m,z_m,ux_m,uy_m,uz_m,rx_rad,ry_rad,rz_rad\n");
    if (!r->quiet) {
        (void)printf("Static solution, %d %s of the loads: displacement of the last node, reaction at the root\n"
                     "  %-16s %11s %11s %11s   %11s %11s %11s %11s %11s %11s\n",
                     iterations, iterations == 1 ? "evaluation" : "evaluations", "member", "ux, m", "uy, m", "uz, m",
                     "Fx, N", "Fy, N", "Fz, N", "Mx, N m", "My, N m", "Mz, N m");
    }
    int status = SPAR_OK;
    for (int64_t i = 0; status == SPAR_OK && i < spar_case_member_count(r->scene); i++) {
        status = report_static(r, file, spar_case_member_at(r->scene, i));
    }
    int closed = run_close(file, "static.csv");
    return status == SPAR_OK ? closed : status;
}

/* ---- modes ---- */

/* As many modes as there are, at most n: *n is reduced until the member has as many unknowns. */
static int solve_modes(spar_member *member, int64_t *n, double *f, double *shapes) {
    int status = spar_member_solve_modes(member, *n, f, shapes);
    while (status == SPAR_ERR_ARGUMENT && *n > 1) {
        --*n;
        status = spar_member_solve_modes(member, *n, f, shapes);
    }
    return status;
}

/* The eigenvalues by their frequency, as frequency (Hz) and damping ratio. */
static int by_frequency(const void *a, const void *b) {
    const double *x = a, *y = b;
    return x[1] < y[1] ? -1 : x[1] > y[1];
}

static int solve_damped(spar_member *member, int64_t n, double *pair) {
    int status = spar_member_solve_eigenvalues(member, n, NULL, pair, NULL, NULL);
    if (status == SPAR_OK) {
        /* NOLINTNEXTLINE(clang-analyzer-core.NonNullParamChecker): run_fail returns what it is given */
        qsort(pair, (size_t)n, 2 * sizeof *pair, by_frequency);
    }
    for (int64_t i = 0; status == SPAR_OK && i < n; i++) {
        double growth = pair[2 * i], omega = pair[2 * i + 1], size = hypot(growth, omega);
        pair[2 * i] = omega / two_pi;
        pair[2 * i + 1] = size > 0 ? -growth / size : 0;
    }
    return status;
}

typedef struct mode_space {
    int64_t n, nodes;
    double *f, *pair, *shape, *x; /* [n], [n][2], [n][nodes][6], [nodes][3] */
    double *before;               /* [n]: of the last member that was solved */
    const char *before_name;
    int64_t before_n;
} mode_space;

static int make_space(const run *r, mode_space *s) {
    int64_t nodes;
    s->n = r->modes;
    for (int64_t i = 0; i < spar_case_member_count(r->scene); i++) {
        RUN_TRY(spar_member_get_count(spar_case_member_at(r->scene, i), &nodes));
        s->nodes = nodes > s->nodes ? nodes : s->nodes;
    }
    s->f = calloc((size_t)s->n, sizeof *s->f);
    s->before = calloc((size_t)s->n, sizeof *s->before);
    s->pair = calloc(2 * (size_t)s->n, sizeof *s->pair);
    s->shape = calloc((size_t)(6 * s->n * s->nodes) + 1, sizeof *s->shape);
    s->x = calloc(3 * (size_t)s->nodes + 1, sizeof *s->x);
    return s->f && s->before && s->pair && s->shape && s->x ? SPAR_OK
                                                            : run_fail(SPAR_ERR_MEMORY, "no memory for modes");
}

static void free_space(mode_space *s) {
    free(s->f);
    free(s->before);
    free(s->pair);
    free(s->shape);
    free(s->x);
}

static int write_shapes(FILE *file, const spar_member *member, const mode_space *s, int64_t n) {
    int64_t nodes;
    RUN_TRY(spar_member_get_count(member, &nodes));
    RUN_TRY(spar_member_get_reference(member, s->x, NULL));
    for (int64_t m = 0; m < n; m++) {
        for (int64_t i = 0; i < nodes; i++) {
            const double *u = s->shape + 6 * (m * nodes + i), *x = s->x + 3 * i;
            (void)fprintf(file, "%s,%lld,%lld,%.15g,%.15g,%.15g,%.15g,%.15g,%.15g,%.15g,%.15g,%.15g\n",
                          spar_member_get_name(member), (long long)m, (long long)i, x[0], x[1], x[2], u[0], u[1], u[2],
                          u[3], u[4], u[5]);
        }
    }
    return SPAR_OK;
}

/* damped: whether the eigenvalues were found too. */
static void tell_modes(const run *r, FILE *file, const char *name, const mode_space *s, int64_t n, int damped) {
    if (!r->quiet) {
        (void)printf("Modes of '%s'%s\n  mode   frequency, Hz%s\n", name, r->speed != 0 ? ", rotating" : "",
                     damped ? "   eigenvalue: frequency, Hz   damping ratio" : "");
    }
    for (int64_t i = 0; i < n; i++) {
        const double *pair = s->pair + 2 * i;
        (void)fprintf(file, "%s,%lld,%.15g,%.15g,%.15g\n", name, (long long)i, s->f[i], damped ? pair[0] : NAN,
                      damped ? pair[1] : NAN);
        if (!r->quiet && damped) {
            (void)printf("  %4lld   %13.6g   %25.6g   %13.4g\n", (long long)i, s->f[i], pair[0], pair[1]);
        } else if (!r->quiet) {
            (void)printf("  %4lld   %13.6g\n", (long long)i, s->f[i]);
        }
    }
}

/* Members that joints connect have one set of modes: the shapes of each are written, the frequencies once. */
static int report_modes(const run *r, FILE *file, FILE *shapes, spar_member *member, mode_space *s) {
    int64_t n = s->n;
    const char *name = spar_member_get_name(member);
    int status = solve_modes(member, &n, s->f, s->shape);
    if (status != SPAR_OK) { /* a point, or a member that the host solves, has none */
        if (!r->quiet && status == SPAR_ERR_UNSUPPORTED) {
            (void)printf("No modes of '%s': %s\n", name, spar_session_message(r->session));
        }
        return status == SPAR_ERR_UNSUPPORTED ? SPAR_OK : status;
    }
    RUN_TRY(write_shapes(shapes, member, s, n));
    if (s->before_n == n && memcmp(s->before, s->f, (size_t)n * sizeof *s->f) == 0) {
        if (!r->quiet) {
            (void)printf("Modes of '%s': those of '%s'\n", name, s->before_name);
        }
        return SPAR_OK;
    }
    int damped = solve_damped(member, n, s->pair) == SPAR_OK;
    tell_modes(r, file, name, s, n, damped);
    memcpy(s->before, s->f, (size_t)n * sizeof *s->f);
    s->before_name = name;
    s->before_n = n;
    return SPAR_OK;
}

int run_modes(run *r) {
    mode_space space = {0};
    RUN_TRY(run_spin(r, r->speed));
    int status = make_space(r, &space);
    FILE *file = status == SPAR_OK ? run_open(r, "modes.csv") : NULL;
    FILE *shapes = file ? run_open(r, "shapes.csv") : NULL;
    status = status == SPAR_OK && !shapes ? SPAR_ERR_IO : status;
    if (status == SPAR_OK) {
        (void)fprintf(file, "member,mode,frequency_Hz,damped_frequency_Hz,damping_ratio\n");
        (void)fprintf(shapes, "member,mode,node,x_m,y_m,z_m,ux,uy,uz,rx,ry,rz\n");
    }
    for (int64_t i = 0; status == SPAR_OK && i < spar_case_member_count(r->scene); i++) {
        status = report_modes(r, file, shapes, spar_case_member_at(r->scene, i), &space);
    }
    int closed = file ? run_close(file, "modes.csv") : SPAR_OK,
        last = shapes ? run_close(shapes, "shapes.csv") : SPAR_OK;
    free_space(&space);
    status = status == SPAR_OK ? closed : status;
    return status == SPAR_OK ? last : status;
}

/* ---- Campbell diagram ---- */

/* The first member that has a driven root: its eigenvalues are those of all that it is joined to. */
static int find_driven(const run *r, spar_member **member) {
    for (int64_t i = 0; i < spar_case_member_count(r->scene); i++) {
        int root = 0;
        *member = spar_case_member_at(r->scene, i);
        RUN_TRY(spar_member_get_root(*member, &root));
        if (root == SPAR_ROOT_DRIVEN) {
            return SPAR_OK;
        }
    }
    return run_fail(SPAR_ERR_ARGUMENT, "a Campbell diagram needs a member with root driven, which rotation then turns");
}

static int campbell_row(run *r, FILE *file, spar_member *member, double speed, double *pair) {
    RUN_TRY(balance(r, speed, NULL));
    RUN_TRY(solve_damped(member, r->modes, pair));
    (void)fprintf(file, "%.15g", speed);
    for (int64_t i = 0; i < r->modes; i++) {
        (void)fprintf(file, ",%.15g,%.15g", pair[2 * i], pair[2 * i + 1]);
    }
    (void)fprintf(file, "\n");
    if (!r->quiet) {
        (void)printf("  %10.4g", speed);
        for (int64_t i = 0; i < r->modes && i < 8; i++) {
            (void)printf(" %9.4g", pair[2 * i]);
        }
        (void)printf("\n");
    }
    return SPAR_OK;
}

static int plot_campbell(const run *r) {
    char script[1024];
    (void)snprintf(script, sizeof script,
                   "set xlabel 'speed, rad/s'\nset ylabel 'frequency, Hz'\nset xrange [0:%.15g]\nset yrange [0:*]\n"
                   "plot for [k=1:%lld] 'campbell.csv' using 1:(column(2*k)) with linespoints pt 7 ps 0.5 title "
                   "sprintf('mode %%d', k-1), \\\n"
                   "  for [p in '1 3 6'] p*x/(2*pi) with lines dashtype 2 linecolor 'gray' title p.' per turn'\n",
                   r->campbell[1], (long long)r->modes);
    return run_plot(r, "campbell", script);
}

int run_campbell(run *r) {
    const int64_t speeds = (int64_t)r->campbell[0];
    spar_member *member = NULL;
    RUN_TRY(find_driven(r, &member));
    double *pair = calloc(2 * (size_t)r->modes, sizeof *pair);
    FILE *file = pair ? run_open(r, "campbell.csv") : NULL;
    int status = !pair ? run_fail(SPAR_ERR_MEMORY, "no memory for modes") : file ? SPAR_OK : SPAR_ERR_IO;
    if (status == SPAR_OK) {
        (void)fprintf(file, "speed_rad_s");
        for (int64_t i = 0; i < r->modes; i++) {
            (void)fprintf(file, ",f%lld_Hz,damping%lld", (long long)i, (long long)i);
        }
        (void)fprintf(file, "\n");
        if (!r->quiet) {
            (void)printf("Campbell diagram of '%s', in the rotating frame\n  %10s  frequencies, Hz\n",
                         spar_member_get_name(member), "rad/s");
        }
    }
    for (int64_t k = 0; status == SPAR_OK && k < speeds; k++) {
        status = campbell_row(r, file, member, r->campbell[1] * (double)k / (double)(speeds - 1), pair);
    }
    int closed = file ? run_close(file, "campbell.csv") : SPAR_OK;
    free(pair);
    RUN_TRY(status);
    RUN_TRY(closed);
    RUN_TRY(balance(r, r->speed, NULL)); /* a run starts from here */
    return plot_campbell(r);
}
