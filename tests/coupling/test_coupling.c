/* The coupling of a session with a fluid that is added mass: limits of stability, iteration counts, the stop tests,
   what is reported, and what a failure leaves behind. The maps are in closed form (pistons.h). */
#include "pistons.h"

#include "member/structure.h"

#include <stdio.h>

/* Steps the explicit scheme from a load of 1 at t^0; returns the last load pushed. */
static double explicit_run(int order, double ratio, int steps, double dt) {
    pistons p;
    double one[3] = {1, 0, 0};
    pistons_create(&p, 1, &ratio);
    scene_explicit(p.session);
    OK(p.session, spar_session_set_option(p.session, "coupling.unstable", "accept"));
    OK(p.session, spar_session_set_predictor(p.session, order));
    OK(p.session, spar_fluid_push_forces(p.fluid[0], one, NULL));
    for (int i = 0; i < steps; i++) {
        OK(p.session, spar_step(p.session, dt, pistons_fluid, &p, NULL));
    }
    double last = fabs(p.force[0][0]);
    pistons_destroy(&p);
    return last;
}

/* Loads follow f^{n+1} = -r (extrapolation of the last ones): |root| = 1 at r = 1 (order 0), 1/3 (order 1), 1/7 (order
   2), where the root is -1: r (1), r (2 + 1), r (3 + 3 + 1) = 1. Sharp to 1e-3, for dt of any size. */
static void explicit_limits(void **state) {
    (void)state;
    static const double limit[3] = {1, 1.0 / 3, 1.0 / 7}, dts[2] = {1e-3, 10};
    for (int order = 0; order <= 2; order++) {
        for (int k = 0; k < 2; k++) {
            double start = explicit_run(order, limit[order] * (1 - 1e-3), 200, dts[k]);
            double below = explicit_run(order, limit[order] * (1 - 1e-3), 4000, dts[k]);
            assert_true(below < 0.2 * start);
            start = explicit_run(order, limit[order] * (1 + 1e-3), 200, dts[k]);
            double above = explicit_run(order, limit[order] * (1 + 1e-3), 4000, dts[k]);
            assert_true(above > 5 * start);
        }
    }
}

/* Every ratio of added mass with every scheme: the answer is b / (1 + r), in 3 evaluations with Aitken and IQN-ILS;
   fixed point iteration without relaxation needs r < 1. */
static void ratios(void **state) {
    (void)state;
    static const double all[] = {0.1, 0.3, 0.9, 1.1, 3, 10, 100};
    for (size_t k = 0; k < sizeof all / sizeof *all; k++) {
        for (int scheme = SPAR_COUPLING_FIXED_POINT; scheme <= SPAR_COUPLING_IQN_ILS; scheme++) {
            pistons p;
            int evaluations = 0;
            pistons_create(&p, 1, all + k);
            p.b[0] = 5;
            OK(p.session, spar_session_set_coupling(p.session, scheme, 0, 1e-10, 250));
            int status = spar_step(p.session, 0.1, pistons_fluid, &p, &evaluations);
            int diverges = scheme == SPAR_COUPLING_FIXED_POINT && all[k] > 1;
            assert_int_equal(status, diverges ? SPAR_ERR_NUMERIC : SPAR_OK);
            if (!diverges) {
                double a[6];
                assert_true(scheme == SPAR_COUPLING_FIXED_POINT || evaluations <= 3);
                NEAR(p.force[0][0], 5 / (1 + all[k]), 5e-9);
                OK(p.session, spar_member_get_motion(p.body[0], NULL, NULL, a));
                NEAR(a[0], 5 / (1 + all[k]) / 2, 5e-9);
            }
            pistons_destroy(&p);
        }
    }
}

/* Causin's channel modes, each a piston of one session: the stacked vector is iterated as a whole, so the counts are
   those of the table (test_accelerate.c), to the same absolute tolerance: 1e-8 of |b|. */
static void channel_modes(void **state) {
    (void)state;
    static const struct {
        int n, aitken, iqn;
        double a_dt2;
    } rows[] = {{1, 3, 3, 0.004}, {2, 12, 4, 0.004}, {5, 30, 7, 0.004}, {5, 9, 6, 40}};
    const double pi = 3.14159265358979323846;
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
        for (int scheme = SPAR_COUPLING_AITKEN; scheme <= SPAR_COUPLING_IQN_ILS; scheme++) {
            double r[5];
            int evaluations;
            pistons p;
            for (int i = 1; i <= rows[k].n; i++) {
                r[i - 1] = 6 / (i * pi * tanh(i * pi * 0.5 / 6)) / (0.11 + rows[k].a_dt2);
            }
            pistons_create(&p, rows[k].n, r);
            for (int i = 0; i < p.n; i++) {
                p.b[i] = 1;
            }
            OK(p.session, spar_session_set_coupling(p.session, scheme, 1e-8 * sqrt(p.n), 0, 100));
            OK(p.session, spar_session_set_relaxation(p.session, 0.01));
            OK(p.session, spar_session_set_option(p.session, "coupling.filter", "0"));
            OK(p.session, spar_step(p.session, 0.1, pistons_fluid, &p, &evaluations));
            assert_int_equal(evaluations, scheme == SPAR_COUPLING_AITKEN ? rows[k].aitken : rows[k].iqn);
            pistons_destroy(&p);
        }
    }
}

/* r = 1/2: residuals 5, 5/2, 5/4, ... against loads 5, 5/2, 15/4, ...; contraction and ratio are 1/2. */
static void report(void **state) {
    (void)state;
    const double r = 0.5;
    double residual[100], size[100], rep[SPAR_REPORT_COUNT];
    int evaluations, iterations;
    pistons p;
    pistons_create(&p, 1, &r);
    p.b[0] = 5;
    OK(p.session, spar_session_set_predictor(p.session, 0));
    OK(p.session, spar_session_get_iterations(p.session, &iterations, 100, residual, size));
    double last[2] = {1, 1};
    OK(p.session, spar_session_get_residual(p.session, last, last + 1));
    assert_true(iterations == 0 && last[0] == 0 && last[1] == 0);
    OK(p.session, spar_session_set_coupling(p.session, SPAR_COUPLING_FIXED_POINT, 0, 1e-9, 100));
    OK(p.session, spar_step(p.session, 0.1, pistons_fluid, &p, &evaluations));
    OK(p.session, spar_session_get_iterations(p.session, &iterations, 100, residual, size));
    OK(p.session, spar_session_get_report(p.session, SPAR_REPORT_COUNT, rep));
    assert_int_equal(iterations, evaluations);
    assert_true(residual[iterations] == 0 && size[iterations] == 0);
    OK(p.session, spar_session_get_residual(p.session, last, last + 1));
    assert_true(last[0] == residual[iterations - 1] && last[1] == size[iterations - 1]);
    OK(p.session, spar_session_get_residual(p.session, NULL, NULL));
    for (int i = 0; i < iterations; i++) {
        NEAR(residual[i], 5 * pow(0.5, i), 1e-12);
    }
    NEAR(size[0], 5, 1e-12);
    NEAR(size[1], 2.5, 1e-12);
    NEAR(size[2], 3.75, 1e-12);
    NEAR(rep[SPAR_REPORT_CONTRACTION], 0.5, 1e-6);
    NEAR(rep[SPAR_REPORT_ADDED_MASS], 0.5, 1e-6);
    NEAR(rep[SPAR_REPORT_ERROR], 1, 1e-12); /* predicted: no load at all */
    OK(p.session, spar_session_get_iterations(p.session, NULL, 0, NULL, NULL));
    OK(p.session, spar_session_get_report(p.session, 1, NULL));
    /* the second step predicts the loads that it finds: one iteration */
    OK(p.session, spar_step(p.session, 0.1, pistons_fluid, &p, &evaluations));
    OK(p.session, spar_session_get_iterations(p.session, &iterations, 0, NULL, NULL));
    OK(p.session, spar_session_get_report(p.session, SPAR_REPORT_COUNT, rep));
    assert_int_equal(iterations, 1);
    assert_true(rep[SPAR_REPORT_ERROR] < 1e-8);
    pistons_destroy(&p);
}

