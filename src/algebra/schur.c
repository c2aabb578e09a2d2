/* Complex Schur form, by LAPACK. GSL has none: without LAPACK Givens rotations reduce the matrix to Hessenberg form,
   and then by QR with Wilkinson shifts (Golub and Van Loan, Matrix Computations, chapter 7). */
#include "schur.h"

#include "../base/status.h"

#include <float.h>
#include <math.h>
#include <stdint.h>

#ifdef SPARI_HAVE_LAPACK
#include "lapack.h"

static void transpose(int n, double complex *A) {
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < i; j++) {
            double complex x = A[(int64_t)n * i + j];
            A[(int64_t)n * i + j] = A[(int64_t)n * j + i];
            A[(int64_t)n * j + i] = x;
        }
    }
}

/* S and Q are stored column by column; room [4 n]. */
static int find_form(int n, double complex *S, double complex *Q, double complex *workspace) {
    int count, bad, size = 2 * n;
    SPARI_BLAS(zgees_("V", "N", NULL, &n, S, &n, &count, workspace, Q, &n, workspace + n, &size,
                      (double *)(workspace + 3 * n), NULL, &bad, 1, 1));
    return bad;
}

/* Moves the largest eigenvalue to the front, then the next. */
static int sort_form(int n, double complex *S, double complex *Q) {
    int bad = 0;
    for (int i = 0; i < n && !bad; i++) {
        int from = i + 1, to = i + 1;
        for (int j = i + 1; j < n; j++) {
            from = cabs(S[(int64_t)(n + 1) * j]) > cabs(S[(int64_t)(n + 1) * (from - 1)]) ? j + 1 : from;
        }
        if (from != to) {
            SPARI_BLAS(ztrexc_("V", &n, S, &n, Q, &n, &from, &to, &bad, 1));
        }
    }
    return bad;
}
#else
/* A rotation of two rows: (c, s; -conj(s), c) (a, b)^T = (r, 0)^T. */
typedef struct schur_turn {
    double c;
    double complex s;
} schur_turn;

static schur_turn turn_onto(double complex a, double complex b) {
    double big = hypot(cabs(a), cabs(b));
    if (!(cabs(b) > 0)) {
        return (schur_turn){1, 0};
    }
    if (!(cabs(a) > 0)) {
        return (schur_turn){0, conj(b) / cabs(b)};
    }
    double complex phase = a / cabs(a);
    return (schur_turn){cabs(a) / big, phase * conj(b) / big};
}

/* Rows i and i + 1, columns [from, n) */
static void schur_rows(int n, double complex *A, int i, int from, schur_turn g) {
    double complex *x = A + (long)n * i, *y = x + n;
    for (int k = from; k < n; k++) {
        double complex a = x[k], b = y[k];
        x[k] = g.c * a + g.s * b;
        y[k] = g.c * b - conj(g.s) * a;
    }
}

/* Columns i and i + 1, rows [0, to), by the conjugate transpose */
static void schur_columns(int n, double complex *A, int i, int to, schur_turn g) {
    for (int k = 0; k < to; k++) {
        double complex *x = A + (long)n * k + i, a = x[0], b = x[1];
        x[0] = g.c * a + conj(g.s) * b;
        x[1] = g.c * b - g.s * a;
    }
}

/* Rotates rows and columns i and i + 1 of A, with the columns of Q, such that entry (i + 1, k) becomes 0. */
static void clear_entry(int n, double complex *A, double complex *Q, int i, int k) {
    double complex *x = A + (long)n * i + k;
    schur_turn g = turn_onto(x[0], x[n]);
    schur_rows(n, A, i, k, g);
    schur_columns(n, A, i, n, g);
    schur_columns(n, Q, i, n, g);
    x[n] = 0;
}

static void to_hessenberg(int n, double complex *A, double complex *Q) {
    for (int i = 0; i < n * n; i++) {
        Q[i] = i % (n + 1) == 0;
    }
    for (int k = 0; k + 2 < n; k++) {
        for (int i = n - 2; i > k; i--) {
            clear_entry(n, A, Q, i, k);
        }
    }
}

/* Eigenvalue of the last 2 x 2 block [.., end] nearest to its last entry; occasionally an exceptional shift. */
static double complex shift_of(int n, const double complex *A, int end, int pass) {
    const double complex *p = A + (long)n * (end - 1) + end - 1, *q = p + n;
    if (pass % 10 == 9) {
        return q[1] + cabs(q[0]);
    }
    double complex half = 0.5 * (p[0] - q[1]), root = csqrt(half * half + p[1] * q[0]);
    double complex near = cabs(half + root) > cabs(half - root) ? half + root : half - root;
    return cabs(near) > 0 ? q[1] - p[1] * q[0] / near : q[1];
}

