/* The tests of linear systems with one lane: what a compiler without vectors makes of the kernels. They come
   with this file instead of the library's. */
#define SPARI_PLAIN_LANES 1
#include "algebra/linear.c"
#include "algebra/linear_lanes.c"

#include "test_linear.c"
