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

/* Products of the deformation and its rates: y . N y and y' . N y of each product of turns, y' . E y', y' . E y, y'' .
 * E y.
 */
typedef struct spari_seconds {
    double yNy[SPARI_SPIN_PRODUCTS], vNy[SPARI_SPIN_PRODUCTS], vEv[3], vEy[3], aEy[3];
} spari_seconds;

typedef struct spari_floating_root {
    int *order;         /* [1 + ends] 0, 1, ...: as constraints know them */
    int ends, *node;    /* nodes that are tied beside the root, of the unknowns' nodes */
    spari_body *body;   /* the root: one node, no mass */
    spari_solver *root; /* its state is used where joints move it; the lengths of the steps in any case */
    /* where joints move the root: */
    double *push[6];                   /* [6 nodes] M R, of the nodes; NULL: no mass */
    double *spin[SPARI_SPIN_PRODUCTS]; /* [6 nodes] f likewise; NULL: none */
    double *mean;                      /* [3][n] (R^T M R)^-1 R^T M, of the turns */
    /* in any case: */
    double *block;              /* the memory of the two that follow */
    spari_state seen;           /* [1 + ends] the root and the tied nodes, as constraints see them */
    double *force;              /* [1 + ends][6] what is left on them, global axes */
    double *kept;               /* [2 n] rates, or places, to go back to */
    spari_condensed *condensed; /* of the root and the tied nodes; of no nodes where no joint ties the member */
    /* of the forces at the latest iterate, in the axes of the frame */
    double *loads;                /* [6 nodes] global axes */
    double *elastic;              /* [n] of internal forces */
    double *x;                    /* [6 nodes] deformation of the nodes; a prescribed root: where loads depend on it */
    const double *speeds, *rates; /* [n] y', y'' of the state, likewise */
    double *workspace;            /* of a tangent of the ends, and three vectors of them */
    int still;                    /* the forces are those without inertia, under */
    double factor;                /* so much of loads and gravity */
    int steady;                   /* the whole turns steadily with steady_rotation, the root where it is put: no step */
    double steady_rotation[3];
    /* likewise, where joints move the root: */
    double *parts;  /* [13][n]: M y'', N_k y + f_k, G_k y', E_k y */
    double *heavy;  /* [6 nodes] M R (a - g, alpha) - s */
    double *out;    /* [2 n] forces at a root that is moved a little */
    double *border; /* [12][n] rows and columns of the root in the tangent */
    spari_seconds seconds;
    double turns[3]; /* w, */
    double *stiff;   /* and of it K + S(w, w), as the matrices */
} spari_floating_root;

/* Makes the root and finds the nodes that joints tie; before the matrices are there. SPAR_OK or SPAR_ERR_MEMORY. */
int spari_floating_root_create(spari_frame *f, spar_member *m);
/* Where joints move the root: before the matrices become those of modes. */
int spari_floating_root_keep_pushes(spari_frame *f);
/* The rest, when the unknowns are known. */
int spari_floating_root_finish(spari_frame *f, const spar_member *m);
void spari_floating_root_free(spari_floating_root *c);
/* Of the row: which of the root and the tied nodes a node is; 0: the root. */
int spari_floating_root_end_of(const spar_member *m, int node);
/* Where the six unknowns of tied node e (from 1) are. */
int spari_floating_root_at(const spari_frame *f, int e);
/* Modal: takes the shapes of the tied nodes out of a deformation x [6 nodes] and gives their amplitudes into y; the
   first free unknown that is left. */
int spari_floating_root_split(const spari_frame *f, double *x, double *y);
/* Modal: y less the rigid motion J about the root. */
void spari_floating_root_take_rigid(const spari_frame *f, const spar_member *m, const double J[6], double *y);

/* The mean turning w after h beyond the state s, for the forces from now on. */
void spari_floating_root_rotate(spari_frame *f, const spari_frame_state *s, double h);
/* Forces r [n] of the state s; where joints move the root the first six are r_0; still: without inertia; factor: of
   loads and gravity. What rounding in them is relative to. */
double spari_floating_root_forces(spari_frame *f, const spar_member *m, const spari_frame_state *s, int still,
                                  double factor, double *r);
/* Whether they are linear in the unknowns: no load depends on these, and no guess of the fluid's added mass. */
int spari_carriage_is_linear(const spari_frame *f, const spar_member *m);
/* Forms and factors their tangent at that state, with the root's rates as cm, cv and tinv say, and what remains at the
   ends. r: the forces there. 0 or 1. */
int spari_floating_root_tangent(spari_frame *f, const spar_member *m, const spari_frame_state *s, double cm, double cv,
                                const double tinv[9], const double *r);
/* Motions of the ends x [6 (1 + ends)], axes of the frame: absolute ones become those seen from the root. And forces
   seen from the root become absolute ones. */
void spari_floating_root_relative(const spari_frame *f, const spar_member *m, const double *y, double *x);
void spari_floating_root_absolute(const spari_frame *f, const spar_member *m, const double *y, double *x);

#endif
