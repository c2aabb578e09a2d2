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

/* Ratios of any number of modes. Four modes of different kinds (first and second bending about y, first about z, first
   torsion) have the ratios asked for, to 1e-8, and so do the eigenvalues, -Re / |lambda|, to 1e-6. */
static void test_four_modes(void **state) {
    (void)state;
    const double wanted[4] = {0.005, 0.008, 0.02, 0.01};
    int64_t mode[4] = {-1, -1, -1, -1};
    double K[36], M[36], f[10], shapes[10 * 6 * 10], value[10][2], achieved[4];
    scene_diagonal(K, 1e7, 1e6, 1e6, 50, 40, 90);
    scene_diagonal(M, 2, 2, 2, 2e-2, 1e-3, 1e-3);
    spar_session *s = scene_session();
    spar_member *b = scene_beam(s, "b", 1, 10, 3, K, M);
    OK(s, spar_member_commit(b));
    OK(s, spar_member_solve_modes(b, 10, f, shapes));
    for (int k = 0; k < 10; k++) { /* by the largest motion of the tip */
        const double *tip = shapes + (ptrdiff_t)6 * (10 * k + 9);
        int kind = fabs(tip[3]) > fabs(tip[1]) + fabs(tip[2]) ? 3 : fabs(tip[2]) > fabs(tip[1]) ? 0 : 2;
        kind = kind == 0 && mode[0] >= 0 ? 1 : kind;
        mode[kind] = mode[kind] < 0 ? k : mode[kind];
    }
    OK(s, spar_beam_fit_damping(b, 4, mode, wanted, achieved));
    OK(s, spar_member_solve_eigenvalues(b, 10, NULL, value[0], NULL, NULL));
    for (int i = 0; i < 4; i++) {
        double nearest = 1e9, ratio = 0;
        NEAR(achieved[i], wanted[i], 1e-8 * wanted[i]);
        for (int k = 0; k < 10; k++) {
            double size = hypot(value[k][0], value[k][1]), off = fabs(size / (two_pi * f[mode[i]]) - 1);
            ratio = off < nearest ? -value[k][0] / size : ratio;
            nearest = fmin(nearest, off);
        }
        NEAR(ratio, wanted[i], 1e-6);
    }
    spar_session_destroy(&s);
}

/* One plane, three modes of one ratio z: mu w/2 + alpha/(2 w) fits them by least squares of two unknowns, whose normal
   equations are solved here by hand (where both are positive), to 1e-8. The other groups have a mu, but no mode shows
   it. */
static void test_least_squares(void **state) {
    (void)state;
    const double z = 0.01, ratio[3] = {z, z, z};
    double K[36], M[36], f[3], mu[6], alpha, achieved[3];
    int64_t mode[3] = {0, 1, 2};
    scene_diagonal(K, 1e7, 1e6, 1e6, 1e5, 40, 1e6); /* stiff but for one bending */
    scene_diagonal(M, 2, 2, 2, 1e-3, 1e-3, 1e-3);
    spar_session *s = scene_session();
    spar_member *b = scene_beam(s, "b", 1, 10, 3, K, M);
    OK(s, spar_member_commit(b));
    OK(s, spar_member_solve_modes(b, 3, f, NULL));
    OK(s, spar_beam_fit_damping(b, 3, mode, ratio, achieved));
    OK(s, spar_beam_get_damping(b, mu));
    OK(s, spar_beam_get_mass_damping(b, &alpha));
    double a = 0, c = 0, d = 0, e = 0, g = 0;
    for (int k = 0; k < 3; k++) {
        double w = two_pi * f[k], p = w / (2 * z), q = 1 / (2 * w * z);
        a += p * p, c += p * q, d += q * q, e += p, g += q;
    }
    double det = a * d - c * c, best = (e * d - g * c) / det, rest = (a * g - c * e) / det;
    assert_true(best > 0 && rest > 0);
    NEAR(mu[4], best, 1e-8 * best);
    NEAR(alpha, rest, 1e-8 * rest);
    for (int k = 0; k < 3; k++) {
        double w = two_pi * f[k];
        NEAR(achieved[k], 0.5 * (best * w + rest / w), 1e-9);
    }
    REFUSED(s, SPAR_ERR_ARGUMENT, "0 modes", spar_beam_fit_damping(b, 0, mode, ratio, NULL));
    REFUSED(s, SPAR_ERR_ARGUMENT, "mode is NULL", spar_beam_fit_damping(b, 3, NULL, ratio, NULL));
    mode[1] = -1;
    REFUSED(s, SPAR_ERR_ARGUMENT, "there is no mode -1", spar_beam_fit_damping(b, 3, mode, ratio, NULL));
    OK(s, spar_beam_get_mass_damping(b, &alpha));
    NEAR(alpha, rest, 1e-8 * rest);
    spar_session_destroy(&s);
}

