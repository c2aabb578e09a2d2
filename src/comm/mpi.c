/* The ranks of an MPI communicator. */
#include "ranks.h"

#ifdef SPARI_HAVE_MPI

#include <limits.h>
#include <mpi.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct mpi_comm {
    spari_comm base;
    MPI_Comm handle; /* our own duplicate, with MPI_ERRORS_RETURN */
    int *counts, *offsets;
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

/* MPI is there to be called: not before MPI_Init, not after MPI_Finalize. These two may be asked at any time. */
static int mpi_is_up(void) {
    int up = 0, down = 0;
    return MPI_Initialized(&up) == MPI_SUCCESS && up && MPI_Finalized(&down) == MPI_SUCCESS && !down;
}

static int check_up(char *message, size_t size) {
    if (!mpi_is_up()) {
        (void)snprintf(message, size, "MPI has been finalized; destroy the session before MPI_Finalize");
        return SPAR_ERR_COMM;
    }
    return SPAR_OK;
}

/* ---- the table ---- */

static void mpi_destroy(spari_comm *comm) {
    mpi_comm *c = (mpi_comm *)comm;
    if (mpi_is_up()) {
        (void)MPI_Comm_free(&c->handle);
    }
    free(c->counts);
    free(c->offsets);
}

/* The text of rank `from`, the lowest that failed, for those that did not fail themselves. */
static int tell(mpi_comm *c, int from, int status, char *message, size_t size) {
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

/* A call's name as a number: FNV-1a. */
static int64_t hash_of(const char *call) {
    uint32_t hash = 2166136261U;
    for (; call && *call; call++) {
        hash = (hash ^ (unsigned char)*call) * 16777619U;
    }
    return hash;
}

static int mpi_agree(spari_comm *comm, const char *call, int status, char *message, size_t size) {
    mpi_comm *c = (mpi_comm *)comm;
    SPARI_TRY(check_up(message, size));
    /* the lowest rank that failed; the calls' least and greatest name */
    int64_t name = hash_of(call), mine[3] = {status == SPAR_OK ? INT_MAX : comm->rank, name, -name}, all[3];
    TRY_MPI(MPI_Allreduce(mine, all, 3, MPI_INT64_T, MPI_MIN, c->handle));
    if (all[1] != -all[2]) {
        (void)snprintf(message, size,
                       "%s: other ranks are in another call; all ranks make the collective calls in the same order",
                       call ? call : "spar");
        return SPAR_ERR_COMM;
    }
    return all[0] == INT_MAX ? SPAR_OK : tell(c, (int)all[0], status, message, size);
}

static int mpi_sum(spari_comm *comm, double *x, int64_t n, int status, char *message, size_t size) {
    mpi_comm *c = (mpi_comm *)comm;
    SPARI_TRY(check_up(message, size));
    if (status != SPAR_OK) {
        memset(x, 0, (size_t)n * sizeof *x);
    }
    x[n] = status != SPAR_OK;
    /* reduced to one rank and sent out again: MPI_Allreduce need not give the same bits on all ranks */
    for (int64_t at = 0; at <= n; at += INT_MAX) {
        int part = (int)(n + 1 - at < INT_MAX ? n + 1 - at : INT_MAX);
        double *p = x + at;
        TRY_MPI(MPI_Reduce(comm->rank == 0 ? MPI_IN_PLACE : p, p, part, MPI_DOUBLE, MPI_SUM, 0, c->handle));
        TRY_MPI(MPI_Bcast(p, part, MPI_DOUBLE, 0, c->handle));
    }
    return x[n] == 0 ? SPAR_OK : mpi_agree(comm, NULL, status, message, size);
}

static int mpi_share(spari_comm *comm, double *x, const int64_t *first, int status, char *message, size_t size) {
    mpi_comm *c = (mpi_comm *)comm;
    SPARI_TRY(check_up(message, size));
    if (first[comm->size] > INT_MAX) { /* the same on all ranks */
        (void)snprintf(message, size, "%lld numbers are more than MPI moves in one call; make the members smaller",
                       (long long)first[comm->size]);
        return SPAR_ERR_UNSUPPORTED;
    }
    for (int r = 0; r < comm->size; r++) {
        c->offsets[r] = (int)first[r];
        c->counts[r] = (int)(first[r + 1] - first[r]);
    }
    x[first[comm->rank + 1] - 1] = status != SPAR_OK;
    TRY_MPI(MPI_Allgatherv(MPI_IN_PLACE, 0, MPI_DATATYPE_NULL, x, c->counts, c->offsets, MPI_DOUBLE, c->handle));
    for (int r = 0; r < comm->size; r++) {
        if (x[first[r + 1] - 1] != 0) {
            return tell(c, r, status, message, size);
        }
    }
    return SPAR_OK;
}

static int mpi_broadcast(spari_comm *comm, void *data, int64_t bytes, char *message, size_t size) {
    mpi_comm *c = (mpi_comm *)comm;
    SPARI_TRY(check_up(message, size));
    for (int64_t at = 0; at < bytes; at += INT_MAX) {
        int part = (int)(bytes - at < INT_MAX ? bytes - at : INT_MAX);
        TRY_MPI(MPI_Bcast((char *)data + at, part, MPI_BYTE, 0, c->handle));
    }
    return SPAR_OK;
}

static int mpi_same(spari_comm *comm, uint64_t key, int *same) {
    mpi_comm *c = (mpi_comm *)comm;
    uint64_t mine[2] = {key, ~key}, all[2];
    if (!mpi_is_up() || MPI_Allreduce(mine, all, 2, MPI_UINT64_T, MPI_MAX, c->handle) != MPI_SUCCESS) {
        *same = 0;
        return SPAR_ERR_COMM;
    }
    *same = all[0] == ~all[1];
    return SPAR_OK;
}

static const spari_comm_ops mpi_ops = {mpi_destroy, mpi_agree, mpi_sum, mpi_share, mpi_broadcast, mpi_same};

/* ---- create ---- */

/* A rank without memory must not leave the others with a communicator they believe in. */
static int agree_on_memory(mpi_comm *c) {
    int mine = c->counts && c->offsets, all = 0;
    return MPI_Allreduce(&mine, &all, 1, MPI_INT, MPI_MIN, c->handle) == MPI_SUCCESS && all;
}

static int duplicate_quietly(MPI_Comm theirs, MPI_Comm *ours, const char **why) {
    int inter = 0;
    if (!theirs || theirs == MPI_COMM_NULL || MPI_Comm_test_inter(theirs, &inter) != MPI_SUCCESS) {
        *why =
            "the communicator is MPI_COMM_NULL, or no communicator at all; give the one whose ranks hold the session";
        return SPAR_ERR_ARGUMENT;
    }
    if (inter) {
        *why = "this is an inter-communicator; merge it first (MPI_Intercomm_merge)";
        return SPAR_ERR_ARGUMENT;
    }
    if (MPI_Comm_dup(theirs, ours) != MPI_SUCCESS) {
        *why = "MPI could not duplicate the communicator; give one that is in use on all its ranks";
        return SPAR_ERR_COMM;
    }
    return SPAR_OK;
}

/* A handle that is none is an error on MPI_COMM_WORLD, whose handler aborts as a rule: it returns while we ask. */
static int duplicate(MPI_Comm theirs, MPI_Comm *ours, const char **why) {
    MPI_Errhandler handler;
    if (MPI_Comm_get_errhandler(MPI_COMM_WORLD, &handler) != MPI_SUCCESS ||
        MPI_Comm_set_errhandler(MPI_COMM_WORLD, MPI_ERRORS_RETURN) != MPI_SUCCESS) {
        *why = "MPI does not answer";
        return SPAR_ERR_COMM;
    }
    int status = duplicate_quietly(theirs, ours, why);
    (void)MPI_Comm_set_errhandler(MPI_COMM_WORLD, handler);
    (void)MPI_Errhandler_free(&handler);
    return status;
}

int spari_comm_create_fortran(int handle, spari_comm **comm, const char **why) {
    if (!mpi_is_up()) {
        *why = "MPI is not running; call it after MPI_Init and before MPI_Finalize, or use spar_session_create";
        return SPAR_ERR_COMM;
    }
    mpi_comm *c = spari_zalloc(1, sizeof *c);
    if (!c) {
        *why = "no memory for the communicator";
        return SPAR_ERR_MEMORY;
    }
    int status = duplicate(MPI_Comm_f2c((MPI_Fint)handle), &c->handle, why);
    if (status != SPAR_OK) {
        free(c);
        return status;
    }
    c->base.ops = &mpi_ops;
    spari_comm *made = &c->base;
    int ok = MPI_Comm_set_errhandler(c->handle, MPI_ERRORS_RETURN) == MPI_SUCCESS &&
             MPI_Comm_rank(c->handle, &made->rank) == MPI_SUCCESS &&
             MPI_Comm_size(c->handle, &made->size) == MPI_SUCCESS;
    if (!ok) {
        spari_comm_destroy(&made);
        *why = "MPI did not set up the communicator";
        return SPAR_ERR_COMM;
    }
    c->counts = spari_zalloc(made->size, sizeof *c->counts);
    c->offsets = spari_zalloc(made->size, sizeof *c->offsets);
    if (!agree_on_memory(c)) {
        spari_comm_destroy(&made);
        *why = "no memory for the communicator on one of the ranks";
        return SPAR_ERR_MEMORY;
    }
    *comm = made;
    return SPAR_OK;
}

#endif
