/* Public call for modes, and modes of an assembly: the members' problems side by side, springs and geometric
   stiffness of the joints, and constraints eliminated. Of the constraints G x = 0, G^T = Q R with column pivoting,
   the last columns of Q are an orthonormal basis of the admissible motions. Stiffness and mass are projected onto
   it. So the eigenproblem has no multipliers or penalties, and redundant constraints do no harm. */
#include "../assembly/assembly.h"
#include "../base/blas.h"
#include "../base/environment.h"
#include "../base/session.h"
#include "../member/body.h"
#include "../member/checks.h"
#include "../member/joint.h"
#include "../time/fidelity.h"
#include "modes.h"

#include <gsl/gsl_blas.h>
#include <gsl/gsl_linalg.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A row of G is dependent if its remainder is smaller than this, as in redundant.c. */
static const double dependent_row = 1e-9;

typedef struct modal_part {
    const spar_member *member;
    int64_t at, size; /* position and number of its unknowns */
} modal_part;

typedef struct tied_modes {
    modal_part *part;
    int parts;
    int64_t size, holds; /* unknowns; rows of G */
    gsl_matrix *K, *M;   /* of all unknowns */
    gsl_matrix *G;       /* G^T, then its factors */
    gsl_vector *tau;
    size_t rank;
    double *room; /* two vectors of a shape */
} tied_modes;

static void tied_modes_free(tied_modes *t) {
    free(t->part);
    free(t->room);
    gsl_matrix_free(t->K);
    gsl_matrix_free(t->M);
    gsl_matrix_free(t->G);
    gsl_vector_free(t->tau);
}

/* ---- members of the assembly ---- */

static const modal_part *modal_part_of(const tied_modes *t, const spar_member *m) {
    for (int i = 0; i < t->parts; i++) {
        if (t->part[i].member == m) {
            return t->part + i;
        }
    }
    return NULL;
}

static int add_modal_part(tied_modes *t, const spar_member *m) {
    SPARI_TRY(spari_modes_need_mass(m));
    t->part[t->parts++] = (modal_part){m, 0, m->row->unknowns(m)};
    return SPAR_OK;
}

/* The unknowns are in the order of creation, so that the modes have the same bits for whichever member they are
   requested. */
static void order_parts(tied_modes *t, const spar_session *s) {
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
static int gather_parts(tied_modes *t, const spar_member *first) {
    spar_session *s = first->session;
    t->part = spari_zalloc(s->member_count, sizeof *t->part);
    SPARI_REQUIRE(s, t->part, SPAR_ERR_MEMORY, "no memory for the modes of '%s'", first->name);
    SPARI_TRY(add_modal_part(t, first));
    for (int i = 0; i < t->parts; i++) {
        for (const spar_joint *j = s->joints; j; j = j->next) {
            for (int side = 0; side < 2; side++) {
                const spar_member *other = j->member[1 - side];
                if (j->member[side] == t->part[i].member && other && other->row->limb && !modal_part_of(t, other)) {
                    SPARI_TRY(add_modal_part(t, other));
                }
            }
        }
    }
    order_parts(t, s);
    for (const spar_joint *j = s->joints; j; j = j->next) {
        int here = modal_part_of(t, j->member[0]) || modal_part_of(t, j->member[1]);
        for (int k = 0; k < 6 && here; k++) {
            t->holds += spari_joint_given(j) >> k & 1;
        }
    }
    return SPAR_OK;
}

/* ---- joints ---- */

/* Motion of a node by the unknowns of its part: S [6][size], column by column from shapes of unit unknowns. */
static void motion_of_node(const modal_part *p, int64_t node, double *room, double *S) {
    const spar_member *m = p->member;
    double *unit = room, *work = unit + p->size, *nodes = work + 6 * (int64_t)m->body->unique;
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
    spari_place place[2];
    spari_relative at = j->after;
    int given = spari_joint_given(j);
    double turning[12][12] = {{0}};
    spari_joint_places(j, place);
    spari_tie_motion(&j->tie, &place[0], &place[1], at.z, B);
    spari_joint_count_turns(j, j->after.z, at.z);
    int springs = spari_joint_spring(j, at.z, at.rate, INFINITY, 1, at.load);
    spari_tie_tangent(&j->tie, &place[0], &place[1], at.load, turning);
    for (int i = 0; i < 144; i++) {
        double sum = -0.5 * (turning[i / 12][i % 12] + turning[i % 12][i / 12]);
        for (int pq = 0; pq < 36 && springs; pq++) {
            int p = pq / 6, q = pq % 6, off = (given >> p & 1) || (given >> q & 1);
            sum += off ? 0 : j->stiffness[pq] * B[p][i / 12] * B[q][i % 12];
        }
        K[i / 12][i % 12] = sum;
    }
}

/* K += S_a^T X S_b over the unknowns of two sides; X a block of stride 12. */
static void add_block(gsl_matrix *K, const modal_part *a, const double *S_a, const modal_part *b, const double *S_b,
                      const double *X) {
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
            *gsl_matrix_ptr(K, (size_t)(a->at + r), (size_t)(b->at + c)) += sum;
        }
    }
}

