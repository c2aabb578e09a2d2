/* What is set for a session: the table that ranks are compared by, the setters, the options. */
#include "settings.h"

#include "../base/quiet.h"
#include "../comm/comm.h"
#include "../fluid/fluid.h"
#include "../math/predictor.h"
#include "../member/structure.h"
#include "../solve/life.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* What all ranks set alike. Not here: fluid.far and fluid.audit, which concern a rank's own nodes and nothing else. */
static const spari_setting settings[] = {
    {"gravity (x)", offsetof(spar_session, gravity), 0},
    {"gravity (y)", offsetof(spar_session, gravity) + sizeof(double), 0},
    {"gravity (z)", offsetof(spar_session, gravity) + 2 * sizeof(double), 0},
    {"rho_inf of spar_session_set_integrator", offsetof(spar_session, rho_inf), 0},
    {"substeps of spar_session_set_integrator", offsetof(spar_session, substeps), 1},
    {"atol of spar_session_set_newton", offsetof(spar_session, newton_atol), 0},
    {"rtol of spar_session_set_newton", offsetof(spar_session, newton_rtol), 0},
    {"max_iterations of spar_session_set_newton", offsetof(spar_session, newton_max), 1},
    {"order of spar_session_set_predictor", offsetof(spar_session, predictor), 1},
    {"scheme of spar_session_set_coupling", offsetof(spar_session, scheme), 1},
    {"atol of spar_session_set_coupling", offsetof(spar_session, coupling_atol), 0},
    {"rtol of spar_session_set_coupling", offsetof(spar_session, coupling_rtol), 0},
    {"max_iterations of spar_session_set_coupling", offsetof(spar_session, coupling_max), 1},
    {"omega of spar_session_set_relaxation", offsetof(spar_session, relaxation), 0},
    {"option coupling.unconverged (1: accept)", offsetof(spar_session, accept_unconverged), 1},
    {"option coupling.columns", offsetof(spar_session, coupling_columns), 1},
    {"option coupling.reuse", offsetof(spar_session, coupling_reuse), 1},
    {"option coupling.filter", offsetof(spar_session, coupling_filter), 0},
    {"option coupling.target", offsetof(spar_session, coupling_target), 0},
    {"option coupling.motion_atol", offsetof(spar_session, motion_atol), 0},
    {"option coupling.motion_rtol", offsetof(spar_session, motion_rtol), 0},
    {"option fluid.theta (1: group)", offsetof(spar_session, theta_on_group), 1},
    {"option advise.dt (1: keep)", offsetof(spar_session, keep_dt), 1},
    {"option advise.nodes (1: keep)", offsetof(spar_session, keep_nodes), 1},
    {"option advise.fidelity (1: keep)", offsetof(spar_session, keep_fidelity), 1},
    {"option advise.coupling (1: keep)", offsetof(spar_session, keep_coupling), 1},
    {"option advise.horizon", offsetof(spar_session, horizon), 0},
    {"option advise.fluid_cost", offsetof(spar_session, fluid_cost), 0},
    {"numbers of members", offsetof(spar_session, member_count), 1},
    /* what a setter has done, though the setting is as it was */
    {"calls that set the coupling", offsetof(spar_session, coupling_stale), 1},
    {"calls of spar_session_set_predictor", offsetof(spar_session, past), 1},
};

/* Default tolerances of Newton: what turning the axes or another number of ranks must not change (1e-11) stays below.
 */
static const double default_atol = 1e-15, default_rtol = 1e-12;

void spari_settings_default(spar_session *s) {
    s->settings = settings;
    s->setting_count = sizeof settings / sizeof *settings;
    s->rho_inf = 0.9;
    s->substeps = 1;
    s->newton_atol = default_atol;
    s->newton_rtol = default_rtol;
    s->newton_max = 50;
    s->predictor = 1;
    s->scheme = SPAR_COUPLING_EXPLICIT;
    s->coupling_atol = 1e-9;
    s->coupling_rtol = 1e-6;
    s->coupling_max = 50;
    s->relaxation = 1;
    s->coupling_columns = 30;
    s->coupling_reuse = 5;
    s->coupling_filter = 1e-4;
    s->coupling_target = 0.01;
    s->coupling_stale = 1;
}

/* ---- setters ---- */

static int settable(spar_session *session, const char *call) {
    SPARI_REQUIRE(NULL, session, SPAR_ERR_ARGUMENT, "%s: the session is NULL; create it first", call);
    SPARI_REQUIRE(session, session->phase == SPARI_IDLE, SPAR_ERR_STATE,
                  "%s: a step is under way; change settings between steps", call);
    return SPAR_OK;
}

