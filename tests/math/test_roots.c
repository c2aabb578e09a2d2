/* Zeros of polynomials: the set of Jenkins and Traub (ACM TOMS 1 (1975) 26), whose zeros are known. A zero of
 * multiplicity m moves by ( e sum |c_i| |z|^i m! / |p^(m)(z)| )^(1/m) when every coefficient moves by a part e. The
 * tolerance is that with e = 64 roundings: what no algorithm in double can be much better than, and what deflation in
 * order of modulus keeps to. */
#include "math/roots.h"
#include <cmocka.h>
#include <complex.h>
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { MOST = SPARI_MAX_DEGREE };

typedef struct problem {
    int n;
    long double complex z[MOST];
    double c[MOST + 1]; /* rising powers */
} problem;

static void add(problem *p, long double complex z) {
    p->z[p->n++] = z;
}

static void add_pair(problem *p, long double re, long double im) {
    add(p, re + im * _Complex_I);
    add(p, re - im * _Complex_I);
}

/* The next factor to multiply: the one farthest from those multiplied (Leja's order), so that no partial product is
 * large. */
static int farthest(const problem *p, const int *done) {
    int best = -1;
    long double most = -1;
    for (int k = 0; k < p->n; k++) {
        long double product = cabsl(p->z[k]);
        for (int j = 0; j < p->n; j++) {
            product *= done[j] && p->z[j] != p->z[k] ? cabsl(p->z[k] - p->z[j]) : 1;
        }
        if (!done[k] && product > most) {
            most = product, best = k;
        }
    }
    return best;
}

/* Multiplies the factors in long double; rounds once. */
static void expand(problem *p) {
    long double complex c[MOST + 1] = {1};
    int done[MOST] = {0};
    for (int n = 0; n < p->n; n++) {
        int k = farthest(p, done);
        done[k] = 1;
        c[n + 1] = c[n];
        for (int i = n; i > 0; i--) {
            c[i] = c[i - 1] - p->z[k] * c[i];
        }
        c[0] *= -p->z[k];
    }
    for (int i = 0; i <= p->n; i++) {
        p->c[i] = (double)creall(c[i]);
    }
}

/* What rounding the coefficients to e can do to the zero z of multiplicity m. */
static double reach(const problem *p, long double complex z, int m, double e) {
    long double sum = 0, size = 1;
    for (int i = 0; i <= p->n; i++) {
        sum += fabsl((long double)p->c[i]) * size;
        size *= cabsl(z);
    }
    long double complex value = p->c[p->n]; /* p^(m)(z) / m! is the product of the other factors */
    for (int k = 0; k < p->n; k++) {
        if (p->z[k] != z) {
            value *= z - p->z[k];
        }
    }
    return (double)powl(e * sum / cabsl(value), 1.0L / m);
}

static int multiplicity(const problem *p, long double complex z) {
    int m = 0;
    for (int k = 0; k < p->n; k++) {
        m += p->z[k] == z;
    }
    return m;
}

/* Every zero is found, each within its reach: zeros are paired with the nearest still free. Returns the worst ratio. */
static double check(const char *name, problem *p, double e) {
    double re[MOST], im[MOST], worst = 0;
    int taken[MOST] = {0};
    assert_int_equal(spari_roots(p->n, p->c, re, im), p->n);
    for (int k = 0; k < p->n; k++) {
        int best = -1;
        long double least = HUGE_VALL;
        for (int j = 0; j < p->n; j++) {
            long double d = cabsl(re[j] + im[j] * _Complex_I - p->z[k]);
            if (!taken[j] && d < least) {
                least = d, best = j;
            }
        }
        taken[best] = 1;
        double allowed = reach(p, p->z[k], multiplicity(p, p->z[k]), e) + 4 * DBL_EPSILON * (double)cabsl(p->z[k]);
        worst = fmax(worst, (double)least / allowed);
    }
    if (worst > 1) {
        print_message("%s: worst zero at %.2g of what its condition allows\n", name, worst);
    }
    return worst;
}

#define CHECK(name, p) assert_true(check(name, p, 64 * DBL_EPSILON) <= 1)

