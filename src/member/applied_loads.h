/* Applied loads of a member beside the dead loads at its nodes: follower loads at nodes, dead and follower loads
   along a beam, and springs to the ground along it (a foundation).
   Distributed loads enter by their virtual work on the element's field (body.h): a force through delta u = sum phi_l
     delta u_l, a moment m through delta theta = 2 Im(delta Q Q*)/|Q|^2, so the nodal 4-vector is 2 phi_l m Q/|Q|^2.
     Dead distributed loads therefore have a potential, and follower moments rotate with the section. */
#ifndef SPARI_APPLIED_LOADS_H
#define SPARI_APPLIED_LOADS_H

#include "../base/saved_file.h"
#include "structure.h"

/* Sets the time in the step at which the calls below evaluate loads. `left` is the remaining fraction of the step; 0
   is its end, the value when no step is being solved. Applied loads are linear in a step, between those of the step
   before and those given for this one. In the first step they are constant. */
void spari_applied_at(const spar_member *member, double left);
/* Dead nodal loads at t^n. */
const double *spari_dead_before(const spar_member *member);
/* Makes the present loads those of t^n: the step is accepted, or the state is in equilibrium with them. */
void spari_applied_accept(spar_member *member);

/* Whether there are applied loads of these kinds. */
static inline int spari_carries_loads(const spar_member *member) {
    return member->load.applied || member->load.foundation;
}
/* r [unique][6] -= factor * loads for the state q [unique][7]; returns the largest entry subtracted. The springs of
   a linear member are in its matrix and are left out. */
double spari_applied_residual(const spar_member *member, const double *q, double factor, double *r);
/* Adds their exact tangent to the tangent S [6P][6P] of element e. */
void spari_applied_tangent(const spar_member *member, int e, const double *q, double factor, double *S);
/* load [nodes][6] += the loads for the motion q [nodes][7] of the host's nodes; and without dead and follower loads
   along the line. */
void spari_applied_nodal(const spar_member *member, const double *q, double *load);
void spari_applied_nodal_but_lines(const spar_member *member, const double *q, double *load);
/* force += force and moment about the section at xi of element e, of the line loads on the element beyond it. q, x
   [nodes]: motion of the host's nodes, and their positions for lever arms. */
void spari_applied_lines_beyond(const spar_member *member, const double *q, const double *x, int e, double xi,
                                double force[6]);
/* Whether the loads have a potential: dead forces and springs only. */
int spari_applied_potential(const spar_member *member);
/* Whether dead distributed loads have components perpendicular to the unit vector `axis`. */
int spari_applied_across(const spar_member *member, const double axis[3]);
/* Save to a file, and load in two passes: the first reads into member->load.applied_next (sets image->failed on
   errors), the second takes it. */
void spari_applied_save(const spar_member *member, spari_image *image);
void spari_applied_check(spar_member *member, spari_image *image);
void spari_applied_load(spar_member *member, spari_image *image);
void spari_applied_free(spari_applied *applied);
void spari_ramp_free(spari_ramp *ramp);
/* Copies the loads of `from` to m, the same member with other nodes. */
int spari_applied_rebuild(const spar_member *from, spar_member *m);

/* Creates the springs of the description if they are in force; nothing if there are none. */
int spari_foundation_build(spar_member *member);
void spari_foundation_free(spari_foundation *foundation);
/* Adds their constant stiffness to the tangent S [6P][6P] of element e. */
void spari_foundation_tangent(const spar_member *member, int e, double factor, double *S);
/* load [nodes][6] += factor * spring forces for the motion q [nodes][7] of the host's nodes. */
void spari_foundation_nodal(const spar_member *member, const double *q, double factor, double *load);
/* Energy stored in the springs. */
double spari_foundation_energy(const spar_member *member, const double *q);

/* Follower loads at the nodes [nodes][6], global axes at the reference; NULL: none. */
const double *spari_applied_follower(const spar_member *member);

#endif
