/* Known added mass: its description by the host, and its terms in a member's equations. See added_mass.h. */
#include "added_mass.h"

#include "../algebra/dense.h"
#include "../base/environment.h"
#include "../math/resample.h"
#include "../math/rotation.h"
#include "beam.h"
#include "check_arguments.h"

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
    return spari_cholesky(6, scaled) ? "not positive semidefinite" : NULL;
}

static int check_guess(const spar_member *m, const char *call, int64_t n, const double *eta, const double *mass) {
    spar_session *s = m->session;
    SPARI_REQUIRE(s, m->kind != SPARI_POINT, SPAR_ERR_UNSUPPORTED,
                  "%s: '%s' is a point with prescribed motion; added mass does not apply to points", call, m->name);
    SPARI_REQUIRE(s, n >= 0 && n <= SPARI_MOST && (n <= 1 || m->kind == SPARI_BEAM), SPAR_ERR_ARGUMENT,
                  "%s: '%s': %lld stations; give 0 to 2^40 for a beam, 1 for a rigid body, or 0 for no added mass",
                  call, m->name, (long long)n);
    if (n > 0 && m->kind == SPARI_BEAM) {
        SPARI_TRY(spari_need_eta(s, call, m->name, n, eta, SPARI_INCREASING));
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
    SPARI_GUARD_ENVIRONMENT;
    SPARI_TRY(spari_need_open(member, __func__));
    SPARI_TRY(check_guess(member, __func__, n, eta, mass));
    return spari_line_table_set(member, __func__, "added mass", n, 36, member->kind == SPARI_BEAM ? eta : NULL, mass,
                                &member->guess);
}

int spar_member_get_added_mass(const spar_member *member, int64_t *n, int64_t capacity, double *eta, double *mass) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_TRY(spari_need_member(member, __func__));
    return spari_line_table_get(member, __func__, 36, &member->guess, capacity, n, eta, mass);
}

int spar_member_set_added_mass_response(spar_member *member, int response) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_TRY(spari_need_open(member, __func__));
    SPARI_REQUIRE(member->session, member->kind != SPARI_POINT, SPAR_ERR_UNSUPPORTED,
                  "%s: '%s' is a point with prescribed motion; added mass does not apply to points", __func__,
                  member->name);
    SPARI_REQUIRE(member->session, response == SPAR_RESPONSE_ACCELERATION || response == SPAR_RESPONSE_VELOCITY,
                  SPAR_ERR_ARGUMENT,
                  "%s: '%s': response %d is not known; give SPAR_RESPONSE_ACCELERATION or SPAR_RESPONSE_VELOCITY",
                  __func__, member->name, response);
    member->added_by_velocity = response == SPAR_RESPONSE_VELOCITY;
    return SPAR_OK;
}

int spar_member_get_added_mass_response(const spar_member *member, int *response) {
    SPARI_TRY(spari_need_member(member, __func__));
    SPARI_REQUIRE(member->session, response, SPAR_ERR_ARGUMENT, "%s: '%s': the pointer to the response is NULL",
                  __func__, member->name);
    *response = member->added_by_velocity ? SPAR_RESPONSE_VELOCITY : SPAR_RESPONSE_ACCELERATION;
    return SPAR_OK;
}

/* ---- strips ---- */

static void free_strips(spari_strips *p) {
    free(p->eta), free(p->R), free(p->phi), free(p->arm);
    *p = (spari_strips){0};
}

static int allocate_strips(spari_strips *p, int elements, int per_element, int in_element) {
    *p = (spari_strips){.count = (int64_t)elements * in_element, .per_element = per_element, .in_element = in_element};
    p->eta = spari_zalloc(2 * p->count, sizeof *p->eta);
    p->R = spari_zalloc(9 * p->count, sizeof *p->R);
    p->phi = spari_zalloc(per_element * p->count, sizeof *p->phi);
    p->arm = spari_zalloc(3 * p->count, sizeof *p->arm);
    p->weight = p->eta + (p->eta ? p->count : 0);
    return p->eta && p->R && p->phi && p->arm ? SPAR_OK : SPAR_ERR_MEMORY;
}

