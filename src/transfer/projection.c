/* Nearest point of a curved line, with guaranteed bounds: bounding spheres around segments, then zeros of a
   polynomial. */
#include "projection.h"

#include "../algebra/eigen.h"
#include "../base/status.h"
#include "../base/thread_pool.h"
#include "../math/rotation.h"
#include "transfer.h"
#include <complex.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The bounded search. On a segment of an element, mapped to s in [0,1], the squared distance D(s) = |r(s) - p|^2 is
   a polynomial of degree N = 2 m. Its Bernstein coefficients are affine in p, apart from |p|^2:
       D_i = G_i - 2 p . C_i + |p|^2,     G of |r|^2, C of r raised to degree N, origin in the segment.
   So a point costs 3 N multiplications per segment. With e_i = D_{i+1} - D_i:
   - D(s) lies between the smallest and the largest D_i (convex hull). A segment whose smallest D_i exceeds the best
     known distance is excluded.
   - D' has at most as many zeros as the e_i have sign changes (Descartes' rule in Bernstein form). None: D is
     monotone. One, from minus to plus: D has exactly one minimum, which guarded Newton finds. More: the segment is
     halved by de Casteljau.
   Nothing is sampled, so no minimum can be missed. Rounding errors are bounded and widen the comparisons (noise
     below). Bounding spheres (a binary tree along the line) and capsules around chords limit the search to one or
     two segments for any number of elements. */

enum {
    MODES = SPARI_MAX_NODES,
    DEGREE = 2 * (SPARI_MAX_NODES - 1), /* of the squared distance */
    ROW = DEGREE + 2,                   /* padded to whole vectors */
    DEPTH = 48,                         /* maximum halvings of a segment; its ends are then equal numbers */
    SPLITS = 6                          /* maximum halvings of an element into segments */
};

typedef struct segment {
    int element, modes; /* r has `modes` Chebyshev coefficients here; the rest is below rounding */
    double a, b;        /* local xi at its ends */
    double origin[3];
    double end[2][3]; /* chord, relative to the origin */
    double deviation; /* largest distance of the line from its chord */
    double ball;      /* largest distance of the line from the origin */
    double radius;    /* scale of rounding errors: bound of all terms of r */
    double c[MODES][4];
    double dg[ROW], dc[3][ROW], g0, c0[3]; /* differences of G_i and of -2 C_i; first entries */
    double pull[ROW], slope[MODES][3];     /* Chebyshev coefficients of r . r' and r': for all roots */
} segment;

typedef struct ball {
    double x[3], radius;
    int child[2]; /* segment: -1 - index */
} ball;

struct spari_line {
    int elements, per_element;
    double scale;     /* size of the line's bounding box */
    double origin[3]; /* centre of the box: everything below is relative to it */
    double *c;        /* Chebyshev coefficients [element][mode][4] */
    int segments, balls;
    segment *segment;
    ball *ball; /* the first is the root */
};

/* ---- polynomials ---- */

/* Position and its first and second derivative at s in [-1,1]. */
static void series(const double (*c)[4], int modes, double s, double x[4], double dx[4], double ddx[4]) {
    double t0 = 1, t1 = s, d0 = 0, d1 = 1, q0 = 0, q1 = 0;
    for (int i = 0; i < 4; i++) {
        x[i] = c[0][i], dx[i] = 0, ddx[i] = 0;
    }
    for (int k = 1; k < modes; k++) {
        for (int i = 0; i < 4; i++) {
            x[i] += c[k][i] * t1, dx[i] += c[k][i] * d1, ddx[i] += c[k][i] * q1;
        }
        double t2 = 2 * s * t1 - t0, d2 = 2 * (t1 + s * d1) - d0, q2 = 4 * d1 + 2 * s * q1 - q0;
        t0 = t1, t1 = t2, d0 = d1, d1 = d2, q0 = q1, q1 = q2;
    }
}

static void place_at(const double (*c)[4], int modes, double s, double x[3]) {
    double t0 = 1, t1 = s;
    x[0] = c[0][0], x[1] = c[0][1], x[2] = c[0][2];
    for (int k = 1; k < modes; k++) {
        for (int i = 0; i < 3; i++) {
            x[i] += c[k][i] * t1;
        }
        double t2 = 2 * s * t1 - t0;
        t0 = t1, t1 = t2;
    }
}

