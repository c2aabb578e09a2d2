/* The call for modes, and the modes of an assembly. Stiffness and mass of the members stand side by side; springs and
   the rotation of the joints' loads couple them. Constraints G x = 0 are eliminated: of orthonormal rows Q the first
   span the rows of G, and the others are a basis of the motions that the constraints allow. Stiffness and mass are
   projected on this basis, so the eigenproblem has no multiplier and no penalty, and redundant constraints do no
   harm. */
#include "../algebra/cblas.h"
#include "../algebra/dense.h"
#include "../assembly/assembly.h"
#include "../base/environment.h"
#include "../base/session.h"
#include "../member/body.h"
#include "../member/check_arguments.h"
#include "../member/joint.h"
#include "../time/fidelity.h"
#include "modes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A row of G is dependent if its remainder is smaller than this, as in redundant.c. */
static const double dependent_row = 1e-9;

typedef struct modal_part {
    const spar_member *member;
    int64_t at, size; /* position and number of its unknowns */
} modal_part;

typedef struct joined_modes {
    modal_part *part;
    int parts;
    int64_t size, constraints; /* unknowns; rows of G */
    double *K, *M;             /* [size][size] of all unknowns */
    double *G;                 /* [constraints][size] */
    double *Q; /* [size][size] orthonormal rows; the first `rank` are the motions that the constraints remove */
    int64_t rank;
    double *workspace; /* of a shape, twice */
} joined_modes;

static void joined_modes_free(joined_modes *t) {
    free(t->part);
    free(t->workspace);
    free(t->K);
}

/* ---- members of the assembly ---- */

static const modal_part *modal_part_of(const joined_modes *t, const spar_member *m) {
    for (int i = 0; i < t->parts; i++) {
        if (t->part[i].member == m) {
            return t->part + i;
        }
    }
    return NULL;
}

static int add_modal_part(joined_modes *t, const spar_member *m) {
    SPARI_TRY(spari_modes_need_mass(m));
    t->part[t->parts++] = (modal_part){m, 0, m->row->unknowns(m)};
    return SPAR_OK;
}

/* The unknowns are in the order of creation, so that the modes have the same bits for whichever member they are
   requested. */
static void order_parts(joined_modes *t, const spar_session *s) {
    int placed = 0;
    for (const spar_member *m = s->members; m; m = m->next) {
        for (int i = placed; i < t->parts; i++) {
            if (t->part[i].member == m) {
                modal_part found = t->part[i];
                t->part[i] = t->part[placed];
                found.at = t->size;
                t->size += found.size;
                t->part[placed++] = found;
            }
        }
    }
}

/* Members connected by joints that spar solves, and the number of constraints. */
static int gather_parts(joined_modes *t, const spar_member *first) {
    spar_session *s = first->session;
    t->part = spari_zalloc(s->member_count, sizeof *t->part);
    SPARI_REQUIRE(s, t->part, SPAR_ERR_MEMORY, "no memory for the modes of '%s'", first->name);
    SPARI_TRY(add_modal_part(t, first));
    for (int i = 0; i < t->parts; i++) {
        for (const spar_joint *j = s->joints; j; j = j->next) {
            for (int side = 0; side < 2; side++) {
                const spar_member *other = j->member[1 - side];
                if (j->member[side] == t->part[i].member && other && other->row->component &&
                    !modal_part_of(t, other)) {
                    SPARI_TRY(add_modal_part(t, other));
                }
            }
        }
    }
    order_parts(t, s);
    for (const spar_joint *j = s->joints; j; j = j->next) {
        int here = modal_part_of(t, j->member[0]) || modal_part_of(t, j->member[1]);
        for (int k = 0; k < 6 && here; k++) {
            t->constraints += spari_joint_constrained(j) >> k & 1;
        }
    }
    return SPAR_OK;
}

/* ---- joints ---- */

/* Motion of a node by the unknowns of its part: S [6][size], column by column from shapes of unit unknowns. */
static void motion_of_node(const modal_part *p, int64_t node, double *workspace, double *S) {
    const spar_member *m = p->member;
    double *unit = workspace, *work = unit + p->size, *nodes = work + 6 * (int64_t)m->body->unique;
    memset(unit, 0, (size_t)p->size * sizeof *unit);
    for (int64_t c = 0; c < p->size; c++) {
        unit[c] = 1;
        m->row->shape(m, unit, work, nodes);
        unit[c] = 0;
        for (int k = 0; k < 6; k++) {
            S[p->size * k + c] = nodes[6 * node + k];
        }
    }
}