/* Column `hold` of G^T += B_k S, over one side's unknowns. */
static void add_hold(gsl_matrix *G, int64_t hold, const modal_part *p, const double *S, const double *row) {
    for (int64_t c = 0; c < p->size; c++) {
        double sum = 0;
        for (int i = 0; i < 6; i++) {
            sum += row[i] * S[p->size * i + c];
        }
        *gsl_matrix_ptr(G, (size_t)(p->at + c), (size_t)hold) += sum;
    }
}

static int add_joint_to_modes(tied_modes *t, const spar_joint *j, int64_t *holds) {
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
            motion_of_node(of[side], j->seat[side], t->room, S[side]);
        }
    }
    stiffness_of_joint(j, K, B);
    for (int i = 0; i < 4; i++) {
        int a = i / 2, b = i % 2;
        if (of[a] && of[b]) {
            add_block(t->K, of[a], S[a], of[b], S[b], &K[6 * a][6 * b]);
        }
    }
    for (int k = 0; k < 6; k++) {
        for (int side = 0; side < 2 && (spari_joint_given(j) >> k & 1); side++) {
            if (of[side]) {
                add_hold(t->G, *holds, of[side], S[side], B[k] + 6 * side);
            }
        }
        *holds += spari_joint_given(j) >> k & 1;
    }
    free(block);
    return SPAR_OK;
}

/* ---- assembly of the matrices ---- */

static int alloc_tied_modes(tied_modes *t) {
    size_t n = (size_t)t->size, h = (size_t)t->holds;
    int64_t most = 0;
    for (int i = 0; i < t->parts; i++) {
        const spar_member *m = t->part[i].member;
        int64_t room = 2 * t->part[i].size * t->part[i].size, shape = t->part[i].size + 6 * m->body->unique;
        shape += 6 * m->nodes;
        most = room > most ? room : most;
        most = shape > most ? shape : most;
    }
    t->room = spari_zalloc(most, sizeof *t->room);
    t->K = gsl_matrix_calloc(n, n);
    t->M = gsl_matrix_calloc(n, n);
    t->G = h > 0 ? gsl_matrix_calloc(n, h) : NULL;
    t->tau = h > 0 ? gsl_vector_alloc(n < h ? n : h) : NULL;
    return t->room && t->K && t->M && (h == 0 || (t->G && t->tau));
}

static int fill_tied_modes(tied_modes *t, const spar_session *s) {
    int64_t holds = 0;
    for (int i = 0; i < t->parts; i++) {
        const modal_part *p = t->part + i;
        double *K = t->room, *M = K + p->size * p->size;
        memset(K, 0, (size_t)(2 * p->size * p->size) * sizeof *K);
        SPARI_TRY(p->member->row->problem(p->member, K, M));
        for (int64_t k = 0; k < p->size * p->size; k++) {
            size_t r = (size_t)(p->at + k / p->size), c = (size_t)(p->at + k % p->size);
            gsl_matrix_set(t->K, r, c, K[k]);
            gsl_matrix_set(t->M, r, c, M[k]);
        }
    }
    for (const spar_joint *j = s->joints; j; j = j->next) {
        SPARI_TRY(add_joint_to_modes(t, j, &holds));
    }
    return SPAR_OK;
}

/* ---- constraints ---- */

/* Scales rows of G to 1, then replaces G^T by Q and R. */
static int factor_holds(tied_modes *t) {
    if (!t->G) {
        return SPAR_OK;
    }
    int sign, status = SPAR_OK;
    gsl_permutation *order = gsl_permutation_alloc(t->G->size2);
    gsl_vector *norm = gsl_vector_alloc(t->G->size2);
    if (order && norm) {
        for (size_t c = 0; c < t->G->size2; c++) {
            gsl_vector_view column = gsl_matrix_column(t->G, c);
            double size = gsl_blas_dnrm2(&column.vector);
            gsl_vector_scale(&column.vector, size > 0 ? 1 / size : 0);
        }
        SPARI_BLAS(gsl_linalg_QRPT_decomp(t->G, t->tau, order, &sign, norm));
        while (t->rank < t->tau->size && fabs(gsl_matrix_get(t->G, t->rank, t->rank)) > dependent_row) {
            t->rank++;
        }
    } else {
        status = SPAR_ERR_MEMORY;
    }
    gsl_permutation_free(order);
    gsl_vector_free(norm);
    return status;
}

