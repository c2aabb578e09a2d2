/* A blade as in AeroDyn's files: stations and airfoils. */
#ifndef SPARI_AERODYN_H
#define SPARI_AERODYN_H

#include <spar/spar_aero.h>

/* Columns of the blade file, in order. Angles in radians. */
enum {
    SPARI_BLADE_SPAN,
    SPARI_BLADE_CURVE,
    SPARI_BLADE_SWEEP,
    SPARI_BLADE_CURVE_ANGLE,
    SPARI_BLADE_TWIST,
    SPARI_BLADE_CHORD,
    SPARI_BLADE_AIRFOIL,
    SPARI_BLADE_COLUMNS
};

typedef struct spari_airfoil {
    int64_t n;
    int kind;                     /* SPAR_POLAR_LINEAR, _CUBIC */
    double *alpha, *cl, *cd, *cm; /* one memory block, owned through alpha */
} spari_airfoil;

typedef struct spari_blade {
    int stations, airfoils;
    double *row;            /* [stations][SPARI_BLADE_COLUMNS] */
    spari_airfoil *airfoil; /* [airfoils]; unused ones are empty */
} spari_blade;

int spari_airfoil_polar(const spari_airfoil *a, spar_polar **polar);
/* c: a + t (b - a) at every angle of either, as a new table. Returns 1 if there is no memory. */
int spari_airfoil_blend(const spari_airfoil *a, const spari_airfoil *b, double t, spari_airfoil *c);
/* Reads the files.
   blade: to be freed in any case
   session, call, subject: of the messages, which begin with call and subject; session NULL: the thread's message
   blade_path: NULL: the first blade of the primary file
   polars: 0: stations only */
int spari_blade_read(spari_blade *blade, const spar_session *session, const char *call, const char *subject,
                     const char *primary_path, const char *blade_path, int polars);
void spari_blade_free(spari_blade *blade);

#endif
