/* Polars: look-up between the rows, round the circle and beyond the table; every bad table is refused with its row. */
#include <math.h>
#include <string.h>

#include <cmocka.h>
#include <spar/spar_aero.h>

#define PI 3.14159265358979323846

static void refused(int64_t n, const double *alpha, const double *cl, const double *cd, const double *cm,
                    const char *what) {
    spar_polar *polar = NULL;
    assert_int_equal(spar_polar_create(n, alpha, cl, cd, cm, &polar), SPAR_ERR_ARGUMENT);
    assert_null(polar);
    const char *message = spar_session_message(NULL);
    if (!strstr(message, what)) {
        print_error("message '%s' does not name '%s'\n", message, what);
        fail();
    }
}

static void lift_at(const spar_polar *polar, double alpha, double expected, double tolerance) {
    double cl;
    assert_int_equal(spar_polar_evaluate(polar, alpha, &cl, NULL, NULL), SPAR_OK);
    assert_true(fabs(cl - expected) <= tolerance);
}

/* Linear between the rows: exact for values on a line, to rounding; and on the rows themselves. */
static void test_linear(void **state) {
    (void)state;
    double alpha[] = {-0.2, 0.1, 0.5}, cl[] = {-1.0, 0.5, 2.5}, cd[] = {0.3, 0.1, 0.5}, cm[] = {0.0, -0.1, 0.2};
    spar_polar *polar = NULL;
    assert_int_equal(spar_polar_create(3, alpha, cl, cd, cm, &polar), SPAR_OK);
    double l, d, m;
    assert_int_equal(spar_polar_evaluate(polar, 0.3, &l, &d, &m), SPAR_OK);
    assert_true(fabs(l - 1.5) < 1e-15 && fabs(d - 0.3) < 1e-15 && fabs(m - 0.05) < 1e-15);
    for (int i = 0; i < 3; i++) {
        lift_at(polar, alpha[i], cl[i], 0.0);
    }
    spar_polar_destroy(&polar);
    assert_null(polar);
    spar_polar_destroy(&polar);
}

/* A table over the full circle given in degrees: the wrap at +-180 degrees is without a step, and any number of turns
   gives the same, to the rounding of the angle (slope 10 per radian, angles up to 100 rad: 10 x 1e-14). */
static void test_wrap(void **state) {
    (void)state;
    double alpha[37], cl[37], cd[37];
    for (int i = 0; i < 37; i++) {
        alpha[i] = (-180.0 + 10.0 * i) * PI / 180.0;
        cl[i] = sin(alpha[i] + 0.3);
        cd[i] = 0.1;
    }
    spar_polar *polar = NULL;
    assert_int_equal(spar_polar_create(37, alpha, cl, cd, NULL, &polar), SPAR_OK);
    double step = 1e-9, inside, outside;
    assert_int_equal(spar_polar_evaluate(polar, PI - step, &inside, NULL, NULL), SPAR_OK);
    assert_int_equal(spar_polar_evaluate(polar, PI + step, &outside, NULL, NULL), SPAR_OK);
    assert_true(fabs(inside - outside) < 3.0 * step);
    for (double a = -3.1; a < 3.1; a += 0.37) {
        double once;
        assert_int_equal(spar_polar_evaluate(polar, a, &once, NULL, NULL), SPAR_OK);
        for (int turns = -15; turns <= 15; turns++) {
            lift_at(polar, a + 2.0 * PI * turns, once, 1e-13);
        }
    }
    assert_int_equal(spar_polar_evaluate(polar, NAN, &inside, NULL, NULL), SPAR_ERR_ARGUMENT);
    spar_polar_destroy(&polar);
}

/* A table that does not go round gives its nearer end beyond: 20 degrees to the one side, 170 to the other. */
static void test_beyond(void **state) {
    (void)state;
    double alpha[] = {-0.2, 0.3}, cl[] = {-1.0, 2.0}, cd[] = {0.1, 0.1};
    spar_polar *polar = NULL;
    assert_int_equal(spar_polar_create(2, alpha, cl, cd, NULL, &polar), SPAR_OK);
    lift_at(polar, 0.5, 2.0, 0.0);
    lift_at(polar, -0.5, -1.0, 0.0);
    lift_at(polar, 3.0, 2.0, 0.0);
    lift_at(polar, 3.5, -1.0, 0.0);
    lift_at(polar, 0.1 + 4.0 * PI, 0.8, 1e-14);
    spar_polar_destroy(&polar);
}

