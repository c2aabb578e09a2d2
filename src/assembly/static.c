/* Static equilibrium of an assembly: Newton with exact tangents, in load steps that are halved where Newton fails.

   If the loads stabilise a motion that no stiffness holds (a body that hangs on a hinge), the tangent is singular
   until the joints' loads are known. Newton also goes to any equilibrium, even with a body upside down. In these
   cases a stiffness is added to every motion (a shift), large enough that the system is that of a minimum, which the
   count of its eigenvalues shows (Levenberg and Marquardt, with the inertia of the KKT system as in interior-point
   methods; Nocedal and Wright, Numerical Optimization (2006), theorem 16.3). The iteration then goes downhill, and
   the shift is 0 at its end. */
#include "assembly.h"

#include "../base/session.h"
#include "../math/rotation.h"
#include "../member/applied.h"
#include "rotation_check.h"
#include "system.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { REST_ITERATIONS = 60, REST_HALVINGS = 14 };

/* A system whose smallest pivot is below this part of its largest stiffness is singular apart from rounding. */
static const double loose = 1e-13;

/* Residual at the load factor f, and gaps with driven motions at the same part of their way. */
static double balance_at_rest(spari_assembly *a, double f, double *noise) {
    double scale = 0;
    for (int i = 0; i < a->components; i++) {
        scale = fmax(scale, a->component[i].row->balance_rest(a->component + i, f));
    }
    for (int i = 0; i < a->constraints; i++) {
        spari_constraint *l = a->constraint + i;
        const spar_joint *j = l->joint;
        spari_constraint_find(l, 1, 1, f);
        for (int k = 0; k < 6; k++) {
            l->drive.z[k] = j->now.z[k] + f * (j->drive[1].z[k] - j->now.z[k]);
            l->gap[k] = spari_constraint_holds(l, k) ? spari_constraint_gap(l, k) : 0;
            scale = fmax(scale, fabs(j->after.load[k]));
        }
    }
    spari_constraints_add_forces(a);
    *noise = 0;
    for (int i = 0; i < a->components; i++) {
        double left = a->component[i].row->noise(a->component + i);
        *noise = fmax(*noise, left);
        scale += 0 * left;
    }
    return scale;
}

/* Solves for the corrections of all components. Returns 0, or 1 if a motion is not constrained. */
static int solve_at_rest(spari_assembly *a, double f) {
    for (int i = 0; i < a->components; i++) {
        if (a->component[i].row->tangent_rest(a->component + i, f)) {
            return 1;
        }
    }
    spari_system_keep_joint_tangents(a);
    return spari_system_solve(a, 0);
}

/* Subtracts the corrections, shortened. Returns their size before. */
static double shift_parts(spari_assembly *a, double longest, double *cut) {
    double largest = 0;
    for (int i = 0; i < a->components; i++) {
        largest = fmax(largest, a->component[i].row->correction_size(a->component + i));
    }
    *cut = largest > longest ? longest / largest : 1;
    for (int i = 0; i < a->components; i++) {
        a->component[i].row->shift(a->component + i, *cut);
    }
    for (int i = 0; i < a->constraints; i++) {
        for (int k = 0; k < 6; k++) {
            a->constraint[i].joint->after.load[k] -= *cut * a->constraint[i].correction[k];
        }
    }
    return largest;
}

/* The largest correction of a joint's load. */
static double change_of_loads(const spari_assembly *a) {
    double largest = 0;
    for (int i = 0; i < a->constraints; i++) {
        for (int k = 0; k < 6; k++) {
            largest = fmax(largest, fabs(a->constraint[i].correction[k]));
        }
    }
    return largest;
}

/* Whether an iteration without motion is the last one. Joints' loads change the stiffness of the motions they
   connect, and a tangent with the former loads does not contain this. */
static int loads_stand(const spari_assembly *a, int it, double scale) {
    return it >= 3 || change_of_loads(a) <= 1e-6 * scale;
}

typedef enum rest { FOUND, FAILED, LOOSE, UNSTABLE } rest;

/* Whether all forces have a potential: no follower loads, no moments about fixed axes, no rotation. */
static int has_potential(const spari_assembly *a, const double *(*fluid)(const spar_member *)) {
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
    return !a->rotates;
}

/* Solves for the corrections with the smallest shift that makes the system that of a minimum: 0, or one of a
   sequence that grows by a factor of 4. *kept: the last shift that was not 0. Returns the fault of the system
   without a shift. */
