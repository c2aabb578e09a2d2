/* Threads of a session (spar_session_set_threads): whatever their number, the same bits. The oracle is the run of one
   thread: places, velocities, loads and messages of runs with 2, 3 and 7 threads are compared with its memory. And: as
   many threads as were asked for, none otherwise. */
#include "scene.h"

#include <dirent.h>
#include <fenv.h>
#include <stdio.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

/* This process' threads, where the system says (Linux); else 0. */
static int threads_of_process(void) {
    int n = 0;
    DIR *all = opendir("/proc/self/task");
    for (struct dirent *one = all ? readdir(all) : NULL; one; one = readdir(all)) {
        n += one->d_name[0] != '.';
    }
    if (all) {
        (void)closedir(all);
    }
    return n;
}

/* That they have become so many: a thread that has ended may stay on the list for a moment. */
static void assert_threads(int n) {
    const struct timespec moment = {0, 1000000};
    for (int k = 0; k < 60000 && threads_of_process() != n; k++) {
        (void)nanosleep(&moment, NULL);
    }
    assert_int_equal(threads_of_process(), n);
}

static const int counts[] = {1, 2, 3, 7};
enum { COUNTS = sizeof counts / sizeof *counts };

/* ---- a scene with all that threads share out ---- */

/* Beams of several sizes, two of them tied end to end, one long and with a root that turns, a rigid body, and fluid of
   many nodes on two beams. */
enum { BEAMS = 6, STEPS = 4, MANY = 40000, FEW = 300, ROW = 48, RECORD = ROW * STEPS + 12 * MANY };
static const int elements[BEAMS] = {1, 3, 40, 2, 1, 130}, per_element[BEAMS] = {7, 4, 3, 5, 9, 4};

typedef struct whole_scene {
    spar_session *s;
    spar_member *beam[BEAMS], *body;
    spar_fluid *fluid[2];
    double *place, *x, *v, *force;
} whole_scene;

static double weight_of(int64_t i) {
    return 0.5 + 0.5 * sin(0.37 * (double)i);
}

static void add_fluid(whole_scene *w, int which, spar_member *m, int64_t n, double length) {
    for (int64_t i = 0; i < n; i++) {
        w->place[3 * i] = length * (1.02 * weight_of(7 * i) - 0.01);
        w->place[3 * i + 1] = 0.1 * weight_of(3 * i), w->place[3 * i + 2] = 0.1 * cos((double)i);
    }
    OK(w->s, spar_fluid_create(m, which ? "few" : "many", &w->fluid[which]));
    OK(w->s, spar_fluid_set_motion_nodes(w->fluid[which], n, w->place));
    OK(w->s, spar_fluid_set_force_nodes(w->fluid[which], n, w->place));
    OK(w->s, spar_fluid_map(w->fluid[which]));
}

static void whole_create(whole_scene *w, int threads, int late) {
    double K[36], M[36], J[3] = {1, 2, 3}, centre[3] = {0.1, 0, 0}, mass[36];
    const double rest[4] = {1, 0, 0, 0}, g[3] = {0, 0, -9.81};
    scene_diagonal(K, 1e7, 1e6, 1e6, 3e3, 4e3, 5e3);
    scene_diagonal(M, 2, 2, 2, 0.02, 0.01, 0.01);
    scene_mass(mass, 3, centre, J);
    *w = (whole_scene){.s = scene_session()};
    double **triples[] = {&w->place, &w->x, &w->v, &w->force};
    for (int i = 0; i < 4; i++) {
        *triples[i] = calloc(3 * MANY, sizeof(double));
    }
    if (!late) {
        OK(w->s, spar_session_set_threads(w->s, threads));
    }
    OK(w->s, spar_session_set_gravity(w->s, g));
    OK(w->s, spar_session_set_coupling(w->s, SPAR_COUPLING_IQN_ILS, 1e-9, 1e-7, 40));
    for (int i = 0; i < BEAMS; i++) {
        char name[8] = {'b', (char)('0' + i), 0};
        const double at[3] = {i == 4 ? 2 : 0, i == 4 ? 3 : i, 0}, mu[6] = {1e-3, 1e-3, 1e-3, 1e-3, 1e-3, 1e-3};
        w->beam[i] = scene_beam(w->s, name, elements[i], per_element[i], 2, K, M);
        OK(w->s, spar_member_set_placement(w->beam[i], at, rest));
        OK(w->s, spar_beam_set_damping(w->beam[i], mu));
        if (i == 4) {
            OK(w->s, spar_member_set_root(w->beam[i], SPAR_ROOT_FREE));
        } else if (i == 5) {
            OK(w->s, spar_member_set_root(w->beam[i], SPAR_ROOT_DRIVEN));
        }
        OK(w->s, spar_member_commit(w->beam[i]));
    }
    OK(w->s, spar_rigid_create(w->s, "body", NULL, rest, mass, &w->body));
    OK(w->s, spar_member_commit(w->body));
    spar_joint *tie = NULL;
    int64_t last;
    OK(w->s, spar_member_get_count(w->beam[3], &last));
    OK(w->s, spar_joint_create(w->s, "tie", w->beam[3], last - 1, w->beam[4], 0, SPAR_FREE_RY, &tie));
    add_fluid(w, 0, w->beam[2], MANY, 2);
    add_fluid(w, 1, w->beam[0], FEW, 2);
    if (late) {
        OK(w->s, spar_session_set_threads(w->s, threads));
    }
}

