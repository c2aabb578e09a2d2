/* Declarations shared by serial.c and mpi.c. The serial communicator has no table of operations. */
#ifndef SPARI_RANKS_H
#define SPARI_RANKS_H

#include "comm.h"

typedef struct spari_comm_ops {
    void (*destroy)(spari_comm *comm);
    int (*agree)(spari_comm *comm, int status, char *message, size_t size);
    int (*enter)(spari_comm *comm, const char *call, const spari_agreed *must_agree, int count, int status,
                 char *message, size_t size);
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
    int most; /* maximum number of items or bytes per MPI message; more are sent in several */
};

#endif
