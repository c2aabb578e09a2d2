/* The linear system of an assembly: what remains of its members at their interface nodes (condense.h), and the
   constraints. Constraints form a tree of interface nodes, whose root is the ground. Nodes that constraints of six
   motions tie together move as one rigid body, a cluster, and have six unknowns in common. A constraint of fewer
   motions has its multipliers in the block of the cluster that it ties to the tree, which is eliminated before the one
   it hangs on: what remains there is the system in relative coordinates (Featherstone, Rigid Body Dynamics Algorithms
   (2008), 8.7). Only constraints that close loops have blocks of their own. */
#ifndef SPARI_SYSTEM_H
#define SPARI_SYSTEM_H

#include "../algebra/block_matrix.h"
#include "../member/joint.h"
#include "../time/component.h"

/* Numbers in `joint_tangent` of a constraint. */
enum { SPARI_JOINT_TANGENT = 144 };

typedef enum spari_constraint_role {
    SPARI_CONSTRAINT_SPRING,
    SPARI_CONSTRAINT_TREE,
    SPARI_CONSTRAINT_LOOP
} spari_constraint_role;

/* An interface node, and the constraint that ties it to the tree. */
typedef struct spari_interface {
    int fixed;      /* so many of its first unknowns its root condition holds */
    int parent;     /* interface node; -1: the ground, or none */
    int constraint; /* that ties it to its parent; -1: none */
    int side;       /* of that constraint: its own */
    int depth;      /* how many constraints lead to it */
    int cluster;    /* the interface node whose unknowns the cluster has; -1: the ground */
    int block;      /* of that node: in the system */
    double arm[3];  /* from that node to this, as the system was formed */
    double gap[6];  /* its motion beside that of the cluster, from the gaps of the constraints that lead to it */
    double E[9];    /* of a node with the unknowns of another: its small rotation by those of the constraint */
} spari_interface;

/* A joint of an assembly, as it stands in the system. */
typedef struct spari_constraint {
    spar_joint *joint;
    spari_component *component[2]; /* NULL: the ground, or a node with prescribed motion */
    int node[2];                   /* interface nodes; -1: given motion */
    spari_constraint_role role;
    int block;          /* in the system, where it closes a loop */
    spari_driven drive; /* at the end of the substep, */
    spari_driven to;    /* or on the way there: there */
    spari_relative begin;
    spari_node_pose pose[2];
    double v[12], a[12], B[6][12];
    int springs;                  /* springs and dampers act */
    double joint_tangent[12][12]; /* geometric stiffness of its load, in the axes of the reused tangents */
    double gap[6], correction[6]; /* of the constraints; of the multipliers */
    /* As the system was formed: B, a stiffness that scales its rows, whether it has a tangent, and that. */
    double rows[6][12], scale;
    int stiff;
    double K[12][12];
} spari_constraint;

struct spari_assembly {
    spar_session *session;
    spari_assembly *next;
    int owner, here; /* the rank that solves it; whether this one does, or all do: where there are no components */
    int components, constraints;
    spari_component *component;
    spari_constraint *constraint; /* on every rank; what follows is the owner's */
    double mass;                  /* of the parts */
    int rotates;                  /* the equilibrium under way is that of a whole that turns so (rotation_check.h) */
    spari_rotating_frame rotating;
    int interfaces;
    spari_interface *interface;
    int *order;         /* of the interface nodes: parents first */
    int clusters;       /* whether any of them has the unknowns of another */
    int loops;          /* whether constraints close loops */
    int solved;         /* the parts and constraints stand at the end of a step */
    spari_trace trace;  /* of Newton; strict it forgets the rate */
    int factored_begun; /* the same two as the step began, and the constraints' turning */
    spari_trace trace_begun;
    spari_snapshot before;
    int factored;     /* whether there are tangents: how many iterations the solution took that formed them, or 0 */
    int violent;      /* velocities are held within the step's equations */
    int rotates_far;  /* joints turn far in a substep */
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

/* The relative motion of a constraint in the states of its parts, at the part s of the step dt where the motion of a
   node is prescribed, and the loads on what is free; those on what is held are the multipliers, which stay. factor: of
   the loads that the host and preloads give. */
void spari_constraint_find(spari_constraint *l, double s, double dt, double factor);
/* B v */
void spari_constraint_times(double B[6][12], const double v[12], double rate[6]);
/* How far a constrained motion, or its rate, is from where it has to be. */
double spari_constraint_gap(const spari_constraint *l, int k);
double spari_constraint_rate_gap(const spari_constraint *l, int k);
/* The side that stands: the ground, or a node that is told to; -1: none. */
int spari_constraint_fixed_side(const spari_constraint *l);
/* What its dampers add to the tangent where the other side turns steadily with w: velocities go with places. */
void spari_constraint_rotate_dampers(spari_constraint *l, const double w[3]);
/* The constraints' forces, subtracted from the parts' residuals; fixed unknowns out. */
void spari_constraints_add_forces(spari_assembly *a);
/* Of the system factored last: the smallest pivot by the largest stiffness. */
double spari_system_weakest_pivot(const spari_assembly *a);
/* Of the same, where the system is watched (block_matrix.h): how many negative eigenvalues it has that are not those of
   its multipliers. Where loads have a potential that is minimal there are none. */
int spari_system_count_negative(const spari_assembly *a);
/* What it lets go nearly freely, the motion of a joint, or of a member; text stays where it cannot be told. Spends the
   factors. */
void spari_system_name_free(spari_assembly *a, char *text, int size);
/* Keeps what the constraints' loads add to the tangent, with the parts' tangents as they have just been formed. */
void spari_system_keep_joint_tangents(spari_assembly *a);
/* Of the parts' forces and the constraints' gaps: the parts' corrections and `correction` that take both away. The
   constraint rows are those of the joints as they stand; the parts' tangents, kept, go along with their nodes. cv: as
   for the tangents. 0 or 1. */
int spari_system_solve(spari_assembly *a, double cv);
/* Of the gaps alone, without forces. */
int spari_system_close_gaps(spari_assembly *a, double cv);
/* Takes down what rings along the constraints at the end of a substep, the part s of the step dt. 0 or 1. */
int spari_system_damp_constraints(spari_assembly *a, double s, double dt);
/* Whether a constraint holds motion k. */
static inline int spari_constraint_holds(const spari_constraint *l, int k) {
    return l->joint->constrained >> k & 1;
}
/* How many motions it holds. */
static inline int spari_constraint_count(const spari_constraint *l) {
    int count = 0;
    for (int k = 0; k < 6; k++) {
        count += spari_constraint_holds(l, k);
    }
    return count;
}
/* Finds the tree. 0, or SPAR_ERR_MEMORY. */
int spari_system_find_tree(spari_assembly *a);
/* Removes redundant constraints from the joints that close loops, with a word to the log. The constraints' B are those
   of the reference. 0, or SPAR_ERR_MEMORY. */
int spari_system_drop_redundant(spari_assembly *a);
/* Memory for the system of the tree. 0, or SPAR_ERR_MEMORY. */
int spari_system_create(spari_assembly *a);
void spari_system_free(spari_assembly *a);

#endif
