#include "spar_aerodyn.h"
#include "adi.h"
#include <math.h>
#include <spar/spar.h>
#include <spar/spar_coupling.h>
#include <spar/spar_structure.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* AeroDyn's section and root axes in spar's: x towards the suction side is -z, y is y, z along the span is x. A body's
   axes are its own. */
static const double blade_turn[9] = {0, 0, 1, 0, 1, 0, -1, 0, 0}, no_turn[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};

struct spar_aerodyn {
    spar_aerodyn_options options;
    int blades, points, begun; /* begun: the library holds a rotor, to be ended */
    spar_fluid **sections;
    int64_t *count;                            /* points of each blade */
    double *x, *q, *v, *omega, *accel, *alpha; /* of a blade's sections, as spar gives them */
    float *place, *velocity, *acceleration;    /* of all points, as the library takes them */
    double *axes;
    float *root, *root_velocity, *root_acceleration;
    double *root_axes;
    float *load, *force, *moment, *channel;
    char *names;
    char message[ADI_MESSAGE + 64];
};

typedef struct pose {
    float x[3], v[6], a[6];
    double axes[9];
} pose;

static int say(spar_aerodyn *s, int status, const char *format, ...) {
    va_list list;
    va_start(list, format);
    vsnprintf(s->message, sizeof s->message, format, list);
    va_end(list);
    return status;
}

/* The library's answer as a status. */
static int answer(spar_aerodyn *s, const char *call, int status, char *message) {
    message[ADI_MESSAGE - 1] = '\0';
    return status >= ADI_FATAL ? say(s, SPAR_ERR_USER, "%s: %s", call, message) : SPAR_OK;
}

/* ---- poses ---- */

/* R(q) turn, row-major: columns are the axes asked for. */
static void axes_of(const double q[4], const double turn[9], double axes[9]) {
    const double w = q[0], x = q[1], y = q[2], z = q[3];
    const double r[9] = {1 - 2 * (y * y + z * z), 2 * (x * y - w * z),     2 * (x * z + w * y),
                         2 * (x * y + w * z),     1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
                         2 * (x * z - w * y),     2 * (y * z + w * x),     1 - 2 * (x * x + y * y)};
    for (int i = 0; i < 9; i++) {
        axes[i] = 0;
        for (int k = 0; k < 3; k++) {
            axes[i] += r[3 * (i / 3) + k] * turn[3 * k + i % 3];
        }
    }
}

static void product(const double p[4], const double q[4], double out[4]) {
    out[0] = p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3];
    out[1] = p[0] * q[1] + p[1] * q[0] + p[2] * q[3] - p[3] * q[2];
    out[2] = p[0] * q[2] - p[1] * q[3] + p[2] * q[0] + p[3] * q[1];
    out[3] = p[0] * q[3] + p[1] * q[2] - p[2] * q[1] + p[3] * q[0];
}

static void narrow(int64_t n, const double *from, float *to) {
    for (int64_t i = 0; i < n; i++) {
        to[i] = (float)from[i];
    }
}

static pose pose_of(const spar_aerodyn_body *body) {
    pose p;
    narrow(3, body->x, p.x);
    narrow(6, body->v, p.v);
    narrow(6, body->a, p.a);
    axes_of(body->q, no_turn, p.axes);
    return p;
}

/* Root of blade b: its own frame, turned with node 0; reference: where it was made. */
static int take_root(spar_aerodyn *s, int b, int reference) {
    spar_member *member;
    double x[3], q[4], frame[4], *motion = NULL, *v, *a;
    int64_t nodes;
    int status = spar_fluid_get_member(s->sections[b], &member);
    status = status ? status : spar_member_get_placement(member, x, frame);
    status = status ? status : spar_member_get_count(member, &nodes);
    if (status != SPAR_OK) {
        return status;
    }
    motion = calloc((size_t)(19 * nodes), sizeof *motion);
    if (!motion) {
        return SPAR_ERR_MEMORY;
    }
    v = motion + 7 * nodes;
    a = v + 6 * nodes;
    motion[3] = 1;
    status = reference ? SPAR_OK : spar_member_get_motion(member, motion, v, a);
    if (status == SPAR_OK) {
        for (int i = 0; i < 3; i++) {
            x[i] += motion[i];
        }
        product(motion + 3, frame, q);
        axes_of(q, blade_turn, s->root_axes + 9 * (int64_t)b);
        narrow(3, x, s->root + 3 * (int64_t)b);
        narrow(6, v, s->root_velocity + 6 * (int64_t)b);
        narrow(6, a, s->root_acceleration + 6 * (int64_t)b);
    }
    free(motion);
    return status;
}

