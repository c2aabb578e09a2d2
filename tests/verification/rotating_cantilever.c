/* Frequencies of rotating cantilevers. Uniform: Southwell; Wright, Smith, Thresher & Wang, J. Appl. Mech. 49 (1982);
   Hodges & Rutkowski, AIAA J. 19 (1981); omega* = omega L^2 sqrt(m / EI) at eta = Omega L^2 sqrt(m / EI), by Frobenius
   series to 9 digits; in the plane omega^2 is less by eta^2. EA = GA = 1e7 EI/L^2 and rotary inertia 1e-8 m L^2 shift
   the modes by some 1e-6 and up to 1e-5, beyond that the stiffness matrix would lose the digits to rounding: 2e-5
   relative, a fifth of what is asked of a beam here. 16 nodes. With a tip swept in the plane: Epps & Chandra, AIAA J.
   34 (1996), experiment, 1 Hz and a tenth. */
#include "verification.h"

static const double pi = 3.14159265358979323846;

enum { NODES = 16, MODES = 8 };

static spar_member *rotor(spar_session *s, double eta) {
    double K[36], M[36];
    const double zero[3] = {0, 0, 0}, omega[3] = {0, 0, eta};
    scene_diagonal(K, 1e7, 1e7, 1e7, 1e3, 1, 1);
    scene_diagonal(M, 1, 1, 1, 2e-8, 1e-8, 1e-8);
    spar_member *b = scene_beam(s, "blade", 1, NODES, 1, K, M);
    OK(s, spar_member_set_root(b, SPAR_ROOT_DRIVEN));
    OK(s, spar_member_set_initial_velocity(b, zero, zero, omega));
    OK(s, spar_member_commit(b));
    return b;
}

static void test_uniform(void **state) {
    (void)state;
    const double table[10][5] = {{0, 3.5160152685, 22.034491565, 61.697214414, 3.5160153},
                                 {1, 3.681646814, 22.181011151, 61.841762587, 3.5432363},
                                 {2, 4.137319573, 22.614921957, 62.273184106, 3.621797},
                                 {3, 4.7972785324, 23.320263674, 62.984967481, 3.7435119},
                                 {4, 5.5850014209, 24.273349394, 63.966760493, 3.8977225},
                                 {5, 6.4495447486, 25.446080358, 65.205040522, 4.0738959},
                                 {6, 7.3603730193, 26.809081678, 66.683914382, 4.2632254},
                                 {8, 9.2568376005, 29.995381892, 70.292962186, 4.6571496},
                                 {10, 11.202327762, 33.640365854, 74.649294597, 5.0489749},
                                 {12, 13.170150488, 37.603112331, 79.614478489, 5.4270493}};
    for (int k = 0; k < 10; k++) {
        double f[MODES], shapes[MODES * NODES * 6], eta = table[k][0];
        int flap = 0, lag = 0;
        char what[64];
        spar_session *s = scene_session();
        spar_member *b = rotor(s, eta);
        OK(s, spar_member_solve_static(b, 1));
        OK(s, spar_member_solve_modes(b, MODES, f, shapes));
        for (int i = 0; i < MODES; i++) {
            const double *tip = shapes + 6 * (NODES * (i + 1) - 1);
            double got = 2 * pi * f[i];
            if (fabs(tip[2]) > fabs(tip[1]) && flap < 3) {
                flap++;
                snprintf(what, sizeof what, "eta = %g: flap %d", eta, flap);
                verify(what, got, table[k][flap], 2e-5 * table[k][flap], "Frobenius series, 9 digits");
            } else if (fabs(tip[1]) > fabs(tip[2]) && lag++ == 0) {
                snprintf(what, sizeof what, "eta = %g: in plane 1", eta);
                verify(what, got, table[k][4], 2e-5 * table[k][4], "Frobenius series, 8 digits");
            }
        }
        assert_int_equal(flap, 3);
        spar_session_destroy(&s);
    }
    verified();
}

/* In time: the blade turns at eta = 5 under a small tip force along the axis, which is let go. It swings in its first
   flap mode, with some hundredths of the others; mean over 20 swings. */
static void test_in_time(void **state) {
    (void)state;
    double load[6] = {0, 0, 1e-4, 0, 0, 0}, none[6] = {0}, q[7], dt = 2 * pi / 6.4495447486 / 200, last = 1, first = 0,
           end = 0;
    int passages = 0;
    spar_session *s = scene_session();
    OK(s, spar_session_set_integrator(s, 0.9, 1));
    spar_member *b = rotor(s, 5);
    OK(s, spar_member_set_load(b, NODES - 1, SPAR_LOAD_DEAD, load));
    OK(s, spar_member_solve_static(b, 1));
    OK(s, spar_member_set_load(b, NODES - 1, SPAR_LOAD_DEAD, none));
    for (int n = 1; passages < 21; n++) {
        double a = 5 * n * dt, root[7] = {0, 0, 0, cos(a / 2), 0, 0, sin(a / 2)}, v[6] = {0, 0, 0, 0, 0, 5};
        OK(s, spar_member_drive(b, root, v, none));
        scene_run(s, dt, 1);
        scene_tip(b, q);
        if (last < 0 && q[2] >= 0) {
            end = (n - q[2] / (q[2] - last)) * dt;
            first = passages++ == 0 ? end : first;
        }
        last = q[2];
    }
    verify("eta = 5: flap 1, in time", 2 * pi * 20 / (end - first), 6.4495447486, 1e-3 * 6.45,
           "20 swings, dt = T / 200");
    spar_session_destroy(&s);
    verified();
}

