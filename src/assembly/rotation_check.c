/* How an assembly turns as one: see rotation_check.h. */
#include "rotation_check.h"

#include "../base/session.h"
#include "../math/rotation.h"
#include "../member/applied.h"
#include "../time/fidelity.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Motions that differ by less, relative to their size, are one. */
static const double same_motion = 1e-6;

/* A motion that is told: of a root, a node, or by a joint. */
typedef struct told_motion {
    const char *kind, *name;
    double x[3], v[6], a[3];
} told_motion;

static int is_turning(const told_motion *t) {
    return spari_norm(t->v + 3) > 0 || spari_norm(t->a) > 0;
}

static told_motion told_by(const spar_member *m, const char *kind, const spari_motion *motion, int64_t node) {
    told_motion t = {.kind = kind, .name = m->name};
    for (int k = 0; k < 3; k++) {
        t.x[k] = m->xr[3 * node + k] + motion->q[7 * node + k];
    }
    memcpy(t.v, motion->v + 6 * node, sizeof t.v);
    memcpy(t.a, motion->a + 6 * node, sizeof t.a);
    return t;
}

/* The turn is that motion's. Where nothing is said of its acceleration, its axis stands. */
static void take_turn(spari_assembly *a, const told_motion *t) {
    spari_turning *g = &a->turning;
    double inward[3];
    memcpy(g->turn.w, t->v + 3, sizeof g->turn.w);
    memcpy(g->turn.v0, t->v, sizeof g->turn.v0);
    memcpy(g->turn.a0, t->a, sizeof g->turn.a0);
    memcpy(g->centre, t->x, sizeof g->centre);
    spari_cross(g->turn.w, g->turn.v0, inward);
    if (!(spari_norm(t->a) > 0)) {
        memcpy(g->turn.a0, inward, sizeof inward);
    }
    a->turns = 1;
}

/* Whether it is part of the turn that has been found. */
static int goes_along(const spari_assembly *a, const told_motion *t) {
    double v[6], acceleration[6], apart[3], turn[3];
    const spari_turn *g = &a->turning.turn;
    spari_turning_rates(&a->turning, 1, t->x, v, acceleration);
    for (int k = 0; k < 3; k++) {
        apart[k] = v[k] - t->v[k];
        turn[k] = v[3 + k] - t->v[3 + k];
    }
    double size = spari_norm(g->v0) + spari_norm(v) + spari_norm(t->v);
    return spari_norm(turn) <= same_motion * spari_norm(g->w) && spari_norm(apart) <= same_motion * size;
}

static int refuse_turns(const spari_assembly *a, const told_motion *one, const told_motion *other) {
    return spari_fail(a->session, SPAR_ERR_UNSUPPORTED,
                      "%s '%s' turns with (%g, %g, %g) rad/s, and %s '%s', which is tied to it, with (%g, %g, %g): "
                      "parts that turn against each other have no state that is steady; for the shape at rest turn "
                      "none of them, else go on in steps until what is left is periodic",
                      one->kind, one->name, one->v[3], one->v[4], one->v[5], other->kind, other->name, other->v[3],
                      other->v[4], other->v[5]);
}

/* ---- who turns it ---- */

/* Takes or compares one. Nodes that stand may carry what turns, as the ground does; members on roots that stand not. */
static int meet_motion(spari_assembly *a, const told_motion *t, int carries, told_motion *first) {
    if (!is_turning(t) && (carries || !a->turns)) {
        return SPAR_OK;
    }
    if (!a->turns) {
        take_turn(a, t);
        *first = *t;
        return SPAR_OK;
    }
    return goes_along(a, t) ? SPAR_OK : refuse_turns(a, first, t);
}

