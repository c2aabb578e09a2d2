/* What accuracy costs: one knob of a scene is turned at a time, the error against a converged reference and the CPU
   time of the steps (the least of several runs) against the scene's default are written as CSV. accuracy [--full]
   [--out folder] Short form: under two minutes. Progress on stderr. */
#include "nrel5mw.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { SAMPLES = 20, STRIPS = 12, WING_STRIPS = 16 };
static const double pi = 3.14159265358979323846;

typedef struct knobs {
    int elements, nodes, rule, points; /* rule -1: default */
    double dt, rho;
    int substeps;
    double newton; /* 0: default */
    int predictor, scheme;
    double tolerance, theta;
    int group, projection, consistent, single; /* single: f32 at the edge */
    int effects;                               /* -1: default */
    int aero;                                  /* -1: default */
    int rung;
    int64_t modes;
} knobs;

typedef struct run {
    const knobs *k;
    double T, time; /* CPU seconds of the steps */
    int64_t iterations;
    double history[SAMPLES][3];
} run;

typedef struct scene {
    const char *name;
    int (*play)(run *r);
    double T;
    knobs standard, reference;
    int spins; /* the error is relative to the deformation beyond the rigid motion */
} scene;

static double cpu(void) {
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

#define TRY(call)                                                                                                      \
    do {                                                                                                               \
        int status_ = (call);                                                                                          \
        if (status_ != SPAR_OK) {                                                                                      \
            return status_;                                                                                            \
        }                                                                                                              \
    } while (0)

static int settings(spar_session *s, const knobs *k) {
    TRY(spar_session_set_integrator(s, k->rho, k->substeps));
    TRY(spar_session_set_predictor(s, k->predictor));
    TRY(spar_session_set_coupling(s, k->scheme, 0, k->tolerance, 60));
    TRY(spar_session_set_option(s, "fluid.theta", k->group ? "group" : "average"));
    TRY(spar_session_set_option(s, "fluid.audit", "off"));
    return k->newton > 0 ? spar_session_set_newton(s, 1e-15, k->newton, 50) : SPAR_OK;
}

static int beam_knobs(spar_member *b, const knobs *k) {
    if (k->rule >= 0) {
        TRY(spar_beam_set_quadrature(b, k->rule, k->points));
    }
    if (k->effects >= 0) {
        TRY(spar_member_set_effects(b, k->effects));
    }
    TRY(spar_member_set_fidelity(b, k->rung, k->modes));
    return spar_member_commit(b);
}

/* Steps of dt to T with the tip kept at SAMPLES even times. */
static int march(spar_session *s, spar_member *b, run *r, int (*before)(run *, double, void *), spar_fluid_solver fluid,
                 void *context) {
    int64_t steps = llround(r->T / r->k->dt), n;
    TRY(spar_member_get_count(b, &n));
    double *q = malloc((size_t)(7 * n) * sizeof *q), since;
    if (!q || steps % SAMPLES != 0) { /* each sample is at the end of a step */
        free(q);
        return q ? SPAR_ERR_ARGUMENT : SPAR_ERR_MEMORY;
    }
    int status = SPAR_OK, sample = 0;
    for (int64_t i = 1; i <= steps && status == SPAR_OK; i++) {
        int iterations = 0;
        status = before ? before(r, (double)i * r->k->dt, context) : SPAR_OK;
        since = cpu();
        status = status == SPAR_OK ? spar_step(s, r->k->dt, fluid, context, &iterations) : status;
        r->time += cpu() - since;
        r->iterations += iterations;
        if (i * SAMPLES % steps == 0 && status == SPAR_OK && sample < SAMPLES) {
            status = spar_member_get_motion(b, q, NULL, NULL);
            memcpy(r->history[sample++], q + 7 * (n - 1), 3 * sizeof *q);
            if (!(fabs(q[7 * (n - 1) + 2]) < 1e3)) {
                status = SPAR_ERR_NUMERIC; /* it has blown up */
            }
        }
    }
    free(q);
    return status;
}

/* ---- one blade of the NREL 5-MW rotor ---- */

static nrel5mw turbine;

typedef struct blade {
    spar_aero *aero;
    spar_member *member;
    nrel5mw_rotor rotor;
    double theta, gust, speed, *inflow;
} blade;

static int blow(spar_session *s, double t, double dt, int iteration, void *context) {
    blade *b = context;
    (void)s, (void)iteration;
    double at = t + b->theta * dt, part = (at - 0.5) / 1.5;
    double u = 11.4 + (part > 0 && part < 1 ? 0.5 * b->gust * (1 - cos(2 * pi * part)) : 0);
    for (int64_t i = 0; i < turbine.aero_n; i++) {
        b->inflow[3 * i] = u;
        b->inflow[3 * i + 1] = b->inflow[3 * i + 2] = 0;
    }
    return spar_aero_solve(b->aero, turbine.density, b->inflow, b->theta);
}

static int turn(run *r, double t, void *context) {
    blade *b = context;
    double q[7], v[6], a[6];
    (void)r;
    nrel5mw_root_motion(&turbine, &b->rotor, 0, b->speed * t, b->speed, 0, q, v, a);
    return spar_member_drive_root(b->member, q, v, a);
}

static int play_blade(run *r, double gust) {
    const double g[3] = {0, 0, -9.80665};
    const knobs *k = r->k;
    double twist[64], omega[3];
    blade b = {.theta = k->theta, .gust = gust, .speed = 12.1 * pi / 30};
    spar_session *s;
    spar_fluid *f;
    nrel5mw_rotor_default(&turbine, &b.rotor);
    TRY(spar_session_create(&s));
    b.inflow = calloc((size_t)(3 * turbine.aero_n), sizeof *b.inflow);
    int status = b.inflow ? settings(s, k) : SPAR_ERR_MEMORY;
    status = status ? status : spar_session_set_gravity(s, g);
    status = status ? status : nrel5mw_create_blade(&turbine, &b.rotor, s, 0, k->elements, k->nodes, &b.member);
    status = status ? status : beam_knobs(b.member, k);
    for (int i = 0; i < 3; i++) {
        omega[i] = b.speed * b.rotor.axis[i];
    }
    status = status ? status : spar_member_set_velocity(b.member, b.rotor.hub, NULL, omega);
    status = status ? status : nrel5mw_create_sections(&turbine, &b.rotor, 0, b.member, &f, twist);
    status = status ? status : spar_fluid_set_interpolation(f, k->consistent);
    status = status ? status : nrel5mw_create_aero(&turbine, &b.rotor, 1, &f, twist, &b.aero);
    status = status || k->aero < 0 ? status : spar_aero_set_effects(b.aero, k->aero);
    status = status ? status : march(s, b.member, r, turn, blow, &b);
    if (status && getenv("SPAR_ACCURACY_VERBOSE")) {
        fprintf(stderr, "\n%s\n", spar_session_message(s));
    }
    spar_aero_destroy(&b.aero);
    spar_session_destroy(&s);
    free(b.inflow);
    return status;
}

static int play_steady(run *r) {
    return play_blade(r, 0);
}

static int play_gust(run *r) {
    return play_blade(r, 8);
}

/* ---- the half wing of the HALE aircraft (Patil, Hodges & Cesnik 2001) at 25 m/s and 2 degrees ---- */

static int glide(spar_session *s, double t, double dt, int iteration, void *context) {
    blade *b = context;
    (void)s, (void)t, (void)dt, (void)iteration;
    return spar_aero_solve(b->aero, 0.0889, b->inflow, b->theta);
}

static void diagonal(double *m, double a, double b, double c, double d, double e, double f) {
    const double x[6] = {a, b, c, d, e, f};
    memset(m, 0, 36 * sizeof *m);
    for (int i = 0; i < 6; i++) {
        m[7 * i] = x[i];
    }
}

static int plain_beam(spar_session *s, const knobs *k, double length, const double *C, const double *M, int root,
                      spar_member **b) {
    const double eta[2] = {0, 1}, xyz[6] = {0, 0, 0, length, 0, 0};
    TRY(spar_beam_create(s, "beam", k->elements, k->nodes, b));
    TRY(spar_beam_set_axis(*b, 2, eta, xyz, NULL));
    TRY(spar_beam_set_sections(*b, 1, eta, C, M));
    TRY(spar_member_set_root(*b, root));
    return beam_knobs(*b, k);
}

static int play_wing(run *r) {
    const knobs *k = r->k;
    double C[36], M[36], xi[WING_STRIPS], offset[3 * WING_STRIPS], inflow[3 * WING_STRIPS];
    double alpha[3] = {-0.5, 0, 0.5}, cl[3] = {-pi, 0, pi}, zero[3] = {0}, cd[3] = {0.01, 0.01, 0.01};
    blade b = {.theta = k->theta, .inflow = inflow};
    spar_session *s;
    spar_fluid *f;
    spar_polar *polar = NULL;
    diagonal(C, 1e7, 1e7, 1e7, 1e4, 2e4, 4e6);
    diagonal(M, 0.75, 0.75, 0.75, 0.1, 0.05, 0.05);
    TRY(spar_session_create(&s));
    int status = settings(s, k);
    status = status ? status : plain_beam(s, k, 16, C, M, SPAR_ROOT_FIXED, &b.member);
    for (int i = 0; i < WING_STRIPS; i++) { /* aerodynamic centre a quarter chord ahead of the elastic axis */
        xi[i] = (2 * i + 1.0) / WING_STRIPS - 1;
        offset[3 * i] = offset[3 * i + 2] = 0, offset[3 * i + 1] = -0.25;
        inflow[3 * i] = 0, inflow[3 * i + 1] = 25 * cos(2 * pi / 180), inflow[3 * i + 2] = -25 * sin(2 * pi / 180);
    }
    status = status ? status : spar_fluid_create(b.member, "strips", &f);
    status = status ? status : spar_fluid_set_sections(f, WING_STRIPS, xi, offset);
    status = status ? status : spar_fluid_set_interpolation(f, k->consistent);
    status = status ? status : spar_fluid_map(f);
    status = status ? status : spar_polar_create(3, alpha, cl, cd, zero, &polar);
    status = status ? status : spar_aero_create(1, &f, &b.aero);
    for (int i = 0; i < WING_STRIPS && !status; i++) {
        status = spar_aero_set_section(b.aero, i, 1, 0, polar);
    }
    status = status ? status : spar_aero_set_effects(b.aero, k->aero < 0 ? SPAR_AERO_DRAG : k->aero);
    status = status ? status : march(s, b.member, r, NULL, glide, &b);
    if (status && getenv("SPAR_ACCURACY_VERBOSE")) {
        fprintf(stderr, "\n%s\n", spar_session_message(s));
    }
    spar_aero_destroy(&b.aero);
    spar_polar_destroy(&polar);
    spar_session_destroy(&s);
    return status;
}

/* ---- nodes beside a line: a heavy fluid on a plate, waves of load on a body on a spring ---- */

typedef struct strip {
    spar_fluid *fluid;
    const knobs *k;
    double added, spring, damper, load, rate; /* of one node: inertia, stiffness, damping, amplitude, rad/s */
    double x[6 * STRIPS], rest[6 * STRIPS], v[6 * STRIPS], old[6 * STRIPS], force[6 * STRIPS];
    float x32[6 * STRIPS], v32[6 * STRIPS], force32[6 * STRIPS];
    double t;
} strip;

static int press(spar_session *s, double t, double dt, int iteration, void *context) {
    strip *f = context;
    (void)s, (void)iteration;
    if (f->k->single) {
        TRY(spar_fluid_pull_motion_f32(f->fluid, f->k->theta, f->x32, f->v32));
        for (int i = 0; i < 6 * STRIPS; i++) {
            f->x[i] = (double)f->x32[i], f->v[i] = (double)f->v32[i];
        }
    } else {
        TRY(spar_fluid_pull_motion(f->fluid, f->k->theta, f->x, f->v));
    }
    for (int i = 0; i < 2 * STRIPS; i++) {
        double speed = f->v[3 * i + 2], gain = (speed - f->old[3 * i + 2]) / (f->k->theta > 0 ? f->k->theta * dt : dt);
        f->force[3 * i] = f->force[3 * i + 1] = 0;
        f->force[3 * i + 2] = f->load * sin(f->rate * (t + dt)) - f->added * gain - f->damper * speed -
                              f->spring * (f->x[3 * i + 2] - f->rest[3 * i + 2]);
    }
    if (f->k->single) {
        for (int i = 0; i < 6 * STRIPS; i++) {
            f->force32[i] = (float)f->force[i];
        }
        return spar_fluid_push_forces_f32(f->fluid, f->force32, NULL);
    }
    return spar_fluid_push_forces(f->fluid, f->force, NULL);
}

/* Before a step: the velocities the fluid saw last become those at t^n. */
static int keep(run *r, double t, void *context) {
    strip *f = context;
    (void)r, (void)t;
    return spar_fluid_pull_motion(f->fluid, 1, NULL, f->old);
}

static int play_strip(run *r, double length, const double *C, const double *M, int root, strip *f) {
    spar_session *s;
    spar_member *b;
    f->k = r->k;
    TRY(spar_session_create(&s));
    int status = settings(s, r->k);
    status = status ? status : plain_beam(s, r->k, length, C, M, root, &b);
    for (int i = 0; i < 2 * STRIPS; i++) {
        const double x[3] = {length * (0.5 + i % STRIPS) / STRIPS, 0, (i < STRIPS ? 0.02 : -0.02) * length};
        memcpy(f->rest + 3 * i, x, sizeof x);
    }
    status = status ? status : spar_fluid_create(b, "nodes", &f->fluid);
    status = status ? status : spar_fluid_set_motion_nodes(f->fluid, 2 * STRIPS, f->rest);
    status = status ? status : spar_fluid_set_force_nodes(f->fluid, 2 * STRIPS, f->rest);
    status = status ? status : spar_fluid_set_projection(f->fluid, r->k->projection, 0);
    status = status ? status : spar_fluid_set_interpolation(f->fluid, r->k->consistent);
    status = status ? status : spar_fluid_map(f->fluid);
    status = status ? status : march(s, b, r, keep, press, f);
    if (status && getenv("SPAR_ACCURACY_VERBOSE")) {
        fprintf(stderr, "\n%s\n", spar_session_message(s));
    }
    spar_session_destroy(&s);
    return status;
}

static int play_plate(run *r) {
    double C[36], M[36], per = 1.0 / (2 * STRIPS);
    strip f = {.added = 10 * per, .damper = 5 * per, .load = 5 * per, .rate = 8};
    diagonal(C, 1e6, 1e5, 1e5, 100, 100, 100);
    diagonal(M, 1, 1, 1, 2e-3, 1e-3, 1e-3);
    return play_strip(r, 1, C, M, SPAR_ROOT_FIXED, &f);
}

static int play_body(run *r) {
    double C[36], M[36], per = 1.0 / (2 * STRIPS);
    strip f = {.spring = 4000 * per, .damper = 200 * per, .load = 300 * per, .rate = 3};
    diagonal(C, 1e10, 1e10, 1e10, 1e8, 1e8, 1e8);
    diagonal(M, 100, 100, 100, 4, 2, 2);
    return play_strip(r, 2, C, M, SPAR_ROOT_FREE, &f);
}

/* ---- turning knobs ---- */

static FILE *csv;
static int full, done;
static double reference[SAMPLES][3], scale, standard_time;

static double rms(double a[SAMPLES][3], double b[SAMPLES][3]) {
    double sum = 0;
    for (int i = 0; i < SAMPLES; i++) {
        for (int c = 0; c < 3; c++) {
            double d = a[i][c] - (b ? b[i][c] : 0);
            sum += d * d;
        }
    }
    return sqrt(sum / SAMPLES);
}

/* The least time of a few runs. */
static int play(const scene *s, const knobs *k, int repeats, run *r) {
    double least = INFINITY;
    int status = SPAR_OK;
    for (int i = 0; i < repeats && status == SPAR_OK; i++) {
        *r = (run){.k = k, .T = s->T};
        status = s->play(r);
        least = fmin(least, r->time);
    }
    r->time = least;
    return status;
}

static void measure(const scene *s, const char *knob, const char *value, knobs k) {
    run r;
    int status = play(s, &k, full ? 5 : 3, &r);
    fprintf(stderr, "\r%4d %-7s %-12s %-16s", ++done, s->name, knob, value);
    if (status != SPAR_OK) {
        fprintf(csv, "%s,%s,%s,,,,fails\n", s->name, knob, value);
        return;
    }
    fprintf(csv, "%s,%s,%s,%.4e,%.4f,%.3f,\n", s->name, knob, value, rms(r.history, reference) / scale,
            r.time / standard_time, (double)r.iterations * k.dt / s->T);
    fflush(csv);
}

#define TURN(knob, field, format, ...)                                                                                 \
    do {                                                                                                               \
        const double list_[] = {__VA_ARGS__};                                                                          \
        for (size_t i_ = 0; i_ < sizeof list_ / sizeof *list_; i_++) {                                                 \
            knobs k_ = s->standard;                                                                                    \
            char text_[32];                                                                                            \
            k_.field = (__typeof__(k_.field))list_[i_];                                                                \
            snprintf(text_, sizeof text_, format, list_[i_]);                                                          \
            measure(s, knob, text_, k_);                                                                               \
        }                                                                                                              \
    } while (0)

static void effects(const scene *s) {
    static const struct {
        const char *name;
        int bit;
    } all[] = {{"no inertia", SPAR_EFFECT_INERTIA},
               {"no gyroscopic", SPAR_EFFECT_GYROSCOPIC},
               {"no gravity", SPAR_EFFECT_GRAVITY},
               {"no damping", SPAR_EFFECT_DAMPING},
               {"no moment", SPAR_EFFECT_FLUID_MOMENT}},
      aero[] = {{"no induction", SPAR_AERO_INDUCTION}, {"no tip loss", SPAR_AERO_TIP_LOSS},
                {"no hub loss", SPAR_AERO_HUB_LOSS},   {"no swirl", SPAR_AERO_SWIRL},
                {"no drag", SPAR_AERO_DRAG},           {"no pitching", SPAR_AERO_MOMENT}};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) {
        knobs k = s->standard;
        k.effects = 63 & ~all[i].bit;
        measure(s, "effects", all[i].name, k);
    }
    for (size_t i = 0; i < sizeof aero / sizeof *aero && s->spins; i++) {
        knobs k = s->standard;
        k.aero = 63 & ~aero[i].bit;
        measure(s, "effects", aero[i].name, k);
    }
}

