/* Angular momentum of a beam with a body welded to its root, found from the motion of the nodes alone: by the field of
   the beam (Lagrange sums of positions and quaternions) and its sections as rigid bodies, with a quadrature of its
   own. */
#include "scene.h"

#include <gsl/gsl_integration.h>

enum { P = 5, ELEMENTS = 2, NODES = P * ELEMENTS };

static const double upright[4] = {1, 0, 0, 0}, origin[3] = {0};

/* ---- the oracle ---- */

/* A section: mass m, centre c from the line, inertia J about the centre, in its own axes (those of the reference). */
typedef struct section {
    double m, c[3], J[3];
} section;

/* Momentum, linear and angular about the origin, of a section at x with velocity v, turned by q and turning with
   omega. */
static void add_section(const section *s, const double x[3], const double v[3], const double q[4],
                        const double omega[3], double weight, double p[6]) {
    double c[3], at[3], u[3], body[3], h[3];
    spari_rotate(q, s->c, c);
    spari_cross(omega, c, u);
    spari_rotate_back(q, omega, body);
    for (int k = 0; k < 3; k++) {
        at[k] = x[k] + c[k];
        u[k] = s->m * (u[k] + v[k]);
        body[k] *= s->J[k];
    }
    spari_rotate(q, body, body);
    spari_cross(at, u, h);
    for (int k = 0; k < 3; k++) {
        p[k] += weight * u[k];
        p[3 + k] += weight * (h[k] + body[k]);
    }
}

/* Lagrange's basis on the places x[n] of nodes along the reference. */
static void basis_at(int n, const double *x, double at, double *phi) {
    for (int l = 0; l < n; l++) {
        phi[l] = 1;
        for (int k = 0; k < n; k++) {
            phi[l] *= k == l ? 1 : (at - x[k]) / (x[l] - x[k]);
        }
    }
}

/* Place, velocity, turn and its rate of the beam's field: the quaternion is a sum of those of the nodes, qd = w q / 2.
 */
static void field_at(const double *phi, const double *X, const double *q, const double *v, double x[3], double rate[3],
                     double Q[4], double omega[3]) {
    double sum[4] = {0}, sum_rate[4] = {0}, back[4], spin[4], size = 0;
    memset(x, 0, 3 * sizeof *x);
    memset(rate, 0, 3 * sizeof *rate);
    for (int l = 0; l < P; l++) {
        const double w[4] = {0, v[6 * l + 3], v[6 * l + 4], v[6 * l + 5]};
        double qd[4];
        spari_quat_mul(w, q + 7 * l + 3, qd);
        for (int k = 0; k < 4; k++) {
            sum[k] += phi[l] * q[7 * l + 3 + k];
            sum_rate[k] += 0.5 * phi[l] * qd[k];
        }
        for (int k = 0; k < 3; k++) {
            x[k] += phi[l] * (X[3 * l + k] + q[7 * l + k]);
            rate[k] += phi[l] * v[6 * l + k];
        }
    }
    for (int k = 0; k < 4; k++) {
        size += sum[k] * sum[k];
    }
    spari_quat_conj(sum, back);
    spari_quat_mul(sum_rate, back, spin);
    for (int k = 0; k < 4; k++) {
        Q[k] = sum[k] / sqrt(size);
    }
    for (int k = 0; k < 3; k++) {
        omega[k] = 2 * spin[1 + k] / size;
    }
}

static void add_beam_momentum(const spar_member *b, const section *s, double p[6]) {
    enum { POINTS = 8 };
    double X[3 * NODES], q[7 * NODES], v[6 * NODES];
    assert_int_equal(spar_member_get_reference(b, X, NULL), SPAR_OK);
    assert_int_equal(spar_member_get_motion(b, q, v, NULL), SPAR_OK);
    gsl_integration_glfixed_table *rule = gsl_integration_glfixed_table_alloc(POINTS);
    for (int e = 0; e < ELEMENTS; e++) {
        double nodes[P], phi[P];
        for (int l = 0; l < P; l++) {
            nodes[l] = X[3 * (P * e + l)];
        }
        for (size_t i = 0; i < POINTS; i++) {
            double at, weight, x[3], rate[3], Q[4], omega[3];
            gsl_integration_glfixed_point(nodes[0], nodes[P - 1], i, &at, &weight, rule);
            basis_at(P, nodes, at, phi);
            field_at(phi, X + (ptrdiff_t)3 * P * e, q + (ptrdiff_t)7 * P * e, v + (ptrdiff_t)6 * P * e, x, rate, Q,
                     omega);
            add_section(s, x, rate, Q, omega, weight, p);
        }
    }
    gsl_integration_glfixed_table_free(rule);
}

