/* A coupled scene on any number of ranks against the same scene on one process: a flexible beam of three elements and a
   heavy piston, whose fluid nodes are dealt out over all ranks but the last (which has none, when there are several).
   The serial run is made on every rank beside the other; results agree to 1e-12 of their size, which is rounding in the
   order of sums. Then everything a single rank can do wrong: all ranks are told, none waits (ctest's time limit is the
   witness), and the run goes on. */
#include "scene.h"

#include "ranks.h"
#include <spar/spar_mpi.h>
#include <stdio.h>

enum { NODES = 40, STEPS = 12, POINTS = 12 };

typedef struct scene {
    spar_session *session;
    spar_member *beam, *piston;
    spar_fluid *around, *added;
    int64_t n;              /* this rank's nodes around the beam */
    double x[NODES][3];     /* their reference places */
    int piston_here, parts; /* ranks that carry the piston's added mass: each its part */
    int calls, bad_call;    /* this call of the fluid pushes NaN */
    int user_call;          /* this call answers 77 */
} scene;

static int learns;   /* the added mass is learned, at one station */
static double guess; /* of the piston's added mass, kg, and of as much spread along the beam; 0: none */

/* Rank `me` of `ranks` gets its share of the nodes. */
static void create(scene *c, int me, int ranks, int scheme) {
    static const double q[4] = {1, 0, 0, 0}, where[3] = {0, 5, 0}, centre[3] = {0, 0, 0}, J[3] = {1, 1, 1};
    double K[36], M[36], mass[36], added[36], along[36], gravity[3] = {0, 0, -2}, eta[1] = {0}, tip[1] = {1};
    int carriers = ranks > 1 ? ranks - 1 : 1;
    memset(c, 0, sizeof *c);
    if (ranks > 1) {
        OK(NULL, spar_session_create_mpi(MPI_COMM_WORLD, &c->session));
    } else {
        OK(NULL, spar_session_create(&c->session));
    }
    spar_session *s = c->session;
    scene_box(K, M);
    OK(s, spar_session_set_gravity(s, gravity));
    OK(s, spar_session_set_coupling(s, scheme, 0, 1e-12, 200));
    OK(s, spar_session_set_relaxation(s, 0.3));
    c->beam = scene_beam(s, "beam", 3, POINTS / 3, 10, K, M);
    OK(s, spar_member_set_root(c->beam, SPAR_ROOT_FIXED));
    OK(s, spar_member_set_effects(c->beam, SPAR_EFFECT_FLUID_HISTORY, 0));
    scene_diagonal(added, guess, guess, guess, 0, 0, 0);
    scene_diagonal(along, guess / 10, guess / 10, guess / 10, 0, 0, 0);
    OK(s, spar_member_set_added_mass(c->beam, guess > 0, eta, along));
    scene_diagonal(mass, 0.5, 0.5, 0.5, 0.02, 0.01, 0.01);
    OK(s, spar_beam_set_masses(c->beam, guess > 0, tip, mass));
    OK(s, spar_beam_set_mass_damping(c->beam, guess > 0 ? 0.3 : 0));
    OK(s, spar_member_learn_added_mass(c->beam, learns, eta));
    OK(s, spar_member_commit(c->beam));
    scene_mass(mass, 3, centre, J);
    OK(s, spar_rigid_create(s, "piston", where, q, mass, &c->piston));
    OK(s, spar_member_set_added_mass(c->piston, guess > 0, NULL, added));
    OK(s, spar_member_learn_added_mass(c->piston, learns, NULL));
    OK(s, spar_member_commit(c->piston));
    for (int i = 0; i < NODES; i++) {
        if (i % carriers == me) {
            double angle = 0.7 * i, place[3] = {10.0 * i / (NODES - 1), 0.3 * cos(angle), 0.3 * sin(angle)};
            memcpy(c->x[c->n++], place, sizeof place);
        }
    }
    c->parts = carriers;
    c->piston_here = me < carriers;
    OK(s, spar_fluid_create(c->beam, "around", &c->around));
    OK(s, spar_fluid_set_motion_nodes(c->around, c->n, c->n ? c->x[0] : NULL));
    OK(s, spar_fluid_set_force_nodes(c->around, c->n, c->n ? c->x[0] : NULL));
    OK(s, spar_fluid_map(c->around));
    OK(s, spar_fluid_create(c->piston, "added", &c->added));
    OK(s, spar_fluid_set_force_nodes(c->added, c->piston_here, c->piston_here ? where : NULL));
    OK(s, spar_fluid_map(c->added));
}

