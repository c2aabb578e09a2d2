/* Sparse matrices of blocks, some tied to others, against a dense solution of all equations: those of the blocks with
   the forces of the ties, and those of the ties. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#include "algebra/block_matrix.h"
#include "algebra/eigen.h"
#include "spar/spar.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SIX = 6, BODIES = 7, LOOPS = 2, BLOCKS = BODIES + LOOPS, MOST = BODIES * 12 + LOOPS * 3 };

static double uniform(void) {
    return 2.0 * rand() / RAND_MAX - 1.0;
}

/* Bodies in a tree, tied to their parents, and blocks that couple bodies far apart, of which the parents are eliminated
   after both. A: all equations, [rows][rows]. */
typedef struct scene {
    int size[BLOCKS], parent[BODIES], rows, held;
    spari_block_tie tie[BLOCKS];
    spari_block_pair coupled[64], before[64];
    int pairs, befores;
    spari_blocks *matrix;
    double A[MOST][MOST];
} scene;

static void couple(scene *s, int a, int b) {
    s->coupled[s->pairs++] = (spari_block_pair){a, b};
}

static void put(scene *s, int a, int b, int i, int j, double value) {
    int stride;
    double *at = spari_blocks_at(s->matrix, a, b, &stride);
    at[i * stride + j] += value;
    s->A[spari_blocks_first(s->matrix, a) + i][spari_blocks_first(s->matrix, b) + j] += value;
}

/* Inverse of A [3][3]. */
static void invert(double A[3][3], double E[9]) {
    double det = 0;
    for (int i = 0; i < 9; i++) {
        int r = i / 3, c = i % 3, r1 = (r + 1) % 3, r2 = (r + 2) % 3, c1 = (c + 1) % 3, c2 = (c + 2) % 3;
        E[3 * c + r] = A[r1][c1] * A[r2][c2] - A[r1][c2] * A[r2][c1];
        det += r == 0 ? A[0][c] * E[3 * c] : 0;
    }
    for (int i = 0; i < 9; i++) {
        E[i] /= det;
    }
}

/* Component k of a rigid motion with the unit displacement or rotation i: by row k of G, of what moves at the point. */
static double component_of(double G[2][3][3], const double arm[3], int k, int i) {
    double at[2][3] = {{0}};
    at[i / 3][i % 3] = 1;
    for (int n = 0; n < 3 && i >= 3; n++) { /* the displacement at the point: t x (-arm) */
        int y = (n + 1) % 3, z = (n + 2) % 3;
        at[0][n] -= at[1][y] * arm[z] - at[1][z] * arm[y];
    }
    double sum = 0;
    for (int n = 0; n < 3; n++) {
        sum += G[k / 3][k % 3][n] * at[k / 3][n];
    }
    return sum;
}

static void tie_body(scene *s, int b) {
    spari_tie *tie = spari_blocks_tie(s->matrix, b);
    const spari_block_tie *how = s->tie + b;
    int own = spari_blocks_first(s->matrix, b), row = own + SIX;
    double G[2][3][3];
    for (int part = 0; part < 2; part++) {
        for (int i = 0; i < 9; i++) {
            G[part][i / 3][i % 3] = (i % 4 == 0) + (how->held[part] ? 0.3 * uniform() : 0);
        }
        invert(G[part], tie->basis[part]);
    }
    for (int k = 0; k < 3; k++) {
        tie->arm[k] = 2 * uniform();
    }
    for (int k = 0, n = 0; k < SIX; k++) {
        if (k % 3 >= how->held[k / 3]) {
            continue;
        }
        for (int i = 0; i < SIX; i++) {
            double of_body = component_of(G, tie->arm, k, i);
            s->A[row + n][own + i] = of_body;
            s->A[own + i][row + n] = -of_body;
            tie->rows[n][i] = 0.5 * uniform();
            if (how->to >= 0) {
                int to = spari_blocks_first(s->matrix, how->to);
                s->A[row + n][to + i] = tie->rows[n][i];
                s->A[to + i][row + n] = -tie->rows[n][i];
            }
        }
        n++;
    }
}

