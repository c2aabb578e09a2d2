/* What differs between versions of code_saturne. SATURNE_VERSION: 60, 70, 80, ... for 6.0, 7.0, 8.0, given by the run
   script. 6.0 is run; 7.0 and 8.0 are compiled against their headers. */
#ifndef SPAR_SATURNE_VERSIONS_H
#define SPAR_SATURNE_VERSIONS_H

#include "cs_defs.h"
#include "cs_field.h"
#include "cs_mesh.h"

#ifndef SATURNE_VERSION
#define SATURNE_VERSION 60
#endif

#if SATURNE_VERSION < 70
#define SATURNE_DISPLACEMENT "disale"
#else
#define SATURNE_DISPLACEMENT "mesh_displacement"
#endif

#if SATURNE_VERSION < 80
/* The arguments of cs_user_boundary_conditions, and the value of component c of the velocity at a face. */
#define SATURNE_CONDITIONS(types) int nvar, int types[], int icodcl[], cs_real_t rcodcl[]
#define SATURNE_UNUSED_CONDITIONS (void)nvar, (void)icodcl
#define SATURNE_VELOCITY_AT(face, c)                                                                                   \
    rcodcl[(cs_field_get_key_int(CS_F_(vel), cs_field_key_id("variable_id")) - 1 + (c)) * cs_glob_mesh->n_b_faces +    \
           (face)]
#else
#define SATURNE_CONDITIONS(types) cs_domain_t *domain, int types[]
#define SATURNE_UNUSED_CONDITIONS (void)domain
#define SATURNE_VELOCITY_AT(face, c) CS_F_(vel)->bc_coeffs->rcodcl1[(c)*cs_glob_mesh->n_b_faces + (face)]
#endif

#endif
