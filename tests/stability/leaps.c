/* Steps that grow, by a tenth or a millionfold: what the new step does not resolve may be damped, but must not be fed.
   Generalised-alpha alone throws velocities of omega^2 dt times the amplitude in such a step (its overshoot), and more
   in every longer one: from 1e-3 s to 1e3 s the energy rose 10^5 to 10^13 times, or Newton failed. */
#include "scene.h"

static const double dt0 = 1e-3;

typedef struct run {
    spar_session *s;
    spar_member *b;
} run;

/* A box beam let go from the shape that a tip load bends it to. */
static run let_go(double rho, int fidelity, int root, int elements) {
    const double load[6] = {0, 0.5, 1, 0.2, 0, 0}, none[6] = {0};
    double K[36], M[36];
    run r = {scene_session(), NULL};
    scene_box(K, M);
    OK(r.s, spar_session_set_integrator(r.s, rho, 1));
    r.b = scene_beam(r.s, "beam", elements, 6, 10, K, M);
    OK(r.s, spar_member_set_fidelity(r.b, fidelity, 8));
    OK(r.s, spar_member_set_root(r.b, root));
    OK(r.s, spar_member_commit(r.b));
    OK(r.s, spar_member_set_load(r.b, 6 * elements - 1, SPAR_LOAD_DEAD, load));
    if (root == SPAR_ROOT_FIXED || root == SPAR_ROOT_DRIVEN) {
        OK(r.s, spar_member_solve_static(r.b, 1));
    } else {
        scene_run(r.s, 0.05, 4); /* nothing holds it: pushed for a while */
    }
    OK(r.s, spar_member_set_load(r.b, 6 * elements - 1, SPAR_LOAD_DEAD, none));
    scene_run(r.s, dt0, 50);
    return r;
}

static double energy_of(const run *r) {
    double e[4];
    OK(r->s, spar_member_get_energy(r->b, 4, e));
    return e[0] + e[1];
}

/* The largest energy, relative to that at the beginning, while dt grows by `factor` from step to step up to `last`. */
static double grow(double rho, int fidelity, int root, int elements, double factor, double last) {
    run r = let_go(rho, fidelity, root, elements);
    double first = energy_of(&r), most = 0;
    for (double dt = dt0 * factor; dt < 1.001 * factor * last; dt *= factor) {
        OK(r.s, spar_step(r.s, fmin(dt, last), NULL, NULL, NULL));
        most = fmax(most, energy_of(&r) / first);
    }
    for (int i = 0; i < 20; i++) { /* and back: what is left in the velocities would show now */
        OK(r.s, spar_step(r.s, dt0, NULL, NULL, NULL));
        most = fmax(most, energy_of(&r) / first);
    }
    spar_session_destroy(&r.s);
    return most;
}

/* Held at the root, with every fidelity that has a shape, one element and two: energy does not rise, beyond the swing
   of 2e-3 that a scheme which keeps another energy than this one has. */
static void test_held(void **state) {
    (void)state;
    static const double rho[] = {0, 0.5, 0.9, 1}, factor[] = {1.1, 2, 10, 1000, 1e6};
    for (int fidelity = SPAR_FIDELITY_LINEAR; fidelity <= SPAR_FIDELITY_EXACT; fidelity++) {
        for (int i = 0; i < 4; i++) {
            for (int k = 0; k < 5; k++) {
                int root = k % 2 ? SPAR_ROOT_DRIVEN : SPAR_ROOT_FIXED;
                NEAR(fmax(1, grow(rho[i], fidelity, root, 1 + k % 2, factor[k], 1e3)), 1, 2e-3);
            }
        }
    }
}

/* Nothing holds it: it flies and turns slowly while it vibrates; the turn is resolved by the longest step. */
static void test_flying(void **state) {
    (void)state;
    static const double rho[] = {0, 0.5, 0.9}, factor[] = {1.1, 2, 10, 100};
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 4; k++) {
            NEAR(fmax(1, grow(rho[i], SPAR_FIDELITY_EXACT, SPAR_ROOT_FREE, 1, factor[k], 0.1)), 1, 2e-3);
        }
    }
}

/* A beam that spins freely, stiff along its axis: a longer step must not take the centripetal accelerations, which are
   those of a rigid body, for what it does not resolve. Radius of the tip about the middle, period 2 pi: the stretch is
   1e-6 and all the rest error. */
