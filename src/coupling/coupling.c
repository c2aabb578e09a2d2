/* The coupling iteration of a step: computes the next loads, and tests convergence. */
#include "coupling.h"
#include "../base/environment.h"

#include "../exchange/session_private.h"
#include "../math/rotation.h"
#include "../member/added_mass.h"
#include "../member/body.h"
#include "../member/mean_acceleration.h"
#include "../member/structure.h"
#include "../time/fidelity.h"
#include "../time/scheme.h"
#include "motion_norm.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- memory ---- */

void spari_coupling_free(spari_coupling **coupling) {
    spari_coupling *c = coupling ? *coupling : NULL;
    if (!c) {
        return;
    }
    SPARI_FREE(c->length, c->unit, c->x, c->g, c->predicted, c->motion, c->residual, c->size, c->image, c->workspace,
               c->missed, c->missing, c->shift, c->settled, c->before, c->path, c->axes);
    spari_accelerator_free(&c->accelerator);
    free(c);
    *coupling = NULL;
}

int spari_coupling_wants_motion(const spar_session *s) {
    return s->coupling.motion_atol > 0 || s->coupling.motion_rtol > 0;
}

static int make_vectors(const spar_session *s, int scheme, spari_coupling *c) {
    int iterated = spari_coupling_scheme_of(scheme)->iterates;
    int64_t n = iterated ? c->n : 0;
    spari_accelerator_settings set = {
        scheme, s->coupling.relaxation, s->coupling.columns, s->coupling.reuse, s->coupling.filter, c->weighs};
    int64_t largest = 0, images = c->weighs ? 2 * n : c->estimates ? c->n : 0, shifted = 0;
    for (const spar_member *m = s->members; m; m = m->next) {
        largest = m->nodes > largest ? m->nodes : largest;
        shifted = m->added && c->weighs ? n : shifted;
    }
    int64_t nodes = c->weighs && spari_coupling_scheme_of(scheme)->columns ? n / 6 : 0;
    c->most = iterated ? s->coupling.max : 1;
    return (c->length = spari_zalloc(c->members, sizeof(double))) &&
           (c->unit = spari_zalloc(c->members, sizeof(double))) && (c->x = spari_zalloc(n, sizeof(double))) &&
           (c->g = spari_zalloc(n, sizeof(double))) && (c->predicted = spari_zalloc(n, sizeof(double))) &&
           (c->motion =
                spari_zalloc(iterated && spari_coupling_wants_motion(s) ? 7 * (c->n / 6) : 0, sizeof(double))) &&
           (c->missed = spari_zalloc(c->n, sizeof(double))) && (c->missing = spari_zalloc(c->n, sizeof(double))) &&
           (c->residual = spari_zalloc(c->most, sizeof(double))) && (c->size = spari_zalloc(c->most, sizeof(double))) &&
           (c->image = spari_zalloc(images + c->members + 1, sizeof(double))) &&
           (shifted == 0 || (c->shift = spari_zalloc(shifted, sizeof(double)))) &&
           (nodes == 0 || (c->settled = spari_zalloc(2 * n + 1, sizeof(double)))) &&
           (c->before = spari_zalloc(7 * nodes, sizeof(double))) &&
           (c->path = spari_zalloc(6 * nodes, sizeof(double))) && (c->axes = spari_zalloc(4 * nodes, sizeof(double))) &&
           (c->workspace = spari_zalloc(images > 0 ? 6 * largest : 0, sizeof(double))) &&
           (!iterated || (c->accelerator = spari_accelerator_create(n, 6, 3, &set)));
}

/* Six unknowns per node of every member. */
static int64_t count_unknowns(const spar_session *s) {
    int64_t n = 0;
    for (const spar_member *m = s->members; m; m = m->next) {
        n += 6 * m->nodes;
    }
    return n;
}

int spari_coupling_fits(const spar_session *s) {
    const spari_coupling *c = s->own->coupling;
    return c && !s->coupling.stale && c->members == s->member_count && c->n == count_unknowns(s);
}

int spari_coupling_create(spar_session *s, int scheme, int static_solution, spari_coupling **coupling) {
    spari_coupling *c = spari_zalloc(1, sizeof *c);
    if (c) {
        c->n = count_unknowns(s);
        c->members = s->member_count;
        int iterates = spari_coupling_scheme_of(scheme)->iterates;
        c->estimates = !static_solution && !iterates && s->coupling.estimate;
        c->weighs = !static_solution && iterates && spari_motion_norm_is_used(s);
    }
    if (!c || !make_vectors(s, scheme, c)) {
        spari_coupling_free(&c);
        return spari_fail(s, SPAR_ERR_MEMORY,
                          "no memory for the coupling; request fewer columns (option coupling.columns)");
    }
    int k = 0;
    for (const spar_member *m = s->members; m; m = m->next, k++) {
        int exponent;
        c->length[k] = spari_member_length(m);
        (void)frexp(1 / c->length[k], &exponent);
        c->unit[k] = ldexp(1, exponent);
    }
    double *weight = c->settled ? spari_accelerator_weights(c->accelerator) : NULL;
    k = 0;
    for (const spar_member *m = s->members; m && weight; m = m->next, k++) {
        for (int64_t i = 0; i < 6 * m->nodes; i++, weight++) {
            *weight = i % 6 < 3 ? 1 : 0.5 * c->unit[k] * c->length[k];
        }
    }
    *coupling = c;
    return SPAR_OK;
}

int spari_coupling_prepare(spar_session *s) {
    spari_coupling *c;
    SPARI_TRY(spari_coupling_create(s, s->coupling.scheme, 0, &c));
    if (s->own->coupling) {
        c->report[SPAR_REPORT_UNCONVERGED] = s->own->coupling->report[SPAR_REPORT_UNCONVERGED];
        c->in_row = s->own->coupling->in_row;
    }
    spari_coupling_free(&s->own->coupling);
    s->own->coupling = c;
    return SPAR_OK;
}

/* ---- the stacked vector ---- */

