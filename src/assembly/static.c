/* Static equilibrium by Newton with exact tangents, in load steps that are halved where Newton fails.

   A member without joints: from a stable state on, the equilibria under growing dead forces form a path. On this path
   the tangent, the second derivative of a potential, is positive definite up to a limit or bifurcation point. A load
   step is halved if it ends beyond such a point, or if its iterations pass a tangent of negative determinant (a jump to
   another branch). If it cannot be halved any more, the point has been found. Moments about fixed axes and follower
   loads have no potential, and their paths are not watched: for example, only symmetry keeps a beam rolled up by a
   moment in its plane.

   An assembly: if the loads stabilise a motion that no stiffness holds (a body that hangs on a hinge), the tangent is
   singular until the joints' loads are known. Newton also converges to any equilibrium, even with a body upside down.
   In these cases a stiffness (shift) is added to every motion. It is large enough that the system is that of a minimum:
   the number of negative eigenvalues shows this (Levenberg and Marquardt, with the inertia of the KKT system as in
   interior-point methods; Nocedal and Wright, Numerical Optimization (2006), theorem 16.3). The iteration then goes
   downhill, and the shift is 0 at its end. */
#include "assembly.h"

#include "../base/session.h"
#include "../math/rotation.h"
#include "../member/applied_loads.h"
#include "../time/fidelity.h"
#include "rotation_check.h"
#include "system.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ITERATIONS = 60, HALVINGS = 14 };

/* Result of a load step: an equilibrium, or none. LOOSE: a motion is not constrained. UNSTABLE: the equilibrium does
   not last, or the path to it passes a limit or bifurcation point. LONG: it needs too many load steps. SPENT: the
   budget of Newton iterations is used up, or the host has cancelled. */
typedef enum outcome { FOUND, FAILED, LOOSE, UNSTABLE, LONG, SPENT } outcome;

/* An equilibrium to be found. */
typedef struct equilibrium {
    spari_assembly *a;
    const double *(*fluid)(const spar_member *);
    int64_t most;       /* Newton iterations of the call */
    int potential;      /* the loads have one, so the stability of an equilibrium is known */
    spari_linear *path; /* the tangent of a member without joints, if its path is watched */
    int on_path;        /* the last point is on the path */
    double unbalanced;  /* largest residual of the latest iterate; infinite if the loads have no potential */
    int loose;          /* a motion is not constrained where the iteration began or ended, not only on its way */
    double *before;     /* nodal forces that balance the first state without the loads; NULL: not known */
    char motion[240];   /* that is not constrained or unstable */
} equilibrium;

/* Whether there may be another iteration. */
static int allows(const equilibrium *t) {
    return spari_budget_allows(t->a->session, spari_assembly_spent(t->a), t->most);
}

/* Adds `part` of the forces that balance the first state. */
static void add_forces_before(const equilibrium *t, double part) {
    const double *from = t->before;
    for (int i = 0; i < t->a->components && from && part > 0; i++) {
        spari_solver *s = t->a->component[i].solver;
        for (int k = 0; s && k < 6 * s->n; k++) {
            s->r[k] -= part * *from++;
        }
    }
}

/* Residual at the load factor f, and gaps with driven motions at the same part of their way. */
static double balance_static(equilibrium *t, double f, double *residual_size) {
    spari_assembly *a = t->a;
    double scale = 0;
    for (int i = 0; i < a->components; i++) {
        scale = fmax(scale, a->component[i].row->balance_static(a->component + i, f));
    }
    for (int i = 0; i < a->constraints; i++) {
        spari_constraint *l = a->constraint + i;
        const spar_joint *j = l->joint;
        spari_constraint_find(l, 1, 1, f);
        spari_constraint_find_force(l);
        for (int k = 0; k < 6; k++) {
            l->drive.z[k] = j->now.z[k] + f * (j->drive[1].z[k] - j->now.z[k]);
            l->gap[k] = spari_constraint_holds(l, k) ? spari_constraint_gap(l, k) : 0;
            scale = fmax(scale, fabs(j->after.load[k]) / (k < 3 ? 1 : l->reach));
        }
    }
    for (int i = 0; i < a->components; i++) {
        spari_constraints_add_forces(a, a->component + i);
    }
    add_forces_before(t, 1 - f);
    *residual_size = 0;
    for (int i = 0; i < a->components; i++) {
        double left = a->component[i].row->residual_size(a->component + i);
        *residual_size = fmax(*residual_size, left);
        scale += 0 * left;
    }
    t->unbalanced = t->potential ? *residual_size : INFINITY;
    return scale;
}

