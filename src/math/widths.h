/* Includes a file of kernels, SPARI_KERNELS (path relative to this folder), once per available vector width:
   portable, AVX2, AVX-512 (width.h). SPARI_KERNELS is undefined afterwards. No include guard: this is a body, not an
   interface. */
#include "lanes.h"

#define SPARI_WIDTH 2
#include "width.h"
#include SPARI_KERNELS
#ifdef SPARI_X86
#define SPARI_WIDTH 4
#include "width.h"
#include SPARI_KERNELS
#define SPARI_WIDTH 8
#include "width.h"
#include SPARI_KERNELS
#endif
#define SPARI_WIDTH 0
#include "width.h"

#undef SPARI_KERNELS
