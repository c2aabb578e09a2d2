/* A turbine of spar as the actuator lines of a flow solver, without a word of the solver: the NREL 5-MW turbine of
   examples/turbine_model.h (tower, nacelle, shaft, pitch bearings and controller, or blades at a given speed), forces
   by blade elements in the flow that the solver has sampled at the points, without momentum theory: the induced flow is
   in the solver's. One process; no MPI.

   Points: the hub and the sections of the blades, one blade after the other. Forces and what goes with them have the
   hub first. Velocities are sampled with the hub last: AMR-Wind's filtered lifting line correction takes the first
   points as those of blade 1. Arrays are those of AMR-Wind's ExternalTurbine: single precision, by component (x of all
   points, y, z), positions relative to the tower's base, z up. */
#ifndef SPAR_ACTUATOR_H
#define SPAR_ACTUATOR_H

#include <spar/spar.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct actuator_machine actuator_machine;

typedef struct actuator_options {
    const char *data;  /* folder of the turbine's tables */
    int points;        /* of a blade */
    int whole;         /* 1: tower, shaft, controller; 0: blades whose roots turn at the given speed */
    int nodes;         /* of a blade's beam */
    double rpm, pitch; /* rev/min; rad, positive towards feather: at the start, or given */
    double wind;       /* m/s: what the turbine is bent by before the first step */
    double downwind;   /* rad from x, counter-clockwise seen from above: where that wind goes */
    double yaw;        /* rad, counter-clockwise seen from above: of the nacelle, from facing that wind */
    double density;    /* kg/m^3, the flow's */
    double gravity;    /* m/s^2, downwards */
    double rho_inf;    /* of the integrator */
    int substeps;      /* of the structure in a step of the flow */
    int scheme;        /* SPAR_COUPLING_*, iterated: of structure and blade elements in a step, the flow held */
    double rtol;       /* of its loads */
    int iterations;    /* at most */
    double accepted;   /* relative residual that is accepted, with a warning, after so many iterations */
} actuator_options;

/* options: out, the NREL 5-MW turbine at rated wind but for data. */
void actuator_default(actuator_options *options);
/* SPAR_COUPLING_* by its name (fixed_point, aitken, iqn_ils), -1: none of them. */
int actuator_scheme(const char *name);
/* Of the turbine whose tables are in a folder. diameter, hub_height: out, m. message[512]: out, why not. */
int actuator_get_size(const char *data, double *diameter, double *hub_height, char message[512]);
/* The turbine at t = 0, bent. Returns a spar status; actuator_destroy in any case. */
int actuator_create(const actuator_options *options, actuator_machine **out);
void actuator_destroy(actuator_machine **a);
int actuator_get_count(const actuator_machine *a);
/* Forces at t = 0 in the flow there: velocity[3][points], m/s, the hub last. */
int actuator_start(actuator_machine *a, const float *velocity);
/* From t^n to t^n + dt in the flow as it was sampled at the points at t^n, the hub last. Structure and blade elements
   agree at the end of the step; the flow is held. A step that fails is taken in parts, down to dt/64, before the
   failure is the caller's. */
int actuator_step(actuator_machine *a, double dt, const float *velocity);
/* Points now, each NULL: not wanted. place[3][points], m; sample[3][points]: the same, the hub last; speed[3][points],
   m/s; chord[points], m; orientation[points][9]: local to global, row by row; x along the span, y to the trailing edge
   (hub: x along the shaft, downwind). force[3][points]: N, on the blades, half-way through the last step (the mean of
   those at its ends): they belong half-way between the positions before and after it. The hub's is 0. */
int actuator_get_points(actuator_machine *a, float *place, float *sample, float *speed, float *force,
                        float *orientation, float *chord);
/* Each NULL: not wanted. x[3]: m; omega[3]: rad/s; axes[9]: as an orientation. */
int actuator_get_hub(actuator_machine *a, double x[3], double omega[3], double axes[9]);
/* Of the last forces. Each NULL: not wanted. thrust: N along the shaft; torque: N m about it; speed: of the rotor,
   rad/s; force[3]: their sum at the end of the step, N. */
int actuator_get_rotor(actuator_machine *a, double *thrust, double *torque, double *speed, double force[3]);
/* s, of spar's clock, which begins at 0 with the turbine. */
double actuator_get_time(const actuator_machine *a);
/* The whole state, between steps: path, and path.host beside it, with the flow's step and time (s). Load refuses
   another step or time, or another turbine. */
int actuator_save(actuator_machine *a, const char *path, int step, double time);
int actuator_load(actuator_machine *a, const char *path, int step, double time);
/* The turbine's figures, a line per call of write. Columns and units stand in the first line. Begin touches no file:
   the first call of write opens it, so that a run that ends before has changed nothing. keep = 0: a new file with the
   figures at begin as its first line; a file at that path is kept aside, as path.1, path.2, ... keep = 1: the lines of
   the file at that path up to this time stay, and those after it go. */
int actuator_begin_figures(actuator_machine *a, const char *path, int keep, int step, double time);
int actuator_write_figures(actuator_machine *a, int step, double time);
/* Figures by their column's name, e.g. "thrust_N". */
int actuator_get_figure(actuator_machine *a, const char *column, double *value);
/* What the last call of actuator_step had to do to go on; "" where it was nothing. */
const char *actuator_warning(const actuator_machine *a);
const char *actuator_message(const actuator_machine *a);

#ifdef __cplusplus
}
#endif

#endif
