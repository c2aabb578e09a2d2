/* Lowest modes of sparse pencils with constraints, against dense solutions, closed forms and residuals. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#include "algebra/eigen.h"
#include "algebra/lowest_modes.h"
#include "algebra/shifted.h"
#include "spar/spar.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { B = 6 };

static double uniform(void) {
    return 2.0 * rand() / RAND_MAX - 1.0;
}

static void *zeros(size_t n, size_t size) {
    void *x = calloc(n, size);
    assert_non_null(x);
    return x;
}

/* A pencil with its blocks of six unknowns, and the same matrices as the test keeps them, K and M [n][n]. */
typedef struct scene {
    int n, *block;
    double *K, *M;
    spari_pencil p;
} scene;

static scene begin(int n) {
    scene s = {n,
               zeros((size_t)n, sizeof(int)),
               zeros((size_t)(n * n), sizeof(double)),
               zeros((size_t)(n * n), sizeof(double)),
               {0}};
    assert_int_equal(spari_pencil_create(&s.p, n), SPAR_OK);
    for (int i = 0; i < n; i++) {
        s.block[i] = i / B;
    }
    return s;
}

static void end(scene *s) {
    spari_pencil_free(&s->p);
    free(s->block);
    free(s->K);
    free(s->M);
}

static void put(scene *s, int i, int j, double k, double m) {
    spari_pencil_put(&s->p, (spari_pencil_entry){i, j, k, 0, m});
    s->K[s->n * i + j] += k;
    s->M[s->n * i + j] += m;
}

static void spring(scene *s, int i, int j, double k) {
    put(s, i, i, k, 0);
    put(s, j, j, k, 0);
    put(s, i, j, -k, 0);
    put(s, j, i, -k, 0);
}

static int solve(scene *s, int n, double *square, double *x, int *available) {
    const spari_modes_problem problem = {&s->p, s->block, 0, NULL};
    return spari_lowest_modes(&problem, n, square, x, available);
}

/* y^T A x */
static double product(const scene *s, const double *A, const double *y, const double *x) {
    double sum = 0;
    for (int i = 0; i < s->n; i++) {
        for (int j = 0; j < s->n; j++) {
            sum += y[i] * A[s->n * i + j] * x[j];
        }
    }
    return sum;
}

/* Unit modal mass and orthogonality within 1e-10. */
static void check_orthonormal(const scene *s, int n, const double *x) {
    for (int i = 0; i < n; i++) {
        for (int j = 0; j <= i; j++) {
            assert_true(fabs(product(s, s->M, x + s->n * i, x + s->n * j) - (i == j)) < 1e-10);
        }
    }
}

/* Random blocks in a chain, stiffness of rank 7 a pair of blocks (so that some motions are loose), random masses. Block
   0 is tied to block 3, 3 to 7 and 8 to 1, by random matrices: x_b = R x_a. The tie of 3 and 7 comes twice, the second
   time as other combinations of its rows. Oracle: the dense problem in the unknowns of the other blocks, x = T y,
   T^T K T against T^T M T = L L^T. The residual K x - omega^2 M x must vanish in these unknowns too. omega^2 within
   1e-9 of the largest one asked; residual 1e-8 of the stiffness. */
enum { BLOCKS = 10, ALL = B * BLOCKS, LEFT = B * (BLOCKS - 3) };

static void add_random(scene *s) {
    for (int b = 0; b < BLOCKS; b++) {
        for (int i = 0; i < B; i++) {
            put(s, B * b + i, B * b + i, 0, 1 + 0.5 * uniform());
        }
        for (int rank = 0; rank < 7 && b + 1 < BLOCKS; rank++) {
            double v[2 * B], k = pow(10, 2 * uniform());
            for (int i = 0; i < 2 * B; i++) {
                v[i] = uniform();
            }
            for (int i = 0; i < 4 * B * B; i++) {
                put(s, B * b + i / (2 * B), B * b + i % (2 * B), k * v[i / (2 * B)] * v[i % (2 * B)], 0);
            }
        }
    }
}