/* Binomials up to C(46,23) < 2^53: all exact. */
typedef struct binomials {
    double c[DEGREE + 1][DEGREE + 1];
} binomials;

static void fill_binomials(binomials *b) {
    for (int n = 0; n <= DEGREE; n++) {
        b->c[n][0] = b->c[n][n] = 1;
        for (int k = 1; k < n; k++) {
            b->c[n][k] = b->c[n - 1][k - 1] + b->c[n - 1][k];
        }
    }
}

/* Bernstein coefficients of T_k in degree k: (-1)^(k-j) C(2k,2j) / C(k,j). */
static void bernstein_of_chebyshev(int k, double *b) {
    double ratio = 1; /* C(2k,2j) / C(k,j), by recurrence in j */
    for (int j = 0; j <= k; j++) {
        b[j] = (k - j) % 2 ? -ratio : ratio;
        ratio *= (double)(2 * k - 2 * j - 1) / (2 * j + 1);
    }
}

/* Chebyshev coefficients on [-1,1] (one component) to Bernstein coefficients of degree modes - 1. */
static void bernstein(const double (*c)[4], int modes, int i, double *b) {
    double t[MODES];
    b[0] = c[0][i];
    for (int k = 1; k < modes; k++) {
        b[k] = b[k - 1];
        for (int j = k - 1; j > 0; j--) { /* raises the degree by one */
            b[j] = ((double)j * b[j - 1] + (double)(k - j) * b[j]) / k;
        }
        bernstein_of_chebyshev(k, t);
        for (int j = 0; j <= k; j++) {
            b[j] += c[k][i] * t[j];
        }
    }
}

/* Product of two polynomials of degree m in Bernstein form: degree 2 m. All weights are positive. */
static void multiply_bernstein(const binomials *b, int m, const double *f, const double *g, double *fg) {
    for (int i = 0; i <= 2 * m; i++) {
        double sum = 0;
        for (int j = i > m ? i - m : 0; j <= m && j <= i; j++) {
            sum += b->c[m][j] * b->c[m][i - j] * f[j] * g[i - j];
        }
        fg[i] = sum / b->c[2 * m][i];
    }
}

/* ---- segments ---- */

/* Chebyshev coefficients of the element's line on [a,b], from its values at the Chebyshev points. */
static void resample(const double (*c)[4], int modes, double a, double b, double (*out)[4]) {
    const double pi = 3.14159265358979323846;
    memset(out, 0, sizeof *out * (size_t)modes);
    for (int j = 0; j < modes; j++) {
        double s = cos(pi * (j + 0.5) / modes), t0 = 1, t1 = s, x[3];
        place_at(c, modes, 0.5 * (a + b) + 0.5 * (b - a) * s, x);
        for (int k = 0; k < modes; k++) {
            for (int i = 0; i < 3; i++) {
                out[k][i] += (k ? 2.0 : 1.0) / modes * t0 * x[i];
            }
            double t2 = 2 * s * t1 - t0;
            t0 = t1, t1 = t2;
        }
    }
}

static int trimmed(const double (*c)[4], int modes, double scale) {
    double tail = 0;
    while (modes > 2) {
        tail += spari_norm(c[modes - 1]);
        if (tail > 2 * DBL_EPSILON * scale) {
            break;
        }
        modes--;
    }
    return modes;
}

static double distance_to_chord(const double a[3], const double b[3], const double p[3]) {
    double u[3], v[3];
    for (int i = 0; i < 3; i++) {
        u[i] = b[i] - a[i], v[i] = p[i] - a[i];
    }
    double length = spari_dot(u, u), t = length > 0 ? spari_dot(u, v) / length : 0;
    t = t < 0 ? 0 : t > 1 ? 1 : t;
    for (int i = 0; i < 3; i++) {
        v[i] -= t * u[i];
    }
    return spari_norm(v);
}