/* Solves for the corrections of all components. Returns 0, or 1 if a motion is not constrained. */
static int solve_static(spari_assembly *a, double f) {
    for (int i = 0; i < a->components; i++) {
        if (a->component[i].row->tangent_static(a->component + i, f)) {
            return 1;
        }
    }
    a->system_serves = 0;
    return spari_assembly_solve(a, 0);
}

/* Subtracts the corrections, shortened. Returns their size before. */
static double correct_static(spari_assembly *a, double longest, double *cut) {
    double largest = 0;
    for (int i = 0; i < a->components; i++) {
        largest = fmax(largest, a->component[i].row->correction_size(a->component + i));
    }
    *cut = largest > longest ? longest / largest : 1;
    for (int i = 0; i < a->components; i++) {
        a->component[i].row->shift(a->component + i, *cut);
    }
    spari_constraints_correct_loads(a, *cut);
    return largest;
}

/* Whether an iteration with a correction of that size may be the last one. Joints' loads change the stiffness of the
   motions they connect, and a tangent with the former loads does not contain this. */
static int may_end(const spari_assembly *a, int it, double scale, double size) {
    double change = 0;
    for (int i = 0; i < a->constraints && it < 3; i++) {
        for (int k = 0; k < 6; k++) {
            change = fmax(change, fabs(a->constraint[i].correction[k]) / (k < 3 ? 1 : a->constraint[i].reach));
        }
    }
    return a->constraints == 0 || (change <= 1e-6 * scale && size < 1e-7);
}

/* Whether all loads have a potential: no follower loads, no moments about fixed axes. */
static int has_potential_loads(const spari_assembly *a, const double *(*fluid)(const spar_member *)) {
    for (int i = 0; i < a->components; i++) {
        const spar_member *m = a->component[i].member;
        const double *other = fluid(m);
        for (int64_t k = 0; k < m->nodes; k++) {
            if (spari_norm(m->load.dead + 6 * k + 3) > 0 || spari_norm(other + 6 * k + 3) > 0) {
                return 0;
            }
        }
        if (m->load.applied && !spari_applied_potential(m)) {
            return 0;
        }
    }
    return 1;
}

/* Solves for the corrections with the smallest shift that makes the system that of a minimum: 0, or one of a
   sequence that grows by a factor of 4. *last_shift: the last shift that was not 0. Returns the fault of the system
   without a shift. */
static outcome solve_downhill(equilibrium *t, double f, double *last_shift) {
    spari_assembly *a = t->a;
    enum { SHIFTS = 30 };
    outcome why = FOUND;
    a->shift = 0;
    if (solve_static(a, f) || spari_system_is_loose(a, t->unbalanced)) {
        why = LOOSE;
    } else if (spari_system_count_negative(a) > 0) {
        why = UNSTABLE;
    }
    double shift = 0.25 * *last_shift;
    for (int i = 0, wrong = why != FOUND; i < SHIFTS && wrong; i++, shift *= 4) {
        a->system_serves = 0;
        a->shift = *last_shift = shift;
        wrong =
            spari_system_solve(a, 0) || spari_system_count_negative(a) > 0 || spari_system_is_loose(a, t->unbalanced);
        if (wrong && i == SHIFTS - 1) {
            return FAILED;
        }
    }
    return why;
}

/* Finds a stable equilibrium at the load factor f from the states `to`, always downhill. LOOSE: a motion is
   not constrained there. UNSTABLE: the equilibrium found is unstable. */
