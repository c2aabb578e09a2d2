/* Time integration of an assembly: see assembly.h. */
#include "assembly.h"

#include "../base/environment.h"
#include "../base/session.h"
#include "../math/rotation.h"
#include "../time/fidelity.h"
#include "../time/newton.h"
#include "../time/substeps.h"
#include "system.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void spari_assembly_name(const void *assembly, char *text, int size) {
    const spari_assembly *a = assembly;
    if (a->constraints == 0) {
        (void)snprintf(text, (size_t)size, "member '%s'", a->component[0].member->name);
    } else {
        (void)snprintf(text, (size_t)size, "the members connected by joint '%s'", a->constraint[0].joint->name);
    }
}

int spari_assembly_solve(spari_assembly *a, double cv) {
    return a->constraints == 0 ? a->component->row->solve(a->component) : spari_system_solve(a, cv);
}

enum { NAME = 160 };

/* ---- one substep ---- */

/* Newton's method (newton.h) for a substep of all components. */
typedef struct newton_step {
    spari_assembly *a;
    double s, dt;
} newton_step;

/* Whether any component has starting values of this kind; the others keep their velocities then. */
static int predict(void *self, spari_guess stays) {
    const newton_step *t = self;
    spari_assembly *a = t->a;
    int any = 0;
    for (int i = 0; i < a->components; i++) {
        spari_component *p = a->component + i;
        int has = p->row->predict(p, stays);
        any = has || any;
        if (!has) {
            (void)p->row->predict(p, SPARI_KEEP_VELOCITY);
        }
    }
    for (int i = 0; i < a->constraints; i++) {
        a->constraint[i].joint->after = a->constraint[i].begin;
    }
    return any;
}

/* A position gap below this counts as zero: in a step h, it causes an acceleration of gap / h^2, 1 m/s^2 for 1e-8 s. */
static double rounding_of(const spari_constraint *l) {
    return 8 * DBL_EPSILON * spari_larger(l->reach, spari_larger(spari_norm(l->pose[0].x), spari_norm(l->pose[1].x)));
}

/* The part of the rates' gaps that closing the gaps leaves. Returns whether there is any. */
static int find_rate_gap(const spari_assembly *a, spari_constraint *l) {
    int any = 0;
    for (int k = 0; k < 6; k++) {
        l->rate_gap[k] = spari_constraint_holds(l, k)
                             ? spari_constraint_rate_gap(l, k) / a->component[0].scheme.rate - l->gap[k]
                             : 0;
        any = any || fabs(l->rate_gap[k]) > 0;
    }
    return any;
}

/* Gaps of all constraints at the latest iterate. */
static void update_gaps(spari_assembly *a, double s, double dt) {
    a->rates_off = 0;
    for (int i = 0; i < a->components; i++) {
        spari_component_impose_root(a->component + i);
    }
    for (int i = 0; i < a->constraints; i++) {
        spari_constraint *l = a->constraint + i;
        spari_constraint_find(l, s, dt, 1);
        spari_constraint_find_force(l);
        double rounding = rounding_of(l);
        for (int k = 0; k < 6; k++) {
            double gap = spari_constraint_holds(l, k) ? spari_constraint_gap(l, k) : 0;
            l->gap[k] = copysign(spari_larger(0, fabs(gap) - (k < 3 ? rounding : 8 * DBL_EPSILON)), gap);
        }
        a->rates_off = (a->constrains_rates && find_rate_gap(a, l)) || a->rates_off;
    }
}

/* Residuals of all components, with reused tangents also condensed: a component is visited once, since a large
   assembly does not fit the caches. Returns the size that rounding errors are relative to, or NaN. */
static double balance(spari_assembly *a, double *residual_size) {
    double scale = 0;
    *residual_size = 0;
    for (int i = 0; i < a->components; i++) {
        spari_component *p = a->component + i;
        p->force = p->row->balance(p);
        scale += p->force;
        spari_constraints_add_forces(a, p);
        p->unbalanced = p->row->residual_size(p);
        *residual_size = spari_larger(*residual_size, p->unbalanced);
        scale += 0 * p->unbalanced;
        if (a->factored && spari_component_reduce(p, 1, a->x + p->at)) {
            return NAN;
        }
    }
    return scale;
}

static int form(spari_assembly *a) {
    for (int i = 0; i < a->components; i++) {
        if (a->component[i].row->tangent(a->component + i)) {
            return 1;
        }
    }
    a->formed = a->stepping;
    a->system_serves = 0;
    return 0;
}

/* Subtracts the corrections, all shortened by the same factor so that none is larger than `longest`. If the step
   constrains rates, also projects them onto the constraints; positions stay. *size: that of the correction before,
   at least that of the projection. Returns 0 or 1. */
static int correct(spari_assembly *a, double longest, double *size) {
    double largest = 0;
    for (int i = 0; i < a->components; i++) {
        largest = spari_larger(largest, a->component[i].correction_size);
    }
    double cut = largest > longest ? longest / largest : 1;
    spari_constraints_correct_loads(a, cut);
    const int rates = a->rates_off;
    if (rates && spari_system_solve_rates(a, a->component[0].scheme.cv)) {
        return 1;
    }
    for (int i = 0; i < a->components; i++) {
        spari_component *p = a->component + i;
        const spari_scheme *c = &p->scheme;
        p->motion = spari_component_correct(p, cut);
        if (rates) {
            spari_component_clear(p);
            spari_component_expand(p, a->x + p->at);
            largest = spari_larger(largest, p->row->correction_size(p));
            spari_component_shift_rates(p, cut * c->rate, cut * c->cm, cut * c->cb);
        }
    }
    if (rates) {
        spari_constraints_correct_loads(a, cut);
    }
    *size = largest;
    return 0;
}

