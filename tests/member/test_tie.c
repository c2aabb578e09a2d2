/* The geometry of joints: coordinates against their definitions, B against central differences (error h^2 + eps/h: 1e-9
   at h = 1e-5), invariance under a rigid motion of both nodes, and the geometric tangent against differences of B^T
   load. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#include "math/rotation.h"
#include "member/joint_kinematics.h"

#include <math.h>
#include <spar/spar_structure.h>
#include <stdlib.h>
#include <string.h>

static double uniform(void) {
    return 2.0 * rand() / RAND_MAX - 1.0;
}

static void random_vector(double size, double x[3]) {
    for (int k = 0; k < 3; k++) {
        x[k] = size * uniform();
    }
}

static void random_turn(double size, double q[4]) {
    double psi[3];
    random_vector(size, psi);
    spari_quat_exp(psi, q);
}

static spari_joint_kinematics random_tie(int free, int line) {
    spari_joint_kinematics t = {.free = free, .line = line};
    random_vector(1, t.arm[0]);
    random_vector(1, t.arm[1]);
    random_turn(2, t.axes[0]);
    random_turn(2, t.axes[1]);
    return t;
}

static void nudge(spari_node_pose *p, const double d[6]) {
    double turn[4];
    for (int k = 0; k < 3; k++) {
        p->x[k] += d[k];
    }
    spari_quat_exp(d + 3, turn);
    spari_quat_mul(turn, p->q, p->q);
}

/* a is where the tie's rotations, held ones among them, are what `relative` says */
static void random_places(const spari_joint_kinematics *t, const double relative[4], spari_node_pose *a,
                          spari_node_pose *b) {
    double frame[4], back[4];
    random_vector(3, a->x);
    random_vector(3, b->x);
    random_turn(3, b->q);
    spari_quat_mul(b->q, t->axes[1], frame);
    spari_quat_mul(frame, relative, frame);
    spari_quat_conj(t->axes[0], back);
    spari_quat_mul(frame, back, a->q);
}

static const int masks[] = {0,
                            SPAR_FREE_RX,
                            SPAR_FREE_RY | SPAR_FREE_X,
                            SPAR_FREE_RZ,
                            SPAR_FREE_RX | SPAR_FREE_RZ,
                            63,
                            SPAR_FREE_RX | SPAR_FREE_RY,
                            SPAR_FREE_RY | SPAR_FREE_RZ | SPAR_FREE_X};
enum { MASKS = sizeof masks / sizeof *masks };

static double angle_apart(double a, double b) {
    return remainder(a - b, 2 * 3.14159265358979323846);
}

/* Any relative rotation within 1 rad, so that the branch of no coordinate is left */
static void test_changes(void **state) {
    (void)state;
    srand(3);
    for (int trial = 0; trial < 80; trial++) {
        spari_joint_kinematics t = random_tie(masks[trial % MASKS], trial >= 64);
        spari_node_pose a, b;
        double relative[4], z[6], B[6][12], load[6], K[12][12] = {{0}}, f[2][12];
        random_turn(0.6, relative);
        random_places(&t, relative, &a, &b);
        random_vector(1, load);
        random_vector(1, load + 3);
        spari_kinematics_motion(&t, &a, &b, z, B);
        spari_kinematics_tangent(&t, &a, &b, load, K);
        for (int j = 0; j < 12; j++) {
            double zz[2][6], Bj[6][12], h = 1e-5;
            for (int side = 0; side < 2; side++) {
                spari_node_pose at = a, bt = b;
                double d[6] = {0};
                d[j % 6] = side ? -h : h;
                nudge(j < 6 ? &at : &bt, d);
                spari_kinematics_motion(&t, &at, &bt, zz[side], Bj);
                spari_kinematics_forces(Bj, load, f[side]);
            }
            for (int k = 0; k < 6; k++) {
                assert_true(fabs(B[k][j] - (zz[0][k] - zz[1][k]) / (2 * h)) < 2e-9);
            }
            for (int i = 0; i < 12; i++) {
                assert_true(fabs(K[i][j] - (f[0][i] - f[1][i]) / (2 * h)) < 1e-8);
            }
        }
    }
}

/* A motion of the whole changes no coordinate, and B asks nothing of it: B (omega x, omega) = 0. */
static void test_rigid_motion(void **state) {
    (void)state;
    srand(5);
    for (int trial = 0; trial < 40; trial++) {
        spari_joint_kinematics t = random_tie(masks[trial % MASKS], trial >= 32);
        spari_node_pose a, b;
        double relative[4], z[6], z2[6], B[6][12], turn[4], way[3], w[3];
        random_turn(1, relative);
        random_places(&t, relative, &a, &b);
        random_turn(3, turn);
        random_vector(5, way);
        random_vector(1, w);
        spari_kinematics_motion(&t, &a, &b, z, B);
        double va[3], vb[3];
        spari_cross(w, a.x, va);
        spari_cross(w, b.x, vb);
        for (int k = 0; k < 6; k++) {
            double rate = 0;
            for (int j = 0; j < 3; j++) {
                rate += B[k][j] * va[j] + B[k][3 + j] * w[j] + B[k][6 + j] * vb[j] + B[k][9 + j] * w[j];
            }
            assert_true(fabs(rate) < 1e-13);
        }
        spari_node_pose *both[2] = {&a, &b};
        for (int n = 0; n < 2; n++) {
            spari_rotate(turn, both[n]->x, both[n]->x);
            spari_quat_mul(turn, both[n]->q, both[n]->q);
            for (int k = 0; k < 3; k++) {
                both[n]->x[k] += way[k];
            }
        }
        spari_kinematics_motion(&t, &a, &b, z2, B);
        for (int k = 0; k < 6; k++) {
            assert_true(fabs(angle_apart(z[k], z2[k])) < 1e-13);
        }
    }
}

