/* Random light structures in random fluids, beside a relaxation that learns nothing: random_coupling [scenes [seed]].
   Structures: clamped, hinged and rotating beams, chains of rigid links. Fluids: added mass normal to the section, in
   all directions, from differences of velocities, or of a channel (every section acts on all); with drag, noise, and
   loads that respond in part. Ratios of the masses 0.1 to 1000, motions 0.001 to 1 of the length, 13 to 200 steps a
   period, tolerances 1e-2 to 1e-8.
   Every step of an exact fluid that Aitken ends must end, as near to a run of Aitken with a hundredth of the tolerance
   as the tolerance says, or as that run's own distance, and all in a third of Aitken's evaluations. No step with memory
   or noise may fail that Aitken ends. The tolerance is five times the noise. The links of a chain carry most of the
   loads: only the part that inclines them moves it, and the tolerance is of this part, so its noise is as much smaller.
   Prints by class evaluations a step, and the worst of them and of the distances, with their seeds. */
#include "support/links.h"

#include <stdio.h>

enum { NODES = 6, MOST_LINKS = 6, STEPS = 15, MOST = 100 };
enum { CLAMPED, HINGED, ROTATING, CHAIN, STRUCTURES };
enum { NORMAL, ALL, RATES, CHANNEL, FLUIDS };
static const char *const structure_name[] = {"clamped", "hinged", "rotating", "chain"}, *const fluid_name[] = {
                                                                                            "normal", "all directions",
                                                                                            "rates", "channel"};

typedef struct world {
    int structure, fluid, links;
    double ratio, amplitude, steps, rtol, noise, rho, drag; /* drawn */
    double added, push, dt, rate;
    spar_session *session;
    spar_member *member[MOST_LINKS];
    spar_fluid *water[MOST_LINKS];
    double v0[MOST_LINKS][NODES][3], v[MOST_LINKS][NODES][3], last[MOST_LINKS][NODES][3];
    int pushed;
    unsigned long long random;
} world;

static double draw(unsigned long long *random, double from, double to) {
    *random = *random * 6364136223846793005ULL + 1442695040888963407ULL;
    return from + (to - from) * (double)(*random >> 11) * 0x1p-53;
}

static double draw_log(unsigned long long *random, double from, double to) {
    return exp(draw(random, log(from), log(to)));
}

static world draw_world(unsigned seed) {
    unsigned long long r = seed * 2654435761ULL + 88172645463325252ULL;
    world w = {.structure = 0};
    for (int i = 0; i < 8; i++) {
        (void)draw(&r, 0, 1);
    }
    w.structure = (int)draw(&r, 0, STRUCTURES);
    w.fluid = (int)draw(&r, 0, FLUIDS);
    w.links = w.structure == CHAIN ? 1 + (int)draw(&r, 0, MOST_LINKS) : 1;
    w.ratio = draw_log(&r, 0.1, 1000);
    w.amplitude = draw_log(&r, 1e-3, 0.5);
    w.steps = draw_log(&r, 13, 200);
    w.rtol = draw_log(&r, 1e-8, 1e-2);
    w.drag = draw(&r, 0, 1) < 0.5 ? 0 : draw(&r, 0, 2);
    double kind = draw(&r, 0, 1);
    w.noise = kind > 0.8 ? draw_log(&r, 1e-5, 1e-2) : 0;
    w.noise *= w.structure == CHAIN ? w.amplitude : 1;
    w.rho = kind > 0.6 && kind < 0.8 ? draw(&r, 0, 0.7) : 0;
    w.rtol = fmax(w.rtol, w.structure == CHAIN ? 5 * w.noise / w.amplitude : 5 * w.noise);
    w.random = r;
    return w;
}

/* ---- the fluid ---- */

/* Mass of each section on the others, [NODES][NODES]: of itself, or of a channel that is open at its end. */
static double mass_between(const world *w, int nodes, int i, int j) {
    double own = w->added / nodes;
    return w->fluid != CHANNEL ? (i == j) * own : own * 2.47 / nodes * (1 + (i < j ? nodes - 1 - j : nodes - 1 - i));
}

