/* What rough use of the library has found, beyond what the other tests ask: each test fails without its mend. */
#include "pistons.h"

#include <float.h>
#include <stdio.h>

static const double rest[4] = {1, 0, 0, 0};

static spar_member *add_piston(spar_session *s, const char *name) {
    const double centre[3] = {0}, inertia[3] = {1, 1, 1};
    double mass[36];
    spar_member *m = NULL;
    scene_mass(mass, 2, centre, inertia);
    OK(s, spar_rigid_create(s, name, NULL, rest, mass, &m));
    OK(s, spar_member_commit(m));
    return m;
}

/* A first step that is rejected, or that fails, leaves the clock at rest: members may still be added. The coupling is
   then made for all of them (it kept the size of the first ones and wrote beyond it). Two bodies under a constant load:
   u = F t^2 / (2 m) in the limit; here the second is only asked to move with its own load. */
static void test_members_after_a_first_step(void **state) {
    (void)state;
    for (int fails = 0; fails <= 1; fails++) {
        const double ratio = 2, load[6] = {0, 4, 0, 0, 0, 0};
        pistons p;
        pistons_create(&p, 1, &ratio);
        p.b[0] = 5;
        spar_session *s = p.session;
        OK(s, spar_session_set_coupling(s, SPAR_COUPLING_IQN_ILS, 0, 1e-10, 50));
        if (fails) {
            p.bad_call = 2;
            assert_int_not_equal(spar_step(s, 0.1, pistons_fluid, &p, NULL), SPAR_OK);
            p.bad_call = 0;
        } else {
            OK(s, spar_step_begin(s, 0.1));
            OK(s, spar_step_reject(s));
        }
        spar_member *late[3];
        for (int i = 0; i < 3; i++) {
            char name[8] = {'l', (char)('0' + i), 0};
            late[i] = add_piston(s, name);
            OK(s, spar_member_set_load(late[i], 0, SPAR_LOAD_DEAD, load));
        }
        for (int i = 0; i < 3; i++) {
            OK(s, spar_step(s, 0.1, pistons_fluid, &p, NULL));
        }
        double a[6];
        OK(s, spar_member_get_motion(p.body[0], NULL, NULL, a));
        NEAR(a[0], 5 / (1 + ratio) / 2, 5e-9);
        for (int i = 0; i < 3; i++) {
            OK(s, spar_member_get_motion(late[i], NULL, NULL, a));
            NEAR(a[1], 2, 1e-12);
        }
        pistons_destroy(&p);
    }
}

/* The host has room for as many residuals as it has asked for iterations, now. */
static void test_room_for_residuals(void **state) {
    (void)state;
    const double r = 0.9;
    double residual[3] = {-1, -1, -1}, size[3] = {-1, -1, -1};
    int iterations;
    pistons p;
    pistons_create(&p, 1, &r);
    p.b[0] = 5;
    OK(p.session, spar_session_set_predictor(p.session, 0));
    OK(p.session, spar_session_set_coupling(p.session, SPAR_COUPLING_FIXED_POINT, 0, 1e-6, 300));
    OK(p.session, spar_step(p.session, 0.1, pistons_fluid, &p, &iterations));
    assert_true(iterations > 50);
    OK(p.session, spar_session_get_iterations(p.session, &iterations, 2, residual, size));
    assert_true(iterations > 50);
    NEAR(residual[1], 5 * 0.9, 1e-12); /* 5 r^k: the first ones */
    assert_true(residual[2] == -1 && size[2] == -1);
    assert_int_equal(spar_session_get_iterations(p.session, &iterations, -1, residual, size), SPAR_ERR_ARGUMENT);
    assert_true(residual[0] > 0 && strstr(spar_session_message(p.session), "capacity of -1"));
    pistons_destroy(&p);
}

static spar_member *light_beam(spar_session *s, int fidelity, int effects, int root) {
    double K[36], M[36];
    scene_box(K, M);
    spar_member *b = scene_beam(s, "beam", 2, 4, 10, K, M);
    OK(s, spar_member_set_fidelity(b, fidelity, 4));
    OK(s, spar_member_set_effects(b, effects));
    OK(s, spar_member_set_root(b, root));
    OK(s, spar_member_commit(b));
    return b;
}

/* Rigid and modal members with no effect that asks for mass: they stand, or follow their root, and a modal one bends as
   a static one does. u = F L^3 / (3 EI) is met by the first modes to a per cent or so; here: that it is there and the
   same in every step, for no inertia keeps anything. */
