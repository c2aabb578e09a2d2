/* Stages of a substep: see stage.h. */
#include "stage.h"

#include "../base/session.h"
#include "../math/rotation.h"
#include "../member/applied_loads.h"
#include "driven_root.h"

#include <string.h>

/* The ends [from, to] of a substep of a root. ratio: of the algorithmic accelerations, see spari_scheme_stretch. */
static spari_ends ends_of_root(const spari_solver *s, const spar_member *m, const spari_scheme *c,
                               const spari_pose *root, double ratio, const spari_state *from, const spari_state *to) {
    spari_ends e = {*from, *to, *to, NULL, 0};
    if (m->root == SPAR_ROOT_DRIVEN && s->own[0].q && !c->still) {
        const spari_pose before = spari_pose_of(from->q, from->v, from->a);
        e.from = s->own[0], e.to = s->own[1], e.root = root;
        e.root_motion = spari_root_motion(&before, root, s->body->length);
        spari_root_look_from(s, m, &before, from, &e.from);
        spari_root_subtract_jump(s, m, c->span, &before, root, &e.from);
    }
    spari_scheme_stretch(ratio, 6 * s->n, e.from.a, e.from.b);
    return e;
}

static void begin_span(void *context, int64_t from, int64_t to) {
    const spari_solver *s = context;
    const spari_state *b = &s->begin;
    size_t n = (size_t)(to - from) * sizeof *b->q;
    memcpy(s->to.q + 7 * from, b->q + 7 * from, 7 * n);
    memcpy(s->to.v + 6 * from, b->v + 6 * from, 6 * n);
    memcpy(s->to.a + 6 * from, b->a + 6 * from, 6 * n);
    memcpy(s->to.b + 6 * from, b->b + 6 * from, 6 * n);
}

void spari_stage_start(spari_solver *s, spar_member *m, spari_stage *g) {
    spari_solver_spread(s, begin_span, s);
    g->before = m->drive[0];
    g->power = s->power_begin;
    m->state.dissipated_step = 0;
}

void spari_stage_enter(spari_solver *s) {
    spari_state t = s->from;
    s->from = s->to;
    s->to = t;
}

/* ---- reference rigid motion ---- */

double spari_stage_rotation_rate(const spari_solver *s, const spar_member *m) {
    double w[3] = {0};
    if (spari_member_rotates_stiffly(m)) {
        spari_mean_rotation(s->n, s->from.v, w);
    }
    return spari_norm(w);
}

/* rad: a step with a larger rotation, or a larger phase of vibration, does not resolve it. */
static const double farthest = 1;

static int make_own_states(spari_solver *s) {
    for (int k = 0; k < 2 && !s->own[k].q; k++) {
        double *block = spari_zalloc(25 * (int64_t)s->n, sizeof *block);
        if (!block) {
            return SPAR_ERR_MEMORY;
        }
        s->own[k] = spari_state_in(block, s->n);
    }
    return s->own[1].q ? SPAR_OK : SPAR_ERR_MEMORY;
}

static int is_tied(const spari_solver *s) {
    return s->condensed && s->condensed->ends > 0;
}

/* Whether a stage describes the member relative to a rigid motion. A rigid body that flies alone rotates about its
   centre of mass and needs none. */
static int turns(const spari_solver *s, const spar_member *m) {
    return spari_member_rotates_stiffly(m) || (s->n == 1 && is_tied(s) && !spari_member_root_is_prescribed(m));
}

/* The mean rotation at the beginning of a substep, and the motion of the centre of mass, or of a pinned root; as the
   displacement of the root's reference position. Relative to another point, the centre of mass would move on a circle,
   and each step would change the momentum by its error on that circle. */
static void find_own_motion(const spari_solver *s, const spar_member *m, spari_pose *p) {
    const spari_state *at = &s->from;
    double center[6];
    int pinned = spari_member_constrained(m) == 3,
        has_center = !pinned && spari_body_center(s->body, at->q, at->v, center) > 0;
    for (int k = 0; k < 3 && has_center; k++) {
        p->q[k] = center[k] - m->xr[k];
        p->v[k] = center[3 + k];
    }
    for (int i = 0; i < s->n && !has_center; i++) {
        double arm[3];
        spari_member_arm(m, i, arm);
        for (int k = 0; k < 3; k++) {
            p->q[k] += (arm[k] + at->q[7 * i + k]) / s->n;
            p->v[k] += at->v[6 * i + k] / s->n;
        }
    }
    for (int k = 0; k < 3 && pinned; k++) {
        p->q[k] = at->q[k];
        p->v[k] = 0;
    }
}

