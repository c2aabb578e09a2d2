/* A floating body in free decay: a rigid cylinder of 60 m draught whose water line and buoyancy are a 6 x 6 spring to
   the ground with a preload, held by three taut moorings. It is pushed aside in each of its six directions in turn and
   let go; printed are where it rests and the periods.
     floating                       the moorings are links of spar, which only pull
     floating --moordyn LIBRARY     the same lines, solved by MoorDyn (version 2), on three nodes of a fluid */
#include "moordyn.h"

#include <math.h>
#include <spar/spar.h>
#include <spar/spar_coupling.h>
#include <spar/spar_structure.h>
#include <stdio.h>
#include <string.h>

enum { LINES = 3, STEPS = 30000 };

static const double pi = 3.14159265358979323846, g = 9.81, m = 8e6, centre = -40, inertia[3] = {9e9, 9e9, 4e8};
static const double line_stiffness = 4e5, line_length = 590, anchor = 600, depth = 100, water = 1025;

typedef struct scene {
    const char *library; /* of MoorDyn; NULL: links */
    double level;        /* m, of the body when it is created, against that of its weight and buoyancy alone */
    spar_session *session;
    spar_member *body;
    spar_joint *water;
    moordyn *lines;
} scene;

static void line_ends(int k, double level, double fairlead[3], double ground[3]) {
    double a = 2 * pi / LINES * k;
    fairlead[0] = 5 * cos(a), fairlead[1] = 5 * sin(a), fairlead[2] = level - 30;
    ground[0] = anchor * cos(a), ground[1] = anchor * sin(a), ground[2] = -depth;
}

static int moor(const scene *s) {
    int status = SPAR_OK;
    for (int k = 0; k < LINES && status == SPAR_OK; k++) {
        double fairlead[3], ground[3];
        spar_joint *line = NULL;
        line_ends(k, s->level, fairlead, ground);
        status = spar_link_create(s->session, (const char *[]){"east", "north", "south"}[k], s->body, 0, fairlead, NULL,
                                  0, ground, &line);
        status = status == SPAR_OK ? spar_link_set_spring(line, line_stiffness, 0, line_length, 1) : status;
    }
    return status;
}

/* The same lines for MoorDyn: as heavy as the water that they displace, without drag, of five segments. */
static int write_lines(const char *path, double level) {
    const double diameter = 0.1, area = pi * diameter * diameter / 4;
    FILE *file = fopen(path, "w");
    if (!file) {
        (void)fprintf(stderr, "floating: cannot write %s\n", path);
        return SPAR_ERR_IO;
    }
    (void)fprintf(file,
                  "MoorDyn input, written by floating.c\n"
                  "--- LINE TYPES ---\nTypeName Diam Mass/m EA BA/-zeta EI Cd Ca CdAx CaAx\n"
                  "(-) (m) (kg/m) (N) (N-s/-) (N-m^2) (-) (-) (-) (-)\n"
                  "taut %.6g %.10g %.10g -0.8 0 0 0 0 0\n"
                  "--- POINTS ---\nID Attachment X Y Z Mass Volume CdA Ca\n(-) (-) (m) (m) (m) (kg) (m^3) (m^2) (-)\n",
                  diameter, water * area, line_stiffness * line_length);
    for (int k = 0; k < 2 * LINES; k++) {
        double end[2][3];
        line_ends(k % LINES, level, end[0], end[1]);
        const double *x = end[k >= LINES];
        (void)fprintf(file, "%d %s %.15g %.15g %.15g 0 0 0 0\n", k + 1, k < LINES ? "Coupled" : "Fixed", x[0], x[1],
                      x[2]);
    }
    (void)fprintf(file,
                  "--- LINES ---\nID LineType AttachA AttachB UnstrLen NumSegs Outputs\n(-) (-) (-) (-) (m) (-) (-)\n");
    for (int k = 0; k < LINES; k++) {
        (void)fprintf(file, "%d taut %d %d %.10g 5 -\n", k + 1, LINES + k + 1, k + 1, line_length);
    }
    (void)fprintf(file,
                  "--- OPTIONS ---\n0 writeLog\n0.004 dtM\n%g g\n%g WtrDnsty\n%g WtrDpth\n20 TmaxIC\n--- end ---\n", g,
                  water, depth);
    return fclose(file) == 0 ? SPAR_OK : SPAR_ERR_IO;
}

static int moor_by_moordyn(scene *s) {
    double fairlead[LINES][3], ground[3];
    spar_fluid *fluid = NULL;
    for (int k = 0; k < LINES; k++) {
        line_ends(k, s->level, fairlead[k], ground);
    }
    int status = write_lines("floating-lines.txt", s->level);
    status = status == SPAR_OK ? spar_fluid_create(s->body, "moorings", &fluid) : status;
    if (status == SPAR_OK) {
        status = moordyn_open(s->library, "floating-lines.txt", fluid, LINES, fairlead[0], &s->lines);
        if (status != SPAR_OK) {
            (void)fprintf(stderr, "floating: %s\n", moordyn_message());
        }
    }
    return status;
}

