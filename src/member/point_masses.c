/* Attached point masses of a beam: description by the host, and position on the elements. Each becomes a point of
   the body without stiffness (beam.c), so inertia, weight and everything derived from them include it. */
#include "../base/environment.h"
#include "beam.h"
#include "check_arguments.h"

#include <math.h>

int spari_point_mass_element(const spar_member *member, int64_t k, double *xi) {
    double along = member->beam->point_masses.eta[k] * member->mesh.elements;
    int e = (int)ceil(along - 1e-9) - 1; /* an element boundary belongs to the element before it */
    e = e < 0 ? 0 : e > member->mesh.elements - 1 ? member->mesh.elements - 1 : e;
    *xi = fmin(fmax(2 * (along - e) - 1, -1), 1);
    return e;
}

int spari_point_masses_of(const spar_member *member, int e) {
    int n = 0;
    for (int64_t k = 0; k < member->beam->point_masses.count; k++) {
        double xi;
        n += spari_point_mass_element(member, k, &xi) == e;
    }
    return n;
}

void spari_point_masses_weight(const spar_member *member, double weight) {
    spari_body *b = member->body;
    for (int e = 0; e < b->elements; e++) {
        int n = b->first[e + 1] - b->first[e], point_masses = spari_point_masses_of(member, e);
        for (int k = n - point_masses; k < n; k++) {
            b->weight[b->slot[e] + k] = weight;
        }
    }
}

int spari_point_masses_check(const spar_member *member) {
    SPARI_REQUIRE(member->session, member->beam->point_masses.count == 0 || member->external || member->beam->mass,
                  SPAR_ERR_STATE,
                  "member '%s' has attached bodies but sections without mass; give its sections mass, however small",
                  member->name);
    return SPAR_OK;
}

int spar_beam_set_masses(spar_member *beam, int64_t n, const double *eta, const double *mass) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_TRY(spari_need_beam(beam, __func__));
    SPARI_TRY(spari_need_stations(beam, __func__, n, SPARI_MOST_STATIONS, eta, SPARI_UNORDERED, "mass", 36, mass));
    for (int64_t i = 0; i < n; i++) {
        double m, c[3], J[6];
        const char *wrong = spari_mass_split(mass + 36 * i, &m, c, J);
        SPARI_REQUIRE(beam->session, !wrong, SPAR_ERR_ARGUMENT,
                      "%s: '%s': the mass of body %lld is not that of a rigid body: %s", __func__, beam->name,
                      (long long)i, wrong);
        double moment[3];
        SPARI_REQUIRE(beam->session, !spari_inertia_is_impossible(mass + 36 * i, moment), SPAR_ERR_ARGUMENT,
                      "%s: '%s': no body has the moments of inertia %.4g, %.4g, %.4g of body %lld about its centre of "
                      "mass: the largest is at most the sum of the others; check the axes and the point they refer to",
                      __func__, beam->name, moment[0], moment[1], moment[2], (long long)i);
    }
    return spari_line_table_set(beam, __func__, "bodies", n, 36, eta, mass, &beam->beam->point_masses);
}

int spar_beam_get_masses(const spar_member *beam, int64_t *n, int64_t capacity, double *eta, double *mass) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_TRY(spari_need_any_beam(beam, __func__));
    return spari_line_table_get(beam, __func__, 36, &beam->beam->point_masses, capacity, n, eta, mass);
}
