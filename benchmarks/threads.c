/* What threads gain (spar_session_set_threads): wall time of one thread over that of `threads`, the two taking turns,
   the median of the turns (the bits are the same: tests/session/test_threads.c). threads [THREADS, default 2]
   And whether the cost of a step stays linear: of an element of 4 nodes in beams of 1000 m, of a member among others,
   one thread, median of so many steps from rest and the least. threads linear
   threads linear MEMBERS ELEMENTS NODES STEPS: one of these, for valgrind --tool=callgrind */
#include <math.h>
#include <spar/spar.h>
#include <spar/spar_coupling.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { TURNS = 15, MOST = 1000000 };

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void need(const spar_session *s, int status) {
    if (status != SPAR_OK) {
        fprintf(stderr, "%s: %s\n", spar_status_text(status), spar_session_message(s));
        exit(1);
    }
}

static spar_member *add_beam(spar_session *s, int number, int elements, int nodes, double length) {
    const double eta[2] = {0, 1}, line[6] = {0, 5.0 * number, 0, length, 5.0 * number, 0};
    double K[36] = {0}, M[36] = {0};
    const double k[6] = {1e10, 1e9, 1e9, 1e9, 1e9, 2e9}, m[6] = {100, 100, 100, 10, 5, 5};
    for (int i = 0; i < 6; i++) {
        K[7 * i] = k[i], M[7 * i] = m[i];
    }
    char name[32];
    spar_member *b = NULL;
    (void)snprintf(name, sizeof name, "beam %d", number);
    need(s, spar_beam_create(s, name, elements, nodes, &b));
    need(s, spar_beam_set_axis(b, 2, eta, line, NULL));
    need(s, spar_beam_set_sections(b, 1, eta, K, M));
    need(s, spar_member_commit(b));
    return b;
}

static spar_session *new_session(int threads) {
    const double g[3] = {0, 0, -9.81};
    spar_session *s = NULL;
    need(NULL, spar_session_create(&s));
    need(s, spar_session_set_gravity(s, g));
    need(s, spar_session_set_threads(s, threads));
    return s;
}

/* ---- the scenes ---- */

typedef struct scene {
    spar_session *s;
    spar_fluid *f;
    double *x, *v;
} scene;

static void make_members(scene *w, int threads, int count, int elements, int nodes, double length) {
    w->s = new_session(threads);
    for (int i = 0; i < count; i++) {
        (void)add_beam(w->s, i, elements, nodes, length);
    }
}

static void make_blades(scene *w, int threads) {
    make_members(w, threads, 3, 1, 10, 60);
}

static void make_farm(scene *w, int threads) {
    make_members(w, threads, 300, 1, 10, 60);
}

static void make_line(scene *w, int threads) {
    make_members(w, threads, 1, 10000, 4, 10000);
}

static void make_fluid(scene *w, int threads) {
    w->s = new_session(threads);
    spar_member *b = add_beam(w->s, 0, 1, 5, 60);
    w->x = malloc(3 * MOST * sizeof *w->x), w->v = malloc(3 * MOST * sizeof *w->v);
    for (int64_t i = 0; i < MOST; i++) {
        double angle = 0.01 * (double)i;
        w->x[3 * i] = 60 * (double)i / MOST, w->x[3 * i + 1] = cos(angle), w->x[3 * i + 2] = sin(angle);
    }
    need(w->s, spar_fluid_create(b, "fluid", &w->f));
    need(w->s, spar_fluid_set_motion_nodes(w->f, MOST, w->x));
    need(w->s, spar_fluid_set_force_nodes(w->f, MOST, w->x));
    need(w->s, spar_fluid_map(w->f));
    need(w->s, spar_step_begin(w->s, 0.01));
    need(w->s, spar_step_solve(w->s));
}

static void step(scene *w) {
    need(w->s, spar_step_begin(w->s, 0.01));
    need(w->s, spar_step_solve(w->s));
    need(w->s, spar_step_accept(w->s));
}

static void step_often(scene *w) {
    for (int i = 0; i < 200; i++) {
        step(w);
    }
}

static void map(scene *w) {
    need(w->s, spar_step_reject(w->s));
    need(w->s, spar_fluid_map(w->f));
    need(w->s, spar_step_begin(w->s, 0.01));
    need(w->s, spar_step_solve(w->s));
}

