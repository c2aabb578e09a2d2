/* Between the ranks: loads up, motion down. */
#include "exchange.h"

#include "../comm/comm.h"
#include "../fluid/fluid.h"
#include "../member/body.h"
#include "../member/structure.h"
#include "own.h"

#include <stdlib.h>
#include <string.h>

/* Of a damped member the energy dissipated in the step goes along. */
static int is_damped(const spar_member *m) {
    return (m->effects & SPAR_EFFECT_DAMPING) != 0;
}

static int64_t block_size(const spar_member *m) {
    return m->body ? 19 * (int64_t)m->body->unique + is_damped(m) : 0;
}

int spari_session_seal(spar_session *s, int status) {
    int ranks = spari_comm_size(s->comm);
    int64_t count = 0, down = ranks; /* a status of each */
    for (spar_member *m = s->members; m; m = m->next) {
        count += m->committed ? 6 * m->nodes : 0;
        down += block_size(m);
    }
    if (status == SPAR_OK &&
        (!s->own->pack || s->own->pack_count != count || (s->own->first && s->own->first[ranks] != down))) {
        free(s->own->pack);
        free(s->own->first);
        free(s->own->motion);
        s->own->pack_count = count;
        s->own->first = NULL;
        s->own->motion = NULL;
        s->own->pack = spari_zalloc(count + 2, sizeof *s->own->pack);
        int ok = s->own->pack != NULL;
        if (ok && ranks > 1) {
            s->own->first = spari_zalloc(ranks + 1, sizeof *s->own->first);
            ok = s->own->first != NULL;
            for (int r = 0; r < ranks && ok; r++) {
                s->own->first[r + 1] = s->own->first[r] + 1; /* the status */
                for (const spar_member *m = s->members; m; m = m->next) {
                    s->own->first[r + 1] += m->owner == r ? block_size(m) : 0;
                }
            }
            ok = ok && (s->own->motion = spari_zalloc(s->own->first[ranks], sizeof *s->own->motion));
        }
        if (!ok) {
            free(s->own->pack);
            s->own->pack = NULL;
            status = spari_fail(s, SPAR_ERR_MEMORY, "no memory for what the ranks exchange");
        }
    }
    return spari_comm_agree(s->comm, status, s->message, sizeof s->message);
}

int spari_session_pushes(spar_session *s, const char *call) {
    const char *why;
    for (const spar_fluid *f = s->fluids; f; f = spari_fluid_next(f)) {
        int status = spari_fluid_refused(f, &why);
        SPARI_REQUIRE(s, status == SPAR_OK, status, "%s: a push was refused, push again (%.800s)", call, why);
    }
    return SPAR_OK;
}

int spari_session_exchange_loads(spar_session *s, int *pushed) {
    double *pushes = s->own->pack + s->own->pack_count;
    memset(s->own->pack, 0, (size_t)(s->own->pack_count + 2) * sizeof *s->own->pack);
    int64_t at = 0;
    for (spar_member *m = s->members; m; m = m->next) {
        m->pack_at = at;
        at += m->committed ? 6 * m->nodes : 0;
    }
    for (const spar_fluid *f = s->fluids; f; f = spari_fluid_next(f)) {
        if (spari_fluid_member(f)->committed) {
            spari_fluid_add_loads(f, s->own->pack + spari_fluid_member(f)->pack_at);
            *pushes += spari_fluid_has_loads(f);
        }
    }
    SPARI_TRY(spari_comm_sum(s->comm, s->own->pack, s->own->pack_count + 1, SPAR_OK, s->message, sizeof s->message));
    if (pushed) {
        *pushed = *pushes > 0;
    }
    return SPAR_OK;
}

void spari_session_take_loads(const spar_session *s, const spar_member *m, double *load) {
    memcpy(load, s->own->pack + m->pack_at, (size_t)(6 * m->nodes) * sizeof *load);
}

/* One member's block: unknowns' q, v, a; dissipation. */
static void pack_member(spar_member *m, double *to) {
    int64_t n = m->body->unique;
    spari_member_to_unique(m, 7, m->after.q, to);
    spari_member_to_unique(m, 6, m->after.v, to + 7 * n);
    spari_member_to_unique(m, 6, m->after.a, to + 13 * n);
    if (is_damped(m)) {
        to[19 * n] = m->dissipated_step;
    }
}

static void unpack_member(spar_member *m, const double *from) {
    int64_t n = m->body->unique;
    spari_member_from_unique(m, 7, from, m->after.q);
    spari_member_from_unique(m, 6, from + 7 * n, m->after.v);
    spari_member_from_unique(m, 6, from + 13 * n, m->after.a);
    m->dissipated_step = is_damped(m) ? from[19 * n] : 0;
}

int spari_session_share_motion(spar_session *s, int status) {
    int ranks = spari_comm_size(s->comm), rank = spari_comm_rank(s->comm);
    if (ranks == 1) {
        return status;
    }
    double *at = s->own->motion + s->own->first[rank];
    for (spar_member *m = s->members; m && status == SPAR_OK; m = m->next) {
        if (m->owner == rank && m->body) {
            pack_member(m, at);
            at += block_size(m);
        }
    }
    SPARI_TRY(spari_comm_share(s->comm, s->own->motion, s->own->first, status, s->message, sizeof s->message));
    for (int r = 0; r < ranks; r++) {
        at = s->own->motion + s->own->first[r];
        for (spar_member *m = s->members; m; m = m->next) {
            if (m->owner == r && m->body) {
                if (r != rank) {
                    unpack_member(m, at);
                }
                at += block_size(m);
            }
        }
    }
    return SPAR_OK;
}
