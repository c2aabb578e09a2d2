/* Warns once of fluids that are legal and probably wrong: nodes far from the member, forces that never come, velocities
   that nobody looks at. */
#include "state.h"

#include <math.h>

enum {
    WARNED_FAR = 1,
    WARNED_UNPUSHED = 2,
    WARNED_VELOCITY = 4,
    WARNED_FOLD = 8,
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
