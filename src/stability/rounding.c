/* Modes and eigenvalues beside stiff strains: see rounding.h. */
#include "rounding.h"

#include "../base/session.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Relative errors of |lambda|^2: below `small` nothing is done; beyond `most` a pair is refused, as its frequency is
   then wrong by more than 5e-4. A pair whose energy in the changed strains is beyond `other` is another one. part: a
   pair that is smaller than this part of the soft stiffness or of the others is as good as without stiffness: loads and
   stiffness cancel in it, and its error counts beside that part. */
static const double small = 1e-5, most = 1e-3, other = 1e-2, part = 1e-3;

/* What is found for each pair. */
typedef struct pair_energies {
    double *energy;  /* x^T K x */
    double *terms;   /* |x|^T |K| |x|, to which rounding errors are relative */
    double *soft;    /* the same with all strains as soft as the softest one; 0: not known */
    double *changed; /* energy in strains that are less stiff than described */
    double *other;
} pair_energies;

/* Energies of the pairs in the stiffness that is formed now. */
static void add_energies(const spari_small_motions *w, const spari_pairs *p, double *energy, double *terms) {
    for (int j = 0; j < p->n; j++) {
        energy[j] = terms[j] = 0;
        for (int k = 0; k < p->vectors; k++) {
            spari_small_motions_energy(w, p->x + ((int64_t)p->vectors * j + k) * w->size, energy + j, terms + j);
        }
    }
}

/* The same with strains at most `ratio` times as stiff as the softest; 0: as they are. */
static int find_energies(spari_small_motions *w, const spari_pairs *p, double ratio, double *energy, double *terms) {
    SPARI_TRY(spari_small_motions_cap(w, ratio));
    add_energies(w, p, energy, terms);
    return SPAR_OK;
}

static double rounding_of_energy(const pair_energies *e, int j) {
    return DBL_EPSILON * e->terms[j];
}

/* Relative errors of the pairs. Behind a pair that is another one, the order is not theirs. */
static void judge_pairs(const spari_pairs *p, const pair_energies *e, double *error) {
    double least = INFINITY;
    int same = 1;
    for (int j = 0; j < p->n; j++) {
        int clear = rounding_of_energy(e, j) < most * p->square[j];
        least = clear ? fmin(least, p->square[j]) : least;
    }
    for (int j = 0; j < p->n; j++) {
        double of = fmax(p->square[j], part * fmax(e->soft[j], isfinite(least) ? least : 0)), far = fabs(e->changed[j]);
        far += p->square[j] > 0 ? 0 : fabs(e->energy[j]); /* one without stiffness has no energy */
        same = same && (fabs(e->changed[j]) <= other * of || !(fabs(e->changed[j]) > 0));
        error[j] = !(e->terms[j] > 0) || !isfinite(p->square[j]) ? 0
                   : same                                        ? (rounding_of_energy(e, j) + far) / of
                                                                 : INFINITY;
    }
}

static double worst_of(const spari_pairs *p, int *which) {
    double worst = 0;
    *which = 0;
    for (int j = 0; j < p->n; j++) {
        if (p->error[j] > worst) {
            worst = p->error[j], *which = j;
        }
    }
    return worst;
}

/* The stiffness of linear and modal beams is that of their commit. */
static int has_softest(const spari_small_motions *w) {
    int exact = 1;
    for (int i = 0; i < w->parts; i++) {
        exact = exact && w->part[i].member->frame != SPARI_FRAME_LINEAR;
    }
    return exact;
}

/* Errors of the pairs as described. */
static int judge_as_described(spari_small_motions *w, spari_pairs *p, pair_energies *e) {
    int which;
    if (p->vectors > 1) {
        SPARI_TRY(find_energies(w, p, 0, e->energy, e->terms)); /* the solution has scaled the equations */
    } else {
        add_energies(w, p, e->energy, e->terms);
    }
    judge_pairs(p, e, p->error);
    if (worst_of(p, &which) > small && has_softest(w)) {
        SPARI_TRY(find_energies(w, p, 1, e->other, e->soft));
        judge_pairs(p, e, p->error);
    }
    return SPAR_OK;
}

