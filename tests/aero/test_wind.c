/* Wind shear and tower shadow: laws and potential flow in closed form, what sections meet and what switches it, bad
   input. */
#include "scene.h"
#include "trials.h"

#include "aero/wind.h"
#include <complex.h>
#include <spar/spar_aero.h>
#include <string.h>

enum { N = 9 };
static const double pi = 3.14159265358979323846, rho = 1.225, chord = 0.1, U = 10, cl = 0.8, cd = 0.1;

/* ---- laws ---- */

/* The laws' own formulas, by hand: twice the height with exponent 1/2 is sqrt(2); three e-foldings over the roughness
   length against two of the reference is 3/2; 4 m above the reference at 0.05 1/m is 1.2. None below the ground, or
   where a line has come to 0. To rounding. */
static void test_shear_laws(void **state) {
    (void)state;
    spari_shear power = {SPAR_SHEAR_POWER, {0}, {0, 0, 1}, 90, 0.5}, log = {SPAR_SHEAR_LOG, {0}, {0, 0, 1}, 0, 0.03},
                linear = {SPAR_SHEAR_LINEAR, {0}, {0, 0, 1}, 90, 0.05};
    log.height = 0.03 * exp(2);
    NEAR(spari_shear_factor(&power, 90), 1, 0);
    NEAR(spari_shear_factor(&power, 180), sqrt(2), 4e-16);
    NEAR(spari_shear_factor(&power, 22.5), 0.5, 2e-16);
    NEAR(spari_shear_factor(&power, 0), 0, 0);
    NEAR(spari_shear_factor(&power, -5), 0, 0);
    NEAR(spari_shear_factor(&log, log.height), 1, 1e-15);
    NEAR(spari_shear_factor(&log, 0.03 * exp(3)), 1.5, 1e-15);
    NEAR(spari_shear_factor(&log, 0.03), 0, 0);
    NEAR(spari_shear_factor(&log, -1), 0, 0);
    NEAR(spari_shear_factor(&linear, 94), 1.2, 1e-15);
    NEAR(spari_shear_factor(&linear, 70), 0, 1e-15);
    NEAR(spari_shear_factor(&linear, 60), 0, 0);
    power.parameter = 0;
    NEAR(spari_shear_factor(&power, 30), 1, 0);
}

/* ---- tower ---- */

/* A tower along e3 of three axes that stand across each other, in no axis of the frame; radius 3 at the base, 2 at the
   top, 80 m. */
static const double e[3][3] = {{2.0 / 3, 2.0 / 3, 1.0 / 3}, {-2.0 / 3, 1.0 / 3, 2.0 / 3}, {1.0 / 3, -2.0 / 3, 2.0 / 3}};

static spari_wind tower(void) {
    spari_wind w = {.has_tower = 1, .tower = {.length = 80, .base_radius = 3, .top_radius = 2}};
    for (int i = 0; i < 3; i++) {
        w.tower.up[i] = e[2][i];
        w.tower.top[i] = 5.0 + 80 * e[2][i];
    }
    return w;
}

/* The wind `in` (in e's axes) as it is met at (x, y) beside the axis, `below` under the top; in e's axes too. */
static int meet(const spari_wind *w, double x, double y, double below, const double in[3], double out[3]) {
    double at[3], inflow[3], met[3];
    for (int i = 0; i < 3; i++) {
        at[i] = w->tower.top[i] + x * e[0][i] + y * e[1][i] - below * e[2][i];
        inflow[i] = in[0] * e[0][i] + in[1] * e[1][i] + in[2] * e[2][i];
    }
    int flag = spari_wind_meet(w, SPAR_AERO_TOWER, at, inflow, met);
    for (int k = 0; k < 3; k++) {
        out[k] = e[k][0] * met[0] + e[k][1] * met[1] + e[k][2] * met[2];
    }
    return flag;
}

/* Far below the top the flow around a cylinder, whose complex velocity is u - i v = U (1 - R^2 / z^2) for a wind along
   x (any book on potential flow); a wind at an angle turns it. What blows along the tower stays. R at the slice. The
   end is 1e9 radii away: 1e-18 of the change; the rest is rounding: 1e-14 of U. */
