/* Eigenvalues of structure and fluid on any number of ranks: a beam and a body on a spring, owned by different ranks,
   in a fluid whose nodes are dealt out over all ranks but the last, against the same on one process; all ranks have the
   same bits. Then what a single rank can do wrong: all are told, none waits (ctest's time limit is the witness), and
   the state is as before. */
#include "scene.h"
#include "trials.h"

#include "ranks.h"
#include <spar/spar_mpi.h>

enum { NODES = 12, MODES = 10, FIRST = 4 };

typedef struct scene {
    spar_session *session;
    spar_member *beam, *body;
    spar_fluid *air;
    int64_t n;
    int calls, bad_call;
} scene;

static void create(scene *c, int me, int ranks) {
    static const double place[3] = {0, 3, 0}, centre[3] = {0, 0, 0}, J[3] = {1, 2, 3};
    static const double spring[36] = {[0] = 4, [7] = 4, [14] = 4, [21] = 4, [28] = 4, [35] = 4};
    double K[36], M[36], mass[36], x[NODES][3];
    int carriers = ranks > 1 ? ranks - 1 : 1;
    *c = (scene){.session = NULL};
    OK(NULL, ranks > 1 ? spar_session_create_mpi(MPI_COMM_WORLD, &c->session) : spar_session_create(&c->session));
    spar_session *s = c->session;
    scene_diagonal(K, 1e3, 1e3, 1e3, 50, 20, 40);
    scene_diagonal(M, 1, 1, 1, 0.2, 0.1, 0.1);
    c->beam = scene_beam(s, "beam", 1, 5, 2, K, M);
    OK(s, spar_member_set_root(c->beam, SPAR_ROOT_FIXED));
    OK(s, spar_member_commit(c->beam));
    scene_mass(mass, 2, centre, J);
    OK(s, spar_rigid_create(s, "body", place, NULL, mass, &c->body));
    OK(s, spar_member_commit(c->body));
    OK(s, spar_spring_create(s, "spring", c->body, 0, 63, spring, NULL, NULL, NULL));
    for (int i = 0; i < NODES; i++) {
        if (i % carriers == me) {
            const double at[3] = {2.0 * i / (NODES - 1), 0.1, 0.05 * (i % 3)};
            memcpy(x[c->n++], at, sizeof at);
        }
    }
    OK(s, spar_fluid_create(c->beam, "air", &c->air));
    OK(s, spar_fluid_set_motion_nodes(c->air, c->n, c->n ? x[0] : NULL));
    OK(s, spar_fluid_set_force_nodes(c->air, c->n, c->n ? x[0] : NULL));
    OK(s, spar_fluid_map(c->air));
    OK(s, spar_fluid_set_states(c->air, 3));
}

/* y' = -3 (y - v): its loads lag behind the motion, and pull across it. */
static int solve(spar_session *s, double t, double dt, int iteration, void *context) {
    scene *c = context;
    double v[NODES][3], y[NODES][3], f[NODES][3];
    (void)t, (void)iteration;
    c->calls++;
    OK(s, spar_fluid_pull_motion(c->air, 1, NULL, c->n ? v[0] : NULL));
    OK(s, spar_fluid_pull_states(c->air, 3, c->n ? y[0] : NULL));
    for (int64_t i = 0; i < c->n; i++) {
        for (int k = 0; k < 3; k++) {
            y[i][k] = (y[i][k] + 3 * dt * v[i][k]) / (1 + 3 * dt);
        }
        f[i][0] = -0.2 * y[i][0], f[i][1] = -0.2 * y[i][1] + 0.4 * y[i][2], f[i][2] = -0.2 * y[i][2];
    }
    OK(s, spar_fluid_push_states(c->air, 3, c->n ? y[0] : NULL));
    OK(s, spar_fluid_push_forces(c->air, c->n ? f[0] : NULL, NULL));
    return c->calls == c->bad_call ? 77 : 0;
}

static int ask(scene *c, int64_t memory, double amplitude, int64_t modes, int64_t n, double *value) {
    const double shift[2] = {0, 3};
    return trial_eigenvalues(c->session, 0.02, memory, amplitude, NULL, solve, c, modes, n, shift, value, 0, NULL,
                             NULL);
}

/* To what differences of 1e-5 leave of rounding. */
static void as_one_process_has_it(void **state) {
    (void)state;
    scene c, alone;
    double value[2][2 * FIRST], first[2 * FIRST];
    create(&c, rank, size);
    create(&alone, 0, 1);
    for (int64_t memory = 30; memory < 100; memory += 30) {
        OK(c.session, ask(&c, memory, 0, MODES, FIRST, value[0]));
        OK(alone.session, ask(&alone, memory, 0, MODES, FIRST, value[1]));
        for (int i = 0; i < 2 * FIRST; i++) {
            NEAR(value[0][i], value[1][i], 1e-8);
        }
        memcpy(first, value[0], sizeof first);
        MPI_Bcast(first, 2 * FIRST, MPI_DOUBLE, 0, MPI_COMM_WORLD);
        assert_memory_equal(first, value[0], sizeof first);
    }
    spar_session_destroy(&c.session);
    spar_session_destroy(&alone.session);
}

static void differs(const scene *c, int status, const char *name) {
    assert_int_equal(status, size == 1 ? SPAR_OK : SPAR_ERR_COMM);
    assert_true(size == 1 || strstr(spar_session_message(c->session), name));
}

static void one_rank_wrong(void **state) {
    (void)state;
    scene c, calm;
    double value[2 * FIRST], q[2][7 * 5];
    int last = rank == size - 1, twice = last ? 2 : 1;
    create(&c, rank, size);
    differs(&c, ask(&c, 30 * twice, 0, MODES, FIRST, value), "memory (here ");
    differs(&c, ask(&c, 20, 1e-6 * twice, MODES, FIRST, value), "amplitude (here ");
    differs(&c, ask(&c, 20, 0, MODES - twice, FIRST, value), "modes (here ");
    differs(&c, ask(&c, 20, 0, MODES, FIRST - twice, value), "n (here ");
    int status = ask(&c, 20, 0, MODES, FIRST, last ? NULL : value);
    assert_int_equal(status, last ? SPAR_ERR_ARGUMENT : SPAR_ERR_PEER);
    c.bad_call = last ? c.calls + 5 : 0;
    status = ask(&c, 20, 0, MODES, FIRST, value);
    assert_int_equal(status, last ? SPAR_ERR_USER : SPAR_ERR_PEER);
    assert_non_null(strstr(spar_session_message(c.session), "returned 77"));
    create(&calm, rank, size);
    OK(c.session, spar_step(c.session, 0.02, solve, &c, NULL));
    OK(calm.session, spar_step(calm.session, 0.02, solve, &calm, NULL));
    OK(c.session, spar_member_get_motion(c.beam, q[0], NULL, NULL));
    OK(calm.session, spar_member_get_motion(calm.beam, q[1], NULL, NULL));
    assert_memory_equal(q[0], q[1], sizeof q[0]);
    spar_session_destroy(&c.session);
    spar_session_destroy(&calm.session);
}

int main(int argc, char **argv) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(as_one_process_has_it), cmocka_unit_test(one_rank_wrong)};
    return RANKS_RUN(argc, argv, tests);
}
