/* What the rank that solves a member tells others of it: the motion after of its unknowns' nodes, and where it is
   damped the energy dissipated in the step. */
#ifndef SPARI_BLOCK_H
#define SPARI_BLOCK_H

#include "../member/structure.h"

/* How many doubles; 0 of a member that all ranks move alike. */
int64_t spari_block_size(const spar_member *member);
/* From the motion after, and back into it. The same answer. */
int64_t spari_block_pack(const spar_member *member, double *to);
int64_t spari_block_unpack(spar_member *member, const double *from);

#endif
