/* The bound on the work of a call: the budget of Newton iterations, and the progress callback that cancels. A beam
   whose driven root jumps by 66 degrees within a step, with a link between two of its nodes, needs hundreds of
   iterations and halvings. Oracles: counts of iterations, and the run of another session in which the refused call was
   not made. */
#include "scene.h"

enum { NODES = 5, JUMP_BUDGET = 100 };

typedef struct world {
    spar_session *s;
    spar_member *beam;
    int told, cancels_at; /* calls of the progress callback; the one that cancels, 0: none */
    double done, expected;
    int warnings;
} world;

static int hear(spar_session *session, double done, double expected, void *context) {
    world *w = context;
    assert_ptr_equal(session, w->s);
    assert_true(done >= 0 && done <= expected);
    w->done = done, w->expected = expected;
    return ++w->told == w->cancels_at ? 7 : 0;
}

static void count_warning(const spar_session *session, int level, const char *text, void *context) {
    (void)session, (void)text;
    ((world *)context)->warnings += level == SPAR_LOG_WARNING;
}

/* A bent beam of 1.3 m, with sections of the size of a small blade's and a link between its nodes 1 and 4, whose root
   has jumped by 1.23 rad within 1 ms (seed 287 of a random search). Its next step of 10 ms takes 3000 iterations. */
static void create(world *w) {
    static const double eta[3] = {0, 0.5, 1}, xyz[9] = {0, 0, 0, 0.65, 0.0430, 0.0191, 1.3, 0.0187, 0.1734},
                        twist[3] = {0.3879, -0.1417, 0.0622},
                        stiffness[3][6] = {{8.611e4, 1.025e4, 5.257e4, 1511, 1121, 5423},
                                           {1.267e5, 2.726e4, 4.379e4, 1052, 2827, 3690},
                                           {1.125e5, 2.235e4, 3.006e4, 1095, 1877, 2975}},
                        mass[3][6] = {{0.5629, -0.02349, -0.02409, 0.06695, 0.02465, 0.0423},
                                      {1.484, 0.04484, 0.0276, 0.03091, 0.02818, 0.002725},
                                      {0.6806, -0.03145, -0.02418, 0.06954, 0.03567, 0.03387}},
                        inertia[3] = {-0.001005, -0.0008339, -0.001117}, a[3] = {0.2859, -0.1503, 0.4686},
                        b[3] = {0.2960, -0.1606, 0.4856},
                        jump[7] = {0.2537, 0.02, -0.02, 0.8181, 0.2422, 0.2137, 0.4758},
                        v[6] = {-0.07, 0.06, -0.05, 0.07, 0.01, -0.01};
    double K[3][36] = {{0}}, M[3][36] = {{0}};
    for (int k = 0; k < 3; k++) {
        const double m = mass[k][0], my = mass[k][1], mz = mass[k][2];
        scene_diagonal(K[k], stiffness[k][0], stiffness[k][1], stiffness[k][2], stiffness[k][3], stiffness[k][4],
                       stiffness[k][5]);
        K[k][22] = K[k][27] = 200;
        scene_diagonal(M[k], m, m, m, mass[k][3], mass[k][4], mass[k][5]);
        M[k][4] = M[k][24] = mz, M[k][5] = M[k][30] = -my;
        M[k][9] = M[k][19] = -mz, M[k][15] = M[k][20] = my;
        M[k][29] = M[k][34] = inertia[k];
    }
    double q[7];
    memcpy(q, jump, sizeof q);
    spari_quat_normalise(q + 3);
    *w = (world){0};
    OK(NULL, spar_session_create(&w->s));
    OK(w->s, spar_beam_create(w->s, "blade", 1, NODES, &w->beam));
    OK(w->s, spar_beam_set_axis(w->beam, 3, eta, xyz, twist));
    OK(w->s, spar_beam_set_sections(w->beam, 3, eta, K[0], M[0]));
    OK(w->s, spar_member_set_root(w->beam, SPAR_ROOT_DRIVEN));
    OK(w->s, spar_member_commit(w->beam));
    spar_joint *link;
    OK(w->s, spar_link_create(w->s, "link", w->beam, 1, a, w->beam, 4, b, &link));
    OK(w->s, spar_session_set_log(w->s, count_warning, w));
    OK(w->s, spar_member_drive(w->beam, q, v, NULL));
    OK(w->s, spar_step(w->s, 1e-3, NULL, NULL, NULL));
}

static int64_t iterations(const world *w) {
    int64_t n;
    OK(w->s, spar_member_get_iterations(w->beam, &n, NULL));
    return n;
}

enum { STATE = 19 * NODES + 1 };

static void look(const world *w, double x[STATE]) {
    OK(w->s, spar_member_get_motion(w->beam, x, x + 7 * NODES, x + 13 * NODES));
    OK(w->s, spar_session_get_time(w->s, x + 19 * NODES, NULL, NULL));
}

