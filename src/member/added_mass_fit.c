/* Added mass identified from coupling iterations by least squares: see added_mass_fit.h. */
#include "added_mass_fit.h"

#include "../algebra/dense.h"
#include "../algebra/eigen.h"
#include "../base/environment.h"
#include "../math/basis.h"
#include "../math/rotation.h"
#include "beam.h"
#include "check_arguments.h"
#include "mean_acceleration.h"

#include <math.h>
#include <string.h>

/* Scalars of the state; the sums decay with time.
   COUNT: differences, weighted relative to the largest of their step
   LEFT, WHOLE: squared error of the mass in predicting new differences, and squares of all these differences
   NOISE, SEEN: the same for directions observed before, without the error due to the limited data so far
   KNOWN, USED: whether a mass has been fitted, and whether it is in the equations
   STEP_*: the same for the current step, with its squares and the largest difference */
enum {
    COUNT,
    LEFT,
    WHOLE,
    NOISE,
    SEEN,
    KNOWN,
    USED,
    STEP_LEFT,
    STEP_WHOLE,
    STEP_NOISE,
    STEP_SEEN,
    STEP_SQUARES,
    STEP_LARGEST,
    HEADS
};

struct spari_learned {
    int64_t n, count; /* stations; size of the state in doubles */
    double *eta;
    double *head;         /* state: [HEADS], followed by: */
    double *force, *mass; /* [n][36] in the equations if USED; and the present fit */
    double *G, *B;        /* [n][n][36], [n][36] normal equations of the accepted steps, decaying */
    double *step_G, *step_B;
    double *one_G, *one_B;  /* of one difference; not part of the state */
    double *metric, *root;  /* [n][36] the member's own mass at the stations, and its Cholesky factor */
    double *axes, *squares; /* [n][36], [n][6] eigenvectors and eigenvalues of G: see look_around */
    double *plain;          /* [n][36] fit without regularisation */
};

/* ENOUGH: differences needed before the mass is tested. USE: relative prediction error below which the mass enters
   the equations; DROP: error above which it leaves them. FADE: decay factor per step. */
static const double ENOUGH = 2.5, USE = 0.25, DROP = 0.5, FADE = 0.9;
/* A direction with a smaller fraction of the squares than this counts as not observed. */
static const double UNSEEN = 1e-8;

/* ---- description ---- */

static int check_stations(const spar_member *m, const char *call, int64_t n, const double *eta) {
    spar_session *s = m->session;
    SPARI_REQUIRE(s, m->kind != SPARI_POINT, SPAR_ERR_UNSUPPORTED,
                  "%s: '%s' is a point with prescribed motion; added mass does not apply to points", call, m->name);
    SPARI_REQUIRE(s, n >= 0 && n <= SPARI_LEARNED_STATIONS && (n <= 1 || m->kind == SPARI_BEAM), SPAR_ERR_ARGUMENT,
                  "%s: '%s': %lld stations; give 1 to %d for a beam, 1 for a rigid body, or 0 to switch estimation off",
                  call, m->name, (long long)n, SPARI_LEARNED_STATIONS);
    return n > 0 && m->kind == SPARI_BEAM ? spari_need_eta(s, call, m->name, n, eta, SPARI_INCREASING) : SPAR_OK;
}

static spari_learned *create_learned(int64_t n, const double *eta) {
    spari_learned *l = spari_zalloc(1, sizeof *l);
    if (!l) {
        return NULL;
    }
    int64_t whole = 36 * n * n, each = 36 * n;
    l->n = n, l->count = HEADS + 2 * each + 2 * (whole + each);
    l->eta = eta ? spari_copy(eta, n) : spari_zalloc(n, sizeof *l->eta);
    l->head = spari_zalloc(l->count + whole + each + 4 * each + 6 * n, sizeof *l->head);
    if (!l->eta || !l->head) {
        spari_learned_free(l);
        return NULL;
    }
    l->force = l->head + HEADS, l->mass = l->force + each;
    l->G = l->mass + each, l->B = l->G + whole;
    l->step_G = l->B + each, l->step_B = l->step_G + whole;
    l->one_G = l->step_B + each, l->one_B = l->one_G + whole;
    l->metric = l->one_B + each, l->root = l->metric + each, l->axes = l->root + each;
    l->plain = l->axes + each, l->squares = l->plain + each;
    return l;
}

