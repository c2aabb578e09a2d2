/* Loads due to motion along shapes, in trials that solve nothing: see fluid_response.h. */
#include "fluid_response.h"

#include "../math/rotation.h"
#include "../session/callbacks.h"
#include "../session/prescribed_step.h"
#include "shapes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Width of the bell, in steps. */
static const double bell_width = 1.25;
/* Maximum difference between the loads of the trials at the present state and those in use. */
static const double same_loads = 1e-3;
/* Loads below this, relative to the structure's forces in a trial, count as zero. */
static const double no_load = 1e-6;

void spari_fluid_response_free(spari_fluid_response *response) {
    free(response->load);
    response->load = NULL;
}

/* Amplitude, velocity and acceleration along a shape. */
typedef struct response_law {
    double x, v, a;
} response_law;

/* One trial. */
typedef struct response_trial {
    const spari_response_query *ask;
    const char *call;
    const double *base; /* [nodes][13]: displacement, quaternion, velocity, angular velocity at the beginning */
    const spari_fluid_response *response;
    int mode, kind; /* kind: without memory 0: displacement, 1: velocity, 2: acceleration */
    double size;    /* amplitude of the motion, signed */
    double *load;   /* [count][modes], out */
    double *scale;  /* [modes] sums of the sizes of the loads' parts: maximum of all trials so far, */
    double *left;   /* and the difference between the loads without motion and those in use */
    int done, all;  /* trials made, and in total */
} response_trial;

/* ---- motion ---- */

/* R = exp(w t), as a quaternion; and the displacement in t due to a velocity that rotates with it. */
static void turn_on(const double w[3], double t, const double v[3], double q[4], double way[3]) {
    double angle = spari_norm(w) * t, s[3] = {w[0] * t, w[1] * t, w[2] * t}, once[3], twice[3];
    double b = fabs(angle) > 1e-3 ? (1 - cos(angle)) / (angle * angle) : 0.5 - angle * angle / 24;
    double c = fabs(angle) > 1e-3 ? (angle - sin(angle)) / (angle * angle * angle) : 1.0 / 6 - angle * angle / 120;
    spari_quat_exp(s, q);
    spari_cross(s, v, once);
    spari_cross(s, once, twice);
    for (int k = 0; k < 3; k++) {
        way[k] = t * (v[k] + b * once[k] + c * twice[k]);
    }
}

/* Position of a node after steady motion for t. own: angular velocity of its member. */
static void move_steadily(const double *base, const double own[3], double t, double q[7], double v[6], double a[6]) {
    double rotation[4], way[3];
    turn_on(own, t, base + 7, rotation, way);
    for (int k = 0; k < 3; k++) {
        q[k] = base[k] + way[k];
        a[3 + k] = 0;
    }
    spari_quat_mul(rotation, base + 3, q + 3);
    spari_rotate(rotation, base + 7, v);
    spari_rotate(rotation, base + 10, v + 3);
    spari_cross(own, v, a);
}

/* c += f a x b */
static void add_cross(double f, const double a[3], const double b[3], double c[3]) {
    double x[3];
    spari_cross(a, b, x);
    for (int k = 0; k < 3; k++) {
        c[k] += f * x[k];
    }
}

/* Adds motion along a shape, (W1) and (W2) of docs/explanation/theory.md, in the axes of the frame at t. frame: its
   rotation; w: its angular velocity; s: that of the member relative to it. */
static void add_motion(const double shape[6], response_law at, const double frame[4], const double w[3],
                       const double s[3], double q[7], double v[6], double a[6]) {
    double d[3][6] = {{0}}, once[3], turned[4], old[4], ws[3] = {w[0] - s[0], w[1] - s[1], w[2] - s[2]};
    for (int k = 0; k < 6; k++) {
        d[0][k] = shape[k] * at.x;
        d[1][k] = shape[k] * at.v;
        d[2][k] = shape[k] * at.a;
    }
    spari_cross(w, d[0], once);
    add_cross(2, w, d[1], d[2]);
    add_cross(1, w, once, d[2]);
    spari_cross(s, d[0] + 3, once);
    add_cross(1, ws, d[1] + 3, d[2] + 3);
    add_cross(-1, w, once, d[2] + 3);
    add_cross(1, w, d[0], d[1]);
    add_cross(-1, s, d[0] + 3, d[1] + 3);
    for (int i = 0; i < 6; i++) {
        spari_rotate(frame, d[i / 2] + 3 * (i % 2), d[i / 2] + 3 * (i % 2));
    }
    spari_quat_exp(d[0] + 3, turned);
    memcpy(old, q + 3, sizeof old);
    spari_quat_mul(turned, old, q + 3);
    spari_quat_normalise(q + 3);
    for (int k = 0; k < 6; k++) {
        q[k] += k < 3 ? d[0][k] : 0;
        v[k] += d[1][k];
        a[k] += d[2][k];
    }
}