/* Chebyshev coefficients of r' and r . r', by T_i T_j = (T_{i+j} + T_{|i-j|}) / 2. */
static void make_slopes(segment *s) {
    int m = s->modes - 1;
    for (int k = m; k > 0; k--) {
        for (int i = 0; i < 3; i++) {
            s->slope[k - 1][i] = 2 * k * s->c[k][i] + (k + 1 < m ? s->slope[k + 1][i] : 0);
        }
    }
    for (int i = 0; i < 3; i++) {
        s->slope[0][i] *= 0.5;
    }
    for (int k = 0; k <= m; k++) {
        for (int j = 0; j < m; j++) {
            double half = 0.5 * spari_dot(s->c[k], s->slope[j]);
            s->pull[k + j] += half;
            s->pull[abs(k - j)] += half;
        }
    }
}

/* All data of r on [a,b] of an element. */
static void make_segment(const spari_line *line, const binomials *bin, int element, double a, double b, segment *s) {
    double control[3][MODES], square[ROW], sum[ROW] = {0}, one[MODES], raised[ROW], peak[MODES];
    memset(s, 0, sizeof *s);
    s->element = element, s->a = a, s->b = b;
    const double(*c)[4] = (const double(*)[4])line->c + (ptrdiff_t)element * line->per_element;
    resample(c, line->per_element, a, b, s->c);
    memcpy(s->origin, s->c[0], sizeof s->origin);
    memset(s->c[0], 0, sizeof s->c[0]);
    s->modes = trimmed((const double(*)[4])s->c, line->per_element, line->scale);
    int m = s->modes - 1;
    for (int j = 0; j <= m; j++) {
        one[j] = 1;
    }
    for (int k = 1; k <= m; k++) {
        double top = 0;
        bernstein_of_chebyshev(k, peak);
        for (int j = 0; j <= k; j++) {
            top = fmax(top, fabs(peak[j]));
        }
        s->radius += top * spari_norm(s->c[k]);
    }
    for (int i = 0; i < 3; i++) {
        bernstein((const double(*)[4])s->c, s->modes, i, control[i]);
        s->end[0][i] = control[i][0], s->end[1][i] = control[i][m];
        multiply_bernstein(bin, m, control[i], control[i], square);
        multiply_bernstein(bin, m, control[i], one, raised);
        s->c0[i] = -2 * raised[0];
        for (int j = 0; j < 2 * m; j++) {
            s->dc[i][j] = -2 * (raised[j + 1] - raised[j]);
        }
        for (int j = 0; j <= 2 * m; j++) {
            sum[j] += square[j];
        }
    }
    s->g0 = sum[0];
    for (int j = 0; j < 2 * m; j++) {
        s->dg[j] = sum[j + 1] - sum[j];
    }
    for (int j = 0; j <= m; j++) {
        double p[3] = {control[0][j], control[1][j], control[2][j]};
        s->deviation = fmax(s->deviation, distance_to_chord(s->end[0], s->end[1], p));
        s->ball = fmax(s->ball, spari_norm(p));
    }
    make_slopes(s);
}

/* Whether a segment is nearly straight with its control points near it, so that it need not be split. */
static int is_plain(const segment *s) {
    double chord[3];
    for (int i = 0; i < 3; i++) {
        chord[i] = s->end[1][i] - s->end[0][i];
    }
    double length = spari_norm(chord);
    return s->deviation <= 0.05 * length && s->radius <= 2 * length;
}

/* Workspace of the subdivision, too large for a small stack. */
typedef struct cutting {
    binomials bin;
    segment s; /* the current segment */
} cutting;

/* Halves [a,b] until its parts are plain; out NULL: only counts. Returns their number. */
static int cut(const spari_line *line, cutting *with, int element, double a, double b, int splits, segment *out) {
    make_segment(line, &with->bin, element, a, b, &with->s);
    if (splits == 0 || is_plain(&with->s)) {
        if (out) {
            *out = with->s;
        }
        return 1;
    }
    double middle = 0.5 * (a + b);
    int n = cut(line, with, element, a, middle, splits - 1, out);
    return n + cut(line, with, element, middle, b, splits - 1, out ? out + n : NULL);
}

/* ---- the tree ---- */

