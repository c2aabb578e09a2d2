/* The linear system of an assembly: see system.h. */
#include "system.h"

#include "../math/rotation.h"

#include <float.h>
#include <stdio.h>
#include <string.h>

/* out [3][3] of row stride `to` := R K Q^T, K of row stride `from` */
static void rotate_block(const double R[9], const double Q[9], int from, const double *K, int to, double *out) {
    double half[9];
    int any = 0;
    for (int i = 0; i < 9; i++) {
        any = any || K[from * (i / 3) + i % 3] != 0;
    }
    for (int i = 0; i < 9 && !any; i++) {
        out[to * (i / 3) + i % 3] = 0;
    }
    if (!any) {
        return;
    }
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

/* rotation NULL: none */
static void matrix_of_rotation(const double *rotation, double R[9]) {
    const double none[4] = {1, 0, 0, 0};
    spari_quat_matrix(rotation ? rotation : none, R);
}

/* Whether a constraint only makes one cluster of its nodes. */
static int is_rigid(const spari_constraint *l) {
    return l->role == SPARI_CONSTRAINT_TREE && spari_constraint_count(l) == 6;
}

/* K -= B^T (stiffness + cv damping) B of the free motions */
static void release_springs(const spari_constraint *l, double cv, double K[12][12]) {
    const spar_joint *j = l->joint;
    int given = spari_joint_constrained(j);
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

/* K[12][12] := the constraint's part of the tangent: the geometric stiffness of its load, springs and dampers. */
static void constraint_tangent(const spari_assembly *a, const spari_constraint *l, double cv, double K[12][12]) {
    memset(K, 0, 12 * sizeof *K);
    spari_kinematics_tangent(&l->joint->kinematics, &l->pose[0], &l->pose[1], l->joint->after.load, K);
    if (a->rotates) {
        spari_constraint_rotate_dampers(l, a->rotating.rotation.w, K);
    }
    if (l->springs) {
        release_springs(l, cv, K);
    }
}

/* Moves a force from the end of a lever arm to its beginning, f[stride 0 to 5]. The same holds for the columns of a
   matrix that multiplies the motion there. */
static void carry_force(const double d[3], int stride, double *f) {
    const double x = f[0], y = f[stride], z = f[2 * stride];
    f[3 * stride] += d[1] * z - d[2] * y;
    f[4 * stride] += d[2] * x - d[0] * z;
    f[5 * stride] += d[0] * y - d[1] * x;
}

static const spari_interface *moving(const spari_assembly *a, int node) {
    return node < 0 || a->interface[node].cluster < 0 ? NULL : a->interface + node;
}

static int fixed_in(const spari_assembly *a, const spari_interface *v) {
    return a->interface[v->cluster].fixed;
}

/* Adds f times the stiffness K between interface nodes v and w to the system. */
static void add_stiffness(spari_assembly *a, int v, int w, double f, const double *K, int stride) {
    const spari_interface *row = moving(a, v), *column = moving(a, w);
    double moved[36];
    int to;
    if (!row || !column) {
        return;
    }
    if (a->clusters) { /* else lever arms are 0 */
        for (int i = 0; i < 6; i++) {
            memcpy(moved + 6 * i, K + stride * i, 6 * sizeof *moved);
            carry_force(column->arm, 1, moved + 6 * i);
        }
        for (int j = 0; j < 6; j++) {
            carry_force(row->arm, 6, moved + j);
        }
        K = moved, stride = 6;
    }
    double *block = spari_blocks_at(a->system, row->block, column->block, &to);
    int first = fixed_in(a, column);
    for (int i = fixed_in(a, row); i < 6; i++) {
        for (int j = first; j < 6; j++) {
            block[to * i + j] += f * K[stride * i + j];
        }
    }
}

/* The condensed tangent of a component, in global axes. */
static void rotate_part(spari_component *p) {
    const spari_condensed *c = p->condensed;
    int m = 6 * c->ends;
    spari_component_find_rotations(p);
    for (int e = 0; e < c->ends; e++) {
        double R[9];
        matrix_of_rotation(spari_component_rotation(p, c->node[e]), R);
        for (int o = 0; o < c->ends; o++) {
            double Q[9];
            matrix_of_rotation(spari_component_rotation(p, c->node[o]), Q);
            for (int k = 0; k < 4; k++) {
                int at = m * (6 * e + 3 * (k / 2)) + 6 * o + 3 * (k % 2);
                rotate_block(R, Q, m, c->K + at, m, p->K + at);
            }
        }
    }
}

static void add_part(spari_assembly *a, spari_component *p) {
    int ends = p->condensed->ends, m = 6 * ends;
    rotate_part(p);
    for (int e = 0; e < ends; e++) {
        for (int o = 0; o < ends; o++) {
            add_stiffness(a, p->at / 6 + e, p->at / 6 + o, 1, p->K + 6 * m * e + 6 * o, m);
        }
    }
    for (int i = 0; i < m; i++) {
        double *scale = a->scale + (i % 6 >= 3);
        *scale = spari_larger(*scale, fabs(p->K[(m + 1) * i]));
    }
}

/* The force of a constraint's displacements on a. */
static void find_pull(spari_constraint *l) {
    for (int i = 0; i < 3; i++) {
        l->pull[i] = 0;
        for (int k = 0; k < 3; k++) {
            l->pull[i] += l->B[k][i] * l->joint->after.load[k];
        }
    }
}

/* Adds the stiffness `sign` d(d x f) of a force f with fixed axes on a lever arm d that rotates with node v: the
   derivative of its moment is (theta x d) x f = (f . theta) d - (d . f) theta. */
static void add_turning_arm(spari_assembly *a, const spari_interface *v, double sign, const double d[3],
                            const double f[3]) {
    int stride;
    double *block = spari_blocks_at(a->system, v->block, v->block, &stride), along = spari_dot(d, f);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            block[stride * (3 + i) + 3 + j] += sign * (d[i] * f[j] - (i == j ? along : 0));
        }
    }
}

