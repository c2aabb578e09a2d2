/* The exact tangent of a body: docs/explanation/theory.md, "The beam". */
#include "tangent.h"

#include "../math/basis.h"

#include <assert.h>

const unsigned char spari_slope_row[2][7][7] = {{{0, 1, 2, 3, 4, 5, 6},
                                                 {1, 7, 8, 9, 10, 11, 12},
                                                 {2, 8, 13, 14, 15, 16, 17},
                                                 {3, 9, 14, 18, 19, 20, 21},
                                                 {4, 10, 15, 19, 22, 23, 24},
                                                 {5, 11, 16, 20, 23, 25, 26},
                                                 {6, 12, 17, 21, 24, 26, 27}},
                                                {{0, 1, 2, 3, 4, 5, 6},
                                                 {28, 7, 8, 9, 10, 11, 12},
                                                 {29, 34, 13, 14, 15, 16, 17},
                                                 {30, 35, 39, 18, 19, 20, 21},
                                                 {31, 36, 40, 43, 22, 23, 24},
                                                 {32, 37, 41, 44, 46, 25, 26},
                                                 {33, 38, 42, 45, 47, 48, 27}}};

/* ---- workspace ---- */

/* Size of a row of node pairs: whole vectors plus one. */
static int64_t row_of_pairs(int P) {
    int64_t pairs = (int64_t)P * (P + 1) / 2;
    return (pairs + SPARI_LANES - 1) / SPARI_LANES * SPARI_LANES + SPARI_LANES;
}

/* Of a residual, followed by that of a tangent: see spari_tangent_work. */
int64_t spari_body_scratch_size(int P, int points, int damped) {
    int64_t slots = ((int64_t)points + SPARI_LANES - 1) / SPARI_LANES * SPARI_LANES;
    int64_t forces = ROW * SPARI_MAX_NODES + BACK * SPARI_MAX_NODES + SPARI_LANES * POINT_ROWS + slots * BACK_ROWS;
    int64_t matrices = slots * (damped ? WHOLE_ROWS + HALF_ROWS + MASS_ROWS : HALF_ROWS + SLOPE_BY_Q + MASS_ROWS);
    int64_t pairs =
        (int64_t)PRODUCTS * points + (damped ? WHOLE_SUMS + HALF_SUMS : HALF_SUMS + SLOPE_BY_Q) + MASS_ROWS + 72;
    return forces + matrices + pairs * row_of_pairs(P) + 36 * (P + (int64_t)SPARI_LANES);
}

/* Takes n doubles from the workspace. */
static double *take_workspace(double **workspace, int64_t n) {
    double *at = *workspace;
    *workspace += n;
    return at;
}

static spari_pair_sums take_sums(double **workspace, int64_t stride, int elastic, int whole) {
    spari_pair_sums s = {.by_q = take_workspace(workspace, SLOPE_BY_Q * stride), .whole = whole};
    if (elastic) {
        s.from[0] = take_workspace(workspace, SLOPES * stride);
        s.from[1] = take_workspace(workspace, SLOPES * stride);
        s.slopes =
            take_workspace(workspace, (whole ? Q_BY_SLOPE - SLOPE_BY_SLOPE : HALF_ROWS - SLOPE_BY_SLOPE) * stride);
        /* for a symmetric matrix, the transpose of the other block */
        s.across[0] = whole ? take_workspace(workspace, SLOPES * stride) : s.from[1];
        s.across[1] = whole ? take_workspace(workspace, SLOPES * stride) : s.from[0];
    }
    return s;
}

static spari_tangent_work begin_tangent(const spari_body *body, int e, const spari_regime *how, int masses, int rates) {
    int P = body->per_element, points = body->first[e + 1] - body->first[e];
    spari_tangent_work t = {.P = P, .points = points, .slots = body->slot[e + 1] - body->slot[e], .masses = masses};
    double *workspace = spari_body_scratch(body);
    t.pairs = (int64_t)P * (P + 1) / 2, t.stride = row_of_pairs(P), t.map_stride = P + SPARI_LANES;
    t.rates = rates, t.elastic = body->C != NULL, t.damped = t.elastic && body->D && rates, t.whole = how->damped;
    t.z = take_workspace(&workspace, ROW * SPARI_MAX_NODES);
    t.g = take_workspace(&workspace, BACK * SPARI_MAX_NODES);
    t.f = take_workspace(&workspace, SPARI_LANES * POINT_ROWS);
    t.back = take_workspace(&workspace, t.slots * BACK_ROWS);
    t.K = take_workspace(&workspace, (t.whole ? WHOLE_ROWS : HALF_ROWS) * t.slots);
    t.B = take_workspace(&workspace, (t.damped ? HALF_ROWS : SLOPE_BY_Q) * t.slots);
    t.M = take_workspace(&workspace, MASS_ROWS * t.slots);
    t.products = take_workspace(&workspace, PRODUCTS * t.stride * points);
    t.of_K = take_sums(&workspace, t.stride, t.elastic, t.whole);
    t.of_B = take_sums(&workspace, t.stride, t.damped, 0);
    t.of_M = take_workspace(&workspace, MASS_ROWS * t.stride);
    t.maps = take_workspace(&workspace, 36 * t.map_stride);
    t.ends[0] = take_workspace(&workspace, 36 * t.stride);
    t.ends[1] = take_workspace(&workspace, 36 * t.stride);
    assert(workspace - spari_body_scratch(body) <= spari_body_scratch_size(P, points, body->D != NULL));
    return t;
}