static void test_cylinder(void **state) {
    (void)state;
    spari_wind w = tower();
    w.tower.length = 4e9; /* half way down, the radius is 2.5 */
    const double below = 2e9, R = 2.5, angle = 0.6;
    for (int k = 0; k < 24; k++) {
        double r = R * (1.05 + 0.3 * k), turn = 0.7 * k, in[3] = {U * cos(angle), U * sin(angle), 1.5}, out[3];
        double complex z = r * cexp(I * turn), flow = cexp(I * angle);
        double complex velocity = U * (conj(flow) - flow * R * R / (z * z)); /* u - i v */
        assert_int_equal(meet(&w, creal(z), cimag(z), below, in, out), 0);
        /* places 2e9 m from the top are known to 5e-7 m */
        NEAR(out[0], creal(velocity), 2e-6 * U);
        NEAR(out[1], -cimag(velocity), 2e-6 * U);
        NEAR(out[2], 1.5, 2e-6 * U);
    }
}

/* Beside the real tower, 40 m below its top (R = 2.5): the change by (1 + t / hypot(t, rho)) / 2; at the top half of
   it, 40 m above 1e-3 of it. Before the tower at its surface the wind would stop but for that; beside it it doubles. To
   1e-13 of U. */
static void test_end_of_tower(void **state) {
    (void)state;
    spari_wind w = tower();
    const double in[3] = {U, 0, 0};
    static const double below[] = {40, 0, -40};
    for (int k = 0; k < 3; k++) {
        double R = k == 0 ? 2.5 : 2, r = 4, out[3];
        double share = 0.5 * (1 + below[k] / hypot(below[k], r)) * R * R / (r * r);
        assert_int_equal(meet(&w, -r, 0, below[k], in, out), 0);
        NEAR(out[0], U * (1 - share), 1e-13 * U);
        assert_int_equal(meet(&w, 0, r, below[k], in, out), 0);
        NEAR(out[0], U * (1 + share), 1e-13 * U);
        NEAR(out[1], 0, 1e-13 * U);
    }
}

/* Inside the tower there is a flag and no jump: the change falls from that of the surface to none at the axis, as the
   square of the distance. Above the top nothing is inside. */
static void test_inside_the_tower(void **state) {
    (void)state;
    spari_wind w = tower();
    const double in[3] = {U, 0, 0};
    double near[3], far[3], out[3];
    assert_int_equal(meet(&w, -2.5 * (1 - 1e-9), 0, 40, in, near), SPAR_AERO_FLAG_TOWER);
    assert_int_equal(meet(&w, -2.5 * (1 + 1e-9), 0, 40, in, far), 0);
    NEAR(near[0], far[0], 1e-7 * U);
    assert_int_equal(meet(&w, 0, 0, 40, in, out), SPAR_AERO_FLAG_TOWER);
    NEAR(out[0], U, 1e-13 * U);
    assert_int_equal(meet(&w, 1.25, 0, 40, in, out), SPAR_AERO_FLAG_TOWER);
    NEAR(out[0], U * (1 - 0.25 * 0.5 * (1 + 40 / hypot(40, 1.25))), 1e-13 * U);
    assert_int_equal(meet(&w, 0, 0, 0, in, out), 0);
    assert_int_equal(meet(&w, 0, 0, -1, in, out), 0);
    NEAR(out[0], U, 1e-13 * U);
}

/* ---- through the library ---- */

/* A rigid wing 2 m along x on a point that is driven, in a wind along y; coefficients that do not depend on the angle:
   loads go with the square of the wind. */
typedef struct scene {
    spar_session *s;
    spar_member *point;
    spar_fluid *fluid;
    spar_polar *polar;
    spar_aero *aero;
    double wind[N][3];
} scene;

static void build(scene *c) {
    const double alpha[2] = {-pi, pi}, lift[2] = {cl, cl}, drag[2] = {cd, cd};
    double eta[N] = {0}, offset[N][3] = {{0}};
    *c = (scene){.s = scene_session()};
    OK(c->s, spar_point_create(c->s, "wing", NULL, NULL, &c->point));
    OK(c->s, spar_member_commit(c->point));
    OK(c->s, spar_fluid_create(c->point, "air", &c->fluid));
    for (int i = 0; i < N; i++) {
        offset[i][0] = 2.0 * i / (N - 1);
        c->wind[i][1] = U;
    }
    OK(c->s, spar_fluid_set_stations(c->fluid, N, eta, offset[0]));
    OK(c->s, spar_fluid_map(c->fluid));
    OK(c->s, spar_polar_create(2, alpha, lift, drag, NULL, &c->polar));
    OK(c->s, spar_aero_create(1, &c->fluid, &c->aero));
    for (int i = 0; i < N; i++) {
        OK(c->s, spar_aero_set_section(c->aero, i, chord, 0, c->polar));
    }
}

