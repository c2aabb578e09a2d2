/* The tree of an assembly's interface nodes: see system.h. */
#include "../base/session.h"
#include "system.h"

#include <stdlib.h>

/* The interface node of one side of a constraint; -1: its motion is prescribed. */
static int interface_of(const spari_assembly *a, const spari_constraint *l, int side) {
    const spari_component *p = l->component[side];
    if (!p) {
        return -1;
    }
    int e = 0;
    while (p->condensed->node[e] != l->joint->unique[side]) {
        e++;
    }
    int node = p->at / 6 + e;
    return a->interface[node].fixed == 6 ? -1 : node;
}

static int place_interfaces(spari_assembly *a) {
    a->interfaces = 0;
    for (int i = 0; i < a->components; i++) {
        a->component[i].at = 6 * a->interfaces;
        a->interfaces += a->component[i].condensed->ends;
    }
    a->interface = spari_zalloc(a->interfaces + 1, sizeof *a->interface);
    a->order = spari_zalloc(a->interfaces + 1, sizeof *a->order);
    if (!a->interface || !a->order) {
        return SPAR_ERR_MEMORY;
    }
    for (int i = 0; i < a->components; i++) {
        const spari_component *p = a->component + i;
        for (int e = 0; e < p->condensed->ends; e++) {
            int left = spari_member_constrained(p->member) - 6 * p->condensed->node[e];
            a->interface[p->at / 6 + e].fixed = left < 0 ? 0 : left > 6 ? 6 : left;
        }
    }
    for (int i = 0; i < a->constraints; i++) {
        for (int side = 0; side < 2; side++) {
            a->constraint[i].node[side] = interface_of(a, a->constraint + i, side);
        }
    }
    return SPAR_OK;
}

/* The representative of a connected part of the tree. */
static int find_part(int *part, int i) {
    while (part[i] != i) {
        part[i] = part[part[i]];
        i = part[i];
    }
    return i;
}

/* Constraints connect parts of the tree in their order. A constraint whose nodes are connected already closes a
   loop. */
static int sort_constraints(spari_assembly *a) {
    int ground = a->interfaces, *part = spari_zalloc(a->interfaces + 1, sizeof *part);
    if (!part) {
        return SPAR_ERR_MEMORY;
    }
    for (int i = 0; i <= ground; i++) {
        part[i] = i < ground && a->interface[i].fixed > 0 ? ground : i;
    }
    for (int i = 0; i < a->constraints; i++) {
        spari_constraint *l = a->constraint + i;
        l->role = SPARI_CONSTRAINT_SPRING;
        if (l->joint->constrained) {
            int end[2];
            for (int side = 0; side < 2; side++) {
                end[side] = find_part(part, l->node[side] < 0 ? ground : l->node[side]);
            }
            l->role = end[0] == end[1] ? SPARI_CONSTRAINT_LOOP : SPARI_CONSTRAINT_TREE;
            part[end[0]] = end[1];
        }
    }
    free(part);
    return SPAR_OK;
}

/* Lists the tree's constraints of each interface node, and of the ground after them: numbers 2 constraint + side. */
typedef struct tree_lists {
    int *begin, *entry;
} tree_lists;

static int list_constraints(const spari_assembly *a, tree_lists *lists) {
    int n = a->interfaces + 1;
    lists->begin = spari_zalloc(n + 1, sizeof *lists->begin);
    lists->entry = spari_zalloc(2 * (int64_t)a->constraints + 1, sizeof *lists->entry);
    int *used = spari_zalloc(n, sizeof *used);
    if (!lists->begin || !lists->entry || !used) {
        free(used);
        return SPAR_ERR_MEMORY;
    }
    for (int pass = 0; pass < 2; pass++) {
        for (int i = 0; i < 2 * a->constraints; i++) {
            const spari_constraint *l = a->constraint + i / 2;
            int v = l->node[i % 2] < 0 ? a->interfaces : l->node[i % 2];
            if (l->role == SPARI_CONSTRAINT_TREE && pass == 0) {
                lists->begin[v + 1]++;
            } else if (l->role == SPARI_CONSTRAINT_TREE) {
                lists->entry[lists->begin[v] + used[v]++] = i;
            }
        }
        for (int v = 0; v < n && pass == 0; v++) {
            lists->begin[v + 1] += lists->begin[v];
        }
    }
    free(used);
    return SPAR_OK;
}

