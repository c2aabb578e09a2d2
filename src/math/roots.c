/* All zeros of a polynomial, by the three-stage algorithm of Jenkins and Traub: see roots.h. */
#include "roots.h"

#include "../base/status.h"

#include <complex.h>
#include <float.h>
#include <math.h>
#include <string.h>

/* The algorithm. For a polynomial p of degree n it computes polynomials K of degree n - 1 that converge to p divided
   by the factor of the wanted zeros, (x - s) or x^2 + u x + v.
   1. Five steps without shift separate the zeros of small modulus.
   2. Steps with a fixed shift, a complex pair with the modulus of the smallest zero, until the estimates of u and v,
     or of s, converge.
   3. Steps with the estimate as shift, which converge faster than quadratically.
   The factor found is divided out, and the quotient is next. Coefficients below are in falling powers: p[0] x^n +
     ... + p[n]. */

enum { SIZE = SPARI_MAX_DEGREE + 1, SHIFTS = 20 };

/* Normalisation of the scalars of the next K (by the larger of c and d), or UNSCALED: K is divisible by the factor. */
typedef enum scaling { BY_C, BY_D, UNSCALED } scaling;

typedef struct finder {
    int n;                         /* degree of p */
    double p[SIZE], qp[SIZE];      /* polynomial, and its quotient by the shift's factor */
    double k[SIZE], qk[SIZE];      /* K and its quotient */
    double u, v;                   /* x^2 + u x + v */
    double a, b, c, d;             /* remainders: b (x + u) + a of p, d (x + u) + c of K */
    double a1, a3, a7, e, f, g, h; /* scalars of the next K */
    double re[2], im[2];           /* zeros just found */
} finder;

/* q = p / (x^2 + u x + v), remainder *b (x + u) + *a; n: degree of p */
static void divide(int n, const double *p, double u, double v, double *q, double *a, double *b) {
    *b = p[0];
    q[0] = *b;
    *a = p[1] - u * *b;
    q[1] = *a;
    for (int i = 2; i <= n; i++) {
        double c = p[i] - u * *a - v * *b;
        q[i] = c;
        *b = *a;
        *a = c;
    }
}

/* Zeros of a x^2 + b x + c, the smaller first, without cancellation and without overflow. */
static void roots_of_quadratic(double a, double b, double c, double re[2], double im[2]) {
    re[0] = re[1] = im[0] = im[1] = 0;
    if (a == 0) {
        re[0] = b != 0 ? -c / b : 0;
        return;
    }
    if (c == 0) {
        re[1] = -b / a;
        return;
    }
    double half = b / 2, size, sign;
    if (fabs(half) < fabs(c)) {
        sign = half * (half / fabs(c)) - (c >= 0 ? a : -a);
        size = sqrt(fabs(sign)) * sqrt(fabs(c));
    } else {
        sign = 1 - (a / half) * (c / half);
        size = sqrt(fabs(sign)) * fabs(half);
    }
    if (sign < 0) {
        re[0] = re[1] = -half / a;
        im[0] = fabs(size / a), im[1] = -im[0];
        return;
    }
    re[1] = (-half + (half >= 0 ? -size : size)) / a;
    re[0] = re[1] != 0 ? c / re[1] / a : 0;
}

/* Divides K by the shift's factor and forms the scalars with which the next K and the next estimate are made. */
static scaling make_scalars(finder *w) {
    const double eps = 100 * DBL_EPSILON;
    divide(w->n - 1, w->k, w->u, w->v, w->qk, &w->c, &w->d);
    if (fabs(w->c) <= eps * fabs(w->k[w->n - 1]) && fabs(w->d) <= eps * fabs(w->k[w->n - 2])) {
        return UNSCALED;
    }
    w->h = w->v * w->b;
    if (fabs(w->d) >= fabs(w->c)) {
        w->e = w->a / w->d;
        w->f = w->c / w->d;
        w->g = w->u * w->b;
        w->a3 = (w->a + w->g) * w->e + w->h * (w->b / w->d);
        w->a1 = w->b * w->f - w->a;
        w->a7 = (w->f + w->u) * w->a + w->h;
        return BY_D;
    }
    w->e = w->a / w->c;
    w->f = w->d / w->c;
    w->g = w->u * w->e;
    w->a3 = w->a * w->e + (w->h / w->c + w->g) * w->b;
    w->a1 = w->b - w->a * (w->d / w->c);
    w->a7 = w->a + w->g * w->d + w->h * w->f;
    return BY_C;
}

