/* Tables of lift, drag and moment over the angle of attack, and their interpolation. */
#include "polar.h"
#include "../base/environment.h"
#include "../math/spline.h"
#include "message.h"
#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

/* Tolerance of a full circle (degrees converted to radians) and of equal end angles. */
#define SPARI_TURN (2.0 * 3.14159265358979323846)
#define SPARI_TURN_SLACK 1e-9
#define SPARI_END_SLACK 1e-6

enum { SPARI_CL, SPARI_CD, SPARI_CM, SPARI_COEFFICIENTS };

struct spari_table {
    atomic_int users;
    int kind, full, has_moment; /* interpolation; covers the full circle; any cm not zero */
    int64_t n;
    double *alpha;
    double *value[SPARI_COEFFICIENTS];
    spari_spline fit[SPARI_COEFFICIENTS];
};

struct spar_polar {
    spari_table *table;
};

static void table_free(spari_table *table) {
    for (int c = 0; table && c < SPARI_COEFFICIENTS; c++) {
        spari_spline_free(table->fit + c);
    }
    if (table) {
        free(table->alpha);
    }
    free(table);
}

void spari_table_release(spari_table *table) {
    if (table && atomic_fetch_sub(&table->users, 1) == 1) {
        table_free(table);
    }
}

spari_table *spari_polar_share(const spar_polar *polar) {
    atomic_fetch_add(&polar->table->users, 1);
    return polar->table;
}

static spari_spline_kind fit_kind(int kind, int full) {
    switch (kind) {
    case SPAR_POLAR_AKIMA:
        return full ? SPARI_SPLINE_AKIMA_PERIODIC : SPARI_SPLINE_AKIMA;
    case SPAR_POLAR_CUBIC:
        return full ? SPARI_SPLINE_CUBIC_PERIODIC : SPARI_SPLINE_CUBIC;
    default:
        return SPARI_SPLINE_LINEAR;
    }
}

/* One memory block holds alpha and the three coefficients; cm NULL: zero. */
static spari_table *table_create(int64_t n, const double *alpha, const double *const value[], int kind) {
    spari_table *table = spari_zalloc(1, sizeof *table);
    double *block = spari_zalloc(4 * n, sizeof *block);
    if (!table || !block) {
        free(table);
        free(block);
        return NULL;
    }
    size_t bytes = (size_t)n * sizeof *block;
    atomic_init(&table->users, 1);
    table->n = n;
    table->kind = kind;
    table->alpha = memcpy(block, alpha, bytes);
    table->full = alpha[n - 1] - alpha[0] > SPARI_TURN * (1.0 - SPARI_TURN_SLACK);
    for (int c = 0; c < SPARI_COEFFICIENTS; c++) {
        table->value[c] = block + (c + 1) * n;
        if (value[c]) {
            memcpy(table->value[c], value[c], bytes);
        }
        if (table->full) {
            table->value[c][n - 1] = table->value[c][0]; /* same angle, same value to the last bit */
        }
        if (spari_spline_create(table->fit + c, fit_kind(kind, table->full), n, table->alpha, table->value[c])) {
            table_free(table);
            return NULL;
        }
    }
    for (int64_t i = 0; i < n; i++) {
        table->has_moment |= table->value[SPARI_CM][i] != 0.0;
    }
    return table;
}

/* Checks that every row is finite and the angles increase; messages count rows from 0. */
static int check_rows(int64_t n, const double *alpha, const double *const value[], const char *call) {
    static const char *const name[] = {"cl", "cd", "cm"};
    for (int64_t i = 0; i < n; i++) {
        SPARI_AERO_REQUIRE(NULL, isfinite(alpha[i]), SPAR_ERR_ARGUMENT, "%s: alpha of row %lld is not finite", call,
                           (long long)i);
        for (int c = 0; c < SPARI_COEFFICIENTS; c++) {
            SPARI_AERO_REQUIRE(NULL, !value[c] || isfinite(value[c][i]), SPAR_ERR_ARGUMENT,
                               "%s: %s of row %lld (alpha %g rad) is not finite", call, name[c], (long long)i,
                               alpha[i]);
        }
        SPARI_AERO_REQUIRE(
            NULL, i == 0 || alpha[i] > alpha[i - 1], SPAR_ERR_ARGUMENT,
            "%s: alpha of row %lld (%g rad) is not above that of the previous row (%g rad); sort the rows "
            "and remove duplicates",
            call, (long long)i, alpha[i], alpha[i > 0 ? i - 1 : 0]);
    }
    return SPAR_OK;
}

