/* Resultant of all loads on the part of a beam beyond a section: see section_resultants.h. Loads are kept per element,
   with each element's own share at nodes in common with its neighbours. Distributed loads (inertia, weight,
   foundation, fluid) are nodal sums weighted with shape functions; spari_share_beyond gives the fraction of
   them that acts beyond a position in the element. Loads at nodes, along the line, of joints and of point masses act
   where they are. */
#include "section_resultants.h"

#include "../math/rotation.h"
#include "applied_loads.h"
#include "joint.h"
#include "plane.h"

#include <stdlib.h>
#include <string.h>

/* A point mass: position, and its force on the beam. */
typedef struct point_force {
    int element;
    double xi, x[3], force[6];
} point_force;

/* Forces on a line. */
typedef struct line_forces {
    int64_t masses;
    point_force *mass; /* [masses] */
    double *x;         /* [nodes][3] positions of the nodes */
    double *spread;    /* [nodes][6] */
    double *point;     /* [nodes][6] */
    double *sum;       /* [elements + 1][6] of all elements from e on, about the first node */
} line_forces;

struct spari_beyond {
    const spar_member *member;
    line_forces *on[2]; /* that act on the reference, and where the line is; NULL: none */
    double gll[SPARI_MAX_NODES], bary[SPARI_MAX_NODES], gauss[SPARI_MAX_NODES], weight[SPARI_MAX_NODES];
};

int spari_beyond_is_known(const spar_member *m) {
    return m->state.balanced[1] && !spari_member_plane(m) && m->body && m->body->C &&
           m->body->elements == m->mesh.elements && m->body->per_element == m->mesh.per_element;
}

int spari_member_is_undeformed(const spar_member *m) {
    return spari_member_is_linear_at_rest(m) && !(m->body && m->body->pre);
}

void spari_beyond_free(spari_beyond *b) {
    for (int k = 0; k < 2 && b; k++) {
        line_forces *f = b->on[k];
        if (f) {
            SPARI_FREE(f->mass, f->x, f->spread, f->point, f->sum, f);
        }
    }
    free(b);
}

static void add_about(const double center[3], const double x[3], const double f[6], double sum[6]) {
    double moment[3];
    const double arm[3] = {x[0] - center[0], x[1] - center[1], x[2] - center[2]};
    spari_cross(arm, f, moment);
    for (int k = 0; k < 3; k++) {
        sum[k] += f[k];
        sum[3 + k] += f[3 + k] + moment[k];
    }
}

/* ---- inertia and weight ---- */

void spari_inertial_fill(const spar_member *m, const spari_inertial *w) {
    const spari_body *body = m->body;
    const int64_t n = body->unique;
    for (int64_t i = 0; i < n; i++) {
        w->q[7 * i + 3] = 1;
    }
    spari_member_to_unique(m, 6, m->after.a, w->a);
    spari_member_to_unique(m, 6, m->after.v, w->v);
    if (!spari_member_is_linear_at_rest(m)) {
        spari_member_to_unique(m, 7, m->after.q, w->q);
    }
    if (body->mass_damping > 0 && !w->still) { /* the inertia of an acceleration: mass_damping times its velocity */
        if (spari_member_is_linear_at_rest(m)) {
            memcpy(w->workspace, w->v, (size_t)(6 * n) * sizeof *w->workspace);
        } else {
            spari_body_see(body, w->q, w->v, w->workspace);
        }
        for (int64_t i = 0; i < 6 * n; i++) {
            w->a[i] += body->mass_damping * w->workspace[i];
        }
    }
    if (spari_member_is_linear_at_rest(m)) {
        memset(w->v, 0, (size_t)(6 * n) * sizeof *w->v);
    }
}

