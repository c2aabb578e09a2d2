/* Sums that do not depend on the order of their terms: see bins.h. */
#include "bins.h"

#include <math.h>

/* Exponent of the last bit of a bin. */
static int last_bit(int64_t bin) {
    return (int)bin * SPARI_BIN_WIDTH + SPARI_BIN_LAST;
}

/* The part of a number in a bin is at most 2^31 units. The next bin above rounds this to zero, because its last bit
   is even. */
int64_t spari_bins_top(double most) {
    int exponent;
    double f = frexp(most, &exponent); /* most <= 2^exponent, and = 2^(exponent - 1) for f = 1/2 */
    int over = (f > 0.5 ? exponent : exponent - 1) - (SPARI_BIN_WIDTH - 1) - SPARI_BIN_LAST;
    return most > 0 && over > 0 ? (over + SPARI_BIN_WIDTH - 1) / SPARI_BIN_WIDTH : 0;
}

void spari_bins_cut(int64_t top, spari_bin_cut *cut) {
    enum { HIGH = 64, LOW = 4, DOWN = -128, UP = 256, MANTISSA = 52 };
    int by = top >= HIGH ? DOWN : top <= LOW ? UP : 0;
    cut->top = top;
    cut->most = ldexp(1, last_bit(top) + SPARI_BIN_WIDTH - 1);
    cut->scale = ldexp(1, by);
    for (int j = 0; j < SPARI_BINS; j++) {
        int unit = last_bit(top - j) + by;
        cut->shift[j] =
            ldexp(1.5, unit + MANTISSA); /* its last bit is the last bit of the bin, for sums of either sign */
        cut->per_unit[j] = ldexp(1, -unit);
    }
}

void spari_bins_add(spari_bins *sum, double x) {
    spari_bins one = {.top = spari_bins_top(fabs(x))};
    spari_bin_cut cut;
    spari_bins_cut(one.top, &cut);
    double left = x * cut.scale;
    for (int j = 0; j < SPARI_BINS; j++) {
        double part = (left + cut.shift[j]) - cut.shift[j];
        one.part[j] = (int64_t)(part * cut.per_unit[j]);
        left -= part;
    }
    spari_bins_merge(sum, &one);
}

/* Overflow wraps; its only consequence is a wrong sum. */
static int64_t add_whole(int64_t a, int64_t b) {
    return (int64_t)((uint64_t)a + (uint64_t)b);
}

void spari_bins_merge(spari_bins *into, const spari_bins *from) {
    spari_bins sum = into->top >= from->top ? *into : *from;
    const spari_bins *low = into->top >= from->top ? from : into;
    int64_t down = sum.top - low->top;
    for (int64_t j = down; j < SPARI_BINS; j++) {
        sum.part[j] = add_whole(sum.part[j], low->part[j - down]);
    }
    *into = sum;
}

void spari_bins_double(spari_bins *sum) {
    for (int j = 0; j < SPARI_BINS; j++) {
        sum->part[j] = add_whole(sum->part[j], sum->part[j]);
    }
}

void spari_bins_merge_half(spari_bins *into, const spari_bins *from, int sign) {
    spari_bins half = {.top = from->top};
    for (int j = 0; j < SPARI_BINS; j++) {
        half.part[j] = sign * (from->part[j] / 2);
    }
    spari_bins_merge(into, &half);
}

/* The upper 64 bits of |high 2^64 + low|. The last of them is set if any lower bit is set. The conversion to double
   rounds once. */
static double round_whole(int64_t high, uint64_t low, int exponent) {
    int negative = high < 0;
    uint64_t h = (uint64_t)high, l = low;
    if (negative) {
        l = 0 - l;
        h = ~h + (l == 0);
    }
    int shift = 0;
    while (shift < 63 && h >> shift) {
        shift++;
    }
    if (shift > 0) {
        uint64_t lost = l & ((UINT64_C(1) << shift) - 1);
        l = h << (64 - shift) | l >> shift | (lost != 0);
    }
    double x = ldexp((double)l, exponent + shift);
    return negative ? -x : x;
}

double spari_bins_value(const spari_bins *sum) {
    const int64_t unit = INT64_C(1) << SPARI_BIN_WIDTH;
    int64_t part[SPARI_BINS] = {sum->part[0], sum->part[1], sum->part[2]};
    for (int j = SPARI_BINS - 1; j > 0;
         j--) { /* carries what exceeds a bin to the next one: 0 <= part < unit remains */
        int64_t rest = part[j] % unit;
        rest += rest < 0 ? unit : 0;
        part[j - 1] = add_whole(part[j - 1], part[j] / unit - (part[j] % unit < 0));
        part[j] = rest;
    }
    return round_whole(part[0], (uint64_t)part[1] << SPARI_BIN_WIDTH | (uint64_t)part[2], last_bit(sum->top - 2));
}
