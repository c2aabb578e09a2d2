/* Fluids that are no CFD but behave like one, to try couplings on: pressure from a small elliptic equation by inner
   corrections of successive over-relaxation that start from where the last push left them, a state that goes from step
   to step, drag that the structure hardly answers, noise of a given size. Flows are linear but for the drag and the
   wake, so that an exact one (inner = 0) is known to the last digit.

   cylinder: diameter 1 on a spring across a stream of unit speed and density. Potential flow of the first harmonic in
             an annulus out to 20 radii (8 rings, logarithmic) carries the added mass; drag and damping by Morison's
             formula with the relative velocity; lift by the wake oscillator of Facchinetti, de Langre & Biolley (2004).
   channel:  a cantilever of length 1 is a wall of a channel of height 0.1, filled with an inviscid fluid of unit
             density with friction: rho/H (w'' + c w') = p_xx in 10 cells, driven by a pulse of pressure at the inlet.

   flag:     the channel's cantilever, far more slender, swings far: velocity and pressure count across it as it stands,
             a traction `drag` pulls along it; the pressure at the inlet is swing sin(2.6 pi t), which comes on within
             1 s (alone in the fluid the flag has 1 Hz).

   Local, serial, deterministic. No function writes or aborts. */
#ifndef FLOWS_H
#define FLOWS_H

#include <spar/spar.h>

enum { FLOW_CYLINDER = 0, FLOW_CHANNEL = 1, FLOW_FLAG = 2, FLOW_STEPS = 400, FLOW_OPTIONS = 8 };

typedef struct flow_case {
    int scene;
    double added; /* (added mass)/(mass) in the lowest mode */
    double noise; /* of each push, relative to its size */
    int inner;    /* corrections of the pressure in each push; 0: solved exactly */
    int tied;     /* joints hold the structure: the cylinder is a body on a joint's spring, the wall is welded to the
                     ground */
    double tip;   /* the wall's: mass of a body at its tip, over that of the wall; welded, or the end of one beam */
    double drag;  /* drag coefficient of the cylinder; 1.2 is a circular one's */
    double swing; /* of the flag's inlet */
    double angle; /* the whole cylinder scene is turned by so much about the span: no axis is the lift's */
    int ramp;     /* the stream starts over so many steps; 0: at once */
    int pushed;   /* loads are pushed at t = 0 */
    double dt;    /* 0: 0.05 */
    int steps;    /* at most FLOW_STEPS */
    int scheme, predictor, most; /* predictor -1: the library's; most 0: 50 iterations */
    double rtol;
    double omega;                        /* 0: the library's */
    double newton;                       /* relative tolerance; 0: the library's */
    const char *option[FLOW_OPTIONS][2]; /* keys and values, ends at NULL */
    int learn;                           /* stations at which the added mass is learned; 0: it is not */
    int response;                        /* SPAR_RESPONSE_*: what predicted loads of it answer to */
    int change_at, then, then_predictor; /* after so many steps, if not 0, another scheme and predictor */
    int fixed;                           /* so many iterations in each step, whatever the check says; 0: no */
    unsigned seed;
} flow_case;

typedef struct flow_result {
    int status, steps;  /* of the first step that failed, and steps accepted */
    char message[1000]; /* of the failure */
    double iterations;  /* mean over the steps accepted */
    int most;
    int unconverged;
    int warned;                  /* step (from 1) in which the log first warned of instability; 0: never */
    int complaints;              /* all warnings */
    double y[FLOW_STEPS];        /* m: of cylinder or tip, after each step */
    double force[FLOW_STEPS][2]; /* N: in flow and across, converged */
    double added[FLOW_STEPS];    /* reported added mass */
    int count[FLOW_STEPS];       /* iterations */
    int used, used_at;           /* learned added mass: in the equations at the end, and the first step after which */
    double spread;               /* of it, at the end */
    double predicted[2];         /* N: what the second step began with in the stream, and what it came to */
} flow_result;

/* Runs it; SPAR_OK also where steps failed (see the result), else a status of building the scene. */
int flow_run(const flow_case *c, flow_result *result);
/* Largest |a - b| over the steps both have made, over the largest |b|. */
double flow_distance(const flow_result *a, const flow_result *b);

#endif