/* Stiffness of a joint's springs and geometric stiffness of its load, for its two nodes. */
static void stiffness_of_joint(const spar_joint *j, double K[12][12], double B[6][12]) {
    spari_node_pose pose[2];
    spari_relative at = j->after;
    int given = spari_joint_constrained(j);
    double joint_tangent[12][12] = {{0}};
    spari_joint_poses(j, pose);
    spari_kinematics_motion(&j->kinematics, &pose[0], &pose[1], at.z, B);
    spari_joint_count_turns(j, j->after.z, at.z);
    int springs = spari_joint_spring(j, at.z, at.rate, INFINITY, 1, at.load);
    spari_kinematics_tangent(&j->kinematics, &pose[0], &pose[1], at.load, joint_tangent);
    for (int i = 0; i < 144; i++) {
        double sum = -0.5 * (joint_tangent[i / 12][i % 12] + joint_tangent[i % 12][i / 12]);
        for (int pq = 0; pq < 36 && springs; pq++) {
            int p = pq / 6, q = pq % 6, off = (given >> p & 1) || (given >> q & 1);
            sum += off ? 0 : j->stiffness[pq] * B[p][i / 12] * B[q][i % 12];
        }
        K[i / 12][i % 12] = sum;
    }
}

/* K += S_a^T X S_b over the unknowns of two sides; X a block of stride 12. */
static void add_block(int64_t size, double *K, const modal_part *a, const double *S_a, const modal_part *b,
                      const double *S_b, const double *X) {
    for (int64_t c = 0; c < b->size; c++) {
        double y[6] = {0};
        for (int i = 0; i < 36; i++) {
            y[i / 6] += X[12 * (i / 6) + i % 6] * S_b[b->size * (i % 6) + c];
        }
        for (int64_t r = 0; r < a->size; r++) {
            double sum = 0;
            for (int i = 0; i < 6; i++) {
                sum += S_a[a->size * i + r] * y[i];
            }
            K[size * (a->at + r) + b->at + c] += sum;
        }
    }
}

/* A row of G += B_k S, over one side's unknowns. */
static void add_constraint_row(double *G, const modal_part *p, const double *S, const double *row) {
    for (int64_t c = 0; c < p->size; c++) {
        double sum = 0;
        for (int i = 0; i < 6; i++) {
            sum += row[i] * S[p->size * i + c];
        }
        G[p->at + c] += sum;
    }
}

static int add_joint_to_modes(joined_modes *t, const spar_joint *j, int64_t *constraints) {
    const modal_part *of[2] = {modal_part_of(t, j->member[0]), modal_part_of(t, j->member[1])};
    double K[12][12], B[6][12], *S[2] = {NULL, NULL};
    if (!of[0] && !of[1]) {
        return SPAR_OK;
    }
    int64_t size[2] = {of[0] ? of[0]->size : 0, of[1] ? of[1]->size : 0};
    double *block = spari_zalloc(6 * (size[0] + size[1]), sizeof *block);
    SPARI_REQUIRE(j->session, block, SPAR_ERR_MEMORY, "joint '%s': no memory for modes", j->name);
    S[0] = block, S[1] = block + 6 * size[0];
    for (int side = 0; side < 2; side++) {
        if (of[side]) {
            motion_of_node(of[side], j->seat[side], t->workspace, S[side]);
        }
    }
    stiffness_of_joint(j, K, B);
    for (int i = 0; i < 4; i++) {
        int a = i / 2, b = i % 2;
        if (of[a] && of[b]) {
            add_block(t->size, t->K, of[a], S[a], of[b], S[b], &K[6 * a][6 * b]);
        }
    }
    for (int k = 0; k < 6; k++) {
        for (int side = 0; side < 2 && (spari_joint_constrained(j) >> k & 1); side++) {
            if (of[side]) {
                add_constraint_row(t->G + t->size * *constraints, of[side], S[side], B[k] + 6 * side);
            }
        }
        *constraints += spari_joint_constrained(j) >> k & 1;
    }
    free(block);
    return SPAR_OK;
}

/* ---- assembly of the matrices ---- */

static int alloc_joined_modes(joined_modes *t) {
    int64_t most = 0, square = t->size * t->size;
    for (int i = 0; i < t->parts; i++) {
        const spar_member *m = t->part[i].member;
        int64_t workspace = 2 * t->part[i].size * t->part[i].size, shape = t->part[i].size + 6 * m->body->unique;
        shape += 6 * m->nodes;
        most = workspace > most ? workspace : most;
        most = shape > most ? shape : most;
    }
    t->workspace = spari_zalloc(most, sizeof *t->workspace);
    t->K = spari_zalloc(3 * square + t->constraints * t->size, sizeof *t->K);
    t->M = t->K + square, t->Q = t->M + square, t->G = t->Q + square;
    return t->workspace && t->K;
}

static int fill_joined_modes(joined_modes *t, const spar_session *s) {
    int64_t constraints = 0;
    for (int i = 0; i < t->parts; i++) {
        const modal_part *p = t->part + i;
        double *K = t->workspace, *M = K + p->size * p->size;
        memset(K, 0, (size_t)(2 * p->size * p->size) * sizeof *K);
        SPARI_TRY(p->member->row->problem(p->member, K, M));
        for (int64_t k = 0; k < p->size * p->size; k++) {
            int64_t at = t->size * (p->at + k / p->size) + p->at + k % p->size;
            t->K[at] = K[k];
            t->M[at] = M[k];
        }
    }
    for (const spar_joint *j = s->joints; j; j = j->next) {
        SPARI_TRY(add_joint_to_modes(t, j, &constraints));
    }
    return SPAR_OK;
}

/* ---- constraints ---- */

