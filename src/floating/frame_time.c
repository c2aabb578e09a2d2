/* How a frame moves: between the nodes' motion and its own, in time, at rest; saved, and its energy. */
#include "frame.h"

#include "../algebra/cblas.h"
#include "../algebra/dense.h"
#include "../base/poison.h"
#include "../base/session.h"
#include "../math/rotation.h"
#include "../member/added_mass.h"
#include "../member/applied.h"
#include "../member/body.h"
#include "../member/pose.h"
#include "../time/driven_root.h"
#include "../time/steady_rotation.h"
#include "floating_root.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- between the nodes' motion and the frame ---- */

static void matvec3(const double T[9], const double x[3], double y[3]) {
    for (int k = 0; k < 3; k++) {
        y[k] = T[3 * k] * x[0] + T[3 * k + 1] * x[1] + T[3 * k + 2] * x[2];
    }
}

/* Deformation and rates of the nodes' motion, seen from the frame, as unknowns. */
static void from_nodes(spari_frame *f, const spar_member *m, const spari_motion *nodes, double *y, double *rate) {
    double *x = f->nodal, *xd = x + 6 * (int64_t)f->nodes;
    const spari_pose pose = spari_member_pose(m, nodes);
    for (int64_t i = 0; i < m->nodes; i++) {
        int64_t u = m->elements == 1 ? i : i - i / m->per_element;
        spari_member_deformation(m, &pose, nodes, i, x + 6 * u, xd + 6 * u);
    }
    if (!f->basis) {
        memcpy(y, x, (size_t)f->n * sizeof *y);
        memcpy(rate, xd, (size_t)f->n * sizeof *y);
        return;
    }
    /* modal: the nearest in the norm of the mass, Phi^T M x; M of the nodes is gone, but the body has it as forces of
     * accelerations at the reference */
    double *in[2] = {x, xd};
    double *out[2] = {y, rate}, *still = f->turned, *zero = still + 7 * (int64_t)f->nodes,
           *force = zero + 6 * (int64_t)f->nodes;
    spari_body loose = *m->body;
    loose.pre = NULL;
    memset(still, 0, (size_t)(13 * f->nodes) * sizeof *still);
    for (int i = 0; i < f->nodes; i++) {
        still[7 * i + 3] = 1;
    }
    for (int k = 0; k < 2; k++) {
        int first = f->carriage ? spari_carriage_split(f, in[k], out[k]) : f->held;
        spari_body_residual(&loose, still, zero, in[k], 0, force, NULL);
        SPARI_BLAS(cblas_dgemv(CblasRowMajor, CblasTrans, 6 * f->nodes, f->n - first, 1, f->basis + first, f->n, force,
                               1, 0, out[k] + first, 1));
        memset(out[k], 0, (size_t)f->held * sizeof *y);
    }
}

/* Rotations of the nodes follow their rotation vectors exactly, second derivatives to first order. */
void spari_frame_node(const spar_member *m, const spari_pose *root, int node, const double x[6], const double xd[6],
                      const double xdd[6], double q[7], double v[6], double a[6]) {
    double omega[3], alpha[3], arm[3], d[3], T[9], spin[3], twice[3], c1[3], c2[3], c3[3], p[4];
    spari_rotate_back(root->q + 3, root->v + 3, omega);
    spari_rotate_back(root->q + 3, root->a + 3, alpha);
    spari_member_arm(m, node, arm);
    for (int k = 0; k < 3; k++) {
        d[k] = arm[k] + x[k];
    }
    spari_quat_exp(x + 3, p);
    spari_quat_mul(root->q + 3, p, q + 3);
    spari_quat_normalise(q + 3);
    spari_tangent(x + 3, T);
    matvec3(T, xd + 3, spin);
    matvec3(T, xdd + 3, twice);
    spari_cross(omega, d, c1);
    for (int k = 0; k < 3; k++) {
        v[k] = c1[k] + xd[k];
        v[3 + k] = omega[k] + spin[k];
        c1[k] += 2 * xd[k]; /* omega x (omega x d + 2 w') */
    }
    spari_cross(omega, c1, c2);
    spari_cross(alpha, d, c3);
    for (int k = 0; k < 3; k++) {
        a[k] = c2[k] + c3[k] + xdd[k];
    }
    spari_cross(omega, spin, c1);
    for (int k = 0; k < 3; k++) {
        a[3 + k] = alpha[k] + twice[k] + c1[k];
    }
    spari_rotate(root->q + 3, d, d);
    for (int k = 0; k < 6; k += 3) {
        spari_rotate(root->q + 3, v + k, v + k);
        spari_rotate(root->q + 3, a + k, a + k);
    }
    for (int k = 0; k < 3; k++) {
        q[k] = d[k] - arm[k] + root->q[k];
        v[k] += root->v[k];
        a[k] += root->a[k];
    }
}

const double *spari_frame_nodal(const spari_frame *f, const double *y, double *x) {
    if (!f->basis) {
        return y;
    }
    SPARI_BLAS(cblas_dgemv(CblasRowMajor, CblasNoTrans, 6 * f->nodes, f->n, 1, f->basis, f->n, y, 1, 0, x, 1));
    return x;
}

