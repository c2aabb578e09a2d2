/* Communication over an MPI communicator. */
#include "ranks.h"

#ifdef SPARI_HAVE_MPI

#include <limits.h>
#include <mpi.h>
#include <stdio.h>
#include <string.h>

typedef struct mpi_comm {
    spari_comm base;
    MPI_Comm handle; /* our own duplicate, with MPI_ERRORS_RETURN */
    int *counts, *offsets;
    int has_bins; /* the next two are set up */
    MPI_Datatype bins;
    MPI_Op merge;
    int gone; /* another rank has destroyed its session: there is nobody to talk to any more */
} mpi_comm;

/* ---- failures of MPI itself ---- */

static int mpi_failure(int code, char *message, size_t size) {
    char text[MPI_MAX_ERROR_STRING] = "unknown error";
    int length = 0;
    (void)MPI_Error_string(code, text, &length);
    (void)snprintf(message, size, "MPI: %s", text);
    return SPAR_ERR_COMM;
}

#define TRY_MPI(call)                                                                                                  \
    do {                                                                                                               \
        int code_ = (call);                                                                                            \
        if (code_ != MPI_SUCCESS) {                                                                                    \
            return mpi_failure(code_, message, size);                                                                  \
        }                                                                                                              \
    } while (0)

/* Whether MPI can be called: after MPI_Init and before MPI_Finalize. These two queries are allowed at any time. */
static int mpi_is_up(void) {
    int up = 0, down = 0;
    return MPI_Initialized(&up) == MPI_SUCCESS && up && MPI_Finalized(&down) == MPI_SUCCESS && !down;
}

static int check_up(const mpi_comm *c, char *message, size_t size) {
    if (!mpi_is_up()) {
        (void)snprintf(message, size, "MPI has been finalized; destroy the session before MPI_Finalize");
        return SPAR_ERR_COMM;
    }
    if (c->gone) {
        (void)snprintf(message, size, "another rank has destroyed this session; destroy it on this one too");
        return SPAR_ERR_COMM;
    }
    return SPAR_OK;
}

/* ---- the table ---- */

/* Sends the text of rank `from`, the lowest failing one, to those that did not fail. */
static int tell_all(mpi_comm *c, int from, int status, char *message, size_t size) {
    char text[SPARI_MESSAGE_SIZE] = "";
    if (c->base.rank == from) {
        (void)snprintf(text, sizeof text, "%s", message);
    }
    TRY_MPI(MPI_Bcast(text, SPARI_MESSAGE_SIZE, MPI_CHAR, from, c->handle));
    if (status != SPAR_OK) {
        return status;
    }
    (void)snprintf(message, size, "rank %d: %s", from, text);
    return SPAR_ERR_PEER;
}

/* Words of the entry message, reduced to their minimum over the ranks. A hash is sent twice, once complemented, so
   that its maximum is known too: all ranks agree if the two match. */
enum {
    FAILED,         /* lowest failing rank; NOBODY; LEAVING on a rank that destroys its session */
    NAME,           /* hash of the call */
    KEY = NAME + 2, /* hash of what must agree */
    WORDS = KEY + 2
};
enum { NOBODY = INT_MAX, LEAVING = -1 };

static void put_pair(int64_t *pair, int64_t value) {
    pair[0] = value;
    pair[1] = ~value;
}

static int is_same(const int64_t *pair) {
    return pair[0] == ~pair[1];
}

/* FNV-1a, which may continue from an earlier hash. */
static int64_t as_word(const spari_agreed *a) {
    int64_t word = a->whole;
    if (a->kind == SPARI_REAL) {
        memcpy(&word, &a->real, sizeof word);
    }
    return word;
}

static int64_t key_of(const spari_agreed *must_agree, int count) {
    uint64_t hash = SPARI_HASH_BEGIN;
    for (int i = 0; i < count; i++) {
        int64_t word = as_word(must_agree + i);
        hash = spari_hash_bytes(hash, &word, sizeof word);
    }
    return (int64_t)hash;
}

static void tell_own(const spari_agreed *a, char *text, size_t size) {
    switch (a->kind) {
    case SPARI_REAL:
        (void)snprintf(text, size, " (here %.17g)", a->real);
        break;
    case SPARI_WHOLE:
        (void)snprintf(text, size, " (here %lld)", (long long)a->whole);
        break;
    case SPARI_GIVEN:
        (void)snprintf(text, size, a->whole ? " (here given, elsewhere NULL)" : " (here NULL, elsewhere given)");
        break;
    case SPARI_HASH:
        text[0] = '\0';
        break;
    }
}

