/* Trial runs go back to the bit, and say what theory says. */
#include "scene.h"
#include "trials.h"

#include "math/basis.h"

#include <stdio.h>

enum { NODES = 40 };

/* A cantilever in a fluid that pushes back with the velocity, and a load that comes and goes; its own state is the
   velocity at t^n, kept before each step. */
typedef struct scene {
    spar_session *s;
    spar_member *b, *body;
    spar_fluid *f, *g;
    double x[3 * NODES], v[3 * NODES], old[3 * NODES], force[3 * NODES], moment[3 * NODES];
    double load, drag, added;
    int moments, fails, solutions;
    spar_trial *other; /* beside the session's first */
} scene;

static int press(spar_session *s, double t, double dt, int iteration, void *context) {
    scene *c = context;
    (void)s, (void)iteration;
    c->solutions++;
    if (c->fails) {
        return c->fails;
    }
    int status = spar_fluid_pull_motion(c->f, 1, c->x, c->v);
    for (int i = 0; i < NODES && !status; i++) {
        for (int k = 0; k < 3; k++) {
            c->force[3 * i + k] = (k == 2 ? c->load * sin(9 * (t + dt)) : 0) - c->drag * c->v[3 * i + k] -
                                  c->added * (c->v[3 * i + k] - c->old[3 * i + k]) / dt;
            c->moment[3 * i + k] = k == 1 ? -0.1 * c->load : 0;
        }
    }
    status = status ? status : spar_fluid_push_forces(c->f, c->force, c->moments ? c->moment : NULL);
    if (!status && c->g) {
        const double up[3] = {0, 0, 2};
        status = spar_fluid_push_forces(c->g, up, NULL);
    }
    return status;
}

static int keep(spar_session *s, double t, double dt, void *context) {
    scene *c = context;
    (void)s, (void)t, (void)dt;
    return spar_fluid_pull_motion(c->f, 1, NULL, c->old);
}

static void build_of(scene *c, int with_body, int elements, int nodes, int given) {
    const double g[3] = {0, 0, -9.81}, J[3] = {1, 2, 3}, zero[3] = {0, 0, 0};
    double K[36], M[36], mass[36], x[3 * NODES];
    c->s = scene_session();
    scene_explicit(c->s);
    scene_diagonal(K, 1e6, 1e5, 1e5, 100, 120, 400);
    scene_diagonal(M, 1, 1, 1, 2e-3, 1e-3, 1e-3);
    OK(c->s, spar_session_set_gravity(c->s, g));
    c->b = scene_beam(c->s, "wing", elements, nodes, 2, K, M);
    if (given) {
        double line[3 * 64] = {0}, gll[SPARI_MAX_NODES];
        spari_gll(nodes, gll, NULL, NULL);
        for (int i = 0; i < elements * nodes; i++) {
            line[3 * i] = (2 * (i / nodes) + 1 + gll[i % nodes]) / elements;
        }
        OK(c->s, spar_beam_set_nodes(c->b, (int64_t)elements * nodes, line, NULL));
    }
    OK(c->s, spar_member_set_effects(c->b, with_body ? SPAR_EFFECT_WORK : 0, 0));
    OK(c->s, spar_member_commit(c->b));
    if (with_body) {
        scene_mass(mass, 2, zero, J);
        OK(c->s, spar_rigid_create(c->s, "body", zero, NULL, mass, &c->body));
        OK(c->s, spar_member_commit(c->body));
        OK(c->s, spar_fluid_create(c->body, "lift", &c->g));
        OK(c->s, spar_fluid_set_force_nodes(c->g, 1, zero));
        OK(c->s, spar_fluid_map(c->g));
    }
    for (int i = 0; i < NODES; i++) {
        x[3 * i] = 2 * (i + 0.5) / NODES, x[3 * i + 1] = 0.1 * sin(i), x[3 * i + 2] = 0.1 * cos(i);
    }
    OK(c->s, spar_fluid_create(c->b, "air", &c->f));
    OK(c->s, spar_fluid_set_motion_nodes(c->f, NODES, x));
    OK(c->s, spar_fluid_set_force_nodes(c->f, NODES, x));
    OK(c->s, spar_fluid_map(c->f));
}

static void build(scene *c, int with_body) {
    build_of(c, with_body, 2, 6, 0);
}

static void step(scene *c, double dt, int n) {
    for (int i = 0; i < n; i++) {
        OK(c->s, (spar_status_text(0), keep(c->s, 0, dt, c)));
        OK(c->s, spar_step(c->s, dt, press, c, NULL));
    }
}

static char *contents(const char *path, long *size) {
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    fseek(file, 0, SEEK_END);
    *size = ftell(file);
    rewind(file);
    char *bytes = malloc((size_t)*size);
    assert_int_equal(fread(bytes, 1, (size_t)*size, file), (size_t)*size);
    fclose(file);
    remove(path);
    return bytes;
}

/* Before the clock runs and in the middle of a run, with loads of every kind: after trials of all kinds, those that
   fail among them, the saved state is the same file, and the run goes on with the same bits. */
static void test_goes_back_to_the_bit(void **state) {
    (void)state;
    for (int begun = 0; begun < 2; begun++) {
        double q[2][12 * 7], report[TRY_COUNT], table[SPAR_ROW_COUNT][COLUMN_COUNT], advice[ADVICE_COUNT];
        for (int tried = 0; tried < 2; tried++) {
            scene c = {.load = 0.02, .drag = 0.01, .moments = 1};
            const double line_eta[2] = {0.2, 0.9}, line[12] = {0, 1, 0, 0, 0, 0, 0, 2, 0, 0, 0, 0},
                         follower[6] = {0, 0.1, 0, 0, 0, 0}, dead[6] = {0, 0, 0.2, 0, 0, 0};
            build(&c, 1);
            OK(c.s, spar_session_set_coupling(c.s, SPAR_COUPLING_IQN_ILS, 1e-9, 1e-6, 50));
            OK(c.s, spar_beam_set_line_load(c.b, SPAR_LOAD_FOLLOWER, 2, line_eta, line));
            OK(c.s, spar_member_set_load(c.b, 11, SPAR_LOAD_FOLLOWER, follower));
            OK(c.s, spar_member_set_load(c.b, 4, SPAR_LOAD_DEAD, dead));
            step(&c, 0.01, begun ? 5 : 0);
            if (tried) {
                long size[2];
                char *file[2];
                OK(c.s, spar_session_save(c.s, "trial_bits.spar"));
                file[0] = contents("trial_bits.spar", &size[0]);
                OK(c.s, trial_run(c.s, 0.01, 16, keep, press, &c, 0, report));
                OK(c.s, trial_report_effects(c.s, 0.01, 16, keep, press, &c, table[0]));
                OK(c.s, trial_advise(c.s, 0.05, 0.01, 16, 16 * 0.01, keep, press, &c, advice));
                c.fails = 7;
                assert_int_equal(trial_run(c.s, 0.01, 16, keep, press, &c, 0, report), SPAR_ERR_USER);
                c.fails = 0;
                OK(c.s, spar_session_save(c.s, "trial_bits.spar"));
                file[1] = contents("trial_bits.spar", &size[1]);
                assert_int_equal(size[0], size[1]);
                assert_memory_equal(file[0], file[1], (size_t)size[0]);
                free(file[0]);
                free(file[1]);
            }
            step(&c, 0.01, 5);
            OK(c.s, spar_member_get_motion(c.b, q[tried], NULL, NULL));
            spar_session_destroy(&c.s);
        }
        assert_memory_equal(q[0], q[1], sizeof q[0]);
    }
}

/* A run against itself has no error; the error of dt falls with its square. */
static void test_errors_of_dt(void **state) {
    (void)state;
    const double none[3] = {0, 0, 0}; /* weight that comes on at once would ring in all modes */
    scene c = {.load = 0.02, .drag = 0.01};
    double report[TRY_COUNT], error[2];
    build(&c, 0);
    OK(c.s, spar_session_set_gravity(c.s, none));
    OK(c.s, spar_session_set_coupling(c.s, SPAR_COUPLING_IQN_ILS, 1e-12, 1e-9, 50));
    OK(c.s, trial_run(c.s, 0.32 / 4096, 4096, keep, press, &c, 0, report));
    assert_true(report[TRY_MOTION] == 0);
    assert_true(report[TRY_EVALUATIONS] >= 4096);
    OK(c.s, trial_run(c.s, 0.32 / 4096, 4096, keep, press, &c, 1, report));
    assert_true(report[TRY_MOTION] == 0 && report[TRY_REACTION] == 0 && report[TRY_LOAD] == 0);
    for (int k = 0; k < 2; k++) {
        OK(c.s, trial_run(c.s, 0.32 / (128 << k), 128 << k, keep, press, &c, 1, report));
        error[k] = report[TRY_MOTION];
    }
    NEAR(log2(error[0] / error[1]), 2, 0.3);
    spar_session_destroy(&c.s);
}