/* An added mass is told once there are differences enough to tell its spread: of one whose map has one ratio the spread
   is rounding; of pushes that are off by a tenth in turn it is some tenth of 1/2 over the ways between them. */
static void added_mass_with_spread(void **state) {
    (void)state;
    const double r = 0.5;
    double rep[SPAR_REPORT_COUNT];
    for (int noisy = 0; noisy < 2; noisy++) {
        pistons p;
        pistons_create(&p, 1, &r);
        OK(p.session, spar_session_set_predictor(p.session, 0));
        OK(p.session, spar_session_set_coupling(p.session, SPAR_COUPLING_FIXED_POINT, 0, 1e-3, 100));
        p.b[0] = 5;
        for (int step = 0; step < 6; step++) {
            int done = 0, n = 0;
            OK(p.session, spar_step_begin(p.session, 0.1));
            while (!done) {
                OK(p.session, spar_step_solve(p.session));
                p.ratio[0] = r * (1 + (noisy && n % 2 ? 0.1 : 0));
                OK(p.session, pistons_fluid(p.session, 0, 0.1, n++, &p));
                OK(p.session, spar_step_check(p.session, &done));
                OK(p.session, spar_session_get_report(p.session, SPAR_REPORT_COUNT, rep));
                assert_true(step > 0 || n > 3 || rep[SPAR_REPORT_ADDED_MASS] == 0);
                done |= n == 8;
            }
            OK(p.session, spar_step_accept(p.session));
            p.b[0] = -p.b[0];
        }
        double spread = rep[SPAR_REPORT_ADDED_MASS_SPREAD];
        NEAR(rep[SPAR_REPORT_ADDED_MASS], r, noisy ? 0.3 : 1e-9);
        assert_true(noisy ? spread > 0.02 && spread < 0.6 : spread < 1e-6);
        print_message("added mass %g (+- %g)\n", rep[SPAR_REPORT_ADDED_MASS], spread);
        pistons_destroy(&p);
    }
}

/* What another iteration would have moved is told of an explicit step without it: as far as a twin that is solved again
   with the loads pushed goes, which is exact for bodies that do not turn. Off by default, and then 0. */
static void explicit_error_is_told(void **state) {
    (void)state;
    const double r[2] = {0.2, 0.3};
    for (int on = 0; on < 2; on++) {
        pistons p[2];
        for (int k = 0; k < 2; k++) {
            pistons_create(&p[k], 2, r);
            p[k].b[0] = 1, p[k].b[1] = -4;
        }
        scene_explicit(p[0].session);
        OK(p[0].session, spar_session_set_option(p[0].session, "coupling.estimate", on ? "on" : "off"));
        OK(p[1].session, spar_session_set_coupling(p[1].session, SPAR_COUPLING_FIXED_POINT, 0, 1e-15, 50));
        for (int step = 0; step < 4; step++) {
            double q[2][7], again[7], rep[SPAR_REPORT_COUNT], want = 0;
            int done;
            for (int k = 0; k < 2; k++) {
                OK(p[k].session, spar_step_begin(p[k].session, 0.1));
                OK(p[k].session, spar_step_solve(p[k].session));
                OK(p[k].session, pistons_fluid(p[k].session, 0, 0.1, 0, &p[k]));
                for (int i = 0; i < 2; i++) {
                    OK(p[k].session, spar_member_get_motion(p[k].body[i], q[i], NULL, NULL));
                }
                OK(p[k].session, spar_step_check(p[k].session, &done));
            }
            OK(p[1].session, spar_step_solve(p[1].session));
            for (int i = 0; i < 2; i++) {
                OK(p[1].session, spar_member_get_motion(p[1].body[i], again, NULL, NULL));
                want = fmax(want, fabs(again[0] - q[i][0]));
            }
            OK(p[1].session, spar_step_reject(p[1].session)); /* and as the other one did */
            OK(p[0].session, spar_session_get_report(p[0].session, SPAR_REPORT_COUNT, rep));
            assert_true(want > 1e-6);
            NEAR(rep[SPAR_REPORT_MOTION_ERROR], on ? want : 0, 1e-12);
            OK(p[0].session, spar_step_accept(p[0].session));
            OK(p[1].session, spar_session_set_coupling(p[1].session, SPAR_COUPLING_EXPLICIT, 0, 1e-15, 50));
            OK(p[1].session, spar_step(p[1].session, 0.1, pistons_fluid, &p[1], NULL));
            OK(p[1].session, spar_session_set_coupling(p[1].session, SPAR_COUPLING_FIXED_POINT, 0, 1e-15, 50));
        }
        pistons_destroy(&p[0]);
        pistons_destroy(&p[1]);
    }
}

/* ---- loops that the host drives ---- */

static double use_of(const pistons *p) {
    double load[6];
    OK(p->session, spar_member_get_loads(p->body[0], load));
    return load[0];
}

/* A fixed number of iterations, whatever the check says, and accept: the loads are those pushed last, the motion that
   of the loads before, which after k iterations from 0 are 5 (1 - (-r)^k) / (1 + r), r = 1/2; the next step predicts
   from the loads pushed. After a check that was not done spar_member_get_loads gives what comes next. */
