/* Linear systems: of a member, element matrices on a chain of elements, dense for one element, banded for more; and any
   with a band. Nothing but create and watch takes memory. */
#ifndef SPARI_LINEAR_H
#define SPARI_LINEAR_H

#include "../base/thread_pool.h"

typedef struct spari_linear spari_linear;

/* elements of block x block matrices; neighbours share the last and first `overlap` unknowns. A long chain is cut in
   its middle: its halves are factored and solved apart, whoever does it, so that the bits are the same. NULL when there
   is no memory. */
spari_linear *spari_linear_create(int elements, int block, int overlap);
/* n unknowns of which i and j have an entry where |i - j| <= band at most; dense where that takes no more room. */
spari_linear *spari_linear_create_banded(int n, int band);
void spari_linear_free(spari_linear *system);
/* Who works on the halves of a long chain (base/crew.h), from now on; NULL: the calling thread. */
void spari_linear_share(spari_linear *system, spari_crew *const *crew);
void spari_linear_zero(spari_linear *system);
void spari_linear_add(spari_linear *system, int element, const double *S); /* S row-major [block][block] */
/* Of no chain: entry (0, 0); (i, j), within the band, is i + step j further on. Factored, (i, i) is the pivot. */
double *spari_linear_entries(const spari_linear *system, int64_t *step);
/* Row and column of unknown i, [unknowns] each. Before factoring. */
void spari_linear_read(const spari_linear *system, int i, double *row, double *column);
/* Takes unknown i out: its row and column become those of the identity. Before factoring. */
void spari_linear_fix(spari_linear *system, int i);
/* Returns 0, or 1 when the matrix is singular or not finite. */
int spari_linear_factor(spari_linear *system);
/* Sign of the determinant of the matrix factored last. */
int spari_linear_sign(const spari_linear *system);
/* Memory to tell whether the matrix is definite, until unwatch: 0, or 1 when there is none. */
int spari_linear_watch(spari_linear *system);
void spari_linear_unwatch(spari_linear *system);
/* Before factoring and while watched, leaves the matrix as it is. 1: symmetric and positive definite (within rounding),
 * 0: symmetric and not, -1: not symmetric. */
int spari_linear_definite(spari_linear *system);
/* x := A^-1 x; 0, or 1 when the result is not finite. */
int spari_linear_solve(spari_linear *system, double *x);
/* x[n] -= `count` columns of n, one after the other, times by[count]; y[count] += by times as many rows times x[n]. */
void spari_linear_less_columns(int n, int count, const double *columns, const double *by, double *x);
void spari_linear_add_rows(int n, int count, const double *rows, double by, const double *x, double *y);
/* The factors as doubles, for save and load. */
int64_t spari_linear_state_size(const spari_linear *system);
void spari_linear_save(const spari_linear *system, double *state);
/* Whether what was saved can be loaded: it names no rows that are not there. */
int spari_linear_is_state(const spari_linear *system, const double *state);
void spari_linear_load(spari_linear *system, const double *state);

#endif