/* The remaining correction that is allowed in a substep with this motion. In a stage of TR-BDF2 less is allowed:
   accelerations follow from increments with cm = 11.7 / h^2 (generalised-alpha: 4 / h^2), and the next step, which may
   be much longer, begins with these accelerations. */
static double correction_tolerance(const spar_session *s, const spari_scheme *c, double motion) {
    const spari_newton_settings *n = &s->newton;
    return c->rule == SPARI_ALPHA ? n->atol + n->rtol * motion
                                  : 0.25 * (fmin(n->atol, 1e-6 * c->h * c->h) + n->rtol * motion);
}

/* The unbalanced forces that may remain where the largest force of a section or of inertia is `force`, with a
   correction tolerance relative to the motion. Forces follow from second derivatives of positions, so that they have
   relative errors some hundred times larger: a tenth of that costs 5 % of the iterations, ten times as much lets a
   coupling take one per cent more (theory.md, (E4)). Rounding of positions makes forces of `stiffest` times their last
   digit.
 */
static double force_tolerance(const spari_body *body, double force, double relative) {
    static const double part = 100, rounding = 64 * DBL_EPSILON;
    return part * relative * force + rounding * body->stiffest;
}

/* A tolerance relative to the motion; at rest there is none. */
static double relative_to(double motion, double tolerance) {
    return tolerance < motion ? tolerance / motion : 1;
}

/* No component needs to be more accurate than SLOWEST times the others: their motions and forces are coupled. */
static const double SLOWEST = 0.01;

/* The tolerances after a correction as large as `largest`, from those of all components. */
static void find_tolerances(const spari_assembly *a, double largest, spari_iterate *it) {
    double motion = 0, force = 0, worst = 0, worst_force = 0;
    it->force = 0;
    for (int i = 0; i < a->components; i++) {
        motion = spari_larger(motion, a->component[i].motion);
        force = spari_larger(force, a->component[i].force);
    }
    for (int i = 0; i < a->components; i++) {
        const spari_component *p = a->component + i;
        double way = spari_larger(p->motion, SLOWEST * motion),
               allowed = correction_tolerance(a->session, &p->scheme, way),
               may_remain =
                   force_tolerance(p->body, spari_larger(p->force, SLOWEST * force), relative_to(way, allowed));
        worst = p->correction_size > 0 ? spari_larger(worst, p->correction_size / allowed) : worst;
        worst_force = p->unbalanced > 0 ? spari_larger(worst_force, p->unbalanced / may_remain) : worst_force;
        it->force = spari_larger(it->force, p->unbalanced);
    }
    it->tolerance = worst > 0 ? largest / worst : largest;
    it->force_tolerance = worst_force > 0 ? it->force / worst_force : 0;
}

static int tangent_serves(const spari_assembly *a) {
    int serves = a->constraints == 0 || a->factored; /* a member without joints keeps its tangent itself */
    for (int i = 0; i < a->components; i++) {
        serves = serves && a->component[i].row->serves(a->component + i);
    }
    return serves;
}

/* If all components have moved by less than near_factored (rad; lengths relative to the member), the factored system
   is used again. Its contraction rate is about this number. */
static const double near_factored = 0.01;

/* Of the tangents of an assembly (spari_tangent_serves_on). They are not formed twice in a step. */
enum { PATIENCE = 3, PRICE = 13 };

/* Whether the step under way has formed its tangents. Rates are projected onto the constraints in the metric of the
   tangents, so a coupling may not converge if every other iteration has new ones. */
static int formed_in_step(const spari_assembly *a) {
    return a->session->integrator.substeps == 1 && (!a->factored_begun || a->formed);
}

static int begin_attempt(void *self, spari_tangents tangents) {
    newton_step *t = self;
    t->a->factored = tangents == SPARI_TANGENT_REUSED && tangent_serves(t->a);
    t->a->wandered = t->a->wandered || tangents == SPARI_TANGENT_EACH;
    for (int i = 0; i < t->a->components; i++) {
        const spari_component *p = t->a->component + i;
        if (p->solver && p->body->C) {
            spari_solver_mix(p->solver, tangents == SPARI_TANGENT_EACH);
        }
    }
    t->a->system_serves = 0; /* the beginning of a solution must not depend on earlier solutions */
    return t->a->factored;
}

/* Nothing restores the energy and the momentum of a free member, so that what Newton leaves adds up over a run. With
   this part of the tolerance a body that tumbles for 10^6 steps of 0.006 or 0.06 rad loses less than the scheme errs.
 */
static const double FREE = 0.01;

/* An iteration of a member without joints. */
static const char *iterate_alone(spari_assembly *a, double longest, spari_iterate *it) {
    spari_component *p = a->component;
    double scale = p->row->balance(p), residual_size = p->row->residual_size(p), motion;
    if (!isfinite(scale) || !isfinite(residual_size)) {
        return "met values that are not finite";
    }
    if ((!a->factored && p->row->tangent(p)) || p->row->correct_newton(p)) {
        return "found a singular tangent";
    }
    a->factored = 1;
    it->correction = p->row->advance(p, longest, &motion);
    it->tolerance = correction_tolerance(a->session, &p->scheme, motion);
    it->tolerance *= p->member->root == SPAR_ROOT_FREE ? FREE : 1;
    it->force = residual_size;
    it->force_tolerance = it->correction > 0 ? force_tolerance(p->body, scale, relative_to(motion, it->tolerance))
                                             : residual_size; /* the solution is exact */
    it->small = it->correction < 1e-11;
    it->stiff = residual_size <= 64 * DBL_EPSILON * p->body->stiffest;
    it->rounded = residual_size <= 16 * DBL_EPSILON * scale;
    return NULL;
}

