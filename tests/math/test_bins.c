/* Reproducible sums (math/bins.h) against exact ones. The oracle adds doubles in a whole number of 2240 bits, in units
   of 2^-1088, and rounds it once: exact for any doubles. Expected: the same bits in every order and grouping; where all
   numbers lie within the three bins the correctly rounded exact sum, else within n max|x| / 2^64 of it and half a unit
   in the last place (the bound in bins.h, from Demmel and Nguyen 2015). */
#include "math/bins.h"
#include "support/lines.h"

#include <cmocka.h>
#include <float.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#define SAME(a, b) assert_memory_equal(&(a), &(b), sizeof(a))

/* ---- the oracle: two's complement in words of 32 bits, least first ---- */

enum { WORDS = 70 };
typedef struct whole {
    uint32_t word[WORDS];
} whole;

static void whole_add(whole *w, double x) {
    int e;
    int64_t m = (int64_t)ldexp(frexp(x, &e), 53); /* x = m 2^(e - 53) */
    if (m == 0) {
        return;
    }
    uint64_t size = (uint64_t)(m < 0 ? -m : m);
    int shift = e - 53 + 1088;
    uint32_t part[WORDS] = {0};
    for (int b = 0; b < 53; b++) {
        if (size >> b & 1) {
            part[(shift + b) / 32] |= UINT32_C(1) << (shift + b) % 32;
        }
    }
    uint64_t carry = m < 0;
    for (int i = 0; i < WORDS; i++) {
        carry += (uint64_t)w->word[i] + (m < 0 ? ~part[i] : part[i]);
        w->word[i] = (uint32_t)carry;
        carry >>= 32;
    }
}

static double whole_value(const whole *w) {
    whole a = *w;
    int negative = (a.word[WORDS - 1] >> 31) != 0, top = 32 * WORDS - 1;
    uint64_t carry = 1;
    for (int i = 0; negative && i < WORDS; i++) {
        carry += (uint32_t)~a.word[i];
        a.word[i] = (uint32_t)carry;
        carry >>= 32;
    }
    while (top >= 0 && !(a.word[top / 32] >> top % 32 & 1)) {
        top--;
    }
    int last = top - 52 > 14 ? top - 52 : 14; /* 2^-1074 is bit 14 */
    uint64_t m = 0;
    int half = 0, more = 0;
    for (int b = top; b >= 0; b--) {
        int bit = (int)(a.word[b / 32] >> b % 32 & 1);
        if (b >= last) {
            m = 2 * m + (uint64_t)bit;
        } else if (b == last - 1) {
            half = bit;
        } else {
            more |= bit;
        }
    }
    m += half && (more || m % 2);
    double x = ldexp((double)m, last - 1088);
    return negative ? -x : x;
}

static double exact(const double *x, int n) {
    whole w = {{0}};
    for (int i = 0; i < n; i++) {
        whole_add(&w, x[i]);
    }
    return whole_value(&w);
}

/* ---- */

static spari_bins sum_of(const double *x, int n) {
    spari_bins s = {0};
    for (int i = 0; i < n; i++) {
        spari_bins_add(&s, x[i]);
    }
    return s;
}

static void shuffle(double *x, int n, unsigned long long *seed) {
    for (int i = n - 1; i > 0; i--) {
        int j = (int)(0.49999 * (1 + line_random(seed)) * (i + 1));
        double t = x[i];
        x[i] = x[j], x[j] = t;
    }
}

static double any_size(unsigned long long *seed, int least, int most) {
    return ldexp(line_random(seed), (int)(least + 0.5 * (1 + line_random(seed)) * (most - least)));
}

