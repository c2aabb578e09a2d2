/* Tangent of an element, assembled from points to nodes: data shared by the kernels of tangent_lanes.h. */
#ifndef SPARI_TANGENT_H
#define SPARI_TANGENT_H

#include "quadrature_point.h"

/* Rows of a point's matrices over (u, Q | u', Q'), each [slots].
   - derivatives of the (u, Q) forces with respect to Q
   - derivatives of the u', Q' forces with respect to Q, Q by Q
   - derivatives of the u', Q' forces with respect to u', Q': upper triangle, then the rest if not symmetric
   - derivatives of the Q forces with respect to u', Q', if not symmetric; otherwise the transpose of the second
   The mass has the first two and the mass itself. The same rows are summed over node pairs; those between Q and
     slopes twice, for the pairs (i, j) and (j, i). */
enum {
    BY_Q = 0,
    Q_BY_Q = 12,
    SLOPE_BY_Q = 28,
    SLOPE_BY_SLOPE = 56,
    HALF_ROWS = 84,
    Q_BY_SLOPE = 105,
    WHOLE_ROWS = 133
};
enum { MASS_ROW = 28, MASS_ROWS = 29, SLOPES = 28, HALF_SUMS = 112, WHOLE_SUMS = 189 };
/* Products of shape functions of two nodes, phi_i phi_j, phi_i phi'_j, phi'_i phi_j, phi'_i phi'_j */
enum { VALUE_VALUE, VALUE_SLOPE, SLOPE_VALUE, SLOPE_SLOPE, PRODUCTS };

/* Row of u', Q' by u', Q' that holds entry [i][j], for symmetric and for general matrices. */
extern const unsigned char spari_slope_row[2][7][7];

/* One matrix over (u, Q) for all node pairs i <= j, [row][stride]; NULL: no such part. */
typedef struct spari_pair_sums {
    double *by_q;                /* (u, Q) by Q */
    double *slopes;              /* u', Q' by u', Q' */
    double *from[2], *across[2]; /* slopes by Q, Q by slopes: of (i, j), of (j, i) */
    int whole;                   /* slopes: full matrix, not only the upper triangle */
} spari_pair_sums;

/* Matrices: K for displacements, B for their rates, M for accelerations; dq = E dtheta, d(qd) = F dtheta, d(qdd) = H
   dtheta. */
typedef struct spari_tangent_work {
    int P, points;
    int64_t slots, pairs, stride; /* length of a row of points; node pairs i <= j, and length of their rows */
    int elastic, damped, whole;   /* damped: B has elastic rows; whole: K is not symmetric either */
    int masses, rates;            /* M, B exist */
    double cm, cv;                /* factors of accelerations and rates */
    double *z, *g, *f, *back;     /* as for the residual */
    double *K, *B, *M;            /* of the points */
    double *products;             /* [points][PRODUCTS][stride] */
    spari_pair_sums of_K, of_B;   /* of the nodes */
    double *of_M;                 /* [MASS_ROWS][stride] */
    double *maps;                 /* [3][4][3][map_stride] E, F, H of the nodes */
    int64_t map_stride;
    double *ends[2]; /* [3][4][3][stride] the same for the first and the second node of each pair */
} spari_tangent_work;

/* The columns 1/2 e_j q, e_j the imaginary units. */
void spari_half_turns(const double *q, double h[4][3]);
/* S (3 x 3, rows of `stride`) += factor times the change with q of the nodal moment 1/2 Im(g q*), g constant. It is
   -1/4 (s I + w~), with (s, w) = g q*. */
void spari_turned_force(double factor, const double *g, const double *q, double *S, int64_t stride);

/* Matrices of all points of element e, and their force terms, as spari_lanes_forces. */
void spari_lanes_matrices(const spari_body *body, int e, const spari_regime *how, const spari_tangent_work *t);
/* Products of shape functions at all points. */
void spari_lanes_products(const spari_body *body, int e, const spari_tangent_work *t);
/* Sums `rows` rows of points times one of the products over the points: rows of pairs. */
void spari_lanes_sum(const spari_body *body, const spari_tangent_work *t, int rows, const double *points, int product,
                     double *pairs);
/* S [6P][6P] := the sums, mapped to nodal unknowns. */
void spari_lanes_project(const spari_body *body, const spari_tangent_work *t, double *S);

#endif
