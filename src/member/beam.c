/* Discretises a described beam: nodes along its line, sections at quadrature points, quadrature over elements. */
#include "beam.h"

#include "../algebra/dense.h"
#include "../base/session.h"
#include "../math/basis.h"
#include "../math/rotation.h"

#include <stdlib.h>
#include <string.h>

void spari_beam_free(spari_beam *beam) {
    if (!beam) {
        return;
    }
    SPARI_FREE(beam->eta, beam->xyz, beam->twist, beam->node_x, beam->node_q, beam->section_eta, beam->stiffness,
               beam->mass, beam->point_masses.eta, beam->point_masses.value, beam->springs.eta, beam->springs.value,
               beam->pretension.eta, beam->pretension.value, beam);
}

static int no_memory_for(const spar_member *member, const char *what) {
    return spari_fail(member->session, SPAR_ERR_MEMORY, "member '%s': no memory for %s", member->name, what);
}

/* ---- frames ---- */

static double twist_at(const spari_beam *beam, double eta) {
    if (!beam->twist) {
        return 0;
    }
    int64_t i = 0, n = beam->axis_count;
    while (i < n - 2 && eta > beam->eta[i + 1]) {
        i++;
    }
    double s = (eta - beam->eta[i]) / (beam->eta[i + 1] - beam->eta[i]);
    s = fmin(fmax(s, 0), 1);
    return (1 - s) * beam->twist[i] + s * beam->twist[i + 1];
}

/* A point of the line: position, unit tangent, Jacobian ds/dxi. */
typedef struct line_point {
    double x[3], t[3], jacobian;
} line_point;

static void line_at(int P, const double *gll, const double *bary, const double *x, double xi, line_point *p) {
    double phi[SPARI_MAX_NODES], dphi[SPARI_MAX_NODES];
    spari_lagrange(P, gll, bary, xi, phi, dphi);
    memset(p, 0, sizeof *p);
    for (int l = 0; l < P; l++) {
        for (int i = 0; i < 3; i++) {
            p->x[i] += phi[l] * x[3 * l + i];
            p->t[i] += dphi[l] * x[3 * l + i];
        }
    }
    p->jacobian = spari_norm(p->t);
    for (int i = 0; i < 3; i++) {
        p->t[i] /= p->jacobian > 0 ? p->jacobian : 1;
    }
}

/* y axis of the untwisted section, unit(z x tangent), if the tangent is not close to z */
static double level_y(const double t[3], double y[3]) {
    double n = hypot(t[0], t[1]);
    y[0] = n > 0 ? -t[1] / n : 0, y[1] = n > 0 ? t[0] / n : 1, y[2] = 0;
    return n;
}

/* Rotates y, perpendicular to the unit vector `from`, by the smallest rotation that takes `from` to `to`. */
static void turn(const double from[3], const double to[3], double y[3]) {
    const double f = spari_dot(y, to) / (1 + spari_dot(from, to));
    for (int i = 0; i < 3; i++) {
        y[i] -= f * (from[i] + to[i]);
    }
}

/* Transports y from one point of the line to the next with the smallest rotation: double reflection, Wang, Juttler,
   Zheng & Liu, ACM Trans. Graph. 27 (2008). At one place, a corner, the line turns. */
static void transport(const line_point *from, const line_point *to, double y[3]) {
    double v[3], t[3], w[3];
    for (int i = 0; i < 3; i++) {
        v[i] = to->x[i] - from->x[i];
    }
    double c = spari_dot(v, v);
    if (c > 0) {
        double fy = 2 * spari_dot(v, y) / c, ft = 2 * spari_dot(v, from->t) / c;
        for (int i = 0; i < 3; i++) {
            y[i] -= fy * v[i];
            t[i] = from->t[i] - ft * v[i];
            w[i] = to->t[i] - t[i];
        }
        double cw = spari_dot(w, w), fw = cw > 0 ? 2 * spari_dot(w, y) / cw : 0;
        for (int i = 0; i < 3; i++) {
            y[i] -= fw * w[i];
        }
    } else {
        turn(from->t, to->t, y);
    }
    double along = spari_dot(y, to->t);
    for (int i = 0; i < 3; i++) {
        y[i] -= along * to->t[i];
    }
    double n = spari_norm(y);
    for (int i = 0; i < 3; i++) {
        y[i] /= n;
    }
}

