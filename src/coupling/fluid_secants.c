/* Quasi-Newton iteration that approximates the fluid alone (docs/explanation/theory.md, "Secants of the fluid").
   The structure's response to loads is known: S, its present tangent. Unknown is the fluid. A secant is a motion p that
   the structure made between two evaluations, and the change y of the loads that came back, both as they were measured,
   in the axes of the sections. A structure that bends or turns therefore leaves secants right that a difference of
   loads, which has S in it, would not. */
#include "accelerator_data.h"

#include "../base/status.h"
#include "../math/rotation.h"

#include <string.h>

/* The constants of the scheme; coupling.filter, coupling.columns and coupling.reuse are the host's.
   FADE_SECANTS: weight of older pairs in rho, for one new secant. It decides how fast rho follows a fluid that changes.
   MOST_RHO: a fluid that carries more of its loads over needs so many evaluations that its residual says nothing.
   LEAST_RHO: below, memory is neglected and costs nothing.
   FIRST_REACH, rad: no correction turns a section by more, until GAIN. It decides how far a linear model of the fluid
     is believed that has not been tried.
   LEAST_REACH, rad: it is not reduced below. Smaller rotations leave a structure linear, and the cause is another.
   GROWN: an iterate whose residual is larger by this factor than that of the one before it is not gone on from.
   GAIN: a limited correction that reduced the residual as predicted makes room for one that is larger by this factor.
   STALE: a reused tangent whose prediction S dx of a motion is off by more is formed anew in each solution. The loads
     of a heavy fluid are off by the same part after each correction.
   OFF: beyond, S is not the response over the step at all. Substeps differ by 1.5 and more, reused tangents by less
     than 0.3. */
static const double FADE_SECANTS = 0.95, MOST_RHO = 0.95, LEAST_RHO = 1e-3, FIRST_REACH = 0.03, LEAST_REACH = 1e-3,
                    GROWN = 10, GAIN = 10, STALE = 0.03, OFF = 0.5;

/* Rotates forces and moments, or displacements and rotations, of each node by its quaternion, or back. */
static void rotate(const double *axes, int back, int64_t n, double *v) {
    for (int64_t i = 0; i < n && axes; i += 6, axes += 4) {
        for (int64_t k = i; k < i + 6; k += 3) {
            (back ? spari_rotate_back : spari_rotate)(axes, v + k, v + k);
        }
    }
}

/* Sum of products of motions, rotations multiplied by the length of the member. */
static double products(const spari_accelerator *a, const double *p, const double *q) {
    double sum[2] = {0, 0};
    for (int64_t i = 0; i < a->n; i += 2) {
        for (int64_t k = i; k < i + 2 && k < a->n; k++) {
            sum[k - i] += a->stretch[k] * a->stretch[k] * p[k] * q[k];
        }
    }
    return sum[0] + sum[1];
}

/* The length of the motion of secant j as this step has it. */
static double length(const spari_accelerator *a, int j) {
    const double *p = a->p + a->column[j].slot * a->n;
    return spari_column_scale(a, j) * sqrt(products(a, p, p));
}

/* ---- secants ---- */

/* Estimates rho (T32). J of an added mass is symmetric, so p_j . y_i - p_i . y_j is rho times the same of the changes
   before. The fit is multiplied by the part R^2 of the asymmetry that it explains, adjusted for the number of pairs:
   an asymmetric fluid without memory, or noise, gives small R^2. */
static void estimate_rho(spari_accelerator *a) {
    spari_recollection *m = &a->memory;
    const double *p = a->p + a->column[0].slot * a->n, *y = a->y + a->column[0].slot * a->n,
                 *b = a->b + a->column[0].slot * a->n;
    double size = length(a, 0);
    m->pairs *= FADE_SECANTS, m->ww *= FADE_SECANTS, m->wb *= FADE_SECANTS, m->bb *= FADE_SECANTS;
    for (int j = 1; j < a->count; j++) {
        int64_t at = a->column[j].slot * a->n;
        double sizes = a->column[j].led && spari_column_serves(a, j) ? size * length(a, j) : 0;
        if (sizes > 0) {
            double scale = spari_column_scale(a, j);
            double w = scale * spari_sum_products(a->p + at, y, a->n) - spari_sum_products(p, a->y + at, a->n);
            double c = scale * spari_sum_products(a->p + at, b, a->n) - spari_sum_products(p, a->b + at, a->n);
            w /= sizes, c /= sizes;
            m->pairs++, m->ww += w * w, m->wb += w * c, m->bb += c * c;
        }
    }
    double explained = m->ww * m->bb > 0 ? m->wb * m->wb / (m->ww * m->bb) : 0;
    explained = m->pairs > 1 ? explained - (1 - explained) / (m->pairs - 1) : 0;
    double rho = m->wb > 0 && explained > 0 ? fmin(MOST_RHO, explained * m->wb / m->bb) : 0;
    m->rho = rho > LEAST_RHO ? rho : 0;
}