/* Inside a cluster, the load rotates with its nodes, which are d apart. Its moment on the cluster is 0, but not the
   derivative of it. */
static void add_rigid_load(spari_assembly *a, spari_constraint *l) {
    const spari_interface *v = moving(a, l->node[0] < 0 ? l->node[1] : l->node[0]);
    double d[3];
    if (!v) {
        return;
    }
    find_pull(l);
    for (int i = 0; i < 3; i++) {
        d[i] = l->pose[0].x[i] - l->pose[1].x[i];
    }
    add_turning_arm(a, v, 1, d, l->pull);
}

/* The load of a ball has the axes of b, and acts on b along a lever arm to a's point. On the motions that the rows C
   of the constraint allow, this is the same as a force f with fixed axes on lever arms of both nodes. The tangent is
   that of such a force and C^T N + M C, with N theta_b = C_a (f x theta_b) and M z = -f x C_a^T z, a moment on b.
   The system has the former, which does not couple the nodes. N adds to the multipliers, M to the right-hand side. */
static void add_ball(spari_assembly *a, spari_constraint *l) {
    double d[2][3];
    find_pull(l);
    spari_rotate(l->pose[0].q, l->joint->kinematics.arm[0], d[0]);
    for (int i = 0; i < 3; i++) {
        d[1][i] = l->pose[0].x[i] + d[0][i] - l->pose[1].x[i];
    }
    for (int side = 0; side < 2; side++) {
        const spari_interface *v = moving(a, l->node[side]);
        if (v) {
            add_turning_arm(a, v, side ? 1 : -1, d[side], l->pull);
        }
    }
}

static int is_ball(const spari_assembly *a, const spari_constraint *l) {
    const double *moment = l->joint->after.load + 3;
    return !a->clusters && l->role == SPARI_CONSTRAINT_TREE && l->joint->constrained == 7 && !l->springs &&
           moment[0] == 0 && moment[1] == 0 && moment[2] == 0;
}

/* The moment on b of the gaps z of a ball. Its loads by the rotation of b. */
static void moment_of_gaps(const spari_constraint *l, const double z[3], double moment[3]) {
    double way[3];
    for (int i = 0; i < 3; i++) {
        way[i] = z[0] * l->rows[0][i] + z[1] * l->rows[1][i] + z[2] * l->rows[2][i];
    }
    spari_cross(l->pull, way, moment);
}

static void add_loads_of_rotation(spari_constraint *l, const double rotation[3]) {
    double change[3];
    spari_cross(l->pull, rotation, change);
    for (int k = 0; k < 3; k++) {
        l->correction[k] += spari_dot(l->rows[k], change);
    }
}

/* Adds the constraint's part of the tangent. */
static void add_constraint_stiffness(spari_assembly *a, spari_constraint *l, double cv) {
    double own[12][12], (*K)[12] = a->clusters ? a->tangents[l - a->constraint] : own;
    l->stiff = 0;
    l->stiffest = 0;
    l->ball = is_ball(a, l);
    if (l->ball || is_rigid(l)) {
        (l->ball ? add_ball : add_rigid_load)(a, l);
        return;
    }
    constraint_tangent(a, l, cv, K);
    for (int i = 0; i < 12; i++) {
        for (int j = 0; j < 12; j++) {
            l->stiffest = spari_larger(l->stiffest, fabs(K[i][j]));
        }
    }
    l->stiff = l->stiffest > 0;
    for (int n = 0; n < 4 && l->stiff; n++) {
        int i = n / 2, j = n % 2;
        add_stiffness(a, l->node[i], l->node[j], -1, &K[6 * i][6 * j], 12);
    }
}

/* The rows of a constraint for the cluster of its node on one side; 0: the node does not move. */
static int rows_of_side(const spari_assembly *a, const spari_constraint *l, int side, double rows[6][6]) {
    const spari_interface *v = moving(a, l->node[side]);
    int constrained = 0;
    for (int k = 0; k < 6 && v; k++) {
        if (spari_constraint_holds(l, k)) {
            memcpy(rows[constrained], l->rows[k] + 6 * side, sizeof rows[constrained]);
            carry_force(v->arm, 1, rows[constrained]);
            memset(rows[constrained], 0, (size_t)fixed_in(a, v) * sizeof rows[constrained][0]);
            constrained++;
        }
    }
    return constrained;
}

/* The largest stiffness of the clusters that a constraint connects, and its own. */
static double scale_of_constraint(spari_assembly *a, const spari_constraint *l) {
    double scale = l->stiffest;
    for (int side = 0; side < 2; side++) {
        const spari_interface *v = l->node[side] < 0 ? NULL : a->interface + l->node[side];
        if (v && v->cluster >= 0) {
            int stride;
            const double *block = spari_blocks_at(a->system, v->block, v->block, &stride);
            for (int k = 0; k < 6; k++) {
                scale = spari_larger(scale, fabs(block[(stride + 1) * k]));
            }
        }
    }
    return scale > 0 ? scale : a->scale[0];
}

/* The multipliers of a constraint that closes a loop have a block of their own. */
static void add_constraint(spari_assembly *a, const spari_constraint *l) {
    for (int side = 0; side < 2; side++) {
        double rows[6][6];
        int constrained = rows_of_side(a, l, side, rows), across, down;
        if (constrained == 0) {
            continue;
        }
        int block = a->interface[l->node[side]].block;
        double *left = spari_blocks_at(a->system, l->block, block, &across),
               *above = spari_blocks_at(a->system, block, l->block, &down);
        for (int k = 0; k < constrained; k++) {
            for (int j = 0; j < 6; j++) {
                left[across * k + j] -= l->scale * rows[k][j];
                above[down * j + k] -= l->scale * rows[k][j];
            }
        }
    }
}

