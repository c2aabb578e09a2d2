/* Pretension of a beam: section forces of its reference configuration, given by the host. They are added to the
   section forces at quadrature points (stiffness_damping_lanes.h). So forces, energy, tangent (geometric stiffness),
   modes and linear members include them. */
#include "../base/environment.h"
#include "beam.h"
#include "check_arguments.h"

static int check_pretension(const spar_member *m, const char *call, int64_t n, const double *eta, const double *force) {
    spar_session *s = m->session;
    SPARI_REQUIRE(s, n >= 0 && n <= SPARI_MOST_POINT_MASSES, SPAR_ERR_ARGUMENT,
                  "%s: '%s': %lld stations; give 0 (removes all) to %d", call, m->name, (long long)n,
                  SPARI_MOST_POINT_MASSES);
    SPARI_TRY(spari_need_finite(s, call, m->name, "eta", n, eta));
    SPARI_TRY(spari_need_finite(s, call, m->name, "force", 6 * n, force));
    for (int64_t i = 0; i < n; i++) {
        SPARI_REQUIRE(s, eta[i] >= 0 && eta[i] <= 1 && (i == 0 || eta[i] > eta[i - 1]), SPAR_ERR_ARGUMENT,
                      "%s: '%s': eta %lld is %g; eta runs from 0 to 1 and must increase from station to station", call,
                      m->name, (long long)i, eta[i]);
    }
    return SPAR_OK;
}

int spar_beam_set_pretension(spar_member *beam, int64_t n, const double *eta, const double *force) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_TRY(spari_need_beam(beam, __func__));
    SPARI_TRY(check_pretension(beam, __func__, n, eta, force));
    spari_beam *b = beam->beam;
    return spari_keep_stations(beam, __func__, "pretension", n, 6, eta, force, &b->pre_count, &b->pre_eta, &b->pre);
}

int spar_beam_get_pretension(const spar_member *beam, int64_t *n, int64_t capacity, double *eta, double *force) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_TRY(spari_need_any_beam(beam, __func__));
    const spari_beam *b = beam->beam;
    return spari_give_stations(beam, __func__, 6, b->pre_count, b->pre_eta, b->pre, capacity, n, eta, force);
}
