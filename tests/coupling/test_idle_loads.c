/* Loads that move nothing: on a held root, between the two nodes of a joint of elements, beside the modes of a modal
   beam, without a resultant on a rigid one. The norm of the motion does not see them, and columns that are averaged, as
   those of a fluid that contradicts itself are, can carry them anywhere. Members without joints; tied ones are in
   tests/stability/flows.c. */
#include "scene.h"

enum { NODES = 12, STEPS = 40 };

static const double RTOL = 5e-3;

typedef struct bar {
    spar_session *session;
    spar_member *beam;
    spar_fluid *fluid;
    double added; /* kg at each node */
    double pushed[3 * NODES], force[3 * NODES], largest;
    unsigned long long seed;
    double tip[STEPS]; /* m, across */
    int calls;
} bar;

static double draw(unsigned long long *seed) {
    *seed = *seed * 6364136223846793005ULL + 1442695040888963407ULL;
    return (double)(*seed >> 11) * 0x1p-52 - 1;
}

static void create(bar *b, int fidelity, double added, double rtol) {
    double K[36], M[36], x[3 * NODES];
    memset(b, 0, sizeof *b);
    spar_session *s = b->session = scene_session();
    b->added = added, b->seed = 5;
    scene_diagonal(K, 4e4, 4e4, 4e4, 130, 100, 150);
    scene_diagonal(M, 1, 1, 1, 0.02, 0.01, 0.01);
    b->beam = scene_beam(s, "bar", 2, 6, 4, K, M);
    OK(s, spar_member_set_root(b->beam, fidelity == SPAR_FIDELITY_RIGID ? SPAR_ROOT_FREE : SPAR_ROOT_FIXED));
    OK(s, spar_member_set_fidelity(b->beam, fidelity, fidelity == SPAR_FIDELITY_MODAL ? 4 : 0));
    OK(s, spar_member_commit(b->beam));
    OK(s, spar_member_get_reference(b->beam, x, NULL));
    OK(s, spar_fluid_create(b->beam, "water", &b->fluid));
    OK(s, spar_fluid_set_motion_nodes(b->fluid, NODES, x));
    OK(s, spar_fluid_set_force_nodes(b->fluid, NODES, x));
    OK(s, spar_fluid_map(b->fluid));
    OK(s, spar_session_set_coupling(s, SPAR_COUPLING_IQN_ILS, 1e-9, rtol, 200));
}

/* `part` of the way from what it pushed last to an added mass under a gust, and a pull along the bar, most of it at the
   root, that the bar hardly answers; `noise` of each on what is pushed. */
static void push(bar *b, double t, double part, double noise) {
    double a[3 * NODES];
    OK(b->session, spar_fluid_pull_poses(b->fluid, SPAR_NODES_MOTION, 1, NULL, NULL, NULL, NULL, a, NULL));
    for (int i = 0; i < 3 * NODES; i++) {
        double gust = i % 3 == 0 ? 0.3 * (i == 0 ? 10 : 1) : 0.1 * sin(5 * t + i);
        b->pushed[i] += part * (gust - b->added * a[i] - b->pushed[i]);
        b->force[i] = b->pushed[i] * (1 + noise * draw(&b->seed));
        b->largest = fmax(b->largest, fabs(b->force[i]));
    }
    b->calls++;
    OK(b->session, spar_fluid_push_forces(b->fluid, b->force, NULL));
}

/* How far loads in use are from those pushed: of loads on the nodes themselves, each goes to its own. */
static double used_beyond(const bar *b) {
    double load[6 * NODES], off = 0;
    OK(b->session, spar_member_get_loads(b->beam, load));
    for (int i = 0; i < 6 * NODES; i++) {
        off = fmax(off, fabs(load[i] - (i % 6 < 3 ? b->force[3 * (i / 6) + i % 6] : 0)));
    }
    return off;
}

