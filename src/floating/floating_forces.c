/* Forces of a floating frame, and their tangent: see floating_root.h. */
#include "../algebra/cblas.h"
#include "../math/rotation.h"
#include "../member/added_mass.h"
#include "../member/applied.h"
#include "floating_root.h"

#include <math.h>
#include <string.h>

enum { ROTATION_PARTS = 1, GYRO_PARTS = 7, EULER_PARTS = 10, ALL_PARTS = 13 };

/* ---- loads ---- */

/* Whether the forces are those of a step. At an equilibrium, and before the first step, the added mass does not
   count. */
static int steps_on(const spari_frame *f) {
    return !f->floating_root->still && !f->floating_root->steady && f->steps.started;
}

int spari_carriage_is_linear(const spari_frame *f, const spar_member *m) {
    return !m->load.applied && !(m->added && steps_on(f));
}

/* Stores the latest iterate, for loads that depend on it. */
static void look_at_iterate(spari_frame *f, const spari_frame_state *s) {
    spari_floating_root *c = f->floating_root;
    const double *x = spari_frame_nodal(f, s->y, c->x);
    c->speeds = s->v, c->rates = s->a;
    if (x != c->x) {
        memcpy(c->x, x, (size_t)(6 * f->nodes) * sizeof *x);
    }
}

/* Nodal loads in global axes: follower loads at the present nodes, and the forces of the fluid's added mass on the
   accelerations of the nodes if the root moves as `root`. */
static void gather_loads_of(spari_frame *f, const spar_member *m, const spari_pose *root) {
    spari_floating_root *c = f->floating_root;
    int n = f->nodes, n6 = 6 * n, guessed = m->added && steps_on(f);
    double *q = f->turned, *v = q + 7 * n, *a = v + n6;
    memset(c->loads, 0, (size_t)n6 * sizeof *c->loads);
    if (m->load.applied || guessed) {
        const double *xd = spari_frame_nodal(f, c->speeds, f->nodal),
                     *xdd = spari_frame_nodal(f, c->rates, f->nodal + n6);
        for (int i = 0; i < n; i++) {
            spari_frame_node(m, root, i, c->x + 6 * i, xd + 6 * i, xdd + 6 * i, q + 7 * i, v + 6 * i, a + 6 * i);
        }
    }
    if (m->load.applied) {
        spari_applied_residual(m, q, c->factor, c->loads);
    }
    if (guessed) {
        (void)spari_added_times(m, SPARI_UNKNOWNS, SPARI_UNKNOWNS, a, 1, c->loads);
    }
    for (int i = 0; i < n6; i++) {
        c->loads[i] = c->factor * f->steps.load[i] - c->loads[i];
    }
}

/* out += M R (a - g, alpha) - loads, on the unknowns, in the axes of the frame. Also in these axes: rate: acceleration
   less gravity, and angular acceleration, of the frame. load [6 nodes]: the loads. */
static void add_weight_and_loads(spari_frame *f, const spar_member *m, const spari_pose *root, double rate[6],
                                 double *load, double *out) {
    const spari_floating_root *c = f->floating_root;
    for (int k = 0; k < 6; k++) {
        rate[k] = (c->still ? 0 : root->a[k]) - (k < 3 ? c->factor * m->body->gravity[k] : 0);
    }
    spari_rotate_back(root->q + 3, rate, rate);
    spari_rotate_back(root->q + 3, rate + 3, rate + 3);
    for (int i = 0; i < 6 * f->nodes; i += 3) {
        spari_rotate_back(root->q + 3, c->loads + i, load + i);
    }
    spari_frame_gather(f, load, f->dx);
    cblas_daxpy(f->n, -1, f->dx, 1, out, 1);
    for (int k = 0; k < 6 && f->rigid[0]; k++) {
        if (rate[k] != 0) {
            cblas_daxpy(f->n, rate[k], f->rigid[k], 1, out, 1);
        }
    }
}

/* ---- forces where the motion of the root is prescribed ---- */

