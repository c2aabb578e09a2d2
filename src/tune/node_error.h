/* Error due to the nodes of a beam, without trials. */
#ifndef SPARI_NODE_ERROR_H
#define SPARI_NODE_ERROR_H

#include "../member/structure.h"

/* Whether the estimate applies: rigid members have no such error. */
int spari_nodes_error_applies(const spar_member *member);
/* Root mean square of the displacement towards the shape with four more nodes per element, m; -1: no result. Between
   steps. During the call the member is replaced by the finer one, which this rank solves. Local. */
int spari_nodes_error(spar_member *member, double *error);

#endif
