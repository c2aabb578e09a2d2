/* Random scenes for the tests of what a solution leaves: one structure, its load and its steps, drawn from a seed. The
   same scene can be built again with other settings. Work is summed here, without the library. */
#ifndef RANDOM_SCENES_H
#define RANDOM_SCENES_H

#include "sequences.h"

#include <float.h>

static const double scene_pi = 3.14159265358979323846;

/* ---- random numbers ---- */

static uint64_t scene_seed;

static inline double scene_uniform(double from, double to) {
    scene_seed = scene_seed * 6364136223846793005u + 1442695040888963407u;
    return from + (to - from) * (double)(scene_seed >> 11) / 9007199254740992.0;
}

static inline int scene_whole(int from, int to) {
    return from + (int)(scene_uniform(0, 1) * (to - from + 1) * (1 - 1e-12));
}

static inline double scene_decades(double from, double to) {
    return pow(10, scene_uniform(from, to));
}

static inline void scene_seed_by(uint64_t seed) {
    scene_seed = 2862933555777941757u * (seed + 1) + 3037000493u;
    for (int i = 0; i < 10; i++) {
        (void)scene_uniform(0, 1);
    }
}

/* ---- scenes ---- */

/* What is held, and how. The parts of PAIR, CHAIN and FLIGHT are one after the other along x. */
enum {
    CLAMPED, /* a beam */
    PINNED,
    FREE,
    HINGED, /* a beam on a hinge to the ground */
    WELDED, /* two beams; one is clamped, a weld connects them */
    BALL,   /* the same with a ball joint */
    CHAIN,  /* two to four rigid rods on balls or hinges, from the ground on */
    FLIGHT, /* two or three beams or rods on joints, free in space */
    STRUCTURES
};
/* How it is loaded. A load acts at the tip; of a free structure it is a pair of moments at both ends. */
enum { AT_ONCE, RAMPED, PERIODIC, LET_GO, LOADINGS };

enum { SCENE_PARTS = 4, SCENE_NODES = 96 };

typedef struct motion_scene {
    uint64_t seed;
    int structure, loading, parts, elements, nodes, fidelity, modes, plane, rods, joint, pattern, steps;
    int flat;                /* 1: load and motion in the plane of x and z, whether it is held there (plane) or not */
    double length, mass, EI; /* of a part; mass per length */
    double slenderness, strip, rho, mu; /* EA L^2 / EI; EI_z / EI_y; damping, s */
    double amplitude, direction[3];     /* of the deflection, by the length; of the load, a unit vector */
    double per_period, factor,
        ramp; /* steps a period of a clamped part; of random steps; periods of ramp or load, 20 steps at least */
    double velocity[3], spin[3]; /* rigid motion at t = 0 */
    double period, dt;           /* s */
} motion_scene;

static inline void scene_direction(const motion_scene *c, double d[3]) {
    double size = 0;
    for (int k = 0; k < 3; k++) {
        d[k] = scene_uniform(-1, 1) * (k == 0 ? 0.3 : 1);
    }
    if (c->flat) {
        d[1] = 0;
    }
    size = sqrt(spari_dot(d, d)) + 1e-3;
    d[2] += size == 1e-3;
    for (int k = 0; k < 3; k++) {
        d[k] /= size;
    }
}

/* The steps are short enough for the rotation: 0.2 rad each at most. */
static inline void scene_draw_motion(motion_scene *c) {
    const double most = 0.2 / c->dt, rate = fmin(most, scene_decades(-2, 0.5) / c->period * 2 * scene_pi);
    for (int k = 0; k < 3; k++) {
        c->velocity[k] = c->length / c->period * scene_uniform(-1, 1);
        c->spin[k] = rate * scene_uniform(-0.57, 0.57);
    }
    if (c->flat) {
        c->velocity[1] = c->spin[0] = c->spin[2] = 0;
    }
}

