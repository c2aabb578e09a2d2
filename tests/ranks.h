/* Tests on several ranks: which rank this one is, and a run that fails on all ranks where it fails on one. */
#ifndef RANKS_H
#define RANKS_H

#include <cmocka.h>
#include <mpi.h>

static int rank, size;

static inline void ranks_begin(int argc, char **argv) {
    MPI_Init(&argc, &argv);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    MPI_Comm_size(MPI_COMM_WORLD, &size);
}

/* Gives back the greatest number of failures of a rank. */
static inline int ranks_end(int failed) {
    int worst = failed;
    MPI_Allreduce(&failed, &worst, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD);
    MPI_Finalize();
    return worst;
}

#define RANKS_RUN(argc, argv, tests) (ranks_begin(argc, argv), ranks_end(cmocka_run_group_tests(tests, NULL, NULL)))

#endif
