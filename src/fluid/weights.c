/* Motion weights: motion nodes that follow a fraction of the section's motion, given by the host or decreasing with
   the distance. */
#include "../base/environment.h"
#include "../base/status.h"
#include "../math/rotation.h"
#include "../transfer/projection.h"
#include "state.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Weights are for nodes given by position: sections follow the line fully. */
static int check_weighable(const spar_fluid *fluid, int64_t n, const char *caller) {
    const spari_node_set *set = &fluid->set[SPAR_NODES_MOTION];
    SPARI_TRY(spari_fluid_check_idle(fluid, caller));
    if (set->sections) {
        return spari_fluid_refuse(
            fluid, SPAR_ERR_STATE, caller,
            "its motion nodes are sections, which have no weights; give positions with spar_fluid_set_motion_nodes");
    }
    if (n != set->n) {
        return spari_fluid_refuse(fluid, SPAR_ERR_ARGUMENT, caller,
                                  "%lld weights for %lld motion nodes; set the nodes first, then one weight for each",
                                  (long long)n, (long long)set->n);
    }
    return SPAR_OK;
}

/* The host's positions as given, or after the map from nearest points and lever arms; free with free(). NULL: no
   memory. */
static double *reference_positions(const spar_fluid *fluid) {
    const spari_node_set *set = &fluid->set[SPAR_NODES_MOTION];
    return set->home    ? spari_copy(set->home, 3 * set->n)
           : set->nodes ? spari_fluid_positions(fluid, set->nodes)
                        : spari_copy(set->x, 3 * set->n);
}

static void take_weights(spari_node_set *set, double *weight, double *home) {
    free(set->weight);
    free(set->home);
    set->weight = weight, set->home = home;
}

/* Takes ownership of the array. */
static int use_weights(spar_fluid *fluid, double *weight, const char *caller) {
    double *home = reference_positions(fluid);
    if (!weight || !home) {
        free(weight);
        free(home);
        return spari_fluid_refuse(fluid, SPAR_ERR_MEMORY, caller, "no memory for the weights of %lld motion nodes",
                                  (long long)fluid->set[SPAR_NODES_MOTION].n);
    }
    take_weights(&fluid->set[SPAR_NODES_MOTION], weight, home);
    return SPAR_OK;
}

int spar_fluid_set_motion_weights(spar_fluid *fluid, int64_t n, const double *w) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_FLUID_HANDLE(fluid);
    if (n == 0 && !w) {
        SPARI_TRY(spari_fluid_check_idle(fluid, __func__));
        take_weights(&fluid->set[SPAR_NODES_MOTION], NULL, NULL);
        return SPAR_OK;
    }
    SPARI_TRY(check_weighable(fluid, n, __func__));
    SPARI_FLUID_REQUIRE(fluid, n == 0 || w, SPAR_ERR_ARGUMENT, "the weights are NULL though there are %lld",
                        (long long)n);
    for (int64_t j = 0; j < n; j++) {
        SPARI_FLUID_REQUIRE(fluid, w[j] >= 0 && w[j] <= 1, SPAR_ERR_ARGUMENT,
                            "the weight of motion node %lld is %g; give 0 (fixed) to 1 (moves with the section)",
                            (long long)j, w[j]);
    }
    return use_weights(fluid, spari_copy(w, n), __func__);
}

int spar_fluid_get_motion_weights(const spar_fluid *fluid, double *w) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_FLUID_HANDLE(fluid);
    const spari_node_set *set = spari_fluid_set(fluid, SPAR_NODES_MOTION);
    SPARI_FLUID_REQUIRE(fluid, set->n == 0 || w, SPAR_ERR_ARGUMENT, "the pointer to the weights is NULL");
    for (int64_t j = 0; j < set->n; j++) {
        w[j] = set->weight ? set->weight[j] : 1;
    }
    return SPAR_OK;
}