static void stack(const spar_session *s) {
    const spari_coupling *c = s->own->coupling;
    int64_t at = 0;
    int k = 0;
    for (const spar_member *m = s->members; m; m = m->next, k++) {
        for (int64_t i = 0; i < 6 * m->nodes; i++, at++) {
            double unit = i % 6 < 3 ? 1 : c->unit[k];
            c->x[at] = unit * m->load.used[i];
            c->g[at] = unit * m->load.pushed[i];
            if (c->shift) {
                c->shift[at] = m->added ? unit * m->added->shift[i] : 0;
            }
        }
    }
}

static void unstack(const spar_session *s) {
    const spari_coupling *c = s->own->coupling;
    int64_t at = 0;
    int k = 0;
    for (spar_member *m = s->members; m; m = m->next, k++) {
        for (int64_t i = 0; i < 6 * m->nodes; i++, at++) {
            m->load.used[i] = c->x[at] / (i % 6 < 3 ? 1 : c->unit[k]);
        }
    }
}

/* Root sum of squares of the change from `from` (stacked by member; NULL: load.used) to the loads that came back,
   and of these loads, [N]. */
static void load_norms(const spar_session *s, const double *from, double *change, double *size) {
    double r2 = 0, f2 = 0;
    int k = 0;
    for (const spar_member *m = s->members; m; m = m->next, k++) {
        const double *used = from ? from : m->load.used;
        double per_length = 1 / s->own->coupling->length[k];
        const double *shift = spari_added_shift(m);
        for (int64_t i = 0; i < 6 * m->nodes; i++) {
            double w = i % 6 < 3 ? 1 : per_length, f = w * m->load.pushed[i], r = f - w * used[i];
            f -= shift ? w * shift[i] : 0;
            r2 += r * r;
            f2 += f * f;
        }
        from = from ? from + 6 * m->nodes : NULL;
    }
    *change = sqrt(r2);
    *size = sqrt(f2);
}

/* Displacement and rotation of a node between two motions. */
static void travel(const double *from, const double *to, double d[6]) {
    double p[4];
    for (int k = 0; k < 3; k++) {
        d[k] = to[k] - from[k];
    }
    spari_quat_between(from + 3, to + 3, p);
    spari_quat_log(p, d + 3);
}

/* Displacement of the nodes since the iteration before, and since t^n, [m]; rotations are multiplied by the length. */
static void motion_norms(const spar_session *s) {
    spari_coupling *c = s->own->coupling;
    double r2 = 0, d2 = 0, d[6], *last = c->motion;
    int k = 0;
    for (const spar_member *m = s->members; m; m = m->next, k++) {
        for (int64_t i = 0; i < m->nodes; i++, last += 7) {
            double l2 = c->length[k] * c->length[k];
            travel(m->now.q + 7 * i, m->after.q + 7 * i, d);
            d2 += spari_dot(d, d) + l2 * spari_dot(d + 3, d + 3);
            if (c->iterations > 0) {
                travel(last, m->after.q + 7 * i, d);
                r2 += spari_dot(d, d) + l2 * spari_dot(d + 3, d + 3);
            }
            memcpy(last, m->after.q + 7 * i, 7 * sizeof *last);
        }
    }
    c->moved = c->iterations > 0 ? sqrt(r2) : INFINITY;
    c->travelled = sqrt(d2);
}

/* ---- the step ---- */

static void report_added_mass(spari_coupling *c) {
    (void)spari_accelerator_added_mass(c->accelerator, c->report + SPAR_REPORT_ADDED_MASS,
                                       c->report + SPAR_REPORT_ADDED_MASS_SPREAD);
}

/* What the motion of a secant is in this step. In a step of TR-BDF2 velocities are no multiples of displacements, and
   it is velocities and accelerations that a fluid answers. */
static spari_response_of motion_of(const spar_session *s) {
    return spari_steps_even(&s->clock, s->clock.dt) || s->integrator.substeps > 1 ? SPARI_OF_DISPLACEMENT
                                                                                  : SPARI_OF_VELOCITY;
}

/* How large velocities and accelerations are, as fluids see them, with a motion of 1. */
static void set_rates(const spar_session *s) {
    const double dt = s->clock.dt;
    const spar_member *m = s->members;
    while (m && !(m->effects & SPAR_EFFECT_INERTIA)) {
        m = m->next;
    }
    if (m) {
        const spari_scheme alpha = spari_scheme_of(m, 0, dt / s->integrator.substeps);
        double rate = motion_of(s) == SPARI_OF_VELOCITY ? 1 / (SPARI_DIAGONAL * dt) : alpha.rate,
               mean = spari_means_rate(s);
        spari_accelerator_set_rates(s->own->coupling->accelerator, rate, mean > 0 ? mean : alpha.cm / alpha.rate);
    }
}

void spari_coupling_begin(spar_session *s) {
    spari_coupling *c = s->own->coupling;
    c->iterations = 0;
    c->report[SPAR_REPORT_CONTRACTION] = c->report[SPAR_REPORT_COLUMNS] = c->report[SPAR_REPORT_DROPPED] = 0;
    c->report[SPAR_REPORT_MOTION_ERROR] = 0;
    if (c->accelerator) {
        double *at = c->predicted;
        c->idle = 1;
        for (const spar_member *m = s->members; m; m = m->next) {
            for (int64_t i = 0; i < 6 * m->nodes; i++, at++) {
                *at = m->load.used[i];
                c->idle = c->idle && *at == 0;
            }
        }
        spari_accelerator_begin(c->accelerator, s->clock.dt);
        set_rates(s);
        report_added_mass(c);
    }
}

static void record(spari_coupling *c, double residual, double size) {
    int last =
        c->iterations < c->most ? c->iterations : c->most - 1; /* a host may call check again after convergence */
    c->residual[last] = residual;
    c->size[last] = size;
    c->iterations = last + 1;
    if (last > 0 && c->residual[0] > 0) {
        c->report[SPAR_REPORT_CONTRACTION] = pow(residual / c->residual[0], 1.0 / last);
    }
}