static void fixed_number_of_iterations(void **state) {
    (void)state;
    enum { COUNT = 3 };
    const double r = 0.5, limit = 5 / (1 + r);
    double a[6], t;
    pistons p;
    pistons_create(&p, 1, &r);
    p.b[0] = 5;
    OK(p.session, spar_session_set_predictor(p.session, 0));
    OK(p.session, spar_session_set_coupling(p.session, SPAR_COUPLING_FIXED_POINT, 0, 1e-9, 50));
    int done = 1;
    OK(p.session, spar_step_begin(p.session, 0.1));
    NEAR(use_of(&p), 0, 0);
    for (int k = 0; k < COUNT; k++) {
        OK(p.session, spar_step_solve(p.session));
        NEAR(use_of(&p), limit * (1 - pow(-r, k)), 1e-12);
        OK(p.session, pistons_fluid(p.session, 0, 0.1, k, &p));
        OK(p.session, spar_step_check(p.session, &done));
        assert_int_equal(done, 0);
        NEAR(use_of(&p), limit * (1 - pow(-r, k + 1)), 1e-12);
    }
    OK(p.session, spar_step_accept(p.session));
    OK(p.session, spar_session_get_time(p.session, &t, NULL, NULL));
    NEAR(t, 0.1, 1e-15);
    OK(p.session, spar_member_get_motion(p.body[0], NULL, NULL, a));
    NEAR(a[0] * p.mass[0], limit * (1 - pow(-r, COUNT - 1)), 1e-12);
    OK(p.session, spar_step_begin(p.session, 0.1));
    NEAR(use_of(&p), limit * (1 - pow(-r, COUNT)), 1e-12);
    OK(p.session, spar_step_reject(p.session));
    pistons_destroy(&p);
}

/* On after `done`: the loads in use stay, so that another solution is the same to the bit, and another check agrees;
   the loads pushed then count. A host that cannot tell when its last iteration is pushes in the next step's first call:
   push, check, accept, begin, solve, and gets the same run. */
static void on_after_done(void **state) {
    (void)state;
    const double r = 2;
    double q[3][7], v[2][6];
    for (int late = 0; late < 3; late++) { /* as spar_step does it; once more after done; pushed late */
        pistons p;
        pistons_create(&p, 1, &r);
        p.b[0] = 5, p.stiffness = 3;
        OK(p.session, spar_session_set_coupling(p.session, SPAR_COUPLING_IQN_ILS, 0, 1e-10, 50));
        int under_way = 0, done = 0;
        for (int step = 0; step < 5; step++) {
            if (under_way) { /* the next step's first call ends the last one */
                OK(p.session, pistons_fluid(p.session, 0, 0.1, 0, &p));
                OK(p.session, spar_step_check(p.session, &done));
                OK(p.session, spar_step_accept(p.session));
            }
            OK(p.session, spar_step_begin(p.session, 0.1));
            for (done = 0; !done;) {
                OK(p.session, spar_step_solve(p.session));
                OK(p.session, pistons_fluid(p.session, 0, 0.1, 0, &p));
                OK(p.session, spar_step_check(p.session, &done));
            }
            if (late > 0) {
                OK(p.session, spar_member_get_motion(p.body[0], q[0], v[0], NULL));
                OK(p.session, spar_step_solve(p.session));
                OK(p.session, spar_member_get_motion(p.body[0], q[1], v[1], NULL));
                assert_memory_equal(q[0], q[1], sizeof q[0]);
                assert_memory_equal(v[0], v[1], sizeof v[0]);
            }
            if (late == 1) {
                OK(p.session, pistons_fluid(p.session, 0, 0.1, 0, &p));
                OK(p.session, spar_step_check(p.session, &done));
                assert_int_equal(done, 1);
            }
            under_way = late == 2;
            if (!under_way) {
                OK(p.session, spar_step_accept(p.session));
            }
        }
        OK(p.session, spar_member_get_motion(p.body[0], q[late == 0 ? 2 : 0], NULL, NULL));
        assert_true(late == 0 || memcmp(q[0], q[2], sizeof q[0]) == 0);
        pistons_destroy(&p);
    }
}

/* The limit of iterations stands in a host's own loop too: at it the check fails, and the step can only be rejected, or
   goes on under coupling.unconverged = accept. */
static void own_loop_to_the_limit(void **state) {
    (void)state;
    const double r = 0.5;
    for (int accept = 0; accept < 2; accept++) {
        pistons p;
        pistons_create(&p, 1, &r);
        p.b[0] = 5;
        OK(p.session, spar_session_set_coupling(p.session, SPAR_COUPLING_FIXED_POINT, 0, 1e-12, 3));
        OK(p.session, spar_session_set_option(p.session, "coupling.unconverged", accept ? "accept" : "error"));
        OK(p.session, spar_step_begin(p.session, 0.1));
        for (int k = 0; k < 3; k++) {
            int done = 0, expected = k < 2 || accept ? SPAR_OK : SPAR_ERR_NUMERIC;
            OK(p.session, spar_step_solve(p.session));
            OK(p.session, pistons_fluid(p.session, 0, 0.1, k, &p));
            assert_int_equal(spar_step_check(p.session, &done), expected);
            assert_int_equal(done, k == 2 && accept);
        }
        assert_int_equal(spar_step_accept(p.session), accept ? SPAR_OK : SPAR_ERR_STATE);
        if (!accept) {
            OK(p.session, spar_step_reject(p.session));
        }
        pistons_destroy(&p);
    }
}

/* At its limit the iteration is an error, or is accepted and counted. */
static void unconverged(void **state) {
    (void)state;
    const double r = 3;
    double rep[SPAR_REPORT_COUNT], t;
    int64_t step;
    pistons p;
    pistons_create(&p, 1, &r);
    p.b[0] = 5;
    OK(p.session, spar_session_set_coupling(p.session, SPAR_COUPLING_FIXED_POINT, 0, 1e-9, 6));
    assert_int_equal(spar_step(p.session, 0.1, pistons_fluid, &p, NULL), SPAR_ERR_NUMERIC);
    assert_non_null(strstr(spar_session_message(p.session), "not converged in 6 iterations"));
    const char *told = strstr(spar_session_message(p.session), "added mass about ");
    double about = 0, spread = 1;
    assert_non_null(told);
    assert_int_equal(sscanf(told, "added mass about %lf (+- %lf", &about, &spread), 2);
    NEAR(about, 3, 0.011); /* told with three digits, which rounding upwards makes 3.01 */
    NEAR(spread, 0, 0.011);
    OK(p.session, spar_session_get_time(p.session, &t, &step, NULL));
    assert_true(t == 0 && step == 0);
    OK(p.session, spar_session_set_option(p.session, "coupling.unconverged", "accept"));
    OK(p.session, spar_step(p.session, 0.1, pistons_fluid, &p, NULL));
    OK(p.session, spar_step(p.session, 0.1, pistons_fluid, &p, NULL));
    OK(p.session, spar_session_get_report(p.session, SPAR_REPORT_COUNT, rep));
    assert_true(rep[SPAR_REPORT_UNCONVERGED] == 2);
    /* without a limit in sight the loads overflow: a status, not an endless loop or a false success */
    OK(p.session, spar_session_set_coupling(p.session, SPAR_COUPLING_FIXED_POINT, 0, 1e-9, 2000));
    assert_int_equal(spar_step(p.session, 0.1, pistons_fluid, &p, NULL), SPAR_ERR_NUMERIC);
    /* and the session goes on */
    OK(p.session, spar_session_set_coupling(p.session, SPAR_COUPLING_IQN_ILS, 0, 1e-9, 20));
    OK(p.session, spar_step(p.session, 0.1, pistons_fluid, &p, NULL));
    NEAR(p.force[0][0], 1.25, 1e-8);
    pistons_destroy(&p);
}

