/* The defaults of the coupling in random scenes (random_scenes.h): members and mechanisms in an exact fluid of added
   mass and drag, 0.01 to 100 times as heavy, whose loads on the nodes are -m_a a - c v. Each scene is run with the
   defaults, with the strictest tolerances of Newton and of the coupling, and with these in half the steps (the last two
   differ by the scheme's own error). Three things hold:
   - Energy of structure and fluid, less the work of the loads as summed here, rises with the defaults by no more than
     with the strictest tolerances and a tenth of the scheme's error.
   - The tip differs by a tenth of the scheme's error, or ten times the tolerance of the coupling of its way.
   - The defaults refuse no step that the strictest tolerances take.
   A scene of which the library tells that its elements lock is played, and nothing is asserted of it.

   random_couplings [seed, default 1 [scenes, default 24]]: the long form is 1000.
   random_couplings seed 0 runs one scene, by the seed that the table names. */
#include "random_scenes.h"

enum { MOST_STEPS = 200 };

static const double part = 0.1, floor_of = 1e-9, rtol = 1e-6;
static uint64_t seed = 1;
static int scenes = 24;

/* ---- the fluid ---- */

/* One fluid for each part, with a node at each of its nodes (a rod's: at its end, where its node is). */
typedef struct sea {
    motion_world w;
    spar_fluid *fluid[SCENE_PARTS];
    double added, drag; /* of each node, kg, N s/m */
    double energy;      /* of the fluid at the last evaluation */
    int64_t calls;
} sea;

static int answer(spar_session *s, double t, double dt, int iteration, void *context) {
    sea *o = context;
    double x[3 * SCENE_NODES], v[3 * SCENE_NODES], a[3 * SCENE_NODES], force[3 * SCENE_NODES];
    (void)t, (void)dt, (void)iteration;
    o->energy = 0, o->calls++;
    for (int i = 0; i < o->w.c->parts; i++) {
        const int64_t n = o->w.n[i];
        OK(s, spar_fluid_pull_poses(o->fluid[i], SPAR_NODES_MOTION, 1, x, NULL, v, NULL, a, NULL));
        for (int64_t k = 0; k < 3 * n; k++) {
            force[k] = -o->added * a[k] - o->drag * v[k];
            o->energy += 0.5 * o->added * v[k] * v[k];
        }
        OK(s, spar_fluid_push_forces(o->fluid[i], force, NULL));
    }
    return 0;
}

static void immerse(sea *o, double ratio, double drag) {
    const motion_scene *c = o->w.c;
    for (int i = 0; i < c->parts; i++) {
        double x[3 * SCENE_NODES];
        OK(o->w.s, spar_member_get_reference(o->w.m[i], x, NULL));
        OK(o->w.s, spar_fluid_create(o->w.m[i], "sea", &o->fluid[i]));
        OK(o->w.s, spar_fluid_set_motion_nodes(o->fluid[i], o->w.n[i], x));
        OK(o->w.s, spar_fluid_set_force_nodes(o->fluid[i], o->w.n[i], x));
        OK(o->w.s, spar_fluid_map(o->fluid[i]));
        o->added = ratio * c->mass * c->length / (double)o->w.n[i];
    }
    o->drag = drag * o->added / c->period;
    o->w.solver = answer, o->w.context = o;
}

/* ---- one scene ---- */

typedef struct outcome {
    int status, steps, locks;
    int64_t calls;
    double gain, scale, largest, balance[MOST_STEPS], tip[3 * MOST_STEPS];
    char message[160];
} outcome;

static void run(const motion_scene *c, double ratio, double drag, int strictest, int halves, outcome *r) {
    static sea o;
    double size;
    o = (sea){.w = scene_build(c, strictest)};
    *r = (outcome){.status = o.w.status};
    if (r->status == SPAR_OK) {
        immerse(&o, ratio, drag);
        if (strictest) {
            OK(o.w.s, spar_session_set_coupling(o.w.s, SPAR_COUPLING_IQN_ILS, 0, 1e-9, 200));
        }
        r->status = spar_session_solve_initial(o.w.s, c->dt / halves, answer, &o, NULL);
    }
    const double first = scene_energy(&o.w, &size) + o.energy;
    sequence_seed = c->seed;
    for (int k = 0; k < c->steps && r->status == SPAR_OK; k++) {
        const double dt = sequence_step(c->pattern, k, c->dt, c->factor) / halves;
        for (int i = 0; i < halves && r->status == SPAR_OK; i++) {
            r->status = scene_step(&o.w, dt);
        }
        if (r->status == SPAR_OK) {
            r->balance[k] = scene_energy(&o.w, &size) + o.energy - first - o.w.work;
            r->gain = fmax(r->gain, r->balance[k]);
            r->scale = fmax(r->scale, size + o.energy);
            memcpy(r->tip + 3 * k, o.w.tip, 3 * sizeof *r->tip);
            r->largest = fmax(r->largest, sqrt(spari_dot(o.w.tip, o.w.tip)));
            r->steps++;
        }
    }
    r->calls = o.calls;
    r->locks = scene_is_told_to_lock(&o.w);
    snprintf(r->message, sizeof r->message, "%.150s", spar_session_message(o.w.s));
    spar_session_destroy(&o.w.s);
}

