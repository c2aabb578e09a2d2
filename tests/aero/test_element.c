/* One blade element: closed forms of its loads, and that they turn with the axes and mirror with the rotor. */
#include <math.h>
#include <string.h>

#include "aero/element.h"
#include "base/session.h"
#include "math/rotation.h"
#include <cmocka.h>

#define PI 3.14159265358979323846
enum { ALL = 63, NO_MOMENTUM = SPAR_AERO_DRAG | SPAR_AERO_MOMENT };

static spar_polar *polar;

/* cl odd, cd even, cm odd in alpha: the mirror tests need no more. */
static int set_up(void **state) {
    (void)state;
    double alpha[361], cl[361], cd[361], cm[361];
    for (int i = 0; i < 361; i++) {
        alpha[i] = (i - 180) * PI / 180.0;
        cl[i] = 2.9 * sin(2.0 * alpha[i]);
        cd[i] = 0.01 + 1.2 * sin(alpha[i]) * sin(alpha[i]);
        cm[i] = -0.3 * sin(alpha[i]);
    }
    cl[180] = cm[0] = cm[360] = 0.0;
    return spar_polar_create(361, alpha, cl, cd, cm, &polar) != SPAR_OK;
}

static int tear_down(void **state) {
    (void)state;
    spar_polar_destroy(&polar);
    return 0;
}

/* A section of a blade that points along global z at 30 m, shaft along x, turning at 1 rad/s in 9 m/s wind. */
typedef struct scene {
    spari_rotor rotor;
    double twist, x[3], q[4], v[3], wind[3];
} scene;

static scene scene_of(int effects) {
    scene s = {.rotor = {effects, 1, 3, {0, 0, 0}, {1, 0, 0}, 1.5, 63.0},
               .twist = 0.08,
               .x = {0.3, -0.2, 30.0},
               .wind = {9.0, 0.0, 0.0}};
    /* columns: span z, aft +y (the blade moves along -y: (1,0,0) x (0,0,1)), face -x */
    double r[9] = {0, 0, -1, 0, 1, 0, 1, 0, 0};
    spari_matrix_quat(r, s.q);
    double omega[3] = {1.0, 0.0, 0.0};
    spari_cross(omega, s.x, s.v);
    return s;
}

static spari_element solve(const scene *s) {
    int64_t row = 0;
    spari_section section = {
        .chord = 3.5, .cos_twist = cos(s->twist), .sin_twist = sin(s->twist), .table = spari_polar_share(polar)};
    spari_centre station = {.x = s->x, .q = s->q, .v = s->v, .wind = s->wind, .row = &row};
    station.loss_radius = spari_rotor_radius(&s->rotor, s->x);
    spari_element e;
    spari_elements_solve(&s->rotor, 8, 1, (const spari_section *[]){&section}, &station, 1.225, &e);
    spari_table_release(section.table);
    return e;
}

/* Without momentum theory: the wind triangle in the plane of the section. With vx = 9, vy = 30 (the swept place has the
   span's 30 m in its plane), tan phi = 0.3, alpha = phi - twist; lift across the flow downwind and forward, drag along
   it, moment nose up about the span. Closed form with the polar's own rows, to rounding. */
static void test_wind_triangle(void **state) {
    (void)state;
    scene s = scene_of(NO_MOMENTUM);
    spari_element e = solve(&s);
    double phi = atan2(9.0, 30.0), speed = hypot(9.0, 30.0), cl, cd, cm, q = 0.5 * 1.225 * speed * speed * 3.5;
    assert_true(fabs(e.alpha - (phi - 0.08)) < 1e-15);
    assert_int_equal(spar_polar_evaluate(polar, phi - 0.08, &cl, &cd, &cm), SPAR_OK);
    assert_true(fabs(e.cl - cl) < 1e-14 && fabs(e.cd - cd) < 1e-14 && e.a == 0.0 && e.a_tangential == 0.0);
    double down = q * (cl * cos(phi) + cd * sin(phi)), ahead = q * (cl * sin(phi) - cd * cos(phi));
    assert_true(fabs(e.load[0] - down) < 1e-12 * q && fabs(e.load[1] + ahead) < 1e-12 * q &&
                fabs(e.load[2]) < 1e-12 * q);
    assert_true(fabs(e.load[5] - q * 3.5 * cm) < 1e-12 * q && fabs(e.load[3]) + fabs(e.load[4]) < 1e-12 * q);
    s.rotor.effects = 0; /* lift alone */
    e = solve(&s);
    assert_true(e.cd == 0.0 && e.load[5] == 0.0 && fabs(e.load[0] - q * cl * cos(phi)) < 1e-12 * q);
}

/* Drag without induction is rho/2 c |W| cd W, along the wind W = (9, 30, 0) that the section meets: of the power per
   length it takes rho/2 c |W| cd 30^2. Nothing else changes. */
