/* Eigenvalues of assemblies: members that joints tie together, and parts that turn against each other. */
#include "scene.h"

#include "algebra/pencil.h"

#include <gsl/gsl_eigen.h>
#include <gsl/gsl_sort_vector.h>

static void slender(double *K, double *M) {
    scene_diagonal(K, 1e6, 1e6, 1e6, 1e3, 1, 1);
    scene_diagonal(M, 1, 1, 1, 2e-8, 1e-8, 1e-8);
}

static spar_member *body_of(spar_session *s, const char *name, double m, double Jp, double Jt, double W) {
    const double x[3] = {0}, q[4] = {1, 0, 0, 0}, c[3] = {0}, J[3] = {Jp, Jt, Jt}, w[3] = {W, 0, 0};
    double M[36];
    spar_member *b = NULL;
    scene_mass(M, m, c, J);
    OK(s, spar_rigid_create(s, name, x, q, M, &b));
    OK(s, spar_member_set_root(b, SPAR_ROOT_FREE));
    OK(s, spar_member_set_initial_velocity(b, NULL, NULL, w));
    return b;
}

/* Beck's column of two halves that a joint welds together: growth rate under P, of the member asked. */
static double growth_of_halves(int nodes, double P, int asked) {
    const double at[3] = {0.5, 0, 0}, q[4] = {1, 0, 0, 0}, load[6] = {-P, 0, 0, 0, 0, 0};
    double K[36], M[36], value[3][2], most = 0;
    spar_session *s = scene_session();
    spar_member *b[2];
    spar_joint *j = NULL;
    slender(K, M);
    b[0] = scene_beam(s, "lower", 1, nodes, 0.5, K, M);
    b[1] = scene_beam(s, "upper", 1, nodes, 0.5, K, M);
    OK(s, spar_member_set_placement(b[1], at, q));
    OK(s, spar_member_set_root(b[1], SPAR_ROOT_FREE));
    OK(s, spar_joint_create(s, "weld", b[0], nodes - 1, b[1], 0, 0, &j));
    OK(s, spar_member_commit(b[0]));
    OK(s, spar_member_commit(b[1]));
    OK(s, spar_member_set_load(b[1], nodes - 1, SPAR_LOAD_FOLLOWER, load));
    OK(s, spar_session_solve_static(s, 1, NULL, NULL, NULL));
    OK(s, spar_member_solve_eigenvalues(b[asked], 3, NULL, &value[0][0], NULL, NULL));
    for (int i = 0; i < 3; i++) {
        most = fmax(most, value[i][0]);
    }
    spar_session_destroy(&s);
    return most;
}

/* As the whole column, test_eigenvalues.c: 20.0509 to 1e-4; dense (78 unknowns) and by Arnoldi (150), and the same bits
   from either member. */
static void test_welded_column(void **state) {
    (void)state;
    for (int nodes = 7; nodes <= 13; nodes += 6) {
        assert_true(growth_of_halves(nodes, 20.03, 0) < 1e-2);
        assert_true(growth_of_halves(nodes, 20.08, 0) > 1e-2);
        assert_true(growth_of_halves(nodes, 22, 0) == growth_of_halves(nodes, 22, 1));
    }
}

/* Steps that damp the stretching away with which the blades meet their turning. */
static void turn_hub(spar_session *s, spar_member *hub) {
    OK(s, spar_session_set_integrator(s, 0, 1));
    for (int i = 1; i <= 150; i++) {
        const double angle = 0.012 * i, rate[6] = {0, 0, 0, 0, 0, 6};
        const double q[7] = {0, 0, 0, cos(0.5 * angle), 0, 0, sin(0.5 * angle)};
        OK(s, spar_member_drive(hub, q, rate, NULL));
        scene_run(s, 0.002, 1);
    }
}

/* Two blades welded to a hub that turns with 6: each bends out of the plane as alone, between the tables of
   test_eigenvalues.c: 7.3603730193 and 26.809081678 (Wright et al. 1982), twice. Shear and
   stretch of 1e-6 EI, and steps of (W dt)^2 / 12 that the turn is found by: asked to 3e-5. */