/* Epps & Chandra: aluminium, 31.5 in straight and 6 in swept back in the plane of rotation, hub 2.5 in */
static void test_swept_tip(void **state) {
    (void)state;
    const double rpm[3] = {0, 500, 750}, sweep[4] = {0, 15, 30, 45};
    const double table[3][3][4] = {{{1.4, 1.8, 1.7, 1.6}, {10.2, 10.1, 10.2, 10.2}, {14.8, 14.4, 14.9, 14.7}},
                                   {{10.3, 10.2, 10.4, 10.4}, {25.2, 25.2, 23.7, 21.6}, {36.1, 34.8, 30.7, 26.1}},
                                   {{27.7, 27.2, 26.6, 24.8}, {47.0, 44.4, 39.3, 35.1}, {62.9, 55.9, 48.6, 44.8}}};
    static const double gll[6] = {-1,
                                  -0.765055323929464692851003,
                                  -0.285231516480645096314150,
                                  0.285231516480645096314150,
                                  0.765055323929464692851003,
                                  1};
    double w = 1, h = 0.063, E = 1.06e7, nu = 0.325, rho = 2.51e-4, A = w * h, Iy = w * h * h * h / 12,
           Iz = h * w * w * w / 12, G = E / 2 / (1 + nu), K[36], M[36];
    scene_diagonal(K, E * A, G * A / 1.2000001839588001, G * A / 14.625127919304001, G * (Iy + Iz) / 65.85255016982444,
                   E * Iy, E * Iz);
    scene_diagonal(M, rho * A, rho * A, rho * A, rho * (Iy + Iz), rho * Iy, rho * Iz);
    for (int r = 0; r < 3; r++) {
        for (int a = 0; a < 4; a++) {
            enum { ELEMENTS = 4, COUNT = 6 * ELEMENTS };
            double x[3 * COUNT], q[4 * COUNT], f[8], shapes[8 * COUNT * 6], angle = -sweep[a] * pi / 180;
            const double eta = 0, zero[3] = {0, 0, 0}, omega[3] = {0, 0, rpm[r] * pi / 30};
            spar_session *s = scene_session();
            spar_member *b;
            for (int e = 0; e < ELEMENTS; e++) {
                for (int k = 0; k < 6; k++) {
                    int i = 6 * e + k, tip = e == ELEMENTS - 1;
                    double along = tip ? 31.5 : 10.5 * (e + 0.5 * (1 + gll[k])), beyond = tip ? 3 * (1 + gll[k]) : 0;
                    x[3 * i] = 2.5 + along + beyond * cos(angle), x[3 * i + 1] = beyond * sin(angle), x[3 * i + 2] = 0;
                    q[4 * i] = tip ? cos(angle / 2) : 1, q[4 * i + 1] = q[4 * i + 2] = 0,
                          q[4 * i + 3] = tip ? sin(angle / 2) : 0;
                }
            }
            OK(s, spar_beam_create(s, "blade", ELEMENTS, 6, &b));
            OK(s, spar_beam_set_nodes(b, COUNT, x, q));
            OK(s, spar_beam_set_sections(b, 1, &eta, K, M));
            OK(s, spar_member_set_root(b, SPAR_ROOT_DRIVEN));
            OK(s, spar_member_set_initial_velocity(b, zero, zero, omega));
            OK(s, spar_member_commit(b));
            OK(s, spar_member_solve_static(b, 1));
            OK(s, spar_member_solve_modes(b, 8, f, shapes));
            int flap = 0;
            for (int i = 0; i < 8 && flap < 3; i++) {
                const double *tip = shapes + 6 * (COUNT * (i + 1) - 1);
                if (fabs(tip[2]) > fabs(tip[1])) { /* out of the plane */
                    double expected = table[flap][r][a];
                    char what[96];
                    snprintf(what, sizeof what, "%g rpm, tip swept %g deg: mode %d (Hz)", rpm[r], sweep[a], ++flap);
                    verify(what, f[i], expected, fmax(1, 0.1 * expected), "Epps & Chandra, experiment, 1 Hz or 10 %");
                }
            }
            assert_int_equal(flap, 3);
            spar_session_destroy(&s);
        }
    }
    verified();
}

VERIFICATION_MAIN("Rotating cantilevers", cmocka_unit_test(test_uniform), cmocka_unit_test(test_in_time),
                  cmocka_unit_test(test_swept_tip))
