/* What is seen from a driven root. */
#include "root.h"

#include "../math/rotation.h"
#include "alpha_nodes.h"
#include "drive.h"

#include <string.h>

/* Motion from outside, and as a root sees it, with its rates in its own axes. */
typedef struct root_view {
    const spar_member *m;
    const spari_pose *root;
    const spari_state *s;
    spari_state *own;
    double W[3], A[3], back[4];
} root_view;

static void look_at_nodes(void *context, int64_t from, int64_t to) {
    const root_view *t = context;
    const spari_pose *root = t->root;
    const spari_state *s = t->s, *own = t->own;
    const double *W = t->W, *A = t->A, *back = t->back;
    for (int64_t i = from; i < to; i++) {
        double arm[3], d[3], c1[3], c2[3], c3[3], *v = own->v + 6 * i, *a = own->a + 6 * i, *q = own->q + 7 * i;
        spari_member_arm(t->m, (int)i, arm);
        for (int k = 0; k < 3; k++) {
            d[k] = arm[k] + s->q[7 * i + k] - root->q[k];
        }
        for (int k = 0; k < 6; k++) {
            v[k] = s->v[6 * i + k] - root->v[k];
            a[k] = s->a[6 * i + k] - root->a[k];
        }
        spari_rotate_back(root->q + 3, d, d);
        for (int k = 0; k < 6; k += 3) {
            spari_rotate_back(root->q + 3, v + k, v + k);
            spari_rotate_back(root->q + 3, a + k, a + k);
        }
        spari_quat_mul(back, s->q + 7 * i + 3, q + 3);
        spari_cross(W, d, c1);
        for (int k = 0; k < 3; k++) {
            q[k] = d[k] - arm[k];
            v[k] -= c1[k];
            c1[k] += 2 * v[k];
        }
        spari_cross(W, c1, c2);
        spari_cross(A, d, c3);
        spari_cross(W, v + 3, c1);
        for (int k = 0; k < 3; k++) {
            a[k] -= c2[k] + c3[k];
            a[3 + k] -= c1[k];
        }
    }
    memcpy(own->b + 6 * from, s->b + 6 * from, (size_t)(6 * (to - from)) * sizeof *own->b);
}

void spari_root_look_from(const spari_solver *solver, const spar_member *m, const spari_pose *root,
                          const spari_state *s, spari_state *own) {
    root_view t = {.m = m, .root = root, .s = s, .own = own};
    spari_quat_conj(root->q + 3, t.back);
    spari_rotate_back(root->q + 3, root->v + 3, t.W);
    spari_rotate_back(root->q + 3, root->a + 3, t.A);
    spari_solver_spread(solver, look_at_nodes, &t);
}

static void show_nodes(void *context, int64_t from, int64_t to) {
    spari_nodes_show(context, from, to);
}

void spari_root_show(const spari_solver *solver, const spar_member *m, spari_ends *e) {
    double R[9], omega[3], alpha[3];
    if (!e->root) {
        return;
    }
    spari_root_view t = {solver->body->lanes, m, e->root, R, omega, alpha, &e->to, &e->seen};
    spari_quat_matrix(e->root->q + 3, R);
    spari_matrix_times_back(R, e->root->v + 3, omega);
    spari_matrix_times_back(R, e->root->a + 3, alpha);
    spari_solver_spread(solver, show_nodes, &t);
}

/* Where the root jumps the nodes keep place and velocity: seen from it they lose the jump. */
static void lose_jump(const spari_solver *solver, const spar_member *m, double h, const spari_pose *from,
                      const spari_pose *to, spari_state *own) {
    double J[6], E[6], back[4], less[3];
    spari_drive_jump(from, to, h, J, E);
    for (int k = 0; k < 3; k++) {
        less[k] = -E[3 + k];
    }
    spari_quat_exp(less, back);
    for (int i = 1; i < solver->n; i++) {
        double *q = own->q + 7 * i, *v = own->v + 6 * i, d[3], c1[3], c2[3];
        spari_member_arm(m, i, d);
        for (int k = 0; k < 3; k++) {
            d[k] += q[k];
        }
        spari_cross(J + 3, d, c1);
        spari_cross(E + 3, d, c2);
        for (int k = 0; k < 3; k++) {
            v[k] -= J[k] + c1[k];
            v[3 + k] -= J[3 + k];
            q[k] -= E[k] + c2[k];
        }
        spari_quat_mul(back, q + 3, q + 3);
    }
}

spari_ends spari_root_ends(const spari_solver *s, const spar_member *m, const spari_scheme *c, const spari_pose *root,
                           double ratio, spari_state *from, spari_state *to) {
    spari_ends e = {*from, *to, *to, NULL, 0};
    if (s->own[0].q && !c->still) {
        const spari_pose before = spari_pose_of(from->q, from->v, from->a);
        double turn[4], psi[3], way[3];
        spari_quat_conj(before.q + 3, turn);
        spari_quat_mul(root->q + 3, turn, turn);
        spari_quat_log(turn, psi);
        for (int k = 0; k < 3; k++) {
            way[k] = root->q[k] - before.q[k];
        }
        e.from = s->own[0], e.to = s->own[1], e.root = root;
        e.carried = spari_norm(way) / s->body->length + spari_norm(psi);
        spari_root_look_from(s, m, &before, from, &e.from);
        lose_jump(s, m, c->h, &before, root, &e.from);
    }
    spari_scheme_stretch(ratio, 6 * s->n, e.from.a, e.from.b);
    return e;
}
