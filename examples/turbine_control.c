#include "turbine_control.h"
#include <math.h>

const double turbine_gear = 97, turbine_efficiency = 0.944;

/* the law of the torque */
static const double cut_in = 70.16224, region_2 = 91.21091, rated = 121.6805, optimal = 2.332287, slip = 0.10,
                    power = 5296610, torque_most = 47402.91, torque_rate = 15000;
/* Above this pitch the power is held, whatever the speed does. */
static const double held_from = 0.01745329;
/* the pitch */
static const double reference = 122.9096, corner = 1.570796, gain_p = 0.01882681, gain_i = 0.008068634,
                    gain_half = 0.1099965, pitch_most = 1.570796, pitch_rate = 0.1396263;

static double within(double x, double least, double most) {
    return x < least ? least : x > most ? most : x;
}

static double gains_at(double pitch) {
    return 1 / (1 + pitch / gain_half);
}

double turbine_torque(double speed, double pitch) {
    const double start = optimal * region_2 * region_2 / (region_2 - cut_in), synchronous = rated / (1 + slip),
                 slope = power / rated / (rated - synchronous);
    if (speed >= rated || pitch >= held_from) {
        return fmin(power / fmax(speed, 1), torque_most);
    }
    if (speed <= cut_in) {
        return 0;
    }
    if (speed < region_2) {
        return start * (speed - cut_in);
    }
    return fmin(fmax(optimal * speed * speed, slope * (speed - synchronous)), torque_most);
}

void turbine_control_begin(turbine_control *c, double speed, double pitch) {
    *c = (turbine_control){speed, pitch / (gains_at(pitch) * gain_i), pitch, turbine_torque(speed, pitch), 0};
}

void turbine_control_step(turbine_control *c, double speed, double dt) {
    const double keep = exp(-corner * dt);
    c->speed = keep * c->speed + (1 - keep) * speed;
    const double asked = turbine_torque(c->speed, c->pitch), turn = torque_rate * dt;
    c->torque = within(asked, c->torque - turn, c->torque + turn);
    const double gain = gains_at(c->pitch), error = c->speed - reference;
    c->integral = within(c->integral + error * dt, 0, pitch_most / (gain * gain_i));
    const double pitch = within(gain * (gain_p * error + gain_i * c->integral), 0, pitch_most);
    const double next = within(pitch, c->pitch - pitch_rate * dt, c->pitch + pitch_rate * dt);
    c->rate = (next - c->pitch) / dt;
    c->pitch = next;
}