/* The motion test asks for one more iteration where the loads agree at once; it holds in the units it says: metres. */
static void motion_test(void **state) {
    (void)state;
    const double r = 0.5;
    int loads_only, with_motion;
    for (int k = 0; k < 2; k++) {
        pistons p;
        pistons_create(&p, 1, &r);
        p.b[0] = 5;
        OK(p.session, spar_session_set_coupling(p.session, SPAR_COUPLING_FIXED_POINT, 0, 1e-3, 100));
        if (k) { /* one step of 0.1 s moves the piston by a dt^2 / 4 or so; a residual R moves it by (R/2) dt^2 / 4 */
            OK(p.session, spar_session_set_option(p.session, "coupling.motion_atol", "1e-9"));
        }
        OK(p.session, spar_step(p.session, 0.1, pistons_fluid, &p, k ? &with_motion : &loads_only));
        pistons_destroy(&p);
    }
    /* residual 5/2^i <= 1e-3 * 10/3 at i = 11; moved = 5/2^i / 2 * 0.0025 <= 1e-9 at i = 23, and it is the change of
       the loads used, one behind */
    assert_int_equal(loads_only, 12);
    assert_int_equal(with_motion, 25);
}

/* The state as the user sees it */
static void snapshot(const pistons *p, double *out) {
    for (int i = 0; i < p->n; i++) {
        OK(p->session, spar_member_get_motion(p->body[i], out + 25 * i, out + 25 * i + 7, out + 25 * i + 13));
        OK(p->session, spar_member_get_loads(p->body[i], out + 25 * i + 19));
    }
}

/* NaN in the third call of the fluid: refused, the step goes back, and the run goes on with the bits of one in which it
   did not happen. Also after a step tried with another dt and rejected. */
static void nan_in_the_third_iteration(void **state) {
    (void)state;
    const double r[3] = {0.2, 4, 30};
    for (int scheme = SPAR_COUPLING_FIXED_POINT; scheme <= SPAR_COUPLING_IQN_ILS; scheme++) {
        double got[2][75];
        for (int with = 0; with < 2; with++) {
            pistons p;
            pistons_create(&p, 3, r);
            OK(p.session, spar_session_set_coupling(p.session, scheme, 0, 1e-9, 2000));
            OK(p.session, spar_session_set_relaxation(p.session, 0.05));
            p.b[0] = 1, p.b[1] = -2, p.b[2] = 3, p.stiffness = 20;
            for (int step = 0; step < 6; step++) {
                if (with && (step == 0 || step == 3)) {
                    double before[75], after[75];
                    snapshot(&p, before);
                    p.calls = 0;
                    p.bad_call = step == 0 ? 3 : 1; /* reused columns leave no third iteration later */
                    assert_int_equal(spar_step(p.session, 0.1, pistons_fluid, &p, NULL), SPAR_ERR_ARGUMENT);
                    assert_non_null(strstr(spar_session_message(p.session), "nan"));
                    p.bad_call = 0;
                    snapshot(&p, after);
                    assert_memory_equal(before, after, sizeof before);
                    /* and a whole step with another dt, taken back */
                    int done = 0;
                    OK(p.session, spar_step_begin(p.session, 0.02));
                    while (!done) {
                        OK(p.session, spar_step_solve(p.session));
                        pistons_fluid(p.session, 0, 0, 0, &p);
                        OK(p.session, spar_step_check(p.session, &done));
                    }
                    OK(p.session, spar_step_reject(p.session));
                    snapshot(&p, after);
                    assert_memory_equal(before, after, sizeof before);
                }
                OK(p.session, spar_step(p.session, 0.1, pistons_fluid, &p, NULL));
            }
            snapshot(&p, got[with]);
            pistons_destroy(&p);
        }
        assert_memory_equal(got[0], got[1], sizeof got[0]);
    }
}

/* ---- the warning ---- */

static int warnings;

static void count_warnings(const spar_session *s, int level, const char *text, void *context) {
    (void)s;
    (void)context;
    warnings += level == 1 && strstr(text, "becoming unstable") != NULL;
}

/* Above the limit the log warns while the loads are still small; below it, and where a load merely grows, it is silent.
 */
static void instability_warning(void **state) {
    (void)state;
    static const double all[2] = {0.3, 0.5};
    for (int k = 0; k < 2; k++) {
        pistons p;
        pistons_create(&p, 1, all + k);
        p.stiffness = 2;
        p.b[0] = 1;
        warnings = 0;
        scene_explicit(p.session);
        OK(p.session, spar_session_set_log(p.session, count_warnings, NULL));
        int step = 0;
        for (; step < 200 && !warnings; step++) {
            p.b[0] += 0.1;
            OK(p.session, spar_step(p.session, 0.01, pistons_fluid, &p, NULL));
        }
        assert_int_equal(warnings, k);
        assert_true(k == 0 || (step < 40 && fabs(p.force[0][0]) < 1e3));
        pistons_destroy(&p);
    }
}

/* Loads that alternate and grow from step to step, from 1e-22 N on, on a body of 1 kg: it does not move by more than
   rounding until they are 1e-12 N, and the log is silent. */
static void rounding_is_no_instability(void **state) {
    (void)state;
    const double ratio = 0;
    for (int large = 0; large < 2; large++) {
        pistons p;
        pistons_create(&p, 1, &ratio);
        warnings = 0;
        scene_explicit(p.session);
        OK(p.session, spar_session_set_option(p.session, "coupling.unstable", "accept"));
        OK(p.session, spar_session_set_log(p.session, count_warnings, NULL));
        for (int step = 0; step < 12; step++) {
            p.b[0] = (large ? 1e-2 : 1e-22) * pow(-4, step);
            OK(p.session, spar_step(p.session, 0.1, pistons_fluid, &p, NULL));
        }
        assert_int_equal(warnings > 0, large);
        pistons_destroy(&p);
    }
}

/* ---- the predictor ---- */

/* A load that is a polynomial of the predictor's order is predicted exactly whatever the steps: dt 1 : 3 : 2. */
static int polynomial(spar_session *s, double t, double dt, int iteration, void *context) {
    pistons *p = context;
    double x = t + dt, f[3] = {p->b[0] + p->b[1] * x + p->b[2] * x * x, 0, 0};
    (void)iteration;
    (void)s;
    return spar_fluid_push_forces(p->fluid[0], f, NULL);
}

static void predictor_is_exact(void **state) {
    (void)state;
    static const double dts[] = {0.1, 0.3, 0.2, 0.1, 0.6}, r = 0;
    for (int order = 0; order <= 2; order++) {
        pistons p;
        double rep[SPAR_REPORT_COUNT];
        pistons_create(&p, 1, &r);
        OK(p.session, spar_session_set_predictor(p.session, order));
        p.b[0] = 2, p.b[1] = order > 0 ? 3 : 0, p.b[2] = order > 1 ? -4 : 0;
        polynomial(p.session, 0, 0, 0, &p);
        for (int i = 0; i < 5; i++) {
            OK(p.session, spar_step(p.session, dts[i], polynomial, &p, NULL));
            OK(p.session, spar_session_get_report(p.session, SPAR_REPORT_COUNT, rep));
            assert_true(i < order ? rep[SPAR_REPORT_ERROR] > 0.01 : rep[SPAR_REPORT_ERROR] < 1e-13);
        }
        pistons_destroy(&p);
    }
}

