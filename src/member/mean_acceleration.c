/* Mean accelerations for fluids: see mean_acceleration.h. */
#include "mean_acceleration.h"

#include "../base/session.h"
#include "../math/resample.h"
#include "added_mass.h"

#include <stdlib.h>
#include <string.h>

int spari_means_make(spar_member *m) {
    if (m->means || (m->added && (m->guess.count > 0 || !m->learned)) || !m->body ||
        !(m->effects & SPAR_EFFECT_INERTIA)) {
        return SPAR_OK;
    }
    spari_means *k = spari_zalloc(1, sizeof *k);
    double *all = k ? spari_zalloc(18 * m->nodes, sizeof *all) : NULL;
    if (!all) {
        free(k);
        return spari_fail(m->session, SPAR_ERR_MEMORY, "no memory for the mean accelerations of '%s'", m->name);
    }
    k->mean = all;
    k->seen[0] = all + 6 * m->nodes;
    k->seen[1] = all + 12 * m->nodes;
    m->means = k;
    return SPAR_OK;
}

int spari_means_keep(spar_member *m) {
    const spar_session *s = m->session;
    return s->integrator.substeps > 1 || s->clock.uneven[0] ? spari_means_make(m) : SPAR_OK;
}

void spari_means_free(spari_means *k) {
    if (k) {
        SPARI_FREE(k->mean, k);
    }
}

const double *spari_means_seen(const spar_member *m, int after) {
    const spari_means *k = m->means;
    return k && k->has[after] && !m->session->state.static_solution ? k->seen[after] : after ? m->after.a : m->now.a;
}

/* How far the mean is extrapolated by its change from what there was at t^n, or half a step before it. */
static double weight_of_change(const spar_session *s, const spari_means *k) {
    return k->has[0] ? s->clock.dt / (s->clock.dt + k->dt) : 1;
}

void spari_means_find(spar_member *m) {
    const spar_session *s = m->session;
    spari_means *k = m->means;
    k->has[1] = (s->integrator.substeps > 1 || s->clock.uneven[1]) && !(m->added && m->added->stands);
    double on = k->has[0] || s->clock.step > 0 || m->initial.acceleration ? weight_of_change(s, k) : 0;
    const double *before = k->has[0] ? k->mean : m->now.a; /* at t^n, half as far back */
    for (int64_t i = 0; i < 6 * m->nodes && k->has[1]; i++) {
        double mean = (m->after.v[i] - m->now.v[i]) / s->clock.dt;
        k->seen[1][i] = mean + on * (mean - before[i]);
    }
}

double spari_means_rate(const spar_session *s) {
    const spar_member *m = s->members;
    while (m && !m->means) {
        m = m->next;
    }
    if (!m || !(s->integrator.substeps > 1 || s->clock.uneven[1])) {
        return 0;
    }
    return (1 + weight_of_change(s, m->means)) / s->clock.dt;
}

void spari_means_accept(spar_member *m) {
    spari_means *k = m->means;
    k->has[0] = k->has[1];
    k->dt = m->session->clock.dt;
    for (int64_t i = 0; i < 6 * m->nodes && k->has[1]; i++) {
        k->mean[i] = (m->after.v[i] - m->now.v[i]) / k->dt;
        k->seen[0][i] = k->seen[1][i];
    }
}

void spari_means_reject(spar_member *m) {
    spari_means *k = m->means;
    k->has[1] = k->has[0];
    memcpy(k->seen[1], k->seen[0], (size_t)(6 * m->nodes) * sizeof(double));
}

void spari_means_forget(spar_member *m) {
    if (m->means) {
        m->means->has[0] = m->means->has[1] = 0;
    }
}

void spari_means_carry(const spar_member *from, spar_member *m) {
    const spari_means *old = from->means;
    spari_means *k = m->means;
    if (!old || !k || !old->has[0]) {
        return;
    }
    const double *rows[3] = {old->mean, old->seen[0], old->seen[1]};
    double *to[3] = {k->mean, k->seen[0], k->seen[1]};
    for (int i = 0; i < 3; i++) {
        spari_resample_values(from->mesh, m->mesh, 6, -1, rows[i], to[i]);
    }
    k->dt = old->dt;
    k->has[0] = k->has[1] = 1;
}
