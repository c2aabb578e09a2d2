/* Sums that do not depend on the order of their terms, by pre-rounded binned summation (Demmel and Nguyen, IEEE
   Trans. Comput. 64 (2015), and ReproBLAS).
   The exponent range is divided into fixed bins of 32 bits. Every number is split into its parts in the bins, each
     rounded to the last bit of its bin. A part depends on the number alone.
   A sum keeps integer multiples of the last bits of three adjacent bins. The highest of these is the highest bin in
     which any term has a part. Integers add without rounding, so any order of terms, and sums of sums, give the same
     three integers.
   Parts below the lowest bin are dropped: the error of n numbers of size at most a is n a / 2^64, plus one rounding
     of the result.
   Rounding must be to nearest, the default. Valid for up to 2^31 terms. */
#ifndef SPARI_BINS_H
#define SPARI_BINS_H

#include <stdint.h>

enum {
    SPARI_BINS = 3,        /* bins that a sum keeps */
    SPARI_BIN_WIDTH = 32,  /* bits */
    SPARI_BIN_LAST = -1088 /* exponent of the last bit of bin 0, below all denormal numbers */
};

/* All bytes zero: an empty sum. */
typedef struct spari_bins {
    int64_t top;              /* highest bin */
    int64_t part[SPARI_BINS]; /* from the highest bin downwards: sum of the parts, in units of the bin's last bit */
} spari_bins;

/* Highest bin in which a finite number of size `most` (>= 0) has a part. */
int64_t spari_bins_top(double most);

/* Constants for splitting numbers that have no part above bin `top`. The part of scale x in the highest bin is
   (scale x + shift[0]) - shift[0], in units of 1 / per_unit[0]. The remainder has its part in the next bin, and so
   on. scale is a power of 2 that keeps shift and per_unit in the range of normal doubles; numbers that become too
   small have no part in these bins. */
typedef struct spari_bin_cut {
    int64_t top;
    double most; /* size of the largest number without a part above `top` */
    double scale, shift[SPARI_BINS], per_unit[SPARI_BINS];
} spari_bin_cut;
void spari_bins_cut(int64_t top, spari_bin_cut *cut);

/* Adds finite x. */
void spari_bins_add(spari_bins *sum, double x);
/* Adds another sum, which may be empty. */
void spari_bins_merge(spari_bins *into, const spari_bins *from);
/* Doubles a sum; its parts are then even. */
void spari_bins_double(spari_bins *sum);
/* Adds (sign 1) or subtracts (sign -1) half of a sum with even parts, without rounding. */
void spari_bins_merge_half(spari_bins *into, const spari_bins *from, int sign);
/* The sum rounded to the nearest double, or infinity. */
double spari_bins_value(const spari_bins *sum);

#endif
