/* Turek and Hron's channel: water of viscosity 1e-3 m2/s and density 1000 kg/m3, a parabola of mean speed `speed` at
   the inlet, which comes on smoothly within 2 s. (Within 1 s the flag rings lengthwise, growing, while the water
   speeds up.) Who wants the limit cycle alone is there sooner with the key `shake V` in the case file: the speed of
   three swings across the stream at the inlet, of 0.2 s each, after that. */
#include "cs_base.h"
#include "cs_headers.h"
#include "cs_prototypes.h"
#include "spar_saturne.h"
#include <math.h>

void cs_user_parameters(cs_domain_t *domain) {
    cs_fluid_properties_t *fluid = cs_get_glob_fluid_properties();
    saturne_steps(domain);
    fluid->ro0 = 1000, fluid->viscl0 = 1, fluid->p0 = 0;
    saturne_centre();
}

static const double ramp_time = 2; /* s */

/* m/s across the stream at the height y and the time t */
static double shake(double y, double t) {
    const double none = 0, pi = acos(-1.), speed = saturne_number("shake", &none), since = t - ramp_time;
    return since > 0 && since < 0.6 ? speed * sin(pi * y / 0.41) * sin(2 * pi * since / 0.2) : 0;
}

/* m/s along it */
static double inflow(double y, double t) {
    const double height = 0.41, mean = saturne_number("speed", NULL), ramp = saturne_ramp(t, ramp_time);
    return ramp * 6 * mean * y * (height - y) / (height * height);
}

void cs_user_boundary_conditions(SATURNE_CONDITIONS(bc_type)) {
    const cs_lnum_t faces = cs_glob_mesh->n_b_faces;
    SATURNE_UNUSED_CONDITIONS;
    saturne_mark("flag flow", "1", CS_INLET, bc_type);
    saturne_mark("flag flow", "2", CS_OUTLET, bc_type);
    saturne_mark("flag flow", "5", CS_SYMMETRY, bc_type);
    saturne_mark("flag flow", "3 or 4 or 6", CS_SMOOTHWALL, bc_type);
    for (cs_lnum_t face = 0; face < faces; face++) {
        if (bc_type[face] == CS_INLET) {
            const double y = cs_glob_mesh_quantities->b_face_cog[3 * face + 1];
            SATURNE_VELOCITY_AT(face, 0) = inflow(y, cs_glob_time_step->t_cur);
            SATURNE_VELOCITY_AT(face, 1) = shake(y, cs_glob_time_step->t_cur);
            SATURNE_VELOCITY_AT(face, 2) = 0;
        }
    }
}
