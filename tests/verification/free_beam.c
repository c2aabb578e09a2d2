/* A beam set free, turning and moving, nothing acting on it: momenta, energy and the course of its centre of mass are
   exact statements about any free body. The momenta are those of the discrete beam, by its own mass matrix: M v is what
   the residual says of accelerations v at rest. Linear momentum: to rounding. Angular momentum and energy: the
   generalised-alpha method on the rotation group keeps them to second order in dt; the order is measured. */
#include "verification.h"

#include "member/body.h"
#include "member/structure.h"

enum { NODES = 8 };

/* Linear momentum and angular momentum about the origin */
static void momenta(const spar_member *b, double P[3], double L[3]) {
    double q[7 * NODES], v[6 * NODES], zero[6 * NODES] = {0}, f[6 * NODES], f0[6 * NODES], x[3 * NODES];
    assert_int_equal(spar_member_get_motion(b, q, v, NULL), SPAR_OK);
    assert_int_equal(spar_member_get_reference(b, x, NULL), SPAR_OK);
    spari_body_residual(b->body, q, zero, v, 0, f, NULL);
    spari_body_residual(b->body, q, zero, zero, 0, f0, NULL);
    for (int k = 0; k < 3; k++) {
        P[k] = L[k] = 0;
    }
    for (int i = 0; i < NODES; i++) {
        double at[3], force[3], c[3];
        for (int k = 0; k < 3; k++) {
            at[k] = x[3 * i + k] + q[7 * i + k];
            force[k] = f[6 * i + k] - f0[6 * i + k];
            P[k] += force[k];
        }
        spari_cross(at, force, c);
        for (int k = 0; k < 3; k++) {
            L[k] += c[k] + f[6 * i + 3 + k] - f0[6 * i + 3 + k];
        }
    }
}

typedef struct drift {
    double P, L, energy; /* largest, relative */
} drift;

static drift fly(double dt, double rho) {
    double K[36], M[36], e0[4], e[4], P0[3], L0[3], P[3], L[3];
    const double x0[3] = {5, 0, 0}, v0[3] = {0.3, -0.2, 0.5}, w[3] = {2, 3, 9};
    drift d = {0, 0, 0};
    spar_session *s = scene_session();
    scene_box(K, M);
    spar_member *b = scene_beam(s, "free", 1, NODES, 10, K, M);
    OK(s, spar_member_set_root(b, SPAR_ROOT_FREE));
    OK(s, spar_member_commit(b));
    OK(s, spar_member_set_initial_velocity(b, x0, v0, w));
    OK(s, spar_session_set_integrator(s, rho, 1));
    OK(s, spar_session_set_newton(s, 1e-13, 1e-13, 30));
    OK(s, spar_member_get_energy(b, 4, e0));
    momenta(b, P0, L0);
    for (int k = 0; k < (int)(0.5 / dt + 0.5); k++) {
        scene_run(s, dt, 1);
        OK(s, spar_member_get_energy(b, 4, e));
        momenta(b, P, L);
        double dp[3], dl[3];
        for (int i = 0; i < 3; i++) {
            dp[i] = P[i] - P0[i], dl[i] = L[i] - L0[i];
        }
        d.P = fmax(d.P, spari_norm(dp) / spari_norm(P0));
        d.L = fmax(d.L, spari_norm(dl) / spari_norm(L0));
        d.energy = fmax(d.energy, fabs(e[0] + e[1] - e0[0] - e0[1]) / e0[0]);
    }
    spar_session_destroy(&s);
    return d;
}

static void test_free_beam(void **state) {
    (void)state;
    const double rho[2] = {1, 0.8};
    for (int k = 0; k < 2; k++) {
        drift a = fly(2e-4, rho[k]), b = fly(1e-4, rho[k]);
        char what[64];
        snprintf(what, sizeof what, "rho_inf = %g: linear momentum, relative drift", rho[k]);
        verify(what, b.P, 0, 1e-9, "free body; Newton's residual, 5000 steps");
        snprintf(what, sizeof what, "rho_inf = %g: angular momentum, relative drift", rho[k]);
        verify(what, b.L, 0, 1e-6, "free body, second order");
        snprintf(what, sizeof what, "rho_inf = %g: energy, relative drift", rho[k]);
        verify(what, b.energy, 0, 1e-4, "free body, second order");
        snprintf(what, sizeof what, "rho_inf = %g: order of the angular momentum", rho[k]);
        verify(what, log2(a.L / b.L), 2, 0.2, "generalised-alpha");
    }
    verified();
}

VERIFICATION_MAIN("Free beam: momenta and energy", cmocka_unit_test(test_free_beam))