/* The load predicted for t + dt, less what it then is: a ramp lags by one step's increment with order 0 and by nothing
   with order 1, which is behind a parabola by its second difference; order 2 by nothing. */
static void predictor_lags(void **state) {
    (void)state;
    static const struct {
        int order, degree;
        double lag; /* of b_degree dt^degree */
    } cases[] = {{0, 1, 1}, {1, 1, 0}, {1, 2, 2}, {2, 2, 0}};
    static const double dt = 0.1, r = 0;
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        pistons p;
        double predicted[6];
        pistons_create(&p, 1, &r);
        OK(p.session, spar_session_set_predictor(p.session, cases[k].order));
        p.b[0] = 2, p.b[cases[k].degree] = 3;
        polynomial(p.session, 0, 0, 0, &p);
        for (int i = 0; i < 6; i++) {
            double t = (i + 1) * dt, f = p.b[0] + p.b[1] * t + p.b[2] * t * t;
            int done;
            OK(p.session, spar_step_begin(p.session, dt));
            OK(p.session, spar_member_get_loads(p.body[0], predicted));
            if (i >= 2) {
                NEAR(f - predicted[0], cases[k].lag * 3 * pow(dt, cases[k].degree), 1e-13);
            }
            OK(p.session, spar_step_solve(p.session));
            polynomial(p.session, i * dt, dt, 0, &p);
            OK(p.session, spar_step_check(p.session, &done));
            OK(p.session, spar_step_accept(p.session));
        }
        pistons_destroy(&p);
    }
}

/* One step of a parabola; what was predicted for it, against order k's polynomial through the last values. */
static void step_of_order(pistons *p, int i, double dt, int k) {
    double f[4], predicted[6];
    int done;
    for (int j = 0; j < 4; j++) { /* at t^{n+1}, t^n, t^{n-1}, t^{n-2} */
        double t = (i + 1 - j) * dt;
        f[j] = p->b[0] + p->b[1] * t + p->b[2] * t * t;
    }
    const double expected[3] = {f[1], 2 * f[1] - f[2], f[0]};
    OK(p->session, spar_step_begin(p->session, dt));
    OK(p->session, spar_member_get_loads(p->body[0], predicted));
    NEAR(predicted[0], expected[k], 1e-13);
    OK(p->session, spar_step_solve(p->session));
    polynomial(p->session, i * dt, dt, 0, p);
    OK(p->session, spar_step_check(p->session, &done));
    OK(p->session, spar_step_accept(p->session));
}

/* No more loads are kept than the order needs; an order that is raised is reached step by step, and through a file too.
 */
static void order_may_change(void **state) {
    (void)state;
    static const int set[] = {0, 0, 0, 2, 2, 2, 2, 1, 1, 2, 2, 0, 1, 1},
                     used[] = {0, 0, 0, 0, 1, 2, 2, 1, 1, 1, 2, 0, 0, 1};
    static const double dt = 0.1, r = 0;
    static const char *const path = "order.spar";
    pistons p;
    pistons_create(&p, 1, &r);
    p.b[0] = 2, p.b[1] = -5, p.b[2] = 3;
    polynomial(p.session, -dt, dt, 0, &p);
    for (int i = 0; i < 14; i++) {
        OK(p.session, spar_session_set_predictor(p.session, set[i]));
        for (int k = 0; k < 3; k++) {
            assert_true((p.body[0]->load.history[k] != NULL) == (k <= set[i]));
        }
        step_of_order(&p, i, dt, used[i]);
    }
    for (int to = 0; to < 3; to++) { /* saved with order 1 */
        pistons other;
        OK(p.session, spar_session_save(p.session, path));
        pistons_create(&other, 1, &r);
        memcpy(other.b, p.b, sizeof p.b);
        OK(other.session, spar_session_set_predictor(other.session, to));
        OK(other.session, spar_session_load(other.session, path));
        for (int i = 14; i < 16; i++) {
            step_of_order(&other, i, dt, to < 2 ? to : i - 13);
        }
        pistons_destroy(&other);
    }
    (void)remove(path);
    pistons_destroy(&p);
}

/* ---- several fluid steps in one ---- */

/* Parts of a step: 8 over 1/4, 4 over 1/4, 2 over 1/2 have the mean 4 and the line of least squares
   4 - 7.5 (s - 1/2), which ends at 1/4 (docs/explanation/theory.md, (T13)). After no load at t = 0: 4 + (1/4 - 0) /
   2; each pass anew. */
static void pushes_over_parts(void **state) {
    (void)state;
    static const double theta[3] = {0.25, 0.5, 1}, r = 0;
    pistons p;
    double got[6];
    int done;
    pistons_create(&p, 1, &r);
    const double moment[3] = {0, 0, 1};
    double f[3] = {8, 0, 0};
    assert_int_equal(spar_fluid_push_forces_at(p.fluid[0], 1, f, NULL), SPAR_ERR_STATE);
    OK(p.session, spar_step_begin(p.session, 0.1));
    for (int pass = 0; pass < 2; pass++) {
        OK(p.session, spar_step_solve(p.session));
        for (int k = 0; k < 3; k++) {
            double bad[3] = {NAN, 0, 0};
            f[0] = (8 >> k) * (pass + 1);
            assert_int_equal(spar_fluid_push_forces_at(p.fluid[0], theta[k], bad, NULL), SPAR_ERR_ARGUMENT);
            OK(p.session, spar_fluid_push_forces_at(p.fluid[0], theta[k], f, k == 1 ? moment : NULL));
        }
        OK(p.session, spar_step_check(p.session, &done));
        OK(p.session, spar_member_get_loads(p.body[0], got));
        NEAR(got[0], 4.125 * (pass + 1), 1e-14);
        NEAR(got[5], 0.25 + 0.5 * (0.25 - 6 * 0.25 * 0.125), 1e-15);
    }
    assert_int_equal(spar_fluid_push_forces_at(p.fluid[0], 0, f, NULL), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_fluid_push_forces_at(p.fluid[0], 1.5, f, NULL), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_fluid_push_forces_at(p.fluid[0], NAN, f, NULL), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_fluid_push_forces_at(p.fluid[0], 1, NULL, NULL), SPAR_ERR_ARGUMENT);
    OK(p.session, spar_step_accept(p.session));
    pistons_destroy(&p);
}

/* A moment given in the parts of one step is taken up and given off by the lines through them; without the effect there
   is none. Loads are 1 from the first step on, which had none at its beginning. */
