/* Generalised-alpha on W nodes at once, one in each lane of a vector, for one vector width (math/lanes.h).
   docs/explanation/theory.md, "Time".

   Lanes are independent and nothing is fused, so the numbers of a node have the same bits at every width. */
#include "node_kinematics_kernels.h"

#include "../base/status.h"

#include <math.h>

#ifdef SPARI_HAS_OBJECT
#define SPARI_WIDTH SPARI_OBJECT_WIDTH
#include "../math/width.h"

#include "../math/rotation_lanes.h"

/* Coefficients of series in the square of the angle, exact to rounding up to an angle of 1: the cosine of half the
   angle, half the sine of the half divided by it, and the second order of the inverse tangent operator, |B_2k| / (2k)!
   with Bernoulli's numbers. */
#define SMALL_ROTATION 1.0
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

/* All nodes of a span: whole vectors, then the remaining nodes. */
#undef EACH_BLOCK
#define EACH_BLOCK(from, to, work)                                                                                     \
    for (int64_t i = (from), at[W]; i < (to); i += W) {                                                                \
        if (NAME(next_nodes)((to)-i, at)) {                                                                            \
            work(1)                                                                                                    \
        } else {                                                                                                       \
            work(0)                                                                                                    \
        }                                                                                                              \
    }

/* ---- the exponential map ---- */

/* c[0] + c[1] x + c[2] x^2 + ..., in pairs and pairs of pairs: a vector waits for four products in a row, not for n. */
HERE L NAME(series)(const int n, const double *c, L x) {
    L y[5], power = x;
    SPARI_UNROLL
    for (int k = 0; k < n; k += 2) {
        y[k / 2] = SPLAT(c + k);
        if (k + 1 < n) {
            y[k / 2] = y[k / 2] + x * SPLAT(c + k + 1);
        }
    }
    SPARI_UNROLL
    for (int m = (n + 1) / 2; m > 1; m = (m + 1) / 2) {
        power = power * power;
        SPARI_UNROLL
        for (int k = 0; k < m; k += 2) {
            y[k / 2] = k + 1 < m ? y[k] + power * y[k + 1] : y[k];
        }
    }
    return y[0];
}

/* The lanes whose angle is too large for the series. */
TARGET SPARI_APART static void NAME(large_rotations)(const double *square, double *cosine, double *sine) {
    for (int l = 0; l < W; l++) {
        double half = 0.5 * sqrt(square[l]);
        if (square[l] > SMALL_ROTATION) {
            cosine[l] = cos(half);
            sine[l] = 0.5 * sin(half) / half;
        }
    }
}

/* The unit quaternion of the rotation vector psi. */
HERE void NAME(quat_exp)(const L *psi, L *q) {
    const double small = SMALL_ROTATION;
    L square = NAME(dot)(psi, psi), quarter = 0.25 * square;
    L cosine = NAME(series)(8, cosine_series, quarter), sine = NAME(series)(7, sine_series, quarter);
    if (NAME(any_above)(square, SPLAT(&small))) {
        double p2[W], c[W], s[W];
        NAME(put)(p2, square);
        NAME(put)(c, cosine);
        NAME(put)(s, sine);
        NAME(large_rotations)(p2, c, s);
        cosine = NAME(get)(c);
        sine = NAME(get)(s);
    }
    q[0] = cosine;
    for (int i = 0; i < 3; i++) {
        q[1 + i] = sine * psi[i];
    }
}

TARGET SPARI_APART static void NAME(large_inverses)(const double *square, double *second) {
    for (int l = 0; l < W; l++) {
        if (square[l] > SMALL_ROTATION) {
            double half = 0.5 * sqrt(square[l]);
            second[l] = (1 - half * cos(half) / sin(half)) / square[l];
        }
    }
}

