/* Redundant constraints of an assembly: those that close a loop and follow from the rest of it. */
#include "../base/session.h"
#include "system.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A constraint is redundant if the part of its row that is independent of the others is below this. The limit is far
   above rounding (1e-15 times the number of rows), and far below the independent part in a mechanism. */
static const double dependent = 1e-9;

/* The connection of an interface node to the tree, in relative coordinates: u = N z + T u_parent. */
typedef struct tree_step {
    int first, count; /* of z among all coordinates */
    double N[6][6];   /* a column a coordinate */
    double T[6][6];
} tree_step;

/* A row in relative coordinates, from its own to `end`. */
typedef struct loop_row {
    int end;
    double *x; /* NULL: none */
} loop_row;

/* The loops' rows so far, triangular: row[i] begins with coordinate i. */
typedef struct loop_rows {
    int n;
    double length; /* of the members: scales rotations */
    tree_step *step;
    loop_row *row;
    double *x; /* the row under way */
} loop_rows;

static double norm_of(const double *x, int n) {
    double sum = 0;
    for (int i = 0; i < n; i++) {
        sum += x[i] * x[i];
    }
    return sqrt(sum);
}

/* Subtracts from x its part along the orthonormal y. Returns the size of that part. */
static double take_along(const double y[6], double x[6]) {
    double along = 0;
    for (int i = 0; i < 6; i++) {
        along += x[i] * y[i];
    }
    for (int i = 0; i < 6; i++) {
        x[i] -= along * y[i];
    }
    return along;
}

/* N: the complement of the orthonormal Q[constrained]. */
static void complete(double Q[6][6], int constrained, tree_step *step) {
    step->count = 6 - constrained;
    memset(step->N, 0, sizeof step->N);
    for (int column = 0; column < 6 - constrained; column++) {
        int best = 0;
        double most = -1, x[6];
        for (int pass = 0; pass <= 6; pass++) { /* last: the axis with the largest independent part */
            int axis = pass < 6 ? pass : best;
            for (int i = 0; i < 6; i++) {
                x[i] = i == axis;
            }
            for (int j = 0; j < 2 * (constrained + column); j++) {
                (void)take_along(Q[j % (constrained + column)], x);
            }
            best = pass < 6 && norm_of(x, 6) > most ? pass : best;
            most = pass < 6 ? fmax(most, norm_of(x, 6)) : most;
        }
        for (int i = 0; i < 6; i++) {
            Q[constrained + column][i] = step->N[i][column] = x[i] / most;
        }
    }
}

/* With the constrained rows H = L Q of a node's own motion and Q orthonormal: T = -Q^T L^-1 H_parent, and N is the
   complement of Q. */
static void find_step(const loop_rows *all, const spari_assembly *a, const spari_interface *v, tree_step *step) {
    double Q[6][6], own[12];
    const spari_constraint *l = v->constraint < 0 ? NULL : a->constraint + v->constraint;
    int constrained = 0;
    for (int k = 0; k < v->fixed; k++) {
        memset(Q[constrained], 0, sizeof Q[constrained]);
        Q[constrained++][k] = 1;
    }
    for (int k = 0; k < 6 && l; k++) {
        if (!spari_constraint_holds(l, k)) {
            continue;
        }
        for (int i = 0; i < 12; i++) {
            own[(i + 6 * v->side) % 12] = l->B[k][i] / (i % 6 < 3 ? 1 : all->length);
        }
        double parent[6] = {0};
        for (int i = 0; i < 6; i++) {
            parent[i] = v->parent < 0 ? 0 : -own[6 + i];
        }
        for (int j = 0; j < constrained; j++) {
            double along = take_along(Q[j], own);
            for (int i = 0; i < 6; i++) {
                parent[i] -= along * step->N[j][i]; /* N stores L^-1 H_parent until N is formed */
            }
        }
        double size = norm_of(own, 6);
        for (int i = 0; i < 6; i++) {
            Q[constrained][i] = own[i] / size;
            step->N[constrained][i] = parent[i] / size;
        }
        constrained++;
    }
    for (int i = 0; i < 36; i++) {
        step->T[i / 6][i % 6] = 0;
        for (int j = 0; j < constrained && l; j++) {
            step->T[i / 6][i % 6] += Q[j][i / 6] * step->N[j][i % 6];
        }
    }
    complete(Q, constrained, step);
}

/* Adds w u of an interface node to the row: along the tree up to `stop`. */
static void follow_tree(loop_rows *all, const spari_assembly *a, int node, const double w[6], int *first, int *end) {
    double row[6];
    memcpy(row, w, sizeof row);
    for (int v = node; v >= 0; v = a->interface[v].parent) {
        const tree_step *step = all->step + v;
        double up[6] = {0};
        for (int i = 0; i < 6; i++) {
            for (int k = 0; k < 6; k++) {
                up[k] += row[i] * step->T[i][k];
                if (k < step->count) {
                    all->x[step->first + k] += row[i] * step->N[i][k];
                }
            }
        }
        *first = step->count && step->first < *first ? step->first : *first;
        *end = step->first + step->count > *end ? step->first + step->count : *end;
        memcpy(row, up, sizeof row);
    }
}