/* One Gauss point per element more than it has nodes. */
static int make_strips_of_beam(const spar_member *m, spari_strips *p) {
    int P = m->mesh.per_element, points = P + 1;
    double xi[SPARI_MAX_NODES + 1], w[SPARI_MAX_NODES + 1];
    SPARI_TRY(allocate_strips(p, m->mesh.elements, P, points));
    spari_station *s = spari_zalloc(p->count, sizeof *s);
    int ok = s != NULL;
    spari_gauss(points, xi, w);
    for (int64_t k = 0; k < p->count && ok; k++) {
        s[k].element = (int)(k / points);
        s[k].xi = xi[k % points];
    }
    ok = ok && spari_beam_stations(m, p->count, s) == SPAR_OK;
    for (int64_t k = 0; k < p->count && ok; k++) {
        const double *position = m->xr + 3 * (int64_t)P * (k / points);
        p->eta[k] = 0.5 * (1 + spari_member_xi(m, s[k].element, s[k].xi));
        p->weight[k] = w[k % points] * s[k].jacobian;
        memcpy(p->R + 9 * k, s[k].R, sizeof s[k].R);
        memcpy(p->phi + P * k, s[k].phi, (size_t)P * sizeof *s[k].phi);
        for (int i = 0; i < 3 * P; i++) {
            p->arm[3 * k + i % 3] += p->phi[P * k + i / 3] * (position[i] - m->xr[i % 3]);
        }
    }
    free(s);
    return ok ? SPAR_OK : SPAR_ERR_MEMORY;
}

static int make_strips(const spar_member *m, spari_strips *p) {
    if (m->kind == SPARI_BEAM) {
        return make_strips_of_beam(m, p);
    }
    SPARI_TRY(allocate_strips(p, 1, 1, 1));
    p->weight[0] = p->phi[0] = 1;
    spari_quat_matrix(m->qr, p->R);
    return SPAR_OK;
}

/* whole [36] += T^T mass T of a point, where T maps the root's acceleration to the point: a + alpha x arm */
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

void spari_added_fill(spar_member *m, int64_t n, const double *eta, const double *mass) {
    spari_added *d = m->added;
    const spari_strips *p = &d->strips;
    int64_t points = (int64_t)d->elements * d->points;
    double own[36], section[36];
    d->stands = n > 0;
    memset(d->mass, 0, (size_t)(36 * points) * sizeof *d->mass);
    for (int64_t k = 0; k < p->count && n > 0; k++) {
        spari_beam_table_at(n, eta, mass, 36, p->eta[k], own);
        spari_beam_rotate_section(p->R + 9 * k, own, section);
        for (int i = 0; i < 36; i++) {
            section[i] *= p->weight[k];
        }
        if (d->whole) {
            gather_point(section, p->arm + 3 * k, d->mass);
        } else {
            memcpy(d->mass + 36 * k, section, sizeof section);
        }
    }
}

/* The mass is kept at the strips, or at one point that combines them all. */
static int allocate_points(const spar_member *m, spari_added *d) {
    const spari_strips *p = &d->strips;
    d->elements = d->whole ? 1 : m->mesh.elements;
    d->per_element = d->whole ? 1 : p->per_element;
    d->points = d->whole ? 1 : p->in_element;
    int64_t count = (int64_t)d->elements * d->points;
    d->mass = spari_zalloc(36 * count, sizeof *d->mass);
    d->phi = spari_zalloc(d->per_element * count, sizeof *d->phi);
    int ok = d->mass && d->phi;
    double **nodal[] = {&d->shift, &d->past[0], &d->past[1], &d->mean[0], &d->mean[1], &d->mean[2], &d->scheme};
    for (size_t i = 0; i < sizeof nodal / sizeof *nodal; i++) {
        ok = ok && (*nodal[i] = spari_zalloc(6 * m->nodes, sizeof(double)));
    }
    if (!ok) {
        return SPAR_ERR_MEMORY;
    }
    d->phi[0] = 1;
    if (!d->whole) {
        memcpy(d->phi, p->phi, (size_t)(d->per_element * count) * sizeof *d->phi);
    }
    return SPAR_OK;
}

int spari_added_create(spar_member *m, int whole) {
    if ((m->guess.count == 0 && !m->learned) || !m->body || !(m->effects & SPAR_EFFECT_INERTIA)) {
        return SPAR_OK;
    }
    spari_added *d = m->added = spari_zalloc(1, sizeof *d);
    int status = d ? SPAR_OK : SPAR_ERR_MEMORY;
    if (d) {
        d->whole = whole && m->kind == SPARI_BEAM;
        status = make_strips(m, &d->strips);
        status = status == SPAR_OK ? allocate_points(m, d) : status;
    }
    SPARI_REQUIRE(m->session, status == SPAR_OK, SPAR_ERR_MEMORY, "no memory for the added mass of '%s'", m->name);
    spari_added_fill(m, m->guess.count, m->guess.eta, m->guess.value);
    if (!m->learned) {
        free_strips(&d->strips);
    }
    return SPAR_OK;
}

void spari_added_free(spari_added *d) {
    if (d) {
        SPARI_FREE(d->mass, d->phi, d->shift, d->past[0], d->past[1], d->mean[0], d->mean[1], d->mean[2], d->scheme,
                   d->last);
        free_strips(&d->strips);
        free(d);
    }
}

