/* The banded system of an assembly: see tied.h. */
#include "tied.h"

#include "../math/rotation.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static double *entry_at(const spari_assembly *a, int i, int j) {
    return a->entry + i + a->step * j;
}

/* The unknown of the system for motion k (0 to 11) of a link's nodes; -1: it is given. */
static int unknown_of_link(const spari_link *l, int k) {
    int side = k / 6;
    if (!l->limb[side]) {
        return -1;
    }
    const spari_condensed *c = l->limb[side]->condensed;
    int own = 6 * l->joint->unique[side] + k % 6;
    return own < c->fixed ? -1 : l->at[side] + k % 6;
}

static const double *turn_of_side(const spari_link *l, int side) {
    const spari_limb *p = l->limb[side];
    return p ? p->row->turn(p, l->joint->unique[side]) : NULL;
}

/* out [3][3] of row stride `to` := R K Q^T, K of row stride `from` */
static void turn_block(const double R[9], const double Q[9], int from, const double *K, int to, double *out) {
    double half[9];
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            const double *row = K + from * i;
            half[3 * i + j] = row[0] * Q[3 * j] + row[1] * Q[3 * j + 1] + row[2] * Q[3 * j + 2];
        }
    }
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            out[to * i + j] = R[3 * i] * half[j] + R[3 * i + 1] * half[3 + j] + R[3 * i + 2] * half[6 + j];
        }
    }
}

/* turn NULL: none */
static void matrix_of_turn(const double *turn, double R[9]) {
    const double none[4] = {1, 0, 0, 0};
    spari_quat_matrix(turn ? turn : none, R);
}

void spari_tied_keep(spari_assembly *a) {
    a->standing = 0;
    for (int i = 0; i < a->links; i++) {
        spari_link *l = a->link + i;
        memset(l->turning, 0, sizeof l->turning);
        spari_tie_tangent(&l->joint->tie, &l->place[0], &l->place[1], l->joint->after.load, l->turning);
        if (a->turns) {
            spari_link_turning_dampers(l, a->turning.turn.w);
        }
    }
}

/* K -= B^T (stiffness + cv damping) B of the free motions */
static void release_springs(const spari_link *l, double cv, double K[12][12]) {
    const spar_joint *j = l->joint;
    int given = spari_joint_given(j);
    for (int p = 0; p < 6; p++) {
        double row[12] = {0};
        int some = 0;
        for (int q = 0; q < 6; q++) {
            double stiff = j->stiffness[6 * p + q] + cv * j->damping[6 * p + q];
            if ((given >> p & 1) || (given >> q & 1) || stiff == 0) {
                continue;
            }
            some = 1;
            for (int i = 0; i < 12; i++) {
                row[i] += stiff * l->B[q][i];
            }
        }
        for (int i = 0; i < 12 && some; i++) {
            for (int k = 0; k < 12; k++) {
                K[i][k] -= l->B[p][i] * row[k];
            }
        }
    }
}

/* K[12][12] := what the link takes from the tangent: the turning of its load, springs and dampers. */
static void link_tangent(const spari_link *l, double cv, double K[12][12]) {
    const spar_joint *j = l->joint;
    double R[2][9];
    matrix_of_turn(turn_of_side(l, 0), R[0]);
    matrix_of_turn(turn_of_side(l, 1), R[1]);
    for (int i = 0; i < 12; i += 3) {
        for (int k = 0; k < 12; k += 3) {
            turn_block(R[i / 6], R[k / 6], 12, &l->turning[i][k], 12, &K[i][k]);
        }
    }
    if (j->sprung && !spari_joint_is_slack(j, &j->after)) {
        release_springs(l, cv, K);
    }
}

static void add_part(spari_assembly *a, const spari_limb *p) {
    const spari_condensed *c = p->condensed;
    int m = 6 * c->ends;
    for (int i = 0; i < m; i += 3) {
        double R[9];
        matrix_of_turn(p->row->turn(p, p->end[i / 6]), R);
        for (int j = 0; j < m; j += 3) {
            double Q[9], K[9];
            matrix_of_turn(p->row->turn(p, p->end[j / 6]), Q);
            turn_block(R, Q, m, c->K + m * i + j, 3, K);
            for (int k = 0; k < 9; k++) {
                *entry_at(a, p->at + i + k / 3, p->at + j + k % 3) += K[k];
            }
        }
    }
    for (int i = 0; i < m; i++) {
        a->scale = fmax(a->scale, fabs(c->K[m * i + i]));
    }
}

