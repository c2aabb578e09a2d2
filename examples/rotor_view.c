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
    int in_force, fails;
    double size, motion, reaction, share;
} line;

static double worst(const line *l) {
    return l->fails ? INFINITY : fmax(l->motion, l->reaction);
}

/* What is in force first, the largest error on top. */
static int by_error(const void *a, const void *b) {
    const line *x = a, *y = b;
    if (x->in_force != y->in_force) {
        return x->in_force < y->in_force ? 1 : -1;
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
    double share = l->share;
    printf("   leave %s out: ", l->name);
    if (l->fails) {
        printf("the run fails\n");
        return;
    }
    printf("%s of the root loads, ", percent(l->reaction, loads));
    if (fabs(share) < 0.005) {
        printf("saves nothing\n");
    } else {
        printf("%s %.0f %%%s\n", share > 0 ? "saves" : "costs", 100 * fabs(share), share > 0 ? "" : " more");
    }
}

static void print_line(const line *l) {
    char motion[32], loads[32];
    printf("  %-18s %9.2g", l->name, l->size);
    if (l->fails) {
        printf(" %11s %11s %8s", "fails", "fails", "");
    } else {
        printf(" %11s %11s %6.0f %%", percent(l->motion, motion), percent(l->reaction, loads),
               round(100 * l->share) + 0.0); /* no -0 */
    }
    print_words(l);
}

static void print_table(const line *lines, const rotor_trial *t) {
    double dt = 0;
    int64_t steps = 0;
    (void)spar_trial_get_steps(t->trial, &dt, &steps);
    printf("What effects are worth over %.3g s from here (%lld steps of %g s):\n\n", dt * (double)steps,
           (long long)steps, dt);
    printf("  %-18s %9s %11s %11s %8s\n", "effect", "size", "deflection", "root loads", "time");
    int k = 0;
    for (; k < ROWS && lines[k].in_force; k++) {
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
        const line *l = lines + k;
        printf("%s,%s,%d,%.6g,%.6g,%.6g,%.6g\n", l->name, l->kind, l->in_force, l->size, l->fails ? -1 : l->motion,
               l->fails ? -1 : l->reaction, l->share);
    }
}

int rotor_view_effects(const rotor_trial *t, int csv, int show) {
    line lines[ROWS];
    int status = spar_trial_report_effects(t->trial);
    if (status == SPAR_OK) {
        status = spar_aero_report_effects(t->aero, t->trial);
    }
    if (status != SPAR_OK || !show) {
        return status;
    }
    for (int r = 0; r < SPAR_ROW_COUNT; r++) {
        line *l = lines + r;
        *l = (line){.name = spar_effect_name(r), .kind = "coupling"};
        spar_trial_get_effect(t->trial, r, &l->in_force, &l->fails, &l->size, &l->motion, &l->reaction, &l->share);
    }
    for (int r = 0; r < SPAR_AERO_ROW_COUNT; r++) {
        line *l = lines + SPAR_ROW_COUNT + r;
        *l = (line){.name = spar_aero_effect_name(r), .kind = "blade element"};
        spar_aero_get_effect(t->aero, r, &l->in_force, &l->fails, &l->size, &l->motion, &l->reaction, &l->share);
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

static int take_advice(const rotor_trial *t, rotor_options *o) {
    int fidelity = 0, nodes = 0, points = 0;
    int64_t modes = 0;
    int status = spar_trial_get_settings(t->trial, &o->dt, &o->substeps, &o->scheme, &o->coupling_tolerance,
                                         &o->predictor, &o->newton);
    if (status == SPAR_OK) {
        status = spar_trial_get_beam(t->trial, t->blade, &fidelity, &modes, NULL, &nodes, &points);
    }
    if (status == SPAR_OK && !o->rigid) {
        o->fidelity = fidelity;
        o->modes = (int)modes;
        o->nodes = nodes;
        o->quadrature = points > 0 ? points : o->quadrature;
    }
    return status;
}

static void print_advice(const rotor_options *o, const rotor_trial *t, double length) {
    double error = 0, cost = 0, present = 0;
    int fails = 0;
    int64_t runs = 0;
    (void)spar_trial_get_outcome(t->trial, &error, &cost, &fails, &present);
    (void)spar_trial_get_search(t->trial, &runs, NULL);
    printf("Settings for a tolerance of %g, from %d trials of %.3g s:\n\n", o->tolerance, (int)runs, length);
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
    printf("  estimated error    %.2g of the deflection", error);
    if (!fails) {
        printf(" (as given: %.2g)\n  cost               %.2g of what it is as given\n", present, cost);
    } else {
        printf(" (as given it fails)\n");
    }
    printf("\n  as options:");
    rotor_options_print(o, stdout);
    printf("\n\n");
}

/* What accuracy costs around the advice: OUT/advice.csv has error and cost of the run as given, as advised, and as
   advised for a tenth of the tolerance. Where that is refused, its row is left out. */
static int write_decades(const rotor_trial *t, const rotor_options *o, double length, int show) {
    double error[2] = {0, 0}, cost[2] = {0, 0}, present = 0, tenth = 0.1 * o->tolerance;
    char path[1024];
    int fails = 0;
    (void)spar_trial_get_outcome(t->trial, error, cost, &fails, &present);
    int found = spar_trial_advise(t->trial, tenth, fmax(o->seconds, length)) == SPAR_OK &&
                spar_trial_get_outcome(t->trial, error + 1, cost + 1, NULL, NULL) == SPAR_OK;
    if (!show) {
        return SPAR_OK;
    }
    snprintf(path, sizeof path, "%s/advice.csv", o->out);
    FILE *file = fopen(path, "w");
    if (!file) {
        fprintf(stderr, "rotor: '%s' cannot be written\n", path);
        return SPAR_ERR_IO;
    }
    fprintf(file, "settings,error,cost\n");
    if (!fails) {
        fprintf(file, "as given,%.6g,1\n", present);
    }
    fprintf(file, "advised for %g,%.6g,%.6g\n", o->tolerance, error[0], cost[0]);
    if (found) {
        fprintf(file, "advised for %g,%.6g,%.6g\n", tenth, error[1], cost[1]);
        printf("  a decade more      a tolerance of %g costs %.2g of what it is as given\n\n", tenth, cost[1]);
    } else {
        printf("  a decade more      no settings were found for a tolerance of %g\n\n", tenth);
    }
    return fclose(file) == 0 ? SPAR_OK : SPAR_ERR_IO;
}

int rotor_view_advice(const rotor_trial *t, rotor_options *o, int show) {
    double dt = 0;
    int64_t steps = 0;
    (void)spar_trial_get_steps(t->trial, &dt, &steps);
    double length = dt * (double)steps;
    int status = spar_trial_advise(t->trial, o->tolerance, fmax(o->seconds, length));
    if (status == SPAR_OK) {
        status = take_advice(t, o);
    }
    if (status == SPAR_OK && show) {
        print_advice(o, t, length);
    }
    return status == SPAR_OK ? write_decades(t, o, length, show) : status;
}
