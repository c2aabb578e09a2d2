/* The operations of generalised-alpha on single nodes, several nodes at once (node_kinematics_lanes.c): rotations
   into the axes of the reused tangent and back, corrections, positions, and motions relative to a driven root.
   Results have the same bits at every vector width. */
#ifndef SPARI_NODE_KINEMATICS_H
#define SPARI_NODE_KINEMATICS_H

#include "body_solver.h"

/* Arrays of all nodes. A function reads only the arrays that its comment names. */
typedef struct spari_node_work {
    int lanes; /* nodes at once at most; 0: what the processor has (tests try all) */
    const spari_scheme *c;
    const spari_state *from, *to; /* a substep's ends as the scheme has them */
    const double *stage;          /* [n][6] velocities at the end of a trapezoidal stage, for the next one */
    double *x, *dx;               /* [n][6] increments and their correction */
    double cut;                   /* how much of the correction is applied */
    const double *q, *tangent_q;  /* [n][7] now; [n][4] rotations when the tangent was formed */
    double *rotation;             /* [n][4] rotation since; NULL: the correction is not in the axes of the tangent */
    const double *r;              /* [n][6] forces */
    double per_length;            /* moments times this count as forces */
    const double *R;              /* [9] orientation of a driven root; NULL: there is none */
} spari_node_work;

/* A root, and the motion of nodes relative to it and in global axes. */
typedef struct spari_root_view {
    int lanes;
    const spar_member *member;
    const spari_pose *root;
    const double *R;                   /* [9] its orientation */
    const double *omega, *alpha;       /* its angular velocity and acceleration in its own axes */
    const spari_state *own, *absolute; /* relative to the root, and absolute */
} spari_root_view;

/* The jump of a root, in its axes (driven_root.h). The nodes do not follow it. */
typedef struct spari_root_jump {
    int lanes;
    const spar_member *member;
    const spari_state *own;
    double velocity[6], position[6], back[4]; /* back: inverse of the rotation in `position` */
} spari_root_jump;

/* Squares of the largest displacement and rotation of the nodes. */
typedef struct spari_node_size {
    double way, rotation;
} spari_node_size;

/* All of nodes [from, to). */
/* rotation := q kept*; dx := the forces r, rotated back. Returns the largest force, moments times per_length, infinite
   if one is not finite. */
double spari_nodes_rotate_back(const spari_node_work *t, int64_t from, int64_t to);
/* dx := dx rotated to the present axes. */
void spari_nodes_rotate_forth(const spari_node_work *t, int64_t from, int64_t to);
/* dx := the part to subtract from x. It is rotated to the present axes, then into the axes of the root. Rotations also
   pass the inverse tangent operator of the rotation vector and the inverse of d psi / d x = I - k omega^n~,
   k = h^2 cv / 12. */
spari_node_size spari_nodes_take(const spari_node_work *t, int64_t from, int64_t to);
/* Starting values of a substep: x and the rates (spari_scheme_predict). */
void spari_nodes_predict(const spari_node_work *t, spari_guess stays, int64_t from, int64_t to);
/* Subtracts cut dx from x, and the corresponding changes from the rates. */
void spari_nodes_correct(const spari_node_work *t, int64_t from, int64_t to);
/* Positions from the increments x, and without inertia also the rates. The rotation vector is the increment plus
   h^2/12 omega^{n+1} x omega^n, the next term of Magnus' series for a rate that changes linearly. The scheme stays
   of second order and reversible, and a fast spin about a changing axis does not drift off its axis. Returns the
   size of x. */
spari_node_size spari_nodes_positions(const spari_node_work *t, int64_t from, int64_t to);
/* take, correct and positions in one pass, with inertia and without a cut: the same bits. by, way: the results of
   take and of positions. */
void spari_nodes_advance(const spari_node_work *t, int64_t from, int64_t to, spari_node_size *by, spari_node_size *way);
/* The size of x. */
spari_node_size spari_nodes_size(const spari_node_work *t, int64_t from, int64_t to);
/* absolute := the motion of own. */
void spari_nodes_show(const spari_root_view *t, int64_t from, int64_t to);
/* own := absolute, relative to the root; b stays. */
void spari_nodes_look(const spari_root_view *t, int64_t from, int64_t to);
/* Subtracts the jump of the root from the positions and rates of own. */
void spari_nodes_lose(const spari_root_jump *t, int64_t from, int64_t to);

#endif
