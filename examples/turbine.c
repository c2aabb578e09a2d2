/* The NREL 5-MW turbine in the wind, end to end, with public functions only: tower, nacelle, shaft, drivetrain, hub,
   pitch bearings and blades tied by joints and solved as one; the published controller gives the generator's torque and
   the pitch; blade element momentum theory is the fluid. Rotor speed and pitch follow the wind. Alone or under mpirun,
   where each rank takes the air of its share of the blades. Run it with --help for what can be chosen. */
#include "ranks.h"
#include "rotor_report.h"
#include "turbine_case.h"
#include "turbine_control.h"
#include "turbine_discon.h"
#include "turbine_model.h"
#include "turbine_report.h"
#include "turbine_view.h"
#include <math.h>
#include <spar/spar_output.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

static const double pi = 3.14159265358979323846, standard_gravity = 9.80665;

/* ---- options ---- */

typedef struct options {
    double wind, shear, gust, gust_start, gust_length, seconds, dt, mean, vtk_every;
    double elements, nodes, rho_inf, tolerance;
    double rpm, pitch; /* where the run begins; not finite: the published steady state of the wind */
    double no_plots, quiet, help;
    double case_start;
    const char *out, *data, *kind;
    const char *controller, *controller_input; /* NULL: the published one */
} options;

static const struct {
    const char *name, *value;
    size_t at; /* a number; `most` 0: a text; no value: a flag */
    double least, most;
    const char *help;
} table[] = {
    {"case", "NAME", offsetof(options, kind), 0, 0,
     "gust, parked, idling, pitch-step, emergency-stop [gust]; all but gust without controller"},
    {"case-start", "S", offsetof(options, case_start), 0, 1e9,
     "when pitch step or stop begin, and a gust beside them [2]"},
    {"controller", "LIBRARY", offsetof(options, controller), 0, 0,
     "a shared library with the function DISCON (Bladed's interface) [the published controller]"},
    {"controller-input", "FILE", offsetof(options, controller_input), 0, 0, "its own file, as DISCON.IN"},
    {"wind", "M/S", offsetof(options, wind), 0, 60, "wind at hub height [8; parked, idling 50, at full load 18]"},
    {"shear", "EXPONENT", offsetof(options, shear), -1, 1, "power law of the wind over height [0]"},
    {"gust", "M/S", offsetof(options, gust), -60, 60,
     "height of a 1-cos gust on top [6: through rated wind; parked 10, others 0]"},
    {"gust-start", "S", offsetof(options, gust_start), 0, 1e9, "when it begins [20; other cases: --case-start]"},
    {"gust-length", "S", offsetof(options, gust_length), 1e-3, 1e9, "how long it lasts [20; other cases 5]"},
    {"seconds", "S", offsetof(options, seconds), 1e-6, 1e9, "time to simulate [60]"},
    {"dt", "S", offsetof(options, dt), 1e-7, 10, "time step [0.02]"},
    {"mean", "S", offsetof(options, mean), 1e-6, 1e9, "the table's means are of the last so many seconds [20]"},
    {"rpm", "REV/MIN", offsetof(options, rpm), 0, 100,
     "rotor speed at the start [published, for the wind; parked, idling 0]"},
    {"pitch", "DEG", offsetof(options, pitch), 0, 90,
     "pitch at the start [published, for the wind; parked, idling 90]"},
    {"elements", "N", offsetof(options, elements), 0, 1000, "beam elements of a blade, 0: rigid blades [1]"},
    {"nodes", "N", offsetof(options, nodes), 2, 24, "nodes of an element [10]"},
    {"rho-inf", "R", offsetof(options, rho_inf), 0, 1, "spectral radius of generalised-alpha [0.8]"},
    {"tolerance", "R", offsetof(options, tolerance), 0, 1,
     "change of the loads that ends the coupling's iteration [1e-6]"},
    {"vtk-every", "S", offsetof(options, vtk_every), 0, 1e9,
     "time between pictures for ParaView, of a run on one rank; 0: none [0.5]"},
    {"out", "FOLDER", offsetof(options, out), 0, 0, "where the files go [turbine-out]"},
    {"data", "FOLDER", offsetof(options, data), 0, 0, "the blade's tables [" SPAR_DATA_DIR "/nrel5mw]"},
    {"no-plots", NULL, offsetof(options, no_plots), 0, 0, "no PNG plots (they need gnuplot)"},
    {"quiet", NULL, offsetof(options, quiet), 0, 0, "no progress line"},
    {"help", NULL, offsetof(options, help), 0, 0, "this text"},
};
enum { OPTIONS = sizeof table / sizeof table[0] };

