/* Nodes given in the present configuration: finds the reference positions that the member's motion moves there. */
#include "../base/environment.h"
#include "../math/brent.h"
#include "../math/rotation.h"
#include "../transfer/projection.h"
#include "state.h"
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A node and an element of the line. The node belongs to the section whose plane, normal to the reference line and
   moved with the section, contains it: in the reference its nearest point has a lever arm normal to the line. */
typedef struct section_search {
    const spar_fluid *fluid;
    const spari_line *reference;
    const double *x;
    int element;
} section_search;

/* Present position and rotation of the line. */
static void present_pose(const spar_fluid *fluid, int element, double xi, double x[3], double q[4]) {
    int modes = fluid->member->mesh.per_element;
    const double *c = fluid->field[0] + (ptrdiff_t)element * modes * SPARI_FIELDS;
    spari_fluid_series(c, modes, SPARI_F_POSITION, 3, xi, x);
    spari_fluid_series(c, modes, SPARI_F_QUAT, 4, xi, q);
    spari_quat_normalise(q);
}

/* How far the node is ahead of the section's plane, m. */
static double ahead_of_section(double xi, void *self) {
    const section_search *s = self;
    double x[3], q[4], at[3], tangent[3], normal[3];
    present_pose(s->fluid, s->element, xi, x, q);
    spari_line_point(s->reference, s->element, xi, at, tangent);
    spari_rotate(q, tangent, normal);
    for (int i = 0; i < 3; i++) {
        at[i] = s->x[i] - x[i];
    }
    return spari_dot(at, normal) / spari_norm(normal);
}

/* The section next to the nearest point of the present line, which shear and strain move away from the section. Beyond
   an end of the line, and at a corner, it is the end or corner. */
static double find_section(section_search *s, double xi) {
    const int last = s->fluid->member->mesh.elements - 1;
    double here = ahead_of_section(xi, s), step = 1. / 64;
    int way = here > 0 ? 1 : -1;
    while (here != 0) {
        double to = way > 0 ? fmin(xi + step, 1) : fmax(xi - step, -1);
        if (to == xi) { /* an element boundary */
            if (s->element == (way > 0 ? last : 0)) {
                return xi;
            }
            s->element += way;
            double there = ahead_of_section(-xi, s);
            if ((there > 0) != (here > 0)) {
                s->element -= way > 0; /* a boundary belongs to the lower element */
                return 1;
            }
            xi = -xi, here = there;
            continue;
        }
        double there = ahead_of_section(to, s);
        if ((there > 0) != (here > 0) || there == 0) {
            return spari_brent(ahead_of_section, s, xi, to, 4 * DBL_EPSILON, 100);
        }
        xi = to, here = there, step *= 2;
    }
    return xi;
}

static double *present_line(const spar_member *m) {
    double *x = spari_zalloc(3 * m->nodes, sizeof *x);
    for (int64_t i = 0; x && i < 3 * m->nodes; i++) {
        x[i] = m->xr[i] + m->after.q[7 * (i / 3) + i % 3];
    }
    return x;
}

int spari_fluid_project_on_present(const spar_fluid *fluid, int64_t n, const double *x, int *element, double *xi,
                                   double *nearest) {
    const spar_member *m = fluid->member;
    double *nodes = present_line(m);
    spari_line *line = nodes ? spari_line_create(m->mesh.elements, m->mesh.per_element, nodes) : NULL;
    uint8_t *flags = spari_zalloc(n, sizeof *flags);
    int status = line && flags
                     ? spari_line_project(line, m->session->pool, fluid->method, n, x, element, xi, nearest, flags)
                     : SPAR_ERR_MEMORY;
    spari_line_free(line);
    SPARI_FREE(nodes, flags);
    return status;
}

static void fill_present(const spar_fluid *fluid) {
    const spar_member *m = fluid->member;
    spari_field_fill(m->mesh.elements, m->mesh.per_element, fluid->modal, fluid->consistent, SPARI_UPTO_POSITION, m->xr,
                     m->after.q, m->after.v, m->after.a, fluid->field[0]);
}

double *spari_fluid_reference_of_present(const spar_fluid *fluid, const spari_line *reference, int64_t n,
                                         const double *x) {
    double *to = spari_zalloc(3 * n, sizeof *to), *nearest = spari_zalloc(3 * n, sizeof *nearest),
           *xi = spari_zalloc(n, sizeof *xi);
    int *element = spari_zalloc(n, sizeof *element);
    int whole =
        to && nearest && xi && element && spari_fluid_project_on_present(fluid, n, x, element, xi, nearest) == SPAR_OK;
    fill_present(fluid);
    for (int64_t j = 0; j < n && whole; j++) {
        section_search s = {.fluid = fluid, .reference = reference, .x = x + 3 * j, .element = element[j]};
        double at = fluid->member->mesh.per_element > 1 ? find_section(&s, xi[j]) : 0, now[3], q[4], unmoved[4], arm[3];
        present_pose(fluid, s.element, at, now, q);
        for (int i = 0; i < 3; i++) {
            now[i] = x[3 * j + i] - now[i];
        }
        spari_rotate_back(q, now, arm);
        spari_fluid_reference(fluid, s.element, at, to + 3 * j, unmoved);
        for (int i = 0; i < 3; i++) {
            to[3 * j + i] += arm[i];
        }
    }
    SPARI_FREE(nearest, xi, element);
    if (!whole) {
        free(to);
        return NULL;
    }
    return to;
}

int spari_fluid_check_present(const spar_fluid *fluid, int which, const spari_nodes *s, const double *x,
                              const char *caller) {
    const spar_member *m = fluid->member;
    double length = spari_member_length(m), worst = 0;
    int64_t astray = 0, first = -1;
    fill_present(fluid);
    for (int64_t p = 0; p < s->n; p++) {
        int64_t j = spari_nodes_node(s, p);
        double now[3], q[4], con[3] = {s->con[0][p], s->con[1][p], s->con[2][p]}, arm[3];
        present_pose(fluid, spari_nodes_element(s, p), spari_nodes_xi(s, p), now, q);
        spari_rotate(q, con, arm);
        for (int i = 0; i < 3; i++) {
            now[i] += arm[i] - x[3 * j + i];
        }
        double off = spari_norm(now);
        /* as far as positions of a saved run agree (position_tolerance) */
        if (!(off <= 1e-9 * (length + spari_norm(con)) + 1e-12 * spari_norm(x + 3 * j))) {
            astray++;
            first = first < 0 || j < first ? j : first;
            worst = fmax(worst, off);
        }
    }
    SPARI_FLUID_REQUIRE_OF(fluid, caller, astray == 0, SPAR_ERR_MAPPING,
                           "%lld of %lld %s nodes have no reference position that the present motion moves where they "
                           "are (off by up to %.3g m, the first is node %lld): the member is folded there, or they are "
                           "too far from it; give their reference positions and call spar_fluid_map",
                           (long long)astray, (long long)s->n, which == SPAR_NODES_MOTION ? "motion" : "force", worst,
                           (long long)first);
    return SPAR_OK;
}
