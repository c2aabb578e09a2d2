/* The reaction at the root of a member, and the energies of the member. */
#include "reaction.h"

#include "../base/environment.h"
#include "../math/rotation.h"
#include "../member/applied_loads.h"
#include "../member/body.h"
#include "../member/check_arguments.h"
#include "../member/joint.h"
#include "../member/plane.h"
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

int64_t spari_reaction_at_root_size(const spar_member *m) {
    return 25 * (int64_t)m->body->unique;
}

void spari_reaction_at_root(const spar_member *m, double *workspace, double load[6]) {
    memset(load, 0, 6 * sizeof *load);
    const spari_body *b = m->body;
    int constrained = spari_member_constrained(m);
    if (constrained == 0) {
        return;
    }
    int64_t n = b->unique;
    int still = !(m->effects & SPAR_EFFECT_INERTIA);
    double *q = workspace, *v = q + 7 * n, *a = v + 6 * n, *r = a + 6 * n;
    spari_member_to_unique(m, 7, m->after.q, q);
    spari_member_to_unique(m, 6, m->after.v, v);
    spari_member_to_unique(m, 6, m->after.a, a);
    spari_body_residual(b, q, still && !b->D ? NULL : v, still ? NULL : a, 1, r, NULL);
    if (spari_carries_loads(m)) {
        spari_applied_residual(m, q, 1, r);
    }
    double joint_load[6] = {0};
    spari_joints_on(m, 0, joint_load);
    for (int i = 0; i < constrained; i++) { /* the root is node 0, which no element shares */
        load[i] = r[i] - m->load.solved[1][i] - joint_load[i];
    }
    if (spari_member_plane(m)) {
        spari_plane_project(spari_member_plane(m), 1, load);
    }
}

int64_t spari_reaction_of_whole_size(const spar_member *m) {
    return (m->body ? 25 * (int64_t)m->body->unique : 0) + 12 * m->nodes;
}

void spari_reaction_of_whole(const spar_member *m, double *workspace, double load[6]) {
    int64_t n = m->body ? m->body->unique : 0;
    int still = !(m->effects & SPAR_EFFECT_INERTIA);
    double *q = workspace, *v = q + 7 * n, *a = v + 6 * n, *r = a + 6 * n, *sum = r + 6 * n,
           *extra = sum + 6 * m->nodes;
    memset(load, 0, 6 * sizeof *load);
    memset(workspace, 0, (size_t)spari_reaction_of_whole_size(m) * sizeof *workspace);
    int standing = spari_member_is_linear_at_rest(m);
    int undeformed = standing && !(m->body && m->body->pre);
    if (m->body) {
        for (int64_t i = 0; i < n; i++) {
            q[7 * i + 3] = 1;
        }
        if (!standing) {
            spari_member_to_unique(m, 7, m->after.q, q);
            spari_member_to_unique(m, 6, m->after.v, v);
        }
        spari_member_to_unique(m, 6, m->after.a, a);
        if (standing &&
            m->body->mass_damping > 0) { /* the root stands: damping by mass is of the velocities as they are */
            spari_member_to_unique(m, 6, m->after.v, r);
            for (int64_t i = 0; i < 6 * n; i++) {
                a[i] += m->body->mass_damping * r[i];
            }
        }
        spari_body loose =
            *m->body; /* pretension gives the whole nothing, but what balances it has a moment by its way */
        loose.pre = NULL;
        spari_body_residual(&loose, q, still ? NULL : v, still ? NULL : a, 1, r, NULL);
        spari_member_from_unique(m, 6, r, sum);
        for (int64_t i = m->mesh.per_element; i < m->nodes; i += m->mesh.per_element) {
            memset(sum + 6 * i, 0, 6 * sizeof *sum); /* a joint counts once */
        }
    }
    if (spari_carries_loads(m)) {
        spari_applied_nodal(m, m->after.q, extra);
        for (int64_t i = 0; i < 6 * m->nodes; i++) {
            sum[i] -= extra[i];
        }
    }
    for (int64_t i = 0; i < m->nodes; i++) {
        double r_i[3], moment[3], f[6], joint_load[6] = {0};
        if (!m->external) { /* its loads have them */
            spari_joints_on(m, i, joint_load);
        }
        for (int k = 0; k < 6; k++) {
            f[k] = sum[6 * i + k] - m->load.solved[1][6 * i + k] - joint_load[k];
        }
        for (int k = 0; k < 3; k++) {
            r_i[k] = m->xr[3 * i + k] - m->xr[k] + (undeformed ? 0 : m->after.q[7 * i + k] - m->after.q[k]);
        }
        spari_cross(r_i, f, moment);
        for (int k = 0; k < 3; k++) {
            load[k] += f[k];
            load[3 + k] += f[3 + k] + moment[k];
        }
    }
    int constrained = spari_member_constrained(m);
    memset(load + constrained, 0, (size_t)(6 - constrained) * sizeof *load);
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