/* A constraint that closes a loop may be all that constrains the nodes it connects. A penalty keeps the blocks
   before its own from being singular. The solution of the constraint does not change (augmented Lagrangian). */
static void add_penalty(spari_assembly *a, const spari_constraint *l, double penalty) {
    double rows[2][6][6];
    int constrained[2];
    for (int side = 0; side < 2; side++) {
        constrained[side] = rows_of_side(a, l, side, rows[side]);
    }
    for (int n = 0; n < 4; n++) {
        int i = n / 2, j = n % 2, stride;
        if (constrained[i] == 0 || constrained[j] == 0) {
            continue;
        }
        double *block =
            spari_blocks_at(a->system, a->interface[l->node[i]].block, a->interface[l->node[j]].block, &stride);
        for (int k = 0; k < 6 * constrained[i]; k++) {
            double by = penalty * l->scale * rows[i][k / 6][k % 6], *to = block + stride * (k % 6);
            for (int column = 0; column < 6; column++) {
                to[column] += by * rows[j][k / 6][column];
            }
        }
    }
}

/* E := the inverse of A. 0 or 1. */
static int invert_rotation(const double *A, int stride, double E[9]) {
    double det = 0;
    for (int i = 0; i < 9; i++) {
        int r = i / 3, c = i % 3, r1 = (r + 1) % 3, r2 = (r + 2) % 3, c1 = (c + 1) % 3, c2 = (c + 2) % 3;
        double minor = A[stride * r1 + c1] * A[stride * r2 + c2] - A[stride * r1 + c2] * A[stride * r2 + c1];
        E[3 * c + r] = minor;
        det += r == 0 ? A[c] * minor : 0;
    }
    for (int i = 0; i < 9; i++) {
        E[i] /= det;
    }
    return !(fabs(det) > 0);
}

/* y: of length 1, perpendicular to x and b. */
static void unit_across(const double x[3], const double b[3], double y[3]) {
    spari_cross(x, b, y);
    double size = spari_norm(y);
    for (int i = 0; i < 3; i++) {
        y[i] /= size;
    }
}

/* The displacements (part 0) or rotations that change one row each of a constraint, for its node on one side: columns
   of the basis, first those of the held ones. Where rows are not held or there are none, others that are perpendicular
   to the held ones stand for them. 0 or 1. */
static int find_basis(const spari_constraint *l, int side, int part, double basis[9]) {
    const spar_joint *j = l->joint;
    int held = j->constrained >> 3 * part & 7, known = part == 0 && !j->kinematics.line ? 7 : held;
    double G[3][3];
    for (int k = 0; k < 3; k++) {
        memcpy(G[k], l->B[3 * part + k] + 6 * side + 3 * part, sizeof G[k]);
    }
    for (int k = 0; k < 3 && held; k++) {
        int next = (k + 1) % 3, last = (k + 2) % 3;
        if (known >> k & 1) {
            continue;
        }
        if ((known >> next & 1) && (known >> last & 1)) {
            unit_across(G[next], G[last], G[k]);
        } else {
            const double *only = G[known >> next & 1 ? next : last];
            double axis[3] = {0};
            axis[fabs(only[0]) < 0.7 * spari_norm(only) ? 0 : 1] = 1;
            unit_across(only, axis, G[k]);
        }
        known |= 1 << k;
    }
    int first = 0, after = (held & 1) + (held >> 1 & 1) + (held >> 2 & 1);
    double E[9];
    for (int i = 0; i < 9; i++) {
        E[i] = G[i % 3][i / 3]; /* the inverse, if they are orthonormal: those of displacements */
    }
    if (part == 1 && held && invert_rotation(G[0], 3, E)) {
        return 1;
    }
    for (int k = 0; k < 3; k++) {
        int column = held >> k & 1 ? first++ : after++;
        for (int i = 0; i < 3; i++) {
            basis[3 * i + column] = E[3 * i + k];
        }
    }
    return 0;
}

/* The clusters, by the constraints as they stand. 0 or 1. */
static int find_clusters(spari_assembly *a) {
    for (int n = 0; n < a->interfaces; n++) {
        spari_interface *v = a->interface + a->order[n];
        const spari_interface *parent = v->parent < 0 ? NULL : a->interface + v->parent;
        memset(v->arm, 0, sizeof v->arm);
        if (v->cluster == a->order[n] || v->constraint < 0) {
            continue;
        }
        const spari_constraint *l = a->constraint + v->constraint;
        v->block = v->cluster < 0 ? -1 : a->interface[v->cluster].block;
        for (int k = 0; k < 3 && parent; k++) {
            v->arm[k] = parent->arm[k] + l->pose[v->side].x[k] - l->pose[1 - v->side].x[k];
        }
        if (invert_rotation(l->rows[3] + 6 * v->side + 3, 12, v->E)) {
            return 1;
        }
    }
    return 0;
}

/* Ties a cluster to its parent, at the point where the constraint holds displacements. 0 or 1. */
static int tie_cluster(spari_assembly *a, const spari_interface *v) {
    const spari_constraint *l = a->constraint + v->constraint;
    spari_tie *tie = spari_blocks_tie(a->system, v->block);
    int at = l->joint->kinematics.line ? v->side : 0;
    double arm[3];
    spari_rotate(l->pose[at].q, l->joint->kinematics.arm[at], arm);
    for (int k = 0; k < 3; k++) {
        tie->arm[k] = l->pose[v->side].x[k] - (l->pose[at].x[k] + arm[k]);
    }
    rows_of_side(a, l, 1 - v->side, tie->rows);
    return find_basis(l, v->side, 0, tie->basis[0]) || find_basis(l, v->side, 1, tie->basis[1]);
}

