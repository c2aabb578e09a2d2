/* A stand-in for AeroDyn's library with the same entry points, so that the adapter can be run and tested without it.
   Its blades are plates of one chord in the wind of an InflowWind file, quasi-steady and without induction; the plate's
   axes are those of the mesh points (x to the suction side, y to the trailing edge, z along the span). It has one state
   with a memory, the impulse of the thrust, and takes the same t a second time as a correction, as the library does. It
   is strict where the library trusts: a call out of order, a matrix that is none or lies the wrong way round, or a step
   that is not dt is fatal. */
#include "adi.h"
#include "plate.h"
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { POINTS_MOST = 512, BLADES_MOST = 8 };
enum { NOTHING, PREPARED, ROTOR, READY };

static struct {
    int stage, blades, points, blade_of[POINTS_MOST], steps, moved;
    double density, wind[3], dt, t_last;
    double length[POINTS_MOST];                         /* to the next point of the blade in the reference, 0: none */
    double place[POINTS_MOST][3], axes[POINTS_MOST][9]; /* axes: row i is local axis i */
    double velocity[POINTS_MOST][3], load[POINTS_MOST][6]; /* load: of the points */
    double hub_axis[3];
    double impulse, impulse_last;
} rotor;

/* Every character of a message is written, as the library's Fortran may do. */
static int fatal(int *status, char *message, const char *text) {
    *status = ADI_FATAL;
    memset(message, 0, ADI_MESSAGE);
    snprintf(message, ADI_MESSAGE, "%s", text);
    return 0;
}

static int good(int *status, char *message) {
    *status = 0;
    memset(message, 0, ADI_MESSAGE);
    return 1;
}

static double dot3(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Rows of a rotation matrix: orthonormal, right-handed. */
static int is_rotation(const double m[9]) {
    double worst = 0;
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++) {
            worst = fmax(worst, fabs(dot3(m + 3 * i, m + 3 * k) - (i == k)));
        }
    }
    const double z[3] = {m[1] * m[5] - m[2] * m[4], m[2] * m[3] - m[0] * m[5], m[0] * m[4] - m[1] * m[3]};
    return worst < 1e-6 && dot3(z, m + 6) > 0;
}

/* As Fortran takes nine numbers for a matrix (row, column): column by column. Local to global, row by row, becomes rows
   that are the local axes. */
static void take_axes(const double *from, double rows[9]) {
    for (int i = 0; i < 9; i++) {
        rows[i] = from[3 * (i % 3) + i / 3];
    }
}

/* ---- what is set once ---- */

void ADI_C_PreInit(const int *turbines, const int *transpose, const int *point_loads, const float *gravity,
                   const float *density, const float *viscosity, const float *sound, const float *pressure,
                   const float *vapour, const float *depth, const float *sea_level, const int *hydrokinetic,
                   const int *external_flow, const char vtk_folder[ADI_TEXT], const int *vtk, const int *vtk_kind,
                   const double *vtk_dt, const float vtk_nacelle[6], const float *vtk_hub_radius, const int *debug,
                   int *status, char message[ADI_MESSAGE]) {
    memset(&rotor, 0, sizeof rotor);
    (void)gravity, (void)viscosity, (void)sound, (void)pressure, (void)vapour, (void)depth, (void)sea_level;
    (void)vtk_folder, (void)vtk_kind, (void)vtk_dt, (void)vtk_nacelle, (void)vtk_hub_radius, (void)debug;
    if (*turbines != 1 || *transpose || !*point_loads || *hydrokinetic || *external_flow || *vtk) {
        fatal(status, message, "one rotor in air, matrices as they are, point loads, no pictures");
        return;
    }
    rotor.density = (double)*density;
    rotor.stage = PREPARED;
    good(status, message);
}

/* Distances between neighbours of a blade. */
static void measure(const float *place) {
    for (int i = 0; i + 1 < rotor.points; i++) {
        double square = 0;
        for (int k = 0; k < 3; k++) {
            const double step = (double)place[3 * i + 3 + k] - (double)place[3 * i + k];
            square += step * step;
        }
        rotor.length[i] = rotor.blade_of[i] == rotor.blade_of[i + 1] ? sqrt(square) : 0;
    }
}

/* The roots' third axis has to point along the blade: to its last mesh point. */
static int roots_point_along(const float *root, const double *root_axes, const float *place) {
    for (int i = 0; i < rotor.points; i++) {
        const int b = rotor.blade_of[i] - 1;
        if (i + 1 < rotor.points && rotor.blade_of[i + 1] == b + 1) {
            continue;
        }
        double rows[9], arm[3];
        take_axes(root_axes + 9 * (int64_t)b, rows);
        for (int k = 0; k < 3; k++) {
            arm[k] = (double)place[3 * i + k] - (double)root[3 * b + k];
        }
        if (!is_rotation(rows) || dot3(rows + 6, arm) < 0.99 * sqrt(dot3(arm, arm))) {
            return 0;
        }
    }
    return 1;
}

