/* Lowest modes: see lowest_modes.h. The operator T = (K + sigma M)^-1 M has the eigenvalues mu = 1 / (omega^2 + sigma).
   Lanczos's method with a block of start vectors (Ruhe 1979), full orthogonalisation in the norm of the mass, and
   restarts with Ritz vectors (Wu and Simon 2000) finds the largest mu: T V = V H + the vectors in front times the last
   rows of H. A block finds as many copies of a multiple eigenvalue as it has vectors. So the number of eigenvalues
   below the largest one found is compared with the number from the factors (Sylvester). If one is missing, the search
   goes on from other vectors beside those found. The start vectors are fixed: the same bits in every run. */
#include "lowest_modes.h"

#include "../base/status.h"
#include "cblas.h"
#include "eigen.h"
#include "shifted.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* converged: residual of a Ritz pair of T relative to mu. accepted: the same by a new product, relative to mu, and
   accepted_rounding relative to the largest mu. */
static const double converged = 1e-12, accepted = 1e-6, accepted_rounding = 1e-9;
enum { BLOCK = 6, MOST_RESTARTS = 300, FIRST_LOOK = 24 };

typedef struct lanczos {
    spari_shifted *of;
    int n, dimension, most, block; /* unknowns; of the space; largest and block of the subspace */
    int count, done;               /* vectors; those whose product with T is in H */
    double *V, *Z;                 /* [most + block][n]: vectors, M times vectors */
    double *H;                     /* [most][most + block]: row j: T v_j */
    double *S, *mu, *left;         /* Ritz vectors of H in rows, descending mu, and their residuals */
    double *workspace;             /* [most + 1][n] */
    uint64_t seed;
} lanczos;

static int lanczos_create(lanczos *k, spari_shifted *of, int most) {
    int64_t n = of->n;
    *k = (lanczos){.of = of, .n = of->n, .dimension = of->n - of->rank, .seed = 1};
    k->most = most < k->dimension ? most : k->dimension;
    k->block = BLOCK < k->dimension ? BLOCK : k->dimension;
    int64_t m = k->most, all = m + k->block;
    k->V = spari_zalloc(2 * all * n + (m + 1) * n, sizeof *k->V);
    k->H = spari_zalloc(2 * m * all + m * m + 2 * m + 2 * all, sizeof *k->H);
    if (!k->V || !k->H) {
        return SPAR_ERR_MEMORY;
    }
    k->Z = k->V + all * n;
    k->workspace = k->Z + all * n;
    k->S = k->H + m * all;
    k->mu = k->S + m * m;
    k->left = k->mu + m;
    return SPAR_OK;
}

/* ---- the subspace ---- */

/* Orthogonalises x against all vectors, twice; h [count]: the coefficients. */
static void orthogonalise(lanczos *k, double *x, double *h) {
    double *part = k->left + k->most;
    memset(h, 0, (size_t)k->count * sizeof *h);
    for (int pass = 0; pass < 2 && k->count > 0; pass++) {
        SPARI_BLAS(cblas_dgemv(CblasRowMajor, CblasNoTrans, k->count, k->n, 1, k->Z, k->n, x, 1, 0, part, 1));
        SPARI_BLAS(cblas_dgemv(CblasRowMajor, CblasTrans, k->count, k->n, -1, k->V, k->n, part, 1, 1, x, 1));
        cblas_daxpy(k->count, 1, part, 1, h, 1);
    }
}

/* Takes vector `count` of V, orthogonalised, into the basis. Returns its norm, or 0 if nothing but rounding is left of
   its former size, of which h are the other parts. */
static double take_vector(lanczos *k, const double *h) {
    double *x = k->V + (int64_t)k->n * k->count, *z = k->Z + (int64_t)k->n * k->count;
    double square, parts = cblas_dnrm2(k->count, h, 1);
    spari_shifted_mass(k->of, x, z);
    square = cblas_ddot(k->n, x, 1, z, 1);
    double norm = square > 0 ? sqrt(square) : 0;
    if (!(norm > 1e-14 * hypot(parts, norm)) || !isfinite(norm)) {
        return isfinite(square) ? 0 : NAN;
    }
    cblas_dscal(k->n, 1 / norm, x, 1);
    cblas_dscal(k->n, 1 / norm, z, 1);
    k->count++;
    return norm;
}

