/* Settings of a session: one table, used by setters, getters, options, the comparison of ranks and saved files. A
   new setting is a field of the session, a row here, and the code that uses it. */
#include "settings.h"

#include "../base/environment.h"
#include "../coupling/schemes.h"
#include "../fluid/fluid.h"
#include "../math/predictor.h"
#include "../member/mean_acceleration.h"
#include "../member/structure.h"
#include "../solve/life.h"
#include "callbacks.h"

#include <assert.h>
#include <float.h>
#include <string.h>

/* Setter calls beside spar_session_set_option. */
enum { NOBODY, GRAVITY, INTEGRATOR, NEWTON, PREDICTOR, COUPLING, RELAXATION, REPRODUCIBLE, TOLERANCE, OPTION };

/* Rows with field, range, default and flags. REAL, WHOLE, ALONG: arguments of a setter, in order. OPTION_*: an option
   that is a number, or one of two words for 0 and 1. STATE: state of the session that is compared across ranks. */
#define FIELD(field) offsetof(spar_session, field)
#define REAL(by, setter, key, field, least, most, range, initial, flags)                                               \
    {                                                                                                                  \
        key " of spar_session_set_" setter, key, FIELD(field), SPARI_IS_REAL, by, least, most, range, {NULL, NULL},    \
            initial, flags                                                                                             \
    }
#define ALONG(key, axis)                                                                                               \
    {                                                                                                                  \
        key, key, FIELD(gravity) + (axis) * sizeof(double), SPARI_IS_REAL, GRAVITY, -DBL_MAX, DBL_MAX,                 \
            "a finite number", {NULL, NULL}, 0, SPARI_AGREED                                                           \
    }
#define WHOLE(by, setter, key, field, least, most, range, initial, flags)                                              \
    {                                                                                                                  \
        key " of spar_session_set_" setter, key, FIELD(field), SPARI_IS_WHOLE, by, least, most, range, {NULL, NULL},   \
            initial, flags                                                                                             \
    }
#define OPTION_REAL(key, field, least, most, range, initial, flags)                                                    \
    { "option " key, key, FIELD(field), SPARI_IS_REAL, OPTION, least, most, range, {NULL, NULL}, initial, flags }
#define OPTION_WHOLE(key, field, least, most, range, initial, flags)                                                   \
    { "option " key, key, FIELD(field), SPARI_IS_WHOLE, OPTION, least, most, range, {NULL, NULL}, initial, flags }
#define OPTION_WORD(key, field, zero, one, flags)                                                                      \
    {                                                                                                                  \
        "option " key " (1: " one ")", key, FIELD(field), SPARI_IS_WORD, OPTION, 0, 1, zero " or " one, {zero, one},   \
            0, flags                                                                                                   \
    }
#define STATE(name, field)                                                                                             \
    { name, NULL, FIELD(field), SPARI_IS_WHOLE, NOBODY, 0, 0, NULL, {NULL, NULL}, 0, SPARI_AGREED }

static const char not_negative[] = "a finite number >= 0", one_or_more[] = "at least 1";

