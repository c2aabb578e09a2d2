/* Damping ratios of two modes turned into stiffness-proportional damping. */
#include "scene.h"

#include "member/body.h"
#include "member/structure.h"

static const double two_pi = 6.283185307179586;

/* Two planes that do not couple: the ratio of a mode is mu omega / 2, so mu = 2 zeta / omega for each plane, the
   geometric mean for torsion and stretch; 1e-9. */
static void test_uncoupled(void **state) {
    (void)state;
    const int64_t mode[2] = {0, 1};
    const double ratio[2] = {0.005, 0.02};
    double K[36], M[36], f[2], mu[6] = {1, 1, 1, 1, 1, 1};
    scene_diagonal(K, 1e6, 1e6, 1e6, 50, 10, 40);
    scene_diagonal(M, 2, 2, 2, 1e-3, 1e-3, 1e-3);
    for (int chosen = 0; chosen < 2; chosen++) {
        spar_session *s = scene_session();
        spar_member *b = scene_beam(s, "b", 1, 8, 3, K, M);
        if (chosen) { /* some damping first, and other effects off */
            OK(s, spar_member_set_effects(b, EFFECTS_ONLY(SPAR_EFFECT_INERTIA | SPAR_EFFECT_DAMPING)));
            OK(s, spar_beam_set_damping(b, mu));
        }
        OK(s, spar_member_commit(b));
        OK(s, spar_member_solve_modes(b, 2, f, NULL));
        OK(s, spar_beam_set_modal_damping(b, mode, ratio, mu));
        NEAR(mu[4], 2 * ratio[0] / (two_pi * f[0]), 1e-8 * mu[4]);
        NEAR(mu[5], 2 * ratio[1] / (two_pi * f[1]), 1e-8 * mu[5]);
        NEAR(mu[2], mu[4], 0);
        NEAR(mu[1], mu[5], 0);
        NEAR(mu[3], sqrt(mu[4] * mu[5]), 1e-12 * mu[3]);
        assert_non_null(b->body->D);
        spar_session_destroy(&s);
    }
}

/* A twisted, coupled blade, time against the wish: let go from the shape of a mode, the energy falls by exp(-2 zeta
   omega T) over a time T; three periods with a fine step, 3 per cent of the exponent (modes' shapes interact at the
   order of the amplitude, other modes at that of the coupling by damping). */
static void test_decay(void **state) {
    (void)state;
    enum { P = 8 };
    const int64_t mode[2] = {0, 1};
    const double ratio[2] = {0.01, 0.03}, eta[2] = {0, 1}, xyz[6] = {0, 0, 0, 10, 0, 0}, twist[2] = {0.3, 0};
    for (int k = 0; k < 2; k++) {
        double K[36], M[36], f[2], shapes[2 * 6 * P], mu[6], e[4], begin;
        spar_session *s = scene_session();
        spar_member *b = NULL;
        scene_box(K, M);
        OK(s, spar_beam_create(s, "b", 1, P, &b));
        OK(s, spar_beam_set_axis(b, 2, eta, xyz, twist));
        OK(s, spar_beam_set_sections(b, 1, eta, K, M));
        OK(s, spar_session_set_integrator(s, 1, 1));
        OK(s, spar_session_set_newton(s, 1e-11, 1e-11, 20));
        OK(s, spar_member_commit(b));
        OK(s, spar_member_solve_modes(b, 2, f, shapes));
        OK(s, spar_beam_set_modal_damping(b, mode, ratio, mu));
        /* a load that holds the beam in the shape: the tangent times it, by the residual there */
        double q[7 * P], r[6 * P], scale = 1e-4;
        for (int i = 0; i < P; i++) {
            const double *x = shapes + (ptrdiff_t)6 * (P * k + i);
            double psi[3];
            for (int c = 0; c < 3; c++) {
                q[7 * i + c] = scale * x[c];
                psi[c] = scale * x[3 + c];
            }
            spari_quat_exp(psi, q + (ptrdiff_t)7 * i + 3);
        }
        spari_body_residual(b->body, q, NULL, NULL, 1, r, NULL);
        for (int i = 0; i < P; i++) {
            OK(s, spar_member_set_load(b, i, SPAR_LOAD_DEAD, r + (ptrdiff_t)6 * i));
        }
        OK(s, spar_member_solve_static(b, 1));
        for (int i = 0; i < P; i++) {
            OK(s, spar_member_set_load(b, i, SPAR_LOAD_DEAD, (double[6]){0}));
        }
        OK(s, spar_member_get_energy(b, 4, e));
        begin = e[1];
        double T = 3 / f[k];
        scene_run(s, T / 600, 600);
        OK(s, spar_member_get_energy(b, 4, e));
        NEAR(log(begin / (e[0] + e[1])) / (2 * two_pi * f[k] * T), ratio[k], 0.03 * ratio[k]);
        NEAR((e[0] + e[1] + e[3]) / begin, 1, 1e-3);
        spar_session_destroy(&s);
    }
}

