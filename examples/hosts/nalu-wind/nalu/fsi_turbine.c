#include "fsi_turbine.h"
#include "turbine_control.h"
#include "turbine_model.h"
#include <math.h>
#include <spar/spar_coupling.h>
#include <spar/spar_structure.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

typedef struct mesh {
    spar_fluid *fluid; /* nodes and forces on the member; NULL: the turbine has no such part */
    spar_fluid *root;  /* of a blade: the same nodes on the hub, with the rest of the weight; NULL: no ramp */
    int64_t n, m;
    double *x;     /* [n][3], reference positions */
    double *hub;   /* [2][n][3], positions and velocities as of the hub */
    double *force; /* [m][3] */
} mesh;

struct fsi_turbine {
    fsi_options options;
    turbine turbine;
    turbine_control control;
    double speed; /* rad/s, where it is given */
    spar_session *session;
    spar_member *hub;
    mesh mesh[FSI_PARTS];
    int stepping; /* between fsi_turbine_begin and fsi_turbine_accept, */
    double end;   /* of the step that ends at this time, s */
    double share; /* of the flow in the loads at the end of the step */
    int alone;    /* the loads are the flow's alone, and blade elements push nothing */
    double *tip;  /* motion of a blade */
    char message[256];
};

static int say(fsi_turbine *f, int status, const char *format, ...) {
    va_list list;
    va_start(list, format);
    vsnprintf(f->message, sizeof f->message, format, list);
    va_end(list);
    return status;
}

#define TRY(call)                                                                                                      \
    do {                                                                                                               \
        int status_ = (call);                                                                                          \
        if (status_ != SPAR_OK) {                                                                                      \
            return status_;                                                                                            \
        }                                                                                                              \
    } while (0)

void fsi_default(fsi_options *options) {
    *options = (fsi_options){.rpm = 12.1, .gravity = 9.81, .nodes = 10, .ranks = 1};
}

/* ---- created ---- */

static int check_options(fsi_turbine *f) {
    const fsi_options *o = &f->options;
    if (!(o->load_ramp >= 0) || !(o->root_ramp >= 0) || !(o->wind >= 0) || !isfinite(o->rpm) || !isfinite(o->pitch)) {
        return say(f, SPAR_ERR_ARGUMENT, "load ramp %g s, root ramp %g m, wind %g m/s: give numbers >= 0", o->load_ramp,
                   o->root_ramp, o->wind);
    }
    if (o->whole && !(o->wind > 0 && o->rpm > 0)) {
        return say(f, SPAR_ERR_ARGUMENT,
                   "the whole turbine starts from an equilibrium: give the wind of the start and a rotor speed, > 0");
    }
    return SPAR_OK;
}

/* The flow does not see its mesh move within a step, so loads do not answer the structure's motion: forces are taken
   as they come (relaxation 1), and the solver says when it is enough. */
static int create_session(fsi_turbine *f) {
    const fsi_options *o = &f->options;
    TRY(o->ranks > 1 ? spar_session_create_fcomm(o->fcomm, &f->session) : spar_session_create(&f->session));
    TRY(spar_session_set_gravity(f->session, (const double[]){0, 0, -o->gravity}));
    TRY(spar_session_set_integrator(f->session, 0.8, 1));
    TRY(spar_session_set_coupling(f->session, SPAR_COUPLING_FIXED_POINT, 0, 1e-12, 100000));
    return spar_session_set_relaxation(f->session, 1);
}

static int create_fluids(fsi_turbine *f) {
    static const char *const name[] = {"mesh1", "mesh2", "mesh3", "hub_mesh", "nacelle_mesh", "tower_mesh"},
                             *const root[] = {"root1", "root2", "root3"};
    const turbine *t = &f->turbine;
    spar_member *const member[] = {t->blade[0], t->blade[1], t->blade[2], f->hub, t->nacelle, t->tower};
    for (int i = 0; i < FSI_PARTS; i++) {
        TRY(member[i] ? spar_fluid_create(member[i], name[i], &f->mesh[i].fluid) : SPAR_OK);
        TRY(i < FSI_BLADES && f->options.root_ramp > 0 ? spar_fluid_create(f->hub, root[i], &f->mesh[i].root)
                                                       : SPAR_OK);
    }
    return SPAR_OK;
}

