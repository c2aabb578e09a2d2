#include "actuator.h"
#include "machine.h"
#include <math.h>
#include <spar/spar_coupling.h>
#include <spar/spar_structure.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

enum { SHORTEST = 64 }; /* a step is taken in so many parts at most */

int actuator_say(actuator_machine *a, int status, const char *format, ...) {
    va_list list;
    va_start(list, format);
    vsnprintf(a->message, sizeof a->message, format, list);
    va_end(list);
    return status;
}

void actuator_default(actuator_options *options) {
    *options = (actuator_options){.points = 38,
                                  .whole = 1,
                                  .nodes = 10,
                                  .rpm = 12.1,
                                  .wind = 11.4,
                                  .density = 1.225,
                                  .gravity = 9.81,
                                  .rho_inf = 0.8,
                                  .substeps = 1,
                                  .scheme = SPAR_COUPLING_IQN_ILS,
                                  .rtol = 1e-6,
                                  .iterations = 30,
                                  .accepted = 1e-3};
}

int actuator_scheme(const char *name) {
    return strcmp(name, "fixed_point") == 0 ? SPAR_COUPLING_FIXED_POINT
           : strcmp(name, "aitken") == 0    ? SPAR_COUPLING_AITKEN
           : strcmp(name, "iqn_ils") == 0   ? SPAR_COUPLING_IQN_ILS
                                            : -1;
}

int actuator_get_size(const char *data, double *diameter, double *hub_height, char message[512]) {
    nrel5mw tables;
    int status = nrel5mw_load(&tables, data);
    *diameter = 2 * tables.tip_radius;
    *hub_height = turbine_hub_height;
    memcpy(message, tables.message, sizeof tables.message);
    nrel5mw_free(&tables);
    return status;
}

/* ---- the flow ---- */

/* Loads of the blades in their latest motion, in the flow that was sampled. */
static int blow(actuator_machine *a) {
    turbine *t = &a->model;
    const int64_t n = TURBINE_BLADES * t->sections;
    const double cone = cos(t->rotor.precone);
    double hub[3], axis[3];
    if (t->hub) {
        TRY(turbine_get_hub(t, hub, axis, NULL));
        TRY(spar_aero_set_rotor(t->aero, hub, axis, cone * t->data.hub_radius, cone * t->data.tip_radius));
    }
    for (int64_t i = 0; i < n; i++) { /* into the model's frame */
        const double u = (double)a->velocity[i], v = (double)a->velocity[a->points + i];
        t->inflow[3 * i] = a->c * u + a->s * v;
        t->inflow[3 * i + 1] = -a->s * u + a->c * v;
        t->inflow[3 * i + 2] = (double)a->velocity[2 * a->points + i];
    }
    TRY(spar_aero_solve(t->aero, a->options.density, t->inflow, 1));
    return spar_aero_get_loads(t->aero, NULL, a->force, NULL);
}

/* Forces half-way through the step under way. */
static int take_half(actuator_machine *a) {
    const turbine *t = &a->model;
    for (int b = 0; b < TURBINE_BLADES; b++) { /* spar_aero wants its fluids packed: back at once */
        TRY(spar_fluid_set_layout(t->air[b], SPAR_NODES_FORCE, 1, a->points));
        int status = spar_fluid_pull_forces_f32(t->air[b], 0.5, a->half + 1 + b * t->sections);
        TRY(spar_fluid_set_layout(t->air[b], SPAR_NODES_FORCE, 3, 1));
        TRY(status);
    }
    return SPAR_OK;
}

/* ---- the turbine, made ---- */

void actuator_matrix(const double q[4], double axes[9]) {
    const double w = q[0], x = q[1], y = q[2], z = q[3];
    const double r[9] = {1 - 2 * (y * y + z * z), 2 * (x * y - w * z),     2 * (x * z + w * y),
                         2 * (x * y + w * z),     1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
                         2 * (x * z - w * y),     2 * (y * z + w * x),     1 - 2 * (x * x + y * y)};
    memcpy(axes, r, sizeof r);
}

