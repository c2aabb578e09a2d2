/* The line through a beam's axis points: its corners, and the curves between them. */
#include "../algebra/dense.h"
#include "../base/session.h"
#include "../math/basis.h"
#include "../math/rotation.h"
#include "../math/spline.h"
#include "beam.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- corners ---- */

static const double degrees = 180 / 3.14159265358979323846;
/* Degrees. What turns by more at one point is a corner, whatever its neighbours do: a circle has nine points and more.
 */
static const double plain = 40;
/* Degrees. A corner on an element boundary is kept from here on: a smooth curve through it would leave the chords by
   turn / 8, 0.2 % of their length. */
static const double least = 1;
/* A smooth line turns at a point by its curvature times half of both chords. What turns more than this many times as
   much as the curvature at the neighbouring points explains is a corner. */
static const double of_neighbours = 3;
/* Degrees. What turns by more goes back on itself. */
static const double back = 175;

/* How the line turns at axis point i: the angle in degrees about a unit axis, and half of the length of its chords. */
typedef struct bend {
    double angle, axis[3], half;
} bend;

static bend bend_at(const spari_beam *b, int64_t i) {
    bend t = {0};
    if (i <= 0 || i >= b->axis_count - 1) {
        return t;
    }
    const double *x = b->xyz + 3 * i;
    double in[3], out[3];
    for (int c = 0; c < 3; c++) {
        in[c] = x[c] - x[c - 3];
        out[c] = x[c + 3] - x[c];
    }
    spari_cross(in, out, t.axis);
    const double sine = spari_norm(t.axis);
    for (int c = 0; c < 3; c++) {
        t.axis[c] /= sine > 0 ? sine : 1;
    }
    t.half = 0.5 * (spari_norm(in) + spari_norm(out));
    t.angle = degrees * atan2(sine, spari_dot(in, out));
    return t;
}

/* Whether the bend at axis point i, on an element boundary, is a corner. */
static int is_corner(const spari_beam *b, int64_t i, const bend *t) {
    double explained = 0;
    for (int64_t j = i - 1; j <= i + 1; j += 2) {
        const bend near = bend_at(b, j);
        if (near.half > 0) { /* a bend to the other side explains nothing */
            explained = fmax(explained, near.angle / near.half * t->half * spari_dot(near.axis, t->axis));
        }
    }
    return t->angle > plain || (t->angle >= least && t->angle > of_neighbours * explained);
}

/* Boundary of two elements on which axis point i lies, 1 to elements - 1; or -1. */
static int64_t boundary_of(const spar_member *member, int64_t i) {
    const double along = member->beam->eta[i] * member->mesh.elements, nearest = round(along);
    return fabs(along - nearest) <= 1e-9 * member->mesh.elements && nearest > 0 && nearest < member->mesh.elements
               ? (int64_t)nearest
               : -1;
}

static int check_bend(const spar_member *member, int64_t i, double angle) {
    const int elements = member->mesh.elements;
    const double eta = member->beam->eta[i];
    SPARI_REQUIRE(member->session, angle < back, SPAR_ERR_ARGUMENT,
                  "member '%s': its axis reverses at axis point %lld (eta %g); give distinct positions in order",
                  member->name, (long long)i, eta);
    SPARI_REQUIRE(
        member->session, angle <= plain || boundary_of(member, i) >= 0, SPAR_ERR_ARGUMENT,
        "member '%s': its axis has a corner of %.0f degrees at axis point %lld (eta %g), inside element %d of "
        "%d; let an element end there (eta a multiple of 1/elements), or give more points of the curve",
        member->name, angle, (long long)i, eta, (int)(eta * elements) + 1, elements);
    return SPAR_OK;
}

int spari_axis_pieces(const spar_member *member, spari_pieces *pieces) {
    const spari_beam *b = member->beam;
    pieces->count = 1;
    pieces->first = spari_zalloc(b->axis_count + 1, sizeof *pieces->first);
    SPARI_REQUIRE(member->session, pieces->first, SPAR_ERR_MEMORY, "member '%s': no memory for its axis", member->name);
    int64_t last = 0;
    for (int64_t i = 1; i < b->axis_count - 1; i++) {
        const bend t = bend_at(b, i);
        const int status = check_bend(member, i, t.angle);
        if (status != SPAR_OK) {
            free(pieces->first);
            return status;
        }
        if (boundary_of(member, i) > last && is_corner(b, i, &t)) { /* a piece has an element at least */
            last = boundary_of(member, i);
            pieces->first[pieces->count++] = i;
        }
    }
    pieces->first[pieces->count] = b->axis_count - 1;
    return SPAR_OK;
}

