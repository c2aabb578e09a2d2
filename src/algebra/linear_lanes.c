/* Factors and back-substitution for one width of vectors (math/lanes.h). Columns lie one after the other, contiguous.
   BLAS takes three to four times as many instructions for so few unknowns (docs/evidence/performance.md). */
#include "linear_kernels.h"

#include "../base/status.h"

#include <math.h>

#ifdef SPARI_HAS_OBJECT
#define SPARI_WIDTH SPARI_OBJECT_WIDTH
#include "../math/width.h"

#include "../math/rotation_lanes.h"

/* x[n] -= `count` columns of length n, `step` apart, times by[count]. */
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

/* Solves with the unit lower, or upper, triangle of m columns. */
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

/* y[8] := M y, M [8][8] column by column. Two interleaved sums hide the latency of additions. */
HERE void NAME(times_corner)(const double *M, double *y) {
    enum { VECTORS = (SPARI_CORNER + W - 1) / W, HALF = SPARI_CORNER / 2 };
    L sum[VECTORS], more[VECTORS];
    SPARI_UNROLL
    for (int v = 0; v < VECTORS; v++) {
        sum[v] = SPLAT(y) * NAME(get)(M + W * v);
        more[v] = SPLAT(y + HALF) * NAME(get)(M + SPARI_CORNER * HALF + W * v);
        SPARI_UNROLL
        for (int k = 1; k < HALF; k++) {
            sum[v] = MADD(SPLAT(y + k), NAME(get)(M + SPARI_CORNER * k + W * v), sum[v]);
            more[v] = MADD(SPLAT(y + HALF + k), NAME(get)(M + SPARI_CORNER * (HALF + k) + W * v), more[v]);
        }
    }
    SPARI_UNROLL
    for (int v = 0; v < VECTORS; v++) {
        NAME(put)(y + W * v, sum[v] + more[v]);
    }
}

/* x[n], rounded up to whole vectors, -= eight columns, `step` apart, times by[8]. */
HERE void NAME(less_eight)(int64_t n, const double *columns, int64_t step, const double *by, double *x) {
    enum { HALF = SPARI_CORNER / 2 };
    double less[SPARI_CORNER];
    L spread[SPARI_CORNER];
    SPARI_UNROLL
    for (int k = 0; k < SPARI_CORNER; k++) {
        less[k] = -by[k];
        spread[k] = SPLAT(less + k);
    }
    for (int64_t i = 0; i < n; i += W) {
        L sum = NAME(get)(x + i), more = spread[HALF] * NAME(get)(columns + step * HALF + i);
        SPARI_UNROLL
        for (int k = 0; k < HALF; k++) {
            sum = MADD(spread[k], NAME(get)(columns + step * k + i), sum);
        }
        SPARI_UNROLL
        for (int k = HALF + 1; k < SPARI_CORNER; k++) {
            more = MADD(spread[k], NAME(get)(columns + step * k + i), more);
        }
        NAME(put)(x + i, sum + more);
    }
}

/* Inverts the triangles of m columns: Z L = 1 and Z U = 1, column by column, each a vector. Eight of them stay in
   registers, and each depends on the one before alone. */
enum { NAME(VECTORS) = (SPARI_CORNER + W - 1) / W };

HERE void NAME(begin_inverse)(L (*z)[NAME(VECTORS)]) {
    static const double one[2 * SPARI_CORNER] = {[SPARI_CORNER] = 1};
    SPARI_UNROLL
    for (int c = 0; c < SPARI_CORNER; c++) {
        SPARI_UNROLL
        for (int v = 0; v < NAME(VECTORS); v++) {
            z[c][v] = NAME(get)(one + SPARI_CORNER - c + W * v);
        }
    }
}