/* A stiff and viscous medium around the beam, pulled sideways; twice its own mass of added mass on the piston. */
static int solve(spar_session *s, double t, double dt, int iteration, void *context) {
    scene *c = context;
    double x[NODES][3], v[NODES][3], f[NODES][3], old[NODES][3], moment[NODES][3], q[7], a[6], piston[3];
    (void)iteration;
    c->calls++;
    OK(s, spar_fluid_pull_motion(c->around, 1, c->n ? x[0] : NULL, c->n ? v[0] : NULL));
    OK(s, spar_fluid_pull_forces(c->around, 0, c->n ? old[0] : NULL));
    for (int64_t i = 0; i < c->n; i++) {
        for (int k = 0; k < 3; k++) {
            f[i][k] =
                0.1 * old[i][k] - 20 * (x[i][k] - c->x[i][k]) - 3 * v[i][k] + (k == 1 ? 2 * sin(3 * (t + dt)) : 0);
            moment[i][k] = 0.1 * v[i][(k + 1) % 3];
        }
    }
    OK(s, spar_member_get_motion(c->piston, q, NULL, a));
    for (int k = 0; k < 3; k++) {
        piston[k] = (-6 * a[k] - 10 * q[k] + (k == 0)) / c->parts;
    }
    if (c->calls == c->bad_call) {
        f[c->n - 1][1] = NAN;
    }
    if (c->calls == c->user_call) {
        return 77;
    }
    int status = spar_fluid_push_forces(c->around, c->n ? f[0] : NULL, c->n ? moment[0] : NULL);
    OK(s, spar_fluid_push_forces(c->added, piston, NULL));
    return c->calls == c->bad_call ? 0 : status; /* a host that does not look at the status of its push */
}

static void state_of(const scene *c, double *out) {
    OK(c->session, spar_member_get_motion(c->beam, out, out + 7 * POINTS, out + 13 * POINTS));
    out += 19 * POINTS;
    OK(c->session, spar_member_get_motion(c->piston, out, out + 7, out + 13));
    OK(c->session, spar_member_get_reaction(c->beam, out + 19));
    OK(c->session, spar_member_get_loads(c->beam, out + 25));
}

enum { STATE = 19 * POINTS + 25 + 6 * POINTS };

/* Places and turns within 1e-12 of the largest. The loads are iterated to 1e-12 of 4 N only; what answers them at once
   gets what that makes: velocities and reactions 1e-11, accelerations (a rotary inertia of 1e-3 kg m^2) 1e-9. */
static void compare(const scene *a, const scene *b) {
    static const int ends[] = {7 * POINTS,       13 * POINTS,      19 * POINTS, 19 * POINTS + 7,
                               19 * POINTS + 13, 19 * POINTS + 19, STATE};
    double x[STATE], y[STATE];
    state_of(a, x);
    state_of(b, y);
    for (int kind = 0, i = 0; kind < 7; kind++) {
        double largest = 0;
        for (int k = i; k < ends[kind]; k++) {
            largest = fmax(largest, fabs(y[k]));
        }
        for (; i < ends[kind]; i++) {
            NEAR(x[i], y[i], largest * (kind % 3 == 2 ? 1e-9 : kind % 3 == 0 && kind < 6 ? 1e-12 : 1e-11));
        }
    }
}

/* ---- the same as on one process ---- */

static void same_as_serial(void **state) {
    (void)state;
    for (int scheme = SPAR_COUPLING_FIXED_POINT; scheme <= SPAR_COUPLING_IQN_ILS; scheme++) {
        scene all, alone;
        create(&all, rank, size, scheme);
        create(&alone, 0, 1, scheme);
        for (int step = 0; step < STEPS; step++) {
            int iterations, serial;
            OK(all.session, spar_step(all.session, 0.02, solve, &all, &iterations));
            OK(alone.session, spar_step(alone.session, 0.02, solve, &alone, &serial));
            assert_true(abs(iterations - serial) <= 1); /* rounding may decide the last one */
            compare(&all, &alone);
        }
        spar_session_destroy(&all.session);
        spar_session_destroy(&alone.session);
    }
}

