/* Loads of a blade element: relative flow, angle of attack and coefficients at one aerodynamic centre. */
#include "element.h"
#include "../math/rotation.h"
#include <stddef.h>

/* A section closer to the tip or hub than this fraction of its radius counts as at the end. There the loss factor is
   0 and the equation has no root. Close to it the swirl of drag-free momentum theory is unbounded. */
#define SPARI_END_SHARE 1e-4
/* Smallest sine of the angle between span and shaft for which the section's plane has an axial direction. */
#define SPARI_SPAN_SINE 1e-3

/* The section's plane: chord from leading to trailing edge, and normal towards the suction side, both perpendicular
   to the span. */
typedef struct frame {
    double span[3], chord[3], normal[3];
} frame;

static frame section_frame(const spari_rotor *rotor, const spari_section *section, const double q[4]) {
    static const double e[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    frame f;
    double y[3], z[3];
    spari_rotate(q, e[0], f.span);
    spari_rotate(q, e[1], y);
    spari_rotate(q, e[2], z);
    for (int i = 0; i < 3; i++) {
        double suction = -(double)rotor->turn * z[i];
        f.chord[i] = section->cos_twist * y[i] + section->sin_twist * suction;
        f.normal[i] = section->cos_twist * suction - section->sin_twist * y[i];
    }
    return f;
}

double spari_rotor_radius(const spari_rotor *rotor, const double x[3]) {
    double d[3], across[3];
    for (int i = 0; i < 3; i++) {
        d[i] = x[i] - rotor->hub[i];
    }
    spari_cross(rotor->axis, d, across);
    return spari_norm(across);
}

static int is_at_end(const spari_rotor *rotor, double radius) {
    return ((rotor->effects & SPAR_AERO_TIP_LOSS) && radius >= (1.0 - SPARI_END_SHARE) * rotor->tip_radius) ||
           ((rotor->effects & SPAR_AERO_HUB_LOSS) && rotor->hub_radius > 0.0 &&
            radius <= (1.0 + SPARI_END_SHARE) * rotor->hub_radius);
}

/* Adds the induced velocity to the flow in the section's plane, flow[0] along the chord and flow[1] along the
   normal. */
static void induce(const spari_rotor *rotor, const spari_section *section, const spari_centre *station, const frame *f,
                   double flow[2], spari_element *element) {
    double along = spari_dot(rotor->axis, f->span), p[3], s[3];
    double sine = sqrt(fmax(0.0, 1.0 - along * along)), radius = spari_rotor_radius(rotor, station->x);
    if (sine < SPARI_SPAN_SINE || !(radius > 0.0)) {
        element->flags |= SPAR_AERO_FLAG_NO_ROOT;
        return;
    }
    for (int i = 0; i < 3; i++) {
        p[i] = (rotor->axis[i] - along * f->span[i]) / sine;
    }
    spari_cross(f->span, p, s);
    double to_p = spari_dot(f->chord, p),
           to_s = rotor->turn * spari_dot(f->chord, s); /* sine and cosine of the twist */
    double half = 0.5 * rotor->blades, loss = station->loss_radius;
    spari_annulus annulus = {.vx = flow[0] * to_p + flow[1] * to_s,
                             .vy = flow[0] * to_s - flow[1] * to_p,
                             .twist = atan2(to_p, to_s),
                             .sigma = half * section->chord / (M_PI * radius),
                             .tip = -1.0,
                             .hub = -1.0,
                             .swirl = (rotor->effects & SPAR_AERO_SWIRL) != 0,
                             .table = section->table,
                             .row = station->row};
    double wx = 0.0, wy = annulus.vy;
    if (is_at_end(rotor, loss)) {
        element->flags |= SPAR_AERO_FLAG_END;
    } else {
        if (rotor->effects & SPAR_AERO_TIP_LOSS) {
            annulus.tip = half * (rotor->tip_radius - loss) / loss;
        }
        if ((rotor->effects & SPAR_AERO_HUB_LOSS) && rotor->hub_radius > 0.0) {
            annulus.hub = half * (loss - rotor->hub_radius) / rotor->hub_radius;
        }
        if (spari_momentum_solve(&annulus, &wx, &wy)) {
            element->flags |= SPAR_AERO_FLAG_NO_ROOT;
        }
    }
    if (station->past && (rotor->effects & SPAR_AERO_INFLOW)) {
        double quasi[2] = {wx - annulus.vx, wy - annulus.vy}, lagged[2];
        double a = annulus.vx != 0.0 ? -quasi[0] / annulus.vx : 0.0;
        double rate = spari_inflow_rate(a, fabs(spari_dot(rotor->axis, station->wind)), rotor->tip_radius);
        spari_inflow_step(&station->past->step, rate, radius / rotor->tip_radius, quasi, lagged);
        wx = annulus.vx + lagged[0];
        wy = annulus.vy + lagged[1];
    }
    element->a = annulus.vx != 0.0 ? 1.0 - wx / annulus.vx : 0.0;
    element->a_tangential = annulus.vy != 0.0 ? wy / annulus.vy - 1.0 : 0.0;
    flow[0] = wx * to_p + wy * to_s;
    flow[1] = wx * to_s - wy * to_p;
}

/* Effective downwash at three quarters of the chord with the shed wake; replaces flow[1]. */
static void shed(const spari_rotor *rotor, const spari_section *section, const spari_centre *station, const frame *f,
                 double flow[2]) {
    double half = 0.5 * section->chord, pitching = rotor->turn * spari_dot(station->past->omega, f->span);
    double rate = hypot(flow[0], flow[1]) / half;
    flow[1] = spari_wake_step(&station->past->step, rate, flow[1] + half * pitching);
}

/* Added-mass loads of a thin airfoil (Theodorsen) per length: pi rho b^2 times the rate of the downwash at half
   chord, acting there across the chord, and the moment of rotational inertia about this point. stream: velocity
   along the chord. */
static void accelerate_air(const spari_rotor *rotor, const spari_section *section, const spari_centre *station,
                           const frame *f, double density, double stream, double load[6]) {
    double half = 0.5 * section->chord, arm[3], at_arm[3], carried[3], again[3], turned[3], rate = 0.0;
    for (int i = 0; i < 3; i++) {
        arm[i] = 0.5 * half * f->chord[i];
    }
    spari_cross(station->past->omega, arm, at_arm);
    spari_cross(station->past->omega_a, arm, carried);
    spari_cross(station->past->omega, at_arm, again);
    spari_cross(station->past->omega, f->normal, turned);
    for (int i = 0; i < 3; i++) {
        double wind = station->wind[i] - station->v[i] - at_arm[i], a = station->past->a[i] + carried[i] + again[i];
        rate += wind * turned[i] - a * f->normal[i];
    }
    double air = M_PI * density * half * half, pitching = rotor->turn * spari_dot(station->past->omega, f->span);
    double faster = rotor->turn * spari_dot(station->past->omega_a, f->span);
    double moment = -air * (0.5 * half * (rate + stream * pitching) + 0.125 * half * half * faster);
    for (int i = 0; i < 3; i++) {
        load[i] += air * rate * f->normal[i];
        load[3 + i] += rotor->turn * moment * f->span[i];
    }
}

/* Lift with a lag of the separation point behind its steady position. Beyond 45 degrees from the zero-lift angle the
   effect fades, beyond 90 degrees there is none, because attached flow is no reference there. */
static double lag_stall(const spari_section *section, const spari_centre *station, double alpha, double speed,
                        double lift) {
    const spari_attached *flow = station->past->attached;
    double away = remainder(alpha - flow->zero, 2.0 * M_PI), attached = flow->slope * away;
    double near = fmax(0.0, fmin(1.0, 2.0 - 4.0 * M_1_PI * fabs(away)));
    double target = fabs(away) > 1e-6 ? spari_attached_part(lift / attached) : 1.0;
    double part = spari_stall_step(&station->past->step, speed / (4.0 * section->chord), target);
    return lift + near * (part - target) * spari_attached_gain(lift, attached);
}

void spari_element_solve(const spari_rotor *rotor, const spari_section *section, const spari_centre *station,
                         double density, spari_element *element) {
    frame f = section_frame(rotor, section, station->q);
    double wind[3] = {station->wind[0] - station->v[0], station->wind[1] - station->v[1],
                      station->wind[2] - station->v[2]};
    double flow[2] = {spari_dot(wind, f.chord), spari_dot(wind, f.normal)};
    *element = (spari_element){.flags = 0};
    if (rotor->effects & SPAR_AERO_INDUCTION) {
        induce(rotor, section, station, &f, flow, element);
    }
    double stream = flow[0];
    const spari_past *past = section->chord > 0.0 ? station->past : NULL;
    int beyond, unsteady = past && (rotor->effects & SPAR_AERO_UNSTEADY);
    if (unsteady) {
        shed(rotor, section, station, &f, flow);
    }
    element->alpha = atan2(flow[1], flow[0]);
    double place = spari_table_wrap(section->table, element->alpha, &beyond);
    element->flags |= beyond ? SPAR_AERO_FLAG_BEYOND_POLAR : 0;
    element->cl = spari_table_lift(section->table, place, station->row);
    /* lift across the flow towards the suction side, drag along it */
    double speed = hypot(flow[0], flow[1]), scale = 0.5 * density * section->chord * speed;
    if (past && (rotor->effects & SPAR_AERO_STALL) && past->attached->slope > 0.0) {
        element->cl = lag_stall(section, station, element->alpha, speed, element->cl);
    }
    double along = -element->cl * flow[1], across = element->cl * flow[0];
    if (rotor->effects & SPAR_AERO_DRAG) {
        element->cd = spari_table_drag(section->table, place, station->row);
        along += element->cd * flow[0];
        across += element->cd * flow[1];
    }
    for (int i = 0; i < 3; i++) {
        element->load[i] = scale * along * f.chord[i] + scale * across * f.normal[i];
    }
    if (rotor->effects & SPAR_AERO_MOMENT) { /* nose up */
        double moment =
            scale * section->chord * speed * rotor->turn * spari_table_moment(section->table, place, station->row);
        for (int i = 0; i < 3; i++) {
            element->load[3 + i] = moment * f.span[i];
        }
    }
    if (unsteady) {
        accelerate_air(rotor, section, station, &f, density, stream, element->load);
    }
}
