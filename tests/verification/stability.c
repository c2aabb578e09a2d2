/* Stability by eigenvalues of the small motions about a state. Columns: Beck, ZAMP 3 (1952): P L^2/EI = 20.05095, at
   the frequency 11.0155; Leipholz, Stability Theory (1970): q L^3/EI = 40.05; Beck's as roots of its characteristic
   equation, evaluated for this test to 7 digits. Slender: EA = GA = 1e7 EI/L^2. Rotor: Wright, Smith, Thresher & Wang,
   J. Appl. Mech. 49 (1982), Frobenius series; whirl of a round shaft in closed form. */
#include "verification.h"

enum { NODES = 12 };

static spar_member *slender(spar_session *s, int root, const double w[3]) {
    double K[36], M[36];
    scene_diagonal(K, 1e7, 1e7, 1e7, 1e4, 1, 1);
    scene_diagonal(M, 1, 1, 1, 2e-8, 1e-8, 1e-8);
    spar_member *b = scene_beam(s, "beam", 1, NODES, 1, K, M);
    OK(s, spar_member_set_root(b, root));
    OK(s, spar_member_set_initial_velocity(b, NULL, NULL, w));
    OK(s, spar_member_commit(b));
    return b;
}

/* The growth rate and frequency of the eigenvalue that grows most, of a column under a force at its tip or along it. */
static void column(int along, double force, double value[2]) {
    const double load[6] = {-force, 0, 0, 0, 0, 0}, eta = 0;
    double all[4][2];
    spar_session *s = scene_session();
    spar_member *b = slender(s, SPAR_ROOT_FIXED, NULL);
    if (along) {
        OK(s, spar_beam_set_line_load(b, SPAR_LOAD_FOLLOWER, 1, &eta, load));
    } else {
        OK(s, spar_member_set_load(b, NODES - 1, SPAR_LOAD_FOLLOWER, load));
    }
    OK(s, spar_member_solve_static(b, 1));
    OK(s, spar_member_solve_eigenvalues(b, 4, NULL, &all[0][0], NULL, NULL));
    memcpy(value, all[0], sizeof all[0]);
    for (int i = 1; i < 4; i++) {
        if (all[i][0] > value[0]) {
            memcpy(value, all[i], sizeof all[i]);
        }
    }
    spar_session_destroy(&s);
}

static double limit_of(int along, double low, double high, double *frequency) {
    double value[2];
    while (high - low > 1e-6 * low) {
        double middle = 0.5 * (low + high);
        column(along, middle, value);
        if (value[0] > 1e-3) {
            high = middle;
        } else {
            low = middle;
        }
    }
    column(along, high, value);
    *frequency = value[1];
    return 0.5 * (low + high);
}

static void test_columns(void **state) {
    (void)state;
    double frequency, limit = limit_of(0, 15, 25, &frequency);
    verify("Beck: flutter at P L^2/EI", limit, 20.05095, 2e-5 * 20.05, "Beck 1952");
    verify("Beck: frequency there", frequency, 11.0155, 1e-3, "Beck 1952");
    limit = limit_of(1, 35, 45, &frequency);
    verify("Leipholz: flutter at q L^3/EI", limit, 40.05, 0.005, "Leipholz 1970, 4 digits");
    verified();
}

static void test_blade(void **state) {
    (void)state;
    const double table[4][5] = {{1, 3.681646814, 22.181011151, 61.841762587, 3.5432363},
                                {4, 5.5850014209, 24.273349394, 63.966760493, 3.8977225},
                                {8, 9.2568376005, 29.995381892, 70.292962186, 4.6571496},
                                {12, 13.170150488, 37.603112331, 79.614478489, 5.4270493}};
    for (int k = 0; k < 4; k++) {
        const double w[3] = {0, 0, table[k][0]};
        spar_session *s = scene_session();
        spar_member *b = slender(s, SPAR_ROOT_DRIVEN, w);
        OK(s, spar_member_solve_static(b, 1));
        for (int i = 1; i < 5; i++) {
            const double shift[2] = {0, table[k][i]};
            double value[2];
            char what[64];
            OK(s, spar_member_solve_eigenvalues(b, 1, shift, value, NULL, NULL));
            (void)snprintf(what, sizeof what, "eta = %g: %s %d", table[k][0], i < 4 ? "flap" : "in plane",
                           i < 4 ? i : 1);
            verify(what, value[1], table[k][i], 2e-5 * table[k][i], "Frobenius series");
        }
        spar_session_destroy(&s);
    }
    verified();
}