/* Rows A (R x_a - x_b) = 0 */
static void tie(scene *s, int a, int b, double R[B][B], int mix) {
    for (int r = 0; r < B; r++) {
        double A[B] = {0};
        for (int i = 0; i < B; i++) {
            A[i] = mix ? uniform() : i == r;
        }
        for (int c = 0; c < B; c++) {
            double sum = 0;
            for (int i = 0; i < B; i++) {
                sum += A[i] * R[i][c];
            }
            spari_pencil_add_constraint(&s->p, (spari_pencil_constraint){s->p.constraints, B * a + c, sum});
            spari_pencil_add_constraint(&s->p, (spari_pencil_constraint){s->p.constraints, B * b + c, -A[c]});
        }
        s->p.constraints++;
    }
}

static void random_matrix(double R[B][B]) {
    for (int i = 0; i < B * B; i++) {
        R[i / B][i % B] = 0.3 * uniform() + (i / B == i % B);
    }
}

/* T [ALL][LEFT] of the ties 0-3 (R), 3-7 (S) and 8-1 (P): x_3 = R x_0, x_7 = S R x_0, x_1 = P x_8 */
static void make_T(double R[B][B], double S[B][B], double P[B][B], double *T) {
    static const int from[BLOCKS] = {0, 6, 1, 0, 2, 3, 4, 0, 6, 5}; /* reduced block of each */
    for (int b = 0; b < BLOCKS; b++) {
        for (int i = 0; i < B; i++) {
            for (int j = 0; j < B; j++) {
                double sum = b == 1 ? P[i][j] : b == 3 ? R[i][j] : i == j;
                for (int l = 0; l < B && b == 7; l++) {
                    sum = (l ? sum : 0) + S[i][l] * R[l][j];
                }
                T[(B * b + i) * LEFT + B * from[b] + j] = sum;
            }
        }
    }
}

/* C [LEFT][LEFT] := T^T A T */
static void reduce(const double *T, const double *A, double *C) {
    double *half = zeros(ALL * LEFT, sizeof *half);
    for (int i = 0; i < ALL; i++) {
        for (int j = 0; j < ALL; j++) {
            for (int c = 0; c < LEFT; c++) {
                half[LEFT * i + c] += A[ALL * i + j] * T[LEFT * j + c];
            }
        }
    }
    memset(C, 0, LEFT * LEFT * sizeof *C);
    for (int i = 0; i < ALL; i++) {
        for (int r = 0; r < LEFT; r++) {
            for (int c = 0; c < LEFT; c++) {
                C[LEFT * r + c] += T[LEFT * i + r] * half[LEFT * i + c];
            }
        }
    }
    free(half);
}

/* Eigenvalues mu of C x = mu D x, D positive definite: with D = V V^T by its own eigenvectors. */
static void dense_eigenvalues(double *C, double *D, double *mu) {
    double *work = zeros(SPARI_SYMMETRIC_ROOM(LEFT), sizeof *work), *half = zeros(LEFT * LEFT, sizeof *half), d[LEFT];
    assert_int_equal(spari_symmetric(LEFT, D, d, work), SPAR_OK);
    for (int i = 0; i < LEFT; i++) {
        for (int j = 0; j < LEFT; j++) {
            for (int l = 0; l < LEFT; l++) {
                half[LEFT * i + j] += D[LEFT * i + l] * C[LEFT * l + j] / sqrt(d[i]);
            }
        }
    }
    memset(C, 0, LEFT * LEFT * sizeof *C);
    for (int i = 0; i < LEFT; i++) {
        for (int j = 0; j < LEFT; j++) {
            for (int l = 0; l < LEFT; l++) {
                C[LEFT * i + j] += half[LEFT * i + l] * D[LEFT * j + l] / sqrt(d[j]);
            }
        }
    }
    assert_int_equal(spari_symmetric(LEFT, C, mu, work), SPAR_OK);
    free(work);
    free(half);
}

/* The operator's largest eigenvalue is 1 / lowest. Its rounding errors, relative to that, become errors of K x by
   square / lowest; the factor: sums over ALL terms (observed: up to 1100). */
