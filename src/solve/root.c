/* The motion of a driven root: within a step, where it jumps, and what is seen from it. */
#include "root.h"

#include "../math/rotation.h"

#include <string.h>

void spari_root_look_from(const spari_solver *solver, const spar_member *m, const double *root, const spari_state *s,
                          spari_state *own) {
    double W[3], A[3], back[4];
    spari_quat_conj(root + 3, back);
    spari_rotate_back(root + 3, root + 10, W);
    spari_rotate_back(root + 3, root + 16, A);
    for (int i = 0; i < solver->n; i++) {
        double arm[3], d[3], c1[3], c2[3], c3[3], *v = own->v + 6 * i, *a = own->a + 6 * i, *q = own->q + 7 * i;
        spari_member_arm(m, i, arm);
        for (int k = 0; k < 3; k++) {
            d[k] = arm[k] + s->q[7 * i + k] - root[k];
        }
        for (int k = 0; k < 6; k++) {
            v[k] = s->v[6 * i + k] - root[7 + k];
            a[k] = s->a[6 * i + k] - root[13 + k];
        }
        spari_rotate_back(root + 3, d, d);
        for (int k = 0; k < 6; k += 3) {
            spari_rotate_back(root + 3, v + k, v + k);
            spari_rotate_back(root + 3, a + k, a + k);
        }
        spari_quat_mul(back, s->q + 7 * i + 3, q + 3);
        spari_cross(W, d, c1);
        for (int k = 0; k < 3; k++) {
            q[k] = d[k] - arm[k];
            v[k] -= c1[k];
            c1[k] += 2 * v[k];
        }
        spari_cross(W, c1, c2);
        spari_cross(A, d, c3);
        spari_cross(W, v + 3, c1);
        for (int k = 0; k < 3; k++) {
            a[k] -= c2[k] + c3[k];
            a[3 + k] -= c1[k];
        }
    }
    memcpy(own->b, s->b, (size_t)(6 * solver->n) * sizeof *own->b);
}

void spari_root_show(const spari_solver *solver, const spar_member *m, spari_ends *e) {
    const double *root = e->root;
    double W[3], A[3];
    if (!root) {
        return;
    }
    spari_rotate_back(root + 3, root + 10, W);
    spari_rotate_back(root + 3, root + 16, A);
    for (int i = 0; i < solver->n; i++) {
        const double *v = e->to.v + 6 * i, *a = e->to.a + 6 * i;
        double arm[3], d[3], c1[3], c2[3], c3[3], *q = e->seen.q + 7 * i, *V = e->seen.v + 6 * i,
                                                  *B = e->seen.a + 6 * i;
        spari_member_arm(m, i, arm);
        for (int k = 0; k < 3; k++) {
            d[k] = arm[k] + e->to.q[7 * i + k];
        }
        spari_cross(W, d, c1);
        for (int k = 0; k < 3; k++) {
            V[k] = v[k] + c1[k];
            V[3 + k] = v[3 + k] + W[k];
            c1[k] += 2 * v[k];
        }
        spari_cross(W, c1, c2);
        spari_cross(A, d, c3);
        spari_cross(W, v + 3, c1);
        for (int k = 0; k < 3; k++) {
            B[k] = a[k] + c2[k] + c3[k];
            B[3 + k] = a[3 + k] + A[k] + c1[k];
        }
        spari_rotate(root + 3, d, d);
        for (int k = 0; k < 6; k += 3) {
            spari_rotate(root + 3, V + k, V + k);
            spari_rotate(root + 3, B + k, B + k);
        }
        for (int k = 0; k < 3; k++) {
            q[k] = root[k] + d[k] - arm[k];
            V[k] += root[7 + k];
            B[k] += root[13 + k];
        }
        spari_quat_mul(root + 3, e->to.q + 7 * i + 3, q + 3);
        spari_quat_normalise(q + 3);
    }
    memcpy(e->seen.b, e->to.b, (size_t)(6 * solver->n) * sizeof(double));
}

/* Where the root jumps the nodes keep place and velocity: seen from it they lose the jump. */
static void lose_jump(const spari_solver *solver, const spar_member *m, double h, const double *from, const double *to,
                      spari_state *own) {
    double J[6], E[6], back[4], less[3];
    spari_root_jump(from, to, h, J, E);
    for (int k = 0; k < 3; k++) {
        less[k] = -E[3 + k];
    }
    spari_quat_exp(less, back);
    for (int i = 1; i < solver->n; i++) {
        double *q = own->q + 7 * i, *v = own->v + 6 * i, d[3], c1[3], c2[3];
        spari_member_arm(m, i, d);
        for (int k = 0; k < 3; k++) {
            d[k] += q[k];
        }
        spari_cross(J + 3, d, c1);
        spari_cross(E + 3, d, c2);
        for (int k = 0; k < 3; k++) {
            v[k] -= J[k] + c1[k];
            v[3 + k] -= J[3 + k];
            q[k] -= E[k] + c2[k];
        }
        spari_quat_mul(back, q + 3, q + 3);
    }
}

