/* All kernels of an element for one vector width. Included by lanes.c once per width with the macros of
   math/width.h. No include guard: this is a body, not an interface. */
#define SPARI_FUSED 1
#include "forces_lanes.h"
#include "nodes_lanes.h"
#include "tangent_lanes.h"
#undef SPARI_FUSED