/* The nodes' motion q, v, a [unique] of a state */
static void to_nodes(spari_frame *f, const spar_member *m, const spari_frame_state *s, double *q, double *v,
                     double *a) {
    int64_t n6 = 6 * (int64_t)f->nodes;
    const double *x = spari_frame_nodal(f, s->y, f->nodal), *xd = spari_frame_nodal(f, s->v, f->nodal + n6),
                 *xdd = spari_frame_nodal(f, s->a, f->nodal + 2 * n6);
    for (int i = 0; i < f->nodes; i++) {
        spari_frame_node(m, &s->root, i, x + 6 * i, xd + 6 * i, xdd + 6 * i, q + 7 * i, v + 6 * i, a + 6 * i);
    }
}

void spari_frame_publish(spari_frame *f, spar_member *m, const spari_frame_state *s) {
    int64_t n = f->nodes;
    double *q = f->turned, *v = q + 7 * n, *a = v + 6 * n;
    to_nodes(f, m, s, q, v, a);
    const double *x = f->basis ? f->nodal : s->y;
    m->overturned = 0;
    for (int i = 0; i < f->nodes; i++) {
        m->overturned |= spari_norm(x + 6 * i + 3) > M_PI;
    }
    spari_member_publish(m, q, v, a, &m->after);
}

/* ---- time ---- */

/* The same turn but for rounding, which accelerations have of omega squared. */
static int is_turn(const double kept[6], const double turn[6]) {
    const double speed = spari_norm(turn), rate = spari_norm(turn + 3) + speed * speed;
    double change[6];
    for (int k = 0; k < 6; k++) {
        change[k] = turn[k] - kept[k];
    }
    return spari_norm(change) <= 1e-13 * speed && spari_norm(change + 3) <= 1e-13 * rate;
}

void spari_frame_combine(spari_frame *f, const double turn[6]) {
    const double *omega = turn;
    if (f->combined && is_turn(f->turn, turn)) {
        return;
    }
    memcpy(f->turn, turn, sizeof f->turn);
    f->combined = 1;
    if (f->sumC) {
        for (int64_t i = 0; i < f->size; i++) {
            f->sumC[i] = f->D ? f->D[i] : 0;
        }
    }
    if (!f->N[0]) {
        return;
    }
    memcpy(f->sumK, f->K, (size_t)f->size * sizeof *f->sumK);
    memset(f->sumf, 0, (size_t)f->n * sizeof *f->sumf);
    double c[SPARI_TURNS];
    for (int k = 0; k < SPARI_TURNS; k++) {
        c[k] = omega[spari_frame_pair[k][0]] * omega[spari_frame_pair[k][1]];
        if (c[k] != 0) {
            cblas_daxpy((int)f->size, c[k], f->N[k], 1, f->sumK, 1);
            cblas_daxpy(f->n, c[k], f->f[k], 1, f->sumf, 1);
        }
    }
    for (int k = 0; k < 3; k++) {
        if (omega[k] != 0) {
            cblas_daxpy((int)f->size, omega[k], f->G[k], 1, f->sumC, 1);
        }
        if (turn[3 + k] != 0) {
            cblas_daxpy((int)f->size, turn[3 + k], f->E[k], 1, f->sumK, 1);
        }
    }
}

/* Of a root that moves so; still: without inertia. */
static void combine_at(spari_frame *f, const spari_pose *root, int still) {
    double turn[6] = {0};
    spari_rotate_back(root->q + 3, root->v + 3, turn);
    if (!still) {
        spari_rotate_back(root->q + 3, root->a + 3, turn + 3);
    }
    spari_frame_combine(f, turn);
}

void spari_frame_gather(const spari_frame *f, const double *x, double *out) {
    if (f->basis) {
        SPARI_BLAS(cblas_dgemv(CblasRowMajor, CblasTrans, 6 * f->nodes, f->n, 1, f->basis, f->n, x, 1, 0, out, 1));
    } else {
        memcpy(out, x, (size_t)f->n * sizeof *out);
    }
}

/* Nodal loads [unique][6] in global axes, as loads on the unknowns. Destroys x. */
static void turn_loads(const spari_frame *f, const double q[4], double *x, double *out) {
    for (int i = 0; i < 6 * f->nodes; i += 3) {
        spari_rotate_back(q, x + i, x + i);
    }
    spari_frame_gather(f, x, out);
}

/* What does not depend on the deformation: r = f + M (rigid acceleration - weight) + pretension - loads. Loads that
 * follow depend on it and are taken at the latest state. */
