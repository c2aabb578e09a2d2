/* The turbine's state, shared by actuator.c and figures.c. */
#ifndef SPAR_ACTUATOR_MACHINE_H
#define SPAR_ACTUATOR_MACHINE_H

#include "actuator.h"
#include "turbine_control.h"
#include "turbine_model.h"
#include <stdio.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The model's wind blows along x. The host's frame is turned by `turned` about z: what comes in is turned back, what
   goes out is turned. */
struct actuator_machine {
    actuator_options options;
    spar_session *session;
    turbine model;
    turbine_control control;
    double angle, speed; /* of the rotor where they are given */
    double turned, c, s; /* rad; its cosine and sine */
    const float *velocity;
    int points;
    double *force;                     /* [blades][sections][3], at the end of the step */
    float *half, *spread;              /* [3][points]: half-way through the last part of the step, and their mean */
    double *axes;                      /* of a blade's sections */
    double *motion, *reference;        /* [nodes][7], [nodes][3] of a member */
    spar_fluid *point[TURBINE_BLADES]; /* the sections once more, for AMR-Wind's arrays by component */
    int iterations, parts;             /* of the last step */
    double unbalanced;                 /* W, mean of the last step */
    FILE *figures;                     /* NULL before the first step */
    char figures_path[1024], first_line[1024];
    int figures_keep;
    double figures_time;
    char message[512], warning[256];
};

#define TRY(call)                                                                                                      \
    do {                                                                                                               \
        int status_ = (call);                                                                                          \
        if (status_ != SPAR_OK) {                                                                                      \
            return status_;                                                                                            \
        }                                                                                                              \
    } while (0)

int actuator_say(actuator_machine *a, int status, const char *format, ...);
/* Where the hub is, and how far the rotor has turned since the reference, in the model's frame. */
int actuator_rotor_pose(actuator_machine *a, double place[3], double turn[4]);
void actuator_product(const double p[4], const double q[4], double out[4]);
void actuator_matrix(const double q[4], double axes[9]);

#ifdef __cplusplus
}
#endif

#endif
