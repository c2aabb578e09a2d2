/* Loads a saved session (save.c describes the file) into a session with the same members. Two passes: the first
   checks and allocates; only if all ranks can load, the second changes the session. Members and fluids may be on
   other ranks than before. Rank 0 reads, and no rank holds the whole file. Data common to all ranks and the directories
   are sent to all. The states then go piece by piece to the ranks that need them. */
#include "../assembly/assembly.h"
#include "../base/environment.h"
#include "../base/saved_file.h"
#include "../comm/enter.h"
#include "../exchange/rank_loads_and_motion.h"
#include "../fluid/fluid.h"
#include "../member/check_arguments.h"
#include "../time/fidelity.h"
#include "common_state.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

/* Solver state of a member or assembly in the file. */
typedef struct solver_record {
    int assembly, index;
    int64_t at, count;
} solver_record;

/* A fluid of the saved run. */
typedef struct fluid_record {
    int rank, member;
    int64_t name; /* position of its name in the directories */
    int64_t at, count;
    int64_t loads; /* words before the data per node */
    spari_by_node by;
    const double *head; /* [SPARI_FLUID_HEAD] */
    int key;            /* equal for fluids with the same name and member */
} fluid_record;

typedef struct reading {
    const char *call;
    spari_loading source; /* on rank 0 */
    int status;           /* status of reading here, */
    char why[SPARI_MESSAGE_SIZE / 2];
    spari_saved common; /* and the directories */
    int64_t at, end;    /* position of the next state that the directories name; words of the file */
    double **solution;  /* [members] state of each member solved here; NULL: not here */
    double **assembled; /* [joints] the same for assemblies; NULL: none */
    solver_record *solvers;
    int64_t solver_count;
    fluid_record *fluids; /* of all ranks */
    int64_t fluid_count, keys;
    int *taker;       /* [keys]: rank whose fluid receives their loads, which are a sum */
    int exact;        /* each fluid here reads only that of its own rank in the saved run */
    uint64_t *buffer; /* for transfers between ranks */
} reading;

enum { PIECE_NODES = 4096, NODE_WORDS = 15, PIECE = NODE_WORDS * PIECE_NODES };

static void end_loading(const spar_session *s, reading *l) {
    spari_loading_close(&l->source);
    spari_saved_free(&l->common);
    for (int k = 0; l->solution && k < s->member_count; k++) {
        free(l->solution[k]);
    }
    for (int k = 0; l->assembled && k < s->joint_count; k++) {
        free(l->assembled[k]);
    }
    SPARI_FREE(l->solution, l->assembled, l->solvers, l->fluids, l->taker, l->buffer);
    spari_fluids_each(s, spari_fluid_give_up);
}

/* Whether all ranks have allocated; SPAR_OK only if this one has. */
static int agree_on_memory(spar_session *s, int have) {
    int status = spari_agree(s, have ? SPAR_OK : spari_saved_no_memory(s));
    return have ? status : SPAR_ERR_MEMORY;
}

static int is_root(const spar_session *s) {
    return spari_comm_rank(s->ranks.comm) == 0;
}

static int tell_why(spar_session *s, const reading *l, int status) {
    return status == SPAR_OK ? SPAR_OK : spari_fail(s, status, "%s", l->why);
}

/* ---- the file ---- */

static int open_file(spar_session *s, reading *l, const char *path) {
    int status = SPAR_OK;
    if (is_root(s)) {
        status = spari_loading_open(&l->source, path, l->why, sizeof l->why);
        status = status == SPAR_OK ? spari_loading_check(&l->source, l->why, sizeof l->why) : status;
    }
    return spari_agree(s, tell_why(s, l, status));
}

/* Words that cannot be read are zeros; the failure is reported after all ranks have received. */
static void read_words(reading *l, int64_t at, int64_t n, uint64_t *words) {
    int status = l->status;
    if (status == SPAR_OK) {
        status = l->status = spari_loading_read(&l->source, at, n, words, l->why, sizeof l->why);
    }
    if (status != SPAR_OK && n > 0) {
        memset(words, 0, (size_t)n * sizeof *words);
    }
}

/* Sends words of the file to rank `to`, or to all. wanted: whether they are needed here. Collective, except for a
   single rank. */