/* The keys differ, as all ranks know: finds the first difference. */
static int tell_difference(mpi_comm *c, const char *call, const spari_agreed *must_agree, int count, char *message,
                           size_t size) {
    int64_t mine[2 * SPARI_MOST_AGREED], all[2 * SPARI_MOST_AGREED];
    char own[64] = "";
    int first = 0;
    for (int i = 0; i < count; i++) {
        put_pair(mine + 2 * i, as_word(must_agree + i));
    }
    TRY_MPI(MPI_Allreduce(mine, all, 2 * count, MPI_INT64_T, MPI_MIN, c->handle));
    while (first < count - 1 && is_same(all + 2 * first)) {
        first++;
    }
    tell_own(must_agree + first, own, sizeof own);
    (void)snprintf(message, size, "%s: the ranks have different %s%s; make them equal on every rank", call,
                   must_agree[first].name, own);
    return SPAR_ERR_COMM;
}

/* call NULL: inside a call that all ranks are known to be in. */
static int meet(mpi_comm *c, const char *call, const spari_agreed *must_agree, int count, int status, char *message,
                size_t size) {
    int64_t mine[WORDS], all[WORDS];
    SPARI_TRY(check_up(c, message, size));
    mine[FAILED] = status == SPAR_OK ? NOBODY : c->base.rank;
    put_pair(mine + NAME, call ? (int64_t)spari_hash_bytes(SPARI_HASH_BEGIN, call, strlen(call)) : 0);
    put_pair(mine + KEY, key_of(must_agree, count));
    TRY_MPI(MPI_Allreduce(mine, all, WORDS, MPI_INT64_T, MPI_MIN, c->handle));
    if (all[FAILED] == LEAVING) {
        c->gone = 1;
        return check_up(c, message, size);
    }
    if (!is_same(all + NAME)) {
        (void)snprintf(message, size,
                       "%s: other ranks are in another call; make the collective calls in the same order on all ranks",
                       call ? call : "spar");
        return SPAR_ERR_COMM;
    }
    if (all[FAILED] != NOBODY) {
        return tell_all(c, (int)all[FAILED], status, message, size);
    }
    return !must_agree || is_same(all + KEY) ? SPAR_OK : tell_difference(c, call, must_agree, count, message, size);
}

static int mpi_enter(spari_comm *comm, const char *call, const spari_agreed *must_agree, int count, int status,
                     char *message, size_t size) {
    return meet((mpi_comm *)comm, call, must_agree, count, status, message, size);
}

static int mpi_agree(spari_comm *comm, int status, char *message, size_t size) {
    return meet((mpi_comm *)comm, NULL, NULL, 0, status, message, size);
}

/* The others may wait in another call for this rank. */
static void mpi_destroy(spari_comm *comm) {
    mpi_comm *c = (mpi_comm *)comm;
    if (mpi_is_up()) {
        int64_t mine[WORDS] = {LEAVING}, all[WORDS];
        if (!c->gone) {
            (void)MPI_Allreduce(mine, all, WORDS, MPI_INT64_T, MPI_MIN, c->handle);
        }
        if (c->has_bins) {
            (void)MPI_Op_free(&c->merge);
            (void)MPI_Type_free(&c->bins);
        }
        (void)MPI_Comm_free(&c->handle);
    }
    SPARI_FREE(c->counts, c->offsets);
}

static int upto_most(const spari_comm *comm, int64_t n) {
    return (int)(n < comm->most ? n : comm->most);
}

static int mpi_sum(spari_comm *comm, double *x, int64_t n, int status, char *message, size_t size) {
    mpi_comm *c = (mpi_comm *)comm;
    SPARI_TRY(check_up(c, message, size));
    if (status != SPAR_OK) {
        memset(x, 0, (size_t)n * sizeof *x);
    }
    x[n] = status != SPAR_OK;
    /* reduced to one rank and broadcast: MPI_Allreduce may give different bits on different ranks */
    for (int64_t at = 0; at <= n; at += comm->most) {
        int part = upto_most(comm, n + 1 - at);
        double *p = x + at;
        TRY_MPI(MPI_Reduce(comm->rank == 0 ? MPI_IN_PLACE : p, p, part, MPI_DOUBLE, MPI_SUM, 0, c->handle));
        TRY_MPI(MPI_Bcast(p, part, MPI_DOUBLE, 0, c->handle));
    }
    return x[n] == 0 ? SPAR_OK : mpi_agree(comm, status, message, size);
}