static void moments_of_parts_come_and_go(void **state) {
    (void)state;
    static const double r = 0, f[3] = {1, 0, 0}, moment[3] = {0, 0, 1}, x[3] = {0, 5, 0};
    pistons p;
    spar_member *point;
    spar_fluid *fluid;
    double got[6];
    int done;
    for (int effect = 0; effect < 2; effect++) {
        pistons_create(&p, 1, &r);
        OK(p.session, spar_point_create(p.session, "point", x, NULL, &point));
        OK(p.session, spar_member_set_effects(point, EFFECTS_ONLY(effect ? SPAR_EFFECT_FLUID_MOMENT : 0)));
        OK(p.session, spar_member_commit(point));
        OK(p.session, spar_fluid_create(point, "f", &fluid));
        OK(p.session, spar_fluid_set_force_nodes(fluid, 1, x));
        OK(p.session, spar_fluid_map(fluid));
        for (int step = 0; step < 3; step++) {
            OK(p.session, spar_step_begin(p.session, 0.1));
            OK(p.session, spar_step_solve(p.session));
            for (int k = 1; k <= 4; k++) {
                OK(p.session, spar_fluid_push_forces_at(fluid, 0.25 * k, f, step == 1 && k > 2 ? moment : NULL));
            }
            OK(p.session, spar_step_check(p.session, &done));
            OK(p.session, spar_member_get_loads(point, got));
            /* mean 1/2, end 1/2 + 6 (3/8 - 1/4) = 5/4 */
            const double expected[3] = {0, 0.5 + 0.5 * 1.25, -0.5 * 1.25};
            NEAR(got[0], step == 0 ? 1.5 : 1, 1e-14);
            NEAR(got[5], effect ? expected[step] : 0, 1e-14);
            OK(p.session, spar_step_accept(p.session));
        }
        pistons_destroy(&p);
    }
}

/* A body of 2 kg, loads over `parts` of each step; momentum at the end. rho_inf 1/2: rest settles. */
static double pushed_in_parts(int steps, double dt, int parts, double (*load)(double from, double to, int step)) {
    static const double r = 0;
    pistons p;
    double v[6];
    int done;
    pistons_create(&p, 1, &r);
    OK(p.session, spar_session_set_integrator(p.session, 0.5, 1));
    OK(p.session, spar_session_set_coupling(p.session, SPAR_COUPLING_FIXED_POINT, 1e-13, 0, 20));
    OK(p.session, spar_fluid_push_forces(p.fluid[0], (double[]){load(0, 0, -1), 0, 0}, NULL));
    for (int n = 0; n < steps; n++) {
        OK(p.session, spar_step_begin(p.session, dt));
        for (done = 0; !done;) {
            OK(p.session, spar_step_solve(p.session));
            for (int k = 0; k < parts; k++) { /* of unequal lengths */
                double a = (double)k * k / (parts * parts), b = (double)(k + 1) * (k + 1) / (parts * parts);
                double f[3] = {load(dt * (n + a), dt * (n + b), n), 0, 0};
                OK(p.session, spar_fluid_push_forces_at(p.fluid[0], b, f, NULL));
            }
            OK(p.session, spar_step_check(p.session, &done));
        }
        OK(p.session, spar_step_accept(p.session));
    }
    OK(p.session, spar_member_get_motion(p.body[0], NULL, v, NULL));
    pistons_destroy(&p);
    return 2 * v[0];
}

/* cos 2 t, its mean */
static double wave(double from, double to, int step) {
    return step < 0 ? 1 : (sin(2 * to) - sin(2 * from)) / (2 * (to - from));
}

/* Any numbers for ten steps, then none. */
static double burst(double from, double to, int step) {
    return step < 0 || step >= 10 ? 0 : sin(1e3 * (from + 2 * to)) + step;
}

static double on_off(double from, double to, int step) {
    (void)from, (void)to;
    return step < 3 ? 0 : 1;
}

/* A known load in one to four parts of a step: momentum sin(2 t) / 2, of order 2 (a mean taken for the load at the
   step's end lags: 2.8e-2 at dt = 0.05, order 1). All of the parts' impulse arrives. A load that sets in overshoots
   once, by half, and does not ring. */
static void parts_are_of_second_order(void **state) {
    (void)state;
    for (int parts = 1; parts <= 4; parts++) {
        double exact = 0.5 * sin(2 * 2.5), coarse = fabs(pushed_in_parts(50, 0.05, parts, wave) - exact),
               fine = fabs(pushed_in_parts(100, 0.025, parts, wave) - exact), impulse = 0;
        assert_true(coarse < 1e-3);
        NEAR(log2(coarse / fine), 2, 0.15);
        for (int n = 0; n < 10; n++) {
            for (int k = 0; k < parts; k++) {
                double a = (double)k * k / (parts * parts), b = (double)(k + 1) * (k + 1) / (parts * parts);
                impulse += 0.1 * (b - a) * burst(0.1 * (n + a), 0.1 * (n + b), n);
            }
        }
        NEAR(pushed_in_parts(80, 0.1, parts, burst), impulse, 1e-12);
    }
}

static void parts_do_not_ring(void **state) {
    (void)state;
    static const double r = 0;
    pistons p;
    double got[6];
    int done;
    pistons_create(&p, 1, &r);
    for (int n = 0; n < 8; n++) {
        OK(p.session, spar_step_begin(p.session, 0.1));
        OK(p.session, spar_step_solve(p.session));
        for (int k = 1; k <= 2; k++) {
            OK(p.session, spar_fluid_push_forces_at(p.fluid[0], 0.5 * k, (double[]){on_off(0, 0, n), 0, 0}, NULL));
        }
        OK(p.session, spar_step_check(p.session, &done));
        OK(p.session, spar_member_get_loads(p.body[0], got));
        NEAR(got[0], n < 3 ? 0 : n == 3 ? 1.5 : 1, 1e-15);
        OK(p.session, spar_step_accept(p.session));
    }
    pistons_destroy(&p);
}

/* ---- settings ---- */

static void settings_are_checked(void **state) {
    (void)state;
    static const char *const bad[][2] = {{"coupling.columns", "0"},      {"coupling.columns", "2.5"},
                                         {"coupling.columns", "ten"},    {"coupling.reuse", "-1"},
                                         {"coupling.filter", "0.7"},     {"coupling.filter", "nan"},
                                         {"coupling.filter", ""},        {"coupling.target", "0.01"},
                                         {"coupling.motion_atol", "-1"}, {"coupling.motion_rtol", "1e-3 m"},
                                         {"coupling.nothing", "1"},      {"ranks.state", "all"}};
    const double r = 1;
    pistons p;
    pistons_create(&p, 1, &r);
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        assert_int_equal(spar_session_set_option(p.session, bad[k][0], bad[k][1]), SPAR_ERR_ARGUMENT);
        assert_non_null(strstr(spar_session_message(p.session), bad[k][0]));
    }
    OK(p.session, spar_session_set_option(p.session, "coupling.columns", "4"));
    OK(p.session, spar_session_set_option(p.session, "coupling.reuse", "0"));
    OK(p.session, spar_session_set_option(p.session, "coupling.filter", "1e-6"));
    pistons_destroy(&p);
}

