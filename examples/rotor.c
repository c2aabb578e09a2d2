/* The NREL 5-MW rotor in the wind, end to end, with public functions only: blades as beams whose roots turn at constant
   speed, blade element momentum theory as the fluid, coupled step by step. Alone or under mpirun, where each rank takes
   its share of the blades. Run it with --help for what can be chosen. Compiled with ROTOR_SHOWS_EFFECTS it is
   spar-effects: the same scene, and what each effect is worth in it. */
#include "nrel5mw.h"
#include "ranks.h"
#include "rotor_options.h"
#include "rotor_report.h"
#include "rotor_view.h"
#include <math.h>
#include <spar/spar_output.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

static const double pi = 3.14159265358979323846, standard_gravity = 9.80665;

/* Transfers are timed apart from the aerodynamics in one of so many solutions. */
enum { BLADES_MAX = 16, SAMPLE_EVERY = 64 };

#ifdef ROTOR_SHOWS_EFFECTS
enum { SHOWS_EFFECTS = 1 };
#else
enum { SHOWS_EFFECTS = 0 };
#endif

typedef struct scene {
    rotor_options options;
    nrel5mw turbine;
    nrel5mw_rotor rotor;
    rotor_report report;
    int rank, ranks;
    spar_session *session;
    spar_member *blade[BLADES_MAX];
    int64_t nodes;              /* of a blade */
    int mine, name[BLADES_MAX]; /* blades whose sections are on this rank */
    spar_fluid *fluid[BLADES_MAX];
    spar_aero *aero;
    double *inflow, *place, *velocity, *turn, *spin, *load, *force, *moment; /* of this rank's sections */
    double *alpha, *induction, *span;
    double *reference, *motion; /* of a blade's nodes [3], [7] */
    int64_t solutions, samples, pictures;
    int trials;                                     /* begun */
    double trials_from, trials_begun, trials_shown; /* simulated time; wall time */
    double trials_part;                             /* of what advice expects to cost; 0: it has not said */
    char trial_text[160];
} scene;

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Adds the time since *since to a phase and starts the next. */
static void lap(scene *s, int phase, double *since) {
    double t = now();
    s->report.phase[phase] += t - *since;
    *since = t;
}

/* ---- failure ---- */

/* Says what went wrong; a rank whose peer failed leaves that to the peer. */
static int complain(const scene *s, int status) {
    const char *text = s->turbine.message[0] ? s->turbine.message : spar_session_message(s->session);
    text = status == SPAR_ERR_MEMORY && !text[0] ? "no memory" : text;
    if (status != SPAR_ERR_PEER) {
        fprintf(stderr, "\nrotor: rank %d: %s: %s\n", s->rank, spar_status_text(status), text);
    }
    return status;
}

#define TRY(call)                                                                                                      \
    do {                                                                                                               \
        int status_ = (call);                                                                                          \
        if (status_ != SPAR_OK) {                                                                                      \
            return complain(s, status_);                                                                               \
        }                                                                                                              \
    } while (0)

/* ---- the scene ---- */

static int describe_session(scene *s) {
    const rotor_options *o = &s->options;
    TRY(ranks_create_session(s->ranks, &s->session));
    TRY(spar_session_set_gravity(s->session, (const double[]){0, 0, -standard_gravity}));
    TRY(spar_session_set_integrator(s->session, o->rho_inf, o->substeps));
    TRY(spar_session_set_predictor(s->session, o->predictor));
    TRY(spar_session_set_coupling(s->session, o->scheme, 0, o->coupling_tolerance, o->max_iterations));
    TRY(spar_session_set_newton(s->session, 1e-15, o->newton, 50));
    if (o->scheme == SPAR_COUPLING_FIXED_POINT) {
        TRY(spar_session_set_relaxation(s->session, o->relaxation));
    }
    return SPAR_OK;
}

