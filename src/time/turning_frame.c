/* The reference motion of a member that turns freely: see turning_frame.h. */
#include "turning_frame.h"

#include "../base/session.h"
#include "../math/rotation.h"

#include <math.h>
#include <string.h>

int spari_turning_centre(const spari_solver *s, const spar_member *m, double c[3]) {
    double mass[10] = {0};
    if (s->n != 1 || !s->body->mass || spari_member_constrained(m) != 0) {
        return 0;
    }
    spari_slot_get(s->body->mass, 10, 0, mass);
    for (int k = 0; k < 3; k++) {
        c[k] = mass[0] > 0 ? mass[1 + k] / mass[0] : 0;
    }
    return mass[0] > 0;
}

/* y := R x - x, without their difference: steps that are short feel its rounding as accelerations. */
static void change_of(const double q[4], const double x[3], double y[3]) {
    double once[3], twice[3];
    spari_cross(q + 1, x, once);
    spari_cross(q + 1, once, twice);
    for (int k = 0; k < 3; k++) {
        y[k] = 2 * (q[0] * once[k] + twice[k]);
    }
}

/* to := the motion of the point of a body at `by` R c from the point with the motion `from`. */
static void shift_point(const double c[3], double by, const spari_state *from, spari_state *to) {
    const double *w = from->v + 3;
    double arm[3], moved[3], spin[3], inward[3], grow[3];
    spari_rotate(from->q + 3, c, arm);
    change_of(from->q + 3, c, moved);
    spari_cross(w, arm, spin);
    spari_cross(w, spin, inward);
    spari_cross(from->a + 3, arm, grow);
    for (int k = 0; k < 3; k++) {
        to->q[k] = from->q[k] + by * moved[k];
        to->v[k] = from->v[k] + by * spin[k];
        to->a[k] = from->a[k] + by * (inward[k] + grow[k]);
        to->q[4 + k] = from->q[4 + k];
        to->v[3 + k] = w[k];
        to->a[3 + k] = from->a[3 + k];
    }
    to->q[3] = from->q[3];
    memcpy(to->b, from->b, 6 * sizeof *to->b);
}

static void add_origin(const spari_pose *origin, double by, spari_state *s) {
    for (int k = 0; k < 3; k++) {
        s->q[k] += by * origin->q[k];
        s->v[k] += by * origin->v[k];
        s->a[k] += by * origin->a[k];
    }
}

void spari_centre_look(const double c[3], const spari_pose *origin, const spari_state *node, spari_state *centre) {
    shift_point(c, 1, node, centre);
    if (origin) {
        add_origin(origin, -1, centre);
    }
}

void spari_centre_show(const double c[3], const spari_pose *origin, const spari_state *centre, spari_state *node) {
    shift_point(c, -1, centre, node);
    if (origin) {
        add_origin(origin, 1, node);
    }
}

void spari_turning_shares(const spari_solver *s, double *share) {
    const spari_body *b = s->body;
    const int P = b->per_element;
    double mass = 0;
    memset(share, 0, (size_t)s->n * sizeof *share);
    for (int e = 0; e < b->elements; e++) {
        for (int k = b->first[e]; k < b->first[e + 1]; k++) {
            const int64_t slot = b->slot[e] + k - b->first[e];
            const double part = *SPARI_BLOCK(b->weight, 1, slot) * *SPARI_BLOCK(b->mass, 10, slot);
            mass += part;
            for (int l = 0; l < P; l++) {
                share[e * (P - 1) + l] += part * b->phi[(int64_t)k * P + l];
            }
        }
    }
    for (int i = 0; i < s->n; i++) {
        share[i] /= mass;
    }
}

/* x := A^-1 y of a symmetric matrix. */
static void solve3(const double A[9], const double y[3], double x[3]) {
    double c[3][3];
    spari_cross(A + 3, A + 6, c[0]);
    spari_cross(A + 6, A, c[1]);
    spari_cross(A, A + 3, c[2]);
    const double det = spari_dot(A, c[0]);
    for (int k = 0; k < 3; k++) {
        x[k] = (c[0][k] * y[0] + c[1][k] * y[1] + c[2][k] * y[2]) / det;
    }
}

