/* A turbine with the meshes of its parts, which spar moves: what an adapter to a flow solver with a moving mesh needs,
   without a word of the solver. The turbine is the NREL 5-MW turbine of examples/turbine_model.h: tower, nacelle,
   drivetrain, hub, blades and controller, or blades and hub at a given rotor speed. At the root a blade's mesh blends
   into the rigid motion of the hub, so that the meshes of blades and hub fit.

   The wind blows along x, z is up. The mesh is that of the reference configuration: blade 1 up, all unbent.
   Collective over the ranks: fsi_turbine_create, _start, _begin, _iterate, _accept, _get_load, _save, _load. The other
   calls are local. Each answers a spar status. A step: fsi_turbine_begin, then fsi_turbine_push for each part and
   fsi_turbine_iterate as often as the solver likes, then fsi_turbine_accept. */
#ifndef FSI_TURBINE_H
#define FSI_TURBINE_H

#include <spar/spar.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { FSI_BLADES = 3, FSI_HUB = 3, FSI_NACELLE = 4, FSI_TOWER = 5, FSI_PARTS = 6 }; /* parts 0 to 2: the blades */

typedef struct fsi_turbine fsi_turbine;

typedef struct fsi_options {
    const char *data;  /* folder of the turbine's tables */
    int whole;         /* 1: the whole turbine; 0: blades and hub at the speed below */
    double base[3];    /* m, centre of the tower's foot */
    double rpm, pitch; /* rev/min; rad, positive towards feather: at the start, or given */
    double wind;       /* m/s along x, in which the static start finds its equilibrium; 0: start unbent, blades and hub
                          only */
    double load_ramp;  /* s, over which the loads of the flow replace those at the start; 0: at once */
    double root_ramp;  /* m of span, over which the motion goes over from the hub's to the blade's; 0: at once */
    double gravity;    /* m/s^2, downwards */
    int nodes;         /* of a blade's beam */
    int fcomm;         /* communicator as a Fortran integer, not used with one rank */
    int rank, ranks;
} fsi_options;

/* options: out, defaults; data is NULL. */
void fsi_default(fsi_options *options);
/* out: a turbine also after a failure, for its message; fsi_turbine_destroy in any case. */
int fsi_turbine_create(const fsi_options *options, fsi_turbine **out);
void fsi_turbine_destroy(fsi_turbine **turbine);
/* 1: the turbine has this part. */
int fsi_turbine_has(const fsi_turbine *turbine, int part);
/* This rank's part of a mesh.
     n, x[n][3]: in, nodes that spar moves
     m, y[m][3]: in, points that forces act on */
int fsi_turbine_set_mesh(fsi_turbine *turbine, int part, int64_t n, const double *x, int64_t m, const double *y);
/* The initial state: bent by the wind and the weight, in rotation. Not for a run that goes on by fsi_turbine_load. */
int fsi_turbine_start(fsi_turbine *turbine);
/* Predicts the loads at time t and solves the structure with them: the mesh may move there. Called again for the same t
   within the step, it leaves the structure where the last loads have put it. t: in, s */
int fsi_turbine_begin(fsi_turbine *turbine, double t);
/* Solves the structure with the loads that were pushed. */
int fsi_turbine_iterate(fsi_turbine *turbine);
int fsi_turbine_accept(fsi_turbine *turbine);
/* x[n][3], v[n][3]: out, m, m/s, of the nodes in the latest solution. */
int fsi_turbine_get_motion(fsi_turbine *turbine, int part, double *x, double *v);
/* force[m][3]: in, N, of the flow on the part. */
int fsi_turbine_push(fsi_turbine *turbine, int part, const double *force);
/* This rank cannot compute the forces: the next fsi_turbine_iterate fails on all ranks. */
int fsi_turbine_fail(fsi_turbine *turbine, int part, const char *message);
/* t: out, s, end of the last accepted step */
int fsi_turbine_get_time(const fsi_turbine *turbine, double *t);
/* force[3], moment[3]: out, N, N m about the foot of the tower, of the flow on all parts, as pushed last. */
int fsi_turbine_get_load(fsi_turbine *turbine, double force[3], double moment[3]);
/* speed: out, rad/s; pitch: out, rad; each NULL: not wanted. */
int fsi_turbine_get_rotor(const fsi_turbine *turbine, double *speed, double *pitch);
/* x: out, m, tip of a blade in the latest solution. */
int fsi_turbine_get_tip(const fsi_turbine *turbine, int blade, double x[3]);
/* Between steps. The file PATH.control has the state of the controller, which rank 0 writes and all ranks read. */
int fsi_turbine_save(fsi_turbine *turbine, const char *path);
int fsi_turbine_load(fsi_turbine *turbine, const char *path);
const char *fsi_turbine_message(const fsi_turbine *turbine);

#ifdef __cplusplus
}
#endif

#endif
