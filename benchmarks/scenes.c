#include "scenes.h"
#include "try.h"

#include "nrel5mw.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { STRIPS = 12, WING_STRIPS = 16, SECTIONS = 64 };
static const double pi = 3.14159265358979323846;

static int settings(spar_session *s, const knobs *k) {
    TRY(spar_session_set_integrator(s, k->rho, k->substeps));
    TRY(spar_session_set_predictor(s, k->predictor));
    TRY(spar_session_set_coupling(s, k->learn > 0 ? SPAR_COUPLING_IQN_ILS : k->scheme, 0, k->tolerance, 60));
    return k->newton > 0 ? spar_session_set_newton(s, 1e-15, k->newton, 50) : SPAR_OK;
}

static int commit(spar_member *b, const knobs *k) {
    const int every = SPAR_EFFECT_INERTIA | SPAR_EFFECT_GYROSCOPIC | SPAR_EFFECT_GRAVITY | SPAR_EFFECT_DAMPING |
                      SPAR_EFFECT_FLUID_MOMENT | SPAR_EFFECT_FLUID_HISTORY | SPAR_EFFECT_WORK | SPAR_EFFECT_MASSES |
                      SPAR_EFFECT_FOUNDATION | SPAR_EFFECT_PRETENSION;
    if (k->rule >= 0) {
        TRY(spar_beam_set_quadrature(b, k->rule, k->points));
    }
    if (k->effects >= 0) {
        TRY(spar_member_set_effects(b, k->effects, every & ~k->effects));
    }
    TRY(spar_member_set_fidelity(b, k->fidelity, k->modes));
    return spar_member_commit(b);
}

static void diagonal(double *m, double a, double b, double c, double d, double e, double f) {
    const double x[6] = {a, b, c, d, e, f};
    memset(m, 0, 36 * sizeof *m);
    for (int i = 0; i < 6; i++) {
        m[7 * i] = x[i];
    }
}

static int straight_beam(scene_run *r, double length, const double *C, const double *M, double added, int root) {
    const double eta[2] = {0, 1}, xyz[6] = {0, 0, 0, length, 0, 0};
    TRY(spar_beam_create(r->session, "beam", r->knobs.elements, r->knobs.nodes, &r->member));
    TRY(spar_beam_set_axis(r->member, 2, eta, xyz, NULL));
    TRY(spar_beam_set_sections(r->member, 1, eta, C, M));
    TRY(spar_member_set_root(r->member, root));
    if (r->knobs.guess > 0) {
        double A[36];
        diagonal(A, 0, 0, added * r->knobs.guess, 0, 0, 0);
        TRY(spar_member_set_added_mass(r->member, 1, eta, A));
    }
    TRY(spar_member_learn_added_mass(r->member, r->knobs.learn > 0, eta));
    return commit(r->member, &r->knobs);
}

static int create_fluid(scene_run *r, const char *name) {
    TRY(spar_fluid_create(r->member, name, &r->fluid));
    TRY(spar_fluid_set_option(r->fluid, "theta", r->knobs.group ? "group" : "average"));
    return spar_fluid_set_option(r->fluid, "audit", "off");
}

/* The loads of a host in single precision. */
static int push_single(spar_fluid *f, int64_t n, const double *force, const double *moment) {
    float force32[3 * SECTIONS], moment32[3 * SECTIONS];
    for (int64_t i = 0; i < 3 * n; i++) {
        force32[i] = (float)force[i], moment32[i] = moment ? (float)moment[i] : 0;
    }
    return spar_fluid_push_forces_f32(f, force32, moment ? moment32 : NULL);
}

/* ---- blade elements: the blade of a rotor, a wing ---- */

typedef struct air {
    const scene_run *run;
    spar_aero *aero;
    nrel5mw_rotor rotor;
    double density, speed, wind, gust; /* kg/m3, rad/s, m/s */
    int64_t n;                         /* sections */
    double inflow[3 * SECTIONS];
} air;

static nrel5mw turbine;

static void release_air(void *context) {
    air *b = context;
    spar_aero_destroy(&b->aero);
    free(b);
}

static air *take_air(scene_run *r) {
    air *b = calloc(1, sizeof *b);
    if (b) {
        b->run = r;
        r->context = b, r->release = release_air;
    }
    return b;
}

