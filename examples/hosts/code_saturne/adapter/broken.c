/* What is told when a flow breaks: the fields and the mesh at that moment. */
#include "cs_base.h"
#include "cs_headers.h"
#include "spar_saturne.h"
#include <math.h>

void saturne_flow_broke(const char *why) {
    const cs_mesh_quantities_t *q = cs_glob_mesh_quantities;
    const double *u = CS_F_(vel)->val;
    double most = 0, none = 0, where[3] = {0};
    for (cs_lnum_t cell = 0; cell < cs_glob_mesh->n_cells; cell++) {
        const double speed = cs_math_3_norm(u + 3 * cell);
        none += isfinite(speed) ? 0 : 1;
        if (isfinite(speed) && speed > most) {
            most = speed;
            for (int c = 0; c < 3; c++) {
                where[c] = q->cell_cen[3 * cell + c];
            }
        }
    }
    cs_parall_max_loc_vals(3, &most, where);
    cs_parall_sum(1, CS_DOUBLE, &none);
    bft_error(
        __FILE__, __LINE__, 0,
        "spar: %s. The flow or its mesh has broken: the largest speed is %.3g m/s at (%.4g %.4g %.4g), %.0f cells "
        "have no number, the least cell has %.3g m3. Take a smaller dt, or give the mesh more room (fade)",
        why, most, where[0], where[1], where[2], none, q->min_vol);
}