/* Tangent of the parabola through the point and its neighbours in the piece; with two points, of their chord. */
void spari_axis_tangent(const spari_beam *b, const spari_pieces *pieces, int64_t k, int64_t i, double t[3]) {
    const int64_t begin = pieces->first[k], end = pieces->first[k + 1], n = end - begin < 2 ? 2 : 3, last = end + 1 - n,
                  from = i - 1 < begin  ? begin
                         : i - 1 < last ? i - 1
                                        : last;
    const double *eta = b->eta + from, *x = b->xyz + 3 * from;
    memset(t, 0, 3 * sizeof *t);
    for (int64_t j = 0; j < n; j++) {
        double slope = 0, below = 1;
        for (int64_t l = 0; l < n; l++) { /* of Lagrange polynomial j */
            double others = 1;
            for (int64_t o = 0; o < n; o++) {
                others *= o == j || o == l ? 1 : b->eta[i] - eta[o];
            }
            slope += l == j ? 0 : others;
            below *= l == j ? 1 : eta[j] - eta[l];
        }
        for (int c = 0; c < 3; c++) {
            t[c] += slope / below * x[3 * j + c];
        }
    }
    const double size = spari_norm(t);
    for (int c = 0; c < 3 && size > 0; c++) {
        t[c] /= size;
    }
}

/* ---- nodes ---- */

/* Axis points of one piece, and the elements that they lie on, up to but without `end`. */
typedef struct piece {
    int64_t n;
    const double *eta, *xyz;
    int begin, end;
} piece;

static piece piece_of(const spar_member *member, const spari_pieces *pieces, int64_t k) {
    const spari_beam *b = member->beam;
    const int64_t from = pieces->first[k], to = pieces->first[k + 1];
    return (piece){to - from + 1, b->eta + from, b->xyz + 3 * from, k == 0 ? 0 : (int)boundary_of(member, from),
                   k == pieces->count - 1 ? member->mesh.elements : (int)boundary_of(member, to)};
}

static double eta_of_node(const spar_member *member, const double *gll, int64_t i) {
    const int P = member->mesh.per_element;
    return 0.5 * (1 + spari_member_xi(member, (int)(i / P), gll[i % P]));
}

/* With few points: the polynomial through all of them (Lagrange), exact on every element. */
static void through_points(const piece *p, double eta, double x[3]) {
    double sum = 0, total[3] = {0};
    for (int64_t i = 0; i < p->n; i++) {
        double w = 1;
        for (int64_t j = 0; j < p->n; j++) {
            w *= j == i ? 1 : (eta - p->eta[j]) / (p->eta[i] - p->eta[j]);
        }
        sum += w;
        for (int c = 0; c < 3; c++) {
            total[c] += w * p->xyz[3 * i + c];
        }
    }
    for (int c = 0; c < 3; c++) {
        x[c] = total[c] / sum;
    }
}

/* Least squares on one element: unknown inner nodes, ends given. Axis points count fully; a spline through all the
   points counts so little (1e-7) that it decides only what the points leave open. */
