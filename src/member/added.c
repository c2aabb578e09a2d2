/* A guess of the fluid's added mass: described, and in a member's equations. See added.h. */
#include "added.h"

#include "../base/blas.h"
#include "../base/quiet.h"
#include "../math/resample.h"
#include "../math/rotation.h"
#include "beam.h"
#include "edge.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_linalg.h>
#include <stdlib.h>
#include <string.h>

/* ---- description ---- */

/* Symmetric to 1e-6 of the diagonal entries, and positive semidefinite after scaling to a unit diagonal. */
static const char *added_mass_fault(const double M[36]) {
    double d[6], scaled[36];
    for (int i = 0; i < 6; i++) {
        if (M[7 * i] < 0) {
            return "not positive semidefinite";
        }
        d[i] = sqrt(M[7 * i]);
    }
    for (int i = 0; i < 6; i++) {
        for (int j = 0; j < 6; j++) {
            double size = d[i] * d[j];
            if (fabs(M[6 * i + j] - M[6 * j + i]) > 1e-6 * size) {
                return "not symmetric";
            }
            if (size == 0 && i != j && M[6 * i + j] != 0) {
                return "not positive semidefinite";
            }
            scaled[6 * i + j] = i == j ? 1 + 1e-6 : size > 0 ? 0.5 * (M[6 * i + j] + M[6 * j + i]) / size : 0;
        }
    }
    gsl_matrix_view view = gsl_matrix_view_array(scaled, 6, 6);
    int status;
    SPARI_BLAS(status = gsl_linalg_cholesky_decomp1(&view.matrix));
    return status == GSL_SUCCESS ? NULL : "not positive semidefinite";
}

static int check_guess(const spar_member *m, const char *call, int64_t n, const double *eta, const double *mass) {
    spar_session *s = m->session;
    SPARI_REQUIRE(s, m->kind != SPARI_POINT, SPAR_ERR_UNSUPPORTED,
                  "%s: '%s' is a point, whose motion the host gives: it has no equations that a mass could stand in",
                  call, m->name);
    SPARI_REQUIRE(s, n >= 0 && n <= SPARI_MOST && (n <= 1 || m->kind == SPARI_BEAM), SPAR_ERR_ARGUMENT,
                  "%s: '%s': %lld stations; give 0 to 2^40 of a beam, 1 of a rigid body, 0: no guess", call, m->name,
                  (long long)n);
    if (n > 0 && m->kind == SPARI_BEAM) {
        SPARI_TRY(spari_need_increasing(s, call, m->name, n, eta));
    }
    SPARI_TRY(spari_need_finite(s, call, m->name, "mass", 36 * n, mass));
    for (int64_t i = 0; i < n; i++) {
        const char *wrong = added_mass_fault(mass + 36 * i);
        SPARI_REQUIRE(s, !wrong, SPAR_ERR_ARGUMENT, "%s: '%s': the added mass of station %lld is %s", call, m->name,
                      (long long)i, wrong);
    }
    return SPAR_OK;
}

int spar_member_set_added_mass(spar_member *member, int64_t n, const double *eta, const double *mass) {
    SPARI_QUIET;
    SPARI_TRY(spari_need_open(member, __func__));
    SPARI_TRY(check_guess(member, __func__, n, eta, mass));
    int beam = member->kind == SPARI_BEAM;
    double *copies[2] = {beam && n > 0 ? spari_copy(eta, n) : spari_zalloc(n + 1, sizeof(double)),
                         n > 0 ? spari_copy(mass, 36 * n) : NULL};
    if (!copies[0] || (n > 0 && !copies[1])) {
        free(copies[0]), free(copies[1]);
        return spari_fail(member->session, SPAR_ERR_MEMORY, "%s: '%s': no memory for the added mass", __func__,
                          member->name);
    }
    free(member->guess_eta), free(member->guess);
    member->guess_eta = copies[0], member->guess = copies[1];
    member->guess_count = n;
    return SPAR_OK;
}