/* Residual and size of the last iteration. */
static void last_iteration(const spar_session *s, double *residual, double *size) {
    const spari_coupling *c = s->own->coupling;
    int last = c->iterations - 1;
    *residual = last >= 0 ? c->residual[last] : 0;
    *size = last >= 0 ? c->size[last] : 0;
}

int spari_coupling_is_rough(const spar_session *s) {
    double residual, size;
    last_iteration(s, &residual, &size);
    return s->state.iteration > 0 && residual > 0.1 * size;
}

int spari_coupling_renews_tangents(const spar_session *s) {
    const spari_coupling *c = s->own->coupling;
    return c->accelerator && spari_accelerator_renews(c->accelerator);
}

/* Growth factor of the residual in the last iterations; 0: it has not grown. */
static double grown_lately(const spari_coupling *c) {
    enum { LATELY = 3 };
    int last = c->iterations - 1, first = last > LATELY ? last - LATELY : 0;
    double factor =
        last > first && c->residual[first] > 0 ? pow(c->residual[last] / c->residual[first], 1.0 / (last - first)) : 0;
    return factor > 1.2 ? factor : 0;
}

/* The smallest residual of the iterations from `from` to before `to`. */
static double least_residual(const spari_coupling *c, int from, int to) {
    double least = INFINITY;
    for (int i = from; i < to; i++) {
        least = fmin(least, c->residual[i]);
    }
    return least;
}

/* The level at which the residual stays, relative to the loads; 0: it does not stay. The second half of many iterations
   has not come below the first, nor is it spread over more than two orders. */
static double flat_level(const spari_coupling *c) {
    enum { MANY = 20 };
    const int n = c->iterations, half = n / 2;
    double least = least_residual(c, half, n), most = 0;
    for (int i = half; i < n; i++) {
        most = fmax(most, c->residual[i]);
    }
    const int flat = n >= MANY && least > 0.5 * least_residual(c, 0, half) && most < 100 * least;
    return flat && c->size[n - 1] > 0 ? least / c->size[n - 1] : 0;
}

/* Remedies, beginning with those that are not in use. diverges: the changes grow; stays: they do not fall. */
static const char *cures_of(const spar_session *s, int diverges, int stays) {
    int newton = spari_coupling_scheme_of(s->coupling.scheme)->columns;
    if (s->state.static_solution) {
        return newton ? "use a larger tolerance or more iterations, or check the fluid's loads"
                      : "use SPAR_COUPLING_IQN_ILS, a larger tolerance or more iterations";
    }
    if (stays && newton) {
        return "use a larger rtol, more pressure corrections per fluid solution or a smaller dt, or reject the step";
    }
    if (!diverges) {
        return newton ? "use more iterations or a smaller dt, or reject the step"
                      : "use SPAR_COUPLING_IQN_ILS, a smaller relaxation or dt, or reject the step";
    }
    return newton ? "give the fluid's added mass or a tenth of it (spar_member_set_added_mass), use a smaller dt, "
                    "SPAR_COUPLING_AITKEN or more pressure corrections per fluid solution, or reject the step"
                  : "use SPAR_COUPLING_IQN_ILS, a smaller relaxation or dt, or more pressure corrections per fluid "
                    "solution, or reject the step";
}

/* The cause in a message, without the call before it and the remedy after it. */
static void cause_of(const char *message, const char *call, char *cause, size_t size) {
    size_t name = strlen(call);
    const char *from = strncmp(message, call, name) == 0 && message[name] == ':' ? message + name + 2 : message;
    (void)snprintf(cause, size, "%.*s", (int)size - 1, from);
    char *end = strrchr(cause, ';');
    if (end) {
        *end = '\0';
    }
}

/* Largest force or moment of nodal loads. */
static double largest_load(const spar_member *m, const double *load) {
    double most = 0;
    for (int64_t i = 0; load && i < 6 * m->nodes; i++) {
        most = fmax(most, fabs(load[i]));
    }
    return most;
}

/* A larger growth of the loads cannot be a response to the structure's motion. A solution that fails after so much
   growth within a step has the coupling as its cause. */
static const double TOO_MUCH = 1e6, MUCH_GROWN = 10;

/* Member whose loads in use, or pushed, have grown most since the steps before, and the two values; NULL: none beyond
   the limit. */
static const spar_member *member_overwhelmed(const spar_session *s, int pushed, double load[2]) {
    const spar_member *worst = NULL;
    double most = TOO_MUCH;
    for (const spar_member *m = s->members; m; m = m->next) {
        double now = largest_load(m, pushed ? m->load.pushed : m->load.used), before = INFINITY;
        for (int k = 0; k < 3; k++) {
            double of = largest_load(m, m->load.history[k]);
            before = of > 0 ? fmin(before, of) : before;
        }
        if (now > most * before) {
            most = now / before;
            worst = m;
            load[0] = before, load[1] = now;
        }
    }
    return worst;
}

int spari_coupling_solve_failed(spar_session *s, const char *call, int status) {
    const spari_coupling *c = s->own->coupling;
    double factor = c->iterations == s->state.iteration ? grown_lately(c) : 0, load[2];
    char why[SPARI_MESSAGE_SIZE / 2];
    if (status != SPAR_ERR_NUMERIC) {
        return status;
    }
    cause_of(s->message, call, why, sizeof why);
    const spar_member *m = factor > 0 && factor < TOO_MUCH ? NULL : member_overwhelmed(s, 0, load);
    SPARI_REQUIRE(s, !m, status,
                  "%s: the fluid's loads on member '%s' have grown from %.3g to %.3g (N, N m) within a few steps; "
                  "check the fluid for a folded mesh or divergence (%.400s)",
                  call, m->name, load[0], load[1], why);
    SPARI_REQUIRE(s, factor == 0, status,
                  "%s: the coupling diverges: the change of the loads has grown by a factor of %.3g from iteration to "
                  "iteration, to %.3g N in iteration %d; %s (%.400s)",
                  call, factor, c->residual[c->iterations - 1], s->state.iteration, cures_of(s, 1, 0), why);
    const int last = c->iterations - 1;
    double least = c->iterations == s->state.iteration && last > 0 ? least_residual(c, 0, last) : INFINITY;
    SPARI_REQUIRE(
        s, last <= 0 || !(c->residual[last] > MUCH_GROWN * least), status,
        "%s: the coupling diverges: the change of the loads has grown from %.3g N to %.3g N in iteration %d; %s "
        "(%.400s)",
        call, least, c->residual[last], s->state.iteration, cures_of(s, 1, 0), why);
    return status;
}