static const char *iterate_newton(void *self, double longest, spari_iterate *it) {
    const newton_step *t = self;
    spari_assembly *a = t->a;
    if (!spari_budget_allows(a->session, spari_assembly_spent(a), a->session->newton.budget)) {
        return "ended";
    }
    if (a->constraints == 0) {
        return iterate_alone(a, longest, it);
    }
    update_gaps(a, t->s, t->dt);
    double residual_size, scale = balance(a, &residual_size);
    if (!isfinite(scale)) {
        return "met values that are not finite";
    }
    if (!a->factored && (form(a) || spari_system_reduce(a, 1))) {
        return "found a singular tangent";
    }
    a->factored = 1;
    if (spari_system_solve_reduced(a, a->component[0].scheme.cv, a->rates_off) ||
        correct(a, longest, &it->correction)) {
        return "found a singular tangent";
    }
    a->moved += it->correction;
    /* Positions must not depend on the state in which the system was factored. */
    a->system_serves = a->system_serves && a->moved < near_factored && a->component[0].scheme.rule == SPARI_ALPHA;
    find_tolerances(a, it->correction, it);
    it->small = it->correction < 1e-11;
    it->stiff = 0;
    it->rounded = residual_size <= 16 * DBL_EPSILON * scale && it->small;
    return NULL;
}

static void renew_tangents(void *self) {
    const newton_step *t = self;
    t->a->factored = 0;
}

static void end_solution(void *self, int iterations, spari_tangents tangents) {
    const newton_step *t = self;
    /* trial loads of a coupling that are far from converged say nothing of the next solution */
    tangents = t->a->session->state.rough && tangents == SPARI_TANGENT_EACH ? SPARI_TANGENT_NEW : tangents;
    spari_component *p = t->a->component;
    if (t->a->constraints == 0) {
        p->row->end_solution(p, iterations, tangents);
    } else {
        int serves =
            spari_tangent_serves_on(&t->a->reuse, PATIENCE, PRICE, iterations, tangents) || formed_in_step(t->a);
        t->a->factored = serves && !t->a->session->state.renew;
    }
}

/* Projects velocities onto the constraints, in the metric of the tangent. */
static int project(spari_assembly *a, double s, double dt) {
    for (int pass = 0; pass < 8; pass++) {
        double worst = 0, size = 0;
        for (int i = 0; i < a->constraints; i++) {
            spari_constraint *l = a->constraint + i;
            if (pass == 0) {
                spari_constraint_find(l, s, dt, 1);
            } else {
                spari_constraint_find_rates(l, dt, 1);
            }
            for (int k = 0; k < 6; k++) {
                l->gap[k] = spari_constraint_holds(l, k) ? spari_constraint_rate_gap(l, k) : 0;
                worst = spari_larger(worst, fabs(l->gap[k]));
            }
            for (int k = 0; k < 12; k++) {
                size = spari_larger(size, fabs(l->v[k]));
            }
        }
        if (worst <= 8 * DBL_EPSILON * size) {
            return 0;
        }
        if (spari_system_shift_rates(a, a->component[0].scheme.cv, 1, 0, 0)) {
            return 1;
        }
    }
    return 0;
}

/* Returns NULL, or the reason why the last attempt failed. A far correction may lead to another way of closing a
   loop. */
static const char *attempts_of(spari_assembly *a, double s, double dt, int *iterations) {
    static const spari_newton tied = {SPARI_LONGEST,  predict,        begin_attempt,
                                      iterate_newton, renew_tangents, end_solution},
                              alone = {INFINITY, predict, begin_attempt, iterate_newton, renew_tangents, end_solution};
    newton_step step = {a, s, dt};
    const spari_component *p = a->component;
    const int joined = a->constraints > 0, most = a->session->newton.max;
    const spari_tangent_reuse *reuse = joined ? &a->reuse : p->solver ? &p->solver->reuse : NULL;
    const spari_tangents first = reuse && !a->session->state.rough && spari_tangent_is_new_in_each(reuse)
                                     ? SPARI_TANGENT_EACH
                                 : tangent_serves(a) ? SPARI_TANGENT_REUSED
                                                     : SPARI_TANGENT_NEW;
    if (joined) {
        return spari_newton_solve(&tied, &step, first, most, &a->left, iterations);
    }
    const char *wrong = spari_newton_solve(&alone, &step, first, most, p->left, iterations);
    if (wrong) {
        p->row->end_solution(a->component, 0, SPARI_TANGENT_REUSED);
    }
    return wrong;
}

/* Where the last solution has led to. */
static int guess_onward(void *self, spari_guess stays) {
    (void)self;
    return stays == SPARI_KEEP_VELOCITY;
}

/* Moves driven joints that jump in so many parts, from the last position, each part from the solution of the part
   before. */
static const char *walk_drives_in(spari_assembly *a, double s, double dt, int parts, int *iterations) {
    static const spari_newton how = {SPARI_LONGEST,  guess_onward,   begin_attempt,
                                     iterate_newton, renew_tangents, end_solution};
    newton_step step = {a, s, dt};
    const char *wrong = NULL;
    (void)predict(&step, SPARI_KEEP_POSITION);
    for (int part = 1; part <= parts && !wrong; part++) {
        for (int i = 0; i < a->constraints; i++) {
            spari_constraint *l = a->constraint + i;
            for (int k = 0; k < 6; k++) {
                l->drive.z[k] = l->begin.z[k] + (l->to.z[k] - l->begin.z[k]) * part / parts;
            }
        }
        wrong = spari_newton_solve(&how, &step, SPARI_TANGENT_NEW, a->session->newton.max, &a->left, iterations);
    }
    return wrong;
}