static void uniform(const double x[3], double t, void *context, double wind[3]) {
    const actuator_options *o = &((const actuator_machine *)context)->options;
    (void)x, (void)t;
    wind[0] = o->wind * cos(o->yaw);
    wind[1] = -o->wind * sin(o->yaw);
    wind[2] = 0;
}

/* Blades at a given speed: bent and set turning. */
static int start_blades(actuator_machine *a) {
    turbine *t = &a->model;
    double omega[3];
    for (int i = 0; i < 3; i++) {
        omega[i] = a->speed * t->rotor.axis[i];
    }
    for (int round = 0; round < 4; round++) {
        for (int b = 0; b < TURBINE_BLADES; b++) {
            TRY(spar_member_set_initial_velocity(t->blade[b], t->rotor.hub, NULL, omega));
        }
        TRY(turbine_blow(t, uniform, a, 0));
        for (int b = 0; b < TURBINE_BLADES; b++) {
            TRY(spar_member_solve_static(t->blade[b], 4));
        }
    }
    for (int b = 0; b < TURBINE_BLADES; b++) {
        TRY(spar_member_set_initial_velocity(t->blade[b], t->rotor.hub, NULL, omega));
    }
    return SPAR_OK;
}

static int allocate(actuator_machine *a) {
    const size_t n = (size_t)a->model.sections, all = (size_t)TURBINE_BLADES * n;
    a->points = 1 + TURBINE_BLADES * (int)a->model.sections;
    a->force = calloc(3 * all, sizeof *a->force);
    a->half = calloc(3 * (size_t)a->points, sizeof *a->half);
    a->spread = calloc(3 * (size_t)a->points, sizeof *a->spread);
    a->axes = calloc(9 * n, sizeof *a->axes);
    const int64_t nodes = a->model.blade_nodes > a->model.tower_nodes ? a->model.blade_nodes : a->model.tower_nodes;
    a->motion = calloc(7 * (size_t)nodes, sizeof *a->motion);
    a->reference = calloc(3 * (size_t)nodes, sizeof *a->reference);
    const int good = a->force && a->half && a->spread && a->axes && a->motion && a->reference;
    return good ? SPAR_OK : actuator_say(a, SPAR_ERR_MEMORY, "no memory");
}

/* Sections that nothing is pushed to, at the places of a blade's own, whose numbers lie in AMR-Wind's arrays: single
   precision, one component behind the other, the hub's before the blades'. */
static int make_points(actuator_machine *a, int b) {
    const turbine *t = &a->model;
    const int64_t n = t->sections;
    double *work = calloc(11 * (size_t)n, sizeof *work), *eta = work;
    if (!work) {
        return actuator_say(a, SPAR_ERR_MEMORY, "no memory");
    }
    double *q = eta + n, *arm = q + 4 * n, *offset = arm + 3 * n, axes[9];
    char name[32];
    snprintf(name, sizeof name, "points%d", b + 1);
    int status = spar_fluid_get_map(t->air[b], SPAR_NODES_MOTION, eta, NULL, NULL);
    status = status ? status : spar_fluid_get_nearest(t->air[b], SPAR_NODES_MOTION, NULL, q, arm);
    for (int64_t i = 0; status == SPAR_OK && i < 3 * n; i++) {
        actuator_matrix(q + 4 * (i / 3), axes);
        for (int64_t k = 0; k < 3; k++) { /* the arm in the section's own axes, which are the matrix's columns */
            offset[i] += axes[3 * k + i % 3] * arm[3 * (i / 3) + k];
        }
    }
    status = status ? status : spar_fluid_create(t->blade[b], name, &a->point[b]);
    status = status ? status : spar_fluid_set_motion_stations(a->point[b], n, eta, offset);
    status = status ? status : spar_fluid_map(a->point[b]);
    status = status ? status : spar_fluid_set_layout(a->point[b], SPAR_NODES_MOTION, 1, a->points);
    free(work);
    return status;
}

