/* code_saturne's user routines of a mesh that moves with spar, from the case file. */
#include "cs_ale.h"
#include "cs_base.h"
#include "cs_headers.h"
#include "cs_prototypes.h"
#include "spar_saturne.h"

void cs_user_model(void) {
    cs_get_glob_turb_model()->iturb = CS_TURB_NONE;
    cs_glob_ale = CS_ALE_LEGACY;
}

/* The mesh's conditions: 1 fixed, 2 sliding; impale: a vertex whose displacement is given. */
void CS_PROCF(usalcl, USALCL)(const int *itrale, const int *nvar, const int *nscal, int *icodcl, int *itypfb,
                              int *ialtyb, int *impale, const cs_real_t *dt, cs_real_t *rcodcl, const cs_real_t *xyzno0,
                              cs_real_t *disale) {
    (void)itrale, (void)nvar, (void)nscal, (void)icodcl, (void)itypfb, (void)dt, (void)rcodcl, (void)disale;
    saturne_set_reference(xyzno0);
    saturne_mark("fixed", saturne_text("fixed", ""), 1, ialtyb);
    saturne_mark("sliding", saturne_text("sliding", ""), 2, ialtyb);
    if (*saturne_text("fade", "") != '\0') {
        for (cs_lnum_t v = 0; v < cs_glob_mesh->n_vertices; v++) {
            impale[v] = 1;
        }
    }
}

/* Wetted faces belong to an external structure: -1. */
void CS_PROCF(usaste, USASTE)(int *idfstr) {
    saturne_bodies_select(-1, idfstr);
}
