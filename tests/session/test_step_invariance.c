/* What a step may not depend on, and must not leave behind: steps that are rejected, iterations beyond the end, the
   order of pulls and pushes, the length of the step where nothing moves. Each test states what other codes get wrong.
   Oracles: another run of the same scene, bit for bit; equilibrium; the tolerance that is asked for. */
#include "pistons.h"

enum { LARGE = 480, PUSHED = 3 };

/* A beam on a fixed root, a second one on a hinge with a spring at its tip, a rigid body welded to that one's tip, and
   a fluid with drag and added mass along the second. */
typedef struct world {
    spar_session *s;
    spar_member *member[3];
    spar_joint *joint[2];
    spar_fluid *fluid;
    double time;
    int messages;
    int steady; /* the loads do not depend on the motion */
} world;

static void count_message(const spar_session *s, int level, const char *text, void *context) {
    (void)s, (void)level, (void)text;
    ((world *)context)->messages++;
}

/* arm: of the fluid's nodes from the line, m. */
static void create(world *w, int scheme, double rtol, double arm) {
    double K[36], M[36], D[36];
    const double straight[4] = {1, 0, 0, 0}, at[3] = {4, 0, 0}, tip[3] = {8, 0, 0}, J[3] = {0.2, 0.3, 0.4};
    const double x[3 * PUSHED] = {4.5, arm, 0, 6, arm, arm, 7.9, -arm, 0}, gravity[3] = {0, 0, -9.81};
    *w = (world){.s = scene_session()};
    spar_session *s = w->s;
    OK(s, spar_session_set_newton(s, 1e-15, rtol, 50));
    OK(s, spar_session_set_gravity(s, gravity));
    OK(s, spar_session_set_coupling(s, scheme, 1e-9, 1e-8, 60));
    OK(s, spar_session_set_log(s, count_message, w));
    scene_box(K, M);
    w->member[0] = scene_beam(s, "inner", 1, 6, 4, K, M);
    OK(s, spar_member_commit(w->member[0]));
    w->member[1] = scene_beam(s, "outer", 2, 4, 4, K, M);
    OK(s, spar_member_set_root(w->member[1], SPAR_ROOT_FREE));
    OK(s, spar_member_set_placement(w->member[1], at, straight));
    OK(s, spar_member_commit(w->member[1]));
    w->member[2] = scene_body(s, "head", tip, 0.5, J);
    w->joint[0] = scene_joint_at(s, "hinge", w->member[0], 5, w->member[1], 0, SPAR_FREE_RY, at);
    scene_diagonal(K, 0, 0, 0, 0, 4e3, 0);
    scene_diagonal(D, 0, 0, 0, 0, 10, 0);
    OK(s, spar_joint_set_spring(w->joint[0], K, D, NULL));
    w->joint[1] = scene_joint_at(s, "weld", w->member[1], 7, w->member[2], 0, 0, tip);
    OK(s, spar_fluid_create(w->member[1], "air", &w->fluid));
    OK(s, spar_fluid_set_motion_nodes(w->fluid, PUSHED, x));
    OK(s, spar_fluid_set_force_nodes(w->fluid, PUSHED, x));
    OK(s, spar_fluid_map(w->fluid));
}

static void answer(const world *w, double t, double f[3 * PUSHED]) {
    double v[3 * PUSHED], a[3 * PUSHED];
    OK(w->s, spar_fluid_pull_poses(w->fluid, SPAR_NODES_MOTION, 1, NULL, NULL, v, NULL, a, NULL));
    for (int i = 0; i < 3 * PUSHED; i++) {
        f[i] = 20 * sin(9 * t + i) - (w->steady ? 0 : 0.05 * a[i] + 0.8 * v[i]);
    }
}

/* Solves, pushes and checks once; whether it is done. */
static int iterate(const world *w, double t) {
    double f[3 * PUSHED];
    int done = 0;
    OK(w->s, spar_step_solve(w->s));
    answer(w, t, f);
    OK(w->s, spar_fluid_push_forces(w->fluid, f, NULL));
    OK(w->s, spar_step_check(w->s, &done));
    return done;
}

static double length_of(int step) {
    static const double dt[] = {0.004, 0.004, 0.004, 0.011, 0.004, 0.004, 0.0007, 0.004, 0.02, 0.02, 0.02, 0.02};
    return dt[step % 12];
}