/* ---- from points to nodes ---- */

/* Sums a stiffness or rate matrix A over the points. */
static void sum_matrix(const spari_body *body, const spari_tangent_work *t, const double *A,
                       const spari_pair_sums *to) {
    spari_lanes_sum(body, t, SLOPE_BY_Q, A, VALUE_VALUE, to->by_q);
    if (to->slopes) {
        const double *slopes = A + t->slots * SLOPE_BY_SLOPE;
        spari_lanes_sum(body, t, SLOPES, A + t->slots * SLOPE_BY_Q, SLOPE_VALUE, to->from[0]);
        spari_lanes_sum(body, t, SLOPES, A + t->slots * SLOPE_BY_Q, VALUE_SLOPE, to->from[1]);
        spari_lanes_sum(body, t, (to->whole ? Q_BY_SLOPE : HALF_ROWS) - SLOPE_BY_SLOPE, slopes, SLOPE_SLOPE,
                        to->slopes);
    }
    if (to->whole) {
        spari_lanes_sum(body, t, SLOPES, A + t->slots * Q_BY_SLOPE, VALUE_SLOPE, to->across[0]);
        spari_lanes_sum(body, t, SLOPES, A + t->slots * Q_BY_SLOPE, SLOPE_VALUE, to->across[1]);
    }
}

void spari_half_turns(const double *q, double h[4][3]) {
    const double c[4][3] = {{-q[1], -q[2], -q[3]}, {q[0], q[3], -q[2]}, {-q[3], q[0], q[1]}, {q[2], -q[1], q[0]}};
    for (int i = 0; i < 12; i++) {
        h[i / 3][i % 3] = 0.5 * c[i / 3][i % 3];
    }
}

/* to (4 x 3) += c m T + (0, w/2) x: products of quaternions, column by column */
static void add_maps(double c, double m[4][3], const double *T, const double *w, double x[4][3], double to[4][3]) {
    for (int j = 0; j < 3; j++) {
        double half[4] = {0, w ? 0.5 * w[0] : 0, w ? 0.5 * w[1] : 0, w ? 0.5 * w[2] : 0}, p[4] = {0};
        const double column[4] = {x[0][j], x[1][j], x[2][j], x[3][j]};
        if (w) {
            spari_quat_mul(half, column, p);
        }
        for (int i = 0; i < 4; i++) {
            to[i][j] += p[i] + c * (m[i][0] * T[j] + m[i][1] * T[3 + j] + m[i][2] * T[6 + j]);
        }
    }
}

/* dq = E dtheta, d(qd) = F dtheta, d(qdd) = H dtheta (4 x 3 each), with dw = cv Tinv dtheta, dalpha = cm Tinv dtheta
   and q' = 1/2 w q, q'' = 1/2 alpha q + 1/2 w q'. */
static void node_maps(const double *z, int node, const double *v, const double *a, double cm, double cv,
                      const double *tinv, double E[4][3], double F[4][3], double H[4][3]) {
    static const double identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    const double *T = tinv ? tinv : identity;
    double by_rate[4][3], rotation[4], rate[4];
    spari_point_rotation(z, node, rotation);
    for (int i = 0; i < 4; i++) {
        rate[i] = z[SPARI_MAX_NODES * (QD + i) + node];
    }
    spari_half_turns(rotation, E);
    spari_half_turns(rate, by_rate);
    add_maps(cv, E, T, v ? v + 3 : NULL, E, F);
    add_maps(cm, E, T, a ? a + 3 : NULL, E, H);
    add_maps(cv, by_rate, T, v ? v + 3 : NULL, F, H);
}

