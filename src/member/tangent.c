/* The exact tangent of a body: docs/theory.md, "The beam". */
#include "../base/blas.h"
#include "../math/basis.h"
#include "linear_body.h"
#include "point.h"

#include <gsl/gsl_cblas.h>

/* c (3 x 4 at row stride `stride`) += f * a (3 x 3) * l (3 x 4) */
static void add_product(double *c, int stride, double f, const double *a, const double *l) {
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 4; j++) {
            c[stride * i + j] += f * (a[3 * i] * l[j] + a[3 * i + 1] * l[4 + j] + a[3 * i + 2] * l[8 + j]);
        }
    }
}

/* c (4 x 4) += f * l^T (4 x 3) * m (3 x 4) */
static void add_transposed_product(double *c, int stride, double f, const double *l, const double *m) {
    for (int i = 0; i < 4; i++) {
        for (int j = 0; j < 4; j++) {
            c[stride * i + j] += f * (l[i] * m[j] + l[4 + i] * m[4 + j] + l[8 + i] * m[8 + j]);
        }
    }
}

/* c := f a b, 3 x 3 each */
static void multiply3(double f, const double *a, const double *b, double *c) {
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            c[3 * i + j] = f * (a[3 * i] * b[j] + a[3 * i + 1] * b[3 + j] + a[3 * i + 2] * b[6 + j]);
        }
    }
}

/* matrix of x -> x s (right product with a pure quaternion) */
static void right_matrix(const double s[3], double m[4][4]) {
    double r[4][4] = {{0, -s[0], -s[1], -s[2]}, {s[0], 0, s[2], -s[1]}, {s[1], -s[2], 0, s[0]}, {s[2], s[1], -s[0], 0}};
    memcpy(m, r, sizeof r);
}

/* matrix of x -> t x */
static void left_matrix(const double t[3], double m[4][4]) {
    double l[4][4] = {{0, -t[0], -t[1], -t[2]}, {t[0], 0, -t[2], t[1]}, {t[1], t[2], 0, -t[0]}, {t[2], -t[1], t[0], 0}};
    memcpy(m, l, sizeof l);
}

/* Point matrices over the fields y = (u, Q | u', Q'), 14 x 14: K for displacements, B for rates; M over (u, Q), 7 x 7.
 */
typedef struct point_matrices {
    double K[14 * 14], B[14 * 14], M[7 * 7];
} point_matrices;

enum { AT_Q = 3, AT_DU = 7, AT_DQ = 10 };

/* J = d e / d y (6 x 14) */
static void strain_gradient(const point_one *s, double J[6][14]) {
    double L[3][4], Lp[3][4], Tx[3][3], R[9];
    memset(J, 0, sizeof(double) * 6 * 14);
    body_spin(s->r, *L);
    body_spin(s->p, *Lp);
    spari_skew(s->T, *Tx);
    spari_quat_matrix(s->r, R);
    add_product(&J[0][AT_Q], 14, 2 / s->N, *Tx, *L);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            J[i][AT_DU + j] = R[3 * j + i];
        }
        for (int j = 0; j < 4; j++) {
            J[3 + i][AT_Q + j] = (-2 * Lp[i][j] - 2 * s->e[3 + i] * s->r[j]) / s->N;
            J[3 + i][AT_DQ + j] = 2 * L[i][j] / s->N;
        }
    }
}