/* Adds the shift to every motion of the clusters, rotations times the members' lengths. */
static void add_shift(spari_assembly *a) {
    for (int i = 0; i < a->components; i++) {
        const spari_component *p = a->component + i;
        double length = spari_member_length(p->member);
        for (int e = 0; e < p->condensed->ends; e++) {
            const spari_interface *v = a->interface + p->at / 6 + e;
            int stride, own = v->cluster == p->at / 6 + e;
            double *block = own ? spari_blocks_at(a->system, v->block, v->block, &stride) : NULL;
            for (int k = own ? v->fixed : 6; k < 6; k++) {
                block[(stride + 1) * k] += a->shift * (k < 3 ? 1 : length * length);
            }
        }
    }
}

static void fill_system(spari_assembly *a, double cv, double penalty) {
    a->penalty = penalty;
    spari_blocks_zero(a->system);
    a->scale[0] = a->scale[1] = 0;
    for (int i = 0; i < a->components; i++) {
        add_part(a, a->component + i);
    }
    a->scale[0] = a->scale[0] > 0 ? a->scale[0] : 1;
    a->scale[1] = a->scale[1] > 0 ? a->scale[1] : 1;
    for (int i = 0; i < a->constraints; i++) {
        add_constraint_stiffness(a, a->constraint + i, cv);
    }
    for (int i = 0; i < a->constraints; i++) {
        spari_constraint *l = a->constraint + i;
        if (l->block >= 0) {
            l->scale = scale_of_constraint(a, l);
        }
    }
    for (int i = 0; i < a->constraints; i++) {
        const spari_constraint *l = a->constraint + i;
        if (l->block >= 0) {
            add_penalty(a, l, penalty);
            add_constraint(a, l);
        }
    }
    for (int i = 0; i < a->interfaces; i++) {
        const spari_interface *v = a->interface + i;
        for (int k = 0; k < v->fixed && v->cluster == i; k++) {
            int stride;
            double *block = spari_blocks_at(a->system, v->block, v->block, &stride);
            block[(stride + 1) * k] = a->scale[k >= 3];
        }
    }
    if (a->shift > 0) {
        add_shift(a);
    }
}

/* Forms the system of the components and constraints at the present positions. Returns 0 or 1. */
static int form_system(spari_assembly *a, double cv, double penalty) {
    for (int i = 0; i < a->constraints; i++) {
        spari_constraint *l = a->constraint + i;
        for (int k = 0; k < 6; k++) {
            if (spari_constraint_holds(l, k)) {
                memcpy(l->rows[k], l->B[k], sizeof l->rows[k]);
            }
        }
    }
    if (find_clusters(a)) {
        return 1;
    }
    fill_system(a, cv, penalty);
    int singular = 0;
    for (int i = 0; i < a->interfaces; i++) {
        const spari_interface *v = a->interface + i;
        singular = (v->cluster == i && v->constraint >= 0 && tie_cluster(a, v)) || singular;
    }
    return singular;
}

/* The smallest pivot, relative to the largest stiffness of its kind: of displacements or of rotations. */
static double weakest_pivot(const spari_assembly *a) {
    double least[2];
    spari_blocks_least_pivots(a->system, least);
    return fmin(least[0] / a->scale[0], least[1] / a->scale[1]);
}

/* Forms and factors the system. With one penalty a block may be singular by chance, but not with two different ones.
   Returns 0 or 1. */
static int factor_system(spari_assembly *a, double cv) {
    static const double penalty[2] = {8, 27}, weak = 1e-11;
    int singular = 0;
    for (int i = 0; i < 2; i++) {
        if (form_system(a, cv, penalty[i])) {
            return 1;
        }
        singular = spari_blocks_factor(a->system);
        if (!a->loops || weakest_pivot(a) > weak) {
            break;
        }
    }
    return singular;
}

/* y[6] += f A x, of row stride `stride`; with A^T. */
static void add_block_times(double f, const double *A, int stride, const double x[6], double y[6]) {
    for (int i = 0; i < 6; i++, A += stride) {
        y[i] += f * ((A[0] * x[0] + A[1] * x[1] + A[2] * x[2]) + (A[3] * x[3] + A[4] * x[4] + A[5] * x[5]));
    }
}

static void add_block_transposed(double f, const double *A, int stride, const double x[6], double y[6]) {
    for (int i = 0; i < 6; i++, A += stride) {
        double by = f * x[i];
        for (int j = 0; j < 6; j++) {
            y[j] += by * A[j];
        }
    }
}

/* y += K u of the components and constraints, [interfaces][6] */
static void add_forces_of(const spari_assembly *a, const double *u, double *y) {
    for (int i = 0; i < a->components; i++) {
        const spari_component *p = a->component + i;
        int ends = p->condensed->ends, m = 6 * ends;
        for (int n = 0; n < ends * ends; n++) {
            int row = 6 * (n / ends), column = 6 * (n % ends);
            add_block_times(1, p->K + m * row + column, m, u + p->at + column, y + p->at + row);
        }
    }
    for (int i = 0; i < a->constraints; i++) {
        const spari_constraint *l = a->constraint + i;
        for (int n = 0; n < 4 && l->stiff; n++) {
            int row = l->node[n / 2], column = l->node[n % 2];
            if (row >= 0 && column >= 0) {
                add_block_times(-1, &a->tangents[i][6 * (n / 2)][6 * (n % 2)], 12, u + 6 * column, y + 6 * row);
            }
        }
    }
}

/* A rigid constraint has the rows [A C; 0 F] for one node's motion, A orthogonal and F^-1 = E. Computes the motion
   for the gaps x, and the multipliers that balance a force y. */
