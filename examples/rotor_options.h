/* What the rotor program can be told. */
#ifndef ROTOR_OPTIONS_H
#define ROTOR_OPTIONS_H

typedef struct rotor_options {
    double wind, rpm, pitch; /* m/s, rev/min, deg; rpm and pitch not finite: from the table of rotor_operating_point */
    double shear, hub_height, yaw;
    double gust, gust_start, gust_length; /* m/s (0: none), s, s */
    double tilt, precone;                 /* deg; not finite: those of the turbine */
    double seconds, dt;
    int rigid, straight, elements, nodes, quadrature;
    int effects, aero_effects; /* SPAR_EFFECT_*, SPAR_AERO_* in force */
    int effects_given, aero_effects_given;
    int scheme, max_iterations, predictor, substeps;
    double tolerance, relaxation, rho_inf, theta;
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

#endif