/* The last attempt. wrong: reason why the one before failed. */
static const char *walk_drives(spari_assembly *a, double s, double dt, const char *wrong, int *iterations) {
    int jumps = 0;
    for (int i = 0; i < a->constraints; i++) {
        spari_constraint *l = a->constraint + i;
        l->to = l->drive;
        for (int k = 0; k < 6; k++) {
            jumps = jumps || ((l->joint->driven >> k & 1) && fabs(l->to.z[k] - l->begin.z[k]) > 0);
        }
    }
    for (int parts = 8; parts <= 128 && jumps && wrong; parts *= 4) {
        wrong = walk_drives_in(a, s, dt, parts, iterations);
    }
    for (int i = 0; i < a->constraints; i++) {
        a->constraint[i].drive = a->constraint[i].to;
    }
    return wrong;
}

/* Newton has found no solution. */
static int fail_newton(const spari_assembly *a, const char *wrong, int iterations) {
    const spar_session *s = a->session;
    const spari_spent *spent = spari_assembly_spent(a);
    const int budget = s->newton.budget;
    char name[NAME];
    spari_assembly_name(a, name, sizeof name);
    SPARI_TRY(spari_budget_cancelled(s, name, spent));
    SPARI_REQUIRE(
        s, !spari_budget_is_over(s, spent, budget), SPAR_ERR_LIMIT,
        "%s: the step from t = %g has used its budget of %d Newton iterations (option newton.budget) in "
        "coupling iteration %d, with %d parts of the step halved; prescribed motions or loads that jump, or a "
        "motion that dt does not resolve, need many: smooth the jump, use a smaller dt, or raise the budget",
        name, s->clock.time, budget, s->state.iteration, a->component[0].member->state.cuts.halved);
    return spari_fail(s, SPAR_ERR_NUMERIC,
                      "%s: Newton %s (%d iterations in several attempts, each of %d at most) in the step from t = %g; "
                      "use a smaller dt, more substeps or a smaller rho_inf, or check the loads",
                      name, wrong, iterations, s->newton.max, s->clock.time);
}

/* The states at the end of a substep. */
static int newton_all(spari_assembly *a, double s, double dt) {
    int iterations = 0;
    const char *wrong = attempts_of(a, s, dt, &iterations);
    if (wrong && a->constraints > 0 && !a->constrains_rates && !a->component[0].scheme.still) {
        a->constrains_rates = 1;
        wrong = attempts_of(a, s, dt, &iterations);
    }
    wrong = wrong ? walk_drives(a, s, dt, wrong, &iterations) : NULL;
    return wrong ? fail_newton(a, wrong, iterations) : SPAR_OK;
}

/* Generalised-alpha with constraints at position level has velocities that are off the constraints by -C h^2 times
   the rate of the acceleration, with C of (E1), because h v + h^2 ((1/2 - beta) b^n + beta b^{n+1}) is the whole
   increment. It begins smoothly if the velocities have this error from the beginning; else accelerations and
   multipliers oscillate with an amplitude of first order. At t^0 (time 0) the rates of the accelerations at the
   joints are those of a steady rotation, later those of the time since t^n. Returns 0 or 1. */
static int shift_for_alpha(spari_assembly *a, double cv, double time) {
    const spari_scheme *c = &a->component[0].alpha;
    double C = spari_scheme_error(c);
    for (int i = 0; i < a->constraints; i++) {
        spari_constraint *l = a->constraint + i;
        double jerk[12] = {0}, rate[6];
        for (int k = 0; k < 12; k += 3) {
            int side = k / 6;
            const spar_member *m = l->joint->member[side];
            if (l->component[side] && time > 0) {
                for (int j = k; j < k + 3; j++) {
                    jerk[j] = (l->a[j] - m->now.a[6 * l->joint->seat[side] + j % 6]) / time;
                }
            } else if (l->component[side] && k % 6 == 0) {
                spari_steady_rate(m, l->v + 6 * side + 3, l->a + k, jerk + k);
            }
        }
        spari_constraint_times(l->B, jerk, rate);
        const spari_relative found = l->joint->after;
        if (!(time > 0)) { /* those of rigid bodies are there already */
            spari_constraint_find(l, 0, 0, 1);
        }
        for (int k = 0; k < 6; k++) {
            double off = time > 0 ? 0 : spari_constraint_rate_gap(l, k);
            l->gap[k] = spari_constraint_holds(l, k) ? off + C * c->h * c->h * rate[k] : 0;
        }
        l->joint->after = found;
    }
    return spari_system_shift_rates(a, cv, 1, 0, 0);
}

/* Acceleration at t^0 of driven motion k, if the motion begins smoothly. Rate and acceleration at the end of the first
   step give a cubic, which has to meet the position there. Motions of degree 5 miss it by dt^2 (|z''^0| + |z''|) / 30,
   those given without accelerations by 1/12 or more, and impulsive ones by more. */
static int begins_smoothly(const spar_joint *j, int k, double dt, double *acceleration) {
    static const double most = 1.0 / 20;
    const spari_driven *from = &j->drive[0], *to = &j->drive[1];
    const double a = 2 * (to->rate[k] - from->rate[k]) / dt - to->acceleration[k],
                 met = from->z[k] + dt * from->rate[k] + dt * dt * (2 * a + to->acceleration[k]) / 6;
    *acceleration = a;
    return j->drive_given && (j->driven >> k & 1) &&
           fabs(to->z[k] - met) < most * dt * dt * (fabs(a) + fabs(to->acceleration[k]));
}

static double step_of(const spari_assembly *a) {
    return a->component[0].alpha.h * a->session->integrator.substeps;
}