int fsi_turbine_create(const fsi_options *options, fsi_turbine **out) {
    fsi_turbine *f = *out = calloc(1, sizeof *f);
    if (!f) {
        return SPAR_ERR_MEMORY;
    }
    f->options = *options;
    f->speed = options->rpm * pi / 30;
    const turbine_options how = {.data = options->data,
                                 .elements = 1,
                                 .nodes = options->nodes,
                                 .tower_elements = 1,
                                 .tower_nodes = 8,
                                 .pitch = options->pitch,
                                 .rank = options->rank,
                                 .ranks = options->ranks,
                                 .driven_roots = !options->whole};
    TRY(check_options(f));
    TRY(create_session(f));
    TRY(turbine_create(&f->turbine, f->session, &how));
    f->hub = f->turbine.hub;
    if (!f->hub) {
        TRY(spar_point_create(f->session, "hub", f->turbine.rotor.hub, NULL, &f->hub));
        TRY(spar_member_commit(f->hub));
    }
    f->tip = calloc((size_t)(7 * f->turbine.blade_nodes), sizeof *f->tip);
    return f->tip ? create_fluids(f) : say(f, SPAR_ERR_MEMORY, "no memory");
}

void fsi_turbine_destroy(fsi_turbine **out) {
    fsi_turbine *f = out ? *out : NULL;
    if (!f) {
        return;
    }
    turbine_free(&f->turbine);
    spar_session_destroy(&f->session);
    for (int i = 0; i < FSI_PARTS; i++) {
        free(f->mesh[i].x);
        free(f->mesh[i].hub);
        free(f->mesh[i].force);
    }
    free(f->tip);
    free(f);
    *out = NULL;
}

int fsi_turbine_has(const fsi_turbine *f, int part) {
    return part >= 0 && part < FSI_PARTS && f->mesh[part].fluid;
}

/* ---- the mesh ---- */

/* The blade's weight goes from 0 at its root to 1 at the end of the ramp, twice differentiable; the hub has the rest.
 */
static int blend_root(fsi_turbine *f, int b) {
    const mesh *p = &f->mesh[b];
    double x[3], q[4], *left = calloc((size_t)p->n + 1, sizeof *left);
    if (!left) {
        return say(f, SPAR_ERR_MEMORY, "no memory");
    }
    nrel5mw_root(&f->turbine.data, &f->turbine.rotor, b, 0, x, q);
    const double axis[3] = {1 - 2 * (q[2] * q[2] + q[3] * q[3]), 2 * (q[1] * q[2] + q[0] * q[3]),
                            2 * (q[1] * q[3] - q[0] * q[2])}; /* the span is the root frame's first axis */
    for (int64_t i = 0; i < p->n; i++) {
        double span = 0;
        for (int k = 0; k < 3; k++) {
            span += axis[k] * (p->x[3 * i + k] - x[k]);
        }
        left[i] = fmax(0, f->options.root_ramp - span);
    }
    int status = spar_fluid_fade_motion(p->fluid, 0, f->options.root_ramp, p->n, left, NULL);
    status = status ? status : spar_fluid_set_motion_nodes(p->root, p->n, p->x);
    status = status ? status : spar_fluid_get_motion_weights(p->fluid, left);
    for (int64_t i = 0; i < p->n && status == SPAR_OK; i++) {
        left[i] = 1 - left[i];
    }
    status = status ? status : spar_fluid_set_motion_weights(p->root, p->n, left);
    status = status ? status : spar_fluid_map(p->root);
    free(left);
    return status;
}