/* Mean angular velocity and acceleration of the nodes: what the momenta do not determine. */
static void mean_rotation(const spar_member *m, double w[3], double alpha[3]) {
    for (int k = 0; k < 3; k++) {
        w[k] = alpha[k] = 0;
        for (int64_t i = 0; i < m->nodes; i++) {
            w[k] += m->now.v[6 * i + 3 + k] / (double)m->nodes;
            alpha[k] += m->now.a[6 * i + 3 + k] / (double)m->nodes;
        }
    }
}

/* Relative to the largest inertia: the least that the momenta determine, of a straight beam about its axis. */
static const double least_inertia = 1e-9;

/* w += (I + e)^-1 (y - I w) */
static void correct_rotation(const double inertia[9], const double y[3], double w[3]) {
    const double least = least_inertia * (inertia[0] + inertia[4] + inertia[8]);
    double A[9], rest[3], more[3];
    memcpy(A, inertia, sizeof A);
    for (int k = 0; k < 3; k++) {
        A[4 * k] += least;
        rest[k] = y[k] - spari_dot(inertia + 3 * k, w);
    }
    if (least > 0) {
        solve3(A, rest, more);
        for (int k = 0; k < 3; k++) {
            w[k] += more[k];
        }
    }
}

void spari_carrier_rotation(const spari_solver *s, const spar_member *m, const double a[3], spari_carrier *c) {
    spari_momenta t;
    double origin[3], moved[3], gyro[3];
    if (s->n == 1) {
        memcpy(c->w, m->now.v + 3, sizeof c->w);
        memcpy(c->alpha, m->now.a + 3, sizeof c->alpha);
        return;
    }
    mean_rotation(m, c->w, c->alpha);
    for (int k = 0; k < 3; k++) {
        origin[k] = m->xr[k] + c->x[k];
    }
    spari_body_momenta(s->body, m->xr, m->now.q, m->now.v, m->now.a, origin, &t);
    spari_cross(t.first, c->v, moved);
    for (int k = 0; k < 3; k++) {
        t.angular[k] -= moved[k];
    }
    correct_rotation(t.inertia, t.angular, c->w);
    spari_cross(t.first, a, moved);
    for (int k = 0; k < 3; k++) {
        gyro[k] = spari_dot(t.inertia + 3 * k, c->w);
    }
    spari_cross(c->w, gyro, gyro);
    for (int k = 0; k < 3; k++) {
        t.moment[k] -= moved[k] + gyro[k];
    }
    correct_rotation(t.inertia, t.moment, c->alpha);
}

void spari_carrier_begin(const spari_solver *s, const spar_member *m, spari_carrier *c) {
    const int pinned = spari_member_constrained(m) == 3;
    spari_momenta t;
    double a[3] = {0};
    *c = (spari_carrier){.turns = !spari_member_root_is_prescribed(m)};
    if (!c->turns || !s->body->mass) {
        return;
    }
    memcpy(c->x, m->now.q, sizeof c->x); /* a pinned root */
    if (!pinned) {
        const spari_motion *now = &m->now;
        spari_body_momenta(s->body, m->xr, now->q, now->v, now->a, m->xr, &t);
        for (int k = 0; k < 3 && t.mass > 0; k++) {
            c->x[k] = t.first[k] / t.mass;
            c->v[k] = t.linear[k] / t.mass;
            a[k] = t.force[k] / t.mass;
        }
    }
    spari_carrier_rotation(s, m, a, c);
    if (!pinned) {
        memcpy(c->path, c->w, sizeof c->path);
        memcpy(c->grows, c->alpha, sizeof c->grows);
    }
}

/* rad in a step: a larger rotation is not resolved, and the series of spari_turning_frame_at ends. */
static const double farthest = 1;

/* A rigid body of one node. */
static void find_body(const spar_member *m, double dt, const spari_carrier *carrier, spari_turning_frame *f) {
    double Rc[3];
    if (carrier->held) {
        memcpy(f->centre, carrier->point, sizeof f->centre);
    }
    f->rests = carrier->held || m->joint_count == 0 || spari_norm(f->begin.v + 3) * dt > farthest;
    f->kind = spari_norm(f->centre) > 0 || !f->rests ? SPARI_TURNS_AS_BODY : SPARI_TURNS_NOT;
    spari_rotate(m->now.q + 3, f->centre, Rc);
    for (int k = 0; k < 3; k++) {
        f->arm[k] = m->now.q[k] + Rc[k] - f->begin.q[k];
    }
}

