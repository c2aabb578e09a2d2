/* Modes at rest and turning, and the steady turn they are taken about. */
#include "scene.h"

#include "algebra/shifted.h"
#include "math/basis.h"
#include "member/body.h"
#include "member/structure.h"
#include "stability/small_motions.h"

#include "time/steady_rotation.h"
#include <stdio.h>

static const double two_pi = 6.283185307179586;

/* A beam along x from the hub's radius R, driven, turning at `speed` about `axis`; in equilibrium with its turn. */
static spar_member *rotor(spar_session *s, int elements, int nodes, double L, double R, const double *K,
                          const double *M, const double axis[3], double speed) {
    double x[3] = {R, 0, 0}, q[4] = {1, 0, 0, 0}, w[3];
    spar_member *b = scene_beam(s, "b", elements, nodes, L, K, M);
    for (int i = 0; i < 3; i++) {
        w[i] = speed * axis[i];
    }
    OK(s, spar_member_set_placement(b, x, q));
    OK(s, spar_member_set_root(b, SPAR_ROOT_DRIVEN));
    OK(s, spar_member_set_initial_velocity(b, NULL, NULL, w));
    OK(s, spar_member_commit(b));
    OK(s, spar_member_solve_static(b, 1));
    return b;
}

/* Rotating uniform cantilever, hub radius 0: omega L^2 sqrt(m/EI) of flap (out of the plane of rotation) by Frobenius
   series, Wright et al., J. Appl. Mech. 49 (1982) 197, 9 digits; in-plane omega^2 is less by eta^2 (first mode given).
   EA, GA = 1e8 EI/L^2, rotary inertia 1e-8 m L^2 flapwise: 1e-5 by stretch at eta = 12 and by shear; asked: 1e-4. */
static void test_rotating_cantilever(void **state) {
    (void)state;
    const double table[][5] = {{0, 3.5160152685, 22.034491565, 61.697214414, 3.5160153},
                               {1, 3.681646814, 22.181011151, 61.841762587, 3.5432363},
                               {2, 4.137319573, 22.614921957, 62.273184106, 3.621797},
                               {3, 4.7972785324, 23.320263674, 62.984967481, 3.7435119},
                               {4, 5.5850014209, 24.273349394, 63.966760493, 3.8977225},
                               {5, 6.4495447486, 25.446080358, 65.205040522, 4.0738959},
                               {6, 7.3603730193, 26.809081678, 66.683914382, 4.2632254},
                               {8, 9.2568376005, 29.995381892, 70.292962186, 4.6571496},
                               {10, 11.202327762, 33.640365854, 74.649294597, 5.0489749},
                               {12, 13.170150488, 37.603112331, 79.614478489, 5.4270493}};
    const double L = 2, EI = 5, m = 3, unit = sqrt(EI / m) / (L * L), stiff = 1e8 * EI / L / L, j = 1e-8 * m * L * L;
    const double axis[3] = {0, 0, 1};
    double K[36], M[36];
    scene_diagonal(K, stiff, stiff, stiff, 1e6 * EI, EI, EI);
    scene_diagonal(M, m, m, m, 2 * j, j, j);
    for (size_t k = 0; k < sizeof table / sizeof *table; k++) {
        spar_session *s = scene_session();
        double f[6], shapes[6 * 6 * 14], flap[3];
        spar_member *b = rotor(s, 1, 14, L, 0, K, M, axis, table[k][0] * unit);
        OK(s, spar_member_solve_modes(b, 6, f, shapes));
        int count = 0, plane = 0;
        double in_plane = 0;
        for (int i = 0; i < 6 && count < 3; i++) {
            const double *tip = shapes + (ptrdiff_t)6 * 14 * i + 6 * 13;
            if (k == 0 ? i % 2 == 0 : fabs(tip[2]) > fabs(tip[1])) {
                flap[count++] = two_pi * f[i] / unit;
            } else if (!plane++) {
                in_plane = two_pi * f[i] / unit;
            }
        }
        in_plane = k == 0 ? two_pi * f[1] / unit : in_plane;
        for (int i = 0; i < 3; i++) {
            NEAR(flap[i], table[k][1 + i], 1e-5 * table[k][1 + i]);
        }
        NEAR(in_plane, table[k][4], 1e-5 * table[k][4]);
        spar_session_destroy(&s);
    }
}

