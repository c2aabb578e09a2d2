/* What of a session no room below sees. */
#ifndef SPARI_OWN_H
#define SPARI_OWN_H

#include "../base/session.h"
#include "../math/bins.h"

typedef struct spari_record spari_record;     /* trial/trial.h */
typedef struct spari_coupling spari_coupling; /* coupling.h */
typedef struct spari_advised spari_advised;   /* trial/apply.h */

/* Of steps to a tolerance (step_control.h), kept from step to step. */
typedef struct spari_pace {
    double last;  /* error over tolerance of the last accepted step, */
    double ratio; /* and as dt goes by it, which fades; 0: none */
    double next;  /* dt, s; 0: no step yet */
    double cut;   /* the step last tried was rejected: 1 */
    int64_t rejected;
} spari_pace;

enum { SPARI_MOST_NUMBERS = 32 };

struct spari_own {
    double *pack; /* loads of all members, stacked, for the ranks' sum: [6 * nodes of all members], the fluids that
                    push, the status */
    int64_t pack_count;
    spari_bins *bins; /* reproducible sums: of the same numbers, in their order; room for bins_room of them */
    int64_t bins_room;
    int64_t *first;          /* several ranks: where the block of each rank's members begins in `motion` */
    double *motion;          /* several ranks: motion of all solved members, by owner */
    struct spari_unit *unit; /* what the threads solve, one each (threads.h); NULL: not made, room for unit_room */
    int64_t unit_room;
    spar_member **member; /* all members, of a step that several threads work on, `listed` of them; room likewise */
    int64_t listed;
    spari_coupling *coupling; /* from the first step on */
    spari_coupling *aside;    /* that of the steps, while a solution is under way that is none; NULL: there was none */
    spari_pace pace;          /* of steps to a tolerance */
    double number[SPARI_MOST_NUMBERS]; /* spar_session_push_numbers, this rank's; 0: not pushed */
    spari_record *kept;                /* of a trial that others are compared with; NULL: none */
    void (*free_kept)(spari_record *kept);
    spari_advised *advised; /* of spar_session_advise; NULL: none */
};

#endif
