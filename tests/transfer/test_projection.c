/* The nearest point on a line: against a scan that knows nothing of polynomials, and against cases with exact answers.
 * The oracle's own rounding is about 1e-15 of the line's size; what is asked is 1e-12. SPAR_TEST_LONG=1 in the
 * environment takes 10^6 points instead of some thousands. */
#include "support/lines.h"
#include "transfer/projection.h"
#include <cmocka.h>
#include <math.h>
#include <spar/spar_coupling.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* cmocka's own compares floats */
#define CLOSE(a, b, tolerance) assert_true(fabs((a) - (b)) <= (tolerance))

typedef struct feet {
    int element;
    double xi, x[3], distance;
    uint8_t flags;
} feet;

static feet foot_of(const spari_line *line, int method, const double p[3]) {
    feet f;
    spari_line_project(line, NULL, method, 1, p, &f.element, &f.xi, f.x, &f.flags);
    double d[3] = {p[0] - f.x[0], p[1] - f.x[1], p[2] - f.x[2]};
    f.distance = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    return f;
}

/* ---- the oracle ---- */

static void s_curve(double t, double x[3]) {
    x[0] = 10 * t, x[1] = sin(6.28 * t), x[2] = 0.4 * t * t;
}

static void helix(double t, double x[3]) {
    x[0] = 3 * cos(7 * t), x[1] = 3 * sin(7 * t), x[2] = 0.8 * t;
}

static void blade(double t, double x[3]) {
    x[0] = 60 * t, x[1] = -4 * t * t * t, x[2] = 2 * t * t;
}

static void near_loop(double t, double x[3]) { /* its ends pass each other at a hundredth of its size */
    x[0] = sin(6.2 * t), x[1] = sin(12.4 * t) / 2, x[2] = 0.02 * t;
}

static void make_line(polyline *l, int kind, unsigned long long *state) {
    static const line_shape shapes[] = {s_curve, helix, blade, near_loop};
    int nodes = 2 + (int)(9.5 * (1 + line_random(state)));    /* 2 to 20 */
    int elements = 1 + (int)(1.5 * (1 + line_random(state))); /* 1 to 3 */
    if (kind % 6 < 4) {
        line_of_shape(l, elements, nodes, shapes[kind % 6]);
    } else {
        line_at_random(l, nodes, kind % 6 == 4 ? 0.4 : 1.0, state);
    }
}

/* A point: near the line, about it, far from it, on it, or on its evolute, where the derivative has a double zero. */
static void make_point(const polyline *l, int kind, unsigned long long *state, double p[3]) {
    int e = (int)(0.49999 * (1 + line_random(state)) * l->elements);
    double xi = 0.98 * line_random(state), x[3], d[3], s[3];
    static const double away[] = {0, 1e-3, 0.03, 0.3, 3};
    line_at(l, e, xi, x);
    if (kind % 6 < 5) {
        for (int i = 0; i < 3; i++) {
            p[i] = x[i] + away[kind % 6] * l->scale * line_random(state);
        }
        return;
    }
    line_slope(l, e, xi, d);
    line_curve(l, e, xi, s);
    double dd = d[0] * d[0] + d[1] * d[1] + d[2] * d[2], ds = d[0] * s[0] + d[1] * s[1] + d[2] * s[2], n[3], nn = 0,
           ns = 0;
    for (int i = 0; i < 3; i++) {
        n[i] = s[i] - ds / dd * d[i];
        nn += n[i] * n[i], ns += n[i] * s[i];
    }
    double reach = nn > 1e-12 * dd * dd ? dd / ns : 0; /* to the centre of curvature */
    for (int i = 0; i < 3; i++) {
        p[i] = x[i] + (fabs(reach) * sqrt(nn) < 10 * l->scale ? reach : 0) * n[i];
    }
}

typedef struct tally {
    long points, wrong, loose;
    double worst;
} tally;

static void try_line(int kind, int points, int method, unsigned long long *state, tally *t) {
    polyline l;
    make_line(&l, kind, state);
    spari_line *line = spari_line_create(l.elements, l.nodes, l.x[0]);
    assert_non_null(line);
    for (int j = 0; j < points; j++) {
        double p[3], x[3];
        make_point(&l, j, state, p);
        feet f = foot_of(line, method, p);
        assert_true(f.element >= 0 && f.element < l.elements && f.xi >= -1 && f.xi <= 1);
        line_at(&l, f.element, f.xi, x); /* the foot lies on the line */
        for (int i = 0; i < 3; i++) {
            t->loose += fabs(x[i] - f.x[i]) > 1e-13 * l.nodes * l.scale;
        }
        double error = (f.distance - line_distance(&l, p)) / l.scale;
        t->worst = fmax(t->worst, error);
        t->wrong += error > 1e-12;
        t->points++;
    }
    spari_line_free(line);
    line_free(&l);
}

