/* A floating body in free decay: a rigid cylinder of 60 m draught whose water line and buoyancy are a 6 x 6 spring to
   the ground with a preload, held by three taut moorings, lines that only pull. It is pushed aside in each of its six
   directions in turn and let go; printed are where it rests and the periods. */
#include <math.h>
#include <spar/spar.h>
#include <spar/spar_structure.h>
#include <stdio.h>

static const double pi = 3.14159265358979323846, g = 9.81, m = 8e6, centre = -40, inertia[3] = {9e9, 9e9, 4e8};
static const double line_stiffness = 4e5, line_length = 590, anchor = 600, depth = 100;

static int moor(spar_session *s, spar_member *body) {
    int status = SPAR_OK;
    for (int k = 0; k < 3 && status == SPAR_OK; k++) {
        double a = 2 * pi / 3 * k, fairlead[3] = {5 * cos(a), 5 * sin(a), -30},
               ground[3] = {anchor * cos(a), anchor * sin(a), -depth};
        spar_joint *line = NULL;
        status = spar_link_create(s, (const char *[]){"east", "north", "south"}[k], body, 0, fairlead, NULL, 0, ground,
                                  &line);
        status = status == SPAR_OK ? spar_link_set_spring(line, line_stiffness, 0, line_length, 1) : status;
    }
    return status;
}

/* Free decay in one direction; its period by the time between the first and the last upward crossing of rest. */
static int decay(int direction, double *period, double *rest) {
    const double x[3] = {0}, upright[4] = {1, 0, 0, 0}, preload[6] = {[2] = m * g}, start = direction < 3 ? 0.5 : 0.01,
                 dt = 0.02;
    /* heave: the water line; roll and pitch: weight and buoyancy; surge, sway and yaw are the moorings' */
    const double stiffness[36] = {[14] = 1025 * g * pi * 16, [21] = 1.2e9, [28] = 1.2e9};
    double mass[36] = {[4] = m * centre, [9] = -m * centre, [19] = -m * centre, [24] = m * centre}, damping[36] = {0};
    for (int k = 0; k < 3; k++) {
        mass[7 * k] = m, mass[7 * (3 + k)] = inertia[k] + (k < 2 ? m * centre * centre : 0);
        damping[7 * k] = 2e4, damping[7 * (3 + k)] = k < 2 ? 1e7 : 1e6;
    }
    spar_session *s = NULL;
    spar_member *body = NULL;
    spar_joint *water = NULL;
    double motion[6], before = 0, first = 0, last = 0, pushed[6] = {0};
    int crossings = 0, status = spar_session_create(&s);
    if (status == SPAR_OK && (status = spar_session_set_gravity(s, (double[]){0, 0, -g})) == SPAR_OK &&
        (status = spar_rigid_create(s, "spar", x, upright, mass, &body)) == SPAR_OK &&
        (status = spar_member_commit(body)) == SPAR_OK &&
        (status = spar_spring_create(s, "water", body, 0, 63, stiffness, damping, preload, &water)) == SPAR_OK &&
        (status = moor(s, body)) == SPAR_OK && (status = spar_member_solve_static(body, 5)) == SPAR_OK &&
        (status = spar_joint_get_motion(water, motion, NULL, NULL)) == SPAR_OK) {
        *rest = motion[direction];
        pushed[direction] = start * (direction < 3 ? 4e5 : 2e9); /* held aside for the first seconds, then let go */
    }
    for (int i = 0; i < 30000 && status == SPAR_OK; i++) {
        status = i == 0 || i == 500 ? spar_joint_set_load(water, i == 0 ? pushed : (double[6]){0}) : SPAR_OK;
        status = status == SPAR_OK ? spar_step(s, dt, NULL, NULL, NULL) : status;
        status = status == SPAR_OK ? spar_joint_get_motion(water, motion, NULL, NULL) : status;
        double away = motion[direction] - *rest;
        if (i > 600 && before < 0 && away >= 0) {
            last = dt * (i - away / (away - before));
            first = crossings++ == 0 ? last : first;
        }
        before = away;
    }
    *period = crossings > 1 ? (last - first) / (crossings - 1) : 0;
    if (status != SPAR_OK) {
        fprintf(stderr, "%s\n", spar_session_message(s));
    }
    spar_session_destroy(&s);
    return status;
}

int main(void) {
    static const char *const name[6] = {"surge", "sway", "heave", "roll", "pitch", "yaw"};
    for (int k = 0; k < 6; k++) {
        double period, rest;
        if (decay(k, &period, &rest) != SPAR_OK) {
            return 1;
        }
        printf("%-6s rest %9.5f %s   period %7.2f s\n", name[k], rest, k < 3 ? "m  " : "rad", period);
    }
    return 0;
}
