/* Creation of assemblies: finds the members that joints connect, allocates and frees. */
#include "../base/session.h"
#include "../comm/enter.h"
#include "../member/plane.h"
#include "../solve/life.h"
#include "../time/fidelity.h"
#include "assembly.h"
#include "owners.h"
#include "system.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Whether a member's motion is unknown in an assembly. */
static int is_part(const spar_member *m) {
    return m && m->row->component;
}

/* ---- one assembly ---- */

static int take_member(spari_assembly *a, int *capacity, spar_member *m) {
    if (a->components == *capacity) {
        int more = 2 * *capacity + 4;
        spari_component *component = realloc(a->component, (size_t)more * sizeof *component);
        if (!component) {
            return SPAR_ERR_MEMORY;
        }
        a->component = component, *capacity = more;
    }
    m->assembly = a;
    m->component = a->components;
    a->component[a->components++] = (spari_component){.member = m, .owner_before = m->owner};
    return SPAR_OK;
}

/* Lists all members that are connected to the first one, in the order in which joints reach them. */
static int gather(spari_assembly *a, spar_member *first) {
    int capacity = 0;
    SPARI_TRY(take_member(a, &capacity, first));
    for (int i = 0; i < a->components; i++) {
        const spar_member *m = a->component[i].member;
        for (int n = 0; n < m->joint_count; n++) {
            const spar_joint *j = m->joints[n];
            spar_member *other = j->member[j->member[0] == m];
            if (is_part(other) && !other->assembly) {
                SPARI_TRY(take_member(a, &capacity, other));
            }
        }
    }
    return SPAR_OK;
}

static spari_component *part_of(spari_assembly *a, const spar_member *m) {
    return m && m->assembly == a ? a->component + m->component : NULL;
}

/* Reference positions of the nodes. */
static void look_at_reference(spari_constraint *l) {
    const spar_joint *j = l->joint;
    double z[6];
    for (int side = 0; side < 2; side++) {
        const spar_member *m = j->member[side];
        l->pose[side] = (spari_node_pose){.q = {1, 0, 0, 0}};
        if (m) {
            memcpy(l->pose[side].x, m->xr + 3 * j->seat[side], sizeof l->pose[side].x);
        }
    }
    spari_kinematics_motion(&j->kinematics, &l->pose[0], &l->pose[1], z, l->B);
}

static spari_assembly *assembly_create(spar_session *s) {
    spari_assembly *a = spari_zalloc(1, sizeof *a);
    if (a) {
        a->session = s;
        a->next = s->assemblies;
        s->assemblies = a;
    }
    return a;
}

/* The constraint of a joint, in an assembly that has memory for it. */
static void take_joint(spari_assembly *a, spar_joint *j) {
    spari_constraint *l = a->constraint + a->constraints;
    l->joint = j;
    l->component[0] = part_of(a, j->member[0]), l->component[1] = part_of(a, j->member[1]);
    for (int side = 0; side < 2; side++) {
        l->reach = l->component[side] ? fmax(l->reach, spari_member_length(j->member[side])) : l->reach;
    }
    j->constraint = a->constraints++;
    j->constrained = spari_joint_constrained(j);
}

static double mass_of_all(const spari_assembly *a) {
    double sum = 0;
    for (int i = 0; i < a->components; i++) {
        sum += spari_body_mass(a->component[i].member->body);
    }
    return sum;
}

/* Allocates the solution, on the owner. */
static int make_system(spari_assembly *a) {
    a->here = a->owner == spari_comm_rank(a->session->ranks.comm) || a->components == 0;
    if (!a->here || a->components == 0) {
        return SPAR_OK;
    }
    for (int i = 0; i < a->components; i++) {
        spari_component *p = a->component + i;
        p->row = p->member->row->component;
        SPARI_TRY(spari_component_make_ends(p));
        p->row->attach(p);
    }
    SPARI_TRY(spari_system_find_tree(a));
    for (int i = 0; i < a->constraints; i++) {
        look_at_reference(a->constraint + i);
    }
    SPARI_TRY(spari_system_drop_redundant(a));
    a->mass = mass_of_all(a);
    return spari_system_create(a);
}

/* ---- owners ---- */

/* Moves the members to the owner. Their former solutions exist until creation ends. */
static int move_members(spari_assembly *a) {
    for (int i = 0; i < a->components; i++) {
        spari_component *p = a->component + i;
        if (p->member->owner != a->owner) {
            p->moved = 1;
            SPARI_TRY(spari_member_move(p->member, a->owner, &p->solution_before));
        }
    }
    return SPAR_OK;
}

