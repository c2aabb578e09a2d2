/* A wide stream past a hub with three blades: density 1 kg/m3, viscosity 0.01 Pa s, 1 m/s at the inlet, which comes on
   smoothly within 0.5 s. */
#include "cs_base.h"
#include "cs_headers.h"
#include "cs_prototypes.h"
#include "spar_saturne.h"

void cs_user_parameters(cs_domain_t *domain) {
    cs_fluid_properties_t *fluid = cs_get_glob_fluid_properties();
    saturne_steps(domain);
    fluid->ro0 = 1, fluid->viscl0 = 0.01, fluid->p0 = 0;
    saturne_centre();
}

void cs_user_boundary_conditions(SATURNE_CONDITIONS(bc_type)) {
    const cs_lnum_t faces = cs_glob_mesh->n_b_faces;
    const double ramp = saturne_ramp(cs_glob_time_step->t_cur, 0.5);
    SATURNE_UNUSED_CONDITIONS;
    saturne_mark("hub flow", "1", CS_INLET, bc_type);
    saturne_mark("hub flow", "2", CS_OUTLET, bc_type);
    saturne_mark("hub flow", "3 or 5", CS_SYMMETRY, bc_type);
    saturne_mark("hub flow", "4 or 6 or 7 or 8", CS_SMOOTHWALL, bc_type);
    for (cs_lnum_t face = 0; face < faces; face++) {
        if (bc_type[face] == CS_INLET) {
            SATURNE_VELOCITY_AT(face, 0) = ramp;
            SATURNE_VELOCITY_AT(face, 1) = SATURNE_VELOCITY_AT(face, 2) = 0;
        }
    }
}
