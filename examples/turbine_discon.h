/* A controller from a shared library with the interface of GH Bladed (a function DISCON; ROSCO and the controllers of
   OpenFAST's decks have it): what the turbine measures goes in, demanded torque and pitch come out. One library a
   process. */
#ifndef TURBINE_DISCON_H
#define TURBINE_DISCON_H

#include "turbine_control.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What a controller is told, in SI units and rad. */
typedef struct turbine_measures {
    double t, dt;
    double pitch;           /* of all blades, */
    double root_moment[3];  /* at their roots, out of the rotor's plane, positive bending downwind, N m, */
    double in_plane[3];     /* and in it, positive about the shaft, N m */
    double generator_speed; /* at the fast shaft, rad/s */
    double rotor_speed;
    double torque, power;      /* of the generator, N m at the fast shaft; electrical, W */
    double wind;               /* at the hub, m/s */
    double azimuth;            /* of blade 1, rad, 0 up */
    double top_fore, top_side; /* accelerations of the tower's top, downwind and sideways, m/s^2 */
} turbine_measures;

typedef struct turbine_discon turbine_discon;

/* Opens the library and looks for the function DISCON.
     library, input: in, paths; input: the controller's own file, as DISCON.IN
     message: out, of size bytes, what went wrong
   Returns 0, or 1 with a message. */
int turbine_discon_open(const char *library, const char *input, turbine_discon **discon, char *message, int size);
/* One call of the controller. control: in, pitch and torque that it is told it had; out, what it demands, and the rate
   that leads there in dt. Returns 0, or 1 with a message: that of the controller, or why what it demands is refused. */
int turbine_discon_step(turbine_discon *discon, const turbine_measures *measures, turbine_control *control,
                        char *message, int size);
/* The last call, and the end of the library. NULL and a second call are legal. */
void turbine_discon_close(turbine_discon **discon);

#ifdef __cplusplus
}
#endif

#endif