/* The pairs with strains at most `ratio` times as stiff as the softest one; takes those that are known better. */
static int solve_capped(spari_small_motions *w, spari_pairs *p, double ratio, pair_energies *e, double *room) {
    const int n = p->n, length = p->vectors * w->size;
    spari_pairs own = *p;
    own.error = room, own.square = room + n, own.value = own.square + n, own.x = own.value + (int64_t)n * p->width;
    SPARI_TRY(spari_small_motions_cap(w, ratio));
    SPARI_TRY(own.solve(own.context, &own));
    SPARI_TRY(find_energies(w, &own, 1, e->other, e->soft));
    SPARI_TRY(find_energies(w, &own, 0.5 * ratio, e->other, e->terms));
    SPARI_TRY(find_energies(w, &own, ratio, e->energy, e->terms));
    for (int j = 0; j < n; j++) {
        e->changed[j] = 2 * (e->energy[j] - e->other[j]);
    }
    judge_pairs(&own, e, own.error);
    for (int j = 0, known = 1; j < n; j++) {
        known = known && own.error[j] <= most; /* then a larger pair is another one: p has missed this one */
        int missed = known && own.square[j] * (1 + 2 * own.error[j]) < p->square[j] * (1 - 2 * p->error[j]);
        if (own.error[j] < p->error[j] || missed) {
            p->error[j] = own.error[j], p->square[j] = own.square[j];
            memcpy(p->value + (int64_t)p->width * j, own.value + (int64_t)p->width * j,
                   (size_t)p->width * sizeof *p->value);
            memcpy(p->x + (int64_t)length * j, own.x + (int64_t)length * j, (size_t)length * sizeof *p->x);
        }
    }
    return SPAR_OK;
}

static int refuse_hidden(const spari_small_motions *w, int which, double error) {
    return spari_fail(
        w->session, SPAR_ERR_NUMERIC,
        "'%s': rounding of the stiffness hides result %d, whose square has a relative error of %.1g: some "
        "strains are too much stiffer than others; reduce the largest stiffness of the sections, or "
        "request fewer",
        w->part[0].member->name, which, error);
}

/* Of linear beams, near loads at which they buckle, small results are differences that no other equations show better.
 */
static void warn_hidden(const spari_small_motions *w, int which, double error) {
    spari_warn(w->session,
               "'%s': rounding of the stiffness of linear or modal beams leaves a relative error of about %.1g in the "
               "square of result %d; use SPAR_FIDELITY_EXACT, or reduce the largest stiffness of the sections",
               w->part[0].member->name, error, which);
}

/* From the equations as described, then with less stiff strains: each pair from where it is known best. */
static int solve_best(spari_small_motions *w, spari_pairs *p, int cures, double *room) {
    static const double ratios[3] = {1e8, 1e10, 1e12};
    const int n = p->n;
    pair_energies e = {room, room + n, room + 2 * (int64_t)n, room + 3 * (int64_t)n, room + 4 * (int64_t)n};
    int which, status = p->solve(p->context, p);
    if (status != SPAR_OK && status != SPAR_ERR_NUMERIC) {
        return status;
    }
    for (int j = 0; j < n; j++) {
        p->error[j] = INFINITY;
    }
    SPARI_TRY(status == SPAR_OK ? judge_as_described(w, p, &e) : SPAR_OK);
    for (int k = 0; k < 3 && cures && has_softest(w) && worst_of(p, &which) > small; k++) {
        char message[SPARI_MESSAGE_SIZE];
        (void)spari_messages_redirect(message); /* that this attempt fails is no failure */
        status = solve_capped(w, p, ratios[k], &e, room + 5 * (int64_t)n) == SPAR_OK ? SPAR_OK : status;
        (void)spari_messages_redirect(NULL);
    }
    SPARI_TRY(status);
    double worst = worst_of(p, &which);
    if (worst > most && !has_softest(w)) {
        warn_hidden(w, which, worst);
        return SPAR_OK;
    }
    return worst <= most ? SPAR_OK : refuse_hidden(w, which, worst);
}

int spari_pairs_solve(spari_small_motions *w, spari_pairs *p, int cures) {
    const int64_t n = p->n, size = 7 * n + n * (p->width + (int64_t)p->vectors * w->size);
    if (n == 0) {
        return SPAR_OK;
    }
    double *room = spari_zalloc(size, sizeof *room);
    SPARI_REQUIRE(w->session, room, SPAR_ERR_MEMORY, "no memory for the modes of '%s'", w->part[0].member->name);
    int status = solve_best(w, p, cures, room);
    free(room);
    return status;
}
