/* A member in steady rotation with its root, in the rotating frame. A shape at rest in that frame moves as a
   rigid body: every section has the angular velocity W of the root and no angular acceleration. A node at x has
   u-dot = v0 + W x (x - x0) and u-ddot = a0 + W x (W x (x - x0)). A change of shape (du, dtheta) changes the
   accelerations by W x (W x du) and no rates of rotation.

   The stiffness is the body's tangent at fixed rates, which contains the centrifugal stress and the change of R J
   R^T, plus M (W~ W~) on the columns of du. It is the second derivative of strain energy less 1/2 int rho |W x x|^2,
   and it is symmetric at equilibrium under dead loads. Damping has no effect: strains do not change. */
#ifndef SPARI_STEADY_ROTATION_H
#define SPARI_STEADY_ROTATION_H

#include "../member/structure.h"

typedef struct spari_steady_rotation {
    double w[3];         /* angular velocity */
    double v0[3], a0[3]; /* of the root */
} spari_steady_rotation;

/* Finds the steady rotation of a root with rates v, a [6]. Returns 0 if the root neither rotates nor accelerates, or
   if the member has no inertia. */
int spari_steady_rotation_of(const spar_member *member, const double v[6], const double a[6],
                             spari_steady_rotation *rotation);
/* The same at load factor f: inertia forces are multiplied by f. */
spari_steady_rotation spari_steady_rotation_part(const spari_steady_rotation *rotation, double f);
/* A frame that rotates steadily and carries several components. `rotation` of `centre` holds for every position
   relative to it. */
typedef struct spari_rotating_frame {
    spari_steady_rotation rotation;
    double centre[3];
    double *mass; /* workspace: the mass matrix of an element of any component */
} spari_rotating_frame;
/* Rates v, a [6] at position x, at load factor f. */
void spari_rotating_frame_rates(const spari_rotating_frame *rotating, double f, const double x[3], double v[6],
                                double a[6]);
/* The frame of a root with the motion `at`, as spari_steady_rotation_of. */
int spari_rotating_frame_of(const spar_member *member, const spari_motion *at, spari_rotating_frame *frame);
/* Rates v, a [n][6] of the unique nodes at q [n][7]. */
void spari_rotating_frame_nodes(const spari_rotating_frame *frame, double f, const spar_member *member, int n,
                                const double *q, double *v, double *a);
/* As spari_body_residual, without damping. */
double spari_steady_rotation_residual(const spari_body *damped, const double *q, const double *v, const double *a,
                                      double factor, double *r);
/* S [6P][6P]: stiffness of element e in the rotating frame. M: its mass. rotation NULL: at rest. */
void spari_steady_rotation_tangent(const spari_body *damped, const spari_steady_rotation *rotation, int e,
                                   const double *q, const double *v, const double *a, double factor, double *S,
                                   double *M);

/* Small-motion equations of element e, M x'' + C x' + K x, [6P][6P] each. The frame rotates with w, the member with
   `own`. x are displacements, and small rotations beyond the rotation of the member, in the instantaneous axes of
   the frame. Where s = own - w is not 0, a rotation x has the rate x' + x cross s beyond own. q, v, a: the state. v,
   a NULL: member and frame are at rest. */
void spari_steady_rotation_pencil(const spari_body *body, const double w[3], const double own[3], int e,
                                  const double *q, const double *v, const double *a, double *K, double *C, double *M);

#endif