/* Answers how far loads in use went from those pushed, at any time, over the largest ever pushed. */
static double run(int fidelity, double added, double part, double noise, double rtol, bar *ran) {
    double off = 0, x[3 * NODES];
    bar b;
    create(&b, fidelity, added, rtol);
    for (int step = 0; step < STEPS; step++) {
        int done = 0;
        OK(b.session, spar_step_begin(b.session, 0.02));
        while (!done) {
            OK(b.session, spar_step_solve(b.session));
            push(&b, 0.02 * (step + 1), part, noise);
            off = fmax(off, used_beyond(&b));
            OK(b.session, spar_step_check(b.session, &done));
        }
        OK(b.session, spar_step_accept(b.session));
        OK(b.session, spar_fluid_pull_motion(b.fluid, 1, x, NULL));
        b.tip[step] = x[3 * NODES - 2];
    }
    spar_session_destroy(&b.session);
    *ran = b;
    return off / b.largest;
}

/* Forces of 3 N at most are pushed: loads in use stay within as much of those. As columns carried them, they went 1e9 N
   off on the modal beam, and the steps of the rigid one ended by overflow. Half-way pushes are those of a fluid that
   corrects its pressure once. */
static void test_run_off(void **state) {
    static const struct {
        int fidelity;
        double added, part, noise, most; /* evaluations a step */
    } of[] = {{SPAR_FIDELITY_EXACT, 0.5, 0.5, 1e-3, 8},  {SPAR_FIDELITY_EXACT, 5, 1, 1e-3, 8},
              {SPAR_FIDELITY_LINEAR, 0.5, 0.5, 1e-3, 8}, {SPAR_FIDELITY_LINEAR, 50, 1, 1e-3, 10},
              {SPAR_FIDELITY_MODAL, 0.5, 0.5, 1e-3, 10}, {SPAR_FIDELITY_MODAL, 5, 0.5, 1e-4, 16},
              {SPAR_FIDELITY_MODAL, 5, 1, 1e-4, 6},      {SPAR_FIDELITY_RIGID, 0.5, 0.5, 1e-3, 3},
              {SPAR_FIDELITY_RIGID, 5, 0.5, 1e-4, 12}};
    (void)state;
    for (size_t i = 0; i < sizeof of / sizeof *of; i++) {
        bar b;
        double off = run(of[i].fidelity, of[i].added, of[i].part, of[i].noise, RTOL, &b);
        print_message("fidelity %d, added mass %g, pushes go %g: %.1f evaluations a step, loads %.2g off\n",
                      of[i].fidelity, of[i].added, of[i].part, b.calls / (double)STEPS, off);
        assert_true(off <= 1.1);
        assert_true(b.calls <= of[i].most * STEPS);
    }
}

/* A fluid 15 and 60 times as heavy as the beam, in its 33 free directions, whose pushes go a part of the way from the
   last one: without its memory in the columns no run but those of 0.3 gets through, with that in 15 evaluations a step.
   With it a step takes what it takes to learn the directions once, then some 6, and the tip is where the exact fluid
   leaves it: steps end within RTOL of the motion when the fluid has settled, which adds up as the root of the steps. */
static void test_heavy_half_way(void **state) {
    static const struct {
        int fidelity;
        double added, part, noise, most; /* evaluations a step */
    } of[] = {{SPAR_FIDELITY_EXACT, 5, 0.9, 0, 8},   {SPAR_FIDELITY_EXACT, 5, 0.7, 0, 8},
              {SPAR_FIDELITY_EXACT, 5, 0.5, 0, 8},   {SPAR_FIDELITY_EXACT, 5, 0.3, 0, 9},
              {SPAR_FIDELITY_LINEAR, 5, 0.7, 0, 8},  {SPAR_FIDELITY_LINEAR, 5, 0.5, 0, 8},
              {SPAR_FIDELITY_MODAL, 5, 0.5, 0, 5},   {SPAR_FIDELITY_EXACT, 20, 0.7, 0, 9},
              {SPAR_FIDELITY_EXACT, 5, 0.7, 1e-3, 8}};
    (void)state;
    for (size_t i = 0; i < sizeof of / sizeof *of; i++) {
        bar b, exact;
        (void)run(of[i].fidelity, of[i].added, 1, 0, 1e-9, &exact);
        (void)run(of[i].fidelity, of[i].added, of[i].part, of[i].noise, RTOL, &b);
        double off = 0, way = 0;
        for (int step = 0; step < STEPS; step++) {
            off = fmax(off, fabs(b.tip[step] - exact.tip[step]));
            way = fmax(way, fabs(exact.tip[step] - exact.tip[0]));
        }
        print_message("fidelity %d, added mass %g, pushes go %g: %.1f evaluations a step, tip %.1e off\n",
                      of[i].fidelity, of[i].added, of[i].part, b.calls / (double)STEPS, off / way);
        assert_true(b.calls <= of[i].most * STEPS);
        assert_true(off < RTOL * sqrt(STEPS) * way);
    }
}

