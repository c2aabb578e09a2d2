/* Temporary coupling for a solution that is not a step: it has its own columns and weights, because those of the
   steps belong to another map. See coupling.h. */
#include "coupling.h"

#include "../comm/enter.h"
#include "../exchange/session_private.h"

int spari_coupling_suspend(spar_session *s, int scheme) {
    spari_coupling *own = NULL;
    int status = spari_enter(s, "coupling", spari_coupling_create(s, scheme, 1, &own));
    if (status != SPAR_OK) {
        spari_coupling_free(&own);
        return status;
    }
    s->own->suspended = s->own->coupling;
    s->own->coupling = own;
    return SPAR_OK;
}

void spari_coupling_keep(spar_session *s) {
    const spari_coupling *of_steps = s->own->suspended;
    if (of_steps) {
        s->own->coupling->report[SPAR_REPORT_UNCONVERGED] = of_steps->report[SPAR_REPORT_UNCONVERGED];
    }
    spari_coupling_free(&s->own->suspended);
    s->coupling.stale = 1;
}

static void swap_lists(double **a, double **b) {
    double *other = *a;
    *a = *b;
    *b = other;
}

void spari_coupling_resume(spar_session *s) {
    spari_coupling *own = s->own->coupling, *of_steps = s->own->suspended;
    if (!of_steps) {
        s->coupling.stale = 1;
        return;
    }
    int most = of_steps->most;
    of_steps->most = own->most;
    own->most = most;
    of_steps->iterations = own->iterations;
    swap_lists(&of_steps->residual, &own->residual);
    swap_lists(&of_steps->size, &own->size);
    for (int i = 0; i <= SPAR_REPORT_DROPPED; i++) {
        of_steps->report[i] = own->report[i];
    }
    of_steps->report[SPAR_REPORT_ADDED_MASS_SPREAD] = own->report[SPAR_REPORT_ADDED_MASS_SPREAD];
    s->own->coupling = of_steps;
    s->own->suspended = NULL;
    spari_coupling_free(&own);
}
