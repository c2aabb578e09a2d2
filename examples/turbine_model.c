#include "turbine_model.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

/* NREL/TP-500-38060, tables 4-1, 5-1, 6-1; lengths in m, masses in kg */
const double turbine_tower_height = 87.6, turbine_hub_height = 90;
static const double tower_diameter[2] = {6.0, 3.87}, tower_wall[2] = {0.0351, 0.0247}, /* base and top */
    tower_E = 210e9, tower_G = 80.8e9, tower_density = 8500, tower_shear = 0.53;       /* shear: of a thin tube */
/* 1 % of critical at 0.32 Hz, where the first modes of tower and machine are: stress = C (strain + mu rate) */
static const double tower_damping = 2 * 0.01 / (2 * 3.14159265358979323846 * 0.32);
static const double overhang = 5.01910, shaft_height = 1.96256; /* hub along the shaft, shaft above the yaw bearing */
static const double nacelle_mass = 240000, nacelle_centre[3] = {1.9, 0, 1.75}, nacelle_yaw_inertia = 2607890;
static const double hub_mass = 56780, hub_inertia = 115926;
static const double generator_inertia = 534.116 * 97 * 97; /* kg m^2, at the rotor's side */
static const double drivetrain_spring = 867.637e6, drivetrain_damper = 6.215e6;

#define TRY(call)                                                                                                      \
    do {                                                                                                               \
        int status_ = (call);                                                                                          \
        if (status_ != SPAR_OK) {                                                                                      \
            return status_;                                                                                            \
        }                                                                                                              \
    } while (0)

/* v turned by the quaternion q */
static void rotate(const double q[4], const double v[3], double out[3]) {
    double t[3] = {q[2] * v[2] - q[3] * v[1], q[3] * v[0] - q[1] * v[2], q[1] * v[1] - q[2] * v[0]},
           u[3] = {q[2] * t[2] - q[3] * t[1], q[3] * t[0] - q[1] * t[2], q[1] * t[1] - q[2] * t[0]};
    for (int i = 0; i < 3; i++) {
        out[i] = v[i] + 2 * (q[0] * t[i] + u[i]);
    }
}

/* ---- tower ---- */

void turbine_tower_tube(double height, double *diameter, double *wall) {
    double f = height / turbine_tower_height;
    *diameter = tower_diameter[0] + f * (tower_diameter[1] - tower_diameter[0]);
    *wall = tower_wall[0] + f * (tower_wall[1] - tower_wall[0]);
}

/* The published tower: a tube at 11 stations, its properties linear between them. */
static int create_tower(turbine *t, const turbine_options *o) {
    enum { STATIONS = 11 };
    double eta[STATIONS], K[STATIONS][36] = {{0}}, M[STATIONS][36] = {{0}}, mu[6];
    const double up[4] = {sqrt(0.5), 0, -sqrt(0.5), 0}, ends[2] = {0, 1},
                 line[6] = {0, 0, 0, turbine_tower_height, 0, 0};
    for (int i = 0; i < STATIONS; i++) {
        double outer, wall;
        eta[i] = i / (STATIONS - 1.0);
        turbine_tower_tube(eta[i] * turbine_tower_height, &outer, &wall);
        double inner = outer - 2 * wall, A = pi / 4 * (outer * outer - inner * inner),
               I = pi / 64 * (pow(outer, 4) - pow(inner, 4));
        const double stiff[6] = {tower_E * A,
                                 tower_shear * tower_G * A,
                                 tower_shear * tower_G * A,
                                 2 * tower_G * I,
                                 tower_E * I,
                                 tower_E * I},
                     mass[6] = {A, A, A, 2 * I, I, I};
        for (int k = 0; k < 6; k++) {
            K[i][7 * k] = stiff[k];
            M[i][7 * k] = tower_density * mass[k];
            mu[k] = tower_damping;
        }
    }
    TRY(spar_beam_create(t->session, "tower", o->tower_elements, o->tower_nodes, &t->tower));
    TRY(spar_beam_set_axis(t->tower, 2, ends, line, NULL));
    TRY(spar_member_set_placement(t->tower, NULL, up));
    TRY(spar_beam_set_sections(t->tower, STATIONS, eta, K[0], M[0]));
    TRY(spar_beam_set_damping(t->tower, mu));
    TRY(spar_member_commit(t->tower));
    return spar_member_get_count(t->tower, &t->tower_nodes);
}

