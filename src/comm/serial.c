/* Communicator of one process, and dispatch to the table of operations. */
#include "ranks.h"

#include <stdio.h>
#include <stdlib.h>

int spari_comm_create_self(spari_comm **comm) {
    spari_comm *c = spari_zalloc(1, sizeof *c);
    if (!c) {
        return SPAR_ERR_MEMORY;
    }
    c->size = 1;
    *comm = c;
    return SPAR_OK;
}

#ifndef SPARI_HAVE_MPI
int spari_comm_create_fortran(int handle, spari_comm **comm, int status, char *message, size_t size) {
    (void)handle;
    (void)comm;
    (void)status;
    (void)snprintf(message, size,
                   "this build of spar has no MPI; configure with -DSPAR_MPI=ON, or use spar_session_create");
    return SPAR_ERR_UNSUPPORTED;
}
#endif

void spari_comm_destroy(spari_comm **comm) {
    if (!comm || !*comm) {
        return;
    }
    if ((*comm)->ops) {
        (*comm)->ops->destroy(*comm);
    }
    free(*comm);
    *comm = NULL;
}

int spari_comm_rank(const spari_comm *comm) {
    return comm->rank;
}

int spari_comm_size(const spari_comm *comm) {
    return comm->size;
}

int(spari_comm_agree)(spari_comm *comm, int status, char *message, size_t size) {
    return comm->ops ? comm->ops->agree(comm, status, message, size) : status;
}

int spari_comm_enter(spari_comm *comm, const char *call, const spari_agreed *must_agree, int count, int status,
                     char *message, size_t size) {
    return comm->ops ? comm->ops->enter(comm, call, must_agree, count, status, message, size) : status;
}

int spari_comm_sum(spari_comm *comm, double *x, int64_t n, int status, char *message, size_t size) {
    return comm->ops ? comm->ops->sum(comm, x, n, status, message, size) : status;
}

int spari_comm_prepare_bins(spari_comm *comm, char *message, size_t size) {
    return comm->ops ? comm->ops->prepare_bins(comm, message, size) : SPAR_OK;
}

int spari_comm_sum_bins(spari_comm *comm, spari_bins *x, int64_t n, int status, char *message, size_t size) {
    return comm->ops ? comm->ops->sum_bins(comm, x, n, status, message, size) : status;
}

int spari_comm_share(spari_comm *comm, double *x, const int64_t *first, int status, char *message, size_t size) {
    return comm->ops ? comm->ops->share(comm, x, first, status, message, size) : status;
}

int spari_comm_broadcast(spari_comm *comm, void *data, int64_t bytes, char *message, size_t size) {
    return comm->ops ? comm->ops->broadcast(comm, data, bytes, message, size) : SPAR_OK;
}

int spari_comm_move(spari_comm *comm, int from, int to, void *data, int64_t bytes, char *message, size_t size) {
    return comm->ops ? comm->ops->move(comm, from, to, data, bytes, message, size) : SPAR_OK;
}
