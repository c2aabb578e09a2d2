/* Pulls the motion of members to the fluid's nodes. */
#include "../base/environment.h"
#include "../base/thread_pool.h"
#include "../math/rotation.h"
#include "../member/mean_acceleration.h"
#include "state.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

double spari_fluid_time(const spar_fluid *fluid, double theta) {
    return fluid->member->session->state.static_solution && theta >= 0 && theta <= 1 ? 1 : theta;
}

int spari_fluid_check_theta(const spar_fluid *fluid, double theta, const char *caller) {
    SPARI_FLUID_REQUIRE_OF(fluid, caller, theta >= 0 && theta <= 1, SPAR_ERR_ARGUMENT,
                           "theta = %g lies outside [0,1]; 0 is t^n, 1 is t^{n+1}", theta);
    return SPAR_OK;
}

/* Node motion between two times on the group R^3 x SO(3), for the nodes of one element: chord of positions, geodesic
   of rotations. */
static void blend_motion(const spar_member *m, int64_t first, double theta, double (*q)[7], double (*v)[6],
                         double (*a)[6]) {
    const double *q0 = m->now.q + 7 * first, *q1 = m->after.q + 7 * first, *a0 = spari_means_seen(m, 0),
                 *a1 = spari_means_seen(m, 1);
    for (int l = 0; l < m->mesh.per_element; l++, q0 += 7, q1 += 7) {
        double back[4], rotation[4], psi[3];
        for (int i = 0; i < 3; i++) {
            q[l][i] = (1 - theta) * q0[i] + theta * q1[i];
        }
        spari_quat_conj(q0 + 3, back);
        spari_quat_mul(back, q1 + 3, rotation);
        spari_quat_log(rotation, psi);
        for (int i = 0; i < 3; i++) {
            psi[i] *= theta;
        }
        spari_quat_exp(psi, rotation);
        spari_quat_mul(q0 + 3, rotation, q[l] + 3);
        spari_quat_normalise(q[l] + 3);
        for (int i = 0; i < 6; i++) {
            int64_t k = 6 * (first + l) + i;
            v[l][i] = (1 - theta) * m->now.v[k] + theta * m->after.v[k];
            a[l][i] = (1 - theta) * a0[k] + theta * a1[k];
        }
    }
}

SPARI_APART static void fill_blended(const spar_fluid *fluid, double theta, int upto) {
    const spar_member *m = fluid->member;
    double q[SPARI_MAX_NODES][7], v[SPARI_MAX_NODES][6], a[SPARI_MAX_NODES][6];
    for (int e = 0; e < m->mesh.elements; e++) {
        int64_t first = (int64_t)e * m->mesh.per_element;
        blend_motion(m, first, theta, q, v, a);
        spari_field_fill(1, m->mesh.per_element, fluid->modal, fluid->consistent, upto, m->xr + 3 * first, q[0], v[0],
                         a[0], fluid->field[0] + first * SPARI_FIELDS);
    }
}

/* At t^n (after: 0) or at t^{n+1}. */
static void fill_one(const spar_fluid *fluid, int after, int upto, double *field) {
    const spar_member *m = fluid->member;
    const spari_motion *at = after ? &m->after : &m->now;
    spari_field_fill(m->mesh.elements, m->mesh.per_element, fluid->modal, fluid->consistent, upto, m->xr, at->q, at->v,
                     spari_means_seen(m, after), field);
}

static int is_between(double theta) {
    return theta > 0 && theta < 1;
}

/* Coefficients of the one or two states that give time theta, and their weights. Returns their number. */
static int fill_states(const spar_fluid *fluid, double theta, int upto, double share[2]) {
    share[0] = 1, share[1] = 0;
    if (!is_between(theta)) {
        fill_one(fluid, theta != 0, upto, fluid->field[0]);
        return 1;
    }
    if (fluid->options.theta_on_group) {
        fill_blended(fluid, theta, upto);
        return 1;
    }
    share[0] = theta, share[1] = 1 - theta;
    fill_one(fluid, 1, upto, fluid->field[0]);
    fill_one(fluid, 0, upto, fluid->field[1]);
    return 2;
}

