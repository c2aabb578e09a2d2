/* The motion of the nodes as seen from a driven root in its axes, in which steady turning is rest and stiff directions
   stay (docs/beam.md). */
#ifndef SPARI_ROOT_H
#define SPARI_ROOT_H

#include "scheme.h"
#include "solver.h"

/* A substep's ends in the variables of the scheme, seen from a driven root, else as they are; and the end as the body
   takes it. */
typedef struct spari_ends {
    spari_state from, to, seen;
    const spari_pose *root; /* a driven root at the end; NULL: as they are */
    double carried;         /* how far the root takes the member along: turns, and ways by its length */
} spari_ends;

/* The ends [from, to] of a substep that a root goes through; `ratio` of the algorithmic accelerations: see
   spari_scheme_stretch. */
spari_ends spari_root_ends(const spari_solver *solver, const spar_member *member, const spari_scheme *scheme,
                           const spari_pose *root, double ratio, spari_state *from, spari_state *to);
/* Motion of all nodes as seen from a root; b is so already. */
void spari_root_look_from(const spari_solver *solver, const spar_member *member, const spari_pose *root,
                          const spari_state *state, spari_state *own);
/* And back, into what the body takes. */
void spari_root_show(const spari_solver *solver, const spar_member *member, spari_ends *ends);

#endif
