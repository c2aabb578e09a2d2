/* Cost of a run, counted by operations, so that it is reproducible, unlike times. The unit is an instruction of a
   processor with vectors of four doubles. The prices are in rules.h. */
#ifndef SPARI_COST_H
#define SPARI_COST_H

#include "../member/structure.h"

/* Of a step that was just accepted: transfer between members and fluids, and the coupling's accelerator. This
   rank's. */
double spari_cost_step(const spar_session *session, int iterations);
/* Of all solutions since the members were created, for members of this rank. each[members]: cost per member; may be
   NULL. */
double spari_cost_members(const spar_session *session, double *each);
/* Of a solution of a linear beam, or of a modal one (modes > 0), with these elements and nodes per element. */
double spari_cost_frame(const spar_member *member, int elements, int nodes, int modes);
/* Of a Newton iteration, and of a tangent, of an exact beam. points: quadrature points; 0: as described. */
double spari_cost_exact(const spar_member *member, int elements, int nodes, int points);
/* Expected cost of a solution of this rank's fluids, from their nodes. */
double spari_cost_fluids(const spar_session *session);
/* Cost of a fluid solution: the host's value, s (option fluid_cost of the trial); if that is 0, the expectation from
   its nodes. If the measured time is far from that, it is the time, rounded so coarsely that timing noise has no
   effect. */
double spari_cost_solution(double given, double by_nodes, double seconds, int64_t solutions);
/* Whether the time is so close to the boundary of two classes that another run may fall in the other. */
int spari_cost_wavers(double given, double by_nodes, double seconds, int64_t solutions);

#endif
