/* Geometric stiffness S of the axial forces that balance the inertia of a moving frame, and weight: equation (J1) in
   frame.h. At each point the force is that of everything beyond it, along the tangent of the line, in the reference.
   The deformation under these forces does not enter: it bends the member, and bending without its shortening, which is
   of second order, stretches it. */
#include "../algebra/cblas.h"
#include "../math/basis.h"
#include "../math/rotation.h"
#include "frame.h"

#include <stdlib.h>
#include <string.h>

/* Acceleration at the lever arm d of a mass m, times m, in a field of the frame (frame.h). d: m times the arm, and the
   first moment of the mass about it. */
static void acceleration_of(int field, double m, const double d[3], double a[3]) {
    const double unit[3] = {field % 3 == 0, field % 3 == 1, field % 3 == 2};
    if (field >= SPARI_TRANSLATIONS) {
        for (int c = 0; c < 3; c++) {
            a[c] = m * unit[c];
        }
    } else if (field >= SPARI_SPIN_PRODUCTS) {
        spari_cross(unit, d, a);
    } else {
        const int i = spari_frame_pair[field][0], j = spari_frame_pair[field][1];
        memset(a, 0, 3 * sizeof *a);
        if (i == j) { /* e_i x (e_i x d) */
            memcpy(a, d, 3 * sizeof *a);
            a[i] = 0;
            a[(i + 1) % 3] *= -1;
            a[(i + 2) % 3] *= -1;
        } else { /* e_i x (e_j x d) + e_j x (e_i x d) */
            a[i] = d[j];
            a[j] = d[i];
        }
    }
}

/* Inertia force at a point of element e, and the position of the point on the element. */
static double point_pull(const spari_body *b, const double *arms, int field, int e, int point, double force[3]) {
    const int P = b->per_element;
    const int64_t slot = b->slot[e] + point;
    const double *phi = b->phi + (int64_t)(b->first[e] + point) * P, *arm = arms + 3 * (int64_t)e * (P - 1);
    double x[SPARI_MAX_NODES], mass[10], d[3] = {0}, xi = 0;
    spari_gll(P, x, NULL, NULL);
    spari_slot_get(b->mass, 10, slot, mass);
    for (int l = 0; l < P; l++) {
        xi += phi[l] * x[l];
        for (int c = 0; c < 3; c++) {
            d[c] += phi[l] * arm[3 * l + c];
        }
    }
    for (int c = 0; c < 3; c++) {
        d[c] = mass[0] * d[c] + mass[1 + c];
    }
    acceleration_of(field, mass[0], d, force);
    for (int c = 0; c < 3; c++) {
        force[c] *= -b->weight[slot];
    }
    return xi;
}

/* Point masses are points without stiffness. */
static int is_point_mass(const spari_body *b, int64_t slot) {
    return *SPARI_BLOCK(b->C, 36, slot) == 0;
}

/* Puts the axial force of a field in element e into b->pre: at each point the forces on all that lies beyond it.
   beyond: the force beyond the end of the element; on return, beyond its beginning. */
static void element_tension(const spari_body *b, const double *arms, int field, int e, double beyond[3]) {
    const int P = b->per_element, points = b->first[e + 1] - b->first[e];
    double x[SPARI_MAX_NODES], share[SPARI_MAX_NODES], load[3 * SPARI_MAX_NODES] = {0}, force[3];
    spari_gll(P, x, NULL, NULL);
    for (int i = 0; i < points; i++) {
        const double *phi = b->phi + (int64_t)(b->first[e] + i) * P;
        (void)point_pull(b, arms, field, e, i, force);
        for (int l = 0; l < P && !is_point_mass(b, b->slot[e] + i); l++) {
            cblas_daxpy(3, phi[l], force, 1, load + 3 * l, 1);
        }
    }
    for (int i = 0; i < points && !is_point_mass(b, b->slot[e] + i); i++) { /* the point masses come last */
        double sum[3] = {beyond[0], beyond[1], beyond[2]}, pre[6] = {0}, t[3];
        const double xi = point_pull(b, arms, field, e, i, force);
        spari_share_beyond(P, x, xi, share);
        for (int l = 0; l < P; l++) {
            cblas_daxpy(3, share[l], load + 3 * l, 1, sum, 1);
        }
        for (int j = 0; j < points; j++) {
            if (is_point_mass(b, b->slot[e] + j) && point_pull(b, arms, field, e, j, force) > xi) {
                cblas_daxpy(3, 1, force, 1, sum, 1);
            }
        }
        spari_slot_get(b->tangent, 3, b->slot[e] + i, t);
        cblas_daxpy(3, spari_dot(t, sum), t, 1, pre, 1);
        spari_slot_put(b->pre, 6, b->slot[e] + i, pre);
    }
    for (int i = 0; i < points; i++) {
        (void)point_pull(b, arms, field, e, i, force);
        cblas_daxpy(3, 1, force, 1, beyond, 1);
    }
}

int spari_frame_add_stretch(const spari_body *body, const double *arm, const double *q, int from, int count,
                            double *const *X) {
    const double large = 0x1p60; /* as in spari_body_rates: the subtraction loses no digits */
    const int64_t mm = 36 * (int64_t)body->per_element * body->per_element;
    double *K = spari_zalloc(2 * mm, sizeof *K), *S = K + mm, beyond[SPARI_FIELDS][3] = {{0}};
    spari_body tense = *body;
    if (!K || spari_body_set_pre(&tense)) {
        free(K);
        return SPAR_ERR_MEMORY;
    }
    for (int e = tense.elements - 1; e >= 0; e--) {
        tense.pre_part = 0;
        spari_body_tangent(&tense, e, q, NULL, NULL, 0, 0, 0, NULL, K);
        tense.pre_part = large;
        for (int k = 0; k < count; k++) {
            element_tension(&tense, arm, from + k, e, beyond[k]);
            spari_body_tangent(&tense, e, q, NULL, NULL, 0, 0, 0, NULL, S);
            for (int64_t i = 0; i < mm; i++) {
                X[k][mm * e + i] += (S[i] - K[i]) / large;
            }
        }
    }
    SPARI_FREE(K, tense.pre);
    return SPAR_OK;
}
