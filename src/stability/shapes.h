/* Undamped shapes of everything that a session solves, from the symmetric part of its small-motion equations. */
#ifndef SPARI_SHAPES_H
#define SPARI_SHAPES_H

#include "../trial/handle.h"
#include "small_motions.h"

/* Whether the trial can be analysed in its modes, for n results (`what`) into `out`. Local. */
int spari_shapes_ready(spar_trial *trial, const char *call, int64_t n, const char *what, const double *out);

/* Nodes of the committed members, at which shapes are given. */
int64_t spari_shapes_nodes(const spar_session *session);
/* K, C or M (kind 0, 1, 2) times x. */
void spari_shapes_times(const spari_pencil *pencil, int kind, const double *x, double *y);
double spari_shapes_product(int n, const double *a, const double *b);
/* Amplitude of a shape [nodes][6] that moves its nodes by one length of their member, or one radian. */
double spari_shapes_unit(const spar_session *session, const double *shape);
/* The motion of all nodes between steps, motion [nodes][13]: displacement, quaternion, velocity, angular velocity. */
enum { SPARI_NODE_MOTION = 13 };
void spari_shapes_keep_motion(const spar_session *session, double *motion);
/* The lowest shapes [modes][size], of unit mass, and their rates [modes], > 0; a status and a message. */
int spari_shapes_find(spari_small_motions *motions, int modes, double *shape, double *rate);
/* Converts shapes to motion of the nodes of all members [modes][nodes][6]; members that spar does not solve are at
   rest. */
void spari_shapes_show(const spari_small_motions *motions, int modes, const double *shape, double *nodes);

#endif