static int describe(actuator_machine *a) {
    const actuator_options *o = &a->options;
    const turbine_options how = {.data = o->data,
                                 .elements = 1,
                                 .nodes = o->nodes,
                                 .tower_elements = 1,
                                 .tower_nodes = 8,
                                 .pitch = o->pitch,
                                 .driven_roots = !o->whole,
                                 .sections = o->points};
    TRY(spar_session_create(&a->session));
    TRY(spar_session_set_gravity(a->session, (const double[]){0, 0, -o->gravity}));
    TRY(spar_session_set_integrator(a->session, o->rho_inf, o->substeps));
    TRY(spar_session_set_coupling(a->session, o->scheme, 0, o->rtol, o->iterations));
    /* residual_is_small decides on them */
    TRY(spar_session_set_option(a->session, "coupling.unconverged", "accept"));
    TRY(spar_session_set_option(a->session, "coupling.patience", "1000000"));
    TRY(turbine_create(&a->model, a->session, &how));
    TRY(allocate(a));
    for (int b = 0; b < TURBINE_BLADES; b++) {
        TRY(make_points(a, b));
    }
    return SPAR_OK;
}

int actuator_create(const actuator_options *options, actuator_machine **out) {
    actuator_machine *a = *out = calloc(1, sizeof *a);
    if (!a) {
        return SPAR_ERR_MEMORY;
    }
    a->options = *options;
    a->speed = options->rpm * pi / 30;
    a->turned = options->downwind + options->yaw;
    a->c = cos(a->turned);
    a->s = sin(a->turned);
    if (options->points < 2 || !(options->density > 0) || !isfinite(a->speed) || !isfinite(a->turned)) {
        return actuator_say(a, SPAR_ERR_ARGUMENT,
                            "an actuator needs 2 points of a blade, a density > 0, a finite speed and direction");
    }
    if (options->scheme <= SPAR_COUPLING_EXPLICIT || options->iterations < 2 || !(options->rtol > 0) ||
        !(options->accepted >= options->rtol)) {
        return actuator_say(
            a, SPAR_ERR_ARGUMENT,
            "the coupling needs an iterated scheme, 2 iterations, a tolerance > 0, and an accepted residual "
            "of no less than the tolerance");
    }
    TRY(describe(a));
    if (options->whole) {
        TRY(turbine_start(&a->model, a->speed, uniform, a, 4));
        turbine_control_begin(&a->control, turbine_gear * a->speed, options->pitch);
    } else {
        TRY(start_blades(a));
    }
    return spar_aero_set_effects(a->model.aero, SPAR_AERO_DRAG | SPAR_AERO_MOMENT); /* the flow is the solver's now */
}

void actuator_destroy(actuator_machine **out) {
    actuator_machine *a = out ? *out : NULL;
    if (!a) {
        return;
    }
    turbine_free(&a->model);
    spar_session_destroy(&a->session);
    if (a->figures) {
        fclose(a->figures);
    }
    free(a->force);
    free(a->half);
    free(a->spread);
    free(a->axes);
    free(a->motion);
    free(a->reference);
    free(a);
    *out = NULL;
}

int actuator_get_count(const actuator_machine *a) {
    return a->points;
}

/* ---- a step ---- */

int actuator_start(actuator_machine *a, const float *velocity) {
    a->velocity = velocity;
    a->message[0] = '\0';
    TRY(blow(a));
    TRY(take_half(a));
    memcpy(a->spread, a->half, 3 * (size_t)a->points * sizeof *a->half);
    return SPAR_OK;
}

/* What is held or driven during the step. */
static int steer(actuator_machine *a, double dt) {
    turbine *t = &a->model;
    double angle, speed, twist;
    if (a->options.whole) {
        TRY(turbine_get_shaft(t, &angle, &speed, &twist));
        turbine_control_step(&a->control, turbine_gear * speed, dt);
        TRY(turbine_set_torque(t, turbine_gear * a->control.torque));
        return turbine_set_pitch(t, a->control.pitch, a->control.rate);
    }
    for (int b = 0; b < TURBINE_BLADES; b++) {
        double q[7], v[6], acceleration[6];
        nrel5mw_root_motion(&t->data, &t->rotor, b, a->angle + a->speed * dt, a->speed, 0, q, v, acceleration);
        TRY(spar_member_drive(t->blade[b], q, v, acceleration));
    }
    return SPAR_OK;
}

/* A residual above the tolerance after the last iteration is accepted if it is small: a run of a thousand ranks does
   not end for it. */
