/* The geometry of a joint: the motion of a frame that a node `a` carries relative to one that a node `b` carries, or
   the ground, in six coordinates, and how they change with small motions of the two nodes. Knows no member.

   Translations are those of a's point in b's axes. Rotations depend on how many are free: none, twice the vector part
   of the relative quaternion r; one, the angle of the twist about it, and for the other two how far a's axis leaves
   b's; two, the angles of a universal joint, about the first axis as b carries it and about the second as a carries it,
   and for the third how far these two are from a right angle; three, the rotation vector of r. All are rotations in rad
   to first order, and each set is smooth wherever the coordinates that are held are near 0. */
#ifndef SPARI_TIE_H
#define SPARI_TIE_H

typedef struct spari_tie {
    int free;          /* SPAR_FREE_* */
    double arm[2][3];  /* from the reference place of node a, b to the joint, global axes */
    double axes[2][4]; /* the joint's axes in the reference, as a and b carry them */
    int line;          /* a line: its one coordinate is the distance from b's point to a's */
} spari_tie;

/* Pose of a node now: place and turn from the reference. */
typedef struct spari_place {
    double x[3], q[4];
} spari_place;

/* Relative motion z[6], and B[6][12], its change with (du, dtheta) of a and of b, all in global axes: z-dot = B (v_a,
   v_b). B NULL: not wanted. A line has z[0] alone, all else is 0. */
void spari_tie_motion(const spari_tie *tie, const spari_place *a, const spari_place *b, double z[6], double B[6][12]);
/* Forces of the tie on the nodes, f[12] = B^T load. */
void spari_tie_forces(double B[6][12], const double load[6], double f[12]);
/* K[12][12] += d(B^T load) at constant load: what a turning load adds to the tangent. */
void spari_tie_tangent(const spari_tie *tie, const spari_place *a, const spari_place *b, const double load[6],
                       double K[12][12]);
/* R[6][12] := d(B v) of small motions of the two nodes at constant v[12]. */
void spari_tie_rates(const spari_tie *tie, const spari_place *a, const spari_place *b, const double v[12],
                     double R[6][12]);
/* What of B v changes with time though v does not: B-dot v, by v[12] of both nodes. */
void spari_tie_drift(const spari_tie *tie, const spari_place *a, const spari_place *b, const double v[12],
                     double rate[6]);
/* The axis about which alone the tie turns freely, 0 to 2; -1: there is none. */
int spari_tie_axis(int free);
/* Bits of the rotations (1, 2, 4) that are angles, which go on beyond a turn: those that are free, up to two. */
int spari_tie_angles(int free);

#endif
