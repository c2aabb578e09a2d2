/* Joints of rebuilt members: see move_joints.h. */
#include "move_joints.h"

#include <stdlib.h>
#include <string.h>

int spari_joints_save_snapshot(spar_session *s, spari_joint_snapshot *t) {
    *t = (spari_joint_snapshot){0};
    if (!s->joints) {
        return SPAR_OK;
    }
    t->joints = spari_zalloc(s->joint_count, sizeof *t->joints);
    SPARI_REQUIRE(s, t->joints, SPAR_ERR_MEMORY, "no memory for the joints of a trial");
    spar_joint *copy = t->joints;
    for (const spar_joint *j = s->joints; j; j = j->next) {
        *copy++ = *j;
    }
    t->stale = s->joints_stale;
    t->assemblies = spari_assemblies_take(s);
    return SPAR_OK;
}

/* Node of a mesh that coincides with a node of the member, as the end of an element in both; -1: none. */
static int64_t end_node(const spar_member *m, int64_t node, spari_mesh mesh) {
    int64_t k = node % m->mesh.per_element;
    return k > 0 && k < m->mesh.per_element - 1
               ? -1
               : spari_resample_end(m->mesh.elements, (int)(node / m->mesh.per_element), k > 0, mesh);
}

int spari_joints_follow_rebuild(const spar_member *m, const spar_member *old) {
    for (int k = 0; k < m->joint_count && !spari_mesh_is_equal(m->mesh, old->mesh); k++) {
        spar_joint *j = m->joints[k];
        for (int side = 0; side < 2; side++) {
            if (j->member[side] != m) {
                continue;
            }
            int64_t node = end_node(old, j->node[side], m->mesh);
            SPARI_REQUIRE(m->session, node >= 0, SPAR_ERR_STATE,
                          "joint '%s' constrains node %lld of '%s', which lies within an element, now or after the "
                          "change: the nodes of the member cannot change; connect joints at element boundaries",
                          j->name, (long long)j->node[side], m->name);
            j->node[side] = node;
        }
    }
    return SPAR_OK;
}

void spari_joints_restore_snapshot(spar_session *s, spari_joint_snapshot *t) {
    if (!t->joints) {
        return;
    }
    const spar_joint *copy = t->joints;
    for (spar_joint *j = s->joints; j; j = j->next) {
        *j = *copy++;
    }
    spari_assemblies_give(s, t->assemblies);
    s->joints_stale = t->stale;
    free(t->joints);
    *t = (spari_joint_snapshot){0};
}

void spari_joints_drop_snapshot(spar_session *s, spari_joint_snapshot *t) {
    const spar_joint *copy = t->joints;
    for (spar_joint *j = s->joints; j && copy; j = j->next, copy++) { /* their work accounts continue */
        memcpy(j->account, copy->account, sizeof j->account);
    }
    spari_assemblies_drop(t->assemblies);
    free(t->joints);
    *t = (spari_joint_snapshot){0};
}

int spari_joints_hold_within(const spar_member *m, int elements) {
    const spari_mesh mesh = {elements, m->mesh.per_element};
    int within = 0;
    for (int k = 0; k < m->joint_count; k++) {
        const spar_joint *j = m->joints[k];
        for (int side = 0; side < 2; side++) {
            within = within || (j->member[side] == m && end_node(m, j->node[side], mesh) < 0);
        }
    }
    return within;
}