void spari_learned_free(spari_learned *l) {
    if (l) {
        SPARI_FREE(l->eta, l->head, l);
    }
}

int spar_member_learn_added_mass(spar_member *member, int64_t n, const double *eta) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_TRY(spari_need_open(member, __func__));
    SPARI_TRY(check_stations(member, __func__, n, eta));
    spari_learned *l = n > 0 ? create_learned(n, member->kind == SPARI_BEAM ? eta : NULL) : NULL;
    SPARI_REQUIRE(member->session, l || n == 0, SPAR_ERR_MEMORY, "%s: '%s': no memory for the added-mass estimate",
                  __func__, member->name);
    spari_learned_free(member->learned);
    member->learned = l;
    return SPAR_OK;
}

static double spread_of(const spari_learned *l) {
    return l->head[COUNT] >= ENOUGH && l->head[WHOLE] > 0 ? fmin(sqrt(l->head[LEFT] / l->head[WHOLE]), 1) : 1;
}

int spar_member_get_learned_added_mass(const spar_member *member, int *used, double *spread, int64_t *n,
                                       int64_t capacity, double *eta, double *mass) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_TRY(spari_need_member(member, __func__));
    SPARI_TRY(spari_need_capacity(member->session, __func__, capacity));
    const spari_learned *l = member->learned;
    SPARI_GIVE(used, l && l->head[USED] > 0);
    SPARI_GIVE(spread, l ? spread_of(l) : 1);
    SPARI_GIVE(n, l ? l->n : 0);
    spari_fill(capacity, eta, l ? l->n : 0, l ? l->eta : NULL);
    spari_fill(36 * capacity, mass, l ? 36 * l->n : 0, l ? l->mass : NULL);
    return SPAR_OK;
}

void spari_learned_part(const spar_member *m, spari_described *part) {
    const spari_learned *l = m->learned;
    spari_described_exact(part, l ? l->n : 0);
    spari_described_add(part, SPARI_NUMBERS_PLAIN, l ? l->n : 0, 1, l ? l->eta : NULL);
}

/* ---- metric of the differences ---- */

/* Cholesky factor of a symmetric matrix; pivots are at least a fraction of the diagonal. */
static void factor_metric(const double W[36], double S[36]) {
    for (int i = 0; i < 36; i++) {
        S[i] = i % 7 == 0 ? W[i] * (1 + 1e-6) + 1e-300 : W[i];
    }
    (void)spari_cholesky(6, S);
    for (int i = 0; i < 36; i++) {
        S[i] = i % 6 > i / 6 ? 0 : S[i];
    }
}

/* The member's own mass at the stations. Its rotary inertia is at least that of a body of a thousandth of its
   length. */
static void measure_stations(const spar_member *m, spari_learned *l) {
    static const double PART = 1e-6;
    double length = spari_member_length(m);
    for (int64_t s = 0; s < l->n; s++) {
        double *W = l->metric + 36 * s;
        if (m->kind == SPARI_BEAM && m->beam->mass) {
            spari_beam_section_at(m->beam, m->beam->mass, l->eta[s], W);
        } else {
            memcpy(W, m->mass, sizeof m->mass);
        }
        for (int i = 3; i < 6; i++) {
            W[7 * i] += PART * W[0] * length * length;
        }
        factor_metric(W, l->root + 36 * s);
    }
}

/* X := S^-1 X */
static void reduce_rows(const double S[36], double X[36]) {
    for (int j = 0; j < 6; j++) {
        for (int i = 0; i < 6; i++) {
            for (int k = 0; k < i; k++) {
                X[6 * i + j] -= S[6 * i + k] * X[6 * k + j];
            }
            X[6 * i + j] /= S[7 * i];
        }
    }
}

