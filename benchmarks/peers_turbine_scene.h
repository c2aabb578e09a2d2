/* The turbine of peers_turbine.c, which peers_kynema_turbine.cpp builds too: a tower, the nacelle as a mass at its top,
   a hub on a driven shaft, three blades on driven pitch bearings. Uniform undamped beams, SI units, z up, the shaft
   along x. */
#ifndef PEERS_TURBINE_SCENE_H
#define PEERS_TURBINE_SCENE_H

#include <math.h>

enum { TOWER_NODES = 6, BLADE_NODES = 10, BLADE_COUNT = 3 };

static const double tower_height = 80, hub_at[3] = {-5, 0, 82}, hub_radius = 1.5, blade_length = 60;
static const double growth_time = 2;                             /* s, in which speed, pitch and gravity grow */
static const double full_speed = 1.2, full_pitch = 0.1;          /* rad/s, rad */
static const double full_gravity = 9.80665, radius_at_inf = 0.9; /* m/s^2; spectral radius at infinite frequency */

/* Diagonals: axial, shear y, shear z, torsion, bending y, bending z. */
static const double tower_stiffness[6] = {1e11, 2e10, 2e10, 3.8e11, 5e11, 5e11};
static const double tower_mass[6] = {4500, 4500, 4500, 4.4e4, 2.2e4, 2.2e4};
static const double blade_stiffness[6] = {4e9, 1e9, 1e9, 2e8, 2e9, 5e9};
static const double blade_mass[6] = {290, 290, 290, 400, 120, 280};
static const double nacelle_mass[6] = {2.4e5, 2.4e5, 2.4e5, 2.6e6, 2.6e6, 2e6}; /* in the tower's section axes */
static const double hub_mass[6] = {5.7e4, 5.7e4, 5.7e4, 1.2e5, 1e5, 1e5};

/* The part that speed, pitch and gravity have reached, its rate, and its integral. */
static inline double part_at(double t) {
    double s = sin(0.5 * 3.14159265358979323846 * t / growth_time);
    return t < growth_time ? s * s : 1;
}
static inline double rate_at(double t) {
    const double w = 3.14159265358979323846 / growth_time;
    return t < growth_time ? 0.5 * w * sin(w * t) : 0;
}
static inline double curve_at(double t) {
    const double w = 3.14159265358979323846 / growth_time;
    return t < growth_time ? 0.5 * w * w * cos(w * t) : 0;
}
static inline double integral_at(double t) {
    const double w = 3.14159265358979323846 / growth_time;
    return t < growth_time ? 0.5 * t - 0.5 * sin(w * t) / w : t - 0.5 * growth_time;
}

/* From the blade's own axes, x along it from the hub, to its reference position; along: where it points. */
static inline void blade_at(int k, double x[3], double q[4], double along[3]) {
    const double angle = 2 * 3.14159265358979323846 / (int)BLADE_COUNT * k, c = cos(0.5 * angle), s = sin(0.5 * angle),
                 r = sqrt(0.5);
    along[0] = 0, along[1] = -sin(angle), along[2] = cos(angle);
    q[0] = c * r, q[1] = s * r, q[2] = -c * r, q[3] = -s * r; /* x to z by -90 degrees about y, then about x */
    for (int i = 0; i < 3; i++) {
        x[i] = hub_at[i] + hub_radius * along[i];
    }
}

#endif
