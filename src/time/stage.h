/* Stages of a substep of a member whose unknowns are the motions of nodes. */
#ifndef SPARI_STAGE_H
#define SPARI_STAGE_H

#include "relative_to_root.h"

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
/* Whether the substep moved the member too little for a second solution to exist, or the work of its loads is not
   known. */
int spari_stage_is_near(const spari_solver *solver, const spar_member *member, double h);
/* gain: energy that the substep added beyond the work of the loads. size: energy that this is relative to. */
void spari_stage_energy(spari_solver *solver, const spar_member *member, const spari_part *part, double *gain,
                        double *size);
/* The substep has ended. */
void spari_stage_end(const spari_solver *solver, spar_member *member, const spari_scheme *scheme, spari_stage *stage);

#endif