/* Timoshenko cantilever: omega L^2 sqrt(m/EI) with r^2 = I/(A L^2), EI/(kGA L^2) = 3.12 r^2, from the frequency
   equation; modes of 16 nodes have converged to the digits given. */
static void test_timoshenko(void **state) {
    (void)state;
    const double table[][5] = {{0.02, 3.50264107, 21.46982418, 58.14983171, 109.0291433},
                               {0.05, 3.435274962, 19.10362328, 46.60313987, 78.90221754},
                               {0.10, 3.227127762, 14.4689281, 31.50253891, 47.90901878}};
    const double L = 2, EI = 5, m = 3, unit = sqrt(EI / m) / (L * L);
    for (int k = 0; k < 3; k++) {
        double K[36], M[36], f[4], r2 = table[k][0] * table[k][0] * L * L, GA = EI / (3.12 * r2);
        scene_diagonal(K, 1e9, 1e9, GA, 1e9, EI, 1e9);
        scene_diagonal(M, m, m, m, 1e-6, m * r2, 1e-6);
        spar_session *s = scene_session();
        spar_member *b = scene_beam(s, "b", 1, 16, L, K, M);
        OK(s, spar_member_commit(b));
        OK(s, spar_member_solve_modes(b, 4, f, NULL));
        for (int i = 0; i < 4; i++) {
            NEAR(two_pi * f[i] / unit, table[k][1 + i], 2e-9 * table[k][1 + i]);
        }
        spar_session_destroy(&s);
    }
}

/* A rotating bar stretches as u = sin(k x/L)/(k/L cos k) - x, k^2 = m W^2 L^2 / EA; the motion left behind is the turn
   of that shape, the root pulls with m W^2 int (x + u) = EA (1/cos k - 1). No step of time moves it in its frame: after
   a quarter turn it has turned by it, to the integrator's error. */
static void test_steady_turn(void **state) {
    (void)state;
    const double L = 2, EA = 50, m = 3, W = 1.4, axis[3] = {0, 0, 1}, k = W * L * sqrt(m / EA);
    double K[36], M[36], q[10 * 7], v[60], a[60], r[6], tip = L * tan(k) / k;
    scene_diagonal(K, EA, 40, 40, 20, 20, 20);
    scene_diagonal(M, m, m, m, 0.1, 0.1, 0.1);
    spar_session *s = scene_session();
    spar_member *b = rotor(s, 1, 10, L, 0, K, M, axis, W);
    OK(s, spar_member_get_motion(b, q, v, a));
    OK(s, spar_member_get_reaction(b, r));
    NEAR(q[63], tip - L, 1e-11 * L);
    NEAR(v[6 * 9 + 1], W * tip, 1e-10);
    NEAR(a[6 * 9], -W * W * tip, 1e-10);
    NEAR(v[6 * 9 + 5], W, 0);
    NEAR(r[0], -EA * (1 / cos(k) - 1), 1e-8);
    const int64_t steps = 200;
    const double dt = two_pi / 4 / W / (double)steps;
    for (int64_t i = 1; i <= steps; i++) {
        double drive[7] = {0, 0, 0, cos(0.5 * W * dt * (double)i), 0, 0, sin(0.5 * W * dt * (double)i)};
        double rate[6] = {0, 0, 0, 0, 0, W};
        OK(s, spar_member_drive(b, drive, rate, NULL));
        scene_run(s, dt, 1);
    }
    OK(s, spar_member_get_motion(b, q, NULL, NULL));
    NEAR(q[63], -L, 1e-4);
    NEAR(q[64], tip, 1e-4);
    spar_session_destroy(&s);
}

/* Coupled, offset sections, an axis of rotation that is oblique to the beam, hub radius: the same frequencies whatever
   way the whole points. */
