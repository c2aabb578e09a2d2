/* What it costs to map fluid nodes, to move them and to gather their loads.

     transfer [largest [smallest]]
                            nodes per second over n = smallest (10^3) .. largest (10^7) and P = 4, 6, 10, 16, beside the
                            plain loop over stored weights (library flags; -O3 -march=native) and the time that the
                            bytes alone would take
     transfer single [n]    n (10^6) nodes of a host with single precision beside one with double, and what the bytes
                            of either would allow
     transfer point [n]     n (10^6) nodes on a point, a rigid body, and a prescribed and a rigid beam of ten nodes,
                            beside the plain loop of a rigid transfer
     transfer projection    microseconds and errors of the nearest point: bounds, RPOLY, GSL's companion matrix

   Times are the least of several runs: the machine may be shared. One core. */
#include "math/basis.h"
#include "plain.h"
#include "transfer/projection.h"
#include <gsl/gsl_errno.h>
#include <gsl/gsl_poly.h>
#include <math.h>
#include <spar/spar.h>
#include <spar/spar_coupling.h>
#include <spar/spar_structure.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void must(const spar_session *session, int status, const char *what) {
    if (status != SPAR_OK) {
        fprintf(stderr, "transfer: %s: %s\n", what, spar_session_message(session));
        exit(1);
    }
}
#define MUST(session, call) must(session, call, #call)

static double *room(int64_t n) {
    double *x = malloc(sizeof *x * (size_t)(n > 0 ? n : 1));
    if (!x) {
        fprintf(stderr, "transfer: no memory for %lld numbers\n", (long long)n);
        exit(1);
    }
    memset(x, 0, sizeof *x * (size_t)n); /* the pages are there before the clock runs */
    return x;
}

/* ---- the transfer ---- */

typedef struct scene {
    spar_session *session;
    spar_member *blade;
    int p;
    int64_t n;
    double *node, *a, *b, *force; /* [n][3] */
    double xr[24 * 3], q[24 * 7], v[24 * 6];
    plain_map plain;
    spar_fluid *motion, *loads;
    double map_seconds;
} scene;

/* A blade of 60 m, bent and turning, and the nodes of its skin in rings from root to tip. */
static void make(scene *s, int p, int64_t n) {
    double eta[21], xyz[63];
    memset(s, 0, sizeof *s);
    s->p = p, s->n = n;
    MUST(s->session, spar_session_create(&s->session));
    MUST(s->session, spar_beam_create(s->session, "blade", 1, p, &s->blade));
    for (int i = 0; i < 21; i++) {
        eta[i] = 0.05 * i;
        xyz[3 * i] = 60 * eta[i], xyz[3 * i + 1] = -3 * pow(eta[i], 3), xyz[3 * i + 2] = 2 * eta[i] * eta[i];
    }
    MUST(s->session, spar_beam_set_axis(s->blade, 21, eta, xyz, NULL));
    MUST(s->session, spar_member_set_external(s->blade, 1));
    MUST(s->session, spar_member_commit(s->blade));
    MUST(s->session, spar_member_get_reference(s->blade, s->xr, NULL));
    for (int l = 0; l < p; l++) {
        double t = s->xr[3 * l] / 60, half = 0.5 + 0.2 * t;
        double q[7] = {0.1 * t, 2 * t, 6 * t * t, cos(half), sin(half) * 0.6, sin(half) * 0.8, 0};
        double v[6] = {1, 2 * t, 3 * t * t, 0.1, 0.2 * t, 1.2};
        memcpy(s->q + 7 * l, q, sizeof q);
        memcpy(s->v + 6 * l, v, sizeof v);
    }
    MUST(s->session, spar_member_set_motion(s->blade, s->q, s->v, NULL));
    s->node = room(3 * n), s->a = room(3 * n), s->b = room(3 * n), s->force = room(3 * n);
    for (int64_t j = 0; j < n; j++) {
        double t = (double)(j / 100) / (double)((n + 99) / 100), turn = 0.0628 * (double)(j % 100);
        s->node[3 * j] = 60 * t;
        s->node[3 * j + 1] = -3 * pow(t, 3) + (2 - 1.5 * t) * cos(turn);
        s->node[3 * j + 2] = 2 * t * t + (0.4 - 0.3 * t) * sin(turn);
        s->force[3 * j] = 1, s->force[3 * j + 1] = cos(turn), s->force[3 * j + 2] = t;
    }
}

