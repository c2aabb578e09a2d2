/* Nodal loads of a fluid from step to step, and as reproducible sums. */
#include "state.h"

#include "../base/status.h"

#include <stdlib.h>
#include <string.h>

enum { PUSHED, NEXT, ACCEPTED }; /* bins of load, load_new, load_accepted */

static size_t count_loads(const spar_fluid *fluid) {
    return fluid->load ? 6 * (size_t)fluid->member->nodes : 0;
}

void spari_fluid_drop_bins(spar_fluid *fluid) {
    for (int k = 0; k < 3; k++) {
        free(fluid->bins[k]);
        fluid->bins[k] = NULL;
    }
}

void spari_fluid_refill_bins(spar_fluid *fluid) {
    for (size_t i = 0; fluid->bins[PUSHED] && i < count_loads(fluid); i++) {
        fluid->bins[PUSHED][i] = (spari_bins){0};
        spari_bins_add(fluid->bins[PUSHED] + i, fluid->load[i]);
    }
}

int spari_fluid_make_bins(spar_fluid *fluid) {
    size_t n = count_loads(fluid);
    if (fluid->bins[PUSHED]) {
        return SPAR_OK;
    }
    for (int k = 0; k < 3; k++) {
        fluid->bins[k] = spari_zalloc((int64_t)n, sizeof *fluid->bins[k]);
        if (!fluid->bins[k]) {
            spari_fluid_drop_bins(fluid);
            return SPAR_ERR_MEMORY;
        }
    }
    for (size_t i = 0; i < n; i++) {
        spari_bins_add(fluid->bins[PUSHED] + i, fluid->load[i]);
        spari_bins_add(fluid->bins[ACCEPTED] + i, fluid->load_accepted[i]);
    }
    return SPAR_OK;
}

static void copy_loads_of(spar_fluid *fluid, double *to, const double *from, int bins_to, int bins_from) {
    size_t n = count_loads(fluid);
    if (n > 0) {
        memcpy(to, from, n * sizeof *to);
    }
    if (n > 0 && fluid->bins[PUSHED]) {
        memcpy(fluid->bins[bins_to], fluid->bins[bins_from], n * sizeof *fluid->bins[bins_to]);
    }
}

void spari_fluid_keep_loads(spar_fluid *fluid) {
    copy_loads_of(fluid, fluid->load_accepted, fluid->load, ACCEPTED, PUSHED);
}

void spari_fluid_revert_loads(spar_fluid *fluid) {
    copy_loads_of(fluid, fluid->load, fluid->load_accepted, PUSHED, ACCEPTED);
}

int spari_fluid_touches(const spar_fluid *fluid) {
    int touches = fluid->set[SPAR_NODES_MOTION].n > 0 || fluid->set[SPAR_NODES_FORCE].n > 0;
    for (size_t i = 0; i < count_loads(fluid) && !touches; i++) {
        touches = fluid->load[i] != 0;
    }
    return touches;
}

void spari_fluid_add_loads(const spar_fluid *fluid, double *load) {
    for (int64_t i = 0; fluid->load && i < 6 * fluid->member->nodes; i++) {
        load[i] += fluid->load[i];
    }
}

void spari_fluid_add_bins(const spar_fluid *fluid, spari_bins *load) {
    for (size_t i = 0; i < count_loads(fluid); i++) {
        if (fluid->bins[PUSHED]) {
            spari_bins_merge(load + i, fluid->bins[PUSHED] + i);
        } else {
            spari_bins_add(load + i, fluid->load[i]);
        }
    }
}
