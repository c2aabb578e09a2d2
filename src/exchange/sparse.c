/* What goes to the ranks that touch it: see sparse.h. */
#include "sparse.h"

#include "../fluid/fluid.h"
#include "../assembly/assembly.h"
#include "motion_block.h"
#include "session_private.h"

#include <stdlib.h>
#include <string.h>

typedef struct spread_unit {
    spari_assembly *assembly; /* NULL: one member alone */
    spar_member *first;       /* of its members, as the session lists them */
    int owner, here;          /* the rank that solves it; whether this rank is one of its */
    int64_t loads_at, loads, motion_at, motion;
} spread_unit;

/* Units with one owner and the same ranks, one after the other: what goes in one message. */
typedef struct spread_group {
    int first, count;  /* its units */
    int outside;       /* some of its ranks stand aside: the core's exchange of motion does not reach them */
    spari_comm *ranks; /* NULL: there is nobody but this rank, or not even this */
    int64_t loads, motion;
} spread_group;

struct spari_spread {
    int count, groups, cores;
    spread_unit *unit;   /* by owner, the same order on every rank */
    spread_group *group; /* likewise */
    int *core;           /* the ranks of the core, ascending */
    spari_comm *ranks;   /* these, on one of them; NULL elsewhere */
    int64_t *first[2];   /* [cores + 1]: where the units that a rank of the core owns begin in the next two, each with a
                            word for the status behind them; on the core. Elsewhere only what is touched is there. */
    double *loads, *motion;
    int64_t load_count, motion_count;
    spari_bins *bins; /* of twice the loads; NULL: never asked for */
    spari_piece *piece;
};

/* Of its members the one after m. */
static spar_member *next_in(const spread_unit *u, const spar_member *m) {
    spar_member *next = u->assembly ? m->next : NULL;
    while (next && next->assembly != u->assembly) {
        next = next->next;
    }
    return next;
}

/* ---- who is where ---- */

/* Whether this rank's fluids move with a member, or have loads on it. */
static int touches(const spar_session *s, const spar_member *m) {
    for (const spar_fluid *f = s->fluids; f; f = spari_fluid_next(f)) {
        if (spari_fluid_member(f) == m && spari_fluid_touches(f)) {
            return 1;
        }
    }
    return 0;
}

static void take_unit(spari_spread *p, const spar_session *s, spar_member *m) {
    spread_unit *u = p->unit + p->count++;
    *u = (spread_unit){.assembly = m->assembly, .first = m, .owner = m->owner};
    u->here = u->owner == spari_comm_rank(s->comm);
    for (spar_member *k = m; k; k = next_in(u, k)) {
        u->here = u->here || touches(s, k);
        u->loads += 6 * k->nodes;
        u->motion += spari_block_size(k);
    }
    u->motion += u->assembly ? spari_assembly_share_size(u->assembly) : 0;
}

static int is_first_of_unit(const spar_session *s, const spar_member *m) {
    for (const spar_member *k = s->members; m->assembly && k != m; k = k->next) {
        if (k->assembly == m->assembly) {
            return 0;
        }
    }
    return 1;
}

/* Rank 0, which writes files, and the owners; and their units, rank by rank. */
static void find_units(spari_spread *p, const spar_session *s) {
    for (int r = 0; r < spari_comm_size(s->comm); r++) {
        int count = p->count;
        for (spar_member *m = s->members; m; m = m->next) {
            if (m->owner == r && is_first_of_unit(s, m)) {
                take_unit(p, s, m);
            }
        }
        if (r == 0 || p->count > count) {
            p->core[p->cores++] = r;
        }
    }
}

/* Where each unit lies that is to be here. */
static void lay_out(spari_spread *p, int all) {
    int k = 0;
    int64_t at[2] = {0, 0};
    for (int c = 0; c < p->cores; c++) {
        p->first[0][c] = at[0], p->first[1][c] = at[1];
        for (; k < p->count && p->unit[k].owner == p->core[c]; k++) {
            spread_unit *u = p->unit + k;
            u->loads_at = at[0], u->motion_at = at[1];
            at[0] += all || u->here ? u->loads : 0;
            at[1] += all || u->here ? u->motion : 0;
        }
        at[0]++, at[1]++;
    }
    p->first[0][p->cores] = p->load_count = at[0];
    p->first[1][p->cores] = p->motion_count = at[1];
}

