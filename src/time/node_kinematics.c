/* Generalised-alpha node by node: the kernels for each width of vectors, and which of them serves. */
#include "node_kinematics.h"

#include "../base/status.h"
#include "../math/lanes.h"

#include <math.h>

/* Up to an angle of 1 series in its square are exact to rounding: the cosine of half of it, half the sine by the half,
   and the second order of the inverse tangent operator, |B_2k| / (2k)! with Bernoulli's numbers. */
#define SMALL_TURN 1.0
static const double cosine_series[] = {1,           -1.0 / 2,       1.0 / 24,        -1.0 / 720,
                                       1.0 / 40320, -1.0 / 3628800, 1.0 / 479001600, -1.0 / 87178291200};
static const double sine_series[] = {0.5,          -0.5 / 6,        0.5 / 120,       -0.5 / 5040,
                                     0.5 / 362880, -0.5 / 39916800, 0.5 / 6227020800};
static const double inverse_series[] = {1.0 / 12,
                                        1.0 / 720,
                                        1.0 / 30240,
                                        1.0 / 1209600,
                                        1.0 / 47900160,
                                        691.0 / 1307674368000,
                                        1.0 / 74724249600,
                                        3617.0 / 10670622842880000,
                                        43867.0 / 5109094217170944000,
                                        174611.0 / 802857662698291200000.0};

#define SPARI_KERNELS "../time/node_kinematics_lanes.h"
#include "../math/widths.h"

/* Passes over nodes that tell how large their motions are. */
enum { TAKE, PLACE, SIZE, SIZED };

/* The kernels of one instruction set. */
typedef struct node_kernels {
    int width;
    double (*back)(const spari_node_work *t, int64_t from, int64_t to);
    void (*forth)(const spari_node_work *t, int64_t from, int64_t to);
    spari_node_size (*sized[SIZED])(const spari_node_work *t, int64_t from, int64_t to);
    int64_t (*predict)(const spari_node_work *t, int64_t from, int64_t to);
    void (*correct)(const spari_node_work *t, int64_t from, int64_t to);
    void (*advance)(const spari_node_work *t, int64_t from, int64_t to, spari_node_size *by, spari_node_size *way);
    void (*show)(const spari_root_view *t, int64_t from, int64_t to);
    void (*look)(const spari_root_view *t, int64_t from, int64_t to);
    void (*lose)(const spari_root_jump *t, int64_t from, int64_t to);
} node_kernels;

#define NODE_KERNELS(set)                                                                                              \
    {                                                                                                                  \
        (int)(sizeof(lanes_##set) / sizeof(double)), turn_back_##set, turn_forth_##set,                                \
            {[TAKE] = take_##set, [PLACE] = place_##set, [SIZE] = size_##set}, predict_##set, correct_##set,           \
            advance_##set, show_##set, look_##set, lose_##set                                                          \
    }
static const node_kernels plain_nodes = NODE_KERNELS(plain);
#ifdef SPARI_X86
static const node_kernels avx2_nodes = NODE_KERNELS(avx2), avx512_nodes = NODE_KERNELS(avx512);
#endif

/* For so many nodes: no wider than they are many. */
static const node_kernels *kernels_of(int lanes, int64_t count) {
#ifdef SPARI_X86
    int most = lanes ? lanes : 8, fit = count > 4 ? 8 : count > 2 ? 4 : 2;
    switch (spari_lanes_here(most < fit ? most : fit)) {
    case 8:
        return &avx512_nodes;
    case 4:
        return &avx2_nodes;
    default:
        break;
    }
#endif
    (void)lanes, (void)count;
    return &plain_nodes;
}

/* The kernels for nodes from `from` on, and where they leave off: what is left over beyond whole vectors goes to
   narrower ones where it fits. */
static const node_kernels *kernels_from(int lanes, int64_t from, int64_t to, int64_t *end) {
    const node_kernels *kernel = kernels_of(lanes, to - from);
    int64_t rest = (to - from) % kernel->width;
    *end = kernel != &plain_nodes && 2 * rest <= kernel->width ? to - rest : to;
    return kernel;
}

static spari_node_size larger_of(spari_node_size a, spari_node_size b) {
    return (spari_node_size){fmax(a.way, b.way), fmax(a.turn, b.turn)};
}

static spari_node_size largest_of(int pass, const spari_node_work *t, int64_t from, int64_t to) {
    spari_node_size size = {0, 0};
    for (int64_t end; from < to; from = end) {
        const node_kernels *kernel = kernels_from(t->lanes, from, to, &end);
        size = larger_of(size, kernel->sized[pass](t, from, end));
    }
    return size;
}

double spari_nodes_turn_back(const spari_node_work *t, int64_t from, int64_t to) {
    double most = 0;
    for (int64_t end; from < to; from = end) {
        const node_kernels *kernel = kernels_from(t->lanes, from, to, &end);
        most = fmax(most, kernel->back(t, from, end));
    }
    return most;
}

void spari_nodes_turn_forth(const spari_node_work *t, int64_t from, int64_t to) {
    for (int64_t end; from < to; from = end) {
        kernels_from(t->lanes, from, to, &end)->forth(t, from, end);
    }
}

spari_node_size spari_nodes_take(const spari_node_work *t, int64_t from, int64_t to) {
    return largest_of(TAKE, t, from, to);
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

spari_node_size spari_nodes_place(const spari_node_work *t, int64_t from, int64_t to) {
    return largest_of(PLACE, t, from, to);
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
    return largest_of(SIZE, t, from, to);
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