/* What joints hold moves on a circle: about the joint, or about the joint that carries it all. The acceleration of its
   first interface node shows this circle. The angular velocity is that in the middle of the substep h, because it
   precesses; an acceleration of more than a radian in the substep is that of a vibration. */
static void find_carried_motion(const spari_solver *s, const spar_member *m, double h, spari_pose *p) {
    const spari_state *at = &s->from;
    const int i = s->condensed->node[0];
    double arm[3], rate[3];
    spari_member_arm(m, i, arm);
    spari_mean_rotation(s->n, at->a, rate);
    const double part = spari_norm(rate) * h * h <= 1 ? 0.5 * h : 0;
    for (int k = 0; k < 3; k++) {
        p->q[k] = arm[k] + at->q[7 * i + k];
        p->v[k] = at->v[6 * i + k];
        p->a[k] = at->a[6 * i + k];
        p->v[3 + k] += part * rate[k];
    }
}

static spari_pose mean_motion(const spari_solver *s, const spar_member *m, double h) {
    spari_pose p = {.q = {0, 0, 0, 1, 0, 0, 0}};
    spari_mean_rotation(s->n, s->from.v, p.v + 3);
    if (is_tied(s)) {
        find_carried_motion(s, m, h, &p);
    } else {
        find_own_motion(s, m, &p);
    }
    return p;
}

/* (S2): the acceleration rotates with the angular velocity, which stays. psi: the rotation, 1 rad at most. */
static spari_pose move_along(const spari_pose *p, double time) {
    spari_pose out = *p;
    double psi[3], rotation[4], second[3], first[3],
        change[3]; /* of exp(psi) a: twice its second integral, the first */
    for (int k = 0; k < 3; k++) {
        psi[k] = time * p->v[3 + k];
        second[k] = p->a[k];
    }
    for (int k = 20; k > 2; k--) {
        spari_cross(psi, second, second);
        for (int j = 0; j < 3; j++) {
            second[j] = p->a[j] + second[j] / k;
        }
    }
    spari_cross(psi, second, first);
    for (int k = 0; k < 3; k++) {
        first[k] = p->a[k] + 0.5 * first[k];
    }
    spari_cross(psi, first, change);
    for (int k = 0; k < 3; k++) {
        out.q[k] += time * (p->v[k] + 0.5 * time * second[k]);
        out.v[k] += time * first[k];
        out.a[k] += change[k];
    }
    spari_quat_exp(psi, rotation);
    spari_quat_mul(rotation, p->q + 3, out.q + 3);
    return out;
}

static spari_ends ends_from_rigid(const spari_solver *s, const spar_member *m, const spari_scheme *c, spari_stage *g) {
    g->along = move_along(&g->rigid, c->span);
    spari_ends e = {s->own[0], s->own[1], s->to, &g->along, 0};
    spari_root_look_from(s, m, &g->rigid, &s->from, &e.from);
    e.root_motion = c->span * (spari_norm(g->rigid.v) / s->body->length + spari_norm(g->rigid.v + 3));
    return e;
}

/* ---- change of the scheme ---- */

/* Position of node i from `pivot`. */
static void arm_from(const spari_solver *s, const spar_member *m, int i, const double pivot[3], double r[3]) {
    spari_member_arm(m, i, r);
    for (int k = 0; k < 3; k++) {
        r[k] += s->from.q[7 * i + k] - pivot[k];
    }
}

/* The angular acceleration of the rigid motion about `pivot` that fits the accelerations of the nodes best,
   rotations times the length, apart from the part that its angular velocity w explains. a0: the acceleration of the
   pivot. */
