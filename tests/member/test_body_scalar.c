/* The tests of the discretised member with one lane: what a compiler without vectors makes of the kernels. They come
   with this file instead of the library's. */
#define SPARI_PLAIN_LANES 1
#include "member/element_lanes.c"
#include "member/lanes.c"

#include "test_body.c"
