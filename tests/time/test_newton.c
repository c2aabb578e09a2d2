/* Where Newton's iteration of a step ends: with the default tolerance, runs are those of strict ones (1e-12) to a small
   part of what dt leaves, in the long run too, and take fewer iterations. The oracle is the strict run, and one with
   half its dt: their distance is the error of dt (3/4 of it). */
#include "scene.h"

#include "time/body_solver.h"
#include "time/fidelity.h"

#include <stdio.h>

/* ---- long runs without a fluid ---- */

enum { P = 5, LOOKS = 200 };

typedef struct flown {
    double energy, momentum, momentum_of_turns; /* the largest distance from those at t = 0, of these */
    double tip[3 * LOOKS], newton;
} flown;

static double from(const double *a, const double *b, int n) {
    double square = 0;
    for (int i = 0; i < n; i++) {
        square += (a[i] - b[i]) * (a[i] - b[i]);
    }
    return sqrt(square);
}

static double farthest(const flown *a, const flown *b) {
    double most = 0;
    for (int i = 0; i < LOOKS; i++) {
        most = fmax(most, from(a->tip + (ptrdiff_t)3 * i, b->tip + (ptrdiff_t)3 * i, 3));
    }
    return most;
}

/* A body of J = (1, 2, 3), tumbling about its middle axis, or the box bent by a force that lets go. */
static flown fly(int beam, double dt, int64_t steps, double rho, int strict) {
    static const double zero[3] = {0, 0, 0}, J[3] = {1, 2, 3}, w[3] = {0.1, 3, 0.2}, none[6] = {0},
                        force[6] = {0, 10, 25};
    double K[36], M[36], e0[4], e[4], L[3], L0[3] = {0}, q[7 * P], v[6 * P], back[3];
    flown f = {0};
    int64_t taken;
    spar_member *m = NULL;
    spar_session *s = NULL;
    OK(NULL, spar_session_create(&s));
    if (strict) {
        scene_strict(s);
    }
    OK(s, spar_session_set_integrator(s, rho, 1));
    if (beam) {
        scene_box(K, M);
        m = scene_beam(s, "box", 1, P, 10, K, M);
        OK(s, spar_member_commit(m));
        OK(s, spar_member_set_load(m, P - 1, SPAR_LOAD_DEAD, force));
        OK(s, spar_member_solve_static(m, 4));
        OK(s, spar_member_set_load(m, P - 1, SPAR_LOAD_DEAD, none));
    } else {
        scene_mass(M, 2, zero, J);
        OK(s, spar_rigid_create(s, "body", zero, NULL, M, &m));
        OK(s, spar_member_commit(m));
        OK(s, spar_member_set_initial_velocity(m, zero, w, w));
    }
    OK(s, spar_member_get_energy(m, 4, e0));
    int n = beam ? P : 1;
    for (int i = 0; i <= LOOKS; i++) {
        if (i > 0) {
            scene_run(s, dt, steps / LOOKS);
        }
        OK(s, spar_member_get_motion(m, q, v, NULL));
        OK(s, spar_member_get_energy(m, 4, e));
        spari_rotate_back(q + 3, v + 3, back);
        for (int k = 0; k < 3; k++) {
            back[k] *= J[k];
        }
        spari_rotate(q + 3, back, L);
        memcpy(i == 0 ? L0 : f.tip + (ptrdiff_t)3 * (i - 1), i == 0 ? L : q + (ptrdiff_t)7 * (n - 1), sizeof L);
        f.energy = fmax(f.energy, fabs(e[0] + e[1] - e0[0] - e0[1]) / (e0[0] + e0[1]));
        f.momentum = beam ? 0 : fmax(f.momentum, from(v, w, 3) / spari_norm(w));
        f.momentum_of_turns = fmax(f.momentum_of_turns, beam ? 0 : from(L, L0, 3) / spari_norm(L0));
    }
    OK(s, spar_member_get_iterations(m, &taken, NULL));
    f.newton = (double)taken / (double)steps;
    spar_session_destroy(&s);
    return f;
}

