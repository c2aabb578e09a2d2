/* The data of a rigid beam. */
#ifndef SPARI_RIGID_BEAM_H
#define SPARI_RIGID_BEAM_H

#include "../time/body_solver.h"
#include "../time/offset_loads.h"

typedef struct spari_rigid_beam {
    spari_body *body;                /* one node at the root, with the mass of the whole beam */
    spari_offset_loads offset_loads; /* the loads on the body, apart from those on the root itself */
    spari_solver *solver;            /* on the owner; else NULL */
} spari_rigid_beam;

#endif
