/* Square sparse matrices of small dense blocks, factored as L U with row exchanges inside diagonal blocks, in
   minimum-degree order (George and Liu, SIAM Review 31 (1989)). The pattern is symmetric; the values need not be.

   A block may be tied to a later one. Its unknowns are the displacement u and the rotation t of a rigid body. At the
   point p of the tie they have the components c of

      u + t x (p - point of u) = basis[0] (c_0, c_1, c_2),    t = basis[1] (c_3, c_4, c_5),

   of which some are held: c = gap - rows x, x being the first unknowns of the later block. The others are eliminated
   alone, and what the body weighs along the held ones passes to the later block (Featherstone, Rigid Body Dynamics
   Algorithms (2008), 7.2). The matrix has no rows for ties: vectors have the gaps behind the six forces of the block,
   and in a solution the forces of the tie along the held components, which balance those. */
#ifndef SPARI_BLOCK_MATRIX_H
#define SPARI_BLOCK_MATRIX_H

#include <stdint.h>

typedef struct spari_blocks spari_blocks;

typedef struct spari_block_pair {
    int a, b;
} spari_block_pair;

/* How many of its first displacements and rotations a tied block holds; neither: it is not tied. The block that they
   depend on; -1: none. */
typedef struct spari_block_tie {
    int held[2], to;
} spari_block_tie;

/* The values of a tie. */
typedef struct spari_tie {
    double arm[3];      /* from the point of the tie to that of the displacement */
    double basis[2][9]; /* row-major, columns of held components first; not used where none of the three is held */
    double rows[][6];   /* of the held components */
} spari_tie;

/* Creates a matrix. NULL: no memory.
   n, size: number of diagonal blocks, and rows of each (> 0)
   tie: of each block; a tied one has size 6, and is `before` the block it depends on. NULL: there are none
   coupled: pairs (a, b) of blocks that may have entries, also at (b, a); repetitions are allowed
   before: pairs (a, b): a is eliminated before b; there must be no cycle */
spari_blocks *spari_blocks_create(int n, const int *size, const spari_block_tie *tie, int64_t coupled_count,
                                  const spari_block_pair *coupled, int64_t before_count,
                                  const spari_block_pair *before);
void spari_blocks_free(spari_blocks *matrix);
/* Rows of a vector, and the first of block i. */
int spari_blocks_rows(const spari_blocks *matrix);
int spari_blocks_first(const spari_blocks *matrix, int i);
void spari_blocks_zero(spari_blocks *matrix);
/* Entry (0, 0) of block (i, j), which must be coupled. Entry (r, c) is r * stride + c further on. Call before
   factoring. */
double *spari_blocks_at(spari_blocks *matrix, int i, int j, int *stride);
/* The tie of block i, to be written before factoring. */
spari_tie *spari_blocks_tie(spari_blocks *matrix, int i);
/* Returns 0, or 1 if a pivot is 0 or not finite. */
int spari_blocks_factor(spari_blocks *matrix);
/* Smallest pivots of the last factorisation: of displacements, which are the first three of a block, and of rotations.
   Blocks of other sizes than 6 count as displacements. */
void spari_blocks_least_pivots(const spari_blocks *matrix, double least[2]);
/* Switches the counting of negative eigenvalues of a symmetric matrix on or off. They are those of the pivot blocks
   (Sylvester's law of inertia), which have 12 rows at most. */
void spari_blocks_watch(spari_blocks *matrix, int on);
int spari_blocks_negative(const spari_blocks *matrix);
/* x := A^-1 x, x [rows][columns]: one column, or two, which give the same bits as each alone. Returns 0, or 1 if a
   number is not finite. */
int spari_blocks_solve(spari_blocks *matrix, int columns, double *x);

#endif