static void test_spin_goes_on(void **state) {
    (void)state;
    const double omega[3] = {0, 0, 1}, middle[3] = {5, 0, 0};
    double K[36], M[36], q[7 * 6];
    run r = {scene_session(), NULL};
    scene_box(K, M);
    OK(r.s, spar_session_set_integrator(r.s, 0.5, 1));
    r.b = scene_beam(r.s, "beam", 1, 6, 10, K, M);
    OK(r.s, spar_member_set_root(r.b, SPAR_ROOT_FREE));
    OK(r.s, spar_member_commit(r.b));
    OK(r.s, spar_member_set_initial_velocity(r.b, middle, NULL, omega));
    double before = energy_of(&r);
    scene_run(r.s, 1e-3, 50);
    scene_run(r.s, 2e-2, 50);
    OK(r.s, spar_member_get_motion(r.b, q, NULL, NULL));
    double x = 10 + q[35] - middle[0], y = q[36], t = 50 * (1e-3 + 2e-2);
    NEAR(hypot(x, y), 5, 5e-4);
    NEAR(atan2(y, x), t, 1e-4);
    NEAR(energy_of(&r) / before, 1, 1e-4);
    spar_session_destroy(&r.s);
}

/* A root that turns: seen from it the beam is at rest, before and after dt leaps from 1e-3 s to 0.05 s. */
static void test_turning_root(void **state) {
    (void)state;
    for (int fidelity = SPAR_FIDELITY_LINEAR; fidelity <= SPAR_FIDELITY_EXACT; fidelity++) {
        const double speed = 2, v[3] = {0, 0, 2};
        double K[36], M[36], q[7 * 6], t = 0, radius[2];
        spar_session *s = scene_session();
        scene_box(K, M);
        OK(s, spar_session_set_integrator(s, 0.5, 1));
        spar_member *b = scene_beam(s, "blade", 1, 6, 10, K, M);
        OK(s, spar_member_set_fidelity(b, fidelity, 8));
        OK(s, spar_member_set_root(b, SPAR_ROOT_DRIVEN));
        OK(s, spar_member_commit(b));
        OK(s, spar_member_set_initial_velocity(b, NULL, NULL, v));
        OK(s, spar_member_solve_static(b, 1));
        for (int i = 0; i < 60; i++) {
            double dt = i < 20 ? 1e-3 : 0.05;
            t += dt;
            const double root[7] = {0, 0, 0, cos(0.5 * speed * t), 0, 0, sin(0.5 * speed * t)},
                         rate[6] = {0, 0, 0, 0, 0, speed};
            OK(s, spar_member_drive(b, root, rate, NULL));
            OK(s, spar_step(s, dt, NULL, NULL, NULL));
            OK(s, spar_member_get_motion(b, q, NULL, NULL));
            radius[i >= 20] = hypot(10 + q[35], q[36]);
            NEAR(radius[i >= 20], radius[0], 1e-6);
        }
        spar_session_destroy(&s);
    }
}

/* ---- tied by joints ---- */

/* The same beam of two halves, welded to each other and to the ground. */
typedef struct halves {
    spar_session *s;
    spar_member *half[2];
    spar_joint *foot, *weld;
} halves;

static halves tie_halves(double rho, int elements, int foot) {
    const double eta[2] = {0, 1}, line[2][6] = {{0, 0, 0, 5, 0, 0}, {5, 0, 0, 10, 0, 0}};
    double K[36], M[36];
    halves h = {.s = scene_session()};
    scene_box(K, M);
    OK(h.s, spar_session_set_integrator(h.s, rho, 1));
    for (int i = 0; i < 2; i++) {
        spar_member **b = &h.half[i];
        OK(h.s, spar_beam_create(h.s, i ? "outer" : "inner", elements, 6, b));
        OK(h.s, spar_beam_set_axis(*b, 2, eta, line[i], NULL));
        OK(h.s, spar_beam_set_sections(*b, 1, eta, K, M));
        OK(h.s, spar_member_set_root(*b, SPAR_ROOT_FREE));
        OK(h.s, spar_member_commit(*b));
    }
    if (foot) {
        OK(h.s, spar_joint_create(h.s, "foot", h.half[0], 0, NULL, 0, 0, &h.foot));
    }
    OK(h.s, spar_joint_create(h.s, "weld", h.half[1], 0, h.half[0], 6 * elements - 1, 0, &h.weld));
    return h;
}

static double energy_of_halves(const halves *h) {
    double sum = 0;
    for (int i = 0; i < 2; i++) {
        const run r = {h->s, h->half[i]};
        sum += energy_of(&r);
    }
    return sum;
}

