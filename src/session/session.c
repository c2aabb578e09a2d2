#include "session.h"
#include "../base/quiet.h"

#include "../math/predictor.h"
#include "../member/body.h"
#include "../member/edge.h"
#include "../member/rung.h"
#include "../solve/solver.h"
#include "trial.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- create and destroy ---- */

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
    {"numbers of members", offsetof(spar_session, member_count), 1},
    /* what a setter has done, though the setting is as it was */
    {"calls that set the coupling", offsetof(spar_session, coupling_stale), 1},
    {"calls of spar_session_set_predictor", offsetof(spar_session, past), 1},
};
/* Default tolerances of Newton: what turning the axes or another number of ranks must not change (1e-11) stays below.
 */
static const double default_atol = 1e-15, default_rtol = 1e-12;

static spar_session *session_new(void) {
    struct whole {
        spar_session scene;
        spari_own own;
    } *whole = spari_zalloc(1, sizeof *whole);
    if (!whole) {
        return NULL;
    }
    spar_session *s = &whole->scene; /* comes first: freed as one */
    s->own = &whole->own;
    s->settings = settings;
    s->setting_count = sizeof settings / sizeof *settings;
    spari_gsl_quiet();
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
    return s;
}

int spar_session_create(spar_session **session) {
    SPARI_REQUIRE(NULL, session, SPAR_ERR_ARGUMENT, "spar_session_create: no place for the new session (NULL)");
    spar_session *s = session_new();
    int status = s ? spari_comm_create_self(&s->comm) : SPAR_ERR_MEMORY;
    if (!s || status != SPAR_OK) {
        free(s);
        return spari_fail(NULL, SPAR_ERR_MEMORY, "spar_session_create: no memory for the session");
    }
    *session = s;
    return SPAR_OK;
}

/* All ranks get a session or none: what can fail on one of them is agreed on over the communicator. */
int spar_session_create_fcomm(int comm, spar_session **session) {
    const char *call = "spar_session_create_fcomm";
    char why[SPARI_MESSAGE_SIZE / 2] = "no memory for the session";
    spari_comm *ranks = NULL;
    spar_session *s = session ? session_new() : NULL;
    int status = s ? SPAR_OK : SPAR_ERR_MEMORY;
    if (!session) {
        status = SPAR_ERR_ARGUMENT;
        (void)snprintf(why, sizeof why, "no place for the new session (NULL)");
    }
    status = spari_comm_create_fortran(comm, &ranks, status, why, sizeof why);
    if (status != SPAR_OK || !s) {
        free(s);
        return spari_fail(NULL, status, "%s: %s", call, why);
    }
    s->comm = ranks;
    *session = s;
    return SPAR_OK;
}

void spar_session_destroy(spar_session **session) {
    if (!session || !*session) {
        return;
    }
    spar_session *s = *session;
    for (spar_fluid *f = s->fluids, *next; f; f = next) {
        next = spari_fluid_next(f);
        spari_fluid_free(f);
    }
    for (spar_member *m = s->members, *next; m; m = next) {
        next = m->next;
        spari_member_free(m);
    }
    spari_comm_destroy(&s->comm);
    spari_coupling_free(&s->own->coupling);
    spari_trial_forget(s);
    free(s->own->pack);
    free(s->own->first);
    free(s->own->motion);
    free(s);
    *session = NULL;
}

/* ---- settings ---- */

static int settable(spar_session *session, const char *call) {
    SPARI_REQUIRE(NULL, session, SPAR_ERR_ARGUMENT, "%s: the session is NULL; create it first", call);
    SPARI_REQUIRE(session, session->phase == SPARI_IDLE, SPAR_ERR_STATE,
                  "%s: a step is under way; change settings between steps", call);
    return SPAR_OK;
}

int spar_session_set_log(spar_session *session, spar_log log, void *context) {
    SPARI_REQUIRE(NULL, session, SPAR_ERR_ARGUMENT, "spar_session_set_log: the session is NULL; create it first");
    session->log = log;
    session->log_context = context;
    return SPAR_OK;
}

