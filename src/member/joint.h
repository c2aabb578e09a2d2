/* A joint connects a node of a member to a node of another member, or to the ground. This file holds its data; the
   solution of connected members is in assembly/assembly.h. */
#ifndef SPARI_JOINT_H
#define SPARI_JOINT_H

#include "joint_kinematics.h"
#include "structure.h"

/* Relative motion at one time: coordinates (angles of hinges and universal joints count revolutions), rates, and the
   load on a, in the joint's axes on its six motions. On constrained motions this is the constraint force; on free
   motions the force of spring, damper and host. */
typedef struct spari_relative {
    double z[6], rate[6], load[6];
    double found; /* 1: computed by a solution; 0: not yet */
} spari_relative;

/* Prescribed values of chosen free motions, at one time. */
typedef struct spari_driven {
    double z[6], rate[6], acceleration[6];
} spari_driven;

/* The data of an iteration come first, so that a large assembly reads few cache lines. */
struct spar_joint {
    spar_session *session;
    spar_member *member[2]; /* a and b; b NULL: the ground */
    int64_t seat[2];        /* nodes whose motion moves the ends: those given, or the root if one body carries a beam */
    int unique[2];          /* the same as unique nodes; after the members are committed */
    int constrained;        /* mask of constrained motions: not free, or driven, and not redundant */
    int driven;             /* mask of driven free motions */
    spari_joint_kinematics kinematics; /* lever arms and axes: once they are known */
    double reference[2][3];            /* reference positions of the seats; of the ground: 0 */
    int sprung, slack;                 /* slack: a link that only pulls */
    double length;                     /* unstretched length of a link */
    double left;                       /* remaining fraction of the step at the current stage */
    double given[6], before[6];        /* spar_joint_set_load, and its value in the last accepted step */
    double preload[6];                 /* on the free motions, as stiffness and damping */
    spari_relative after, now;         /* at t^{n+1} and t^n */
    spari_driven drive[2];             /* at t^n and t^{n+1} */
    double stiffness[36], damping[36];

    spar_joint *next; /* in order of creation, the same on every rank */
    char *name;
    int64_t node[2];
    int placed;     /* seats, lever arms and axes are known */
    int constraint; /* its place among the constraints of the assembly */
    int frame_given;
    double position[3], axes[4]; /* of spar_joint_set_frame */
    double point[2][3];          /* end points of a link */
    int drive_given;
    double account[3]; /* energy dissipated by dampers, supplied by drives and by the host's load, up to t^n; if kept */
    spari_relative described; /* `now` before the consistent initial conditions were computed; while `balanced` */
    int balanced;
};

/* Unique node of a node in the host's numbering. */
int spari_member_unique(const spar_member *member, int64_t node);
/* The description as one number, and for a saved file: all that is said of it before the first step. */
uint64_t spari_joint_hash(const spar_joint *joint);
void spari_joint_digest(const spar_joint *joint, spari_digest *digest);
/* Hash of what may change at any time: springs, load, drive. And that of all joints, which the ranks compare before
   a solution; 0 on one rank, and while joints are described. */
uint64_t spari_joint_setting(const spar_joint *joint);
uint64_t spari_joints_setting(const spar_session *session);
/* Mask of the constrained motions: not free, or driven. */
int spari_joint_constrained(const spar_joint *joint);
/* The host's load on motion k with the fraction `left` of a step remaining: linear in the step, constant in the
   first step. */
double spari_joint_load_at(const spar_joint *joint, int k, double left);
/* Loads on the free motions from springs, dampers, and `factor` times preloads and the host's loads. load[k] of
   other motions is unchanged. speed: as in spari_joint_pull. Returns whether springs and dampers act: a link that
   only pulls may be slack. */
int spari_joint_spring(const spar_joint *joint, const double z[6], const double rate[6], double speed, double factor,
                       double load[6]);
/* Tension of a link's spring and damper. A link that only pulls is slack up to its length. Beyond it the damper acts
   on the rate, limited in a step to the rate at which the link can have stretched since it became taut: the stretch
   times `speed`, the derivative of the step's rates with respect to its coordinates. So the tension grows from 0 and
   is piecewise linear in the motion, and the step has a solution. For short steps it tends to the instantaneous
   tension (speed INFINITY). */
double spari_joint_pull(const spar_joint *joint, const double z[6], const double rate[6], double speed);
/* check: whether the nodes are at connectable positions; a status and a message. place: computes lever arms and
   axes. Both after the members are committed. */
int spari_joint_check_place(const spar_joint *joint);
void spari_joint_place(spar_joint *joint);
/* z, with the angles of a hinge or universal joint shifted by full revolutions to be nearest to `near`. */
void spari_joint_count_turns(const spar_joint *joint, const double near[6], double z[6]);
/* Driven motions at fraction s of the step dt: cubic Hermite interpolation. */
void spari_joint_drive_at(const spar_joint *joint, double s, double dt, spari_driven *at);
/* Keeps the position of a driven joint that was not driven for this step. */
void spari_joint_hold(spar_joint *joint);
/* Makes `after` the start of the step: it belongs to the consistent initial conditions at t^0, unless they are
   rejected. */
void spari_joint_balance(spar_joint *joint);
/* Accepts or rejects the step; the first one with the initial conditions at t^0. */
void spari_joint_accept(spar_joint *joint);
void spari_joint_reject(spar_joint *joint);
/* Makes the computed initial conditions those of t^0. */
void spari_joint_end_start(spar_joint *joint);
/* Positions of its two nodes in the motion `after`. */
void spari_joint_poses(const spar_joint *joint, spari_node_pose position[2]);
/* Second derivatives of its coordinates in the motion `after`; 0 before this is computed. */
void spari_joint_acceleration(const spar_joint *joint, double acceleration[6]);
/* load[6] += loads of the joints on a node of a member, in the motion `after`. */
void spari_joints_on(const spar_member *member, int64_t node, double load[6]);
/* The same on all nodes [n][6] of an external member; nothing for others. The host solves the member with them, so
   they are among the loads of the coupling iteration. */
void spari_joints_on_external(const spar_member *member, double *load);
/* Whether joints connect members whose motion the host may set during the iteration (external members, points); then
   the other members must be solved again. And whether it has been set in this step. */
int spari_joints_hold_prescribed(const spar_session *session);
int spari_joints_hold_moved(const spar_session *session);
void spari_joint_free(spar_joint *joint);

/* Calls `with` for each joint of the session. */
static inline void spari_joints_each(const spar_session *session, void (*with)(spar_joint *joint)) {
    for (spar_joint *j = session->joints; j; j = j->next) {
        with(j);
    }
}

#endif