static void one_number_is_itself(void **state) {
    (void)state;
    static const double some[] = {0,
                                  1,
                                  -1,
                                  DBL_MAX,
                                  -DBL_MAX,
                                  DBL_MIN,
                                  DBL_MAX,
                                  DBL_EPSILON,
                                  0x1p-1074,
                                  -0x1p-1074,
                                  0x1p-1057,
                                  0x1.8p-1057,
                                  0x1p31,
                                  0x1p-1,
                                  -0x1.fffffffffffffp-1,
                                  0x1.0000000000001p-33,
                                  0x1p960,
                                  0x1.fp991};
    unsigned long long seed = 1;
    for (int i = 0; i < (int)(sizeof some / sizeof *some); i++) {
        spari_bins s = sum_of(some + i, 1);
        assert_true(spari_bins_value(&s) == some[i]);
    }
    for (int i = 0; i < 100000; i++) {
        double x = any_size(&seed, -1074, 1023);
        spari_bins s = sum_of(&x, 1);
        assert_true(spari_bins_value(&s) == x);
    }
}

/* A number has no part above the bin it is said to be in, and one in it, or by rounding one in the next below. */
static void highest_bins_are_right(void **state) {
    (void)state;
    for (int e = -1074; e <= 1023; e++) {
        for (int k = 0; k < 3; k++) {
            double x = k == 0 ? ldexp(1, e) : k == 1 ? nextafter(ldexp(1, e), 0) : nextafter(ldexp(1, e), INFINITY);
            int64_t top = spari_bins_top(x);
            assert_true(top >= 0 && x <= ldexp(0x1p31, (int)(32 * top - 1088)));
            assert_true(top == 0 || x > ldexp(0x1p31, (int)(32 * top - 1120)));
        }
    }
    assert_int_equal(spari_bins_top(0), 0);
}

static void check_all(double *x, int n, unsigned long long *seed, int within) {
    enum { GROUPS = 7 };
    double most = 0, right = exact(x, n);
    for (int i = 0; i < n; i++) {
        most = fmax(most, fabs(x[i]));
    }
    spari_bins first = sum_of(x, n);
    double got = spari_bins_value(&first);
    if (within) {
        SAME(got, right);
    } else {
        double step = nextafter(fabs(right), INFINITY) - fabs(right);
        assert_true(fabs(got - right) <= n * (most / 0x1p64) + step);
    }
    for (int turn = 0; turn < 5; turn++) {
        shuffle(x, n, seed);
        spari_bins group[GROUPS], sum = {0};
        memset(group, 0, sizeof group);
        for (int i = 0; i < n; i++) {
            spari_bins_add(group + (i * turn + i / 3) % GROUPS, x[i]);
        }
        for (int g = 0; g < GROUPS; g++) {
            spari_bins_merge(&sum, group + (turn % 2 ? g : GROUPS - 1 - g));
        }
        SAME(sum, first);
    }
}

static void any_order_same_bits(void **state) {
    (void)state;
    enum { N = 300 };
    static const int range[][2] = {{-3, 3},     {-60, 60},     {-1074, 1013}, {-1074, -1000},
                                   {950, 1013}, {-1060, -900}, {-40, 0}};
    double x[N];
    unsigned long long seed = 2;
    for (int turn = 0; turn < 210; turn++) {
        const int *r = range[turn % 7];
        int n = 1 + turn % N;
        for (int i = 0; i < n; i++) {
            x[i] = any_size(&seed, r[0], r[1]);
        }
        check_all(x, n, &seed, r[1] <= -1000); /* below 2^-1000 nothing lies below the three bins */
    }
}

/* All numbers with their last bit above 2^-61 of the largest: the exact sum, rounded once, whatever cancels. */
static void exact_within_bins(void **state) {
    (void)state;
    enum { N = 200 };
    double x[N];
    unsigned long long seed = 3;
    for (int turn = 0; turn < 300; turn++) {
        int at = (int)(1000 * line_random(&seed)), n = 2 + turn % (N - 1);
        for (int i = 0; i < n; i++) { /* whole multiples of 2^(at - 60), up to 2^at */
            double size = ldexp(floor(ldexp(line_random(&seed), 52)), (int)(4 * line_random(&seed)) + 4);
            x[i] = ldexp(size, at - 60);
        }
        for (int i = 0; i + 1 < n && turn % 2; i += 2) {
            x[i + 1] = -x[i] + (i == 0 ? ldexp(1, at - 56) : 0);
        }
        check_all(x, n, &seed, 1);
    }
}