static void oracle_agrees(void **state) {
    (void)state;
    const char *longer = getenv("SPAR_TEST_LONG");
    int lines = 200, points = longer ? 5000 : 24;
    unsigned long long seed = 88172645463325252ull;
    tally t = {0};
    for (int k = 0; k < lines; k++) {
        try_line(k, points, SPAR_PROJECT_BOUNDED, &seed, &t);
    }
    print_message("bounded: %ld points, %ld wrong, worst excess %.2e of the line's size\n", t.points, t.wrong, t.worst);
    assert_int_equal(t.wrong, 0);
    assert_int_equal(t.loose, 0);
}

/* The same points by all zeros of the derivative. Near-double zeros, deflation and the degree may cost one its foot:
 * misses are counted, and few. */
static void root_finder_agrees(void **state) {
    (void)state;
    int lines = 200, points = getenv("SPAR_TEST_LONG") ? 5000 : 24;
    unsigned long long seed = 88172645463325252ull;
    tally t = {0};
    for (int k = 0; k < lines; k++) {
        try_line(k, points, SPAR_PROJECT_RPOLY, &seed, &t);
    }
    print_message("RPOLY: %ld points, %ld wrong, worst excess %.2e of the line's size\n", t.points, t.wrong, t.worst);
    assert_true(t.wrong <= t.points / 1000);
    assert_int_equal(t.loose, 0);
}

/* ---- cases with exact answers ---- */

static void parabola(double t, double x[3]) {
    double s = 4 * t - 2;
    x[0] = s, x[1] = s * s, x[2] = 0;
}

static void check(const spari_line *line, double px, double py, double t, double distance, int flags) {
    double p[3] = {px, py, 0};
    feet f = foot_of(line, SPAR_PROJECT_BOUNDED, p);
    CLOSE(2 * f.xi, t, 1e-9);
    CLOSE(f.distance, distance, 1e-13);
    assert_int_equal(f.flags, flags);
}

/* r = (t, t^2), t = 2 xi. Roots of 2 t^3 + (1 - 2 y) t - x = 0, to 14 digits. (0,2): minima at +-sqrt(3/2), a maximum
   between them: the smaller xi, flagged. (0,1/2) lies on the evolute: triple zero, found to the cube root of rounding.
 */
static void parabola_has_known_feet(void **state) {
    (void)state;
    for (int nodes = 3; nodes <= 24; nodes += 7) {
        polyline l;
        line_of_shape(&l, 1, nodes, parabola);
        spari_line *line = spari_line_create(1, nodes, l.x[0]);
        check(line, 1, 0, 0.58975451230146, 0.53784144869820, 0);
        check(line, 3, 1, 1.28962390148506, 1.83442839589788, 0);
        check(line, 0, 2, -1.22474487139159, 1.32287565553230, SPAR_MAP_AMBIGUOUS);
        check(line, 1e-3, 0.5, 0.0793700525984, 0.4998819309808, 0);
        double p[3] = {0, 0.5, 0};
        feet f = foot_of(line, SPAR_PROJECT_BOUNDED, p);
        CLOSE(f.xi, 0, 1e-3); /* D differs by xi^4: below rounding within 1e-4 */
        CLOSE(f.distance, 0.5, 1e-13);
        spari_line_free(line);
        line_free(&l);
    }
}

static void straight(double t, double x[3]) {
    x[0] = 1 + 4 * t, x[1] = 2 + 3 * t, x[2] = -12 * t;
}

/* A straight line of length 13: every coefficient of the derivative above the linear one is rounding. The foot is
   linear in the point; beyond the ends it is clamped and flagged; in the end's plane it is not beyond. */
