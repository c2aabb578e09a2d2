/* The motion of the nodes in a substep of generalised-alpha or TR-BDF2: starting values, corrections, rates. */
#ifndef SPARI_SUBSTEP_MOTION_H
#define SPARI_SUBSTEP_MOTION_H

#include "stage.h"

/* Computes starting values: the state e->to and the increments x [unique][6]. Returns 0, and writes nothing, if this
   kind does not exist here. */
int spari_alpha_predict(const spari_solver *s, const spar_member *member, const spari_scheme *c, spari_guess stays,
                        spari_ends *e, double *x);
/* The same without inertia: the member follows its root, which rotates by `rotation`. */
void spari_alpha_carry(const spari_solver *s, const spar_member *member, const spari_scheme *c, const spari_pose *root,
                       const double rotation[4], const spari_ends *e, double *x);
/* Prescribes the root: a driven root takes its prescribed pose, a fixed root stays. */
void spari_alpha_impose_root(const spar_member *member, const spari_pose *root, const spari_ends *e, double *x);
/* Fills the solver's tinv. */
void spari_alpha_operators(const spari_solver *s, const spari_scheme *c, const spari_ends *e, const double *x);
/* Sizes of a correction and of the resulting increments: translations relative to the member's length, rotations in
   radians. */
typedef struct spari_corrected {
    double by, motion;
} spari_corrected;
/* x -= the correction dx, in global axes, shortened to `longest`, rotations through the inverse tangent operator.
   rotation: first rotates the correction to the present axes; NULL: does not. */
spari_corrected spari_alpha_correct(const spari_solver *s, const spar_member *member, const spari_scheme *c,
                                    spari_ends *e, double *rotation, double longest, double *x, double *dx);
/* Subtracts the corrections, times v, a and b, from velocities, accelerations and algorithmic accelerations at the
   end. Positions stay. */
void spari_alpha_shift_rates(const spari_solver *s, const spari_scheme *c, const spari_ends *e, double v, double a,
                             double b);
/* The size of increments, relative to the member's length, in radians. */
double spari_alpha_size(const spari_solver *s, double *x);
/* Statics: q [n][7] less the correction dx [n][6], shortened by `cut`. */
void spari_static_shift(int n, double cut, const double *dx, double *q);
/* Whether a coefficient x is close enough to that of the reused tangent. */
int spari_alpha_close(double x, double before);

#endif
