/* Trial runs on any number of ranks: all ranks are told the same table and the same advice, which are those of one
   process; the state is as before to the bit; a callback that fails on one rank only is known to all, and nobody waits
   (ctest's time limit is the witness). The last rank has no fluid nodes, when there are several. */
#include "scene.h"
#include "trials.h"

#include "ranks.h"
#include <spar/spar_mpi.h>
#include <stdio.h>

enum { NODES = 24, STEPS = 16, POINTS = 12 };
static const double dt = 0.02;

typedef struct scene {
    spar_session *session;
    spar_member *beam, *body;
    spar_fluid *around, *pull;
    int64_t n; /* this rank's nodes around the beam */
    double x[NODES][3];
    int body_here;
    int calls, bad_call;       /* from this call on the fluid answers 77, until good_call; 0: never */
    int good_call;             /* 0: never again */
    int begins, bad_beginning; /* the same of the call before a step */
} scene;

static void create(scene *c, int me, int ranks) {
    static const double q[4] = {1, 0, 0, 0}, where[3] = {0, 5, 0}, centre[3] = {0.1, 0, 0}, J[3] = {1, 2, 3};
    double K[36], M[36], mass[36], gravity[3] = {0, 0, -2};
    int carriers = ranks > 1 ? ranks - 1 : 1;
    memset(c, 0, sizeof *c);
    OK(NULL, ranks > 1 ? spar_session_create_mpi(MPI_COMM_WORLD, &c->session) : spar_session_create(&c->session));
    spar_session *s = c->session;
    scene_box(K, M);
    OK(s, spar_session_set_gravity(s, gravity));
    OK(s, spar_session_set_coupling(s, SPAR_COUPLING_IQN_ILS, 0, 1e-10, 100));
    c->beam = scene_beam(s, "beam", 2, POINTS / 2, 10, K, M);
    OK(s, spar_member_set_root(c->beam, SPAR_ROOT_FIXED));
    OK(s, spar_member_commit(c->beam));
    scene_mass(mass, 3, centre, J);
    OK(s, spar_rigid_create(s, "body", where, q, mass, &c->body)); /* another owner, when there are several ranks */
    OK(s, spar_member_commit(c->body));
    for (int i = 0; i < NODES; i++) {
        if (i % carriers == me) {
            double angle = 0.7 * i, place[3] = {10.0 * i / (NODES - 1), 0.3 * cos(angle), 0.3 * sin(angle)};
            memcpy(c->x[c->n++], place, sizeof place);
        }
    }
    OK(s, spar_fluid_create(c->beam, "around", &c->around));
    OK(s, spar_fluid_set_motion_nodes(c->around, c->n, c->n ? c->x[0] : NULL));
    OK(s, spar_fluid_set_force_nodes(c->around, c->n, c->n ? c->x[0] : NULL));
    OK(s, spar_fluid_map(c->around));
    c->body_here = me == 0;
    OK(s, spar_fluid_create(c->body, "pull", &c->pull));
    OK(s, spar_fluid_set_motion_nodes(c->pull, c->body_here, c->body_here ? where : NULL));
    OK(s, spar_fluid_set_force_nodes(c->pull, c->body_here, c->body_here ? where : NULL));
    OK(s, spar_fluid_map(c->pull));
    OK(s, spar_fluid_set_option(c->pull, "velocity", "own"));
}

/* A viscous medium around the beam with a load that comes and goes, and moments; a spring on the body. */
static int solve(spar_session *s, double t, double step, int iteration, void *context) {
    scene *c = context;
    double v[NODES][3], f[NODES][3], moment[NODES][3], x[3], pull[3];
    (void)iteration;
    c->calls++;
    if (c->bad_call > 0 && c->calls >= c->bad_call && (c->good_call == 0 || c->calls < c->good_call)) {
        return 77;
    }
    OK(s, spar_fluid_pull_motion(c->around, 1, NULL, c->n ? v[0] : NULL));
    for (int64_t i = 0; i < c->n; i++) {
        for (int k = 0; k < 3; k++) {
            f[i][k] = -0.5 * v[i][k] + (k == 1 ? 2 * sin(3 * (t + step)) : 0);
            moment[i][k] = k == 0 ? 0.1 : 0;
        }
    }
    OK(s, spar_fluid_pull_motion(c->pull, 1, c->body_here ? x : NULL, NULL));
    for (int k = 0; k < 3 && c->body_here; k++) {
        pull[k] = -8 * (x[k] - (k == 1 ? 5 : 0));
    }
    OK(s, spar_fluid_push_forces(c->around, c->n ? f[0] : NULL, c->n ? moment[0] : NULL));
    OK(s, spar_fluid_push_forces(c->pull, c->body_here ? pull : NULL, NULL));
    return 0;
}