/* Places all members at time t, with their mode at `law`. */
static void place_members(spar_session *s, const response_trial *of, double t, response_law law, int after) {
    const spari_small_motions *w = of->ask->motions;
    const double zero[3] = {0, 0, 0}, *base = of->base, *shape = of->ask->shape + 6 * of->ask->nodes * of->mode;
    double frame[4], way[3];
    turn_on(w->w, t, zero, frame, way);
    for (spar_member *m = s->members; m; m = m->next) {
        const spari_motion_part *part = spari_small_motions_part(w, m);
        const spari_motion *to = after ? &m->after : &m->now;
        double own[3], seen[3];
        memcpy(own, base + 10, sizeof own);
        for (int k = 0; k < 3; k++) {
            seen[k] = own[k] - w->w[k];
        }
        for (int64_t i = 0; i < m->nodes; i++, base += SPARI_NODE_MOTION, shape += 6) {
            double *q = to->q + 7 * i, *v = to->v + 6 * i, *a = to->a + 6 * i;
            move_steadily(base, own, t, q, v, a);
            if (part) {
                add_motion(shape, law, frame, w->w, seen, q, v, a);
            }
        }
    }
}

/* ---- loads ---- */

/* Generalised loads on all shapes at t, and the sizes of their parts. */
static void see_loads(const spar_session *s, const spari_response_query *ask, double t, double *load, double *scale) {
    const spari_small_motions *w = ask->motions;
    const double zero[3] = {0, 0, 0};
    double frame[4], way[3];
    turn_on(w->w, t, zero, frame, way);
    for (int k = 0; k < ask->modes; k++) {
        const double *shape = ask->shape + 6 * ask->nodes * k;
        double sum = 0, size = 0;
        for (const spar_member *m = s->members; m; m = m->next) {
            for (int64_t i = 0; i < 2 * m->nodes; i++, shape += 3) {
                double f[3];
                spari_rotate_back(frame, m->load.pushed + 3 * i, f);
                sum += spari_dot(shape, f);
                size += spari_norm(shape) * spari_norm(f);
            }
        }
        load[k] = sum;
        scale[k] = fmax(scale[k], size);
    }
}

static response_law bell(int64_t sample) {
    double u = ((double)sample - SPARI_PULSE_MIDDLE) / bell_width, x = exp(-0.5 * u * u);
    return fabs(u) < 8 ? (response_law){x, -u / bell_width * x, (u * u - 1) / (bell_width * bell_width) * x}
                       : (response_law){0, 0, 0};
}

/* Motion at the end of a step, or at its beginning (before = 1). */
static response_law law_of(const response_trial *of, int64_t sample, int before) {
    double dt = of->ask->run.dt, rate = of->ask->rate[of->mode], size = of->size;
    if (of->ask->memory > 0) {
        response_law at = bell(sample - before);
        return (response_law){size * at.x, size * at.v / dt, size * at.a / (dt * dt)};
    }
    double v = of->kind == 1 ? size * rate : 0, a = of->kind == 2 ? size * rate * rate : 0, t = before ? -dt : 0;
    return (response_law){(of->kind == 0 ? size : 0) + v * t + 0.5 * a * t * t, v + a * t, a};
}

/* The trial itself. */
static int move_there(spar_session *s, void *self) {
    const response_trial *of = self;
    const spari_response_query *ask = of->ask;
    int64_t steps = ask->memory > 0 ? of->response->count : 1;
    place_members(s, of, 0, law_of(of, 0, 1), 0);
    place_members(s, of, 0, law_of(of, 0, 1), 1);
    for (int64_t i = 0; i < steps; i++) {
        double t = ask->run.dt * (double)(i + 1);
        SPARI_TRY(spari_callback_before_step(s, of->call, ask->run.before, ask->run.dt, ask->run.before_context));
        place_members(s, of, t, law_of(of, i, 0), 1);
        SPARI_TRY(spari_forced_step(s, of->call, ask->run.dt, ask->run.solve, ask->run.solve_context));
        see_loads(s, ask, t, of->load + ask->modes * i, of->scale);
    }
    return SPAR_OK;
}

/* ---- all trials ---- */

/* Half the difference of two trials, divided by the unit of their motion, into column `mode`. Their mean is the load
   without motion. */