static void forcing(spari_frame *f, const spar_member *m, const spari_frame_state *s, int still, double *out) {
    double weight[3], *x = f->nodal;
    memcpy(x, f->steps.load, (size_t)(6 * f->nodes) * sizeof *x);
    if (m->applied) {
        double *q = f->turned, *v = q + 7 * (int64_t)f->nodes, *a = v + 6 * (int64_t)f->nodes;
        to_nodes(f, m, s, q, v, a);
        for (int i = 0; i < 6 * f->nodes; i++) {
            x[i] = -f->steps.load[i];
        }
        spari_applied_residual(m, q, 1, x);
        for (int i = 0; i < 6 * f->nodes; i++) {
            x[i] = -x[i];
        }
    }
    turn_loads(f, s->root.q + 3, x, out);
    for (int i = 0; i < f->n; i++) {
        out[i] = (still || !f->sumf ? 0 : f->sumf[i]) - out[i];
    }
    cblas_daxpy(f->pull ? f->n : 0, 1, f->pull, 1, out, 1);
    if (f->rigid[0]) {
        double rate[6] = {0};
        spari_rotate_back(s->root.q + 3, m->body->gravity, weight);
        if (!still) {
            spari_rotate_back(s->root.q + 3, s->root.a, rate);
            spari_rotate_back(s->root.q + 3, s->root.a + 3, rate + 3);
        }
        for (int k = 0; k < 3; k++) {
            rate[k] -= weight[k];
        }
        for (int k = 0; k < 6; k++) {
            if (rate[k] != 0) {
                cblas_daxpy(f->n, rate[k], f->rigid[k], 1, out, 1);
            }
        }
    }
}

/* r = forcing + M a + C v + K y, the held rows out */
static void unbalance(const spari_frame *f, const spari_frame_state *s, int still, const double *fixed, double *r) {
    memcpy(r, fixed, (size_t)f->n * sizeof *r);
    spari_frame_add_times(f, f->sumK ? f->sumK : f->K, s->y, 1, r);
    if (f->sumC) {
        spari_frame_add_times(f, f->sumC, s->v, 1, r);
    }
    if (f->M && !still) {
        spari_frame_add_times(f, f->M, s->a, 1, r);
    }
    memset(r, 0, (size_t)f->held * sizeof *r);
}

/* A: f->A, or NULL: without it */
static int factor_with(spari_frame *f, const spari_scheme *c, const double *A) {
    int singular;
    spari_frame_keep_factors(f);
    spari_frame_factor(f, f->sumK ? f->sumK : f->K, 1, f->sumC, c->cv, A, c->cm, f->element, &singular);
    f->factored = !singular;
    f->kept_cm = c->cm, f->kept_cv = c->cv;
    memcpy(f->kept_turn, f->turn, sizeof f->turn);
    return singular;
}

static int factor_step(spari_frame *f, const spari_scheme *c) {
    return factor_with(f, c, f->A);
}

static double largest(const spari_frame *f, const double *x) {
    double big = 0;
    for (int i = 0; i < f->n; i++) {
        big = fmax(big, fabs(x[i]));
    }
    return big;
}

static spari_rates rates_from(const spari_frame_state *s, int first) {
    return (spari_rates){s->v + first, s->a + first, s->b + first, NULL};
}

/* Starting values: the accelerations stay. */
static void predict_unknowns(const spari_frame *f, const spari_scheme *c, const spari_frame_state *from,
                             spari_frame_state *to) {
    int held = f->held, n = f->n - held;
    double *x = f->dx + held;
    if (c->still) {
        memset(x, 0, (size_t)n * sizeof *x);
        memset(to->v + held, 0, (size_t)n * sizeof *x);
        memset(to->a + held, 0, (size_t)n * sizeof *x);
        memset(to->b + held, 0, (size_t)n * sizeof *x);
    } else {
        spari_rates before = rates_from(from, held);
        before.stage = f->stage_v + held;
        spari_scheme_predict(c, SPARI_KEEP_ACCELERATION, n, before, x, rates_from(to, held));
    }
    for (int k = held; k < f->n; k++) {
        to->y[k] = from->y[k] + f->dx[k];
    }
}

/* Where the root jumps (hosts that give no accelerations, a sudden start) the nodes keep place and velocity: seen from
   it they lose the jump; modal ones to the nearest, in the norm of the mass. */
void spari_frame_take_jump(const spari_frame *f, const spar_member *m, double h, spari_frame_state *from,
                           const spari_frame_state *to) {
    double jump[2][6], *rows[2] = {from->v, from->y};
    spari_drive_jump(&from->root, &to->root, h, jump[0], jump[1]);
    for (int s = 0; s < 2; s++) {
        const double *J = jump[s];
        double *x = rows[s];
        if (f->carriage && f->basis) {
            spari_carriage_take(f, m, J, x);
        }
        for (int k = 6; k < f->n && f->basis && !f->carriage; k++) {
            x[k] -= cblas_ddot(6, f->M + (int64_t)f->n * k, 1, J, 1);
        }
        for (int i = 1; i < f->nodes && !f->basis; i++) {
            double arm[3], turn[3];
            spari_member_arm(m, i, arm);
            spari_cross(J + 3, arm, turn);
            for (int k = 0; k < 3; k++) {
                x[6 * i + k] -= J[k] + turn[k];
                x[6 * i + 3 + k] -= J[3 + k];
            }
        }
    }
}

