/* Writes a member as a VTK file: its line, sampled more finely than its nodes, with fields along it, and the nodes
   as points. Uses public calls alone. */
#include "../base/environment.h"
#include "../math/basis.h"
#include "../math/rotation.h"
#include "vtk.h"
#include <math.h>
#include <spar/spar_output.h>
#include <spar/spar_structure.h>
#include <stdlib.h>
#include <string.h>

/* Samples between two nodes: a high-order basis is curved there. */
enum { SPARI_PIECES = 4 };

/* Columns of the table of samples, and the fields made from them. */
enum {
    X,
    U = 3,
    AXES = 6,
    V = 15,
    OMEGA = 18,
    A = 21,
    ALPHA = 24,
    FORCE = 27,
    MOMENT = 30,
    NODE = 33,
    BENT = 34,
    ROTATION = 37,
    INNER = 40,
    COLUMNS = 46
};
static const struct {
    const char *name;
    int column, components;
} field_of[] = {{"points", X, 3},
                {"displacement", U, 3},
                {"section_x", AXES, 3},
                {"section_y", AXES + 3, 3},
                {"section_z", AXES + 6, 3},
                {"velocity", V, 3},
                {"angular_velocity", OMEGA, 3},
                {"acceleration", A, 3},
                {"angular_acceleration", ALPHA, 3},
                {"nodal_force", FORCE, 3},
                {"nodal_moment", MOMENT, 3},
                {"node", NODE, 1},
                {"deflection", BENT, 3},
                {"rotation", ROTATION, 3},
                {"section_force", INNER, 3},
                {"section_moment", INNER + 3, 3}}; /* these two only if section forces are known */
enum { FIELDS = sizeof field_of / sizeof field_of[0] };

typedef struct sampled {
    int64_t n;     /* samples */
    double *table; /* [COLUMNS][n], each field in VTK's layout: at table + column * n, [n][components] */
    double *eta;   /* [n] along the whole beam; the first of an element is shifted inwards, because an element boundary
                      belongs to the element before */
    int64_t *node; /* [nodes] sample of each node */
    int64_t *end;  /* [elements] */
} sampled;

/* Data at the nodes. */
typedef struct nodal {
    int elements, per_element;
    int64_t n;                /* nodes */
    double *xr, *qr;          /* [nodes][3], [4]: reference */
    double *q, *v, *a, *load; /* [nodes][7], [6], [6], [6] */
    double *chain, *frame;    /* [nodes][4]: q and the reference orientation, signs chained along each element */
    double reaction[6];
    int inner; /* whether it has sections with known forces */
} nodal;

static void put_columns(const sampled *s, int column, int components, int64_t sample, const double *value) {
    memcpy(s->table + (int64_t)column * s->n + sample * components, value, (size_t)components * sizeof *value);
}

static void blend(int n, const double *phi, int stride, const double *from, int components, double *to) {
    for (int c = 0; c < components; c++) {
        to[c] = 0;
        for (int k = 0; k < n; k++) {
            to[c] += phi[k] * from[k * stride + c];
        }
    }
}