static void next_k(finder *w, scaling by) {
    int n = w->n;
    if (by == UNSCALED) {
        w->k[0] = w->k[1] = 0;
        for (int i = 2; i < n; i++) {
            w->k[i] = w->qk[i - 2];
        }
        return;
    }
    if (fabs(w->a1) <=
        fabs(by == BY_C ? w->b : w->a) * DBL_EPSILON * 10) { /* a1 is nearly zero: use another multiple of K */
        w->k[0] = 0;
        w->k[1] = -w->a7 * w->qp[0];
        for (int i = 2; i < n; i++) {
            w->k[i] = w->a3 * w->qk[i - 2] - w->a7 * w->qp[i - 1];
        }
        return;
    }
    w->a7 /= w->a1;
    w->a3 /= w->a1;
    w->k[0] = w->qp[0];
    w->k[1] = w->qp[1] - w->a7 * w->qp[0];
    for (int i = 2; i < n; i++) {
        w->k[i] = w->a3 * w->qk[i - 2] - w->a7 * w->qp[i - 1] + w->qp[i];
    }
}

/* New estimate of the quadratic factor; zeros if there is none. */
static void estimate(const finder *w, scaling by, double *u, double *v) {
    const double *p = w->p, *k = w->k;
    int n = w->n;
    *u = *v = 0;
    if (by == UNSCALED) {
        return;
    }
    double a4, a5;
    if (by == BY_D) {
        a4 = (w->a + w->g) * w->f + w->h;
        a5 = (w->f + w->u) * w->c + w->v * w->d;
    } else {
        a4 = w->a + w->u * w->b + w->h * w->f;
        a5 = w->c + (w->u + w->v * w->f) * w->d;
    }
    double b1 = -k[n - 1] / p[n], b2 = -(k[n - 2] + b1 * p[n - 1]) / p[n];
    double c1 = w->v * b2 * w->a1, c2 = b1 * w->a7, c3 = b1 * b1 * w->a3, c4 = c1 - c2 - c3;
    double below = a5 + b1 * a4 - c4;
    if (below != 0) {
        *u = w->u - (w->u * (c3 + c2) + w->v * (b1 * w->a1 + b2 * w->a7)) / below;
        *v = w->v * (1 + c4 / below);
    }
}

/* Bound of the rounding error of p at the zero (re, im) of the quadratic, evaluated with its quotient. */
static double quadratic_rounding(const finder *w, double re) {
    double size = sqrt(fabs(w->v)), sum = 2 * fabs(w->qp[0]), t = -re * w->b;
    for (int i = 1; i < w->n; i++) {
        sum = sum * size + fabs(w->qp[i]);
    }
    sum = sum * size + fabs(w->a + t);
    return DBL_EPSILON * (9 * sum - 7 * (fabs(w->a + t) + fabs(w->b) * size) + 2 * fabs(t));
}

/* Stage 3 for a quadratic factor. Returns 2 if its zeros are found. These are complex, equal, or close in modulus. */
static int quadratic_iteration(finder *w, double u, double v) {
    int stirred = 0;
    double before = 0, step = 0;
    w->u = u, w->v = v;
    for (int j = 0; j <= 20;) {
        roots_of_quadratic(1, w->u, w->v, w->re, w->im);
        if (fabs(fabs(w->re[0]) - fabs(w->re[1])) > 0.01 * fabs(w->re[1])) {
            return 0; /* two separate real zeros: better found one by one */
        }
        divide(w->n, w->p, w->u, w->v, w->qp, &w->a, &w->b);
        double size = fabs(w->a - w->re[0] * w->b) + fabs(w->im[0] * w->b);
        if (size <= 20 * quadratic_rounding(w, w->re[0])) {
            return 2;
        }
        if (++j > 20) {
            return 0;
        }
        if (j >= 2 && step <= 0.01 && size >= before &&
            !stirred) { /* stalled at a cluster: perturb the shift, then five steps */
            step = sqrt(fmax(step, DBL_EPSILON));
            w->u -= w->u * step;
            w->v += w->v * step;
            divide(w->n, w->p, w->u, w->v, w->qp, &w->a, &w->b);
            for (int i = 0; i < 5; i++) {
                next_k(w, make_scalars(w));
            }
            stirred = 1;
            j = 0;
        }
        before = size;
        next_k(w, make_scalars(w));
        estimate(w, make_scalars(w), &u, &v);
        if (v == 0) {
            return 0;
        }
        step = fabs((v - w->v) / v);
        w->u = u, w->v = v;
    }
    return 0;
}