static void map(scene *s) {
    MUST(s->session, spar_fluid_create(s->blade, "moved", &s->motion));
    MUST(s->session, spar_fluid_create(s->blade, "loaded", &s->loads));
    MUST(s->session, spar_fluid_set_motion_nodes(s->motion, s->n, s->node));
    double t = now();
    MUST(s->session, spar_fluid_map(s->motion));
    s->map_seconds = now() - t;
    MUST(s->session, spar_fluid_set_force_nodes(s->loads, s->n, s->node));
    MUST(s->session, spar_fluid_map(s->loads));
    double *weight = room(s->n * s->p);
    MUST(s->session, spar_fluid_get_basis(s->motion, SPAR_NODES_MOTION, NULL, weight));
    MUST(s->session,
         spar_fluid_get_nearest(s->motion, SPAR_NODES_MOTION, NULL, NULL, s->node)); /* arms take the places' place */
    s->plain = (plain_map){s->n, s->p, weight, s->node, s->xr, s->q, s->v};
}

static void unmake(scene *s) {
    free((void *)(uintptr_t)s->plain.weight);
    free(s->node);
    free(s->a);
    free(s->b);
    free(s->force);
    spar_session_destroy(&s->session);
}

typedef void (*work)(scene *s);

static void pull(scene *s) {
    MUST(s->session, spar_fluid_pull_motion(s->motion, 1, s->a, s->b));
}

static void push(scene *s) {
    MUST(s->session, spar_fluid_push_forces(s->loads, s->force, NULL));
}

static void pull_native(scene *s) {
    plain_motion_native(&s->plain, s->a, s->b);
}

static void pull_portable(scene *s) {
    plain_motion_portable(&s->plain, s->a, s->b);
}

static void push_native(scene *s) {
    double load[24 * 6];
    plain_loads_native(&s->plain, s->force, load);
    s->a[0] = load[0];
}

static void push_portable(scene *s) {
    double load[24 * 6];
    plain_loads_portable(&s->plain, s->force, load);
    s->a[0] = load[0];
}

/* What a pull must move: 32 bytes a node in, 48 out; a push: 56 in. Copied, half of the bytes each way. */
static void copy_as_pull(scene *s) {
    memcpy(s->a, s->node, (size_t)s->n * 24);
    memcpy(s->b, s->force, (size_t)s->n * 16);
}

static void copy_as_push(scene *s) {
    memcpy(s->a, s->node, (size_t)s->n * 24);
    memcpy(s->b, s->force, (size_t)s->n * 4);
}

/* Million nodes a second: the best of `runs` runs that last about 20 ms each. */
static double rate(scene *s, work w) {
    w(s);
    double best = HUGE_VAL;
    int64_t repeats = 1 + 600000 / s->n;
    for (int run = 0; run < 5; run++) {
        double t = now();
        for (int64_t k = 0; k < repeats; k++) {
            w(s);
        }
        best = fmin(best, (now() - t) / (double)repeats);
    }
    return (double)s->n / best * 1e-6;
}

/* The plain loop and the library agree, or the comparison is worth nothing. */
static void compare(scene *s) {
    double most = 0, *x = room(3 * s->n), *v = room(3 * s->n);
    pull(s);
    plain_motion_native(&s->plain, x, v);
    for (int64_t i = 0; i < 3 * s->n; i++) {
        most = fmax(most, fmax(fabs(x[i] - s->a[i]), fabs(v[i] - s->b[i])));
    }
    free(x);
    free(v);
    if (!(most < 1e-11)) {
        fprintf(stderr, "transfer: the plain loop differs by %g\n", most);
        exit(1);
    }
}

/* Force, moment and power have passed the map, or the speed is worth nothing. */
static void check_audit(scene *s) {
    double audit[SPAR_AUDIT_COUNT];
    MUST(s->session, spar_fluid_get_audit(s->loads, SPAR_AUDIT_COUNT, audit));
    if (!(audit[SPAR_AUDIT_FORCE_ERROR] < 1e-13 && audit[SPAR_AUDIT_MOMENT_ERROR] < 1e-13 &&
          audit[SPAR_AUDIT_POWER_ERROR] < 1e-13)) {
        fprintf(stderr, "transfer: lost on the way: %g of the force, %g of the moment, %g of the power\n",
                audit[SPAR_AUDIT_FORCE_ERROR], audit[SPAR_AUDIT_MOMENT_ERROR], audit[SPAR_AUDIT_POWER_ERROR]);
        exit(1);
    }
}