/* Rounding error of positions divided by dt^2, relative to the largest acceleration: of all members, for one that all
   but rests has no other accelerations than rounding. */
static double rounding_of_accelerations(const spar_session *s) {
    const double h = s->clock.dt / s->integrator.substeps;
    double place = 0, most = 0;
    for (const spar_member *m = s->members; m; m = m->next) {
        for (int64_t i = 0; i < m->nodes && m->body && m->effects & SPAR_EFFECT_INERTIA; i++) {
            for (int k = 0; k < 3; k++) {
                place = fmax(place, fabs(m->xr[3 * i + k] + m->after.q[7 * i + k]));
                most = fmax(most, fabs(m->after.a[6 * i + k]));
            }
        }
    }
    return most > 0 ? DBL_EPSILON * place / (h * h * most) : 0;
}

/* Error of the correction for added mass, [N], by rounding and by what Newton leaves in the accelerations: loads cannot
   agree any better, and may be smaller than this. The latter is taken as a thousandth of the tolerance, of the
   correction: nothing beside the tolerance of loads that are not a thousand times smaller. A fluid that pushes nothing
   has no other load, and without this its steps do not end (tests/member/test_added_mass.c, no_loads_on_a_bent_beam).
 */
static const double correction_part = 1e-3; /* of the tolerance */

static double error_of_added_mass(const spar_session *s) {
    double f2 = 0;
    int k = 0;
    for (const spar_member *m = s->members; m; m = m->next, k++) {
        const double *shift = spari_added_shift(m);
        for (int64_t i = 0; i < 6 * m->nodes && shift; i++) {
            double f = (i % 6 < 3 ? 1 : 1 / s->own->coupling->length[k]) * shift[i];
            f2 += f * f;
        }
    }
    if (!(f2 > 0)) {
        return 0;
    }
    const double rounding = 8 * (DBL_EPSILON + rounding_of_accelerations(s));
    return fmax(rounding, correction_part * s->coupling.rtol) * sqrt(f2);
}

/* Adds to a message what the iterations have shown of the fluid. */
static void describe_fluid(const spari_coupling *c, size_t size, char *text) {
    static const double MUCH = 0.3;
    double mass = c->report[SPAR_REPORT_ADDED_MASS], spread = c->report[SPAR_REPORT_ADDED_MASS_SPREAD];
    double rho = spari_accelerator_carried_over(c->accelerator);
    double rotation = spari_accelerator_limited_rotation(c->accelerator);
    int n = 0;
    text[0] = '\0';
    if (mass != 0) {
        n = snprintf(text, size, "; added mass about %.3g (+- %.2g) of the mass", mass, spread);
    }
    if (rho > MUCH) {
        n += snprintf(text + n, size - (size_t)n,
                      "; the fluid carries %.0f %% of each change over to its next solution, so correct it more often",
                      100 * rho);
    }
    if (rotation > 0) {
        n += snprintf(text + n, size - (size_t)n, "; the last correction would rotate a section by %.2g rad", rotation);
    }
    if (flat_level(c) > 0) {
        (void)snprintf(
            text + n, size - (size_t)n,
            "; the residual stays at %.1e of the loads: if they scatter from call to call, rtol cannot be below",
            flat_level(c));
    }
}

static int not_converged(spar_session *s, const char *call) {
    const spari_coupling *c = s->own->coupling;
    int last = c->iterations - 1;
    char motion[80] = "", mass[400];
    double load[2];
    const spar_member *m = s->state.static_solution ? NULL : member_overwhelmed(s, 1, load);
    SPARI_REQUIRE(s, !m, SPAR_ERR_NUMERIC,
                  "%s: the fluid's loads on member '%s' have grown from %.3g to %.3g (N, N m) within a few steps; "
                  "check the fluid for a folded mesh or divergence (the coupling has not converged in %d iterations)",
                  call, m->name, load[0], load[1], s->state.iteration);
    describe_fluid(c, sizeof mass, mass);
    if (spari_coupling_wants_motion(s)) {
        (void)snprintf(motion, sizeof motion, ", motion by %.3g m of %.3g m", c->moved, c->travelled);
    }
    /* Before growth is looked at: what rounding leaves may grow from iteration to iteration. */
    const double rounding = s->state.static_solution ? 0 : rounding_of_accelerations(s);
    SPARI_REQUIRE(s, 10 * rounding < s->coupling.rtol || s->coupling.rtol == 0, SPAR_ERR_NUMERIC,
                  "%s: the coupling has not converged in %d iterations (loads change by %.3g N of %.3g N%s%s): in a "
                  "step of %g s the rounding of positions makes a relative error of %.1g in accelerations and in loads "
                  "that depend on them; use a larger dt or tolerance",
                  call, s->state.iteration, c->residual[last], c->size[last], motion, mass, s->clock.dt, rounding);
    double factor = grown_lately(c);
    if (factor > 0) {
        return spari_fail(
            s, SPAR_ERR_NUMERIC,
            "%s: the coupling has not converged in %d iterations and diverges: the change of "
            "the loads has grown by a factor of %.3g from iteration to iteration, to %.3g N of %.3g N%s%s; %s",
            call, s->state.iteration, factor, c->residual[last], c->size[last], motion, mass, cures_of(s, 1, 0));
    }
    return spari_fail(s, SPAR_ERR_NUMERIC,
                      "%s: the coupling has not converged in %d iterations (loads change by %.3g N of %.3g "
                      "N%s%s); %s",
                      call, s->state.iteration, c->residual[last], c->size[last], motion, mass,
                      cures_of(s, 0, flat_level(c) > 0));
}

