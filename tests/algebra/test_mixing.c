/* Newton's corrections mixed with those before them, on linear problems whose errors are known, at every width that the
   processor has. z = (I - T) e is the correction of the error e that a tangent contracts by T.

   Oracle: a T of rank two with T a = lambda b and T b = lambda a, whose eigenvalues are +-lambda. Corrections as they
   come leave lambda^k of the error; the two changes that three corrections show span all errors there are, so that the
   next, mixed, leaves rounding: 1e-16 over the angle between them. A lambda of 0.35 and more is seen by the third, one
   of 0.1 by the fourth. Widths among each other: the same bits. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#include "algebra/anderson.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST = 300, WIDTHS = 4, BEYOND = SPARI_MIXED_STRIPE };
static const int widths[WIDTHS] = {2, 4, 8, 0};

static double uniform(void) {
    return 2.0 * rand() / RAND_MAX - 1.0;
}

static double dot(int n, const double *a, const double *b) {
    double sum = 0;
    for (int i = 0; i < n; i++) {
        sum += a[i] * b[i];
    }
    return sum;
}

static double size_of(int n, const double *a) {
    return sqrt(dot(n, a, a));
}

/* Two directions, orthogonal and of length 1. */
static void two_directions(int n, double *a, double *b) {
    for (int i = 0; i < n; i++) {
        a[i] = uniform();
        b[i] = uniform();
    }
    double by = dot(n, a, b) / dot(n, a, a);
    for (int i = 0; i < n; i++) {
        b[i] -= by * a[i];
    }
    double over_a = 1 / size_of(n, a), over_b = 1 / size_of(n, b);
    for (int i = 0; i < n; i++) {
        a[i] *= over_a;
        b[i] *= over_b;
    }
}

/* e less its correction; x: the correction that was taken. */
static void correct(spari_anderson *m, int width, double length, int n, double lambda, const double *a, const double *b,
                    double *e, double *x) {
    double along = dot(n, a, e), across = dot(n, b, e);
    for (int i = 0; i < n; i++) {
        x[i] = e[i] - lambda * (along * b[i] + across * a[i]);
    }
    spari_anderson_step(m, NULL, width, length, x);
    for (int i = 0; i < n; i++) {
        e[i] -= x[i];
    }
}

static void test_pair_is_taken(void **unused) {
    (void)unused;
    const int counts[] = {1, 2, 3, 4, 5, 8, 11, 19, 255, 256, 257, MOST};
    const double lambdas[] = {0.1, 0.35, 0.45};
    for (size_t c = 0; c < sizeof counts / sizeof *counts; c++) {
        for (size_t l = 0; l < sizeof lambdas / sizeof *lambdas; l++) {
            double a[6 * MOST], b[6 * MOST], x[6 * MOST + BEYOND] = {0}, first[6 * MOST], lambda = lambdas[l];
            int n = 6 * counts[c];
            two_directions(n, a, b);
            spari_anderson *m = spari_anderson_create(counts[c]);
            assert_non_null(m);
            for (int w = 0; w < WIDTHS; w++) {
                double e[6 * MOST];
                for (int i = 0; i < n; i++) {
                    e[i] = 1e-3 * (a[i] + 0.3 * b[i]);
                }
                double before = size_of(n, e);
                spari_anderson_begin(m);
                for (int it = 0; it < (l == 0 ? 4 : 3); it++) {
                    double comes = pow(lambda, it) * before;
                    assert_true(fabs(size_of(n, e) - comes) <= 1e-12 * before || it % 2);
                    correct(m, widths[w], 1, n, lambda, a, b, e, x);
                }
                assert_true(size_of(n, e) <= 1e-12 * before);
                if (w == 0) {
                    memcpy(first, x, (size_t)n * sizeof *x);
                }
                assert_memory_equal(first, x, (size_t)n * sizeof *x);
            }
            spari_anderson_free(m);
        }
    }
}

/* Errors of eight directions, contracted by 0.3 to 0.02 and their opposites: twelve corrections leave 0.3^12 = 5e-7 as
   they come, a tenth of that at most where they are mixed. */
static void test_more_directions(void **unused) {
    (void)unused;
    enum { N = 48, PAIRS = 4 };
    double v[2 * PAIRS][N], e[N] = {0}, x[N];
    for (int k = 0; k < 2 * PAIRS; k++) {
        for (int i = 0; i < N; i++) {
            v[k][i] = (i + k) % (2 * PAIRS) == 0 ? 1 : 0; /* orthogonal, of turns and displacements */
            e[i] += v[k][i] / sqrt(6);
        }
    }
    spari_anderson *m = spari_anderson_create(N / 6);
    for (int it = 0; it < 12; it++) {
        memcpy(x, e, sizeof x);
        for (int k = 0; k < 2 * PAIRS; k++) {
            double part = (k % 2 ? -1 : 1) * 0.3 / (1 + k / 2 * 2) * dot(N, v[k], e) / dot(N, v[k], v[k]);
            for (int i = 0; i < N; i++) {
                x[i] -= part * v[k][i];
            }
        }
        spari_anderson_step(m, NULL, 0, 7, x);
        for (int i = 0; i < N; i++) {
            e[i] -= x[i];
        }
    }
    print_message("left after 12: %.1e\n", size_of(N, e));
    assert_true(size_of(N, e) <= 0.1 * pow(0.3, 12) * sqrt(8));
    spari_anderson_free(m);
}

/* Corrections that say nothing are taken as they come: none, the same again, what no square holds, what contracts fast.
 */
static void test_what_says_nothing(void **unused) {
    (void)unused;
    const double sizes[] = {0, 1, 1e-200, 1e200, 1e308};
    enum { N = 66 };
    spari_anderson *m = spari_anderson_create(N / 6);
    for (size_t s = 0; s < sizeof sizes / sizeof *sizes; s++) {
        for (int fast = 0; fast < 2; fast++) {
            spari_anderson_begin(m);
            for (int it = 0; it < 6; it++) {
                double x[N + BEYOND] = {0}, as_it_comes[N], by = fast ? pow(0.02, it) : 1;
                for (int i = 0; i < N; i++) {
                    x[i] = as_it_comes[i] = sizes[s] * by * cos(i) * (it % 2 && fast ? -1 : 1);
                }
                spari_anderson_step(m, NULL, 0, 7, x);
                assert_memory_equal(x, as_it_comes, sizeof as_it_comes);
            }
        }
    }
    spari_anderson_free(m);
}

/* What begins anew knows of nothing before: the same bits as for the first time. */
static void test_begins_anew(void **unused) {
    (void)unused;
    enum { N = 30 };
    double a[N], b[N], x[2][N + BEYOND] = {{0}};
    two_directions(N, a, b);
    spari_anderson *m = spari_anderson_create(N / 6);
    for (int run = 0; run < 2; run++) {
        double e[N];
        for (int i = 0; i < N; i++) {
            e[i] = a[i] - b[i] + 0.1 * cos(i);
        }
        spari_anderson_begin(m);
        for (int it = 0; it < 5 + 2 * run; it++) {
            correct(m, 0, 1, N, 0.4, a, b, e, it < 5 ? x[run] : (double[N + BEYOND]){0});
        }
    }
    assert_memory_equal(x[0], x[1], sizeof x[0]);
    spari_anderson_free(m);
    spari_anderson_free(NULL);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_pair_is_taken),
        cmocka_unit_test(test_more_directions),
        cmocka_unit_test(test_what_says_nothing),
        cmocka_unit_test(test_begins_anew),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
