/* A fluid model tied to one member on this rank: its nodes, their feet on the reference line, motion out, loads in. */
#ifndef SPARI_FLUID_H
#define SPARI_FLUID_H

#include "../math/bins.h"
#include "../member/structure.h"

/* What the session asks of a fluid; the public calls are in nodes.c, map.c, push.c, pull.c and others of this room. */

/* Doubles of work space that each thread takes for it (base/workspace.h, base/thread_pool.h). */
int64_t spari_fluid_room(const spar_fluid *fluid);
/* Adds the fluid's nodal loads, as last pushed, to load [nodes][6]. */
void spari_fluid_add_loads(const spar_fluid *fluid, double *load);
/* The same to reproducible sums. */
void spari_fluid_add_bins(const spar_fluid *fluid, spari_bins *load);
/* What of them is on node i of the member; answers 0 where there are none yet. */
int spari_fluid_node_load(const spar_fluid *fluid, int64_t i, double load[6]);
/* Whether the host has ever pushed loads. */
int spari_fluid_has_loads(const spar_fluid *fluid);
/* The step moves: begin predicts the node forces at t^{n+1}, accept shifts the histories, reject goes back. Only fluids
   that keep node forces (SPAR_EFFECT_FLUID_HISTORY) have work to do. ratio = dt^{n+1}/dt^n; order 0, 1 or 2 as in force
   at this step. */
/* Status of the last push of this step (before the first step: of the last one), and the message of a refusal. */
int spari_fluid_refused(const spar_fluid *fluid, const char **why);
void spari_fluid_forget_refusal(spar_fluid *fluid);
/* Past node forces for a predictor of this order, if they are kept. SPAR_ERR_MEMORY: all is as before. */
int spari_fluid_keep(spar_fluid *fluid, int order);
void spari_fluid_begin(spar_fluid *fluid, int order, double dt, const double dt_last[2]);
void spari_fluid_accept(spar_fluid *fluid);
void spari_fluid_reject(spar_fluid *fluid);
/* What was pushed last holds at t^n, as after a static solution. */
void spari_fluid_settle(spar_fluid *fluid);
void spari_fluid_free(spar_fluid *fluid);
spar_fluid *spari_fluid_next(const spar_fluid *fluid); /* the session's list */
spar_member *spari_fluid_member(const spar_fluid *fluid);

/* What of a fluid a trial run can leave out: velocities and section poses are then those of a fluid at rest in the
   reference configuration, the nodes stand where they are at t^{n+1}, node forces between steps are zero. */
enum {
    SPARI_MUTE_VELOCITY = 1,
    SPARI_MUTE_POSES = 2,
    SPARI_MUTE_HALF_STEP = 4,
    SPARI_MUTE_HISTORY = 8,
    SPARI_ASKED_LOADS = 32, /* loads have been pushed, which may be zero; this too only tells; */
    SPARI_HAD_LOADS = 64,   /* and had been when the step began, to which a rejected one goes back */
    SPARI_ASKED_MOMENT = 16 /* moments are left out by SPAR_EFFECT_FLUID_MOMENT; this only tells that there are any */
};
void spari_fluid_mute(spar_fluid *fluid, int mute);
/* Which of these the host has pulled or pushed since the fluid was made, or made anew. */
int spari_fluid_asked(const spar_fluid *fluid);

/* For a trial run on a member made anew (member/remake.h); `before` is what the member was. *old: what the fluid was;
   give it to spari_fluid_restore, also after a failure unless it is NULL. Local. */
int spari_fluid_remake(spar_fluid *fluid, const spar_member *before, spar_fluid **old);
void spari_fluid_restore(spar_fluid *fluid, spar_fluid *old);
/* Its loads as reproducible sums, of twice the loads on the nodes there were: adds them to sums[carried_size], which is
   of what `before` was; and back as values of that size, for the nodes there are now: NULL, another rank has them. */
int64_t spari_fluid_carried_size(const spar_member *before);
void spari_fluid_add_carried(const spar_fluid *old, const spar_member *before, spari_bins *sums);
void spari_fluid_put_carried(spar_fluid *fluid, const spar_member *before, const double *values);
/* It stays as it was made anew: what it was goes. */
void spari_fluid_adopt(spar_fluid *fluid, spar_fluid *old);
/* Whether there are nodes that wait for their map. */
int spari_fluid_is_pending(const spar_fluid *fluid);
/* After the way back: the fluids that the host has destroyed within the trial. */
void spari_fluid_release_gone(spar_session *session);

/* Whether nodes of it are sections. */
int spari_fluid_has_sections(const spar_fluid *fluid);

/* State for save and load, as doubles: loads, kept node forces and the host's own numbers, with the places of these
   nodes. */
int64_t spari_fluid_state_size(const spar_fluid *fluid);
int spari_fluid_save(const spar_fluid *fluid, const char *call, double *state);
/* What a state has node by node: one block behind the other, of so many numbers a node each. */
enum { SPARI_FLUID_BLOCKS = 7 };
typedef struct spari_by_node {
    int64_t nodes; /* 0: nothing is kept by node */
    int blocks;
    int64_t width[SPARI_FLUID_BLOCKS], all; /* all: their sum */
} spari_by_node;
/* Of its first SPARI_FLUID_HEAD words, as many as there are in all, on a member: how many go before what is node by
   node, and what that is. 0: it is none. */
enum { SPARI_FLUID_HEAD = 16 };
int spari_fluid_is_state(const spar_member *member, const double *head, int64_t count, int64_t *loads,
                         spari_by_node *by);

/* Loads a fluid from the states of those of its name and member on all ranks of the saved run (or of one, where the
   ranks are the same), piece by piece. take: by their heads, whether that can be done, with the memory for it. */
int spari_fluid_take(spar_fluid *fluid, const char *call, int count, const double *const *heads);
/* The words of a state up to its nodes; the nodal loads, which are a sum, go to the fluid that `takes_loads`. 0:
 * broken. */
int spari_fluid_take_loads(spar_fluid *fluid, const double *state, int takes_loads);
/* Of the nodes of a state so many, its blocks of them one behind the other: found by their reference places. */
void spari_fluid_take_nodes(spar_fluid *fluid, const double *head, int64_t first, int64_t count, const double *rows);
/* The first node here that was not among them, -1: all were; and a refusal, if one was not. */
int64_t spari_fluid_untaken(spar_fluid *fluid);
int spari_fluid_taken(spar_fluid *fluid, const char *call);
/* What was taken is in force, after that; or it was not to be. */
void spari_fluid_load(spar_fluid *fluid);
void spari_fluid_give_up(spar_fluid *fluid);

#endif
