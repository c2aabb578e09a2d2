#include "fluid.h"
#include "../base/quiet.h"

#include "../math/predictor.h"
#include "../math/rotation.h"
#include "../transfer/projection.h"
#include "state.h"
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const set_name[2] = {"motion", "force"};

int spari_fluid_refuse(const spar_fluid *fluid, int status, const char *caller, const char *format, ...) {
    char text[SPARI_MESSAGE_SIZE];
    va_list list;
    va_start(list, format);
    vsnprintf(text, sizeof text, format, list);
    va_end(list);
    return spari_fail(fluid->member->session, status, "%s: fluid '%s' of member '%s': %s", caller, fluid->name,
                      fluid->member->name, text);
}
/* ---- life ---- */

int spar_fluid_create(spar_member *member, const char *name, spar_fluid **fluid) {
    SPARI_REQUIRE(NULL, member, SPAR_ERR_ARGUMENT, "spar_fluid_create: the member is NULL; create it first");
    spar_session *session = member->session;
    SPARI_REQUIRE(session, fluid, SPAR_ERR_ARGUMENT, "spar_fluid_create: member '%s': the place for the handle is NULL",
                  member->name);
    SPARI_REQUIRE(session, !session->trial, SPAR_ERR_STATE,
                  "spar_fluid_create: member '%s': a trial run is under way; create fluids before or after it",
                  member->name);
    SPARI_REQUIRE(session, name && name[0], SPAR_ERR_ARGUMENT,
                  "spar_fluid_create: member '%s': the fluid needs a name; messages use it", member->name);
    spar_fluid *made = spari_zalloc(1, sizeof *made);
    char *copy = spari_zalloc((int64_t)strlen(name) + 1, 1);
    if (!made || !copy) {
        free(made);
        free(copy);
        return spari_fail(session, SPAR_ERR_MEMORY, "spar_fluid_create: member '%s': no memory for a fluid",
                          member->name);
    }
    strcpy(copy, name);
    made->member = member, made->name = copy;
    spar_fluid **end = &session->fluids; /* at the end: loads are added in order of creation */
    while (*end) {
        end = &(*end)->next;
    }
    *end = made;
    *fluid = made;
    return SPAR_OK;
}

static void clear_set(spari_node_set *set) {
    free(set->x);
    free(set->xi);
    spari_nodes_free(set->nodes);
    *set = (spari_node_set){0};
}

void spari_history_free(spari_history *h) {
    if (!h) {
        return;
    }
    free(h->after);
    for (int i = 0; i < 3; i++) {
        free(h->past[i]);
    }
    free(h);
}

spari_history *spari_history_create(int64_t n, int order) {
    spari_history *h = spari_zalloc(1, sizeof *h);
    if (!h) {
        return NULL;
    }
    h->n = n;
    h->after = spari_zalloc(3 * n, sizeof *h->after);
    if (!h->after || spari_history_keep(h->past, 3 * n, order) != SPAR_OK) {
        spari_history_free(h);
        return NULL;
    }
    return h;
}

void spari_fluid_free(spar_fluid *fluid) {
    if (!fluid) {
        return;
    }
    clear_set(&fluid->set[0]);
    clear_set(&fluid->set[1]);
    spari_history_free(fluid->history);
    spari_history_free(fluid->history_next);
    double *all[] = {fluid->modal,   fluid->field[0], fluid->field[1],     fluid->reference,
                     fluid->work,    fluid->load,     fluid->load_new,     fluid->load_accepted,
                     fluid->mean[0], fluid->mean[1],  fluid->mean_next[0], fluid->mean_next[1]};
    for (size_t i = 0; i < sizeof all / sizeof all[0]; i++) {
        free(all[i]);
    }
    free(fluid->why);
    free(fluid->name);
    free(fluid);
}

void spar_fluid_destroy(spar_fluid **fluid) {
    if (!fluid || !*fluid || (*fluid)->member->session->trial) { /* what it was is needed after the trial */
        return;
    }
    spar_fluid **at = &(*fluid)->member->session->fluids;
    while (*at && *at != *fluid) {
        at = &(*at)->next;
    }
    if (*at) {
        *at = (*fluid)->next;
    }
    spari_fluid_free(*fluid);
    *fluid = NULL;
}