static outcome find_downhill(equilibrium *t, double f) {
    spari_assembly *a = t->a;
    enum { DOWNHILL = 400 };
    const double longest = 0.3;
    double last = 0, last_shift = 0;
    outcome why = FOUND;
    for (int it = 0; it < DOWNHILL && why != FAILED; it++) {
        if (!allows(t)) {
            return SPENT;
        }
        double residual_size, cut, scale = balance_static(t, f, &residual_size);
        if (!isfinite(scale)) {
            return FAILED;
        }
        if (it == 0) {
            last_shift = residual_size > 0 ? 16 * residual_size / spari_member_length(a->component[0].member)
                                           : DBL_EPSILON * a->scale[0];
        }
        why = solve_downhill(t, f, &last_shift);
        if (why == FAILED) {
            break;
        }
        double largest = correct_static(a, longest, &cut);
        int small = cut == 1 && it >= 3 && (largest < 1e-9 || (largest < 1e-7 && last > 0 && largest > 0.5 * last));
        if (small) {
            return why;
        }
        last = largest;
    }
    return FAILED;
}

/* ---- a load step ---- */

/* Whether the equilibrium is stable: no maximum or saddle, apart from motions without stiffness. */
static outcome judge(equilibrium *t, double f) {
    spari_assembly *a = t->a;
    if (t->path) {
        return a->component[0].row->definite_static(a->component, f) == 0 ? UNSTABLE : FOUND;
    }
    if (!t->potential || a->constraints == 0) {
        return FOUND;
    }
    spari_blocks_watch(a->system, 1);
    int singular = solve_static(a, f);
    spari_blocks_watch(a->system, 0);
    int unstable = !singular && spari_system_count_negative(a) > 0 && !spari_system_is_loose(a, t->unbalanced);
    return unstable ? UNSTABLE : FOUND;
}

/* By Newton from the present state. */
static outcome find_nearby(equilibrium *t, double f) {
    const double longest = 0.8; /* a correction rotates no node by more (rad), and moves it by no more of the length */
    spari_assembly *a = t->a;
    double last = 0;
    a->shift = 0;
    for (int it = 0; it < ITERATIONS; it++) {
        if (!allows(t)) {
            return SPENT;
        }
        double residual_size, cut, scale = balance_static(t, f, &residual_size);
        if (!isfinite(scale)) {
            return FAILED;
        }
        int singular = solve_static(a, f);
        if (a->constraints > 0 && (singular || spari_system_is_loose(a, t->unbalanced))) {
            t->loose = it == 0;
            return LOOSE;
        }
        if (singular || (t->path && t->on_path && spari_linear_sign(t->path) < 0)) {
            return singular ? FAILED : UNSTABLE;
        }
        double size = correct_static(a, longest, &cut);
        /* quadratic: a correction of 1e-8 leaves 1e-16; or the balance is as good as rounding lets it be */
        int found =
            size < 1e-9 || residual_size <= 16 * DBL_EPSILON * scale || (size < 1e-7 && last > 0 && size > 0.5 * last);
        if (found && cut == 1 && may_end(a, it, scale, size)) {
            return judge(t, f);
        }
        last = size;
    }
    return FAILED;
}

/* The states and multipliers of the last point found. */
static void keep_point(equilibrium *t, int back) {
    spari_assembly *a = t->a;
    t->on_path = 1;
    for (int i = 0; i < a->components; i++) {
        a->component[i].row->keep_positions(a->component + i, back);
    }
    for (int i = 0; i < a->constraints; i++) {
        spari_constraint *l = a->constraint + i;
        *(back ? &l->joint->after : &l->begin) = back ? l->begin : l->joint->after;
    }
}

/* Solves a load step by Newton; in an assembly, downhill if Newton finds no stable equilibrium. first: no point has
   been found yet. */