static void test_placement(void **state) {
    (void)state;
    enum { N = 13, MODES = 5 };
    double K[36], M[36], f[2][MODES], shapes[MODES * 6 * N], x[3] = {0.5, 0, 0};
    const double c[3] = {0, 0.02, -0.03}, J[3] = {0.02, 0.005, 0.015}, axis[3] = {0, 0.6, 0.8};
    scene_box(K, M);
    scene_mass(M, 0.2, c, J);
    for (int k = 0; k < 2; k++) {
        double q[4] = {1, 0, 0, 0}, w[3], psi[3] = {0.3, -0.4, 0.9};
        spar_session *s = scene_session();
        spar_member *b = scene_beam(s, "b", 1, N, 10, K, M);
        if (k) {
            spari_quat_exp(psi, q);
        }
        for (int i = 0; i < 3; i++) {
            w[i] = 30 * axis[i];
        }
        double place[3];
        spari_rotate(q, w, w);
        spari_rotate(q, x, place);
        OK(s, spar_member_set_placement(b, place, q));
        OK(s, spar_member_set_root(b, SPAR_ROOT_DRIVEN));
        OK(s, spar_member_set_initial_velocity(b, NULL, NULL, w));
        OK(s, spar_member_commit(b));
        OK(s, spar_member_solve_static(b, 3));
        OK(s, spar_member_solve_modes(b, MODES, f[k], shapes));
        spar_session_destroy(&s);
    }
    for (int i = 0; i < MODES; i++) {
        NEAR(f[0][i], f[1][i], 1e-8 * f[0][i]);
    }
}

/* The stiffness in the frame that turns is the derivative of the forces of a shape at rest in it, whatever the shape:
   central differences, 1e-9 of the stiffness. Offset masses, oblique axis, hub radius. */
static void test_turning_tangent(void **state) {
    (void)state;
    enum { P = 5, N = 6 * P };
    double K[36], M[36], q[7 * P], v[N], a[N], r[2][N], S[N * N], Me[N * N], h = 1e-5;
    const double c[3] = {0, 0.02, -0.03}, J[3] = {0.02, 0.005, 0.015}, vr[6] = {1, 2, 3, 12, -20, 31},
                 ar[6] = {100, 50, -40, 0, 0, 0};
    scene_box(K, M);
    for (int i = 0; i < 36; i++) {
        K[i] *= 1e-3; /* centrifugal terms as large as elastic ones */
    }
    scene_mass(M, 0.2, c, J);
    spar_session *s = scene_session();
    spar_member *b = scene_beam(s, "b", 1, P, 10, K, M);
    OK(s, spar_member_commit(b));
    spari_rotating_frame turn = {.mass = NULL};
    assert_true(spari_steady_rotation_of(b, vr, ar, &turn.rotation));
    memcpy(turn.centre, b->xr, sizeof turn.centre);
    for (int i = 0; i < P; i++) {
        double psi[3] = {0.1 * i, -0.2 * i * i, 0.3 * i};
        q[7 * i] = 0.1 * i, q[7 * i + 1] = 0.2 * i * i, q[7 * i + 2] = -0.1 * i;
        spari_quat_exp(psi, q + (ptrdiff_t)7 * i + 3);
    }
    spari_rotating_frame_nodes(&turn, 1, b, P, q, v, a);
    spari_steady_rotation_tangent(b->body, &turn.rotation, 0, q, v, a, 1, S, Me);
    for (int j = 6; j < N; j++) { /* the root carries the frame */
        for (int k = 0; k < 2; k++) {
            double p[7 * P], step = k ? h : -h, psi[3] = {0}, t[4];
            memcpy(p, q, sizeof p);
            if (j % 6 < 3) {
                p[7 * (j / 6) + j % 6] += step;
            } else {
                psi[j % 6 - 3] = step;
                spari_quat_exp(psi, t);
                spari_quat_mul(t, p + (ptrdiff_t)7 * (j / 6) + 3, p + (ptrdiff_t)7 * (j / 6) + 3);
            }
            spari_rotating_frame_nodes(&turn, 1, b, P, p, v, a);
            spari_steady_rotation_residual(b->body, p, v, a, 1, r[k]);
        }
        for (int i = 0; i < N; i++) {
            NEAR((r[1][i] - r[0][i]) / (2 * h), S[N * i + j], 1e-5);
        }
    }
    spar_session_destroy(&s);
}