static void test_no_inertia_no_weight(void **state) {
    (void)state;
    const int none = SPAR_EFFECT_LARGE_ROTATION, roots[] = {SPAR_ROOT_FIXED, SPAR_ROOT_DRIVEN};
    const double load[6] = {0, 0, 3, 0, 0, 0};
    for (int k = 0; k < 4; k++) {
        spar_session *s = scene_session();
        double first[7], tip[7], energy[4];
        int fidelity = k / 2 ? SPAR_FIDELITY_MODAL : SPAR_FIDELITY_RIGID;
        spar_member *b = light_beam(s, fidelity, none, roots[k % 2]);
        OK(s, spar_member_set_load(b, 7, SPAR_LOAD_DEAD, load));
        scene_run(s, 0.1, 1);
        scene_tip(b, first);
        scene_run(s, 0.1, 3);
        scene_tip(b, tip);
        NEAR(tip[2], first[2], 1e-13);
        assert_true(fidelity == SPAR_FIDELITY_RIGID ? tip[2] == 0 : tip[2] > 1e-4);
        OK(s, spar_member_get_energy(b, 4, energy));
        assert_true(energy[0] == 0 && energy[2] == 0);
        spar_session_destroy(&s);
    }
}

static int press(spar_session *s, double t, double dt, int iteration, void *context) {
    const double f[3] = {0, 0, 0.5};
    (void)s, (void)t, (void)dt, (void)iteration;
    return spar_fluid_push_forces(context, f, NULL);
}

/* The same by trials: advice for a beam without inertia tries rigid and modal ones, and a report leaves inertia out. */
static void test_trials_without_inertia(void **state) {
    (void)state;
    const int effects[] = {SPAR_EFFECT_LARGE_ROTATION, SPAR_EFFECT_LARGE_ROTATION | SPAR_EFFECT_INERTIA,
                           SPAR_EFFECT_LARGE_ROTATION | SPAR_EFFECT_GRAVITY};
    for (int k = 0; k < 3; k++) {
        double advice[SPAR_ADVICE_COUNT], table[SPAR_ROW_COUNT][SPAR_COLUMN_COUNT];
        const double tip[3] = {10, 0, 0}, g[3] = {0, 0, -1};
        spar_session *s = scene_session();
        spar_fluid *f = NULL;
        OK(s, spar_session_set_gravity(s, g));
        spar_member *b = light_beam(s, k == 0 ? SPAR_FIDELITY_EXACT : SPAR_FIDELITY_RIGID, effects[k], SPAR_ROOT_FIXED);
        OK(s, spar_fluid_create(b, "tip", &f));
        OK(s, spar_fluid_set_force_nodes(f, 1, tip));
        OK(s, spar_fluid_map(f));
        OK(s, spar_session_report_effects(s, 0.01, 8, NULL, press, f, SPAR_ROW_COUNT, SPAR_COLUMN_COUNT, table[0]));
        if (k == 0) {
            OK(s, spar_session_advise(s, 0.1, 0.01, 8, 8 * 0.01, NULL, press, f, SPAR_ADVICE_COUNT, advice));
        }
        spar_session_destroy(&s);
    }
}

/* A run kept for comparison is one of the members there were. */
static void test_comparison_of_other_members(void **state) {
    (void)state;
    double report[SPAR_TRY_COUNT];
    spar_session *s = scene_session();
    add_piston(s, "one");
    OK(s, spar_session_try(s, 0.1, 8, NULL, NULL, NULL, 0, SPAR_TRY_COUNT, report));
    add_piston(s, "two");
    assert_int_equal(spar_session_try(s, 0.1, 8, NULL, NULL, NULL, 1, SPAR_TRY_COUNT, report), SPAR_ERR_STATE);
    OK(s, spar_session_try(s, 0.1, 8, NULL, NULL, NULL, 0, SPAR_TRY_COUNT, report));
    OK(s, spar_session_try(s, 0.1, 8, NULL, NULL, NULL, 1, SPAR_TRY_COUNT, report));
    spar_session_destroy(&s);
}

/* A push refused before the first step: what then cannot go on says so in its own name, with the reason; the same after
   messages of others; and all is well once the fluid is gone. */
static void test_refused_before_the_first_step(void **state) {
    (void)state;
    const double r = 0, nan3[3] = {0, NAN, 0};
    pistons p;
    pistons_create(&p, 1, &r);
    spar_session *s = p.session;
    spar_fluid *other = NULL;
    OK(s, spar_fluid_create(p.body[0], "other", &other));
    const double x[3] = {0, 0, 0};
    OK(s, spar_fluid_set_force_nodes(other, 1, x));
    OK(s, spar_fluid_map(other));
    assert_int_equal(spar_fluid_push_forces(other, nan3, NULL), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_session_set_predictor(s, 7), SPAR_ERR_ARGUMENT); /* another message stands now */
    static const char *const call[] = {"spar_step_begin", "spar_session_save"};
    for (int k = 0; k < 2; k++) {
        int status = k == 0 ? spar_step_begin(s, 0.1) : spar_session_save(s, "never_written.run");
        const char *text = spar_session_message(s);
        assert_int_equal(status, SPAR_ERR_ARGUMENT);
        assert_true(strncmp(text, call[k], strlen(call[k])) == 0);
        assert_non_null(strstr(text, "'other'"));
        assert_non_null(strstr(text, "component 1"));
    }
    spar_fluid_destroy(&other);
    scene_run(s, 0.1, 2);
    pistons_destroy(&p);
}