static void solve_for_motion(const spari_constraint *l, const spari_interface *v, double x[6]) {
    double motion[6] = {0};
    for (int i = 0; i < 9; i++) {
        motion[3 + i / 3] += v->E[i] * x[3 + i % 3];
    }
    for (int k = 0; k < 3; k++) {
        const double *row = l->rows[k] + 6 * v->side;
        double left = x[k] - (row[3] * motion[3] + row[4] * motion[4] + row[5] * motion[5]);
        for (int i = 0; i < 3; i++) {
            motion[i] += row[i] * left;
        }
    }
    memcpy(x, motion, sizeof motion);
}

static void solve_for_loads(const spari_constraint *l, const spari_interface *v, const double y[6], double load[6]) {
    double moment[3] = {y[3], y[4], y[5]};
    for (int k = 0; k < 3; k++) {
        const double *row = l->rows[k] + 6 * v->side;
        load[k] = row[0] * y[0] + row[1] * y[1] + row[2] * y[2];
        for (int i = 0; i < 3; i++) {
            moment[i] -= row[3 + i] * load[k];
        }
    }
    for (int k = 0; k < 3; k++) {
        load[3 + k] = v->E[k] * moment[0] + v->E[3 + k] * moment[1] + v->E[6 + k] * moment[2];
    }
}

/* The motion of the interface nodes that closes the gaps while their clusters stay. Returns whether it is not zero. */
static int find_gaps(spari_assembly *a) {
    int any = 0;
    for (int n = 0; n < a->interfaces && a->clusters; n++) {
        spari_interface *v = a->interface + a->order[n];
        const spari_constraint *l = a->constraint + v->constraint;
        memset(v->gap, 0, sizeof v->gap);
        if (v->cluster == a->order[n] || v->constraint < 0) {
            continue;
        }
        if (v->parent >= 0) {
            add_block_times(-1, l->rows[0] + 6 * (1 - v->side), 12, a->interface[v->parent].gap, v->gap);
        }
        for (int k = 0; k < 6; k++) {
            v->gap[k] += l->gap[k];
            any = any || v->gap[k] != 0;
        }
        solve_for_motion(l, v, v->gap);
    }
    return any;
}

/* The remaining gaps of a constraint, of its constrained motions in order; their number. gaps: nodes move in their
   clusters. */
static int gaps_left(const spari_assembly *a, const spari_constraint *l, const double *all, int gaps, double left[6]) {
    int constrained = 0;
    for (int k = 0; k < 6; k++) {
        if (spari_constraint_holds(l, k)) {
            double gap = all[k];
            for (int side = 0; side < 2 && gaps; side++) {
                const double *of = l->node[side] < 0 ? NULL : a->interface[l->node[side]].gap;
                for (int i = 0; of && i < 6; i++) {
                    gap -= l->rows[k][6 * side + i] * of[i];
                }
            }
            left[constrained++] = gap;
        }
    }
    return constrained;
}

/* Column c of the right-hand side or of the solution in a block: number k stands at a->columns * k. */
static double *column_of(const spari_assembly *a, int block, int c) {
    return a->b + a->columns * (int64_t)spari_blocks_first(a->system, block) + c;
}

/* Adds the force f on an interface node to column c of the right-hand side. */
static inline void load_node(const spari_assembly *a, const spari_interface *v, double f[6], int c) {
    double *b = column_of(a, v->block, c);
    const int fixed = fixed_in(a, v), stride = a->columns;
    if (a->clusters) {
        carry_force(v->arm, 1, f);
    }
    for (int k = 0; k < 6; k++, b += stride) {
        *b += k < fixed ? 0 : f[k];
    }
}

/* The gaps of a constraint of the tree. */
static void load_tie(const spari_assembly *a, const spari_constraint *l, int block, int gaps, int c) {
    const spari_interface *other = moving(a, l->node[1]);
    double left[6], f[6] = {0}, *b = column_of(a, block, c) + 6 * a->columns;
    int constrained = gaps_left(a, l, c ? l->rate_gap : l->gap, gaps, left);
    for (int k = 0; k < constrained; k++) {
        b[a->columns * k] = left[k];
    }
    if (l->ball && other) {
        moment_of_gaps(l, left, f + 3);
        load_node(a, other, f, c);
    }
}

/* The gaps of a constraint that closes a loop, and the forces of its penalty. */
static void load_loop(const spari_assembly *a, const spari_constraint *l, int gaps, int c) {
    double left[6], f[12] = {0}, *b = column_of(a, l->block, c);
    (void)gaps_left(a, l, c ? l->rate_gap : l->gap, gaps, left);
    for (int k = 0, n = 0; k < 6; k++) {
        if (spari_constraint_holds(l, k)) {
            double by = l->scale * left[n];
            b[a->columns * n++] = -by;
            for (int i = 0; i < 12; i++) {
                f[i] += a->penalty * by * l->rows[k][i];
            }
        }
    }
    for (int side = 0; side < 2; side++) {
        const spari_interface *v = moving(a, l->node[side]);
        if (v) {
            load_node(a, v, f + 6 * side, c);
        }
    }
}

/* The forces y of the interface nodes in column c. */
static void load_forces(const spari_assembly *a, const double *y, int c) {
    for (int i = 0; i < a->interfaces; i++) {
        const spari_interface *v = a->interface + i;
        if (v->cluster >= 0) {
            double f[6];
            memcpy(f, y + 6 * i, sizeof f);
            load_node(a, v, f, c);
        }
    }
}

/* Column c of the right-hand side: of the gaps and the forces y that the interface nodes' balance has too many, or of
   the rates' gaps (y NULL). */
