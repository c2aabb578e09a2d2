/* Steady rotation of an assembly: see rotation_check.h. */
#include "rotation_check.h"

#include "../base/session.h"
#include "../math/rotation.h"
#include "../member/applied_loads.h"
#include "../time/fidelity.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Motions that differ by less than this, relative to their size, are equal. */
static const double same_motion = 1e-6;

/* A prescribed motion: of a root, of a node, or by a joint. */
typedef struct prescribed_motion {
    const char *kind, *name;
    double x[3], v[6], a[3];
} prescribed_motion;

static prescribed_motion prescribed_by(const spar_member *m, const char *kind, const spari_motion *motion,
                                       int64_t node) {
    prescribed_motion t = {.kind = kind, .name = m->name};
    for (int k = 0; k < 3; k++) {
        t.x[k] = m->xr[3 * node + k] + motion->q[7 * node + k];
    }
    memcpy(t.v, motion->v + 6 * node, sizeof t.v);
    memcpy(t.a, motion->a + 6 * node, sizeof t.a);
    return t;
}

/* Sets the rotation from this motion. Without an acceleration its axis stays. */
static void take_rotation(spari_assembly *a, const prescribed_motion *t) {
    spari_rotating_frame *g = &a->rotating;
    double inward[3];
    memcpy(g->rotation.w, t->v + 3, sizeof g->rotation.w);
    memcpy(g->rotation.v0, t->v, sizeof g->rotation.v0);
    memcpy(g->rotation.a0, t->a, sizeof g->rotation.a0);
    memcpy(g->centre, t->x, sizeof g->centre);
    spari_cross(g->rotation.w, g->rotation.v0, inward);
    if (!(spari_norm(t->a) > 0)) {
        memcpy(g->rotation.a0, inward, sizeof inward);
    }
    a->rotates = 1;
}

/* Whether the motion agrees with the rotation that has been found. */
static int goes_along(const spari_assembly *a, const prescribed_motion *t) {
    double v[6], acceleration[6], difference[3], rotation[3];
    const spari_steady_rotation *g = &a->rotating.rotation;
    spari_rotating_frame_rates(&a->rotating, 1, t->x, v, acceleration);
    for (int k = 0; k < 3; k++) {
        difference[k] = v[k] - t->v[k];
        rotation[k] = v[3 + k] - t->v[3 + k];
    }
    double size = spari_norm(g->v0) + spari_norm(v) + spari_norm(t->v);
    return spari_norm(rotation) <= same_motion * spari_norm(g->w) && spari_norm(difference) <= same_motion * size;
}

static int refuse_rotations(const spari_assembly *a, const prescribed_motion *one, const prescribed_motion *other) {
    return spari_fail(a->session, SPAR_ERR_UNSUPPORTED,
                      "%s '%s' rotates at (%g, %g, %g) rad/s and %s '%s', which is connected to it, at (%g, %g, %g): "
                      "parts in relative rotation have no steady state; for the shape at rest set all rates to 0, "
                      "otherwise run time steps until the motion is periodic",
                      one->kind, one->name, one->v[3], one->v[4], one->v[5], other->kind, other->name, other->v[3],
                      other->v[4], other->v[5]);
}

/* ---- motions that define the rotation ---- */

/* Sets the rotation from a motion, or compares the two. Nodes at rest may carry rotating parts, as the ground does;
   members on roots at rest may not. */
static int meet_motion(spari_assembly *a, const prescribed_motion *t, int carries, prescribed_motion *first) {
    if (!(spari_norm(t->v + 3) > 0 || spari_norm(t->a) > 0) && (carries || !a->rotates)) {
        return SPAR_OK;
    }
    if (!a->rotates) {
        take_rotation(a, t);
        *first = *t;
        return SPAR_OK;
    }
    return goes_along(a, t) ? SPAR_OK : refuse_rotations(a, first, t);
}

/* Visits roots and nodes with prescribed motion. Called twice, because those at rest may come before those that
   rotate. */