/* Messages stand until the next failure: a step that succeeds is none. */
static void test_messages_stand(void **state) {
    (void)state;
    const double r = 0;
    char before[1024];
    pistons p;
    pistons_create(&p, 1, &r);
    assert_int_equal(spar_session_set_predictor(p.session, 7), SPAR_ERR_ARGUMENT);
    snprintf(before, sizeof before, "%s", spar_session_message(p.session));
    OK(p.session, spar_step(p.session, 0.1, pistons_fluid, &p, NULL));
    assert_string_equal(spar_session_message(p.session), before);
    pistons_destroy(&p);
}

/* What was pushed for a static solution, or a first step, that then fails or is given up is in use no longer. The
   pinned body has no static solution: nothing holds its rotation. */
static void test_loads_as_they_were(void **state) {
    (void)state;
    const double f[3] = {0, 0, 1e-3}, wild[3] = {0, 0, 1e4}, tip[3] = {10, 0, 0};
    double K[36], M[36], loads[6 * 4], then[6 * 4];
    scene_box(K, M);
    spar_session *s = scene_session();
    spar_member *b = scene_beam(s, "beam", 1, 4, 10, K, M);
    spar_fluid *fluid = NULL;
    OK(s, spar_member_commit(b));
    OK(s, spar_fluid_create(b, "tip", &fluid));
    OK(s, spar_fluid_set_force_nodes(fluid, 1, tip));
    OK(s, spar_fluid_map(fluid));
    OK(s, spar_fluid_push_forces(fluid, f, NULL));
    OK(s, spar_member_solve_static(b, 1));
    OK(s, spar_member_get_loads(b, loads));
    NEAR(loads[20], 1e-3, 1e-15);
    OK(s, spar_session_set_newton(s, 0, 1e-12, 1)); /* one iteration finds nothing */
    OK(s, spar_fluid_push_forces(fluid, wild, NULL));
    assert_int_equal(spar_step(s, 1, NULL, NULL, NULL), SPAR_ERR_NUMERIC);
    OK(s, spar_member_get_loads(b, then));
    assert_memory_equal(loads, then, sizeof loads);
    OK(s, spar_session_set_newton(s, 0, 1e-12, 50));
    OK(s, spar_step_begin(s, 0.01));
    OK(s, spar_step_reject(s));
    OK(s, spar_member_get_loads(b, then));
    assert_memory_equal(loads, then, sizeof loads);
    const double squeeze[3] = {-1e9, 0, 0}; /* past the column's limit: no equilibrium */
    OK(s, spar_fluid_push_forces(fluid, squeeze, NULL));
    assert_int_equal(spar_member_solve_static(b, 1), SPAR_ERR_NUMERIC);
    OK(s, spar_member_get_loads(b, then));
    assert_memory_equal(loads, then, sizeof loads);
    spar_session_destroy(&s);
}

/* A check that failed is no ground to accept on, whatever made it fail. */
static void test_no_accept_after_a_failed_check(void **state) {
    (void)state;
    const double r = 3, nan3[3] = {NAN, 0, 0}, f[3] = {1, 0, 0};
    int done;
    pistons p;
    pistons_create(&p, 1, &r);
    spar_session *s = p.session;
    OK(s, spar_step_begin(s, 0.1));
    OK(s, spar_step_solve(s));
    assert_int_equal(spar_fluid_push_forces(p.fluid[0], nan3, NULL), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_step_accept(s), SPAR_ERR_ARGUMENT); /* not checked, but refused */
    assert_int_equal(spar_step_check(s, &done), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_step_accept(s), SPAR_ERR_STATE);
    assert_non_null(strstr(spar_session_message(s), "spar_step_accept"));
    OK(s, spar_fluid_push_forces(p.fluid[0], f, NULL));
    assert_int_equal(spar_step_accept(s), SPAR_ERR_STATE); /* the good push is not checked yet */
    OK(s, spar_step_check(s, &done));
    OK(s, spar_step_accept(s));
    OK(s, spar_session_set_coupling(s, SPAR_COUPLING_FIXED_POINT, 0, 1e-12, 1)); /* diverges, and ends at once */
    OK(s, spar_step_begin(s, 0.1));
    OK(s, spar_step_solve(s));
    OK(s, pistons_fluid(s, 0.1, 0.1, 0, &p));
    assert_int_equal(spar_step_check(s, &done), SPAR_ERR_NUMERIC);
    assert_int_equal(spar_step_accept(s), SPAR_ERR_STATE);
    OK(s, spar_step_reject(s));
    pistons_destroy(&p);
}

