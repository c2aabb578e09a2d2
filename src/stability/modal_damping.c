/* Stiffness-proportional damping from the damping ratios of two modes. With D_ij = sqrt(mu_i mu_j) C_ij, a mode of
   unit modal mass has the ratio x^T B x / (2 omega), B the beam's damping matrix. The strain components form three
   groups: bending about y with shear z, bending about z with shear y, torsion with stretch. Each of the two modes
   sets the mu of the group with most of its strain energy; the third group gets their geometric mean. A fit to any
   number of modes has the mu of the groups and the mass-proportional alpha, which adds alpha / (2 omega). */
#include "../algebra/dense.h"
#include "../base/environment.h"
#include "../member/beam.h"
#include "../member/check_arguments.h"
#include "../time/fidelity.h"
#include "modes.h"
#include "plausible_damping.h"

#include <stdlib.h>
#include <string.h>

enum { GROUPS = 3 };

static const int GROUP[6] = {2, 1, 0, 2, 0, 1}; /* group of axial, shear y, shear z, torsion, bending y, bending z */
static const char *const GROUP_NAME[GROUPS] = {"bending about y", "bending about z", "torsion and stretch"};

/* x^T B x of `count` shapes [count][unique][6] at the state q */
static void modal_damping(const spari_body *b, const double *q, int64_t count, const double *x, double *S, double *S0,
                          double *c) {
    int P = b->per_element, n = 6 * P;
    memset(c, 0, (size_t)count * sizeof *c);
    for (int e = 0; e < b->elements; e++) {
        spari_body_tangent(b, e, q, NULL, NULL, 1, 0, 1, NULL, S);
        spari_body_tangent(b, e, q, NULL, NULL, 1, 0, 0, NULL, S0);
        for (int64_t k = 0; k < count; k++) {
            const double *xe = x + 6 * (k * b->unique + (int64_t)e * (P - 1));
            for (int i = 0; i < n; i++) {
                for (int j = 0; j < n; j++) {
                    c[k] += xe[i] * (S[n * i + j] - S0[n * i + j]) * xe[j];
                }
            }
        }
    }
}

/* share[k][g][h]: the ratio of mode k is sum sqrt(mu_g mu_h) share. work: 2 tangents of an element and count */
static int find_shares(spar_member *m, int64_t count, const double *omega, const double *q, const double *x,
                       double *work, double (*share)[GROUPS][GROUPS]) {
    int64_t size = 36 * (int64_t)m->mesh.per_element * m->mesh.per_element;
    for (int g = 0; g < GROUPS; g++) {
        for (int h = g; h >= 0; h--) { /* the diagonal first */
            spari_body *b;
            double mu[6], *c = work + 2 * size;
            for (int i = 0; i < 6; i++) {
                mu[i] = GROUP[i] == g || GROUP[i] == h ? 1 : 0;
            }
            SPARI_TRY(spari_beam_build(m, 0, mu, &b));
            modal_damping(b, q, count, x, work, work + size, c);
            spari_body_free(b);
            for (int64_t k = 0; k < count; k++) {
                double value = c[k] / (2 * omega[k]);
                share[k][g][h] = share[k][h][g] = g == h ? value : 0.5 * (value - share[k][g][g] - share[k][h][h]);
            }
        }
    }
    return SPAR_OK;
}

static double ratio_of(const double share[GROUPS][GROUPS], const double mu[GROUPS]) {
    double sum = 0;
    for (int g = 0; g < GROUPS; g++) {
        for (int h = 0; h < GROUPS; h++) {
            sum += sqrt(mu[g] * mu[h]) * share[g][h];
        }
    }
    return sum;
}

/* mu of the groups a and b from y = log mu; the third is their geometric mean */
static void groups_of(const int own[2], const double y[2], double mu[GROUPS]) {
    for (int g = 0; g < GROUPS; g++) {
        mu[g] = exp(0.5 * (y[0] + y[1]));
    }
    mu[own[0]] = exp(y[0]);
    mu[own[1]] = exp(y[1]);
}

