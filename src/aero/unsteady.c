/* First-order lags of induced velocities, shed wake and separation point: see unsteady.h. */
#include "unsteady.h"

#include <math.h>
#include <spar/spar_aero.h>

/* Jones' approximation of Wagner's function. */
static const double jones_share[2] = {0.165, 0.335}, jones_rate[2] = {0.0455, 0.3};
/* Fraction of the quasi-steady induced velocity that acts without the first lag (Oye). */
static const double oye_lead = 0.6;

double spari_lag(double y, double u0, double u1, double x) {
    double fading = x > 0.0 ? -expm1(-x) / x : 1.0; /* mean of exp(-s) over the step */
    return u1 - (u1 - u0) * fading + (y - u0) * exp(-x);
}

/* Whether the state of an effect continues from the step before. */
static int goes_on(const spari_passage *step, int effect) {
    double begun = step->was->begun;
    return step->dt > 0.0 && begun > 0.0 && begun < 2.0 * SPAR_AERO_UNSTEADY && ((int)begun & effect) != 0;
}

/* Step size in units of the time constant, whose rate changes over the step. */
static double spent(const spari_passage *step, double from, double to) {
    return 0.5 * (from + to) * step->dt;
}

static void note_effect(const spari_passage *step, int effect) {
    step->is->begun += effect;
}

double spari_inflow_rate(double a, double wind, double radius) {
    return (1.0 - 1.3 * fmin(a, 0.5)) * wind / (1.1 * radius);
}

void spari_inflow_step(const spari_passage *step, double rate, double share, const double quasi[2], double lagged[2]) {
    double slow = 0.39 - 0.26 * fmin(share * share, 1.0), part = (1.0 - oye_lead) / (1.0 - slow);
    int on = goes_on(step, SPAR_AERO_INFLOW);
    double x = on ? spent(step, step->was->inflow.rate, rate) : 0.0;
    step->is->inflow.rate = rate;
    for (int i = 0; i < 2; i++) {
        const double *was = step->was->inflow.lag[i];
        double from = step->was->inflow.quasi[i], *is = step->is->inflow.lag[i];
        is[0] = on ? spari_lag(was[0], from, quasi[i], x) : quasi[i];
        is[1] = on ? spari_lag(was[1], from, quasi[i], x / slow) : quasi[i];
        step->is->inflow.quasi[i] = quasi[i];
        lagged[i] = part * is[0] + (1.0 - part) * is[1];
    }
    note_effect(step, SPAR_AERO_INFLOW);
}

double spari_wake_step(const spari_passage *step, double rate, double downwash) {
    int on = goes_on(step, SPAR_AERO_UNSTEADY);
    double x = on ? spent(step, step->was->wake.rate, rate) : 0.0, acts = downwash;
    for (int i = 0; i < 2; i++) {
        double y =
            on ? spari_lag(step->was->wake.lag[i], step->was->wake.downwash, downwash, jones_rate[i] * x) : downwash;
        step->is->wake.lag[i] = y;
        acts += jones_share[i] * (y - downwash);
    }
    step->is->wake.rate = rate;
    step->is->wake.downwash = downwash;
    note_effect(step, SPAR_AERO_UNSTEADY);
    return acts;
}

double spari_attached_part(double ratio) {
    double root = 2.0 * sqrt(fmax(ratio, 0.25)) - 1.0; /* Kirchhoff: ratio = ((1 + sqrt(f)) / 2)^2 */
    return fmin(root * root, 1.0);
}

/* (attached - lift) / (1 - f) without its removable singularity at f = 1. */
double spari_attached_gain(double lift, double attached) {
    double ratio = attached != 0.0 ? lift / attached : 1.0;
    if (!(ratio > 0.25)) {
        return attached - lift;
    }
    double root = sqrt(ratio);
    return attached * (1.0 + root) / (4.0 * root);
}

double spari_stall_step(const spari_passage *step, double rate, double target) {
    int on = goes_on(step, SPAR_AERO_STALL);
    double part = target;
    if (on) {
        part =
            spari_lag(step->was->stall.part, step->was->stall.target, target, spent(step, step->was->stall.rate, rate));
    }
    step->is->stall.rate = rate;
    step->is->stall.target = target;
    step->is->stall.part = part;
    note_effect(step, SPAR_AERO_STALL);
    return part;
}