/* Forms the row of constrained motion k of a constraint, in all->x from *first to *end. Returns its size. */
static double read_row(loop_rows *all, const spari_assembly *a, const spari_constraint *l, int k, int *first,
                       int *end) {
    double size = 0;
    *first = all->n, *end = 0;
    for (int side = 0; side < 2; side++) {
        double w[6];
        for (int i = 0; i < 6; i++) {
            w[i] = l->B[k][6 * side + i] / (i < 3 ? 1 : all->length);
            size += l->node[side] < 0 ? 0 : w[i] * w[i];
        }
        follow_tree(all, a, l->node[side], w, first, end);
    }
    return sqrt(size);
}

/* Takes a row into the triangle by rotations in the planes of two rows. 1: nothing is left of it, it is redundant; -1:
   no memory. */
static int take_row(loop_rows *all, int first, int end, double size) {
    double *x = all->x;
    for (int i = first; i < end; i++) {
        loop_row *r = all->row + i;
        if (fabs(x[i]) <= dependent * size) {
            x[i] = 0;
            continue;
        }
        if (r->end < end || !r->x) {
            double *more = spari_zalloc(end - i, sizeof *more);
            if (!more) {
                return -1;
            }
            memcpy(more, r->x ? r->x : x + i, (size_t)((r->x ? r->end : end) - i) * sizeof *more);
            int is_new = !r->x;
            free(r->x);
            r->x = more, r->end = end;
            if (is_new) {
                memset(x + i, 0, (size_t)(end - i) * sizeof *x);
                return 0;
            }
        }
        double length = hypot(r->x[0], x[i]), c = r->x[0] / length, s = x[i] / length;
        end = r->end;
        for (int k = i; k < end; k++) {
            double above = r->x[k - i];
            r->x[k - i] = c * above + s * x[k];
            x[k] = c * x[k] - s * above;
        }
        x[i] = 0;
    }
    return 1;
}

static void warn_redundant(const spari_constraint *l, int k) {
    static const char *const motion[6] = {
        "x", "y", "z", "the rotation about x", "the rotation about y", "the rotation about z"};
    spari_warn(l->joint->session,
               "joint '%.200s': redundant constraint ignored: %s follows from the other joints; its load is 0",
               l->joint->name, l->joint->kinematics.line ? "its length" : motion[k]);
}

static int drop_from_constraint(loop_rows *all, const spari_assembly *a, const spari_constraint *l) {
    for (int k = 0; k < 6; k++) {
        int first, end;
        if (!spari_constraint_holds(l, k)) {
            continue;
        }
        double size = read_row(all, a, l, k, &first, &end);
        int redundant = take_row(all, first, end, size);
        if (redundant < 0) {
            return SPAR_ERR_MEMORY;
        }
        if (redundant) {
            l->joint->constrained &= ~(1 << k);
            warn_redundant(l, k);
        }
    }
    return SPAR_OK;
}

static int begin_rows(loop_rows *all, const spari_assembly *a) {
    all->step = spari_zalloc(a->interfaces + 1, sizeof *all->step);
    if (!all->step) {
        return SPAR_ERR_MEMORY;
    }
    for (int i = 0; i < a->components; i++) {
        all->length = fmax(all->length, spari_member_length(a->component[i].member));
    }
    for (int n = 0; n < a->interfaces; n++) {
        tree_step *step = all->step + a->order[n];
        find_step(all, a, a->interface + a->order[n], step);
        step->first = all->n;
        all->n += step->count;
    }
    all->row = spari_zalloc(all->n + 1, sizeof *all->row);
    all->x = spari_zalloc(all->n + 1, sizeof *all->x);
    return all->row && all->x ? SPAR_OK : SPAR_ERR_MEMORY;
}

int spari_system_drop_redundant(spari_assembly *a) {
    loop_rows all = {0};
    int loops = 0;
    for (int i = 0; i < a->constraints; i++) {
        loops += a->constraint[i].role == SPARI_CONSTRAINT_LOOP;
    }
    int status = loops ? begin_rows(&all, a) : SPAR_OK;
    for (int i = 0; i < a->constraints && status == SPAR_OK && loops; i++) {
        if (a->constraint[i].role == SPARI_CONSTRAINT_LOOP) {
            status = drop_from_constraint(&all, a, a->constraint + i);
        }
    }
    for (int i = 0; i < all.n && all.row; i++) {
        free(all.row[i].x);
    }
    free(all.row);
    free(all.step);
    free(all.x);
    return status;
}
