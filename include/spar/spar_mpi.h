/* spar_mpi.h: a session on an MPI communicator; the only header that needs <mpi.h>. */
#ifndef SPAR_MPI_H
#define SPAR_MPI_H

#include <mpi.h>
#include <spar/spar.h>

/* A session over comm (duplicated; the caller keeps his). Collective over comm. */
static inline int spar_session_create_mpi(MPI_Comm comm, spar_session **session) {
    return spar_session_create_fcomm((int)MPI_Comm_c2f(comm), session);
}

#endif
