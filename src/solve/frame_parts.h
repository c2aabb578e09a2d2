/* What the three files of the frame share: matrices, modes, time. */
#ifndef SPARI_FRAME_PARTS_H
#define SPARI_FRAME_PARTS_H

#include "frame.h"

/* Which two components of the turn are multiplied in each of the SPARI_TURNS products; and where two products stand
   among their SPARI_TURN_PAIRS. */
extern const int spari_frame_pair[SPARI_TURNS][2];
int spari_frame_pair_of(int k, int l);

/* y [n] += factor * X x for a matrix of the frame */
void spari_frame_add_times(const spari_frame *f, const double *X, const double *x, double factor, double *y);
/* Factors ck K + cv C + cm M with the held unknowns out; S: room for an element. C may be NULL. */
void spari_frame_factor(spari_frame *f, const double *K, double ck, const double *C, double cv, double cm, double *S,
                        int *singular);

/* Columns of the basis: the six rigid motions about the root, of which the first `held` stay zero, then the lowest
   modes; those that are free are orthonormal in the norm of the mass. arm [nodes][3] from the root. */
int spari_frame_fill_basis(spari_frame *f, const double *arm, int cols);
/* The matrices and vectors of the nodes become those of the basis. 1: no memory. */
int spari_frame_project(spari_frame *f, int cols);

#endif
