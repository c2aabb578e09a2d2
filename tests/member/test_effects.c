/* Effects of members: what is off is not there, and changes the answer by what the theory says. */
#include "scene.h"

static double K[36], M[36];

static spar_member *beam_with(spar_session *s, int effects, int root) {
    spar_member *b = scene_beam(s, "b", 1, 8, 10, K, M);
    if (effects >= 0) {
        OK(s, spar_member_set_effects(b, EFFECTS_ONLY(effects)));
    }
    OK(s, spar_member_set_root(b, root));
    OK(s, spar_member_commit(b));
    return b;
}

/* Without inertia each step is equilibrium: a load that grows linearly gives the static answer at each time, and
 * velocities from its change. */
static void test_without_inertia(void **state) {
    (void)state;
    double load[6] = {0, 0, 75, 0, 0, 0}, q[2][7], e[4];
    for (int k = 0; k < 2; k++) {
        spar_session *s = scene_session();
        spar_member *b = beam_with(s, k ? 0 : -1, SPAR_ROOT_FIXED);
        OK(s, spar_member_set_load(b, 7, SPAR_LOAD_DEAD, load));
        if (k) {
            scene_run(s, 0.5, 1);
            OK(s, spar_member_get_energy(b, 4, e));
            assert_true(e[0] == 0);
        } else {
            OK(s, spar_member_solve_static(b, 1));
        }
        scene_tip(b, q[k]);
        spar_session_destroy(&s);
    }
    for (int i = 0; i < 7; i++) {
        NEAR(q[1][i], q[0][i], 1e-10);
    }
}

/* Without gravity's effect the session's gravity does nothing to the member; with it a free body falls by g t^2 / 2. */
static void test_gravity(void **state) {
    (void)state;
    const double g[3] = {0.5, 0, -9.81};
    for (int k = 0; k < 2; k++) {
        double q[7];
        spar_session *s = scene_session();
        OK(s, spar_session_set_gravity(s, g));
        spar_member *b = beam_with(s, SPAR_EFFECT_INERTIA | (k ? SPAR_EFFECT_GRAVITY : 0), SPAR_ROOT_FREE);
        scene_run(s, 0.01, 100);
        scene_tip(b, q);
        NEAR(q[0], k ? 0.25 : 0, 1e-9);
        NEAR(q[2], k ? -4.905 : 0, 1e-9);
        spar_session_destroy(&s);
    }
}

/* Without gyroscopic terms Euler's equations are J w' = 0: the angular velocity stays, and the spatial momentum of a
   body that is not a sphere is no longer what keeps; with them it is. Checked by the body rates after one turn against
   the exact solution (1, 2, 3 inertia: elliptic functions, tests in test_dynamic.c). */
static void test_gyroscopic(void **state) {
    (void)state;
    const double J[3] = {1, 2, 3}, c[3] = {0, 0, 0}, w[3] = {1, 1, 1};
    double mass[36], v[6], q[7], L[3], momentum[2];
    for (int k = 0; k < 2; k++) {
        spar_session *s = scene_session();
        spar_member *r;
        scene_mass(mass, 1, c, J);
        OK(s, spar_rigid_create(s, "r", c, NULL, mass, &r));
        OK(s, spar_member_set_effects(r, EFFECTS_ONLY(SPAR_EFFECT_INERTIA | (k ? SPAR_EFFECT_GYROSCOPIC : 0))));
        OK(s, spar_member_commit(r));
        OK(s, spar_member_set_initial_velocity(r, c, c, w));
        scene_run(s, 1e-3, 1000);
        OK(s, spar_member_get_motion(r, q, v, NULL));
        spari_rotate_back(q + 3, v + 3, L);
        for (int i = 0; i < 3; i++) {
            L[i] *= J[i];
        }
        spari_rotate(q + 3, L, L);
        for (int i = 0; i < 3 && k == 0; i++) {
            NEAR(v[3 + i], 1, 1e-12);
        }
        momentum[k] = fabs(L[0] - 1) + fabs(L[1] - 2) + fabs(L[2] - 3);
        spar_session_destroy(&s);
    }
    assert_true(momentum[1] < 1e-6);
    assert_true(momentum[0] > 0.1);
}