static int before(spar_session *s, double t, double step, void *context) {
    scene *c = context;
    (void)s, (void)t, (void)step;
    return ++c->begins == c->bad_beginning ? 78 : 0;
}

static void go(scene *c, int n) {
    for (int i = 0; i < n; i++) {
        OK(c->session, spar_step(c->session, dt, solve, c, NULL));
    }
}

enum { STATE = 25 * POINTS + 25 + 6 };

static void state_of(const scene *c, double *out) {
    OK(c->session, spar_member_get_motion(c->beam, out, out + 7 * POINTS, out + 13 * POINTS));
    OK(c->session, spar_member_get_loads(c->beam, out + 19 * POINTS));
    out += 25 * POINTS;
    OK(c->session, spar_member_get_motion(c->body, out, out + 7, out + 13));
    OK(c->session, spar_member_get_loads(c->body, out + 19));
    OK(c->session, spar_member_get_reaction(c->beam, out + 25));
}

static void same_bits(const double *a, const scene *c) {
    double b[STATE];
    state_of(c, b);
    assert_memory_equal(a, b, sizeof b);
}

/* The numbers of all ranks are those of rank 0. */
static void same_on_all(const double *x, int n) {
    double first[128];
    assert_true(n <= 128);
    memcpy(first, x, (size_t)n * sizeof *x);
    MPI_Bcast(first, n, MPI_DOUBLE, 0, MPI_COMM_WORLD);
    assert_memory_equal(first, x, (size_t)n * sizeof *x);
}

/* In place of the empty "nothing failed" of a status: the failing rank's own, the others' SPAR_ERR_PEER. */
static void told(int status, int own, int bad, const spar_session *s, const char *text) {
    assert_int_equal(status, rank == bad ? own : SPAR_ERR_PEER);
    assert_non_null(strstr(spar_session_message(s), text));
}

/* ---- answers ---- */

/* Errors, sizes and what is in force to rounding, which decides at what digit the coupling stops (rtol 1e-10); the
   added mass is what the quasi-Newton columns show of it. */
static void same_table(void **state) {
    (void)state;
    scene all, alone;
    double table[SPAR_ROW_COUNT][COLUMN_COUNT], serial[SPAR_ROW_COUNT][COLUMN_COUNT], held[STATE];
    create(&all, rank, size);
    create(&alone, 0, 1);
    go(&all, 3);
    go(&alone, 3);
    state_of(&all, held);
    OK(all.session, trial_report_effects(all.session, dt, STEPS, before, solve, &all, table[0]));
    same_bits(held, &all);
    OK(alone.session, trial_report_effects(alone.session, dt, STEPS, before, solve, &alone, serial[0]));
    same_on_all(table[0], SPAR_ROW_COUNT * COLUMN_COUNT);
    for (int r = 0; r < SPAR_ROW_COUNT; r++) {
        assert_true(table[r][COLUMN_IN_FORCE] == serial[r][COLUMN_IN_FORCE]);
        for (int c = COLUMN_SIZE; c <= COLUMN_REACTION; c++) {
            NEAR(table[r][c], serial[r][c], r == SPAR_ROW_ITERATION && c == COLUMN_SIZE ? 0.01 : 1e-7);
        }
    }
    assert_true(table[SPAR_ROW_GRAVITY][COLUMN_REACTION] > 0.01);
    assert_true(table[SPAR_ROW_FLUID_MOMENT][COLUMN_IN_FORCE] == 1);
    go(&all, 2);
    spar_session_destroy(&all.session);
    spar_session_destroy(&alone.session);
}

