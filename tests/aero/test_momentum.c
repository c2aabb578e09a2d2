/* The momentum balance of one annulus against closed forms and against the balances themselves, written with
 * velocities. */
#include <math.h>

#include "aero/momentum.h"
#include "base/session.h"
#include "math/basis.h"
#include "math/brent.h"
#include <cmocka.h>

#define PI 3.14159265358979323846

typedef struct bench {
    spar_polar *polar;
    spari_table *table;
    int64_t row;
} bench;

static bench bench_of(int64_t n, const double *alpha, const double *cl) {
    static const double cd[400];
    bench b = {NULL, NULL, 0};
    assert_int_equal(spar_polar_create(n, alpha, cl, cd, NULL, &b.polar), SPAR_OK);
    b.table = spari_polar_share(b.polar);
    return b;
}

static void bench_free(bench *b) {
    spar_polar_destroy(&b->polar);
    spari_table_release(b->table);
}

static bench constant_lift(double cl) {
    double alpha[] = {-PI, 0.0, PI}, value[] = {cl, cl, cl};
    return bench_of(3, alpha, value);
}

/* cl(alpha) = 1.1 sin(2 alpha) + 0.4 cos(alpha) sin(4 alpha) in 1 degree rows; the oracle below uses the same rows. */
static double bumpy_lift(double alpha) {
    double row = floor(alpha * 180.0 / PI), value[2];
    for (int i = 0; i < 2; i++) {
        double a = (row + i) * PI / 180.0;
        value[i] = 1.1 * sin(2.0 * a) + 0.4 * cos(a) * sin(4.0 * a);
    }
    return value[0] + (alpha * 180.0 / PI - row) * (value[1] - value[0]);
}

static bench bumpy(void) {
    double alpha[361], cl[361];
    for (int i = 0; i < 361; i++) {
        alpha[i] = (i - 180) * PI / 180.0;
        cl[i] = 1.1 * sin(2.0 * alpha[i]) + 0.4 * cos(alpha[i]) * sin(4.0 * alpha[i]);
    }
    return bench_of(361, alpha, cl);
}

static spari_annulus annulus_of(bench *b, double vx, double vy, double sigma) {
    return (spari_annulus){
        .vx = vx, .vy = vy, .sigma = sigma, .tip = -1.0, .hub = -1.0, .swirl = 1, .table = b->table, .row = &b->row};
}

/* Lane l of a set of annuli. */
static void put(const spari_annulus *ring, spari_annuli *a, int l) {
    a->vx[l] = ring->vx, a->vy[l] = ring->vy, a->sigma[l] = ring->sigma;
    a->twist_sine[l] = sin(ring->twist), a->twist_cosine[l] = cos(ring->twist);
    a->tip[l] = ring->tip, a->hub[l] = ring->hub, a->table[l] = ring->table, a->row[l] = ring->row;
}

static int solve(const spari_annulus *ring, double *wx, double *wy) {
    spari_annuli a = {.count = 1, .swirl = ring->swirl};
    put(ring, &a, 0);
    spari_momentum_solve(&a, 8);
    *wx = a.wx[0], *wy = a.wy[0];
    return a.no_root[0];
}

/* Prandtl's factor: 1 far from the end, 2/pi sqrt(2 f / sin phi) close to it (relative error f / (6 sin phi)), 0 on it,
   1 when off; f = ln 2 sin phi gives 2/pi acos(1/2) = 2/3 to rounding. */
static void test_prandtl(void **state) {
    (void)state;
    assert_true(spari_prandtl(-1.0, 0.3) == 1.0);
    assert_true(spari_prandtl(0.0, 0.3) == 0.0);
    assert_true(fabs(spari_prandtl(40.0 * 0.3, 0.3) - 1.0) < 1e-15);
    assert_true(spari_prandtl(1.0, 1e-300) == 1.0);
    assert_true(fabs(spari_prandtl(0.3 * log(2.0), -0.3) - 2.0 / 3.0) < 1e-15);
    double f = 1e-9, near = 2.0 / PI * sqrt(2.0 * f / 0.3);
    assert_true(fabs(spari_prandtl(f, 0.3) / near - 1.0) < 1e-9);
}

