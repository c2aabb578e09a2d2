/* The added mass learned from iterations (spar_member_learn_added_mass) through what happens to a run: steps given up,
   trials, files, failures, substeps, joints, directions that move little. docs/explanation/theory.md, (T21) to
   (T23). */
#include "buoy.h"
#include "trials.h"

#include <stdio.h>

static const double ratios[] = {1, 10, 100};
enum { RATIOS = 3 };

/* ---- steps given up ---- */

/* The step fails in the second evaluation of the fluid; with loads that are no numbers; it is rejected with loads that
   no structure bears, of which the coupling takes a part. What is learned stays as it was. */
static void fail_in_all_ways(buoy *b) {
    double before[37], after[37], f[3] = {NAN, 0, 0}, m[3] = {1e40, 1e40, 1e40};
    int done;
    OK(b->session, spar_member_get_learned_added_mass(b->body, NULL, before + 36, NULL, 1, NULL, before));
    b->failing = b->calls + 2;
    assert_int_equal(spar_step(b->session, 0.02, buoy_fluid, b, NULL), SPAR_ERR_USER);
    for (int way = 0; way < 2; way++) {
        OK(b->session, spar_step_begin(b->session, 0.02));
        OK(b->session, spar_step_solve(b->session));
        f[0] = way == 0 ? NAN : 0;
        int pushed = spar_fluid_push_forces(b->fluid, f, way == 0 ? NULL : m);
        int status = spar_step_check(b->session, &done);
        status = status == SPAR_OK ? spar_step_solve(b->session) : status;
        assert_true((way == 1 || status != SPAR_OK) && (way == 0) == (pushed != SPAR_OK));
        OK(b->session, spar_step_reject(b->session));
    }
    OK(b->session, spar_member_get_learned_added_mass(b->body, NULL, after + 36, NULL, 1, NULL, after));
    assert_memory_equal(before, after, sizeof before);
}

/* Steps given up at every stage, trials, and files written and read between steps and in the middle of one change no
   bit of what is learned, nor of the motion (without columns of earlier steps: these go with steps given up). Steps
   that fail in the fluid, or are fed loads that no structure bears, change it by the rounding of other tangents: 1e-9.
 */
static void bits(void **state) {
    (void)state;
    static const char path[] = "learned_mass.spar";
    static double seen[4][7 + 36 + 2];
    for (int way = 0; way < 4; way++) { /* undisturbed; steps given up and trials; files; failures */
        buoy b;
        int used, done;
        double report[TRY_COUNT];
        buoy_create(&b, 10, 1);
        OK(b.session, spar_session_set_option(b.session, "coupling.reuse", "0"));
        for (int step = 0; step < 30; step++) {
            unsigned long long seed = b.seed;
            for (int stage = 0; stage < 3 && way == 1; stage++) {
                OK(b.session, spar_step_begin(b.session, 0.02));
                for (int i = 0; i < stage; i++) {
                    OK(b.session, spar_step_solve(b.session));
                    OK(b.session, buoy_fluid(b.session, 0, 0.02, i, &b));
                    OK(b.session, spar_step_check(b.session, &done));
                }
                OK(b.session, spar_step_reject(b.session));
            }
            if (way == 1 && step == 8) {
                OK(b.session, trial_run(b.session, 0.02, 16, NULL, buoy_fluid, &b, 0, report));
            }
            if (way == 3) {
                fail_in_all_ways(&b);
            }
            b.seed = seed;
            OK(b.session, spar_step_begin(b.session, 0.02));
            done = 0;
            for (int i = 0; !done; i++) {
                OK(b.session, spar_step_solve(b.session));
                if (way == 2 && (i == 1 || i == 2)) {
                    buoy kept = b;
                    OK(b.session, spar_session_save(b.session, path));
                    spar_session_destroy(&b.session);
                    buoy_create(&b, 10, 1);
                    OK(b.session, spar_session_set_option(b.session, "coupling.reuse", "0"));
                    OK(b.session, spar_session_load(b.session, path));
                    memcpy(b.drive, kept.drive, sizeof b.drive);
                    b.seed = kept.seed;
                }
                OK(b.session, buoy_fluid(b.session, 0, 0.02, i, &b));
                OK(b.session, spar_step_check(b.session, &done));
            }
            OK(b.session, spar_step_accept(b.session));
            if (way == 2) {
                buoy kept = b;
                OK(b.session, spar_session_save(b.session, path));
                spar_session_destroy(&b.session);
                buoy_create(&b, 10, 1);
                OK(b.session, spar_session_set_option(b.session, "coupling.reuse", "0"));
                OK(b.session, spar_session_load(b.session, path));
                b.seed = kept.seed;
            }
        }
        OK(b.session, spar_member_get_motion(b.body, seen[way], NULL, NULL));
        OK(b.session, spar_member_get_learned_added_mass(b.body, &used, &seen[way][43], NULL, 1, NULL, seen[way] + 7));
        seen[way][44] = used;
        assert_true(used);
        if (way == 2) { /* a session that learns nothing has another description */
            OK(b.session, spar_session_save(b.session, path));
            spar_session_destroy(&b.session);
            buoy_create(&b, 10, 0);
            assert_int_not_equal(spar_session_load(b.session, path), SPAR_OK);
        }
        spar_session_destroy(&b.session);
    }
    assert_memory_equal(seen[1], seen[0], sizeof seen[0]);
    assert_memory_equal(seen[2], seen[0], sizeof seen[0]);
    for (int i = 0; i < 45; i++) { /* a solution that fails leaves another tangent to begin with */
        NEAR(seen[3][i], seen[0][i], 1e-9 * 10);
    }
    (void)remove(path);
}

