/* Warns about elements with too few nodes for their stiffness (membrane and shear locking). A bent element with few
   nodes cannot keep its length, or its sections perpendicular to its line, and becomes as stiff as its axial and
   shear stiffness. Checked once, at commit. The limits are those at which a cantilever of one element deflects 10 %
   too little (tests/member/test_beam.c). */
#include "beam.h"

#include "../base/session.h"
#include "../math/rotation.h"

#include <math.h>

enum { ENOUGH = 5 }; /* nodes: the remaining error is below 1.3 % */

/* Largest (axial or shear stiffness) h^2 / (bending stiffness) for elements of P nodes; bent: in their reference, or
   by loads. */
static double bearable(int P, int bent) {
    switch (P) {
    case 2:
        return 1;
    case 3:
        return 30;
    default:
        return P < ENOUGH && bent ? 1e3 : INFINITY;
    }
}

/* Largest ratio of the elements, and of the member with its whole length; *element: the element. */
static double largest_ratio(const spar_member *m, double *whole, int *element) {
    double most = 0, length = 0, section = 0;
    for (int e = 0; e < m->mesh.elements; e++) {
        double h = 0, ratio = 0;
        for (int i = 1; i < m->mesh.per_element; i++) {
            const double *x = m->xr + 3 * ((int64_t)e * m->mesh.per_element + i);
            const double d[3] = {x[0] - x[-3], x[1] - x[-2], x[2] - x[-1]};
            h += spari_norm(d);
        }
        for (int k = 0; k < 3; k++) {
            double C[36];
            spari_beam_section_at(m->beam, m->beam->stiffness, (e + 0.5 * k) / m->mesh.elements, C);
            ratio = fmax(ratio, fmax(C[0], fmax(C[7], C[14])) / fmin(C[28], C[35])); /* per length squared */
        }
        length += h, section = fmax(section, ratio);
        *element = ratio * h * h > most ? e : *element;
        most = fmax(most, ratio * h * h);
    }
    *whole = section * length * length;
    return most;
}

/* Whether an element is bent in its reference by more than 0.01 rad between nodes. */
static int is_bent(const spar_member *m) {
    const double x[3] = {1, 0, 0};
    double before[3], after[3], turn[3];
    for (int64_t i = 1; i < m->nodes; i++) {
        spari_rotate(m->qr + 4 * (i - 1), x, before);
        spari_rotate(m->qr + 4 * i, x, after);
        spari_cross(before, after, turn);
        if (i % m->mesh.per_element != 0 && spari_norm(turn) > 0.01) {
            return 1;
        }
    }
    return 0;
}

void spari_beam_tell_locking(const spar_member *m) {
    static const double rounding = 1e15; /* beyond this, bending is below the rounding error of the other stiffnesses */
    double whole = 0;
    int element = 0, exact = m->frame != SPARI_FRAME_LINEAR;
    const double ratio = largest_ratio(m, &whole, &element), most = bearable(m->mesh.per_element, exact || is_bent(m));
    if (ratio > most) {
        spari_warn(m->session,
                   "member '%s': element %d has %d nodes and locks: axial or shear stiffness is %.2g times its "
                   "bending stiffness / length^2, so its deflection is too small; use %d nodes per element, or "
                   "%.3g times as many elements",
                   m->name, element, m->mesh.per_element, ratio, ENOUGH, ceil(sqrt(ratio / most)));
    } else if (whole > rounding && m->beam->pretension.count == 0) {
        spari_warn(m->session,
                   "member '%s': axial or shear stiffness is %.2g times its bending stiffness / length^2: rounding "
                   "hides bending for any number of nodes; bring the stiffnesses closer together",
                   m->name, whole);
    }
}