/* Unit modal mass and orthogonality of the shapes of a straight uniform beam, x^T M y by Lobatto's rule on the nodes
   (1e-5 off the exact integral for these shapes). */
static void test_mass_normalised(void **state) {
    (void)state;
    enum { N = 9, MODES = 4 };
    double K[36], M[36], f[MODES], shapes[MODES * 6 * N], w[N];
    const double c[3] = {0, 0, 0}, J[3] = {0.02, 0.005, 0.015}, L = 4;
    scene_box(K, M);
    scene_mass(M, 0.2, c, J);
    spar_session *s = scene_session();
    spar_member *b = scene_beam(s, "b", 1, N, L, K, M);
    OK(s, spar_member_commit(b));
    OK(s, spar_member_solve_modes(b, MODES, f, shapes));
    spari_gll(N, NULL, w, NULL);
    for (int i = 0; i < MODES; i++) {
        for (int j = 0; j <= i; j++) {
            double sum = 0;
            for (int l = 0; l < N; l++) {
                const double *p = shapes + (ptrdiff_t)6 * (N * i + l), *q = shapes + (ptrdiff_t)6 * (N * j + l);
                for (int k = 0; k < 6; k++) {
                    sum += 0.5 * L * w[l] * M[7 * k] * p[k] * q[k];
                }
            }
            NEAR(sum, i == j ? 1 : 0, 1e-5);
        }
    }
    spar_session_destroy(&s);
}

/* A free beam has six modes of frequency 0 and then the free-free ones, (beta L)^2 = 22.3732854481; rounding shows as
   1e-2, shear and rotary inertia take 1e-3 off. A column beyond its Euler load, held straight by symmetry, has a
   negative one: with the axial force P, omega^2 falls through zero at P_cr = pi^2 EI / (4 L^2). */
static void test_free_and_buckled(void **state) {
    (void)state;
    const double L = 2, EI = 5, m = 3, unit = sqrt(EI / m) / (L * L), stiff = 1e4 * EI, j = 1e-4;
    double K[36], M[36], f[8];
    scene_diagonal(K, stiff, stiff, stiff, stiff, EI, EI);
    scene_diagonal(M, m, m, m, 2 * j, j, j);
    spar_session *s = scene_session();
    spar_member *b = scene_beam(s, "free", 1, 12, L, K, M), *c = scene_beam(s, "column", 1, 12, L, K, M);
    OK(s, spar_member_set_root(b, SPAR_ROOT_FREE));
    OK(s, spar_member_commit(b));
    OK(s, spar_member_commit(c));
    OK(s, spar_member_solve_modes(b, 8, f, NULL));
    for (int i = 0; i < 6; i++) {
        NEAR(two_pi * f[i] / unit, 0, 1e-2);
    }
    NEAR(two_pi * f[6] / unit, 22.3732854481, 2e-3 * 22.37);
    for (int k = 0; k < 2; k++) {
        double P = (k ? 0.999 : 0.99) * 2.46740110027 * EI / (L * L), load[6] = {-P, 0, 0, 0, 0, 0};
        OK(s, spar_member_set_load(c, 11, SPAR_LOAD_DEAD, load));
        OK(s, spar_member_solve_static(c, 1));
        OK(s, spar_member_solve_modes(c, 1, f + k, NULL));
    }
    NEAR(f[1] * f[1] / (f[0] * f[0]), 0.1, 1e-3); /* omega^2 is linear in P near the critical load */
    spar_session_destroy(&s);
}