/* ---- nacelle, generator, hub ---- */

/* m, its centre c from the node, inertia J about the centre, all in the body's frame */
static void body_mass(double m, const double c[3], const double J[3], double M[36]) {
    double s[3][3] = {{0, -c[2], c[1]}, {c[2], 0, -c[0]}, {-c[1], c[0], 0}};
    memset(M, 0, 36 * sizeof *M);
    for (int i = 0; i < 3; i++) {
        M[7 * i] = m;
        M[21 + 7 * i] = J[i] + m * (c[0] * c[0] + c[1] * c[1] + c[2] * c[2]);
        for (int k = 0; k < 3; k++) {
            M[6 * (3 + i) + k] = M[6 * k + 3 + i] = m * s[i][k];
            M[6 * (3 + i) + 3 + k] -= m * c[i] * c[k];
        }
    }
}

/* Inertias that are not published, the nacelle's and the hub's about other axes, are taken like the one that is. */
static int create_bodies(turbine *t) {
    const double top[3] = {0, 0, turbine_tower_height}, zero[3] = {0}, upright[4] = {1, 0, 0, 0};
    const double level = nacelle_yaw_inertia - nacelle_mass * nacelle_centre[0] * nacelle_centre[0];
    double M[36];
    body_mass(nacelle_mass, nacelle_centre, (double[]){level, level, level}, M);
    TRY(spar_rigid_create(t->session, "nacelle", top, upright, M, &t->nacelle));
    TRY(spar_member_commit(t->nacelle));
    /* The generator's weight is in the nacelle's. Of its angular momentum the shaft carries 1/97, so that its
       gyroscopic moments are left out. */
    body_mass(0, zero, (double[]){generator_inertia, 0, 0}, M);
    TRY(spar_rigid_create(t->session, "generator", t->shaft_place, t->shaft_axes, M, &t->generator));
    TRY(spar_member_set_effects(t->generator, 0, SPAR_EFFECT_GRAVITY | SPAR_EFFECT_GYROSCOPIC));
    TRY(spar_member_commit(t->generator));
    body_mass(hub_mass, zero, (double[]){hub_inertia, hub_inertia, hub_inertia}, M);
    TRY(spar_rigid_create(t->session, "hub", t->rotor.hub, t->shaft_axes, M, &t->hub));
    return spar_member_commit(t->hub);
}

/* ---- blades and air ---- */

static int create_blades(turbine *t, const turbine_options *o) {
    t->sections = t->data.aero_n;
    t->twist = calloc((size_t)t->sections, sizeof *t->twist);
    t->place = calloc((size_t)(3 * TURBINE_BLADES * t->sections), sizeof *t->place);
    t->inflow = calloc((size_t)(3 * TURBINE_BLADES * t->sections), sizeof *t->inflow);
    if (!t->twist || !t->place || !t->inflow) {
        return SPAR_ERR_MEMORY;
    }
    for (int b = 0; b < TURBINE_BLADES; b++) {
        TRY(nrel5mw_create_blade(&t->data, &t->rotor, t->session, b, o->elements, o->nodes, &t->blade[b]));
        TRY(o->driven_roots ? SPAR_OK : spar_member_set_root(t->blade[b], SPAR_ROOT_FREE)); /* the bearing holds it */
        TRY(spar_member_commit(t->blade[b]));
        if (o->ranks < 2 || b % o->ranks == o->rank) {
            TRY(nrel5mw_create_sections(&t->data, &t->rotor, b, t->blade[b], &t->air[t->blown], t->twist));
            t->blown++;
        }
    }
    TRY(spar_member_get_count(t->blade[0], &t->blade_nodes));
    return nrel5mw_create_aero(&t->data, &t->rotor, t->blown, t->air, t->twist, &t->aero);
}

