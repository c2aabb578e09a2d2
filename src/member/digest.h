/* What a description consists of, part by part: compared bit by bit between the ranks of a session (a hash), and to
   rounding with a saved file (a digest). A host computes many of these numbers, and another processor rounds them
   differently. */
#ifndef SPARI_MEMBER_DIGEST_H
#define SPARI_MEMBER_DIGEST_H

#include <stdint.h>

/* How numbers are scaled before they are compared, and with which tolerance:
     PLAIN     as they are: coordinates along the line, quaternions, angles
     LENGTH    by the size of the member: shape of a line
     POSITION  by that size and the distance from the origin, as nodes of fluids in a saved file
     MATRIX    6x6 with positive diagonal: entry ij by the diagonal entries ii and jj
     ROW       each row by its norm: springs, damping, forces */
typedef enum spari_number_kind {
    SPARI_NUMBERS_PLAIN,
    SPARI_NUMBERS_LENGTH,
    SPARI_NUMBERS_POSITION,
    SPARI_NUMBERS_MATRIX,
    SPARI_NUMBERS_ROW
} spari_number_kind;

/* x [rows][width]; NULL: zeros. */
typedef struct spari_described_numbers {
    const double *x;
    int64_t rows;
    int width;
    spari_number_kind kind;
} spari_described_numbers;

/* A part of a description: what is the same or not, and numbers, whose rows are among the former. */
enum { SPARI_DESCRIBED_EXACT = 10, SPARI_DESCRIBED_ARRAYS = 6 };
typedef struct spari_described {
    int64_t exact[SPARI_DESCRIBED_EXACT];
    int exact_count;
    spari_described_numbers numbers[SPARI_DESCRIBED_ARRAYS];
    int count;
    double length; /* of the member */
} spari_described;

void spari_described_exact(spari_described *part, int64_t value);
void spari_described_add(spari_described *part, spari_number_kind kind, int64_t rows, int width, const double *x);
/* Adds the part to a hash, bit by bit. Zeros in place of NULL change it. */
uint64_t spari_described_hash(uint64_t hash, const spari_described *part);

/* sum[count]: weighted sums over the rows of each column, scaled; tolerance[count]: up to which they are the same.
   Parts with equal `exact` have equally many sums. */
enum { SPARI_DIGEST_MOST = 96 };
typedef struct spari_digest {
    uint64_t exact; /* hash */
    int count;
    double sum[SPARI_DIGEST_MOST], tolerance[SPARI_DIGEST_MOST];
} spari_digest;
void spari_described_digest(const spari_described *part, spari_digest *digest);

#endif