/* A := Q^T A Q, A symmetric */
static void onto_allowed(const tied_modes *t, gsl_matrix *A) {
    for (int side = 0; side < 2 && t->G; side++) {
        SPARI_BLAS(gsl_linalg_QR_QTmat(t->G, t->tau, A));
        gsl_matrix_transpose(A);
    }
}

/* The admissible part of A, into B. */
static void take_allowed(const tied_modes *t, const gsl_matrix *A, gsl_matrix *B) {
    for (size_t i = 0; i < B->size1; i++) {
        for (size_t k = 0; k < B->size2; k++) {
            double a = gsl_matrix_get(A, t->rank + i, t->rank + k), b = gsl_matrix_get(A, t->rank + k, t->rank + i);
            gsl_matrix_set(B, i, k, 0.5 * (a + b));
        }
    }
}

static void give_shapes(const tied_modes *t, spari_modal *p, const spar_member *m, int64_t n, gsl_vector *x,
                        double *shapes) {
    const modal_part *own = modal_part_of(t, m);
    for (int64_t k = 0; k < n; k++) {
        gsl_vector_set_zero(x);
        memcpy(x->data + t->rank, spari_modal_mode(p, (size_t)k), p->size * sizeof *x->data);
        if (t->G) {
            SPARI_BLAS(gsl_linalg_QR_Qvec(t->G, t->tau, x));
        }
        m->row->shape(m, x->data + own->at, t->room, shapes + 6 * m->nodes * k);
    }
}

static int solve_tied_modes(tied_modes *t, spar_member *m, int64_t n, double *frequency, double *shapes) {
    spar_session *s = m->session;
    int status = alloc_tied_modes(t) ? fill_tied_modes(t, s) : SPAR_ERR_MEMORY;
    status = status == SPAR_OK ? factor_holds(t) : status;
    SPARI_REQUIRE(s, status == SPAR_OK, status, "no memory for the modes of what joints tie to '%s'", m->name);
    int64_t left = t->size - (int64_t)t->rank;
    SPARI_REQUIRE(s, n <= left, SPAR_ERR_ARGUMENT, "'%s' and what joints tie to it: %lld modes; they have %lld",
                  m->name, (long long)n, (long long)left);
    if (n == 0) {
        return SPAR_OK;
    }
    spari_modal p = {0};
    gsl_vector *x = gsl_vector_calloc((size_t)t->size);
    status = spari_modal_alloc(&p, (size_t)left) && x ? SPAR_OK : SPAR_ERR_MEMORY;
    if (status == SPAR_OK) {
        onto_allowed(t, t->K);
        onto_allowed(t, t->M);
        take_allowed(t, t->K, p.K);
        take_allowed(t, t->M, p.M);
        status = spari_modal_solve(&p, m, "what joints tie to", n, frequency);
        if (status == SPAR_OK && shapes) {
            give_shapes(t, &p, m, n, x, shapes);
        }
    } else {
        status = spari_fail(s, status, "no memory for the modes of what joints tie to '%s'", m->name);
    }
    gsl_vector_free(x);
    spari_modal_free(&p);
    return status;
}

static int modes_of_assembly(spar_member *m, int64_t n, double *frequency, double *shapes) {
    tied_modes t = {0};
    SPARI_TRY(spari_joints_place(m->session));
    int status = gather_parts(&t, m);
    status = status == SPAR_OK ? solve_tied_modes(&t, m, n, frequency, shapes) : status;
    tied_modes_free(&t);
    return status;
}

int spar_member_solve_modes(spar_member *member, int64_t n, double *frequency_hz, double *shapes) {
    SPARI_QUIET;
    SPARI_TRY(spari_need_committed(member, __func__));
    spar_session *s = member->session;
    SPARI_TRY(spari_named(s, __func__, spari_modes_need_mass(member)));
    SPARI_REQUIRE(s, n >= 0, SPAR_ERR_ARGUMENT, "%s: '%s': %lld modes", __func__, member->name, (long long)n);
    SPARI_REQUIRE(s, frequency_hz || n == 0, SPAR_ERR_ARGUMENT, "%s: '%s': frequency_hz is NULL", __func__,
                  member->name);
    int status = spari_member_is_tied(member) ? modes_of_assembly(member, n, frequency_hz, shapes)
                 : n == 0                     ? SPAR_OK
                                              : spari_modes_of_member(member, n, frequency_hz, shapes);
    return spari_named(s, __func__, status);
}