/* Under a load at rest the sizes are ratios of known forces, and what is left out is missing from the support: weight
   of a beam of m g L = 19.62 N against a load at its tip. */
static void test_gravity_row(void **state) {
    (void)state;
    scene c = {.load = 0};
    double table[SPAR_ROW_COUNT][COLUMN_COUNT];
    const double dead[6] = {0, 0, -19.62, 0, 0, 0};
    build(&c, 0);
    OK(c.s, spar_member_set_load(c.b, 11, SPAR_LOAD_DEAD, dead));
    OK(c.s, spar_member_solve_static(c.b, 4));
    OK(c.s, trial_report_effects(c.s, 1e-3, 8, keep, press, &c, table[0]));
    const double *gravity = table[SPAR_ROW_GRAVITY];
    assert_true(gravity[COLUMN_IN_FORCE] == 1);
    assert_true(gravity[COLUMN_SIZE] > 0.1 && gravity[COLUMN_SIZE] <= 1);
    assert_true(gravity[COLUMN_REACTION] > 0.01);
    for (int r = 0; r < SPAR_ROW_COUNT; r++) {
        int there = r == SPAR_ROW_INERTIA || r == SPAR_ROW_GYROSCOPIC || r == SPAR_ROW_GRAVITY ||
                    r == SPAR_ROW_FLUID_VELOCITY || r == SPAR_ROW_PREDICTOR;
        assert_int_equal(table[r][COLUMN_IN_FORCE], there);
        for (int k = 0; k < COLUMN_COUNT && !there; k++) {
            assert_true(table[r][k] == 0);
        }
        assert_true(spar_effect_name(r)[0] != '\0');
    }
    NEAR(table[SPAR_ROW_INERTIA][COLUMN_SIZE], 0, 1e-9); /* at rest */
    assert_string_equal(spar_effect_name(-1), "");
    assert_string_equal(spar_effect_name(SPAR_ROW_COUNT), "");
    spar_session_destroy(&c.s);
}

/* At rest nothing flows and damping has no size yet; it is the trial that shows one. A beam that a load at its tip
   begins to move: the size is more than a hundredth of the leading forces, and what it does to the motion as well. */
static void test_sizes_at_rest(void **state) {
    (void)state;
    const double dead[6] = {0, 0, -20, 0, 0, 0}, mu[6] = {0.02, 0.02, 0.02, 0.02, 0.02, 0.02};
    double table[SPAR_ROW_COUNT][COLUMN_COUNT], K[36], M[36];
    spar_session *s = scene_session();
    scene_diagonal(K, 1e6, 1e6, 1e6, 1e3, 1e3, 1e3);
    scene_diagonal(M, 1, 1, 1, 2e-3, 1e-3, 1e-3);
    spar_member *b = scene_beam(s, "beam", 1, 6, 2, K, M);
    OK(s, spar_beam_set_damping(b, mu));
    OK(s, spar_member_commit(b));
    OK(s, spar_member_set_load(b, 5, SPAR_LOAD_DEAD, dead));
    OK(s, trial_report_effects(s, 0.02, 16, NULL, NULL, NULL, table[0]));
    assert_true(table[SPAR_ROW_DAMPING][COLUMN_MOTION] > 0.01);
    assert_true(table[SPAR_ROW_DAMPING][COLUMN_SIZE] > 0.01);
    assert_true(table[SPAR_ROW_INERTIA][COLUMN_SIZE] > 0.01);
    spar_session_destroy(&s);
}

/* A body that spins about its node, its centre of mass beside it, pulled by twice m w^2 c towards the node: gyroscopic
   terms are half of the leading one, and so is inertia once the trial has begun, in eight states of nine, so short that
   nothing turns; and the next report says the same, for nothing is left changed. */
static void test_gyroscopic_row(void **state) {
    (void)state;
    const double zero[3] = {0}, J[3] = {1, 2, 3}, c[3] = {0.1, 0, 0}, w[3] = {0, 0, 3}, dead[6] = {-3.6, 0, 0, 0, 0, 0};
    double mass[36], table[2][SPAR_ROW_COUNT][COLUMN_COUNT];
    spar_member *b;
    spar_session *s = scene_session();
    scene_mass(mass, 2, c, J);
    OK(s, spar_rigid_create(s, "top", zero, NULL, mass, &b));
    OK(s, spar_member_set_initial_velocity(b, zero, zero, w));
    OK(s, spar_member_commit(b));
    OK(s, spar_member_set_load(b, 0, SPAR_LOAD_DEAD, dead));
    for (int k = 0; k < 2; k++) {
        OK(s, trial_report_effects(s, 1e-8, 8, NULL, NULL, NULL, table[k][0]));
        NEAR(table[k][SPAR_ROW_GYROSCOPIC][COLUMN_SIZE], 0.5, 1e-6);
        NEAR(table[k][SPAR_ROW_INERTIA][COLUMN_SIZE], 0.5 * sqrt(8.0 / 9), 1e-6);
    }
    assert_true(table[0][SPAR_ROW_GYROSCOPIC][COLUMN_MOTION] == table[1][SPAR_ROW_GYROSCOPIC][COLUMN_MOTION]);
    spar_session_destroy(&s);
}

/* Without inertia the load of the fluid works as in equilibrium: a static scene has the same reactions, gravity left
   out takes m g L off the support exactly. */
static void test_left_out_of_statics(void **state) {
    (void)state;
    scene c = {.load = 0};
    double table[SPAR_ROW_COUNT][COLUMN_COUNT], K[36], M[36];
    const double g[3] = {0, 0, -9.81}, dead[6] = {0, 0, -10, 0, 0, 0};
    c.s = scene_session();
    scene_diagonal(K, 1e9, 1e9, 1e9, 1e9, 1e9, 1e9); /* stiff: moments by the reference's arms */
    scene_diagonal(M, 1, 1, 1, 2e-3, 1e-3, 1e-3);
    OK(c.s, spar_session_set_gravity(c.s, g));
    c.b = scene_beam(c.s, "wing", 1, 6, 2, K, M);
    OK(c.s, spar_member_set_effects(c.b, EFFECTS_ONLY(SPAR_EFFECT_GRAVITY)));
    OK(c.s, spar_member_commit(c.b));
    OK(c.s, spar_member_set_load(c.b, 5, SPAR_LOAD_DEAD, dead));
    OK(c.s, trial_report_effects(c.s, 0.1, 8, NULL, NULL, NULL, table[0]));
    /* reaction: force 10 + 2 g, moment over length 10 + g; without weight 10, 10 */
    double weight = hypot(2 * 9.81, 9.81), all = hypot(10 + 2 * 9.81, 10 + 9.81);
    NEAR(table[SPAR_ROW_GRAVITY][COLUMN_REACTION], weight / all, 1e-6);
    spar_session_destroy(&c.s);
}

/* Fluid parts: a fluid that only sees velocities is not there without them; moments change the first loads by what
   they are. */
static void test_fluid_rows(void **state) {
    (void)state;
    scene c = {.load = 0.5, .drag = 0, .moments = 1};
    double table[SPAR_ROW_COUNT][COLUMN_COUNT];
    build(&c, 0);
    OK(c.s, trial_report_effects(c.s, 0.01, 16, keep, press, &c, table[0]));
    assert_true(table[SPAR_ROW_FLUID_MOMENT][COLUMN_IN_FORCE] == 1);
    assert_true(table[SPAR_ROW_FLUID_MOMENT][COLUMN_SIZE] > 0.05);
    assert_true(table[SPAR_ROW_FLUID_MOMENT][COLUMN_MOTION] > 0.01);
    assert_true(table[SPAR_ROW_FLUID_VELOCITY][COLUMN_IN_FORCE] == 1); /* pulled, though of no use at drag 0 */
    assert_true(table[SPAR_ROW_FLUID_VELOCITY][COLUMN_MOTION] == 0);
    spar_session_destroy(&c.s);
    c = (scene){.load = 0.5, .drag = 0.05};
    build(&c, 0);
    OK(c.s, trial_report_effects(c.s, 0.01, 16, keep, press, &c, table[0]));
    assert_true(table[SPAR_ROW_FLUID_MOMENT][COLUMN_IN_FORCE] == 0);
    assert_true(table[SPAR_ROW_FLUID_VELOCITY][COLUMN_MOTION] > 0.01);
    spar_session_destroy(&c.s);
}

/* From rest velocities come with time, beside a load that is there from the first step on (that of the body): what they
   are worth is of the run, and steps a tenth as long say the same of it. */
