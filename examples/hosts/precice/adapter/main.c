/* spar-precice FILE.case: the structure of a case file as a participant of preCICE (participant.h). */
#include "participant.h"

#include <stdio.h>

int main(int argc, char **argv) {
    char message[1024];
    MPI_Init(&argc, &argv);
    if (argc != 2) {
        fprintf(stderr, "usage: spar-precice FILE.case\n");
        MPI_Abort(MPI_COMM_WORLD, 2);
    }
    if (participant_run(argv[1], MPI_COMM_WORLD, message, sizeof message) != 0) {
        fprintf(stderr, "spar-precice: %s\n", message);
        MPI_Abort(MPI_COMM_WORLD, 1); /* the partner would wait for ever */
    }
    MPI_Finalize();
    return 0;
}
