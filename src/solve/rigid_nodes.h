/* Nodes that a root carries as one rigid body. */
#ifndef SPARI_RIGID_NODES_H
#define SPARI_RIGID_NODES_H

#include "../member/structure.h"

/* The nodes where the motion of the root takes them. */
void spari_rigid_nodes_move(const spar_member *member, const spari_pose *root, spari_motion *to);
/* A small motion of the root, displacement and rotation, carried to all nodes [nodes][6] of the latest iterate. */
void spari_rigid_nodes_displace(const spar_member *member, const double root[6], double *nodes);
/* The operation `rest` of their rows: where the motion now is, at rest or turning steadily with a driven root. */
int spari_rigid_nodes_rest(spar_member *member, const double *fluid, int load_steps, int onward);

#endif