static int residual_is_small(actuator_machine *a) {
    const actuator_options *o = &a->options;
    double residual, size, t;
    TRY(spar_session_get_residual(a->session, &residual, &size));
    TRY(spar_session_get_time(a->session, &t, NULL, &a->iterations));
    if (a->iterations < o->iterations || residual <= o->rtol * size) {
        return SPAR_OK;
    }
    if (!(residual <= o->accepted * size)) {
        return actuator_say(a, SPAR_ERR_NUMERIC, "after %d iterations the loads change by %.3g N of %.3g N",
                            a->iterations, residual, size);
    }
    snprintf(a->warning, sizeof a->warning,
             "after t = %g s the loads still changed by %.3g N of %.3g N in iteration %d, the last: accepted", t,
             residual, size, a->iterations);
    return SPAR_OK;
}

static int iterate(actuator_machine *a, double dt) {
    int done = 0;
    TRY(spar_step_begin(a->session, dt));
    while (!done) {
        TRY(spar_step_solve(a->session));
        TRY(blow(a));
        TRY(spar_step_check(a->session, &done));
    }
    TRY(residual_is_small(a));
    TRY(take_half(a));
    return spar_step_accept(a->session);
}

/* ---- the balance of power ---- */

/* What the air gives, the angle that the generator has turned through and the torque it brakes with, and what is stored
   in motion, strain and weight. */
typedef struct account {
    double air, angle, torque, stored;
} account;

static int get_account(actuator_machine *a, account *out) {
    turbine *t = &a->model;
    enum { MEMBERS = 4 + TURBINE_BLADES };
    spar_member *const members[MEMBERS] = {t->tower,    t->nacelle,  t->generator, t->hub,
                                           t->blade[0], t->blade[1], t->blade[2]};
    double speed, twist, energy[SPAR_ENERGY_COUNT], audit[SPAR_AUDIT_COUNT];
    *out = (account){.torque = turbine_gear * a->control.torque};
    for (int b = 0; b < TURBINE_BLADES; b++) {
        TRY(spar_fluid_get_audit(t->air[b], SPAR_AUDIT_COUNT, audit));
        out->air += audit[SPAR_AUDIT_POWER];
    }
    for (int i = 0; i < MEMBERS; i++) {
        TRY(spar_member_get_energy(members[i], SPAR_ENERGY_COUNT, energy));
        for (int k = 0; k < SPAR_ENERGY_COUNT; k++) {
            out->stored += energy[k];
        }
    }
    return turbine_get_shaft(t, &out->angle, &speed, &twist);
}

/* J, of a step: what the air gave, less what the generator took and what is stored since. What is left has gone into
   damping, or is the error of long steps. */
static double unbalanced(const account *from, const account *to, double dt) {
    return 0.5 * (from->air + to->air) * dt - 0.5 * (from->torque + to->torque) * (to->angle - from->angle) -
           (to->stored - from->stored);
}

/* One step of spar; after a failure all is as it was. */
static int try_step(actuator_machine *a, double dt) {
    const turbine_control before = a->control;
    account from = {0}, to = {0};
    a->message[0] = '\0';
    int status = a->options.whole ? get_account(a, &from) : SPAR_OK;
    status = status ? status : steer(a, dt);
    status = status ? status : iterate(a, dt);
    if (status == SPAR_OK) {
        a->angle += a->speed * dt;
        TRY(a->options.whole ? get_account(a, &to) : SPAR_OK);
        a->unbalanced += unbalanced(&from, &to, dt);
        return SPAR_OK;
    }
    if (!a->message[0]) { /* before the reject has a message of its own */
        actuator_say(a, status, "%s", spar_session_message(a->session));
    }
    spar_step_reject(a->session);
    a->control = before;
    return status;
}

