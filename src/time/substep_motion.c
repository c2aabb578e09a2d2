/* Generalised-alpha on R^3 x SO(3): Bruls, Cardona & Arnold, Mechanism and Machine Theory 48 (2012), with rotations
   composed from the left (spatial rates): q^{n+1} = exp(psi) q^n. With a driven root, in the axes of the root. */
#include "substep_motion.h"
#include "../base/session.h"
#include "../math/rotation.h"
#include "node_kinematics.h"
#include "stage.h"

#include <math.h>
#include <string.h>

/* ---- one substep ---- */

/* An operation on nodes, in spans. */
typedef struct alpha_nodes {
    const spari_solver *s;
    spari_node_work work;
    spari_guess stays;
    int shifted, rotated;
} alpha_nodes;

/* The work on a substep's increments. */
static spari_node_work alpha_work_on(const spari_solver *s, const spari_scheme *c, const spari_ends *e, double *x) {
    return (spari_node_work){.lanes = s->body->lanes,
                             .c = c,
                             .from = &e->from,
                             .to = &e->to,
                             .x = x,
                             .dx = s->dx,
                             .stage = s->stage_v,
                             .tangent_q = s->tangent_q,
                             .cut = 1};
}

static double size_of_span(const alpha_nodes *t, spari_node_size size) {
    return fmax(sqrt(size.way) / t->s->body->length, sqrt(size.rotation));
}

/* Stores the largest size of a span. */
static void put_size(const alpha_nodes *t, int64_t from, spari_node_size size) {
    t->s->most[from / SPARI_SPAN] = size_of_span(t, size);
}

/* The increments that give the member, relative to its root, the shape that it had at t^n. Used where the root jumps
   and the nodes do not follow (relative_to_root.c). Does not read `to`. */
static void keep_shape(const spari_solver *s, const spar_member *member, spari_ends *e, double *dx) {
    const spari_pose before = spari_pose_of(s->from.q, s->from.v, s->from.a);
    const spari_state *from = &e->from, *shape = &e->to;
    spari_root_look_from(s, member, &before, &s->from, &e->to);
    for (int i = 0; i < s->n; i++) {
        double rotation[4];
        spari_quat_between(from->q + 7 * i + 3, shape->q + 7 * i + 3, rotation);
        spari_quat_log(rotation, dx + 6 * i + 3);
        for (int k = 0; k < 3; k++) {
            dx[6 * i + k] = from->q[7 * i + k] - shape->q[7 * i + k];
            dx[6 * i + 3 + k] *= -1;
        }
    }
}

/* rad in a substep: a member whose ends rotate less keeps its accelerations. So does a member without joints. Newton's
   error there would no longer have either sign equally often, and a free body would lose more energy. */
static const double least_rotation = 1e-3;

static int accelerations_rotate(const spari_solver *s, double h, const double *v) {
    const double *last = v + 6 * (int64_t)(s->n - 1);
    return s->condensed && h * fmax(spari_norm(v + 3), spari_norm(last + 3)) > least_rotation;
}

/* dx := the correction that rotates the acceleration of starting values with its node, because the forces on a rotating
   member mostly keep their directions in the member. Cayley's rotation needs no sine. */
static void rotate_accelerations(const spari_node_work *w, int64_t from, int64_t to) {
    const double half = 0.5 * w->c->h;
    for (int64_t i = 6 * from; i < 6 * to; i += 3) {
        const double *spin = w->from->v + i / 6 * 6 + 3, *a = w->from->a + i;
        const double t[3] = {half * spin[0], half * spin[1], half * spin[2]};
        double once[3], twice[3], f = 2 / ((1 + spari_dot(t, t)) * w->c->cm);
        spari_cross(t, a, once);
        spari_cross(t, once, twice);
        for (int k = 0; k < 3; k++) {
            w->dx[i + k] = -f * (once[k] + twice[k]);
        }
    }
}

static void predict_span(void *context, int64_t from, int64_t to) {
    const alpha_nodes *t = context;
    const spari_node_work *w = &t->work;
    spari_nodes_predict(w, t->stays, from, to);
    if (t->rotated) {
        rotate_accelerations(w, from, to);
    }
    if (t->shifted || t->rotated) {
        spari_nodes_correct(w, from, to);
    }
    (void)spari_nodes_positions(w, from, to);
}

