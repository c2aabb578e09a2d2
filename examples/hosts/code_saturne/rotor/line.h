/* line.h: a kernel between points of lines and the cells of the mesh, both ways: eta(r) = exp(-(r / width)^2), scaled
   so that over all cells it sums to one. */
#ifndef ROTOR_LINE_H
#define ROTOR_LINE_H

#include "cs_defs.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Velocity of the flow that the points see, by the kernel's mean over cells. Collective; the same on all ranks.
     width: in, m; n: in, points; x[n][3]: in, m; weight[n]: out, the kernel's sum over cells before it is scaled, which
     is pi^(3/2) width^3 where the mesh is fine enough; u[n][3]: out, m/s */
void line_sample(double width, int n, const double *x, double *weight, double *u);
/* Adds minus the points' forces to the source term of momentum, with the same kernel and weights.
     force[n][3]: in, N; source[cells][3]: in and out, N */
void line_spread(double width, int n, const double *x, const double *weight, const double *force, cs_real_3_t *source);

#ifdef __cplusplus
}
#endif

#endif