/* One QR sweep over the rows [begin, end]. */
static void sweep(int n, double complex *A, double complex *Q, int begin, int end, double complex shift) {
    double complex a = A[(long)n * begin + begin] - shift, b = A[(long)n * (begin + 1) + begin];
    for (int i = begin; i < end; i++) {
        schur_turn g = turn_onto(a, b);
        schur_rows(n, A, i, i > begin ? i - 1 : begin, g);
        schur_columns(n, A, i, i + 3 < end + 1 ? i + 3 : end + 1, g);
        schur_columns(n, Q, i, n, g);
        if (i + 1 < end) {
            a = A[(long)n * (i + 1) + i];
            b = A[(long)n * (i + 2) + i];
        }
        if (i > begin) {
            A[(long)n * (i + 1) + i - 1] = 0;
        }
    }
}

static int find_form(int n, double complex *S, double complex *Q, double complex *workspace) {
    enum { PASSES = 60 };
    double largest = 0; /* every sweep leaves rounding of the largest behind */
    for (int i = 0; i < n * n; i++) {
        largest = fmax(largest, cabs(S[i]));
    }
    (void)workspace;
    to_hessenberg(n, S, Q);
    for (int end = n - 1, pass = 0; end > 0;) {
        int begin = end;
        for (; begin > 0; begin--) {
            double complex *p = S + (long)n * begin + begin - 1;
            if (cabs(*p) <= DBL_EPSILON * fmax(largest, cabs(p[0 - n]) + cabs(p[1]))) {
                *p = 0;
                break;
            }
        }
        if (begin == end) {
            end--;
            pass = 0;
        } else if (pass++ > PASSES) {
            return 1;
        } else {
            sweep(n, S, Q, begin, end, shift_of(n, S, end, pass));
        }
    }
    return 0;
}

/* The eigenvalues k and k + 1 exchange their places. */
static void swap_neighbours(int n, double complex *S, double complex *Q, int k) {
    double complex *p = S + (long)n * k + k, first = p[0], second = p[n + 1];
    schur_turn g = turn_onto(p[1], second - first);
    schur_rows(n, S, k, k, g);
    schur_columns(n, S, k, k + 2, g);
    schur_columns(n, Q, k, n, g);
    p[0] = second, p[n + 1] = first, p[n] = 0;
}

static int sort_form(int n, double complex *S, double complex *Q) {
    for (int end = n - 1; end > 0; end--) {
        for (int i = 0; i < end; i++) {
            if (cabs(S[(int64_t)(n + 1) * i]) < cabs(S[(int64_t)(n + 1) * (i + 1)])) {
                swap_neighbours(n, S, Q, i);
            }
        }
    }
    return 0;
}

static void transpose(int n, double complex *A) { /* rows and columns are as they are to be */
    (void)n, (void)A;
}
#endif

int spari_schur(int n, double complex *S, double complex *Q, int sorted, double complex *workspace) {
    if (n < 1) {
        return 0;
    }
    if (spari_first_nonfinite((const double *)S, 2 * (int64_t)n * n) >= 0) {
        return 1;
    }
    transpose(n, S);
    int bad = find_form(n, S, Q, workspace) || (sorted && sort_form(n, S, Q));
    transpose(n, S);
    transpose(n, Q);
    return bad;
}

/* The eigenvector of S to the eigenvalue k: its entry k is 1 and those behind it 0. */
static void vector_of_form(int n, const double complex *S, int k, double complex *x) {
    double scale = 0;
    for (int i = 0; i <= k; i++) {
        scale = fmax(scale, cabs(S[(long)n * i + i]));
    }
    double least = DBL_EPSILON * (scale > 0 ? scale : 1);
    for (int i = 0; i < n; i++) {
        x[i] = i == k;
    }
    for (int i = k - 1; i >= 0; i--) {
        double complex sum = 0, apart = S[(long)n * i + i] - S[(long)n * k + k];
        for (int j = i + 1; j <= k; j++) {
            sum += S[(long)n * i + j] * x[j];
        }
        x[i] = -sum / (cabs(apart) > least ? apart : least);
    }
}

void spari_schur_vector(int n, const double complex *S, const double complex *Q, int k, double complex *x,
                        double complex *workspace) {
    vector_of_form(n, S, k, workspace);
    for (int i = 0; i < n; i++) {
        x[i] = 0;
        for (int l = 0; l <= k; l++) {
            x[i] += Q[(int64_t)n * i + l] * workspace[l];
        }
    }
}