/* ---- all assemblies ---- */

static int check_committed(const spar_joint *j, const spar_member *m) {
    SPARI_REQUIRE(j->session, m->committed, SPAR_ERR_STATE,
                  "joint '%s': member '%s' is not committed; call spar_member_commit first", j->name, m->name);
    return SPAR_OK;
}

static int check_members(const spar_joint *j) {
    SPARI_TRY(check_committed(j, j->member[0]));
    SPARI_TRY(j->member[1] ? check_committed(j, j->member[1]) : SPAR_OK);
    SPARI_REQUIRE(j->session, j->member[0] != j->member[1] || !j->member[0]->row->whole, SPAR_ERR_ARGUMENT,
                  "joint '%s' connects two nodes of '%s', which moves as one rigid body; remove the joint", j->name,
                  j->member[0]->name);
    SPARI_REQUIRE(j->session, is_part(j->member[0]) || is_part(j->member[1]) || !spari_joint_constrained(j),
                  SPAR_ERR_ARGUMENT,
                  "joint '%s' constrains or drives nodes whose motion is prescribed ('%s'); leave the motions of the "
                  "joint free and use springs instead",
                  j->name, j->member[0]->name);
    return SPAR_OK;
}

/* The node of a beam that one rigid body carries: the joint holds that body, at an offset. Copies the reference
   positions of the nodes. */
static void lead_to_components(spar_joint *j) {
    for (int side = 0; side < 2; side++) {
        const spar_member *m = j->member[side];
        if (is_part(m) && m->row->whole) {
            j->unique[side] = 0;
            j->seat[side] = 0;
            for (int k = 0; k < 3; k++) {
                j->kinematics.arm[side][k] += m->xr[3 * j->node[side] + k] - m->xr[k];
            }
        }
        for (int k = 0; k < 3; k++) {
            j->reference[side][k] = m ? m->xr[3 * j->seat[side] + k] : 0;
        }
    }
}

/* The assembly of a joint; NULL: its nodes all have prescribed motion. */
static spari_assembly *assembly_of(const spar_joint *j) {
    return is_part(j->member[0]) ? j->member[0]->assembly : is_part(j->member[1]) ? j->member[1]->assembly : NULL;
}

/* Finds the members of the assemblies. A joint whose nodes all have prescribed motion is an assembly of its own. */
static int gather_members(spar_session *s) {
    for (spar_joint *j = s->joints; j; j = j->next) {
        for (int side = 0; side < 2; side++) {
            spar_member *m = j->member[side];
            if (is_part(m) && !m->assembly) {
                spari_assembly *a = assembly_create(s);
                SPARI_TRY(a ? gather(a, m) : SPAR_ERR_MEMORY);
            }
        }
        if (!assembly_of(j)) {
            spari_assembly *a = assembly_create(s);
            if (!a || !(a->constraint = spari_zalloc(1, sizeof *a->constraint))) {
                return SPAR_ERR_MEMORY;
            }
            take_joint(a, j);
        }
    }
    return SPAR_OK;
}

/* Joints in order of creation, whatever the order of the members. */
static int gather_joints(spar_session *s) {
    for (spar_joint *j = s->joints; j; j = j->next) {
        if (assembly_of(j)) {
            assembly_of(j)->constraints++;
        }
    }
    for (spari_assembly *a = s->assemblies; a; a = a->next) {
        if (!a->constraint) {
            a->constraint = spari_zalloc(a->constraints, sizeof *a->constraint);
            a->constraints = 0;
        }
        if (!a->constraint) {
            return SPAR_ERR_MEMORY;
        }
    }
    for (spar_joint *j = s->joints; j; j = j->next) {
        if (assembly_of(j)) {
            take_joint(assembly_of(j), j);
        }
    }
    return SPAR_OK;
}

/* What a joint asks of a node out of its plane has no unknown. */
static int check_planes(const spar_joint *j) {
    for (int side = 0; side < 2; side++) {
        const spar_member *m = j->member[side];
        SPARI_REQUIRE(
            j->session, !m || !spari_member_plane(m), SPAR_ERR_UNSUPPORTED,
            "joint '%s' connects '%s', which is held in a plane (spar_beam_set_plane); such a beam can have no "
            "joints, only a root that is free, pinned, fixed or driven",
            j->name, m->name);
    }
    return SPAR_OK;
}

