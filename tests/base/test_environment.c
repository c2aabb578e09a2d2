/* The host's surroundings: floating-point traps raise no signal and are there again, also inside its own callbacks;
   flags and rounding stay; numbers are read and written with a point. */
#include "base/environment.h"
#include "scene.h"

#include <fenv.h>
#include <locale.h>
#include <stdio.h>

#ifdef __GLIBC__ /* declared for _GNU_SOURCE only */
extern int feenableexcept(int exceptions);
extern int fedisableexcept(int exceptions);
extern int fegetexcept(void);
#else
#define feenableexcept(x) ((void)(x))
#define fedisableexcept(x) ((void)(x))
#define fegetexcept() TRAPS
#endif

enum { TRAPS = FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW };

/* Many ARM processors cannot trap, nor can their emulator. */
static void skip_without_traps(void) {
    if (fegetexcept() != TRAPS) {
        skip();
    }
}

/* The call answers the status, and the host's traps are there as before. */
#define ANSWERS(wanted, call)                                                                                          \
    do {                                                                                                               \
        assert_int_equal(call, wanted);                                                                                \
        assert_int_equal(fegetexcept(), TRAPS);                                                                        \
    } while (0)

static int traps_on(void **state) {
    (void)state;
    feclearexcept(FE_ALL_EXCEPT);
    feenableexcept(TRAPS);
    return 0;
}

static int traps_off(void **state) {
    (void)state;
    fedisableexcept(TRAPS);
    feclearexcept(FE_ALL_EXCEPT);
    return 0;
}

typedef struct host {
    spar_fluid *fluid;
    double push;
    int seen;
} host;

static int solve(spar_session *s, double t, double dt, int iteration, void *context) {
    host *h = context;
    double f[3] = {0, h->push, 0};
    (void)s, (void)t, (void)dt, (void)iteration;
    h->seen |= fegetexcept() == TRAPS ? 1 : 2;
    return spar_fluid_push_forces(h->fluid, f, NULL);
}

static void before_log(const spar_session *s, int level, const char *text, void *context) {
    (void)s, (void)level, (void)text;
    *(int *)context |= fegetexcept() == TRAPS ? 1 : 2;
}

/* What is not finite is refused, what runs beyond the range of numbers is a failure, and both are statuses. */
static void test_traps(void **state) {
    (void)state;
    skip_without_traps();
    const double nan3[3] = {0, NAN, 0}, inf6[6] = {INFINITY}, huge[6] = {0, 1e200, 0, 0, 0, 1e200};
    double K[36], M[36], x[3] = {10, 0, 0}, frequency[2], found[6];
    host h = {NULL, 0, 0};
    int logged = 0;
    spar_session *s = scene_session();
    OK(s, spar_session_set_log(s, before_log, &logged));
    scene_box(K, M);
    spar_member *b = scene_beam(s, "b", 1, 5, 10, K, M);
    ANSWERS(SPAR_ERR_ARGUMENT, spar_session_set_gravity(s, nan3));
    ANSWERS(SPAR_ERR_ARGUMENT, spar_session_set_option(s, "coupling.filter", "nan"));
    ANSWERS(SPAR_ERR_ARGUMENT, spar_session_set_newton(s, NAN, NAN, 3));
    ANSWERS(SPAR_ERR_ARGUMENT, spar_beam_set_damping(b, inf6));
    OK(s, spar_member_commit(b));
    OK(s, spar_fluid_create(b, "f", &h.fluid));
    OK(s, spar_fluid_set_force_nodes(h.fluid, 1, x));
    OK(s, spar_fluid_map(h.fluid));
    ANSWERS(SPAR_ERR_ARGUMENT, spar_member_set_load(b, 4, SPAR_LOAD_DEAD, inf6));
    ANSWERS(SPAR_ERR_ARGUMENT, spar_step_begin(s, NAN));
    h.push = NAN;
    assert_int_not_equal(spar_step(s, 0.01, solve, &h, NULL), SPAR_OK);
    h.push = 1;
    ANSWERS(SPAR_OK, spar_step(s, 0.01, solve, &h, NULL));
    OK(s, spar_member_set_load(b, 4, SPAR_LOAD_DEAD, huge));
    ANSWERS(SPAR_ERR_NUMERIC, spar_step(s, 0.01, solve, &h, NULL));
    OK(s, spar_member_get_loads(b, K)); /* room enough */
    (void)spar_member_solve_modes(b, 2, frequency, NULL);
    (void)spar_member_get_reaction(b, found);
    (void)spar_member_get_energy(b, 4, found);
    assert_int_equal(fegetexcept(), TRAPS);
    assert_int_equal(h.seen, 1);
    assert_int_equal(logged, 1);
    assert_int_equal(fetestexcept(TRAPS), 0);
    spar_session_destroy(&s);
}