/* Difference of the motion and that which the tangent predicts, relative to the latter. */
static double error_of_tangent(const spari_accelerator *a, const double *response, const spari_images *images) {
    double *off = a->response, size = products(a, response, response);
    for (int64_t i = 0; i < a->n; i++) {
        off[i] = images->moved[i] - response[i];
    }
    return size > 0 ? sqrt(products(a, off, off) / size) : 0;
}

/* ---- axes ---- */

/* p and y of column j, both weighed, in fixed axes or in those of the sections. */
static void get_column(const spari_accelerator *a, int j, int fixed, double *p, double *y) {
    size_t bytes = (size_t)a->n * sizeof *p;
    const int slot = a->column[j].slot;
    const double scale = spari_column_scale(a, j);
    memcpy(p, a->p + slot * a->n, bytes);
    memcpy(y, a->y + slot * a->n, bytes);
    if (fixed != a->fixed) {
        const double *axes = a->axes + slot * (a->n / 6 * 4);
        rotate(axes, a->fixed, a->n, p);
        rotate(axes, a->fixed, a->n, y);
    }
    for (int64_t i = 0; i < a->n; i++) {
        p[i] *= scale * a->stretch[i];
        y[i] /= a->stretch[i];
    }
}

/* Whether secant j of an earlier step is as long as those that the fit has: a shorter one is rounding, or scatter. */
static int is_kept(const spari_accelerator *a, int j, double longest) {
    return length(a, j) > a->set.filter * a->set.filter * longest;
}

/* Length of the longest motion of earlier steps. */
static double longest_before(const spari_accelerator *a) {
    double most = 0;
    for (int j = 1; j < a->count; j++) {
        most = a->column[j].step < a->step && spari_column_serves(a, j) ? fmax(most, length(a, j)) : most;
    }
    return most;
}

/* The part of the newest secant's loads that those of earlier steps do not predict, squared, relative to these loads;
   -1: its motion is new to them. Newest first, each by its independent part: a mean would hide what rotates. */
static double misprediction(spari_accelerator *a, int fixed, double longest) {
    static const double INDEPENDENT = 1e-2, NEW = 0.1;
    int64_t n = a->n;
    int rank = 0, j = 1;
    double *r = a->matrix, whole;
    for (; j < a->count && rank < a->set.columns - 1; j++) {
        if (a->column[j].step < a->step && spari_column_serves(a, j) && is_kept(a, j, longest)) {
            double *y = a->loads + rank * n;
            get_column(a, j, fixed, a->basis + rank * n, y);
            if (spari_orthonormalise(n, rank, INDEPENDENT, a->basis, r)) {
                for (int i = 0; i < rank; i++) {
                    spari_axpy(-r[i], a->loads + i * n, y, n);
                }
                for (int64_t i = 0; i < n; i++) {
                    y[i] /= r[rank];
                }
                rank++;
            }
        }
    }
    double *p = a->basis + rank * n, *y = a->loads + rank * n;
    get_column(a, 0, fixed, p, y);
    whole = spari_sum_products(y, y, n);
    if (!spari_orthonormalise(n, rank, 0, a->basis, r)) {
        r[rank] = 0;
    }
    for (int i = 0; i < rank; i++) {
        spari_axpy(-r[i], a->loads + i * n, y, n);
    }
    double known = spari_sum_products(r, r, rank), left = r[rank] * r[rank];
    return left <= NEW * NEW * (known + left) && whole > 0 ? spari_sum_products(y, y, n) / whole : -1;
}

/* Adds to decaying sums, unless one of the hypotheses knows nothing of the motion. */
static void add_surprises(int count, const double *surprise, double *sum) {
    int known = 1;
    for (int i = 0; i < count; i++) {
        known = known && surprise[i] >= 0;
    }
    for (int i = 0; i < count && known; i++) {
        sum[i] = FADE_SECANTS * sum[i] + surprise[i];
    }
}