/* Adds any vector in the range of T that is orthogonal to all others. Returns 0 if there is none. */
static int add_any_vector(lanczos *k) {
    double *x = k->V + (int64_t)k->n * k->count, *h = k->left + k->most + (k->most + k->block), *start = k->workspace;
    for (int attempt = 0; attempt < 3 && k->count < k->dimension; attempt++) {
        for (int i = 0; i < k->n; i++) {
            k->seed = k->seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
            start[i] = (double)(k->seed >> 11) * 0x1p-53 - 0.5;
        }
        spari_shifted_mass(k->of, start, x);
        (void)spari_shifted_solve(k->of, x);
        spari_shifted_mass(k->of, x, start);
        double size = cblas_ddot(k->n, x, 1, start, 1);
        orthogonalise(k, x, h);
        spari_shifted_mass(k->of, x, start);
        double rest = cblas_ddot(k->n, x, 1, start, 1);
        if (rest > 1e-20 * size && isfinite(rest) && take_vector(k, h) > 0) {
            return 1;
        }
    }
    return 0;
}

/* Grows the subspace until `to` vectors have their products, or as far as possible. Returns 1 if a number is not
   finite. */
static int grow_basis(lanczos *k, int to) {
    int all = k->most + k->block;
    while (k->count < k->done + k->block && add_any_vector(k)) {
    }
    for (; k->done < to && k->done < k->count; k->done++) {
        double *x = k->V + (int64_t)k->n * k->count, *h = k->H + (int64_t)all * k->done;
        memcpy(x, k->Z + (int64_t)k->n * k->done, (size_t)k->n * sizeof *x);
        if (spari_shifted_solve(k->of, x)) {
            return 1;
        }
        memset(h, 0, (size_t)all * sizeof *h);
        orthogonalise(k, x, h);
        int vectors = k->count;
        double norm = vectors < k->dimension ? take_vector(k, h) : 0;
        if (!isfinite(norm)) {
            return 1;
        }
        if (norm > 0) {
            h[vectors] = norm;
        } else {
            (void)add_any_vector(k);
        }
    }
    return 0;
}

/* Ritz values and vectors of the subspace, and their residuals. 0 or a status. */
static int ritz(lanczos *k) {
    int m = k->done, all = k->most + k->block, status;
    double *A = k->left + k->most + 2 * all, *workspace = k->workspace;
    double *own = NULL;
    if (SPARI_SYMMETRIC_ROOM((int64_t)m) > (int64_t)k->most * k->n) {
        workspace = own = spari_zalloc(SPARI_SYMMETRIC_ROOM((int64_t)m), sizeof *own);
        if (!own) {
            return SPAR_ERR_MEMORY;
        }
    }
    for (int i = 0; i < m * m; i++) {
        A[i] = 0.5 * (k->H[(int64_t)all * (i / m) + i % m] + k->H[(int64_t)all * (i % m) + i / m]);
    }
    status = spari_symmetric(m, A, k->left, workspace);
    free(own);
    for (int j = 0; j < m; j++) {
        k->mu[j] = k->left[m - 1 - j];
        memcpy(k->S + (int64_t)m * j, A + (int64_t)m * (m - 1 - j), (size_t)m * sizeof *k->S);
    }
    for (int j = 0; j < m; j++) {
        k->left[j] = 0;
        for (int i = m; i < k->count; i++) {
            double sum = 0;
            for (int l = 0; l < m; l++) {
                sum += k->H[(int64_t)all * l + i] * k->S[(int64_t)m * j + l];
            }
            k->left[j] = hypot(k->left[j], sum);
        }
    }
    return status;
}

