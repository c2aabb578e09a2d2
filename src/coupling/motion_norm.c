/* The motion norm of the coupling. Loads x move the structure by S x over the step; S is the flexibility, the
   inverse of the step's matrix. The norm is sqrt(x . S x), the root of the work of x on its own response. A load
   that moves nothing has no weight, forces and moments have one unit, and the derivative of an added mass, -M S, is
   symmetric. */
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
    if (spari_lone_response(m, load, out + at)) {
        return 1;
    }
    for (int64_t i = 0; i < n; i++) {
        out[at + i] /= i % 6 < 3 ? 1 : unit;
    }
    return 0;
}

/* Stacks the motions of a connected member. LEAST times the flexibility of its assembly's mass alone is added. Loads
   carried by constraints move nothing, and a norm that ignores them would not control them. They count a hundredth
   of loads that move the structure. With less, averaged columns still carry loads on rigid beams away. */
static void stack_assembled(const spar_member *m, double unit, int64_t at, const double *x, const double *from,
                            double *out) {
    static const double LEAST = 1e-4;
    double least = LEAST * spari_assembly_mass_response(m->assembly);
    for (int64_t i = at; i < at + 6 * m->nodes; i++) {
        double load = x[i] - (from ? from[i] : 0);
        out[i] = out[i] / ((i - at) % 6 < 3 ? 1 : unit) + least * load;
    }
}

/* And those of members whose loads x[j] - from[j] are stored, the x `apart` numbers from each other; from NULL:
   nothing is subtracted. */
static int respond_assembled(spar_session *s, const spari_norm_loads *c, int64_t count, const double *x, int64_t apart,
                             const double *const *from, double *image) {
    int rank = spari_comm_rank(s->ranks.comm), singular = 0, k = 0;
    int64_t at = 0;
    for (spari_assembly *a = s->assemblies; a; a = spari_assembly_next(a)) {
        singular = spari_assembly_response(a, count, c->n, image) || singular;
    }
    for (const spar_member *m = s->members; m && s->assemblies; at += 6 * m->nodes, m = m->next, k++) {
        for (int64_t j = 0; j < count && m->assembly && m->owner == rank; j++) {
            stack_assembled(m, c->unit[k], at, x + j * apart, from ? from[j] : NULL, image + j * c->n);
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

/* Whether x . S y equals y . S x, here for g - x and g, apart from rounding. Otherwise it is no inner product, and
   orthogonal columns can be nearly equal. The step's matrix is unsymmetric if beams rotate far under large loads,
   and by gyroscopic terms. Symmetric ones are symmetric to 1e-11. Joints rotate with their loads in each step; a
   scheme that alternates between two norms learns less than in either. */
static int is_symmetric(const spari_norm_loads *c, int assembled, const double *response, const double *whole,
                        double work, double all) {
    static const double LOPSIDED = 1e-5, ASSEMBLED = 1e-4;
    double sizes = 0, one = sum_products(c->g, response, NULL, c->n, &sizes),
           other = sum_products(c->g, whole, c->x, c->n, &sizes);
    return fabs(one - other) <=
           (assembled ? ASSEMBLED : LOPSIDED) * sqrt(fmax(work, 0) * fmax(all, 0)) + ROUNDING * fmax(all, sizes);
}

int spari_motion_norm(spar_session *s, const spari_norm_loads *c, double *residual, double *size, int *ok) {
    double *response = c->image, *whole = c->image + c->n, *bare = c->shift ? whole + c->n : whole;
    int64_t at = 0, images = c->shift ? 3 * c->n : 2 * c->n;
    int rank = spari_comm_rank(s->ranks.comm), singular = 0, k = 0;
    memset(c->image, 0, (size_t)(images + 1) * sizeof *c->image);
    for (spar_member *m = s->members; m; at += 6 * m->nodes, m = m->next, k++) {
        if (m->owner == rank && m->row->component) {
            singular = singular || respond_stacked(c, m, c->unit[k], at, c->g, c->x, response) ||
                       respond_stacked(c, m, c->unit[k], at, c->g, NULL, whole) ||
                       (c->shift && respond_stacked(c, m, c->unit[k], at, c->g, c->shift, bare));
        }
    }
    const double *const from[3] = {c->x, NULL, c->shift};
    singular = singular || respond_assembled(s, c, c->shift ? 3 : 2, c->g, 0, from, c->image);
    if (singular) { /* its numbers would make the sums NaN, on every rank */
        c->image[0] = NAN;
    }
    SPARI_TRY(spari_sum(s, c->image, images));
    double works = 0, sizes = 0, work = sum_products(c->g, response, c->x, c->n, &works),
           all = sum_products(c->g, bare, c->shift, c->n, &sizes);
    double both = c->shift ? fmax(all, sum_products(c->g, whole, NULL, c->n, &sizes)) : all;
    *ok = isfinite(work) && isfinite(all) && work >= -ROUNDING * works && (all > 0 || work <= 0) &&
          is_symmetric(c, s->assemblies != NULL, response, whole, work, both);
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
    if (respond_assembled(s, c, count, loads, c->n, NULL, image)) {
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
        singular = (!m->assembly && spari_lone_response(m, workspace, at)) || singular;
    }
    for (spari_assembly *a = s->assemblies; a; a = spari_assembly_next(a)) {
        singular = spari_assembly_response(a, 1, 0, image) || singular;
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