/* y := T^-1 y, the inverse of the tangent operator of psi, T^-1 = I - psi~/2 + (1 - (p/2) cot(p/2))/p^2 psi~^2 */
HERE void NAME(tangent_inverse)(const L *psi, L *y) {
    const double small = SMALL_ROTATION;
    L square = NAME(dot)(psi, psi), second = NAME(series)(10, inverse_series, square), once[3], twice[3];
    if (NAME(any_above)(square, SPLAT(&small))) {
        double p2[W], b[W];
        NAME(put)(p2, square);
        NAME(put)(b, second);
        NAME(large_inverses)(p2, b);
        second = NAME(get)(b);
    }
    NAME(cross)(psi, y, once);
    NAME(cross)(psi, once, twice);
    for (int i = 0; i < 3; i++) {
        y[i] = y[i] - 0.5 * once[i] + second * twice[i];
    }
}

/* ---- to the reused tangent and back ---- */

HERE void NAME(forces_back_block)(const int whole, const int64_t *at, const spari_node_work *t, int64_t i, L *most,
                                  L *poison) {
    L q[4], before[4], rotation[4], r[6];
    NAME(pick_rows)(whole, at, 7, 4, t->q + 7 * i + 3, q);
    NAME(pick_rows)(whole, at, 4, 4, t->tangent_q + 4 * i, before);
    NAME(pick_rows)(whole, at, 6, 6, t->r + 6 * i, r);
    const L back[4] = {before[0], -before[1], -before[2], -before[3]};
    NAME(quat_mul)(q, back, rotation);
    NAME(drop_rows)(whole, at, 4, 4, t->rotation + 4 * i, rotation);
    for (int k = 0; k < 6; k++) {
        const L size = k < 3 ? r[k] : t->per_length * r[k];
        *most = NAME(larger)(NAME(larger)(size, -size), *most);
        *poison = *poison + 0.0 * r[k];
    }
    NAME(rotate_back)(rotation, r, r);
    NAME(rotate_back)(rotation, r + 3, r + 3);
    NAME(drop_rows)(whole, at, 6, 6, t->dx + 6 * i, r);
}

TARGET static double NAME(forces_back)(const spari_node_work *t, int64_t from, int64_t to) {
    L most = {0}, poison = {0};
    double bad[W], large;
#define WORK(whole) NAME(forces_back_block)(whole, at, t, i, &most, &poison);
    EACH_BLOCK(from, to, WORK)
#undef WORK
    NAME(put)(bad, poison);
    for (int l = 1; l < W; l++) {
        bad[0] += bad[l];
    }
    large = NAME(largest)(0, most);
    return bad[0] == 0 ? large : INFINITY;
}

HERE void NAME(corrections_forth_block)(const int whole, const int64_t *at, const spari_node_work *t, int64_t i, L *d) {
    L rotation[4];
    NAME(pick_rows)(whole, at, 4, 4, t->rotation + 4 * i, rotation);
    NAME(rotate)(rotation, d, d);
    NAME(rotate)(rotation, d + 3, d + 3);
}

HERE void NAME(forth_block)(const int whole, const int64_t *at, const spari_node_work *t, int64_t i) {
    L d[6];
    NAME(pick_rows)(whole, at, 6, 6, t->dx + 6 * i, d);
    NAME(corrections_forth_block)(whole, at, t, i, d);
    NAME(drop_rows)(whole, at, 6, 6, t->dx + 6 * i, d);
}

TARGET static void NAME(corrections_forth)(const spari_node_work *t, int64_t from, int64_t to) {
#define WORK(whole) NAME(forth_block)(whole, at, t, i);
    EACH_BLOCK(from, to, WORK)
#undef WORK
}

/* ---- corrections ---- */

/* psi of the increment and of the rates at both ends, which without inertia are not read. */
HERE void NAME(rotations)(const spari_scheme *c, const L *x, const L *rate, const L *before, L *psi) {
    const double part = c->span * c->span / 12;
    L rotation[3];
    for (int k = 0; k < 3; k++) {
        psi[k] = x[k];
    }
    if (!c->still) {
        NAME(cross)(rate, before, rotation);
        for (int k = 0; k < 3; k++) {
            psi[k] = psi[k] + part * rotation[k];
        }
    }
}

