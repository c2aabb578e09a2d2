/* A rank whose member exceeds the budget of Newton iterations, or whose host cancels: the others learn of it in the
   same call (SPAR_ERR_PEER with its message), and all go on from the same state. Oracle: the motion before the step, to
   the bit, and the same motion on all ranks after the next step. */
#include "scene.h"

#include "ranks.h"
#include <spar/spar_mpi.h>

enum { NODES = 6 };

static int cancel(spar_session *session, double done, double expected, void *context) {
    (void)session, (void)expected, (void)context;
    return done >= 3;
}

/* A driven beam that the last rank solves. */
static spar_session *create(int last, spar_member **beam) {
    double K[36], M[36];
    spar_session *s = NULL;
    OK(NULL, spar_session_create_mpi(MPI_COMM_WORLD, &s));
    scene_diagonal(K, 1e5, 1e5, 1e5, 500, 500, 500);
    scene_diagonal(M, 1, 1, 1, 0.02, 0.01, 0.01);
    *beam = scene_beam(s, "blade", 1, NODES, 1, K, M);
    OK(s, spar_member_set_root(*beam, SPAR_ROOT_DRIVEN));
    OK(s, spar_member_set_owner(*beam, last));
    OK(s, spar_member_commit(*beam));
    OK(s, spar_step(s, 1e-3, NULL, NULL, NULL));
    return s;
}

static void drive(spar_session *s, spar_member *beam, double angle) {
    const double q[7] = {0, 0, 0, cos(angle / 2), 0, sin(angle / 2), 0};
    OK(s, spar_member_drive(beam, q, NULL, NULL));
}

static void test_all_learn(void **state) {
    (void)state;
    for (int cancels = 0; cancels < 2; cancels++) {
        spar_member *beam;
        spar_session *s = create(size - 1, &beam);
        double x[13 * NODES], y[13 * NODES];
        int solves = rank == size - 1, own = cancels ? SPAR_ERR_USER : SPAR_ERR_LIMIT;
        OK(s, spar_member_get_motion(beam, x, x + 7 * NODES, NULL));
        if (cancels && solves) {
            OK(s, spar_session_set_progress(s, cancel, NULL));
        } else if (!cancels) {
            OK(s, spar_session_set_option(s, "newton.budget", "3"));
        }
        drive(s, beam, 1.2);
        REFUSED(s, solves ? own : SPAR_ERR_PEER, cancels ? "cancelled by the progress callback (1)" : "newton.budget",
                spar_step(s, 1e-2, NULL, NULL, NULL));
        OK(s, spar_member_get_motion(beam, y, y + 7 * NODES, NULL));
        assert_memory_equal(x, y, sizeof x);
        OK(s, spar_session_set_progress(s, NULL, NULL));
        OK(s, spar_session_set_option(s, "newton.budget", "100000"));
        drive(s, beam, 0.001);
        OK(s, spar_step(s, 1e-2, NULL, NULL, NULL));
        OK(s, spar_member_get_motion(beam, y, y + 7 * NODES, NULL));
        memcpy(x, y, sizeof x);
        MPI_Bcast(x, 13 * NODES, MPI_DOUBLE, 0, MPI_COMM_WORLD);
        assert_memory_equal(x, y, sizeof x);
        spar_session_destroy(&s);
    }
}

int main(int argc, char **argv) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_all_learn)};
    return RANKS_RUN(argc, argv, tests);
}
