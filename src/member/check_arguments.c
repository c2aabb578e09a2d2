/* Argument checks shared by the public calls on members: see check_arguments.h. */
#include "check_arguments.h"

#include "../comm/enter.h"
#include "../math/rotation.h"

#include <stdio.h>
#include <stdlib.h>

int spari_need_member(const spar_member *member, const char *call) {
    SPARI_REQUIRE(NULL, member, SPAR_ERR_ARGUMENT, "%s: the member is NULL; create it first", call);
    return SPAR_OK;
}

int spari_need_open(spar_member *member, const char *call) {
    SPARI_TRY(spari_need_member(member, call));
    SPARI_REQUIRE(member->session, !member->committed, SPAR_ERR_STATE,
                  "%s: member '%s' is committed; describe it before spar_member_commit", call, member->name);
    return SPAR_OK;
}

int spari_need_committed(const spar_member *member, const char *call) {
    SPARI_TRY(spari_need_member(member, call));
    SPARI_REQUIRE(member->session, member->committed, SPAR_ERR_STATE,
                  "%s: member '%s' is not committed; call spar_member_commit first", call, member->name);
    return SPAR_OK;
}

int spari_need_all_committed(const spar_session *s, const char *call) {
    for (const spar_member *m = s->members; m; m = m->next) {
        SPARI_TRY(spari_need_committed(m, call));
    }
    return SPAR_OK;
}

int spari_need_no_trial(const spar_session *s, const char *call) {
    SPARI_REQUIRE(s, !s->state.trial, SPAR_ERR_STATE, "%s: a trial run is in progress; call this before or after it",
                  call);
    return SPAR_OK;
}

int spari_need_idle(const spar_session *s, const char *call) {
    SPARI_REQUIRE(s, s->state.phase == SPARI_IDLE, SPAR_ERR_STATE,
                  "%s: a step is in progress; accept or reject it first", call);
    return SPAR_OK;
}

int spari_need_any_beam(const spar_member *member, const char *call) {
    SPARI_TRY(spari_need_member(member, call));
    SPARI_REQUIRE(member->session, member->kind == SPARI_BEAM, SPAR_ERR_ARGUMENT,
                  "%s: member '%s' is not a beam; call this for a beam alone", call, member->name);
    return SPAR_OK;
}

int spari_need_beam(spar_member *member, const char *call) {
    SPARI_TRY(spari_need_open(member, call));
    return spari_need_any_beam(member, call);
}

int spari_line_table_set(const spar_member *member, const char *call, const char *what, int64_t n, int width,
                         const double *eta, const double *value, spari_line_table *table) {
    spari_line_table copy = {n, NULL, NULL};
    if (n > 0) {
        copy.eta = eta ? spari_copy(eta, n) : spari_zalloc(n, sizeof *eta);
        copy.value = spari_copy(value, width * n);
        if (!copy.eta || !copy.value) {
            SPARI_FREE(copy.eta, copy.value);
            return spari_fail(member->session, SPAR_ERR_MEMORY, "%s: '%s': no memory for the %s", call, member->name,
                              what);
        }
    }
    SPARI_FREE(table->eta, table->value);
    *table = copy;
    return SPAR_OK;
}

int spari_line_table_get(const spar_member *member, const char *call, int width, const spari_line_table *table,
                         int64_t capacity, int64_t *count, double *eta, double *value) {
    SPARI_TRY(spari_need_capacity(member->session, call, capacity));
    SPARI_GIVE(count, table->count);
    spari_fill(capacity, eta, table->count, table->eta);
    spari_fill(width * capacity, value, width * table->count, table->value);
    return SPAR_OK;
}

int spari_need_finite(spar_session *session, const char *call, const char *name, const char *what, int64_t n,
                      const double *x) {
    SPARI_REQUIRE(session, x || n == 0, SPAR_ERR_ARGUMENT, "%s: '%s': %s is NULL", call, name, what);
    int64_t at = spari_first_nonfinite(x, n);
    SPARI_REQUIRE(session, at < 0, SPAR_ERR_ARGUMENT, "%s: '%s': entry %lld of %s is not a finite number", call, name,
                  (long long)at, what);
    return SPAR_OK;
}

int spari_need_dt(spar_session *session, const char *call, double dt) {
    static const double least = 1e-100;
    SPARI_REQUIRE(session, isfinite(dt) && dt >= least, SPAR_ERR_ARGUMENT,
                  "%s: dt is %g; give a positive number of seconds, %g or more", call, dt, least);
    return SPAR_OK;
}

int spari_need_unit(spar_session *session, const char *call, const char *name, const char *what, int64_t n,
                    const double *q, int stride) {
    for (int64_t i = 0; i < n; i++) {
        double size = spari_quat_dot(q + stride * i, q + stride * i);
        SPARI_REQUIRE(session, fabs(size - 1) < 1e-6, SPAR_ERR_ARGUMENT,
                      "%s: '%s': quaternion %lld of %s has length %g; give unit quaternions, scalar first", call, name,
                      (long long)i, what, sqrt(size));
    }
    return SPAR_OK;
}

int spari_need_eta(spar_session *session, const char *call, const char *name, int64_t n, const double *eta,
                   spari_order order) {
    SPARI_TRY(spari_need_finite(session, call, name, "eta", n, eta));
    for (int64_t i = 0; i < n; i++) {
        SPARI_REQUIRE(session, eta[i] >= -1e-9 && eta[i] <= 1 + 1e-9, SPAR_ERR_ARGUMENT,
                      "%s: '%s': eta %lld is %g; eta runs from 0 to 1", call, name, (long long)i, eta[i]);
        SPARI_REQUIRE(session, i == 0 || order != SPARI_INCREASING || eta[i] > eta[i - 1], SPAR_ERR_ARGUMENT,
                      "%s: '%s': eta %lld (%.17g) is not above the previous one", call, name, (long long)i, eta[i]);
        SPARI_REQUIRE(session, i == 0 || order != SPARI_WITH_JUMPS || eta[i] >= eta[i - 1], SPAR_ERR_ARGUMENT,
                      "%s: '%s': eta %lld (%.17g) is below the previous one; two stations at the same eta mark a jump",
                      call, name, (long long)i, eta[i]);
    }
    return SPAR_OK;
}

int spari_need_stations(const spar_member *beam, const char *call, int64_t n, int64_t most, const double *eta,
                        spari_order order, const char *what, int width, const double *value) {
    SPARI_REQUIRE(beam->session, n >= 0 && n <= most, SPAR_ERR_ARGUMENT,
                  "%s: '%s': %lld stations; give 0 (removes all) to %lld", call, beam->name, (long long)n,
                  (long long)most);
    SPARI_TRY(spari_need_eta(beam->session, call, beam->name, n, eta, order));
    return spari_need_finite(beam->session, call, beam->name, what, width * n, value);
}

int spari_member_enter(const spar_member *member, const char *call, const spari_agreed *must_agree, int count,
                       int status) {
    char what[SPARI_MESSAGE_SIZE / 2];
    (void)snprintf(what, sizeof what, "%s: member '%s'", call, member->name);
    return spari_enter_agreed(member->session, what, must_agree, count, status);
}