/* 10^5 steps of a free body, 300 turns: the error of dt in its angular momentum is 1e-3, and that of energy 2e-4; what
   Newton leaves adds a tenth to neither. Linear momentum is kept to rounding: 1e-16 times the root of the steps. */
static void test_body_keeps_what_it_has(void **state) {
    (void)state;
    for (double rho = 0.9; rho < 1.05; rho += 0.1) {
        flown strict = fly(0, 0.02, 100000, rho, 1), plain = fly(0, 0.02, 100000, rho, 0);
        print_message("body: energy %.3e, strict %.3e; turns' momentum %.3e, strict %.3e; iterations %.2f of %.2f\n",
                      plain.energy, strict.energy, plain.momentum_of_turns, strict.momentum_of_turns, plain.newton,
                      strict.newton);
        assert_true(plain.energy <= 1.1 * strict.energy);
        assert_true(plain.momentum_of_turns <= 1.1 * strict.momentum_of_turns);
        NEAR(plain.momentum, 0, 1e-12);
        NEAR(plain.energy, strict.energy, 0.05 * strict.energy);
        assert_true(plain.newton < 0.9 * strict.newton);
    }
}

/* The box swings by a tenth of its length, 20 and 8 periods of its lowest mode: off the strict run by no more than a
   hundredth of what the dt leaves; what the scheme dissipates (rho_inf 0.9) or keeps is the same to 4 per cent. */
static void test_beam_swings_alike(void **state) {
    (void)state;
    const struct { double dt, rho; } run[] = {{5e-3, 1}, {5e-3, 0.9}, {2e-3, 0.9}};
    for (size_t k = 0; k < sizeof run / sizeof *run; k++) {
        double dt = run[k].dt, rho = run[k].rho;
        flown strict = fly(1, dt, 4000, rho, 1), plain = fly(1, dt, 4000, rho, 0), half = fly(1, dt / 2, 8000, rho, 1);
        double off = farthest(&strict, &plain), error = farthest(&strict, &half);
        print_message("box: %.1e of the error; energy %.3e, strict %.3e; iterations %.2f of %.2f\n", off / error,
                      plain.energy, strict.energy, plain.newton, strict.newton);
        assert_true(off <= 0.01 * error);
        NEAR(plain.energy, strict.energy, 0.05 * strict.energy);
        assert_true(plain.newton < 0.85 * strict.newton);
    }
}

/* ---- what has no error ---- */

/* A box that drifts, and turns about its own axis: after 2000 steps no node is off the rigid motion by more than
 * rounding, 1e-12 of the length. */
static void test_rigid_motion_is_no_strain(void **state) {
    (void)state;
    const double x0[3] = {0, 0, 0}, v0[3] = {1, 2, -1}, w[3] = {0.5, 0, 0}, dt = 0.01;
    double K[36], M[36], q[7 * P], turn[4], half = 0.5 * w[0] * 2000 * dt;
    for (int kind = 0; kind < 2; kind++) {
        spar_session *s = NULL;
        OK(NULL, spar_session_create(&s));
        scene_diagonal(K, 1e6, 1e5, 1e5, 1e4, 2e4, 2e4);
        scene_diagonal(M, 1, 1, 1, 0.02, 0.01, 0.01);
        spar_member *b = scene_beam(s, "box", 1, P, 10, K, M);
        OK(s, spar_member_set_root(b, SPAR_ROOT_FREE));
        OK(s, spar_member_commit(b));
        OK(s, spar_member_set_initial_velocity(b, x0, v0, kind ? w : x0));
        scene_run(s, dt, 2000);
        OK(s, spar_member_get_motion(b, q, NULL, NULL));
        for (int i = 0; i < P; i++) {
            const double straight[4] = {kind ? cos(half) : 1, kind ? sin(half) : 0, 0, 0};
            for (int k = 0; k < 3; k++) {
                NEAR(q[7 * i + k], v0[k] * 2000 * dt, 1e-11);
            }
            memcpy(turn, q + (ptrdiff_t)7 * i + 3, sizeof turn);
            NEAR(fabs(spari_quat_dot(turn, straight)), 1, 1e-14);
            NEAR(fmax(fabs(turn[2]), fabs(turn[3])), 0, 1e-12);
        }
        spar_session_destroy(&s);
    }
}