static void print_help(const char *program) {
    printf(
        "usage: %s [options]\n\nThe NREL 5-MW turbine: tower, nacelle, drivetrain, controller and flexible blades in "
        "the wind.\n\n",
        program);
    for (int i = 0; i < OPTIONS; i++) {
        char left[64];
        snprintf(left, sizeof left, "--%s %s", table[i].name, table[i].value ? table[i].value : "");
        printf("  %-24s %s\n", left, table[i].help);
    }
}

static int read_option(options *o, int i, const char *text) {
    char *field = (char *)o + table[i].at, *end;
    if (table[i].most == 0 && table[i].value) {
        memcpy(field, &text, sizeof text);
        return 0;
    }
    double x = table[i].value ? strtod(text, &end) : 1;
    if (table[i].value && (end == text || *end || !(x >= table[i].least && x <= table[i].most))) {
        fprintf(stderr, "turbine: --%s %s: a number from %g to %g is wanted\n", table[i].name, text, table[i].least,
                table[i].most);
        return 1;
    }
    memcpy(field, &x, sizeof x);
    return 0;
}

/* What was not given is the case's. */
static int fill_case(options *o) {
    double wind, gust, rpm, pitch;
    int kind = turbine_case_of(o->kind);
    if (kind < 0) {
        fprintf(stderr, "turbine: --case %s: gust, parked, idling, pitch-step or emergency-stop is wanted\n", o->kind);
        return 1;
    }
    turbine_case_defaults(kind, &wind, &gust, &rpm, &pitch);
    o->wind = isfinite(o->wind) ? o->wind : wind;
    o->gust = isfinite(o->gust) ? o->gust : gust;
    o->gust_start = isfinite(o->gust_start) ? o->gust_start : kind == TURBINE_GUST ? 20 : o->case_start;
    o->gust_length = isfinite(o->gust_length) ? o->gust_length : kind == TURBINE_GUST ? 20 : 5;
    o->rpm = isfinite(o->rpm) ? o->rpm : rpm;
    o->pitch = isfinite(o->pitch) ? o->pitch : pitch;
    return 0;
}

static int read_options(options *o, int argc, char **argv) {
    *o = (options){.wind = NAN,
                   .gust = NAN,
                   .gust_start = NAN,
                   .gust_length = NAN,
                   .seconds = 60,
                   .dt = 0.02,
                   .mean = 20,
                   .vtk_every = 0.5,
                   .elements = 1,
                   .nodes = 10,
                   .rho_inf = 0.8,
                   .tolerance = 1e-6,
                   .rpm = NAN,
                   .pitch = NAN,
                   .out = "turbine-out",
                   .data = SPAR_DATA_DIR "/nrel5mw",
                   .kind = "gust",
                   .case_start = 2};
    for (int k = 1; k < argc; k++) {
        int i = 0;
        while (i < OPTIONS && (strncmp(argv[k], "--", 2) != 0 || strcmp(argv[k] + 2, table[i].name) != 0)) {
            i++;
        }
        if (i == OPTIONS) {
            fprintf(stderr, "turbine: '%s' is no option; --help lists them\n", argv[k]);
            return 1;
        }
        if (table[i].value && k + 1 == argc) {
            fprintf(stderr, "turbine: --%s needs a value\n", table[i].name);
            return 1;
        }
        if (read_option(o, i, table[i].value ? argv[++k] : "") != 0) {
            return 1;
        }
    }
    if (!o->controller != !o->controller_input || (o->controller && turbine_case_of(o->kind) != TURBINE_GUST)) {
        fprintf(stderr, "turbine: --controller and --controller-input go together, and with --case gust\n");
        return 1;
    }
    return fill_case(o) != 0;
}

/* ---- the scene ---- */

typedef struct scene {
    options options;
    spar_session *session;
    turbine turbine;
    turbine_control control; /* of the other cases: their pitch and torque now */
    turbine_discon *discon;
    turbine_case happens;
    turbine_report report;
    turbine_view view;
    char title[160];
    double *motion, *reference; /* of a blade's nodes [7], [3]; of the tower's, if these are more */
    int pictures, rank, ranks;
} scene;

static int complain(const scene *s, int status) {
    const char *text = turbine_message(&s->turbine);
    fprintf(stderr, "\nturbine: %s: %s\n", spar_status_text(status), text[0] ? text : "no memory");
    return status;
}

#define TRY(call)                                                                                                      \
    do {                                                                                                               \
        int status_ = (call);                                                                                          \
        if (status_ != SPAR_OK) {                                                                                      \
            return complain(s, status_);                                                                               \
        }                                                                                                              \
    } while (0)