/* out := A B, or A^T B or A B^T as given by `turned` */
typedef enum turned_factor { NEITHER, FIRST, SECOND } turned_factor;
static void multiply_six(const double A[36], const double B[36], turned_factor turned, double out[36]) {
    for (int i = 0; i < 6; i++) {
        for (int j = 0; j < 6; j++) {
            double sum = 0;
            for (int k = 0; k < 6; k++) {
                sum +=
                    (turned == FIRST ? A[6 * k + i] : A[6 * i + k]) * (turned == SECOND ? B[6 * j + k] : B[6 * k + j]);
            }
            out[6 * i + j] = sum;
        }
    }
}

/* S^-1 M S^-T for symmetric M */
static void to_metric(const double S[36], const double M[36], double out[36]) {
    double half[36];
    memcpy(half, M, sizeof half);
    reduce_rows(S, half);
    for (int i = 0; i < 36; i++) {
        out[i] = half[6 * (i % 6) + i / 6];
    }
    reduce_rows(S, out);
}

/* Eigenvalues of a symmetric A, which is lost, and E, its eigenvectors by columns; no eigenvalues where A is no number.
 */
static void diagonalise_six(double A[36], double lambda[6], double E[36]) {
    double workspace[SPARI_SYMMETRIC_ROOM(6)];
    if (spari_symmetric(6, A, lambda, workspace) != SPAR_OK) {
        memset(lambda, 0, 6 * sizeof *lambda);
    }
    for (int i = 0; i < 36; i++) {
        E[i] = A[6 * (i % 6) + i / 6];
    }
}

static double product_six(const double A[36], const double B[36]) {
    double sum = 0;
    for (int i = 0; i < 36; i++) {
        sum += A[i] * B[i];
    }
    return sum;
}

/* ---- one difference ---- */

/* Nodal data: loads and accelerations of the iteration before; their differences in section axes; positions and axes
   of the nodes. */
typedef struct nodal_view {
    double *load, *rate, *f, *a, *eta, *R;
} nodal_view;

static nodal_view view_of_nodes(const spar_member *m) {
    double *x = m->added->last;
    int64_t n = m->nodes;
    return (nodal_view){x, x + 6 * n, x + 12 * n, x + 18 * n, x + 24 * n, x + 25 * n};
}

int spari_learned_create(spar_member *m) {
    if (!m->learned || !m->added) {
        return SPAR_OK;
    }
    int P = m->mesh.per_element;
    double xi[SPARI_MAX_NODES] = {0};
    if (!(m->added->last = spari_zalloc(34 * m->nodes, sizeof(double)))) {
        return SPAR_ERR_MEMORY;
    }
    nodal_view at = view_of_nodes(m);
    if (m->kind == SPARI_BEAM) {
        spari_gll(P, xi, NULL, NULL);
    }
    for (int64_t i = 0; i < m->nodes; i++) {
        at.eta[i] = 0.5 * (1 + spari_member_xi(m, (int)(i / P), xi[i % P]));
        spari_quat_matrix(m->qr + 4 * i, at.R + 9 * i);
    }
    measure_stations(m, m->learned);
    if (m->learned->head[USED] > 0) {
        spari_learned_put(m);
    }
    return SPAR_OK;
}

/* own [6] := R^T x, with the section's rotation at t^n */
static void to_section(const spar_member *m, int64_t e, const double *phi, const double R[9], const double x[6],
                       double own[6]) {
    double rotation[4];
    spari_added_rotation(m, e, phi, rotation);
    for (int i = 0; i < 6; i += 3) {
        spari_rotate_back(rotation, x + i, own + i);
        spari_matrix_times_back(R, own + i, own + i);
    }
}

/* Differences from the iteration before at the nodes, in section axes. */
static void differ_at_nodes(const spar_member *m, const double *seen, const nodal_view *at) {
    int P = m->mesh.per_element;
    for (int64_t i = 0; i < m->nodes; i++) {
        double phi[SPARI_MAX_NODES] = {0}, df[6], da[6];
        phi[i % P] = 1;
        for (int k = 0; k < 6; k++) {
            df[k] = m->load.pushed[6 * i + k] - at->load[6 * i + k];
            da[k] = seen[6 * i + k] - at->rate[6 * i + k];
        }
        to_section(m, i / P, phi, at->R + 9 * i, df, at->f + 6 * i);
        to_section(m, i / P, phi, at->R + 9 * i, da, at->a + 6 * i);
    }
}