void spari_frame_stage(spari_frame *f, const spar_member *m, const spari_scheme *c, const spari_part *part,
                       const spari_pose *root) {
    size_t size = (size_t)f->n * sizeof(double);
    if (c->rule == SPARI_ALPHA) {
        spari_scheme_stretch(part->ratio, f->n, f->from.a, f->from.b);
    } else if (c->rule == SPARI_BACKWARD) {
        memcpy(f->stage_v, f->to.v, size);
        memcpy(f->from.b, f->to.a, size);
    }
    f->to.root = m->root == SPAR_ROOT_DRIVEN ? *root : f->begin.root;
    if (c->rule != SPARI_BACKWARD && m->root == SPAR_ROOT_DRIVEN && !c->still) { /* the stage has lost it already */
        spari_frame_take_jump(f, m, c->span, &f->from, &f->to);
    }
}

void spari_frame_take_velocities(spari_frame *f, const spar_member *m, spari_frame_state *state) {
    from_nodes(f, m, &m->now, f->increment, state->v);
}

void spari_frame_restart_scheme(spari_frame *f, const spari_scheme *c) {
    if (c->rule == SPARI_BACKWARD) {
        spari_scheme_restart(c, f->n, f->from.a, f->to.a, f->to.b);
    }
}

/* out += what the guess of the fluid's added mass takes of the accelerations as they are published: those of the nodes,
   which follow their rotation vectors and the root, so that at convergence it is to rounding what the loads have been
   corrected by. Spends dx. */
static void add_fictitious(spari_frame *f, const spar_member *m, const spari_frame_state *s, double *out) {
    double *q = f->turned, *v = q + 7 * (int64_t)f->nodes, *a = v + 6 * (int64_t)f->nodes, *x = f->nodal;
    to_nodes(f, m, s, q, v, a);
    memset(x, 0, (size_t)(6 * f->nodes) * sizeof *x);
    (void)spari_added_times(m, SPARI_UNKNOWNS, SPARI_UNKNOWNS, a, 1, x);
    turn_loads(f, s->root.q + 3, x, f->dx);
    cblas_daxpy(f->n, 1, f->dx, 1, out, 1);
}

enum { MOST_ITERATIONS = 30 };

static int no_solution(const spar_member *m) {
    return spari_fail(m->session, SPAR_ERR_NUMERIC,
                      "member '%s': the linear equations have no solution in the step from t = %g; look at the "
                      "turning speed of its root, or at loads that follow it",
                      m->name, m->session->time);
}

/* One stage. The equations are linear: one solution with their own matrix ends it; with the matrix of a slightly
   other turn, or with loads that follow, the corrections shrink until they are rounding. */
static int solve_stage(spari_frame *f, const spar_member *m, const spari_scheme *c) {
    const spari_frame_state *from = &f->from;
    spari_frame_state *to = &f->to;
    double last = 0;
    combine_at(f, &to->root, c->still);
    f->factored = f->factored && c->cm == f->kept_cm && c->cv == f->kept_cv;
    predict_unknowns(f, c, from, to);
    double *fixed = f->increment;
    for (int it = 0; it < MOST_ITERATIONS; it++) {
        if (it == 0 || m->applied || f->A) {
            forcing(f, m, to, c->still, fixed);
        }
        if (f->A) {
            add_fictitious(f, m, to, fixed);
        }
        unbalance(f, to, c->still, fixed, f->r);
        if (!f->factored && factor_step(f, c)) {
            return 1;
        }
        int exact = !m->applied && !f->A && memcmp(f->kept_turn, f->turn, sizeof f->turn) == 0;
        memcpy(f->dx, f->r, (size_t)f->n * sizeof *f->dx);
        if (spari_linear_solve(f->linear, f->dx)) {
            return 1;
        }
        f->solves++;
        spari_scheme_correct(c, 1, f->n - f->held, f->dx + f->held, to->y + f->held, rates_from(to, f->held));
        double step = largest(f, f->dx), theta = last > 0 ? step / last : 0;
        if (exact || step <= m->session->newton_atol + m->session->newton_rtol * largest(f, to->y) ||
            (it > 2 && theta > 0.5 && step <= 1e-10 * largest(f, to->y))) {
            return 0;
        }
        if (theta > 0.2) {
            f->factored = 0;
        }
        last = step;
    }
    return 1;
}

static void unbalance_of_frame(void *self, const spar_member *m, const double *a, double *r) {
    spari_frame *f = self;
    (void)m, (void)a; /* those of t^0, in place */
    unbalance(f, &f->begin, 0, f->increment, r);
}

/* Accelerations at t^0. */
static int start_frame(spari_frame *f, const spar_member *m, const spari_scheme *c) {
    spari_frame_state *b = &f->begin;
    int singular;
    combine_at(f, &b->root, c->still);
    spari_frame_factor(f, f->sumK ? f->sumK : f->K, 1, NULL, 0, NULL, c->cm, f->element, &singular);
    f->factored = 0;
    memcpy(f->steps.load, f->steps.load0, (size_t)(6 * f->nodes) * sizeof *f->steps.load);
    forcing(f, m, b, c->still, f->increment);
    if (singular || spari_scheme_start(c, f->linear, f->held, f->n, unbalance_of_frame, f, m, f->r, b->a)) {
        return no_solution(m);
    }
    memcpy(b->b, b->a, (size_t)f->n * sizeof *b->b);
    f->steps.started = 1;
    return SPAR_OK;
}

