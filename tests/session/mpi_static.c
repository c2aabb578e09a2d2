/* Static equilibrium with the fluid on any number of ranks, against the same on one process: two beams solved for by
   different ranks, fluid nodes dealt out over all ranks but the last (which has none, when there are several). Places
   agree to 1e-11 of the span: loads are iterated to 1e-12 of their size. Then what a single rank can do wrong: all are
   told, none waits (ctest's time limit is the witness), and all is as it was. */
#include "scene.h"

#include "ranks.h"
#include <spar/spar_mpi.h>

enum { POINTS = 8, NODES = 24 };

typedef struct scene {
    spar_session *session;
    spar_member *beam[2];
    spar_fluid *fluid[2];
    int64_t n; /* this rank's nodes of each */
    double x[2][NODES][3];
    double softness, breeze; /* how the medium's force grows with the shape; part of the wind that blows */
    int calls, bad_call, user_call;
} scene;

/* Rank `me` of `ranks` gets its share of the nodes. */
static void create(scene *c, int me, int ranks, int scheme) {
    static const double eta[2] = {0, 1}, gravity[3] = {0, 0, -2};
    double K[36], M[36];
    int carriers = ranks > 1 ? ranks - 1 : 1;
    memset(c, 0, sizeof *c);
    OK(NULL, ranks > 1 ? spar_session_create_mpi(MPI_COMM_WORLD, &c->session) : spar_session_create(&c->session));
    spar_session *s = c->session;
    scene_diagonal(K, 4e3, 4e3, 4e3, 80, 60, 60);
    scene_diagonal(M, 1, 1, 1, 0.02, 0.01, 0.01);
    OK(s, spar_session_set_gravity(s, gravity));
    OK(s, spar_session_set_coupling(s, scheme, 0, 1e-12, 200));
    for (int i = 0; i < NODES; i++) {
        c->n += i % carriers == me;
    }
    for (int k = 0; k < 2; k++) {
        double xyz[6] = {0, k, 0, 4, k, 0};
        OK(s, spar_beam_create(s, k ? "front" : "rear", 2, POINTS / 2, &c->beam[k]));
        OK(s, spar_beam_set_axis(c->beam[k], 2, eta, xyz, NULL));
        OK(s, spar_beam_set_sections(c->beam[k], 1, eta, K, M));
        OK(s, spar_member_set_owner(c->beam[k], k % ranks));
        OK(s, spar_member_commit(c->beam[k]));
        for (int i = 0, mine = 0; i < NODES; i++) {
            double place[3] = {4.0 * i / (NODES - 1), k + 0.2, 0.1};
            if (i % carriers == me) {
                memcpy(c->x[k][mine++], place, sizeof place);
            }
        }
        double *x = c->n ? c->x[k][0] : NULL;
        OK(s, spar_fluid_create(c->beam[k], "air", &c->fluid[k]));
        OK(s, spar_fluid_set_motion_nodes(c->fluid[k], c->n, x));
        OK(s, spar_fluid_set_force_nodes(c->fluid[k], c->n, x));
        OK(s, spar_fluid_map(c->fluid[k]));
    }
    c->softness = -0.05;
    c->breeze = 1;
}

static int solve(spar_session *s, double t, double dt, int iteration, void *context) {
    scene *c = context;
    (void)t, (void)iteration;
    c->calls++;
    for (int k = 0; k < 2; k++) {
        double x[NODES][3], f[NODES][3], *to = c->n ? x[0] : NULL;
        OK(s, spar_fluid_pull_motion(c->fluid[k], 1, to, NULL));
        for (int64_t i = 0; i < c->n; i++) {
            f[i][0] = 0;
            f[i][1] = c->breeze * 0.3 + c->softness * (x[i][1] - c->x[k][i][1]);
            f[i][2] = c->breeze * 0.2 * (k ? -1 : 1) + c->softness * (x[i][2] - c->x[k][i][2]);
        }
        if (c->calls == c->bad_call && k == 1) {
            f[c->n - 1][1] = NAN;
        }
        int status = spar_fluid_push_forces(c->fluid[k], c->n ? f[0] : NULL, NULL);
        if (status != SPAR_OK && c->calls != c->bad_call) {
            return status;
        }
    }
    return c->calls == c->user_call ? 77 : dt < 0;
}

static void places(const scene *c, double *q) {
    for (int k = 0; k < 2; k++) {
        OK(c->session, spar_member_get_motion(c->beam[k], q + 7 * POINTS * k, NULL, NULL));
    }
}

static void compare(const scene *a, const scene *b, double tolerance) {
    double x[2 * 7 * POINTS], y[2 * 7 * POINTS];
    places(a, x);
    places(b, y);
    for (int i = 0; i < 2 * 7 * POINTS; i++) {
        NEAR(x[i], y[i], tolerance);
    }
}

