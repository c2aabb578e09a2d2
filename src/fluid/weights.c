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
    SPARI_FLUID_REQUIRE_OF(
        fluid, caller, !set->sections, SPAR_ERR_STATE,
        "its motion nodes are sections, which have no weights; give positions with spar_fluid_set_motion_nodes");
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

static void take_weights(spari_node_set *set, double *weight, double *home, spari_fade *fade) {
    SPARI_FREE(set->weight, set->home);
    spari_fade_free(set->fade);
    set->weight = weight, set->home = home, set->fade = fade;
}

/* Takes ownership of the array and of the fade, if any. */
static int use_weights(spar_fluid *fluid, double *weight, spari_fade *fade, const char *caller) {
    const spari_nodes *nodes = fluid->set[SPAR_NODES_MOTION].nodes;
    double *home = reference_positions(fluid);
    if (!weight || !home || (fade && spari_fade_map(fade, nodes))) {
        SPARI_FREE(weight, home);
        spari_fade_free(fade);
        return spari_fluid_refuse(fluid, SPAR_ERR_MEMORY, caller, "no memory for the weights of %lld motion nodes",
                                  (long long)fluid->set[SPAR_NODES_MOTION].n);
    }
    take_weights(&fluid->set[SPAR_NODES_MOTION], weight, home, fade);
    return SPAR_OK;
}

int spar_fluid_set_motion_weights(spar_fluid *fluid, int64_t n, const double *w) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_FLUID_HANDLE(fluid);
    if (n == 0 && !w) {
        SPARI_TRY(spari_fluid_check_idle(fluid, __func__));
        take_weights(&fluid->set[SPAR_NODES_MOTION], NULL, NULL, NULL);
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
    return use_weights(fluid, spari_copy(w, n), NULL, __func__);
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

/* ---- fading ---- */

static void unit(double x[3]) {
    double length = spari_norm(x);
    for (int i = 0; i < 3 && length > 0; i++) {
        x[i] /= length;
    }
}

/* Lever arms of the motion nodes from the line, and its tangents there, 0 at an end; [n][3], free with free(). */
static int look_at_line(const spar_fluid *fluid, double **arm, double **tangent, const char *caller) {
    const spar_member *m = fluid->member;
    int64_t n = fluid->set[SPAR_NODES_MOTION].n;
    SPARI_FLUID_REQUIRE_OF(fluid, caller, m->committed, SPAR_ERR_STATE,
                           "the member is not committed, so distances from its axis are not known; call "
                           "spar_member_commit first, or give distances");
    spari_line *line = spari_line_create(m->mesh.elements, m->mesh.per_element, m->xr);
    double *x = reference_positions(fluid), *nearest = spari_zalloc(3 * n, sizeof *nearest),
           *xi = spari_zalloc(n, sizeof *xi), point[3];
    int *element = spari_zalloc(n, sizeof *element);
    uint8_t *flags = spari_zalloc(n, sizeof *flags);
    int whole = line && x && nearest && xi && element && flags;
    whole = whole && !spari_line_project(line, m->session->pool, fluid->method, n, x, element, xi, nearest, flags);
    for (int64_t j = 0; whole && j < n; j++) {
        for (int i = 0; i < 3; i++) {
            x[3 * j + i] -= nearest[3 * j + i];
        }
        memset(nearest + 3 * j, 0, 3 * sizeof *nearest);
        if (m->mesh.per_element > 1 && !(flags[j] & SPAR_MAP_END)) {
            spari_line_point(line, element[j], xi[j], point, nearest + 3 * j);
            unit(nearest + 3 * j);
        }
    }
    *arm = whole ? x : NULL, *tangent = whole ? nearest : NULL;
    spari_line_free(line);
    SPARI_FREE(whole ? NULL : x, whole ? NULL : nearest, xi, element, flags);
    return whole ? SPAR_OK
                 : spari_fluid_refuse(fluid, SPAR_ERR_MEMORY, caller, "no memory to measure %lld nodes", (long long)n);
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
    double *arm = NULL, *tangent = NULL;
    if (!distance) {
        SPARI_TRY(look_at_line(fluid, &arm, &tangent, __func__));
    }
    double *weight = spari_zalloc(n, sizeof *weight), span = beyond / 2 - within / 2; /* halved: both may be large */
    for (int64_t j = 0; weight && j < n; j++) {
        double at = distance ? distance[j] : spari_norm(arm + 3 * j);
        weight[j] = held && held[j] ? 0 : spari_fade_weight((at / 2 - within / 2) / span);
    }
    spari_fade *fade = arm ? spari_fade_create(n, arm, tangent, held, within, beyond) : NULL;
    if (arm && !fade) {
        free(weight);
        weight = NULL; /* refused as no memory */
    }
    SPARI_FREE(arm, tangent);
    return use_weights(fluid, weight, fade, __func__);
}

/* det of I + w (R - I) M + way slope^T, M the derivative of the shorter arm's end by the node's position. Curvature and
   strain of the line are left out: they act on arms of twice `within` at most. */
static double jacobian(const spari_fade_node *f, double reach, double w, const double q[4], const double way[3]) {
    double e[3] = {f->slope[0], f->slope[1], f->slope[2]}, R[9], M[3][3], F[3][3], unit_q[4] = {q[0], q[1], q[2], q[3]},
           minor[3];
    unit(e);
    spari_quat_normalise(unit_q);
    spari_quat_matrix(unit_q, R);
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++) {
            M[i][k] =
                (1 - reach) * f->tangent[i] * f->tangent[k] + (f->growth - reach) * e[i] * e[k] + (i == k ? reach : 0);
        }
    }
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++) {
            F[i][k] = (i == k) + way[i] * f->slope[k] - w * M[i][k];
            for (int l = 0; l < 3; l++) {
                F[i][k] += w * R[3 * i + l] * M[l][k];
            }
        }
    }
    spari_cross(F[1], F[2], minor);
    return spari_dot(F[0], minor);
}

void spari_fluid_weigh(const spari_node_set *set, int64_t first, int upto, double (*buf)[SPARI_ROW], spari_fold *fold) {
    const spari_fade *fade = set->fade;
    int count = spari_tile_count(set->nodes, first), rows[] = {SPARI_R_RATE, SPARI_R_ACCEL};
    int moves = upto >= SPARI_UPTO_ACCEL ? 2 : upto >= SPARI_UPTO_RATE ? 1 : 0;
    for (int i = 0; i < count; i++) {
        int64_t node = spari_nodes_node(set->nodes, first + i);
        double w = set->weight[node], way[3];
        if (w == 1) { /* the same bits as without weights */
            continue;
        }
        for (int k = 0; k < 3; k++) {
            double *x = &buf[SPARI_R_POSITION + k][i], home = set->home[3 * node + k];
            way[k] = *x - home;
            if (fade) { /* x is the end of the shorter arm */
                way[k] += set->nodes->con[k][first + i] - fade->nodes->con[k][first + i];
            }
            *x = w == 0 ? home : home + w * way[k];
            for (int r = 0; r < moves; r++) {
                double *rate = &buf[rows[r] + k][i];
                *rate = w == 0 ? 0 : w * *rate;
            }
        }
        if (fade && w != 0) {
            const double q[4] = {buf[SPARI_R_QUAT][i], buf[SPARI_R_QUAT + 1][i], buf[SPARI_R_QUAT + 2][i],
                                 buf[SPARI_R_QUAT + 3][i]};
            spari_fold here = {jacobian(fade->node + node, fade->reach[node], w, q, way), node};
            *fold = spari_fold_worse(*fold, here);
        }
    }
}
