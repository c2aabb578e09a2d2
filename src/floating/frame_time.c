/* The motion of a frame: conversion from and to the motion of the nodes, stages, saved state, energy. */
#include "frame.h"

#include "../algebra/cblas.h"
#include "../algebra/dense.h"
#include "../base/poison.h"
#include "../base/session.h"
#include "../math/rotation.h"
#include "../member/applied_loads.h"
#include "../member/body.h"
#include "../member/pose.h"
#include "../solve/reaction.h"
#include "../time/driven_root.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- conversion between nodal motion and unknowns ---- */

static void matvec3(const double T[9], const double x[3], double y[3]) {
    for (int k = 0; k < 3; k++) {
        y[k] = T[3 * k] * x[0] + T[3 * k + 1] * x[1] + T[3 * k + 2] * x[2];
    }
}

/* Deformation and rates of the nodal motion relative to the frame, as unknowns. */
static void from_nodes(spari_frame *f, const spar_member *m, const spari_motion *nodes, double *y, double *rate) {
    double *x = f->nodal, *xd = x + 6 * (int64_t)f->nodes;
    const spari_pose pose = spari_member_pose(m, nodes);
    for (int64_t i = 0; i < m->nodes; i++) {
        int64_t u = m->mesh.elements == 1 ? i : i - i / m->mesh.per_element;
        spari_member_deformation(m, &pose, nodes, i, x + 6 * u, xd + 6 * u);
    }
    if (!f->basis) {
        memcpy(y, x, (size_t)f->n * sizeof *y);
        memcpy(rate, xd, (size_t)f->n * sizeof *y);
        return;
    }
    /* modal: the projection in the norm of the mass, Phi^T M x. The mass matrix of the nodes no longer exists; the
     * body gives its products as the forces of accelerations at the reference */
    double *in[2] = {x, xd};
    double *out[2] = {y, rate}, *still = f->global, *zero = still + 7 * (int64_t)f->nodes,
           *force = zero + 6 * (int64_t)f->nodes;
    spari_body loose = *m->body;
    loose.pre = NULL;
    memset(still, 0, (size_t)(13 * f->nodes) * sizeof *still);
    for (int i = 0; i < f->nodes; i++) {
        still[7 * i + 3] = 1;
    }
    for (int k = 0; k < 2; k++) {
        spari_body_residual(&loose, still, zero, in[k], 0, force, NULL);
        SPARI_BLAS(cblas_dgemv(CblasRowMajor, CblasTrans, 6 * f->nodes, f->n - f->constrained, 1,
                               f->basis + f->constrained, f->n, force, 1, 0, out[k] + f->constrained, 1));
        memset(out[k], 0, (size_t)f->constrained * sizeof *y);
    }
}