/* Counts that no memory holds: three times n, or its bytes, would pass 2^63. */
static void test_counts_beyond_memory(void **state) {
    (void)state;
    const double x[6] = {0, 0, 0, 1, 0, 0}, eta[2] = {0, 1};
    double K[36], M[36], out[6];
    static const int64_t huge[] = {INT64_MAX, INT64_MAX / 3 + 1, (INT64_C(1) << 62) / 3 * 2 + 1, INT64_C(1) << 61,
                                   (INT64_C(1) << 40) + 1};
    scene_box(K, M);
    spar_session *s = scene_session();
    spar_member *open = scene_beam(s, "open", 1, 2, 1, K, M), *b = scene_beam(s, "b", 1, 2, 1, K, M);
    spar_fluid *f = NULL;
    OK(s, spar_member_commit(b));
    OK(s, spar_fluid_create(b, "f", &f));
    for (size_t k = 0; k < sizeof huge / sizeof *huge; k++) {
        int64_t n = huge[k];
        assert_int_equal(spar_fluid_set_motion_nodes(f, n, x), SPAR_ERR_ARGUMENT);
        assert_int_equal(spar_fluid_set_force_nodes(f, n, x), SPAR_ERR_ARGUMENT);
        assert_int_equal(spar_fluid_set_sections(f, n, eta, NULL), SPAR_ERR_ARGUMENT);
        assert_int_equal(spar_beam_set_axis(open, n, eta, x, NULL), SPAR_ERR_ARGUMENT);
        assert_int_equal(spar_beam_set_nodes(open, n, x, NULL), SPAR_ERR_ARGUMENT);
        assert_int_equal(spar_beam_set_sections(open, n, eta, K, M), SPAR_ERR_ARGUMENT);
        assert_int_equal(spar_beam_set_line_load(b, SPAR_LOAD_DEAD, n, eta, x), SPAR_ERR_ARGUMENT);
        assert_int_equal(spar_beam_get_section(b, n, eta, out, NULL, NULL, NULL), SPAR_ERR_ARGUMENT);
        assert_int_equal(spar_member_solve_modes(b, n, out, NULL), SPAR_ERR_ARGUMENT);
    }
    spar_session_destroy(&s);
}

/* Numbers near the largest: a status, and the state as it was, for every fidelity and for what a root is driven with.
 */
static void test_loads_beyond_numbers(void **state) {
    (void)state;
    const double huge[6] = {0, 1e200, 0, 0, 0, 1e200}, heavy[3] = {0, 0, -1e200}, none[6] = {0}, no_g[3] = {0};
    for (int fidelity = SPAR_FIDELITY_PRESCRIBED; fidelity <= SPAR_FIDELITY_EXACT; fidelity++) {
        double K[36], M[36], tip[7], after[7];
        scene_box(K, M);
        spar_session *s = scene_session();
        spar_member *b = scene_beam(s, "beam", 1, 4, 10, K, M);
        OK(s, spar_member_set_root(b, SPAR_ROOT_DRIVEN));
        OK(s, spar_member_set_fidelity(b, fidelity, 5));
        OK(s, spar_member_commit(b));
        scene_run(s, 0.1, 2);
        scene_tip(b, tip);
        int elastic = fidelity >= SPAR_FIDELITY_LINEAR;
        for (int k = 0; k < 3; k++) {
            const double q[7] = {0, 0, 0, 1, 0, 0, 0}, fast[6] = {0, 0, 0, 1e200, 0, 1e200};
            OK(s, k == 0   ? spar_member_set_load(b, 3, SPAR_LOAD_DEAD, huge)
                  : k == 1 ? spar_session_set_gravity(s, heavy)
                           : spar_member_drive_root(b, q, fast, NULL));
            int status = spar_step(s, 0.1, NULL, NULL, NULL);
            int bears = fidelity == SPAR_FIDELITY_PRESCRIBED || (fidelity == SPAR_FIDELITY_RIGID && k == 0);
            assert_int_equal(status, k < 2 && bears ? SPAR_OK : SPAR_ERR_NUMERIC);
            if (elastic && k < 2) {
                assert_int_equal(spar_member_solve_static(b, 1), SPAR_ERR_NUMERIC);
                assert_non_null(strstr(spar_session_message(s), "'beam'"));
            }
            scene_tip(b, after);
            assert_memory_equal(tip, after, sizeof tip);
            OK(s, spar_member_set_load(b, 3, SPAR_LOAD_DEAD, none));
            OK(s, spar_session_set_gravity(s, no_g));
            OK(s, spar_member_drive_root(b, q, NULL, NULL));
            scene_run(s, 0.1, 1);
            scene_tip(b, tip);
        }
        spar_session_destroy(&s);
    }
}