static void load_system(spari_assembly *a, const double *y, int gaps, int c) {
    for (int i = 0; i < a->interfaces; i++) {
        const spari_interface *v = a->interface + i;
        if (v->cluster >= 0 && y) {
            double f[6] = {-y[6 * i], -y[6 * i + 1], -y[6 * i + 2], -y[6 * i + 3], -y[6 * i + 4], -y[6 * i + 5]};
            load_node(a, v, f, c);
        }
        if (v->cluster == i && v->constraint >= 0) {
            load_tie(a, a->constraint + v->constraint, v->block, gaps, c);
        }
    }
    for (int i = 0; i < a->constraints; i++) {
        if (a->constraint[i].block >= 0) {
            load_loop(a, a->constraint + i, gaps, c);
        }
    }
}

/* The motion of the interface nodes with their clusters, of column c. */
static void show_motion(const spari_assembly *a, int c, double *x) {
    for (int i = 0; i < a->interfaces; i++) {
        const spari_interface *v = a->interface + i;
        const double *b = v->cluster < 0 ? NULL : column_of(a, v->block, c);
        double *to = x + 6 * i, arm[3];
        for (int k = 0; k < 6; k++) {
            to[k] = b ? b[a->columns * k] : 0;
        }
        if (b && v->cluster != i) {
            spari_cross(to + 3, v->arm, arm);
            for (int k = 0; k < 3; k++) {
                to[k] += arm[k];
            }
        }
    }
}

/* Corrections of the multipliers, by `scale` those in the system. Subtracts their forces from the unbalanced forces y
 * (NULL: none). */
static void read_multipliers(spari_constraint *l, double scale, const double *b, int stride, double *y) {
    int constrained = 0;
    for (int k = 0; k < 6; k++) {
        double by = l->correction[k] = spari_constraint_holds(l, k) ? scale * b[stride * constrained++] : 0;
        for (int side = 0; side < 2 && y && by != 0; side++) {
            double *at = l->node[side] < 0 ? NULL : y + 6 * l->node[side];
            for (int i = 0; at && i < 6; i++) {
                at[i] -= l->rows[k][6 * side + i] * by;
            }
        }
    }
}

/* Corrections of the multipliers of clusters, which balance the remaining forces y on their nodes, from the ends of
   the tree on. y NULL: there are no clusters of several nodes. */
static void find_constraint_loads(spari_assembly *a, double *y, int c) {
    for (int i = 0; i < a->constraints; i++) {
        spari_constraint *l = a->constraint + i;
        memset(l->correction, 0, sizeof l->correction);
        if (l->block >= 0) {
            read_multipliers(l, l->scale, column_of(a, l->block, c), a->columns, y);
        }
    }
    for (int n = a->interfaces - 1; n >= 0; n--) {
        const spari_interface *v = a->interface + a->order[n];
        if (v->constraint < 0) {
            continue;
        }
        spari_constraint *l = a->constraint + v->constraint;
        if (!y || v->cluster == a->order[n]) {
            read_multipliers(l, 1, column_of(a, v->block, c) + 6 * a->columns, a->columns, y);
            if (l->ball && l->node[1] >= 0) {
                add_loads_of_rotation(l, a->x + 6 * l->node[1] + 3);
            }
            continue;
        }
        solve_for_loads(l, v, y + 6 * a->order[n], l->correction);
        if (v->parent >= 0) {
            add_block_transposed(-1, l->rows[0] + 6 * (1 - v->side), 12, l->correction, y + 6 * v->parent);
        }
    }
}

static int system_serves(const spari_assembly *a, double cv) {
    return a->system_serves && !(fabs(a->cv - cv) > 0);
}

/* Solves with the condensed residuals of the components in x. loads: the corrections of the multipliers too. rates:
   solves for the rates' gaps too, in the other column. */
static int solve_reduced(spari_assembly *a, double cv, int loads, int rates) {
    if (!system_serves(a, cv)) {
        a->system_serves = 0;
        if (factor_system(a, cv)) {
            return 1;
        }
        a->system_serves = 1, a->cv = cv, a->moved = 0;
    }
    int n = 6 * a->interfaces, gaps = find_gaps(a);
    for (int i = 0; i < n; i++) {
        a->y[i] = -a->x[i];
    }
    if (gaps) {
        for (int i = 0; i < a->interfaces; i++) {
            memcpy(a->x + 6 * i, a->interface[i].gap, sizeof a->interface[i].gap);
        }
        add_forces_of(a, a->x, a->y);
    }
    a->columns = rates ? 2 : 1;
    memset(a->b, 0, (size_t)(a->columns * spari_blocks_rows(a->system)) * sizeof *a->b);
    load_system(a, a->y, gaps, 0);
    if (rates) {
        load_system(a, NULL, 0, 1);
    }
    if (spari_blocks_solve(a->system, a->columns, a->b)) {
        return 1;
    }
    show_motion(a, 0, a->x);
    if (a->clusters && loads) {
        add_forces_of(a, a->x, a->y);
    }
    if (loads) {
        find_constraint_loads(a, a->clusters ? a->y : NULL, 0);
    }
    for (int i = 0; i < n && gaps; i++) {
        a->x[i] += a->interface[i / 6].gap[i % 6];
    }
    return 0;
}

void spari_constraints_add_forces(const spari_assembly *a, spari_component *p) {
    if (a->constraints == 0) { /* a member that is solved alone */
        return;
    }
    for (int n = 0; n < p->member->joint_count; n++) {
        const spari_constraint *l = a->constraint + p->member->joints[n]->constraint;
        for (int side = 0; side < 2; side++) {
            for (int k = 0; k < 6 && l->component[side] == p; k++) {
                p->solver->r[6 * l->joint->unique[side] + k] -= l->force[6 * side + k];
            }
        }
    }
    memset(p->solver->r, 0, (size_t)spari_member_constrained(p->member) * sizeof(double));
}

void spari_constraints_correct_loads(spari_assembly *a, double cut) {
    for (int i = 0; i < a->constraints; i++) {
        for (int k = 0; k < 6; k++) {
            a->constraint[i].joint->after.load[k] -= cut * a->constraint[i].correction[k];
        }
    }
}

