/* Generalised-alpha of one member, in the pieces of which a step is made: alone (body_newton.c), or tied to others
   (assembly.c). */
#ifndef SPARI_BODY_NEWTON_H
#define SPARI_BODY_NEWTON_H

#include "root.h"

/* Starting values: the state e->to and the increments x [unique][6]. 0: there are none of that kind, none is written.
 */
int spari_alpha_predict(const spari_solver *s, const spar_member *member, const spari_scheme *c, spari_guess stays,
                        spari_ends *e, double *x);
/* The same without inertia: the member goes along with its root, which turns by `turn`. */
void spari_alpha_carry(const spari_solver *s, const spar_member *member, const spari_scheme *c, const spari_pose *root,
                       const double rotation[4], const spari_ends *e, double *x);
/* A driven root goes where it is told, a fixed one stays. */
void spari_alpha_impose_root(const spar_member *member, const spari_pose *root, const spari_ends *e, double *x);
/* r := forces less loads, fixed unknowns out; the size that rounding in it is relative to. */
double spari_alpha_balance(spari_solver *s, const spar_member *member, const spari_scheme *c, const spari_state *at,
                           double *r);
/* Fills the solver's tinv. */
void spari_alpha_operators(const spari_solver *s, const spari_scheme *c, const spari_ends *e, const double *x);
/* Forces less loads at t^0 with the accelerations a; self: the solver. */
void spari_alpha_unbalance(void *self, const spar_member *member, const double *a, double *r);
/* Forms and factors the tangent. 0 or 1. */
int spari_alpha_tangent(spari_solver *s, const spar_member *member, const spari_scheme *c, const spari_state *to);
/* Forces in the axes of the reused tangent, and corrections out of them: sees how the nodes, at q, have turned since it
   was formed. The largest of the forces, infinite where one is no number. */
double spari_alpha_rotate_back(const spari_solver *s, const double *q, const double *r, double *dx);
void spari_alpha_rotate_forth(const spari_solver *s, double *dx);
/* x -= correction dx, in global axes and shortened to `longest`; its size. */
double spari_alpha_correct(const spari_solver *s, const spar_member *member, const spari_scheme *c, spari_ends *e,
                           double longest, double *x, double *dx);
/* The corrections, times v, a and b, come off velocities and accelerations at the end while the places stay. */
void spari_alpha_shift_rates(const spari_solver *s, const spari_scheme *c, const spari_ends *e, double v, double a,
                             double b);
/* The size of increments: by the member's length, in radians. */
double spari_alpha_size(const spari_solver *s, double *x);
/* Whether a reused tangent's coefficient is near enough. */
int spari_alpha_close(double x, double kept);

#endif
