/* Mass, momenta and inertia of a body in motion: see body.h. */
#include "../math/rotation.h"
#include "body.h"

#include <math.h>
#include <string.h>

/* The motion of a section, its position relative to the origin. */
typedef struct section_motion {
    double x[3], q[4], v[6], a[6];
} section_motion;

/* By the sums of the nodes' positions, quaternions and rates. */
static void add_node(double phi, const double *position, const double *q, const double *v, const double *a,
                     section_motion *s) {
    for (int k = 0; k < 3; k++) {
        s->x[k] += phi * (position[k] + q[k]);
    }
    for (int k = 0; k < 4; k++) {
        s->q[k] += phi * q[3 + k];
    }
    for (int k = 0; k < 6; k++) {
        s->v[k] += phi * v[k];
        s->a[k] += phi * a[k];
    }
}

/* y := R J R^T x, with J (xx, xy, xz, yy, yz, zz) at the reference. */
static void rotated_inertia(const double q[4], const double J[6], const double x[3], double y[3]) {
    double z[3];
    spari_rotate_back(q, x, z);
    const double Jz[3] = {J[0] * z[0] + J[1] * z[1] + J[2] * z[2], J[1] * z[0] + J[3] * z[1] + J[4] * z[2],
                          J[2] * z[0] + J[4] * z[1] + J[5] * z[2]};
    spari_rotate(q, Jz, y);
}

/* The force of `of` (velocity or acceleration of the line's point and its angular rate), with the rest of the mass
   centre's acceleration, at x + Rc. */
static void add_point(const section_motion *s, double weight, const double mass[10], spari_momenta *m) {
    double c[3], x[3], v[3], a[3], t[3], spin[3], grow[3], gyro[3];
    const double J[6] = {mass[4], mass[5], mass[6], mass[7], mass[8], mass[9]}, *w = s->v + 3, size = weight * mass[0];
    spari_rotate(s->q, mass + 1, c); /* m c */
    spari_cross(w, c, v);
    spari_cross(w, v, a);
    spari_cross(s->a + 3, c, t);
    for (int k = 0; k < 3; k++) {
        x[k] = weight * (mass[0] * s->x[k] + c[k]);
        v[k] = weight * (mass[0] * s->v[k] + v[k]);
        a[k] = weight * (mass[0] * s->a[k] + a[k] + t[k]);
        m->first[k] += x[k];
        m->linear[k] += v[k];
        m->force[k] += a[k];
    }
    m->mass += size;
    /* about the point of the line, moved to the origin: J w + m c x v + x x p */
    rotated_inertia(s->q, J, w, spin);
    rotated_inertia(s->q, J, s->a + 3, grow);
    spari_cross(w, spin, gyro);
    for (int k = 0; k < 3; k++) {
        m->angular[k] += weight * spin[k];
        m->moment[k] += weight * (grow[k] + gyro[k]);
    }
    spari_cross(c, s->v, spin);
    spari_cross(c, s->a, grow);
    for (int k = 0; k < 3; k++) {
        m->angular[k] += weight * spin[k];
        m->moment[k] += weight * grow[k];
    }
    spari_cross(s->x, v, spin);
    spari_cross(s->x, a, grow);
    for (int k = 0; k < 3; k++) {
        m->angular[k] += spin[k];
        m->moment[k] += grow[k];
    }
    const double square = size * spari_dot(s->x, s->x) + 2 * weight * spari_dot(s->x, c);
    for (int i = 0; i < 3; i++) {
        double e[3] = {i == 0, i == 1, i == 2}, column[3];
        rotated_inertia(s->q, J, e, column);
        for (int k = 0; k < 3; k++) {
            const double cross = weight * (s->x[i] * c[k] + c[i] * s->x[k]) + size * s->x[i] * s->x[k];
            m->inertia[3 * k + i] += weight * column[k] + (i == k ? square : 0) - cross;
        }
    }
}

void spari_body_momenta(const spari_body *b, const double *position, const double *q, const double *v, const double *a,
                        const double origin[3], spari_momenta *m) {
    const int P = b->per_element;
    memset(m, 0, sizeof *m);
    for (int e = 0; e < b->elements && b->mass; e++) {
        for (int k = b->first[e]; k < b->first[e + 1]; k++) {
            const int64_t slot = b->slot[e] + k - b->first[e];
            section_motion s = {{-origin[0], -origin[1], -origin[2]}, {0}, {0}, {0}};
            double mass[10];
            for (int l = 0; l < P; l++) {
                const int64_t node = (int64_t)e * P + l;
                add_node(b->phi[(int64_t)k * P + l], position + 3 * node, q + 7 * node, v + 6 * node, a + 6 * node, &s);
            }
            spari_quat_normalise(s.q);
            spari_slot_get(b->mass, 10, slot, mass);
            add_point(&s, *SPARI_BLOCK(b->weight, 1, slot), mass, m);
        }
    }
}