/* G = d (e-dot) / d y at fixed rates (6 x 14) */
static void strain_rate_gradient(const point_one *s, const double J[6][14], double G[6][14]) {
    double L[3][4], Ld[3][4], Lz[3][4], Tx[3][3], Wx[3][3], tx[3][3];
    memset(G, 0, sizeof(double) * 6 * 14);
    body_spin(s->r, *L);
    body_spin(s->d, *Ld);
    body_spin(s->z, *Lz);
    spari_skew(s->T, *Tx);
    spari_skew(s->omega, *Wx);
    spari_skew(s->t_rate, *tx);
    /* d(R^T u'-dot) = t_rate x dtheta; dT x W = -W x dT; T x dW with dW = (-2 Ld - 2 W r^T)/N dQ */
    add_product(&G[0][AT_Q], 14, 2 / s->N, *tx, *L);
    double dW[3][4];
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 4; j++) {
            dW[i][j] = (-2 * Ld[i][j] - 2 * s->omega[i] * s->r[j]) / s->N;
        }
    }
    add_product(&G[0][AT_Q], 14, 1, *Tx, *dW);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 14; j++) {
            G[i][j] -= Wx[i][0] * J[0][j] + Wx[i][1] * J[1][j] + Wx[i][2] * J[2][j];
        }
    }
    for (int i = 0; i < 3; i++) {
        double kappa = s->e[3 + i];
        for (int j = 0; j < 4; j++) {
            G[3 + i][AT_Q + j] = (-2 * Lz[i][j] - 2 * s->kd0[i] * s->r[j]) / s->N - 2 * s->b * J[3 + i][AT_Q + j] -
                                 2 * kappa * (s->d[j] - 2 * s->b * s->r[j]) / s->N;
            G[3 + i][AT_DQ + j] = 2 * Ld[i][j] / s->N - 2 * s->b * J[3 + i][AT_DQ + j];
        }
    }
}

/* Second derivative of s . e(y) at fixed s, added to K. */
static void add_geometric(const point_one *s, double w, double *K) {
    double L[3][4], Sx[3][3], R[9], RS[3][3], mixed[3][4] = {{0}};
    double in = 1 / s->N, in2 = in * in;
    body_spin(s->r, *L);
    spari_skew(s->s, *Sx);
    spari_quat_matrix(s->r, R);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            RS[i][j] = R[3 * i] * Sx[0][j] + R[3 * i + 1] * Sx[1][j] + R[3 * i + 2] * Sx[2][j];
        }
    }
    add_product(&mixed[0][0], 4, -2 * in, *RS, *L);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 4; j++) {
            K[14 * (AT_DU + i) + AT_Q + j] += w * mixed[i][j];
            K[14 * (AT_Q + j) + AT_DU + i] += w * mixed[i][j];
        }
    }
    double Rk[4][4], Rn[4][4], Lt[4][4], t[3], rk[4], pk[4], trs[4], tr[4], grad[4];
    spari_rotate(s->r, s->T, t);
    right_matrix(s->s + 3, Rk);
    right_matrix(s->s, Rn);
    left_matrix(t, Lt);
    quat_vec(s->r, s->s + 3, rk);
    quat_vec(s->p, s->s + 3, pk);
    double pure[4] = {0, t[0], t[1], t[2]};
    spari_quat_mul(pure, s->r, tr);
    quat_vec(tr, s->s, trs);
    double F = spari_dot(s->s, s->T) + spari_dot(s->s + 3, s->e + 3);
    for (int i = 0; i < 4; i++) {
        grad[i] = -2 * trs[i] - 2 * pk[i];
    }
    for (int i = 0; i < 4; i++) {
        for (int j = 0; j < 4; j++) {
            double slope = in2 * (2 * Rk[i][j] - 4 * rk[i] * s->r[j]); /* d2/dQ'_i dQ_j */
            double twice = 0;                                          /* B = -Rn Lt */
            for (int k = 0; k < 4; k++) {
                twice -= 2 * Rn[i][k] * Lt[k][j];
            }
            twice += -2 * (grad[i] * s->r[j] + s->r[i] * grad[j]) + 8 * F * s->r[i] * s->r[j] - (i == j ? 2 * F : 0);
            K[14 * (AT_DQ + i) + AT_Q + j] += w * slope;
            K[14 * (AT_Q + j) + AT_DQ + i] += w * slope;
            K[14 * (AT_Q + i) + AT_Q + j] += w * in2 * twice;
        }
    }
}