int spar_session_set_gravity(spar_session *session, const double g[3]) {
    SPARI_QUIET;
    SPARI_TRY(settable(session, __func__));
    SPARI_REQUIRE(session, g && spari_first_nonfinite(g, 3) < 0, SPAR_ERR_ARGUMENT,
                  "%s: gravity must be three finite numbers", __func__);
    memcpy(session->gravity, g, sizeof session->gravity);
    for (spar_member *m = session->members; m; m = m->next) {
        if (m->committed) {
            spari_member_gravity(m);
        }
    }
    return SPAR_OK;
}

int spar_session_set_integrator(spar_session *session, double rho_inf, int substeps) {
    SPARI_QUIET;
    SPARI_TRY(settable(session, __func__));
    SPARI_REQUIRE(session, rho_inf >= 0 && rho_inf <= 1, SPAR_ERR_ARGUMENT,
                  "%s: rho_inf is %g; give 0 (most damping) to 1 (none)", __func__, rho_inf);
    SPARI_REQUIRE(session, substeps >= 1, SPAR_ERR_ARGUMENT, "%s: %d substeps; give at least 1", __func__, substeps);
    session->rho_inf = rho_inf;
    session->substeps = substeps;
    return SPAR_OK;
}

/* tolerances and iteration limits, wherever they are set */
static int check_limits(spar_session *session, const char *call, double atol, double rtol, int max_iterations) {
    SPARI_REQUIRE(session, isfinite(atol) && isfinite(rtol) && atol >= 0 && rtol >= 0, SPAR_ERR_ARGUMENT,
                  "%s: tolerances %g and %g; give finite numbers >= 0", call, atol, rtol);
    SPARI_REQUIRE(session, max_iterations >= 1, SPAR_ERR_ARGUMENT, "%s: %d iterations; give at least 1", call,
                  max_iterations);
    return SPAR_OK;
}

int spar_session_set_newton(spar_session *session, double atol, double rtol, int max_iterations) {
    SPARI_QUIET;
    SPARI_TRY(settable(session, __func__));
    SPARI_TRY(check_limits(session, __func__, atol, rtol, max_iterations));
    session->newton_atol = atol;
    session->newton_rtol = rtol;
    session->newton_max = max_iterations;
    return SPAR_OK;
}

int spar_session_set_predictor(spar_session *session, int order) {
    SPARI_QUIET;
    SPARI_TRY(settable(session, __func__));
    SPARI_REQUIRE(session, order >= 0 && order <= 2, SPAR_ERR_ARGUMENT, "%s: order %d; give 0, 1 or 2", __func__,
                  order);
    int status = SPAR_OK;
    for (spar_member *m = session->members; m && status == SPAR_OK; m = m->next) {
        status = m->committed ? spari_history_keep(m->load_history, 6 * m->nodes, order) : SPAR_OK;
    }
    for (spar_fluid *f = session->fluids; f && status == SPAR_OK; f = spari_fluid_next(f)) {
        status = spari_fluid_keep(f, order);
    }
    SPARI_REQUIRE(session, status == SPAR_OK, status, "%s: no memory for the loads of order %d", __func__, order);
    session->predictor = order;
    session->past = session->past < order ? session->past : order;
    return SPAR_OK;
}

int spar_session_set_coupling(spar_session *session, int scheme, double atol, double rtol, int max_iterations) {
    SPARI_QUIET;
    SPARI_TRY(settable(session, __func__));
    SPARI_REQUIRE(session, scheme >= SPAR_COUPLING_EXPLICIT && scheme <= SPAR_COUPLING_IQN_ILS, SPAR_ERR_ARGUMENT,
                  "%s: there is no scheme %d; see SPAR_COUPLING_*", __func__, scheme);
    SPARI_TRY(check_limits(session, __func__, atol, rtol, max_iterations));
    session->scheme = scheme;
    session->coupling_atol = atol;
    session->coupling_rtol = rtol;
    session->coupling_max = max_iterations;
    session->coupling_stale = 1;
    return SPAR_OK;
}

int spar_session_set_relaxation(spar_session *session, double omega) {
    SPARI_QUIET;
    SPARI_TRY(settable(session, __func__));
    SPARI_REQUIRE(session, omega > 0 && omega <= 2, SPAR_ERR_ARGUMENT, "%s: omega is %g; give a number in (0, 2]",
                  __func__, omega);
    session->relaxation = omega;
    session->coupling_stale = 1;
    return SPAR_OK;
}

int spar_session_set_reproducible(spar_session *session, int on) {
    SPARI_TRY(settable(session, __func__));
    SPARI_REQUIRE(session, !on || spari_comm_size(session->comm) == 1, SPAR_ERR_UNSUPPORTED,
                  "%s: sums over several ranks are not yet independent of how nodes are spread over them", __func__);
    return SPAR_OK;
}

