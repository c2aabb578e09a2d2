/* Warns once of fluids that are legal and probably wrong: nodes far from the member, forces that never come, velocities
   that nobody looks at. */
#include "../math/rotation.h"
#include "state.h"

#include <math.h>
#include <stdlib.h>

enum {
    WARNED_FAR = 1,
    WARNED_UNPUSHED = 2,
    WARNED_VELOCITY = 4,
    WARNED_FOLD = 8,
    WARNED_PRESENT = 16,
    WARNED_NO_FORCE_NODES = 32,
    STEPS_WITHOUT_PUSH = 2,      /* accepted steps before a missing push is reported */
    STEPS_WITHOUT_VELOCITY = 10, /* and before missing velocities are */
};

/* Largest lever arm of a set; *count: nodes whose arm is longer than the limit. */
static double farthest(const spari_nodes *s, double limit, int64_t *count) {
    double most = 0;
    *count = 0;
    for (int64_t p = 0; p < s->n; p++) {
        double d = sqrt(s->con[0][p] * s->con[0][p] + s->con[1][p] * s->con[1][p] + s->con[2][p] * s->con[2][p]);
        most = fmax(most, d);
        *count += d > limit;
    }
    return most;
}

void spari_fluid_warn_far(spar_fluid *fluid) {
    const spar_member *m = fluid->member;
    const spari_node_set *set = spari_fluid_set(fluid, SPAR_NODES_FORCE);
    int64_t count;
    if (m->kind != SPARI_BEAM || fluid->warned & WARNED_FAR || !set->nodes || set->sections) {
        return;
    }
    double length = spari_member_length(m), most = farthest(set->nodes, length, &count);
    if (count > 0) {
        fluid->warned |= WARNED_FAR;
        spari_warn(m->session,
                   "fluid '%s' of member '%s': %lld of %lld force nodes are farther from the line than the member is "
                   "long (up to %.3g m; length %.3g m); check the units of positions and the member's placement",
                   fluid->name, m->name, (long long)count, (long long)set->n, most, length);
    }
}

/* Largest displacement of the line. */
static double farthest_moved(const spar_member *m) {
    double most = 0;
    for (int64_t l = 0; l < m->nodes; l++) {
        most = fmax(most, spari_norm(m->after.q + 7 * l));
    }
    return most;
}

/* Mean square of the nodes' distances from the reference line. */
static double mean_square_from_reference(const spari_nodes *s) {
    double sum = 0;
    for (int64_t p = 0; p < s->n; p++) {
        sum += s->con[0][p] * s->con[0][p] + s->con[1][p] * s->con[1][p] + s->con[2][p] * s->con[2][p];
    }
    return sum / (double)s->n;
}

/* The same from the present line; HUGE_VAL: no memory. */
static double mean_square_from_present(const spar_fluid *fluid, const spari_nodes *s) {
    double *x = spari_fluid_positions(fluid, s), *nearest = spari_zalloc(3 * s->n, sizeof *nearest),
           *xi = spari_zalloc(s->n, sizeof *xi), sum = HUGE_VAL;
    int *element = spari_zalloc(s->n, sizeof *element);
    if (x && nearest && xi && element &&
        spari_fluid_project_on_present(fluid, s->n, x, element, xi, nearest) == SPAR_OK) {
        sum = 0;
        for (int64_t i = 0; i < 3 * s->n; i++) {
            sum += (x[i] - nearest[i]) * (x[i] - nearest[i]);
        }
    }
    SPARI_FREE(x, nearest, xi, element);
    return sum / (double)s->n;
}

/* A deformed mesh surrounds the present line. Where the line has moved by u, the mean square of its nodes' distances
   is d^2 from the present line and about d^2 + u^2 from the reference line; a mesh in the reference has it the other
   way round. The map of a deformed mesh is told where u exceeds d. */
