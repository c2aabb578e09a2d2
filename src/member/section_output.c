/* Strains and section forces at any position along a beam: strains from the element's field, as at quadrature
   points; section forces from equilibrium of the part beyond. */
#include "../base/environment.h"
#include "../base/session.h"
#include "../math/rotation.h"
#include "beam.h"
#include "check_arguments.h"
#include "pose.h"
#include "quadrature_point.h"
#include "section_resultants.h"

#include <stdlib.h>
#include <string.h>

/* Fields at a position as at a quadrature point, in the first lane of a block [POINT_ROWS]. */
static void section_fields(const spar_member *m, const spari_station *s, double *f) {
    int P = m->mesh.per_element;
    const double *q = m->after.q + 7 * (int64_t)s->element * P, *v = m->after.v + 6 * (int64_t)s->element * P;
    double last[4] = {0};
    memset(f, 0, sizeof *f * POINT_ROWS * SPARI_LANES);
    for (int l = 0; l < P; l++, q += 7, v += 6) {
        double row[14], half[4] = {0, 0.5 * v[3], 0.5 * v[4], 0.5 * v[5]},
                        sign = spari_quat_dot(q + 3, last) < 0 ? -1 : 1;
        memcpy(row + U, q, 3 * sizeof *row);
        memcpy(row + UD, v, 3 * sizeof *row);
        for (int i = 0; i < 4; i++) {
            row[Q + i] = last[i] = sign * q[3 + i];
        }
        spari_quat_mul(half, last, row + QD);
        for (int i = 0; i < 14; i++) {
            f[SPARI_LANES * i] += s->phi[l] * row[i];
            f[SPARI_LANES * (DU + i)] += s->dphi[l] * row[i];
        }
    }
}

/* Strains and their rates, reference axes. */
static void strains(const spari_station *s, point_one *p, double e[6], double ed[6]) {
    static const double none[36 * SPARI_LANES] = {0}; /* without section forces */
    double tangent[3 * SPARI_LANES];
    for (int i = 0; i < 3; i++) {
        tangent[SPARI_LANES * i] = s->t[i];
    }
    strain_one(tangent, none, p);
    strain_rate_one(none, p);
    memcpy(e, p->e, sizeof p->e);
    memcpy(ed, p->ed, sizeof p->ed);
}

/* The same of linear members: (w' - theta x x0', theta') of the deformation that their equations know. */
static void linear_strains(const spar_member *m, const spari_station *s, double e[6], double ed[6]) {
    int P = m->mesh.per_element;
    double theta[3] = {0}, omega[3] = {0}, c[3];
    const spari_pose pose = spari_member_pose(m, &m->after);
    memset(e, 0, 6 * sizeof *e);
    memset(ed, 0, 6 * sizeof *ed);
    for (int l = 0; l < P; l++) {
        int64_t node = (int64_t)s->element * P + l;
        double x[6], rate[6];
        spari_member_deformation(m, &pose, &m->after, node, x, rate);
        for (int i = 0; i < 3; i++) {
            theta[i] += s->phi[l] * x[3 + i];
            omega[i] += s->phi[l] * rate[3 + i];
        }
        for (int i = 0; i < 6; i++) {
            e[i] += s->dphi[l] * x[i];
            ed[i] += s->dphi[l] * rate[i];
        }
    }
    spari_cross(theta, s->t, c);
    for (int i = 0; i < 3; i++) {
        e[i] -= c[i];
    }
    spari_cross(omega, s->t, c);
    for (int i = 0; i < 3; i++) {
        ed[i] -= c[i];
    }
}

/* Converts to the section's axes: R^T of both triples. */
static void to_local(const double R[9], const double x[6], double y[6]) {
    spari_matrix_times_back(R, x, y);
    spari_matrix_times_back(R, x + 3, y + 3);
}

/* Section forces from the section alone: stiffness, damping and pretension. */
static void forces_of_strains(const spar_member *m, double eta, const double local[6], const double rate[6],
                              double force[6]) {
    const int damped = m->beam->damped && (m->effects & SPAR_EFFECT_DAMPING);
    const double *mu = m->beam->mu;
    double C[36], pre[6] = {0};
    spari_beam_section_at(m->beam, m->beam->stiffness, eta, C);
    if (m->effects & SPAR_EFFECT_PRETENSION) {
        spari_pretension_at(m->beam, eta, pre);
    }
    for (int i = 0; i < 6; i++) {
        force[i] = pre[i];
        for (int j = 0; j < 6; j++) {
            force[i] += C[6 * i + j] * (local[j] + (damped ? sqrt(mu[i] * mu[j]) * rate[j] : 0));
        }
    }
}

