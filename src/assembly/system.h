/* The linear system of an assembly: what remains of its members at their interface nodes (condense.h), and the
   constraints. Constraints form a tree of interface nodes, whose root is the ground. Nodes that constraints of six
   motions tie together move as one rigid body, a cluster, and have six unknowns in common. A constraint of fewer
   motions has its multipliers in the block of the cluster that it ties to the tree, which is eliminated before the one
   it hangs on: what remains there is the system in relative coordinates (Featherstone, Rigid Body Dynamics Algorithms
   (2008), 8.7). Only constraints that close loops have blocks of their own. */
#ifndef SPARI_TIED_H
#define SPARI_TIED_H

#include "../member/joint.h"
#include "../algebra/block_matrix.h"
#include "../time/component.h"

/* Numbers in `turning` of a link. */
enum { SPARI_TURNING = 144 };

typedef enum spari_link_role { SPARI_LINK_SPRING, SPARI_LINK_TREE, SPARI_LINK_LOOP } spari_link_role;

/* An interface node, and the constraint that ties it to the tree. */
typedef struct spari_interface {
    int fixed;     /* so many of its first unknowns its root condition holds */
    int parent;    /* interface node; -1: the ground, or none */
    int link;      /* that ties it to its parent; -1: none */
    int side;      /* of that link: its own */
    int depth;     /* how many links lead to it */
    int cluster;   /* the interface node whose unknowns the cluster has; -1: the ground */
    int block;     /* of that node: in the system */
    double arm[3]; /* from that node to this, as the system was formed */
    double gap[6]; /* its motion beside that of the cluster, from the gaps of the links that lead to it */
    double E[9];   /* of a node with the unknowns of another: its small rotation by those of the link */
} spari_interface;

/* A joint of an assembly, as it stands in the system. */
typedef struct spari_link {
    spar_joint *joint;
    spari_limb *limb[2]; /* NULL: the ground, or a node that moves as it is told */
    int node[2];         /* interface nodes; -1: given motion */
    spari_link_role role;
    int block;          /* in the system, where it closes a loop */
    spari_driven drive; /* at the end of the substep, */
    spari_driven to;    /* or on the way there: there */
    spari_relative begin;
    spari_place place[2];
    double v[12], a[12], B[6][12];
    int springs;            /* springs and dampers act */
    double turning[12][12]; /* what the turning of its load adds to the tangent, in the axes of the kept tangents */
    double gap[6], correction[6]; /* of the constraints; of the multipliers */
    /* As the system was formed: B, a stiffness that scales its rows, whether it has a tangent, and that. */
    double rows[6][12], scale;
    int stiff;
    double K[12][12];
} spari_link;

struct spari_assembly {
    spar_session *session;
    spari_assembly *next;
    int owner, here; /* the rank that solves it; whether this one does, or all do: where there are no limbs */
    int limbs, links;
    spari_limb *limb;
    spari_link *link; /* on every rank; what follows is the owner's */
    double mass;      /* of the parts */
    int turns;        /* the equilibrium under way is that of a whole that turns so (turning.h) */
    spari_turning turning;
    int interfaces;
    spari_interface *interface;
    int *order;         /* of the interface nodes: parents first */
    int clusters;       /* whether any of them has the unknowns of another */
    int loops;          /* whether constraints close loops */
    int solved;         /* the parts and links stand at the end of a step */
    spari_trace trace;  /* of Newton; strict it forgets the rate */
    int factored_begun; /* the same two as the step began, and the links' turning */
    spari_trace trace_begun;
    spari_snapshot before;
    int factored;     /* whether there are tangents: how many iterations the solution took that formed them, or 0 */
    int violent;      /* velocities are held within the step's equations */
    int turns_far;    /* joints turn far in a substep */
    int standing;     /* the system below is factored, for the tangents there are and this cv, */
    double cv, moved; /* and the parts' way since; only within a solution */
    double scale;     /* its largest stiffness */
    double penalty;   /* of constraints that close loops, by their scale */
    int potential;    /* its loads have one; at rest */
    double shift;     /* stiffness of every motion of a cluster beside its own, N/m; at rest */
    spari_blocks *system;
    double *x, *y; /* [interfaces][6] */
    double *b;     /* of the system */
    double *rates; /* 6 of each node of the largest part */
};

/* The relative motion of a link in the states of its parts, at the part s of the step dt where a node moves as it is
   told, and the loads on what is free; those on what is held are the multipliers, which stay. factor: of the loads that
   the host and preloads give. */
void spari_link_find(spari_link *l, double s, double dt, double factor);
/* B v */
void spari_link_times(double B[6][12], const double v[12], double rate[6]);
/* How far a held motion, or its rate, is from where it has to be. */
double spari_link_gap(const spari_link *l, int k);
double spari_link_rate_gap(const spari_link *l, int k);
/* The side that stands: the ground, or a node that is told to; -1: none. */
int spari_link_standing(const spari_link *l);
/* What its dampers add to the tangent where the other side turns steadily with w: velocities go with places. */
void spari_link_turning_dampers(spari_link *l, const double w[3]);
/* The links' forces, taken from the parts' residuals; fixed unknowns out. */
void spari_links_add(spari_assembly *a);
/* Of the system factored last: the smallest pivot by the largest stiffness. */
double spari_tied_weakest(const spari_assembly *a);
/* Of the same, where the system is watched (block_matrix.h): how many negative eigenvalues it has that are not those of
   its multipliers. Where loads have a potential that is minimal there are none. */
int spari_tied_downward(const spari_assembly *a);
/* What it lets go nearly freely, the motion of a joint, or of a member; text stays where it cannot be told. Spends the
   factors. */
void spari_tied_name_free(spari_assembly *a, char *text, int size);
/* Keeps what the links' loads add to the tangent, with the parts' tangents as they have just been formed. */
void spari_tied_keep(spari_assembly *a);
/* Of the parts' forces and the links' gaps: the parts' corrections and `correction` that take both away. The
   constraints are those of the links as they stand; the parts' tangents, kept, go along with their nodes. cv: as for
   the tangents. 0 or 1. */
int spari_tied_solve(spari_assembly *a, double cv);
/* Of the gaps alone, without forces. */
int spari_tied_close(spari_assembly *a, double cv);
/* Takes down what rings along the constraints at the end of a substep, the part s of the step dt. 0 or 1. */
int spari_tied_calm(spari_assembly *a, double s, double dt);
/* Whether a link holds motion k. */
static inline int spari_link_holds(const spari_link *l, int k) {
    return l->joint->held >> k & 1;
}
/* How many motions it holds. */
static inline int spari_link_holds_count(const spari_link *l) {
    int count = 0;
    for (int k = 0; k < 6; k++) {
        count += spari_link_holds(l, k);
    }
    return count;
}
/* Finds the tree. 0, or SPAR_ERR_MEMORY. */
int spari_tied_tree(spari_assembly *a);
/* Removes redundant constraints from the joints that close loops, with a word to the log. The links' B are those of the
   reference. 0, or SPAR_ERR_MEMORY. */
int spari_tied_drop_redundant(spari_assembly *a);
/* Memory for the system of the tree. 0, or SPAR_ERR_MEMORY. */
int spari_tied_room(spari_assembly *a);
void spari_tied_free(spari_assembly *a);

#endif
