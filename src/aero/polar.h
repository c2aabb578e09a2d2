/* Polars: tables of lift, drag and moment over the angle of attack. A spar_polar is a handle on an immutable,
   reference-counted table, so a section keeps its table after the handle is destroyed. */
#ifndef SPARI_POLAR_H
#define SPARI_POLAR_H

#include <spar/spar_aero.h>

typedef struct spari_table spari_table;

/* Table of the polar with one reference more; release it with spari_table_release. */
spari_table *spari_polar_share(const spar_polar *polar);
void spari_table_release(spari_table *table);

/* Rows, and the first `capacity` of each array that is not NULL, 0 beyond the last. */
int64_t spari_table_rows(const spari_table *table, int64_t capacity, double *alpha, double *const value[3], int *kind);
/* Whether any moment coefficient differs from zero. */
int spari_table_has_moment(const spari_table *table);

/* Reduces alpha to the range of the table by full circles. An angle outside the rows is moved to the nearer end, and
 *beyond is 1, otherwise 0. */
double spari_table_wrap(const spari_table *table, double alpha, int *beyond);

/* Coefficients at a place that spari_table_wrap gave; *row is where the search begins and where it ended, 0 at first.
 */
double spari_table_lift(const spari_table *table, double place, int64_t *row);
/* slope: out, the derivative of the lift coefficient */
double spari_table_lift_slope(const spari_table *table, double place, int64_t *row, double *slope);
double spari_table_drag(const spari_table *table, double place, int64_t *row);
double spari_table_moment(const spari_table *table, double place, int64_t *row);

/* Line of attached flow: *zero is the zero-lift angle nearest to 0 with rising lift; *slope is the steepest slope
   from there to a row within 45 degrees, or 0 if there is none. */
void spari_table_find_attached(const spari_table *table, double *zero, double *slope);

#endif