/* The two stations around a position on the line, and their weights. */
typedef struct shares {
    int64_t at[2];
    double part[2];
} shares;

static shares shares_of(const spari_learned *l, double eta) {
    shares h = {{0, 0}, {1, 0}};
    if (l->n > 1) {
        while (h.at[0] < l->n - 2 && eta > l->eta[h.at[0] + 1]) {
            h.at[0]++;
        }
        h.at[1] = h.at[0] + 1;
        h.part[1] = fmin(fmax((eta - l->eta[h.at[0]]) / (l->eta[h.at[1]] - l->eta[h.at[0]]), 0), 1);
        h.part[0] = 1 - h.part[1];
    }
    return h;
}

/* to [6][6] += f x y^T */
static void add_outer(double f, const double x[6], const double y[6], double *to) {
    for (int i = 0; i < 6 && f != 0; i++) {
        for (int j = 0; j < 6; j++) {
            to[6 * i + j] += f * x[i] * y[j];
        }
    }
}

/* Normal equations of one difference. With N_s the weight of station s along the line and I the nodes'
   interpolation,
     G_st = integral of N_t a (I N_s a)^T,    B_s = - sum over nodes of N_s f a^T,
   so the loads f of a mass with stations M_t satisfy B_s = sum over t of M_t G_st exactly. */
static void gather_difference(const spar_member *m, const double *seen, const nodal_view *at, spari_learned *l) {
    const spari_strips *p = &m->added->strips;
    int P = p->per_element;
    memset(l->one_G, 0, (size_t)(36 * l->n * (l->n + 1)) * sizeof *l->one_G);
    for (int64_t i = 0; i < m->nodes; i++) {
        shares h = shares_of(l, at->eta[i]);
        for (int k = 0; k < 2; k++) {
            add_outer(-h.part[k], at->f + 6 * i, at->a + 6 * i, l->one_B + 36 * h.at[k]);
        }
    }
    for (int64_t k = 0; k < p->count; k++) {
        int64_t e = k / p->in_element;
        const double *phi = p->phi + P * k;
        double da[6] = {0}, own[6];
        for (int i = 0; i < 6 * P; i++) {
            int64_t node = 6 * e * P + i;
            da[i % 6] += phi[i / 6] * (seen[node] - at->rate[node]);
        }
        to_section(m, e, phi, p->R + 9 * k, da, own);
        shares here = shares_of(l, p->eta[k]);
        for (int64_t i = e * P; i < (e + 1) * P; i++) {
            shares h = shares_of(l, at->eta[i]);
            for (int j = 0; j < 4; j++) {
                double f = p->weight[k] * phi[i - e * P] * h.part[j / 2] * here.part[j % 2];
                add_outer(f, own, at->a + 6 * i, l->one_G + 36 * (l->n * h.at[j / 2] + here.at[j % 2]));
            }
        }
    }
}

/* da . M da of the difference; M: a mass with its stations, or the metric. */
static double square_in(const spari_learned *l, const double *M) {
    double sum = 0;
    for (int64_t s = 0; s < l->n; s++) {
        for (int64_t t = 0; t < l->n; t++) {
            sum += product_six(M + 36 * t, l->one_G + 36 * (l->n * s + t));
        }
    }
    return sum;
}

/* - da . df */
static double square_that_came_back(const spari_learned *l) {
    double sum = 0;
    for (int64_t i = 0; i < 36 * l->n; i++) {
        sum += i % 36 % 7 == 0 ? l->one_B[i] : 0;
    }
    return sum;
}

/* D [36] := squares G at station s, with the accelerations of all stations, in the metric. */
static void squares_at(const spari_learned *l, const double *squares, int64_t s, double D[36]) {
    double sum[36] = {0}, half[36];
    for (int64_t t = 0; t < l->n; t++) {
        const double *G = squares + 36 * (l->n * s + t);
        for (int i = 0; i < 36; i++) {
            sum[i] += 0.5 * (G[i] + G[6 * (i % 6) + i / 6]);
        }
    }
    multiply_six(l->root + 36 * s, sum, FIRST, half);
    multiply_six(half, l->root + 36 * s, NEITHER, D);
}