int spari_system_reduce(spari_assembly *a, int rotated) {
    for (int i = 0; i < a->components; i++) {
        spari_component *p = a->component + i;
        if (spari_component_reduce(p, rotated, a->x + p->at)) {
            return 1;
        }
    }
    return 0;
}

int spari_system_solve_reduced(spari_assembly *a, double cv, int rates) {
    if (solve_reduced(a, cv, 1, rates && !a->clusters)) {
        return 1;
    }
    for (int i = 0; i < a->components; i++) {
        spari_component *p = a->component + i;
        spari_component_expand(p, a->x + p->at);
        p->correction_size = p->row->correction_size(p);
    }
    return 0;
}

int spari_system_solve(spari_assembly *a, double cv) {
    return spari_system_reduce(a, 0) || spari_system_solve_reduced(a, cv, 0);
}

int spari_system_solve_gaps(spari_assembly *a, double cv, int loads) {
    for (int i = 0; i < a->components && !system_serves(a, cv); i++) {
        spari_component_clear(a->component + i); /* for the rotations */
    }
    memset(a->x, 0, (size_t)(6 * a->interfaces) * sizeof *a->x);
    return solve_reduced(a, cv, loads, 0);
}

int spari_system_solve_rates(spari_assembly *a, double cv) {
    if (a->clusters) { /* the gaps of nodes in their clusters are those of one column only */
        for (int i = 0; i < a->constraints; i++) {
            memcpy(a->constraint[i].gap, a->constraint[i].rate_gap, sizeof a->constraint[i].gap);
        }
        return spari_system_solve_gaps(a, cv, 1);
    }
    show_motion(a, 1, a->x);
    find_constraint_loads(a, NULL, 1);
    return 0;
}

int spari_system_shift_rates(spari_assembly *a, double cv, double v, double acceleration, double memory) {
    if (a->constraints == 0) {
        return 0;
    }
    if (spari_system_solve_gaps(a, cv, 0)) {
        return 1;
    }
    for (int i = 0; i < a->components; i++) {
        spari_component_clear(a->component + i);
        spari_component_expand(a->component + i, a->x + a->component[i].at);
        spari_component_shift_rates(a->component + i, v, acceleration, memory);
    }
    return 0;
}

/* The moment that a load causes if its lever arms rotate by 1 rad. */
static double moment_of_load(const spari_constraint *l, const double load[6]) {
    return l->reach * spari_norm(load) + spari_norm(load + 3);
}

/* |x|^T |K| |x| of a constraint in the motion a->x: of its springs, and of its loads, which are as accurate as those
   from which the iteration began. */
static double stiffness_of_constraint(const spari_assembly *a, const spari_constraint *l) {
    const double moment = moment_of_load(l, l->joint->after.load) + moment_of_load(l, l->begin.load);
    double K[12][12], x[12], sum = 0;
    constraint_tangent(a, l, 0, K);
    for (int i = 0; i < 12; i++) {
        x[i] = l->node[i / 6] < 0 ? 0 : a->x[6 * l->node[i / 6] + i % 6];
        sum += i % 6 < 3 ? 0 : moment * x[i] * x[i];
    }
    for (int i = 0; i < 144; i++) {
        sum += fabs(x[i / 12] * K[i / 12][i % 12] * x[i % 12]);
    }
    return sum;
}

/* The largest difference between K_ij and K_ji of a component, in N/m, beyond those of unbalanced moments of its nodes:
   rounding of its condensation. Two rotations of a node do not commute, and are left out. */
static double lopsidedness(const spari_component *p, double unbalanced) {
    const double length = spari_member_length(p->member);
    double most = 0;
    for (int i = 0, m = 6 * p->condensed->ends; i < m; i++) {
        for (int j = 0; j < i; j++) {
            double size = (i % 6 < 3 ? 1 : length) * (j % 6 < 3 ? 1 : length);
            int rotations = i % 6 >= 3 && j % 6 >= 3 && i / 6 == j / 6;
            most = rotations ? most : fmax(most, fabs(p->K[m * i + j] - p->K[m * j + i]) / size);
        }
    }
    return fmax(0, most - unbalanced * p->body->unique / length);
}

/* Rounding of a sum of products, relative to that of their absolute values. */
static const double rounding = 256 * DBL_EPSILON;

/* The same of a component and its constraints. Before condensation its stiffness is larger: `stiffest` is its force for
   a strain of 1, so that a motion of 1 between nodes n apart has n times this over the length. The rounding that is
   measured counts once: a matrix of m rows has at most m times its largest element as norm. */
static double stiffness_of_motion(const spari_assembly *a, const spari_component *p, double unbalanced) {
    const double *x = a->x + p->at, length = spari_member_length(p->member);
    const int m = 6 * p->condensed->ends;
    const double within = p->body->stiffest * p->body->unique / length + m * lopsidedness(p, unbalanced) / rounding;
    double sum = 0;
    for (int i = 0; i < m; i++) {
        double way = fabs(x[i]) * (i % 6 < 3 ? 1 : length);
        sum += within * way * way;
        for (int j = 0; j < m; j++) {
            sum += fabs(x[i] * p->K[m * i + j] * x[j]);
        }
    }
    for (int n = 0; n < p->member->joint_count; n++) {
        sum += stiffness_of_constraint(a, a->constraint + p->member->joints[n]->constraint);
    }
    return sum;
}

/* The motion caused by a force F on every interface node and a moment F times the member's length does the work W. If a
   stiffness k opposes the motion, W is of the size k |x|^2, and rounding errors are of the size eps |x|^T |K| |x|: both
   are energies, so that no unit matters. */
