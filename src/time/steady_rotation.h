/* A member that turns steadily with its root, seen from the frame that turns with it. A shape at rest in that frame
   moves as a rigid body does: every section has the root's angular velocity W, whatever the shape, and no angular
   acceleration; a node at x has u-dot = v0 + W x (x - x0) and u-ddot = a0 + W x (W x (x - x0)). A change of shape
   (du, dtheta) changes the accelerations by W x (W x du) and no rates of rotation: besides the body's tangent at fixed
   rates (which has the centrifugal stress and the change of R J R^T) the stiffness has M (W~ W~) on the columns of du.
   It is the second derivative of strain energy less 1/2 int rho |W x x|^2, symmetric at equilibrium under dead loads.
   Damping feels nothing of it: strains do not change. */
#ifndef SPARI_STEADY_ROTATION_H
#define SPARI_STEADY_ROTATION_H

#include "../member/structure.h"

typedef struct spari_steady_rotation {
    double w[3];         /* angular velocity */
    double v0[3], a0[3]; /* of the root */
} spari_steady_rotation;

/* The turn of a root that moves as v, a [6] say; 0 when it does not turn or accelerate, or the member has no inertia.
 */
int spari_steady_rotation_of(const spar_member *member, const double v[6], const double a[6],
                             spari_steady_rotation *rotation);
/* The same at load factor f: forces of inertia times f. */
spari_steady_rotation spari_steady_rotation_part(const spari_steady_rotation *rotation, double f);
/* Rates v, a [unique][6] of the shape q [unique][7]. */
void spari_steady_rotation_rates(const spar_member *member, const spari_steady_rotation *rotation, const double *q,
                                 double *v, double *a);
/* What turns as one with others: the turn is that of `centre`, and of every place from there. */
typedef struct spari_rotating_frame {
    spari_steady_rotation rotation;
    double centre[3];
    double *mass; /* room for the mass matrix of an element of any part */
} spari_rotating_frame;
/* Rates v, a [6] of what is at x, at load factor f. */
void spari_rotating_frame_rates(const spari_rotating_frame *rotating, double f, const double x[3], double v[6],
                                double a[6]);
/* As spari_body_residual, damping left out. */
double spari_steady_rotation_residual(const spari_body *damped, const double *q, const double *v, const double *a,
                                      double factor, double *r);
/* S [6P][6P] = stiffness of element e in the frame that turns, M likewise = its mass; turn NULL: at rest. */
void spari_steady_rotation_tangent(const spari_body *damped, const spari_steady_rotation *rotation, int e,
                                   const double *q, const double *v, const double *a, double factor, double *S,
                                   double *M);

/* The equations of small motions of element e, M x'' + C x' + K x [6P][6P] each, seen from a frame that turns with w
   while the member itself turns with `own`: x are displacements, and small turns beyond the turning of the member, in
   the axes of the frame as they stand. Of a section that turns otherwise than the frame, with s = own - w, the turn x
   has the rate x' + x cross s beyond own. q, v, a: as it turns; v, a NULL: it rests, as the frame does. */
void spari_steady_rotation_pencil(const spari_body *body, const double w[3], const double own[3], int e,
                                  const double *q, const double *v, const double *a, double *K, double *C, double *M);

#endif
