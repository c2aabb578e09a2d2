/* Stability of explicit coupling: see explicit_stability.h. */
#include "explicit_stability.h"

#include <math.h>

/* Blocks of 4 steps contain a large error of each root that is not close to a positive one. Blocks of 16 steps show
   slow growth, to which 4 steps are too rough. */
static const int block_steps[SPARI_GROWTH_BLOCKS] = {4, 16};

static void grow(spari_growth *g, double factor) {
    if (!(factor > 1) || !isfinite(factor)) {
        *g = (spari_growth){0};
        return;
    }
    g->count++;
    g->log_sum += log(factor);
    g->log_square += log(factor) * log(factor);
    g->log_last = log(factor);
}

static void add_to_block(spari_growth_block *b, int steps, const spari_predicted_step *step) {
    static const double LARGE = 0.3, SAME_SIGN = 0.25;
    b->error = fmax(b->error, step->error);
    b->size = fmax(b->size, step->size);
    b->cosine += step->turned;
    if (++b->steps < steps) {
        return;
    }
    /* loads that grow with one sign, as at the beginning of a short pulse, are no instability */
    int counts = b->error > LARGE * b->size && b->cosine <= SAME_SIGN * steps && b->last > 0;
    grow(&b->growth, counts ? b->error / b->last : 0);
    b->last = b->error;
    b->part = b->size > 0 ? b->error / b->size : 0;
    b->error = b->size = b->cosine = 0;
    b->steps = 0;
}

void spari_explicit_stability_add(spari_explicit_stability *is, const spari_predicted_step *step) {
    static const double OPPOSITE = -0.8;
    grow(&is->steps, step->before > 0 && step->turned <= OPPOSITE ? step->error / step->before : 0);
    is->opposed = step->answered <= OPPOSITE ? is->opposed + 1 : 0;
    for (int k = 0; k < SPARI_GROWTH_BLOCKS; k++) {
        add_to_block(&is->block[k], block_steps[k], step);
    }
    is->error = step->error;
    is->size = step->size;
}

typedef struct limit {
    int count;
    double factor; /* of all steps together */
} limit;

/* Whether the growth is large enough for its number of factors, and geometric. Random errors that happen to grow
   scatter. The beat of a wave near two steps per period grows like a power of time: its factors decrease. */
static int is_growth(const spari_growth *g, const limit *limits, int count) {
    if (g->count == 0) {
        return 0;
    }
    double mean = g->log_sum / g->count, square = g->log_square / g->count;
    if (sqrt(fmax(square - mean * mean, 0)) > 0.25 + 0.25 * mean || g->log_last < 0.7 * mean) {
        return 0;
    }
    for (int i = 0; i < count; i++) {
        if (g->count >= limits[i].count && g->log_sum >= log(limits[i].factor)) {
            return 1;
        }
    }
    return 0;
}

/* The limits were chosen by experiment. Of 6 10^5 steps with normally distributed random loads none counts as an
   instability. When an instability is detected, the loads have grown by a factor of 10 to 10^4 (added mass up to 10
   times the mass). */
int spari_explicit_is_unstable(const spari_explicit_stability *is, double *factor) {
    static const double SIGNIFICANT = 0.5;
    static const int OFTEN = 5;
    static const limit of_steps[] = {{10, 10}, {7, 1e2}, {5, 1e4}, {3, 2e3}}, of_blocks[] = {{7, 30}, {5, 1e3}};
    if (is->error > SIGNIFICANT * is->size && is->opposed >= (is->steps.count < OFTEN ? is->steps.count : OFTEN) &&
        is_growth(&is->steps, of_steps, sizeof of_steps / sizeof *of_steps)) {
        *factor = exp(is->steps.log_sum / (double)is->steps.count);
        return is->steps.count + 1;
    }
    for (int k = 0; k < SPARI_GROWTH_BLOCKS; k++) {
        const spari_growth_block *b = &is->block[k];
        const spari_growth *g = &b->growth;
        if (b->steps == 0 && b->part > SIGNIFICANT && is_growth(g, of_blocks, sizeof of_blocks / sizeof *of_blocks)) {
            *factor = exp(g->log_sum / (g->count * block_steps[k]));
            return (g->count + 1) * block_steps[k];
        }
    }
    return 0;
}