/* Stage 3 for a real zero from *s. Returns 1 if it is found. *cluster: the iteration stalls at *s as at a double
   zero. */
static int linear_iteration(finder *w, double *s, int *cluster) {
    int n = w->n;
    double x = *s, before = 0, t = 0;
    *cluster = 0;
    for (int j = 0;;) {
        double value = w->p[0], sum = fabs(value) / 2;
        w->qp[0] = value;
        for (int i = 1; i <= n; i++) {
            value = value * x + w->p[i];
            w->qp[i] = value;
            sum = sum * fabs(x) + fabs(value);
        }
        double size = fabs(value);
        if (size <= 20 * DBL_EPSILON * (2 * sum - size)) {
            w->re[0] = x, w->im[0] = 0;
            return 1;
        }
        if (++j > 10) {
            return 0;
        }
        if (j >= 2 && fabs(t) <= 0.001 * fabs(x - t) && size > before) {
            *cluster = 1;
            *s = x;
            return 0;
        }
        before = size;
        double kv = w->k[0];
        w->qk[0] = kv;
        for (int i = 1; i < n; i++) {
            kv = kv * x + w->k[i];
            w->qk[i] = kv;
        }
        if (fabs(kv) > fabs(w->k[n - 1]) * 10 * DBL_EPSILON) {
            t = -value / kv;
            w->k[0] = w->qp[0];
            for (int i = 1; i < n; i++) {
                w->k[i] = t * w->qk[i - 1] + w->qp[i];
            }
        } else {
            w->k[0] = 0;
            for (int i = 1; i < n; i++) {
                w->k[i] = w->qk[i - 1];
            }
        }
        kv = w->k[0];
        for (int i = 1; i < n; i++) {
            kv = kv * x + w->k[i];
        }
        t = fabs(kv) > fabs(w->k[n - 1]) * 10 * DBL_EPSILON ? -value / kv : 0;
        x += t;
    }
}

/* Stage 3 from estimates that passed the tests: the more promising kind first, then the other with the original K.
   If a real iteration stalls at two close zeros, the quadratic with both is tried. Returns the number of zeros
   found. */
SPARI_APART static int stage_three(finder *w, double u, double v, double s, int try_v, int try_s, int s_first,
                                   int *failed_v, int *failed_s) {
    double saved[SIZE];
    const double shift_u = w->u, shift_v = w->v;
    memcpy(saved, w->k, sizeof *saved * (size_t)w->n);
    for (int turn = 0; turn < 2; turn++) {
        int real = turn == 0 ? s_first : !s_first, cluster = 0, found;
        if (!(real ? try_s : try_v)) {
            continue;
        }
        found = real ? linear_iteration(w, &s, &cluster) : quadratic_iteration(w, u, v);
        if (found == 0 && cluster) {
            found = quadratic_iteration(w, -2 * s, s * s);
        }
        if (found) {
            return found;
        }
        *(real ? failed_s : failed_v) = 1;
        w->u = shift_u, w->v = shift_v;
        memcpy(w->k, saved, sizeof *saved * (size_t)w->n);
    }
    divide(w->n, w->p, w->u, w->v, w->qp, &w->a, &w->b);
    return 0;
}

/* Stage 2: at most `steps` with a fixed shift (u, v). Two successive estimates with decreasing changes (product
   below 1/4, less after each failed attempt) lead to stage 3. Returns the number of zeros found. */