/* Allocates the second state if there is none. */
static int need_second(spar_fluid *fluid, const char *caller) {
    const spar_member *m = fluid->member;
    if (fluid->field[1] || !fluid->field[0]) {
        return SPAR_OK;
    }
    fluid->field[1] = spari_zalloc(m->nodes * SPARI_FIELDS, sizeof *fluid->field[1]);
    if (!fluid->field[1] || spari_fluid_reserve_workspace(fluid)) {
        free(fluid->field[1]);
        fluid->field[1] = NULL;
        return spari_fluid_refuse(fluid, SPAR_ERR_MEMORY, caller, "no memory for the motion at two times");
    }
    return SPAR_OK;
}

/* The first average of two states allocates the second. */
static int need_states(spar_fluid *fluid, double theta, const char *caller) {
    return is_between(theta) && !fluid->options.theta_on_group ? need_second(fluid, caller) : SPAR_OK;
}

int spari_fluid_check_rotation(const spar_fluid *fluid, double least, const char *caller) {
    SPARI_FLUID_REQUIRE_OF(fluid, caller, !(least < 1e-12), SPAR_ERR_NUMERIC,
                           "rotations within an element cancel, so the interpolated rotation is undefined; use "
                           "more nodes or elements");
    return SPAR_OK;
}

/* Destination of a result: one of the two, or none. */
typedef struct sink {
    double *d;
    float *f;
} sink;

/* Requested results, by node. */
typedef struct wanted {
    sink x, v, omega, accel, alpha; /* [n][3] */
    sink q;                         /* [n][4] */
    sink matrix;                    /* [n][9] */
    int convention;                 /* of the matrices */
    const spari_layout *layout;     /* of the triples; NULL: packed */
} wanted;

static int is_wanted(sink s) {
    return s.d || s.f;
}

static int wants_pose(const wanted *w) {
    return is_wanted(w->q) || is_wanted(w->matrix) || is_wanted(w->omega) || is_wanted(w->accel) || is_wanted(w->alpha);
}

/* Request flags for the kernels. */
static int what_of(const wanted *w) {
    int poses = is_wanted(w->q) || is_wanted(w->matrix) || is_wanted(w->omega) ? SPARI_POSES : 0;
    if (is_wanted(w->accel) || is_wanted(w->alpha)) {
        return SPARI_UPTO_ACCEL | SPARI_POSES;
    }
    return poses | (is_wanted(w->v) || is_wanted(w->omega) ? SPARI_UPTO_RATE : SPARI_UPTO_POSITION);
}

/* Tiles of the one or two states that give a time, and of the reference if poses are requested. */
typedef struct states {
    int n;
    double share[2];
    double (*buf[2])[SPARI_ROW];
    double (*reference)[SPARI_ROW];
} states;

/* Stores three rows of the tile in the host's triples. Rows of two states are first averaged in place. */
static void emit(const spari_nodes *s, int64_t first, const states *t, int row, sink out, const spari_layout *layout) {
    if (!is_wanted(out)) {
        return;
    }
    int count = spari_tile_count(s, first);
    for (int k = row; k < row + 3 && t->n == 2 && t->buf[1]; k++) {
        for (int i = 0; i < count; i++) {
            t->buf[0][k][i] = t->share[0] * t->buf[0][k][i] + t->share[1] * t->buf[1][k][i];
        }
    }
    if (layout) {
        spari_tile_store_at(s, first, t->buf[0] + row, layout, out.d, out.f);
    } else if (out.d) {
        spari_tile_store(s, first, t->buf[0] + row, out.d);
    } else {
        spari_tile_store_f32(s, first, t->buf[0] + row, out.f);
    }
}

static void put_values(sink out, int64_t node, int width, const double *x) {
    if (out.d) {
        memcpy(out.d + node * width, x, (size_t)width * sizeof *x);
    }
    for (int i = 0; i < width && out.f; i++) {
        out.f[node * width + i] = (float)x[i];
    }
}

