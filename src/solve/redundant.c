/* Constraints of an assembly that say what others say already. */
#include "tied.h"

#include "../math/rotation.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A row is dependent when so little of it is left beside those before it: far above what rounding leaves (1e-15 times
   the number of rows), far below what a mechanism's geometry leaves. */
static const double dependent = 1e-9;

/* A graph of n + 1 vertices (the ground is one) with as many links as a tree has, or fewer, has no loop in which a
   constraint could be said twice; two links between the same vertices are one. */
static int has_loop(const spari_assembly *a) {
    int grounded = 0;
    for (int i = 0; i < a->links; i++) {
        grounded |= !a->link[i].limb[0] || !a->link[i].limb[1];
    }
    for (int i = 0; i < a->limbs; i++) {
        grounded |= a->limb[i].member->root != SPAR_ROOT_FREE;
    }
    int rooted = 0;
    for (int i = 0; i < a->limbs; i++) {
        rooted += a->limb[i].member->root != SPAR_ROOT_FREE; /* a link to the ground of its own */
    }
    return a->links + rooted > a->limbs + grounded - 1;
}

/* The row of held motion k in the unknowns of the parts' ends, turns times the size of the joint's member; 0: none. */
static void read_row(const spari_assembly *a, const spari_link *l, int k, double *row) {
    memset(row, 0, (size_t)a->n * sizeof *row);
    for (int i = 0; i < 12; i++) {
        int side = i / 6;
        if (!l->limb[side]) {
            continue;
        }
        const spar_member *m = l->limb[side]->member;
        int own = 6 * l->joint->unique[side] + i % 6;
        if (own < spari_member_held(m)) {
            continue;
        }
        row[l->at[side] + i % 6] = l->B[k][i] / (i % 6 < 3 ? 1 : spari_member_length(m));
    }
}

static double norm_of(const double *x, int n) {
    double sum = 0;
    for (int i = 0; i < n; i++) {
        sum += x[i] * x[i];
    }
    return sqrt(sum);
}

/* Takes what the orthonormal rows [count][n] have of x out of it, twice for rounding's sake; what is left of its size.
 */
static double orthogonalise(const double *rows, int count, int n, double *x) {
    double before = norm_of(x, n);
    for (int pass = 0; pass < 2; pass++) {
        for (int r = 0; r < count; r++) {
            const double *y = rows + (int64_t)r * n;
            double along = 0;
            for (int i = 0; i < n; i++) {
                along += x[i] * y[i];
            }
            for (int i = 0; i < n; i++) {
                x[i] -= along * y[i];
            }
        }
    }
    double after = norm_of(x, n);
    for (int i = 0; i < n && after > 0; i++) {
        x[i] /= after;
    }
    return before > 0 ? after / before : 0;
}

static void tell(const spari_link *l, int k) {
    static const char *const motion[6] = {"x", "y", "z", "the turn about x", "the turn about y", "the turn about z"};
    char text[SPARI_MESSAGE_SIZE];
    const spar_session *s = l->joint->session;
    if (s->log) {
        (void)snprintf(text, sizeof text,
                       "joint '%.200s': it holds %s, which follows from the other joints already; this hold is left "
                       "out, and its load is 0",
                       l->joint->name, l->joint->tie.line ? "its length" : motion[k]);
        spari_log(s, SPAR_LOG_WARNING, text);
    }
}

int spari_tied_drop_redundant(spari_assembly *a) {
    int count = 0, holds = 0;
    if (!has_loop(a)) {
        return SPAR_OK;
    }
    for (int i = 0; i < a->links; i++) {
        holds += 6;
    }
    double *rows = spari_zalloc((int64_t)holds * a->n, sizeof *rows);
    if (!rows) {
        return SPAR_ERR_MEMORY;
    }
    for (int i = 0; i < a->links; i++) {
        spari_link *l = a->link + i;
        for (int k = 0; k < 6; k++) {
            double *row = rows + (int64_t)count * a->n;
            if (!(l->joint->held >> k & 1)) {
                continue;
            }
            read_row(a, l, k, row);
            if (orthogonalise(rows, count, a->n, row) > dependent) {
                count++;
            } else {
                l->joint->held &= ~(1 << k);
                tell(l, k);
            }
        }
    }
    free(rows);
    return SPAR_OK;
}
