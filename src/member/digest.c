/* Hash and digest of a part of a description: see digest.h. */
#include "digest.h"

#include "../base/status.h"

#include <math.h>
#include <string.h>

enum { MATRIX = 36 };

/* Rounding of what a host computes is far below these, and a description that is meant to differ is far above. Damping
   comes from eigenvalues, whose error is amplified by the ratio of the stiffest to the softest mode. */
static const double position_tolerance = 1e-9, matrix_tolerance = 1e-8, row_tolerance = 1e-6;

void spari_described_exact(spari_described *part, int64_t value) {
    part->exact[part->exact_count++] = value;
}

void spari_described_add(spari_described *part, spari_number_kind kind, int64_t rows, int width, const double *x) {
    part->numbers[part->count++] = (spari_described_numbers){x, rows, width, kind};
}

uint64_t spari_described_hash(uint64_t hash, const spari_described *part) {
    hash = spari_hash_bytes(hash, part->exact, (size_t)part->exact_count * sizeof *part->exact);
    for (int k = 0; k < part->count; k++) {
        const spari_described_numbers *n = part->numbers + k;
        hash = n->x ? spari_hash_bytes(hash, n->x, (size_t)(n->rows * n->width) * sizeof *n->x) : hash;
    }
    return hash;
}

/* ---- scaled rows ---- */

/* Entries by the diagonal, the diagonal by its logarithm. A diagonal entry that is only rounding beside the others of
   its kind (translations, rotations) counts as they do. */
static void scale_matrix(const double *x, double y[MATRIX]) {
    double d[6];
    for (int i = 0; i < 6; i++) {
        const double *of = x + 21 * (i / 3); /* first diagonal entry of its kind */
        d[i] = fabs(x[7 * i]) + 1e-14 * fmax(fabs(of[0]), fmax(fabs(of[7]), fabs(of[14])));
    }
    for (int i = 0; i < MATRIX; i++) {
        const int r = i / 6, c = i % 6;
        const double by = sqrt(d[r]) * sqrt(d[c]);
        y[i] = !(by > 0) ? 0 : r == c ? log(d[r]) : x[i] / by;
    }
}

/* The direction of the row, and the logarithm of its norm. */
static void scale_row(int width, const double *x, double *y) {
    double norm = 0;
    for (int i = 0; i < width; i++) {
        norm = hypot(norm, x[i]);
    }
    for (int i = 0; i < width; i++) {
        y[i] = norm > 0 ? x[i] / norm : 0;
    }
    y[width] = norm > 0 ? log(norm) : 0;
}

static void scale(const spari_described *part, const spari_described_numbers *n, const double *x, double *y) {
    const double by = n->kind == SPARI_NUMBERS_LENGTH ? part->length
                      : n->kind == SPARI_NUMBERS_POSITION
                          ? part->length + 1e-3 * fmax(fabs(x[0]), fmax(fabs(x[1]), fabs(x[2])))
                          : 1;
    if (n->kind == SPARI_NUMBERS_MATRIX) {
        scale_matrix(x, y);
    } else if (n->kind == SPARI_NUMBERS_ROW) {
        scale_row(n->width, x, y);
    } else {
        for (int i = 0; i < n->width; i++) {
            y[i] = x[i] / by;
        }
    }
}

/* Between 1 and 2, another one for each row: rows that are exchanged change the sum. */
static double row_weight(int64_t row) {
    const double golden = 0.61803398874989485, at = golden * (double)row;
    return 1 + at - floor(at);
}

static void add_numbers(const spari_described *part, const spari_described_numbers *n, spari_digest *digest) {
    const int width = n->width + (n->kind == SPARI_NUMBERS_ROW);
    const double tolerance = n->kind == SPARI_NUMBERS_MATRIX ? matrix_tolerance
                             : n->kind == SPARI_NUMBERS_ROW  ? row_tolerance
                                                             : position_tolerance;
    double *sum = digest->sum + digest->count;
    for (int i = 0; i < width; i++) {
        sum[i] = 0;
        digest->tolerance[digest->count + i] = tolerance * sqrt((double)n->rows); /* of errors that are independent */
    }
    for (int64_t row = 0; row < n->rows && n->x; row++) {
        double y[MATRIX];
        scale(part, n, n->x + row * n->width, y);
        for (int i = 0; i < width; i++) {
            sum[i] += row_weight(row) * y[i];
        }
    }
    digest->count += width;
}

void spari_described_digest(const spari_described *part, spari_digest *digest) {
    digest->exact = spari_hash_bytes(SPARI_HASH_BEGIN, part->exact, (size_t)part->exact_count * sizeof *part->exact);
    digest->count = 0;
    for (int k = 0; k < part->count; k++) {
        if (part->numbers[k].rows > 0) {
            add_numbers(part, part->numbers + k, digest);
        }
    }
}