/* Angular velocities at both ends. */
HERE void NAME(pick_spins)(const int whole, const int64_t *at, const spari_node_work *t, int64_t i, L *rate,
                           L *before) {
    for (int k = 0; k < 3; k++) {
        rate[k] = before[k] = (L){0};
    }
    if (!t->c->still) {
        NAME(pick_rows)(whole, at, 6, 3, t->to->v + 6 * i + 3, rate);
        NAME(pick_rows)(whole, at, 6, 3, t->from->v + 6 * i + 3, before);
    }
}

/* y := (I - k w~)^-1 y, in closed form (I + k w~ + k^2 w w^T) / (1 + k^2 w.w) */
HERE void NAME(without_spin)(double k, const L *w, L *y) {
    L f = 1.0 / (1.0 + k * k * NAME(dot)(w, w)), along = k * k * NAME(dot)(w, y), wy[3];
    NAME(cross)(w, y, wy);
    for (int i = 0; i < 3; i++) {
        y[i] = f * (y[i] + k * wy[i] + along * w[i]);
    }
}

HERE void NAME(sizes_of)(const L *x, L *size) {
    size[0] = NAME(larger)(NAME(dot)(x, x), size[0]);
    size[1] = NAME(larger)(NAME(dot)(x + 3, x + 3), size[1]);
}

HERE spari_node_size NAME(size_of)(const L *size) {
    return (spari_node_size){NAME(largest)(0, size[0]), NAME(largest)(0, size[1])};
}

/* Converts d of nodes with rotation vectors psi from the tangent's variables to those of the increments x. */
HERE void NAME(to_increments)(const int whole, const int64_t *at, const spari_node_work *t, int64_t i, L *d) {
    if (t->rotation) {
        NAME(corrections_forth_block)(whole, at, t, i, d);
    }
    for (int k = 0; k < 6 && t->R; k += 3) {
        NAME(matrix_times_back)(t->R, d + k, d + k);
    }
}

HERE void NAME(through_rotations)(const spari_scheme *c, const L *psi, const L *before, L *d) {
    NAME(tangent_inverse)(psi, d + 3);
    if (!c->still) {
        NAME(without_spin)(c->span * c->span * c->cv / 12, before, d + 3);
    }
}

HERE void NAME(take_block)(const int whole, const int64_t *at, const spari_node_work *t, int64_t i, L *size) {
    L d[6], x[3], psi[3], rate[3], before[3];
    NAME(pick_rows)(whole, at, 6, 6, t->dx + 6 * i, d);
    NAME(to_increments)(whole, at, t, i, d);
    NAME(pick_rows)(whole, at, 6, 3, t->x + 6 * i + 3, x);
    NAME(pick_spins)(whole, at, t, i, rate, before);
    NAME(rotations)(t->c, x, rate, before, psi);
    NAME(through_rotations)(t->c, psi, before, d);
    NAME(sizes_of)(d, size);
    NAME(drop_rows)(whole, at, 6, 6, t->dx + 6 * i, d);
}

TARGET static spari_node_size NAME(take)(const spari_node_work *t, int64_t from, int64_t to) {
    L size[2] = {0};
#define WORK(whole) NAME(take_block)(whole, at, t, i, size);
    EACH_BLOCK(from, to, WORK)
#undef WORK
    return NAME(size_of)(size);
}

/* Adds by step to W contiguous numbers. */
HERE void NAME(add_step)(double by, L step, double *x) {
    NAME(put)(x, NAME(get)(x) + by * step);
}

TARGET static void NAME(correct)(const spari_node_work *t, int64_t from, int64_t to) {
    const double rate = t->c->rate, cm = t->c->cm, cb = t->c->cb, cut = t->cut;
    const double *dx = t->dx;
    double *x = t->x, *v = t->to->v, *a = t->to->a, *b = t->to->b;
    int64_t i = 6 * from;
    for (; i + W <= 6 * to; i += W) {
        L step = -cut * NAME(get)(dx + i);
        NAME(add_step)(1, step, x + i);
        NAME(add_step)(rate, step, v + i);
        NAME(add_step)(cm, step, a + i);
        NAME(add_step)(cb, step, b + i);
    }
    for (; i < 6 * to; i++) {
        double step = -cut * dx[i];
        x[i] += step;
        v[i] += rate * step;
        a[i] += cm * step;
        b[i] += cb * step;
    }
}