/* Sections of blade b, whose points begin at first. */
static int take_sections(spar_aerodyn *s, int b, int64_t first, int reference) {
    const int64_t n = s->count[b];
    int status;
    if (reference) {
        memset(s->v, 0, (size_t)(3 * n) * sizeof *s->v);
        memset(s->omega, 0, (size_t)(3 * n) * sizeof *s->omega);
        memset(s->accel, 0, (size_t)(3 * n) * sizeof *s->accel);
        memset(s->alpha, 0, (size_t)(3 * n) * sizeof *s->alpha);
        status = spar_fluid_get_nearest(s->sections[b], SPAR_NODES_MOTION, s->x, s->q, s->v);
        for (int64_t i = 0; i < 3 * n; i++) { /* from the foot to the node */
            s->x[i] += s->v[i];
            s->v[i] = 0;
        }
    } else {
        status =
            spar_fluid_pull_poses(s->sections[b], SPAR_NODES_MOTION, 1, s->x, s->q, s->v, s->omega, s->accel, s->alpha);
    }
    narrow(3 * n, s->x, s->place + 3 * first);
    for (int64_t i = 0; i < n; i++) {
        axes_of(s->q + 4 * i, blade_turn, s->axes + 9 * (first + i));
        narrow(3, s->v + 3 * i, s->velocity + 6 * (first + i));
        narrow(3, s->omega + 3 * i, s->velocity + 6 * (first + i) + 3);
        narrow(3, s->accel + 3 * i, s->acceleration + 6 * (first + i));
        narrow(3, s->alpha + 3 * i, s->acceleration + 6 * (first + i) + 3);
    }
    return status;
}

static int take_blades(spar_aerodyn *s, int reference) {
    int64_t first = 0;
    for (int b = 0; b < s->blades; b++) {
        int status = take_root(s, b, reference);
        status = status ? status : take_sections(s, b, first, reference);
        if (status != SPAR_OK) {
            return say(s, status, "blade %d: %s", b + 1, spar_status_text(status));
        }
        first += s->count[b];
    }
    return SPAR_OK;
}

/* ---- the library, begun ---- */

static int begin_library(spar_aerodyn *s) {
    const spar_aerodyn_options *o = &s->options;
    const int one = 1, zero = 0;
    const float gravity = (float)o->gravity, density = (float)o->density, viscosity = (float)o->viscosity,
                sound = (float)o->sound, pressure = 101325, vapour = 2000, none = 0, nacelle[6] = {0};
    const double never = 1e30;
    char folder[ADI_TEXT] = "", message[ADI_MESSAGE] = "";
    int status = 0;
    ADI_C_PreInit(&one, &zero, &one, &gravity, &density, &viscosity, &sound, &pressure, &vapour, &none, &none, &zero,
                  &zero, folder, &zero, &zero, &never, nacelle, &none, &zero, &status, message);
    s->begun = 1;
    return answer(s, "ADI_C_PreInit", status, message);
}

static int begin_rotor(spar_aerodyn *s, const spar_aerodyn_body *hub, const spar_aerodyn_body *nacelle) {
    const pose h = pose_of(hub), n = pose_of(nacelle);
    const float origin[3] = {0};
    const int one = 1;
    int status = 0, *blade_of = calloc((size_t)s->points + 1, sizeof *blade_of), k = 0;
    char message[ADI_MESSAGE] = "";
    if (!blade_of) {
        return say(s, SPAR_ERR_MEMORY, "no memory");
    }
    for (int b = 0; b < s->blades; b++) {
        for (int64_t i = 0; i < s->count[b]; i++) {
            blade_of[k++] = b + 1;
        }
    }
    ADI_C_SetupRotor(&one, &one, origin, h.x, h.axes, n.x, n.axes, &s->blades, s->root, s->root_axes, &s->points,
                     s->place, s->axes, blade_of, &status, message);
    free(blade_of);
    return answer(s, "ADI_C_SetupRotor", status, message);
}

/* The library gives velocities in the projection of BEM_Mod 1, whatever the file says. With BEM_Mod 2 it finds no
   induction and says nothing. */
static int look_at_model(spar_aerodyn *s) {
    char line[1024], model[16], name[32];
    FILE *file = fopen(s->options.aerodyn_file, "r");
    int wrong = 0;
    while (file && !wrong && fgets(line, sizeof line, file)) {
        wrong = sscanf(line, "%15s %31s", model, name) == 2 && strcmp(name, "BEM_Mod") == 0 &&
                strcmp(model, "2") == 0; /* NOLINT */
    }
    if (file) { /* a file that is not there is the library's to tell */
        fclose(file);
    }
    return wrong ? say(s, SPAR_ERR_ARGUMENT,
                       "BEM_Mod is 2 in %s: the library serves BEM_Mod 1 alone, and with 2 there is no induction; set "
                       "BEM_Mod to 1",
                       s->options.aerodyn_file)
                 : SPAR_OK;
}

