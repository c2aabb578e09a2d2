/* Splines, Brent's roots and Gauss's quadrature against closed forms and against GSL. */
#include <cmocka.h>
#include <float.h>
#include <math.h>

#include <gsl/gsl_integration.h>
#include <gsl/gsl_roots.h>
#include <gsl/gsl_spline.h>

#include "math/basis.h"
#include "math/brent.h"
#include "math/spline.h"

#define PI 3.14159265358979323846

/* Uneven points from 0 to 2 pi. */
static void make_points(int n, double *x) {
    for (int i = 0; i < n; i++) {
        double t = (double)i / (n - 1);
        x[i] = i == n - 1 ? 2 * PI : 2 * PI * t * (0.6 + 0.4 * t);
    }
}

static double polynomial(int degree, double x) {
    static const double c[] = {0.7, -1.3, 0.4, 0.25};
    double y = 0;
    for (int k = degree; k >= 0; k--) {
        y = y * x + c[k];
    }
    return y;
}

/* Each kind gives back what it can be: linear and Akima's lines, the parabola parabolas, Akima's curve parabolas at
   points evenly spaced, the natural cubic a cubic whose curvature is 0 at both ends. Slopes with them, values at the
   points to the last bit. */
static void test_exact(void **state) {
    (void)state;
    static const struct exact {
        spari_spline_kind kind;
        int n, degree;
    } kind[] = {{SPARI_SPLINE_LINEAR, 2, 1}, {SPARI_SPLINE_LINEAR, 9, 1}, {SPARI_SPLINE_PARABOLA, 3, 2},
                {SPARI_SPLINE_CUBIC, 2, 1},  {SPARI_SPLINE_CUBIC, 7, 1},  {SPARI_SPLINE_AKIMA, 5, 1},
                {SPARI_SPLINE_AKIMA, 9, 2}};
    for (size_t k = 0; k < sizeof kind / sizeof *kind; k++) {
        int n = kind[k].n, degree = kind[k].degree, even = kind[k].kind == SPARI_SPLINE_AKIMA && degree == 2;
        double x[9], y[9], slope;
        make_points(n, x);
        for (int i = 0; i < n; i++) {
            x[i] = even ? 0.5 * i : x[i];
            y[i] = polynomial(degree, x[i]);
        }
        spari_spline s;
        int64_t at = 7;
        assert_int_equal(spari_spline_create(&s, kind[k].kind, n, x, y), 0);
        for (int i = 0; i <= 100; i++) {
            double t = x[0] + (x[n - 1] - x[0]) * i / 100;
            assert_true(fabs(spari_spline_at(&s, fmin(t, x[n - 1]), &at, &slope) - polynomial(degree, t)) < 1e-13);
            double exact = -1.3 + (degree > 1 ? 0.8 * t : 0);
            assert_true(fabs(slope - exact) < 1e-12);
        }
        for (int i = 0; i < n; i++) {
            assert_true(spari_spline_at(&s, x[i], &at, NULL) == y[i]);
        }
        spari_spline_free(&s);
    }
}

/* sin has no curvature at 0 and 2 pi, and is periodic: the
   error falls with the fourth power of the distance, of both cubics, by 16 to a few per cent. */
static void test_order(void **state) {
    (void)state;
    for (int periodic = 0; periodic < 2; periodic++) {
        double error[2] = {0};
        for (int fine = 0; fine < 2; fine++) {
            enum { MOST = 129 };
            int n = fine ? MOST : MOST / 2 + 1;
            double x[MOST], y[MOST];
            for (int i = 0; i < n; i++) {
                x[i] = 2 * PI * i / (n - 1);
                y[i] = i == n - 1 ? 0 : sin(x[i]);
            }
            spari_spline s;
            int64_t at = 0;
            assert_int_equal(
                spari_spline_create(&s, periodic ? SPARI_SPLINE_CUBIC_PERIODIC : SPARI_SPLINE_CUBIC, n, x, y), 0);
            for (int i = 0; i < 1000; i++) {
                double t = 2 * PI * i / 1000;
                error[fine] = fmax(error[fine], fabs(spari_spline_at(&s, t, &at, NULL) - sin(t)));
            }
            spari_spline_free(&s);
        }
        assert_true(error[1] < 1e-7 && error[0] / error[1] > 15 && error[0] / error[1] < 17);
    }
}