/* Positions relative to the foot of the tower, where the model has its origin. */
static void to_model(const fsi_turbine *f, int64_t n, const double *x, double *out) {
    for (int64_t i = 0; i < 3 * n; i++) {
        out[i] = x[i] - f->options.base[i % 3];
    }
}

int fsi_turbine_set_mesh(fsi_turbine *f, int part, int64_t n, const double *x, int64_t m, const double *y) {
    if (!fsi_turbine_has(f, part)) {
        return say(f, SPAR_ERR_ARGUMENT, "part %d: the turbine has no such part; nacelle and tower want the whole one",
                   part);
    }
    mesh *p = &f->mesh[part];
    free(p->x);
    free(p->hub);
    free(p->force);
    p->n = n;
    p->m = m;
    p->x = calloc((size_t)(3 * n) + 1, sizeof *p->x);
    p->hub = calloc((size_t)(6 * n) + 1, sizeof *p->hub);
    p->force = calloc((size_t)(3 * m) + 1, sizeof *p->force);
    if (!p->x || !p->hub || !p->force) {
        return say(f, SPAR_ERR_MEMORY, "no memory");
    }
    to_model(f, n, x, p->x);
    to_model(f, m, y, p->force);
    TRY(spar_fluid_set_motion_nodes(p->fluid, n, p->x));
    TRY(spar_fluid_set_force_nodes(p->fluid, m, p->force));
    TRY(p->root ? blend_root(f, part) : SPAR_OK);
    return spar_fluid_map(p->fluid);
}

/* X + (x_blade - X) + (x_hub - X): each has its share of the way. */
int fsi_turbine_get_motion(fsi_turbine *f, int part, double *x, double *v) {
    mesh *p = &f->mesh[part];
    TRY(spar_fluid_pull_motion(p->fluid, 1, x, v));
    TRY(p->root ? spar_fluid_pull_motion(p->root, 1, p->hub, p->hub + 3 * p->n) : SPAR_OK);
    for (int64_t i = 0; i < 3 * p->n; i++) {
        x[i] += f->options.base[i % 3] + (p->root ? p->hub[i] - p->x[i] : 0);
        v[i] += p->root ? p->hub[3 * p->n + i] : 0;
    }
    return SPAR_OK;
}

/* ---- the start ---- */

static void uniform(const double x[3], double t, void *context, double wind[3]) {
    (void)x, (void)t;
    wind[0] = ((fsi_turbine *)context)->options.wind;
    wind[1] = wind[2] = 0;
}

/* All that turns does so about the shaft, at x along the axis. */
static int spin(fsi_turbine *f, const double x[3], const double axis[3]) {
    const turbine *t = &f->turbine;
    spar_member *const turning[] = {f->hub, t->blade[0], t->blade[1], t->blade[2], t->generator};
    double omega[3];
    for (int i = 0; i < 3; i++) {
        omega[i] = f->speed * axis[i];
    }
    for (size_t i = 0; i < sizeof turning / sizeof turning[0]; i++) {
        TRY(turning[i] ? spar_member_set_initial_velocity(turning[i], x, NULL, omega) : SPAR_OK);
    }
    return SPAR_OK;
}

int fsi_turbine_start(fsi_turbine *f) {
    const int rounds = 4; /* of loads and shape, until they agree */
    const nrel5mw_rotor *r = &f->turbine.rotor;
    if (f->options.whole) {
        double hub[3], axis[3];
        TRY(turbine_start(&f->turbine, f->speed, uniform, f, rounds));
        turbine_control_begin(&f->control, turbine_gear * f->speed, f->options.pitch);
        TRY(turbine_get_hub(&f->turbine, hub, axis, NULL));
        return spin(f, hub, axis);
    }
    TRY(spin(f, r->hub, r->axis));
    if (!(f->options.wind > 0)) {
        return SPAR_OK;
    }
    for (int k = 0; k < rounds; k++) {
        TRY(turbine_blow(&f->turbine, uniform, f, 0));
        for (int b = 0; b < FSI_BLADES; b++) {
            TRY(spar_member_solve_static(f->turbine.blade[b], 4));
        }
        TRY(spin(f, r->hub, r->axis));
    }
    return turbine_blow(&f->turbine, uniform, f, 0);
}