/* The shift of velocities for the motion of driven joints in the first step; and the scheme's memory begins with b^0 =
   a^0 + (alpha_m - alpha_f) h a'^0 (Arnold & Bruls 2007). Returns 0 or 1. */
static int shift_for_drives(spari_assembly *a) {
    const spari_scheme *c = &a->component[0].alpha;
    const double dt = step_of(a);
    int moves = 0;
    for (int i = 0; i < a->constraints; i++) {
        const spar_joint *j = a->constraint[i].joint;
        for (int k = 0; k < 6; k++) {
            double begin, *gap = a->constraint[i].gap + k;
            *gap = spari_constraint_holds(a->constraint + i, k) && begins_smoothly(j, k, dt, &begin)
                       ? (j->drive[1].acceleration[k] - begin) / dt
                       : 0;
            moves = moves || *gap != 0;
        }
    }
    return moves &&
           spari_system_shift_rates(a, 0, spari_scheme_error(c) * c->h * c->h, 0, -(c->alpha_m - c->alpha_f) * c->h);
}

/* ---- consistent initial accelerations ---- */

enum { START_REFINEMENTS = 3 };

/* The residual of the balance at t^0 and of the constraints' accelerations. */
static void start_residual(spari_assembly *a, double cm) {
    for (int i = 0; i < a->constraints; i++) {
        spari_constraint *l = a->constraint + i;
        spari_constraint_find(l, 0, 0, 1);
        spari_constraint_find_force(l);
        spari_constraint_set_acceleration_gaps(l);
        for (int k = 0; k < 6; k++) {
            l->gap[k] /= cm;
        }
    }
    for (int i = 0; i < a->components; i++) {
        a->component[i].row->unbalance(a->component + i);
        spari_constraints_add_forces(a, a->component + i);
    }
}

/* At t^0 a driven motion begins with the motion of its members; later with the motion that it was driven to. */
static void begin_drive(spari_constraint *l, double dt) {
    spar_joint *j = l->joint;
    for (int k = 0; k < 6; k++) {
        if (j->session->clock.step == 0 && (j->driven >> k & 1)) {
            j->drive[0].z[k] = j->after.z[k];
            j->drive[0].rate[k] = j->after.rate[k];
            double smooth;
            j->drive[0].acceleration[k] = begins_smoothly(j, k, dt, &smooth) ? smooth : 0;
        }
    }
    l->drive = j->drive[0];
}

/* Finds consistent accelerations of the components and loads of the joints at t^0: those of the initial rigid-body
   field, and what the balance of forces requires beyond them, through M + K / cm instead of M. Parts that are stiff or
   light against this step (or have no mass at all) would start with accelerations that the step cannot follow. Each
   refinement solves for the remaining part. With z = omega^2 / cm a mode keeps 1 - (z / (1 + z))^4 of its
   acceleration. */
static int start_all(spari_assembly *a) {
    char name[NAME];
    double cm = a->component[0].scheme.cm;
    int singular = 0;
    for (int i = 0; i < a->components; i++) { /* all of them: constraints look at their states */
        singular = a->component[i].row->start(a->component + i) || singular;
    }
    for (int i = 0; i < a->constraints; i++) {
        spari_constraint_find(a->constraint + i, 0, 0, 1);
        begin_drive(a->constraint + i, step_of(a));
    }
    a->system_serves = 0;
    singular = singular || project(a, 0, 0);
    for (int k = 0; k <= START_REFINEMENTS && !singular; k++) {
        start_residual(a, cm);
        singular = spari_assembly_solve(a, 0);
        for (int i = 0; i < a->components && !singular; i++) {
            a->component[i].row->correct_start(a->component + i);
        }
        spari_constraints_correct_loads(a, 1);
    }
    for (int i = 0; i < a->components && !singular; i++) {
        a->component[i].row->end_start(a->component + i);
    }
    if (a->session->clock.step ==
        0) { /* later the accelerations that a trial begins with are not those of a steady motion */
        singular = singular || shift_for_alpha(a, 0, 0) || shift_for_drives(a);
    }
    a->factored = 0;
    spari_assembly_name(a, name, sizeof name);
    SPARI_REQUIRE(a->session, !singular, SPAR_ERR_NUMERIC,
                  "%s: mass and stiffness together are singular at the start; give mass or rotary inertia in every "
                  "direction of free motion",
                  name);
    for (int i = 0; i < a->constraints; i++) {
        spari_joint_balance(a->constraint[i].joint);
    }
    return SPAR_OK;
}

void spari_assembly_forget(spari_assembly *a) {
    a->factored = 0;
}

/* ---- the step ---- */

/* Keeps positions and velocities, and computes accelerations from the balance. In a frame that rotates, and in a
   rigid beam, the accelerations of nodes depend on the velocities. The loads belong to the velocities of the scheme. */
static void publish_component(spari_component *p, double *rates) {
    const spar_member *m = p->member;
    size_t size = (size_t)(6 * m->nodes) * sizeof *rates;
    if (m->row->whole) {
        m->row->publish(p->member);
        memcpy(rates, m->after.v, size);
    } else {
        spari_member_from_unique(m, 6, p->solver->to.v, rates);
    }
    spari_component_keep_rates(p, 1);
    m->row->publish(p->member);
    memcpy(m->after.v, rates, size);
}

static int fail_singular(const spari_assembly *a) {
    return spari_fail(
        a->session, SPAR_ERR_NUMERIC,
        "the members connected by joint '%s': found a singular tangent in the step from t = %g; use a smaller dt",
        a->constraint[0].joint->name, a->session->clock.time);
}