/* Entries, symmetric or not; `inertia` on the diagonal. */
static void fill(scene *s, int symmetric, double inertia) {
    spari_blocks_zero(s->matrix);
    for (int p = 0; p < s->pairs; p++) {
        int a = s->coupled[p].a, b = s->coupled[p].b;
        if (rand() % 4 == 0) { /* none after all */
            continue;
        }
        for (int n = 0; n < s->size[a] * s->size[b]; n++) {
            int i = n / s->size[b], j = n % s->size[b];
            double x = uniform(), y = symmetric ? x : uniform();
            put(s, a, b, i, j, x);
            put(s, b, a, j, i, y);
        }
    }
    for (int b = 0; b < BLOCKS; b++) {
        for (int i = 0; i < s->size[b]; i++) {
            put(s, b, b, i, i, b < BODIES ? inertia * (1 + 0.5 * uniform()) : -1);
            for (int j = 0; j < i && b < BODIES; j++) {
                double x = uniform(), y = symmetric ? x : uniform();
                put(s, b, b, i, j, x);
                put(s, b, b, j, i, y);
            }
        }
    }
    for (int b = 0; b < BODIES; b++) {
        if (s->tie[b].held[0] + s->tie[b].held[1] > 0) {
            tie_body(s, b);
        }
    }
}

/* Ties that hold `held` components each; 0: of any number. sparse: pairs have no entries but those of loops. */
static scene *begin(int held, int sparse) {
    scene *s = calloc(1, sizeof *s);
    assert_non_null(s);
    for (int b = 0; b < BODIES; b++) {
        int count = held ? held : 1 + rand() % SIX;
        s->size[b] = SIX;
        s->parent[b] = b == 0 ? -1 : rand() % b;
        s->tie[b] = (spari_block_tie){{0, 0}, s->parent[b]};
        int least = count > 3 ? count - 3 : 0, most = count < 3 ? count : 3;
        if (b > 0 || rand() % 2) {
            s->tie[b].held[0] = least + rand() % (most - least + 1);
            s->tie[b].held[1] = count - s->tie[b].held[0];
        }
        s->held += s->tie[b].held[0] + s->tie[b].held[1];
        if (b > 0) {
            if (!sparse || rand() % 2) {
                couple(s, b, s->parent[b]);
            }
            s->before[s->befores++] = (spari_block_pair){b, s->parent[b]};
        }
    }
    for (int l = BODIES; l < BLOCKS; l++) {
        int a = rand() % BODIES, b = rand() % BODIES;
        s->size[l] = 1 + rand() % 3;
        couple(s, a, l);
        couple(s, b, l);
        for (int c = 0; c < BODIES; c++) {
            s->before[s->befores++] = (spari_block_pair){c, l};
        }
    }
    s->matrix = spari_blocks_create(BLOCKS, s->size, s->tie, s->pairs, s->coupled, s->befores, s->before);
    assert_non_null(s->matrix);
    s->rows = spari_blocks_rows(s->matrix);
    return s;
}

static void end(scene *s) {
    spari_blocks_free(s->matrix);
    free(s);
}

/* x := A^-1 x by elimination with row exchanges. */
static void solve_dense(const scene *s, double *x) {
    static double A[MOST][MOST];
    int n = s->rows;
    memcpy(A, s->A, sizeof A);
    for (int k = 0; k < n; k++) {
        int best = k;
        for (int i = k; i < n; i++) {
            best = fabs(A[i][k]) > fabs(A[best][k]) ? i : best;
        }
        for (int j = 0; j < n; j++) {
            double kept = A[k][j];
            A[k][j] = A[best][j], A[best][j] = kept;
        }
        double kept = x[k];
        x[k] = x[best], x[best] = kept;
        for (int i = k + 1; i < n; i++) {
            double f = A[i][k] / A[k][k];
            for (int j = k; j < n; j++) {
                A[i][j] -= f * A[k][j];
            }
            x[i] -= f * x[k];
        }
    }
    for (int k = n - 1; k >= 0; k--) {
        for (int j = k + 1; j < n; j++) {
            x[k] -= A[k][j] * x[j];
        }
        x[k] /= A[k][k];
    }
}