/* The children of interface node v, or of the ground (its number), join the order. */
static int visit_children(spari_assembly *a, const tree_lists *lists, int v, int visited) {
    for (int k = lists->begin[v]; k < lists->begin[v + 1]; k++) {
        const spari_constraint *l = a->constraint + lists->entry[k] / 2;
        int side = 1 - lists->entry[k] % 2, child = l->node[side];
        if (child < 0 || a->interface[child].cluster != -2) {
            continue;
        }
        spari_interface *to = a->interface + child;
        int rigid = spari_constraint_count(l) == 6;
        to->parent = v < a->interfaces ? v : -1;
        to->constraint = lists->entry[k] / 2;
        to->side = side;
        to->depth = v < a->interfaces ? a->interface[v].depth + 1 : 1;
        to->cluster = !rigid ? child : v < a->interfaces ? a->interface[v].cluster : -1;
        a->clusters = a->clusters || rigid;
        a->order[visited++] = child;
    }
    return visited;
}

/* The tree begins at the ground, then at nodes that a root condition constrains in part, then at any node. */
static void visit_all(spari_assembly *a, const tree_lists *lists) {
    enum { UNSEEN = -2 };
    int done = 0, visited = 0;
    for (int i = 0; i < a->interfaces; i++) {
        spari_interface *to = a->interface + i;
        to->parent = to->constraint = to->block = -1;
        to->cluster = UNSEEN;
        if (to->fixed > 0) {
            to->cluster = to->fixed == 6 ? -1 : i;
            a->order[visited++] = i;
        }
    }
    visited = visit_children(a, lists, a->interfaces, visited);
    for (int next = 0; done < a->interfaces; done++) {
        while (done == visited && a->interface[next].cluster != UNSEEN) {
            next++;
        }
        if (done == visited) {
            a->interface[next].cluster = next;
            a->order[visited++] = next;
        }
        visited = visit_children(a, lists, a->order[done], visited);
    }
}

int spari_system_find_tree(spari_assembly *a) {
    tree_lists lists = {0};
    int status = place_interfaces(a);
    status = status == SPAR_OK ? sort_constraints(a) : status;
    status = status == SPAR_OK ? list_constraints(a, &lists) : status;
    if (status == SPAR_OK) {
        visit_all(a, &lists);
    }
    free(lists.begin);
    free(lists.entry);
    return status;
}

/* ---- the system ---- */

/* The block of the cluster of an interface node, -1: it does not move. */
static int block_of_node(const spari_assembly *a, int node) {
    int cluster = node < 0 ? -1 : a->interface[node].cluster;
    return cluster < 0 ? -1 : a->interface[cluster].block;
}

static void add_pair(spari_block_pair *pair, int64_t *count, int a, int b) {
    if (a >= 0 && b >= 0 && a != b) {
        pair[(*count)++] = (spari_block_pair){a, b};
    }
}

/* Numbers the blocks, clusters first; their sizes and ties. */
static int count_blocks(spari_assembly *a, int *size, spari_block_tie *tie) {
    int n = 0;
    for (int i = 0; i < a->interfaces; i++) {
        spari_interface *v = a->interface + i;
        if (v->cluster == i) {
            size[n] = 6;
            v->block = n++;
        }
    }
    for (int i = 0; i < a->interfaces; i++) {
        const spari_interface *v = a->interface + i;
        if (v->cluster == i && v->constraint >= 0) {
            spari_block_tie *of = tie + v->block;
            of->to = block_of_node(a, v->parent);
            for (int k = 0; k < 6; k++) {
                of->held[k / 3] += spari_constraint_holds(a->constraint + v->constraint, k);
            }
        }
    }
    for (int i = 0; i < a->constraints; i++) {
        spari_constraint *l = a->constraint + i;
        int holds = spari_constraint_count(l);
        l->block = -1;
        if (l->role == SPARI_CONSTRAINT_LOOP && holds > 0) {
            size[n] = holds;
            l->block = n++;
            a->loops = 1;
        }
    }
    return n;
}

/* The constraints of a loop closer have full rank only in the relative coordinates of the whole loop. They are
   therefore eliminated after the clusters on both paths, up to the cluster where the paths meet. */
