/* Small-motion equations about a state, M x'' + C x' + K x = 0 with G x = 0, as entries of unsymmetric sparse
   matrices; and their eigenvalues lambda, (lambda^2 M + lambda C + K) x = 0, nearest to a shift. */
#ifndef SPARI_PENCIL_H
#define SPARI_PENCIL_H

#include <complex.h>
#include <stdint.h>

#ifndef CMPLX /* the system's header defines it for GCC alone; both parts are finite here */
#define CMPLX(re, im) ((double complex)((re) + (im)*_Complex_I))
#endif

typedef struct spari_pencil_entry {
    int row, column;
    double k, c, m;
} spari_pencil_entry;

typedef struct spari_pencil_constraint { /* of G */
    int row, column;
    double g;
} spari_pencil_constraint;

typedef struct spari_pencil {
    int n, constraints; /* unknowns, rows of G */
    int base;           /* first unknown of the entries that are added now */
    int64_t entries, entry_capacity, constraint_entries, constraint_capacity;
    spari_pencil_entry *entry;
    spari_pencil_constraint *constraint;
    double *left;        /* [n] internal minus external forces of the state */
    double scale, noise; /* reference force, and its rounding error */
    double cap;          /* of beams: the stiffest strain, relative to the softest (member/capped.h); 0: as described */
    int full;            /* an entry did not fit in memory */
} spari_pencil;

/* Returns 0 or SPAR_ERR_MEMORY. */
int spari_pencil_create(spari_pencil *pencil, int unknowns);
void spari_pencil_free(spari_pencil *pencil);
/* Adds blocks [n][n] from unknown base + at on; rows are `apart` doubles apart. Rows and columns before base are
   constrained and skipped. NULL: zero. */
void spari_pencil_add(spari_pencil *pencil, int at, int n, int64_t apart, const double *K, const double *C,
                      const double *M);
/* Adds the symmetric parts of blocks K and M. */
void spari_pencil_add_symmetric(spari_pencil *pencil, int at, int n, const double *K, const double *M);
void spari_pencil_put(spari_pencil *pencil, spari_pencil_entry entry);
void spari_pencil_add_constraint(spari_pencil *pencil, spari_pencil_constraint entry);
/* left += r [n] from unknown base + at on. */
void spari_pencil_set_forces(spari_pencil *pencil, int at, int n, const double *r);
/* y [n] += (a K + b C + c M) x of the entries from `first` on. */
void spari_pencil_times(const spari_pencil *pencil, int64_t first, double a, double b, double c, const double *x,
                        double *y);

enum { SPARI_SPECTRUM_CHOICE, SPARI_SPECTRUM_DENSE, SPARI_SPECTRUM_SPARSE };
/* The n eigenvalues nearest to the shift, in order of distance. A conjugate pair counts once, with imaginary part >=
   0. Scales the pencil.
   x: [n][unknowns] eigenvectors
   how: SPARI_SPECTRUM_*
   found: number of eigenvalues that exist or have converged
   Returns 0, SPAR_ERR_MEMORY, or SPAR_ERR_NUMERIC: the equations cannot be solved. */
int spari_spectrum(spari_pencil *pencil, int n, double complex shift, int how, int *found, double complex *value,
                   double complex *x);

#endif