/* Square of the accelerations themselves, to exclude differences that are rounding errors. */
static double size_of_rates(const spar_member *m, const spari_learned *l, const double *rates) {
    double sum = 0, W = 0, whole = 0;
    for (int64_t k = 0; k < m->added->strips.count; k++) {
        whole += m->added->strips.weight[k];
    }
    for (int i = 0; i < 6; i++) {
        W = fmax(W, l->metric[7 * i]);
    }
    for (int64_t i = 0; i < 6 * m->nodes; i++) {
        sum += rates[i] * rates[i];
    }
    return W * whole * sum / (double)m->nodes;
}

/* Variance of A along a difference da, in units of the noise variance and including the difference's weight. It is
   the mean over stations, weighted by their fractions of da, of the sum over axes of da^2 divided by the observed
   squares. INFINITY for unobserved directions. */
static double leverage_of(const spari_learned *l, double square, double weight) {
    double h = 0;
    for (int64_t s = 0; s < l->n; s++) {
        const double *E = l->axes + 36 * s, *lambda = l->squares + 6 * s;
        double half[36], all[36], here = 0, sum = 0;
        squares_at(l, l->one_G, s, half);
        multiply_six(E, half, FIRST, all);
        multiply_six(all, E, NEITHER, half);
        for (int i = 0; i < 6; i++) {
            here += half[7 * i];
        }
        for (int i = 0; i < 6; i++) {
            if (half[7 * i] > UNSEEN * here) {
                sum += lambda[i] > 0 ? half[7 * i] / lambda[i] : INFINITY;
            }
        }
        h += here > UNSEEN * square ? weight * sum * here / square : 0;
    }
    return h;
}

/* Tests the mass fitted so far on a new difference, before it is used. `left`: error in the direction of the
   difference, which is the contraction factor of the coupling with this mass. `plain`: error of the fit without
   regularisation, which in observed directions is noise: 1 + h times that of one difference. */
static void test_mass(spari_learned *l, double square, double left, double plain) {
    double *head = l->head;
    head[STEP_SQUARES] += square;
    head[STEP_LARGEST] = fmax(head[STEP_LARGEST], square);
    head[STEP_LEFT] += square * left * left;
    head[STEP_WHOLE] += square;
    double h = head[KNOWN] > 0 ? leverage_of(l, square, 1 / sqrt(head[STEP_LARGEST])) : INFINITY;
    if (h < INFINITY) {
        head[STEP_NOISE] += square * plain * plain / (1 + h);
        head[STEP_SEEN] += square;
    }
}

static void take_difference(spar_member *m, const double *seen, const nodal_view *at) {
    static const double ROUNDING = 1e-8;
    spari_learned *l = m->learned;
    differ_at_nodes(m, seen, at);
    gather_difference(m, seen, at, l);
    double square = square_in(l, l->metric), added = square_in(l, l->mass), back = square_that_came_back(l);
    double left = (added - back) / (square + added);
    if (!isfinite(square) || !isfinite(left) || !(square > ROUNDING * ROUNDING * size_of_rates(m, l, seen))) {
        return;
    }
    for (int64_t i = 0; i < 36 * l->n * (l->n + 1); i++) {
        l->step_G[i] += l->one_G[i];
    }
    test_mass(l, square, left, (square_in(l, l->plain) - back) / (square + added));
}

void spari_learned_note(spar_member *m, int iteration) {
    if (!m->learned || !m->added || m->session->state.trial) {
        return;
    }
    nodal_view at = view_of_nodes(m);
    const double *seen = spari_means_seen(m, 1); /* accelerations to which the loads respond */
    if (iteration > 1) {
        take_difference(m, seen, &at);
    }
    memcpy(at.load, m->load.pushed, (size_t)(6 * m->nodes) * sizeof *at.load);
    memcpy(at.rate, seen, (size_t)(6 * m->nodes) * sizeof *at.rate);
}

/* ---- the fit ---- */

/* Eigenvectors and eigenvalues of the observed accelerations at each station, in the metric of the mass; eigenvalues
   of unobserved directions are 0. */