static void unit_quat(double (*buf)[SPARI_ROW], int i, double q[4]) {
    for (int c = 0; c < 4; c++) {
        q[c] = buf[SPARI_R_QUAT + c][i];
    }
    spari_quat_normalise(q);
}

/* Present orientation of a section, scalar part >= 0: rotations of the states, averaged if there are two, times the
   reference orientation or a frame of its own. */
static void orientation(const states *t, int i, const double *frame, double now[4]) {
    double q[4], reference[4];
    unit_quat(t->buf[0], i, q);
    if (t->n == 2) {
        double other[4];
        unit_quat(t->buf[1], i, other);
        double sign = spari_quat_dot(q, other) < 0 ? -1 : 1;
        for (int c = 0; c < 4; c++) {
            q[c] = t->share[0] * q[c] + sign * t->share[1] * other[c];
        }
    }
    if (!frame) {
        unit_quat(t->reference, i, reference);
    }
    spari_quat_mul(q, frame ? frame : reference, now);
    spari_quat_normalise(now);
    double sign = now[0] < 0 ? -1 : 1;
    for (int c = 0; c < 4; c++) {
        now[c] *= sign;
    }
}

/* Matrix of a convention, row by row: R(q) maps local components to global ones. */
static void matrix_of(const double q[4], int convention, double m[9]) {
    double r[9];
    spari_quat_matrix(q, r);
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++) {
            m[3 * i + k] = convention == SPAR_MATRIX_LOCAL_TO_GLOBAL ? r[3 * i + k] : r[3 * k + i];
        }
    }
}

static void emit_orientations(const spar_fluid *fluid, const spari_node_set *set, int64_t first, const states *t,
                              const wanted *w) {
    const spari_nodes *s = set->nodes;
    if (!is_wanted(w->q) && !is_wanted(w->matrix)) {
        return;
    }
    int count = spari_tile_count(s, first);
    double q[4], m[9];
    (void)spari_tile_motion(s, first, fluid->reference, 0, SPARI_UPTO_POSITION | SPARI_POSES, t->reference);
    for (int i = 0; i < count; i++) {
        int64_t node = spari_nodes_node(s, first + i);
        if (i == 0 || s->per_element > 1) { /* otherwise all have the rotation of the one node */
            orientation(t, i, set->frame ? set->frame + 4 * node : NULL, q);
            if (is_wanted(w->matrix)) {
                matrix_of(q, w->convention, m);
            }
        }
        put_values(w->q, node, 4, q);
        put_values(w->matrix, node, 9, m);
    }
}

static int parts_of(const wanted *w, double theta) {
    return (is_wanted(w->x) ? SPARI_ASKED_POSITIONS : 0) | (is_wanted(w->v) ? SPARI_MUTE_VELOCITY : 0) |
           (wants_pose(w) ? SPARI_MUTE_POSES : 0) | (theta > 0 && theta < 1 ? SPARI_MUTE_HALF_STEP : 0);
}

static void zero(sink *out, int64_t n, const spari_layout *layout) {
    int64_t node = layout ? layout->node : 3, component = layout ? layout->component : 1;
    const double none = 0;
    for (int64_t j = 0; j < n && is_wanted(*out); j++) {
        for (int i = 0; i < 3; i++) {
            put_values(*out, j * node + i * component, 1, &none);
        }
    }
    *out = (sink){0};
}

/* Fills results that a trial switches off, and removes them from the request. */
static void mute_parts(const spar_fluid *fluid, const spari_node_set *set, wanted *w) {
    const spari_nodes *s = set->nodes;
    if (fluid->mute & SPARI_MUTE_VELOCITY) {
        zero(&w->v, s->n, w->layout);
    }
    if (!(fluid->mute & SPARI_MUTE_POSES)) {
        return;
    }
    for (int64_t p = 0; p < s->n && (is_wanted(w->q) || is_wanted(w->matrix)); p++) {
        double x[3], q[4], m[9];
        spari_fluid_frame(fluid, set, p, x, q);
        put_values(w->q, spari_nodes_node(s, p), 4, q);
        matrix_of(q, w->convention, m);
        put_values(w->matrix, spari_nodes_node(s, p), 9, m);
    }
    w->q = w->matrix = (sink){0};
    zero(&w->omega, s->n, w->layout);
    zero(&w->accel, s->n, w->layout);
    zero(&w->alpha, s->n, w->layout);
}

