/* AeroDyn (OpenFAST's AeroDyn-InflowWind library) as the fluid of spar's blades. It knows the library's rules: mesh
   points at the aerodynamic nodes, point loads, single precision, one dt from t = 0 on, corrections by the same step
   once more.

   The blades' own frames (spar_member_set_placement) have x along the pitch axis, y from leading to trailing edge, z =
   x cross y, as examples/nrel5mw.h makes them; their fluids are sections (spar_fluid_set_stations) at the nodes of
   AeroDyn's blade file. The library has one state for the process: one rotor, all its fluids on one rank. That state
   cannot be saved, nor go back by more than the step under way: no restart, no trials. */
#ifndef SPAR_AERODYN_H
#define SPAR_AERODYN_H

#include <spar/spar.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct spar_aerodyn spar_aerodyn;

/* A rigid part of the turbine now, global axes; q: hub: x along the shaft, downwind, z along blade 1 at azimuth 0;
   nacelle: x downwind, z up. */
typedef struct spar_aerodyn_body {
    double x[3], q[4]; /* m; unit quaternion, local to global */
    double v[6], a[6]; /* m/s, rad/s; m/s^2, rad/s^2 */
} spar_aerodyn_body;

typedef struct spar_aerodyn_options {
    const char *aerodyn_file, *inflow_file;    /* primary input files of AeroDyn and InflowWind */
    const char *output;                        /* begins the names of the files it writes */
    double gravity, density, viscosity, sound; /* m/s^2, kg/m^3, m^2/s, m/s: where the file says default */
    double dt, seconds;                        /* s: every step; how long the run is at most */
    int order;                                 /* of the library's interpolation of inputs in a step: 1 or 2 */
} spar_aerodyn_options;

/* sections[blades]: in, mapped; hub, nacelle: in the reference configuration. The fluids must outlive it. aerodyn: out,
   also after a failure, for its message; destroy it in any case. Answers a spar status. */
int spar_aerodyn_create(const spar_aerodyn_options *options, int blades, spar_fluid *const *sections,
                        const spar_aerodyn_body *hub, const spar_aerodyn_body *nacelle, spar_aerodyn **aerodyn);
void spar_aerodyn_destroy(spar_aerodyn **aerodyn);
/* Loads at t + dt of the blades as they are now, pushed: what a spar_fluid_solver does, as often as it is called.
   Before the first step, with dt = 0: loads at t = 0. After a failure the fluid is marked (spar_fluid_fail). */
int spar_aerodyn_solve(spar_aerodyn *aerodyn, double t, double dt, const spar_aerodyn_body *hub,
                       const spar_aerodyn_body *nacelle);
/* Force on all points, N, as pushed last. */
void spar_aerodyn_get_force(const spar_aerodyn *aerodyn, double force[3]);
/* The library's output channel i, 0 if there is none. */
double spar_aerodyn_get_channel(const spar_aerodyn *aerodyn, int i);
const char *spar_aerodyn_message(const spar_aerodyn *aerodyn);

#ifdef __cplusplus
}
#endif

#endif