spar_fluid *spari_fluid_next(const spar_fluid *fluid) {
    return fluid->next;
}

spar_member *spari_fluid_member(const spar_fluid *fluid) {
    return fluid->member;
}

spar_session *spari_fluid_session(const spar_fluid *fluid) {
    return fluid->member->session;
}

const char *spari_fluid_name(const spar_fluid *fluid) {
    return fluid->name;
}

/* ---- what the host gives ---- */

static int check_idle(const spar_fluid *fluid, const char *caller) {
    if (fluid->member->session->phase != SPARI_IDLE) {
        return spari_fluid_refuse(
            fluid, SPAR_ERR_STATE, caller,
            "a step is under way; change nodes and maps after spar_step_accept or spar_step_reject");
    }
    if (fluid->member->session->trial) {
        return spari_fluid_refuse(fluid, SPAR_ERR_STATE, caller,
                                  "a trial run is under way; its fluids are not to be changed");
    }
    return SPAR_OK;
}

int spari_fluid_check_values(const spar_fluid *fluid, const char *caller, const char *what, const double *x, int64_t n,
                             int width) {
    int64_t bad = spari_first_nonfinite(x, n * width);
    if (bad >= 0) {
        return spari_fluid_refuse(fluid, SPAR_ERR_ARGUMENT, caller, "%s %lld, component %d, is %g; give finite numbers",
                                  what, (long long)(bad / width), (int)(bad % width), x[bad]);
    }
    return SPAR_OK;
}

/* A copy of x [n], zeros for NULL. */
static double *copy_of(const double *x, int64_t n) {
    double *copy = spari_zalloc(n, sizeof *copy);
    if (copy && x && n > 0) {
        memcpy(copy, x, sizeof *copy * (size_t)n);
    }
    return copy;
}

static int set_places(spar_fluid *fluid, int which, int64_t n, const double *x, const char *caller) {
    SPARI_TRY(check_idle(fluid, caller));
    if (n < 0 || n > SPARI_MOST || (n > 0 && !x)) {
        return spari_fluid_refuse(fluid, SPAR_ERR_ARGUMENT, caller, "%lld nodes%s; give 0 to 2^40, and n x 3 places",
                                  (long long)n, x ? "" : " without places");
    }
    SPARI_TRY(
        spari_fluid_check_values(fluid, caller, which == SPAR_NODES_MOTION ? "motion node" : "force node", x, n, 3));
    double *copy = copy_of(x, 3 * n);
    if (!copy) {
        return spari_fluid_refuse(fluid, SPAR_ERR_MEMORY, caller, "no memory for %lld nodes", (long long)n);
    }
    if (fluid->shared) { /* sections served both; the other set keeps them */
        fluid->shared = 0;
        if (which == SPAR_NODES_MOTION) {
            fluid->set[SPAR_NODES_FORCE] = fluid->set[SPAR_NODES_MOTION];
            fluid->set[SPAR_NODES_MOTION] = (spari_node_set){0};
        }
    }
    clear_set(&fluid->set[which]);
    fluid->set[which] = (spari_node_set){.pending = 1, .n = n, .x = copy};
    return SPAR_OK;
}

int spar_fluid_set_motion_nodes(spar_fluid *fluid, int64_t n, const double *x) {
    SPARI_QUIET;
    SPARI_FLUID_HANDLE(fluid);
    return set_places(fluid, SPAR_NODES_MOTION, n, x, __func__);
}

int spar_fluid_set_force_nodes(spar_fluid *fluid, int64_t n, const double *x) {
    SPARI_QUIET;
    SPARI_FLUID_HANDLE(fluid);
    return set_places(fluid, SPAR_NODES_FORCE, n, x, __func__);
}