static spari_norm_loads weighed(const spar_session *s) {
    const spari_coupling *c = s->own->coupling;
    return (spari_norm_loads){c->n, c->unit, c->x, c->g, c->shift, c->image, c->workspace, motion_of(s)};
}

int spari_coupling_weighs(const spar_session *s) {
    const spari_coupling *c = s->own->coupling;
    /* a step that has changed to the load norm keeps it */
    return c->weighs && (s->state.iteration == 0 || spari_accelerator_imaged(c->accelerator));
}

/* motion := the larger of the motion due to the residual, and due to the residual relative to the settled fluid. A
   fluid that responds only partly may agree with the loads while the rest is still to come. */
static int unsettled(spar_session *s, double *motion) {
    const spari_coupling *c = s->own->coupling;
    double *r = c->settled, *image = c->settled + c->n, square = 0;
    if (!spari_accelerator_settled(c->accelerator, c->x, c->g, r)) {
        return SPAR_OK;
    }
    const spari_norm_loads w = weighed(s);
    SPARI_TRY(spari_motion_norm_images(s, &w, 1, r, image));
    spari_motion_norm_add_carried(s, &w, r, image);
    for (int64_t i = 0; i < c->n; i++) {
        square += r[i] * image[i];
    }
    *motion = fmax(*motion, sqrt(fmax(square, 0)));
    return SPAR_OK;
}

/* The residual in the motion norm: the motion that it causes, relative to the motion caused by all loads. */
static int measure_residual(spar_session *s, double size, double *residual) {
    spari_coupling *c = s->own->coupling;
    double motion, whole;
    c->weighed = 0;
    c->idle = c->idle && size == 0;
    /* loads that agree to rounding: what they move may be rounding too (those of a fixed root), without a ratio */
    const int same = *residual <= 8 * DBL_EPSILON * size;
    if (c->idle) {
        return SPAR_OK;
    }
    /* a step that has changed to the load norm keeps it */
    if (c->weighs && (s->state.iteration == 1 || spari_accelerator_imaged(c->accelerator))) {
        stack(s);
        const spari_norm_loads w = weighed(s);
        SPARI_TRY(spari_motion_norm(s, &w, &motion, &whole, &c->weighed));
        motion = same ? 0 : motion;
        if (c->weighed && c->settled) {
            SPARI_TRY(unsettled(s, &motion));
        }
        if (c->weighed && !(same && motion == 0)) {
            *residual = whole > 0 ? size * (motion / whole) : 0;
        }
    }
    return SPAR_OK;
}

/* The absolute tolerance unless the host gives another (session/settings.c), N; and a motion that counts as none,
   lengths relative to the member, or rad. */
static const double DEFAULT_ATOL = 1e-9, NEGLIGIBLE = 1e-12;

/* The smallest force that moves a member by such a motion, for solutions without steps: by its largest stiffness, or
   its mass in a step. INFINITY: not known. */
static double negligible_force(const spar_session *s) {
    double least = INFINITY, dt = s->clock.dt;
    for (const spar_member *m = s->members; m; m = m->next) {
        double scale = m->body ? m->body->stiffest : 0;
        if (scale == 0 && m->body && dt > 0) {
            scale = spari_body_mass(m->body) * m->body->length / (dt * dt);
        }
        least = scale > 0 ? fmin(least, scale) : least;
    }
    return NEGLIGIBLE * least;
}

/* *moves: whether the residual moves a node by more than that. 0 where spar does not know the flexibility. All ranks.
 */
static int moves_nodes(spar_session *s, int *moves) {
    const spari_coupling *c = s->own->coupling;
    const double *image = c->image, *unit = c->unit;
    double most = 0, farthest;
    if (!c->weighed && c->weighs) {
        SPARI_TRY(spari_motion_norm_miss(s, c->n, c->image, c->workspace, &farthest));
    }
    for (const spar_member *m = s->members; m && c->weighs; image += 6 * m->nodes, unit++, m = m->next) {
        for (int64_t i = 0; i < 6 * m->nodes; i++) { /* stacked, rotations are multiplied by the length */
            most = fmax(most, fabs(image[i]) * (i % 6 < 3 || c->weighed ? *unit : 1));
        }
    }
    *moves = most > NEGLIGIBLE;
    return SPAR_OK;
}

/* Whether the residual is within the tolerances. For a small structure the default of the absolute one may exceed all
   loads, so it counts only if the residual moves nothing. */
static int is_small(spar_session *s, double residual, double size, int *small) {
    int moves = 0;
    *small = residual <= s->coupling.rtol * size || residual <= error_of_added_mass(s);
    if (*small || residual > s->coupling.atol + s->coupling.rtol * size) {
        return SPAR_OK;
    }
    if (fabs(s->coupling.atol - DEFAULT_ATOL) > 0) {
        *small = 1;
        return SPAR_OK;
    }
    if (s->state.static_solution) {
        *small = residual <= negligible_force(s);
        return SPAR_OK;
    }
    SPARI_TRY(moves_nodes(s, &moves));
    *small = !moves;
    return SPAR_OK;
}

int spari_coupling_compare(spar_session *s, int *agreed) {
    spari_coupling *c = s->own->coupling;
    double residual, size;
    *agreed = 0;
    load_norms(s, NULL, &residual, &size);
    SPARI_REQUIRE(s, isfinite(residual) && isfinite(size), SPAR_ERR_NUMERIC,
                  "the square of the loads overflows: the fluid or the iteration has diverged; check the fluid, use a "
                  "smaller relaxation or dt, or reject the step");
    int motion = c->accelerator && spari_coupling_wants_motion(s);
    if (motion) {
        motion_norms(s);
    }
    SPARI_TRY(measure_residual(s, size, &residual));
    record(c, residual, size);
    if (c->estimates) {
        SPARI_TRY(spari_motion_norm_miss(s, c->n, c->image, c->workspace, c->report + SPAR_REPORT_MOTION_ERROR));
    }
    SPARI_TRY(is_small(s, residual, size, agreed));
    *agreed = *agreed && (!motion || c->moved <= s->coupling.motion_atol + s->coupling.motion_rtol * c->travelled);
    return SPAR_OK;
}

