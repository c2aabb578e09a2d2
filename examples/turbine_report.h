/* What the turbine program leaves behind: the history, its table, plots. */
#ifndef TURBINE_REPORT_H
#define TURBINE_REPORT_H

#include <stdint.h>
#include <stdio.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Columns of the history. */
enum {
    TURBINE_TIME,
    TURBINE_WIND,
    TURBINE_ROTOR_SPEED, /* rad/s */
    TURBINE_PITCH,       /* rad */
    TURBINE_GENERATOR,   /* torque at the rotor's side, N m */
    TURBINE_SHAFT_POWER, /* that of the generator's torque, W */
    TURBINE_POWER,       /* electrical, W */
    TURBINE_THRUST,      /* N */
    TURBINE_AIR_TORQUE,  /* N m */
    TURBINE_TOP_FORE,    /* of the tower, downwind, m */
    TURBINE_TOP_SIDE,    /* along y, m */
    TURBINE_BASE_MOMENT, /* about y: what bends the tower downwind, N m */
    TURBINE_TWIST,       /* of the drivetrain, rad */
    TURBINE_AZIMUTH,     /* rad */
    TURBINE_ITERATIONS,
    TURBINE_TIPS, /* for each blade: flap (downwind) and edge (to the trailing edge), m, in the hub's axes */
    TURBINE_COLUMNS = TURBINE_TIPS + 6
};

typedef struct turbine_report {
    const char *out, *scene; /* folder; what the plots' titles say */
    int64_t rows, room;
    double (*row)[TURBINE_COLUMNS];
} turbine_report;

/* The next row, to be filled; NULL when there is no memory. */
double *turbine_report_row(turbine_report *report);
void turbine_report_free(turbine_report *report);
/* Means, least and most over the last `seconds`. */
void turbine_report_print(const turbine_report *report, double seconds, FILE *file);
/* history.csv, plots.gp and, where gnuplot is there, the plots. Returns 0, or 1 with a line on stderr. */
int turbine_report_write(const turbine_report *report, int plots);
/* Runs gnuplot on a script in the folder. 0 when it drew. */
int turbine_draw(const char *folder, const char *script);

#ifdef __cplusplus
}
#endif

#endif