/* out (14 x 14) += w J^T C G */
static void add_congruence(double w, const double J[6][14], const double *C, const double G[6][14], double *out) {
    double CG[6][14];
    for (int i = 0; i < 6; i++) {
        for (int j = 0; j < 14; j++) {
            double sum = 0;
            for (int k = 0; k < 6; k++) {
                sum += C[6 * i + k] * G[k][j];
            }
            CG[i][j] = w * sum;
        }
    }
    for (int i = 0; i < 14; i++) {
        for (int k = 0; k < 6; k++) {
            double x = J[k][i];
            if (x != 0) {
                for (int j = 0; j < 14; j++) {
                    out[14 * i + j] += x * CG[k][j];
                }
            }
        }
    }
}

static void add_elastic(const spari_body *body, int64_t slot, int moving, double w, const point_one *s,
                        point_matrices *m) {
    double J[6][14], C[36];
    strain_gradient(s, J);
    spari_slot_get(body->C, 36, slot, C);
    add_congruence(w, (const double(*)[14])J, C, (const double(*)[14])J, m->K);
    add_geometric(s, w, m->K);
    if (body->D) {
        spari_slot_get(body->D, 36, slot, C);
        add_congruence(w, (const double(*)[14])J, C, (const double(*)[14])J, m->B);
        if (moving) {
            double G[6][14];
            strain_rate_gradient(s, (const double(*)[14])J, G);
            add_congruence(w, (const double(*)[14])J, C, (const double(*)[14])G, m->K);
        }
    }
}

/* K of the rows g_Q = 2 Q mb / N^2 of a moment mb in body axes that changes by mQ dQ. */
static void add_moment_rows(double w, const point_one *s, const double *L, const double *mQ, const double mb[3],
                            double *K) {
    double Rm[4][4], rm[4], in = 1 / s->N;
    add_transposed_product(&K[14 * AT_Q + AT_Q], 14, 2 * w * in, L, mQ);
    right_matrix(mb, Rm);
    quat_vec(s->r, mb, rm);
    for (int i = 0; i < 4; i++) {
        for (int j = 0; j < 4; j++) {
            K[14 * (AT_Q + i) + AT_Q + j] += w * in * in * (2 * Rm[i][j] - 4 * rm[i] * s->r[j]);
        }
    }
}

/* How the body rate W = 2 Im(Q* Qd)/N^2 and its rate A = 2 Im(Q* Qdd)/N^2 - 2 (Q.Qd) W/N^2 follow the fields, 3 x 4
   each; by the highest rate of Q both are 2 L/N. */
typedef struct spin_gradient {
    double L[12], rate_by_q[12], acceleration_by_q[12], acceleration_by_qd[12];
} spin_gradient;

static void differentiate_spin(const point_one *s, const point_inertia_one *n, spin_gradient *by) {
    double Ld[12], Ldd[12], rdd[4], in = 1 / s->N;
    for (int i = 0; i < 4; i++) {
        rdd[i] = s->f[SPARI_LANES * (QDD + i)] * in;
    }
    body_spin(s->r, by->L);
    body_spin(s->d, Ld);
    body_spin(rdd, Ldd);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 4; j++) {
            int at = 4 * i + j;
            by->rate_by_q[at] = (-2 * Ld[at] - 2 * s->omega[i] * s->r[j]) * in;
            by->acceleration_by_qd[at] = -2 * s->omega[i] * s->r[j] * in - 4 * s->b * by->L[at] * in;
            by->acceleration_by_q[at] = (-2 * Ldd[at] - 2 * n->A0[i] * s->r[j]) * in -
                                        2 * s->omega[i] * (s->d[j] - 2 * s->b * s->r[j]) * in -
                                        2 * s->b * by->rate_by_q[at];
        }
    }
}

/* How the force of inertia (global axes) and its moment (body axes) follow Q and its rates, 3 x 4 each; and what that
   takes of the section: R, mc~ and J, 3 x 3. */
typedef struct inertia_gradient {
    double force_by_q[12], force_by_qd[12], force_by_qdd[12];
    double moment_by_q[12], moment_by_qd[12], moment_by_qdd[12];
    double R[9], offset[9], J[9];
} inertia_gradient;

