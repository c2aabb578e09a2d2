/* The transfer as it is written first: the spec's sums node by node over stored weights, [n][p]. Compiled twice, with
   the library's flags and for this machine. */
#ifndef BENCH_PLAIN_H
#define BENCH_PLAIN_H

#include <stdint.h>

typedef struct plain_map {
    int64_t n;
    int p;
    const double *weight;     /* [n][p] */
    const double *con;        /* [n][3] */
    const double *xr, *q, *v; /* of the p nodes: [p][3], [p][7], [p][6] */
} plain_map;

void plain_motion_portable(const plain_map *m, double *x, double *v);
void plain_motion_native(const plain_map *m, double *x, double *v);
void plain_loads_portable(const plain_map *m, const double *force, double *load);
void plain_loads_native(const plain_map *m, const double *force, double *load);

#endif