static double largest_force(int n, const double *x) {
    double most = 0;
    for (int i = 0; i < n; i++) {
        double size = fabs(x[i]);
        most = size > most ? size : most;
    }
    return most;
}

/* Forces from one sum of the matrices for the rotation rates of the root. */
static double forces_of_prescribed(spari_frame *f, const spar_member *m, const spari_frame_state *s, double *r) {
    spari_floating_root *c = f->floating_root;
    double rate[6], turn[6] = {0};
    const size_t size = (size_t)f->n * sizeof *r;
    spari_rotate_back(s->root.q + 3, s->root.v + 3, turn);
    if (!c->still) {
        spari_rotate_back(s->root.q + 3, s->root.a + 3, turn + 3);
    }
    spari_frame_combine(f, turn);
    if (!spari_carriage_is_linear(f, m)) {
        look_at_iterate(f, s);
    }
    gather_loads_of(f, m, &s->root);
    if (f->sumf) {
        memcpy(r, f->sumf, size);
    } else {
        memset(r, 0, size);
    }
    add_weight_and_loads(f, m, &s->root, rate, f->turned, r);
    cblas_daxpy(f->pull ? f->n : 0, c->factor, f->pull, 1, r, 1);
    memset(c->elastic, 0, size);
    spari_frame_add_times(f, f->sumK ? f->sumK : f->K, s->y, 1, c->elastic);
    double scale = fmax(largest_force(f->n, r), largest_force(f->n, c->elastic));
    cblas_daxpy(f->n, 1, c->elastic, 1, r, 1);
    if (f->sumC) {
        spari_frame_add_times(f, f->sumC, s->v, 1, r);
    }
    if (f->M && !c->still) {
        spari_frame_add_times(f, f->M, s->a, 1, r);
    }
    memset(r, 0, (size_t)f->constrained * sizeof *r);
    return scale;
}

/* ---- forces where joints move the root ---- */

/* parts[k] := X y */
static void product_into(spari_frame *f, int k, const double *X, const double *y) {
    double *to = f->floating_root->parts + (int64_t)k * f->n;
    memset(to, 0, (size_t)f->n * sizeof *to);
    if (X) {
        spari_frame_add_times(f, X, y, 1, to);
    }
}

/* c->stiff := K + S(w, w), constant in the substep. */
static void combine_stretch(spari_frame *f) {
    spari_floating_root *c = f->floating_root;
    memcpy(c->stiff, f->K, (size_t)f->size * sizeof *c->stiff);
    for (int k = 0; k < SPARI_SPIN_PRODUCTS; k++) {
        double by = c->turns[spari_frame_pair[k][0]] * c->turns[spari_frame_pair[k][1]];
        if (by != 0) {
            cblas_daxpy((int)f->size, by, f->S[k], 1, c->stiff, 1);
        }
    }
}

void spari_floating_root_rotate(spari_frame *f, const spari_frame_state *s, double h) {
    spari_floating_root *c = f->floating_root;
    double alpha[3];
    if (!f->S[0]) {
        return;
    }
    spari_rotate_back(s->root.q + 3, s->root.v + 3, c->turns);
    spari_rotate_back(s->root.q + 3, s->root.a + 3, alpha);
    for (int k = 0; k < 3; k++) {
        const double *mean = c->mean + (int64_t)k * f->n + 6;
        c->turns[k] +=
            cblas_ddot(f->n - 6, mean, 1, s->v + 6, 1) + h * (alpha[k] + cblas_ddot(f->n - 6, mean, 1, s->a + 6, 1));
    }
    combine_stretch(f);
}

/* E_k y into the parts, and its products with the rates. */
static void gather_euler(spari_frame *f, int k, const spari_frame_state *s) {
    spari_floating_root *c = f->floating_root;
    const double *part = c->parts + (int64_t)(EULER_PARTS + k) * f->n + 6;
    product_into(f, EULER_PARTS + k, f->E[k], s->v);
    c->seconds.vEv[k] = cblas_ddot(f->n - 6, s->v + 6, 1, part, 1);
    product_into(f, EULER_PARTS + k, f->E[k], s->y);
    c->seconds.vEy[k] = cblas_ddot(f->n - 6, s->v + 6, 1, part, 1);
    c->seconds.aEy[k] = cblas_ddot(f->n - 6, s->a + 6, 1, part, 1);
}