static double wind_speed(const options *o, double t) {
    double part = (t - o->gust_start) / o->gust_length;
    return o->wind + (part > 0 && part < 1 ? 0.5 * o->gust * (1 - cos(2 * pi * part)) : 0);
}

static void wind_at(const double x[3], double t, void *context, double wind[3]) {
    const options *o = context;
    double speed = wind_speed(o, t), height = fmax(x[2] / turbine_hub_height, 0);
    wind[0] = o->shear != 0 ? speed * pow(height, o->shear) : speed;
    wind[1] = wind[2] = 0;
}

static int solve_air(spar_session *session, double t, double dt, int iteration, void *context) {
    scene *s = context;
    (void)session, (void)iteration;
    return turbine_blow(&s->turbine, wind_at, &s->options, t + dt);
}

static int set_up(scene *s) {
    const options *o = &s->options;
    double rpm, pitch;
    rotor_operating_point(o->wind, &rpm, &pitch);
    rpm = isfinite(o->rpm) ? o->rpm : rpm;
    pitch = (isfinite(o->pitch) ? o->pitch : pitch) * pi / 180;
    const turbine_options how = {.data = o->data,
                                 .elements = (int)o->elements,
                                 .nodes = (int)o->nodes,
                                 .tower_elements = 1,
                                 .tower_nodes = 8,
                                 .pitch = pitch,
                                 .rank = s->rank,
                                 .ranks = s->ranks};
    TRY(ranks_create_session(s->ranks, &s->session));
    TRY(spar_session_set_gravity(s->session, (const double[]){0, 0, -standard_gravity}));
    TRY(spar_session_set_integrator(s->session, o->rho_inf, 1));
    TRY(spar_session_set_coupling(s->session, SPAR_COUPLING_FIXED_POINT, 0, o->tolerance, 30));
    TRY(turbine_create(&s->turbine, s->session, &how));
    TRY(turbine_start(&s->turbine, rpm * pi / 30, wind_at, &s->options, 4));
    turbine_control_begin(&s->control, turbine_gear * rpm * pi / 30, pitch);
    s->happens = (turbine_case){turbine_case_of(o->kind), o->case_start, pitch, s->control.torque};
    TRY(turbine_brake(&s->turbine, s->happens.kind == TURBINE_PARKED));
    int64_t n = s->turbine.blade_nodes > s->turbine.tower_nodes ? s->turbine.blade_nodes : s->turbine.tower_nodes;
    s->motion = calloc((size_t)(7 * n), sizeof *s->motion);
    s->reference = calloc((size_t)(3 * n), sizeof *s->reference);
    snprintf(s->title, sizeof s->title, "NREL 5-MW turbine, %s%s%g m/s%s", s->happens.kind ? o->kind : "",
             s->happens.kind ? ", " : "", o->wind, o->gust != 0 ? " and a gust" : "");
    s->report.out = o->out, s->report.scene = s->title;
    return s->motion && s->reference ? SPAR_OK : complain(s, SPAR_ERR_MEMORY);
}

static void release(scene *s) {
    turbine_discon_close(&s->discon);
    turbine_view_free(&s->view);
    turbine_report_free(&s->report);
    turbine_free(&s->turbine);
    spar_session_destroy(&s->session);
    free(s->motion);
    free(s->reference);
}

/* ---- recording ---- */

/* Tip of a blade, from where that of a straight one is, in axes that turn with the hub: flap across the cone of the
   blades, edge in it. */
static int record_tip(scene *s, int b, double *out) {
    turbine *t = &s->turbine;
    double hub[3], axis[3], q[4], x0[3], root[4], here[3], then[3];
    TRY(turbine_get_hub(t, hub, axis, q));
    TRY(spar_member_get_motion(t->blade[b], s->motion, NULL, NULL));
    TRY(spar_member_get_reference(t->blade[b], s->reference, NULL));
    nrel5mw_rotor level = t->rotor;
    level.pitch = 0;
    nrel5mw_root(&t->data, &level, b, 0, x0, root);
    int64_t tip = t->blade_nodes - 1;
    for (int i = 0; i < 3; i++) {
        here[i] = s->reference[3 * tip + i] + s->motion[7 * tip + i] - hub[i];
        then[i] = s->reference[3 * tip + i] - t->rotor.hub[i];
    }
    turbine_turn_back(q, here, here); /* the hub's turn away */
    turbine_turn_back(root, here, here);
    turbine_turn_back(root, then, then);
    out[0] = -(here[2] - then[2]);
    out[1] = here[1] - then[1];
    return SPAR_OK;
}