/* As grow(). */
static double grow_tied(double rho, int elements, double factor, double last) {
    const double load[6] = {0, 0.5, 1, 0.2, 0, 0}, none[6] = {0};
    halves h = tie_halves(rho, elements, 1);
    OK(h.s, spar_member_set_load(h.half[1], 6 * elements - 1, SPAR_LOAD_DEAD, load));
    OK(h.s, spar_member_solve_static(h.half[0], 1));
    OK(h.s, spar_member_set_load(h.half[1], 6 * elements - 1, SPAR_LOAD_DEAD, none));
    scene_run(h.s, dt0, 50);
    double first = energy_of_halves(&h), most = 0;
    for (double dt = dt0 * factor; dt < 1.001 * factor * last; dt *= factor) {
        OK(h.s, spar_step(h.s, fmin(dt, last), NULL, NULL, NULL));
        most = fmax(most, energy_of_halves(&h) / first);
    }
    for (int i = 0; i < 20; i++) {
        OK(h.s, spar_step(h.s, dt0, NULL, NULL, NULL));
        most = fmax(most, energy_of_halves(&h) / first);
    }
    spar_session_destroy(&h.s);
    return most;
}

/* Halves in steps of up to 1e3 s, of any factor. */
static void test_tied(void **state) {
    (void)state;
    static const double rho[] = {0, 0.5, 0.9, 1}, factor[] = {1.1, 2, 10, 1000, 1e6};
    for (int i = 0; i < 4; i++) {
        for (int k = 0; k < 5; k++) {
            NEAR(fmax(1, grow_tied(rho[i], 1 + k % 2, factor[k], 1e3)), 1, 2e-3);
        }
    }
}

/* Let go under its weight, steps of 1e-3 s and then of 1 s: what is not resolved dies, by 1/2 a step and some beginning
   swings, and the foot holds the weight m g L and its moment m g L^2 / 2 (less by the tip's droop: 1e-4). */
static void test_tied_loads(void **state) {
    (void)state;
    const double g = 0.05, weight = 8.538e-2 * g * 10;
    halves h = tie_halves(0.5, 1, 1);
    double load[6];
    OK(h.s, spar_session_set_gravity(h.s, (double[]){0, 0, -g}));
    scene_run(h.s, 1e-3, 20);
    scene_run(h.s, 1, 60);
    OK(h.s, spar_joint_get_load(h.foot, load));
    NEAR(load[2], weight, 1e-9 * weight);
    NEAR(load[4], -weight * 5, 1e-4 * weight * 5);
    OK(h.s, spar_joint_get_load(h.weld, load));
    NEAR(load[2], weight / 2, 1e-6 * weight);
    spar_session_destroy(&h.s);
}

/* Two halves that spin about their weld, as test_spin_goes_on: neither the turning of each nor what the weld asks of
   their accelerations is taken for unresolved, in a step of 0.1 s. */
static void test_tied_spin(void **state) {
    (void)state;
    const double omega[3] = {0, 0, 1}, middle[3] = {5, 0, 0};
    double q[7 * 6], load[6];
    halves h = tie_halves(0.5, 1, 0);
    for (int i = 0; i < 2; i++) {
        OK(h.s, spar_member_set_initial_velocity(h.half[i], middle, NULL, omega));
    }
    double before = energy_of_halves(&h);
    scene_run(h.s, 1e-3, 50);
    scene_run(h.s, 0.1, 1);
    NEAR(energy_of_halves(&h) / before, 1, 1e-3);
    scene_run(h.s, 2e-2, 50);
    OK(h.s, spar_member_get_motion(h.half[1], q, NULL, NULL));
    double x = 10 + q[35] - middle[0], y = q[36], t = 50 * (1e-3 + 2e-2) + 0.1;
    NEAR(hypot(x, y), 5, 5e-4);
    NEAR(atan2(y, x), t, 3e-4); /* the speed has changed by half of that step's energy */
    NEAR(energy_of_halves(&h) / before, 1, 1e-3);
    OK(h.s, spar_joint_get_load(h.weld, load));
    NEAR(sqrt(spari_dot(load, load)), 8.538e-2 * 12.5, 1e-3 * 8.538e-2 * 12.5); /* m omega^2 r^2 / 2 */
    spar_session_destroy(&h.s);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_held),         cmocka_unit_test(test_flying),
                                       cmocka_unit_test(test_spin_goes_on), cmocka_unit_test(test_turning_root),
                                       cmocka_unit_test(test_tied),         cmocka_unit_test(test_tied_loads),
                                       cmocka_unit_test(test_tied_spin)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