/* The terms that do not depend on the motion of the root. */
static void gather_parts_of(spari_frame *f, const spari_frame_state *s) {
    spari_floating_root *c = f->floating_root;
    product_into(f, 0, c->still ? NULL : f->M, s->a);
    memset(&c->seconds, 0, sizeof c->seconds);
    for (int k = 0; k < SPARI_SPIN_PRODUCTS && !c->still; k++) {
        const double *part = c->parts + (int64_t)(ROTATION_PARTS + k) * f->n + 6;
        product_into(f, ROTATION_PARTS + k, f->N[k], s->y);
        c->seconds.yNy[k] = cblas_ddot(f->n - 6, s->y + 6, 1, part, 1);
        c->seconds.vNy[k] = cblas_ddot(f->n - 6, s->v + 6, 1, part, 1);
        if (f->f[k]) {
            cblas_daxpy(f->n, 1, f->f[k], 1, c->parts + (int64_t)(ROTATION_PARTS + k) * f->n, 1);
        }
    }
    for (int k = 0; k < 3 && !c->still; k++) {
        product_into(f, GYRO_PARTS + k, f->G[k], s->v);
        gather_euler(f, k, s);
    }
    const int stretched = f->S[0] && !c->still;
    memset(c->elastic, 0, (size_t)f->n * sizeof *c->elastic);
    spari_frame_add_times(f, stretched ? c->stiff : f->K, s->y, 1, c->elastic);
    cblas_daxpy(f->pull ? f->n : 0, c->factor, f->pull, 1, c->elastic, 1);
    if (f->D) {
        spari_frame_add_times(f, f->D, s->v, 1, c->elastic);
    }
    look_at_iterate(f, s);
}

/* out += forces of the frame's rotation */
static void add_rotation_forces(const spari_frame *f, const spari_pose *root, double *out) {
    const double *parts = f->floating_root->parts;
    double omega[3], alpha[3], c[SPARI_SPIN_PRODUCTS], less[ALL_PARTS - ROTATION_PARTS];
    int n = f->n;
    spari_rotate_back(root->q + 3, root->v + 3, omega);
    spari_rotate_back(root->q + 3, root->a + 3, alpha);
    for (int k = 0; k < SPARI_SPIN_PRODUCTS; k++) {
        c[k] = omega[spari_frame_pair[k][0]] * omega[spari_frame_pair[k][1]];
        less[k] = -c[k];
    }
    for (int k = 0; k < 3; k++) {
        less[GYRO_PARTS - ROTATION_PARTS + k] = -omega[k];
        less[EULER_PARTS - ROTATION_PARTS + k] = -alpha[k];
    }
    spari_linear_less_columns(n, ALL_PARTS - ROTATION_PARTS, parts + (int64_t)ROTATION_PARTS * n, less, out);
}

/* heavy := M R (a - g, alpha) - loads of the nodes, in the axes of the frame; out += the same of the unknowns */
static void add_heavy(spari_frame *f, const spar_member *m, const spari_pose *root, double *out) {
    spari_floating_root *c = f->floating_root;
    int n6 = 6 * f->nodes;
    double rate[6], omega[3], *load = f->turned;
    add_weight_and_loads(f, m, root, rate, load, out);
    for (int i = 0; i < n6; i++) {
        c->heavy[i] = -load[i];
    }
    spari_rotate_back(root->q + 3, root->v + 3, omega);
    for (int k = 0; k < SPARI_SPIN_PRODUCTS && f->S[0] && !c->still;
         k++) { /* on the unknowns it is among the parts already */
        cblas_daxpy(n6, omega[spari_frame_pair[k][0]] * omega[spari_frame_pair[k][1]], c->spin[k], 1, c->heavy, 1);
    }
    for (int k = 0; k < 6 && f->rigid[0]; k++) {
        cblas_daxpy(n6, rate[k], c->push[k], 1, c->heavy, 1);
    }
}

