/* Explicit coupling with a heavy fluid. Set-up: a body of 2 kg on a spring that holds it to the ground, in
   a fluid that pushes a load b(t) and the load of its added mass. Expected: the known limits of stability, 1, 1/3 and
   1/7 of the mass; the motion stays within the bound of the forced oscillation or is refused; a light fluid is never
   refused, whatever its loads are. */
#include "support/sprung.h"

#include "coupling/explicit_stability.h"

#include <stdio.h>

/* a number in [0, 1) */
static double draw(uint64_t *seed) {
    *seed = *seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (double)(*seed >> 11) / 9007199254740992.0;
}

/* ---- explicit ---- */

/* Steps until refused; 0: never. bound: no position may be beyond it. */
static int explicit_run(sprung *w, double dt, int order, int steps, double bound) {
    OK(w->s, spar_session_set_coupling(w->s, SPAR_COUPLING_EXPLICIT, 1e-9, 1e-6, 50));
    OK(w->s, spar_session_set_predictor(w->s, order));
    for (int i = 0; i < steps; i++) {
        double x[3];
        int status = spar_step(w->s, dt, solve, w, NULL);
        if (status != SPAR_OK) {
            assert_int_equal(status, SPAR_ERR_NUMERIC);
            assert_non_null(strstr(spar_session_message(w->s), "SPAR_COUPLING_IQN_ILS"));
            return i + 1;
        }
        place(w, x);
        if (!(fabs(x[0]) <= bound)) {
            fail_msg("added mass %g, order %d%s: |x| is %g in step %d, and at most %g is right", w->added / w->mass,
                     order, w->by_velocity ? ", by velocities" : "", fabs(x[0]), i + 1, bound);
        }
    }
    return 0;
}

/* Largest position of the oracle: amplitude of the load at most 1 N, at most 3 in resonance with what begins. */
static double bound_of(const sprung *w) {
    return 30 / stiffness_of(w->mass + w->added);
}

/* Stable below 1, 1/3, 1/7 (orders 0, 1, 2): those below go on, those above are refused. */
static void test_limits(void **state) {
    (void)state;
    static const double ratios[] = {0.1, 0.2, 0.5, 1.2, 4, 100}, limit[] = {1, 1.0 / 3, 1.0 / 7};
    for (int order = 0; order <= 2; order++) {
        for (size_t r = 0; r < sizeof ratios / sizeof *ratios; r++) {
            sprung w;
            create(&w, body_mass, ratios[r] * body_mass);
            w.load = slow;
            int refused = explicit_run(&w, 0.02, order, 3000, order == 0 ? INFINITY : bound_of(&w));
            print_message("added mass %g, order %d: refused in step %d\n", ratios[r], order, refused);
            assert_true((refused > 0) == (ratios[r] > limit[order]));
            spar_session_destroy(&w.s);
        }
    }
}

/* A refused step can be rejected, and the run goes on iterated; or the host accepts the instability. */
static void test_after_refusal(void **state) {
    (void)state;
    for (int accept = 0; accept < 2; accept++) {
        sprung w;
        double x[3];
        create(&w, body_mass, 4 * body_mass);
        w.load = slow;
        if (accept) {
            OK(w.s, spar_session_set_option(w.s, "coupling.unstable", "accept"));
        }
        int refused = explicit_run(&w, 0.02, 1, accept ? 12 : 200, INFINITY);
        assert_true(accept ? refused == 0 : refused > 0);
        if (!accept) {
            OK(w.s, spar_session_set_coupling(w.s, SPAR_COUPLING_IQN_ILS, 1e-9, 1e-6, 50));
            for (int i = 0; i < 100; i++) {
                OK(w.s, spar_step(w.s, 0.02, solve, &w, NULL));
            }
        }
        place(&w, x);
        assert_true(isfinite(x[0]) && (fabs(x[0]) > 1e3 * bound_of(&w)) == accept);
        spar_session_destroy(&w.s);
    }
}

/* A loop that accepts each step after one evaluation is explicit, whatever the scheme is: the same. */
static void test_accepted_before_done(void **state) {
    (void)state;
    static const double ratios[] = {0.2, 4};
    for (int r = 0; r < 2; r++) {
        sprung w;
        int done = 0, status = SPAR_OK, steps = 0;
        create(&w, body_mass, ratios[r] * body_mass);
        w.load = slow;
        OK(w.s, spar_session_set_coupling(w.s, SPAR_COUPLING_IQN_ILS, 1e-9, 1e-6, 50));
        for (; steps < 300 && status == SPAR_OK; steps++) {
            OK(w.s, spar_step_begin(w.s, 0.02));
            OK(w.s, spar_step_solve(w.s));
            OK(w.s, solve(w.s, steps * 0.02, 0.02, 0, &w));
            status = spar_step_check(w.s, &done);
            if (status == SPAR_OK) {
                OK(w.s, spar_step_accept(w.s));
            }
        }
        assert_int_equal(status, r == 0 ? SPAR_OK : SPAR_ERR_NUMERIC);
        assert_true(r == 0 || steps < 10);
        if (r == 1) { /* the same step, iterated */
            OK(w.s, spar_step_reject(w.s));
            OK(w.s, spar_step(w.s, 0.02, solve, &w, NULL));
        }
        spar_session_destroy(&w.s);
    }
}

