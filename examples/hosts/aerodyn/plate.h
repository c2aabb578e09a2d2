/* The plate of the stand-in: its chord, and coefficients that are linear between a few angles of attack, so that spar's
   own blade elements can have the very same. */
#ifndef PLATE_H
#define PLATE_H

#include <math.h>

#ifdef __cplusplus
extern "C" {
#endif

static const double plate_chord = 3, plate_cm = -0.05; /* m */

/* Rows of a polar: angle (rad), lift, drag, moment. */
enum { PLATE_ROWS = 5 };
static const double plate_alpha[PLATE_ROWS] = {-3.14159265358979323846, -0.3, 0, 0.3, 3.14159265358979323846},
                    plate_cl[PLATE_ROWS] = {0, -1.5, 0, 1.5, 0}, plate_cd[PLATE_ROWS] = {0.9, 0.1, 0.01, 0.1, 0.9},
                    plate_cms[PLATE_ROWS] = {-0.05, -0.05, -0.05, -0.05, -0.05};

static inline void plate_coefficients(double alpha, double *cl, double *cd) {
    int i = 1;
    while (i + 1 < PLATE_ROWS && alpha > plate_alpha[i]) {
        i++;
    }
    const double t = (alpha - plate_alpha[i - 1]) / (plate_alpha[i] - plate_alpha[i - 1]);
    *cl = plate_cl[i - 1] + t * (plate_cl[i] - plate_cl[i - 1]);
    *cd = plate_cd[i - 1] + t * (plate_cd[i] - plate_cd[i - 1]);
}

#ifdef __cplusplus
}
#endif

#endif
