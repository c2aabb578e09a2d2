/* The life of a member: made by its commit, carried from step to step, released. */
#ifndef SPARI_LIFE_H
#define SPARI_LIFE_H

#include "../member/structure.h"

void spari_member_free(spar_member *member);
/* All that commit makes of the description (nodes, body, loads at zero, solution), its effects being in force; a
   status and a message where it fails, which leaves parts to be released. */
int spari_member_build(spar_member *m);
/* Frees it; the description stays. */
void spari_member_release(spar_member *m);
/* Another rank solves a committed member from now on, from the motion now; *before: what this one kept of it. A status
   without a message. Then the end of it: what is not wanted any more goes. back: it stays with its owner of before. */
int spari_member_move(spar_member *m, int owner, void **before);
void spari_member_end_move(spar_member *m, int owner, void *before, int back);
/* Detaches what has been made of the description: `detached` is the member as it was and owns all of it, `m` has the
   description and nothing made of it. And the way back: what has been made since goes. */
void spari_member_detach(spar_member *m, spar_member *detached);
void spari_member_take_back(spar_member *m, const spar_member *detached);
/* SPAR_EFFECT_* in force: what was asked for (or everything), as far as the description gives it something to do. */
int spari_member_effects(const spar_member *m);
/* The motion now has been set anew: the latest iterate, the root and the solver start from it. */
void spari_member_restart(spar_member *m);
/* Whether the rotations of the motion after are ones that a linear member's rotation vectors can tell: SPAR_OK, or
   SPAR_ERR_NUMERIC with a message. */
int spari_member_check_rotations(const spar_member *m);
/* The motion after has been found under dead and `fluid` loads: the reaction is what they leave to the root. */
void spari_member_solved(spar_member *member, const double *fluid);
/* The latest iterate becomes the motion the clock stands at, as after a static solution. */
void spari_member_commit_state(spar_member *member);
/* A step begins. It is accepted, or given up. */
void spari_member_begin(spar_member *member);
void spari_member_accept(spar_member *member);
void spari_member_reject(spar_member *member);
/* A start with initial accelerations: room for the accelerations that it begins with; back to these, but for what the
   host gives of an external member; those found are those of t^0, or all is as it was. */
int spari_member_begin_start(spar_member *member);
void spari_member_again(spar_member *member);
void spari_member_end_start(spar_member *member, int found);
/* After an accepted step: whether what it has shown of the fluid's added mass has put another one into the member's
   equations (added_mass_fit.h). And that in force as it stands, as when a file has been read. */
int spari_member_learn(spar_member *member);
void spari_member_put_learned(spar_member *member);
/* Puts the session's gravity in force. */
void spari_member_gravity(spar_member *member);

#endif
