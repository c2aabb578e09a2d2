/* Kinematics of a joint: motion of a frame attached to node `a` relative to a frame attached to node `b` or to the
   ground, in six coordinates, and its derivatives. Independent of members.
   Translations are those of a's point in b's axes. Rotations depend on the number of free ones:
   - none: twice the vector part of the relative quaternion r;
   - one: the twist angle about the free axis, and the two deviations of a's axis from b's;
   - two: the angles of a universal joint, about the first axis attached to b and the second attached to a, and the
     deviation of these axes from a right angle;
   - three: the rotation vector of r.
   All are rotations in rad to first order. Each set is smooth where the constrained coordinates are near 0. */
#ifndef SPARI_JOINT_KINEMATICS_H
#define SPARI_JOINT_KINEMATICS_H

typedef struct spari_joint_kinematics {
    int free;          /* SPAR_FREE_* */
    double arm[2][3];  /* from the reference position of node a, b to the joint, global axes */
    double axes[2][4]; /* the joint's axes in the reference, attached to a and b */
    int line;          /* a link: its one coordinate is the distance from b's point to a's */
} spari_joint_kinematics;

/* Present pose of a node: position, and rotation from the reference. */
typedef struct spari_node_pose {
    double x[3], q[4];
} spari_node_pose;

/* Relative motion z[6], and B[6][12], its derivative with respect to (du, dtheta) of a and of b, in global axes:
   z-dot = B (v_a, v_b). B may be NULL. A link has z[0] alone; the rest is 0. */
void spari_kinematics_motion(const spari_joint_kinematics *kinematics, const spari_node_pose *a,
                             const spari_node_pose *b, double z[6], double B[6][12]);
/* Forces of the joint on the nodes, f[12] = B^T load. */
void spari_kinematics_forces(double B[6][12], const double load[6], double f[12]);
/* K[12][12] += d(B^T load) at constant load: geometric stiffness. */
void spari_kinematics_tangent(const spari_joint_kinematics *kinematics, const spari_node_pose *a,
                              const spari_node_pose *b, const double load[6], double K[12][12]);
/* R[6][12] := d(B v) for small motions of the two nodes at constant v[12]. */
void spari_kinematics_rates(const spari_joint_kinematics *kinematics, const spari_node_pose *a,
                            const spari_node_pose *b, const double v[12], double R[6][12]);
/* B-dot v: rate of change of B v at constant v[12] of both nodes. */
void spari_kinematics_drift(const spari_joint_kinematics *kinematics, const spari_node_pose *a,
                            const spari_node_pose *b, const double v[12], double rate[6]);
/* The only free rotation axis, 0 to 2; -1: there is none. */
int spari_kinematics_free_axis(int free);
/* Bits of the rotations (1, 2, 4) that are angles and count revolutions: the free ones, if at most two. */
int spari_kinematics_angles(int free);

#endif
