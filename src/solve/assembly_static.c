/* Members that joints tie together, in equilibrium: Newton with exact tangents, in load steps that halve where it
 * fails. */
#include "assembly.h"

#include "../base/scene.h"
#include "tied.h"
#include "turning.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { REST_ITERATIONS = 60, REST_HALVINGS = 14 };

/* A system whose weakest pivot is smaller than so much of its largest stiffness holds a motion by rounding alone. */
static const double loose = 1e-13;

/* Forces less loads at the factor f, gaps with driven motions so far on their way. */
static double balance_at_rest(spari_assembly *a, double f, double *noise) {
    double scale = 0;
    for (int i = 0; i < a->limbs; i++) {
        scale = fmax(scale, a->limb[i].row->balance_rest(a->limb + i, f));
    }
    for (int i = 0; i < a->links; i++) {
        spari_link *l = a->link + i;
        const spar_joint *j = l->joint;
        spari_link_find(l, 1, 1, f);
        for (int k = 0; k < 6; k++) {
            l->drive.z[k] = j->now.z[k] + f * (j->drive[1].z[k] - j->now.z[k]);
            l->gap[k] = l->row[k] >= 0 ? spari_link_gap(l, k) : 0;
            scale = fmax(scale, fabs(j->after.load[k]));
        }
    }
    spari_links_add(a);
    *noise = 0;
    for (int i = 0; i < a->limbs; i++) {
        double left = a->limb[i].row->noise(a->limb + i);
        *noise = fmax(*noise, left);
        scale += 0 * left;
    }
    return scale;
}

/* Corrections of all parts at rest; 0, or 1 where something is not held. */
static int solve_at_rest(spari_assembly *a, double f) {
    for (int i = 0; i < a->limbs; i++) {
        if (a->limb[i].row->tangent_rest(a->limb + i, f)) {
            return 1;
        }
    }
    spari_tied_keep(a);
    return spari_tied_solve(a, 0);
}

/* Shortened corrections come off; their size before. */
static double shift_parts(spari_assembly *a, double longest, double *cut) {
    double largest = 0;
    for (int i = 0; i < a->limbs; i++) {
        largest = fmax(largest, a->limb[i].row->change(a->limb + i));
    }
    *cut = largest > longest ? longest / largest : 1;
    for (int i = 0; i < a->limbs; i++) {
        a->limb[i].row->shift(a->limb + i, *cut);
    }
    for (int i = 0; i < a->links; i++) {
        for (int k = 0; k < 6; k++) {
            a->link[i].joint->after.load[k] -= *cut * a->link[i].correction[k];
        }
    }
    return largest;
}

/* The largest correction of a joint's load. */
static double change_of_loads(const spari_assembly *a) {
    double largest = 0;
    for (int i = 0; i < a->links; i++) {
        for (int k = 0; k < 6; k++) {
            largest = fmax(largest, fabs(a->link[i].correction[k]));
        }
    }
    return largest;
}

/* Whether an iteration that moves nothing is the last one: joints' loads hold or loosen what they tie, and a tangent
   with those of before says nothing of it. */
static int loads_stand(const spari_assembly *a, int it, double scale) {
    return it >= 3 || change_of_loads(a) <= 1e-6 * scale;
}

/* Equilibrium at the factor f from the states `to`; 0 or 1. */
static int find_rest_at(spari_assembly *a, double f, int *weak) {
    double last = 0;
    for (int it = 0; it < REST_ITERATIONS; it++) {
        double noise, cut, scale = balance_at_rest(a, f, &noise);
        *weak = 0;
        if (!isfinite(scale) || solve_at_rest(a, f)) {
            *weak = isfinite(scale) != 0;
            return 1;
        }
        if (spari_tied_weakest(a) < loose) {
            *weak = 1;
            return 1;
        }
        double largest = shift_parts(a, 0.8, &cut);
        if (cut == 1 && loads_stand(a, it, scale) &&
            (largest < 1e-9 || (noise <= 16 * DBL_EPSILON * scale && largest < 1e-7) ||
             (largest < 1e-7 && last > 0 && largest > 0.5 * last))) {
            return 0;
        }
        last = largest;
    }
    return 1;
}

/* The states and multipliers of the last point found. */
static void keep_point(spari_assembly *a, int back) {
    for (int i = 0; i < a->limbs; i++) {
        a->limb[i].row->keep_places(a->limb + i, back);
    }
    for (int i = 0; i < a->links; i++) {
        spari_link *l = a->link + i;
        *(back ? &l->joint->after : &l->begin) = back ? l->begin : l->joint->after;
    }
}