/* ---- joints ---- */

static int create_joints(turbine *t) {
    const double spring[36] = {[21] = drivetrain_spring}, damper[36] = {[21] = drivetrain_damper};
    TRY(spar_joint_create(t->session, "yaw", t->nacelle, 0, t->tower, t->tower_nodes - 1, 0, &t->yaw));
    TRY(spar_joint_create(t->session, "shaft", t->generator, 0, t->nacelle, 0, SPAR_FREE_RX, &t->shaft));
    TRY(spar_joint_set_frame(t->shaft, t->shaft_place, t->shaft_axes));
    TRY(spar_joint_create(t->session, "drivetrain", t->hub, 0, t->generator, 0, SPAR_FREE_RX, &t->drivetrain));
    TRY(spar_joint_set_frame(t->drivetrain, t->rotor.hub, t->shaft_axes));
    TRY(spar_joint_set_spring(t->drivetrain, spring, damper, NULL));
    for (int b = 0; b < TURBINE_BLADES; b++) {
        char name[32];
        double x[3], q[4];
        snprintf(name, sizeof name, "bearing%d", b + 1);
        nrel5mw_root(&t->data, &t->rotor, b, 0, x, q);
        TRY(spar_joint_create(t->session, name, t->blade[b], 0, t->hub, 0, SPAR_FREE_RX, &t->bearing[b]));
        TRY(spar_joint_set_frame(t->bearing[b], x, q));
        TRY(spar_joint_set_driven(t->bearing[b], SPAR_FREE_RX));
    }
    return SPAR_OK;
}

/* ---- the whole ---- */

/* Shaft, hub and reference pitch. */
static void place_rotor(turbine *t, const turbine_options *o) {
    nrel5mw_rotor_default(&t->data, &t->rotor);
    t->rotor.pitch = o->pitch;
    const double *n = t->rotor.axis, over[3] = {0, 0, turbine_tower_height + shaft_height}, half = 0.5 * t->data.tilt;
    for (int i = 0; i < 3; i++) {
        t->shaft_place[i] = over[i];
        t->rotor.hub[i] = over[i] - overhang * n[i];
    }
    memcpy(t->shaft_axes, (double[]){cos(half), 0, sin(half), 0}, sizeof t->shaft_axes); /* about y, x goes down */
}

int turbine_create(turbine *t, spar_session *session, const turbine_options *o) {
    *t = (turbine){.session = session};
    TRY(nrel5mw_load(&t->data, o->data));
    TRY(o->sections > 0 ? nrel5mw_resample(&t->data, o->sections) : SPAR_OK);
    place_rotor(t, o);
    if (!o->driven_roots) {
        TRY(create_tower(t, o));
        TRY(create_bodies(t));
    }
    TRY(create_blades(t, o));
    return o->driven_roots ? SPAR_OK : create_joints(t);
}

const char *turbine_message(const turbine *t) {
    return t->data.message[0] ? t->data.message : spar_session_message(t->session);
}

void turbine_free(turbine *t) {
    spar_aero_destroy(&t->aero);
    nrel5mw_free(&t->data);
    free(t->place);
    free(t->inflow);
    free(t->twist);
    *t = (turbine){0};
}

/* ---- in motion ---- */

int turbine_get_hub(const turbine *t, double x[3], double axis[3], double q[4]) {
    double motion[7];
    TRY(spar_member_get_motion(t->hub, motion, NULL, NULL));
    for (int i = 0; i < 3; i++) {
        x[i] = t->rotor.hub[i] + motion[i];
    }
    rotate(motion + 3, t->rotor.axis, axis);
    if (q) {
        memcpy(q, motion + 3, 4 * sizeof *q);
    }
    return SPAR_OK;
}

