/* The fluid's forces on boundary faces from the present pressure and velocity, by the boundary conditions' own
   coefficients: the pressure at a face is a + b p(I'), the viscous traction af + bf u(I'), where I' is the foot of the
   cell's centre on the face's normal, to which gradients lead. */
#include "cs_base.h"
#include "cs_field_operator.h"
#include "cs_headers.h"
#include "spar_saturne.h"

static void face_force(cs_lnum_t face, const cs_real_3_t *grad_p, const cs_real_33_t *grad_u, double force[3]) {
    const cs_mesh_quantities_t *q = cs_glob_mesh_quantities;
    const cs_field_bc_coeffs_t *bp = CS_F_(p)->bc_coeffs, *bu = CS_F_(vel)->bc_coeffs;
    cs_lnum_t cell = cs_glob_mesh->b_face_cells[face];
    const double *to_foot = q->diipb + 3 * face, *normal = q->b_face_normal + 3 * face;
    double p = CS_F_(p)->val[cell], u[3];
    for (int i = 0; i < 3; i++) {
        p += to_foot[i] * grad_p[cell][i];
        u[i] = CS_F_(vel)->val[3 * cell + i];
        for (int j = 0; j < 3; j++) {
            u[i] += to_foot[j] * grad_u[cell][i][j];
        }
    }
    p = bp->a[face] + bp->b[face] * p;
    for (int i = 0; i < 3; i++) {
        double traction = bu->af[3 * face + i];
        for (int j = 0; j < 3; j++) {
            traction += bu->bf[9 * face + 3 * i + j] * u[j];
        }
        force[i] = p * normal[i] + traction * q->b_face_surf[face];
    }
}

void saturne_wall_forces(cs_lnum_t n, const cs_lnum_t *faces, double *force) {
    cs_lnum_t cells = cs_glob_mesh->n_cells_with_ghosts;
    cs_real_3_t *grad_p;
    cs_real_33_t *grad_u;
    BFT_MALLOC(grad_p, cells, cs_real_3_t);
    BFT_MALLOC(grad_u, cells, cs_real_33_t);
#if SATURNE_VERSION < 80
    cs_field_gradient_potential(CS_F_(p), false, 1, true, 0, NULL, grad_p);
#else
    cs_field_gradient_potential(CS_F_(p), false, 1, 0, NULL, grad_p);
#endif
    cs_field_gradient_vector(CS_F_(vel), false, 1, grad_u);
    for (cs_lnum_t i = 0; i < n; i++) {
        face_force(faces[i], (const cs_real_3_t *)grad_p, (const cs_real_33_t *)grad_u, force + 3 * i);
    }
    BFT_FREE(grad_p);
    BFT_FREE(grad_u);
}
