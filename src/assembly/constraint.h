/* A constraint of an assembly: the equations of a joint between the components that it connects. */
#ifndef SPARI_CONSTRAINT_H
#define SPARI_CONSTRAINT_H

#include "../member/joint.h"
#include "../time/component.h"

typedef enum spari_constraint_role {
    SPARI_CONSTRAINT_SPRING,
    SPARI_CONSTRAINT_TREE,
    SPARI_CONSTRAINT_LOOP
} spari_constraint_role;

/* A constraint: the equations of a joint in an assembly. The data of an iteration come first. */
typedef struct spari_constraint {
    spar_joint *joint;
    spari_component *component[2]; /* NULL: the ground, or a node with prescribed motion */
    int node[2];                   /* interface nodes; -1: prescribed motion */
    spari_constraint_role role;
    int block;                    /* in the system, if it closes a loop */
    int springs;                  /* springs and dampers act */
    int stiff;                    /* as the system was formed: whether it has a tangent, */
    double scale, stiffest;       /* a stiffness that scales its rows, and the largest entry of the tangent */
    double gap[6], correction[6]; /* of the constraints; of the multipliers */
    double rate_gap[6];           /* of the rates, beyond what closing the gaps changes; over the scheme's rate */
    double reach;                 /* length of the longer one of its components */
    spari_node_pose pose[2];
    double force[12]; /* on its nodes, by spari_constraint_find_force */
    double v[12], a[12], B[6][12];
    double rows[6][12]; /* B of the constrained motions, as the system was formed */
    int ball;           /* as it was formed: whether the load of a ball is all that gives it a tangent, */
    double pull[3];     /* and this load, global axes */
    spari_driven drive; /* prescribed motion of the joint at the end of the substep, */
    spari_driven to;    /* and on the way there */
    spari_relative begin;
} spari_constraint;

/* Whether motion k is constrained. */
static inline int spari_constraint_holds(const spari_constraint *l, int k) {
    return l->joint->constrained >> k & 1;
}
/* The number of constrained motions. */
static inline int spari_constraint_count(const spari_constraint *l) {
    int count = 0;
    for (int k = 0; k < 6; k++) {
        count += spari_constraint_holds(l, k);
    }
    return count;
}
/* Finds the relative motion of a constraint from the states of its components, and the loads on its free motions.
   Nodes with prescribed motion are at the part s of the step dt. The loads on constrained motions are the
   multipliers, which stay. factor: of the host's load and of preloads. */
void spari_constraint_find(spari_constraint *l, double s, double dt, double factor);
/* The same after only the velocities of its components have changed. */
void spari_constraint_find_rates(spari_constraint *l, double dt, double factor);
/* Computes the forces on the nodes from the present loads. */
void spari_constraint_find_force(spari_constraint *l);
/* rate := B v */
void spari_constraint_times(double B[6][12], const double v[12], double rate[6]);
/* The error of constrained motion k, and of its rate. */
double spari_constraint_gap(const spari_constraint *l, int k);
double spari_constraint_rate_gap(const spari_constraint *l, int k);
/* Sets the gaps to the errors of the accelerations. */
void spari_constraint_set_acceleration_gaps(spari_constraint *l);
/* The side that is the ground or has prescribed motion; -1: none. */
int spari_constraint_fixed_side(const spari_constraint *l);
/* Adds the dampers to K where the other side rotates steadily with w: there velocities depend on positions. */
void spari_constraint_rotate_dampers(const spari_constraint *l, const double w[3], double K[12][12]);

#endif