/* R (W x (W x mc)) and W x J W, through W. */
static void add_gyroscopic(const point_one *s, const point_inertia_one *n, const spin_gradient *by,
                           inertia_gradient *g) {
    double W[9], JW[9], Wc[9], W_J[9], W_c[9], moment_by_rate[9], own_by_rate[9], force_by_rate[9], in = 1 / s->N;
    spari_skew(s->omega, W);
    spari_skew(n->JW, JW);
    spari_skew(n->Wc, Wc);
    multiply3(1, W, g->J, W_J);
    multiply3(1, W, g->offset, W_c);
    for (int i = 0; i < 9; i++) {
        moment_by_rate[i] = W_J[i] - JW[i];
        own_by_rate[i] = -Wc[i] - W_c[i];
    }
    multiply3(1, g->R, own_by_rate, force_by_rate);
    add_product(g->force_by_qd, 4, 2 * in, force_by_rate, by->L);
    add_product(g->force_by_q, 4, 1, force_by_rate, by->rate_by_q);
    add_product(g->moment_by_qd, 4, 2 * in, moment_by_rate, by->L);
    add_product(g->moment_by_q, 4, 1, moment_by_rate, by->rate_by_q);
}

/* R (A x mc) and J A, through A; and what turns with the section: R y, and mc x h as h = R^T (udd - g) does. */
static void add_accelerated(const point_one *s, const point_inertia_one *n, const spin_gradient *by,
                            inertia_gradient *g) {
    double h[9], y[9], force_by_acceleration[9], force_by_turn[9], moment_by_turn[9], in = 1 / s->N;
    spari_skew(n->h, h);
    spari_skew(n->y, y);
    multiply3(-1, g->R, g->offset, force_by_acceleration);
    multiply3(-1, g->R, y, force_by_turn);
    multiply3(1, g->offset, h, moment_by_turn);
    add_product(g->force_by_qdd, 4, 2 * in, force_by_acceleration, by->L);
    add_product(g->force_by_qd, 4, 1, force_by_acceleration, by->acceleration_by_qd);
    add_product(g->force_by_q, 4, 1, force_by_acceleration, by->acceleration_by_q);
    add_product(g->force_by_q, 4, 2 * in, force_by_turn, by->L);
    add_product(g->moment_by_qdd, 4, 2 * in, g->J, by->L);
    add_product(g->moment_by_qd, 4, 1, g->J, by->acceleration_by_qd);
    add_product(g->moment_by_q, 4, 1, g->J, by->acceleration_by_q);
    add_product(g->moment_by_q, 4, 2 * in, moment_by_turn, by->L);
}

/* Rows u: the force itself. */
static void add_force_rows(double w, double mass, const inertia_gradient *g, point_matrices *m) {
    for (int i = 0; i < 3; i++) {
        m->M[7 * i + i] += w * mass;
        for (int j = 0; j < 4; j++) {
            m->M[7 * i + 3 + j] += w * g->force_by_qdd[4 * i + j];
            m->B[14 * i + AT_Q + j] += w * g->force_by_qd[4 * i + j];
            m->K[14 * i + AT_Q + j] += w * g->force_by_q[4 * i + j];
        }
    }
}

/* Rows Q: g_Q = 2 Q mb/N^2 changes with mb through 2 L^T/N, by udd through mc x R^T, and with Q itself. */
static void add_rotary_rows(double w, const point_one *s, const double *mb, const double *L, const inertia_gradient *g,
                            point_matrices *m) {
    double back[9], moment_by_udd[9], in = 1 / s->N;
    for (int i = 0; i < 9; i++) {
        back[i] = g->R[3 * (i % 3) + i / 3];
    }
    multiply3(1, g->offset, back, moment_by_udd);
    for (int i = 0; i < 4; i++) {
        for (int j = 0; j < 3; j++) {
            double x = L[i] * moment_by_udd[j] + L[4 + i] * moment_by_udd[3 + j] + L[8 + i] * moment_by_udd[6 + j];
            m->M[7 * (3 + i) + j] += w * (2 * in * x);
        }
    }
    add_transposed_product(&m->M[7 * 3 + 3], 7, 2 * w * in, L, g->moment_by_qdd);
    add_transposed_product(&m->B[14 * AT_Q + AT_Q], 14, 2 * w * in, L, g->moment_by_qd);
    add_moment_rows(w, s, L, g->moment_by_q, mb, m->K);
}