/* A body spun about its root, its centre of mass at c: the root holds it with -m Omega^2 c, or with nothing. */
static void test_centrifugal(void **state) {
    (void)state;
    const double J[3] = {0.1, 0.2, 0.3}, c[3] = {0.7, 0, 0}, x[3] = {0, 0, 0}, m = 2, omega = 3, dt = 0.01;
    double mass[36], v[6] = {0, 0, 0, 0, 0, omega}, a[6] = {0}, q[7] = {0}, reaction[6];
    scene_mass(mass, m, c, J);
    for (int k = 0; k < 2; k++) {
        spar_session *s = scene_session();
        spar_member *r;
        OK(s, spar_rigid_create(s, "r", x, NULL, mass, &r));
        OK(s, spar_member_set_root(r, SPAR_ROOT_DRIVEN));
        OK(s, spar_member_set_initial_velocity(r, x, x, v + 3));
        OK(s, spar_member_set_effects(r, EFFECTS_ONLY(SPAR_EFFECT_INERTIA | (k ? SPAR_EFFECT_GYROSCOPIC : 0))));
        OK(s, spar_member_commit(r));
        for (int i = 1; i <= 50; i++) {
            q[3] = cos(0.5 * omega * dt * i), q[6] = sin(0.5 * omega * dt * i);
            OK(s, spar_member_drive(r, q, v, a));
            scene_run(s, dt, 1);
            OK(s, spar_member_get_reaction(r, reaction));
            double force = k ? m * omega * omega * c[0] : 0;
            NEAR(reaction[0], -force * cos(omega * dt * i), 1e-12);
            NEAR(reaction[1], -force * sin(omega * dt * i), 1e-12);
            NEAR(reaction[2], 0, 1e-12);
        }
        spar_session_destroy(&s);
    }
}

/* Damping: the logarithmic decrement of the first bending mode is pi mu omega for small mu; none given, none computed.
 */
static void test_damping(void **state) {
    (void)state;
    double C[36], D[36], f[1], shape[48], mu0 = 2e-4, mu[6] = {mu0, mu0, mu0, mu0, mu0, mu0};
    scene_diagonal(C, 1e6, 1e6, 1e6, 2e4, 5e4, 6e4);
    scene_diagonal(D, 2, 2, 2, 0.1, 0.05, 0.05);
    spar_session *s = scene_session();
    spar_member *b = scene_beam(s, "b", 1, 8, 10, C, D);
    OK(s, spar_beam_set_damping(b, mu));
    OK(s, spar_member_set_effects(b, EFFECTS_ONLY(SPAR_EFFECT_INERTIA | SPAR_EFFECT_DAMPING)));
    OK(s, spar_member_commit(b));
    OK(s, spar_member_solve_modes(b, 1, f, shape));
    double load[6] = {0, 0, 1, 0, 0, 0}, none[6] = {0};
    OK(s, spar_member_set_load(b, 7, SPAR_LOAD_DEAD, load));
    OK(s, spar_member_solve_static(b, 1));
    OK(s, spar_member_set_load(b, 7, SPAR_LOAD_DEAD, none));
    OK(s, spar_session_set_integrator(s, 1, 1));
    double e0[4], e1[4], omega = 6.283185307179586 * f[0], period = 1 / f[0], before[4];
    int n = 400;
    OK(s, spar_member_get_energy(b, 4, e0));
    scene_run(s, period / n, 50 * n); /* until the higher modes are gone */
    OK(s, spar_member_get_energy(b, 4, before));
    scene_run(s, period / n, 5 * n);
    OK(s, spar_member_get_energy(b, 4, e1));
    double decrement = 0.5 * log((before[0] + before[1]) / (e1[0] + e1[1])) / 5;
    NEAR(decrement, 3.14159265358979 * mu0 * omega, 1e-3 * decrement);
    NEAR(e0[1] - e1[0] - e1[1], e1[3], 1e-3 * e0[1]); /* what is gone has been dissipated, O(h^2) in the higher modes */
    spar_session_destroy(&s);
}

/* With its damping off the same member, let go, keeps its energy: the trapezoidal rule does, but for what the stiffest
   modes start with. Damped, the first mode alone loses mu omega^2 = 6e-3 of it in this second. */
static void test_damping_off(void **state) {
    (void)state;
    double C[36], D[36], mu[6] = {2e-4, 2e-4, 2e-4, 2e-4, 2e-4, 2e-4}, load[6] = {0, 0, 1, 0, 0, 0}, none[6] = {0},
                         e0[4], e[4];
    scene_diagonal(C, 1e6, 1e6, 1e6, 2e4, 5e4, 6e4);
    scene_diagonal(D, 2, 2, 2, 0.1, 0.05, 0.05);
    spar_session *s = scene_session();
    spar_member *b = scene_beam(s, "b", 1, 8, 10, C, D);
    OK(s, spar_beam_set_damping(b, mu));
    OK(s, spar_member_set_effects(b, EFFECTS_ONLY(SPAR_EFFECT_INERTIA)));
    OK(s, spar_member_commit(b));
    OK(s, spar_member_set_load(b, 7, SPAR_LOAD_DEAD, load));
    OK(s, spar_member_solve_static(b, 1));
    OK(s, spar_member_set_load(b, 7, SPAR_LOAD_DEAD, none));
    OK(s, spar_session_set_integrator(s, 1, 1));
    OK(s, spar_member_get_energy(b, 4, e0));
    scene_run(s, 1e-3, 1000);
    OK(s, spar_member_get_energy(b, 4, e));
    assert_true(e[3] == 0 && e[0] > 0);
    NEAR(e[0] + e[1], e0[1], 1e-5 * e0[1]);
    spar_session_destroy(&s);
}

/* Quasi-static, damped and heavy: strains and their rates bear the weight, nothing of the inertia. A bar that hangs
   ends stretched by u = rho g L^2 / 2 EA; without gravity nothing moves. */
