/* What a blade element remembers of the steps before: first-order lags, each exact for an input that is linear in time
   over the step. Knows no fluid and no session.

   Dynamic inflow (Oye; in Snel and Schepers, ECN-C--94-107): with the quasi-steady induced velocity q,
     u + tau_1 u' = q + 0.6 tau_1 q',   w + tau_2 w' = u,
     tau_1 = 1.1 R / ((1 - 1.3 min(a, 0.5)) U),   tau_2 / tau_1 = 0.39 - 0.26 (r / R)^2 = s,
   which is w = A y_1 + B y_2 of two lags of q with tau_1 and tau_2, A = 0.4 / (1 - s), B = 1 - A.

   Thin airfoil (Theodorsen 1935, Wagner's function by Jones 1940): of the downwash w at three quarters of the chord
   acts w (1 - A_1 - A_2) + A_1 y_1 + A_2 y_2,   y_i' = b_i (V / b) (w - y_i), A = 0.165, 0.335, b_i = 0.0455, 0.3, half
   chord b, speed V.

   Dynamic stall (Oye 1991): the flow is attached over the part f of the chord, f' = (V / (4 c)) (f_static - f), and
     cl = f cl_attached + (1 - f) cl_separated. */
#ifndef SPARI_UNSTEADY_H
#define SPARI_UNSTEADY_H

/* Rates are 1/s, at the end of the step; "quasi", "downwash", "target": inputs there. Doubles only: a fluid keeps it as
   so many numbers a node. */
typedef struct spari_memory {
    double begun; /* effects (SPAR_AERO_*) whose numbers below are of the step before */
    struct {
        double rate, quasi[2], lag[2][2];
    } inflow;
    struct {
        double rate, downwash, lag[2];
    } wake;
    struct {
        double rate, target, part;
    } stall;
} spari_memory;
enum { SPARI_MEMORY_NUMBERS = sizeof(spari_memory) / sizeof(double) };

/* A step in time; dt 0: the steady state of what comes in. */
typedef struct spari_passage {
    double dt;
    const spari_memory *was;
    spari_memory *is;
} spari_passage;

/* y' = (u - y) / tau over x = dt / tau, u from u0 to u1. */
double spari_lag(double y, double u0, double u1, double x);
/* Oye's rate 1 / tau_1 by the axial induction, the wind across the disc, and the rotor's radius. */
double spari_inflow_rate(double a, double wind, double radius);
/* Induced velocity, axial and tangential. share: r / R. */
void spari_inflow_step(const spari_passage *step, double rate, double share, const double quasi[2], double lagged[2]);
/* rate: speed over half the chord. */
double spari_wake_step(const spari_passage *step, double rate, double downwash);
/* The part of the chord with attached flow by the lift in parts of that of attached flow, and how much lift more there
   is for each part more. */
double spari_attached_part(double ratio);
double spari_attached_gain(double lift, double attached);
double spari_stall_step(const spari_passage *step, double rate, double target);

#endif