static int image_loads(void *session, int64_t count, const double *loads, double *image) {
    spar_session *s = session;
    const spari_norm_loads w = weighed(s);
    SPARI_TRY(spari_motion_norm_images(s, &w, count, loads, image));
    for (int64_t j = 0; j < count && !s->own->coupling->settled; j++) { /* Aitken's products are those of the norm */
        spari_motion_norm_add_carried(s, &w, loads + j * w.n, image + j * w.n);
    }
    return SPAR_OK;
}

/* Largest rotation of a section, rad, in stacked motions. */
static double largest_rotation(void *session, const double *motion) {
    const spar_session *s = session;
    const double *unit = s->own->coupling->unit;
    double most = 0;
    for (const spar_member *m = s->members; m; m = m->next, unit++) {
        for (int64_t i = 0; i < m->nodes; i++, motion += 6) {
            double rotation = *unit * spari_norm(motion + 3);
            most = isfinite(rotation) ? fmax(most, rotation) : INFINITY;
        }
    }
    return most;
}

/* The motion since the iteration before as the structure made it, and the axes of the sections. */
static void measure_motion(const spar_session *s) {
    spari_coupling *c = s->own->coupling;
    double *before = c->before, *moved = c->path, *axes = c->axes, *unit = c->unit;
    for (const spar_member *m = s->members; m; m = m->next, unit++) {
        for (int64_t i = 0; i < m->nodes; i++, before += 7, moved += 6, axes += 4) {
            const double *q = m->after.q + 7 * i, *v = m->after.v + 6 * i;
            if (motion_of(s) == SPARI_OF_VELOCITY) {
                for (int k = 0; k < 6; k++) {
                    moved[k] = SPARI_DIAGONAL * s->clock.dt * (v[k] - before[k]);
                }
                memcpy(before, v, 6 * sizeof *v);
            } else {
                travel(before, q, moved);
                memcpy(before, q, 7 * sizeof *q);
            }
            for (int k = 3; k < 6; k++) {
                moved[k] /= *unit;
            }
            memcpy(axes, q + 3, 4 * sizeof *q);
        }
    }
}

int spari_coupling_next(spar_session *s) {
    spari_coupling *c = s->own->coupling;
    const spari_images images = {c->image, image_loads, s, c->path, c->axes, largest_rotation};
    const spari_norm_loads w = weighed(s);
    int secants = c->weighed && spari_coupling_scheme_of(s->coupling.scheme)->columns;
    stack(s);
    if (secants) {
        measure_motion(s);
    }
    SPARI_TRY(spari_accelerator_next(c->accelerator, c->x, c->g, c->weighed ? &images : NULL, c->x));
    /* loads that move nothing are not in the least squares: they are used as they came back */
    SPARI_TRY(secants ? spari_motion_norm_effective_load(s, &w, c->settled, c->x) : SPAR_OK);
    unstack(s);
    report_added_mass(c);
    c->report[SPAR_REPORT_COLUMNS] = spari_accelerator_columns(c->accelerator);
    c->report[SPAR_REPORT_DROPPED] = spari_accelerator_dropped(c->accelerator);
    return SPAR_OK;
}

/* Writes to the log each time, and fails after coupling.patience steps in turn. */
static int accept_unconverged(spar_session *s, const char *call) {
    spari_coupling *c = s->own->coupling;
    int last = c->iterations - 1;
    if (c->in_row + 1 >= s->coupling.patience) {
        return not_converged(s, call);
    }
    c->unconverged = 1;
    c->report[SPAR_REPORT_UNCONVERGED] += 1;
    spari_warn(s,
               "the coupling has not converged in %d iterations in the step from t = %g (loads change by %.3g "
               "N of %.3g N); the step continues unconverged (option coupling.unconverged = accept)",
               s->state.iteration, s->clock.time, c->residual[last], c->size[last]);
    return SPAR_OK;
}

/* ---- stability of explicit steps ---- */

/* Whether a node has moved in the step by more than rounding. What happens to a structure at rest says nothing. */
static int moves_in_step(const spar_session *s) {
    const double *length = s->own->coupling->length;
    double d[6];
    for (const spar_member *m = s->members; m; m = m->next, length++) {
        for (int64_t i = 0; i < m->nodes; i++) {
            travel(m->now.q + 7 * i, m->after.q + 7 * i, d);
            if (spari_norm(d) > NEGLIGIBLE * *length || spari_norm(d + 3) > NEGLIGIBLE) {
                return 1;
            }
        }
    }
    return 0;
}

/* Ratio of added mass to mass with which an explicit scheme of this order grows by z per step. */
static double ratio_of_growth(int order, double z) {
    return order == 0 ? z : order == 1 ? z * z / (2 * z + 1) : z * z * z / (3 * z * z + 3 * z + 1);
}

/* Added mass, relative to the mass, up to which an explicit scheme of this order is stable. */
static const double stable_ratio[3] = {1, 1.0 / 3, 1.0 / 7};

/* Logs what the growth implies: mean, scatter, and the added mass with which an explicit scheme of this order grows
   so fast. */
