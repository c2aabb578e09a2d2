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

#include <string.h>

static const double most = 0.9;

/* Sets the gaps to e. */
static void find_ringing(spari_assembly *a, double s, double dt) {
    for (int i = 0; i < a->constraints; i++) {
        spari_constraint *l = a->constraint + i;
        const spari_relative found = l->joint->after;
        double drift[6], rate[6];
        spari_constraint_find(l, s, dt, 1);
        l->joint->after = found;
        spari_kinematics_drift(&l->joint->kinematics, &l->pose[0], &l->pose[1], l->v, drift);
        spari_constraint_times(l->B, l->a, rate);
        for (int k = 0; k < 6; k++) {
            double asked = l->joint->driven >> k & 1 ? l->drive.acceleration[k] : 0;
            l->gap[k] = spari_constraint_holds(l, k) ? rate[k] + drift[k] - asked : 0;
        }
    }
}

int spari_system_damp_constraints(spari_assembly *a, double s, double dt) {
    const spari_scheme *c = &a->component[0].scheme;
    double r = most / a->session->integrator.rho_inf;
    if (!(r < 1) || c->still) {
        return 0;
    }
    find_ringing(a, s, dt);
    if (spari_system_close_gaps(a, c->cv)) {
        return 1;
    }
    for (int i = 0; i < a->components; i++) { /* violent: velocities are on the constraints */
        a->component[i].row->shift_rates(a->component + i, a->violent ? 0 : 0.25 * (1 - r) * (1 - r) * c->h, 1 - r * r,
                                         0);
    }
    return 0;
}
