/* A cylinder in a stream, on a spring and damper in one direction. The fluid is a wake oscillator (Facchinetti, de
   Langre & Biolley, J. Fluids Struct. 19 (2004)), q'' + e w (q^2 - 1) q' + w^2 q = A y''/D with lift q C / 2, and the
   water's added mass; a flow solver would stand in its place. Printed: the amplitude over the speed, with lock-in. */
#include <math.h>
#include <spar/spar.h>
#include <spar/spar_coupling.h>
#include <spar/spar_structure.h>
#include <stdio.h>

static const double diameter = 0.05, rho = 1000, strouhal = 0.2, epsilon = 0.3, forcing = 12, lift0 = 0.3; /* SI */
static const double pi = 3.14159265358979323846, added = 1000 * 3.14159265358979323846 / 4 * 0.05 * 0.05;  /* kg/m */

typedef struct wake {
    spar_fluid *fluid;
    double speed, q, rate, q_new, rate_new;
} wake;

/* From t to t + dt with the cylinder's latest acceleration; the state moves on when the step begins anew. */
static int solve_wake(spar_session *session, double t, double dt, int iteration, void *context) {
    wake *w = context;
    double x[3], q[4], v[3], a[3];
    (void)session, (void)t;
    if (iteration == 0) {
        w->q = w->q_new, w->rate = w->rate_new;
    }
    int status = spar_fluid_pull_poses(w->fluid, SPAR_NODES_MOTION, 1, x, q, v, NULL, a, NULL);
    if (status != SPAR_OK) {
        return status;
    }
    double w0 = 2 * pi * strouhal * w->speed / diameter, r = w->rate;
    w->rate_new = r + dt * (forcing * a[1] / diameter - epsilon * w0 * (w->q * w->q - 1) * r - w0 * w0 * w->q);
    w->q_new = w->q + dt * w->rate_new;
    const double area = 0.5 * rho * w->speed * diameter, lift = 0.5 * area * w->speed * lift0 * w->q_new;
    const double push[3] = {0, lift - 2 * area * v[1] - added * a[1], 0}; /* lift, drag and added mass */
    return spar_fluid_push_forces(w->fluid, push, NULL);
}

static int run(double speed, double *amplitude) {
    const double x[3] = {0}, upright[4] = {1, 0, 0, 0}, m = 2 * added, k = 4 * pi * pi * 9 * (m + added); /* 3 Hz wet */
    const double mass[36] = {[0] = m, [7] = m, [14] = m, [21] = 1, [28] = 1, [35] = 1};
    const double stiffness[36] = {[7] = k}, damping[36] = {[7] = 0.002 * 2 * sqrt(k * m)};
    spar_session *s = NULL;
    spar_member *cylinder = NULL;
    spar_joint *spring = NULL;
    wake w = {NULL, speed, 0, 0, 0.1, 0};
    int status = spar_session_create(&s);
    if (status == SPAR_OK && (status = spar_rigid_create(s, "cylinder", x, upright, mass, &cylinder)) == SPAR_OK &&
        (status = spar_member_commit(cylinder)) == SPAR_OK &&
        (status = spar_spring_create(s, "spring", cylinder, 0, SPAR_FREE_Y, stiffness, damping, NULL, &spring)) ==
            SPAR_OK &&
        (status = spar_fluid_create(cylinder, "stream", &w.fluid)) == SPAR_OK &&
        (status = spar_fluid_set_motion_nodes(w.fluid, 1, x)) == SPAR_OK &&
        (status = spar_fluid_set_force_nodes(w.fluid, 1, x)) == SPAR_OK &&
        (status = spar_fluid_map(w.fluid)) == SPAR_OK) {
        status = spar_session_set_coupling(s, SPAR_COUPLING_IQN_ILS, 1e-9, 1e-6, 50); /* the water is heavy */
        status =
            status == SPAR_OK ? spar_session_solve_initial(s, 0.004, solve_wake, &w, NULL) : status; /* also at t = 0 */
    }
    *amplitude = 0;
    for (int i = 0; i < 10000 && status == SPAR_OK; i++) {
        double motion[6] = {0};
        status = spar_step(s, 0.004, solve_wake, &w, NULL);
        status = status == SPAR_OK ? spar_joint_get_motion(spring, motion, NULL, NULL) : status;
        *amplitude = i > 8000 ? fmax(*amplitude, fabs(motion[1]) / diameter) : 0;
    }
    if (status != SPAR_OK) {
        fprintf(stderr, "%s\n", spar_session_message(s));
    }
    spar_session_destroy(&s);
    return status;
}

int main(void) {
    printf("stream, U / (f D)   amplitude, A / D\n");
    for (double reduced = 3; reduced <= 9; reduced += 0.5) {
        double amplitude;
        if (run(reduced * 3 * diameter, &amplitude) != SPAR_OK) {
            return 1;
        }
        printf("%17.1f   %7.4f\n", reduced, amplitude);
    }
    return 0;
}
