/* Joints in the small-motion equations: springs, dampers, geometric stiffness of their loads, and constraints. */
#include "small_motions_joints.h"

#include "../base/session.h"
#include "../math/rotation.h"
#include "../time/component.h"
#include "../time/fidelity.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Motion of a joint's node by the unknowns of its part, which are those of the node or of a rigid body: the nonzero
   columns. */
typedef struct motion_side {
    const spari_motion_part *part; /* NULL: prescribed motion */
    int count, column[6];          /* numbers among all unknowns */
    double S[6][6];
} motion_side;

static void find_columns(const spari_small_motions *w, const spar_joint *j, int side, motion_side *of) {
    const spar_member *m = of->part->member;
    int constrained = spari_member_constrained(m), own = !m->row->whole;
    double *unit = w->workspace, *work = unit + of->part->size, *nodes = work + 6 * (int64_t)m->body->unique;
    int first = own ? 6 * j->unique[side] - constrained : 0, end = own ? first + 6 : of->part->size;
    memset(unit, 0, (size_t)of->part->size * sizeof *unit);
    of->count = 0;
    for (int c = first < 0 ? 0 : first; c < end; c++) {
        double *S = of->S[of->count], size = 0;
        if (own) {
            memset(S, 0, 6 * sizeof *S);
            S[c - first] = 1;
        } else {
            unit[c] = 1;
            m->row->shape(m, unit, work, nodes);
            unit[c] = 0;
            memcpy(S, nodes + 6 * j->seat[side], 6 * sizeof *S);
        }
        for (int k = 0; k < 6; k++) {
            size = fmax(size, fabs(S[k]));
        }
        if (size > 0) {
            of->column[of->count++] = of->part->at + c;
        }
    }
}

/* Derivative of the nodes' rates [12] with respect to their motion: V = d v / d x, in the frame (steady_rotation.h),
   v the present rates. */
static void rates_of_nodes(const spari_small_motions *w, const spar_joint *j, const motion_side of[2], double v[12],
                           double V[12][12]) {
    memset(V, 0, 144 * sizeof V[0][0]);
    for (int side = 0; side < 2; side++) {
        const spar_member *m = j->member[side];
        memset(v + 6 * side, 0, 6 * sizeof *v);
        if (m) {
            memcpy(v + 6 * side, m->after.v + 6 * j->seat[side], 6 * sizeof *v);
        }
        for (int half = 0; half < 2 && of[side].part; half++) {
            double rotation[3], W[3][3];
            for (int k = 0; k < 3; k++) {
                rotation[k] = half ? w->w[k] - of[side].part->own[k] : w->w[k];
            }
            spari_skew(rotation, *W);
            for (int i = 0; i < 9; i++) {
                V[6 * side + 3 * half + i / 3][6 * side + 3 * half + i % 3] = W[i / 3][i % 3];
            }
        }
    }
}

typedef struct motion_joint {
    double K[12][12], C[12][12], B[6][12], f[12];
    double bound[12][12]; /* the part of K that depends on the joint's axes, without the rotation of loads that rotate
                             with all */
    int given;
} motion_joint;

/* K, C += B^T (k B + d R), B^T d B over the free motions; K into `bound` too */
static void add_spring(const spar_joint *j, double R[6][12], motion_joint *of) {
    for (int pq = 0; pq < 36; pq++) {
        int p = pq / 6, q = pq % 6, off = (of->given >> p & 1) || (of->given >> q & 1);
        double k = off ? 0 : j->stiffness[pq], d = off ? 0 : j->damping[pq];
        for (int i = 0; i < 144 && (k != 0 || d != 0); i++) {
            int r = i / 12, c = i % 12;
            double spring = of->B[p][r] * (k * of->B[q][c] + d * R[q][c]);
            of->K[r][c] += spring;
            of->bound[r][c] += spring;
            of->C[r][c] += d * of->B[p][r] * of->B[q][c];
        }
    }
}