/* Betz: no swirl, no loss, constant cl, solidity so that k = 1/2 at tan phi = (2/3) / lambda. Then a = 1/3 and the
   annulus' power coefficient sigma W^2 cl sin(phi) lambda = 16/27; both closed forms, so to rounding. */
static void test_betz(void **state) {
    (void)state;
    bench b = constant_lift(0.8);
    for (double lambda = 0.2; lambda < 12.0; lambda *= 1.3) {
        double phi = atan2(2.0 / 3.0, lambda), wx, wy;
        double sigma = 0.5 * 4.0 * sin(phi) * sin(phi) / (0.8 * cos(phi));
        spari_annulus ring = annulus_of(&b, 9.0, 9.0 * lambda, sigma);
        ring.swirl = 0;
        assert_int_equal(solve(&ring, &wx, &wy), 0);
        assert_true(fabs(wx / 9.0 - 2.0 / 3.0) < 1e-13 && fabs(wy / ring.vy - 1.0) < 1e-13);
        double power = sigma * hypot(wx, wy) * 0.8 * wx * lambda / 81.0;
        assert_true(fabs(power - 16.0 / 27.0) < 1e-12);
    }
    bench_free(&b);
}

/* Glauert's optimum rotor with swirl: for a in (1/4, 1/3), a' = (1 - 3a)/(4a - 1), lambda_r^2 = a(1 - a)/(a'(1 + a')),
   and the whole rotor has CP = 8/(729 lambda^2) [64/5 x^5 + 72 x^4 + 124 x^3 + 38 x^2 - 63 x - 12 ln x - 4/x] from x =
   1 - 3 a(lambda) to 1/4 (Glauert 1935; Manwell et al., eq. 3.52 there). Each annulus gets the solidity that carries
   it; the solver must find a and a', and the integral 8/lambda^2 int a'(1 - a) lambda_r^3 dlambda_r over its answers
   must be that CP. */
typedef struct glauert {
    bench *b;
    double worst;
} glauert;

static double glauert_speed(double a) {
    double swirl = (1.0 - 3.0 * a) / (4.0 * a - 1.0);
    return sqrt(a * (1.0 - a) / (swirl * (1.0 + swirl)));
}

static double glauert_power(double a, void *context) {
    glauert *g = context;
    double lambda = glauert_speed(a), swirl = (1.0 - 3.0 * a) / (4.0 * a - 1.0), wx, wy;
    double phi = atan2(1.0 - a, lambda * (1.0 + swirl));
    double sigma = a / (1.0 - a) * 4.0 * sin(phi) * sin(phi) / cos(phi);
    spari_annulus ring = annulus_of(g->b, 1.0, lambda, sigma);
    assert_int_equal(solve(&ring, &wx, &wy), 0);
    double found[] = {1.0 - wx, wy / lambda - 1.0};
    g->worst = fmax(g->worst, fmax(fabs(found[0] / a - 1.0), fabs(found[1] / swirl - 1.0)));
    double h = 1e-6, slope = (glauert_speed(a + h) - glauert_speed(a - h)) / (2.0 * h);
    return found[1] * (1.0 - found[0]) * lambda * lambda * lambda * slope;
}

static double glauert_primitive(double x) {
    return 12.8 * pow(x, 5) + 72.0 * pow(x, 4) + 124.0 * pow(x, 3) + 38.0 * x * x - 63.0 * x - 12.0 * log(x) - 4.0 / x;
}