static void large_ones_cancel(void **state) {
    (void)state;
    double a[] = {1e300, 1, -1e300, 3}, b[] = {DBL_MAX, DBL_MAX, -DBL_MAX, -1e308}, c[] = {0x1p60, 3, -0x1p60, 0x1p-1},
           d[] = {DBL_MAX, DBL_MAX};
    spari_bins s = sum_of(a, 4);
    assert_true(spari_bins_value(&s) == 0); /* 1 and 3 are 2^-996 of the largest */
    s = sum_of(b, 4);
    assert_true(spari_bins_value(&s) == DBL_MAX - 1e308); /* plain sums overflow on the way */
    s = sum_of(c, 4);
    assert_true(spari_bins_value(&s) == 3.5);
    s = sum_of(d, 2);
    assert_true(spari_bins_value(&s) == INFINITY);
}

/* 2^22 numbers of the greatest part: the sums of parts have room. */
static void many_numbers(void **state) {
    (void)state;
    spari_bins s = {0};
    const int n = 1 << 22;
    for (int i = 0; i < n; i++) {
        spari_bins_add(&s, i % 3 ? 0x1.fffffffffffffp30 : -0x1p-20);
    }
    double thirds = (n - 1) / 3 + 1; /* i = 0, 3, ..., n - 1 */
    double right = (n - thirds) * 0x1.fffffffffffffp30 - thirds * 0x1p-20;
    assert_true(fabs(spari_bins_value(&s) - right) <= 2 * DBL_EPSILON * right);
}

/* Twice a sum of x, half of twice a sum of y added, half of twice a sum of z taken away: as 2 x + y - z, number by
   number, in any grouping; and half of twice a sum is the sum. */
static void halves_of_doubled_sums(void **state) {
    (void)state;
    enum { N = 60, GROUPS = 4 };
    double x[3][N], all[3 * N];
    unsigned long long seed = 4;
    for (int turn = 0; turn < 200; turn++) {
        spari_bins group[GROUPS], together = {0};
        memset(group, 0, sizeof group);
        for (int i = 0; i < 3 * N; i++) {
            x[i / N][i % N] = any_size(&seed, -40, turn % 2 ? 0 : 40);
            all[i] = x[i / N][i % N] * (i < N ? 2 : i < 2 * N ? 1 : -1);
        }
        for (int i = 0; i < 3 * N; i++) {
            spari_bins one = sum_of(&x[i / N][i % N], 1), same = {0}, *to = group + (i + turn) % GROUPS;
            const spari_bins was = one;
            spari_bins_double(&one);
            spari_bins_merge_half(&same, &one, 1);
            SAME(same, was);
            if (i < N) {
                spari_bins_merge(to, &one);
            } else {
                spari_bins_merge_half(to, &one, i < 2 * N ? 1 : -1);
            }
        }
        for (int g = 0; g < GROUPS; g++) {
            spari_bins_merge(&together, group + (turn % 3 ? g : GROUPS - 1 - g));
        }
        double got = spari_bins_value(&together), right = exact(all, 3 * N);
        assert_true(fabs(got - right) <= 4 * N * (turn % 2 ? 0x1p-64 : 0x1p-24) + DBL_EPSILON * fabs(right));
        spari_bins other = {0};
        for (int k = 0; k < 3; k++) {
            spari_bins part = sum_of(x[k], N);
            spari_bins_double(&part);
            if (k == 0) {
                spari_bins_merge(&other, &part);
            } else {
                spari_bins_merge_half(&other, &part, k == 1 ? 1 : -1);
            }
        }
        SAME(other, together);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_number_is_itself),   cmocka_unit_test(highest_bins_are_right),
        cmocka_unit_test(any_order_same_bits),    cmocka_unit_test(exact_within_bins),
        cmocka_unit_test(large_ones_cancel),      cmocka_unit_test(many_numbers),
        cmocka_unit_test(halves_of_doubled_sums),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