/* ---- reactions ---- */

static int push_sine(spar_session *s, double t, double dt, int iteration, void *context) {
    double force[3] = {0, 0, sin(20 * (t + dt))};
    (void)iteration;
    return spar_fluid_push_forces(context, force, NULL) != SPAR_OK || s == NULL;
}

/* A force sin 20 t on what its root carries: a body, beams that are rigid or prescribed, the root of an exact beam. It
   moves nothing, so the steps end after one evaluation with predicted loads, 0.04 off. The reaction at the end of the
   step is that to the force pushed last, to rounding in the waves of the exact beam, 1e-7. A root driven at 0.5 m/s
   takes the work that the force gives, the trapezoidal sum of what was pushed. */
static void test_reaction(void **state) {
    static const int fidelity[] = {-1, SPAR_FIDELITY_RIGID, SPAR_FIDELITY_PRESCRIBED, SPAR_FIDELITY_EXACT};
    const double dt = 0.01, speed = 0.5, still[3] = {0}, way[3] = {0, 0, speed};
    (void)state;
    for (int k = 0; k < 16; k++) {
        const int kind = fidelity[k % 4], driven = k / 4 % 2, scheme = k / 8;
        double M[36], K[36], work[SPAR_WORK_COUNT], sum = 0, node[3] = {kind == SPAR_FIDELITY_EXACT ? 0 : 0.6, 0, 0};
        spar_session *s = scene_session();
        spar_member *m = NULL;
        spar_fluid *f = NULL;
        OK(s, spar_session_set_coupling(s, scheme ? SPAR_COUPLING_EXPLICIT : SPAR_COUPLING_IQN_ILS, 1e-9, 1e-6, 50));
        scene_diagonal(K, 4e7, 4e7, 4e7, 1e6, 1e6, 1e6);
        scene_mass(M, 2, still, (double[3]){0.03, 0.02, 0.01});
        if (kind < 0) {
            OK(s, spar_rigid_create(s, "m", NULL, NULL, M, &m));
        } else {
            m = scene_beam(s, "m", 1, 5, 1, K, M);
            OK(s, spar_member_set_fidelity(m, kind, 0));
        }
        OK(s, spar_member_set_root(m, driven ? SPAR_ROOT_DRIVEN : SPAR_ROOT_FIXED));
        OK(s, spar_member_set_effects(m, SPAR_EFFECT_WORK, 0));
        OK(s, spar_member_set_initial_velocity(m, still, driven ? way : still, still));
        OK(s, spar_member_commit(m));
        OK(s, spar_fluid_create(m, "air", &f));
        OK(s, spar_fluid_set_option(f, "velocity", "own"));
        OK(s, spar_fluid_set_motion_nodes(f, 1, node));
        OK(s, spar_fluid_set_force_nodes(f, 1, node));
        OK(s, spar_fluid_map(f));
        for (int i = 1; i <= 40; i++) {
            double q[7] = {0, 0, driven * speed * dt * i, 1, 0, 0, 0}, v[6] = {0, 0, speed, 0, 0, 0}, reaction[6];
            if (driven) {
                OK(s, spar_member_drive(m, q, v, NULL));
            }
            OK(s, spar_step(s, dt, push_sine, f, NULL));
            OK(s, spar_member_get_reaction(m, reaction));
            NEAR(reaction[2], -sin(20 * dt * i), 1e-7);
            NEAR(reaction[4], node[0] * sin(20 * dt * i), 1e-7);
            sum += 0.5 * (sin(20 * dt * i) + sin(20 * dt * (i - 1))) * driven * speed * dt;
        }
        OK(s, spar_member_get_work(m, SPAR_WORK_COUNT, work));
        NEAR(work[SPAR_WORK_FLUID], sum, 1e-8);
        NEAR(work[SPAR_WORK_ROOT], -sum, 1e-8);
        spar_session_destroy(&s);
    }
}

/* Loads at the clamped root of beams in 128 orientations, by two schemes, the same in every iteration. They move
   nothing but by the rounding of the map, and agree in the second iteration. */
