/* The calls on fluids. */
#include "fuzz.h"

#include <limits.h>
#include <stdio.h>

void do_spar_fluid_create(call *c) {
    live_fluid *at = NULL;
    for (int i = 0; i < FLUIDS && !at; i++) {
        at = c->w->fluid[i].f ? NULL : c->w->fluid + i;
    }
    if (!at) {
        return;
    }
    live_member *m = arg_member(c, -1);
    const char *name = arg_name(c, "f");
    spar_fluid *f = NULL;
    int nowhere = odd(c);
    text(c, nowhere ? ", NULL" : ", &f%d", (int)(at - c->w->fluid));
    RUN(c, spar_fluid_create(m->m, name, nowhere ? NULL : &f));
    if ((c->status == SPAR_OK) != (f != NULL)) {
        fuzz_finding("handle", "%s answers %d and %s a handle", c->what->name, c->status, f ? "writes" : "writes no");
    }
    if (f) {
        *at = (live_fluid){f, c->session, (int)(m - c->w->member), ++c->w->clock};
    }
}

void do_spar_fluid_destroy(call *c) {
    live_fluid *f = arg_fluid(c);
    c->asked = 0;
    c->session = -1;
    if (!f->f) {
        spar_fluid *none = NULL;
        int nowhere = chance(c, 50);
        RUN_VOID(c, spar_fluid_destroy(nowhere ? NULL : &none));
        return;
    }
    for (int i = 0; i < AEROS; i++) { /* a blade without its fluid: the host must not solve it any more */
        live_aero *a = c->w->aero + i;
        for (int b = 0; a->a && b < a->blades; b++) {
            if (a->busy && a->fluid[b] == (int)(f - c->w->fluid)) {
                return;
            }
            a->orphan |= a->fluid[b] == (int)(f - c->w->fluid);
        }
    }
    RUN_VOID(c, spar_fluid_destroy(&f->f));
    if (f->f) {
        fuzz_finding("handle", "a destroyed fluid's handle is not NULL");
    }
}

static void set_nodes(call *c, int (*set)(spar_fluid *fluid, int64_t n, const double *x)) {
    live_fluid *f = arg_fluid(c);
    int64_t n = chance(c, 10) ? 0 : arg_count(c, 1, 5);
    double *x = arg_reals(c, 3 * length(n), -0.3, 1.5);
    RUN(c, set(f->f, n, x));
}

void do_spar_fluid_set_motion_nodes(call *c) {
    set_nodes(c, spar_fluid_set_motion_nodes);
}

void do_spar_fluid_set_force_nodes(call *c) {
    set_nodes(c, spar_fluid_set_force_nodes);
}

static void set_sections(call *c, int (*set)(spar_fluid *fluid, int64_t n, const double *eta, const double *offset)) {
    live_fluid *f = arg_fluid(c);
    int64_t n = chance(c, 5) ? 0 : arg_count(c, 2, 4), room = length(n);
    double *eta = arg_rising(c, room, 0.05, 1), *offset = arg_reals_or_null(c, 3 * room, -0.05, 0.05);
    RUN(c, set(f->f, n, eta, offset));
}

void do_spar_fluid_set_stations(call *c) {
    set_sections(c, spar_fluid_set_stations);
}

void do_spar_fluid_set_motion_stations(call *c) {
    set_sections(c, spar_fluid_set_motion_stations);
}

void do_spar_fluid_set_motion_weights(call *c) {
    live_fluid *f = arg_fluid(c);
    int off = chance(c, 30);
    int64_t n = off ? 0 : odd(c) ? arg_count(c, 0, 5) : fluid_count(f, SPAR_NODES_MOTION);
    double *w = off ? NULL : arg_reals(c, length(n), 0, 1);
    RUN(c, spar_fluid_set_motion_weights(f->f, n, w));
}

void do_spar_fluid_get_motion_weights(call *c) {
    live_fluid *f = arg_fluid(c);
    double *w = OUT(c, fluid_count(f, SPAR_NODES_MOTION));
    RUN(c, spar_fluid_get_motion_weights(f->f, w));
}

