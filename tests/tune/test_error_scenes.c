/* What steps and nodes are said to leave (spar_member_estimate_error) on the scenes of benchmarks/worlds.h, which the
   estimates were not made with, against runs that are finer. */
#include "check.h"

#include "math/resample.h"
#include "support/deformed.h"
#include "worlds.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { MOST = 64, FINE = 14 };

/* Coupling and Newton leave less than what is looked for. */
static void begin(int k, int nodes, double fading, double dt, world *w) {
    assert_int_equal(world_create(k, nodes, fading, w), SPAR_OK);
    OK(w->s, spar_session_set_coupling(w->s, SPAR_COUPLING_IQN_ILS, 1e-12, 1e-7, 50));
    OK(w->s, spar_session_set_newton(w->s, 1e-14, 1e-10, 50));
    if (dt > 0) {
        OK(w->s, spar_session_solve_initial(w->s, dt, world_solve, w, NULL));
    }
}

/* Sums of squares over looks, for each member: what is said, and what is. */
typedef struct sums {
    double said[WORLD_MEMBERS], is[WORLD_MEMBERS];
} sums;

/* Whether sums agree within a factor; nothing is asked of what has no error to speak of, parts of 1e-6 of the motion.
 */
static void agree(const world *w, const char *scene, const char *what, const sums *e, const double *size, double low,
                  double high) {
    for (int m = 0; m < w->members; m++) {
        double ratio = sqrt(e->said[m] / e->is[m]);
        if (size && e->is[m] <= 1e-12 * size[m]) {
            continue;
        }
        print_message("%s, %s, member %d: ratio %.2f\n", scene, what, m, ratio);
        assert_true(ratio > low && ratio < high);
    }
}

/* ---- steps ---- */

/* The step from where the world stands, in 16 parts, on a copy. */
static void step_finely(world *w, int k, double t, double dt, double q[WORLD_MEMBERS][7 * MOST]) {
    enum { PARTS = 16 };
    world copy;
    OK(w->s, spar_session_save(w->s, "test_error_scenes.saved"));
    begin(k, 8, 0, 0, &copy);
    OK(copy.s, spar_session_load(copy.s, "test_error_scenes.saved"));
    assert_int_equal(remove("test_error_scenes.saved"), 0);
    for (int i = 0; i < PARTS; i++) {
        OK(copy.s, world_step(&copy, t + dt * i / PARTS, dt / PARTS));
    }
    for (int m = 0; m < w->members; m++) {
        OK(copy.s, spar_member_get_motion(copy.m[m], q[m], NULL, NULL));
    }
    spar_session_destroy(&copy.s);
}

static void add_step(const world *w, double q[WORLD_MEMBERS][7 * MOST], sums *e) {
    for (int m = 0; m < w->members; m++) {
        double now[7 * MOST], said;
        int64_t n;
        OK(w->s, spar_member_estimate_error(w->m[m], &said, NULL));
        OK(w->s, spar_member_get_count(w->m[m], &n));
        OK(w->s, spar_member_get_motion(w->m[m], now, NULL, NULL));
        e->said[m] += said * said;
        for (int64_t i = 0; i < 7 * n; i++) {
            e->is[m] += i % 7 < 3 ? pow(now[i] - q[m][i], 2) / (double)n : 0;
        }
    }
}

/* Root of the mean square over 24 steps of the run, each at its dt and at twice that, is that of the same steps in 16
   parts, for every member within a factor of 3; measured 0.93 to 1.3. Of the stiff rod and of the chain, which turn
   freely, 4.5 and 4; measured 3.0 to 4.1 and 1.4 to 3.5, too large for two reasons (docs/explanation/theory.md, "Steps
   that change"). Steps of another length begin with the velocities that belong to the places, and those of
   generalised-alpha, which the estimate is made of, are off these by C h^2 times the rate of the acceleration. And
   TR-BDF2, which takes the steps of fast rotation, has no error in steady rotation, which the estimate counts. */