static int describe_rotor(scene *s) {
    rotor_options *o = &s->options;
    double rpm, pitch;
    TRY(nrel5mw_load(&s->turbine, o->data));
    rotor_operating_point(o->wind, &rpm, &pitch);
    s->turbine.tilt = isfinite(o->tilt) ? o->tilt * pi / 180 : s->turbine.tilt;
    s->turbine.precone = isfinite(o->precone) ? o->precone * pi / 180 : s->turbine.precone;
    nrel5mw_rotor_default(&s->turbine, &s->rotor);
    s->rotor.pitch = (isfinite(o->pitch) ? o->pitch : pitch) * pi / 180;
    s->report.speed = (isfinite(o->rpm) ? o->rpm : rpm) * pi / 30;
    if (!isfinite(o->seconds)) {
        o->seconds = SHOWS_EFFECTS && s->report.speed > 0 ? 4 * pi / s->report.speed : 30;
    }
    if (s->rotor.blades > BLADES_MAX) {
        snprintf(s->turbine.message, sizeof s->turbine.message, "%d blades are more than %d", s->rotor.blades,
                 BLADES_MAX);
        return complain(s, SPAR_ERR_ARGUMENT);
    }
    return SPAR_OK;
}

/* Every point of the blade turns with the rotor, from where it is. */
static int spin(scene *s, int b) {
    double omega[3];
    for (int i = 0; i < 3; i++) {
        omega[i] = s->report.speed * s->rotor.axis[i];
    }
    TRY(spar_member_set_initial_velocity(s->blade[b], s->rotor.hub, NULL, omega));
    return SPAR_OK;
}

static int create_blade(scene *s, int b) {
    const rotor_options *o = &s->options;
    TRY(nrel5mw_create_blade(&s->turbine, &s->rotor, s->session, b, o->rigid ? 0 : o->elements, o->nodes,
                             &s->blade[b]));
    if (!o->rigid && o->quadrature > 0) {
        TRY(spar_beam_set_quadrature(s->blade[b], SPAR_QUADRATURE_SECTIONS, o->quadrature));
    }
    if (!o->rigid && o->fidelity != SPAR_FIDELITY_EXACT) {
        TRY(spar_member_set_fidelity(s->blade[b], o->fidelity, o->fidelity == SPAR_FIDELITY_MODAL ? o->modes : 0));
    }
    TRY(spar_member_set_effects(s->blade[b], 0, o->effects_off));
    TRY(spar_member_set_owner(s->blade[b], b % s->ranks));
    TRY(spar_member_commit(s->blade[b]));
    return spin(s, b);
}

static int allocate(scene *s) {
    int64_t n = s->mine * s->turbine.aero_n;
    double **array[] = {&s->inflow, &s->place, &s->velocity,  &s->turn, &s->spin,      &s->load,  &s->force,
                        &s->moment, &s->alpha, &s->induction, &s->span, &s->reference, &s->motion};
    const int64_t size[] = {
        3 * n,        3 * n,       3 * n, 4 * n, 3 * n, 6 * n, 3 * n, 3 * n, n, n, ROTOR_SPAN * s->turbine.aero_n,
        3 * s->nodes, 7 * s->nodes};
    for (size_t i = 0; i < sizeof array / sizeof array[0]; i++) {
        *array[i] = calloc((size_t)size[i] + 1, sizeof(double));
        if (!*array[i]) {
            return 1;
        }
    }
    return rotor_report_begin(&s->report);
}

static int build(scene *s) {
    double twist[256];
    if (s->turbine.aero_n > (int64_t)(sizeof twist / sizeof *twist)) {
        snprintf(s->turbine.message, sizeof s->turbine.message, "aero.txt has %lld sections; 256 is the most",
                 (long long)s->turbine.aero_n);
        return complain(s, SPAR_ERR_ARGUMENT);
    }
    for (int b = 0; b < s->rotor.blades; b++) {
        if (create_blade(s, b) != SPAR_OK) {
            return 1;
        }
        if (b % s->ranks == s->rank) {
            TRY(nrel5mw_create_sections(&s->turbine, &s->rotor, b, s->blade[b], &s->fluid[s->mine], twist));
            s->name[s->mine++] = b;
        }
    }
    TRY(nrel5mw_create_aero(&s->turbine, &s->rotor, s->mine, s->fluid, twist, &s->aero));
    if (s->options.aero_effects_given) {
        TRY(spar_aero_set_effects(s->aero, s->options.aero_effects));
    }
    TRY(spar_member_get_count(s->blade[0], &s->nodes));
    return allocate(s) == 0 ? SPAR_OK : complain(s, SPAR_ERR_MEMORY);
}

