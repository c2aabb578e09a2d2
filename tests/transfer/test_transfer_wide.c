/* The transfer tests with eight lanes in plain C: the arithmetic and the weaving of the widest kernel on processors
   that lack its instructions. The kernels come with this file instead of the library's. */
#define SPARI_PLAIN_LANES 8
#if defined(__GNUC__)
#pragma GCC diagnostic ignored "-Wpsabi" /* such vectors are never passed, all is inlined */
#endif
#include "transfer/transfer.c"
#include "transfer/transfer_lanes.c"

#include "test_transfer.c"
