/* Arnoldi's method with Krylov-Schur restarts (Stewart, SIAM J. Matrix Anal. Appl. 23, 2001): T V = V S + v b, S
   upper triangular. The Schur vectors of the largest eigenvalues are kept and the subspace is grown again. One start
   vector finds one copy of a multiple eigenvalue, as of a beam with equal bending stiffness in two planes. So
   converged vectors are locked and the search continues from another vector until nothing new is found. */
#include "arnoldi.h"

#include "../base/status.h"
#include "cblas.h"
#include "schur.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double converged_at = 1e-12, same_value = 1e-8;
enum { MOST_RESTARTS = 200, MOST_SEARCHES = 8 };

typedef struct krylov {
    const spari_arnoldi_problem *of;
    int size, most, kept;          /* size of a vector; largest and kept number of vectors */
    double complex *V;             /* [most + 1][size] orthonormal */
    double complex *H;             /* [most + 1][most]; S is its square part after a restart */
    double complex *S, *Q, *b, *h; /* [most][most] twice; [most + 1] twice */
    double left;                   /* norm of the last vector outside the subspace */
    double complex *workspace;     /* [most][size] */
    double *last;                  /* [most] moduli found by the search before */
    uint64_t seed;
} krylov;

static int krylov_create(krylov *k) {
    int64_t m = k->most, n = k->size;
    k->V = spari_zalloc((m + 1) * n, sizeof *k->V);
    k->H = spari_zalloc((m + 1) * m, sizeof *k->H);
    k->S = spari_zalloc(2 * m * m + 5 * m + 2, sizeof *k->S);
    k->workspace = spari_zalloc(m * n, sizeof *k->workspace);
    k->last = spari_zalloc(m, sizeof *k->last);
    k->Q = k->S ? k->S + m * m : NULL;
    k->b = k->Q ? k->Q + m * m : NULL;
    k->h = k->b ? k->b + m + 1 : NULL;
    return k->V && k->H && k->S && k->workspace && k->last;
}

/* Orthogonalises x against the first `count` vectors of V, twice; h [count]: the coefficients. Returns the norm of
   x. */
static double orthogonal_to(const krylov *k, int count, double complex *x, double complex *h) {
    const double complex one = 1, minus = -1, zero = 0;
    memset(h, 0, (size_t)count * sizeof *h);
    for (int pass = 0; pass < 2 && count > 0; pass++) {
        SPARI_BLAS(
            cblas_zgemv(CblasColMajor, CblasConjTrans, k->size, count, &one, k->V, k->size, x, 1, &zero, k->b, 1));
        SPARI_BLAS(
            cblas_zgemv(CblasColMajor, CblasNoTrans, k->size, count, &minus, k->V, k->size, k->b, 1, &one, x, 1));
        for (int j = 0; j < count; j++) {
            h[j] += k->b[j];
        }
    }
    return cblas_dznrm2(k->size, x, 1);
}

/* Sets vector `at` of V to any vector orthogonal to those before it, in the range of the operator. 1: there is none. */
static int any_vector(krylov *k, int at) {
    double complex *x = k->V + (int64_t)k->size * at, *y = k->workspace;
    for (int attempt = 0; attempt < 3; attempt++) {
        for (int i = 0; i < k->size; i++) {
            k->seed = k->seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
            y[i] = (double)(k->seed >> 11) * 0x1p-53 - 0.5;
        }
        k->of->apply(k->of->self, y, x);
        double size = cblas_dznrm2(k->size, x, 1), left = orthogonal_to(k, at, x, k->h);
        if (left > 1e-10 * size && isfinite(left)) {
            cblas_zdscal(k->size, 1 / left, x, 1);
            return 0;
        }
    }
    return 1;
}

/* Grows the subspace from `kept` vectors and one more to `most`, or as far as possible; returns its size. */
static int grow_subspace(krylov *k) {
    for (int j = k->kept; j < k->most; j++) {
        double complex *x = k->V + (int64_t)k->size * (j + 1);
        k->of->apply(k->of->self, x - k->size, x);
        double size = cblas_dznrm2(k->size, x, 1), left = orthogonal_to(k, j + 1, x, k->h);
        if (!isfinite(left)) {
            return -1;
        }
        for (int i = 0; i <= j; i++) {
            k->H[(int64_t)k->most * i + j] = k->h[i];
        }
        k->left = left > 1e-14 * size ? left : 0;
        k->H[(int64_t)k->most * (j + 1) + j] = k->left;
        if (k->left > 0) {
            cblas_zdscal(k->size, 1 / left, x, 1);
        } else if (j + 1 == k->most || any_vector(k, j + 1)) {
            return j + 1;
        }
    }
    return k->most;
}

