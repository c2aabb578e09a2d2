/* Realisation of a linear system from its decaying response (eigensystem realisation): see prony.h. The block Hankel
   matrix with Y_(i + j) in block row i and column j is O X, with as many independent rows as there are states. The
   one with Y_(i + j + 1) is O A X. With O X = U S V^T, A = S^-1/2 U^T (O A X) V S^-1/2. Rows and columns need not be
   consecutive: close ones at first and distant ones later resolve fast and slow modes. */
#include "prony.h"

#include "../base/status.h"
#include "cblas.h"
#include "dense.h"
#include "schur.h"

#include <math.h>
#include <string.h>

/* Maximum of block rows times size; maximum of states; relative thresholds of singular values. */
enum { MOST_ROWS = 160, MOST_STATES = 60 };
static const double nothing = 1e-10, fits = 1e-9, as_good = 3, nothing_fits = 0.3;

typedef struct hankel {
    int size, rows, m;                 /* of Y; blocks; size * rows */
    int64_t *at;                       /* [rows] */
    double *U, *V, *next, *G, *S;      /* [m][m] four times, [m] */
    double complex *A, *Q, *workspace; /* [MOST_STATES][MOST_STATES] twice; more */
} hankel;

void spari_decay_free(spari_decay *d) {
    SPARI_FREE(d->z, d->left, d->right);
    *d = (spari_decay){0};
}

int spari_decay_solve(int n, double complex *A, int columns, double complex *b) {
    for (int k = 0; k < n; k++) {
        int p = k;
        for (int i = k + 1; i < n; i++) {
            p = cabs(A[n * i + k]) > cabs(A[n * p + k]) ? i : p;
        }
        if (!(cabs(A[n * p + k]) > 0) || !isfinite(cabs(A[n * p + k]))) {
            return 1;
        }
        for (int j = 0; j < n && p != k; j++) {
            double complex x = A[n * k + j];
            A[n * k + j] = A[n * p + j], A[n * p + j] = x;
        }
        for (int j = 0; j < columns && p != k; j++) {
            double complex x = b[columns * k + j];
            b[columns * k + j] = b[columns * p + j], b[columns * p + j] = x;
        }
        for (int i = 0; i < n; i++) {
            double complex f = i == k ? 0 : A[n * i + k] / A[n * k + k];
            for (int j = k; j < n && i != k; j++) {
                A[n * i + j] -= f * A[n * k + j];
            }
            for (int j = 0; j < columns && i != k; j++) {
                b[columns * i + j] -= f * b[columns * k + j];
            }
        }
    }
    for (int i = 0; i < n * columns; i++) {
        b[i] /= A[(n + 1) * (i / columns)];
    }
    return 0;
}

static int hankel_create(hankel *h, int size, int64_t count) {
    int64_t rows = MOST_ROWS / size > 4 ? MOST_ROWS / size : 4, states = MOST_STATES;
    rows = rows < count / 3 ? rows : count / 3;
    *h = (hankel){.size = size, .rows = (int)rows, .m = (int)rows * size};
    int64_t square = (int64_t)h->m * h->m;
    h->at = spari_zalloc(rows, sizeof *h->at);
    h->A = spari_zalloc(3 * states * states + 4 * states, sizeof *h->A);
    h->Q = h->A ? h->A + states * states : NULL;
    h->workspace = h->Q ? h->Q + states * states : NULL;
    h->U = spari_zalloc(4 * square + h->m, sizeof *h->U);
    h->V = h->U + square, h->next = h->V + square, h->G = h->next + square, h->S = h->G + square;
    return h->at && h->A && h->U ? SPAR_OK : SPAR_ERR_MEMORY;
}

/* Computes U, S, V, and G = U^T (O A X) V. */
static int decompose(hankel *h, const double *y) {
    int n = h->size, m = h->m;
    for (int i = 0; i < m; i++) {
        for (int j = 0; j < m; j++) {
            const double *Y = y + n * n * (h->at[i / n] + h->at[j / n]) + n * (i % n) + j % n;
            h->U[m * i + j] = Y[0];
            h->next[m * i + j] = Y[n * n];
        }
    }
    SPARI_TRY(spari_singular_values(m, h->U, h->S, h->V));
    SPARI_BLAS(cblas_dgemm(CblasRowMajor, CblasTrans, CblasNoTrans, m, m, m, 1, h->U, m, h->next, m, 0, h->G, m));
    SPARI_BLAS(cblas_dgemm(CblasRowMajor, CblasNoTrans, CblasNoTrans, m, m, m, 1, h->G, m, h->V, m, 0, h->next, m));
    memcpy(h->G, h->next, (size_t)m * (size_t)m * sizeof *h->G);
    return SPAR_OK;
}

static double root_of(const hankel *h, int i) {
    return sqrt(h->S[i]);
}