static void mean_angular_acceleration(const spari_solver *s, const spar_member *m, const double pivot[3],
                                      const double a0[3], const double w[3], double alpha[3]) {
    double L2 = s->body->length * s->body->length, A[9] = {0}, right[3] = {0}, c[3][3], det;
    for (int i = 0; i < s->n; i++) {
        const double *a = s->from.a + 6 * i;
        double r[3], t[3], rest[3];
        arm_from(s, m, i, pivot, r);
        spari_cross(w, r, t);
        spari_cross(w, t, rest);
        for (int k = 0; k < 3; k++) {
            rest[k] = a[k] - a0[k] - rest[k];
        }
        spari_cross(r, rest, t);
        for (int k = 0; k < 3; k++) {
            right[k] += t[k] + L2 * a[3 + k];
            A[4 * k] += spari_dot(r, r) + L2;
            for (int j = 0; j < 3; j++) {
                A[3 * k + j] -= r[k] * r[j];
            }
        }
    }
    spari_cross(A + 3, A + 6, c[0]);
    spari_cross(A + 6, A, c[1]);
    spari_cross(A, A + 3, c[2]);
    det = spari_dot(A, c[0]);
    for (int k = 0; k < 3; k++) {
        alpha[k] = (c[0][k] * right[0] + c[1][k] * right[1] + c[2][k] * right[2]) / det;
    }
}

/* A point of the rotation without third derivative: a pinned root, the node that a joint holds, or, of free members,
   the centre of mass, about which the shift changes no momentum. Returns 0 if there are several. */
static int find_pivot(const spari_solver *s, const spar_member *m, double pivot[3], double a0[3]) {
    int ends = s->condensed ? s->condensed->ends : 0, pinned = spari_member_constrained(m) == 3;
    if (ends > 1 || (ends == 1 && pinned && s->condensed->node[0] != 0)) {
        return 0;
    }
    const double zero[3] = {0, 0, 0};
    const int only = ends == 1 ? s->condensed->node[0] : 0;
    double center[6];
    if (ends == 0 && !pinned) { /* linear in the rates, so that it takes accelerations as well */
        int exists = spari_body_center(s->body, s->from.q, s->from.a, center) > 0;
        for (int k = 0; k < 3 && exists; k++) {
            pivot[k] = center[k] - m->xr[k];
            a0[k] = center[3 + k];
        }
        return exists;
    }
    arm_from(s, m, only, zero, pivot);
    memcpy(a0, s->from.a + 6 * (int64_t)only, 3 * sizeof *a0);
    return 1;
}

/* Generalised-alpha has velocities of stiff parts that differ from the true ones by -C h^2 times the third
   derivative of the position, with C of (E1), because h v + h^2 ((1/2 - beta) b^n + beta b^{n+1}) is the whole
   increment. A step of TR-BDF2 begins with the true velocities, and generalised-alpha continues with its own: v += f
   times that derivative for all parts that rotate as a rigid body. */
static void shift_rotating_nodes(const spari_solver *s, const spar_member *m, double f) {
    double w[3], pivot[3], a0[3], alpha[3];
    if (!find_pivot(s, m, pivot, a0)) {
        return;
    }
    spari_mean_rotation(s->n, s->from.v, w);
    mean_angular_acceleration(s, m, pivot, a0, w, alpha);
    for (int i = 0; i < s->n; i++) {
        double r[3], rotation[3], grow[3], a[3], b[3];
        arm_from(s, m, i, pivot, r);
        spari_cross(w, r, rotation);
        spari_cross(alpha, r, grow);
        spari_cross(w, rotation, a);
        for (int k = 0; k < 3; k++) {
            a[k] += grow[k]; /* the acceleration */
        }
        spari_cross(w, a, b);
        spari_cross(alpha, rotation, a);
        for (int k = 0; k < 3; k++) {
            s->from.v[6 * i + k] += f * (b[k] + 2 * a[k]);
        }
    }
}

void spari_steady_rate(const spar_member *m, const double w[3], const double a[3], double rate[3]) {
    double pushed[3];
    for (int k = 0; k < 3; k++) {
        pushed[k] = a[k] - m->body->gravity[k];
    }
    spari_cross(w, pushed, rate);
}

/* b^0 = a^0 + (alpha_m - alpha_f) h times the rate of the acceleration. For a rigid body also v^0 -= C h^2 times
   this rate, as shift_rotating_nodes does for members that deform. */