/* Scales rows of G to 1, then replaces G^T by Q and R. */
static int factor_constraints(joined_modes *t) {
    int *order = spari_zalloc(t->constraints + 1, sizeof *order), n = (int)t->size;
    if (order && t->constraints > 0) {
        t->rank = spari_independent_rows((int)t->constraints, n, t->G, dependent_row, order, n, t->Q);
    }
    for (int64_t i = 0; i < n && t->constraints == 0; i++) {
        t->Q[(t->size + 1) * i] = 1;
    }
    int status = order && t->rank >= 0 ? SPAR_OK : SPAR_ERR_MEMORY;
    free(order);
    return status;
}

/* B := the part of a symmetric A that the constraints allow, Q A Q^T by the last rows of Q. half [size][size]:
   workspace. */
static void onto_allowed(const joined_modes *t, const double *A, double *half, double *B) {
    int n = (int)t->size, left = n - (int)t->rank;
    const double *Q = t->Q + t->size * t->rank;
    SPARI_BLAS(cblas_dgemm(CblasRowMajor, CblasNoTrans, CblasNoTrans, left, n, n, 1, Q, n, A, n, 0, half, n));
    SPARI_BLAS(cblas_dgemm(CblasRowMajor, CblasNoTrans, CblasTrans, left, left, n, 1, half, n, Q, n, 0, B, left));
    for (int i = 0; i < left; i++) {
        for (int k = 0; k < i; k++) {
            double mean = 0.5 * (B[(int64_t)left * i + k] + B[(int64_t)left * k + i]);
            B[(int64_t)left * i + k] = B[(int64_t)left * k + i] = mean;
        }
    }
}

/* x [size]: workspace */
static void give_shapes(const joined_modes *t, spari_modal *p, const spar_member *m, int64_t n, double *x,
                        double *shapes) {
    const modal_part *own = modal_part_of(t, m);
    int size = (int)t->size;
    for (int64_t k = 0; k < n; k++) {
        const double *mode = spari_modal_mode(p, k);
        SPARI_BLAS(
            cblas_dgemv(CblasRowMajor, CblasTrans, p->size, size, 1, t->Q + t->size * t->rank, size, mode, 1, 0, x, 1));
        m->row->shape(m, x + own->at, t->workspace, shapes + 6 * m->nodes * k);
    }
}

static int solve_joined_modes(joined_modes *t, spar_member *m, int64_t n, double *frequency, double *shapes) {
    spar_session *s = m->session;
    int status = alloc_joined_modes(t) ? fill_joined_modes(t, s) : SPAR_ERR_MEMORY;
    status = status == SPAR_OK ? factor_constraints(t) : status;
    SPARI_REQUIRE(s, status == SPAR_OK, status, "no memory for the modes of the assembly of '%s'", m->name);
    int64_t left = t->size - t->rank;
    SPARI_REQUIRE(s, n <= left, SPAR_ERR_ARGUMENT, "the assembly of '%s': %lld modes; the assembly has %lld", m->name,
                  (long long)n, (long long)left);
    if (n == 0) {
        return SPAR_OK;
    }
    spari_modal p = {0};
    double *workspace = spari_zalloc(t->size * t->size, sizeof *workspace);
    status = spari_modal_alloc(&p, (int)left) && workspace ? SPAR_OK : SPAR_ERR_MEMORY;
    if (status == SPAR_OK) {
        onto_allowed(t, t->K, workspace, p.K);
        onto_allowed(t, t->M, workspace, p.M);
        status = spari_modal_solve(&p, m, "the assembly of", n, frequency);
        if (status == SPAR_OK && shapes) {
            give_shapes(t, &p, m, n, workspace, shapes);
        }
    } else {
        status = spari_fail(s, status, "no memory for the modes of the assembly of '%s'", m->name);
    }
    free(workspace);
    spari_modal_free(&p);
    return status;
}

static int modes_of_assembly(spar_member *m, int64_t n, double *frequency, double *shapes) {
    joined_modes t = {0};
    SPARI_TRY(spari_joints_place(m->session));
    int status = gather_parts(&t, m);
    status = status == SPAR_OK ? solve_joined_modes(&t, m, n, frequency, shapes) : status;
    joined_modes_free(&t);
    return status;
}

int spar_member_solve_modes(spar_member *member, int64_t n, double *frequency_hz, double *shapes) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_TRY(spari_need_committed(member, __func__));
    spar_session *s = member->session;
    SPARI_TRY(spari_named(s, __func__, spari_modes_need_mass(member)));
    SPARI_REQUIRE(s, n >= 0, SPAR_ERR_ARGUMENT, "%s: '%s': %lld modes", __func__, member->name, (long long)n);
    SPARI_REQUIRE(s, frequency_hz || n == 0, SPAR_ERR_ARGUMENT, "%s: '%s': frequency_hz is NULL", __func__,
                  member->name);
    int status = spari_joint_of(member) ? modes_of_assembly(member, n, frequency_hz, shapes)
                 : n == 0               ? SPAR_OK
                                        : spari_modes_of_member(member, n, frequency_hz, shapes);
    return spari_named(s, __func__, status);
}
