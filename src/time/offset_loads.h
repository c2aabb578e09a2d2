/* Loads that act at an offset from the node of a rigid body. Their moment follows the rotation of the body. */
#ifndef SPARI_OFFSET_LOADS_H
#define SPARI_OFFSET_LOADS_H

/* First moments sum (rho f^T) of the nodal forces f at the reference offsets rho: now, at t^n and at t^{n+1}. A
   rigid body with rotation R gets the moment of R Z. gravity: that of the body, set to the member's. */
typedef struct spari_offset_loads {
    double Z[9], begin[9], end[9];
    double *gravity;
} spari_offset_loads;
void spari_offset_loads_at(spari_offset_loads *offset_loads, double s);
/* r[3] -= the moment at orientation q. */
void spari_offset_loads_residual(const spari_offset_loads *offset_loads, const double q[4], double r[3]);
/* Adds its tangent to S [6][6]. */
void spari_offset_loads_tangent(const spari_offset_loads *offset_loads, const double q[4], double S[36]);

#endif