static void copy_state(const spari_frame *f, const spari_frame_state *from, spari_frame_state *to) {
    memcpy(to->y, from->y, (size_t)(4 * f->n) * sizeof *to->y);
    to->root = from->root;
}

static void swap_states(spari_frame_state *a, spari_frame_state *b) {
    spari_frame_state t = *a;
    *a = *b;
    *b = t;
}

double spari_frame_damped_power(spari_frame *f, const spari_frame_state *s) {
    double power = 0;
    if (f->D) {
        memset(f->r, 0, (size_t)f->n * sizeof *f->r);
        spari_frame_add_times(f, f->D, s->v, 1, f->r);
        power = cblas_ddot(f->n, f->r, 1, s->v, 1);
    }
    return power;
}

/* A member by itself, in a step. */
typedef struct frame_run {
    spari_frame *f;
    spar_member *member;
    spari_pose before, root; /* of a driven root, at the beginning of the substep and at the end of the stage */
    double power;
} frame_run;

static void start_run(frame_run *t) {
    spari_frame *f = t->f;
    copy_state(f, &f->begin, &f->to);
    f->steps.solved = f->steps.begin;
    t->before = t->member->drive[0];
    t->power = spari_frame_damped_power(f, &f->begin);
    t->member->dissipated_step = 0;
}

static void enter_alone_frame(void *self, const spari_part *part) {
    const frame_run *t = self;
    (void)part;
    swap_states(&t->f->from, &t->f->to);
}

static int solve_alone_frame(void *self, const spari_scheme *c, const spari_part *part) {
    frame_run *t = self;
    spari_frame *f = t->f;
    spari_scheme_mix_loads(t->member, &f->steps, 6 * f->nodes, part->end);
    t->root = spari_drive_at(t->member, part->to, part->dt);
    if (c->rule == SPARI_TRAPEZOIDAL) {
        t->root = spari_drive_stage(&t->before, &t->root, c->h, c->span);
    }
    spari_frame_stage(f, t->member, c, part, &t->root);
    if (solve_stage(f, t->member, c)) {
        f->factored = 0;
        return no_solution(t->member);
    }
    return SPAR_OK;
}

static int leave_alone_frame(void *self, const spari_scheme *c, const spari_part *part) {
    frame_run *t = self;
    (void)part;
    spari_frame_restart_scheme(t->f, c);
    t->before = t->root;
    spari_scheme_dissipate(t->member, c, &t->power, spari_frame_damped_power(t->f, &t->f->to));
    return SPAR_OK;
}

void spari_frame_poison(spari_frame *f) {
    double *const work[] = {f->r, f->dx, f->increment, f->steps.load, f->nodal};
    for (size_t k = 0; k < sizeof work / sizeof *work; k++) {
        spari_poison(work[k], f->n);
    }
    spari_poison(f->stage_v, f->n);
    spari_poison(f->nodal, 18 * (int64_t)f->nodes);
    spari_poison(f->turned, 19 * (int64_t)f->nodes);
    spari_poison(f->element, (int64_t)f->block * f->block);
    spari_poison(f->to.y, 4 * (int64_t)f->n);
}

int spari_frame_advance(spari_frame *f, spar_member *m, double dt) {
    static const spari_stepper how = {
        .enter = enter_alone_frame, .solve = solve_alone_frame, .leave = leave_alone_frame};
    const spari_scheme c = spari_scheme_of(m, m->body->D != NULL, dt / m->session->substeps);
    frame_run t = {.f = f, .member = m};
    spari_scheme_loads(m, &f->steps);
    if (!f->steps.started && !c.still) {
        SPARI_TRY(start_frame(f, m, &c));
    }
    spari_frame_poison(f);
    start_run(&t);
    SPARI_TRY(spari_scheme_run(&how, &t, &c, &m->cuts, &f->steps.solved, m->session, dt));
    spari_frame_publish(f, m, &f->to);
    return SPAR_OK;
}

int spari_frame_balance(spari_frame *f, spar_member *m, double dt) {
    const spari_scheme c = spari_scheme_of(m, 0, dt / m->session->substeps);
    frame_run t = {.f = f, .member = m};
    spari_scheme_loads(m, &f->steps);
    if (!f->steps.started && !c.still) {
        SPARI_TRY(start_frame(f, m, &c));
    }
    start_run(&t);
    spari_frame_publish(f, m, &f->to);
    return SPAR_OK;
}

