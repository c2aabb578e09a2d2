/* Undamped shapes of all that a session solves for, of the symmetric part of its equations of small motions. */
#ifndef SPARI_SHAPES_H
#define SPARI_SHAPES_H

#include "small_motions.h"

/* As many as are asked for at most. */
enum { SPARI_SHAPES_MOST = 200 };

/* Nodes of the members that have been committed: as many as shapes are shown at. */
int64_t spari_shapes_nodes(const spar_session *session);
/* K, C or M (kind 0, 1, 2) times x. */
void spari_shapes_times(const spari_pencil *pencil, int kind, const double *x, double *y);
double spari_shapes_product(int n, const double *a, const double *b);
/* The lowest shapes [modes][size], of unit mass, and their rates [modes], > 0; a status and a message. */
int spari_shapes_find(spari_swing *swing, int modes, double *shape, double *rate);
/* As motion of the nodes of all members [modes][nodes][6]; what spar does not solve for stands still. */
void spari_shapes_show(const spari_swing *swing, int modes, const double *shape, double *nodes);

#endif