static void as_one_process_has_it(void **state) {
    (void)state;
    for (int scheme = SPAR_COUPLING_EXPLICIT; scheme <= SPAR_COUPLING_IQN_ILS; scheme++) {
        scene c, alone;
        int n[2];
        create(&c, rank, size, scheme);
        create(&alone, 0, 1, scheme);
        for (int again = 0; again < 2; again++) { /* before the first step, and between steps */
            OK(c.session, spar_session_solve_static(c.session, 2, solve, &c, &n[0]));
            OK(alone.session, spar_session_solve_static(alone.session, 2, solve, &alone, &n[1]));
            assert_int_equal(c.calls, alone.calls);
            assert_true(abs(n[0] - n[1]) <= 1); /* the last one may be rounding's */
            compare(&c, &alone, 4e-11);
            alone.softness = c.softness = -0.04;
            OK(c.session, spar_step(c.session, 0.02, solve, &c, NULL));
            OK(alone.session, spar_step(alone.session, 0.02, solve, &alone, NULL));
            alone.calls = c.calls = 0;
            compare(&c, &alone, 4e-11);
        }
        spar_session_destroy(&c.session);
        spar_session_destroy(&alone.session);
    }
}

static void same_bits(const scene *a, const scene *b) {
    double x[2 * 7 * POINTS], y[2 * 7 * POINTS];
    places(a, x);
    places(b, y);
    assert_memory_equal(x, y, sizeof x);
}

/* With reproducible sums, equilibria and the run that begins there have the bits of one process. */
static void bits_of_one_process(void **state) {
    (void)state;
    for (int scheme = SPAR_COUPLING_EXPLICIT; scheme <= SPAR_COUPLING_IQN_ILS; scheme++) {
        scene c, alone;
        int n[2];
        create(&c, rank, size, scheme);
        create(&alone, 0, 1, scheme);
        OK(c.session, spar_session_set_reproducible(c.session, 1));
        OK(alone.session, spar_session_set_reproducible(alone.session, 1));
        for (int k = 0; k < 8; k++) {
            if (k % 4 < 2) {
                OK(c.session, spar_session_solve_static(c.session, 2, solve, &c, &n[0]));
                OK(alone.session, spar_session_solve_static(alone.session, 2, solve, &alone, &n[1]));
                alone.softness = c.softness = -0.04;
            } else {
                OK(c.session, spar_step(c.session, 0.02, solve, &c, &n[0]));
                OK(alone.session, spar_step(alone.session, 0.02, solve, &alone, &n[1]));
            }
            assert_int_equal(n[0], n[1]);
            same_bits(&c, &alone);
        }
        spar_session_destroy(&c.session);
        spar_session_destroy(&alone.session);
    }
}

/* A rank without a solver has one that pushes nothing; a rank that answers or pushes badly is known to all; and where
   the loads outgrow the stiffness, the owner's failure is all ranks'. After each the state is that of before: the next
   solution is as on one process that has not seen it. */
static void one_rank_fails(void **state) {
    (void)state;
    static const double none[3] = {0, 0, 0}, down[3] = {0, 0, -2};
    scene c, alone;
    create(&c, rank, size, SPAR_COUPLING_FIXED_POINT);
    create(&alone, 0, 1, SPAR_COUPLING_FIXED_POINT);
    spar_session *s = c.session;
    int last = rank == size - 1, carriers = size > 1 ? size - 1 : 1;
    c.user_call = last ? 2 : 0;
    assert_int_equal(spar_session_solve_static(s, 1, solve, &c, NULL), last ? SPAR_ERR_USER : SPAR_ERR_PEER);
    assert_non_null(strstr(spar_session_message(s), "spar_session_solve_static: the fluid solver returned 77"));
    c.calls = c.user_call = 0;
    c.bad_call = rank == carriers - 1 ? 2 : 0;
    assert_int_equal(spar_session_solve_static(s, 1, solve, &c, NULL), c.bad_call ? SPAR_ERR_ARGUMENT : SPAR_ERR_PEER);
    assert_non_null(strstr(spar_session_message(s), "front"));
    c.bad_call = 0;
    c.softness = 0.6, c.breeze = 1e-4;
    OK(s, spar_session_set_gravity(s, none));
    OK(s, spar_session_set_coupling(s, SPAR_COUPLING_FIXED_POINT, 0, 1e-12, 8));
    int status = spar_session_solve_static(s, 1, solve, &c, NULL);
    assert_true(status == SPAR_ERR_NUMERIC || status == SPAR_ERR_PEER);
    assert_non_null(strstr(spar_session_message(s), "spar_session_solve_static: the loads grow"));
    c.softness = -0.05, c.breeze = 1;
    OK(s, spar_session_set_gravity(s, down));
    OK(s, spar_session_set_coupling(s, SPAR_COUPLING_FIXED_POINT, 0, 1e-12, 200));
    if (size > 1) {
        assert_int_equal(spar_session_solve_static(s, last ? 2 : 1, solve, &c, NULL), SPAR_ERR_COMM);
        assert_non_null(strstr(spar_session_message(s), "load_steps (here "));
        status = rank == 0 ? spar_step_begin(s, 0.1) : spar_session_solve_static(s, 1, solve, &c, NULL);
        assert_int_equal(status, SPAR_ERR_COMM);
        assert_non_null(strstr(spar_session_message(s), "another call"));
    }
    OK(s, spar_session_solve_static(s, 1, c.n ? solve : NULL, &c, NULL));
    OK(alone.session, spar_session_solve_static(alone.session, 1, solve, &alone, NULL));
    compare(&c, &alone, 4e-11);
    spar_session_destroy(&c.session);
    spar_session_destroy(&alone.session);
}

int main(int argc, char **argv) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(as_one_process_has_it), cmocka_unit_test(bits_of_one_process),
                                       cmocka_unit_test(one_rank_fails)};
    return RANKS_RUN(argc, argv, tests);
}
