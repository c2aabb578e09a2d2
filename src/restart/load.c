/* Loads a saved session (save.c describes the file) into a session with the same members. Two passes: the first
   checks and allocates; only if all ranks can load, the second changes the session. Members and fluids may be on
   other ranks than before. Rank 0 reads, and no rank holds the whole file. Data common to all ranks are sent to all.
   For data of single ranks, rank 0 sends the positions, and the data then go piece by piece to the ranks that need
   them. */
#include "../assembly/assembly.h"
#include "../base/environment.h"
#include "../base/saved_file.h"
#include "../comm/enter.h"
#include "../exchange/rank_loads_and_motion.h"
#include "../fluid/fluid.h"
#include "../member/check_arguments.h"
#include "../time/fidelity.h"
#include "common_state.h"

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
    int64_t name; /* position of its name in the index */
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
    spari_saved common;
    spari_image index;  /* index of the rest, rank by rank, without states */
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
    spari_image_free(&l->index);
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

/* ---- data common to all ranks ---- */

/* Rank 0 reads until it has all; the contents determine the end. */
static int read_common(spar_session *s, reading *l) {
    spari_image *image = &l->common.image;
    int64_t n = 1 << 14;
    for (;; n *= 4) {
        n = n < l->source.count ? n : l->source.count;
        free(image->word);
        image->word = spari_zalloc(n, sizeof *image->word);
        if (!image->word) {
            return spari_saved_no_memory(s);
        }
        SPARI_TRY(tell_why(s, l, spari_loading_read(&l->source, 0, n, image->word, l->why, sizeof l->why)));
        image->count = image->capacity = n;
        char unheard[SPARI_MESSAGE_SIZE]; /* what is read may end too soon */
        char *before = spari_messages_redirect(unheard);
        int status = spari_saved_check(s, &l->common);
        (void)spari_messages_redirect(before);
        if (status == SPAR_OK) {
            image->count = image->at;
        }
        if (status == SPAR_OK || status == SPAR_ERR_MEMORY || n == l->source.count ||
            (status != SPAR_ERR_IO && !image->failed)) {
            return status == SPAR_ERR_MEMORY ? spari_saved_no_memory(s) : SPAR_OK; /* all ranks find other errors */
        }
    }
}

/* Sends rank 0's words to all ranks. */
static int send_image(spar_session *s, spari_image *image) {
    SPARI_TRY(spari_comm_broadcast(s->ranks.comm, &image->count, sizeof image->count, s->message, sizeof s->message));
    if (!is_root(s)) {
        image->word = spari_zalloc(image->count, sizeof *image->word);
    }
    SPARI_TRY(spari_agree(s, image->word ? SPAR_OK : spari_saved_no_memory(s)));
    return spari_comm_broadcast(s->ranks.comm, image->word, 8 * image->count, s->message, sizeof s->message);
}

static int load_common(spar_session *s, reading *l) {
    SPARI_TRY(spari_agree(s, is_root(s) ? read_common(s, l) : SPAR_OK));
    SPARI_TRY(send_image(s, &l->common.image));
    return spari_agree(s, spari_saved_check(s, &l->common));
}

/* ---- index of the rest: rank 0 reads it without the states ---- */

/* Reads words within a rank's block; reading past its end is a failure. */
typedef struct block_reader {
    reading *l;
    int64_t at, end;
    int failed;
} block_reader;

static void next_words(block_reader *b, int64_t n, uint64_t *words) {
    b->failed |= n < 0 || n > b->end - b->at;
    if (!b->failed) {
        read_words(b->l, b->at, n, words);
        b->at += n;
        b->failed |= b->l->status != SPAR_OK;
    }
}

static int64_t next_int(block_reader *b) {
    uint64_t word = 0;
    int64_t value = 0;
    next_words(b, 1, &word);
    memcpy(&value, &word, sizeof value);
    return b->failed ? 0 : value;
}

/* Copies n words to the index. */
static void copy_words(block_reader *b, int64_t n) {
    b->failed |= n < 0 || n > b->end - b->at;
    uint64_t *to = b->failed ? NULL : spari_image_add(&b->l->index, n);
    if (to) {
        next_words(b, n, to);
    }
}

/* Skips a counted block of words; its position and size go to the index, and its first `head` words (zeros if there
   are fewer). */
static void index_state(block_reader *b, int64_t head) {
    int64_t n = next_int(b);
    b->failed |= n < 0 || n > b->end - b->at;
    spari_image_put_int(&b->l->index, b->at);
    spari_image_put_int(&b->l->index, n);
    int64_t at = b->at, there = b->failed ? 0 : n < head ? n : head;
    copy_words(b, there);
    for (int64_t i = there; i < head; i++) {
        spari_image_put_int(&b->l->index, 0);
    }
    b->at = b->failed ? b->end : at + n;
}

/* Copies a text. */
static void index_text(block_reader *b) {
    int64_t length = next_int(b);
    b->failed |= length < 0 || length > INT64_MAX - 7;
    spari_image_put_int(&b->l->index, length);
    copy_words(b, b->failed ? 0 : (length + 7) / 8);
}