/* System with r states, by its eigenvectors. Returns 1 if they are not independent. */
static int find_system(hankel *h, int r, spari_decay *d) {
    int n = h->size;
    for (int i = 0; i < r * r; i++) {
        h->A[i] = h->G[h->m * (i / r) + i % r] / (root_of(h, i / r) * root_of(h, i % r));
    }
    if (spari_schur(r, h->A, h->Q, 0, h->workspace)) {
        return 1;
    }
    double complex *x = h->workspace, *W = x + 2 * MOST_STATES; /* columns of W: eigenvectors */
    for (int k = 0; k < r; k++) {
        d->z[k] = h->A[(r + 1) * k];
        spari_schur_vector(r, h->A, h->Q, k, x, x + MOST_STATES);
        for (int i = 0; i < r; i++) {
            W[r * i + k] = x[i];
        }
    }
    for (int k = 0; k < r; k++) {
        for (int i = 0; i < n; i++) {
            d->left[n * k + i] = 0;
            d->right[n * k + i] = root_of(h, k) * h->V[h->m * i + k];
            for (int l = 0; l < r; l++) {
                d->left[n * k + i] += h->U[h->m * i + l] * root_of(h, l) * W[r * l + k];
            }
        }
    }
    d->order = r;
    return spari_decay_solve(r, W, n, d->right);
}

/* power [order], sum [size]: workspace */
static double misfit_of(const spari_decay *d, int64_t count, const double *y, double most, double complex *power) {
    int n = d->size;
    double worst = 0;
    for (int i = 0; i < d->order; i++) {
        power[i] = 1;
    }
    for (int64_t k = 0; k < count; k++) {
        for (int e = 0; e < n * n; e++) {
            double complex sum = 0;
            for (int i = 0; i < d->order; i++) {
                sum += d->left[n * i + e / n] * power[i] * d->right[n * i + e % n];
            }
            double off = cabs(y[n * n * k + e] - sum) / most;
            worst = off > worst || isnan(off) ? off : worst;
        }
        for (int i = 0; i < d->order; i++) {
            power[i] *= d->z[i];
        }
    }
    return isnan(worst) ? INFINITY : worst;
}

/* Fit with r states. A growing one is accepted only if may_grow: the response of a fluid decays. */
static double try_order(hankel *h, int r, int64_t count, const double *y, double most, int may_grow, spari_decay *d) {
    if (find_system(h, r, d)) {
        return INFINITY;
    }
    for (int i = 0; i < r && !may_grow; i++) {
        if (cabs(d->z[i]) > 1 + 1e-9) {
            return INFINITY;
        }
    }
    return misfit_of(d, count, y, most, h->workspace);
}

/* Fewest states whose fit is nearly the best. */
static void choose_order(hankel *h, int64_t count, const double *y, double most, spari_decay *d) {
    int top = 0, best = 0;
    double least = INFINITY, found = INFINITY;
    while (top < h->m && top < MOST_STATES && h->S[top] > nothing * h->S[0]) {
        top++;
    }
    for (int may_grow = 0; may_grow < 2 && !(least < INFINITY); may_grow++) {
        for (int r = 1; r <= top && !(least <= fits); r++) {
            least = fmin(least, try_order(h, r, count, y, most, may_grow, d));
        }
        for (int r = 1; r <= top && !best && least < INFINITY; r++) {
            found = try_order(h, r, count, y, most, may_grow, d);
            best = found <= as_good * least ? r : 0;
        }
    }
    int noise = !best || found > nothing_fits; /* no linear system */
    d->order = noise ? 0 : best;
    d->misfit = noise ? 1 : found;
}

int spari_decay_fit(int size, int64_t count, const double *y, double noise, spari_decay *d) {
    double most = 0;
    *d = (spari_decay){.size = size};
    for (int64_t i = 0; i < count * size * size; i++) {
        if (!isfinite(y[i])) {
            return SPAR_ERR_NUMERIC;
        }
        most = fmax(most, fabs(y[i]));
    }
    d->largest = most;
    if (!(most > noise) || count < 3) {
        d->misfit = most > noise;
        return SPAR_OK;
    }
    hankel h;
    d->z = spari_zalloc(MOST_STATES, sizeof *d->z);
    d->left = spari_zalloc((int64_t)MOST_STATES * size, sizeof *d->left);
    d->right = spari_zalloc((int64_t)MOST_STATES * size, sizeof *d->right);
    int status = hankel_create(&h, size, count);
    status = status == SPAR_OK && d->z && d->left && d->right ? SPAR_OK : SPAR_ERR_MEMORY;
    /* Indices of the block rows and columns: 0, 1, .. and then increasingly distant, up to a third of the samples. The
       last third of Y is predicted, which noise cannot be. */
    const int64_t last = count / 3 - 1;
    for (int i = 0; i < h.rows && status == SPAR_OK; i++) {
        double part = h.rows > 1 ? (double)i / (h.rows - 1) : 0;
        int64_t at = (int64_t)(part * part * (double)last), next = i > 0 ? h.at[i - 1] + 1 : 0;
        h.at[i] = at > next ? at : next;
    }
    if (status == SPAR_OK) {
        status = decompose(&h, y);
    }
    if (status == SPAR_OK) {
        choose_order(&h, count, y, most, d);
    }
    SPARI_FREE(h.at, h.A, h.U);
    return status;
}
