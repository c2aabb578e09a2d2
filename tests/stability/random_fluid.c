/* Any sequence of steps, as random_steps.c, in a fluid that is nothing but added mass: beams of each fidelity, clamped,
   a rod on a hinge and a body on a spring, with explicit coupling and little of it, and with IQN-ILS and as much and
   four times as much as the structure has. The fluid's energy, half its mass times the squares of the nodes'
   velocities, counts with the structure's. It stays below what it began with but for (W h)^2 (3/8 + 0.08 W T) of the
   largest kinetic energy: as in random_mechanisms.c, and 1/8 for the loads, which are taken as linear within a step. W
   is the lowest frequency in the fluid, or how fast the rod turns.

   Accelerations are those that fluids pull, (T15). To the members' own of t^{n+1} a fluid of twice a beam's mass must
   not answer where dt changes: TR-BDF2 takes its loads as linear within a step, so that the first stage does not see
   its mass, and modes with a period of 1 to 3 steps grow (at four times the mass by 13 % a step; the largest force was
   78 000 times too large in steps that shrink). */
#include "sequences.h"

enum { EXACT, LINEAR, MODAL, ROD, SPRING, SCENES };
static const char *const names[SCENES] = {"exact beam", "linear beam", "modal beam", "rod on a hinge",
                                          "body on a spring"};
static const double steps[SCENES] = {0.002, 0.002, 0.002, 0.01, 0.02}, times[SCENES] = {0.2, 0.2, 0.2, 0.8, 2};
/* Lowest frequency without the fluid, rad/s: 3.516 sqrt(EI/m)/L^2, sqrt(k/m); of the rod how fast it falls. */
static const double frequency[SCENES] = {111, 111, 111, 5.5, 6.3};

static const struct {
    const char *name;
    int scheme;
    double added, guess; /* of the added mass, which the structure's equations have */
    int differences;     /* it takes accelerations from velocities at both ends of the step, as flow solvers do */
} fluids[] = {{"explicit, 0.05", SPAR_COUPLING_EXPLICIT, 0.05, 0, 0},
              {"IQN-ILS, 1", SPAR_COUPLING_IQN_ILS, 1, 0, 0},
              {"IQN-ILS, 4", SPAR_COUPLING_IQN_ILS, 4, 0, 0},
              {"IQN-ILS, 4, 3 known", SPAR_COUPLING_IQN_ILS, 4, 3, 0},
              {"IQN-ILS, 4, velocity", SPAR_COUPLING_IQN_ILS, 4, 0, 1}};
enum { FLUIDS = 5, NODES = 6 };

typedef struct bath {
    sequence_world w;
    spar_fluid *fluid;
    int nodes;
    double mass[NODES];              /* of the fluid, at the nodes */
    double guess, before[3 * NODES]; /* before: velocities at t^n */
    int differences;
} bath;

/* Before the first member's commit. */
static void prepare(bath *b) {
    const double g = b->guess, eta = 0;
    double guess[36];
    scene_diagonal(guess, g, g, g, 0, 0, 0);
    OK(b->w.s, spar_member_set_effects(b->w.m[0], SPAR_EFFECT_WORK, 0));
    if (g > 0) {
        OK(b->w.s, spar_member_set_added_mass(b->w.m[0], 1, &eta, guess));
    }
}

static int answer(spar_session *s, double t, double dt, int iteration, void *context) {
    bath *b = context;
    double v[3 * NODES], a[3 * NODES], f[3 * NODES];
    (void)t, (void)iteration;
    OK(s, spar_fluid_pull_poses(b->fluid, SPAR_NODES_MOTION, 1, NULL, NULL, v, NULL, a, NULL));
    for (int i = 0; b->differences && dt > 0 && i < 3 * b->nodes; i++) {
        a[i] = (v[i] - b->before[i]) / dt;
    }
    for (int i = 0; i < b->nodes; i++) {
        for (int k = 0; k < 3; k++) {
            f[3 * i + k] = -b->mass[i] * a[3 * i + k];
        }
    }
    return spar_fluid_push_forces(b->fluid, f, NULL);
}