static void test_shaft(void **state) {
    (void)state;
    for (double W = 1; W < 6; W += 2) { /* below and beyond the critical speed */
        const double w[3] = {W, 0, 0};
        double value[2][2];
        char what[64];
        spar_session *s = scene_session();
        spar_member *b = slender(s, SPAR_ROOT_DRIVEN, w);
        OK(s, spar_member_solve_eigenvalues(b, 2, NULL, &value[0][0], NULL, NULL));
        for (int i = 0; i < 2; i++) {
            (void)snprintf(what, sizeof what, "shaft, W = %g: %s", W, i ? "omega + W" : "|omega - W|");
            verify(what, value[i][1], i ? 3.5160152685 + W : fabs(3.5160152685 - W), 2e-5, "closed form");
        }
        spar_session_destroy(&s);
    }
    verified();
}

/* Three blades welded to a hub that a hinge against the ground drives: the flap of one, thrice; and a rod that its own
   centrifugal force stretches, x = sin(k s) / (k cos(k L)), k^2 = m W^2 / EA. */
static void test_rotor(void **state) {
    (void)state;
    const double table[2][3] = {{4, 5.5850014209, 24.273349394}, {12, 13.170150488, 37.603112331}};
    for (int k = 0; k < 2; k++) {
        const double x[3] = {0}, unit[4] = {1, 0, 0, 0}, c[3] = {0}, J[3] = {1, 1, 1}, third = 2 * acos(-1) / 3;
        const double rate[6] = {0, 0, 0, 0, 0, table[k][0]}, angle[6] = {0}, EA = 1e3, L = 1;
        double M[36], K[36], rod_M[36], q[7], s_k = table[k][0] / sqrt(EA);
        spar_session *s = scene_session();
        spar_member *hub = NULL, *b[3], *rod = NULL;
        spar_joint *j = NULL;
        char what[64];
        scene_mass(M, 1, c, J);
        OK(s, spar_rigid_create(s, "hub", x, unit, M, &hub));
        OK(s, spar_member_set_root(hub, SPAR_ROOT_FREE));
        OK(s, spar_member_commit(hub));
        OK(s, spar_joint_create(s, "shaft", hub, 0, NULL, 0, SPAR_FREE_RZ, &j));
        OK(s, spar_joint_set_driven(j, SPAR_FREE_RZ));
        OK(s, spar_joint_drive(j, angle, rate, NULL));
        for (int i = 0; i < 4; i++) {
            static const char *const name[4] = {"a", "b", "c", "rod"}, *const tie[4] = {"wa", "wb", "wc", "wr"};
            const double turn[4] = {cos(0.5 * third * i), 0, 0, sin(0.5 * third * i)};
            scene_diagonal(K, i < 3 ? 1e8 : EA, 1e8, 1e8, 1e3, 1, 1);
            scene_diagonal(rod_M, 1, 1, 1, 2e-8, 1e-8, 1e-8);
            spar_member *m = scene_beam(s, name[i], 1, 13, L, K, rod_M);
            OK(s, spar_member_set_placement(m, x, i < 3 ? turn : unit));
            OK(s, spar_member_set_root(m, SPAR_ROOT_FREE));
            OK(s, spar_member_commit(m));
            OK(s, spar_joint_create(s, tie[i], m, 0, hub, 0, 0, &j));
            *(i < 3 ? &b[i] : &rod) = m;
        }
        OK(s, spar_session_solve_static(s, 1, NULL, NULL, NULL));
        scene_tip(rod, q);
        (void)snprintf(what, sizeof what, "W = %g: tip of a rod on the hub", table[k][0]);
        verify(what, L + q[0], tan(s_k * L) / s_k, 1e-9, "closed form");
        for (int i = 1; i < 3; i++) {
            const double shift[2] = {0, table[k][i]};
            double value[3][2];
            OK(s, spar_member_solve_eigenvalues(b[0], 3, shift, &value[0][0], NULL, NULL));
            for (int blade = 0; blade < 3; blade++) {
                (void)snprintf(what, sizeof what, "rotor, W = %g: flap %d, %d of 3", table[k][0], i, blade + 1);
                verify(what, value[blade][1], table[k][i], 2e-5 * table[k][i], "Frobenius series");
            }
        }
        spar_session_destroy(&s);
    }
    verified();
}

VERIFICATION_MAIN("Stability by eigenvalues", cmocka_unit_test(test_columns), cmocka_unit_test(test_blade),
                  cmocka_unit_test(test_shaft), cmocka_unit_test(test_rotor))