/* Bounding sphere of segments [first, last): centre of their boxes, and largest distance from it. */
static int make_ball(spari_line *line, int first, int last) {
    if (last - first == 1) {
        return -1 - first;
    }
    int index = line->balls++;
    ball *b = &line->ball[index];
    double low[3], high[3];
    for (int i = 0; i < 3; i++) {
        low[i] = HUGE_VAL, high[i] = -HUGE_VAL;
        for (int k = first; k < last; k++) {
            low[i] = fmin(low[i], line->segment[k].origin[i] - line->segment[k].ball);
            high[i] = fmax(high[i], line->segment[k].origin[i] + line->segment[k].ball);
        }
        b->x[i] = 0.5 * (low[i] + high[i]);
    }
    for (int k = first; k < last; k++) {
        double d[3];
        for (int i = 0; i < 3; i++) {
            d[i] = line->segment[k].origin[i] - b->x[i];
        }
        b->radius = fmax(b->radius, spari_norm(d) + line->segment[k].ball);
    }
    int middle = first + (last - first) / 2;
    int left = make_ball(line, first, middle), right = make_ball(line, middle, last);
    line->ball[index].child[0] = left, line->ball[index].child[1] = right;
    return index;
}

static int build_balls(spari_line *line) {
    cutting *with = spari_zalloc(1, sizeof *with);
    int n = 0;
    if (!with) {
        return SPAR_ERR_MEMORY;
    }
    fill_binomials(&with->bin);
    for (int e = 0; e < line->elements; e++) {
        n += cut(line, with, e, -1, 1, SPLITS, NULL);
    }
    line->segment = spari_zalloc(n, sizeof *line->segment);
    line->ball = spari_zalloc(n, sizeof *line->ball);
    int whole = line->segment && line->ball;
    for (int e = 0; e < line->elements && whole; e++) {
        line->segments += cut(line, with, e, -1, 1, SPLITS, line->segment + line->segments);
    }
    free(with);
    if (!whole) {
        return SPAR_ERR_MEMORY;
    }
    if (n > 1) {
        make_ball(line, 0, n);
    }
    return SPAR_OK;
}

spari_line *spari_line_create(int elements, int per_element, const double *x) {
    spari_line *line = spari_zalloc(1, sizeof *line);
    if (!line) {
        return NULL;
    }
    line->elements = elements, line->per_element = per_element;
    line->c = spari_zalloc((int64_t)elements * per_element * 4, sizeof *line->c);
    double *m = spari_zalloc((int64_t)per_element * per_element, sizeof *m);
    if (!line->c || !m) {
        free(m);
        spari_line_free(line);
        return NULL;
    }
    for (int i = 0; i < 3; i++) {
        double low = x[i], high = x[i];
        for (ptrdiff_t l = 1; l < (ptrdiff_t)elements * per_element; l++) {
            low = fmin(low, x[3 * l + i]), high = fmax(high, x[3 * l + i]);
        }
        line->scale = fmax(line->scale, high - low);
        line->origin[i] = 0.5 * (low + high);
    }
    spari_modal_matrix(per_element, m);
    for (int e = 0; e < elements; e++) {
        ptrdiff_t node = (ptrdiff_t)e * per_element;
        for (int k = 0; k < per_element; k++) {
            for (int l = 0; l < per_element; l++) {
                for (int i = 0; i < 3; i++) {
                    line->c[4 * (node + k) + i] += m[k * per_element + l] * (x[3 * (node + l) + i] - line->origin[i]);
                }
            }
        }
    }
    free(m);
    if (per_element > 1 && build_balls(line) != SPAR_OK) {
        spari_line_free(line);
        return NULL;
    }
    return line;
}

void spari_line_free(spari_line *line) {
    if (line) {
        SPARI_FREE(line->c, line->segment, line->ball, line);
    }
}

static const double (*coefficients(const spari_line *line, int element))[4] {
    return (const double(*)[4])line->c + (ptrdiff_t)element * line->per_element;
}

void spari_line_point(const spari_line *line, int element, double xi, double x[3], double dx[3]) {
    double r[4], d[4], s[4];
    series(coefficients(line, element), line->per_element, xi, r, d, s);
    for (int i = 0; i < 3; i++) {
        x[i] = line->origin[i] + r[i];
        if (dx) {
            dx[i] = d[i];
        }
    }
}

/* ---- the search ---- */

