/* Linear systems of members: element matrices assembled along a chain, dense for one element and banded for more.
   Only create and watch allocate memory. */
#ifndef SPARI_LINEAR_H
#define SPARI_LINEAR_H

#include "../base/thread_pool.h"

typedef struct spari_linear spari_linear;

/* Chain of elements with block x block matrices; neighbours share their last and first `overlap` unknowns. NULL:
   no memory. */
spari_linear *spari_linear_create(int elements, int block, int overlap);
void spari_linear_free(spari_linear *system);
/* Threads for the elements of a chain (base/thread_pool.h) from now on; NULL: the calling thread. */
void spari_linear_share(spari_linear *system, spari_thread_pool *const *pool);
/* Of six unknowns in turn the last three are rotations: rows are exchanged as if their equations, of moments, were
   multiplied by this number, an inverse length. Forces and moments have different units, and which row is the largest
   must not depend on them. 1, or never called: rows are compared as they are. Returns 0, or 1 if there is no memory. */
int spari_linear_weigh(spari_linear *system, double moments);
void spari_linear_zero(spari_linear *system);
void spari_linear_add(spari_linear *system, int element, const double *S); /* S row-major [block][block] */
/* Row and column of unknown i, [unknowns] each. Call before factoring. */
void spari_linear_read(const spari_linear *system, int i, double *row, double *column);
/* Constrains unknown i: its row and column become those of the identity. Call before factoring. */
void spari_linear_fix(spari_linear *system, int i);
/* Returns 0, or 1 if the matrix is singular or not finite. */
int spari_linear_factor(spari_linear *system);
/* Sign of the determinant of the last factored matrix. */
int spari_linear_sign(const spari_linear *system);
/* Allocates memory for spari_linear_definite, until unwatch. Returns 0, or 1 if there is no memory. */
int spari_linear_watch(spari_linear *system);
void spari_linear_unwatch(spari_linear *system);
/* Tests the matrix without changing it, before factoring and while watched. 1: symmetric positive definite (within
   rounding), 0: symmetric indefinite, -1: not symmetric. */
int spari_linear_definite(spari_linear *system);
/* x := A^-1 x. Returns 0, or 1 if the result is not finite. */
int spari_linear_solve(spari_linear *system, double *x);
/* x[n] -= `count` consecutive columns of length n times by[count]; and y[count] += by times as many rows times x[n]. */
void spari_linear_less_columns(int n, int count, const double *columns, const double *by, double *x);
void spari_linear_add_rows(int n, int count, const double *rows, double by, const double *x, double *y);
/* Factors as doubles, for save and load. */
int64_t spari_linear_state_size(const spari_linear *system);
void spari_linear_save(const spari_linear *system, double *state);
/* Whether a saved state is valid: its row exchanges name existing rows. */
int spari_linear_is_state(const spari_linear *system, const double *state);
void spari_linear_load(spari_linear *system, const double *state);

#endif
