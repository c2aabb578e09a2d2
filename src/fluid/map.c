/* The map of a fluid's nodes: nearest points on the member, and queries about them. */
#include "../base/environment.h"
#include "../base/poison.h"
#include "../base/thread_pool.h"
#include "../math/rotation.h"
#include "../transfer/projection.h"
#include "state.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char *const set_name[2] = {"motion", "force"};

/* Memory and coefficients that depend on the member alone; kept between maps. */
static int prepare_member(spar_fluid *fluid) {
    const spar_member *m = fluid->member;
    int64_t nodes = m->nodes;
    if (fluid->modal) {
        return SPAR_OK;
    }
    fluid->modal = spari_zalloc((int64_t)m->mesh.per_element * m->mesh.per_element, sizeof *fluid->modal);
    fluid->reference = spari_zalloc(nodes * SPARI_FIELDS, sizeof *fluid->reference);
    double *q = spari_zalloc(nodes * 7, sizeof *q);
    struct {
        double **to;
        int64_t size;
    } all[] = {{&fluid->field[0], nodes * SPARI_FIELDS},
               {&fluid->load, 6 * nodes},
               {&fluid->load_new, 6 * nodes},
               {&fluid->load_accepted, 6 * nodes}};
    int whole = fluid->modal && fluid->reference && q && !spari_fluid_reserve_workspace(fluid);
    for (size_t i = 0; i < sizeof all / sizeof all[0]; i++) {
        *all[i].to = spari_zalloc(all[i].size, sizeof(double));
        whole = whole && *all[i].to;
    }
    if (!whole) {
        for (size_t i = 0; i < sizeof all / sizeof all[0]; i++) {
            free(*all[i].to);
            *all[i].to = NULL;
        }
        SPARI_FREE(q, fluid->modal, fluid->reference);
        fluid->modal = fluid->reference = NULL;
        return SPAR_ERR_MEMORY;
    }
    spari_modal_matrix(m->mesh.per_element, fluid->modal);
    for (int64_t l = 0; l < nodes; l++) {
        memcpy(q + 7 * l + 3, m->qr + 4 * l, 4 * sizeof *q);
    }
    spari_field_fill(m->mesh.elements, m->mesh.per_element, fluid->modal, 0, SPARI_UPTO_POSITION, m->xr, q, NULL, NULL,
                     fluid->reference);
    free(q);
    return SPAR_OK;
}

int64_t spari_fluid_workspace_size(const spar_fluid *fluid) {
    const spar_member *m = fluid->member;
    int64_t gather = spari_gather_workspace_size(m->mesh.elements, m->mesh.per_element);
    int64_t pull = (fluid->field[1] ? SPARI_PULL_BOTH : SPARI_PULL_ONE) * SPARI_ROW;
    return gather > pull ? gather : pull;
}

int spari_fluid_reserve_workspace(const spar_fluid *fluid) {
    spar_session *s = fluid->member->session;
    int64_t doubles = spari_fluid_workspace_size(fluid);
    return spari_workspace_reserve(&s->workspace, doubles) || spari_thread_pool_reserve(s->pool, doubles);
}

double *spari_fluid_work(const spar_fluid *fluid, int worker) {
    const spar_session *s = fluid->member->session;
    int64_t doubles = spari_fluid_workspace_size(fluid);
    double *work = worker == 0 ? spari_workspace_at(&s->workspace, doubles)
                               : spari_thread_pool_workspace(s->pool, worker, doubles);
    spari_poison(work, doubles);
    return work;
}

/* Element and local coordinate of a coordinate along the whole line; an element boundary belongs to the lower
   element. */
static int locate(const spar_member *m, double eta, double *local) {
    double along = eta * m->mesh.elements;
    int e = (int)ceil(along) - 1;
    e = e < 0 ? 0 : e > m->mesh.elements - 1 ? m->mesh.elements - 1 : e;
    *local = m->mesh.per_element > 1 ? 2 * (along - e) - 1 : 0;
    return e;
}

/* Nearest points of a set, by node. */
typedef struct points_found {
    int *element;
    double *xi, *con;
    uint8_t *flags;
} points_found;

static void free_points_found(points_found *f) {
    SPARI_FREE(f->element, f->xi, f->con, f->flags);
}