static void table(int64_t largest, int64_t smallest) {
    static const int order[] = {4, 6, 10, 16};
    printf("Million nodes a second on one core; state: 33 bytes a node (39 with several elements). audited: loads in "
           "with the\n"
           "figures of spar_fluid_get_audit. bytes: what the copy speed allows for the bytes moved at this size.\n\n"
           "| P | n | map | motion out | native loop | portable loop | gain | gain | bytes | loads in | audited | "
           "native loop | "
           "portable loop | gain | gain | bytes |\n"
           "|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n");
    for (int k = 0; k < 4; k++) {
        for (int64_t n = smallest; n <= largest; n *= 10) {
            scene s;
            make(&s, order[k], n);
            map(&s);
            compare(&s);
            double out = rate(&s, pull), on = rate(&s, pull_native), op = rate(&s, pull_portable),
                   ob = rate(&s, copy_as_pull);
            double audited = rate(&s, push);
            check_audit(&s);
            MUST(s.session, spar_fluid_set_option(s.loads, "audit", "off"));
            double in = rate(&s, push), in_n = rate(&s, push_native), ip = rate(&s, push_portable),
                   ib = rate(&s, copy_as_push);
            printf("| %d | %lld | %.1f | %.0f | %.0f | %.1f | %.1f | %.1f | %.0f | %.0f | %.0f | %.0f | %.1f | %.1f | "
                   "%.1f | %.0f |\n",
                   s.p, (long long)n, (double)n / s.map_seconds * 1e-6, out, on, op, out / on, out / op, ob, in,
                   audited, in_n, ip, in / in_n, in / ip, ib);
            fflush(stdout);
            unmake(&s);
        }
    }
}

/* ---- single precision ---- */

static void pull_single(scene *s) {
    MUST(s->session, spar_fluid_pull_motion_f32(s->motion, 1, (float *)(void *)s->a, (float *)(void *)s->b));
}

static void push_single(scene *s) {
    MUST(s->session, spar_fluid_push_forces_f32(s->loads, (const float *)(const void *)s->b, NULL));
}

/* Of 32 bytes a node in and 24 out; of 44 in. */
static void copy_as_pull_single(scene *s) {
    memcpy(s->a, s->node, (size_t)s->n * 24);
    memcpy(s->b, s->force, (size_t)s->n * 4);
}

static void copy_as_push_single(scene *s) {
    memcpy(s->a, s->node, (size_t)s->n * 22);
}

static void single(int64_t n) {
    static const int order[] = {4, 6, 10, 16};
    printf(
        "Million nodes a second on one core, %lld nodes; f32: the host's arrays are single, what is computed is not.\n"
        "bytes: what the copy speed allows for the bytes moved.\n\n"
        "| P | out | bytes | f32 | bytes | gain | in | audited | bytes | f32 | audited | bytes | gain | gain |\n"
        "|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n",
        (long long)n);
    for (int k = 0; k < 4; k++) {
        scene s;
        make(&s, order[k], n);
        map(&s);
        double out = rate(&s, pull), out_bytes = rate(&s, copy_as_pull), out1 = rate(&s, pull_single),
               out1_bytes = rate(&s, copy_as_pull_single);
        for (int64_t j = 0; j < 3 * n; j++) { /* the forces, as the host has them */
            ((float *)(void *)s.b)[j] = (float)s.force[j];
        }
        double audited = rate(&s, push), audited1 = rate(&s, push_single);
        check_audit(&s);
        MUST(s.session, spar_fluid_set_option(s.loads, "audit", "off"));
        double in = rate(&s, push), in1 = rate(&s, push_single), in_bytes = rate(&s, copy_as_push),
               in1_bytes = rate(&s, copy_as_push_single);
        printf("| %d | %.0f | %.0f | %.0f | %.0f | %.2f | %.0f | %.0f | %.0f | %.0f | %.0f | %.0f | %.2f | %.2f |\n",
               s.p, out, out_bytes, out1, out1_bytes, out1 / out, in, audited, in_bytes, in1, audited1, in1_bytes,
               in1 / in, audited1 / audited);
        fflush(stdout);
        unmake(&s);
    }
}