/* Solvers of members, of assemblies; fluids: each preceded by their number. */
static void index_block(block_reader *b) {
    spari_image *index = &b->l->index;
    for (int kind = 0; kind < 3 && !b->failed; kind++) {
        int64_t count = next_int(b);
        spari_image_put_int(index, count);
        for (int64_t i = 0; i < count && !b->failed && !index->failed; i++) {
            spari_image_put_int(index, next_int(b));
            if (kind == 2) {
                index_text(b);
            }
            index_state(b, kind == 2 ? SPARI_FLUID_HEAD : 0);
        }
    }
    b->failed |= b->at != b->end;
}

/* First word: whether the file can be read in this way. */
static int read_index(spar_session *s, reading *l) {
    block_reader all = {l, l->common.image.count, l->source.count, 0};
    spari_image_put_int(&l->index, 1);
    for (int r = 0; r < l->common.ranks && !all.failed; r++) {
        int64_t n = next_int(&all);
        all.failed |= n < 0 || n > all.end - all.at;
        block_reader block = {l, all.at, all.failed ? all.at : all.at + n, all.failed};
        index_block(&block);
        all.failed |= block.failed;
        all.at = block.end;
    }
    SPARI_TRY(tell_why(s, l, l->status));
    if (l->index.failed) {
        return spari_saved_no_memory(s);
    }
    l->index.word[0] = !all.failed && all.at == all.end;
    return SPAR_OK;
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

static int note_solver(spar_session *s, reading *l, int assembly) {
    int64_t k = spari_image_get_int(&l->index);
    int64_t at = spari_image_get_int(&l->index), count = spari_image_get_int(&l->index);
    if (l->index.failed || !(assembly ? assembly_at(s, k) != NULL : member_at(s, k) != NULL)) {
        return spari_saved_broken(s);
    }
    l->solvers[l->solver_count++] = (solver_record){assembly, (int)k, at, count};
    return SPAR_OK;
}

static int note_fluid(spar_session *s, reading *l, int rank) {
    int64_t k = spari_image_get_int(&l->index);
    fluid_record r = {.rank = rank, .name = l->index.at};
    (void)spari_image_is_text(&l->index, "");
    r.at = spari_image_get_int(&l->index);
    r.count = spari_image_get_int(&l->index);
    r.head = (const double *)(const void *)spari_image_get(&l->index, SPARI_FLUID_HEAD);
    const spar_member *m = member_at(s, k);
    if (l->index.failed || !m || r.count < SPARI_FLUID_HEAD ||
        !spari_fluid_is_state(m, r.head, r.count, &r.loads, &r.by)) {
        return spari_saved_broken(s);
    }
    r.member = (int)k;
    l->fluids[l->fluid_count++] = r;
    return SPAR_OK;
}

static int note_block(spar_session *s, reading *l, int rank) {
    for (int kind = 0; kind < 3; kind++) {
        int64_t count = spari_image_get_int(&l->index);
        for (int64_t i = 0; i < count; i++) {
            SPARI_TRY(kind == 2 ? note_fluid(s, l, rank) : note_solver(s, l, kind));
        }
    }
    return l->index.failed ? spari_saved_broken(s) : SPAR_OK;
}

static int load_index(spar_session *s, reading *l) {
    SPARI_TRY(spari_agree(s, is_root(s) ? read_index(s, l) : SPAR_OK));
    SPARI_TRY(send_image(s, &l->index));
    /* each record has at least three words in the index, a fluid's head too */
    l->solvers = spari_zalloc(l->index.count / 3, sizeof *l->solvers);
    l->fluids = spari_zalloc(l->index.count / (3 + SPARI_FLUID_HEAD), sizeof *l->fluids);
    int status = l->solvers && l->fluids ? SPAR_OK : spari_saved_no_memory(s);
    if (status == SPAR_OK && spari_image_get_int(&l->index) != 1) {
        status = spari_saved_broken(s);
    }
    for (int r = 0; r < l->common.ranks && status == SPAR_OK; r++) {
        status = note_block(s, l, r);
    }
    return spari_agree(s, status);
}

/* ---- distribution ---- */

static int is_record_of(reading *l, const fluid_record *r, const spar_fluid *f) {
    l->index.at = r->name;
    return r->member == spari_fluid_member(f)->number && spari_image_is_text(&l->index, spar_fluid_get_name(f));
}

static int same_key(const reading *l, const fluid_record *a, const fluid_record *b) {
    const uint64_t *x = l->index.word + a->name, *y = l->index.word + b->name;
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
    for (int64_t i = 0; i < l->fluid_count && status == SPAR_OK; i++) {
        const fluid_record *r = l->fluids + i;
        for (const spar_fluid *f = s->fluids; f && has[r->key * ranks + rank] == 0; f = spari_fluid_next(f)) {
            has[r->key * ranks + rank] = is_record_of(l, r, f);
        }
    }
    if (status == SPAR_OK) {
        status = spari_sum(s, has, l->keys * ranks);
    }
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
static int fetch_solvers(spar_session *s, reading *l) {
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
    return broken ? spari_saved_broken(s) : SPAR_OK;
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
        for (int k = 0; k < by->blocks; before += by->width[k], k++) {
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

static int load_solvers(spar_session *s, reading *l) {
    int status = fetch_solvers(s, l);
    return spari_agree(s, l->status != SPAR_OK ? tell_why(s, l, l->status) : status);
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
    int (*const parts[])(spar_session *, reading *) = {load_common, load_index, prepare, load_solvers, load_fluids};
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