/* ---- a step ---- */

static int drive(fsi_turbine *f, double t) {
    const turbine *m = &f->turbine;
    const double angle = f->speed * t, s = sin(angle / 2), *n = m->rotor.axis;
    const double turn[7] = {0, 0, 0, cos(angle / 2), s * n[0], s * n[1], s * n[2]},
                 rate[6] = {0, 0, 0, f->speed * n[0], f->speed * n[1], f->speed * n[2]};
    TRY(spar_member_drive(f->hub, turn, rate, NULL));
    for (int b = 0; b < FSI_BLADES; b++) {
        double q[7], v[6], a[6];
        nrel5mw_root_motion(&m->data, &m->rotor, b, angle, f->speed, 0, q, v, a);
        TRY(spar_member_drive(m->blade[b], q, v, a));
    }
    return SPAR_OK;
}

static int steer(fsi_turbine *f, double dt) {
    double angle, speed, twist;
    TRY(turbine_get_shaft(&f->turbine, &angle, &speed, &twist));
    turbine_control_step(&f->control, turbine_gear * speed, dt);
    TRY(turbine_set_torque(&f->turbine, turbine_gear * f->control.torque));
    return turbine_set_pitch(&f->turbine, f->control.pitch, f->control.rate);
}

int fsi_turbine_begin(fsi_turbine *f, double t) {
    double now;
    TRY(spar_session_get_time(f->session, &now, NULL, NULL));
    if (f->stepping && fabs(t - f->end) <= 1e-9 * fabs(t - now)) { /* controller and pitch have made this step */
        return SPAR_OK;
    }
    if (!(t > now)) {
        return say(f, SPAR_ERR_ARGUMENT, "a step to %g s, but the structure is at %g s", t, now);
    }
    const double way = f->options.load_ramp > 0 ? fmin(t / f->options.load_ramp, 1) : 1;
    f->share = way * way * (3 - 2 * way);
    TRY(f->options.whole ? steer(f, t - now) : drive(f, t));
    TRY(spar_step_begin(f->session, t - now));
    f->stepping = 1;
    f->end = t;
    return spar_step_solve(f->session);
}

/* Blade elements in the wind of the start have the rest of the loads; their loads go with the density. */
static int push_start(fsi_turbine *f) {
    const double density = f->turbine.data.density, rest = 1 - f->share;
    if (f->alone || !(f->options.wind > 0)) {
        return SPAR_OK;
    }
    f->turbine.data.density = rest * density;
    const int status = turbine_blow(&f->turbine, uniform, f, 0);
    f->turbine.data.density = density;
    f->alone = status == SPAR_OK && !(rest > 0);
    return status;
}

int fsi_turbine_iterate(fsi_turbine *f) {
    int done;
    const int status = push_start(f); /* local: the check says the same to all ranks */
    TRY(spar_step_check(f->session, &done));
    TRY(status);
    return spar_step_solve(f->session);
}

int fsi_turbine_accept(fsi_turbine *f) {
    TRY(spar_step_accept(f->session));
    f->stepping = 0;
    return SPAR_OK;
}

int fsi_turbine_push(fsi_turbine *f, int part, const double *force) {
    mesh *p = &f->mesh[part];
    for (int64_t i = 0; i < 3 * p->m; i++) {
        p->force[i] = f->share * force[i];
    }
    return spar_fluid_push_forces(p->fluid, p->force, NULL);
}

int fsi_turbine_fail(fsi_turbine *f, int part, const char *message) {
    return spar_fluid_fail(f->mesh[part].fluid, SPAR_ERR_STATE, message);
}

/* ---- what is asked for ---- */

