#include "fsi_rotor.h"
#include "nrel5mw.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

struct fsi_rotor {
    fsi_rotor_options options;
    nrel5mw data;
    nrel5mw_rotor rotor;
    double speed;
    spar_session *session;
    spar_member *hub, *blade[FSI_BLADES];
    spar_fluid *fluid[FSI_BLADES]; /* nodes and forces on the blade */
    spar_fluid *root[FSI_BLADES];  /* the same nodes on the hub, with the rest of the weight; NULL: no ramp */
    int64_t tip;                   /* node of a blade */
    double *reference[FSI_BLADES]; /* places of the nodes, [n][3] */
    int64_t n[FSI_BLADES];
    double *x, *v, *tips; /* of one blade's nodes: the hub's part; motion of its beam */
    int64_t room;
};

#define TRY(call)                                                                                                      \
    do {                                                                                                               \
        int status_ = (call);                                                                                          \
        if (status_ != SPAR_OK) {                                                                                      \
            return status_;                                                                                            \
        }                                                                                                              \
    } while (0)

/* ---- made ---- */

/* The flow does not see its mesh move within a step, so that loads do not answer the structure's motion: forces are
   taken as they come (relaxation 1), and it is the solver that says when it is enough. */
static int create_session(fsi_rotor *r) {
    const fsi_rotor_options *o = &r->options;
    TRY(o->ranks > 1 ? spar_session_create_fcomm(o->fcomm, &r->session) : spar_session_create(&r->session));
    TRY(spar_session_set_gravity(r->session, (const double[]){0, 0, -o->gravity}));
    TRY(spar_session_set_integrator(r->session, 0.8, 1));
    TRY(spar_session_set_coupling(r->session, SPAR_COUPLING_FIXED_POINT, 0, 1e-12, 100000));
    return spar_session_set_relaxation(r->session, 1);
}

static int create_members(fsi_rotor *r) {
    const fsi_rotor_options *o = &r->options;
    double omega[3];
    int64_t nodes;
    for (int i = 0; i < 3; i++) {
        omega[i] = r->speed * r->rotor.axis[i];
    }
    TRY(spar_point_create(r->session, "hub", r->rotor.hub, NULL, &r->hub));
    TRY(spar_member_commit(r->hub));
    TRY(spar_member_set_initial_velocity(r->hub, r->rotor.hub, NULL, omega));
    for (int b = 0; b < FSI_BLADES; b++) {
        char name[32];
        TRY(nrel5mw_create_blade(&r->data, &r->rotor, r->session, b, 1, o->nodes, &r->blade[b]));
        TRY(spar_member_set_owner(r->blade[b], o->ranks > 1 ? b % o->ranks : 0));
        TRY(spar_member_commit(r->blade[b]));
        TRY(spar_member_set_initial_velocity(r->blade[b], r->rotor.hub, NULL, omega));
        snprintf(name, sizeof name, "mesh%d", b + 1);
        TRY(spar_fluid_create(r->blade[b], name, &r->fluid[b]));
        snprintf(name, sizeof name, "root%d", b + 1);
        TRY(o->ramp > 0 ? spar_fluid_create(r->hub, name, &r->root[b]) : SPAR_OK);
    }
    TRY(spar_member_get_count(r->blade[0], &nodes));
    r->tip = nodes - 1;
    r->tips = calloc((size_t)(7 * nodes), sizeof *r->tips);
    return r->tips ? SPAR_OK : SPAR_ERR_MEMORY;
}

int fsi_rotor_create(const fsi_rotor_options *options, fsi_rotor **out) {
    fsi_rotor *r = *out = calloc(1, sizeof *r);
    if (!r) {
        return SPAR_ERR_MEMORY;
    }
    r->options = *options;
    TRY(nrel5mw_load(&r->data, options->data));
    nrel5mw_rotor_default(&r->data, &r->rotor);
    memcpy(r->rotor.hub, options->hub, sizeof r->rotor.hub);
    r->rotor.pitch = options->pitch;
    r->speed = options->rpm * pi / 30;
    TRY(create_session(r));
    return create_members(r);
}

void fsi_rotor_destroy(fsi_rotor **out) {
    fsi_rotor *r = out ? *out : NULL;
    if (!r) {
        return;
    }
    spar_session_destroy(&r->session);
    nrel5mw_free(&r->data);
    for (int b = 0; b < FSI_BLADES; b++) {
        free(r->reference[b]);
    }
    free(r->x);
    free(r->v);
    free(r->tips);
    free(r);
    *out = NULL;
}

/* ---- the mesh ---- */

/* The blade's weight goes from 0 at its root to 1 at the ramp's end, twice differentiable; the hub has the rest. */
static int fade(fsi_rotor *r, int b, int64_t n, const double *x) {
    double place[3], q[4], *left = calloc((size_t)n + 1, sizeof *left);
    int status = left ? SPAR_OK : SPAR_ERR_MEMORY;
    nrel5mw_root(&r->data, &r->rotor, b, 0, place, q);
    for (int64_t i = 0; i < n && status == SPAR_OK; i++) { /* the span is the root frame's first axis */
        const double axis[3] = {1 - 2 * (q[2] * q[2] + q[3] * q[3]), 2 * (q[1] * q[2] + q[0] * q[3]),
                                2 * (q[1] * q[3] - q[0] * q[2])};
        double span = 0;
        for (int k = 0; k < 3; k++) {
            span += axis[k] * (x[3 * i + k] - place[k]);
        }
        left[i] = fmax(0, r->options.ramp - span);
    }
    status = status ? status : spar_fluid_fade_motion(r->fluid[b], 0, r->options.ramp, n, left, NULL);
    status = status ? status : spar_fluid_set_motion_nodes(r->root[b], n, x);
    status = status ? status : spar_fluid_get_motion_weights(r->fluid[b], left);
    for (int64_t i = 0; i < n && status == SPAR_OK; i++) {
        left[i] = 1 - left[i];
    }
    status = status ? status : spar_fluid_set_motion_weights(r->root[b], n, left);
    status = status ? status : spar_fluid_map(r->root[b]);
    free(left);
    return status;
}