SPARI_APART static void linearise_joint(const spari_small_motions *w, const spar_joint *j, const motion_side side[2],
                                        motion_joint *of) {
    spari_node_pose pose[2];
    spari_relative at = j->after;
    double v[12], V[12][12], R[6][12], stands[6];
    *of = (motion_joint){.given = spari_joint_constrained(j)};
    spari_joint_poses(j, pose);
    rates_of_nodes(w, j, side, v, V);
    spari_kinematics_motion(&j->kinematics, &pose[0], &pose[1], at.z, of->B);
    spari_joint_count_turns(j, j->after.z, at.z);
    int springs = spari_joint_spring(j, at.z, at.rate, INFINITY, 1, at.load);
    spari_kinematics_tangent(&j->kinematics, &pose[0], &pose[1], at.load, of->K);
    spari_kinematics_forces(of->B, at.load, of->f);
    for (int k = 0; k < 6;
         k++) { /* constraint and spring forces are steady like the motion; the host's loads are fixed in space */
        stands[k] = of->given >> k & 1 ? 0 : j->given[k] + j->preload[k];
    }
    spari_kinematics_tangent(&j->kinematics, &pose[0], &pose[1], stands, of->bound);
    for (int i = 0; i < 144; i++) {
        of->K[i / 12][i % 12] *= -1;
        of->bound[i / 12][i % 12] *= -1;
    }
    memset(R, 0, sizeof R);
    if (springs && !w->modes) {
        spari_kinematics_rates(&j->kinematics, &pose[0], &pose[1], v, R);
        for (int i = 0; i < 72; i++) {
            for (int k = 0; k < 12; k++) {
                R[i / 12][i % 12] += of->B[i / 12][k] * V[k][i % 12];
            }
        }
    }
    if (springs) {
        add_spring(j, R, of);
    }
    for (int i = 0; i < 144 && w->modes; i++) {
        double *x = &of->K[i / 12][i % 12], *y = &of->K[i % 12][i / 12];
        *x = *y = 0.5 * (*x + *y);
    }
}

/* |A T - T A| of a 12 x 12 matrix, T the rotation of vectors with s; *size: its scale. */
static double change_by_rotation(double A[12][12], const double s[3], double *size) {
    double W[3][3], change = 0;
    spari_skew(s, *W);
    for (int i = 0; i < 12; i++) {
        for (int k = 0; k < 12; k++) {
            double sum = 0;
            for (int l = 0; l < 3; l++) {
                sum += A[i][k - k % 3 + l] * W[l][k % 3] - W[i % 3][l] * A[i - i % 3 + l][k];
            }
            change = fmax(change, fabs(sum));
            *size = fmax(*size, fabs(A[i][k]));
        }
    }
    return change;
}

/* Projection onto the constrained motions, B^T (B B^T)^-1 B of the given rows, by Gram-Schmidt. */
static void constrained_directions(const motion_joint *of, double P[12][12]) {
    double row[6][12] = {{0}};
    int count = 0;
    memset(P, 0, 144 * sizeof P[0][0]);
    for (int k = 0; k < 6; k++) {
        double *x = row[count], size = 0, left = 0;
        for (int i = 0; i < 12 && (of->given >> k & 1); i++) {
            x[i] = of->B[k][i];
            size += x[i] * x[i];
        }
        for (int l = 0; l < 2 * count && size > 0; l++) {
            const double *y = row[l % count];
            double along = 0;
            for (int i = 0; i < 12; i++) {
                along += x[i] * y[i];
            }
            for (int i = 0; i < 12; i++) {
                x[i] -= along * y[i];
            }
        }
        for (int i = 0; i < 12 && size > 0; i++) {
            left += x[i] * x[i];
        }
        for (int i = 0; i < 12 && left > 1e-18 * size; i++) {
            x[i] /= sqrt(left);
        }
        count += left > 1e-18 * size;
    }
    for (int i = 0; i < 144 * count; i++) {
        P[i / 12 % 12][i % 12] += row[i / 144][i / 12 % 12] * row[i / 144][i % 12];
    }
}

