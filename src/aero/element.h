/* One blade element: loads per unit span from position, motion and wind. Independent of fluid and session. */
#ifndef SPARI_ELEMENT_H
#define SPARI_ELEMENT_H

#include "momentum.h"
#include "unsteady.h"

/* Data that the sections of a rotor share. */
typedef struct spari_rotor {
    int effects; /* SPAR_AERO_* in force; hub loss needs a hub radius > 0 */
    int turn;    /* 1, or -1 for mirrored blades */
    int blades;  /* of the whole rotor */
    double hub[3], axis[3];
    double hub_radius, tip_radius;
} spari_rotor;

typedef struct spari_section {
    double chord, cos_twist, sin_twist;
    spari_table *table; /* NULL: not set */
} spari_section;

/* Attached flow of a section's table: zero-lift angle and slope. */
typedef struct spari_attached {
    int known;
    double zero, slope;
} spari_attached;

/* State of a section for unsteady effects. */
typedef struct spari_past {
    spari_passage step;
    const spari_attached *attached;    /* for dynamic stall */
    const double *omega, *a, *omega_a; /* for an unsteady airfoil: angular velocity, accelerations of the centre */
} spari_past;

typedef struct spari_centre {
    const double *x, *q, *v, *wind; /* position, orientation and velocity of the aerodynamic centre; wind there */
    double loss_radius;             /* distance from the axis in the reference configuration */
    int64_t *row;                   /* of its polar: where the next look-up begins */
    const spari_past *past;         /* NULL: no such effect in force */
} spari_centre;

typedef struct spari_element {
    double alpha, cl, cd, a, a_tangential;
    int flags;
    double load[6]; /* force and moment per unit span, global axes */
} spari_element;

/* Distance of x from the shaft axis. */
double spari_rotor_radius(const spari_rotor *rotor, const double x[3]);
/* count <= SPARI_ANNULI elements side by side, each by itself. lanes: see spari_momentum_solve. */
void spari_elements_solve(const spari_rotor *rotor, int lanes, int count, const spari_section *const *section,
                          const spari_centre *station, double density, spari_element *element);

#endif