/* Loads into the parts' solvers, which stay where they are onward, else go to t^n. */
static void begin_rest(spari_assembly *a, const double *(*fluid)(const spar_member *), int onward) {
    for (int i = 0; i < a->limbs; i++) {
        a->limb[i].turning = a->turns ? &a->turning : NULL;
        a->limb[i].row->rest(a->limb + i, fluid(a->limb[i].member), onward);
    }
    for (int i = 0; i < a->links && !onward; i++) {
        a->link[i].joint->after = a->link[i].joint->now;
    }
    keep_point(a, 0);
}

/* Load steps from 0 to all of the loads, the last point kept. Returns the part reached; text: of
   what nothing holds. */
static double follow_loads(spari_assembly *a, int load_steps, char *text, int size) {
    double done = 0, step = 1.0 / load_steps;
    int halvings = 0, weak = 0;
    while (done < 1 && halvings <= REST_HALVINGS) {
        double f = done + step > 1 - 1e-12 ? 1 : done + step;
        if (find_rest_at(a, f, &weak) == 0) {
            done = f;
            keep_point(a, 0);
            continue;
        }
        if (weak) {
            spari_tied_name_free(a, text, size);
        }
        keep_point(a, 1);
        step *= 0.5;
        halvings += weak && done == 0 ? REST_HALVINGS : 1;
    }
    return done;
}

static void give_up_rest(spari_assembly *a) {
    for (int i = 0; i < a->limbs; i++) {
        a->limb[i].row->leave_rest(a->limb + i);
    }
    spari_assembly_leave(a);
}

/* Nothing has been found: all is as it was. */
static int refuse_rest(spari_assembly *a, double done, const char *text) {
    give_up_rest(a);
    return spari_fail(a->session, SPAR_ERR_NUMERIC,
                      "the members that joint '%s' ties together: no equilibrium found beyond %.6g of the loads%s%s; "
                      "the state is as it was",
                      a->link[0].joint->name, done, text[0] ? ": nothing holds " : "", text);
}

/* Joints whose nodes all move as they are told: their springs. */
static int look_at_rest(spari_assembly *a) {
    for (int i = 0; i < a->links; i++) {
        spar_joint *j = a->link[i].joint;
        j->after = j->now;
        spari_link_find(a->link + i, 1, 1, 1);
    }
    return SPAR_OK;
}

static int find_equilibrium_of(spari_assembly *a, const double *(*fluid)(const spar_member *), int load_steps,
                               int onward) {
    char text[240] = "";
    begin_rest(a, fluid, onward);
    double done = onward ? follow_loads(a, 1, text, sizeof text) : 0;
    if (done < 1) {
        begin_rest(a, fluid, 0);
        text[0] = '\0';
        done = follow_loads(a, load_steps, text, sizeof text);
    }
    a->factored = 0;
    if (done < 1) {
        return refuse_rest(a, done, text);
    }
    for (int i = 0; i < a->limbs; i++) {
        a->limb[i].row->end_rest(a->limb + i);
    }
    for (int i = 0; i < a->links && !a->turns; i++) {
        memset(a->link[i].joint->after.rate, 0, sizeof a->link[i].joint->after.rate);
    }
    return SPAR_OK;
}

int spari_assembly_static(spari_assembly *a, const double *(*fluid)(const spar_member *), int load_steps, int onward) {
    if (!a->here || a->limbs == 0) {
        return a->here ? look_at_rest(a) : SPAR_OK;
    }
    int status = spari_turning_begin(a);
    status = status == SPAR_OK ? find_equilibrium_of(a, fluid, load_steps, onward) : status;
    if (status == SPAR_OK && a->turns) {
        status = spari_turning_check(a);
        if (status != SPAR_OK) {
            give_up_rest(a);
        }
    }
    spari_turning_end(a);
    return status;
}

void spari_assembly_settle(spari_assembly *a) {
    for (int i = 0; i < a->links; i++) {
        spar_joint *j = a->link[i].joint;
        j->now = j->after;
        j->drive[0] = j->drive[1];
        for (int k = 0; k < 6; k++) { /* of what turns; else 0 */
            j->drive[0].rate[k] = j->driven >> k & 1 ? j->after.rate[k] : 0;
        }
        memset(j->drive[0].acceleration, 0, sizeof j->drive[0].acceleration);
    }
}

void spari_assembly_leave(spari_assembly *a) {
    for (int i = 0; i < a->links; i++) {
        spari_joint_reject(a->link[i].joint);
    }
}
