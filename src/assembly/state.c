/* State of an assembly: the part that its owner sends to the other ranks, and the part that it keeps from step to
   step. */
#include "assembly.h"
#include "system.h"

#include <string.h>

enum { RELATIVE = sizeof(spari_relative) / sizeof(double), DRIVEN = sizeof(spari_driven) / sizeof(double) };

/* Of a joint: its motion at the end of the step, and in the first step also that at t^0. */
enum { SHARED = 1 + 2 * RELATIVE + DRIVEN };

int spari_assembly_owner(const spari_assembly *a) {
    return a->owner;
}

int64_t spari_assembly_share_size(const spari_assembly *a) {
    return (int64_t)SHARED * a->constraints;
}

void spari_assembly_pack(const spari_assembly *a, double *to) {
    for (int i = 0; i < a->constraints; i++, to += SHARED) {
        const spar_joint *j = a->constraint[i].joint;
        to[0] = j->balanced;
        memcpy(to + 1, &j->after, sizeof j->after);
        memcpy(to + 1 + RELATIVE, &j->now, sizeof j->now);
        memcpy(to + 1 + 2 * RELATIVE, &j->drive[0], sizeof j->drive[0]);
    }
}

void spari_assembly_unpack(spari_assembly *a, const double *from) {
    for (int i = 0; i < a->constraints; i++, from += SHARED) {
        spar_joint *j = a->constraint[i].joint;
        if (from[0] != 0 && !j->balanced) {
            memcpy(&j->after, from + 1 + RELATIVE, sizeof j->after);
            spari_joint_balance(j);
            memcpy(&j->drive[0], from + 1 + 2 * RELATIVE, sizeof j->drive[0]);
        }
        memcpy(&j->after, from + 1, sizeof j->after);
    }
}

double spari_assembly_remaining(const spari_assembly *a) {
    return a->left;
}

/* ---- begin, accept and reject ---- */

void spari_assembly_begin(spari_assembly *a) {
    a->factored_begun = a->factored;
    a->left_begun = a->left;
    a->reuse_begun = a->reuse;
    a->stepping = 1, a->formed = 0;
}

void spari_assembly_accept(spari_assembly *a) {
    a->stepping = a->formed = 0;
}

void spari_assembly_reject(spari_assembly *a) {
    if (a->stepping) {
        a->factored = a->factored_begun;
        a->left = a->left_begun;
        a->reuse = a->reuse_begun;
    }
}

/* ---- save and load ---- */

enum { HEAD = 13 };

/* Of a factored system: the condensed members. */
static int64_t factors_size(const spari_assembly *a) {
    int64_t n = 0;
    for (int i = 0; i < a->components; i++) {
        n += spari_condensed_state_size(a->component[i].condensed);
    }
    return n;
}

int64_t spari_assembly_state_size(const spari_assembly *a) {
    int64_t factors = a->factored ? factors_size(a) : 0;
    return !a->here || a->components == 0 ? 0 : HEAD + factors;
}

void spari_assembly_save(const spari_assembly *a, double *state) {
    state[0] = a->factored;
    state[1] = a->components;
    state[2] = a->left;
    state[3] = a->factored_begun;
    state[4] = a->left_begun;
    state[5] = a->stepping;
    state[6] = a->formed;
    state[7] = (double)a->reuse.served;
    state[8] = (double)a->reuse.spent;
    state[9] = (double)a->reuse_begun.served;
    state[10] = (double)a->reuse_begun.spent;
    state[11] = (double)a->reuse.each;
    state[12] = (double)a->reuse_begun.each;
    state += HEAD;
    for (int i = 0; i < a->components && a->factored; i++) {
        spari_condensed_save(a->component[i].condensed, state);
        state += spari_condensed_state_size(a->component[i].condensed);
    }
}

static int is_flag(double x) {
    return x == 0 || x == 1;
}

int spari_assembly_is_state(const spari_assembly *a, const double *state, int64_t count) {
    if (count < HEAD || !is_flag(state[0]) || state[1] != a->components || !spari_is_remaining(state[2]) ||
        !is_flag(state[3]) || !spari_is_remaining(state[4]) || !is_flag(state[5]) || !is_flag(state[6])) {
        return 0;
    }
    for (int k = 7; k < HEAD; k++) {
        if (!spari_is_count(state[k])) {
            return 0;
        }
    }
    return count == HEAD + (state[0] == 0 ? 0 : factors_size(a));
}

void spari_assembly_load(spari_assembly *a, const double *state) {
    a->factored = state ? (int)state[0] : 0;
    a->left = state ? state[2] : 0;
    a->stepping = state && state[5] != 0;
    a->formed = state && state[6] != 0;
    a->factored_begun = state && (a->factored || a->formed) ? (int)state[3] : 0; /* with the condensed members */
    a->left_begun = state ? state[4] : 0;
    a->reuse = a->reuse_begun = (spari_tangent_reuse){0};
    if (state) {
        a->reuse = (spari_tangent_reuse){(int64_t)state[7], (int64_t)state[8], (int64_t)state[11]};
        a->reuse_begun = (spari_tangent_reuse){(int64_t)state[9], (int64_t)state[10], (int64_t)state[12]};
    }
    a->solved = 0;
    state = state ? state + HEAD : NULL;
    for (int i = 0; i < a->components && a->factored; i++) {
        spari_condensed *c = a->component[i].condensed;
        spari_condensed_load(c, spari_member_constrained(a->component[i].member), state);
        state += spari_condensed_state_size(c);
    }
}