static void merge_bins(void *from, void *into, int *count, MPI_Datatype *type) {
    const spari_bins *f = from;
    spari_bins *t = into;
    (void)type;
    for (int i = 0; i < *count; i++) {
        spari_bins_merge(t + i, f + i);
    }
}

static int mpi_prepare_bins(spari_comm *comm, char *message, size_t size) {
    mpi_comm *c = (mpi_comm *)comm;
    if (c->has_bins) {
        return SPAR_OK;
    }
    SPARI_TRY(check_up(c, message, size));
    TRY_MPI(MPI_Type_contiguous((int)sizeof(spari_bins), MPI_BYTE, &c->bins));
    int code = MPI_Type_commit(&c->bins);
    code = code == MPI_SUCCESS ? MPI_Op_create(merge_bins, 1, &c->merge) : code;
    if (code != MPI_SUCCESS) {
        (void)MPI_Type_free(&c->bins);
        return mpi_failure(code, message, size);
    }
    c->has_bins = 1;
    return SPAR_OK;
}

static int mpi_sum_bins(spari_comm *comm, spari_bins *x, int64_t n, int status, char *message, size_t size) {
    mpi_comm *c = (mpi_comm *)comm;
    SPARI_TRY(check_up(c, message, size));
    if (status != SPAR_OK) {
        memset(x, 0, (size_t)n * sizeof *x);
    }
    x[n] = (spari_bins){.part = {status != SPAR_OK}};
    for (int64_t at = 0; at <= n; at += comm->most) { /* the same bits in any order of addition */
        int part = upto_most(comm, n + 1 - at);
        TRY_MPI(MPI_Allreduce(MPI_IN_PLACE, x + at, part, c->bins, c->merge, c->handle));
    }
    return x[n].part[0] == 0 ? SPAR_OK : mpi_agree(comm, status, message, size);
}

static int mpi_share(spari_comm *comm, double *x, const int64_t *first, int status, char *message, size_t size) {
    mpi_comm *c = (mpi_comm *)comm;
    SPARI_TRY(check_up(c, message, size));
    x[first[comm->rank + 1] - 1] = status != SPAR_OK;
    const int at_once = first[comm->size] <= comm->most; /* else each rank's block in messages that fit */
    for (int r = 0; r < comm->size; r++) {
        for (int64_t at = first[r]; at < first[r + 1] && !at_once; at += comm->most) {
            TRY_MPI(MPI_Bcast(x + at, upto_most(comm, first[r + 1] - at), MPI_DOUBLE, r, c->handle));
        }
        c->offsets[r] = (int)first[r];
        c->counts[r] = (int)(first[r + 1] - first[r]);
    }
    if (at_once) {
        TRY_MPI(MPI_Allgatherv(MPI_IN_PLACE, 0, MPI_DATATYPE_NULL, x, c->counts, c->offsets, MPI_DOUBLE, c->handle));
    }
    for (int r = 0; r < comm->size; r++) {
        if (x[first[r + 1] - 1] != 0) {
            return tell_all(c, r, status, message, size);
        }
    }
    return SPAR_OK;
}

static int mpi_broadcast(spari_comm *comm, void *data, int64_t bytes, char *message, size_t size) {
    mpi_comm *c = (mpi_comm *)comm;
    SPARI_TRY(check_up(c, message, size));
    for (int64_t at = 0; at < bytes; at += comm->most) {
        int part = upto_most(comm, bytes - at);
        TRY_MPI(MPI_Bcast((char *)data + at, part, MPI_BYTE, 0, c->handle));
    }
    return SPAR_OK;
}

