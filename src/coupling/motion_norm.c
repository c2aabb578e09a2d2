/* The motion norm of the coupling. Loads x move the structure by S x over the step; S is the flexibility, the
   inverse of the step's matrix. The norm is sqrt(x . S x), the root of the work of x on its own response. A load
   that moves nothing has no weight, and forces and moments have one unit. S of gyroscopic terms and follower loads is
   not symmetric: the norm has its symmetric part. */
#include "motion_norm.h"

#include "../assembly/assembly.h"
#include "../comm/enter.h"
#include "../member/structure.h"
#include "../time/fidelity.h"

#include <math.h>
#include <string.h>

int spari_motion_norm_is_used(const spar_session *s) {
    for (const spar_member *m = s->members; m; m = m->next) {
        if (!m->row->moves) { /* only the host knows its response */
            return 0;
        }
        if (m->assembly &&
            !(m->effects & SPAR_EFFECT_INERTIA)) { /* without mass there is no reference for constrained loads */
            return 0;
        }
    }
    return !s->coupling.norm_of_loads;
}

/* Response of member m, whose stacked loads begin at `at`, to the loads x - from (from NULL: x), stacked. Members
   connected by joints are solved together later; here their loads are stored instead. */
static int respond_stacked(const spari_norm_loads *c, spar_member *m, double unit, int64_t at, const double *x,
                           const double *from, double *out) {
    double *load = m->assembly ? out + at : c->workspace;
    int64_t n = 6 * m->nodes;
    for (int64_t i = 0; i < n; i++) {
        load[i] = (x[at + i] - (from ? from[at + i] : 0)) / (i % 6 < 3 ? 1 : unit);
    }
    if (m->assembly) {
        return 0;
    }
    if (spari_lone_response(m, c->of, load, out + at)) {
        return 1;
    }
    for (int64_t i = 0; i < n; i++) {
        out[at + i] /= i % 6 < 3 ? 1 : unit;
    }
    return 0;
}

/* Stacks the motions of a connected member. */
static void stack_assembled(const spar_member *m, double unit, int64_t at, double *out) {
    for (int64_t i = at; i < at + 6 * m->nodes; i++) {
        out[i] /= (i - at) % 6 < 3 ? 1 : unit;
    }
}

/* Responses of the members whose loads are stored. */
static int respond_assembled(spar_session *s, const spari_norm_loads *c, int64_t count, double *image) {
    int rank = spari_comm_rank(s->ranks.comm), singular = 0, k = 0;
    int64_t at = 0;
    for (spari_assembly *a = s->assemblies; a; a = spari_assembly_next(a)) {
        singular = spari_assembly_response(a, c->of, count, c->n, image) || singular;
    }
    for (const spar_member *m = s->members; m && s->assemblies; at += 6 * m->nodes, m = m->next, k++) {
        for (int64_t j = 0; j < count && m->assembly && m->owner == rank; j++) {
            stack_assembled(m, c->unit[k], at, image + j * c->n);
        }
    }
    return singular;
}

/* Sum of (a - minus) b, minus may be NULL; *sizes: sum of the products' sizes, the scale of rounding errors. */
static double sum_products(const double *a, const double *b, const double *minus, int64_t n, double *sizes) {
    double s = 0, size = 0;
    for (int64_t i = 0; i < n; i++) {
        double product = (a[i] - (minus ? minus[i] : 0)) * b[i];
        s += product;
        size += fabs(product);
    }
    *sizes += size;
    return s;
}

/* Rounding error of such sums and of the images in them, relative to the products' sizes. Loads that move nothing
   may be many times as large as those that do: they are in the sizes alone. */
static const double ROUNDING = 1e-13;

/* Loads on connected members may be carried by constraints: they move nothing, and a norm that ignores them would not
   control them. Their squares, times LEAST and the flexibility of the assembly's mass alone, are added: they count a
   hundredth of loads that move the structure. This rank's members. */
