/* Generalised-alpha: its coefficients, and what every member integrated with it does in the same way, however its state
   looks. The members of a session are integrated alike. */
#ifndef SPARI_SCHEME_H
#define SPARI_SCHEME_H

#include "../member/structure.h"

typedef struct spari_scheme {
    double h, alpha_m, alpha_f, beta, gamma;
    double cm, cv, cb; /* d a / d x, d v / d x and d b / d x of the Newton increments x */
    int still;         /* no inertia: equilibrium at each time, rates from the increments */
} spari_scheme;

/* Of substeps h, with the session's spectral radius. */
spari_scheme spari_scheme_of(const spar_member *member, double h);
/* The algorithmic acceleration b^n stands for the acceleration at t^n + (alpha_m - alpha_f) h: with a new h its
   distance from a^n is multiplied with this, where `before` is the step that led to t^n (0: none). */
double spari_scheme_stretch(double before, double h);
/* b := a + ratio (b - a) */
void spari_scheme_stretch_by(double ratio, int n, const double *a, double *b);
/* Loads [unique][6] at the ends of the step, fluid and dead ones; `room` is as large. */
void spari_scheme_loads(const spar_member *member, double *begin, double *end, double *room);
/* load[n] := linear between them, at the part s of the step */
static inline void spari_scheme_load_at(double s, int n, const double *begin, const double *end, double *load) {
    for (int i = 0; i < n; i++) {
        load[i] = (1 - s) * begin[i] + s * end[i];
    }
}

#endif
