/* Whether advice is kept over ten times the trials, on eleven scenes that it was not made with: each asks for two
   tolerances, puts the advice in force, runs ten times as long as the trials did and is compared with where
   steps of a sixteenth and of half that point to, on more nodes, with the coupling converged. kept [--scene name]
   [--scale factor ...] [--verbose]: asks at so many times the tolerances, for each factor; 1 where there is none. A
   table on stdout; 1: one tolerance or more is not kept. */
#include <spar/spar.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MEMBERS = 4, NODES = 8, TIMES = 10, FINER = 16 };

#define TRY(call)                                                                                                      \
    do {                                                                                                               \
        int status_ = (call);                                                                                          \
        if (status_ != SPAR_OK) {                                                                                      \
            return status_;                                                                                            \
        }                                                                                                              \
    } while (0)

/* Loads at nodes along each member, across it: two waves, a drag linear, square and cubic in the velocity, a spring. */
typedef struct flow {
    double wave[2], rate[2], number, linear, square, cubic, spring;
} flow;

typedef struct world {
    spar_session *s;
    spar_member *m[MEMBERS];
    spar_fluid *f[MEMBERS];
    int64_t n[MEMBERS];
    double x[MEMBERS][3 * NODES], rest[MEMBERS][3 * NODES], v[MEMBERS][3 * NODES];
    int members, nodes; /* of an element */
    flow air;
    double spin; /* of the first member's root, rad/s */
} world;

static int blow(spar_session *s, double t, double dt, int iteration, void *context) {
    world *w = context;
    double force[3 * NODES];
    (void)s, (void)iteration;
    for (int k = 0; k < w->members; k++) {
        const flow *a = &w->air;
        TRY(spar_fluid_pull_motion(w->f[k], 1, w->x[k], w->v[k]));
        memset(force, 0, sizeof force);
        for (int64_t i = 0; i < w->n[k]; i++) {
            double v = w->v[k][3 * i + 2], at = a->number * w->rest[k][3 * i];
            force[3 * i + 2] = a->wave[0] * sin(a->rate[0] * (t + dt) - at) + a->wave[1] * sin(a->rate[1] * (t + dt)) -
                               v * (a->linear + a->square * fabs(v) + a->cubic * v * v) -
                               a->spring * (w->x[k][3 * i + 2] - w->rest[k][3 * i + 2]);
        }
        TRY(spar_fluid_push_forces(w->f[k], force, NULL));
    }
    return SPAR_OK;
}

static int spin(spar_session *s, double t, double dt, void *context) {
    world *w = context;
    double half = 0.5 * w->spin * (t + dt);
    const double q[7] = {0, 0, 0, cos(half), sin(half), 0, 0}, v[6] = {0, 0, 0, w->spin, 0, 0}, a[6] = {0};
    (void)s;
    return w->spin > 0 ? spar_member_drive_root(w->m[0], q, v, a) : SPAR_OK;
}

/* ---- members ---- */

static void diagonal(double *m, double a, double b, double c, double d, double e, double f) {
    const double x[6] = {a, b, c, d, e, f};
    memset(m, 0, 36 * sizeof *m);
    for (int i = 0; i < 6; i++) {
        m[7 * i] = x[i];
    }
}

static int add_fluid(world *w, int64_t n, const double *x) {
    int k = w->members++;
    char name[16];
    (void)snprintf(name, sizeof name, "air%d", k);
    w->n[k] = n;
    memcpy(w->rest[k], x, (size_t)(3 * n) * sizeof *x);
    TRY(spar_fluid_create(w->m[k], name, &w->f[k]));
    TRY(spar_fluid_set_motion_nodes(w->f[k], n, x));
    TRY(spar_fluid_set_force_nodes(w->f[k], n, x));
    return spar_fluid_map(w->f[k]);
}

/* From a to b, of stiffness EI, 1 kg/m. */
static int add_beam(world *w, int root, const double a[3], const double b[3], double EI, double damping) {
    const double eta[2] = {0, 1}, xyz[6] = {a[0], a[1], a[2], b[0], b[1], b[2]};
    double K[36], M[36], x[3 * NODES], mu[6];
    char name[16];
    (void)snprintf(name, sizeof name, "beam%d", w->members);
    diagonal(K, 1e4 * EI, 1e4 * EI, 1e4 * EI, EI, EI, 2 * EI);
    diagonal(M, 1, 1, 1, 2e-3, 1e-3, 1e-3);
    spar_member **m = &w->m[w->members];
    TRY(spar_beam_create(w->s, name, 1, w->nodes, m));
    TRY(spar_beam_set_axis(*m, 2, eta, xyz, NULL));
    TRY(spar_beam_set_sections(*m, 1, eta, K, M));
    TRY(spar_member_set_root(*m, root));
    for (int i = 0; i < 6; i++) {
        mu[i] = damping;
    }
    if (damping > 0) {
        TRY(spar_beam_set_damping(*m, mu));
    }
    TRY(spar_member_commit(*m));
    for (int i = 0; i < NODES; i++) {
        for (int c = 0; c < 3; c++) {
            x[3 * i + c] = a[c] + (b[c] - a[c]) * (i + 0.5) / NODES;
        }
    }
    return add_fluid(w, NODES, x);
}

