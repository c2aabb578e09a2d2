#include "rotor_view.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int64_t rotor_trial_steps(double seconds, double dt) {
    return 8 * (int64_t)fmax(1, ceil(seconds / (8 * dt) - 1e-9));
}

/* ---- effects ---- */

enum { ROWS = SPAR_ROW_COUNT + SPAR_AERO_ROW_COUNT };

typedef struct line {
    const char *name, *kind;
    const double *value; /* [SPAR_COLUMN_COUNT] */
} line;

static double worst(const double *value) {
    double motion = value[SPAR_COLUMN_MOTION], reaction = value[SPAR_COLUMN_REACTION];
    return motion < 0 ? INFINITY : fmax(motion, reaction);
}

/* What is in force first, the largest error on top. */
static int by_error(const void *a, const void *b) {
    const double *x = ((const line *)a)->value, *y = ((const line *)b)->value;
    if (x[SPAR_COLUMN_IN_FORCE] != y[SPAR_COLUMN_IN_FORCE]) {
        return x[SPAR_COLUMN_IN_FORCE] < y[SPAR_COLUMN_IN_FORCE] ? 1 : -1;
    }
    return worst(x) < worst(y) ? 1 : worst(x) > worst(y) ? -1 : 0;
}

/* 0.4 %, to two digits */
static const char *percent(double part, char text[32]) {
    double size = 100 * fabs(part);
    if (size == 0) {
        snprintf(text, 32, "0 %%");
    } else if (size < 0.001) {
        snprintf(text, 32, "< 0.001 %%");
    } else {
        int digits = size >= 10 ? 0 : size >= 1 ? 1 : size >= 0.1 ? 2 : 3;
        snprintf(text, 32, "%.*f %%", digits, size);
    }
    return text;
}

static void print_words(const line *l) {
    char loads[32];
    double share = l->value[SPAR_COLUMN_SHARE];
    printf("   leave %s out: ", l->name);
    if (l->value[SPAR_COLUMN_MOTION] < 0) {
        printf("the run fails\n");
        return;
    }
    printf("%s of the root loads, ", percent(l->value[SPAR_COLUMN_REACTION], loads));
    if (fabs(share) < 0.005) {
        printf("saves nothing\n");
    } else {
        printf("%s %.0f %%%s\n", share > 0 ? "saves" : "costs", 100 * fabs(share), share > 0 ? "" : " more");
    }
}

static void print_line(const line *l) {
    char motion[32], loads[32];
    printf("  %-18s %9.2g", l->name, l->value[SPAR_COLUMN_SIZE]);
    if (l->value[SPAR_COLUMN_MOTION] < 0) {
        printf(" %11s %11s %8s", "fails", "fails", "");
    } else {
        printf(" %11s %11s %6.0f %%", percent(l->value[SPAR_COLUMN_MOTION], motion),
               percent(l->value[SPAR_COLUMN_REACTION], loads),
               round(100 * l->value[SPAR_COLUMN_SHARE]) + 0.0); /* no -0 */
    }
    print_words(l);
}

static void print_table(const line *lines, const rotor_trial *t) {
    printf("What effects are worth over %.3g s from here (%lld steps of %g s):\n\n", t->dt * (double)t->steps,
           (long long)t->steps, t->dt);
    printf("  %-18s %9s %11s %11s %8s\n", "effect", "size", "deflection", "root loads", "time");
    int k = 0;
    for (; k < ROWS && lines[k].value[SPAR_COLUMN_IN_FORCE] > 0; k++) {
        print_line(lines + k);
    }
    printf("\n  not in force:");
    for (int first = k; k < ROWS; k++) {
        printf("%s %s", k > first ? "," : "", lines[k].name);
    }
    printf("\n");
}

static void print_csv(const line *lines) {
    printf("effect,of,in_force,size,deflection_error,root_load_error,share_of_time\n");
    for (int k = 0; k < ROWS; k++) {
        printf("%s,%s", lines[k].name, lines[k].kind);
        for (int c = 0; c < SPAR_COLUMN_COUNT; c++) {
            printf(",%.6g", lines[k].value[c]);
        }
        printf("\n");
    }
}