/* ---- substeps ---- */

/* With 2, 3 and 5 substeps fluids see mean accelerations until the mass is known (T15), and from then on those of the
   body. It is learned from what they see: the fluid's own mass to 1e-6, as with one substep, and fixed points, which
   diverge from ratio 1 on without, take 5 evaluations to 1e-9. */
static void substeps(void **state) {
    (void)state;
    static const int counts[] = {2, 3, 5};
    for (int k = 0; k < RATIOS * 3; k++) {
        double M[36], spread;
        int used = 0, most = 0, at = 0;
        buoy b;
        buoy_create(&b, ratios[k % RATIOS], 1);
        OK(b.session, spar_session_set_integrator(b.session, 0.9, counts[k / RATIOS]));
        for (int step = 0; step < 40; step++) {
            (void)buoy_step(&b, 0.01);
            OK(b.session, spar_member_get_learned_added_mass(b.body, &used, &spread, NULL, 1, NULL, M));
            at = used && at == 0 ? step + 1 : at;
        }
        OK(b.session, spar_session_set_coupling(b.session, SPAR_COUPLING_FIXED_POINT, 1e-12, 1e-9, 300));
        for (int i = 0; i < 10; i++) {
            int n = buoy_step(&b, 0.01);
            most = n > most ? n : most;
        }
        double off = largest_difference(M, b.added, 36) / ratios[k % RATIOS];
        print_message("%d substeps, added mass %g: used from step %d on, off by %.1e, fixed point %d\n",
                      counts[k / RATIOS], ratios[k % RATIOS], at, off, most);
        assert_true(used && at < 10 && most <= 5);
        NEAR(off, 0, 1e-6);
        spar_session_destroy(&b.session);
    }
}

/* ---- directions that move little ---- */

/* A first step that moves the body along one axis a thousand times as far as later ones move it along another: both
   are known to 1e-6 as soon as each has been seen in two steps. A direction that was foretold wrongly because nothing
   had moved along it is not the fluid's noise, and does not make others doubtful. */
