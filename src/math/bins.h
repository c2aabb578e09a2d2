/* Sums that do not depend on the order of their numbers (pre-rounded binned summation; Demmel and Nguyen, IEEE Trans.
   Comput. 64 (2015), and ReproBLAS).

   The line of all exponents is cut at fixed places into bins of 32 bits, and every number into its parts in them, each
   rounded to the last bit of its bin: a part depends on the number alone. A sum keeps whole multiples of the last bits
   of three bins next to each other, of which the highest is the highest that any of its numbers has a part in. Whole
   numbers add without rounding, so any order, and sums of sums, come to the same three numbers. What lies below the
   lowest is left out: n numbers of size at most a are summed to n a / 2^64, and one rounding of the result.

   The parts are taken with rounding to the nearest, as is the floating-point default. Good for 2^31 numbers. */
#ifndef SPARI_BINS_H
#define SPARI_BINS_H

#include <stdint.h>

enum {
    SPARI_BINS = 3,        /* that a sum keeps */
    SPARI_BIN_WIDTH = 32,  /* bits */
    SPARI_BIN_LAST = -1088 /* exponent of the last bit of bin 0, below all denormal numbers */
};

/* Zero bytes: the sum of no numbers. */
typedef struct spari_bins {
    int64_t top;              /* the highest bin */
    int64_t part[SPARI_BINS]; /* from there downwards: sum of the numbers' parts in it, in units of its last bit */
} spari_bins;

/* The highest bin that a finite number of size `most` (>= 0) has a part in. */
int64_t spari_bins_top(double most);

/* How numbers that have no part above bin `top` are taken apart, once for many: of scale x the part in the highest bin
   is (scale x + shift[0]) - shift[0], in units of 1 / per_unit[0]; what is left has its part in the next bin, and so
   on. scale is a power of 2 that keeps shift and per_unit within the range of normal doubles; what it makes too small
   for one has no part in these bins. */
typedef struct spari_bin_cut {
    int64_t top;
    double most; /* size of the largest number without a part above */
    double scale, shift[SPARI_BINS], per_unit[SPARI_BINS];
} spari_bin_cut;
void spari_bins_cut(int64_t top, spari_bin_cut *cut);

/* Adds finite x. */
void spari_bins_add(spari_bins *sum, double x);
/* Adds a sum; `from` may be one of no numbers. */
void spari_bins_merge(spari_bins *into, const spari_bins *from);
/* A sum becomes twice what it was; its parts are even then. */
void spari_bins_double(spari_bins *sum);
/* Adds half of a sum with even parts, or takes it away (sign -1), without rounding. */
void spari_bins_merge_half(spari_bins *into, const spari_bins *from, int sign);
/* To the nearest double; infinite where the sum is too large for one. */
double spari_bins_value(const spari_bins *sum);

#endif
