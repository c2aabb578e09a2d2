/* Members below the exact ones. Prescribed: the nodes follow the root as one rigid body; nothing is solved for. Rigid:
   the same about a body of the member's whole mass, which the solver of rigid bodies advances. Linear and modal: see
   solve/frame.h. */
#ifndef SPARI_RUNG_H
#define SPARI_RUNG_H

#include "member.h"

/* First moments sum (rho f^T) of the nodal forces over the arms of the reference, and those of t^n and t^{n+1}: a rigid
   body turned by R takes the moment of R Z. */
struct spari_arms {
    double Z[9], begin[9], end[9];
};
void spari_arms_at(spari_arms *arms, double s);
/* r[3] -= the moment at orientation q */
void spari_arms_residual(const spari_arms *arms, const double q[4], double r[3]);
/* Adds its tangent to S [6][6]. */
void spari_arms_tangent(const spari_arms *arms, const double q[4], double S[36]);

struct spari_frame;
struct spari_rung {
    spar_member *core;         /* rigid: a body of one node; NULL: none */
    struct spari_frame *frame; /* linear, modal; NULL: none */
};

/* The body that carries a rigid member (not NULL), with the latest iterate and the arms of the loads in use. 0, or
   SPAR_ERR_MEMORY. */
int spari_rung_core(const spar_member *member, spar_member **core);
/* A small motion of its root, displacement and rotation, carried to all nodes [nodes][6] of the latest iterate. */
void spari_rung_carry(const spar_member *member, const double root[6], double *nodes);

/* Whether the member is one whose nodes follow its root without a solution. */
int spari_rung_prescribed(const spar_member *member);
/* What of the description the rung cannot serve: a status and a message. Before anything is built. */
int spari_rung_check(const spar_member *member);
/* The effects that are left to a rung, of those in force. */
int spari_rung_effects(const spar_member *member, int effects);
/* After nodes and body are there. */
int spari_rung_create(spar_member *member);
void spari_rung_free(spari_rung *rung);
void spari_rung_restart(spar_member *member);
int spari_rung_advance(spar_member *member, double dt);
void spari_rung_accept(spar_member *member);
int spari_rung_static(spar_member *member);
/* What the owner of a member keeps of it beside the member itself, of any fidelity, as doubles: see
 * spari_solver_state_size. Size 0: this rank keeps nothing. */
int64_t spari_rung_state_size(const spar_member *member);
void spari_rung_save(const spar_member *member, double *state);
int spari_rung_is_state(const spar_member *member, const double *state, int64_t count);
void spari_rung_load(spar_member *member, const double *state);
/* What the root gives the member in the motion after, from the balance of the whole: inertia less weight less loads,
   each where its node is; in linear theory about axes that stand, where its node is in the reference. Internal forces
   have no part in it. room: so many doubles. */
int64_t spari_rung_reaction_room(const spar_member *member);
void spari_rung_reaction(const spar_member *member, double *room, double load[6]);
/* Puts what a rung's own equations say in place of the energies of the exact member. 0, or SPAR_ERR_MEMORY. */
int spari_rung_energy(const spar_member *member, double energy[4]);
/* Place, orientation and velocity of the frame that a linear or modal member is seen from: those of its root where they
   are given, else it stands at the reference. Members that are linear about their reference otherwise: the same. */
void spari_rung_pose(const spar_member *member, const spari_motion *nodes, double pose[13]);
/* Deformation of a node seen from there, displacement and rotation vector in the axes of the pose, and its rates. */
void spari_rung_deformation(const spar_member *member, const double pose[13], const spari_motion *nodes, int64_t node,
                            double x[6], double rate[6]);

#endif