static void seen_a_little(void **state) {
    (void)state;
    for (int k = 0; k < RATIOS; k++) {
        double M[36], spread;
        buoy b;
        buoy_create(&b, ratios[k], 1);
        for (int i = 0; i < 36; i++) {
            b.added[i] = i % 7 == 0 ? b.added[i] : 0;
        }
        for (int step = 0; step < 12; step++) {
            int done = 0;
            buoy_turn(&b);
            OK(b.session, spar_step_begin(b.session, 0.01));
            while (!done) {
                double a[6], f[6] = {0};
                OK(b.session, spar_step_solve(b.session));
                OK(b.session, spar_fluid_pull_poses(b.fluid, SPAR_NODES_MOTION, 1, NULL, NULL, NULL, NULL, a, a + 3));
                spari_rotate_back(b.axes, a, a);
                f[0] = -b.added[0] * a[0] + (step == 0 ? 1 : 0);
                f[1] = -b.added[7] * a[1] + 1e-3 * (step % 3);
                spari_rotate(b.axes, f, f);
                OK(b.session, spar_fluid_push_forces(b.fluid, f, f + 3));
                OK(b.session, spar_step_check(b.session, &done));
            }
            OK(b.session, spar_step_accept(b.session));
        }
        OK(b.session, spar_member_get_learned_added_mass(b.body, NULL, &spread, NULL, 1, NULL, M));
        print_message("added mass %g: seen little off by %.1e, spread %.1e\n", ratios[k], fabs(M[7] / b.added[7] - 1),
                      spread);
        NEAR(M[0], b.added[0], 1e-6 * ratios[k]);
        NEAR(M[7], b.added[7], 1e-6 * ratios[k]);
        spar_session_destroy(&b.session);
    }
}

/* ---- members that joints tie ---- */

typedef struct raft {
    spar_session *session;
    spar_member *arm, *body;
    spar_fluid *fluid;
    double added;
} raft;

/* arm: the fidelity of a beam of 1 m that is welded to the ground and carries a body of 2 kg on a hinge; -1: a body on
   two hinges in its place, and a rigid beam is on a hinge. The fluid is around the second body. */
static void raft_create(raft *r, int arm, double ratio, int learn) {
    static const double origin[3] = {0}, tip[3] = {1, 0, 0}, q[4] = {1, 0, 0, 0}, J[3] = {0.1, 0.2, 0.3}, eta[1] = {0};
    double K[36], M[36], mass[36];
    spar_joint *j = NULL;
    memset(r, 0, sizeof *r);
    spar_session *s = r->session = scene_session();
    r->added = 2 * ratio;
    scene_mass(mass, 2, (double[]){0.4, 0, 0.1}, J);
    if (arm < 0) {
        OK(s, spar_rigid_create(s, "arm", origin, q, mass, &r->arm));
    } else {
        scene_diagonal(K, 4e5, 4e5, 4e5, 130, 100, 150);
        scene_diagonal(M, 1, 1, 1, 0.02, 0.01, 0.01);
        r->arm = scene_beam(s, "arm", 2, 4, 1, K, M);
        OK(s, spar_member_set_root(r->arm, SPAR_ROOT_FREE));
        OK(s, spar_member_set_fidelity(r->arm, arm, 0));
    }
    OK(s, spar_rigid_create(s, "body", tip, q, mass, &r->body));
    OK(s,
       spar_joint_create(s, "foot", r->arm, 0, NULL, 0, arm < 0 || arm == SPAR_FIDELITY_RIGID ? SPAR_FREE_RY : 0, &j));
    OK(s, spar_joint_set_frame(j, origin, q));
    OK(s, spar_joint_create(s, "knee", r->body, 0, r->arm, arm < 0 ? 0 : 7, SPAR_FREE_RY, &j));
    OK(s, spar_joint_set_frame(j, tip, q));
    OK(s, spar_member_learn_added_mass(r->arm, learn, eta));
    OK(s, spar_member_learn_added_mass(r->body, learn, NULL));
    OK(s, spar_member_commit(r->arm));
    OK(s, spar_member_commit(r->body));
    OK(s, spar_fluid_create(r->body, "water", &r->fluid));
    OK(s, spar_fluid_set_motion_nodes(r->fluid, 1, tip));
    OK(s, spar_fluid_set_force_nodes(r->fluid, 1, tip));
    OK(s, spar_fluid_map(r->fluid));
    OK(s, spar_session_set_coupling(s, SPAR_COUPLING_IQN_ILS, 1e-12, 1e-9, 200));
}

