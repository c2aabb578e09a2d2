/* Linear systems: factors and back-substitution, dense and banded, of members and of any entries. Oracle: what the
   solution leaves of the system, |A x - b| <= 1e-13 n max|A| max|x|, as Gaussian elimination with exchanges of rows
   leaves unless pivots grow (Wilkinson's bound with a growth of one digit); A is kept by the test itself. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#include "algebra/linear.h"
#include "base/thread_pool.h"

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
/* The first unknowns held, as a root is: they are left out of what is factored. Beside the same matrix of which nobody
   says where elements overlap, so that none is. Saved factors give the same bits after loading, from either. */
static void check_held(int n, int held) {
    spari_linear *s[3] = {spari_linear_create(1, n, 6), spari_linear_create(1, n, 0), spari_linear_create(1, n, 6)};
    double *S = calloc((size_t)(n * n), sizeof *S), x[3][MOST], b[MOST], left, most = 0;
    double *state = calloc((size_t)spari_linear_state_size(s[0]), sizeof *state);
    for (int i = 0; i < n * n; i++) {
        S[i] = uniform();
    }
    for (int i = 0; i < n; i++) {
        b[i] = x[0][i] = x[1][i] = x[2][i] = uniform();
    }
    for (int k = 0; k < 2; k++) {
        spari_linear_zero(s[k]);
        spari_linear_add(s[k], 0, S);
        for (int i = held - 1; i >= 0; i--) {
            spari_linear_fix(s[k], i);
        }
        assert_int_equal(spari_linear_factor(s[k]), 0);
        assert_int_equal(spari_linear_solve(s[k], x[k]), 0);
    }
    assert_int_equal(spari_linear_sign(s[0]), spari_linear_sign(s[1]));
    for (int i = 0; i < n; i++) {
        most = fmax(most, fabs(x[0][i]));
    }
    for (int i = 0; i < n; i++) {
        left = -b[i];
        for (int j = 0; j < n; j++) {
            left += (i < held || j < held ? i == j : S[n * i + j]) * x[0][j];
        }
        assert_true(fabs(left) <= 1e-13 * n * most);
        assert_true(i >= held || x[0][i] == b[i]);
    }
    for (int k = 0; k < 2; k++) {
        spari_linear_save(s[k], state);
        assert_true(spari_linear_is_state(s[2], state));
        spari_linear_load(s[2], state);
        memcpy(x[2], b, sizeof x[2]);
        assert_int_equal(spari_linear_solve(s[2], x[2]), 0);
        for (int i = 0; i < n; i++) {
            assert_true(x[2][i] == x[k][i]);
        }
        assert_int_equal(spari_linear_sign(s[2]), spari_linear_sign(s[k]));
    }
    x[2][0] = NAN;
    assert_int_equal(spari_linear_solve(s[2], x[2]), 1);
    if (held == 6) { /* identity rows may fill the matrix: none of them is exchanged with a row of an unknown */
        spari_linear_save(s[0], state);
        double *first_swap = state + spari_linear_state_size(s[0]) - n;
        first_swap[0] = n - held + 1;
        assert_int_equal(spari_linear_is_state(s[0], state), first_swap[-1] == 0);
    }
    for (int k = 0; k < 3; k++) {
        spari_linear_free(s[k]);
    }
    free(S);
    free(state);
}

static void test_held(void **unused) {
    (void)unused;
    for (int n = 7; n <= 84; n++) {
        check_held(n, 6);
        check_held(n, n % 6);
        check_held(n, n < 12 ? n : 12);
    }
}