static inline void scene_draw_beam(motion_scene *c) {
    c->nodes = scene_uniform(0, 1) < 0.6 ? scene_whole(4, 10) : scene_whole(2, 24);
    c->elements = c->nodes > 12 ? scene_whole(1, 2) : scene_whole(1, 4);
    c->slenderness = scene_decades(2, 12);
    c->strip = scene_uniform(0, 1) < 0.5 ? 1 : fmin(scene_decades(0, 3), c->slenderness / 20);
    const double of = scene_uniform(0, 1);
    int single = c->structure <= FREE;
    c->fidelity = of < 0.7 || !single ? SPAR_FIDELITY_EXACT
                  : of < 0.8          ? SPAR_FIDELITY_LINEAR
                  : of < 0.9          ? SPAR_FIDELITY_MODAL
                                      : SPAR_FIDELITY_RIGID;
    c->modes = (c->structure == FREE     ? 6
                : c->structure == PINNED ? 3
                                         : 0) +
               scene_whole(1, (int)fmin(8, c->elements * (c->nodes - 1)));
    c->plane = single && c->fidelity == SPAR_FIDELITY_EXACT && scene_uniform(0, 1) < 0.2;
    if (!single) {
        c->elements = scene_whole(1, 2), c->nodes = scene_whole(3, 9);
    }
    /* a thin beam that is bent and may turn about its axis rolls faster than a step resolves */
    c->flat =
        c->plane || ((c->structure == PINNED || c->structure == FREE || c->structure == FLIGHT) && c->seed / 7 % 2);
}

/* structure, loading: -1 for any. uneven: steps of any length. */
static inline motion_scene scene_draw(uint64_t seed, int structure, int loading, int uneven) {
    static const int balls = SPAR_FREE_RX | SPAR_FREE_RY | SPAR_FREE_RZ;
    static const double rhos[] = {0, 0.5, 0.8, 0.9, 0.9, 0.9, 1};
    motion_scene c = {.seed = seed, .fidelity = SPAR_FIDELITY_EXACT};
    scene_seed_by(seed);
    c.structure = structure < 0 ? scene_whole(0, STRUCTURES - 1) : structure;
    c.loading = loading < 0 ? scene_whole(0, LOADINGS - 1) : loading;
    c.parts = c.structure <= HINGED ? 1 : c.structure <= BALL ? 2 : scene_whole(2, c.structure == CHAIN ? 4 : 3);
    scene_draw_beam(&c);
    c.rods = c.structure == CHAIN || (c.structure == FLIGHT && scene_uniform(0, 1) < 0.4);
    c.joint = c.structure == WELDED ? 0
              : c.structure == BALL ? balls
                                    : (int[]){0, SPAR_FREE_RY, balls}[scene_whole(0, 2)];
    c.joint = c.structure == CHAIN && c.joint == 0 ? balls : c.joint;
    c.length = scene_decades(-1, 1), c.mass = scene_decades(-2, 2), c.EI = scene_decades(-1, 4);
    c.period = 2 * scene_pi / 3.516 * c.length * c.length * sqrt(c.mass / c.EI);
    c.rho = rhos[scene_whole(0, 6)];
    c.mu = scene_uniform(0, 1) < 0.25 ? scene_decades(-3, -1) * c.period / scene_pi : 0; /* mu omega / 2 is the ratio */
    c.amplitude = scene_decades(-3, 0);
    c.per_period = scene_decades(log10(20), 3);
    c.dt = c.period / c.per_period;
    c.ramp = fmax(scene_decades(-1, 0.3), 20 / c.per_period);
    c.pattern = uneven ? scene_whole(ONE_PERCENT, REPEATED) : EVEN;
    c.factor = scene_decades(0.1, 3);
    c.steps = (int)fmin(fmax(1.5 * c.per_period, 100), 500);
    scene_direction(&c, c.direction);
    scene_draw_motion(&c);
    return c;
}

static inline void scene_print(const motion_scene *c) {
    static const char *const structures[] = {"clamped", "pinned", "free",  "hinged",
                                             "welded",  "ball",   "chain", "flight"},
                             *const loadings[] = {"at once", "ramped", "periodic", "let go"},
                             *const fidelities[] = {"prescribed", "rigid", "linear", "modal", "exact"};
    print_message("    seed %llu: %s, %s, %d parts%s, joint %d, %d x %d nodes, %s (%d modes)%s, EA L2/EI %.2g, strip "
                  "%.2g, rho_inf %g, mu %.2g s, amplitude %.2g, %.0f steps a period, sequence %d, factor %.3g, ramp "
                  "%.2g; L %.3g, m %.3g, EI %.3g, dt %.4g\n",
                  (unsigned long long)c->seed, structures[c->structure], loadings[c->loading], c->parts,
                  c->rods ? " (rods)" : "", c->joint, c->elements, c->nodes, fidelities[c->fidelity], c->modes,
                  c->plane  ? ", held in a plane"
                  : c->flat ? ", in a plane"
                            : "",
                  c->slenderness, c->strip, c->rho, c->mu, c->amplitude, c->per_period, c->pattern, c->factor, c->ramp,
                  c->length, c->mass, c->EI, c->dt);
}