void do_spar_fluid_fade_motion(call *c) {
    live_fluid *f = arg_fluid(c);
    double within = arg_real(c, 0, 0.3), beyond = arg_real(c, 0.3, 1);
    int64_t n = odd(c) ? arg_count(c, 0, 5) : fluid_count(f, SPAR_NODES_MOTION);
    double *distance = arg_reals_or_null(c, length(n), 0, 1);
    int held[64] = {0}, hold = chance(c, 50);
    for (int64_t i = 0; hold && i < 64; i++) {
        held[i] = chance(c, 20);
    }
    RUN(c, spar_fluid_fade_motion(f->f, within, beyond, n, distance, hold && length(n) <= 64 ? held : NULL));
}

/* By component, in records, packed; or any, which mostly overlap. */
void do_spar_fluid_set_layout(call *c) {
    live_fluid *f = arg_fluid(c);
    int which = arg_int(c, 0, 1), kind = below(c, 4);
    int64_t n = fluid_count(f, which == 1 ? SPAR_NODES_FORCE : SPAR_NODES_MOTION), node, component;
    if (kind == 0) {
        node = arg_count(c, 1, 1), component = arg_count(c, n + 1, n + 3);
    } else if (kind == 1) {
        node = arg_count(c, 3, 8), component = arg_count(c, 1, 2);
    } else {
        node = arg_count(c, kind, 3), component = arg_count(c, 1, kind);
    }
    RUN(c, spar_fluid_set_layout(f->f, which, node, component));
}

void do_spar_fluid_get_layout(call *c) {
    live_fluid *f = arg_fluid(c);
    int which = arg_int(c, 0, 1);
    int64_t *node = arg_out(c, (int64_t)sizeof *node, 1), *component = arg_out(c, (int64_t)sizeof *component, 1);
    RUN(c, spar_fluid_get_layout(f->f, which, node, component));
}

void do_spar_fluid_set_projection(call *c) {
    live_fluid *f = arg_fluid(c);
    int method = arg_int(c, SPAR_PROJECT_BOUNDED, SPAR_PROJECT_RPOLY);
    double most = chance(c, 50) ? 0 : arg_real(c, 0.1, 2);
    RUN(c, spar_fluid_set_projection(f->f, method, most));
}

void do_spar_fluid_set_interpolation(call *c) {
    live_fluid *f = arg_fluid(c);
    int kind = arg_int(c, SPAR_INTERPOLATE_NODAL, SPAR_INTERPOLATE_CONSISTENT);
    RUN(c, spar_fluid_set_interpolation(f->f, kind));
}

void do_spar_fluid_map(call *c) {
    live_fluid *f = arg_fluid(c);
    RUN(c, spar_fluid_map(f->f));
}

/* ---- what is mapped ---- */

void do_spar_fluid_get_member(call *c) {
    live_fluid *f = arg_fluid(c);
    spar_member **member = arg_out(c, (int64_t)sizeof(spar_member *), 1);
    RUN(c, spar_fluid_get_member(f->f, member));
    if (c->status == SPAR_OK && *member != c->w->member[f->member].m) {
        fuzz_finding("handle", "another member");
    }
}

void do_spar_fluid_get_name(call *c) {
    live_fluid *f = arg_fluid(c);
    RUN_VOID(c, is_name(spar_fluid_get_name(f->f)));
}

void do_spar_fluid_fail(call *c) {
    live_fluid *f = arg_fluid(c);
    int status = odd(c) ? 0 : 1 + below(c, SPAR_ERR_LIMIT);
    const char *message = arg_name(c, "why");
    RUN(c, spar_fluid_fail(f->f, status, message));
}

void do_spar_fluid_get_count(call *c) {
    live_fluid *f = arg_fluid(c);
    int which = arg_int(c, 0, 1);
    int64_t *n = arg_out(c, sizeof *n, 0);
    RUN(c, spar_fluid_get_count(f->f, which, n));
}

void do_spar_fluid_get_kind(call *c) {
    live_fluid *f = arg_fluid(c);
    int which = arg_int(c, 0, 1);
    int *kind = arg_out(c, sizeof *kind, 0);
    RUN(c, spar_fluid_get_kind(f->f, which, kind));
}

void do_spar_fluid_get_flag_count(call *c) {
    live_fluid *f = arg_fluid(c);
    int which = arg_int(c, 0, 1), flag = odd(c) ? arg_int(c, 1, 4) : 1 << below(c, 3);
    int64_t *n = arg_out(c, sizeof *n, 0);
    RUN(c, spar_fluid_get_flag_count(f->f, which, flag, n));
}