static int alloc_points_found(points_found *f, int64_t n) {
    *f = (points_found){spari_zalloc(n, sizeof *f->element), spari_zalloc(n, sizeof *f->xi),
                        spari_zalloc(3 * n, sizeof *f->con), spari_zalloc(n, sizeof *f->flags)};
    return f->element && f->xi && f->con && f->flags ? SPAR_OK : SPAR_ERR_MEMORY;
}

static void points_of_sections(const spar_fluid *fluid, const spari_node_set *set, points_found *f) {
    for (int64_t j = 0; j < set->n; j++) {
        double x[3], q[4];
        f->element[j] = locate(fluid->member, set->eta[j], &f->xi[j]);
        spari_fluid_reference(fluid, f->element[j], f->xi[j], x, q);
        spari_rotate(q, set->x + 3 * j, f->con + 3 * j);
    }
}

static void flag_far(const spar_fluid *fluid, int64_t n, points_found *f, int64_t *far) {
    for (int64_t j = 0; j < n; j++) {
        if (fluid->max_distance > 0 && spari_norm(f->con + 3 * j) > fluid->max_distance) {
            f->flags[j] |= SPAR_MAP_FAR;
            far[0]++;
            far[1] = far[0] == 1 ? j : far[1];
        }
    }
}

static int no_memory_to_map(const spar_fluid *fluid, const char *caller, int64_t n, int which) {
    return spari_fluid_refuse(fluid, SPAR_ERR_MEMORY, caller, "no memory to map %lld %s nodes", (long long)n,
                              set_name[which]);
}

/* Maps one set into *made; the fluid is not changed. */
static int map_set(const spar_fluid *fluid, int which, const spari_line *line, spari_nodes **made, const char *caller) {
    const spar_member *m = fluid->member;
    const spari_node_set *set = &fluid->set[which];
    int64_t far[2] = {0, 0}, n = set->pending ? set->n : set->nodes->n;
    points_found f;
    double *again = set->pending ? NULL : spari_fluid_positions(fluid, set->nodes);
    *made = spari_nodes_create(n, m->mesh.elements, m->mesh.per_element);
    if (alloc_points_found(&f, n) != SPAR_OK || !*made || !(set->pending || again)) {
        free_points_found(&f);
        free(again);
        return no_memory_to_map(fluid, caller, n, which);
    }
    const double *x = set->pending ? set->x : again;
    if (set->sections) {
        points_of_sections(fluid, set, &f);
    } else {
        if (spari_line_project(line, m->session->pool, fluid->method, n, x, f.element, f.xi, f.con, f.flags)) {
            free_points_found(&f);
            free(again);
            return no_memory_to_map(fluid, caller, n, which);
        }
        for (int64_t i = 0; i < 3 * n; i++) {
            f.con[i] = x[i] - f.con[i];
        }
        flag_far(fluid, n, &f, far);
    }
    (*made)->pool = &m->session->pool;
    spari_nodes_put(*made, f.element, f.xi, f.con, f.flags);
    free_points_found(&f);
    free(again);
    SPARI_FLUID_REQUIRE_OF(fluid, caller, far[0] == 0 || !fluid->options.far_refuse, SPAR_ERR_MAPPING,
                           "%lld of %lld %s nodes lie farther than %g from the line, the first is node %lld; "
                           "move them, increase max_distance, or accept them with the option far = take",
                           (long long)far[0], (long long)n, set_name[which], fluid->max_distance, (long long)far[1]);
    return SPAR_OK;
}

/* A history for n new force nodes. As many stations as before keep their forces. Of other nodes no forces are known
   before they are pushed, unless the fluid has no loads. */
static int renew_history(spar_fluid *fluid, int64_t n) {
    const spari_history *was = fluid->history;
    int sections = spari_fluid_set(fluid, SPAR_NODES_FORCE)->sections;
    if (was && was->sections && sections && was->n == n) {
        return SPAR_OK;
    }
    spari_history *h = spari_history_create(n, fluid->member->session->coupling.predictor);
    if (!h) {
        return SPAR_ERR_MEMORY;
    }
    h->sections = sections;
    h->known = spari_fluid_has_loads(fluid) ? 0 : SPARI_MOST_PAST;
    spari_history_free(fluid->history);
    fluid->history = h;
    return SPAR_OK;
}