/* All motion, rates, loads of joints, reaction, loads and clock; how many numbers. */
static int look(const world *w, double x[LARGE]) {
    int at = 0;
    int64_t step;
    memset(x, 0, LARGE * sizeof *x);
    for (int i = 0; i < 3; i++) {
        int64_t n;
        OK(w->s, spar_member_get_count(w->member[i], &n));
        assert_true(at + 25 * n < LARGE - 40);
        OK(w->s, spar_member_get_motion(w->member[i], x + at, x + at + 7 * n, x + at + 13 * n));
        OK(w->s, spar_member_get_loads(w->member[i], x + at + 19 * n));
        at += (int)(25 * n);
    }
    for (int k = 0; k < 2; k++, at += 12) {
        OK(w->s, spar_joint_get_motion(w->joint[k], x + at, NULL, NULL));
        OK(w->s, spar_joint_get_load(w->joint[k], x + at + 6));
    }
    OK(w->s, spar_member_get_reaction(w->member[0], x + at));
    OK(w->s, spar_session_get_time(w->s, x + at + 6, &step, NULL));
    x[at + 7] = (double)step;
    return at + 8;
}

static void assert_same(const double *a, const double *b, int n, const char *what, int step) {
    for (int i = 0; i < n; i++) {
        if (memcmp(a + i, b + i, sizeof *a) != 0) {
            fail_msg("%s, step %d: number %d is %.17g, not %.17g", what, step, i, a[i], b[i]);
        }
    }
}

/* ---- rejected steps ---- */

enum { STEPS = 14 };

static void run_rejecting(int scheme, double rtol, int times, double row[STEPS][LARGE]) {
    world w;
    create(&w, scheme, rtol, 0.1);
    for (int k = 0; k < STEPS; k++) {
        double dt = length_of(k);
        for (int again = 0; again < times; again++) {
            static const double factor[] = {0.5, 3, 1, 0.02, 1.5, 10, 0.9};
            double other = dt * factor[(again + k) % 7];
            OK(w.s, spar_step_begin(w.s, other));
            for (int it = 0; it < 1 + (again + k) % 3; it++) {
                (void)iterate(&w, w.time + other);
            }
            OK(w.s, spar_step_reject(w.s));
        }
        OK(w.s, spar_step_begin(w.s, dt));
        for (int it = 0, done = 0; !done; it++) {
            assert_true(it < 60);
            done = iterate(&w, w.time + dt);
        }
        OK(w.s, spar_step_accept(w.s));
        w.time += dt;
        (void)look(&w, row[k]);
    }
    spar_session_destroy(&w.s);
}

/* Codes that keep a predictor, a Jacobian, a learned relaxation or difference columns of the step that was given up go
   on with other numbers. Steps of other dt, solved one to three times and rejected, 1, 2 and 7 times before each of 14
   uneven steps, with Aitken's rule and quasi-Newton, and with both of Newton's stopping rules. Expected: the bits of
   the run without. */
static void rejected_steps_leave_no_bit(void **state) {
    (void)state;
    static double plain[STEPS][LARGE], other[STEPS][LARGE];
    static const int schemes[] = {SPAR_COUPLING_AITKEN, SPAR_COUPLING_IQN_ILS}, times[] = {1, 2, 7};
    static const double rtols[] = {1e-12, 1e-8};
    for (int k = 0; k < 4; k++) {
        run_rejecting(schemes[k / 2], rtols[k % 2], 0, plain);
        for (int t = 0; t < 3; t++) {
            run_rejecting(schemes[k / 2], rtols[k % 2], times[t], other);
            for (int i = 0; i < STEPS; i++) {
                assert_same(other[i], plain[i], LARGE, k % 2 ? "1e-8" : "1e-12", i);
            }
        }
    }
}

/* The same of a step that ended as not converged (option coupling.unconverged): it is no such step any more, and the
   next one is the first in a row. Three iterations at most, two unconverged steps in a row allowed. */
