/* The work done on a member, for those who ask: kept with the motion of accepted steps by the trapezoidal rule, loads
   at both ends of a step against its displacement (exact for dead forces, of order 2 else, as the steps are). */
#ifndef SPARI_WORK_H
#define SPARI_WORK_H

#include "../member/joint.h"

/* An account for the member. */
int spari_work_create(spar_member *member);
/* The step is accepted: now -> after, before `after` becomes `now`. */
void spari_work_step(spar_member *member);
/* The same of a joint, before its members' accounts: what it has done on them, if they keep one, and its own, where one
   of them does. */
void spari_work_of_joint(spar_joint *joint);
/* The motion has been set anew: the account starts at zero, and those of its joints. */
void spari_work_restart(spar_member *member);
/* Before the first step: the fluids' loads at t = 0, which come after the motion there was set. */
void spari_work_begin(spar_member *member);
void spari_work_free(spari_work *work);
/* The member has been made anew: the account of what it was goes on, if there is one. */
void spari_work_carry(const spar_member *from, spar_member *member);

#endif
