/* The transfer as it is written first: the sums (T4) to (T9) node by node over stored weights, [n][p], and that of a
   rigid body. Compiled with the library's flags (portable) and with the vectors of this machine (native). */
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

typedef struct plain_rigid {
    int64_t n;
    const double *con; /* [n][3] arms in the reference */
    double x[3], v[3], R[9], omega[3];
} plain_rigid;

void plain_motion_portable(const plain_map *m, double *x, double *v);
void plain_motion_native(const plain_map *m, double *x, double *v);
void plain_loads_portable(const plain_map *m, const double *force, double *load);
void plain_loads_native(const plain_map *m, const double *force, double *load);
void plain_rigid_motion_portable(const plain_rigid *m, double *x, double *v);
void plain_rigid_motion_native(const plain_rigid *m, double *x, double *v);
void plain_rigid_loads_portable(const plain_rigid *m, const double *force, double load[6]);
void plain_rigid_loads_native(const plain_rigid *m, const double *force, double load[6]);

#endif
