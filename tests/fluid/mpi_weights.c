/* Meshes cut over ranks that move with part of the structure's motion: every rank weighs its own nodes, and what it
   gets is what a session of this process alone gets for them. The last rank of several has none. */
#include "scene.h"

#include "ranks.h"
#include <spar/spar_mpi.h>

enum { NODES = 40, STEPS = 5 };

typedef struct run {
    spar_session *session;
    spar_fluid *fluid;
    int64_t n;
    double X[NODES][3], x[NODES][3], v[NODES][3], w[NODES];
} run;

/* A flexible cantilever that falls under gravity, nodes around it up to 1.5 m off, faded from 0.2 to 1.2 m of the line;
   of every seventh the mesh is held. Alone: the nodes of this rank in a session of one process. */
static void fall(run *r, int alone) {
    const double gravity[3] = {0, 0, -9.81};
    double K[36], M[36];
    int held[NODES];
    memset(r, 0, sizeof *r);
    if (alone) {
        OK(NULL, spar_session_create(&r->session));
    } else {
        OK(NULL, spar_session_create_mpi(MPI_COMM_WORLD, &r->session));
    }
    scene_box(K, M);
    OK(r->session, spar_session_set_gravity(r->session, gravity));
    spar_member *b = scene_beam(r->session, "beam", 2, 5, 10, K, M);
    OK(r->session, spar_member_commit(b));
    for (int i = 0; i < NODES && (size == 1 || rank < size - 1); i++) {
        if (size > 1 && i % (size - 1) != rank) {
            continue;
        }
        double place[3] = {0.25 * i, 0.0375 * i * cos(0.7 * i), 0.0375 * i * sin(0.7 * i)};
        memcpy(r->X[r->n], place, sizeof place);
        held[r->n++] = i % 7 == 0;
    }
    OK(r->session, spar_fluid_create(b, "mesh", &r->fluid));
    OK(r->session, spar_fluid_set_motion_nodes(r->fluid, r->n, r->X[0]));
    OK(r->session, spar_fluid_fade_motion(r->fluid, 0.2, 1.2, r->n, NULL, held));
    OK(r->session, spar_fluid_map(r->fluid));
    OK(r->session, spar_fluid_get_motion_weights(r->fluid, r->w));
    scene_run(r->session, 0.02, STEPS);
    OK(r->session, spar_fluid_pull_motion(r->fluid, 1, r->x[0], r->v[0]));
    spar_session_destroy(&r->session);
}

/* Places to 1e-12 m and velocities to 1e-11 m/s of those alone: the same beam, solved on one rank; weights to the bit.
   In 0.1 s the free end falls by about g t^2 / 2 = 49 mm, so that there is something to compare. */
static void ranks_weigh_their_own(void **state) {
    (void)state;
    run ours, alone;
    double farthest = 0, most = 0;
    fall(&ours, 0);
    fall(&alone, 1);
    assert_int_equal(ours.n, alone.n);
    assert_memory_equal(ours.w, alone.w, sizeof ours.w);
    for (int64_t j = 0; j < ours.n; j++) {
        for (int i = 0; i < 3; i++) {
            NEAR(ours.x[j][i], alone.x[j][i], 1e-12);
            NEAR(ours.v[j][i], alone.v[j][i], 1e-11);
            assert_true(ours.w[j] != 0 || (ours.x[j][i] == ours.X[j][i] && ours.v[j][i] == 0));
            farthest = fmax(farthest, fabs(ours.x[j][i] - ours.X[j][i]));
        }
    }
    MPI_Allreduce(&farthest, &most, 1, MPI_DOUBLE, MPI_MAX, MPI_COMM_WORLD);
    assert_true(most > 0.005);
}

int main(int argc, char **argv) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(ranks_weigh_their_own)};
    return RANKS_RUN(argc, argv, tests);
}
