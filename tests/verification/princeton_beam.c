/* Princeton beam: Dowell & Traybar (1975); Bauchau et al., Multibody Syst. Dyn. 37 (2016). L 0.508, section 12.377 x
   3.2024 mm, dead tip load at an angle from the tall axis. Converged solution of the exact equations, printed to 1e-8 m
   and 1e-6 degrees; against ANSYS beams (Obrezkov et al., Nonlinear Dyn. 109, 2022, with another torsion constant) 0.1
   % in w and 1.5 % in v. */
#include "verification.h"

static const double pi = 3.14159265358979323846;

/* ux, v along the tall side, w along the thin side, twist in degrees */
static void princeton(double P, double degrees, double out[4]) {
    const double a = degrees * pi / 180, load[6] = {0, -P * cos(a), -P * sin(a), 0, 0, 0};
    double K[36], q[7], R[9];
    scene_diagonal(K, 2841908.71416, 903914.98542, 903914.98542, 3.103338276607787, 2.428734443353508,
                   36.27936354403289);
    spar_session *s = scene_session();
    spar_member *b = scene_beam(s, "princeton", 1, 14, 0.508, K, NULL);
    OK(s, spar_member_commit(b));
    OK(s, spar_member_set_load(b, 13, SPAR_LOAD_DEAD, load));
    OK(s, spar_member_solve_static(b, 1));
    scene_tip(b, q);
    spari_quat_matrix(q + 3, R);
    out[0] = q[0], out[1] = q[1], out[2] = q[2], out[3] = atan2(R[7], R[4]) * 180 / pi;
    spar_session_destroy(&s);
}

static void test_exact(void **state) {
    (void)state;
    const double table[][6] = {
        {4.448, 0, -0.00003391, -0.00535954, 0, 0},
        {4.448, 15, -0.00054378, -0.00521016, -0.02080109, -0.222721},
        {4.448, 30, -0.00191679, -0.00475107, -0.03994940, -0.382231},
        {4.448, 45, -0.00374689, -0.00396516, -0.05605519, -0.435960},
        {4.448, 60, -0.00552706, -0.00286221, -0.06812912, -0.373034},
        {4.448, 75, -0.00680012, -0.00150299, -0.07557150, -0.213517},
        {4.448, 90, -0.00725995, 0, -0.07808187, 0},
        {13.345, 0, -0.00030481, -0.01606514, 0, 0},
        {13.345, 45, -0.03036111, -0.01534226, -0.15658782, -3.484691},
        {13.345, 90, -0.05040568, 0, -0.20069291, 0},
    };
    const char *names[] = {"ux", "v", "w", "twist (deg)"};
    for (size_t k = 0; k < sizeof table / sizeof *table; k++) {
        double got[4];
        princeton(table[k][0], table[k][1], got);
        for (int i = 0; i < 4; i++) {
            char what[64];
            snprintf(what, sizeof what, "P = %g, %g deg: %s", table[k][0], table[k][1], names[i]);
            verify(what, got[i], table[k][2 + i], i < 3 ? 6e-9 : 6e-7, "exact equations, 8 decimals");
        }
    }
    verified();
}

static void test_ansys(void **state) {
    (void)state;
    const double v[] = {
        1.606423724e-2, 1.645825752e-2, 1.665873206e-2, 1.518618440e-2, 1.157837500e-2, 6.248967384e-3, 0};
    const double w[] = {0, 6.435812858e-2, 0.117735994, 0.156467239, 0.181861627, 0.196097131, 0.200677707};
    for (int k = 0; k < 7; k++) {
        double got[4];
        char what[64];
        princeton(13.345, 15 * k, got);
        snprintf(what, sizeof what, "P = 13.345, %d deg: v, ANSYS beam", 15 * k);
        verify(what, -got[1], v[k], 0.015 * v[k] + 1e-12, "Obrezkov et al. 2022, 1.5 %");
        snprintf(what, sizeof what, "P = 13.345, %d deg: w, ANSYS beam", 15 * k);
        verify(what, -got[2], w[k], 0.001 * w[6], "Obrezkov et al. 2022, 0.1 %");
    }
    verified();
}

VERIFICATION_MAIN("Princeton beam", cmocka_unit_test(test_exact), cmocka_unit_test(test_ansys))
