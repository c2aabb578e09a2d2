/* The discretised member: spectral elements, quadrature points, section properties. A rigid body is one node with
   one point and no stiffness. This file computes forces and tangents; time integration is in time/. Formulation:
   geometrically exact (Simo-Reissner) beam, docs/explanation/theory.md, "The beam".
   Unknowns are at `unique` nodes, where element boundaries count once: unique = elements (P - 1) + 1, element e
     begins at e (P - 1). Fields within an element are Lagrange sums of nodal u and of nodal unit quaternions q as
     4-vectors, Q = sum phi_l q_l. The section rotates by R(Q/|Q|). Strains, virtual work and inertia all use this
     one field, so the discrete forces are the gradient of a discrete energy. The semi-discrete equations therefore
     conserve energy and momenta, and the tangent is symmetric where it should be. Virtual rotations of a node act
     through delta q = 1/2 delta theta q. */
#ifndef SPARI_BODY_H
#define SPARI_BODY_H

#include "../base/thread_pool.h"
#include "../base/workspace.h"

#include <stddef.h>

/* Points are processed in parallel lanes. Each point has a slot. The points of an element begin at a slot that is a
   multiple of SPARI_LANES. Their data are stored in blocks of SPARI_LANES slots, row by row, [block][row][lane].
   Unused slots in an element's last block repeat its last point with weight 0. */
enum { SPARI_LANES = 8 };
#define SPARI_BLOCK(x, rows, slot) ((x) + (slot) / SPARI_LANES * SPARI_LANES * (rows) + (slot) % SPARI_LANES)

typedef struct spari_body {
    int elements, per_element, unique;
    int *first;       /* [elements + 1] quadrature points of each element */
    int *slot;        /* [elements + 1] slot of each element's first point, and the end */
    double *phi;      /* [points][P], not in blocks */
    double *dphi;     /* [points][P], derivative with respect to arc length */
    double *shape;    /* [blocks][P][2][lanes]: copy of phi and dphi, by spari_body_complete */
    double *position; /* [points][3] reference position, not in blocks */
    double *weight;   /* [blocks][lanes], quadrature weight times Jacobian */
    double *tangent;  /* [blocks][3][lanes] unit tangent of the reference line, global */
    double *C;        /* [blocks][36][lanes] stiffness in global axes at the reference; NULL: not elastic */
    double *D;        /* [blocks][36][lanes] damping likewise; NULL: none */
    double *pre;      /* [blocks][6][lanes] section forces of the reference, global axes; NULL: none */
    double pre_part;  /* fraction of `pre` in force: 1, or less in load steps */
    double *mass; /* [blocks][10][lanes]: m, m c (global at the reference), J (xx, xy, xz, yy, yz, zz); NULL: none */
    int lanes;    /* maximum number of points at once; 0: as the processor has (tests try all) */
    double gravity[3];
    double mass_damping;   /* 1/s, mass-proportional damping of the motion relative to the first node's rigid motion;
                      needs D,   possibly zero */
    double *node_position; /* [unique][3] reference positions, for mass_damping; NULL: none, or it acts on absolute
                              velocities */
    double *seen;          /* [unique][6] workspace, likewise */
    int gyroscopic;
    double length;   /* size of the member for tolerances: arc length, or radius of gyration of a rigid body */
    double stiffest; /* force due to rounding of positions: largest stiffness, of moments over this size squared */
    double *lines;   /* memory of the blocks, without `pre` */
    /* [blocks][6][lanes] strains that the section forces of the tangent follow; NULL: those of its state */
    const double *mixed_strain;
    double *tally;     /* [tiles][2] workspace of sums over elements */
    int64_t workspace; /* doubles of an element, at least 6 for each node of the body; its tangent stands behind */
    spari_workspace *shared;               /* workspace of the calling thread, */
    struct spari_thread_pool *const *pool; /* and threads for its elements (base/thread_pool.h); NULL: one thread */
} spari_body;

/* Allocates zero section forces of the reference. Returns 0, or 1 if there is no memory. */
int spari_body_set_pre(spari_body *body);
/* The same body with this fraction of its pretension. */
static inline spari_body spari_body_in_part(const spari_body *body, double factor) {
    spari_body part = *body;
    part.pre_part = factor;
    return part;
}
/* Adds mass-proportional damping to a body with D. place: reference positions of its unique nodes, 3 doubles each,
   which the body owns afterwards; NULL: damping of absolute velocities. Returns 0, or 1 if there is no memory; then
   the caller still owns place. */