/* ---- rigid transfers ---- */

typedef struct rigid_scene {
    spar_session *session;
    spar_fluid *fluid;
    plain_rigid plain;
    double *node, *x, *v, *force;
    double load[6];
} rigid_scene;

static const char *const carriers[] = {"point", "rigid body", "prescribed beam, P = 10", "rigid beam, P = 10"};
enum { CARRIERS = 4 };

static spar_member *make_carrier(spar_session *s, int kind) {
    static const double q[4] = {1, 0, 0, 0}, eta[2] = {0, 1}, xyz[6] = {0, 0, 0, 10, 0, 0};
    spar_member *m;
    double mass[36] = {0}, stiffness[36] = {0};
    for (int i = 0; i < 6; i++) {
        mass[7 * i] = 1, stiffness[7 * i] = 1e6;
    }
    if (kind == 0) {
        MUST(s, spar_point_create(s, "carrier", NULL, q, &m));
    } else if (kind == 1) {
        MUST(s, spar_rigid_create(s, "carrier", NULL, q, mass, &m));
    } else {
        MUST(s, spar_beam_create(s, "carrier", 1, 10, &m));
        MUST(s, spar_beam_set_axis(m, 2, eta, xyz, NULL));
        MUST(s, spar_beam_set_sections(m, 1, eta, stiffness, mass));
        MUST(s, spar_member_set_fidelity(m, kind == 2 ? SPAR_FIDELITY_PRESCRIBED : SPAR_FIDELITY_RIGID, 0));
    }
    MUST(s, spar_member_commit(m));
    return m;
}

static void make_rigid(rigid_scene *s, int kind, int64_t n) {
    memset(s, 0, sizeof *s);
    s->node = room(3 * n), s->x = room(3 * n), s->v = room(3 * n), s->force = room(3 * n);
    for (int64_t j = 0; j < n; j++) {
        double turn = 0.0628 * (double)j;
        s->node[3 * j] = 10 * (double)j / (double)n, s->node[3 * j + 1] = cos(turn), s->node[3 * j + 2] = sin(turn);
        s->force[3 * j] = 1, s->force[3 * j + 1] = cos(turn), s->force[3 * j + 2] = 0.1;
    }
    MUST(s->session, spar_session_create(&s->session));
    MUST(s->session, spar_fluid_create(make_carrier(s->session, kind), "around", &s->fluid));
    MUST(s->session, spar_fluid_set_option(s->fluid, "audit", "off"));
    MUST(s->session, spar_fluid_set_motion_nodes(s->fluid, n, s->node));
    MUST(s->session, spar_fluid_set_force_nodes(s->fluid, n, s->node));
    MUST(s->session, spar_fluid_map(s->fluid));
    s->plain = (plain_rigid){.n = n, .con = s->node, .R = {1, 0, 0, 0, 1, 0, 0, 0, 1}, .omega = {0.1, 0.2, 0.3}};
}

static void rigid_work(rigid_scene *s, int push_in, int by) {
    if (by == 0 && push_in) {
        MUST(s->session, spar_fluid_push_forces(s->fluid, s->force, NULL));
    } else if (by == 0) {
        MUST(s->session, spar_fluid_pull_motion(s->fluid, 1, s->x, s->v));
    } else if (push_in) {
        (by == 1 ? plain_rigid_loads_portable : plain_rigid_loads_native)(&s->plain, s->force, s->load);
    } else {
        (by == 1 ? plain_rigid_motion_portable : plain_rigid_motion_native)(&s->plain, s->x, s->v);
    }
}

/* Seconds of a pull or push by the library, the loop with the library's flags and the loop for this machine, in turns.
 */
static void rigid_seconds(rigid_scene *s, int push_in, double best[3]) {
    best[0] = best[1] = best[2] = HUGE_VAL;
    for (int run = 0; run < 25; run++) {
        for (int by = 0; by < 3; by++) {
            double t = now();
            rigid_work(s, push_in, by);
            best[by] = fmin(best[by], now() - t);
        }
    }
}

