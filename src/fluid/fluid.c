#include "fluid.h"

#include "../math/rotation.h"
#include "../session/session.h"
#include "projection.h"
#include "transfer.h"
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A set of nodes as the host gave it, until the map ties it to the line, and as it is kept afterwards. */
typedef struct node_set {
    int pending;  /* given, not mapped yet */
    int sections; /* given by coordinate, not by place */
    int64_t n;
    double *x;          /* [n][3]: places, or offsets in the section frame; while pending */
    double *xi;         /* [n]: sections only; while pending */
    spari_nodes *nodes; /* once mapped */
} node_set;

/* Node forces over time, for hosts that want them back between the steps (SPAR_EFFECT_FLUID_HISTORY). */
typedef struct history {
    int on, pushed; /* pushed: a push came in the step under way */
    int64_t n;
    double *after;   /* [n][3] at t^{n+1}: predicted, then pushed */
    double *past[3]; /* at t^n, t^{n-1}, t^{n-2} */
} history;

struct spar_fluid {
    spar_member *member;
    spar_fluid *next;
    char *name;
    int method, consistent;
    double max_distance;
    int shared; /* sections: the motion set serves both */
    node_set set[2];
    int64_t pushes;
    int refused; /* status of the last push of this step */

    /* allocated by the map */
    double *modal;                           /* [P][P] */
    double *field[2];                        /* coefficients of two states [nodes][SPARI_FIELDS] */
    double *reference;                       /* of the reference configuration */
    double *blend[3];                        /* node motion at theta */
    double *work;                            /* [nodes][14] */
    double *load, *load_new, *load_accepted; /* [nodes][6] */
    double audit[8];
    history *history;
};

static const char *const set_name[2] = {"motion", "force"};

/* Message with the caller, the fluid and its member in front; gives back status. */
static int refuse(const spar_fluid *fluid, int status, const char *caller, const char *format, ...) SPARI_PRINTF(4, 5);
static int refuse(const spar_fluid *fluid, int status, const char *caller, const char *format, ...) {
    char text[SPARI_MESSAGE_SIZE];
    va_list list;
    va_start(list, format);
    vsnprintf(text, sizeof text, format, list);
    va_end(list);
    return spari_fail(fluid->member->session, status, "%s: fluid '%s' of member '%s': %s", caller, fluid->name,
                      fluid->member->name, text);
}

#define REQUIRE(fluid, condition, status, ...)                                                                         \
    do {                                                                                                               \
        if (!(condition)) {                                                                                            \
            return refuse(fluid, status, __func__, __VA_ARGS__);                                                       \
        }                                                                                                              \
    } while (0)
#define REQUIRE_HANDLE(fluid)                                                                                          \
    SPARI_REQUIRE(NULL, fluid, SPAR_ERR_ARGUMENT, "%s: the fluid is NULL; create it with spar_fluid_create", __func__)

static node_set *set_of(spar_fluid *fluid, int which) {
    return &fluid->set[fluid->shared ? SPAR_NODES_MOTION : which];
}

static const node_set *const_set_of(const spar_fluid *fluid, int which) {
    return &fluid->set[fluid->shared ? SPAR_NODES_MOTION : which];
}

/* ---- life ---- */

int spar_fluid_create(spar_member *member, const char *name, spar_fluid **fluid) {
    SPARI_REQUIRE(NULL, member, SPAR_ERR_ARGUMENT, "spar_fluid_create: the member is NULL; create it first");
    spar_session *session = member->session;
    SPARI_REQUIRE(session, fluid, SPAR_ERR_ARGUMENT, "spar_fluid_create: member '%s': the place for the handle is NULL",
                  member->name);
    SPARI_REQUIRE(session, name && name[0], SPAR_ERR_ARGUMENT,
                  "spar_fluid_create: member '%s': the fluid needs a name; messages use it", member->name);
    spar_fluid *made = spari_zalloc(1, sizeof *made);
    char *copy = spari_zalloc((int64_t)strlen(name) + 1, 1);
    history *kept = spari_zalloc(1, sizeof *kept);
    if (!made || !copy || !kept) {
        free(made);
        free(copy);
        free(kept);
        return spari_fail(session, SPAR_ERR_MEMORY, "spar_fluid_create: member '%s': no memory for a fluid",
                          member->name);
    }
    strcpy(copy, name);
    made->member = member, made->name = copy, made->history = kept;
    spar_fluid **end = &session->fluids; /* at the end: loads are added in order of creation */
    while (*end) {
        end = &(*end)->next;
    }
    *end = made;
    *fluid = made;
    return SPAR_OK;
}

static void clear_set(node_set *set) {
    free(set->x);
    free(set->xi);
    spari_nodes_free(set->nodes);
    *set = (node_set){0};
}

