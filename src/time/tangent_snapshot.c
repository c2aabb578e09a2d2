/* The snapshot that a rejected step restores: see tangent_snapshot.h. */
#include "tangent_snapshot.h"

#include "../base/status.h"

#include <stdlib.h>
#include <string.h>

void spari_snapshot_open(spari_snapshot *s, int useful) {
    s->open = useful;
    s->saved = 0;
}

double *spari_snapshot_take(spari_snapshot *s, int64_t count) {
    if (!s->open || s->saved) {
        return NULL;
    }
    s->count = count;
    if (count > s->capacity) {
        double *data = spari_zalloc(count, sizeof *data);
        if (data) {
            free(s->data);
            s->data = data, s->capacity = count;
        }
    }
    s->saved = count <= s->capacity ? 1 : -1;
    return s->saved > 0 ? s->data : NULL;
}

void spari_snapshot_close(spari_snapshot *s) {
    s->open = s->saved = 0;
}

void spari_snapshot_free(spari_snapshot *s) {
    free(s->data);
    *s = (spari_snapshot){0};
}

int64_t spari_snapshot_size(const spari_snapshot *s) {
    return SPARI_SNAPSHOT_HEAD + (s->saved > 0 ? s->count : 0);
}

void spari_snapshot_save(const spari_snapshot *s, double *state) {
    const double head[SPARI_SNAPSHOT_HEAD] = {s->open, s->saved, s->saved > 0 ? (double)s->count : 0};
    memcpy(state, head, sizeof head);
    if (s->saved > 0) {
        memcpy(state + SPARI_SNAPSHOT_HEAD, s->data, (size_t)s->count * sizeof *state);
    }
}

int spari_snapshot_is(const double *state, int64_t count, int64_t expected) {
    if (count < SPARI_SNAPSHOT_HEAD || !(state[0] == 0 || state[0] == 1)) {
        return 0;
    }
    if (state[0] == 1 && state[1] == 1) {
        return state[2] == (double)expected && count == SPARI_SNAPSHOT_HEAD + expected;
    }
    return (state[1] == 0 || state[1] == -1) && state[2] == 0 && count == SPARI_SNAPSHOT_HEAD;
}

void spari_snapshot_load(spari_snapshot *s, const double *state, int there) {
    spari_snapshot_open(s, state[0] != 0);
    double *to = state[1] > 0 ? spari_snapshot_take(s, (int64_t)state[2]) : NULL;
    if (to) {
        memcpy(to, state + SPARI_SNAPSHOT_HEAD, (size_t)s->count * sizeof *to);
    }
    s->saved = s->open && !to && (state[1] != 0 || !there) ? -1 : s->saved;
}
