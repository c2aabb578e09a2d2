/* The channel with two flaps: density 1 kg/m3, viscosity 0.01 Pa s, a parabola of mean speed 1 m/s at the inlet, which
   comes on smoothly within 0.5 s. Channel, flow and flaps are the same in the mirror y -> 2 - y. */
#include "cs_base.h"
#include "cs_headers.h"
#include "cs_prototypes.h"
#include "spar_saturne.h"

void cs_user_parameters(cs_domain_t *domain) {
    cs_fluid_properties_t *fluid = cs_get_glob_fluid_properties();
    saturne_steps(domain);
    fluid->ro0 = 1, fluid->viscl0 = 0.01, fluid->p0 = 0;
}

void cs_user_boundary_conditions(SATURNE_CONDITIONS(bc_type)) {
    const cs_lnum_t faces = cs_glob_mesh->n_b_faces;
    const double ramp = saturne_ramp(cs_glob_time_step->t_cur, 0.5);
    SATURNE_UNUSED_CONDITIONS;
    saturne_mark("flaps flow", "1", CS_INLET, bc_type);
    saturne_mark("flaps flow", "2", CS_OUTLET, bc_type);
    saturne_mark("flaps flow", "5", CS_SYMMETRY, bc_type);
    saturne_mark("flaps flow", "3 or 6 or 7 or 8", CS_SMOOTHWALL, bc_type);
    for (cs_lnum_t face = 0; face < faces; face++) {
        if (bc_type[face] == CS_INLET) {
            const double y = cs_glob_mesh_quantities->b_face_cog[3 * face + 1];
            SATURNE_VELOCITY_AT(face, 0) = 1.5 * ramp * y * (2 - y);
            SATURNE_VELOCITY_AT(face, 1) = SATURNE_VELOCITY_AT(face, 2) = 0;
        }
    }
}