/* Puts the resultant force and moment about the root into the first six of out, with lever arms of the deformed member.
   Adds the elastic forces, which have no resultant, to the others. */
static void gather_whole(const spari_frame *f, const spar_member *m, double *out) {
    const spari_floating_root *c = f->floating_root;
    double sum[6] = {0};
    for (int i = 0; i < f->nodes; i++) {
        double arm[3], turn[3];
        const double *r = out + 6 * i;
        if (!f->basis) {
            spari_member_arm(m, i, arm);
            spari_cross(arm, r, turn);
            for (int k = 0; k < 3; k++) {
                sum[k] += r[k];
                sum[3 + k] += r[3 + k] + turn[k];
            }
        }
        spari_cross(c->x + 6 * i, c->heavy + 6 * i, turn);
        for (int k = 0; k < 3; k++) {
            sum[3 + k] += turn[k];
        }
    }
    for (int k = 0; k < 6; k++) {
        out[k] = sum[k] + (f->basis ? out[k] : 0);
    }
    for (int i = 6; i < f->n; i++) {
        out[i] += c->elastic[i];
    }
}

/* Subtracts m x theta / 2 from the resultant moment: N and E contain it for the unknowns, but the resultant has the
   moments themselves. */
static void take_half_moments_off(const spari_frame *f, const spari_pose *root, double moment[3]) {
    const spari_floating_root *c = f->floating_root;
    double omega[3], alpha[3], by[SPARI_SPIN_PRODUCTS];
    spari_rotate_back(root->q + 3, root->v + 3, omega);
    spari_rotate_back(root->q + 3, root->a + 3, alpha);
    for (int t = 0; t < SPARI_SPIN_PRODUCTS; t++) {
        by[t] = omega[spari_frame_pair[t][0]] * omega[spari_frame_pair[t][1]];
    }
    for (int i = 3; i < 6 * f->nodes; i += 6) {
        double m[3], turn[3];
        for (int k = 0; k < 3; k++) {
            m[k] = alpha[0] * c->push[3][i + k] + alpha[1] * c->push[4][i + k] + alpha[2] * c->push[5][i + k];
            for (int t = 0; t < SPARI_SPIN_PRODUCTS; t++) {
                m[k] += by[t] * c->spin[t][i + k];
            }
        }
        spari_cross(m, c->x + i, turn);
        for (int k = 0; k < 3; k++) {
            moment[k] -= 0.5 * turn[k];
        }
    }
}

/* Adds the moment of second order in the deformation that belongs to N and E. The Lagrangian has the terms
   omega_k y' . E_k y - y . N(omega, omega) y / 2; the angular momentum is its derivative by omega. */
static void add_seconds(const spari_frame *f, const spari_pose *root, double moment[3]) {
    const spari_seconds *s = &f->floating_root->seconds;
    double omega[3], alpha[3], p[3], turn[3];
    spari_rotate_back(root->q + 3, root->v + 3, omega);
    spari_rotate_back(root->q + 3, root->a + 3, alpha);
    memcpy(p, s->vEy, sizeof p);
    for (int k = 0; k < 3; k++) {
        moment[k] += s->aEy[k] + s->vEv[k];
    }
    for (int t = 0; t < SPARI_SPIN_PRODUCTS; t++) {
        int i = spari_frame_pair[t][0], j = spari_frame_pair[t][1];
        p[i] -= 0.5 * omega[j] * s->yNy[t];
        p[j] -= 0.5 * omega[i] * s->yNy[t];
        moment[i] -= 0.5 * alpha[j] * s->yNy[t] + omega[j] * s->vNy[t];
        moment[j] -= 0.5 * alpha[i] * s->yNy[t] + omega[i] * s->vNy[t];
    }
    spari_cross(omega, p, turn);
    for (int k = 0; k < 3; k++) {
        moment[k] += turn[k];
    }
}