int spar_member_get_added_mass(const spar_member *member, int64_t *n, int64_t capacity, double *eta, double *mass) {
    SPARI_QUIET;
    SPARI_TRY(spari_need_member(member, __func__));
    SPARI_TRY(spari_need_capacity(member->session, __func__, capacity));
    if (n) {
        *n = member->guess_count;
    }
    spari_fill(capacity, eta, member->guess_count, member->guess_eta);
    spari_fill(36 * capacity, mass, 36 * member->guess_count, member->guess);
    return SPAR_OK;
}

/* ---- points ---- */

/* The guess per length along the line, at one Gauss point an element more than it has nodes. */
static int fill_beam(const spar_member *m, spari_added *d) {
    int P = m->per_element, points = d->points;
    int64_t count = (int64_t)m->elements * points;
    double xi[SPARI_MAX_NODES + 1], w[SPARI_MAX_NODES + 1], own[36], section[36];
    spari_station *s = spari_zalloc(count, sizeof *s);
    int ok = s && spari_gauss(points, xi, w) == 0;
    for (int64_t k = 0; k < count && ok; k++) {
        s[k].element = (int)(k / points);
        s[k].xi = xi[k % points];
    }
    ok = ok && spari_beam_stations(m, count, s) == SPAR_OK;
    for (int64_t k = 0; k < count && ok; k++) {
        double eta = 0.5 * (1 + spari_member_xi(m, s[k].element, s[k].xi)), *mass = d->mass + 36 * k;
        spari_beam_table_at(m->guess_count, m->guess_eta, m->guess, eta, own);
        spari_beam_turn_section(s[k].R, own, section);
        for (int i = 0; i < 36; i++) {
            mass[i] = w[k % points] * s[k].jacobian * section[i];
        }
        memcpy(d->phi + P * k, s[k].phi, (size_t)P * sizeof *s[k].phi);
    }
    free(s);
    return ok ? SPAR_OK : SPAR_ERR_MEMORY;
}

/* whole [36] += T^T mass T of a point, T taking the root's acceleration to it: a + alpha x arm */
static void gather_point(const double mass[36], const double arm[3], double whole[36]) {
    double T[36] = {0}, half[36] = {0}, skew[9];
    spari_skew(arm, skew);
    for (int i = 0; i < 6; i++) {
        T[7 * i] = 1;
    }
    for (int i = 0; i < 9; i++) {
        T[6 * (i / 3) + 3 + i % 3] = -skew[i];
    }
    for (int i = 0; i < 36; i++) {
        for (int j = 0; j < 6; j++) {
            half[i] += mass[6 * (i / 6) + j] * T[6 * j + i % 6];
        }
    }
    for (int i = 0; i < 36; i++) {
        for (int j = 0; j < 6; j++) {
            whole[i] += T[6 * j + i / 6] * half[6 * j + i % 6];
        }
    }
}

/* Of a beam that one body carries: the mass of the whole at its root. */
static int fill_whole(const spar_member *m, spari_added *d) {
    int P = m->per_element, points = P + 1;
    spari_added all = {.elements = m->elements, .per_element = P, .points = points};
    int64_t count = (int64_t)m->elements * points;
    all.mass = spari_zalloc((36 + P) * count, sizeof *all.mass);
    if (!all.mass) {
        return SPAR_ERR_MEMORY;
    }
    all.phi = all.mass + 36 * count;
    int status = fill_beam(m, &all);
    for (int64_t k = 0; k < count && status == SPAR_OK; k++) {
        const double *place = m->xr + 3 * (int64_t)P * (k / points);
        double arm[3] = {0};
        for (int i = 0; i < 3 * P; i++) {
            arm[i % 3] += all.phi[P * k + i / 3] * (place[i] - m->xr[i % 3]);
        }
        gather_point(all.mass + 36 * k, arm, d->mass);
    }
    free(all.mass);
    return status;
}

static int fill_added(spar_member *m, int whole) {
    spari_added *d = m->added;
    double R[9];
    if (m->kind == SPARI_BEAM && !whole) {
        return fill_beam(m, d);
    }
    d->phi[0] = 1;
    if (m->kind == SPARI_BEAM) {
        return fill_whole(m, d);
    }
    spari_quat_matrix(m->qr, R);
    spari_beam_turn_section(R, m->guess, d->mass);
    return SPAR_OK;
}