static void test_ties_against_dense(void **state) {
    (void)state;
    srand(7);
    for (int trial = 0; trial < 140; trial++) {
        scene *s = begin(trial % 7, trial % 2);
        double x[2][MOST], both[2 * MOST], dense[MOST];
        fill(s, 0, 8);
        assert_int_equal(spari_blocks_factor(s->matrix), 0);
        double least[2];
        spari_blocks_least_pivots(s->matrix, least);
        assert_true(least[0] > 0 && least[1] > 0);
        for (int i = 0; i < s->rows; i++) {
            both[2 * i] = x[0][i] = uniform();
            both[2 * i + 1] = x[1][i] = uniform();
        }
        memcpy(dense, x[0], sizeof dense);
        solve_dense(s, dense);
        double size = 0;
        for (int i = 0; i < s->rows; i++) {
            size = fmax(size, fabs(dense[i]));
        }
        for (int c = 0; c < 2; c++) {
            assert_int_equal(spari_blocks_solve(s->matrix, 1, x[c]), 0);
        }
        assert_int_equal(spari_blocks_solve(s->matrix, 2, both), 0);
        for (int i = 0; i < s->rows; i++) {
            assert_true(fabs(x[0][i] - dense[i]) <= 1e-9 * size);
            assert_memory_equal(&x[0][i], &both[2 * i], sizeof(double));
            assert_memory_equal(&x[1][i], &both[2 * i + 1], sizeof(double));
        }
        end(s);
    }
}

/* The eigenvalues of all equations, of which each held component has a pair of both signs. */
static void test_negative_eigenvalues(void **state) {
    (void)state;
    static double A[MOST * MOST], mu[MOST], workspace[SPARI_SYMMETRIC_ROOM(MOST)];
    srand(11);
    int some = 0;
    for (int trial = 0; trial < 70; trial++) {
        scene *s = begin(trial % 7, trial % 2);
        int n = s->rows, negative = 0;
        spari_blocks_watch(s->matrix, 1);
        fill(s, 1, trial % 3 ? 2 : 9);
        assert_int_equal(spari_blocks_factor(s->matrix), 0);
        for (int b = 0; b < BODIES; b++) { /* the rows of ties with the sign of their columns */
            for (int i = SIX; i < SIX + s->tie[b].held[0] + s->tie[b].held[1]; i++) {
                for (int j = 0; j < n; j++) {
                    s->A[spari_blocks_first(s->matrix, b) + i][j] *= -1;
                }
            }
        }
        for (int i = 0; i < n * n; i++) {
            A[i] = s->A[i / n][i % n];
            assert_true(fabs(A[i] - s->A[i % n][i / n]) <= 1e-14);
        }
        assert_int_equal(spari_symmetric(n, A, mu, workspace), SPAR_OK);
        for (int i = 0; i < n; i++) {
            negative += mu[i] < 0;
        }
        assert_int_equal(spari_blocks_negative(s->matrix), negative - s->held);
        some += negative - s->held > 2;
        end(s);
    }
    assert_true(some > 10);
}

/* A hinge about which nothing resists. */
static void test_free_component(void **state) {
    (void)state;
    const int size = SIX;
    const spari_block_tie how = {{3, 2}, -1};
    spari_blocks *m = spari_blocks_create(1, &size, &how, 0, NULL, 0, NULL);
    assert_non_null(m);
    for (int resists = 0; resists < 2; resists++) {
        int stride;
        spari_blocks_zero(m);
        double *D = spari_blocks_at(m, 0, 0, &stride);
        spari_tie *tie = spari_blocks_tie(m, 0);
        for (int i = 0; i < 5 + resists; i++) {
            D[(stride + 1) * i] = 2;
        }
        memset(tie->arm, 0, sizeof tie->arm);
        for (int i = 0; i < 18; i++) {
            tie->basis[i / 9][i % 9] = i % 9 % 4 == 0;
        }
        assert_int_equal(spari_blocks_factor(m), !resists);
        double least[2];
        spari_blocks_least_pivots(m, least);
        assert_true(fmin(least[0], least[1]) == (resists ? 2 : 0));
    }
    double x[SIX + 5] = {1, 1, 1, 1, 1, 1, 0.5};
    assert_int_equal(spari_blocks_rows(m), SIX + 5);
    assert_int_equal(spari_blocks_solve(m, 1, x), 0);
    /* displaced by the gap, and rotated by the free moment; the tie's forces balance the others */
    const double expected[SIX + 5] = {0.5, 0, 0, 0, 0, 0.5, 0, -1, -1, -1, -1};
    for (int i = 0; i < SIX + 5; i++) {
        assert_true(fabs(x[i] - expected[i]) < 1e-15);
    }
    spari_blocks_free(m);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_ties_against_dense),
        cmocka_unit_test(test_negative_eigenvalues),
        cmocka_unit_test(test_free_component),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