int fsi_rotor_set_mesh(fsi_rotor *r, int b, int64_t n, const double *x, int64_t m, const double *y) {
    double *kept = calloc((size_t)(3 * n) + 1, sizeof *kept);
    if (!kept) {
        return SPAR_ERR_MEMORY;
    }
    memcpy(kept, n > 0 ? x : kept, (size_t)(3 * n) * sizeof *kept);
    free(r->reference[b]);
    r->reference[b] = kept;
    r->n[b] = n;
    if (n >= r->room) {
        free(r->x);
        free(r->v);
        r->room = n + 1;
        r->x = calloc((size_t)(3 * r->room), sizeof *r->x);
        r->v = calloc((size_t)(3 * r->room), sizeof *r->v);
        if (!r->x || !r->v) {
            return SPAR_ERR_MEMORY;
        }
    }
    TRY(spar_fluid_set_motion_nodes(r->fluid[b], n, x));
    TRY(spar_fluid_set_force_nodes(r->fluid[b], m, y));
    TRY(r->root[b] ? fade(r, b, n, x) : SPAR_OK);
    return spar_fluid_map(r->fluid[b]);
}

/* X + (x_blade - X) + (x_hub - X): each has its share of the way. */
int fsi_rotor_get_motion(fsi_rotor *r, int b, double *x, double *v) {
    TRY(spar_fluid_pull_motion(r->fluid[b], 1, x, v));
    if (!r->root[b]) {
        return SPAR_OK;
    }
    TRY(spar_fluid_pull_motion(r->root[b], 1, r->x, r->v));
    for (int64_t i = 0; i < 3 * r->n[b]; i++) {
        x[i] += r->x[i] - r->reference[b][i];
        v[i] += r->v[i];
    }
    return SPAR_OK;
}

/* ---- a step ---- */

static int drive(fsi_rotor *r, double t) {
    const double angle = r->speed * t, s = sin(angle / 2), *n = r->rotor.axis;
    const double turn[7] = {0, 0, 0, cos(angle / 2), s * n[0], s * n[1], s * n[2]},
                 spin[6] = {0, 0, 0, r->speed * n[0], r->speed * n[1], r->speed * n[2]};
    TRY(spar_member_drive(r->hub, turn, spin, NULL));
    for (int b = 0; b < FSI_BLADES; b++) {
        double q[7], v[6], a[6];
        nrel5mw_root_motion(&r->data, &r->rotor, b, angle, r->speed, 0, q, v, a);
        TRY(spar_member_drive(r->blade[b], q, v, a));
    }
    return SPAR_OK;
}

int fsi_rotor_begin(fsi_rotor *r, double dt) {
    double t;
    TRY(spar_session_get_time(r->session, &t, NULL, NULL));
    TRY(drive(r, t + dt));
    TRY(spar_step_begin(r->session, dt));
    return spar_step_solve(r->session);
}

int fsi_rotor_iterate(fsi_rotor *r) {
    int done;
    TRY(spar_step_check(r->session, &done));
    return spar_step_solve(r->session);
}

int fsi_rotor_accept(fsi_rotor *r) {
    return spar_step_accept(r->session);
}

int fsi_rotor_push(fsi_rotor *r, int b, const double *force) {
    return spar_fluid_push_forces(r->fluid[b], force, NULL);
}

/* ---- what is asked for ---- */

int fsi_rotor_get_force(fsi_rotor *r, double force[3]) {
    double one[3];
    memset(force, 0, sizeof one);
    for (int b = 0; b < FSI_BLADES; b++) {
        TRY(spar_fluid_sum_loads(r->fluid[b], NULL, one, NULL));
        for (int i = 0; i < 3; i++) {
            force[i] += one[i];
        }
    }
    return SPAR_OK;
}

int fsi_rotor_get_tip(const fsi_rotor *r, int b, double x[3]) {
    TRY(spar_member_get_reference(r->blade[b], r->tips, NULL));
    memcpy(x, r->tips + 3 * r->tip, 3 * sizeof *x);
    TRY(spar_member_get_motion(r->blade[b], r->tips, NULL, NULL));
    for (int i = 0; i < 3; i++) {
        x[i] += r->tips[7 * r->tip + i];
    }
    return SPAR_OK;
}

int fsi_rotor_save(fsi_rotor *r, const char *path) {
    return spar_session_save(r->session, path);
}

int fsi_rotor_load(fsi_rotor *r, const char *path) {
    return spar_session_load(r->session, path);
}

const char *fsi_rotor_message(const fsi_rotor *r) {
    if (!r) {
        return "no memory";
    }
    return r->data.message[0] ? r->data.message : spar_session_message(r->session);
}