int spari_added_create(spar_member *m, int whole) {
    if (m->guess_count == 0 || !m->body || !(m->effects & SPAR_EFFECT_INERTIA)) {
        return SPAR_OK;
    }
    spari_added *d = m->added = spari_zalloc(1, sizeof *d);
    int ok = d != NULL, line = m->kind == SPARI_BEAM && !whole;
    if (ok) {
        d->elements = line ? m->elements : 1;
        d->per_element = line ? m->per_element : 1;
        d->points = line ? d->per_element + 1 : 1;
        int64_t count = (int64_t)d->elements * d->points;
        d->mass = spari_zalloc(36 * count, sizeof *d->mass);
        d->phi = spari_zalloc(d->per_element * count, sizeof *d->phi);
        d->shift = spari_zalloc(6 * m->nodes, sizeof *d->shift);
        d->past[0] = spari_zalloc(6 * m->nodes, sizeof *d->past[0]);
        d->past[1] = spari_zalloc(6 * m->nodes, sizeof *d->past[1]);
        ok = d->mass && d->phi && d->shift && d->past[0] && d->past[1] && fill_added(m, whole) == SPAR_OK;
    }
    SPARI_REQUIRE(m->session, ok, SPAR_ERR_MEMORY, "no memory for the added mass of '%s'", m->name);
    return SPAR_OK;
}

void spari_added_free(spari_added *d) {
    if (d) {
        free(d->mass);
        free(d->phi);
        free(d->shift);
        free(d->past[0]);
        free(d->past[1]);
        free(d);
    }
}

/* ---- in the equations ---- */

/* How the section at a point of element e is turned at t^n, as fluids see it: the nodes' quaternions summed. Small
   rotations are left out; a member that is linear seen from its root turns with that. */
static void turn_at(const spar_member *m, int64_t e, const double *phi, double turn[4]) {
    const spari_added *d = m->added;
    const double *q = m->now.q + 3;
    double sign = 1;
    memset(turn, 0, 4 * sizeof *turn);
    turn[0] = 1;
    if (!(m->effects & SPAR_EFFECT_LARGE_ROTATION) && !m->floats) {
        return;
    }
    if (d->per_element == 1 || m->seen == SPARI_SEEN_LINEAR) {
        memcpy(turn, q, 4 * sizeof *turn);
        return;
    }
    turn[0] = 0;
    q += 7 * e * d->per_element;
    for (int l = 0; l < d->per_element; l++) {
        sign = l > 0 && spari_quat_dot(q + 7 * l, q + 7 * l - 7) < 0 ? -sign : sign;
        for (int i = 0; i < 4; i++) {
            turn[i] += sign * phi[l] * q[7 * l + i];
        }
    }
    spari_quat_normalise(turn);
}

/* The first node of an element. */
static int64_t first_node(const spari_added *d, spari_numbering of, int64_t e) {
    return e * (of == SPARI_UNKNOWNS ? d->per_element - 1 : d->per_element);
}

/* force := mass of a point times an acceleration, in global axes */
static void times_point(const double turn[4], const double mass[36], const double a[6], double force[6]) {
    double own[6];
    spari_rotate_back(turn, a, own);
    spari_rotate_back(turn, a + 3, own + 3);
    for (int i = 0; i < 6; i++) {
        force[i] = 0;
        for (int j = 0; j < 6; j++) {
            force[i] += mass[6 * i + j] * own[j];
        }
    }
    spari_rotate(turn, force, force);
    spari_rotate(turn, force + 3, force + 3);
}

