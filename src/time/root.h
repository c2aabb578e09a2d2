/* The motion of the nodes as seen from a driven root in its axes, in which steady turning is rest and stiff directions
   stay (docs/beam.md). */
#ifndef SPARI_ROOT_H
#define SPARI_ROOT_H

#include "body_solver.h"
#include "scheme.h"

/* A substep's ends in the variables of the scheme, seen from a driven root, else as they are; and the end as the body
   takes it. */
typedef struct spari_ends {
    spari_state from, to, seen;
    const spari_pose *root; /* what they are seen from, at the end: a driven root, or a rigid motion; NULL: nothing */
    double carried;         /* how far that takes the member along: turns, and ways by its length */
} spari_ends;

/* The ends [from, to] of a substep that a root goes through; `ratio` of the algorithmic accelerations: see
   spari_scheme_stretch. */
spari_ends spari_root_ends(const spari_solver *solver, const spar_member *member, const spari_scheme *scheme,
                           const spari_pose *root, double ratio, spari_state *from, spari_state *to);
/* A stage of a substep of a member whose unknowns are the motions of nodes. */
typedef struct spari_stage {
    spari_ends ends;
    spari_pose before, root; /* a driven root at the beginning of the substep and at the end of the stage */
    spari_pose rigid, along; /* the rigid motion that a substep of TR-BDF2 is seen from, likewise */
    double rotation[4];      /* of the root */
    double power;            /* that damping takes at the beginning */
} spari_stage;
/* A step begins at t^n. */
void spari_stage_start(spari_solver *solver, spar_member *member, spari_stage *stage);
/* The rate of the acceleration a of a node that turns steadily with w: forces turn with it, weight does not. */
void spari_steady_rate(const spar_member *member, const double w[3], const double a[3], double rate[3]);
/* Accelerations at t^0 are known: what of generalised-alpha belongs to them, for substeps of the scheme. */
void spari_stage_remember(spari_solver *solver, const spar_member *member, const spari_scheme *scheme);
/* The mean angular velocity at the beginning of the substep, of what turns freely and deforms; else 0. */
double spari_stage_rotation_rate(const spari_solver *solver, const spar_member *member);
/* A substep begins where the last one has ended. */
void spari_stage_enter(spari_solver *solver);
/* Loads, root and ends of a stage. SPAR_OK or SPAR_ERR_MEMORY. */
int spari_stage_begin(spari_solver *solver, const spar_member *member, const spari_scheme *scheme,
                      const spari_part *part, spari_stage *stage);
/* The root and ends alone. */
int spari_stage_root(spari_solver *solver, const spar_member *member, const spari_scheme *scheme,
                     const spari_part *part, spari_stage *stage);
/* What generalised-alpha would go on with after the substep. */
void spari_stage_restart(const spari_solver *solver, const spar_member *member, const spari_scheme *scheme,
                         spari_stage *stage);
/* Whether a substep has moved it too little for another solution, or the work of its loads is not known. */
int spari_stage_is_near(const spari_solver *solver, const spar_member *member, double h);
/* What the substep has added to the energy beyond the work of the loads, and how much there was to add to. */
void spari_stage_energy(spari_solver *solver, const spar_member *member, const spari_part *part, double *gain,
                        double *size);
/* The substep has ended. */
void spari_stage_end(const spari_solver *solver, spar_member *member, const spari_scheme *scheme, spari_stage *stage);
/* Motion of all nodes as seen from a root; b is so already. */
void spari_root_look_from(const spari_solver *solver, const spar_member *member, const spari_pose *root,
                          const spari_state *state, spari_state *own);
/* And back, into what the body takes. */
void spari_root_show(const spari_solver *solver, const spar_member *member, spari_ends *ends);

#endif