static void rejected_unconverged_steps_do_not_count(void **state) {
    (void)state;
    world w;
    create(&w, SPAR_COUPLING_FIXED_POINT, 1e-12, 0.1);
    OK(w.s, spar_session_set_coupling(w.s, SPAR_COUPLING_FIXED_POINT, 1e-9, 1e-8, 2));
    OK(w.s, spar_session_set_option(w.s, "coupling.unconverged", "accept"));
    OK(w.s, spar_session_set_option(w.s, "coupling.patience", "2"));
    OK(w.s, spar_step_begin(w.s, 0.01));
    while (!iterate(&w, 0.01)) {
    }
    OK(w.s, spar_step_reject(w.s));
    OK(w.s, spar_step_begin(w.s, 0.01)); /* one that is never checked has nothing that did not converge */
    OK(w.s, spar_step_solve(w.s));
    OK(w.s, spar_step_accept(w.s));
    OK(w.s, spar_step_begin(w.s, 0.01));
    while (!iterate(&w, 0.02)) {
    }
    OK(w.s, spar_step_accept(w.s));
    spar_session_destroy(&w.s);
}

/* ---- iterations ---- */

/* A clock that ticks, a history that shifts or a file that grows with every iteration is a common fault of couplings.
   Loads that depend on time alone; each step is iterated 1, 2 and 6 times in all. Expected: within a step the clock and
   the log stand; after it the clock, the step and the messages are those of one iteration, to the bit; motion and loads
   to 1e-11 of the largest, what Newton (strict) leaves of accelerations. */
static void iterations_change_nothing_but_the_iterate(void **state) {
    (void)state;
    static double row[3][STEPS][LARGE];
    static const int times[] = {1, 2, 6};
    int messages[3] = {0}, n = 0;
    for (int r = 0; r < 3; r++) {
        world w;
        create(&w, SPAR_COUPLING_EXPLICIT, 1e-12, 0.1);
        w.steady = 1;
        OK(w.s, spar_session_set_coupling(w.s, SPAR_COUPLING_IQN_ILS, 1e-9, 1e-8, 60));
        for (int k = 0; k < STEPS; k++) {
            double dt = length_of(k), before, now;
            int64_t steps, step;
            OK(w.s, spar_session_get_time(w.s, &before, &steps, NULL));
            OK(w.s, spar_step_begin(w.s, dt));
            while (!iterate(&w, w.time + dt)) {
            }
            for (int it = 1; it < times[r]; it++) {
                assert_true(iterate(&w, w.time + dt));
                OK(w.s, spar_session_get_time(w.s, &now, &step, NULL));
                assert_true(now == before && step == steps);
            }
            OK(w.s, spar_step_accept(w.s));
            w.time += dt;
            n = look(&w, row[r][k]);
        }
        messages[r] = w.messages;
        spar_session_destroy(&w.s);
    }
    for (int r = 1; r < 3; r++) {
        assert_int_equal(messages[r], messages[0]);
        for (int k = 0; k < STEPS; k++) {
            double size = 0;
            for (int i = 0; i < n; i++) {
                size = fmax(size, fabs(row[0][k][i]));
            }
            for (int i = 0; i < n; i++) {
                NEAR(row[r][k][i], row[0][k][i], 1e-11 * size);
            }
            assert_same(row[r][k] + n - 2, row[0][k] + n - 2, 2, "clock", k);
        }
    }
}

/* Pulls that shift a history, pushes that add instead of replace. Loads that depend on time alone. One run pulls once
   and pushes once in each iteration; the other pulls 0 to 3 times at random times of the step, pushes wrong loads and
   then the right ones, twice, or, after the first iteration, nothing: the loads are those pushed last. The fluid's
   nodes lie on the line: loads are mapped when they are pushed, with the lever arms of that motion. Expected: the same
   bits. */
static void pulls_and_pushes_may_repeat(void **state) {
    (void)state;
    static double row[2][STEPS][LARGE];
    unsigned random = 12345;
    for (int r = 0; r < 2; r++) {
        world w;
        create(&w, SPAR_COUPLING_IQN_ILS, 1e-8, 0);
        for (int k = 0; k < STEPS; k++) {
            double dt = length_of(k), f[3 * PUSHED], wrong[3 * PUSHED], x[3 * PUSHED];
            OK(w.s, spar_step_begin(w.s, dt));
            for (int it = 0, done = 0; !done; it++) {
                OK(w.s, spar_step_solve(w.s));
                for (int i = 0; i < 3 * PUSHED; i++) {
                    f[i] = 20 * sin(9 * (w.time + dt) + i);
                    wrong[i] = 1e3 * i;
                }
                random = random * 1664525u + 1013904223u;
                int draw = (int)(random >> 24);
                for (int pull = 0; r && pull < draw % 4; pull++) {
                    OK(w.s, spar_fluid_pull_motion(w.fluid, 0.25 * pull, x, x));
                }
                if (r && draw & 64) {
                    OK(w.s, spar_fluid_push_forces(w.fluid, wrong, NULL));
                    OK(w.s, spar_fluid_push_forces(w.fluid, f, NULL));
                }
                if (!r || it == 0 || draw & 128) {
                    OK(w.s, spar_fluid_push_forces(w.fluid, f, NULL));
                }
                OK(w.s, spar_step_check(w.s, &done));
            }
            OK(w.s, spar_step_accept(w.s));
            w.time += dt;
            (void)look(&w, row[r][k]);
        }
        spar_session_destroy(&w.s);
    }
    for (int k = 0; k < STEPS; k++) {
        assert_same(row[1][k], row[0][k], LARGE, "pulls and pushes", k);
    }
}

