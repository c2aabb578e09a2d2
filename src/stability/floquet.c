/* Stability of a periodic state: the map of small motions over one period, found by trials of the host's own steps,
   and its eigenvalues (Floquet multipliers). Each trial displaces every member along a shape, or gives it a velocity
   along it, in either direction, and runs through the period. Half the difference of the two final states is a
   column. */
#include "../trial/handle.h"
#include "shapes.h"

#include "../algebra/dense.h"
#include "../algebra/eigen.h"
#include "../assembly/assembly.h"
#include "../base/environment.h"
#include "../exchange/rank_loads_and_motion.h"
#include "../math/rotation.h"
#include "../session/callbacks.h"
#include "../solve/life.h"

#include <complex.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double usual_amplitude = 1e-4;
/* Maximum difference of the state after a period: displacement relative to the member's length, rotation, and both
   for velocities times a radian of the period. */
static const double periodic = 1e-3;

typedef struct floquet {
    spari_run run; /* dt, callbacks, progress */
    int64_t steps; /* per period */
    int64_t nodes; /* of all members */
    int modes;
    double amplitude;
    spari_small_motions motions; /* its parts have shapes */
    double *shape;               /* [modes][nodes][6] */
    double *rate, *unit; /* [modes]: 1/s; of a shape that moves its nodes by one length of their member or one radian */
    double *base;        /* [nodes][13]: motion at the beginning of the period, one step from here */
    double *gram;        /* [modes][modes] products of shapes, factored */
    double *Y[2];        /* [2 modes][2 modes] the state at both ends of the period: row by row what was moved, at the
                            beginning; column by column, at the end */
    double *change;      /* [2][2 modes] of a run, at both ends */
    int mode, kind;      /* of the run under way; mode -1: nothing is moved */
    double size, drift;  /* with its sign; out: how far from the beginning it ends */
} floquet;

/* ---- states ---- */

/* Displaces all parts along the shape, and changes their velocities along it, in axes that rotate with each part. */
static void displace(spar_session *s, const floquet *f, double way, double speed) {
    const double *shape = f->shape + 6 * f->nodes * f->mode, *base = f->base;
    for (spar_member *m = s->members; m; m = m->next) {
        const double *own = base + 10;
        for (int64_t i = 0; i < m->nodes; i++, shape += 6, base += SPARI_NODE_MOTION) {
            double rotation[3], p[4], along[3], *q = m->now.q + 7 * i, *v = m->now.v + 6 * i;
            for (int k = 0; k < 3; k++) {
                rotation[k] = way * shape[3 + k];
                along[k] = way * shape[k];
                q[k] += along[k];
                v[3 + k] += speed * shape[3 + k];
            }
            spari_quat_exp(rotation, p);
            spari_quat_mul(p, q + 3, q + 3);
            spari_cross(own, along, rotation);
            for (int k = 0; k < 3; k++) {
                v[k] += speed * shape[k] + rotation[k];
            }
        }
        if (spari_small_motions_part(&f->motions, m)) {
            spari_member_restart(m);
        }
    }
}

/* Change of a node since the beginning: displacement, rotation, and their velocities, in these axes. */
static void look_at_change(const double *base, const double own[3], const double *q, const double *v, double x[12]) {
    double rotation[4], carried[3];
    spari_quat_between(base + 3, q + 3, rotation);
    spari_quat_log(rotation, x + 3);
    for (int k = 0; k < 3; k++) {
        x[k] = q[k] - base[k];
    }
    spari_cross(own, x, carried);
    for (int k = 0; k < 6; k++) {
        x[6 + k] = v[k] - base[7 + k] - (k < 3 ? carried[k] : 0);
    }
}

/* Rotations are multiplied by the member's length. */
static double product_at(double length, const double *a, const double *b) {
    return spari_dot(a, b) + length * length * spari_dot(a + 3, b + 3);
}

/* The state against the beginning, in shapes, into a row; and how far it is away. */
static void look_at_state(const spar_session *s, floquet *f, double *row) {
    int n = f->modes;
    double radian = f->run.dt * (double)f->steps / (2 * acos(-1));
    const double *base = f->base;
    int64_t at = 0;
    memset(row, 0, 2 * (size_t)n * sizeof *row);
    f->drift = 0;
    for (const spar_member *m = s->members; m; m = m->next) {
        const double *own = base + 10, length = spari_member_length(m);
        for (int64_t i = 0; i < m->nodes; i++, base += SPARI_NODE_MOTION, at += 6) {
            double x[12];
            look_at_change(base, own, m->now.q + 7 * i, m->now.v + 6 * i, x);
            for (int k = 0; k < n; k++) {
                const double *shape = f->shape + 6 * f->nodes * k + at;
                row[k] += product_at(length, shape, x);
                row[n + k] += product_at(length, shape, x + 6);
            }
            if (spari_small_motions_part(&f->motions, m)) {
                f->drift = fmax(f->drift, fmax(spari_norm(x) / length, spari_norm(x + 3)));
                f->drift = fmax(f->drift, radian * fmax(spari_norm(x + 6) / length, spari_norm(x + 9)));
            }
        }
    }
    for (int half = 0; half < 2; half++) {
        spari_cholesky_solve(n, f->gram, row + half * n);
    }
}