/* A periodic curve has one slope at both ends, and turned by some points it is the same curve. */
static void test_periodic(void **state) {
    (void)state;
    static const double value[] = {0.3, -1, 2, 0.5, 0.4, 1.7, -0.2};
    enum { N = 8 };
    for (int kind = 0; kind < 2; kind++) {
        double x[2][N], y[2][N], first, last;
        spari_spline s[2];
        int64_t at = 0;
        for (int turned = 0; turned < 2; turned++) {
            for (int i = 0; i < N; i++) {
                int from = i + 3 * turned;
                x[turned][i] = 0.5 * from + 0.1 * (from % (N - 1)) + (from >= N - 1 ? 0.7 : 0);
                y[turned][i] = value[from % (N - 1)];
            }
            assert_int_equal(spari_spline_create(s + turned,
                                                 kind ? SPARI_SPLINE_AKIMA_PERIODIC : SPARI_SPLINE_CUBIC_PERIODIC, N,
                                                 x[turned], y[turned]),
                             0);
            (void)spari_spline_at(s + turned, x[turned][0], &at, &first);
            (void)spari_spline_at(s + turned, x[turned][N - 1], &at, &last);
            assert_true(fabs(first - last) < 1e-13);
        }
        for (double t = x[1][0]; t < x[0][N - 1]; t += 0.01) {
            assert_true(fabs(spari_spline_at(s, t, &at, NULL) - spari_spline_at(s + 1, t, &at, NULL)) < 1e-13);
        }
        spari_spline_free(s);
        spari_spline_free(s + 1);
    }
}

/* Akima's corner between two straight pieces stays one. */
static void test_corner(void **state) {
    (void)state;
    double x[9], y[9], slope;
    for (int i = 0; i < 9; i++) {
        x[i] = i, y[i] = abs(i - 4);
    }
    spari_spline s;
    int64_t at = 0;
    assert_int_equal(spari_spline_create(&s, SPARI_SPLINE_AKIMA, 9, x, y), 0);
    for (double t = 0.1; t < 8; t += 0.1) {
        assert_true(fabs(spari_spline_at(&s, t, &at, &slope) - fabs(t - 4)) < 1e-14);
    }
    spari_spline_free(&s);
}

static double wave(double x, void *count) {
    ++*(int *)count;
    return cos(x) - x;
}

static double steep(double x, void *count) {
    ++*(int *)count;
    return x > 0.3 ? 1 : -1e-9;
}

static double flat(double x, void *count) {
    ++*(int *)count;
    return (x - 0.1) * (x - 0.1) * (x - 0.1);
}

/* Dottie's number, a jump, a root three times; roots at an end; no bracket, no number. */
static void test_brent(void **state) {
    (void)state;
    int count = 0;
    assert_true(fabs(spari_brent(wave, &count, 0, 1, 0, 100) - 0.73908513321516064166) < 1e-15);
    assert_true(count < 12);
    assert_true(fabs(spari_brent(steep, &count, -1, 2, 0, 200) - 0.3) < 1e-15);
    assert_true(fabs(spari_brent(flat, &count, -1, 2, 1e-6, 200) - 0.1) < 1e-6);
    assert_true(spari_brent(flat, &count, 0.1, 2, 0, 100) == 0.1);
    assert_true(spari_brent(flat, &count, -2, 0.1, 0, 100) == 0.1);
    assert_true(isnan(spari_brent(wave, &count, 1, 2, 0, 100)));
    assert_true(isnan(spari_brent(wave, &count, 0, NAN, 0, 100)));
}

