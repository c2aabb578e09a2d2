/* The linear system of an assembly: the members condensed to their interface nodes (condense.h), and the
   constraints.

   Constraints form a tree of interface nodes, whose root is the ground. Nodes that constraints of six motions
   connect move as one rigid body, a cluster, and share six unknowns. A constraint of fewer motions ties the cluster to
   its parent in the tree (block_matrix.h): the system is that in relative coordinates (Featherstone, Rigid Body
   Dynamics Algorithms (2008), 8.7). Only constraints that close loops have blocks of their own, for their
   multipliers. */
#ifndef SPARI_SYSTEM_H
#define SPARI_SYSTEM_H

#include "../algebra/block_matrix.h"
#include "constraint.h"

/* An interface node, and the constraint that connects it to the tree. */
typedef struct spari_interface {
    int fixed;      /* how many of its first unknowns the root condition constrains */
    int parent;     /* interface node; -1: the ground, or none */
    int constraint; /* the constraint with its parent; -1: none */
    int side;       /* its own side of that constraint */
    int depth;      /* number of constraints from the ground to it */
    int cluster;    /* the interface node whose unknowns the cluster has; -1: the ground */
    int block;      /* of that node: in the system */
    double arm[3];  /* from that node to this one, as the system was formed */
    double gap[6];  /* its motion relative to the cluster, from the gaps of the constraints between them */
    double E[9];    /* of a node in the cluster of another: its small rotation by the rotation of the constraint */
} spari_interface;

struct spari_assembly {
    spar_session *session;
    spari_assembly *next;
    int owner, here; /* the rank that solves it; whether this rank does, or all do: if there are no components */
    int components, constraints;
    spari_component *component;
    spari_constraint *constraint; /* on every rank; what follows exists on the owner */
    double mass;                  /* of the components */
    int rotates;                  /* the present equilibrium is in steady rotation (rotation_check.h) */
    spari_rotating_frame rotating;
    int interfaces;
    spari_interface *interface;
    int *order;                 /* of the interface nodes: parents first */
    int clusters;               /* whether any of them has the unknowns of another; if so, */
    double (*tangents)[12][12]; /* [constraints] their tangents as the system was formed */
    int loops;                  /* whether constraints close loops */
    int solved;                 /* the components and constraints are at the end of a step */
    double left;                /* estimated remaining correction of Newton in the last solution */
    int stepping, formed;       /* a step has begun; it has formed tangents */
    int factored_begun;         /* these three at the beginning of the step */
    double left_begun;
    spari_tangent_reuse reuse_begun;
    int factored; /* there are tangents */
    spari_tangent_reuse reuse;
    int constrains_rates; /* the step's equations constrain velocities too */
    int rotates_far;      /* joints rotate far in a substep */
    int system_serves;    /* the system below is factored, for the present tangents and this cv, */
    double cv, moved;     /* and the motion of the components since; only within a solution */
    double scale[2];      /* its largest stiffness, of displacements and of rotations */
    double penalty;       /* of constraints that close loops, by their scale */
    double shift;         /* additional stiffness of every motion of a cluster, N/m; at rest */
    spari_blocks *system;
    double *x, *y; /* [interfaces][6] */
    double *b;     /* of the system, [rows][columns]: for the gaps and forces, and for the rates' gaps */
    int columns;
    int rates_off; /* there are rates' gaps */
    int wandered;  /* the solution of the substep needed new tangents in each iteration */
    double *rates; /* 6 of each node of the largest component */
};

/* Subtracts the constraints' forces from the residual of a component; constrained unknowns get none. */
void spari_constraints_add_forces(const spari_assembly *a, spari_component *p);
/* A member without joints is solved as an assembly of one component and no constraint. */
static inline spari_assembly spari_assembly_of_one(spari_component *p) {
    return (spari_assembly){.session = p->member->session, .here = 1, .components = 1, .component = p};
}
/* What the solver has used of the budget (base/budget.h). */
static inline spari_spent *spari_assembly_spent(const spari_assembly *a) {
    return &a->component[0].member->state.spent;
}
/* "member 'x'", or the members connected by a joint. */
void spari_assembly_name(const void *assembly, char *text, int size);
/* Motions and springs of joints whose nodes all have prescribed motion, at the end of a step dt. */
void spari_assembly_look(spari_assembly *a, double dt);
/* As spari_system_solve, or the component's own solution where there are no constraints. */
int spari_assembly_solve(spari_assembly *a, double cv);
/* Subtracts the part `cut` of the multipliers' corrections. */
void spari_constraints_correct_loads(spari_assembly *a, double cut);
/* Whether the system factored last has a motion whose stiffness rounding hides. unbalanced: the largest
   residual of the components; infinite if their loads have no potential. Destroys x, y and b. */
int spari_system_is_loose(spari_assembly *a, double unbalanced);
/* The number of negative eigenvalues of that system, apart from those of its multipliers, if the system counts them
   (block_matrix.h). There are none where the potential of the loads has a minimum. */
int spari_system_count_negative(const spari_assembly *a);
/* Names the motion with the least stiffness, of a joint or of a member. text stays if the motion is not known.
   Destroys the factors. */
void spari_system_name_free(spari_assembly *a, char *text, int size);
/* Solves for the corrections of the components, and of the multipliers (`correction`), that remove the components'
   residuals and the constraints' gaps. The constraints are those of the present positions; the reused tangents of
   the components follow their nodes. cv: as for the tangents. Returns 0 or 1. */
int spari_system_solve(spari_assembly *a, double cv);
/* The same in two parts: the condensed residuals (rotated: as for spari_component_reduce), and the solution. The
   residuals come first, because the system uses the rotations of the components that they find. rates:
   spari_system_solve_rates will be called; both solutions read the factors once. */
int spari_system_reduce(spari_assembly *a, int rotated);
int spari_system_solve_reduced(spari_assembly *a, double cv, int rates);
/* After this with `rates`: x and the corrections of the multipliers become those that close the rates' gaps, as by
   spari_system_solve_gaps. */
int spari_system_solve_rates(spari_assembly *a, double cv);
/* Solves for the gaps alone, without forces. x has the motion of the interface nodes; spari_component_clear and
   spari_component_expand compute the corrections of a component from its part. loads: whether those of the multipliers
   are needed. */
int spari_system_solve_gaps(spari_assembly *a, double cv, int loads);
/* The same for the rates at the end: shifts velocities by v, accelerations by `acceleration`, and the accelerations
   that the scheme carries by `memory`, times the corrections. Without constraints it does nothing. */
int spari_system_shift_rates(spari_assembly *a, double cv, double v, double acceleration, double memory);
/* Constraint damping: damps oscillations along the constraints at the end of a substep, at the part s of the step
   dt. Returns 0 or 1. */
int spari_system_damp_constraints(spari_assembly *a, double s, double dt);
/* Finds the tree. Returns 0 or SPAR_ERR_MEMORY. */
int spari_system_find_tree(spari_assembly *a);
/* Removes redundant constraints from the joints that close loops, and writes them to the log. B of the constraints:
   of the reference. Returns 0 or SPAR_ERR_MEMORY. */
int spari_system_drop_redundant(spari_assembly *a);
/* Allocates the system of the tree. Returns 0 or SPAR_ERR_MEMORY. */
int spari_system_create(spari_assembly *a);
void spari_system_free(spari_assembly *a);

#endif