/* X [p][n] := the first p Ritz vectors' combinations of the vectors in X */
static void combine(lanczos *k, int p, double *X) {
    SPARI_BLAS(cblas_dgemm(CblasRowMajor, CblasNoTrans, CblasNoTrans, p, k->n, k->done, 1, k->S, k->done, X, k->n, 0,
                           k->workspace, k->n));
    memcpy(X, k->workspace, (size_t)p * (size_t)k->n * sizeof *X);
}

/* Keeps p Ritz vectors, and the vectors in front unless `beside`: the search goes on beside those kept. */
static void keep_ritz_vectors(lanczos *k, int p, int beside) {
    int m = k->done, all = k->most + k->block, front = beside ? 0 : k->count - m;
    double *C = k->left + k->most + 2 * all; /* [p][front] */
    for (int i = 0; i < p * front; i++) {
        C[i] = 0;
        for (int l = 0; l < m; l++) {
            C[i] += k->H[(int64_t)all * l + m + i % front] * k->S[(int64_t)m * (i / front) + l];
        }
    }
    combine(k, p, k->V);
    combine(k, p, k->Z);
    memmove(k->V + (int64_t)k->n * p, k->V + (int64_t)k->n * m, (size_t)front * (size_t)k->n * sizeof *k->V);
    memmove(k->Z + (int64_t)k->n * p, k->Z + (int64_t)k->n * m, (size_t)front * (size_t)k->n * sizeof *k->Z);
    memset(k->H, 0, (size_t)p * (size_t)all * sizeof *k->H);
    for (int i = 0; i < p; i++) {
        k->H[(int64_t)all * i + i] = k->mu[i];
        for (int j = 0; j < front; j++) {
            k->H[(int64_t)all * i + p + j] = C[front * i + j];
        }
    }
    k->done = p;
    k->count = p + front;
}

/* ---- none is missing ---- */

/* Whether the first `wanted` Ritz values are all eigenvalues up to the last of them: 1; 0: one is missing; -1: the
   factors do not say. Restores the shift. */
static int none_missing(lanczos *k, int wanted) {
    double sigma = k->of->sigma, last = 1 / k->mu[wanted - 1];
    int known = -1;
    for (double beside = 1e-6; beside < 1e-3 && known < 0; beside *= 10) {
        double limit = last * (1 - beside); /* of omega^2 + sigma */
        int found = 0;
        while (found < wanted && 1 / k->mu[found] < limit) {
            found++;
        }
        if (found == 0 || limit == sigma) {
            known = found == 0 ? 1 : -1;
        } else if (!spari_shifted_factor(k->of, sigma - limit) && k->of->below >= found) {
            known = k->of->below == found;
        }
    }
    if (k->of->sigma != sigma) {
        (void)spari_shifted_factor(k->of, sigma);
    }
    return known;
}

/* Finds the first `wanted` Ritz values, or all that have mass. 0 or a status. */
static int search(lanczos *k, int wanted) {
    for (int pass = 0; pass < MOST_RESTARTS; pass++) {
        if (grow_basis(k, k->most)) {
            return SPAR_ERR_NUMERIC;
        }
        SPARI_TRY(ritz(k));
        if (k->done == k->count) { /* the whole space */
            return SPAR_OK;
        }
        int found = 0;
        while (found < wanted && found < k->done && k->left[found] <= converged * fabs(k->mu[found])) {
            found++;
        }
        int complete = found == wanted ? none_missing(k, wanted) : 0;
        if (complete != 0) {
            return complete > 0 ? SPAR_OK : SPAR_ERR_NUMERIC;
        }
        int beside = found == wanted;
        keep_ritz_vectors(k, beside ? wanted : wanted + (k->done - wanted) / 2, beside);
    }
    return SPAR_ERR_NUMERIC;
}

/* ---- the shift ---- */

/* Whether K x is rounding error alone for the motion of least stiffness, by steps of x := K^-1 M x. (The factorisation
   of a singular matrix may succeed by rounding.) Rows are scaled by the roots of their stiffness. */