/* Parts of a step are counted in 64ths of dt. What is spread is the mean of the parts' forces: no impulse is lost. */
int actuator_step(actuator_machine *a, double dt, const float *velocity) {
    const size_t n = 3 * (size_t)a->points;
    int left = SHORTEST, part = SHORTEST;
    a->velocity = velocity;
    a->warning[0] = '\0';
    a->parts = 0;
    a->unbalanced = 0;
    memset(a->spread, 0, n * sizeof *a->spread);
    while (left > 0) {
        const int status = try_step(a, part == SHORTEST ? dt : dt * part / SHORTEST);
        if (status == SPAR_OK) {
            for (size_t i = 0; i < n; i++) {
                a->spread[i] += (float)part / SHORTEST * a->half[i];
            }
            left -= part;
            part = part < left ? part : left;
            a->parts++;
        } else if (status == SPAR_ERR_NUMERIC && part > 1) {
            part /= 2;
        } else {
            return status;
        }
    }
    a->unbalanced /= dt;
    if (a->parts > 1) {
        snprintf(a->warning, sizeof a->warning, "up to t = %g s a step of %g s was taken in %d parts",
                 actuator_get_time(a), dt, a->parts);
    }
    return SPAR_OK;
}

/* ---- what the solver asks for ---- */

void actuator_product(const double p[4], const double q[4], double out[4]) {
    out[0] = p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3];
    out[1] = p[0] * q[1] + p[1] * q[0] + p[2] * q[3] - p[3] * q[2];
    out[2] = p[0] * q[2] - p[1] * q[3] + p[2] * q[0] + p[3] * q[1];
    out[3] = p[0] * q[3] + p[1] * q[2] - p[2] * q[1] + p[3] * q[0];
}

double actuator_get_time(const actuator_machine *a) {
    double t = 0;
    spar_session_get_time(a->session, &t, NULL, NULL);
    return t;
}

/* From the model's frame to the host's. */
static void turn_out(const actuator_machine *a, double v[3]) {
    const double x = a->c * v[0] - a->s * v[1];
    v[1] = a->s * v[0] + a->c * v[1];
    v[0] = x;
}

static void turn_all(const actuator_machine *a, float *v) {
    const float c = (float)a->c, s = (float)a->s;
    float *y = v + a->points;
    for (int i = 0; a->turned != 0 && i < a->points; i++) {
        const float x = c * v[i] - s * y[i];
        y[i] = s * v[i] + c * y[i];
        v[i] = x;
    }
}

int actuator_rotor_pose(actuator_machine *a, double place[3], double turn[4]) {
    const turbine *t = &a->model;
    double axis[3];
    if (t->hub) {
        return turbine_get_hub(t, place, axis, turn);
    }
    memcpy(place, t->rotor.hub, sizeof t->rotor.hub);
    turn[0] = cos(a->angle / 2);
    for (int i = 0; i < 3; i++) {
        turn[1 + i] = sin(a->angle / 2) * t->rotor.axis[i];
    }
    return SPAR_OK;
}

/* The rows of axes are x, y, z of the host's frame. */
static void turn_axes(const actuator_machine *a, double axes[9]) {
    for (int k = 0; k < 3; k++) {
        double column[3] = {axes[k], axes[3 + k], axes[6 + k]};
        turn_out(a, column);
        axes[k] = column[0];
        axes[3 + k] = column[1];
    }
}

int actuator_get_hub(actuator_machine *a, double x[3], double omega[3], double axes[9]) {
    const turbine *t = &a->model;
    double place[3], turn[4], q[4], v[6];
    TRY(actuator_rotor_pose(a, place, turn));
    for (int i = 0; i < 3; i++) {
        v[3 + i] = a->speed * t->rotor.axis[i];
    }
    TRY(t->hub ? spar_member_get_motion(t->hub, NULL, v, NULL) : SPAR_OK);
    actuator_product(turn, t->shaft_axes, q);
    if (x) {
        memcpy(x, place, sizeof place);
        turn_out(a, x);
    }
    if (omega) {
        memcpy(omega, v + 3, 3 * sizeof *omega);
        turn_out(a, omega);
    }
    if (axes) {
        actuator_matrix(q, axes);
        turn_axes(a, axes);
    }
    return SPAR_OK;
}

int actuator_get_rotor(actuator_machine *a, double *thrust, double *torque, double *speed, double force[3]) {
    double angle, twist;
    TRY(spar_aero_get_rotor(a->model.aero, thrust, torque, NULL));
    if (speed) {
        *speed = a->speed;
        TRY(a->options.whole ? turbine_get_shaft(&a->model, &angle, speed, &twist) : SPAR_OK);
    }
    for (int k = 0; force && k < 3; k++) {
        force[k] = 0;
        for (int64_t i = 0; i < TURBINE_BLADES * a->model.sections; i++) {
            force[k] += a->force[3 * i + k];
        }
    }
    if (force) {
        turn_out(a, force);
    }
    return SPAR_OK;
}