/* Curved and twisted beams with coupled sections, free (6 rigid modes) or pinned (3), under a small dead load that
   gives rotations a stiffness of either sign: any number of modes is found. Rigid ones stay below what the load gives a
   rod about its end, omega^2 = 3 p / (2 m), and the rounding of the stiffness, 1e-5 of the first elastic frequency. The
   others agree within 1e-6, whichever number is asked for. */
static void test_free_and_curved(void **state) {
    (void)state;
    enum { SHAPES = 70, POINTS = 5, MOST = 12 };
    for (int k = 0; k < SHAPES; k++) {
        const int rigid = k % 2 ? 3 : 6;
        const double p = pow(10, -3 - k % 7), middle = 0.5, load[6] = {p, -p, p, 0, 0, 0};
        double K[36], M[36], eta[POINTS], xyz[POINTS][3], twist[POINTS], all[MOST], f[MOST];
        const double diagonal[6] = {1e5, 4e4, 5e4, 3e3, 4e3, 6e3};
        for (int i = 0; i < 36; i++) {
            const double part = i / 6 == i % 6 ? 1 : 0.15 * sin(1.0 + k + (i / 6) * (i % 6));
            K[i] = part * sqrt(diagonal[i / 6] * diagonal[i % 6]);
        }
        scene_mass(M, 2, (double[3]){0, 0.1, -0.05}, (double[3]){0.05, 0.02, 0.03});
        for (int i = 0; i < POINTS; i++) {
            eta[i] = i / (POINTS - 1.0);
            xyz[i][0] = 2 * eta[i];
            xyz[i][1] = 0.1 * (k % 5) * eta[i] * eta[i];
            xyz[i][2] = 0.1 * (k % 3) * eta[i] * (1 - eta[i]);
            twist[i] = 0.2 * (k % 4) * eta[i];
        }
        spar_session *s = scene_session();
        OK(s, spar_session_set_gravity(s, load));
        spar_member *b = scene_beam(s, "b", 2 + k % 2, 4 + k % 3, 2, K, M);
        OK(s, spar_beam_set_axis(b, POINTS, eta, xyz[0], twist));
        OK(s, spar_member_set_root(b, k % 2 ? SPAR_ROOT_PINNED : SPAR_ROOT_FREE));
        OK(s, spar_member_commit(b));
        OK(s, spar_beam_set_line_load(b, SPAR_LOAD_DEAD, 1, &middle, load));
        OK(s, spar_member_solve_modes(b, MOST, all, NULL));
        for (int n = 1; n <= MOST; n++) {
            OK(s, spar_member_solve_modes(b, n, f, NULL));
            for (int i = 0; i < n; i++) {
                NEAR(f[i], i < rigid ? 0 : all[i], i < rigid ? sqrt(p) + 1e-5 * all[rigid] : 1e-6 * all[rigid]);
            }
        }
        assert_true(all[rigid] > 1);
        spar_session_destroy(&s);
    }
}

/* A free body under a follower force F at its centre of mass: the symmetric part of the load's stiffness couples
   displacements and rotations and has nothing on the diagonal: omega^2 = +-|F| / (2 sqrt(m J)), each twice, and twice
   0. The same in any orientation, where rounding comes upon the diagonal; 1e-9 of the largest. */
static void test_followed_body(void **state) {
    (void)state;
    const double m = 3, J = 2, J3[3] = {J, J, J}, centre[3] = {0, 0, 0}, way[3] = {0.3, -0.4, 1.2}; /* of length 1.3 */
    for (int k = 0; k < 12; k++) {
        const double F = pow(10, k / 2 - 3), turn[3] = {0.7 * (k % 2), 0.2 * k, -0.5 * k};
        const double largest = sqrt(1.3 * F / (2 * sqrt(m * J))) / two_pi, wanted[6] = {-1, -1, 0, 0, 1, 1};
        double M[36], q[4], f[6];
        scene_mass(M, m, centre, J3);
        spari_quat_exp(turn, q);
        spar_session *s = scene_session();
        spar_member *b = NULL;
        OK(s, spar_rigid_create(s, "b", NULL, q, M, &b));
        OK(s, spar_member_commit(b));
        OK(s, spar_member_set_load(b, 0, SPAR_LOAD_FOLLOWER, (double[6]){F * way[0], F * way[1], F * way[2], 0, 0, 0}));
        OK(s, spar_member_solve_modes(b, 6, f, NULL));
        for (int i = 0; i < 6; i++) {
            NEAR(f[i], wanted[i] * largest, (wanted[i] == 0 ? 1e-6 : 1e-9) * largest);
        }
        OK(s, spar_member_solve_modes(b, 1, f, NULL));
        NEAR(f[0], -largest, 1e-9 * largest);
        spar_session_destroy(&s);
    }
}