static void release(scene *s) {
    double *all[] = {s->inflow, s->place, s->velocity,  s->turn, s->spin,      s->load,  s->force,
                     s->moment, s->alpha, s->induction, s->span, s->reference, s->motion};
    for (size_t i = 0; i < sizeof all / sizeof all[0]; i++) {
        free(all[i]);
    }
    spar_aero_destroy(&s->aero);
    spar_session_destroy(&s->session);
    rotor_report_free(&s->report);
    nrel5mw_free(&s->turbine);
}

/* ---- the fluid ---- */

static double wind_speed(const rotor_options *o, double t) {
    double part = (t - o->gust_start) / o->gust_length;
    double gust = part > 0 && part < 1 ? 0.5 * o->gust * (1 - cos(2 * pi * part)) : 0;
    return o->wind + gust;
}

/* Wind at the sections at time t; with shear it depends on where they are (s->place). */
static void blow(scene *s, double t) {
    const rotor_options *o = &s->options;
    double speed = wind_speed(o, t), yaw = o->yaw * pi / 180;
    for (int64_t i = 0; i < s->mine * s->turbine.aero_n; i++) {
        double height = 1 + (s->place[3 * i + 2] - s->rotor.hub[2]) / o->hub_height;
        double here = o->shear != 0 ? speed * pow(fmax(height, 0), o->shear) : speed;
        s->inflow[3 * i] = here * cos(yaw);
        s->inflow[3 * i + 1] = here * sin(yaw);
        s->inflow[3 * i + 2] = 0;
    }
}

/* The aerodynamics of the step from t to t + dt: of the motion and the time alone, so trials can repeat it. */
static int solve_aero(scene *s, double t, double dt) {
    int status = SPAR_OK;
    for (int k = 0; k < s->mine && s->options.shear != 0 && status == SPAR_OK; k++) {
        double *place = s->place + 3 * k * s->turbine.aero_n;
        status = spar_fluid_pull_motion(s->fluid[k], s->options.theta, place, NULL);
    }
    blow(s, t + s->options.theta * dt);
    return status == SPAR_OK ? spar_aero_solve(s->aero, s->turbine.density, s->inflow, s->options.theta) : status;
}

/* spar_aero_solve takes motion out and puts loads in; doing just that once more tells what part of its time it is. The
   loads are the same ones, so nothing changes. */
static int sample_transfer(scene *s) {
    int64_t n = s->turbine.aero_n;
    double since = now();
    for (int k = 0; k < s->mine; k++) {
        TRY(spar_fluid_pull_motion(s->fluid[k], s->options.theta, s->place + 3 * k * n, s->velocity + 3 * k * n));
        TRY(spar_fluid_pull_poses(s->fluid[k], SPAR_NODES_MOTION, s->options.theta, NULL, s->turn + 4 * k * n, NULL,
                                  s->spin + 3 * k * n, NULL, NULL));
    }
    lap(s, ROTOR_MOTION, &since);
    TRY(spar_aero_get_loads(s->aero, NULL, s->force, s->moment));
    for (int k = 0; k < s->mine; k++) {
        const double *moment = s->options.aero_effects & SPAR_AERO_MOMENT ? s->moment + 3 * k * n : NULL;
        TRY(spar_fluid_push_forces(s->fluid[k], s->force + 3 * k * n, moment));
    }
    lap(s, ROTOR_LOADS, &since);
    s->samples++;
    return SPAR_OK;
}

/* The same in a step of the run, with its time taken. */
static int solve_fluid(scene *s, double t, double dt) {
    double since = now();
    TRY(solve_aero(s, t, dt));
    lap(s, ROTOR_AERO, &since);
    return s->solutions++ % SAMPLE_EVERY == 0 ? sample_transfer(s) : SPAR_OK;
}

/* ---- recording ---- */

/* v in the axes of the frame q: R(q)^T v */
static void to_frame(const double q[4], const double v[3], double out[3]) {
    double t[3] = {v[1] * q[3] - v[2] * q[2], v[2] * q[1] - v[0] * q[3], v[0] * q[2] - v[1] * q[1]};
    out[0] = v[0] + 2 * (q[0] * t[0] + t[1] * q[3] - t[2] * q[2]);
    out[1] = v[1] + 2 * (q[0] * t[1] + t[2] * q[1] - t[0] * q[3]);
    out[2] = v[2] + 2 * (q[0] * t[2] + t[0] * q[2] - t[1] * q[1]);
}

