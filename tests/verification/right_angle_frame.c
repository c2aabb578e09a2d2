/* Right-angle cantilever: Simo & Vu-Quoc, CMAME 66 (1988). Two legs of 10, clamp - elbow - tip, the elbow pushed out of
   the plane by 0 - 50 - 0 in two seconds. One beam of four elements, two a leg; at the elbow the node stands twice,
   with one place and two orientations. Table: converged solution of the exact equations, 5 decimals, 5e-6 apart on two
   meshes; 2e-5, and 5e-5 at 10 s, where smaller steps here change nothing in the sixth decimal. */
#include "verification.h"

enum { ELEMENTS = 4, NODES = 8, COUNT = ELEMENTS * NODES, ELBOW = 2 * NODES - 1, TIMES = 8 };

/* Gauss-Lobatto-Legendre nodes are spar's; any places on the line will do for a straight leg if the nodes are these. */
static void place(double *x, double *q) {
    static const double gll[NODES] = {-1,
                                      -0.871740148509606615337445761,
                                      -0.591700181433142302144510731,
                                      -0.209299217902478868768657260,
                                      0.209299217902478868768657260,
                                      0.591700181433142302144510731,
                                      0.871740148509606615337445761,
                                      1};
    for (int e = 0; e < ELEMENTS; e++) {
        for (int k = 0; k < NODES; k++) {
            int i = NODES * e + k;
            double at = 5 * (e % 2) + 2.5 * (1 + gll[k]);
            int second = e >= 2;
            x[3 * i] = second ? 10 : at, x[3 * i + 1] = second ? at : 0, x[3 * i + 2] = 0;
            q[4 * i] = second ? sqrt(0.5) : 1, q[4 * i + 1] = q[4 * i + 2] = 0, q[4 * i + 3] = second ? sqrt(0.5) : 0;
        }
    }
}

typedef struct history {
    double u[TIMES][2][3]; /* elbow, tip */
    double energy[2];      /* after unloading, and at the end */
} history;

static const double when[TIMES] = {1, 2, 3, 4, 5, 6, 8, 10};

static void run(double dt, double rho, history *h) {
    double K[36], M[36], x[3 * COUNT], q[7 * COUNT];
    const double eta = 0;
    scene_diagonal(K, 1e6, 1e6, 1e6, 1e3, 1e3, 1e3);
    scene_diagonal(M, 1, 1, 1, 20, 10, 10);
    place(x, q);
    spar_session *s = scene_session();
    spar_member *b;
    OK(s, spar_session_set_integrator(s, rho, 1));
    OK(s, spar_beam_create(s, "frame", ELEMENTS, NODES, &b));
    OK(s, spar_beam_set_nodes(b, COUNT, x, q));
    OK(s, spar_beam_set_sections(b, 1, &eta, K, M));
    OK(s, spar_member_commit(b));
    int n = 0, per_second = (int)(1 / dt + 0.5), next = 0;
    while (next < TIMES) {
        n++;
        double t = (double)n / per_second, load[6] = {0, 0, t < 1 ? 50 * t : fmax(100 - 50 * t, 0), 0, 0, 0}, e[4];
        OK(s, spar_member_set_load(b, ELBOW, SPAR_LOAD_DEAD, load));
        scene_run(s, 1.0 / per_second, 1);
        if (n % per_second == 0 && n / per_second == (int)when[next]) {
            OK(s, spar_member_get_motion(b, q, NULL, NULL));
            memcpy(h->u[next][0], q + 7 * ELBOW, 3 * sizeof *q);
            memcpy(h->u[next][1], q + 7 * (COUNT - 1), 3 * sizeof *q);
            for (int i = 0; i < 7; i++) {
                assert_true(q[7 * ELBOW + i] == q[7 * ELBOW + 7 + i]); /* one motion at the joint */
            }
            OK(s, spar_member_get_energy(b, 4, e));
            if (next == 1 || next == TIMES - 1) {
                h->energy[next > 1] = e[0] + e[1];
            }
            next++;
        }
    }
    spar_session_destroy(&s);
}

static void test_frame(void **state) {
    (void)state;
    const double table[TIMES][2][3] = {{{-0.05420, 0.02288, 0.95131}, {-0.00302, -0.02339, 0.05403}},
                                       {{-1.01111, 0.26739, 4.11525}, {0.10626, -0.69215, 0.06926}},
                                       {{-2.04912, 0.23966, 5.50167}, {0.78850, -1.06150, 1.50721}},
                                       {{-1.56439, -0.42766, 4.64207}, {0.44198, -0.70624, 3.50893}},
                                       {{-0.85179, -0.76427, 3.11142}, {-0.54068, -1.06247, 5.47940}},
                                       {{-0.57896, -0.77835, 2.54069}, {-1.22365, -1.81836, 6.91335}},
                                       {{-0.19389, -0.32683, 1.63332}, {0.02321, -2.64483, 7.96056}},
                                       {{-0.77237, 1.62879, -3.09597}, {0.00432, -1.97028, 4.46312}}};
    history h[3];
    double dt = verification_long() ? 1e-3 : 4e-3, worst[2] = {0, 0};
    for (int k = 0; k < 3; k++) {
        run(dt / (1 << k), 0.9, &h[k]);
    }
    for (int i = 0; i < TIMES; i++) {
        for (int j = 0; j < 2; j++) {
            double got[3];
            char what[64];
            for (int k = 0; k < 3; k++) {
                got[k] = richardson_3(h[0].u[i][j][k], h[1].u[i][j][k], h[2].u[i][j][k], 3);
                worst[0] = fmax(worst[0], fabs(h[1].u[i][j][k] - got[k]));
                worst[1] = fmax(worst[1], fabs(h[2].u[i][j][k] - got[k]));
            }
            snprintf(what, sizeof what, "t = %g: u of the %s", when[i], j ? "tip" : "elbow");
            verify_3(what, got, table[i][j], when[i] > 8 ? 5e-5 : 2e-5, "exact equations, 5 decimals");
        }
    }
    verify("order in dt", log2(worst[0] / worst[1]), 2, 0.15, "generalised-alpha");
    verify("energy at t = 2", richardson_3(h[0].energy[0], h[1].energy[0], h[2].energy[0], 3), 114.8800, 1e-3,
           "exact equations, 4 decimals");
    verify("energy at t = 10", richardson_3(h[0].energy[1], h[1].energy[1], h[2].energy[1], 3), 114.8800, 1e-3,
           "no load after 2 s, no damping");
    verified();
}

VERIFICATION_MAIN("Right-angle frame (Simo & Vu-Quoc 1988)", cmocka_unit_test(test_frame))