static void tell_alternation(const spar_session *s) {
    const spari_growth *g = &s->own->coupling->stability.steps;
    double n = g->count, mean = g->log_sum / n, spread = sqrt(fmax(g->log_square / n - mean * mean, 0));
    double z = exp(mean), ratio = ratio_of_growth(s->state.order, z);
    spari_warn(s,
               "the coupling is becoming unstable at t = %g: in the last %d steps the error of the predicted loads has "
               "alternated in sign and grown by a factor of %.3g (+- %.2g) per step: the added mass is about %.2g (+- "
               "%.1g) of the mass; an explicit scheme with a predictor of order %d is stable up to %.2g; "
               "iterate "
               "(spar_session_set_coupling) or lower the order of the predictor",
               s->clock.time + s->clock.dt, g->count + 1, z, z * spread, ratio,
               ratio_of_growth(s->state.order, z * exp(spread)) - ratio, s->state.order, stable_ratio[s->state.order]);
}

/* Compares the predicted loads with the pushed loads, and with the comparison of the step before. */
static spari_predicted_step see_prediction(const spar_session *s) {
    spari_coupling *c = s->own->coupling;
    double error = 0, size = 0, before = 0, turned = 0, predicted = 0, answered = 0;
    const double *from = c->predicted, *last = c->missed;
    double *now = c->missing;
    int k = 0;
    for (const spar_member *m = s->members; m; m = m->next, k++) {
        const double *shift = spari_added_shift(m), *used = c->accelerator ? from : m->load.used;
        for (int64_t i = 0; i < 6 * m->nodes; i++, last++, now++) {
            double w = i % 6 < 3 ? 1 : 1 / c->length[k], load = w * m->load.pushed[i], guess = w * used[i];
            *now = load - guess;
            error += *now * *now;
            before += *last * *last;
            turned += *now * *last;
            predicted += guess * guess;
            answered += guess * load;
            load -= shift ? w * shift[i] : 0;
            size += load * load;
        }
        from += c->accelerator ? 6 * m->nodes : 0;
    }
    double both = sqrt(error * before), same = sqrt(size * predicted);
    return (spari_predicted_step){sqrt(error), sqrt(size), sqrt(before), both > 0 ? turned / both : 0,
                                  same > 0 ? answered / same : 0};
}

/* SPAR_ERR_NUMERIC if the error of the predicted loads grows from step to step with one evaluation of the fluid. */
static int check_explicit(spar_session *s, const char *call) {
    const spari_coupling *c = s->own->coupling;
    const spari_predicted_step now = see_prediction(s);
    spari_explicit_stability is = c->stability;
    double factor = 0;
    spari_explicit_stability_add(&is, &now);
    int steps = spari_explicit_is_unstable(&is, &factor);
    SPARI_REQUIRE(
        s, steps == 0 || s->coupling.accept_unstable || now.error <= s->coupling.atol, SPAR_ERR_NUMERIC,
        "%s: explicit coupling, with one evaluation of the fluid per step, is unstable at t = %g: in the last "
        "%d steps the error of the predicted loads has grown by a factor of %.3g per step, to %.3g N of %.3g "
        "N, as with an added mass of about %.2g of the mass (a predictor of order %d is stable up to %.2g); "
        "reject the step and iterate with SPAR_COUPLING_IQN_ILS (spar_session_set_coupling), give the "
        "fluid's added mass (spar_member_set_added_mass), lower the order of the predictor, or go on with "
        "the option coupling.unstable = accept",
        call, s->clock.time + s->clock.dt, steps, factor, now.error, now.size, ratio_of_growth(s->state.order, factor),
        s->state.order, stable_ratio[s->state.order]);
    return SPAR_OK;
}

static void forget_explicit(spari_coupling *c) {
    if (c->was_explicit) {
        c->was_explicit = 0;
        c->stability = (spari_explicit_stability){.steps = {0}};
    }
}

static void accept_explicit(spar_session *s) {
    static const double LARGE = 0.5, SMALL = 0.05;
    enum { AT_LEAST = 2, SURE = 4 };
    spari_coupling *c = s->own->coupling;
    const spari_predicted_step now = see_prediction(s);
    double *last = c->missed;
    c->missed = c->missing, c->missing = last;
    spari_explicit_stability_add(&c->stability, &now);
    const spari_growth *g = &c->stability.steps;
    int sure = g->count >= SURE ? now.error > SMALL * now.size : g->count >= AT_LEAST && now.error > LARGE * now.size;
    c->was_explicit = 1;
    if (sure && g->log_sum > log(2) && !c->warned && moves_in_step(s)) {
        c->warned = 1;
        tell_alternation(s);
    }
}

/* Loads that move nothing have no weight in the stop test, and are those of an iteration before. Section forces that
   follow from loads, not from strains, need those pushed last. */
static int needs_idle_loads(const spar_member *m) {
    return m->row->effective_load && !m->assembly &&
           (m->fidelity == SPAR_FIDELITY_MODAL || m->fidelity == SPAR_FIDELITY_RIGID);
}

static int update_idle_loads(spar_session *s) {
    spari_coupling *c = s->own->coupling;
    const double *x = c->x, *unit = c->unit;
    int needed = 0;
    for (const spar_member *m = s->members; m; m = m->next) {
        needed = needed || needs_idle_loads(m);
    }
    if (!needed) {
        return SPAR_OK;
    }
    stack(s);
    const spari_norm_loads w = weighed(s);
    SPARI_TRY(spari_motion_norm_effective_load(s, &w, c->image, c->x));
    for (spar_member *m = s->members; m; x += 6 * m->nodes, m = m->next, unit++) {
        const double *shift = spari_added_shift(m);
        for (int64_t i = 0; i < 6 * m->nodes && needs_idle_loads(m); i++) {
            m->load.solved[1][i] = m->load.dead[i] + x[i] / (i % 6 < 3 ? 1 : *unit) - (shift ? shift[i] : 0);
        }
    }
    return SPAR_OK;
}