/* The forces if the root moves as `root`; all other terms are gathered. */
static void forces_at(spari_frame *f, const spar_member *m, const spari_pose *root, double *out) {
    memcpy(out, f->floating_root->parts, (size_t)f->n * sizeof *out);
    if (m->added) {
        gather_loads_of(f, m, root);
    }
    if (!f->floating_root->still) {
        add_rotation_forces(f, root, out);
    }
    add_heavy(f, m, root, out);
    gather_whole(f, m, out);
    if (!f->floating_root->still && f->S[0]) {
        add_seconds(f, root, out + 3);
        take_half_moments_off(f, root, out + 3);
    }
}

double spari_floating_root_forces(spari_frame *f, const spar_member *m, const spari_frame_state *s, int still,
                                  double factor, double *r) {
    spari_floating_root *c = f->floating_root;
    double scale = 0;
    c->still = still, c->factor = factor;
    if (!f->floats) {
        return forces_of_prescribed(f, m, s, r);
    }
    gather_parts_of(f, s);
    gather_loads_of(f, m, &s->root);
    forces_at(f, m, &s->root, r);
    for (int i = 0; i < f->n; i++) {
        scale = fmax(scale, fmax(fabs(c->elastic[i]), fabs(c->parts[i])));
    }
    for (int i = 0; i < 6 * f->nodes; i++) {
        scale = fmax(scale, fabs(c->heavy[i]));
    }
    memset(r, 0, (size_t)spari_member_constrained(m) * sizeof *r);
    return scale;
}

/* ---- interface nodes relative to the root ---- */

/* Lever arm d from the root to interface node e (from 1), and the inverse tangent operator T of its rotation. */
static void look_at_end(const spari_frame *f, const spar_member *m, const double *y, int e, double d[3], double T[9]) {
    const double *x = y + spari_floating_root_at(f, e);
    spari_member_arm(m, f->floating_root->node[e - 1], d);
    for (int k = 0; k < 3; k++) {
        d[k] += x[k];
    }
    spari_tangent_inverse(x + 3, T);
}

void spari_floating_root_relative(const spari_frame *f, const spar_member *m, const double *y, double *x) {
    for (int e = 1; e <= f->floating_root->ends; e++) {
        double d[3], T[9], turn[3], less[3], *z = x + 6 * e;
        look_at_end(f, m, y, e, d, T);
        spari_cross(x + 3, d, turn);
        for (int k = 0; k < 3; k++) {
            z[k] -= x[k] + turn[k];
            less[k] = z[3 + k] - x[3 + k];
        }
        for (int k = 0; k < 3; k++) {
            z[3 + k] = T[3 * k] * less[0] + T[3 * k + 1] * less[1] + T[3 * k + 2] * less[2];
        }
    }
}

void spari_floating_root_absolute(const spari_frame *f, const spar_member *m, const double *y, double *x) {
    for (int e = 1; e <= f->floating_root->ends; e++) {
        double d[3], T[9], turn[3], *F = x + 6 * e, M[3] = {F[3], F[4], F[5]};
        look_at_end(f, m, y, e, d, T);
        spari_cross(d, F, turn);
        for (int k = 0; k < 3; k++) {
            F[3 + k] = T[k] * M[0] + T[3 + k] * M[1] + T[6 + k] * M[2];
            x[k] -= F[k];
            x[3 + k] -= F[3 + k] + turn[k];
        }
    }
}

/* ---- the tangent ---- */

/* The root displaced by `by` along k, in the axes of the frame, with the corresponding change of its rates. */
static spari_pose moved_root(const spari_floating_root *c, const spari_pose *root, int k, double by, double cm,
                             double cv, const double tinv[9]) {
    spari_pose p = *root;
    double unit[3] = {0}, axis[3], x[3], turn[4];
    unit[k % 3] = by;
    spari_rotate(root->q + 3, unit, axis);
    if (k < 3) {
        if (c->steady) {
            spari_cross(c->steady_rotation, axis, x);
            spari_cross(c->steady_rotation, x, x);
        }
        for (int i = 0; i < 3; i++) {
            p.a[i] += cm * axis[i] + (c->steady ? x[i] : 0);
        }
        return p;
    }
    for (int i = 0; i < 3; i++) {
        x[i] = tinv[3 * i] * axis[0] + tinv[3 * i + 1] * axis[1] + tinv[3 * i + 2] * axis[2];
        p.v[3 + i] += cv * x[i];
        p.a[3 + i] += cm * x[i];
    }
    spari_quat_exp(axis, turn);
    spari_quat_mul(turn, root->q + 3, p.q + 3);
    return p;
}