/* Whether secants serve whose steps had another length. */
static int has_other_steps(const spari_accelerator *a) {
    int other = 0;
    for (int j = 0; j < a->count; j++) {
        other = other || memcmp(a->column[j].per, a->per, sizeof a->per) != 0;
    }
    return other;
}

/* The quantity that has predicted best. */
static void choose_quantity(spari_accelerator *a) {
    const double *surprise = a->memory.surprise_of;
    for (int i = 0; i <= SPARI_OWN_STEPS; i++) {
        a->memory.quantity = surprise[i] < surprise[a->memory.quantity] ? i : a->memory.quantity;
    }
}

/* The first secant of a step tells in which axes those of the steps before hold, and as functions of which quantity.
   Without those of other steps, nothing is predicted: the whole of the loads is new. */
static void compare_hypotheses(spari_accelerator *a) {
    if (a->count < 2 || a->column[1].step == a->step || a->set.columns < 2) {
        return;
    }
    const int quantity = a->memory.quantity;
    double longest = longest_before(a), axes[2] = {misprediction(a, 0, longest), -1}, of[SPARI_OWN_STEPS + 1];
    axes[1] = axes[0] >= 0 ? misprediction(a, 1, longest) : -1;
    add_surprises(2, axes, a->memory.surprise);
    for (int i = 0; i < SPARI_QUANTITIES && has_other_steps(a); i++) {
        a->memory.quantity = i;
        of[i] = misprediction(a, a->fixed, longest_before(a));
    }
    if (has_other_steps(a)) {
        of[SPARI_OWN_STEPS] = 1;
        add_surprises(SPARI_OWN_STEPS + 1, of, a->memory.surprise_of);
    }
    a->memory.quantity = quantity;
    choose_quantity(a); /* at once: where a step that fails is halved again and again, none is accepted */
}

void spari_fluid_secants_accept(spari_accelerator *a) {
    int fixed = a->memory.surprise[1] < a->memory.surprise[0];
    for (int j = 0; j < a->count && fixed != a->fixed; j++) {
        int slot = a->column[j].slot;
        const double *axes = a->axes + slot * (a->n / 6 * 4);
        double *const vector[] = {a->p, a->y, a->b};
        for (int k = 0; k < 3 && a->column[j].kind != SPARI_OF_LOADS; k++) {
            rotate(axes, a->fixed, a->n, vector[k] + slot * a->n);
        }
    }
    a->fixed = fixed;
}

/* Adds a secant with the motion p. */
static void add(spari_accelerator *a, const double *p, const double *axes) {
    size_t bytes = (size_t)a->n * sizeof *a->lead;
    const double *y = a->change + a->n, *own = a->fixed ? NULL : axes;
    if (spari_sum_products(p, p, a->n) > 0) {
        int slot = spari_column_add(a);
        int64_t at = slot * a->n;
        memcpy(a->p + at, p, bytes);
        memcpy(a->y + at, y, bytes);
        rotate(own, 1, a->n, a->p + at);
        rotate(own, 1, a->n, a->y + at);
        if (a->led) {
            memcpy(a->b + at, a->lead, bytes);
            rotate(own, 1, a->n, a->b + at);
            estimate_rho(a);
        }
        if (axes) {
            memcpy(a->axes + slot * (a->n / 6 * 4), axes, bytes / 6 * 4);
            compare_hypotheses(a);
        }
    } else {
        a->stalled++;
    }
    memcpy(a->lead, y, bytes);
    a->led = 1;
}

int spari_accelerator_renews(const spari_accelerator *a) {
    return a->memory.off > STALE;
}

int spari_fluid_secants_learn(spari_accelerator *a, const double *dx, const spari_images *images) {
    SPARI_TRY(images->of(images->context, 1, dx, a->images));
    if (images->rotation(images->context, images->moved) <= FIRST_REACH) {
        double off = error_of_tangent(a, a->images, images);
        a->drifts = off > OFF || (a->drifts && a->iteration > 2); /* not back within a step: secants would be lost */
        a->memory.off = fmax(a->drifts ? 0 : off, FADE_SECANTS * a->memory.off);
    }
    add(a, a->drifts ? a->images : images->moved, images->axes);
    return SPAR_OK;
}

void spari_fluid_secants_end(spari_accelerator *a, const spari_images *images) {
    if (!a->drifts) {
        add(a, images->moved, images->axes);
    }
}