static void point(int64_t n) {
    printf(
        "Nanoseconds a node on one core, %lld nodes, and their ratio to the plain loop's with the library's flags and "
        "for this\n"
        "machine. State: 25 bytes a node on one node (its arm and its flags), 33 on a beam.\n\n"
        "| nodes on a | pull | loop | native loop | ratio | ratio | push | loop | native loop | ratio | ratio |\n"
        "|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n",
        (long long)n);
    for (int kind = 0; kind < CARRIERS; kind++) {
        rigid_scene s;
        make_rigid(&s, kind, n);
        printf("| %s |", carriers[kind]);
        for (int push_in = 0; push_in < 2; push_in++) {
            double t[3];
            rigid_seconds(&s, push_in, t);
            for (int by = 0; by < 3; by++) {
                t[by] *= 1e9 / (double)n;
            }
            printf(" %.2f | %.2f | %.2f | %.2f | %.2f |", t[0], t[1], t[2], t[0] / t[1], t[0] / t[2]);
        }
        printf("\n");
        fflush(stdout);
        free(s.node);
        free(s.x);
        free(s.v);
        free(s.force);
        spar_session_destroy(&s.session);
    }
}

/* ---- nearest points ---- */

enum { POINTS = 20000, MOST = 20 };

static double uniform(uint64_t *state) {
    *state ^= *state << 13, *state ^= *state >> 7, *state ^= *state << 17;
    return (double)(*state >> 11) / 4503599627370496.0 - 1.0;
}

/* One element: a curve of the kind, P nodes. */
static void curve(int kind, int p, uint64_t *state, double *x) {
    double gll[MOST];
    spari_gll(p, gll, NULL, NULL);
    for (int l = 0; l < p; l++) {
        double t = 0.5 * (1 + gll[l]);
        double smooth[2][3] = {{60 * t, -3 * t * t * t, 2 * t * t}, {10 * t, 2 * sin(6.28 * t), t * t}};
        for (int i = 0; i < 3; i++) {
            x[3 * l + i] = kind < 2 ? smooth[kind][i] : uniform(state);
        }
    }
}

/* Monomial coefficients of the element's line on [-1,1], by Newton's divided differences. */
static void monomials(int p, const double *x, double (*c)[3]) {
    double gll[MOST], d[MOST][3];
    spari_gll(p, gll, NULL, NULL);
    memcpy(d, x, sizeof *d * (size_t)p);
    for (int k = 1; k < p; k++) {
        for (int j = p - 1; j >= k; j--) {
            for (int i = 0; i < 3; i++) {
                d[j][i] = (d[j][i] - d[j - 1][i]) / (gll[j] - gll[j - k]);
            }
        }
    }
    memset(c, 0, sizeof *c * (size_t)p);
    for (int k = p - 1; k >= 0; k--) {
        for (int i = 0; i < 3; i++) {
            for (int j = p - 1; j > 0; j--) {
                c[j][i] = c[j - 1][i] - gll[k] * c[j][i];
            }
            c[0][i] = d[k][i] - gll[k] * c[0][i];
        }
    }
}

static double distance(const spari_line *line, double xi, const double *p) {
    double r[3], s = 0;
    spari_line_point(line, 0, xi, r, NULL);
    for (int i = 0; i < 3; i++) {
        s += (r[i] - p[i]) * (r[i] - p[i]);
    }
    return sqrt(s);
}

/* Least distance by the eigenvalues of the companion matrix of (r - p) . r' in powers of xi over the whole element. */
static double companion(const spari_line *line, int p, const double (*c)[3], const double *point) {
    double h[2 * MOST] = {0}, z[4 * MOST], best = fmin(distance(line, -1, point), distance(line, 1, point)), most = 0;
    int degree = 2 * p - 3;
    for (int j = 0; j < p; j++) {
        for (int k = 1; k < p; k++) {
            for (int i = 0; i < 3; i++) {
                h[j + k - 1] += k * c[k][i] * (c[j][i] - (j == 0 ? point[i] : 0));
            }
        }
    }
    for (int k = 0; k <= degree; k++) {
        most = fmax(most, fabs(h[k]));
    }
    while (degree > 1 && fabs(h[degree]) < 1e-15 * most) {
        degree--;
    }
    gsl_poly_complex_workspace *w = gsl_poly_complex_workspace_alloc((size_t)degree + 1);
    if (gsl_poly_complex_solve(h, (size_t)degree + 1, w, z) == GSL_SUCCESS) {
        for (int k = 0; k < degree; k++) {
            if (fabs(z[2 * k + 1]) < 1e-3 && fabs(z[2 * k]) <= 1) {
                best = fmin(best, distance(line, z[2 * k], point));
            }
        }
    }
    gsl_poly_complex_workspace_free(w);
    return best;
}