static void test_fluid_size_from_rest(void **state) {
    (void)state;
    double size[2];
    for (int fine = 0; fine < 2; fine++) {
        scene c = {.load = 0.5, .drag = 0.05};
        double table[SPAR_ROW_COUNT][COLUMN_COUNT];
        build(&c, 1);
        OK(c.s, trial_report_effects(c.s, fine ? 1e-3 : 1e-2, fine ? 160 : 16, keep, press, &c, table[0]));
        size[fine] = table[SPAR_ROW_FLUID_VELOCITY][COLUMN_SIZE];
        spar_session_destroy(&c.s);
    }
    assert_true(size[0] > 0.01);
    NEAR(size[1] / size[0], 1, 0.2);
}

/* What is advised keeps the tolerance when it is run by itself against a finer run, and is not dearer than what there
   was. The session built to the advice is another one, as a host would build it. */
static void advised(double tolerance, double added) {
    enum { STEPS = 32 };
    const double T = 0.32;
    double advice[ADVICE_COUNT], tip[2][7];
    int nodes = 0, fidelity = 0, points = 0;
    int64_t modes = 0;
    scene c = {.load = 0.05, .drag = 0.01, .added = added};
    build(&c, 0);
    if (added > 0) {
        OK(c.s, spar_session_set_coupling(c.s, SPAR_COUPLING_IQN_ILS, 1e-9, 1e-6, 50));
    }
    OK(c.s, trial_advise(c.s, tolerance, T / STEPS, STEPS, STEPS * T / STEPS, keep, press, &c, advice));
    OK(c.s, trial_get_beam(c.b, &fidelity, &modes, &nodes, &points));
    assert_true(advice[ADVICE_ERROR] <= tolerance);
    assert_true(advice[ADVICE_RUNS] >= 3 && advice[ADVICE_RUNS] <= 15);
    spar_session_destroy(&c.s);
    for (int fine = 0; fine < 2; fine++) {
        scene r = {.load = 0.05, .drag = 0.01, .added = added};
        double K[36], M[36], x[3 * NODES];
        const double g[3] = {0, 0, -9.81};
        r.s = scene_session();
        scene_diagonal(K, 1e6, 1e5, 1e5, 100, 120, 400);
        scene_diagonal(M, 1, 1, 1, 2e-3, 1e-3, 1e-3);
        OK(r.s, spar_session_set_gravity(r.s, g));
        r.b = scene_beam(r.s, "wing", 2, fine ? 9 : nodes, 2, K, M);
        if (!fine) {
            OK(r.s, spar_member_set_fidelity(r.b, fidelity, modes));
        }
        OK(r.s, spar_member_commit(r.b));
        for (int i = 0; i < NODES; i++) {
            x[3 * i] = 2 * (i + 0.5) / NODES, x[3 * i + 1] = 0.1 * sin(i), x[3 * i + 2] = 0.1 * cos(i);
        }
        OK(r.s, spar_fluid_create(r.b, "air", &r.f));
        OK(r.s, spar_fluid_set_motion_nodes(r.f, NODES, x));
        OK(r.s, spar_fluid_set_force_nodes(r.f, NODES, x));
        OK(r.s, spar_fluid_map(r.f));
        int n = fine ? 4096 : (int)lround(T / advice[ADVICE_DT]);
        OK(r.s, spar_session_set_coupling(r.s, fine ? SPAR_COUPLING_IQN_ILS : (int)advice[ADVICE_SCHEME], 1e-9,
                                          fine ? 1e-8 : advice[ADVICE_COUPLING_RTOL], 50));
        if (!fine) {
            OK(r.s, spar_session_set_integrator(r.s, 0.9, (int)advice[ADVICE_SUBSTEPS]));
            OK(r.s, spar_session_set_predictor(r.s, (int)advice[ADVICE_PREDICTOR]));
            OK(r.s, spar_session_set_newton(r.s, 1e-15, advice[ADVICE_NEWTON_RTOL], 50));
        }
        step(&r, T / n, n);
        scene_tip(r.b, tip[fine]);
        spar_session_destroy(&r.s);
    }
    double off = 0, size = 0;
    for (int k = 0; k < 3; k++) {
        off = hypot(off, tip[0][k] - tip[1][k]);
        size = hypot(size, tip[1][k]);
    }
    if (getenv("SPAR_SHOW")) {
        printf("tolerance %g added %g: estimate %g, real %g at the end, cost %.3g, present error %g, %g trials; dt %g, "
               "scheme %g %g, predictor %g, newton %g, %d nodes, fidelity %d, %d modes\n",
               tolerance, added, advice[ADVICE_ERROR], off / size, advice[ADVICE_COST], advice[ADVICE_PRESENT_ERROR],
               advice[ADVICE_RUNS], advice[ADVICE_DT], advice[ADVICE_SCHEME], advice[ADVICE_COUPLING_RTOL],
               advice[ADVICE_PREDICTOR], advice[ADVICE_NEWTON_RTOL], nodes, fidelity, (int)modes);
    }
    assert_true(off <= 1.5 * tolerance * size); /* the tolerance is of the mean over the run, this is its end */
}

static void test_advice_is_kept(void **state) {
    (void)state;
    advised(1e-2, 0);
    advised(2e-2, 0.02);
}

/* A body on a spring in a fluid that is nearly as heavy as explicit coupling can bear: m a + ma a + c v + k x = F sin.
   The explicit limit of order 1 is ma/m = 1/3, but for dt that the spring feels it is passed slowly: what is advised
   has to stay by the steady answer for sixteen times the trials. */
typedef struct heave {
    spar_fluid *f;
    double m, added, k, c, F, rate, rest, x[3], v[3], old[3];
} heave;

static int float_on(spar_session *s, double t, double dt, int iteration, void *context) {
    heave *h = context;
    (void)s, (void)iteration;
    int status = spar_fluid_pull_motion(h->f, 1, h->x, h->v);
    double force[3] = {
        0, 0, h->F * sin(h->rate * (t + dt)) - h->k * h->x[2] - h->c * h->v[2] - h->added * (h->v[2] - h->old[2]) / dt};
    return status ? status : spar_fluid_push_forces(h->f, force, NULL);
}

static int keep_heave(spar_session *s, double t, double dt, void *context) {
    heave *h = context;
    (void)s, (void)t, (void)dt;
    return spar_fluid_pull_motion(h->f, 1, NULL, h->old);
}

static spar_session *heave_session(heave *h) {
    const double zero[3] = {0, 0, 0}, J[3] = {1, 1, 1};
    double mass[36];
    spar_member *b;
    spar_session *s = scene_session();
    scene_mass(mass, h->m, zero, J);
    OK(s, spar_rigid_create(s, "body", zero, NULL, mass, &b));
    OK(s, spar_member_commit(b));
    OK(s, spar_fluid_create(b, "water", &h->f));
    OK(s, spar_fluid_set_motion_nodes(h->f, 1, zero));
    OK(s, spar_fluid_set_force_nodes(h->f, 1, zero));
    OK(s, spar_fluid_map(h->f));
    return s;
}

static void test_advice_stays_stable(void **state) {
    (void)state;
    const double ratio[] = {0.3, 0.36, 0.45, 0.5, 0.55, 0.6, 3};
    for (size_t i = 0; i < sizeof ratio / sizeof *ratio; i++) {
        heave h = {.m = 1, .added = ratio[i], .k = 40, .c = 0.5, .F = 1, .rate = 3};
        double advice[ADVICE_COUNT], largest = 0, t = 0, dt;
        spar_session *s = heave_session(&h);
        OK(s, spar_session_set_coupling(s, SPAR_COUPLING_IQN_ILS, 1e-12, 1e-6, 50));
        /* the last one is near resonance: what its first-order fluid leaves grows for as long as trials look */
        double length = ratio[i] < 1 ? 160 : 512 * 0.02;
        OK(s, trial_advise(s, 1e-2, 0.02, 512, length, keep_heave, float_on, &h, advice));
        OK(s, spar_session_set_integrator(s, 0.9, (int)advice[ADVICE_SUBSTEPS]));
        OK(s, spar_session_set_predictor(s, (int)advice[ADVICE_PREDICTOR]));
        OK(s, spar_session_set_newton(s, 1e-15, advice[ADVICE_NEWTON_RTOL], 50));
        OK(s, spar_session_set_coupling(s, (int)advice[ADVICE_SCHEME], 1e-12, advice[ADVICE_COUPLING_RTOL], 50));
        for (dt = advice[ADVICE_DT]; t < 160; t += dt) {
            OK(s, keep_heave(s, t, dt, &h));
            OK(s, spar_step(s, dt, float_on, &h, NULL));
            largest = t > 120 ? fmax(largest, fabs(h.x[2])) : largest;
        }
        double stiff = h.k - (h.m + h.added) * h.rate * h.rate;
        NEAR(largest, h.F / hypot(stiff, h.c * h.rate), 0.05 * largest);
        spar_session_destroy(&s);
    }
}

/* ---- advice put in force ---- */