/* ---- the length of steps ---- */

/* Schemes whose residual is divided by dt lose the loads of what stands where dt is short, others drift where it is
   long. A beam in equilibrium under weight and a tip load, with a joint and a rigid body at its tip, three steps of
   each dt from 1e-5 to 1 s. Expected: the reaction and the joint's load of the static solution, to 1e-10 of the
   largest. */
static void what_stands_keeps_its_loads(void **state) {
    (void)state;
    double K[36], M[36], load[6] = {0, 15, 60, 0, 0, 0}, was[12], is[12];
    const double gravity[3] = {0, 0, -9.81}, tip[3] = {10, 0, 0}, J[3] = {0.2, 0.3, 0.4};
    spar_session *s = scene_session();
    OK(s, spar_session_set_gravity(s, gravity));
    scene_box(K, M);
    spar_member *b = scene_beam(s, "box", 1, 8, 10, K, M);
    OK(s, spar_member_commit(b));
    spar_member *head = scene_body(s, "head", tip, 2, J);
    spar_joint *weld = scene_joint_at(s, "weld", b, 7, head, 0, 0, tip);
    OK(s, spar_member_set_load(b, 7, SPAR_LOAD_DEAD, load));
    OK(s, spar_member_solve_static(b, 4));
    OK(s, spar_member_get_reaction(b, was));
    OK(s, spar_joint_get_load(weld, was + 6));
    for (int k = 0; k <= 15; k++) {
        double size[2] = {0, 0};
        scene_run(s, pow(10, -5 + k / 3.0), 3);
        OK(s, spar_member_get_reaction(b, is));
        OK(s, spar_joint_get_load(weld, is + 6));
        for (int i = 0; i < 12; i++) {
            size[i / 6] = fmax(size[i / 6], fabs(was[i]));
        }
        for (int i = 0; i < 12; i++) {
            NEAR(is[i], was[i], 1e-10 * size[i / 6]);
        }
    }
    spar_session_destroy(&s);
}

static int wind_and_waves(spar_session *s, double t, double dt, int iteration, void *context) {
    const world *w = context;
    double v[3 * PUSHED], a[3 * PUSHED], f[3 * PUSHED];
    (void)s, (void)dt, (void)iteration;
    OK(w->s, spar_fluid_pull_poses(w->fluid, SPAR_NODES_MOTION, 1, NULL, NULL, v, NULL, a, NULL));
    for (int i = 0; i < 3 * PUSHED; i++) {
        double wind = i % 3 == 1 ? 8 : 0, water = i % 3 == 2 ? 3 * sin(2 * t) : 0,
               lost = i % 3 == 2 ? 6 * cos(2 * t) : 0;
        f[i] = 2 * (wind + water - v[i]) * fabs(wind + water - v[i]) + 0.1 * (lost - a[i]);
    }
    return spar_fluid_push_forces(w->fluid, f, NULL);
}

/* Codes that begin with accelerations of zero, or loads of zero, have a first step that is not of the scene. The beams
   in balance with the wind, waves from t = 0 on, drag and added mass; one step of 2 ms and 100 of 0.02 ms. Expected:
   the reaction and the hinge's load at 2 ms of both within 1 % of the largest force, and moment. */