static void test_glauert(void **state) {
    (void)state;
    bench b = constant_lift(1.0);
    glauert g = {&b, 0.0};
    double xi[64], weight[64];
    spari_gauss(64, xi, weight);
    for (double end = 0.29; end < 0.3325; end += 0.01) {
        double lambda = glauert_speed(end);
        double power = 0.0, first = 0.25 + 1e-5, half = 0.5 * (end - first);
        for (int i = 0; i < 64; i++) {
            power += 8.0 / (lambda * lambda) * half * weight[i] * glauert_power(first + half * (1.0 + xi[i]), &g);
        }
        double exact = 8.0 / (729.0 * lambda * lambda) * (glauert_primitive(0.25) - glauert_primitive(1.0 - 3.0 * end));
        assert_true(fabs(power - exact) <
                    1e-6); /* cut at the hub: lambda_r(0.25 + 1e-5)^4 ~ 1e-9; slope by differences */
    }
    assert_true(g.worst < 1e-11);
    bench_free(&b);
}

/* Both balances with velocities: what the flow found by the solver gives the blade, and what the annulus then takes up.
   Axial: 4 F a(1 - a) up to a = 0.4, Buhl's parabola 8/9 + (4F - 40/9) a + (50/9 - 4F) a^2 up to a = 1, beyond the
   larger of 4 F a(a - 1) and the parabola's tangent at a = 1. Swirl: 4 F v times the mass flow |wx|, by half a degree
   of phi more than that. Returns the larger error, relative to the terms. */
static double imbalance(const spari_annulus *ring, double wx, double wy) {
    double side = ring->vx < 0.0 ? -1.0 : 1.0, vx = fabs(ring->vx), flow = side * wx, speed = hypot(wx, wy);
    double cl = bumpy_lift(remainder(atan2(wx, wy) - ring->twist, 2.0 * PI)), s = fabs(wx) / speed, disc, loss = 1.0;
    loss *= ring->tip < 0.0 ? 1.0 : 2.0 / PI * acos(exp(-ring->tip / s));
    loss *= ring->hub < 0.0 ? 1.0 : 2.0 / PI * acos(exp(-ring->hub / s));
    if (flow >= 0.6 * vx) { /* a vx = vx - flow; so written, vx may be 0 */
        disc = 4.0 * loss * (vx - flow) * flow;
    } else if (flow >= 0.0) {
        double a = 1.0 - flow / vx;
        disc = (8.0 / 9.0 + (4.0 * loss - 40.0 / 9.0) * a + (50.0 / 9.0 - 4.0 * loss) * a * a) * vx * vx;
    } else {
        disc = fmax(4.0 * loss * (vx - flow) * -flow, 2.0 * vx * vx + (20.0 / 3.0 - 4.0 * loss) * -flow * vx);
    }
    double axial_force = side * ring->sigma * speed * cl * wy, torque = ring->sigma * speed * cl * wx;
    double axial = fabs(axial_force - disc) / fmax(fabs(axial_force) + fabs(disc), 1e-6 * speed * speed);
    double mass = s < 0.01 ? fabs(wx) / spari_swirl_sign(s) : fabs(wx), wake = 4.0 * loss * (wy - ring->vy) * mass;
    double size = fabs(torque) + 4.0 * loss * mass * (fabs(wy) + fabs(ring->vy));
    double swirl = fabs(torque - wake) / fmax(size, 1e-6 * speed * speed);
    return fmax(axial, ring->swirl ? swirl : fabs(wy - ring->vy) / fmax(1e-3, fabs(ring->vy)));
}

static uint64_t seed = 88172645463325252u;
static double uniform(double lo, double hi) {
    seed ^= seed << 13, seed ^= seed >> 7, seed ^= seed << 17;
    return lo + (hi - lo) * (double)(seed >> 11) * 0x1p-53;
}

/* Whether a scan of the inflow angle from lo to hi, blind to the solver's brackets, sees the residual pass through zero
   where the flow's speed is positive. */
static int scan_finds_root(const spari_annulus *ring, double lo, double hi, int steps) {
    double before = 0.0;
    for (int i = 0; i < steps; i++) {
        double phi = lo + (hi - lo) * (i + 0.5) / steps;
        spari_balance x = spari_momentum_balance(ring, phi);
        double speed = fabs(ring->vx) * x.g + ring->vy * x.h;
        if (i > 0 && speed > 0.0 && before * x.residual < 0.0) {
            return 1;
        }
        before = x.residual;
    }
    return 0;
}

