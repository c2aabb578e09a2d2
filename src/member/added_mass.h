/* Known added mass: an estimate of the fluid's added mass, given by the host, which stabilises the coupling. The member
   has this mass in its equations of motion, and its loads are corrected by the same amount, so that the converged
   result is unchanged. See docs/explanation/theory.md, "Known added mass".

   With A the added mass, rotated with the member at t^n, a step solves
     forces(q, v, a) + A a = y,     y = loads + A a of the last iterate,
   y in place of the fluids' loads: load.used always, load.pushed from a check to the end of the step. The difference
   between the two is the shift A a(after). */
#ifndef SPARI_ADDED_MASS_H
#define SPARI_ADDED_MASS_H

#include "structure.h"

/* Points along the line of a beam, or the node of a body. */
typedef struct spari_strips {
    int64_t count;
    int per_element, in_element; /* nodes and points per element */
    double *eta, *weight;        /* [count] position, and length (a body: 1) */
    double *R;                   /* [count][9] section axes of the reference configuration */
    double *phi;                 /* [count][per_element] */
    double *arm;                 /* [count][3] lever arm from the root in the reference configuration */
} spari_strips;

struct spari_added {
    int stands;                        /* the mass is not zero */
    int whole;                         /* one body carries all nodes of a beam */
    int elements, per_element, points; /* of the mass: as the member, or one node and point if one body carries all */
    double *mass;        /* [elements][points][36] per point, including its weight, in global axes at the reference */
    double *phi;         /* [elements][points][P] */
    double *shift;       /* [nodes][6] A a of the motion `after` */
    double *past[2];     /* [nodes][6] accelerations at t^{n-1}, t^{n-2} */
    double *mean[3];     /* [nodes][6] changes of velocity over dt, in the last three steps */
    double *scheme;      /* [nodes][6] algorithmic acceleration at t^n */
    spari_strips strips; /* if the mass is learned; otherwise empty */
    double *last;        /* likewise (added_mass_fit.h), or NULL */
};

/* Creates m->added for a member with inertia that has an added mass or is to learn it; otherwise does nothing.
   whole: one body carries all nodes, from the root. Returns a status, with a message; after a failure the result
   must be freed. */
int spari_added_create(spar_member *m, int whole);
/* Replaces the mass by a table of n stations (0: none). Used at creation, and when the mass is learned. */
void spari_added_fill(spar_member *m, int64_t n, const double *eta, const double *mass);
/* Rotation at t^n of the section at a point of element e, as fluids see it: the sum of the nodes' quaternions. Small
   rotations are ignored; a linear member rotates with its root frame. */
void spari_added_rotation(const spar_member *m, int64_t e, const double *phi, double rotation[4]);
void spari_added_free(spari_added *added);

/* out [n][6] += factor A a, a [n][6]; each by the host's nodes or by unknowns (element boundaries once). Returns the
   largest entry of A a at a point, the scale of rounding errors. */
typedef enum spari_numbering { SPARI_NODES, SPARI_UNKNOWNS } spari_numbering;
double spari_added_times(const spar_member *m, spari_numbering from, spari_numbering to, const double *a, double factor,
                         double *out);
/* Tangent of element e, as spari_body_tangent: S [6P][6P] += cm A diag(I, Tinv), tinv [unique][9]. NULL: the member
   is at its reference. */
void spari_added_tangent(const spar_member *m, int e, double cm, const double *tinv, double *S);

/* Predicts y; w: the predictor's weights in a step dt. load.used += A (w[0] a^n + w[1] a^{n-1} + w[2] a^{n-2}), and
   the shift is that of t^n. For a fluid that takes accelerations from velocities see (T19) of
   docs/explanation/theory.md. */
void spari_added_predict(spar_member *m, const double w[3], double dt);
/* Resets the past after the motion was set: as if it had always had the present acceleration. */
void spari_added_restart(spar_member *m);
/* Updates the shift after a change of the motion `after`. */
void spari_added_see(spar_member *m);
/* load += factor times the shift */
void spari_added_correct(const spar_member *m, double factor, double *load);
/* [nodes][6] difference between load.used (and load.pushed, once checked) and the fluids' loads; NULL: none. */
const double *spari_added_shift(const spar_member *m);
/* Call before the motion `after` becomes that of t^n. */
void spari_added_accept(spar_member *m);
/* Copies past accelerations to a rebuilt member. */
void spari_added_carry(const spar_member *from, spar_member *m);

#endif
