/* Fades of the motion with the distance from the line: weights, lever arms, and what the mesh's Jacobian needs. */
#include "../math/rotation.h"
#include "state.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void spari_fade_free(spari_fade *fade) {
    if (fade) {
        SPARI_FREE(fade->reach, fade->node);
        spari_nodes_free_shortened(fade->nodes);
        free(fade);
    }
}

static spari_fade *allocate(int64_t n) {
    spari_fade *f = spari_zalloc(1, sizeof *f);
    if (f) {
        f->reach = spari_zalloc(n, sizeof *f->reach);
        f->node = spari_zalloc(n, sizeof *f->node);
    }
    if (f && !(f->reach && f->node)) {
        spari_fade_free(f);
        f = NULL;
    }
    return f;
}

spari_fade *spari_fade_copy(const spari_fade *from, int64_t n) {
    spari_fade *f = allocate(n);
    if (f) {
        f->within = from->within, f->beyond = from->beyond;
        memcpy(f->reach, from->reach, (size_t)n * sizeof *f->reach);
        memcpy(f->node, from->node, (size_t)n * sizeof *f->node);
    }
    return f;
}

int spari_fade_map(spari_fade *fade, const spari_nodes *nodes) {
    if (!nodes) {
        return 0;
    }
    spari_nodes *made = spari_nodes_shorten(nodes, fade->reach);
    if (made) {
        spari_nodes_free_shortened(fade->nodes);
        fade->nodes = made;
    }
    return !made;
}

/* 1 at s <= 0, 0 at s >= 1, twice differentiable: linear in the middle, which makes the steepest slope as small as 6/5,
   with quartic ends of length 1/6. */
double spari_fade_weight(double s) {
    double t = s < 0.5 ? s : 1 - s, end = t <= 0 ? 0 : t * t * t * (43.2 - 129.6 * t);
    return t >= 1.0 / 6 ? 0.5 - 1.2 * (s - 0.5) : s < 0.5 ? 1 - end : end;
}

/* Its derivative. */
static double slope_at(double s) {
    double t = s < 0.5 ? s : 1 - s;
    return t <= 0 ? 0 : t >= 1.0 / 6 ? -1.2 : -t * t * (129.6 - 518.4 * t);
}

/* How much of a lever arm rotates: the arm itself up to the length `within`; beyond, its length grows to twice that,
   which it has, twice differentiable, at three times. growth: out, the derivative of the length. */
static double arm_reach(double arm, double within, double *growth) {
    double t = within > 0 ? fmin((arm / 2 - within / 2) / within, 1) : 1;
    *growth = t > 0 ? 1 - t * t * (3 - 2 * t) : 1;
    return t <= 0 ? 1 : within > 0 ? within * (1 + t * (2 - t * t * (2 - t))) / arm : 0;
}

spari_fade *spari_fade_create(int64_t n, const double *arm, const double *tangent, const int *held, double within,
                              double beyond) {
    spari_fade *f = allocate(n);
    double span = beyond / 2 - within / 2; /* halved: both may be large */
    for (int64_t j = 0; f && j < n; j++) {
        spari_fade_node *node = f->node + j;
        double d = spari_norm(arm + 3 * j), steep = slope_at((d / 2 - within / 2) / span) / span / 2;
        f->reach[j] = arm_reach(d, within, &node->growth);
        memcpy(node->tangent, tangent + 3 * j, sizeof node->tangent);
        for (int i = 0; i < 3 && d > 0 && !(held && held[j]); i++) {
            node->slope[i] = steep * arm[3 * j + i] / d;
        }
    }
    if (f) {
        f->within = within, f->beyond = beyond;
    }
    return f;
}