static const spari_setting settings[] = {
    ALONG("gravity (x)", 0),
    ALONG("gravity (y)", 1),
    ALONG("gravity (z)", 2),
    REAL(INTEGRATOR, "integrator", "rho_inf", integrator.rho_inf, 0, 1, "0 (most damping) to 1 (none)", 0.9,
         SPARI_AGREED),
    WHOLE(INTEGRATOR, "integrator", "substeps", integrator.substeps, 1, INT32_MAX, one_or_more, 1,
          SPARI_AGREED | SPARI_VARIED),
    REAL(NEWTON, "newton", "atol", newton.atol, 0, DBL_MAX, not_negative, 1e-15, SPARI_AGREED),
    REAL(NEWTON, "newton", "rtol", newton.rtol, 0, DBL_MAX, not_negative, 1e-8, SPARI_AGREED | SPARI_VARIED),
    WHOLE(NEWTON, "newton", "max_iterations", newton.max, 1, INT32_MAX, one_or_more, 50, SPARI_AGREED),
    /* A hundred times what a step of many coupling iterations takes, and eight times the most of a step in all tests
       (12 879, tests/stability/random_coupling). */
    OPTION_WHOLE("newton.budget", newton.budget, 1, 1000000000, "a whole number from 1 to 1000000000", 100000,
                 SPARI_AGREED),
    WHOLE(PREDICTOR, "predictor", "order", coupling.predictor, 0, 2, "0, 1 or 2", 1, SPARI_AGREED | SPARI_VARIED),
    WHOLE(COUPLING, "coupling", "scheme", coupling.scheme, 0, SPARI_SCHEME_COUNT - 1, "a SPAR_COUPLING_*",
          SPAR_COUPLING_IQN_ILS, SPARI_AGREED | SPARI_OF_COUPLING | SPARI_VARIED),
    REAL(COUPLING, "coupling", "atol", coupling.atol, 0, DBL_MAX, not_negative, 1e-9, SPARI_AGREED),
    REAL(COUPLING, "coupling", "rtol", coupling.rtol, 0, DBL_MAX, not_negative, 1e-6, SPARI_AGREED | SPARI_VARIED),
    WHOLE(COUPLING, "coupling", "max_iterations", coupling.max, 1, INT32_MAX, one_or_more, 50,
          SPARI_AGREED | SPARI_OF_COUPLING),
    REAL(RELAXATION, "relaxation", "omega", coupling.relaxation, DBL_MIN, 2, "a number in (0, 2]", 1,
         SPARI_AGREED | SPARI_OF_COUPLING),
    WHOLE(REPRODUCIBLE, "reproducible", "on", ranks.reproducible, 0, 1, "0 or 1", 0, SPARI_AGREED),
    REAL(TOLERANCE, "tolerance", "drift", tolerance.drift, 0, DBL_MAX, not_negative, 0, SPARI_AGREED),
    REAL(TOLERANCE, "tolerance", "rtol", tolerance.rtol, 0, 1, "a number from 0 to 1", 0, SPARI_AGREED),
    OPTION_WORD("coupling.unconverged", coupling.accept_unconverged, "error", "accept", SPARI_AGREED),
    OPTION_WORD("coupling.unstable", coupling.accept_unstable, "error", "accept", SPARI_AGREED),
    OPTION_WHOLE("coupling.patience", coupling.patience, 1, 1000000, "a whole number from 1 to 1000000", 3,
                 SPARI_AGREED),
    OPTION_WORD("coupling.norm", coupling.norm_of_loads, "motion", "loads", SPARI_AGREED | SPARI_OF_COUPLING),
    OPTION_WORD("coupling.estimate", coupling.estimate, "off", "on", SPARI_AGREED | SPARI_OF_COUPLING),
    OPTION_WHOLE("coupling.columns", coupling.columns, 1, 10000, "a whole number from 1 to 10000", 30,
                 SPARI_AGREED | SPARI_OF_COUPLING),
    OPTION_WHOLE("coupling.reuse", coupling.reuse, 0, 10000, "a whole number from 0 to 10000", 5,
                 SPARI_AGREED | SPARI_OF_COUPLING),
    OPTION_REAL("coupling.filter", coupling.filter, 0, 0.5, "a number from 0 to 0.5", 1e-4,
                SPARI_AGREED | SPARI_OF_COUPLING),
    OPTION_REAL("coupling.motion_atol", coupling.motion_atol, 0, 1e300, "a number >= 0 (metres)", 0,
                SPARI_AGREED | SPARI_OF_COUPLING),
    OPTION_REAL("coupling.motion_rtol", coupling.motion_rtol, 0, 1, "a number from 0 to 1", 0,
                SPARI_AGREED | SPARI_OF_COUPLING),
    STATE("numbers of members", member_count),
    STATE("numbers of joints", joint_count),
    STATE("calls that set the coupling", coupling.stale),
    STATE("calls of spar_session_set_predictor", state.past),
};
enum { SETTINGS = sizeof settings / sizeof *settings };

/* A value that is the same as before changes nothing: the coupling's memory stays. */
static void store(spar_session *s, const spari_setting *of, double x) {
    s->coupling.stale |= of->flags & SPARI_OF_COUPLING && spari_setting_value(s, of) != x;
    spari_setting_store(s, of, x);
}

void spari_settings_default(spar_session *s) {
    s->settings = settings;
    s->setting_count = SETTINGS;
    for (int i = 0; i < SETTINGS; i++) {
        if (settings[i].key) {
            store(s, settings + i, settings[i].initial);
        }
    }
}

int spari_settings_of_coupling(const spar_session *s, double *values) {
    int n = 0;
    for (int i = 0; i < SETTINGS; i++) {
        if (settings[i].flags & SPARI_OF_COUPLING) {
            values[n++] = spari_setting_value(s, settings + i);
        }
    }
    return n;
}

int spari_settings_varied(const spar_session *s, double *values) {
    int n = 0;
    for (int i = 0; i < SETTINGS; i++) {
        if (settings[i].flags & SPARI_VARIED) {
            assert(n < SPARI_MOST_VARIED);
            values[n++] = spari_setting_value(s, settings + i);
        }
    }
    return n;
}