/* Search for one point, with the best result so far. */
typedef struct search {
    const spari_line *line;
    struct part *stack; /* [DEPTH + 1]: parts of a segment not yet examined */
    double p[3];        /* relative to the line's origin */
    double square;      /* smallest squared distance found */
    double reach;       /* its root plus the tie tolerance: nothing farther is examined */
    double tie;         /* squared distances this close count as equal */
    int element;        /* element of the nearest point; -1: none yet */
    double xi;
    int ambiguous;
    int method, no_memory;
} search;

/* Distances within 2e-13 of the line's size count as equal: rounding decides between them, so xi is used instead. */
static void set_reach(search *q) {
    double d = sqrt(q->square), width = 2e-13 * q->line->scale + 8 * DBL_EPSILON * d;
    q->tie = (2 * d + width) * width;
    q->reach = d + width;
}

/* Coordinate along the line, in elements; an element boundary has the same value from both sides. */
static double along(int element, double xi) {
    return element + 0.5 * (1 + xi);
}

/* Proposes a nearest point. Of equally near points the first along the line wins. A second one is recorded as
   ambiguous, unless both are the same point (an element boundary or a split). */
static void offer(search *q, int element, double xi, double square) {
    double from = along(q->element, q->xi), to = along(element, xi);
    if (q->element < 0 ? square <= q->square + q->tie : square < q->square - q->tie) {
        q->ambiguous = 0;
    } else if (square > q->square + q->tie) {
        return;
    } else {
        if (fabs(to - from) > 5e-4) {
            q->ambiguous = 1;
        }
        if (to > from || (to == from && element >= q->element)) {
            return;
        }
    }
    q->element = element, q->xi = xi;
    if (square < q->square) {
        q->square = square;
        set_reach(q);
    }
}

static double square_at(const search *q, int element, double xi) {
    double x[3];
    place_at(coefficients(q->line, element), q->line->per_element, xi, x);
    for (int i = 0; i < 3; i++) {
        x[i] -= q->p[i];
    }
    return spari_dot(x, x);
}

static double xi_of(const segment *s, double t) {
    return t <= 0 ? s->a : t >= 1 ? s->b : s->a + (s->b - s->a) * t;
}

/* Newton on D'/2 = (r - p) . r', kept between low and high (s of the segment, in [-1,1]) by bisection. If the zero
   is not between them, returns the nearer end. */
static double refine_nearest(const segment *s, const double p[3], double low, double high, double at) {
    const double first = low, last = high, small = 2 * DBL_EPSILON;
    double before = HUGE_VAL;
    int low_known = 0, high_known = 0;
    for (int k = 0; k < 100 && high - low > small; k++) {
        double x[4], d[4], dd[4];
        series((const double(*)[4])s->c, s->modes, at, x, d, dd);
        for (int i = 0; i < 3; i++) {
            x[i] -= p[i];
        }
        double slope = spari_dot(x, d), curve = spari_dot(d, d) + spari_dot(x, dd);
        if (slope == 0 || (slope > 0 && at <= first) || (slope < 0 && at >= last)) {
            return at;
        }
        if (slope > 0) {
            high = at, high_known = 1;
        } else {
            low = at, low_known = 1;
        }
        double next = at - slope / curve;
        int newton = curve > 0;
        if (newton && next <= low) {
            next = low_known ? 0.5 * (low + high) : low, newton = 0;
        } else if (newton && next >= high) {
            next = high_known ? 0.5 * (low + high) : high, newton = 0;
        } else if (!newton) {
            next = 0.5 * (low + high);
        }
        double step = fabs(next - at);
        at = next;
        /* quadratic convergence: the next step would be about step^3 / before^2 */
        if (newton && (step <= small || (before < 1 && step * step * step <= small * before * before))) {
            break;
        }
        before = newton ? step : HUGE_VAL;
    }
    return at;
}

/* A part [t0,t1] of a segment: D at its ends, and the differences of its Bernstein coefficients. */
typedef struct part {
    double t0, t1, d0, d1, e[ROW];
} part;

static void offer_inside(search *q, const segment *s, const double p[3], const part *a, double t) {
    double found = refine_nearest(s, p, 2 * a->t0 - 1, 2 * a->t1 - 1, 2 * t - 1), xi = xi_of(s, 0.5 * (1 + found));
    offer(q, s->element, xi, square_at(q, s->element, xi));
}