/* The eigenvalue solver never ends on matrices that are no numbers: they are refused before. Nor may it on entries
   whose squares are none; those are only another unit of force: frequencies go with the root of the stiffness. */
static void test_modes_beyond_numbers(void **state) {
    (void)state;
    const double eta[2] = {0, 1};
    double K[36], M[36], load[12] = {0}, f[2][4];
    scene_box(K, M);
    load[1] = load[7] = 1e308;
    load[5] = load[11] = 1e308;
    spar_session *s = scene_session();
    spar_member *b = scene_beam(s, "beam", 1, 4, 10, K, M);
    OK(s, spar_member_commit(b));
    OK(s, spar_member_solve_modes(b, 4, f[0], NULL));
    OK(s, spar_beam_set_line_load(b, SPAR_LOAD_FOLLOWER, 2, eta, load));
    assert_int_equal(spar_member_solve_modes(b, 4, f[1], NULL), SPAR_ERR_NUMERIC);
    assert_non_null(strstr(spar_session_message(s), "'beam'"));
    for (int i = 0; i < 36; i++) {
        K[i] *= 1e200;
        M[i] *= 1e190;
    }
    for (int fidelity = SPAR_FIDELITY_LINEAR; fidelity <= SPAR_FIDELITY_EXACT; fidelity++) {
        char name[8] = {'s', (char)('0' + fidelity), 0};
        spar_member *stiff = scene_beam(s, name, 1, 4, 10, K, M);
        OK(s, spar_member_set_fidelity(stiff, fidelity, 5));
        OK(s, spar_member_commit(stiff));
        OK(s, spar_member_solve_modes(stiff, 4, f[1], NULL));
        for (int k = 0; k < 4; k++) {
            NEAR(f[1][k] / f[0][k], 1e5, 1e5 * 1e-9);
        }
    }
    spar_session_destroy(&s);
}

/* Two identical cantilevers of equal bending stiffness in both planes, connected without springs: every
   frequency of one of them twice, the bending ones four times. The same to 1e-9. */
static void test_identical_beams(void **state) {
    (void)state;
    enum { MODES = 12 };
    double K[36], M[36], one[MODES / 2], f[MODES];
    spar_session *s = scene_session();
    scene_diagonal(K, 5e5, 5e5, 5e5, 40, 50, 50);
    scene_diagonal(M, 3, 3, 3, 0.02, 0.01, 0.01);
    spar_member *b[3];
    for (int i = 0; i < 3; i++) {
        const char name[2] = {(char)('a' + i), 0};
        b[i] = scene_beam(s, name, 3, 5, 2, K, M);
        OK(s, spar_member_commit(b[i]));
    }
    (void)scene_joint(s, "nothing", b[1], 14, b[2], 14, 63);
    OK(s, spar_member_solve_modes(b[0], MODES / 2, one, NULL));
    OK(s, spar_member_solve_modes(b[1], MODES, f, NULL));
    for (int i = 0; i < MODES; i++) {
        NEAR(f[i], one[i / 2], 1e-9 * one[i / 2]);
    }
    spar_session_destroy(&s);
}

/* A jacket of `bays` storeys of 12 beams: four legs, and two braces on each side that pass each other. The lowest
   beams are fixed at the ground, the others welded to the legs. */