static void look_around(spari_learned *l) {
    for (int64_t s = 0; s < l->n; s++) {
        double all[36], *lambda = l->squares + 6 * s, most = 0;
        squares_at(l, l->G, s, all);
        diagonalise_six(all, lambda, l->axes + 36 * s);
        for (int i = 0; i < 6; i++) {
            most = fmax(most, lambda[i]);
        }
        for (int i = 0; i < 6; i++) {
            lambda[i] = lambda[i] > UNSEEN * most ? lambda[i] : 0;
        }
    }
}

/* Residual at station s: B_s minus the masses times G, in the metric and the axes there. */
static void missing_at(const spari_learned *l, const double *mass, int64_t s, double doubt, double out[36]) {
    const double *S = l->root + 36 * s, *E = l->axes + 36 * s;
    double r[36], part[36], half[36];
    memcpy(r, l->B + 36 * s, sizeof r);
    for (int64_t t = 0; t < l->n; t++) {
        multiply_six(mass + 36 * t, l->G + 36 * (l->n * s + t), NEITHER, part);
        for (int i = 0; i < 36; i++) {
            r[i] -= part[i];
        }
    }
    reduce_rows(S, r);
    multiply_six(r, S, NEITHER, half);
    to_metric(S, mass + 36 * s, part);
    for (int i = 0; i < 36; i++) {
        half[i] -= doubt * part[i];
    }
    multiply_six(E, half, FIRST, part);
    multiply_six(part, E, NEITHER, out);
}

/* Corrects station s by the nearest symmetric mass (Higham, BIT 28, 1988) in the observed directions, regularised by
   the noise. */
static void correct_station(const spari_learned *l, double *mass, int64_t s, double doubt) {
    const double *lambda = l->squares + 6 * s;
    double r[36], X[36], half[36], T[36];
    missing_at(l, mass, s, doubt, r);
    for (int i = 0; i < 6; i++) {
        for (int j = 0; j < 6; j++) {
            int seen = lambda[i] > 0 && lambda[j] > 0;
            X[6 * i + j] = seen ? (r[6 * i + j] + r[6 * j + i]) / (lambda[i] + lambda[j] + 2 * doubt) : 0;
        }
    }
    multiply_six(l->root + 36 * s, l->axes + 36 * s, NEITHER, T);
    multiply_six(T, X, NEITHER, half);
    multiply_six(half, T, SECOND, X);
    for (int i = 0; i < 36; i++) {
        mass[36 * s + i] += X[i];
    }
}

/* Nearest positive semidefinite mass: negative eigenvalues become 0. */
static void keep_positive(spari_learned *l, int64_t s) {
    double A[36], lambda[6], E[36], U[36], *M = l->mass + 36 * s;
    to_metric(l->root + 36 * s, M, A);
    diagonalise_six(A, lambda, E);
    multiply_six(l->root + 36 * s, E, NEITHER, U);
    for (int i = 0; i < 36; i++) {
        U[i] *= sqrt(fmax(lambda[i % 6], 0));
    }
    multiply_six(U, U, SECOND, M);
}

/* doubt: regularisation of all stations together. */
static void fit_stations(const spari_learned *l, double doubt, double *mass) {
    enum { SWEEPS = 60 };
    double whole = 0;
    for (int64_t i = 0; i < 6 * l->n; i++) {
        whole += l->squares[i];
    }
    memset(mass, 0, (size_t)(36 * l->n) * sizeof *mass);
    for (int sweep = 0; sweep < (l->n > 1 ? SWEEPS : 1) && whole > 0; sweep++) {
        for (int64_t s = 0; s < l->n; s++) {
            double all = 0;
            for (int i = 0; i < 6; i++) {
                all += l->squares[6 * s + i];
            }
            correct_station(l, mass, s, doubt * all / whole);
        }
    }
}

/* Noise variance of a difference of weight 1, from differences in observed directions. As long as there are none,
   all errors count as noise. */
static double noise_of(const spari_learned *l) {
    const double *h = l->head;
    return fmin(h[SEEN] > 0 ? h[NOISE] * h[WHOLE] / h[SEEN] : h[LEFT], h[WHOLE]) / fmax(h[COUNT], 1);
}

