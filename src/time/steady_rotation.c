/* Equilibrium in a frame that rotates steadily with the root: rates, forces, tangent. */
#include "steady_rotation.h"

#include "../math/rotation.h"
#include "../member/body.h"

#include <string.h>

int spari_steady_rotation_of(const spar_member *m, const double v[6], const double a[6],
                             spari_steady_rotation *rotation) {
    memcpy(rotation->v0, v, sizeof rotation->v0);
    memcpy(rotation->w, v + 3, sizeof rotation->w);
    memcpy(rotation->a0, a, sizeof rotation->a0);
    int inertia = m->body->mass && (m->effects & SPAR_EFFECT_INERTIA);
    return inertia && (spari_norm(rotation->w) > 0 || spari_norm(rotation->a0) > 0);
}

spari_steady_rotation spari_steady_rotation_part(const spari_steady_rotation *rotation, double f) {
    spari_steady_rotation part = *rotation;
    for (int i = 0; i < 3; i++) {
        part.w[i] *= sqrt(f);
        part.v0[i] *= sqrt(f);
        part.a0[i] *= f;
    }
    return part;
}

void spari_rotating_frame_rates(const spari_rotating_frame *t, double f, const double x[3], double v[6], double a[6]) {
    const spari_steady_rotation part = spari_steady_rotation_part(&t->rotation, f);
    const double r[3] = {x[0] - t->centre[0], x[1] - t->centre[1], x[2] - t->centre[2]};
    spari_cross(part.w, r, v);
    spari_cross(part.w, v, a);
    for (int k = 0; k < 3; k++) {
        v[k] += part.v0[k];
        a[k] += part.a0[k];
        v[3 + k] = part.w[k];
        a[3 + k] = 0;
    }
}

int spari_rotating_frame_of(const spar_member *m, const spari_motion *at, spari_rotating_frame *frame) {
    for (int k = 0; k < 3; k++) {
        frame->centre[k] = m->xr[k] + at->q[k];
    }
    return spari_steady_rotation_of(m, at->v, at->a, &frame->rotation);
}

void spari_rotating_frame_nodes(const spari_rotating_frame *frame, double f, const spar_member *m, int n,
                                const double *q, double *v, double *a) {
    for (int i = 0; i < n; i++) {
        double x[3];
        spari_member_arm(m, i, x);
        for (int k = 0; k < 3; k++) {
            x[k] += m->xr[k] + q[7 * i + k];
        }
        spari_rotating_frame_rates(frame, f, x, v + 6 * i, a + 6 * i);
    }
}

double spari_steady_rotation_residual(const spari_body *damped, const double *q, const double *v, const double *a,
                                      double factor, double *r) {
    spari_body body = *damped;
    body.D = NULL;
    body.mass_damping = 0;
    return spari_body_residual(&body, q, v, a, factor, r, NULL);
}

void spari_steady_rotation_tangent(const spari_body *damped, const spari_steady_rotation *rotation, int e,
                                   const double *q, const double *v, const double *a, double factor, double *S,
                                   double *M) {
    int n = 6 * damped->per_element;
    spari_body body = *damped;
    body.D = NULL;
    body.mass_damping = 0;
    spari_body_tangent(&body, e, q, rotation ? v : NULL, rotation ? a : NULL, factor, 0, 0, NULL, S);
    spari_body_rates(&body, e, q, rotation ? v : NULL, rotation ? a : NULL, factor, S, NULL, M);
    if (!rotation) {
        return;
    }
    const double *w = rotation->w;
    double ww[3][3], square = spari_dot(w, w);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            ww[i][j] = w[i] * w[j] - (i == j ? square : 0);
        }
    }
    for (int i = 0; i < n; i++) {
        for (int l = 0; l < n; l += 6) {
            double *s = S + (int64_t)i * n + l, *x = M + (int64_t)i * n + l;
            for (int j = 0; j < 3; j++) {
                s[j] += x[0] * ww[0][j] + x[1] * ww[1][j] + x[2] * ww[2][j];
            }
        }
    }
}

/* to [n][n] += X T, X [n][n], with the same 3 x 3 block T for the vector of each node that begins at `from` */
static void add_by_blocks(int n, const double *X, int from, double T[3][3], double *to) {
    for (int i = 0; i < n; i++) {
        for (int l = from; l < n; l += 6) {
            const double *x = X + (int64_t)i * n + l;
            double *y = to + (int64_t)i * n + l;
            for (int j = 0; j < 3; j++) {
                y[j] += x[0] * T[0][j] + x[1] * T[1][j] + x[2] * T[2][j];
            }
        }
    }
}

void spari_steady_rotation_pencil(const spari_body *body, const double w[3], const double own[3], int e,
                                  const double *q, const double *v, const double *a, double *K, double *C, double *M) {
    int n = 6 * body->per_element;
    spari_body_tangent(body, e, q, v, a, 1, 0, 0, NULL, K);
    spari_body_rates(body, e, q, v, a, 1, K, C, M);
    if (!v) {
        return;
    }
    /* dv = x' + w x and x' - s x, da = x'' + 2 w x' + w w x and x'' + (w - s) x' - w s x, of positions and rotations */
    double W[3][3], S[3][3], WW[3][3], WS[3][3], two[3][3], less[3][3], back[3][3];
    double s[3] = {own[0] - w[0], own[1] - w[1], own[2] - w[2]};
    spari_skew(w, *W);
    spari_skew(s, *S);
    for (int i = 0; i < 9; i++) {
        int r = i / 3, c = i % 3;
        WW[r][c] = W[r][0] * W[0][c] + W[r][1] * W[1][c] + W[r][2] * W[2][c];
        WS[r][c] = -(W[r][0] * S[0][c] + W[r][1] * S[1][c] + W[r][2] * S[2][c]);
        two[r][c] = 2 * W[r][c];
        less[r][c] = W[r][c] - S[r][c];
        back[r][c] = -S[r][c];
    }
    if (body->mass_damping > 0 && body->node_position) { /* mass-proportional damping acts relative to the frame */
        double still[3][3];
        for (int i = 0; i < 9; i++) {
            still[i / 3][i % 3] = -body->mass_damping * W[i / 3][i % 3];
        }
        add_by_blocks(n, M, 0, still, K);
    }
    add_by_blocks(n, C, 0, W, K);
    add_by_blocks(n, C, 3, back, K);
    add_by_blocks(n, M, 0, WW, K);
    add_by_blocks(n, M, 3, WS, K);
    add_by_blocks(n, M, 0, two, C);
    add_by_blocks(n, M, 3, less, C);
}