/* The maps of all nodes, followed by zeros. */
static void put_maps(const spari_body *body, int e, const double *v, const double *a, const double *tinv,
                     const spari_tangent_work *t) {
    for (int i = 0; i < 36; i++) {
        memset(t->maps + t->map_stride * i + t->P, 0, SPARI_LANES * sizeof *t->maps);
    }
    for (int l = 0; l < t->P; l++) {
        int64_t node = (int64_t)e * (body->per_element - 1) + l;
        double map[3][4][3] = {{{0}}}, flat[36];
        node_maps(t->z, l, v ? v + 6 * node : NULL, a ? a + 6 * node : NULL, t->cm, t->cv,
                  tinv ? tinv + 9 * node : NULL, map[0], map[1], map[2]);
        memcpy(flat, map, sizeof flat);
        for (int i = 0; i < 36; i++) {
            t->maps[t->map_stride * i + l] = flat[i];
        }
    }
}

void spari_turned_force(double factor, const double *g, const double *q, double *S, int64_t stride) {
    double c[4], p[4], w[3][3];
    spari_quat_conj(q, c);
    spari_quat_mul(g, c, p);
    spari_skew(p + 1, *w);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            S[stride * i + j] -= 0.25 * factor * ((i == j ? p[0] : 0) + w[i][j]);
        }
    }
}

/* The same for all nodes, with their field forces. */
static void add_turned_forces(const spari_body *body, int e, const spari_tangent_work *t, double *S) {
    int64_t stride = 6 * (int64_t)t->P;
    spari_lanes_collect(body, e, t->back, t->g);
    for (int l = 0; l < t->P; l++) {
        double g[4], q[4];
        spari_point_rotation(t->z, l, q);
        for (int i = 0; i < 4; i++) {
            g[i] = t->g[SPARI_MAX_NODES * (3 + i) + l];
        }
        spari_turned_force(1, g, q, S + (stride + 1) * (6 * l + 3), stride);
    }
}

void spari_body_tangent(const spari_body *body, int e, const double *q, const double *v, const double *a, double factor,
                        double cm, double cv, const double *tinv, double *S) {
    cm += body->mass_damping * cv; /* the frame's own turn is left out: what the tangent of a step needs not know */
    const spari_regime how = spari_point_regime(body, v, a, factor);
    int masses = (cm != 0 || a) && body->mass, rates = (cv != 0 || v) && (body->D || masses);
    spari_tangent_work t = begin_tangent(body, e, &how, masses, rates);
    t.cm = cm, t.cv = cv;
    spari_point_gather(body, e, q, v, a, t.z);
    spari_lanes_matrices(body, e, &how, &t);
    spari_lanes_products(body, e, &t);
    sum_matrix(body, &t, t.K, &t.of_K);
    if (rates) {
        sum_matrix(body, &t, t.B, &t.of_B);
    }
    if (masses) {
        spari_lanes_sum(body, &t, MASS_ROWS, t.M, VALUE_VALUE, t.of_M);
    }
    put_maps(body, e, v, a, tinv, &t);
    spari_lanes_project(body, &t, S);
    add_turned_forces(body, e, &t, S);
}

/* The tangent is linear in cm and cv. Large values avoid cancellation: with 1, the mass of a stiff beam would keep few
   digits. out := C (which 0) or M (1), of a tangent with `large` times it beside S. Returns whether S is so large, in
   these units of time, that its rounding counts. */
static int rates_part(const spari_body *body, int e, const double *q, const double *v, const double *a, double factor,
                      const double *S, int which, double large, double *out) {
    double most = 0, most_of_S = 0;
    spari_body_tangent(body, e, q, v, a, factor, which == 1 ? large : 0, which == 0 ? large : 0, NULL, out);
    for (int i = 0; i < 36 * body->per_element * body->per_element; i++) {
        out[i] -= S[i];
        most = fmax(most, fabs(out[i])), most_of_S = fmax(most_of_S, fabs(S[i]));
        out[i] /= large;
    }
    return most > 0 && most < 0x1p20 * most_of_S;
}

void spari_body_rates(const spari_body *body, int e, const double *q, const double *v, const double *a, double factor,
                      const double *S, double *C, double *M) {
    double *out[2] = {C, M};
    for (int k = 0; k < 2; k++) {
        double large = 0x1p60;
        while (out[k] && rates_part(body, e, q, v, a, factor, S, k, large, out[k]) && large < 0x1p240) {
            large *= 0x1p60;
        }
    }
}
