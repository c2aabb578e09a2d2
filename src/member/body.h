/* The discretised member: spectral elements, their quadrature points, their section properties. A rigid body is one
   node with one point and no stiffness; a beam has its elements. This file knows forces and tangents, not time.

   Unknowns live on `unique` nodes: joints once, unique = elements (P - 1) + 1, element e begins at e (P - 1).
   Fields within an element are Lagrange sums of nodal u and of nodal unit quaternions q as plain 4-vectors, Q = sum
   phi_l q_l; the section turns by R(Q/|Q|). Strains, virtual work and inertia are all taken from that one field, so the
   discrete forces are the gradient of a discrete energy: energy and momenta are kept by the semi-discrete equations and
   the tangent is symmetric where it should be. Virtual rotations of a node act through delta q = 1/2 delta theta q. */
#ifndef SPARI_BODY_H
#define SPARI_BODY_H

#include <stdint.h>

typedef struct spari_body {
    int elements, per_element, unique;
    int *first;      /* [elements + 1] quadrature points of each element */
    double *phi;     /* [points][P] */
    double *dphi;    /* [points][P], per arc length */
    double *weight;  /* [points], quadrature weight times Jacobian */
    double *tangent; /* [points][3] unit tangent of the reference line, global */
    double *place;   /* [points][3] reference place */
    double *C;       /* [points][36] stiffness in global axes at the reference; NULL: not elastic */
    double *D;       /* [points][36] damping likewise; NULL: none */
    double *mass;    /* [points][10]: m, m c (global at the reference), J (xx, xy, xz, yy, yz, zz); NULL: none */
    double gravity[3];
    int gyroscopic;
    double length; /* size of the member, for the tolerances: arc length, or radius of gyration of a rigid body */
    double
        stiffest; /* size of a force that rounding in the places makes: largest stiffness, and moments over this size */
    double *linear[3]; /* linear members: element matrices [elements][6P][6P] of stiffness, damping, mass; NULL: none */
    double *weights;   /* linear members: forces [unique][6] of gravity at the reference; NULL: weightless */
    double *at_rest;   /* linear members: the reference as a state, [unique][7] */
    double *scratch;   /* work space of one element, and of 6 doubles a node at least */
} spari_body;

/* Doubles of a body's scratch. */
int64_t spari_body_scratch(int per_element, int points);
/* Sizes the arrays for `points` quadrature points over all elements; elastic, damped, massive say which properties
   exist. Returns NULL when there is no memory. */
spari_body *spari_body_create(int elements, int per_element, int points, int elastic, int damped, int massive);
void spari_body_free(spari_body *body);

/* Forces of the state q [unique][7], v [unique][6], a [unique][6] (v, a NULL: at rest):
   r [unique][6] = inertia + internal - gravity * factor, global axes. *power (NULL: not wanted): the power that damping
   takes out. Returns an estimate of the largest single contribution (what rounding in r is relative to). */
double spari_body_residual(const spari_body *body, const double *q, const double *v, const double *a, double factor,
                           double *r, double *power);

/* The same of a body that has been made linear too, as if it were not. */
double spari_body_exact_residual(const spari_body *body, const double *q, const double *v, const double *a,
                                 double factor, double *r, double *power);

/* Tangent of element e, row-major S [6P][6P]: dr = S (du, dtheta) with dv = cv X, da = cm X, X = (du, Tinv dtheta),
   Tinv [unique][9] or NULL for the identity; v, a NULL: at rest. */
void spari_body_tangent(const spari_body *body, int e, const double *q, const double *v, const double *a, double factor,
                        double cm, double cv, const double *tinv, double *S);

/* The parts of it that belong to velocities and accelerations, dr = C dv + M da, row-major [6P][6P]; S is the tangent
   with cm = cv = 0. C, M NULL: not wanted. */
void spari_body_rates(const spari_body *body, int e, const double *q, const double *v, const double *a, double factor,
                      const double *S, double *C, double *M);

/* kinetic, strain, gravity potential (zero at the reference), power dissipated; v NULL: at rest */
void spari_body_energy(const spari_body *body, const double *q, const double *v, double energy[4]);

/* Makes the body linear about its reference: element matrices are formed once. heavy: gravity may come. Returns 0, or 1
   when there is no memory. */
int spari_body_linearise(spari_body *body, int heavy);
/* A linear body keeps its weight as nodal loads: call this after gravity has changed. */
void spari_body_gravity_changed(spari_body *body);

#endif