/* Distances of the motion nodes from the line, [n]; free with free(). */
static int line_distances(const spar_fluid *fluid, double **distance, const char *caller) {
    const spar_member *m = fluid->member;
    int64_t n = fluid->set[SPAR_NODES_MOTION].n;
    *distance = NULL;
    if (!m->committed) {
        return spari_fluid_refuse(fluid, SPAR_ERR_STATE, caller,
                                  "the member is not committed, so distances from its axis are not known; call "
                                  "spar_member_commit first, or give distances");
    }
    spari_line *line = spari_line_create(m->mesh.elements, m->mesh.per_element, m->xr);
    double *x = reference_positions(fluid), *nearest = spari_zalloc(3 * n, sizeof *nearest),
           *xi = spari_zalloc(n, sizeof *xi);
    int *element = spari_zalloc(n, sizeof *element);
    uint8_t *flags = spari_zalloc(n, sizeof *flags);
    int whole = line && x && nearest && xi && element && flags;
    whole = whole && !spari_line_project(line, m->session->pool, fluid->method, n, x, element, xi, nearest, flags);
    if (whole) {
        for (int64_t j = 0; j < n; j++) {
            double arm[3] = {x[3 * j] - nearest[3 * j], x[3 * j + 1] - nearest[3 * j + 1],
                             x[3 * j + 2] - nearest[3 * j + 2]};
            xi[j] = spari_norm(arm);
        }
        *distance = xi, xi = NULL;
    }
    spari_line_free(line);
    free(x);
    free(nearest);
    free(xi);
    free(element);
    free(flags);
    return whole ? SPAR_OK
                 : spari_fluid_refuse(fluid, SPAR_ERR_MEMORY, caller, "no memory to measure %lld nodes", (long long)n);
}

/* 1 at s <= 0, 0 at s >= 1, the first two derivatives 0 at both ends. */
static double quintic_fade(double s) {
    double r = 1 - s;
    return s <= 0 ? 1 : s >= 1 ? 0 : r * r * r * (10 - r * (15 - 6 * r));
}

int spar_fluid_fade_motion(spar_fluid *fluid, double within, double beyond, int64_t n, const double *distance,
                           const int *held) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_FLUID_HANDLE(fluid);
    SPARI_TRY(check_weighable(fluid, n, __func__));
    SPARI_FLUID_REQUIRE(fluid, isfinite(within) && isfinite(beyond) && within < beyond, SPAR_ERR_ARGUMENT,
                        "the blending distances are %g and %g; give two distances in increasing order", within, beyond);
    if (distance) {
        SPARI_TRY(spari_fluid_check_values(fluid, __func__, "distance of motion node", distance, n, 1));
    }
    double *own = NULL;
    if (!distance) {
        SPARI_TRY(line_distances(fluid, &own, __func__));
    }
    double *weight = spari_zalloc(n, sizeof *weight), span = beyond / 2 - within / 2; /* halved: both may be large */
    for (int64_t j = 0; weight && j < n; j++) {
        double at = distance ? distance[j] : own[j];
        weight[j] = held && held[j] ? 0 : quintic_fade((at / 2 - within / 2) / span);
    }
    free(own);
    return use_weights(fluid, weight, __func__);
}

void spari_fluid_weigh(const spari_node_set *set, int64_t first, int upto, double (*buf)[SPARI_ROW]) {
    int count = spari_tile_count(set->nodes, first), rows[] = {SPARI_R_RATE, SPARI_R_ACCEL};
    int moves = upto >= SPARI_UPTO_ACCEL ? 2 : upto >= SPARI_UPTO_RATE ? 1 : 0;
    for (int i = 0; i < count; i++) {
        int64_t node = spari_nodes_node(set->nodes, first + i);
        double w = set->weight[node];
        if (w == 1) { /* the same bits as without weights */
            continue;
        }
        for (int k = 0; k < 3; k++) {
            double *x = &buf[SPARI_R_POSITION + k][i], home = set->home[3 * node + k];
            *x = w == 0 ? home : home + w * (*x - home);
            for (int r = 0; r < moves; r++) {
                double *rate = &buf[rows[r] + k][i];
                *rate = w == 0 ? 0 : w * *rate;
            }
        }
    }
}