/* Rotations of the nodes follow their rotation vectors exactly, second derivatives to first order. */
static void to_node(const spar_member *m, const spari_pose *root, int node, const double x[6], const double xd[6],
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

void spari_frame_to_nodes(spari_frame *f, const spar_member *m, const spari_frame_state *s, double *q, double *v,
                          double *a) {
    int64_t n6 = 6 * (int64_t)f->nodes;
    const double *x = spari_frame_nodal(f, s->y, f->nodal), *xd = spari_frame_nodal(f, s->v, f->nodal + n6),
                 *xdd = spari_frame_nodal(f, s->a, f->nodal + 2 * n6);
    for (int i = 0; i < f->nodes; i++) {
        to_node(m, &s->root, i, x + 6 * i, xd + 6 * i, xdd + 6 * i, q + 7 * i, v + 6 * i, a + 6 * i);
    }
}

void spari_frame_publish(spar_member *m) {
    spari_frame *f = m->solution;
    const spari_frame_state *s = &f->to;
    int64_t n = f->nodes;
    double *q = f->global, *v = q + 7 * n, *a = v + 6 * n;
    spari_frame_to_nodes(f, m, s, q, v, a);
    const double *x = f->basis ? f->nodal : s->y;
    m->state.overturned = 0;
    for (int i = 0; i < f->nodes; i++) {
        m->state.overturned |= spari_norm(x + 6 * i + 3) > M_PI;
    }
    spari_member_publish(m, q, v, a, &m->after);
}

/* ---- time ---- */

void spari_frame_gather(const spari_frame *f, const double *x, double *out) {
    if (f->basis) {
        SPARI_BLAS(cblas_dgemv(CblasRowMajor, CblasTrans, 6 * f->nodes, f->n, 1, f->basis, f->n, x, 1, 0, out, 1));
    } else {
        memcpy(out, x, (size_t)f->n * sizeof *out);
    }
}

/* If the root jumps (hosts that give no accelerations, an impulsive start), the nodes keep position and velocity.
   Relative to the root the jump is subtracted; modal unknowns take its projection in the norm of the mass. */
static void subtract_jump(const spari_frame *f, const spar_member *m, double h, spari_frame_state *from,
                          const spari_frame_state *to) {
    double jump[2][6], *rows[2] = {from->v, from->y};
    spari_drive_jump(&from->root, &to->root, h, jump[0], jump[1]);
    for (int s = 0; s < 2; s++) {
        const double *J = jump[s];
        double *x = rows[s];
        for (int k = 6; k < f->n && f->basis; k++) {
            x[k] -= cblas_ddot(6, f->M + (int64_t)f->n * k, 1, J, 1);
        }
        for (int i = 1; i < f->nodes && !f->basis; i++) {
            double arm[3], rotation[3];
            spari_member_arm(m, i, arm);
            spari_cross(J + 3, arm, rotation);
            for (int k = 0; k < 3; k++) {
                x[6 * i + k] -= J[k] + rotation[k];
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
    if (c->rule != SPARI_BACKWARD && m->root == SPAR_ROOT_DRIVEN && !c->still) { /* once in a substep */
        subtract_jump(f, m, c->span, &f->from, &f->to);
    }
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

void spari_frame_poison(spari_frame *f) {
    double *const work[] = {f->r, f->dx, f->increment, f->steps.load, f->nodal, f->elastic};
    for (size_t k = 0; k < sizeof work / sizeof *work; k++) {
        spari_poison(work[k], f->n);
    }
    spari_poison(f->stage_v, f->n);
    spari_poison(f->loads, 6 * (int64_t)f->nodes);
    spari_poison(f->nodal, 18 * (int64_t)f->nodes);
    spari_poison(f->global, 19 * (int64_t)f->nodes);
    spari_poison(f->element, (int64_t)f->block * f->block);
    spari_poison(f->to.y, 4 * (int64_t)f->n);
}

/* x [6 f->nodes][n]: the rows of rotations, times `by` */
static void scale_rotations(const spari_frame *f, int n, double by, double *x) {
    for (int i = 0; i < f->nodes; i++) {
        cblas_dscal(3 * n, by, x + (int64_t)n * (6 * i + 3), 1);
    }
}

/* The factored products of the free columns, which are linearly independent. Rotations count at the member's length. */
static int factor_gram(spari_frame *f, double length) {
    const int n = f->n;
    const int64_t size = 6 * (int64_t)f->nodes * n;
    if (f->gram) {
        return SPAR_OK;
    }
    double *scaled = spari_zalloc(size, sizeof *scaled);
    f->gram = spari_zalloc((int64_t)n * n, sizeof *f->gram);
    if (!f->gram || !scaled) {
        SPARI_FREE(f->gram, scaled);
        f->gram = NULL;
        return SPAR_ERR_MEMORY;
    }
    memcpy(scaled, f->basis, (size_t)size * sizeof *scaled);
    scale_rotations(f, n, length, scaled);
    SPARI_BLAS(cblas_dgemm(CblasRowMajor, CblasTrans, CblasNoTrans, n, n, 6 * f->nodes, 1, scaled, n, scaled, n, 0,
                           f->gram, n));
    free(scaled);
    for (int k = 0; k < f->constrained * n; k++) {
        int i = k / n, j = k % n;
        f->gram[i * n + j] = f->gram[j * n + i] = i == j;
    }
    if (spari_cholesky(n, f->gram)) {
        free(f->gram);
        f->gram = NULL;
    }
    return SPAR_OK;
}

/* S phi (phi^T S phi)^-1 phi^T load, with phi the basis, and S 1 for forces and the member's length squared for
   moments: the smallest load with the same modal loads, moments divided by the length. */
int spari_frame_effective_load(spar_member *m, double *load) {
    spari_frame *f = m->solution;
    const double *root = f->to.root.q;
    int n = f->n;
    if (!f->basis) {
        spari_member_even_loads(m, load);
        return SPAR_OK;
    }
    const double length = spari_member_length(m);
    SPARI_TRY(factor_gram(f, length));
    if (!f->gram) {
        return SPAR_OK;
    }
    spari_member_gather(m, load, f->nodal);
    for (int i = 0; i < 6 * f->nodes; i += 3) {
        spari_rotate_back(root + 3, f->nodal + i, f->nodal + i);
    }
    spari_frame_gather(f, f->nodal, f->dx);
    memset(f->dx, 0, (size_t)f->constrained * sizeof *f->dx);
    spari_cholesky_solve(n, f->gram, f->dx);
    SPARI_BLAS(cblas_dgemv(CblasRowMajor, CblasNoTrans, 6 * f->nodes, n, 1, f->basis, n, f->dx, 1, 0, f->nodal, 1));
    scale_rotations(f, 1, length * length, f->nodal);
    for (int64_t i = 0; i < 6 * f->nodes; i += 3) {
        spari_rotate(root + 3, f->nodal + i, f->global + i);
    }
    spari_member_from_unique(m, 6, f->global, load);
    for (int64_t e = 1; e < m->mesh.elements; e++) { /* each of its two nodes takes half */
        double *left = load + 6 * (e * m->mesh.per_element - 1);
        for (int k = 0; k < 12; k++) {
            left[k] *= 0.5;
        }
    }
    return SPAR_OK;
}

/* Saves the factors before they are overwritten. */
void spari_frame_keep_factors(spari_frame *f) {
    double *to = f->begun.factored != 0 ? spari_snapshot_take(&f->before, spari_linear_state_size(f->linear)) : NULL;
    if (to) {
        spari_linear_save(f->linear, to);
    }
}

void spari_frame_begin(spar_member *m) {
    spari_frame *f = m->solution;
    f->begun = f->tangent;
    spari_snapshot_open(&f->before, 1);
}

void spari_frame_reject(spar_member *m) {
    spari_frame *f = m->solution;
    if (!f->before.open) {
        return;
    }
    f->tangent = f->begun;
    f->tangent.factored = f->begun.factored != 0 && f->before.saved >= 0;
    if (f->before.saved > 0) {
        spari_linear_load(f->linear, f->before.data);
    }
}

void spari_frame_accept(spar_member *m) {
    spari_frame *f = m->solution;
    spari_snapshot_close(&f->before);
    const spari_frame_state begin = f->to;
    f->to = f->begin, f->begin = begin;
    f->steps.begin = f->steps.solved;
}

void spari_frame_restart(spar_member *m) {
    spari_frame *f = m->solution;
    f->begin.root = spari_member_pose(m, &m->now);
    if (m->root == SPAR_ROOT_DRIVEN) {
        memcpy(f->begin.root.a, m->now.a, sizeof f->begin.root.a);
    }
    memset(f->begin.y, 0, (size_t)(4 * f->n) * sizeof(double));
    from_nodes(f, m, &m->now, f->begin.y, f->begin.v);
    memcpy(f->to.y, f->begin.y, (size_t)(4 * f->n) * sizeof(double));
    f->to.root = f->begin.root;
    f->steps.started = 0;
    f->steps.begin = (spari_pattern){0, SPARI_EVEN};
}

enum {
    STATE_HEAD = 13,
    STATE_RATES = STATE_HEAD,
    STATE_BEGUN = STATE_RATES + 2 * SPARI_FRAME_RATES,
    STATE_ENDS = STATE_BEGUN + sizeof(spari_frame_tangent_state) / sizeof(double),
    STATE_ROOT = sizeof(spari_pose) / sizeof(double)
};

/* Size of the head and of the states at both ends of the step. */
static int64_t ends_size(const spari_frame *f) {
    return STATE_ENDS + 2 * (STATE_ROOT + 4 * (int64_t)f->n);
}

/* After these come the data of the beginning of the step, and the factors if there are any. */
int64_t spari_frame_state_size(const spar_member *m) {
    const spari_frame *f = m->solution;
    return ends_size(f) + spari_snapshot_size(&f->before) +
           (f->tangent.factored != 0 ? spari_linear_state_size(f->linear) : 0);
}

void spari_frame_save(const spar_member *m, double *state) {
    const spari_frame *f = m->solution;
    const double head[STATE_HEAD] = {f->n,
                                     f->tangent.factored,
                                     f->tangent.cm,
                                     f->tangent.cv,
                                     f->steps.started,
                                     f->combined,
                                     f->tangent.left,
                                     f->steps.begin.h,
                                     f->steps.begin.even,
                                     f->steps.solved.h,
                                     f->steps.solved.even,
                                     (double)f->solves,
                                     (double)f->factors};
    const spari_frame_state *const ends[2] = {&f->begin, &f->to};
    memcpy(state, head, sizeof head);
    memcpy(state + STATE_RATES, f->rates, sizeof f->rates);
    memcpy(state + STATE_RATES + SPARI_FRAME_RATES, f->tangent.rates, sizeof f->tangent.rates);
    memcpy(state + STATE_BEGUN, &f->begun, sizeof f->begun);
    double *at = state + STATE_ENDS;
    for (int k = 0; k < 2; k++, at += STATE_ROOT + 4 * (int64_t)f->n) {
        memcpy(at, &ends[k]->root, sizeof ends[k]->root);
        memcpy(at + STATE_ROOT, ends[k]->y, (size_t)(4 * f->n) * sizeof *state);
    }
    spari_snapshot_save(&f->before, at);
    if (f->tangent.factored != 0) {
        spari_linear_save(f->linear, at + spari_snapshot_size(&f->before));
    }
}

int spari_frame_is_state(const spar_member *m, const double *state, int64_t count) {
    const spari_frame *f = m->solution;
    const int64_t at = ends_size(f), expected = spari_linear_state_size(f->linear);
    if (count < at + SPARI_SNAPSHOT_HEAD || state[0] != f->n || !spari_is_remaining(state[6]) ||
        !spari_pattern_is(state[7], state[8]) || !spari_pattern_is(state[9], state[10]) || !spari_is_count(state[11]) ||
        !spari_is_count(state[12]) || !spari_is_remaining(state[STATE_BEGUN + 3])) {
        return 0;
    }
    int64_t factors = state[1] != 0 ? expected : 0, before = SPARI_SNAPSHOT_HEAD + (state[at + 1] > 0 ? expected : 0);
    return spari_snapshot_is(state + at, before, expected) && count == at + before + factors &&
           (before == SPARI_SNAPSHOT_HEAD || spari_linear_is_state(f->linear, state + at + SPARI_SNAPSHOT_HEAD)) &&
           (factors == 0 || spari_linear_is_state(f->linear, state + at + before));
}

/* Forms the sums for the saved rates again, with the same bits. */
void spari_frame_load(spar_member *m, const double *state) {
    spari_frame *f = m->solution;
    spari_frame_state *const ends[2] = {&f->begin, &f->to};
    f->tangent.factored = state[1] != 0;
    f->tangent.cm = state[2], f->tangent.cv = state[3];
    f->steps.started = state[4] != 0;
    f->combined = 0;
    if (state[5] != 0) {
        (void)spari_frame_combine(f, m, state + STATE_RATES);
    }
    f->tangent.left = state[6];
    f->steps.begin = (spari_pattern){state[7], (int)state[8]};
    f->steps.solved = (spari_pattern){state[9], (int)state[10]};
    f->solves = (int64_t)state[11], f->factors = (int64_t)state[12];
    memcpy(f->tangent.rates, state + STATE_RATES + SPARI_FRAME_RATES, sizeof f->tangent.rates);
    memcpy(&f->begun, state + STATE_BEGUN, sizeof f->begun);
    const double *at = state + STATE_ENDS;
    for (int k = 0; k < 2; k++, at += STATE_ROOT + 4 * (int64_t)f->n) {
        memcpy(&ends[k]->root, at, sizeof ends[k]->root);
        memcpy(ends[k]->y, at + STATE_ROOT, (size_t)(4 * f->n) * sizeof *state);
    }
    /* a step writes the free unknowns alone */
    memcpy(f->from.y, f->to.y, (size_t)(4 * f->n) * sizeof *f->to.y);
    spari_snapshot_load(&f->before, at, f->tangent.factored != 0);
    if (f->tangent.factored != 0) {
        spari_linear_load(f->linear, at + SPARI_SNAPSHOT_HEAD + (int64_t)at[2]);
    }
}

/* x^T X x / 2 */
static double half_form(spari_frame *f, const double *X, const double *x) {
    memset(f->r, 0, (size_t)f->n * sizeof *f->r);
    spari_frame_add_times(f, X, x, 0.5, f->r);
    return cblas_ddot(f->n, x, 1, f->r, 1);
}

int spari_frame_energy(const spar_member *m, double energy[4]) {
    spari_frame *f = m->solution;
    SPARI_TRY(spari_energy_of_body(m, energy));
    const spari_pose pose = spari_member_pose(m, &m->after);
    double rates[SPARI_FRAME_RATES];
    spari_frame_rates(m, &pose, 1, 1, rates);
    SPARI_TRY(spari_frame_weigh(f, m, rates + 6));
    double *y = spari_zalloc(2 * (int64_t)f->n, sizeof *y), *rate = y + f->n;
    if (!y) {
        return SPAR_ERR_MEMORY;
    }
    from_nodes(f, m, &m->after, y, rate);
    energy[1] = half_form(f, f->K, y) + (f->pull ? cblas_ddot(f->n, f->pull, 1, y, 1) : 0);
    energy[1] -= m->load.foundation ? spari_foundation_energy(m, m->after.q) : 0;
    if (m->root != SPAR_ROOT_DRIVEN) { /* the frame is fixed: the equations conserve these */
        energy[0] = f->M && (m->effects & SPAR_EFFECT_INERTIA) ? half_form(f, f->M, rate) : 0;
        energy[2] = 0;
        for (int k = 0; k < 3 && f->M; k++) {
            energy[2] -= m->body->gravity[k] * cblas_ddot(f->n, f->rigid[k], 1, y, 1);
        }
    }
    for (int k = 0; k < 3 && f->P[k]; k++) { /* weight and the shortening of a bent line */
        energy[2] += rates[6 + k] != 0 ? rates[6 + k] * half_form(f, f->P[k], y) : 0;
    }
    free(y);
    return SPAR_OK;
}