/* Let go from where a load at its tip has bent it to; 1 m, 1 kg/m, EI 1e3. */
static void clamped(bath *b, int fidelity) {
    const double load[6] = {0, 0, 1.2, 0, 0, 0}, none[6] = {0};
    double K[36], M[36];
    scene_diagonal(K, 1e6, 1e6, 1e6, 1e3, 1e3, 1e3);
    scene_diagonal(M, 1, 1, 1, 2e-3, 1e-3, 1e-3);
    spar_session *s = b->w.s;
    spar_member *m = b->w.m[0] = scene_beam(s, "beam", 1, NODES, 1, K, M);
    OK(s, spar_member_set_fidelity(m, fidelity, fidelity == SPAR_FIDELITY_MODAL ? 8 : 0));
    prepare(b);
    OK(s, spar_member_commit(m));
    OK(s, spar_member_set_load(m, NODES - 1, SPAR_LOAD_DEAD, load));
    OK(s, spar_member_solve_static(m, 1));
    OK(s, spar_member_set_load(m, NODES - 1, SPAR_LOAD_DEAD, none));
    b->nodes = NODES;
}

static void body(bath *b, int kind) {
    const double centre[3] = {0, 0, 0}, straight[4] = {1, 0, 0, 0}, x[3] = {kind == ROD ? 0.5 : 0, 0, 0},
                 J[3] = {1.0 / 120, 1.0 / 12, 1.0 / 12}, k[36] = {[14] = 40};
    double mass[36];
    spar_session *s = b->w.s;
    scene_mass(mass, 1, centre, J);
    OK(s, spar_rigid_create(s, "body", x, straight, mass, &b->w.m[0]));
    prepare(b);
    OK(s, spar_member_commit(b->w.m[0]));
    b->w.j[0] = scene_joint_at(s, "joint", b->w.m[0], 0, NULL, 0, kind == ROD ? SPAR_FREE_RY : SPAR_FREE_Z,
                               (double[]){0, 0, 0});
    b->w.joints = 1;
    if (kind == SPRING) {
        OK(s, spar_joint_set_spring(b->w.j[0], k, NULL, NULL));
        OK(s, spar_member_set_initial_velocity(b->w.m[0], x, (double[]){0, 0, 1}, NULL));
    } else {
        OK(s, spar_session_set_gravity(s, (double[]){0, 0, -9.81}));
    }
    b->nodes = 1;
}

static void make(bath *b, int kind, int fluid, double rho) {
    double x[3 * NODES] = {0}, length = kind < ROD ? 1 : 0;
    *b = (bath){.w = {.s = scene_session(), .members = 1},
                .guess = fluids[fluid].guess,
                .differences = fluids[fluid].differences};
    spar_session *s = b->w.s;
    OK(s, spar_session_set_integrator(s, rho, 1));
    OK(s, spar_session_set_coupling(s, fluids[fluid].scheme, 0, 1e-6, 100));
    if (kind < ROD) {
        static const int fidelity[] = {SPAR_FIDELITY_EXACT, SPAR_FIDELITY_LINEAR, SPAR_FIDELITY_MODAL};
        clamped(b, fidelity[kind]);
    } else {
        body(b, kind);
    }
    OK(s, spar_member_get_reference(b->w.m[0], x, NULL));
    for (int i = 0; i < b->nodes; i++) { /* a node's half of the way to its neighbours */
        double left = i ? x[3 * i - 3] : 0, right = i + 1 < b->nodes ? x[3 * i + 3] : length;
        b->mass[i] = fluids[fluid].added * (kind < ROD ? 0.5 * (right - left) : 1);
    }
    OK(s, spar_fluid_create(b->w.m[0], "water", &b->fluid));
    OK(s, spar_fluid_set_force_nodes(b->fluid, b->nodes, x));
    OK(s, spar_fluid_set_motion_nodes(b->fluid, b->nodes, x));
    OK(s, spar_fluid_map(b->fluid));
    OK(s, spar_fluid_pull_motion(b->fluid, 1, NULL, b->before));
    OK(s, spar_session_solve_initial(s, 1e-3 * steps[kind], answer, b, NULL));
}

static double energy(const bath *b, double *kinetic) {
    double v[6 * NODES], sum = sequence_energy(&b->w, kinetic);
    OK(b->w.s, spar_member_get_motion(b->w.m[0], NULL, v, NULL));
    for (int i = 0; i < b->nodes; i++) {
        double part = 0.5 * b->mass[i] * spari_dot(v + 6 * i, v + 6 * i);
        sum += part, *kinetic += part;
    }
    return sum;
}

