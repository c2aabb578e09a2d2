/* Warns of a line that swings between its axis points: the curve leaves their polygon by more than the points bend.
   Points that nearly coincide, rounded, have a direction of their own that the curve follows far into its neighbours.
   Warns of a curve through so few points that its nodes lie far off their polygon. */
#include "../base/session.h"
#include "../math/basis.h"
#include "../math/rotation.h"
#include "beam.h"

#include <math.h>
#include <stdlib.h>

enum { SAMPLES = 8 }; /* of the curve, between two axis points */

/* Axis points nearer than this part of a neighbouring interval count as one. */
static const double near_part = 0.1;
/* Off a straight uniform path between two points, a smooth curve is at most an eighth of the interval times the change
   of its velocity dx/deta. Twice that is allowed, and besides this part of the interval. Measured with blades of 5
   shapes on 6 meshes by 3 to 24 points, a pair of them 1 to 50 mm apart, rounded to 1 and 0.1 mm. */
static const double rise = 0.25, of_chord = 5e-3;

static double separation(const double *a, const double *b) {
    return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
}

/* The points [n] that count, kept [at most n]; returns their number. */
static int64_t separate(const spari_beam *b, int64_t *kept) {
    const int64_t n = b->axis_count;
    int64_t count = 1;
    const double *x = b->xyz;
    kept[0] = 0;
    for (int64_t i = 1; i < n; i++) {
        const int64_t k = kept[count - 1];
        const double gap = separation(x + 3 * k, x + 3 * i), before = k > 0 ? separation(x + 3 * k, x + 3 * k - 3) : 0,
                     after = i + 1 < n ? separation(x + 3 * i, x + 3 * i + 3) : 0;
        if (gap >= near_part * fmax(before, after)) {
            kept[count++] = i;
        } else if (i == n - 1 && count > 1) {
            kept[count - 1] = i; /* the end stays, the point beside it goes */
        }
    }
    return count;
}

/* Point of the curve, in the beam's own frame. */
static void curve_at(const spar_member *m, const double *gll, const double *bary, double eta, double x[3]) {
    const int P = m->mesh.per_element, E = m->mesh.elements;
    const int e = (int)fmin(E - 1, fmax(0, eta * E));
    double phi[SPARI_MAX_NODES], back[4], away[3] = {0};
    spari_lagrange(P, gll, bary, fmax(-1, fmin(1, 2 * (eta * E - e) - 1)), phi, NULL);
    for (int l = 0; l < P; l++) {
        for (int c = 0; c < 3; c++) {
            away[c] += phi[l] * (m->xr[3 * ((int64_t)e * P + l) + c] - m->placement.x[c]);
        }
    }
    spari_quat_conj(m->placement.q, back);
    spari_rotate(back, away, x);
}

/* Mean velocity from one axis point to another, dx/deta. */
static void velocity(const spari_beam *b, int64_t from, int64_t to, double v[3]) {
    for (int c = 0; c < 3; c++) {
        v[c] = (b->xyz[3 * to + c] - b->xyz[3 * from + c]) / (b->eta[to] - b->eta[from]);
    }
}

/* Length of interval i over that of its longer neighbour. */
static double relative_gap(const spari_beam *b, int64_t i) {
    const double *x = b->xyz + 3 * i;
    const double before = i > 0 ? separation(x, x - 3) : 0,
                 after = i + 2 < b->axis_count ? separation(x + 3, x + 6) : 0;
    return separation(x, x + 3) / fmax(before, after);
}

static void warn_of_line(const spar_member *m, int64_t from, int64_t to, double off, double chord) {
    const spari_beam *b = m->beam;
    int64_t pair = 0;
    for (int64_t i = 1; i + 1 < b->axis_count && b->axis_count > 2; i++) {
        pair = relative_gap(b, i) < relative_gap(b, pair) ? i : pair;
    }
    if (b->axis_count > 2 && relative_gap(b, pair) < near_part) {
        spari_warn(m->session,
                   "member '%s': its line swings out by %.3g m between axis points %lld and %lld, %.3g m apart, more "
                   "than the points bend; points %lld and %lld are only %.3g m apart: leave one of them out, or give "
                   "them with more digits",
                   m->name, off, (long long)from, (long long)to, chord, (long long)pair, (long long)pair + 1,
                   separation(b->xyz + 3 * pair, b->xyz + 3 * pair + 3));
        return;
    }
    spari_warn(m->session,
               "member '%s': its line swings out by %.3g m between axis points %lld and %lld, %.3g m apart, more than "
               "the points bend; check eta and positions there; a corner belongs at an element boundary, or give more "
               "points or elements",
               m->name, off, (long long)from, (long long)to, chord);
}