/* Tip and root of blade b in the frame that turns with its root: x along the span, y aft, z upwind. */
static int record_blade(scene *s, int b, double angle, double *out) {
    int64_t tip = s->nodes - 1;
    double x0[3], q0[4], x[3], q[4], then[3], here[3], reaction[6], moment[3];
    TRY(spar_member_get_reference(s->blade[b], s->reference, NULL));
    TRY(spar_member_get_motion(s->blade[b], s->motion, NULL, NULL));
    TRY(spar_member_get_reaction(s->blade[b], reaction));
    nrel5mw_root(&s->turbine, &s->rotor, b, 0, x0, q0);
    nrel5mw_root(&s->turbine, &s->rotor, b, angle, x, q);
    for (int i = 0; i < 3; i++) {
        then[i] = s->reference[3 * tip + i] - x0[i];
        here[i] = s->reference[3 * tip + i] + s->motion[7 * tip + i] - x[i];
    }
    to_frame(q0, then, then);
    to_frame(q, here, here);
    to_frame(q, reaction + 3, moment);
    out[ROTOR_FLAP] = -(here[2] - then[2]);
    out[ROTOR_EDGE] = here[1] - then[1];
    out[ROTOR_FLAP_MOMENT] = -moment[1]; /* what the blade does to the hub */
    out[ROTOR_EDGE_MOMENT] = -moment[2];
    for (int64_t i = 0; i < s->nodes; i++) {
        const double *p = s->motion + 7 * i + 3;
        double size = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2] + p[3] * p[3]);
        s->report.quaternion_error = fmax(s->report.quaternion_error, fabs(size - 1));
    }
    return SPAR_OK;
}

/* Loads along blade 0, which rank 0 has. */
static int record_span(scene *s, double angle, double weight) {
    int64_t n = s->turbine.aero_n;
    const double *axis = s->rotor.axis;
    double x[3], driving[3], size;
    TRY(spar_aero_get_loads(s->aero, s->load, s->force, NULL));
    TRY(spar_aero_get_sections(s->aero, s->alpha, NULL, NULL, s->induction, NULL));
    double q[4];
    nrel5mw_root(&s->turbine, &s->rotor, 0, angle, x, q);
    for (int i = 0; i < 3; i++) {
        x[i] -= s->rotor.hub[i];
    }
    for (int i = 0; i < 3; i++) {
        driving[i] = axis[(i + 1) % 3] * x[(i + 2) % 3] - axis[(i + 2) % 3] * x[(i + 1) % 3];
    }
    size = sqrt(driving[0] * driving[0] + driving[1] * driving[1] + driving[2] * driving[2]);
    memset(s->span, 0, (size_t)(ROTOR_SPAN * n) * sizeof *s->span);
    for (int64_t i = 0; i < n; i++) {
        for (int c = 0; c < 3; c++) {
            s->span[ROTOR_AXIAL * n + i] += s->load[6 * i + c] * axis[c];
            s->span[ROTOR_TANGENTIAL * n + i] += s->load[6 * i + c] * driving[c] / size;
            s->span[ROTOR_LUMPED * n + i] += s->force[3 * i + c] * axis[c];
        }
        s->span[ROTOR_ALPHA * n + i] = s->alpha[i];
        s->span[ROTOR_INDUCTION * n + i] = s->induction[i];
    }
    rotor_report_span(&s->report, s->span, weight);
    return SPAR_OK;
}

static int record(scene *s, double t, double dt, double angle, int iterations) {
    double *row = rotor_report_row(&s->report), rotor[2];
    if (!row) {
        return complain(s, SPAR_ERR_MEMORY);
    }
    rotor[0] = rotor[1] = 0;
    if (s->mine > 0) {
        TRY(spar_aero_get_rotor(s->aero, &rotor[0], &rotor[1], NULL));
    }
    ranks_sum(s->ranks, rotor, 2);
    row[ROTOR_TIME] = t;
    row[ROTOR_AZIMUTH] = fmod(angle, 2 * pi) * 180 / pi;
    row[ROTOR_WIND] = wind_speed(&s->options, t);
    row[ROTOR_THRUST] = rotor[0];
    row[ROTOR_TORQUE] = rotor[1];
    row[ROTOR_POWER] = rotor[1] * s->report.speed;
    row[ROTOR_ITERATIONS] = iterations;
    for (int b = 0; b < s->rotor.blades; b++) {
        if (record_blade(s, b, angle, row + ROTOR_BLADES + ROTOR_PER_BLADE * b) != SPAR_OK) {
            return 1;
        }
    }
    double weight = dt > 0 ? rotor_report_weight(&s->report, t, dt) : 0;
    return s->rank == 0 && weight > 0 ? record_span(s, angle, weight) : SPAR_OK;
}

