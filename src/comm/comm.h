/* Communication between the ranks of a session. Only this room knows MPI: mpi.c serves sessions with MPI, serial.c
   the others. Every collective call carries a status, so that all ranks learn of a failure on one rank before any of
   them can block. The others get SPAR_ERR_PEER and the failing rank's message. */
#ifndef SPARI_COMM_H
#define SPARI_COMM_H

#include "../base/status.h"
#include "../math/bins.h"

typedef struct spari_comm spari_comm;

int spari_comm_create_self(spari_comm **comm);
/* Duplicates the communicator. Steps that can fail on one rank alone come after the duplication, so that the failure
   can be communicated. status: result of this rank's preparation, agreed on as by spari_comm_agree. Without MPI:
   SPAR_ERR_UNSUPPORTED. */
int spari_comm_create_fortran(int handle, spari_comm **comm, int status, char *message, size_t size);
/* With several ranks: notifies the others, which may be in another call, and waits for none of them. */
void spari_comm_destroy(spari_comm **comm);

int spari_comm_rank(const spari_comm *comm); /* local */
int spari_comm_size(const spari_comm *comm); /* local */

/* Agrees on a status: SPAR_OK if all ranks pass SPAR_OK. Otherwise returns the rank's own failure, or SPAR_ERR_PEER
   if a peer failed.
   message: on input the rank's own text, read only if status is a failure; on output "rank R: " and the text of the
     lowest failing rank */
int spari_comm_agree(spari_comm *comm, int status, char *message, size_t size);
#ifdef __clang_analyzer__ /* tells the analyser, which reads one file at a time, that a failure of this rank stays a   \
                             failure */
#define spari_comm_agree(comm, status, message, size) ((spari_comm_agree)(comm, status, message, size) ? 1 : (status))
#endif

/* An argument or setting of a collective call that must agree across ranks. */
typedef struct spari_agreed {
    const char *name; /* "dt"; used in messages only */
    enum {
        SPARI_REAL,
        SPARI_WHOLE,
        SPARI_GIVEN,
        SPARI_HASH
    } kind; /* GIVEN: whether a pointer is not NULL; HASH: a hash that is not shown */
    double real;
    int64_t whole; /* for all kinds but the first */
} spari_agreed;
enum { SPARI_MOST_AGREED = 64 };

static inline spari_agreed spari_real(const char *name, double x) {
    return (spari_agreed){name, SPARI_REAL, x + 0.0, 0}; /* no negative zero: numbers are compared by their bits */
}

static inline spari_agreed spari_whole(const char *name, int64_t x) {
    return (spari_agreed){name, SPARI_WHOLE, 0, x};
}

static inline spari_agreed spari_given(const char *name, int given) {
    return (spari_agreed){name, SPARI_GIVEN, 0, given};
}

static inline spari_agreed spari_hash(const char *name, uint64_t hash) {
    return (spari_agreed){name, SPARI_HASH, 0, (int64_t)hash};
}

/* spari_comm_agree at the entry of the collective call `call`. Only here are calls compared. Ranks in different
   calls would wait for each other for ever; ranks with different arguments would diverge later. Both give
   SPAR_ERR_COMM on all ranks. alike[count]: what must agree; count must be equal on all ranks. Takes one message;
   finding the name of a difference takes another. */
int spari_comm_enter(spari_comm *comm, const char *call, const spari_agreed *must_agree, int count, int status,
                     char *message, size_t size);

/* Replaces x[n] by its sum over the ranks, with the same bits on all of them. The x of a failing rank counts as
   zero. x must have room for n + 1 doubles: the last carries the status. Returns as spari_comm_agree. */
int spari_comm_sum(spari_comm *comm, double *x, int64_t n, int status, char *message, size_t size);

/* The same for reproducible sums x[n], with room for n + 1 of them. prepare: sets up what this needs; local, free
   when repeated. */
int spari_comm_prepare_bins(spari_comm *comm, char *message, size_t size);
int spari_comm_sum_bins(spari_comm *comm, spari_bins *x, int64_t n, int status, char *message, size_t size);

/* Each rank owns x[first[rank] .. first[rank+1]-1] and receives the blocks of all others. The last double of each
   block carries its rank's status, so every block has at least one. Returns as spari_comm_agree. */
int spari_comm_share(spari_comm *comm, double *x, const int64_t *first, int status, char *message, size_t size);

/* Rank 0's data[bytes] goes to all the others. */
int spari_comm_broadcast(spari_comm *comm, void *data, int64_t bytes, char *message, size_t size);
/* Sends data[bytes] from one rank to another. Only these two make the call; for other ranks it does nothing. */
int spari_comm_move(spari_comm *comm, int from, int to, void *data, int64_t bytes, char *message, size_t size);

#endif