static void test_hub_and_blades(void **state) {
    (void)state;
    enum { N = 9 };
    const double flap[2] = {7.3603730193, 26.809081678}, W[3] = {0, 0, 6};
    const double x[3] = {0}, q[2][4] = {{1, 0, 0, 0}, {0, 0, 0, 1}}, c[3] = {0}, J[3] = {1, 1, 1};
    double K[36], M[36], body[36], value[2][2], shapes[2 * 12 * N], frame[3];
    spar_session *s = scene_session();
    spar_member *hub = NULL, *b[2];
    spar_joint *j = NULL;
    slender(K, M);
    scene_mass(body, 1, c, J);
    OK(s, spar_rigid_create(s, "hub", x, q[0], body, &hub));
    OK(s, spar_member_set_root(hub, SPAR_ROOT_DRIVEN));
    OK(s, spar_member_set_initial_velocity(hub, NULL, NULL, W));
    OK(s, spar_member_commit(hub));
    for (int i = 0; i < 2; i++) {
        b[i] = scene_beam(s, i ? "second" : "first", 1, N, 1, K, M);
        OK(s, spar_member_set_placement(b[i], x, q[i]));
        OK(s, spar_member_set_root(b[i], SPAR_ROOT_FREE));
        OK(s, spar_member_set_initial_velocity(b[i], NULL, NULL, W));
        OK(s, spar_joint_create(s, i ? "weld 2" : "weld 1", b[i], 0, hub, 0, 0, &j));
        OK(s, spar_member_commit(b[i]));
    }
    turn_hub(s, hub);
    for (int k = 0; k < 2; k++) {
        const double shift[2] = {0, flap[k]};
        OK(s, spar_member_solve_eigenvalues(b[1], 2, shift, &value[0][0], shapes, frame));
        for (int i = 0; i < 2; i++) {
            NEAR(value[i][1], flap[k], 3e-5 * flap[k]);
            NEAR(value[i][0], 0, 1e-6);
        }
        NEAR(frame[2], 6, 1e-12);
    }
    spar_session_destroy(&s);
}

/* A mast on springs that let it tilt, and a disc that spins on it: (J1 + Jt) p'' - i Jp W p' + k p = 0, seen from axes
   that stand; and the spin itself, without stiffness. A disc that is not round has no eigenvalues. */
static void test_spinning_disc(void **state) {
    (void)state;
    const double k = 40, Jp = 1.5, Jt = 0.8, J1 = 0.4, W = 7, sum = J1 + Jt, root = sqrt(Jp * Jp * W * W + 4 * sum * k);
    const double expected[3] = {0, (root - Jp * W) / (2 * sum), (root + Jp * W) / (2 * sum)};
    for (int round = 1; round >= 0; round--) {
        double value[3][2], frame[3], spring[36];
        spar_session *s = scene_session();
        spar_member *mast = body_of(s, "mast", 1, 0.4, J1, 0), *disc = NULL;
        const double x[3] = {0}, q[4] = {1, 0, 0, 0}, c[3] = {0}, J[3] = {Jp, Jt, round ? Jt : 1.1 * Jt};
        const double w[3] = {W, 0, 0};
        double M[36];
        spar_joint *foot = NULL, *hinge = NULL;
        scene_mass(M, 2, c, J);
        scene_diagonal(spring, 0, 0, 0, 0, k, k);
        OK(s, spar_rigid_create(s, "disc", x, q, M, &disc));
        OK(s, spar_member_set_root(disc, SPAR_ROOT_FREE));
        OK(s, spar_member_set_initial_velocity(disc, NULL, NULL, w));
        OK(s, spar_joint_create(s, "foot", mast, 0, NULL, 0, SPAR_FREE_RY | SPAR_FREE_RZ, &foot));
        OK(s, spar_joint_set_spring(foot, spring, NULL, NULL));
        OK(s, spar_joint_create(s, "bearing", disc, 0, mast, 0, SPAR_FREE_RX, &hinge));
        OK(s, spar_member_commit(mast));
        OK(s, spar_member_commit(disc));
        if (round) {
            OK(s, spar_member_solve_eigenvalues(disc, 3, NULL, &value[0][0], NULL, frame));
            for (int i = 0; i < 3; i++) {
                NEAR(value[i][1], expected[i], 1e-7);
                NEAR(value[i][0], 0, 1e-7);
            }
            NEAR(frame[0], 0, 0);
        } else {
            assert_int_equal(spar_member_solve_eigenvalues(disc, 3, NULL, &value[0][0], NULL, frame),
                             SPAR_ERR_UNSUPPORTED);
            assert_non_null(strstr(spar_session_message(s), "'disc' rotates relative"));
        }
        spar_session_destroy(&s);
    }
}

/* A round body that spins on springs that are not: seen from axes that stand the body's equations do not change with
   its angle, sqrt(k/m) each. */
static void test_unlike_springs(void **state) {
    (void)state;
    double spring[36], value[2], frame[3];
    spar_session *s = scene_session();
    spar_member *b = body_of(s, "rotor", 2, 1.5, 0.8, 3);
    spar_joint *j = NULL;
    scene_diagonal(spring, 8, 50, 72, 0, 1e3, 1e3);
    OK(s, spar_joint_create(s, "springs", b, 0, NULL, 0, 63, &j));
    OK(s, spar_joint_set_spring(j, spring, NULL, NULL));
    OK(s, spar_member_commit(b));
    for (int i = 0; i < 3; i++) {
        const double expected = i == 0 ? 2 : i == 1 ? 5 : 6, shift[2] = {0, expected};
        OK(s, spar_member_solve_eigenvalues(b, 1, shift, value, NULL, frame));
        NEAR(value[1], expected, 1e-9);
        NEAR(frame[0], 0, 0);
    }
    spar_session_destroy(&s);
}