/* Axes and unregularised fit of the accepted differences; not part of the state. */
static void fit_plainly(spari_learned *l) {
    look_around(l);
    fit_stations(l, 0, l->plain);
}

/* The same, and the regularised mass. */
static void fit_mass(spari_learned *l) {
    fit_plainly(l);
    fit_stations(l, noise_of(l), l->mass);
    for (int64_t s = 0; s < l->n; s++) {
        keep_positive(l, s);
    }
}

/* ---- the step ---- */

void spari_learned_begin(spar_member *m) {
    spari_learned *l = m->learned;
    if (l && m->added && !m->session->state.trial) {
        memset(l->head + STEP_LEFT, 0, (HEADS - STEP_LEFT) * sizeof *l->head);
        memset(l->step_G, 0, (size_t)(36 * l->n * (l->n + 1)) * sizeof *l->step_G);
    }
}

/* Relative distance between the fitted mass and the mass in the equations, in units of structural plus added mass. */
static double distance_from_force(const spari_learned *l) {
    double most = 0;
    for (int64_t s = 0; s < l->n; s++) {
        double M[36], F[36], off = 0;
        to_metric(l->root + 36 * s, l->mass + 36 * s, M);
        to_metric(l->root + 36 * s, l->force + 36 * s, F);
        for (int i = 0; i < 36; i++) {
            off += (M[i] - F[i]) * (M[i] - F[i]);
        }
        most = fmax(most, sqrt(off) / (1 + sqrt(product_six(F, F))));
    }
    return most;
}

/* Decides whether the mass in the equations changes; then `force` is the new one. */
static int choose(spari_learned *l) {
    static const double NEAR = 0.02;
    double spread = spread_of(l);
    int used = l->head[USED] > 0, use = spread <= (used ? DROP : USE);
    if (use && (!used || distance_from_force(l) > fmax(NEAR, 0.5 * spread))) {
        memcpy(l->force, l->mass, (size_t)(36 * l->n) * sizeof *l->force);
        l->head[USED] = 1;
        return 1;
    }
    l->head[USED] = use;
    return used && !use;
}

int spari_learned_accept(spar_member *m) {
    spari_learned *l = m->learned;
    if (!l || !m->added || m->session->state.trial || !(l->head[STEP_LARGEST] > 0)) {
        return 0;
    }
    double *h = l->head, scale = 1 / sqrt(h[STEP_LARGEST]);
    for (int64_t i = 0; i < 36 * l->n * (l->n + 1); i++) {
        l->G[i] = FADE * l->G[i] + scale * l->step_G[i];
    }
    if (h[KNOWN] > 0) { /* otherwise there was no mass to test */
        h[LEFT] = FADE * h[LEFT] + scale * h[STEP_LEFT];
        h[WHOLE] = FADE * h[WHOLE] + scale * h[STEP_WHOLE];
        h[NOISE] = FADE * h[NOISE] + scale * h[STEP_NOISE];
        h[SEEN] = FADE * h[SEEN] + scale * h[STEP_SEEN];
        h[COUNT] = FADE * h[COUNT] + h[STEP_SQUARES] / h[STEP_LARGEST];
    }
    h[KNOWN] = 1;
    fit_mass(l);
    spari_learned_begin(m);
    return choose(l);
}

void spari_learned_take_back(const spar_member *m) {
    if (m->learned && m->added) {
        measure_stations(m, m->learned);
        fit_plainly(m->learned);
    }
}

void spari_learned_put(spar_member *m) {
    spari_learned *l = m->learned;
    fit_plainly(l);
    if (l->head[USED] > 0) {
        spari_added_fill(m, l->n, l->eta, l->force);
    } else {
        spari_added_fill(m, m->guess.count, m->guess.eta, m->guess.value);
    }
}

/* ---- save and load ---- */

double *spari_learned_state(const spar_member *m, int64_t *count) {
    *count = m->learned->count;
    return m->learned->head;
}

double *spari_learned_last(const spar_member *m, int64_t *count) {
    *count = 12 * m->nodes;
    return m->added->last;
}