static int add_body(world *w, double mass) {
    const double zero[3] = {0, 0, 0};
    double M[36];
    diagonal(M, mass, mass, mass, mass, mass, mass);
    TRY(spar_rigid_create(w->s, "body", zero, NULL, M, &w->m[w->members]));
    TRY(spar_member_commit(w->m[w->members]));
    return add_fluid(w, 1, zero);
}

static int tie(world *w, const char *name, int a, int b, int free) {
    spar_joint *joint;
    int64_t last = 0;
    if (b >= 0) {
        TRY(spar_member_get_count(w->m[b], &last));
    }
    return spar_joint_create(w->s, name, w->m[a], 0, b < 0 ? NULL : w->m[b], b < 0 ? 0 : last - 1, free, &joint);
}

/* ---- scenes ---- */

static const double o[3] = {0, 0, 0}, one[3] = {1, 0, 0}, two[3] = {2, 0, 0};

static int pile(world *w) {
    w->air = (flow){.wave = {0.1, 0}, .rate = {2.1, 0}, .number = 0.3, .linear = 0.05};
    return add_beam(w, SPAR_ROOT_FIXED, o, two, 120, 0);
}

static int sea(world *w) {
    w->air = (flow){.wave = {0.1, 0.06}, .rate = {2.1, 3.3}, .number = 0.3, .linear = 0.02, .square = 0.5};
    return add_beam(w, SPAR_ROOT_FIXED, o, two, 120, 0);
}

static int riser(world *w) { /* wakes that drive it until their drag stops it */
    w->air = (flow){.wave = {0.02, 0}, .rate = {5, 0}, .linear = -0.1, .cubic = 1};
    return add_beam(w, SPAR_ROOT_FIXED, o, two, 60, 1e-3);
}

static int rod(world *w) {
    const double g[3] = {0, 0, -9.81};
    w->air = (flow){.linear = 0.05};
    TRY(spar_session_set_gravity(w->s, g));
    TRY(add_beam(w, SPAR_ROOT_FREE, o, one, 100, 1e-3));
    return tie(w, "hinge", 0, -1, SPAR_FREE_RY);
}

static int buoy(world *w) {
    w->air = (flow){.wave = {30, 10}, .rate = {1.1, 1.7}, .linear = 20, .spring = 400};
    return add_body(w, 100);
}

static int wing(world *w) {
    w->air = (flow){.wave = {0.3, 0}, .rate = {1.5, 0}, .linear = 0.6};
    const double tip[3] = {4, 0, 0};
    return add_beam(w, SPAR_ROOT_FIXED, o, tip, 60, 0);
}

static int portal(world *w) {
    const double up[3] = {0, 1.5, 0}, over[3] = {1.5, 1.5, 0}, down[3] = {1.5, 0, 0};
    w->air = (flow){.wave = {0.2, 0}, .rate = {3, 0}, .linear = 0.1};
    TRY(add_beam(w, SPAR_ROOT_FIXED, o, up, 60, 1e-3));
    TRY(add_beam(w, SPAR_ROOT_FREE, up, over, 60, 1e-3));
    TRY(add_beam(w, SPAR_ROOT_FREE, over, down, 60, 1e-3));
    TRY(tie(w, "corner", 1, 0, 0));
    return tie(w, "other corner", 2, 1, 0);
}

static int cylinder(world *w) {
    w->air = (flow){.wave = {0.1, 0}, .rate = {3, 0}, .linear = -0.3, .cubic = 3, .spring = 16};
    return add_body(w, 1);
}

static int shaft(world *w) {
    const double g[3] = {0, 0, -9.81};
    w->spin = 6;
    w->air = (flow){.linear = 0.2};
    TRY(spar_session_set_gravity(w->s, g));
    return add_beam(w, SPAR_ROOT_DRIVEN, o, two, 200, 1e-3);
}