static spar_member *jacket(spar_session *s, int bays, spar_member **first) {
    enum { E = 1, N = 5 };
    const double corner[4][2] = {{-5, -5}, {5, -5}, {5, 5}, {-5, 5}}, eta[2] = {0, 1};
    double K[36], M[36];
    spar_member *below[4] = {NULL}, *leg[4], *b = NULL;
    scene_diagonal(M, 200, 200, 200, 20, 10, 10);
    for (int i = 0; i < 12 * bays; i++) {
        int bay = i / 12, k = i % 12, from = k < 4 ? k : (k / 2 + k % 2) % 4, to = k < 4 ? k : (k / 2 + 1 - k % 2) % 4;
        const double xyz[6] = {corner[from][0], corner[from][1], 6 * bay, corner[to][0], corner[to][1], 6 * bay + 6};
        double EI = k < 4 ? 4e9 : 2e8;
        char name[16], weld[24];
        scene_diagonal(K, 50 * EI, 10 * EI, 10 * EI, 0.8 * EI, EI, EI);
        snprintf(name, sizeof name, "beam%d", i);
        OK(s, spar_beam_create(s, name, E, N, &b));
        OK(s, spar_beam_set_axis(b, 2, eta, xyz, NULL));
        OK(s, spar_beam_set_sections(b, 1, eta, K, M));
        OK(s, spar_member_set_root(b, bay ? SPAR_ROOT_FREE : SPAR_ROOT_FIXED));
        OK(s, spar_member_commit(b));
        *first = i == 0 ? b : *first;
        leg[k < 4 ? k : 0] = k < 4 ? b : leg[0];
        snprintf(weld, sizeof weld, "root of %d", i);
        if (bay) {
            (void)scene_joint(s, weld, b, 0, below[from], E * N - 1, 0);
        }
        snprintf(weld, sizeof weld, "tip of %d", i);
        if (k >= 4) {
            (void)scene_joint(s, weld, b, E * N - 1, leg[to], E * N - 1, 0);
        }
        memcpy(below, k == 11 ? leg : below, sizeof below);
    }
    return b;
}

/* Number of modes below f, from the signs of the pivots of K - (2 pi f)^2 M with the constraints. */
static int modes_below(const spar_member *m, double f) {
    spari_small_motions w;
    spari_shifted a;
    assert_int_equal(spari_small_motions_create_modes(&w, m, 1), SPAR_OK);
    int *block = calloc((size_t)w.size, sizeof *block), count = -1;
    assert_non_null(block);
    for (int i = 0; i < w.parts; i++) {
        for (int k = 0; k < w.part[i].size; k++) {
            count += k == 0 || (w.part[i].size - k) % 6 == 0;
            block[w.part[i].at + k] = count;
        }
    }
    assert_int_equal(spari_shifted_create(&a, &w.pencil, block, 0, NULL), SPAR_OK);
    assert_int_equal(spari_shifted_factor(&a, -two_pi * f * two_pi * f), 0);
    int below = a.below;
    spari_shifted_free(&a);
    spari_small_motions_free(&w);
    free(block);
    return below;
}

/* A jacket of 24 beams has the frequencies that its unsymmetric eigenproblem has, found by other code, 1e-8. In one of
   204 beams the number of modes below limits between the frequencies is that of the negative pivots. The modes of two
   of its members are the same bits, and so is a second solution. */
static void test_jacket(void **state) {
    (void)state;
    enum { MODES = 30 };
    double f[MODES], again[MODES], value[2 * MODES];
    spar_session *s = scene_session();
    spar_member *first = NULL, *b = jacket(s, 2, &first);
    OK(s, spar_member_solve_modes(b, 12, f, NULL));
    OK(s, spar_member_solve_eigenvalues(b, 12, NULL, value, NULL, NULL));
    for (int i = 0; i < 12; i++) {
        NEAR(two_pi * f[i], value[2 * i + 1], 1e-8 * value[2 * i + 1]);
    }
    spar_session_destroy(&s);
    s = scene_session();
    b = jacket(s, 17, &first);
    OK(s, spar_member_solve_modes(b, MODES, f, NULL));
    for (int i = 1; i < MODES; i++) {
        assert_true(f[i] >= f[i - 1]);
        if (f[i] > f[i - 1] * (1 + 1e-6)) {
            assert_int_equal(modes_below(b, 0.5 * (f[i] + f[i - 1])), i);
        }
    }
    OK(s, spar_member_solve_modes(first, MODES, again, NULL));
    assert_memory_equal(again, f, sizeof f);
    spar_session_destroy(&s);
}

