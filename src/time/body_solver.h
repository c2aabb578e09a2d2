/* The owner's solver of one body: the states of its unknowns' nodes (element boundaries once), its factored tangent,
   and what a step reuses. The body is that of an exact member, or the one node that carries a rigid beam.
   component_body.c has the operations of a step. */
#ifndef SPARI_BODY_SOLVER_H
#define SPARI_BODY_SOLVER_H

#include "../algebra/anderson.h"
#include "../algebra/condense.h"
#include "../base/thread_pool.h"
#include "../member/body.h"
#include "../member/structure.h"
#include "effort.h"
#include "offset_loads.h"
#include "scheme.h"
#include "tangent_reuse.h"
#include "tangent_snapshot.h"

/* State at one time, [unique][...]: q 7, v 6, true acceleration a 6, algorithmic acceleration b 6. One block of 25
 * doubles a node. With a driven root b is relative to the root. */
typedef struct spari_state {
    double *q, *v, *a, *b;
} spari_state;

/* How a tangent is reused. */
typedef struct spari_reuse {
    int factored;
    double cm, cv; /* the tangent's coefficients */
    spari_tangent_reuse tangent;
    double left; /* estimated remaining correction of the last solution, relative to the length, rad */
} spari_reuse;

/* Forces at the starting values of Newton. These values follow from the motion at t^n, so each iteration of a coupling
   begins with the same forces. */
typedef struct spari_start_forces {
    int at_start;           /* the next forces are those of starting values */
    int known;              /* what follows is known, of the step under way */
    double *state, *forces; /* [n][19] q, v and a, and [n][6]; NULL: not kept */
    double gravity[3], scale, power;
} spari_start_forces;

/* The last correction, for tangents with mixed integration points (member/body.h). The memory is allocated when a
   solution first needs a tangent in each iteration. */
typedef struct spari_mixed_points {
    int on;
    double part;    /* of dx that has been subtracted */
    double *q, *dx; /* [n][7] positions before, [n][6] correction, global axes */
    double *strain; /* of the points */
} spari_mixed_points;

typedef struct spari_solver spari_solver;
/* The data of an iteration come first, so that a large assembly reads few cache lines. */
struct spari_solver {
    const spari_body *body;
    spari_offset_loads *offset_loads; /* of a body that carries a rigid beam, with its loads along the line; or NULL */
    int n;                            /* unique nodes */
    double *r, *dx;
    double *increment;    /* [n][6] u - u_n and the rotation vector of q q_n^-1 */
    spari_state to, from; /* a substep's ends; after a solve `to` is t^{n+1} */
    spari_steps steps;
    double *most, *most_by;     /* [spans of nodes] the largest of each (spari_solver_most), and of their corrections */
    double *tangent_q;          /* [n][4] rotation of the nodes when it was formed */
    double *rotation;           /* [n][4] their rotation since */
    double power, power_begin;  /* that damping takes out, at the last forces computed and at t^n */
    int64_t newton, factors;    /* totals: iterations, factorisations */
    double *stage_v;            /* [n][6] velocities at the end of a trapezoidal stage */
    spari_condensed *condensed; /* of a member that joints tie to others; NULL: none */
    spari_linear *linear;
    spari_anderson *anderson; /* of the corrections of one solution */
    double *tinv;             /* [n][9] inverse tangent operator of the rotation vector */
    spari_mixed_points mixed;
    double *best;       /* static: state to go back to */
    spari_state begin;  /* at t^n */
    spari_state own[2]; /* ends of a substep relative to a driven root or a rigid motion; NULL: none so far */
    double *block[3];   /* the memory of the three states */
    /* the factored tangent, reused while it contracts */
    int factored;
    double tangent_cm, tangent_cv; /* its coefficients */
    spari_tangent_reuse reuse;
    spari_start_forces start;
    double left;           /* estimated remaining correction of the last solution, relative to the length, rad */
    spari_reuse begun;     /* the same at the beginning of the step, */
    spari_snapshot before; /* and its factors */
};

/* The solver keeps references to `body` and `offset_loads` (NULL: none). */
spari_solver *spari_solver_create(const spar_member *member, const spari_body *body, spari_offset_loads *offset_loads);
void spari_solver_free(spari_solver *solver);
/* A state in a block of 25 doubles for each of n nodes. */
spari_state spari_state_in(double *block, int n);
/* Call it after begin.q, v, a have been set. */
void spari_solver_restart(spari_solver *solver);
/* A step begins. It is accepted: t^{n+1} becomes t^n. It is rejected: the tangent is again the one that it began with.
 */
void spari_solver_begin(spari_solver *solver);
void spari_solver_accept(spari_solver *solver);
void spari_solver_reject(spari_solver *solver);
/* The tangents of an attempt have mixed integration points, if `on` and if there is memory. It begins with the strains
   at the beginning of the substep. */
void spari_solver_mix(spari_solver *solver, int on);
/* Remembers a correction, with the positions q that it begins from. rotation: from the axes of dx to global ones; NULL:
   these are global. */
void spari_solver_remember_correction(spari_solver *solver, const double *q, const double *rotation);
/* The effort so far. */
void spari_solver_effort(const spari_solver *solver, spari_effort *effort);

/* All that the next steps depend on, to the last bit, as doubles, for save and load; the reused tangent is part of it.
   is_state: whether `count` doubles can be the state of this solver. */
int64_t spari_solver_state_size(const spari_solver *solver);
void spari_solver_save(const spari_solver *solver, double *state);
int spari_solver_is_state(const spari_solver *solver, const double *state, int64_t count);
void spari_solver_load(spari_solver *solver, const double *state);

/* Shared by the files of the solver */
/* Overwrites the workspace at the beginning of a solution (base/poison.h). */
void spari_solver_poison(spari_solver *solver);
/* Whether there are follower loads of the body's nodes, or distributed loads. */
static inline int spari_solver_has_applied(const spari_solver *solver, const spar_member *member) {
    return (member->load.applied || member->load.foundation) && !solver->offset_loads;
}
/* Runs over the solver's nodes in spans, on the worker threads if there are any. Span number from / SPARI_SPAN writes
   to its own nodes and to most[number]. */
enum { SPARI_SPAN = 256 };
static inline void spari_solver_spread(const spari_solver *solver, spari_span work, void *context) {
    spari_thread_pool_spread(solver->body->pool ? *solver->body->pool : NULL, solver->n, SPARI_SPAN, work, context);
}
/* The maximum over the spans. */
static inline double spari_solver_largest(const spari_solver *solver, const double *spans) {
    double most = spans[0];
    for (int k = 1; k < (solver->n + SPARI_SPAN - 1) / SPARI_SPAN; k++) {
        most = spans[k] > most ? spans[k] : most;
    }
    return most;
}
static inline double spari_solver_most(const spari_solver *solver) {
    return spari_solver_largest(solver, solver->most);
}
/* The state of a tangent, the load factor, and its coefficients. */
typedef struct spari_tangent_at {
    const double *q, *v, *a, *tinv;
    double factor, cm, cv;
    const struct spari_steady_rotation *rotation; /* equilibrium in a rotating frame; NULL: else */
    double *mass;                                 /* with it: workspace for the matrix of an element */
} spari_tangent_at;
/* Forms the tangent. */
void spari_solver_form(spari_solver *solver, const spar_member *member, const spari_tangent_at *at);
/* Forms and factors it. Returns 0 or 1 (singular). */
int spari_solver_factor(spari_solver *solver, const spar_member *member, const spari_tangent_at *at);

#endif