static void put_axes(const sampled *s, int64_t sample, int n, const double *phi, const double *chain,
                     const double *frame) {
    static const double unit[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    double rotation[4], at_rest[4], now[4];
    blend(n, phi, 4, chain, 4, rotation);
    blend(n, phi, 4, frame, 4, at_rest);
    spari_quat_normalise(rotation);
    spari_quat_mul(rotation, at_rest, now);
    spari_quat_normalise(now);
    double angle[3];
    spari_quat_log(rotation, angle);
    put_columns(s, ROTATION, 3, sample, angle);
    for (int i = 0; i < 3; i++) {
        double axis[3];
        spari_rotate(now, unit[i], axis);
        put_columns(s, AXES + 3 * i, 3, sample, axis);
    }
}

/* Deflection: displacement from the position that a rigid motion of the root would give. */
static void put_deflection(const sampled *s, const nodal *at, const double *x, const double *u, int64_t sample) {
    double arm[3], turned[3], bent[3];
    for (int i = 0; i < 3; i++) {
        arm[i] = x[i] - u[i] - at->xr[i];
    }
    spari_rotate(at->q + 3, arm, turned);
    for (int i = 0; i < 3; i++) {
        bent[i] = x[i] - at->xr[i] - at->q[i] - turned[i];
    }
    put_columns(s, BENT, 3, sample, bent);
}

/* One sample of the element whose nodes begin at `first`. node: its number, or -1 between nodes. */
static void put_sample(const sampled *s, const nodal *at, int64_t first, const double *phi, int64_t node,
                       int64_t sample) {
    static const double zero[6] = {0};
    int n = at->per_element;
    double x[3], u[3], rate[6], number = (double)node;
    const double *load = node < 0 ? zero : at->load + 6 * node; /* nodal loads: zero between nodes */
    blend(n, phi, 3, at->xr + 3 * first, 3, x);
    blend(n, phi, 7, at->q + 7 * first, 3, u);
    for (int i = 0; i < 3; i++) {
        x[i] += u[i];
    }
    put_columns(s, X, 3, sample, x);
    put_columns(s, U, 3, sample, u);
    put_deflection(s, at, x, u, sample);
    put_axes(s, sample, n, phi, at->chain + 4 * first, at->frame + 4 * first);
    blend(n, phi, 6, at->v + 6 * first, 6, rate);
    put_columns(s, V, 3, sample, rate);
    put_columns(s, OMEGA, 3, sample, rate + 3);
    blend(n, phi, 6, at->a + 6 * first, 6, rate);
    put_columns(s, A, 3, sample, rate);
    put_columns(s, ALPHA, 3, sample, rate + 3);
    put_columns(s, FORCE, 3, sample, load);
    put_columns(s, MOMENT, 3, sample, load + 3);
    put_columns(s, NODE, 1, sample, &number);
}

static void sample_member(const sampled *s, const nodal *at) {
    int n = at->per_element;
    double x[SPARI_MAX_NODES], bary[SPARI_MAX_NODES], phi[SPARI_MAX_NODES];
    int64_t sample = 0;
    spari_gll(n, x, NULL, bary);
    for (int e = 0; e < at->elements; e++) {
        int64_t first = (int64_t)e * n;
        for (int k = 0; k < n; k++) {
            for (int piece = 0; piece < (k + 1 < n ? SPARI_PIECES : 1); piece++, sample++) {
                double xi = piece == 0 ? x[k] : x[k] + (x[k + 1] - x[k]) * piece / SPARI_PIECES;
                spari_lagrange(n, x, bary, xi, phi, NULL);
                if (piece == 0) {
                    s->node[first + k] = sample;
                }
                put_sample(s, at, first, phi, piece == 0 ? first + k : -1, sample);
                s->eta[sample] = fmin(1, (e + (k + piece == 0 ? 1e-14 * (e + 1) : 0.5 * (1 + xi))) / at->elements);
            }
        }
        s->end[e] = sample;
    }
}

static int no_memory(spar_session *session, const spar_member *m, const char *call) {
    return spari_fail(session, SPAR_ERR_MEMORY, "%s: no memory for '%s'", call, spar_member_get_name(m));
}

static int sample_sections(const sampled *s, const spar_member *m, spar_session *session, const char *call) {
    double *force = spari_zalloc(6 * s->n, sizeof *force);
    int status = force ? spar_beam_evaluate(m, s->n, s->eta, NULL, force, NULL, NULL) : no_memory(session, m, call);
    for (int64_t i = 0; i < s->n && status == SPAR_OK; i++) {
        put_columns(s, INNER, 3, i, force + 6 * i);
        put_columns(s, INNER + 3, 3, i, force + 6 * i + 3);
    }
    free(force);
    return status;
}

static int fill_nodal(const spar_member *m, nodal *at) {
    SPARI_TRY(spar_member_get_reference(m, at->xr, at->qr));
    SPARI_TRY(spar_member_get_motion(m, at->q, at->v, at->a));
    SPARI_TRY(spar_member_get_loads(m, at->load));
    SPARI_TRY(spar_member_get_reaction(m, at->reaction));
    for (int e = 0; e < at->elements; e++) {
        int64_t first = (int64_t)e * at->per_element;
        spari_chain(at->per_element, at->q + 7 * first + 3, 7, at->chain + 4 * first);
        spari_chain(at->per_element, at->qr + 4 * first, 4, at->frame + 4 * first);
    }
    return SPAR_OK;
}

static int write_member(const sampled *s, const nodal *at, spar_session *session, const char *path, const char *call) {
    spari_vtk_field field[FIELDS];
    for (int i = 0; i < FIELDS; i++) {
        field[i] = (spari_vtk_field){field_of[i].name, field_of[i].components, s->table + field_of[i].column * s->n};
    }
    spari_vtk_field fact[] = {{"reaction_force", 3, at->reaction}, {"reaction_moment", 3, at->reaction + 3}};
    spari_vtk_picture picture = {.points = s->n,
                                 .x = field[0].value,
                                 .verts = at->n,
                                 .vert = s->node,
                                 .lines = at->per_element > 1 ? at->elements : 0,
                                 .line_end = s->end,
                                 .fields = FIELDS - 1 - (at->inner ? 0 : 2),
                                 .field = field + 1,
                                 .facts = 2,
                                 .fact = fact};
    SPARI_TRY(spar_session_get_time(session, &picture.time, NULL, NULL));
    return spari_vtk_write(session, call, path, &picture);
}

/* Number of nodes in `at`; checks that the member has results. */
static int size_up(const spar_member *member, nodal *at) {
    SPARI_TRY(spar_member_get_count(member, &at->n));
    at->elements = at->per_element = 1;
    if (at->n > 1) {
        int external, fidelity;
        SPARI_TRY(spar_beam_get_elements(member, &at->elements, &at->per_element));
        SPARI_TRY(spar_member_get_external(member, &external));
        SPARI_TRY(spar_member_get_fidelity(member, &fidelity, NULL));
        at->inner = !external && fidelity != SPAR_FIDELITY_PRESCRIBED;
    }
    return spar_member_get_reference(member, NULL, NULL);
}

static int write_picture(const spar_member *member, nodal *at, spar_session *session, const char *path,
                         const char *call) {
    int64_t n = at->n;
    sampled s = {.n = (int64_t)at->elements * ((at->per_element - 1) * SPARI_PIECES + 1)};
    double *work = spari_zalloc(40 * n, sizeof *work);
    at->q = work, at->v = work + 7 * n, at->a = work + 13 * n, at->load = work + 19 * n, at->chain = work + 25 * n;
    at->frame = work + 29 * n, at->xr = work + 33 * n, at->qr = work + 36 * n;
    s.table = spari_zalloc(COLUMNS * s.n, sizeof *s.table);
    s.eta = spari_zalloc(s.n, sizeof *s.eta);
    s.node = spari_zalloc(n, sizeof *s.node);
    s.end = spari_zalloc(at->elements, sizeof *s.end);
    int all = work && s.table && s.eta && s.node && s.end;
    int status = all ? fill_nodal(member, at) : no_memory(session, member, call);
    if (status == SPAR_OK) {
        sample_member(&s, at);
        status = at->inner ? sample_sections(&s, member, session, call) : SPAR_OK;
    }
    if (status == SPAR_OK) {
        status = write_member(&s, at, session, path, call);
    }
    SPARI_FREE(work, s.table, s.eta, s.node, s.end);
    return status;
}

int spar_member_write_vtk(const spar_member *member, const char *path) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_REQUIRE(NULL, member, SPAR_ERR_ARGUMENT, "%s: the member is NULL; create it first", __func__);
    spar_session *session;
    nodal at = {0};
    SPARI_TRY(spar_member_get_session(member, &session));
    int status = size_up(member, &at);
    status = status == SPAR_OK ? write_picture(member, &at, session, path, __func__) : status;
    return spari_named(session, __func__, status);
}
