/* What carries the components of an assembly when it turns: see time/turning_frame.h. The tree of the joints says which
   joint carries a component: the one on its way to the ground. */
#include "../base/session.h"
#include "../math/rotation.h"
#include "system.h"

#include <string.h>

/* The velocity of the ground or of the nodes with prescribed motion that joints lead to; their number. */
static int find_ground(const spari_assembly *a, double v[3], double rate[3]) {
    int sides = 0;
    for (int i = 0; i < a->constraints; i++) {
        const spari_constraint *l = a->constraint + i;
        for (int side = 0; side < 2; side++) {
            const spar_member *m = l->joint->member[side];
            for (int k = 0; k < 3 && !l->component[side] && m; k++) {
                v[k] += m->now.v[6 * l->joint->seat[side] + k];
                rate[k] += m->now.a[6 * l->joint->seat[side] + k];
            }
            sides += !l->component[side];
        }
    }
    return sides;
}

static int flies(const spari_assembly *a) {
    for (int i = 0; i < a->components; i++) {
        const spari_component *p = a->component + i;
        if (p->frame || spari_member_constrained(p->member) > 0) {
            return 0;
        }
    }
    return 1;
}

/* The base of all: the ground, else the mass centre. The forces of joints have no influence on its acceleration. */
static void find_base(spari_assembly *a) {
    double v[3] = {0}, rate[3] = {0}, mass = find_ground(a, v, rate);
    if (!(mass > 0) && flies(a)) {
        for (int i = 0; i < a->components; i++) {
            const spar_member *m = a->component[i].member;
            spari_momenta t;
            spari_body_momenta(a->component[i].body, m->xr, m->now.q, m->now.v, m->now.a, m->xr, &t);
            mass += t.mass;
            for (int k = 0; k < 3; k++) {
                v[k] += t.linear[k];
                rate[k] += t.force[k];
            }
        }
    }
    for (int i = 0; i < a->components && mass > 0; i++) {
        spari_carrier *c = &a->component[i].stage.carrier;
        for (int k = 0; k < 3; k++) {
            c->base_v[k] = v[k] / mass;
            c->base_a[k] = rate[k] / mass;
        }
    }
}

/* The point of a joint on a component: where it is, its velocity and its acceleration. */
static void find_joint(const spari_component *p, const spar_joint *j, int side, spari_carrier *c, double a[3]) {
    const spar_member *m = p->member;
    const double *q = m->now.q + 7 * j->seat[side], *v = m->now.v + 6 * j->seat[side];
    const double *rate = m->now.a + 6 * j->seat[side], *reference = m->xr + 3 * j->seat[side];
    double arm[3], rotation[3], inward[3], grow[3];
    memcpy(c->point, j->kinematics.arm[side], sizeof c->point);
    spari_rotate(q + 3, c->point, arm);
    spari_cross(v + 3, arm, rotation);
    spari_cross(v + 3, rotation, inward);
    spari_cross(rate + 3, arm, grow);
    for (int k = 0; k < 3; k++) {
        c->x[k] = reference[k] - m->xr[k] + q[k] + arm[k];
        c->v[k] = v[k] + rotation[k];
        a[k] = rate[k] + inward[k] + grow[k];
    }
}

/* Keeps of the rotation w only the part that a joint with one free axis lets differ from that of the other side. */
static void rotate_about_axis(const spar_joint *j, const double other[3], double w[3]) {
    const int axis = spari_kinematics_free_axis(j->kinematics.free);
    double e[3] = {axis == 0, axis == 1, axis == 2}, relative[3];
    if (axis < 0 || j->kinematics.line) {
        return;
    }
    spari_rotate(j->kinematics.axes[1], e, e);
    if (j->member[1]) {
        spari_rotate(j->member[1]->now.q + 7 * j->seat[1] + 3, e, e);
    }
    for (int k = 0; k < 3; k++) {
        relative[k] = w[k] - other[k];
    }
    const double along = spari_dot(relative, e);
    for (int k = 0; k < 3; k++) {
        w[k] = other[k] + along * e[k];
    }
}

/* Angular velocities or accelerations of the nodes that a joint ties, of the side less the other. */
static double between(const spar_joint *j, int side, int acceleration, int k) {
    double sum = 0;
    for (int i = 0; i < 2; i++) {
        const spar_member *m = j->member[i];
        const double *rates = m ? (acceleration ? m->now.a : m->now.v) + 6 * j->seat[i] : NULL;
        sum += m ? (i == side ? 1 : -1) * rates[3 + k] : 0;
    }
    return sum;
}