/* 20000 random annuli, flow from any side, twist of any size, losses on and off: what is called a root satisfies both
   balances to 1e-9 (Brent stops at 1e-15 in the angle; the balances lose up to six digits where phi is small), and
   where none is found the blind scan finds none either. The seed is fixed. */
static void test_random(void **state) {
    (void)state;
    bench b = bumpy();
    int lost = 0, brake = 0, buhl = 0;
    double worst = 0.0;
    for (int i = 0; i < 20000; i++) {
        spari_annulus ring = annulus_of(&b, uniform(-20.0, 20.0), uniform(-60.0, 60.0), pow(10.0, uniform(-3.0, 0.0)));
        ring.twist = uniform(-1.0, 1.0) * (i % 3 == 0 ? PI : 0.3);
        ring.tip = i % 2 ? pow(10.0, uniform(-3.0, 1.0)) : -1.0;
        ring.hub = i % 5 ? -1.0 : pow(10.0, uniform(-3.0, 1.0));
        ring.swirl = i % 7 != 0;
        double wx, wy;
        if (solve(&ring, &wx, &wy)) {
            lost++;
            assert_true(wx == ring.vx && wy == ring.vy);
            assert_false(scan_finds_root(&ring, 0.0, PI, 20000) || scan_finds_root(&ring, -PI, 0.0, 20000));
            continue;
        }
        double a = 1.0 - wx / ring.vx, error = imbalance(&ring, wx, wy);
        brake += a > 1.0;
        buhl += a > 0.4 && a <= 1.0;
        worst = fmax(worst, error);
        if (error > 1e-8) {
            print_error("vx %g vy %g sigma %g twist %g tip %g hub %g swirl %d: wx %g wy %g error %g\n", ring.vx,
                        ring.vy, ring.sigma, ring.twist, ring.tip, ring.hub, ring.swirl, wx, wy, error);
        }
        assert_true(error <= 1e-8);
    }
    print_message("worst imbalance %.1e, without root %d, brake %d, empirical %d\n", worst, lost, brake, buhl);
    assert_true(brake > 100 && buhl > 100 && lost < 200);
    bench_free(&b);
}

static double residual_of(double phi, void *ring) {
    return spari_momentum_balance(ring, phi).residual;
}

/* Newton's method ends at the root that Brent's method finds from the ends of the quadrant of the free flow, to 1e-12
   of the free flow. 5000 annuli of ordinary rotors: induction up to the empirical state, losses at both ends, swirl on
   and off. The last step of Newton is 1e-9 of the angle, so a wrong derivative would leave more. */
static void test_brent(void **state) {
    (void)state;
    bench b = bumpy();
    int compared = 0, empirical = 0;
    double worst = 0.0;
    for (int i = 0; i < 5000; i++) {
        spari_annulus ring = annulus_of(&b, uniform(4.0, 14.0), uniform(10.0, 80.0), pow(10.0, uniform(-2.0, -1.0)));
        ring.twist = uniform(-0.05, 0.25);
        ring.tip = i % 4 ? pow(10.0, uniform(-2.0, 1.0)) : -1.0;
        ring.hub = i % 5 ? -1.0 : pow(10.0, uniform(-2.0, 1.0));
        ring.swirl = i % 7 != 0;
        double wx, wy, phi = spari_brent(residual_of, &ring, 1e-8, 0.5 * PI, 0.0, 100);
        assert_int_equal(solve(&ring, &wx, &wy), 0);
        if (isfinite(phi)) {
            spari_balance x = spari_momentum_balance(&ring, phi);
            double speed = (ring.vx * x.g + ring.vy * x.h) / (x.g * x.g + x.h * x.h);
            double off = hypot(wx - speed * sin(phi), wy - speed * cos(phi)) / hypot(ring.vx, ring.vy);
            worst = fmax(worst, off);
            compared++;
            empirical += 1.0 - wx / ring.vx > 0.4;
        }
    }
    print_message("%d compared, %d in the empirical state, off by %.1e\n", compared, empirical, worst);
    assert_true(compared > 4000 && empirical > 100 && worst < 1e-12);
    bench_free(&b);
}

