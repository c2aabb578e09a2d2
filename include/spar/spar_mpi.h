/* spar_mpi.h: a session on an MPI communicator; the only header that needs <mpi.h>. */
#ifndef SPAR_MPI_H
#define SPAR_MPI_H

#include <mpi.h>
#include <spar/spar.h>

/* A session over comm (duplicated; the caller keeps his), as spar_session_create_fcomm. Collective over comm.
   SPAR_ERR_COMM before MPI_Init and after MPI_Finalize, where MPI cannot even be asked for the integer of comm. */
static inline int spar_session_create_mpi(MPI_Comm comm, spar_session **session) {
    int up = 0, down = 0;
    MPI_Initialized(&up);
    MPI_Finalized(&down);
    return spar_session_create_fcomm(up && !down ? (int)MPI_Comm_c2f(comm) : 0, session);
}

#endif