static double apart(const outcome *a, const outcome *b, int tip) {
    double most = 0;
    for (int k = 0; k < a->steps && k < b->steps; k++) {
        double square = 0;
        for (int i = 0; i < (tip ? 3 : 1); i++) {
            const double d = tip ? a->tip[3 * k + i] - b->tip[3 * k + i] : a->balance[k] - b->balance[k];
            square += d * d;
        }
        most = fmax(most, square);
    }
    return sqrt(most);
}

/* Slender to 1e8, moved by what a step resolves; steps of one length mostly. */
static motion_scene draw(uint64_t at, double *ratio, double *drag) {
    static const int structures[] = {CLAMPED, CLAMPED, PINNED, HINGED, WELDED, BALL, CHAIN};
    scene_seed_by(at);
    const int structure = structures[scene_whole(0, 6)], loading = scene_whole(0, LOADINGS - 1),
              uneven = scene_whole(0, 3) == 0;
    const double heavy = scene_decades(-2, 2), viscous = scene_whole(0, 1) ? scene_decades(-2, 1) : 0;
    motion_scene c = scene_draw(at, structure, loading, uneven);
    c.slenderness = pow(c.slenderness, 2.0 / 3), c.strip = fmin(c.strip, c.slenderness / 20);
    c.elements = c.nodes > 8 ? 1 : c.elements, c.nodes = 4 + c.nodes % 5;
    c.modes = (c.structure == PINNED ? 3 : 0) + scene_whole(1, 3);
    c.steps = MOST_STEPS;
    *ratio = heavy, *drag = viscous;
    return c;
}

static int check(uint64_t at, int k, double *worst) {
    static outcome usual, strict, half;
    double ratio, drag;
    const motion_scene c = draw(at, &ratio, &drag);
    run(&c, ratio, drag, 0, 1, &usual), run(&c, ratio, drag, 1, 1, &strict), run(&c, ratio, drag, 1, 2, &half);
    int failed = 0;
    if (usual.status != SPAR_OK || strict.status != SPAR_OK || half.status != SPAR_OK) {
        print_message("%3d: refused: defaults in step %d: %s; strictest in step %d: %s\n", k, usual.steps,
                      usual.message, strict.steps, strict.message);
        print_message("    added mass %.3g, drag %.3g\n", ratio, drag);
        scene_print(&c);
        failed = usual.status != SPAR_OK && !usual.locks;
    } else {
        const double scale = fmax(strict.scale, DBL_MIN), size = fmax(strict.largest, DBL_MIN),
                     error = 4.0 / 3 * apart(&strict, &half, 0), off = 4.0 / 3 * apart(&strict, &half, 1),
                     gain = usual.gain - strict.gain, difference = apart(&usual, &strict, 1),
                     allowed = fmax(part * off, 10 * rtol * size);
        print_message("%3d: gain above the strictest %8.1e (scheme %.1e), difference %.1e of the way (scheme %.1e); "
                      "evaluations a step %.2f, strictest %.2f\n",
                      k, gain / scale, error / scale, difference / size, off / size, (double)usual.calls / usual.steps,
                      (double)strict.calls / strict.steps);
        failed = !usual.locks && (!(gain <= part * error + floor_of * scale) || !(difference <= allowed));
        *worst = usual.locks ? *worst : fmax(*worst, difference / allowed);
    }
    if (failed) {
        print_message("  FAILED: added mass %.3g, drag %.3g\n", ratio, drag);
        scene_print(&c);
    }
    return failed;
}

static void test_random_couplings(void **state) {
    (void)state;
    double worst = 0;
    int failed = scenes ? 0 : check(seed, 0, &worst);
    for (int k = 0; k < scenes; k++) {
        failed += check(seed * 1000 + (uint64_t)k, k, &worst);
    }
    print_message("%d scenes, worst difference %.2g of what is allowed, %d failed\n", scenes, worst, failed);
    assert_int_equal(failed, 0);
}

int main(int argc, char **argv) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_random_couplings)};
    seed = argc > 1 ? strtoull(argv[1], NULL, 10) : seed;
    scenes = argc > 2 ? atoi(argv[2]) : scenes;
    return cmocka_run_group_tests(tests, NULL, NULL);
}