typedef struct outcome {
    double seconds, worst;
    int64_t wrong;
} outcome;

static void note(outcome *o, double found, double right, double scale) {
    double error = (found - right) / scale;
    o->worst = fmax(o->worst, error);
    o->wrong += error > 1e-12;
}

/* The best of the three answers counts as right: each is a distance to a point of the line, so none can be below the
 * least. */
static void try_curve(int kind, int p, outcome o[3]) {
    static double point[POINTS][3], foot[POINTS][3], xi[POINTS], d[3][POINTS];
    static int element[POINTS];
    static uint8_t flags[POINTS];
    uint64_t state = 88172645463325252ull;
    double x[MOST * 3], c[MOST][3], scale = kind == 0 ? 60 : kind == 1 ? 10 : 2;
    curve(kind, p, &state, x);
    monomials(p, x, c);
    spari_line *line = spari_line_create(1, p, x);
    for (int j = 0; j < POINTS; j++) {
        spari_line_point(line, 0, 2.0 * j / POINTS - 1, point[j], NULL);
        for (int i = 0; i < 3; i++) {
            point[j][i] += 0.05 * scale * uniform(&state);
        }
    }
    for (int k = 0; k < 2; k++) {
        double t = now();
        spari_line_project(line, NULL, k ? SPAR_PROJECT_RPOLY : SPAR_PROJECT_BOUNDED, POINTS, point[0], element, xi,
                           foot[0], flags);
        o[k].seconds = now() - t;
        for (int j = 0; j < POINTS; j++) {
            d[k][j] = distance(line, xi[j], point[j]);
        }
    }
    double t = now();
    for (int j = 0; j < POINTS; j++) {
        d[2][j] = companion(line, p, (const double(*)[3])c, point[j]);
    }
    o[2].seconds = now() - t;
    for (int j = 0; j < POINTS; j++) {
        double right = fmin(d[0][j], fmin(d[1][j], d[2][j]));
        for (int k = 0; k < 3; k++) {
            note(&o[k], d[k][j], right, scale);
        }
    }
    spari_line_free(line);
}

static void projection(void) {
    static const char *const name[] = {"blade", "S-curve", "random nodes"};
    gsl_set_error_handler_off();
    printf("Microseconds a point on one core; wrong: points of %d farther than 1e-12 of the line's size from the least "
           "distance,\n"
           "and the worst of them. companion: gsl_poly_complex_solve on the whole element in powers of xi.\n\n"
           "| line | P | bounded | wrong | worst | RPOLY | wrong | worst | companion | wrong | worst |\n"
           "|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n",
           POINTS);
    for (int kind = 0; kind < 3; kind++) {
        for (int p = 4; p <= MOST; p += p < 6 ? 2 : p == 6 ? 4 : 5) {
            outcome o[3] = {{0}};
            try_curve(kind, p, o);
            printf("| %s | %d |", name[kind], p);
            for (int k = 0; k < 3; k++) {
                printf(" %.2f | %lld | %.0e |", o[k].seconds / POINTS * 1e6, (long long)o[k].wrong, o[k].worst);
            }
            printf("\n");
            fflush(stdout);
        }
    }
}

int main(int argc, char **argv) {
    if (argc > 1 && strcmp(argv[1], "projection") == 0) {
        projection();
    } else if (argc > 1 && strcmp(argv[1], "point") == 0) {
        point(argc > 2 ? (int64_t)strtod(argv[2], NULL) : 1000000);
    } else if (argc > 1 && strcmp(argv[1], "single") == 0) {
        single(argc > 2 ? (int64_t)strtod(argv[2], NULL) : 1000000);
    } else {
        table(argc > 1 ? (int64_t)strtod(argv[1], NULL) : 10000000, argc > 2 ? (int64_t)strtod(argv[2], NULL) : 1000);
    }
    return 0;
}