static int add_picture(scene *s, const char *index, int part, const char *kind, double t) {
    char path[1024], file[64];
    snprintf(path, sizeof path, "%s/%s.pvd", s->options.out, index);
    snprintf(file, sizeof file, "vtk/%s%d_%05lld.vtp", kind, part + 1, (long long)s->pictures);
    if (s->pictures == 0 && part == 0) {
        remove(path); /* of a run before */
    }
    return spar_vtk_series_add(path, t, part, file);
}

/* Blades from rank 0, sections from the rank that has them; rank 0 keeps the indices. */
static int take_picture(scene *s, double t) {
    char path[1024];
    for (int b = 0; b < s->rotor.blades && s->rank == 0; b++) {
        snprintf(path, sizeof path, "%s/vtk/blade%d_%05lld.vtp", s->options.out, b + 1, (long long)s->pictures);
        TRY(spar_member_write_vtk(s->blade[b], path));
        TRY(add_picture(s, "blades", b, "blade", t));
        TRY(add_picture(s, "sections", b, "sections", t));
    }
    for (int k = 0; k < s->mine; k++) {
        snprintf(path, sizeof path, "%s/vtk/sections%d_%05lld.vtp", s->options.out, s->name[k] + 1,
                 (long long)s->pictures);
        TRY(spar_fluid_write_vtk(s->fluid[k], path));
    }
    s->pictures++;
    return SPAR_OK;
}

/* ---- the run ---- */

static int drive(const scene *s, double angle) {
    double q[7], v[6], a[6];
    for (int b = 0; b < s->rotor.blades; b++) {
        nrel5mw_root_motion(&s->turbine, &s->rotor, b, angle, s->report.speed, 0, q, v, a);
        int status = spar_member_drive(s->blade[b], q, v, a);
        if (status != SPAR_OK) {
            return status;
        }
    }
    return SPAR_OK;
}

static int step(scene *s, double t, double dt, double angle, int *iterations) {
    int done = 0;
    double since = now();
    TRY(drive(s, angle));
    TRY(spar_step_begin(s->session, dt));
    lap(s, ROTOR_PREDICT, &since);
    for (*iterations = 0; !done; ++*iterations) {
        TRY(spar_step_solve(s->session));
        lap(s, ROTOR_STRUCTURE, &since);
        if (solve_fluid(s, t, dt) != SPAR_OK) {
            return 1;
        }
        since = now();
        TRY(spar_step_check(s->session, &done));
        lap(s, ROTOR_CHECK, &since);
    }
    TRY(spar_step_accept(s->session));
    lap(s, ROTOR_ACCEPT, &since);
    return SPAR_OK;
}

/* A line on stderr once the run takes longer than two seconds: in place on a terminal, else now and then. */
static void show_progress(const scene *s, double t, double begun, double *shown) {
    int terminal = isatty(STDERR_FILENO);
    double wall = now() - begun, part = t / s->options.seconds;
    if (s->rank != 0 || s->options.quiet || wall < 2 || wall - *shown < (terminal ? 0.2 : 10)) {
        return;
    }
    *shown = wall;
    fprintf(stderr, "%srotor: %3.0f %%  t = %.2f s  %.3g x real time  %.0f s to go%s", terminal ? "\r" : "", 100 * part,
            t, t / wall, wall / part - wall, terminal ? "   " : "\n");
    fflush(stderr);
}

/* Bends the blades to where the loads of the turning rotor and gravity would hold them at rest: straight blades let go
   in the wind swing for many turns. The loads depend on the shape: a few rounds bring both together, the first with
   the loads in steps. The static solution takes along the centrifugal force of the turning root. */
static int bend(scene *s) {
    enum { ROUNDS = 4, FIRST_STEPS = 4 };
    for (int round = 0; round < ROUNDS; round++) {
        if (solve_fluid(s, 0, 0) != SPAR_OK) {
            return 1;
        }
        for (int b = 0; b < s->rotor.blades; b++) {
            TRY(spar_member_solve_static(s->blade[b], round == 0 ? FIRST_STEPS : 1));
        }
        for (int b = 0; b < s->rotor.blades; b++) {
            if (spin(s, b) != SPAR_OK) {
                return 1;
            }
        }
    }
    return SPAR_OK;
}