/* ---- life ---- */

static void spread_free(spari_spread *p) {
    if (!p) {
        return;
    }
    for (int g = 0; g < p->groups; g++) {
        spari_comm_destroy(&p->group[g].ranks);
    }
    spari_comm_destroy(&p->ranks);
    free(p->unit);
    free(p->group);
    free(p->core);
    free(p->first[0]);
    free(p->first[1]);
    free(p->loads);
    free(p->motion);
    free(p->bins);
    free(p->piece);
    free(p);
}

static int stands_aside(const spari_spread *p, int rank) {
    for (int c = 0; c < p->cores; c++) {
        if (p->core[c] == rank) {
            return 0;
        }
    }
    return 1;
}

static spari_spread *spread_create(const spar_session *s) {
    int ranks = spari_comm_size(s->comm);
    spari_spread *p = spari_zalloc(1, sizeof *p);
    if (!p || !(p->unit = spari_zalloc(s->member_count, sizeof *p->unit)) ||
        !(p->group = spari_zalloc(s->member_count, sizeof *p->group)) ||
        !(p->core = spari_zalloc(ranks, sizeof *p->core)) ||
        !(p->piece = spari_zalloc(s->member_count, sizeof *p->piece))) {
        spread_free(p);
        return NULL;
    }
    find_units(p, s);
    int aside = stands_aside(p, spari_comm_rank(s->comm));
    int ok = (p->first[0] = spari_zalloc(p->cores + 1, sizeof *p->first[0])) &&
             (p->first[1] = spari_zalloc(p->cores + 1, sizeof *p->first[1]));
    if (ok) {
        lay_out(p, !aside);
        ok = (p->loads = spari_zalloc(p->load_count, sizeof *p->loads)) &&
             (p->motion = spari_zalloc(p->motion_count, sizeof *p->motion)) &&
             (aside || spari_comm_create_self(&p->ranks) == SPAR_OK);
    }
    if (!ok) {
        spread_free(p);
        return NULL;
    }
    return p;
}

/* flags[2 count + 1]: summed over the ranks, how many see a unit otherwise than the one before, and how many of those
   that stand aside are among its. */
static int find_groups(spar_session *s, spari_spread *p, double *flags) {
    int aside = stands_aside(p, spari_comm_rank(s->comm));
    for (int k = 0; k < p->count; k++) {
        flags[2 * k] = k > 0 && p->unit[k].here != p->unit[k - 1].here;
        flags[2 * k + 1] = aside && p->unit[k].here;
    }
    SPARI_TRY(spari_comm_sum(s->comm, flags, 2 * (int64_t)p->count, SPAR_OK, s->message, sizeof s->message));
    for (int k = 0; k < p->count; k++) {
        if (k == 0 || flags[2 * k] > 0 || p->unit[k].owner != p->unit[k - 1].owner) {
            p->group[p->groups++] = (spread_group){.first = k, .outside = flags[2 * k + 1] > 0};
        }
        spread_group *g = p->group + p->groups - 1;
        g->count++;
        g->loads += p->unit[k].loads;
        g->motion += p->unit[k].motion;
    }
    return SPAR_OK;
}

/* The communicators, all of them on every rank that is to have them. */
static int make_communicators(spar_session *s, spari_spread *p) {
    int aside = stands_aside(p, spari_comm_rank(s->comm));
    spari_comm *core = NULL;
    SPARI_TRY(spari_comm_split(s->comm, !aside, 0, &core, s->message, sizeof s->message));
    if (core) {
        spari_comm_destroy(&p->ranks);
        p->ranks = core;
    }
    for (int k = 0; k < p->groups; k++) {
        const spread_unit *u = p->unit + p->group[k].first;
        SPARI_TRY(spari_comm_split(s->comm, u->here, u->owner, &p->group[k].ranks, s->message, sizeof s->message));
    }
    return SPAR_OK;
}

