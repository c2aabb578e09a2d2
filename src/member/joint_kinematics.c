/* Kinematics of a joint: see joint_kinematics.h. */
#include "joint_kinematics.h"

#include "../math/rotation.h"

#include <spar/spar_structure.h>
#include <string.h>

int spari_kinematics_free_axis(int free) {
    switch (free & (SPAR_FREE_RX | SPAR_FREE_RY | SPAR_FREE_RZ)) {
    case SPAR_FREE_RX:
        return 0;
    case SPAR_FREE_RY:
        return 1;
    case SPAR_FREE_RZ:
        return 2;
    default:
        return -1;
    }
}

enum { FREE_ROTATIONS = SPAR_FREE_RX | SPAR_FREE_RY | SPAR_FREE_RZ };

/* Constrained axis of a joint with two free rotations; otherwise -1. */
static int axis_without_rotation(int free) {
    switch (free & FREE_ROTATIONS) {
    case SPAR_FREE_RY | SPAR_FREE_RZ:
        return 0;
    case SPAR_FREE_RX | SPAR_FREE_RZ:
        return 1;
    case SPAR_FREE_RX | SPAR_FREE_RY:
        return 2;
    default:
        return -1;
    }
}

int spari_kinematics_angles(int free) {
    return (free & FREE_ROTATIONS) == FREE_ROTATIONS ? 0 : (free & FREE_ROTATIONS) / SPAR_FREE_RX;
}

/* One end of a joint. */
typedef struct joint_end {
    double arm[3], axes[4]; /* from the node, present configuration */
} joint_end;

static void carry_end(const spari_joint_kinematics *t, int side, const spari_node_pose *at, joint_end *e) {
    spari_rotate(at->q, t->arm[side], e->arm);
    spari_quat_mul(at->q, t->axes[side], e->axes);
}

/* rows of B: z-dot[k] = sum over sides of (force axis) . u-dot + (rotation axis) . omega */
static void set_row(double row[12], const double axis[3], const double turn_a[3], const double turn_b[3]) {
    for (int k = 0; k < 3; k++) {
        row[k] = axis[k];
        row[3 + k] = turn_a[k];
        row[6 + k] = -axis[k];
        row[9 + k] = -turn_b[k];
    }
}

/* Along `axis` (global), for the point at arm_a from a and at arm_b from b: axis . (omega x arm) = (arm x axis) .
   omega */
static void set_way(double row[12], const double axis[3], const double arm_a[3], const double arm_b[3]) {
    double turn_a[3], turn_b[3];
    spari_cross(arm_a, axis, turn_a);
    spari_cross(arm_b, axis, turn_b);
    set_row(row, axis, turn_a, turn_b);
}

/* Angle of (c[r], c[q]) and, in row[3], its change with a rotation phi of c in the axes of b: dc = phi x c. */
static double angle_of(const double c[3], int q, int r, double sign, double row[3]) {
    double size = c[q] * c[q] + c[r] * c[r];
    for (int m = 0; m < 3; m++) {
        double phi[3] = {0}, d[3];
        phi[m] = 1;
        spari_cross(phi, c, d);
        row[m] = sign * (c[q] * d[r] - c[r] * d[q]) / size;
    }
    return atan2(sign * c[r], c[q]);
}

/* The cross of a universal joint has two perpendicular arms: axis p of b and axis q of a; r is the third. r[4]
   rotates b's p by the first angle, then a's q by the second. */
static void universal(int without, const double rotation[4], double z[3], double D[9]) {
    int r = without, p = r == 0 ? 1 : 0, q = 3 - p - r;
    double sign = r == 1 ? -1 : 1, e[3] = {0}, f[3] = {0}, c[3], d[3], row[3];
    e[q] = f[p] = 1;
    spari_rotate(rotation, e, c);
    z[p] = angle_of(c, q, r, sign, D + 3 * p);
    z[r] = -sign * c[p]; /* dc = phi x c */
    spari_cross(c, f, D + 3 * r);
    for (int m = 0; m < 3; m++) {
        D[3 * r + m] *= -sign;
    }
    spari_rotate_back(rotation, f, d); /* b's p, in a's axes, rotates with -phi */
    z[q] = angle_of(d, p, r, sign, row);
    spari_rotate(rotation, row, D + 3 * q);
    for (int m = 0; m < 3; m++) {
        D[3 * q + m] = -D[3 * q + m];
    }
}

