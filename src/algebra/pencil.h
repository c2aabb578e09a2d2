/* The equations of small motions about a state, M x'' + C x' + K x = 0 with G x = 0, as entries of unsymmetric sparse
   matrices; and those of their eigenvalues lambda, (lambda^2 M + lambda C + K) x = 0, that are nearest to a shift. */
#ifndef SPARI_PENCIL_H
#define SPARI_PENCIL_H

#include <complex.h>
#include <stdint.h>

#ifndef CMPLX /* the system's header has it for GCC alone; here both parts are finite */
#define CMPLX(re, im) ((double complex)((re) + (im)*_Complex_I))
#endif

typedef struct spari_pencil_entry {
    int row, column;
    double k, c, m;
} spari_pencil_entry;

typedef struct spari_pencil_hold { /* of G */
    int row, column;
    double g;
} spari_pencil_hold;

typedef struct spari_pencil {
    int n, holds; /* unknowns, rows of G */
    int base;     /* where the unknowns of what is added now begin */
    int64_t entries, entry_room, ties, tie_room;
    spari_pencil_entry *entry;
    spari_pencil_hold *tie;
    double *left;        /* [n] forces less loads of the state; */
    double scale, noise; /* what they are compared with, and what rounding makes */
    int full;            /* there was no memory for an entry */
} spari_pencil;

/* 0, or SPAR_ERR_MEMORY. */
int spari_pencil_create(spari_pencil *pencil, int unknowns);
void spari_pencil_free(spari_pencil *pencil);
/* Adds blocks [n][n] of rows that are `apart` doubles from each other, from the unknown base + at on; what lies before
   the base is held and left out. NULL: nothing. */
void spari_pencil_add(spari_pencil *pencil, int at, int n, int64_t apart, const double *K, const double *C,
                      const double *M);
void spari_pencil_put(spari_pencil *pencil, spari_pencil_entry entry);
void spari_pencil_hold_at(spari_pencil *pencil, spari_pencil_hold hold);
/* left += r [n] from base + at on. */
void spari_pencil_leave(spari_pencil *pencil, int at, int n, const double *r);
/* The parts of y [n] += (a K + b C + c M) x of the entries from `first` on. */
void spari_pencil_times(const spari_pencil *pencil, int64_t first, double a, double b, double c, const double *x,
                        double *y);

enum { SPARI_SPECTRUM_CHOICE, SPARI_SPECTRUM_DENSE, SPARI_SPECTRUM_SPARSE };
/* The n eigenvalues nearest to the shift, of which conjugate pairs count once, with imaginary part >= 0, in order of
   their distance; x [n][unknowns] their vectors. Scales the pencil. *found: how many there are, or have converged,
   where those are fewer. how: SPARI_SPECTRUM_*. 0, SPAR_ERR_MEMORY, SPAR_ERR_NUMERIC: nothing to be solved. */
int spari_spectrum(spari_pencil *pencil, int n, double complex shift, int how, int *found, double complex *value,
                   double complex *x);

#endif
