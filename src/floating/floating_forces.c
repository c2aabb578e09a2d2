/* Forces of a linear or modal beam in the frame of its root, and their tangent: see frame.h. */
#include "../algebra/cblas.h"
#include "../math/rotation.h"
#include "../member/added_mass.h"
#include "../member/applied_loads.h"
#include "frame.h"

#include <math.h>
#include <string.h>

/* Loads of the nodes, in the axes of the frame: follower loads at the present nodes, and in a step the forces of the
   fluid's added mass on their accelerations. */
static void gather_loads_of(spari_frame *f, const spar_member *m, const spari_frame_state *s, int still,
                            double factor) {
    int n = f->nodes, n6 = 6 * n, guessed = m->added && !still && !f->resting && f->steps.started;
    double *q = f->global, *v = q + 7 * n, *a = v + n6;
    memset(f->loads, 0, (size_t)n6 * sizeof *f->loads);
    if (m->load.applied || guessed) {
        spari_frame_to_nodes(f, m, s, q, v, a);
    }
    if (m->load.applied) {
        spari_applied_residual(m, q, factor, f->loads);
    }
    if (guessed) {
        (void)spari_added_times(m, SPARI_UNKNOWNS, SPARI_UNKNOWNS, a, 1, f->loads);
    }
    for (int i = 0; i < n6; i++) {
        f->loads[i] = factor * f->steps.load[i] - f->loads[i];
    }
    for (int i = 0; i < n6; i += 3) {
        spari_rotate_back(s->root.q + 3, f->loads + i, f->loads + i);
    }
}

/* r := M (a - g, alpha) + f(omega, omega) - loads, with the acceleration (a, alpha) of the root and gravity g */
static void add_inertia_and_loads(spari_frame *f, const double rates[SPARI_FRAME_RATES], double factor, double *r) {
    if (f->sumf) {
        memcpy(r, f->sumf, (size_t)f->n * sizeof *r);
    } else {
        memset(r, 0, (size_t)f->n * sizeof *r);
    }
    spari_frame_gather(f, f->loads, f->dx);
    cblas_daxpy(f->n, -1, f->dx, 1, r, 1);
    for (int k = 0; k < 6 && f->rigid[0]; k++) {
        const double rate = rates[k < 3 ? 6 + k : k];
        if (rate != 0) {
            cblas_daxpy(f->n, rate, f->rigid[k], 1, r, 1);
        }
    }
    cblas_daxpy(f->pull ? f->n : 0, factor, f->pull, 1, r, 1);
}

static double largest_force(int n, const double *x) {
    double most = 0;
    for (int i = 0; i < n; i++) {
        double size = fabs(x[i]);
        most = size > most ? size : most;
    }
    return most;
}

double spari_frame_forces(spari_frame *f, const spar_member *m, const spari_frame_state *s, int still, double factor,
                          double *r) {
    double rates[SPARI_FRAME_RATES];
    spari_frame_rates(m, &s->root, still, factor, rates);
    const double lost = spari_frame_combine(f, m, rates) == SPAR_OK ? 0 : NAN;
    gather_loads_of(f, m, s, still, factor);
    add_inertia_and_loads(f, rates, factor, r);
    memset(f->elastic, 0, (size_t)f->n * sizeof *f->elastic);
    spari_frame_add_times(f, f->sumK ? f->sumK : f->K, s->y, 1, f->elastic);
    double scale = fmax(largest_force(f->n, r), largest_force(f->n, f->elastic));
    cblas_daxpy(f->n, 1, f->elastic, 1, r, 1);
    if (f->sumC) {
        spari_frame_add_times(f, f->sumC, s->v, 1, r);
    }
    if (f->M && !still) {
        spari_frame_add_times(f, f->M, s->a, 1, r);
    }
    memset(r, 0, (size_t)f->constrained * sizeof *r);
    r[f->n - 1] += lost;
    return scale;
}

int spari_frame_tangent(spari_frame *f, double cm, double cv) {
    const int64_t mm = (int64_t)f->block * f->block;
    const double *K = f->sumK ? f->sumK : f->K, *C = f->sumC, *M = f->M,
                 *A = f->steps.started ? f->A : NULL; /* at t^0 the added mass does not count */
    spari_frame_keep_factors(f);
    f->tangent.factored = 0;
    spari_linear_zero(f->linear);
    for (int e = 0; e < f->elements; e++) {
        for (int64_t i = 0, at = mm * e; i < mm; i++, at++) {
            f->element[i] = K[at] + (C ? cv * C[at] : 0) + (M ? cm * M[at] : 0) + (A ? cm * A[at] : 0);
        }
        spari_linear_add(f->linear, e, f->element);
    }
    for (int i = 0; i < f->constrained; i++) {
        spari_linear_fix(f->linear, i);
    }
    f->factors++;
    if (spari_linear_factor(f->linear)) {
        return 1;
    }
    f->tangent.factored = 1;
    f->tangent.cm = cm, f->tangent.cv = cv;
    memcpy(f->tangent.rates, f->rates, sizeof f->tangent.rates);
    return 0;
}
