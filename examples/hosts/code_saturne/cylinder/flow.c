/* The stream around the cylinder at Re 150: code_saturne's user routines. */
#include "cs_ale.h"
#include "cs_base.h"
#include "cs_headers.h"
#include "cs_prototypes.h"
#include "cs_selector.h"
#include "spar_saturne.h"
#include <math.h>

/* The faces' groups: gmsh's numbers, for code_saturne 6.0 reads no names; the cylinder is 4. */
#define INLET "1"
#define OUTLET "2"
#define SIDES "3"
#define FRONT_BACK "5"

static const double speed = 1, viscosity = 1. / 150;

void cs_user_model(void) {
    cs_get_glob_turb_model()->iturb = CS_TURB_NONE;
    cs_glob_ale = CS_ALE_LEGACY;
}

void cs_user_parameters(cs_domain_t *domain) {
    cs_var_cal_opt_t scheme;
    cs_fluid_properties_t *fluid = cs_get_glob_fluid_properties();
    cs_get_glob_time_step_options()->idtvar = 0;
    domain->time_step->dt_ref = saturne_number("DT", 0.025);
    domain->time_step->nt_max = (int)saturne_number("STEPS", 40);
    fluid->ro0 = 1, fluid->viscl0 = viscosity, fluid->p0 = 0;
    cs_field_get_key_struct(CS_F_(vel), cs_field_key_id("var_cal_opt"), &scheme);
    scheme.blencv = 1, scheme.ischcv = 1, scheme.isstpc = 1; /* centred, no slope test */
    cs_field_set_key_struct(CS_F_(vel), cs_field_key_id("var_cal_opt"), &scheme);
}

/* The mesh is stiff near the cylinder, where its cells are small. */
void cs_user_initialization(cs_domain_t *domain) {
    cs_real_3_t *u = (cs_real_3_t *)CS_F_(vel)->val;
    cs_field_t *stiffness = cs_field_by_name("mesh_viscosity");
    (void)domain;
    for (cs_lnum_t cell = 0; cell < cs_glob_mesh->n_cells; cell++) {
        const cs_real_t *x = cs_glob_mesh_quantities->cell_cen + 3 * cell;
        u[cell][0] = speed, u[cell][1] = u[cell][2] = 0;
        for (int i = 0; i < stiffness->dim; i++) {
            stiffness->val[stiffness->dim * cell + i] = CS_MAX(1e-3, pow(hypot(x[0], x[1]), -3));
        }
    }
}

static void mark(const char *criterion, int type, int types[]) {
    cs_lnum_t n, *faces;
    BFT_MALLOC(faces, cs_glob_mesh->n_b_faces, cs_lnum_t);
    cs_selector_get_b_face_list(criterion, &n, faces);
    for (cs_lnum_t i = 0; i < n; i++) {
        types[faces[i]] = type;
    }
    BFT_FREE(faces);
}

void cs_user_boundary_conditions(int nvar, int bc_type[], int icodcl[], cs_real_t rcodcl[]) {
    const int iu = cs_field_get_key_int(CS_F_(vel), cs_field_key_id("variable_id")) - 1;
    const cs_lnum_t faces = cs_glob_mesh->n_b_faces;
    (void)nvar, (void)icodcl;
    mark(INLET, CS_INLET, bc_type);
    mark(OUTLET, CS_OUTLET, bc_type);
    mark(SIDES " or " FRONT_BACK, CS_SYMMETRY, bc_type);
    mark(saturne_this_case.wetted, CS_SMOOTHWALL, bc_type);
    for (cs_lnum_t face = 0; face < faces; face++) {
        if (bc_type[face] == CS_INLET) {
            rcodcl[iu * faces + face] = speed;
            rcodcl[(iu + 1) * faces + face] = rcodcl[(iu + 2) * faces + face] = 0;
        }
    }
}

/* The mesh's conditions: 1 fixed, 2 sliding. Of the cylinder's vertices the adapter gives the displacement. */
void CS_PROCF(usalcl, USALCL)(const int *itrale, const int *nvar, const int *nscal, int *icodcl, int *itypfb,
                              int *ialtyb, int *impale, const cs_real_t *dt, cs_real_t *rcodcl, const cs_real_t *xyzno0,
                              cs_real_t *disale) {
    (void)itrale, (void)nvar, (void)nscal, (void)icodcl, (void)itypfb, (void)impale, (void)dt, (void)rcodcl;
    (void)xyzno0, (void)disale;
    mark(INLET " or " OUTLET " or " SIDES, 1, ialtyb);
    mark(FRONT_BACK, 2, ialtyb);
}

/* Wetted faces belong to an external structure: -1. */
void CS_PROCF(usaste, USASTE)(int *idfstr) {
    mark(saturne_this_case.wetted, -1, idfstr);
}

/* Without an XML file the library's own version of this one stops the run. */
void CS_PROCF(cs_f_user_boundary_conditions, CS_F_USER_BOUNDARY_CONDITIONS)(void) {
}
