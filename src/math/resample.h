/* The same line with other elements or other nodes in them: values go over by the elements' own interpolation, loads by
   its transpose, so that their sum is kept. Elements are equally long in eta, which tells places. */
#ifndef SPARI_RESAMPLE_H
#define SPARI_RESAMPLE_H

#include <stdint.h>

/* What a line is divided into. Values stand [elements][per_element][width]. */
typedef struct spari_mesh {
    int elements, per_element;
} spari_mesh;

static inline int spari_mesh_alike(spari_mesh a, spari_mesh b) {
    return a.elements == b.elements && a.per_element == b.per_element;
}
/* P basis values at xi of an element with P nodes; 1 for one node. */
void spari_resample_basis(int per_element, double xi, double *phi);
/* The element of `to` in which place x in [-1, 1] of element e of `from` is, both numbers of elements; *xi: where. Ends
   are found to the bit, and between two elements the one on the same side. */
int spari_resample_place(int from, int e, double x, int to, double *xi);
/* The end of an element of `to` that the end of an element of `from` is, as a node of the line: side 0 is the first
   node of element e, 1 its last. -1: it lies within. */
int64_t spari_resample_end(int from, int e, int side, spari_mesh to);
/* Nodal values at the nodes of `to`; quaternions stand from column `turn` on (-1: there are none) and are brought into
   one hemisphere and back to unit length. */
void spari_resample_values(spari_mesh from, spari_mesh to, int width, int turn, const double *values, double *out);
/* Nodal loads of width 6 as those of the nodes of `to`. */
void spari_resample_loads(spari_mesh from, spari_mesh to, const double *loads, double *out);

#endif