static int solve_air(air *b) {
    double force[3 * SECTIONS], moment[3 * SECTIONS];
    TRY(spar_aero_solve(b->aero, b->density, b->inflow, b->run->knobs.theta));
    if (!b->run->knobs.single) {
        return SPAR_OK;
    }
    TRY(spar_aero_get_loads(b->aero, NULL, force, moment));
    return push_single(b->run->fluid, b->n, force, moment);
}

static int blow(spar_session *s, double t, double dt, int iteration, void *context) {
    air *b = context;
    (void)s, (void)iteration;
    double part = (t + b->run->knobs.theta * dt - 0.5 - 0.1 * b->run->knobs.phase) / 1.5;
    double u = b->wind + (part > 0 && part < 1 ? 0.5 * b->gust * (1 - cos(2 * pi * part)) : 0);
    for (int64_t i = 0; i < b->n; i++) {
        b->inflow[3 * i] = u;
    }
    return solve_air(b);
}

static int turn(spar_session *s, double t, double dt, void *context) {
    air *b = context;
    double q[7], v[6], a[6];
    (void)s;
    nrel5mw_root_motion(&turbine, &b->rotor, 0, b->speed * (t + dt), b->speed, 0, q, v, a);
    return spar_member_drive(b->run->member, q, v, a);
}

static int build_blade(scene_run *r, double gust) {
    const double g[3] = {0, 0, -9.80665};
    double twist[SECTIONS], omega[3];
    air *b = take_air(r);
    if (!b) {
        return SPAR_ERR_MEMORY;
    }
    if (!turbine.aero_n) {
        TRY(nrel5mw_load(&turbine, SPAR_DATA_DIR "/nrel5mw"));
    }
    if (turbine.aero_n > SECTIONS) {
        return SPAR_ERR_UNSUPPORTED;
    }
    nrel5mw_rotor_default(&turbine, &b->rotor);
    b->density = turbine.density, b->speed = 12.1 * pi / 30, b->wind = 11.4 * (1 + 0.03 * r->knobs.phase),
    b->gust = gust, b->n = turbine.aero_n;
    r->solve = blow, r->before = turn;
    TRY(spar_session_set_gravity(r->session, g));
    TRY(nrel5mw_create_blade(&turbine, &b->rotor, r->session, 0, r->knobs.elements, r->knobs.nodes, &r->member));
    TRY(commit(r->member, &r->knobs));
    for (int i = 0; i < 3; i++) {
        omega[i] = b->speed * b->rotor.axis[i];
    }
    TRY(spar_member_set_initial_velocity(r->member, b->rotor.hub, NULL, omega));
    TRY(nrel5mw_create_sections(&turbine, &b->rotor, 0, r->member, &r->fluid, twist));
    TRY(spar_fluid_set_interpolation(r->fluid, r->knobs.consistent));
    TRY(nrel5mw_create_aero(&turbine, &b->rotor, 1, &r->fluid, twist, &b->aero));
    return r->knobs.aero < 0 ? SPAR_OK : spar_aero_set_effects(b->aero, r->knobs.aero);
}

static int build_rotor(scene_run *r) {
    return build_blade(r, 0);
}

static int build_gust(scene_run *r) {
    return build_blade(r, 8);
}

static int glide(spar_session *s, double t, double dt, int iteration, void *context) {
    (void)s, (void)t, (void)dt, (void)iteration;
    return solve_air(context);
}

