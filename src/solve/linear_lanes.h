/* Back-substitution for one width of vectors. Included by linear.c once per width with the macros of math/width.h. No
   include guard: this is a body, not an interface. Columns lie one after the other, contiguous. BLAS takes three to
   four times as many instructions for so few unknowns (docs/performance.md). */

/* x[n] -= `count` columns of n, each `step` after the one before, times by[count]. */
HERE void NAME(less_columns)(const int count, int64_t n, const double *columns, int64_t step, const double *by,
                             double *x) {
    double less[4];
    L spread[4];
    int64_t i = 0;
    SPARI_UNROLL
    for (int k = 0; k < count; k++) {
        less[k] = -by[k];
        spread[k] = SPLAT(less + k);
    }
    for (; i < n % W; i++) {
        for (int k = 0; k < count; k++) {
            x[i] += less[k] * columns[step * k + i];
        }
    }
    for (; i < n; i += W) {
        L sum = NAME(get)(x + i);
        SPARI_UNROLL
        for (int k = 0; k < count; k++) {
            sum = MADD(spread[k], NAME(get)(columns + step * k + i), sum);
        }
        NAME(put)(x + i, sum);
    }
}

/* m unknowns against the triangle below a diagonal of ones, or the one above with its diagonal, of their own columns.
 */
HERE void NAME(lower_corner)(const int m, int64_t n, const double *at, double *x) {
    SPARI_UNROLL
    for (int k = 0; k < m; k++) {
        SPARI_UNROLL
        for (int i = k + 1; i < m; i++) {
            x[i] -= at[n * k + i] * x[k];
        }
    }
}

HERE void NAME(upper_corner)(const int m, int64_t n, const double *at, double *x) {
    SPARI_UNROLL
    for (int k = m - 1; k >= 0; k--) {
        x[k] /= at[n * k + k];
        SPARI_UNROLL
        for (int i = 0; i < k; i++) {
            x[i] -= at[n * k + i] * x[k];
        }
    }
}

/* x := A^-1 x with the triangles of A [n][n] below a diagonal of ones and above; columns go by four, the last few are
   what is left over. */
TARGET static void NAME(solve_dense)(int64_t n, const double *A, double *x) {
    int rest = (int)(n % 4);
    int64_t whole = n - rest, j = 0;
    for (; j < whole; j += 4) {
        const double *at = A + (n + 1) * j;
        NAME(lower_corner)(4, n, at, x + j);
        NAME(less_columns)(4, n - j - 4, at + 4, n, x + j, x + j + 4);
    }
    NAME(lower_corner)(rest, n, A + (n + 1) * j, x + j);
    NAME(upper_corner)(rest, n, A + (n + 1) * j, x + j);
    for (int k = 0; k < rest; k++) {
        NAME(less_columns)(1, whole, A + n * (whole + k), n, x + whole + k, x);
    }
    for (j = whole - 4; j >= 0; j -= 4) {
        NAME(upper_corner)(4, n, A + (n + 1) * j, x + j);
        NAME(less_columns)(4, j, A + n * j, n, x + j, x);
    }
}

/* The same for a band with `band` entries on either side, and as many more above that exchanges of rows brought: row
   swap[j] took the place of row j before column j was taken out. A(i, j) is at columns[step j + 2 band + i - j]. */
TARGET static void NAME(solve_band)(int64_t n, int64_t band, const double *columns, int64_t step, const unsigned *swap,
                                    double *x) {
    const double *at = columns + 2 * band;
    for (int64_t j = 0; j < n - 1; j++, at += step) {
        double there = x[swap[j]];
        x[swap[j]] = x[j];
        x[j] = there;
        NAME(less_columns)(1, n - 1 - j < band ? n - 1 - j : band, at + 1, step, x + j, x + j + 1);
    }
    for (int64_t j = n - 1; j >= 0; j--, at -= step) {
        int64_t above = j < 2 * band ? j : 2 * band;
        x[j] /= *at;
        NAME(less_columns)(1, above, at - above, step, x + j, x + j - above);
    }
}