/* The root is the one in the right region: where the flow found has left the quadrant of the free flow (the brake, or
   swirl that turns the tangential flow round), a blind scan of that quadrant finds no root in it. Heavily loaded
   annuli, so that this is common. */
static void test_region(void **state) {
    (void)state;
    bench b = bumpy();
    int left = 0;
    for (int i = 0; i < 3000; i++) {
        spari_annulus ring = annulus_of(&b, uniform(-20.0, 20.0), uniform(-60.0, 60.0), pow(10.0, uniform(-2.0, -0.7)));
        ring.twist = uniform(-0.6, 0.6);
        double wx, wy;
        if (solve(&ring, &wx, &wy) || (wx * ring.vx > 0.0 && wy * ring.vy > 0.0)) {
            continue;
        }
        left++;
        assert_false(scan_finds_root(&ring, ring.vy < 0.0 ? PI / 2.0 : 0.0, ring.vy < 0.0 ? PI : PI / 2.0, 2000));
    }
    assert_true(left > 100);
    bench_free(&b);
}

/* Wind from the other side is the mirror image: the flow with the blade turned over gives the same numbers with wx
   reversed. For a polar odd in alpha, (vx, twist) -> (-vx, -twist). */
static void test_mirror(void **state) {
    (void)state;
    bench b = bumpy();
    for (int i = 0; i < 500; i++) {
        spari_annulus one = annulus_of(&b, uniform(0.1, 20.0), uniform(-60.0, 60.0), uniform(0.001, 0.3)), two = one;
        double w[2][2];
        one.twist = uniform(-0.5, 0.5);
        two.vx = -one.vx, two.twist = -one.twist;
        assert_int_equal(solve(&one, &w[0][0], &w[0][1]), solve(&two, &w[1][0], &w[1][1]));
        double scale = hypot(one.vx, one.vy);
        assert_true(fabs(w[0][0] + w[1][0]) < 1e-10 * scale && fabs(w[0][1] - w[1][1]) < 1e-10 * scale);
    }
    bench_free(&b);
}

/* Corners: no wind, no turning, neither, very small ones, a section without lift. All finite; a parked section without
   lift and one in calm air without lift see the free flow; a lifting one in calm air blows as hover theory says: sigma
   W^2 cl cos phi = 4 wx^2. */
static void test_corners(void **state) {
    (void)state;
    bench b = bumpy(), none = constant_lift(0.0);
    const double speeds[] = {0.0, -0.0, 1e-300, 1e-12, -1e-12, 1e-3, 10.0, -10.0};
    for (int i = 0; i < 8; i++) {
        for (int j = 0; j < 8; j++) {
            for (int k = -3; k <= 3; k++) {
                double wx, wy;
                spari_annulus ring = annulus_of(&b, speeds[i], speeds[j], 0.05);
                ring.twist = 0.5 * k;
                ring.tip = 0.7;
                solve(&ring, &wx, &wy);
                assert_true(isfinite(wx) && isfinite(wy) && hypot(wx, wy) < 20.0);
                ring.table = none.table, ring.row = &none.row;
                assert_int_equal(solve(&ring, &wx, &wy), 0);
                assert_true(wx == ring.vx && wy == ring.vy);
            }
        }
    }
    for (double twist = -0.3; twist < 0.31; twist += 0.1) {
        double wx, wy;
        spari_annulus ring = annulus_of(&b, 0.0, 50.0, 0.08);
        ring.twist = twist;
        if (fabs(twist) < 0.05) {
            continue; /* no lift, no flow */
        }
        assert_int_equal(solve(&ring, &wx, &wy), 0);
        assert_true(wx * twist > 0.0); /* pushes the air the way the chord is turned */
        assert_true(imbalance(&ring, wx, wy) < 1e-10);
    }
    bench_free(&b);
    bench_free(&none);
}

