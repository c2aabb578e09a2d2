/* Shapes for the reduced description of structure and fluid: see shapes.h. */
#include "shapes.h"

#include "../base/session.h"
#include "../exchange/rank_loads_and_motion.h"
#include "../math/rotation.h"
#include "../time/fidelity.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

int spari_shapes_ready(spar_trial *t, const char *call, int64_t n, const char *what, const double *out) {
    spar_session *s = t->session;
    SPARI_TRY(spari_trial_ready(t, call));
    SPARI_REQUIRE(s, t->modes > 0, SPAR_ERR_STATE,
                  "%s: the number of modes is not set; call spar_trial_set_motion first", call);
    SPARI_TRY(s->clock.started ? SPAR_OK : spari_session_pushes(s, call));
    SPARI_REQUIRE(s, n >= 0 && n <= 2 * t->modes, SPAR_ERR_ARGUMENT,
                  "%s: %lld %s of %lld modes; give at most two per mode", call, (long long)n, what,
                  (long long)t->modes);
    SPARI_REQUIRE(s, out || n == 0, SPAR_ERR_ARGUMENT, "%s: eigenvalue is NULL", call);
    return SPAR_OK;
}

int64_t spari_shapes_nodes(const spar_session *s) {
    int64_t nodes = 0;
    for (const spar_member *m = s->members; m; m = m->next) {
        nodes += m->committed ? m->nodes : 0;
    }
    return nodes;
}

void spari_shapes_times(const spari_pencil *p, int kind, const double *x, double *y) {
    memset(y, 0, (size_t)p->n * sizeof *y);
    spari_pencil_times(p, 0, kind == 0, kind == 1, kind == 2, x, y);
}

double spari_shapes_product(int n, const double *a, const double *b) {
    double sum = 0;
    for (int i = 0; i < n; i++) {
        sum += a[i] * b[i];
    }
    return sum;
}

/* The undamped, symmetric part, whose eigenvectors are the shapes. `more` times M is added to K, which does not
   change them. */
static int symmetric_part(const spari_pencil *p, double more, spari_pencil *to) {
    if (spari_pencil_create(to, p->n) != SPAR_OK) {
        return SPAR_ERR_MEMORY;
    }
    to->constraints = p->constraints;
    for (int64_t i = 0; i < p->entries; i++) {
        const spari_pencil_entry *e = p->entry + i;
        double k = 0.5 * (e->k + more * e->m), m = 0.5 * e->m;
        spari_pencil_put(to, (spari_pencil_entry){e->row, e->column, k, 0, m});
        spari_pencil_put(to, (spari_pencil_entry){e->column, e->row, k, 0, m});
    }
    for (int64_t i = 0; i < p->constraint_entries; i++) {
        spari_pencil_add_constraint(to, p->constraint[i]);
    }
    return to->full ? SPAR_ERR_MEMORY : SPAR_OK;
}

/* Orthogonalises x, or its imaginary part, against the `count` existing shapes; appends the rest if it is not zero.
   room [2 n] */
static int add_shape(const spari_pencil *p, const double complex *x, int imaginary, int count, double *shape,
                     double *workspace) {
    int n = p->n;
    double *at = shape + (int64_t)n * count, *Mx = workspace;
    for (int i = 0; i < n; i++) {
        at[i] = imaginary ? cimag(x[i]) : creal(x[i]);
    }
    for (int pass = 0; pass < 2; pass++) {
        for (int k = 0; k < count; k++) {
            const double *other = shape + (int64_t)n * k;
            spari_shapes_times(p, 2, other, Mx);
            double along = spari_shapes_product(n, Mx, at);
            for (int i = 0; i < n; i++) {
                at[i] -= along * other[i];
            }
        }
        spari_shapes_times(p, 2, at, Mx);
        double square = spari_shapes_product(n, at, Mx);
        if (!(square > (pass == 0 ? 1e-8 : 0))) {
            return 0;
        }
        for (int i = 0; i < n; i++) {
            at[i] /= sqrt(square);
        }
    }
    return 1;
}

