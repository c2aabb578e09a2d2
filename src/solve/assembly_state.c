/* What an assembly's owner tells the other ranks, and what it keeps from step to step. */
#include "assembly.h"
#include "tied.h"

#include <limits.h>
#include <math.h>
#include <string.h>

enum { RELATIVE = sizeof(spari_relative) / sizeof(double), DRIVEN = sizeof(spari_driven) / sizeof(double) };

/* Of a joint: the motion after, and in the first step what it began with at t^0. */
enum { SHARED = 1 + 2 * RELATIVE + DRIVEN };

int spari_assembly_owner(const spari_assembly *a) {
    return a->owner;
}

int64_t spari_assembly_share_size(const spari_assembly *a) {
    return (int64_t)SHARED * a->links;
}

void spari_assembly_pack(const spari_assembly *a, double *to) {
    for (int i = 0; i < a->links; i++, to += SHARED) {
        const spar_joint *j = a->link[i].joint;
        to[0] = j->balanced;
        memcpy(to + 1, &j->after, sizeof j->after);
        memcpy(to + 1 + RELATIVE, &j->now, sizeof j->now);
        memcpy(to + 1 + 2 * RELATIVE, &j->drive[0], sizeof j->drive[0]);
    }
}

void spari_assembly_unpack(spari_assembly *a, const double *from) {
    for (int i = 0; i < a->links; i++, from += SHARED) {
        spar_joint *j = a->link[i].joint;
        if (from[0] != 0 && !j->balanced) {
            memcpy(&j->after, from + 1 + RELATIVE, sizeof j->after);
            spari_joint_balance(j);
            memcpy(&j->drive[0], from + 1 + 2 * RELATIVE, sizeof j->drive[0]);
        }
        memcpy(&j->after, from + 1, sizeof j->after);
    }
}

double spari_assembly_left(const spari_assembly *a) {
    return a->trace.left;
}

/* ---- save and load ---- */

enum { KEPT_HEAD = 4, TURNING = 144 };

/* Of a factored system: what remains of the members at the joints' nodes, and of the loads' turning. */
static int64_t kept_size(const spari_assembly *a) {
    int64_t n = KEPT_HEAD + (int64_t)TURNING * a->links;
    for (int i = 0; i < a->limbs; i++) {
        n += spari_condensed_state_size(a->limb[i].condensed);
    }
    return n;
}

int64_t spari_assembly_state_size(const spari_assembly *a) {
    return !a->here || a->limbs == 0 ? 0 : a->factored ? kept_size(a) : KEPT_HEAD;
}

void spari_assembly_save(const spari_assembly *a, double *state) {
    state[0] = a->factored;
    state[1] = a->limbs;
    state[2] = a->trace.rate;
    state[3] = a->trace.left;
    state += KEPT_HEAD;
    for (int i = 0; i < a->limbs && a->factored; i++) {
        spari_condensed_save(a->limb[i].condensed, state);
        state += spari_condensed_state_size(a->limb[i].condensed);
    }
    for (int i = 0; i < a->links && a->factored; i++, state += TURNING) {
        memcpy(state, a->link[i].turning, sizeof a->link[i].turning);
    }
}

int spari_assembly_is_state(const spari_assembly *a, const double *state, int64_t count) {
    return count >= KEPT_HEAD && state[1] == a->limbs && state[0] >= 0 && state[0] < INT_MAX &&
           state[0] == floor(state[0]) && spari_trace_is(state + 2) &&
           count == (state[0] == 0 ? KEPT_HEAD : kept_size(a));
}

void spari_assembly_load(spari_assembly *a, const double *state) {
    a->factored = state ? (int)state[0] : 0;
    a->trace = (spari_trace){state ? state[2] : 0, state ? state[3] : 0};
    a->solved = 0;
    state = state ? state + KEPT_HEAD : NULL;
    for (int i = 0; i < a->limbs && a->factored; i++) {
        spari_condensed *c = a->limb[i].condensed;
        spari_condensed_load(c, spari_member_held(a->limb[i].member), state);
        state += spari_condensed_state_size(c);
    }
    for (int i = 0; i < a->links && a->factored; i++, state += TURNING) {
        memcpy(a->link[i].turning, state, sizeof a->link[i].turning);
    }
}
