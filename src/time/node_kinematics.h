/* What generalised-alpha does node by node, several nodes at once (node_kinematics_lanes.c): turns into the axes of the
   reused tangent and out of them, corrections, places, and how it all looks from a driven root and from outside.
   Numbers have the same bits however many nodes go at once. */
#ifndef SPARI_NODE_KINEMATICS_H
#define SPARI_NODE_KINEMATICS_H

#include "body_solver.h"

/* Arrays of all nodes; what a function does not mention it does not look at. */
typedef struct spari_node_work {
    int lanes; /* nodes at once at most; 0: what the processor has (tests try all) */
    const spari_scheme *c;
    const spari_state *from, *to; /* a substep's ends as the scheme has them */
    const double *stage;          /* [n][6] velocities at the end of a trapezoidal stage, for the next one */
    double *x, *dx;               /* [n][6] increments and their correction */
    double cut;                   /* how much of the correction is applied */
    const double *q, *kept;       /* [n][7] now; [n][4] how nodes were turned when the tangent was formed */
    double *rotation;             /* [n][4] their turn since; NULL: the correction is not in the axes of the tangent */
    const double *r;              /* [n][6] forces */
    const double *R;              /* [9] how a driven root is turned; NULL: there is none */
} spari_node_work;

/* A root, and nodes on either side of it. */
typedef struct spari_root_view {
    int lanes;
    const spar_member *member;
    const spari_pose *root;
    const double *R;               /* [9] how it is turned */
    const double *omega, *alpha;   /* its angular velocity and acceleration in its own axes */
    const spari_state *own, *seen; /* as it sees them, and from outside */
} spari_root_view;

/* What nodes lose of a root that jumps, in its axes (driven_root.h). */
typedef struct spari_root_jump {
    int lanes;
    const spar_member *member;
    const spari_state *own;
    double velocity[6], position[6], back[4]; /* back: the turn of the place, undone */
} spari_root_jump;

/* Of the largest displacement and turn of nodes, the squares. */
typedef struct spari_node_size {
    double way, rotation;
} spari_node_size;

/* All of nodes [from, to). */
/* turn := q kept*; dx := the forces r, turned back. The largest of them, infinite where one is no number. */
double spari_nodes_rotate_back(const spari_node_work *t, int64_t from, int64_t to);
/* dx := turned forth. */
void spari_nodes_rotate_forth(const spari_node_work *t, int64_t from, int64_t to);
/* dx := what x has to lose: turned forth, into the axes of the root, rotations through the inverse tangent operator of
   the rotation vector and the inverse of d psi / d x = I - k omega^n~, k = h^2 cv / 12. */
spari_node_size spari_nodes_take(const spari_node_work *t, int64_t from, int64_t to);
/* Starting values of a substep: x and the rates (spari_scheme_predict). */
void spari_nodes_predict(const spari_node_work *t, spari_guess stays, int64_t from, int64_t to);
/* x and the rates less cut dx. */
void spari_nodes_correct(const spari_node_work *t, int64_t from, int64_t to);
/* Places from the increments x, and without inertia the rates. The rotation vector is the increment plus h^2/12
   omega^{n+1} x omega^n, the next term of Magnus' series for a rate that changes linearly: the scheme stays of second
   order and reversible, and a fast spin about an axis that turns no longer drifts off its axis. The size of x. */
spari_node_size spari_nodes_positions(const spari_node_work *t, int64_t from, int64_t to);
/* take, correct and place at once, with inertia and nothing cut: the same bits. by, way: what take and place answer. */
void spari_nodes_advance(const spari_node_work *t, int64_t from, int64_t to, spari_node_size *by, spari_node_size *way);
/* The size of x. */
spari_node_size spari_nodes_size(const spari_node_work *t, int64_t from, int64_t to);
/* seen := own, seen from outside. */
void spari_nodes_show(const spari_root_view *t, int64_t from, int64_t to);
/* own := seen, as the root sees it; b as it is. */
void spari_nodes_look(const spari_root_view *t, int64_t from, int64_t to);
/* Of own, places and rates less the jump of the root as it takes a node along. */
void spari_nodes_lose(const spari_root_jump *t, int64_t from, int64_t to);

#endif