/* A round cantilever in no axis' direction, stretch and shear 1e4 to 1e20 times as stiff as bending: the frequencies of
   two pairs of bending, 3.516 and 22.03 sqrt(EI/m)/L^2 less 2e-4 and 2e-3 of them by rotary inertia, and the
   eigenvalues are those of 1e8, whose own stretch and shear change 1e-6 of them. Beside a tip load, too, as far as
   there is an equilibrium. A linear beam keeps the stiffness of its commit: it is right, refused, or
   a warning says how wrong it may be. */
static void test_stiff_strains(void **state) {
    (void)state;
    const double eta[2] = {0, 1}, line[6] = {0, 0, 0, 0.6, 0.64, 0.48}, load[6] = {0.1, 0.3, -0.5};
    static const int fidelity[3] = {SPAR_FIDELITY_EXACT, SPAR_FIDELITY_EXACT, SPAR_FIDELITY_LINEAR};
    for (int kind = 0; kind < 3; kind++) {
        double want[4] = {0};
        for (double ratio = 1e8; ratio < (kind == 1 ? 1e13 : 1e21); ratio *= 10) {
            double K[36], M[36], f[4], value[8];
            scene_diagonal(K, ratio, ratio, ratio, 1, 1, 1);
            scene_diagonal(M, 1, 1, 1, 2e-4, 1e-4, 1e-4);
            spar_session *s = scene_session();
            spar_member *b = scene_beam(s, "b", 2, 8, 1, K, M);
            OK(s, spar_beam_set_axis(b, 2, eta, line, NULL));
            OK(s, spar_member_set_fidelity(b, fidelity[kind], 0));
            OK(s, spar_member_commit(b));
            if (kind == 1) {
                OK(s, spar_member_set_load(b, 15, SPAR_LOAD_DEAD, load));
                OK(s, spar_member_solve_static(b, 4));
            }
            int status = spar_member_solve_modes(b, 4, f, NULL);
            int other = spar_member_solve_eigenvalues(b, 4, NULL, value, NULL, NULL);
            assert_true(kind == 2 || (status == SPAR_OK && other == SPAR_OK));
            int warned = kind == 2 && spar_session_get_warning(s, 0)[0];
            for (int i = 0; i < 4; i++) {
                want[i] = ratio < 2e8 ? f[i] : want[i];
                assert_true(status != SPAR_OK || warned || fabs(f[i] / want[i] - 1) < (kind == 2 ? 1e-3 : 5e-6));
                assert_true(other != SPAR_OK || warned ||
                            fabs(value[2 * i + 1] / (two_pi * want[i]) - 1) < (kind == 2 ? 1e-3 : 5e-6));
            }
            spar_session_destroy(&s);
        }
        if (kind != 1) {
            NEAR(two_pi * want[0] / 3.516015, 1, 3e-4);
            NEAR(two_pi * want[2] / 22.034492, 1, 3e-3);
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_rotating_cantilever), cmocka_unit_test(test_timoshenko),
        cmocka_unit_test(test_steady_turn),         cmocka_unit_test(test_placement),
        cmocka_unit_test(test_mass_normalised),     cmocka_unit_test(test_turning_tangent),
        cmocka_unit_test(test_free_and_buckled),    cmocka_unit_test(test_free_and_curved),
        cmocka_unit_test(test_followed_body),       cmocka_unit_test(test_modes_beyond_numbers),
        cmocka_unit_test(test_identical_beams),     cmocka_unit_test(test_jacket),
        cmocka_unit_test(test_stiff_strains),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