static void add_body_momentum(const spar_member *b, const section *s, double p[6]) {
    double q[7], v[6];
    assert_int_equal(spar_member_get_motion(b, q, v, NULL), SPAR_OK);
    add_section(s, q, v, q + 3, v + 3, 1, p);
}

/* ---- the scene ---- */

/* A beam of 2 m along x, pinned at the origin, with a body welded to its root there, in space. */
typedef struct spinner {
    spar_session *s;
    spar_member *beam, *hub;
    section of_beam, of_hub;
} spinner;

static spinner make_spinner(const section *of_beam, const double omega[3]) {
    spinner t = {.s = scene_session(), .of_beam = *of_beam, .of_hub = {1, {0, 0, 0}, {0.3, 0.4, 0.5}}};
    double K[36], M[36], H[36];
    spar_joint *weld = NULL;
    OK(t.s, spar_session_set_integrator(t.s, 1, 1));
    scene_diagonal(K, 4e6, 4e6, 4e6, 500, 600, 700);
    scene_mass(M, of_beam->m, of_beam->c, of_beam->J);
    t.beam = scene_beam(t.s, "beam", ELEMENTS, P, 2, K, M);
    OK(t.s, spar_member_set_root(t.beam, SPAR_ROOT_PINNED));
    OK(t.s, spar_member_commit(t.beam));
    scene_mass(H, t.of_hub.m, t.of_hub.c, t.of_hub.J);
    OK(t.s, spar_rigid_create(t.s, "hub", origin, upright, H, &t.hub));
    OK(t.s, spar_member_commit(t.hub));
    OK(t.s, spar_joint_create(t.s, "weld", t.hub, 0, t.beam, 0, 0, &weld));
    OK(t.s, spar_member_set_initial_velocity(t.beam, origin, origin, omega));
    OK(t.s, spar_member_set_initial_velocity(t.hub, origin, origin, omega));
    return t;
}

static void momentum_of(const spinner *t, double p[6]) {
    memset(p, 0, 6 * sizeof *p);
    add_beam_momentum(t->beam, &t->of_beam, p);
    add_body_momentum(t->hub, &t->of_hub, p);
}

/* A couple on the tip and its opposite on the hub set it shaking for the first `until` seconds; one step. */
static void shake(const spinner *t, double size, double time, double until, double dt) {
    double part = time < until ? size : 0,
           couple[6] = {0, 0, 0, part * sin(50 * time), part * cos(24 * time), part * sin(26 * time)}, back[6];
    for (int k = 0; k < 6; k++) {
        back[k] = -couple[k];
    }
    OK(t->s, spar_member_set_load(t->beam, NODES - 1, SPAR_LOAD_DEAD, couple));
    OK(t->s, spar_member_set_load(t->hub, 0, SPAR_LOAD_DEAD, back));
    scene_run(t->s, dt, 1);
}

/* The largest change in half a second of the angular momentum, of which the couples give none. */
static double change_of_momentum(const section *of_beam, const double omega[3], double size) {
    const double dt = 0.0005;
    spinner t = make_spinner(of_beam, omega);
    double p0[6], worst = 0;
    momentum_of(&t, p0);
    for (int i = 1; i <= 1000; i++) {
        double p[6];
        shake(&t, size, i * dt, 0.25, dt);
        momentum_of(&t, p);
        for (int k = 3; k < 6; k++) {
            worst = fmax(worst, fabs(p[k] - p0[k]));
        }
    }
    spar_session_destroy(&t.s);
    return worst;
}

static const section plain = {1, {0, 0, 0}, {0.002, 0.001, 0.001}}, thick = {1, {0, 0.1, 0.05}, {0.03, 0.02, 0.01}};

/* The couples give no angular momentum: its change is the error of dt, 4e-4 of 20 kg m^2/s. Plain sections, and thick
   ones whose centre of mass is 0.11 m off the line; the beam rotates and is deflected by 0.1 m. */
static void test_momentum_stays(void **state) {
    (void)state;
    const double omega[3] = {0.3, 0.5, 3};
    NEAR(change_of_momentum(&plain, omega, 40), 0, 4e-4);
    NEAR(change_of_momentum(&thick, omega, 40), 0, 4e-4);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_momentum_stays)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