int spari_coupling_check(spar_session *s, const char *call, int *done) {
    spari_coupling *c = s->own->coupling;
    int agreed;
    *done = 1;
    SPARI_TRY(spari_named(s, call, spari_coupling_compare(s, &agreed)));
    if (!s->state.static_solution && (!c->accelerator || (!agreed && c->was_explicit && s->state.iteration == 1))) {
        SPARI_TRY(check_explicit(s, call));
    }
    if (agreed || !c->accelerator) {
        return agreed && c->accelerator && c->weighs ? update_idle_loads(s) : SPAR_OK;
    }
    if (s->state.iteration >= s->coupling.max) {
        if (!s->coupling.accept_unconverged) {
            return not_converged(s, call);
        }
        return accept_unconverged(s, call);
    }
    *done = 0;
    return spari_coupling_next(s);
}

/* ---- report of an accepted step ---- */

/* Work of the fluid over the step minus work on the structure, [J]; *whole: of all loads, each counted positive. */
static double work_defect(const spar_session *s, double *whole) {
    double defect = 0, d[6];
    *whole = 0;
    for (const spar_member *m = s->members; m; m = m->next) {
        const double *shift = spari_added_shift(m);
        for (int64_t i = 0; i < m->nodes; i++) {
            travel(m->now.q + 7 * i, m->after.q + 7 * i, d);
            for (int k = 0; k < 6; k++) {
                double f = m->load.pushed[6 * i + k];
                defect += 0.5 * (f - m->load.used[6 * i + k]) * d[k];
                *whole += 0.5 * fabs((f - (shift ? shift[6 * i + k] : 0)) * d[k]);
            }
        }
    }
    return defect;
}

/* In a sound run the defect is a small part of the work. In a run that is about to diverge it has the size of the
   work and grows from step to step. */
static void watch(spar_session *s) {
    enum { GROWING_STEPS = 4, LONG_UNWARNED = 20 };
    spari_coupling *c = s->own->coupling;
    double whole, defect = work_defect(s, &whole);
    c->grown = moves_in_step(s) && fabs(defect) > fabs(c->defect) && fabs(defect) > 0.9 * whole ? c->grown + 1 : 0;
    c->defect = defect;
    c->report[SPAR_REPORT_WORK_DEFECT] = defect;
    c->steps_unwarned = c->grown == 0 && c->stability.steps.count == 0 ? c->steps_unwarned + 1 : 0;
    if (c->steps_unwarned >= LONG_UNWARNED) {
        c->warned = 0;
    }
    if (c->grown >= GROWING_STEPS && !c->warned) {
        c->warned = 1;
        spari_warn(s,
                   "the coupling is becoming unstable at t = %g: fluid and structure differ by %.3g J of %.3g J "
                   "of work in this step, and the difference has grown for %d steps; iterate (spar_session_set_"
                   "coupling) or lower the order of the predictor",
                   s->clock.time + s->clock.dt, fabs(defect), whole, c->grown);
    }
}

void spari_coupling_accept(spar_session *s) {
    spari_coupling *c = s->own->coupling;
    c->in_row = c->unconverged ? c->in_row + 1 : 0;
    c->unconverged = 0;
    const int checked = s->state.phase == SPARI_CHECKED;
    /* a step with loads of one evaluation of the fluid: explicit, or accepted before the coupling has converged */
    if (checked && (!c->accelerator || (s->state.iteration == 1 && s->state.iterating))) {
        accept_explicit(s);
    } else {
        forget_explicit(c);
    }
    if (checked) { /* predicted minus final loads are the error of the coupling, of order dt^(order + 1) */
        double change, size;
        load_norms(s, c->accelerator ? c->predicted : NULL, &change, &size);
        c->report[SPAR_REPORT_ERROR] = size > 0 ? change / size : 0;
        watch(s);
    }
    if (c->accelerator) {
        int ended = checked && c->settled;
        if (ended) {
            stack(s);
            if (!s->state.iterating && s->state.iteration > 1) {
                const spari_images images = {NULL, NULL, NULL, c->path, c->axes, NULL};
                measure_motion(s);
                spari_accelerator_end(c->accelerator, c->x, c->g, &images);
            }
        }
        spari_accelerator_accept(c->accelerator, ended ? c->g : NULL);
    }
}

void spari_coupling_reject(spar_session *s) {
    s->own->coupling->unconverged = 0;
    if (s->own->coupling->accelerator) {
        forget_explicit(s->own->coupling); /* the host may iterate the step now */
        spari_accelerator_reject(s->own->coupling->accelerator);
    }
}

void spari_coupling_forget(spar_session *s) {
    if (s->own->coupling->accelerator) {
        spari_accelerator_forget(s->own->coupling->accelerator);
    }
}

int spar_session_get_iterations(const spar_session *session, int *iterations, int64_t capacity, double *residual,
                                double *size) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_REQUIRE(NULL, session, SPAR_ERR_ARGUMENT, "%s: the session is NULL; create it first", __func__);
    SPARI_TRY(spari_need_capacity(session, __func__, capacity));
    const spari_coupling *c = session->own->coupling;
    SPARI_GIVE(iterations, c ? c->iterations : 0);
    spari_fill(capacity, residual, c ? c->iterations : 0, c ? c->residual : NULL);
    spari_fill(capacity, size, c ? c->iterations : 0, c ? c->size : NULL);
    return SPAR_OK;
}

int spar_session_get_residual(const spar_session *session, double *residual, double *size) {
    SPARI_REQUIRE(NULL, session, SPAR_ERR_ARGUMENT, "%s: the session is NULL; create it first", __func__);
    double last[2] = {0, 0};
    if (session->own->coupling) {
        last_iteration(session, &last[0], &last[1]);
    }
    SPARI_GIVE(residual, last[0]);
    SPARI_GIVE(size, last[1]);
    return SPAR_OK;
}

int spar_session_get_report(const spar_session *session, int64_t capacity, double *report) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_REQUIRE(NULL, session, SPAR_ERR_ARGUMENT, "%s: the session is NULL; create it first", __func__);
    SPARI_TRY(spari_need_capacity(session, __func__, capacity));
    const spari_coupling *c = session->own->coupling;
    spari_fill(capacity, report, c ? SPAR_REPORT_COUNT : 0, c ? c->report : NULL);
    return SPAR_OK;
}