/* Newton iteration for the logarithms; 0 if the ratios are met to 1e-12. */
static int solve_ratios(const double share[2][GROUPS][GROUPS], const int own[2], const double ratio[2],
                        double mu[GROUPS]) {
    double y[2];
    for (int k = 0; k < 2; k++) {
        y[k] = log(ratio[k] / share[k][own[k]][own[k]]);
    }
    for (int it = 0; it < 200; it++) {
        double f[2], J[2][2], h = 1e-6, largest = 0;
        groups_of(own, y, mu);
        for (int k = 0; k < 2; k++) {
            f[k] = log(ratio_of(share[k], mu) / ratio[k]);
            largest = fmax(largest, fabs(f[k]));
        }
        if (!(largest < 1e3)) {
            return 1;
        }
        if (largest < 1e-12) {
            return 0;
        }
        for (int j = 0; j < 2; j++) {
            double up[2] = {y[0] + (j == 0 ? h : 0), y[1] + (j == 1 ? h : 0)}, at[GROUPS];
            groups_of(own, up, at);
            for (int k = 0; k < 2; k++) {
                J[k][j] = (log(ratio_of(share[k], at) / ratio[k]) - f[k]) / h;
            }
        }
        double det = J[0][0] * J[1][1] - J[0][1] * J[1][0], d[2];
        d[0] = (f[0] * J[1][1] - f[1] * J[0][1]) / det;
        d[1] = (f[1] * J[0][0] - f[0] * J[1][0]) / det;
        for (int k = 0; k < 2; k++) {
            y[k] -= fmax(-1, fmin(1, d[k]));
        }
        if (!isfinite(y[0]) || !isfinite(y[1]) || fabs(y[0]) > 200 || fabs(y[1]) > 200) {
            return 1;
        }
    }
    return 1;
}

/* Number of rigid-body modes of a free or pinned beam, whose frequencies are rounding errors. */
static int rigid_modes(const spar_member *m) {
    return m->root == SPAR_ROOT_FREE ? 6 : m->root == SPAR_ROOT_PINNED ? 3 : 0;
}

/* Shares of the given modes, and their angular frequencies */
static int find_damped_modes(spar_member *m, int64_t count, const int64_t *mode, double *omega,
                             double (*share)[GROUPS][GROUPS]) {
    spar_session *s = m->session;
    int64_t most = 1, u = m->body->unique, size = 36 * (int64_t)m->mesh.per_element * m->mesh.per_element;
    for (int64_t k = 0; k < count; k++) {
        most = mode[k] >= most ? mode[k] + 1 : most;
    }
    double *all = spari_zalloc(most * (1 + 6 * m->nodes) + 7 * u + 6 * u * count + 2 * size + count, sizeof *all);
    SPARI_REQUIRE(s, all, SPAR_ERR_MEMORY, "no memory for '%s'", m->name);
    double *shapes = all + most, *q = shapes + 6 * m->nodes * most, *x = q + 7 * u, *work = x + 6 * u * count;
    int status = spari_modes(m, 0, most, all, shapes);
    for (int64_t k = 0; k < count && status == SPAR_OK; k++) {
        if (mode[k] < rigid_modes(m)) {
            status =
                spari_fail(s, SPAR_ERR_NUMERIC,
                           "member '%s': mode %lld is a rigid-body mode and cannot be damped; give mode %d or higher",
                           m->name, (long long)mode[k], rigid_modes(m));
            break;
        }
        omega[k] = 6.283185307179586 * all[mode[k]];
        if (!(omega[k] > 0) || !isfinite(omega[k])) {
            status = spari_fail(
                s, SPAR_ERR_NUMERIC,
                "member '%s': mode %lld has the frequency %g Hz and cannot be damped; choose a mode that vibrates",
                m->name, (long long)mode[k], all[mode[k]]);
        }
        spari_member_to_unique(m, 6, shapes + 6 * m->nodes * mode[k], x + 6 * u * k);
    }
    spari_member_to_unique(m, 7, m->after.q, q);
    status = status == SPAR_OK ? find_shares(m, count, omega, q, x, work, share) : status;
    free(all);
    return status;
}

/* What is chosen; omega: of these modes. */
static spari_damping_asked asked_of(int64_t n, const int64_t *mode, const double *ratio, const double *omega) {
    spari_damping_asked asked = {ratio[0], ratio[0], omega[0], omega[0], 0};
    int64_t most = 0;
    for (int64_t k = 0; k < n; k++) {
        asked.least = fmin(asked.least, ratio[k]), asked.most = fmax(asked.most, ratio[k]);
        asked.lowest = fmin(asked.lowest, omega[k]), asked.highest = fmax(asked.highest, omega[k]);
        most = mode[k] >= most ? mode[k] + 1 : most;
    }
    asked.modes = 2 * most + 6; /* torsion stands above the bending modes that are chosen */
    return asked;
}