static int push_on(world *w, int j) {
    const int nodes = w->structure == CHAIN ? 3 : NODES;
    const double up[3] = {0, 0, 1};
    double q[NODES][4], a[NODES][3], n[NODES][3], across[NODES], f[NODES][3], size = 0;
    OK(w->session, spar_fluid_pull_poses(w->water[j], SPAR_NODES_MOTION, 1, NULL, q[0], w->v[j][0], NULL, a[0], NULL));
    for (int i = 0; i < nodes; i++) {
        for (int k = 0; k < 3 && w->fluid == RATES; k++) {
            a[i][k] = (w->v[j][i][k] - w->v0[j][i][k]) / w->dt;
        }
        spari_rotate(q[i], up, n[i]);
        across[i] = spari_dot(a[i], n[i]);
    }
    for (int i = 0; i < nodes; i++) {
        double load = 0, slip = spari_dot(w->v[j][i], n[i]);
        for (int l = 0; l < nodes; l++) {
            load -= mass_between(w, nodes, i, l) * across[l];
        }
        load -= w->drag * w->added / nodes * slip * (0.3 + fabs(slip));
        for (int k = 0; k < 3; k++) {
            f[i][k] = w->fluid == ALL ? -w->added / nodes * a[i][k] : load * n[i][k];
            f[i][k] += k == 2 ? w->push / nodes : 0;
            f[i][k] = w->pushed ? w->rho * w->last[j][i][k] + (1 - w->rho) * f[i][k] : f[i][k];
            size += f[i][k] * f[i][k] / (3 * nodes);
        }
    }
    memcpy(w->last[j], f, sizeof f);
    for (int i = 0; i < 3 * nodes; i++) {
        f[i / 3][i % 3] += w->noise * sqrt(size) * draw(&w->random, -1.7, 1.7);
    }
    return spar_fluid_push_forces(w->water[j], f[0], NULL);
}

static int solve_fluid(spar_session *s, double t, double dt, int iteration, void *context) {
    world *w = context;
    int status = SPAR_OK;
    (void)s, (void)t, (void)dt, (void)iteration;
    for (int j = 0; j < w->links && status == SPAR_OK; j++) {
        status = push_on(w, j);
    }
    w->pushed = 1;
    return status;
}

/* ---- the structure ---- */

/* 1 m, EI = 20 N m^2, in 1 kg/m of fluid; hinged: by a spring of the same stiffness. */
static void build_beam(world *w) {
    const double mu = 1 / w->ratio, still[3] = {0, 0, 0}, axes[4] = {1, 0, 0, 0};
    double K[36], M[36], x[3 * NODES] = {0}, spring[36] = {0};
    spar_session *s = w->session;
    scene_diagonal(K, 1e5, 1e4, 1e4, 20, 20, 20);
    scene_diagonal(M, mu, mu, mu, mu * 1e-3, mu * 5e-4, mu * 5e-4);
    w->member[0] = scene_beam(s, "beam", 1, 6, 1, K, M);
    static const int root[] = {SPAR_ROOT_FIXED, SPAR_ROOT_FREE, SPAR_ROOT_DRIVEN};
    OK(s, spar_member_set_root(w->member[0], root[w->structure]));
    OK(s, spar_member_commit(w->member[0]));
    if (w->structure == HINGED) {
        spar_joint *joint = NULL;
        OK(s, spar_joint_create(s, "hinge", w->member[0], 0, NULL, 0, SPAR_FREE_RY, &joint));
        OK(s, spar_joint_set_frame(joint, still, axes));
        spring[7 * 4] = 20;
        OK(s, spar_joint_set_spring(joint, spring, NULL, NULL));
    }
    for (int i = 0; i < NODES; i++) {
        x[3 * i] = (i + 0.5) / NODES;
    }
    w->added = 1;
    w->push = w->amplitude * 8 * 20;
    w->dt = 2 * 3.1416 / 3.516 * sqrt((mu + 1) / 20) / w->steps;
    w->rate = w->structure == ROTATING ? 0.02 / w->dt : 0;
    w->water[0] = links_wet(w->session, w->member[0], NODES, x);
}