/* Nodal forces [P][6] of inertia minus `factor` times weight on element e, with the points' weights [slots]. */
static void element_inertia(const spari_body *body, const spari_inertial *w, double factor, int e, double *weights,
                            double *r) {
    const int64_t first = (int64_t)e * (body->per_element - 1);
    spari_body part = *body;
    part.elements = 1, part.unique = body->per_element;
    part.first += e, part.slot += e;
    part.C = part.D = part.pre = NULL;
    part.mass_damping = 0;
    part.pool = NULL;
    part.weight = weights;
    (void)spari_body_residual(&part, w->q + 7 * first, w->still ? NULL : w->v + 6 * first,
                              w->still ? NULL : w->a + 6 * first, factor, r, NULL);
}

/* Force of each point mass of element e on the beam; their weights are then 0. */
static void take_masses(const spari_beyond *b, line_forces *on, const spari_inertial *w, double factor, int e,
                        double *weights) {
    const spar_member *m = b->member;
    const spari_body *body = m->body;
    const int P = m->mesh.per_element, points = body->first[e + 1] - body->first[e],
              point_masses = spari_point_masses_of(m, e);
    double *at = weights + body->slot[e], r[6 * SPARI_MAX_NODES], phi[SPARI_MAX_NODES];
    int next = points - point_masses;
    for (int64_t k = 0; k < m->beam->point_masses.count && next < points; k++) {
        double xi;
        if (spari_point_mass_element(m, k, &xi) != e) {
            continue;
        }
        point_force *p = on->mass + on->masses++;
        double *alone = weights + body->slot[body->elements]; /* all others: 0 */
        memset(alone, 0, (size_t)body->slot[body->elements] * sizeof *alone);
        alone[body->slot[e] + next] = 1;
        element_inertia(body, w, factor, e, alone, r);
        at[next++] = 0;
        *p = (point_force){.element = e, .xi = xi};
        spari_lagrange(P, b->gll, b->bary, xi, phi, NULL);
        for (int l = 0; l < P; l++) {
            for (int c = 0; c < 3; c++) {
                p->x[c] += phi[l] * on->x[3 * ((int64_t)e * P + l) + c];
            }
        }
        for (int l = 0; l < P; l++) {
            add_about(p->x, on->x + 3 * ((int64_t)e * P + l), r + 6 * l, p->force);
        }
        for (int c = 0; c < 6; c++) {
            p->force[c] = -p->force[c];
        }
    }
}

/* weight: 1 of it, 0, or -1: it alone, where the nodes are. */
static int add_inertia(const spari_beyond *b, line_forces *on, int weight) {
    const spar_member *m = b->member;
    const spari_body *body = m->body;
    const int64_t n = body->unique, slots = body->slot[body->elements];
    const int lumped = m->beam->point_masses.count > 0 && (m->effects & SPAR_EFFECT_MASSES) && body->mass;
    double *workspace = spari_zalloc(25 * n + 2 * slots, sizeof *workspace), *weights = workspace + 25 * n;
    if (!workspace) {
        return SPAR_ERR_MEMORY;
    }
    const spari_inertial w = {workspace, workspace + 7 * n, workspace + 13 * n, workspace + 19 * n,
                              weight < 0 || !(m->effects & SPAR_EFFECT_INERTIA)};
    spari_inertial_fill(m, &w);
    if (weight < 0) {
        spari_member_to_unique(m, 7, m->after.q, w.q);
    }
    memcpy(weights, body->weight, (size_t)slots * sizeof *weights);
    for (int e = 0; e < m->mesh.elements && body->mass; e++) {
        double r[6 * SPARI_MAX_NODES], *to = on->spread + 6 * (int64_t)e * m->mesh.per_element;
        if (lumped) {
            take_masses(b, on, &w, weight != 0, e, weights);
        }
        element_inertia(body, &w, weight != 0, e, weights, r);
        for (int i = 0; i < 6 * m->mesh.per_element; i++) {
            to[i] -= r[i];
        }
    }
    free(workspace);
    return SPAR_OK;
}

/* ---- loads ---- */