int spar_fluid_set_sections(spar_fluid *fluid, int64_t n, const double *xi, const double *offset) {
    SPARI_QUIET;
    SPARI_FLUID_HANDLE(fluid);
    SPARI_TRY(check_idle(fluid, __func__));
    SPARI_FLUID_REQUIRE(fluid, n >= 0 && n <= SPARI_MOST && (n == 0 || xi), SPAR_ERR_ARGUMENT,
                        "%lld sections%s; give 0 to 2^40, and n coordinates", (long long)n,
                        xi ? "" : " without coordinates");
    for (int64_t j = 0; j < n; j++) {
        SPARI_FLUID_REQUIRE(fluid, xi[j] >= -1 && xi[j] <= 1, SPAR_ERR_ARGUMENT,
                            "section %lld: xi = %g lies outside [-1,1]; xi = 2 eta - 1 over the whole beam",
                            (long long)j, xi[j]);
    }
    if (offset) {
        SPARI_TRY(spari_fluid_check_values(fluid, __func__, "offset of section", offset, n, 3));
    }
    double *copy = copy_of(offset, 3 * n), *at = copy_of(xi, n);
    if (!copy || !at) {
        free(copy);
        free(at);
        return spari_fluid_refuse(fluid, SPAR_ERR_MEMORY, __func__, "no memory for %lld sections", (long long)n);
    }
    clear_set(&fluid->set[0]);
    clear_set(&fluid->set[1]);
    fluid->shared = 1;
    fluid->set[SPAR_NODES_MOTION] = (spari_node_set){.pending = 1, .sections = 1, .n = n, .x = copy, .xi = at};
    return SPAR_OK;
}

int spar_fluid_set_projection(spar_fluid *fluid, int method, double max_distance) {
    SPARI_QUIET;
    SPARI_FLUID_HANDLE(fluid);
    SPARI_TRY(check_idle(fluid, __func__));
    SPARI_FLUID_REQUIRE(fluid, method == SPAR_PROJECT_BOUNDED || method == SPAR_PROJECT_RPOLY, SPAR_ERR_ARGUMENT,
                        "projection method %d is not known; SPAR_PROJECT_BOUNDED or SPAR_PROJECT_RPOLY", method);
    SPARI_FLUID_REQUIRE(fluid, !isnan(max_distance), SPAR_ERR_ARGUMENT,
                        "max_distance is not a number; <= 0 means no limit");
    fluid->method = method;
    fluid->max_distance = max_distance;
    return SPAR_OK;
}

int spar_fluid_set_interpolation(spar_fluid *fluid, int kind) {
    SPARI_QUIET;
    SPARI_FLUID_HANDLE(fluid);
    SPARI_TRY(check_idle(fluid, __func__));
    SPARI_FLUID_REQUIRE(fluid, kind == SPAR_INTERPOLATE_NODAL || kind == SPAR_INTERPOLATE_CONSISTENT, SPAR_ERR_ARGUMENT,
                        "interpolation %d is not known; SPAR_INTERPOLATE_NODAL or SPAR_INTERPOLATE_CONSISTENT", kind);
    fluid->consistent = kind == SPAR_INTERPOLATE_CONSISTENT;
    return SPAR_OK;
}

/* ---- the map ---- */

/* Memory and coefficients that depend on the member alone; kept from map to map. */
static int prepare_member(spar_fluid *fluid) {
    const spar_member *m = fluid->member;
    int64_t nodes = m->nodes;
    if (fluid->modal) {
        return SPAR_OK;
    }
    fluid->modal = spari_zalloc((int64_t)m->per_element * m->per_element, sizeof *fluid->modal);
    fluid->reference = spari_zalloc(nodes * SPARI_FIELDS, sizeof *fluid->reference);
    double *q = spari_zalloc(nodes * 7, sizeof *q);
    struct {
        double **to;
        int64_t width;
    } all[] = {{&fluid->field[0], SPARI_FIELDS},
               {&fluid->work, 14},
               {&fluid->load, 6},
               {&fluid->load_new, 6},
               {&fluid->load_accepted, 6}};
    int whole = fluid->modal && fluid->reference && q;
    for (size_t i = 0; i < sizeof all / sizeof all[0]; i++) {
        *all[i].to = spari_zalloc(nodes * all[i].width, sizeof(double));
        whole = whole && *all[i].to;
    }
    if (!whole) {
        for (size_t i = 0; i < sizeof all / sizeof all[0]; i++) {
            free(*all[i].to);
            *all[i].to = NULL;
        }
        free(q);
        free(fluid->modal);
        free(fluid->reference);
        fluid->modal = fluid->reference = NULL;
        return SPAR_ERR_MEMORY;
    }
    spari_modal_matrix(m->per_element, fluid->modal);
    for (int64_t l = 0; l < nodes; l++) {
        memcpy(q + 7 * l + 3, m->qr + 4 * l, 4 * sizeof *q);
    }
    spari_field_fill(m->elements, m->per_element, fluid->modal, 0, SPARI_UPTO_PLACE, m->xr, q, NULL, NULL,
                     fluid->reference);
    free(q);
    return SPAR_OK;
}