/* R (columns: tangent, y, z) of a section with given untwisted y */
static void frame(const double t[3], const double y0[3], double twist, double R[9]) {
    double z0[3], c = cos(twist), s = sin(twist), y[3], z[3];
    spari_cross(t, y0, z0);
    for (int i = 0; i < 3; i++) {
        y[i] = c * y0[i] + s * z0[i];
    }
    spari_cross(t, y, z);
    for (int i = 0; i < 3; i++) {
        R[3 * i] = t[i], R[3 * i + 1] = y[i], R[3 * i + 2] = z[i];
    }
}

/* Orientation of sections along the line: level if the described line is nowhere close to z, otherwise transported
   from the root. The host's description decides, so that the axes do not depend on the nodes. */
typedef struct framing {
    int carried;
    double *y; /* transported: untwisted y at the nodes, [nodes][3] */
} framing;

/* Sines of the tangent's angle to z: 10 degrees, below which level sections rotate fast along the line; and the
   limit at which a root has no level section. */
static const double steep = 0.17364817766693033, vertical = 1e-3;

/* Smallest sine of the angle between tangents and z, at the given nodes or at the axis points; and at the root. */
static int steepest(const spar_member *member, const double *gll, const double *bary, const double *x, double *least,
                    double *root) {
    const int P = member->mesh.per_element;
    double y[3], t[3];
    *least = *root = 1;
    if (member->beam->node_x) {
        for (int64_t i = 0; i < member->nodes; i++) {
            line_point p;
            line_at(P, gll, bary, x + 3 * (i / P) * P, gll[i % P], &p);
            const double sine = level_y(p.t, y);
            *root = i == 0 ? sine : *root;
            *least = fmin(*least, sine);
        }
        return SPAR_OK;
    }
    spari_pieces pieces;
    SPARI_TRY(spari_axis_pieces(member, &pieces));
    for (int64_t k = 0; k < pieces.count; k++) {
        for (int64_t i = pieces.first[k]; i <= pieces.first[k + 1]; i++) {
            spari_axis_tangent(member->beam, &pieces, k, i, t);
            const double sine = level_y(t, y);
            *root = i == 0 ? sine : *root;
            *least = fmin(*least, sine);
        }
    }
    free(pieces.first);
    return SPAR_OK;
}

static int make_framing(const spar_member *member, const double *gll, const double *bary, const double *x, framing *f) {
    int P = member->mesh.per_element;
    line_point p, q;
    memset(f, 0, sizeof *f);
    double y[3], least, root;
    SPARI_TRY(steepest(member, gll, bary, x, &least, &root));
    f->carried = least < steep;
    if (!f->carried) {
        return SPAR_OK;
    }
    f->y = spari_zalloc(3 * member->nodes, sizeof *f->y);
    if (!f->y) {
        return no_memory_for(member, "its frames");
    }
    line_at(P, gll, bary, x, -1, &p);
    (void)level_y(p.t, y);
    if (root < vertical) { /* global y, perpendicular to the tangent */
        y[0] = -p.t[1] * p.t[0], y[1] = 1 - p.t[1] * p.t[1], y[2] = -p.t[1] * p.t[2];
        double n = spari_norm(y);
        y[0] /= n, y[1] /= n, y[2] /= n;
    }
    for (int64_t i = 0; i < member->nodes; i++) {
        line_at(P, gll, bary, x + 3 * (i / P) * P, gll[i % P], &q);
        if (i % P == 0) {
            memcpy(q.x, p.x, sizeof q.x); /* the node that elements share */
        }
        transport(&p, &q, y);
        memcpy(f->y + 3 * i, y, 3 * sizeof *y);
        p = q;
    }
    return SPAR_OK;
}