static int fixed_shift(finder *w, int steps, double real_part, double modulus) {
    double limit_v = 0.25, limit_s = 0.25, last_v = modulus * modulus, last_s = real_part, change_v = 1, change_s = 1;
    w->u = -2 * real_part, w->v = modulus * modulus;
    divide(w->n, w->p, w->u, w->v, w->qp, &w->a, &w->b);
    scaling by = make_scalars(w);
    for (int j = 1; j <= steps; j++) {
        double u, v, s, tv = 1, ts = 1;
        next_k(w, by);
        by = make_scalars(w);
        estimate(w, by, &u, &v);
        s = w->k[w->n - 1] != 0 ? -w->p[w->n] / w->k[w->n - 1] : 0;
        if (j > 1 && by != UNSCALED) {
            tv = v != 0 ? fabs((v - last_v) / v) : 1;
            ts = s != 0 ? fabs((s - last_s) / s) : 1;
            double both_v = tv < change_v ? tv * change_v : 1, both_s = ts < change_s ? ts * change_s : 1;
            int pass_v = both_v < limit_v, pass_s = both_s < limit_s;
            if (pass_v || pass_s) {
                int failed_v = 0, failed_s = 0;
                int found = stage_three(w, u, v, s, pass_v, pass_s, pass_s && (!pass_v || both_s < both_v), &failed_v,
                                        &failed_s);
                if (found) {
                    return found;
                }
                limit_v *= failed_v ? 0.25 : 1;
                limit_s *= failed_s ? 0.25 : 1;
                by = make_scalars(w);
            }
        }
        last_v = v, last_s = s, change_v = tv, change_s = ts;
    }
    return 0;
}

/* Stage 1: K from the derivative, by five steps without shift. */
static void no_shift(finder *w) {
    int n = w->n;
    for (int i = 0; i < n; i++) {
        w->k[i] = (n - i) * w->p[i] / n;
    }
    int vanishes = w->k[n - 1] == 0;
    for (int step = 0; step < 5; step++) {
        double t = vanishes ? 0 : -w->p[n] / w->k[n - 1];
        for (int i = n - 1; i > 0; i--) {
            w->k[i] = vanishes ? w->k[i - 1] : t * w->k[i - 1] + w->p[i];
        }
        w->k[0] = vanishes ? 0 : w->p[0];
        vanishes = vanishes ? w->k[n - 1] == 0 : fabs(w->k[n - 1]) <= fabs(w->p[n - 1]) * DBL_EPSILON * 10;
    }
}

/* Scales coefficients of extreme size towards 1 by a power of two, without rounding. */
static void scale_coefficients(finder *w) {
    double most = 0, least = HUGE_VAL;
    for (int i = 0; i <= w->n; i++) {
        double x = fabs(w->p[i]);
        most = fmax(most, x);
        least = x > 0 ? fmin(least, x) : least;
    }
    double low = DBL_MIN / DBL_EPSILON, factor = low / least;
    if ((factor <= 1 && most < 10) || (factor > 1 && DBL_MAX / factor < most)) {
        return;
    }
    int power = (int)floor(log2(factor > 0 ? factor : DBL_MIN) + 0.5);
    power = factor <= 1 ? (int)fmax(power, -ilogb(most)) : power; /* down to 1, not below */
    for (int i = 0; i <= w->n && power; i++) {
        w->p[i] = ldexp(w->p[i], power);
    }
}

/* Cauchy's lower bound of the moduli of the zeros: the positive zero of |p0| x^n + ... + |p(n-1)| x - |pn|, to two
   digits. */
static double lower_bound(const finder *w) {
    int n = w->n;
    double p[SIZE];
    for (int i = 0; i <= n; i++) {
        p[i] = fabs(w->p[i]);
    }
    p[n] = -p[n];
    double x = exp((log(-p[n]) - log(p[0])) / n);
    if (p[n - 1] != 0) {
        x = fmin(x, -p[n] / p[n - 1]);
    }
    for (double small = 0.1 * x;; small *= 0.1) { /* until the sum becomes negative */
        double f = p[0];
        for (int i = 1; i <= n; i++) {
            f = f * small + p[i];
        }
        if (f <= 0) {
            break;
        }
        x = small;
    }
    for (double step = x; fabs(step / x) > 0.005; x -= step) {
        double f = p[0], df = p[0];
        for (int i = 1; i < n; i++) {
            f = f * x + p[i];
            df = df * x + f;
        }
        f = f * x + p[n];
        step = f / df;
    }
    return x;
}