/* The same with a guess of the added mass, which every rank has the loads corrected by. Ranks that give different
   guesses are told at commit. */
static void guess_over_ranks(void **state) {
    (void)state;
    static const double x[3] = {0, 9, 0}, q[4] = {1, 0, 0, 0}, c[3] = {0, 0, 0}, J[3] = {1, 1, 1};
    double mass[36], along[36], mass_of_beam[36];
    spar_member *body;
    scene all, alone;
    scene_diagonal(mass_of_beam, 1, 1, 1, 0.02, 0.01, 0.01);
    guess = 5;
    create(&all, rank, size, SPAR_COUPLING_IQN_ILS);
    create(&alone, 0, 1, SPAR_COUPLING_IQN_ILS);
    guess = 0;
    for (int step = 0; step < STEPS; step++) {
        OK(all.session, spar_step(all.session, 0.02, solve, &all, NULL));
        OK(alone.session, spar_step(alone.session, 0.02, solve, &alone, NULL));
        compare(&all, &alone);
    }
    spar_session_destroy(&all.session);
    spar_session_destroy(&alone.session);
    create(&all, rank, size, SPAR_COUPLING_IQN_ILS);
    scene_mass(mass, 3, c, J);
    OK(all.session, spar_rigid_create(all.session, "other", x, q, mass, &body));
    scene_diagonal(mass, rank == size - 1 ? 2 : 1, 1, 1, 0, 0, 0);
    OK(all.session, spar_member_set_added_mass(body, 1, NULL, mass));
    assert_int_equal(spar_member_commit(body), size > 1 ? SPAR_ERR_COMM : SPAR_OK);
    scene_diagonal(mass, 1, 1, 1, 0, 0, 0);
    if (size > 1) {
        assert_non_null(strstr(spar_session_message(all.session), "description"));
        OK(all.session, spar_member_set_added_mass(body, 1, NULL, mass));
        OK(all.session, spar_member_commit(body));
    }
    const double tip = 1;
    scene_diagonal(along, 1e4, 1e4, 1e4, 1e3, 1e3, 1e3);
    spar_member *laden = scene_beam(all.session, "laden", 1, 4, 2, along, mass_of_beam);
    scene_diagonal(mass, 1 + (rank == size - 1), 1 + (rank == size - 1), 1 + (rank == size - 1), 0, 0, 0);
    OK(all.session, spar_beam_set_masses(laden, 1, &tip, mass));
    assert_int_equal(spar_member_commit(laden), size > 1 ? SPAR_ERR_COMM : SPAR_OK);
    spar_session_destroy(&all.session);
}

/* What member k of both runs has learned, and how far the two are from each other. */
static double learned_apart(const scene *all, const scene *alone, int k, double M[36], double *spread) {
    double mine[36], first[36], most = 0;
    int used[2];
    OK(all->session,
       spar_member_get_learned_added_mass(k ? all->piston : all->beam, &used[0], spread, NULL, 1, NULL, mine));
    OK(alone->session,
       spar_member_get_learned_added_mass(k ? alone->piston : alone->beam, &used[1], NULL, NULL, 1, NULL, M));
    memcpy(first, mine, sizeof first);
    MPI_Bcast(first, 36, MPI_DOUBLE, 0, MPI_COMM_WORLD);
    assert_memory_equal(first, mine, sizeof first);
    assert_int_equal(used[0], used[1]);
    assert_true(used[0]);
    for (int i = 0; i < 36; i++) {
        most = fmax(most, fabs(mine[i] - M[i]));
    }
    return most;
}

/* The same learned: every rank has the same bits of each member's mass, and it is that of the serial run. The piston's
   fluid is a mass in the two directions that it moves in: 6 kg, with its spring of 10 N/m over the step 1e-3 kg, to
   1e-9 by every scheme. The beam's medium is none: what is learned is a mean of answers that contradict each other by
   the spread, and as near to that of the other run as the differences are that it is a mean of. Those of relaxed
   iterations agree to rounding: 1e-9. Quasi-Newton carries rounding into its next loads by the condition of its
   columns, here to 1e-2 of a difference (3 ranks): 2e-2 of the spread, of the mass of 0.085 kg/m and the fluid's. */
