/* Square sparse matrices of small dense blocks, factored as L U with row exchanges inside diagonal blocks, in
   minimum-degree order (George and Liu, SIAM Review 31 (1989)). The pattern is symmetric; the values need not be. */
#ifndef SPARI_BLOCK_MATRIX_H
#define SPARI_BLOCK_MATRIX_H

#include <stdint.h>

typedef struct spari_blocks spari_blocks;

typedef struct spari_block_pair {
    int a, b;
} spari_block_pair;

/* Creates a matrix. NULL: no memory.
   n, size: number of diagonal blocks, and rows of each (> 0)
   shared: how many first rows and columns of each block have entries in blocks that are eliminated earlier; NULL: all
   coupled: pairs (a, b) of blocks that may have entries, also at (b, a); repetitions are allowed
   before: pairs (a, b): a is eliminated before b; there must be no cycle */
spari_blocks *spari_blocks_create(int n, const int *size, const int *shared, int64_t coupled_count,
                                  const spari_block_pair *coupled, int64_t before_count,
                                  const spari_block_pair *before);
void spari_blocks_free(spari_blocks *matrix);
/* Rows of the matrix, and first row of block i. */
int spari_blocks_rows(const spari_blocks *matrix);
int spari_blocks_first(const spari_blocks *matrix, int i);
void spari_blocks_zero(spari_blocks *matrix);
/* Entry (0, 0) of block (i, j), which must be coupled. Entry (r, c) is r * stride + c further on. Call before
   factoring. */
double *spari_blocks_at(spari_blocks *matrix, int i, int j, int *stride);
/* Returns 0, or 1 if a pivot is 0 or not finite. */
int spari_blocks_factor(spari_blocks *matrix);
/* Smallest pivot of the last factorisation. */
double spari_blocks_least_pivot(const spari_blocks *matrix);
/* Switches the counting of negative eigenvalues of a symmetric matrix on or off. They are those of the pivot blocks
   (Sylvester's law of inertia), which have 12 rows at most. */
void spari_blocks_watch(spari_blocks *matrix, int on);
int spari_blocks_negative(const spari_blocks *matrix);
/* x := A^-1 x, x [rows][columns]: one column, or two, which give the same bits as each alone. Returns 0, or 1 if a
   number is not finite. */
int spari_blocks_solve(spari_blocks *matrix, int columns, double *x);

#endif
