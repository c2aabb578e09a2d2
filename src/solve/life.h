/* The life of a member: built by its commit, advanced from step to step, released. */
#ifndef SPARI_LIFE_H
#define SPARI_LIFE_H

#include "../member/structure.h"

void spari_member_free(spar_member *member);
/* Builds what commit makes of the description: nodes, body, zero loads, solution. The effects are in force already.
   Returns a status, with a message; a failure leaves parts to be released. */
int spari_member_build(spar_member *m);
/* Frees what was built; the description stays. */
void spari_member_release(spar_member *m);
/* move: another rank solves a committed member from now on, from the present motion. *before: what this rank had of
   the solution. Returns a status without a message. end_move: frees what is no longer needed. back: the member stays
   with its former owner. */
int spari_member_move(spar_member *m, int owner, void **before);
void spari_member_end_move(spar_member *m, int owner, void *before, int back);
/* detach: `detached` becomes the member as it was, with all that was built; `m` keeps the description alone.
   take_back: the inverse; what was built since is freed. */
void spari_member_detach(spar_member *m, spar_member *detached);
void spari_member_take_back(spar_member *m, const spar_member *detached);
/* The effects in force, SPAR_EFFECT_*: those requested (or all), as far as the description has data for them. */
int spari_member_effects(const spar_member *m);
/* The motion at t^n has been set: the latest iterate, the root and the solver restart from it. */
void spari_member_restart(spar_member *m);
/* Checks that the rotation vectors of a linear member can represent the rotations at t^{n+1}. Returns SPAR_OK, or
   SPAR_ERR_NUMERIC with a message. */
int spari_member_check_rotations(const spar_member *m);
/* The motion at t^{n+1} has been found under dead and `fluid` loads. The reaction of the root follows from them. */
void spari_member_solved(spar_member *member, const double *fluid);
/* The latest iterate becomes the motion at t^n, as after a static solution. */
void spari_member_commit_state(spar_member *member);
/* A step begins, is accepted, or is rejected. */
void spari_member_begin(spar_member *member);
void spari_member_accept(spar_member *member);
/* Warns of what the accepted step has shown, once; in the calling thread. */
void spari_member_tell(spar_member *member);
void spari_member_reject(spar_member *member);
/* Consistent initial accelerations. begin_start: allocates the accelerations that the search begins with. again:
   returns to these, except for motions that the host gives of an external member. end_start: the accelerations found
   become those of t^0, or (found 0) everything is restored. */
int spari_member_begin_start(spar_member *member);
void spari_member_again(spar_member *member);
void spari_member_end_start(spar_member *member, int found);
/* learn: after an accepted step, updates the added mass learned from the fluid (added_mass_fit.h) and returns
   whether the member's equations have changed. put_learned: puts the present estimate in force, as after reading a
   file. */
int spari_member_learn(spar_member *member);
void spari_member_put_learned(spar_member *member);
/* Puts the session's gravity in force. */
void spari_member_gravity(spar_member *member);

#endif