/* Tiles in a thread's workspace. There is no second before the first average. */
static states tiles_of(const spar_fluid *fluid, int worker, int n, const double share[2]) {
    double(*row)[SPARI_ROW] = (double(*)[SPARI_ROW])spari_fluid_work(fluid, worker);
    states t = {.n = n, .share = {share[0], share[1]}, .buf = {row}, .reference = row + SPARI_ROWS};
    t.buf[1] = fluid->field[1] ? row + SPARI_PULL_ONE : NULL;
    return t;
}

/* A weighted node has no unique rotation. */
static int check_rotations(const spar_fluid *fluid, int which, const wanted *w, const char *caller) {
    int turns = is_wanted(w->q) || is_wanted(w->matrix) || is_wanted(w->omega) || is_wanted(w->alpha);
    SPARI_FLUID_REQUIRE_OF(fluid, caller, !turns || !spari_fluid_set(fluid, which)->weight, SPAR_ERR_UNSUPPORTED,
                           "motion nodes with weights have positions, velocities and accelerations, but no "
                           "rotation; pull rotations from a fluid without weights");
    return SPAR_OK;
}

/* Arguments of a pull of one set. direct: without tiles. */
typedef struct pulling {
    const spar_fluid *fluid;
    const spari_node_set *set;
    const wanted *wanted;
    int what, states, direct;
    double share[2];
    double least[SPARI_MOST_THREADS];    /* smallest |Q|^2 of each thread */
    spari_fold fold[SPARI_MOST_THREADS]; /* largest of each thread */
} pulling;

static void pull_tile(pulling *p, int64_t first, const states *t, int worker) {
    const spar_fluid *fluid = p->fluid;
    const spari_nodes *s = spari_moving_nodes(p->set);
    double *least = &p->least[worker];
    const wanted *w = p->wanted;
    int what = p->what | (p->set->fade ? SPARI_POSES : 0);
    for (int i = 0; i < t->n; i++) {
        *least = fmin(*least, spari_tile_motion(s, first, fluid->field[i], fluid->consistent, what, t->buf[i]));
    }
    for (int i = 0; i < t->n && p->set->weight; i++) {
        spari_fluid_weigh(p->set, first, p->what & SPARI_UPTO, t->buf[i], &p->fold[worker]);
    }
    emit(s, first, t, SPARI_R_POSITION, w->x, w->layout);
    emit(s, first, t, SPARI_R_RATE, w->v, w->layout);
    emit(s, first, t, SPARI_R_OMEGA, w->omega, w->layout);
    emit(s, first, t, SPARI_R_ACCEL, w->accel, w->layout);
    emit(s, first, t, SPARI_R_ALPHA, w->alpha, w->layout);
    emit_orientations(fluid, p->set, first, t, w);
}

static void pull_slab(void *context, int64_t slab, int worker) {
    pulling *p = context;
    const states t = tiles_of(p->fluid, worker, p->states, p->share);
    const wanted *w = p->wanted;
    int64_t from = slab * SPARI_SLAB, end = from + SPARI_SLAB < p->set->nodes->n ? from + SPARI_SLAB : p->set->nodes->n;
    if (p->direct) {
        const int single = w->x.f || w->v.f;
        void *x = single ? (void *)w->x.f : w->x.d, *v = single ? (void *)w->v.f : w->v.d;
        double least =
            spari_move_to(p->set->nodes, from, end - from, p->fluid->field[0], p->fluid->consistent, single, x, v);
        p->least[worker] = fmin(p->least[worker], least);
    }
    for (int64_t first = from; first < end && !p->direct; first += SPARI_TILE) {
        pull_tile(p, first, &t, worker);
    }
    spari_tiles_end();
}