/* The published motion at the end of a step has velocities on the constraints. The scheme continues with its own
   velocities, which are off the constraints by dt^2. With projected velocities h^2 (1/2 - beta) b^n +
   h^2 beta b^{n+1} would have to compensate the whole local error of the positions. Accelerations and loads of joints
   would then be of first order only. */
static int publish_all(spari_assembly *a, double dt) {
    if (a->constraints == 0) {
        a->component[0].member->row->publish(a->component[0].member);
        return SPAR_OK;
    }
    int moves = !a->component[0].scheme.still;
    for (int i = 0; i < a->components; i++) {
        spari_component_keep_rates(a->component + i, 0);
    }
    int singular = moves && project(a, 1, dt);
    for (int i = 0; i < a->components; i++) {
        publish_component(a->component + i, a->rates);
    }
    singular = singular || spari_system_damp_constraints(a, 1, dt);
    return singular ? fail_singular(a) : SPAR_OK;
}

/* rad: with a larger rotation in a step, constraints at position level alone cause growing oscillations of the
   joints' loads. It is the rotation of the joints, and of their nodes, which carry the constrained directions. */
static const double farthest_rotation = 0.1, farthest_spin = 0.2;

/* In a long chain under tension, short members rotate to and fro in less than a step. Their oscillation grows,
   however small the rotation is (tests/stability/chains.c). So many joints with free motions are a long chain. */
enum { CHAIN = 8 };

static int makes_a_chain(const spari_assembly *a) {
    int joints = 0;
    for (int i = 0; i < a->constraints && joints < CHAIN; i++) {
        int holds = spari_constraint_count(a->constraint + i);
        joints += holds > 1 && holds < 6;
    }
    return joints >= CHAIN;
}

/* By the rates at the beginning of a step, in a substep h. */
static int rotates_far(const spari_assembly *a, double h) {
    int far = 0;
    for (int i = 0; i < a->constraints; i++) {
        const spar_joint *j = a->constraint[i].joint;
        far = far || (!j->kinematics.line && spari_norm(j->now.rate + 3) * h > farthest_rotation);
        for (int side = 0; side < 2 && !j->kinematics.line; side++) {
            const spar_member *m = j->member[side];
            far = far || (m && spari_norm(m->now.v + 6 * j->seat[side] + 3) * h > farthest_spin);
        }
    }
    return far;
}

static void begin_constraints(spari_assembly *a) {
    for (int i = 0; i < a->constraints; i++) {
        a->constraint[i].joint->after = a->constraint[i].joint->now;
    }
}

/* Joints whose nodes all have prescribed motion: their springs. */
void spari_assembly_look(spari_assembly *a, double dt) {
    begin_constraints(a);
    for (int i = 0; i < a->constraints; i++) {
        spari_constraint_find(a->constraint + i, 1, dt, 1);
    }
}

/* A step begins at t^n, in the first one with the accelerations there. */
static int begin_step(spari_assembly *a, double dt) {
    int started = 1;
    for (int i = 0; i < a->components; i++) {
        spari_component *p = a->component + i;
        started = p->row->take(p, dt / a->session->integrator.substeps) && started;
        p->alpha = p->scheme;
    }
    begin_constraints(a);
    if (a->components > 0 && !started && !a->component[0].scheme.still) {
        SPARI_TRY(start_all(a));
    }
    for (int i = 0; i < a->components; i++) {
        a->component[i].row->begin(a->component + i);
    }
    return SPAR_OK;
}

int spari_assembly_balance(spari_assembly *a, double dt) {
    if (!a->here) {
        return SPAR_OK;
    }
    SPARI_TRY(begin_step(a, dt));
    for (int i = 0; i < a->constraints && a->components == 0; i++) {
        spari_constraint_find(a->constraint + i, 0, 0, 1);
    }
    for (int i = 0; i < a->components; i++) {
        a->component[i].member->row->publish(a->component[i].member);
    }
    return SPAR_OK;
}

/* Tangents where the step has ended. */
static int form_after(spari_assembly *a) {
    for (int i = 0; i < a->components; i++) {
        spari_component *p = a->component + i;
        double power = p->solver->power;
        (void)p->row->balance(p);
        p->solver->power = power;
    }
    return form(a);
}

/* Energy stored in the springs of a joint, in the host's load and in the preload. */
static double potential_of(const spar_joint *j, double left, const double z[6]) {
    double sum = 0;
    for (int p = 0; p < 6; p++) {
        double force = j->preload[p] + spari_joint_load_at(j, p, left);
        for (int q = 0; q < 6; q++) {
            force -= 0.5 * j->stiffness[6 * p + q] * z[q];
        }
        sum -= force * z[p];
    }
    return sum;
}

/* Whether the work on all members and joints is known: not where something is driven, or a node of a joint has
   prescribed motion. */
static int knows_work(const spari_assembly *a) {
    for (int i = 0; i < a->components; i++) {
        const spari_component *p = a->component + i;
        if (p->frame || p->member->root == SPAR_ROOT_DRIVEN || p->member->added || p->solver->offset_loads) {
            return 0;
        }
    }
    for (int i = 0; i < a->constraints; i++) {
        const spari_constraint *l = a->constraint + i;
        const spar_joint *j = l->joint;
        int given = (!l->component[0] && j->member[0]) || (!l->component[1] && j->member[1]);
        if (given || j->driven || j->kinematics.line) {
            return 0;
        }
    }
    return 1;
}

