/* Transfers nodal values between two meshes of the same line. Values are interpolated by the elements' basis; loads
   use the transpose, so that their sum is conserved. Elements are equally long in eta. */
#ifndef SPARI_RESAMPLE_H
#define SPARI_RESAMPLE_H

#include <stdint.h>

/* Elements and nodes per element of a line. Values are stored as [elements][per_element][width]. */
typedef struct spari_mesh {
    int elements, per_element;
} spari_mesh;

static inline int spari_mesh_is_equal(spari_mesh a, spari_mesh b) {
    return a.elements == b.elements && a.per_element == b.per_element;
}
/* Basis values at xi of an element with per_element nodes; 1 for one node. */
void spari_resample_basis(int per_element, double xi, double *phi);
/* Element of `to` that contains the point x in [-1, 1] of element e of `from` (both numbers of elements); *xi: its
   coordinate. Element ends are found exactly; at a boundary the element on the same side is returned. */
int spari_resample_place(int from, int e, double x, int to, double *xi);
/* Node of `to` that coincides with an end of element e of `from`: side 0 is its first node, 1 its last. -1: the end
   lies inside an element of `to`. */
int64_t spari_resample_end(int from, int e, int side, spari_mesh to);
/* Interpolates nodal values. Quaternions begin at column `turn` (-1: none); they are brought into one hemisphere and
   normalised. */
void spari_resample_values(spari_mesh from, spari_mesh to, int width, int rotation, const double *values, double *out);
/* Transfers nodal loads of width 6. */
void spari_resample_loads(spari_mesh from, spari_mesh to, const double *loads, double *out);

#endif
