/* Stiffness-proportional damping from the damping ratios of two modes. With D_ij = sqrt(mu_i mu_j) C_ij, a mode of
   unit modal mass has the ratio x^T B x / (2 omega), B the beam's damping matrix. The strain components form three
   groups: bending about y with shear z, bending about z with shear y, torsion with stretch. Each of the two modes
   sets the mu of the group with most of its strain energy; the third group gets their geometric mean. */
#include "../base/environment.h"
#include "../math/rotation.h"
#include "../member/beam.h"
#include "../member/check_arguments.h"
#include "../time/fidelity.h"
#include "modes.h"

#include <stdlib.h>
#include <string.h>

enum { GROUPS = 3 };

static const int GROUP[6] = {2, 1, 0, 2, 0, 1}; /* group of axial, shear y, shear z, torsion, bending y, bending z */
static const char *const GROUP_NAME[GROUPS] = {"bending about y", "bending about z", "torsion and stretch"};

/* x^T B x of both shapes [2][unique][6] at the state q */
static void modal_damping(const spari_body *b, const double *q, const double *x, double *S, double *S0, double c[2]) {
    int P = b->per_element, n = 6 * P;
    c[0] = c[1] = 0;
    for (int e = 0; e < b->elements; e++) {
        spari_body_tangent(b, e, q, NULL, NULL, 1, 0, 1, NULL, S);
        spari_body_tangent(b, e, q, NULL, NULL, 1, 0, 0, NULL, S0);
        for (int k = 0; k < 2; k++) {
            const double *xe = x + 6 * ((int64_t)k * b->unique + (int64_t)e * (P - 1));
            for (int i = 0; i < n; i++) {
                for (int j = 0; j < n; j++) {
                    c[k] += xe[i] * (S[n * i + j] - S0[n * i + j]) * xe[j];
                }
            }
        }
    }
}

/* share[k][g][h]: the ratio of mode k is sum sqrt(mu_g mu_h) share */
static int find_shares(spar_member *m, const double omega[2], const double *q, const double *x, double *work,
                       double share[2][GROUPS][GROUPS]) {
    int64_t size = 36 * (int64_t)m->mesh.per_element * m->mesh.per_element;
    for (int g = 0; g < GROUPS; g++) {
        for (int h = g; h >= 0; h--) { /* the diagonal first */
            spari_body *b;
            double mu[6], c[2];
            for (int i = 0; i < 6; i++) {
                mu[i] = GROUP[i] == g || GROUP[i] == h ? 1 : 0;
            }
            SPARI_TRY(spari_beam_build(m, 0, mu, &b));
            modal_damping(b, q, x, work, work + size, c);
            spari_body_free(b);
            for (int k = 0; k < 2; k++) {
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

static int find_mu(spar_member *m, const int64_t mode[2], const double ratio[2], double mu[6]) {
    spar_session *s = m->session;
    int64_t most = 1 + (mode[0] > mode[1] ? mode[0] : mode[1]), u = m->body->unique,
            size = 36 * (int64_t)m->mesh.per_element * m->mesh.per_element;
    double *all = spari_zalloc(most * (1 + 6 * m->nodes) + 7 * u + 12 * u + 2 * size, sizeof *all);
    SPARI_REQUIRE(s, all, SPAR_ERR_MEMORY, "no memory for '%s'", m->name);
    double *shapes = all + most, *q = shapes + 6 * m->nodes * most, *x = q + 7 * u, *work = x + 12 * u;
    double omega[2], share[2][GROUPS][GROUPS], groups[GROUPS];
    int own[2] = {0, 0}, status = spari_modes_of_member(m, most, all, shapes);
    for (int k = 0; k < 2 && status == SPAR_OK; k++) {
        if (mode[k] < rigid_modes(m)) {
            status =
                spari_fail(s, SPAR_ERR_NUMERIC,
                           "member '%s': mode %lld is a rigid-body mode and cannot be damped; give mode %d or higher",
                           m->name, (long long)mode[k], rigid_modes(m));
            break;
        }
        omega[k] = 6.283185307179586 * all[mode[k]];
        if (!(omega[k] > 0) || !isfinite(omega[k])) {
            status =
                spari_fail(s, SPAR_ERR_NUMERIC, "member '%s': mode %lld has the frequency %g Hz and cannot be damped",
                           m->name, (long long)mode[k], all[mode[k]]);
        }
        spari_member_to_unique(m, 6, shapes + 6 * m->nodes * mode[k], x + 6 * u * k);
    }
    spari_member_to_unique(m, 7, m->after.q, q);
    status = status == SPAR_OK ? find_shares(m, omega, q, x, work, share) : status;
    free(all);
    SPARI_TRY(status);
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
    return SPAR_OK;
}

static int check_pair(const spar_member *m, const int64_t mode[2], const double ratio[2]) {
    spar_session *s = m->session;
    SPARI_REQUIRE(s, m->kind == SPARI_BEAM, SPAR_ERR_ARGUMENT, "member '%s' is not a beam", m->name);
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
    for (int k = 0; k < 2; k++) {
        SPARI_REQUIRE(s, mode[k] >= 0 && mode[k] < 6 * m->nodes, SPAR_ERR_ARGUMENT,
                      "member '%s': there is no mode %lld", m->name, (long long)mode[k]);
        SPARI_REQUIRE(s, ratio[k] > 0 && ratio[k] < 1e3, SPAR_ERR_ARGUMENT,
                      "member '%s': ratio %d is %g; give a damping ratio above 0, such as 0.005", m->name, k, ratio[k]);
    }
    return SPAR_OK;
}

int spar_beam_set_modal_damping(spar_member *beam, const int64_t mode[2], const double ratio[2], double mu[6]) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_REQUIRE(NULL, beam, SPAR_ERR_ARGUMENT, "%s: the member is NULL; create it first", __func__);
    spar_session *s = beam->session;
    double found[6];
    spari_body *body = NULL;
    int status = check_pair(beam, mode, ratio);
    status = status == SPAR_OK ? find_mu(beam, mode, ratio, found) : status;
    status = status == SPAR_OK ? spari_beam_build(beam, 0, found, &body) : status;
    if (status == SPAR_OK) {
        status = spari_beam_drag(beam, body);
    }
    if (status == SPAR_OK) {
        body->gyroscopic = beam->body->gyroscopic;
        memcpy(body->gravity, beam->body->gravity, sizeof body->gravity);
    }
    int given = mode && ratio;
    const spari_agreed must_agree[] = {
        spari_whole("mode[0]", given ? mode[0] : 0), spari_whole("mode[1]", given ? mode[1] : 0),
        spari_real("ratio[0]", given ? ratio[0] : 0), spari_real("ratio[1]", given ? ratio[1] : 0)};
    status = spari_member_enter(beam, __func__, must_agree, 4, status);
    if (status != SPAR_OK) {
        spari_body_free(body);
        return spari_named(s, __func__, status);
    }
    spari_body_free(beam->body);
    beam->body = body;
    memcpy(beam->beam->mu, found, sizeof found);
    beam->beam->damped = 1;
    beam->effects |= SPAR_EFFECT_DAMPING;
    if (spari_fidelity_is_here(beam)) {
        beam->row->renew(beam);
    }
    if (mu) {
        memcpy(mu, found, sizeof found);
    }
    return SPAR_OK;
}