static void test_band(void **unused) {
    (void)unused;
    for (int block = 2; block <= 18; block++) {
        for (int elements = 2; elements < 10; elements++) {
            check_system(elements, block, block > 6 ? 6 : block / 2);
        }
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

/* ---- long chains, cut in their middle ---- */

/* A chain of random blocks, and all its entries A [n][n]; unknown `held` is taken out. */
typedef struct long_chain {
    int n, block, overlap;
    double *A;
    spari_linear *s;
} long_chain;

static long_chain chain_create(int elements, int block, int overlap, int held) {
    int n = elements * (block - overlap) + overlap;
    long_chain c = {n, block, overlap, calloc((size_t)n * (size_t)n, sizeof(double)),
                    spari_linear_create(elements, block, overlap)};
    double *S = calloc((size_t)(block * block), sizeof *S);
    for (int e = 0; e < elements; e++) {
        for (int i = 0; i < block * block; i++) {
            S[i] = uniform();
            c.A[n * (e * (block - overlap) + i / block) + e * (block - overlap) + i % block] += S[i];
        }
        spari_linear_add(c.s, e, S);
    }
    for (int i = 0; i < n; i++) {
        c.A[n * i + held] = c.A[n * held + i] = i == held;
    }
    spari_linear_fix(c.s, held);
    free(S);
    return c;
}

static void chain_free(long_chain *c) {
    spari_linear_free(c->s);
    free(c->A);
}

/* Sign of the determinant, by plain elimination; destroys the entries. */
static int sign_of(const long_chain *c) {
    int n = c->n, sign = 1;
    for (int k = 0; k < n; k++) {
        int p = k;
        for (int i = k + 1; i < n; i++) {
            p = fabs(c->A[n * i + k]) > fabs(c->A[n * p + k]) ? i : p;
        }
        for (int j = k; j < n && p != k; j++) {
            double there = c->A[n * k + j];
            c->A[n * k + j] = c->A[n * p + j], c->A[n * p + j] = there;
        }
        sign = (c->A[n * k + k] < 0) != (p != k) ? -sign : sign;
        for (int i = k + 1; i < n && i < k + 2 * c->block; i++) {
            double f = c->A[n * i + k] / c->A[n * k + k];
            for (int j = k; j < n && j < k + 2 * c->block; j++) {
                c->A[n * i + j] -= f * c->A[n * k + j];
            }
        }
    }
    return sign;
}

/* What x leaves of A x - b, of n max|A| max|x|. */
static double left_of(const long_chain *c, const double *x, const double *b) {
    double left = 0, big = 0, most = 0;
    for (int i = 0; i < c->n; i++) {
        double sum = -b[i];
        for (int j = 0; j < c->n; j++) {
            sum += c->A[c->n * i + j] * x[j];
            big = fmax(big, fabs(c->A[c->n * i + j]));
        }
        left = fmax(left, fabs(sum));
        most = fmax(most, fabs(x[i]));
    }
    return left / (c->n * big * most);
}

/* ---- chains whose elements have unknowns to themselves, which are taken out first ---- */

/* Rows and columns as they were put in; what is left of A x = b, a digit more where the last pivots of an element,
   which have its rows alone to choose from, are small; the sign of the determinant. */
static void check_chain(int elements, int block, int overlap, int held) {
    long_chain c = chain_create(elements, block, overlap, held);
    double *x = calloc(4 * (size_t)c.n, sizeof *x), *b = x + c.n, *row = b + c.n, *column = row + c.n;
    for (int i = 0; i < c.n; i++) {
        b[i] = x[i] = uniform();
        spari_linear_read(c.s, i, row, column);
        for (int j = 0; j < c.n; j++) {
            assert_true(fabs(row[j] - c.A[c.n * i + j]) < 1e-15 && fabs(column[j] - c.A[c.n * j + i]) < 1e-15);
        }
    }
    assert_int_equal(spari_linear_factor(c.s), 0);
    assert_int_equal(spari_linear_solve(c.s, x), 0);
    assert_true(left_of(&c, x, b) <= 1e-12);
    assert_int_equal(spari_linear_sign(c.s), sign_of(&c));
    chain_free(&c);
    free(x);
}

/* Many elements without unknowns of their own; held at an end, at a joint and beside it. */
static void test_long_chains(void **unused) {
    (void)unused;
    for (int elements = 64; elements < 68; elements++) {
        for (int block = 2; block <= 18; block += 4) {
            int overlap = block > 6 ? 6 : block / 2, joint = elements / 2 * (block - overlap), end = joint + overlap;
            check_chain(elements, block, overlap, 0);
            check_chain(elements, block, overlap, joint);
            check_chain(elements, block, overlap, end - 1);
            check_chain(elements, block, overlap, end + 3);
        }
    }
}

/* Few elements and many, every remainder of columns that are an element's own; held at an end, within an element, at a
   joint. */
static void test_elements(void **unused) {
    (void)unused;
    for (int own = 12; own <= 40; own += own < 20 ? 1 : 7) {
        for (int elements = 2; elements < 6; elements++) {
            int step = own + 6;
            check_chain(elements, own + 12, 6, 0);
            check_chain(elements, own + 12, 6, step + 8);
            check_chain(elements, own + 12, 6, step + 2);
            check_chain(elements, own + 12, 6, step * elements + 5);
        }
    }
    check_chain(20, 24, 6, 3);
    check_chain(35, 9, 2, 35);
    check_chain(70, 4, 1, 105);
}

/* Any number of threads, and factors that have been saved: the same bits. */
static void check_threads(int block) {
    enum { COUNT = 70, OVERLAP = 6, WIDE = 24, MOST_OF_X = COUNT * (WIDE - OVERLAP) + OVERLAP };
    int n = COUNT * (block - OVERLAP) + OVERLAP;
    double first[MOST_OF_X], x[MOST_OF_X] = {0};
    for (int threads = 1; threads <= 4; threads++) {
        srand(7);
        spari_thread_pool *pool = threads > 1 ? spari_thread_pool_create(threads) : NULL;
        long_chain c = chain_create(COUNT, block, OVERLAP, 0), d = chain_create(COUNT, block, OVERLAP, 0);
        spari_linear_share(c.s, &pool);
        for (int i = 0; i < n; i++) {
            x[i] = sin(i);
        }
        assert_int_equal(spari_linear_factor(c.s), 0);
        assert_int_equal(spari_linear_solve(c.s, x), 0);
        if (threads == 1) {
            memcpy(first, x, sizeof x);
        }
        assert_memory_equal(first, x, sizeof x);
        int64_t size = spari_linear_state_size(c.s);
        double *state = malloc((size_t)size * sizeof *state);
        spari_linear_save(c.s, state);
        assert_true(spari_linear_is_state(d.s, state));
        spari_linear_load(d.s, state);
        for (int i = 0; i < n; i++) {
            x[i] = sin(i);
        }
        assert_int_equal(spari_linear_solve(d.s, x), 0);
        assert_memory_equal(first, x, sizeof x);
        state[size - 1] = n; /* the last row went where there is none */
        assert_false(spari_linear_is_state(d.s, state));
        free(state);
        chain_free(&c);
        chain_free(&d);
        spari_thread_pool_free(pool);
    }
}

static void test_threads_of_chain(void **unused) {
    (void)unused;
    check_threads(18);
    check_threads(24);
}

/* Springs in a row, whose pivots are exact: singular with both ends free, and so is the chain with an element
   missing; not a number, a solution beyond the numbers; definite or not. Elements of as many springs, the last of
   another stiffness. */
static int springs(int each, int missing, double of_last, int held, int *definite) {
    enum { MANY = 64, FEW = 3, ALL = MANY * FEW };
    const int n = MANY * each;
    spari_linear *s = spari_linear_create(MANY, each + 1, 1);
    double x[ALL + 1];
    assert_int_equal(spari_linear_watch(s), 0);
    for (int e = 0; e < MANY; e++) {
        double S[(FEW + 1) * (FEW + 1)] = {0};
        for (int k = 0; k < each && e != missing; k++) {
            double stiffness = e == MANY - 1 && k == each - 1 ? of_last : 1, *at = S + (each + 2) * k;
            at[0] += stiffness, at[1] -= stiffness, at[each + 1] -= stiffness, at[each + 2] += stiffness;
        }
        spari_linear_add(s, e, S);
    }
    if (held >= 0) {
        spari_linear_fix(s, held);
    }
    *definite = spari_linear_definite(s);
    int bad = spari_linear_factor(s);
    for (int i = 0; i <= n; i++) { /* pulled at its last end: a mass's way is that of the springs before it */
        x[i] = i == n;
    }
    if (!bad) {
        assert_int_equal(spari_linear_solve(s, x), 0);
        for (int i = 0; i <= n && held == 0; i++) {
            assert_true(fabs(x[i] - (i == n ? i - 1 + 1 / of_last : i)) < 3e-16 * n * n * n); /* times its condition */
        }
        x[n - 5] = INFINITY;
        assert_int_equal(spari_linear_solve(s, x), 1);
    }
    spari_linear_free(s);
    return bad;
}

static void test_springs(void **unused) {
    (void)unused;
    int definite;
    for (int each = 1; each <= 3; each += 2) {
        assert_int_equal(springs(each, -1, 1, 0, &definite), 0);
        assert_int_equal(definite, 1);
        assert_int_equal(springs(each, -1, 1, 32 * each, &definite), 0);
        assert_int_equal(springs(each, -1, -3, 0, &definite), 0);
        assert_int_equal(definite, 0);
        assert_int_equal(each == 1 ? springs(each, -1, 1, -1, &definite) : 1, 1); /* of three, pivots are thirds */
        assert_int_equal(springs(each, 10, 1, 0, &definite), 1);
        assert_int_equal(springs(each, 50, 1, 0, &definite), 1);
        assert_int_equal(springs(each, -1, NAN, 0, &definite), 1);
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

/* Six unknowns in turn, displacements and rotations, in metres and in units of a nanometre (2^-30, so that nothing is
   rounded): the same solution, to the bit, as long as rows are weighed. Rows as they are would be exchanged otherwise
   where forces and moments have other units. */
static void check_units(int elements, int block) {
    const double unit = 0x1p-30;
    double *S = calloc((size_t)(block * block), sizeof *S), x[2][MOST];
    spari_linear *s[2] = {spari_linear_create(elements, block, 6), spari_linear_create(elements, block, 6)};
    const int n = elements * (block - 6) + 6;
    assert_int_equal(spari_linear_weigh(s[0], 1), 0);
    assert_int_equal(spari_linear_weigh(s[1], 1 / unit), 0);
    for (int k = 0; k < 2; k++) {
        spari_linear_zero(s[k]);
    }
    for (int e = 0; e < elements; e++) {
        for (int i = 0; i < block * block; i++) {
            S[i] = uniform();
        }
        spari_linear_add(s[0], e, S);
        for (int i = 0; i < block * block; i++) {
            S[i] *= (i / block % 6 < 3 ? 1 : unit) / (i % block % 6 < 3 ? unit : 1);
        }
        spari_linear_add(s[1], e, S);
    }
    for (int i = 0; i < n; i++) {
        x[0][i] = uniform();
        x[1][i] = x[0][i] * (i % 6 < 3 ? 1 : unit);
    }
    for (int k = 0; k < 2; k++) {
        assert_int_equal(spari_linear_factor(s[k]), 0);
        assert_int_equal(spari_linear_solve(s[k], x[k]), 0);
        spari_linear_free(s[k]);
    }
    for (int i = 0; i < n; i++) {
        assert_true(x[1][i] == x[0][i] * (i % 6 < 3 ? unit : 1));
    }
    free(S);
}

static void test_units(void **unused) {
    (void)unused;
    check_units(1, 30);
    check_units(3, 18); /* a band */
    check_units(3, 36); /* elements with unknowns to themselves */
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_dense),
        cmocka_unit_test(test_band),
        cmocka_unit_test(test_long_chains),
        cmocka_unit_test(test_springs),
        cmocka_unit_test(test_threads_of_chain),
        cmocka_unit_test(test_elements),
        cmocka_unit_test(test_products),
        cmocka_unit_test(test_not_finite),
        cmocka_unit_test(test_held),
        cmocka_unit_test(test_units),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