static void add_link(spari_assembly *a, const spari_link *l, double cv) {
    double K[12][12];
    int to[12];
    link_tangent(l, cv, K);
    for (int i = 0; i < 12; i++) {
        to[i] = unknown_of_link(l, i);
    }
    for (int i = 0; i < 12; i++) {
        for (int j = 0; j < 12 && to[i] >= 0; j++) {
            if (to[j] >= 0) {
                *entry_at(a, to[i], to[j]) -= K[i][j];
            }
        }
        for (int k = 0; k < 6 && to[i] >= 0; k++) {
            if (l->row[k] >= 0) {
                *entry_at(a, to[i], l->row[k]) = *entry_at(a, l->row[k], to[i]) = -a->scale * l->B[k][i];
            }
        }
    }
}

/* The system of the parts and links as they stand. */
static void fill_system(spari_assembly *a, double cv) {
    spari_linear_zero(a->linear);
    a->scale = 0;
    for (int i = 0; i < a->limbs; i++) {
        add_part(a, a->limb + i);
    }
    a->scale = a->scale > 0 ? a->scale : 1;
    for (int i = 0; i < a->links; i++) {
        add_link(a, a->link + i, cv);
    }
}

/* With what is left of the parts' forces at their ends in x. */
static int solve_reduced(spari_assembly *a, double cv) {
    if (!a->standing || fabs(a->cv - cv) > 0) {
        a->standing = 0;
        fill_system(a, cv);
        if (spari_linear_factor(a->linear)) {
            return 1;
        }
        a->standing = 1, a->cv = cv, a->moved = 0;
    }
    for (int i = 0; i < a->links; i++) {
        const spari_link *l = a->link + i;
        for (int k = 0; k < 6; k++) {
            if (l->row[k] >= 0) {
                a->x[l->row[k]] = -a->scale * l->gap[k];
            }
        }
    }
    if (spari_linear_solve(a->linear, a->x)) {
        return 1;
    }
    for (int i = 0; i < a->limbs; i++) {
        spari_limb *p = a->limb + i;
        p->row->expand(p, a->x + p->at);
    }
    for (int i = 0; i < a->links; i++) {
        spari_link *l = a->link + i;
        for (int k = 0; k < 6; k++) {
            l->correction[k] = l->row[k] >= 0 ? a->scale * a->x[l->row[k]] : 0;
        }
    }
    return 0;
}

int spari_tied_solve(spari_assembly *a, double cv) {
    /* first: it says how the parts have turned, which the system goes by */
    for (int i = 0; i < a->limbs; i++) {
        spari_limb *p = a->limb + i;
        if (p->row->reduce(p, a->x + p->at)) {
            return 1;
        }
    }
    return solve_reduced(a, cv);
}

int spari_tied_close(spari_assembly *a, double cv) {
    for (int i = 0; i < a->limbs; i++) {
        spari_limb *p = a->limb + i;
        p->row->clear(p);
        memset(a->x + p->at, 0, (size_t)(6 * p->condensed->ends) * sizeof *a->x);
    }
    return solve_reduced(a, cv);
}

double spari_tied_weakest(const spari_assembly *a) {
    double least = INFINITY;
    for (int i = 0; i < a->n; i++) {
        least = fmin(least, fabs(*entry_at(a, i, i)));
    }
    return least / a->scale;
}

/* Relative motion k of a link in the motion x of the system, turns by the length of its member. */
static double slip_of(const spari_link *l, const double *x, int k) {
    double slip = 0, length = 1;
    for (int i = 0; i < 12; i++) {
        int at = unknown_of_link(l, i);
        slip += at >= 0 ? l->B[k][i] * x[at] : 0;
    }
    for (int side = 0; side < 2; side++) {
        length = l->limb[side] ? spari_member_length(l->limb[side]->member) : length;
    }
    return fabs(slip) * (k < 3 ? 1 : length);
}

/* The motion x that the system resists least, by two steps of inverse iteration from a motion of no symmetry; every
   motion is given a little stiffness, so that there are factors. 0 or 1. */
static int free_motion(spari_assembly *a) {
    int lost = 0;
    a->standing = 0;
    fill_system(a, 0);
    for (int i = 0; i < a->limbs; i++) {
        for (int k = 0; k < 6 * a->limb[i].condensed->ends; k++) {
            *entry_at(a, a->limb[i].at + k, a->limb[i].at + k) += 1e-12 * a->scale;
        }
    }
    if (spari_linear_factor(a->linear)) {
        return 1;
    }
    for (int i = 0; i < a->n; i++) {
        a->x[i] = 1 + 0.37 * sin(2.7 * i);
    }
    for (int pass = 0; pass < 2 && !lost; pass++) {
        double largest = 0;
        lost = spari_linear_solve(a->linear, a->x);
        for (int i = 0; i < a->n; i++) {
            largest = fmax(largest, fabs(a->x[i]));
        }
        for (int i = 0; i < a->n && largest > 0; i++) {
            a->x[i] /= largest;
        }
    }
    return lost;
}

