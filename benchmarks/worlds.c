#include "worlds.h"
#include "try.h"

#include <math.h>
#include <spar/spar.h>
#include <spar/spar_structure.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

/* -1 .. 1 */
static double noise_of(uint32_t n) {
    n = (n ^ 61) ^ (n >> 16);
    n *= 9;
    n ^= n >> 4;
    n *= UINT32_C(0x27d4eb2d);
    n ^= n >> 15;
    return n / 2147483648.0 - 1;
}

/* Loads that depend on the time alone. */
static double load_of_time(const flow *a, double t, double x) {
    double at = a->number * x, sum = a->wave[0] * sin(a->rate[0] * t - at) + a->wave[1] * sin(a->rate[1] * t);
    if (t > a->from && t <= a->until) {
        sum += a->kick * (a->smooth ? 0.5 * (1 - cos(2 * pi * (t - a->from) / (a->until - a->from))) : 1);
    }
    return sum + a->rough * noise_of((uint32_t)(t / 0.05 + 1e-6)) + a->hiss * noise_of((uint32_t)(1e6 * t + 0.5));
}

int world_solve(spar_session *s, double t, double dt, int iteration, void *context) {
    world *w = context;
    double force[3 * WORLD_NODES];
    (void)s;
    for (int k = 0; k < w->members; k++) {
        const flow *a = &w->air;
        double v[3 * WORLD_NODES], acceleration[3 * WORLD_NODES];
        TRY(spar_fluid_pull_motion(w->f[k], 1, w->x[k], w->v[k]));
        memset(acceleration, 0, sizeof acceleration);
        if (a->added > 0) {
            TRY(spar_fluid_pull_poses(w->f[k], SPAR_NODES_MOTION, 1, NULL, NULL, v, NULL, acceleration, NULL));
        }
        memset(force, 0, sizeof force);
        for (int64_t i = 0; i < w->n[k]; i++) {
            double u = w->v[k][3 * i + 2], spring = a->spring * (1 + a->modulation * cos(a->pace * (t + dt)));
            force[3 * i + 2] =
                load_of_time(a, t + dt, w->rest[k][3 * i]) - u * (a->linear + a->square * fabs(u) + a->cubic * u * u) -
                spring * (w->x[k][3 * i + 2] - w->rest[k][3 * i + 2]) - a->added * acceleration[3 * i + 2] +
                a->noise * noise_of((uint32_t)(1000 * iteration + i) + (uint32_t)(1e4 * t));
        }
        TRY(spar_fluid_push_forces(w->f[k], force, NULL));
    }
    return SPAR_OK;
}

int world_before(spar_session *s, double t, double dt, void *context) {
    world *w = context;
    double end = t + dt, rises = w->rises, part = end < rises ? 0.5 * end * end / rises : end - 0.5 * rises,
           half = 0.5 * w->spin * part;
    const double q[7] = {0, 0, 0, cos(half), sin(half), 0, 0},
                 v[6] = {0, 0, 0, end < rises ? w->spin * end / rises : w->spin, 0, 0},
                 a[6] = {0, 0, 0, end < rises ? w->spin / rises : 0, 0, 0};
    (void)s;
    return w->spin > 0 ? spar_member_drive(w->m[0], q, v, a) : SPAR_OK;
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
    double K[36], M[36], x[3 * WORLD_NODES], mu[6];
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
    if (w->fading > 0) {
        TRY(spar_beam_set_mass_damping(*m, w->fading));
    }
    TRY(spar_member_commit(*m));
    for (int i = 0; i < WORLD_NODES; i++) {
        for (int c = 0; c < 3; c++) {
            x[3 * i + c] = a[c] + (b[c] - a[c]) * (i + 0.5) / WORLD_NODES;
        }
    }
    return add_fluid(w, WORLD_NODES, x);
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
    TRY(spar_link_create(w->s, "spring", w->m[0], n - 1, two, w->m[1], n - 1, b, &line));
    return spar_link_set_spring(line, 20, 0.5, 1, 0);
}

/* ---- impulses, parametric excitation, noise, limit cycles, added mass ---- */

static int kick(world *w) {
    w->air = (flow){.spring = 16, .kick = 10, .from = 0.4013, .until = 0.4313};
    return add_body(w, 1);
}

static int knock(world *w) {
    w->air = (flow){.linear = 0.1, .kick = 2, .from = 0.3007, .until = 0.3207};
    return add_beam(w, SPAR_ROOT_FIXED, o, two, 120, 1e-3);
}

static int gust(world *w) {
    w->air = (flow){.linear = 0.3, .kick = 0.5, .from = 1, .until = 1.5, .smooth = 1};
    return add_beam(w, SPAR_ROOT_FIXED, o, two, 60, 0);
}

static int mathieu(world *w) {
    w->air = (flow){.spring = 16, .modulation = 0.3, .pace = 8, .linear = 0.1, .cubic = 1, .kick = 2, .until = 0.2013};
    return add_body(w, 1);
}

static int swing(world *w) {
    w->air =
        (flow){.spring = 6, .modulation = 0.6, .pace = 9, .linear = 0.02, .cubic = 0.5, .kick = 0.1, .until = 0.3013};
    return add_beam(w, SPAR_ROOT_FIXED, o, two, 20, 1e-3);
}