static int mpi_move(spari_comm *comm, int from, int to, void *data, int64_t bytes, char *message, size_t size) {
    mpi_comm *c = (mpi_comm *)comm;
    SPARI_TRY(check_up(c, message, size));
    for (int64_t at = 0; at < bytes && from != to; at += comm->most) {
        int part = upto_most(comm, bytes - at);
        if (comm->rank == from) {
            TRY_MPI(MPI_Send((char *)data + at, part, MPI_BYTE, to, 0, c->handle));
        } else if (comm->rank == to) {
            TRY_MPI(MPI_Recv((char *)data + at, part, MPI_BYTE, from, 0, c->handle, MPI_STATUS_IGNORE));
        }
    }
    return SPAR_OK;
}

static const spari_comm_ops mpi_ops = {mpi_destroy,  mpi_agree, mpi_enter,     mpi_sum, mpi_prepare_bins,
                                       mpi_sum_bins, mpi_share, mpi_broadcast, mpi_move};

/* ---- create ---- */

static int duplicate_quietly(MPI_Comm theirs, MPI_Comm *ours, const char **why) {
    int inter = 0;
    if (!theirs || theirs == MPI_COMM_NULL || MPI_Comm_test_inter(theirs, &inter) != MPI_SUCCESS) {
        *why =
            "the communicator is MPI_COMM_NULL or invalid; give the communicator of the ranks that share the session";
        return SPAR_ERR_ARGUMENT;
    }
    if (inter) {
        *why = "this is an inter-communicator; merge it first (MPI_Intercomm_merge)";
        return SPAR_ERR_ARGUMENT;
    }
    if (MPI_Comm_dup(theirs, ours) != MPI_SUCCESS) {
        *why = "MPI could not duplicate the communicator; give a communicator that is valid on all its ranks";
        return SPAR_ERR_COMM;
    }
    return SPAR_OK;
}

/* An invalid handle is an error on MPI_COMM_WORLD, whose error handler usually aborts. It is set to return
   meanwhile. */
static int duplicate(MPI_Comm theirs, MPI_Comm *ours, const char **why) {
    MPI_Errhandler handler;
    if (MPI_Comm_get_errhandler(MPI_COMM_WORLD, &handler) != MPI_SUCCESS ||
        MPI_Comm_set_errhandler(MPI_COMM_WORLD, MPI_ERRORS_RETURN) != MPI_SUCCESS) {
        *why = "MPI does not respond";
        return SPAR_ERR_COMM;
    }
    int status = duplicate_quietly(theirs, ours, why);
    (void)MPI_Comm_set_errhandler(MPI_COMM_WORLD, handler);
    (void)MPI_Errhandler_free(&handler);
    return status;
}

/* Rank, size and memory of the duplicate: steps that may fail on this rank alone. status: of this rank so far. */
static int set_up(mpi_comm *c, int status, mpi_comm **made, char *message, size_t size) {
    TRY_MPI(MPI_Comm_set_errhandler(c->handle, MPI_ERRORS_RETURN));
    TRY_MPI(MPI_Comm_rank(c->handle, &c->base.rank));
    TRY_MPI(MPI_Comm_size(c->handle, &c->base.size));
    SPARI_TRY(status);
    c->base.most = INT_MAX;
    c->counts = spari_zalloc(c->base.size, sizeof *c->counts);
    c->offsets = spari_zalloc(c->base.size, sizeof *c->offsets);
    *made = c->counts && c->offsets ? spari_zalloc(1, sizeof **made) : NULL;
    if (!*made) {
        (void)snprintf(message, size, "no memory for the communicator");
        return SPAR_ERR_MEMORY;
    }
    return SPAR_OK;
}

int spari_comm_create_fortran(int handle, spari_comm **comm, int status, char *message, size_t size) {
    const char *why = "MPI is not running; call it after MPI_Init and before MPI_Finalize, or use spar_session_create";
    mpi_comm c = {.base.ops = &mpi_ops}, *made = NULL;
    int found = mpi_is_up() ? duplicate(MPI_Comm_f2c((MPI_Fint)handle), &c.handle, &why) : SPAR_ERR_COMM;
    if (found != SPAR_OK) {
        (void)snprintf(message, size, "%s", why);
        return found;
    }
    status = set_up(&c, status, &made, message, size);
    status = meet(&c, "spar_session_create_fcomm", NULL, 0, status, message, size);
    if (status != SPAR_OK || !made) {
        (void)MPI_Comm_free(&c.handle);
        SPARI_FREE(c.counts, c.offsets, made);
        return status;
    }
    *made = c;
    *comm = &made->base;
    return SPAR_OK;
}

#endif