/* The saved session is still this one. */
static void same_file(spar_session *s, const char *before, long size) {
    long now;
    OK(s, spar_session_save(s, "trial_apply.spar"));
    char *after = contents("trial_apply.spar", &now);
    assert_int_equal(now, size);
    assert_memory_equal(before, after, (size_t)size);
    free(after);
}

static void ask_advice(scene *c, double advice[ADVICE_COUNT]) {
    OK(c->s, trial_advise(c->s, 0.05, 0.01, 16, 16 * 0.01, keep, press, c, advice));
}

/* Refused, and the session as it was to the bit: without advice, in a step, with other members than were advised on,
   with nodes that wait for their map, and where the second of two members cannot be made anew after the first has been.
 */
static void test_apply_refuses(void **state) {
    (void)state;
    scene c = {.load = 0.05, .drag = 0.01};
    const double x[3] = {1, 0, 0};
    double advice[ADVICE_COUNT], dt = 7;
    int nodes;
    long size;
    build(&c, 1);
    assert_int_equal(spar_trial_apply(NULL, &dt), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_trial_apply(trial_of(c.s), &dt), SPAR_ERR_STATE);
    assert_non_null(strstr(spar_session_message(c.s), "no advice yet"));
    step(&c, 0.01, 3);
    ask_advice(&c, advice);
    OK(c.s, trial_get_beam(c.b, NULL, NULL, &nodes, NULL));
    spari_rebuild *advised_of = trial_of(c.s)->advised.beam; /* wing, body */
    assert_true(nodes * advised_of[0].elements != 12);       /* else nothing would be made anew */
    OK(c.s, spar_session_save(c.s, "trial_apply.spar"));
    char *before = contents("trial_apply.spar", &size);
    spari_rebuild right = advised_of[1];
    advised_of[1].fidelity = SPAR_FIDELITY_MODAL; /* there is no modal body */
    assert_int_equal(spar_trial_apply(trial_of(c.s), &dt), SPAR_ERR_STATE);
    assert_non_null(strstr(spar_session_message(c.s), "spar_trial_apply"));
    advised_of[1] = right;
    same_file(c.s, before, size);
    assert_true(c.s->coupling.predictor == 1 && c.s->coupling.scheme == SPAR_COUPLING_EXPLICIT &&
                c.s->newton.rtol == 1e-12);
    OK(c.s, spar_fluid_set_force_nodes(c.g, 1, x));
    assert_int_equal(spar_trial_apply(trial_of(c.s), &dt), SPAR_ERR_STATE);
    assert_non_null(strstr(spar_session_message(c.s), "not mapped"));
    OK(c.s, spar_fluid_map(c.g));
    OK(c.s, spar_step_begin(c.s, 0.01));
    assert_int_equal(spar_trial_apply(trial_of(c.s), &dt), SPAR_ERR_STATE);
    OK(c.s, spar_step_reject(c.s));
    trial_of(c.s)->advised.of ^= 1; /* as if other members had been advised on */
    assert_int_equal(spar_trial_apply(trial_of(c.s), &dt), SPAR_ERR_STATE);
    assert_non_null(strstr(spar_session_message(c.s), "request the advice again"));
    assert_true(dt == 7);
    step(&c, 0.01, 2);
    free(before);
    spar_session_destroy(&c.s);
}

/* What is to outlive it: sums of the loads' forces, the tip, the work done, the fluid's nodes, the body's motion. */
typedef struct outlook {
    double sum[3], tip[7], work[SPAR_WORK_COUNT], x[3 * NODES], body[7];
    int64_t nodes;
} outlook;

static void look_at(scene *c, outlook *o) {
    double load[6 * 48];
    *o = (outlook){.nodes = 0};
    OK(c->s, spar_member_get_count(c->b, &o->nodes));
    OK(c->s, spar_member_get_loads(c->b, load));
    for (int64_t i = 0; i < o->nodes; i++) {
        for (int k = 0; k < 3; k++) {
            o->sum[k] += load[6 * i + k];
        }
    }
    scene_tip(c->b, o->tip);
    OK(c->s, spar_member_get_work(c->b, SPAR_WORK_COUNT, o->work));
    OK(c->s, spar_fluid_pull_motion(c->f, 1, o->x, NULL));
    OK(c->s, spar_member_get_motion(c->body, o->body, NULL, NULL));
}

/* In the middle of a run, with loads of every kind: the tip stays where it is, places along the beam to what its nodes
   can show, sums of loads and the work account go on, a body for which nothing is advised keeps its motion to the bit;
   called again, nothing changes to the bit; and the run goes on. */
static void test_apply_in_a_run(void **state) {
    (void)state;
    scene c = {.load = 0.05, .drag = 0.01, .moments = 1};
    const double follower[6] = {0, 0.1, 0, 0, 0, 0}, dead[6] = {0, 0, 0.2, 0, 0, 0};
    double advice[ADVICE_COUNT], dt;
    outlook before, after;
    int64_t modes;
    int nodes, fidelity;
    long size;
    build(&c, 1);
    OK(c.s, spar_member_set_load(c.b, 11, SPAR_LOAD_FOLLOWER, follower));
    OK(c.s, spar_member_set_load(c.b, 4, SPAR_LOAD_DEAD, dead));
    step(&c, 0.01, 8);
    ask_advice(&c, advice);
    OK(c.s, trial_get_beam(c.b, &fidelity, &modes, &nodes, NULL));
    look_at(&c, &before);
    OK(c.s, spar_trial_apply(trial_of(c.s), &dt));
    look_at(&c, &after);
    assert_true(dt == advice[ADVICE_DT]);
    assert_true(after.nodes == 2 * nodes && after.nodes != before.nodes);
    assert_true(c.b->fidelity == fidelity && c.b->modes == modes);
    assert_true(c.s->coupling.scheme == (int)advice[ADVICE_SCHEME] &&
                c.s->coupling.predictor == (int)advice[ADVICE_PREDICTOR]);
    assert_true(c.s->integrator.substeps == (int)advice[ADVICE_SUBSTEPS]);
    assert_true(c.s->newton.rtol == advice[ADVICE_NEWTON_RTOL]);
    for (int i = 0; i < 3; i++) {
        NEAR(after.sum[i], before.sum[i], 1e-11);
        NEAR(after.tip[i], before.tip[i], 1e-13);
    }
    assert_memory_equal(after.work, before.work, sizeof after.work);
    assert_memory_equal(after.body, before.body, sizeof after.body);
    double off = 0;
    for (int i = 0; i < 3 * NODES; i++) {
        off = fmax(off, fabs(after.x[i] - before.x[i]));
    }
    print_message("%d nodes an element in place of 6: %.2g m off, the tip is %.3g m down\n", nodes, off, before.tip[2]);
    NEAR(off, 0, 1e-2 * fabs(before.tip[2])); /* the tolerance that the advice is for is 5 % */
    OK(c.s, spar_session_save(c.s, "trial_apply.spar"));
    char *saved = contents("trial_apply.spar", &size);
    OK(c.s, spar_trial_apply(trial_of(c.s), NULL));
    same_file(c.s, saved, size);
    free(saved);
    step(&c, dt, 8);
    look_at(&c, &before);
    assert_true(before.work[SPAR_WORK_FLUID] != after.work[SPAR_WORK_FLUID]);
    spar_session_destroy(&c.s);
}

/* Likewise with other elements, as if that had been advised: 2 of 6 nodes become halves, thirds and one. */
static void test_apply_elements(void **state) {
    (void)state;
    const int divided[][2] = {{4, 5}, {3, 6}, {1, 11}};
    const double follower[6] = {0, 0.1, 0, 0, 0, 0}, dead[6] = {0, 0, 0.2, 0, 0, 0};
    for (int k = 0; k < 3; k++) {
        scene c = {.load = 0.05, .drag = 0.01, .moments = 1};
        double advice[ADVICE_COUNT], off = 0;
        outlook before, after;
        long size;
        int elements, nodes;
        build(&c, 1);
        OK(c.s, spar_member_set_load(c.b, 11, SPAR_LOAD_FOLLOWER, follower));
        OK(c.s, spar_member_set_load(c.b, 4, SPAR_LOAD_DEAD, dead));
        step(&c, 0.01, 8);
        ask_advice(&c, advice);
        spari_rebuild *to = trial_of(c.s)->advised.beam;
        to->elements = divided[k][0], to->per_element = divided[k][1];
        to->fidelity = SPAR_FIDELITY_EXACT, to->modes = 0;
        look_at(&c, &before);
        OK(c.s, spar_trial_apply(trial_of(c.s), NULL));
        look_at(&c, &after);
        OK(c.s, spar_beam_get_elements(c.b, &elements, &nodes));
        assert_true(elements == divided[k][0] && nodes == divided[k][1] && after.nodes == (int64_t)elements * nodes);
        for (int i = 0; i < 3; i++) {
            NEAR(after.sum[i], before.sum[i], 1e-11);
            NEAR(after.tip[i], before.tip[i], 1e-13);
            NEAR(after.body[i], before.body[i], 0);
        }
        assert_memory_equal(after.work, before.work, sizeof after.work);
        for (int i = 0; i < 3 * NODES; i++) {
            off = fmax(off, fabs(after.x[i] - before.x[i]));
        }
        print_message("%d of %d in place of 2 of 6: %.2g m off, the tip is %.3g m down\n", elements, nodes, off,
                      before.tip[2]);
        NEAR(off, 0, 1e-3 * fabs(before.tip[2]));
        OK(c.s, spar_session_save(c.s, "trial_apply.spar"));
        char *saved = contents("trial_apply.spar", &size);
        OK(c.s, spar_trial_apply(trial_of(c.s), NULL));
        same_file(c.s, saved, size);
        free(saved);
        step(&c, 0.01, 8);
        look_at(&c, &before);
        assert_true(before.work[SPAR_WORK_FLUID] != after.work[SPAR_WORK_FLUID]);
        spar_session_destroy(&c.s);
    }
}

