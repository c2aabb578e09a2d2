/* Loads of a blade element: inflow, angle of attack and coefficients at one aerodynamic centre. */
#include "element.h"
#include "../math/rotation.h"

/* Nearer to the tip or hub than this share of its radius, a section counts as lying on it: there the loss factor is 0
   and the equation has no root, and just beside it the swirl of drag-free momentum theory grows without bound. */
#define SPARI_END_SHARE 1e-4
/* Smallest sine of the angle between span and shaft with which the section's plane has an axial direction. */
#define SPARI_SPAN_SINE 1e-3

/* The section's plane: chord from leading to trailing edge, normal to it towards the suction side, both across the
 * span. */
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

/* Turns the flow in the section's plane, flow[0] along the chord and flow[1] along the normal, into that with
 * induction. */
static void induce(const spari_rotor *rotor, const spari_section *section, const spari_centre *station, const frame *f,
                   gsl_root_fsolver *solver, double flow[2], spari_element *element) {
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
                             .accel = station->accel};
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
        if (spari_momentum_solve(&annulus, solver, &wx, &wy)) {
            element->flags |= SPAR_AERO_FLAG_NO_ROOT;
        }
    }
    element->a = annulus.vx != 0.0 ? 1.0 - wx / annulus.vx : 0.0;
    element->a_tangential = annulus.vy != 0.0 ? wy / annulus.vy - 1.0 : 0.0;
    flow[0] = wx * to_p + wy * to_s;
    flow[1] = wx * to_s - wy * to_p;
}

void spari_element_solve(const spari_rotor *rotor, const spari_section *section, const spari_centre *station,
                         double density, gsl_root_fsolver *solver, spari_element *element) {
    frame f = section_frame(rotor, section, station->q);
    double wind[3] = {station->wind[0] - station->v[0], station->wind[1] - station->v[1],
                      station->wind[2] - station->v[2]};
    double flow[2] = {spari_dot(wind, f.chord), spari_dot(wind, f.normal)};
    *element = (spari_element){.flags = 0};
    if (rotor->effects & SPAR_AERO_INDUCTION) {
        induce(rotor, section, station, &f, solver, flow, element);
    }
    int beyond;
    element->alpha = atan2(flow[1], flow[0]);
    double place = spari_table_wrap(section->table, element->alpha, &beyond);
    element->flags |= beyond ? SPAR_AERO_FLAG_BEYOND_POLAR : 0;
    element->cl = spari_table_lift(section->table, place, station->accel);
    /* lift across the flow towards the suction side, drag along it */
    double speed = hypot(flow[0], flow[1]), scale = 0.5 * density * section->chord * speed;
    double along = -element->cl * flow[1], across = element->cl * flow[0];
    if (rotor->effects & SPAR_AERO_DRAG) {
        element->cd = spari_table_drag(section->table, place, station->accel);
        along += element->cd * flow[0];
        across += element->cd * flow[1];
    }
    for (int i = 0; i < 3; i++) {
        element->load[i] = scale * along * f.chord[i] + scale * across * f.normal[i];
    }
    if (rotor->effects & SPAR_AERO_MOMENT) { /* nose up */
        double moment =
            scale * section->chord * speed * rotor->turn * spari_table_moment(section->table, place, station->accel);
        for (int i = 0; i < 3; i++) {
            element->load[3 + i] = moment * f.span[i];
        }
    }
}