static void whole_destroy(whole_scene *w) {
    spar_session_destroy(&w->s);
    free(w->place);
    free(w->x);
    free(w->v);
    free(w->force);
}

/* A fluid that damps, with a part of mass in it. */
static int whole_fluid(spar_session *s, double t, double dt, int iteration, void *context) {
    whole_scene *w = context;
    for (int which = 0; which < 2; which++) {
        int64_t n = which ? FEW : MANY;
        int status = spar_fluid_pull_motion(w->fluid[which], 1, w->x, w->v);
        for (int64_t i = 0; i < 3 * n && status == SPAR_OK; i++) {
            w->force[i] = (-4 * w->v[i] + 0.3 * sin(20 * t + (double)i)) / (double)n;
        }
        status = status == SPAR_OK ? spar_fluid_push_forces(w->fluid[which], w->force, NULL) : status;
        if (status != SPAR_OK) {
            return status;
        }
    }
    (void)s, (void)dt, (void)iteration;
    return SPAR_OK;
}

/* All that a host sees of a run. */
static void whole_run(int threads, int late, double *record) {
    whole_scene w;
    whole_create(&w, threads, late);
    memset(record, 0, RECORD * sizeof *record);
    for (int step = 0; step < STEPS; step++) {
        int iterations;
        double *at = record + ROW * step;
        const double turned[7] = {0, 0, 1e-3 * step, cos(0.02 * step), 0, sin(0.02 * step), 0},
                     rate[6] = {0, 0, 0.2, 0, 8, 0}, none[6] = {0};
        OK(w.s, spar_member_drive(w.beam[5], turned, rate, none));
        OK(w.s, spar_step(w.s, step == 2 ? 0.02 : 0.005, whole_fluid, &w, &iterations));
        for (int i = 0; i < BEAMS; i++) {
            scene_tip(w.beam[i], at + 7 * i);
        }
        at[42] = iterations;
        OK(w.s, spar_fluid_get_audit(w.fluid[0], 4, at + 43));
    }
    OK(w.s, spar_fluid_pull_motion(w.fluid[0], 0.5, record + ROW * STEPS, record + ROW * STEPS + 3 * MANY));
    OK(w.s, spar_fluid_pull_motion(w.fluid[0], 1, record + ROW * STEPS + 6 * MANY, record + ROW * STEPS + 9 * MANY));
    whole_destroy(&w);
}

static void test_same_bits(void **state) {
    (void)state;
    double *one = malloc(RECORD * sizeof *one), *more = malloc(RECORD * sizeof *more);
    whole_run(1, 0, one);
    for (int i = 0; i < COUNTS; i++) {
        whole_run(counts[i], i == 2, more);
        assert_memory_equal(one, more, RECORD * sizeof *one);
    }
    free(one);
    free(more);
}

/* A host that rounds upwards gets the same bits with any number of threads, which round as the library does. */
static void test_rounding_of_the_host(void **state) {
    (void)state;
    double *one = malloc(RECORD * sizeof *one), *two = malloc(RECORD * sizeof *two);
    int mode = fegetround();
    if (fesetround(FE_UPWARD) == 0) {
        whole_run(1, 0, one); /* its fluid, the host's, rounds upwards */
        whole_run(2, 0, two);
        (void)fesetround(mode);
        assert_memory_equal(one, two, RECORD * sizeof *one);
    }
    free(one);
    free(two);
}

/* A long beam alone, whose elements and nodes are shared out with two threads already: on a root that turns,
   and hanging on one that stands, at rest and then let go. */
enum { LONG = 130, NODES = 4 * LONG };

static void long_run(int threads, int driven, double motion[19 * NODES]) {
    spar_session *s = scene_session();
    spar_member *b = NULL;
    double K[36], M[36];
    const double g[3] = {0, -1, -9.81}, mu[6] = {1e-3, 1e-3, 1e-3, 1e-3, 1e-3, 1e-3}, none[6] = {0};
    scene_diagonal(K, 1e7, 1e6, 1e6, 3e3, 4e3, 5e3);
    scene_diagonal(M, 2, 2, 2, 0.02, 0.01, 0.01);
    OK(s, spar_session_set_threads(s, threads));
    OK(s, spar_session_set_gravity(s, g));
    b = scene_beam(s, "long", LONG, 4, 3, K, M);
    OK(s, spar_beam_set_damping(b, mu));
    OK(s, spar_member_set_root(b, driven ? SPAR_ROOT_DRIVEN : SPAR_ROOT_FIXED));
    OK(s, spar_member_commit(b));
    if (!driven) {
        OK(s, spar_session_solve_static(s, 2, NULL, NULL, NULL));
    }
    for (int step = 1; step <= STEPS; step++) {
        const double turned[7] = {0, 0, 0, cos(0.005 * step), 0, sin(0.005 * step), 0}, rate[6] = {0, 0, 0, 0, 2, 0};
        if (driven) {
            OK(s, spar_member_drive(b, turned, rate, none));
        }
        OK(s, spar_member_set_load(b, NODES / 2, SPAR_LOAD_DEAD, (const double[6]){1, 20.0 * step, 3, 0, 0.5, 0}));
        scene_run(s, step == 3 ? 0.02 : 0.005, 1); /* the third is much longer than the second */
    }
    OK(s, spar_member_get_motion(b, motion, motion + 7 * NODES, motion + 13 * NODES));
    spar_session_destroy(&s);
}

