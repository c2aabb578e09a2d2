/* The reference motion of a member that turns freely. Over a step, the integration takes the motion of the nodes
   relative to it (docs/explanation/theory.md, "Members that turn"). In fixed axes a step combines positions and
   velocities along chords: what is stiff is strained, and the scheme's damping takes energy from the rotation.

   The frame rotates with a constant angular velocity. Its origin is the joint that carries the member, and moves in a
   circle with what the joint is fixed to. Without a joint it is the mass centre; of a member that flies alone, whose
   mean then moves in axes at rest and keeps its momentum. A steady rotation of an assembly is then rest in the frames
   of its members. Frames follow from the momenta of members at t^n and from the velocities that are published there,
   which are on the constraints: oscillations of accelerations and of multipliers do not reach them
   (docs/evidence/beam.md, "Members that turn").

   A member that deforms has its motion in the axes of its frame. A rigid body of one node is integrated in axes at rest
   at its mass centre, or at its joint if this does not turn. In a step of TR-BDF2 the mass centre is integrated
   relative to the point of the frame that is there at t^n. */
#ifndef SPARI_TURNING_FRAME_H
#define SPARI_TURNING_FRAME_H

#include "body_solver.h"

/* What carries a member at t^n. */
typedef struct spari_carrier {
    int turns;                   /* the member can rotate as a whole */
    int held;                    /* the origin is a joint to what does not rotate */
    double x[3], v[3];           /* of the origin, x relative to the root's reference position */
    double w[3], alpha[3];       /* angular velocity and acceleration of the member's frame, */
    double path[3], grows[3];    /* and of what the origin is fixed to */
    double point[3];             /* from the root's node to the joint, at the reference */
    double base_v[3], base_a[3]; /* of the ground, or of the mass centre of an assembly that flies freely */
} spari_carrier;

typedef enum spari_turning_kind { SPARI_TURNS_NOT, SPARI_TURNS_WITH_FRAME, SPARI_TURNS_AS_BODY } spari_turning_kind;

typedef struct spari_turning_frame {
    spari_turning_kind kind;
    spari_pose begin; /* at t^n: its origin, relative to the root's reference position, and its rotation */
    int alone;        /* no joint carries it: its origin follows the mean of the nodes */
    double path[3];   /* angular velocity of the path of the origin */
    double steady[3]; /* the part of the origin's acceleration that does not rotate with the path */
    double centre[3]; /* of a body: from the node to the point that is integrated, at the reference, */
    double arm[3];    /* and from the origin to there at t^n */
    int rests;        /* of a body: this point is integrated in axes at rest */
} spari_turning_frame;

/* The carrier of a member without a joint: its mass centre, or a pinned root. */
void spari_carrier_begin(const spari_solver *solver, const spar_member *member, spari_carrier *carrier);
/* The angular velocity and acceleration of the rigid motion with the member's momenta about its origin, which has the
   acceleration a. */
void spari_carrier_rotation(const spari_solver *solver, const spar_member *member, const double a[3],
                            spari_carrier *carrier);
/* Finds the frame of a step dt of a member with inertia. */
void spari_turning_frame_find(const spari_solver *solver, const spar_member *member, spari_rule rule, double dt,
                              const spari_carrier *carrier, spari_turning_frame *frame);
/* Its pose after so much time. */
spari_pose spari_turning_frame_at(const spari_turning_frame *frame, double time);
/* The parts of the mass that count at the unique nodes: share [n]. */
void spari_turning_shares(const spari_solver *solver, double *share);
/* Whether a free body has one node. c: from it to the mass centre, at the reference. */
int spari_turning_centre(const spari_solver *solver, const spar_member *member, double c[3]);

/* Motion of the point at R c from a node, relative to `origin` (NULL: absolute), and the inverse. Only the translation
   differs. b is copied. */
void spari_centre_look(const double c[3], const spari_pose *origin, const spari_state *node, spari_state *centre);
void spari_centre_show(const double c[3], const spari_pose *origin, const spari_state *centre, spari_state *node);

#endif
