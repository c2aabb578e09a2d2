/* Nearest points on the reference line of a member: `elements` polynomials of degree per_element - 1, each on [-1,1].
 */
#ifndef SPARI_PROJECTION_H
#define SPARI_PROJECTION_H

#include "../base/thread_pool.h"

typedef struct spari_line spari_line;

/* x [elements * per_element][3] at the GLL points; per_element 1: a point, whose foot is the node. NULL: no memory. */
spari_line *spari_line_create(int elements, int per_element, const double *x);
void spari_line_free(spari_line *line);

/* Feet of points x [n][3]: element [n], local xi [n], foot [n][3], flags [n] (SPAR_MAP_END, SPAR_MAP_AMBIGUOUS). The
   foot is the place of smallest distance; of several, the one with the smallest coordinate along the line, flagged.
   crew: who looks for them (base/thread_pool.h). SPAR_OK, or SPAR_ERR_MEMORY without a message. */
int spari_line_project(const spari_line *line, spari_crew *crew, int method, int64_t n, const double *x, int *element,
                       double *xi, double *foot, uint8_t *flags);
/* Place (and derivative, NULL: not wanted) of the line. */
void spari_line_point(const spari_line *line, int element, double xi, double x[3], double dx[3]);

#endif