HERE void NAME(put_inverse)(const int m, const L (*z)[NAME(VECTORS)], double *Z) {
    memset(Z, 0, SPARI_CORNER * SPARI_CORNER * sizeof *Z);
    SPARI_UNROLL
    for (int c = 0; c < m; c++) {
        SPARI_UNROLL
        for (int v = 0; v < NAME(VECTORS); v++) {
            NAME(put)(Z + SPARI_CORNER * c + W * v, z[c][v]);
        }
    }
}

HERE void NAME(invert_lower)(int64_t n, const int m, const double *at, double *Z) {
    L z[SPARI_CORNER][NAME(VECTORS)];
    NAME(begin_inverse)(z);
    SPARI_UNROLL
    for (int c = m - 1; c >= 0; c--) {
        SPARI_UNROLL
        for (int k = m - 1; k > c; k--) {
            L by = SPLAT(at + n * c + k);
            SPARI_UNROLL
            for (int v = 0; v < NAME(VECTORS); v++) {
                z[c][v] = z[c][v] - by * z[k][v];
            }
        }
    }
    NAME(put_inverse)(m, (const L(*)[NAME(VECTORS)])z, Z);
}

HERE void NAME(invert_upper)(int64_t n, const int m, const double *at, double *Z) {
    L z[SPARI_CORNER][NAME(VECTORS)];
    NAME(begin_inverse)(z);
    SPARI_UNROLL
    for (int c = 0; c < m; c++) {
        double over = 1 / at[(n + 1) * c];
        SPARI_UNROLL
        for (int k = 0; k < c; k++) {
            L by = SPLAT(at + n * c + k);
            SPARI_UNROLL
            for (int v = 0; v < NAME(VECTORS); v++) {
                z[c][v] = z[c][v] - by * z[k][v];
            }
        }
        SPARI_UNROLL
        for (int v = 0; v < NAME(VECTORS); v++) {
            z[c][v] = over * z[c][v];
        }
    }
    NAME(put_inverse)(m, (const L(*)[NAME(VECTORS)])z, Z);
}

/* B := M times the block A [8][8] whose columns are n apart. */
HERE void NAME(times_block)(const double *M, int64_t n, const double *A, double *B) {
    for (int c = 0; c < SPARI_CORNER; c++) {
        memcpy(B + SPARI_CORNER * c, A + n * c, SPARI_CORNER * sizeof *B);
        NAME(times_corner)(M, B + SPARI_CORNER * c);
    }
}

/* Prepares what solve_dense needs beyond the triangles, for the columns from j on of A [n][step]. For whole blocks
   of eight, factoring has computed the first part, unless the factors were loaded. */
TARGET static void NAME(invert_corner)(int64_t n, int64_t j, int loaded, const double *A, int64_t step,
                                       double *corner) {
    enum { SIZE = SPARI_CORNER * SPARI_CORNER };
    const double *at = A + (step + 1) * j;
    if (n - j < SPARI_CORNER) {
        NAME(invert_lower)(step, (int)(n - j), at, corner);
        NAME(invert_upper)(step, (int)(n - j), at, corner + SIZE);
        return;
    }
    if (loaded) {
        NAME(invert_lower)(step, SPARI_CORNER, at, corner);
    }
    NAME(invert_upper)(step, SPARI_CORNER, at, corner + SIZE);
    if (j > 0) {
        NAME(times_block)(corner, step, at - step * SPARI_CORNER, corner + 2 * SIZE);
        NAME(times_block)(corner - (SPARI_CORNERS - 1) * SIZE, step, at - SPARI_CORNER, corner + 3 * SIZE);
    }
}

