/* The transfer tests with one lane: what a compiler without vectors makes of the kernels. They come with this file
   instead of the library's. */
#define SPARI_PLAIN_LANES 1
#include "transfer/transfer.c"
#include "transfer/transfer_lanes.c"

#include "test_transfer.c"