static outcome find_point(equilibrium *t, double f, int first) {
    spari_assembly *a = t->a;
    outcome found = find_nearby(t, f), why = found;
    if (a->constraints == 0) {
        return found;
    }
    if (found == LOOSE || found == UNSTABLE) {
        spari_system_name_free(a, t->motion, sizeof t->motion);
    }
    if ((found == LOOSE && first) || found == UNSTABLE) {
        keep_point(t, 1);
        spari_blocks_watch(a->system, 1);
        found = find_downhill(t, f);
        spari_blocks_watch(a->system, 0);
        a->shift = 0;
        if (found == LOOSE || found == UNSTABLE) { /* where the downhill iteration has ended */
            why = found;
            t->loose = found == LOOSE;
            spari_system_name_free(a, t->motion, sizeof t->motion);
        }
    }
    return found == FOUND || found == SPENT ? found : why;
}

/* ---- the load steps ---- */

/* Begins from the last shapes (onward), else from t^n. before: receives the forces that balance this state without the
   loads, so that the path begins there; NULL: the loads begin at 0. Returns whether they count. */
static int begin_equilibrium(equilibrium *t, int onward, double *before) {
    spari_assembly *a = t->a;
    double stiffest = 0, residual_size;
    for (int i = 0; i < a->components; i++) {
        a->component[i].rotating = a->rotates ? &a->rotating : NULL;
        a->component[i].row->begin_static(a->component + i, t->fluid(a->component[i].member), onward);
        stiffest = a->component[i].body ? fmax(stiffest, a->component[i].body->stiffest) : stiffest;
    }
    for (int i = 0; i < a->constraints && !onward; i++) {
        a->constraint[i].joint->after = a->constraint[i].joint->now;
    }
    t->motion[0] = 0;
    t->before = NULL;
    keep_point(t, 0);
    if (onward) {
        t->on_path = !t->path;
        return 0;
    }
    int finite = isfinite(balance_static(t, 0, &residual_size)), loaded = !(residual_size <= 1e-9 * stiffest);
    t->on_path = !t->path || (finite && !loaded);
    double *to = before;
    for (int i = 0; i < a->components && before && finite; i++) {
        const spari_solver *s = a->component[i].solver;
        spari_give(to, s ? s->r : NULL, s ? 6 * s->n : 0);
        to += s ? 6 * s->n : 0;
    }
    t->before = finite ? before : NULL;
    return loaded;
}

/* Keeps the last point. Returns the part of the load that was reached. */
static double follow_loads(equilibrium *t, int load_steps, outcome *why) {
    double done = 0, step = 1.0 / load_steps;
    int halvings = 0, left = load_steps + SPARI_STATIC_MORE;
    while (done < 1 && halvings <= HALVINGS) {
        if (left-- == 0) {
            *why = LONG;
            break;
        }
        double f = done + step > 1 - 1e-12 ? 1 : done + step;
        *why = find_point(t, f, done == 0);
        keep_point(t, *why != FOUND);
        if (*why == FOUND) {
            done = f;
            continue;
        }
        if (*why == SPENT) {
            break;
        }
        step *= 0.5;
        halvings += *why == LOOSE && t->loose && done == 0 ? HALVINGS : 1;
    }
    return done;
}

/* From t^n: along a path that begins in this state, with the loads that balance it. If this ends before the loads are
   reached, from loads of 0. */
static double follow_loads_from_state(equilibrium *t, int load_steps, outcome *why) {
    int64_t count = 0;
    for (int i = 0; i < t->a->components; i++) {
        count += t->a->component[i].solver ? 6 * t->a->component[i].solver->n : 0;
    }
    double *before = spari_zalloc(count, sizeof *before);
    int loaded = begin_equilibrium(t, 0, before);
    double done = follow_loads(t, load_steps, why);
    if (done < 1 && loaded && before) {
        outcome other;
        char motion[sizeof t->motion];
        memcpy(motion, t->motion, sizeof motion);
        (void)begin_equilibrium(t, 0, NULL);
        if (follow_loads(t, load_steps, &other) < 1) {
            memcpy(t->motion, motion, sizeof motion);
            *why = other == SPENT ? SPENT : *why;
        } else {
            done = 1;
        }
    }
    free(before);
    t->before = NULL;
    return done;
}

static void give_up_equilibrium(spari_assembly *a) {
    for (int i = 0; i < a->components; i++) {
        a->component[i].row->discard_static(a->component + i);
    }
    spari_assembly_discard(a);
}