int spar_session_set_gravity(spar_session *session, const double g[3]) {
    SPARI_QUIET;
    const char *call = "spar_session_set_gravity";
    SPARI_TRY(settable(session, call));
    SPARI_REQUIRE(session, g && spari_first_nonfinite(g, 3) < 0, SPAR_ERR_ARGUMENT,
                  "%s: gravity must be three finite numbers", call);
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
    const char *call = "spar_session_set_integrator";
    SPARI_TRY(settable(session, call));
    SPARI_REQUIRE(session, rho_inf >= 0 && rho_inf <= 1, SPAR_ERR_ARGUMENT,
                  "%s: rho_inf is %g; give 0 (most damping) to 1 (none)", call, rho_inf);
    SPARI_REQUIRE(session, substeps >= 1, SPAR_ERR_ARGUMENT, "%s: %d substeps; give at least 1", call, substeps);
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
    const char *call = "spar_session_set_newton";
    SPARI_TRY(settable(session, call));
    SPARI_TRY(check_limits(session, call, atol, rtol, max_iterations));
    session->newton_atol = atol;
    session->newton_rtol = rtol;
    session->newton_max = max_iterations;
    return SPAR_OK;
}

int spar_session_set_predictor(spar_session *session, int order) {
    SPARI_QUIET;
    const char *call = "spar_session_set_predictor";
    SPARI_TRY(settable(session, call));
    SPARI_REQUIRE(session, order >= 0 && order <= 2, SPAR_ERR_ARGUMENT, "%s: order %d; give 0, 1 or 2", call, order);
    int status = SPAR_OK;
    for (spar_member *m = session->members; m && status == SPAR_OK; m = m->next) {
        status = m->committed ? spari_history_keep(m->load_history, 6 * m->nodes, order) : SPAR_OK;
    }
    for (spar_fluid *f = session->fluids; f && status == SPAR_OK; f = spari_fluid_next(f)) {
        status = spari_fluid_keep(f, order);
    }
    SPARI_REQUIRE(session, status == SPAR_OK, status, "%s: no memory for the loads of order %d", call, order);
    session->predictor = order;
    session->past = session->past < order ? session->past : order;
    return SPAR_OK;
}

int spar_session_set_coupling(spar_session *session, int scheme, double atol, double rtol, int max_iterations) {
    SPARI_QUIET;
    const char *call = "spar_session_set_coupling";
    SPARI_TRY(settable(session, call));
    SPARI_REQUIRE(session, scheme >= SPAR_COUPLING_EXPLICIT && scheme <= SPAR_COUPLING_IQN_ILS, SPAR_ERR_ARGUMENT,
                  "%s: there is no scheme %d; see SPAR_COUPLING_*", call, scheme);
    SPARI_TRY(check_limits(session, call, atol, rtol, max_iterations));
    session->scheme = scheme;
    session->coupling_atol = atol;
    session->coupling_rtol = rtol;
    session->coupling_max = max_iterations;
    session->coupling_stale = 1;
    return SPAR_OK;
}

int spar_session_set_relaxation(spar_session *session, double omega) {
    SPARI_QUIET;
    const char *call = "spar_session_set_relaxation";
    SPARI_TRY(settable(session, call));
    SPARI_REQUIRE(session, omega > 0 && omega <= 2, SPAR_ERR_ARGUMENT, "%s: omega is %g; give a number in (0, 2]", call,
                  omega);
    session->relaxation = omega;
    session->coupling_stale = 1;
    return SPAR_OK;
}

int spar_session_set_reproducible(spar_session *session, int on) {
    const char *call = "spar_session_set_reproducible";
    SPARI_TRY(settable(session, call));
    SPARI_REQUIRE(session, !on || spari_comm_size(session->comm) == 1, SPAR_ERR_UNSUPPORTED,
                  "%s: sums over several ranks are not yet independent of how nodes are spread over them", call);
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
    const char *call = "spar_session_set_option";
    SPARI_TRY(settable(session, call));
    SPARI_REQUIRE(session, key && value, SPAR_ERR_ARGUMENT, "%s: key or value is NULL", call);
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
    SPARI_REQUIRE(session, known, SPAR_ERR_ARGUMENT, "%s: there is no option '%s'; spar.h lists them", call, key);
    return spari_fail(session, SPAR_ERR_ARGUMENT, "%s: option '%s' cannot be '%s'; spar.h lists its values", call, key,
                      value);
}

