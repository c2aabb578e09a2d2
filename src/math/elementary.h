/* Elementary functions without branches and without calls, so that the compiler turns a loop over them into vectors.
   They have the same bits at every width of vectors. Errors are below 4 ulp (tests/math/test_elementary.c). NaN answers
   NaN. They round to nearest: see SPARI_GUARD_ENVIRONMENT. */
#ifndef SPARI_ELEMENTARY_H
#define SPARI_ELEMENTARY_H

#include "lanes.h"

#include <math.h>

/* Adding and subtracting this number rounds |x| < 2^51 to an integer; the last bits of the sum are that integer. */
#define SPARI_ROUNDER 0x1.8p52

/* The magnitude of x with the sign of y. */
static inline SPARI_ALWAYS_INLINE double spari_lane_sign(double x, double y) {
    uint64_t a, b;
    memcpy(&a, &x, sizeof a);
    memcpy(&b, &y, sizeof b);
    a = (a & ~((uint64_t)1 << 63)) | (b & ((uint64_t)1 << 63));
    memcpy(&x, &a, sizeof x);
    return x;
}

/* *s = sin(x), *c = cos(x) for |x| <= 1000. pi / 2 is subtracted in three parts of which the first two are short; the
   polynomials on |r| <= pi / 4 are those of fdlibm. */
static inline SPARI_ALWAYS_INLINE void spari_lane_sincos(double x, double *s, double *c) {
    double shifted = x * M_2_PI + SPARI_ROUNDER, k = shifted - SPARI_ROUNDER;
    uint64_t quarter;
    memcpy(&quarter, &shifted, sizeof quarter);
    double r = ((x - k * 0x1.921fb544p0) - k * 0x1.0b4611a6p-34) - k * 0x1.3198a2e037073p-69, z = r * r;
    double odd = 1.58969099521155010221e-10;
    odd = odd * z - 2.50507602534068634195e-08;
    odd = odd * z + 2.75573137070700676789e-06;
    odd = odd * z - 1.98412698298579493134e-04;
    odd = odd * z + 8.33333333332248946124e-03;
    odd = odd * z - 1.66666666666666324348e-01;
    double even = -1.13596475577881948265e-11;
    even = even * z + 2.08757232129817482790e-09;
    even = even * z - 2.75573143513906633035e-07;
    even = even * z + 2.48015872894767294178e-05;
    even = even * z - 1.38888888888741095749e-03;
    even = even * z + 4.16666666666666019037e-02;
    double sine = r + r * (z * odd), cosine = 1.0 - (0.5 * z - z * z * even);
    int64_t swapped = (int64_t)(quarter & 1), below = (int64_t)(quarter & 2), left = (int64_t)((quarter + 1) & 2);
    double first = swapped != 0 ? cosine : sine, second = swapped != 0 ? sine : cosine;
    *s = below != 0 ? -first : first;
    *c = left != 0 ? -second : second;
}

/* *power = exp(x) and, without loss of digits at 0, *less = exp(x) - 1, for -708 <= x <= 0.5. */
static inline SPARI_ALWAYS_INLINE void spari_lane_exp(double x, double *power, double *less) {
    double shifted = x * M_LOG2E + SPARI_ROUNDER, k = shifted - SPARI_ROUNDER;
    double r = (x - k * 0x1.62e42feep-1) - k * 0x1.a39ef35793c76p-33;
    double sum = 1.0 / 6227020800.0; /* the series of (exp(r) - 1) / r on |r| <= 0.35 */
    sum = sum * r + 1.0 / 479001600.0;
    sum = sum * r + 1.0 / 39916800.0;
    sum = sum * r + 1.0 / 3628800.0;
    sum = sum * r + 1.0 / 362880.0;
    sum = sum * r + 1.0 / 40320.0;
    sum = sum * r + 1.0 / 5040.0;
    sum = sum * r + 1.0 / 720.0;
    sum = sum * r + 1.0 / 120.0;
    sum = sum * r + 1.0 / 24.0;
    sum = sum * r + 1.0 / 6.0;
    sum = sum * r + 0.5;
    sum = r + r * r * sum;
    uint64_t bits;
    memcpy(&bits, &shifted, sizeof bits);
    bits = (bits + 1023) << 52; /* 2^k: only the last bits of the integer are left */
    double scale;
    memcpy(&scale, &bits, sizeof scale);
    *power = scale + scale * sum;
    *less = (scale - 1.0) + scale * sum;
}

/* atan2(y, x). The smaller over the larger is brought into [0, sqrt(2) - 1] by pi / 4; there (atan(t) / t - 1) / t^2 is
   interpolated in the zeros of a Chebyshev polynomial, which leaves 5e-18. */
static inline SPARI_ALWAYS_INLINE double spari_lane_atan2(double y, double x) {
    double up = fabs(y), wide = fabs(x), small = up < wide ? up : wide, large = up < wide ? wide : up;
    int64_t steep = up > wide, upper = small > 0.41421356237309503 * large;
    double over = upper != 0 ? small - large : small, under = upper != 0 ? small + large : large;
    double t = over / (under == 0.0 ? 1.0 : under), z = t * t;
    double sum = -0.019176885636589051899;
    sum = sum * z + 0.039231657085083686644;
    sum = sum * z - 0.050854496960392585335;
    sum = sum * z + 0.058581489047951238442;
    sum = sum * z - 0.066645114464602189808;
    sum = sum * z + 0.076921831907606508702;
    sum = sum * z - 0.090909045781210852;
    sum = sum * z + 0.11111111015256292406;
    sum = sum * z - 0.14285714284666542061;
    sum = sum * z + 0.19999999999995520674;
    sum = sum * z - 0.3333333333333333016;
    double angle = t + t * (z * sum);
    angle = upper != 0 ? 0.25 * M_PI + (angle + 0x1.1a62633145c07p-55) : angle; /* pi / 4 in two parts */
    angle = steep != 0 ? 0.5 * M_PI - (angle - 0x1.1a62633145c07p-54) : angle;
    angle = spari_lane_sign(1.0, x) < 0.0 ? M_PI - (angle - 0x1.1a62633145c07p-53) : angle;
    return spari_lane_sign(angle, y);
}

#endif
