/* The whole NREL 5-MW turbine as one assembly of spar: a tower (beam) on the ground, the nacelle (rigid) welded to its
   top, the shaft, the hub (rigid), and three blades (beams) on pitch bearings. Uses public functions only.

       ground - tower - nacelle = shaft (hinge) = generator = drivetrain (hinge with spring) = hub = bearings - blades

   The generator is a body of its own, with the fast shaft's inertia as the rotor feels it (gear ratio squared): between
   it and the nacelle acts its torque, between it and the hub the drivetrain's spring and damper. Wind blows along x, z
   is up, the shaft leans by the tilt. Tables: examples/data/nrel5mw (blades), the figures in turbine_model.c (all
   else). */
#ifndef TURBINE_MODEL_H
#define TURBINE_MODEL_H

#include "nrel5mw.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { TURBINE_BLADES = 3 };

typedef struct turbine_options {
    const char *data;                /* folder of the blade's tables */
    int elements, nodes;             /* of a blade; elements 0: rigid blades */
    int tower_elements, tower_nodes; /* nodes of each element */
    double pitch;                    /* rad, of the reference configuration */
    int rank, ranks;                 /* this one and their number (0: alone), which share the blades' air */
    int driven_roots;                /* 1: no tower, shaft and bearings: blades on roots driven by the host */
    int sections;                    /* aerodynamic, of a blade; 0: those of the tables */
} turbine_options;

typedef struct turbine {
    nrel5mw data;
    nrel5mw_rotor rotor;
    spar_session *session; /* the caller's */
    spar_member *tower, *nacelle, *generator, *hub, *blade[TURBINE_BLADES];
    spar_joint *yaw, *shaft, *drivetrain, *bearing[TURBINE_BLADES];
    spar_fluid *air[TURBINE_BLADES]; /* of the blades whose air is on this rank, */
    int blown;                       /* so many */
    spar_aero *aero;
    int64_t tower_nodes, blade_nodes, sections; /* tower, a blade, its aerodynamic sections */
    double shaft_place[3], shaft_axes[4];       /* of its joints in the reference: x along it, downwind */
    double *place, *inflow;                     /* [blown][sections][3] */
    double *twist; /* [sections], what their frames have not of it, as spar_aero_set_section */
} turbine;

/* Wind at a place and time, m/s. */
typedef void (*turbine_wind)(const double x[3], double t, void *context, double wind[3]);

/* What drives the published figures of the tower: outer diameter and wall at a height. */
void turbine_tower_tube(double height, double *diameter, double *wall);
extern const double turbine_tower_height, turbine_hub_height;

/* Builds it in a session that has no members yet. Returns a spar status; turbine_free in any case. */
int turbine_create(turbine *turbine, spar_session *session, const turbine_options *options);
/* What went wrong last. */
const char *turbine_message(const turbine *turbine);
void turbine_free(turbine *turbine);

/* Before the first step: bends the machine to where wind and weight would hold it with the rotor's sections turning at
   a speed (rad/s) and the brake on, and lets it go at that speed. rounds: how often loads and shape are brought
   together. */
int turbine_start(turbine *turbine, double speed, turbine_wind wind, void *context, int rounds);
/* Angle (rad, with its turns) and speed (rad/s) of the generator at the rotor's side, the twist of the drivetrain. */
int turbine_get_shaft(const turbine *turbine, double *angle, double *speed, double *twist);
/* At the end of the step begun next: pitch of all blades, rad, positive towards feather, and its rate. */
int turbine_set_pitch(turbine *turbine, double pitch, double rate);
/* The same where the rate changes smoothly: with its derivative. */
int turbine_turn_blades(turbine *turbine, double pitch, double rate, double acceleration);
/* The brake on the shaft: a spring that holds it where it is in the reference. on 0: off. */
int turbine_brake(turbine *turbine, int on);
/* From now on: the generator's torque at the rotor's side, N m, positive where it brakes. */
int turbine_set_torque(turbine *turbine, double torque);
/* Aerodynamic loads of the blades in their latest motion, in the wind at time t. */
int turbine_blow(turbine *turbine, turbine_wind wind, void *context, double t);
/* Moments at a blade's root, N m, at a pitch: out of the rotor's plane, positive bending downwind, and in it, positive
   about the shaft. */
int turbine_get_root_moment(const turbine *turbine, int blade, double pitch, double *out_of_plane, double *in_plane);
/* Hub now: place of its centre, and the rotor's axis. */
int turbine_get_hub(const turbine *turbine, double x[3], double axis[3], double q[4]);

#ifdef __cplusplus
}
#endif

#endif
