/* Getters and setters of a member: counts, reference, motion, loads; and conversion between its two node numberings. */
#include "../base/environment.h"
#include "../math/rotation.h"
#include "added_mass.h"
#include "applied_loads.h"
#include "body.h"
#include "check_arguments.h"
#include "joint.h"
#include "plane.h"
#include "structure.h"

#include <stdlib.h>
#include <string.h>

#define SPARI_ROW(name, width, order, kind)                                                                            \
    { offsetof(spar_member, name), width, order, SPARI_NODAL_##kind }
const spari_nodal spari_nodal_table[SPARI_NODAL_COUNT] = {
    SPARI_ROW(xr, 3, 0, REFERENCE),         SPARI_ROW(qr, 4, 0, REFERENCE),
    SPARI_ROW(now.q, 7, 0, MOTION),         SPARI_ROW(now.v, 6, 0, MOTION),
    SPARI_ROW(now.a, 6, 0, MOTION),         SPARI_ROW(after.q, 7, 0, MOTION),
    SPARI_ROW(after.v, 6, 0, MOTION),       SPARI_ROW(after.a, 6, 0, MOTION),
    SPARI_ROW(load.dead, 6, 0, LOAD),       SPARI_ROW(load.used, 6, 0, LOAD),
    SPARI_ROW(load.pushed, 6, 0, LOAD),     SPARI_ROW(load.before, 6, 0, LOAD),
    SPARI_ROW(load.history[0], 6, 0, LOAD), SPARI_ROW(load.history[1], 6, 1, LOAD),
    SPARI_ROW(load.history[2], 6, 2, LOAD), SPARI_ROW(load.solved[0], 6, 0, LOAD),
    SPARI_ROW(load.solved[1], 6, 0, LOAD),
};

double spari_member_length(const spar_member *m) {
    double length = m->body ? m->body->length : 0;
    for (int64_t i = 1; i < m->nodes && !m->body && m->xr; i++) { /* not of a beam that lacks its line */
        double d[3];
        for (int k = 0; k < 3; k++) {
            d[k] = m->xr[3 * i + k] - m->xr[3 * (i - 1) + k];
        }
        length += spari_norm(d);
    }
    return length > 0 ? length : 1;
}

int spar_member_get_count(const spar_member *member, int64_t *nodes) {
    SPARI_TRY(spari_need_member(member, __func__));
    SPARI_REQUIRE(member->session, nodes, SPAR_ERR_ARGUMENT, "%s: '%s': nodes is NULL", __func__, member->name);
    *nodes = member->nodes;
    return SPAR_OK;
}

/* copies n doubles if they are wanted */
int spar_member_get_reference(const spar_member *member, double *x, double *q) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_TRY(spari_need_committed(member, __func__));
    spari_give(x, member->xr, 3 * member->nodes);
    spari_give(q, member->qr, 4 * member->nodes);
    return SPAR_OK;
}

int spar_member_get_motion(const spar_member *member, double *q, double *v, double *a) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_TRY(spari_need_committed(member, __func__));
    spari_give(q, member->after.q, 7 * member->nodes);
    spari_give(v, member->after.v, 6 * member->nodes);
    spari_give(a, member->after.a, 6 * member->nodes);
    return SPAR_OK;
}

int spar_member_get_loads(const spar_member *member, double *load) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_TRY(spari_need_committed(member, __func__));
    SPARI_REQUIRE(member->session, load, SPAR_ERR_ARGUMENT, "%s: '%s': load is NULL", __func__, member->name);
    const spar_session *s = member->session;
    int used = s->state.phase == SPARI_BEGUN || s->state.phase == SPARI_SOLVED ||
               (s->state.phase == SPARI_CHECKED && s->state.iterating);
    const double *fluid = used ? member->load.used : member->load.pushed;
    for (int64_t i = 0; i < 6 * member->nodes; i++) {
        load[i] = member->load.dead[i] + fluid[i];
    }
    if (s->state.phase != SPARI_IDLE && spari_added_shift(member)) {
        spari_added_correct(member, -1, load);
    }
    if (spari_carries_loads(member)) {
        spari_applied_nodal(member, member->after.q, load);
    }
    if (s->joints && member->kind == SPARI_POINT && !member->external) {
        spari_joints_on(member, 0, load);
    }
    return SPAR_OK;
}

/* Unknowns count element boundaries once: host node i is unique node i - i / P (e P + k -> e (P-1) + k). */
void spari_member_to_unique(const spar_member *m, int width, const double *nodes, double *unique) {
    int P = m->mesh.per_element;
    if (m->mesh.elements == 1) {
        memcpy(unique, nodes, (size_t)(width * m->nodes) * sizeof *nodes);
        return;
    }
    for (int64_t i = 0; i < m->nodes; i++) {
        memcpy(unique + width * (i - i / P), nodes + width * i, (size_t)width * sizeof *nodes);
    }
}

/* Host nodes and unique nodes. */
typedef struct two_views {
    const spar_member *m;
    int width;
    const double *from;
    double *to;
} two_views;

static void nodes_of_unique(void *context, int64_t from, int64_t to) {
    const two_views *t = context;
    int P = t->m->mesh.per_element, width = t->width;
    for (int64_t i = from; i < to; i++) {
        memcpy(t->to + width * i, t->from + width * (i - i / P), (size_t)width * sizeof *t->to);
    }
}

void spari_member_from_unique(const spar_member *m, int width, const double *unique, double *nodes) {
    if (m->mesh.elements == 1) {
        memcpy(nodes, unique, (size_t)(width * m->nodes) * sizeof *nodes);
        return;
    }
    spari_member_spread(m, m->nodes, nodes_of_unique, &(two_views){m, width, unique, nodes});
}

void spari_member_publish(const spar_member *m, const double *q, const double *v, const double *a, spari_motion *to) {
    spari_member_from_unique(m, 7, q, to->q);
    spari_member_from_unique(m, 6, v, to->v);
    spari_member_from_unique(m, 6, a, to->a);
}

/* An element boundary is the end of one element and the beginning of the next. */
static void gather_nodes(void *context, int64_t from, int64_t to) {
    const two_views *t = context;
    int64_t steps = t->m->mesh.per_element - 1, last = t->m->mesh.elements * steps;
    for (int64_t u = from; u < to; u++) {
        int64_t e = u > 0 ? (u - 1) / steps : 0;
        const double *load = t->from + 6 * (u + e);
        double *sum = t->to + 6 * u;
        int joint = u > 0 && u < last && u == (e + 1) * steps;
        for (int k = 0; k < 6; k++) {
            sum[k] = 0 + load[k];
        }
        for (int k = 0; k < 6 && joint; k++) {
            sum[k] += load[6 + k];
        }
    }
}

void spari_member_gather(const spar_member *m, const double *nodal, double *unique) {
    if (m->mesh.elements == 1) {
        for (int64_t i = 0; i < 6 * m->nodes; i++) {
            unique[i] = 0 + nodal[i];
        }
        return;
    }
    spari_member_spread(m, m->body->unique, gather_nodes, &(two_views){m, 6, nodal, unique});
}

void spari_member_even_loads(const spar_member *m, double *load) {
    int P = m->mesh.per_element;
    spari_member_constrain(m, m->nodes, load);
    for (int64_t e = 1; e < m->mesh.elements; e++) {
        double *left = load + 6 * (e * P - 1), *right = left + 6;
        for (int k = 0; k < 6; k++) {
            left[k] = right[k] = 0.5 * (left[k] + right[k]);
        }
    }
}