static void test_long_beam(void **state) {
    (void)state;
    static double one[19 * NODES], more[19 * NODES];
    for (int driven = 0; driven < 2; driven++) {
        long_run(1, driven, one);
        for (int i = 1; i < COUNTS; i++) {
            long_run(counts[i], driven, more);
            assert_memory_equal(one, more, sizeof one);
        }
    }
}

/* So many members that steps begin and end for several at once: beams held, driven and free, rigid bodies, two tied,
   one with an added mass, a fluid on each third; accounts of their energy are kept. */
enum { FARM = 50, FARM_NODES = 3, FARM_RECORD = 19 * FARM_NODES + 1 };

typedef struct farm_scene {
    spar_session *s;
    spar_member *m[FARM];
    spar_fluid *fluid[FARM];
} farm_scene;

static void farm_member(farm_scene *w, int i) {
    double K[36], M[36], mass[36];
    const double at[3] = {0, i, 0}, rest[4] = {1, 0, 0, 0}, omega[3] = {0.1 * i, 1, 0};
    char name[16];
    (void)snprintf(name, sizeof name, "m%d", i);
    scene_diagonal(K, 1e7, 1e6, 1e6, 3e3, 4e3, 5e3);
    scene_diagonal(M, 2, 2, 2, 0.02, 0.01, 0.01);
    scene_mass(mass, 3, (const double[3]){0.1, 0, 0}, (const double[3]){1, 2, 3});
    if (i % 7 == 6) {
        OK(w->s, spar_rigid_create(w->s, name, at, rest, mass, &w->m[i]));
        OK(w->s, spar_member_set_initial_velocity(w->m[i], NULL, NULL, omega));
    } else {
        w->m[i] = scene_beam(w->s, name, 1, FARM_NODES, 1 + 0.1 * i, K, M);
        OK(w->s, spar_member_set_placement(w->m[i], at, rest));
        if (i % 5 == 1) {
            OK(w->s, spar_member_set_root(w->m[i], i % 2 ? SPAR_ROOT_DRIVEN : SPAR_ROOT_FREE));
        }
    }
    if (i == 3) {
        const double eta[1] = {0};
        scene_diagonal(mass, 0.2, 0.2, 0.2, 0, 0, 0);
        OK(w->s, spar_member_set_added_mass(w->m[i], 1, eta, mass));
    }
    if (i % 4 == 1) {
        OK(w->s, spar_member_set_effects(w->m[i], SPAR_EFFECT_WORK, 0));
    }
    OK(w->s, spar_member_commit(w->m[i]));
    if (i % 3 == 0) {
        const double x[3] = {0.5, i, 0.1};
        OK(w->s, spar_fluid_create(w->m[i], name, &w->fluid[i]));
        OK(w->s, spar_fluid_set_motion_nodes(w->fluid[i], 1, x));
        OK(w->s, spar_fluid_set_force_nodes(w->fluid[i], 1, x));
        OK(w->s, spar_fluid_map(w->fluid[i]));
    }
}

static int farm_fluid(spar_session *s, double t, double dt, int iteration, void *context) {
    const farm_scene *w = context;
    int status = SPAR_OK;
    for (int i = 0; i < FARM && status == SPAR_OK; i += 3) {
        double x[3], v[3] = {0}, force[3];
        status = spar_fluid_pull_motion(w->fluid[i], 1, x, v);
        for (int k = 0; k < 3; k++) {
            force[k] = sin(20 * (t + dt) + i + k) - 0.4 * v[k];
        }
        status = status == SPAR_OK ? spar_fluid_push_forces(w->fluid[i], force, NULL) : status;
    }
    (void)s, (void)iteration;
    return status;
}