/* y := M y - B x, eight of each, in four interleaved sums. */
HERE void NAME(next_corner)(const double *M, const double *B, const double *x, double *y) {
    enum { HALF = SPARI_CORNER / 2 };
    L sum[4][NAME(VECTORS)];
    SPARI_UNROLL
    for (int v = 0; v < NAME(VECTORS); v++) {
        sum[0][v] = SPLAT(y) * NAME(get)(M + W * v);
        sum[1][v] = SPLAT(y + HALF) * NAME(get)(M + SPARI_CORNER * HALF + W * v);
        sum[2][v] = SPLAT(x) * NAME(get)(B + W * v);
        sum[3][v] = SPLAT(x + HALF) * NAME(get)(B + SPARI_CORNER * HALF + W * v);
    }
    SPARI_UNROLL
    for (int k = 1; k < HALF; k++) {
        SPARI_UNROLL
        for (int v = 0; v < NAME(VECTORS); v++) {
            const double *m = M + SPARI_CORNER * k + W * v, *b = B + SPARI_CORNER * k + W * v;
            sum[0][v] = MADD(SPLAT(y + k), NAME(get)(m), sum[0][v]);
            sum[1][v] = MADD(SPLAT(y + HALF + k), NAME(get)(m + SPARI_CORNER * HALF), sum[1][v]);
            sum[2][v] = MADD(SPLAT(x + k), NAME(get)(b), sum[2][v]);
            sum[3][v] = MADD(SPLAT(x + HALF + k), NAME(get)(b + SPARI_CORNER * HALF), sum[3][v]);
        }
    }
    SPARI_UNROLL
    for (int v = 0; v < NAME(VECTORS); v++) {
        NAME(put)(y + W * v, (sum[0][v] + sum[1][v]) - (sum[2][v] + sum[3][v]));
    }
}

/* 0 x is 0 for every finite x. */
HERE int NAME(is_finite)(int64_t n, const double *x) {
    L poison = {0};
    double lanes[W], rest = 0;
    int64_t i = 0;
    for (; i + W <= n; i += W) {
        poison = poison + 0.0 * NAME(get)(x + i);
    }
    for (; i < n; i++) {
        rest += 0.0 * x[i];
    }
    NAME(put)(lanes, poison);
    for (int l = 0; l < W; l++) {
        rest += lanes[l];
    }
    return rest == 0;
}

/* y := A^-1 y with the unit lower and the upper triangle of A [n][step], eight columns at a time. corners holds
   [4][8][8] for each eight:
   - the inverses of its lower and upper diagonal blocks, with zeros beyond the last column;
   - for a whole block: the lower inverse times the block to its left, and the upper inverse of the block before
     times the block above.
   With these, each block of eight waits for one product alone. y has room for whole blocks of eight. */
TARGET static int NAME(solve_dense)(int64_t n, const double *A, int64_t step, const double *corners, double *y) {
    enum { SIZE = SPARI_CORNER * SPARI_CORNER, NEXT = SPARI_CORNERS * SIZE, TWO = 2 * SPARI_CORNER };
    int64_t rest = n % SPARI_CORNER, whole = n - rest, j = 0;
    if (whole > 0) {
        NAME(times_corner)(corners, y);
    }
    for (; j + SPARI_CORNER < whole; j += SPARI_CORNER) {
        corners += NEXT;
        NAME(next_corner)(corners, corners + 2 * SIZE, y + j, y + j + SPARI_CORNER);
        NAME(less_eight)(n - j - TWO, A + (step + 1) * j + TWO, step, y + j, y + j + TWO);
    }
    if (whole > 0) {
        NAME(less_eight)(rest, A + (step + 1) * j + SPARI_CORNER, step, y + j, y + whole);
    }
    if (rest > 0) {
        const double *last = corners + (whole > 0 ? NEXT : 0);
        memset(y + n, 0, (size_t)(SPARI_CORNER - rest) * sizeof *y);
        NAME(times_corner)(last, y + whole);
        NAME(times_corner)(last + SIZE, y + whole);
        for (int64_t k = 0; k < rest; k++) {
            NAME(less_columns)(1, whole, A + step * (whole + k), step, y + whole + k, y);
        }
    }
    if (whole > 0) {
        NAME(times_corner)(corners + SIZE, y + j);
    }
    for (; j > 0; j -= SPARI_CORNER, corners -= NEXT) {
        NAME(next_corner)(corners - NEXT + SIZE, corners + 3 * SIZE, y + j, y + j - SPARI_CORNER);
        NAME(less_eight)(j - SPARI_CORNER, A + step * j, step, y + j, y);
    }
    return !NAME(is_finite)(n, y);
}