/* The joint's axes rotate with b. If b rotates otherwise than the frame, the joint must be isotropic about the axis. */
SPARI_APART static int check_around(const spari_small_motions *w, const spar_joint *j, const motion_side side[2],
                                    motion_joint *of) {
    double s[3], P[12][12], size[3] = {0}, most = spari_norm(w->w);
    for (int k = 0; k < 3; k++) {
        double b = side[1].part   ? side[1].part->own[k]
                   : j->member[1] ? j->member[1]->after.v[6 * j->seat[1] + 3 + k]
                                  : 0;
        s[k] = b - w->w[k];
    }
    if (!(spari_norm(s) > 1e-4 * most) || !(spari_norm(s) > 0)) {
        return SPAR_OK;
    }
    constrained_directions(of, P);
    double rotation = spari_norm(s), of_K = change_by_rotation(of->bound, s, size),
           of_C = change_by_rotation(of->C, s, size + 1);
    double of_P = change_by_rotation(P, s, size + 2);
    const double tolerance = 1e-6;
    int round = of_K <= tolerance * rotation * size[0] && of_C <= tolerance * rotation * size[1] &&
                of_P <= tolerance * rotation * size[2];
    SPARI_REQUIRE(w->session, round, SPAR_ERR_UNSUPPORTED,
                  "joint '%s' is not isotropic about the axis of relative rotation: the small-motion equations depend "
                  "on time and have no eigenvalues; for a periodic state use spar_trial_solve_floquet",
                  j->name);
    return SPAR_OK;
}

/* S_a^T X S_b of two sides, and the constraints */
static void put_joint(spari_small_motions *w, const motion_side side[2], const motion_joint *of, int *constraints) {
    for (int ab = 0; ab < 4; ab++) {
        const motion_side *a = side + ab / 2, *b = side + ab % 2;
        for (int64_t rc = 0; rc < (int64_t)a->count * b->count; rc++) {
            const double *S = a->S[rc / b->count], *T = b->S[rc % b->count];
            spari_pencil_entry e = {a->column[rc / b->count], b->column[rc % b->count], 0, 0, 0};
            for (int i = 0; i < 36; i++) {
                double f = S[i / 6] * T[i % 6];
                e.k += f * of->K[6 * (ab / 2) + i / 6][6 * (ab % 2) + i % 6];
                e.c += f * of->C[6 * (ab / 2) + i / 6][6 * (ab % 2) + i % 6];
            }
            spari_pencil_put(&w->pencil, e);
        }
    }
    for (int n = 0; n < 2; n++) {
        for (int c = 0; c < side[n].count; c++) {
            double *left = w->pencil.left + side[n].column[c], row[6] = {0};
            for (int i = 0; i < 6; i++) {
                w->pencil.scale = fmax(w->pencil.scale, fabs(of->f[6 * n + i]));
                *left -= side[n].S[c][i] * of->f[6 * n + i];
                for (int k = 0; k < 6; k++) {
                    row[k] += side[n].S[c][i] * of->B[k][6 * n + i];
                }
            }
            for (int k = 0, at = *constraints; k < 6; at += of->given >> k & 1, k++) {
                if (of->given >> k & 1) {
                    spari_pencil_add_constraint(&w->pencil, (spari_pencil_constraint){at, side[n].column[c], row[k]});
                }
            }
        }
    }
    for (int k = 0; k < 6; k++) {
        *constraints += of->given >> k & 1;
    }
}

int spari_small_motions_add_joint(spari_small_motions *w, const spar_joint *j, int *constraints) {
    motion_side side[2] = {{.part = spari_small_motions_part(w, j->member[0])},
                           {.part = spari_small_motions_part(w, j->member[1])}};
    if (!side[0].part && !side[1].part) {
        return SPAR_OK;
    }
    motion_joint *of = spari_zalloc(1, sizeof *of);
    SPARI_REQUIRE(w->session, of, SPAR_ERR_MEMORY, "joint '%s': no memory for eigenvalues", j->name);
    for (int n = 0; n < 2; n++) {
        if (side[n].part) {
            find_columns(w, j, n, side + n);
        }
    }
    linearise_joint(w, j, side, of);
    int status = w->loose || w->modes ? SPAR_OK : check_around(w, j, side, of);
    if (status == SPAR_OK) {
        put_joint(w, side, of, constraints);
    }
    free(of);
    return status;
}