static void test_drag(void **state) {
    (void)state;
    scene s = scene_of(SPAR_AERO_DRAG);
    spari_element with = solve(&s);
    s.rotor.effects = 0;
    spari_element without = solve(&s);
    double wind[3] = {9.0, 30.0, 0.0}, scale = 0.5 * 1.225 * 3.5 * hypot(9.0, 30.0) * with.cd, power = 0.0;
    for (int i = 0; i < 3; i++) {
        double d = with.load[i] - without.load[i];
        assert_true(fabs(d - scale * wind[i]) < 1e-12 * scale * 30.0);
        power += d * s.v[i];
    }
    assert_true(fabs(power + scale * 900.0) < 1e-11 * scale * 900.0);
    assert_true(with.cd > 0.01 && without.cd == 0.0 && with.cl == without.cl && with.alpha == without.alpha);
}

/* A twist by tau is the section's frame turned by minus tau about its x: more twist, less angle of attack. */
static void test_twist_is_a_turn(void **state) {
    (void)state;
    scene s = scene_of(ALL), t = s;
    double psi[3] = {-0.11, 0.0, 0.0}, turn[4];
    s.twist += 0.11;
    spari_quat_exp(psi, turn);
    spari_quat_mul(t.q, turn, t.q);
    spari_element a = solve(&s), b = solve(&t);
    assert_true(a.alpha < 0.19 && fabs(a.alpha - b.alpha) < 1e-13);
    for (int i = 0; i < 6; i++) {
        assert_true(fabs(a.load[i] - b.load[i]) < 1e-9); /* of some 1000 N/m: 1e-12 of it */
    }
}

static void turn_scene(const double turn[4], scene *s) {
    double *vector[] = {s->rotor.hub, s->rotor.axis, s->x, s->v, s->wind};
    for (int i = 0; i < 5; i++) {
        spari_rotate(turn, vector[i], vector[i]);
    }
    spari_quat_mul(turn, s->q, s->q);
}

/* The whole set-up turned by any rotation gives turned loads, to 1e-12 of their size. */
static void test_turned(void **state) {
    (void)state;
    for (int i = 0; i < 50; i++) {
        scene s = scene_of(ALL), t = s;
        double psi[3] = {sin(7.0 * i), 2.0 * sin(5.0 * i), 3.0 * cos(3.0 * i)}, turn[4], load[6];
        s.wind[1] = t.wind[1] = 2.0;
        s.wind[2] = t.wind[2] = -1.0;
        spari_quat_exp(psi, turn);
        turn_scene(turn, &t);
        spari_element a = solve(&s), b = solve(&t);
        spari_rotate(turn, a.load, load);
        spari_rotate(turn, a.load + 3, load + 3);
        double size = spari_norm(a.load);
        assert_true(size > 900.0 && fabs(a.alpha - b.alpha) < 1e-12 && fabs(a.a - b.a) < 1e-12);
        for (int c = 0; c < 6; c++) {
            assert_true(fabs(load[c] - b.load[c]) < 2e-12 * size);
        }
    }
}

/* The mirror image in the plane y = 0 of a rotor, its blades, motion and wind turns left-handed; its section frames (x,
   y mirrored; z minus the mirror image, so as to stay right-handed) need turn -1. Forces mirror, moments mirror with
   the other sign. */
static void test_left_handed(void **state) {
    (void)state;
    scene s = scene_of(ALL);
    s.wind[1] = 3.0, s.x[1] = 1.0;
    scene t = s;
    t.rotor.turn = -1;
    t.wind[1] = -3.0, t.x[1] = -1.0, t.v[1] = -s.v[1];
    double r[9] = {0, 0, 1, 0, -1, 0, 1, 0, 0}; /* span z, aft -y, z = +x: the suction side */
    spari_matrix_quat(r, t.q);
    spari_element a = solve(&s), b = solve(&t);
    static const double sign[] = {1, -1, 1, -1, 1, -1};
    assert_true(fabs(a.alpha - b.alpha) < 1e-13 && fabs(a.a - b.a) < 1e-12 && a.a > 0.04);
    for (int c = 0; c < 6; c++) {
        assert_true(fabs(sign[c] * a.load[c] - b.load[c]) < 1e-12 * spari_norm(a.load));
    }
}

/* On the tip and hub radius the loss factor is 0: blocked, no swirl, flagged; a hair beside it solves again and is
   finite. Without that loss the same place is an ordinary one. */