/* Proposes an end where D is smallest. If rounding hides the slope of D there, uses Newton. */
static void offer_end(search *q, const segment *s, const double p[3], const part *a, int end, int hidden,
                      double noise) {
    double t = end ? a->t1 : a->t0;
    if ((end ? a->d1 : a->d0) > q->square + q->tie + noise) {
        return;
    }
    if (hidden) {
        offer_inside(q, s, p, a, t);
    } else {
        double xi = xi_of(s, t);
        offer(q, s->element, xi, square_at(q, s->element, xi));
    }
}

/* Differences of the two halves by de Casteljau; each spans half the length. */
static void halve(const part *from, int n, part *left, part *right) {
    double e[ROW], sum = 0, middle = 0.5 * (from->t0 + from->t1);
    memcpy(e, from->e, sizeof *e * (size_t)n);
    for (int k = 0; k < n; k++) {
        left->e[k] = 0.5 * e[0];
        right->e[n - 1 - k] = 0.5 * e[n - 1 - k];
        sum += left->e[k];
        for (int j = 0; j < n - 1 - k; j++) {
            e[j] = 0.5 * (e[j] + e[j + 1]);
        }
    }
    left->t0 = from->t0, left->t1 = middle, left->d0 = from->d0, left->d1 = from->d0 + sum;
    right->t0 = middle, right->t1 = from->t1, right->d0 = left->d1, right->d1 = from->d1;
}

/* Examines one part. Returns 1 if it must be halved. */
static int settle(search *q, const segment *s, const double p[3], part *a, int n, double noise, double slope_noise) {
    double sum = a->d0, low = sum, high = sum;
    int sign = 0, begin = 0, changes = 0, at = 0, lead = 0, trail = 0;
    for (int i = 0; i < n; i++) {
        double e = a->e[i];
        sum += e;
        low = sum < low ? sum : low;
        high = sum > high ? sum : high;
        int now = (e > slope_noise) - (e < -slope_noise);
        trail = now ? 0 : trail + 1;
        if (now && now != sign) {
            changes += sign != 0;
            lead = sign ? lead : i;
            begin = begin ? begin : now;
            at = i;
            sign = now;
        }
    }
    a->d1 = sum;
    if (low > q->square + q->tie + noise) {
        return 0;
    }
    if (changes == 0) { /* monotone, or constant: an end is the minimum */
        if (begin >= 0) {
            offer_end(q, s, p, a, 0, begin && lead, noise);
        }
        if (begin <= 0) {
            offer_end(q, s, p, a, 1, begin && trail, noise);
        }
        return 0;
    }
    if (changes == 1 && begin > 0) { /* a maximum */
        offer_end(q, s, p, a, 0, lead, noise);
        offer_end(q, s, p, a, 1, trail, noise);
        return 0;
    }
    if (changes == 1) {
        double e0 = a->e[at - 1], e1 = a->e[at]; /* the zero of the control polygon is near that of the polynomial */
        double cross = at - 1 + (e0 < 0 ? e0 / (e0 - e1) : 0);
        offer_inside(q, s, p, a, a->t0 + (a->t1 - a->t0) * cross / (n - 1));
        return 0;
    }
    if (high - low <= q->tie) {
        offer_end(q, s, p, a, 0, 1, noise);
        offer_end(q, s, p, a, 1, 1, noise);
        return 0;
    }
    return 1;
}

/* By Descartes' rule and halving, as described above. */
static void bound(search *q, const segment *s, const double p[3]) {
    part *stack = q->stack;
    int n = 2 * (s->modes - 1), depth = 1;
    double size = spari_norm(p) + s->radius, noise = 32 * DBL_EPSILON * size * size;
    double slope_noise = 32 * DBL_EPSILON * size * s->radius;
    stack[0].t0 = 0, stack[0].t1 = 1;
    stack[0].d0 = s->g0 + spari_dot(s->c0, p) + spari_dot(p, p);
    for (int i = 0; i < n; i++) {
        stack[0].e[i] = s->dg[i] + s->dc[0][i] * p[0] + s->dc[1][i] * p[1] + s->dc[2][i] * p[2];
    }
    while (depth > 0) {
        part *top = &stack[depth - 1];
        if (!settle(q, s, p, top, n, noise, slope_noise * (top->t1 - top->t0))) {
            depth--;
        } else if (depth == DEPTH) { /* its ends are equal numbers */
            offer_end(q, s, p, top, 0, 1, noise);
            depth--;
        } else {
            part whole = *top;
            halve(&whole, n, &stack[depth], &stack[depth - 1]);
            depth++;
        }
    }
}

