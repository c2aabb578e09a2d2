/* Loads pushed several times in a step, each over a part of it: see docs/explanation/theory.md, (T13).
   The load of a part is its mean over the part. The structure needs the load at t^{n+1}; between t^n and t^{n+1} it
     interpolates linearly. The least-squares line through the parts has their mean m, so it conserves their impulse,
     and tends to e at the end of the step. The mean alone would lag by half a step.
   The load in use is f^{n+1} = m + (e - e^n) / 2, which is of second order. Because sum (f^n + f^{n+1}) / 2 = sum m
     + (e^{N+1} + e^N) / 4 - m / 2, where the end terms cancel for steady loads, it conserves the impulse of all
     parts. The choice 2 m - f^n conserves the impulse of each step, but oscillates. */
#include "state.h"

#include <stdlib.h>
#include <string.h>

enum { FORCE, MOMENT };

/* ---- memory ---- */

void spari_parts_free(spari_parts *p) {
    if (!p) {
        return;
    }
    for (int k = 0; k < 2; k++) {
        SPARI_FREE(p->sums[k][0], p->sums[k][1], p->value[k], p->end[k]);
    }
    SPARI_FREE(p->mean, p);
}

int spari_parts_prepare(spar_fluid *fluid) {
    if (fluid->parts) {
        return SPAR_OK;
    }
    spari_parts *p = spari_zalloc(1, sizeof *p);
    int64_t n = 6 * fluid->member->nodes;
    if (!p || !(p->end[0] = spari_zalloc(n, sizeof(double))) || !(p->end[1] = spari_zalloc(n, sizeof(double))) ||
        !(p->mean = spari_zalloc(n, sizeof(double)))) {
        spari_parts_free(p);
        return SPAR_ERR_MEMORY;
    }
    fluid->parts = p;
    return SPAR_OK;
}

/* Allocates sums of n forces or moments. */
static int make_sums(spari_parts *p, int kind, int64_t n) {
    if (p->sums[kind][0] && p->n[kind] == n) {
        return SPAR_OK;
    }
    double *made[3] = {spari_zalloc(6 * n, sizeof(double)), spari_zalloc(6 * n, sizeof(double)),
                       spari_zalloc(3 * n, sizeof(double))};
    if (!made[0] || !made[1] || !made[2]) {
        for (int k = 0; k < 3; k++) {
            free(made[k]);
        }
        return SPAR_ERR_MEMORY;
    }
    SPARI_FREE(p->sums[kind][0], p->sums[kind][1], p->value[kind]);
    p->sums[kind][0] = made[0], p->sums[kind][1] = made[1], p->value[kind] = made[2];
    p->n[kind] = n;
    return SPAR_OK;
}

static int reserve_parts(spar_fluid *fluid, int64_t n, int with_moment) {
    SPARI_TRY(spari_parts_prepare(fluid));
    spari_parts *p = fluid->parts;
    if (p->n[FORCE] != n) {
        p->theta = 0; /* the parts belonged to other nodes */
    }
    SPARI_TRY(make_sums(p, FORCE, n));
    return with_moment ? make_sums(p, MOMENT, n) : SPAR_OK;
}

/* ---- a part ---- */

/* Adds a part from `last` to `theta` to the sums, in the spare arrays. before: there were parts; no load: zeros. */
static void sum_up(spari_parts *p, int kind, int before, double last, double theta, spari_source load) {
    int64_t n = 3 * p->n[kind];
    const double *old = p->sums[kind][0], length = theta - last, middle = 0.5 * (theta + last);
    double *sum = p->sums[kind][1];
    for (int64_t i = 0; i < n; i++) {
        double impulse = load.d || load.f ? length * spari_source_at(load, i / 3, (int)(i % 3)) : 0;
        sum[i] = (before ? old[i] : 0) + impulse;
        sum[n + i] = (before ? old[n + i] : 0) + middle * impulse;
    }
}

/* Means of the parts over [0, theta] (at_end 0), or the values at theta of the least-squares lines. */
static void see(spari_parts *p, int kind, double theta, int at_end) {
    int64_t n = 3 * p->n[kind];
    const double *sum = p->sums[kind][1];
    for (int64_t i = 0; i < n; i++) {
        double mean = sum[i] / theta;
        p->value[kind][i] = at_end ? mean + 6 / theta * (sum[n + i] / theta - 0.5 * sum[i]) : mean;
    }
}

void spari_parts_see(spari_parts *p, double theta, int at_end) {
    see(p, FORCE, theta, at_end);
    if (p->moment_next) {
        see(p, MOMENT, theta, at_end);
    }
}

int spari_parts_add(spar_fluid *fluid, int64_t n, double theta, spari_source force, spari_source moment) {
    const int has_moment = moment.d || moment.f;
    SPARI_TRY(reserve_parts(fluid, n, has_moment));
    spari_parts *p = fluid->parts;
    double last = theta > p->theta ? p->theta : 0; /* otherwise the fluid repeats the step */
    int before = last > 0, had_moment = before && p->moment;
    sum_up(p, FORCE, before, last, theta, force);
    p->moment_next = had_moment || has_moment;
    if (p->moment_next) {
        sum_up(p, MOMENT, had_moment, last, theta, moment);
    }
    return SPAR_OK;
}

void spari_parts_keep(spari_parts *p, double theta) {
    for (int kind = 0; kind < 2; kind++) {
        double *old = p->sums[kind][0];
        p->sums[kind][0] = p->sums[kind][1], p->sums[kind][1] = old;
    }
    p->theta = theta;
    p->moment = p->moment_next;
}

/* ---- the step ---- */

void spari_parts_begin(spar_fluid *fluid) {
    if (fluid->parts) {
        fluid->parts->theta = 0;
        fluid->parts->plain = 0;
    }
}

void spari_parts_accept(spar_fluid *fluid) {
    spari_parts *p = fluid->parts;
    if (!p) {
        return;
    }
    if (p->theta > 0) {
        double *old = p->end[0];
        spari_bins *sums = fluid->bins[SPARI_OF_BEGIN];
        p->end[0] = p->end[1], p->end[1] = old;
        fluid->bins[SPARI_OF_BEGIN] = fluid->bins[SPARI_OF_END], fluid->bins[SPARI_OF_END] = sums;
    }
    p->ended = p->theta > 0 || (p->ended && !p->plain); /* loads that were not pushed stay unchanged */
    spari_parts_begin(fluid);
}