/* Forward and back substitution when the columns from `inner` on are not factored: forth leaves their right-hand
   side in x, back expects their solution there. */
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

/* The same for a band with `band` entries on either side, and as many more above from row exchanges: row j was
   exchanged with row swap[j] before column j was eliminated. A(i, j) is at columns[step j + 2 band + i - j]. */
TARGET static void NAME(forth_band)(int64_t n, int64_t band, const double *columns, int64_t step, const int *swap,
                                    double *x) {
    const double *at = columns + 2 * band;
    for (int64_t j = 0; j < n - 1; j++, at += step) {
        double there = x[swap[j]];
        x[swap[j]] = x[j];
        x[j] = there;
        NAME(less_columns)(1, n - 1 - j < band ? n - 1 - j : band, at + 1, step, x + j, x + j + 1);
    }
}

TARGET static void NAME(back_band)(int64_t n, int64_t band, const double *columns, int64_t step, double *x) {
    const double *at = columns + step * (n - 1) + 2 * band;
    for (int64_t j = n - 1; j >= 0; j--, at -= step) {
        int64_t above = j < 2 * band ? j : 2 * band;
        x[j] /= *at;
        NAME(less_columns)(1, above, at - above, step, x + j, x + j - above);
    }
}

/* Whether all of x[4] are 0 */
HERE int NAME(are_zero)(const double *x) {
    uint64_t bits[4];
    memcpy(bits, x, sizeof bits);
    return (bits[0] | bits[1] | bits[2] | bits[3]) << 1 == 0;
}

/* Index of the largest of |x[n]|, the first of equal ones. */
HERE int64_t NAME(pivot_of)(int64_t n, const double *x) {
    L lanes = {0};
    int64_t i = 0;
    double most = 0;
    for (; i + W <= n; i += W) {
        L here = NAME(get)(x + i);
        lanes = NAME(larger)(NAME(larger)(here, -here), lanes);
    }
    for (; i < n; i++) {
        most = fabs(x[i]) > most ? fabs(x[i]) : most;
    }
    most = NAME(largest)(most, lanes);
    for (i = 0; i < n - 1 && !(fabs(x[i]) >= most);) {
        i++;
    }
    return i;
}

/* The same of |x[n]| times weight[n]; weight NULL: 1. */
HERE int64_t NAME(weighed_pivot_of)(int64_t n, const double *x, const double *weight) {
    int64_t at = 0;
    double most = -1;
    if (!weight) {
        return NAME(pivot_of)(n, x);
    }
    for (int64_t i = 0; i < n; i++) {
        double size = fabs(x[i]) * weight[i];
        at = size > most ? i : at;
        most = size > most ? size : most;
    }
    return at;
}