static void weigh_carried_loads(const spar_session *s, double *least) {
    static const double LEAST = 1e-4;
    for (const spar_member *m = s->members; m && s->assemblies; m = m->next, least++) {
        if (m->assembly && m->row->component && m->owner == spari_comm_rank(s->ranks.comm)) {
            *least = LEAST * spari_assembly_mass_response(m->assembly);
        }
    }
}

void spari_motion_norm_add_carried(const spar_session *s, const spari_norm_loads *c, const double *loads,
                                   double *image) {
    const double *least = c->image + 2 * c->n;
    int64_t at = 0;
    for (const spar_member *m = s->members; m && s->assemblies; at += 6 * m->nodes, m = m->next, least++) {
        for (int64_t i = at; i<at + 6 * m->nodes && * least> 0; i++) {
            image[i] += *least * loads[i];
        }
    }
}

/* Their squares, of g - x and of g - shift. */
static void add_carried_squares(const spar_session *s, const spari_norm_loads *c, double square[2]) {
    const double *least = c->image + 2 * c->n;
    int64_t at = 0;
    for (const spar_member *m = s->members; m && s->assemblies; at += 6 * m->nodes, m = m->next, least++) {
        for (int64_t i = at; i<at + 6 * m->nodes && * least> 0; i++) {
            double r = c->g[i] - c->x[i], g = c->g[i] - (c->shift ? c->shift[i] : 0);
            square[0] += *least * r * r;
            square[1] += *least * g * g;
        }
    }
}

int spari_motion_norm(spar_session *s, const spari_norm_loads *c, double *residual, double *size, int *ok) {
    double *response = c->image, *whole = c->image + c->n, square[2] = {0, 0};
    int64_t at = 0;
    int rank = spari_comm_rank(s->ranks.comm), singular = 0, k = 0;
    memset(c->image, 0, (size_t)(2 * c->n + s->member_count + 1) * sizeof *c->image);
    for (spar_member *m = s->members; m; at += 6 * m->nodes, m = m->next, k++) {
        if (m->owner == rank && m->row->component) {
            singular = singular || respond_stacked(c, m, c->unit[k], at, c->g, c->x, response) ||
                       respond_stacked(c, m, c->unit[k], at, c->g, c->shift, whole);
        }
    }
    singular = singular || respond_assembled(s, c, 2, c->image);
    weigh_carried_loads(s, c->image + 2 * c->n);
    if (singular) { /* its numbers would make the sums NaN, on every rank */
        c->image[0] = NAN;
    }
    SPARI_TRY(spari_sum(s, c->image, 2 * c->n + s->member_count));
    add_carried_squares(s, c, square);
    double works = 0, sizes = 0, work = sum_products(c->g, response, c->x, c->n, &works) + square[0],
           all = sum_products(c->g, whole, c->shift, c->n, &sizes) + square[1];
    *ok = isfinite(work) && isfinite(all) && work >= -ROUNDING * works && (all > 0 || work <= 0);
    *residual = sqrt(fmax(work, 0));
    *size = sqrt(fmax(all, 0));
    return SPAR_OK;
}

static int is_zero(const double *x, int64_t n) {
    int64_t i = 0;
    while (i < n && x[i] == 0) {
        i++;
    }
    return i == n;
}

int spari_motion_norm_images(spar_session *s, const spari_norm_loads *c, int64_t count, const double *loads,
                             double *image) {
    int rank = spari_comm_rank(s->ranks.comm), k = 0;
    int64_t at = 0;
    memset(image, 0, (size_t)(count * c->n + 1) * sizeof *image);
    for (spar_member *m = s->members; m; at += 6 * m->nodes, m = m->next, k++) {
        for (int64_t j = 0; j < count && m->owner == rank && m->row->component; j++) {
            const double *x = loads + j * c->n;
            if (!is_zero(x + at, 6 * m->nodes) && respond_stacked(c, m, c->unit[k], at, x, NULL, image + j * c->n)) {
                image[0] = NAN; /* cannot happen after spari_motion_norm succeeded */
            }
        }
    }
    if (respond_assembled(s, c, count, image)) {
        image[0] = NAN;
    }
    return spari_sum(s, image, count * c->n);
}