/* The residual is continuous in the angle from 0 to pi across k = 2/3 and Buhl's removable singularity (k such that
   2Fk = 25/9 - 2F): no step between neighbours 1e-7 apart is larger than a slope of 1e4 allows. */
static void test_continuous(void **state) {
    (void)state;
    bench b = bumpy();
    spari_annulus ring = annulus_of(&b, 8.0, 40.0, 0.05);
    ring.tip = 0.2;
    int seen_empirical = 0, seen_momentum = 0;
    for (double phi = 0.02; phi < 3.1; phi += 1e-4) {
        spari_balance x = spari_momentum_balance(&ring, phi), y = spari_momentum_balance(&ring, phi + 1e-7);
        assert_true(isfinite(x.residual) && fabs(x.residual - y.residual) < 1e-3);
        double a = 1.0 - sin(phi) / x.g;
        seen_empirical |= a > 0.6;
        seen_momentum |= a < 0.4;
    }
    assert_true(seen_empirical && seen_momentum);
    bench_free(&b);
}

/* The flow found follows the free flow without a jump, through windmill, empirical state, brake, calm air and wind from
   behind: a coupling iteration can meet them all. Attached lift 2 pi sin alpha; in steps of 1e-4 of the speed the
   induced flow moves by less than 1e-2 of it (a slope of 100, that of sqrt at the edge of calm air aside, which is why
   the limit is not 1e-3). */
static void test_no_jump(void **state) {
    (void)state;
    double alpha[721], cl[721];
    for (int i = 0; i < 721; i++) {
        alpha[i] = (0.5 * i - 180.0) * PI / 180.0;
        cl[i] = 2.0 * PI * sin(alpha[i]);
    }
    static const double cd[721];
    bench b = {NULL, NULL, 0};
    assert_int_equal(spar_polar_create(721, alpha, cl, cd, NULL, &b.polar), SPAR_OK);
    b.table = spari_polar_share(b.polar);
    double worst = 0.0;
    for (int k = 0; k < 12; k++) {
        double vy = 50.0, last[2] = {NAN, NAN};
        spari_annulus ring = annulus_of(&b, 0.0, vy, k % 2 ? 0.03 : 0.1);
        ring.tip = k % 3 ? 0.05 * k : -1.0;
        ring.twist = 0.05 * (k / 2 - 1);
        for (double vx = 20.0; vx > -20.0; vx -= 1e-4 * vy) {
            double wx, wy;
            ring.vx = vx;
            assert_int_equal(solve(&ring, &wx, &wy), 0);
            if (isfinite(last[0])) {
                worst = fmax(worst, hypot(wx - last[0], wy - last[1]) / vy);
            }
            last[0] = wx, last[1] = wy;
        }
    }
    print_message("largest step of the flow %.1e\n", worst);
    assert_true(worst < 1e-2);
    bench_free(&b);
}

/* What tip loss, hub loss and swirl are worth, at a < 0.4: with s, c of the angle found and F the product of Prandtl's
   factors, a / (1 - a) = sigma cl c / (4 F s^2) and a' / (1 + a') = sigma cl / (4 F c). Off: F = 1, and a' = 0 to the
   last bit. So the losses are an annulus of solidity sigma / F without them. */
