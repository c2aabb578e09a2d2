/* The motion of the nodes relative to a driven root: see relative_to_root.h. */
#include "relative_to_root.h"

#include "../math/rotation.h"
#include "driven_root.h"
#include "node_kinematics.h"

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
    spari_root_view t = {solver->body->lanes, m, e->root, R, omega, alpha, &e->to, &e->absolute};
    spari_quat_matrix(e->root->q + 3, R);
    spari_matrix_times_back(R, e->root->v + 3, omega);
    spari_matrix_times_back(R, e->root->a + 3, alpha);
    spari_solver_spread(solver, show_nodes, &t);
}

/* All but the root. */
static void lose_of_nodes(void *context, int64_t from, int64_t to) {
    spari_nodes_lose(context, from > 0 ? from : 1, to);
}

void spari_root_subtract_jump(const spari_solver *solver, const spar_member *m, double h, const spari_pose *from,
                              const spari_pose *to, const spari_state *own) {
    spari_root_jump t = {.lanes = solver->body->lanes, .member = m, .own = own};
    double less[3];
    spari_drive_jump(from, to, h, t.velocity, t.position);
    for (int k = 0; k < 3; k++) {
        less[k] = -t.position[3 + k];
    }
    spari_quat_exp(less, t.back);
    spari_solver_spread(solver, lose_of_nodes, &t);
}

double spari_root_motion(const spari_pose *from, const spari_pose *to, double length) {
    double rotation[4], psi[3], way[3];
    spari_quat_between(from->q + 3, to->q + 3, rotation);
    spari_quat_log(rotation, psi);
    for (int k = 0; k < 3; k++) {
        way[k] = to->q[k] - from->q[k];
    }
    return spari_norm(way) / length + spari_norm(psi);
}