/* The long tail: words that set one number. */
typedef struct option {
    const char *key, *value;
    size_t field;
    int to;
} option;

static const option options[] = {
    {"coupling.unconverged", "error", offsetof(spar_session, accept_unconverged), 0},
    {"coupling.unconverged", "accept", offsetof(spar_session, accept_unconverged), 1},
    {"fluid.theta", "average", offsetof(spar_session, theta_on_group), 0},
    {"fluid.theta", "group", offsetof(spar_session, theta_on_group), 1},
    {"fluid.far", "take", offsetof(spar_session, far_refuse), 0},
    {"fluid.far", "refuse", offsetof(spar_session, far_refuse), 1},
    {"advise.dt", "vary", offsetof(spar_session, keep_dt), 0},
    {"advise.dt", "keep", offsetof(spar_session, keep_dt), 1},
    {"advise.nodes", "vary", offsetof(spar_session, keep_nodes), 0},
    {"advise.nodes", "keep", offsetof(spar_session, keep_nodes), 1},
    {"advise.fidelity", "vary", offsetof(spar_session, keep_fidelity), 0},
    {"advise.fidelity", "keep", offsetof(spar_session, keep_fidelity), 1},
    {"advise.coupling", "vary", offsetof(spar_session, keep_coupling), 0},
    {"advise.coupling", "keep", offsetof(spar_session, keep_coupling), 1},
    {"fluid.audit", "on", offsetof(spar_session, audit_off), 0},
    {"fluid.audit", "off", offsetof(spar_session, audit_off), 1},
};

/* Numbers, with the range they may have. */
typedef struct number_option {
    const char *key;
    size_t field;
    int whole; /* an int, else a double */
    double least, most;
    const char *range;
} number_option;

static const number_option number_options[] = {
    {"coupling.columns", offsetof(spar_session, coupling_columns), 1, 1, 10000, "a whole number from 1 to 10000"},
    {"coupling.reuse", offsetof(spar_session, coupling_reuse), 1, 0, 10000, "a whole number from 0 to 10000"},
    {"coupling.filter", offsetof(spar_session, coupling_filter), 0, 0, 0.5, "a number from 0 to 0.5"},
    {"coupling.target", offsetof(spar_session, coupling_target), 0, 1e-15, 1, "a number from 1e-15 to 1"},
    {"advise.horizon", offsetof(spar_session, horizon), 0, 0, 1e300, "a number >= 0 (seconds)"},
    {"advise.fluid_cost", offsetof(spar_session, fluid_cost), 0, 0, 1e300, "a number >= 0 (seconds)"},
    {"coupling.motion_atol", offsetof(spar_session, motion_atol), 0, 0, 1e300, "a number >= 0 (metres)"},
    {"coupling.motion_rtol", offsetof(spar_session, motion_rtol), 0, 0, 1, "a number from 0 to 1"},
};

static int set_number(spar_session *session, const number_option *o, const char *value) {
    char *end;
    double x = strtod(value, &end);
    SPARI_REQUIRE(
        session, end != value && *end == '\0' && x >= o->least && x <= o->most && (!o->whole || x == floor(x)),
        SPAR_ERR_ARGUMENT, "spar_session_set_option: option '%s' cannot be '%s'; give %s", o->key, value, o->range);
    char *field = (char *)session + o->field;
    if (o->whole) {
        *(int *)(void *)field = (int)x;
    } else {
        *(double *)(void *)field = x;
    }
    return SPAR_OK;
}

int spar_session_set_option(spar_session *session, const char *key, const char *value) {
    SPARI_QUIET;
    SPARI_TRY(settable(session, __func__));
    SPARI_REQUIRE(session, key && value, SPAR_ERR_ARGUMENT, "%s: key or value is NULL", __func__);
    int known = 0;
    for (size_t i = 0; i < sizeof options / sizeof *options; i++) {
        if (strcmp(options[i].key, key) == 0) {
            known = 1;
            if (strcmp(options[i].value, value) == 0) {
                *(int *)(void *)((char *)session + options[i].field) = options[i].to;
                return SPAR_OK;
            }
        }
    }
    for (size_t i = 0; i < sizeof number_options / sizeof *number_options; i++) {
        if (strcmp(number_options[i].key, key) == 0) {
            SPARI_TRY(set_number(session, number_options + i, value));
            session->coupling_stale = 1;
            return SPAR_OK;
        }
    }
    SPARI_REQUIRE(session, known, SPAR_ERR_ARGUMENT, "%s: there is no option '%s'; spar.h lists them", __func__, key);
    return spari_fail(session, SPAR_ERR_ARGUMENT, "%s: option '%s' cannot be '%s'; spar.h lists its values", __func__,
                      key, value);
}