/* ---- building ---- */

/* A scene that runs. */
typedef struct motion_world {
    const motion_scene *c;
    spar_session *s;
    spar_fluid_solver solver; /* NULL: no fluid */
    void *context;
    spar_member *m[SCENE_PARTS];
    spar_joint *j[SCENE_PARTS];
    int64_t n[SCENE_PARTS];
    int joints, status;      /* status: of the commit that was refused */
    double t, load[6], work; /* load at the tip now; its work so far */
    double tip[7], rate[6];  /* motion of the tip now, its velocity, and its angular velocity relative to the root */
} motion_world;

/* The strictest settings: tolerances at rounding. */
static inline void scene_strictest(spar_session *s) {
    OK(s, spar_session_set_newton(s, 1e-15, 1e-14, 100));
}

static inline void scene_sections(const motion_scene *c, double *K, double *M) {
    const double EA = c->EI * c->slenderness / c->length / c->length, I = c->mass * c->EI / EA, GJ = 0.8 * c->EI;
    scene_diagonal(K, EA, 0.3 * EA, 0.3 * EA, GJ, c->EI, c->EI * c->strip);
    scene_diagonal(M, c->mass, c->mass, c->mass, I * (1 + c->strip), I, I * c->strip);
}

static inline int scene_create_part(motion_world *w, int i) {
    const motion_scene *c = w->c;
    const char name[4] = {'p', (char)('0' + i), 0};
    const double L = c->length, eta[2] = {0, 1}, line[6] = {i * L, 0, 0, (i + 1) * L, 0, 0}, middle[3] = {L / 2, 0, 0},
                 m = c->mass * L, J[3] = {m * L * L / 240, m * L * L / 12, m * L * L / 12},
                 mu[6] = {c->mu, c->mu, c->mu, c->mu, c->mu, c->mu}, straight[4] = {1, 0, 0, 0};
    double K[36], M[36];
    if (c->rods) { /* the node at the end that is nearer to the ground, so that joints have arms */
        scene_mass(M, m, middle, J);
        OK(w->s, spar_rigid_create(w->s, name, line, straight, M, &w->m[i]));
    } else {
        scene_sections(c, K, M);
        OK(w->s, spar_beam_create(w->s, name, c->elements, c->nodes, &w->m[i]));
        OK(w->s, spar_beam_set_axis(w->m[i], 2, eta, line, NULL));
        OK(w->s, spar_beam_set_sections(w->m[i], 1, eta, K, M));
        OK(w->s, spar_beam_set_damping(w->m[i], mu));
        OK(w->s, spar_beam_set_plane(w->m[i], c->plane ? (const double[3]){0, 1, 0} : NULL));
        OK(w->s, spar_member_set_fidelity(w->m[i], c->fidelity, c->fidelity == SPAR_FIDELITY_MODAL ? c->modes : 0));
        OK(w->s,
           spar_member_set_root(w->m[i], c->structure == PINNED                                    ? SPAR_ROOT_PINNED
                                         : i > 0 || c->structure == FREE || c->structure >= HINGED ? SPAR_ROOT_FREE
                                                                                                   : SPAR_ROOT_FIXED));
        if (i == 0 && (c->structure == WELDED || c->structure == BALL)) {
            OK(w->s, spar_member_set_root(w->m[i], SPAR_ROOT_FIXED));
        }
    }
    OK(w->s, spar_member_get_count(w->m[i], &w->n[i]));
    return spar_member_commit(w->m[i]);
}

static inline void scene_create_joint(motion_world *w, int i) {
    const motion_scene *c = w->c;
    const char name[4] = {'j', (char)('0' + i), 0};
    const double x[3] = {i * c->length, 0, 0};
    int grounded = c->structure == HINGED || c->structure == CHAIN;
    if (i > 0 || grounded) {
        w->j[w->joints++] = scene_joint_at(w->s, name, w->m[i], 0, i ? w->m[i - 1] : NULL,
                                           i ? (w->n[i - 1] > 1 ? w->n[i - 1] - 1 : 0) : 0,
                                           c->structure == HINGED ? SPAR_FREE_RY : c->joint, x);
    }
}