static void straight_line_is_one_segment_for_any_degree(void **state) {
    (void)state;
    unsigned long long seed = 5;
    for (int nodes = 2; nodes <= 24; nodes++) {
        for (int elements = 1; elements <= 4; elements += 3) {
            polyline l;
            line_of_shape(&l, elements, nodes, straight);
            spari_line *line = spari_line_create(elements, nodes, l.x[0]);
            for (int k = 0; k < 40; k++) {
                double s = 8 * line_random(&seed), side = line_random(&seed), up = line_random(&seed);
                s = k == 0 ? -6.5 : k == 1 ? 6.5 : k == 2 ? 0 : s;
                side = k == 3 ? 0 : side, up = k == 3 ? 0 : up; /* on the line itself */
                /* axes: (4,3,-12)/13, (3,-4,0)/5, their cross product */
                double p[3], at = s + 6.5;
                for (int i = 0; i < 3; i++) {
                    static const double along[] = {4. / 13, 3. / 13, -12. / 13}, n[] = {0.6, -0.8, 0},
                                        b[] = {-9.6 / 13, -7.2 / 13, -5. / 13};
                    p[i] = (i == 0 ? 1 : i == 1 ? 2 : 0) + at * along[i] + side * n[i] + up * b[i];
                }
                feet f = foot_of(line, SPAR_PROJECT_BOUNDED, p);
                double clamped = fmax(-6.5, fmin(6.5, s)) / 6.5;
                double eta = (f.element + 0.5 * (1 + f.xi)) / elements;
                CLOSE(2 * eta - 1, clamped, 1e-13);
                CLOSE(f.distance, sqrt(side * side + up * up + pow(fmax(0, fabs(s) - 6.5), 2)), 1e-13);
                assert_int_equal(f.flags, fabs(s) > 6.5 + 1e-9 ? SPAR_MAP_END : 0);
            }
            spari_line_free(line);
            line_free(&l);
        }
    }
}

static void arc(double t, double x[3]) {
    double a = t * M_PI / 4;
    x[0] = 100 * sin(a), x[1] = 100 * (1 - cos(a)), x[2] = 0;
}

/* Circular arc, R = 100, 45 degrees, 15 nodes. From the centre every foot is right: the first is taken and flagged.
   From half the radius at a third of the arc, xi = -1/3. */
static void arc_centre_is_ambiguous(void **state) {
    (void)state;
    polyline l;
    line_of_shape(&l, 1, 15, arc);
    spari_line *line = spari_line_create(1, 15, l.x[0]);
    double centre[3] = {0, 100, 0}, a = M_PI / 12, half[3] = {50 * sin(a), 100 - 50 * cos(a), 0};
    feet f = foot_of(line, SPAR_PROJECT_BOUNDED, centre);
    CLOSE(f.distance, 100, 1e-9);
    assert_int_equal(f.flags & SPAR_MAP_AMBIGUOUS, SPAR_MAP_AMBIGUOUS);
    f = foot_of(line, SPAR_PROJECT_BOUNDED, half);
    CLOSE(f.xi, -1.0 / 3, 1e-10);
    CLOSE(f.distance, 50, 1e-10);
    assert_int_equal(f.flags, 0);
    spari_line_free(line);
    line_free(&l);
}

static void cubic(double t, double x[3]) {
    double s = 2 * t - 1;
    x[0] = s, x[1] = 3 * (s * s * s - 0.6 * s), x[2] = 0;
}

/* An S with the point on its axis of symmetry (a turn by 180 degrees): with (0, 0, h) the line passes under the point;
   with a point off the line on that axis both arms are equally far. */
static void symmetric_point_of_an_s(void **state) {
    (void)state;
    polyline l;
    line_of_shape(&l, 1, 4, cubic);
    spari_line *line = spari_line_create(1, 4, l.x[0]);
    double above[3] = {0, 0, 0.25};
    feet f = foot_of(line, SPAR_PROJECT_BOUNDED, above);
    CLOSE(f.xi, 0, 1e-14);
    CLOSE(f.distance, 0.25, 1e-15);
    for (int k = 0; k < 200; k++) {
        double p[3] = {-1 + 0.01 * k, 0.9 * sin(k), 0.01 * (k % 7)};
        f = foot_of(line, SPAR_PROJECT_BOUNDED, p);
        assert_true(f.distance - line_distance(&l, p) < 1e-13);
    }
    spari_line_free(line);
    line_free(&l);
}

/* Two elements with a kink of 90 degrees: over the inside of the corner two feet tie; over its outside the joint is the
   foot, once, of the lower element and not ambiguous. A line folded back on itself: two coordinates for one place. */