/* ---- what messages say ---- */

/* Whether 30 characters of it stand in it twice. */
static int says_twice(const char *text) {
    enum { PIECE = 30 };
    size_t n = strlen(text);
    for (size_t i = 0; i + PIECE < n; i++) {
        for (size_t j = i + 1; j + PIECE <= n; j++) {
            if (strncmp(text + i, text + j, PIECE) == 0) {
                return 1;
            }
        }
    }
    return 0;
}

/* A body free to turn, whose fluid pushes a moment of 10 N m for some steps, and then 1e56. */
static int folding_fluid(spar_session *s, double t, double dt, int iteration, void *context) {
    spar_fluid *f = context;
    double force[3] = {0, 0, 0}, moment[3] = {0, 10, 1};
    (void)s, (void)iteration;
    moment[1] *= t + dt > 0.035 ? 1e55 : 1;
    return spar_fluid_push_forces(f, force, moment);
}

/* A cure is none that is taken already; iterations are those of several attempts, and the limit is said; loads that no
   structure answers are the fluid's; nothing is said twice. */
static void messages(void **state) {
    (void)state;
    const double ratio = 100, x[3] = {0, 0, 0}, J[3] = {1, 2, 3};
    for (int scheme = SPAR_COUPLING_FIXED_POINT; scheme <= SPAR_COUPLING_IQN_ILS; scheme++) {
        pistons p;
        pistons_create(&p, 1, &ratio);
        p.b[0] = 5;
        OK(p.session, spar_session_set_coupling(p.session, scheme, 0, 1e-15, 2));
        assert_int_equal(spar_step(p.session, 0.1, pistons_fluid, &p, NULL), SPAR_ERR_NUMERIC);
        const char *message = spar_session_message(p.session);
        assert_non_null(strstr(message, "has not converged in 2 iterations"));
        assert_true(!strstr(message, "use SPAR_COUPLING_IQN_ILS") == (scheme == SPAR_COUPLING_IQN_ILS));
        assert_false(says_twice(message));
        pistons_destroy(&p);
    }
    for (int scheme = SPAR_COUPLING_EXPLICIT; scheme <= SPAR_COUPLING_IQN_ILS; scheme += SPAR_COUPLING_IQN_ILS) {
        spar_session *s = scene_session();
        spar_member *b = scene_body(s, "top", x, 1, J);
        spar_fluid *f = NULL;
        OK(s, spar_fluid_create(b, "air", &f));
        OK(s, spar_fluid_set_motion_nodes(f, 1, x));
        OK(s, spar_fluid_set_force_nodes(f, 1, x));
        OK(s, spar_fluid_map(f));
        OK(s, spar_session_set_coupling(s, scheme, 0, 1e-9, 20));
        int status = SPAR_OK;
        for (int step = 0; step < 6 && status == SPAR_OK; step++) {
            status = spar_step(s, 0.01, folding_fluid, f, NULL);
        }
        const char *message = spar_session_message(s);
        assert_int_equal(status, SPAR_ERR_NUMERIC);
        assert_non_null(strstr(message, "the fluid's loads on member 'top' have grown from 10 to "));
        assert_non_null(strstr(message, "check the fluid for"));
        assert_non_null(strstr(message, scheme == SPAR_COUPLING_EXPLICIT ? "attempts, each of 50 at most"
                                                                         : "not converged in 20 iterations"));
        assert_null(strstr(message, "use a smaller dt"));
        assert_false(says_twice(message));
        spar_session_destroy(&s);
    }
}

/* A force that jumps at first and then alternates and grows by a tenth from iteration to iteration, until Newton fails.
 */
static int creeping_fluid(spar_session *s, double t, double dt, int iteration, void *context) {
    const double force[3] = {1, 0, iteration > 0 ? 100 * pow(-1.1, iteration) : 1};
    (void)s, (void)t, (void)dt;
    return spar_fluid_push_forces(context, force, NULL);
}

/* A hundredth of the load differs from call to call. */
static int scattering_fluid(spar_session *s, double t, double dt, int iteration, void *context) {
    const double force[3] = {1 + 0.01 * sin(12.9898 * iteration * iteration), 0, 0};
    (void)s, (void)t, (void)dt;
    return spar_fluid_push_forces(context, force, NULL);
}

/* A solution that fails after the loads have grown has the coupling as its cause, which is told first, also if they did
   not grow by much in the last iterations. Loads that scatter are told of, with their level. */
static void causes(void **state) {
    (void)state;
    const double x[3] = {1, 0, 0}, ratio = 0;
    double K[36], M[36];
    scene_diagonal(K, 1e5, 1e4, 1e4, 20, 20, 20);
    scene_diagonal(M, 0.01, 0.01, 0.01, 1e-5, 5e-6, 5e-6);
    spar_session *s = scene_session();
    spar_member *b = scene_beam(s, "flap", 1, 6, 1, K, M);
    spar_fluid *f = NULL;
    OK(s, spar_member_set_root(b, SPAR_ROOT_FIXED));
    OK(s, spar_member_commit(b));
    OK(s, spar_fluid_create(b, "air", &f));
    OK(s, spar_fluid_set_force_nodes(f, 1, x));
    OK(s, spar_fluid_map(f));
    OK(s, spar_session_set_coupling(s, SPAR_COUPLING_FIXED_POINT, 0, 1e-9, 200));
    assert_int_equal(spar_step(s, 0.01, creeping_fluid, f, NULL), SPAR_ERR_NUMERIC);
    const char *message = spar_session_message(s), *cause = strstr(message, "the coupling diverges");
    print_message("%s\n", message);
    assert_non_null(cause);
    assert_true(cause < strstr(message, "Newton does not converge"));
    spar_session_destroy(&s);

    pistons p;
    pistons_create(&p, 1, &ratio);
    OK(p.session, spar_session_set_coupling(p.session, SPAR_COUPLING_IQN_ILS, 0, 1e-6, 40));
    assert_int_equal(spar_step(p.session, 0.01, scattering_fluid, p.fluid[0], NULL), SPAR_ERR_NUMERIC);
    message = spar_session_message(p.session);
    print_message("%s\n", message);
    assert_non_null(strstr(message, "rtol cannot be below"));
    assert_non_null(strstr(message, "use a larger rtol"));
    pistons_destroy(&p);
}

/* A body that all but rests, as the hub of a rotor does, has accelerations that are nothing but rounding. That is not
   why the coupling of the others fails. */
static void rest_is_not_rounding(void **state) {
    (void)state;
    const double ratio[2] = {100, 0};
    pistons p;
    pistons_create(&p, 2, ratio);
    p.b[0] = 5, p.b[1] = 1e-20;
    OK(p.session, spar_session_set_coupling(p.session, SPAR_COUPLING_IQN_ILS, 0, 1e-6, 2));
    assert_int_equal(spar_step(p.session, 0.1, pistons_fluid, &p, NULL), SPAR_ERR_NUMERIC);
    assert_non_null(strstr(spar_session_message(p.session), "has not converged in 2 iterations"));
    assert_null(strstr(spar_session_message(p.session), "the rounding of positions"));
    pistons_destroy(&p);
}

