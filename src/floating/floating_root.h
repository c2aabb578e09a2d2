/* The floating frame of reference of a member with joints. Its root is integrated as a body of one node without
   mass. The forces have the motion of the root as an unknown.

   With y the deformation and its rates in the axes of the frame, a, alpha and omega the root's there, g gravity, s
   the loads, R the six rigid motions of the member about its root,

      r   = M y'' + (D + G(omega)) y' + (K + N(omega, omega) + E(alpha)) y + f(omega, omega) + M R (a - g, alpha)
            + S(w, w) y - s
      r_0 = R^T (r without K, D, S) + sum over the nodes of (0, y_i x (M R (a - g, alpha) + f - s)_i) + (0, m_2)

   r are the forces on the unknowns, r_0 is the force and moment of the whole about the root. The lever arms in r_0
   are those of the deformed member, m_2 is of second order in the deformation, and internal forces do not enter. On
   the unknowns and in m_2 a moment m of the rigid motion counts as m + m x theta / 2, because theta are rotation
   vectors. S is the geometric stiffness of the axial forces that balance the centrifugal ones. w is the mean
   rotation rate of the member, that of the rigid motion with the same momenta. docs/theory.md, (J1) to (J5), derives
   this. */
#ifndef SPARI_FLOATING_ROOT_H
#define SPARI_FLOATING_ROOT_H

#include "../time/body_solver.h"
#include "frame.h"

/* Products of the deformation and its rates: y . N y and y' . N y of each product of rotation rates, y' . E y',
   y' . E y, y'' . E y. */
typedef struct spari_seconds {
    double yNy[SPARI_SPIN_PRODUCTS], vNy[SPARI_SPIN_PRODUCTS], vEv[3], vEy[3], aEy[3];
} spari_seconds;

typedef struct spari_floating_root {
    int *order;         /* [1 + ends] 0, 1, ...: numbers that constraints use */
    int ends, *node;    /* interface nodes beside the root, numbers of the unknowns' nodes */
    spari_body *body;   /* the root, one node without mass */
    spari_solver *root; /* of its state only the step lengths if the root is prescribed */
    /* if joints move the root: */
    double *push[6];                   /* [6 nodes] M R, of the nodes; NULL: no mass */
    double *spin[SPARI_SPIN_PRODUCTS]; /* [6 nodes] f likewise; NULL: none */
    double *mean;                      /* [3][n] (R^T M R)^-1 R^T M, its rotations */
    /* always: */
    double *block;              /* memory of `seen` and `force` */
    spari_state seen;           /* [1 + ends] motion of root and interface nodes, for constraints */
    double *force;              /* [1 + ends][6] residual forces on them, global axes */
    double *kept;               /* [2 n] saved rates or positions */
    spari_condensed *condensed; /* of root and interface nodes; no nodes if no joint ties the member */
    /* of the forces at the latest iterate, in the axes of the frame */
    double *loads;                /* [6 nodes] global axes */
    double *elastic;              /* [n] of internal forces */
    double *x;                    /* [6 nodes] deformation; a prescribed root: if loads depend on it */
    const double *speeds, *rates; /* [n] y', y'' of the state, likewise */
    double *workspace;            /* a tangent of the interface nodes, and three vectors */
    int still;                    /* the forces are without inertia, */
    double factor;                /* with this part of loads and gravity */
    int steady;                   /* equilibrium in steady rotation, not a step */
    double steady_rotation[3];
    /* likewise, if joints move the root: */
    double *parts;  /* [13][n]: M y'', N_k y + f_k, G_k y', E_k y */
    double *heavy;  /* [6 nodes] M R (a - g, alpha) - s */
    double *out;    /* [2 n] forces at a displaced root */
    double *border; /* [12][n] rows and columns of the root in the tangent */
    spari_seconds seconds;
    double turns[3]; /* the mean rotation rate w, */
    double *stiff;   /* and K + S(w, w), laid out as the matrices */
} spari_floating_root;

/* Creates the root and finds the nodes that joints tie. Call it before the matrices exist. SPAR_OK or
   SPAR_ERR_MEMORY. */
int spari_floating_root_create(spari_frame *f, spar_member *m);
/* If joints move the root: saves M R and f before the matrices become those of the modes. */
int spari_floating_root_keep_pushes(spari_frame *f);
/* Allocates and computes the rest once the unknowns are known. */
int spari_floating_root_finish(spari_frame *f, const spar_member *m);
void spari_floating_root_free(spari_floating_root *c);
/* Operation of the row: the index of a node among root (0) and interface nodes. */
int spari_floating_root_end_of(const spar_member *m, int node);
/* The first of the six unknowns of interface node e (from 1). */
int spari_floating_root_at(const spari_frame *f, int e);
/* Modal: removes the shapes of the interface nodes from a deformation x [6 nodes] and puts their amplitudes into y.
   Returns the first unknown after them. */
int spari_floating_root_split(const spari_frame *f, double *x, double *y);
/* Modal: y less the rigid motion J about the root. */
void spari_floating_root_take_rigid(const spari_frame *f, const spar_member *m, const double J[6], double *y);

/* Sets the mean rotation rate w to that at time h after the state s, for the next forces. */
void spari_floating_root_rotate(spari_frame *f, const spari_frame_state *s, double h);
/* Forces r [n] of the state s. If joints move the root, the first six are r_0. still: without inertia. factor: of loads
   and gravity. Returns the scale to which their rounding is relative. */
double spari_floating_root_forces(spari_frame *f, const spar_member *m, const spari_frame_state *s, int still,
                                  double factor, double *r);
/* Whether the forces are linear in the unknowns: no load depends on these, and there is no added mass. */
int spari_carriage_is_linear(const spari_frame *f, const spar_member *m);
/* Forms and factors the tangent at the state s, and condenses it to the interface nodes. cm, cv, tinv: rates of the
   root per change. r: the forces of s. Returns 0, or 1 if it is singular. */
int spari_floating_root_tangent(spari_frame *f, const spar_member *m, const spari_frame_state *s, double cm, double cv,
                                const double tinv[9], const double *r);
/* In the axes of the frame, for x [6 (1 + ends)]: relative converts absolute motions of the interface nodes to motions
   relative to the root. absolute converts forces on the relative motions to forces on the absolute ones. */
void spari_floating_root_relative(const spari_frame *f, const spar_member *m, const double *y, double *x);
void spari_floating_root_absolute(const spari_frame *f, const spar_member *m, const double *y, double *x);

#endif