static int begin_run(spar_aerodyn *s) {
    const spar_aerodyn_options *o = &s->options;
    if (strlen(o->aerodyn_file) >= ADI_TEXT || strlen(o->inflow_file) >= ADI_TEXT || strlen(o->output) >= ADI_TEXT) {
        return say(s, SPAR_ERR_ARGUMENT, "AeroDyn's library takes names of %d characters at most", ADI_TEXT - 1);
    }
    const int zero = 0, one = 1, aerodyn = (int)strlen(o->aerodyn_file) + 1, inflow = (int)strlen(o->inflow_file) + 1;
    char output[ADI_TEXT] = "", message[ADI_MESSAGE] = "";
    int status = 0, channels = 0;
    snprintf(output, sizeof output, "%s", o->output);
    ADI_C_Init(&zero, &o->aerodyn_file, &aerodyn, &zero, &o->inflow_file, &inflow, output, &o->order, &o->dt,
               &o->seconds, &one, &zero, &o->dt, &channels, s->names, s->names + ADI_CHANNELS * ADI_CHANNEL_TEXT + 1,
               &status, message);
    return answer(s, "ADI_C_Init", status, message);
}

static int allocate(spar_aerodyn *s, int64_t longest) {
    const size_t one = (size_t)longest, all = (size_t)s->points, blades = (size_t)s->blades;
    double **wide[] = {&s->x, &s->q, &s->v, &s->omega, &s->accel, &s->alpha, &s->axes, &s->root_axes};
    const size_t wide_n[] = {3 * one, 4 * one, 3 * one, 3 * one, 3 * one, 3 * one, 9 * all, 9 * blades};
    float **thin[] = {&s->place, &s->velocity, &s->acceleration, &s->root,   &s->root_velocity, &s->root_acceleration,
                      &s->load,  &s->force,    &s->moment,       &s->channel};
    const size_t thin_n[] = {3 * all,    6 * all, 6 * all, 3 * blades, 6 * blades,
                             6 * blades, 6 * all, 3 * all, 3 * all,    ADI_CHANNELS};
    int good = 1;
    for (size_t i = 0; i < sizeof wide / sizeof wide[0]; i++) {
        *wide[i] = calloc(wide_n[i] + 1, sizeof(double));
        good = good && *wide[i];
    }
    for (size_t i = 0; i < sizeof thin / sizeof thin[0]; i++) {
        *thin[i] = calloc(thin_n[i] + 1, sizeof(float));
        good = good && *thin[i];
    }
    s->names = calloc(2 * (ADI_CHANNELS * ADI_CHANNEL_TEXT + 1), 1);
    return good && s->names ? SPAR_OK : say(s, SPAR_ERR_MEMORY, "no memory");
}

static int take_fluids(spar_aerodyn *s, int blades, spar_fluid *const *sections) {
    int64_t longest = 0, total = 0;
    s->sections = calloc((size_t)blades + 1, sizeof(spar_fluid *));
    s->count = calloc((size_t)blades + 1, sizeof *s->count);
    if (!s->sections || !s->count) {
        return say(s, SPAR_ERR_MEMORY, "no memory");
    }
    s->blades = blades;
    for (int b = 0; b < blades; b++) {
        s->sections[b] = sections[b];
        int status = spar_fluid_get_count(sections[b], SPAR_NODES_MOTION, &s->count[b]);
        if (status != SPAR_OK) {
            return say(s, status, "blade %d: its fluid cannot be asked", b + 1);
        }
        longest = s->count[b] > longest ? s->count[b] : longest;
        total += s->count[b];
    }
    s->points = (int)total;
    return allocate(s, longest);
}

int spar_aerodyn_create(const spar_aerodyn_options *options, int blades, spar_fluid *const *sections,
                        const spar_aerodyn_body *hub, const spar_aerodyn_body *nacelle, spar_aerodyn **aerodyn) {
    spar_aerodyn *s = *aerodyn = calloc(1, sizeof *s);
    if (!s) {
        return SPAR_ERR_MEMORY;
    }
    s->options = *options;
    if (blades < 1 || !(options->dt > 0)) {
        return say(s, SPAR_ERR_ARGUMENT, "AeroDyn needs a blade and dt > 0");
    }
    int status = take_fluids(s, blades, sections);
    status = status ? status : take_blades(s, 1);
    status = status ? status : look_at_model(s);
    status = status ? status : begin_library(s);
    status = status ? status : begin_rotor(s, hub, nacelle);
    return status ? status : begin_run(s);
}