/* What is set is read, and what is read can be set; getters of results are refused before there are any. */
static void test_settings_of_a_trial(void **state) {
    (void)state;
    static const char *const option[][3] = {
        {"dt", "vary", "keep"}, {"nodes", "vary", "keep"}, {"coupling", "vary", "keep"}, {"limit", "15", "12"}};
    scene c = {.load = 0.02};
    spar_trial *t = NULL;
    spar_session *of = NULL;
    double dt = 7, amplitude = 7;
    int64_t steps = 7, modes = 7, memory = 7;
    int goals = 0;
    char word[32];
    build(&c, 0);
    REFUSED(c.s, SPAR_ERR_ARGUMENT, "NULL", spar_trial_create(c.s, NULL));
    assert_int_equal(spar_trial_create(NULL, &t), SPAR_ERR_ARGUMENT);
    OK(c.s, spar_trial_create(c.s, &t));
    OK(c.s, spar_trial_get_session(t, &of));
    assert_ptr_equal(of, c.s);
    OK(c.s, spar_trial_get_steps(t, &dt, &steps));
    OK(c.s, spar_trial_get_motion(t, &modes, &amplitude, &memory));
    OK(c.s, spar_trial_get_goals(t, &goals));
    assert_true(dt == 0 && steps == 0 && modes == 0 && amplitude == 0 && memory == 0 && goals == SPAR_GOAL_MOTION);
    REFUSED(c.s, SPAR_ERR_STATE, "no steps", spar_trial_run(t, 0));
    REFUSED(c.s, SPAR_ERR_ARGUMENT, "0 steps", spar_trial_set_steps(t, 0.01, 0));
    REFUSED(c.s, SPAR_ERR_ARGUMENT, "dt", spar_trial_set_steps(t, 0, 8));
    REFUSED(c.s, SPAR_ERR_ARGUMENT, "-1 modes", spar_trial_set_motion(t, -1, 0, 0));
    OK(c.s, spar_trial_set_steps(t, dt, steps)); /* what is read can be written back */
    OK(c.s, spar_trial_set_motion(t, modes, amplitude, memory));
    REFUSED(c.s, SPAR_ERR_STATE, "no steps", spar_trial_run(t, 0));
    REFUSED(c.s, SPAR_ERR_ARGUMENT, "201 modes", spar_trial_set_motion(t, 201, 0, 0));
    REFUSED(c.s, SPAR_ERR_ARGUMENT, "amplitude", spar_trial_set_motion(t, 1, 0.2, 0));
    REFUSED(c.s, SPAR_ERR_ARGUMENT, "amplitude", spar_trial_set_motion(t, 1, NAN, 0));
    REFUSED(c.s, SPAR_ERR_ARGUMENT, "memory", spar_trial_set_motion(t, 1, 0, -1));
    REFUSED(c.s, SPAR_ERR_ARGUMENT, "goals", spar_trial_set_goals(t, 0));
    REFUSED(c.s, SPAR_ERR_ARGUMENT, "goals", spar_trial_set_goals(t, 32));
    REFUSED(c.s, SPAR_ERR_ARGUMENT, "no option", spar_trial_set_option(t, "advise.dt", "keep"));
    REFUSED(c.s, SPAR_ERR_ARGUMENT, "does not accept", spar_trial_set_option(t, "limit", "-1"));
    OK(c.s, spar_trial_set_steps(t, 0.02, 24));
    OK(c.s, spar_trial_set_motion(t, 3, 1e-3, 40));
    OK(c.s, spar_trial_set_goals(t, SPAR_GOAL_LOAD | SPAR_GOAL_SECTION));
    OK(c.s, spar_trial_get_steps(t, &dt, &steps));
    OK(c.s, spar_trial_get_motion(t, &modes, &amplitude, &memory));
    OK(c.s, spar_trial_get_goals(t, &goals));
    assert_true(dt == 0.02 && steps == 24 && modes == 3 && amplitude == 1e-3 && memory == 40);
    assert_int_equal(goals, SPAR_GOAL_LOAD | SPAR_GOAL_SECTION);
    for (size_t i = 0; i < sizeof option / sizeof *option; i++) {
        OK(c.s, spar_trial_get_option(t, option[i][0], sizeof word, word));
        assert_string_equal(word, option[i][1]);
        OK(c.s, spar_trial_set_option(t, option[i][0], option[i][2]));
        OK(c.s, spar_trial_get_option(t, option[i][0], (int64_t)strlen(option[i][2]) + 1, word));
        assert_string_equal(word, option[i][2]);
    }
    REFUSED(c.s, SPAR_ERR_STATE, "no run", spar_trial_get_errors(t, NULL, NULL, NULL));
    REFUSED(c.s, SPAR_ERR_STATE, "no run", spar_trial_get_cost(t, NULL, NULL));
    REFUSED(c.s, SPAR_ERR_STATE, "no report", spar_trial_get_effect(t, 0, NULL, NULL, NULL, NULL, NULL, NULL));
    REFUSED(c.s, SPAR_ERR_ARGUMENT, "no row", spar_trial_get_effect(t, -1, NULL, NULL, NULL, NULL, NULL, NULL));
    REFUSED(c.s, SPAR_ERR_STATE, "no advice", spar_trial_get_settings(t, NULL, NULL, NULL, NULL, NULL, NULL));
    REFUSED(c.s, SPAR_ERR_STATE, "no advice", spar_trial_get_outcome(t, NULL, NULL, NULL, NULL));
    REFUSED(c.s, SPAR_ERR_STATE, "no advice", spar_trial_get_search(t, NULL, NULL));
    REFUSED(c.s, SPAR_ERR_STATE, "no advice", spar_trial_get_beam(t, c.b, NULL, NULL, NULL, NULL, NULL));
    spar_trial_destroy(&t);
    assert_null(t);
    spar_trial_destroy(&t);
    spar_trial_destroy(NULL);
    spar_session_destroy(&c.s);
}

/* Each trial is compared with its own run, and each callback has its own context. */
static int count_before(spar_session *s, double t, double dt, void *context) {
    (void)s, (void)t, (void)dt;
    ++*(int *)context;
    return 0;
}

static void test_two_trials(void **state) {
    (void)state;
    scene c = {.load = 0.02};
    spar_trial *t[2] = {NULL, NULL};
    double motion = 7;
    int counted = 0;
    build(&c, 0);
    for (int k = 0; k < 2; k++) {
        OK(c.s, spar_trial_create(c.s, &t[k]));
        OK(c.s, spar_trial_set_callbacks(t[k], count_before, &counted, press, &c));
        OK(c.s, spar_trial_set_steps(t[k], k ? 0.005 : 0.01, k ? 16 : 8));
        OK(c.s, spar_trial_run(t[k], 0));
    }
    assert_int_equal(counted, 24);
    for (int k = 0; k < 2; k++) {
        OK(c.s, spar_trial_run(t[k], 1));
        OK(c.s, spar_trial_get_errors(t[k], &motion, NULL, NULL));
        assert_true(motion == 0);
    }
    OK(c.s, spar_trial_set_steps(t[1], 0.01, 8));
    OK(c.s, spar_trial_run(t[1], 1));
    OK(c.s, spar_trial_get_errors(t[1], &motion, NULL, NULL));
    assert_true(motion > 0);
    c.fails = 7; /* what has been found stays */
    assert_int_equal(spar_trial_run(t[1], 1), SPAR_ERR_USER);
    c.fails = 0;
    double again = 7;
    OK(c.s, spar_trial_get_errors(t[1], &again, NULL, NULL));
    assert_true(again == motion);
    spar_trial_destroy(&t[0]);
    spar_session_destroy(&c.s);
}