static void take_trials(const spari_response_query *ask, const response_trial *of, const double *in_use,
                        const double *plus, const double *minus, double unit, double *to) {
    int n = ask->modes;
    int64_t steps = ask->memory > 0 ? of->response->count : 1;
    for (int64_t k = 0; k < steps; k++) {
        for (int i = 0; i < n; i++) {
            double mean = 0.5 * (plus[n * k + i] + minus[n * k + i]);
            of->left[i] = fmax(of->left[i], fabs(mean - in_use[i]));
            to[n * (n * k + i) + of->mode] = 0.5 * (plus[n * k + i] - minus[n * k + i]) / unit;
        }
    }
}

/* Both trials of a mode and kind. room [2][count][modes], scale [modes]. */
static int try_mode(spar_session *s, response_trial *of, const spari_trial_settings *trial_settings,
                    const double *in_use, double *workspace, double *to) {
    const spari_response_query *ask = of->ask;
    double size = ask->amplitude * spari_shapes_unit(s, ask->shape + 6 * ask->nodes * of->mode);
    double unit = ask->memory > 0 || of->kind == 0 ? size : size * pow(ask->rate[of->mode], of->kind);
    spari_run run = ask->run;
    run.instead = move_there;
    run.of = of;
    of->scale[of->mode] = fmax(of->scale[of->mode], no_load * size * pow(ask->rate[of->mode], 2));
    for (int side = 0; side < 2; side++) {
        spari_record none;
        of->size = side ? -size : size;
        of->load = workspace + side * of->response->count * ask->modes;
        SPARI_TRY(spari_progress_tell(s, run.progress, of->done++, of->all));
        (void)spari_trial_run(s, &run, trial_settings, &none);
        SPARI_TRY(none.own);
    }
    take_trials(ask, of, in_use, workspace, workspace + of->response->count * ask->modes, unit, to);
    return SPAR_OK;
}

static int run_trials(spar_session *s, const char *call, const spari_response_query *ask,
                      const spari_trial_settings *trial_settings, spari_fluid_response *response, double *workspace) {
    int n = ask->modes;
    double *base = workspace, *in_use = base + SPARI_NODE_MOTION * ask->nodes, *scale = in_use + n, *left = scale + n,
           *both = left + n;
    response_trial of = {.ask = ask, .call = call, .base = base, .response = response, .scale = scale, .left = left};
    double worst = 0;
    int kinds = ask->memory > 0 ? 1 : 3;
    of.all = 2 * kinds * n;
    spari_shapes_keep_motion(s, base);
    see_loads(s, ask, 0, in_use, scale);
    for (of.mode = 0; of.mode < n; of.mode++) {
        for (of.kind = 0; of.kind < kinds; of.kind++) {
            double *to = response->load + (int64_t)n * n * of.kind;
            SPARI_TRY(try_mode(s, &of, trial_settings, in_use, both, to));
        }
    }
    for (int i = 0; i < n; i++) {
        worst = fmax(worst, left[i] > 0 ? left[i] / scale[i] : 0);
    }
    SPARI_REQUIRE(
        s, worst <= same_loads, SPAR_ERR_STATE,
        "the fluid's loads in the present state differ from those in use by %.1e, or they change without motion: no "
        "equilibrium; solve with the fluid first (spar_session_solve_static), or run until the motion ends",
        worst);
    return SPAR_OK;
}

int spari_fluid_response_find(spar_session *s, const char *call, const spari_response_query *ask,
                              spari_fluid_response *response) {
    int64_t n = ask->modes;
    *response = (spari_fluid_response){.count = ask->memory > 0 ? SPARI_PULSE + ask->memory : 3};
    for (int k = 0; k < SPARI_PULSE; k++) {
        response_law at = bell(k);
        response->x[k] = at.x, response->v[k] = at.v / ask->run.dt, response->a[k] = at.a / (ask->run.dt * ask->run.dt);
    }
    response->load = spari_zalloc(response->count * n * n, sizeof *response->load);
    double *workspace =
        spari_zalloc(SPARI_NODE_MOTION * ask->nodes + 3 * n + 2 * response->count * n, sizeof *workspace);
    int status =
        response->load && workspace ? SPAR_OK : spari_fail(s, SPAR_ERR_MEMORY, "no memory for the fluid's response");
    status = spari_agree(s, status);
    spari_trial_settings trial_settings = {.member = NULL};
    status = status == SPAR_OK ? spari_trial_settings_create(s, &trial_settings) : status;
    if (status == SPAR_OK) {
        SPARI_VARY(trial_settings.setting, integrator.substeps, 1);
        status = run_trials(s, call, ask, &trial_settings, response, workspace);
        spari_trial_settings_free(&trial_settings);
    }
    free(workspace);
    return status;
}