/* Whether the kernels' motion goes to the host's triples unchanged. */
static int is_direct(const pulling *p) {
    const wanted *w = p->wanted;
    const int single = w->x.f || w->v.f;
    return p->states == 1 && p->what <= SPARI_UPTO_RATE && !p->set->weight && !w->layout &&
           (single ? !w->x.d && !w->v.d : 1) && spari_can_move_to(p->set->nodes, single);
}

static int check_fold(const spar_fluid *fluid, spari_fold fold, const char *caller) {
    const spari_fade *fade = fluid->set[SPAR_NODES_MOTION].fade;
    SPARI_FLUID_REQUIRE_OF(fluid, caller, !(fold.jacobian <= 0), SPAR_ERR_NUMERIC,
                           "the mesh folds at motion node %lld: the member moves farther than the fade from %g "
                           "to %g m can take; give spar_fluid_fade_motion a wider range",
                           (long long)fold.node, fade->within, fade->beyond);
    return SPAR_OK;
}

/* All pulls: the nodes of one set at t^n + theta dt. fold: out. */
static int pull_set(const spar_fluid *fluid, int which, double theta, const wanted *w, const char *caller,
                    spari_fold *fold) {
    spari_thread_pool *pool = fluid->member->session->pool;
    pulling p = {.fluid = fluid, .set = spari_fluid_set(fluid, which), .wanted = w, .what = what_of(w)};
    const spari_nodes *s;
    *fold = spari_fold_none();
    SPARI_TRY(spari_fluid_check_theta(fluid, theta, caller));
    SPARI_TRY(spari_fluid_mapped(fluid, which, caller, &s));
    if (!s || s->n == 0) {
        return SPAR_OK;
    }
    p.states = fill_states(fluid, theta, p.what & SPARI_UPTO, p.share);
    if (s->per_element == 1 && p.states == 1 && p.what <= SPARI_UPTO_RATE && !w->x.f && !w->v.f && !p.set->weight &&
        !w->layout) {
        return spari_fluid_check_rotation(fluid, spari_carry(s, fluid->field[0], w->x.d, w->v.d), caller);
    }
    p.direct = is_direct(&p);
    for (int k = 0; k < spari_thread_pool_threads(pool); k++) {
        p.least[k] = HUGE_VAL;
        p.fold[k] = spari_fold_none();
    }
    spari_thread_pool_run(pool, spari_slabs(s->n, SPARI_SLAB), pull_slab, &p);
    for (int k = 1; k < spari_thread_pool_threads(pool); k++) {
        p.least[0] = fmin(p.least[0], p.least[k]);
        p.fold[0] = spari_fold_worse(p.fold[0], p.fold[k]);
    }
    *fold = p.fold[0];
    SPARI_TRY(spari_fluid_check_rotation(fluid, p.least[0], caller));
    return check_fold(fluid, p.fold[0], caller);
}

/* Whether a result may exceed FLT_MAX, about 3e38. Omega^2 times a lever arm is the largest product. */
static int may_exceed_single(const spar_fluid *fluid, const spari_node_set *set) {
    const spar_member *m = fluid->member;
    double most = 0, rotation = 0;
    for (int64_t l = 0; l < m->nodes; l++) {
        for (int k = 0; k < 2; k++) {
            const spari_motion *at = k ? &m->after : &m->now;
            const double *a = spari_means_seen(m, k) + 6 * l, *q = at->q + 7 * l, *v = at->v + 6 * l;
            for (int i = 0; i < 3; i++) {
                most = fmax(most, fmax(fmax(fabs(m->xr[3 * l + i]), fabs(q[i])), fmax(fabs(v[i]), fabs(a[i]))));
                rotation = fmax(rotation, fmax(fabs(v[3 + i]), fabs(a[3 + i])));
            }
        }
    }
    return most > 1e30 || rotation > 1e9 || set->farthest > 1e9;
}