static void test_off(void **state) {
    (void)state;
    static const double end[][2] = {{-1, -1}, {0.3, -1}, {-1, 0.2}, {0.5, 0.4}};
    bench b = constant_lift(0.8);
    for (int k = 0; k < 8; k++) {
        spari_annulus ring = annulus_of(&b, 9.0, 40.0, 0.03), bare;
        double wx, wy, ux, uy;
        ring.tip = end[k / 2][0], ring.hub = end[k / 2][1], ring.swirl = k % 2;
        assert_int_equal(solve(&ring, &wx, &wy), 0);
        double w = hypot(wx, wy), s = wx / w, c = wy / w, a = 1 - wx / ring.vx, swirl = 1 - ring.vy / wy, F = 1;
        F *= ring.tip < 0 ? 1 : 2 / PI * acos(exp(-ring.tip / s));
        F *= ring.hub < 0 ? 1 : 2 / PI * acos(exp(-ring.hub / s));
        assert_true(a > 0 && a < 0.4 && (k < 2) == (F == 1));
        assert_true(fabs(a / (1 - a) - ring.sigma * 0.8 * c / (4 * F * s * s)) < 1e-12);
        assert_true(ring.swirl ? fabs(swirl - ring.sigma * 0.8 / (4 * F * c)) < 1e-12 : wy == ring.vy);
        bare = ring;
        bare.tip = bare.hub = -1, bare.sigma /= F;
        assert_int_equal(solve(&bare, &ux, &uy), 0);
        assert_true(hypot(ux - wx, uy - wy) < 1e-12 * w);
    }
    bench_free(&b);
}

/* Any number of annuli side by side and any width of vectors give the bits of each annulus alone in the portable
   kernels. Random annuli: flow from any side, twist of any size, losses on and off, lift or none, no wind, and one in
   sixteen without a number, which has no root and leaves its neighbours alone. */
static void test_lanes(void **state) {
    (void)state;
    bench b = bumpy(), none = constant_lift(0.0);
    for (int i = 0; i < 3000; i++) {
        spari_annuli a = {.count = 1 + i % SPARI_ANNULI, .swirl = i % 7 != 0}, wide[2], alone;
        for (int l = 0; l < a.count; l++) {
            int kind = (int)uniform(0.0, 16.0);
            spari_annulus ring =
                annulus_of(&b, uniform(-20.0, 20.0), uniform(-20.0, 80.0), pow(10.0, uniform(-3.0, 0.0)));
            ring.vx = kind == 0 ? NAN : kind == 1 ? 0.0 : ring.vx;
            ring.table = kind == 2 ? none.table : ring.table;
            ring.twist = uniform(-1.0, 1.0) * (kind < 5 ? PI : 0.3);
            ring.tip = kind % 2 ? pow(10.0, uniform(-3.0, 1.0)) : -1.0;
            ring.hub = kind % 3 ? -1.0 : pow(10.0, uniform(-3.0, 1.0));
            put(&ring, &a, l);
        }
        wide[0] = wide[1] = a;
        spari_momentum_solve(wide, 4);
        spari_momentum_solve(wide + 1, 8);
        for (int l = 0; l < a.count; l++) {
            spari_annulus ring = {a.vx[l], a.vy[l], 0.0, a.sigma[l], a.tip[l], a.hub[l], a.swirl, a.table[l], a.row[l]};
            alone = (spari_annuli){.count = 1, .swirl = a.swirl};
            put(&ring, &alone, 0);
            alone.twist_sine[0] = a.twist_sine[l], alone.twist_cosine[0] = a.twist_cosine[l];
            spari_momentum_solve(&alone, 2);
            for (int k = 0; k < 2; k++) {
                assert_int_equal(wide[k].no_root[l], alone.no_root[0]);
                assert_memory_equal(wide[k].wx + l, alone.wx, sizeof alone.wx[0]);
                assert_memory_equal(wide[k].wy + l, alone.wy, sizeof alone.wy[0]);
            }
            assert_true(!isnan(a.vx[l]) || alone.no_root[0] == 1);
        }
    }
    bench_free(&b);
    bench_free(&none);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_prandtl), cmocka_unit_test(test_betz),    cmocka_unit_test(test_glauert),
        cmocka_unit_test(test_random),  cmocka_unit_test(test_brent),   cmocka_unit_test(test_region),
        cmocka_unit_test(test_mirror),  cmocka_unit_test(test_corners), cmocka_unit_test(test_continuous),
        cmocka_unit_test(test_no_jump), cmocka_unit_test(test_off),     cmocka_unit_test(test_lanes)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