static void pull(scene *w) {
    need(w->s, spar_fluid_pull_motion(w->f, 1, w->x, w->v));
}

static void push(scene *w) {
    need(w->s, spar_fluid_push_forces(w->f, w->v, NULL));
}

static const struct {
    const char *what;
    void (*make)(scene *w, int threads);
    void (*run)(scene *w);
    int runs;
} scenes[] = {{"three blades of 10 nodes, a step", make_blades, step_often, 200},
              {"300 blades of 10 nodes, a step", make_farm, step, 1},
              {"a beam of 10000 elements of 4 nodes, a step", make_line, step, 1},
              {"a million nodes on a beam of 5: map", make_fluid, map, 1},
              {"pull places and velocities", make_fluid, pull, 1},
              {"push forces", make_fluid, push, 1}};

/* ---- in turns ---- */

static int by_size(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double timed(scene *w, void (*run)(scene *w)) {
    double since = now();
    run(w);
    return now() - since;
}

static void measure(size_t k, int threads) {
    scene w[2] = {{0}, {0}};
    double seconds[TURNS], ratio[TURNS];
    for (int i = 0; i < 2; i++) {
        scenes[k].make(&w[i], i ? threads : 1);
        scenes[k].run(&w[i]);
    }
    for (int t = 0; t < TURNS; t++) {
        seconds[t] = timed(&w[0], scenes[k].run);
        ratio[t] = seconds[t] / timed(&w[1], scenes[k].run);
    }
    qsort(seconds, TURNS, sizeof *seconds, by_size);
    qsort(ratio, TURNS, sizeof *ratio, by_size);
    printf("%-46s %10.3f %8.2f\n", scenes[k].what, 1e3 * seconds[TURNS / 2] / scenes[k].runs, ratio[TURNS / 2]);
    fflush(stdout);
    for (int i = 0; i < 2; i++) {
        spar_session_destroy(&w[i].s);
        free(w[i].x);
        free(w[i].v);
    }
}

/* ---- the cost of one among others ---- */

enum { MOST_STEPS = 1000 };

static void measure_one(int members, int elements, int nodes, int steps) {
    scene w = {0};
    double seconds[MOST_STEPS], each = 1e6 / members / elements;
    make_members(&w, 1, members, elements, nodes, elements > 1 ? 1000 : 60);
    for (int k = 0; k < steps; k++) {
        seconds[k] = timed(&w, step);
    }
    qsort(seconds, (size_t)steps, sizeof *seconds, by_size);
    printf("%8d %8d %8d %8d %10.2f %10.2f\n", members, elements, nodes, steps, each * seconds[steps / 2],
           each * seconds[0]);
    fflush(stdout);
    spar_session_destroy(&w.s);
}

static int measure_linear(int argc, char **argv) {
    static const int of[][4] = {{1, 32, 4, 100},   {1, 256, 4, 100}, {1, 512, 4, 100}, {1, 1024, 4, 100},
                                {1, 4096, 4, 100}, {1, 1, 10, 200},  {300, 1, 10, 200}};
    printf("%8s %8s %8s %8s %10s %10s\n", "members", "elements", "nodes", "steps", "us each", "least");
    if (argc > 5) {
        int steps = atoi(argv[5]);
        measure_one(atoi(argv[2]), atoi(argv[3]), atoi(argv[4]), steps < MOST_STEPS ? steps : MOST_STEPS);
        return 0;
    }
    for (size_t k = 0; k < sizeof of / sizeof *of; k++) {
        measure_one(of[k][0], of[k][1], of[k][2], of[k][3]);
    }
    return 0;
}

int main(int argc, char **argv) {
    if (argc > 1 && strcmp(argv[1], "linear") == 0) {
        return measure_linear(argc, argv);
    }
    int threads = argc > 1 ? atoi(argv[1]) : 2;
    printf("%-46s %10s %8s\n", "", "1 thread", "gain of");
    printf("%-46s %10s %6d\n", "", "ms", threads);
    for (size_t k = 0; k < sizeof scenes / sizeof *scenes; k++) {
        measure(k, threads);
    }
    return 0;
}