static int meet_prescribed(spari_assembly *a, prescribed_motion *first) {
    for (int i = 0; i < 2 * a->components; i++) {
        const spar_member *m = a->component[i % a->components].member;
        prescribed_motion t = prescribed_by(m, "the root of", &m->now, 0);
        if (m->root == SPAR_ROOT_PINNED && a->rotates) {
            memset(t.v, 0, 3 * sizeof *t.v);
            memcpy(t.v + 3, a->rotating.rotation.w, 3 * sizeof *t.v);
        }
        if (spari_member_root_is_prescribed(m) || (m->root == SPAR_ROOT_PINNED && a->rotates)) {
            SPARI_TRY(meet_motion(a, &t, 0, first));
        }
    }
    for (int i = 0; i < 2 * a->constraints; i++) {
        const spari_constraint *l = a->constraint + i % a->constraints;
        const spar_joint *j = l->joint;
        if (!l->component[i / a->constraints] && j->member[i / a->constraints]) {
            const spar_member *m = j->member[i / a->constraints];
            const prescribed_motion t = prescribed_by(m, "the member", &m->after, j->seat[i / a->constraints]);
            SPARI_TRY(meet_motion(a, &t, 1, first));
        }
    }
    return SPAR_OK;
}

/* Position and axes of the joint on the side at rest. */
static void frame_of_joint(const spar_joint *j, int side, double x[3], double q[4]) {
    spari_node_pose pose[2];
    spari_joint_poses(j, pose);
    spari_rotate(pose[side].q, j->kinematics.arm[side], x);
    for (int k = 0; k < 3; k++) {
        x[k] += pose[side].x[k];
    }
    spari_quat_mul(pose[side].q, j->kinematics.axes[side], q);
}

/* A joint driven against a side at rest, about its one axis. */
static int meet_drive(spari_assembly *a, const spari_constraint *l, prescribed_motion *first) {
    const spar_joint *j = l->joint;
    int side = spari_constraint_fixed_side(l),
        axis = j->kinematics.line ? -1 : spari_kinematics_free_axis(j->kinematics.free), others = 0;
    prescribed_motion t = {.kind = "joint", .name = j->name};
    double q[4], unit[3] = {0};
    for (int k = 0; k < 6; k++) {
        others = others || ((j->driven >> k & 1) && fabs(j->drive[1].rate[k]) > 0 && k != 3 + axis);
    }
    double rate = axis >= 0 && (j->driven >> (3 + axis) & 1) ? j->drive[1].rate[3 + axis] : 0;
    if (!others && !(fabs(rate) > 0)) {
        return SPAR_OK;
    }
    SPARI_REQUIRE(
        j->session, !others && side >= 0, SPAR_ERR_UNSUPPORTED,
        "joint '%s' is driven between moving parts, or not about a single axis: parts in relative motion have "
        "no steady state; for the shape at rest drive it with a rate of 0 (spar_joint_drive), otherwise run "
        "time steps until the motion is periodic",
        j->name);
    frame_of_joint(j, side, t.x, q);
    unit[axis] = side == 1 ? rate : -rate;
    spari_rotate(q, unit, t.v + 3);
    return meet_motion(a, &t, 0, first);
}

/* ---- loads fixed in space ---- */

static int refuse_loads_across(const spari_assembly *a, const spar_member *m, const double axis[3]) {
    spar_session *s = a->session;
    const double *g = m->body ? m->body->gravity : NULL;
    SPARI_REQUIRE(s, !g || !m->body->mass || !spari_across(axis, g), SPAR_ERR_UNSUPPORTED,
                  "'%s' rotates about (%.4g, %.4g, %.4g), and gravity (%g, %g, %g) is not parallel to that axis, so "
                  "there is no steady state; set only the component of gravity along the axis, its mean over a "
                  "revolution (spar_session_set_gravity), or run time steps until the motion is periodic",
                  m->name, axis[0], axis[1], axis[2], g[0], g[1], g[2]);
    for (int64_t i = 0; i < 2 * m->nodes; i++) {
        SPARI_REQUIRE(
            s, !spari_across(axis, m->load.dead + 3 * i), SPAR_ERR_UNSUPPORTED,
            "'%s' rotates about (%.4g, %.4g, %.4g), and the dead load of node %lld is not parallel to that axis: its "
            "direction is fixed while the node rotates; use SPAR_LOAD_FOLLOWER, or only the component along the axis",
            m->name, axis[0], axis[1], axis[2], (long long)(i / 2));
    }
    SPARI_REQUIRE(
        s, !spari_applied_across(m, axis), SPAR_ERR_UNSUPPORTED,
        "'%s' rotates about (%.4g, %.4g, %.4g), and its dead line load is not parallel to that axis: its direction is "
        "fixed while the beam rotates; use SPAR_LOAD_FOLLOWER, or only the component along the axis",
        m->name, axis[0], axis[1], axis[2]);
    SPARI_REQUIRE(s, !m->load.foundation, SPAR_ERR_UNSUPPORTED,
                  "'%s' rotates, and its foundation springs connect it to the ground, so there is no steady state; "
                  "remove the foundation, or run time steps",
                  m->name);
    return SPAR_OK;
}