static int record(scene *s, double time, int iterations) {
    double *row = turbine_report_row(&s->report), base[6], air[2] = {0, 0}, angle, speed, twist;
    turbine *t = &s->turbine;
    if (!row) {
        return complain(s, SPAR_ERR_MEMORY);
    }
    TRY(turbine_get_shaft(t, &angle, &speed, &twist));
    TRY(spar_member_get_motion(t->tower, s->motion, NULL, NULL));
    TRY(spar_member_get_reaction(t->tower, base));
    row[TURBINE_TIME] = time;
    row[TURBINE_WIND] = wind_speed(&s->options, time);
    row[TURBINE_ROTOR_SPEED] = speed;
    row[TURBINE_PITCH] = s->control.pitch;
    row[TURBINE_GENERATOR] = turbine_gear * s->control.torque;
    row[TURBINE_SHAFT_POWER] = row[TURBINE_GENERATOR] * speed;
    row[TURBINE_POWER] = turbine_efficiency * row[TURBINE_SHAFT_POWER];
    if (t->blown > 0) {
        TRY(spar_aero_get_rotor(t->aero, &air[0], &air[1], NULL));
    }
    ranks_sum(s->ranks, air, 2);
    row[TURBINE_THRUST] = air[0];
    row[TURBINE_AIR_TORQUE] = air[1];
    row[TURBINE_TOP_FORE] = s->motion[7 * (t->tower_nodes - 1)];
    row[TURBINE_TOP_SIDE] = s->motion[7 * (t->tower_nodes - 1) + 1];
    row[TURBINE_BASE_MOMENT] = -base[4];
    row[TURBINE_TWIST] = twist;
    row[TURBINE_AZIMUTH] = angle;
    row[TURBINE_ITERATIONS] = iterations;
    for (int b = 0; b < TURBINE_BLADES; b++) {
        if (record_tip(s, b, row + TURBINE_TIPS + 2 * b) != SPAR_OK) {
            return 1;
        }
    }
    return SPAR_OK;
}

static int take_picture(scene *s, double t) {
    char path[1024], file[64], index[1024];
    snprintf(file, sizeof file, "vtk/turbine_%05d.vtp", s->pictures);
    snprintf(path, sizeof path, "%s/%s", s->options.out, file);
    snprintf(index, sizeof index, "%s/turbine.pvd", s->options.out);
    if (s->pictures++ == 0) {
        remove(index); /* of a run before */
        TRY(turbine_view_create(&s->view, &s->turbine));
    }
    TRY(turbine_view_look(&s->view, &s->turbine));
    if (turbine_view_write_vtk(&s->view, path, t) != 0) {
        return 1;
    }
    return spar_vtk_series_add(index, t, 0, file) == SPAR_OK ? SPAR_OK : complain(s, SPAR_ERR_IO);
}

/* ---- the run ---- */

static int measure(scene *s, turbine_measures *m) {
    for (int b = 0; b < TURBINE_BLADES; b++) {
        TRY(turbine_get_root_moment(&s->turbine, b, s->control.pitch, &m->root_moment[b], &m->in_plane[b]));
    }
    double *motion = s->motion;
    TRY(spar_member_get_motion(s->turbine.tower, NULL, NULL, motion));
    m->top_fore = motion[6 * (s->turbine.tower_nodes - 1)];
    m->top_side = motion[6 * (s->turbine.tower_nodes - 1) + 1];
    return SPAR_OK;
}

/* Asks a controller's library on rank 0; all ranks get what it demands. */
static int ask_library(scene *s, double t, double dt, double angle, double speed) {
    turbine_measures m = {.t = t,
                          .dt = dt,
                          .pitch = s->control.pitch,
                          .generator_speed = turbine_gear * speed,
                          .rotor_speed = speed,
                          .torque = s->control.torque,
                          .power = turbine_efficiency * s->control.torque * turbine_gear * speed,
                          .wind = wind_speed(&s->options, t),
                          .azimuth = fmod(angle, 2 * pi)};
    char message[1024] = "";
    double shared[4] = {0};
    TRY(measure(s, &m));
    if (s->rank == 0) {
        shared[0] = s->discon ? 0
                              : turbine_discon_open(s->options.controller, s->options.controller_input, &s->discon,
                                                    message, sizeof message);
        shared[0] = shared[0] != 0 ? 1 : turbine_discon_step(s->discon, &m, &s->control, message, sizeof message);
        shared[1] = s->control.pitch, shared[2] = s->control.rate, shared[3] = s->control.torque;
    }
    ranks_sum(s->ranks, shared, 4);
    s->control.pitch = shared[1], s->control.rate = shared[2], s->control.torque = shared[3];
    if (shared[0] != 0 && s->rank == 0) {
        fprintf(stderr, "\nturbine: %s\n", message);
    }
    return shared[0] != 0 ? SPAR_ERR_USER : SPAR_OK;
}