static int run(scene *s) {
    const rotor_options *o = &s->options;
    int64_t steps = (int64_t)ceil(o->seconds / o->dt - 1e-9);
    double begun = now(), shown = 0, picture = 0, since;
    double every = SHOWS_EFFECTS ? 0 : isfinite(o->vtk_every) ? o->vtk_every : fmax(0.25, o->seconds / 240);
    for (int64_t i = 0; i <= steps; i++) {
        double t = i == steps ? o->seconds : (double)i * o->dt, angle = s->report.speed * t;
        double before = (double)(i - 1) * o->dt;
        int iterations = 0;
        if (i > 0 && step(s, before, t - before, angle, &iterations) != SPAR_OK) {
            return 1;
        }
        since = now();
        if (record(s, t, i > 0 ? t - before : 0, angle, iterations) != SPAR_OK) {
            return 1;
        }
        if (every > 0 && t >= picture - 1e-9) {
            picture += every;
            if (take_picture(s, t) != SPAR_OK) {
                return 1;
            }
        }
        lap(s, ROTOR_OUTPUT, &since);
        show_progress(s, t, begun, &shown);
    }
    if (shown > 0 && isatty(STDERR_FILENO)) {
        fprintf(stderr, "\r%78s\r", "");
    }
    s->report.wall = now() - begun;
    return SPAR_OK;
}

/* Where the run begins. */
static int start(scene *s) {
    const rotor_options *o = &s->options;
    if (!o->rigid && !o->straight && bend(s) != SPAR_OK) {
        return 1;
    }
    return solve_fluid(s, 0, 0); /* the loads the first prediction begins with */
}

/* ---- trials ---- */

/* A line on stderr once the trials take longer than two seconds, as show_progress. */
static void show_trials(scene *s) {
    int terminal = isatty(STDERR_FILENO);
    double wall = now() - s->trials_begun;
    if (s->rank != 0 || s->options.quiet || wall < 2 || wall - s->trials_shown < (terminal ? 0.2 : 10)) {
        return;
    }
    s->trials_shown = wall;
    char part[40] = "";
    if (s->trials_part > 0) {
        snprintf(part, sizeof part, " (%.0f %%)", 100 * s->trials_part);
    }
    fprintf(stderr, "%srotor: %.0f s, trial %d%s%s%.*s%s", terminal ? "\r" : "", wall, s->trials, part,
            s->trial_text[0] ? "; last: " : "", terminal ? 90 : 159, s->trial_text, terminal ? "\033[K" : "\n");
    fflush(stderr);
}

/* What the session's log says of its trials. */
static void hear(const spar_session *session, int level, const char *text, void *context) {
    scene *s = context;
    const char *trial = strstr(text, ": trial ");
    const char *why = strstr(text, "without ");
    (void)session;
    if (level == SPAR_LOG_INFO && !trial && why && s->rank == 0) { /* an effect that cannot be left out */
        fprintf(stderr, "%s%s\n", isatty(STDERR_FILENO) ? "\r\033[K" : "", why);
    }
    if (level == SPAR_LOG_INFO && trial) {
        snprintf(s->trial_text, sizeof s->trial_text, "%s", strchr(trial + 2, ':') + 2);
    }
}

/* What advice says of itself ahead of a trial. */
static int hear_progress(spar_session *session, double done, double expected, void *context) {
    scene *s = context;
    (void)session;
    s->trials_part = expected > 0 ? done / expected : 0;
    return 0;
}

static int before_step(spar_session *session, double t, double dt, void *context) {
    scene *s = context;
    (void)session;
    s->trials += t <= s->trials_from;
    show_trials(s);
    return drive(s, s->report.speed * (t + dt));
}

static int solve_step(spar_session *session, double t, double dt, int iteration, void *context) {
    (void)session, (void)iteration;
    return solve_aero(context, t, dt);
}