int spari_frame_answer(spari_frame *f, const spar_member *m, const double *load, double *motion) {
    int64_t n6 = 6 * (int64_t)f->nodes;
    const double *root = f->to.root.q, *x = f->dx;
    spari_scheme c = spari_scheme_last(m, m->body->D != NULL, &f->steps.solved);
    if (!f->factored && factor_step(f, &c)) {
        return 1;
    }
    spari_member_gather(m, load, f->nodal);
    turn_loads(f, root + 3, f->nodal, f->dx);
    memset(f->dx, 0, (size_t)f->held * sizeof *f->dx);
    if (spari_linear_solve(f->linear, f->dx)) {
        return 1;
    }
    if (f->basis) {
        SPARI_BLAS(cblas_dgemv(CblasRowMajor, CblasNoTrans, (int)n6, f->n, 1, f->basis, f->n, x, 1, 0, f->nodal, 1));
        x = f->nodal;
    }
    for (int64_t i = 0; i < n6; i += 3) {
        spari_rotate(root + 3, x + i, f->turned + i);
    }
    spari_member_from_unique(m, 6, f->turned, motion);
    return 0;
}

/* The products of the columns that are free, of which none is made of others, factored. */
static int factor_gram(spari_frame *f) {
    int n = f->n;
    if (f->gram) {
        return SPAR_OK;
    }
    if (!(f->gram = spari_zalloc((int64_t)n * n, sizeof *f->gram))) {
        return SPAR_ERR_MEMORY;
    }
    SPARI_BLAS(cblas_dgemm(CblasRowMajor, CblasTrans, CblasNoTrans, n, n, 6 * f->nodes, 1, f->basis, n, f->basis, n, 0,
                           f->gram, n));
    for (int k = 0; k < f->held * n; k++) {
        int i = k / n, j = k % n;
        f->gram[i * n + j] = f->gram[j * n + i] = i == j;
    }
    if (spari_cholesky(n, f->gram)) {
        free(f->gram);
        f->gram = NULL;
    }
    return SPAR_OK;
}

/* With phi the basis, phi (phi^T phi)^-1 phi^T load: of all loads that do the same to the modes the smallest. */
int spari_frame_felt(spari_frame *f, const spar_member *m, double *load) {
    const double *root = f->to.root.q;
    int n = f->n;
    SPARI_TRY(factor_gram(f));
    if (!f->gram) {
        return SPAR_OK;
    }
    spari_member_gather(m, load, f->nodal);
    turn_loads(f, root + 3, f->nodal, f->dx);
    memset(f->dx, 0, (size_t)f->held * sizeof *f->dx);
    spari_cholesky_solve(n, f->gram, f->dx);
    SPARI_BLAS(cblas_dgemv(CblasRowMajor, CblasNoTrans, 6 * f->nodes, n, 1, f->basis, n, f->dx, 1, 0, f->nodal, 1));
    for (int64_t i = 0; i < 6 * f->nodes; i += 3) {
        spari_rotate(root + 3, f->nodal + i, f->turned + i);
    }
    spari_member_from_unique(m, 6, f->turned, load);
    for (int64_t e = 1; e < m->elements; e++) { /* its ends bear half of it each */
        double *left = load + 6 * (e * m->per_element - 1);
        for (int k = 0; k < 12; k++) {
            left[k] *= 0.5;
        }
    }
    return SPAR_OK;
}

/* A frame that joints tie has its root's orientation and what remains at the ends besides. */
static int64_t size_of_ends(const spari_frame *f) {
    return f->carriage ? 4 + spari_condensed_state_size(f->carriage->condensed) : 0;
}

void spari_frame_keep_factors(spari_frame *f) {
    int64_t factors = spari_linear_state_size(f->linear);
    double *to = f->begun.factored ? spari_snapshot_take(&f->before, factors + size_of_ends(f)) : NULL;
    if (!to) {
        return;
    }
    spari_linear_save(f->linear, to);
    if (f->carriage) {
        memcpy(to + factors, f->carriage->root->kept_q, 4 * sizeof *to);
        spari_condensed_save(f->carriage->condensed, to + factors + 4);
    }
}

void spari_frame_begin(spari_frame *f) {
    f->begun.factored = f->factored;
    f->begun.cm = f->kept_cm, f->begun.cv = f->kept_cv;
    memcpy(f->begun.turn, f->kept_turn, sizeof f->kept_turn);
    spari_snapshot_open(&f->before, 1);
    if (f->carriage) {
        spari_solver_begin(f->carriage->root);
    }
}

void spari_frame_reject(spari_frame *f) {
    if (!f->before.open) {
        return;
    }
    f->factored = f->begun.factored && f->before.taken >= 0;
    f->kept_cm = f->begun.cm, f->kept_cv = f->begun.cv;
    memcpy(f->kept_turn, f->begun.turn, sizeof f->kept_turn);
    if (f->carriage) {
        spari_solver_reject(f->carriage->root);
    }
    if (f->before.taken > 0) {
        const double *from = f->before.data, *ends = from + spari_linear_state_size(f->linear);
        spari_linear_load(f->linear, from);
        if (f->carriage) {
            memcpy(f->carriage->root->kept_q, ends, 4 * sizeof *ends);
            spari_condensed_load(f->carriage->condensed, f->carriage->condensed->fixed, ends + 4);
        }
    }
}

