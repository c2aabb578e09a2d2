/* Which members joints tie together: assemblies found, sized and released. */
#include "../base/scene.h"
#include "../comm/comm.h"
#include "assembly.h"
#include "fidelity.h"
#include "tied.h"

#include <stdlib.h>
#include <string.h>

/* Whether a member's motion is unknown in an assembly. */
static int is_part(const spar_member *m) {
    return m && m->row->solver && spari_fidelity_is_here(m);
}

/* ---- one assembly ---- */

/* The nodes of a member that joints hold, in increasing order; how many. */
static int ends_of(const spar_member *m, int *node) {
    int n = 0;
    for (const spar_joint *j = m->session->joints; j; j = j->next) {
        for (int side = 0; side < 2; side++) {
            if (j->member[side] != m) {
                continue;
            }
            int at = 0;
            while (at < n && node[at] < j->unique[side]) {
                at++;
            }
            if (at < n && node[at] == j->unique[side]) {
                continue;
            }
            memmove(node + at + 1, node + at, (size_t)(n - at) * sizeof *node);
            node[at] = j->unique[side];
            n++;
        }
    }
    return n;
}

static int condense(const spar_member *m, spari_solver *solver) {
    int count = 0;
    for (const spar_joint *j = m->session->joints; j; j = j->next) {
        count += (j->member[0] == m) + (j->member[1] == m);
    }
    int *node = spari_zalloc(count + 1, sizeof *node);
    int ends = node ? ends_of(m, node) : 0;
    spari_condensed_free(solver->condensed);
    solver->condensed = node ? spari_condensed_create(ends, node, 6 * solver->n) : NULL;
    free(node);
    return solver->condensed ? SPAR_OK : SPAR_ERR_MEMORY;
}

static void assembly_free(spari_assembly *a) {
    for (int i = 0; i < a->limbs; i++) {
        a->limb[i].member->assembly = NULL;
    }
    spari_tied_free(a);
    free(a->limb);
    free(a->link);
    free(a);
}

static void take_member(spari_assembly *a, spar_member *m) {
    a->limb[a->limbs++] = (spari_limb){.member = m, .solver = m->row->solver(m)};
    m->assembly = a;
}

/* All that is tied to its first member, in the order in which joints reach it. */
static void gather(spari_assembly *a, spar_member *first) {
    take_member(a, first);
    for (int i = 0; i < a->limbs; i++) {
        for (spar_joint *j = a->session->joints; j; j = j->next) {
            for (int side = 0; side < 2; side++) {
                spar_member *other = j->member[1 - side];
                if (j->member[side] == a->limb[i].member && is_part(other) && !other->assembly) {
                    take_member(a, other);
                }
            }
        }
    }
}

static spari_limb *part_of(spari_assembly *a, const spar_member *m) {
    for (int i = 0; i < a->limbs; i++) {
        if (a->limb[i].member == m) {
            return a->limb + i;
        }
    }
    return NULL;
}

/* Where the nodes are in the reference. */
static void look_at_reference(spari_link *l) {
    const spar_joint *j = l->joint;
    double z[6];
    for (int side = 0; side < 2; side++) {
        const spar_member *m = j->member[side];
        l->place[side] = (spari_place){.q = {1, 0, 0, 0}};
        if (m) {
            memcpy(l->place[side].x, m->xr + 3 * j->seat[side], sizeof l->place[side].x);
        }
    }
    spari_tie_motion(&j->tie, &l->place[0], &l->place[1], z, l->B);
}

static int assembly_create(spar_session *s, spar_member *first) {
    int joints = 0;
    for (const spar_joint *j = s->joints; j; j = j->next) {
        joints++;
    }
    spari_assembly *a = spari_zalloc(1, sizeof *a);
    if (!a) {
        return SPAR_ERR_MEMORY;
    }
    a->session = s;
    a->next = s->assemblies;
    s->assemblies = a;
    a->limb = spari_zalloc(s->member_count, sizeof *a->limb);
    a->link = spari_zalloc(joints, sizeof *a->link);
    if (!a->limb || !a->link) {
        return SPAR_ERR_MEMORY;
    }
    gather(a, first);
    for (int i = 0; i < a->limbs; i++) {
        SPARI_TRY(condense(a->limb[i].member, a->limb[i].solver));
    }
    for (spar_joint *j = s->joints; j; j = j->next) {
        spari_limb *of[2] = {part_of(a, j->member[0]), part_of(a, j->member[1])};
        if (of[0] || of[1]) {
            spari_link *l = a->link + a->links++;
            l->joint = j;
            l->limb[0] = of[0], l->limb[1] = of[1];
            j->held = spari_joint_given(j);
        }
    }
    spari_tied_place(a);
    for (int i = 0; i < a->links; i++) {
        look_at_reference(a->link + i);
    }
    SPARI_TRY(spari_tied_drop_redundant(a));
    spari_tied_place(a);
    return spari_tied_room(a);
}

static int check_members(const spar_joint *j) {
    for (int side = 0; side < 2; side++) {
        const spar_member *m = j->member[side];
        SPARI_REQUIRE(j->session, !m || m->committed, SPAR_ERR_STATE,
                      "joint '%s': member '%s' is not committed; call spar_member_commit first", j->name, m->name);
        SPARI_REQUIRE(j->session, !m || m->row->solver || !m->row->solved, SPAR_ERR_UNSUPPORTED,
                      "joint '%s': '%s' is linear or modal; joints tie rigid bodies and rigid or exact beams in this "
                      "release",
                      j->name, m->name);
    }
    return SPAR_OK;
}

/* A beam that one body carries is held there: a rigid arm leads to the node. */
static void lead_to_bodies(spar_joint *j) {
    for (int side = 0; side < 2; side++) {
        const spar_member *m = j->member[side];
        if (is_part(m) && m->row->solver(m)->n == 1) {
            j->unique[side] = 0;
            j->seat[side] = 0;
            for (int k = 0; k < 3; k++) {
                j->tie.arm[side][k] += m->xr[3 * j->node[side] + k] - m->xr[k];
            }
        }
    }
}

int spari_assemblies_make(spar_session *s) {
    int status = SPAR_OK;
    if (!s->joints_stale) {
        return SPAR_OK;
    }
    spari_assemblies_free(s);
    for (spar_joint *j = s->joints; j; j = j->next) {
        SPARI_TRY(check_members(j));
        SPARI_TRY(spari_joint_place(j));
        lead_to_bodies(j);
    }
    for (spar_joint *j = s->joints; j && status == SPAR_OK; j = j->next) {
        for (int side = 0; side < 2 && status == SPAR_OK; side++) {
            spar_member *m = j->member[side];
            status = is_part(m) && !m->assembly ? assembly_create(s, m) : SPAR_OK;
        }
    }
    if (status != SPAR_OK) {
        spari_assemblies_free(s);
        return spari_fail(s, status, "no memory for the members that joints tie together");
    }
    s->joints_stale = 0;
    return SPAR_OK;
}

void spari_assemblies_free(spar_session *s) {
    while (s->assemblies) {
        spari_assembly *a = s->assemblies;
        s->assemblies = a->next;
        assembly_free(a);
    }
}

spari_assembly *spari_assembly_next(const spari_assembly *a) {
    return a->next;
}
