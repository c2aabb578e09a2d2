/* Data of a rotor or wing of blade elements, shared by the files of this room. */
#ifndef SPARI_AERO_H
#define SPARI_AERO_H

#include "element.h"
#include "wind.h"

#include <spar/spar_aero.h>

/* A row of the report of effects. */
typedef struct spari_aero_effect {
    int in_force, fails;
    double size, motion, reaction, share;
} spari_aero_effect;

struct spar_aero {
    spar_session *session; /* for messages; NULL without blades */
    int blades;            /* on this rank */
    int64_t n;             /* sections per blade */
    spar_fluid **fluid;
    spari_rotor rotor, first; /* first: as described first */
    int rotor_given, effects_given, solved;
    spari_section *section; /* [n] */
    int64_t *row;           /* [blades][n] of the polars: where look-ups begin */
    double *place;          /* reference positions [blades][n][3] */
    double *length;         /* [blades][n - 1] */
    double *loss_radius;    /* [blades][n], of the first rotor; NULL: no loss asked for so far */
    double *x, *v, *q;
    double *omega;            /* NULL: no rotor and no unsteady airfoil yet */
    double *a, *omega_a;      /* NULL: no unsteady airfoil yet */
    spari_element *element;   /* [blades][n] */
    double *force, *moment;   /* moment: NULL before one is pushed */
    spari_memory *was, *is;   /* [blades][n] at t^n and at t^{n+1}; NULL: no unsteady effects yet */
    spari_attached *attached; /* [n]; NULL: no dynamic stall yet */
    spari_wind *wind;         /* NULL: neither shear nor tower described */
    double *met;              /* [blades][n][3] wind with shear and tower; NULL: not in force yet */
    int *inside;              /* [blades][n] SPAR_AERO_FLAG_TOWER or 0 */
    int64_t solves;           /* calls of spar_aero_solve */
    int reporting, gone;      /* a report is being made; a callback in it has destroyed the object */
    int reported;             /* there is a report of effects */
    spari_aero_effect effect[SPAR_AERO_ROW_COUNT];
    spari_rotor used; /* in the last solution; rotor_used: it was set then */
    int rotor_used;
};

#endif
