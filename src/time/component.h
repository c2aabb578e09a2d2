/* A component: a member of an assembly, as the assembly uses it. One table of operations serves members whose unknowns
   are the motions of their nodes (component_body.c), another one beams that are linear in the frame of their root
   (component_floating.c). Joints tie only the former. These have ends, interface nodes whose motion and residual forces
   the constraints use; the rest of the member is condensed to them. */
#ifndef SPARI_COMPONENT_H
#define SPARI_COMPONENT_H

#include "stage.h"
#include "steady_rotation.h"

struct spari_frame;
struct spari_component;

/* Operations on a component. */
typedef struct spari_component_row {
    /* Finds the solver of the member, which exists already. */
    void (*attach)(struct spari_component *p);

    /* Takes the loads and coefficients of a step with substeps h. Returns whether the accelerations at t^0 are
       known. */
    int (*take)(struct spari_component *p, double h);
    /* begin: the step begins at t^n. enter: a substep begins at the end of the last one. stage: one stage of the
       substep, with p->scheme; returns 0, or a status and a message. end: the substep ends. */
    void (*begin)(struct spari_component *p);
    void (*enter)(struct spari_component *p);
    int (*stage)(struct spari_component *p, const spari_part *part);
    void (*end)(struct spari_component *p);

    /* Computes starting values. Returns 0 if this kind does not exist here. */
    int (*predict)(struct spari_component *p, spari_guess stays);
    /* Computes the residual (forces less loads) of the latest iterate. Returns the size that rounding errors are
       relative to. */
    double (*balance)(struct spari_component *p);
    /* The largest residual force, moments over the length; not finite if one of them is not. */
    double (*residual_size)(const struct spari_component *p);
    /* Forms and factors the tangent at that iterate and condenses it to the ends. Returns 0 or 1 (singular). */
    int (*tangent)(struct spari_component *p);
    /* Whether the reused tangent can serve this step. */
    int (*serves)(const struct spari_component *p);
    /* The size of the corrections. */
    double (*correction_size)(const struct spari_component *p);
    /* Of a component without ends. solve: the corrections from the latest residual; returns 0 or 1. correct_newton: the
       same in an iteration of Newton, after `residual_size`. advance: subtracts them, shortened to `longest`; returns
       their size before, and the size of the motion in the step; 0: the solution is exact. end_solution: Newton has
       converged in so many iterations, with these tangents; 0: it has failed. */
    int (*solve)(struct spari_component *p);
    int (*correct_newton)(struct spari_component *p);
    double (*advance)(struct spari_component *p, double longest, double *motion);
    void (*end_solution)(struct spari_component *p, int iterations, spari_tangents tangents);

    /* After the step. tangent_after: forms the tangent at its end if none is there; returns 0 or 1. apply_load: the
       residual becomes a small additional load [nodes][6] on the nodes. carry_over: takes `part` of this residual, and
       adds what the corrections of the trapezoidal stage of TR-BDF2 carry over to the backward-difference one (T35).
       get_response: the corrections as a motion [nodes][6] of the nodes, displacements and small rotations, global
       axes. */
    int (*tangent_after)(struct spari_component *p);
    void (*apply_load)(struct spari_component *p, const double *load);
    void (*carry_over)(struct spari_component *p, double part);
    void (*get_response)(struct spari_component *p, double *motion);
    /* Restores the end of a step that was read from a file. */
    void (*restore_end)(struct spari_component *p);

    /* At t^0. start: factors the mass; returns 0 or 1 (singular). unbalance: the residual of the accelerations.
       correct_start: subtracts the corrections from the accelerations. end_start: the accelerations are found. */
    int (*start)(struct spari_component *p);
    void (*unbalance)(struct spari_component *p);
    void (*correct_start)(struct spari_component *p);
    void (*end_start)(struct spari_component *p);

    /* Equilibrium under dead and `fluid` loads [nodes][6]. begin_static: begins from the last shape (onward), else from
       t^n. balance_static, tangent_static: residual and tangent at the load factor f. shift: subtracts the part `cut`
       of the corrections. keep_positions: saves the positions, or restores them (back). discard_static: discards the
       equilibrium. end_static: accepts it. */
    void (*begin_static)(struct spari_component *p, const double *fluid, int onward);
    double (*balance_static)(struct spari_component *p, double f);
    int (*tangent_static)(struct spari_component *p, double f);
    /* Whether the tangent of the equilibrium is positive definite: as spari_linear_definite. NULL: not known. */
    int (*definite_static)(struct spari_component *p, double f);
    void (*shift)(struct spari_component *p, double cut);
    void (*keep_positions)(struct spari_component *p, int back);
    void (*discard_static)(struct spari_component *p);
    void (*end_static)(struct spari_component *p);
} spari_component_row;

