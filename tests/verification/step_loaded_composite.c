/* Composite cantilever of Wang et al. (Wind Energy 20, 2017) loaded suddenly by F = 150 at the tip, and by 100 sin(10
   t). Tables: mesh- and time-converged solution (4 elements of 8 nodes, dt 5e-6; a finer mesh differs by 2e-4; the
   published 5-node curve at dt 0.005 is not converged). A sudden load excites every mode of the mesh: what the modes
   above the tenth do is noise of some 1e-4, and grows with time as phases drift; 4 elements of 8 nodes here too. Step:
   1e-3 of the swing up to 0.5 s, 3e-3 to 1 s. */
#include "verification.h"

typedef struct swing {
    double u[20][3];
    double defect; /* of the energy balance, relative */
} swing;

static void run(double dt, double end, double every, double rho, int sine, swing *out) {
    double K[36], M[36], load[6] = {0, 0, 150, 0, 0, 0}, e[4], q[7];
    spar_session *s = scene_session();
    scene_box(K, M);
    spar_member *b = scene_beam(s, "box", 4, 8, 10, K, M);
    OK(s, spar_member_commit(b));
    OK(s, spar_session_set_integrator(s, rho, 1));
    int per_sample = (int)(every / dt + 0.5), samples = (int)(end / every + 0.5), n = 0;
    out->defect = 0;
    for (int i = 0; i < samples; i++) {
        for (int k = 0; k < per_sample; k++) {
            n++;
            load[2] = sine ? 100 * sin(10 * n * dt) : 150;
            OK(s, spar_member_set_load(b, 31, SPAR_LOAD_DEAD, load));
            scene_run(s, dt, 1);
        }
        scene_tip(b, q);
        memcpy(out->u[i], q, sizeof out->u[i]);
        OK(s, spar_member_get_energy(b, 4, e));
        out->defect = fmax(out->defect, fabs(e[0] + e[1] - 150 * q[2]) / (150 * 2.3));
    }
    spar_session_destroy(&s);
}

static void test_step(void **state) {
    (void)state;
    const double table[20][3] = {
        {-0.03356, -0.00595, 0.7714}, {-0.24023, -0.12722, 2.0380}, {-0.28093, -0.33515, 2.1766},
        {-0.06638, -0.04748, 1.0740}, {-0.00275, 0.18113, 0.1064},  {-0.01896, -0.18002, 0.5387},
        {-0.19084, -0.06561, 1.8130}, {-0.29053, -0.14209, 2.2344}, {-0.09973, -0.31747, 1.2692},
        {-0.00705, 0.23839, 0.2476},  {-0.01194, 0.00814, 0.4496},  {-0.15922, -0.31820, 1.6210},
        {-0.30016, -0.00445, 2.2796}, {-0.12487, -0.21857, 1.4508}, {-0.00479, -0.04507, 0.2962},
        {-0.00828, 0.22123, 0.3199},  {-0.1305, -0.2575, 1.4705},   {-0.3147, -0.2561, 2.3084},
        {-0.1717, -0.0483, 1.7127},   {-0.0119, -0.0671, 0.4217}};
    swing got;
    run(verification_long() ? 1e-5 : 1e-4, 1, 0.05, 1, 0, &got);
    for (int i = 0; i < 20; i++) {
        char what[64];
        snprintf(what, sizeof what, "step load, t = %.2f: u", 0.05 * (i + 1));
        verify_3(what, got.u[i], table[i], (i < 10 ? 1e-3 : 3e-3) * 2.3, "exact equations, converged");
    }
    /* the load's work is kinetic and strain energy; rho_inf = 1 keeps it to second order in dt */
    verify("step load: energy - work, of the largest work", got.defect, 0, 2e-5, "energy theorem");
    verified();
}

static void test_sine(void **state) {
    (void)state;
    const double table[][2] = {{0.05, 0.10098619}, {0.10, 0.56245216},  {0.15, 1.16812241},  {0.20, 1.31091097},
                               {0.25, 0.73203139}, {0.30, -0.15818787}, {0.40, -0.73844634}, {0.50, -0.71038476}};
    swing r[2];
    run(5e-4, 0.5, 0.05, 0.9, 1, &r[0]);
    run(2.5e-4, 0.5, 0.05, 0.9, 1, &r[1]);
    for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
        char what[64];
        int at = (int)(table[i][0] / 0.05 + 0.5) - 1;
        snprintf(what, sizeof what, "100 sin(10 t), t = %.2f: u3", table[i][0]);
        verify(what, richardson(r[0].u[at][2], r[1].u[at][2]), table[i][1], 1e-5, "exact equations, converged");
    }
    verify("100 sin(10 t), t = 0.20: u1", richardson(r[0].u[3][0], r[1].u[3][0]), -0.10129745, 1e-5, "exact equations");
    verify("100 sin(10 t), t = 0.20: u2", richardson(r[0].u[3][1], r[1].u[3][1]), -0.10664188, 1e-5, "exact equations");
    verified();
}

VERIFICATION_MAIN("Composite cantilever, dynamic (Wang et al. 2017)", cmocka_unit_test(test_step),
                  cmocka_unit_test(test_sine))