/* ---- starting values ---- */

/* Starting values of constant acceleration for whole vectors of the unknowns from..to (scheme.c: the same for one
   unknown). Returns where it ends. */
TARGET static int64_t NAME(predict)(const spari_node_work *t, int64_t from, int64_t to) {
    const spari_scheme *c = t->c;
    const double h = c->h, half = 0.5 - c->beta, beta = c->beta, before = 1 - c->gamma, gamma = c->gamma;
    const double alpha_m = c->alpha_m, rest = 1 - c->alpha_m, square = h * h;
    const double *v0 = t->from->v, *a0 = t->from->a, *b0 = t->from->b;
    double *x = t->x, *v1 = t->to->v, *a1 = t->to->a, *b1 = t->to->b;
    int64_t i = from;
    for (; i + W <= to; i += W) {
        L b = NAME(get)(b0 + i), a = NAME(get)(a0 + i), v = NAME(get)(v0 + i);
        L next = (a - alpha_m * b) / rest;
        NAME(put)(a1 + i, a);
        NAME(put)(x + i, h * v + square * (half * b + beta * next));
        NAME(put)(v1 + i, v + h * (before * b + gamma * next));
        NAME(put)(b1 + i, next);
    }
    return i;
}

/* ---- positions ---- */

/* Positions after the increments x with rotation vectors psi. */
HERE void NAME(put_places)(const int whole, const int64_t *at, const spari_node_work *t, int64_t i, const L *x,
                           const L *psi) {
    L p[4], from[7], q[7];
    NAME(pick_rows)(whole, at, 7, 7, t->from->q + 7 * i, from);
    for (int k = 0; k < 3; k++) {
        q[k] = from[k] + x[k];
    }
    NAME(quat_exp)(psi, p);
    NAME(quat_mul)(p, from + 3, q + 3);
    L over = 1.0 / NAME(root)(NAME(quat_dot)(q + 3, q + 3));
    for (int k = 3; k < 7; k++) {
        q[k] = q[k] * over;
    }
    NAME(drop_rows)(whole, at, 7, 7, t->to->q + 7 * i, q);
}

HERE void NAME(place_block)(const int whole, const int64_t *at, const spari_node_work *t, int64_t i, L *size) {
    L x[6], psi[3], rate[3], before[3];
    NAME(pick_rows)(whole, at, 6, 6, t->x + 6 * i, x);
    NAME(pick_spins)(whole, at, t, i, rate, before);
    NAME(rotations)(t->c, x + 3, rate, before, psi);
    NAME(sizes_of)(x, size);
    NAME(put_places)(whole, at, t, i, x, psi);
}

TARGET static spari_node_size NAME(set_positions)(const spari_node_work *t, int64_t from, int64_t to) {
    L size[2] = {0};
#define WORK(whole) NAME(place_block)(whole, at, t, i, size);
    EACH_BLOCK(from, to, WORK)
#undef WORK
    for (int64_t i = 6 * from; i < 6 * to && t->c->still; i++) {
        t->to->v[i] = t->x[i] / t->c->span;
        t->to->a[i] = t->to->b[i] = 0;
    }
    return NAME(size_of)(size);
}

/* ---- a whole correction ---- */

/* Adds by step to arrays of six numbers per node. */
HERE void NAME(add_to_rows)(const int whole, const int64_t *at, double by, const L *step, double *to, L *x) {
    NAME(pick_rows)(whole, at, 6, 6, to, x);
    for (int k = 0; k < 6; k++) {
        x[k] = x[k] + by * step[k];
    }
    NAME(drop_rows)(whole, at, 6, 6, to, x);
}