/* ---- what comes at once ---- */

/* A box that hardly moves is hit; a ball drops into a slack line. In the step of it the steps before are no guide.
   Beside the strict run to a hundredth of the error of dt. */
static void hit(double dt, int64_t steps, int strict, double tip[3]) {
    const double little[6] = {0, 0, 1e-3}, much[6] = {0, 40, 60};
    double K[36], M[36], q[7];
    spar_session *s = NULL;
    OK(NULL, spar_session_create(&s));
    if (strict) {
        scene_strict(s);
    }
    scene_box(K, M);
    spar_member *b = scene_beam(s, "box", 1, P, 10, K, M);
    OK(s, spar_member_commit(b));
    OK(s, spar_member_set_load(b, P - 1, SPAR_LOAD_DEAD, little));
    scene_run(s, dt, steps);
    OK(s, spar_member_set_load(b, P - 1, SPAR_LOAD_DEAD, much));
    scene_run(s, dt, steps);
    scene_tip(b, q);
    memcpy(tip, q, 3 * sizeof *tip);
    spar_session_destroy(&s);
}

static void drop(double dt, int64_t steps, int strict, double place[3]) {
    static const double zero[3] = {0, 0, 0}, above[3] = {0.3, 0, 2}, J[3] = {1, 1, 1}, g[3] = {0, 0, -9.81},
                        v0[3] = {0.5, 0.2, 0}, w[3] = {0.3, 0.4, 0}, eye[3] = {0, 0.1, 0.2};
    double M[36], q[7];
    spar_member *ball;
    spar_joint *line;
    spar_session *s = NULL;
    OK(NULL, spar_session_create(&s));
    if (strict) {
        scene_strict(s);
    }
    OK(s, spar_session_set_gravity(s, g));
    scene_mass(M, 10, zero, J);
    OK(s, spar_rigid_create(s, "ball", zero, NULL, M, &ball));
    OK(s, spar_member_commit(ball));
    OK(s, spar_member_set_initial_velocity(ball, zero, v0, w));
    OK(s, spar_link_create(s, "line", ball, 0, eye, NULL, 0, above, &line));
    OK(s, spar_link_set_spring(line, 2e4, 10, 3, 1));
    scene_run(s, dt, steps);
    OK(s, spar_member_get_motion(ball, q, NULL, NULL));
    memcpy(place, q, 3 * sizeof *place);
    spar_session_destroy(&s);
}

static void test_what_comes_at_once(void **state) {
    (void)state;
    double strict[3], plain[3], half[3];
    hit(0.01, 60, 1, strict), hit(0.01, 60, 0, plain), hit(0.005, 120, 1, half);
    print_message("hit: %.1e of the error\n", from(strict, plain, 3) / from(strict, half, 3));
    assert_true(from(strict, plain, 3) <= 0.01 * from(strict, half, 3));
    drop(0.01, 120, 1, strict), drop(0.01, 120, 0, plain), drop(0.005, 240, 1, half);
    print_message("dropped: %.1e of the error\n", from(strict, plain, 3) / from(strict, half, 3));
    assert_true(from(strict, plain, 3) <= 0.01 * from(strict, half, 3));
}

/* ---- corrections that are mixed ---- */

/* A box of 8 nodes whose tip is pushed by 150 N at once, 40 steps in which it bends by a fifth of its length: what a
   step costs in iterations, a tangent counting ten, and the tip. */