/* Of roots and nodes that are told; twice, since those that stand come before those that turn. */
static int meet_told(spari_assembly *a, told_motion *first) {
    for (int i = 0; i < 2 * a->limbs; i++) {
        const spar_member *m = a->limb[i % a->limbs].member;
        told_motion t = told_by(m, "the root of", &m->now, 0);
        if (m->root == SPAR_ROOT_PINNED && a->turns) {
            memset(t.v, 0, 3 * sizeof *t.v);
            memcpy(t.v + 3, a->turning.turn.w, 3 * sizeof *t.v);
        }
        if (spari_member_root_is_given(m) || (m->root == SPAR_ROOT_PINNED && a->turns)) {
            SPARI_TRY(meet_motion(a, &t, 0, first));
        }
    }
    for (int i = 0; i < 2 * a->links; i++) {
        const spari_link *l = a->link + i % a->links;
        const spar_joint *j = l->joint;
        if (!l->limb[i / a->links] && j->member[i / a->links]) {
            const spar_member *m = j->member[i / a->links];
            const told_motion t = told_by(m, "the member", &m->after, j->seat[i / a->links]);
            SPARI_TRY(meet_motion(a, &t, 1, first));
        }
    }
    return SPAR_OK;
}

/* Where the joint is as the side that stands carries it, and its axes there. */
static void frame_of_joint(const spar_joint *j, int side, double x[3], double q[4]) {
    spari_place place[2];
    spari_joint_places(j, place);
    spari_rotate(place[side].q, j->tie.arm[side], x);
    for (int k = 0; k < 3; k++) {
        x[k] += place[side].x[k];
    }
    spari_quat_mul(place[side].q, j->tie.axes[side], q);
}

static int refuse_drive(const spari_link *l) {
    const spar_joint *j = l->joint;
    return spari_fail(j->session, SPAR_ERR_UNSUPPORTED,
                      "joint '%s' is driven with a rate between parts that move, or other than about one axis: parts "
                      "that move against each other have no state that is steady; for the shape at rest drive it with "
                      "a rate of 0 (spar_joint_drive), else go on in steps until what is left is periodic",
                      j->name);
}

/* A joint driven against what stands, about its one axis. */
static int meet_drive(spari_assembly *a, const spari_link *l, told_motion *first) {
    const spar_joint *j = l->joint;
    int side = spari_link_standing(l), axis = j->tie.line ? -1 : spari_tie_axis(j->tie.free), others = 0;
    told_motion t = {.kind = "joint", .name = j->name};
    double q[4], unit[3] = {0};
    for (int k = 0; k < 6; k++) {
        others = others || ((j->driven >> k & 1) && fabs(j->drive[1].rate[k]) > 0 && k != 3 + axis);
    }
    double rate = axis >= 0 && (j->driven >> (3 + axis) & 1) ? j->drive[1].rate[3 + axis] : 0;
    if (!others && !(fabs(rate) > 0)) {
        return SPAR_OK;
    }
    if (others || side < 0) {
        return refuse_drive(l);
    }
    frame_of_joint(j, side, t.x, q);
    unit[axis] = side == 1 ? rate : -rate;
    spari_rotate(q, unit, t.v + 3);
    return meet_motion(a, &t, 0, first);
}

/* ---- what stands and does not turn with it ---- */

static int refuse_loads_across(const spari_assembly *a, const spar_member *m, const double axis[3]) {
    spar_session *s = a->session;
    const double *g = m->body ? m->body->gravity : NULL;
    SPARI_REQUIRE(s, !g || !m->body->mass || !spari_across(axis, g), SPAR_ERR_UNSUPPORTED,
                  "'%s' turns about (%.4g, %.4g, %.4g), and gravity (%g, %g, %g) goes across that axis: its weight "
                  "changes with the angle, and no state is steady; give gravity along the axis alone, its mean over a "
                  "turn (spar_session_set_gravity), or go on in steps until what is left is periodic",
                  m->name, axis[0], axis[1], axis[2], g[0], g[1], g[2]);
    for (int64_t i = 0; i < 2 * m->nodes; i++) {
        SPARI_REQUIRE(s, !spari_across(axis, m->dead + 3 * i), SPAR_ERR_UNSUPPORTED,
                      "'%s' turns about (%.4g, %.4g, %.4g), and the dead load of node %lld goes across that axis: it "
                      "stands while the node turns; give it as SPAR_LOAD_FOLLOWER, or the part along the axis",
                      m->name, axis[0], axis[1], axis[2], (long long)(i / 2));
    }
    SPARI_REQUIRE(s, !spari_applied_across(m, axis), SPAR_ERR_UNSUPPORTED,
                  "'%s' turns about (%.4g, %.4g, %.4g), and its dead line load goes across that axis: it stands while "
                  "the line turns; give it as SPAR_LOAD_FOLLOWER, or the part along the axis",
                  m->name, axis[0], axis[1], axis[2]);
    SPARI_REQUIRE(s, !m->foundation, SPAR_ERR_UNSUPPORTED,
                  "'%s' turns, and springs along it lead to the ground, which stands: no state is steady; take the "
                  "foundation away, or go on in steps",
                  m->name);
    return SPAR_OK;
}