static int find_mu(spar_member *m, const int64_t mode[2], const double ratio[2], double mu[6],
                   spari_damping_asked *asked) {
    spar_session *s = m->session;
    double omega[2], share[2][GROUPS][GROUPS], groups[GROUPS];
    int own[2] = {0, 0};
    SPARI_TRY(find_damped_modes(m, 2, mode, omega, share));
    for (int k = 0; k < 2; k++) {
        for (int g = 1; g < GROUPS; g++) {
            own[k] = share[k][g][g] > share[k][own[k]][own[k]] ? g : own[k];
        }
    }
    SPARI_REQUIRE(s, own[0] != own[1], SPAR_ERR_ARGUMENT,
                  "member '%s': modes %lld and %lld are both mostly %s, whose damping ratios grow together with the "
                  "frequency; choose two different kinds of modes, such as the first flapwise and the first edgewise",
                  m->name, (long long)mode[0], (long long)mode[1], GROUP_NAME[own[0]]);
    SPARI_REQUIRE(s, solve_ratios((const double(*)[GROUPS][GROUPS])share, own, ratio, groups) == 0, SPAR_ERR_NUMERIC,
                  "member '%s': no damping gives modes %lld and %lld the ratios %g and %g: their strains are too "
                  "similar; bring the ratios closer together",
                  m->name, (long long)mode[0], (long long)mode[1], ratio[0], ratio[1]);
    for (int i = 0; i < 6; i++) {
        mu[i] = groups[GROUP[i]];
    }
    *asked = asked_of(2, mode, ratio, omega);
    return SPAR_OK;
}

static int check_modes(const spar_member *m, int64_t n, const int64_t *mode, const double *ratio) {
    spar_session *s = m->session;
    SPARI_REQUIRE(s, m->kind == SPARI_BEAM, SPAR_ERR_ARGUMENT, "member '%s' is not a beam; call this for a beam alone",
                  m->name);
    SPARI_REQUIRE(s, m->committed, SPAR_ERR_STATE,
                  "member '%s' is not committed, so its modes are not known; call this between spar_member_commit and "
                  "the first step",
                  m->name);
    SPARI_REQUIRE(s, !s->clock.started && s->state.phase == SPARI_IDLE, SPAR_ERR_STATE,
                  "member '%s': the clock has started; choose the damping before the first step", m->name);
    SPARI_REQUIRE(s, m->body && !(m->effects_off & SPAR_EFFECT_DAMPING), SPAR_ERR_STATE,
                  "member '%s': damping is switched off; leave SPAR_EFFECT_DAMPING on in spar_member_set_effects",
                  m->name);
    SPARI_REQUIRE(s, m->row->renew, SPAR_ERR_UNSUPPORTED,
                  "member '%s' is linear or modal, and its damping is fixed at commit; compute mu with an exact member "
                  "and pass it to spar_beam_set_damping",
                  m->name);
    SPARI_REQUIRE(s, mode && ratio, SPAR_ERR_ARGUMENT, "member '%s': %s is NULL", m->name, mode ? "ratio" : "mode");
    for (int64_t k = 0; k < n; k++) {
        SPARI_REQUIRE(s, mode[k] >= 0 && mode[k] < 6 * m->nodes, SPAR_ERR_ARGUMENT,
                      "member '%s': there is no mode %lld", m->name, (long long)mode[k]);
        SPARI_REQUIRE(s, ratio[k] > 0 && ratio[k] < 1e3, SPAR_ERR_ARGUMENT,
                      "member '%s': ratio %lld is %g; give a damping ratio above 0, such as 0.005", m->name,
                      (long long)k, ratio[k]);
    }
    return SPAR_OK;
}