static void test_velocities_beyond_numbers(void **state) {
    (void)state;
    const double wild[3] = {0, 0, 1e200};
    double K[36], M[36], v[24];
    scene_box(K, M);
    spar_session *s = scene_session();
    spar_member *b = scene_beam(s, "beam", 1, 4, 10, K, M), *late = scene_beam(s, "late", 1, 4, 10, K, M);
    OK(s, spar_member_commit(b));
    assert_int_equal(spar_member_set_initial_velocity(b, NULL, NULL, wild), SPAR_ERR_ARGUMENT);
    OK(s, spar_member_get_motion(b, NULL, v, NULL));
    for (int i = 0; i < 24; i++) {
        assert_true(v[i] == 0);
    }
    OK(s, spar_member_set_initial_velocity(late, NULL, NULL, wild));
    assert_int_equal(spar_member_commit(late), SPAR_ERR_ARGUMENT);
    spar_session_destroy(&s);
}

/* The eigenvalue solver never ends on matrices that are no numbers: they are refused before. Nor may it on entries
   whose squares are none; those are only another unit of force: frequencies go with the root of the stiffness. */
static void test_modes_beyond_numbers(void **state) {
    (void)state;
    const double eta[2] = {0, 1};
    double K[36], M[36], load[12] = {0}, f[2][4];
    scene_box(K, M);
    load[1] = load[7] = 1e308;
    load[5] = load[11] = 1e308;
    spar_session *s = scene_session();
    spar_member *b = scene_beam(s, "beam", 1, 4, 10, K, M);
    OK(s, spar_member_commit(b));
    OK(s, spar_member_solve_modes(b, 4, f[0], NULL));
    OK(s, spar_beam_set_line_load(b, SPAR_LOAD_FOLLOWER, 2, eta, load));
    assert_int_equal(spar_member_solve_modes(b, 4, f[1], NULL), SPAR_ERR_NUMERIC);
    assert_non_null(strstr(spar_session_message(s), "'beam'"));
    for (int i = 0; i < 36; i++) {
        K[i] *= 1e200;
        M[i] *= 1e190;
    }
    for (int fidelity = SPAR_FIDELITY_LINEAR; fidelity <= SPAR_FIDELITY_EXACT; fidelity++) {
        char name[8] = {'s', (char)('0' + fidelity), 0};
        spar_member *stiff = scene_beam(s, name, 1, 4, 10, K, M);
        OK(s, spar_member_set_fidelity(stiff, fidelity, 5));
        OK(s, spar_member_commit(stiff));
        OK(s, spar_member_solve_modes(stiff, 4, f[1], NULL));
        for (int k = 0; k < 4; k++) {
            NEAR(f[1][k] / f[0][k], 1e5, 1e5 * 1e-9);
        }
    }
    spar_session_destroy(&s);
}

static void test_matrices_have_a_place(void **state) {
    (void)state;
    const double x[3] = {0};
    double matrix[9];
    spar_session *s = scene_session();
    spar_member *m = add_piston(s, "m");
    spar_fluid *f = NULL;
    OK(s, spar_fluid_create(m, "f", &f));
    OK(s, spar_fluid_pull_matrices(f, 1, SPAR_MATRIX_LOCAL_TO_GLOBAL, NULL)); /* no nodes */
    OK(s, spar_fluid_set_motion_nodes(f, 1, x));
    OK(s, spar_fluid_map(f));
    assert_int_equal(spar_fluid_pull_matrices(f, 1, SPAR_MATRIX_LOCAL_TO_GLOBAL, NULL), SPAR_ERR_ARGUMENT);
    OK(s, spar_fluid_pull_matrices(f, 1, SPAR_MATRIX_LOCAL_TO_GLOBAL, matrix));
    NEAR(matrix[0], 1, 1e-15);
    spar_session_destroy(&s);
}

/* The clock stays a number, and so does every dt that a trial is made with. */
static int nothing(spar_session *s, double t, double dt, int iteration, void *context) {
    (void)s, (void)iteration, (void)context;
    assert_true(isfinite(t) && isfinite(dt) && dt > 0);
    return 0;
}

/* A million steps of 0.01 s end at 1e4 s to the last digit of the sum, 2e-13 s off as the double nearest to 0.01 is;
   added one by one they were 1.7e-7 s off. A file in the middle changes nothing. */