/* Inertia: rows u and Q, against (u, Q) for accelerations (M), rates (B) and displacements (K). */
static void add_inertia(const spari_body *body, int64_t slot, double w, const point_one *s, const point_inertia_one *n,
                        point_matrices *m) {
    double mass[10];
    const double *J = mass + 4;
    spin_gradient by;
    spari_slot_get(body->mass, 10, slot, mass);
    inertia_gradient g = {.J = {J[0], J[1], J[2], J[1], J[3], J[4], J[2], J[4], J[5]}};
    spari_quat_matrix(s->r, g.R);
    spari_skew(mass + 1, g.offset);
    differentiate_spin(s, n, &by);
    if (body->gyroscopic) {
        add_gyroscopic(s, n, &by, &g);
    }
    add_accelerated(s, n, &by, &g);
    add_force_rows(w, mass[0], &g, m);
    add_rotary_rows(w, s, n->mb, by.L, &g, m);
}

/* The weight alone: its moment about the node turns with the section. */
static void add_weight(const spari_body *body, int64_t slot, double w, const point_one *s, const point_inertia_one *n,
                       point_matrices *m) {
    double L[3][4], cx[3][3], hx[3][3], ch[3][3], mQ[3][4] = {{0}}, mass[10];
    body_spin(s->r, *L);
    spari_slot_get(body->mass, 10, slot, mass);
    spari_skew(mass + 1, *cx);
    spari_skew(n->h, *hx);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            ch[i][j] = cx[i][0] * hx[0][j] + cx[i][1] * hx[1][j] + cx[i][2] * hx[2][j];
        }
    }
    add_product(&mQ[0][0], 4, 2 / s->N, *ch, *L);
    add_moment_rows(w, s, *L, *mQ, n->mb, m->K);
}

/* Nodal maps: dq = E dtheta, d(qd) = F dtheta, d(qdd) = H dtheta (4 x 3 each), with dw = cv Tinv dtheta, dalpha = cm
 * Tinv dtheta. */
static void node_maps(const double *zn, const double *v, const double *a, double cm, double cv, const double *tinv,
                      double E[4][3], double F[4][3], double H[4][3]) {
    static const double identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    const double *t = tinv ? tinv : identity;
    double w[4] = {0}, al[4] = {0};
    for (int i = 0; i < 3; i++) {
        w[1 + i] = v ? 0.5 * v[3 + i] : 0;
        al[1 + i] = a ? 0.5 * a[3 + i] : 0;
    }
    for (int j = 0; j < 3; j++) {
        double th[4] = {0, 0, 0, 0}, dw[4] = {0}, da[4] = {0}, q1[4], q2[4], q3[4], q4[4], q5[4], q6[4];
        th[1 + j] = 0.5;
        for (int i = 0; i < 3; i++) {
            dw[1 + i] = 0.5 * cv * t[3 * i + j];
            da[1 + i] = 0.5 * cm * t[3 * i + j];
        }
        spari_quat_mul(th, zn + Q, q1);
        spari_quat_mul(dw, zn + Q, q2);
        spari_quat_mul(w, q1, q3);
        spari_quat_mul(da, zn + Q, q4);
        spari_quat_mul(al, q1, q5);
        spari_quat_mul(dw, zn + QD, q6);
        double qd[4], w_qd[4];
        for (int i = 0; i < 4; i++) {
            qd[i] = q2[i] + q3[i];
        }
        spari_quat_mul(w, qd, w_qd);
        for (int i = 0; i < 4; i++) {
            E[i][j] = q1[i];
            F[i][j] = qd[i];
            H[i][j] = q4[i] + q5[i] + q6[i] + w_qd[i];
        }
    }
}

/* S_ij (6 x 6 at row stride `stride`) += E_i^T X E_j for one of K, B, M; X is 7 x 7; the translational factor of column
 * j is `cu`. */