/* A smooth lift curve in 10 degree rows: |f''''| = 1, h = 0.1745. Cubic splines err by at most 5/384 h^4 = 1.2e-5,
   Akima by O(h^2) near inflections (1e-3 seen), lines by h^2/8 = 3.8e-3. The periodic kinds have no worse place at
   +-180 degrees. */
static void test_smooth_kinds(void **state) {
    (void)state;
    double alpha[37], cl[37], cd[37] = {0};
    for (int i = 0; i < 37; i++) {
        alpha[i] = (-180.0 + 10.0 * i) * PI / 180.0;
        cl[i] = sin(alpha[i] + 0.3);
    }
    static const double bound[] = {3.9e-3, 2e-3, 1.25e-5};
    spar_polar *polar = NULL;
    assert_int_equal(spar_polar_create(37, alpha, cl, cd, NULL, &polar), SPAR_OK);
    for (int kind = SPAR_POLAR_LINEAR; kind <= SPAR_POLAR_CUBIC; kind++) {
        double worst = 0.0, value;
        assert_int_equal(spar_polar_set_interpolation(polar, kind), SPAR_OK);
        for (double a = -3.2; a < 3.2; a += 0.01) {
            assert_int_equal(spar_polar_evaluate(polar, a, &value, NULL, NULL), SPAR_OK);
            worst = fmax(worst, fabs(value - sin(a + 0.3)));
        }
        assert_true(worst < bound[kind] && worst > 1e-3 * bound[kind]);
    }
    assert_int_equal(spar_polar_set_interpolation(polar, 7), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_polar_set_interpolation(NULL, 0), SPAR_ERR_ARGUMENT);
    spar_polar_destroy(&polar);
    assert_int_equal(spar_polar_create(2, alpha, cl, cd, NULL, &polar), SPAR_OK);
    assert_int_equal(spar_polar_set_interpolation(polar, SPAR_POLAR_AKIMA), SPAR_ERR_ARGUMENT);
    lift_at(polar, alpha[0], cl[0], 0.0); /* still as it was */
    spar_polar_destroy(&polar);
}

static void test_refused(void **state) {
    (void)state;
    double alpha[] = {-PI, 0.0, 1.0, PI}, cl[] = {0.0, 1.0, 2.0, 0.0}, cd[] = {1.0, 1.0, 1.0, 1.0};
    refused(1, alpha, cl, cd, NULL, "1 rows");
    refused(0, NULL, NULL, NULL, NULL, "0 rows");
    refused(-3, alpha, cl, cd, NULL, "-3 rows");
    refused(4, NULL, cl, cd, NULL, "NULL");
    refused(4, alpha, NULL, cd, NULL, "NULL");
    refused(4, alpha, cl, NULL, NULL, "NULL");
    double twice[] = {-PI, 1.0, 1.0, PI};
    refused(4, twice, cl, cd, NULL, "row 2");
    double holes[] = {0.0, 1.0, 1.0, NAN};
    refused(4, alpha, cl, holes, NULL, "cd of row 3");
    refused(4, alpha, holes, cd, NULL, "cl of row 3");
    refused(4, alpha, cl, cd, holes, "cm of row 3");
    refused(4, holes, cl, cd, NULL, "row");
    double degrees[] = {-180.0, 0.0, 10.0, 180.0};
    refused(4, degrees, cl, cd, NULL, "radians");
    double ends[] = {0.0, 1.0, 2.0, 0.1};
    refused(4, alpha, ends, cd, NULL, "cl is 0 in row 0 and 0.1 in row 3");
    assert_int_equal(spar_polar_create(4, alpha, cl, cd, NULL, NULL), SPAR_ERR_ARGUMENT);
    spar_polar *polar = NULL;
    assert_int_equal(spar_polar_create(4, alpha, cl, cd, NULL, &polar), SPAR_OK); /* the good one is taken */
    assert_int_equal(spar_polar_evaluate(NULL, 0.0, NULL, NULL, NULL), SPAR_ERR_ARGUMENT);
    spar_polar_destroy(&polar);
    spar_polar_destroy(NULL);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_linear), cmocka_unit_test(test_wrap),
                                       cmocka_unit_test(test_beyond), cmocka_unit_test(test_smooth_kinds),
                                       cmocka_unit_test(test_refused)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