static void test_refusals(void **state) {
    (void)state;
    const int64_t same[2] = {0, 2}, none[2] = {0, 1000}, good[2] = {0, 1};
    const double ratio[2] = {0.01, 0.01}, bad[2] = {0.01, 0};
    double K[36], M[36];
    scene_diagonal(K, 1e6, 1e6, 1e6, 5000, 10, 40);
    scene_diagonal(M, 2, 2, 2, 1e-3, 1e-3, 1e-3);
    spar_session *s = scene_session();
    spar_member *b = scene_beam(s, "b", 1, 8, 3, K, M);
    assert_int_equal(spar_beam_set_modal_damping(b, good, ratio, NULL), SPAR_ERR_STATE);
    OK(s, spar_member_commit(b));
    assert_int_equal(spar_beam_set_modal_damping(b, same, ratio, NULL), SPAR_ERR_ARGUMENT);
    assert_non_null(strstr(spar_session_message(s), "bending about y"));
    assert_int_equal(spar_beam_set_modal_damping(b, none, ratio, NULL), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_beam_set_modal_damping(b, good, bad, NULL), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_beam_set_modal_damping(b, good, NULL, NULL), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_beam_set_modal_damping(NULL, good, ratio, NULL), SPAR_ERR_ARGUMENT);
    assert_null(b->body->D);
    scene_run(s, 0.01, 1);
    assert_int_equal(spar_beam_set_modal_damping(b, good, ratio, NULL), SPAR_ERR_STATE);
    spar_session_destroy(&s);
}

/* A mode without strain, whose frequency is rounding, would give a damping that no step can be solved with. */
static void test_rigid_modes(void **state) {
    (void)state;
    const double ratio[2] = {0.01, 0.01};
    double K[36], M[36];
    scene_diagonal(K, 1e6, 1e6, 1e6, 5000, 10, 40);
    scene_diagonal(M, 2, 2, 2, 1e-3, 1e-3, 1e-3);
    for (int free = 0; free < 2; free++) {
        int64_t rigid[2] = {free ? 5 : 2, free ? 8 : 5}, good[2] = {free ? 6 : 3, free ? 7 : 4};
        spar_session *s = scene_session();
        spar_member *b = scene_beam(s, "b", 1, 8, 3, K, M);
        OK(s, spar_member_set_root(b, free ? SPAR_ROOT_FREE : SPAR_ROOT_PINNED));
        OK(s, spar_member_commit(b));
        assert_int_equal(spar_beam_set_modal_damping(b, rigid, ratio, NULL), SPAR_ERR_NUMERIC);
        assert_non_null(strstr(spar_session_message(s), "is a rigid-body mode"));
        OK(s, spar_beam_set_modal_damping(b, good, ratio, NULL));
        scene_run(s, 0.01, 2);
        spar_session_destroy(&s);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_uncoupled),
        cmocka_unit_test(test_decay),
        cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_rigid_modes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