static int chain(world *w) {
    const double g[3] = {0, 0, -9.81};
    w->air = (flow){.linear = 0.1};
    TRY(spar_session_set_gravity(w->s, g));
    for (int k = 0; k < 3; k++) {
        const double a[3] = {0.5 * k, 0, 0}, b[3] = {0.5 * (k + 1), 0, 0};
        char name[16];
        (void)snprintf(name, sizeof name, "hinge%d", k);
        TRY(add_beam(w, SPAR_ROOT_FREE, a, b, 100, 1e-3));
        TRY(tie(w, name, k, k - 1, SPAR_FREE_RY));
    }
    return SPAR_OK;
}

static int pair(world *w) {
    const double a[3] = {0, 0, 1}, b[3] = {2, 0, 1};
    spar_joint *line;
    int64_t n;
    w->air = (flow){.wave = {0.1, 0.05}, .rate = {2.5, 4}, .number = 1, .linear = 0.1};
    TRY(add_beam(w, SPAR_ROOT_FIXED, o, two, 120, 0));
    TRY(add_beam(w, SPAR_ROOT_FIXED, a, b, 60, 0));
    TRY(spar_member_get_count(w->m[0], &n));
    TRY(spar_line_create(w->s, "spring", w->m[0], n - 1, two, w->m[1], n - 1, b, &line));
    return spar_line_set_spring(line, 20, 0.5, 1, 0);
}

static const struct {
    const char *name;
    int (*build)(world *w);
    double dt;
    int64_t steps;
    double tolerance[2];
} scenes[] = {{"pile", pile, 0.02, 304, {3e-2, 1e-2}},     {"sea", sea, 0.02, 400, {3e-2, 1e-2}},
              {"riser", riser, 0.02, 304, {3e-2, 1e-2}},   {"rod", rod, 0.01, 400, {3e-2, 1e-2}},
              {"buoy", buoy, 0.1, 160, {3e-2, 1e-2}},      {"wing", wing, 0.02, 432, {3e-2, 1e-2}},
              {"portal", portal, 0.02, 216, {3e-2, 1e-2}}, {"cylinder", cylinder, 0.05, 128, {3e-2, 1e-2}},
              {"shaft", shaft, 0.02, 160, {3e-2, 1e-2}},   {"chain", chain, 0.01, 320, {1e-1, 3e-2}},
              {"pair", pair, 0.02, 256, {3e-2, 1e-2}}};
enum { SCENES = sizeof scenes / sizeof *scenes };

/* ---- runs ---- */

static int create(int k, int nodes, world *w) {
    *w = (world){.nodes = nodes};
    TRY(spar_session_create(&w->s));
    return scenes[k].build(w);
}

/* Ends of the members. */
static int look(const world *w, double *out) {
    double q[7 * 64];
    for (int k = 0; k < w->members; k++) {
        int64_t n;
        TRY(spar_member_get_count(w->m[k], &n));
        TRY(spar_member_get_motion(w->m[k], q, NULL, NULL));
        memcpy(out + 3 * k, q + 7 * (n - 1), 3 * sizeof *out);
    }
    return SPAR_OK;
}

static int step(world *w, double t, double dt) {
    TRY(spin(w->s, t, dt, w));
    return spar_step(w->s, dt, blow, w, NULL);
}

/* A run of `finer` steps to each of the host's, what it comes to at every FINER-th part of those; from the second on it
   goes to where that and the one before of half the steps point, of order 2. truth [steps + 1][3 MEMBERS] */
static int converge(int k, int finer, double *truth) {
    world w;
    double dt = scenes[k].dt / finer, now[3 * MEMBERS];
    const int each = finer / FINER;
    int status = create(k, 10, &w);
    status = status ? status : spar_session_set_coupling(w.s, SPAR_COUPLING_IQN_ILS, 1e-12, 1e-7, 50);
    status = status ? status : spar_session_set_newton(w.s, 1e-14, 1e-9, 50);
    status = status ? status : look(&w, truth);
    for (int64_t i = 1; i <= TIMES * finer * scenes[k].steps && !status; i++) {
        double *x = truth + 3 * MEMBERS * (i / each);
        status = step(&w, (double)(i - 1) * dt, dt);
        status = status ? status : look(&w, now);
        for (int c = 0; c < 3 * w.members && i % each == 0; c++) {
            x[c] = each == 1 ? now[c] : now[c] + (now[c] - x[c]) / 3;
        }
    }
    spar_session_destroy(&w.s);
    return status;
}

