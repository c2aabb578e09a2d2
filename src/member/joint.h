/* A joint: what ties a node of a member to a node of another, or to the ground. What it is stands here; how the members
   it ties are solved, in assembly/assembly.h. */
#ifndef SPARI_JOINT_H
#define SPARI_JOINT_H

#include "joint_kinematics.h"
#include "structure.h"

/* Relative motion at one time: coordinates (angles of a hinge or universal joint count their turns), rates, and the
   load on a, in the joint's axes on its six motions: of what is held the constraint's, of what is free the spring's,
   the damper's and the host's.
 */
typedef struct spari_relative {
    double z[6], rate[6], load[6];
    double found; /* 1: by a solution; 0: nothing has been found yet */
} spari_relative;

/* Of chosen free motions, at one time. */
typedef struct spari_driven {
    double z[6], rate[6], acceleration[6];
} spari_driven;

struct spar_joint {
    spar_session *session;
    spar_joint *next; /* in order of creation, the same on every rank */
    char *name;
    spar_member *member[2]; /* a and b; b NULL: the ground */
    int64_t node[2];
    int64_t seat[2]; /* the nodes whose motion carries the ends: those, or the root where one body carries a beam */
    int unique[2];   /* the same of the unknowns' nodes; after the members are committed */
    int placed;      /* seats, arms and axes are known */
    spari_tie tie;   /* arms and axes: then too */
    int frame_given;
    double place[3], axes[4]; /* of spar_joint_set_frame */
    double point[2][3];       /* of a line */

    int sprung, slack;                             /* slack: a line that only pulls */
    double stiffness[36], damping[36], preload[6]; /* on the free motions */
    double length;                                 /* a line's, unstretched */
    double given[6], before[6];                    /* spar_joint_set_load, and what it was in the step accepted last */
    double left;                                   /* part of the step still to come at the stage under way */
    int driven;                                    /* mask of free motions */
    spari_driven drive[2];                         /* at t^n and t^{n+1} */
    int drive_given;
    int held; /* mask of motions that are constraints: not free, or driven, and not redundant */

    spari_relative now, after; /* at t^n and t^{n+1} */
    double account[3];         /* what dampers have taken, drives and the host's load given, up to t^n; where kept */
    spari_relative described;  /* now, before the balance at t^0 was found; while `balanced` */
    int balanced;
};

/* The unknowns' node of a node of the public numbering. */
int spari_member_unique(const spar_member *member, int64_t node);
/* Whether a joint ties it to something. */
int spari_member_is_tied(const spar_member *member);
/* The description as one number: all that is said of it before the first step. */
uint64_t spari_joint_hash(const spar_joint *joint);
/* What may be given of it at any time, as one number: springs, load, drive. And of all joints, which the ranks compare
   before a solution; 0 on one rank, and while joints are described. */
uint64_t spari_joint_setting(const spar_joint *joint);
uint64_t spari_joints_setting(const spar_session *session);
/* Mask of the motions that a joint gives: those not free and the driven ones. */
int spari_joint_given(const spar_joint *joint);
/* The host's load on motion k where the part `left` of a step is still to come: linear in the step; in the first step
   it stands from the beginning. */
double spari_joint_load_at(const spar_joint *joint, int k, double left);
/* Loads on the free motions, from springs, dampers, and `factor` of preloads and the host's: load[k] of motions that
   are not free stays as it is. speed: as in spari_joint_pull. Whether springs and dampers act: a line that only pulls
   may be slack. */
int spari_joint_spring(const spar_joint *joint, const double z[6], const double rate[6], double speed, double factor,
                       double load[6]);
/* The pull of a line's spring and damper. A line that only pulls is slack up to its length. Beyond, the damper feels
   the rate, and in a step the rate at which the line can have stretched since it came taut, at most: the stretch times
   `speed`, the change of the step's rates with its coordinates. Then the pull of a step grows from 0, is a straight
   line over the motion and has a solution, and its limit for short steps is that at every moment (speed INFINITY). */
double spari_joint_pull(const spar_joint *joint, const double z[6], const double rate[6], double speed);
/* Whether its nodes are where it can tie them; a status and a message. And places arms and axes. After both members are
   committed. */
int spari_joint_check_place(const spar_joint *joint);
void spari_joint_place(spar_joint *joint);
/* z with the angles of a hinge or universal joint brought to the turns nearest to `near`. */
void spari_joint_count_turns(const spar_joint *joint, const double near[6], double z[6]);
/* Driven motions at the part s of the step dt: cubic Hermite. */
void spari_joint_drive_at(const spar_joint *joint, double s, double dt, spari_driven *at);
/* A driven joint that was not driven for this step stays where it is. */
void spari_joint_hold(spar_joint *joint);
/* `after` is what belongs to the balance of forces at t^0: the step begins with it, if it is not rejected. */
void spari_joint_balance(spar_joint *joint);
/* The step under way is accepted, or given up: the first one with the balance at t^0. */
void spari_joint_accept(spar_joint *joint);
void spari_joint_reject(spar_joint *joint);
/* A balanced start has ended: what it found is that of t^0. */
void spari_joint_end_start(spar_joint *joint);
/* Where its two nodes are in the motion after. */
void spari_joint_places(const spar_joint *joint, spari_place place[2]);
/* The second rates of its coordinates in the motion after; 0 before that is found. */
void spari_joint_acceleration(const spar_joint *joint, double acceleration[6]);
/* load[6] += what the joints put on a node of a member, in the motion after. */
void spari_joints_on(const spar_member *member, int64_t node, double load[6]);
/* The same on all nodes [n][6] of an external member, of any other nothing: what its host solves it with, so that they
   are among the loads that the coupling iterates. */
void spari_joints_on_external(const spar_member *member, double *load);
/* Whether joints tie members whose motion the host may give while it is asked for its loads, external ones and points:
   what joints put on these and on the others is that of the motion which it has just given, so that the others are
   solved again. And whether it has given one in the step under way. */
int spari_joints_tie_given(const spar_session *session);
int spari_joints_tie_moved(const spar_session *session);
void spari_joint_free(spar_joint *joint);

#endif