/* A first step that is rejected, or that fails, leaves the clock at rest: members may still be added. The coupling is
   then made for all of them (it kept the size of the first ones and wrote beyond it). Two bodies under a constant load:
   u = F t^2 / (2 m) in the limit; here the second is only asked to move with its own load. */
static void members_after_a_first_step(void **state) {
    (void)state;
    for (int fails = 0; fails <= 1; fails++) {
        const double ratio = 2, load[6] = {0, 4, 0, 0, 0, 0};
        pistons p;
        pistons_create(&p, 1, &ratio);
        p.b[0] = 5;
        spar_session *s = p.session;
        OK(s, spar_session_set_coupling(s, SPAR_COUPLING_IQN_ILS, 0, 1e-10, 50));
        if (fails) {
            p.bad_call = 2;
            assert_int_not_equal(spar_step(s, 0.1, pistons_fluid, &p, NULL), SPAR_OK);
            p.bad_call = 0;
        } else {
            OK(s, spar_step_begin(s, 0.1));
            OK(s, spar_step_reject(s));
        }
        spar_member *late[3];
        for (int i = 0; i < 3; i++) {
            char name[8] = {'l', (char)('0' + i), 0};
            late[i] = scene_body(s, name, (double[3]){0}, 2, (double[]){1, 1, 1});
            OK(s, spar_member_set_load(late[i], 0, SPAR_LOAD_DEAD, load));
        }
        for (int i = 0; i < 3; i++) {
            OK(s, spar_step(s, 0.1, pistons_fluid, &p, NULL));
        }
        double a[6];
        OK(s, spar_member_get_motion(p.body[0], NULL, NULL, a));
        NEAR(a[0], 5 / (1 + ratio) / 2, 5e-9);
        for (int i = 0; i < 3; i++) {
            OK(s, spar_member_get_motion(late[i], NULL, NULL, a));
            NEAR(a[1], 2, 1e-12);
        }
        pistons_destroy(&p);
    }
}

/* The host has room for as many residuals as it has asked for iterations, now. */
static void room_for_residuals(void **state) {
    (void)state;
    const double r = 0.9;
    double residual[3] = {-1, -1, -1}, size[3] = {-1, -1, -1};
    int iterations;
    pistons p;
    pistons_create(&p, 1, &r);
    p.b[0] = 5;
    OK(p.session, spar_session_set_predictor(p.session, 0));
    OK(p.session, spar_session_set_coupling(p.session, SPAR_COUPLING_FIXED_POINT, 0, 1e-6, 300));
    OK(p.session, spar_step(p.session, 0.1, pistons_fluid, &p, &iterations));
    assert_true(iterations > 50);
    OK(p.session, spar_session_get_iterations(p.session, &iterations, 2, residual, size));
    assert_true(iterations > 50);
    NEAR(residual[1], 5 * 0.9, 1e-12); /* 5 r^k: the first ones */
    assert_true(residual[2] == -1 && size[2] == -1);
    assert_int_equal(spar_session_get_iterations(p.session, &iterations, -1, residual, size), SPAR_ERR_ARGUMENT);
    assert_true(residual[0] > 0 && strstr(spar_session_message(p.session), "capacity is -1"));
    pistons_destroy(&p);
}

/* Loads f^0, f^1 on a body of 2 kg a step of `first` apart, then a step of 1 ms: predicted is f^1 + R (f^1 - f^0) with
   R the ratio of the steps, at most 10 (unbounded it was 1e27, and Newton was blamed). */
static void extrapolation_has_a_reach(void **state) {
    (void)state;
    const double none = 0, first[] = {1e-30, 1e-6, 5e-4};
    for (int k = 0; k < 3; k++) {
        pistons p;
        double a[6], R = 1e-3 / first[k];
        pistons_create(&p, 1, &none);
        p.b[0] = 1;
        OK(p.session, spar_fluid_push_forces(p.fluid[0], (double[]){1, 0, 0}, NULL));
        p.b[0] = 1.125;
        OK(p.session, spar_step(p.session, first[k], pistons_fluid, &p, NULL));
        OK(p.session, spar_step_begin(p.session, 1e-3));
        OK(p.session, spar_step_solve(p.session));
        OK(p.session, spar_member_get_motion(p.body[0], NULL, NULL, a));
        NEAR(a[0], (1.125 + (R < 10 ? R : 10) * 0.125) / 2, 1e-12);
        pistons_destroy(&p);
    }
}

/* Order 2 through values a step of 1e-12 and one of 0.1 apart is order 1: f^2 + (f^2 - f^1), not 1e11 (f^1 - f^0). */
static void no_curve_through_close_values(void **state) {
    (void)state;
    const double none = 0;
    pistons p;
    double a[6];
    pistons_create(&p, 1, &none);
    OK(p.session, spar_session_set_predictor(p.session, 2));
    OK(p.session, spar_fluid_push_forces(p.fluid[0], (double[]){1, 0, 0}, NULL));
    p.b[0] = 1.25;
    OK(p.session, spar_step(p.session, 1e-12, pistons_fluid, &p, NULL));
    p.b[0] = 1.5;
    OK(p.session, spar_step(p.session, 0.1, pistons_fluid, &p, NULL));
    OK(p.session, spar_step_begin(p.session, 0.1));
    OK(p.session, spar_step_solve(p.session));
    OK(p.session, spar_member_get_motion(p.body[0], NULL, NULL, a));
    NEAR(a[0], 1.75 / 2, 1e-12);
    pistons_destroy(&p);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(explicit_limits),
        cmocka_unit_test(ratios),
        cmocka_unit_test(channel_modes),
        cmocka_unit_test(report),
        cmocka_unit_test(added_mass_with_spread),
        cmocka_unit_test(explicit_error_is_told),
        cmocka_unit_test(fixed_number_of_iterations),
        cmocka_unit_test(on_after_done),
        cmocka_unit_test(own_loop_to_the_limit),
        cmocka_unit_test(unconverged),
        cmocka_unit_test(motion_test),
        cmocka_unit_test(nan_in_the_third_iteration),
        cmocka_unit_test(instability_warning),
        cmocka_unit_test(rounding_is_no_instability),
        cmocka_unit_test(predictor_is_exact),
        cmocka_unit_test(predictor_lags),
        cmocka_unit_test(order_may_change),
        cmocka_unit_test(pushes_over_parts),
        cmocka_unit_test(parts_are_of_second_order),
        cmocka_unit_test(parts_do_not_ring),
        cmocka_unit_test(moments_of_parts_come_and_go),
        cmocka_unit_test(settings_are_checked),
        cmocka_unit_test(messages),
        cmocka_unit_test(causes),
        cmocka_unit_test(rest_is_not_rounding),
        cmocka_unit_test(members_after_a_first_step),
        cmocka_unit_test(room_for_residuals),
        cmocka_unit_test(extrapolation_has_a_reach),
        cmocka_unit_test(no_curve_through_close_values),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