static void learning_over_ranks(void **state) {
    (void)state;
    for (int scheme = SPAR_COUPLING_FIXED_POINT; scheme <= SPAR_COUPLING_IQN_ILS; scheme++) {
        scene all, alone;
        double M[36], spread, apart;
        learns = 1;
        create(&all, rank, size, scheme);
        create(&alone, 0, 1, scheme);
        learns = 0;
        for (int step = 0; step < (scheme == SPAR_COUPLING_IQN_ILS ? 2 : 1) * STEPS; step++) {
            OK(all.session, spar_step(all.session, 0.02, solve, &all, NULL));
            OK(alone.session, spar_step(alone.session, 0.02, solve, &alone, NULL));
            compare(&all, &alone);
        }
        apart = learned_apart(&all, &alone, 0, M, &spread);
        print_message("scheme %d: beam %g of %g, spread %g", scheme, apart, M[7], spread);
        NEAR(apart, 0, scheme == SPAR_COUPLING_IQN_ILS ? 2e-2 * spread * (0.085 + M[7]) : 1e-9 * M[7]);
        apart = learned_apart(&all, &alone, 1, M, &spread);
        print_message("; piston %g of %.12g, spread %g\n", apart, M[0], spread);
        NEAR(apart, 0, 1e-9 * 6);
        NEAR(M[0], 6 + 10 * 0.02 * 0.02 / 4, 1e-4);
        NEAR(M[14], M[0], 1e-9 * 6);
        spar_session_destroy(&all.session);
        spar_session_destroy(&alone.session);
    }
}

/* ---- what one rank can do wrong ---- */

/* Whatever happens in between, the run ends where a run without trouble ends. */
static void check_goes_on(scene *c) {
    scene alone;
    int64_t step;
    create(&alone, 0, 1, SPAR_COUPLING_IQN_ILS);
    OK(c->session, spar_session_get_time(c->session, NULL, &step, NULL));
    c->bad_call = c->user_call = 0;
    for (int64_t i = 0; i < step + 2; i++) {
        if (i >= step) {
            OK(c->session, spar_step(c->session, 0.02, solve, c, NULL));
        }
        OK(alone.session, spar_step(alone.session, 0.02, solve, &alone, NULL));
    }
    compare(c, &alone);
    spar_session_destroy(&alone.session);
}

/* Force and moment of the whole fluid, dealt out over the ranks, are those of the serial run on every rank (to the
   1e-11 that the loads of the two runs agree to), and each rank gives its own part of the same fluid. */
static void totals_over_ranks(void **state) {
    (void)state;
    static const double point[3] = {1, 2, 3};
    scene all, alone;
    double x[6], y[6];
    create(&all, rank, size, SPAR_COUPLING_IQN_ILS);
    create(&alone, 0, 1, SPAR_COUPLING_IQN_ILS);
    for (int step = 0; step < 3; step++) {
        OK(all.session, spar_step(all.session, 0.02, solve, &all, NULL));
        OK(alone.session, spar_step(alone.session, 0.02, solve, &alone, NULL));
        OK(all.session, spar_fluid_sum_loads(all.around, point, x, x + 3));
        OK(alone.session, spar_fluid_sum_loads(alone.around, point, y, y + 3));
        double force = sqrt(y[0] * y[0] + y[1] * y[1] + y[2] * y[2]);
        assert_true(force > 1e-3);
        for (int k = 0; k < 6; k++) {
            NEAR(x[k], y[k], 1e-11 * 10 * force);
        }
        OK(all.session, spar_fluid_check_loads(all.around, point, x, x + 3, 1e-14));
        y[0] += 1e-6 * force; /* as if a node were pushed twice */
        assert_int_equal(spar_fluid_check_loads(all.around, point, y, NULL, 1e-9), SPAR_ERR_ARGUMENT);
    }
    int expected = size > 1 ? SPAR_ERR_COMM : SPAR_OK;
    assert_int_equal(spar_fluid_sum_loads(rank == 0 ? all.around : all.added, point, x, x + 3), expected);
    const double own[3] = {rank == 0, 0, 0};
    assert_int_equal(spar_fluid_sum_loads(all.around, own, x, x + 3), expected);
    assert_true(size == 1 || strstr(spar_session_message(all.session), "point (x)"));
    check_goes_on(&all);
    spar_session_destroy(&all.session);
    spar_session_destroy(&alone.session);
}