/* Puts the damping in force on all ranks, or on none. status: of this rank so far. */
static int agree_on_damping(spar_member *m, const char *call, const spari_agreed *must_agree, int count,
                            const double mu[6], double alpha, int status) {
    spari_body *body = NULL;
    double before = m->beam ? m->beam->mass_damping : 0;
    if (status == SPAR_OK) {
        m->beam->mass_damping = alpha;
        status = spari_beam_build(m, 0, mu, &body);
        status = status == SPAR_OK ? spari_beam_mass_damping(m, body) : status;
    }
    status = spari_member_enter(m, call, must_agree, count, status);
    if (status != SPAR_OK) {
        if (m->beam) {
            m->beam->mass_damping = before;
        }
        spari_body_free(body);
        return spari_named(m->session, call, status);
    }
    /* NOLINTNEXTLINE(clang-analyzer-core.NullDereference): built above, since the status is SPAR_OK */
    body->gyroscopic = m->body->gyroscopic;
    memcpy(body->gravity, m->body->gravity, sizeof body->gravity);
    spari_body_free(m->body);
    m->body = body;
    memcpy(m->beam->mu, mu, sizeof m->beam->mu);
    m->beam->damped = m->beam->damped_by_ratios = 1;
    m->effects |= SPAR_EFFECT_DAMPING;
    if (spari_fidelity_is_here(m)) {
        m->row->renew(m);
    }
    return SPAR_OK;
}

int spar_beam_set_modal_damping(spar_member *beam, const int64_t mode[2], const double ratio[2], double mu[6]) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_REQUIRE(NULL, beam, SPAR_ERR_ARGUMENT, "%s: the member is NULL; create it first", __func__);
    double found[6], alpha = beam->beam ? beam->beam->mass_damping : 0;
    int status = check_modes(beam, 2, mode, ratio), given = mode && ratio;
    spari_damping_asked asked;
    status = status == SPAR_OK ? find_mu(beam, mode, ratio, found, &asked) : status;
    const spari_agreed must_agree[] = {
        spari_whole("mode[0]", given ? mode[0] : 0), spari_whole("mode[1]", given ? mode[1] : 0),
        spari_real("ratio[0]", given ? ratio[0] : 0), spari_real("ratio[1]", given ? ratio[1] : 0)};
    SPARI_TRY(agree_on_damping(beam, __func__, must_agree, 4, found, alpha, status));
    spari_damping_tell_plausible(beam, &asked);
    spari_give(mu, found, 6);
    return SPAR_OK;
}

/* ---- fit to any number of modes ---- */

/* The fit minimises sum (found / given - 1)^2 over y = (sqrt(mu) of the groups, sqrt(alpha)): squares keep all of them
   from being negative. */
enum { FITTED = GROUPS + 1, MOST_FITTED = 1000 };

static double fitted_ratio(const double share[GROUPS][GROUPS], double omega, const double y[FITTED]) {
    const double mu[GROUPS] = {y[0] * y[0], y[1] * y[1], y[2] * y[2]};
    return ratio_of(share, mu) + y[GROUPS] * y[GROUPS] / (2 * omega);
}

/* Normal equations of a step in log y: A [FITTED][FITTED], g [FITTED]; returns the sum of squares. */
static double fit_step(int64_t n, const double (*share)[GROUPS][GROUPS], const double *omega, const double *ratio,
                       const double y[FITTED], double A[FITTED * FITTED], double g[FITTED]) {
    double sum = 0;
    memset(A, 0, FITTED * FITTED * sizeof *A);
    memset(g, 0, FITTED * sizeof *g);
    for (int64_t k = 0; k < n; k++) {
        double row[FITTED], off = fitted_ratio(share[k], omega[k], y) / ratio[k] - 1;
        for (int i = 0; i < GROUPS; i++) {
            row[i] = 0;
            for (int j = 0; j < GROUPS; j++) {
                row[i] += 2 * y[i] * y[j] * share[k][i][j] / ratio[k];
            }
        }
        row[GROUPS] = y[GROUPS] * y[GROUPS] / (omega[k] * ratio[k]);
        for (int i = 0; i < FITTED; i++) {
            g[i] -= row[i] * off;
            for (int j = 0; j < FITTED; j++) {
                A[FITTED * i + j] += row[i] * row[j];
            }
        }
        sum += off * off;
    }
    return sum;
}

/* Levenberg and Marquardt's method. What no mode depends on keeps its first value, the geometric mean over the modes.
 */