/* heave: the water line; roll and pitch: weight and buoyancy; surge, sway and yaw are the moorings' */
static int create_body(scene *s) {
    const double x[3] = {[2] = s->level}, upright[4] = {1, 0, 0, 0};
    const double heave = water * g * pi * 16, preload[6] = {[2] = m * g - heave * s->level};
    const double stiffness[36] = {[14] = heave, [21] = 1.2e9, [28] = 1.2e9};
    double mass[36] = {[4] = m * centre, [9] = -m * centre, [19] = -m * centre, [24] = m * centre}, damping[36] = {0};
    for (int k = 0; k < 3; k++) {
        mass[7 * k] = m, mass[7 * (3 + k)] = inertia[k] + (k < 2 ? m * centre * centre : 0);
        damping[7 * k] = 2e4, damping[7 * (3 + k)] = k < 2 ? 1e7 : 1e6;
    }
    int status = spar_session_create(&s->session);
    if (status == SPAR_OK && (status = spar_session_set_gravity(s->session, (double[]){0, 0, -g})) == SPAR_OK &&
        (status = spar_rigid_create(s->session, "spar", x, upright, mass, &s->body)) == SPAR_OK &&
        (status = spar_member_commit(s->body)) == SPAR_OK) {
        status = spar_spring_create(s->session, "water", s->body, 0, 63, stiffness, damping, preload, &s->water);
    }
    return status;
}

static int step(scene *s, double dt) {
    return spar_step(s->session, dt, s->lines ? moordyn_pull : NULL, s->lines, NULL);
}

/* The body with its moorings. The static solution does not see how MoorDyn's lines respond, so there the body is
   created where the links hold it at rest. */
static int moor_body(scene *s) {
    int status = create_body(s);
    if (status == SPAR_OK && s->library) {
        return moor_by_moordyn(s);
    }
    status = status == SPAR_OK ? moor(s) : status;
    return status == SPAR_OK ? spar_member_solve_static(s->body, 5) : status;
}

/* Free decay in one direction, held aside for the first ten seconds: its period and rest by the upward crossings of
   the place where it started, and the mean between the first and the last of them. */
static int decay(scene *s, int direction, double *period, double *rest) {
    const double dt = 0.02;
    double motion[6] = {0}, before = 0, first = 0, last = 0, pushed[6] = {0}, start = 0, sum = 0, mean = 0;
    int crossings = 0, status = moor_body(s);
    status = status == SPAR_OK ? spar_joint_get_motion(s->water, motion, NULL, NULL) : status;
    start = motion[direction];
    pushed[direction] = direction < 3 ? 2e5 : 2e7;
    for (int i = 0; i < STEPS && status == SPAR_OK; i++) {
        status = i == 0 || i == 500 ? spar_joint_set_load(s->water, i == 0 ? pushed : (double[6]){0}) : SPAR_OK;
        status = status == SPAR_OK ? step(s, dt) : status;
        status = status == SPAR_OK ? spar_joint_get_motion(s->water, motion, NULL, NULL) : status;
        double away = motion[direction] - start;
        sum += away;
        if (i > 600 && before < 0 && away >= 0) {
            last = dt * (i - away / (away - before));
            if (crossings++ == 0) {
                first = last, sum = 0;
            }
            mean = last > first ? sum * dt / (last - first) : 0;
        }
        before = away;
    }
    *period = crossings > 1 ? (last - first) / (crossings - 1) : 0;
    *rest = start + mean + (direction == 2 ? s->level : 0);
    if (status != SPAR_OK && s->session) {
        fprintf(stderr, "%s\n", spar_session_message(s->session));
    }
    moordyn_close(&s->lines);
    spar_session_destroy(&s->session);
    return status;
}

/* Where the links hold the body. */
static int find_level(double *level) {
    double motion[6] = {0};
    scene s = {0};
    int status = moor_body(&s);
    status = status == SPAR_OK ? spar_joint_get_motion(s.water, motion, NULL, NULL) : status;
    *level = motion[2];
    spar_session_destroy(&s.session);
    return status;
}

int main(int argc, char **argv) {
    static const char *const name[6] = {"surge", "sway", "heave", "roll", "pitch", "yaw"};
    const char *library = argc == 3 && strcmp(argv[1], "--moordyn") == 0 ? argv[2] : NULL;
    if (argc > 1 && !library) {
        fprintf(stderr, "usage: floating [--moordyn LIBRARY]\n");
        return 2;
    }
    double level = 0;
    if (library && find_level(&level) != SPAR_OK) {
        return 1;
    }
    for (int k = 0; k < 6; k++) {
        scene s = {.library = library, .level = level};
        double period, rest;
        if (decay(&s, k, &period, &rest) != SPAR_OK) {
            return 1;
        }
        printf("%-6s rest %9.5f %s   period %7.2f s\n", name[k], rest, k < 3 ? "m  " : "rad", period);
        fflush(stdout);
    }
    return 0;
}