static void release(scene *c) {
    spar_aero_destroy(&c->aero);
    spar_polar_destroy(&c->polar);
    spar_session_destroy(&c->s);
}

static int blow(spar_session *s, double t, double dt, int iteration, void *context) {
    scene *c = context;
    (void)s, (void)t, (void)dt, (void)iteration;
    return spar_aero_solve(c->aero, rho, c->wind[0], 1);
}

/* The lift per length, -z. */
static void lifts(scene *c, double lift[N]) {
    double load[N][6];
    OK(c->s, spar_aero_get_loads(c->aero, load[0], NULL, NULL));
    for (int i = 0; i < N; i++) {
        lift[i] = -load[i][2];
    }
}

/* Heights are measured along the wing, its root 1 m above the ground: the lift at x is q c cl (1 + x)^(2 p), reference
   1 m, to 1e-14. After a step that takes the wing up by 3 m it is that of 4 + x: places are those now. */
static void test_wing_in_shear(void **state) {
    (void)state;
    scene c;
    const double ground[3] = {-1, 4, -7}, up[3] = {3, 0, 0}, p = 0.2, q = 0.5 * rho * U * U * chord * cl;
    double lift[N], to[7] = {3, 0, 0, 1, 0, 0, 0};
    build(&c);
    OK(c.s, spar_aero_set_shear(c.aero, SPAR_SHEAR_POWER, ground, up, 1, p));
    OK(c.s, spar_aero_solve(c.aero, rho, c.wind[0], 1));
    lifts(&c, lift);
    for (int i = 0; i < N; i++) {
        NEAR(lift[i], q * pow(1 + 2.0 * i / (N - 1), 2 * p), 1e-14 * q);
    }
    OK(c.s, spar_member_drive(c.point, to, NULL, NULL));
    OK(c.s, spar_step(c.s, 0.1, blow, &c, NULL));
    lifts(&c, lift);
    for (int i = 0; i < N; i++) {
        NEAR(lift[i], q * pow(4 + 2.0 * i / (N - 1), 2 * p), 1e-14 * q);
    }
    release(&c);
}

/* A tower of 1 m radius 4 m behind the wing's root, along x: at the root, where the tower ends, the wind is U (1 -
   1/32); 1 m along it is under the top by that. Shear first: the tower parts the wind that there is. To 1e-13. */
static void test_wing_before_tower(void **state) {
    (void)state;
    scene c;
    const double base[3] = {90, 4, 0}, top[3] = {0, 4, 0}, ground[3] = {-1, 0, 0}, up[3] = {1, 0, 0},
                 q = 0.5 * rho * U * U * chord * cl;
    double lift[N];
    build(&c);
    OK(c.s, spar_aero_set_tower(c.aero, base, top, 1, 1));
    for (int shear = 0; shear <= 1; shear++) {
        if (shear) {
            OK(c.s, spar_aero_set_shear(c.aero, SPAR_SHEAR_LINEAR, ground, up, 1, 0.5));
        }
        OK(c.s, spar_aero_solve(c.aero, rho, c.wind[0], 1));
        lifts(&c, lift);
        for (int i = 0; i < N; i++) {
            double x = 2.0 * i / (N - 1), left = 1 - 0.5 * (1 + x / hypot(x, 4)) / 16, wind = shear ? 1 + 0.5 * x : 1;
            NEAR(lift[i], q * wind * wind * left * left, 1e-13 * q);
        }
    }
    release(&c);
}

/* Described and switched off gives the bits of never described; a section inside of the tower is flagged when it is on
   and by nothing else. */