void do_spar_fluid_get_map(call *c) {
    live_fluid *f = arg_fluid(c);
    int which = arg_int(c, 0, 1);
    int64_t n = fluid_count(f, which);
    double *eta = OUT_OR_NULL(c, n), *distance = OUT_OR_NULL(c, n);
    int *flags = arg_out(c, n * (int64_t)sizeof(int), 1);
    RUN(c, spar_fluid_get_map(f->f, which, eta, distance, flags));
}

void do_spar_fluid_get_nearest(call *c) {
    live_fluid *f = arg_fluid(c);
    int which = arg_int(c, 0, 1);
    int64_t n = fluid_count(f, which);
    double *x = OUT_OR_NULL(c, 3 * n), *q = OUT_OR_NULL(c, 4 * n), *con = OUT_OR_NULL(c, 3 * n);
    RUN(c, spar_fluid_get_nearest(f->f, which, x, q, con));
}

void do_spar_fluid_get_basis(call *c) {
    live_fluid *f = arg_fluid(c);
    int which = arg_int(c, 0, 1);
    int64_t n = fluid_count(f, which), P = f->f ? c->w->member[f->member].per_element : 1;
    P = c->w->depth > 0 ? 24 : P; /* a trial may have more nodes */
    int64_t *first = arg_out(c, n * (int64_t)sizeof *first, 1);
    double *phi = OUT_OR_NULL(c, n * P);
    RUN(c, spar_fluid_get_basis(f->f, which, first, phi));
}

/* ---- pull ---- */

static double arg_theta(call *c) {
    double theta = odd(c) ? arg_real(c, 0, 1) : chance(c, 50) ? 1 : chance(c, 50) ? 0 : 0.5;
    text(c, ", %g", theta);
    return theta;
}

void do_spar_fluid_pull_motion(call *c) {
    live_fluid *f = arg_fluid(c);
    int64_t room = fluid_room(f, SPAR_NODES_MOTION);
    double theta = arg_theta(c), *x = OUT_OR_NULL(c, room), *v = OUT_OR_NULL(c, room);
    RUN(c, spar_fluid_pull_motion(f->f, theta, x, v));
}

static float *out_floats(call *c, int64_t n) {
    return arg_out(c, n * (int64_t)sizeof(float), 1);
}

void do_spar_fluid_pull_motion_f32(call *c) {
    live_fluid *f = arg_fluid(c);
    int64_t room = fluid_room(f, SPAR_NODES_MOTION);
    double theta = arg_theta(c);
    float *x = out_floats(c, room), *v = out_floats(c, room);
    RUN(c, spar_fluid_pull_motion_f32(f->f, theta, x, v));
}

void do_spar_fluid_pull_poses_f32(call *c) {
    live_fluid *f = arg_fluid(c);
    int which = arg_int(c, 0, 1);
    int64_t n = fluid_count(f, which), room = fluid_room(f, which);
    double theta = arg_theta(c);
    float *x = out_floats(c, room), *q = out_floats(c, 4 * n), *v = out_floats(c, room), *omega = out_floats(c, room),
          *accel = out_floats(c, room), *alpha = out_floats(c, room);
    RUN(c, spar_fluid_pull_poses_f32(f->f, which, theta, x, q, v, omega, accel, alpha));
}

void do_spar_fluid_pull_poses(call *c) {
    live_fluid *f = arg_fluid(c);
    int which = arg_int(c, 0, 1);
    int64_t n = fluid_count(f, which), room = fluid_room(f, which);
    double theta = arg_theta(c), *x = OUT_OR_NULL(c, room), *q = OUT_OR_NULL(c, 4 * n), *v = OUT_OR_NULL(c, room),
           *omega = OUT_OR_NULL(c, room), *accel = OUT_OR_NULL(c, room), *alpha = OUT_OR_NULL(c, room);
    RUN(c, spar_fluid_pull_poses(f->f, which, theta, x, q, v, omega, accel, alpha));
}

void do_spar_fluid_pull_matrices(call *c) {
    live_fluid *f = arg_fluid(c);
    int64_t n = fluid_count(f, SPAR_NODES_MOTION);
    double theta = arg_theta(c);
    int convention = arg_int(c, 0, 1);
    double *matrix = OUT(c, 9 * n);
    RUN(c, spar_fluid_pull_matrices(f->f, theta, convention, matrix));
}