static void joints_and_folds(void **state) {
    (void)state;
    const double corner[] = {0, 0, 0, 1, 0, 0, 1, 0, 0, 1, 1, 0};
    spari_line *line = spari_line_create(2, 2, corner);
    const double inside[3] = {0.5, 0.5, 0}, outside[3] = {2, -1, 0};
    feet f = foot_of(line, SPAR_PROJECT_BOUNDED, inside);
    assert_int_equal(f.element, 0);
    CLOSE(f.xi, 0, 1e-14);
    assert_int_equal(f.flags, SPAR_MAP_AMBIGUOUS);
    f = foot_of(line, SPAR_PROJECT_BOUNDED, outside);
    assert_int_equal(f.element, 0);
    CLOSE(f.xi, 1, 0);
    assert_int_equal(f.flags, 0);
    spari_line_free(line);
    const double fold[] = {0, 0, 0, 1, 0, 0, 0, 0, 0}; /* x = 1 - xi^2 */
    line = spari_line_create(1, 3, fold);
    const double over[3] = {0.75, 0.1, 0};
    f = foot_of(line, SPAR_PROJECT_BOUNDED, over);
    CLOSE(f.xi, -0.5, 1e-13);
    CLOSE(f.distance, 0.1, 1e-15);
    assert_int_equal(f.flags, SPAR_MAP_AMBIGUOUS);
    spari_line_free(line);
}

/* All nodes in one place: any foot is right, the first is given. */
static void line_of_no_length(void **state) {
    (void)state;
    double x[6][3] = {{0}};
    for (int j = 0; j < 6; j++) {
        x[j][0] = 1, x[j][1] = 2, x[j][2] = 3;
    }
    spari_line *line = spari_line_create(1, 6, x[0]);
    const double p[3] = {1, 2, 7};
    feet f = foot_of(line, SPAR_PROJECT_BOUNDED, p), g = foot_of(line, SPAR_PROJECT_BOUNDED, x[0]);
    CLOSE(f.distance, 4, 1e-15);
    CLOSE(g.distance, 0, 0);
    CLOSE(f.xi, -1, 0);
    spari_line_free(line);
}

/* Many points at once give the bits each gives alone, in any order: a foot does not depend on its neighbours, nor on
   how the host's mesh is spread over ranks. */
static void feet_do_not_depend_on_neighbours(void **state) {
    (void)state;
    enum { N = 500 };
    polyline l;
    unsigned long long seed = 17;
    line_of_shape(&l, 3, 9, near_loop);
    spari_line *line = spari_line_create(3, 9, l.x[0]);
    static double p[N][3], xi[N], x[N][3];
    static int element[N];
    static uint8_t flags[N];
    for (int j = 0; j < N; j++) {
        make_point(&l, j, &seed, p[j]);
    }
    spari_line_project(line, NULL, SPAR_PROJECT_BOUNDED, N, p[0], element, xi, x[0], flags);
    for (int j = N - 1; j >= 0; j--) {
        feet f = foot_of(line, SPAR_PROJECT_BOUNDED, p[j]);
        assert_int_equal(f.element, element[j]);
        assert_memory_equal(&f.xi, &xi[j], sizeof f.xi);
        assert_memory_equal(f.x, x[j], sizeof f.x);
        assert_int_equal(f.flags, flags[j]);
    }
    spari_line_free(line);
    line_free(&l);
}

/* A line far from the origin of the axes keeps its accuracy relative to its own size: the differences are taken first.
 */
static void far_origin(void **state) {
    (void)state;
    polyline l;
    line_of_shape(&l, 1, 10, s_curve);
    double moved[10][3];
    for (int j = 0; j < 10; j++) {
        for (int i = 0; i < 3; i++) {
            moved[j][i] = l.x[j][i] + 4096 * (i + 1); /* exact to 1e-12 of a unit */
            l.x[j][i] = moved[j][i] - 4096 * (i + 1);
        }
    }
    spari_line *near = spari_line_create(1, 10, l.x[0]), *far = spari_line_create(1, 10, moved[0]);
    const double p[3] = {3, 1.5, -0.5}, q[3] = {3 + 4096, 1.5 + 8192, -0.5 + 12288};
    feet f = foot_of(near, SPAR_PROJECT_BOUNDED, p), g = foot_of(far, SPAR_PROJECT_BOUNDED, q);
    CLOSE(f.xi, g.xi, 1e-14);
    CLOSE(f.distance, g.distance, 4e-12);
    spari_line_free(near);
    spari_line_free(far);
    line_free(&l);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(oracle_agrees),
        cmocka_unit_test(root_finder_agrees),
        cmocka_unit_test(parabola_has_known_feet),
        cmocka_unit_test(straight_line_is_one_segment_for_any_degree),
        cmocka_unit_test(arc_centre_is_ambiguous),
        cmocka_unit_test(symmetric_point_of_an_s),
        cmocka_unit_test(joints_and_folds),
        cmocka_unit_test(line_of_no_length),
        cmocka_unit_test(feet_do_not_depend_on_neighbours),
        cmocka_unit_test(far_origin),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
