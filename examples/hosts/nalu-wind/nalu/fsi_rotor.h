/* A rotor of flexible blades at a given speed, with a volume mesh around each blade that spar moves: what an adapter to
   a flow solver with a moving mesh needs, without a word of the solver. The blades are those of the NREL 5-MW turbine
   (examples/nrel5mw.h); at the root their motion fades into the hub's rigid one, so that the meshes of blades and hub
   fit.

   Collective over the ranks but for fsi_rotor_set_mesh, _get_motion, _push; each answers a spar status. A step:
   fsi_rotor_begin, then fsi_rotor_push on each blade and fsi_rotor_iterate as often as the solver likes,
   fsi_rotor_accept. */
#ifndef FSI_ROTOR_H
#define FSI_ROTOR_H

#include <spar/spar.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { FSI_BLADES = 3 };

typedef struct fsi_rotor fsi_rotor;

typedef struct fsi_rotor_options {
    const char *data;  /* folder of the turbine's tables */
    double rpm, pitch; /* rev/min; rad, positive towards feather */
    double hub[3];     /* m, where the blades' axes meet */
    double ramp;       /* m of span, over which the motion fades from the hub's to the blade's; 0: not at all */
    double gravity;    /* m/s^2, downwards */
    int nodes;         /* of a blade's beam */
    int fcomm, ranks;  /* the communicator as a Fortran integer, unused with one rank */
} fsi_rotor_options;

int fsi_rotor_create(const fsi_rotor_options *options, fsi_rotor **out);
void fsi_rotor_destroy(fsi_rotor **rotor);
/* This rank's part of the mesh around a blade (0 to 2), in the reference configuration: blade 0 upright, unbent.
     n, x[n][3]: in, nodes that are moved
     m, y[m][3]: in, points that forces come from */
int fsi_rotor_set_mesh(fsi_rotor *rotor, int blade, int64_t n, const double *x, int64_t m, const double *y);
/* Loads are predicted for t^n + dt, the structure is solved: the mesh may go there. */
int fsi_rotor_begin(fsi_rotor *rotor, double dt);
/* The structure anew with the forces that were pushed. */
int fsi_rotor_iterate(fsi_rotor *rotor);
int fsi_rotor_accept(fsi_rotor *rotor);
/* x[n][3], v[n][3]: out, places and velocities of the nodes in the latest solution. */
int fsi_rotor_get_motion(fsi_rotor *rotor, int blade, double *x, double *v);
/* force[m][3]: in, N, on the blade. */
int fsi_rotor_push(fsi_rotor *rotor, int blade, const double *force);
/* force[3]: out, N, pushed on all blades and ranks. */
int fsi_rotor_get_force(fsi_rotor *rotor, double force[3]);
/* Tip of a blade in the latest solution, m. */
int fsi_rotor_get_tip(const fsi_rotor *rotor, int blade, double x[3]);
int fsi_rotor_save(fsi_rotor *rotor, const char *path);
int fsi_rotor_load(fsi_rotor *rotor, const char *path);
const char *fsi_rotor_message(const fsi_rotor *rotor);

#ifdef __cplusplus
}
#endif

#endif