/* Root of the mean square of the error over that of the motion from where it began, at the ends of steps. */
static int march(world *w, int k, double dt, const double *truth, double *error) {
    double d = 0, size = 0, end = TIMES * scenes[k].dt * (double)scenes[k].steps, now[3 * MEMBERS];
    for (int64_t i = 1; (double)i * dt <= end * (1 + 1e-9); i++) {
        TRY(step(w, (double)(i - 1) * dt, dt));
        TRY(look(w, now));
        double at = (double)i * dt / scenes[k].dt * FINER, most = (double)(TIMES * FINER * scenes[k].steps);
        int64_t low = (int64_t)fmin(at, most - 1);
        for (int c = 0; c < 3 * w->members; c++) {
            const double *x = truth + 3 * MEMBERS * low + c;
            double exact = x[0] + (at - (double)low) * (x[3 * MEMBERS] - x[0]);
            d += (now[c] - exact) * (now[c] - exact), size += (exact - truth[c]) * (exact - truth[c]);
        }
    }
    *error = sqrt(d / size);
    return SPAR_OK;
}

static int verbose;

static void show(const spar_session *s, int level, const char *text, void *context) {
    (void)s, (void)context;
    if (verbose || level < SPAR_LOG_INFO) {
        fprintf(stderr, "%s\n", text);
    }
}

static int check(int k, double tolerance, const double *truth) {
    world w;
    double advice[SPAR_ADVICE_COUNT], dt, error = INFINITY, T = scenes[k].dt * (double)scenes[k].steps;
    int status = create(k, 8, &w);
    status = status ? status : spar_session_set_log(w.s, show, NULL);
    status = status ? status
                    : spar_session_advise(w.s, tolerance, scenes[k].dt, scenes[k].steps, TIMES * T, spin, blow, &w,
                                          SPAR_ADVICE_COUNT, advice);
    if (status) {
        printf("%-9s %-7.3g refused: %s\n", scenes[k].name, tolerance, spar_session_message(w.s));
        spar_session_destroy(&w.s);
        return 0;
    }
    status = spar_session_apply_advice(w.s, &dt);
    status = status ? status : march(&w, k, dt, truth, &error);
    double asking = advice[SPAR_ADVICE_WORK], showing = advice[SPAR_ADVICE_SHOWING], cost = advice[SPAR_ADVICE_COST];
    int keeps = advice[SPAR_ADVICE_PRESENT_ERROR] <= 0.9 * tolerance;
    printf("%-9s %-7.3g %9.2e %9.2e %8.4g %5.0f %5.0f %7.3f %7.1f %7.1f %7.1f %7.1f %7.1f %s\n", scenes[k].name,
           tolerance, advice[SPAR_ADVICE_ERROR], error, dt, advice[SPAR_ADVICE_TRIALS], advice[SPAR_ADVICE_SKIPPED],
           cost, asking, keeps ? TIMES * (1 - cost) : NAN, showing, asking - showing, advice[SPAR_ADVICE_SAVES],
           status               ? spar_session_message(w.s)
           : error <= tolerance ? ""
                                : "NOT KEPT");
    fflush(stdout);
    spar_session_destroy(&w.s);
    return !(error <= tolerance);
}

/* What the command line says; `scales` of the tolerances. */
typedef struct request {
    const char *only;
    double scale[8];
    int scales;
} request;

static int read_arguments(int argc, char **argv, request *r) {
    enum { MOST = sizeof r->scale / sizeof *r->scale };
    for (int i = 1; i < argc; i++) {
        if (strcmp(argv[i], "--verbose") == 0) {
            verbose = 1;
        } else if (strcmp(argv[i], "--scene") == 0 && i + 1 < argc) {
            r->only = argv[++i];
        } else if (strcmp(argv[i], "--scale") == 0 && i + 1 < argc && r->scales < MOST) {
            r->scale[r->scales++] = strtod(argv[++i], NULL);
        } else {
            (void)fprintf(stderr, "kept [--scene name] [--scale factor ...] [--verbose]\n");
            return 0;
        }
    }
    if (r->scales == 0) {
        r->scale[r->scales++] = 1;
    }
    return 1;
}

int main(int argc, char **argv) {
    request r = {0};
    int failed = 0;
    if (!read_arguments(argc, argv, &r)) {
        return 2;
    }
    printf("scene     tolerance   said      real       dt  runs  left    cost   asking   saves  showing  finding   "
           "brings  "
           "(in trials as it was)\n");
    for (int k = 0; k < SCENES; k++) {
        if (r.only && strcmp(r.only, scenes[k].name) != 0) {
            continue;
        }
        double *truth = malloc((size_t)(3 * MEMBERS * (TIMES * FINER * scenes[k].steps + 1)) * sizeof *truth);
        if (!truth || converge(k, FINER, truth) != SPAR_OK || converge(k, 2 * FINER, truth) != SPAR_OK) {
            printf("%s: no reference\n", scenes[k].name);
            failed++;
        }
        for (int t = 0; t < 2 * r.scales && truth; t++) {
            failed += check(k, r.scale[t / 2] * scenes[k].tolerance[t % 2], truth);
        }
        free(truth);
    }
    return failed > 0;
}
