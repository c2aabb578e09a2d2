/* What generalised-alpha is for every member: coefficients, loads within a step, steps of another length. */
#include "scheme.h"

#include "../base/scene.h"
#include "../member/body.h"

#include <math.h>

spari_scheme spari_scheme_of(const spar_member *member, double h) {
    double rho = member->session->rho_inf;
    spari_scheme c = {.h = h};
    c.alpha_m = (2 * rho - 1) / (rho + 1);
    c.alpha_f = rho / (rho + 1);
    c.gamma = 0.5 + c.alpha_f - c.alpha_m;
    c.beta = 0.25 * (0.5 + c.gamma) * (0.5 + c.gamma);
    c.still = !(member->effects & SPAR_EFFECT_INERTIA);
    if (c.still) {
        c.cm = 0, c.cv = member->body->D ? 1 / h : 0;
    } else {
        c.cm = (1 - c.alpha_m) / (h * h * c.beta * (1 - c.alpha_f));
        c.cv = c.gamma / (h * c.beta);
    }
    c.cb = c.cm * (1 - c.alpha_f) / (1 - c.alpha_m);
    return c;
}

/* Without this a sequence of uneven steps is of first order. A much larger step gets no more than four times the
   distance: it is mostly what an unresolved part left there. */
double spari_scheme_stretch(double before, double h) {
    return before > 0 && h != before ? fmin(h / before, 4) : 1;
}

void spari_scheme_stretch_by(double ratio, int n, const double *a, double *b) {
    for (int i = 0; i < n && ratio != 1; i++) {
        b[i] = a[i] + ratio * (b[i] - a[i]);
    }
}

void spari_scheme_loads(const spar_member *member, double *begin, double *end, double *room) {
    spari_member_gather(member, member->load_history[0], begin);
    spari_member_gather(member, member->load_used, end);
    spari_member_gather(member, member->dead, room);
    for (int i = 0; i < 6 * member->body->unique; i++) {
        begin[i] += room[i];
        end[i] += room[i];
    }
}