/* Of all members and joints. */
static int gains_of_all(void *self, const spari_part *part) {
    spari_assembly *a = self;
    double gain = 0, size = 0;
    int near = !a->wandered;
    if (!knows_work(a)) {
        return 0;
    }
    for (int i = 0; i < a->components && near; i++) {
        const spari_component *p = a->component + i;
        near = spari_stage_is_near(p->solver, p->member, p->scheme.h);
    }
    if (near) {
        return 0;
    }
    for (int i = 0; i < a->constraints; i++) {
        const spari_constraint *l = a->constraint + i;
        const spar_joint *j = l->joint;
        double left = 1 - 0.5 * (part->from + part->to),
               correction_size = potential_of(j, left, j->after.z) - potential_of(j, left, l->begin.z);
        gain += correction_size;
        size += fabs(correction_size);
    }
    for (int i = 0; i < a->components; i++) {
        spari_component *p = a->component + i;
        double more, of;
        spari_stage_energy(p->solver, p->member, part, &more, &of);
        gain += more;
        size += of;
    }
    return gain > (a->wandered ? SPARI_GAIN_FAR : SPARI_GAIN) * size;
}

static void enter_all(void *self, const spari_part *part) {
    spari_assembly *a = self;
    (void)part;
    for (int i = 0; i < a->components; i++) {
        a->component[i].row->enter(a->component + i);
    }
    for (int i = 0; i < a->constraints; i++) {
        a->constraint[i].begin = a->constraint[i].joint->after;
    }
}

static double rotation_rate_of_all(const void *self) {
    const spari_assembly *a = self;
    double most = 0;
    for (int i = 0; i < a->components; i++) {
        const spari_component *p = a->component + i;
        most = fmax(most, p->frame ? 0 : spari_stage_rotation_rate(p->solver, p->member));
    }
    return most;
}

/* Coefficients of a stage, of each member by whether it has inertia. */
static void set_scheme(spari_assembly *a, const spari_scheme *c) {
    for (int i = 0; i < a->components; i++) {
        spari_component *p = a->component + i;
        const spari_scheme own = c->h < p->alpha.h ? spari_scheme_resize(&p->alpha, c->h) : p->alpha;
        p->scheme = c->rule == SPARI_ALPHA ? own : spari_scheme_stage(&own, c->rule);
    }
}

/* If dt changes, constraints hold at velocity level too (Gear, Gupta and Leimkuhler, J. Comput. Appl. Math. 12
   (1985)). At position level alone velocities are off the constraints by dt^2, which a shorter step turns into an
   acceleration of dt_old^2 / dt_new. */
static int stage_of_all(void *self, const spari_scheme *c, const spari_part *part) {
    spari_assembly *a = self;
    set_scheme(a, c);
    a->constrains_rates = a->rotates_far || c->rule != SPARI_ALPHA;
    a->wandered = a->wandered && c->rule == SPARI_BACKWARD;
    if (c->rule == SPARI_TRAPEZOIDAL) { /* positions depend on the tangent here, so it must
                                           not depend on earlier solutions */
        a->factored = 0;
    }
    for (int i = 0; i < a->components; i++) {
        spari_component *p = a->component + i;
        if (c->rule == SPARI_TRAPEZOIDAL && !(part->from > 0) && !part->again && a->constraints > 0) {
            spari_component_take_velocities(p);
        }
        SPARI_TRY(p->row->stage(p, part));
    }
    for (int i = 0; i < a->constraints; i++) {
        spari_joint_drive_at(a->constraint[i].joint, part->end, part->dt, &a->constraint[i].drive);
        a->constraint[i].joint->left = 1 - part->end;
    }
    return newton_all(a, part->end, part->dt);
}

static int finish_all(void *self, const spari_scheme *c, const spari_part *part) {
    spari_assembly *a = self;
    (void)c;
    if (part->to < 1 && spari_system_damp_constraints(a, part->to, part->dt)) {
        return fail_singular(a);
    }
    if (part->to < 1 && part->last && shift_for_alpha(a, a->component[0].scheme.cv, part->to * part->dt)) {
        return fail_singular(a);
    }
    for (int i = 0; i < a->components; i++) {
        a->component[i].row->end(a->component + i);
    }
    return SPAR_OK;
}

int spari_assembly_advance(spari_assembly *a, double dt, int responses) {
    static const spari_stepper how = {enter_all,  rotation_rate_of_all, stage_of_all,
                                      finish_all, gains_of_all,         spari_assembly_name};
    if (!a->here) {
        return SPAR_OK;
    }
    if (a->components == 0) {
        spari_assembly_look(a, dt);
        return SPAR_OK;
    }
    SPARI_TRY(begin_step(a, dt));
    a->rotates_far =
        !a->component[0].scheme.still && (makes_a_chain(a) || rotates_far(a, dt / a->session->integrator.substeps));
    spari_pattern pattern = a->component[0].steps->begin;
    int status = spari_substeps_run(&how, a, &a->component[0].alpha, &a->component[0].member->state.cuts, &pattern,
                                    a->session, dt);
    if (status != SPAR_OK) {
        a->factored = 0;
        return status;
    }
    for (int i = 0; i < a->components; i++) {
        a->component[i].steps->solved = pattern;
    }
    SPARI_TRY(publish_all(a, dt));
    if (a->component[0].scheme.rule == SPARI_BACKWARD && pattern.even == SPARI_EVEN - 1 &&
        shift_for_alpha(a, a->component[0].scheme.cv, dt)) {
        return fail_singular(a);
    }
    a->solved = 1;
    if (responses && !a->factored && form_after(a) == 0) {
        a->factored = 1;
        a->reuse.served = 0, a->reuse.spent = PRICE;
    }
    return SPAR_OK;
}

int spari_lone_balance(spar_member *m, double dt) {
    spari_component p = spari_component_of(m);
    spari_assembly a = spari_assembly_of_one(&p);
    return spari_assembly_balance(&a, dt);
}