/* Starting values of Newton. */
int spari_alpha_predict(const spari_solver *s, const spar_member *member, const spari_scheme *c, spari_guess stays,
                        spari_ends *e, double *x) {
    int shape = stays == SPARI_KEEP_SHAPE;
    if (shape && !(e->root && member->root == SPAR_ROOT_DRIVEN)) {
        return 0;
    }
    if (shape) {
        keep_shape(s, member, e, s->dx);
    }
    alpha_nodes t = {.s = s, .work = alpha_work_on(s, c, e, x), .shifted = shape};
    t.rotated = stays == SPARI_KEEP_ACCELERATION && c->rule == SPARI_ALPHA && !e->root &&
                accelerations_rotate(s, c->h, e->from.v);
    t.stays = shape ? SPARI_KEEP_POSITION : stays;
    spari_solver_spread(s, predict_span, &t);
    spari_root_show(s, member, e);
    return 1;
}

/* Starting values without inertia: the member follows its root without deformation. */
void spari_alpha_carry(const spari_solver *s, const spar_member *member, const spari_scheme *c, const spari_pose *root,
                       const double rotation[4], const spari_ends *e, double *x) {
    const spari_state *from = &e->from;
    const spari_node_work work = alpha_work_on(s, c, e, x);
    int driven = member->root == SPAR_ROOT_DRIVEN;
    double psi[3];
    spari_quat_log(rotation, psi);
    for (int i = 0; i < s->n; i++) {
        const double *position = spari_member_position(member, i);
        double arm[3], rotated[3];
        for (int k = 0; k < 3; k++) {
            arm[k] = position[k] + from->q[7 * i + k] - member->xr[k] - from->q[k];
        }
        spari_rotate(rotation, arm, rotated);
        for (int k = 0; k < 3; k++) {
            x[6 * i + k] = driven ? root->q[k] - from->q[k] + rotated[k] - arm[k] : 0;
            x[6 * i + 3 + k] = driven ? psi[k] : 0;
        }
    }
    (void)spari_nodes_positions(&work, 0, s->n);
}

/* Prescribes the motion of a driven root. */
void spari_alpha_impose_root(const spar_member *member, const spari_pose *root, const spari_ends *e, double *x) {
    const spari_state *from = &e->from, *to = &e->to;
    int end = spari_member_constrained(member);
    if (end == 0 || e->root) { /* relative to itself a root does not move */
        return;
    }
    double p[4];
    if (member->root == SPAR_ROOT_DRIVEN) {
        memcpy(to->q, root->q, sizeof root->q);
        memcpy(to->v, root->v, sizeof root->v);
        memcpy(to->a, root->a, sizeof root->a);
        memcpy(to->b, root->a, sizeof root->a);
    } else { /* fixed or pinned: it stays */
        memcpy(to->q, from->q, (size_t)(end == 6 ? 7 : 3) * sizeof *to->q);
        memset(to->v, 0, (size_t)end * sizeof *to->v);
        memset(to->a, 0, (size_t)end * sizeof *to->a);
        memset(to->b, 0, (size_t)end * sizeof *to->b);
        memset(x, 0, (size_t)end * sizeof *x);
        return;
    }
    for (int k = 0; k < 3; k++) {
        x[k] = to->q[k] - from->q[k];
    }
    spari_quat_between(from->q + 3, to->q + 3, p);
    spari_quat_log(p, x + 3);
}

/* T := R T R^T */
static void rotation_matrix(const double q[4], double T[9]) {
    for (int side = 0; side < 2; side++) {
        for (int j = 0; j < 3; j++) { /* rows: T R^T, then columns */
            double x[3];
            for (int k = 0; k < 3; k++) {
                x[k] = side ? T[3 * k + j] : T[3 * j + k];
            }
            spari_rotate(q, x, x);
            for (int k = 0; k < 3; k++) {
                T[side ? 3 * k + j : 3 * j + k] = x[k];
            }
        }
    }
}

/* The rotation vector of node i from its increment, and k = span^2 cv / 12, the factor of its change with the rates. */
static double rotation_of(const spari_scheme *c, const spari_ends *e, const double *x, int i, double psi[3]) {
    double rotation[3];
    spari_cross(e->to.v + 6 * i + 3, e->from.v + 6 * i + 3, rotation);
    for (int j = 0; j < 3; j++) {
        psi[j] = x[6 * i + 3 + j] + (c->still ? 0 : c->span * c->span / 12 * rotation[j]);
    }
    return c->still ? 0 : c->span * c->span * c->cv / 12;
}

/* y = (I - k w~)^-1 x, in closed form (I + k w~ + k^2 w w^T) / (1 + k^2 w.w); y may be x. */
static void less_spin(double k, const double w[3], const double x[3], double y[3]) {
    double f = 1 / (1 + k * k * spari_dot(w, w)), along = k * k * spari_dot(w, x), wx[3];
    spari_cross(w, x, wx);
    for (int m = 0; m < 3; m++) {
        y[m] = f * (x[m] + k * wx[m] + along * w[m]);
    }
}