/* Section forces from equilibrium of the part beyond. */
static void forces_of_balance(const spari_beyond *beyond, const spari_station *s, const point_one *p, double force[6]) {
    double global[2][6];
    spari_beyond_at(beyond, s, global);
    for (int k = 0; k < 6; k += 3) {
        spari_rotate_back(p->r, global[1] + k, global[1] + k);
    }
    for (int k = 0; k < 6; k++) {
        global[0][k] += global[1][k];
    }
    to_local(s->R, global[0], force);
}

/* Requested results at each position; may be NULL. */
typedef struct section_request {
    double *strain, *force, *x, *q;
} section_request;

static void section_output(const spar_member *m, const spari_station *s, double eta, const spari_beyond *beyond,
                           int64_t i, const section_request *to) {
    point_one p;
    double f[POINT_ROWS * SPARI_LANES], e[6], ed[6], local[6], rate[6], q0[4];
    section_fields(m, s, f);
    fields_one(1, f, &p);
    if (m->frame == SPARI_FRAME_LINEAR) {
        linear_strains(m, s, e, ed);
    } else {
        strains(s, &p, e, ed);
    }
    to_local(s->R, e, local);
    to_local(s->R, ed, rate);
    if (to->strain) {
        memcpy(to->strain + 6 * i, local, sizeof local);
    }
    if (to->force && !beyond) {
        forces_of_strains(m, eta, local, rate, to->force + 6 * i);
    } else if (to->force) {
        forces_of_balance(beyond, s, &p, to->force + 6 * i);
    }
    for (int k = 0; k < 3 && to->x; k++) {
        to->x[3 * i + k] = s->x[k] + f[SPARI_LANES * (U + k)];
    }
    if (to->q) {
        spari_matrix_quat(s->R, q0);
        spari_quat_mul(p.r, q0, to->q + 4 * i);
        spari_quat_normalise(to->q + 4 * i);
    }
}

static int section_outputs(const spar_member *m, int64_t n, const spari_station *s, const double *eta,
                           const section_request *to) {
    const int balanced = to->force && spari_beyond_is_known(m);
    spari_beyond *beyond = balanced ? spari_beyond_create(m) : NULL;
    int status = balanced && !beyond ? SPAR_ERR_MEMORY : SPAR_OK;
    for (int64_t i = 0; i < n && status == SPAR_OK; i++) {
        section_output(m, s + i, eta[i], beyond, i, to);
    }
    spari_beyond_free(beyond);
    SPARI_REQUIRE(m->session, status == SPAR_OK, status, "no memory for the section forces of '%s'", m->name);
    return SPAR_OK;
}

int spar_beam_evaluate(const spar_member *beam, int64_t n, const double *eta, double *strain, double *force, double *x,
                       double *q) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_TRY(spari_need_any_beam(beam, __func__));
    SPARI_TRY(spari_need_committed(beam, __func__));
    spar_session *session = beam->session;
    SPARI_REQUIRE(session, n >= 0 && n <= SPARI_MOST && (eta || n == 0), SPAR_ERR_ARGUMENT,
                  "%s: '%s': %lld positions%s; give 0 to 2^40, and n values of eta", __func__, beam->name, (long long)n,
                  eta ? "" : " without eta");
    SPARI_REQUIRE(
        session, !force || beam->beam->stiffness, SPAR_ERR_UNSUPPORTED,
        "%s: '%s' has no sections, so it has no section forces; call spar_beam_set_sections before the commit",
        __func__, beam->name);
    for (int64_t i = 0; i < n; i++) {
        SPARI_REQUIRE(session, eta[i] >= -1e-9 && eta[i] <= 1 + 1e-9, SPAR_ERR_ARGUMENT,
                      "%s: '%s': eta %lld is %g; eta runs from 0 to 1", __func__, beam->name, (long long)i, eta[i]);
    }
    spari_station *s = spari_zalloc(n, sizeof *s);
    SPARI_REQUIRE(session, s, SPAR_ERR_MEMORY, "%s: no memory for '%s'", __func__, beam->name);
    int E = beam->mesh.elements;
    for (int64_t i = 0; i < n; i++) { /* an element boundary belongs to the element before it */
        int e = (int)ceil(eta[i] * E - 1e-9) - 1;
        e = e < 0 ? 0 : e > E - 1 ? E - 1 : e;
        s[i].element = e;
        s[i].xi = fmin(fmax(2 * (eta[i] * E - e) - 1, -1), 1);
    }
    int status = spari_beam_stations(beam, n, s);
    const section_request to = {strain, force, x, q};
    status = status == SPAR_OK ? section_outputs(beam, n, s, eta, &to) : status;
    free(s);
    return status;
}