static void test_clock_of_many_steps(void **state) {
    (void)state;
    enum { STEPS = 1000000, HALF = STEPS / 2 };
    static const char file[] = "findings_clock.spar";
    const double x[3] = {0}, J[3] = {1, 1, 1}, dt = 0.01;
    double t;
    spar_session *s = scene_session();
    (void)scene_body(s, "b", x, 1, J);
    for (int half = 0; half < 2; half++) {
        scene_run(s, dt, HALF);
        if (half == 0) {
            OK(s, spar_session_save(s, file));
            spar_session_destroy(&s);
            s = scene_session();
            (void)scene_body(s, "b", x, 1, J);
            OK(s, spar_session_load(s, file));
        }
    }
    (void)remove(file);
    OK(s, spar_session_get_time(s, &t, NULL, NULL));
    NEAR(t, 1e4, 2e-12); /* one digit of 1e4 */
    spar_session_destroy(&s);
}

static void test_clock_beyond_numbers(void **state) {
    (void)state;
    double report[SPAR_TRY_COUNT], advice[SPAR_ADVICE_COUNT], t;
    spar_session *s = scene_session();
    OK(s, spar_step(s, 1e308, nothing, NULL, NULL));
    assert_int_equal(spar_step(s, 1e308, nothing, NULL, NULL), SPAR_ERR_ARGUMENT);
    assert_non_null(strstr(spar_session_message(s), "clock"));
    OK(s, spar_session_get_time(s, &t, NULL, NULL));
    assert_true(t == 1e308);
    OK(s, spar_step(s, 1, nothing, NULL, NULL));
    static const double dt[] = {1e308, 1e302, 5e-324};
    for (size_t k = 0; k < sizeof dt / sizeof *dt; k++) {
        assert_int_equal(spar_session_try(s, dt[k], 8, NULL, nothing, NULL, 0, SPAR_TRY_COUNT, report),
                         SPAR_ERR_ARGUMENT);
        assert_int_equal(spar_session_advise(s, 0.1, dt[k], 8, 1, NULL, nothing, NULL, SPAR_ADVICE_COUNT, advice),
                         SPAR_ERR_ARGUMENT);
    }
    spar_session_destroy(&s);
}

static int meddle(spar_session *s, double t, double dt, int iteration, void *context) {
    pistons *p = context;
    assert_int_equal(spar_step_solve(s), SPAR_ERR_STATE);
    assert_int_equal(spar_step_accept(s), SPAR_ERR_STATE);
    assert_non_null(strstr(spar_session_message(s), "spar_step_accept"));
    assert_int_equal(spar_step_reject(s), SPAR_ERR_STATE);
    int done = 0;
    assert_int_equal(spar_step_check(s, &done), SPAR_ERR_STATE);
    return pistons_fluid(s, t, dt, iteration, p);
}

/* The step that spar_step makes is not ended by the fluid solver it calls: such calls are refused, and the step comes
   out as without them: a = b / (1 + r) / m. */
static void test_a_fluid_solver_ends_no_step(void **state) {
    (void)state;
    const double ratio = 0.5;
    pistons p;
    pistons_create(&p, 1, &ratio);
    p.b[0] = 3;
    double a[6];
    OK(p.session, spar_session_set_coupling(p.session, SPAR_COUPLING_IQN_ILS, 0, 1e-12, 50));
    OK(p.session, spar_step(p.session, 0.1, meddle, &p, NULL));
    OK(p.session, spar_member_get_motion(p.body[0], NULL, NULL, a));
    NEAR(a[0], 3 / 1.5 / 2, 1e-12);
    OK(p.session, spar_step_begin(p.session, 0.1)); /* outside they are the host's again */
    OK(p.session, spar_step_solve(p.session));
    OK(p.session, spar_step_reject(p.session));
    pistons_destroy(&p);
}

/* Loads f^0, f^1 on a body of 2 kg a step of `first` apart, then a step of 1 ms: predicted is f^1 + R (f^1 - f^0) with
   R the ratio of the steps, at most 10 (unbounded it was 1e27, and Newton was blamed). */
static void test_extrapolation_has_a_reach(void **state) {
    (void)state;
    const double none = 0, first[] = {1e-30, 1e-6, 5e-4};
    for (int k = 0; k < 3; k++) {
        pistons p;
        double a[6], R = 1e-3 / first[k];
        pistons_create(&p, 1, &none);
        p.b[0] = 1;
        OK(p.session, spar_fluid_push_forces(p.fluid[0], (double[]){1, 0, 0}, NULL));
        p.b[0] = 1.125;
        OK(p.session, spar_step(p.session, first[k], pistons_fluid, &p, NULL));
        OK(p.session, spar_step_begin(p.session, 1e-3));
        OK(p.session, spar_step_solve(p.session));
        OK(p.session, spar_member_get_motion(p.body[0], NULL, NULL, a));
        NEAR(a[0], (1.125 + (R < 10 ? R : 10) * 0.125) / 2, 1e-12);
        pistons_destroy(&p);
    }
}

