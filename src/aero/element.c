/* Loads of a blade element: relative flow, angle of attack and coefficients at one aerodynamic centre. */
#include "element.h"
#include "../math/rotation.h"
#include "momentum_kernels.h"
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

/* Axes of a section and the flow that it meets. */
typedef struct section_flow {
    frame f;
    double flow[2];    /* along the chord and the normal */
    double to_p, to_s; /* sine and cosine of the twist from the disc's plane */
    double vx, vy;     /* free flow, see momentum.h */
    int annulus;       /* its number among those that are solved; -1: none */
} section_flow;

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
           ((rotor->effects & SPAR_AERO_HUB_LOSS) && radius <= (1.0 + SPARI_END_SHARE) * rotor->hub_radius);
}

/* Splits the flow in the section's plane into vx and vy. Returns 0 where the plane has no axial direction. */
static int split_flow(const spari_rotor *rotor, section_flow *e, double radius) {
    double along = spari_dot(rotor->axis, e->f.span), p[3], s[3];
    double sine = sqrt(fmax(0.0, 1.0 - along * along));
    if (sine < SPARI_SPAN_SINE || !(radius > 0.0)) {
        return 0;
    }
    for (int i = 0; i < 3; i++) {
        p[i] = (rotor->axis[i] - along * e->f.span[i]) / sine;
    }
    spari_cross(e->f.span, p, s);
    e->to_p = spari_dot(e->f.chord, p);
    e->to_s = rotor->turn * spari_dot(e->f.chord, s);
    e->vx = e->flow[0] * e->to_p + e->flow[1] * e->to_s;
    e->vy = e->flow[0] * e->to_s - e->flow[1] * e->to_p;
    return 1;
}

/* Appends the annulus of a section. */
static void add_annulus(const spari_rotor *rotor, const spari_section *section, const spari_centre *station,
                        double radius, section_flow *e, spari_annuli *annuli) {
    double half = 0.5 * rotor->blades, loss = station->loss_radius;
    int l = annuli->count++;
    e->annulus = l;
    annuli->vx[l] = e->vx;
    annuli->vy[l] = e->vy;
    annuli->twist_sine[l] = e->to_p;
    annuli->twist_cosine[l] = e->to_s;
    annuli->sigma[l] = half * section->chord / (M_PI * radius);
    annuli->tip[l] = annuli->hub[l] = -1.0;
    annuli->table[l] = section->table;
    annuli->row[l] = station->row;
    if (rotor->effects & SPAR_AERO_TIP_LOSS) {
        annuli->tip[l] = half * (rotor->tip_radius - loss) / loss;
    }
    if (rotor->effects & SPAR_AERO_HUB_LOSS) {
        annuli->hub[l] = half * (loss - rotor->hub_radius) / rotor->hub_radius;
    }
}

/* Adds the induced velocity to the flow of an element whose plane has an axial direction. */
static void induce(const spari_rotor *rotor, const spari_centre *station, const spari_annuli *annuli, double radius,
                   section_flow *e, spari_element *element) {
    double wx = 0.0, wy = e->vy; /* at an end */
    if (e->annulus >= 0) {
        wx = annuli->wx[e->annulus];
        wy = annuli->wy[e->annulus];
        element->flags |= annuli->no_root[e->annulus] ? SPAR_AERO_FLAG_NO_ROOT : 0;
    } else {
        element->flags |= SPAR_AERO_FLAG_END;
    }
    if (station->past && (rotor->effects & SPAR_AERO_INFLOW)) {
        double quasi[2] = {wx - e->vx, wy - e->vy}, lagged[2];
        double a = e->vx != 0.0 ? -quasi[0] / e->vx : 0.0;
        double rate = spari_inflow_rate(a, fabs(spari_dot(rotor->axis, station->wind)), rotor->tip_radius);
        spari_inflow_step(&station->past->step, rate, radius / rotor->tip_radius, quasi, lagged);
        wx = e->vx + lagged[0];
        wy = e->vy + lagged[1];
    }
    element->a = e->vx != 0.0 ? 1.0 - wx / e->vx : 0.0;
    element->a_tangential = e->vy != 0.0 ? wy / e->vy - 1.0 : 0.0;
    e->flow[0] = wx * e->to_p + wy * e->to_s;
    e->flow[1] = wx * e->to_s - wy * e->to_p;
}

