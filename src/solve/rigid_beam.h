/* Members below the exact ones. Prescribed: the nodes follow the root as one rigid body; nothing is solved for. Rigid:
   the same about a body of the member's whole mass, which the solver of rigid bodies advances. Linear and modal: see
   solve/frame.h. */
#ifndef SPARI_RIGID_BEAM_H
#define SPARI_RIGID_BEAM_H

#include "../member/structure.h"
#include "arms.h"

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
/* Under `fluid` loads [nodes][6] beside the kept ones; writes member->after. */
int spari_rung_static(spar_member *member, const double *fluid);
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

#endif
