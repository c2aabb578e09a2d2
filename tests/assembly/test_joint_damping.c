/* Damping of members as an assembly feels it: decay rates of its modes against closed forms. */
#include "scene.h"

#include <gsl/gsl_integration.h>

enum { P = 7 };

static const double two_pi = 6.283185307179586;

/* A slender cantilever of 2 m in two halves welded together, 1 kg/m, EI = 600 N m^2 about y and 700 about z; stress = C
   (strain
   + mu rate) with a mu for each half. */
typedef struct mast {
    spar_session *s;
    spar_member *half[2];
    double f;
} mast;

static mast make_mast(const double mu[2]) {
    mast t = {.s = scene_session()};
    OK(t.s, spar_session_set_integrator(t.s, 1, 1));
    for (int i = 0; i < 2; i++) {
        double K[36], M[36], each[6];
        scene_diagonal(K, 4e6, 4e6, 4e6, 800, 600, 700);
        scene_diagonal(M, 1, 1, 1, 2e-5, 1e-5, 1e-5);
        for (int k = 0; k < 6; k++) {
            each[k] = mu[i];
        }
        spar_member *b = t.half[i] = scene_beam(t.s, i ? "outer" : "inner", 1, P, 1, K, M);
        OK(t.s, spar_member_set_placement(b, (double[]){i, 0, 0}, (double[]){1, 0, 0, 0}));
        OK(t.s, spar_member_set_root(b, i ? SPAR_ROOT_FREE : SPAR_ROOT_FIXED));
        OK(t.s, mu[i] > 0 ? spar_beam_set_damping(b, each) : SPAR_OK);
        OK(t.s, spar_member_commit(b));
    }
    spar_joint *weld = NULL;
    OK(t.s, spar_joint_create(t.s, "weld", t.half[1], 0, t.half[0], P - 1, 0, &weld));
    OK(t.s, spar_member_solve_modes(t.half[0], 1, &t.f, NULL));
    return t;
}

/* Kinetic and strain energy, and what has been dissipated. */
static double energy_of(const mast *t, double *dissipated) {
    double sum = 0;
    *dissipated = 0;
    for (int i = 0; i < 2; i++) {
        double e[SPAR_ENERGY_COUNT];
        OK(t->s, spar_member_get_energy(t->half[i], SPAR_ENERGY_COUNT, e));
        sum += e[SPAR_ENERGY_KINETIC] + e[SPAR_ENERGY_STRAIN];
        *dissipated += e[SPAR_ENERGY_DISSIPATED];
    }
    return sum;
}

static double curvature_squared(double x, void *context) {
    const double l = 1.875104068711961, y = l * x, sigma = (sinh(l) - sin(l)) / (cosh(l) + cos(l)),
                 w = cosh(y) + cos(y) - sigma * (sinh(y) + sin(y));
    (void)context;
    return w * w;
}

/* Of the strain energy of a cantilever's first mode (Euler and Bernoulli) what its inner half has: 0.949. */
static double inner_share(void) {
    gsl_function f = {curvature_squared, NULL};
    gsl_integration_glfixed_table *rule = gsl_integration_glfixed_table_alloc(32);
    double inner = gsl_integration_glfixed(&f, 0, 0.5, rule), all = gsl_integration_glfixed(&f, 0, 1, rule);
    gsl_integration_glfixed_table_free(rule);
    return inner / all;
}

/* Let go from the bend under a force at the tip, at small amplitude; after two periods only the first mode is left (the
   second decays 40 times faster, and had 3 % of the energy). Over the next three periods the energy falls by
   exp(-omega^2 T sum of mu_i times the half's share of the strain energy): D = mu_i K_i, so that x . D x = mu_i x . K_i
   x in a mode that moves as x. To 2e-3 of the exponent: the slender beam's shear, and dt^2. Energy and what the members
   say they have dissipated stay to 1e-3. */
static void check_decay(mast *t, const double mu[2]) {
    enum { STEPS = 400 };
    const double omega = two_pi * t->f, share = inner_share(), push[6] = {0, 0, 2e-3},
                 expected = two_pi * 3 * omega * (mu[0] * share + mu[1] * (1 - share));
    double lost[2], begin, dissipated;
    OK(t->s, spar_member_set_load(t->half[1], P - 1, SPAR_LOAD_DEAD, push));
    OK(t->s, spar_session_solve_static(t->s, 1, NULL, NULL, NULL));
    OK(t->s, spar_member_set_load(t->half[1], P - 1, SPAR_LOAD_DEAD, (double[6]){0}));
    begin = energy_of(t, &dissipated);
    scene_run(t->s, 1 / (STEPS * t->f), 2 * STEPS);
    double before = energy_of(t, &lost[0]);
    scene_run(t->s, 1 / (STEPS * t->f), 3 * STEPS);
    double after = energy_of(t, &lost[1]);
    NEAR(log(before / after), expected, 2e-3 * expected);
    NEAR((after + lost[1]) / begin, 1, 1e-3);
}

/* One damping for both halves, zeta = 0.02; the inner half's alone, 0.03; the outer's alone, which has 1 % of the
   strain: 0.05 is light enough for the shape to stay. */
static void test_decay(void **state) {
    (void)state;
    const double ratio[3][2] = {{0.02, 0.02}, {0.03, 0}, {0, 0.02}}, f = 0.5595931 * sqrt(600 / 16.0);
    for (int run = 0; run < 3; run++) {
        const double *r = ratio[run], mu[2] = {2 * r[0] / (two_pi * f), 2 * r[1] / (two_pi * f)};
        mast t = make_mast(mu);
        NEAR(t.f, f, 3e-4 * f);
        check_decay(&t, mu);
        spar_session_destroy(&t.s);
    }
}

/* Ratios of a tied member's own modes (its two bending ones by itself, 4 times as high as the mast's) become a mu, and
   that the mast's decay. */
static void test_modal_damping(void **state) {
    (void)state;
    const int64_t mode[2] = {0, 1};
    const double ratio[2] = {0.12, 0.1}, none[2] = {0, 0};
    double found[6];
    mast t = make_mast(none);
    OK(t.s, spar_beam_set_modal_damping(t.half[0], mode, ratio, found));
    const double mu[2] = {found[4], 0}, f = 0.5595931 * sqrt(600.0);
    NEAR(found[4], 2 * ratio[0] / (two_pi * f), 1e-3 * found[4]);
    check_decay(&t, mu);
    spar_session_destroy(&t.s);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_decay), cmocka_unit_test(test_modal_damping)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