static rest solve_downhill(spari_assembly *a, double f, double *kept) {
    enum { SHIFTS = 30 };
    rest why = FOUND;
    a->shift = 0;
    if (solve_at_rest(a, f) || spari_system_weakest_pivot(a) < loose) {
        why = LOOSE;
    } else if (spari_system_count_negative(a) > 0) {
        why = UNSTABLE;
    }
    double shift = 0.25 * *kept;
    for (int i = 0, wrong = why != FOUND; i < SHIFTS && wrong; i++, shift *= 4) {
        a->standing = 0;
        a->shift = *kept = shift;
        wrong = spari_system_solve(a, 0) || spari_system_weakest_pivot(a) < loose || spari_system_count_negative(a) > 0;
        if (wrong && i == SHIFTS - 1) {
            return FAILED;
        }
    }
    return why;
}

/* Finds a stable equilibrium at the load factor f from the states `to`, always downhill. LOOSE: a motion is not
   constrained there. UNSTABLE: the equilibrium found is unstable. */
static rest find_downhill(spari_assembly *a, double f) {
    enum { ITERATIONS = 400 };
    const double longest = 0.3;
    double last = 0, kept = 0;
    rest why = FOUND;
    for (int it = 0; it < ITERATIONS && why != FAILED; it++) {
        double noise, cut, scale = balance_at_rest(a, f, &noise);
        if (!isfinite(scale)) {
            return FAILED;
        }
        if (it == 0) {
            kept = 16 * (noise > 0 ? noise : 1) / spari_member_length(a->component[0].member);
        }
        why = solve_downhill(a, f, &kept);
        if (why == FAILED) {
            break;
        }
        double largest = shift_parts(a, longest, &cut);
        int small = cut == 1 && it >= 3 && (largest < 1e-9 || (largest < 1e-7 && last > 0 && largest > 0.5 * last));
        if (small) {
            return why;
        }
        last = largest;
    }
    return FAILED;
}

/* Whether the equilibrium is a maximum or a saddle, apart from motions without stiffness. */
static int is_unstable(spari_assembly *a, double f) {
    spari_blocks_watch(a->system, 1);
    int singular = solve_at_rest(a, f);
    spari_blocks_watch(a->system, 0);
    return !singular && spari_system_weakest_pivot(a) >= loose && spari_system_count_negative(a) > 0;
}

/* Equilibrium at the factor f from the states `to`. */
static rest find_rest_at(spari_assembly *a, double f) {
    double last = 0;
    a->shift = 0;
    for (int it = 0; it < REST_ITERATIONS; it++) {
        double noise, cut, scale = balance_at_rest(a, f, &noise);
        if (!isfinite(scale)) {
            return FAILED;
        }
        if (solve_at_rest(a, f) || spari_system_weakest_pivot(a) < loose) {
            return LOOSE;
        }
        double largest = shift_parts(a, 0.8, &cut);
        if (cut == 1 && loads_stand(a, it, scale) &&
            (largest < 1e-9 || (noise <= 16 * DBL_EPSILON * scale && largest < 1e-7) ||
             (largest < 1e-7 && last > 0 && largest > 0.5 * last))) {
            return a->potential && is_unstable(a, f) ? UNSTABLE : FOUND;
        }
        last = largest;
    }
    return FAILED;
}

/* The states and multipliers of the last point found. */
static void keep_point(spari_assembly *a, int back) {
    for (int i = 0; i < a->components; i++) {
        a->component[i].row->keep_positions(a->component + i, back);
    }
    for (int i = 0; i < a->constraints; i++) {
        spari_constraint *l = a->constraint + i;
        *(back ? &l->joint->after : &l->begin) = back ? l->begin : l->joint->after;
    }
}

/* Passes the loads to the components' solvers. onward: these keep their states, else they go to t^n. */
static void begin_rest(spari_assembly *a, const double *(*fluid)(const spar_member *), int onward) {
    for (int i = 0; i < a->components; i++) {
        a->component[i].rotating = a->rotates ? &a->rotating : NULL;
        a->component[i].row->rest(a->component + i, fluid(a->component[i].member), onward);
    }
    for (int i = 0; i < a->constraints && !onward; i++) {
        a->constraint[i].joint->after = a->constraint[i].joint->now;
    }
    keep_point(a, 0);
}

/* Why the load steps ended, and the motion that is not constrained or unstable. */
typedef struct rest_end {
    rest why;
    char motion[240];
} rest_end;

/* One load step: by Newton, and downhill where that finds nothing that lasts. */
static rest find_point(spari_assembly *a, double f, int first, rest_end *end) {
    rest found = find_rest_at(a, f), why = found;
    if (found == LOOSE || found == UNSTABLE) {
        spari_system_name_free(a, end->motion, sizeof end->motion);
    }
    if ((found == LOOSE && first) || found == UNSTABLE) {
        keep_point(a, 1);
        spari_blocks_watch(a->system, 1);
        found = find_downhill(a, f);
        spari_blocks_watch(a->system, 0);
        a->shift = 0;
        if (found == LOOSE || found == UNSTABLE) { /* where it has come to rest, that motion is the one */
            why = found;
            spari_system_name_free(a, end->motion, sizeof end->motion);
        }
    }
    end->why = found == FOUND ? FOUND : why;
    return end->why;
}