static void errors_of_steps_are_true(void **state) {
    (void)state;
    for (int k = 0; k < WORLD_STEADY; k++) {
        for (int twice = 1; twice <= 2; twice++) {
            const double dt = twice * worlds[k].dt;
            const int steps = (int)worlds[k].steps / twice, between = steps / 24;
            static double fine[WORLD_MEMBERS][7 * MOST];
            sums e = {{0}, {0}};
            world w;
            begin(k, 8, 0, dt, &w);
            OK(w.s, spar_session_set_tolerance(w.s, 1e-3, 0));
            for (int i = 0; i < steps; i++) {
                int looks = i > 2 && i % between == 0;
                if (looks) {
                    step_finely(&w, k, i * dt, dt, fine);
                }
                OK(w.s, world_step(&w, i * dt, dt));
                if (looks) {
                    add_step(&w, fine, &e);
                }
            }
            agree(&w, worlds[k].name, twice == 1 ? "steps of dt" : "steps of 2 dt", &e, NULL, 1.0 / 3,
                  strcmp(worlds[k].name, "rod") == 0     ? 4.5
                  : strcmp(worlds[k].name, "chain") == 0 ? 4
                                                         : 3);
            spar_session_destroy(&w.s);
        }
    }
}

/* ---- nodes ---- */

/* Displacements [onto][3] seen from the root, at so many nodes. Answers how many there are, 1 for what has no shape. */
static int64_t shape(const world *w, int m, int onto, double *x) {
    double u[3 * MOST];
    int64_t n = deformed(w->s, w->m[m], MOST, u);
    if (n > 1) {
        spari_resample_values((spari_mesh){1, (int)n}, (spari_mesh){1, onto}, 3, -1, u, x);
    }
    return n;
}

/* Of a run of so many nodes beside one of FINE: errors of the shape, and its size. */
static void watch_nodes(int k, int nodes, double fading, world *w, sums *e, double *size) {
    const double dt = worlds[k].dt;
    const int steps = (int)worlds[k].steps, between = steps / 24;
    world fine;
    begin(k, nodes, fading, dt, w);
    begin(k, FINE, fading, dt, &fine);
    for (int i = 0; i < steps; i++) {
        OK(w->s, world_step(w, i * dt, dt));
        OK(fine.s, world_step(&fine, i * dt, dt));
        for (int m = 0; m < w->members && i > 2 && i % between == 0; m++) {
            double x[3 * MOST], y[3 * MOST], said;
            if (shape(w, m, FINE, x) == 1) {
                continue;
            }
            (void)shape(&fine, m, FINE, y);
            OK(w->s, spar_member_estimate_error(w->m[m], NULL, &said));
            e->said[m] += said * said;
            for (int c = 0; c < 3 * FINE; c++) {
                e->is[m] += pow(x[c] - y[c], 2) / FINE;
                size[m] += y[c] * y[c] / FINE;
            }
        }
    }
    spar_session_destroy(&fine.s);
}

/* Of 5 and 6 nodes where the run forgets what was, beams braked with 3/s: within a factor of 4 of how far the same run
   on 14 nodes is from there; measured 0.43 to 3.07. Not of the rod, whose hinge leaves its place to inertia (E3): 0.18.
 */
static void errors_of_nodes_are_true(void **state) {
    (void)state;
    for (int k = 0; k < WORLD_STEADY; k++) {
        for (int nodes = 5; nodes <= 6 && strcmp(worlds[k].name, "rod") != 0; nodes++) {
            sums e = {{0}, {0}};
            double size[WORLD_MEMBERS] = {0};
            world w;
            watch_nodes(k, nodes, 3, &w, &e, size);
            agree(&w, worlds[k].name, nodes == 5 ? "5 nodes" : "6 nodes", &e, size, 0.25, 4);
            spar_session_destroy(&w.s);
        }
    }
}

/* What cannot be seen in a shape: the second mode of the undamped pile is off by 0.55 % of its frequency on 6 nodes
   (9.6142 Hz; 9.5615 Hz on 14), and what the waves left of it at the start is out of phase by 2 rad after the run. 0.06
   of the error is said, as the header and docs/explanation/advice.md have it: were it more, they would be wrong. */
static void frequencies_are_not_seen(void **state) {
    (void)state;
    sums e = {{0}, {0}};
    double size[WORLD_MEMBERS] = {0};
    world w;
    watch_nodes(0, 6, 0, &w, &e, size);
    agree(&w, worlds[0].name, "6 nodes, undamped", &e, size, 0.01, 0.2);
    spar_session_destroy(&w.s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(errors_of_steps_are_true),
        cmocka_unit_test(errors_of_nodes_are_true),
        cmocka_unit_test(frequencies_are_not_seen),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