static void fit(int64_t n, const double (*share)[GROUPS][GROUPS], const double *omega, const double *ratio,
                double y[FITTED]) {
    double mean = 0, lowest = omega[0], damp = 1e-3;
    for (int64_t k = 0; k < n; k++) {
        mean += log(ratio[k] / (share[k][0][0] + share[k][1][1] + share[k][2][2])) / (double)n;
        lowest = fmin(lowest, omega[k]);
    }
    y[0] = y[1] = y[2] = exp(0.5 * mean);
    y[GROUPS] = sqrt(0.1 * 2 * lowest * ratio[0]);
    for (int it = 0; it < 1000; it++) {
        double A[FITTED * FITTED], g[FITTED], next[FITTED], B[FITTED * FITTED], h[FITTED];
        double sum = fit_step(n, share, omega, ratio, y, A, g), largest = 0;
        for (int i = 0; i < FITTED; i++) {
            A[(FITTED + 1) * i] += damp * (A[(FITTED + 1) * i] + 1e-6);
        }
        if (spari_cholesky(FITTED, A)) {
            return;
        }
        spari_cholesky_solve(FITTED, A, g);
        for (int i = 0; i < FITTED; i++) {
            next[i] = y[i] * exp(fmax(-1, fmin(1, g[i])));
            largest = fmax(largest, fabs(g[i]) * (next[i] * next[i] > 1e-12 ? 1 : 0));
        }
        if (fit_step(n, share, omega, ratio, next, B, h) <= sum) {
            memcpy(y, next, sizeof next);
            damp *= 0.1;
            if (largest < 1e-12) {
                return;
            }
        } else if ((damp *= 10) > 1e12) {
            return;
        }
    }
}

/* mu, alpha and the ratios that they give */
static int fit_damping(spar_member *m, int64_t n, const int64_t *mode, const double *ratio, double mu[6], double *alpha,
                       double *found, spari_damping_asked *asked) {
    double *omega = spari_zalloc(n, sizeof *omega), y[FITTED];
    double(*share)[GROUPS][GROUPS] = spari_zalloc(n, sizeof *share);
    int status = omega && share
                     ? find_damped_modes(m, n, mode, omega, share)
                     : spari_fail(m->session, SPAR_ERR_MEMORY, "no memory for the modes of member '%s'", m->name);
    if (status == SPAR_OK) {
        const double(*kept)[GROUPS][GROUPS] = (const double(*)[GROUPS][GROUPS])share;
        fit(n, kept, omega, ratio, y);
        for (int64_t k = 0; k < n; k++) {
            found[k] = fitted_ratio(kept[k], omega[k], y);
        }
        for (int i = 0; i < 6; i++) {
            mu[i] = y[GROUP[i]] * y[GROUP[i]];
        }
        *alpha = y[GROUPS] * y[GROUPS];
        *asked = asked_of(n, mode, ratio, omega);
    }
    SPARI_FREE(omega, share);
    return status;
}

int spar_beam_fit_damping(spar_member *beam, int64_t n, const int64_t *mode, const double *ratio, double *achieved) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_REQUIRE(NULL, beam, SPAR_ERR_ARGUMENT, "%s: the member is NULL; create it first", __func__);
    double mu[6], alpha = 0, *found = NULL;
    int status = n >= 1 && n <= MOST_FITTED
                     ? check_modes(beam, n, mode, ratio)
                     : spari_fail(beam->session, SPAR_ERR_ARGUMENT, "member '%s': %lld modes; give 1 to %d", beam->name,
                                  (long long)n, MOST_FITTED);
    int given = status == SPAR_OK;
    uint64_t modes = given ? spari_hash_bytes(SPARI_HASH_BEGIN, mode, (size_t)n * sizeof *mode) : 0;
    uint64_t ratios = given ? spari_hash_bytes(SPARI_HASH_BEGIN, ratio, (size_t)n * sizeof *ratio) : 0;
    if (given && !(found = spari_zalloc(n, sizeof *found))) {
        status = spari_fail(beam->session, SPAR_ERR_MEMORY, "no memory for the damping of member '%s'", beam->name);
    }
    spari_damping_asked asked;
    status = status == SPAR_OK ? fit_damping(beam, n, mode, ratio, mu, &alpha, found, &asked) : status;
    const spari_agreed must_agree[] = {spari_whole("n", n), spari_hash("mode", modes), spari_hash("ratio", ratios)};
    status = agree_on_damping(beam, __func__, must_agree, 3, mu, alpha, status);
    if (status == SPAR_OK) {
        spari_damping_tell_plausible(beam, &asked);
        spari_give(achieved, found, n);
    }
    free(found);
    return status;
}