/* A shaft on bearings with external damping c alike all around, its own frame turning with W: in axes that stand
   m y'' + c y' + k y = 0 whatever W; seen from the shaft lambda is that -+ i W. */
static void test_damped_bearing(void **state) {
    (void)state;
    const double m = 2, k = 50, c = 3, W = 1.7;
    double spring[36], damper[36], value[2][2];
    spar_session *s = scene_session();
    spar_member *b = body_of(s, "shaft", m, 1.5, 0.8, W);
    spar_joint *j = NULL;
    scene_diagonal(spring, 1e4, k, k, 0, 1e4, 1e4);
    scene_diagonal(damper, 0, c, c, 0, 0, 0);
    OK(s, spar_joint_create(s, "bearing", b, 0, NULL, 0, 63, &j));
    OK(s, spar_joint_set_spring(j, spring, damper, NULL));
    OK(s, spar_member_commit(b));
    for (int i = 0; i < 2; i++) {
        const double w0 = sqrt(k / m - 0.25 * c * c / (m * m)) + (i ? W : -W), shift[2] = {-0.5 * c / m, w0};
        OK(s, spar_member_solve_eigenvalues(b, 1, shift, value[i], NULL, NULL));
        NEAR(value[i][0], -0.5 * c / m, 1e-8);
        NEAR(value[i][1], w0, 1e-8);
    }
    spar_session_destroy(&s);
}

/* Numbers without any order, for what has no symmetry to lean on. */
static double drawn(uint64_t *seed) {
    *seed = *seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (double)(*seed >> 11) * 0x1p-53 - 0.5;
}

/* Unsymmetric matrices of a chain with held and doubly held unknowns: dense and by Arnoldi the same eigenvalues, twice
   over, since the chain is there two times; and P x has no part that the holds allow. */
static void test_dense_and_sparse(void **state) {
    (void)state;
    enum { N = 60, ASK = 10 };
    double complex value[2][ASK], x[2][ASK * 2 * N];
    for (int how = 0; how < 2; how++) {
        spari_pencil p;
        uint64_t seed = 7;
        assert_int_equal(spari_pencil_create(&p, 2 * N), SPAR_OK);
        for (int i = 0; i < N; i++) {
            for (int j = i > 1 ? i - 2 : 0; j < N && j < i + 3; j++) {
                double k = drawn(&seed) + (i == j ? 4 + 0.1 * i : 0), c = 0.2 * drawn(&seed), m = i == j;
                spari_pencil_put(&p, (spari_pencil_entry){i, j, k, c, m});
                spari_pencil_put(&p, (spari_pencil_entry){N + i, N + j, k, c, m});
            }
        }
        for (int copy = 0; copy < 4; copy++) { /* each chain's first two move alike; said twice */
            spari_pencil_add_constraint(&p, (spari_pencil_constraint){copy, N * (copy % 2), 1});
            spari_pencil_add_constraint(&p, (spari_pencil_constraint){copy, N * (copy % 2) + 1, -1});
        }
        p.constraints = 4;
        int found = 0;
        assert_int_equal(spari_spectrum(&p, ASK, CMPLX(0, 2), how ? SPARI_SPECTRUM_SPARSE : SPARI_SPECTRUM_DENSE,
                                        &found, value[how], x[how]),
                         SPAR_OK);
        assert_int_equal(found, ASK);
        spari_pencil_free(&p);
    }
    for (int i = 0; i < ASK; i++) {
        NEAR(cabs(value[0][i] - value[1][i]), 0, 1e-9);
        NEAR(cabs(value[1][i] - value[1][i - i % 2]), 0, 1e-9);
        NEAR(cabs(x[1][2 * N * i] - x[1][2 * N * i + 1]), 0, 1e-9);
    }
}

/* ---- drivetrains ---- */

enum { MOST_DISCS = 10 };

/* Frequencies, Hz, of n discs on a shaft, k between them, that nothing holds: those of the symmetric matrix of the
   springs over the roots of the inertias, by GSL. */