static void test_loads_on_a_root(void **state) {
    (void)state;
    const double gravity[3] = {1, 2, -9}, eta[3] = {0, 0.5, 1}, curve[9] = {0, 0, 0, 2, 0.1, -0.1, 4, 0.4, -0.4};
    unsigned long long seed = 9;
    for (int n = 0; n < 128; n++) {
        double K[36], M[36], turn[3], q[4], x[9], f[9], v[9];
        spar_session *s = NULL;
        spar_fluid *fluid;
        OK(NULL, spar_session_create(&s));
        scene_box(K, M);
        OK(s, spar_session_set_gravity(s, gravity));
        spar_member *b = scene_beam(s, "beam", 2, 6, 4, K, M);
        OK(s, spar_beam_set_axis(b, 3, eta, curve, NULL));
        for (int k = 0; k < 3; k++) {
            turn[k] = 3 * draw(&seed);
        }
        spari_quat_exp(turn, q);
        OK(s, spar_member_set_placement(b, NULL, q));
        OK(s, spar_member_commit(b));
        OK(s, spar_fluid_create(b, "water", &fluid));
        for (int i = 0; i < 9; i++) {
            x[i] = i % 3 == 0 ? -0.5 : 0.5 * draw(&seed);
        }
        for (int i = 0; i < 9; i += 3) {
            spari_rotate(q, x + i, x + i);
        }
        OK(s, spar_fluid_set_motion_nodes(fluid, 3, x));
        OK(s, spar_fluid_set_force_nodes(fluid, 3, x));
        OK(s, spar_fluid_map(fluid));
        OK(s, spar_session_set_coupling(s, n % 2 ? SPAR_COUPLING_FIXED_POINT : SPAR_COUPLING_IQN_ILS, 1e-11, 1e-9, 20));
        for (int step = 1; step <= 10; step++) {
            int done = 0;
            OK(s, spar_step_begin(s, 0.02));
            while (!done) {
                OK(s, spar_step_solve(s));
                OK(s, spar_fluid_pull_motion(fluid, 1, x, v));
                for (int i = 0; i < 9; i++) {
                    f[i] = 5 * sin(0.08 * step + i) - 2 * v[i] - x[i];
                }
                OK(s, spar_fluid_push_forces(fluid, f, NULL));
                OK(s, spar_step_check(s, &done));
            }
            OK(s, spar_step_accept(s));
        }
        spar_session_destroy(&s);
    }
}

/* A modal beam with bending modes alone under a pull along it, which moves nothing and is another one in each push:
   once the step has ended, the reaction balances the last one, by equilibrium along the beam. By IQN-ILS and Aitken. */
static void test_reaction_beside_modes(void **state) {
    (void)state;
    for (int scheme = SPAR_COUPLING_AITKEN; scheme <= SPAR_COUPLING_IQN_ILS; scheme++) {
        bar b;
        double reaction[6], pull = 0;
        int done = 0;
        create(&b, SPAR_FIDELITY_MODAL, 0.01, 1e-6);
        OK(b.session, spar_session_set_coupling(b.session, scheme, 1e-9, 1e-6, 50));
        OK(b.session, spar_step_begin(b.session, 0.02));
        for (int i = 0; !done; i++) {
            OK(b.session, spar_step_solve(b.session));
            push(&b, 1, 1, 0);
            pull = 0;
            for (int k = 0; k < NODES; k++) {
                b.force[3 * k] = 1 + 0.1 * i;
                pull += b.force[3 * k];
            }
            OK(b.session, spar_fluid_push_forces(b.fluid, b.force, NULL));
            OK(b.session, spar_step_check(b.session, &done));
        }
        OK(b.session, spar_step_accept(b.session));
        OK(b.session, spar_member_get_reaction(b.beam, reaction));
        print_message("scheme %d: reaction %.6f for %.6f N in %d pushes\n", scheme, reaction[0], pull, b.calls);
        assert_true(b.calls > 1);
        NEAR(fabs(reaction[0]), pull, 1e-6 * pull);
        spar_session_destroy(&b.session);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_run_off), cmocka_unit_test(test_heavy_half_way),
                                       cmocka_unit_test(test_reaction), cmocka_unit_test(test_loads_on_a_root),
                                       cmocka_unit_test(test_reaction_beside_modes)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