void ADI_C_SetupRotor(const int *i, const int *horizontal, const float origin[3], const float hub[3],
                      const double hub_axes[9], const float nacelle[3], const double nacelle_axes[9], const int *blades,
                      const float *root, const double *root_axes, const int *points, const float *place,
                      const double *axes, const int *blade_of, int *status, char message[ADI_MESSAGE]) {
    double rows[9];
    (void)origin, (void)hub, (void)nacelle, (void)nacelle_axes;
    if (rotor.stage != PREPARED || *i != 1 || !*horizontal || *points > POINTS_MOST || *blades > BLADES_MOST) {
        fatal(status, message, "a rotor is made after PreInit, as number 1, with 512 points and 8 blades at most");
        return;
    }
    rotor.blades = *blades;
    rotor.points = *points;
    memcpy(rotor.blade_of, blade_of, (size_t)*points * sizeof *blade_of);
    measure(place);
    take_axes(hub_axes, rows);
    memcpy(rotor.hub_axis, rows, sizeof rotor.hub_axis);
    for (int p = 0; p < *points; p++) {
        take_axes(axes + 9 * (int64_t)p, rotor.axes[p]);
        if (!is_rotation(rotor.axes[p])) {
            fatal(status, message, "a mesh point's matrix is no rotation");
            return;
        }
    }
    if (!roots_point_along(root, root_axes, place)) {
        fatal(status, message, "the third axis of a blade's root does not lie along the blade");
        return;
    }
    rotor.stage = ROTOR;
    good(status, message);
}

/* HWindSpeed of an InflowWind file: the number before the word. */
static int read_wind(const char *path, double *speed) {
    char line[512];
    int found = 0;
    FILE *file = fopen(path, "r");
    while (file && !found && fgets(line, sizeof line, file)) {
        char *end;
        *speed = strtod(line, &end);
        end += strspn(end, " \t");
        found = strncmp(end, "HWindSpeed", 10) == 0;
    }
    if (file) {
        fclose(file);
    }
    return found;
}

/* The files that a primary file names in quotes, beside it. A missing one is told as the library does: each routine
   that it passes adds its name, and the path stands in it more than once. */
static int find_files(const char *path, char text[ADI_MESSAGE]) {
    char line[1024], name[4 * ADI_TEXT], where[512];
    const char *slash = strrchr(path, '/');
    FILE *file = fopen(path, "r"), *one;
    if (!file) {
        snprintf(text, ADI_MESSAGE, "no file %s", path);
        return 0;
    }
    int all = 1;
    while (all && fgets(line, sizeof line, file)) {
        if (sscanf(line, " \"%511[^\"]\"", where) != 1 || !strstr(where, ".dat")) { /* NOLINT */
            continue;
        }
        snprintf(name, sizeof name, "%.*s%s", slash ? (int)(slash + 1 - path) : 0, path, where);
        one = fopen(name, "r");
        all = one != NULL;
        if (one) {
            fclose(one);
        }
    }
    fclose(file);
    for (size_t at = 0; !all && at + 1 < ADI_MESSAGE;) {
        at += (size_t)snprintf(text + at, ADI_MESSAGE - at, "AD_Init:ReadFile: the file \"%s\" was not found. ", name);
    }
    return all;
}

void ADI_C_Init(const int *aerodyn_passed, const char *const *aerodyn, const int *aerodyn_length,
                const int *inflow_passed, const char *const *inflow, const int *inflow_length,
                const char output[ADI_TEXT], const int *order, const double *dt, const double *seconds,
                const int *keep_hub_wind, const int *write, const double *write_dt, int *channels, char *channel_names,
                char *channel_units, int *status, char message[ADI_MESSAGE]) {
    char text[ADI_MESSAGE];
    (void)output, (void)seconds, (void)keep_hub_wind, (void)write, (void)write_dt;
    if (rotor.stage != ROTOR || *aerodyn_passed || *inflow_passed || *order < 1 || *order > 2 || !(*dt > 0) ||
        *aerodyn_length < 1 || *inflow_length != (int)strlen(*inflow) + 1) {
        fatal(status, message, "Init comes after SetupRotor, with paths, order 1 or 2 and dt > 0");
        return;
    }
    if (!find_files(*aerodyn, text)) {
        fatal(status, message, text);
        return;
    }
    if (!read_wind(*inflow, &rotor.wind[0])) {
        fatal(status, message, "no HWindSpeed in the file of InflowWind");
        return;
    }
    rotor.dt = *dt;
    rotor.t_last = -*dt;
    *channels = 1;
    snprintf(channel_names, ADI_CHANNEL_TEXT + 1, "%-20s", "ThrustImpulse");
    snprintf(channel_units, ADI_CHANNEL_TEXT + 1, "%-20s", "(N-s)");
    rotor.stage = READY;
    good(status, message);
}

/* ---- motion in, loads out ---- */

