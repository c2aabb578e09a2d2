/* Unsteady state of a blade element: first-order lags, each exact for an input that is linear in time over the step.
   Independent of fluid and session.

   Dynamic inflow (Oye; in Snel and Schepers, ECN-C--94-107), with the quasi-steady induced velocity q:
     u + tau_1 u' = q + 0.6 tau_1 q',   w + tau_2 w' = u,
     tau_1 = 1.1 R / ((1 - 1.3 min(a, 0.5)) U),   tau_2 / tau_1 = 0.39 - 0.26 (r / R)^2 = s.
   This is w = A y_1 + B y_2 with two lags of q, tau_1 and tau_2, A = 0.4 / (1 - s), B = 1 - A.

   Thin airfoil (Theodorsen 1935, Wagner's function by Jones 1940): the effective downwash at three quarters of the
   chord is w (1 - A_1 - A_2) + A_1 y_1 + A_2 y_2,   y_i' = b_i (V / b) (w - y_i), with A = 0.165, 0.335, b_i = 0.0455,
   0.3, half chord b, speed V.

   Dynamic stall (Oye 1991): the flow is attached over the fraction f of the chord, f' = (V / (4 c)) (f_static - f), and
     cl = f cl_attached + (1 - f) cl_separated. */
#ifndef SPARI_UNSTEADY_H
#define SPARI_UNSTEADY_H

/* Rates are 1/s, at the end of the step; "quasi", "downwash", "target": inputs there. Doubles only: a fluid stores
   them as numbers per node. */
typedef struct spari_memory {
    double begun; /* effects (SPAR_AERO_*) whose numbers below come from the step before */
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

/* A time step; dt 0: the steady state of the input. */
typedef struct spari_passage {
    double dt;
    const spari_memory *was;
    spari_memory *is;
} spari_passage;

/* y' = (u - y) / tau over x = dt / tau, u from u0 to u1. */
double spari_lag(double y, double u0, double u1, double x);
/* Oye's rate 1 / tau_1 by the axial induction, the wind across the disc, and the rotor's radius. */
double spari_inflow_rate(double a, double wind, double radius);
/* Lagged induced velocity, axial and tangential. share: r / R. */
void spari_inflow_step(const spari_passage *step, double rate, double share, const double quasi[2], double lagged[2]);
/* rate: speed over half the chord. */
double spari_wake_step(const spari_passage *step, double rate, double downwash);
/* Attached fraction of the chord from the ratio of lift to attached lift, and the lift added per attached fraction. */
double spari_attached_part(double ratio);
double spari_attached_gain(double lift, double attached);
double spari_stall_step(const spari_passage *step, double rate, double target);

#endif
