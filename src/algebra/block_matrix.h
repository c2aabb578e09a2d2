/* Square sparse matrices of small dense blocks, factored by blocks: L U with row exchanges inside diagonal blocks, in
   an order of least degree (George and Liu, SIAM Review 31 (1989)). Their pattern is symmetric, their values need not
   be.
 */
#ifndef SPARI_BLOCK_MATRIX_H
#define SPARI_BLOCK_MATRIX_H

#include <stdint.h>

typedef struct spari_blocks spari_blocks;

typedef struct spari_block_pair {
    int a, b;
} spari_block_pair;

/* n diagonal blocks of size[i] rows, none of them 0. coupled: blocks (a, b) and (b, a) may have entries. before: a is
   eliminated before b; these must have no cycle. Pairs may be repeated. NULL: no memory. */
spari_blocks *spari_blocks_create(int n, const int *size, int64_t coupled_count, const spari_block_pair *coupled,
                                  int64_t before_count, const spari_block_pair *before);
void spari_blocks_free(spari_blocks *matrix);
/* Rows of all blocks; where those of block i begin in a vector. */
int spari_blocks_rows(const spari_blocks *matrix);
int spari_blocks_first(const spari_blocks *matrix, int i);
void spari_blocks_zero(spari_blocks *matrix);
/* Entry (0, 0) of block (i, j), which must be coupled; entry (r, c) is r * stride + c further on. Before factoring. */
double *spari_blocks_at(spari_blocks *matrix, int i, int j, int *stride);
/* 0, or 1 where a pivot is 0 or not finite. */
int spari_blocks_factor(spari_blocks *matrix);
/* The smallest pivot of the last factoring. */
double spari_blocks_least_pivot(const spari_blocks *matrix);
/* From now on, or no more, factoring counts the negative eigenvalues of a symmetric matrix: those of its pivot blocks
   (Sylvester's law of inertia), which have 12 rows at most. */
void spari_blocks_watch(spari_blocks *matrix, int on);
int spari_blocks_negative(const spari_blocks *matrix);
/* x := A^-1 x. 0, or 1 where a number is not finite. */
int spari_blocks_solve(spari_blocks *matrix, double *x);

#endif
