/* Beams held in a plane: a slab under pressure that would twist out of it, the motion in the plane against the same
   beam without the constraint, an inclined plane, roots, statics, modes, eigenvalues, save and load, bad input. */
#include "scene.h"

#include <stdio.h>

enum { E = 2, P = 6, NODES = E * P };
static const double L = 0.35, h = 0.02, w = 0.01, two_pi = 6.283185307179586;
static const double normal_z[3] = {0, 0, 1};

/* Turek and Hron's FSI2 flag, a slab of width w: stiffness and mass as in examples/hosts/cases/flag_fsi2.case. */
static spar_member *named_slab(spar_session *s, const char *name, const double *normal) {
    double K[36], M[36];
    scene_diagonal(K, 333.3333333333333, 83.33333333333333, 83.33333333333333, 0.011111111111111112, 0.1111111111111111,
                   0.011111111111111112);
    scene_diagonal(M, 2, 2, 2, 8.333333333333333e-5, 1.6666666666666667e-5, 6.6666666666666667e-5);
    spar_member *b = scene_beam(s, name, E, P, L, K, M);
    OK(s, spar_beam_set_plane(b, normal));
    return b;
}

static spar_member *slab(spar_session *s, const double *normal) {
    return named_slab(s, "flag", normal);
}

/* ---- the instability that the constraint is for ---- */

enum { STRIPS = 20 };

/* Pressure p on both faces, in the fluid's fixed directions across the flag, and a touch of everything out of the
   plane. Returns the largest displacement or rotation out of the plane of the last of n steps. */
static double press(double p, const double *normal, int n) {
    double x[2 * STRIPS][3], f[2 * STRIPS][3], worst = 0, q[NODES][7], v[NODES][6], a[NODES][6];
    const double touch[6] = {0, 0, 1e-7, 1e-9, 1e-9, 0};
    spar_session *s = scene_session();
    spar_member *b = slab(s, normal);
    spar_fluid *fluid = NULL;
    scene_explicit(s);
    OK(s, spar_member_commit(b));
    OK(s, spar_member_set_load(b, NODES - 1, SPAR_LOAD_DEAD, touch));
    for (int i = 0; i < 2 * STRIPS; i++) {
        int side = i % 2 ? -1 : 1;
        x[i][0] = (i / 2 + 0.5) * L / STRIPS, x[i][1] = side * h / 2, x[i][2] = 0;
        f[i][0] = f[i][2] = 0, f[i][1] = -side * p * w * L / STRIPS;
    }
    OK(s, spar_fluid_create(b, "water", &fluid));
    OK(s, spar_fluid_set_motion_nodes(fluid, 2 * STRIPS, x[0]));
    OK(s, spar_fluid_set_force_nodes(fluid, 2 * STRIPS, x[0]));
    OK(s, spar_fluid_map(fluid));
    for (int k = 0; k < n; k++) {
        int done = 0;
        OK(s, spar_step_begin(s, 0.002));
        while (!done) {
            OK(s, spar_step_solve(s));
            OK(s, spar_fluid_pull_motion(fluid, 1, x[0], NULL));
            OK(s, spar_fluid_push_forces(fluid, f[0], NULL));
            OK(s, spar_step_check(s, &done));
        }
        OK(s, spar_step_accept(s));
    }
    OK(s, spar_member_get_motion(b, q[0], v[0], a[0]));
    for (int i = 0; i < NODES; i++) {
        double out[] = {q[i][2], q[i][4], q[i][5], v[i][2], v[i][3], v[i][4], a[i][2], a[i][3], a[i][4]};
        for (int c = 0; c < 9; c++) {
            worst = fmax(worst, fabs(out[c]) * (c < 3));
            assert_true(!normal || out[c] == 0);
        }
    }
    spar_session_destroy(&s);
    return worst;
}

/* Above the pressure G J (pi / 2 L)^2 / (h w) a free slab twists: twice that, its rotation grows to more than 0.1 of a
   touch that bends it by 1e-4 of that below the limit. Held in its plane nothing leaves it, to the bit. */
