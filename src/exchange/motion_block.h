/* Data of a solved member that its owner sends to other ranks: the motion `after` of its unique nodes and, if
   damped, the dissipated energy of the step. */
#ifndef SPARI_BLOCK_H
#define SPARI_BLOCK_H

#include "../member/structure.h"

/* Size in doubles; 0 for a member that all ranks know. */
int64_t spari_block_size(const spar_member *member);
/* Pack the motion `after`, and unpack it. Return the size. */
int64_t spari_block_pack(const spar_member *member, double *to);
int64_t spari_block_unpack(spar_member *member, const double *from);

#endif