static void clear_history(history *h) {
    free(h->after);
    for (int i = 0; i < 3; i++) {
        free(h->past[i]);
    }
    *h = (history){0};
}

void spari_fluid_free(spar_fluid *fluid) {
    if (!fluid) {
        return;
    }
    clear_set(&fluid->set[0]);
    clear_set(&fluid->set[1]);
    clear_history(fluid->history);
    free(fluid->history);
    double *all[] = {fluid->modal,    fluid->field[0], fluid->field[1],     fluid->reference,
                     fluid->blend[0], fluid->blend[1], fluid->blend[2],     fluid->work,
                     fluid->load,     fluid->load_new, fluid->load_accepted};
    for (size_t i = 0; i < sizeof all / sizeof all[0]; i++) {
        free(all[i]);
    }
    free(fluid->name);
    free(fluid);
}

void spar_fluid_destroy(spar_fluid **fluid) {
    if (!fluid || !*fluid) {
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
        return refuse(fluid, SPAR_ERR_STATE, caller,
                      "a step is under way; change nodes and maps after spar_step_accept or spar_step_reject");
    }
    return SPAR_OK;
}

static int check_values(const spar_fluid *fluid, const char *caller, const char *what, const double *x, int64_t n,
                        int width) {
    int64_t bad = spari_first_nonfinite(x, n * width);
    if (bad >= 0) {
        return refuse(fluid, SPAR_ERR_ARGUMENT, caller, "%s %lld, component %d, is %g; give finite numbers", what,
                      (long long)(bad / width), (int)(bad % width), x[bad]);
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
    if (n < 0 || (n > 0 && !x)) {
        return refuse(fluid, SPAR_ERR_ARGUMENT, caller, "%lld nodes%s; give n >= 0 and n x 3 places", (long long)n,
                      x ? "" : " without places");
    }
    SPARI_TRY(check_values(fluid, caller, which == SPAR_NODES_MOTION ? "motion node" : "force node", x, n, 3));
    double *copy = copy_of(x, 3 * n);
    if (!copy) {
        return refuse(fluid, SPAR_ERR_MEMORY, caller, "no memory for %lld nodes", (long long)n);
    }
    if (fluid->shared) { /* sections served both; the other set keeps them */
        fluid->shared = 0;
        if (which == SPAR_NODES_MOTION) {
            fluid->set[SPAR_NODES_FORCE] = fluid->set[SPAR_NODES_MOTION];
            fluid->set[SPAR_NODES_MOTION] = (node_set){0};
        }
    }
    clear_set(&fluid->set[which]);
    fluid->set[which] = (node_set){.pending = 1, .n = n, .x = copy};
    return SPAR_OK;
}

int spar_fluid_set_motion_nodes(spar_fluid *fluid, int64_t n, const double *x) {
    REQUIRE_HANDLE(fluid);
    return set_places(fluid, SPAR_NODES_MOTION, n, x, __func__);
}

int spar_fluid_set_force_nodes(spar_fluid *fluid, int64_t n, const double *x) {
    REQUIRE_HANDLE(fluid);
    return set_places(fluid, SPAR_NODES_FORCE, n, x, __func__);
}

int spar_fluid_set_sections(spar_fluid *fluid, int64_t n, const double *xi, const double *offset) {
    REQUIRE_HANDLE(fluid);
    SPARI_TRY(check_idle(fluid, __func__));
    REQUIRE(fluid, n >= 0 && (n == 0 || xi), SPAR_ERR_ARGUMENT, "%lld sections%s; give n >= 0 and n coordinates",
            (long long)n, xi ? "" : " without coordinates");
    for (int64_t j = 0; j < n; j++) {
        REQUIRE(fluid, xi[j] >= -1 && xi[j] <= 1, SPAR_ERR_ARGUMENT,
                "section %lld: xi = %g lies outside [-1,1]; xi = 2 eta - 1 over the whole beam", (long long)j, xi[j]);
    }
    if (offset) {
        SPARI_TRY(check_values(fluid, __func__, "offset of section", offset, n, 3));
    }
    double *copy = copy_of(offset, 3 * n), *at = copy_of(xi, n);
    if (!copy || !at) {
        free(copy);
        free(at);
        return refuse(fluid, SPAR_ERR_MEMORY, __func__, "no memory for %lld sections", (long long)n);
    }
    clear_set(&fluid->set[0]);
    clear_set(&fluid->set[1]);
    fluid->shared = 1;
    fluid->set[SPAR_NODES_MOTION] = (node_set){.pending = 1, .sections = 1, .n = n, .x = copy, .xi = at};
    return SPAR_OK;
}

int spar_fluid_set_projection(spar_fluid *fluid, int method, double max_distance) {
    REQUIRE_HANDLE(fluid);
    SPARI_TRY(check_idle(fluid, __func__));
    REQUIRE(fluid, method == SPAR_PROJECT_BOUNDED || method == SPAR_PROJECT_RPOLY, SPAR_ERR_ARGUMENT,
            "projection method %d is not known; SPAR_PROJECT_BOUNDED or SPAR_PROJECT_RPOLY", method);
    REQUIRE(fluid, !isnan(max_distance), SPAR_ERR_ARGUMENT, "max_distance is not a number; <= 0 means no limit");
    fluid->method = method;
    fluid->max_distance = max_distance;
    return SPAR_OK;
}

int spar_fluid_set_interpolation(spar_fluid *fluid, int kind) {
    REQUIRE_HANDLE(fluid);
    SPARI_TRY(check_idle(fluid, __func__));
    REQUIRE(fluid, kind == SPAR_INTERPOLATE_NODAL || kind == SPAR_INTERPOLATE_CONSISTENT, SPAR_ERR_ARGUMENT,
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
               {&fluid->field[1], SPARI_FIELDS},
               {&fluid->blend[0], 7},
               {&fluid->blend[1], 6},
               {&fluid->blend[2], 6},
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
static void reference_at(const spar_fluid *fluid, int element, double xi, double x[3], double q[4]) {
    double s[7];
    int modes = fluid->member->per_element;
    field_at(fluid->reference + (ptrdiff_t)element * modes * SPARI_FIELDS, modes, SPARI_F_PLACE, 7, xi, s);
    memcpy(x, s, 3 * sizeof *x);
    memcpy(q, s + 3, 4 * sizeof *q);
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

static void feet_of_sections(const spar_fluid *fluid, const node_set *set, feet *f) {
    for (int64_t j = 0; j < set->n; j++) {
        double x[3], q[4];
        f->element[j] = locate(fluid->member, set->xi[j], &f->xi[j]);
        reference_at(fluid, f->element[j], f->xi[j], x, q);
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

/* Reference places of a mapped set, put together again from feet and arms: [n][3]. */
static double *places_again(const spar_fluid *fluid, const spari_nodes *s) {
    double *x = spari_zalloc(3 * s->n, sizeof *x);
    for (int64_t p = 0; x && p < s->n; p++) {
        double foot[3], q[4];
        reference_at(fluid, spari_nodes_element(s, p), s->xi[p], foot, q);
        for (int i = 0; i < 3; i++) {
            x[3 * spari_nodes_node(s, p) + i] = foot[i] + s->con[i][p];
        }
    }
    return x;
}

/* Ties one set to the line, into *made; nothing of the fluid changes. */
static int map_set(const spar_fluid *fluid, int which, const spari_line *line, spari_nodes **made, const char *caller) {
    const spar_member *m = fluid->member;
    const node_set *set = &fluid->set[which];
    int64_t far[2] = {0, 0}, n = set->pending ? set->n : set->nodes->n;
    feet f;
    double *again = set->pending ? NULL : places_again(fluid, set->nodes);
    *made = spari_nodes_create(n, m->elements, m->per_element);
    if (alloc_feet(&f, n) != SPAR_OK || !*made || !(set->pending || again)) {
        free_feet(&f);
        free(again);
        return refuse(fluid, SPAR_ERR_MEMORY, caller, "no memory to map %lld %s nodes", (long long)n, set_name[which]);
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
        return refuse(
            fluid, SPAR_ERR_MAPPING, caller,
            "%lld of %lld %s nodes lie farther than %g from the line, the first is node %lld; move them, raise "
            "max_distance, or take them with the option fluid.far = take",
            (long long)far[0], (long long)n, set_name[which], fluid->max_distance, (long long)far[1]);
    }
    return SPAR_OK;
}

/* A history for n nodes in place of the old one. */
static int renew_history(spar_fluid *fluid, int64_t n) {
    history h = {.on = 1, .n = n};
    h.after = spari_zalloc(3 * n, sizeof *h.after);
    for (int i = 0; i < 3; i++) {
        h.past[i] = spari_zalloc(3 * n, sizeof *h.past[i]);
    }
    if (!h.after || !h.past[0] || !h.past[1] || !h.past[2]) {
        clear_history(&h);
        return SPAR_ERR_MEMORY;
    }
    clear_history(fluid->history);
    *fluid->history = h;
    return SPAR_OK;
}

static void take_nodes(node_set *set, spari_nodes *nodes) {
    int sections = set->sections;
    clear_set(set);
    *set = (node_set){.sections = sections, .n = nodes->n, .nodes = nodes};
}

int spar_fluid_map(spar_fluid *fluid) {
    REQUIRE_HANDLE(fluid);
    const spar_member *m = fluid->member;
    REQUIRE(fluid, m->committed, SPAR_ERR_STATE, "the member is not committed; call spar_member_commit first");
    SPARI_TRY(check_idle(fluid, __func__));
    REQUIRE(fluid, prepare_member(fluid) == SPAR_OK, SPAR_ERR_MEMORY, "no memory to map");
    spari_line *line = spari_line_create(m->elements, m->per_element, m->xr);
    REQUIRE(fluid, line, SPAR_ERR_MEMORY, "no memory to map");
    spari_nodes *made[2] = {NULL, NULL};
    int status = SPAR_OK, fresh = set_of(fluid, SPAR_NODES_FORCE)->pending;
    for (int which = 0; which < 2 && status == SPAR_OK; which++) {
        const node_set *set = &fluid->set[which];
        if (set->pending || (set->nodes && !set->sections)) {
            status = map_set(fluid, which, line, &made[which], __func__);
        }
    }
    spari_line_free(line);
    if (status == SPAR_OK && fresh &&
        (fluid->history->on || fluid->shared || (m->effects & SPAR_EFFECT_FLUID_HISTORY))) {
        if (renew_history(fluid, set_of(fluid, SPAR_NODES_FORCE)->n) != SPAR_OK) {
            status = refuse(fluid, SPAR_ERR_MEMORY, __func__, "no memory for the node forces");
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
static int mapped(const spar_fluid *fluid, int which, const char *caller, const spari_nodes **nodes) {
    const node_set *set = const_set_of(fluid, which);
    *nodes = set->nodes;
    if (set->pending) {
        return refuse(fluid, SPAR_ERR_STATE, caller, "the %s nodes are given but not mapped; call spar_fluid_map",
                      set_name[which]);
    }
    return SPAR_OK;
}

static int check_which(const spar_fluid *fluid, int which, const char *caller) {
    if (which != SPAR_NODES_MOTION && which != SPAR_NODES_FORCE) {
        return refuse(fluid, SPAR_ERR_ARGUMENT, caller,
                      "node set %d is not known; SPAR_NODES_MOTION or SPAR_NODES_FORCE", which);
    }
    return SPAR_OK;
}

int spar_fluid_get_count(const spar_fluid *fluid, int which, int64_t *n) {
    REQUIRE_HANDLE(fluid);
    SPARI_TRY(check_which(fluid, which, __func__));
    REQUIRE(fluid, n, SPAR_ERR_ARGUMENT, "the place for the count is NULL");
    *n = const_set_of(fluid, which)->n;
    return SPAR_OK;
}

int spar_fluid_get_map(const spar_fluid *fluid, int which, double *xi, double *distance, int *flags) {
    REQUIRE_HANDLE(fluid);
    SPARI_TRY(check_which(fluid, which, __func__));
    const spari_nodes *s;
    SPARI_TRY(mapped(fluid, which, __func__, &s));
    for (int64_t p = 0; s && p < s->n; p++) {
        int64_t j = spari_nodes_node(s, p);
        double con[3] = {s->con[0][p], s->con[1][p], s->con[2][p]};
        if (xi) {
            xi[j] = spari_member_xi(fluid->member, spari_nodes_element(s, p), s->xi[p]);
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
    REQUIRE_HANDLE(fluid);
    SPARI_TRY(check_which(fluid, which, __func__));
    const spari_nodes *s;
    SPARI_TRY(mapped(fluid, which, __func__, &s));
    for (int64_t p = 0; s && p < s->n; p++) {
        int64_t j = spari_nodes_node(s, p);
        double x[3], q[4];
        reference_at(fluid, spari_nodes_element(s, p), s->xi[p], x, q);
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
    REQUIRE_HANDLE(fluid);
    SPARI_TRY(check_which(fluid, which, __func__));
    const spari_nodes *s;
    SPARI_TRY(mapped(fluid, which, __func__, &s));
    int n = fluid->member->per_element;
    double x[SPARI_MAX_NODES], bary[SPARI_MAX_NODES];
    spari_gll(n, x, NULL, bary);
    for (int64_t p = 0; s && p < s->n; p++) {
        int64_t j = spari_nodes_node(s, p);
        if (first_node) {
            first_node[j] = (int64_t)spari_nodes_element(s, p) * n;
        }
        if (phi) {
            spari_lagrange(n, x, bary, s->xi[p], phi + j * n, NULL);
        }
    }
    return SPAR_OK;
}

/* ---- motion out ---- */

static int check_theta(const spar_fluid *fluid, double theta, const char *caller) {
    if (!(theta >= 0 && theta <= 1)) {
        return refuse(fluid, SPAR_ERR_ARGUMENT, caller, "theta = %g lies outside [0,1]; 0 is t^n, 1 is t^{n+1}", theta);
    }
    return SPAR_OK;
}

/* Node motion between the two times on the group R^3 x SO(3): the chord of places, the geodesic of rotations. */
static void blend_motion(const spar_fluid *fluid, double theta) {
    const spari_motion *now = &fluid->member->now, *after = &fluid->member->after;
    for (int64_t l = 0; l < fluid->member->nodes; l++) {
        const double *q0 = now->q + 7 * l, *q1 = after->q + 7 * l;
        double *q = fluid->blend[0] + 7 * l, back[4], turn[4], psi[3];
        for (int i = 0; i < 3; i++) {
            q[i] = (1 - theta) * q0[i] + theta * q1[i];
        }
        spari_quat_conj(q0 + 3, back);
        spari_quat_mul(back, q1 + 3, turn);
        spari_quat_log(turn, psi);
        for (int i = 0; i < 3; i++) {
            psi[i] *= theta;
        }
        spari_quat_exp(psi, turn);
        spari_quat_mul(q0 + 3, turn, q + 3);
        spari_quat_normalise(q + 3);
        for (int64_t i = 6 * l; i < 6 * l + 6; i++) {
            fluid->blend[1][i] = (1 - theta) * now->v[i] + theta * after->v[i];
            fluid->blend[2][i] = (1 - theta) * now->a[i] + theta * after->a[i];
        }
    }
}

/* Coefficients of the one or two states that make up time theta, and their shares. Returns their number. */
static int fill_states(const spar_fluid *fluid, double theta, int upto, double share[2]) {
    const spar_member *m = fluid->member;
    spari_motion blended = {fluid->blend[0], fluid->blend[1], fluid->blend[2]};
    const spari_motion *state[2] = {theta == 0 ? &m->now : &m->after, &m->now};
    int n = theta > 0 && theta < 1 ? 2 : 1;
    share[0] = n == 2 ? theta : 1, share[1] = 1 - theta;
    if (n == 2 && m->session->theta_on_group) {
        blend_motion(fluid, theta);
        state[0] = &blended, share[0] = 1, n = 1;
    }
    for (int i = 0; i < n; i++) {
        spari_field_fill(m->elements, m->per_element, fluid->modal, fluid->consistent, upto, m->xr, state[i]->q,
                         state[i]->v, state[i]->a, fluid->field[i]);
    }
    return n;
}

/* Rows of two states become those of the time between them, in the first's place. */
static void average(const double share[2], double (*buf[2])[SPARI_ROW], int row, int count) {
    for (int k = row; k < row + 3; k++) {
        for (int i = 0; i < count; i++) {
            buf[0][k][i] = share[0] * buf[0][k][i] + share[1] * buf[1][k][i];
        }
    }
}

/* Three rows of the tile to the host's triples, by node. */
static void emit(const spari_nodes *s, int64_t first, int n, const double share[2], double (*buf[2])[SPARI_ROW],
                 int row, double *out) {
    if (out) {
        if (n == 2) {
            average(share, buf, row, spari_tile_count(s, first));
        }
        spari_tile_store(s, first, buf[0] + row, out);
    }
}

static int check_rotation(const spar_fluid *fluid, double least, const char *caller) {
    if (least < 1e-12) {
        return refuse(fluid, SPAR_ERR_NUMERIC, caller,
                      "rotations within an element cancel each other, so that there is none to interpolate; use more "
                      "nodes or elements");
    }
    return SPAR_OK;
}

int spar_fluid_pull_motion(spar_fluid *fluid, double theta, double *x, double *v) {
    REQUIRE_HANDLE(fluid);
    SPARI_TRY(check_theta(fluid, theta, __func__));
    const spari_nodes *s;
    SPARI_TRY(mapped(fluid, SPAR_NODES_MOTION, __func__, &s));
    if (!s || s->n == 0 || (!x && !v)) {
        return SPAR_OK;
    }
    double a[SPARI_ROWS][SPARI_ROW], b[SPARI_ROWS][SPARI_ROW], (*buf[2])[SPARI_ROW] = {a, b}, share[2],
                                                               least = HUGE_VAL;
    int upto = v ? SPARI_UPTO_RATE : SPARI_UPTO_PLACE;
    int n = fill_states(fluid, theta, upto, share);
    for (int64_t first = 0; first < s->n; first += SPARI_TILE) {
        for (int i = 0; i < n; i++) {
            least = fmin(least, spari_tile_motion(s, first, fluid->field[i], fluid->consistent, upto, buf[i]));
        }
        emit(s, first, n, share, buf, SPARI_R_PLACE, x);
        emit(s, first, n, share, buf, SPARI_R_RATE, v);
    }
    return check_rotation(fluid, least, __func__);
}

/* Orientation now of the tile's nodes: the states' rotations, averaged where there are two, times the reference's. */
static void emit_orientation(const spar_fluid *fluid, const spari_nodes *s, int64_t first, int n, const double share[2],
                             double (*buf[2])[SPARI_ROW], double *out) {
    int count = spari_tile_count(s, first);
    for (int i = 0; out && i < count; i++) {
        double q[2][4] = {{0}}, x[3], reference[4];
        for (int k = 0; k < n; k++) {
            for (int c = 0; c < 4; c++) {
                q[k][c] = buf[k][SPARI_R_QUAT + c][i];
            }
            spari_quat_normalise(q[k]);
        }
        if (n == 2) {
            double sign = spari_quat_dot(q[0], q[1]) < 0 ? -1 : 1;
            for (int c = 0; c < 4; c++) {
                q[0][c] = share[0] * q[0][c] + sign * share[1] * q[1][c];
            }
        }
        reference_at(fluid, spari_nodes_element(s, first + i), s->xi[first + i], x, reference);
        spari_quat_mul(q[0], reference, q[0]);
        spari_quat_normalise(q[0]);
        double sign = q[0][0] < 0 ? -1 : 1; /* scalar part >= 0 */
        for (int c = 0; c < 4; c++) {
            out[4 * spari_nodes_node(s, first + i) + c] = sign * q[0][c];
        }
    }
}

int spari_fluid_look(const spar_fluid *fluid, int which, double *x, double *v, double *q) {
    const char *caller = "spar_fluid_write_vtk";
    const spari_nodes *s;
    SPARI_TRY(mapped(fluid, which, caller, &s));
    if (!s || s->n == 0) {
        return SPAR_OK;
    }
    double a[SPARI_ROWS][SPARI_ROW], (*buf[2])[SPARI_ROW] = {a, a}, share[2], least = HUGE_VAL;
    fill_states(fluid, 1, SPARI_UPTO_ACCEL, share);
    for (int64_t first = 0; first < s->n; first += SPARI_TILE) {
        least = fmin(least, spari_tile_motion(s, first, fluid->field[0], fluid->consistent, SPARI_UPTO_ACCEL, a));
        emit(s, first, 1, share, buf, SPARI_R_PLACE, x);
        emit(s, first, 1, share, buf, SPARI_R_RATE, v);
        emit_orientation(fluid, s, first, 1, share, buf, q);
    }
    return check_rotation(fluid, least, caller);
}

int spari_fluid_has_sections(const spar_fluid *fluid) {
    return fluid->shared;
}

const double *spari_fluid_forces(const spar_fluid *fluid) {
    return fluid->history->on ? fluid->history->after : NULL;
}

int spar_fluid_pull_sections(spar_fluid *fluid, double theta, double *q, double *omega, double *accel) {
    REQUIRE_HANDLE(fluid);
    SPARI_TRY(check_theta(fluid, theta, __func__));
    const spari_nodes *s;
    SPARI_TRY(mapped(fluid, SPAR_NODES_MOTION, __func__, &s));
    if (!s || s->n == 0) {
        return SPAR_OK;
    }
    double a[SPARI_ROWS][SPARI_ROW], b[SPARI_ROWS][SPARI_ROW], (*buf[2])[SPARI_ROW] = {a, b}, share[2],
                                                               least = HUGE_VAL;
    int n = fill_states(fluid, theta, SPARI_UPTO_ACCEL, share);
    for (int64_t first = 0; first < s->n; first += SPARI_TILE) {
        for (int i = 0; i < n; i++) {
            least =
                fmin(least, spari_tile_motion(s, first, fluid->field[i], fluid->consistent, SPARI_UPTO_ACCEL, buf[i]));
        }
        emit(s, first, n, share, buf, SPARI_R_OMEGA, omega);
        emit(s, first, n, share, buf, SPARI_R_ACCEL, accel);
        emit_orientation(fluid, s, first, n, share, buf, q);
    }
    return check_rotation(fluid, least, __func__);
}

/* ---- loads in ---- */

/* Node forces are kept from now on, if they can still be kept from the beginning. */
static int start_history(spar_fluid *fluid, int64_t n, const char *caller) {
    history *h = fluid->history;
    if (h->on) {
        return SPAR_OK;
    }
    if (fluid->pushes > 0) {
        return refuse(
            fluid, SPAR_ERR_STATE, caller,
            "node forces were not kept; set SPAR_EFFECT_FLUID_HISTORY on the member before it is committed, or call "
            "spar_fluid_pull_forces once before the first push");
    }
    history made = {.on = 1, .n = n};
    made.after = spari_zalloc(3 * n, sizeof *made.after);
    for (int i = 0; i < 3; i++) {
        made.past[i] = spari_zalloc(3 * n, sizeof *made.past[i]);
    }
    if (!made.after || !made.past[0] || !made.past[1] || !made.past[2]) {
        clear_history(&made);
        return refuse(fluid, SPAR_ERR_MEMORY, caller, "no memory for the node forces");
    }
    *h = made;
    return SPAR_OK;
}

int spar_fluid_pull_forces(spar_fluid *fluid, double theta, double *force) {
    REQUIRE_HANDLE(fluid);
    SPARI_TRY(check_theta(fluid, theta, __func__));
    const spari_nodes *s;
    SPARI_TRY(mapped(fluid, SPAR_NODES_FORCE, __func__, &s));
    int64_t n = s ? s->n : 0;
    REQUIRE(fluid, n == 0 || force, SPAR_ERR_ARGUMENT, "the place for the forces is NULL");
    SPARI_TRY(start_history(fluid, n, __func__));
    const history *h = fluid->history;
    for (int64_t i = 0; i < 3 * n; i++) {
        force[i] = (1 - theta) * h->past[0][i] + theta * h->after[i];
    }
    return SPAR_OK;
}

static void keep_forces(history *h, const double *force, int before_start) {
    if (!h->on || h->n == 0) {
        return;
    }
    size_t size = sizeof *h->after * 3 * (size_t)h->n;
    memcpy(h->after, force, size);
    if (before_start) {
        memcpy(h->past[0], force, size);
    }
    h->pushed = 1;
}

/* What came out of the map, against what went in (spar.h says what the numbers are). */
static void write_audit(spar_fluid *fluid, const spari_audit *in, int64_t n) {
    const spar_member *m = fluid->member;
    double force[3] = {0}, moment[3] = {0}, power = 0, t[3], d[3];
    for (int64_t l = 0; l < m->nodes; l++) {
        const double *load = fluid->load + 6 * l, *q = m->after.q + 7 * l, *v = m->after.v + 6 * l;
        double x[3] = {m->xr[3 * l] + q[0], m->xr[3 * l + 1] + q[1], m->xr[3 * l + 2] + q[2]};
        spari_cross(x, load, t);
        for (int i = 0; i < 3; i++) {
            force[i] += load[i];
            moment[i] += t[i] + load[3 + i];
            power += load[i] * v[i] + load[3 + i] * v[3 + i];
        }
    }
    double force_scale = in->force_sum, moment_scale = in->force_sum * in->x_max + in->moment_sum;
    double power_scale = in->force_sum * in->v_max + in->moment_sum * in->omega_max;
    double *a = fluid->audit;
    a[0] = spari_norm(in->force), a[1] = spari_norm(in->moment), a[2] = in->power;
    for (int i = 0; i < 3; i++) {
        d[i] = force[i] - in->force[i], t[i] = moment[i] - in->moment[i];
    }
    a[3] = force_scale > 0 ? spari_norm(d) / force_scale : 0;
    a[4] = moment_scale > 0 ? spari_norm(t) / moment_scale : 0;
    a[5] = power_scale > 0 ? fabs(power - in->power) / power_scale : 0;
    a[6] = in->x_max, a[7] = (double)n;
}

/* The load of the nodes in load_new; SPAR_OK if it can be used. */
static int gather(spar_fluid *fluid, const spari_nodes *s, const double *force, const double *moment,
                  spari_audit *audit, const char *caller) {
    const spar_member *m = fluid->member;
    spari_field_fill(m->elements, m->per_element, fluid->modal, fluid->consistent,
                     audit ? SPARI_UPTO_RATE : SPARI_UPTO_PLACE, m->xr, m->after.q, m->after.v, m->after.a,
                     fluid->field[0]);
    double least = spari_gather_loads(s, fluid->modal, fluid->field[0], fluid->consistent, m->after.q, force, moment,
                                      fluid->work, fluid->load_new, audit);
    if (spari_first_nonfinite(fluid->load_new, 6 * m->nodes) >= 0) { /* only now look where it came from */
        SPARI_TRY(check_values(fluid, caller, "force of node", force, s->n, 3));
        if (moment) {
            SPARI_TRY(check_values(fluid, caller, "moment of node", moment, s->n, 3));
        }
        SPARI_TRY(check_rotation(fluid, least, caller));
        return refuse(fluid, SPAR_ERR_ARGUMENT, caller, "the loads are too large for a double; check their unit");
    }
    return check_rotation(fluid, least, caller);
}

static int push(spar_fluid *fluid, const spari_nodes *s, const double *force, const double *moment,
                const char *caller) {
    spari_audit audit = {0};
    int audited = !fluid->member->session->audit_off;
    if (s->n > 0 && !force) {
        return refuse(fluid, SPAR_ERR_ARGUMENT, caller, "the force array is NULL though there are %lld force nodes",
                      (long long)s->n);
    }
    if (!(fluid->member->effects & SPAR_EFFECT_FLUID_MOMENT)) {
        moment = NULL;
    }
    SPARI_TRY(gather(fluid, s, force, moment, audited ? &audit : NULL, caller));
    double *old = fluid->load;
    fluid->load = fluid->load_new, fluid->load_new = old;
    if (audited) {
        write_audit(fluid, &audit, s->n);
    } else {
        memset(fluid->audit, 0, sizeof fluid->audit);
    }
    return SPAR_OK;
}

int spar_fluid_push_forces(spar_fluid *fluid, const double *force, const double *moment) {
    REQUIRE_HANDLE(fluid);
    spar_session *session = fluid->member->session;
    REQUIRE(fluid, session->phase != SPARI_IDLE || !session->started, SPAR_ERR_STATE,
            "no step is under way; loads are pushed between spar_step_begin and spar_step_accept, or before the first "
            "step");
    const spari_nodes *s;
    SPARI_TRY(mapped(fluid, SPAR_NODES_FORCE, __func__, &s));
    if (!s) {
        return SPAR_OK;
    }
    fluid->refused = push(fluid, s, force, moment, __func__);
    session->refused = fluid->refused;
    if (fluid->refused != SPAR_OK) {
        return fluid->refused;
    }
    for (const spar_fluid *f = session->fluids; f && session->refused == SPAR_OK; f = f->next) {
        session->refused = f->refused; /* a good push mends its own fluid's, not another's */
    }
    fluid->pushes++;
    int before_start = session->phase == SPARI_IDLE;
    if (before_start) {
        memcpy(fluid->load_accepted, fluid->load, sizeof *fluid->load * 6 * (size_t)fluid->member->nodes);
    }
    keep_forces(fluid->history, force, before_start);
    return SPAR_OK;
}

int spar_fluid_get_audit(const spar_fluid *fluid, double audit[8]) {
    REQUIRE_HANDLE(fluid);
    REQUIRE(fluid, audit, SPAR_ERR_ARGUMENT, "the place for the audit is NULL");
    memcpy(audit, fluid->audit, sizeof fluid->audit);
    return SPAR_OK;
}

/* ---- what the session asks ---- */

void spari_fluid_add_loads(const spar_fluid *fluid, double *load) {
    for (int64_t i = 0; fluid->load && i < 6 * fluid->member->nodes; i++) {
        load[i] += fluid->load[i];
    }
}

/* Weights of the polynomial through t^n, t^{n-1}, t^{n-2} at t^{n+1} (Lagrange, steps of any length). */
static void predictor(int order, double dt, const double dt_last[2], double w[3]) {
    double a = dt_last[0], b = dt_last[0] + dt_last[1];
    w[0] = 1, w[1] = w[2] = 0;
    if (order == 1) {
        w[1] = -dt / a;
        w[0] = 1 - w[1];
    } else if (order == 2) {
        w[0] = (dt + a) * (dt + b) / (a * b);
        w[1] = -dt * (dt + b) / (a * (b - a));
        w[2] = dt * (dt + a) / (b * (b - a));
    }
}

void spari_fluid_begin(spar_fluid *fluid, int order, double dt, const double dt_last[2]) {
    history *h = fluid->history;
    double w[3];
    fluid->refused = SPAR_OK;
    h->pushed = 0;
    if (!h->on) {
        return;
    }
    predictor(order, dt, dt_last, w);
    for (int64_t i = 0; i < 3 * h->n; i++) {
        h->after[i] = w[0] * h->past[0][i];
        for (int k = 1; k <= order; k++) {
            h->after[i] += w[k] * h->past[k][i];
        }
    }
}

void spari_fluid_accept(spar_fluid *fluid) {
    history *h = fluid->history;
    fluid->refused = SPAR_OK;
    if (fluid->load) {
        memcpy(fluid->load_accepted, fluid->load, sizeof *fluid->load * 6 * (size_t)fluid->member->nodes);
    }
    if (!h->on || h->n == 0) {
        return;
    }
    size_t size = sizeof *h->after * 3 * (size_t)h->n;
    if (!h->pushed) { /* loads not given anew stay as they were */
        memcpy(h->after, h->past[0], size);
    }
    double *oldest = h->past[2];
    h->past[2] = h->past[1], h->past[1] = h->past[0], h->past[0] = oldest;
    memcpy(h->past[0], h->after, size);
}

void spari_fluid_reject(spar_fluid *fluid) {
    history *h = fluid->history;
    fluid->refused = SPAR_OK;
    if (fluid->load) {
        memcpy(fluid->load, fluid->load_accepted, sizeof *fluid->load * 6 * (size_t)fluid->member->nodes);
    }
    if (h->on && h->n > 0) {
        memcpy(h->after, h->past[0], sizeof *h->after * 3 * (size_t)h->n);
    }
    h->pushed = 0;
}