static void frame_at(const spar_member *member, const framing *f, const double *gll, const double *bary,
                     const double *x, int e, double xi, double R[9]) {
    int P = member->mesh.per_element, below = 0;
    const double *xe = x + 3 * (int64_t)e * P;
    line_point p, q;
    double y[3];
    line_at(P, gll, bary, xe, xi, &q);
    if (f->carried) {
        while (below < P - 1 && gll[below + 1] <= xi) {
            below++;
        }
        line_at(P, gll, bary, xe, gll[below], &p);
        memcpy(y, f->y + 3 * ((int64_t)e * P + below), sizeof y);
        transport(&p, &q, y);
    } else {
        level_y(q.t, y);
    }
    frame(q.t, y, twist_at(member->beam, 0.5 * (1 + spari_member_xi(member, e, xi))), R);
}

/* ---- nodes ---- */

/* Nodes in the beam's own frame, before placement: x and, if requested, q. */
static int own_nodes(const spar_member *member, const double *gll, const double *bary, double *x, double *q) {
    const spari_beam *beam = member->beam;
    int P = member->mesh.per_element;
    if (beam->node_x) {
        memcpy(x, beam->node_x, (size_t)member->nodes * 3 * sizeof *x);
    } else {
        spari_pieces pieces;
        SPARI_TRY(spari_axis_pieces(member, &pieces));
        const int status = spari_axis_fit(member, &pieces, gll, bary, x);
        free(pieces.first);
        SPARI_TRY(status);
    }
    if (beam->node_q) {
        memcpy(q, beam->node_q, (size_t)member->nodes * 4 * sizeof *q);
        return SPAR_OK;
    }
    framing f;
    SPARI_TRY(make_framing(member, gll, bary, x, &f));
    for (int64_t i = 0; i < member->nodes; i++) {
        double R[9];
        frame_at(member, &f, gll, bary, x, (int)(i / P), gll[i % P], R);
        spari_matrix_quat(R, q + 4 * i);
    }
    free(f.y);
    return SPAR_OK;
}

/* Checks that the line advances between its nodes: it may neither reverse nor stop. */
static int check_forward(const spar_member *member, const double *gll, const double *bary, const double *x,
                         double length) {
    enum { PARTS = 8 };
    const int P = member->mesh.per_element;
    for (int64_t i = 1; i < member->nodes; i++) {
        const double *xe = x + 3 * (i / P) * P,
                     d[3] = {x[3 * i] - x[3 * i - 3], x[3 * i + 1] - x[3 * i - 2], x[3 * i + 2] - x[3 * i - 1]};
        line_point before, p;
        int back = 0;
        if (i % P == 0) {
            continue; /* coincident points */
        }
        line_at(P, gll, bary, xe, gll[i % P - 1], &before);
        for (int k = 1; k <= PARTS; k++, before = p) {
            line_at(P, gll, bary, xe, gll[i % P - 1] + (gll[i % P] - gll[i % P - 1]) * k / PARTS, &p);
            back |= !(spari_dot(before.t, p.t) > 0);
        }
        SPARI_REQUIRE(member->session, !back && spari_norm(d) > 1e-9 * length / member->mesh.elements,
                      SPAR_ERR_ARGUMENT,
                      "member '%s': its axis reverses or has zero length between nodes %lld and %lld; give distinct "
                      "positions in order, spaced like Gauss-Lobatto-Legendre points",
                      member->name, (long long)(i - 1), (long long)i);
    }
    return SPAR_OK;
}

/* Checks that the line advances and that sections are perpendicular to it. */
static int check_line(spar_member *member, const double *gll, const double *bary, const double *x, const double *q) {
    int P = member->mesh.per_element;
    double length = 0, far = 0;
    for (int64_t i = 1; i < member->nodes; i++) {
        double d[3] = {x[3 * i] - x[3 * i - 3], x[3 * i + 1] - x[3 * i - 2], x[3 * i + 2] - x[3 * i - 1]};
        length += spari_norm(d);
    }
    for (int k = 0; k < 3; k++) { /* positions lose digits with the distance from the origin */
        far = fmax(far, fmax(fabs(x[k]), fabs(member->placement.x[k])));
    }
    SPARI_REQUIRE(member->session, length >= 1e-9 * far && length > 0, SPAR_ERR_ARGUMENT,
                  "member '%s': its points coincide: its axis is %.3g m long; give at least 1e-9 of its distance from "
                  "the origin",
                  member->name, length);
    SPARI_TRY(check_forward(member, gll, bary, x, length));
    for (int64_t i = 0; i < member->nodes; i++) {
        line_point p;
        double along[3] = {1, 0, 0};
        line_at(P, gll, bary, x + 3 * (i / P) * P, gll[i % P], &p);
        SPARI_REQUIRE(
            member->session, p.jacobian > 1e-9 * length / member->mesh.elements, SPAR_ERR_ARGUMENT,
            "member '%s': its axis has no direction at node %lld because points coincide; give distinct positions",
            member->name, (long long)i);
        spari_rotate(q + 4 * i, along, along);
        SPARI_REQUIRE(member->session, spari_dot(along, p.t) > 0.7, SPAR_ERR_ARGUMENT,
                      "member '%s': at node %lld the section's x axis is %.0f degrees off the beam's tangent; align "
                      "the x axis of the section with the beam",
                      member->name, (long long)i, 180 / 3.14159265358979323846 * acos(fmax(-1, spari_dot(along, p.t))));
    }
    return SPAR_OK;
}