/* Sections imply node forces (a blade-element host has one set of nodes, an actuator line needs their forces),
   unless the host has switched the effect off. */
static int keeps_forces(const spar_fluid *fluid) {
    const spar_member *m = fluid->member;
    return fluid->history || (m->effects & SPAR_EFFECT_FLUID_HISTORY) ||
           (spari_fluid_set(fluid, SPAR_NODES_FORCE)->sections && !(m->effects_off & SPAR_EFFECT_FLUID_HISTORY));
}

/* Makes all data per force node anew, or nothing if it fails. */
static int renew_by_node(spar_fluid *fluid, int64_t n) {
    spari_states *made = fluid->states ? spari_states_create(n, fluid->states->width) : NULL;
    int status = fluid->states && !made ? SPAR_ERR_MEMORY : SPAR_OK;
    if (status == SPAR_OK && keeps_forces(fluid)) {
        status = renew_history(fluid, n);
    }
    if (status != SPAR_OK || !made) {
        spari_states_free(made);
        return status;
    }
    spari_states_free(fluid->states);
    fluid->states = made;
    return SPAR_OK;
}

static void take_nodes(spari_node_set *set, spari_nodes *nodes) {
    spari_node_set was = *set;
    double farthest = 0;
    for (int64_t p = 0; p < nodes->n; p++) {
        farthest = fmax(farthest, spari_norm((const double[3]){nodes->con[0][p], nodes->con[1][p], nodes->con[2][p]}));
    }
    *set = (spari_node_set){.sections = was.sections,
                            .n = nodes->n,
                            .nodes = nodes,
                            .farthest = farthest,
                            .weight = was.weight,
                            .home = was.home,
                            .fade = was.fade};
    was.weight = was.home = NULL, was.fade = NULL; /* they belong to nodes, whatever the line */
    spari_node_set_clear(&was);
}

/* Replaces positions given in the present configuration by those of the reference, and keeps the former. */
static int refer_positions(spar_fluid *fluid, const spari_line *line, double *given[2], const char *caller) {
    for (int which = 0; which < 2; which++) {
        spari_node_set *set = &fluid->set[which];
        if (!set->pending || set->sections) {
            continue;
        }
        SPARI_FLUID_REQUIRE_OF(fluid, caller, !set->weight, SPAR_ERR_UNSUPPORTED,
                               "motion nodes with weights cannot be given in the present configuration; give their "
                               "reference positions and call spar_fluid_map");
        double *x = spari_fluid_reference_of_present(fluid, line, set->n, set->x);
        if (!x) {
            return no_memory_to_map(fluid, caller, set->n, which);
        }
        given[which] = set->x;
        set->x = x;
    }
    return SPAR_OK;
}

/* Restores the positions as given after a refusal. */
static void end_referring(spar_fluid *fluid, double *given[2], int status) {
    for (int which = 0; which < 2; which++) {
        if (given[which] && status != SPAR_OK) {
            free(fluid->set[which].x);
            fluid->set[which].x = given[which];
        } else {
            free(given[which]);
        }
    }
}

/* Maps what is new, and remaps positions, into made[2]; the fluid is not changed. */
static int map_sets(const spar_fluid *fluid, const spari_line *line, double *const given[2], spari_nodes *made[2],
                    const char *caller) {
    for (int which = 0; which < 2; which++) {
        const spari_node_set *set = &fluid->set[which];
        if (set->pending || (set->nodes && !set->sections)) {
            SPARI_TRY(map_set(fluid, which, line, &made[which], caller));
        }
        if (given[which]) {
            SPARI_TRY(spari_fluid_check_present(fluid, which, made[which], given[which], caller));
        }
    }
    return SPAR_OK;
}