/* The largest rotation between neighbouring nodes, rad; 0 of linear members. */
static double largest_bend(const spari_component *p) {
    double largest = 0;
    for (int i = 1; p->solver && i < p->solver->n; i++) {
        double rotation[4], psi[3];
        spari_quat_between(p->solver->to.q + 7 * i - 4, p->solver->to.q + 7 * i + 3, rotation);
        spari_quat_log(rotation, psi);
        largest = fmax(largest, spari_norm(psi));
    }
    return largest;
}

/* With a larger rotation between nodes, the shape between them is not determined. A circle of 5 revolutions on 24 nodes
   (2.1 rad) is accurate to 5e-4, one of 7 revolutions (3 rad) is another curve. If Newton has failed, 1 rad suffices
   for this message: 10 nodes of an element fail at 1.7 rad. */
static const double most_bend = 2.2, suspect_bend = 1;

static void say_why_alone(const equilibrium *t, outcome why, char *text, size_t size) {
    double bend = largest_bend(t->a->component);
    (void)snprintf(text, size, ": a limit point, or a member free to move as a rigid body; apply smaller loads");
    if (why == UNSTABLE) {
        (void)snprintf(text, size,
                       ": a limit or bifurcation point, where the stiffness is not positive definite; apply smaller "
                       "loads, or run time steps");
    } else if (bend > suspect_bend) {
        (void)snprintf(text, size,
                       ": neighbouring nodes are rotated by %.2g rad relative to each other, more than the elements "
                       "resolve; give the beam more nodes or elements",
                       bend);
    }
}

/* No equilibrium was found: restores everything. */
static int refuse_equilibrium(const equilibrium *t, double done, outcome why) {
    const char *motion = t->motion[0] ? t->motion : "some motion";
    char text[500] = "; use more load_steps", name[160];
    if (t->a->constraints == 0 && why != LONG) {
        say_why_alone(t, why, text, sizeof text);
    } else if (why == LOOSE) {
        (void)snprintf(
            text, sizeof text,
            ": %s is not constrained; constrain it by a joint or a spring; the stiffness of a fluid does not count",
            motion);
    } else if (why == UNSTABLE) {
        (void)snprintf(text, sizeof text,
                       ": the equilibrium is unstable in %s; start slightly away from it to find a stable one, or "
                       "constrain that motion by a joint or a spring",
                       motion);
    }
    give_up_equilibrium(t->a);
    spari_assembly_name(t->a, name, sizeof name);
    if (why == SPENT) {
        SPARI_TRY(spari_budget_cancelled(t->a->session, name, spari_assembly_spent(t->a)));
        return spari_fail(
            t->a->session, SPAR_ERR_LIMIT,
            "%s: the static solution has used its budget of %lld Newton iterations (option newton.budget, "
            "for each of the load_steps) and found no equilibrium beyond %.6g of the loads; use more "
            "load_steps or raise the budget; the state is unchanged",
            name, (long long)t->most, done);
    }
    return spari_fail(t->a->session, SPAR_ERR_NUMERIC,
                      "%s: no %sequilibrium found beyond %.6g of the loads%s; the state is unchanged", name,
                      why == UNSTABLE ? "stable " : "", done, text);
}

static int find_equilibrium_of(equilibrium *t, int load_steps, int onward) {
    spari_assembly *a = t->a;
    outcome why = FAILED;
    double done = 0;
    t->most = load_steps * (int64_t)a->session->newton.budget;
    t->potential = !a->rotates && has_potential_loads(a, t->fluid);
    if (onward) {
        (void)begin_equilibrium(t, 1, NULL);
        done = follow_loads(t, 1, &why);
    }
    if (done < 1) {
        done = follow_loads_from_state(t, load_steps, &why);
    }
    a->factored = 0;
    a->stepping = a->formed = 0;
    if (done < 1) {
        return refuse_equilibrium(t, done, why);
    }
    for (int i = 0; i < a->components; i++) {
        a->component[i].row->end_static(a->component + i);
    }
    for (int i = 0; i < a->constraints && !a->rotates; i++) {
        memset(a->constraint[i].joint->after.rate, 0, sizeof a->constraint[i].joint->after.rate);
    }
    return SPAR_OK;
}