/* Interval of kept points k to k + 1: how far the curve leaves its own chord, beyond what the points explain, relative
   to its length. A coarse curve that passes the points by leaves it no further than they do. */
static double excess(const spar_member *m, const double *gll, const double *bary, const int64_t *kept, int64_t count,
                     int64_t k, double *off) {
    const spari_beam *b = m->beam;
    const double from = b->eta[kept[k]], to = b->eta[kept[k + 1]];
    double ends[2][3], v[3], beside[3], change = 0;
    *off = 0;
    curve_at(m, gll, bary, from, ends[0]);
    curve_at(m, gll, bary, to, ends[1]);
    velocity(b, kept[k], kept[k + 1], v);
    for (int i = 0; i < SAMPLES; i++) {
        double at[3], straight[3], part = (i + 0.5) / SAMPLES;
        curve_at(m, gll, bary, from + (to - from) * part, at);
        for (int c = 0; c < 3; c++) {
            straight[c] = ends[0][c] + part * (ends[1][c] - ends[0][c]);
        }
        *off = fmax(*off, separation(at, straight));
    }
    if (k > 0) {
        velocity(b, kept[k - 1], kept[k], beside);
        change = fmax(change, separation(v, beside));
    }
    if (k + 2 < count) {
        velocity(b, kept[k + 1], kept[k + 2], beside);
        change = fmax(change, separation(v, beside));
    }
    return (*off / (to - from) - rise * change) / spari_norm(v);
}

/* Nodes further off the polygon than this part of its length are told. A quarter of a circle by 5 points has 1.2 %. */
static const double off_polygon = 0.02;

/* Distance of x from the straight line between axis points i and i + 1. */
static double from_chord(const spari_beam *b, int64_t i, const double x[3]) {
    const double *a = b->xyz + 3 * i, chord[3] = {a[3] - a[0], a[4] - a[1], a[5] - a[2]},
                 arm[3] = {x[0] - a[0], x[1] - a[1], x[2] - a[2]};
    const double part = fmax(0, fmin(1, spari_dot(arm, chord) / spari_dot(chord, chord)));
    double foot[3];
    for (int c = 0; c < 3; c++) {
        foot[c] = a[c] + part * chord[c];
    }
    return separation(foot, x);
}

static void tell_few_points(const spar_member *m, const double *gll, const double *bary) {
    const spari_beam *b = m->beam;
    const int P = m->mesh.per_element;
    double length = 0, most = 0;
    int64_t at = 0, between = 0;
    for (int64_t i = 0; i + 1 < b->axis_count; i++) {
        length += separation(b->xyz + 3 * i, b->xyz + 3 * i + 3);
    }
    for (int64_t i = 0; i < m->nodes; i++) {
        const double eta = 0.5 * (1 + spari_member_xi(m, (int)(i / P), gll[i % P]));
        double x[3];
        curve_at(m, gll, bary, eta, x);
        while (between + 2 < b->axis_count && b->eta[between + 1] < eta) {
            between++;
        }
        const double off = from_chord(b, between, x);
        if (off > most) {
            most = off, at = between;
        }
    }
    if (most > off_polygon * length) {
        spari_warn(m->session,
                   "member '%s': a curve is fitted through its %lld axis points, whose nodes lie up to %.3g m off the "
                   "straight lines between the points (between %lld and %lld); give more points of the curve; where "
                   "the line has a corner, let an element end there",
                   m->name, (long long)b->axis_count, most, (long long)at, (long long)at + 1);
    }
}

void spari_beam_tell_line(const spar_member *m) {
    const spari_beam *b = m->beam;
    double gll[SPARI_MAX_NODES], bary[SPARI_MAX_NODES], most = of_chord, off, told = 0;
    int64_t *kept = b->eta ? spari_zalloc(b->axis_count, sizeof *kept) : NULL, worst = 0;
    if (!kept) {
        return; /* nodes were given instead; or no memory, and the line is none the worse */
    }
    spari_gll(m->mesh.per_element, gll, NULL, bary);
    const int64_t count = separate(b, kept);
    for (int64_t k = 0; k + 1 < count; k++) {
        const double more = excess(m, gll, bary, kept, count, k, &off);
        if (more > most) {
            most = more, worst = k, told = off;
        }
    }
    if (told > 0) {
        warn_of_line(m, kept[worst], kept[worst + 1], told,
                     separation(b->xyz + 3 * kept[worst], b->xyz + 3 * kept[worst + 1]));
    } else {
        tell_few_points(m, gll, bary);
    }
    free(kept);
}
