/* The tangent of an element on its way from points to nodes: what its kernels (tangent_lanes.h) share. */
#ifndef SPARI_TANGENT_H
#define SPARI_TANGENT_H

#include "point.h"

/* Rows of a point's matrices over (u, Q | u', Q'), each [slots]: what (u, Q) answers to Q; what u', Q' answer to Q, Q
   by Q; what u', Q' answer to u', Q', the upper triangle, then the rest of one that is not symmetric, and what Q
   answers to u', Q' in that case, else the transpose of the former. Of the mass there are the first two and the mass
   itself. Over pairs of nodes the same rows are summed, and those between Q and slopes twice: for the pair (i, j) and
   (j, i). */
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

/* The row of u', Q' by u', Q' that holds entry [i][j], of a symmetric matrix and of another. */
extern const unsigned char spari_slope_row[2][7][7];

/* One matrix over (u, Q) of all pairs of nodes i <= j, [row][stride]; NULL: it has no such part. */
typedef struct spari_pair_sums {
    double *by_q;                /* (u, Q) by Q */
    double *slopes;              /* u', Q' by u', Q' */
    double *from[2], *across[2]; /* slopes by Q, Q by slopes: of (i, j), of (j, i) */
    int whole;                   /* slopes: not the upper triangle alone */
} spari_pair_sums;

/* K multiplies displacements, B their rates, M accelerations; dq = E dtheta, d(qd) = F dtheta, d(qdd) = H dtheta. */
typedef struct spari_tangent_work {
    int P, points;
    int64_t slots, pairs, stride; /* of a row of points; pairs of nodes i <= j, and of a row of theirs */
    int elastic, damped, whole;   /* damped: B has elastic rows; whole: and K is not symmetric */
    int masses, rates;            /* there are M, B */
    double cm, cv;                /* factors of accelerations and rates */
    double *z, *g, *f, *back;     /* as of the residual */
    double *K, *B, *M;            /* of the points */
    double *products;             /* [points][PRODUCTS][stride] */
    spari_pair_sums of_K, of_B;   /* of the nodes */
    double *of_M;                 /* [MASS_ROWS][stride] */
    double *maps;                 /* [3][4][3][map_stride] E, F, H of the nodes */
    int64_t map_stride;
    double *ends[2]; /* [3][4][3][stride] the same of the first and of the second node of each pair */
} spari_tangent_work;

/* The matrices of all points of element e, and what they give back, as spari_lanes_forces. */
void spari_lanes_matrices(const spari_body *body, int e, const spari_regime *how, const spari_tangent_work *t);
/* The products of shape functions at all points. */
void spari_lanes_products(const spari_body *body, int e, const spari_tangent_work *t);
/* `rows` rows of points, summed over the points times one of the products: rows of pairs. */
void spari_lanes_sum(const spari_body *body, const spari_tangent_work *t, int rows, const double *points, int product,
                     double *pairs);
/* S [6P][6P] := the sums, by the maps of the nodes. */
void spari_lanes_project(const spari_body *body, const spari_tangent_work *t, double *S);

#endif