/* Added mass, dt, order and the kind of fluid at random: refused, or never beyond the bound. */
static void test_random(void **state) {
    (void)state;
    uint64_t random = 7;
    int refused = 0;
    for (int i = 0; i < 120; i++) {
        sprung w;
        double ratio = 0.02 * pow(5000, draw(&random)), dt = 0.005 + 0.025 * draw(&random);
        create(&w, body_mass, ratio * body_mass);
        w.load = slow;
        w.by_velocity = i % 2;
        refused += explicit_run(&w, dt, 1 + i / 2 % 2, 600, 3 * bound_of(&w)) > 0;
        spar_session_destroy(&w.s);
    }
    print_message("%d of 120 random runs refused\n", refused);
    assert_true(refused > 30 && refused < 110);
}

/* ---- a light fluid is never refused ---- */

typedef struct weather {
    uint64_t random;
    int kind;
    double at, now, next;
} weather;

/* Loads that a predictor misses: gusts as short as a step, single impulses, jumps, noise in each step, waves that turn
   in each second step, growth over ten orders of magnitude. */
static double blow(double t, void *of) {
    weather *b = of;
    if (t == b->at) {
        return b->now;
    }
    b->at = t;
    double x = draw(&b->random), y = draw(&b->random);
    switch (b->kind) {
    case 0:
        return b->now = fmod(t, 1) < 0.05 ? 0.5 * (1 - cos(40 * pi * fmod(t, 1))) : 0;
    case 1:
        return b->now = x < 0.1 ? exp(4 * y) : 0;
    case 2:
        return b->now = x < 0.1 ? 2 * y - 1 : b->now;
    case 3:
        return b->now = sqrt(-2 * log(x + 1e-12)) * cos(2 * pi * y);
    case 4:
        return b->now = sin(2 * pi * t / 0.042);
    default:
        return b->now = exp(fmin(t, 5) * 4.6 - 23) * sin(3 * t);
    }
}

static void test_light_fluid(void **state) {
    (void)state;
    for (int kind = 0; kind < 6; kind++) {
        for (int order = 0; order <= 2; order++) {
            for (int seed = 0; seed < 3; seed++) {
                sprung w;
                weather b = {(uint64_t)(17 * seed + kind + 1), kind, -1, 0, 0};
                create(&w, body_mass, (seed == 0 ? 0 : 0.05) * body_mass);
                w.load = blow, w.of = &b;
                w.by_velocity = seed == 2;
                if (explicit_run(&w, 0.02, order, 1500, INFINITY) > 0) {
                    fail_msg("loads %d, order %d, seed %d: %s", kind, order, seed, spar_session_message(w.s));
                }
                spar_session_destroy(&w.s);
            }
        }
    }
}

/* The watch alone, with normally distributed loads in each step, whose prediction is worse than none: 10^6 steps. */
static void test_random_loads(void **state) {
    (void)state;
    uint64_t random = 3;
    for (int order = 0; order <= 2; order++) {
        spari_explicit_stability is = {.steps = {0}};
        double f[4] = {0}, error = 0, factor;
        for (int i = 0; i < 350000; i++) {
            f[0] = sqrt(-2 * log(draw(&random) + 1e-300)) * cos(2 * pi * draw(&random));
            double guess = order == 0 ? f[1] : order == 1 ? 2 * f[1] - f[2] : 3 * (f[1] - f[2]) + f[3];
            double miss = f[0] - guess;
            const spari_predicted_step step = {fabs(miss), fabs(f[0]), fabs(error), miss * error > 0 ? 1 : -1,
                                               guess * f[0] > 0 ? 1 : -1};
            spari_explicit_stability_add(&is, &step);
            if (spari_explicit_is_unstable(&is, &factor)) {
                fail_msg("order %d, step %d: taken for an instability", order, i);
            }
            error = miss;
            f[3] = f[2], f[2] = f[1], f[1] = f[0];
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_limits),
                                       cmocka_unit_test(test_after_refusal),
                                       cmocka_unit_test(test_accepted_before_done),
                                       cmocka_unit_test(test_random),
                                       cmocka_unit_test(test_light_fluid),
                                       cmocka_unit_test(test_random_loads)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
