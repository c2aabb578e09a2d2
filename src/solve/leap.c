/* The acceleration that a longer step begins with: see leap.h. */
#include "leap.h"

#include "../math/rotation.h"

#include <string.h>

/* The rigid motion of a member: place and angular velocity of its middle, accelerations there. */
typedef struct rigid {
    double middle[3], omega[3], a[3], alpha[3];
} rigid;

/* Place of a node now, from the middle. */
static void arm_now(const spar_member *m, const double *q, int i, const double middle[3], double r[3]) {
    const double *place = spari_member_place(m, i);
    for (int k = 0; k < 3; k++) {
        r[k] = place[k] + q[7 * i + k] - middle[k];
    }
}

/* What the turn of the whole gives a node, omega x (omega x r). */
static void centripetal(const rigid *g, const double r[3], double c[3]) {
    double t[3];
    spari_cross(g->omega, r, t);
    spari_cross(g->omega, t, c);
}

/* x := A^-1 x for a symmetric positive definite A [3][3], by Cramer's rule */
static void solve3(const double A[9], double x[3]) {
    double c0[3], c1[3], c2[3];
    spari_cross(A + 3, A + 6, c0);
    spari_cross(A + 6, A, c1);
    spari_cross(A, A + 3, c2);
    double det = spari_dot(A, c0), y[3] = {x[0], x[1], x[2]};
    for (int k = 0; k < 3; k++) {
        x[k] = (c0[k] * y[0] + c1[k] * y[1] + c2[k] * y[2]) / det;
    }
}

static void means(const spari_solver *s, const spar_member *m, const double *q, const double *v, const double *b,
                  rigid *g) {
    int n = s->n;
    const double zero[3] = {0};
    memset(g, 0, sizeof *g);
    for (int i = 0; i < n; i++) {
        double x[3];
        arm_now(m, q, i, zero, x);
        for (int k = 0; k < 3; k++) {
            g->middle[k] += x[k] / n;
            g->omega[k] += v[6 * i + 3 + k] / n;
            g->a[k] += b[6 * i + k] / n;
        }
    }
}

/* The rigid motion whose accelerations are nearest to b by least squares over the nodes, turns times the length. The
   arms sum up to nothing, so that the mean acceleration stands by itself. */
static void fit(const spari_solver *s, const spar_member *m, const double *q, const double *v, const double *b,
                rigid *g) {
    int n = s->n;
    double L2 = s->body->length * s->body->length, A[9] = {0}, right[3] = {0};
    means(s, m, q, v, b, g);
    for (int i = 0; i < n; i++) {
        double r[3], c[3], t[3];
        arm_now(m, q, i, g->middle, r);
        centripetal(g, r, c);
        for (int k = 0; k < 3; k++) {
            c[k] = b[6 * i + k] - c[k];
        }
        spari_cross(r, c, t);
        for (int k = 0; k < 3; k++) {
            right[k] += t[k] + L2 * b[6 * i + 3 + k];
            A[4 * k] += spari_dot(r, r) + L2;
            for (int j = 0; j < 3; j++) {
                A[3 * k + j] -= r[k] * r[j];
            }
        }
    }
    solve3(A, right);
    memcpy(g->alpha, right, sizeof right);
}

/* b less the accelerations of a rigid motion */
static void subtract(const spari_solver *s, const spar_member *m, const double *q, const rigid *g, const double *b,
                     double *y) {
    for (int i = 0; i < s->n; i++) {
        double r[3], c[3], t[3];
        arm_now(m, q, i, g->middle, r);
        centripetal(g, r, c);
        spari_cross(g->alpha, r, t);
        for (int k = 0; k < 3; k++) {
            y[6 * i + k] = b[6 * i + k] - g->a[k] - c[k] - t[k];
            y[6 * i + 3 + k] = b[6 * i + 3 + k] - g->alpha[k];
        }
    }
}

void spari_leap_take_spin(const spari_solver *s, const spar_member *m, const spari_state *at, const spari_scheme *c,
                          double *y) {
    rigid g;
    means(s, m, at->q, at->v, y, &g);
    double z = spari_dot(g.omega, g.omega) / c->cm, resolved = 1 - z / (1 + z) * (z / (1 + z));
    for (int i = 0; i < s->n; i++) {
        double r[3], a[3];
        arm_now(m, at->q, i, g.middle, r);
        centripetal(&g, r, a);
        for (int k = 0; k < 3; k++) {
            y[6 * i + k] -= resolved * a[k];
        }
    }
}

/* The beginning of a step. Arrays of the solver that are not in use there serve as room: `rest` for the forces at rest,
   `still` for velocities of zero. */
typedef struct leap_state {
    const spari_body *body;
    const double *q, *still, *rest;
    int n;
} leap_state;

/* r := M y: the forces that accelerations take beyond those at rest. */
static void times_mass(void *self, const spar_member *m, const double *y, double *r) {
    const leap_state *l = self;
    (void)m;
    spari_body_residual(l->body, l->q, l->still, y, 0, r, NULL);
    for (int i = 0; i < l->n; i++) {
        r[i] -= l->rest[i];
    }
}

int spari_leap(spari_solver *s, const spar_member *m, const spari_state *at, const spari_scheme *c, double *b) {
    int held = spari_member_held(m), n6 = 6 * s->n;
    double *y = s->increment, *rest = s->tinv, *still = s->best; /* the next step begins with its own */
    leap_state l = {s->body, at->q, still, rest, n6};
    memcpy(y, b, (size_t)n6 * sizeof *y);
    if (!spari_member_root_is_given(m)) {
        rigid g;
        fit(s, m, at->q, at->v, b, &g);
        subtract(s, m, at->q, &g, b, y);
    }
    memset(y, 0, (size_t)held * sizeof *y);
    for (int i = 0; i < n6; i++) { /* what is not rigid goes out, and comes back as far as it passes */
        b[i] -= y[i];
    }
    memcpy(s->dx, y, (size_t)n6 * sizeof *y);
    memset(still, 0, (size_t)n6 * sizeof *still);
    spari_body_residual(s->body, at->q, still, still, 0, rest, NULL);
    if (spari_solver_factor(s, m, at->q, at->v, at->a, 1, c->cm, c->cv, NULL) ||
        spari_scheme_filter_vector(c, s->linear, held, n6, times_mass, &l, m, s->r, y)) {
        return 1;
    }
    for (int i = 0; i < n6; i++) {
        b[i] += s->dx[i] - y[i];
    }
    return 0;
}