static int fit_element(const piece *p, double e0, double e1, int P, const double *gll, const double *bary,
                       const double *spline, double *x) {
    int64_t first = 0, last = p->n - 1;
    while (first < last && p->eta[first] < e0) {
        first++;
    }
    while (last > first && p->eta[last] > e1) {
        last--;
    }
    int inner = P - 2, points = p->eta[first] <= e1 && p->eta[last] >= e0 ? (int)(last - first + 1) : 0;
    int rows = points + inner;
    double *A = spari_zalloc((int64_t)rows * (inner + 3), sizeof *A), *b = A + (int64_t)rows * inner;
    for (int i = 0; i < rows && A; i++) {
        double phi[SPARI_MAX_NODES],
            xi = i < points ? 2 * (p->eta[first + i] - e0) / (e1 - e0) - 1 : gll[1 + i - points];
        const double *data = i < points ? p->xyz + 3 * (first + i) : spline + 3 * (1 + i - points);
        double weight = i < points ? 1 : 1e-7;
        spari_lagrange(P, gll, bary, xi, phi, NULL);
        for (int j = 0; j < inner; j++) {
            A[(int64_t)inner * i + j] = weight * phi[1 + j];
        }
        for (int d = 0; d < 3; d++) {
            double ends = phi[0] * x[d] + phi[P - 1] * x[3 * (P - 1) + d];
            b[(int64_t)rows * d + i] = weight * (data[d] - ends);
        }
    }
    int bad = !A || spari_least_squares(rows, inner, A, 3, b) != SPAR_OK;
    for (int i = 0; i < 3 * inner && !bad; i++) {
        x[3 + i] = b[(int64_t)rows * (i % 3) + i / 3];
    }
    free(A);
    return bad;
}

/* x: the spline through the piece's points, at the nodes of its elements. column [n]: workspace. */
static int spline_at_nodes(const spar_member *member, const piece *p, const double *gll, double *column, double *x) {
    const int64_t from = (int64_t)p->begin * member->mesh.per_element, to = (int64_t)p->end * member->mesh.per_element;
    int bad = 0;
    for (int d = 0; d < 3 && !bad; d++) {
        for (int64_t i = 0; i < p->n; i++) {
            column[i] = p->xyz[3 * i + d];
        }
        spari_spline spline;
        int64_t interval = 0;
        bad = spari_spline_create(&spline, SPARI_SPLINE_CUBIC, p->n, p->eta, column);
        for (int64_t i = from; i < to && !bad; i++) {
            double eta = fmin(fmax(eta_of_node(member, gll, i), p->eta[0]), p->eta[p->n - 1]);
            x[3 * (i - from) + d] = spari_spline_at(&spline, eta, &interval, NULL);
        }
        spari_spline_free(&spline);
    }
    return bad;
}

/* The ends of the piece are exact; element boundaries within it lie on the spline (or on an axis point there). */
static int fit_piece(const spar_member *member, const piece *p, const double *gll, const double *bary, double *x) {
    const int E = member->mesh.elements, P = member->mesh.per_element;
    double *column = spari_zalloc(p->n, sizeof *column),
           *spline = spari_zalloc(3 * (int64_t)(p->end - p->begin) * P, sizeof *spline);
    int bad = !column || !spline || spline_at_nodes(member, p, gll, column, spline);
    for (int e = p->begin; e < p->end && !bad; e++) {
        double *xe = x + 3 * (int64_t)e * P, *se = spline + 3 * (int64_t)(e - p->begin) * P;
        memcpy(xe, e == p->begin ? p->xyz : se, 3 * sizeof *xe);
        memcpy(xe + 3 * (P - 1), e == p->end - 1 ? p->xyz + 3 * (p->n - 1) : se + 3 * (P - 1), 3 * sizeof *xe);
        bad = P > 2 && fit_element(p, (double)e / E, (double)(e + 1) / E, P, gll, bary, se, xe);
    }
    free(column);
    free(spline);
    return bad;
}

int spari_axis_fit(const spar_member *member, const spari_pieces *pieces, const double *gll, const double *bary,
                   double *x) {
    const int P = member->mesh.per_element;
    for (int64_t k = 0; k < pieces->count; k++) {
        const piece p = piece_of(member, pieces, k);
        if (p.n > P) {
            SPARI_REQUIRE(member->session, fit_piece(member, &p, gll, bary, x) == 0, SPAR_ERR_MEMORY,
                          "member '%s': no memory for the fit of its axis", member->name);
            continue;
        }
        const int64_t from = (int64_t)p.begin * P, to = (int64_t)p.end * P - 1;
        for (int64_t i = from; i <= to; i++) {
            through_points(&p, eta_of_node(member, gll, i), x + 3 * i);
        }
        memcpy(x + 3 * from, p.xyz, 3 * sizeof *x);
        memcpy(x + 3 * to, p.xyz + 3 * (p.n - 1), 3 * sizeof *x);
    }
    return SPAR_OK;
}