int spar_session_get_time(const spar_session *session, double *t, int64_t *step, int *iteration) {
    SPARI_QUIET;
    SPARI_REQUIRE(NULL, session, SPAR_ERR_ARGUMENT, "spar_session_get_time: the session is NULL; create it first");
    if (t) {
        *t = session->time;
    }
    if (step) {
        *step = session->step;
    }
    if (iteration) {
        *iteration = session->iteration;
    }
    return SPAR_OK;
}

/* ---- between the ranks ---- */

/* Of a damped member the energy dissipated in the step goes along. */
static int is_damped(const spar_member *m) {
    return (m->effects & SPAR_EFFECT_DAMPING) != 0;
}

static int64_t block_size(const spar_member *m) {
    return m->body ? 19 * (int64_t)m->body->unique + is_damped(m) : 0;
}

int spari_session_seal(spar_session *s, int status) {
    int ranks = spari_comm_size(s->comm);
    int64_t count = 0, down = ranks; /* a status of each */
    for (spar_member *m = s->members; m; m = m->next) {
        count += m->committed ? 6 * m->nodes : 0;
        down += block_size(m);
    }
    if (status == SPAR_OK &&
        (!s->own->pack || s->own->pack_count != count || (s->own->first && s->own->first[ranks] != down))) {
        free(s->own->pack);
        free(s->own->first);
        free(s->own->motion);
        s->own->pack_count = count;
        s->own->first = NULL;
        s->own->motion = NULL;
        s->own->pack = spari_zalloc(count + 1, sizeof *s->own->pack);
        int ok = s->own->pack != NULL;
        if (ok && ranks > 1) {
            s->own->first = spari_zalloc(ranks + 1, sizeof *s->own->first);
            ok = s->own->first != NULL;
            for (int r = 0; r < ranks && ok; r++) {
                s->own->first[r + 1] = s->own->first[r] + 1; /* the status */
                for (const spar_member *m = s->members; m; m = m->next) {
                    s->own->first[r + 1] += m->owner == r ? block_size(m) : 0;
                }
            }
            ok = ok && (s->own->motion = spari_zalloc(s->own->first[ranks], sizeof *s->own->motion));
        }
        if (!ok) {
            free(s->own->pack);
            s->own->pack = NULL;
            status = spari_fail(s, SPAR_ERR_MEMORY, "no memory for what the ranks exchange");
        }
    }
    return spari_comm_agree(s->comm, status, s->message, sizeof s->message);
}

int spari_session_pushes(spar_session *s, const char *call) {
    const char *why;
    for (const spar_fluid *f = s->fluids; f; f = spari_fluid_next(f)) {
        int status = spari_fluid_refused(f, &why);
        SPARI_REQUIRE(s, status == SPAR_OK, status, "%s: a push was refused, push again (%.800s)", call, why);
    }
    return SPAR_OK;
}

int spari_session_exchange_loads(spar_session *s) {
    memset(s->own->pack, 0, (size_t)(s->own->pack_count + 1) * sizeof *s->own->pack);
    int64_t at = 0;
    for (spar_member *m = s->members; m; m = m->next) {
        m->pack_at = at;
        at += m->committed ? 6 * m->nodes : 0;
    }
    for (const spar_fluid *f = s->fluids; f; f = spari_fluid_next(f)) {
        if (spari_fluid_member(f)->committed) {
            spari_fluid_add_loads(f, s->own->pack + spari_fluid_member(f)->pack_at);
        }
    }
    return spari_comm_sum(s->comm, s->own->pack, s->own->pack_count, SPAR_OK, s->message, sizeof s->message);
}

void spari_session_take_loads(const spar_session *s, const spar_member *m, double *load) {
    memcpy(load, s->own->pack + m->pack_at, (size_t)(6 * m->nodes) * sizeof *load);
}