/* A section's axes with y along the chord: turned by the aerodynamic twist that the structure's have not. */
static void turn_to_chord(const double *axes, double twist, float *out) {
    const double c = cos(twist), s = sin(twist);
    for (int k = 0; k < 3; k++) {
        out[3 * k] = (float)axes[3 * k];
        out[3 * k + 1] = (float)(c * axes[3 * k + 1] - s * axes[3 * k + 2]);
        out[3 * k + 2] = (float)(s * axes[3 * k + 1] + c * axes[3 * k + 2]);
    }
}

static int get_hub_point(actuator_machine *a, float *place, float *speed, float *orientation, float *chord) {
    double x[3], axes[9], v[6] = {0};
    TRY(actuator_get_hub(a, x, NULL, axes));
    if (a->model.hub) {
        TRY(spar_member_get_motion(a->model.hub, NULL, v, NULL));
        turn_out(a, v);
    }
    for (int k = 0; k < 3; k++) {
        if (place) {
            place[k * a->points] = (float)x[k];
        }
        if (speed) {
            speed[k * a->points] = (float)v[k];
        }
    }
    for (int i = 0; orientation && i < 9; i++) {
        orientation[i] = (float)axes[i];
    }
    if (chord) {
        chord[0] = 0;
    }
    return SPAR_OK;
}

/* Of blade b, from point `first` on. */
static int get_axes(actuator_machine *a, int b, int first, float *orientation) {
    const turbine *t = &a->model;
    TRY(spar_fluid_pull_matrices(a->point[b], 1, SPAR_MATRIX_LOCAL_TO_GLOBAL, a->axes));
    for (int64_t i = 0; i < t->sections; i++) {
        turn_axes(a, a->axes + 9 * i);
        turn_to_chord(a->axes + 9 * i, t->twist[i], orientation + 9 * (first + i));
    }
    return SPAR_OK;
}

static int get_blade_points(actuator_machine *a, int b, float *place, float *speed, float *orientation, float *chord) {
    const int n = (int)a->model.sections, first = 1 + b * n;
    TRY(spar_fluid_pull_motion_f32(a->point[b], 1, place ? place + first : NULL, speed ? speed + first : NULL));
    for (int i = 0; chord && i < n; i++) {
        chord[first + i] = (float)a->model.data.chord[i];
    }
    return orientation ? get_axes(a, b, first, orientation) : SPAR_OK;
}

int actuator_get_points(actuator_machine *a, float *place, float *sample, float *speed, float *force,
                        float *orientation, float *chord) {
    const size_t n = (size_t)a->points;
    for (int b = 0; b < TURBINE_BLADES; b++) {
        TRY(get_blade_points(a, b, place, speed, orientation, chord));
    }
    if (force) {
        memcpy(force, a->spread, 3 * n * sizeof *force);
    }
    float *const turned[] = {place, speed, force};
    for (int i = 0; i < 3; i++) {
        if (turned[i]) {
            turned[i][0] = turned[i][n] = 0; /* the hub's, which follows */
            turn_all(a, turned[i]);
        }
    }
    TRY(get_hub_point(a, place, speed, orientation, chord));
    for (size_t k = 0; place && sample && k < 3; k++) {
        memcpy(sample + k * n, place + k * n + 1, (n - 1) * sizeof *sample);
        sample[k * n + n - 1] = place[k * n];
    }
    return SPAR_OK;
}

/* ---- restart ---- */

