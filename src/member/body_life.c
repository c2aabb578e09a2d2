/* Allocates and frees bodies, and distributes elements over threads: see body.h. */
#include "body.h"

#include "../base/status.h"
#include "../base/thread_pool.h"
#include "../math/lanes.h"

#include <stdlib.h>

/* Numbers an element's points and slots. Returns the maximum number of points of an element. */
static int number_points(spari_body *body, const int *points) {
    int most = 0;
    for (int e = 0; e < body->elements; e++) {
        body->first[e + 1] = body->first[e] + points[e];
        body->slot[e + 1] = body->slot[e] + (points[e] + SPARI_LANES - 1) / SPARI_LANES * SPARI_LANES;
        most = points[e] > most ? points[e] : most;
    }
    return most;
}

/* Takes n doubles from the memory, aligned to a cache line; NULL: none. */
static double *carve_aligned(double **workspace, int64_t n) {
    double *at = *workspace;
    *workspace += (n + SPARI_LANES - 1) / SPARI_LANES * SPARI_LANES;
    return n > 0 ? at : NULL;
}

/* Allocates the block data in one piece. 0, or 1: no memory. */
static int create_blocks(spari_body *body, int64_t slots, int elastic, int damped, int massive) {
    enum { PARTS = 6 };
    const int64_t P = body->per_element;
    const int64_t count[PARTS] = {
        slots * P * 2, slots, slots * 3, elastic ? slots * 36 : 0, damped ? slots * 36 : 0, massive ? slots * 10 : 0};
    double **part[PARTS] = {&body->shape, &body->weight, &body->tangent, &body->C, &body->D, &body->mass};
    int64_t all = SPARI_LANES;
    for (int k = 0; k < PARTS; k++) {
        all += count[k] + SPARI_LANES;
    }
    if (!(body->lines = spari_zalloc(all, sizeof *body->lines))) {
        return 1;
    }
    double *workspace = body->lines + spari_to_line(body->lines);
    for (int k = 0; k < PARTS; k++) {
        *part[k] = carve_aligned(&workspace, count[k]);
    }
    return 0;
}

spari_body *spari_body_create(int elements, int per_element, const int *points, int elastic, int damped, int massive,
                              spari_workspace *shared, spari_thread_pool *const *pool) {
    spari_body *body = spari_zalloc(1, sizeof *body);
    if (!body) {
        return NULL;
    }
    int64_t P = per_element;
    body->elements = elements;
    body->per_element = per_element;
    body->unique = elements * (per_element - 1) + 1;
    body->gyroscopic = 1;
    int ok = (body->first = spari_zalloc(elements + 1, sizeof *body->first)) != NULL;
    ok = ok && (body->slot = spari_zalloc(elements + 1, sizeof *body->slot));
    int most = ok ? number_points(body, points) : 0;
    int64_t n = ok ? body->first[elements] : 0, slots = ok ? body->slot[elements] : 0;
    /* vector loads read past the last row of phi */
    ok = ok && (body->phi = spari_zalloc(n * P + SPARI_LANES, sizeof *body->phi));
    ok = ok && (body->dphi = spari_zalloc(n * P + SPARI_LANES, sizeof *body->dphi));
    ok = ok && (body->position = spari_zalloc(n * 3, sizeof *body->position));
    const int64_t nodes = 12 * (int64_t)body->unique, scratch = spari_body_scratch_size(per_element, most, damped);
    body->workspace = scratch > nodes ? scratch : nodes;
    body->shared = shared, body->pool = pool;
    ok = ok && spari_workspace_reserve(shared, spari_body_workspace_size(body)) == 0;
    ok = ok && create_blocks(body, slots, elastic, damped, massive) == 0;
    ok = ok && (body->tally = spari_zalloc(2 * (int64_t)spari_body_tiles(body), sizeof *body->tally));
    if (!ok) {
        spari_body_free(body);
        return NULL;
    }
    return body;
}