/* Checks that the angles span at most a full circle, and that the coefficients agree after a full circle. */
static int check_turn(int64_t n, const double *alpha, const double *const value[], const char *call) {
    static const char *const name[] = {"cl", "cd", "cm"};
    double width = alpha[n - 1] - alpha[0];
    SPARI_AERO_REQUIRE(
        NULL, width < SPARI_TURN * (1.0 + SPARI_TURN_SLACK), SPAR_ERR_ARGUMENT,
        "%s: alpha goes from %g (row 0) to %g (row %lld), more than a full revolution; give radians over a "
        "range of at most 2 pi",
        call, alpha[0], alpha[n - 1], (long long)(n - 1));
    if (width > SPARI_TURN * (1.0 - SPARI_TURN_SLACK)) {
        for (int c = 0; c < SPARI_COEFFICIENTS; c++) {
            double first = value[c] ? value[c][0] : 0.0, last = value[c] ? value[c][n - 1] : 0.0;
            SPARI_AERO_REQUIRE(
                NULL, fabs(last - first) <= SPARI_END_SLACK * fmax(1.0, fabs(first)), SPAR_ERR_ARGUMENT,
                "%s: %s is %g in row 0 and %g in row %lld, but the two rows are one revolution apart; make them equal",
                call, name[c], first, last, (long long)(n - 1));
        }
    }
    return SPAR_OK;
}

int spar_polar_create(int64_t n, const double *alpha_rad, const double *cl, const double *cd, const double *cm,
                      spar_polar **polar) {
    SPARI_GUARD_ENVIRONMENT;
    const double *const value[] = {cl, cd, cm};
    SPARI_AERO_REQUIRE(NULL, polar, SPAR_ERR_ARGUMENT,
                       "%s: the pointer to the polar is NULL; give the address of a handle", __func__);
    SPARI_AERO_REQUIRE(NULL, n >= 2, SPAR_ERR_ARGUMENT, "%s: %lld rows; a polar needs at least 2", __func__,
                       (long long)n);
    SPARI_AERO_REQUIRE(NULL, n <= INT32_MAX, SPAR_ERR_ARGUMENT, "%s: %lld rows are too many", __func__, (long long)n);
    SPARI_AERO_REQUIRE(NULL, alpha_rad && cl && cd, SPAR_ERR_ARGUMENT, "%s: alpha, cl or cd is NULL; only cm may be",
                       __func__);
    SPARI_TRY(check_rows(n, alpha_rad, value, __func__));
    SPARI_TRY(check_turn(n, alpha_rad, value, __func__));
    spar_polar *made = spari_zalloc(1, sizeof *made);
    spari_table *table = made ? table_create(n, alpha_rad, value, SPAR_POLAR_LINEAR) : NULL;
    if (!table) {
        free(made);
        return spari_aero_fail(NULL, SPAR_ERR_MEMORY, "%s: no memory for %lld rows", __func__, (long long)n);
    }
    made->table = table;
    *polar = made;
    return SPAR_OK;
}

void spar_polar_destroy(spar_polar **polar) {
    if (polar && *polar) {
        spari_table_release((*polar)->table);
        free(*polar);
        *polar = NULL;
    }
}

int spar_polar_set_interpolation(spar_polar *polar, int kind) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_AERO_REQUIRE(NULL, polar, SPAR_ERR_ARGUMENT, "%s: the polar is NULL", __func__);
    SPARI_AERO_REQUIRE(NULL, kind >= SPAR_POLAR_LINEAR && kind <= SPAR_POLAR_CUBIC, SPAR_ERR_ARGUMENT,
                       "%s: kind %d is not known; SPAR_POLAR_LINEAR, _AKIMA or _CUBIC", __func__, kind);
    const spari_table *old = polar->table;
    int64_t least = spari_spline_least(fit_kind(kind, old->full));
    SPARI_AERO_REQUIRE(NULL, old->n >= least, SPAR_ERR_ARGUMENT,
                       "%s: kind %d needs at least %lld rows, the polar has %lld", __func__, kind, (long long)least,
                       (long long)old->n);
    const double *const value[] = {old->value[SPARI_CL], old->value[SPARI_CD], old->value[SPARI_CM]};
    spari_table *table = table_create(old->n, old->alpha, value, kind);
    SPARI_AERO_REQUIRE(NULL, table, SPAR_ERR_MEMORY, "%s: no memory for %lld rows", __func__, (long long)old->n);
    spari_table_release(polar->table);
    polar->table = table;
    return SPAR_OK;
}