enum { EVERYBODY = -1 };
static int fetch_words(spar_session *s, reading *l, int to, int wanted, int64_t at, int64_t n, uint64_t *words) {
    for (int64_t i = 0; i < n; i += PIECE) {
        int64_t piece = n - i < PIECE ? n - i : PIECE;
        uint64_t *by = wanted ? words + i : l->buffer;
        if (is_root(s)) {
            read_words(l, at + i, piece, by);
        }
        SPARI_TRY(to == EVERYBODY
                      ? spari_comm_broadcast(s->ranks.comm, by, 8 * piece, s->message, sizeof s->message)
                      : spari_comm_move(s->ranks.comm, 0, to, by, 8 * piece, s->message, sizeof s->message));
    }
    return SPAR_OK;
}

/* ---- data common to all ranks, and the directories ---- */

static int load_common(spar_session *s, reading *l) {
    spari_image *image = &l->common.image;
    int64_t count[2] = {0, l->source.count};
    if (is_root(s)) {
        read_words(l, 0, 1, (uint64_t *)count);
    }
    SPARI_TRY(spari_comm_broadcast(s->ranks.comm, count, sizeof count, s->message, sizeof s->message));
    image->count = count[0] > 0 && count[0] < count[1] ? count[0] : 0;
    l->end = count[1];
    l->at = 1 + image->count;
    image->word = spari_zalloc(image->count, sizeof *image->word);
    SPARI_TRY(spari_agree(s, image->word ? SPAR_OK : spari_saved_no_memory(s)));
    SPARI_TRY(fetch_words(s, l, EVERYBODY, 1, 1, image->count, image->word));
    SPARI_TRY(spari_agree(s, tell_why(s, l, l->status)));
    return spari_agree(s, spari_saved_check(s, &l->common));
}

static const spar_member *member_at(const spar_session *s, int64_t k) {
    const spar_member *m = k < 0 ? NULL : s->members;
    for (int64_t j = 0; j < k && m; j++) {
        m = m->next;
    }
    return m;
}

static const spari_assembly *assembly_at(const spar_session *s, int64_t k) {
    const spari_assembly *a = k < 0 ? NULL : s->assemblies;
    for (int64_t j = 0; j < k && a; j++) {
        a = spari_assembly_next(a);
    }
    return a;
}

static int is_fluid(const spar_session *s, spari_image *image, fluid_record *r) {
    const spar_member *m = member_at(s, r->member);
    r->name = image->at;
    (void)spari_image_is_text(image, "");
    r->head = (const double *)(const void *)spari_image_get(image, SPARI_FLUID_HEAD);
    return m && r->head && r->count >= SPARI_FLUID_HEAD &&
           spari_fluid_is_state(m, r->head, r->count, &r->loads, &r->by);
}

/* Notes the next state in the directory of a rank. */
static int note_state(spar_session *s, reading *l, int rank, int64_t kind) {
    spari_image *image = &l->common.image;
    const int64_t k = spari_image_get_int(image), count = spari_image_get_int(image);
    int ok = !image->failed && count >= 0 && count <= l->end - l->at && k <= INT_MAX;
    if (ok && kind == SPARI_SAVED_FLUID) {
        fluid_record r = {.rank = rank, .member = (int)k, .at = l->at, .count = count};
        ok = is_fluid(s, image, &r);
        if (ok) {
            l->fluids[l->fluid_count++] = r;
        }
    } else if (ok) {
        ok = kind == SPARI_SAVED_ASSEMBLY ? assembly_at(s, k) != NULL
                                          : kind == SPARI_SAVED_MEMBER && member_at(s, k) != NULL;
        l->solvers[l->solver_count++] = (solver_record){kind == SPARI_SAVED_ASSEMBLY, (int)k, l->at, count};
    }
    l->at += ok ? count : 0;
    return ok ? SPAR_OK : spari_saved_broken(s);
}

static int load_directories(spar_session *s, reading *l) {
    spari_image *image = &l->common.image;
    const int64_t most = (image->count - image->at) / 3; /* a state has at least three words */
    l->solvers = spari_zalloc(most, sizeof *l->solvers);
    l->fluids = spari_zalloc(most / 4, sizeof *l->fluids); /* and a fluid's head */
    int status = l->solvers && l->fluids ? SPAR_OK : spari_saved_no_memory(s);
    for (int r = 0; r < l->common.ranks && status == SPAR_OK;) {
        const int64_t kind = spari_image_get_int(image);
        status = kind == SPARI_SAVED_END ? SPAR_OK : note_state(s, l, r, kind);
        r += kind == SPARI_SAVED_END;
    }
    if (status == SPAR_OK && (image->at != image->count || l->at != l->end)) {
        status = spari_saved_broken(s);
    }
    return spari_agree(s, status);
}

