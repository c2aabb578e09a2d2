/* spar_aero.h: blade element with momentum theory, the fluid that comes with the library. */
#ifndef SPAR_AERO_H
#define SPAR_AERO_H

#include <spar/spar.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct spar_polar spar_polar;
typedef struct spar_aero spar_aero;

enum {
    SPAR_AERO_INDUCTION = 1,
    SPAR_AERO_TIP_LOSS = 2,
    SPAR_AERO_HUB_LOSS = 4,
    SPAR_AERO_SWIRL = 8,
    SPAR_AERO_DRAG = 16,
    SPAR_AERO_MOMENT = 32
};

SPAR_API int spar_polar_create(int64_t n, const double *alpha_rad, const double *cl, const double *cd, const double *cm, spar_polar **polar);
SPAR_API void spar_polar_destroy(spar_polar **polar);
SPAR_API void spar_aero_destroy(spar_aero **aero);
SPAR_API int spar_aero_create(int blades, spar_fluid *const *sections, spar_aero **aero); /* fluids made with set_sections, one per blade */
SPAR_API int spar_aero_set_section(spar_aero *aero, int64_t i, double chord, double twist, const spar_polar *polar); /* same for every blade; twist rad, the spec's tau:
     positive turns the leading edge into the wind and lowers the angle of attack, i.e. minus a right-handed turn about the section's x */
SPAR_API int spar_aero_set_rotor(spar_aero *aero, const double hub[3], const double axis[3], double hub_radius, double tip_radius); /* axis: shaft, pointing downwind */
SPAR_API int spar_aero_set_effects(spar_aero *aero, int effects); /* SPAR_AERO_INDUCTION, _TIP_LOSS, _HUB_LOSS, _SWIRL, _DRAG, _MOMENT */
SPAR_API int spar_aero_solve(spar_aero *aero, double density, const double *inflow, double theta); /* wind at all sections [blades][n][3]; pulls motion, pushes forces */
SPAR_API int spar_aero_get_rotor(const spar_aero *aero, double *thrust, double *torque, double *power);
SPAR_API int spar_aero_get_sections(const spar_aero *aero, double *alpha, double *cl, double *cd, double *a, double *a_tangential); /* [blades][n], any NULL */

#ifdef __cplusplus
}
#endif

#endif
