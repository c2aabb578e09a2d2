/* Wind at a section: inflow with shear and tower influence. Independent of fluid and session. */
#ifndef SPARI_WIND_H
#define SPARI_WIND_H

typedef struct spari_shear {
    int law; /* SPAR_SHEAR_* */
    double ground[3], up[3], height, parameter;
} spari_shear;

typedef struct spari_tower {
    double top[3], up[3]; /* upwards, from base to top, unit length */
    double length, base_radius, top_radius;
} spari_tower;

/* Shear and tower; those that are not described are not read. */
typedef struct spari_wind {
    int has_shear, has_tower;
    spari_shear shear;
    spari_tower tower;
} spari_wind;

/* Factor of the inflow at a height above the ground. */
double spari_shear_factor(const spari_shear *shear, double z);
/* Wind at x with the effects (SPAR_AERO_SHEAR, _TOWER). Returns SPAR_AERO_FLAG_TOWER or 0. */
int spari_wind_meet(const spari_wind *wind, int effects, const double x[3], const double inflow[3], double met[3]);

#endif