static void farm_run(int threads, double record[FARM][FARM_RECORD]) {
    farm_scene w = {.s = scene_session()};
    const double g[3] = {0, 0, -9.81}, rate[6] = {0, 0, 0, 0, 1, 0}, none[6] = {0};
    spar_joint *tie = NULL;
    OK(w.s, spar_session_set_threads(w.s, threads));
    OK(w.s, spar_session_set_gravity(w.s, g));
    for (int i = 0; i < FARM; i++) {
        farm_member(&w, i);
    }
    OK(w.s, spar_joint_create(w.s, "tie", w.m[8], FARM_NODES - 1, w.m[16], 0, SPAR_FREE_RY, &tie));
    const double place[3] = {0.9, 12, 0};
    OK(w.s, spar_joint_set_frame(tie, place, NULL));
    for (int step = 1; step <= STEPS; step++) {
        const double turned[7] = {0, 0, 0, cos(0.005 * step), 0, sin(0.005 * step), 0};
        OK(w.s, spar_member_drive(w.m[11], turned, rate, none));
        OK(w.s, spar_step(w.s, 0.01, farm_fluid, &w, NULL));
    }
    for (int i = 0; i < FARM; i++) {
        int64_t nodes;
        double *to = record[i];
        OK(w.s, spar_member_get_count(w.m[i], &nodes));
        OK(w.s, spar_member_get_motion(w.m[i], to, to + 7 * nodes, to + 13 * nodes));
        if (i % 4 == 1) {
            OK(w.s, spar_member_get_work(w.m[i], 1, to + 19 * nodes));
        }
    }
    spar_session_destroy(&w.s);
}

static void test_farm(void **state) {
    (void)state;
    static double one[FARM][FARM_RECORD], more[FARM][FARM_RECORD];
    farm_run(1, one);
    for (int i = 1; i < COUNTS; i++) {
        farm_run(counts[i], more);
        assert_memory_equal(one, more, sizeof one);
    }
}

/* ---- members whose motion is given, which joints tie to others ---- */

/* Beams alone, which keep threads busy; driven points, prescribed beams on driven roots and the host's own bodies;
   beams and bodies that hinges, ball joints, springs and lines tie to these and to each other. How many of each, and
   what ties what, is drawn. */
enum { LONE = 4, TOLD = 4, TIED = 6, TIED_STEPS = 12, SCENES = 6, TIED_RECORD = 7 * TIED };

typedef struct told_scene {
    spar_session *s;
    uint64_t random;
    spar_member *told[TOLD], *tied[TIED];
    int64_t end[TIED]; /* the node that may be tied next */
} told_scene;

static int draw(told_scene *w, int n) {
    w->random = w->random * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (int)((w->random >> 33) % (uint64_t)n);
}

static spar_member *straight_beam(told_scene *w, const char *kind, int i, int count, const double at[3]) {
    double K[36], M[36];
    const double rest[4] = {1, 0, 0, 0};
    char name[16];
    scene_diagonal(K, 1e7, 1e6, 1e6, 3e3, 4e3, 5e3);
    scene_diagonal(M, 2, 2, 2, 0.02, 0.01, 0.01);
    (void)snprintf(name, sizeof name, "%s%d", kind, i);
    spar_member *b = scene_beam(w->s, name, count, 4, 1, K, M);
    OK(w->s, spar_member_set_placement(b, at, rest));
    return b;
}

static void add_told(told_scene *w, int i) {
    const double at[3] = {0, i, 0}, rest[4] = {1, 0, 0, 0};
    double mass[36];
    char name[16];
    (void)snprintf(name, sizeof name, "told%d", i);
    if (i % 3 == 0) {
        OK(w->s, spar_point_create(w->s, name, at, NULL, &w->told[i]));
    } else if (i % 3 == 1) {
        w->told[i] = straight_beam(w, "told", i, 1, at);
        OK(w->s, spar_member_set_root(w->told[i], SPAR_ROOT_DRIVEN));
        OK(w->s, spar_member_set_fidelity(w->told[i], SPAR_FIDELITY_PRESCRIBED, 0));
    } else {
        scene_mass(mass, 1, (const double[3]){0}, (const double[3]){1, 1, 1});
        OK(w->s, spar_rigid_create(w->s, name, at, rest, mass, &w->told[i]));
        OK(w->s, spar_member_set_external(w->told[i], 1));
    }
    OK(w->s, spar_member_commit(w->told[i]));
}

/* A beam or a body, tied to one that is told or to one that is tied already. */
static void add_tied(told_scene *w, int i) {
    static const int hinge = SPAR_FREE_RY, ball = SPAR_FREE_RX | SPAR_FREE_RY | SPAR_FREE_RZ;
    int to = draw(w, 3) > 0 || i == 0 ? -1 - draw(w, TOLD) : draw(w, i), whole = draw(w, 3) == 0;
    const double at[3] = {1 + 0.1 * i, 0.3 * i, 0.2};
    char name[16];
    spar_joint *j = NULL;
    (void)snprintf(name, sizeof name, "body%d", i);
    if (whole) {
        w->tied[i] = scene_body(w->s, name, at, 2, (const double[3]){1, 2, 3});
    } else {
        w->tied[i] = straight_beam(w, "tied", i, 1 + draw(w, 3), at);
        OK(w->s, spar_member_set_root(w->tied[i], SPAR_ROOT_FREE));
        OK(w->s, spar_member_commit(w->tied[i]));
    }
    OK(w->s, spar_member_get_count(w->tied[i], &w->end[i]));
    spar_member *b = to < 0 ? w->told[-1 - to] : w->tied[to];
    int64_t node = to < 0 ? 0 : w->end[to] - 1;
    double x[3], K[36];
    memcpy(x, at, sizeof x);
    (void)snprintf(name, sizeof name, "j%d", i);
    switch (draw(w, 4)) {
    case 0:
        OK(w->s, spar_link_create(w->s, name, w->tied[i], 0, x, b, node, (const double[3]){0, 0, 2}, &j));
        OK(w->s, spar_link_set_spring(j, 500, 5, 1, draw(w, 2)));
        break;
    case 1:
        j = scene_joint_at(w->s, name, w->tied[i], 0, b, node, 63, x);
        scene_diagonal(K, 500, 600, 700, 50, 60, 70);
        OK(w->s, spar_joint_set_spring(j, K, NULL, NULL));
        break;
    default:
        (void)scene_joint_at(w->s, name, w->tied[i], 0, b, node, draw(w, 2) ? hinge : ball, x);
    }
}