static int check_parts(const spari_assembly *a) {
    const double *w = a->turning.turn.w, speed = spari_norm(w);
    const double axis[3] = {w[0] / speed, w[1] / speed, w[2] / speed};
    for (int i = 0; i < a->limbs && speed > 0; i++) {
        SPARI_TRY(refuse_loads_across(a, a->limb[i].member, axis));
    }
    return SPAR_OK;
}

static int room_to_turn(spari_assembly *a) {
    int64_t most = 1;
    for (int i = 0; i < a->limbs; i++) {
        int64_t P = a->limb[i].solver->body->per_element;
        most = P > most ? P : most;
    }
    a->turning.mass = spari_zalloc(36 * most * most, sizeof *a->turning.mass);
    SPARI_REQUIRE(a->session, a->turning.mass, SPAR_ERR_MEMORY,
                  "no memory for the equilibrium of the members that joint '%s' ties together", a->link[0].joint->name);
    return SPAR_OK;
}

int spari_turning_begin(spari_assembly *a) {
    told_motion first;
    a->turns = 0;
    a->turning.mass = NULL;
    SPARI_TRY(meet_told(a, &first));
    for (int i = 0; i < a->links; i++) {
        SPARI_TRY(meet_drive(a, a->link + i, &first));
    }
    if (a->turns) {
        SPARI_TRY(meet_told(a, &first)); /* a joint has begun it: roots that stand do not go along */
        SPARI_TRY(check_parts(a));
        SPARI_TRY(room_to_turn(a));
    }
    return SPAR_OK;
}

void spari_turning_end(spari_assembly *a) {
    free(a->turning.mass);
    a->turning.mass = NULL;
    a->turns = 0;
}

/* ---- what holds it ---- */

/* A link as it is when the whole has turned on by some angle: forces on the side that turns, the rows that it holds
   there, and its motion. */
typedef struct link_view {
    double force[6], z[6], B[6][6];
} link_view;