void spari_stage_remember(spari_solver *s, const spar_member *m, const spari_scheme *c) {
    double h = (c->alpha_m - c->alpha_f) * c->h, C = spari_scheme_error(c), rate[3];
    memcpy(s->begin.b, s->begin.a, (size_t)(6 * s->n) * sizeof *s->begin.b);
    if (m->root == SPAR_ROOT_DRIVEN && s->own[0].q) {
        const spari_pose root = spari_pose_of(s->begin.q, s->begin.v, s->begin.a);
        spari_root_look_from(s, m, &root, &s->begin, &s->own[0]);
        memcpy(s->begin.b, s->own[0].a, (size_t)(6 * s->n) * sizeof *s->begin.b);
        return;
    }
    for (int i = 0; i < s->n && !spari_member_root_is_prescribed(m) && m->session->clock.step == 0; i++) {
        double *v = s->begin.v + 6 * i, *b = s->begin.b + 6 * i;
        spari_steady_rate(m, v + 3, s->begin.a + 6 * i, rate);
        for (int k = 0; k < 3; k++) {
            b[k] += h * rate[k];
            v[k] -= s->n == 1 ? C * c->h * c->h * rate[k] : 0;
        }
    }
}

/* Begins a substep after one of the other scheme. */
static void change_scheme(const spari_solver *s, const spar_member *m, const spari_scheme *c, const spari_part *part) {
    double C = spari_scheme_error(c);
    if (!spari_member_rotates_stiffly(m) || c->still) {
        return;
    }
    if (c->rule == SPARI_TRAPEZOIDAL && part->alpha > 0) {
        shift_rotating_nodes(s, m, C * part->alpha * part->alpha);
    } else if (c->rule == SPARI_ALPHA && part->alpha == 0 && part->ratio > 0) {
        shift_rotating_nodes(s, m, -C * c->h * c->h);
    }
}

/* ---- stages ---- */

void spari_stage_drive(const spar_member *m, const spari_scheme *c, const spari_part *part, spari_stage *g) {
    g->root = spari_drive_at(m, part->to, part->dt);
    if (c->rule == SPARI_TRAPEZOIDAL) {
        g->root = spari_drive_stage(&g->before, &g->root, c->h, c->span);
    }
}

int spari_stage_begin(spari_solver *s, const spar_member *m, const spari_scheme *c, const spari_part *part,
                      spari_stage *g) {
    spari_scheme_mix_loads(m, &s->steps, 6 * s->n, part->end);
    if (s->offset_loads) {
        spari_offset_loads_at(s->offset_loads, part->end);
        memcpy(s->offset_loads->gravity, m->body->gravity, sizeof m->body->gravity);
    }
    change_scheme(s, m, c, part);
    int rigid = c->rule != SPARI_ALPHA && !c->still && turns(s, m);
    if (rigid && c->rule == SPARI_TRAPEZOIDAL) {
        g->rigid = mean_motion(s, m, c->h);
    }
    rigid = rigid && spari_norm(g->rigid.v + 3) * c->h <= farthest;
    spari_stage_drive(m, c, part, g);
    g->rotation[0] = 1;
    memset(g->rotation + 1, 0, 3 * sizeof *g->rotation);
    if (m->root == SPAR_ROOT_DRIVEN) {
        spari_quat_between(g->before.q + 3, g->root.q + 3, g->rotation);
    }
    if (rigid && c->rule == SPARI_TRAPEZOIDAL) {
        SPARI_REQUIRE(m->session, make_own_states(s) == SPAR_OK, SPAR_ERR_MEMORY,
                      "member '%s': no memory for the new step size", m->name);
    }
    g->ends = rigid ? ends_from_rigid(s, m, c, g)
                    : ends_of_root(s, m, c, &g->root, c->rule == SPARI_ALPHA ? part->ratio : 1, &s->from, &s->to);
    if (c->rule == SPARI_BACKWARD) {
        size_t size = (size_t)(6 * s->n) * sizeof(double);
        memcpy(s->stage_v, g->ends.to.v, size);
        memcpy(g->ends.from.b, g->ends.to.a, size);
    }
    return SPAR_OK;
}

/* rad, or relative to the length: for a smaller motion a substep has one solution only. */
static const double near = 0.1;