/* Puts the map in force. A refusal changes nothing. */
static int use_map(spar_fluid *fluid, spari_nodes *made[2], const char *caller) {
    spari_fade *fade = fluid->set[SPAR_NODES_MOTION].fade;
    const spari_node_set *force = spari_fluid_set(fluid, SPAR_NODES_FORCE);
    SPARI_FLUID_REQUIRE_OF(fluid, caller, !force->pending || renew_by_node(fluid, force->n) == SPAR_OK, SPAR_ERR_MEMORY,
                           "no memory for the node forces");
    if (fade && spari_fade_map(fade, made[SPAR_NODES_MOTION])) {
        return no_memory_to_map(fluid, caller, made[SPAR_NODES_MOTION]->n, SPAR_NODES_MOTION);
    }
    for (int which = 0; which < 2; which++) {
        if (made[which]) {
            take_nodes(&fluid->set[which], made[which]);
            made[which] = NULL;
        }
    }
    return SPAR_OK;
}

int spari_fluid_map(spar_fluid *fluid, int present, const char *caller) {
    const spar_member *m = fluid->member;
    SPARI_FLUID_REQUIRE_OF(fluid, caller, m->committed, SPAR_ERR_STATE,
                           "the member is not committed; call spar_member_commit first");
    SPARI_TRY(spari_fluid_check_idle(fluid, caller));
    SPARI_FLUID_REQUIRE_OF(fluid, caller, prepare_member(fluid) == SPAR_OK, SPAR_ERR_MEMORY, "no memory to map");
    spari_line *line = spari_line_create(m->mesh.elements, m->mesh.per_element, m->xr);
    SPARI_FLUID_REQUIRE_OF(fluid, caller, line, SPAR_ERR_MEMORY, "no memory to map");
    spari_nodes *made[2] = {NULL, NULL};
    double *given[2] = {NULL, NULL};
    int status = present ? refer_positions(fluid, line, given, caller) : SPAR_OK;
    status = status == SPAR_OK ? map_sets(fluid, line, given, made, caller) : status;
    status = status == SPAR_OK ? use_map(fluid, made, caller) : status;
    end_referring(fluid, given, status);
    spari_line_free(line);
    spari_nodes_free(made[0]);
    spari_nodes_free(made[1]);
    return status;
}

int spar_fluid_map(spar_fluid *fluid) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_FLUID_HANDLE(fluid);
    SPARI_TRY(spari_fluid_map(fluid, 0, __func__));
    spari_fluid_warn_far(fluid);
    spari_fluid_warn_present(fluid);
    return SPAR_OK;
}

int spar_fluid_map_current(spar_fluid *fluid) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_FLUID_HANDLE(fluid);
    SPARI_TRY(spari_fluid_map(fluid, 1, __func__));
    spari_fluid_warn_far(fluid);
    return SPAR_OK;
}

int spari_fluid_check_which(const spar_fluid *fluid, int which, const char *caller) {
    SPARI_FLUID_REQUIRE_OF(fluid, caller, which == SPAR_NODES_MOTION || which == SPAR_NODES_FORCE, SPAR_ERR_ARGUMENT,
                           "node set %d is not known; give SPAR_NODES_MOTION or SPAR_NODES_FORCE", which);
    return SPAR_OK;
}

int spari_fluid_mapped(const spar_fluid *fluid, int which, const char *caller, const spari_nodes **nodes) {
    SPARI_TRY(spari_fluid_check_which(fluid, which, caller));
    const spari_node_set *set = spari_fluid_set(fluid, which);
    *nodes = set->nodes;
    SPARI_FLUID_REQUIRE_OF(fluid, caller, !set->pending, SPAR_ERR_STATE,
                           "the %s nodes are given but not mapped; call spar_fluid_map", set_name[which]);
    return SPAR_OK;
}

int spari_fluid_is_pending(const spar_fluid *fluid) {
    return (fluid->set[0].pending && fluid->set[0].n > 0) || (fluid->set[1].pending && fluid->set[1].n > 0);
}

int spari_fluid_need_mapped(const spar_fluid *fluid, const char *caller) {
    const spari_nodes *nodes;
    for (int which = 0; which < 2 && spari_fluid_is_pending(fluid); which++) {
        SPARI_TRY(spari_fluid_mapped(fluid, which, caller, &nodes));
    }
    return SPAR_OK;
}

int spar_fluid_get_count(const spar_fluid *fluid, int which, int64_t *n) {
    SPARI_FLUID_HANDLE(fluid);
    SPARI_TRY(spari_fluid_check_which(fluid, which, __func__));
    SPARI_FLUID_REQUIRE(fluid, n, SPAR_ERR_ARGUMENT, "the pointer to the count is NULL");
    *n = spari_fluid_set(fluid, which)->n;
    return SPAR_OK;
}

