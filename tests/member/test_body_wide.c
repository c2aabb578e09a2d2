/* The tests of the discretised member with eight lanes in plain C: the arithmetic of the widest kernel on processors
   that lack its instructions. The kernels come with this file instead of the library's. */
#define SPARI_PLAIN_LANES 8
#if defined(__GNUC__)
#pragma GCC diagnostic ignored "-Wpsabi" /* such vectors are never passed, all is inlined */
#endif
#include "member/element_lanes.c"
#include "member/lanes.c"

#include "test_body.c"