/* Load steps from 0 to the full load. Keeps the last point. Returns the part of the load that was reached. */
static double follow_loads(spari_assembly *a, int load_steps, rest_end *end) {
    double done = 0, step = 1.0 / load_steps;
    int halvings = 0;
    for (int attempts = 0; done < 1 && halvings <= REST_HALVINGS && attempts < load_steps + SPARI_STATIC_MORE;
         attempts++) {
        double f = done + step > 1 - 1e-12 ? 1 : done + step;
        rest found = find_point(a, f, done == 0, end);
        if (found == FOUND) {
            done = f;
            keep_point(a, 0);
            continue;
        }
        keep_point(a, 1);
        step *= 0.5;
        halvings += found == LOOSE && done == 0 ? REST_HALVINGS : 1;
    }
    return done;
}

static void give_up_rest(spari_assembly *a) {
    for (int i = 0; i < a->components; i++) {
        a->component[i].row->discard_rest(a->component + i);
    }
    spari_assembly_discard(a);
}

/* No equilibrium was found: restores everything. */
static int refuse_rest(spari_assembly *a, double done, const rest_end *end) {
    const char *motion = end->motion[0] ? end->motion : "some motion";
    char text[500] = "; use more load_steps";
    if (end->why == LOOSE) {
        (void)snprintf(text, sizeof text, ": %s is not constrained; constrain it by a joint or a spring", motion);
    } else if (end->why == UNSTABLE) {
        (void)snprintf(text, sizeof text,
                       ": the equilibrium is unstable in %s; start slightly away from it to find a stable one, or "
                       "constrain that motion by a joint or a spring",
                       motion);
    }
    give_up_rest(a);
    return spari_fail(a->session, SPAR_ERR_NUMERIC,
                      "the members connected by joint '%s': no %sequilibrium found beyond %.6g of the loads%s; "
                      "the state is unchanged",
                      a->constraint[0].joint->name, end->why == UNSTABLE ? "stable " : "", done, text);
}

/* Joints whose nodes all have prescribed motion: their springs. */
static int look_at_rest(spari_assembly *a) {
    for (int i = 0; i < a->constraints; i++) {
        spar_joint *j = a->constraint[i].joint;
        j->after = j->now;
        spari_constraint_find(a->constraint + i, 1, 1, 1);
    }
    return SPAR_OK;
}

static int find_equilibrium_of(spari_assembly *a, const double *(*fluid)(const spar_member *), int load_steps,
                               int onward) {
    rest_end end = {FAILED, ""};
    a->potential = has_potential(a, fluid);
    begin_rest(a, fluid, onward);
    double done = onward ? follow_loads(a, 1, &end) : 0;
    if (done < 1) {
        begin_rest(a, fluid, 0);
        end = (rest_end){FAILED, ""};
        done = follow_loads(a, load_steps, &end);
    }
    a->factored = 0;
    spari_snapshot_close(&a->before);
    if (done < 1) {
        return refuse_rest(a, done, &end);
    }
    for (int i = 0; i < a->components; i++) {
        a->component[i].row->end_rest(a->component + i);
    }
    for (int i = 0; i < a->constraints && !a->rotates; i++) {
        memset(a->constraint[i].joint->after.rate, 0, sizeof a->constraint[i].joint->after.rate);
    }
    return SPAR_OK;
}

int spari_assembly_static(spari_assembly *a, const double *(*fluid)(const spar_member *), int load_steps, int onward) {
    if (!a->here || a->components == 0) {
        return a->here ? look_at_rest(a) : SPAR_OK;
    }
    int status = spari_rotation_check_begin(a);
    status = status == SPAR_OK ? find_equilibrium_of(a, fluid, load_steps, onward) : status;
    if (status == SPAR_OK && a->rotates) {
        status = spari_rotation_check_joints(a);
        if (status != SPAR_OK) {
            give_up_rest(a);
        }
    }
    spari_rotation_check_end(a);
    return status;
}

void spari_assembly_commit_state(spari_assembly *a) {
    for (int i = 0; i < a->constraints; i++) {
        spar_joint *j = a->constraint[i].joint;
        j->now = j->after;
        memcpy(j->before, j->given, sizeof j->before);
        j->drive[0] = j->drive[1];
        for (int k = 0; k < 6; k++) { /* of what turns; else 0 */
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