static void project_block(const double *X, double Ei[4][3], double Ej[4][3], double cu, double *S, int64_t stride) {
    double XE[7][6];
    for (int i = 0; i < 7; i++) {
        for (int j = 0; j < 3; j++) {
            XE[i][j] = cu * X[7 * i + j];
            XE[i][3 + j] =
                X[7 * i + 3] * Ej[0][j] + X[7 * i + 4] * Ej[1][j] + X[7 * i + 5] * Ej[2][j] + X[7 * i + 6] * Ej[3][j];
        }
    }
    for (int j = 0; j < 6; j++) {
        for (int i = 0; i < 3; i++) {
            S[stride * i + j] += XE[i][j];
            S[stride * (3 + i) + j] +=
                Ei[0][i] * XE[3][j] + Ei[1][i] * XE[4][j] + Ei[2][i] * XE[5][j] + Ei[3][i] * XE[6][j];
        }
    }
}

/* The element's nodal 7 x 7 blocks [i][j] of a sum over points: phi_i phi_j A00 + phi_i phi'_j A01 + phi'_i phi_j A10 +
   phi'_i phi'_j A11, in two stages: over j at each point, then over points by one matrix product. */
static void first_stage(int P, const double *phi, const double *dphi, const double *A, int slopes, double *x0,
                        double *x1) {
    for (int j = 0; j < P; j++) {
        double f = phi[j], d = slopes ? dphi[j] : 0;
        for (int i = 0; i < 7; i++) {
            for (int c = 0; c < 7; c++) {
                x0[49 * j + 7 * i + c] = f * A[14 * i + c] + d * A[14 * i + 7 + c];
                if (slopes) {
                    x1[49 * j + 7 * i + c] = f * A[14 * (7 + i) + c] + d * A[14 * (7 + i) + 7 + c];
                }
            }
        }
    }
}

/* One element's tangent on its way: fields at nodes and points; the nodes' 7 x 7 blocks of stiffness, rates and mass,
   and their first stages, all in the body's scratch; g[P][4], the forces on Q. */
typedef struct element_tangent {
    int P, first, points; /* nodes, points */
    int64_t slot;         /* of the first point */
    int damped, masses, rates;
    int64_t row; /* doubles of the first stage of one point */
    double *z, *f, *K, *B, *M, *g, *first_K, *first_B, *first_M;
    double *table; /* [P][2 points] phi, then phi' */
} element_tangent;

static element_tangent begin_tangent(const spari_body *body, int e, int masses, int rates) {
    int P = body->per_element, first = body->first[e], n = body->first[e + 1] - first;
    int64_t pp = (int64_t)P * P * 49, row = (int64_t)P * 49;
    element_tangent t = {P, first, n, body->slot[e], body->D != NULL, masses, rates, .row = row, .z = body->scratch};
    t.f = t.z + (int64_t)P * ROW;
    t.K = SPARI_BLOCK(t.f, POINT_ROWS, body->slot[e + 1] - body->slot[e]);
    t.B = t.K + pp, t.M = t.B + pp, t.g = t.M + pp;
    t.first_K = t.g + pp, t.first_B = t.first_K + 2 * n * row;
    t.first_M = t.first_B + n * row; /* B has no slopes unless damped: its second half is then free for M */
    t.table = t.first_B + 2 * n * row;
    memset(t.g, 0, (size_t)P * 4 * sizeof *t.g);
    memset(t.M, 0, (size_t)pp * sizeof *t.M);
    return t;
}

