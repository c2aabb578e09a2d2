/* What is seen from a driven root. */
#include "root.h"

#include "../math/rotation.h"
#include "alpha_nodes.h"
#include "drive.h"

#include <string.h>

static void look_at_nodes(void *context, int64_t from, int64_t to) {
    spari_nodes_look(context, from, to);
}

void spari_root_look_from(const spari_solver *solver, const spar_member *m, const spari_pose *root,
                          const spari_state *s, spari_state *own) {
    double omega[3], alpha[3];
    spari_root_view t = {solver->body->lanes, m, root, NULL, omega, alpha, own, s};
    spari_rotate_back(root->q + 3, root->v + 3, omega);
    spari_rotate_back(root->q + 3, root->a + 3, alpha);
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

/* All but the root. */
static void lose_of_nodes(void *context, int64_t from, int64_t to) {
    spari_nodes_lose(context, from > 0 ? from : 1, to);
}

/* Where the root jumps the nodes keep place and velocity: seen from it they lose the jump. */
static void lose_jump(const spari_solver *solver, const spar_member *m, double h, const spari_pose *from,
                      const spari_pose *to, const spari_state *own) {
    spari_root_jump t = {.lanes = solver->body->lanes, .member = m, .own = own};
    double less[3];
    spari_drive_jump(from, to, h, t.velocity, t.place);
    for (int k = 0; k < 3; k++) {
        less[k] = -t.place[3 + k];
    }
    spari_quat_exp(less, t.back);
    spari_solver_spread(solver, lose_of_nodes, &t);
}

spari_ends spari_root_ends(const spari_solver *s, const spar_member *m, const spari_scheme *c, const spari_pose *root,
                           double ratio, spari_state *from, spari_state *to) {
    spari_ends e = {*from, *to, *to, NULL, 0};
    if (s->own[0].q && !c->still) {
        const spari_pose before = spari_pose_of(from->q, from->v, from->a);
        double turn[4], psi[3], way[3];
        spari_quat_between(before.q + 3, root->q + 3, turn);
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
