/* Ratios that modes get from damping which was chosen by the ratios of others. */
#ifndef SPARI_PLAUSIBLE_DAMPING_H
#define SPARI_PLAUSIBLE_DAMPING_H

#include "../member/structure.h"

/* What was chosen. */
typedef struct spari_damping_asked {
    double least, most;     /* ratios */
    double lowest, highest; /* rad/s, of the modes */
    int64_t modes;          /* how many of the lowest modes to look at */
} spari_damping_asked;

/* Warns if another mode, of the member or of its assembly, gets a ratio far from those chosen. */
void spari_damping_tell_plausible(const spar_member *member, const spari_damping_asked *asked);

#endif
