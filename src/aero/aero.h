/* A rotor or wing of blade elements: what its calls share. */
#ifndef SPARI_AERO_H
#define SPARI_AERO_H

#include "element.h"
#include "wind.h"

#include <spar/spar_aero.h>

struct spar_aero {
    spar_session *session; /* for messages; NULL without blades */
    int blades;            /* on this rank */
    int64_t n;             /* sections per blade */
    spar_fluid **fluid;
    spari_rotor rotor, first; /* first: as it was described first */
    int rotor_given, effects_given, solved;
    spari_section *section; /* [n] */
    int64_t *row;           /* [blades][n] of the polars: where look-ups begin */
    double *place;          /* reference places [blades][n][3] */
    double *length;         /* [blades][n - 1] */
    double *loss_radius;    /* [blades][n], of the first rotor; NULL: no loss asked for so far */
    double *x, *v, *q;
    double *omega;            /* NULL: no rotor, no unsteady airfoil so far */
    double *a, *omega_a;      /* NULL: no unsteady airfoil so far */
    spari_element *element;   /* [blades][n] */
    double *force, *moment;   /* moment: NULL before there is one to push */
    spari_memory *was, *is;   /* [blades][n] at t^n and at t^{n+1}; NULL: nothing that remembers so far */
    spari_attached *attached; /* [n]; NULL: no dynamic stall so far */
    spari_wind *wind;         /* NULL: neither shear nor tower described so far */
    double *met;              /* [blades][n][3] wind with these; NULL: not in force so far */
    int *inside;              /* [blades][n] SPAR_AERO_FLAG_TOWER or 0 */
    spari_rotor used;         /* in the last solve; rotor_used: it was given then */
    int rotor_used;
};

#endif