static int check_parts(const spari_assembly *a) {
    const double *w = a->rotating.rotation.w, speed = spari_norm(w);
    const double axis[3] = {w[0] / speed, w[1] / speed, w[2] / speed};
    for (int i = 0; i < a->components && speed > 0; i++) {
        SPARI_TRY(refuse_loads_across(a, a->component[i].member, axis));
    }
    return SPAR_OK;
}

static int is_free_to_rotate(spari_assembly *a) {
    int64_t most = 1;
    for (int i = 0; i < a->components; i++) {
        int64_t P = a->component[i].body->per_element;
        most = P > most ? P : most;
    }
    a->rotating.mass = spari_zalloc(36 * most * most, sizeof *a->rotating.mass);
    SPARI_REQUIRE(a->session, a->rotating.mass, SPAR_ERR_MEMORY,
                  "no memory for the equilibrium of the members connected by joint '%s'", a->constraint[0].joint->name);
    return SPAR_OK;
}

int spari_rotation_check_begin(spari_assembly *a) {
    prescribed_motion first;
    a->rotates = 0;
    a->rotating.mass = NULL;
    SPARI_TRY(meet_prescribed(a, &first));
    for (int i = 0; i < a->constraints; i++) {
        SPARI_TRY(meet_drive(a, a->constraint + i, &first));
    }
    if (a->rotates) {
        SPARI_TRY(meet_prescribed(a, &first)); /* a joint drives the rotation: roots at rest do not take part */
        SPARI_TRY(check_parts(a));
        SPARI_TRY(is_free_to_rotate(a));
    }
    return SPAR_OK;
}

void spari_rotation_check_end(spari_assembly *a) {
    free(a->rotating.mass);
    a->rotating.mass = NULL;
    a->rotates = 0;
}

/* ---- constraints to parts that do not rotate ---- */

/* A constraint after a rotation of the whole by some angle: the forces on the rotating side, the constrained rows
   there, and its motion. */
typedef struct constraint_view {
    double force[6], z[6], B[6][6];
} constraint_view;

static void look_at_constraint(const spari_assembly *a, const spari_constraint *l, int side, double angle,
                               constraint_view *view) {
    const spari_steady_rotation *g = &a->rotating.rotation;
    double speed = spari_norm(g->w), psi[3], rotation[4], hub[3], r[3], along, inward[3], v[12] = {0}, rate[6],
           unused[6];
    double B[6][12], load[6], f[12];
    spari_node_pose pose[2] = {l->pose[0], l->pose[1]};
    for (int k = 0; k < 3; k++) {
        psi[k] = g->w[k] * angle / speed;
    }
    spari_quat_exp(psi, rotation);
    spari_cross(g->w, g->v0, inward); /* to the axis: x + w x v / w^2 */
    along = spari_dot(g->w, g->v0) / (speed * speed);
    for (int k = 0; k < 3; k++) {
        hub[k] = a->rotating.centre[k] + inward[k] / (speed * speed);
        r[k] = pose[side].x[k] - hub[k];
    }
    spari_rotate(rotation, r, r);
    for (int k = 0; k < 3; k++) {
        pose[side].x[k] = hub[k] + r[k] + along * psi[k];
    }
    spari_quat_mul(rotation, pose[side].q, pose[side].q);
    spari_rotating_frame_rates(&a->rotating, 1, pose[side].x, v + 6 * side, unused);
    spari_kinematics_motion(&l->joint->kinematics, &pose[0], &pose[1], view->z, B);
    spari_constraint_times(B, v, rate);
    memcpy(load, l->joint->after.load, sizeof load);
    double z[6];
    memcpy(z, view->z, sizeof z);
    spari_joint_count_turns(l->joint, l->joint->after.z, z);
    (void)spari_joint_spring(l->joint, z, rate, INFINITY, 1, load);
    for (int k = 0; k < 6; k++) {
        load[k] = spari_joint_constrained(l->joint) >> k & 1 ? 0 : load[k];
    }
    spari_kinematics_forces(B, load, f);
    for (int k = 0; k < 6; k++) { /* back into the initial axes */
        memcpy(view->B[k], B[k] + 6 * side, sizeof view->B[k]);
        spari_rotate_back(rotation, view->B[k], view->B[k]);
        spari_rotate_back(rotation, view->B[k] + 3, view->B[k] + 3);
    }
    memcpy(view->force, f + 6 * side, sizeof view->force);
    spari_rotate_back(rotation, view->force, view->force);
    spari_rotate_back(rotation, view->force + 3, view->force + 3);
}