/* What another iteration would move is found on every rank, as on one process (1e-9: accelerations are as near). */
static void explicit_error_over_ranks(void **state) {
    (void)state;
    scene all, alone;
    double x[SPAR_REPORT_COUNT], y[SPAR_REPORT_COUNT];
    create(&all, rank, size, SPAR_COUPLING_EXPLICIT);
    create(&alone, 0, 1, SPAR_COUPLING_EXPLICIT);
    OK(all.session, spar_session_set_option(all.session, "coupling.estimate", "on"));
    OK(alone.session, spar_session_set_option(alone.session, "coupling.estimate", "on"));
    for (int step = 0; step < 3; step++) {
        OK(all.session, spar_step(all.session, 0.02, solve, &all, NULL));
        OK(alone.session, spar_step(alone.session, 0.02, solve, &alone, NULL));
        OK(all.session, spar_session_get_report(all.session, SPAR_REPORT_COUNT, x));
        OK(alone.session, spar_session_get_report(alone.session, SPAR_REPORT_COUNT, y));
        assert_true(y[SPAR_REPORT_MOTION_ERROR] > 0);
        NEAR(x[SPAR_REPORT_MOTION_ERROR], y[SPAR_REPORT_MOTION_ERROR], 1e-9 * y[SPAR_REPORT_MOTION_ERROR]);
    }
    spar_session_destroy(&all.session);
    spar_session_destroy(&alone.session);
}

static void nan_on_one_rank(void **state) {
    (void)state;
    int carriers = size > 1 ? size - 1 : 1;
    for (int bad = 0; bad < carriers; bad++) {
        for (int call = 1; call <= 3; call += 2) {
            scene c;
            char prefix[32];
            create(&c, rank, size, SPAR_COUPLING_IQN_ILS);
            c.bad_call = rank == bad ? call : 0;
            int status = spar_step(c.session, 0.02, solve, &c, NULL);
            assert_int_equal(status, rank == bad ? SPAR_ERR_ARGUMENT : SPAR_ERR_PEER);
            snprintf(prefix, sizeof prefix, "rank %d: ", bad);
            const char *text = spar_session_message(c.session);
            assert_non_null(strstr(text, "around"));
            assert_true(rank == bad || strstr(text, prefix) == text);
            check_goes_on(&c);
            spar_session_destroy(&c.session);
        }
    }
}

static void callback_fails_on_one_rank(void **state) {
    (void)state;
    scene c;
    int bad = size - 1; /* the one without nodes */
    create(&c, rank, size, SPAR_COUPLING_IQN_ILS);
    c.user_call = rank == bad ? 2 : 0;
    int status = spar_step(c.session, 0.02, solve, &c, NULL);
    assert_int_equal(status, rank == bad ? SPAR_ERR_USER : SPAR_ERR_PEER);
    assert_non_null(strstr(spar_session_message(c.session), "77"));
    check_goes_on(&c);
    spar_session_destroy(&c.session);
}

/* Ranks in different calls, in every pair of calls of the step. */
static int make_call(scene *c, int which, double dt) {
    int done = 0;
    switch (which) {
    case 0:
        return spar_step_begin(c->session, dt);
    case 1:
        return spar_step_solve(c->session);
    case 2:
        return spar_step_check(c->session, &done);
    case 3:
        return spar_step_accept(c->session);
    default:
        return spar_step_reject(c->session);
    }
}

static void wrong_calls_on_one_rank(void **state) {
    (void)state;
    if (size == 1) {
        return;
    }
    for (int reached = 0; reached < 3; reached++) { /* idle, begun, solved */
        for (int one = 0; one < 5; one++) {
            for (int others = 0; others < 5; others++) {
                if (one == others) {
                    continue;
                }
                scene c;
                create(&c, rank, size, SPAR_COUPLING_IQN_ILS);
                for (int k = 0; k < reached; k++) {
                    OK(c.session, make_call(&c, k, 0.02));
                }
                int status = make_call(&c, rank == 1 ? one : others, 0.02);
                assert_int_equal(status, SPAR_ERR_COMM);
                assert_non_null(strstr(spar_session_message(c.session), "another call"));
                if (reached > 0) {
                    OK(c.session, spar_step_reject(c.session));
                }
                spar_session_destroy(&c.session);
            }
        }
    }
}