/* sum_k T_k(xi) c[k][offset .. offset + n) */
static void field_at(const double *c, int modes, int offset, int n, double xi, double *out) {
    double t0 = 1, t1 = xi;
    memset(out, 0, sizeof *out * (size_t)n);
    for (int k = 0; k < modes; k++) {
        for (int f = 0; f < n; f++) {
            out[f] += t0 * c[k * SPARI_FIELDS + offset + f];
        }
        double t2 = 2 * xi * t1 - t0;
        t0 = t1, t1 = t2;
    }
}

/* Reference foot and its orientation (the spec's normalised sum of the nodes' quaternions). */
void spari_fluid_reference(const spar_fluid *fluid, int element, double xi, double x[3], double q[4]) {
    int modes = fluid->member->per_element;
    const double *c = fluid->reference + (ptrdiff_t)element * modes * SPARI_FIELDS;
    field_at(c, modes, SPARI_F_PLACE, 3, xi, x);
    field_at(c, modes, SPARI_F_QUAT, 4, xi, q);
    spari_quat_normalise(q);
}

/* Element and local coordinate of a place along the whole line; a joint belongs to the lower element. */
static int locate(const spar_member *m, double xi, double *local) {
    double eta = 0.5 * (xi + 1) * m->elements;
    int e = (int)ceil(eta) - 1;
    e = e < 0 ? 0 : e > m->elements - 1 ? m->elements - 1 : e;
    *local = m->per_element > 1 ? 2 * (eta - e) - 1 : 0;
    return e;
}

/* Feet of a set, by node. */
typedef struct feet {
    int *element;
    double *xi, *con;
    uint8_t *flags;
} feet;

static void free_feet(feet *f) {
    free(f->element);
    free(f->xi);
    free(f->con);
    free(f->flags);
}

static int alloc_feet(feet *f, int64_t n) {
    *f = (feet){spari_zalloc(n, sizeof *f->element), spari_zalloc(n, sizeof *f->xi),
                spari_zalloc(3 * n, sizeof *f->con), spari_zalloc(n, sizeof *f->flags)};
    return f->element && f->xi && f->con && f->flags ? SPAR_OK : SPAR_ERR_MEMORY;
}

static void feet_of_sections(const spar_fluid *fluid, const spari_node_set *set, feet *f) {
    for (int64_t j = 0; j < set->n; j++) {
        double x[3], q[4];
        f->element[j] = locate(fluid->member, set->xi[j], &f->xi[j]);
        spari_fluid_reference(fluid, f->element[j], f->xi[j], x, q);
        spari_rotate(q, set->x + 3 * j, f->con + 3 * j);
    }
}

static void flag_far(const spar_fluid *fluid, int64_t n, feet *f, int64_t *far) {
    for (int64_t j = 0; j < n; j++) {
        if (fluid->max_distance > 0 && spari_norm(f->con + 3 * j) > fluid->max_distance) {
            f->flags[j] |= SPAR_MAP_FAR;
            far[0]++;
            far[1] = far[0] == 1 ? j : far[1];
        }
    }
}

double *spari_fluid_places(const spar_fluid *fluid, const spari_nodes *s) {
    double *x = spari_zalloc(3 * s->n, sizeof *x);
    for (int64_t p = 0; x && p < s->n; p++) {
        double foot[3], q[4];
        spari_fluid_reference(fluid, spari_nodes_element(s, p), spari_nodes_xi(s, p), foot, q);
        for (int i = 0; i < 3; i++) {
            x[3 * spari_nodes_node(s, p) + i] = foot[i] + s->con[i][p];
        }
    }
    return x;
}