int spari_spread_begin(spar_session *s) {
    spari_spread *p = spread_create(s);
    double *flags = p ? spari_zalloc(2 * (int64_t)p->count + 1, sizeof *flags) : NULL;
    int status = flags ? SPAR_OK : spari_fail(s, SPAR_ERR_MEMORY, "no memory for what the ranks share");
    status = spari_comm_agree(s->comm, status, s->message, sizeof s->message);
    status = status == SPAR_OK ? find_groups(s, p, flags) : status;
    status = status == SPAR_OK ? make_communicators(s, p) : status;
    free(flags);
    if (status != SPAR_OK) {
        spread_free(p);
        return status;
    }
    spari_spread_end(s);
    s->own->spread = p;
    s->apart = 1;
    s->aside = stands_aside(p, spari_comm_rank(s->comm));
    for (int k = 0; k < p->count; k++) {
        for (spar_member *m = p->unit[k].first; m; m = next_in(p->unit + k, m)) {
            m->away = !s->aside ? 0 : p->unit[k].here ? SPARI_LOADS_AWAY : SPARI_ALL_AWAY;
        }
    }
    return spari_spread_prepare(s);
}

void spari_spread_end(spar_session *s) {
    spread_free(s->own->spread);
    s->own->spread = NULL;
    s->apart = s->aside = 0;
    for (spar_member *m = s->members; m; m = m->next) {
        m->away = 0;
    }
}

int spari_spread_prepare(spar_session *s) {
    spari_spread *p = s->own->spread;
    if (!s->reproducible || p->bins) {
        return SPAR_OK;
    }
    p->bins = spari_zalloc(p->load_count, sizeof *p->bins);
    int status = p->bins ? spari_comm_prepare_bins(s->comm, s->message, sizeof s->message)
                         : spari_fail(s, SPAR_ERR_MEMORY, "no memory for reproducible sums over the ranks");
    status = spari_comm_agree(s->comm, status, s->message, sizeof s->message);
    if (status != SPAR_OK) { /* on all ranks or on none */
        free(p->bins);
        p->bins = NULL;
    }
    return status;
}

int spari_spread_refuse(spar_session *s, const char *call) {
    SPARI_REQUIRE(s, !s->apart, SPAR_ERR_STATE,
                  "%s: the ranks know what they touch only (option ranks.state = touched), and this needs all on each; "
                  "call it before the first step, or save, and load into a session with ranks.state = all",
                  call);
    return SPAR_OK;
}

/* ---- loads ---- */

/* Those of this rank's fluids, as doubles or as bins. */
static void add_own_loads(spar_session *s, spari_spread *p, spari_bins *bins) {
    for (int k = 0; k < p->count; k++) {
        int64_t at = p->unit[k].loads_at;
        for (spar_member *m = p->unit[k].first; m; at += 6 * m->nodes, m = next_in(p->unit + k, m)) {
            m->pack_at = at;
        }
    }
    for (const spar_fluid *f = s->fluids; f; f = spari_fluid_next(f)) {
        const spar_member *m = spari_fluid_member(f);
        if (m->away == SPARI_ALL_AWAY) {
            continue;
        }
        if (bins) {
            spari_fluid_add_bins(f, bins + m->pack_at);
        } else {
            spari_fluid_add_loads(f, p->loads + m->pack_at);
        }
    }
}

static void round_own(spari_spread *p, int rank) {
    for (int k = 0; k < p->count; k++) {
        const spread_unit *u = p->unit + k;
        for (int64_t i = u->loads_at; u->owner == rank && i < u->loads_at + u->loads; i++) {
            p->loads[i] = 0.5 * spari_bins_value(p->bins + i);
        }
    }
}