static void told_move(told_scene *w, double t, int external) {
    const double q[7] = {0.1 * sin(t), 0, 0.2 * sin(3 * t), cos(t), 0, sin(t), 0},
                 v[6] = {0.1 * cos(t), 0, 0.6 * cos(3 * t), 0, 2, 0},
                 a[6] = {-0.1 * sin(t), 0, -1.8 * sin(3 * t), 0, 0, 0};
    for (int i = 0; i < TOLD; i++) {
        if (external && i % 3 == 2) {
            OK(w->s, spar_member_set_motion(w->told[i], q, v, a));
        } else if (!external && i % 3 != 2) {
            OK(w->s, spar_member_drive(w->told[i], q, v, a));
        }
    }
}

static void told_run(uint64_t seed, int threads, double record[TIED_STEPS][TIED_RECORD]) {
    told_scene w = {.s = scene_session(), .random = seed};
    const double g[3] = {0, 0, -9.81};
    OK(w.s, spar_session_set_threads(w.s, threads));
    OK(w.s, spar_session_set_gravity(w.s, g));
    for (int i = 0; i < LONE; i++) {
        OK(w.s, spar_member_commit(straight_beam(&w, "lone", i, 12, (const double[3]){0, 10 + i, 0})));
    }
    for (int i = 0; i < TOLD; i++) {
        add_told(&w, i);
    }
    for (int i = 0; i < TIED; i++) {
        add_tied(&w, i);
    }
    for (int step = 0; step < TIED_STEPS; step++) {
        told_move(&w, 0.01 * (step + 1), 0);
        OK(w.s, spar_step_begin(w.s, 0.01));
        told_move(&w, 0.01 * (step + 1), 1);
        OK(w.s, spar_step_solve(w.s));
        OK(w.s, spar_step_accept(w.s));
        for (int i = 0; i < TIED; i++) {
            scene_tip(w.tied[i], record[step] + 7 * i);
        }
    }
    spar_session_destroy(&w.s);
}

/* What is told moves before those that are tied to it are solved: with all in one round, a step differed from that of
   one thread by up to the whole way of the step. */
static void test_tied_to_told(void **state) {
    (void)state;
    static double one[TIED_STEPS][TIED_RECORD], more[TIED_STEPS][TIED_RECORD];
    for (uint64_t seed = 1; seed <= SCENES; seed++) {
        told_run(seed, 1, one);
        for (int i = 1; i < COUNTS; i++) {
            told_run(seed, counts[i], more);
            assert_memory_equal(one, more, sizeof one);
        }
    }
}

/* ---- fork ---- */

enum { FORK_BEAMS = 4, FORK_RECORD = 7 * FORK_BEAMS };

static spar_session *fork_scene(int threads, spar_member *beam[FORK_BEAMS]) {
    double K[36], M[36];
    spar_session *s = scene_session();
    OK(s, spar_session_set_threads(s, threads));
    OK(s, spar_session_set_gravity(s, (const double[3]){0, 1, -9.81}));
    scene_diagonal(K, 1e7, 1e6, 1e6, 3e3, 4e3, 5e3);
    scene_diagonal(M, 2, 2, 2, 0.02, 0.01, 0.01);
    for (int i = 0; i < FORK_BEAMS; i++) {
        const char name[3] = {'b', (char)('0' + i), 0};
        beam[i] = scene_beam(s, name, i == 0 ? 130 : 2, 4, 2, K, M);
        OK(s, spar_member_commit(beam[i]));
    }
    return s;
}

static void fork_steps(spar_session *s, spar_member *beam[FORK_BEAMS], double record[FORK_RECORD]) {
    scene_run(s, 0.01, 3);
    for (int i = 0; i < FORK_BEAMS; i++) {
        scene_tip(beam[i], record + 7 * i);
    }
}

/* What a child does with a session of its parent's: the bits of what the parent will have; one thread, then two of its
   own; and lets it go. */