/* Induction of all elements. */
static void induce_all(const spari_rotor *rotor, int lanes, int count, const spari_section *const *section,
                       const spari_centre *station, section_flow *e, spari_element *element) {
    spari_annuli annuli = {.swirl = (rotor->effects & SPAR_AERO_SWIRL) != 0};
    double radius[SPARI_ANNULI];
    int has_plane[SPARI_ANNULI];
    for (int l = 0; l < count; l++) {
        radius[l] = spari_rotor_radius(rotor, station[l].x);
        has_plane[l] = split_flow(rotor, e + l, radius[l]);
        e[l].annulus = -1;
        if (has_plane[l] && !is_at_end(rotor, station[l].loss_radius)) {
            add_annulus(rotor, section[l], station + l, radius[l], e + l, &annuli);
        }
    }
    spari_momentum_solve(&annuli, lanes);
    for (int l = 0; l < count; l++) {
        if (has_plane[l]) {
            induce(rotor, station + l, &annuli, radius[l], e + l, element + l);
        } else {
            element[l].flags |= SPAR_AERO_FLAG_NO_ROOT;
        }
    }
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

/* Loads of an element whose flow and angle of attack are known. stream: flow along the chord before the shed wake. */
static void load(const spari_rotor *rotor, const spari_section *section, const spari_centre *station, double density,
                 double stream, const section_flow *e, spari_element *element) {
    const double *flow = e->flow;
    const spari_past *past = section->chord > 0.0 ? station->past : NULL;
    int beyond;
    double place = spari_table_wrap(section->table, element->alpha, &beyond);
    element->flags |= beyond ? SPAR_AERO_FLAG_BEYOND_POLAR : 0;
    element->cl = spari_table_lift(section->table, place, station->row);
    /* lift across the flow towards the suction side, drag along it */
    double speed = sqrt(flow[0] * flow[0] + flow[1] * flow[1]), scale = 0.5 * density * section->chord * speed;
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
        element->load[i] = scale * along * e->f.chord[i] + scale * across * e->f.normal[i];
    }
    if (rotor->effects & SPAR_AERO_MOMENT) { /* nose up */
        double moment =
            scale * section->chord * speed * rotor->turn * spari_table_moment(section->table, place, station->row);
        for (int i = 0; i < 3; i++) {
            element->load[3 + i] = moment * e->f.span[i];
        }
    }
    if (past && (rotor->effects & SPAR_AERO_UNSTEADY)) {
        accelerate_air(rotor, section, station, &e->f, density, stream, element->load);
    }
}

void spari_elements_solve(const spari_rotor *rotor, int lanes, int count, const spari_section *const *section,
                          const spari_centre *station, double density, spari_element *element) {
    section_flow e[SPARI_ANNULI];
    double stream[SPARI_ANNULI], along[SPARI_ANNULI] = {0}, across[SPARI_ANNULI] = {0}, alpha[SPARI_ANNULI];
    for (int l = 0; l < count; l++) {
        const spari_centre *s = station + l;
        double wind[3] = {s->wind[0] - s->v[0], s->wind[1] - s->v[1], s->wind[2] - s->v[2]};
        e[l].f = section_frame(rotor, section[l], s->q);
        e[l].flow[0] = spari_dot(wind, e[l].f.chord);
        e[l].flow[1] = spari_dot(wind, e[l].f.normal);
        element[l] = (spari_element){.flags = 0};
    }
    if (rotor->effects & SPAR_AERO_INDUCTION) {
        induce_all(rotor, lanes, count, section, station, e, element);
    }
    for (int l = 0; l < count; l++) {
        stream[l] = e[l].flow[0];
        if (station[l].past && section[l]->chord > 0.0 && (rotor->effects & SPAR_AERO_UNSTEADY)) {
            shed(rotor, section[l], station + l, &e[l].f, e[l].flow);
        }
        along[l] = e[l].flow[0];
        across[l] = e[l].flow[1];
    }
    spari_momentum_kernels_for(lanes)->angles(across, along, alpha);
    for (int l = 0; l < count; l++) {
        element[l].alpha = alpha[l];
        load(rotor, section[l], station + l, density, stream[l], e + l, element + l);
    }
}