static void rungs(const scene *s) {
    static const char *const names[] = {"prescribed", "rigid", "linear"};
    for (int rung = s->play == play_body; rung < 3; rung++) {
        knobs k = s->standard;
        k.rung = rung;
        measure(s, "rung", names[rung], k);
    }
    for (int64_t modes = 2; modes <= 16 && s->play != play_body; modes *= 2) {
        knobs k = s->standard;
        char text[32];
        k.rung = SPAR_FIDELITY_MODAL, k.modes = modes;
        snprintf(text, sizeof text, "%d modes", (int)modes);
        measure(s, "rung", text, k);
    }
}

static void coupling(const scene *s) {
    static const char *const names[] = {"explicit", "fixed", "aitken", "iqn"};
    const double tolerances[] = {1e-2, 1e-4, 1e-6, 1e-9};
    for (int scheme = 0; scheme < 4; scheme++) {
        for (int t = 0; t < (scheme ? 4 : 1); t++) {
            knobs k = s->standard;
            char text[32];
            k.scheme = scheme, k.tolerance = tolerances[t];
            snprintf(text, sizeof text, scheme ? "%s %.0e" : "%s", names[scheme], tolerances[t]);
            measure(s, "coupling", text, k);
        }
    }
    for (int i = 2; i <= 4; i *= 2) { /* is it the coupling that a long step fails by? */
        knobs k = s->standard;
        char text[32];
        k.scheme = SPAR_COUPLING_IQN_ILS, k.tolerance = 1e-4, k.dt *= i;
        snprintf(text, sizeof text, "iqn 1e-04 dt %g", k.dt);
        measure(s, "coupling", text, k);
    }
}