static int begin_trials(scene *s, double turns, rotor_trial *t) {
    const rotor_options *o = &s->options;
    double turn = s->report.speed > 0 ? 2 * pi / s->report.speed : 6,
           seconds = isfinite(o->trial) ? o->trial : turns * turn;
    s->trials_begun = now();
    s->trials_shown = 0;
    s->trials = 0;
    spar_session_get_time(s->session, &s->trials_from, NULL, NULL);
    spar_session_set_log(s->session, hear, s);
    *t = (rotor_trial){.aero = s->aero, .blade = s->blade[0]};
    TRY(spar_trial_create(s->session, &t->trial));
    TRY(spar_trial_set_steps(t->trial, o->dt, rotor_trial_steps(seconds, o->dt)));
    TRY(spar_trial_set_callbacks(t->trial, before_step, s, solve_step, s));
    return SPAR_OK;
}

static void end_trials(scene *s, rotor_trial *t) {
    spar_trial_destroy(&t->trial);
    spar_session_set_log(s->session, NULL, NULL);
    if (s->trials_shown > 0 && isatty(STDERR_FILENO)) {
        fprintf(stderr, "\r\033[K");
    }
}

static int show_effects(scene *s) {
    rotor_trial t;
    TRY(begin_trials(s, 0.5, &t));
    int status = rotor_view_effects(&t, s->options.csv, s->rank == 0);
    end_trials(s, &t);
    TRY(status);
    return SPAR_OK;
}

static int ask_advice(scene *s) {
    rotor_trial t;
    TRY(begin_trials(s, 1, &t));
    TRY(spar_trial_set_progress(t.trial, hear_progress, s));
    int status = rotor_view_advice(&t, &s->options, s->rank == 0);
    s->trials_part = 0;
    end_trials(s, &t);
    TRY(status);
    return SPAR_OK;
}

/* ---- the whole ---- */

/* The sampled transfers stand for all; what spar_aero_solve took without them is aerodynamics. */
static void settle_times(scene *s) {
    double *phase = s->report.phase, scale = (double)s->solutions / (double)s->samples;
    double taken = phase[ROTOR_MOTION] + phase[ROTOR_LOADS]; /* by the sampling itself */
    phase[ROTOR_MOTION] *= scale;
    phase[ROTOR_LOADS] *= scale;
    phase[ROTOR_AERO] = fmax(phase[ROTOR_AERO] - phase[ROTOR_MOTION] - phase[ROTOR_LOADS], 0);
    s->report.wall -= taken;
}

static int set_up(scene *s) {
    return describe_rotor(s) != SPAR_OK || describe_session(s) != SPAR_OK || build(s) != SPAR_OK || start(s) != SPAR_OK;
}

/* A scene of nothing but its options, and the ranks. */
static void clear(scene *s) {
    *s = (scene){.options = s->options, .rank = s->rank, .ranks = s->ranks};
    s->report.options = &s->options;
    s->report.turbine = &s->turbine;
    s->report.rotor = &s->rotor;
    s->report.ranks = s->ranks;
}

static int write_results(scene *s) {
    settle_times(s);
    if (s->rank != 0) {
        return 0;
    }
    rotor_report_print(&s->report, stdout);
    if (rotor_report_write(&s->report) != 0) {
        return 1;
    }
    if (s->pictures > 0) {
        printf("  %s/blades.pvd, sections.pvd (for ParaView, %lld times)\n", s->options.out, (long long)s->pictures);
    }
    return 0;
}

static int rotor(scene *s) {
    char folder[1024];
    snprintf(folder, sizeof folder, "%s/vtk", s->options.out);
    if (!SHOWS_EFFECTS && s->rank == 0 && rotor_make_folder(folder) != 0) {
        return 1;
    }
    if (set_up(s) != 0) {
        return 1;
    }
    if (isfinite(s->options.tolerance)) { /* built anew, with the settings advised */
        if (ask_advice(s) != SPAR_OK) {
            return 1;
        }
        release(s);
        clear(s);
        if (set_up(s) != 0) {
            return 1;
        }
    }
    if (run(s) != SPAR_OK) {
        return 1;
    }
    return SHOWS_EFFECTS ? show_effects(s) : write_results(s);
}

int main(int argc, char **argv) {
    scene s = {0};
    ranks_begin(&argc, &argv, &s.rank, &s.ranks);
    clear(&s);
    int failed = rotor_options_read(&s.options, argc, argv);
    if (!failed && s.options.help) {
        if (s.rank == 0) {
            rotor_options_help(argv[0]);
        }
    } else if (!failed) {
        failed = rotor(&s);
    }
    release(&s);
    ranks_end(s.ranks, failed);
    return failed ? 1 : 0;
}