int spari_spread_loads(spar_session *s) {
    spari_spread *p = s->own->spread;
    spari_bins *bins = s->reproducible ? p->bins : NULL;
    int pieces = 0;
    memset(p->loads, 0, (size_t)p->load_count * sizeof *p->loads);
    if (bins) {
        memset(bins, 0, (size_t)p->load_count * sizeof *bins);
    }
    add_own_loads(s, p, bins);
    for (int k = 0; k < p->groups; k++) {
        const spread_group *g = p->group + k;
        int64_t at = p->unit[g->first].loads_at;
        if (g->ranks && g->loads > 0) {
            p->piece[pieces++] =
                (spari_piece){g->ranks, bins ? (void *)(bins + at) : (void *)(p->loads + at), g->loads};
        }
    }
    SPARI_TRY(spari_comm_collect(s->comm, p->piece, pieces, bins != NULL, s->message, sizeof s->message));
    if (bins) {
        round_own(p, spari_comm_rank(s->comm));
    }
    return s->aside ? SPAR_OK
                    : spari_comm_share(p->ranks, p->loads, p->first[0], SPAR_OK, s->message, sizeof s->message);
}

const double *spari_spread_loads_of(const spar_session *s, const spar_member *m) {
    return s->own->spread->loads + m->pack_at;
}

/* ---- motion ---- */

static void pack_unit(const spread_unit *u, double *to) {
    for (spar_member *m = u->first; m; m = next_in(u, m)) {
        to += spari_block_pack(m, to);
    }
    if (u->assembly) {
        spari_assembly_pack(u->assembly, to);
    }
}

static void unpack_unit(const spread_unit *u, const double *from) {
    for (spar_member *m = u->first; m; m = next_in(u, m)) {
        from += spari_block_unpack(m, from);
    }
    if (u->assembly) {
        spari_assembly_unpack(u->assembly, from);
    }
}

int spari_spread_motion(spar_session *s, int status) {
    spari_spread *p = s->own->spread;
    int rank = spari_comm_rank(s->comm), pieces = 0;
    for (int k = 0; k < p->count; k++) {
        const spread_unit *u = p->unit + k;
        if (u->owner == rank && status == SPAR_OK) {
            pack_unit(u, p->motion + u->motion_at);
        }
    }
    for (int k = 0; k < p->groups; k++) {
        const spread_group *g = p->group + k;
        if (g->ranks && g->outside && g->motion > 0) {
            p->piece[pieces++] = (spari_piece){g->ranks, p->motion + p->unit[g->first].motion_at, g->motion};
        }
    }
    SPARI_TRY(spari_comm_spread(s->comm, p->piece, pieces, status, s->message, sizeof s->message));
    if (!s->aside) {
        SPARI_TRY(spari_comm_share(p->ranks, p->motion, p->first[1], SPAR_OK, s->message, sizeof s->message));
    }
    for (int k = 0; k < p->count; k++) {
        const spread_unit *u = p->unit + k;
        if (u->owner != rank && (u->here || !s->aside)) {
            unpack_unit(u, p->motion + u->motion_at);
        }
    }
    return SPAR_OK;
}

/* ---- what the core has found ---- */

spari_comm *spari_spread_core(const spar_session *s) {
    return s->apart ? s->own->spread->ranks : s->comm;
}

int spari_spread_found(spar_session *s, int status, spari_found *found) {
    struct {
        int64_t status, ended;
        double residual, size;
    } told = {status, found->ended, found->residual, found->size};
    SPARI_TRY(spari_comm_broadcast(s->comm, &told, sizeof told, s->message, sizeof s->message));
    *found = (spari_found){(int)told.ended, told.residual, told.size};
    if (told.status != SPAR_OK) {
        char why[SPARI_MESSAGE_SIZE];
        memcpy(why, s->message, sizeof why);
        SPARI_TRY(spari_comm_broadcast(s->comm, why, sizeof why, s->message, sizeof s->message));
        why[sizeof why - 1] = '\0';
        return s->aside ? spari_fail(s, (int)told.status, "%s", why) : status;
    }
    return SPAR_OK;
}