/* At 25 m/s and 2 degrees, or half a degree more or less */
static int build_wing(scene_run *r) {
    const double alpha[3] = {-0.5, 0, 0.5}, cl[3] = {-pi, 0, pi}, zero[3] = {0}, cd[3] = {0.01, 0.01, 0.01};
    double C[36], M[36], along[WING_STRIPS], offset[3 * WING_STRIPS] = {0};
    double angle = (2 + 0.5 * sin(r->knobs.phase)) * pi / 180;
    spar_polar *polar = NULL;
    air *b = take_air(r);
    if (!b) {
        return SPAR_ERR_MEMORY;
    }
    diagonal(C, 1e7, 1e7, 1e7, 1e4, 2e4, 4e6);
    diagonal(M, 0.75, 0.75, 0.75, 0.1, 0.05, 0.05);
    TRY(straight_beam(r, 16, C, M, 0, SPAR_ROOT_FIXED));
    b->density = 0.0889, b->n = WING_STRIPS;
    r->solve = glide;
    for (int i = 0; i < WING_STRIPS; i++) { /* aerodynamic centre a quarter chord ahead of the elastic axis */
        along[i] = (i + 0.5) / WING_STRIPS;
        offset[3 * i + 1] = -0.25;
        b->inflow[3 * i + 1] = 25 * cos(angle), b->inflow[3 * i + 2] = -25 * sin(angle);
    }
    TRY(create_fluid(r, "strips"));
    TRY(spar_fluid_set_stations(r->fluid, WING_STRIPS, along, offset));
    TRY(spar_fluid_set_interpolation(r->fluid, r->knobs.consistent));
    TRY(spar_fluid_map(r->fluid));
    TRY(spar_aero_create(1, &r->fluid, &b->aero));
    TRY(spar_polar_create(3, alpha, cl, cd, zero, &polar));
    int status = SPAR_OK;
    for (int i = 0; i < WING_STRIPS && status == SPAR_OK; i++) {
        status = spar_aero_set_section(b->aero, i, 1, 0, polar);
    }
    spar_polar_destroy(&polar); /* the sections keep its table */
    TRY(status);
    return spar_aero_set_effects(b->aero, r->knobs.aero < 0 ? SPAR_AERO_DRAG : r->knobs.aero);
}

/* ---- nodes beside a line: a heavy fluid on a plate, waves of load on a body on a spring ---- */

typedef struct strip {
    const scene_run *run;
    double added, spring, damper, load, rate; /* of one node: inertia, stiffness, damping, amplitude, rad/s */
    double x[6 * STRIPS], rest[6 * STRIPS], v[6 * STRIPS], a[6 * STRIPS], old[6 * STRIPS], force[6 * STRIPS];
} strip;

/* Places, velocities, accelerations at theta. */
static int pull(strip *f) {
    const knobs *k = &f->run->knobs;
    spar_fluid *fluid = f->run->fluid;
    float x32[6 * STRIPS], v32[6 * STRIPS], a32[6 * STRIPS];
    if (!k->single) {
        TRY(spar_fluid_pull_motion(fluid, k->theta, f->x, f->v));
        return k->acceleration
                   ? spar_fluid_pull_poses(fluid, SPAR_NODES_MOTION, k->theta, NULL, NULL, NULL, NULL, f->a, NULL)
                   : SPAR_OK;
    }
    TRY(spar_fluid_pull_motion_f32(fluid, k->theta, x32, v32));
    TRY(spar_fluid_pull_poses_f32(fluid, SPAR_NODES_MOTION, k->theta, NULL, NULL, NULL, NULL, a32, NULL));
    for (int i = 0; i < 6 * STRIPS; i++) {
        f->x[i] = (double)x32[i], f->v[i] = (double)v32[i], f->a[i] = (double)a32[i];
    }
    return SPAR_OK;
}

static int press(spar_session *s, double t, double dt, int iteration, void *context) {
    strip *f = context;
    const knobs *k = &f->run->knobs;
    (void)s, (void)iteration;
    TRY(pull(f));
    for (int i = 2; i < 6 * STRIPS; i += 3) {
        double over = k->theta > 0 ? k->theta * dt : dt;
        double gain = k->acceleration ? f->a[i] : over > 0 ? (f->v[i] - f->old[i]) / over : 0;
        f->force[i] = f->load * sin(f->rate * (1 + 0.04 * k->phase) * (t + dt)) - f->added * gain -
                      f->damper * f->v[i] - f->spring * (f->x[i] - f->rest[i]);
    }
    return k->single ? push_single(f->run->fluid, 2 * STRIPS, f->force, NULL)
                     : spar_fluid_push_forces(f->run->fluid, f->force, NULL);
}

/* The velocities the fluid saw last become those at t^n. */
static int keep(spar_session *s, double t, double dt, void *context) {
    strip *f = context;
    (void)s, (void)t, (void)dt;
    return spar_fluid_pull_motion(f->run->fluid, 1, NULL, f->old);
}

