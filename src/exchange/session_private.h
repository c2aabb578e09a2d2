/* Data of a session that rooms below do not see. */
#ifndef SPARI_SESSION_PRIVATE_H
#define SPARI_SESSION_PRIVATE_H

#include "../base/session.h"
#include "../math/bins.h"

typedef struct spari_coupling spari_coupling; /* coupling/coupling.h */

/* Step-size control (session/step_control.h). */
typedef struct spari_step_control {
    double last;  /* error/tolerance of the last accepted step, */
    double ratio; /* and the decaying value that determines dt; 0: none */
    double next;  /* dt, s; 0: no step yet */
    double cut;   /* the last attempted step was rejected: 1 */
    int64_t rejected;
} spari_step_control;

/* Memory for the exchange between ranks, which spari_session_seal makes for the members as they are. */
typedef struct spari_exchange {
    double *pack; /* loads of all members, stacked, for the sum over ranks: [6 * nodes of all members], number of fluids
                     that push, status */
    int64_t pack_count;
    int64_t *first; /* several ranks: begin of the block of each rank's members in `motion` */
    double *motion; /* several ranks: motion of all solved members, by owner */
} spari_exchange;

struct spari_own {
    spari_exchange exchange;
    spari_bins *bins; /* reproducible sums of the same numbers, in their order; capacity bins_capacity */
    int64_t bins_capacity;
    struct spari_unit *unit; /* items of the threads (session/work_shares.h); NULL: none, capacity unit_capacity */
    int64_t unit_capacity;
    spar_member **member; /* all members, for a step with several threads, `listed` of them; same capacity */
    int64_t listed;
    spari_coupling *coupling;  /* from the first step on */
    spari_coupling *suspended; /* that of the steps, while a solution is under way that is none; NULL: there was none */
    spari_step_control step_control; /* of steps to a tolerance */
    spar_trial *trials;              /* list, in order of creation (trial/handle.h) */
    int64_t trials_created;
    void (*free_trials)(spar_trial *first); /* NULL: there are none */
};

#endif