static void shaft_frequencies(int n, const double *J, const double *k, double *f) {
    gsl_matrix *A = gsl_matrix_calloc((size_t)n, (size_t)n);
    gsl_vector *square = gsl_vector_alloc((size_t)n);
    gsl_eigen_symm_workspace *w = gsl_eigen_symm_alloc((size_t)n);
    for (size_t i = 0; i + 1 < (size_t)n; i++) {
        *gsl_matrix_ptr(A, i, i) += k[i] / J[i];
        *gsl_matrix_ptr(A, i + 1, i + 1) += k[i] / J[i + 1];
        *gsl_matrix_ptr(A, i, i + 1) -= k[i] / sqrt(J[i] * J[i + 1]);
        *gsl_matrix_ptr(A, i + 1, i) -= k[i] / sqrt(J[i] * J[i + 1]);
    }
    gsl_eigen_symm(A, square, w);
    gsl_sort_vector(square);
    for (int i = 0; i < n; i++) {
        f[i] = sqrt(fmax(gsl_vector_get(square, (size_t)i), 0)) / (2 * acos(-1));
    }
    gsl_matrix_free(A);
    gsl_vector_free(square);
    gsl_eigen_symm_free(w);
}

/* The same of discs on bearings, 1 m apart: modes [n] and eigenvalues [n][2]. */
static void turn_shaft(int n, const double *J, const double *k, double *f, double *value) {
    static const char *const disc[MOST_DISCS] = {"d0", "d1", "d2", "d3", "d4", "d5", "d6", "d7", "d8", "d9"},
                             *const hold[MOST_DISCS] = {"b0", "b1", "b2", "b3", "b4", "b5", "b6", "b7", "b8", "b9"},
                             *const shaft[MOST_DISCS] = {"s0", "s1", "s2", "s3", "s4", "s5", "s6", "s7", "s8", "s9"};
    spar_session *s = scene_session();
    spar_member *m[MOST_DISCS];
    for (int i = 0; i < n; i++) {
        const double x[3] = {i, 0, 0}, inertia[3] = {J[i], J[i], J[i]};
        m[i] = scene_body(s, disc[i], x, 1, inertia);
        (void)scene_joint_at(s, hold[i], m[i], 0, NULL, 0, SPAR_FREE_RX, x);
    }
    for (int i = 0; i + 1 < n; i++) {
        const double x[3] = {i + 0.5, 0, 0};
        const int all = SPAR_FREE_X | SPAR_FREE_Y | SPAR_FREE_Z | SPAR_FREE_RX | SPAR_FREE_RY | SPAR_FREE_RZ;
        double stiffness[36];
        scene_diagonal(stiffness, 0, 0, 0, k[i], 0, 0);
        OK(s, spar_joint_set_spring(scene_joint_at(s, shaft[i], m[i], 0, m[i + 1], 0, all, x), stiffness, NULL, NULL));
    }
    OK(s, spar_member_solve_modes(m[0], n, f, NULL));
    OK(s, spar_member_solve_eigenvalues(m[0], n, NULL, value, NULL, NULL));
    spar_session_destroy(&s);
}

/* A shaft that turns freely has one motion without stiffness. Whether its stiffness can be factored is for rounding to
   decide: modes were wrong by up to 70 %, eigenvalues refused. The three discs of the first are at 3.048 and 5.247 Hz.
 */
static void test_drivetrains(void **state) {
    (void)state;
    const double discs[3] = {4, 1.5, 0.7}, springs[2] = {900, 300};
    srand(2);
    for (int trial = 0; trial < 101; trial++) {
        double J[MOST_DISCS], k[MOST_DISCS], exact[MOST_DISCS], f[MOST_DISCS], value[2 * MOST_DISCS];
        int n = trial == 0 ? 3 : 2 + rand() % (MOST_DISCS - 1);
        for (int i = 0; i < n; i++) { /* over four powers of ten */
            J[i] = trial == 0 ? discs[i] : pow(10, 4.0 * rand() / RAND_MAX - 2);
            k[i] = trial == 0 ? springs[i % 2] : pow(10, 4.0 * rand() / RAND_MAX + 1);
        }
        shaft_frequencies(n, J, k, exact);
        turn_shaft(n, J, k, f, value);
        NEAR(f[0], 0, 1e-4 * exact[1]);
        NEAR(value[1], 0, 1e-4 * exact[1]);
        for (int i = 1; i < n; i++) {
            NEAR(f[i], exact[i], 1e-7 * exact[i]);
            NEAR(value[2 * i + 1] / (2 * acos(-1)), exact[i], 1e-7 * exact[i]);
            NEAR(value[2 * i], 0, 1e-6 * value[2 * i + 1]);
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_welded_column),  cmocka_unit_test(test_hub_and_blades),
        cmocka_unit_test(test_spinning_disc),  cmocka_unit_test(test_unlike_springs),
        cmocka_unit_test(test_damped_bearing), cmocka_unit_test(test_dense_and_sparse),
        cmocka_unit_test(test_drivetrains),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
