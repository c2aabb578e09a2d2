/* The work done on a member, if the host asks for it. It is integrated over accepted steps by the trapezoidal rule:
   loads at both ends of a step times the displacement. This is exact for dead forces, else of order 2, as the steps
   are. */
#ifndef SPARI_WORK_H
#define SPARI_WORK_H

#include "../member/joint.h"

/* Creates the member's account. */
int spari_work_create(spar_member *member);
/* Adds an accepted step, before the motion at t^{n+1} becomes that of t^n. */
void spari_work_step(spar_member *member);
/* The same for a joint, before the accounts of its members: adds the joint's work to their accounts if they have
   one, and its own if one of them has. */
void spari_work_of_joint(spar_joint *joint);
/* The motion has been set: the account and those of its joints restart at zero. */
void spari_work_restart(spar_member *member);
/* Takes the fluid loads at t = 0. Called before the first step, because these loads may come after the motion has
   been set. */
void spari_work_begin(spar_member *member);
void spari_work_free(spari_work *work);
/* Copies the account of the member that `member` replaces, if there is one. */
void spari_work_carry(const spar_member *from, spar_member *member);

#endif
