/* The root of a floating frame: creation, memory, saved state. See floating_root.h. */
#include "floating_root.h"

#include "../algebra/cblas.h"
#include "../math/rotation.h"
#include "../member/joint.h"
#include "../time/component.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static int find_joint_nodes(spari_floating_root *c, const spar_member *m) {
    c->node = spari_zalloc(spari_component_joint_count(m) + 1, sizeof *c->node);
    if (!c->node) {
        return SPAR_ERR_MEMORY;
    }
    c->ends = spari_component_joint_nodes(m, c->node);
    if (c->ends > 0 && c->node[0] == 0) {
        c->ends--;
        memmove(c->node, c->node + 1, (size_t)c->ends * sizeof *c->node);
    }
    return SPAR_OK;
}

int spari_floating_root_create(spari_frame *f, spar_member *m) {
    spari_floating_root *c = f->floating_root = spari_zalloc(1, sizeof *c);
    if (!c || find_joint_nodes(c, m) != SPAR_OK) {
        return SPAR_ERR_MEMORY;
    }
    spari_body *body = c->body = spari_body_create(1, 1, (const int[]){1}, 0, 0, 0);
    if (!body) {
        return SPAR_ERR_MEMORY;
    }
    body->length = m->body->length;
    body->phi[0] = body->weight[0] = 1;
    spari_body_complete(body);
    c->root = spari_solver_create(m, body, NULL);
    return c->root ? SPAR_OK : SPAR_ERR_MEMORY;
}

/* (R^T M R)^-1 X for six right-hand sides in rows, X [6][n], by elimination. Motions without mass give 0. */
static void solve_whole(double A[6][6], int n, double *X) {
    for (int p = 0; p < 6; p++) {
        double size = 0;
        for (int j = 0; j < 6; j++) {
            size = fmax(size, fabs(A[j][j]));
        }
        int none = !(A[p][p] > 1e-12 * size);
        double by_pivot = none ? 0 : 1 / A[p][p];
        for (int i = 0; i < 6; i++) {
            double by = A[i][p] * by_pivot;
            for (int j = 0; j < 6 && i != p; j++) {
                A[i][j] -= by * A[p][j];
            }
            cblas_daxpy(i != p ? n : 0, -by, X + (int64_t)n * p, 1, X + (int64_t)n * i, 1);
        }
        cblas_dscal(n, by_pivot, X + (int64_t)n * p, 1);
        for (int j = 0; j < 6; j++) {
            A[p][j] *= by_pivot;
        }
    }
}

/* c->mean, when the unknowns are known. R_k^T M R_j from the nodes. */
static int find_mean(spari_frame *f, const spar_member *m) {
    spari_floating_root *c = f->floating_root;
    double A[6][6] = {{0}}, *X = spari_zalloc(6 * (int64_t)f->n, sizeof *X);
    c->mean = spari_zalloc(3 * (int64_t)f->n, sizeof *c->mean);
    if (!X || !c->mean) {
        free(X);
        return SPAR_ERR_MEMORY;
    }
    for (int j = 0; j < 6; j++) {
        for (int i = 0; i < f->nodes; i++) {
            const double *push = c->push[j] + 6 * i;
            double arm[3], turn[3];
            spari_member_arm(m, i, arm);
            spari_cross(arm, push, turn);
            for (int k = 0; k < 3; k++) {
                A[k][j] += push[k];
                A[3 + k][j] += push[3 + k] + turn[k];
            }
        }
        memcpy(X + (int64_t)f->n * j, f->rigid[j], (size_t)f->n * sizeof *X);
    }
    solve_whole(A, f->n, X);
    memcpy(c->mean, X + 3 * (int64_t)f->n, (size_t)(3 * f->n) * sizeof *X);
    free(X);
    return SPAR_OK;
}

static double *copy_nodal(const spari_frame *f, const double *x) {
    double *to = spari_zalloc(6 * (int64_t)f->nodes, sizeof *to);
    if (to) {
        memcpy(to, x, (size_t)(6 * f->nodes) * sizeof *to);
    }
    return to;
}

int spari_floating_root_keep_pushes(spari_frame *f) {
    spari_floating_root *c = f->floating_root;
    int ok = 1;
    for (int k = 0; k < 6; k++) {
        ok = ok && (!f->rigid[k] || (c->push[k] = copy_nodal(f, f->rigid[k])));
        ok = ok && (!f->S[k] || (c->spin[k] = copy_nodal(f, f->f[k])));
    }
    return ok ? SPAR_OK : SPAR_ERR_MEMORY;
}

int spari_floating_root_at(const spari_frame *f, int e) {
    return e == 0 ? 0 : f->basis ? 6 * e : 6 * f->floating_root->node[e - 1];
}

