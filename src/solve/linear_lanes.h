/* Factors and back-substitution for one width of vectors. Included by linear.c once per width with the macros of
   math/width.h. No include guard: this is a body, not an interface. Columns lie one after the other, contiguous. BLAS
   takes three to four times as many instructions for so few unknowns (docs/performance.md). */

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

/* Where the columns from `inner` on have not been taken out: x is left with what the others leave of them; and the
   others from x, which has their solution. */
TARGET static void NAME(forth_dense)(int64_t n, int64_t inner, const double *A, double *x) {
    int64_t j = 0;
    for (; j + 4 <= inner; j += 4) {
        const double *at = A + (n + 1) * j;
        NAME(lower_corner)(4, n, at, x + j);
        NAME(less_columns)(4, n - j - 4, at + 4, n, x + j, x + j + 4);
    }
    NAME(lower_corner)((int)(inner - j), n, A + (n + 1) * j, x + j);
    for (; j < inner; j++) {
        NAME(less_columns)(1, n - inner, A + n * j + inner, n, x + j, x + inner);
    }
}

TARGET static void NAME(back_dense)(int64_t n, int64_t inner, const double *A, double *x) {
    int rest = (int)(inner % 4);
    int64_t whole = inner - rest, j = inner;
    for (; j + 4 <= n; j += 4) {
        NAME(less_columns)(4, inner, A + n * j, n, x + j, x);
    }
    for (; j < n; j++) {
        NAME(less_columns)(1, inner, A + n * j, n, x + j, x);
    }
    NAME(upper_corner)(rest, n, A + (n + 1) * whole, x + whole);
    for (int k = 0; k < rest; k++) {
        NAME(less_columns)(1, whole, A + n * (whole + k), n, x + whole + k, x);
    }
    for (j = whole - 4; j >= 0; j -= 4) {
        NAME(upper_corner)(4, n, A + (n + 1) * j, x + j);
        NAME(less_columns)(4, j, A + n * j, n, x + j, x);
    }
}

/* The same for a band with `band` entries on either side, and as many more above that exchanges of rows brought: row
   swap[j] took the place of row j before column j was taken out. A(i, j) is at columns[step j + 2 band + i - j]. The
   columns from `inner` on have not been: x is left with what the others leave of them, and has then their solution. */
TARGET static void NAME(forth_band)(int64_t n, int64_t inner, int64_t band, const double *columns, int64_t step,
                                    const unsigned *swap, double *x) {
    const double *at = columns + 2 * band;
    int64_t end = inner < n ? inner : n - 1;
    for (int64_t j = 0; j < end; j++, at += step) {
        double there = x[swap[j]];
        x[swap[j]] = x[j];
        x[j] = there;
        NAME(less_columns)(1, n - 1 - j < band ? n - 1 - j : band, at + 1, step, x + j, x + j + 1);
    }
}

TARGET static void NAME(back_band)(int64_t n, int64_t inner, int64_t band, const double *columns, int64_t step,
                                   double *x) {
    const double *at = columns + step * (n - 1) + 2 * band;
    int64_t j = n - 1;
    for (; j >= inner; j--, at -= step) {
        int64_t above = j < 2 * band ? j : 2 * band, met = inner - (j - above);
        NAME(less_columns)(1, met, at - above, step, x + j, x + j - above);
    }
    for (; j >= 0; j--, at -= step) {
        int64_t above = j < 2 * band ? j : 2 * band;
        x[j] /= *at;
        NAME(less_columns)(1, above, at - above, step, x + j, x + j - above);
    }
}

/* Whether none of x[4] is but 0 */
HERE int NAME(are_zero)(const double *x) {
    uint64_t bits[4];
    memcpy(bits, x, sizeof bits);
    return (bits[0] | bits[1] | bits[2] | bits[3]) << 1 == 0;
}

/* Where the largest of x[n] is; the first, unless it has less than `least` of that. */
HERE int64_t NAME(pivot_of)(int64_t n, double least, const double *x) {
    int64_t at = 0;
    double most = fabs(x[0]);
    for (int64_t i = 1; i < n; i++) {
        if (fabs(x[i]) > most) {
            most = fabs(x[i]), at = i;
        }
    }
    return fabs(x[0]) >= least * most ? 0 : at;
}

HERE void NAME(scale)(int64_t n, double by, double *x) {
    L spread = SPLAT(&by);
    int64_t i = 0;
    for (; i < n % W; i++) {
        x[i] *= by;
    }
    for (; i < n; i += W) {
        NAME(put)(x + i, spread * NAME(get)(x + i));
    }
}

/* A := its triangles, a column at a time against those before it, with exchanges of whole rows among the first `inner`,
   which are taken out; the corner of the others is left with what it has beyond them. Row j with row swap[j] - 1,
   unless the diagonal has as much as `least` of the largest entry. Columns that it does not meet, four by four, cost
   nothing: with unknowns in the order in which a tree of parts is taken apart these are most, and the fewer rows are
   exchanged, the more. 0, or 1 where a pivot is 0 or none at all. */
