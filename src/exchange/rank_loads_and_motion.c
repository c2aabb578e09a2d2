/* Exchange between ranks: sums loads, distributes motion. See rank_loads_and_motion.h. */
#include "rank_loads_and_motion.h"

#include "../assembly/assembly.h"
#include "../comm/enter.h"
#include "../fluid/fluid.h"
#include "../member/body.h"
#include "session_private.h"

#include <stdlib.h>
#include <string.h>

/* ---- a member's motion in a message ---- */

/* The dissipated energy of a damped member goes with its motion. */
static int is_damped(const spar_member *m) {
    return (m->effects & SPAR_EFFECT_DAMPING) != 0;
}

/* Doubles that a member's message has: position, velocity and acceleration of its unknowns' nodes, and the energy
   dissipated in the step. 0: all ranks move the member by themselves. */
static int64_t motion_size(const spar_member *m) {
    return m->body ? 19 * (int64_t)m->body->unique + is_damped(m) : 0;
}

/* From the motion after the step. Returns motion_size. */
static int64_t pack_motion(const spar_member *m, double *to) {
    int64_t n = m->body ? m->body->unique : 0;
    if (n > 0) {
        spari_member_to_unique(m, 7, m->after.q, to);
        spari_member_to_unique(m, 6, m->after.v, to + 7 * n);
        spari_member_to_unique(m, 6, m->after.a, to + 13 * n);
        if (is_damped(m)) {
            to[19 * n] = m->state.dissipated_step;
        }
    }
    return motion_size(m);
}

/* Into the motion after the step. Returns motion_size. */
static int64_t unpack_motion(spar_member *m, const double *from) {
    int64_t n = m->body ? m->body->unique : 0;
    if (n > 0) {
        spari_member_from_unique(m, 7, from, m->after.q);
        spari_member_from_unique(m, 6, from + 7 * n, m->after.v);
        spari_member_from_unique(m, 6, from + 13 * n, m->after.a);
        m->state.dissipated_step = is_damped(m) ? from[19 * n] : 0;
    }
    return motion_size(m);
}

/* ---- memory ---- */

/* Doubles that a rank sends to the others, with its status. */
static int64_t block_of_rank(const spar_session *s, int rank) {
    int64_t n = 1;
    for (const spar_member *m = s->members; m; m = m->next) {
        n += m->owner == rank ? motion_size(m) : 0;
    }
    for (const spari_assembly *a = s->assemblies; a; a = spari_assembly_next(a)) {
        n += spari_assembly_owner(a) == rank ? spari_assembly_share_size(a) : 0;
    }
    return n;
}

/* Whether members or joints were added since the blocks were laid out. */
static int fits_blocks(const spar_session *s) {
    const int64_t *first = s->own->exchange.first;
    int fits = 1;
    for (int r = 0; r < spari_comm_size(s->ranks.comm) && first; r++) {
        fits = fits && first[r + 1] - first[r] == block_of_rank(s, r);
    }
    return fits;
}

static void free_bins(spar_session *s) {
    free(s->own->bins);
    s->own->bins = NULL;
    s->own->bins_capacity = 0;
}

/* Never shrinks: a trial returns to members with more nodes. */
static int make_bins(spar_session *s, int64_t count) {
    if (s->own->bins_capacity < count) {
        free_bins(s);
        s->own->bins = spari_zalloc(count, sizeof *s->own->bins);
        SPARI_REQUIRE(s, s->own->bins, SPAR_ERR_MEMORY, "no memory for reproducible sums over the ranks");
        s->own->bins_capacity = count;
    }
    return spari_comm_prepare_bins(s->ranks.comm, s->message, sizeof s->message);
}

int spari_session_seal(spar_session *s, int status) {
    int ranks = spari_comm_size(s->ranks.comm);
    spari_exchange *x = &s->own->exchange;
    int64_t count = 0;
    for (spar_member *m = s->members; m; m = m->next) {
        count += m->committed ? 6 * m->nodes : 0;
    }
    if (status == SPAR_OK && (!x->pack || x->pack_count != count || !fits_blocks(s))) {
        SPARI_FREE(x->pack, x->first, x->motion);
        *x = (spari_exchange){.pack = spari_zalloc(count + 2, sizeof *x->pack), .pack_count = count};
        int ok = x->pack != NULL;
        if (ok && ranks > 1) {
            x->first = spari_zalloc(ranks + 1, sizeof *x->first);
            ok = x->first != NULL;
            for (int r = 0; r < ranks && ok; r++) {
                x->first[r + 1] = x->first[r] + block_of_rank(s, r);
            }
            ok = ok && (x->motion = spari_zalloc(x->first[ranks], sizeof *x->motion));
        }
        if (!ok) {
            free(x->pack);
            x->pack = NULL;
            status = spari_fail(s, SPAR_ERR_MEMORY, "no memory for the exchange between ranks");
        }
    }
    if (status == SPAR_OK && s->ranks.reproducible) {
        status = make_bins(s, count + 2);
    }
    status = spari_agree(s, status);
    if (status != SPAR_OK) { /* on all ranks or none: spari_session_is_sealed must agree */
        free_bins(s);
    }
    return status;
}