double spari_added_times(const spar_member *m, spari_numbering from, spari_numbering to, const double *a, double factor,
                         double *out) {
    const spari_added *d = m->added;
    int P = d->per_element;
    double largest = 0;
    for (int64_t k = 0; k < (int64_t)d->elements * d->points; k++) {
        int64_t e = k / d->points;
        const double *phi = d->phi + P * k, *in = a + 6 * first_node(d, from, e);
        double *back = out + 6 * first_node(d, to, e), turn[4], at[6] = {0}, force[6];
        turn_at(m, e, phi, turn);
        for (int l = 0; l < P; l++) {
            for (int i = 0; i < 6; i++) {
                at[i] += phi[l] * in[6 * l + i];
            }
        }
        times_point(turn, d->mass + 36 * k, at, force);
        for (int l = 0; l < P; l++) {
            for (int i = 0; i < 6; i++) {
                back[6 * l + i] += factor * phi[l] * force[i];
            }
        }
        for (int i = 0; i < 6; i++) {
            largest = fmax(largest, fabs(force[i]));
        }
    }
    return largest;
}

/* X diag(I, T); T NULL: the identity */
static void turn_columns(const double X[36], const double *T, double out[36]) {
    for (int i = 0; i < 36; i++) {
        const double *row = X + 6 * (i / 6) + 3;
        int j = i % 6 - 3;
        out[i] = T && j >= 0 ? row[0] * T[j] + row[1] * T[3 + j] + row[2] * T[6 + j] : X[i];
    }
}

/* to, 6x6 in rows of `row`, += f X */
static void add_section_block(double f, const double X[36], int64_t row, double *to) {
    for (int i = 0; i < 6; i++) {
        for (int j = 0; j < 6; j++) {
            to[row * i + j] += f * X[6 * i + j];
        }
    }
}

void spari_added_tangent(const spar_member *m, int e, double cm, const double *tinv, double *S) {
    const spari_added *d = m->added;
    int P = d->per_element;
    int64_t row = 6 * (int64_t)P, first = first_node(d, SPARI_UNKNOWNS, e);
    for (int64_t k = (int64_t)e * d->points; k < (int64_t)(e + 1) * d->points; k++) {
        const double *phi = d->phi + P * k;
        double turn[4] = {1, 0, 0, 0}, R[9], X[36], XT[36];
        if (tinv) {
            turn_at(m, e, phi, turn);
        }
        spari_quat_matrix(turn, R);
        spari_beam_turn_section(R, d->mass + 36 * k, X);
        for (int j = 0; j < P; j++) {
            turn_columns(X, tinv ? tinv + 9 * (first + j) : NULL, XT);
            for (int l = 0; l < P; l++) {
                double f = cm * phi[l] * phi[j], *to = S + row * 6 * l + 6 * j;
                add_section_block(f, XT, row, to);
            }
        }
    }
}

/* ---- in the loads ---- */

void spari_added_see(spar_member *m) {
    memset(m->added->shift, 0, (size_t)(6 * m->nodes) * sizeof(double));
    (void)spari_added_times(m, SPARI_NODES, SPARI_NODES, m->after.a, 1, m->added->shift);
}

void spari_added_predict(spar_member *m, const double w[3]) {
    const spari_added *d = m->added;
    const double *a[3] = {m->now.a, d->past[0], d->past[1]};
    for (int k = 0; k < 3; k++) {
        if (w[k] != 0) {
            (void)spari_added_times(m, SPARI_NODES, SPARI_NODES, a[k], w[k], m->load_used);
        }
    }
    spari_added_see(m);
}

void spari_added_correct(const spar_member *m, double factor, double *load) {
    for (int64_t i = 0; i < 6 * m->nodes; i++) {
        load[i] += factor * m->added->shift[i];
    }
}

const double *spari_added_shift(const spar_member *m) {
    return m->added && !m->session->standing ? m->added->shift : NULL;
}

void spari_added_accept(spar_member *m) {
    spari_added *d = m->added;
    double *oldest = d->past[1];
    d->past[1] = d->past[0];
    d->past[0] = oldest;
    memcpy(oldest, m->now.a, (size_t)(6 * m->nodes) * sizeof *oldest);
}

void spari_added_carry(const spar_member *from, spar_member *m) {
    for (int k = 0; k < 2 && from->added && m->added; k++) {
        spari_resample_values(m->elements, from->per_element, m->per_element, 6, -1, from->added->past[k],
                              m->added->past[k]);
    }
}