/* Nothing is changed until all of them can be placed. */
static int check_joints(const spar_session *s) {
    for (const spar_joint *j = s->joints; j; j = j->next) {
        SPARI_TRY(check_members(j));
        SPARI_TRY(check_planes(j));
        SPARI_TRY(spari_joint_check_place(j));
    }
    return SPAR_OK;
}

int spari_joints_place(spar_session *s) {
    if (!s->joints_stale) {
        return SPAR_OK;
    }
    SPARI_TRY(check_joints(s));
    spari_assemblies_free(s); /* of the joints as they were */
    for (spar_joint *j = s->joints; j; j = j->next) {
        spari_joint_place(j);
        lead_to_components(j);
    }
    return SPAR_OK;
}

/* This rank's part. */
static int make_all(spar_session *s) {
    SPARI_TRY(spari_joints_place(s));
    int status = gather_members(s);
    status = status == SPAR_OK ? gather_joints(s) : status;
    status = status == SPAR_OK ? spari_owners_of_assemblies(s) : status;
    for (spari_assembly *a = s->assemblies; a && status == SPAR_OK; a = a->next) {
        status = move_members(a);
        status = status == SPAR_OK ? make_system(a) : status;
    }
    SPARI_REQUIRE(s, status != SPAR_ERR_MEMORY, status, "no memory for the members that joints connect");
    return status;
}

/* Whether all ranks have created the assemblies, and their joints agree. */
static int agree_on_joints(const spar_session *s, const char *call, int status) {
    char what[SPARI_MESSAGE_SIZE / 2];
    for (const spar_joint *j = s->joints; j; j = j->next) {
        const spari_agreed must_agree[] = {spari_hash("descriptions of it", spari_joint_hash(j)),
                                           spari_hash("springs, loads or drives of it", spari_joint_setting(j))};
        (void)snprintf(what, sizeof what, "%s: joint '%s'", call, j->name);
        status = spari_enter_agreed(j->session, what, must_agree, 2, status);
        SPARI_TRY(status);
    }
    return SPAR_OK;
}

int spari_solvers_place(spar_session *s, const char *call) {
    SPARI_TRY(s->joints ? spari_assemblies_make(s, call) : SPAR_OK);
    return s->clock.started ? SPAR_OK : spari_owners_assign(s);
}

int spari_assemblies_make(spar_session *s, const char *call) {
    if (!s->joints_stale) {
        return SPAR_OK;
    }
    int status = check_joints(s), changed = status == SPAR_OK;
    if (changed) {
        spari_assemblies_free(s);
        status = make_all(s);
    }
    status = agree_on_joints(s, call, status);
    for (spari_assembly *a = s->assemblies; a; a = a->next) {
        for (int i = 0; i < a->components; i++) {
            spari_component *p = a->component + i;
            if (p->moved) {
                spari_member_end_move(p->member, p->owner_before, p->solution_before, status != SPAR_OK);
            }
            p->moved = 0;
        }
    }
    if (status != SPAR_OK && changed) {
        spari_assemblies_free(s);
    }
    SPARI_TRY(status);
    s->joints_stale = 0;
    return SPAR_OK;
}

void spari_assemblies_free(spar_session *s) {
    spari_assemblies_drop(spari_assemblies_take(s));
}

spari_assembly *spari_assemblies_take(spar_session *s) {
    spari_assembly *all = s->assemblies;
    for (spar_member *m = s->members; m; m = m->next) {
        m->assembly = NULL;
    }
    s->assemblies = NULL;
    s->joints_stale = s->joints != NULL;
    return all;
}

void spari_assemblies_give(spar_session *s, spari_assembly *all) {
    spari_assemblies_free(s);
    s->assemblies = all;
    for (spari_assembly *a = all; a; a = a->next) {
        for (int i = 0; i < a->components; i++) {
            a->component[i].member->assembly = a;
        }
        for (int i = 0; i < a->constraints; i++) {
            a->constraint[i].joint->constraint = i;
        }
    }
}

void spari_assemblies_drop(spari_assembly *all) {
    while (all) {
        spari_assembly *a = all;
        all = a->next;
        spari_system_free(a);
        free(a->component);
        free(a->constraint);
        free(a);
    }
}

spari_assembly *spari_assembly_next(const spari_assembly *a) {
    return a->next;
}