/* A trial that is destroyed in its own run ends it; the session goes on. */
static int destroy_own(spar_session *s, double t, double dt, void *context) {
    (void)s, (void)t, (void)dt;
    spar_trial_destroy(context);
    return 0;
}

static void test_destroyed_while_it_runs(void **state) {
    (void)state;
    scene c = {.load = 0.02};
    spar_trial *t = NULL, *next = NULL;
    build(&c, 0);
    OK(c.s, spar_trial_create(c.s, &t));
    OK(c.s, spar_trial_create(c.s, &next));
    spar_trial *same = t;
    OK(c.s, spar_trial_set_steps(t, 0.01, 8));
    OK(c.s, spar_trial_set_callbacks(t, destroy_own, &t, press, &c));
    OK(c.s, spar_trial_run(same, 0));
    assert_null(t);
    REFUSED(c.s, SPAR_ERR_STATE, "destroyed the trial", spar_trial_run(same, 0)); /* a library may have its handle */
    REFUSED(c.s, SPAR_ERR_STATE, "destroyed the trial", spar_trial_set_steps(same, 0.01, 8));
    step(&c, 0.01, 2);
    spar_session_destroy(&c.s);
}

static void test_bad_input(void **state) {
    (void)state;
    scene c = {.load = 0.02};
    double report[TRY_COUNT], table[SPAR_ROW_COUNT][COLUMN_COUNT], advice[ADVICE_COUNT];
    build(&c, 0);
    assert_int_equal(trial_run(NULL, 0.01, 8, NULL, NULL, NULL, 0, report), SPAR_ERR_ARGUMENT);
    assert_int_equal(trial_run(c.s, NAN, 8, NULL, NULL, NULL, 0, report), SPAR_ERR_ARGUMENT);
    assert_int_equal(trial_run(c.s, 0.01, 12, NULL, NULL, NULL, 0, report), SPAR_ERR_ARGUMENT);
    assert_non_null(strstr(spar_session_message(c.s), "multiple of 8"));
    assert_int_equal(trial_run(c.s, 0.01, 0, NULL, NULL, NULL, 0, report), SPAR_ERR_ARGUMENT);
    assert_int_equal(trial_run(c.s, 0.01, 8, NULL, NULL, NULL, 1, report), SPAR_ERR_STATE);
    assert_int_equal(trial_advise(c.s, 0, 0.01, 8, 8 * 0.01, NULL, press, &c, advice), SPAR_ERR_ARGUMENT);
    assert_int_equal(trial_advise(c.s, NAN, 0.01, 8, 8 * 0.01, NULL, press, &c, advice), SPAR_ERR_ARGUMENT);
    assert_int_equal(trial_advise(c.s, 1e-2, 0.01, 8, 8 * 0.01, NULL, NULL, NULL, advice), SPAR_ERR_UNSUPPORTED);
    assert_int_equal(trial_get_beam(c.b, NULL, NULL, NULL, NULL), SPAR_ERR_STATE);
    OK(c.s, spar_step_begin(c.s, 0.01));
    assert_int_equal(trial_run(c.s, 0.01, 8, NULL, NULL, NULL, 0, report), SPAR_ERR_STATE);
    assert_int_equal(trial_report_effects(c.s, 0.01, 8, NULL, NULL, NULL, table[0]), SPAR_ERR_STATE);
    spar_session_destroy(&c.s);
}

/* The settings of a trial that runs are fixed. */
static void refuses_settings(spar_trial *t) {
    spar_session *s = t->session;
    REFUSED(s, SPAR_ERR_STATE, "the trial is running", spar_trial_set_steps(t, 0.01, 8));
    REFUSED(s, SPAR_ERR_STATE, "the trial is running", spar_trial_set_callbacks(t, NULL, NULL, NULL, NULL));
    REFUSED(s, SPAR_ERR_STATE, "the trial is running", spar_trial_set_progress(t, NULL, NULL));
    REFUSED(s, SPAR_ERR_STATE, "the trial is running", spar_trial_set_goals(t, SPAR_GOAL_LOAD));
    REFUSED(s, SPAR_ERR_STATE, "the trial is running", spar_trial_set_option(t, "dt", "keep"));
    REFUSED(s, SPAR_ERR_STATE, "the trial is running", spar_trial_set_motion(t, 1, 0, 0));
}

/* Within a trial nothing may be made or saved, and its settings are fixed; the trial goes on. */
static int meddle(spar_session *s, double t, double dt, void *context) {
    scene *c = context;
    spar_fluid *f = NULL;
    spar_member *m = NULL;
    REFUSED(s, SPAR_ERR_STATE, "trial run is in progress", spar_trial_run(c->other, 0));
    REFUSED(s, SPAR_ERR_STATE, "trial run is in progress", spar_trial_run(trial_of(s), 0));
    refuses_settings(trial_of(s));
    assert_int_equal(spar_fluid_create(c->b, "late", &f), SPAR_ERR_STATE);
    assert_int_equal(spar_point_create(s, "late", NULL, NULL, &m), SPAR_ERR_STATE);
    assert_int_equal(spar_fluid_set_motion_nodes(c->f, 0, NULL), SPAR_ERR_STATE);
    assert_int_equal(spar_fluid_map(c->f), SPAR_ERR_STATE);
    assert_int_equal(spar_session_save(s, "trial_never.spar"), SPAR_ERR_STATE);
    REFUSED(s, SPAR_ERR_STATE, "spar_trial_run is in progress", spar_session_set_reproducible(s, 1));
    REFUSED(s, SPAR_ERR_STATE, "spar_trial_run is in progress", spar_session_set_threads(s, 2));
    REFUSED(s, SPAR_ERR_STATE, "spar_trial_run is in progress", spar_session_set_predictor(s, 1));
    REFUSED(s, SPAR_ERR_STATE, "spar_trial_run is in progress", spar_session_set_option(s, "newton.jacobian", "x"));
    REFUSED(s, SPAR_ERR_STATE, "spar_trial_run is in progress", spar_step(s, dt, NULL, NULL, NULL));
    return keep(s, t, dt, context);
}

static void test_meddling(void **state) {
    (void)state;
    scene c = {.load = 0.02};
    double report[TRY_COUNT];
    build(&c, 0);
    (void)trial_of(c.s);
    OK(c.s, spar_trial_create(c.s, &c.other));
    OK(c.s, spar_trial_set_steps(c.other, 0.01, 8));
    OK(c.s, trial_run(c.s, 0.01, 8, meddle, press, &c, 0, report));
    step(&c, 0.01, 2);
    spar_session_destroy(&c.s);
}

static int no_fluid(spar_session *s, double t, double dt, int iteration, void *context) {
    (void)s, (void)t, (void)dt, (void)iteration, (void)context;
    return 0;
}

/* A fluid that has faded its motion and never got motion nodes, in trials of a beam with other nodes. */
static void test_fade_without_nodes(void **state) {
    (void)state;
    double K[36], M[36];
    spar_session *s = scene_session();
    spar_fluid *f = NULL;
    spar_trial *t = NULL;
    scene_diagonal(K, 9e4, 9e4, 9e4, 1500, 1500, 1500);
    scene_diagonal(M, 0.7, 0.7, 0.7, 0.1, 0.05, 0.05);
    spar_member *b = scene_beam(s, "b", 1, 2, 1, K, M);
    OK(s, spar_member_commit(b));
    OK(s, spar_fluid_create(b, "f", &f));
    OK(s, spar_fluid_map(f));
    OK(s, spar_fluid_fade_motion(f, 0.2, 0.43, 0, NULL, NULL));
    OK(s, spar_trial_create(s, &t));
    OK(s, spar_trial_set_steps(t, 1e-3, 8));
    OK(s, spar_trial_set_callbacks(t, NULL, NULL, no_fluid, NULL));
    OK(s, spar_trial_advise(t, 0.2, 0.0078));
    OK(s, spar_trial_run(t, 0));
    spar_session_destroy(&s);
}

/* A fluid that is destroyed within a trial: the trial takes as many solutions as one without it, and afterwards the run
 * is that of a session where it was destroyed between steps. */
static int leave(spar_session *s, double t, double dt, void *context) {
    scene *c = context;
    spar_fluid_destroy(&c->g);
    assert_null(c->g);
    return keep(s, t, dt, context);
}

static void test_destroyed_within(void **state) {
    (void)state;
    double q[2][12 * 7], body[2][7], report[2][TRY_COUNT];
    for (int within = 0; within < 2; within++) {
        scene c = {.load = 0.02};
        build(&c, 1);
        step(&c, 0.01, 3);
        if (!within) {
            spar_fluid_destroy(&c.g);
        }
        OK(c.s, trial_run(c.s, 0.01, 8, within ? leave : keep, press, &c, 0, report[within]));
        assert_null(c.g);
        step(&c, 0.01, 3);
        OK(c.s, spar_member_get_motion(c.b, q[within], NULL, NULL));
        OK(c.s, spar_member_get_motion(c.body, body[within], NULL, NULL));
        spar_session_destroy(&c.s);
    }
    assert_memory_equal(q[0], q[1], sizeof q[0]);
    assert_memory_equal(body[0], body[1], sizeof body[0]);
    assert_true(report[0][TRY_EVALUATIONS] == report[1][TRY_EVALUATIONS]);
}