/* One rank commits or solves another member than the others, or takes another call. */
static void wrong_members_on_one_rank(void **state) {
    (void)state;
    static const double q[4] = {1, 0, 0, 0}, x[3] = {0, 9, 0}, centre[3] = {0, 0, 0}, J[3] = {1, 1, 1};
    scene c;
    spar_member *more[2];
    double mass[36];
    int expected = size > 1 ? SPAR_ERR_COMM : SPAR_OK;
    create(&c, rank, size, SPAR_COUPLING_EXPLICIT);
    scene_mass(mass, 1, centre, J);
    for (int k = 0; k < 2; k++) {
        OK(c.session, spar_rigid_create(c.session, k ? "two" : "one", x, q, mass, &more[k]));
        OK(c.session, spar_member_set_root(more[k], SPAR_ROOT_FIXED));
    }
    assert_int_equal(spar_member_commit(more[rank == 0]), expected);
    if (size > 1) {
        OK(c.session, spar_member_commit(more[1]));
    }
    OK(c.session, spar_member_commit(more[0]));
    assert_int_equal(spar_member_solve_static(rank == 0 ? more[0] : c.beam, 1), expected);
    int status = rank == 0 ? spar_member_solve_static(c.beam, 1) : spar_step_begin(c.session, 0.1);
    assert_int_equal(status, expected);
    OK(c.session, spar_member_solve_static(c.beam, 1));
    spar_session_destroy(&c.session);
}

static void different_arguments(void **state) {
    (void)state;
    scene c;
    create(&c, rank, size, SPAR_COUPLING_IQN_ILS);
    int expected = size > 1 ? SPAR_ERR_COMM : SPAR_OK;
    int status = spar_step_begin(c.session, rank == 0 ? 0.02 : 0.03);
    assert_int_equal(status, expected);
    if (status == SPAR_OK) {
        OK(c.session, spar_step_reject(c.session));
    }
    /* dt that is no dt on one rank only */
    status = spar_step_begin(c.session, rank == 0 ? NAN : 0.02);
    assert_int_equal(status, rank == 0 ? SPAR_ERR_ARGUMENT : SPAR_ERR_PEER);
    OK(c.session, spar_session_set_relaxation(c.session, rank == 0 ? 0.3 : 0.4));
    status = spar_step_begin(c.session, 0.02);
    assert_int_equal(status, expected);
    if (status == SPAR_OK) {
        OK(c.session, spar_step_reject(c.session));
    }
    OK(c.session, spar_session_set_relaxation(c.session, 0.3));
    /* no place for the answer, on one rank */
    int done;
    OK(c.session, spar_step_begin(c.session, 0.02));
    OK(c.session, spar_step_solve(c.session));
    status = spar_step_check(c.session, rank == 0 ? NULL : &done);
    assert_int_equal(status, rank == 0 ? SPAR_ERR_ARGUMENT : SPAR_ERR_PEER);
    OK(c.session, spar_step_reject(c.session));
    check_goes_on(&c);
    spar_session_destroy(&c.session);
}

/* A member described differently on one rank. */
static void different_members(void **state) {
    (void)state;
    static const double q[4] = {1, 0, 0, 0}, centre[3] = {0, 0, 0}, J[3] = {1, 1, 1};
    spar_session *s = NULL;
    spar_member *m = NULL;
    double x[3] = {rank == 0 ? 1 : 2, 0, 0}, mass[36];
    OK(NULL, spar_session_create_mpi(MPI_COMM_WORLD, &s));
    scene_mass(mass, 1, centre, J);
    OK(s, spar_rigid_create(s, "body", x, q, mass, &m));
    assert_int_equal(spar_member_commit(m), size > 1 ? SPAR_ERR_COMM : SPAR_OK);
    spar_session_destroy(&s);
}

/* ---- save and load ---- */

static char file[32]; /* of this number of ranks: tests may run side by side */

static void same_bits(const scene *a, const scene *b) {
    double x[STATE], y[STATE];
    state_of(a, x);
    state_of(b, y);
    assert_memory_equal(x, y, sizeof x);
}

static void steps(scene *c, int n) {
    for (int i = 0; i < n; i++) {
        OK(c->session, spar_step(c->session, 0.02, solve, c, NULL));
    }
}

