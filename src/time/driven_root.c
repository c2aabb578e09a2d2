/* The motion of a driven root within a step, and its jumps. */
#include "driven_root.h"

#include "../math/rotation.h"

spari_pose spari_drive_at(const spar_member *member, double s, double dt) {
    return spari_drive_between(&member->drive[0], &member->drive[1], s, dt);
}

/* Cubic Hermite in u and in the rotation vector from t^n, whose rate is T^-1 omega. */
spari_pose spari_drive_between(const spari_pose *a, const spari_pose *b, double s, double dt) {
    if (s <= 0 || s >= 1) { /* the initial accelerations have no dt */
        return s <= 0 ? *a : *b;
    }
    double h00 = 1 - s * s * (3 - 2 * s), h01 = s * s * (3 - 2 * s), h10 = s * (1 - s) * (1 - s),
           h11 = -s * s * (1 - s), d01 = 6 * s * (1 - s), d10 = (1 - s) * (1 - 3 * s), d11 = s * (3 * s - 2);
    double p[4], psi1[3], t[9], rate1[3], psi[3], rate[3];
    spari_pose out;
    spari_quat_between(a->q + 3, b->q + 3, p);
    spari_quat_log(p, psi1);
    spari_tangent_inverse(psi1, t);
    for (int k = 0; k < 3; k++) {
        rate1[k] = t[3 * k] * b->v[3] + t[3 * k + 1] * b->v[4] + t[3 * k + 2] * b->v[5];
    }
    for (int k = 0; k < 3; k++) {
        out.q[k] = h00 * a->q[k] + h01 * b->q[k] + dt * (h10 * a->v[k] + h11 * b->v[k]);
        out.v[k] = d01 * (b->q[k] - a->q[k]) / dt + d10 * a->v[k] + d11 * b->v[k];
        psi[k] = h01 * psi1[k] + dt * (h10 * a->v[3 + k] + h11 * rate1[k]);
        rate[k] = d01 * psi1[k] / dt + d10 * a->v[3 + k] + d11 * rate1[k];
    }
    spari_quat_exp(psi, p);
    spari_quat_mul(p, a->q + 3, out.q + 3);
    spari_tangent(psi, t);
    for (int k = 0; k < 3; k++) {
        out.v[3 + k] = t[3 * k] * rate[0] + t[3 * k + 1] * rate[1] + t[3 * k + 2] * rate[2];
    }
    for (int k = 0; k < 6; k++) {
        out.a[k] = (1 - s) * a->a[k] + s * b->a[k];
    }
    return out;
}

/* Integrates back from the end with an acceleration that is linear in time. */
spari_pose spari_drive_stage(const spari_pose *from, const spari_pose *to, double h, double span) {
    double r = h - span, f = span / h, way[6], rotation[4];
    spari_pose out;
    for (int k = 0; k < 6; k++) {
        out.a[k] = (1 - f) * from->a[k] + f * to->a[k];
        out.v[k] = to->v[k] - 0.5 * r * (out.a[k] + to->a[k]);
        way[k] = -r * (to->v[k] - r * (to->a[k] / 3 + out.a[k] / 6));
    }
    for (int k = 0; k < 3; k++) {
        out.q[k] = to->q[k] + way[k];
    }
    spari_quat_exp(way + 3, rotation);
    spari_quat_mul(rotation, to->q + 3, out.q + 3);
    return out;
}

void spari_drive_jump(const spari_pose *from, const spari_pose *to, double h, double velocity[6], double position[6]) {
    double rotation[4];
    for (int k = 0; k < 3; k++) {
        position[k] = to->q[k] - from->q[k];
    }
    spari_quat_between(from->q + 3, to->q + 3, rotation);
    spari_quat_log(rotation, position + 3);
    for (int k = 0; k < 6; k++) {
        const double *v = from->v, *a = from->a, *b = to->a;
        velocity[k] = to->v[k] - v[k] - 0.5 * h * (a[k] + b[k]);
        position[k] -= h * (v[k] + velocity[k] + h * (a[k] / 3 + b[k] / 6));
    }
    for (int k = 0; k < 6; k += 3) {
        spari_rotate_back(to->q + 3, velocity + k, velocity + k);
        spari_rotate_back(to->q + 3, position + k, position + k);
    }
}