static void look_at_link(const spari_assembly *a, const spari_link *l, int side, double angle, link_view *view) {
    const spari_turn *g = &a->turning.turn;
    double speed = spari_norm(g->w), psi[3], turn[4], hub[3], r[3], along, inward[3], v[12] = {0}, rate[6], room[6];
    double B[6][12], load[6], f[12];
    spari_place place[2] = {l->place[0], l->place[1]};
    for (int k = 0; k < 3; k++) {
        psi[k] = g->w[k] * angle / speed;
    }
    spari_quat_exp(psi, turn);
    spari_cross(g->w, g->v0, inward); /* to the axis: x + w x v / w^2 */
    along = spari_dot(g->w, g->v0) / (speed * speed);
    for (int k = 0; k < 3; k++) {
        hub[k] = a->turning.centre[k] + inward[k] / (speed * speed);
        r[k] = place[side].x[k] - hub[k];
    }
    spari_rotate(turn, r, r);
    for (int k = 0; k < 3; k++) {
        place[side].x[k] = hub[k] + r[k] + along * psi[k];
    }
    spari_quat_mul(turn, place[side].q, place[side].q);
    spari_turning_rates(&a->turning, 1, place[side].x, v + 6 * side, room);
    spari_tie_motion(&l->joint->tie, &place[0], &place[1], view->z, B);
    spari_link_times(B, v, rate);
    memcpy(load, l->joint->after.load, sizeof load);
    double z[6];
    memcpy(z, view->z, sizeof z);
    spari_joint_count_turns(l->joint, l->joint->after.z, z);
    (void)spari_joint_spring(l->joint, z, rate, INFINITY, 1, load);
    for (int k = 0; k < 6; k++) {
        load[k] = spari_joint_given(l->joint) >> k & 1 ? 0 : load[k];
    }
    spari_tie_forces(B, load, f);
    for (int k = 0; k < 6; k++) { /* back into the axes of the beginning */
        memcpy(view->B[k], B[k] + 6 * side, sizeof view->B[k]);
        spari_rotate_back(turn, view->B[k], view->B[k]);
        spari_rotate_back(turn, view->B[k] + 3, view->B[k] + 3);
    }
    memcpy(view->force, f + 6 * side, sizeof view->force);
    spari_rotate_back(turn, view->force, view->force);
    spari_rotate_back(turn, view->force + 3, view->force + 3);
}

/* Whether row x is made of the rows that are held in `view`; length: of arms. */
static int is_held_in(const link_view *view, int given, const double x[6]) {
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

static int is_same_view(const spari_link *l, const link_view *now, const link_view *then, double angle, double speed) {
    const spar_joint *j = l->joint;
    int given = spari_joint_given(j), same = 1, axis = j->tie.line ? -1 : spari_tie_axis(j->tie.free);
    double apart = 0, size = 0, most = 0, reach = spari_member_length(j->member[0]);
    for (int k = 0; k < 6; k++) {
        apart = fmax(apart, fabs(now->force[k] - then->force[k]));
        size = fmax(size, fabs(now->force[k]));
        if (!(given >> k & 1) || (j->tie.line && k > 0)) {
            continue;
        }
        same = same && is_held_in(now, given, then->B[k]);
        double rate = j->driven >> k & 1 ? j->drive[1].rate[k] : 0, gap = then->z[k] - now->z[k] - rate * angle / speed;
        gap = k == 3 + axis ? remainder(gap, 2 * acos(-1)) : gap;
        same = same && fabs(gap) <= 1e-6 * (k < 3 ? reach : 1);
    }
    for (int i = 0; i < 36; i++) { /* of a motion of nothing but rounding */
        most = fmax(most, (fabs(j->stiffness[i]) + speed * fabs(j->damping[i])) * (i % 6 < 3 ? reach : 1));
    }
    return same && apart <= 1e-6 * size + 1e-9 * most;
}

static int check_link(const spari_assembly *a, spari_link *l) {
    static const double angles[2] = {1, 2.3};
    double speed = spari_norm(a->turning.turn.w);
    int side = spari_link_standing(l), same = speed > 0;
    link_view now, then;
    if (side < 0 || !l->limb[1 - side]) {
        return SPAR_OK;
    }
    spari_link_find(l, 1, 1, 1);
    if (same) {
        look_at_link(a, l, 1 - side, 0, &now);
    }
    for (int k = 0; k < 2 && same; k++) {
        look_at_link(a, l, 1 - side, angles[k], &then);
        same = is_same_view(l, &now, &then, angles[k], speed);
    }
    SPARI_REQUIRE(a->session, same, SPAR_ERR_UNSUPPORTED,
                  "joint '%s' ties '%s', which turns, to what stands, and does not hold it alike at every angle: no "
                  "state is steady; leave its turn about the axis free or drive it, with springs and dampers alike all "
                  "around, or go on in steps until what is left is periodic",
                  l->joint->name, l->joint->member[1 - side]->name);
    return SPAR_OK;
}

int spari_turning_check(spari_assembly *a) {
    for (int i = 0; i < a->links; i++) {
        SPARI_TRY(check_link(a, a->link + i));
    }
    return SPAR_OK;
}