/* A run goes on from its file with the same bits on the same ranks; and on one process, which has all the nodes, with
   what it would have had. Written on one process, it goes on on the ranks. */
static void saved_on_some_ranks(void **state) {
    (void)state;
    scene all, again, alone, serial;
    char own[48];
    snprintf(own, sizeof own, "mpi_coupling_%d_%d.spar", size, rank);
    create(&all, rank, size, SPAR_COUPLING_IQN_ILS);
    steps(&all, 5);
    OK(all.session, spar_session_save(all.session, file));
    create(&again, rank, size, SPAR_COUPLING_IQN_ILS);
    OK(again.session, spar_session_load(again.session, file));
    same_bits(&again, &all);
    create(&alone, 0, 1, SPAR_COUPLING_IQN_ILS);
    OK(alone.session, spar_session_load(alone.session, file));
    same_bits(&alone, &all);
    steps(&all, 5);
    steps(&again, 5);
    steps(&alone, 5);
    same_bits(&again, &all);
    compare(&alone, &all);
    /* the other way round: every rank has the same serial run, rank 0's file is read */
    create(&serial, 0, 1, SPAR_COUPLING_IQN_ILS);
    steps(&serial, 5);
    OK(serial.session, spar_session_save(serial.session, own));
    spar_session_destroy(&again.session);
    create(&again, rank, size, SPAR_COUPLING_IQN_ILS);
    OK(again.session, spar_session_load(again.session, own));
    same_bits(&again, &serial);
    steps(&serial, 5);
    steps(&again, 5);
    compare(&again, &serial);
    remove(own);
    spar_session_destroy(&all.session);
    spar_session_destroy(&again.session);
    spar_session_destroy(&alone.session);
    spar_session_destroy(&serial.session);
}

/* What only one rank sees is told to all. */
static void refused_files(void **state) {
    (void)state;
    scene c;
    create(&c, rank, size, SPAR_COUPLING_IQN_ILS);
    int status = spar_session_load(c.session, "no/such/file");
    assert_int_equal(status, rank == 0 ? SPAR_ERR_IO : SPAR_ERR_PEER);
    status = spar_session_save(c.session, "no/such/folder/file");
    assert_int_equal(status, rank == 0 ? SPAR_ERR_IO : SPAR_ERR_PEER);
    status = spar_session_load(c.session, rank == size - 1 ? NULL : file);
    assert_int_equal(status, rank == size - 1 ? SPAR_ERR_ARGUMENT : SPAR_ERR_PEER);
    /* a fluid node that the saved run has not, on one rank */
    spar_fluid_destroy(&c.around);
    double place[3] = {1, 2, 3};
    OK(c.session, spar_fluid_create(c.beam, "around", &c.around));
    OK(c.session, spar_fluid_set_force_nodes(c.around, rank == 0, rank == 0 ? place : NULL));
    OK(c.session, spar_fluid_map(c.around));
    status = spar_session_load(c.session, file);
    assert_int_equal(status, rank == 0 ? SPAR_ERR_ARGUMENT : SPAR_ERR_PEER);
    assert_non_null(strstr(spar_session_message(c.session), "force node 0 is not in the saved run"));
    spar_session_destroy(&c.session);
    MPI_Barrier(MPI_COMM_WORLD);
    if (rank == 0) {
        remove(file);
    }
}

int main(int argc, char **argv) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(same_as_serial),
        cmocka_unit_test(guess_over_ranks),
        cmocka_unit_test(learning_over_ranks),
        cmocka_unit_test(totals_over_ranks),
        cmocka_unit_test(explicit_error_over_ranks),
        cmocka_unit_test(totals_over_ranks),
        cmocka_unit_test(nan_on_one_rank),
        cmocka_unit_test(callback_fails_on_one_rank),
        cmocka_unit_test(wrong_calls_on_one_rank),
        cmocka_unit_test(wrong_members_on_one_rank),
        cmocka_unit_test(different_arguments),
        cmocka_unit_test(different_members),
        cmocka_unit_test(saved_on_some_ranks),
        cmocka_unit_test(refused_files),
    };
    ranks_begin(argc, argv);
    snprintf(file, sizeof file, "mpi_coupling_%d.spar", size);
    return ranks_end(cmocka_run_group_tests(tests, NULL, NULL));
}
