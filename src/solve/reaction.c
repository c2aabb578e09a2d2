/* What the root gives a member, and the energies of it. */
#include "reaction.h"

#include "../base/quiet.h"
#include "../member/applied.h"
#include "../member/body.h"
#include "../member/edge.h"
#include "rigid_beam.h"

#include <stdlib.h>
#include <string.h>

int spar_member_get_reaction(const spar_member *member, double load[6]) {
    SPARI_QUIET;
    SPARI_TRY(spari_need_committed(member, __func__));
    SPARI_REQUIRE(member->session, load, SPAR_ERR_ARGUMENT, "spar_member_get_reaction: '%s': load is NULL",
                  member->name);
    return spari_member_reaction(member, load);
}

int64_t spari_member_reaction_room(const spar_member *m) {
    return m->rung ? spari_rung_reaction_room(m) : m->body ? 25 * (int64_t)m->body->unique : 0;
}

void spari_member_reaction_in(const spar_member *m, double *room, double load[6]) {
    if (m->rung) {
        spari_rung_reaction(m, room, load);
        return;
    }
    memset(load, 0, 6 * sizeof *load);
    const spari_body *b = m->body;
    int held = m->root == SPAR_ROOT_FREE ? 0 : m->root == SPAR_ROOT_PINNED ? 3 : 6;
    if (!b || held == 0) {
        return;
    }
    int64_t n = b->unique;
    int still = !(m->effects & SPAR_EFFECT_INERTIA);
    double *q = room, *v = q + 7 * n, *a = v + 6 * n, *r = a + 6 * n;
    spari_member_to_unique(m, 7, m->after.q, q);
    spari_member_to_unique(m, 6, m->after.v, v);
    spari_member_to_unique(m, 6, m->after.a, a);
    spari_body_residual(b, q, still && !b->D ? NULL : v, still ? NULL : a, 1, r, NULL);
    if (m->applied) {
        spari_applied_residual(m, q, 1, r);
    }
    for (int i = 0; i < held; i++) { /* the root is node 0, which no joint repeats */
        load[i] = r[i] - m->load_solved[1][i];
    }
}

int spari_member_reaction(const spar_member *m, double load[6]) {
    double *room = spari_zalloc(spari_member_reaction_room(m), sizeof *room);
    SPARI_REQUIRE(m->session, room, SPAR_ERR_MEMORY, "member '%s': no memory for its reaction", m->name);
    spari_member_reaction_in(m, room, load);
    free(room);
    return SPAR_OK;
}

int spar_member_get_energy(const spar_member *member, double energy[4]) {
    SPARI_QUIET;
    SPARI_TRY(spari_need_committed(member, __func__));
    SPARI_REQUIRE(member->session, energy, SPAR_ERR_ARGUMENT, "spar_member_get_energy: '%s': energy is NULL",
                  member->name);
    memset(energy, 0, 4 * sizeof *energy);
    const spari_body *b = member->body;
    if (!b) {
        return SPAR_OK;
    }
    double *q = spari_zalloc(13 * (int64_t)b->unique, sizeof *q), *v = q + 7 * (int64_t)b->unique;
    SPARI_REQUIRE(member->session, q, SPAR_ERR_MEMORY, "spar_member_get_energy: no memory for '%s'", member->name);
    spari_member_to_unique(member, 7, member->after.q, q);
    spari_member_to_unique(member, 6, member->after.v, v);
    spari_body_energy(b, q, v, energy);
    energy[0] = member->effects & SPAR_EFFECT_INERTIA ? energy[0] : 0;
    energy[3] = member->dissipated;
    free(q);
    SPARI_REQUIRE(member->session, !member->rung || spari_rung_energy(member, energy) == SPAR_OK, SPAR_ERR_MEMORY,
                  "spar_member_get_energy: no memory for '%s'", member->name);
    return SPAR_OK;
}