static int child_goes_on(spar_session *s, spar_member *beam[FORK_BEAMS], const double expected[FORK_RECORD]) {
    double seen[FORK_RECORD];
    int threads = 0;
    (void)alarm(60); /* a child that waits for threads which it does not have ends */
    if (spar_session_get_threads(s, &threads) != SPAR_OK || threads != 1) {
        return 2;
    }
    fork_steps(s, beam, seen);
    if (memcmp(seen, expected, sizeof seen) != 0) {
        return 3;
    }
    if (spar_session_set_threads(s, 2) != SPAR_OK || threads_of_process() > 2) {
        return 4;
    }
    scene_run(s, 0.01, 2);
    spar_session_destroy(&s);
    return 0;
}

static void test_fork(void **state) {
    (void)state;
#if defined(__SANITIZE_THREAD__)
    skip(); /* it ends a child that makes threads */
#endif
    double expected[FORK_RECORD], seen[FORK_RECORD];
    spar_member *beam[FORK_BEAMS];
    spar_session *s = fork_scene(1, beam);
    scene_run(s, 0.01, 2);
    fork_steps(s, beam, expected);
    spar_session_destroy(&s);
    s = fork_scene(3, beam);
    scene_run(s, 0.01, 2);
    pid_t child = fork();
    if (child == 0) {
        _exit(child_goes_on(s, beam, expected));
    }
    int status = -1;
    assert_true(child > 0 && waitpid(child, &status, 0) == child);
    assert_true(WIFEXITED(status));
    assert_int_equal(WEXITSTATUS(status), 0);
    fork_steps(s, beam, seen);
    assert_memory_equal(seen, expected, sizeof seen);
    spar_session_destroy(&s);
}

/* A step that is loaded in its middle, by a session that has asked for threads since its last one, is solved: the bits
   of the run that was saved. (Nothing was there for the threads to work on: a segmentation fault.) */
static void test_loaded_within(void **state) {
    (void)state;
    static const char path[] = "threads_within.spar";
    double seen[2][FORK_RECORD];
    spar_member *beam[FORK_BEAMS];
    for (int loaded = 0; loaded < 2; loaded++) {
        spar_session *s = fork_scene(1, beam);
        OK(s, spar_step_begin(s, 0.01));
        OK(s, loaded ? SPAR_OK : spar_session_save(s, path));
        if (loaded) {
            OK(s, spar_step_reject(s));
            OK(s, spar_session_set_threads(s, 2));
            OK(s, spar_session_load(s, path));
        }
        OK(s, spar_step_solve(s));
        OK(s, spar_step_accept(s));
        fork_steps(s, beam, seen[loaded]);
        spar_session_destroy(&s);
    }
    assert_memory_equal(seen[0], seen[1], sizeof seen[0]);
    (void)remove(path);
}

/* ---- maps ---- */

static void test_same_feet(void **state) {
    (void)state;
    static double feet[2][2][MANY];
    static int flags[2][MANY];
    double K[36], M[36];
    scene_box(K, M);
    for (int k = 0; k < 2; k++) {
        spar_session *s = scene_session();
        spar_fluid *f = NULL;
        OK(s, spar_session_set_threads(s, k ? 3 : 1));
        const double eta[3] = {0, 0.5, 1}, bow[9] = {0, 0, 0, 1, 0.5, 0, 2, 0, 0};
        spar_member *b = NULL;
        OK(s, spar_beam_create(s, "bow", 4, 5, &b));
        OK(s, spar_beam_set_axis(b, 3, eta, bow, NULL));
        OK(s, spar_beam_set_sections(b, 1, eta, K, M));
        OK(s, spar_member_commit(b));
        double *x = malloc(3 * MANY * sizeof *x);
        for (int64_t i = 0; i < MANY; i++) {
            x[3 * i] = 2.4 * weight_of(i) - 0.2, x[3 * i + 1] = 0.3 * weight_of(2 * i) - 0.5, x[3 * i + 2] = 0;
        }
        OK(s, spar_fluid_create(b, "f", &f));
        OK(s, spar_fluid_set_motion_nodes(f, MANY, x));
        OK(s, spar_fluid_map(f));
        OK(s, spar_fluid_get_map(f, SPAR_NODES_MOTION, feet[k][0], feet[k][1], flags[k]));
        free(x);
        spar_session_destroy(&s);
    }
    assert_memory_equal(feet[0], feet[1], sizeof feet[0]);
    assert_memory_equal(flags[0], flags[1], sizeof flags[0]);
}

/* ---- more nodes than caches hold: their motion goes past them ---- */

/* The nodes of a fluid of many, and each by the side of it in one of few, have the same bits, wherever the host's
   arrays begin: at a double, within a line of the cache, within a double. */
