/* Nodes that follow a root as one rigid body. */
#ifndef SPARI_RIGID_NODES_H
#define SPARI_RIGID_NODES_H

#include "../member/structure.h"

/* Moves the nodes with the root. */
void spari_rigid_nodes_move(const spar_member *member, const spari_pose *root, spari_motion *to);
/* The displacements and rotations [nodes][6] of the latest iterate for a small motion of the root. */
void spari_rigid_nodes_displace(const spar_member *member, const double root[6], double *nodes);
/* The operation `equilibrium` of their fidelities: the nodes stay where they are, at rest or in steady rotation with a
   driven root. */
void spari_rigid_nodes_equilibrium(spar_member *member);

#endif