int turbine_get_shaft(const turbine *t, double *angle, double *speed, double *twist) {
    double z[6], wound[6], own[6], frame[6], hub[3], axis[3];
    TRY(spar_joint_get_motion(t->shaft, z, NULL, NULL));
    TRY(spar_joint_get_motion(t->drivetrain, wound, NULL, NULL));
    TRY(spar_member_get_motion(t->generator, NULL, own, NULL)); /* a joint has no rate before the first step */
    TRY(spar_member_get_motion(t->nacelle, NULL, frame, NULL));
    TRY(turbine_get_hub(t, hub, axis, NULL));
    *angle = z[3];
    *twist = wound[3];
    *speed = 0;
    for (int i = 0; i < 3; i++) {
        *speed += axis[i] * (own[3 + i] - frame[3 + i]);
    }
    return SPAR_OK;
}

int turbine_get_root_moment(const turbine *t, int blade, double pitch, double *out_of_plane, double *in_plane) {
    double load[6];
    TRY(spar_joint_get_load(t->bearing[blade], load));
    /* on the blade, in axes that turn with it: x along the span, y to the trailing edge, z upwind, turned by -pitch */
    double y = cos(pitch) * load[4] + sin(pitch) * load[5], z = cos(pitch) * load[5] - sin(pitch) * load[4];
    *out_of_plane = -y;
    *in_plane = z;
    return SPAR_OK;
}

int turbine_turn_blades(turbine *t, double pitch, double rate, double acceleration) {
    const double to[6] = {0, 0, 0, t->rotor.pitch - pitch}, by[6] = {0, 0, 0, -rate},
                 more[6] = {0, 0, 0, -acceleration}; /* feather: minus about the span */
    for (int b = 0; b < TURBINE_BLADES; b++) {
        TRY(spar_joint_drive(t->bearing[b], to, by, more));
    }
    return SPAR_OK;
}

int turbine_set_pitch(turbine *t, double pitch, double rate) {
    return turbine_turn_blades(t, pitch, rate, 0);
}

int turbine_brake(turbine *t, int on) {
    const double brake[36] = {[21] = 1e12}; /* N m/rad */
    return spar_joint_set_spring(t->shaft, on ? brake : NULL, NULL, NULL);
}

int turbine_set_torque(turbine *t, double torque) {
    return spar_joint_set_load(t->shaft, (double[]){0, 0, 0, -torque, 0, 0});
}

int turbine_blow(turbine *t, turbine_wind wind, void *context, double time) {
    double hub[3], axis[3], cone = cos(t->rotor.precone);
    if (t->hub) {
        TRY(turbine_get_hub(t, hub, axis, NULL));
        TRY(spar_aero_set_rotor(t->aero, hub, axis, cone * t->data.hub_radius, cone * t->data.tip_radius));
    }
    for (int b = 0; b < t->blown; b++) {
        double *place = t->place + 3 * b * t->sections, *inflow = t->inflow + 3 * b * t->sections;
        TRY(spar_fluid_pull_motion(t->air[b], 1, place, NULL));
        for (int64_t i = 0; i < t->sections; i++) {
            wind(place + 3 * i, time, context, inflow + 3 * i);
        }
    }
    return spar_aero_solve(t->aero, t->data.density, t->inflow, 1);
}

/* ---- the start ---- */

/* All that turns with the rotor does so about the shaft where it is now. */
static int spin(turbine *t, double speed) {
    double hub[3], axis[3], omega[3];
    spar_member *turning[] = {t->generator, t->hub, t->blade[0], t->blade[1], t->blade[2]};
    TRY(turbine_get_hub(t, hub, axis, NULL));
    for (int i = 0; i < 3; i++) {
        omega[i] = speed * axis[i];
    }
    for (size_t i = 0; i < sizeof turning / sizeof turning[0]; i++) {
        TRY(spar_member_set_initial_velocity(turning[i], hub, NULL, omega));
    }
    return SPAR_OK;
}

int turbine_start(turbine *t, double speed, turbine_wind wind, void *context, int rounds) {
    TRY(turbine_brake(t, 1)); /* nothing else holds the shaft at rest */
    TRY(spin(t, speed));
    for (int k = 0; k < rounds; k++) {
        TRY(turbine_blow(t, wind, context, 0));
        TRY(spar_member_solve_static(t->tower, 4));
        TRY(spin(t, speed));
    }
    TRY(turbine_brake(t, 0));
    return turbine_blow(t, wind, context, 0);
}