/* What a callback asks and gives within trials: the residuals have the room that the host says, whatever scheme is
   tried; a first follower finds room for its reaction. */
static int ask(spar_session *s, double t, double dt, int iteration, void *context) {
    scene *c = context;
    double residual[3] = {0, 7, 7}, size[3] = {0, 7, 7}, load[6] = {0, 0, 0.01, 0, 0, 0};
    int iterations;
    OK(s, spar_session_get_iterations(s, &iterations, 1, residual, size));
    assert_true(iterations >= 0 && residual[1] == 7 && size[1] == 7);
    OK(s, spar_member_set_load(c->b, 0, SPAR_LOAD_FOLLOWER, load));
    return press(s, t, dt, iteration, context);
}

/* A host made with a header that knows fewer entries, or more: what there is room for comes, the first ones first, and
   the rest of the room is 0. */
static void test_capacities(void **state) {
    (void)state;
    scene c = {.load = 0.02};
    build(&c, 0);
    step(&c, 0.01, 3);
    double energy[SPAR_ENERGY_COUNT + 1], first[2] = {7, 7}, audit[SPAR_AUDIT_COUNT + 1], count[7];
    OK(c.s, spar_member_get_energy(c.b, SPAR_ENERGY_COUNT + 1, energy));
    OK(c.s, spar_member_get_energy(c.b, 1, first));
    assert_true(energy[SPAR_ENERGY_COUNT] == 0 && energy[SPAR_ENERGY_KINETIC] > 0);
    assert_true(first[0] == energy[0] && first[1] == 7);
    OK(c.s, spar_fluid_get_audit(c.f, SPAR_AUDIT_COUNT + 1, audit));
    OK(c.s, spar_fluid_get_audit(c.f, 7, count));
    assert_true(audit[SPAR_AUDIT_COUNT] == 0 && audit[SPAR_AUDIT_NODES] > 0 && audit[SPAR_AUDIT_FORCE] == count[0]);
    spar_session_destroy(&c.s);
}

static void test_asking(void **state) {
    (void)state;
    scene c = {.load = 0.02};
    double advice[ADVICE_COUNT], report[TRY_COUNT];
    build(&c, 0);
    OK(c.s, spar_session_set_coupling(c.s, SPAR_COUPLING_EXPLICIT, 1e-9, 1e-6, 30));
    OK(c.s, trial_advise(c.s, 0.1, 0.01, 8, 8 * 0.01, keep, ask, &c, advice));
    OK(c.s, trial_run(c.s, 0.01, 8, keep, ask, &c, 0, report));
    spar_session_destroy(&c.s);
}

/* No members, or members that nothing is to be found of: a point, an external beam. */
static void test_nothing_to_try(void **state) {
    (void)state;
    double report[TRY_COUNT], table[SPAR_ROW_COUNT][COLUMN_COUNT];
    spar_session *s = scene_session();
    OK(s, trial_run(s, 0.01, 8, NULL, NULL, NULL, 0, report));
    spar_member *p;
    OK(s, spar_point_create(s, "p", NULL, NULL, &p));
    OK(s, spar_member_commit(p));
    OK(s, trial_report_effects(s, 0.01, 8, NULL, NULL, NULL, table[0]));
    OK(s, trial_run(s, 0.01, 8, NULL, NULL, NULL, 0, report));
    OK(s, trial_run(s, 0.01, 8, NULL, NULL, NULL, 1, report));
    assert_true(report[TRY_MOTION] == 0);
    spar_session_destroy(&s);
}

static int idle(spar_session *s, double t, double dt, int iteration, void *context) {
    (void)s, (void)t, (void)dt, (void)iteration, (void)context;
    return 0;
}

/* Loads that the host cannot give, whatever status it names, end a trial before it begins: that status, or that there
   is no reference run. "A peer failed" is one of them, also where there is no other rank. */
static void test_loads_that_are_not_there(void **state) {
    (void)state;
    for (int why = SPAR_ERR_ARGUMENT; why <= SPAR_ERR_LIMIT; why++) {
        double K[36], M[36], advice[ADVICE_COUNT], report[TRY_COUNT];
        spar_fluid *f = NULL;
        spar_session *s = scene_session();
        scene_diagonal(K, 100, 100, 100, 100, 100, 100);
        scene_diagonal(M, 1, 1, 1, 1, 1, 1);
        spar_member *beam = scene_beam(s, "beam", 1, 4, 1, K, M);
        OK(s, spar_member_commit(beam));
        OK(s, spar_fluid_create(beam, "air", &f));
        OK(s, spar_fluid_fail(f, why, "the solver has stopped"));
        assert_int_equal(trial_run(s, 0.01, 8, NULL, idle, NULL, 0, report), why);
        int status = trial_advise(s, 0.1, 0.01, 8, 8 * 0.01, NULL, idle, NULL, advice);
        assert_true(status == why || status == SPAR_ERR_NUMERIC);
        spar_session_destroy(&s);
    }
}

/* Another load in each step, whatever the motion. */
static int whim(spar_session *s, double t, double dt, int iteration, void *context) {
    static int steps = 0;
    (void)s, (void)t, (void)dt;
    steps += iteration == 0;
    const double force[3] = {0, 0, sin(7.0 * steps * steps)};
    return spar_fluid_push_forces(context, force, NULL);
}

/* A fluid that does not repeat has no reference. The message gives the reference's error and what it would have to be
   below: a part of the tolerance, so that the first is above the second and the second below the tolerance. */
static void test_fluid_that_does_not_repeat(void **state) {
    (void)state;
    double K[36], M[36], advice[ADVICE_COUNT], error, limit, tolerance = 0.03;
    const double tip[3] = {1, 0, 0};
    spar_fluid *f = NULL;
    spar_session *s = scene_session();
    scene_diagonal(K, 100, 100, 100, 100, 100, 100);
    scene_diagonal(M, 1, 1, 1, 1, 1, 1);
    spar_member *beam = scene_beam(s, "beam", 1, 4, 1, K, M);
    OK(s, spar_member_commit(beam));
    OK(s, spar_fluid_create(beam, "air", &f));
    OK(s, spar_fluid_set_force_nodes(f, 1, tip));
    OK(s, spar_fluid_map(f));
    assert_int_equal(trial_advise(s, tolerance, 0.01, 8, 8 * 0.01, NULL, whim, f, advice), SPAR_ERR_NUMERIC);
    const char *says = strstr(spar_session_message(s), "the error of the reference is about ");
    assert_non_null(says);
    assert_int_equal(sscanf(says, "the error of the reference is about %lf, but must be below %lf", &error, &limit), 2);
    assert_true(error > limit && limit < tolerance && limit > 0.1 * tolerance);
    spar_session_destroy(&s);
}

/* What a progress call hears. */
typedef struct hearing {
    scene *c;
    int calls, stop;             /* answers 5 in this call, from 1; 0: in none */
    int first;                   /* solutions of the fluid before the first */
    double done, expected, most; /* of the last call; the most that was expected */
} hearing;

static int hear(spar_session *s, double done, double expected, void *context) {
    hearing *h = context;
    assert_ptr_equal(s, h->c->s);
    h->first = h->calls == 0 ? h->c->solutions : h->first;
    assert_true(h->calls == 0 ? done == 0 && expected > 0 : done >= h->done);
    assert_true(isfinite(expected) && expected >= done);
    h->done = done, h->expected = expected, h->most = fmax(h->most, expected);
    return ++h->calls == h->stop ? 5 : 0;
}

static int ask_for(scene *c, int table, double *answer) {
    return table ? trial_report_effects(c->s, 0.01, 8, keep, press, c, answer)
                 : trial_advise(c->s, 0.05, 0.01, 16, 16 * 0.01, keep, press, c, answer);
}

/* Advice calls once ahead of each trial, with the number of trials so far: 0 at first, before the fluid is solved. The
   option limit is what is expected at most, and the advice is the same without the callback. Effects: one
   run with all and six for each row in force, as which that many are expected in the end. Unset, nothing is called. */