static int build_strip(scene_run *r, const strip *of, double length, const double *C, const double *M, int root) {
    strip *f = calloc(1, sizeof *f);
    if (!f) {
        return SPAR_ERR_MEMORY;
    }
    *f = *of;
    f->run = r;
    r->context = f, r->release = free, r->solve = press, r->before = keep;
    TRY(straight_beam(r, length, C, M, 2 * STRIPS * of->added / length, root));
    for (int i = 0; i < 2 * STRIPS; i++) {
        const double x[3] = {length * (0.5 + i % STRIPS) / STRIPS, 0, (i < STRIPS ? 0.02 : -0.02) * length};
        memcpy(f->rest + 3 * i, x, sizeof x);
    }
    TRY(create_fluid(r, "nodes"));
    TRY(spar_fluid_set_motion_nodes(r->fluid, 2 * STRIPS, f->rest));
    TRY(spar_fluid_set_force_nodes(r->fluid, 2 * STRIPS, f->rest));
    TRY(spar_fluid_set_projection(r->fluid, r->knobs.projection, 0));
    TRY(spar_fluid_set_interpolation(r->fluid, r->knobs.consistent));
    return spar_fluid_map(r->fluid);
}

static int build_plate(scene_run *r) {
    double C[36], M[36], per = 1.0 / (2 * STRIPS);
    const strip f = {.added = 10 * per, .damper = 5 * per, .load = 5 * per, .rate = 8};
    diagonal(C, 1e6, 1e5, 1e5, 100, 100, 100);
    diagonal(M, 1, 1, 1, 2e-3, 1e-3, 1e-3);
    return build_strip(r, &f, 1, C, M, SPAR_ROOT_FIXED);
}

static int build_body(scene_run *r) {
    double C[36], M[36], per = 1.0 / (2 * STRIPS);
    const strip f = {.spring = 4000 * per, .damper = 200 * per, .load = 300 * per, .rate = 3};
    diagonal(C, 1e10, 1e10, 1e10, 1e8, 1e8, 1e8);
    diagonal(M, 100, 100, 100, 4, 2, 2);
    return build_strip(r, &f, 2, C, M, SPAR_ROOT_FREE);
}

/* ---- the scenes ---- */

#define STANDARD(dt_, scheme_)                                                                                         \
    {                                                                                                                  \
        .elements = 1, .nodes = 8, .rule = -1, .dt = (dt_), .rho = 0.9, .substeps = 1, .predictor = 1,                 \
        .scheme = (scheme_), .tolerance = 1e-6, .theta = 1, .acceleration = 1, .start = 1, .effects = -1, .aero = -1,  \
        .fidelity = SPAR_FIDELITY_EXACT                                                                                \
    }

const scene scenes[SCENE_COUNT] = {
    {"rotor", 3.2, STANDARD(0.02, SPAR_COUPLING_EXPLICIT), .spins = 1, .build = build_rotor},
    {"gust", 3.2, STANDARD(0.02, SPAR_COUPLING_EXPLICIT), .spins = 1, .build = build_gust},
    {"wing", 4, STANDARD(0.0125, SPAR_COUPLING_EXPLICIT), .build = build_wing},
    {"plate", 2, STANDARD(0.0125, SPAR_COUPLING_IQN_ILS), .nodes = 1, .build = build_plate},
    {"body", 6, STANDARD(0.0125, SPAR_COUPLING_EXPLICIT), .nodes = 1, .floats = 1, .build = build_body}};

int scene_build(const scene *s, const knobs *k, scene_run **run) {
    scene_run *r = *run = calloc(1, sizeof *r);
    if (!r) {
        return SPAR_ERR_MEMORY;
    }
    r->scene = s, r->knobs = *k;
    TRY(spar_session_create(&r->session));
    TRY(settings(r->session, k));
    TRY(s->build(r));
    return k->start ? r->solve(r->session, 0, 0, 0, r->context) : SPAR_OK;
}

void scene_destroy(scene_run **run) {
    scene_run *r = *run;
    if (!r) {
        return;
    }
    if (r->release) {
        r->release(r->context);
    }
    spar_session_destroy(&r->session);
    free(r);
    *run = NULL;
}

void scenes_free(void) {
    nrel5mw_free(&turbine);
    turbine = (nrel5mw){0};
}

double scene_dt(const scene *s, double dt) {
    double between = s->T / SCENE_SAMPLES;
    return between / ceil(between / dt * (1 - 1e-9));
}