int64_t spari_table_rows(const spari_table *table, int64_t capacity, double *alpha, double *const value[3], int *kind) {
    double *const out[] = {alpha, value[0], value[1], value[2]};
    const double *const in[] = {table->alpha, table->value[0], table->value[1], table->value[2]};
    for (int c = 0; c < SPARI_COEFFICIENTS + 1; c++) {
        for (int64_t i = 0; out[c] && i < capacity; i++) {
            out[c][i] = i < table->n ? in[c][i] : 0;
        }
    }
    if (kind) {
        *kind = table->kind;
    }
    return table->n;
}

int spari_table_has_moment(const spari_table *table) {
    return table->has_moment;
}

double spari_table_wrap(const spari_table *table, double alpha, int *beyond) {
    double first = table->alpha[0], last = table->alpha[table->n - 1];
    *beyond = 0;
    if (alpha >= first && alpha <= last) {
        return alpha;
    }
    alpha -= SPARI_TURN * floor((alpha - first) / SPARI_TURN); /* into [first, first + 2 pi) */
    if (alpha <= last) {
        return fmax(alpha, first);
    }
    *beyond = !table->full;
    return alpha - last <= first + SPARI_TURN - alpha ? last : first;
}

static double look_up(const spari_table *table, int c, double place, int64_t *row) {
    return spari_spline_at(table->fit + c, place, row, NULL);
}

double spari_table_lift(const spari_table *table, double place, int64_t *row) {
    return look_up(table, SPARI_CL, place, row);
}

double spari_table_lift_slope(const spari_table *table, double place, int64_t *row, double *slope) {
    return spari_spline_at(table->fit + SPARI_CL, place, row, slope);
}

double spari_table_drag(const spari_table *table, double place, int64_t *row) {
    return look_up(table, SPARI_CD, place, row);
}

double spari_table_moment(const spari_table *table, double place, int64_t *row) {
    return look_up(table, SPARI_CM, place, row);
}

/* Zero of the lift between two rows, not positive at the first and positive at the second. */
static double find_zero_lift(const spari_table *table, int64_t row) {
    int64_t near = row;
    double low = table->alpha[row], high = table->alpha[row + 1];
    for (int i = 0; i < 60; i++) {
        double middle = 0.5 * (low + high);
        if (spari_table_lift(table, middle, &near) > 0.0) {
            high = middle;
        } else {
            low = middle;
        }
    }
    return low;
}

void spari_table_find_attached(const spari_table *table, double *zero, double *slope) {
    const double *alpha = table->alpha, *lift = table->value[SPARI_CL];
    *zero = INFINITY;
    *slope = 0.0;
    for (int64_t i = 0; i + 1 < table->n; i++) {
        if (lift[i] <= 0.0 && lift[i + 1] > 0.0) {
            double found = find_zero_lift(table, i);
            *zero = fabs(found) < fabs(*zero) ? found : *zero;
        }
    }
    for (int64_t i = 0; i < table->n; i++) { /* closer than 1e-3 rad the quotient is dominated by rounding */
        double away = alpha[i] - *zero;
        if (fabs(away) > 1e-3 && fabs(away) < SPARI_TURN / 8.0) {
            *slope = fmax(*slope, lift[i] / away);
        }
    }
}

int spar_polar_evaluate(const spar_polar *polar, double alpha_rad, double *cl, double *cd, double *cm) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_AERO_REQUIRE(NULL, polar, SPAR_ERR_ARGUMENT, "%s: the polar is NULL", __func__);
    SPARI_AERO_REQUIRE(NULL, isfinite(alpha_rad), SPAR_ERR_ARGUMENT,
                       "%s: alpha is not finite; give a finite angle, rad", __func__);
    int64_t row = 0;
    int beyond;
    double place = spari_table_wrap(polar->table, alpha_rad, &beyond);
    double *out[] = {cl, cd, cm};
    for (int c = 0; c < SPARI_COEFFICIENTS; c++) {
        if (out[c]) {
            *out[c] = look_up(polar->table, c, place, &row);
        }
    }
    return SPAR_OK;
}
