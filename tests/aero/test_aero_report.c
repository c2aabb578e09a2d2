/* What blade element effects are worth, by trials: what theory says of drag and losses, and that nothing stays changed.
 */
#include "scene.h"
#include "trials.h"

#include <nrel5mw.h>
#include <spar/spar_aero.h>
#include <stdio.h>

enum { N = 9, ROOM = 19 };
static const double pi = 3.14159265358979323846, rho = 1.225, dt = 0.01, chord = 0.1, U = 10, cl = 0.8, cd = 0.1;

/* A wing of constant chord and coefficients, at rest in a wind along y: lift along -z (section frame x along the span,
   y from leading to trailing edge, z = x cross y towards the pressure side), drag along y. */
typedef struct scene {
    spar_session *s;
    spar_member *wing;
    spar_fluid *fluid;
    spar_polar *polar;
    spar_aero *aero;
    double wind[ROOM][3];
    int calls, fails_at;
} scene;

static int solve(spar_session *s, double t, double step, int iteration, void *context) {
    scene *c = context;
    (void)s, (void)t, (void)step, (void)iteration;
    return ++c->calls == c->fails_at ? 7 : spar_aero_solve(c->aero, rho, c->wind[0], 1);
}

static void build(scene *c, const double *cm) {
    const double alpha[2] = {-pi, pi}, lift[2] = {cl, cl}, drag[2] = {cd, cd};
    double K[36], M[36], eta[N];
    *c = (scene){.s = scene_session()};
    scene_explicit(c->s); /* calls of the solver are counted */
    scene_diagonal(K, 1e6, 1e6, 1e6, 1e4, 1e4, 1e4);
    scene_diagonal(M, 1, 1, 1, 2e-3, 1e-3, 1e-3);
    c->wing = scene_beam(c->s, "wing", 1, 6, 2, K, M);
    OK(c->s, spar_member_commit(c->wing));
    OK(c->s, spar_fluid_create(c->wing, "air", &c->fluid));
    for (int i = 0; i < N; i++) {
        eta[i] = 1.0 * i / (N - 1);
        c->wind[i][1] = U;
    }
    OK(c->s, spar_fluid_set_stations(c->fluid, N, eta, NULL));
    OK(c->s, spar_fluid_map(c->fluid));
    OK(c->s, spar_polar_create(2, alpha, lift, drag, cm, &c->polar));
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

/* Loads at rest: without drag the load lacks exactly drag's part, cd of hypot(cl, cd), at every section; force and
   moment alike. The wing has begun to move by the first sample, which changes the angle of attack but no coefficient:
   1e-3. The support's forces lack less or more, as the wing swings. */
static void test_drag(void **state) {
    (void)state;
    scene c;
    double table[SPAR_AERO_ROW_COUNT][COLUMN_COUNT], before[N][3], after[N][3];
    build(&c, NULL);
    OK(c.s, spar_aero_solve(c.aero, rho, c.wind[0], 1));
    OK(c.s, spar_aero_get_loads(c.aero, NULL, before[0], NULL));
    OK(c.s, trial_report_aero(c.aero, c.s, dt, 16, NULL, solve, &c, table[0]));
    const double *drag = table[SPAR_AERO_ROW_DRAG];
    assert_true(drag[COLUMN_IN_FORCE] == 1);
    NEAR(drag[COLUMN_SIZE], cd / hypot(cl, cd), 1e-3);
    NEAR(drag[COLUMN_MOTION], cd / hypot(cl, cd), 0.05);
    NEAR(drag[COLUMN_REACTION], cd / hypot(cl, cd), 0.05);
    for (int r = 0; r < SPAR_AERO_ROW_COUNT; r++) { /* no rotor, and polars without moments */
        assert_true(spar_aero_effect_name(r)[0] != '\0');
        for (int k = 0; k < COLUMN_COUNT && r != SPAR_AERO_ROW_DRAG; k++) {
            assert_true(table[r][k] == 0);
        }
    }
    assert_string_equal(spar_aero_effect_name(SPAR_AERO_ROW_TIP_LOSS), "tip loss");
    assert_string_equal(spar_aero_effect_name(-1), "");
    assert_string_equal(spar_aero_effect_name(SPAR_AERO_ROW_COUNT), "");
    OK(c.s, spar_aero_solve(c.aero, rho, c.wind[0], 1)); /* drag is back, and the wing where it was */
    OK(c.s, spar_aero_get_loads(c.aero, NULL, after[0], NULL));
    assert_memory_equal(before, after, sizeof before);
    release(&c);
}

/* Moments are in force where a polar has some; they turn the tip, and leave forces alone. */
static void test_moment(void **state) {
    (void)state;
    scene c;
    const double cm[2] = {-0.1, -0.1};
    double table[SPAR_AERO_ROW_COUNT][COLUMN_COUNT];
    build(&c, cm);
    OK(c.s, trial_report_aero(c.aero, c.s, dt, 8, NULL, solve, &c, table[0]));
    assert_true(table[SPAR_AERO_ROW_MOMENT][COLUMN_IN_FORCE] == 1);
    /* load: force q c L hypot(cl, cd) and half of that as moment by the length; cm q c^2 L by the length */
    NEAR(table[SPAR_AERO_ROW_MOMENT][COLUMN_SIZE], 0.1 * chord / 2 / (hypot(cl, cd) * hypot(1, 0.5)), 1e-4);
    release(&c);
}

/* A solver that fails in the trial with all: the call says so; in the one without drag, the row does, and the message
   of the earlier failure stays. In both cases drag is there afterwards. */
static void test_failing_solve(void **state) {
    (void)state;
    scene c;
    double table[SPAR_AERO_ROW_COUNT][COLUMN_COUNT] = {{5}}, force[N][3], drag = 0;
    build(&c, NULL);
    for (int fails_at = 4; fails_at <= 12; fails_at += 8) {
        c.calls = 0;
        c.fails_at = fails_at;
        char message[1024];
        (void)snprintf(message, sizeof message, "%s", spar_session_message(c.s));
        int status = trial_report_aero(c.aero, c.s, dt, 8, NULL, solve, &c, table[0]);
        if (fails_at == 4) {
            assert_int_equal(status, SPAR_ERR_USER);
            assert_true(table[0][0] == 5);
        } else {
            assert_int_equal(status, SPAR_OK);
            assert_true(message[0] != '\0');
            assert_string_equal(spar_session_message(c.s), message);
            assert_true(table[SPAR_AERO_ROW_DRAG][COLUMN_IN_FORCE] == 1);
            assert_true(table[SPAR_AERO_ROW_DRAG][COLUMN_MOTION] == -1);
            assert_true(table[SPAR_AERO_ROW_DRAG][COLUMN_REACTION] == -1);
        }
        drag = 0;
        OK(c.s, spar_aero_solve(c.aero, rho, c.wind[0], 1));
        OK(c.s, spar_aero_get_loads(c.aero, NULL, force[0], NULL));
        for (int i = 0; i < N; i++) {
            drag += force[i][1];
        }
        NEAR(drag, 0.5 * rho * U * U * chord * 2 * cd, 1e-12);
    }
    release(&c);
}

/* Sum of the forces on blade 0, and their moment about its root by its length. */
static void sum_loads(const scene *c, const double root[3], double length, double sum[6]) {
    double f[ROOM][3], m[ROOM][3], x[ROOM][3];
    OK(c->s, spar_fluid_pull_motion(c->fluid, 1, x[0], NULL));
    OK(c->s, spar_aero_get_loads(c->aero, NULL, f[0], m[0]));
    memset(sum, 0, 6 * sizeof *sum);
    for (int i = 0; i < ROOM; i++) {
        for (int k = 0; k < 3; k++) {
            int a = (k + 1) % 3, b = (k + 2) % 3;
            sum[k] += f[i][k];
            sum[3 + k] += (m[i][k] + (x[i][a] - root[a]) * f[i][b] - (x[i][b] - root[b]) * f[i][a]) / length;
        }
    }
}

/* A blade of the rotor: what an effect weighs is the change of its loads, found here without a trial; the first step is
   short, the blade just begins to bend: 2 %. Without induction, and without a hub, there are no losses to leave out. */
static void test_rotor(void **state) {
    (void)state;
    static const int bit[] = {SPAR_AERO_INDUCTION, SPAR_AERO_TIP_LOSS, SPAR_AERO_HUB_LOSS, SPAR_AERO_SWIRL,
                              SPAR_AERO_DRAG,      SPAR_AERO_MOMENT,   SPAR_AERO_SHEAR,    SPAR_AERO_TOWER};
    nrel5mw data;
    nrel5mw_rotor rotor;
    scene c = {.s = scene_session()};
    double twist[64], table[SPAR_AERO_ROW_COUNT][COLUMN_COUNT], omega[3], root[3], q[4], all[6], less[6];
    OK(NULL, nrel5mw_load(&data, SPAR_DATA_DIR "/nrel5mw"));
    assert_int_equal(data.aero_n, ROOM);
    nrel5mw_rotor_default(&data, &rotor);
    for (int i = 0; i < 3; i++) {
        omega[i] = 9.16 * pi / 30 * rotor.axis[i];
    }
    OK(c.s, nrel5mw_create_blade(&data, &rotor, c.s, 0, 1, 6, &c.wing));
    OK(c.s, spar_member_set_root(c.wing, SPAR_ROOT_FIXED)); /* before it turns: the wind alone */
    OK(c.s, spar_member_commit(c.wing));
    OK(c.s, nrel5mw_create_sections(&data, &rotor, 0, c.wing, &c.fluid, twist));
    OK(c.s, nrel5mw_create_aero(&data, &rotor, 1, &c.fluid, twist, &c.aero));
    for (int i = 0; i < ROOM; i++) { /* the wind of the turning blade */
        memcpy(c.wind[i], (double[3]){8, -omega[0] * (1.5 + 61.5 * i / (ROOM - 1)), 0}, sizeof c.wind[i]);
    }
    nrel5mw_root(&data, &rotor, 0, 0, root, q);
    int effects = 2 * SPAR_AERO_TOWER - 1;
    const double ground[3] = {0, 0, -90}, base[3] = {0, 0, -90}, top[3] = {8, 0, 200};
    OK(c.s, spar_aero_set_shear(c.aero, SPAR_SHEAR_POWER, ground, (double[3]){0, 0, 1}, 90, 0.2));
    OK(c.s, spar_aero_set_tower(c.aero, base, top, 3, 2));
    OK(c.s, spar_aero_set_effects(c.aero, effects));
    OK(c.s, trial_report_aero(c.aero, c.s, 1e-4, 8, NULL, solve, &c, table[0]));
    OK(c.s, spar_aero_solve(c.aero, rho, c.wind[0], 1));
    sum_loads(&c, root, data.length, all);
    for (int r = 0; r <= SPAR_AERO_ROW_TOWER; r++) {
        double change = 0, size = 0;
        OK(c.s, spar_aero_set_effects(c.aero, effects & ~bit[r]));
        OK(c.s, spar_aero_solve(c.aero, rho, c.wind[0], 1));
        sum_loads(&c, root, data.length, less);
        for (int k = 0; k < 6; k++) {
            change = hypot(change, all[k] - less[k]);
            size = hypot(size, all[k]);
        }
        assert_true(table[r][COLUMN_IN_FORCE] == 1);
        NEAR(table[r][COLUMN_SIZE], change / size, 0.02 * change / size);
    }
    OK(c.s, spar_aero_set_effects(c.aero, effects & ~SPAR_AERO_INDUCTION));
    OK(c.s, trial_report_aero(c.aero, c.s, 1e-4, 8, NULL, solve, &c, table[0]));
    for (int r = 0; r < SPAR_AERO_ROW_COUNT; r++) {
        assert_true(table[r][COLUMN_IN_FORCE] == (r >= SPAR_AERO_ROW_DRAG && r <= SPAR_AERO_ROW_TOWER));
    }
    OK(c.s, spar_aero_set_effects(c.aero, effects));
    OK(c.s, spar_aero_set_rotor(c.aero, rotor.hub, rotor.axis, 0, 63));
    OK(c.s, trial_report_aero(c.aero, c.s, 1e-4, 8, NULL, solve, &c, table[0]));
    assert_true(table[SPAR_AERO_ROW_HUB_LOSS][COLUMN_IN_FORCE] == 0);
    assert_true(table[SPAR_AERO_ROW_TIP_LOSS][COLUMN_IN_FORCE] == 1);
    release(&c);
    nrel5mw_free(&data);
}

static void test_bad_input(void **state) {
    (void)state;
    scene c, other;
    double table[SPAR_AERO_ROW_COUNT][COLUMN_COUNT];
    build(&c, NULL);
    build(&other, NULL);
    assert_int_equal(trial_report_aero(NULL, c.s, dt, 8, NULL, solve, &c, table[0]), SPAR_ERR_ARGUMENT);
    assert_int_equal(trial_report_aero(c.aero, NULL, dt, 8, NULL, solve, &c, table[0]), SPAR_ERR_ARGUMENT);
    assert_int_equal(trial_report_aero(c.aero, other.s, dt, 8, NULL, solve, &c, table[0]), SPAR_ERR_ARGUMENT);
    assert_non_null(strstr(spar_session_message(other.s), "another session"));
    assert_int_equal(trial_report_aero(c.aero, c.s, dt, 8, NULL, NULL, &c, table[0]), SPAR_ERR_STATE);
    assert_non_null(strstr(spar_session_message(c.s), "does not call spar_aero_solve"));
    assert_int_equal(spar_aero_get_effect(c.aero, 0, NULL, NULL, NULL, NULL, NULL, NULL), SPAR_ERR_STATE);
    assert_int_equal(spar_aero_get_effect(c.aero, SPAR_AERO_ROW_COUNT, NULL, NULL, NULL, NULL, NULL, NULL),
                     SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_aero_get_effect(NULL, 0, NULL, NULL, NULL, NULL, NULL, NULL), SPAR_ERR_ARGUMENT);
    assert_int_equal(trial_report_aero(c.aero, c.s, NAN, 8, NULL, solve, &c, table[0]), SPAR_ERR_ARGUMENT);
    assert_int_equal(trial_report_aero(c.aero, c.s, dt, 12, NULL, solve, &c, table[0]), SPAR_ERR_ARGUMENT);
    OK(c.s, spar_step_begin(c.s, dt));
    assert_int_equal(trial_report_aero(c.aero, c.s, dt, 8, NULL, solve, &c, table[0]), SPAR_ERR_STATE);
    OK(c.s, spar_step_reject(c.s));
    OK(c.s, trial_report_aero(c.aero, c.s, dt, 8, NULL, solve, &c, table[0]));
    release(&c);
    release(&other);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_drag),  cmocka_unit_test(test_moment),    cmocka_unit_test(test_failing_solve),
        cmocka_unit_test(test_rotor), cmocka_unit_test(test_bad_input),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