int spari_body_set_mass_damping(spari_body *body, double mass_damping, double *position);
/* Velocities on which mass-proportional damping acts, out [unique][6]; q NULL: at the reference. */
void spari_body_see(const spari_body *body, const double *q, const double *v, double *out);
/* Workspace in doubles of an element with this many points, without its tangent. */
int64_t spari_body_scratch_size(int per_element, int points, int damped);
/* Allocates a body with points[elements] quadrature points; elastic, damped, massive: which properties exist. shared:
   workspace of the calling thread, for all bodies of a session. pool: its threads, with workspace of their own; NULL:
   none. Returns NULL if there is no memory. */
spari_body *spari_body_create(int elements, int per_element, const int *points, int elastic, int damped, int massive,
                              spari_workspace *shared, struct spari_thread_pool *const *pool);
/* Size of the workspace of a thread, in doubles. */
static inline int64_t spari_body_workspace_size(const spari_body *body) {
    return body->workspace + 36 * (int64_t)body->per_element * body->per_element;
}
/* Workspace of the calling thread for one element; and there [6P][6P], for the element's tangent. */
static inline double *spari_body_scratch(const spari_body *body) {
    const struct spari_thread_pool *pool = body->pool ? *body->pool : NULL;
    int worker = spari_thread_pool_worker(pool);
    int64_t size = spari_body_workspace_size(body);
    return worker > 0 ? spari_thread_pool_workspace(pool, worker, size) : spari_workspace_at(body->shared, size);
}
static inline double *spari_body_matrix(const spari_body *body) {
    return spari_body_scratch(body) + body->workspace;
}
/* Call this when phi, dphi and the properties of all points are set. */
void spari_body_complete(spari_body *body);
/* kg */
double spari_body_mass(const spari_body *body);
void spari_body_free(spari_body *body);

/* Sums over elements are processed in tiles of this many elements, odd tiles after even ones. Neighbouring tiles
   share a node, where two contributions add, with the same bits in either order. Several threads may work on the
   tiles of long members. */
enum { SPARI_BODY_TILE = 8 };
static inline int spari_body_tiles(const spari_body *body) {
    return (body->elements + SPARI_BODY_TILE - 1) / SPARI_BODY_TILE;
}
/* Processes the elements [from, to) of a tile. */
typedef void (*spari_body_work)(const spari_body *body, int tile, int from, int to, void *context);
void spari_body_sweep(const spari_body *body, spari_body_work work, void *context);

/* Copies the rows of one slot to and from contiguous numbers x[rows]. */
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

/* Forces of the state q [unique][7], v [unique][6], a [unique][6] (v, a NULL: at rest), global axes.
   factor: of gravity
   r: [unique][6] = inertia + internal forces - gravity * factor
   power: power dissipated by damping; may be NULL
   Returns an estimate of the largest single contribution, the scale of rounding errors in r. */
double spari_body_residual(const spari_body *body, const double *q, const double *v, const double *a, double factor,
                           double *r, double *power);

/* Tangent of element e, row-major S [6P][6P]: dr = S (du, dtheta) with dv = cv X, da = cm X, X = (du, Tinv dtheta).
   tinv [unique][9]; NULL: identity. v, a NULL: at rest. */
void spari_body_tangent(const spari_body *body, int e, const double *q, const double *v, const double *a, double factor,
                        double cm, double cv, const double *tinv, double *S);

/* Mixed integration points (Magisano, Leonetti and Garcea, CMAME 313 (2017)): Newton's method converges independently
   of the stiffness if the section forces at the points are unknowns of their own, which follow from the linearised
   strains. Eliminated, they change the tangent alone: its geometric part has the forces of the strains at the last
   iterate q, linear in the correction -part dq [unique][6] that led from there to the present one. Puts these strains
   in the layout of `mixed_strain`. */
void spari_body_mixed_strains(const spari_body *body, const double *q, const double *dq, double part, double *strain);

/* Velocity and acceleration parts of the tangent, dr = C dv + M da, row-major [6P][6P]; S is the tangent with cm =
   cv = 0. C, M may be NULL. */
void spari_body_rates(const spari_body *body, int e, const double *q, const double *v, const double *a, double factor,
                      const double *S, double *C, double *M);

/* energy: kinetic, strain, gravity potential (zero at the reference), dissipated power; v NULL: at rest */
void spari_body_energy(const spari_body *body, const double *q, const double *v, double energy[4]);
/* Position and velocity of the centre of mass. Returns the mass; 0: there is no centre. */
double spari_body_center(const spari_body *body, const double *q, const double *v, double center[6]);

#endif