/* Links of 1 m in all, inclined by the amplitude in rad, buoyant, on the ground. */
static void build_chain(world *w) {
    const double L = 1.0 / w->links;
    w->added = L;
    w->push = 10 * L;
    w->dt = 2 * 3.1416 * sqrt((1 + 1 / w->ratio) / 15) / w->steps / w->links;
    links_create(w->session, w->links, L / w->ratio, 1.5708 - w->amplitude, w->member, w->water);
}

/* ---- runs ---- */

typedef struct outcome {
    int steps;                  /* that ended */
    double evaluations, tip[3]; /* a step; path of the last node */
    char message[400];
} outcome;

static void drive(const world *w, int step) {
    if (w->rate > 0) {
        double angle = w->rate * w->dt * (step + 1), q[7] = {0, 0, 0, cos(angle / 2), 0, sin(angle / 2), 0};
        double v[6] = {0, 0, 0, 0, w->rate, 0};
        OK(w->session, spar_member_drive(w->member[0], q, v, NULL));
    }
}

static outcome run(const world *drawn, int scheme, double rtol) {
    world w = *drawn;
    outcome o = {0};
    int calls = 0, end = w.links - 1, last = 3 * (w.structure == CHAIN ? 2 : NODES - 1);
    double from[3 * NODES], to[3 * NODES], spin[3] = {0, 0, 0};
    w.session = scene_session();
    (w.structure == CHAIN ? build_chain : build_beam)(&w);
    if (w.rate > 0) {
        spin[1] = w.rate;
        OK(w.session, spar_member_set_initial_velocity(w.member[0], (double[3]){0, 0, 0}, (double[3]){0, 0, 0}, spin));
    }
    OK(w.session, spar_session_set_coupling(w.session, scheme, 1e-12, rtol, MOST));
    OK(w.session, spar_fluid_get_positions(w.water[end], SPAR_NODES_MOTION, from, NULL, NULL, NULL));
    for (int i = 0; i < STEPS; i++) {
        drive(&w, i);
        if (spar_step(w.session, w.dt, solve_fluid, &w, &calls) != SPAR_OK) {
            (void)snprintf(o.message, sizeof o.message, "%s", spar_session_message(w.session));
            break;
        }
        memcpy(w.v0, w.v, sizeof w.v);
        o.steps++;
        o.evaluations += calls;
    }
    o.evaluations /= o.steps > 0 ? o.steps : 1;
    OK(w.session, spar_fluid_get_positions(w.water[end], SPAR_NODES_MOTION, to, NULL, NULL, NULL));
    for (int k = 0; k < 3; k++) {
        o.tip[k] = to[last + k] - from[last + k];
    }
    spar_session_destroy(&w.session);
    return o;
}

/* ---- the table ---- */

typedef struct row {
    int scenes, failed, aitken_failed;
    double mean, aitken, worst, off; /* worst evaluations a step; worst distance from the oracle over the one allowed */
    unsigned seed, off_seed;
} row;

static int tell(unsigned seed, const world *w, const char *what, const outcome *o, const outcome *other) {
    print_message("seed %u: %s: %s, %s, %d links, ratio %.3g, amplitude %.2g, %.0f steps a period, rtol %.1e, noise "
                  "%.1e, memory %.2f, drag %.2f: %d steps, %.2f evaluations; Aitken %d, %.2f. %s\n",
                  seed, what, structure_name[w->structure], fluid_name[w->fluid], w->links, w->ratio, w->amplitude,
                  w->steps, w->rtol, w->noise, w->rho, w->drag, o->steps, o->evaluations, other->steps,
                  other->evaluations, o->message);
    return 1;
}

/* Distance of the tip from that of a run of Aitken with a hundredth of the tolerance, over the one allowed. -1: that
   run does not end. */
