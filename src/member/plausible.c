/* Warns at the commit about beams that are legal and probably wrong: angles in degrees, stiffness or lengths in other
   units or in another order, inertia that no section has. */
#include "../base/session.h"
#include "../math/rotation.h"
#include "beam.h"

#include <math.h>
#include <stdio.h>

/* Means along a beam, by which its first frequency is estimated. */
typedef struct means {
    double length, mass;  /* m, kg */
    double bending;       /* N m^2 */
    double tension, bed;  /* N, N/m^2 */
    double weight_length; /* 1/s^2: g / length */
} means;

/* The smaller bending stiffness of a section: least eigenvalue of its block. */
static double softer_bending(const double C[36]) {
    double mean = 0.5 * (C[28] + C[35]), half = 0.5 * (C[28] - C[35]);
    return mean - hypot(half, C[29]);
}

static means means_of(const spar_member *m) {
    enum { PLACES = 16 };
    const spari_beam *b = m->beam;
    means a = {.length = spari_member_length(m)};
    for (int i = 0; i < PLACES; i++) {
        double C[36], eta = (i + 0.5) / PLACES, pre[6] = {0};
        spari_beam_section_at(b, b->stiffness, eta, C);
        a.bending += softer_bending(C) / PLACES;
        if (b->mass) {
            spari_beam_section_at(b, b->mass, eta, C);
            a.mass += C[0] * a.length / PLACES;
        }
        if (b->pretension.count > 0) {
            spari_pretension_at(b, eta, pre);
            a.tension += pre[0] / PLACES;
        }
    }
    for (int64_t i = 0; i < b->point_masses.count; i++) {
        a.mass += b->point_masses.value[36 * i];
    }
    for (int64_t i = 0; i < b->springs.count; i++) {
        a.bed += fmin(b->springs.value[3 * i + 1], b->springs.value[3 * i + 2]) / (double)b->springs.count;
    }
    a.weight_length = m->effects & SPAR_EFFECT_GRAVITY ? spari_norm(m->session->gravity) / a.length : 0;
    return a;
}

/* First frequency, Hz, of a uniform beam with these means: bending as a cantilever, or free, and the stiffness of
   tension, weight and foundation, by Rayleigh's and Dunkerley's bounds. Right to a factor of about 10, which is enough
   to see another unit. */
static double first_frequency(const spar_member *m, const means *a) {
    static const double pi = 3.14159265358979323846;
    double L = a->length, shape = m->root == SPAR_ROOT_FIXED || m->root == SPAR_ROOT_DRIVEN ? 12.36 : 500.6;
    double per_length = a->mass / L;
    double square = shape * a->bending / (per_length * L * L * L * L) + a->weight_length + a->bed / per_length +
                    fmax(a->tension, 0) * pi * pi / (per_length * L * L);
    return sqrt(square) / (2 * pi);
}

static void warn_of_twist(const spar_member *m) {
    const spari_beam *b = m->beam;
    for (int64_t i = 1; b->twist && i < b->axis_count; i++) {
        double change = fabs(b->twist[i] - b->twist[i - 1]);
        if (change > 3.1416) {
            spari_warn(
                m->session,
                "member '%s': the twist changes by %.4g rad from axis point %lld to %lld, more than half a turn; "
                "twist is in radians: convert degrees, or add axis points",
                m->name, change, (long long)(i - 1), (long long)i);
            return;
        }
    }
}

/* One warning of each kind, for the first such section. */
static void warn_of_sections(const spar_member *m) {
    const spari_beam *b = m->beam;
    int64_t swapped = 0;
    for (int64_t i = 0; i < b->section_count; i++) {
        swapped += spari_section_is_other_order(b->stiffness + 36 * i);
    }
    if (swapped == b->section_count && swapped > 0) {
        spari_warn(
            m->session,
            "member '%s': the stiffness of its sections looks like BeamDyn's order (axial %.3g below shear along "
            "z %.3g N); give it as axial, shears, torsion, bendings, or read BeamDyn's file with "
            "spar_beam_read_beamdyn",
            m->name, b->stiffness[0], b->stiffness[14]);
    }
    for (int64_t i = 0; b->mass && i < b->section_count; i++) {
        double moment[3];
        if (spari_inertia_is_impossible(b->mass + 36 * i, moment)) {
            spari_warn(m->session,
                       "member '%s': no section has the moments of inertia %.4g, %.4g, %.4g kg m of section %lld about "
                       "its centre of mass: the largest is at most the sum of the others; check the order of the axes",
                       m->name, moment[0], moment[1], moment[2], (long long)i);
            return;
        }
    }
}

void spari_beam_tell_plausible(const spar_member *m) {
    warn_of_twist(m);
    warn_of_sections(m);
    means a = means_of(m);
    if (!(a.mass > 0)) {
        return;
    }
    double frequency = first_frequency(m, &a);
    if (frequency < 1e-4 || frequency > 1e5) {
        spari_warn(m->session,
                   "member '%s': its first frequency is about %.1e Hz (length %.3g m, mass %.3g kg, bending stiffness "
                   "%.3g N m^2); check the units of lengths, stiffness and mass",
                   m->name, frequency, a.length, a.mass, a.bending);
    }
    if (m->session->callbacks.log) {
        char text[SPARI_MESSAGE_SIZE];
        (void)snprintf(text, sizeof text,
                       "member '%s': mass %.4g kg, length %.4g m, first frequency about %.2g Hz (of a uniform beam)",
                       m->name, a.mass, a.length, frequency);
        spari_log(m->session, SPAR_LOG_INFO, text);
    }
}