/* The matrices of one point, and its forces on Q and Q' in value and slope, 4 each. */
static void differentiate_point(const spari_body *body, int64_t slot, const spari_regime *how, int masses,
                                const double *f, point_matrices *m, double *value, double *slope) {
    point_one s;
    double w = body->weight[slot], of_value[BACK] = {0}, of_slope[BACK] = {0};
    memset(m, 0, sizeof *m);
    fields_one(how->moving, f, &s);
    if (body->C) {
        strain_one(SPARI_BLOCK(body->tangent, 3, slot), SPARI_BLOCK(body->C, 36, slot),
                   how->damped ? SPARI_BLOCK(body->D, 36, slot) : NULL, &s);
        add_elastic(body, slot, how->moving, w, &s, m);
        elastic_forces_one(&s, of_value, of_slope);
    }
    if (masses || how->heavy) {
        point_inertia_one in;
        double m4[4];
        if (masses) {
            inertia_forces_one(SPARI_BLOCK(body->mass, 10, slot), body->gyroscopic, how, &s, &in);
            add_inertia(body, slot, w, &s, &in, m);
        } else {
            weight_forces_one(SPARI_BLOCK(body->mass, 10, slot), how, &s, &in);
            add_weight(body, slot, w, &s, &in, m);
        }
        quat_vec(s.r, in.mb, m4);
        for (int i = 0; i < 4; i++) {
            of_value[3 + i] += 2 * m4[i] / s.N;
        }
    }
    memcpy(value, of_value + 3, 4 * sizeof *value);
    memcpy(slope, of_slope + 3, 4 * sizeof *slope);
}

/* All fields that a tangent asks for; at rest what belongs to rates is 0. */
static void interpolate_all(const spari_body *body, int e, int moving, const element_tangent *t) {
    int wanted = body->C ? SPARI_SLOPES : 0;
    if (moving) {
        wanted |= SPARI_RATES | SPARI_ACCELERATIONS | (body->C && body->D ? SPARI_RATE_SLOPES : 0);
    } else {
        memset(t->f, 0, (size_t)(body->slot[e + 1] - body->slot[e]) * POINT_ROWS * sizeof *t->f);
    }
    spari_lanes_interpolate(body, e, wanted, t->z, t->f);
}

/* The mass of point k: by a first stage of its own, or, where damping takes up the room for it, at once. */
static void collect_mass(const element_tangent *t, int k, const double *phi, const double *dphi, const double *M) {
    if (!t->damped) {
        double M14[14 * 7] = {0}; /* first_stage multiplies what it does not need by 0 */
        for (int i = 0; i < 7; i++) {
            memcpy(M14 + 14 * i, M + 7 * i, 7 * sizeof *M14);
        }
        first_stage(t->P, phi, dphi, M14, 0, t->first_M + k * t->row, NULL);
        return;
    }
    for (int i = 0; i < t->P; i++) {
        for (int j = 0; j < t->P; j++) {
            double fij = phi[i] * phi[j], *to = t->M + ((int64_t)i * t->P + j) * 49;
            for (int c = 0; c < 49; c++) {
                to[c] += fij * M[c];
            }
        }
    }
}

/* Point k of the element into forces on Q, the table of phi and the first stages. */
static void collect_point(const spari_body *body, const element_tangent *t, int k, const spari_regime *how) {
    int P = t->P, n = t->points, at = t->first + k;
    int64_t slot = t->slot + k;
    const double *phi = body->phi + (int64_t)at * P, *dphi = body->dphi + (int64_t)at * P;
    double value[4], slope[4], w = body->weight[slot];
    point_matrices m;
    differentiate_point(body, slot, how, t->masses, SPARI_BLOCK(t->f, POINT_ROWS, k), &m, value, slope);
    for (int l = 0; l < P; l++) {
        for (int i = 0; i < 4; i++) {
            t->g[4 * l + i] += w * (phi[l] * value[i] + dphi[l] * slope[i]);
        }
        t->table[2 * n * l + k] = phi[l];
        t->table[2 * n * l + n + k] = dphi[l];
    }
    first_stage(P, phi, dphi, m.K, 1, t->first_K + k * t->row, t->first_K + (n + k) * t->row);
    if (t->rates) {
        first_stage(P, phi, dphi, m.B, t->damped, t->first_B + k * t->row, t->first_B + (n + k) * t->row);
    }
    if (t->masses) {
        collect_mass(t, k, phi, dphi, m.M);
    }
}

/* Blocks := the second stage, over the first `rows` rows of the table. */
static void second_stage(const element_tangent *t, int rows, const double *first, double *blocks) {
    int cols = (int)t->row;
    SPARI_BLAS(cblas_dgemm(CblasRowMajor, CblasNoTrans, CblasNoTrans, t->P, cols, rows, 1, t->table, 2 * t->points,
                           first, cols, 0, blocks, cols));
}