/* Whether row x is a combination of the constrained rows in `view`. length: for moments. */
static int is_constrained_in(const constraint_view *view, int given, const double x[6]) {
    double row[6][6], left[6], size = 0, rest = 0;
    int count = 0;
    for (int k = 0; k <= 6; k++) {
        double *to = k < 6 ? row[count] : left, own = 0, now = 0;
        if (k < 6 && !(given >> k & 1)) {
            continue;
        }
        memcpy(to, k < 6 ? view->B[k] : x, sizeof left);
        for (int i = 0; i < 6; i++) {
            own += to[i] * to[i];
        }
        for (int m = 0; m < 2 * count; m++) {
            double along = 0;
            for (int i = 0; i < 6; i++) {
                along += to[i] * row[m % count][i];
            }
            for (int i = 0; i < 6; i++) {
                to[i] -= along * row[m % count][i];
            }
        }
        for (int i = 0; i < 6; i++) {
            now += to[i] * to[i];
        }
        for (int i = 0; i < 6 && k < 6 && now > 1e-18 * own; i++) {
            to[i] /= sqrt(now);
        }
        count += k < 6 && now > 1e-18 * own;
        size = own, rest = now;
    }
    return rest <= 1e-12 * size;
}

static int is_same_view(const spari_constraint *l, const constraint_view *now, const constraint_view *then,
                        double angle, double speed) {
    const spar_joint *j = l->joint;
    int given = spari_joint_constrained(j), same = 1,
        axis = j->kinematics.line ? -1 : spari_kinematics_free_axis(j->kinematics.free);
    double difference = 0, size = 0, most = 0, reach = spari_member_length(j->member[0]);
    for (int k = 0; k < 6; k++) {
        difference = fmax(difference, fabs(now->force[k] - then->force[k]));
        size = fmax(size, fabs(now->force[k]));
        if (!(given >> k & 1) || (j->kinematics.line && k > 0)) {
            continue;
        }
        same = same && is_constrained_in(now, given, then->B[k]);
        double rate = j->driven >> k & 1 ? j->drive[1].rate[k] : 0, gap = then->z[k] - now->z[k] - rate * angle / speed;
        gap = k == 3 + axis ? remainder(gap, 2 * acos(-1)) : gap;
        same = same && fabs(gap) <= 1e-6 * (k < 3 ? reach : 1);
    }
    for (int i = 0; i < 36; i++) { /* of a motion that is only rounding */
        most = fmax(most, (fabs(j->stiffness[i]) + speed * fabs(j->damping[i])) * (i % 6 < 3 ? reach : 1));
    }
    return same && difference <= 1e-6 * size + 1e-9 * most;
}

static int check_constraint(const spari_assembly *a, spari_constraint *l) {
    static const double angles[2] = {1, 2.3};
    double speed = spari_norm(a->rotating.rotation.w);
    int side = spari_constraint_fixed_side(l), same = speed > 0;
    constraint_view now, then;
    if (side < 0 || !l->component[1 - side]) {
        return SPAR_OK;
    }
    spari_constraint_find(l, 1, 1, 1);
    if (same) {
        look_at_constraint(a, l, 1 - side, 0, &now);
    }
    for (int k = 0; k < 2 && same; k++) {
        look_at_constraint(a, l, 1 - side, angles[k], &then);
        same = is_same_view(l, &now, &then, angles[k], speed);
    }
    SPARI_REQUIRE(a->session, same, SPAR_ERR_UNSUPPORTED,
                  "joint '%s' connects '%s', which rotates, to a part at rest, and its stiffness depends on the angle, "
                  "so there is no steady state; leave the rotation about the axis free or drive it, with isotropic "
                  "springs and dampers, or run time steps until the motion is periodic",
                  l->joint->name, l->joint->member[1 - side]->name);
    return SPAR_OK;
}

int spari_rotation_check_joints(spari_assembly *a) {
    for (int i = 0; i < a->constraints; i++) {
        SPARI_TRY(check_constraint(a, a->constraint + i));
    }
    return SPAR_OK;
}