double *spari_settings_place(double *values, size_t field) {
    int n = 0;
    for (int i = 0; settings[i].field != field; i++) {
        n += settings[i].flags & SPARI_VARIED ? 1 : 0;
    }
    return values + n;
}

void spari_settings_vary(spar_session *s, const double *values) {
    int stale = s->coupling.stale;
    for (int i = 0; i < SETTINGS; i++) {
        if (settings[i].flags & SPARI_VARIED) {
            store(s, settings + i, *values++);
        }
    }
    s->coupling.stale = stale;
}

/* ---- setters and getters ---- */

static int settable(spar_session *session, const char *call) {
    SPARI_REQUIRE(NULL, session, SPAR_ERR_ARGUMENT, "%s: the session is NULL; create it first", call);
    SPARI_REQUIRE(session, session->state.phase == SPARI_IDLE, SPAR_ERR_STATE,
                  "%s: a step is in progress; change settings between steps", call);
    return spari_callback_refuse(session, call);
}

/* Checks the arguments of a setter, in order, against their ranges. */
static int check_given(spar_session *session, const char *call, int by, const double *given) {
    SPARI_TRY(settable(session, call));
    for (int i = 0; i < SETTINGS; i++) {
        if (settings[i].by == by) {
            SPARI_REQUIRE(session, spari_setting_allows(settings + i, *given), SPAR_ERR_ARGUMENT,
                          "%s: %s is %.15g; give %s", call, settings[i].key, *given, settings[i].range);
            given++;
        }
    }
    return SPAR_OK;
}

static void store_given(spar_session *session, int by, const double *given) {
    for (int i = 0; i < SETTINGS; i++) {
        if (settings[i].by == by) {
            store(session, settings + i, *given++);
        }
    }
}

static int set(spar_session *session, const char *call, int by, const double *given) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_TRY(check_given(session, call, by, given));
    store_given(session, by, given);
    return SPAR_OK;
}

/* into[n]: double or int as in the row; may be NULL */
static int get(const spar_session *session, const char *call, int by, int n, void *const *into) {
    SPARI_REQUIRE(NULL, session, SPAR_ERR_ARGUMENT, "%s: the session is NULL; create it first", call);
    for (int i = 0, k = 0; i < SETTINGS && k < n; i++) {
        if (settings[i].by == by) {
            void *to = into[k++];
            if (to && settings[i].kind == SPARI_IS_REAL) {
                *(double *)to = spari_setting_value(session, settings + i);
            } else if (to) {
                *(int *)to = (int)spari_setting_value(session, settings + i);
            }
        }
    }
    return SPAR_OK;
}

/* clang-format off */
#define INTO(...) (int)(sizeof((void *const[]){__VA_ARGS__}) / sizeof(void *)), (void *const[]){__VA_ARGS__}
/* clang-format on */

int spar_session_set_gravity(spar_session *session, const double g[3]) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_TRY(settable(session, __func__));
    SPARI_REQUIRE(session, g, SPAR_ERR_ARGUMENT, "%s: the gravity vector is NULL", __func__);
    SPARI_TRY(set(session, __func__, GRAVITY, g));
    for (spar_member *m = session->members; m; m = m->next) {
        if (m->committed) {
            spari_member_gravity(m);
        }
    }
    return SPAR_OK;
}

int spar_session_get_gravity(const spar_session *session, double g[3]) {
    return get(session, __func__, GRAVITY, INTO(g, g ? g + 1 : NULL, g ? g + 2 : NULL));
}

int spar_session_set_integrator(spar_session *session, double rho_inf, int substeps) {
    SPARI_GUARD_ENVIRONMENT;
    const double given[] = {rho_inf, substeps};
    SPARI_TRY(check_given(session, __func__, INTEGRATOR, given));
    int status = SPAR_OK, before = session->integrator.substeps;
    session->integrator.substeps = substeps;
    for (spar_member *m = session->members; m && status == SPAR_OK; m = m->next) {
        status = m->committed ? spari_means_keep(m) : SPAR_OK;
    }
    session->integrator.substeps = before;
    SPARI_TRY(spari_named(session, __func__, status));
    store_given(session, INTEGRATOR, given);
    return SPAR_OK;
}

int spar_session_get_integrator(const spar_session *session, double *rho_inf, int *substeps) {
    return get(session, __func__, INTEGRATOR, INTO(rho_inf, substeps));
}

int spar_session_set_newton(spar_session *session, double atol, double rtol, int max_iterations) {
    return set(session, __func__, NEWTON, (const double[]){atol, rtol, max_iterations});
}

