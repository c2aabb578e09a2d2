/* Constraint damping. Accelerations and loads along the constraints oscillate: the scheme has no motion there but
   its own three roots, all -rho_inf. Near -1 these oscillations do not decay, and rotation feeds them until members
   fly apart (a chain of ten members that oscillates by 0.05 rad, after 8000 steps with rho_inf = 1). If rho_inf is
   larger than `most`, the oscillations are damped to it after each step, along the constraints alone. All other
   motions keep rho_inf.

   With e = B a + B-dot v - z-dot-dot, which is of order h^2 apart from the oscillation, and x the motion that forces
   of the joints cause with B x = e,

      a := a - (1 - r^2) x,    v := v - (1 - r)^2 / 4 h x,    r = most / rho_inf

   have two roots -r instead of two roots -1 (rho_inf = 1). The third root belongs to the algorithmic accelerations,
   which enter as b^n + b^{n+1} and do not show there. Positions stay, and the published motion is that before. */
#include "system.h"

#include "../base/session.h"

static const double most = 0.9;

/* Sets the gaps to e. */
static void find_ringing(spari_assembly *a, double s, double dt) {
    for (int i = 0; i < a->constraints; i++) {
        spari_constraint *l = a->constraint + i;
        const spari_relative found = l->joint->after;
        spari_constraint_find(l, s, dt, 1);
        l->joint->after = found;
        spari_constraint_set_acceleration_gaps(l);
    }
}

int spari_system_damp_constraints(spari_assembly *a, double s, double dt) {
    const spari_scheme *c = &a->component[0].scheme;
    double r = most / a->session->integrator.rho_inf;
    if (!(r < 1) || c->still) {
        return 0;
    }
    find_ringing(a, s, dt);
    /* velocities are on the constraints already */
    return spari_system_shift_rates(a, c->cv, a->constrains_rates ? 0 : 0.25 * (1 - r) * (1 - r) * c->h, 1 - r * r, 0);
}