/* ---- fit ---- */

/* The secants in use, newest first: a->slots; returns how many. */
static int gather_secants(spari_accelerator *a) {
    int k = 0;
    for (int j = 0; j < a->count && k < a->set.columns; j++) {
        if (spari_column_serves(a, j)) {
            a->slots[k++] = j;
        }
    }
    return k;
}

/* Products of the motions in use, [k][k], each times the weight of both. A secant counts by the root of its length:
   long ones have less scatter, short ones are nearer to the solution. */
static void multiply(const spari_accelerator *a, int k, double *weight, double *A) {
    for (int i = 0; i < k; i++) {
        const double *p = a->p + a->column[a->slots[i]].slot * a->n, scale = spari_column_scale(a, a->slots[i]);
        weight[i] = 1 / sqrt(length(a, a->slots[i]));
        for (int j = 0; j <= i; j++) {
            const double *q = a->p + a->column[a->slots[j]].slot * a->n;
            double scales = scale * spari_column_scale(a, a->slots[j]);
            A[i * k + j] = A[j * k + i] = weight[i] * weight[j] * scales * products(a, p, q);
        }
    }
}

/* Rows U [rank][k]: orthonormal combinations of the secants that hold all but coupling.filter of their motions, by
   Cholesky's factorisation of A with pivots (Higham 1990), orthonormalised. left [k]: workspace. Returns the rank. */
static int find_combinations(int k, const double *A, double filter, double *U, double *left) {
    int rank = 0;
    double most = 0;
    for (int i = 0; i < k; i++) {
        left[i] = A[i * k + i];
        most = fmax(most, left[i]);
    }
    for (; rank < k; rank++) {
        int pivot = 0;
        double *u = U + rank * k;
        for (int i = 1; i < k; i++) {
            pivot = left[i] > left[pivot] ? i : pivot;
        }
        if (!(left[pivot] > filter * filter * most) || !isfinite(left[pivot])) {
            break;
        }
        double root = sqrt(left[pivot]);
        for (int i = 0; i < k; i++) {
            double rest = left[i] > 0 ? A[i * k + pivot] : 0;
            for (int r = 0; r < rank && left[i] > 0; r++) {
                rest -= U[r * k + i] * U[r * k + pivot];
            }
            u[i] = rest / root;
        }
        for (int i = 0; i < k; i++) {
            left[i] = i == pivot ? 0 : left[i] - u[i] * u[i];
        }
    }
    for (int r = 0; r < rank; r++) {
        (void)spari_orthonormalise(k, r, 0, U, left);
    }
    return rank;
}

/* Motions that the secants span, a->basis, and the loads of the fluid due to each, without the part that it only
   carries over, a->loads, in global axes. Returns how many. */
static int span(spari_accelerator *a, const double *axes) {
    int k = gather_secants(a);
    double *weight = a->alpha, rho = spari_rho_of(a);
    multiply(a, k, weight, a->matrix);
    int rank = find_combinations(k, a->matrix, a->set.filter, a->combinations, a->left);
    memset(a->basis, 0, (size_t)(rank * a->n) * sizeof *a->basis);
    memset(a->loads, 0, (size_t)(rank * a->n) * sizeof *a->loads);
    for (int r = 0; r < rank; r++) {
        double *p = a->basis + r * a->n, *y = a->loads + r * a->n;
        for (int i = 0; i < k; i++) {
            const spari_column *c = a->column + a->slots[i];
            double f = weight[i] * a->combinations[r * k + i];
            spari_axpy(f * spari_column_scale(a, a->slots[i]), a->p + c->slot * a->n, p, a->n);
            spari_axpy(f, a->y + c->slot * a->n, y, a->n);
            if (rho > 0 && c->led) {
                spari_axpy(-rho * f, a->b + c->slot * a->n, y, a->n);
            }
        }
        rotate(axes, 0, a->n, p);
        rotate(axes, 0, a->n, y);
    }
    a->filtered = k - rank;
    return rank;
}

/* alpha := the coefficients of the loads that minimise |s + (S Y - P) alpha|; s is destroyed. Returns whether they are
   finite. */
