/* The reaction at the root of a member, and the energies of the member. */
#include "reaction.h"

#include "../base/environment.h"
#include "../math/rotation.h"
#include "../member/applied_loads.h"
#include "../member/body.h"
#include "../member/check_arguments.h"
#include "../member/joint.h"
#include "../member/plane.h"
#include "../member/section_resultants.h"
#include "../time/fidelity.h"

#include <stdlib.h>
#include <string.h>

int spar_member_get_reaction(const spar_member *member, double load[6]) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_TRY(spari_need_committed(member, __func__));
    SPARI_REQUIRE(member->session, load, SPAR_ERR_ARGUMENT, "%s: '%s': load is NULL", __func__, member->name);
    double *workspace = spari_zalloc(spari_member_reaction_size(member), sizeof *workspace);
    SPARI_REQUIRE(member->session, workspace, SPAR_ERR_MEMORY, "%s: '%s': no memory for its reaction", __func__,
                  member->name);
    spari_member_reaction_in(member, workspace, load);
    free(workspace);
    return SPAR_OK;
}

int64_t spari_member_reaction_size(const spar_member *m) {
    return m->row->reaction_size ? m->row->reaction_size(m) : 0;
}

void spari_member_reaction_in(const spar_member *m, double *workspace, double load[6]) {
    if (m->row->reaction) {
        m->row->reaction(m, workspace, load);
    } else {
        memset(load, 0, 6 * sizeof *load);
    }
}

int64_t spari_reaction_of_whole_size(const spar_member *m) {
    return (m->body ? 31 * (int64_t)m->body->unique : 0) + 18 * m->nodes;
}

/* sum [nodes][6] += forces r of the unique nodes, once where two elements meet. */
static void add_once(const spar_member *m, const double *r, double *sum, double *workspace) {
    spari_member_from_unique(m, 6, r, workspace);
    for (int64_t i = 0; i < m->nodes; i++) {
        const int shared = i > 0 && i % m->mesh.per_element == 0;
        for (int k = 0; k < 6 && !shared; k++) {
            sum[6 * i + k] += workspace[6 * i + k];
        }
    }
}

/* Inertia less weight at the nodes. weight: NULL, or the weight of a linear member at rest apart, where the nodes are:
   the equations have its moments there (frame.h), those of all other forces at the reference. */
static void inertia_of_whole(const spar_member *m, double *workspace, double *sum, double *weight) {
    const int64_t n = m->body->unique;
    const int still = !(m->effects & SPAR_EFFECT_INERTIA);
    spari_body loose = *m->body; /* the sum and moment of internal forces are zero */
    loose.C = loose.D = loose.pre = NULL;
    loose.mass_damping = 0;
    double *r = workspace + 25 * n, *spread = r + 6 * n;
    const spari_inertial at = {workspace, workspace + 7 * n, workspace + 13 * n, workspace + 19 * n, still};
    if (!loose.mass) {
        return;
    }
    spari_inertial_fill(m, &at);
    spari_body_residual(&loose, at.q, still ? NULL : at.v, still ? NULL : at.a, weight ? 0 : 1, r, NULL);
    add_once(m, r, sum, spread);
    if (weight) {
        spari_member_to_unique(m, 7, m->after.q, at.q);
        spari_body_residual(&loose, at.q, NULL, NULL, 1, r, NULL);
        add_once(m, r, weight, spread);
    }
}

/* load += f and its moment about the root, at the node's reference or, moved, where it is. */
static void add_about_root(const spar_member *m, int64_t node, int moved, const double f[6], double load[6]) {
    double arm[3], moment[3];
    for (int k = 0; k < 3; k++) {
        arm[k] = m->xr[3 * node + k] - m->xr[k] + (moved ? m->after.q[7 * node + k] - m->after.q[k] : 0);
    }
    spari_cross(arm, f, moment);
    for (int k = 0; k < 3; k++) {
        load[k] += f[k];
        load[3 + k] += f[3 + k] + moment[k];
    }
}

void spari_reaction_of_whole(const spar_member *m, double *workspace, double load[6]) {
    const int constrained = spari_member_constrained(m), undeformed = spari_member_is_undeformed(m);
    const int apart = undeformed && m->body && spari_norm(m->body->gravity) > 0;
    double *sum = workspace + (m->body ? 31 * (int64_t)m->body->unique : 0) + 6 * m->nodes, *other = sum + 6 * m->nodes;
    memset(load, 0, 6 * sizeof *load);
    if (constrained == 0) {
        return;
    }
    memset(workspace, 0, (size_t)spari_reaction_of_whole_size(m) * sizeof *workspace);
    if (m->body) {
        inertia_of_whole(m, workspace, sum, apart ? other : NULL);
    }
    for (int64_t i = 0; i < m->nodes && apart; i++) {
        add_about_root(m, i, 1, other + 6 * i, load);
    }
    if (spari_carries_loads(m)) {
        memset(other, 0, (size_t)(6 * m->nodes) * sizeof *other);
        spari_applied_nodal(m, m->after.q, other);
        for (int64_t i = 0; i < 6 * m->nodes; i++) {
            sum[i] -= other[i];
        }
    }
    for (int64_t i = 0; i < m->nodes; i++) {
        double f[6], joint_load[6] = {0};
        if (!m->external) { /* its loads have them */
            spari_joints_on(m, i, joint_load);
        }
        for (int k = 0; k < 6; k++) {
            f[k] = sum[6 * i + k] - m->load.solved[1][6 * i + k] - joint_load[k];
        }
        add_about_root(m, i, !undeformed, f, load);
    }
    memset(load + constrained, 0, (size_t)(6 - constrained) * sizeof *load);
    if (spari_member_plane(m)) {
        spari_plane_project(spari_member_plane(m), 1, load);
    }
}

int spari_energy_of_body(const spar_member *m, double energy[4]) {
    double *q = spari_zalloc(13 * (int64_t)m->body->unique, sizeof *q), *v = q + 7 * (int64_t)m->body->unique;
    if (!q) {
        return SPAR_ERR_MEMORY;
    }
    spari_member_to_unique(m, 7, m->after.q, q);
    spari_member_to_unique(m, 6, m->after.v, v);
    spari_body_energy(m->body, q, v, energy);
    energy[SPAR_ENERGY_KINETIC] = m->effects & SPAR_EFFECT_INERTIA ? energy[SPAR_ENERGY_KINETIC] : 0;
    free(q);
    return SPAR_OK;
}

int spar_member_get_energy(const spar_member *member, int64_t capacity, double *energy) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_TRY(spari_need_committed(member, __func__));
    SPARI_TRY(spari_need_capacity(member->session, __func__, capacity));
    double found[SPAR_ENERGY_COUNT] = {0};
    int status = member->row->energy ? member->row->energy(member, found) : SPAR_OK;
    SPARI_REQUIRE(member->session, status == SPAR_OK, status, "%s: no memory for '%s'", __func__, member->name);
    found[SPAR_ENERGY_DISSIPATED] = member->state.dissipated;
    if (member->load.foundation) {
        found[SPAR_ENERGY_FOUNDATION] = spari_foundation_energy(member, member->after.q);
    }
    spari_fill(capacity, energy, SPAR_ENERGY_COUNT, found);
    return SPAR_OK;
}