int spar_session_get_newton(const spar_session *session, double *atol, double *rtol, int *max_iterations) {
    return get(session, __func__, NEWTON, INTO(atol, rtol, max_iterations));
}

int spar_session_set_predictor(spar_session *session, int order) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_TRY(check_given(session, __func__, PREDICTOR, (const double[]){order}));
    int status = SPAR_OK;
    for (spar_member *m = session->members; m && status == SPAR_OK; m = m->next) {
        status = m->committed ? spari_history_keep(m->load.history, 6 * m->nodes, order) : SPAR_OK;
    }
    for (spar_fluid *f = session->fluids; f && status == SPAR_OK; f = spari_fluid_next(f)) {
        status = spari_fluid_keep(f, order);
    }
    SPARI_REQUIRE(session, status == SPAR_OK, status, "%s: no memory for the loads of order %d", __func__, order);
    store_given(session, PREDICTOR, (const double[]){order});
    session->state.past = session->state.past < order ? session->state.past : order;
    return SPAR_OK;
}

int spar_session_get_predictor(const spar_session *session, int *order) {
    return get(session, __func__, PREDICTOR, INTO(order));
}

int spar_session_set_coupling(spar_session *session, int scheme, double atol, double rtol, int max_iterations) {
    return set(session, __func__, COUPLING, (const double[]){scheme, atol, rtol, max_iterations});
}

int spar_session_get_coupling(const spar_session *session, int *scheme, double *atol, double *rtol,
                              int *max_iterations) {
    return get(session, __func__, COUPLING, INTO(scheme, atol, rtol, max_iterations));
}

int spar_session_set_relaxation(spar_session *session, double omega) {
    return set(session, __func__, RELAXATION, (const double[]){omega});
}

int spar_session_get_relaxation(const spar_session *session, double *omega) {
    return get(session, __func__, RELAXATION, INTO(omega));
}

int spar_session_set_reproducible(spar_session *session, int on) {
    return set(session, __func__, REPRODUCIBLE, (const double[]){on != 0});
}

int spar_session_get_reproducible(const spar_session *session, int *on) {
    return get(session, __func__, REPRODUCIBLE, INTO(on));
}

int spar_session_set_tolerance(spar_session *session, double drift, double rtol) {
    SPARI_GUARD_ENVIRONMENT;
    const double given[] = {drift, rtol};
    SPARI_TRY(check_given(session, __func__, TOLERANCE, given));
    SPARI_REQUIRE(session, drift > 0 || rtol == 0, SPAR_ERR_ARGUMENT,
                  "%s: drift is 0 and rtol is %g: at rest there is no speed for a relative tolerance; also set a "
                  "drift, in m/s, small enough to be negligible",
                  __func__, rtol);
    store_given(session, TOLERANCE, given);
    return SPAR_OK;
}

int spar_session_get_tolerance(const spar_session *session, double *drift, double *rtol) {
    return get(session, __func__, TOLERANCE, INTO(drift, rtol));
}

/* ---- options ---- */

static int session_option(const spar_session *session, const char *call, const char *key, const spari_setting **of) {
    char keys[SPARI_MESSAGE_SIZE / 2];
    *of = spari_setting_find(settings, SETTINGS, OPTION, key);
    SPARI_REQUIRE(session, *of, SPAR_ERR_ARGUMENT, "%s: there is no option '%s'; give one of %s", call, key,
                  spari_setting_keys(settings, SETTINGS, OPTION, keys, sizeof keys));
    return SPAR_OK;
}

int spar_session_set_option(spar_session *session, const char *key, const char *value) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_TRY(settable(session, __func__));
    SPARI_REQUIRE(session, key && value, SPAR_ERR_ARGUMENT, "%s: key or value is NULL", __func__);
    const spari_setting *of;
    SPARI_TRY(session_option(session, __func__, key, &of));
    double x;
    SPARI_REQUIRE(session, spari_setting_read(of, value, &x), SPAR_ERR_ARGUMENT,
                  "%s: option '%s' does not accept '%s'; give %s", __func__, key, value, of->range);
    store(session, of, x);
    return SPAR_OK;
}

int spar_session_get_option(const spar_session *session, const char *key, int64_t capacity, char *text) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_REQUIRE(NULL, session, SPAR_ERR_ARGUMENT, "%s: the session is NULL; create it first", __func__);
    SPARI_REQUIRE(session, key && text, SPAR_ERR_ARGUMENT, "%s: key or text is NULL", __func__);
    const spari_setting *of;
    SPARI_TRY(session_option(session, __func__, key, &of));
    return spari_setting_write(session, __func__, of, spari_setting_value(session, of), capacity, text);
}