static int minimise(spari_accelerator *a, int rank, double *s) {
    static const double DEPENDENT = 1e-12; /* a direction in which the fluid cancels the structure to rounding */
    int64_t n = a->n;
    a->used = 0;
    for (int j = 0; j < rank; j++) {
        double *z = a->basis + a->used * n, *r = a->matrix + (int64_t)a->used * a->set.columns;
        for (int64_t i = 0; i < n; i++) {
            z[i] = a->stretch[i] * (a->images[j * n + i] - a->basis[j * n + i]);
        }
        if (spari_orthonormalise(n, a->used, DEPENDENT, a->basis, r)) {
            a->slots[a->used++] = j;
        }
    }
    for (int j = 0; j < a->used; j++) {
        const double *z = a->basis + j * n;
        a->alpha[j] = -spari_sum_products(z, s, n);
        spari_axpy(a->alpha[j], z, s, n);
    }
    return spari_back_substitute(a->used, a->matrix, a->set.columns, a->alpha);
}

/* ---- correction ---- */

/* The part of a correction that is applied. size: of the residual in motion, before it; base: of that from which the
   correction goes on. The reach of one step serves the next, until a correction does not reduce the residual. Then it
   is a quarter of that correction. */
static double limit(spari_accelerator *a, double rotation, double size, double base) {
    double *reach = &a->memory.reach, wanted = a->cut > 0 ? 1 - 0.5 * a->cut : 1;
    if (a->iteration == 1) {
        *reach = fmax(*reach, FIRST_REACH);
    } else if (size > wanted * a->before) {
        *reach = fmax(fmin(FIRST_REACH, 0.25 * a->turned), LEAST_REACH);
    } else if (a->cut > 0) {
        *reach *= GAIN;
    }
    a->cut = rotation > *reach ? *reach / rotation : 0;
    a->turned = fmin(rotation, *reach);
    a->before = base;
    return a->cut > 0 ? a->cut : 1;
}

/* s and motion := of the residual next [n], whose image is `image`. Returns the size of the motion. */
static double weigh(const spari_accelerator *a, const double *image, double *s, double *motion) {
    for (int64_t i = 0; i < a->n; i++) {
        motion[i] = image[i];
        s[i] = a->stretch[i] * motion[i];
    }
    return sqrt(spari_sum_products(s, s, a->n));
}

/* The loads from which the correction goes on: those of this iteration, or, if the residual has grown so far that a
   linear model of it says nothing, those of the one before. The secants have both. *size := of their residual. */
static int choose_base(spari_accelerator *a, const spari_images *images, double *next, double *image, double *size) {
    const int64_t n = a->n;
    const int far = a->iteration > 1 && a->turned > LEAST_REACH; /* where structure or fluid may be another one */
    if (!far || spari_rho_of(a) > 0 || *size <= GROWN * a->before) {
        memcpy(a->base, a->x, (size_t)n * sizeof *a->x);
        memcpy(a->base + n, a->g, (size_t)n * sizeof *a->g);
        return SPAR_OK;
    }
    for (int64_t i = 0; i < n; i++) {
        next[i] = a->base[n + i] - a->base[i];
    }
    SPARI_TRY(images->of(images->context, 1, next, image));
    *size = weigh(a, image, a->response, a->response + n);
    return SPAR_OK;
}

int spari_fluid_secants_next(spari_accelerator *a, const spari_images *images, double *next) {
    const int64_t n = a->n;
    double rho = a->led ? spari_rho_of(a) : 0;
    int rank = span(a, a->fixed ? NULL : images->axes);
    double *lead = a->loads + rank * n, *image = a->images + rank * n, *s = a->response, *motion = a->response + n;
    memset(lead, 0, (size_t)n * sizeof *lead);
    spari_axpy(rho, a->lead, lead, n);
    SPARI_TRY(images->of(images->context, rank + 1, a->loads, a->images));
    for (int64_t i = 0; i < n; i++) {
        image[i] = images->now[i] + image[i];
        next[i] = a->g[i] - a->x[i] + lead[i];
    }
    double size = weigh(a, image, s, motion), base = size, omega = rank > 0 ? 1 : a->omega;
    SPARI_TRY(choose_base(a, images, next, image, &base));
    if (!minimise(a, rank, s)) {
        a->used = 0;
    }
    for (int j = 0; j < a->used; j++) {
        spari_axpy(a->alpha[j], a->loads + a->slots[j] * n, next, n);
        spari_axpy(a->alpha[j], a->images + a->slots[j] * n, motion, n);
    }
    omega *= limit(a, omega * images->rotation(images->context, motion), size, base);
    for (int64_t i = 0; i < n; i++) {
        next[i] = a->base[i] + omega * next[i];
    }
    return SPAR_OK;
}