/* The zeros z [n] of the series a_0 T_0 + ... + a_n T_n, eigenvalues of its colleague matrix. Returns a status. */
static int solve_series(int n, const double *a, double complex *z) {
    double *A = spari_zalloc((int64_t)n * n, sizeof *A);
    if (!A) {
        return SPAR_ERR_MEMORY;
    }
    for (int k = 0; k < n; k++) { /* row k: s T_k */
        if (k > 0) {
            A[k * n + k - 1] = 0.5;
        }
        if (k + 1 < n) {
            A[k * n + k + 1] = k == 0 ? 1 : 0.5;
        }
    }
    for (int j = 0; j < n; j++) { /* T_n = -(a_0 T_0 + ... + a_{n-1} T_{n-1}) / a_n */
        A[(n - 1) * n + j] -= (n == 1 ? 1 : 0.5) * a[j] / a[n];
    }
    int status = spari_eigenvalues(n, A, z);
    free(A);
    return status;
}

/* By all zeros of D'/2 = (r - p) . r', degree 2 m - 1, and the ends. Two close real zeros come back as a complex
   pair with an imaginary part of the order of the root of rounding. Such pairs count as real, and Newton refines
   them. Returns 0 if the zeros were not found. */
static int solve_by_roots(search *q, const segment *s, const double p[3]) {
    const double near = 1e-3;
    double a[ROW], most = 0;
    double complex z[DEGREE];
    int degree = 2 * s->modes - 3;
    for (int k = 0; k <= degree; k++) {
        a[k] = s->pull[k] - (k < s->modes - 1 ? spari_dot(p, s->slope[k]) : 0);
        most = fmax(most, fabs(a[k]));
    }
    while (degree > 0 && fabs(a[degree]) <= DBL_EPSILON * most) {
        degree--;
    }
    int status = degree > 0 ? solve_series(degree, a, z) : SPAR_OK;
    q->no_memory |= status == SPAR_ERR_MEMORY;
    if (status != SPAR_OK) {
        return 0;
    }
    for (int k = 0; k < degree; k++) {
        double re = creal(z[k]);
        if (fabs(cimag(z[k])) <= near && fabs(re) <= 1 + near) {
            double at = fmax(-1, fmin(1, re));
            double found = refine_nearest(s, p, fmax(-1, at - near), fmin(1, at + near), at),
                   xi = xi_of(s, 0.5 * (1 + found));
            offer(q, s->element, xi, square_at(q, s->element, xi));
        }
    }
    offer(q, s->element, s->a, square_at(q, s->element, s->a));
    offer(q, s->element, s->b, square_at(q, s->element, s->b));
    return 1;
}

static void look_at(search *q, const segment *s) {
    double p[3];
    for (int i = 0; i < 3; i++) {
        p[i] = q->p[i] - s->origin[i];
    }
    if (distance_to_chord(s->end[0], s->end[1], p) > q->reach + s->deviation + 8 * DBL_EPSILON * s->radius) {
        return;
    }
    if (q->method != SPAR_PROJECT_RPOLY || !solve_by_roots(q, s, p)) {
        bound(q, s, p);
    }
}

/* Squared distance to the centre of a sphere or segment minus its radius. */
static double gap(const search *q, int node) {
    const double *x = node < 0 ? q->line->segment[-1 - node].origin : q->line->ball[node].x;
    double r = node < 0 ? q->line->segment[-1 - node].ball : q->line->ball[node].radius, d[3];
    for (int i = 0; i < 3; i++) {
        d[i] = q->p[i] - x[i];
    }
    return spari_norm(d) - r;
}