/* A tower of 82 m, its top mass off the axis: the bending modes 0 to 3 at 1, 1, 2, 2 % are met by a torsion of 1000 %,
   which is told; with the torsion, mode 4, among those chosen, nothing is. */
static void test_other_modes(void **state) {
    (void)state;
    enum { CHOSEN = 5 };
    const double d[2] = {4.6, 0.027}, eta[2] = {0, 1}, xyz[6] = {0, 0, 0, 0, 0, 82}, tip = 1, c[3] = {1.8, -0.3, 0},
                 J[3] = {3e6, 2.6e7, 2.4e7}, ratio[CHOSEN] = {0.01, 0.01, 0.02, 0.02, 0.02};
    const int64_t mode[CHOSEN] = {0, 1, 2, 3, 4};
    for (int n = CHOSEN - 1; n <= CHOSEN; n++) {
        double p[SPAR_SECTION_COUNT], K[36], M[36], R[36], mu[6], f[CHOSEN];
        spar_session *s = scene_session();
        spar_member *b = NULL;
        OK(s, spar_section_from_shape(SPAR_SHAPE_TUBE, 2, d, 210e9, 0.3, 8500, SPAR_SECTION_COUNT, p));
        OK(s, spar_section_build(SPAR_SECTION_COUNT, p, K, M));
        OK(s, spar_beam_create(s, "tower", 4, 5, &b));
        OK(s, spar_beam_set_axis(b, 2, eta, xyz, NULL));
        OK(s, spar_beam_set_sections(b, 1, eta, K, M));
        scene_mass(R, 3.1e5, c, J);
        OK(s, spar_beam_set_masses(b, 1, &tip, R));
        OK(s, spar_member_commit(b));
        OK(s, spar_member_solve_modes(b, CHOSEN, f, NULL));
        OK(s, spar_beam_fit_damping(b, n, mode, ratio, NULL));
        OK(s, spar_beam_get_damping(b, mu));
        const double torsion = mu[3] * 0.5 * two_pi * f[4];
        const char *text = spar_session_get_warning(s, 0);
        if (n < CHOSEN) {
            const char *said = strstr(text, "mode 4 (3.8");
            assert_non_null(said);
            NEAR(atof(strstr(said, "ratio") + 6), torsion, 0.1 * torsion); /* bending has a little part in it */
        } else {
            assert_string_equal(text, "");
            assert_true(torsion < 0.1);
        }
        spar_session_destroy(&s);
    }
}

/* A mass of ten times its own, welded to a beam's tip: its ratios of 1 % become less. What the warning says is what the
   eigenvalue has, -Re / |lambda|, to its three digits. If the joint comes later, that is told. */
static void test_joined_mass(void **state) {
    (void)state;
    const int64_t mode[2] = {0, 1};
    const double ratio[2] = {0.01, 0.01}, J[3] = {0.1, 0.1, 0.1}, x[3] = {3, 0, 0};
    for (int run = 0; run < 4; run++) {
        const int late = run / 2, fit = run % 2;
        double K[36], M[36], value[2];
        spar_session *s = scene_session();
        scene_diagonal(K, 1e6, 1e6, 1e6, 50, 10, 40);
        scene_diagonal(M, 2, 2, 2, 1e-3, 1e-3, 1e-3);
        spar_member *b = scene_beam(s, "b", 1, 8, 3, K, M), *top;
        OK(s, spar_member_commit(b));
        top = scene_body(s, "top", x, 60, J);
        (void)(late ? NULL : scene_joint(s, "weld", b, 7, top, 0, 0));
        OK(s, fit ? spar_beam_fit_damping(b, 2, mode, ratio, NULL) : spar_beam_set_modal_damping(b, mode, ratio, NULL));
        assert_int_equal(spar_session_get_warning(s, 0)[0] != 0, !late);
        (void)(late ? scene_joint(s, "weld", b, 7, top, 0, 0) : NULL);
        const char *text = spar_session_get_warning(s, 0), *said = strstr(text, "gets the damping ratio");
        if (late) {
            assert_non_null(strstr(text, "before joint 'weld' was created"));
        } else {
            OK(s, spar_member_solve_eigenvalues(b, 1, NULL, value, NULL, NULL));
            assert_non_null(said);
            NEAR(atof(said + 23), -value[0] / hypot(value[0], value[1]), 6e-3 * 0.01);
        }
        assert_string_equal(spar_session_get_warning(s, 1), "");
        spar_session_destroy(&s);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_uncoupled),   cmocka_unit_test(test_four_modes),  cmocka_unit_test(test_least_squares),
        cmocka_unit_test(test_decay),       cmocka_unit_test(test_refusals),    cmocka_unit_test(test_rigid_modes),
        cmocka_unit_test(test_other_modes), cmocka_unit_test(test_joined_mass),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
