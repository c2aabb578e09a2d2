/* The wind around the rotor: air, uniform at the inlet and at the start, no turbulence model. */
#include "cs_base.h"
#include "cs_headers.h"
#include "cs_prototypes.h"
#include "spar_saturne.h"

void cs_user_model(void) {
    cs_get_glob_turb_model()->iturb = CS_TURB_NONE;
}

void cs_user_parameters(cs_domain_t *domain) {
    cs_fluid_properties_t *fluid = cs_get_glob_fluid_properties();
    saturne_steps(domain);
    fluid->ro0 = 1.225, fluid->viscl0 = 1.8e-5, fluid->p0 = 0;
}

void cs_user_initialization(cs_domain_t *domain) {
    cs_real_3_t *u = (cs_real_3_t *)CS_F_(vel)->val;
    const double wind = saturne_number("wind", NULL);
    (void)domain;
    if (cs_glob_time_step->nt_prev > 0) {
        return;
    }
    for (cs_lnum_t cell = 0; cell < cs_glob_mesh->n_cells; cell++) {
        u[cell][0] = wind, u[cell][1] = u[cell][2] = 0;
    }
}

void cs_user_boundary_conditions(SATURNE_CONDITIONS(bc_type)) {
    const cs_lnum_t faces = cs_glob_mesh->n_b_faces;
    const double wind = saturne_number("wind", NULL);
    SATURNE_UNUSED_CONDITIONS;
    saturne_mark("rotor flow", "1", CS_INLET, bc_type);
    saturne_mark("rotor flow", "2", CS_OUTLET, bc_type);
    saturne_mark("rotor flow", "3", CS_SYMMETRY, bc_type);
    for (cs_lnum_t face = 0; face < faces; face++) {
        if (bc_type[face] == CS_INLET) {
            SATURNE_VELOCITY_AT(face, 0) = wind;
            SATURNE_VELOCITY_AT(face, 1) = SATURNE_VELOCITY_AT(face, 2) = 0;
        }
    }
}
