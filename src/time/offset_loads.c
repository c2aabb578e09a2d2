/* Loads that act at an offset from the node of a rigid body. Their moment follows the rotation of the body. */
#include "offset_loads.h"

#include "../math/rotation.h"

void spari_offset_loads_at(spari_offset_loads *offset_loads, double s) {
    for (int i = 0; i < 9; i++) {
        offset_loads->Z[i] = (1 - s) * offset_loads->begin[i] + s * offset_loads->end[i];
    }
}

/* Y = R Z = sum (R rho) f^T */
static void rotate_sums(const spari_offset_loads *offset_loads, const double q[4], double Y[9]) {
    for (int j = 0; j < 3; j++) {
        double column[3] = {offset_loads->Z[j], offset_loads->Z[3 + j], offset_loads->Z[6 + j]};
        spari_rotate(q, column, column);
        for (int i = 0; i < 3; i++) {
            Y[3 * i + j] = column[i];
        }
    }
}

void spari_offset_loads_residual(const spari_offset_loads *offset_loads, const double q[4], double r[3]) {
    double Y[9];
    rotate_sums(offset_loads, q, Y);
    r[0] -= Y[5] - Y[7];
    r[1] -= Y[6] - Y[2];
    r[2] -= Y[1] - Y[3];
}

/* (dtheta x r) x f = r (f . dtheta) - (r . f) dtheta, summed: Y - tr(Y) */
void spari_offset_loads_tangent(const spari_offset_loads *offset_loads, const double q[4], double S[36]) {
    double Y[9];
    rotate_sums(offset_loads, q, Y);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            S[6 * (3 + i) + 3 + j] -= Y[3 * i + j] - (i == j ? Y[0] + Y[4] + Y[8] : 0);
        }
    }
}