/* Columns of the root, by central differences. The forces are linear in its accelerations and of low order in its
   other rates and its rotation. */
static void form_columns(spari_frame *f, const spar_member *m, const spari_pose *root, double cm, double cv,
                         const double tinv[9]) {
    spari_floating_root *c = f->floating_root;
    double fastest = fmax(1, fmax(cv, sqrt(cm)));
    for (int k = 0; k < 6; k++) {
        double *column = c->border + (int64_t)(6 + k) * f->n, by = (k < 3 ? m->body->length : 1) * 1e-5 / fastest;
        for (int side = 0; side < 2; side++) {
            const spari_pose p = moved_root(c, root, k, side ? -by : by, cm, cv, tinv);
            forces_at(f, m, &p, c->out + (int64_t)side * f->n);
        }
        for (int i = 0; i < f->n; i++) {
            column[i] = (c->out[i] - c->out[f->n + i]) / (2 * by);
        }
    }
    forces_at(f, m, root, c->out); /* leaves `heavy` for the present root */
}

/* Adds to the rows of the resultants: rigid motions times the tangent S of element e. */
static void add_rows(const spari_frame *f, const spar_member *m, int e, const double *S) {
    double *rows = f->floating_root->border;
    int first = e * (f->block - f->overlap);
    for (int i = 0; i < f->block && (!f->basis || i < 6); i++) {
        double arm[3], weight[6] = {0};
        weight[f->basis ? i : (first + i) % 6] = 1;
        if (!f->basis && i % 6 < 3) { /* moment of the force about the root */
            double unit[3] = {weight[0], weight[1], weight[2]};
            spari_member_arm(m, (first + i) / 6, arm);
            spari_cross(arm, unit, weight + 3);
        }
        for (int k = 0; k < 6; k++) {
            if (weight[k] != 0) {
                cblas_daxpy(f->block, weight[k], S + (int64_t)f->block * i, 1, rows + (int64_t)k * f->n + first, 1);
            }
        }
    }
}

/* Adds to these rows the change of the lever arms: dx x heavy. */
static void add_arms_to_rows(const spari_frame *f) {
    const spari_floating_root *c = f->floating_root;
    for (int i = 0; i < f->nodes; i++) {
        double W[9];
        spari_skew(c->heavy + 6 * i, W);
        for (int k = 0; k < 9; k++) {
            double *row = c->border + (int64_t)(3 + k / 3) * f->n;
            if (f->basis) {
                cblas_daxpy(f->n, -W[k], f->basis + (int64_t)(6 * i + k % 3) * f->n, 1, row, 1);
            } else {
                row[6 * i + k % 3] -= W[k];
            }
        }
    }
}

/* The tangent of element e, from the sums that exist. */
static void form_element(spari_frame *f, int e, double cm, double cv) {
    const int64_t mm = (int64_t)f->block * f->block, at = mm * e;
    const double *K = (f->sumK ? f->sumK : f->K) + at, *C = f->sumC ? f->sumC + at : NULL, *M = f->M ? f->M + at : NULL,
                 *A = f->A && steps_on(f) ? f->A + at : NULL;
    double *S = f->element;
    for (int64_t i = 0; i < mm; i++) {
        S[i] = K[i] + (C ? cv * C[i] : 0) + (M ? cm * M[i] : 0) + (A ? cm * A[i] : 0);
    }
}