static int grid(world *w) { /* a fluid that is solved to a few digits */
    w->air = (flow){.wave = {0.1, 0}, .rate = {2.1, 0}, .number = 0.3, .linear = 0.2, .noise = 3e-5};
    TRY(spar_session_set_coupling(w->s, SPAR_COUPLING_IQN_ILS, 1e-9, 1e-2, 50));
    return add_beam(w, SPAR_ROOT_FIXED, o, two, 120, 1e-3);
}

static int storm(world *w) { /* white noise in time: no dt resolves it */
    w->air = (flow){.wave = {0.1, 0}, .rate = {2.1, 0}, .number = 0.3, .linear = 0.1, .hiss = 0.5};
    return add_beam(w, SPAR_ROOT_FIXED, o, two, 120, 1e-3);
}

static int road(world *w) {
    w->air = (flow){.spring = 400, .linear = 20, .rough = 100};
    return add_body(w, 100);
}

static int spinup(world *w) {
    const double g[3] = {0, 0, -9.81};
    w->spin = 6, w->rises = 40;
    w->air = (flow){.linear = 0.2};
    TRY(spar_session_set_gravity(w->s, g));
    return add_beam(w, SPAR_ROOT_DRIVEN, o, two, 200, 1e-3);
}

static int arms(world *w) { /* stiff and light, in a heavy fluid */
    const double end[3] = {0.5, 0, 0};
    w->air = (flow){.wave = {0.2, 0}, .rate = {3, 0}, .linear = 0.2, .spring = 2, .added = 3 * 0.5 / WORLD_NODES};
    TRY(add_beam(w, SPAR_ROOT_FREE, o, end, 1000, 1e-4));
    TRY(tie(w, "hinge0", 0, -1, SPAR_FREE_RY));
    TRY(add_beam(w, SPAR_ROOT_FREE, end, one, 1000, 1e-4));
    return tie(w, "hinge1", 1, 0, SPAR_FREE_RY);
}

static int mast(world *w) { /* with an arm on a hinge */
    const double out[3] = {2.8, 0, 0}, g[3] = {9.81, 0, 0};
    w->air = (flow){.wave = {0.2, 0.1}, .rate = {2, 3.1}, .linear = 0.1};
    TRY(spar_session_set_gravity(w->s, g));
    TRY(add_beam(w, SPAR_ROOT_FIXED, o, two, 200, 1e-3));
    TRY(add_beam(w, SPAR_ROOT_FREE, two, out, 200, 1e-3));
    return tie(w, "hinge", 1, 0, SPAR_FREE_RY);
}

static int reed(world *w) { /* stronger than sinusoidal */
    w->air = (flow){.spring = 4, .linear = -1.5, .cubic = 1.5, .kick = 1, .until = 0.3013};
    return add_body(w, 1);
}

static int years(world *w) { /* forty times the trials */
    w->air = (flow){.wave = {0.1, 0.05}, .rate = {2.1, 2.9}, .number = 0.3, .linear = 0.15};
    return add_beam(w, SPAR_ROOT_FIXED, o, two, 120, 1e-3);
}

const world_scene worlds[WORLD_COUNT] = {
    {"pile", pile, 0.02, 304, {3e-2, 1e-2}, 10},       {"sea", sea, 0.02, 400, {3e-2, 1e-2}, 10},
    {"riser", riser, 0.02, 304, {3e-2, 1e-2}, 10},     {"rod", rod, 0.01, 400, {3e-2, 1e-2}, 10},
    {"buoy", buoy, 0.1, 160, {3e-2, 1e-2}, 10},        {"wing", wing, 0.02, 432, {3e-2, 1e-2}, 10},
    {"portal", portal, 0.02, 216, {3e-2, 1e-2}, 10},   {"cylinder", cylinder, 0.05, 128, {3e-2, 1e-2}, 10},
    {"shaft", shaft, 0.02, 160, {3e-2, 1e-2}, 10},     {"chain", chain, 0.01, 320, {1e-1, 3e-2}, 10},
    {"pair", pair, 0.02, 256, {3e-2, 1e-2}, 10},       {"kick", kick, 0.02, 400, {3e-2, 1e-2}, 10},
    {"knock", knock, 0.01, 400, {3e-2, 1e-2}, 10},     {"gust", gust, 0.02, 400, {3e-2, 1e-2}, 10},
    {"mathieu", mathieu, 0.02, 800, {3e-2, 1e-2}, 10}, {"swing", swing, 0.02, 600, {3e-2, 1e-2}, 10},
    {"grid", grid, 0.02, 304, {3e-2, 1e-2}, 10},       {"storm", storm, 0.02, 304, {3e-2, 1e-2}, 10},
    {"road", road, 0.05, 320, {3e-2, 1e-2}, 10},       {"spinup", spinup, 0.02, 160, {3e-2, 1e-2}, 10},
    {"arms", arms, 0.02, 200, {3e-2, 1e-2}, 10},       {"mast", mast, 0.02, 256, {3e-2, 1e-2}, 10},
    {"reed", reed, 0.05, 400, {3e-2, 1e-2}, 10},       {"years", years, 0.02, 304, {3e-2, 1e-2}, 40}};

int world_create(int k, int nodes, double fading, world *w) {
    *w = (world){.nodes = nodes, .fading = fading};
    TRY(spar_session_create(&w->s));
    return worlds[k].build(w);
}

int world_step(world *w, double t, double dt) {
    TRY(world_before(w->s, t, dt, w));
    return spar_step(w->s, dt, world_solve, w, NULL);
}
