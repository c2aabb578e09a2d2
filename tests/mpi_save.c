/* A file from ranks of which only the first kept its node forces, loaded where all nodes are on one process: the forces
   of the others are not in it, which is said; nothing is read that is not there (the sanitizers are the witness). */
#include "scene.h"

#include <mpi.h>
#include <spar/spar_mpi.h>
#include <stdio.h>

enum { NODES = 200 }; /* of each rank; many, so that what is not there lies beyond the file */

static int rank, size;

static void create(spar_session *s, int first, int ranks, spar_fluid **fluid) {
    double K[36], M[36], *x = calloc((size_t)(3 * NODES * ranks), sizeof *x);
    scene_box(K, M);
    spar_member *beam = scene_beam(s, "beam", 1, 4, 10, K, M);
    OK(s, spar_member_commit(beam));
    for (int i = 0; i < NODES * ranks; i++) {
        x[3 * i] = 10.0 * (first * NODES + i) / (NODES * size);
    }
    OK(s, spar_fluid_create(beam, "nodes", fluid));
    if (first == 0) { /* sections keep their forces */
        double *xi = calloc((size_t)(NODES * ranks), sizeof *xi);
        for (int i = 0; i < NODES * ranks; i++) {
            xi[i] = 0.2 * x[3 * i] - 1;
        }
        OK(s, spar_fluid_set_sections(*fluid, (int64_t)NODES * ranks, xi, NULL));
        free(xi);
    } else {
        OK(s, spar_fluid_set_force_nodes(*fluid, (int64_t)NODES * ranks, x));
    }
    OK(s, spar_fluid_map(*fluid));
    free(x);
}

static void kept_on_one_rank(void **state) {
    (void)state;
    spar_session *all = NULL, *alone = scene_session();
    spar_fluid *fluid;
    char file[32];
    snprintf(file, sizeof file, "mpi_save_%d.spar", size);
    OK(NULL, spar_session_create_mpi(MPI_COMM_WORLD, &all));
    create(all, rank, 1, &fluid);
    scene_run(all, 0.02, 2);
    OK(all, spar_session_save(all, file));
    create(alone, 0, size, &fluid);
    int status = spar_session_load(alone, file);
    assert_int_equal(status, size == 1 ? SPAR_OK : SPAR_ERR_ARGUMENT);
    assert_true(size == 1 || strstr(spar_session_message(alone), "force node 200 is not in the saved run"));
    OK(all, spar_session_load(all, file));
    scene_run(all, 0.02, 1);
    spar_session_destroy(&all);
    spar_session_destroy(&alone);
    MPI_Barrier(MPI_COMM_WORLD);
    if (rank == 0) {
        remove(file);
    }
}

int main(int argc, char **argv) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(kept_on_one_rank)};
    int failed, worst = 0;
    MPI_Init(&argc, &argv);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    MPI_Comm_size(MPI_COMM_WORLD, &size);
    failed = cmocka_run_group_tests(tests, NULL, NULL);
    MPI_Allreduce(&failed, &worst, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD);
    MPI_Finalize();
    return worst;
}