static void test_progress(void **state) {
    (void)state;
    scene c = {.load = 0.02, .drag = 0.01, .moments = 1};
    hearing h = {.c = &c};
    double advice[ADVICE_COUNT], quiet[ADVICE_COUNT], table[SPAR_ROW_COUNT][COLUMN_COUNT];
    build(&c, 0);
    assert_int_equal(spar_trial_set_progress(trial_of(NULL), hear, &h), SPAR_ERR_ARGUMENT);
    step(&c, 0.01, 3);
    OK(c.s, ask_for(&c, 0, quiet));
    c.solutions = 0;
    OK(c.s, spar_trial_set_progress(trial_of(c.s), hear, &h));
    OK(c.s, ask_for(&c, 0, advice));
    assert_memory_equal(advice, quiet, sizeof quiet);
    assert_true(h.first == 0 && c.solutions > 0);
    assert_true(h.calls == (int)advice[ADVICE_RUNS]);
    assert_true(h.done == advice[ADVICE_RUNS] - 1 && h.most == 15);
    h = (hearing){.c = &c};
    OK(c.s, ask_for(&c, 1, table[0]));
    int rows = 0;
    for (int r = 0; r < SPAR_ROW_COUNT; r++) {
        rows += table[r][COLUMN_IN_FORCE] > 0;
    }
    assert_true(rows > 3);
    assert_int_equal(h.calls, 1 + 6 * rows);
    assert_true(h.done == 6 * rows && h.expected == 1 + 6 * rows);
    OK(c.s, spar_trial_set_progress(trial_of(c.s), NULL, &h));
    h.calls = 0;
    OK(c.s, ask_for(&c, 1, table[0]));
    assert_int_equal(h.calls, 0);
    spar_session_destroy(&c.s);
}

/* Stopped at each call that there is: SPAR_ERR_USER, the message says who has, the saved session is the same file,
   nothing comes out; then it is asked again to the end, and the run goes on. */
static void test_stopped_at_each_call(void **state) {
    (void)state;
    for (int table = 0; table < 2; table++) {
        scene c = {.load = 0.02, .drag = 0.01};
        hearing h = {.c = &c};
        double answer[SPAR_ROW_COUNT * COLUMN_COUNT];
        long size;
        build(&c, 0);
        step(&c, 0.01, 2);
        OK(c.s, spar_trial_set_progress(trial_of(c.s), hear, &h));
        OK(c.s, ask_for(&c, table, answer));
        int calls = h.calls;
        assert_true(calls >= 3);
        OK(c.s, spar_session_save(c.s, "trial_apply.spar"));
        char *file = contents("trial_apply.spar", &size);
        for (int stop = 1; stop <= calls; stop++) {
            h = (hearing){.c = &c, .stop = stop};
            answer[0] = 77;
            REFUSED(c.s, SPAR_ERR_USER,
                    table ? "spar_trial_report_effects: cancelled by the progress callback (5)"
                          : "spar_trial_advise: cancelled by the progress callback (5)",
                    ask_for(&c, table, answer));
            assert_int_equal(h.calls, stop);
            assert_true(answer[0] == 77);
            same_file(c.s, file, size);
        }
        h = (hearing){.c = &c};
        OK(c.s, ask_for(&c, table, answer));
        assert_int_equal(h.calls, calls);
        step(&c, 0.01, 2);
        free(file);
        spar_session_destroy(&c.s);
    }
}

/* From within: the session can be read; what tries or saves is refused, and so are settings of the trial. */
static int meddle_between(spar_session *s, double done, double expected, void *context) {
    hearing *h = context;
    double t = -1;
    (void)done, (void)expected;
    OK(s, spar_session_get_time(s, &t, NULL, NULL));
    NEAR(t, 0.02, 1e-12);
    REFUSED(s, SPAR_ERR_STATE, "trial run is in progress", spar_trial_run(h->c->other, 0));
    assert_int_equal(spar_session_save(s, "trial_apply.spar"), SPAR_ERR_STATE);
    refuses_settings(trial_of(s));
    h->calls++;
    return 0;
}

static void test_progress_meddles(void **state) {
    (void)state;
    scene c = {.load = 0.02, .drag = 0.01};
    hearing h = {.c = &c};
    double advice[ADVICE_COUNT];
    build(&c, 0);
    step(&c, 0.01, 2);
    OK(c.s, spar_trial_set_progress(trial_of(c.s), meddle_between, &h));
    OK(c.s, spar_trial_create(c.s, &c.other));
    OK(c.s, spar_trial_set_steps(c.other, 0.01, 8));
    OK(c.s, ask_for(&c, 0, advice));
    assert_int_equal(h.calls, (int)advice[ADVICE_RUNS]);
    spar_session_destroy(&c.s);
}

static spar_member *light_beam(spar_session *s, int fidelity, int effects, int root) {
    double K[36], M[36];
    scene_box(K, M);
    spar_member *b = scene_beam(s, "beam", 2, 4, 10, K, M);
    OK(s, spar_member_set_fidelity(b, fidelity, 4));
    OK(s, spar_member_set_effects(b, EFFECTS_ONLY(effects)));
    OK(s, spar_member_set_root(b, root));
    OK(s, spar_member_commit(b));
    return b;
}

static int press_tip(spar_session *s, double t, double dt, int iteration, void *context) {
    const double f[3] = {0, 0, 0.5};
    (void)s, (void)t, (void)dt, (void)iteration;
    return spar_fluid_push_forces(context, f, NULL);
}

/* Members without inertia: advice tries rigid and modal ones, and a report leaves inertia out. */
static void test_trials_without_inertia(void **state) {
    (void)state;
    const int effects[] = {0, SPAR_EFFECT_INERTIA, SPAR_EFFECT_GRAVITY};
    for (int k = 0; k < 3; k++) {
        double advice[ADVICE_COUNT], table[SPAR_ROW_COUNT][COLUMN_COUNT];
        const double tip[3] = {10, 0, 0}, g[3] = {0, 0, -1};
        spar_session *s = scene_session();
        spar_fluid *f = NULL;
        OK(s, spar_session_set_gravity(s, g));
        spar_member *b = light_beam(s, k == 0 ? SPAR_FIDELITY_EXACT : SPAR_FIDELITY_RIGID, effects[k], SPAR_ROOT_FIXED);
        OK(s, spar_fluid_create(b, "tip", &f));
        OK(s, spar_fluid_set_force_nodes(f, 1, tip));
        OK(s, spar_fluid_map(f));
        OK(s, trial_report_effects(s, 0.01, 8, NULL, press_tip, f, table[0]));
        if (k == 0) {
            OK(s, trial_advise(s, 0.1, 0.01, 8, 8 * 0.01, NULL, press_tip, f, advice));
        }
        spar_session_destroy(&s);
    }
}

/* A run kept for comparison is refused once the session has other members. */
static void test_comparison_of_other_members(void **state) {
    (void)state;
    double report[TRY_COUNT];
    spar_session *s = scene_session();
    scene_body(s, "one", (double[3]){0}, 2, (double[]){1, 1, 1});
    OK(s, trial_run(s, 0.1, 8, NULL, NULL, NULL, 0, report));
    scene_body(s, "two", (double[3]){0}, 2, (double[]){1, 1, 1});
    assert_int_equal(trial_run(s, 0.1, 8, NULL, NULL, NULL, 1, report), SPAR_ERR_STATE);
    OK(s, trial_run(s, 0.1, 8, NULL, NULL, NULL, 0, report));
    OK(s, trial_run(s, 0.1, 8, NULL, NULL, NULL, 1, report));
    spar_session_destroy(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_goes_back_to_the_bit),
        cmocka_unit_test(test_errors_of_dt),
        cmocka_unit_test(test_gravity_row),
        cmocka_unit_test(test_sizes_at_rest),
        cmocka_unit_test(test_gyroscopic_row),
        cmocka_unit_test(test_left_out_of_statics),
        cmocka_unit_test(test_fluid_rows),
        cmocka_unit_test(test_fluid_size_from_rest),
        cmocka_unit_test(test_advice_is_kept),
        cmocka_unit_test(test_advice_stays_stable),
        cmocka_unit_test(test_apply_refuses),
        cmocka_unit_test(test_apply_in_a_run),
        cmocka_unit_test(test_apply_elements),
        cmocka_unit_test(test_settings_of_a_trial),
        cmocka_unit_test(test_two_trials),
        cmocka_unit_test(test_destroyed_while_it_runs),
        cmocka_unit_test(test_bad_input),
        cmocka_unit_test(test_meddling),
        cmocka_unit_test(test_fade_without_nodes),
        cmocka_unit_test(test_asking),
        cmocka_unit_test(test_destroyed_within),
        cmocka_unit_test(test_capacities),
        cmocka_unit_test(test_nothing_to_try),
        cmocka_unit_test(test_loads_that_are_not_there),
        cmocka_unit_test(test_fluid_that_does_not_repeat),
        cmocka_unit_test(test_progress),
        cmocka_unit_test(test_stopped_at_each_call),
        cmocka_unit_test(test_progress_meddles),
        cmocka_unit_test(test_trials_without_inertia),
        cmocka_unit_test(test_comparison_of_other_members),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