static void walk(search *q) {
    const spari_line *line = q->line;
    struct {
        int node;
        double gap;
    } stack[64];
    int depth = 1;
    stack[0].node = line->segments > 1 ? 0 : -1, stack[0].gap = -HUGE_VAL;
    while (depth > 0) {
        depth--;
        int node = stack[depth].node;
        if (stack[depth].gap > q->reach * (1 + 8 * DBL_EPSILON)) {
            continue;
        }
        if (node < 0) {
            look_at(q, &line->segment[-1 - node]);
            continue;
        }
        int left = line->ball[node].child[0], right = line->ball[node].child[1];
        double gl = gap(q, left), gr = gap(q, right);
        int near = gl <= gr; /* the nearer one is examined first */
        stack[depth].node = near ? right : left, stack[depth].gap = near ? gr : gl;
        stack[depth + 1].node = near ? left : right, stack[depth + 1].gap = near ? gl : gr;
        depth += 2;
    }
}

/* Whether the nearest point is an end of the line and the point lies beyond it, by more than rounding. */
static int is_beyond(const search *q) {
    const spari_line *line = q->line;
    double x[4], d[4], dd[4];
    int first = q->element == 0 && q->xi == -1, last = q->element == line->elements - 1 && q->xi == 1;
    if ((!first && !last) || line->per_element == 1) {
        return 0;
    }
    series(coefficients(line, q->element), line->per_element, q->xi, x, d, dd);
    for (int i = 0; i < 3; i++) {
        x[i] = q->p[i] - x[i];
    }
    double ahead = spari_dot(x, d), small = 1e-12 * (line->scale + spari_norm(x)) * spari_norm(d);
    return first ? ahead < -small : ahead > small;
}

/* Points that are projected one after the other. */
typedef struct points {
    const spari_line *line;
    int method;
    int64_t n;
    const double *x;
    int *element;
    double *xi, *nearest;
    uint8_t *flags;
    struct part *stacks; /* per thread */
    char *no_memory;     /* likewise: whether the search of all roots had none */
} points;

enum { SLAB = 1024 }; /* points per item; the first of an item has no neighbour */

static void project_item(void *context, int64_t item, int worker) {
    const points *p = context;
    const spari_line *line = p->line;
    const double *x = p->x;
    int64_t first = item * SLAB, end = p->n - first < SLAB ? p->n : first + SLAB;
    search q = {.line = line, .method = p->method, .xi = line->per_element > 1 ? -1 : 0};
    q.stack = p->stacks + (ptrdiff_t)worker * (DEPTH + 1);
    for (int64_t j = first; j < end; j++) {
        for (int i = 0; i < 3; i++) {
            q.p[i] = x[3 * j + i] - line->origin[i];
        }
        q.ambiguous = 0;
        if (line->per_element >
            1) { /* neighbours have neighbouring nearest points: the distance to the previous one is the first bound */
            int last = q.element;
            q.square = square_at(&q, last, q.xi);
            q.element = -1;
            set_reach(&q);
            walk(&q);
            q.element = q.element < 0 ? last : q.element;
        }
        p->element[j] = q.element, p->xi[j] = q.xi;
        p->flags[j] = (uint8_t)((q.ambiguous ? SPAR_MAP_AMBIGUOUS : 0) | (is_beyond(&q) ? SPAR_MAP_END : 0));
        spari_line_point(line, q.element, q.xi, p->nearest + 3 * j, NULL);
    }
    p->no_memory[worker] |= (char)q.no_memory;
}

int spari_line_project(const spari_line *line, spari_thread_pool *pool, int method, int64_t n, const double *x,
                       int *element, double *xi, double *nearest, uint8_t *flags) {
    points p = {line, method, n, x, element, xi, nearest, flags, NULL, NULL};
    const int threads = spari_thread_pool_threads(pool);
    p.stacks = spari_zalloc((int64_t)threads * (DEPTH + 1), sizeof *p.stacks);
    p.no_memory = spari_zalloc(threads, 1);
    int whole = p.stacks && p.no_memory;
    if (whole) {
        spari_thread_pool_run(pool, (n + SLAB - 1) / SLAB, project_item, &p);
    }
    for (int k = 0; k < threads && whole; k++) {
        whole = !p.no_memory[k];
    }
    SPARI_FREE(p.stacks, p.no_memory);
    return whole ? SPAR_OK : SPAR_ERR_MEMORY;
}