void spari_root_of(const spari_state *s, double root[19]) {
    memcpy(root, s->q, 7 * sizeof *root);
    memcpy(root + 7, s->v, 6 * sizeof *root);
    memcpy(root + 13, s->a, 6 * sizeof *root);
}

spari_ends spari_root_ends(const spari_solver *s, const spar_member *m, const spari_scheme *c, const double *root,
                           double ratio, spari_state *from, spari_state *to) {
    spari_ends e = {*from, *to, *to, NULL, 0};
    if (s->own[0].q && !c->still) {
        double before[19], turn[4], psi[3], way[3];
        spari_root_of(from, before);
        spari_quat_conj(before + 3, turn);
        spari_quat_mul(root + 3, turn, turn);
        spari_quat_log(turn, psi);
        for (int k = 0; k < 3; k++) {
            way[k] = root[k] - before[k];
        }
        e.from = s->own[0], e.to = s->own[1], e.root = root;
        e.carried = spari_norm(way) / s->body->length + spari_norm(psi);
        spari_root_look_from(s, m, before, from, &e.from);
        lose_jump(s, m, c->h, before, root, &e.from);
    }
    spari_scheme_stretch_by(ratio, 6 * s->n, e.from.a, e.from.b);
    return e;
}

void spari_root_jump(const double *from, const double *to, double h, double velocity[6], double place[6]) {
    double back[4], turn[4];
    for (int k = 0; k < 3; k++) {
        place[k] = to[k] - from[k];
    }
    spari_quat_conj(from + 3, back);
    spari_quat_mul(to + 3, back, turn);
    spari_quat_log(turn, place + 3);
    for (int k = 0; k < 6; k++) {
        const double *v = from + 7, *a = from + 13, *b = to + 13;
        velocity[k] = to[7 + k] - v[k] - 0.5 * h * (a[k] + b[k]);
        place[k] -= h * (v[k] + velocity[k] + h * (a[k] / 3 + b[k] / 6));
    }
    for (int k = 0; k < 6; k += 3) {
        spari_rotate_back(to + 3, velocity + k, velocity + k);
        spari_rotate_back(to + 3, place + k, place + k);
    }
}

/* Root motion at s in (0, 1] of the step: cubic Hermite in u and in the rotation vector from t^n, whose rate is T^-1
 * omega. */
void spari_root_at(const spar_member *member, double s, double dt, double out[19]) {
    const double *a = member->drive[0], *b = member->drive[1];
    if (s >= 1) {
        memcpy(out, b, 19 * sizeof *out);
        return;
    }
    double c[4], p[4], psi1[3], t[9], rate1[3], psi[3], rate[3], h00 = 1 - s * s * (3 - 2 * s),
                                                                 h01 = s * s * (3 - 2 * s);
    double h10 = s * (1 - s) * (1 - s), h11 = -s * s * (1 - s), d01 = 6 * s * (1 - s), d10 = (1 - s) * (1 - 3 * s),
           d11 = s * (3 * s - 2);
    spari_quat_conj(a + 3, c);
    spari_quat_mul(b + 3, c, p);
    spari_quat_log(p, psi1);
    spari_tangent_inverse(psi1, t);
    for (int k = 0; k < 3; k++) {
        rate1[k] = t[3 * k] * b[10] + t[3 * k + 1] * b[11] + t[3 * k + 2] * b[12];
    }
    for (int k = 0; k < 3; k++) {
        out[k] = h00 * a[k] + h01 * b[k] + dt * (h10 * a[7 + k] + h11 * b[7 + k]);
        out[7 + k] = d01 * (b[k] - a[k]) / dt + d10 * a[7 + k] + d11 * b[7 + k];
        psi[k] = h01 * psi1[k] + dt * (h10 * a[10 + k] + h11 * rate1[k]);
        rate[k] = d01 * psi1[k] / dt + d10 * a[10 + k] + d11 * rate1[k];
    }
    spari_quat_exp(psi, p);
    spari_quat_mul(p, a + 3, out + 3);
    spari_tangent(psi, t);
    for (int k = 0; k < 3; k++) {
        out[10 + k] = t[3 * k] * rate[0] + t[3 * k + 1] * rate[1] + t[3 * k + 2] * rate[2];
    }
    for (int k = 13; k < 19; k++) {
        out[k] = (1 - s) * a[k] + s * b[k];
    }
}