static void test_ends(void **state) {
    (void)state;
    static const double radius[] = {63.0, 62.0, 1.5, 1.6, 64.0, 1.0}, blocked[] = {1, 0, 1, 0, 1, 1};
    for (int i = 0; i < 6; i++) {
        scene s = scene_of(ALL);
        double omega[3] = {1.0, 0.0, 0.0}, x[3] = {0.0, 0.0, radius[i]};
        memcpy(s.x, x, sizeof x);
        spari_cross(omega, s.x, s.v);
        spari_element e = solve(&s);
        assert_int_equal(e.flags, blocked[i] != 0.0 ? SPAR_AERO_FLAG_END : 0);
        assert_true(isfinite(spari_norm(e.load)) && (blocked[i] == 0.0 || (e.a == 1.0 && e.a_tangential == 0.0)));
        s.rotor.effects = ALL & ~(SPAR_AERO_TIP_LOSS | SPAR_AERO_HUB_LOSS);
        e = solve(&s);
        assert_int_equal(e.flags, 0);
        assert_true(isfinite(spari_norm(e.load)) && e.a < 0.999);
    }
}

/* Standing still in calm air, in wind, turning in calm air, backwards, wind from behind: finite loads, drag against
 * what moves. */
static void test_corners(void **state) {
    (void)state;
    static const double wind[] = {0.0, 9.0, -9.0, 1e-9, 80.0}, speed[] = {0.0, 1.0, -1.0, 1e-9, 5.0};
    for (int i = 0; i < 5; i++) {
        for (int j = 0; j < 5; j++) {
            scene s = scene_of(ALL);
            double omega[3] = {speed[j], 0.0, 0.0};
            s.wind[0] = wind[i];
            spari_cross(omega, s.x, s.v);
            spari_element e = solve(&s);
            assert_true(isfinite(e.alpha) && isfinite(e.a) && isfinite(e.a_tangential) && isfinite(spari_norm(e.load)));
            assert_true((wind[i] != 0.0 || speed[j] != 0.0) || spari_norm(e.load) == 0.0);
            double relative[3] = {s.wind[0] - s.v[0], -s.v[1], -s.v[2]};
            assert_true(spari_dot(relative, e.load) >= 0.0 || speed[j] > 0.0);
        }
    }
    scene s = scene_of(ALL); /* span along the shaft: no disc, flagged, solved without induction */
    double r[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    spari_matrix_quat(r, s.q);
    assert_int_equal(solve(&s).flags, SPAR_AERO_FLAG_NO_ROOT);
    s = scene_of(ALL); /* on the axis itself */
    memset(s.x, 0, sizeof s.x);
    s.rotor.effects = ALL & ~SPAR_AERO_HUB_LOSS;
    assert_int_equal(solve(&s).flags, SPAR_AERO_FLAG_NO_ROOT);
}

/* Eight elements side by side have the bits of each alone: yawed wind, stall, reversed motion, calm air, an element at
   the tip. */
static void test_side_by_side(void **state) {
    (void)state;
    scene s[SPARI_ANNULI];
    spari_section section = {.chord = 3.5, .cos_twist = 1.0, .table = spari_polar_share(polar)};
    const spari_section *sections[SPARI_ANNULI];
    spari_centre station[SPARI_ANNULI];
    int64_t row[SPARI_ANNULI] = {0};
    spari_element all[SPARI_ANNULI], alone;
    for (int l = 0; l < SPARI_ANNULI; l++) {
        double omega[3] = {l == 2 ? -1.0 : l == 4 ? 0.05 : 1.0, 0.0, 0.0};
        s[l] = scene_of(ALL);
        s[l].x[2] = l == 5 ? 63.0 : 4.0 + 7.0 * l;
        s[l].wind[0] = l == 3 ? 0.0 : 3.0 * l;
        s[l].wind[1] = l - 4.0;
        spari_cross(omega, s[l].x, s[l].v);
        sections[l] = &section;
        station[l] = (spari_centre){.x = s[l].x, .q = s[l].q, .v = s[l].v, .wind = s[l].wind, .row = row + l};
        station[l].loss_radius = spari_rotor_radius(&s[l].rotor, s[l].x);
    }
    for (int count = 1; count <= SPARI_ANNULI; count++) {
        spari_elements_solve(&s[0].rotor, 8, count, sections, station, 1.225, all);
        for (int l = 0; l < count; l++) {
            spari_elements_solve(&s[0].rotor, 2, 1, sections + l, station + l, 1.225, &alone);
            assert_int_equal(all[l].flags, alone.flags);
            assert_memory_equal(&all[l].alpha, &alone.alpha, 5 * sizeof alone.alpha);
            assert_memory_equal(all[l].load, alone.load, sizeof alone.load);
        }
    }
    assert_int_equal(all[5].flags, SPAR_AERO_FLAG_END);
    spari_table_release(section.table);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_wind_triangle),   cmocka_unit_test(test_drag),
                                       cmocka_unit_test(test_twist_is_a_turn), cmocka_unit_test(test_turned),
                                       cmocka_unit_test(test_left_handed),     cmocka_unit_test(test_ends),
                                       cmocka_unit_test(test_corners),         cmocka_unit_test(test_side_by_side)};
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