/* ---- tangent and forces ---- */

void spari_added_rotation(const spar_member *m, int64_t e, const double *phi, double rotation[4]) {
    const spari_added *d = m->added;
    const double *q = m->now.q + 3;
    double sign = 1;
    memset(rotation, 0, 4 * sizeof *rotation);
    rotation[0] = 1;
    if (spari_member_is_linear_in_place(m)) {
        return;
    }
    if (d->per_element == 1 || m->frame == SPARI_FRAME_LINEAR) {
        memcpy(rotation, q, 4 * sizeof *rotation);
        return;
    }
    rotation[0] = 0;
    q += 7 * e * d->per_element;
    for (int l = 0; l < d->per_element; l++) {
        sign = l > 0 && spari_quat_dot(q + 7 * l, q + 7 * l - 7) < 0 ? -sign : sign;
        for (int i = 0; i < 4; i++) {
            rotation[i] += sign * phi[l] * q[7 * l + i];
        }
    }
    spari_quat_normalise(rotation);
}

/* First node of an element. */
static int64_t first_node(const spari_added *d, spari_numbering of, int64_t e) {
    return e * (of == SPARI_UNKNOWNS ? d->per_element - 1 : d->per_element);
}

/* force := mass of a point times an acceleration, in global axes */
static void times_point(const double rotation[4], const double mass[36], const double a[6], double force[6]) {
    double own[6];
    spari_rotate_back(rotation, a, own);
    spari_rotate_back(rotation, a + 3, own + 3);
    for (int i = 0; i < 6; i++) {
        force[i] = 0;
        for (int j = 0; j < 6; j++) {
            force[i] += mass[6 * i + j] * own[j];
        }
    }
    spari_rotate(rotation, force, force);
    spari_rotate(rotation, force + 3, force + 3);
}