/* dx = tinv dtheta, in global axes: the inverse tangent operator of the rotation vector psi, and the inverse of d psi /
   d x = I - k omega^n~, k = span^2 cv / 12. */
void spari_alpha_operators(const spari_solver *s, const spari_scheme *c, const spari_ends *e, const double *x) {
    for (int i = 0; i < s->n; i++) {
        double psi[3], t[9], *out = s->tinv + 9 * i, k = rotation_of(c, e, x, i, psi);
        spari_tangent_inverse(psi, t);
        for (int j = 0; j < 3; j++) {
            double column[3] = {t[j], t[3 + j], t[6 + j]};
            less_spin(k, e->from.v + 6 * i + 3, column, column);
            for (int m = 0; m < 3; m++) {
                out[3 * m + j] = column[m];
            }
        }
        if (e->root) {
            rotation_matrix(e->root->q + 3, out);
        }
    }
}

static void take_increments(void *context, int64_t from, int64_t to) {
    const alpha_nodes *t = context;
    put_size(t, from, spari_nodes_take(&t->work, from, to));
}

static void correct_span(void *context, int64_t from, int64_t to) {
    const alpha_nodes *t = context;
    spari_nodes_correct(&t->work, from, to);
    put_size(t, from, spari_nodes_positions(&t->work, from, to));
}

/* Both at once if nothing is cut. */
static void advance_span(void *context, int64_t from, int64_t to) {
    const alpha_nodes *t = context;
    spari_node_size by, motion;
    spari_nodes_advance(&t->work, from, to, &by, &motion);
    put_size(t, from, motion);
    t->s->most_by[from / SPARI_SPAN] = size_of_span(t, by);
}

spari_corrected spari_alpha_correct(const spari_solver *s, const spar_member *member, const spari_scheme *c,
                                    spari_ends *e, double *rotation, double longest, double *x, double *dx) {
    double R[9], largest;
    alpha_nodes t = {.s = s, .work = alpha_work_on(s, c, e, x)};
    t.work.dx = dx, t.work.rotation = rotation, t.work.R = e->root ? R : NULL;
    if (e->root) {
        spari_quat_matrix(e->root->q + 3, R);
    }
    if (longest == INFINITY && !c->still) {
        spari_solver_spread(s, advance_span, &t);
        spari_root_show(s, member, e);
        return (spari_corrected){spari_solver_largest(s, s->most_by), spari_solver_most(s)};
    }
    spari_solver_spread(s, take_increments, &t);
    largest = spari_solver_most(s);
    t.work.cut = largest > longest ? longest / largest : 1;
    spari_solver_spread(s, correct_span, &t);
    spari_root_show(s, member, e);
    return (spari_corrected){largest, spari_solver_most(s)};
}

/* A position depends on the increment and, in the term of Magnus' series, on the velocity of its node. The increment
   gets the part that is subtracted from the velocity. */
void spari_alpha_shift_rates(const spari_solver *s, const spari_scheme *c, const spari_ends *e, double v, double a,
                             double b) {
    for (int i = 0; i < s->n; i++) {
        double rotation[3];
        spari_cross(s->dx + 6 * i + 3, e->from.v + 6 * i + 3, rotation);
        for (int k = 0; k < 3; k++) {
            s->increment[6 * i + 3 + k] += v * c->span * c->span / 12 * rotation[k];
        }
        for (int k = 6 * i; k < 6 * i + 6; k++) {
            e->to.v[k] -= v * s->dx[k];
            e->to.a[k] -= a * s->dx[k];
            e->to.b[k] -= b * s->dx[k];
        }
    }
}

static void size_nodes(void *context, int64_t from, int64_t to) {
    const alpha_nodes *t = context;
    put_size(t, from, spari_nodes_size(&t->work, from, to));
}

double spari_alpha_size(const spari_solver *s, double *x) {
    spari_solver_spread(s, size_nodes, &(alpha_nodes){.s = s, .work = {.lanes = s->body->lanes, .x = x}});
    return spari_solver_most(s);
}

/* A tangent of a slightly other dt contracts as fast (hosts' steps differ in their last bits, or by per mille). */
int spari_alpha_close(double x, double before) {
    return fabs(x - before) <= 0.01 * fabs(before);
}

void spari_static_shift(int n, double cut, const double *dx, double *q) {
    for (int i = 0; i < n; i++) {
        double rotation[3], p[4];
        for (int k = 0; k < 3; k++) {
            q[7 * i + k] -= cut * dx[6 * i + k];
            rotation[k] = -cut * dx[6 * i + 3 + k];
        }
        spari_quat_exp(rotation, p);
        spari_quat_mul(p, q + 7 * i + 3, q + 7 * i + 3);
        spari_quat_normalise(q + 7 * i + 3);
    }
}