static int raft_fluid(spar_session *s, double t, double dt, int iteration, void *context) {
    raft *r = context;
    double a[3];
    (void)iteration;
    OK(s, spar_fluid_pull_poses(r->fluid, SPAR_NODES_MOTION, 1, NULL, NULL, NULL, NULL, a, NULL));
    const double f[3] = {0.1 - r->added * a[0], 0.3 * sin(9 * (t + dt)) - r->added * a[1],
                         0.2 * cos(7 * (t + dt)) - r->added * a[2]};
    return spar_fluid_push_forces(r->fluid, f, NULL);
}

static void raft_run(raft *r, int steps, int *most) {
    for (int i = 0; i < steps; i++) {
        int n;
        OK(r->session, spar_step(r->session, 0.01, raft_fluid, r, &n));
        *most = n > *most ? n : *most;
    }
}

/* A body in a heavy fluid on a hinge at an exact or rigid beam, or at another body, both learning: of the body its
   fluid's mass where joints let it move, to 1e-4 (in the equations within 2 per cent), of the arm, which has no fluid,
   none. Fixed points, which diverge without, take 12 evaluations at most; the answer is that without, to 1e-7 of the
   way. */
static void tied(void **state) {
    (void)state;
    static const int arms[] = {-1, SPAR_FIDELITY_EXACT, SPAR_FIDELITY_RIGID};
    enum { ARMS = sizeof arms / sizeof *arms };
    for (int k = 0; k < ARMS * RATIOS; k++) {
        double ratio = ratios[k % RATIOS], q[2][7], M[36], none[36], spread;
        int used = 0, most = 0, sum[2] = {0, 0};
        raft r;
        for (int learn = 0; learn < 2; learn++) {
            raft_create(&r, arms[k / RATIOS], ratio, learn);
            raft_run(&r, 60, &sum[learn]); /* enough secants that differ: half as many leave 1e-3 of the mass */
            OK(r.session, spar_member_get_motion(r.body, q[learn], NULL, NULL));
            if (learn == 0) {
                OK(r.session, spar_session_set_coupling(r.session, SPAR_COUPLING_FIXED_POINT, 1e-12, 1e-9, 200));
                assert_true(ratio < 10 || spar_step(r.session, 0.01, raft_fluid, &r, NULL) == SPAR_ERR_NUMERIC);
                spar_session_destroy(&r.session);
            }
        }
        OK(r.session, spar_member_get_learned_added_mass(r.arm, NULL, NULL, NULL, 1, NULL, none));
        OK(r.session, spar_member_get_learned_added_mass(r.body, &used, &spread, NULL, 1, NULL, M));
        OK(r.session, spar_session_set_coupling(r.session, SPAR_COUPLING_FIXED_POINT, 1e-12, 1e-9, 200));
        raft_run(&r, 10, &most);
        print_message("arm %d, added mass %g: learned %.9g %.9g, arm %.1e, spread %.1e, apart %.1e, most %d %d, fixed "
                      "point %d\n",
                      arms[k / RATIOS], ratio, M[7] / 2, M[14] / 2, none[14], spread, largest_difference(q[0], q[1], 7),
                      sum[0], sum[1], most);
        assert_true(used && most <= 12);
        NEAR(M[14], r.added, 1e-4 * r.added);
        NEAR(none[14], 0, 1e-12);
        NEAR(largest_difference(q[0], q[1], 7), 0, 1e-7);
        spar_session_destroy(&r.session);
    }
}

/* ---- asked for the error of its nodes ---- */

/* A curved beam in a fluid that answers its accelerations, at its root and on springs and dampers at its tip; the added
   mass is learned at three stations. */
enum { BENT = 4 };

typedef struct bent {
    spar_session *session;
    spar_member *beam;
    spar_joint *foot;
    spar_fluid *fluid;
} bent;