static int has_loose_motion(lanczos *k) {
    enum { STEPS = 4 };
    const double only_rounding = 1e-11;
    const spari_shifted *a = k->of;
    double left = 0, size = 0, *x = k->V, *y = k->Z;
    for (int i = 0; i < k->n; i++) {
        x[i] = 1 + 0.3 * sin(12.9898 * (double)(i + 1));
    }
    for (int step = 0; step < STEPS; step++) {
        double norm = cblas_dnrm2(k->n, x, 1);
        cblas_dscal(k->n, norm > 0 ? 1 / norm : 0, x, 1);
        spari_shifted_mass(a, x, y);
        memcpy(x, y, (size_t)k->n * sizeof *x);
        (void)spari_shifted_solve(k->of, x);
    }
    for (int i = 0; i < k->n; i++) {
        double sum = 0, of_sizes = 0, own = 0;
        for (int64_t e = a->begin[i]; e < a->begin[i + 1]; e++) {
            double product = a->k[e] * x[a->column[e]];
            sum += product;
            of_sizes += fabs(product);
            own = a->column[e] == i ? sqrt(fabs(a->k[e])) : own;
        }
        left = hypot(left, own > 0 ? sum / own : 0);
        size = hypot(size, own > 0 ? of_sizes / own : 0);
    }
    return !(left > only_rounding * size);
}

/* Largest sum of |K_ij| / sqrt(M_ii M_jj) over j: of loads on a rigid body K may have nothing on its diagonal. */
static double highest_of_rows(lanczos *k) {
    const spari_shifted *a = k->of;
    double highest = 0, *mass = k->workspace;
    for (int i = 0; i < k->n; i++) {
        mass[i] = 0;
        for (int64_t e = a->begin[i]; e < a->begin[i + 1]; e++) {
            mass[i] = a->column[e] == i ? a->m[e] : mass[i];
        }
    }
    for (int i = 0; i < k->n; i++) {
        double sum = 0;
        for (int64_t e = a->begin[i]; e < a->begin[i + 1]; e++) {
            const double product = mass[i] * mass[a->column[e]];
            sum += product > 0 ? fabs(a->k[e]) / sqrt(product) : 0;
        }
        highest = fmax(highest, sum);
    }
    return highest;
}

static int definite_at(spari_shifted *a, double sigma) {
    return !spari_shifted_factor(a, sigma) && a->below == 0;
}

/* A shift that makes the stiffness positive definite: 0 if it is so beyond rounding and nothing is constrained, else
   the smallest in steps of 10 from 1e-6 of the largest K_ii / M_ii. Returns 0, or 1 if there is none. */
static int first_shift(lanczos *k) {
    spari_shifted *a = k->of;
    if (a->less > 0) {
        return !definite_at(a, 0);
    }
    if (a->rank == 0 && definite_at(a, 0) && !has_loose_motion(k)) {
        return 0;
    }
    for (double f = 1e-6; f < 1e4 && a->highest > 0; f *= 10) {
        if (definite_at(a, f * a->highest)) {
            return 0;
        }
    }
    const double highest = highest_of_rows(k);
    for (double f = 1; f < 1e4 && highest > a->highest; f *= 10) {
        if (definite_at(a, f * highest)) {
            return 0;
        }
    }
    return a->highest > 0 || !definite_at(a, 1); /* 1: an unconstrained rigid body */
}

/* What rounding of the stiffness may change of omega^2 of the first Ritz vectors: eps |x| |K| |x| for unit mass. */
static double rounding_of_stiffness(lanczos *k) {
    const spari_shifted *a = k->of;
    double most = 0, *x = k->workspace;
    for (int j = 0; j < BLOCK && j < k->done; j++) {
        double sum = 0;
        SPARI_BLAS(cblas_dgemv(CblasRowMajor, CblasTrans, k->done, k->n, 1, k->V, k->n, k->S + (int64_t)k->done * j, 1,
                               0, x, 1));
        for (int i = 0; i < k->n; i++) {
            for (int64_t e = a->begin[i]; e < a->begin[i + 1]; e++) {
                sum += fabs(x[i] * a->k[e] * x[a->column[e]]);
            }
        }
        most = fmax(most, DBL_EPSILON * sum);
    }
    return most;
}

