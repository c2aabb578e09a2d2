/* A component: a member of an assembly, as the assembly uses it. A component has ends, its interface nodes, which
   joints tie (a member without joints has none), with their motion and the residual forces on them. A table of
   operations solves the rest of the member. One table serves members whose unknowns are the motions of their nodes
   (component_body.c), another one members that are linear in the frame of their root (component_floating.c). */
#ifndef SPARI_COMPONENT_H
#define SPARI_COMPONENT_H

#include "root.h"
#include "steady_rotation.h"

struct spari_frame;
struct spari_component;

/* Operations on a component. */
typedef struct spari_component_row {
    /* make: allocates the ends; the member and its solver exist already; returns 0 or SPAR_ERR_MEMORY. NULL: nothing is
       to be allocated. attach: finds the solver and the ends. */
    int (*make)(struct spari_component *p);
    void (*attach)(struct spari_component *p);

    /* Takes the loads and coefficients of a step with substeps h. Returns whether the accelerations at t^0 are
       known. */
    int (*take)(struct spari_component *p, double h);
    /* begin: the step begins at t^n. enter: a substep begins at the end of the last one. stage: one stage of the
       substep, with p->scheme; returns 0, or a status and a message. end: the substep ends. */
    void (*begin)(struct spari_component *p);
    void (*enter)(struct spari_component *p);
    int (*stage)(struct spari_component *p, const spari_part *part);
    /* The step begins with the published velocities. */
    void (*take_velocities)(struct spari_component *p);
    void (*end)(struct spari_component *p);
    /* Saves the rates at the end, or restores them (back). */
    void (*keep_rates)(struct spari_component *p, int back);

    /* Computes starting values. Returns 0 if this kind does not exist here. */
    int (*predict)(struct spari_component *p, spari_guess stays);
    /* Computes the residual (forces less loads) of the latest iterate. The residual at the ends goes to p->force, to
       which constraints add. Returns the size that rounding errors are relative to. */
    double (*balance)(struct spari_component *p);
    /* The largest residual force; not finite if one of them is not. */
    double (*noise)(const struct spari_component *p);
    /* Forms and factors the tangent at that iterate and condenses it to the ends. Returns 0 or 1 (singular). */
    int (*tangent)(struct spari_component *p);
    /* Whether the reused tangent can serve this step. */
    int (*serves)(const struct spari_component *p);
    /* Computes the condensed residual at the ends, x [6 ends], global axes. Returns 0 or 1. */
    int (*reduce)(struct spari_component *p, double *x);
    /* Computes the corrections of all unknowns from those of the ends. */
    void (*expand)(struct spari_component *p, double *x);
    /* correction_size: the size of the corrections. correct: subtracts the part `cut` of them. */
    double (*correction_size)(const struct spari_component *p);
    void (*correct)(struct spari_component *p, double cut);
    /* The size of the motion in the step. */
    double (*way)(const struct spari_component *p);
    /* An iteration of a component without ends. solve: the corrections from the latest residual, after `noise`; returns
       0 or 1. advance: subtracts them, shortened to `longest`; returns their size before, and the size of the motion in
       the step; 0: the solution is exact. end_solution: Newton has converged in so many iterations, with a tangent
       formed in this attempt if `fresh`; 0: it has failed. */
    int (*solve)(struct spari_component *p);
    double (*advance)(struct spari_component *p, double longest, double *way);
    void (*end_solution)(struct spari_component *p, int iterations, int fresh);
    /* Sets the result of reduce for zero residual forces: none at the ends. */
    void (*clear)(struct spari_component *p);
    /* Subtracts the corrections, times v, a and b, from the velocities, accelerations and algorithmic accelerations
       at the end. */
    void (*shift_rates)(struct spari_component *p, double v, double a, double b);

    /* After the step. tangent_after: forms the tangent at its end if none is there; returns 0 or 1. take_more: the
       residual becomes a small additional load [nodes][6] on the nodes. show_more: the corrections as a motion
       [nodes][6] of the nodes, displacements and small rotations, global axes. */
    int (*tangent_after)(struct spari_component *p);
    void (*take_more)(struct spari_component *p, const double *load);
    void (*show_more)(struct spari_component *p, double *motion);
    /* Restores the end of a step that was read from a file. */
    void (*look_back)(struct spari_component *p);

    /* At t^0. start: factors the mass; returns 0 or 1 (singular). unbalance: the residual of the accelerations.
       correct_start: subtracts the corrections from the accelerations. end_start: the accelerations are found. */
    int (*start)(struct spari_component *p);
    void (*unbalance)(struct spari_component *p);
    void (*correct_start)(struct spari_component *p);
    void (*end_start)(struct spari_component *p);
    /* Called after velocities were shifted. NULL: does nothing. */
    void (*shift_start)(struct spari_component *p);

    /* Equilibrium under dead and `fluid` loads [nodes][6]. rest: begins from the last shape (onward), else from t^n.
       balance_rest, tangent_rest: residual and tangent at the load factor f. shift: subtracts the part `cut` of the
       corrections. keep_positions: saves the positions, or restores them (back). discard_rest: discards the
       equilibrium. end_rest: accepts it. */
    void (*rest)(struct spari_component *p, const double *fluid, int onward);
    double (*balance_rest)(struct spari_component *p, double f);
    int (*tangent_rest)(struct spari_component *p, double f);
    /* Whether the tangent of the equilibrium is positive definite: as spari_linear_definite. NULL: not known. */
    int (*definite_rest)(struct spari_component *p, double f);
    void (*shift)(struct spari_component *p, double cut);
    void (*keep_positions)(struct spari_component *p, int back);
    void (*discard_rest)(struct spari_component *p);
    void (*end_rest)(struct spari_component *p);

    /* The rotation of an end since its tangent was formed. NULL: none. */
    const double *(*rotation)(const struct spari_component *p, int node);
} spari_component_row;

extern const spari_component_row spari_component_body, spari_component_floating;

/* A component and its substep. */
typedef struct spari_component {
    spar_member *member;
    const spari_component_row *row;
    spari_solver *solver; /* of its body, or of the root of its frame; NULL: another rank solves it */
    struct spari_frame *frame;
    spari_condensed *condensed; /* condensed to its ends */
    double *K;                  /* the condensed tangent [6 ends][6 ends], global axes, as the system was formed */
    const int *end;             /* indices of its ends among the nodes that constraints use */
    double *force;              /* [those nodes][6] residual forces, global axes */
    int at;                     /* index of its first unknown in the system */
    const spari_state *state;   /* motion of those nodes */
    spari_scheme alpha, scheme; /* of a substep, and of the stage under way */
    spari_stage stage;
    const spari_rotating_frame *rotating; /* equilibrium in a rotating frame; NULL: in one at rest */
    double moved_in_step;                 /* of a component without ends: the motion of the stage; 0: not known */
    double correction_size,
        allowed;             /* of the latest correction: its size, and the remaining correction that is allowed */
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
/* Its corrections from the latest residual, with the latest tangent: of accelerations at t^0, of a response, or of an
   equilibrium. Returns 0 or 1. */
int spari_component_solve(spari_component *p);
/* Its motion at the end of a stage. Returns NULL, or the reason of a failure. */
const char *spari_component_newton(spari_component *p, int *iterations);

/* The nodes of a member's unknowns that joints tie, in increasing order. node: capacity of two per joint. Returns how
   many there are. */
int spari_component_joint_nodes(const spar_member *member, int *node);
int spari_component_joint_count(const spar_member *member);

#endif