static int bent_fluid(spar_session *s, double t, double dt, int iteration, void *context) {
    const bent *b = context;
    double a[3 * BENT], f[3 * BENT];
    (void)s, (void)iteration;
    int status = spar_fluid_pull_poses(b->fluid, SPAR_NODES_MOTION, 1, NULL, NULL, NULL, NULL, a, NULL);
    for (int i = 0; i < 3 * BENT; i++) {
        f[i] = -0.8 * a[i] + sin(9 * (t + dt) + i);
    }
    return status == SPAR_OK ? spar_fluid_push_forces(b->fluid, f, NULL) : status;
}

static void bent_create(bent *b) {
    const double eta[4] = {0, 0.3, 0.7, 1}, axis[12] = {0, 0, 0, 0.5, 0.1, 0, 1.2, 0.3, 0.05, 1.7, 0.7, 0.2};
    double K[36], M[36];
    b->session = scene_session();
    scene_diagonal(K, 1e6, 1e5, 1e5, 300, 400, 500);
    scene_diagonal(M, 2, 2, 2, 0.02, 0.01, 0.01);
    OK(b->session, spar_beam_create(b->session, "bent", 2, 5, &b->beam));
    OK(b->session, spar_beam_set_axis(b->beam, 4, eta, axis, NULL));
    OK(b->session, spar_beam_set_sections(b->beam, 1, eta, K, M));
    OK(b->session, spar_member_set_effects(b->beam, SPAR_EFFECT_WORK, 0));
    OK(b->session, spar_member_learn_added_mass(b->beam, 3, (const double[]){0, 0.5, 1}));
    OK(b->session, spar_member_commit(b->beam));
    scene_diagonal(K, 50, 50, 50, 1, 1, 1);
    scene_diagonal(M, 2, 2, 2, 0.1, 0.1, 0.1);
    b->foot = scene_joint(b->session, "foot", b->beam, 9, NULL, 0, 63);
    OK(b->session, spar_joint_set_spring(b->foot, K, M, NULL));
    OK(b->session, spar_fluid_create(b->beam, "fluid", &b->fluid));
    OK(b->session, spar_fluid_set_motion_nodes(b->fluid, BENT, axis));
    OK(b->session, spar_fluid_set_force_nodes(b->fluid, BENT, axis));
    OK(b->session, spar_fluid_map(b->fluid));
    OK(b->session, spar_session_set_coupling(b->session, SPAR_COUPLING_IQN_ILS, 1e-12, 1e-9, 100));
}

/* Asking in every step changes no bit of the motion, of what is learned, and of the accounts. (Those of joints began
   anew at zero, and what is learned was measured by the length that the finer nodes have.) */
static void error_is_asked(void **state) {
    (void)state;
    enum { Q = 70, ENERGY = Q, LEARNED = Q + SPAR_JOINT_ENERGY_COUNT, ALL = LEARNED + 3 * 36 + 2 };
    static double seen[2][ALL];
    for (int way = 0; way < 2; way++) {
        bent b;
        int used = 0;
        double error = 0;
        bent_create(&b);
        for (int step = 0; step < 24; step++) {
            OK(b.session, spar_step(b.session, 0.01, bent_fluid, &b, NULL));
            OK(b.session, way ? spar_member_estimate_error(b.beam, NULL, &error) : SPAR_OK);
        }
        OK(b.session, spar_member_get_motion(b.beam, seen[way], NULL, NULL));
        OK(b.session, spar_joint_get_energy(b.foot, SPAR_JOINT_ENERGY_COUNT, seen[way] + ENERGY));
        OK(b.session,
           spar_member_get_learned_added_mass(b.beam, &used, &seen[way][ALL - 2], NULL, 3, NULL, seen[way] + LEARNED));
        assert_true(used && (way == 0 || error > 0));
        assert_true(seen[way][ENERGY + SPAR_JOINT_ENERGY_DAMPER] > 0);
        spar_session_destroy(&b.session);
    }
    for (int i = 0; i < ALL; i++) {
        NEAR(seen[1][i], seen[0][i], 0);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bits), cmocka_unit_test(substeps),       cmocka_unit_test(seen_a_little),
        cmocka_unit_test(tied), cmocka_unit_test(error_is_asked),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