/* n points integrate x^(2 n - 1) and x^(2 n - 2) to rounding; points ascend and are symmetric to the bit. */
static void test_gauss(void **state) {
    (void)state;
    for (int n = 1; n <= 128; n++) {
        double x[128], w[128], odd = 0, even = 0, all = 0;
        spari_gauss(n, x, w);
        for (int i = 0; i < n; i++) {
            odd += w[i] * pow(x[i], 2 * n - 1);
            even += w[i] * pow(x[i], 2 * n - 2);
            all += w[i];
            assert_true(x[i] == -x[n - 1 - i] && w[i] == w[n - 1 - i] && (i == 0 || x[i] > x[i - 1]));
        }
        assert_true(fabs(odd) < 1e-15 && fabs(all - 2) < 1e-14);
        assert_true(fabs(even * (2 * n - 1) / 2 - 1) < 1e-12);
    }
}

static void test_splines_of_gsl(void **state) {
    (void)state;
    const gsl_interp_type *const theirs[] = {gsl_interp_linear,  gsl_interp_polynomial,
                                             gsl_interp_cspline, gsl_interp_cspline_periodic,
                                             gsl_interp_akima,   gsl_interp_akima_periodic};
    enum { MOST = 40 };
    for (int kind = 0; kind < 6; kind++) {
        assert_int_equal(spari_spline_least((spari_spline_kind)kind), gsl_interp_type_min_size(theirs[kind]));
        int least = kind == SPARI_SPLINE_CUBIC_PERIODIC ? 3 : (int)spari_spline_least((spari_spline_kind)kind);
        for (int n = least; n <= (kind == 1 ? 3 : MOST); n++) {
            double x[MOST], y[MOST], slope;
            make_points(n, x);
            for (int i = 0; i < n; i++) {
                y[i] = i == n - 1 ? y[0] : sin(7.1 * i) + (i % 5 > 1 ? 0 : 0.1 * i);
            }
            spari_spline s;
            int64_t at = 0;
            gsl_spline *g = gsl_spline_alloc(theirs[kind], (size_t)n);
            assert_int_equal(gsl_spline_init(g, x, y, (size_t)n), 0);
            assert_int_equal(spari_spline_create(&s, (spari_spline_kind)kind, n, x, y), 0);
            for (int i = 0; i <= 500; i++) {
                double t = fmin(x[0] + (x[n - 1] - x[0]) * i / 500, x[n - 1]);
                assert_true(fabs(spari_spline_at(&s, t, &at, &slope) - gsl_spline_eval(g, t, NULL)) < 1e-12);
                assert_true(fabs(slope - gsl_spline_eval_deriv(g, t, NULL)) < 1e-10);
            }
            spari_spline_free(&s);
            gsl_spline_free(g);
        }
    }
}

static void test_root_of_gsl(void **state) {
    (void)state;
    int count = 0;
    gsl_function f = {wave, &count};
    gsl_root_fsolver *g = gsl_root_fsolver_alloc(gsl_root_fsolver_brent);
    assert_int_equal(gsl_root_fsolver_set(g, &f, -1, 3), 0);
    for (int i = 0; i < 30; i++) {
        assert_int_equal(gsl_root_fsolver_iterate(g), 0);
    }
    assert_true(fabs(spari_brent(wave, &count, -1, 3, 0, 100) - gsl_root_fsolver_root(g)) <= 2 * DBL_EPSILON);
    gsl_root_fsolver_free(g);
}

/* GSL has tables up to 20 points; others it computes, to 1e-10. */
static void test_gauss_of_gsl(void **state) {
    (void)state;
    for (int n = 1; n <= 64; n++) {
        double x[64], w[64], at, weight;
        gsl_integration_glfixed_table *g = gsl_integration_glfixed_table_alloc((size_t)n);
        spari_gauss(n, x, w);
        for (int i = 0; i < n; i++) {
            gsl_integration_glfixed_point(-1, 1, (size_t)i, &at, &weight, g);
            double digit = n <= 20 ? DBL_EPSILON : 1e-10;
            assert_true(fabs(x[i] - at) <= digit && fabs(w[i] - weight) <= digit);
        }
        gsl_integration_glfixed_table_free(g);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_exact),          cmocka_unit_test(test_order),       cmocka_unit_test(test_periodic),
        cmocka_unit_test(test_corner),         cmocka_unit_test(test_brent),       cmocka_unit_test(test_gauss),
        cmocka_unit_test(test_splines_of_gsl), cmocka_unit_test(test_root_of_gsl), cmocka_unit_test(test_gauss_of_gsl),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