static double cpu(void) {
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

int scene_step(scene_run *run, double *seconds, int64_t *iterations) {
    double t, dt = run->knobs.dt;
    int count = 0;
    TRY(spar_session_get_time(run->session, &t, NULL, NULL));
    double since = cpu();
    if (run->before) {
        TRY(run->before(run->session, t, dt, run->context));
    }
    int status = spar_step(run->session, dt, run->solve, run->context, &count);
    *seconds += cpu() - since;
    *iterations += count;
    return status;
}

/* What the structure hands on, or, where nothing holds it, is given. */
static int look(const scene_run *run, double *q, double displacement[3], double load[3]) {
    int64_t n;
    double reaction[6];
    TRY(spar_member_get_count(run->member, &n));
    TRY(spar_member_get_motion(run->member, q, NULL, NULL));
    memcpy(displacement, q + 7 * (n - 1), 3 * sizeof *q);
    if (run->scene->floats) {
        return spar_fluid_sum_loads(run->fluid, (const double[3]){0}, load, NULL);
    }
    TRY(spar_member_get_reaction(run->member, reaction));
    memcpy(load, reaction + 3, 3 * sizeof *load);
    return SPAR_OK;
}

int scene_march(scene_run *run, scene_result *result) {
    double t, T = run->scene->T, dt = run->knobs.dt;
    int64_t n, steps = llround(T / dt);
    *result = (scene_result){.seconds = 0};
    TRY(spar_member_get_count(run->member, &n));
    TRY(spar_session_get_time(run->session, &t, NULL, NULL));
    double *q = malloc((size_t)(7 * n) * sizeof *q);
    if (!q || steps % SCENE_SAMPLES != 0) {
        free(q);
        return q ? SPAR_ERR_ARGUMENT : SPAR_ERR_MEMORY;
    }
    int status = SPAR_OK;
    for (int64_t i = llround(t / dt) + 1; i <= steps && status == SPAR_OK; i++) {
        const knobs *k = &run->knobs;
        if (k->learn > 0 && i == k->learn + 1) {
            TRY(spar_session_set_coupling(run->session, k->scheme, 0, k->tolerance, 60));
        }
        status = scene_step(run, &result->seconds, &result->iterations);
        result->steps += status == SPAR_OK;
        if (i * SCENE_SAMPLES % steps == 0 && status == SPAR_OK) {
            int64_t at = 3 * (i * SCENE_SAMPLES / steps - 1);
            status = look(run, q, result->history + at, result->load + at);
            if (!(fabs(result->history[at + 2]) < 1e3)) {
                status = SPAR_ERR_NUMERIC; /* it has blown up */
            }
        }
    }
    free(q);
    return status;
}

/* ---- errors ---- */

double scene_distance(const double a[3 * SCENE_SAMPLES], const double b[3 * SCENE_SAMPLES]) {
    double sum = 0;
    for (int i = 0; i < 3 * SCENE_SAMPLES; i++) {
        double d = a[i] - (b ? b[i] : 0);
        sum += d * d;
    }
    return sqrt(sum / SCENE_SAMPLES);
}

static int play(const scene *s, const knobs *k, scene_result *result) {
    scene_run *r;
    int status = scene_build(s, k, &r);
    status = status == SPAR_OK ? scene_march(r, result) : status;
    scene_destroy(&r);
    return status;
}

int scene_converge_at(const scene *s, double phase, double refine, int elements, int nodes,
                      scene_reference *reference) {
    knobs fine = s->standard, still;
    scene_result result;
    fine.phase = phase;
    fine.dt = scene_dt(s, s->standard.dt / refine), fine.elements = elements, fine.nodes = nodes;
    fine.scheme = SPAR_COUPLING_IQN_ILS, fine.tolerance = 1e-9, fine.newton = 1e-12;
    TRY(play(s, &fine, &result));
    memcpy(reference->history, result.history, sizeof result.history);
    memcpy(reference->load, result.load, sizeof result.load);
    reference->scale = scene_distance(result.history, NULL);
    reference->load_scale = scene_distance(result.load, NULL);
    if (s->spins) {
        still = s->standard;
        still.phase = phase;
        still.fidelity = SPAR_FIDELITY_PRESCRIBED, still.nodes = nodes;
        TRY(play(s, &still, &result));
        reference->scale = scene_distance(reference->history, result.history);
    }
    return SPAR_OK;
}

int scene_converge(const scene *s, double refine, int elements, int nodes, scene_reference *reference) {
    return scene_converge_at(s, 0, refine, elements, nodes, reference);
}

double scene_error(const scene_reference *reference, const scene_result *result) {
    return scene_distance(result->history, reference->history) / reference->scale;
}

double scene_load_error(const scene_reference *reference, const scene_result *result) {
    return scene_distance(result->load, reference->load) / reference->load_scale;
}
