/* Bathe & Bolourchi's 45-degree bend (IJNME 14, 1979): an arc of radius 100 in the x-y plane curving to -y, tip force
   600 along z. Converged solution of the exact beam equations on the true arc, with the rounded stiffness of the
   BeamDyn and Kynema-FMB decks, 13 digits. 15 nodes from 60 axis points: 1e-9 of the radius. */
#include "verification.h"

static const double pi = 3.14159265358979323846;

static void bend(int load_steps, int elements, int nodes, double q[7], double total[4]) {
    enum { N = 60 };
    double eta[N], xyz[3 * N], K[36], load[6] = {0, 0, 600, 0, 0, 0}, x[3 * 40], frame[4 * 40];
    for (int i = 0; i < N; i++) {
        double a = pi / 4 * i / (N - 1);
        eta[i] = (double)i / (N - 1);
        xyz[3 * i] = 100 * sin(a), xyz[3 * i + 1] = -100 * (1 - cos(a)), xyz[3 * i + 2] = 0;
    }
    scene_diagonal(K, 1e7, 4.16667e6, 4.16667e6, 8.333e5, 8.333e5, 8.333e5);
    spar_session *s = scene_session();
    spar_member *b;
    OK(s, spar_beam_create(s, "bend", elements, nodes, &b));
    OK(s, spar_beam_set_axis(b, N, eta, xyz, NULL));
    OK(s, spar_beam_set_sections(b, 1, eta, K, NULL));
    OK(s, spar_member_commit(b));
    OK(s, spar_member_set_load(b, elements * nodes - 1, SPAR_LOAD_DEAD, load));
    OK(s, spar_member_solve_static(b, load_steps));
    OK(s, spar_member_get_reference(b, x, frame));
    scene_tip(b, q);
    spari_quat_mul(q + 3, frame + 4 * (elements * nodes - 1), total);
    spar_session_destroy(&s);
}

static void test_bend(void **state) {
    (void)state;
    const double u[3] = {-23.5612967857147, 13.6050230096446, 53.4761081402819};
    const double turn[4] = {0.7833921165, -0.0617645868, -0.5441939641, -0.2938279378};
    double q[7], q10[7], q2[7], total[4];
    bend(1, 1, 15, q, total);
    verify_3("P = 600, 15 nodes: u", q, u, 1e-7, "exact equations, converged");
    for (int i = 0; i < 4; i++) {
        char what[64];
        snprintf(what, sizeof what, "P = 600, 15 nodes: quaternion %c", "wxyz"[i]);
        verify(what, total[0] < 0 ? -total[i] : total[i], turn[i], 1e-9, "exact equations, 10 digits");
    }
    verify("P = 600: u1 against BeamDyn's paper", q[0], -23.7, 0.003 * 53.4, "Wang 2015, 0.3 % of the deflection");
    verify("P = 600: u1 against Bathe & Bolourchi", q[0], -23.5, 0.003 * 53.4, "1979, 0.3 % of the deflection");
    verify("P = 600: u3 against Bathe & Bolourchi", q[2], 53.4, 0.003 * 53.4, "1979, 0.3 % of the deflection");
    /* the answer does not depend on the way: Newton ends below 1e-10 of the length */
    bend(10, 1, 15, q10, total);
    verify_3("P = 600, 10 load steps against 1", q10, q, 1e-10 * 78.5, "path independence");
    bend(1, 2, 12, q2, total);
    verify_3("P = 600, 2 elements of 12 nodes against 1", q2, q, 1e-8, "mesh independence");
    verified();
}

VERIFICATION_MAIN("45-degree bend (Bathe & Bolourchi)", cmocka_unit_test(test_bend))