static void gather_loads_at(const spar_member *m, line_forces *on) {
    const double *follower = spari_applied_follower(m);
    const int turns = !spari_member_is_linear_in_place(m); /* as in their nodal loads */
    if (spari_carries_loads(m)) {
        spari_applied_nodal_but_lines(m, m->after.q, on->spread);
    }
    for (int64_t i = 0; i < m->nodes; i++) {
        double at_node[6] = {0};
        for (int k = 0; k < 6; k++) {
            at_node[k] = m->load.dead[6 * i + k];
            on->spread[6 * i + k] += m->load.solved[1][6 * i + k] - at_node[k];
        }
        for (int k = 0; k < 6 && follower; k += 3) {
            double f[3];
            memcpy(f, follower + 6 * i + k, sizeof f);
            if (turns) {
                spari_rotate(m->after.q + 7 * i + 3, f, f);
            }
            for (int c = 0; c < 3; c++) {
                at_node[k + c] += f[c];
                on->spread[6 * i + k + c] -= f[c];
            }
        }
        if (m->session->joints) {
            spari_joints_on(m, i, at_node);
        }
        memcpy(on->point + 6 * i, at_node, sizeof at_node);
    }
}

/* ---- assembly ---- */

static void sum_elements(const spar_member *m, line_forces *on, int loads) {
    const int P = m->mesh.per_element;
    double lines[6];
    for (int e = m->mesh.elements - 1; e >= 0; e--) {
        double *sum = on->sum + 6 * (int64_t)e;
        for (int k = 0; k < 6; k++) {
            sum[k] = sum[6 + k];
        }
        for (int64_t i = (int64_t)e * P; i < (int64_t)(e + 1) * P; i++) {
            add_about(on->x, on->x + 3 * i, on->spread + 6 * i, sum);
            add_about(on->x, on->x + 3 * i, on->point + 6 * i, sum);
        }
        if (loads) {
            memset(lines, 0, sizeof lines);
            spari_applied_lines_beyond(m, m->after.q, on->x, e, -1, lines);
            add_about(on->x, on->x + 3 * (int64_t)e * P, lines, sum);
        }
        for (int64_t k = 0; k < on->masses; k++) {
            if (on->mass[k].element == e) {
                add_about(on->x, on->mass[k].x, on->mass[k].force, sum);
            }
        }
    }
}

/* The forces on the reference (moved 0) or on the line where it is. NULL: no memory. */
static line_forces *line_forces_of(const spari_beyond *b, int moved, int loads, int weight) {
    const spar_member *m = b->member;
    line_forces *on = spari_zalloc(1, sizeof *on);
    if (!on) {
        return NULL;
    }
    on->x = spari_zalloc(3 * m->nodes, sizeof *on->x);
    on->spread = spari_zalloc(6 * m->nodes, sizeof *on->spread);
    on->point = spari_zalloc(6 * m->nodes, sizeof *on->point);
    on->sum = spari_zalloc(6 * ((int64_t)m->mesh.elements + 1), sizeof *on->sum);
    on->mass = spari_zalloc(m->beam->point_masses.count + 1, sizeof *on->mass);
    int ok = on->x && on->spread && on->point && on->sum && on->mass;
    for (int64_t i = 0; i < 3 * m->nodes && ok; i++) {
        on->x[i] = m->xr[i] + (moved ? m->after.q[7 * (i / 3) + i % 3] : 0);
    }
    if (ok && loads) {
        gather_loads_at(m, on);
    }
    if (!ok || add_inertia(b, on, weight) != SPAR_OK) {
        SPARI_FREE(on->mass, on->x, on->spread, on->point, on->sum, on);
        return NULL;
    }
    sum_elements(m, on, loads);
    return on;
}

/* Weight moves with a linear member at rest, as in its equations (floating/frame.h); all other forces stay. */
spari_beyond *spari_beyond_create(const spar_member *m) {
    spari_beyond *b = spari_zalloc(1, sizeof *b);
    if (!b) {
        return NULL;
    }
    b->member = m;
    spari_gll(m->mesh.per_element, b->gll, NULL, b->bary);
    spari_gauss(m->mesh.per_element, b->gauss, b->weight);
    const int undeformed = spari_member_is_undeformed(m),
              apart = undeformed && m->body && spari_norm(m->body->gravity) > 0;
    b->on[!undeformed] = line_forces_of(b, !undeformed, 1, !apart);
    b->on[1] = apart ? line_forces_of(b, 1, 0, -1) : b->on[1];
    if (!b->on[!undeformed] || (apart && !b->on[1])) {
        spari_beyond_free(b);
        return NULL;
    }
    return b;
}