/* Ties one set to the line, into *made; nothing of the fluid changes. */
static int map_set(const spar_fluid *fluid, int which, const spari_line *line, spari_nodes **made, const char *caller) {
    const spar_member *m = fluid->member;
    const spari_node_set *set = &fluid->set[which];
    int64_t far[2] = {0, 0}, n = set->pending ? set->n : set->nodes->n;
    feet f;
    double *again = set->pending ? NULL : spari_fluid_places(fluid, set->nodes);
    *made = spari_nodes_create(n, m->elements, m->per_element);
    if (alloc_feet(&f, n) != SPAR_OK || !*made || !(set->pending || again)) {
        free_feet(&f);
        free(again);
        return spari_fluid_refuse(fluid, SPAR_ERR_MEMORY, caller, "no memory to map %lld %s nodes", (long long)n,
                                  set_name[which]);
    }
    const double *x = set->pending ? set->x : again;
    if (set->sections) {
        feet_of_sections(fluid, set, &f);
    } else {
        spari_line_project(line, fluid->method, n, x, f.element, f.xi, f.con, f.flags);
        for (int64_t i = 0; i < 3 * n; i++) {
            f.con[i] = x[i] - f.con[i];
        }
        flag_far(fluid, n, &f, far);
    }
    spari_nodes_put(*made, f.element, f.xi, f.con, f.flags);
    free_feet(&f);
    free(again);
    if (far[0] > 0 && m->session->far_refuse) {
        return spari_fluid_refuse(
            fluid, SPAR_ERR_MAPPING, caller,
            "%lld of %lld %s nodes lie farther than %g from the line, the first is node %lld; move them, raise "
            "max_distance, or take them with the option fluid.far = take",
            (long long)far[0], (long long)n, set_name[which], fluid->max_distance, (long long)far[1]);
    }
    return SPAR_OK;
}

/* A history for n nodes in place of the old one. */
int spari_fluid_renew_history(spar_fluid *fluid, int64_t n) {
    spari_history *h = spari_history_create(n, fluid->member->session->predictor);
    if (!h) {
        return SPAR_ERR_MEMORY;
    }
    spari_history_free(fluid->history);
    fluid->history = h;
    return SPAR_OK;
}

/* Sections imply it (a blade element host has one set of nodes, an actuator line asks for their forces), unless the
   host has said which effects it wants. */
static int keeps_forces(const spar_fluid *fluid) {
    const spar_member *m = fluid->member;
    return fluid->history || (m->effects & SPAR_EFFECT_FLUID_HISTORY) || (fluid->shared && !m->effects_given);
}

static void take_nodes(spari_node_set *set, spari_nodes *nodes) {
    int sections = set->sections;
    clear_set(set);
    *set = (spari_node_set){.sections = sections, .n = nodes->n, .nodes = nodes};
}

int spar_fluid_map(spar_fluid *fluid) {
    SPARI_QUIET;
    SPARI_FLUID_HANDLE(fluid);
    const spar_member *m = fluid->member;
    SPARI_FLUID_REQUIRE(fluid, m->committed, SPAR_ERR_STATE,
                        "the member is not committed; call spar_member_commit first");
    SPARI_TRY(check_idle(fluid, __func__));
    SPARI_FLUID_REQUIRE(fluid, prepare_member(fluid) == SPAR_OK, SPAR_ERR_MEMORY, "no memory to map");
    spari_line *line = spari_line_create(m->elements, m->per_element, m->xr);
    SPARI_FLUID_REQUIRE(fluid, line, SPAR_ERR_MEMORY, "no memory to map");
    spari_nodes *made[2] = {NULL, NULL};
    int status = SPAR_OK, fresh = spari_fluid_set(fluid, SPAR_NODES_FORCE)->pending;
    for (int which = 0; which < 2 && status == SPAR_OK; which++) {
        const spari_node_set *set = &fluid->set[which];
        if (set->pending || (set->nodes && !set->sections)) {
            status = map_set(fluid, which, line, &made[which], __func__);
        }
    }
    spari_line_free(line);
    if (status == SPAR_OK && fresh && keeps_forces(fluid)) {
        if (spari_fluid_renew_history(fluid, spari_fluid_set(fluid, SPAR_NODES_FORCE)->n) != SPAR_OK) {
            status = spari_fluid_refuse(fluid, SPAR_ERR_MEMORY, __func__, "no memory for the node forces");
        }
    }
    for (int which = 0; which < 2; which++) {
        if (status == SPAR_OK && made[which]) {
            take_nodes(&fluid->set[which], made[which]);
        } else {
            spari_nodes_free(made[which]);
        }
    }
    return status;
}

