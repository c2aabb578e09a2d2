/* Generalised-alpha on nodes: chooses the kernels, and their nodes. */
#include "node_kinematics_kernels.h"

#include "../math/rotation.h"

#include <math.h>

/* For so many nodes: no wider than the number of nodes. */
static const spari_node_kernels *kernels_of(int lanes, int64_t count) {
    int most = lanes ? lanes : 8, fit = count > 4 ? 8 : count > 2 ? 4 : 2;
    return spari_node_kernels_for(most < fit ? most : fit);
}

/* The kernels for the nodes from `from` on, and the node at which they end. The nodes after the last whole vector go to
   narrower vectors if they fit. */
static const spari_node_kernels *kernels_from(int lanes, int64_t from, int64_t to, int64_t *end) {
    const spari_node_kernels *kernel = kernels_of(lanes, to - from);
    int64_t rest = (to - from) % kernel->width;
    *end = kernel != &spari_node_kernels_plain && 2 * rest <= kernel->width ? to - rest : to;
    return kernel;
}

static spari_node_size larger_of(spari_node_size a, spari_node_size b) {
    return (spari_node_size){spari_larger(a.way, b.way), spari_larger(a.rotation, b.rotation)};
}

static spari_node_size largest_of(int pass, const spari_node_work *t, int64_t from, int64_t to) {
    spari_node_size size = {0, 0};
    for (int64_t end; from < to; from = end) {
        const spari_node_kernels *kernel = kernels_from(t->lanes, from, to, &end);
        size = larger_of(size, kernel->sized[pass](t, from, end));
    }
    return size;
}

double spari_nodes_rotate_back(const spari_node_work *t, int64_t from, int64_t to) {
    double most = 0;
    for (int64_t end; from < to; from = end) {
        const spari_node_kernels *kernel = kernels_from(t->lanes, from, to, &end);
        most = fmax(most, kernel->back(t, from, end));
    }
    return most;
}

void spari_nodes_rotate_forth(const spari_node_work *t, int64_t from, int64_t to) {
    for (int64_t end; from < to; from = end) {
        kernels_from(t->lanes, from, to, &end)->forth(t, from, end);
    }
}

spari_node_size spari_nodes_take(const spari_node_work *t, int64_t from, int64_t to) {
    return largest_of(SPARI_SIZED_BY_TAKE, t, from, to);
}

void spari_nodes_predict(const spari_node_work *t, spari_guess stays, int64_t from, int64_t to) {
    int64_t i = 6 * from;
    if (stays == SPARI_KEEP_ACCELERATION && t->c->rule == SPARI_ALPHA) {
        i = kernels_of(t->lanes, to - from)->predict(t, i, 6 * to);
    }
    const spari_rates before = {t->from->v + i, t->from->a + i, t->from->b + i, t->stage ? t->stage + i : NULL},
                      after = {t->to->v + i, t->to->a + i, t->to->b + i, NULL};
    spari_scheme_predict(t->c, stays, (int)(6 * to - i), before, t->x + i, after);
}

void spari_nodes_correct(const spari_node_work *t, int64_t from, int64_t to) {
    kernels_of(t->lanes, to - from)->correct(t, from, to);
}

spari_node_size spari_nodes_positions(const spari_node_work *t, int64_t from, int64_t to) {
    return largest_of(SPARI_SIZED_BY_POSITION, t, from, to);
}

void spari_nodes_advance(const spari_node_work *t, int64_t from, int64_t to, spari_node_size *by,
                         spari_node_size *way) {
    *by = *way = (spari_node_size){0, 0};
    for (int64_t end; from < to; from = end) {
        spari_node_size size, went;
        kernels_from(t->lanes, from, to, &end)->advance(t, from, end, &size, &went);
        *by = larger_of(*by, size);
        *way = larger_of(*way, went);
    }
}

spari_node_size spari_nodes_size(const spari_node_work *t, int64_t from, int64_t to) {
    return largest_of(SPARI_SIZED_BY_SIZE, t, from, to);
}

void spari_nodes_show(const spari_root_view *t, int64_t from, int64_t to) {
    for (int64_t end; from < to; from = end) {
        kernels_from(t->lanes, from, to, &end)->show(t, from, end);
    }
}

void spari_nodes_look(const spari_root_view *t, int64_t from, int64_t to) {
    for (int64_t end; from < to; from = end) {
        kernels_from(t->lanes, from, to, &end)->look(t, from, end);
    }
}

void spari_nodes_lose(const spari_root_jump *t, int64_t from, int64_t to) {
    for (int64_t end; from < to; from = end) {
        kernels_from(t->lanes, from, to, &end)->lose(t, from, end);
    }
}
