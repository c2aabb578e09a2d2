/* The stream around the cylinder: D = 1 m, 1 m/s, Re 150, at full speed from the start. */
#include "cs_base.h"
#include "cs_headers.h"
#include "cs_prototypes.h"
#include "cs_restart_default.h"
#include "spar_saturne.h"
#include <math.h>

static const double speed = 1, viscosity = 1. / 150;

void cs_user_parameters(cs_domain_t *domain) {
    cs_fluid_properties_t *fluid = cs_get_glob_fluid_properties();
    saturne_steps(domain);
    fluid->ro0 = 1, fluid->viscl0 = viscosity, fluid->p0 = 0;
    saturne_centre();
}

/* The mesh, where code_saturne moves it, is stiff near the cylinder, where its cells are small at the start. A run that
   goes on has that from the checkpoint. */
void cs_user_finalize_setup(cs_domain_t *domain) {
    (void)domain;
    cs_field_set_key_int(cs_field_by_name("mesh_viscosity"), cs_field_key_id("restart_file"), CS_RESTART_AUXILIARY);
}

void cs_user_initialization(cs_domain_t *domain) {
    cs_real_3_t *u = (cs_real_3_t *)CS_F_(vel)->val;
    cs_field_t *stiffness = cs_field_by_name("mesh_viscosity");
    (void)domain;
    if (cs_glob_time_step->nt_prev > 0) {
        return;
    }
    for (cs_lnum_t cell = 0; cell < cs_glob_mesh->n_cells; cell++) {
        const cs_real_t *x = cs_glob_mesh_quantities->cell_cen + 3 * cell;
        u[cell][0] = speed, u[cell][1] = u[cell][2] = 0;
        for (int i = 0; i < stiffness->dim; i++) {
            stiffness->val[stiffness->dim * cell + i] = CS_MAX(1e-3, pow(hypot(x[0], x[1]), -3));
        }
    }
}

void cs_user_boundary_conditions(SATURNE_CONDITIONS(bc_type)) {
    const cs_lnum_t faces = cs_glob_mesh->n_b_faces;
    SATURNE_UNUSED_CONDITIONS;
    saturne_mark("cylinder flow", "1", CS_INLET, bc_type);
    saturne_mark("cylinder flow", "2", CS_OUTLET, bc_type);
    saturne_mark("cylinder flow", "3 or 5", CS_SYMMETRY, bc_type);
    saturne_mark("cylinder flow", "4", CS_SMOOTHWALL, bc_type);
    for (cs_lnum_t face = 0; face < faces; face++) {
        if (bc_type[face] == CS_INLET) {
            SATURNE_VELOCITY_AT(face, 0) = speed;
            SATURNE_VELOCITY_AT(face, 1) = SATURNE_VELOCITY_AT(face, 2) = 0;
        }
    }
}