HERE void NAME(exchange_weights)(double *weight, int64_t i, int64_t j) {
    if (weight) {
        double there = weight[i];
        weight[i] = weight[j];
        weight[j] = there;
    }
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

/* Four columns x of n rows -= eight columns, n apart, from `columns` on, times by[4][8]; V vectors of rows. */
HERE void NAME(less_tile)(const int V, const double *columns, int64_t step, const double (*by)[SPARI_CORNER],
                          double *const *x, int64_t i) {
    L sum[4][2];
    SPARI_UNROLL
    for (int c = 0; c < 4; c++) {
        SPARI_UNROLL
        for (int v = 0; v < V; v++) {
            sum[c][v] = NAME(get)(x[c] + i + W * v);
        }
    }
    columns += i;
    for (int k = 0; k < SPARI_CORNER; k++, columns += step) {
        SPARI_UNROLL
        for (int c = 0; c < 4; c++) {
            L less = SPLAT(by[c] + k);
            SPARI_UNROLL
            for (int v = 0; v < V; v++) {
                sum[c][v] = MADD(less, NAME(get)(columns + W * v), sum[c][v]);
            }
        }
    }
    SPARI_UNROLL
    for (int c = 0; c < 4; c++) {
        SPARI_UNROLL
        for (int v = 0; v < V; v++) {
            NAME(put)(x[c] + i + W * v, sum[c][v]);
        }
    }
}

/* Updates n rows below eight factored columns, of four columns whose eight rows are `by`. */
HERE void NAME(less_block)(int64_t n, const double *columns, int64_t step, double (*by)[SPARI_CORNER],
                           double *const *x) {
    int64_t i = 0;
    for (int c = 0; c < 4; c++) {
        for (int k = 0; k < SPARI_CORNER; k++) {
            by[c][k] = -by[c][k];
        }
    }
    for (; i + 2 * W <= n; i += 2 * W) {
        NAME(less_tile)(2, columns, step, (const double(*)[SPARI_CORNER])by, x, i);
    }
    for (; i + W <= n; i += W) {
        NAME(less_tile)(1, columns, step, (const double(*)[SPARI_CORNER])by, x, i);
    }
    for (; i < n; i++) {
        for (int c = 0; c < 4; c++) {
            double sum = x[c][i];
            SPARI_UNROLL
            for (int k = 0; k < SPARI_CORNER; k++) {
                sum += by[c][k] * columns[step * k + i];
            }
            x[c][i] = sum;
        }
    }
}

/* Updates the later columns with eight factored columns from j on, four at a time; columns without entries are
   skipped. inverse [8][8]: of the lower triangle. */
TARGET SPARI_APART static void NAME(take_out)(int64_t n, int64_t j, double *A, int64_t step, double *inverse) {
    double by[4][SPARI_CORNER], *x[4];
    int64_t below = n - j - SPARI_CORNER;
    const double *corner = A + (step + 1) * j, *columns = corner + SPARI_CORNER;
    int held = 0;
    NAME(invert_lower)(step, SPARI_CORNER, corner, inverse);
    for (int64_t c = j + SPARI_CORNER; c < n; c++) {
        double *top = A + step * c + j;
        if (NAME(are_zero)(top) && NAME(are_zero)(top + 4)) {
            continue;
        }
        NAME(times_corner)(inverse, top);
        memcpy(by[held], top, sizeof by[held]);
        x[held++] = top + SPARI_CORNER;
        if (held == 4) {
            NAME(less_block)(below, columns, step, by, x);
            held = 0;
        }
    }
    for (int c = 0; c < held; c++) {
        NAME(less_columns)(4, below, columns, step, by[c], x[c]);
        NAME(less_columns)(4, below, columns + 4 * step, step, by[c] + 4, x[c]);
    }
}

/* Updates one column with the factored columns from `first` to `end`; four columns without entries at a time are
   skipped. */
HERE void NAME(take_from)(int64_t n, int64_t first, int64_t end, const double *A, int64_t step, double *x) {
    int64_t k = first;
    for (; k + 4 <= end; k += 4) {
        const double *at = A + (step + 1) * k;
        if (!NAME(are_zero)(x + k)) {
            NAME(lower_corner)(4, step, at, x + k);
            NAME(less_columns)(4, n - k - 4, at + 4, step, x + k, x + k + 4);
        }
    }
    for (; k < end; k++) {
        if (x[k] != 0) {
            NAME(less_columns)(1, n - k - 1, A + (step + 1) * k + 1, step, x + k, x + k + 1);
        }
    }
}

/* Factors A [n][step] in place, eight columns at a time.
   inner: rows are exchanged among the first `inner`, which are eliminated; the rest is left as their Schur
     complement
   swap: row j is exchanged with row swap[j] - 1, that of the largest entry times the weight of its row
   weight [inner]: of the rows, exchanged with them; NULL: 1
   corners: receives the lower inverses of whole blocks of eight for solve_dense; may be NULL
   Columns without entries are skipped. In the elimination order of a tree of parts these are most, the more so the
     fewer rows are exchanged. Returns 0, or 1 if a pivot is 0 or not finite. */
TARGET static int NAME(factor_dense)(int64_t n, int64_t inner, double *A, int64_t step, int *swap, double *weight,
                                     double *corners) {
    double inverse[SPARI_CORNER * SPARI_CORNER];
    for (int64_t j = 0; j < inner; j++) {
        double *x = A + step * j;
        int64_t p = j + NAME(weighed_pivot_of)(inner - j, x + j, weight ? weight + j : NULL);
        int64_t first = j - j % SPARI_CORNER, c = j + 1;
        swap[j] = (int)p + 1;
        NAME(exchange_weights)(weight, j, p);
        for (double *row = A; p != j && row < A + step * n; row += step) {
            double there = row[p];
            row[p] = row[j];
            row[j] = there;
        }
        if (!(fabs(x[j]) > 0)) {
            return 1;
        }
        NAME(scale)(n - j - 1, 1 / x[j], x + j + 1);
        for (; c < first + SPARI_CORNER && c < inner; c++) {
            if (A[step * c + j] != 0) {
                NAME(less_columns)(1, n - j - 1, x + j + 1, step, A + step * c + j, A + step * c + j + 1);
            }
        }
        if (c == first + SPARI_CORNER && c == j + 1) {
            NAME(take_out)(n, first, A, step, corners ? corners + SPARI_CORNERS * SPARI_CORNER * first : inverse);
        }
    }
    for (int64_t j = inner; j < n; j++) {
        NAME(take_from)(n, inner - inner % SPARI_CORNER, inner, A, step, A + step * j);
    }
    return 0;
}

/* The same for a band, as forth_band and back_band need it. Rows are exchanged from column j on. */
TARGET static int NAME(factor_band)(int64_t n, int64_t band, double *columns, int64_t step, int *swap, double *weight) {
    for (int64_t j = 0; j < n; j++) {
        double *x = columns + step * j + 2 * band - j; /* x[i]: row i */
        int64_t end = j + band + 1 < n ? j + band + 1 : n;
        for (int64_t k = j > 2 * band ? j - 2 * band : 0; k < j; k++) {
            double there = x[swap[k]];
            x[swap[k]] = x[k];
            x[k] = there;
            if (there != 0) {
                NAME(less_columns)
                (1, n - 1 - k < band ? n - 1 - k : band, columns + step * k + 2 * band + 1, step, x + k, x + k + 1);
            }
        }
        int64_t p = j + NAME(weighed_pivot_of)(end - j, x + j, weight ? weight + j : NULL);
        swap[j] = (int)p;
        NAME(exchange_weights)(weight, j, p);
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

/* x[n] -= `count` consecutive columns of length n times by[count]. */
TARGET static void NAME(take_columns)(int64_t n, int64_t count, const double *columns, const double *by, double *x) {
    int64_t k = 0;
    for (; k + 4 <= count; k += 4) {
        NAME(less_columns)(4, n, columns + n * k, n, by + k, x);
    }
    for (; k < count; k++) {
        NAME(less_columns)(1, n, columns + n * k, n, by + k, x);
    }
}

/* Sum of the lanes of one row's products. */
HERE double NAME(total_of)(L sum) {
    double lanes[W], total = 0;
    NAME(put)(lanes, sum);
    SPARI_UNROLL
    for (int k = 0; k < W; k++) {
        total += lanes[k];
    }
    return total;
}

/* y[count] += by times `count` consecutive rows of length n times x[n]. */
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

const spari_linear_kernels NAME(spari_linear_kernels) = {
    .factor_dense = NAME(factor_dense),
    .factor_band = NAME(factor_band),
    .corner = NAME(invert_corner),
    .dense = NAME(solve_dense),
    .forth_dense = NAME(forth_dense),
    .back_dense = NAME(back_dense),
    .forth = NAME(forth_band),
    .back = NAME(back_band),
    .columns = NAME(take_columns),
    .rows = NAME(add_rows),
};
#endif