/* A static load that no equilibrium bears: Newton runs away, and says so. */
static void test_static(void **state) {
    (void)state;
    skip_without_traps();
    double K[36], M[36], load[6] = {0, 0, 1e150};
    spar_session *s = scene_session();
    scene_box(K, M);
    spar_member *b = scene_beam(s, "b", 1, 5, 10, K, M);
    OK(s, spar_member_commit(b));
    OK(s, spar_member_set_load(b, 4, SPAR_LOAD_DEAD, load));
    ANSWERS(SPAR_ERR_NUMERIC, spar_member_solve_static(b, 1));
    spar_session_destroy(&s);
}

/* Flags that the host has raised are there afterwards, others are not; so is its rounding. */
static void test_flags(void **state) {
    (void)state;
    double K[36], M[36];
    scene_box(K, M);
    assert_int_equal(fesetround(FE_UPWARD), 0);
    feclearexcept(FE_ALL_EXCEPT);
    feraiseexcept(FE_UNDERFLOW);
    int raised = fetestexcept(FE_ALL_EXCEPT);
    spar_session *s = scene_session();
    spar_member *b = scene_beam(s, "b", 1, 5, 10, K, M);
    OK(s, spar_member_commit(b));
    scene_run(s, 0.01, 2);
    assert_int_equal(fetestexcept(FE_ALL_EXCEPT), raised);
    assert_int_equal(fegetround(), FE_UPWARD);
    assert_int_equal(fesetround(FE_TONEAREST), 0);
    spar_session_destroy(&s);
}

/* What is computed in the wide format inside leaves no flag, and a trap of the host's finds none afterwards. */
static void test_wide(void **state) {
    (void)state;
    volatile long double none = 0, one = 1, x = 0;
    feclearexcept(FE_ALL_EXCEPT);
    for (int traps = 0; traps <= 1; traps++) {
        if (traps) {
            feenableexcept(TRAPS);
        }
        spari_environment_begin();
        x = one / none;
        spari_environment_end();
        assert_int_equal(fetestexcept(FE_ALL_EXCEPT), 0);
        assert_true(x > 1);
        x = x + one; /* which is where a flag left behind would raise its signal */
    }
    fedisableexcept(TRAPS);
}

/* A run of the library alone, whose host only says numbers: gravity, a load, a spring, a joint. */
static void run_alone(int rounding, double q[7 * 5]) {
    const double g[3] = {0, 0, -9.81}, load[6] = {0, 3, 0, 0, 0.1, 0};
    double K[36], M[36];
    spar_joint *weld;
    assert_int_equal(fesetround(rounding), 0);
    spar_session *s = scene_session();
    scene_box(K, M);
    spar_member *b = scene_beam(s, "b", 1, 5, 10, K, M), *other = scene_beam(s, "other", 1, 5, 10, K, M);
    OK(s, spar_session_set_gravity(s, g));
    OK(s, spar_member_commit(b));
    OK(s, spar_member_commit(other));
    OK(s, spar_joint_create(s, "hinge", b, 4, other, 4, SPAR_FREE_RX, &weld));
    OK(s, spar_member_set_load(b, 2, SPAR_LOAD_FOLLOWER, load));
    scene_run(s, 0.01, 40);
    assert_int_equal(fegetround(), rounding);
    OK(s, spar_member_get_motion(b, q, NULL, NULL));
    spar_session_destroy(&s);
    assert_int_equal(fesetround(FE_TONEAREST), 0);
}

/* However the host rounds: the same bits. */
static void test_rounding(void **state) {
    (void)state;
    static const int modes[] = {FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO};
    double nearest[7 * 5], q[7 * 5];
    run_alone(FE_TONEAREST, nearest);
    for (int k = 0; k < 3; k++) {
        run_alone(modes[k], q);
        assert_memory_equal(q, nearest, sizeof q);
    }
}

/* Under a comma (where the system has such a locale; tests/torture/traps makes one): numbers keep their point. */
static void test_comma(void **state) {
    (void)state;
    char before[100];
    const char *const locale[] = {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8", "de_DE"};
    double nan3[3] = {0.5, NAN, 0};
    size_t k = 0;
    (void)snprintf(before, sizeof before, "%s", setlocale(LC_ALL, NULL));
    while (k < 4 && !setlocale(LC_ALL, locale[k])) {
        k++;
    }
    if (k == 4) {
        skip();
    }
    spar_session *s = scene_session();
    OK(s, spar_session_set_option(s, "coupling.filter", "1.5e-4"));
    assert_int_equal(spar_session_set_option(s, "coupling.filter", "0,5"), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_step_begin(s, -0.5), SPAR_ERR_ARGUMENT);
    assert_non_null(strstr(spar_session_message(s), "-0.5"));
    assert_int_equal(spar_session_set_gravity(s, nan3), SPAR_ERR_ARGUMENT);
    (void)snprintf(before, sizeof before, "%.1f", 0.5);
    assert_string_equal(before, "0,5"); /* the host's is as it was */
    spar_session_destroy(&s);
    (void)setlocale(LC_ALL, "C");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_traps, traps_on, traps_off),
        cmocka_unit_test_setup_teardown(test_static, traps_on, traps_off),
        cmocka_unit_test(test_flags),
        cmocka_unit_test(test_wide),
        cmocka_unit_test(test_rounding),
        cmocka_unit_test(test_comma),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
