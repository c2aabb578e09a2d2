/* Loads on the arms of a rigid body. */
#ifndef SPARI_OFFSET_LOADS_H
#define SPARI_OFFSET_LOADS_H

/* First moments sum (rho f^T) of the nodal forces over the arms of the reference, and those of t^n and t^{n+1}: a rigid
   body turned by R takes the moment of R Z. gravity: of the body, which goes with that of the member that has it. */
typedef struct spari_offset_loads {
    double Z[9], begin[9], end[9];
    double *gravity;
} spari_offset_loads;
void spari_offset_loads_at(spari_offset_loads *offset_loads, double s);
/* r[3] -= the moment at orientation q */
void spari_offset_loads_residual(const spari_offset_loads *offset_loads, const double q[4], double r[3]);
/* Adds its tangent to S [6][6]. */
void spari_offset_loads_tangent(const spari_offset_loads *offset_loads, const double q[4], double S[36]);

#endif