int spari_beam_place_nodes(spar_member *member) {
    double gll[SPARI_MAX_NODES], bary[SPARI_MAX_NODES];
    spari_gll(member->mesh.per_element, gll, NULL, bary);
    SPARI_TRY(own_nodes(member, gll, bary, member->xr, member->qr));
    SPARI_TRY(check_line(member, gll, bary, member->xr, member->qr));
    for (int64_t i = 0; i < member->nodes; i++) {
        double *x = member->xr + 3 * i, *q = member->qr + 4 * i;
        spari_rotate(member->placement.q, x, x);
        for (int c = 0; c < 3; c++) {
            x[c] += member->placement.x[c];
        }
        spari_quat_mul(member->placement.q, q, q);
        spari_quat_normalise(q);
    }
    return SPAR_OK;
}

/* ---- sections and quadrature ---- */

void spari_beam_table_at(int64_t n, const double *stations, const double *table, int width, double eta, double *out) {
    int64_t i = 0;
    while (i < n - 2 && eta > stations[i + 1]) {
        i++;
    }
    double s = 0;
    if (n > 1) {
        s = (eta - stations[i]) / (stations[i + 1] - stations[i]);
        s = fmin(fmax(s, 0), 1);
    }
    for (int k = 0; k < width; k++) {
        out[k] = (1 - s) * table[width * i + k] + (s > 0 ? s * table[width * (i + 1) + k] : 0);
    }
}

void spari_pretension_at(const spari_beam *beam, double eta, double out[6]) {
    spari_beam_table_at(beam->pretension.count, beam->pretension.eta, beam->pretension.value, 6, eta, out);
}

void spari_beam_section_at(const spari_beam *beam, const double *table, double eta, double out[36]) {
    spari_beam_table_at(beam->section_count, beam->section_eta, table, 36, eta, out);
}

void spari_beam_rotate_section(const double R[9], const double *C, double *out) {
    double half[36];
    for (int bi = 0; bi < 6; bi += 3) {
        for (int i = 0; i < 3; i++) {
            for (int j = 0; j < 6; j++) {
                half[6 * (bi + i) + j] =
                    R[3 * i] * C[6 * bi + j] + R[3 * i + 1] * C[6 * (bi + 1) + j] + R[3 * i + 2] * C[6 * (bi + 2) + j];
            }
        }
    }
    for (int i = 0; i < 6; i++) {
        for (int bj = 0; bj < 6; bj += 3) {
            for (int j = 0; j < 3; j++) {
                out[6 * i + bj + j] = half[6 * i + bj] * R[3 * j] + half[6 * i + bj + 1] * R[3 * j + 1] +
                                      half[6 * i + bj + 2] * R[3 * j + 2];
            }
        }
    }
}

int spari_beam_rule(const spari_beam *beam) {
    if (beam->rule >= 0) {
        return beam->rule;
    }
    return beam->section_count > 2 ? SPAR_QUADRATURE_SECTIONS : SPAR_QUADRATURE_GAUSS;
}

/* Points of element e: xi and weights, at most `room`; returns their number (also with xi NULL). By section
   intervals: a piece of relative length d gets `points` Gauss points, or by default as many as integrate its share
   of the element's polynomials. */
