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

void spari_root_mean(const spari_solver *s, const double *of, int step, double mean[3]) {
    mean[0] = mean[1] = mean[2] = 0;
    for (int64_t i = 0; i < s->n; i++) {
        for (int k = 0; k < 3; k++) {
            mean[k] += s->share[i] * of[step * i + k];
        }
    }
}

/* With the mean y of the nodes, x = y + R (x' - y): the origin is y - R y. */
void spari_root_follow(const spari_solver *s, const spar_member *m, const spari_state *of, spari_pose *p) {
    const double *w = p->v + 3;
    double y[3], v[3], a[3], Ry[3], Rv[3], Ra[3], spin[3], inward[3], twice[3];
    spari_root_mean(s, of->q, 7, y);
    spari_root_mean(s, of->v, 6, v);
    spari_root_mean(s, of->a, 6, a);
    for (int i = 0; i < s->n; i++) {
        double arm[3];
        spari_member_arm(m, i, arm);
        for (int k = 0; k < 3; k++) {
            y[k] += s->share[i] * arm[k];
        }
    }
    spari_rotate(p->q + 3, y, Ry);
    spari_rotate(p->q + 3, v, Rv);
    spari_rotate(p->q + 3, a, Ra);
    spari_cross(w, Ry, spin);
    spari_cross(w, spin, inward);
    spari_cross(w, Rv, twice);
    for (int k = 0; k < 3; k++) {
        p->q[k] = y[k] - Ry[k];
        p->v[k] = v[k] - Rv[k] - spin[k];
        p->a[k] = a[k] - Ra[k] - 2 * twice[k] - inward[k];
    }
}

static void show_nodes(void *context, int64_t from, int64_t to) {
    spari_nodes_show(context, from, to);
}

void spari_root_show(const spari_solver *solver, const spar_member *m, spari_ends *e) {
    double R[9], omega[3], alpha[3];
    if (e->centre) {
        spari_centre_show(e->centre, e->origin, &e->to, &e->absolute);
    }
    if (!e->root) {
        return;
    }
    if (e->follows) {
        spari_root_follow(solver, m, &e->to, e->follows);
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