/* What is not spar's, exactly. */
static int save_host(actuator_machine *a, const char *path, int step, double time) {
    const turbine_control *c = &a->control;
    char name[1024];
    snprintf(name, sizeof name, "%s.host", path);
    FILE *file = fopen(name, "w");
    int good = file != NULL;
    good = good && fprintf(file, "spar-actuator 1 %d %a %a %a %d\n", step, time, actuator_get_time(a), a->turned,
                           a->points) > 0;
    good =
        good && fprintf(file, "%a %a %a %a %a %a\n", c->speed, c->integral, c->pitch, c->torque, c->rate, a->angle) > 0;
    for (int i = 0; good && i < 3 * (a->points - 1); i++) {
        good = fprintf(file, "%a\n", a->force[i]) > 0;
    }
    for (int i = 0; good && i < 3 * a->points; i++) {
        good = fprintf(file, "%a\n", (double)a->spread[i]) > 0;
    }
    good = file && fclose(file) == 0 && good;
    return good ? SPAR_OK : actuator_say(a, SPAR_ERR_IO, "%s cannot be written", name);
}

/* The first line: of which step and time of the flow, and of which turbine. */
static int check_host(actuator_machine *a, const char *path, FILE *file, int step, double time) {
    int of_step, points;
    double of_time, own, turned;
    if (fscanf(file, "spar-actuator 1 %d %la %la %la %d", &of_step, &of_time, &own, &turned, &points) !=
        5) { /* NOLINT */
        return actuator_say(a, SPAR_ERR_IO, "%s.host is not the file of a turbine", path);
    }
    if (of_step != step || fabs(of_time - time) > 1e-9 * fmax(1, fabs(time))) {
        return actuator_say(
            a, SPAR_ERR_ARGUMENT,
            "%s is of step %d, t = %g s, and the flow restarts at step %d, t = %g s: give the turbine's "
            "file of that step",
            path, of_step, of_time, step, time);
    }
    if (points != a->points || fabs(turned - a->turned) > 1e-12) {
        return actuator_say(a, SPAR_ERR_ARGUMENT,
                            "%s is of a turbine with %d points that faces another way by %g degrees: restart with the "
                            "inputs of its run",
                            path, points, (turned - a->turned) * 180 / pi);
    }
    if (fabs(own - actuator_get_time(a)) > 1e-9 * fmax(1, own)) {
        return actuator_say(a, SPAR_ERR_IO,
                            "%s and %s.host are not of one step: one of them was not written to its end", path, path);
    }
    return SPAR_OK;
}

static int load_host(actuator_machine *a, const char *path, int step, double time) {
    turbine_control c = {0};
    char name[1024];
    double angle = 0;
    snprintf(name, sizeof name, "%s.host", path);
    FILE *file = fopen(name, "r");
    if (!file) {
        return actuator_say(a, SPAR_ERR_IO, "%s is not there: it belongs to %s", name, path);
    }
    const int status = check_host(a, path, file, step, time);
    int good = status == SPAR_OK &&
               fscanf(file, "%la %la %la %la %la %la", &c.speed, &c.integral, &c.pitch, &c.torque, &c.rate, /* NOLINT */
                      &angle) == 6;
    for (int i = 0; good && i < 3 * (a->points - 1); i++) {
        good = fscanf(file, "%la", &a->force[i]) == 1; /* NOLINT */
    }
    for (int i = 0; good && i < 3 * a->points; i++) {
        good = fscanf(file, "%a", &a->spread[i]) == 1; /* NOLINT */
    }
    fclose(file);
    if (!good) {
        return status ? status : actuator_say(a, SPAR_ERR_IO, "%s cannot be read to its end", name);
    }
    a->control = c;
    a->angle = angle;
    return SPAR_OK;
}

int actuator_save(actuator_machine *a, const char *path, int step, double time) {
    a->message[0] = '\0';
    TRY(spar_session_save(a->session, path));
    return save_host(a, path, step, time);
}

int actuator_load(actuator_machine *a, const char *path, int step, double time) {
    a->message[0] = '\0';
    FILE *file = fopen(path, "rb");
    if (!file) {
        return actuator_say(a, SPAR_ERR_IO, "there is no %s: step %d of the flow has no state of the turbine", path,
                            step);
    }
    fclose(file);
    TRY(spar_session_load(a->session, path));
    return load_host(a, path, step, time);
}

const char *actuator_warning(const actuator_machine *a) {
    return a->warning;
}

const char *actuator_message(const actuator_machine *a) {
    if (!a) {
        return "no memory";
    }
    const char *text = a->message[0] ? a->message : turbine_message(&a->model);
    return text[0] ? text : spar_session_message(a->session);
}