int rotor_view_effects(const rotor_trial *t, int csv, int show) {
    double table[SPAR_ROW_COUNT][SPAR_COLUMN_COUNT], aero[SPAR_AERO_ROW_COUNT][SPAR_COLUMN_COUNT];
    line lines[ROWS];
    int status = spar_session_report_effects(t->session, t->dt, t->steps, t->before, t->solve, t->context,
                                             SPAR_ROW_COUNT, SPAR_COLUMN_COUNT, table[0]);
    if (status == SPAR_OK) {
        status = spar_aero_report_effects(t->aero, t->session, t->dt, t->steps, t->before, t->solve, t->context,
                                          SPAR_AERO_ROW_COUNT, SPAR_COLUMN_COUNT, aero[0]);
    }
    if (status != SPAR_OK || !show) {
        return status;
    }
    for (int r = 0; r < SPAR_ROW_COUNT; r++) {
        lines[r] = (line){spar_effect_name(r), "coupling", table[r]};
    }
    for (int r = 0; r < SPAR_AERO_ROW_COUNT; r++) {
        lines[SPAR_ROW_COUNT + r] = (line){spar_aero_effect_name(r), "blade element", aero[r]};
    }
    qsort(lines, ROWS, sizeof *lines, by_error);
    if (csv) {
        print_csv(lines);
    } else {
        print_table(lines, t);
    }
    return SPAR_OK;
}

/* ---- advice ---- */

static void take_advice(const double *advice, int fidelity, int64_t modes, int nodes, int points, rotor_options *o) {
    o->dt = advice[SPAR_ADVICE_DT];
    o->substeps = (int)advice[SPAR_ADVICE_SUBSTEPS];
    o->scheme = (int)advice[SPAR_ADVICE_SCHEME];
    o->coupling_tolerance = advice[SPAR_ADVICE_COUPLING_RTOL];
    o->predictor = (int)advice[SPAR_ADVICE_PREDICTOR];
    o->newton = advice[SPAR_ADVICE_NEWTON_RTOL];
    if (!o->rigid) {
        o->fidelity = fidelity;
        o->modes = (int)modes;
        o->nodes = nodes;
        o->quadrature = points > 0 ? points : o->quadrature;
    }
}

static void print_advice(const double *advice, const rotor_options *o, const rotor_trial *t) {
    double present = advice[SPAR_ADVICE_PRESENT_ERROR], cost = advice[SPAR_ADVICE_COST];
    printf("Settings for a tolerance of %g, from %d trials of %.3g s:\n\n", o->tolerance,
           (int)advice[SPAR_ADVICE_TRIALS], t->dt * (double)t->steps);
    printf("  time step          %.4g s", o->dt);
    if (o->substeps > 1) {
        printf(" in %d substeps", o->substeps);
    }
    printf("\n");
    if (!o->rigid) {
        printf("  blades             %s", rotor_fidelity_name(o->fidelity));
        if (o->fidelity == SPAR_FIDELITY_MODAL) {
            printf(", %d modes", o->modes);
        }
        printf(", %d %s of %d nodes\n", o->elements, o->elements > 1 ? "elements" : "element", o->nodes);
        if (o->quadrature > 0) {
            printf("  quadrature         %d %s per interval of the section table\n", o->quadrature,
                   o->quadrature > 1 ? "points" : "point");
        } else {
            printf("  quadrature         as it was\n");
        }
    }
    printf("  coupling           %s", rotor_scheme_name(o->scheme));
    if (o->scheme != SPAR_COUPLING_EXPLICIT) {
        printf(", to %.2g of the loads", o->coupling_tolerance);
    }
    printf("\n  predictor          order %d\n  Newton             to %.2g\n", o->predictor, o->newton);
    printf("  estimated error    %.2g of the deflection", advice[SPAR_ADVICE_ERROR]);
    if (present >= 0) {
        printf(" (as given: %.2g)\n  cost               %.2g of what it is as given\n", present, cost);
    } else {
        printf(" (as given it fails)\n");
    }
    printf("\n  as options:");
    rotor_options_print(o, stdout);
    printf("\n\n");
}

int rotor_view_advice(const rotor_trial *t, rotor_options *o, int show) {
    double advice[SPAR_ADVICE_COUNT];
    int fidelity = 0, nodes = 0, points = 0;
    int64_t modes = 0;
    int status =
        spar_session_advise(t->session, o->tolerance, t->dt, t->steps, fmax(o->seconds, (double)t->steps * t->dt),
                            t->before, t->solve, t->context, SPAR_ADVICE_COUNT, advice);
    if (status == SPAR_OK) {
        status = spar_member_get_advice(t->blade, &fidelity, &modes, &nodes, &points);
    }
    if (status != SPAR_OK) {
        return status;
    }
    take_advice(advice, fidelity, modes, nodes, points, o);
    if (show) {
        print_advice(advice, o, t);
    }
    return SPAR_OK;
}