/* Several knobs at once, over dt: what the single ones suggest. */
static void together(const scene *s) {
    static const double factor[] = {0.25, 0.5, 1, 2};
    static const char *const names[] = {"newton 1e-6", "lean", "lean/modal", "rigid"};
    for (int kind = 0; kind < 4; kind++) {
        if ((kind == 2) == (s->play == play_body) && kind > 1) {
            continue;
        }
        for (size_t i = 0; i < sizeof factor / sizeof *factor; i++) {
            knobs k = s->standard;
            char text[48];
            k.dt *= factor[i];
            k.newton = 1e-6;
            if (kind > 0) { /* fewer nodes and points, the coupling no tighter than the step */
                k.nodes = 6;
                k.rule = s->spins ? SPAR_QUADRATURE_SECTIONS : -1, k.points = 1;
                k.tolerance = 1e-2;
            }
            if (kind == 2) {
                k.rung = SPAR_FIDELITY_MODAL, k.modes = 8;
            }
            if (kind == 3) {
                k.rung = SPAR_FIDELITY_RIGID;
            }
            snprintf(text, sizeof text, "%s dt %g", names[kind], k.dt);
            measure(s, "together", text, k);
        }
    }
}

static int benchmark(const scene *s) {
    run r;
    double rigid[SAMPLES][3];
    knobs still = s->reference;
    still.rung = SPAR_FIDELITY_PRESCRIBED, still.dt = s->standard.dt, still.scheme = SPAR_COUPLING_EXPLICIT;
    fprintf(stderr, "\r%4d %-7s reference            ", done, s->name);
    int status = play(s, &s->reference, 1, &r);
    if (status != SPAR_OK) {
        fprintf(stderr, "\n%s: the reference fails: %s\n", s->name, spar_status_text(status));
        return 1;
    }
    memcpy(reference, r.history, sizeof reference);
    scale = rms(reference, NULL);
    if (s->spins) {
        if (play(s, &still, 1, &r) != SPAR_OK) {
            return 1;
        }
        memcpy(rigid, r.history, sizeof rigid);
        scale = rms(reference, rigid);
    }
    if (play(s, &s->standard, 5, &r) != SPAR_OK) {
        fprintf(stderr, "\n%s: the default fails\n", s->name);
        return 1;
    }
    standard_time = r.time;
    measure(s, "default", "default", s->standard);
    double d = s->standard.dt;
    TURN("dt", dt, "%g", d / 4, d / 2, d * 2, d * 4);
    TURN("nodes", nodes, "%g", 3, 4, 5, 6, 8, 10, 12);
    TURN("elements", elements, "%g", 1, 2, 3);
    for (int points = 1; points <= 4 && s->spins; points++) {
        knobs k = s->standard;
        char text[32];
        k.rule = SPAR_QUADRATURE_SECTIONS, k.points = points;
        snprintf(text, sizeof text, "%d a section", points);
        measure(s, "quadrature", text, k);
    }
    for (int points = 7; points <= 16 && !s->spins; points += 3) {
        knobs k = s->standard;
        char text[32];
        k.rule = SPAR_QUADRATURE_GAUSS, k.points = points;
        snprintf(text, sizeof text, "%d gauss", points);
        measure(s, "quadrature", text, k);
    }
    TURN("rho", rho, "%g", 0, 0.5, 1);
    TURN("substeps", substeps, "%g", 2, 4);
    TURN("newton", newton, "%g", 1e-3, 1e-6, 1e-9);
    TURN("predictor", predictor, "%g", 0, 1, 2);
    TURN("theta", theta, "%g", 0, 0.5);
    TURN("consistent", consistent, "%g", 1);
    if (s->play == play_plate || s->play == play_body) {
        TURN("projection", projection, "%g", 1);
        TURN("f32", single, "%g", 1);
    }
    coupling(s);
    effects(s);
    rungs(s);
    together(s);
    return 0;
}