/* The three rotations z, and D[3][3]: their change with a small rotation phi of a relative to b, in b's axes. */
static void rotations(const spari_joint_kinematics *t, const double r[4], double z[3], double D[9]) {
    int i = spari_kinematics_free_axis(t->free), rotations_free = t->free & FREE_ROTATIONS,
        without = axis_without_rotation(t->free);
    double sign = r[0] < 0 ? -1 : 1;
    if (rotations_free == 0) { /* z = 2 r_v, dr_v = (r0 phi + phi x r_v) / 2 */
        for (int k = 0; k < 3; k++) {
            z[k] = 2 * sign * r[1 + k];
        }
        spari_skew(z, D);
        for (int k = 0; k < 9; k++) {
            D[k] = -0.5 * D[k] + (k % 4 == 0 ? sign * r[0] : 0);
        }
    } else if (i >=
               0) { /* c: a's axis i in b's axes, dc = phi x c; about j and k it deviates from b's by -c_k and c_j */
        int j = (i + 1) % 3, k = (i + 2) % 3;
        double e[3] = {0}, c[3], s2 = r[0] * r[0] + r[1 + i] * r[1 + i];
        e[i] = 1;
        spari_rotate(r, e, c);
        z[j] = -c[k], z[k] = c[j];
        z[i] = 2 * atan2(r[1 + i], r[0]);
        memset(D, 0, 9 * sizeof *D);
        D[3 * j + j] = c[i], D[3 * j + i] = -c[j]; /* -(phi x c)_k = -(phi_i c_j - phi_j c_i) */
        D[3 * k + k] = c[i], D[3 * k + i] = -c[k]; /* (phi x c)_j = phi_k c_i - phi_i c_k */
        for (int m = 0; m < 3; m++) {              /* dr = (0, phi) r / 2 */
            double p[4] = {0, 0, 0, 0}, d[4];
            p[1 + m] = 1;
            spari_quat_mul(p, r, d);
            D[3 * i + m] = (r[0] * d[1 + i] - r[1 + i] * d[0]) / s2;
        }
    } else if (without >= 0) {
        universal(without, r, z, D);
    } else {
        spari_quat_log(r, z);
        spari_tangent_inverse(z, D);
    }
}

/* Both ends; reach: a's point relative to node b; way: relative to b's point. */
static void carry_ends(const spari_joint_kinematics *t, const spari_node_pose *a, const spari_node_pose *b,
                       joint_end e[2], double reach[3], double way[3]) {
    carry_end(t, 0, a, &e[0]);
    carry_end(t, 1, b, &e[1]);
    for (int k = 0; k < 3; k++) {
        reach[k] = a->x[k] + e[0].arm[k] - b->x[k];
        way[k] = reach[k] - e[1].arm[k];
    }
}

/* Rotation of a's axes relative to b's. */
static void relative_rotation(const joint_end e[2], double r[4]) {
    double back[4];
    spari_quat_conj(e[1].axes, back);
    spari_quat_mul(back, e[0].axes, r);
}

static void line_motion(const joint_end e[2], const double w[3], double z[6], double B[6][12]) {
    double n[3];
    memset(z, 0, 6 * sizeof *z);
    z[0] = spari_norm(w);
    if (B) {
        for (int k = 0; k < 3; k++) {
            n[k] = z[0] > 0 ? w[k] / z[0] : 0;
        }
        memset(B, 0, 6 * sizeof *B);
        set_way(B[0], n, e[0].arm, e[1].arm);
    }
}

void spari_kinematics_motion(const spari_joint_kinematics *t, const spari_node_pose *a, const spari_node_pose *b,
                             double z[6], double B[6][12]) {
    joint_end e[2];
    double w[3], r[4], D[9], reach[3];
    carry_ends(t, a, b, e, reach, w);
    if (t->line) {
        line_motion(e, w, z, B);
        return;
    }
    double R[9]; /* columns: the axes of b */
    spari_quat_matrix(e[1].axes, R);
    for (int k = 0; k < 3; k++) {
        z[k] = R[k] * w[0] + R[3 + k] * w[1] + R[6 + k] * w[2];
    }
    relative_rotation(e, r);
    rotations(t, r, z + 3, D);
    for (int m = 0; m < 3 && B; m++) {
        const double none[3] = {0}, axis[3] = {R[m], R[3 + m], R[6 + m]}, *d = D + 3 * m;
        double rotation[3];
        set_way(B[m], axis, e[0].arm, reach); /* in b's axes, which rotate: a's point moves with b */
        for (int k = 0; k < 3; k++) {
            rotation[k] = R[3 * k] * d[0] + R[3 * k + 1] * d[1] + R[3 * k + 2] * d[2];
        }
        set_row(B[3 + m], none, rotation, rotation);
    }
}