/* Results in single precision must be finite. They are looked at only where they may not be. */
static int check_single(const spar_fluid *fluid, int which, const wanted *w, const char *caller) {
    const struct {
        const float *x;
        const char *name;
    } all[] = {{w->x.f, "position"},
               {w->v.f, "velocity"},
               {w->omega.f, "angular velocity"},
               {w->accel.f, "acceleration"},
               {w->alpha.f, "angular acceleration"}};
    const spari_node_set *set = spari_fluid_set(fluid, which);
    int64_t node = w->layout ? w->layout->node : 3, component = w->layout ? w->layout->component : 1;
    int any = all[0].x || all[1].x || all[2].x || all[3].x || all[4].x;
    if (!any || !set->nodes || !may_exceed_single(fluid, set)) {
        return SPAR_OK;
    }
    for (size_t k = 0; k < sizeof all / sizeof *all; k++) {
        for (int64_t i = 0; i < 3 * set->n && all[k].x; i++) {
            SPARI_FLUID_REQUIRE_OF(fluid, caller, isfinite(all[k].x[i / 3 * node + i % 3 * component]),
                                   SPAR_ERR_NUMERIC,
                                   "the %s of node %lld is too large for single precision; check the motion and its "
                                   "units, or pull it in double precision",
                                   all[k].name, (long long)(i / 3));
        }
    }
    return SPAR_OK;
}

/* Public pulls. */
static int pull_nodes(spar_fluid *fluid, int which, double theta, const wanted *w, const char *caller) {
    const spari_nodes *s;
    wanted left = *w;
    SPARI_TRY(check_rotations(fluid, which, w, caller));
    left.layout = spari_fluid_layout(fluid, which);
    fluid->asked |= parts_of(w, theta);
    theta = spari_fluid_time(fluid, theta);
    if (fluid->mute & SPARI_MUTE_HALF_STEP && theta > 0) {
        theta = 1;
    }
    SPARI_TRY(need_states(fluid, theta, caller));
    if (fluid->mute) {
        SPARI_TRY(spari_fluid_mapped(fluid, which, caller, &s));
        if (s) {
            mute_parts(fluid, spari_fluid_set(fluid, which), &left);
        }
    }
    spari_fold fold;
    SPARI_TRY(pull_set(fluid, which, theta, &left, caller, &fold));
    SPARI_TRY(check_single(fluid, which, &left, caller));
    spari_fluid_warn_fold(fluid, fold);
    return SPAR_OK;
}

static int pull_motion(spar_fluid *fluid, double theta, const wanted *w, const char *caller) {
    return pull_nodes(fluid, SPAR_NODES_MOTION, theta, w, caller);
}

int spar_fluid_pull_motion(spar_fluid *fluid, double theta, double *x, double *v) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_FLUID_HANDLE(fluid);
    wanted w = {.x.d = x, .v.d = v};
    return pull_motion(fluid, theta, &w, __func__);
}

int spar_fluid_pull_motion_f32(spar_fluid *fluid, double theta, float *x, float *v) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_FLUID_HANDLE(fluid);
    wanted w = {.x.f = x, .v.f = v};
    return pull_motion(fluid, theta, &w, __func__);
}

/* Displacements of the nodes of a tile: largest square, and its node. */
static void longest_way(const spari_nodes *s, int64_t first, const states *t, double *square, int64_t *node) {
    int count = spari_tile_count(s, first);
    for (int i = 0; i < count; i++) {
        double way = 0;
        for (int k = SPARI_R_POSITION; k < SPARI_R_POSITION + 3; k++) {
            double d = t->buf[1][k][i] - t->buf[0][k][i];
            way += d * d;
        }
        int64_t here = spari_nodes_node(s, first + i);
        if (*node < 0 || way > *square || (way == *square && here < *node)) {
            *square = way;
            *node = here;
        }
    }
}

