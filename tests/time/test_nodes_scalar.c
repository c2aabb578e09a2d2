/* The tests of nodes side by side with one lane: what a compiler without vectors makes of the kernels. They come with
   this file instead of the library's. */
#define SPARI_PLAIN_LANES 1
#include "time/node_kinematics.c"
#include "time/node_kinematics_lanes.c"

#include "test_nodes.c"