/* Order 2 through values a step of 1e-12 and one of 0.1 apart is order 1: f^2 + (f^2 - f^1), not 1e11 (f^1 - f^0). */
static void test_no_curve_through_close_values(void **state) {
    (void)state;
    const double none = 0;
    pistons p;
    double a[6];
    pistons_create(&p, 1, &none);
    OK(p.session, spar_session_set_predictor(p.session, 2));
    OK(p.session, spar_fluid_push_forces(p.fluid[0], (double[]){1, 0, 0}, NULL));
    p.b[0] = 1.25;
    OK(p.session, spar_step(p.session, 1e-12, pistons_fluid, &p, NULL));
    p.b[0] = 1.5;
    OK(p.session, spar_step(p.session, 0.1, pistons_fluid, &p, NULL));
    OK(p.session, spar_step_begin(p.session, 0.1));
    OK(p.session, spar_step_solve(p.session));
    OK(p.session, spar_member_get_motion(p.body[0], NULL, NULL, a));
    NEAR(a[0], 1.75 / 2, 1e-12);
    pistons_destroy(&p);
}

static char warned[1024];

static void hear(const spar_session *s, int level, const char *text, void *context) {
    (void)s, (void)context;
    if (level == SPAR_LOG_WARNING) {
        snprintf(warned, sizeof warned, "%s", text);
    }
}

static int roll(int nodes, double turns) {
    double K[36], load[6] = {0, 0, 0, 0, 0, 2 * 3.14159265358979323846 * turns * 100};
    scene_diagonal(K, 1e7, 1e7, 1e7, 100, 100, 100);
    spar_session *s = scene_session();
    spar_member *b = scene_beam(s, "roll", 1, nodes, 1, K, NULL);
    OK(s, spar_session_set_log(s, hear, NULL));
    OK(s, spar_member_commit(b));
    OK(s, spar_member_set_load(b, nodes - 1, SPAR_LOAD_DEAD, load));
    warned[0] = '\0';
    int status = spar_member_solve_static(b, 20), blames = strstr(spar_session_message(s), "more nodes") != NULL;
    spar_session_destroy(&s);
    return status == SPAR_OK ? SPAR_OK : blames ? status : -1;
}

/* Rolled up tighter than its nodes can follow: where Newton fails it is the nodes that are blamed, and where it finds
   an equilibrium that is none of the beam (10 turns on 24 nodes) a log is warned; not for a circle. */
static void test_too_few_nodes_are_blamed(void **state) {
    (void)state;
    assert_int_equal(roll(10, 10), SPAR_ERR_NUMERIC);
    assert_int_equal(roll(24, 10), SPAR_OK);
    assert_non_null(strstr(warned, "'roll'"));
    assert_int_equal(roll(10, 1), SPAR_OK);
    assert_string_equal(warned, "");
}

/* A first step that is rejected leaves the joints as they were (the balance at t^0 had stayed in what a getter says); a
   joint described after it holds. A body of 2 kg under gravity at a rod of 3 m, whose pull is 2 kg * 9.81 m/s^2 once
   the clock runs and nothing before; then a second rod, level, keeps it from a push that way. */
static void test_joints_after_a_rejected_step(void **state) {
    (void)state;
    const double origin[3] = {0}, low[3] = {0, 0, -3}, side[3] = {4, 0, -3}, q[4] = {1, 0, 0, 0}, J[3] = {1, 1, 1};
    double mass[36], z[6], rate[6], load[6], x[7];
    spar_session *s = scene_session();
    spar_member *b = NULL;
    spar_joint *rod = NULL, *level = NULL;
    scene_mass(mass, 2, origin, J);
    OK(s, spar_session_set_gravity(s, (double[]){0, 0, -9.81}));
    OK(s, spar_rigid_create(s, "bob", low, q, mass, &b));
    OK(s, spar_member_commit(b));
    OK(s, spar_line_create(s, "rod", b, 0, low, NULL, 0, origin, &rod));
    for (int round = 0; round < 2; round++) {
        OK(s, spar_step_begin(s, 0.01));
        OK(s, spar_step_solve(s));
        OK(s, spar_joint_get_load(rod, load));
        NEAR(load[0], -2 * 9.81, 1e-9);
        OK(s, spar_step_reject(s));
        OK(s, spar_joint_get_motion(rod, z, rate, NULL));
        OK(s, spar_joint_get_load(rod, load));
        assert_true(z[0] == 3 && rate[0] == 0 && load[0] == 0);
    }
    OK(s, spar_line_create(s, "level", b, 0, low, NULL, 0, side, &level));
    OK(s, spar_member_set_load(b, 0, SPAR_LOAD_DEAD, (double[]){5, 0, 0, 0, 0, 0}));
    OK(s, spar_step(s, 0.01, NULL, NULL, NULL));
    OK(s, spar_joint_get_load(level, load));
    NEAR(load[0], 5, 1e-9);
    OK(s, spar_member_get_motion(b, x, NULL, NULL));
    NEAR(x[0], 0, 1e-12);
    spar_session_destroy(&s);
}