/* What is counted decides what is advised, summed over the ranks: every rank decides alike. Of motion alone, and of all
   goals. */
static void same_advice_for(int goals, double tolerance) {
    scene c, untried;
    const double part = 1 + rank;
    double advice[ADVICE_COUNT + 4], held[STATE];
    int fidelity, nodes, points;
    int64_t modes;
    create(&c, rank, size);
    create(&untried, rank, size);
    go(&c, 3);
    go(&untried, 3);
    state_of(&c, held);
    OK(c.session, spar_trial_set_goals(trial_of(c.session), goals));
    OK(c.session, spar_trial_push_numbers(trial_of(c.session), 1, &part));
    OK(c.session, trial_advise(c.session, tolerance, dt, STEPS, STEPS * dt, before, solve, &c, advice));
    same_bits(held, &c);
    OK(c.session, trial_get_beam(c.beam, &fidelity, &modes, &nodes, &points));
    advice[ADVICE_COUNT] = fidelity;
    advice[ADVICE_COUNT + 1] = (double)modes;
    advice[ADVICE_COUNT + 2] = nodes;
    advice[ADVICE_COUNT + 3] = points;
    same_on_all(advice, ADVICE_COUNT + 4);
    assert_true(advice[ADVICE_ERROR] <= tolerance);
    go(&c, 3);
    go(&untried, 3);
    state_of(&untried, held);
    same_bits(held, &c);
    spar_session_destroy(&c.session);
    spar_session_destroy(&untried.session);
}

static void same_advice(void **state) {
    (void)state;
    same_advice_for(SPAR_GOAL_MOTION, 0.3);
    same_advice_for(SPAR_GOAL_MOTION | SPAR_GOAL_REACTION | SPAR_GOAL_SECTION | SPAR_GOAL_LOAD | SPAR_GOAL_NUMBERS,
                    0.5);
}

/* ---- failures on one rank ---- */

static void failing_callbacks(void **state) {
    (void)state;
    for (int bad = 0; bad < size; bad++) {
        scene c;
        double report[TRY_COUNT], held[STATE];
        create(&c, rank, size);
        go(&c, 2);
        state_of(&c, held);
        for (int when = 1; when <= 9; when += 8) {
            c.calls = 0;
            c.bad_call = rank == bad ? when : 0;
            told(trial_run(c.session, dt, 8, before, solve, &c, 0, report), SPAR_ERR_USER, bad, c.session, "77");
            same_bits(held, &c);
            c.bad_call = c.begins = 0;
            c.bad_beginning = rank == bad ? 1 + when / 2 : 0;
            told(trial_run(c.session, dt, 8, before, solve, &c, 0, report), SPAR_ERR_USER, bad, c.session, "78");
            same_bits(held, &c);
            c.bad_beginning = 0;
        }
        OK(c.session, trial_run(c.session, dt, 8, before, solve, &c, 0, report));
        go(&c, 1);
        spar_session_destroy(&c.session);
    }
}

/* In the run that all are compared with, that is the end; in the run without inertia (the first row), the row says that
   it fails, on all ranks, and the others are found. */
static void failing_in_a_table(void **state) {
    (void)state;
    for (int bad = 0; bad<size; bad += size> 1 ? size - 1 : 1) {
        scene c;
        double table[SPAR_ROW_COUNT][COLUMN_COUNT], held[STATE], report[TRY_COUNT];
        create(&c, rank, size);
        go(&c, 2);
        state_of(&c, held);
        c.calls = 0;
        c.bad_call = rank == bad ? 4 : 0;
        told(trial_report_effects(c.session, dt, 8, before, solve, &c, table[0]), SPAR_ERR_USER, bad, c.session, "77");
        same_bits(held, &c);
        c.bad_call = 0;
        OK(c.session, trial_run(c.session, dt, 8, before, solve, &c, 0, report));
        c.calls = 0;
        c.bad_call = rank == bad ? (int)report[TRY_EVALUATIONS] + 3 : 0;
        c.good_call = c.bad_call + 1;
        OK(c.session, trial_report_effects(c.session, dt, 8, before, solve, &c, table[0]));
        assert_true(table[SPAR_ROW_INERTIA][COLUMN_MOTION] == -1);
        assert_true(table[SPAR_ROW_GRAVITY][COLUMN_MOTION] > 0);
        same_on_all(table[0], SPAR_ROW_COUNT * COLUMN_COUNT);
        same_bits(held, &c);
        spar_session_destroy(&c.session);
    }
}