/* Adds y x M y'' to the rows of the resultants. */
static void add_euler_to_rows(const spari_frame *f, double cm) {
    const spari_floating_root *c = f->floating_root;
    int m = f->block, step = f->block - f->overlap;
    for (int k = 0; k < 3 && f->S[0] && !c->still; k++) {
        double *row = c->border + (int64_t)(3 + k) * f->n;
        for (int e = 0; e < f->elements; e++) {
            SPARI_BLAS(cblas_dgemv(CblasRowMajor, CblasTrans, m, m, 1, f->E[k] + (int64_t)m * m * e, m,
                                   c->rates + (int64_t)e * step, 1, 1, row + (int64_t)e * step, 1));
        }
        cblas_daxpy(f->n - 6, cm, c->parts + (int64_t)(EULER_PARTS + k) * f->n + 6, 1, row + 6, 1);
    }
}

/* Puts the tangent of the unknowns into the linear system, and forms the rows of the resultants. */
static void form_chain(spari_frame *f, const spar_member *m, const spari_pose *root, double cm, double cv) {
    spari_floating_root *c = f->floating_root;
    int64_t mm = (int64_t)f->block * f->block;
    double alpha[3], turn[6] = {0};
    spari_rotate_back(root->q + 3, root->a + 3, alpha);
    if (!c->still) {
        spari_rotate_back(root->q + 3, root->v + 3, turn);
    }
    spari_frame_combine(f, turn); /* the acceleration enters element by element */
    spari_linear_zero(f->linear);
    memset(c->border, 0, (size_t)(6 * f->n) * sizeof *c->border);
    for (int e = 0; e < f->elements; e++) {
        form_element(f, e, cm, cv);
        for (int k = 0; k < 3 && f->E[0] && !c->still; k++) { /* internal forces of the stretch are added separately */
            cblas_daxpy((int)mm, alpha[k], f->E[k] + mm * e, 1, f->element, 1);
        }
        /* rigid motions strain the stiffness of pretension: the resultants contain it through the lever arms */
        cblas_daxpy(f->pull ? (int)mm : 0, -1, f->K + mm * e, 1, f->element, 1);
        add_rows(f, m, e, f->element);
        cblas_daxpy(f->pull ? (int)mm : 0, 1, f->K + mm * e, 1, f->element, 1);
        for (int64_t i = 0; i < mm && f->S[0] && !c->still; i++) {
            f->element[i] += c->stiff[mm * e + i] - f->K[mm * e + i];
        }
        spari_linear_add(f->linear, e, f->element);
    }
    add_euler_to_rows(f, cm);
    add_arms_to_rows(f);
}

/* Inserts the rows and columns of the root, which the chain does not have. */
static void put_border(spari_frame *f, const spar_member *m) {
    const spari_floating_root *c = f->floating_root;
    spari_condensed *d = c->condensed;
    int M = 6 * d->ends, n = f->n;
    for (int j = spari_member_constrained(m); j < 6; j++) {
        double *row = d->rows + (int64_t)n * j, *column = d->W + (int64_t)n * j;
        memcpy(row, c->border + (int64_t)n * j, (size_t)n * sizeof *row);
        memcpy(column, c->border + (int64_t)n * (6 + j), (size_t)n * sizeof *row);
        for (int k = spari_member_constrained(m); k < M; k++) {
            int u = 6 * d->node[k / 6] + k % 6;
            d->K[M * j + k] = k < 6 ? column[u] : row[u]; /* root with root: from the differences, below */
            if (k >= 6) {
                d->K[M * k + j] = column[u];
            }
        }
        for (int k = 0; k < M; k++) {
            row[6 * d->node[k / 6] + k % 6] = column[6 * d->node[k / 6] + k % 6] = 0;
        }
    }
    for (int j = spari_member_constrained(m); j < 6; j++) {
        for (int k = spari_member_constrained(m); k < 6; k++) {
            d->K[M * j + k] = c->border[(int64_t)n * (6 + k) + j];
        }
    }
}

/* Transforms the condensed matrix from motions relative to the root to absolute ones: K := T^T K T, plus the terms of
   the rotation of the forces r at the interface nodes. */