/* Distributed loads on the station's element beyond it: forces by their shares. Their moment is the integral of the
   line's slope times the force beyond, which Gauss quadrature integrates exactly. */
static void add_share(const spari_beyond *b, const line_forces *on, const spari_station *s, double force[6]) {
    const int P = b->member->mesh.per_element;
    const int64_t from = (int64_t)s->element * P;
    double share[SPARI_MAX_NODES], phi[SPARI_MAX_NODES], dphi[SPARI_MAX_NODES];
    const double half = 0.5 * (1 - s->xi);
    spari_share_beyond(P, b->gll, s->xi, share);
    for (int l = 0; l < P; l++) {
        for (int k = 0; k < 6; k++) {
            force[k] += share[l] * on->spread[6 * (from + l) + k];
        }
    }
    for (int g = 0; g < P; g++) {
        const double at = s->xi + half * (1 + b->gauss[g]);
        double slope[3] = {0}, f[3] = {0}, moment[3];
        spari_lagrange(P, b->gll, b->bary, at, phi, dphi);
        spari_share_beyond(P, b->gll, at, share);
        for (int l = 0; l < P; l++) {
            for (int k = 0; k < 3; k++) {
                slope[k] += dphi[l] * on->x[3 * (from + l) + k];
                f[k] += share[l] * on->spread[6 * (from + l) + k];
            }
        }
        spari_cross(slope, f, moment);
        for (int k = 0; k < 3; k++) {
            force[3 + k] += half * b->weight[g] * moment[k];
        }
    }
}

static void forces_beyond(const spari_beyond *b, const line_forces *on, int loads, const spari_station *s,
                          double force[6]) {
    const int P = b->member->mesh.per_element;
    const double *sum = on->sum + 6 * ((int64_t)s->element + 1), near = 1e-9;
    double x[3] = {0}, phi[SPARI_MAX_NODES], moment[3];
    spari_lagrange(P, b->gll, b->bary, s->xi, phi, NULL);
    for (int l = 0; l < P; l++) {
        for (int k = 0; k < 3; k++) {
            x[k] += phi[l] * on->x[3 * ((int64_t)s->element * P + l) + k];
        }
    }
    const double arm[3] = {on->x[0] - x[0], on->x[1] - x[1], on->x[2] - x[2]};
    spari_cross(arm, sum, moment);
    for (int k = 0; k < 3; k++) {
        force[k] = sum[k];
        force[3 + k] = sum[3 + k] + moment[k];
    }
    for (int l = 1; l < P; l++) { /* the first node belongs to the root or to the element before */
        int64_t i = (int64_t)s->element * P + l;
        if (b->gll[l] >= s->xi - near) {
            add_about(x, on->x + 3 * i, on->point + 6 * i, force);
        }
    }
    for (int64_t k = 0; k < on->masses; k++) {
        if (on->mass[k].element == s->element && on->mass[k].xi >= s->xi - near && on->mass[k].xi > -1) {
            add_about(x, on->mass[k].x, on->mass[k].force, force);
        }
    }
    add_share(b, on, s, force);
    if (loads) {
        spari_applied_lines_beyond(b->member, b->member->after.q, on->x, s->element, s->xi, force);
    }
}

void spari_beyond_at(const spari_beyond *b, const spari_station *s, double force[2][6]) {
    memset(force, 0, 2 * sizeof *force);
    for (int k = 0; k < 2; k++) {
        if (b->on[k]) {
            forces_beyond(b, b->on[k], k == 0 || !b->on[0], s, force[k]);
        }
    }
}
