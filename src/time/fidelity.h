/* The fidelities of a member, as a table with one row each. Code calls the operations of the row and does not
   distinguish fidelities. To add a fidelity, write a file with its row, name it in SPARI_FIDELITIES, and give it a
   number in spar.h. */
#ifndef SPARI_FIDELITY_H
#define SPARI_FIDELITY_H

#include "../comm/comm.h"
#include "../member/structure.h"
#include "effort.h"

struct spari_pencil;

/* A row. An operation that is NULL does nothing. Operations are called where spari_fidelity_is_here; those marked
   "every rank" on all ranks. They return 0 or a status. Their messages name the member; the public call adds its own
   name. */
typedef struct spari_fidelity {
    int moves;           /* spar finds the motion; else the host gives it */
    int solved;          /* by equations: there is a body, and its owner sends the motion; else all ranks compute it */
    int massive;         /* the body has its mass whatever effects are in force */
    int takes_modes;     /* it has a number of modes */
    int prescribed_root; /* it needs a root that is fixed or driven */
    int lower;           /* the next simpler SPAR_FIDELITY_*, which advice tries; 0: none */
    int whole;           /* one rigid body at the root carries all nodes */
    spari_frame_kind frame;

    /* every rank, before anything is built: refuses a description that it cannot serve */
    int (*check)(const spar_member *m);
    /* every rank: the effects that it has, of those given; NULL: all */
    int (*effects)(const spar_member *m, int effects);
    /* every rank, after nodes and body: creates m->solution; a failure leaves it to `free` */
    int (*create)(spar_member *m);
    void (*free)(void *solution);
    /* the body has been replaced by one with other damping; NULL: not possible */
    void (*renew)(spar_member *m);
    /* every rank: the mass in m->added has changed; NULL: nothing depends on it */
    void (*remass)(spar_member *m);

    /* the motion at t^n has been set */
    void (*restart)(spar_member *m);
    /* members without `component`: finds m->after; reads t^n */
    int (*advance)(spar_member *m, double dt);
    /* repeats `advance`, a solution under the loads at the last motion, until the loads that depend on the motion
       stay; NULL: once is enough */
    int (*repeat)(spar_member *m, double dt, int (*advance)(spar_member *m, double dt));
    /* replaces load [nodes][6] by the part of it that moves the member: without the part that the root takes, that
       cancels between the ends of two elements, or that a rigid body or modes do not represent. Returns 0 or
       SPAR_ERR_MEMORY. NULL: all loads move the member. effective_here: only the rank that finds the motion can call
       it; else every rank can, without a motion */
    int (*effective_load)(spar_member *m, double *load);
    int effective_here;
    /* a step begins; is accepted: t^{n+1} becomes t^n; is rejected: data that are reused from step to step are
       restored */
    void (*begin)(spar_member *m);
    void (*accept)(spar_member *m);
    void (*reject)(spar_member *m);
    /* the effort since the member was made; NULL: negligible */
    void (*effort)(const spar_member *m, spari_effort *effort);
    /* finds its equilibrium, if this is the same under all loads */
    void (*equilibrium)(spar_member *m);

    /* every rank: the reaction of the root in m->after (NULL: none), with a workspace of so many doubles, which
       suffices for follower and line loads that a host may give later */
    int64_t (*reaction_size)(const spar_member *m);
    void (*reaction)(const spar_member *m, double *workspace, double load[6]);
    /* every rank: kinetic, strain and potential energy of m->after */
    int (*energy)(const spar_member *m, double energy[4]);

    /* every rank: the number of unknowns that the root condition leaves free; adds the symmetric parts of K and M
       about m->after; a vector of the unknowns as a field [nodes][6], global axes (workspace: 6 of each unique node).
       Called only for bodies with mass. */
    int64_t (*unknowns)(const spar_member *m);
    int (*problem)(const spar_member *m, struct spari_pencil *to);
    void (*shape)(const spar_member *m, const double *x, double *workspace, double *nodes);
    /* every rank: adds the small-motion equations about m->after, unsymmetric and with rates, in a frame that
       rotates with w, to the pencil, and the residual of the forces. SPAR_ERR_UNSUPPORTED: the equations exist only
       in the frame of the member's own root, which rotates differently */
    int (*linearise)(const spar_member *m, const double w[3], struct spari_pencil *to);

    /* For members that are solved (assembly.h). component: the operations (component.h); NULL: the motion is given, and
       joints do not move it. publish: writes the motion found into m->after. For members whose unknowns are motions of
       nodes, on the owner: solver; take_loads: passes the loads of a step to it; take_static: passes dead and `fluid`
       loads for an equilibrium. */
    const struct spari_component_row *component;
    struct spari_solver *(*solver)(const spar_member *m);
    void (*take_loads)(spar_member *m);
    void (*take_static)(spar_member *m, const double *fluid);
    /* after a step, for `response`: apply_load: a small additional load [nodes][6] as forces r on the unknowns.
       get_response: the motion x of the unknowns as a motion [nodes][6]. */
    void (*apply_load)(spar_member *m, const double *load, double *r);
    void (*get_response)(spar_member *m, const double *x, double *motion);
    void (*publish)(spar_member *m);

    /* The state on which the next steps depend, to the last bit, apart from the member itself, as doubles. is_state:
       whether `count` doubles can be such a state. NULL: there is none. */
    int64_t (*state_size)(const spar_member *m);
    void (*save)(const spar_member *m, double *state);
    int (*is_state)(const spar_member *m, const double *state, int64_t count);
    void (*load)(spar_member *m, const double *state);
} spari_fidelity;

/* The table: SPAR_FIDELITY_* and the row's name. */
#define SPARI_FIDELITIES(ROW)                                                                                          \
    ROW(PRESCRIBED, prescribed)                                                                                        \
    ROW(RIGID, rigid)                                                                                                  \
    ROW(LINEAR, linear)                                                                                                \
    ROW(MODAL, modal)                                                                                                  \
    ROW(EXACT, exact)
#define SPARI_DECLARE_FIDELITY(number, name) extern const spari_fidelity spari_fidelity_##name;
SPARI_FIDELITIES(SPARI_DECLARE_FIDELITY)
extern const spari_fidelity spari_fidelity_given; /* points and external members */

/* The row of an existing fidelity. */
const spari_fidelity *spari_fidelity_row(int fidelity);
/* The row for the description of a member. */
const spari_fidelity *spari_fidelity_of(const spar_member *member);
/* Refuses a description that the row cannot serve: a status and a message. */
int spari_fidelity_check(const spar_member *member);
/* Whether this rank finds the motion of a committed member. */
static inline int spari_fidelity_is_here(const spar_member *member) {
    return !member->row->solved || member->owner == spari_comm_rank(member->session->ranks.comm);
}
/* Whether spar finds its static equilibrium. */
static inline int spari_fidelity_has_equilibrium(const spar_member *member) {
    return member->row->component || member->row->equilibrium;
}
/* Number of doubles in the state of a committed member on this rank; 0: none. */
static inline int64_t spari_fidelity_state_size(const spar_member *member) {
    return member->row->state_size && spari_fidelity_is_here(member) ? member->row->state_size(member) : 0;
}

#endif
