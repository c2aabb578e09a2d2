/* code_saturne's user routines of a mesh that moves with spar, from the case file. */
#include "cs_ale.h"
#include "cs_base.h"
#include "cs_headers.h"
#include "cs_prototypes.h"
#include "spar_saturne.h"
#if SATURNE_VERSION >= 80
#include "cs_mobile_structures.h"

extern int cs_glob_ast_coupling_n_couplings;
#endif

void cs_user_model(void) {
    cs_get_glob_turb_model()->iturb = CS_TURB_NONE;
    cs_glob_ale = CS_ALE_LEGACY;
#if SATURNE_VERSION >= 80
    /* limits.f90 of earlier versions: the sub-iterations of a step are out of spar's way; one external structure. The
       list of all structures is there only if code_saturne has one of its own. */
    cs_glob_mobile_structures_i_max = 60;
    cs_glob_ale_n_ini_f = 0;
    cs_glob_ast_coupling_n_couplings = 1;
    if (cs_mobile_structures_get_n_structures() == 0) {
        cs_mobile_structures_add_n_structures(1);
    }
#endif
}

/* The mesh's conditions: 1 fixed, 2 sliding; follows: a vertex whose displacement is given. */
static void set_conditions(int *types, int *follows) {
    saturne_mark("fixed", saturne_text("fixed", ""), 1, types);
    saturne_mark("sliding", saturne_text("sliding", ""), 2, types);
    if (*saturne_text("fade", "") != '\0') {
        for (cs_lnum_t v = 0; v < cs_glob_mesh->n_vertices; v++) {
            follows[v] = 1;
        }
    }
}

#if SATURNE_VERSION < 80

void CS_PROCF(usalcl, USALCL)(const int *itrale, const int *nvar, const int *nscal, int *icodcl, int *itypfb,
                              int *ialtyb, int *impale, const cs_real_t *dt, cs_real_t *rcodcl, const cs_real_t *xyzno0,
                              cs_real_t *disale) {
    (void)itrale, (void)nvar, (void)nscal, (void)icodcl, (void)itypfb, (void)dt, (void)rcodcl, (void)disale;
    saturne_set_reference(xyzno0);
    set_conditions(ialtyb, impale);
}

/* Wetted faces belong to an external structure: -1. */
void CS_PROCF(usaste, USASTE)(int *idfstr) {
    saturne_bodies_select(-1, idfstr);
}

#else

void cs_user_boundary_conditions_ale(cs_domain_t *domain, int bc_type[], int ale_bc_type[], int impale[]) {
    (void)domain, (void)bc_type;
    set_conditions(ale_bc_type, impale);
    saturne_bodies_follow(impale);
}

/* 8.0 counts the faces of external structures wrongly (one for each structure) and then writes beyond the array of
   their forces. The adapter takes the forces itself and says which vertices follow, so none is marked. */
void cs_user_fsi_structure_num(cs_domain_t *domain, int structure_num[]) {
    int *types;
    (void)domain, (void)structure_num;
    BFT_MALLOC(types, cs_glob_mesh->n_b_faces, int);
    saturne_bodies_select(-1, types);
    BFT_FREE(types);
}

/* The structure of code_saturne's own that cs_user_model makes, without a face: it rests. */
void cs_user_fsi_structure_values(int n_structs, const cs_time_step_t *ts, const cs_real_t xstreq[][3],
                                  const cs_real_t xstr[][3], const cs_real_t vstr[][3], cs_real_t xmstru[][3][3],
                                  cs_real_t xcstru[][3][3], cs_real_t xkstru[][3][3], cs_real_t forstr[][3],
                                  cs_real_t dtstr[]) {
    (void)ts, (void)xstreq, (void)xstr, (void)vstr, (void)xcstru, (void)forstr, (void)dtstr;
    for (int i = 0; i < n_structs; i++) {
        for (int c = 0; c < 3; c++) {
            xmstru[i][c][c] = xkstru[i][c][c] = 1;
        }
    }
}

#endif
