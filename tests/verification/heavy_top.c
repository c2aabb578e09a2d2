/* Heavy top: Bruls, Cardona & Arnold, Mech. Mach. Theory 48 (2012). m 15, centre of mass at (0, 1, 0) of a body pinned
   at the origin, spin 150 about that axis. Solution by DOP853 to 1e-13 (energy 5435.6967908655 kept to 1e-11). Order 2
   of places, turns and pin forces is what the paper is about; extrapolated figures from dt 1e-4 and 5e-5, whose error
   of order dt^3 or dt^4 is a hundredth of the second-order one. */
#include "verification.h"

typedef struct top {
    double x[3], q[4], reaction[6], w1, energy;
} top;

static void spin(double dt, double rho, double end, top *out) {
    const double J[3] = {0.234375, 0.46875, 0.234375}, c[3] = {0, 1, 0}, w[3] = {0, 150, -4.61538}, zero[3] = {0, 0, 0},
                 g[3] = {0, 0, -9.81};
    double M[36], q[7], v[6], e[4], body[3];
    spar_session *s = scene_session();
    spar_member *r;
    scene_mass(M, 15, c, J);
    OK(s, spar_session_set_gravity(s, g));
    OK(s, spar_rigid_create(s, "top", zero, NULL, M, &r));
    OK(s, spar_member_set_root(r, SPAR_ROOT_PINNED));
    OK(s, spar_member_commit(r));
    OK(s, spar_member_set_initial_velocity(r, zero, zero, w));
    OK(s, spar_session_set_integrator(s, rho, 1));
    OK(s, spar_session_set_newton(s, 1e-13, 1e-13, 30));
    scene_run(s, dt, (int64_t)(end / dt + 0.5));
    OK(s, spar_member_get_motion(r, q, v, NULL));
    OK(s, spar_member_get_reaction(r, out->reaction));
    OK(s, spar_member_get_energy(r, 4, e));
    memcpy(out->q, q + 3, sizeof out->q);
    spari_rotate(q + 3, c, out->x);
    spari_rotate_back(q + 3, v + 3, body);
    out->w1 = body[0];
    out->energy = e[0] + e[2];
    spar_session_destroy(&s);
}

static void test_top(void **state) {
    (void)state;
    const double x[2][3] = {{-0.70246829705662, -0.02116518470183, -0.71140025765170},
                            {0.17334396409835, 0.64008859207049, -0.74849079113366}};
    const double q[2][4] = {{0.58456062406946, -0.70066289541216, 0.38432575302289, 0.14019307880049},
                            {0.7329439806797, -0.2782857193377, 0.53182461133408, -0.32017614273624}};
    const double w[2] = {-0.47105310174427, -0.82207810168484};
    for (int k = 0; k < 2; k++) {
        top a, b, c;
        double e[2] = {0, 0}, r[2] = {0, 0}, got[3];
        char what[64];
        spin(2e-4, 0.9, 0.5 * (k + 1), &a);
        spin(1e-4, 0.9, 0.5 * (k + 1), &b);
        spin(5e-5, 0.9, 0.5 * (k + 1), &c);
        for (int i = 0; i < 3; i++) {
            got[i] = richardson_3(a.x[i], b.x[i], c.x[i], 3);
            e[0] = fmax(e[0], fabs(b.x[i] - x[k][i])), e[1] = fmax(e[1], fabs(c.x[i] - x[k][i]));
            r[0] = fmax(r[0], fabs(a.reaction[i] - b.reaction[i])),
            r[1] = fmax(r[1], fabs(b.reaction[i] - c.reaction[i]));
        }
        snprintf(what, sizeof what, "t = %g: centre of mass", 0.5 * (k + 1));
        verify_3(what, got, x[k], 1e-7, "DOP853, 13 digits");
        double sign = spari_quat_dot(q[k], c.q) < 0 ? -1 : 1;
        for (int i = 0; i < 4; i++) {
            snprintf(what, sizeof what, "t = %g: quaternion %c", 0.5 * (k + 1), "wxyz"[i]);
            verify(what, sign * richardson_3(a.q[i], b.q[i], c.q[i], 3), q[k][i], 1e-7, "DOP853, 13 digits");
        }
        snprintf(what, sizeof what, "t = %g: body rate 1", 0.5 * (k + 1));
        verify(what, richardson_3(a.w1, b.w1, c.w1, 3), w[k], 1e-5, "DOP853, 13 digits");
        snprintf(what, sizeof what, "t = %g: order of the place", 0.5 * (k + 1));
        verify(what, log2(e[0] / e[1]), 2, 0.1, "Bruls, Cardona & Arnold 2012");
        snprintf(what, sizeof what, "t = %g: order of the pin force", 0.5 * (k + 1));
        verify(what, log2(r[0] / r[1]), 2, 0.1, "Bruls, Cardona & Arnold 2012");
        snprintf(what, sizeof what, "t = %g: energy", 0.5 * (k + 1));
        verify(what, richardson_3(a.energy, b.energy, c.energy, 3), 5435.6967908655, 1e-6, "DOP853");
    }
    verified();
}

VERIFICATION_MAIN("Heavy top (Bruls, Cardona & Arnold 2012)", cmocka_unit_test(test_top))