static inline int scene_is_free(const motion_scene *c) {
    return c->structure == FREE || c->structure == FLIGHT;
}

/* Whether the load at time t is applied, and its size: 1 is that which deflects a clamped part by the amplitude. */
static inline double scene_load_at(const motion_scene *c, double t) {
    const double s = t / (c->ramp * c->period);
    switch (c->loading) {
    case AT_ONCE:
        return 1;
    case RAMPED:
        return fmin(s, 1);
    case PERIODIC:
        return sin(2 * scene_pi * s);
    default:
        return 0;
    }
}

/* Sets the load at the end of the next step. */
static inline void scene_put_load(motion_world *w, double at, double load[6]) {
    const motion_scene *c = w->c;
    const double size = scene_load_at(c, at) * c->amplitude * c->EI / c->length;
    const int last = c->parts - 1, first = scene_is_free(c) ? 3 : 0;
    memset(load, 0, 6 * sizeof *load);
    for (int k = 0; k < 3; k++) {
        load[first + k] = size * c->direction[k] * (first ? 1 : 3 / c->length);
    }
    if (first && c->flat) {
        load[3] = load[5] = 0, load[4] = size;
    }
    if (c->loading == LET_GO) {
        return;
    }
    OK(w->s, spar_member_set_load(w->m[last], w->n[last] - 1, SPAR_LOAD_DEAD, load));
    if (first && (c->parts > 1 || w->n[0] > 1)) { /* the sum of moments is 0 */
        double back[6];
        for (int k = 0; k < 6; k++) {
            back[k] = -load[k];
        }
        OK(w->s, spar_member_set_load(w->m[0], 0, SPAR_LOAD_DEAD, back));
    }
}

/* Motion of the first or the last node of a part. */
static inline void scene_read_end(const motion_world *w, int part, int last, double q[7], double v[6]) {
    double all[7 * SCENE_NODES], rates[6 * SCENE_NODES];
    const int64_t n = w->n[part], i = last ? n - 1 : 0;
    assert_true(n <= SCENE_NODES);
    OK(w->s, spar_member_get_motion(w->m[part], all, rates, NULL));
    if (q) {
        memcpy(q, all + 7 * i, 7 * sizeof *q);
    }
    memcpy(v, rates + 6 * i, 6 * sizeof *v);
}

/* SPAR_NEWTON=1e-8 and the like try another tolerance in place of the default. */
static inline void scene_try_tolerance(spar_session *s) {
    const char *rtol = getenv("SPAR_NEWTON");
    if (rtol) {
        OK(s, spar_session_set_newton(s, 1e-15, atof(rtol), 50));
    }
}

/* LET_GO: held structures fall under gravity from rest; free ones move at t = 0 in any case. */
static inline motion_world scene_build(const motion_scene *c, int strictest) {
    motion_world w = {.c = c};
    OK(NULL, spar_session_create(&w.s));
    if (strictest) {
        scene_strictest(w.s);
    } else {
        scene_try_tolerance(w.s);
    }
    OK(w.s, spar_session_set_integrator(w.s, c->rho, 1));
    if (c->loading == LET_GO && !scene_is_free(c)) {
        double g[3];
        for (int k = 0; k < 3; k++) { /* a clamped part bends by F L^3 / 8 EI */
            g[k] = 8 * c->amplitude * c->EI / pow(c->length, 3) / c->mass * c->direction[k];
        }
        OK(w.s, spar_session_set_gravity(w.s, g));
    }
    for (int i = 0; i < c->parts; i++) {
        w.status = scene_create_part(&w, i);
        if (w.status != SPAR_OK) {
            return w;
        }
        scene_create_joint(&w, i);
    }
    if (scene_is_free(c)) {
        for (int i = 0; i < c->parts; i++) {
            OK(w.s, spar_member_set_initial_velocity(w.m[i], NULL, c->velocity, c->spin));
        }
    }
    scene_put_load(&w, 0, w.load);
    scene_read_end(&w, c->parts - 1, 1, w.tip, w.rate);
    w.rate[3] = w.rate[4] = w.rate[5] = 0; /* all parts turn alike at t = 0 */
    return w;
}

/* ---- steps and energy ---- */

