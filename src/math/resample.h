/* The same elements with other nodes: values go over by the element's own interpolation, loads by its transpose, so
   that their sum is kept. */
#ifndef SPARI_RESAMPLE_H
#define SPARI_RESAMPLE_H

#include <stdint.h>

/* P basis values at xi of an element with P nodes; 1 for one node. */
void spari_resample_basis(int per_element, double xi, double *phi);
/* Nodal values [elements][P][width] at the n nodes of each element, to [elements][n][width]; quaternions stand from
   column `turn` on (-1: there are none) and are brought into one hemisphere and back to unit length. */
void spari_resample_values(int elements, int P, int n, int width, int turn, const double *from, double *to);
/* Nodal loads [elements][P][6] as those of n nodes, out [elements][n][6]. */
void spari_resample_loads(int elements, int P, int n, const double *loads, double *out);

#endif