void spari_fluid_warn_present(spar_fluid *fluid) {
    const spar_member *m = fluid->member;
    if (m->kind != SPARI_BEAM || fluid->warned & WARNED_PRESENT) {
        return;
    }
    double moved = farthest_moved(m);
    for (int which = 0; which < 2 && moved > 0; which++) {
        const spari_nodes *s = fluid->set[which].nodes;
        if (!s || s->n == 0 || fluid->set[which].sections) {
            continue;
        }
        double reference = mean_square_from_reference(s);
        if (moved < (1 - sqrt(0.5)) * sqrt(reference)) { /* the present line is not near enough for half */
            continue;
        }
        double present = mean_square_from_present(fluid, s);
        if (present < 0.5 * reference) {
            fluid->warned |= WARNED_PRESENT;
            spari_warn(m->session,
                       "fluid '%s' of member '%s': its %s nodes surround the member as it is now (%.3g m from the "
                       "line in the root mean square), not as in the reference (%.3g m); spar_fluid_map takes "
                       "reference positions: for nodes of a deformed mesh call spar_fluid_map_current",
                       fluid->name, m->name, which == SPAR_NODES_MOTION ? "motion" : "force", sqrt(present),
                       sqrt(reference));
            return;
        }
    }
}

/* Forces are pushed, and there has never been a set of force nodes, not even an empty one. */
void spari_fluid_warn_no_force_nodes(spar_fluid *fluid) {
    const spar_member *m = fluid->member;
    if (fluid->set[SPAR_NODES_MOTION].n == 0 || fluid->warned & WARNED_NO_FORCE_NODES) {
        return;
    }
    fluid->warned |= WARNED_NO_FORCE_NODES;
    spari_warn(m->session,
               "fluid '%s' of member '%s' has motion nodes and no force nodes: the forces that are pushed have no "
               "effect; call spar_fluid_set_force_nodes, with n = 0 if this rank has none",
               fluid->name, m->name);
}

void spari_fluid_warn_fold(spar_fluid *fluid, spari_fold fold) {
    const spari_fade *fade = fluid->set[SPAR_NODES_MOTION].fade;
    if (fold.jacobian > 0.2 || fluid->warned & WARNED_FOLD) {
        return;
    }
    fluid->warned |= WARNED_FOLD;
    spari_warn(fluid->member->session,
               "fluid '%s' of member '%s': the fade from %g to %g m leaves cells at motion node %lld %.0f %% of their "
               "volume; at 0 the mesh folds and the motion is refused; give spar_fluid_fade_motion a wider range",
               fluid->name, fluid->member->name, fade->within, fade->beyond, (long long)fold.node, 100 * fold.jacobian);
}

/* At the end of an accepted step. */
void spari_fluid_warn_step(spar_fluid *fluid) {
    const spar_member *m = fluid->member;
    int looks = fluid->asked & (SPARI_ASKED_POSITIONS | SPARI_MUTE_VELOCITY | SPARI_MUTE_POSES);
    if (fluid->steps == STEPS_WITHOUT_VELOCITY || m->session->state.trial) {
        return;
    }
    fluid->steps++;
    if (looks && !(fluid->asked & SPARI_ASKED_LOADS) && spari_fluid_set(fluid, SPAR_NODES_FORCE)->n > 0 &&
        fluid->steps >= STEPS_WITHOUT_PUSH && !(fluid->warned & WARNED_UNPUSHED)) {
        fluid->warned |= WARNED_UNPUSHED;
        spari_warn(m->session,
                   "fluid '%s' of member '%s' has force nodes, and its motion is pulled, but no forces were pushed in "
                   "%d steps, so it has no loads; call spar_fluid_push_forces, or map it without force nodes",
                   fluid->name, m->name, fluid->steps);
    }
    if (fluid->steps == STEPS_WITHOUT_VELOCITY && fluid->asked & SPARI_ASKED_LOADS && looks == SPARI_ASKED_POSITIONS &&
        !fluid->options.own_velocity && !m->external && m->kind != SPARI_POINT && m->effects & SPAR_EFFECT_INERTIA &&
        !(fluid->warned & WARNED_VELOCITY)) {
        fluid->warned |= WARNED_VELOCITY;
        spari_warn(
            m->session,
            "fluid '%s' of member '%s' pulls positions and no velocities: its loads do not damp the motion; pull "
            "v with spar_fluid_pull_motion. If the fluid needs none, or takes them from its "
            "moving mesh, set its option velocity = own",
            fluid->name, m->name);
    }
}
