/* Loads a member carries beside the dead ones at its nodes: follower loads at nodes, dead and follower loads along a
   beam, and the forces of springs to the ground along it (a foundation). Loads along the line enter by their virtual
   work on the element's own field (see body.h): a force through delta u = sum phi_l delta u_l, a moment m through delta
   theta = 2 Im(delta Q Q*)/|Q|^2, so that the nodal 4-vector is 2 phi_l m Q/|Q|^2. Dead loads along a line have then a
   potential, and moments that follow turn with the section. */
#ifndef SPARI_APPLIED_H
#define SPARI_APPLIED_H

#include "../base/saved_file.h"
#include "structure.h"

/* Applied loads are linear in a step, from those in force in the step before to those that the host has given for this
   one. In the first step those given stand from its beginning. All below is of the moment that is set here: the part
   `left` of the step is still to come, 0: its end, as it is whenever no step is being solved. */
void spari_applied_at(const spar_member *member, double left);
/* The dead loads at its nodes at t^n. */
const double *spari_dead_before(const spar_member *member);
/* The step is accepted, or the state stands under the loads as they are: they are those of t^n. */
void spari_applied_accept(spar_member *member);

/* Whether there are any. */
static inline int spari_carries_loads(const spar_member *member) {
    return member->applied || member->foundation;
}
/* r [unique][6] -= factor * loads at the state q [unique][7]; returns the largest entry taken off. A member that is
   seen linear has its springs in its own matrix: they are left out. */
double spari_applied_residual(const spar_member *member, const double *q, double factor, double *r);
/* Its exact tangent, added to the tangent S [6P][6P] of element e. */
void spari_applied_tangent(const spar_member *member, int e, const double *q, double factor, double *S);
/* load [nodes][6] += the loads at the motion q [nodes][7] of the public numbering. */
void spari_applied_nodal(const spar_member *member, const double *q, double *load);
/* Whether the loads have a potential: dead forces and springs only. */
int spari_applied_potential(const spar_member *member);
/* Whether loads along its line that do not turn have parts across an axis, of length 1. */
int spari_applied_across(const spar_member *member, const double axis[3]);
/* Into a file, and back in two passes: the first gets what it needs into member->applied_next (image->failed when it
 * cannot), the second takes it. */
void spari_applied_save(const spar_member *member, spari_image *image);
void spari_applied_check(spar_member *member, spari_image *image);
void spari_applied_load(spar_member *member, spari_image *image);
void spari_applied_free(spari_applied *applied);
void spari_ramp_free(spari_ramp *ramp);
/* Gives m, the same member with other nodes, the loads of `from`. */
int spari_applied_remake(const spar_member *from, spar_member *m);

/* The springs along a beam by its description, where they are in force; nothing where there are none. */
int spari_foundation_build(spar_member *member);
void spari_foundation_free(spari_foundation *foundation);
/* Their stiffness, which is constant, added to the tangent S [6P][6P] of element e. */
void spari_foundation_tangent(const spar_member *member, int e, double factor, double *S);
/* load [nodes][6] += factor * their forces at the motion q [nodes][7] of the public numbering. */
void spari_foundation_nodal(const spar_member *member, const double *q, double factor, double *load);
/* What they store there. */
double spari_foundation_energy(const spar_member *member, const double *q);

/* The follower loads at its nodes [nodes][6], global axes at the reference; NULL: none. */
const double *spari_applied_follower(const spar_member *member);

#endif
