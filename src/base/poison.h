/* With the CMake option SPAR_POISON, fills workspace with NaN before each use, so that stale values show in the
   results. Otherwise does nothing. */
#ifndef SPARI_POISON_H
#define SPARI_POISON_H

#include <math.h>
#include <stdint.h>

static inline void spari_poison(double *x, int64_t n) {
#ifdef SPAR_POISON
    for (int64_t i = 0; x && i < n; i++) {
        x[i] = NAN;
    }
#else
    (void)x, (void)n;
#endif
}

#endif