/* The nodal moment 1/2 Im(g q*) of a constant g changes with q by -1/4 (s I + w~), (s, w) = g q*. */
static void add_turned_force(const double *g, const double *q, double *S, int64_t stride) {
    double c[4], p[4], w[3][3];
    spari_quat_conj(q, c);
    spari_quat_mul(g, c, p);
    spari_skew(p + 1, *w);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            S[stride * i + j] -= 0.25 * ((i == j ? p[0] : 0) + w[i][j]);
        }
    }
}

/* From the blocks over (u, Q) and its rates to the unknowns of the nodes, by their maps (4 x 3 each). */
static void project_blocks(const element_tangent *t, double cm, double cv, double E[][4][3], double F[][4][3],
                           double H[][4][3], double *S) {
    int64_t stride = 6 * t->P;
    memset(S, 0, (size_t)(stride * stride) * sizeof *S);
    for (int i = 0; i < t->P; i++) {
        for (int j = 0; j < t->P; j++) {
            double *Sij = S + stride * 6 * i + 6 * j;
            int64_t at = ((int64_t)i * t->P + j) * 49;
            project_block(t->K + at, E[i], E[j], 1, Sij, stride);
            if (t->rates) {
                project_block(t->B + at, E[i], F[j], cv, Sij, stride);
            }
            if (t->masses) {
                project_block(t->M + at, E[i], H[j], cm, Sij, stride);
            }
        }
        add_turned_force(t->g + 4 * i, t->z + ROW * i + Q, S + stride * (6 * i + 3) + 6 * i + 3, stride);
    }
}

void spari_body_tangent(const spari_body *body, int e, const double *q, const double *v, const double *a, double factor,
                        double cm, double cv, const double *tinv, double *S) {
    if (body->linear[0]) {
        spari_linear_tangent(body, e, cm, cv, S);
        return;
    }
    const spari_regime how = spari_point_regime(body, v, a, factor);
    int masses = (cm != 0 || a) && body->mass, rates = (cv != 0 || v) && (body->D || masses);
    const element_tangent t = begin_tangent(body, e, masses, rates);
    spari_point_gather(body, e, q, v, a, t.z);
    interpolate_all(body, e, how.moving, &t);
    for (int k = 0; k < t.points; k++) {
        collect_point(body, &t, k, &how);
    }
    second_stage(&t, 2 * t.points, t.first_K, t.K);
    if (rates) {
        second_stage(&t, t.damped ? 2 * t.points : t.points, t.first_B, t.B);
    }
    if (masses && !t.damped) {
        second_stage(&t, t.points, t.first_M, t.M);
    }
    double E[SPARI_MAX_NODES][4][3], F[SPARI_MAX_NODES][4][3], H[SPARI_MAX_NODES][4][3];
    for (int l = 0; l < t.P; l++) {
        int64_t node = (int64_t)e * (t.P - 1) + l;
        node_maps(t.z + ROW * l, v ? v + 6 * node : NULL, a ? a + 6 * node : NULL, cm, cv,
                  tinv ? tinv + 9 * node : NULL, E[l], F[l], H[l]);
    }
    project_blocks(&t, cm, cv, E, F, H, S);
}

/* The tangent is linear in cm and cv. With a large one what is subtracted does not take digits: with 1 a stiff beam's
   mass would keep few. */
void spari_body_rates(const spari_body *body, int e, const double *q, const double *v, const double *a, double factor,
                      const double *S, double *C, double *M) {
    const double large = 0x1p60;
    double *out[2] = {C, M};
    for (int k = 0; k < 2; k++) {
        if (out[k]) {
            spari_body_tangent(body, e, q, v, a, factor, k == 1 ? large : 0, k == 0 ? large : 0, NULL, out[k]);
            for (int i = 0; i < 36 * body->per_element * body->per_element; i++) {
                out[k][i] = (out[k][i] - S[i]) / large;
            }
        }
    }
}
