/* Arrays: checks of numbers, memory, copies and hashes, declared in status.h. Also compiled into libspar_aero. */
#include "status.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

int64_t spari_first_nonfinite(const double *x, int64_t n) {
    /* 0 * x is 0 for every finite x and NaN otherwise, so one vectorised sum decides. There are several sums because
       the compiler may not reorder additions. The search for the index is the rare case. */
    double sum[8] = {0.0};
    int64_t i = 0;
    for (; i + 8 <= n; i += 8) {
        for (int k = 0; k < 8; k++) {
            sum[k] += 0.0 * x[i + k];
        }
    }
    for (; i < n; i++) {
        sum[0] += 0.0 * x[i];
    }
    double all = ((sum[0] + sum[1]) + (sum[2] + sum[3])) + ((sum[4] + sum[5]) + (sum[6] + sum[7]));
    if (all == 0.0) {
        return -1;
    }
    for (i = 0; i < n; i++) {
        if (!(0.0 * x[i] == 0.0)) {
            return i;
        }
    }
    return -1;
}

int spari_is_count(double x) {
    return x >= 0 && x < 1e15 && x == floor(x);
}

void *spari_zalloc(int64_t n, size_t size) {
    if (n < 0 || (uint64_t)n > SIZE_MAX) {
        return NULL;
    }
    return calloc(n > 0 && size > 0 ? (size_t)n : 1, size > 0 ? size : 1);
}

void spari_free_all(size_t n, void *const *pointers) {
    for (size_t i = 0; i < n; i++) {
        free(pointers[i]);
    }
}

double *spari_copy(const double *x, int64_t n) {
    double *copy = spari_zalloc(n, sizeof *copy);
    if (copy && x && n > 0) {
        memcpy(copy, x, (size_t)n * sizeof *copy);
    }
    return copy;
}

void spari_give(double *array, const double *values, int64_t n) {
    if (array && n > 0) {
        memcpy(array, values, (size_t)n * sizeof *array);
    }
}

void spari_fill(int64_t capacity, double *array, int64_t known, const double *values) {
    for (int64_t i = 0; array && i < capacity; i++) {
        array[i] = i < known ? values[i] : 0;
    }
}

uint64_t spari_hash_bytes(uint64_t hash, const void *data, size_t size) {
    const unsigned char *byte = data;
    for (size_t i = 0; i < size; i++) {
        hash = (hash ^ byte[i]) * UINT64_C(1099511628211);
    }
    return hash;
}
