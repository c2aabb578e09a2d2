/* Layout of the host's triples: packed, inside structures, or component by component. */
#include "state.h"

/* Largest index, in bits, that a layout may reach. */
enum { LAYOUT_BITS = 58 };

const spari_layout *spari_fluid_layout(const spar_fluid *fluid, int which) {
    return fluid->layout[which].node > 0 ? &fluid->layout[which] : NULL;
}

/* Whether two components overlap: of node j and a later node, one or two components apart. */
static int overlaps(int64_t n, int64_t node, int64_t component) {
    for (int apart = 1; apart <= 2; apart++) {
        if (apart * component % node == 0 && apart * component / node < n) {
            return 1;
        }
    }
    return 0;
}

int spar_fluid_set_layout(spar_fluid *fluid, int which, int64_t node, int64_t component) {
    SPARI_FLUID_HANDLE(fluid);
    SPARI_TRY(spari_fluid_check_which(fluid, which, __func__));
    SPARI_FLUID_REQUIRE(fluid, !fluid->member->session->state.trial, SPAR_ERR_STATE,
                        "a trial run is in progress; change fluids before or after it");
    int64_t n = spari_fluid_set(fluid, which)->n, most = INT64_C(1) << LAYOUT_BITS;
    SPARI_FLUID_REQUIRE(fluid, node >= 1 && node <= SPARI_MOST && component >= 1 && component <= SPARI_MOST,
                        SPAR_ERR_ARGUMENT, "node stride %lld and component stride %lld; give 1 to 2^40 for each",
                        (long long)node, (long long)component);
    SPARI_FLUID_REQUIRE(fluid, n < 2 || node <= most / (n - 1), SPAR_ERR_ARGUMENT,
                        "node stride %lld for %lld nodes makes the array too long; stride x count must not exceed 2^40",
                        (long long)node, (long long)n);
    SPARI_FLUID_REQUIRE(fluid, !overlaps(n, node, component), SPAR_ERR_ARGUMENT,
                        "node stride %lld and component stride %lld: entries of the %lld nodes overlap; set the nodes "
                        "first, then e.g. (1, n) for an array by component",
                        (long long)node, (long long)component, (long long)n);
    int packed = node == 3 && component == 1;
    fluid->layout[which] = packed ? (spari_layout){0, 0} : (spari_layout){node, component};
    return SPAR_OK;
}

int spar_fluid_get_layout(const spar_fluid *fluid, int which, int64_t *node, int64_t *component) {
    SPARI_FLUID_HANDLE(fluid);
    SPARI_TRY(spari_fluid_check_which(fluid, which, __func__));
    const spari_layout *layout = spari_fluid_layout(fluid, which);
    SPARI_GIVE(node, layout ? layout->node : 3);
    SPARI_GIVE(component, layout ? layout->component : 1);
    return SPAR_OK;
}
