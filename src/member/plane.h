/* Beams held in a plane (spar_beam_set_plane): displacements along the normal and rotations about axes in the plane are
   constrained. The unknowns stay six a node: forces lose what the plane holds, and so do the rows and columns of the
   tangent, which has stiffnesses of its own there. */
#ifndef SPARI_PLANE_H
#define SPARI_PLANE_H

#include "structure.h"

/* The unit normal, or NULL. */
const double *spari_member_plane(const spar_member *member);
/* Zeros what the member's constraints hold, of forces on its unique nodes, r [unique][6]: the root and the plane. */
void spari_member_constrain(const spar_member *member, int64_t unique, double *r);
/* x [n][6], forces and moments or motions: removes what is out of the plane. */
void spari_plane_project(const double normal[3], int64_t n, double *x);
/* S [n][6][n][6] := P S P + c (1 - P), P the projection, c as large as the diagonal. */
void spari_plane_tangent(const double normal[3], int n, double *S);
/* Checks a motion of the root, q (displacement and quaternion), v, a; NULL: none. SPAR_ERR_ARGUMENT: it leaves the
   plane by more than rounding, which is removed otherwise. */
int spari_plane_take(const spar_member *member, const char *caller, double q[7], double v[6], double a[6]);

/* Modes have three unknowns a node: two displacements in the plane, and the rotation. reduce: S [n][6][n][6] to
   [n][3][n] [3], in place. collect, spread: vectors [n][6] to [n][3], and back. */
void spari_plane_reduce(const double normal[3], int n, double *S);
void spari_plane_collect(const double normal[3], int64_t n, const double *x, double *y);
void spari_plane_spread(const double normal[3], int64_t n, const double *y, double *x);

#endif
