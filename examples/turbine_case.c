#include "turbine_case.h"
#include <math.h>
#include <stddef.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

static const struct {
    const char *name;
    double wind, gust, rpm, pitch;
} cases[] = {{"gust", 8, 6, NAN, NAN},
             {"parked", 50, 10, 0, 90},
             {"idling", 50, 0, 0, 90},
             {"pitch-step", 18, 0, NAN, NAN},
             {"emergency-stop", 18, 0, NAN, NAN}};

/* Pitch drives turn at 8 degrees a second at most. */
static const double fastest = 8 * 3.14159265358979323846 / 180;

int turbine_case_of(const char *name) {
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        if (strcmp(name, cases[i].name) == 0) {
            return (int)i;
        }
    }
    return -1;
}

void turbine_case_defaults(int kind, double *wind, double *gust, double *rpm, double *pitch) {
    *wind = cases[kind].wind;
    *gust = cases[kind].gust;
    *rpm = cases[kind].rpm;
    *pitch = cases[kind].pitch;
}

/* Way of a motion that begins at 0: its speed rises to the fastest within 1 s as half a cosine. */
static double way_at(double t, double rate[2]) {
    const double rise = 1;
    if (t <= 0 || t >= rise) {
        rate[0] = t <= 0 ? 0 : fastest;
        rate[1] = 0;
        return t <= 0 ? 0 : fastest * (t - 0.5 * rise);
    }
    rate[0] = 0.5 * fastest * (1 - cos(pi * t / rise));
    rate[1] = 0.5 * fastest * pi / rise * sin(pi * t / rise);
    return 0.5 * fastest * (t - rise / pi * sin(pi * t / rise));
}

/* Ends as it begins: from the middle on seen from the end. */
void turbine_case_pitch(const turbine_case *c, double t, double *pitch, double *rate, double *acceleration) {
    const double way = c->kind == TURBINE_PITCH_STEP       ? 4 * pi / 180
                       : c->kind == TURBINE_EMERGENCY_STOP ? pi / 2 - c->pitch
                                                           : 0;
    const double length = way / fastest + 1, since = t - c->begins;
    double change[2] = {0, 0}, gone = 0;
    if (way > 0 && since < 0.5 * length) {
        gone = way_at(since, change);
    } else if (way > 0) {
        gone = way - way_at(length - since, change);
        change[1] = -change[1];
    }
    *pitch = c->pitch + gone;
    *rate = change[0];
    *acceleration = change[1];
}

/* It falls within a fifth of a second as half a cosine. */
double turbine_case_torque(const turbine_case *c, double t) {
    const double gone = fmin(fmax((t - c->begins) / 0.2, 0), 1);
    return c->kind == TURBINE_PITCH_STEP       ? c->torque
           : c->kind == TURBINE_EMERGENCY_STOP ? 0.5 * c->torque * (1 + cos(pi * gone))
                                               : 0;
}
