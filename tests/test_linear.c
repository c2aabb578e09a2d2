/* Linear systems: factors and back-substitution, dense and banded, of members and of any entries. Oracle: what the
   solution leaves of the system, |A x - b| <= 1e-13 n max|A| max|x|, as Gaussian elimination with exchanges of rows
   leaves unless pivots grow (Wilkinson's bound with a growth of one digit); A is kept by the test itself. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#include "solve/linear.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST = 160 };

static double uniform(void) {
    return 2.0 * rand() / RAND_MAX - 1.0;
}

/* A chain of random blocks, with a diagonal that asks for exchanges; unknown 1 held. */
static void check_system(int elements, int block, int overlap) {
    int n = elements * (block - overlap) + overlap, at = n > 1 ? 1 : 0;
    double *A = calloc((size_t)(n * n), sizeof *A), *S = calloc((size_t)(block * block), sizeof *S), x[MOST], b[MOST];
    spari_linear *s = spari_linear_create(elements, block, overlap);
    double big = 1, most = 0;
    assert_true(n <= MOST && s);
    for (int e = 0; e < elements; e++) {
        for (int i = 0; i < block * block; i++) {
            S[i] = uniform();
            A[n * (e * (block - overlap) + i / block) + e * (block - overlap) + i % block] += S[i];
        }
        spari_linear_add(s, e, S);
    }
    spari_linear_fix(s, at);
    for (int i = 0; i < n; i++) {
        A[n * i + at] = A[n * at + i] = i == at;
        b[i] = x[i] = uniform();
    }
    assert_int_equal(spari_linear_factor(s), 0);
    assert_int_equal(spari_linear_solve(s, x), 0);
    for (int i = 0; i < n; i++) {
        most = fmax(most, fabs(x[i]));
        for (int j = 0; j < n; j++) {
            big = fmax(big, fabs(A[n * i + j]));
        }
    }
    for (int i = 0; i < n; i++) {
        double left = -b[i];
        for (int j = 0; j < n; j++) {
            left += A[n * i + j] * x[j];
        }
        assert_true(fabs(left) <= 1e-13 * n * big * most);
    }
    assert_true(fabs(x[at] - b[at]) <= 1e-13 * most); /* its row and column are those of the identity */
    spari_linear_free(s);
    free(A);
    free(S);
}

/* 1 to 75 unknowns: every remainder of columns and of vectors. */
static void test_dense(void **unused) {
    (void)unused;
    for (int n = 1; n <= 75; n++) {
        check_system(1, n, 0);
    }
}

/* Chains of 2 to 9 blocks of 2 to 18, overlapping by 1 to 6. */
static void test_band(void **unused) {
    (void)unused;
    for (int block = 2; block <= 18; block++) {
        for (int elements = 2; elements < 10; elements++) {
            check_system(elements, block, block > 6 ? 6 : block / 2);
        }
    }
}

/* A x = b of n unknowns with holes, most of the entries and every third of the diagonal, as constraints leave them.
   Rows are exchanged for a tenth of a pivot only: one digit of growth more. */
static void check_holes(int n, int band) {
    double *A = calloc((size_t)(n * n), sizeof *A), x[MOST], b[MOST], most = 0;
    spari_linear *s = spari_linear_create_banded(n, band);
    int64_t step;
    double *entry = spari_linear_entries(s, &step);
    spari_linear_zero(s);
    for (int i = 0; i < n; i++) {
        b[i] = x[i] = uniform();
        for (int j = i > band ? i - band : 0; j < n && j <= i + band; j++) {
            int in = i == j ? i % 3 != 2 : uniform() > 0.6 || (j == i + 1 && j % 3 == 2) || (j == i - 1 && i % 3 == 2);
            entry[i + step * j] = A[n * i + j] = in ? uniform() + (i == j) : 0;
        }
    }
    assert_int_equal(spari_linear_factor(s), 0);
    assert_int_equal(spari_linear_solve(s, x), 0);
    for (int i = 0; i < n; i++) {
        most = fmax(most, fabs(x[i]));
    }
    for (int i = 0; i < n; i++) {
        double left = -b[i];
        for (int j = 0; j < n; j++) {
            left += A[n * i + j] * x[j];
        }
        assert_true(fabs(left) <= 2e-12 * n * most);
    }
    spari_linear_free(s);
    free(A);
}

static void test_holes(void **unused) {
    (void)unused;
    for (int n = 3; n <= 84; n += 3) {
        check_holes(n, n - 1);
    }
    for (int band = 1; band <= 20; band++) {
        check_holes(150, band);
    }
}

/* Products with rows and columns against plain sums of at most 40 numbers, to rounding. */
static void test_products(void **unused) {
    (void)unused;
    double A[40 * 13], x[40], y[40], by[13], sum;
    for (int n = 1; n <= 40; n++) {
        for (int count = 1; count <= 13; count++) {
            for (int i = 0; i < n * count; i++) {
                A[i] = uniform();
            }
            for (int i = 0; i < 40; i++) {
                x[i] = uniform(), y[i] = 1, by[i % 13] = uniform();
            }
            spari_linear_add_rows(n, count, A, -0.5, x, y);
            for (int k = 0; k < count; k++) {
                sum = 1;
                for (int i = 0; i < n; i++) {
                    sum -= 0.5 * A[n * k + i] * x[i];
                }
                assert_true(fabs(y[k] - sum) < 1e-14);
            }
            assert_true(y[count] == 1);
            for (int i = 0; i < 40; i++) {
                y[i] = 1;
            }
            spari_linear_less_columns(n, count, A, by, y);
            for (int i = 0; i < n; i++) {
                sum = 1;
                for (int k = 0; k < count; k++) {
                    sum -= A[n * k + i] * by[k];
                }
                assert_true(fabs(y[i] - sum) < 1e-14);
            }
            assert_true(n == 40 || y[n] == 1);
        }
    }
}

/* A solution that is not finite is said so. */
static void test_not_finite(void **unused) {
    (void)unused;
    const double S[4] = {1, 2, 3, 4};
    double x[2] = {INFINITY, 1};
    spari_linear *s = spari_linear_create(1, 2, 0);
    spari_linear_add(s, 0, S);
    assert_int_equal(spari_linear_factor(s), 0);
    assert_int_equal(spari_linear_solve(s, x), 1);
    spari_linear_free(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_dense),    cmocka_unit_test(test_band),       cmocka_unit_test(test_holes),
        cmocka_unit_test(test_products), cmocka_unit_test(test_not_finite),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