/* The angular velocity in the middle of the step. An angular acceleration that a step does not resolve does not
   count. */
static void middle_rotation(double half, const double w[3], const double alpha[3], double middle[3]) {
    const double size = half * spari_norm(alpha), most = 0.5 * spari_norm(w), part = size > most ? most / size : 1;
    for (int k = 0; k < 3; k++) {
        middle[k] = w[k] + part * half * alpha[k];
    }
}

void spari_turning_frame_find(const spari_solver *s, const spar_member *m, spari_rule rule, double dt,
                              const spari_carrier *carrier, spari_turning_frame *f) {
    const double half = rule == SPARI_ALPHA && m->joint_count > 0 ? 0 : 0.5 * dt;
    const int body = spari_turning_centre(s, m, f->centre);
    double way[3];
    f->alone = m->joint_count == 0 && spari_member_constrained(m) == 0;
    f->kind = SPARI_TURNS_NOT; /* multipliers of generalised-alpha may oscillate: then the rotation at t^n */
    if (!carrier->turns || !s->body->mass || (s->n == 1 && !body)) {
        return;
    }
    f->begin = (spari_pose){.q = {0, 0, 0, 1, 0, 0, 0}};
    middle_rotation(half, carrier->w, carrier->alpha, f->begin.v + 3);
    middle_rotation(half, carrier->path, carrier->grows, f->path);
    for (int k = 0; k < 3; k++) {
        f->begin.q[k] = carrier->x[k];
        f->begin.v[k] = carrier->v[k];
        f->steady[k] = carrier->base_a[k];
        way[k] = carrier->v[k] - carrier->base_v[k];
    }
    spari_cross(f->path, way, f->begin.a);
    const double turn = dt * fmax(spari_norm(f->begin.v + 3), spari_norm(f->path));
    if (body) {
        find_body(m, dt, carrier, f);
    } else if (turn > 0 && turn <= farthest) {
        f->kind = SPARI_TURNS_WITH_FRAME;
    }
}

/* The motion of the origin in a circle: with psi = w t its velocity and position are the series
   t sum psi~^k / (k + 1)! and t^2 sum psi~^k / (k + 2)! of the acceleration. */
static void follow_path(const spari_turning_frame *f, double t, spari_pose *out) {
    double psi[3], term[3], rotation[4], first = t, second = 0.5 * t * t;
    for (int k = 0; k < 3; k++) {
        psi[k] = t * f->path[k];
        term[k] = f->begin.a[k];
        out->q[k] += t * f->begin.v[k] + second * f->steady[k];
        out->v[k] += t * f->steady[k];
    }
    for (int j = 0; j < 24 && spari_dot(term, term) > 0; j++) { /* exact to rounding for psi <= 2 */
        for (int k = 0; k < 3; k++) {
            out->v[k] += first * term[k];
            out->q[k] += second * term[k];
        }
        spari_cross(psi, term, term);
        first /= j + 2, second /= j + 3;
    }
    spari_quat_exp(psi, rotation);
    spari_rotate(rotation, f->begin.a, out->a);
    for (int k = 0; k < 3; k++) {
        out->a[k] += f->steady[k];
    }
}

spari_pose spari_turning_frame_at(const spari_turning_frame *f, double t) {
    spari_pose out = f->begin;
    for (int k = 0; k < 3 && f->kind == SPARI_TURNS_AS_BODY; k++) {
        out.q[k] = 0;
    }
    const double *w = f->begin.v + 3, psi[3] = {t * w[0], t * w[1], t * w[2]};
    follow_path(f, t, &out);
    spari_quat_exp(psi, out.q + 3);
    if (f->kind == SPARI_TURNS_AS_BODY) { /* the point at `arm`, from where it is at t^n */
        double arm[3], moved[3], spin[3], inward[3];
        spari_rotate(out.q + 3, f->arm, arm);
        change_of(out.q + 3, f->arm, moved);
        spari_cross(w, arm, spin);
        spari_cross(w, spin, inward);
        for (int k = 0; k < 3; k++) {
            out.q[k] += moved[k];
            out.v[k] += spin[k];
            out.a[k] += inward[k];
        }
    }
    return out;
}