int spari_system_is_loose(spari_assembly *a, double unbalanced) {
    a->columns = 1;
    memset(a->b, 0, (size_t)spari_blocks_rows(a->system) * sizeof *a->b);
    for (int i = 0; i < a->components; i++) {
        const spari_component *p = a->component + i;
        for (int k = 0, m = 6 * p->condensed->ends; k < m; k++) {
            double sign = sin(1 + 12.9898 * (p->at + k));
            a->y[p->at + k] = copysign(0.5, sign) + sign;
            a->y[p->at + k] *= k % 6 < 3 ? 1 : spari_member_length(p->member);
        }
    }
    load_forces(a, a->y, 0);
    if (spari_blocks_solve(a->system, 1, a->b)) {
        return 1;
    }
    show_motion(a, 0, a->x);
    int loose = 0;
    for (int i = 0; i < a->components && !loose; i++) {
        const spari_component *p = a->component + i;
        double work = 0;
        int moves = 0; /* a fixed member does not, and its joints are those of the others too */
        for (int k = p->at; k < p->at + 6 * p->condensed->ends; k++) {
            work += fabs(a->y[k] * a->x[k]);
            moves = moves || a->x[k] != 0;
        }
        loose = moves && !(work >= rounding * stiffness_of_motion(a, p, unbalanced));
    }
    return loose;
}

int spari_system_count_negative(const spari_assembly *a) {
    int multipliers = 0;
    for (int i = 0; i < a->constraints; i++) {
        multipliers += a->constraint[i].block >= 0 ? spari_constraint_count(a->constraint + i) : 0;
    }
    return spari_blocks_negative(a->system) - multipliers;
}

/* Relative motion k of a constraint in the motion x of the system, rotations times the length of its member. */
static double slip_of(const spari_constraint *l, const double *x, int k) {
    double slip = 0, length = 1;
    for (int i = 0; i < 12; i++) {
        slip += l->node[i / 6] >= 0 ? l->B[k][i] * x[6 * l->node[i / 6] + i % 6] : 0;
    }
    for (int side = 0; side < 2; side++) {
        length = l->component[side] ? spari_member_length(l->component[side]->member) : length;
    }
    return fabs(slip) * (k < 3 ? 1 : length);
}

/* Scales the motion in b to a largest entry of 1, and sets the multipliers to 0. */
static void scale_motion(spari_assembly *a) {
    double largest = 0;
    for (int pass = 0; pass < 2; pass++) {
        for (int i = 0; i < a->interfaces; i++) {
            const spari_interface *v = a->interface + i;
            double *b = v->cluster == i ? column_of(a, v->block, 0) : NULL;
            for (int k = 0; k < 6 && b; k++) {
                largest = pass ? largest : fmax(largest, fabs(b[k]));
                b[k] /= pass && largest > 0 ? largest : 1;
            }
            for (int k = 0; b && v->constraint >= 0 && k < spari_constraint_count(a->constraint + v->constraint); k++) {
                b[6 + k] = 0;
            }
        }
    }
    for (int i = 0; i < a->constraints; i++) {
        const spari_constraint *l = a->constraint + i;
        for (int k = 0; l->block >= 0 && k < spari_constraint_count(l); k++) {
            column_of(a, l->block, 0)[k] = 0;
        }
    }
}

/* x := the motion with the least stiffness, by two steps of inverse iteration from a motion without symmetry. A
   small stiffness is added to every motion, so that the system can be factored. Returns 0 or 1. */
static int free_motion(spari_assembly *a) {
    int n = spari_blocks_rows(a->system);
    a->system_serves = 0;
    a->columns = 1;
    if (form_system(a, 0, 8)) {
        return 1;
    }
    for (int i = 0; i < a->interfaces; i++) {
        int block = a->interface[i].cluster == i ? a->interface[i].block : -1, stride;
        for (int k = 0; k < 6 && block >= 0; k++) {
            double *entry = spari_blocks_at(a->system, block, block, &stride);
            entry[(stride + 1) * k] += 1e-12 * a->scale[k >= 3];
        }
    }
    if (spari_blocks_factor(a->system)) {
        return 1;
    }
    for (int i = 0; i < n; i++) {
        a->b[i] = 1 + 0.37 * sin(2.7 * i);
    }
    for (int pass = 0; pass < 2; pass++) {
        scale_motion(a);
        if (spari_blocks_solve(a->system, 1, a->b)) {
            return 1;
        }
    }
    scale_motion(a);
    show_motion(a, 0, a->x);
    return 0;
}

/* Names the motion by the joints that move. If no joint moves, the assembly moves as a whole; the member whose node
   moves farthest then names the motion. */
void spari_system_name_free(spari_assembly *a, char *text, int size) {
    static const char *const motion[6] = {
        "x", "y", "z", "the rotation about x", "the rotation about y", "the rotation about z"};
    double most = 0, farthest = 0;
    if (free_motion(a)) {
        return;
    }
    for (int i = 0; i < a->components; i++) {
        const spari_component *p = a->component + i;
        for (int k = 0; k < 6 * p->condensed->ends; k++) {
            double x = fabs(a->x[p->at + k]) * (k % 6 < 3 ? 1 : spari_member_length(p->member));
            if (x > farthest) {
                farthest = x;
                (void)snprintf(text, (size_t)size, "%s of '%.80s' (global axes)", motion[k % 6], p->member->name);
            }
        }
    }
    for (int i = 0; i < a->constraints; i++) {
        const spari_constraint *l = a->constraint + i;
        for (int k = 0; k < (l->joint->kinematics.line ? 1 : 6); k++) {
            double slip = slip_of(l, a->x, k);
            if (slip > 1e-3 * farthest && slip > most) {
                most = slip;
                (void)snprintf(text, (size_t)size, "%s of joint '%.80s'",
                               l->joint->kinematics.line ? "the length" : motion[k], l->joint->name);
            }
        }
    }
}
