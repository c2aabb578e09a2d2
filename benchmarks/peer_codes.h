/* One beam, or blades that turn about one hub, moved by spar and by published codes installed here: the description is
   spar's, and what the others read is written from the member that spar made of it. */
#ifndef PEER_CODES_H
#define PEER_CODES_H

#include <spar/spar.h>

/* One element a blade. Blades lie along x from the hub, which turns about y; weight and force point
   along z. The first blade's tip is looked at, from the frame that turns with the hub. Smoothly: force and speed grow
   with sin^2 from nothing to all at the end, so that an error of second order is one; else they are there at once. */
typedef struct peer_scene {
    int (*describe)(spar_member *beam, const void *of); /* axis of three points and more, sections, damping */
    const void *of;
    int nodes, rule, points; /* quadrature, as spar_beam_set_quadrature takes it */
    int refine;              /* BeamDyn's trapezoids between two stations; 0: Gauss points, as many as nodes */
    int blades;
    double hub, turning; /* m, rad/s; 0: a clamped beam */
    double gravity;      /* m/s^2 */
    double force;        /* N, on each tip */
    double end;          /* s */
    double rho_inf;      /* spectral radius at infinite frequency */
    int joints;          /* spar's roots are free, on joints to the ground that drive them */
    int smoothly;
} peer_scene;

/* A run: microseconds of processor time a step, and the tip's deflection at the end. */
typedef struct peer_run {
    double us, u[3];
} peer_run;

/* Newton ends at atol + rtol |x|; BeamDyn knows one number, its stop_tol, which is atol here. */
typedef struct peer_tolerance {
    double atol, rtol;
} peer_tolerance;

typedef struct peer_code {
    const char *name, *missing;
    int (*here)(void);
    int (*run)(const peer_scene *scene, int steps, peer_tolerance t, peer_run *r); /* 0, or 1: it failed */
} peer_code;

enum { PEER_CODES = 3 };
extern const peer_code peer_codes[PEER_CODES]; /* spar the first */

/* Where peers_kynema is; makes a folder for files, that the last call removes again. Returns 0, or 1. */
int peer_codes_begin(const char *program);
void peer_codes_end(void);

#endif