/* The run goes on as one in which the refused call was not made: to Newton's tolerance, for tangents may be reused. */
static void goes_on(world *w) {
    world other;
    double x[STATE], y[STATE];
    create(&other);
    w->cancels_at = 0;
    for (int k = 0; k < 3; k++) {
        OK(w->s, spar_step(w->s, 1e-4, NULL, NULL, NULL));
        OK(other.s, spar_step(other.s, 1e-4, NULL, NULL, NULL));
    }
    look(w, x);
    look(&other, y);
    for (int i = 0; i < 13 * NODES; i++) {
        NEAR(x[i], y[i], 1e-5 * (1 + fabs(y[i])));
    }
    spar_session_destroy(&other.s);
    spar_session_destroy(&w->s);
}

/* Within the default budget the step is solved. */
static void test_default(void **state) {
    (void)state;
    world w;
    char text[32];
    create(&w);
    OK(w.s, spar_session_get_option(w.s, "newton.budget", sizeof text, text));
    assert_string_equal(text, "100000");
    const int64_t before = iterations(&w);
    OK(w.s, spar_step(w.s, 1e-2, NULL, NULL, NULL));
    assert_true(iterations(&w) - before > 10 * JUMP_BUDGET);
    spar_session_destroy(&w.s);
}

static void test_budget(void **state) {
    (void)state;
    for (int own_loop = 0; own_loop < 2; own_loop++) {
        world w;
        double x[STATE], y[STATE];
        create(&w);
        OK(w.s, spar_session_set_option(w.s, "newton.budget", "100"));
        look(&w, x);
        const int64_t before = iterations(&w);
        if (own_loop) {
            OK(w.s, spar_step_begin(w.s, 1e-2));
            REFUSED(w.s, SPAR_ERR_LIMIT, "newton.budget", spar_step_solve(w.s));
            OK(w.s, spar_step_reject(w.s));
        } else {
            REFUSED(w.s, SPAR_ERR_LIMIT, "newton.budget", spar_step(w.s, 1e-2, NULL, NULL, NULL));
        }
        assert_int_equal(iterations(&w) - before, JUMP_BUDGET);
        look(&w, y);
        assert_memory_equal(x, y, sizeof x);
        goes_on(&w);
    }
}

/* The budget is that of a step, with all its solutions; a host that solves again and again reaches it too. */
static void test_solved_again(void **state) {
    (void)state;
    world w;
    create(&w);
    OK(w.s, spar_session_set_option(w.s, "newton.budget", "40"));
    OK(w.s, spar_step_begin(w.s, 1e-4));
    const int64_t before = iterations(&w);
    int solved = 0, status = SPAR_OK;
    while (status == SPAR_OK && solved < 100) {
        status = spar_step_solve(w.s);
        solved++;
    }
    assert_int_equal(status, SPAR_ERR_LIMIT);
    assert_true(solved > 1);
    assert_int_equal(iterations(&w) - before, 40);
    OK(w.s, spar_step_reject(w.s));
    OK(w.s, spar_session_set_option(w.s, "newton.budget", "100000"));
    goes_on(&w);
}

static void test_cancelled(void **state) {
    (void)state;
    for (int threads = 1; threads < 3; threads++) {
        world w;
        double x[STATE], y[STATE];
        create(&w);
        OK(w.s, spar_session_set_threads(w.s, threads));
        OK(w.s, spar_session_set_progress(w.s, hear, &w));
        look(&w, x);
        const int64_t before = iterations(&w);
        w.cancels_at = 61;
        REFUSED(w.s, SPAR_ERR_USER, "cancelled by the progress callback (7) after 60 Newton iterations",
                spar_step(w.s, 1e-2, NULL, NULL, NULL));
        assert_true(w.told == 61 && w.done == 60 && w.expected == 100000);
        assert_int_equal(iterations(&w) - before, 60);
        look(&w, y);
        assert_memory_equal(x, y, sizeof x);
        goes_on(&w);
    }
}

/* An adaptive step is cancelled in any of its tries. */
static void test_adaptive(void **state) {
    (void)state;
    world w;
    double dt = 1e-2;
    create(&w);
    OK(w.s, spar_session_set_progress(w.s, hear, &w));
    OK(w.s, spar_session_set_tolerance(w.s, 0.0976, 0.0886));
    w.cancels_at = 400;
    REFUSED(w.s, SPAR_ERR_USER, "cancelled", spar_step_adaptive(w.s, &dt, NULL, NULL, NULL, NULL));
    assert_int_equal(w.told, 400);
    assert_true(dt == 1e-2);
    OK(w.s, spar_session_set_tolerance(w.s, 0, 0));
    goes_on(&w);
}