void spari_kinematics_forces(double B[6][12], const double load[6], double f[12]) {
    memset(f, 0, 12 * sizeof *f);
    for (int k = 0; k < 6; k++) {
        for (int j = 0; j < 12 && load[k] != 0; j++) {
            f[j] += B[k][j] * load[k];
        }
    }
}

/* Displaces (du, dtheta) of one of the two nodes, counted as the entries of K and B */
static void nudge(spari_node_pose *a, spari_node_pose *b, int j, double by) {
    spari_node_pose *at = j < 6 ? a : b;
    if (j % 6 < 3) {
        at->x[j % 6] += by;
    } else {
        double psi[3] = {0}, p[4];
        psi[j % 6 - 3] = by;
        spari_quat_exp(psi, p);
        spari_quat_mul(p, at->q, at->q);
    }
}

/* Step of the central differences: the size of the geometry, for an accuracy of about 1e-10. */
static double size_of_joint(const spari_joint_kinematics *t, const spari_node_pose *a, const spari_node_pose *b) {
    double w[3];
    for (int k = 0; k < 3; k++) {
        w[k] = a->x[k] - b->x[k];
    }
    double size = spari_norm(w) + spari_norm(t->arm[0]) + spari_norm(t->arm[1]);
    return size > 0 ? size : 1;
}

/* The parts of a joint's forces B^T load, in global axes. For a link the moments are 0. */
typedef struct joint_forces {
    joint_end end[2];
    double reach[3];            /* from node b to the point where the force acts on b */
    double force[3], moment[3]; /* on a */
    double H[9];                /* derivative of the moment with respect to the relative rotation of a */
    double along[3], over;      /* of a link: its direction, and its tension over its length */
} joint_forces;

/* H := R G R^T, G the derivative of D^T load with respect to a small rotation of a relative to b, in b's axes. */
static void moment_tangent(const spari_joint_kinematics *t, const double r[4], const double R[9], const double load[3],
                           double H[9]) {
    const double by = 1e-5; /* central differences: relative error 1e-10 */
    double G[9] = {0};
    for (int j = 0; j < 3; j++) {
        for (int side = 0; side < 2; side++) {
            double psi[3] = {0}, p[4], z[3], D[9], moment[3];
            psi[j] = side ? -by : by;
            spari_quat_exp(psi, p);
            spari_quat_mul(p, r, p);
            rotations(t, p, z, D);
            spari_matrix_times_back(D, load, moment);
            for (int i = 0; i < 3; i++) {
                G[3 * i + j] += moment[i] / (2 * psi[j]);
            }
        }
    }
    for (int i = 0; i < 9; i++) {
        const double *row = R + 3 * (i / 3), *column = R + 3 * (i % 3);
        double half[3];
        spari_matrix_times(G, column, half);
        H[i] = spari_dot(row, half);
    }
}

static void find_joint_forces(const spari_joint_kinematics *t, const spari_node_pose *a, const spari_node_pose *b,
                              const double load[6], joint_forces *f) {
    double w[3], r[4], z[3], D[9], R[9];
    memset(f, 0, sizeof *f);
    carry_ends(t, a, b, f->end, f->reach, w);
    if (t->line) {
        double length = spari_norm(w);
        for (int k = 0; k < 3 && length > 0; k++) {
            f->over = load[0] / length;
            f->along[k] = w[k] / length;
            f->force[k] = load[0] * f->along[k];
        }
        memcpy(f->reach, f->end[1].arm, sizeof f->reach);
        return;
    }
    spari_quat_matrix(f->end[1].axes, R);
    spari_matrix_times(R, load, f->force);
    if (load[3] == 0 && load[4] == 0 && load[5] == 0) {
        return;
    }
    relative_rotation(f->end, r);
    rotations(t, r, z, D);
    spari_matrix_times_back(D, load + 3, f->moment);
    spari_matrix_times(R, f->moment, f->moment);
    moment_tangent(t, r, R, load + 3, f->H);
}

static void add_product(const double a[3], const double b[3], double sign, double to[3]) {
    double c[3];
    spari_cross(a, b, c);
    for (int k = 0; k < 3; k++) {
        to[k] += sign * c[k];
    }
}