/* take_block, correct and place_block at once, for the full correction. */
HERE void NAME(advance_block)(const int whole, const int64_t *at, const spari_node_work *t, int64_t i, L *by, L *way) {
    const spari_scheme *c = t->c;
    const spari_state *to = t->to;
    L d[6], x[6], v[6], psi[3], rate[3], before[3];
    NAME(pick_rows)(whole, at, 6, 6, t->dx + 6 * i, d);
    NAME(to_increments)(whole, at, t, i, d);
    NAME(pick_rows)(whole, at, 6, 3, t->x + 6 * i + 3, x);
    NAME(pick_spins)(whole, at, t, i, rate, before);
    NAME(rotations)(c, x, rate, before, psi);
    NAME(through_rotations)(c, psi, before, d);
    NAME(sizes_of)(d, by);
    NAME(drop_rows)(whole, at, 6, 6, t->dx + 6 * i, d);
    for (int k = 0; k < 6; k++) {
        d[k] = -d[k];
    }
    NAME(add_to_rows)(whole, at, c->cm, d, to->a + 6 * i, v);
    NAME(add_to_rows)(whole, at, c->cb, d, to->b + 6 * i, v);
    NAME(add_to_rows)(whole, at, c->rate, d, to->v + 6 * i, v);
    NAME(add_to_rows)(whole, at, 1, d, t->x + 6 * i, x);
    NAME(rotations)(c, x + 3, v + 3, before, psi);
    NAME(sizes_of)(x, way);
    NAME(put_places)(whole, at, t, i, x, psi);
}

TARGET static void NAME(advance)(const spari_node_work *t, int64_t from, int64_t to, spari_node_size *by,
                                 spari_node_size *way) {
    L size[2] = {0}, went[2] = {0};
#define WORK(whole) NAME(advance_block)(whole, at, t, i, size, went);
    EACH_BLOCK(from, to, WORK)
#undef WORK
    *by = NAME(size_of)(size);
    *way = NAME(size_of)(went);
}

HERE void NAME(size_block)(const int whole, const int64_t *at, const spari_node_work *t, int64_t i, L *size) {
    L x[6];
    NAME(pick_rows)(whole, at, 6, 6, t->x + 6 * i, x);
    NAME(sizes_of)(x, size);
}

TARGET static spari_node_size NAME(size)(const spari_node_work *t, int64_t from, int64_t to) {
    L size[2] = {0};
#define WORK(whole) NAME(size_block)(whole, at, t, i, size);
    EACH_BLOCK(from, to, WORK)
#undef WORK
    return NAME(size_of)(size);
}

/* ---- absolute motion ---- */

HERE void NAME(splat3)(const double *x, L *y) {
    for (int k = 0; k < 3; k++) {
        y[k] = SPLAT(x + k);
    }
}

/* Adds the motion of the root to the relative rates v and accelerations a at d from the root, in its axes. */
HERE void NAME(add_root_motion)(const L *omega, const L *alpha, const L *d, L *v, L *a) {
    L c1[3], c2[3], c3[3];
    NAME(cross)(omega, d, c1);
    for (int k = 0; k < 3; k++) {
        L rate = v[k];
        v[k] = rate + c1[k];
        c1[k] = c1[k] + 2.0 * rate;
    }
    NAME(cross)(omega, c1, c2);
    NAME(cross)(alpha, d, c3);
    NAME(cross)(omega, v + 3, c1);
    for (int k = 0; k < 3; k++) {
        v[3 + k] = v[3 + k] + omega[k];
        a[k] = a[k] + c2[k] + c3[k];
        a[3 + k] = a[3 + k] + alpha[k] + c1[k];
    }
}

/* Reference lever arms from the root to the nodes from i on. */
HERE void NAME(arms_of)(const int whole, const int64_t *at, const spar_member *member, int64_t i, L *r) {
    double arm[3 * W];
    for (int l = 0; l < W; l++) {
        spari_member_arm(member, (int)(i + (whole ? l : at[l])), arm + 3 * l);
    }
    NAME(pick_rows)(1, at, 3, 3, arm, r);
}