/* One step. A force is linear within it, and does its work on a cubic (Hermite) displacement: exact for forces that
   stay. A pair of moments does its work by the trapezoidal rule, of order 2. */
static inline int scene_step(motion_world *w, double dt) {
    double load[6], q[7], v[6], root[6];
    scene_put_load(w, w->t + dt, load);
    int status = spar_step(w->s, dt, w->solver, w->context, NULL);
    if (status != SPAR_OK) {
        return status;
    }
    w->t += dt;
    scene_read_end(w, w->c->parts - 1, 1, q, v);
    scene_read_end(w, 0, 0, NULL, root);
    for (int k = 0; k < 3; k++) {
        const double mean = 0.5 * (load[k] + w->load[k]), turn = v[3 + k] - root[3 + k];
        w->work += mean * (q[k] - w->tip[k]) - (load[k] - w->load[k]) * (w->rate[k] - v[k]) * dt / 12;
        w->work += 0.25 * (load[3 + k] + w->load[3 + k]) * (turn + w->rate[3 + k]) * dt;
        v[3 + k] = turn;
    }
    memcpy(w->load, load, sizeof load), memcpy(w->tip, q, sizeof q), memcpy(w->rate, v, sizeof v);
    return SPAR_OK;
}

/* Kinetic, strain and potential energy of all parts. What damping takes is not added: energy may only fall by it. */
static inline double scene_energy(const motion_world *w, double *size) {
    double sum = 0, e[SPAR_ENERGY_COUNT];
    *size = 0;
    for (int i = 0; i < w->c->parts && w->status == SPAR_OK; i++) {
        OK(w->s, spar_member_get_energy(w->m[i], SPAR_ENERGY_COUNT, e));
        sum += e[SPAR_ENERGY_KINETIC] + e[SPAR_ENERGY_STRAIN] + e[SPAR_ENERGY_GRAVITY];
        *size += e[SPAR_ENERGY_KINETIC] + fabs(e[SPAR_ENERGY_STRAIN]);
    }
    return sum;
}

/* Newton's iterations so far, of the part that has most. */
static inline int64_t scene_iterations(const motion_world *w) {
    int64_t most = 0;
    for (int i = 0; i < w->c->parts && w->status == SPAR_OK; i++) {
        int64_t n;
        OK(w->s, spar_member_get_iterations(w->m[i], &n, NULL));
        most = n > most ? n : most;
    }
    return most;
}

/* Whether the library has told that elements have too few nodes for their stiffness: no answer is promised then. */
static inline int scene_is_told_to_lock(const motion_world *w) {
    for (int k = 0; spar_session_get_warning(w->s, k)[0] != '\0'; k++) {
        if (strstr(spar_session_get_warning(w->s, k), " locks")) {
            return 1;
        }
    }
    return 0;
}

/* A run of this many iterations a step on average is stopped, so that a scene that hardly converges ends in time. */
enum { SCENE_ITERATIONS = 40 };

static inline int scene_is_slow(const motion_world *w, int steps) {
    return scene_iterations(w) > (int64_t)SCENE_ITERATIONS * steps;
}

/* What the command line of a test of long runs says: seed, number of scenes, steps of each. */
typedef struct scene_plan {
    uint64_t seed;
    int scenes, steps;
} scene_plan;

static inline void scene_take_arguments(int argc, char **argv, scene_plan *p) {
    p->seed = argc > 1 ? strtoull(argv[1], NULL, 10) : p->seed;
    p->scenes = argc > 2 ? atoi(argv[2]) : p->scenes;
    p->steps = argc > 3 ? atoi(argv[3]) : p->steps;
}

/* Plays the scenes of a plan; 0: the one of its seed. The first `fixed` ones have their own number as seed. */
static inline void scene_check_all(const scene_plan *p, int fixed, motion_scene (*draw)(uint64_t at),
                                   int (*check)(const motion_scene *c, int k)) {
    int failed = 0;
    for (int k = 0; k < (p->scenes > 0 ? p->scenes : 1); k++) {
        const motion_scene c = draw(p->scenes == 0 ? p->seed : k < fixed ? (uint64_t)k : p->seed * 1000 + (uint64_t)k);
        failed += check(&c, k);
    }
    print_message("%d scenes of %d steps, %d failed\n", p->scenes, p->steps, failed);
    assert_int_equal(failed, 0);
}

#endif
