#include "actuator.h"
#include "turbine_control.h"
#include "turbine_model.h"
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

struct actuator_machine {
    actuator_options options;
    spar_session *session;
    turbine turbine;
    turbine_control control;
    double angle, speed; /* of the rotor where they are given */
    const float *velocity;
    int points;
    double *force;                     /* [blades][sections][3], at the end of the step */
    float *half;                       /* [3][points], half-way through it */
    double *axes;                      /* of a blade's sections */
    spar_fluid *point[TURBINE_BLADES]; /* the sections once more, for AMR-Wind's arrays by component */
    char message[256];
};

static int say(actuator_machine *a, int status, const char *format, ...) {
    va_list list;
    va_start(list, format);
    vsnprintf(a->message, sizeof a->message, format, list);
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

void actuator_default(actuator_options *options) {
    *options = (actuator_options){.points = 38,
                                  .whole = 1,
                                  .nodes = 10,
                                  .rpm = 12.1,
                                  .wind = 11.4,
                                  .density = 1.225,
                                  .gravity = 9.81,
                                  .rho_inf = 0.8,
                                  .substeps = 1};
}

/* ---- the flow ---- */

/* Loads of the blades in their latest motion, in the flow that was sampled; half: those half-way through the step too.
 */
static int blow(actuator_machine *a) {
    turbine *t = &a->turbine;
    const int64_t n = t->sections;
    const double cone = cos(t->rotor.precone);
    double hub[3], axis[3];
    if (t->hub) {
        TRY(turbine_get_hub(t, hub, axis, NULL));
        TRY(spar_aero_set_rotor(t->aero, hub, axis, cone * t->data.hub_radius, cone * t->data.tip_radius));
    }
    for (int64_t i = 0; i < TURBINE_BLADES * n; i++) {
        for (int64_t k = 0; k < 3; k++) {
            t->inflow[3 * i + k] = (double)a->velocity[k * a->points + 1 + i];
        }
    }
    TRY(spar_aero_solve(t->aero, a->options.density, t->inflow, 1));
    TRY(spar_aero_get_loads(t->aero, NULL, a->force, NULL));
    for (int b = 0; b < TURBINE_BLADES; b++) { /* spar_aero wants its fluids packed: back at once */
        TRY(spar_fluid_set_layout(t->air[b], SPAR_NODES_FORCE, 1, a->points));
        int status = spar_fluid_pull_forces_f32(t->air[b], 0.5, a->half + 1 + b * n);
        TRY(spar_fluid_set_layout(t->air[b], SPAR_NODES_FORCE, 3, 1));
        TRY(status);
    }
    return SPAR_OK;
}

static int solve_flow(spar_session *session, double t, double dt, int iteration, void *context) {
    (void)session, (void)t, (void)dt, (void)iteration;
    return blow(context);
}

/* ---- the turbine, made ---- */

static void matrix(const double q[4], double axes[9]) {
    const double w = q[0], x = q[1], y = q[2], z = q[3];
    const double r[9] = {1 - 2 * (y * y + z * z), 2 * (x * y - w * z),     2 * (x * z + w * y),
                         2 * (x * y + w * z),     1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
                         2 * (x * z - w * y),     2 * (y * z + w * x),     1 - 2 * (x * x + y * y)};
    memcpy(axes, r, sizeof r);
}

static void uniform(const double x[3], double t, void *context, double wind[3]) {
    (void)x, (void)t;
    wind[0] = ((actuator_machine *)context)->options.wind;
    wind[1] = wind[2] = 0;
}

/* Blades at a given speed: bent and set turning. */
static int start_blades(actuator_machine *a) {
    turbine *t = &a->turbine;
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
    const size_t n = (size_t)a->turbine.sections, all = (size_t)TURBINE_BLADES * n;
    a->points = 1 + TURBINE_BLADES * (int)a->turbine.sections;
    a->force = calloc(3 * all, sizeof *a->force);
    a->half = calloc(3 * (size_t)a->points, sizeof *a->half);
    a->axes = calloc(9 * n, sizeof *a->axes);
    return a->force && a->half && a->axes ? SPAR_OK : say(a, SPAR_ERR_MEMORY, "no memory");
}

/* Sections that nothing is pushed to, at the places of a blade's own, whose numbers lie in AMR-Wind's arrays: single
   precision, one component behind the other, the hub's before the blades'. */
static int make_points(actuator_machine *a, int b) {
    const turbine *t = &a->turbine;
    const int64_t n = t->sections;
    double *work = calloc(11 * (size_t)n, sizeof *work), *eta = work;
    if (!work) {
        return say(a, SPAR_ERR_MEMORY, "no memory");
    }
    double *q = eta + n, *arm = q + 4 * n, *offset = arm + 3 * n, axes[9];
    char name[32];
    snprintf(name, sizeof name, "points%d", b + 1);
    int status = spar_fluid_get_map(t->air[b], SPAR_NODES_MOTION, eta, NULL, NULL);
    status = status ? status : spar_fluid_get_nearest(t->air[b], SPAR_NODES_MOTION, NULL, q, arm);
    for (int64_t i = 0; status == SPAR_OK && i < 3 * n; i++) {
        matrix(q + 4 * (i / 3), axes);
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
    TRY(spar_session_set_coupling(a->session, SPAR_COUPLING_FIXED_POINT, 0, 1e-6, 30));
    TRY(turbine_create(&a->turbine, a->session, &how));
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
    if (options->points < 2 || !(options->density > 0) || !isfinite(a->speed)) {
        return say(a, SPAR_ERR_ARGUMENT, "an actuator wants 2 points of a blade, a density and a speed");
    }
    TRY(describe(a));
    if (options->whole) {
        TRY(turbine_start(&a->turbine, a->speed, uniform, a, 4));
        turbine_control_begin(&a->control, turbine_gear * a->speed, options->pitch);
    } else {
        TRY(start_blades(a));
    }
    return spar_aero_set_effects(a->turbine.aero, SPAR_AERO_DRAG | SPAR_AERO_MOMENT); /* the flow is the solver's now */
}

void actuator_destroy(actuator_machine **out) {
    actuator_machine *a = out ? *out : NULL;
    if (!a) {
        return;
    }
    turbine_free(&a->turbine);
    spar_session_destroy(&a->session);
    free(a->force);
    free(a->half);
    free(a->axes);
    free(a);
    *out = NULL;
}

int actuator_get_count(const actuator_machine *a) {
    return a->points;
}

/* ---- a step ---- */

int actuator_start(actuator_machine *a, const float *velocity) {
    a->velocity = velocity;
    return blow(a);
}

/* What is held or driven during the step. */
static int steer(actuator_machine *a, double dt) {
    turbine *t = &a->turbine;
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

int actuator_step(actuator_machine *a, double dt, const float *velocity) {
    const turbine_control before = a->control;
    a->velocity = velocity;
    int status = steer(a, dt);
    status = status ? status : spar_step(a->session, dt, solve_flow, a, NULL);
    if (status != SPAR_OK) {
        a->control = before;
        return status;
    }
    a->angle += a->speed * dt;
    return SPAR_OK;
}

/* ---- what the solver asks for ---- */

static void product(const double p[4], const double q[4], double out[4]) {
    out[0] = p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3];
    out[1] = p[0] * q[1] + p[1] * q[0] + p[2] * q[3] - p[3] * q[2];
    out[2] = p[0] * q[2] - p[1] * q[3] + p[2] * q[0] + p[3] * q[1];
    out[3] = p[0] * q[3] + p[1] * q[2] - p[2] * q[1] + p[3] * q[0];
}

int actuator_get_hub(actuator_machine *a, double x[3], double omega[3], double axes[9]) {
    const turbine *t = &a->turbine;
    double place[3], axis[3], turn[4], q[4], v[6];
    memcpy(place, t->rotor.hub, sizeof place);
    turn[0] = cos(a->angle / 2);
    for (int i = 0; i < 3; i++) {
        turn[1 + i] = sin(a->angle / 2) * t->rotor.axis[i];
        v[3 + i] = a->speed * t->rotor.axis[i];
    }
    if (t->hub) {
        TRY(turbine_get_hub(t, place, axis, turn));
        TRY(spar_member_get_motion(t->hub, NULL, v, NULL));
    }
    product(turn, t->shaft_axes, q);
    if (x) {
        memcpy(x, place, sizeof place);
    }
    if (omega) {
        memcpy(omega, v + 3, 3 * sizeof *omega);
    }
    if (axes) {
        matrix(q, axes);
    }
    return SPAR_OK;
}

int actuator_get_rotor(actuator_machine *a, double *thrust, double *torque, double *speed, double force[3]) {
    double angle, twist;
    TRY(spar_aero_get_rotor(a->turbine.aero, thrust, torque, NULL));
    if (speed) {
        *speed = a->speed;
        TRY(a->options.whole ? turbine_get_shaft(&a->turbine, &angle, speed, &twist) : SPAR_OK);
    }
    for (int k = 0; force && k < 3; k++) {
        force[k] = 0;
        for (int64_t i = 0; i < TURBINE_BLADES * a->turbine.sections; i++) {
            force[k] += a->force[3 * i + k];
        }
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
    if (a->turbine.hub) {
        TRY(spar_member_get_motion(a->turbine.hub, NULL, v, NULL));
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
    const turbine *t = &a->turbine;
    TRY(spar_fluid_pull_matrices(a->point[b], 1, SPAR_MATRIX_LOCAL_TO_GLOBAL, a->axes));
    for (int64_t i = 0; i < t->sections; i++) {
        turn_to_chord(a->axes + 9 * i, t->twist[i], orientation + 9 * (first + i));
    }
    return SPAR_OK;
}

int actuator_get_points(actuator_machine *a, float *place, float *speed, float *force, float *orientation,
                        float *chord) {
    const turbine *t = &a->turbine;
    const int n = (int)t->sections;
    TRY(get_hub_point(a, place, speed, orientation, chord));
    if (force) {
        memcpy(force, a->half, 3 * (size_t)a->points * sizeof *force);
    }
    for (int b = 0; b < TURBINE_BLADES; b++) {
        const int first = 1 + b * n;
        TRY(spar_fluid_pull_motion_f32(a->point[b], 1, place ? place + first : NULL, speed ? speed + first : NULL));
        TRY(orientation ? get_axes(a, b, first, orientation) : SPAR_OK);
        for (int i = 0; chord && i < n; i++) {
            chord[first + i] = (float)t->data.chord[i];
        }
    }
    return SPAR_OK;
}

/* ---- restart ---- */

/* What is not spar's, exactly. */
static int save_host(actuator_machine *a, const char *path) {
    const turbine_control *c = &a->control;
    char name[1024];
    snprintf(name, sizeof name, "%s.host", path);
    FILE *file = fopen(name, "w");
    int good = file != NULL;
    good =
        good && fprintf(file, "%a %a %a %a %a %a\n", c->speed, c->integral, c->pitch, c->torque, c->rate, a->angle) > 0;
    for (int i = 0; good && i < 3 * (a->points - 1); i++) {
        good = fprintf(file, "%a\n", a->force[i]) > 0;
    }
    for (int i = 0; good && i < 3 * a->points; i++) {
        good = fprintf(file, "%a\n", (double)a->half[i]) > 0;
    }
    good = file && fclose(file) == 0 && good;
    return good ? SPAR_OK : say(a, SPAR_ERR_IO, "%s cannot be written", name);
}

static int load_host(actuator_machine *a, const char *path) {
    turbine_control c = {0};
    char name[1024];
    double angle = 0;
    snprintf(name, sizeof name, "%s.host", path);
    FILE *file = fopen(name, "r");
    int good = file &&
               fscanf(file, "%la %la %la %la %la %la", &c.speed, &c.integral, &c.pitch, &c.torque, &c.rate, /* NOLINT */
                      &angle) == 6;
    for (int i = 0; good && i < 3 * (a->points - 1); i++) {
        good = fscanf(file, "%la", &a->force[i]) == 1; /* NOLINT */
    }
    for (int i = 0; good && i < 3 * a->points; i++) {
        good = fscanf(file, "%a", &a->half[i]) == 1; /* NOLINT */
    }
    if (file) {
        fclose(file);
    }
    if (!good) {
        return say(a, SPAR_ERR_IO, "%s cannot be read, or is another turbine's", name);
    }
    a->control = c;
    a->angle = angle;
    return SPAR_OK;
}

int actuator_save(actuator_machine *a, const char *path) {
    TRY(spar_session_save(a->session, path));
    return save_host(a, path);
}

int actuator_load(actuator_machine *a, const char *path) {
    TRY(spar_session_load(a->session, path));
    return load_host(a, path);
}

const char *actuator_message(const actuator_machine *a) {
    if (!a) {
        return "no memory";
    }
    const char *text = a->message[0] ? a->message : turbine_message(&a->turbine);
    return text[0] ? text : spar_session_message(a->session);
}