static void test_pressure(void **state) {
    (void)state;
    const double GJ = 0.011111111111111112, limit = GJ * pow(two_pi / 4 / L, 2) / (h * w);
    NEAR(limit, 1119, 1); /* 1.1 kPa of FSI2 */
    assert_true(press(0.5 * limit, NULL, 400) < 1e-4);
    assert_true(press(2 * limit, NULL, 400) > 0.1);
    assert_true(press(2 * limit, normal_z, 400) == 0);
}

/* ---- motion in the plane ---- */

/* Axes of a scene: the plane's normal is the third column of the rotation. */
static void placed(const double q[4], const double in[6], double out[6]) {
    spari_rotate(q, in, out);
    spari_rotate(q, in + 3, out + 3);
}

/* A flag at a placement swings far under loads in its plane; result: tip, relative to the placement's axes. 1: held in
   the plane, and pushed out of it too. */
static void swing(int planar, const double turn[4], double tip[7], double v[6], double root[6]) {
    const double at[3] = {1, 2, 3}, in[6] = {0.02, 0.4, 0, 0, 0, 0.003}, out[6] = {0, 0, 0.7, 0.02, -0.01, 0};
    double load[6], more[6], q[NODES][7], rate[NODES][6], normal[3], r[6];
    spar_session *s = scene_session();
    spari_rotate(turn, normal_z, normal);
    for (int i = 0; i < 3; i++) {
        normal[i] *= 2; /* any length */
    }
    spar_member *b = slab(s, planar ? normal : NULL);
    scene_explicit(s);
    OK(s, spar_member_set_placement(b, at, turn));
    OK(s, spar_member_commit(b));
    placed(turn, in, load);
    placed(turn, out, more);
    for (int i = 0; i < 6 && planar; i++) {
        load[i] += more[i];
    }
    OK(s, spar_member_set_load(b, NODES - 1, SPAR_LOAD_DEAD, load));
    scene_run(s, 0.005, 80);
    OK(s, spar_member_get_motion(b, q[0], rate[0], NULL));
    OK(s, spar_member_get_reaction(b, r));
    const double *last = q[NODES - 1];
    double back[4] = {turn[0], -turn[1], -turn[2], -turn[3]}, part[4];
    spari_rotate_back(turn, last, tip);
    spari_quat_mul(back, last + 3, part);
    spari_quat_mul(part, turn, tip + 3);
    for (int k = 0; k < 6; k += 3) {
        spari_rotate_back(turn, rate[NODES - 1] + k, v + k);
        spari_rotate_back(turn, r + k, root + k);
    }
    spar_session_destroy(&s);
}

/* The same motion as that of the free beam without loads out of the plane, to what Newton leaves (strict); its root's
   reaction too. In an inclined plane the same, and what leaves the plane is rounding. */
static void test_as_the_free_beam(void **state) {
    (void)state;
    const double straight[4] = {1, 0, 0, 0}, psi[3] = {0.7, -1.1, 0.4};
    double inclined[4], tip[3][7], v[3][6], root[3][6];
    spari_quat_exp(psi, inclined);
    swing(0, straight, tip[0], v[0], root[0]);
    swing(1, straight, tip[1], v[1], root[1]);
    swing(1, inclined, tip[2], v[2], root[2]);
    assert_true(tip[0][1] > 0.05);
    for (int k = 1; k < 3; k++) {
        for (int i = 0; i < 7; i++) {
            NEAR(tip[k][i], tip[0][i], 1e-10);
        }
        for (int i = 0; i < 6; i++) {
            NEAR(v[k][i], v[0][i], 1e-8);
            NEAR(root[k][i], root[0][i], 1e-8);
        }
    }
    assert_true(tip[1][2] == 0 && tip[1][4] == 0 && tip[1][5] == 0 && v[1][2] == 0);
    NEAR(tip[2][2], 0, 1e-14);
    NEAR(tip[2][4], 0, 1e-14);
    NEAR(tip[2][5], 0, 1e-14);
}

/* Roots in the plane: pinned and free ones with an initial rotation about the normal, and a driven one, against the
   beam without the constraint; rounding of steps that Newton converges strictly. */