void spari_frame_accept(spari_frame *f) {
    spari_snapshot_close(&f->before);
    swap_states(&f->begin, &f->to);
    if (f->carriage) {
        spari_solver_accept(f->carriage->root);
    }
    f->steps.begin = f->steps.solved;
}

void spari_frame_restart(spari_frame *f, const spar_member *m) {
    f->begin.root = spari_member_pose(m, &m->now);
    if (f->carriage) {
        spari_carriage_restart(f, m);
    }
    if (m->root == SPAR_ROOT_DRIVEN || m->floats) {
        memcpy(f->begin.root.a, m->now.a, sizeof f->begin.root.a);
    }
    memset(f->begin.y, 0, (size_t)(4 * f->n) * sizeof(double));
    from_nodes(f, m, &m->now, f->begin.y, f->begin.v);
    copy_state(f, &f->begin, &f->to);
    f->steps.started = 0;
    f->steps.begin = (spari_pattern){0, SPARI_EVEN};
}

int spari_frame_static(spari_frame *f, spar_member *m, const double *fluid) {
    double last = 0;
    int failed = 1;
    spari_turn turn;
    SPARI_REQUIRE(m->session, f->held == 6, SPAR_ERR_STATE,
                  "member '%s': nothing holds a linear member that its root leaves free to turn; fix or drive its root",
                  m->name);
    int turning = m->root == SPAR_ROOT_DRIVEN && spari_turn_of(m, f->begin.root.v, f->begin.root.a, &turn);
    spari_member_gather(m, m->dead, f->steps.load);
    spari_member_gather(m, fluid, f->steps.load1);
    for (int i = 0; i < 6 * f->nodes; i++) {
        f->steps.load[i] += f->steps.load1[i];
    }
    spari_scheme c = {.cm = 0, .cv = 0};
    copy_state(f, &f->begin, &f->to);
    memset(f->to.root.a + 3, 0, 3 * sizeof(double)); /* steady, or at rest */
    if (!turning) {
        memset(f->to.root.a, 0, sizeof f->to.root.a);
        memset(f->to.root.v, 0, sizeof f->to.root.v);
    }
    combine_at(f, &f->to.root, !turning);
    memset(f->to.v, 0, (size_t)(3 * f->n) * sizeof(double));
    int singular = factor_step(f, &c);
    f->factored = 0;
    for (int it = 0; it < MOST_ITERATIONS && failed && !singular; it++) {
        forcing(f, m, &f->to, !turning, f->increment);
        unbalance(f, &f->to, !turning, f->increment, f->r);
        memcpy(f->dx, f->r, (size_t)f->n * sizeof *f->dx);
        singular = spari_linear_solve(f->linear, f->dx);
        for (int k = 6; k < f->n; k++) {
            f->to.y[k] -= f->dx[k];
        }
        double step = largest(f, f->dx);
        failed = m->applied && step > 1e-11 * largest(f, f->to.y) && !(it > 2 && step > 0.5 * last && step < 1e-9);
        last = step;
    }
    if (!singular && !failed) {
        spari_frame_publish(f, m, &f->to);
        failed = spari_first_nonfinite(m->after.q, 7 * m->nodes) >= 0 ||
                 spari_first_nonfinite(m->after.a, 6 * m->nodes) >= 0;
    }
    if (singular || failed) {
        return spari_fail(m->session, SPAR_ERR_NUMERIC,
                          "member '%s': the linear member has no equilibrium under these loads; the state is as it was",
                          m->name);
    }
    return SPAR_OK;
}

enum { STATE_BEGUN = 9, STATE_HEAD = 22, STATE_TURN = 10, STATE_ROOT = sizeof(spari_pose) / sizeof(double) };

/* The head, and the states at either end of the step. */
static int64_t ends_size(const spari_frame *f) {
    return STATE_HEAD + 2 * (STATE_ROOT + 4 * (int64_t)f->n);
}

/* And what the step began with. */
static int64_t own_size(const spari_frame *f) {
    return ends_size(f) + STATE_BEGUN + spari_snapshot_size(&f->before);
}

int64_t spari_frame_state_size(const spari_frame *f) {
    return own_size(f) + (f->carriage ? spari_carriage_state_size(f, f->factored) : 0);
}

void spari_frame_save(const spari_frame *f, double *state) {
    const double head[STATE_HEAD] = {f->n,
                                     f->factored,
                                     f->kept_cm,
                                     f->kept_cv,
                                     f->steps.begin.h,
                                     f->steps.solved.h,
                                     f->steps.started,
                                     f->combined,
                                     f->steps.begin.even,
                                     f->steps.solved.even};
    const spari_frame_state *const ends[2] = {&f->begin, &f->to};
    memcpy(state, head, sizeof head);
    memcpy(state + STATE_TURN, f->turn, sizeof f->turn);
    memcpy(state + STATE_TURN + 6, f->kept_turn, sizeof f->kept_turn);
    double *at = state + STATE_HEAD;
    for (int k = 0; k < 2; k++, at += STATE_ROOT + 4 * (int64_t)f->n) {
        memcpy(at, &ends[k]->root, sizeof ends[k]->root);
        memcpy(at + STATE_ROOT, ends[k]->y, (size_t)(4 * f->n) * sizeof *state);
    }
    const double begun[STATE_BEGUN] = {f->begun.factored, f->begun.cm, f->begun.cv};
    memcpy(at, begun, sizeof begun);
    memcpy(at + 3, f->begun.turn, sizeof f->begun.turn);
    spari_snapshot_save(&f->before, at + STATE_BEGUN);
    if (f->carriage) {
        spari_carriage_save(f, at + STATE_BEGUN + spari_snapshot_size(&f->before));
    }
}

