/* Transfers reproducible load sums to other nodes: see move_loads.h. */
#include "move_loads.h"

#include "../base/session.h"
#include "../comm/enter.h"

#include <stdlib.h>
#include <string.h>

enum { FLAGS = 32 }; /* fluids per word */

typedef struct moved_sums {
    const spari_moved_loads *fluids;
    int64_t count, words, *first, sums; /* words: per rank, including its status */
    double *here;                       /* [ranks][words]: bit mask of fluids with force nodes on the rank */
    spari_bins *sum;                    /* [sums], and room for a status */
    double *value;                      /* of the largest fluid */
} moved_sums;

/* Hash of what must agree across ranks, so that sums over them belong to one fluid. */
static uint64_t hash_of(const moved_sums *c) {
    uint64_t h = SPARI_HASH_BEGIN;
    for (int64_t k = 0; k < c->count; k++) {
        const char *member = spari_fluid_member(c->fluids[k].fluid)->name,
                   *name = spar_fluid_get_name(c->fluids[k].fluid);
        h = spari_hash_bytes(h, member, strlen(member) + 1);
        h = spari_hash_bytes(h, name, strlen(name) + 1);
    }
    return h;
}

static int alloc_sums(spar_session *s, moved_sums *c) {
    int64_t ranks = spari_comm_size(s->ranks.comm), most = 0;
    for (int64_t k = 0; k < c->count; k++) {
        int64_t n = spari_fluid_moved_size(c->fluids[k].before);
        c->sums += n;
        most = n > most ? n : most;
    }
    c->words = (c->count + FLAGS - 1) / FLAGS + 1;
    c->first = spari_zalloc(ranks + 1, sizeof *c->first);
    c->here = spari_zalloc(ranks * c->words, sizeof *c->here);
    c->sum = spari_zalloc(c->sums + 1, sizeof *c->sum);
    c->value = spari_zalloc(most, sizeof *c->value);
    SPARI_REQUIRE(s, c->first && c->here && c->sum && c->value, SPAR_ERR_MEMORY,
                  "no memory for reproducible sums of loads on other nodes");
    for (int64_t r = 0; r < ranks; r++) {
        c->first[r + 1] = (r + 1) * c->words;
    }
    return spari_comm_prepare_bins(s->ranks.comm, s->message, sizeof s->message);
}

static void flag_own(const spar_session *s, moved_sums *c) {
    double *own = c->here + c->first[spari_comm_rank(s->ranks.comm)];
    for (int64_t k = 0; k < c->count; k++) {
        int64_t n = 0;
        (void)spar_fluid_get_count(c->fluids[k].fluid, SPAR_NODES_FORCE, &n);
        own[k / FLAGS] += n > 0 ? (double)(UINT32_C(1) << k % FLAGS) : 0;
    }
}

/* First rank with force nodes of the k-th fluid; 0 if none. */
static int holder_of(const spar_session *s, const moved_sums *c, int64_t k) {
    for (int r = 0; r < spari_comm_size(s->ranks.comm); r++) {
        if ((uint32_t)c->here[c->first[r] + k / FLAGS] >> k % FLAGS & 1) {
            return r;
        }
    }
    return 0;
}

static void put_sums(const spar_session *s, const moved_sums *c) {
    const spari_bins *sum = c->sum;
    for (int64_t k = 0; k < c->count; k++) {
        const spari_moved_loads *f = c->fluids + k;
        int64_t n = spari_fluid_moved_size(f->before);
        for (int64_t i = 0; i < n; i++) {
            c->value[i] = 0.5 * spari_bins_value(sum++);
        }
        int holds = holder_of(s, c, k) == spari_comm_rank(s->ranks.comm);
        spari_fluid_put_moved(f->fluid, f->before, holds ? c->value : NULL);
    }
}

static int carry(spar_session *s, const char *call, moved_sums *c) {
    int status = alloc_sums(s, c);
    const spari_agreed must_agree[] = {spari_hash("list of fluids (reproducible sums, on other nodes)", hash_of(c))};
    SPARI_TRY(spari_enter_agreed(s, call, must_agree, 1, status));
    flag_own(s, c);
    SPARI_TRY(spari_comm_share(s->ranks.comm, c->here, c->first, SPAR_OK, s->message, sizeof s->message));
    spari_bins *at = c->sum;
    for (int64_t k = 0; k < c->count; k++) {
        spari_fluid_add_moved(c->fluids[k].old, c->fluids[k].before, at);
        at += spari_fluid_moved_size(c->fluids[k].before);
    }
    SPARI_TRY(spari_comm_sum_bins(s->ranks.comm, c->sum, c->sums, SPAR_OK, s->message, sizeof s->message));
    put_sums(s, c);
    return SPAR_OK;
}

int spari_move_loads(spar_session *s, const char *call, int any, const spari_moved_loads *fluids, int64_t count) {
    moved_sums c = {.fluids = fluids, .count = count};
    if (!any || !s->ranks.reproducible || spari_comm_size(s->ranks.comm) == 1) {
        return SPAR_OK;
    }
    int status = carry(s, call, &c);
    SPARI_FREE(c.first, c.here, c.sum, c.value);
    return status;
}
