/* A member of an assembly as the assembly sees it: its ends, the nodes that joints hold, how they move and what forces
   are left on them. A member alone has no ends (component.c). What lies behind them is solved by a table of operations,
   one for the members whose unknowns are the motions of their nodes (component_body.c) and one for those that are
   linear in the frame of their root (component_floating.c). */
#ifndef SPARI_COMPONENT_H
#define SPARI_COMPONENT_H

#include "root.h"
#include "steady_rotation.h"

struct spari_frame;
struct spari_component;

/* Operations on a component. */
typedef struct spari_component_row {
    /* Room for its ends; the component's member and what solves it are there. 0, or SPAR_ERR_MEMORY. */
    int (*make)(struct spari_component *p);

    /* Loads and coefficients of a step in substeps h; whether accelerations at t^0 are known. */
    int (*take)(struct spari_component *p, double h);
    /* It begins at t^n. A substep begins where the last one has ended; a stage of it, p->scheme, 0
       or a status and a message; it ends. */
    void (*begin)(struct spari_component *p);
    void (*enter)(struct spari_component *p);
    int (*stage)(struct spari_component *p, const spari_part *part);
    /* A step begins with the velocities that have been published. */
    void (*take_velocities)(struct spari_component *p);
    void (*end)(struct spari_component *p);
    /* Its rates at the end are kept, or what was kept comes back. */
    void (*keep_rates)(struct spari_component *p, int back);

    /* Starting values; 0: there are none of that kind. */
    int (*predict)(struct spari_component *p, spari_guess stays);
    /* Forces less loads of the latest iterate: those on the ends go to p->force, which constraints add to; what
       rounding in them is relative to. */
    double (*balance)(struct spari_component *p);
    /* The largest of what is left of the forces; NaN where one is none. */
    double (*noise)(const struct spari_component *p);
    /* Forms and factors the tangent there, and what remains of it at the ends. 0 or 1. */
    int (*tangent)(struct spari_component *p);
    /* Whether the tangent kept can serve this step. */
    int (*serves)(const struct spari_component *p);
    /* Whether one correction with that tangent solves the equations: they are linear, and it is their own. NULL: no. */
    int (*solved)(const struct spari_component *p);
    /* What is left of the forces at the ends, x [6 ends], global axes. 0 or 1. */
    int (*reduce)(struct spari_component *p, double *x);
    /* The corrections of all, with those of the ends. */
    void (*expand)(struct spari_component *p, double *x);
    /* The size of the corrections; takes them off, `cut` of them. */
    double (*correction_size)(const struct spari_component *p);
    void (*correct)(struct spari_component *p, double cut);
    /* The size of what the step has moved it by. */
    double (*way)(const struct spari_component *p);
    /* What reduce leaves where there are no forces at all: none at the ends. */
    void (*clear)(struct spari_component *p);
    /* The corrections, times v, a and b, come off the velocities and accelerations at the end. */
    void (*shift_rates)(struct spari_component *p, double v, double a, double b);

    /* After the step: its forces become a little more load [nodes][6] of its nodes; and the motion [nodes][6] of these
       that the corrections are, displacements and small turns, global axes. */
    void (*take_more)(struct spari_component *p, const double *load);
    void (*show_more)(struct spari_component *p, double *motion);
    /* A step that was read from a file: it stands at its end. */
    void (*look_back)(struct spari_component *p);

    /* At t^0: the mass it starts with, factored (0 or 1); forces less loads of the accelerations there; those less the
       corrections; they are found. */
    int (*start)(struct spari_component *p);
    void (*unbalance)(struct spari_component *p);
    void (*correct_start)(struct spari_component *p);
    void (*end_start)(struct spari_component *p);
    /* Its velocities have been shifted after that; NULL: nothing is to be done. */
    void (*shift_start)(struct spari_component *p);

    /* At rest under dead and `fluid` loads [nodes][6]: from the last shape onward, else from t^n. Forces and tangent at
       the factor f of the loads; the corrections come off; places kept or put back; given up; found. */
    void (*rest)(struct spari_component *p, const double *fluid, int onward);
    double (*balance_rest)(struct spari_component *p, double f);
    int (*tangent_rest)(struct spari_component *p, double f);
    void (*shift)(struct spari_component *p, double cut);
    void (*keep_positions)(struct spari_component *p, int back);
    void (*discard_rest)(struct spari_component *p);
    void (*end_rest)(struct spari_component *p);

    /* How an end has turned since its tangent was formed; NULL: its axes stand. */
    const double *(*rotation)(const struct spari_component *p, int node);
} spari_component_row;

extern const spari_component_row spari_component_body, spari_component_floating;

/* A member of an assembly that is solved for, and its substep. */
typedef struct spari_component {
    spar_member *member;
    const spari_component_row *row;
    spari_solver *solver; /* of its body, or of the root of its frame; NULL: another rank solves it */
    struct spari_frame *frame;
    spari_condensed *condensed; /* what remains of it at its ends */
    double *K;                  /* the same [6 ends][6 ends], in global axes, as the system was formed */
    const int *end;             /* which of the nodes that constraints know its ends are */
    double *force;              /* [those nodes][6]: what is left on them, global axes */
    int at;                     /* where the unknowns of its ends begin in the system */
    const spari_state *state;   /* the motion that the constraints see, of those nodes */
    spari_scheme alpha, scheme; /* of a substep, and of the stage under way */
    spari_stage stage;
    const spari_rotating_frame *rotating; /* equilibrium in a frame that turns; NULL: at rest */
    double correction_size, allowed;      /* of the correction under way: its size, and what may be left of it */
    int moved, owner_before;              /* while it is made: the rank that had it, and what that kept of it */
    void *solution_before;
} spari_component;

/* A component without ends, in time and at rest: what it finds is for `publish` of the member's row. */
/* From t^n to t^n + dt in the session's substeps; leaves t^n alone. */
int spari_component_advance(spari_component *p, double dt);
/* Accelerations at t^0, for steps dt. */
int spari_component_balance(spari_component *p, double dt);
/* After a step: what a little more load [nodes][6] adds to the motion [nodes][6]. 0, or 1: there is no answer. */
int spari_component_answer(spari_component *p, const double *load, double *motion);
/* Equilibrium under dead and `fluid` loads [nodes][6], in the frame of a root that is driven steadily. 0, or 1: there
   is none. */
int spari_component_static(spari_component *p, const double *fluid);

/* The nodes of a member's unknowns that joints hold, in increasing order (node has room for two a joint); how many. */
int spari_component_joint_nodes(const spar_member *member, int *node);
int spari_component_joint_count(const spar_member *member);

#endif
