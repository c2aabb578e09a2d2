/* What the two sides of the room share: the serial one has no table and answers at once. */
#ifndef SPARI_RANKS_H
#define SPARI_RANKS_H

#include "comm.h"

typedef struct spari_comm_ops {
    void (*destroy)(spari_comm *comm);
    int (*agree)(spari_comm *comm, int status, char *message, size_t size);
    int (*enter)(spari_comm *comm, const char *call, const spari_alike *alike, int count, int status, char *message,
                 size_t size);
    int (*sum)(spari_comm *comm, double *x, int64_t n, int status, char *message, size_t size);
    int (*prepare_bins)(spari_comm *comm, char *message, size_t size);
    int (*sum_bins)(spari_comm *comm, spari_bins *x, int64_t n, int status, char *message, size_t size);
    int (*share)(spari_comm *comm, double *x, const int64_t *first, int status, char *message, size_t size);
    int (*broadcast)(spari_comm *comm, void *data, int64_t bytes, char *message, size_t size);
    int (*move)(spari_comm *comm, int from, int to, void *data, int64_t bytes, char *message, size_t size);
} spari_comm_ops;

struct spari_comm {
    const spari_comm_ops *ops; /* NULL: this process alone */
    int rank, size;
    int most; /* items, or bytes, that a message of MPI has at most; more go in several */
};

#endif