/* The trial: one step from consistent initial conditions of the disturbed state, which makes velocities compatible
   with joints, and a period from there. */
static int run_period(spar_session *s, void *self) {
    floquet *f = self;
    const spari_run *run = &f->run;
    int iterations;
    s->newton.rtol = fmin(s->newton.rtol, 1e-12); /* small differences of runs are looked at */
    if (f->mode >= 0) {
        displace(s, f, f->kind == 0 ? f->size : 0, f->kind == 1 ? f->size * f->rate[f->mode] : 0);
    }
    s->clock.step = 0;
    s->clock.started = 0;
    SPARI_TRY(spar_session_solve_initial(s, run->dt, run->solve, run->solve_context, &iterations));
    for (int64_t i = 0; i <= f->steps; i++) {
        SPARI_TRY(spari_callback_before_step(s, "spar_trial_solve_floquet", run->before, run->dt, run->before_context));
        SPARI_TRY(spar_step(s, run->dt, run->solve, run->solve_context, &iterations));
        if (i == 0 && f->mode < 0) {
            spari_shapes_keep_motion(s, f->base);
        }
        if (i == 0 || i == f->steps) {
            look_at_state(s, f, f->change + 2 * f->modes * (i > 0));
        }
    }
    return SPAR_OK;
}

/* ---- all trials ---- */

static int try_period(spar_session *s, floquet *f, const spari_trial_settings *trial_settings, int done) {
    spari_record none;
    spari_run run = f->run;
    run.instead = run_period;
    run.of = f;
    SPARI_TRY(spari_progress_tell(s, run.progress, done, 4 * f->modes + 1));
    (void)spari_trial_run(s, &run, trial_settings, &none);
    return none.own;
}

static int find_columns_of_map(spar_session *s, floquet *f, const spari_trial_settings *trial_settings) {
    int n = f->modes, done = 0;
    f->mode = -1;
    SPARI_TRY(try_period(s, f, trial_settings, done++));
    SPARI_REQUIRE(s, f->drift <= periodic, SPAR_ERR_STATE,
                  "the state is not periodic with %lld steps of %g s: it differs by %.2g of a member's length, or rad, "
                  "after one period; run until it repeats, or give the whole period",
                  (long long)f->steps, f->run.dt, f->drift);
    for (int column = 0; column < 2 * n; column++) {
        f->mode = column % n;
        f->kind = column / n;
        for (int side = 0; side < 2; side++) {
            f->size = (side ? -1 : 1) * f->amplitude * f->unit[f->mode];
            SPARI_TRY(try_period(s, f, trial_settings, done++));
            for (int end = 0; end < 2; end++) {
                for (int i = 0; i < 2 * n; i++) {
                    f->Y[end][end ? 2 * n * i + column : 2 * n * column + i] +=
                        f->change[2 * n * end + i] / (2 * f->size);
                }
            }
        }
    }
    return SPAR_OK;
}

static int by_size(const void *a, const void *b) {
    double x = cabs(*(const double complex *)a), y = cabs(*(const double complex *)b);
    return x < y ? 1 : x > y ? -1 : 0;
}

/* Multipliers z [2 modes], largest first, one of each conjugate pair, and their number. Returns a status, without a
   message. */
static int solve_map(floquet *f, double complex *z, int *count) {
    int n = 2 * f->modes, status = z ? spari_least_squares(n, n, f->Y[0], n, f->Y[1]) : SPAR_ERR_MEMORY;
    status = status == SPAR_OK ? spari_eigenvalues(n, f->Y[1], z) : status;
    for (int k = 0; k < n && status == SPAR_OK; k++) {
        if (cimag(z[k]) >= 0) {
            z[(*count)++] = z[k];
        }
    }
    if (*count > 0) {
        qsort(z, (size_t)*count, sizeof *z, by_size);
    }
    return status;
}

/* ---- the call ---- */