/* The change of position, or the distance that the change of velocity covers in h. */
static double moved_by(const spari_solver *s, double h) {
    double most = 0;
    for (int i = 0; i < s->n; i++) {
        const double *u = s->from.v + 6 * i, *v = s->to.v + 6 * i;
        const double dv[3] = {h * (v[0] - u[0]), h * (v[1] - u[1]), h * (v[2] - u[2])},
                     dw[3] = {h * (v[3] - u[3]), h * (v[4] - u[4]), h * (v[5] - u[5])};
        const double *p = s->from.q + 7 * i, *q = s->to.q + 7 * i;
        const double way[3] = {q[0] - p[0], q[1] - p[1], q[2] - p[2]};
        double rotation[4], psi[3];
        spari_quat_between(p + 3, q + 3, rotation);
        spari_quat_log(rotation, psi);
        double far = fmax(spari_norm(way), spari_norm(dv)) / s->body->length;
        most = fmax(most, fmax(far, fmax(spari_norm(psi), spari_norm(dw))));
    }
    return most;
}

/* The work of the loads at the part `at` of the step, in the state x, along the substep. s->dx holds their residual,
   which has the other sign. */
static double work_of_loads(spari_solver *s, const spar_member *m, const spari_state *x, double at) {
    double sum = 0;
    spari_scheme_mix_loads(m, &s->steps, 6 * s->n, at);
    memcpy(s->dx, s->steps.load, (size_t)(6 * s->n) * sizeof *s->dx);
    for (int i = 0; i < 6 * s->n; i++) {
        s->dx[i] *= -1;
    }
    if (spari_solver_has_applied(s, m)) {
        (void)spari_applied_residual(m, x->q, 1, s->dx);
    }
    for (int i = 0; i < s->n; i++) {
        double rotation[4], psi[3];
        spari_quat_between(s->from.q + 7 * i + 3, s->to.q + 7 * i + 3, rotation);
        spari_quat_log(rotation, psi);
        for (int k = 0; k < 3; k++) {
            sum -= s->dx[6 * i + k] * (s->to.q[7 * i + k] - s->from.q[7 * i + k]) + s->dx[6 * i + 3 + k] * psi[k];
        }
    }
    return sum;
}

void spari_stage_energy(spari_solver *s, const spar_member *m, const spari_part *part, double *gain, double *size) {
    double before[4], after[4];
    double work = 0.5 * (work_of_loads(s, m, &s->from, part->from) + work_of_loads(s, m, &s->to, part->to));
    spari_scheme_mix_loads(m, &s->steps, 6 * s->n, 0.5 * (part->from + part->to)); /* gravity may change too */
    spari_body_energy(s->body, s->from.q, s->from.v, before);
    spari_body_energy(s->body, s->to.q, s->to.v, after);
    spari_scheme_mix_loads(m, &s->steps, 6 * s->n, part->to);
    *size = before[0] + before[1] + fabs(work) + fabs(after[2] - before[2]);
    *gain = after[0] + after[1] + after[2] - before[0] - before[1] - before[2] - work;
}

int spari_stage_is_near(const spari_solver *s, const spar_member *m, double h) {
    return m->root == SPAR_ROOT_DRIVEN || m->added || s->offset_loads || !(moved_by(s, h) > near);
}

/* The algorithmic acceleration of a member with a driven root is relative to the root, all others are in global
   axes. */
void spari_stage_end(const spari_solver *s, spar_member *m, const spari_scheme *c, spari_stage *g) {
    const spari_ends *e = &g->ends;
    int driven = m->root == SPAR_ROOT_DRIVEN && e->root;
    if (c->rule == SPARI_BACKWARD) {
        spari_scheme_restart(c, 6 * s->n, driven ? e->from.a : s->from.a, driven ? e->to.a : e->absolute.a,
                             e->absolute.b);
    }
    if (c->rule == SPARI_BACKWARD && e->root) { /* the function that shows the motion reads it there */
        memcpy(e->to.b, e->absolute.b, (size_t)(6 * s->n) * sizeof *e->to.b);
    }
    g->before = g->root;
    spari_scheme_dissipate(m, c, &g->power, s->power);
}