/* The right matrices, or any. */
void do_spar_fluid_check_matrices(call *c) {
    live_fluid *f = arg_fluid(c);
    int64_t n = fluid_count(f, SPAR_NODES_MOTION);
    int convention = arg_int(c, 0, 1);
    double *matrix = arg_reals(c, 9 * n, -1, 1);
    if (f->f && matrix && chance(c, 60)) {
        (void)spar_fluid_pull_matrices(f->f, 1, convention, matrix);
    }
    RUN(c, spar_fluid_check_matrices(f->f, convention, matrix));
}

void do_spar_fluid_get_positions(call *c) {
    live_fluid *f = arg_fluid(c);
    int which = arg_int(c, 0, 1);
    int64_t n = fluid_count(f, which);
    double *x = OUT_OR_NULL(c, 3 * n), *q = OUT_OR_NULL(c, 4 * n), *v = OUT_OR_NULL(c, 3 * n),
           *nearest = OUT_OR_NULL(c, 3 * n);
    RUN(c, spar_fluid_get_positions(f->f, which, x, q, v, nearest));
}

void do_spar_fluid_get_forces(call *c) {
    live_fluid *f = arg_fluid(c);
    double *force = OUT(c, 3 * fluid_count(f, SPAR_NODES_FORCE));
    RUN(c, spar_fluid_get_forces(f->f, force));
}

void do_spar_fluid_set_states(call *c) {
    live_fluid *f = arg_fluid(c);
    int64_t width = arg_count(c, 0, 3);
    RUN(c, spar_fluid_set_states(f->f, width));
}

void do_spar_fluid_get_states(call *c) {
    live_fluid *f = arg_fluid(c);
    int64_t *width = arg_out(c, sizeof(int64_t), 1);
    double *dt = OUT_OR_NULL(c, 1);
    RUN(c, spar_fluid_get_states(f->f, width, dt));
}

/* Most often as many numbers a node as there are. */
static int64_t arg_width(call *c, const live_fluid *f) {
    int64_t width = 0;
    if (f->f) {
        (void)spar_fluid_get_states(f->f, &width, NULL);
    }
    return odd(c) ? arg_count(c, 0, 3) : width;
}

void do_spar_fluid_pull_states(call *c) {
    live_fluid *f = arg_fluid(c);
    int64_t width = arg_width(c, f);
    double *states = OUT(c, length(width) * fluid_count(f, SPAR_NODES_FORCE));
    RUN(c, spar_fluid_pull_states(f->f, width, states));
}

void do_spar_fluid_push_states(call *c) {
    live_fluid *f = arg_fluid(c);
    int64_t width = arg_width(c, f);
    double *states = arg_reals(c, length(width) * fluid_count(f, SPAR_NODES_FORCE), -1, 1);
    RUN(c, spar_fluid_push_states(f->f, width, states));
}

void do_spar_fluid_pull_forces(call *c) {
    live_fluid *f = arg_fluid(c);
    double theta = arg_theta(c), *force = OUT(c, fluid_room(f, SPAR_NODES_FORCE));
    RUN(c, spar_fluid_pull_forces(f->f, theta, force));
}

void do_spar_fluid_pull_forces_f32(call *c) {
    live_fluid *f = arg_fluid(c);
    double theta = arg_theta(c);
    float *force = arg_out(c, fluid_room(f, SPAR_NODES_FORCE) * (int64_t)sizeof(float), 0);
    RUN(c, spar_fluid_pull_forces_f32(f->f, theta, force));
}

/* ---- push ---- */

void do_spar_fluid_push_forces(call *c) {
    live_fluid *f = arg_fluid(c);
    int64_t room = fluid_room(f, SPAR_NODES_FORCE);
    double *force = arg_reals(c, room, -1, 1), *moment = arg_reals_or_null(c, room, -0.1, 0.1);
    RUN(c, spar_fluid_push_forces(f->f, force, moment));
}

