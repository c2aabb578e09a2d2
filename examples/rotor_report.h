/* What the rotor program leaves behind: the history, the loads along the span, plots, the table. */
#ifndef ROTOR_REPORT_H
#define ROTOR_REPORT_H

#include "nrel5mw.h"
#include "rotor_options.h"
#include <stdio.h>

#ifdef __cplusplus
extern "C" {
#endif

/* One row of the history: these, then ROTOR_PER_BLADE for each blade. */
enum { ROTOR_TIME, ROTOR_AZIMUTH, ROTOR_WIND, ROTOR_THRUST, ROTOR_TORQUE, ROTOR_POWER, ROTOR_ITERATIONS, ROTOR_BLADES };
enum { ROTOR_FLAP, ROTOR_EDGE, ROTOR_FLAP_MOMENT, ROTOR_EDGE_MOMENT, ROTOR_PER_BLADE };
/* Loads along the span of the first blade: per length, and lumped at the sections. */
enum { ROTOR_AXIAL, ROTOR_TANGENTIAL, ROTOR_LUMPED, ROTOR_ALPHA, ROTOR_INDUCTION, ROTOR_SPAN };
/* Where the wall time goes. */
enum {
    ROTOR_PREDICT,
    ROTOR_STRUCTURE,
    ROTOR_MOTION,
    ROTOR_AERO,
    ROTOR_LOADS,
    ROTOR_CHECK,
    ROTOR_ACCEPT,
    ROTOR_OUTPUT,
    ROTOR_PHASES
};

typedef struct rotor_report {
    const rotor_options *options;
    const nrel5mw *turbine;
    const nrel5mw_rotor *rotor;
    double speed; /* rad/s */
    int ranks;
    double mean_from, revolutions; /* means are taken from here to the end: whole revolutions, where one fits */
    /* history */
    int columns;
    int64_t rows, room;
    double *history;
    /* [ROTOR_SPAN][sections]: weighted sum, least, most */
    double *sum, *least, *most, weight;
    double phase[ROTOR_PHASES], wall;
    double quaternion_error; /* largest | |q| - 1 | met */
} rotor_report;

/* Returns 0, or 1 when there is no memory. */
int rotor_report_begin(rotor_report *report);
void rotor_report_free(rotor_report *report);
/* The next row, filled by the caller; NULL when there is no memory. */
double *rotor_report_row(rotor_report *report);
/* Part of the step of length dt ending at t that counts in the means, 0 to 1. */
double rotor_report_weight(const rotor_report *report, double t, double dt);
/* Adds the span loads [ROTOR_SPAN][sections] of one time. */
void rotor_report_span(rotor_report *report, const double *value, double weight);

void rotor_report_print(const rotor_report *report, FILE *file);
/* history.csv, span.csv, plots.gp, and the plots where gnuplot is there; in the folder of the options. Says on stdout
   where they are. Returns 0, or 1 with a line on stderr. */
int rotor_report_write(const rotor_report *report);
/* Makes the folder and those above it. Returns 0, or 1 with a line on stderr. */
int rotor_make_folder(const char *path);

#ifdef __cplusplus
}
#endif

#endif