/* What the controller sees at t^n decides on torque and pitch until t^{n+1}. Without it: the case's pitch and torque
   at t^{n+1}. */
static int steer(scene *s, double t, double dt) {
    double angle, speed, twist, acceleration;
    if (s->happens.kind != TURBINE_GUST) {
        turbine_case_pitch(&s->happens, t + dt, &s->control.pitch, &s->control.rate, &acceleration);
        s->control.torque = turbine_case_torque(&s->happens, t + dt);
        TRY(turbine_set_torque(&s->turbine, turbine_gear * s->control.torque));
        TRY(turbine_turn_blades(&s->turbine, s->control.pitch, s->control.rate, acceleration));
        return SPAR_OK;
    }
    TRY(turbine_get_shaft(&s->turbine, &angle, &speed, &twist));
    if (s->options.controller) {
        if (ask_library(s, t, dt, angle, speed) != SPAR_OK) {
            return 1;
        }
    } else {
        turbine_control_step(&s->control, turbine_gear * speed, dt);
    }
    TRY(turbine_set_torque(&s->turbine, turbine_gear * s->control.torque));
    TRY(turbine_set_pitch(&s->turbine, s->control.pitch, s->control.rate));
    return SPAR_OK;
}

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* A line on stderr once the run takes longer than two seconds: in place on a terminal, else now and then. */
static void show_progress(const scene *s, double t, double begun, double *shown) {
    int terminal = isatty(STDERR_FILENO);
    double wall = now() - begun, part = t / s->options.seconds;
    if (s->rank != 0 || s->options.quiet != 0 || wall < 2 || wall - *shown < (terminal ? 0.2 : 10)) {
        return;
    }
    *shown = wall;
    fprintf(stderr, "%sturbine: %3.0f %%  t = %.2f s  %.3g x real time  %.0f s to go%s", terminal ? "\r" : "",
            100 * part, t, t / wall, wall / part - wall, terminal ? "   " : "\n");
    fflush(stderr);
}

static int run(scene *s) {
    const options *o = &s->options;
    int64_t steps = (int64_t)ceil(o->seconds / o->dt - 1e-9);
    double begun = now(), shown = 0, picture = 0;
    for (int64_t i = 0; i <= steps; i++) {
        double t = (double)i * o->dt;
        int iterations = 0;
        if (i > 0) {
            if (steer(s, t - o->dt, o->dt) != SPAR_OK) {
                return 1;
            }
            TRY(spar_step(s->session, o->dt, solve_air, s, &iterations));
        }
        if (record(s, t, iterations) != SPAR_OK) {
            return 1;
        }
        if (o->vtk_every > 0 && s->ranks == 1 && t >= picture - 1e-9) {
            picture += o->vtk_every;
            if (take_picture(s, t) != SPAR_OK) {
                return 1;
            }
        }
        show_progress(s, t, begun, &shown);
    }
    if (shown > 0 && isatty(STDERR_FILENO)) {
        fprintf(stderr, "\r%78s\r", "");
    }
    return SPAR_OK;
}

static int turbine_program(scene *s) {
    char folder[1024];
    snprintf(folder, sizeof folder, "%s/vtk", s->options.out);
    if ((s->rank == 0 && rotor_make_folder(folder) != 0) || set_up(s) != SPAR_OK || run(s) != SPAR_OK) {
        return 1;
    }
    if (s->rank != 0) {
        return 0;
    }
    turbine_report_print(&s->report, s->options.mean, stdout);
    if (turbine_report_write(&s->report, s->options.no_plots == 0) != 0) {
        return 1;
    }
    if (s->pictures > 0) {
        printf("  %s/turbine.pvd (for ParaView, %d times)\n", s->options.out, s->pictures);
        return turbine_view_draw(&s->view, s->options.out, s->options.no_plots == 0);
    }
    return 0;
}

int main(int argc, char **argv) {
    scene s = {0};
    ranks_begin(&argc, &argv, &s.rank, &s.ranks);
    int failed = read_options(&s.options, argc, argv);
    if (!failed && s.options.help != 0) {
        if (s.rank == 0) {
            print_help(argv[0]);
        }
    } else if (!failed) {
        failed = turbine_program(&s);
    }
    release(&s);
    ranks_end(s.ranks, failed);
    return failed ? 1 : 0;
}