void spar_aerodyn_destroy(spar_aerodyn **aerodyn) {
    spar_aerodyn *s = aerodyn ? *aerodyn : NULL;
    if (!s) {
        return;
    }
    if (s->begun) {
        char message[ADI_MESSAGE];
        int status;
        ADI_C_End(&status, message);
    }
    void *all[] = {s->sections,
                   s->count,
                   s->x,
                   s->q,
                   s->v,
                   s->omega,
                   s->accel,
                   s->alpha,
                   s->place,
                   s->velocity,
                   s->acceleration,
                   s->axes,
                   s->root,
                   s->root_velocity,
                   s->root_acceleration,
                   s->root_axes,
                   s->load,
                   s->force,
                   s->moment,
                   s->channel,
                   s->names};
    for (size_t i = 0; i < sizeof all / sizeof all[0]; i++) {
        free(all[i]);
    }
    free(s);
    *aerodyn = NULL;
}

/* ---- a step ---- */

static int give_motion(spar_aerodyn *s, const spar_aerodyn_body *hub, const spar_aerodyn_body *nacelle) {
    const pose h = pose_of(hub), n = pose_of(nacelle);
    const int one = 1;
    char message[ADI_MESSAGE] = "";
    int status = take_blades(s, 0);
    if (status != SPAR_OK) {
        return status;
    }
    ADI_C_SetRotorMotion(&one, h.x, h.axes, h.v, h.a, n.x, n.axes, n.v, n.a, s->root, s->root_axes, s->root_velocity,
                         s->root_acceleration, &s->points, s->place, s->axes, s->velocity, s->acceleration, &status,
                         message);
    return answer(s, "ADI_C_SetRotorMotion", status, message);
}

static int take_loads(spar_aerodyn *s, double t) {
    const int one = 1;
    float wind[3];
    char message[ADI_MESSAGE] = "";
    int status = 0;
    ADI_C_CalcOutput(&t, s->channel, &status, message);
    if (answer(s, "ADI_C_CalcOutput", status, message) != SPAR_OK) {
        return SPAR_ERR_USER;
    }
    ADI_C_GetRotorLoads(&one, &s->points, s->load, wind, &status, message);
    return answer(s, "ADI_C_GetRotorLoads", status, message);
}

static int give_loads(spar_aerodyn *s) {
    const float *load = s->load;
    for (int b = 0; b < s->blades; b++) {
        for (int64_t i = 0; i < s->count[b]; i++, load += 6) {
            memcpy(s->force + 3 * i, load, 3 * sizeof *load);
            memcpy(s->moment + 3 * i, load + 3, 3 * sizeof *load);
        }
        int status = spar_fluid_push_forces_f32(s->sections[b], s->force, s->moment);
        if (status != SPAR_OK) {
            return say(s, status, "blade %d: the loads are refused", b + 1);
        }
    }
    return SPAR_OK;
}

/* The library counts steps of dt from t = 0, whatever times it is given: with another dt it would go on without a word,
   at a time of its own. */
static int look_at_clock(spar_aerodyn *s, double t, double dt) {
    const double own = s->options.dt;
    if (fabs(dt - own) > 1e-9 * own || fabs(t - own * round(t / own)) > 1e-6 * own) {
        return say(
            s, SPAR_ERR_ARGUMENT,
            "a step of %g s from t = %g s: AeroDyn's library counts steps of the dt that it was made with, %g s, from "
            "t = 0; keep dt, or make the adapter with the dt that is wanted",
            dt, t, own);
    }
    return SPAR_OK;
}

static int advance(spar_aerodyn *s, double t, double dt) {
    const double next = t + dt;
    char message[ADI_MESSAGE] = "";
    int status = look_at_clock(s, t, dt);
    if (status == SPAR_OK) {
        ADI_C_UpdateStates(&t, &next, &status, message);
        status = answer(s, "ADI_C_UpdateStates", status, message);
    }
    return status;
}

int spar_aerodyn_solve(spar_aerodyn *s, double t, double dt, const spar_aerodyn_body *hub,
                       const spar_aerodyn_body *nacelle) {
    int status = give_motion(s, hub, nacelle);
    if (status == SPAR_OK && dt > 0) {
        status = advance(s, t, dt);
    }
    status = status ? status : take_loads(s, t + dt);
    status = status ? status : give_loads(s);
    if (status != SPAR_OK) {
        spar_fluid_fail(s->sections[0], status, s->message);
    }
    return status;
}

void spar_aerodyn_get_force(const spar_aerodyn *s, double force[3]) {
    memset(force, 0, 3 * sizeof *force);
    for (int i = 0; i < s->points; i++) {
        for (int k = 0; k < 3; k++) {
            force[k] += (double)s->load[6 * i + k];
        }
    }
}

double spar_aerodyn_get_channel(const spar_aerodyn *s, int i) {
    return i >= 0 && i < ADI_CHANNELS ? (double)s->channel[i] : 0;
}

const char *spar_aerodyn_message(const spar_aerodyn *s) {
    return s ? s->message : "no memory";
}
