/* All kernels of an element for one width of vectors (math/lanes.h). */
#include "element_kernels.h"

#include "../base/status.h"
#include "../math/basis.h"

#ifdef SPARI_HAS_OBJECT
#define SPARI_WIDTH SPARI_OBJECT_WIDTH
#include "../math/width.h"
#define SPARI_FUSED 1
#include "forces_lanes.h"
#include "nodes_lanes.h"
#include "tangent_lanes.h"

const spari_element_kernels NAME(spari_element_kernels) = {
    .width = W,
    .interpolate = NAME(interpolate_block),
    .forces = {NAME(massless_forces), NAME(weighed_forces), NAME(accelerated_forces)},
    .gather = NAME(gather_nodes),
    .add = NAME(add_nodes),
    .collect = NAME(collect),
    .matrices = NAME(element_matrices),
    .products = NAME(pair_products),
    .sum = NAME(sum_pairs),
    .project = NAME(project),
};
#endif