/* The joint on `side` carries a component, and rotates with what is on its other side. */
static void carry_component(spari_component *p, const spari_constraint *l, int side) {
    spari_carrier *c = &p->stage.carrier;
    const spar_joint *j = l->joint;
    const spari_component *other = l->component[1 - side];
    const spar_member *m = j->member[1 - side];
    const spari_carrier *by = other ? &other->stage.carrier : NULL;
    const int free = j->kinematics.free >> 3 & 7, driven = j->driven >> 3 & 7;
    double a[3];
    find_joint(p, j, side, c, a);
    for (int k = 0; k < 3; k++) {
        const int64_t at = 6 * j->seat[1 - side] + 3 + k;
        c->path[k] = by ? by->w[k] : m ? m->now.v[at] : 0;
        c->grows[k] = by ? by->alpha[k] : m ? m->now.a[at] : 0;
        c->w[k] = c->path[k] + (free ? between(j, side, 0, k) : 0);
        c->alpha[k] = c->grows[k] + (free ? between(j, side, 1, k) : 0);
    }
    c->held = (!by || !by->turns) && !(spari_norm(c->path) > 0);
    c->turns = free || !c->held;
    if (free & ~driven) {
        spari_carrier_rotation(p->solver, p->member, a, c);
        rotate_about_axis(j, c->path, c->w);
        rotate_about_axis(j, c->grows, c->alpha);
    }
}

/* A component that no joint carries. */
static void stand_alone(spari_component *p) {
    spari_carrier *c = &p->stage.carrier;
    const spar_member *m = p->member;
    if (!p->frame && !spari_member_root_is_prescribed(m)) {
        spari_carrier_begin(p->solver, m, c);
        return;
    }
    *c = (spari_carrier){0};
    memcpy(c->w, m->drive[0].v + 3, sizeof c->w);
    memcpy(c->alpha, m->drive[0].a + 3, sizeof c->alpha);
}

void spari_assembly_find_carriers(spari_assembly *a) {
    if (a->components == 0 || a->component[0].scheme.still) {
        return;
    }
    if (a->constraints == 0) {
        stand_alone(a->component);
    }
    for (int n = 0; n < a->components && a->constraints > 0; n++) {
        const spari_carried *by = a->carried + n;
        spari_component *p = a->component + by->component;
        if (by->constraint < 0) {
            stand_alone(p);
        } else {
            p->stage.carrier = (spari_carrier){0};
            carry_component(p, a->constraint + by->constraint, by->side);
        }
    }
    find_base(a);
}

/* ---- the order ---- */

/* Whether a joint holds a component so that it can carry it: not a link, nor springs alone. */
static int holds(const spari_constraint *l) {
    return !l->joint->kinematics.line && l->joint->kinematics.free != 63;
}

static int is_base(const spari_component *p) {
    return p->frame || spari_member_constrained(p->member) > 0;
}

/* Appends the component on `side` of a constraint, if it has no carrier yet. */
static int append(spari_assembly *a, int constraint, int side, int count) {
    const spari_component *p = a->constraint[constraint].component[side];
    const int i = p ? (int)(p - a->component) : 0;
    if (p && !p->carried) {
        a->component[i].carried = 1;
        a->carried[count++] = (spari_carried){i, constraint, side};
    }
    return count;
}

static int append_base(spari_assembly *a, int i, int count) {
    a->component[i].carried = 1;
    a->carried[count] = (spari_carried){i, -1, 0};
    return count + 1;
}

/* Appends what the components from number `done` on carry, and what that carries. */
static int append_carried(spari_assembly *a, int done, int count) {
    for (; done < count; done++) {
        const spari_component *p = a->component + a->carried[done].component;
        for (int n = 0; n < p->member->joint_count; n++) {
            const int k = p->member->joints[n]->constraint;
            for (int side = 0; side < 2 && holds(a->constraint + k); side++) {
                count = append(a, k, side, count);
            }
        }
    }
    return count;
}

int spari_assembly_order_carriers(spari_assembly *a) {
    int count = 0;
    a->carried = spari_zalloc(a->components + 1, sizeof *a->carried);
    if (!a->carried) {
        return spari_fail(a->session, SPAR_ERR_MEMORY, "no memory for the order of %d joined members", a->components);
    }
    for (int i = 0; i < a->components; i++) {
        a->component[i].carried = 0;
    }
    for (int i = 0; i < a->components; i++) {
        count = is_base(a->component + i) ? append_base(a, i, count) : count;
    }
    for (int k = 0; k < a->constraints; k++) {
        const spari_constraint *l = a->constraint + k;
        for (int side = 0; side < 2 && holds(l); side++) {
            count = l->component[1 - side] ? count : append(a, k, side, count);
        }
    }
    count = append_carried(a, 0, count);
    for (int i = 0; i < a->components; i++) {
        if (!a->component[i].carried) {
            count = append_carried(a, count, append_base(a, i, count));
        }
    }
    return SPAR_OK;
}
