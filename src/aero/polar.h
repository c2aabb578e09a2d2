/* Polars: tables of lift, drag and moment over the angle of attack. A spar_polar is a handle on an immutable, counted
   table, so that a section keeps the table it was given whatever becomes of the handle. */
#ifndef SPARI_POLAR_H
#define SPARI_POLAR_H

#include <spar/spar_aero.h>

typedef struct spari_table spari_table;

/* The polar's table, one user more; given back with spari_table_release. */
spari_table *spari_polar_share(const spar_polar *polar);
void spari_table_release(spari_table *table);

/* Whether any moment coefficient differs from zero. */
int spari_table_has_moment(const spari_table *table);

/* The place in the table of the angle alpha: whole turns are taken off; an angle that no row covers goes to the nearer
   end and *beyond becomes 1, else 0. */
double spari_table_wrap(const spari_table *table, double alpha, int *beyond);

/* Coefficients at a place that spari_table_wrap gave; *row is where the search begins and where it ended, 0 at first.
 */
double spari_table_lift(const spari_table *table, double place, int64_t *row);
double spari_table_drag(const spari_table *table, double place, int64_t *row);
double spari_table_moment(const spari_table *table, double place, int64_t *row);

/* The line that lift lies on where the flow is attached: the angle without lift nearest to 0 that lift rises through,
   and the steepest way from there to a row within half a right angle. *slope is 0 where there is none. */
void spari_table_find_attached(const spari_table *table, double *zero, double *slope);

#endif