static void test_roots(void **state) {
    (void)state;
    const int roots[3] = {SPAR_ROOT_FREE, SPAR_ROOT_PINNED, SPAR_ROOT_DRIVEN};
    const double spin[3] = {0, 0, 3}, along[3] = {0.3, 0.2, 0}, zero[3] = {0, 0, 0};
    for (int k = 0; k < 3; k++) {
        double tip[2][7];
        for (int planar = 0; planar < 2; planar++) {
            spar_session *s = scene_session();
            spar_member *b = slab(s, planar ? normal_z : NULL);
            const double gravity[3] = {0.5, -1, planar ? 4 : 0};
            OK(s, spar_session_set_gravity(s, gravity));
            OK(s, spar_member_set_root(b, roots[k]));
            OK(s, spar_member_set_initial_velocity(b, NULL, k == 0 ? along : zero, spin));
            OK(s, spar_member_commit(b));
            for (int i = 1; i <= 60; i++) {
                double angle = 3 * 0.005 * i, q[7] = {0, 0, 0, cos(angle / 2), 0, 0, sin(angle / 2)},
                       v[6] = {0, 0, 0, 0, 0, 3};
                OK(s, roots[k] == SPAR_ROOT_DRIVEN ? spar_member_drive(b, q, v, NULL) : SPAR_OK);
                scene_run(s, 0.005, 1);
            }
            scene_tip(b, tip[planar]);
            spar_session_destroy(&s);
        }
        assert_true(fabs(tip[0][1]) > 0.1);
        for (int i = 0; i < 7; i++) {
            NEAR(tip[1][i], tip[0][i], 1e-9);
        }
        assert_true(tip[1][2] == 0 && tip[1][4] == 0 && tip[1][5] == 0);
    }
}

/* ---- statics, modes, eigenvalues ---- */

/* The static shape under loads in and out of the plane is that of those in it. */
static void test_statics(void **state) {
    (void)state;
    double tip[2][7];
    for (int planar = 0; planar < 2; planar++) {
        const double load[6] = {0.1, 0.15, planar ? 5 : 0, planar ? 0.1 : 0, planar ? 0.2 : 0, 0.01};
        spar_session *s = scene_session();
        spar_member *b = slab(s, planar ? normal_z : NULL);
        OK(s, spar_member_commit(b));
        OK(s, spar_member_set_load(b, NODES - 1, SPAR_LOAD_DEAD, load));
        OK(s, spar_member_solve_static(b, 4));
        scene_tip(b, tip[planar]);
        spar_session_destroy(&s);
    }
    assert_true(tip[0][1] > 0.1);
    for (int i = 0; i < 7; i++) {
        NEAR(tip[1][i], tip[0][i], 1e-10);
    }
    assert_true(tip[1][2] == 0 && tip[1][4] == 0 && tip[1][5] == 0);
}

/* Modes in the plane alone: of a slab as wide as FSI2's, bending across the flag is the softest. The first is Euler and
   Bernoulli's cantilever, 1.8751^2 sqrt(EI / m L^4) / 2 pi, but for shear and rotary inertia (0.6 %). All modes of the
   held beam are among those of the free one, in number 3 a free node; no shape leaves the plane. Eigenvalues agree. */
