/* The wind that a section meets: the inflow as it changes with height, and past the tower. Knows no fluid and no
   session. */
#ifndef SPARI_WIND_H
#define SPARI_WIND_H

typedef struct spari_shear {
    int law; /* SPAR_SHEAR_* */
    double ground[3], up[3], height, parameter;
} spari_shear;

typedef struct spari_tower {
    double top[3], up[3]; /* up: from base to top, of length 1 */
    double length, base_radius, top_radius;
} spari_tower;

/* What of it there is; a law or tower that was not described is not looked at. */
typedef struct spari_wind {
    int has_shear, has_tower;
    spari_shear shear;
    spari_tower tower;
} spari_wind;

/* What the inflow is times at a height above the ground. */
double spari_shear_factor(const spari_shear *shear, double z);
/* Wind at x by the effects (SPAR_AERO_SHEAR, _TOWER) of what there is. Returns SPAR_AERO_FLAG_TOWER or 0. */
int spari_wind_meet(const spari_wind *wind, int effects, const double x[3], const double inflow[3], double met[3]);

#endif