static void test_off(void **state) {
    (void)state;
    scene c;
    const double ground[3] = {-5, 0, 0}, up[3] = {1, 0, 0}, base[3] = {90, 0, 0}, top[3] = {1, 0, 0};
    double never[N][6], off[N][6], lift[N];
    int flags[N];
    build(&c);
    OK(c.s, spar_aero_solve(c.aero, rho, c.wind[0], 1));
    OK(c.s, spar_aero_get_loads(c.aero, never[0], NULL, NULL));
    OK(c.s, spar_aero_set_shear(c.aero, SPAR_SHEAR_POWER, ground, up, 1, 0.2));
    OK(c.s, spar_aero_set_tower(c.aero, base, top, 1, 0.5));
    OK(c.s, spar_aero_solve(c.aero, rho, c.wind[0], 1));
    OK(c.s, spar_aero_get_flags(c.aero, flags, NULL));
    lifts(&c, lift);
    for (int i = 0; i < N; i++) { /* on the axis of the tower from x = 1 on, below the top from behind it */
        assert_int_equal(flags[i], 2.0 * i / (N - 1) > 1 ? SPAR_AERO_FLAG_TOWER : 0);
        assert_true(fabs(lift[i] + never[i][2]) > 0.1 * fabs(never[i][2]));
    }
    OK(c.s, spar_aero_set_effects(c.aero, SPAR_AERO_DRAG));
    OK(c.s, spar_aero_solve(c.aero, rho, c.wind[0], 1));
    OK(c.s, spar_aero_get_loads(c.aero, off[0], NULL, NULL));
    OK(c.s, spar_aero_get_flags(c.aero, flags, NULL));
    assert_memory_equal(never, off, sizeof off);
    for (int i = 0; i < N; i++) {
        assert_int_equal(flags[i], 0);
    }
    release(&c);
}

/* The report by trials: a wing at twice the reference height with exponent 1/4 has loads sqrt(2) times those without
   shear, which is a change of 1 - 1/sqrt(2) of them; the tower far to the side, 8 radii below its top's height of none:
   (1 + s)^2 of the lift with s = 1/64, a change of 1 - 1/(1 + s)^2. Both at once: the other factor cancels. To 1e-3,
   since the wing's top is 1e4 m below the tower's. */
static void test_report(void **state) {
    (void)state;
    scene c;
    const double ground[3] = {0, 0, -20}, up[3] = {0, 0, 1}, base[3] = {1e5, 0, 8}, top[3] = {-1e4, 0, 8};
    double table[SPAR_AERO_ROW_COUNT][COLUMN_COUNT], s = 1.0 / 64;
    build(&c);
    OK(c.s, spar_aero_set_shear(c.aero, SPAR_SHEAR_POWER, ground, up, 10, 0.25));
    OK(c.s, spar_aero_set_tower(c.aero, base, top, 1, 1));
    OK(c.s, trial_report_aero(c.aero, c.s, 0.1, 8, NULL, blow, &c, table[0]));
    assert_true(table[SPAR_AERO_ROW_SHEAR][COLUMN_IN_FORCE] == 1);
    assert_true(table[SPAR_AERO_ROW_TOWER][COLUMN_IN_FORCE] == 1);
    NEAR(table[SPAR_AERO_ROW_SHEAR][COLUMN_SIZE], 1 - 1 / sqrt(2), 1e-6);
    NEAR(table[SPAR_AERO_ROW_TOWER][COLUMN_SIZE], 1 - 1 / ((1 + s) * (1 + s)), 1e-6);
    assert_string_equal(spar_aero_effect_name(SPAR_AERO_ROW_SHEAR), "wind shear");
    assert_string_equal(spar_aero_effect_name(SPAR_AERO_ROW_TOWER), "tower shadow");
    OK(c.s, spar_aero_set_effects(c.aero, SPAR_AERO_DRAG));
    OK(c.s, trial_report_aero(c.aero, c.s, 0.1, 8, NULL, blow, &c, table[0]));
    assert_true(table[SPAR_AERO_ROW_SHEAR][COLUMN_IN_FORCE] == 0);
    assert_true(table[SPAR_AERO_ROW_TOWER][COLUMN_IN_FORCE] == 0);
    release(&c);
}