/* A hinge at any angle: held rotations stay 0, the angle is the angle, and B is smooth through half a turn and more. */
static void test_hinge_turns(void **state) {
    (void)state;
    srand(7);
    for (int axis = 0; axis < 3; axis++) {
        spari_joint_kinematics t = random_tie(SPAR_FREE_RX << axis, 0);
        for (int n = -40; n <= 40; n++) {
            double angle = 0.1 * n, psi[3] = {0}, relative[4], z[6], B[6][12], D = 0;
            spari_node_pose a, b;
            psi[axis] = angle;
            spari_quat_exp(psi, relative);
            random_places(&t, relative, &a, &b);
            spari_kinematics_motion(&t, &a, &b, z, B);
            for (int k = 0; k < 3; k++) {
                assert_true(k == axis ? fabs(angle_apart(z[3 + k], angle)) < 1e-14 : fabs(z[3 + k]) < 1e-14);
                D = 0;
                for (int j = 0; j < 3; j++) {
                    D += B[3 + k][3 + j] * B[3 + k][3 + j];
                }
                assert_true(fabs(D - 1) < 1e-13);
            }
        }
    }
}

/* A universal joint at any two angles, the first about an axis of b's, the second about one of a's: the angles are the
   angles, the held coordinate is 0; turned about the third axis besides by 0.1, it is sin 0.1. */
static void test_universal_turns(void **state) {
    (void)state;
    srand(9);
    for (int n = 0; n < 300; n++) {
        int without = n % 3, first = without == 0 ? 1 : 0, second = 3 - without - first, off = n % 2;
        spari_joint_kinematics t = random_tie(56 & ~(SPAR_FREE_RX << without), 0);
        double angle[2] = {0.17 * (n - 150), 4 * uniform()}, psi[3][3] = {{0}}, turn[3][4], relative[4], z[6];
        spari_node_pose a, b;
        psi[0][first] = angle[0], psi[1][second] = angle[1], psi[2][without] = 0.1 * off;
        for (int k = 0; k < 3; k++) {
            spari_quat_exp(psi[k], turn[k]);
        }
        spari_quat_mul(turn[0], turn[2], relative);
        spari_quat_mul(relative, turn[1], relative);
        random_places(&t, relative, &a, &b);
        spari_kinematics_motion(&t, &a, &b, z, NULL);
        assert_true(fabs(angle_apart(z[3 + first], angle[0])) < 1e-13);
        assert_true(fabs(angle_apart(z[3 + second], angle[1])) < 1e-13);
        assert_true(fabs(z[3 + without] - sin(0.1 * off)) < 1e-13);
    }
}

/* Small rotations are the same three numbers to first order, whichever are free: their difference is of second order.
 */
static void test_rotations_agree(void **state) {
    (void)state;
    srand(11);
    const double psi[3] = {1e-4, -2e-4, 1.5e-4};
    double relative[4];
    spari_quat_exp(psi, relative);
    for (int m = 0; m < MASKS; m++) {
        spari_joint_kinematics t = random_tie(masks[m], 0);
        spari_node_pose a, b;
        double z[6];
        random_places(&t, relative, &a, &b);
        spari_kinematics_motion(&t, &a, &b, z, NULL);
        for (int k = 0; k < 3; k++) {
            assert_true(fabs(z[3 + k] - psi[k]) < 1e-7);
        }
    }
}

/* B-dot v against the second difference of z along v: z(s) = z + B v s + (B-dot v) s^2 / 2. */
static void test_drift(void **state) {
    (void)state;
    srand(13);
    for (int trial = 0; trial < 40; trial++) {
        spari_joint_kinematics t = random_tie(masks[trial % MASKS], trial >= 32);
        spari_node_pose a, b;
        double relative[4], v[12], z[3][6], drift[6], h = 1e-4;
        random_turn(0.5, relative);
        random_places(&t, relative, &a, &b);
        for (int j = 0; j < 12; j++) {
            v[j] = uniform();
        }
        spari_kinematics_drift(&t, &a, &b, v, drift);
        for (int s = -1; s <= 1; s++) {
            spari_node_pose at = a, bt = b;
            double d[12];
            for (int j = 0; j < 12; j++) {
                d[j] = s * h * v[j];
            }
            nudge(&at, d);
            nudge(&bt, d + 6);
            spari_kinematics_motion(&t, &at, &bt, z[s + 1], NULL);
        }
        for (int k = 0; k < 6; k++) {
            assert_true(fabs(drift[k] - (z[0][k] - 2 * z[1][k] + z[2][k]) / (h * h)) < 1e-6);
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_changes),         cmocka_unit_test(test_rigid_motion),
        cmocka_unit_test(test_hinge_turns),     cmocka_unit_test(test_universal_turns),
        cmocka_unit_test(test_rotations_agree), cmocka_unit_test(test_drift),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