int fsi_turbine_get_time(const fsi_turbine *f, double *t) {
    return spar_session_get_time(f->session, t, NULL, NULL);
}

int fsi_turbine_get_load(fsi_turbine *f, double force[3], double moment[3]) {
    memset(force, 0, 3 * sizeof *force);
    memset(moment, 0, 3 * sizeof *moment);
    for (int i = 0; i < FSI_PARTS; i++) {
        double one[3] = {0}, turn[3] = {0};
        TRY(f->mesh[i].fluid ? spar_fluid_sum_loads(f->mesh[i].fluid, NULL, one, turn) : SPAR_OK);
        for (int k = 0; k < 3; k++) {
            force[k] += one[k];
            moment[k] += turn[k];
        }
    }
    return SPAR_OK;
}

int fsi_turbine_get_rotor(const fsi_turbine *f, double *speed, double *pitch) {
    double angle, now = f->speed, twist;
    TRY(f->options.whole ? turbine_get_shaft(&f->turbine, &angle, &now, &twist) : SPAR_OK);
    if (speed) {
        *speed = now;
    }
    if (pitch) {
        *pitch = f->options.whole ? f->control.pitch : f->options.pitch;
    }
    return SPAR_OK;
}

int fsi_turbine_get_tip(const fsi_turbine *f, int b, double x[3]) {
    const int64_t last = f->turbine.blade_nodes - 1;
    TRY(spar_member_get_reference(f->turbine.blade[b], f->tip, NULL));
    memcpy(x, f->tip + 3 * last, 3 * sizeof *x);
    TRY(spar_member_get_motion(f->turbine.blade[b], f->tip, NULL, NULL));
    for (int i = 0; i < 3; i++) {
        x[i] += f->tip[7 * last + i] + f->options.base[i];
    }
    return SPAR_OK;
}

/* ---- restart ---- */

static int open_control(fsi_turbine *f, const char *path, const char *how, FILE **file) {
    char name[1024];
    const int length = snprintf(name, sizeof name, "%s.control", path);
    *file = length > 0 && (size_t)length < sizeof name ? fopen(name, how) : NULL;
    return *file ? SPAR_OK : say(f, SPAR_ERR_IO, "%s.control cannot be opened", path);
}

int fsi_turbine_save(fsi_turbine *f, const char *path) {
    const turbine_control *c = &f->control;
    FILE *file;
    TRY(spar_session_save(f->session, path));
    if (!f->options.whole || f->options.rank > 0) {
        return SPAR_OK;
    }
    TRY(open_control(f, path, "w", &file));
    int good = fprintf(file, "%a %a %a %a %a\n", c->speed, c->integral, c->pitch, c->torque, c->rate) > 0;
    good = fclose(file) == 0 && good;
    return good ? SPAR_OK : say(f, SPAR_ERR_IO, "%s.control cannot be written", path);
}

static int load_control(fsi_turbine *f, const char *path) {
    turbine_control *c = &f->control;
    FILE *file;
    TRY(open_control(f, path, "r", &file));
    const int found = fscanf(file, "%la %la %la %la %la", &c->speed, &c->integral, /* NOLINT */
                             &c->pitch, &c->torque, &c->rate);
    fclose(file);
    return found == 5 ? SPAR_OK : say(f, SPAR_ERR_IO, "%s.control is not the state of a controller", path);
}

/* The file may be missing on one rank alone: all of them go through the collective call. */
int fsi_turbine_load(fsi_turbine *f, const char *path) {
    const int status = f->options.whole ? load_control(f, path) : SPAR_OK;
    const int loaded = spar_session_load(f->session, path);
    return status ? status : loaded;
}

const char *fsi_turbine_message(const fsi_turbine *f) {
    if (!f) {
        return "no memory";
    }
    return f->message[0]        ? f->message
           : f->turbine.session ? turbine_message(&f->turbine)
                                : spar_session_message(f->session);
}