int spar_fluid_get_travel(spar_fluid *fluid, double *largest, int64_t *node) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_FLUID_HANDLE(fluid);
    double square = 0, least = HUGE_VAL;
    const spari_node_set *set = &fluid->set[SPAR_NODES_MOTION];
    const spari_nodes *s;
    spari_fold fold = spari_fold_none();
    int64_t farthest = -1;
    SPARI_TRY(spari_fluid_mapped(fluid, SPAR_NODES_MOTION, __func__, &s));
    SPARI_TRY(need_second(fluid, __func__));
    if (s && s->n > 0) {
        fill_one(fluid, 0, SPARI_UPTO_POSITION, fluid->field[0]);
        fill_one(fluid, 1, SPARI_UPTO_POSITION, fluid->field[1]);
    }
    for (int64_t first = 0; s && first < s->n; first += SPARI_TILE) {
        const states t = tiles_of(fluid, 0, 2, (const double[2]){1, 0});
        for (int i = 0; i < t.n; i++) {
            double met = spari_tile_motion(spari_moving_nodes(set), first, fluid->field[i], fluid->consistent,
                                           SPARI_UPTO_POSITION | (set->fade ? SPARI_POSES : 0), t.buf[i]);
            least = fmin(least, met);
        }
        for (int i = 0; i < t.n && set->weight; i++) {
            spari_fluid_weigh(set, first, SPARI_UPTO_POSITION, t.buf[i], &fold);
        }
        if (t.buf[1]) { /* see need_second */
            longest_way(s, first, &t, &square, &farthest);
        }
    }
    SPARI_TRY(spari_fluid_check_rotation(fluid, least, __func__));
    SPARI_GIVE(largest, sqrt(square));
    SPARI_GIVE(node, farthest);
    return SPAR_OK;
}

int spar_fluid_pull_poses(spar_fluid *fluid, int which, double theta, double *x, double *q, double *v, double *omega,
                          double *accel, double *alpha) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_FLUID_HANDLE(fluid);
    SPARI_TRY(spari_fluid_check_which(fluid, which, __func__));
    wanted w = {.x.d = x, .q.d = q, .v.d = v, .omega.d = omega, .accel.d = accel, .alpha.d = alpha};
    return pull_nodes(fluid, which, theta, &w, __func__);
}

int spar_fluid_pull_poses_f32(spar_fluid *fluid, int which, double theta, float *x, float *q, float *v, float *omega,
                              float *accel, float *alpha) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_FLUID_HANDLE(fluid);
    SPARI_TRY(spari_fluid_check_which(fluid, which, __func__));
    wanted w = {.x.f = x, .q.f = q, .v.f = v, .omega.f = omega, .accel.f = accel, .alpha.f = alpha};
    return pull_nodes(fluid, which, theta, &w, __func__);
}

static int check_convention(const spar_fluid *fluid, int convention, const char *caller) {
    SPARI_FLUID_REQUIRE_OF(fluid, caller,
                           convention == SPAR_MATRIX_LOCAL_TO_GLOBAL || convention == SPAR_MATRIX_GLOBAL_TO_LOCAL,
                           SPAR_ERR_ARGUMENT,
                           "matrix convention %d is not known; give SPAR_MATRIX_LOCAL_TO_GLOBAL or "
                           "SPAR_MATRIX_GLOBAL_TO_LOCAL",
                           convention);
    return SPAR_OK;
}

int spar_fluid_pull_matrices(spar_fluid *fluid, double theta, int convention, double *matrix) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_FLUID_HANDLE(fluid);
    SPARI_TRY(check_convention(fluid, convention, __func__));
    SPARI_FLUID_REQUIRE(fluid, matrix || spari_fluid_set(fluid, SPAR_NODES_MOTION)->n == 0, SPAR_ERR_ARGUMENT,
                        "the pointer to the matrices is NULL");
    wanted w = {.matrix.d = matrix, .convention = convention};
    return pull_motion(fluid, theta, &w, __func__);
}

