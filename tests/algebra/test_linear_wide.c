/* The tests of linear systems with eight lanes in plain C: the arithmetic of the widest kernel on processors
   that lack its instructions. They come
   with this file instead of the library's. */
#define SPARI_PLAIN_LANES 8
#if defined(__GNUC__)
#pragma GCC diagnostic ignored "-Wpsabi" /* such vectors are never passed, all is inlined */
#endif
#include "algebra/linear.c"
#include "algebra/linear_lanes.c"

#include "test_linear.c"