/* Schur form of the projected matrix with the largest eigenvalues first, and b. 0 or 1. */
static int order_subspace(krylov *k, int m) {
    for (int i = 0; i < m; i++) {
        memcpy(k->S + (int64_t)m * i, k->H + (int64_t)k->most * i, (size_t)m * sizeof *k->S);
    }
    if (spari_schur(m, k->S, k->Q, 1, k->h)) {
        return 1;
    }
    for (int j = 0; j < m; j++) {
        k->b[j] = k->left * k->Q[(int64_t)m * (m - 1) + j];
    }
    return 0;
}

/* Keeps the first p of the m Schur vectors and the residual vector, or another vector if `beside` says that the kept
   ones have converged. 1: there is none. */
static int restart(krylov *k, int m, int p, int beside) {
    const double complex one = 1, zero = 0;
    SPARI_BLAS(cblas_zgemm(CblasColMajor, CblasNoTrans, CblasTrans, k->size, p, m, &one, k->V, k->size, k->Q, m, &zero,
                           k->workspace, k->size));
    memcpy(k->V, k->workspace, (size_t)p * (size_t)k->size * sizeof *k->V);
    memset(k->H, 0, ((size_t)k->most + 1) * (size_t)k->most * sizeof *k->H);
    for (int i = 0; i < p; i++) {
        memcpy(k->H + (int64_t)k->most * i, k->S + (int64_t)m * i, (size_t)p * sizeof *k->H);
    }
    k->kept = p;
    if (beside) {
        return any_vector(k, p);
    }
    memcpy(k->H + (int64_t)k->most * p, k->b, (size_t)p * sizeof *k->H);
    memmove(k->V + (int64_t)k->size * p, k->V + (int64_t)k->size * m, (size_t)k->size * sizeof *k->V);
    return 0;
}

/* Whether the search after locking has found nothing new; stores the moduli for the next. */
static int nothing_new(krylov *k, int m, int count) {
    int same = 1;
    for (int i = 0; i < count; i++) {
        double size = cabs(k->S[(int64_t)(m + 1) * i]);
        same = same && fabs(size - k->last[i]) <= same_value * size;
        k->last[i] = size;
    }
    return same;
}

/* No further vector exists: the p kept vectors are the subspace. */
static int stay_with(krylov *k, int p) {
    for (int i = 0; i < p * p; i++) {
        k->S[i] = k->H[(int64_t)k->most * (i / p) + i % p];
        k->Q[i] = i % (p + 1) == 0;
    }
    return p;
}

/* Size of the subspace, or -1; *count of its first Schur vectors are the wanted ones. */
static int search_subspaces(krylov *k, int wanted, int *count) {
    for (int pass = 0, searches = 0; pass < MOST_RESTARTS; pass++) {
        int m = grow_subspace(k);
        if (m < 0 || order_subspace(k, m)) {
            return -1;
        }
        for (*count = 0; *count < wanted && *count < m; ++*count) {
            if (!(cabs(k->b[*count]) <= converged_at * cabs(k->S[(int64_t)(m + 1) * *count]))) {
                break;
            }
        }
        int whole = m < k->most || m == k->of->rank;
        int all = *count == (wanted < m ? wanted : m);
        int last = pass + 1 == MOST_RESTARTS || searches == MOST_SEARCHES;
        if (whole || last || (all && nothing_new(k, m, *count))) {
            return m;
        }
        searches += all;
        int keep = all ? *count : wanted + (m - wanted) / 2;
        if (restart(k, m, keep, all)) {
            return stay_with(k, keep);
        }
    }
    return -1;
}

/* z [count][size]: eigenvectors of T. */
static void give_vectors(krylov *k, int m, int count, double complex *mu, double complex *z) {
    const double complex one = 1, zero = 0;
    for (int j = 0; j < count; j++) {
        mu[j] = k->S[(int64_t)(m + 1) * j];
        spari_schur_vector(m, k->S, k->Q, j, k->h, k->b);
        SPARI_BLAS(cblas_zgemv(CblasColMajor, CblasNoTrans, k->size, m, &one, k->V, k->size, k->h, 1, &zero,
                               z + (int64_t)k->size * j, 1));
    }
}

int spari_arnoldi(const spari_arnoldi_problem *of, int wanted, int *count, double complex *mu, double complex *z) {
    int most = 2 * wanted + 20 > 40 ? 2 * wanted + 20 : 40;
    krylov k = {.of = of, .size = of->size, .most = most < of->rank ? most : of->rank, .seed = 1};
    *count = 0;
    int status = krylov_create(&k) ? SPAR_OK : SPAR_ERR_MEMORY;
    if (status == SPAR_OK && !any_vector(&k, 0)) {
        int found = 0, m = search_subspaces(&k, wanted, &found);
        if (m >= 0) {
            give_vectors(&k, m, found, mu, z);
        }
        *count = m >= 0 ? found : 0;
        status = m >= 0 ? SPAR_OK : SPAR_ERR_NUMERIC;
    }
    SPARI_FREE(k.V, k.H, k.S, k.workspace, k.last);
    return status;
}
