/* Nearest points on the reference line of a member: `elements` polynomials of degree per_element - 1, each on
   [-1,1]. */
#ifndef SPARI_PROJECTION_H
#define SPARI_PROJECTION_H

#include "../base/thread_pool.h"

typedef struct spari_line spari_line;

/* x [elements * per_element][3] at the GLL points. With per_element 1 the line is a point, its only nearest point.
   NULL: no memory. */
spari_line *spari_line_create(int elements, int per_element, const double *x);
void spari_line_free(spari_line *line);

/* Projects points x [n][3] onto the line. The nearest point has the smallest distance; of several, the one with the
   smallest coordinate along the line is returned and flagged.
   thread pool: threads (base/thread_pool.h)
   element, xi, projection point: [n], [n], [n][3] element, local coordinate and position of the nearest points
   flags: [n] SPAR_MAP_END, SPAR_MAP_AMBIGUOUS
   Returns SPAR_OK, or SPAR_ERR_MEMORY without a message. */
int spari_line_project(const spari_line *line, spari_thread_pool *pool, int method, int64_t n, const double *x,
                       int *element, double *xi, double *nearest, uint8_t *flags);
/* Position and derivative (may be NULL) of the line. */
void spari_line_point(const spari_line *line, int element, double xi, double x[3], double dx[3]);

#endif