/* Finds the next one or two zeros of p; returns 0 after twenty failed shifts. Each shift is rotated by 94 degrees. */
SPARI_APART static int search_roots(finder *w) {
    const double turn_c = -0.069756473744125, turn_s = 0.997564050259824; /* cos, sin of 94 degrees */
    double c = 0.707106781186547524, s = -c, first[SIZE];
    scale_coefficients(w);
    double bound = lower_bound(w);
    no_shift(w);
    memcpy(first, w->k, sizeof *first * (size_t)w->n);
    for (int shift = 1; shift <= SHIFTS; shift++) {
        double turned = turn_c * c - turn_s * s;
        s = turn_s * c + turn_c * s;
        c = turned;
        int found = fixed_shift(w, 20 * shift, bound * c, bound);
        if (found) {
            return found;
        }
        memcpy(w->k, first, sizeof *first * (size_t)w->n);
    }
    return 0;
}

/* p(z) / p'(z) for c in rising powers, or 0 if |p(z)| is below rounding. Outside the unit circle it uses the
   reversed polynomial in 1/z, so that no power overflows. */
static double complex newton_step(int n, const double *c, double complex z) {
    int inside = cabs(z) <= 1;
    double complex x = inside ? z : 1 / z, value = 0, slope = 0;
    double size = cabs(x), sum = 0;
    for (int i = 0; i <= n; i++) {
        double next = c[inside ? n - i : i];
        slope = slope * x + value;
        value = value * x + next;
        sum = sum * size + fabs(next);
    }
    if (cabs(value) <= 4 * DBL_EPSILON * sum) {
        return 0;
    }
    return inside ? value / slope : value / ((n * value - slope * x) * x);
}

/* Each zero was found on a quotient, which carries the errors of the zeros before it. All zeros are refined on the
   original polynomial by the simultaneous Newton steps of Ehrlich and Aberth, which keep them apart. Conjugate pairs
   stay pairs, real zeros stay real. */
static void polish(int n, const double *c, double *re, double *im) {
    for (int sweep = 0, moving = 1; sweep < 30 && moving; sweep++) {
        moving = 0;
        for (int k = 0; k < n; k++) {
            double complex z = re[k] + im[k] * _Complex_I, step = newton_step(n, c, z), others = 0;
            int pair = im[k] != 0;
            for (int j = 0; j < n && step != 0; j++) {
                double complex d = z - (re[j] + im[j] * _Complex_I);
                others += j != k && d != 0 ? 1 / d : 0;
            }
            step /= 1 - step * others;
            if (isfinite(creal(step)) && isfinite(cimag(step)) && cabs(step) > DBL_EPSILON * cabs(z)) {
                moving = 1;
                re[k] -= creal(step);
                im[k] -= pair ? cimag(step) : 0;
            }
            if (pair) { /* followed by its conjugate */
                re[k + 1] = re[k], im[k + 1] = -im[k];
                k++;
            }
        }
    }
}

int spari_roots(int degree, const double *c, double *re, double *im) {
    finder w;
    int count = 0;
    if (degree < 0 || degree > SPARI_MAX_DEGREE) {
        return -1;
    }
    for (int i = 0; i <= degree; i++) {
        if (!isfinite(c[i])) {
            return -1;
        }
    }
    while (degree >= 0 && c[degree] == 0) {
        degree--;
    }
    if (degree < 0) {
        return -1;
    }
    for (; c[0] == 0; c++, degree--, count++) { /* zeros at the origin */
        re[count] = im[count] = 0;
    }
    const int origin = count;
    w.n = degree;
    for (int i = 0; i <= degree; i++) {
        w.p[i] = c[degree - i];
    }
    while (w.n > 2) {
        int found = search_roots(&w);
        if (!found) {
            return count;
        }
        for (int i = 0; i < found; i++, count++) {
            re[count] = w.re[i], im[count] = w.im[i];
        }
        w.n -= found;
        memcpy(w.p, w.qp, sizeof *w.p * (size_t)(w.n + 1));
    }
    if (w.n == 2) {
        roots_of_quadratic(w.p[0], w.p[1], w.p[2], re + count, im + count);
        count += 2;
    } else if (w.n == 1) {
        re[count] = -w.p[1] / w.p[0], im[count] = 0;
        count++;
    }
    polish(degree, c, re + origin, im + origin);
    return count;
}