/* Static solutions: of a member, and of the session. The budget counts for each load step. */
static void test_static(void **state) {
    (void)state;
    for (int whole = 0; whole < 2; whole++) {
        world w = {0};
        double K[36], x[7 * NODES], y[7 * NODES], load[6] = {0, 0, 600, 0, 0, 0};
        OK(NULL, spar_session_create(&w.s));
        scene_diagonal(K, 1e6, 1e6, 1e6, 100, 100, 100);
        w.beam = scene_beam(w.s, "beam", 1, NODES, 1, K, NULL);
        OK(w.s, spar_member_commit(w.beam));
        OK(w.s, spar_member_set_load(w.beam, NODES - 1, SPAR_LOAD_DEAD, load));
        OK(w.s, spar_session_set_option(w.s, "newton.budget", "3"));
        OK(w.s, spar_member_get_motion(w.beam, x, NULL, NULL));
        REFUSED(w.s, SPAR_ERR_LIMIT, "newton.budget",
                whole ? spar_session_solve_static(w.s, 1, NULL, NULL, NULL) : spar_member_solve_static(w.beam, 1));
        OK(w.s, spar_member_get_motion(w.beam, y, NULL, NULL));
        assert_memory_equal(x, y, sizeof x);
        OK(w.s, spar_session_set_option(w.s, "newton.budget", "100000"));
        OK(w.s, spar_session_set_progress(w.s, hear, &w));
        w.cancels_at = 5;
        REFUSED(w.s, SPAR_ERR_USER, "cancelled by the progress callback (7) after 4 Newton iterations",
                whole ? spar_session_solve_static(w.s, 2, NULL, NULL, NULL) : spar_member_solve_static(w.beam, 2));
        assert_true(w.expected == 200000);
        OK(w.s, spar_member_get_motion(w.beam, y, NULL, NULL));
        assert_memory_equal(x, y, sizeof x);
        OK(w.s, spar_session_set_progress(w.s, NULL, NULL));
        OK(w.s, whole ? spar_session_solve_static(w.s, 1, NULL, NULL, NULL) : spar_member_solve_static(w.beam, 1));
        spar_session_destroy(&w.s);
    }
}

/* Where Newton may make three iterations alone, a swing of a beam is solved in tens of parts of a step. This is told
   once, with the same motion as from steps without halving to the error of the scheme (0.05 of the largest deflection).
 */
static void test_halvings_told(void **state) {
    (void)state;
    enum { P = 6, STEPS = 6 };
    double K[36], M[36], load[6] = {0, 0, 100, 0, 0, 0};
    scene_diagonal(K, 1e5, 1e5, 1e5, 20, 20, 20);
    scene_diagonal(M, 1, 1, 1, 0.02, 0.01, 0.01);
    for (int few = 0; few < 2; few++) {
        world w = {0};
        OK(NULL, spar_session_create(&w.s));
        OK(w.s, spar_session_set_log(w.s, count_warning, &w));
        OK(w.s, spar_session_set_newton(w.s, 1e-15, 1e-8, few ? 2 : 50));
        w.beam = scene_beam(w.s, "arm", 2, P / 2, 1, K, M);
        OK(w.s, spar_member_commit(w.beam));
        OK(w.s, spar_member_set_load(w.beam, P - 1, SPAR_LOAD_DEAD, load));
        for (int k = 0; k < STEPS; k++) {
            OK(w.s, spar_step(w.s, 0.05, NULL, NULL, NULL));
        }
        int told = 0;
        for (int i = 0; spar_session_get_warning(w.s, i)[0]; i++) {
            told += strstr(spar_session_get_warning(w.s, i), "was halved") != NULL;
        }
        assert_int_equal(told, few);
        spar_session_destroy(&w.s);
    }
}

static int nosy(spar_session *session, double done, double expected, void *context) {
    (void)done, (void)expected;
    int *refused = context, iterations;
    *refused += spar_step(session, 1e-2, NULL, NULL, &iterations) == SPAR_ERR_STATE;
    *refused += spar_session_set_progress(session, NULL, NULL) == SPAR_ERR_STATE;
    *refused += spar_session_set_option(session, "newton.budget", "1") == SPAR_ERR_STATE;
    return 0;
}

/* What a callback must not call is refused, and the step goes on. */
static void test_calls_within(void **state) {
    (void)state;
    world w;
    int refused = 0;
    create(&w);
    OK(w.s, spar_session_set_progress(w.s, nosy, &refused));
    OK(w.s, spar_step(w.s, 1e-4, NULL, NULL, NULL));
    assert_true(refused >= 3 && refused % 3 == 0);
    OK(w.s, spar_session_set_progress(w.s, NULL, NULL));
    spar_session_destroy(&w.s);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_default),       cmocka_unit_test(test_budget),
                                       cmocka_unit_test(test_solved_again),  cmocka_unit_test(test_cancelled),
                                       cmocka_unit_test(test_adaptive),      cmocka_unit_test(test_static),
                                       cmocka_unit_test(test_halvings_told), cmocka_unit_test(test_calls_within)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
