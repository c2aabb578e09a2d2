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

/* Something to be given to a rank. */
typedef struct load {
    double expected;
    int at; /* its place before sorting */
} load;

/* The most expensive first; of equal ones the one that came first. x and y begin with a load. */
static int compare_loads(const void *a, const void *b) {
    const load *x = a, *y = b;
    return x->expected != y->expected ? (x->expected < y->expected) - (x->expected > y->expected)
                                      : (x->at > y->at) - (x->at < y->at);
}

typedef struct open_assembly {
    load load;
    spari_assembly *assembly;
} open_assembly;

/* Gives the assemblies without an owner to the rank with the least to do. */
static int assign_open(spar_session *s, double *busy) {
    int n = 0;
    for (const spari_assembly *a = s->assemblies; a; a = a->next) {
        n += a->owner < 0;
    }
    open_assembly *all = spari_zalloc(n, sizeof *all);
    if (!all) {
        return SPAR_ERR_MEMORY;
    }
    n = 0;
    for (spari_assembly *a = s->assemblies; a; a = a->next) {
        if (a->owner < 0) {
            all[n] = (open_assembly){{spari_assembly_expected(a), n}, a};
            n++;
        }
    }
    qsort(all, (size_t)n, sizeof *all, compare_loads);
    for (int i = 0; i < n; i++) {
        all[i].assembly->owner = least_busy(busy, spari_comm_size(s->ranks.comm));
        busy[all[i].assembly->owner] += all[i].load.expected;
    }
    free(all);
    return SPAR_OK;
}

int spari_owners_of_assemblies(spar_session *s) {
    double *busy = spari_zalloc(spari_comm_size(s->ranks.comm), sizeof *busy);
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
    status = status == SPAR_OK ? assign_open(s, busy) : status;
    free(busy);
    return status;
}

/* ---- members without joints ---- */

typedef struct free_member {
    load load;
    spar_member *member;
    int owner_before;
    void *before; /* its former solution, while it moves */
    int moved;
} free_member;

static int find_free(const spar_session *s, free_member *all) {
    int n = 0;
    for (spar_member *m = s->members; m; m = m->next) {
        if (is_unsettled(m)) {
            if (all) {
                all[n] = (free_member){{spari_member_expected(m), n}, .member = m, .owner_before = m->owner};
            }
            n++;
        }
    }
    return n;
}

static int move_free(spar_session *s, free_member *all, int n, double *busy) {
    int ranks = spari_comm_size(s->ranks.comm);
    qsort(all, (size_t)n, sizeof *all, compare_loads);
    add_assigned(s, busy);
    for (const spari_assembly *a = s->assemblies; a; a = a->next) {
        busy[a->owner] += spari_assembly_expected(a);
    }
    for (int i = 0; i < n; i++) {
        spar_member *m = all[i].member;
        int owner = least_busy(busy, ranks);
        busy[owner] += all[i].load.expected;
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
