/* Warns about elements with too few nodes for their stiffness (membrane and shear locking). A bent element with few
   nodes cannot keep its length, or its sections perpendicular to its line, and becomes as stiff as its axial and
   shear stiffness. Equilibria are checked at commit: the limits are those at which a cantilever of one element deflects
   10 % too little (tests/member/test_beam.c). Motions are checked after each step, by the rotation of the elements. */
#include "beam.h"

#include "../base/session.h"
#include "../math/rotation.h"

#include <math.h>

enum { ENOUGH = 5 }; /* nodes: the remaining error of an equilibrium is below 1.3 % */

/* Nodes from which motions are right too: a cantilever of one element that is released under its weight is within 1 %
   of many nodes, for ratios up to 1e11 and rotations up to 1 rad. */
enum { ENOUGH_IN_MOTION = 7 };

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

/* Axial energy that an element of P nodes stores if it bends as the root of a cantilever does under its weight, beside
   the bending energy, divided by the ratio above and by the square of its rotation. With phi ~ 1 - (1 - eta)^3, a line
   that keeps its length has the slope 1 - phi^2 / 2. The element's positions have slopes of degree P - 2 at most, so
   that the Legendre coefficients of a higher degree are axial strains. phi^2 has degree 6. */
static double axial_energy(int P, int elements) {
    enum { POINTS = 8, DEGREE = 6 };
    double x[POINTS], w[POINTS], coefficient[DEGREE + 1] = {0}, bending = 0, axial = 0, far = 1.0 / elements;
    const double rotation = 1 - (1 - far) * (1 - far) * (1 - far);
    spari_gauss(POINTS, x, w);
    for (int i = 0; i < POINTS; i++) {
        double left = 1 - 0.5 * (1 + x[i]) * far, phi = (1 - left * left * left) / rotation,
               curvature = 3 * left * left * far / rotation, legendre[2] = {1, x[i]};
        bending += w[i] * curvature * curvature;
        for (int k = 2; k <= DEGREE; k++) {
            double next = ((2 * k - 1) * x[i] * legendre[1] - (k - 1) * legendre[0]) / k;
            legendre[0] = legendre[1];
            legendre[1] = next;
            coefficient[k] += (k + 0.5) * w[i] * next * 0.5 * phi * phi;
        }
    }
    for (int k = P - 1; k <= DEGREE; k++) {
        axial += coefficient[k] * coefficient[k] / (k + 0.5);
    }
    return axial / bending;
}

/* In an equilibrium, small changes of the bent shape avoid these axial strains. In a motion they act as blows along the
   line, and the element bends into another shape or stays almost straight. With 5 and 6 nodes and 1, 2 or 4 elements
   the tip of a cantilever is first 10 % off where the energy above is 9 to 32 times that of bending. By then it may
   have locked at a fifth of its true rotation, hence the smaller limit: with 1e4 to 1e12 and tips that move 0.01 to 0.7
   of the length it misses none of 84 wrong motions but one that is 11 % off, and warns of 54 of 240 that are not. */
static const double most_axial_energy = 0.5;

void spari_beam_find_locking(spar_member *m) {
    const int P = m->mesh.per_element;
    double whole;
    int element = 0;
    m->locks_from = INFINITY;
    if (P >= ENOUGH && P < ENOUGH_IN_MOTION && m->frame != SPARI_FRAME_LINEAR) {
        m->locks_from =
            sqrt(most_axial_energy / (largest_ratio(m, &whole, &element) * axial_energy(P, m->mesh.elements)));
    }
}

/* The largest rotation of a node relative to the first one of its element, without the rotation about the element's
   chord; the sine of its half, squared. */
static double bend_of(const spar_member *m, int e) {
    const int P = m->mesh.per_element;
    const double *q = m->now.q + 7 * (int64_t)e * P, *x = m->xr + 3 * (int64_t)e * P, *end = x + 3 * (P - 1);
    const double chord[3] = {end[0] - x[0], end[1] - x[1], end[2] - x[2]};
    const double square = spari_dot(chord, chord);
    double most = 0, back[4], rotation[4];
    spari_quat_conj(q + 3, back);
    for (int i = 1; i < P; i++) {
        spari_quat_mul(back, q + 7 * i + 3, rotation);
        double along = spari_dot(rotation + 1, chord);
        most = fmax(most, spari_dot(rotation + 1, rotation + 1) - along * along / square);
    }
    return most;
}

void spari_beam_check_locking(spar_member *m) {
    if (!(m->locks_from < 3) || !(m->effects & SPAR_EFFECT_INERTIA) || m->session->state.trial) {
        return;
    }
    const double limit = sin(0.5 * m->locks_from), most = limit * limit;
    for (int e = 0; e < m->mesh.elements; e++) {
        if (bend_of(m, e) > most) {
            spari_warn(m->session,
                       "member '%s': element %d has %d nodes and is bent by more than %.2g rad: in a motion it locks, "
                       "for axial or shear stiffness is so large beside its bending stiffness / length^2 that the "
                       "deflection may be wrong; use %d nodes per element, or more elements",
                       m->name, e, m->mesh.per_element, m->locks_from, ENOUGH_IN_MOTION);
            m->locks_from = INFINITY;
            return;
        }
    }
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