static void test_modes(void **state) {
    (void)state;
    enum { UNKNOWNS = E * (P - 1) };
    const double psi[3] = {0.7, -1.1, 0.4};
    double all[6 * UNKNOWNS], in[3 * UNKNOWNS], shapes[3 * UNKNOWNS][NODES][6], value[5][2], inclined[4], normal[3];
    spar_session *s = scene_session();
    spar_member *free_one = named_slab(s, "free", NULL), *held = named_slab(s, "held", normal_z), *tilted;
    OK(s, spar_member_commit(free_one));
    OK(s, spar_member_commit(held));
    OK(s, spar_member_solve_modes(free_one, 6 * UNKNOWNS, all, NULL));
    OK(s, spar_member_solve_modes(held, 3 * UNKNOWNS, in, shapes[0][0]));
    REFUSED(s, SPAR_ERR_ARGUMENT, "it has 30", spar_member_solve_modes(held, 3 * UNKNOWNS + 1, all, NULL));
    double first = 1.8751 * 1.8751 * sqrt(0.011111111111111112 / 2 / pow(L, 4)) / two_pi;
    NEAR(in[0], first, 0.006 * first);
    for (int k = 0; k < 3 * UNKNOWNS; k++) {
        double nearest = HUGE_VAL;
        for (int i = 0; i < 6 * UNKNOWNS; i++) {
            nearest = fmin(nearest, fabs(all[i] - in[k]));
        }
        NEAR(nearest, 0, 1e-6 * in[k]);
        for (int i = 0; i < NODES; i++) {
            assert_true(shapes[k][i][2] == 0 && shapes[k][i][3] == 0 && shapes[k][i][4] == 0);
        }
    }
    OK(s, spar_member_solve_eigenvalues(held, 5, NULL, value[0], NULL, NULL));
    for (int k = 0; k < 5; k++) {
        NEAR(value[k][1], two_pi * in[k], 1e-7 * value[k][1]);
        NEAR(value[k][0], 0, 1e-6 * value[k][1]);
    }
    spari_quat_exp(psi, inclined);
    spari_rotate(inclined, normal_z, normal);
    tilted = named_slab(s, "tilted", normal);
    OK(s, spar_member_set_placement(tilted, psi, inclined));
    OK(s, spar_member_commit(tilted));
    OK(s, spar_member_solve_modes(tilted, 5, all, NULL));
    for (int k = 0; k < 5; k++) {
        NEAR(all[k], in[k], 1e-8 * in[k]);
    }
    spar_session_destroy(&s);
}

/* ---- save and load ---- */

/* A saved run goes on to the bit; a session whose beam has no plane, or another one, refuses the file. */
static void test_saved(void **state) {
    (void)state;
    const double load[6] = {0, 0.3, 0.2, 0, 0, 0}, other[3] = {0, 1, 0},
                 *normals[4] = {normal_z, normal_z, NULL, other};
    const char *file = "plane.spar";
    double tip[2][7];
    for (int k = 0; k < 4; k++) {
        spar_session *s = scene_session();
        spar_member *b = slab(s, normals[k]);
        OK(s, spar_member_commit(b));
        OK(s, spar_member_set_load(b, NODES - 1, SPAR_LOAD_DEAD, load));
        if (k == 0) {
            scene_run(s, 0.005, 10);
            OK(s, spar_session_save(s, file));
        } else if (k == 1) {
            OK(s, spar_session_load(s, file));
        } else {
            REFUSED(s, SPAR_ERR_ARGUMENT, "flag", spar_session_load(s, file));
        }
        if (k < 2) {
            scene_run(s, 0.005, 10);
            scene_tip(b, tip[k]);
        }
        spar_session_destroy(&s);
    }
    assert_true(tip[0][1] > 1e-3);
    assert_memory_equal(tip[0], tip[1], sizeof tip[0]);
    assert_int_equal(remove(file), 0);
}

/* ---- bad input ---- */

