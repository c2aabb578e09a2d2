/* What a run costs, by what is counted in it: the same each time, as no time is. The unit is an instruction, of a
   processor with vectors of four doubles; the prices stand in the table of advice (rules.h). */
#ifndef SPARI_COST_H
#define SPARI_COST_H

#include "../member/structure.h"

/* A step just accepted: what passes between members and fluids, and the coupling's accelerator. This rank's. */
double spari_cost_step(const spar_session *session, int iterations);
/* All that has been solved since the members were made, of those this rank owns. each[members]: what for each of them;
   NULL: not wanted. */
double spari_cost_members(const spar_session *session, double *each);
/* What a solution of a linear beam costs, or of a modal one (modes > 0), in so many elements and nodes of each. */
double spari_cost_frame(const spar_member *member, int elements, int nodes, int modes);
/* What an iteration of Newton and a tangent of an exact one cost; points: of its quadrature, 0: as described. */
double spari_cost_exact(const spar_member *member, int elements, int nodes, int points);
/* What a solution of this rank's fluids may cost, by their nodes. */
double spari_cost_fluids(const spar_session *session);
/* What a solution of the fluid counts for: what the host says (option advise.fluid_cost), or else what its nodes say
   unless the time that solutions took is far from it; then that time, so coarsely that no clock's noise is in it. */
double spari_cost_solution(const spar_session *session, double by_nodes, double seconds, int64_t solutions);
/* Whether that time lies so near to a border of two classes that another run may find it in the other one. */
int spari_cost_wavers(const spar_session *session, double by_nodes, double seconds, int64_t solutions);

#endif