/* Largest entry of a - b, with b transposed on request. */
static double apart(const double a[9], const double b[9], int transposed) {
    double most = 0;
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++) {
            most = fmax(most, fabs(a[3 * i + k] - b[transposed ? 3 * k + i : 3 * i + k]));
        }
    }
    return most;
}

static double determinant(const double m[9]) {
    return m[0] * (m[4] * m[8] - m[5] * m[7]) - m[1] * (m[3] * m[8] - m[5] * m[6]) + m[2] * (m[3] * m[7] - m[4] * m[6]);
}

/* Describes the error of a host's matrix `m` that should be `right`; NULL: none. */
static const char *wrong_with(const double m[9], const double right[9]) {
    const double tolerance = 1e-5; /* hosts may use single precision */
    double mirrored[9];
    for (int i = 0; i < 9; i++) {
        mirrored[i] = -m[i];
    }
    if (spari_first_nonfinite(m, 9) >= 0) {
        return "is not a number";
    }
    if (apart(m, right, 0) <= tolerance) {
        return NULL;
    }
    if (apart(m, right, 1) <= tolerance) {
        return "is transposed: use the other convention, or check the order of rows and columns between languages";
    }
    if (determinant(m) < 0) {
        return apart(mirrored, right, 0) <= tolerance || apart(mirrored, right, 1) <= tolerance
                   ? "has determinant -1: all its axes are reversed"
                   : "has determinant -1: an axis is reversed, or two are swapped";
    }
    return fabs(determinant(m) - 1) > tolerance ? "is not a rotation: its determinant is not 1"
                                                : "is a rotation, but not the rotation of this section";
}

int spar_fluid_check_matrices(spar_fluid *fluid, int convention, const double *matrix) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_FLUID_HANDLE(fluid);
    SPARI_TRY(check_convention(fluid, convention, __func__));
    const spari_nodes *s;
    SPARI_TRY(spari_fluid_mapped(fluid, SPAR_NODES_MOTION, __func__, &s));
    int64_t n = s ? s->n : 0;
    SPARI_FLUID_REQUIRE(fluid, n == 0 || matrix, SPAR_ERR_ARGUMENT, "the matrices are NULL");
    double *right = spari_zalloc(9 * n, sizeof *right);
    SPARI_FLUID_REQUIRE(fluid, right, SPAR_ERR_MEMORY, "no memory for %lld matrices", (long long)n);
    wanted w = {.matrix.d = right, .convention = convention};
    int status = check_rotations(fluid, SPAR_NODES_MOTION, &w, __func__);
    spari_fold fold;
    status = status != SPAR_OK ? status : pull_set(fluid, SPAR_NODES_MOTION, 1, &w, __func__, &fold);
    for (int64_t j = 0; j < n && status == SPAR_OK; j++) {
        const char *why = wrong_with(matrix + 9 * j, right + 9 * j);
        if (why) {
            status =
                spari_fluid_refuse(fluid, SPAR_ERR_ARGUMENT, __func__, "the matrix of node %lld %s", (long long)j, why);
        }
    }
    free(right);
    return status;
}

int spar_fluid_get_positions(const spar_fluid *fluid, int which, double *x, double *q, double *v, double *nearest) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_FLUID_HANDLE(fluid);
    SPARI_TRY(spari_fluid_check_which(fluid, which, __func__));
    wanted w = {.x.d = x, .v.d = v, .q.d = q};
    spari_fold fold;
    SPARI_TRY(pull_set(fluid, which, 1, &w, __func__, &fold)); /* also fills the coefficients of the motion */
    const spari_nodes *s = spari_fluid_set(fluid, which)->nodes;
    for (int64_t p = 0; s && nearest && p < s->n; p++) {
        const double *c = fluid->field[0] + (ptrdiff_t)spari_nodes_element(s, p) * s->per_element * SPARI_FIELDS;
        spari_fluid_series(c, s->per_element, SPARI_F_POSITION, 3, spari_nodes_xi(s, p),
                           nearest + 3 * spari_nodes_node(s, p));
    }
    return SPAR_OK;
}