int spar_fluid_get_kind(const spar_fluid *fluid, int which, int *kind) {
    SPARI_FLUID_HANDLE(fluid);
    SPARI_TRY(spari_fluid_check_which(fluid, which, __func__));
    SPARI_FLUID_REQUIRE(fluid, kind, SPAR_ERR_ARGUMENT, "the pointer to the kind is NULL");
    const spari_node_set *set = spari_fluid_set(fluid, which);
    int bears_forces = which == SPAR_NODES_FORCE || fluid->shared;
    *kind = (set->sections ? SPAR_KIND_STATIONS : 0) | (fluid->shared ? SPAR_KIND_SHARED : 0) |
            (set->weight ? SPAR_KIND_WEIGHTS : 0) |
            (bears_forces && fluid->history && spari_history_is_known(fluid->history) ? SPAR_KIND_FORCES : 0);
    return SPAR_OK;
}

int spar_fluid_get_flag_count(const spar_fluid *fluid, int which, int flag, int64_t *n) {
    SPARI_FLUID_HANDLE(fluid);
    const spari_nodes *s;
    SPARI_TRY(spari_fluid_mapped(fluid, which, __func__, &s));
    SPARI_FLUID_REQUIRE(fluid, n, SPAR_ERR_ARGUMENT, "the pointer to the count is NULL");
    int64_t count = 0;
    for (int64_t j = 0; s && j < s->n; j++) {
        count += (s->flags[j] & flag) != 0;
    }
    *n = count;
    return SPAR_OK;
}

int spar_fluid_get_map(const spar_fluid *fluid, int which, double *eta, double *distance, int *flags) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_FLUID_HANDLE(fluid);
    const spari_nodes *s;
    SPARI_TRY(spari_fluid_mapped(fluid, which, __func__, &s));
    int64_t n =
        s && (eta || distance || flags) ? s->n : 0; /* without an array the question is whether there is a map */
    for (int64_t p = 0; p < n; p++) {
        int64_t j = spari_nodes_node(s, p);
        double con[3] = {s->con[0][p], s->con[1][p], s->con[2][p]};
        if (eta) {
            eta[j] = spari_member_eta(fluid->member, spari_nodes_element(s, p), spari_nodes_xi(s, p));
        }
        if (distance) {
            distance[j] = spari_norm(con);
        }
        if (flags) {
            flags[j] = s->flags[j];
        }
    }
    return SPAR_OK;
}

int spar_fluid_get_nearest(const spar_fluid *fluid, int which, double *x_map, double *q_map, double *con) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_FLUID_HANDLE(fluid);
    const spari_nodes *s;
    SPARI_TRY(spari_fluid_mapped(fluid, which, __func__, &s));
    for (int64_t p = 0; s && p < s->n; p++) {
        int64_t j = spari_nodes_node(s, p);
        double x[3], q[4];
        spari_fluid_frame(fluid, spari_fluid_set(fluid, which), p, x, q);
        if (x_map) {
            memcpy(x_map + 3 * j, x, sizeof x);
        }
        if (q_map) {
            memcpy(q_map + 4 * j, q, sizeof q);
        }
        for (int i = 0; con && i < 3; i++) {
            con[3 * j + i] = s->con[i][p];
        }
    }
    return SPAR_OK;
}

int spar_fluid_get_basis(const spar_fluid *fluid, int which, int64_t *first_node, double *phi) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_FLUID_HANDLE(fluid);
    const spari_nodes *s;
    SPARI_TRY(spari_fluid_mapped(fluid, which, __func__, &s));
    int n = fluid->member->mesh.per_element;
    double x[SPARI_MAX_NODES], bary[SPARI_MAX_NODES];
    spari_gll(n, x, NULL, bary);
    for (int64_t p = 0; s && p < s->n; p++) {
        int64_t j = spari_nodes_node(s, p);
        if (first_node) {
            first_node[j] = (int64_t)spari_nodes_element(s, p) * n;
        }
        if (phi) {
            spari_lagrange(n, x, bary, spari_nodes_xi(s, p), phi + j * n, NULL);
        }
    }
    return SPAR_OK;
}