extern const spari_component_row spari_component_body, spari_component_floating;

/* A component and its substep. The data of an iteration come first, so that a large assembly reads few cache lines. */
typedef struct spari_component {
    spar_member *member;
    const spari_component_row *row;
    spari_solver *solver;       /* NULL: it is linear, or another rank solves it */
    spari_condensed *condensed; /* condensed to its ends */
    const spari_body *body;
    const spari_state *state; /* motion of the nodes */
    int at;                   /* index of its first unknown in the system */
    /* Of the latest correction: its size, the motion in the step, the largest force, and the unbalanced one before it.
     */
    double correction_size, motion, force, unbalanced;
    spari_scheme scheme; /* of the stage under way */
    spari_stage stage;
    spari_scheme alpha;        /* of a substep */
    double *K;                 /* the condensed tangent [6 ends][6 ends], global axes, as the system was formed */
    struct spari_frame *frame; /* if it is linear */
    spari_steps *steps;
    double *left;                         /* remaining correction of Newton, without ends */
    const spari_rotating_frame *rotating; /* equilibrium in a rotating frame; NULL: in one at rest */
    double moved_in_step;                 /* of a component without ends: the motion of the stage; 0: not known */
    int moved, owner_before; /* during creation: the rank that had the member before, and the solution of this rank */
    void *solution_before;
} spari_component;

/* Operations of the table of fidelities for members that spari_component_body serves. */
void spari_body_remass(spar_member *member);
void spari_body_begin(spar_member *member);
void spari_body_accept(spar_member *member);
void spari_body_reject(spar_member *member);
void spari_body_effort(const spar_member *member, spari_effort *effort);
int64_t spari_body_state_size(const spar_member *member);
void spari_body_save(const spar_member *member, double *state);
int spari_body_is_state(const spar_member *member, const double *state, int64_t count);
void spari_body_load(spar_member *member, const double *state);
#define SPARI_BODY_ROW                                                                                                 \
    .component = &spari_component_body, .remass = spari_body_remass, .begin = spari_body_begin,                        \
    .accept = spari_body_accept, .reject = spari_body_reject, .effort = spari_body_effort,                             \
    .state_size = spari_body_state_size, .save = spari_body_save, .is_state = spari_body_is_state,                     \
    .load = spari_body_load

/* A member that no joint ties, as a component. */
spari_component spari_component_of(spar_member *member);

/* ---- components with ends ---- */

/* Allocates the ends, before `attach`. Returns 0 or SPAR_ERR_MEMORY. */
int spari_component_make_ends(const spari_component *p);
/* Gives the root its prescribed motion, or that at t^n. */
void spari_component_impose_root(spari_component *p);
/* The step begins with the published velocities. */
void spari_component_take_velocities(const spari_component *p);
/* Saves the rates at the end, or restores them (back). */
void spari_component_keep_rates(spari_component *p, int back);
/* Computes the condensed residual at the ends, x [6 ends], global axes. rotated: it is in the axes of the tangent, by
   residual_size or tangent. Returns 0 or 1. */
int spari_component_reduce(spari_component *p, int rotated, double *x);
/* Sets the result of reduce for zero residual forces: none at the ends. */
void spari_component_clear(spari_component *p);
/* Computes the corrections of all unknowns from those of the ends. */
void spari_component_expand(spari_component *p, const double *x);
/* Subtracts the part `cut` of the corrections. Returns the size of the motion in the step. */
double spari_component_correct(spari_component *p, double cut);
/* Subtracts the corrections, times v, a and b, from the velocities, accelerations and algorithmic accelerations at the
   end. */
void spari_component_shift_rates(spari_component *p, double v, double a, double b);
/* Finds the rotations of the nodes since the tangent was formed, if the reduced residual did not need them. */
void spari_component_find_rotations(const spari_component *p);
/* The rotation of a node since the tangent was formed. */
static inline const double *spari_component_rotation(const spari_component *p, int node) {
    return p->solver->rotation + 4 * node;
}

#endif