/* The part of the loads x - g that member m responds to, into off, stacked. */
static int effective_part(const spari_norm_loads *c, spar_member *m, double unit, const double *x, const double *g,
                          double *off) {
    int64_t n = 6 * m->nodes;
    for (int64_t i = 0; i < n; i++) {
        c->workspace[i] = (x[i] - g[i]) / (i % 6 < 3 ? 1 : unit);
    }
    int status = m->row->effective_load && !m->assembly ? m->row->effective_load(m, c->workspace) : SPAR_OK;
    for (int64_t i = 0; i < n; i++) {
        off[i] = c->workspace[i] * (i % 6 < 3 ? 1 : unit);
    }
    return status;
}

int spari_motion_norm_effective_load(spar_session *s, const spari_norm_loads *c, double *off, double *x) {
    int rank = spari_comm_rank(s->ranks.comm), asked = 0, status = SPAR_OK, k = 0;
    int64_t at = 0;
    memset(off, 0, (size_t)(c->n + 1) * sizeof *off);
    for (const spar_member *m = s->members; m; m = m->next) {
        asked = asked || (m->row->effective_here && !m->assembly);
    }
    for (spar_member *m = s->members; m; at += 6 * m->nodes, m = m->next, k++) {
        if ((!asked || m->owner == rank) && status == SPAR_OK) {
            status = effective_part(c, m, c->unit[k], x + at, c->g + at, off + at);
        }
    }
    if (status != SPAR_OK) {
        (void)spari_fail(s, status, "no memory for the modal loads");
    }
    SPARI_TRY(asked ? spari_comm_sum(s->ranks.comm, off, c->n, status, s->message, sizeof s->message) : status);
    for (int64_t i = 0; i < c->n; i++) {
        x[i] = c->g[i] + off[i];
    }
    return SPAR_OK;
}

/* Response of this rank's members to the loads that the prediction missed, image [n]. 1: none. */
static int respond_to_miss(spar_session *s, double *image, double *workspace) {
    int rank = spari_comm_rank(s->ranks.comm), singular = 0;
    double *at = image;
    for (spar_member *m = s->members; m; at += 6 * m->nodes, m = m->next) {
        if (m->owner != rank || !m->row->component) {
            continue;
        }
        double *miss = m->assembly ? at : workspace; /* replaced later by the response of connected members */
        for (int64_t i = 0; i < 6 * m->nodes; i++) {
            miss[i] = m->load.pushed[i] - m->load.used[i];
        }
        singular = (!m->assembly && spari_lone_response(m, SPARI_OF_DISPLACEMENT, workspace, at)) || singular;
    }
    for (spari_assembly *a = s->assemblies; a; a = spari_assembly_next(a)) {
        singular = spari_assembly_response(a, SPARI_OF_DISPLACEMENT, 1, 0, image) || singular;
    }
    return singular;
}

int spari_motion_norm_miss(spar_session *s, int64_t n, double *image, double *workspace, double *farthest) {
    double square = 0;
    memset(image, 0, (size_t)(n + 1) * sizeof *image);
    if (respond_to_miss(s, image, workspace)) {
        image[0] = NAN;
    }
    SPARI_TRY(spari_sum(s, image, n));
    for (int64_t i = 0; i < n; i += 6) {
        double way = image[i] * image[i] + image[i + 1] * image[i + 1] + image[i + 2] * image[i + 2];
        square = isfinite(way) ? fmax(square, way) : INFINITY;
    }
    *farthest = sqrt(square);
    return SPAR_OK;
}