/* Shapes, computed on every rank. */
static int find_shapes_of_period(spar_session *s, floquet *f) {
    int n = f->modes;
    SPARI_TRY(spari_joints_place(s));
    SPARI_TRY(spari_small_motions_create_loose(&f->motions, s));
    int64_t square = (int64_t)n * n;
    f->shape = spari_zalloc(6 * n * f->nodes + 2 * n + SPARI_NODE_MOTION * f->nodes + (int64_t)n * f->motions.size,
                            sizeof *f->shape);
    f->gram = spari_zalloc(9 * square + 4 * n, sizeof *f->gram);
    SPARI_REQUIRE(s, f->shape && f->gram, SPAR_ERR_MEMORY, "no memory for %d modes", n);
    f->Y[0] = f->gram + square, f->Y[1] = f->Y[0] + 4 * square, f->change = f->Y[1] + 4 * square;
    f->rate = f->shape + 6 * n * f->nodes, f->unit = f->rate + n, f->base = f->unit + n;
    double *x = f->base + SPARI_NODE_MOTION * f->nodes;
    SPARI_TRY(spari_shapes_find(&f->motions, n, x, f->rate));
    spari_shapes_show(&f->motions, n, x, f->shape);
    spari_shapes_keep_motion(s, f->base);
    return SPAR_OK;
}

/* Products of shapes, and the unit amplitude of each. */
static int weigh_shapes(spar_session *s, floquet *f) {
    for (int i = 0; i < f->modes; i++) {
        const double *a = f->shape + 6 * f->nodes * i;
        f->unit[i] = spari_shapes_unit(s, a);
        for (const spar_member *m = s->members; m; m = m->next) {
            double length = spari_member_length(m);
            for (int64_t k = 0; k < m->nodes; k++, a += 6) {
                for (int j = 0; j <= i; j++) {
                    const double *b = a + 6 * f->nodes * (j - i);
                    f->gram[f->modes * i + j] += product_at(length, a, b);
                }
            }
        }
    }
    SPARI_REQUIRE(s, spari_cholesky(f->modes, f->gram) == 0, SPAR_ERR_NUMERIC,
                  "the mode shapes are linearly dependent; request fewer modes");
    return SPAR_OK;
}

static int find_multipliers(spar_session *s, floquet *f, int64_t n, double *eigenvalue) {
    double complex *z = spari_zalloc(2 * (int64_t)f->modes, sizeof *z);
    int count = 0, status = solve_map(f, z, &count);
    double period = f->run.dt * (double)f->steps;
    for (int64_t k = 0; k < n && count >= n; k++) {
        eigenvalue[2 * k] = log(cabs(z[k])) / period;
        eigenvalue[2 * k + 1] = carg(z[k]) / period;
    }
    free(z);
    SPARI_REQUIRE(s, status != SPAR_ERR_MEMORY, status, "no memory for %d modes", f->modes);
    SPARI_REQUIRE(s, count >= n, SPAR_ERR_NUMERIC,
                  "only %d of %lld multipliers found; a conjugate pair counts once: request fewer, or give more modes",
                  count, (long long)n);
    return SPAR_OK;
}

static int solve_floquet(spar_session *s, floquet *f, int64_t n, double *eigenvalue) {
    int status = find_shapes_of_period(s, f);
    status = status == SPAR_OK ? weigh_shapes(s, f) : status;
    status = spari_agree(s, status);
    spari_trial_settings trial_settings = {.member = NULL};
    status = status == SPAR_OK ? spari_trial_settings_create(s, &trial_settings) : status;
    if (status == SPAR_OK) {
        status = find_columns_of_map(s, f, &trial_settings);
        spari_trial_settings_free(&trial_settings);
    }
    if (status == SPAR_OK) {
        status = find_multipliers(s, f, n, eigenvalue);
        status = spari_agree(s, status);
    }
    return status;
}

static int check_floquet(spar_trial *t, const char *call, int64_t n, const double *eigenvalue) {
    SPARI_TRY(spari_shapes_ready(t, call, n, "multipliers", eigenvalue));
    SPARI_REQUIRE(t->session, isfinite(t->dt * (double)t->steps), SPAR_ERR_ARGUMENT,
                  "%s: the period of %lld steps is not finite; give fewer or shorter steps", call, (long long)t->steps);
    return SPAR_OK;
}

int spar_trial_solve_floquet(spar_trial *trial, int64_t n, double *eigenvalue) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_REQUIRE(NULL, trial, SPAR_ERR_ARGUMENT, "%s: the trial is NULL; create it first", __func__);
    spar_session *s = trial->session;
    spari_progress progress = spari_trial_progress(trial, __func__);
    floquet f = {.steps = trial->steps, .modes = (int)trial->modes};
    f.run = spari_trial_run_of(trial, &progress);
    f.run.steps = SPARI_MULTIPLE;
    f.amplitude = trial->amplitude == 0 ? usual_amplitude : trial->amplitude;
    f.nodes = spari_shapes_nodes(s);
    const spari_agreed arguments[] = {spari_whole("n", n)};
    SPARI_TRY(spari_trial_enter(trial, __func__, arguments, 1, check_floquet(trial, __func__, n, eigenvalue)));
    int status = solve_floquet(s, &f, n, eigenvalue);
    spari_small_motions_free(&f.motions);
    SPARI_FREE(f.shape, f.gram);
    return spari_trial_leave(trial, __func__, spari_progress_ends(&progress, status));
}
