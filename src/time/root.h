/* The motion of the nodes relative to a driven root, in the axes of the root. In these axes a steady rotation is
   rest, and stiff directions stay (docs/evidence/beam.md). */
#ifndef SPARI_ROOT_H
#define SPARI_ROOT_H

#include "body_solver.h"
#include "scheme.h"

/* The ends of a substep in the variables of the scheme: relative to a driven root, else absolute. `absolute` is the end
   as the body takes it. */
typedef struct spari_ends {
    spari_state from, to, absolute;
    const spari_pose *root; /* reference of the motion at the end: a driven root, or a rigid motion; NULL: none */
    double root_motion; /* how far the reference moves the member: rotation, and displacement relative to its length */
} spari_ends;

/* A stage of a substep of a member whose unknowns are the motions of nodes. */
typedef struct spari_stage {
    spari_ends ends;
    spari_pose before, root; /* driven root at the beginning of the substep and at the end of the stage */
    spari_pose rigid, along; /* the reference rigid motion of a TR-BDF2 substep, likewise */
    double rotation[4];      /* of the root */
    double power;            /* damping power at the beginning */
} spari_stage;
/* A step begins at t^n. */
void spari_stage_start(spari_solver *solver, spar_member *member, spari_stage *stage);
/* The rate of the acceleration a of a node in steady rotation w: forces rotate with the node, weight does not. */
void spari_steady_rate(const spar_member *member, const double w[3], const double a[3], double rate[3]);
/* Sets the algorithmic accelerations from known accelerations at t^0, for substeps of the scheme. */
void spari_stage_remember(spari_solver *solver, const spar_member *member, const spari_scheme *scheme);
/* The mean angular velocity at the beginning of the substep, of a member that rotates freely and deforms; else 0. */
double spari_stage_rotation_rate(const spari_solver *solver, const spar_member *member);
/* A substep begins at the end of the last one. */
void spari_stage_enter(spari_solver *solver);
/* Loads, root and ends of a stage. SPAR_OK or SPAR_ERR_MEMORY. */
int spari_stage_begin(spari_solver *solver, const spar_member *member, const spari_scheme *scheme,
                      const spari_part *part, spari_stage *stage);
/* The driven root only. */
void spari_stage_drive(const spar_member *member, const spari_scheme *scheme, const spari_part *part,
                       spari_stage *stage);
/* How far a root moves the member: rotation, and displacement relative to its length. */
double spari_root_motion(const spari_pose *from, const spari_pose *to, double length);
/* Whether the substep moved the member too little for a second solution to exist, or the work of its loads is not
   known. */
int spari_stage_is_near(const spari_solver *solver, const spar_member *member, double h);
/* gain: energy that the substep added beyond the work of the loads. size: energy that this is relative to. */
void spari_stage_energy(spari_solver *solver, const spar_member *member, const spari_part *part, double *gain,
                        double *size);
/* The substep has ended. */
void spari_stage_end(const spari_solver *solver, spar_member *member, const spari_scheme *scheme, spari_stage *stage);
/* own := the motion of all nodes relative to a root. b is relative already. */
void spari_root_look_from(const spari_solver *solver, const spar_member *member, const spari_pose *root,
                          const spari_state *state, spari_state *own);
/* The inverse: sets the absolute motion that the body takes. */
void spari_root_show(const spari_solver *solver, const spar_member *member, spari_ends *ends);

#endif