typedef struct found {
    double force, gain; /* the largest; gain by the largest kinetic energy, or the first */
    double mean;        /* evaluations a step */
    int refused;
} found;

/* Accelerations have the rounding of positions of 0.5 m over (0.29 dt)^2: 7e-7 of 1 m/s^2 at 3e-5 s. IQN-ILS ends where
   its tolerance, 1e-6 of 8 N, is ten times that. Shorter steps may be refused; then the next one is taken from where
   this one began. */
static const double rounding = 3e-5;

static found run(int kind, int fluid, double rho, int pattern, double h, double factor) {
    bath b;
    make(&b, kind, fluid, rho);
    double size, first = energy(&b, &size), gain = 0, most = fabs(first);
    found f = {0};
    int n = 0;
    for (int k = 0; b.w.t < times[kind]; k++) {
        double kinetic, dt = sequence_step(pattern, k, h, factor);
        int iterations;
        int status = spar_step(b.w.s, dt, answer, &b, &iterations);
        if (status == SPAR_ERR_NUMERIC && dt < rounding) {
            assert_non_null(strstr(spar_session_message(b.w.s), "the rounding of positions"));
            f.refused++;
            continue;
        }
        if (status != SPAR_OK) {
            fail_msg("step %d, dt %g: %s", k, dt, spar_session_message(b.w.s));
        }
        b.w.t += dt;
        OK(b.w.s, spar_fluid_pull_motion(b.fluid, 1, NULL, b.before));
        f.mean += iterations, n++;
        f.force = fmax(f.force, sequence_force(&b.w, 0));
        gain = fmax(gain, energy(&b, &kinetic) - first);
        most = fmax(most, kinetic);
    }
    f.gain = gain / most;
    f.mean /= n;
    spar_session_destroy(&b.w.s);
    return f;
}

typedef struct tally {
    int sequences, failed, refused;
    double gain, force, mean; /* the worst: gain, ratio of the force to that of even steps, evaluations a step */
} tally;

static void check(int kind, int fluid, double rho, int pattern, double factor, const found *even, tally *sum) {
    const double W = kind == ROD ? frequency[kind] : frequency[kind] / sqrt(1 + fluids[fluid].added),
                 h = 1.5 * steps[kind], bound = W * h * W * h * (0.375 + 0.08 * W * times[kind]) + 1e-3;
    found f = run(kind, fluid, rho, pattern, steps[kind], factor);
    sum->sequences++;
    sum->gain = fmax(sum->gain, f.gain);
    sum->force = fmax(sum->force, f.force / even->force);
    sum->refused += f.refused;
    sum->mean = fmax(sum->mean, f.mean);
    if (!(f.force < 1.5 * even->force) || !(f.gain < bound)) {
        print_message("%s, %s, rho_inf %g, sequence %d over %g: force %g for %g, gain %.1e, at most %.1e\n",
                      names[kind], fluids[fluid].name, rho, pattern, factor, f.force, even->force, f.gain, bound);
        sum->failed++;
    }
}

static void test_energy_and_forces(void **state) {
    (void)state;
    int failed = 0;
    for (int i = 0; i < SCENES * FLUIDS; i++) {
        const int kind = i / FLUIDS, fluid = i % FLUIDS;
        const found even = run(kind, fluid, 0.9, EVEN, steps[kind], 1);
        tally sum = {0};
        for (int pattern = ONE_PERCENT; pattern < RANDOM; pattern++) {
            check(kind, fluid, 0.9, pattern, 1, &even, &sum);
            check(kind, fluid, 0, pattern, 1, &even, &sum);
        }
        for (int k = 0; k < sequence_count(1); k++) {
            int pattern;
            double factor, rho;
            sequence_take(i, k, &pattern, &factor, &rho);
            check(kind, fluid, rho, pattern, factor, &even, &sum);
        }
        print_message("%-16s %-20s %5d sequences: worst gain %.1e, force %.3f, evaluations a step %.2f, %d "
                      "steps refused\n",
                      names[kind], fluids[fluid].name, sum.sequences, sum.gain, sum.force, sum.mean, sum.refused);
        failed += sum.failed;
    }
    assert_int_equal(failed, 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_energy_and_forces)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