/* Lowers the shift to the size of the wanted omega^2, as a few products show them. A shift far above hides the low
   modes; one far below makes mu of rigid motions so large that rounding hides the other modes. Rounding of the
   stiffness is a tenth of `accepted` of the shift at most. 0 or a status. */
static int lower_shift(lanczos *k, int wanted) {
    enum { LOOKS = 6 };
    for (int look = 0; look < LOOKS && k->of->sigma > 0; look++) {
        double sigma = k->of->sigma, next = 0, below = 0;
        k->count = k->done = 0;
        if (grow_basis(k, k->most < FIRST_LOOK ? k->most : FIRST_LOOK)) {
            return SPAR_ERR_NUMERIC;
        }
        SPARI_TRY(ritz(k));
        for (int j = 0; j < k->done && k->mu[j] > 0; j++) {
            double square = 1 / k->mu[j] - sigma;
            below = square < -1e-9 * sigma ? fmax(below, -square) : below;
            if (square > 1e-9 * sigma && (j >= wanted / 2 || j == k->done - 1) && !(next > 0)) {
                next = square;
            }
        }
        next = fmax(next, 2 * below);
        next = next > 0 ? fmax(next, 10 / accepted * rounding_of_stiffness(k)) : 0;
        if (!(next > 0) || next > 0.3 * sigma) {
            break;
        }
        while (next < sigma && !definite_at(k->of, next)) {
            next *= 4;
        }
        if (!(next < sigma)) {
            (void)spari_shifted_factor(k->of, sigma);
            break;
        }
    }
    k->count = k->done = 0;
    return SPAR_OK;
}

/* ---- results ---- */

/* Modes from the Ritz vectors, verified with a new product. 0 or a status. */
static int give_modes(lanczos *k, int n, double *square, double *x) {
    int found = n < k->done ? n : k->done;
    if (found > 0) {
        SPARI_BLAS(cblas_dgemm(CblasRowMajor, CblasNoTrans, CblasNoTrans, found, k->n, k->done, 1, k->S, k->done, k->V,
                               k->n, 0, x, k->n));
    }
    for (int j = 0; j < n; j++) {
        double *mode = x + (int64_t)k->n * j, *y = k->workspace, *z = y + k->n, left = 0;
        if (j >= found || !(k->mu[j] > 0)) {
            square[j] = INFINITY;
            continue;
        }
        spari_shifted_mass(k->of, mode, y);
        (void)spari_shifted_solve(k->of, y);
        cblas_daxpy(k->n, -k->mu[j], mode, 1, y, 1);
        spari_shifted_mass(k->of, y, z);
        left = sqrt(fmax(0, cblas_ddot(k->n, y, 1, z, 1)));
        if (!(left <= accepted * k->mu[j] + accepted_rounding * k->mu[0])) {
            return SPAR_ERR_NUMERIC;
        }
        square[j] = 1 / k->mu[j] - k->of->sigma;
    }
    return SPAR_OK;
}

int spari_lowest_modes(const spari_modes_problem *problem, int n, double *square, double *x, int *available) {
    spari_shifted a;
    lanczos k = {0};
    int status = spari_shifted_create(&a, problem->pencil, problem->block, problem->less, problem->W);
    *available = a.n - a.rank;
    if (status == SPAR_OK && n > *available) {
        status = SPAR_ERR_ARGUMENT;
    }
    if (status == SPAR_OK && n > 0) {
        status = lanczos_create(&k, &a, n + (n > 8 * BLOCK ? n : 8 * BLOCK));
        status = status == SPAR_OK && first_shift(&k) ? SPAR_ERR_STATE : status;
        status = status == SPAR_OK ? lower_shift(&k, n) : status;
        status = status == SPAR_OK ? search(&k, n) : status;
        status = status == SPAR_OK ? give_modes(&k, n, square, x) : status;
    }
    SPARI_FREE(k.V, k.H);
    spari_shifted_free(&a);
    return status;
}
