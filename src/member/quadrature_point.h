/* Computations at quadrature points for forces, tangent and energy of a body: interpolated fields, strains, section
   forces, inertia. docs/explanation/theory.md, "The beam". */
#ifndef SPARI_QUADRATURE_POINT_H
#define SPARI_QUADRATURE_POINT_H

#include "../math/basis.h"
#include "../math/lanes.h"
#include "../math/rotation.h"
#include "body.h"

/* ---- small algebra ---- */

/* quaternion product of q and the pure quaternion s */
static inline void quat_vec(const double q[4], const double s[3], double c[4]) {
    double pure[4] = {0, s[0], s[1], s[2]};
    spari_quat_mul(q, pure, c);
}

/* ---- fields ---- */

/* Interpolated fields: u and its two rates, q and its two rates. */
enum { U = 0, Q = 3, UD = 7, QD = 10, UDD = 14, QDD = 17, ROW = 21 };
/* Rows of a block of point fields: values, then derivatives along the line of u, q and their rates. */
enum { DU = ROW, DQ = ROW + 3, DUD = ROW + 7, DQD = ROW + 10, POINT_ROWS = ROW + 14 };
/* Rows of a block of force terms: multiplied by phi (u, Q), then by phi' (u', Q'). */
enum { BACK = 7, BACK_ROWS = 2 * BACK };
/* Requested fields: Q; its rate; positions and velocities with both; accelerations; slopes of u and Q; of their
   rates. */
enum {
    SPARI_ROTATIONS = 0,
    SPARI_RATES = 1,
    SPARI_PLACES = 2,
    SPARI_ACCELERATIONS = 4,
    SPARI_SLOPES = 8,
    SPARI_RATE_SLOPES = 16
};

/* Mass variants of a section: none, weight alone, or inertia (and weight, if any). */
enum { SPARI_MASSLESS, SPARI_WEIGHED, SPARI_ACCELERATED };

typedef struct spari_regime {
    int moving;       /* rates are given */
    int damped;       /* damping acts */
    int beyond;       /* section forces exceed stiffness times strain: by damping or pretension */
    int heavy, shown; /* with weight; mass variant of the section */
    int wanted;       /* fields that the forces need */
    double weight[3]; /* gravity times its factor */
} spari_regime;

spari_regime spari_point_regime(const spari_body *body, const double *v, const double *a, double factor);

/* Nodal 4-vectors and their rates, z [ROW][SPARI_MAX_NODES]. Neighbours are brought into one hemisphere, so that an
   element may rotate by more than half a revolution between its ends. */
void spari_point_gather(const spari_body *body, int e, const double *q, const double *v, const double *a, double *z);

/* Sizes of forces and damping power, summed over points per lane. */
typedef struct spari_tally {
    double power[SPARI_LANES], most[SPARI_LANES];
} spari_tally;

/* Quaternion of a node. */
static inline void spari_point_rotation(const double *z, int node, double q[4]) {
    for (int i = 0; i < 4; i++) {
        q[i] = z[SPARI_MAX_NODES * (Q + i) + node];
    }
}

/* The same without changing hemispheres, for arrays that begin with the element's first node; v and a may be NULL.
   Returns whether a node may be in another hemisphere than its neighbour. */
int spari_lanes_gather(const spari_body *body, const double *q, const double *v, const double *a, double *z);
/* Adds the field forces of an element, g [BACK][SPARI_MAX_NODES], to the nodal forces r. */
void spari_lanes_add(const spari_body *body, const double *g, const double *z, double *r);

/* Fields at the points of element e, blocks f [blocks][POINT_ROWS][lanes], from its nodes' rows; others are
   unchanged. */
void spari_lanes_interpolate(const spari_body *body, int e, int wanted, const double *z, double *f);
/* Force terms of the points of element e, blocks back [blocks][BACK_ROWS][lanes]; f: room for one block of fields. */
void spari_lanes_forces(const spari_body *body, int e, const spari_regime *how, const double *z, double *f,
                        double *back, spari_tally *tally);
/* Sums the force terms to the nodes, g [BACK][SPARI_MAX_NODES]. */
void spari_lanes_collect(const spari_body *body, int e, const double *back, double *g);

/* ---- one point ---- */

#define SPARI_WIDTH 1
#include "../math/width.h"
#include "stiffness_damping_lanes.h"
/* uses the one above */
#include "inertia_gravity_lanes.h"
#define SPARI_WIDTH 0
#include "../math/width.h"

#endif
