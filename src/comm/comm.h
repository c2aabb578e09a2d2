/* The ranks of a session. Only this room knows MPI: serial.c serves builds and sessions without it, mpi.c the others.
   Every call below is collective over the session's ranks and carries a status, so that a failure on one rank is known
   on all before any of them can block (what the others get is SPAR_ERR_PEER and the failing rank's message). */
#ifndef SPARI_COMM_H
#define SPARI_COMM_H

#include "../base/status.h"
#include "../math/bins.h"

typedef struct spari_comm spari_comm;

int spari_comm_create_self(spari_comm **comm);
/* Duplicates the communicator; what can fail on one rank alone comes after that, so that there is a way to tell the
   others. status: of what this rank has prepared for the session, agreed on as by spari_comm_agree. Without MPI:
   SPAR_ERR_UNSUPPORTED. */
int spari_comm_create_fortran(int handle, spari_comm **comm, int status, char *message, size_t size);
/* Several ranks: tells the others, who may be in another call, and from then on waits for nobody. */
void spari_comm_destroy(spari_comm **comm);

int spari_comm_rank(const spari_comm *comm); /* local */
int spari_comm_size(const spari_comm *comm); /* local */

/* Agrees on a status: SPAR_OK if it is so on all ranks; else the rank's own failure, or SPAR_ERR_PEER where a peer
   failed, with "rank R: " and the peer's text put into message (of `size` chars; in: own text, read only when status is
   a failure). The lowest failing rank's text is the one that is told. */
int spari_comm_agree(spari_comm *comm, int status, char *message, size_t size);
#ifdef __clang_analyzer__ /* reads one file at a time: a failure of this rank is a failure */
#define spari_comm_agree(comm, status, message, size) ((spari_comm_agree)(comm, status, message, size) ? 1 : (status))
#endif

/* What the ranks must say alike in a collective call: an argument of it, or a setting. */
typedef struct spari_alike {
    const char *name; /* "dt"; it is read in a message only */
    enum {
        SPARI_REAL,
        SPARI_WHOLE,
        SPARI_GIVEN,
        SPARI_HASH
    } kind; /* GIVEN: whether a pointer is; HASH: no number to show */
    double real;
    int64_t whole; /* of all kinds but the first */
} spari_alike;
enum { SPARI_MOST_ALIKE = 64 };

static inline spari_alike spari_real(const char *name, double x) {
    return (spari_alike){name, SPARI_REAL, x + 0.0, 0}; /* no negative zero: numbers are compared by their bits */
}

static inline spari_alike spari_whole(const char *name, int64_t x) {
    return (spari_alike){name, SPARI_WHOLE, 0, x};
}

static inline spari_alike spari_given(const char *name, int given) {
    return (spari_alike){name, SPARI_GIVEN, 0, given};
}

static inline spari_alike spari_hash(const char *name, uint64_t hash) {
    return (spari_alike){name, SPARI_HASH, 0, (int64_t)hash};
}

/* As spari_comm_agree, at the entry of a collective call named `call`, the only place where calls are compared: ranks
   in different calls would wait for each other for ever, and ranks that give it different things would part ways
   later; either is SPAR_ERR_COMM on all of them. alike[count]: what must be the same, as many of them on all ranks.
   One message, whatever the count; a difference takes another to be named. */
int spari_comm_enter(spari_comm *comm, const char *call, const spari_alike *alike, int count, int status, char *message,
                     size_t size);

/* x[n] becomes its sum over the ranks, the same bits on all of them; a failing rank's x counts as zero. x must have
   room for n + 1 doubles: the last one carries the status. One message up, one down. Returns as spari_comm_agree. */
int spari_comm_sum(spari_comm *comm, double *x, int64_t n, int status, char *message, size_t size);

/* The same for sums that are the same in any order of the ranks: x[n] becomes its sum over them, with room for n + 1 of
   them. prepare: what it takes, before; local, again costs nothing. */
int spari_comm_prepare_bins(spari_comm *comm, char *message, size_t size);
int spari_comm_sum_bins(spari_comm *comm, spari_bins *x, int64_t n, int status, char *message, size_t size);

/* Each rank owns x[first[rank] .. first[rank+1]-1] and gets all the others': the last double of each rank's own block
   carries its status (so every block has at least one). Returns as spari_comm_agree. */
int spari_comm_share(spari_comm *comm, double *x, const int64_t *first, int status, char *message, size_t size);

/* Rank 0's data[bytes] goes to all the others. */
int spari_comm_broadcast(spari_comm *comm, void *data, int64_t bytes, char *message, size_t size);
/* data[bytes] goes from one rank to another; these two make the call, and for others it is none. */
int spari_comm_move(spari_comm *comm, int from, int to, void *data, int64_t bytes, char *message, size_t size);

#endif