static void test_past_caches(void **state) {
    (void)state;
    enum { ALL = (1 << 19) + 77, SOME = 999 };
    double K[36], M[36], some[2][3 * SOME];
    double *place = malloc(3 * ALL * sizeof *place), few[3 * SOME];
    char *room = malloc(2 * (3 * ALL + 9) * sizeof(double));
    scene_box(K, M);
    for (int64_t i = 0; i < 3 * ALL; i++) {
        place[i] = 2 * weight_of(7 * i);
    }
    for (int64_t i = 0; i < SOME; i++) { /* the last ones, with the part of a tile */
        memcpy(few + 3 * i, place + 3 * (ALL - SOME + i), 3 * sizeof *few);
    }
    for (int threads = 1; threads <= 3; threads += 2) {
        spar_session *s = scene_session();
        spar_fluid *all = NULL, *part = NULL;
        OK(s, spar_session_set_threads(s, threads));
        spar_member *b = scene_beam(s, "b", 1, 5, 2, K, M);
        OK(s, spar_member_commit(b));
        OK(s, spar_member_set_load(b, 4, SPAR_LOAD_DEAD, (const double[6]){0, 30, 100, 0, 0, 5}));
        OK(s, spar_fluid_create(b, "all", &all));
        OK(s, spar_fluid_set_motion_nodes(all, ALL, place));
        OK(s, spar_fluid_map(all));
        OK(s, spar_fluid_create(b, "part", &part));
        OK(s, spar_fluid_set_motion_nodes(part, SOME, few));
        OK(s, spar_fluid_map(part));
        scene_run(s, 0.01, 3);
        OK(s, spar_fluid_pull_motion(part, 1, some[0], some[1]));
        const int at[] = {0, 8, 24, 56, 4};
        for (int i = 0; i < 5; i++) {
            memset(room, 0xff, 2 * (3 * ALL + 9) * sizeof(double));
            char *x = room + at[i], *v = x + (3 * ALL + 1) * sizeof(double);
            OK(s, spar_fluid_pull_motion(all, 1, (double *)(void *)x, (double *)(void *)v));
            size_t last = 3 * (size_t)(ALL - SOME) * sizeof(double);
            assert_memory_equal(x + last, some[0], sizeof some[0]);
            assert_memory_equal(v + last, some[1], sizeof some[1]);
            assert_int_equal((unsigned char)x[3 * ALL * sizeof(double)], 0xff); /* and nothing beyond */
            for (int64_t k = 0; k < 3 * ALL; k += 11) {
                double value;
                memcpy(&value, x + k * (int64_t)sizeof value, sizeof value);
                assert_true(fabs(value - place[k]) < 2);
            }
        }
        spar_session_destroy(&s);
    }
    free(place);
    free(room);
}

/* Single precision: the doubles, rounded, wherever the host's array begins; its forces come in as the same
   doubles do, to the last bit. */
static void test_singles_past_caches(void **state) {
    (void)state;
    enum { ALL = (1 << 19) + 77, LINE = 5 };
    double K[36], M[36], audit[2][SPAR_AUDIT_COUNT];
    double *x = malloc(3 * ALL * sizeof *x), *v = malloc(3 * ALL * sizeof *v);
    char *room = malloc(2 * (3 * ALL + 32) * sizeof(float));
    assert_true(x && v && room);
    scene_box(K, M);
    for (int64_t i = 0; i < 3 * ALL; i++) {
        x[i] = 2 * weight_of(7 * i);
    }
    spar_session *s = scene_session();
    spar_fluid *f = NULL;
    spar_member *b = scene_beam(s, "b", 1, LINE, 2, K, M);
    OK(s, spar_member_commit(b));
    OK(s, spar_member_set_load(b, 4, SPAR_LOAD_DEAD, (const double[6]){0, 30, 100, 0, 0, 5}));
    OK(s, spar_fluid_create(b, "all", &f));
    OK(s, spar_fluid_set_motion_nodes(f, ALL, x));
    OK(s, spar_fluid_set_force_nodes(f, ALL, x));
    OK(s, spar_fluid_map(f));
    scene_run(s, 0.01, 3);
    OK(s, spar_fluid_pull_motion(f, 1, x, v));
    const int at[] = {0, 4, 16, 61};
    for (int i = 0; i < 4; i++) {
        memset(room, 0xff, 2 * (3 * ALL + 32) * sizeof(float));
        char *place = room + at[i], *rate = place + (3 * ALL + 1) * sizeof(float);
        OK(s, spar_fluid_pull_motion_f32(f, 1, (float *)(void *)place, (float *)(void *)rate));
        for (int64_t k = 0; k < 3 * ALL; k++) {
            float got[2];
            memcpy(got, place + k * (int64_t)sizeof *got, sizeof *got);
            memcpy(got + 1, rate + k * (int64_t)sizeof *got, sizeof *got);
            assert_true(got[0] == (float)x[k] && got[1] == (float)v[k]);
        }
        assert_int_equal((unsigned char)place[3 * ALL * sizeof(float)], 0xff); /* and nothing between and beyond */
        assert_int_equal((unsigned char)rate[3 * ALL * sizeof(float)], 0xff);
    }
    OK(s, spar_step_begin(s, 0.01));
    OK(s, spar_step_solve(s));
    for (int single = 0; single < 2; single++) {
        char *force = room + 61;
        for (int64_t k = 0; k < 3 * ALL; k++) {
            float value = (float)(1e-4 * weight_of(3 * k));
            memcpy(force + k * (int64_t)sizeof value, &value, sizeof value);
            v[k] = value;
        }
        OK(s, single ? spar_fluid_push_forces_f32(f, (const float *)(const void *)force, NULL)
                     : spar_fluid_push_forces(f, v, NULL));
        OK(s, spar_fluid_get_audit(f, SPAR_AUDIT_COUNT, audit[single]));
    }
    assert_memory_equal(audit[0], audit[1], sizeof audit[0]);
    assert_true(audit[0][SPAR_AUDIT_FORCE] > 1);
    spar_session_destroy(&s);
    free(x);
    free(v);
    free(room);
}