/* The mapped set, or a refusal: *nodes NULL means there is none and nothing to do. */
int spari_fluid_mapped(const spar_fluid *fluid, int which, const char *caller, const spari_nodes **nodes) {
    const spari_node_set *set = spari_fluid_set(fluid, which);
    *nodes = set->nodes;
    if (set->pending) {
        return spari_fluid_refuse(fluid, SPAR_ERR_STATE, caller,
                                  "the %s nodes are given but not mapped; call spar_fluid_map", set_name[which]);
    }
    return SPAR_OK;
}

static int check_which(const spar_fluid *fluid, int which, const char *caller) {
    if (which != SPAR_NODES_MOTION && which != SPAR_NODES_FORCE) {
        return spari_fluid_refuse(fluid, SPAR_ERR_ARGUMENT, caller,
                                  "node set %d is not known; SPAR_NODES_MOTION or SPAR_NODES_FORCE", which);
    }
    return SPAR_OK;
}

int spar_fluid_get_count(const spar_fluid *fluid, int which, int64_t *n) {
    SPARI_FLUID_HANDLE(fluid);
    SPARI_TRY(check_which(fluid, which, __func__));
    SPARI_FLUID_REQUIRE(fluid, n, SPAR_ERR_ARGUMENT, "the place for the count is NULL");
    *n = spari_fluid_set(fluid, which)->n;
    return SPAR_OK;
}

int spar_fluid_get_flag_count(const spar_fluid *fluid, int which, int flag, int64_t *n) {
    SPARI_FLUID_HANDLE(fluid);
    SPARI_TRY(check_which(fluid, which, __func__));
    SPARI_FLUID_REQUIRE(fluid, n, SPAR_ERR_ARGUMENT, "the place for the count is NULL");
    const spari_nodes *s;
    SPARI_TRY(spari_fluid_mapped(fluid, which, __func__, &s));
    int64_t count = 0;
    for (int64_t j = 0; s && j < s->n; j++) {
        count += (s->flags[j] & flag) != 0;
    }
    *n = count;
    return SPAR_OK;
}

int spar_fluid_get_map(const spar_fluid *fluid, int which, double *xi, double *distance, int *flags) {
    SPARI_QUIET;
    SPARI_FLUID_HANDLE(fluid);
    SPARI_TRY(check_which(fluid, which, __func__));
    const spari_nodes *s;
    SPARI_TRY(spari_fluid_mapped(fluid, which, __func__, &s));
    for (int64_t p = 0; s && p < s->n; p++) {
        int64_t j = spari_nodes_node(s, p);
        double con[3] = {s->con[0][p], s->con[1][p], s->con[2][p]};
        if (xi) {
            xi[j] = spari_member_xi(fluid->member, spari_nodes_element(s, p), spari_nodes_xi(s, p));
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

int spar_fluid_get_feet(const spar_fluid *fluid, int which, double *x_map, double *q_map, double *con) {
    SPARI_QUIET;
    SPARI_FLUID_HANDLE(fluid);
    SPARI_TRY(check_which(fluid, which, __func__));
    const spari_nodes *s;
    SPARI_TRY(spari_fluid_mapped(fluid, which, __func__, &s));
    for (int64_t p = 0; s && p < s->n; p++) {
        int64_t j = spari_nodes_node(s, p);
        double x[3], q[4];
        spari_fluid_reference(fluid, spari_nodes_element(s, p), spari_nodes_xi(s, p), x, q);
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
    SPARI_QUIET;
    SPARI_FLUID_HANDLE(fluid);
    SPARI_TRY(check_which(fluid, which, __func__));
    const spari_nodes *s;
    SPARI_TRY(spari_fluid_mapped(fluid, which, __func__, &s));
    int n = fluid->member->per_element;
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