/* Advice with a rank that fails now and then comes to its end; with one that always fails there is none. */
static void failing_in_advice(void **state) {
    (void)state;
    for (int bad = 0; bad<size; bad += size> 1 ? size - 1 : 1) {
        scene c;
        double advice[ADVICE_COUNT], held[STATE];
        create(&c, rank, size);
        state_of(&c, held);
        c.bad_call = rank == bad ? 1 : 0;
        int status = trial_advise(c.session, 0.3, dt, 8, 8 * dt, before, solve, &c, advice);
        assert_true(status == SPAR_ERR_NUMERIC || status == SPAR_ERR_USER || status == SPAR_ERR_PEER);
        assert_non_null(strstr(spar_session_message(c.session), "77"));
        same_bits(held, &c);
        c.calls = 0;
        c.bad_call = rank == bad ? 300 : 0;
        c.good_call = 310;
        OK(c.session, trial_advise(c.session, 0.3, dt, 8, 8 * dt, before, solve, &c, advice));
        same_on_all(advice, ADVICE_COUNT);
        same_bits(held, &c);
        spar_session_destroy(&c.session);
    }
}

/* Steps to a tolerance: the same dt and the same tries on all ranks, and as one process has them, to 1e-6 (sums of
   loads differ in their last digits); errors of members are known on every rank. */
static void same_steps(void **state) {
    (void)state;
    scene all, alone;
    double next[2] = {0.1, 0.1}, taken[2], control[3], error[2][4];
    int64_t rejected[2];
    int reject;
    create(&all, rank, size);
    create(&alone, 0, 1);
    OK(all.session, spar_session_set_tolerance(all.session, 1e-6, 3e-3));
    OK(alone.session, spar_session_set_tolerance(alone.session, 1e-6, 3e-3));
    for (int i = 0; i < 30; i++) {
        OK(all.session, spar_step_adaptive(all.session, next, before, solve, &all, taken));
        OK(alone.session, spar_step_adaptive(alone.session, next + 1, before, solve, &alone, taken + 1));
        same_on_all(next, 1);
        same_on_all(taken, 1);
        NEAR(taken[0], taken[1], 1e-6 * taken[1]);
    }
    OK(all.session, spar_session_get_step_control(all.session, control, control + 1, &reject, &rejected[0]));
    OK(alone.session, spar_session_get_step_control(alone.session, NULL, NULL, NULL, &rejected[1]));
    control[2] = (double)rejected[0];
    OK(all.session, spar_member_estimate_error(all.beam, error[0], error[0] + 1));
    OK(all.session, spar_member_estimate_error(all.body, error[0] + 2, error[0] + 3));
    OK(alone.session, spar_member_estimate_error(alone.beam, error[1], error[1] + 1));
    OK(alone.session, spar_member_estimate_error(alone.body, error[1] + 2, error[1] + 3));
    same_on_all(control, 3);
    same_on_all(error[0], 4);
    assert_true(reject == 0 && rejected[0] >= 1);
    assert_true(rejected[0] == rejected[1]);
    for (int k = 0; k < 4; k++) {
        NEAR(error[0][k], error[1][k], 1e-3 * error[1][k]);
    }
    assert_true(error[0][0] > 0 && error[0][1] > 0 && error[0][2] > 0 && error[0][3] == 0);
    spar_session_destroy(&all.session);
    spar_session_destroy(&alone.session);
}

typedef struct hearing {
    int calls, stop; /* answers 5 in this call, from 1; 0: in none */
    double heard[2];
} hearing;

static int hear(spar_session *s, double done, double expected, void *context) {
    hearing *h = context;
    (void)s;
    h->heard[0] = done, h->heard[1] = expected;
    return ++h->calls == h->stop ? 5 : 0;
}

/* A rank that stops stops all, in the same call; all hear the same. Set on one rank only it is refused: the ranks would
   part. */