int spari_assembly_static(spari_assembly *a, const double *(*fluid)(const spar_member *), int load_steps, int onward) {
    if (!a->here) {
        return SPAR_OK;
    }
    if (a->components == 0) {
        spari_assembly_look(a, 1);
        return SPAR_OK;
    }
    int status = spari_rotation_check_begin(a);
    status =
        status == SPAR_OK ? find_equilibrium_of(&(equilibrium){.a = a, .fluid = fluid}, load_steps, onward) : status;
    if (status == SPAR_OK && a->rotates) {
        status = spari_rotation_check_joints(a);
        if (status != SPAR_OK) {
            give_up_equilibrium(a);
        }
    }
    spari_rotation_check_end(a);
    return status;
}

/* ---- equilibrium of one member ---- */

/* An equilibrium of the nodes need not be one of the beam. */
static void warn_of_bend(const spari_component *p) {
    const spar_member *m = p->member;
    double bend = largest_bend(p);
    if (bend > most_bend) {
        spari_warn(m->session,
                   "static equilibrium of '%s': neighbouring nodes are rotated by %.2g rad relative to each other, "
                   "more than the elements resolve; the result may be wrong; give the beam more nodes or elements",
                   m->name, bend);
    }
}

int spari_lone_static(spar_member *m, const double *(*fluid)(const spar_member *), int load_steps, int onward) {
    const int64_t P = m->mesh.per_element;
    spari_component p = spari_component_of(m);
    spari_assembly a = spari_assembly_of_one(&p);
    equilibrium t = {.a = &a, .fluid = fluid};
    int linear = p.frame != NULL;
    SPARI_REQUIRE(m->session, !linear || spari_member_constrained(m) == 6, SPAR_ERR_STATE,
                  "member '%s': a linear member cannot have a root that is free to rotate; fix or drive its root",
                  m->name);
    a.rotating.mass = spari_zalloc(36 * P * P, sizeof(double));
    a.rotates = m->root == SPAR_ROOT_DRIVEN && spari_rotating_frame_of(m, &m->now, &a.rotating);
    t.path = !linear && m->root != SPAR_ROOT_PINNED && has_potential_loads(&a, fluid) ? p.solver->linear : NULL;
    if (!a.rotating.mass || (t.path && spari_linear_watch(t.path))) {
        free(a.rotating.mass);
        return spari_fail(m->session, SPAR_ERR_MEMORY, "member '%s': no memory for its equilibrium", m->name);
    }
    int status = find_equilibrium_of(&t, linear ? 1 : load_steps, !linear && onward);
    if (t.path) {
        spari_linear_unwatch(t.path);
    }
    free(a.rotating.mass);
    SPARI_TRY(status);
    if (spari_first_nonfinite(m->after.q, 7 * m->nodes) >= 0 || spari_first_nonfinite(m->after.a, 6 * m->nodes) >= 0) {
        p.row->discard_static(&p);
        return spari_fail(m->session, SPAR_ERR_NUMERIC,
                          "member '%s': its equilibrium is not finite; check its loads and the motion of its root",
                          m->name);
    }
    warn_of_bend(&p);
    return SPAR_OK;
}

/* ---- commit the state ---- */

void spari_assembly_commit_state(spari_assembly *a) {
    for (int i = 0; i < a->constraints; i++) {
        spar_joint *j = a->constraint[i].joint;
        j->now = j->after;
        memcpy(j->before, j->given, sizeof j->before);
        j->drive[0] = j->drive[1];
        for (int k = 0; k < 6; k++) { /* of driven motions; else 0 */
            j->drive[0].rate[k] = j->driven >> k & 1 ? j->after.rate[k] : 0;
        }
        memset(j->drive[0].acceleration, 0, sizeof j->drive[0].acceleration);
    }
}

void spari_assembly_discard(spari_assembly *a) {
    for (int i = 0; i < a->constraints; i++) {
        spari_joint_reject(a->constraint[i].joint);
    }
}