/* ---- failures ---- */

/* Two of five bodies are given loads beyond the numbers: the message is that of the first, no log hears of the other,
   and the steps after it are the same to the last bit. */
static int heard;
static void hear(const spar_session *s, int level, const char *text, void *context) {
    (void)s, (void)text, (void)context;
    heard += level == SPAR_LOG_ERROR;
}

static void test_failures(void **state) {
    (void)state;
    char said[2][2048];
    double after[2][5][7];
    for (int k = 0; k < 2; k++) {
        spar_session *s = scene_session();
        spar_member *b[5];
        double K[36], M[36];
        const double far[6] = {0, 0, 1e306, 0, 1e306, 0}, push[6] = {0, 0, 1, 0, 0, 0}, none[6] = {0};
        scene_box(K, M);
        OK(s, spar_session_set_threads(s, k ? 3 : 1));
        OK(s, spar_session_set_log(s, hear, NULL));
        for (int i = 0; i < 5; i++) {
            char name[8] = {'b', (char)('0' + i), 0};
            b[i] = scene_beam(s, name, 2, 4, 1 + i, K, M);
            OK(s, spar_member_commit(b[i]));
            OK(s, spar_member_set_load(b[i], 7, SPAR_LOAD_DEAD, push));
        }
        scene_run(s, 0.01, 3);
        OK(s, spar_member_set_load(b[1], 7, SPAR_LOAD_DEAD, far));
        OK(s, spar_member_set_load(b[3], 7, SPAR_LOAD_DEAD, far));
        OK(s, spar_step_begin(s, 0.01));
        heard = 0;
        assert_int_equal(spar_step_solve(s), SPAR_ERR_NUMERIC);
        (void)snprintf(said[k], sizeof said[k], "%s", spar_session_message(s));
        assert_non_null(strstr(said[k], "'b1'"));
        assert_int_equal(heard, 1);
        OK(s, spar_step_reject(s));
        OK(s, spar_member_set_load(b[1], 7, SPAR_LOAD_DEAD, none));
        OK(s, spar_member_set_load(b[3], 7, SPAR_LOAD_DEAD, none));
        scene_run(s, 0.01, 3);
        for (int i = 0; i < 5; i++) {
            scene_tip(b[i], after[k][i]);
        }
        spar_session_destroy(&s);
    }
    assert_string_equal(said[0], said[1]);
    assert_memory_equal(after[0], after[1], sizeof after[0]);
}

/* ---- the number ---- */

static void test_number(void **state) {
    (void)state;
    int before = threads_of_process(), n = 0;
    spar_session *s = scene_session();
    OK(s, spar_session_get_threads(s, &n));
    assert_int_equal(n, 1);
    assert_threads(before);
    const int bad[] = {0, -1, 65, 1 << 30};
    for (int i = 0; i < 4; i++) {
        assert_int_equal(spar_session_set_threads(s, bad[i]), SPAR_ERR_ARGUMENT);
        assert_non_null(strstr(spar_session_message(s), "1 to 64"));
    }
    assert_int_equal(spar_session_set_threads(NULL, 2), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_session_get_threads(NULL, &n), SPAR_ERR_ARGUMENT);
    OK(s, spar_session_get_threads(s, NULL));
    OK(s, spar_session_set_threads(s, 2)); /* the first thread of all may bring one of a sanitizer's along */
    before = before > 0 ? threads_of_process() - 1 : 0;
    for (int i = 0; i < 3; i++) {
        const int wanted[3] = {5, 2, 1};
        OK(s, spar_session_set_threads(s, wanted[i]));
        OK(s, spar_session_get_threads(s, &n));
        assert_int_equal(n, wanted[i]);
        assert_threads(before > 0 ? before + wanted[i] - 1 : 0);
    }
    OK(s, spar_session_set_threads(s, 64));
    OK(s, spar_step_begin(s, 0.1));
    assert_int_equal(spar_session_set_threads(s, 2), SPAR_ERR_STATE);
    OK(s, spar_step_reject(s));
    spar_session_destroy(&s);
    assert_threads(before);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_number),      cmocka_unit_test(test_same_feet),
        cmocka_unit_test(test_failures),    cmocka_unit_test(test_same_bits),
        cmocka_unit_test(test_past_caches), cmocka_unit_test(test_singles_past_caches),
        cmocka_unit_test(test_long_beam),   cmocka_unit_test(test_rounding_of_the_host),
        cmocka_unit_test(test_farm),        cmocka_unit_test(test_tied_to_told),
        cmocka_unit_test(test_fork),        cmocka_unit_test(test_loaded_within),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