void do_spar_fluid_push_forces_at(call *c) {
    live_fluid *f = arg_fluid(c);
    int64_t room = fluid_room(f, SPAR_NODES_FORCE);
    double theta = arg_theta(c), *force = arg_reals(c, room, -1, 1), *moment = arg_reals_or_null(c, room, -0.1, 0.1);
    RUN(c, spar_fluid_push_forces_at(f->f, theta, force, moment));
}

void do_spar_fluid_push_forces_f32(call *c) {
    live_fluid *f = arg_fluid(c);
    int64_t room = fluid_room(f, SPAR_NODES_FORCE);
    float *force = arg_floats(c, room, -1, 1, 0), *moment = arg_floats(c, room, -0.1, 0.1, 1);
    RUN(c, spar_fluid_push_forces_f32(f->f, force, moment));
}

void do_spar_fluid_get_projection(call *c) {
    live_fluid *f = arg_fluid(c);
    int *method = arg_out(c, (int64_t)sizeof *method, 1);
    double *max_distance = arg_out(c, (int64_t)sizeof *max_distance, 1);
    RUN(c, spar_fluid_get_projection(f->f, method, max_distance));
}

void do_spar_fluid_get_interpolation(call *c) {
    live_fluid *f = arg_fluid(c);
    int *kind = arg_out(c, (int64_t)sizeof *kind, 1);
    RUN(c, spar_fluid_get_interpolation(f->f, kind));
}

static const char *const option_keys[] = {"theta", "far", "audit", "velocity"};

void do_spar_fluid_set_option(call *c) {
    static const char *const values[][2] = {{"average", "group"}, {"take", "refuse"}, {"on", "off"}, {"pulled", "own"}},
                             *const strange[] = {"", "1", "spar%n", "ON"};
    live_fluid *f = arg_fluid(c);
    int k = below(c, 4);
    const char *key = option_keys[k], *value = values[k][below(c, 2)];
    if (odd(c)) {
        key = chance(c, 30) ? NULL : chance(c, 50) ? "fluid.theta" : option_keys[below(c, 4)];
    }
    if (odd(c)) {
        value = chance(c, 20) ? NULL : strange[below(c, 4)];
    }
    text(c, ", \"%s\", \"%s\"", key ? key : "NULL", value ? value : "NULL");
    RUN(c, spar_fluid_set_option(f->f, key, value));
}

void do_spar_fluid_get_option(call *c) {
    live_fluid *f = arg_fluid(c);
    const char *key = odd(c) ? NULL : option_keys[below(c, 4)];
    int64_t n = arg_count(c, 0, 30);
    char *into = arg_out(c, length(n), 1);
    text(c, ", \"%s\"", key ? key : "NULL");
    RUN(c, spar_fluid_get_option(f->f, key, n, into));
}

void do_spar_fluid_get_audit(call *c) {
    live_fluid *f = arg_fluid(c);
    int64_t n = arg_count(c, 0, SPAR_AUDIT_COUNT + 2);
    double *audit = OUT_OR_NULL(c, length(n));
    RUN(c, spar_fluid_get_audit(f->f, n, audit));
}

void do_spar_fluid_sum_loads(call *c) {
    live_fluid *f = arg_fluid(c);
    double *point = arg_reals_or_null(c, 3, -3, 3), *force = OUT_OR_NULL(c, 3), *moment = OUT_OR_NULL(c, 3);
    RUN(c, spar_fluid_sum_loads(f->f, point, force, moment));
}

void do_spar_fluid_check_loads(call *c) {
    live_fluid *f = arg_fluid(c);
    double *point = arg_reals_or_null(c, 3, -3, 3), *force = arg_reals_or_null(c, 3, -3, 3);
    double *moment = arg_reals_or_null(c, 3, -3, 3), rtol = arg_real(c, 1e-12, 2);
    RUN(c, spar_fluid_check_loads(f->f, point, force, moment, rtol));
}

void do_spar_fluid_get_travel(call *c) {
    live_fluid *f = arg_fluid(c);
    double *largest = OUT_OR_NULL(c, 1);
    int64_t *node = arg_out(c, (int64_t)sizeof *node, 1);
    RUN(c, spar_fluid_get_travel(f->f, largest, node));
}

void do_spar_fluid_write_vtk(call *c) {
    live_fluid *f = arg_fluid(c);
    const char *path = arg_path(c, chance(c, 50) ? ".vtu" : ".vtp");
    RUN(c, spar_fluid_write_vtk(f->f, path));
}