TARGET static int NAME(factor_dense)(int64_t n, int64_t inner, double least, double *A, int *swap) {
    for (int64_t j = 0; j < n; j++) {
        double *x = A + n * j;
        int64_t k = 0, end = j < inner ? j : inner;
        for (; k + 4 <= end; k += 4) {
            const double *at = A + (n + 1) * k;
            if (!NAME(are_zero)(x + k)) {
                NAME(lower_corner)(4, n, at, x + k);
                NAME(less_columns)(4, n - k - 4, at + 4, n, x + k, x + k + 4);
            }
        }
        for (; k < end; k++) {
            if (x[k] != 0) {
                NAME(less_columns)(1, n - k - 1, A + (n + 1) * k + 1, n, x + k, x + k + 1);
            }
        }
        if (j >= inner) {
            continue;
        }
        int64_t p = j + NAME(pivot_of)(inner - j, least, x + j);
        swap[j] = (int)p + 1;
        for (double *row = A; p != j && row < A + n * n; row += n) {
            double there = row[p];
            row[p] = row[j];
            row[j] = there;
        }
        if (!(fabs(x[j]) > 0)) {
            return 1;
        }
        NAME(scale)(n - j - 1, 1 / x[j], x + j + 1);
    }
    return 0;
}

/* The same of a band as forth_band and back_band want it: rows are exchanged from column j on, among the first `inner`.
   The corner of the others is left with what it has beyond the first. */
TARGET static int NAME(factor_band)(int64_t n, int64_t inner, int64_t band, double least, double *columns, int64_t step,
                                    unsigned *swap) {
    for (int64_t j = 0; j < n; j++) {
        double *x = columns + step * j + 2 * band - j; /* x[i]: row i */
        int64_t end = j + band + 1 < n ? j + band + 1 : n;
        for (int64_t k = j > 2 * band ? j - 2 * band : 0; k < j && k < inner; k++) {
            double there = x[swap[k]];
            x[swap[k]] = x[k];
            x[k] = there;
            if (there != 0) {
                NAME(less_columns)
                (1, n - 1 - k < band ? n - 1 - k : band, columns + step * k + 2 * band + 1, step, x + k, x + k + 1);
            }
        }
        if (j >= inner) {
            continue;
        }
        int64_t p = j + NAME(pivot_of)((end < inner ? end : inner) - j, least, x + j);
        swap[j] = (unsigned)p;
        double there = x[p];
        x[p] = x[j];
        x[j] = there;
        if (!(fabs(there) > 0)) {
            return 1;
        }
        NAME(scale)(end - j - 1, 1 / there, x + j + 1);
    }
    return 0;
}

/* x[n] -= `count` columns of n, one after the other, times by[count]. */
TARGET static void NAME(take_columns)(int64_t n, int64_t count, const double *columns, const double *by, double *x) {
    int64_t k = 0;
    for (; k + 4 <= count; k += 4) {
        NAME(less_columns)(4, n, columns + n * k, n, by + k, x);
    }
    for (; k < count; k++) {
        NAME(less_columns)(1, n, columns + n * k, n, by + k, x);
    }
}

/* The sum of one row's products in lanes. */
HERE double NAME(total_of)(L sum) {
    double lanes[W], total = 0;
    NAME(put)(lanes, sum);
    SPARI_UNROLL
    for (int k = 0; k < W; k++) {
        total += lanes[k];
    }
    return total;
}

/* y[count] += by times `count` rows of n, one after the other, times x[n]. */
HERE void NAME(more_rows)(const int count, int64_t n, const double *rows, double by, const double *x, double *y) {
    double first[4] = {0};
    L sum[4];
    int64_t i = 0;
    SPARI_UNROLL
    for (int k = 0; k < count; k++) {
        sum[k] = (L){0};
    }
    for (; i < n % W; i++) {
        SPARI_UNROLL
        for (int k = 0; k < count; k++) {
            first[k] += rows[n * k + i] * x[i];
        }
    }
    for (; i < n; i += W) {
        L at = NAME(get)(x + i);
        SPARI_UNROLL
        for (int k = 0; k < count; k++) {
            sum[k] = MADD(NAME(get)(rows + n * k + i), at, sum[k]);
        }
    }
    SPARI_UNROLL
    for (int k = 0; k < count; k++) {
        y[k] += by * (first[k] + NAME(total_of)(sum[k]));
    }
}

TARGET static void NAME(add_rows)(int64_t n, int64_t count, const double *rows, double by, const double *x, double *y) {
    int64_t k = 0;
    for (; k + 4 <= count; k += 4) {
        NAME(more_rows)(4, n, rows + n * k, by, x, y + k);
    }
    for (; k < count; k++) {
        NAME(more_rows)(1, n, rows + n * k, by, x, y + k);
    }
}