HERE void NAME(show_block)(const int whole, const int64_t *at, const spari_root_view *t, int64_t i) {
    const spari_pose *root = t->root;
    L q[7], v[6], a[6], d[3], r[3], rotation[4], out[7], spin[3], grow[3];
    NAME(arms_of)(whole, at, t->member, i, r);
    NAME(pick_rows)(whole, at, 7, 7, t->own->q + 7 * i, q);
    NAME(pick_rows)(whole, at, 6, 6, t->own->v + 6 * i, v);
    NAME(pick_rows)(whole, at, 6, 6, t->own->a + 6 * i, a);
    NAME(splat3)(t->omega, spin);
    NAME(splat3)(t->alpha, grow);
    for (int k = 0; k < 3; k++) {
        d[k] = r[k] + q[k];
    }
    NAME(add_root_motion)(spin, grow, d, v, a);
    NAME(matrix_times)(t->R, d, d);
    for (int k = 0; k < 6; k += 3) {
        NAME(matrix_times)(t->R, v + k, v + k);
        NAME(matrix_times)(t->R, a + k, a + k);
    }
    for (int k = 0; k < 3; k++) {
        out[k] = root->q[k] + d[k] - r[k];
        v[k] = v[k] + root->v[k];
        a[k] = a[k] + root->a[k];
    }
    for (int k = 0; k < 4; k++) {
        rotation[k] = SPLAT(root->q + 3 + k);
    }
    NAME(quat_mul)(rotation, q + 3, out + 3);
    L over = 1.0 / NAME(root)(NAME(quat_dot)(out + 3, out + 3));
    for (int k = 3; k < 7; k++) {
        out[k] = out[k] * over;
    }
    NAME(drop_rows)(whole, at, 7, 7, t->absolute->q + 7 * i, out);
    NAME(drop_rows)(whole, at, 6, 6, t->absolute->v + 6 * i, v);
    NAME(drop_rows)(whole, at, 6, 6, t->absolute->a + 6 * i, a);
}

TARGET static void NAME(show)(const spari_root_view *t, int64_t from, int64_t to) {
#define WORK(whole) NAME(show_block)(whole, at, t, i);
    EACH_BLOCK(from, to, WORK)
#undef WORK
    memcpy(t->absolute->b + 6 * from, t->own->b + 6 * from, (size_t)(6 * (to - from)) * sizeof *t->own->b);
}

/* ---- motion relative to a root ---- */

/* Subtracts the motion of the root from the rates v and accelerations a of nodes at d from the root, in its axes. */
HERE void NAME(less_root_motion)(const L *omega, const L *alpha, const L *d, L *v, L *a) {
    L c1[3], c2[3], c3[3];
    NAME(cross)(omega, d, c1);
    for (int k = 0; k < 3; k++) {
        v[k] = v[k] - c1[k];
        c1[k] = c1[k] + 2.0 * v[k];
    }
    NAME(cross)(omega, c1, c2);
    NAME(cross)(alpha, d, c3);
    NAME(cross)(omega, v + 3, c1);
    for (int k = 0; k < 3; k++) {
        a[k] = a[k] - (c2[k] + c3[k]);
        a[3 + k] = a[3 + k] - c1[k];
    }
}