int spari_session_is_sealed(const spar_session *s) {
    return !s->ranks.reproducible || s->own->bins_capacity >= s->own->exchange.pack_count + 2;
}

/* ---- loads ---- */

int spari_session_pushes(spar_session *s, const char *call) {
    const char *why;
    for (const spar_fluid *f = s->fluids; f; f = spari_fluid_next(f)) {
        int status = spari_fluid_refused(f, &why);
        SPARI_REQUIRE(s, status == SPAR_OK, status, "%s: a push failed; push again (%.800s)", call, why);
    }
    return SPAR_OK;
}

int spari_session_mapped(spar_session *s, const char *call) {
    for (const spar_fluid *f = s->fluids; f; f = spari_fluid_next(f)) {
        SPARI_TRY(spari_fluid_need_mapped(f, call));
    }
    return SPAR_OK;
}

/* Reproducible sum of the fluids' loads, in any distribution of fluids and nodes. */
static int sum_bins(spar_session *s, int64_t count, double pushes) {
    spari_bins *bins = s->own->bins;
    memset(bins, 0, (size_t)(count + 2) * sizeof *bins);
    for (const spar_fluid *f = s->fluids; f; f = spari_fluid_next(f)) {
        if (spari_fluid_member(f)->committed) {
            spari_fluid_add_bins(f, bins + spari_fluid_member(f)->load.pack_at);
        }
    }
    spari_bins_add(bins + count, pushes);
    SPARI_TRY(spari_comm_sum_bins(s->ranks.comm, bins, count + 1, SPAR_OK, s->message, sizeof s->message));
    for (int64_t i = 0; i < count; i++) {
        s->own->exchange.pack[i] = 0.5 * spari_bins_value(bins + i);
    }
    s->own->exchange.pack[count] = spari_bins_value(bins + count);
    return SPAR_OK;
}

int spari_session_exchange_loads(spar_session *s, int *pushed) {
    double *pushes = s->own->exchange.pack + s->own->exchange.pack_count;
    memset(s->own->exchange.pack, 0, (size_t)(s->own->exchange.pack_count + 2) * sizeof *s->own->exchange.pack);
    int64_t at = 0;
    for (spar_member *m = s->members; m; m = m->next) {
        m->load.pack_at = at;
        at += m->committed ? 6 * m->nodes : 0;
    }
    for (const spar_fluid *f = s->fluids; f; f = spari_fluid_next(f)) {
        if (spari_fluid_member(f)->committed) {
            if (!s->ranks.reproducible) {
                spari_fluid_add_loads(f, s->own->exchange.pack + spari_fluid_member(f)->load.pack_at);
            }
            *pushes += spari_fluid_has_loads(f);
        }
    }
    SPARI_TRY(s->ranks.reproducible ? sum_bins(s, s->own->exchange.pack_count, *pushes)
                                    : spari_sum(s, s->own->exchange.pack, s->own->exchange.pack_count + 1));
    SPARI_GIVE(pushed, *pushes > 0);
    return SPAR_OK;
}

int spari_session_moved(spar_session *s, int *moved) {
    *moved = 0;
    return spari_joints_hold_prescribed(s) ? spari_anywhere(s, spari_joints_hold_moved(s), moved) : SPAR_OK;
}

void spari_session_take_loads(const spar_session *s, const spar_member *m, double *load) {
    memcpy(load, s->own->exchange.pack + m->load.pack_at, (size_t)(6 * m->nodes) * sizeof *load);
    spari_joints_on_external(m, load);
}

/* Writes this rank's results into its block. */
static void pack_own(spar_session *s, int rank, double *at) {
    for (spar_member *m = s->members; m; m = m->next) {
        at += m->owner == rank ? pack_motion(m, at) : 0;
    }
    for (const spari_assembly *a = s->assemblies; a; a = spari_assembly_next(a)) {
        if (spari_assembly_owner(a) == rank) {
            spari_assembly_pack(a, at);
            at += spari_assembly_share_size(a);
        }
    }
}

static void unpack_peer(spar_session *s, int peer, const double *at) {
    for (spar_member *m = s->members; m; m = m->next) {
        at += m->owner == peer ? unpack_motion(m, at) : 0;
    }
    for (spari_assembly *a = s->assemblies; a; a = spari_assembly_next(a)) {
        if (spari_assembly_owner(a) == peer) {
            spari_assembly_unpack(a, at);
            at += spari_assembly_share_size(a);
        }
    }
}

int spari_session_share_motion(spar_session *s, int status) {
    int ranks = spari_comm_size(s->ranks.comm), rank = spari_comm_rank(s->ranks.comm);
    if (ranks == 1) {
        return status;
    }
    if (status == SPAR_OK) {
        pack_own(s, rank, s->own->exchange.motion + s->own->exchange.first[rank]);
    }
    SPARI_TRY(spari_comm_share(s->ranks.comm, s->own->exchange.motion, s->own->exchange.first, status, s->message,
                               sizeof s->message));
    for (int r = 0; r < ranks; r++) {
        if (r != rank) {
            unpack_peer(s, r, s->own->exchange.motion + s->own->exchange.first[r]);
        }
    }
    return SPAR_OK;
}