double spari_added_times(const spar_member *m, spari_numbering from, spari_numbering to, const double *a, double factor,
                         double *out) {
    const spari_added *d = m->added;
    int P = d->per_element;
    double largest = 0;
    for (int64_t k = 0; k < (int64_t)d->elements * d->points; k++) {
        int64_t e = k / d->points;
        const double *phi = d->phi + P * k, *in = a + 6 * first_node(d, from, e);
        double *back = out + 6 * first_node(d, to, e), rotation[4], at[6] = {0}, force[6];
        spari_added_rotation(m, e, phi, rotation);
        for (int l = 0; l < P; l++) {
            for (int i = 0; i < 6; i++) {
                at[i] += phi[l] * in[6 * l + i];
            }
        }
        times_point(rotation, d->mass + 36 * k, at, force);
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
static void rotate_columns(const double X[36], const double *T, double out[36]) {
    for (int i = 0; i < 36; i++) {
        const double *row = X + 6 * (i / 6) + 3;
        int j = i % 6 - 3;
        out[i] = T && j >= 0 ? row[0] * T[j] + row[1] * T[3 + j] + row[2] * T[6 + j] : X[i];
    }
}

void spari_added_tangent(const spar_member *m, int e, double cm, const double *tinv, double *S) {
    const spari_added *d = m->added;
    int P = d->per_element;
    int64_t row = 6 * (int64_t)P, first = first_node(d, SPARI_UNKNOWNS, e);
    for (int64_t k = (int64_t)e * d->points; k < (int64_t)(e + 1) * d->points; k++) {
        const double *phi = d->phi + P * k;
        double rotation[4] = {1, 0, 0, 0}, R[9], X[36], XT[36];
        if (tinv) {
            spari_added_rotation(m, e, phi, rotation);
        }
        spari_quat_matrix(rotation, R);
        spari_beam_rotate_section(R, d->mass + 36 * k, X);
        for (int j = 0; j < P; j++) {
            rotate_columns(X, tinv ? tinv + 9 * (first + j) : NULL, XT);
            for (int l = 0; l < P; l++) {
                double f = cm * phi[l] * phi[j], *to = S + row * 6 * l + 6 * j;
                for (int i = 0; i < 36; i++) {
                    to[row * (i / 6) + i % 6] += f * XT[i];
                }
            }
        }
    }
}

/* ---- predicted loads ---- */

void spari_added_see(spar_member *m) {
    memset(m->added->shift, 0, (size_t)(6 * m->nodes) * sizeof(double));
    (void)spari_added_times(m, SPARI_NODES, SPARI_NODES, m->after.a, 1, m->added->shift);
}

/* Integration scheme: weights of (v^{n+1} - v^n) / dt by the true accelerations at both ends and the algorithmic one
   b^n, and of b^{n+1} (time/scheme.h). For a step of TR-BDF2 the acceleration at its stage is interpolated linearly
   and b^n does not enter. */
typedef struct integration {
    double a0, b0, a1;                /* weights of the change of velocity */
    double next_a0, next_b0, next_a1; /* weights of b^{n+1} */
    double stretch;                   /* amplification of b^n - a^n per step */
} integration;

static integration integration_of(const spar_session *s, double dt) {
    double rho = s->integrator.rho_inf, am = (2 * rho - 1) / (rho + 1), af = rho / (rho + 1), gamma = 0.5 + af - am,
           f = fmax(am - af, -0.8);
    if (!spari_steps_even(&s->clock, dt)) {
        return (integration){0.5, 0, 0.5, -f, 0, 1 + f, 1};
    }
    return (integration){.a0 = gamma * af / (1 - am),
                         .b0 = 1 - gamma - gamma * am / (1 - am),
                         .a1 = gamma * (1 - af) / (1 - am),
                         .next_a0 = af / (1 - am),
                         .next_b0 = -am / (1 - am),
                         .next_a1 = (1 - af) / (1 - am),
                         .stretch = s->clock.step > 0 ? dt / s->clock.dt_last[0] : 1};
}

/* Fluid that takes accelerations from velocities: its acceleration is the change of velocity over dt. A multiplies
   the part that depends on the acceleration at t^{n+1}. The total is extrapolated, and the part known at t^n is
   subtracted. */
static void predict_by_velocity(spar_member *m, const double w[3], double dt) {
    const spari_added *d = m->added;
    const integration g = integration_of(m->session, dt);
    for (int64_t i = 0; i < 6 * m->nodes; i++) {
        double a = m->now.a[i], b = a + g.stretch * (d->scheme[i] - a);
        d->shift[i] = w[0] * d->mean[0][i] + w[1] * d->mean[1][i] + w[2] * d->mean[2][i] - g.a0 * a - g.b0 * b;
    }
    (void)spari_added_times(m, SPARI_NODES, SPARI_NODES, d->shift, 1 / g.a1, m->load.used);
}

void spari_added_predict(spar_member *m, const double w[3], double dt) {
    const spari_added *d = m->added;
    const double *a[3] = {m->now.a, d->past[0], d->past[1]};
    int by_velocity = m->added_by_velocity && m->session->integrator.substeps == 1;
    if (by_velocity) {
        predict_by_velocity(m, w, dt);
    }
    for (int k = 0; k < 3 && !by_velocity; k++) {
        if (w[k] != 0) {
            (void)spari_added_times(m, SPARI_NODES, SPARI_NODES, a[k], w[k], m->load.used);
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
    return m->added && !m->session->state.static_solution ? m->added->shift : NULL;
}

void spari_added_restart(spar_member *m) {
    double *all[] = {m->added->mean[0], m->added->mean[1], m->added->mean[2], m->added->scheme};
    for (size_t k = 0; k < sizeof all / sizeof *all; k++) {
        memcpy(all[k], m->now.a, (size_t)(6 * m->nodes) * sizeof(double));
    }
}

static void accept_means(spar_member *m) {
    spari_added *d = m->added;
    double *last = d->mean[2], dt = m->session->clock.dt;
    const integration g = integration_of(m->session, dt);
    d->mean[2] = d->mean[1], d->mean[1] = d->mean[0], d->mean[0] = last;
    for (int64_t i = 0; i < 6 * m->nodes; i++) {
        double a = m->now.a[i], b = a + g.stretch * (d->scheme[i] - a);
        last[i] = (m->after.v[i] - m->now.v[i]) / dt;
        d->scheme[i] = g.next_a1 * m->after.a[i] + g.next_a0 * a + g.next_b0 * b;
    }
}

void spari_added_accept(spar_member *m) {
    spari_added *d = m->added;
    accept_means(m);
    double *oldest = d->past[1];
    d->past[1] = d->past[0];
    d->past[0] = oldest;
    memcpy(oldest, m->now.a, (size_t)(6 * m->nodes) * sizeof *oldest);
}

void spari_added_carry(const spar_member *from, spar_member *m) {
    if (!from->added || !m->added) {
        return;
    }
    const spari_added *old = from->added, *d = m->added;
    const double *was[] = {old->past[0], old->past[1], old->mean[0], old->mean[1], old->mean[2], old->scheme};
    double *is[] = {d->past[0], d->past[1], d->mean[0], d->mean[1], d->mean[2], d->scheme};
    for (size_t k = 0; k < sizeof is / sizeof *is; k++) {
        spari_resample_values(from->mesh, m->mesh, 6, -1, was[k], is[k]);
    }
}