/* ---- distribution ---- */

static int is_record_of(reading *l, const fluid_record *r, const spar_fluid *f) {
    l->common.image.at = r->name;
    return r->member == spari_fluid_member(f)->number && spari_image_is_text(&l->common.image, spar_fluid_get_name(f));
}

static int same_key(const reading *l, const fluid_record *a, const fluid_record *b) {
    const uint64_t *x = l->common.image.word + a->name, *y = l->common.image.word + b->name;
    return a->member == b->member && x[0] == y[0] && memcmp(x + 1, y + 1, (size_t)((x[0] + 7) / 8) * sizeof *x) == 0;
}

/* Ranks have fluids in similar order, so the search continues from the last match. by[keys]: the first of each. */
static int find_keys(spar_session *s, reading *l) {
    int64_t *by = spari_zalloc(l->fluid_count, sizeof *by), at = 0;
    if (!by) {
        return spari_saved_no_memory(s);
    }
    for (int64_t i = 0; i < l->fluid_count; i++) {
        int64_t tried = 0;
        for (at++; tried < l->keys; tried++, at++) {
            at = at < l->keys ? at : 0;
            if (same_key(l, l->fluids + i, l->fluids + by[at])) {
                break;
            }
        }
        if (tried == l->keys) {
            at = l->keys++;
            by[at] = i;
        }
        l->fluids[i].key = (int)at;
    }
    free(by);
    return SPAR_OK;
}

/* Whether the fluids here equal those of this rank in the file, one by one. */
static int same_fluids(const spar_session *s, reading *l) {
    int rank = spari_comm_rank(s->ranks.comm);
    const spar_fluid *f = s->fluids;
    for (int64_t i = 0; i < l->fluid_count; i++) {
        if (l->fluids[i].rank == rank) {
            if (!f || !is_record_of(l, l->fluids + i, f)) {
                return 0;
            }
            f = spari_fluid_next(f);
        }
    }
    return !f && l->common.ranks == spari_comm_size(s->ranks.comm);
}

/* Rank whose fluid receives the loads of a key: the first with such a fluid. */
static int find_takers(spar_session *s, reading *l) {
    int ranks = spari_comm_size(s->ranks.comm), rank = spari_comm_rank(s->ranks.comm);
    double *has = spari_zalloc(l->keys * ranks + 1, sizeof *has);
    l->taker = spari_zalloc(l->keys, sizeof *l->taker);
    int status = agree_on_memory(s, has && l->taker);
    if (status != SPAR_OK || !has) {
        free(has);
        return status;
    }
    for (int64_t i = 0; i < l->fluid_count; i++) {
        const fluid_record *r = l->fluids + i;
        for (const spar_fluid *f = s->fluids; f && has[r->key * ranks + rank] == 0; f = spari_fluid_next(f)) {
            has[r->key * ranks + rank] = is_record_of(l, r, f);
        }
    }
    status = spari_sum(s, has, l->keys * ranks);
    for (int64_t i = 0; i < l->fluid_count && status == SPAR_OK; i++) {
        int *taker = l->taker + l->fluids[i].key;
        for (*taker = 0; *taker < ranks && has[l->fluids[i].key * ranks + *taker] == 0;) {
            ++*taker;
        }
        if (*taker == ranks) {
            status = spari_fail(s, SPAR_ERR_ARGUMENT,
                                "fluid %lld of the file matches no fluid of this session by name and member; create "
                                "the fluids of the saved run first",
                                (long long)i);
        }
    }
    free(has);
    return status;
}

/* Whether a fluid here reads from a record. own: number of this rank's records before. */
static int takes(const spar_session *s, reading *l, const fluid_record *r, const spar_fluid *f, int64_t own) {
    if (!l->exact) {
        return is_record_of(l, r, f);
    }
    const spar_fluid *at = r->rank == spari_comm_rank(s->ranks.comm) ? s->fluids : NULL;
    for (; at && own > 0; own--) {
        at = spari_fluid_next(at);
    }
    return at == f;
}

static int take_fluid(spar_session *s, reading *l, spar_fluid *f, const double **heads) {
    int count = 0;
    int64_t own = 0;
    for (int64_t i = 0; i < l->fluid_count; i++) {
        const fluid_record *r = l->fluids + i;
        if (takes(s, l, r, f, own)) {
            heads[count++] = r->head;
        }
        own += r->rank == spari_comm_rank(s->ranks.comm);
    }
    SPARI_REQUIRE(s, count > 0, SPAR_ERR_ARGUMENT, "fluid '%s' of member '%s' is not in the file",
                  spar_fluid_get_name(f), spari_fluid_member(f)->name);
    return spari_fluid_take(f, l->call, count, heads);
}