/* The same of a frame that has been saved; -1: it cannot be one. */
static int64_t saved_size(const spari_frame *f, const double *state, int64_t count) {
    int64_t at = ends_size(f) + STATE_BEGUN, expected = spari_linear_state_size(f->linear) + size_of_ends(f);
    int64_t head = at + SPARI_SNAPSHOT_HEAD;
    if (count < head) {
        return -1;
    }
    int64_t numbers = state[at + 1] > 0 ? expected : 0;
    int sound = spari_snapshot_is(state + at, SPARI_SNAPSHOT_HEAD + numbers, expected) && count >= head + numbers &&
                (numbers == 0 || spari_linear_is_state(f->linear, state + head));
    return sound ? head + numbers : -1;
}

int spari_frame_is_state(const spari_frame *f, const double *state, int64_t count) {
    int64_t own = saved_size(f, state, count);
    if (own < 0 || count < own || state[0] != f->n || !spari_pattern_is(state[4], state[8]) ||
        !spari_pattern_is(state[5], state[9])) {
        return 0;
    }
    return f->carriage ? spari_carriage_is_state(f, state + own, count - own, state[1] != 0) : count == own;
}

/* The kept factors are those of the kept turn and coefficients, to the last bit. */
void spari_frame_load(spari_frame *f, const double *state) {
    spari_scheme c = {.cm = state[2], .cv = state[3]};
    f->factored = 0;
    f->combined = 0;
    const double *begun = state + ends_size(f), *before = begun + STATE_BEGUN;
    f->begun.factored = begun[0] != 0, f->begun.cm = begun[1], f->begun.cv = begun[2];
    memcpy(f->begun.turn, begun + 3, sizeof f->begun.turn);
    spari_snapshot_close(&f->before); /* while it is factored */
    if (f->carriage) {
        f->factored = state[1] != 0;
        f->kept_cm = c.cm, f->kept_cv = c.cv;
        spari_carriage_load(f, before + SPARI_SNAPSHOT_HEAD + (int64_t)before[2]);
    } else if (state[1] != 0) {
        spari_frame_combine(f, state + STATE_TURN + 6);
        factor_step(f, &c);
    }
    spari_snapshot_load(&f->before, before, f->factored);
    f->combined = 0;
    if (state[7] != 0 && !f->carriage) {
        spari_frame_combine(f, state + STATE_TURN);
    }
    f->steps.begin = (spari_pattern){state[4], (int)state[8]};
    f->steps.solved = (spari_pattern){state[5], (int)state[9]};
    f->steps.started = state[6] != 0;
    spari_frame_state *const ends[2] = {&f->begin, &f->to};
    state += STATE_HEAD;
    for (int k = 0; k < 2; k++, state += STATE_ROOT + 4 * (int64_t)f->n) {
        memcpy(&ends[k]->root, state, sizeof ends[k]->root);
        memcpy(ends[k]->y, state + STATE_ROOT, (size_t)(4 * f->n) * sizeof *state);
    }
}

/* x^T X x / 2 */
static double half_form(spari_frame *f, const double *X, const double *x) {
    memset(f->r, 0, (size_t)f->n * sizeof *f->r);
    spari_frame_add_times(f, X, x, 0.5, f->r);
    return cblas_ddot(f->n, x, 1, f->r, 1);
}

int spari_frame_energy(spari_frame *f, const spar_member *m, double energy[4]) {
    double *y = spari_zalloc(2 * (int64_t)f->n, sizeof *y), *rate = y + f->n;
    if (!y) {
        return SPAR_ERR_MEMORY;
    }
    from_nodes(f, m, &m->after, y, rate);
    energy[1] = half_form(f, f->K, y) + (f->pull ? cblas_ddot(f->n, f->pull, 1, y, 1) : 0);
    energy[1] -= m->foundation ? spari_foundation_energy(m, m->after.q) : 0;
    if (m->root != SPAR_ROOT_DRIVEN && !m->floats) { /* the frame stands: these are what the equations keep */
        energy[0] = f->M && (m->effects & SPAR_EFFECT_INERTIA) ? half_form(f, f->M, rate) : 0;
        energy[2] = 0;
        for (int k = 0; k < 3 && f->M; k++) {
            energy[2] -= m->body->gravity[k] * cblas_ddot(f->n, f->rigid[k], 1, y, 1);
        }
    }
    free(y);
    return SPAR_OK;
}