/* A small stiffness, proportional to mass, for motions without stiffness; larger than its rounding error. */
static double some_stiffness(const spari_pencil *p, double *diagonal) {
    double most = 0;
    memset(diagonal, 0, 2 * (size_t)p->n * sizeof *diagonal);
    for (int64_t i = 0; i < p->entries; i++) {
        const spari_pencil_entry *e = p->entry + i;
        diagonal[e->row] += e->row == e->column ? e->k : 0;
        diagonal[p->n + e->row] += e->row == e->column ? e->m : 0;
    }
    for (int i = 0; i < p->n; i++) {
        most = fmax(most, diagonal[p->n + i] > 0 ? fabs(diagonal[i]) / diagonal[p->n + i] : 0);
    }
    return most > 0 ? 1e-12 * most : 1;
}

/* `modes` shapes of unit mass [modes][size] and their rates; *count: their number. A shape with negative omega^2, as
   in rotation beyond the frequency of a support, has two eigenvalues that count, so more are requested. value: room
   for 2 modes, and as many vectors. */
static int search_shapes(const spari_small_motions *w, int modes, double more, double complex *value, double *shape,
                         double *rate, double *workspace, int *count) {
    spari_pencil part = {0};
    int n = w->size, found = 0, status = symmetric_part(&w->pencil, more, &part);
    double complex *x = value + 2 * modes;

    *count = 0;
    if (status == SPAR_OK) {
        status = spari_spectrum(&part, 2 * modes, 0, SPARI_SPECTRUM_CHOICE, &found, value, x);
    }
    for (int k = 0; k < 2 * found && *count < modes && status == SPAR_OK; k++) {
        if (add_shape(&w->pencil, x + (int64_t)n * (k / 2), k % 2, *count, shape, workspace)) {
            double square = fabs(creal(value[k / 2] * value[k / 2]) + more);
            rate[(*count)++] = square > 1e-3 * more ? sqrt(square) : 0;
        }
    }
    spari_pencil_free(&part);
    return status;
}

double spari_shapes_unit(const spar_session *s, const double *shape) {
    double most = 0;
    for (const spar_member *m = s->members; m; m = m->next) {
        for (int64_t i = 0; i < m->nodes; i++, shape += 6) {
            most = fmax(most, fmax(spari_norm(shape) / spari_member_length(m), spari_norm(shape + 3)));
        }
    }
    return most > 0 ? 1 / most : 1;
}

void spari_shapes_keep_motion(const spar_session *s, double *motion) {
    for (const spar_member *m = s->members; m; m = m->next) {
        for (int64_t i = 0; i < m->nodes; i++, motion += SPARI_NODE_MOTION) {
            memcpy(motion, m->now.q + 7 * i, 7 * sizeof *motion);
            memcpy(motion + 7, m->now.v + 6 * i, 6 * sizeof *motion);
        }
    }
}

int spari_shapes_find(spari_small_motions *w, int modes, double *shape, double *rate) {
    int64_t n = w->size;
    int count = 0;
    SPARI_REQUIRE(w->session, modes <= n, SPAR_ERR_ARGUMENT, "%d modes; there are %d unknowns", modes, w->size);
    double complex *value = spari_zalloc(2 * modes * (n + 1), sizeof *value);
    double *workspace = spari_zalloc(2 * n, sizeof *workspace), most = 0;
    int status = value && workspace ? SPAR_OK : SPAR_ERR_MEMORY;
    for (int pass = 0; pass < 2 && count < modes && status != SPAR_ERR_MEMORY; pass++) {
        double more = pass ? some_stiffness(&w->pencil, workspace) : 0;
        status = search_shapes(w, modes, more, value, shape, rate, workspace, &count);
    }
    for (int k = 0; k < count; k++) {
        most = fmax(most, rate[k]);
    }
    for (int k = 0; k < count; k++) {
        rate[k] = fmax(rate[k], most > 0 ? 0.01 * most : 1);
    }
    SPARI_FREE(value, workspace);
    SPARI_REQUIRE(w->session, status != SPAR_ERR_MEMORY, status, "no memory for %d modes", modes);
    SPARI_REQUIRE(w->session, status == SPAR_OK && count == modes, SPAR_ERR_NUMERIC,
                  "only %d of %d modes found; the others have no mass, or have not converged: request fewer", count,
                  modes);
    return SPAR_OK;
}

void spari_shapes_show(const spari_small_motions *w, int modes, const double *shape, double *nodes) {
    for (int k = 0; k < modes; k++, shape += w->size) {
        for (const spar_member *m = w->session->members; m; m = m->next) {
            const spari_motion_part *part = spari_small_motions_part(w, m);
            if (part) {
                m->row->shape(m, shape + part->at, w->workspace, nodes);
            }
            nodes += 6 * m->nodes;
        }
    }
}