/* Each refusal names what is wrong and leaves the object as it was: the same bits afterwards. */
static void test_bad_input(void **state) {
    (void)state;
    scene c;
    const double zero[3] = {0}, up[3] = {0, 0, 1}, bad[3] = {0, NAN, 0}, top[3] = {0, 0, 9},
                 huge[3] = {1.7e308, 1.7e308, 0};
    double before[N][6], after[N][6];
    build(&c);
    OK(c.s, spar_aero_solve(c.aero, rho, c.wind[0], 1));
    OK(c.s, spar_aero_get_loads(c.aero, before[0], NULL, NULL));
    REFUSED(c.s, SPAR_ERR_ARGUMENT, "law 3 is not known", spar_aero_set_shear(c.aero, 3, zero, up, 10, 0.2));
    REFUSED(c.s, SPAR_ERR_ARGUMENT, "law -1 is not known", spar_aero_set_shear(c.aero, -1, zero, up, 10, 0.2));
    REFUSED(c.s, SPAR_ERR_ARGUMENT, "NULL", spar_aero_set_shear(c.aero, 0, NULL, up, 10, 0.2));
    REFUSED(c.s, SPAR_ERR_ARGUMENT, "not finite", spar_aero_set_shear(c.aero, 0, bad, up, 10, 0.2));
    REFUSED(c.s, SPAR_ERR_ARGUMENT, "the upward direction has length 0",
            spar_aero_set_shear(c.aero, 0, zero, zero, 10, 0.2));
    REFUSED(c.s, SPAR_ERR_ARGUMENT, "upward direction", spar_aero_set_shear(c.aero, 0, zero, bad, 10, 0.2));
    REFUSED(c.s, SPAR_ERR_ARGUMENT, "reference height is 0", spar_aero_set_shear(c.aero, 0, zero, up, 0, 0.2));
    REFUSED(c.s, SPAR_ERR_ARGUMENT, "reference height", spar_aero_set_shear(c.aero, 0, zero, up, INFINITY, 0.2));
    REFUSED(c.s, SPAR_ERR_ARGUMENT, "exponent -0.2", spar_aero_set_shear(c.aero, 0, zero, up, 10, -0.2));
    REFUSED(c.s, SPAR_ERR_ARGUMENT, "parameter", spar_aero_set_shear(c.aero, 0, zero, up, 10, NAN));
    REFUSED(c.s, SPAR_ERR_ARGUMENT, "roughness length 10", spar_aero_set_shear(c.aero, 1, zero, up, 10, 10));
    REFUSED(c.s, SPAR_ERR_ARGUMENT, "roughness length 0", spar_aero_set_shear(c.aero, 1, zero, up, 10, 0));
    REFUSED(c.s, SPAR_ERR_ARGUMENT, "NULL", spar_aero_set_tower(c.aero, zero, NULL, 1, 1));
    REFUSED(c.s, SPAR_ERR_ARGUMENT, "not finite", spar_aero_set_tower(c.aero, zero, bad, 1, 1));
    REFUSED(c.s, SPAR_ERR_ARGUMENT, "from base to top has length 0", spar_aero_set_tower(c.aero, top, top, 1, 1));
    REFUSED(c.s, SPAR_ERR_ARGUMENT, "from base to top", spar_aero_set_tower(c.aero, zero, huge, 1, 1));
    REFUSED(c.s, SPAR_ERR_ARGUMENT, "radii 0", spar_aero_set_tower(c.aero, zero, top, 0, 1));
    REFUSED(c.s, SPAR_ERR_ARGUMENT, "radii 1", spar_aero_set_tower(c.aero, zero, top, 1, NAN));
    assert_int_equal(spar_aero_set_shear(NULL, 0, zero, up, 10, 0.2), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_aero_set_tower(NULL, zero, top, 1, 1), SPAR_ERR_ARGUMENT);
    OK(c.s, spar_aero_solve(c.aero, rho, c.wind[0], 1));
    OK(c.s, spar_aero_get_loads(c.aero, after[0], NULL, NULL));
    assert_memory_equal(before, after, sizeof before);
    OK(c.s, spar_aero_set_effects(c.aero, SPAR_AERO_SHEAR));
    REFUSED(c.s, SPAR_ERR_STATE, "spar_aero_set_shear", spar_aero_solve(c.aero, rho, c.wind[0], 1));
    OK(c.s, spar_aero_set_effects(c.aero, SPAR_AERO_TOWER));
    REFUSED(c.s, SPAR_ERR_STATE, "spar_aero_set_tower", spar_aero_solve(c.aero, rho, c.wind[0], 1));
    release(&c);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_shear_laws),    cmocka_unit_test(test_cylinder),
        cmocka_unit_test(test_end_of_tower),  cmocka_unit_test(test_inside_the_tower),
        cmocka_unit_test(test_wing_in_shear), cmocka_unit_test(test_wing_before_tower),
        cmocka_unit_test(test_off),           cmocka_unit_test(test_report),
        cmocka_unit_test(test_bad_input),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
