/* The controller of the NREL 5-MW turbine as its report has it (Jonkman et al., NREL/TP-500-38060, 2009, section 7):
   generator torque by a law of the generator's speed, collective pitch by a PI controller whose gains go down with the
   pitch. It sees the generator's speed alone, filtered by one pole. Angles in rad, speeds in rad/s, torques in N m at
   the fast shaft, 97 times as fast as the rotor. */
#ifndef TURBINE_CONTROL_H
#define TURBINE_CONTROL_H

#ifdef __cplusplus
extern "C" {
#endif

typedef struct turbine_control {
    double speed;    /* filtered */
    double integral; /* of the speed's error, rad */
    double pitch, torque;
    double rate; /* of the pitch in the last step, rad/s */
} turbine_control;

extern const double turbine_gear, turbine_efficiency; /* 97; electrical power over that of the generator's shaft */

/* At rest with itself at a generator speed and pitch. */
void turbine_control_begin(turbine_control *control, double speed, double pitch);
/* One step: torque and pitch to hold for the next dt. speed: the generator's, measured now. */
void turbine_control_step(turbine_control *control, double speed, double dt);
/* The law of the torque: without filter and limit of rate. */
double turbine_torque(double speed, double pitch);

#ifdef __cplusplus
}
#endif

#endif