int spari_floating_root_finish(spari_frame *f, const spar_member *m) {
    spari_floating_root *c = f->floating_root;
    const int64_t n = f->n, n6 = 6 * (int64_t)f->nodes, ends = 1 + c->ends, size = f->S[0] ? f->size : 0;
    double **floating_root_sizes[] = {&c->loads, &c->x,     &c->kept, &c->elastic, &c->workspace,
                                      &c->heavy, &c->parts, &c->out,  &c->border,  &c->stiff};
    const int64_t sizes[] = {n6, n6, 2 * n, n, 36 * ends * ends + 18 * ends, n6, 13 * n, 2 * n, 12 * n, size};
    const size_t wanted = f->floats ? sizeof floating_root_sizes / sizeof *floating_root_sizes : 5;
    int ok = 1, *at = spari_zalloc(ends, sizeof *at);
    for (size_t k = 0; k < wanted; k++) {
        ok = ok && (*floating_root_sizes[k] = spari_zalloc(sizes[k], sizeof(double)));
    }
    ok = ok && (c->block = spari_zalloc(31 * ends, sizeof *c->block));
    c->order = spari_zalloc(ends, sizeof *c->order);
    for (int e = 0; e < ends && at && c->order; e++) {
        c->order[e] = e;
        at[e] = spari_floating_root_at(f, e) / 6;
    }
    c->condensed = at ? spari_condensed_create(spari_member_has_joints(m) ? (int)ends : 0, at, f->n) : NULL;
    free(at);
    if (!ok || !c->order || !c->condensed) {
        return SPAR_ERR_MEMORY;
    }
    c->seen = (spari_state){c->block, c->block + 7 * ends, c->block + 13 * ends, c->block + 19 * ends};
    c->force = c->block + 25 * ends;
    if (size > 0) {
        memcpy(c->stiff, f->K, (size_t)size * sizeof *c->stiff); /* no rotation yet */
    }
    return f->S[0] ? find_mean(f, m) : SPAR_OK;
}

void spari_floating_root_free(spari_floating_root *c) {
    if (!c) {
        return;
    }
    for (int k = 0; k < 6; k++) {
        free(c->push[k]);
        free(c->spin[k]);
    }
    double *all[] = {c->block, c->kept, c->loads,  c->elastic,   c->parts, c->x,
                     c->heavy, c->out,  c->border, c->workspace, c->stiff};
    for (size_t k = 0; k < sizeof all / sizeof *all; k++) {
        free(all[k]);
    }
    free(c->mean);
    spari_solver_free(c->root);
    spari_body_free(c->body);
    spari_condensed_free(c->condensed);
    free(c->order);
    free(c->node);
    free(c);
}

int spari_floating_root_end_of(const spar_member *m, int node) {
    const spari_frame *f = m->solution;
    int e = 0;
    while (node > 0 && e < f->floating_root->ends && f->floating_root->node[e] != node) {
        e++;
    }
    return node > 0 ? 1 + e : 0;
}

/* ---- modal: amplitudes of interface nodes ---- */

int spari_floating_root_split(const spari_frame *f, double *x, double *y) {
    const spari_floating_root *c = f->floating_root;
    int n6 = 6 * f->nodes;
    for (int k = 0; k < 6 * c->ends; k++) {
        y[6 + k] = x[6 * c->node[k / 6] + k % 6];
    }
    for (int k = 0; k < 6 * c->ends; k++) {
        cblas_daxpy(n6, -y[6 + k], f->basis + 6 + k, f->n, x, 1);
    }
    return c->ends > 0 ? 6 + 6 * c->ends : f->constrained;
}

void spari_floating_root_take_rigid(const spari_frame *f, const spar_member *m, const double J[6], double *y) {
    const spari_floating_root *c = f->floating_root;
    int first = 6 + 6 * c->ends;
    for (int k = first; k < f->n; k++) { /* the part of the rigid motion beside the shapes of the interface nodes */
        const double *row = f->M + (int64_t)f->n * k;
        y[k] -= cblas_ddot(6, row, 1, J, 1);
        for (int e = 0; e < c->ends; e++) {
            double arm[3], turn[3];
            spari_member_arm(m, c->node[e], arm);
            spari_cross(J + 3, arm, turn);
            for (int i = 0; i < 3; i++) {
                y[k] += row[6 + 6 * e + i] * (J[i] + turn[i]) + row[9 + 6 * e + i] * J[3 + i];
            }
        }
    }
    for (int e = 0; e < c->ends; e++) {
        double arm[3], turn[3];
        spari_member_arm(m, c->node[e], arm);
        spari_cross(J + 3, arm, turn);
        for (int i = 0; i < 3; i++) {
            y[6 + 6 * e + i] -= J[i] + turn[i];
            y[9 + 6 * e + i] -= J[3 + i];
        }
    }
}
