/* Sparse complex linear systems: the unknowns are reordered to a narrow band (reverse Cuthill-McKee), which is
   factored with row exchanges. */
#ifndef SPARI_BAND_H
#define SPARI_BAND_H

#include <complex.h>
#include <stddef.h>
#include <stdint.h>

typedef struct spari_band spari_band;

/* Positions of the entries: (row[i], column[i]), `apart` bytes from each other in memory. NULL: no memory. */
spari_band *spari_band_create(int n, int64_t entries, const int *row, const int *column, size_t apart);
void spari_band_free(spari_band *band);
void spari_band_zero(spari_band *band);
void spari_band_add(spari_band *band, int row, int column, double complex x);
/* Returns 0, or 1 if the matrix is singular or not finite. */
int spari_band_factor(spari_band *band);
/* x [n] := A^-1 x */
void spari_band_solve(spari_band *band, double complex *x);

#endif