/* All that a session of two masses and three joints shows. */
static void look_at_joints(spar_member *const m[2], spar_joint *const j[3], double seen[64]) {
    double *out = seen;
    memset(seen, 0, 64 * sizeof *seen);
    for (int i = 0; i < 2; i++, out += 6) {
        (void)spar_member_get_reaction(m[i], out);
    }
    for (int i = 0; i < 3; i++, out += 16) {
        (void)spar_joint_get_motion(j[i], out, NULL, NULL);
        (void)spar_joint_get_load(j[i], out + 6);
        (void)spar_joint_get_energy(j[i], SPAR_JOINT_ENERGY_COUNT, out + 12);
    }
}

/* A step that is refused because a joint's nodes are apart leaves all as it was: those before it in the order of
   creation had been placed, and showed what springs hold there. A body of 2 kg on a line of 3 m, 3 N/m and 2 m
   unstretched, which holds 1.5 J; a second one at the ground, and a joint between the two from 1 m away. Once that has
   a frame the step is made; in 1 ms the line is shortened by 3 N / 2 kg * 1e-6 s^2 / 2. */
static void test_joints_apart_change_nothing(void **state) {
    (void)state;
    const double origin[3] = {0}, away[3] = {1, 0, 0}, up[3] = {0, 0, 3}, q[4] = {1, 0, 0, 0}, J[3] = {1, 1, 1};
    double mass[36], stiff[36] = {3}, before[64], after[64];
    spar_session *s = scene_session();
    spar_member *m[2];
    spar_joint *j[3] = {NULL};
    scene_mass(mass, 2, origin, J);
    OK(s, spar_rigid_create(s, "one", origin, q, mass, &m[0]));
    OK(s, spar_rigid_create(s, "two", away, q, mass, &m[1]));
    OK(s, spar_member_set_effects(m[0], SPAR_EFFECT_DEFAULT | SPAR_EFFECT_WORK));
    OK(s, spar_member_commit(m[0]));
    OK(s, spar_member_commit(m[1]));
    OK(s, spar_line_create(s, "line", m[0], 0, origin, NULL, 0, up, &j[0]));
    OK(s, spar_line_set_spring(j[0], 3, 0, 2, 0));
    OK(s, spar_joint_create(s, "foot", m[1], 0, NULL, 0, 0, &j[1]));
    OK(s, spar_joint_create(s, "apart", m[1], 0, m[0], 0, 63, &j[2]));
    OK(s, spar_joint_set_spring(j[2], stiff, NULL, NULL));
    look_at_joints(m, j, before);
    assert_int_equal(spar_step_begin(s, 1e-3), SPAR_ERR_ARGUMENT);
    assert_non_null(strstr(spar_session_message(s), "1 m apart"));
    look_at_joints(m, j, after);
    assert_memory_equal(before, after, sizeof before);
    OK(s, spar_joint_set_frame(j[2], away, q));
    OK(s, spar_step(s, 1e-3, NULL, NULL, NULL));
    OK(s, spar_joint_get_energy(j[0], SPAR_JOINT_ENERGY_COUNT, after));
    NEAR(after[0], 1.5 * (1 - 2 * 0.75e-6), 1e-7);
    spar_session_destroy(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_members_after_a_first_step),
        cmocka_unit_test(test_room_for_residuals),
        cmocka_unit_test(test_no_inertia_no_weight),
        cmocka_unit_test(test_trials_without_inertia),
        cmocka_unit_test(test_comparison_of_other_members),
        cmocka_unit_test(test_refused_before_the_first_step),
        cmocka_unit_test(test_messages_stand),
        cmocka_unit_test(test_loads_as_they_were),
        cmocka_unit_test(test_no_accept_after_a_failed_check),
        cmocka_unit_test(test_counts_beyond_memory),
        cmocka_unit_test(test_loads_beyond_numbers),
        cmocka_unit_test(test_velocities_beyond_numbers),
        cmocka_unit_test(test_modes_beyond_numbers),
        cmocka_unit_test(test_matrices_have_a_place),
        cmocka_unit_test(test_clock_beyond_numbers),
        cmocka_unit_test(test_clock_of_many_steps),
        cmocka_unit_test(test_a_fluid_solver_ends_no_step),
        cmocka_unit_test(test_extrapolation_has_a_reach),
        cmocka_unit_test(test_no_curve_through_close_values),
        cmocka_unit_test(test_too_few_nodes_are_blamed),
        cmocka_unit_test(test_joints_after_a_rejected_step),
        cmocka_unit_test(test_joints_apart_change_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