HERE void NAME(look_block)(const int whole, const int64_t *at, const spari_root_view *t, int64_t i) {
    const spari_pose *root = t->root;
    L q[7], v[6], a[6], d[3], r[3], rotation[4], out[7], spin[3], grow[3];
    NAME(arms_of)(whole, at, t->member, i, r);
    NAME(pick_rows)(whole, at, 7, 7, t->absolute->q + 7 * i, q);
    NAME(pick_rows)(whole, at, 6, 6, t->absolute->v + 6 * i, v);
    NAME(pick_rows)(whole, at, 6, 6, t->absolute->a + 6 * i, a);
    NAME(splat3)(t->omega, spin);
    NAME(splat3)(t->alpha, grow);
    for (int k = 0; k < 4; k++) {
        rotation[k] = SPLAT(root->q + 3 + k);
    }
    for (int k = 0; k < 3; k++) {
        d[k] = r[k] + q[k] - root->q[k];
    }
    for (int k = 0; k < 6; k++) {
        v[k] = v[k] - root->v[k];
        a[k] = a[k] - root->a[k];
    }
    NAME(rotate_back)(rotation, d, d);
    for (int k = 0; k < 6; k += 3) {
        NAME(rotate_back)(rotation, v + k, v + k);
        NAME(rotate_back)(rotation, a + k, a + k);
    }
    const L back[4] = {rotation[0], -rotation[1], -rotation[2], -rotation[3]};
    NAME(quat_mul)(back, q + 3, out + 3);
    for (int k = 0; k < 3; k++) {
        out[k] = d[k] - r[k];
    }
    NAME(less_root_motion)(spin, grow, d, v, a);
    NAME(drop_rows)(whole, at, 7, 7, t->own->q + 7 * i, out);
    NAME(drop_rows)(whole, at, 6, 6, t->own->v + 6 * i, v);
    NAME(drop_rows)(whole, at, 6, 6, t->own->a + 6 * i, a);
}

TARGET static void NAME(look)(const spari_root_view *t, int64_t from, int64_t to) {
#define WORK(whole) NAME(look_block)(whole, at, t, i);
    EACH_BLOCK(from, to, WORK)
#undef WORK
    memcpy(t->own->b + 6 * from, t->absolute->b + 6 * from, (size_t)(6 * (to - from)) * sizeof *t->own->b);
}

HERE void NAME(lose_block)(const int whole, const int64_t *at, const spari_root_jump *t, int64_t i) {
    L q[7], v[6], d[3], out[4], back[4], jump[3], gap[3], c1[3], c2[3];
    NAME(arms_of)(whole, at, t->member, i, d);
    NAME(pick_rows)(whole, at, 7, 7, t->own->q + 7 * i, q);
    NAME(pick_rows)(whole, at, 6, 6, t->own->v + 6 * i, v);
    NAME(splat3)(t->velocity + 3, jump);
    NAME(splat3)(t->position + 3, gap);
    for (int k = 0; k < 4; k++) {
        back[k] = SPLAT(t->back + k);
    }
    for (int k = 0; k < 3; k++) {
        d[k] = d[k] + q[k];
    }
    NAME(cross)(jump, d, c1);
    NAME(cross)(gap, d, c2);
    for (int k = 0; k < 3; k++) {
        v[k] = v[k] - (t->velocity[k] + c1[k]);
        v[3 + k] = v[3 + k] - t->velocity[3 + k];
        q[k] = q[k] - (t->position[k] + c2[k]);
    }
    NAME(quat_mul)(back, q + 3, out);
    NAME(drop_rows)(whole, at, 7, 3, t->own->q + 7 * i, q);
    NAME(drop_rows)(whole, at, 7, 4, t->own->q + 7 * i + 3, out);
    NAME(drop_rows)(whole, at, 6, 6, t->own->v + 6 * i, v);
}

TARGET static void NAME(lose)(const spari_root_jump *t, int64_t from, int64_t to) {
#define WORK(whole) NAME(lose_block)(whole, at, t, i);
    EACH_BLOCK(from, to, WORK)
#undef WORK
}

const spari_node_kernels NAME(spari_node_kernels) = {
    .width = W,
    .back = NAME(forces_back),
    .forth = NAME(corrections_forth),
    .sized = {[SPARI_SIZED_BY_TAKE] = NAME(take),
              [SPARI_SIZED_BY_POSITION] = NAME(set_positions),
              [SPARI_SIZED_BY_SIZE] = NAME(size)},
    .predict = NAME(predict),
    .correct = NAME(correct),
    .advance = NAME(advance),
    .show = NAME(show),
    .look = NAME(look),
    .lose = NAME(lose),
};
#endif