static void close_loop(const spari_assembly *a, const spari_constraint *l, spari_block_pair *before, int64_t *befores) {
    int v[2] = {l->node[0], l->node[1]}, last[2] = {-1, -1};
    while (v[0] != v[1]) {
        int deeper = v[1] < 0 || (v[0] >= 0 && a->interface[v[0]].depth >= a->interface[v[1]].depth) ? 0 : 1;
        last[deeper] = a->interface[v[deeper]].cluster == v[deeper] ? v[deeper] : last[deeper];
        v[deeper] = a->interface[v[deeper]].parent;
    }
    for (int side = 0; side < 2; side++) {
        add_pair(before, befores, block_of_node(a, last[side]), l->block);
    }
}

/* Which blocks have entries, and which come before which. */
static void couple_blocks(const spari_assembly *a, spari_block_pair *coupled, int64_t *count, spari_block_pair *before,
                          int64_t *befores) {
    for (int i = 0; i < a->components; i++) {
        int first = a->component[i].at / 6, ends = a->component[i].condensed->ends;
        for (int j = 0; j < ends; j++) {
            for (int k = 0; k < j; k++) {
                add_pair(coupled, count, block_of_node(a, first + j), block_of_node(a, first + k));
            }
        }
    }
    for (int i = 0; i < a->constraints; i++) {
        const spari_constraint *l = a->constraint + i;
        int block[2] = {block_of_node(a, l->node[0]), block_of_node(a, l->node[1])};
        add_pair(coupled, count, block[0], block[1]);
        for (int side = 0; side < 2; side++) {
            add_pair(coupled, count, l->block, block[side]);
        }
        if (l->block >= 0) {
            close_loop(a, l, before, befores);
        }
    }
    for (int i = 0; i < a->interfaces; i++) {
        const spari_interface *v = a->interface + i;
        if (v->cluster == i && v->constraint >= 0) {
            add_pair(before, befores, v->block, block_of_node(a, v->parent));
        }
    }
}

static int make_blocks(spari_assembly *a) {
    int64_t most = 3 * (int64_t)a->constraints, count = 0, befores = 0;
    for (int i = 0; i < a->components; i++) {
        int64_t ends = a->component[i].condensed->ends;
        most += ends * (ends - 1) / 2;
    }
    int blocks = a->interfaces + a->constraints + 1, *size = spari_zalloc(blocks, sizeof *size);
    spari_block_tie *tie = spari_zalloc(blocks, sizeof *tie);
    spari_block_pair *coupled = spari_zalloc(most + 1, sizeof *coupled),
                     *before = spari_zalloc(2 * (int64_t)a->constraints + a->interfaces + 1, sizeof *before);
    if (size && tie && coupled && before) {
        int n = count_blocks(a, size, tie);
        couple_blocks(a, coupled, &count, before, &befores);
        a->system = spari_blocks_create(n, size, tie, count, coupled, befores, before);
    }
    SPARI_FREE(size, tie, coupled, before);
    return a->system ? SPAR_OK : SPAR_ERR_MEMORY;
}

int spari_system_create(spari_assembly *a) {
    int64_t most = 0, n = 6 * (int64_t)a->interfaces;
    for (int i = 0; i < a->components; i++) {
        most = a->component[i].member->nodes > most ? a->component[i].member->nodes : most;
    }
    SPARI_TRY(make_blocks(a));
    for (int i = 0; i < a->components; i++) {
        int64_t m = 6 * (int64_t)a->component[i].condensed->ends;
        a->component[i].K = spari_zalloc(m * m, sizeof *a->component[i].K);
        if (!a->component[i].K) {
            return SPAR_ERR_MEMORY;
        }
    }
    a->x = spari_zalloc(n + 1, sizeof *a->x);
    a->y = spari_zalloc(n + 1, sizeof *a->y);
    a->b = spari_zalloc(2 * (int64_t)spari_blocks_rows(a->system) + 2, sizeof *a->b);
    a->rates = spari_zalloc(6 * most, sizeof *a->rates);
    a->tangents = a->clusters ? spari_zalloc(a->constraints, sizeof *a->tangents) : NULL;
    return a->x && a->y && a->b && a->rates && (a->tangents || !a->clusters) ? SPAR_OK : SPAR_ERR_MEMORY;
}

void spari_system_free(spari_assembly *a) {
    for (int i = 0; i < a->components && a->component; i++) {
        free(a->component[i].K);
    }
    spari_blocks_free(a->system);
    free(a->interface);
    free(a->order);
    free(a->x);
    free(a->y);
    free(a->b);
    free(a->rates);
    free(a->tangents);
}
