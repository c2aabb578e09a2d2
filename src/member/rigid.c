/* Discretises a rigid body: one node, one point with its mass. */
#include "beam.h"

#include "../algebra/eigen.h"
#include "../base/session.h"
#include "../math/rotation.h"

#include <string.h>

/* Momentum of a rigid section or body: m (v + w x c), J w + c x m v: M = [m I, -m c~; m c~, J]. */
const char *spari_mass_split(const double M[36], double *m, double c[3], double J[6]) {
    double size = 0, inertia = 0;
    for (int i = 0; i < 3; i++) {
        size = fmax(size, fabs(M[7 * i]));
        inertia = fmax(inertia, fabs(M[7 * (3 + i)]));
    }
    double coupling = sqrt(size * inertia), tol = 1e-6;
    for (int i = 0; i < 6; i++) {
        for (int j = 0; j < i; j++) {
            double scale = i < 3 ? size : j < 3 ? coupling : inertia;
            if (fabs(M[6 * i + j] - M[6 * j + i]) > tol * scale) {
                return "it is not symmetric";
            }
        }
    }
    *m = (M[0] + M[7] + M[14]) / 3;
    if (M[0] < 0 || M[7] < 0 || M[14] < 0) {
        return "its mass is negative";
    }
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            if (fabs(M[6 * i + j] - (i == j ? *m : 0)) > tol * size) {
                return "its upper left block is not m times the identity";
            }
            if (fabs(M[6 * (3 + i) + j] + M[6 * (3 + j) + i]) > tol * coupling) {
                return "its lower left block is not skew (m times the offset of the centre of mass)";
            }
        }
    }
    double mc[3] = {0.5 * (M[31] - M[26]), 0.5 * (M[20] - M[30]), 0.5 * (M[24] - M[19])};
    for (int i = 0; i < 3; i++) {
        if (*m == 0 && mc[i] != 0) {
            return "it has an offset but no mass";
        }
        c[i] = *m > 0 ? mc[i] / *m : 0;
    }
    J[0] = M[21], J[1] = M[22], J[2] = M[23], J[3] = M[28], J[4] = M[29], J[5] = M[35];
    /* the inertia about the centre of mass must not be negative: leading and trailing minors of J - m (c.c I - c
       c^T) */
    double cc = spari_dot(c, c), small = tol * inertia;
    double a = J[0] - *m * (cc - c[0] * c[0]), b = J[3] - *m * (cc - c[1] * c[1]), d = J[5] - *m * (cc - c[2] * c[2]);
    double f = J[1] + *m * c[0] * c[1], g = J[2] + *m * c[0] * c[2], h = J[4] + *m * c[1] * c[2];
    if (a < -small || b < -small || d < -small || a * b - f * f < -small * inertia ||
        a * d - g * g < -small * inertia || b * d - h * h < -small * inertia ||
        a * (b * d - h * h) - f * (f * d - g * h) + g * (f * h - g * b) < -small * inertia * inertia) {
        return "its rotary inertia about the centre of mass is negative";
    }
    return NULL;
}

int spari_inertia_is_impossible(const double M[36], double moment[3]) {
    /* A moment given to two digits is off by up to 5 %: a plate of 1.0, 1.0 and 2.1 passes. Moments left out are no
       contradiction: a hub known by its inertia about the shaft alone. */
    static const double digits = 0.05, left_out = 1e-6;
    double m, c[3], J[6], workspace[SPARI_SYMMETRIC_ROOM(3)];
    if (spari_mass_split(M, &m, c, J)) {
        return 0;
    }
    double cc = spari_dot(c, c), xx = J[0] - m * (cc - c[0] * c[0]), yy = J[3] - m * (cc - c[1] * c[1]),
           zz = J[5] - m * (cc - c[2] * c[2]), xy = J[1] + m * c[0] * c[1], xz = J[2] + m * c[0] * c[2],
           yz = J[4] + m * c[1] * c[2], about_centre[9] = {xx, xy, xz, xy, yy, yz, xz, yz, zz};
    const double largest = fmax(J[0], fmax(J[3], J[5])); /* about the node, as it was given */
    return spari_symmetric(3, about_centre, moment, workspace) == 0 && moment[1] > left_out * largest &&
           moment[2] - moment[1] - moment[0] > digits * largest;
}

void spari_mass_rotate(const double R[9], const double M[36], double out[10]) {
    double m, c[3], J[6], half[3][3], g[3][3];
    spari_mass_split(M, &m, c, J);
    double full[3][3] = {{J[0], J[1], J[2]}, {J[1], J[3], J[4]}, {J[2], J[4], J[5]}};
    for (int i = 0; i < 3; i++) {
        out[1 + i] = m * (R[3 * i] * c[0] + R[3 * i + 1] * c[1] + R[3 * i + 2] * c[2]);
        for (int j = 0; j < 3; j++) {
            half[i][j] = R[3 * i] * full[0][j] + R[3 * i + 1] * full[1][j] + R[3 * i + 2] * full[2][j];
        }
    }
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            g[i][j] = half[i][0] * R[3 * j] + half[i][1] * R[3 * j + 1] + half[i][2] * R[3 * j + 2];
        }
    }
    out[0] = m;
    out[4] = g[0][0], out[5] = g[0][1], out[6] = g[0][2], out[7] = g[1][1], out[8] = g[1][2], out[9] = g[2][2];
}

int spari_rigid_build(spar_member *member, spari_body **body) {
    double R[9], m[10];
    spari_body *b =
        spari_body_create(1, 1, (const int[]){1}, 0, 0, 1, &member->session->bodies, &member->session->pool);
    SPARI_REQUIRE(member->session, b, SPAR_ERR_MEMORY, "member '%s': no memory for the rigid body", member->name);
    b->phi[0] = b->weight[0] = 1;
    spari_quat_matrix(member->qr, R);
    spari_mass_rotate(R, member->mass, m);
    spari_slot_put(b->mass, 10, 0, m);
    spari_body_complete(b);
    memcpy(b->position, member->xr, 3 * sizeof *b->position);
    double gyration = m[0] > 0 ? sqrt((m[4] + m[7] + m[9]) / m[0]) : 0;
    b->length = gyration > 0 ? gyration : 1;
    *body = b;
    return SPAR_OK;
}