static double push(int elements, double atol, double tip[3]) {
    enum { NODES = 8, STEPS = 40 };
    const double force[6] = {0, 0, 150};
    double K[36], M[36], q[7];
    spari_effort effort;
    spar_session *s = scene_session();
    scene_box(K, M);
    OK(s, spar_session_set_integrator(s, 0, 1));
    OK(s, spar_session_set_newton(s, atol, 100 * atol, 30));
    spar_member *b = scene_beam(s, "box", elements, NODES, 10, K, M);
    OK(s, spar_beam_set_quadrature(b, SPAR_QUADRATURE_GAUSS, NODES));
    OK(s, spar_member_commit(b));
    OK(s, spar_member_set_load(b, (int64_t)elements * NODES - 1, SPAR_LOAD_DEAD, force));
    scene_run(s, 0.01, STEPS);
    scene_tip(b, q);
    memcpy(tip, q, 3 * sizeof *tip);
    spari_solver_effort(b->row->solver(b), &effort);
    spar_session_destroy(&s);
    return (double)(effort.iterations + 10 * effort.tangents) / STEPS;
}

/* The tangent that is kept contracts by 0.1 to 0.3, by eigenvalues of either sign. As they come the corrections take
   8.3, 9.9 and 11.4 to 1e-8, 1e-10 and 1e-12; mixed a tenth less, and leave no more than they may. */
static void test_corrections_are_mixed(void **state) {
    (void)state;
    const int elements[] = {1, 3};
    const double most[] = {7.7, 9, 10.4};
    for (int k = 0; k < 2; k++) {
        double exact[3], tip[3], atol = 1e-8;
        (void)push(elements[k], 1e-15, exact);
        for (int i = 0; i < 3; i++, atol /= 100) {
            double cost = push(elements[k], atol, tip);
            print_message("%d elements, %.0e: %.2f, left %.1e\n", elements[k], atol, cost, from(tip, exact, 3));
            assert_true(from(tip, exact, 3) <= 1e4 * atol); /* 40 steps, 100 |x| of it, 10 m, velocities for places */
            assert_true(cost < most[i]);
        }
    }
}

/* ---- the same again ---- */

/* Saved and loaded, the run goes on to the bit: the reused tangent is in the file. */
static void test_saved_and_loaded(void **state) {
    (void)state;
    const char *path = "newton.spar";
    const double force[6] = {0, 10, 25};
    double K[36], M[36], q[2][7 * P], v[2][6 * P];
    int64_t taken[2];
    for (int k = 0; k < 2; k++) {
        spar_session *s = NULL;
        OK(NULL, spar_session_create(&s));
        scene_box(K, M);
        spar_member *b = scene_beam(s, "box", 1, P, 10, K, M);
        OK(s, spar_member_commit(b));
        OK(s, spar_member_set_load(b, P - 1, SPAR_LOAD_DEAD, force));
        if (k == 0) {
            scene_run(s, 0.01, 37);
            OK(s, spar_session_save(s, path));
        } else {
            OK(s, spar_session_load(s, path));
        }
        scene_run(s, 0.01, 50);
        OK(s, spar_member_get_motion(b, q[k], v[k], NULL));
        OK(s, spar_member_get_iterations(b, taken + k, NULL));
        spar_session_destroy(&s);
    }
    assert_memory_equal(q[0], q[1], sizeof q[0]);
    assert_memory_equal(v[0], v[1], sizeof v[0]);
    assert_int_equal(taken[0], taken[1]);
    remove(path);
}

/* What is asked of members that are solved without iteration, and of none. */
static void test_getter(void **state) {
    (void)state;
    const double x[3] = {0, 0, 0};
    int64_t taken = -1;
    double left = -1;
    spar_session *s = scene_session();
    spar_member *p;
    assert_int_equal(spar_member_get_iterations(NULL, &taken, &left), SPAR_ERR_ARGUMENT);
    OK(s, spar_point_create(s, "point", x, NULL, &p));
    OK(s, spar_member_get_iterations(p, NULL, NULL));
    OK(s, spar_member_get_iterations(p, &taken, &left));
    assert_true(taken == 0 && left == 0);
    spar_session_destroy(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_body_keeps_what_it_has),
        cmocka_unit_test(test_beam_swings_alike),
        cmocka_unit_test(test_rigid_motion_is_no_strain),
        cmocka_unit_test(test_what_comes_at_once),
        cmocka_unit_test(test_corrections_are_mixed),
        cmocka_unit_test(test_saved_and_loaded),
        cmocka_unit_test(test_getter),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