/* One member's block: unknowns' q, v, a; dissipation. */
static void pack_member(spar_member *m, double *to) {
    int64_t n = m->body->unique;
    spari_member_to_unique(m, 7, m->after.q, to);
    spari_member_to_unique(m, 6, m->after.v, to + 7 * n);
    spari_member_to_unique(m, 6, m->after.a, to + 13 * n);
    if (is_damped(m)) {
        to[19 * n] = m->dissipated_step;
    }
}

static void unpack_member(spar_member *m, const double *from) {
    int64_t n = m->body->unique;
    spari_member_from_unique(m, 7, from, m->after.q);
    spari_member_from_unique(m, 6, from + 7 * n, m->after.v);
    spari_member_from_unique(m, 6, from + 13 * n, m->after.a);
    m->dissipated_step = is_damped(m) ? from[19 * n] : 0;
}

int spari_session_share_motion(spar_session *s, int status) {
    int ranks = spari_comm_size(s->comm), rank = spari_comm_rank(s->comm);
    if (ranks == 1) {
        return status;
    }
    double *at = s->own->motion + s->own->first[rank];
    for (spar_member *m = s->members; m && status == SPAR_OK; m = m->next) {
        if (m->owner == rank && m->body) {
            pack_member(m, at);
            at += block_size(m);
        }
    }
    SPARI_TRY(spari_comm_share(s->comm, s->own->motion, s->own->first, status, s->message, sizeof s->message));
    for (int r = 0; r < ranks; r++) {
        at = s->own->motion + s->own->first[r];
        for (spar_member *m = s->members; m; m = m->next) {
            if (m->owner == r && m->body) {
                if (r != rank) {
                    unpack_member(m, at);
                }
                at += block_size(m);
            }
        }
    }
    return SPAR_OK;
}

int spar_member_solve_static(spar_member *member, int load_steps) {
    SPARI_QUIET;
    const char *call = "spar_member_solve_static";
    SPARI_REQUIRE(NULL, member, SPAR_ERR_ARGUMENT, "%s: the member is NULL; create it first", call);
    spar_session *s = member->session;
    int status = SPAR_OK;
    if (!member->committed) {
        status = spari_fail(s, SPAR_ERR_STATE, "%s: member '%s' is not committed; call spar_member_commit first", call,
                            member->name);
    } else if (s->phase != SPARI_IDLE) {
        status = spari_fail(s, SPAR_ERR_STATE, "%s: '%s': a step is under way; accept or reject it first", call,
                            member->name);
    } else if (load_steps < 1) {
        status = spari_fail(s, SPAR_ERR_ARGUMENT, "%s: '%s': %d load steps; give at least 1", call, member->name,
                            load_steps);
    } else if (!member->body && !member->rung) {
        status = spari_fail(s, SPAR_ERR_UNSUPPORTED, "%s: spar does not solve for '%s' (a point, or external)", call,
                            member->name);
    } else if (member->root == SPAR_ROOT_FREE ||
               (member->root == SPAR_ROOT_PINNED && member->body && !member->body->C)) {
        status =
            spari_fail(s, SPAR_ERR_STATE, "%s: nothing holds '%s'; fix, pin or drive its root", call, member->name);
    }
    if (status == SPAR_OK && !s->started) {
        status = spari_session_pushes(s, call);
    }
    const spari_alike alike[] = {spari_whole("load_steps", load_steps)};
    SPARI_TRY(spari_member_enter(member, call, alike, 1, status));
    SPARI_TRY(spari_session_seal(s, SPAR_OK));
    memcpy(member->load_before, member->load_pushed, (size_t)(6 * member->nodes) * sizeof(double));
    if (!s->started) {
        SPARI_TRY(spari_session_exchange_loads(s));
        spari_session_take_loads(s, member, member->load_pushed);
    }
    if (member->rung) {
        status = spari_rung_static(member);
    } else if (member->solver) {
        status = spari_solver_static(member, load_steps);
    }
    status = spari_session_share_motion(s, status);
    if (status != SPAR_OK) {
        memcpy(member->load_pushed, member->load_before, (size_t)(6 * member->nodes) * sizeof(double));
        return status;
    }
    member->dissipated_step = 0;
    spari_member_solved(member, member->load_pushed);
    spari_member_settle(member);
    return SPAR_OK;
}
