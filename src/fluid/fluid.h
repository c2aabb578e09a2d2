/* A fluid model attached to one member on this rank: its nodes, their nearest points on the reference line, motion
   to the fluid, loads from the fluid. */
#ifndef SPARI_FLUID_H
#define SPARI_FLUID_H

#include "../math/bins.h"
#include "../member/structure.h"

/* Internal interface for the session; the public calls are in nodes.c, map.c, push.c, pull.c and other files of this
   room. */

/* Workspace per thread, in doubles (base/workspace.h, base/thread_pool.h). */
int64_t spari_fluid_workspace_size(const spar_fluid *fluid);
/* Adds the fluid's nodal loads, as last pushed, to load [nodes][6]. */
void spari_fluid_add_loads(const spar_fluid *fluid, double *load);
/* The same for reproducible sums. */
void spari_fluid_add_bins(const spar_fluid *fluid, spari_bins *load);
/* Its load on node i of the member; returns 0 if there are no loads yet. */
int spari_fluid_node_load(const spar_fluid *fluid, int64_t i, double load[6]);
/* Whether the host has ever pushed loads. */
int spari_fluid_has_loads(const spar_fluid *fluid);
/* Step events: begin predicts the node forces at t^{n+1}, accept shifts the history, reject restores it. They matter
   only with SPAR_EFFECT_FLUID_HISTORY. ratio = dt^{n+1}/dt^n; order 0, 1 or 2 of the predictor in this step. */
/* Status of the last push of this step (before the first step: of the last push), and the message of a refusal. */
int spari_fluid_refused(const spar_fluid *fluid, const char **why);
void spari_fluid_forget_refusal(spar_fluid *fluid);
/* Keeps past node forces for a predictor of this order, if node forces are kept. SPAR_ERR_MEMORY: nothing has
   changed. */
int spari_fluid_keep(spar_fluid *fluid, int order);
void spari_fluid_begin(spar_fluid *fluid, int order, double dt, const double dt_last[2]);
void spari_fluid_accept(spar_fluid *fluid);
void spari_fluid_reject(spar_fluid *fluid);
/* Makes the last pushed loads those of t^n, as after a static solution. */
void spari_fluid_commit_state(spar_fluid *fluid);
void spari_fluid_free(spar_fluid *fluid);
spar_fluid *spari_fluid_next(const spar_fluid *fluid); /* in the session's list */
spar_member *spari_fluid_member(const spar_fluid *fluid);
/* Calls `with` for each fluid of the session. */
static inline void spari_fluids_each(const spar_session *session, void (*with)(spar_fluid *fluid)) {
    for (spar_fluid *f = session->fluids; f; f = spari_fluid_next(f)) {
        with(f);
    }
}

/* Contributions of a fluid that a trial can switch off. Velocities and section poses are then those of a fluid at
   rest in the reference configuration, nodes are at their t^{n+1} positions, and node forces between steps are zero. */
enum {
    SPARI_MUTE_VELOCITY = 1,
    SPARI_MUTE_POSES = 2,
    SPARI_MUTE_HALF_STEP = 4,
    SPARI_MUTE_HISTORY = 8,
    SPARI_ASKED_POSITIONS = 128, /* informative only: positions or orientations have been pulled */
    SPARI_ASKED_LOADS = 32,      /* informative only: loads have been pushed, possibly zero; */
    SPARI_HAD_LOADS = 64,        /* informative only: the same at the beginning of the step, restored by reject */
    SPARI_ASKED_MOMENT = 16      /* informative only: there are moments; SPAR_EFFECT_FLUID_MOMENT switches them off */
};
void spari_fluid_mute(spar_fluid *fluid, int mute);
/* Which of these the host has pulled or pushed since the fluid was created, or created anew. */
int spari_fluid_asked(const spar_fluid *fluid);

/* Rebuilds the fluid for a trial on a rebuilt member (trial/rebuild.h). Local.
   before: the member as it was
   old: receives the fluid as it was; pass it to spari_fluid_restore, also after a failure unless it is NULL */
int spari_fluid_rebuild(spar_fluid *fluid, const spar_member *before, spar_fluid **old);
void spari_fluid_restore(spar_fluid *fluid, spar_fluid *old);
/* Reproducible sums of its loads, of twice the loads on the old nodes: adds them to sums[carried_size], which
   belongs to `before`; and converts them back to the present nodes. NULL: on another rank. */
int64_t spari_fluid_moved_size(const spar_member *before);
void spari_fluid_add_moved(const spar_fluid *old, const spar_member *before, spari_bins *sums);
void spari_fluid_put_moved(spar_fluid *fluid, const spar_member *before, const double *values);
/* Keeps the rebuilt fluid and frees the old one. */
void spari_fluid_adopt(spar_fluid *fluid, spar_fluid *old);
/* Whether there are nodes that are not mapped yet. */
int spari_fluid_is_pending(const spar_fluid *fluid);
/* Refuses nodes that are not mapped yet. */
int spari_fluid_need_mapped(const spar_fluid *fluid, const char *caller);
/* After restoring: frees the fluids that the host destroyed during the trial. */
void spari_fluid_release_gone(spar_session *session);

/* State for save and load, as doubles: loads, kept node forces and the host's own numbers, with the positions of
   these nodes. */
int64_t spari_fluid_state_size(const spar_fluid *fluid);
int spari_fluid_save(const spar_fluid *fluid, const char *call, double *state);
/* The part of a state that is stored per node: consecutive blocks, each with a number of words per node. */
enum { SPARI_FLUID_BLOCKS = 7 };
typedef struct spari_by_node {
    int64_t nodes;                          /* 0: nothing is kept per node */
    int64_t width[SPARI_FLUID_BLOCKS], all; /* per block, 0: not kept; all: their sum */
} spari_by_node;
/* From the first SPARI_FLUID_HEAD words of a state (or all, if fewer), on a member: words before the data per node,
   and its blocks. 0: not a valid state. */
enum { SPARI_FLUID_HEAD = 16 };
int spari_fluid_is_state(const spar_member *member, const double *head, int64_t count, int64_t *loads,
                         spari_by_node *by);

/* Begins to load a fluid from the states of all fluids of its name and member in the saved run (on all ranks, or one
   if the ranks are the same). take: checks by their heads whether this is possible, and allocates memory. */
int spari_fluid_take(spar_fluid *fluid, const char *call, int count, const double *const *heads);
/* Reads a state up to its nodes. Nodal loads, which are a sum, go to the fluid with `takes_loads`. 0: corrupt. */
int spari_fluid_take_loads(spar_fluid *fluid, const double *state, int takes_loads);
/* Reads `count` nodes of a state, in consecutive blocks. Nodes are found by their reference positions. */
void spari_fluid_take_nodes(spar_fluid *fluid, const double *head, int64_t first, int64_t count, const double *rows);
/* First node here that was not found, or -1; the message says which. */
int64_t spari_fluid_first_missing(spar_fluid *fluid);
int spari_fluid_loaded_whole(spar_fluid *fluid, const char *call);
/* load: puts the new state in force; give_up: discards it. */
void spari_fluid_load(spar_fluid *fluid);
void spari_fluid_give_up(spar_fluid *fluid);

#endif