/* Allocates the solver states needed here; each is in the file once. */
static int alloc_solvers(spar_session *s, reading *l) {
    l->solution = spari_zalloc(s->member_count, sizeof *l->solution);
    l->assembled = spari_zalloc(s->joint_count, sizeof *l->assembled);
    int ok = l->solution && l->assembled, twice = 0;
    for (int64_t i = 0; i < l->solver_count && ok && !twice; i++) {
        const solver_record *r = l->solvers + i;
        double **to = (r->assembly ? l->assembled : l->solution) + r->index;
        int wanted = r->assembly ? spari_assembly_state_size(assembly_at(s, r->index)) > 0
                                 : spari_fidelity_state_size(member_at(s, r->index)) > 0;
        twice = wanted && *to;
        if (wanted && !twice) {
            ok = (*to = spari_zalloc(r->count, sizeof **to)) != NULL;
        }
    }
    return twice ? spari_saved_broken(s) : ok ? SPAR_OK : spari_saved_no_memory(s);
}

static int prepare(spar_session *s, reading *l) {
    int64_t capacity = PIECE;
    for (int64_t i = 0; i < l->fluid_count; i++) {
        capacity = l->fluids[i].loads > capacity ? l->fluids[i].loads : capacity;
    }
    l->buffer = spari_zalloc(capacity, sizeof *l->buffer);
    int status = l->buffer ? alloc_solvers(s, l) : spari_saved_no_memory(s);
    return spari_agree(s, status == SPAR_OK ? find_keys(s, l) : status);
}

/* ---- the states ---- */

/* Sends each to the ranks that have allocated it. */
static int load_solvers(spar_session *s, reading *l) {
    int broken = 0;
    for (int64_t i = 0; i < l->solver_count; i++) {
        const solver_record *r = l->solvers + i;
        double *to = (r->assembly ? l->assembled : l->solution)[r->index];
        SPARI_TRY(fetch_words(s, l, EVERYBODY, to != NULL, r->at, r->count, (uint64_t *)(void *)to));
        if (to && l->status == SPAR_OK) {
            const spar_member *m = r->assembly ? NULL : member_at(s, r->index);
            broken |= m ? !m->row->is_state(m, to, r->count)
                        : !spari_assembly_is_state(assembly_at(s, r->index), to, r->count);
        }
    }
    int k = 0;
    for (const spar_member *m = s->members; m; m = m->next, k++) {
        broken |= spari_fidelity_state_size(m) > 0 && !l->solution[k];
    }
    int status = l->status != SPAR_OK ? tell_why(s, l, l->status) : broken ? spari_saved_broken(s) : SPAR_OK;
    return spari_agree(s, status);
}

/* Next words of a record, in the buffer, to the fluids that read from it. */
static int fetch_piece(spar_session *s, reading *l, const fluid_record *r, int wanted, int64_t at, int64_t n,
                       int64_t put) {
    return fetch_words(s, l, l->exact ? r->rank : EVERYBODY, wanted, r->at + at, n, l->buffer + put);
}

static int fetch_fluid(spar_session *s, reading *l, const fluid_record *r, int64_t own) {
    int rank = spari_comm_rank(s->ranks.comm), wanted = 0, broken = 0;
    const double *words = (const double *)(const void *)l->buffer;
    for (const spar_fluid *f = s->fluids; f; f = spari_fluid_next(f)) {
        wanted |= takes(s, l, r, f, own);
    }
    if (l->exact && !wanted && rank > 0) {
        return SPAR_OK;
    }
    SPARI_TRY(fetch_piece(s, l, r, wanted, 0, r->loads, 0));
    for (spar_fluid *f = s->fluids; f && l->status == SPAR_OK; f = spari_fluid_next(f)) {
        if (takes(s, l, r, f, own)) {
            broken |= !spari_fluid_take_loads(f, words, l->exact || l->taker[r->key] == rank);
        }
    }
    const spari_by_node *by = &r->by;
    int64_t most = by->all > 0 ? PIECE / by->all : 1;
    for (int64_t i = 0; i < by->nodes; i += most) {
        int64_t n = by->nodes - i < most ? by->nodes - i : most, before = 0;
        for (int k = 0; k < SPARI_FLUID_BLOCKS; before += by->width[k], k++) {
            int64_t width = by->width[k];
            SPARI_TRY(fetch_piece(s, l, r, wanted, r->loads + before * by->nodes + width * i, width * n, before * n));
        }
        for (spar_fluid *f = s->fluids; f && l->status == SPAR_OK; f = spari_fluid_next(f)) {
            if (takes(s, l, r, f, own)) {
                spari_fluid_take_nodes(f, r->head, i, n, words);
            }
        }
    }
    return broken ? spari_saved_broken(s) : SPAR_OK;
}