static int element_points(const spari_beam *beam, int elements, int e, int P, double *xi, double *w) {
    int rule = spari_beam_rule(beam);
    if (rule != SPAR_QUADRATURE_SECTIONS) {
        int n = beam->points > 0 ? beam->points : P;
        if (!xi) {
            return n;
        }
        if (rule == SPAR_QUADRATURE_LOBATTO) {
            spari_gll(n, xi, w, NULL);
            return n;
        }
        spari_gauss(n, xi, w);
        return n;
    }
    double from = -1;
    int count = 0;
    for (int64_t i = 0; i <= beam->section_count && from < 1; i++) {
        double to = i < beam->section_count ? 2 * (beam->section_eta[i] * elements - e) - 1 : 1;
        to = to > 1 - 1e-9 ? 1 : to;
        if (to - from < 1e-9) {
            continue;
        }
        double half = 0.5 * (to - from);
        int n = beam->points > 0 ? beam->points : 1 + (int)ceil(half * P);
        if (xi) {
            spari_gauss(n, xi + count, w + count);
            for (int k = count; k < count + n; k++) {
                xi[k] = from + half * (1 + xi[k]);
                w[k] *= half;
            }
        }
        count += n;
        from = to;
    }
    return count;
}

/* Reference orientation at a quadrature point: from the axis description if there is one, otherwise interpolated
   from the nodes. */
static void reference_frame(const spar_member *member, const framing *f, const double *gll, const double *bary,
                            const double *x, int e, double xi, double R[9]) {
    int P = member->mesh.per_element;
    if (!member->beam->node_q) {
        double own[9], position[9];
        frame_at(member, f, gll, bary, x, e, xi, own);
        spari_quat_matrix(member->placement.q, position);
        for (int i = 0; i < 3; i++) {
            for (int j = 0; j < 3; j++) {
                R[3 * i + j] =
                    position[3 * i] * own[j] + position[3 * i + 1] * own[3 + j] + position[3 * i + 2] * own[6 + j];
            }
        }
        return;
    }
    double phi[SPARI_MAX_NODES], q[4] = {0}, sign = 1;
    const double *qe = member->qr + 4 * (int64_t)e * P;
    spari_lagrange(P, gll, bary, xi, phi, NULL);
    for (int l = 0; l < P; l++) {
        sign = l > 0 && spari_quat_dot(qe + 4 * l, qe + 4 * l - 4) < 0 ? -sign : sign;
        for (int i = 0; i < 4; i++) {
            q[i] += sign * phi[l] * qe[4 * l + i];
        }
    }
    spari_quat_normalise(q);
    spari_quat_matrix(q, R);
}

/* Position of point i of element e; returns the line's Jacobian there. */
static double fill_place(const spar_member *member, spari_body *b, int e, int i, double xi, const double *gll,
                         const double *bary) {
    int P = b->per_element, k = b->first[e] + i;
    line_point p;
    line_at(P, gll, bary, member->xr + 3 * (int64_t)e * P, xi, &p);
    spari_lagrange(P, gll, bary, xi, b->phi + (int64_t)k * P, b->dphi + (int64_t)k * P);
    for (int l = 0; l < P; l++) {
        b->dphi[(int64_t)k * P + l] /= p.jacobian;
    }
    spari_slot_put(b->tangent, 3, b->slot[e] + i, p.t);
    memcpy(b->position + 3 * (int64_t)k, p.x, sizeof p.x);
    return p.jacobian;
}

