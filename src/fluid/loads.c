/* Nodal loads of a fluid from step to step, and their reproducible sums. */
#include "state.h"

#include "../base/status.h"

#include <stdlib.h>
#include <string.h>

static size_t count_loads(const spar_fluid *fluid) {
    return fluid->load ? 6 * (size_t)fluid->member->nodes : 0;
}

void spari_fluid_add_twice(spari_bins *sum, double x) {
    spari_bins one = {0};
    spari_bins_add(&one, x);
    spari_bins_double(&one);
    spari_bins_merge(sum, &one);
}

static void drop_some(spar_fluid *fluid, int first, int last) {
    for (int k = first; k <= last; k++) {
        free(fluid->bins[k]);
        fluid->bins[k] = NULL;
    }
}

void spari_fluid_drop_bins(spar_fluid *fluid) {
    drop_some(fluid, 0, SPARI_OF_COUNT - 1);
}

/* Allocates sums of kinds first to last for the existing values; value NULL: their content is irrelevant. */
static int make_some(spar_fluid *fluid, int first, int last, const double *const *value) {
    int64_t n = (int64_t)count_loads(fluid);
    if (fluid->bins[first]) {
        return SPAR_OK;
    }
    for (int k = first; k <= last; k++) {
        fluid->bins[k] = spari_zalloc(n, sizeof *fluid->bins[k]);
        if (!fluid->bins[k]) {
            drop_some(fluid, first, last);
            return SPAR_ERR_MEMORY;
        }
        for (int64_t i = 0; value[k - first] && i < n; i++) {
            spari_fluid_add_twice(fluid->bins[k] + i, value[k - first][i]);
        }
    }
    return SPAR_OK;
}

int spari_fluid_make_bins(spar_fluid *fluid) {
    const spari_parts *p = fluid->parts;
    const double *loads[] = {fluid->load, NULL, fluid->load_accepted};
    SPARI_TRY(make_some(fluid, SPARI_OF_PUSHED, SPARI_OF_ACCEPTED, loads));
    return p ? make_some(fluid, SPARI_OF_MEAN, SPARI_OF_END, (const double *const[]){NULL, p->end[0], p->end[1]})
             : SPAR_OK;
}

static void copy_loads_of(spar_fluid *fluid, double *to, const double *from, int bins_to, int bins_from) {
    size_t n = count_loads(fluid);
    if (n > 0) {
        memcpy(to, from, n * sizeof *to);
    }
    if (n > 0 && fluid->bins[SPARI_OF_PUSHED]) {
        memcpy(fluid->bins[bins_to], fluid->bins[bins_from], n * sizeof *fluid->bins[bins_to]);
    }
}

void spari_fluid_keep_loads(spar_fluid *fluid) {
    copy_loads_of(fluid, fluid->load_accepted, fluid->load, SPARI_OF_ACCEPTED, SPARI_OF_PUSHED);
}

void spari_fluid_revert_loads(spar_fluid *fluid) {
    copy_loads_of(fluid, fluid->load, fluid->load_accepted, SPARI_OF_PUSHED, SPARI_OF_ACCEPTED);
}

void spari_fluid_add_loads(const spar_fluid *fluid, double *load) {
    for (int64_t i = 0; fluid->load && i < 6 * fluid->member->nodes; i++) {
        load[i] += fluid->load[i];
    }
}

void spari_fluid_add_bins(const spar_fluid *fluid, spari_bins *load) {
    for (size_t i = 0; i < count_loads(fluid); i++) {
        if (fluid->bins[SPARI_OF_PUSHED]) {
            spari_bins_merge(load + i, fluid->bins[SPARI_OF_PUSHED] + i);
        } else {
            spari_fluid_add_twice(load + i, fluid->load[i]);
        }
    }
}

/* A fluid from a file, or one that was rebuilt, has the arrays. */
int spari_fluid_has_loads(const spar_fluid *fluid) {
    int has = fluid->asked & SPARI_ASKED_LOADS ? 1 : 0;
    for (int64_t i = 0; !has && fluid->load && i < 6 * fluid->member->nodes; i++) {
        has = fluid->load[i] != 0;
    }
    return has;
}
