/* The rank that solves each member: see owners.h. */
#include "owners.h"

#include "../comm/comm.h"
#include "../member/body.h"
#include "../solve/life.h"
#include "../time/fidelity.h"
#include "system.h"

#include <stdlib.h>

/* ---- estimated cost ---- */

/* Costs in instructions, rounded from callgrind's counts (docs/evidence/performance.md, benchmarks/assemblies.c).
   Only their ratios matter. An iteration of Newton costs a sum over: nodes with six unknowns, quadrature points, nodes
   that a point depends on, entries of the rows of the band. A linear or modal member: nodes, entries of its matrices.
   Others: a rigid body; a joint, with the condensed bodies that it connects. Newton takes several iterations where a
   linear member takes one solution. */
static const double NODE = 2500, POINT = 390, POINT_NODE = 11, ENTRY = 0.87, FRAME_NODE = 3200, FRAME_ENTRY = 2.75,
                    RIGID = 5000, JOINT = 22000, NEWTON = 2.5;

double spari_member_expected(const spar_member *m) {
    const spari_body *b = m->body;
    if (!m->committed || !m->row->solved || !b) {
        return 0;
    }
    double nodes = b->unique, band = 12.0 * b->per_element;
    if (m->row->whole) {
        return NEWTON * RIGID;
    }
    if (m->frame == SPARI_FRAME_LINEAR) {
        double entries = m->row->takes_modes ? 6 * nodes * (double)m->modes : 6 * nodes * band;
        return nodes * FRAME_NODE + entries * FRAME_ENTRY;
    }
    return NEWTON * (nodes * (NODE + 6 * band * ENTRY) + b->first[b->elements] * (POINT + POINT_NODE * b->per_element));
}

double spari_assembly_expected(const spari_assembly *a) {
    double sum = a->components > 0 ? NEWTON * JOINT * a->constraints : 0;
    for (int i = 0; i < a->components; i++) {
        sum += spari_member_expected(a->component[i].member);
    }
    return sum;
}

static int least_busy(const double *busy, int ranks) {
    int least = 0;
    for (int r = 1; r < ranks; r++) {
        least = busy[r] < busy[least] ? r : least;
    }
    return least;
}

/* Whether a member without joints still needs an owner. */
static int is_unsettled(const spar_member *m) {
    return m->committed && !m->assembly && !m->owner_given && !m->owner_assigned && spari_member_expected(m) > 0;
}

/* The load of each rank from members without joints that have their owner. */
static void add_assigned(const spar_session *s, double *busy) {
    for (const spar_member *m = s->members; m; m = m->next) {
        busy[m->owner] += !m->assembly && !is_unsettled(m) ? spari_member_expected(m) : 0;
    }
}

/* ---- assemblies ---- */

/* The owner that the host has given its members; -1: none. */
static int find_host_owner(spari_assembly *a) {
    const spar_member *by = NULL;
    a->owner = -1;
    for (int i = 0; i < a->components; i++) {
        const spar_member *m = a->component[i].member;
        if (!m->owner_given) {
            continue;
        }
        SPARI_REQUIRE(a->session, !by || by->owner == m->owner, SPAR_ERR_ARGUMENT,
                      "members '%s' and '%s' are connected by joints, but their owners are ranks %d and %d; give "
                      "connected members the same owner, or none",
                      by->name, m->name, by->owner, m->owner);
        by = m;
        a->owner = m->owner;
    }
    return SPAR_OK;
}

/* The most expensive assembly without an owner; NULL: all have one. */
static spari_assembly *dearest_left(const spar_session *s) {
    spari_assembly *found = NULL;
    for (spari_assembly *a = s->assemblies; a; a = a->next) {
        if (a->owner < 0 && (!found || spari_assembly_expected(a) > spari_assembly_expected(found))) {
            found = a;
        }
    }
    return found;
}

int spari_owners_of_assemblies(spar_session *s) {
    int ranks = spari_comm_size(s->ranks.comm);
    double *busy = spari_zalloc(ranks, sizeof *busy);
    int status = busy ? SPAR_OK : SPAR_ERR_MEMORY;
    if (busy) {
        add_assigned(s, busy);
    }
    for (spari_assembly *a = s->assemblies; a && status == SPAR_OK; a = a->next) {
        status = find_host_owner(a);
        if (status == SPAR_OK && a->owner >= 0) {
            busy[a->owner] += spari_assembly_expected(a);
        }
    }
    for (spari_assembly *a = NULL; status == SPAR_OK && (a = dearest_left(s)) != NULL;) {
        a->owner = least_busy(busy, ranks);
        busy[a->owner] += spari_assembly_expected(a);
    }
    free(busy);
    return status;
}

/* ---- members without joints ---- */

typedef struct free_member {
    spar_member *member;
    int at, owner_before; /* `at`: its index in the order of creation */
    double expected;
    void *before; /* its former solution, while it moves */
    int moved;
} free_member;

/* The most expensive first; of equal ones the one created first. */
static int compare_free(const void *a, const void *b) {
    const free_member *x = a, *y = b;
    return x->expected != y->expected ? (x->expected < y->expected) - (x->expected > y->expected)
                                      : (x->at > y->at) - (x->at < y->at);
}

static int find_free(const spar_session *s, free_member *all) {
    int n = 0;
    for (spar_member *m = s->members; m; m = m->next) {
        if (is_unsettled(m)) {
            if (all) {
                all[n] = (free_member){.member = m, .at = n, .owner_before = m->owner};
                all[n].expected = spari_member_expected(m);
            }
            n++;
        }
    }
    return n;
}

static int move_free(spar_session *s, free_member *all, int n, double *busy) {
    int ranks = spari_comm_size(s->ranks.comm);
    qsort(all, (size_t)n, sizeof *all, compare_free);
    add_assigned(s, busy);
    for (const spari_assembly *a = s->assemblies; a; a = a->next) {
        busy[a->owner] += spari_assembly_expected(a);
    }
    for (int i = 0; i < n; i++) {
        spar_member *m = all[i].member;
        int owner = least_busy(busy, ranks);
        busy[owner] += all[i].expected;
        if (owner != m->owner) {
            all[i].moved = 1;
            int status = spari_member_move(m, owner, &all[i].before);
            SPARI_REQUIRE(s, status == SPAR_OK, status, "no memory to solve for '%s'", m->name);
        }
    }
    return SPAR_OK;
}

int spari_owners_assign(spar_session *s) {
    int ranks = spari_comm_size(s->ranks.comm), n = ranks > 1 ? find_free(s, NULL) : 0;
    if (n == 0) {
        return SPAR_OK;
    }
    free_member *all = spari_zalloc(n, sizeof *all);
    double *busy = spari_zalloc(ranks, sizeof *busy);
    int status =
        all && busy ? SPAR_OK : spari_fail(s, SPAR_ERR_MEMORY, "no memory to distribute the members over the ranks");
    if (status == SPAR_OK) {
        (void)find_free(s, all);
        status = move_free(s, all, n, busy);
    }
    status = spari_comm_agree(s->ranks.comm, status, s->message, sizeof s->message);
    for (int i = 0; i < n && all; i++) {
        if (all[i].moved) {
            spari_member_end_move(all[i].member, all[i].owner_before, all[i].before, status != SPAR_OK);
        }
        all[i].member->owner_assigned = status == SPAR_OK;
    }
    free(all);
    free(busy);
    return status;
}