/* Point i of element e. */
static void fill_point(const spar_member *member, spari_body *b, int e, int i, double xi, double w, const double R[9],
                       const double *gll, const double *bary, const double *mu) {
    const spari_beam *beam = member->beam;
    int slot = b->slot[e] + i;
    double eta = 0.5 * (1 + spari_member_xi(member, e, xi)), section[36], turned[36];
    b->weight[slot] = w * fill_place(member, b, e, i, xi, gll, bary);
    b->length += b->weight[slot];
    spari_beam_section_at(beam, beam->stiffness, eta, section);
    spari_beam_rotate_section(R, section, turned);
    spari_slot_put(b->C, 36, slot, turned);
    for (int j = 0; j < 3; j++) {
        b->stiffest = fmax(b->stiffest, section[7 * j]);
    }
    if (mu) { /* sqrt(mu_i mu_j) C_ij: positive semidefinite for any coupling, mu_i C_ii on the diagonal */
        for (int j = 0; j < 36; j++) {
            section[j] *= sqrt(mu[j / 6] * mu[j % 6]);
        }
        spari_beam_rotate_section(R, section, turned);
        spari_slot_put(b->D, 36, slot, turned);
    }
    if (b->pre) {
        double own[6], pre[6];
        spari_pretension_at(beam, eta, own);
        for (int j = 0; j < 6; j++) {
            const double *r = R + 3 * (j % 3), *x = own + j / 3 * 3;
            pre[j] = r[0] * x[0] + r[1] * x[1] + r[2] * x[2];
        }
        spari_slot_put(b->pre, 6, slot, pre);
    }
    if (b->mass) {
        double mass[10];
        spari_beam_section_at(beam, beam->mass, eta, section);
        spari_mass_rotate(R, section, mass);
        spari_slot_put(b->mass, 10, slot, mass);
    }
}

/* Adds the attached masses of element e after its `at` other points: weight 1, no stiffness. */
static void fill_point_masses(const spar_member *member, const framing *f, const double *x, int e, int at,
                              spari_body *b) {
    double gll[SPARI_MAX_NODES], bary[SPARI_MAX_NODES];
    spari_gll(b->per_element, gll, NULL, bary);
    for (int64_t k = 0; k < member->beam->point_masses.count; k++) {
        double xi, R[9], mass[10];
        if (spari_point_mass_element(member, k, &xi) != e) {
            continue;
        }
        (void)fill_place(member, b, e, at, xi, gll, bary);
        b->weight[b->slot[e] + at] = 1;
        reference_frame(member, f, gll, bary, x, e, xi, R);
        spari_mass_rotate(R, member->beam->point_masses.value + 36 * k, mass);
        spari_slot_put(b->mass, 10, b->slot[e] + at, mass);
        at++;
    }
}

/* Number of quadrature points per element, points[elements], and its maximum. */
static int count_points(const spar_member *member, int *points, int *most) {
    int E = member->mesh.elements, P = member->mesh.per_element;
    for (int e = 0; e < E; e++) {
        points[e] = element_points(member->beam, E, e, P, NULL, NULL);
        SPARI_REQUIRE(member->session, points[e] >= P - 1, SPAR_ERR_ARGUMENT,
                      "member '%s': element %d has %d quadrature points for %d nodes, so its stiffness is singular; "
                      "use at least %d",
                      member->name, e, points[e], P, P - 1);
        *most = points[e] > *most ? points[e] : *most;
    }
    return SPAR_OK;
}

/* All points of a body, at most `most` per element. */
static int fill_body(const spar_member *member, int most, const double mu[6], spari_body *b) {
    int E = member->mesh.elements, P = member->mesh.per_element, status = SPAR_OK;
    double gll[SPARI_MAX_NODES], bary[SPARI_MAX_NODES];
    double *xi = spari_zalloc(most, sizeof *xi), *w = spari_zalloc(most, sizeof *w),
           *x = spari_zalloc(3 * member->nodes, sizeof *x), *q = spari_zalloc(4 * member->nodes, sizeof *q);
    framing f = {0, NULL};
    status = xi && w && x && q ? SPAR_OK : no_memory_for(member, "its quadrature points");
    spari_gll(P, gll, NULL, bary);
    if (status == SPAR_OK && !member->beam->node_q) {
        status = own_nodes(member, gll, bary, x, q);
        status = status == SPAR_OK ? make_framing(member, gll, bary, x, &f) : status;
    }
    for (int e = 0; e < E && status == SPAR_OK; e++) {
        int n = element_points(member->beam, E, e, P, xi, w);
        for (int i = 0; i < n; i++) {
            double R[9];
            reference_frame(member, &f, gll, bary, x, e, xi[i], R);
            fill_point(member, b, e, i, xi[i], w[i], R, gll, bary, mu);
        }
        if (b->first[e + 1] - b->first[e] > n) {
            fill_point_masses(member, &f, x, e, n, b);
        }
    }
    SPARI_FREE(xi, w, x, q, f.y);
    return status;
}

