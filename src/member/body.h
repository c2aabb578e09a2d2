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

/* Points are worked on side by side. Each has a slot: an element's points take the slots from a multiple of SPARI_LANES
   on, and what is said of points lies in blocks of as many, row by row, [block][row][lane]. Slots that are left over
   in an element's last block repeat its last point with weight 0. */
enum { SPARI_LANES = 8 };
#define SPARI_BLOCK(x, rows, slot) ((x) + (slot) / SPARI_LANES * SPARI_LANES * (rows) + (slot) % SPARI_LANES)

typedef struct spari_body {
    int elements, per_element, unique;
    int *first;      /* [elements + 1] quadrature points of each element */
    int *slot;       /* [elements + 1] slot of each element's first point, and of the end */
    double *phi;     /* [points][P], not in blocks */
    double *dphi;    /* [points][P], per arc length */
    double *shape;   /* [blocks][P][2][lanes]: phi and dphi again, by spari_body_complete */
    double *place;   /* [points][3] reference place, not in blocks */
    double *weight;  /* [blocks][lanes], quadrature weight times Jacobian */
    double *tangent; /* [blocks][3][lanes] unit tangent of the reference line, global */
    double *C;       /* [blocks][36][lanes] stiffness in global axes at the reference; NULL: not elastic */
    double *D;       /* [blocks][36][lanes] damping likewise; NULL: none */
    double *pre;     /* [blocks][6][lanes] section forces of the reference, its axes, global; NULL: none */
    double pre_part; /* how much of `pre` is in force: 1, in load steps less */
    double *mass;    /* [blocks][10][lanes]: m, m c (global at the reference), J (xx, xy, xz, yy, yz, zz); NULL: none */
    int lanes;       /* points worked on at once at most; 0: what the processor has (tests try all) */
    double gravity[3];
    double drag; /* 1/s, damping by mass: of the motion seen from the first node as it turns; with D, be it zero */
    double *node_place; /* [unique][3] reference places, with drag; NULL: none, or drag is of velocities as they are */
    double *seen;       /* [unique][6] work space likewise */
    int gyroscopic;
    double length; /* size of the member, for the tolerances: arc length, or radius of gyration of a rigid body */
    double
        stiffest; /* size of a force that rounding in the places makes: largest stiffness, and moments over this size */
    double *lines;   /* the memory of what is in blocks but for `pre`, and of the work space of an element */
    int64_t room;    /* doubles of work space that an element takes */
    double *scratch; /* work space of one element, and of 6 doubles a node at least */
    double *matrix;  /* [6P][6P] work space: an element's tangent */
    double *tally;   /* [tiles][2] work space of sums over elements */
    struct spari_crew *const *crew; /* who works on its elements (base/crew.h); NULL: one thread */
} spari_body;

/* Room for the section forces of the reference, 0 yet. Returns 0, or 1 when there is no memory. */
int spari_body_set_pre(spari_body *body);
/* The same body with so much of its pretension in force. */
static inline spari_body spari_body_in_part(const spari_body *body, double factor) {
    spari_body part = *body;
    part.pre_part = factor;
    return part;
}
/* Gives a body with D damping by mass. place: reference places of its nodes, 3 doubles each, joints once, which it
   keeps; NULL: of velocities as they are, not as the first node sees them. Returns 0, or 1 when there is no memory:
   place is the caller's still. */
int spari_body_set_drag(spari_body *body, double drag, double *place);
/* Velocities as damping by mass sees them, out [unique][6]; q NULL: from the reference. */
void spari_body_see(const spari_body *body, const double *q, const double *v, double *out);
/* Doubles of work space that an element with so many points takes. */
int64_t spari_body_scratch(int per_element, int points, int damped);
/* Sizes the arrays for points[elements] quadrature points; elastic, damped, massive say which properties exist.
   Returns NULL when there is no memory. */
spari_body *spari_body_create(int elements, int per_element, const int *points, int elastic, int damped, int massive);
/* To be called when phi, dphi and the properties of all points are given. */
void spari_body_complete(spari_body *body);
void spari_body_free(spari_body *body);

/* Sums over elements go by tiles of so many, the odd ones after the even ones: a tile's end is the next one's
   beginning, where two shares add, which gives the same bits in either order. Tiles of long members may be worked on by
   several threads at once. */
enum { SPARI_BODY_TILE = 8 };
static inline int spari_body_tiles(const spari_body *body) {
    return (body->elements + SPARI_BODY_TILE - 1) / SPARI_BODY_TILE;
}
/* The elements [from, to) of a tile; the body has work space that is this thread's alone. */
typedef void (*spari_body_work)(const spari_body *body, int tile, int from, int to, void *context);
void spari_body_sweep(const spari_body *body, spari_body_work work, void *context);
/* Doubles of work space that a thread takes in it. */
int64_t spari_body_room(const spari_body *body);

/* Rows of one slot to and from contiguous numbers x[rows]. */
static inline void spari_slot_put(double *blocks, int rows, int64_t slot, const double *x) {
    for (int i = 0; i < rows; i++) {
        SPARI_BLOCK(blocks, rows, slot)[SPARI_LANES * i] = x[i];
    }
}
static inline void spari_slot_get(const double *blocks, int rows, int64_t slot, double *x) {
    for (int i = 0; i < rows; i++) {
        x[i] = SPARI_BLOCK(blocks, rows, slot)[SPARI_LANES * i];
    }
}

/* Forces of the state q [unique][7], v [unique][6], a [unique][6] (v, a NULL: at rest):
   r [unique][6] = inertia + internal - gravity * factor, global axes. *power (NULL: not wanted): the power that damping
   takes out. Returns an estimate of the largest single contribution (what rounding in r is relative to). */
double spari_body_residual(const spari_body *body, const double *q, const double *v, const double *a, double factor,
                           double *r, double *power);

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

#endif