static void take_ends_out(spari_frame *f, const spar_member *m, const spari_frame_state *s, const double *r,
                          double *workspace) {
    const spari_floating_root *c = f->floating_root;
    spari_condensed *d = c->condensed;
    int M = 6 * d->ends, constrained = spari_member_constrained(m);
    double *K = workspace, *z = K + (int64_t)M * M, *g = z + M, *force = g + M;
    for (int k = 0; k < M; k++) {
        force[k] = r[6 * d->node[k / 6] + k % 6];
    }
    spari_floating_root_absolute(f, m, s->y, force);
    memset(K, 0, (size_t)(M * M) * sizeof *K);
    for (int j = constrained; j < M; j++) {
        memset(z, 0, (size_t)M * sizeof *z);
        z[j] = 1;
        spari_floating_root_relative(f, m, s->y, z);
        cblas_dgemv(CblasRowMajor, CblasNoTrans, M, M, 1, d->K, M, z, 1, 0, g, 1);
        memset(g, 0, (size_t)constrained * sizeof *g);
        spari_floating_root_absolute(f, m, s->y, g);
        for (int e = 1; e < d->ends; e++) { /* the lever arm of its force changes */
            double turn[3];
            spari_cross(z + 6 * e, force + 6 * e, turn);
            for (int k = 0; k < 3; k++) {
                g[3 + k] -= turn[k];
            }
        }
        for (int k = 0; k < M && j >= 3 && j < 6; k += 3) { /* the forces rotate with the frame */
            double unit[3] = {j == 3, j == 4, j == 5}, turn[3];
            spari_cross(unit, force + k, turn);
            for (int i = 0; i < 3; i++) {
                g[k + i] += turn[i];
            }
        }
        for (int k = constrained; k < M; k++) {
            K[M * k + j] = g[k];
        }
    }
    for (int j = 0; j < constrained; j++) {
        K[(M + 1) * j] = 1;
    }
    memcpy(d->K, K, (size_t)(M * M) * sizeof *K);
}

/* Rotates K [M][M], in blocks of three, into global axes. */
static void rotate_ends(const double q[4], int M, double *K) {
    for (int side = 0; side < 2; side++) {
        for (int i = 0; i < M; i++) {
            for (int j = 0; j < M; j += 3) {
                double x[3];
                for (int k = 0; k < 3; k++) {
                    x[k] = side ? K[M * (j + k) + i] : K[M * i + j + k];
                }
                spari_rotate(q, x, x);
                for (int k = 0; k < 3; k++) {
                    *(side ? &K[M * (j + k) + i] : &K[M * i + j + k]) = x[k];
                }
            }
        }
    }
}

int spari_floating_root_tangent(spari_frame *f, const spar_member *m, const spari_frame_state *s, double cm, double cv,
                                const double tinv[9], const double *r) {
    spari_floating_root *c = f->floating_root;
    spari_condensed *d = c->condensed;
    spari_frame_keep_factors(f);
    f->factored = 0;
    if (f->floats) {
        form_columns(f, m, &s->root, cm, cv, tinv);
        form_chain(f, m, &s->root, cm, cv);
    } else {
        spari_linear_zero(f->linear);
        for (int e = 0; e < f->elements; e++) {
            form_element(f, e, cm, cv);
            spari_linear_add(f->linear, e, f->element);
        }
    }
    for (int i = 0; i < f->constrained; i++) {
        spari_linear_fix(f->linear, i);
    }
    spari_condensed_take(d, f->linear, spari_member_constrained(m));
    if (f->floats) {
        put_border(f, m);
    }
    f->factors++;
    if (spari_linear_factor(f->linear) || spari_condensed_form(d, f->linear)) {
        return 1;
    }
    if (d->ends > 0) {
        take_ends_out(f, m, s, r, c->workspace);
        rotate_ends(s->root.q + 3, 6 * d->ends, d->K);
    }
    f->factored = 1;
    f->tangent_cm = cm, f->tangent_cv = cv;
    memcpy(f->tangent_turn, f->turn, sizeof f->tangent_turn);
    memcpy(c->root->tangent_q, s->root.q + 3, 4 * sizeof(double));
    return 0;
}
