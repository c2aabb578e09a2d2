/* What happens to the turbine, and when: hard cases of a turbine's life in which the controller has no part. Pitch and
   generator torque are functions of time alone, so that runs with another dt are runs of the same case. */
#ifndef TURBINE_CASE_H
#define TURBINE_CASE_H

#ifdef __cplusplus
extern "C" {
#endif

enum {
    TURBINE_GUST = 0,          /* the controller's */
    TURBINE_PARKED = 1,        /* blades feathered, the brake on, in a gust */
    TURBINE_IDLING = 2,        /* blades feathered, the shaft free */
    TURBINE_PITCH_STEP = 3,    /* at full load the pitch goes up by 4 degrees */
    TURBINE_EMERGENCY_STOP = 4 /* at full load the grid is lost, and the blades go to feather */
};

typedef struct turbine_case {
    int kind;
    double begins;        /* s, of the pitch step and the stop */
    double pitch, torque; /* at the start, rad, and N m at the fast shaft */
} turbine_case;

/* TURBINE_* of a name; -1: there is none. */
int turbine_case_of(const char *name);
/* Wind, gust, rotor speed and pitch of a case, m/s, rev/min and degrees; not finite: the steady state of the wind. */
void turbine_case_defaults(int kind, double *wind, double *gust, double *rpm, double *pitch);
/* Pitch of the blades at time t, its rate and acceleration, rad. */
void turbine_case_pitch(const turbine_case *c, double t, double *pitch, double *rate, double *acceleration);
/* Torque of the generator at the fast shaft, N m. */
double turbine_case_torque(const turbine_case *c, double t);

#ifdef __cplusplus
}
#endif

#endif
