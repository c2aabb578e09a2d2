/* The fluid's added mass as the host guesses it: a mass that a member has in its equations of motion and not in the
   world, since the loads it is solved with are corrected by as much. See docs/theory.md, "Known added mass". With A the
   guess, turned as the member is at t^n, a step solves

     forces(q, v, a) + A a = y,     y = loads + A a of the last iterate,

   y in place of the fluids' loads: load_used always, load_pushed from a check to the step's end. What is between the
   two is the shift A a(after). */
#ifndef SPARI_ADDED_H
#define SPARI_ADDED_H

#include "structure.h"

/* Points along the line of a beam; or the node of a body. */
typedef struct spari_strips {
    int64_t count;
    int per_element, in_element; /* nodes and points of an element */
    double *eta, *weight;        /* [count] place, and length (a body: 1) */
    double *R;                   /* [count][9] section axes in the reference */
    double *phi;                 /* [count][per_element] */
    double *arm;                 /* [count][3] from the root in the reference */
} spari_strips;

struct spari_added {
    int stands;                        /* there is a mass */
    int whole;                         /* one body carries all of a beam's nodes */
    int elements, per_element, points; /* of the mass: the member's, or one node and point where one body carries all */
    double *mass;        /* [elements][points][36] of a point, weight in it, global axes of the reference */
    double *phi;         /* [elements][points][P] */
    double *shift;       /* [nodes][6] A a of the motion after */
    double *past[2];     /* [nodes][6] accelerations at t^{n-1}, t^{n-2} */
    double *mean[3];     /* [nodes][6] changes of the velocity over dt, in the last three steps */
    double *scheme;      /* [nodes][6] the scheme's own acceleration at t^n */
    spari_strips strips; /* where the mass is learned, else empty */
    double *last;        /* likewise (learned.h), or NULL */
};

/* m->added of a member that moves by equations with inertia and has been given a guess, or is to learn it; else
   nothing. whole: one body carries all of its nodes, from the root. A status and a message; what there is then is to be
   freed. */
int spari_added_create(spar_member *m, int whole);
/* Puts a table of n stations in place of what the mass was, n = 0: none. Only while it is made, and where it is
 * learned.
 */
void spari_added_fill(spar_member *m, int64_t n, const double *eta, const double *mass);
/* How the section at a point of element e is turned at t^n, as fluids see it: the nodes' quaternions summed. Small
   rotations are left out; a member that is linear seen from its root turns with that. */
void spari_added_turn(const spar_member *m, int64_t e, const double *phi, double turn[4]);
void spari_added_free(spari_added *added);

/* out [n][6] += factor A a, a [n][6]; each over the nodes as they are numbered for hosts, or as the unknowns are,
   joints once. The largest number of A a at a point, which rounding in the sum is relative to. */
typedef enum spari_numbering { SPARI_NODES, SPARI_UNKNOWNS } spari_numbering;
double spari_added_times(const spar_member *m, spari_numbering from, spari_numbering to, const double *a, double factor,
                         double *out);
/* Tangent of element e, as spari_body_tangent's: S [6P][6P] += cm A diag(I, Tinv), tinv [unique][9]; NULL: of a
   member that stands as in the reference. */
void spari_added_tangent(const spar_member *m, int e, double cm, const double *tinv, double *S);

/* Predicted loads become y, w being the predictor's weights in a step of dt: load_used += A (w[0] a^n + w[1] a^{n-1} +
   w[2] a^{n-2}), and the shift that of t^n; of a fluid that takes accelerations from velocities (T19) of
   docs/theory.md. */
void spari_added_predict(spar_member *m, const double w[3], double dt);
/* The motion now has been set anew: as if it had always been accelerated so. */
void spari_added_restart(spar_member *m);
/* The motion after has changed: the shift follows. */
void spari_added_see(spar_member *m);
/* load += factor times the shift */
void spari_added_correct(const spar_member *m, double factor, double *load);
/* [nodes][6] what load_used, and load_pushed once it is checked, have beyond the fluids' loads; NULL: nothing. */
const double *spari_added_shift(const spar_member *m);
/* Before the motion after becomes that of t^n. */
void spari_added_accept(spar_member *m);
/* Accelerations of the past to a member made anew. */
void spari_added_carry(const spar_member *from, spar_member *m);

#endif