/* Joints that move name it best; where none does, the whole goes, and the farthest motion of a member's node does. */
void spari_tied_name_free(spari_assembly *a, char *text, int size) {
    static const char *const motion[6] = {"x", "y", "z", "the turn about x", "the turn about y", "the turn about z"};
    double most = 0, farthest = 0;
    if (free_motion(a)) {
        return;
    }
    for (int i = 0; i < a->limbs; i++) {
        const spari_limb *p = a->limb + i;
        for (int k = 0; k < 6 * p->condensed->ends; k++) {
            double x = fabs(a->x[p->at + k]) * (k % 6 < 3 ? 1 : spari_member_length(p->member));
            if (x > farthest) {
                farthest = x;
                (void)snprintf(text, (size_t)size, "%s of '%.80s' (global axes)", motion[k % 6], p->member->name);
            }
        }
    }
    for (int i = 0; i < a->links; i++) {
        const spari_link *l = a->link + i;
        for (int k = 0; k < (l->joint->tie.line ? 1 : 6); k++) {
            double slip = slip_of(l, a->x, k);
            if (slip > 1e-3 * farthest && slip > most) {
                most = slip;
                (void)snprintf(text, (size_t)size, "%s of joint '%.80s'", l->joint->tie.line ? "the length" : motion[k],
                               l->joint->name);
            }
        }
    }
}

/* ---- size ---- */

static void reach(int *band, int i, int j) {
    int d = i > j ? i - j : j - i;
    *band = d > *band ? d : *band;
}

/* Half the bandwidth: parts' ends among each other, links' nodes and rows. */
static int bandwidth(const spari_assembly *a) {
    int band = 1;
    for (int i = 0; i < a->limbs; i++) {
        reach(&band, 0, 6 * a->limb[i].condensed->ends - 1);
    }
    for (int i = 0; i < a->links; i++) {
        const spari_link *l = a->link + i;
        int all[18], n = 0;
        for (int side = 0; side < 2; side++) {
            for (int k = 0; k < 6 && l->at[side] >= 0; k++) {
                all[n++] = l->at[side] + k;
            }
        }
        for (int k = 0; k < 6; k++) {
            if (l->row[k] >= 0) {
                all[n++] = l->row[k];
            }
        }
        for (int p = 0; p < n; p++) {
            for (int q = 0; q < p; q++) {
                reach(&band, all[p], all[q]);
            }
        }
    }
    return band;
}

static int is_placed(const spari_link *l, const spari_limb *newest) {
    int placed = 1;
    for (int side = 0; side < 2; side++) {
        placed = placed && (!l->limb[side] || l->limb[side] <= newest);
    }
    return placed && (l->limb[0] == newest || l->limb[1] == newest);
}

/* Where side of a link has its six unknowns in the system */
static int place_of_end(const spari_link *l, int side) {
    const spari_limb *p = l->limb[side];
    if (!p) {
        return -1;
    }
    int e = 0;
    while (p->end[e] != l->joint->unique[side]) {
        e++;
    }
    return p->at + 6 * e;
}

/* Parts stand in the order opposite to that in which links reach them, the rows of a link after the one of its parts
   that it reached: factors then begin where branches end, and a branch fills nothing but its own. */
void spari_tied_place(spari_assembly *a) {
    a->n = 0;
    for (int i = a->limbs - 1; i >= 0; i--) {
        spari_limb *p = a->limb + i;
        p->at = a->n;
        a->n += 6 * p->condensed->ends;
        for (int k = 0; k < a->links; k++) {
            spari_link *l = a->link + k;
            for (int m = 0; m < 6 && is_placed(l, p); m++) {
                l->row[m] = l->joint->held >> m & 1 ? a->n++ : -1;
            }
        }
    }
    for (int i = 0; i < a->links; i++) {
        for (int side = 0; side < 2; side++) {
            a->link[i].at[side] = place_of_end(a->link + i, side);
        }
    }
}

int spari_tied_room(spari_assembly *a) {
    int band = bandwidth(a);
    a->linear = spari_linear_create_banded(a->n, band < a->n ? band : a->n - 1);
    a->x = spari_zalloc(a->n, sizeof *a->x);
    int64_t most = 0;
    for (int i = 0; i < a->limbs; i++) {
        most = a->limb[i].member->nodes > most ? a->limb[i].member->nodes : most;
    }
    a->rates = spari_zalloc(6 * most, sizeof *a->rates);
    a->entry = a->linear ? spari_linear_entries(a->linear, &a->step) : NULL;
    return a->linear && a->x && a->rates ? SPAR_OK : SPAR_ERR_MEMORY;
}

void spari_tied_free(spari_assembly *a) {
    spari_linear_free(a->linear);
    free(a->x);
    free(a->rates);
}