static void test_weight_without_inertia(void **state) {
    (void)state;
    double C[36], D[36], mu[6] = {0.1, 0.1, 0.1, 0.1, 0.1, 0.1}, g[3] = {9.81, 0, 0}, q[7], EA = 1e6, L = 10, m = 2;
    scene_diagonal(C, EA, 1e6, 1e6, 2e4, 5e4, 6e4);
    scene_diagonal(D, m, m, m, 0.1, 0.05, 0.05);
    for (int k = 0; k < 2; k++) {
        spar_session *s = scene_session();
        spar_member *b = scene_beam(s, "b", 1, 4, L, C, D);
        OK(s, spar_session_set_gravity(s, g));
        OK(s, spar_beam_set_damping(b, mu));
        OK(s, spar_member_set_effects(b, EFFECTS_ONLY(SPAR_EFFECT_DAMPING | (k ? SPAR_EFFECT_GRAVITY : 0))));
        OK(s, spar_member_commit(b));
        scene_run(s, 0.1, 300); /* the lag behind the weight decays as (1 + h / mu)^-n */
        scene_tip(b, q);
        NEAR(q[0], k ? m * 9.81 * L * L / (2 * EA) : 0, 1e-12);
        spar_session_destroy(&s);
    }
}

/* A moment of the fluid at the tip bends a cantilever into an arc: the tip turns by M L / EI, exactly; not read,
   nothing moves. */
static void test_fluid_moment(void **state) {
    (void)state;
    double C[36], D[36], EI = 5e4, L = 10, q[7], place[3] = {L, 0, 0}, force[3] = {0, 0, 0}, moment[3] = {0, 3000, 0};
    scene_diagonal(C, 1e6, 4e4, 4e4, 2e4, EI, EI);
    scene_diagonal(D, 1, 1, 1, 0.1, 0.05, 0.05);
    for (int k = 0; k < 2; k++) {
        spar_session *s = scene_session();
        spar_member *b = scene_beam(s, "b", 1, 10, L, C, D);
        spar_fluid *f;
        OK(s, spar_member_set_effects(b, EFFECTS_ONLY(SPAR_EFFECT_INERTIA | (k ? SPAR_EFFECT_FLUID_MOMENT : 0))));
        OK(s, spar_member_commit(b));
        OK(s, spar_fluid_create(b, "tip", &f));
        OK(s, spar_fluid_set_force_nodes(f, 1, place));
        OK(s, spar_fluid_map(f));
        OK(s, spar_fluid_push_forces(f, force, moment));
        OK(s, spar_member_solve_static(b, 4));
        scene_tip(b, q);
        double turn = k ? moment[1] * L / EI : 0, radius = k ? EI / moment[1] : 0;
        NEAR(2 * atan2(q[5], q[3]), turn, 1e-10);
        NEAR(q[2], -radius * (1 - cos(turn)), 1e-7); /* ten nodes follow an arc of 0.6 rad to that */
        spar_session_destroy(&s);
    }
}

/* External members and points: what the host says is what they do; loads come out. */
static void test_external(void **state) {
    (void)state;
    double q[28] = {0}, v[24] = {0}, got[28], load[6] = {1, 2, 3, 4, 5, 6}, out[24];
    spar_session *s = scene_session();
    spar_member *b;
    const double eta[2] = {0, 1}, xyz[6] = {0, 0, 0, 3, 0, 0};
    OK(s, spar_beam_create(s, "theirs", 1, 4, &b));
    OK(s, spar_beam_set_axis(b, 2, eta, xyz, NULL));
    OK(s, spar_member_set_external(b, 1));
    OK(s, spar_member_commit(b)); /* needs no sections */
    OK(s, spar_member_set_load(b, 2, SPAR_LOAD_DEAD, load));
    OK(s, spar_step_begin(s, 0.1));
    OK(s, spar_member_get_loads(b, out));
    assert_memory_equal(out + 12, load, sizeof load);
    for (int i = 0; i < 4; i++) {
        q[7 * i + 3] = 1;
        q[7 * i + 1] = 0.1 * i;
        v[6 * i + 1] = i;
    }
    OK(s, spar_member_set_motion(b, q, v, NULL));
    OK(s, spar_step_solve(s));
    OK(s, spar_member_get_motion(b, got, NULL, NULL));
    assert_memory_equal(got, q, sizeof q);
    OK(s, spar_step_reject(s));
    OK(s, spar_member_get_motion(b, got, NULL, NULL));
    NEAR(got[8], 0, 0);
    assert_int_equal(spar_member_solve_static(b, 1), SPAR_ERR_UNSUPPORTED);
    spar_session_destroy(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_without_inertia),
        cmocka_unit_test(test_gravity),
        cmocka_unit_test(test_gyroscopic),
        cmocka_unit_test(test_centrifugal),
        cmocka_unit_test(test_damping),
        cmocka_unit_test(test_damping_off),
        cmocka_unit_test(test_weight_without_inertia),
        cmocka_unit_test(test_fluid_moment),
        cmocka_unit_test(test_external),
    };
    scene_box(K, M);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