static void test_refused(void **state) {
    (void)state;
    const double nan3[3] = {NAN, 0, 1}, huge[3] = {1e200, 1e200, 1e200}, zero[3] = {0, 0, 0}, five[3] = {3, 0, 4},
                 rest[6] = {0}, off[7] = {0, 0, 1e-3, 1, 0, 0, 0}, tilt[7] = {0, 0, 0, 0.8, 0.6, 0, 0},
                 in_plane[7] = {0.1, 0.2, 1e-16, 0.8, 0, 0, 0.6}, up[6] = {0, 0, 1e-3, 0, 0, 0}, x[3] = {0, 0, 1},
                 unit[4] = {1, 0, 0, 0};
    double got[3];
    spar_joint *joint = NULL;
    spar_session *s = scene_session();
    spar_member *b = slab(s, NULL), *point = NULL;
    OK(s, spar_beam_get_plane(b, got));
    assert_true(got[0] == 0 && got[1] == 0 && got[2] == 0);
    OK(s, spar_beam_set_plane(b, five));
    OK(s, spar_beam_get_plane(b, got));
    NEAR(got[0], 0.6, 1e-15);
    NEAR(got[2], 0.8, 1e-15);
    REFUSED(s, SPAR_ERR_ARGUMENT, "normal", spar_beam_set_plane(b, nan3));
    REFUSED(s, SPAR_ERR_ARGUMENT, "too long", spar_beam_set_plane(b, huge));
    OK(s, spar_beam_get_plane(b, NULL));
    OK(s, spar_beam_set_plane(b, zero));
    OK(s, spar_beam_get_plane(b, got));
    assert_true(got[0] == 0 && got[2] == 0);
    assert_int_equal(spar_beam_set_plane(NULL, five), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_beam_get_plane(NULL, got), SPAR_ERR_ARGUMENT);
    OK(s, spar_point_create(s, "point", zero, unit, &point));
    REFUSED(s, SPAR_ERR_ARGUMENT, "not a beam", spar_beam_set_plane(point, five));
    OK(s, spar_beam_set_plane(b, normal_z));
    const int kinds[] = {SPAR_FIDELITY_LINEAR, SPAR_FIDELITY_MODAL, SPAR_FIDELITY_RIGID, SPAR_FIDELITY_PRESCRIBED};
    for (int k = 0; k < 4; k++) {
        OK(s, spar_member_set_fidelity(b, kinds[k], 2));
        REFUSED(s, SPAR_ERR_UNSUPPORTED, "spar_beam_set_plane", spar_member_commit(b));
    }
    OK(s, spar_member_set_fidelity(b, SPAR_FIDELITY_EXACT, 0));
    OK(s, spar_member_set_external(b, 1));
    REFUSED(s, SPAR_ERR_UNSUPPORTED, "spar_beam_set_plane", spar_member_commit(b));
    OK(s, spar_member_set_external(b, 0));
    OK(s, spar_member_set_root(b, SPAR_ROOT_DRIVEN));
    OK(s, spar_member_set_initial_velocity(b, NULL, NULL, x + 0));
    OK(s, spar_member_set_initial_velocity(b, NULL, x, NULL));
    REFUSED(s, SPAR_ERR_ARGUMENT, "plane", spar_member_commit(b));
    OK(s, spar_member_set_initial_velocity(b, NULL, NULL, NULL));
    OK(s, spar_member_commit(b));
    REFUSED(s, SPAR_ERR_STATE, "committed", spar_beam_set_plane(b, NULL));
    REFUSED(s, SPAR_ERR_ARGUMENT, "plane", spar_member_set_initial_velocity(b, NULL, x, NULL));
    REFUSED(s, SPAR_ERR_ARGUMENT, "plane", spar_member_set_initial_velocity(b, NULL, NULL, five));
    REFUSED(s, SPAR_ERR_ARGUMENT, "plane", spar_member_drive(b, off, NULL, NULL));
    REFUSED(s, SPAR_ERR_ARGUMENT, "plane", spar_member_drive(b, tilt, NULL, NULL));
    REFUSED(s, SPAR_ERR_ARGUMENT, "plane", spar_member_drive(b, in_plane, up, NULL));
    REFUSED(s, SPAR_ERR_ARGUMENT, "plane", spar_member_drive(b, in_plane, rest, up));
    OK(s, spar_member_drive(b, in_plane, rest, rest)); /* rounding of the host is removed */
    OK(s, spar_member_commit(point));
    OK(s, spar_joint_create(s, "hinge", b, NODES - 1, NULL, 0, SPAR_FREE_X, &joint));
    REFUSED(s, SPAR_ERR_UNSUPPORTED, "spar_beam_set_plane", spar_step_begin(s, 0.1));
    spar_session_destroy(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_pressure), cmocka_unit_test(test_as_the_free_beam),
        cmocka_unit_test(test_roots),    cmocka_unit_test(test_statics),
        cmocka_unit_test(test_modes),    cmocka_unit_test(test_saved),
        cmocka_unit_test(test_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
