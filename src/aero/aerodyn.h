/* A blade as AeroDyn's files describe it: stations and airfoils. */
#ifndef SPARI_AERODYN_H
#define SPARI_AERODYN_H

#include <spar/spar_aero.h>

/* What stands in a row of the blade file, and in which order. Angles in radians. */
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
    double *alpha, *cl, *cd, *cm; /* one block, which is alpha's */
} spari_airfoil;

typedef struct spari_blade {
    int stations, airfoils;
    double *row;            /* [stations][SPARI_BLADE_COLUMNS] */
    spari_airfoil *airfoil; /* [airfoils]; those that no station has are empty */
} spari_blade;

/* Reads the files; blade_path NULL: the primary file's first blade. polars 0: stations only. Messages go to the session
   (NULL: the thread) and begin with call and subject. blade is to be freed in any case. */
int spari_blade_read(spari_blade *blade, const spar_session *session, const char *call, const char *subject,
                     const char *primary_path, const char *blade_path, int polars);
void spari_blade_free(spari_blade *blade);

#endif