static void the_first_step_has_the_loads_of_the_scene(void **state) {
    (void)state;
    double row[2][12];
    for (int r = 0; r < 2; r++) {
        world w;
        create(&w, SPAR_COUPLING_IQN_ILS, 1e-12, 0.1);
        OK(w.s, spar_session_solve_static(w.s, 4, wind_and_waves, &w, NULL));
        for (int k = 0; k < (r ? 100 : 1); k++) {
            OK(w.s, spar_step(w.s, r ? 2e-5 : 2e-3, wind_and_waves, &w, NULL));
        }
        OK(w.s, spar_member_get_reaction(w.member[0], row[r]));
        OK(w.s, spar_joint_get_load(w.joint[0], row[r] + 6));
        spar_session_destroy(&w.s);
    }
    for (int i = 0; i < 12; i += 3) {
        double size = spari_norm(row[1] + i);
        for (int k = i; k < i + 3; k++) {
            NEAR(row[0][k], row[1][k], 0.01 * size);
        }
    }
}

/* ---- what SPAR_OK says ---- */

/* Couplings that end after their last iteration whatever is left. Pistons with random added masses, 40 scenes, 8
   iterations at most, relaxed, by Aitken's rule and by quasi-Newton with one column: some converge, some cannot.
   Expected: a step that is done has its residual within atol + rtol times the loads; the other answers
   SPAR_ERR_NUMERIC. At least five of each. */
static void no_step_is_done_above_its_tolerance(void **state) {
    (void)state;
    unsigned random = 7;
    int good = 0, bad = 0;
    for (int scene = 0; scene < 40; scene++) {
        double ratio[3], residual, size;
        pistons p;
        for (int i = 0; i < 3; i++) {
            random = random * 1664525u + 1013904223u;
            ratio[i] = 3.0 * (random >> 8) / (1 << 24);
        }
        pistons_create(&p, 3, ratio);
        p.b[0] = 3, p.b[1] = -2, p.b[2] = 5;
        OK(p.session, spar_session_set_coupling(p.session, 1 + scene % 3, 1e-9, 1e-7, 8));
        int status = SPAR_OK;
        for (int k = 0; k < 5 && status == SPAR_OK; k++) {
            status = spar_step(p.session, 0.01, pistons_fluid, &p, NULL);
            OK(p.session, spar_session_get_residual(p.session, &residual, &size));
            assert_true(status == SPAR_OK || status == SPAR_ERR_NUMERIC);
            if (status == SPAR_OK) {
                assert_true(residual <= 1e-9 + 1e-7 * size);
            }
        }
        good += status == SPAR_OK, bad += status != SPAR_OK;
        spar_session_destroy(&p.session);
    }
    assert_true(good >= 5 && bad >= 5);
}

/* Where the fluid's answer has an eigenvalue just below or above 1, I - J is nearly singular, and quasi-Newton that
   filters or limits its columns stands still. Three pistons with g = b - r x, r = -0.999, -1.001 and 0.5. Expected: the
   solution b / (1 + r) of every step to 1e-6 of it, by at most 12 iterations (a fixed point takes 1e4, or diverges). */
static void an_eigenvalue_near_one_is_no_obstacle(void **state) {
    (void)state;
    const double ratio[3] = {-0.999, -1.001, 0.5};
    pistons p;
    pistons_create(&p, 3, ratio);
    p.b[0] = 3, p.b[1] = -2, p.b[2] = 5;
    OK(p.session, spar_session_set_coupling(p.session, SPAR_COUPLING_IQN_ILS, 1e-12, 1e-10, 12));
    for (int k = 0; k < 6; k++) {
        int iterations = 0;
        OK(p.session, spar_step(p.session, 0.01, pistons_fluid, &p, &iterations));
        assert_true(iterations <= 12);
        for (int i = 0; i < 3; i++) {
            double a[6], expected = p.b[i] / (1 + ratio[i]);
            OK(p.session, spar_member_get_motion(p.body[i], NULL, NULL, a));
            NEAR(p.mass[i] * a[0], expected, 1e-6 * fabs(expected));
        }
    }
    spar_session_destroy(&p.session);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rejected_steps_leave_no_bit),
        cmocka_unit_test(rejected_unconverged_steps_do_not_count),
        cmocka_unit_test(iterations_change_nothing_but_the_iterate),
        cmocka_unit_test(pulls_and_pushes_may_repeat),
        cmocka_unit_test(what_stands_keeps_its_loads),
        cmocka_unit_test(the_first_step_has_the_loads_of_the_scene),
        cmocka_unit_test(no_step_is_done_above_its_tolerance),
        cmocka_unit_test(an_eigenvalue_near_one_is_no_obstacle),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