static int take_fluids(spar_session *s, reading *l) {
    const double **heads = spari_zalloc(l->fluid_count, sizeof *heads);
    if (!heads) {
        return agree_on_memory(s, 0);
    }
    int status = SPAR_OK;
    for (spar_fluid *f = s->fluids; f && status == SPAR_OK; f = spari_fluid_next(f)) {
        status = take_fluid(s, l, f, heads);
    }
    free(heads);
    return spari_agree(s, status);
}

static int fetch_fluids(spar_session *s, reading *l) {
    int64_t own = 0;
    int found = SPAR_OK;
    SPARI_TRY(take_fluids(s, l));
    for (int64_t i = 0; i < l->fluid_count; i++) {
        int status = fetch_fluid(s, l, l->fluids + i, own);
        found = found == SPAR_OK ? status : found;
        own += l->fluids[i].rank == spari_comm_rank(s->ranks.comm);
    }
    return spari_agree(s, l->status != SPAR_OK ? tell_why(s, l, l->status) : found);
}

/* With the same number of ranks and fluids, nodes may still be distributed otherwise; only their positions tell. */
static int load_fluids(spar_session *s, reading *l) {
    int other = 0, lost = 0, status = SPAR_OK;
    SPARI_TRY(spari_anywhere(s, !same_fluids(s, l), &other));
    l->exact = !other;
    if (l->exact) {
        SPARI_TRY(fetch_fluids(s, l));
        for (spar_fluid *f = s->fluids; f; f = spari_fluid_next(f)) {
            lost |= spari_fluid_first_missing(f) >= 0;
        }
        SPARI_TRY(spari_anywhere(s, lost, &other));
        if (!other) {
            return SPAR_OK;
        }
        l->exact = 0;
    }
    SPARI_TRY(find_takers(s, l));
    SPARI_TRY(fetch_fluids(s, l));
    for (spar_fluid *f = s->fluids; f && status == SPAR_OK; f = spari_fluid_next(f)) {
        status = spari_fluid_loaded_whole(f, l->call);
    }
    return spari_agree(s, status);
}

/* ---- putting in force ---- */

static void put_in_force(spar_session *s, reading *l) {
    int64_t k = 0;
    spari_saved_load(s, &l->common);
    for (spar_member *m = s->members; m; m = m->next, k++) {
        if (spari_fidelity_state_size(m) > 0) {
            m->row->load(m, l->solution[k]);
        }
    }
    k = 0;
    for (spari_assembly *a = s->assemblies; a; a = spari_assembly_next(a), k++) {
        spari_assembly_load(a, l->assembled[k]);
    }
    spari_fluids_each(s, spari_fluid_load);
}

int spar_session_load(spar_session *session, const char *path) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_REQUIRE(NULL, session, SPAR_ERR_ARGUMENT, "%s: the session is NULL; create it first", __func__);
    spar_session *s = session;
    reading l = {.call = __func__};
    int status = spari_saved_check_call(s, __func__, path);
    status = status == SPAR_OK ? spari_need_idle(s, __func__) : status;
    SPARI_TRY(spari_enter_agreed(s, __func__, NULL, 0, status));
    status = open_file(s, &l, path); /* without a file, nothing of the joints is created */
    status = status == SPAR_OK ? spari_solvers_place(s, __func__) : status;
    int (*const parts[])(spar_session *, reading *) = {load_common, load_directories, prepare, load_solvers,
                                                       load_fluids};
    for (size_t k = 0; k < sizeof parts / sizeof *parts && status == SPAR_OK; k++) {
        status = parts[k](s, &l);
    }
    status = status == SPAR_OK ? spari_session_seal(s, SPAR_OK) : status;
    if (status == SPAR_OK) {
        put_in_force(s, &l);
    }
    end_loading(s, &l);
    return spari_named(s, __func__, status);
}
