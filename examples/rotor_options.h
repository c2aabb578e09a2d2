/* What the rotor programs can be told. */
#ifndef ROTOR_OPTIONS_H
#define ROTOR_OPTIONS_H

#include <stdio.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct rotor_options {
    double wind, rpm, pitch; /* m/s, rev/min, deg; rpm and pitch not finite: from the table of rotor_operating_point */
    double shear, hub_height, yaw;
    double gust, gust_start, gust_length; /* m/s (0: none), s, s */
    double tilt, precone;                 /* deg; not finite: those of the turbine */
    double seconds, dt;                   /* seconds not finite: the program's choice */
    int rigid, straight, elements, nodes, quadrature;
    int fidelity, modes;           /* SPAR_FIDELITY_*; modes of a modal blade */
    int effects_off, aero_effects; /* SPAR_EFFECT_* that are off, SPAR_AERO_* that are on */
    int aero_effects_given;
    int scheme, max_iterations, predictor, substeps;
    double coupling_tolerance, relaxation, rho_inf, theta, newton;
    double tolerance, trial; /* not finite: no advice wanted; s, how long trials last, not finite: the program's */
    int csv;
    double vtk_every; /* s; 0: no pictures; not finite: the program's choice */
    int quiet, no_plots, help;
    const char *out, *data;
} rotor_options;

/* Fills the options from the command line. Returns 0, or 1 with a line on stderr that says what was wrong. */
int rotor_options_read(rotor_options *options, int argc, char **argv);
void rotor_options_help(const char *program);
/* Steady operation of the turbine at a wind speed: rotor speed in rev/min, blade pitch in deg. */
void rotor_operating_point(double wind, double *rpm, double *pitch);
const char *rotor_scheme_name(int scheme);
const char *rotor_fidelity_name(int fidelity);
/* The options that advice is about, as they stand on a command line. */
void rotor_options_print(const rotor_options *options, FILE *file);

#ifdef __cplusplus
}
#endif

#endif
