/* A program of the examples alone or under mpirun: its rank, a session for it, sums over the ranks. */
#ifndef RANKS_H
#define RANKS_H

#include <spar/spar.h>
#ifdef SPAR_WITH_MPI
#include <spar/spar_mpi.h>
#endif

static inline void ranks_begin(int *argc, char ***argv, int *rank, int *ranks) {
    *rank = 0, *ranks = 1;
#ifdef SPAR_WITH_MPI
    MPI_Init(argc, argv);
    MPI_Comm_rank(MPI_COMM_WORLD, rank);
    MPI_Comm_size(MPI_COMM_WORLD, ranks);
#else
    (void)argc, (void)argv;
#endif
}

static inline int ranks_create_session(int ranks, spar_session **session) {
#ifdef SPAR_WITH_MPI
    if (ranks > 1) {
        return spar_session_create_mpi(MPI_COMM_WORLD, session);
    }
#endif
    (void)ranks;
    return spar_session_create(session);
}

/* x[n] becomes its sum over the ranks. */
static inline void ranks_sum(int ranks, double *x, int n) {
#ifdef SPAR_WITH_MPI
    if (ranks > 1) {
        MPI_Allreduce(MPI_IN_PLACE, x, n, MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
    }
#else
    (void)ranks, (void)x, (void)n;
#endif
}

static inline void ranks_end(int ranks, int failed) {
#ifdef SPAR_WITH_MPI
    if (failed && ranks > 1) { /* the others may be waiting */
        MPI_Abort(MPI_COMM_WORLD, 1);
    }
    MPI_Finalize();
#else
    (void)ranks, (void)failed;
#endif
}

#endif