int main(int argc, char **argv) {
    const char *out = "accuracy.csv", *only = NULL;
    for (int i = 1; i < argc; i++) {
        full |= strcmp(argv[i], "--full") == 0;
        out = strcmp(argv[i], "--out") == 0 && i + 1 < argc ? argv[++i] : out;
        only = strcmp(argv[i], "--scene") == 0 && i + 1 < argc ? argv[++i] : only;
    }
    const knobs plain = {.elements = 1,
                         .nodes = 8,
                         .rule = -1,
                         .dt = 0.02,
                         .rho = 0.9,
                         .substeps = 1,
                         .predictor = 1,
                         .tolerance = 1e-6,
                         .theta = 1,
                         .effects = -1,
                         .aero = -1,
                         .rung = SPAR_FIDELITY_EXACT};
    scene scenes[] = {{"rotor", play_steady, 3.2, plain, plain, 1},
                      {"gust", play_gust, 3.2, plain, plain, 1},
                      {"wing", play_wing, 4, plain, plain, 0},
                      {"plate", play_plate, 2, plain, plain, 0},
                      {"body", play_body, 6, plain, plain, 0}};
    scenes[3].standard.scheme = SPAR_COUPLING_IQN_ILS;
    scenes[3].standard.dt = scenes[2].standard.dt = scenes[4].standard.dt = 0.0125;
    if (nrel5mw_load(&turbine, SPAR_DATA_DIR "/nrel5mw") != SPAR_OK) {
        fprintf(stderr, "accuracy: %s\n", turbine.message);
        return 1;
    }
    csv = fopen(out, "w");
    if (!csv) {
        perror(out);
        return 1;
    }
    fprintf(csv, "scene,knob,value,error,cost,iterations,note\n");
    int failed = 0;
    double since = cpu();
    for (size_t i = 0; i < sizeof scenes / sizeof *scenes; i++) {
        scenes[i].reference = scenes[i].standard;
        scenes[i].reference.dt = scenes[i].standard.dt / (full ? 40 : 16);
        scenes[i].reference.nodes = 14;
        scenes[i].reference.scheme = SPAR_COUPLING_IQN_ILS;
        scenes[i].reference.tolerance = 1e-9;
        failed |= !only || strcmp(only, scenes[i].name) == 0 ? benchmark(&scenes[i]) : 0;
    }
    fclose(csv);
    nrel5mw_free(&turbine);
    fprintf(stderr, "\n%d settings in %.0f s; %s\n", done, cpu() - since, out);
    return failed;
}
