/* How members move, as a table with one row for each fidelity. Every room asks the row, none asks which it is. A row is
   a file of this room: to add one, write the file, name it in SPARI_FIDELITIES and give it its number in spar.h. */
#ifndef SPARI_FIDELITY_H
#define SPARI_FIDELITY_H

#include "../comm/comm.h"
#include "../member/structure.h"
#include "effort.h"

struct spari_pencil;

/* A row. Of the operations NULL means: nothing to do. They are called where spari_fidelity_is_here, but for those that
   every rank calls. 0 or a status; messages name the member, the public call puts its name before. */
typedef struct spari_fidelity {
    int moves;           /* spar finds the motion; else the host gives it */
    int solved;          /* by equations: there is a body, and its owner sends the motion; else all ranks do alike */
    int massive;         /* the body has its mass whatever effects are in force */
    int takes_modes;     /* it is asked for with a number of modes */
    int prescribed_root; /* it needs a root that is fixed or driven */
    int lower;           /* the SPAR_FIDELITY_* that advice goes on to from here, 0: none */
    int whole;           /* one body carries all of its nodes, from the root */
    spari_view seen;

    /* every rank: what of the description it cannot serve; before anything is built */
    int (*check)(const spar_member *m);
    /* every rank: of the effects that may be in force those that are left to it; NULL: all */
    int (*effects)(const spar_member *m, int effects);
    /* every rank, nodes and body being there: m->solution, which a failure leaves to `free` */
    int (*create)(spar_member *m);
    void (*free)(void *solution);
    /* the body has been put in the place of one that had no damping, or another; NULL: that cannot be */
    void (*renew)(spar_member *m);
    /* every rank: m->added has another mass than before; NULL: nothing is kept that knows it */
    void (*remass)(spar_member *m);

    /* the motion now has been set anew */
    void (*restart)(spar_member *m);
    /* from t^n to t^n + dt in the session's substeps, under dead loads, load_history[0] and load_used; leaves t^n
       alone, writes m->after and m->dissipated_step */
    int (*advance)(spar_member *m, double dt);
    /* accelerations at t^0 under dead loads and load_history[0], for steps dt; writes m->after, which is t^0 with them.
       NULL: the host gives them */
    int (*balance)(spar_member *m, double dt);
    /* after a step: what a little more of load_used, `load` [nodes][6], adds to m->after: `motion` [nodes][6],
       displacements and small turns, global axes, to first order and over the last substep. 0, or 1: there is no
       answer. NULL: loads move nothing */
    int (*response)(spar_member *m, const double *load, double *motion);
    /* load [nodes][6] becomes one that moves the member as it does, without what moves nothing: what the root holds,
       what cancels between the ends of two elements, what a rigid body or modes leave out. 0 or SPAR_ERR_MEMORY. NULL:
       all loads move it. Where felt_here it is for the one who finds the motion, else for every rank, without a motion.
     */
    int (*felt)(spar_member *m, double *load);
    int felt_here;
    /* a step begins; t^{n+1} becomes t^n; or what is reused from step to step is again as the step began */
    void (*begin)(spar_member *m);
    void (*accept)(spar_member *m);
    void (*reject)(spar_member *m);
    /* the effort of all that since the member was made; NULL: nothing to speak of */
    void (*effort)(const spar_member *m, spari_effort *effort);
    /* equilibrium under dead and `fluid` loads [nodes][6], line loads and gravity; leaves t^n alone, writes m->after.
       onward: from the shape that the last call found, if that leads there; else from t^n. NULL: there is none */
    int (*rest)(spar_member *m, const double *fluid, int load_steps, int onward);

    /* every rank: what the root gives in the motion after (NULL: nothing), with memory given beforehand: so many
       doubles; with that of followers and line loads, which a host may give later */
    int64_t (*reaction_size)(const spar_member *m);
    void (*reaction)(const spar_member *m, double *workspace, double load[6]);
    /* every rank: kinetic, strain, potential of the motion after */
    int (*energy)(const spar_member *m, double energy[4]);

    /* every rank: the unknowns that the root leaves free; K and M of the motion after, dense, their symmetric parts; a
       vector of the unknowns as a field of the nodes [nodes][6], global axes (room: 6 of each unique node). Called only
       where the body has mass. */
    int64_t (*unknowns)(const spar_member *m);
    int (*problem)(const spar_member *m, double *K, double *M);
    void (*shape)(const spar_member *m, const double *x, double *workspace, double *nodes);
    /* every rank: its equations of small motions about the motion after, unsymmetric and with rates, seen from a frame
       that turns with w: entries of the pencil, and what is left of its forces. SPAR_ERR_UNSUPPORTED: it can be seen
       from the frame of its own root only, which turns otherwise */
    int (*linearise)(const spar_member *m, const double w[3], struct spari_pencil *to);

    /* Of members that joints tie to others, and that are solved with them (assembly.h): how (component.h; NULL: joints
       cannot tie it); what it has found, into m->after; of those whose unknowns are nodes' the solver of the body, on
       its owner, and what goes into it before a step, and before equilibrium under dead and `fluid` loads. */
    const struct spari_component_row *component;
    /* every rank: joints have come or changed, m->solution is made anew for them if it depends on them; the node of the
       component's that a node of the unknowns is. NULL: it does not; the same */
    int (*renew_joints)(spar_member *m);
    int (*end_of)(const spar_member *m, int node);
    struct spari_solver *(*solver)(const spar_member *m);
    void (*take_loads)(spar_member *m);
    void (*take_rest)(spar_member *m, const double *fluid);
    /* after a step, as `answer` has it: a little more load [nodes][6] as forces r on its unknowns, and the motion x of
       these as that of the nodes [nodes][6] */
    void (*take_more)(spar_member *m, const double *load, double *r);
    void (*show_more)(spar_member *m, const double *x, double *motion);
    void (*publish)(spar_member *m);

    /* All that the next steps depend on beside the member itself, to the last bit, as doubles; whether `count` doubles
       can be that. NULL: nothing is kept. */
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

/* What a fidelity is called: "exact". */
const char *spari_fidelity_name(int fidelity);
/* The row of a fidelity that there is. */
const spari_fidelity *spari_fidelity_row(int fidelity);
/* The row of a member, from what it is described as. */
const spari_fidelity *spari_fidelity_of(const spar_member *member);
/* What of the description its row cannot serve: a status and a message. */
int spari_fidelity_check(const spar_member *member);
/* Whether this rank finds the motion of a committed member. */
static inline int spari_fidelity_is_here(const spar_member *member) {
    return !member->row->solved || member->owner == spari_comm_rank(member->session->comm);
}
/* Doubles that this rank keeps of a committed member; 0: nothing. */
static inline int64_t spari_fidelity_state_size(const spar_member *member) {
    return member->row->state_size && spari_fidelity_is_here(member) ? member->row->state_size(member) : 0;
}

#endif
