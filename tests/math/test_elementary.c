/* The elementary functions for lanes against the mathematics library over their range. 1e-15 is 4.5 ulp; the library's
   own error is below 1 ulp. */
#include "math/elementary.h"

#include <float.h>

#include <cmocka.h>

enum { DRAWS = 200000 };

static uint64_t seed = 88172645463325252u;
static double uniform(double lo, double hi) {
    seed ^= seed << 13, seed ^= seed >> 7, seed ^= seed << 17;
    return lo + (hi - lo) * (double)(seed >> 11) * 0x1p-53;
}

/* Error relative to the expected value. */
static double off(double found, double expected) {
    return fabs(found - expected) / fmax(fabs(expected), DBL_MIN);
}

static void test_sincos(void **state) {
    (void)state;
    double worst = 0.0, s, c;
    for (int i = 0; i < DRAWS; i++) {
        double x = i % 2 ? uniform(-1000.0, 1000.0) : uniform(-4.0, 4.0) * pow(10.0, -(i % 16));
        spari_lane_sincos(x, &s, &c);
        worst = fmax(worst, fmax(off(s, sin(x)), off(c, cos(x))));
    }
    print_message("sine, cosine: %.1e\n", worst);
    assert_true(worst < 1e-15);
    spari_lane_sincos(0.0, &s, &c);
    assert_true(s == 0.0 && c == 1.0);
    spari_lane_sincos(NAN, &s, &c);
    assert_true(isnan(s) && isnan(c));
}

static void test_exp(void **state) {
    (void)state;
    double worst = 0.0, power, less;
    for (int i = 0; i < DRAWS; i++) {
        double x = i % 2 ? uniform(-708.0, 0.5) : uniform(-1.0, 0.5) * pow(10.0, -(i % 18));
        spari_lane_exp(x, &power, &less);
        worst = fmax(worst, fmax(off(power, exp(x)), off(less, expm1(x))));
    }
    print_message("exponential: %.1e\n", worst);
    assert_true(worst < 1e-15);
    spari_lane_exp(0.0, &power, &less);
    assert_true(power == 1.0 && less == 0.0);
    spari_lane_exp(NAN, &power, &less);
    assert_true(isnan(power) && isnan(less));
}

/* All quadrants and ratios from 1e-30 to 1e30; y = 0 of both signs has the bits of the library. */
static void test_atan2(void **state) {
    (void)state;
    static const double edge[] = {0.0, -0.0, 1.0, -1.0};
    double worst = 0.0;
    for (int i = 0; i < DRAWS; i++) {
        double y = uniform(-1.0, 1.0), x = uniform(-1.0, 1.0) * pow(10.0, i % 3 ? 0.0 : uniform(-30.0, 30.0));
        worst = fmax(worst, off(spari_lane_atan2(y, x), atan2(y, x)));
    }
    print_message("arc tangent: %.1e\n", worst);
    assert_true(worst < 1e-15);
    for (int i = 0; i < 16; i++) {
        if (edge[i / 4] != 0.0) {
            continue;
        }
        double found = spari_lane_atan2(edge[i / 4], edge[i % 4]), expected = atan2(edge[i / 4], edge[i % 4]);
        assert_memory_equal(&found, &expected, sizeof found);
    }
    assert_true(isnan(spari_lane_atan2(NAN, 1.0)) && isnan(spari_lane_atan2(1.0, NAN)));
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_sincos), cmocka_unit_test(test_exp),
                                       cmocka_unit_test(test_atan2)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