static void jenkins_traub_real(void **state) {
    (void)state;
    static const double huge[] = {1e10, 1e-10};
    for (int k = 0; k < 2; k++) {
        problem p = {0};
        add(&p, huge[k]), add(&p, -huge[k]), add(&p, 1);
        expand(&p);
        CHECK("jt01", &p);
    }
    problem wilkinson = {0}, small = {0}, four = {0}, five = {0}, cluster = {0};
    for (int i = 1; i <= 17; i++) {
        add(&wilkinson, i);
    }
    for (int i = 1; i <= 8; i++) {
        add(&small, powl(10, -i));
    }
    for (int i = 0; i < 3; i++) {
        add(&four, 0.1L);
    }
    add(&four, 0.5L), add(&four, 0.6L), add(&four, 0.7L);
    for (int i = 4; i > 0; i--) {
        for (int j = 0; j < i; j++) {
            add(&five, 0.1L * (5 - i));
        }
    }
    add(&cluster, 0.1L), add(&cluster, 1.001L), add(&cluster, 0.998L), add(&cluster, 1.00002L), add(&cluster, 0.99999L);
    problem *all[] = {&wilkinson, &small, &four, &five, &cluster};
    static const char *const name[] = {"jt02", "jt03", "jt04", "jt05", "jt06"};
    for (int k = 0; k < 5; k++) {
        expand(all[k]);
        CHECK(name[k], all[k]);
    }
}

static void jenkins_traub_close(void **state) {
    (void)state;
    static const double a[] = {1e-10, 1e-9, 1e-8, 1e-7}, b[] = {1e3, 1e6, 1e9, 1e12};
    for (int k = 0; k < 4; k++) {
        problem p = {0}, q = {0};
        add(&p, 0.001L), add(&p, 0.01L), add(&p, 0.1L), add_pair(&p, 0.1L, a[k]), add(&p, 1), add(&p, -10);
        expand(&p);
        /* to a double, three zeros at 0.1: their reach is that of a triple one, e^(1/3) of the local scale */
        double re[7], im[7];
        assert_int_equal(spari_roots(7, p.c, re, im), 7);
        int near = 0;
        for (int j = 0; j < 7; j++) {
            near += hypot(re[j] - 0.1, im[j]) < 0.1 * cbrt(1e4 * DBL_EPSILON);
        }
        assert_int_equal(near, 3);
        add(&q, b[k]), add(&q, 1), add(&q, 1 / (long double)b[k]);
        expand(&q);
        CHECK("jt10", &q);
    }
    problem fold = {0}, circles = {0};
    for (int i = 0; i < 5; i++) {
        add(&fold, -1);
    }
    expand(&fold);
    CHECK("jt08", &fold);
    const long double pi = 3.141592653589793238462643383279L;
    for (int i = 0; i < 5; i++) {
        long double t = pi * (2 * i + 1) / 10;
        add_pair(&circles, 100 * cosl(t), 100 * sinl(t));
        if (i > 0) {
            add_pair(&circles, 0.01L * cosl(pi * i / 5), 0.01L * sinl(pi * i / 5));
        }
    }
    add(&circles, 0.01L), add(&circles, -0.01L);
    circles.c[20] = 1, circles.c[10] = 1e20 - 1e-20, circles.c[0] = -1;
    CHECK("jt09", &circles);
}

/* Zeros on the unit circle's right half and on 0.9 times its left half: stable only when deflated in order of modulus.
 */
static void jenkins_traub_circles(void **state) {
    (void)state;
    const long double pi = 3.141592653589793238462643383279L;
    for (int m = 5; m <= 15; m += 5) { /* from 20 on, deflation of degree 80 leaves nothing to set right */
        problem p = {0};
        add(&p, 1), add(&p, -0.9L);
        for (int k = 1; k < m; k++) {
            add_pair(&p, cosl(k * pi / (2 * m)), sinl(k * pi / (2 * m)));
        }
        for (int k = m; k < 2 * m; k++) {
            add_pair(&p, 0.9L * cosl(k * pi / (2 * m)), 0.9L * sinl(k * pi / (2 * m)));
        }
        assert_int_equal(p.n, 4 * m);
        expand(&p);
        CHECK("jt11", &p);
    }
}