static double distance(const world *w, const outcome *o, const outcome *aitken) {
    outcome near = run(w, SPAR_COUPLING_AITKEN, fmax(1e-2 * w->rtol, 1e-10));
    double off = 0, path = 0, own = 0;
    for (int k = 0; k < 3; k++) {
        off += pow(o->tip[k] - near.tip[k], 2);
        own += pow(aitken->tip[k] - near.tip[k], 2);
        path += near.tip[k] * near.tip[k];
    }
    /* the tolerance is of the motion that all loads cause, which is 1 + ratio times the motion in a heavy fluid */
    double bound = 1e-7 + 3 * STEPS * (w->rtol * (1 + w->ratio) * fmax(sqrt(path), w->amplitude) + sqrt(own));
    return near.steps == STEPS ? sqrt(off) / bound : -1;
}

/* Returns whether the scene fails. */
static int play(unsigned seed, row *sum) {
    const world w = draw_world(seed);
    const int exact = w.noise == 0 && w.rho == 0;
    outcome o = run(&w, SPAR_COUPLING_IQN_ILS, w.rtol), aitken = run(&w, SPAR_COUPLING_AITKEN, w.rtol);
    int bad = 0;
    if (o.steps < aitken.steps) {
        bad = tell(seed, &w, "fails", &o, &aitken);
    } else if (exact && aitken.steps == STEPS) {
        double off = distance(&w, &o, &aitken);
        if (off > sum->off) {
            sum->off = off, sum->off_seed = seed;
        }
        bad = off > 1 ? tell(seed, &w, "another motion", &o, &aitken) : 0;
    }
    sum->scenes++;
    sum->failed += o.steps < STEPS;
    sum->aitken_failed += aitken.steps < STEPS;
    if (o.steps == STEPS && aitken.steps == STEPS) {
        sum->mean += o.evaluations;
        sum->aitken += aitken.evaluations;
    }
    if (o.evaluations > sum->worst) {
        sum->worst = o.evaluations, sum->seed = seed;
    }
    return bad;
}

static int scenes = 1000;

/* Scenes in which the first correction, made before anything is known of the fluid, multiplies the residual by
   hundreds: steps end only if the iteration goes on from the loads before it. */
static void test_bad_starts(void **state) {
    static const unsigned seeds[] = {8106, 11725, 12754, 18126, 24011, 24443, 27693};
    row sum = {0};
    (void)state;
    for (size_t i = 0; i < sizeof seeds / sizeof *seeds && scenes > 1; i++) {
        assert_int_equal(play(seeds[i], &sum), 0);
    }
}

static int first_seed = 1;

static void test_scenes(void **state) {
    enum { KINDS = 3 };
    static const char *const kind_name[] = {"exact", "memory", "noise"};
    row sums[STRUCTURES][KINDS] = {{{0}}};
    int bad = 0;
    (void)state;
    for (int i = 0; i < scenes; i++) {
        const unsigned seed = (unsigned)(first_seed + i);
        const world w = draw_world(seed);
        bad += play(seed, &sums[w.structure][w.noise > 0 ? 2 : w.rho > 0]);
    }
    for (int k = 0; k < STRUCTURES * KINDS; k++) {
        const row *r = &sums[k / KINDS][k % KINDS];
        const int both = r->scenes - (r->failed > r->aitken_failed ? r->failed : r->aitken_failed);
        print_message("%-9s %-7s %4d scenes: %5.2f evaluations a step, Aitken %6.2f; %d fail, Aitken %d; worst %.1f "
                      "(seed %u); off by %.2g of what is allowed (seed %u)\n",
                      structure_name[k / KINDS], kind_name[k % KINDS], r->scenes, r->mean / (both > 0 ? both : 1),
                      r->aitken / (both > 0 ? both : 1), r->failed, r->aitken_failed, r->worst, r->seed, r->off,
                      r->off_seed);
    }
    assert_int_equal(bad, 0);
    for (int k = 0; k < STRUCTURES && scenes >= 250; k++) {
        assert_true(sums[k][0].mean < sums[k][0].aitken / 3);
    }
}

int main(int argc, char **argv) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_bad_starts), cmocka_unit_test(test_scenes)};
    scenes = argc > 1 ? atoi(argv[1]) : scenes;
    first_seed = argc > 2 ? atoi(argv[2]) : first_seed;
    return cmocka_run_group_tests(tests, NULL, NULL);
}
