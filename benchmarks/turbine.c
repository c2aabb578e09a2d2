/* What the rest of a turbine costs beside its three blades: a step of the whole machine (tower, nacelle, shaft, hub,
   bearings: 11 members and joints solved as one) against one of the same blades on driven roots, in the same air.
     turbine                      processor time of both, and their ratio
     turbine roots|machine STEPS
                                  runs one of them so many steps: the difference of two such runs under
                                  `valgrind --tool=callgrind` is the cost of a step */
#include "turbine_control.h"
#include "turbine_model.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static const double rpm = 9.16, step = 0.02, pi = 3.14159265358979323846;

static void wind_at(const double x[3], double t, void *context, double wind[3]) {
    (void)x, (void)t, (void)context;
    wind[0] = 8, wind[1] = wind[2] = 0;
}

static int solve_air(spar_session *s, double t, double dt, int iteration, void *context) {
    (void)s, (void)iteration;
    return turbine_blow(context, wind_at, NULL, t + dt);
}

/* Roots driven round at constant speed, from t to t + dt. */
static int drive(turbine *t, double time) {
    int status = SPAR_OK;
    for (int b = 0; b < TURBINE_BLADES && status == SPAR_OK; b++) {
        double q[7], v[6], a[6];
        nrel5mw_root_motion(&t->data, &t->rotor, b, rpm * pi / 30 * time, rpm * pi / 30, 0, q, v, a);
        status = spar_member_drive(t->blade[b], q, v, a);
    }
    return status;
}

static int steer(turbine *t, turbine_control *c) {
    double angle, speed, twist;
    int status = turbine_get_shaft(t, &angle, &speed, &twist);
    turbine_control_step(c, turbine_gear * speed, step);
    status = status == SPAR_OK ? turbine_set_torque(t, turbine_gear * c->torque) : status;
    return status == SPAR_OK ? turbine_set_pitch(t, c->pitch, c->rate) : status;
}

/* Bent and turning, as the rotor example begins. */
static int start_roots(turbine *t) {
    int status = SPAR_OK;
    double omega[3];
    for (int i = 0; i < 3; i++) {
        omega[i] = rpm * pi / 30 * t->rotor.axis[i];
    }
    for (int round = 0; round <= 4 && status == SPAR_OK; round++) {
        for (int b = 0; b < TURBINE_BLADES && status == SPAR_OK && round > 0; b++) {
            status = spar_member_solve_static(t->blade[b], 4);
        }
        for (int b = 0; b < TURBINE_BLADES && status == SPAR_OK; b++) {
            status = spar_member_set_initial_velocity(t->blade[b], t->rotor.hub, NULL, omega);
        }
        status = status == SPAR_OK ? turbine_blow(t, wind_at, NULL, 0) : status;
    }
    return status;
}

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* A run of some steps: processor time and coupling iterations of a step. */
static int run(int roots, int steps, double *seconds, double *iterations) {
    const turbine_options how = {SPAR_DATA_DIR "/nrel5mw", 1, 10, 1, 8, 0, 0, 1, roots, 0};
    turbine t = {.session = NULL};
    turbine_control c;
    spar_session *s = NULL;
    int status = spar_session_create(&s), sum = 0;
    if (status == SPAR_OK && (status = spar_session_set_gravity(s, (double[]){0, 0, -9.80665})) == SPAR_OK &&
        (status = spar_session_set_integrator(s, 0.8, 1)) == SPAR_OK &&
        (status = spar_session_set_coupling(s, SPAR_COUPLING_FIXED_POINT, 0, 1e-6, 30)) == SPAR_OK &&
        (status = turbine_create(&t, s, &how)) == SPAR_OK) {
        status = roots ? start_roots(&t) : turbine_start(&t, rpm * pi / 30, wind_at, NULL, 4);
    }
    turbine_control_begin(&c, turbine_gear * rpm * pi / 30, 0);
    double since = now();
    for (int i = 1; i <= steps && status == SPAR_OK; i++) {
        int taken = 0;
        status = roots ? drive(&t, step * i) : steer(&t, &c);
        status = status == SPAR_OK ? spar_step(s, step, solve_air, &t, &taken) : status;
        sum += taken;
    }
    *seconds = (now() - since) / steps;
    *iterations = (double)sum / steps;
    if (status != SPAR_OK) {
        fprintf(stderr, "turbine: %s\n", turbine_message(&t));
    }
    turbine_free(&t);
    spar_session_destroy(&s);
    return status;
}

int main(int argc, char **argv) {
    double seconds[2], iterations[2];
    if (argc == 3) {
        return run(strcmp(argv[1], "roots") == 0, atoi(argv[2]), &seconds[0], &iterations[0]) != SPAR_OK;
    }
    for (int roots = 0; roots <= 1; roots++) {
        if (run(roots, 500, &seconds[roots], &iterations[roots]) != SPAR_OK) {
            return 1;
        }
        printf("%-24s %8.3f ms a step, %.2f coupling iterations\n", roots ? "blades on driven roots" : "whole turbine",
               1e3 * seconds[roots], iterations[roots]);
    }
    printf("%-24s %8.2f\n", "ratio", seconds[0] / seconds[1]);
    return 0;
}
