/* Points of lines and the cells of the mesh. */
#include "line.h"
#include "cs_base.h"
#include "cs_headers.h"
#include <math.h>
#include <string.h>

/* The kernel times the cell's volume; beyond four widths it is 1e-7 and left out. */
static double share(double width, const double *x, cs_lnum_t cell) {
    const cs_real_t *centre = cs_glob_mesh_quantities->cell_cen + 3 * cell;
    const double a = x[0] - centre[0], b = x[1] - centre[1], c = x[2] - centre[2];
    const double r2 = (a * a + b * b + c * c) / (width * width);
    return r2 > 16 ? 0 : exp(-r2) * cs_glob_mesh_quantities->cell_vol[cell];
}

void line_sample(double width, int n, const double *x, double *weight, double *u) {
    const cs_real_3_t *flow = (const cs_real_3_t *)CS_F_(vel)->val;
    memset(weight, 0, (size_t)n * sizeof *weight);
    memset(u, 0, (size_t)(3 * n) * sizeof *u);
    for (cs_lnum_t cell = 0; cell < cs_glob_mesh->n_cells; cell++) {
        for (int i = 0; i < n; i++) {
            const double part = share(width, x + 3 * i, cell);
            weight[i] += part;
            for (int k = 0; k < 3; k++) {
                u[3 * i + k] += part * flow[cell][k];
            }
        }
    }
    cs_parall_sum(n, CS_DOUBLE, weight);
    cs_parall_sum(3 * n, CS_DOUBLE, u);
    for (int i = 0; i < 3 * n; i++) {
        u[i] /= weight[i / 3];
    }
}

void line_spread(double width, int n, const double *x, const double *weight, const double *force, cs_real_3_t *source) {
    for (cs_lnum_t cell = 0; cell < cs_glob_mesh->n_cells; cell++) {
        for (int i = 0; i < n; i++) {
            const double part = share(width, x + 3 * i, cell) / weight[i];
            for (int k = 0; k < 3; k++) {
                source[cell][k] -= part * force[3 * i + k];
            }
        }
    }
}