/* Bending and torsion count as forces at the member's length, so that no unit of length matters. */
static void find_stiffest(spari_body *b) {
    for (int64_t slot = 0; slot < b->slot[b->elements]; slot++) {
        double section[36];
        spari_slot_get(b->C, 36, slot, section);
        for (int j = 3; j < 6; j++) {
            b->stiffest = fmax(b->stiffest, section[7 * j] / (b->length * b->length));
        }
    }
}

int spari_beam_build(const spar_member *member, int massive, const double mu[6], spari_body **body) {
    int *points = spari_zalloc(member->mesh.elements, sizeof *points), most = 0;
    int status = points ? count_points(member, points, &most) : no_memory_for(member, "its quadrature points");
    spari_body *b = NULL;
    if (status == SPAR_OK) {
        massive = massive || (member->beam->mass && (member->effects & (SPAR_EFFECT_INERTIA | SPAR_EFFECT_GRAVITY)));
        int attached = massive && (member->effects & SPAR_EFFECT_MASSES);
        for (int e = 0; e < member->mesh.elements && attached; e++) {
            points[e] += spari_point_masses_of(member, e); /* attached masses are quadrature points too */
        }
        b = spari_body_create(member->mesh.elements, member->mesh.per_element, points, 1, mu != NULL, massive,
                              &member->session->bodies, &member->session->pool);
        if (b && (member->effects & SPAR_EFFECT_PRETENSION) && spari_body_set_pre(b)) {
            spari_body_free(b);
            b = NULL;
        }
        status = b ? fill_body(member, most, mu, b) : no_memory_for(member, "its quadrature points");
    }
    free(points);
    if (status != SPAR_OK) {
        spari_body_free(b);
        return status;
    }
    find_stiffest(b);
    spari_body_complete(b);
    *body = b;
    return SPAR_OK;
}

int spari_beam_mass_damping(const spar_member *member, spari_body *body) {
    if (member->beam->mass_damping == 0 || !body->D || !body->mass) {
        return SPAR_OK;
    }
    int given = spari_member_root_is_prescribed(member);
    double *position = given ? spari_zalloc(3 * (int64_t)body->unique, sizeof *position) : NULL;
    for (int i = 0; position && i < body->unique; i++) {
        memcpy(position + 3 * (int64_t)i, spari_member_position(member, i), 3 * sizeof *position);
    }
    if ((given && !position) || spari_body_set_mass_damping(body, member->beam->mass_damping, position)) {
        free(position);
        return no_memory_for(member, "its damping");
    }
    return SPAR_OK;
}

int spari_beam_stations(const spar_member *member, int64_t n, spari_station *s) {
    int P = member->mesh.per_element;
    double gll[SPARI_MAX_NODES], bary[SPARI_MAX_NODES], back[4];
    double *x = spari_zalloc(3 * member->nodes, sizeof *x);
    if (!x) {
        return no_memory_for(member, "its frames");
    }
    spari_gll(P, gll, NULL, bary);
    spari_quat_conj(member->placement.q, back);
    for (int64_t i = 0; i < member->nodes; i++) { /* nodes in the beam's own frame */
        double d[3];
        for (int c = 0; c < 3; c++) {
            d[c] = member->xr[3 * i + c] - member->placement.x[c];
        }
        spari_rotate(back, d, x + 3 * i);
    }
    framing f = {0, NULL};
    int status = member->beam->node_q ? SPAR_OK : make_framing(member, gll, bary, x, &f);
    for (int64_t k = 0; k < n && status == SPAR_OK; k++) {
        line_point p;
        line_at(P, gll, bary, member->xr + 3 * (int64_t)s[k].element * P, s[k].xi, &p);
        spari_lagrange(P, gll, bary, s[k].xi, s[k].phi, s[k].dphi);
        for (int l = 0; l < P; l++) {
            s[k].dphi[l] /= p.jacobian;
        }
        memcpy(s[k].x, p.x, sizeof p.x);
        memcpy(s[k].t, p.t, sizeof p.t);
        s[k].jacobian = p.jacobian;
        reference_frame(member, &f, gll, bary, x, s[k].element, s[k].xi, s[k].R);
    }
    SPARI_FREE(x, f.y);
    return status;
}