void ADI_C_SetRotorMotion(const int *i, const float hub[3], const double hub_axes[9], const float hub_v[6],
                          const float hub_a[6], const float nacelle[3], const double nacelle_axes[9],
                          const float nacelle_v[6], const float nacelle_a[6], const float *root,
                          const double *root_axes, const float *root_v, const float *root_a, const int *points,
                          const float *place, const double *axes, const float *v, const float *a, int *status,
                          char message[ADI_MESSAGE]) {
    double rows[9];
    (void)hub, (void)hub_v, (void)hub_a, (void)nacelle, (void)nacelle_axes, (void)nacelle_v, (void)nacelle_a;
    (void)root_v, (void)root_a, (void)a;
    if (rotor.stage != READY || *i != 1 || *points != rotor.points) {
        fatal(status, message, "motion comes after Init, of as many points as there were");
        return;
    }
    take_axes(hub_axes, rows);
    memcpy(rotor.hub_axis, rows, sizeof rotor.hub_axis);
    for (int p = 0; p < *points; p++) {
        for (int k = 0; k < 3; k++) {
            rotor.place[p][k] = (double)place[3 * p + k];
            rotor.velocity[p][k] = (double)v[6 * p + k];
        }
        take_axes(axes + 9 * (int64_t)p, rotor.axes[p]);
        if (!is_rotation(rotor.axes[p])) {
            fatal(status, message, "a mesh point's matrix is no rotation");
            return;
        }
    }
    if (!is_rotation(rows) || !roots_point_along(root, root_axes, place)) {
        fatal(status, message, "hub or roots are turned as they cannot be");
        return;
    }
    rotor.moved = 1;
    good(status, message);
}

/* Force and moment per length of a point's plate. */
static void plate_load(int p, double load[6]) {
    const double *x = rotor.axes[p], *y = x + 3, *z = x + 6;
    double w[3];
    for (int k = 0; k < 3; k++) {
        w[k] = rotor.wind[k] - rotor.velocity[p][k];
    }
    const double along = dot3(w, y), across = dot3(w, x), size = hypot(along, across);
    const double scale = 0.5 * rotor.density * plate_chord * size;
    double cl, cd;
    plate_coefficients(atan2(across, along), &cl, &cd);
    for (int k = 0; k < 3; k++) {
        load[k] = scale * ((cd * along - cl * across) * y[k] + (cl * along + cd * across) * x[k]);
        load[3 + k] = scale * plate_chord * size * plate_cm * z[k];
    }
}

/* Loads that are linear between the points, shared consistently. */
static void find_loads(void) {
    double here[6], next[6];
    memset(rotor.load, 0, sizeof rotor.load);
    plate_load(0, next);
    for (int p = 0; p + 1 < rotor.points; p++) {
        memcpy(here, next, sizeof here);
        plate_load(p + 1, next);
        for (int k = 0; k < 6; k++) {
            rotor.load[p][k] += rotor.length[p] / 6 * (2 * here[k] + next[k]);
            rotor.load[p + 1][k] += rotor.length[p] / 6 * (here[k] + 2 * next[k]);
        }
    }
}

static double thrust(void) {
    double sum = 0;
    for (int p = 0; p < rotor.points; p++) {
        sum += dot3(rotor.load[p], rotor.hub_axis);
    }
    return sum;
}

void ADI_C_UpdateStates(const double *t, const double *t_next, int *status, char message[ADI_MESSAGE]) {
    if (rotor.stage != READY || !rotor.moved || fabs(*t_next - *t - rotor.dt) > 1e-6 * rotor.dt) {
        fatal(status, message, "a step is dt long, after motion was given");
        return;
    }
    if (fabs(*t - rotor.t_last) < 1e-6 * rotor.dt) {
        rotor.impulse = rotor.impulse_last; /* the same step once more */
    } else if (fabs(*t - rotor.steps * rotor.dt) < 1e-6 * rotor.dt) {
        rotor.steps++;
        rotor.t_last = *t;
    } else {
        fatal(status, message, "steps follow each other from t = 0");
        return;
    }
    find_loads();
    rotor.impulse_last = rotor.impulse;
    rotor.impulse += rotor.dt * thrust();
    good(status, message);
}

void ADI_C_CalcOutput(const double *t, float *channel_values, int *status, char message[ADI_MESSAGE]) {
    if (rotor.stage != READY || !rotor.moved || fabs(*t - rotor.steps * rotor.dt) > 1e-6 * rotor.dt) {
        fatal(status, message, "loads are those at the end of the last step");
        return;
    }
    find_loads();
    channel_values[0] = (float)rotor.impulse;
    good(status, message);
}

void ADI_C_GetRotorLoads(const int *i, const int *points, float *load, float hub_wind[3], int *status,
                         char message[ADI_MESSAGE]) {
    if (rotor.stage != READY || *i != 1 || *points != rotor.points) {
        fatal(status, message, "no loads yet");
        return;
    }
    for (int p = 0; p < rotor.points; p++) {
        for (int k = 0; k < 6; k++) {
            load[6 * p + k] = (float)rotor.load[p][k];
        }
    }
    for (int k = 0; k < 3; k++) {
        hub_wind[k] = (float)rotor.wind[k];
    }
    good(status, message);
}

void ADI_C_End(int *status, char message[ADI_MESSAGE]) {
    rotor.stage = NOTHING;
    good(status, message);
}