static int advance_once(spar_member *m, double dt) {
    spari_component p = spari_component_of(m);
    spari_assembly a = spari_assembly_of_one(&p);
    return spari_assembly_advance(&a, dt, 0);
}

int spari_lone_advance(spar_member *m, double dt) {
    return m->row->repeat ? m->row->repeat(m, dt, advance_once) : advance_once(m, dt);
}

/* ---- response to loads ---- */

/* Whether the step was one of TR-BDF2, whose two stages respond one after the other. Of a step in several parts only
   the last one responds. */
static int has_two_stages(const spari_component *p) {
    return p->scheme.rule == SPARI_BACKWARD && spari_steps_are_equal(p->scheme.h, p->member->session->clock.dt);
}

static void get_response(spari_component *p, spari_response_of of, double *motion) {
    p->row->get_response(p, motion);
    if (of == SPARI_OF_VELOCITY && !has_two_stages(p)) {
        double rate = SPARI_DIAGONAL * p->member->session->clock.dt * p->scheme.rate;
        for (int64_t i = 0; i < 6 * p->member->nodes; i++) {
            motion[i] *= rate;
        }
    }
}

/* The part of the load that acts in the second stage. */
static double part_of_load(spari_response_of of) {
    return of == SPARI_OF_VELOCITY ? SPARI_DIAGONAL : 1;
}

int spari_lone_response(spar_member *m, spari_response_of of, const double *load, double *motion) {
    spari_component p = spari_component_of(m);
    p.row->restore_end(&p);
    if (p.row->tangent_after(&p)) {
        return 1;
    }
    p.row->apply_load(&p, load);
    if (p.row->solve(&p)) {
        return 1;
    }
    if (has_two_stages(&p)) {
        p.row->apply_load(&p, load);
        p.row->carry_over(&p, part_of_load(of));
        if (p.row->solve(&p)) {
            return 1;
        }
    }
    get_response(&p, of, motion);
    return 0;
}

/* The part of a member among the numbers of all members. */
static double *stacked_of(const spar_member *member, double *stacked) {
    for (const spar_member *m = member->session->members; m != member; m = m->next) {
        stacked += 6 * m->nodes;
    }
    return stacked;
}

static int has_loads(const spari_assembly *a, double *stacked) {
    for (int i = 0; i < a->components; i++) {
        const spar_member *m = a->component[i].member;
        const double *load = stacked_of(m, stacked);
        for (int64_t k = 0; k < 6 * m->nodes; k++) {
            if (load[k] != 0) {
                return 1;
            }
        }
    }
    return 0;
}

static int respond_in_stage(spari_assembly *a, spari_response_of of, int stage, double *stacked) {
    for (int i = 0; i < a->components; i++) {
        spari_component *p = a->component + i;
        p->row->apply_load(p, stacked_of(p->member, stacked));
        if (stage > 0) {
            p->row->carry_over(p, part_of_load(of));
        }
    }
    for (int i = 0; i < a->constraints; i++) {
        memset(a->constraint[i].gap, 0, sizeof a->constraint[i].gap);
    }
    return spari_system_solve(a, a->component[0].scheme.cv);
}

/* One response of these tangents, stacked. */
static int respond_once(spari_assembly *a, spari_response_of of, double *stacked) {
    const int stages = has_two_stages(a->component) ? 2 : 1;
    for (int stage = 0; stage < stages; stage++) {
        if (respond_in_stage(a, of, stage, stacked)) {
            return 1;
        }
    }
    for (int i = 0; i < a->components; i++) {
        get_response(a->component + i, of, stacked_of(a->component[i].member, stacked));
    }
    return 0;
}
/* Restores the components and constraints at the end of the step that was read from a file. The motions of joints
   stay: their rates are the published ones. */
static void restore_end(spari_assembly *a) {
    for (int i = 0; i < a->components; i++) {
        a->component[i].row->restore_end(a->component + i);
    }
    for (int i = 0; i < a->constraints; i++) {
        spar_joint *j = a->constraint[i].joint;
        const spari_relative before = j->after;
        spari_constraint_find(a->constraint + i, 1, a->session->clock.dt, 1);
        j->after = before;
    }
    a->solved = 1;
}

int spari_assembly_response(spari_assembly *a, spari_response_of of, int64_t count, int64_t stride, double *stacked) {
    if (!a->here || a->components == 0) {
        return 0;
    }
    if (!a->factored && (!a->solved || form_after(a))) {
        return 1;
    }
    if (!a->solved) {
        restore_end(a);
    }
    int singular = 0;
    a->system_serves = 0; /* the system was formed at slightly different positions */
    for (int64_t k = 0; k < count && !singular; k++) {
        singular = has_loads(a, stacked + k * stride) && respond_once(a, of, stacked + k * stride);
    }
    a->system_serves = 0;
    return singular;
}

double spari_assembly_mass_response(const spari_assembly *a) {
    double force = a->here && a->components > 0 ? a->component[0].scheme.cm * a->mass : 0;
    return force > 0 ? 1 / force : 0;
}

/* ---- calls of the host ---- */

int spar_member_get_iterations(const spar_member *member, int64_t *iterations, double *left) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_REQUIRE(NULL, member, SPAR_ERR_ARGUMENT, "%s: the member is NULL; create it first", __func__);
    spari_effort effort = {0};
    if (member->committed && member->row->effort && spari_fidelity_is_here(member)) {
        member->row->effort(member, &effort);
        effort.left = member->assembly ? spari_assembly_remaining(member->assembly) : effort.left;
    }
    if (iterations) {
        *iterations = effort.iterations;
    }
    if (left) {
        *left = effort.left;
    }
    return SPAR_OK;
}
