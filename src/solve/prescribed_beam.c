/* The prescribed beam: its nodes follow a prescribed root as one rigid body without mass. */
#include "../time/fidelity.h"
#include "reaction.h"
#include "rigid_nodes.h"

static int prescribed_check(const spar_member *m) {
    SPARI_REQUIRE(m->session, spari_member_root_is_prescribed(m), SPAR_ERR_STATE,
                  "member '%s' is prescribed and its root is free or pinned, so its motion is not defined; fix or "
                  "drive its root, or make it rigid",
                  m->name);
    return SPAR_OK;
}

static int prescribed_advance(spar_member *m, double dt) {
    const double rest[6] = {0};
    const spari_pose constrained = spari_pose_of(m->now.q, rest, rest);
    (void)dt; /* where it goes is given */
    spari_rigid_nodes_move(m, m->root == SPAR_ROOT_DRIVEN ? &m->drive[1] : &constrained, &m->after);
    return SPAR_OK;
}

const spari_fidelity spari_fidelity_prescribed = {
    .moves = 1,
    .prescribed_root = 1,
    .frame = SPARI_FRAME_PRESCRIBED,
    .check = prescribed_check,
    .advance = prescribed_advance,
    .equilibrium = spari_rigid_nodes_equilibrium,
    .reaction_size = spari_reaction_of_whole_size,
    .reaction = spari_reaction_of_whole,
};