/* The driver of Algorithm 493: zeros 1 to 10, coefficients as printed there. */
static void algorithm_493_driver(void **state) {
    (void)state;
    problem p = {0};
    const double falling[] = {1, -55, 1320, -18150, 157773, -902055, 3416930, -8409500, 12753576, -10628640, 3628800};
    for (int i = 0; i <= 10; i++) {
        p.c[10 - i] = falling[i];
    }
    for (int i = 1; i <= 10; i++) {
        add(&p, i);
    }
    CHECK("493", &p);
}

/* Behaviour at the edges: trimming, zeros at the origin, low degrees, extreme scales, refusals. */
static void edges(void **state) {
    (void)state;
    double re[8], im[8];
    const double trimmed[] = {0, 0, 6, -5, 1, 0, 0}; /* x^2 (x - 2)(x - 3) and two leading zeros */
    assert_int_equal(spari_roots(6, trimmed, re, im), 4);
    assert_true(re[0] == 0 && re[1] == 0 && fabs(re[2] - 2) < 1e-15 && fabs(re[3] - 3) < 1e-15);
    const double line[] = {3, -2}, constant[] = {4}, nothing[] = {0, 0, 0}, bad[] = {1, NAN, 1}, pair[] = {25, -6, 1};
    assert_int_equal(spari_roots(1, line, re, im), 1);
    assert_true(re[0] == 1.5 && im[0] == 0);
    assert_int_equal(spari_roots(0, constant, re, im), 0);
    assert_int_equal(spari_roots(2, nothing, re, im), -1);
    assert_int_equal(spari_roots(2, bad, re, im), -1);
    assert_int_equal(spari_roots(-1, constant, re, im), -1);
    assert_int_equal(spari_roots(SPARI_MAX_DEGREE + 1, constant, re, im), -1);
    assert_int_equal(spari_roots(2, pair, re, im), 2);
    assert_true(fabs(re[0] - 3) < 1e-15 && fabs(im[0] - 4) < 1e-15 && re[1] == re[0] && im[1] == -im[0]);
    for (int power = -900; power <= 900; power += 300) { /* (x - 1)(x - 2)(x - 3)(x - 4) times 2^power */
        const double c[] = {24, -50, 35, -10, 1};
        double scaled[5];
        for (int i = 0; i < 5; i++) {
            scaled[i] = ldexp(c[i], power);
        }
        assert_int_equal(spari_roots(4, scaled, re, im), 4);
        for (int i = 0; i < 4; i++) {
            assert_true(fabs(re[i] - (i + 1)) < 1e-12 && im[i] == 0);
        }
    }
}

/* Random polynomials of any degree: every zero comes out, and each makes the polynomial as small as rounding its terms
 * does. */
static void random_polynomials(void **state) {
    (void)state;
    unsigned long long x = 1234567;
    double c[47], re[46], im[46], worst = 0;
    for (int turn = 0; turn < 500; turn++) {
        int n = 3 + turn % 44;
        for (int i = 0; i <= n; i++) {
            x ^= x << 13, x ^= x >> 7, x ^= x << 17;
            c[i] = (double)(x >> 11) / 4503599627370496.0 - 1.0;
        }
        assert_int_equal(spari_roots(n, c, re, im), n);
        for (int k = 0; k < n; k++) {
            long double complex z = re[k] + im[k] * _Complex_I, value = 0;
            long double sum = 0;
            for (int i = n; i >= 0; i--) {
                value = value * z + c[i];
                sum = sum * cabsl(z) + fabsl((long double)c[i]);
            }
            worst = fmax(worst, (double)(cabsl(value) / sum));
        }
    }
    assert_true(worst < 16 * DBL_EPSILON);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(jenkins_traub_real),
        cmocka_unit_test(jenkins_traub_close),
        cmocka_unit_test(jenkins_traub_circles),
        cmocka_unit_test(algorithm_493_driver),
        cmocka_unit_test(edges),
        cmocka_unit_test(random_polynomials),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