int spari_body_set_pre(spari_body *body) {
    body->pre = spari_zalloc(6 * (int64_t)body->slot[body->elements], sizeof *body->pre);
    body->pre_part = 1;
    return body->pre == NULL;
}

int spari_body_set_mass_damping(spari_body *body, double mass_damping, double *position) {
    body->seen = spari_zalloc(6 * (int64_t)body->unique, sizeof *body->seen);
    if (!body->seen) {
        return 1;
    }
    body->mass_damping = mass_damping;
    body->node_position = position;
    return 0;
}

/* Lane i of a block := lane j. */
static void copy_lane(double *blocks, int rows, int64_t to, int64_t from) {
    for (int i = 0; blocks && i < rows; i++) {
        SPARI_BLOCK(blocks, rows, to)[SPARI_LANES * i] = SPARI_BLOCK(blocks, rows, from)[SPARI_LANES * i];
    }
}

void spari_body_complete(spari_body *body) {
    int P = body->per_element;
    for (int e = 0; e < body->elements; e++) {
        int n = body->first[e + 1] - body->first[e];
        int64_t slot = body->slot[e];
        for (int k = 0; k < n; k++) {
            double *to = SPARI_BLOCK(body->shape, 2 * P, slot + k);
            for (int l = 0; l < P; l++) {
                int64_t at = (int64_t)(body->first[e] + k) * P + l;
                to[SPARI_LANES * 2 * l] = body->phi[at];
                to[SPARI_LANES * (2 * l + 1)] = body->dphi[at];
            }
        }
        for (int64_t k = slot + n; k < body->slot[e + 1]; k++) {
            copy_lane(body->shape, 2 * P, k, slot + n - 1);
            copy_lane(body->tangent, 3, k, slot + n - 1);
            copy_lane(body->C, 36, k, slot + n - 1);
            copy_lane(body->D, 36, k, slot + n - 1);
            copy_lane(body->pre, 6, k, slot + n - 1);
            copy_lane(body->mass, 10, k, slot + n - 1);
            body->weight[k] = 0;
        }
    }
}

/* ---- elements in tiles ---- */

typedef struct body_sweep {
    const spari_body *body;
    spari_body_work work;
    void *context;
    int odd;
} body_sweep;

static void sweep_tile(const spari_body *body, int tile, spari_body_work work, void *context) {
    int from = tile * SPARI_BODY_TILE, to = from + SPARI_BODY_TILE;
    work(body, tile, from, to < body->elements ? to : body->elements, context);
}

static void sweep_item(void *context, int64_t item, int worker) {
    const body_sweep *s = context;
    (void)worker;
    sweep_tile(s->body, (int)(2 * item) + s->odd, s->work, s->context);
}

void spari_body_sweep(const spari_body *body, spari_body_work work, void *context) {
    int tiles = spari_body_tiles(body);
    spari_thread_pool *pool =
        body->pool && tiles > 3 ? *body->pool : NULL; /* with at least two tiles of either parity */
    if (!spari_thread_pool_is_free(pool) || !spari_thread_pool_workspace(pool, 1, spari_body_workspace_size(body))) {
        for (int tile = 0; tile < tiles; tile++) {
            sweep_tile(body, tile, work, context);
        }
        return;
    }
    body_sweep s = {.body = body, .work = work, .context = context};
    for (s.odd = 0; s.odd < 2; s.odd++) {
        spari_thread_pool_run(pool, (tiles + 1 - s.odd) / 2, sweep_item, &s);
    }
}

double spari_body_mass(const spari_body *b) {
    double sum = 0;
    for (int64_t k = 0; k < b->slot[b->elements] && b->mass; k++) {
        sum += b->weight[k] * *SPARI_BLOCK(b->mass, 10, k);
    }
    return sum;
}

void spari_body_free(spari_body *body) {
    if (!body) {
        return;
    }
    SPARI_FREE(body->node_position, body->seen, body->first, body->slot, body->phi, body->dphi, body->position,
               body->pre, body->lines, body->tally);
    free(body);
}