static void check_residual(const scene *s, const double *T, double lowest, double square, const double *x) {
    double most = 0, left = 0;
    for (int c = 0; c < LEFT; c++) {
        double sum = 0;
        for (int i = 0; i < ALL; i++) {
            for (int j = 0; j < ALL; j++) {
                sum += T[LEFT * i + c] * (s->K[ALL * i + j] - square * s->M[ALL * i + j]) * x[j];
                most = fmax(most, fabs(T[LEFT * i + c] * s->K[ALL * i + j] * x[j]));
            }
        }
        left = fmax(left, fabs(sum));
    }
    assert_true(left <= (1e-11 + 4096 * DBL_EPSILON * square / lowest) * most);
}

static void test_random(void **state) {
    (void)state;
    static const int wanted[] = {1, 7, 20, LEFT};
    static double x[LEFT * ALL], again[LEFT * ALL], T[ALL * LEFT], C[LEFT * LEFT], D[LEFT * LEFT];
    srand(7);
    for (int pass = 0; pass < 12; pass++) {
        double R[B][B], S[B][B], P[B][B], mu[LEFT], square[LEFT], same[LEFT];
        int n = wanted[pass % 4], available;
        scene s = begin(ALL);
        memset(T, 0, sizeof T);
        random_matrix(R), random_matrix(S), random_matrix(P);
        add_random(&s);
        tie(&s, 0, 3, R, 0);
        tie(&s, 3, 7, S, 0);
        tie(&s, 8, 1, P, 1);
        tie(&s, 3, 7, S, 1);
        make_T(R, S, P, T);
        reduce(T, s.K, C);
        reduce(T, s.M, D);
        dense_eigenvalues(C, D, mu);
        assert_int_equal(solve(&s, n, square, x, &available), SPAR_OK);
        assert_int_equal(available, LEFT);
        for (int k = 0; k < n; k++) {
            assert_true(fabs(square[k] - mu[k]) <= 1e-9 * mu[n - 1] + 1e-9);
            check_residual(&s, T, mu[0], square[k], x + ALL * k);
        }
        check_orthonormal(&s, n, x);
        assert_int_equal(solve(&s, n, same, again, &available), SPAR_OK);
        assert_memory_equal(same, square, (size_t)n * sizeof *same);
        assert_memory_equal(again, x, (size_t)(n * ALL) * sizeof *x);
        assert_int_equal(solve(&s, LEFT + 1, square, x, &available), SPAR_ERR_ARGUMENT);
        end(&s);
    }
}

/* A ring of equal masses: omega^2 = 4 k / m sin^2(pi j / N), j = 0 once, the others twice. Within 1e-10 of 4 k / m. */
static void test_ring(void **state) {
    (void)state;
    enum { N = 120, MODES = 41 };
    const double k = 3, m = 0.5, pi = acos(-1);
    double square[MODES];
    static double x[MODES * N];
    int available;
    scene s = begin(N);
    for (int i = 0; i < N; i++) {
        put(&s, i, i, 0, m);
        spring(&s, i, (i + 1) % N, k);
    }
    assert_int_equal(solve(&s, MODES, square, x, &available), SPAR_OK);
    for (int i = 0; i < MODES; i++) {
        double sine = sin(pi * ((i + 1) / 2) / N);
        assert_true(fabs(square[i] - 4 * k / m * sine * sine) < 1e-10 * 4 * k / m);
    }
    check_orthonormal(&s, MODES, x);
    end(&s);
}

/* Many identical pairs of masses, m - k - m - k - ground: (3 -+ sqrt 5) / 2 k / m, as often as there are pairs. A
   search finds six copies; the count of negative pivots must show that others are missing. */