/* df := the change of the forces with small displacements u and rotations p of the nodes */
static void change_of_forces(const joint_forces *f, int line, double u[2][3], double p[2][3], double df[12]) {
    double way[3], rotation[3], *force = df, *moment = df + 3, *moment_b = df + 9;
    memset(df, 0, 12 * sizeof *df);
    for (int k = 0; k < 3; k++) {
        way[k] = u[0][k] - u[1][k];
        rotation[k] = p[0][k] - p[1][k];
    }
    add_product(p[0], f->end[0].arm, 1, way);
    if (line) { /* the force changes its direction with the ends */
        add_product(p[1], f->end[1].arm, -1, way);
        double length = spari_dot(f->along, way), arm[3] = {0};
        for (int k = 0; k < 3; k++) {
            force[k] = f->over * (way[k] - length * f->along[k]);
        }
        add_product(p[1], f->end[1].arm, 1, arm);
        add_product(arm, f->force, -1, moment_b);
    } else { /* the force has b's axes, and acts on b at a's point */
        add_product(p[1], f->force, 1, force);
        add_product(way, f->force, -1, moment_b);
        spari_matrix_times(f->H, rotation, moment);
        add_product(p[1], f->moment, 1, moment);
        for (int k = 0; k < 3; k++) {
            moment_b[k] -= moment[k];
        }
    }
    double arm[3] = {0};
    add_product(p[0], f->end[0].arm, 1, arm);
    add_product(arm, f->force, 1, moment);
    add_product(f->end[0].arm, force, 1, moment);
    add_product(f->reach, force, -1, moment_b);
    for (int k = 0; k < 3; k++) {
        df[6 + k] = -force[k];
    }
}

void spari_kinematics_tangent(const spari_joint_kinematics *t, const spari_node_pose *a, const spari_node_pose *b,
                              const double load[6], double K[12][12]) {
    joint_forces f;
    find_joint_forces(t, a, b, load, &f);
    for (int j = 0; j < 12; j++) {
        double u[2][3] = {{0}}, p[2][3] = {{0}}, df[12];
        (j % 6 < 3 ? u : p)[j / 6][j % 3] = 1;
        change_of_forces(&f, t->line, u, p, df);
        for (int i = 0; i < 12; i++) {
            K[i][j] += df[i];
        }
    }
}

void spari_kinematics_rates(const spari_joint_kinematics *t, const spari_node_pose *a, const spari_node_pose *b,
                            const double v[12], double R[6][12]) {
    const double rotation = 1e-5, way = rotation * size_of_joint(t, a, b);
    for (int j = 0; j < 12; j++) {
        double by = j % 6 < 3 ? way : rotation, z[6], B[2][6][12];
        for (int side = 0; side < 2; side++) {
            spari_node_pose at = *a, bt = *b;
            nudge(&at, &bt, j, side ? -by : by);
            spari_kinematics_motion(t, &at, &bt, z, B[side]);
        }
        for (int i = 0; i < 6; i++) {
            R[i][j] = 0;
            for (int k = 0; k < 12; k++) {
                R[i][j] += (B[0][i][k] - B[1][i][k]) / (2 * by) * v[k];
            }
        }
    }
}

void spari_kinematics_drift(const spari_joint_kinematics *t, const spari_node_pose *a, const spari_node_pose *b,
                            const double v[12], double rate[6]) {
    double fastest = 0, size = size_of_joint(t, a, b), z[6], B[2][6][12];
    for (int j = 0; j < 12; j++) {
        fastest = fmax(fastest, fabs(v[j]) / (j % 6 < 3 ? size : 1));
    }
    double s = fastest > 0 ? 1e-5 / fastest : 0;
    for (int side = 0; side < 2; side++) {
        spari_node_pose at = *a, bt = *b;
        for (int n = 0; n < 2; n++) {
            spari_node_pose *p = n ? &bt : &at;
            double psi[3], rotation[4], by = side ? -s : s;
            for (int k = 0; k < 3; k++) {
                p->x[k] += by * v[6 * n + k];
                psi[k] = by * v[6 * n + 3 + k];
            }
            spari_quat_exp(psi, rotation);
            spari_quat_mul(rotation, p->q, p->q);
        }
        spari_kinematics_motion(t, &at, &bt, z, B[side]);
    }
    for (int k = 0; k < 6; k++) {
        rate[k] = 0;
        for (int j = 0; j < 12 && s > 0; j++) {
            rate[k] += (B[0][k][j] - B[1][k][j]) / (2 * s) * v[j];
        }
    }
}