static void stopped_on_one_rank(void **state) {
    (void)state;
    scene c;
    double advice[ADVICE_COUNT], table[SPAR_ROW_COUNT][COLUMN_COUNT], held[STATE];
    create(&c, rank, size);
    go(&c, 2);
    state_of(&c, held);
    for (int k = 0; k < 2 * size; k++) {
        int bad = k / 2, stop = k % 2 ? 2 : 1;
        hearing h = {.stop = rank == bad ? stop : 0};
        OK(c.session, spar_trial_set_progress(trial_of(c.session), hear, &h));
        told(trial_advise(c.session, 0.3, dt, STEPS, STEPS * dt, before, solve, &c, advice), SPAR_ERR_USER, bad,
             c.session, "cancelled by the progress callback");
        assert_int_equal(h.calls, stop);
        same_on_all(h.heard, 2);
        same_bits(held, &c);
        h.calls = 0;
        told(trial_report_effects(c.session, dt, 8, before, solve, &c, table[0]), SPAR_ERR_USER, bad, c.session,
             "cancelled by the progress callback");
        assert_int_equal(h.calls, stop);
        same_on_all(h.heard, 2);
        same_bits(held, &c);
    }
    hearing h = {0};
    if (size > 1) {
        OK(c.session, spar_trial_set_progress(trial_of(c.session), rank == 0 ? hear : NULL, &h));
        REFUSED(c.session, SPAR_ERR_COMM, "progress callback",
                trial_advise(c.session, 0.3, dt, STEPS, STEPS * dt, before, solve, &c, advice));
        assert_int_equal(h.calls, 0);
        same_bits(held, &c);
    }
    OK(c.session, spar_trial_set_progress(trial_of(c.session), hear, &h));
    OK(c.session, trial_advise(c.session, 0.3, dt, STEPS, STEPS * dt, before, solve, &c, advice));
    assert_int_equal(h.calls, (int)advice[ADVICE_RUNS]);
    go(&c, 1);
    spar_session_destroy(&c.session);
}

/* Arguments that are wrong on one rank. */
static void bad_arguments(void **state) {
    (void)state;
    scene c;
    double table[SPAR_ROW_COUNT][COLUMN_COUNT], advice[ADVICE_COUNT];
    int bad = size - 1, here = rank == bad;
    create(&c, rank, size);
    spar_session *s = c.session;
    REFUSED(s, SPAR_ERR_STATE, "no steps", spar_trial_run(trial_of(s), 0));
    OK(s, trial_set(s, dt, 8, before, solve, &c));
    if (here) {
        REFUSED(s, SPAR_ERR_ARGUMENT, "dt", spar_trial_set_steps(trial_of(s), NAN, 8));
    }
    OK(s, spar_trial_run(trial_of(s), 0));
    spar_trial *extra = NULL, *two = NULL;
    if (here && size > 1) {
        OK(s, spar_trial_create(s, &extra));
    }
    OK(s, spar_trial_create(s, &two));
    OK(s, spar_trial_set_steps(two, dt, 8));
    if (size > 1) {
        REFUSED(s, SPAR_ERR_COMM, "number of the trial", spar_trial_run(two, 0));
    }
    spar_trial_destroy(&two);
    spar_trial_destroy(&extra);
    told(trial_report_effects(s, dt, here ? 7 : 8, before, solve, &c, table[0]), SPAR_ERR_ARGUMENT, bad, s,
         "multiple of 8");
    told(trial_advise(s, here ? 2 : 0.05, dt, 8, 8 * dt, before, solve, &c, advice), SPAR_ERR_ARGUMENT, bad, s,
         "tolerance");
    go(&c, 2);
    spar_session_destroy(&c.session);
}

int main(int argc, char **argv) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(same_table),        cmocka_unit_test(same_advice),
        cmocka_unit_test(failing_callbacks), cmocka_unit_test(failing_in_a_table),
        cmocka_unit_test(failing_in_advice), cmocka_unit_test(bad_arguments),
        cmocka_unit_test(same_steps),        cmocka_unit_test(stopped_on_one_rank),
    };
    return RANKS_RUN(argc, argv, tests);
}