static void test_identical(void **state) {
    (void)state;
    enum { PAIRS = 50, N = 2 * PAIRS, MODES = 60 };
    const double k = 2, m = 5;
    double square[MODES];
    static double x[MODES * N];
    int available;
    scene s = begin(N);
    for (int i = 0; i < N; i += 2) {
        put(&s, i, i, k, m);
        put(&s, i + 1, i + 1, 0, m);
        spring(&s, i, i + 1, k);
    }
    assert_int_equal(solve(&s, MODES, square, x, &available), SPAR_OK);
    for (int i = 0; i < MODES; i++) {
        assert_true(fabs(square[i] - k / m * (3 + (i < PAIRS ? -1 : 1) * sqrt(5)) / 2) < 1e-12);
    }
    check_orthonormal(&s, MODES, x);
    end(&s);
}

/* Every second unknown without mass: its modes come last, infinite. Here a mass between two springs in a row k = 2 to
   the ground has the stiffness 1 at the end of the row: the masses of a fixed-free chain of springs 2 / 2. */
static void test_massless(void **state) {
    (void)state;
    enum { N = 20 };
    const double pi = acos(-1);
    double square[N], x[N * N];
    int available;
    scene s = begin(N);
    for (int i = 0; i < N; i++) {
        put(&s, i, i, i == 0 ? 2 : 0, i % 2);
        if (i > 0) {
            spring(&s, i - 1, i, 2);
        }
    }
    assert_int_equal(solve(&s, N, square, x, &available), SPAR_OK);
    for (int i = 0; i < N / 2; i++) {
        double sine = sin(pi * (2 * i + 1) / (2 * (N + 1)));
        assert_true(fabs(square[i] - 4 * sine * sine) < 1e-9);
        assert_true(isinf(square[N / 2 + i]));
    }
    check_orthonormal(&s, N / 2, x);
    end(&s);
}

/* omega^2 below 0 come first; without mass they have no shift. */
static void test_negative(void **state) {
    (void)state;
    double square[3], x[9];
    int available;
    scene s = begin(3);
    put(&s, 0, 0, 5, 1);
    put(&s, 1, 1, -3, 1);
    put(&s, 2, 2, 1, 1);
    assert_int_equal(solve(&s, 3, square, x, &available), SPAR_OK);
    assert_true(fabs(square[0] + 3) < 1e-12 && fabs(square[1] - 1) < 1e-12 && fabs(square[2] - 5) < 1e-12);
    end(&s);
    s = begin(2);
    put(&s, 0, 0, 5, 1);
    put(&s, 1, 1, -3, 0);
    assert_int_equal(solve(&s, 1, square, x, &available), SPAR_ERR_STATE);
    end(&s);
}

/* The number of omega^2 below any limit, with constraints and with a reduced mass M - W^T W: diagonal matrices, K = 1,
   2, ..., M = 1; unknowns 3 and 8 are tied (omega^2 = 6.5); W takes 3/4 of the mass of unknown 0 (omega^2 = 4). */
static void test_count(void **state) {
    (void)state;
    enum { N = 12 };
    double W[N] = {sqrt(0.75)};
    scene s = begin(N);
    spari_shifted a;
    for (int i = 0; i < N; i++) {
        put(&s, i, i, i + 1, 1);
    }
    spari_pencil_add_constraint(&s.p, (spari_pencil_constraint){0, 3, 1});
    spari_pencil_add_constraint(&s.p, (spari_pencil_constraint){0, 8, -1});
    s.p.constraints = 1;
    for (int less = 0; less < 2; less++) {
        const double all[N - 1] = {less ? 4 : 1, 2, 3, 5, 6, 7, 8, 6.5, 10, 11, 12};
        assert_int_equal(spari_shifted_create(&a, &s.p, s.block, less, W), SPAR_OK);
        for (double limit = -0.75; limit < 14; limit += 1) {
            int below = 0;
            for (int i = 0; i < N - 1; i++) {
                below += all[i] < limit;
            }
            assert_int_equal(spari_shifted_factor(&a, -limit), 0);
            assert_int_equal(a.below, below);
        }
        spari_shifted_free(&a);
    }
    end(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_random),   cmocka_unit_test(test_ring),     cmocka_unit_test(test_identical),
        cmocka_unit_test(test_massless), cmocka_unit_test(test_negative), cmocka_unit_test(test_count),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
