/* The discretised member: forces against the energy they come from, the tangent against finite differences of the
   forces, invariance under rigid motion. Oracles: central differences (error h^2 + eps/h, so 1e-7 of the largest entry
   at h = 1e-5) and exact identities (1e-12). */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#include "math/basis.h"
#include "math/rotation.h"
#include "member/body.h"

#include <stdlib.h>
#include <string.h>

static double uniform(void) {
    return 2.0 * rand() / RAND_MAX - 1.0;
}

/* symmetric positive definite n x n */
static void random_spd(int n, double *a) {
    double b[36];
    for (int i = 0; i < n * n; i++) {
        b[i] = uniform();
    }
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < n; j++) {
            a[n * i + j] = i == j;
            for (int k = 0; k < n; k++) {
                a[n * i + j] += b[n * i + k] * b[n * j + k];
            }
        }
    }
}

/* elements of Jacobian 1.1 on the x axis (straight), or with random tangents at the points, random section properties
 */
static spari_body *random_body(int elements, int P, int points, int damped, int straight) {
    spari_body *b = spari_body_create(elements, P, elements * points, 1, damped, 1);
    double x[24], bary[24], gx[24], gw[24];
    spari_gll(P, x, NULL, bary);
    assert_int_equal(spari_gauss(points, gx, gw), 0);
    b->length = 2.0 * elements;
    b->gravity[0] = 0.3, b->gravity[1] = -1.2, b->gravity[2] = -9.0;
    for (int e = 0; e <= elements; e++) {
        b->first[e] = e * points;
    }
    for (int k = 0; k < elements * points; k++) {
        double bend = straight ? 0 : 0.3, t[3] = {1, bend * uniform(), bend * uniform()}, n = spari_norm(t), c[9];
        for (int i = 0; i < 3; i++) {
            b->tangent[3 * k + i] = t[i] / n;
        }
        b->weight[k] = gw[k % points] * 1.1;
        spari_lagrange(P, x, bary, gx[k % points], b->phi + k * P, b->dphi + k * P);
        for (int l = 0; l < P; l++) {
            b->dphi[k * P + l] /= 1.1;
        }
        random_spd(6, b->C + 36 * k);
        if (damped) {
            random_spd(6, b->D + 36 * k);
        }
        double *m = b->mass + 10 * k;
        m[0] = 2 + uniform();
        for (int i = 0; i < 3; i++) {
            m[1 + i] = 0.4 * uniform();
        }
        random_spd(3, c);
        m[4] = c[0], m[5] = c[1], m[6] = c[2], m[7] = c[4], m[8] = c[5], m[9] = c[8];
    }
    return b;
}

typedef struct state {
    double q[7 * 32], v[6 * 32], a[6 * 32], psi[3 * 32], tinv[9 * 32];
} state;

static void random_state(int n, double size, state *s) {
    for (int i = 0; i < n; i++) {
        double turn[3];
        for (int j = 0; j < 3; j++) {
            s->q[7 * i + j] = size * uniform();
            turn[j] = size * uniform();
            s->psi[3 * i + j] = 0.5 * uniform();
        }
        spari_quat_exp(turn, s->q + 7 * i + 3);
        spari_tangent_inverse(s->psi + 3 * i, s->tinv + 9 * i);
        for (int j = 0; j < 6; j++) {
            s->v[6 * i + j] = size * uniform();
            s->a[6 * i + j] = size * uniform();
        }
    }
}

/* moves degree of freedom d by h: q, and v, a with it as the integrator does */
static void disturb(const state *s, int d, double h, double cm, double cv, state *t) {
    int node = d / 6, k = d % 6;
    *t = *s;
    double x[6] = {0};
    if (k < 3) {
        t->q[7 * node + k] += h;
        x[k] = h;
    } else {
        double turn[3] = {0}, p[4];
        turn[k - 3] = h;
        spari_quat_exp(turn, p);
        spari_quat_mul(p, s->q + 7 * node + 3, t->q + 7 * node + 3);
        for (int i = 0; i < 3; i++) {
            x[3 + i] = s->tinv[9 * node + 3 * i + k - 3] * h;
        }
    }
    for (int i = 0; i < 6; i++) {
        t->v[6 * node + i] += cv * x[i];
        t->a[6 * node + i] += cm * x[i];
    }
}

static void check_tangent(int elements, int P, int damped, int gyroscopic, double cm, double cv) {
    spari_body *b = random_body(elements, P, P, damped, 0);
    int n = b->unique, N = 6 * n, m = 6 * P;
    state s, t;
    double *full = calloc((size_t)(N * N), sizeof *full), *S = calloc((size_t)(m * m), sizeof *S), r1[192], r2[192];
    b->gyroscopic = gyroscopic;
    random_state(n, 0.6, &s);
    for (int e = 0; e < elements; e++) {
        spari_body_tangent(b, e, s.q, s.v, s.a, 0.7, cm, cv, s.tinv, S);
        for (int i = 0; i < m; i++) {
            for (int j = 0; j < m; j++) {
                full[N * (6 * e * (P - 1) + i) + 6 * e * (P - 1) + j] += S[m * i + j];
            }
        }
    }
    double worst = 0, big = 0, h = 1e-5;
    for (int d = 0; d < N; d++) {
        disturb(&s, d, h, cm, cv, &t);
        spari_body_residual(b, t.q, t.v, t.a, 0.7, r1, NULL);
        disturb(&s, d, -h, cm, cv, &t);
        spari_body_residual(b, t.q, t.v, t.a, 0.7, r2, NULL);
        for (int i = 0; i < N; i++) {
            double fd = (r1[i] - r2[i]) / (2 * h);
            big = fmax(big, fabs(fd));
            worst = fmax(worst, fabs(fd - full[N * i + d]));
        }
    }
    if (!(worst < 1e-7 * big)) {
        print_error("elements %d P %d damped %d gyro %d cm %g cv %g: worst %g of %g\n", elements, P, damped, gyroscopic,
                    cm, cv, worst, big);
    }
    assert_true(worst < 1e-7 * big);
    free(full);
    free(S);
    spari_body_free(b);
}

static void test_tangent(void **unused) {
    (void)unused;
    check_tangent(1, 2, 0, 1, 0, 0);
    check_tangent(1, 4, 0, 1, 3, 0);
    check_tangent(1, 4, 0, 1, 3, 2);
    check_tangent(1, 4, 0, 0, 3, 2);
    check_tangent(1, 5, 1, 1, 0, 2);
    check_tangent(3, 4, 1, 1, 3, 2);
}

/* r . delta = d(strain energy - gravity work) for a virtual displacement of every node */
static void test_forces_are_the_gradient_of_the_energy(void **unused) {
    (void)unused;
    spari_body *b = random_body(2, 5, 6, 0, 0);
    state s, t;
    double r[192], e1[4], e2[4], h = 1e-5;
    random_state(b->unique, 0.6, &s);
    spari_body_residual(b, s.q, NULL, NULL, 1, r, NULL);
    for (int d = 0; d < 6 * b->unique; d++) {
        disturb(&s, d, h, 0, 0, &t);
        spari_body_energy(b, t.q, NULL, e1);
        disturb(&s, d, -h, 0, 0, &t);
        spari_body_energy(b, t.q, NULL, e2);
        double fd = (e1[1] + e1[2] - e2[1] - e2[2]) / (2 * h);
        assert_true(fabs(fd - r[d]) < 1e-7);
    }
    spari_body_free(b);
}

/* turning the state turns the forces and leaves the energies: 1e-12 of the largest force */
static void test_frame_indifference(void **unused) {
    (void)unused;
    spari_body *b = random_body(2, 5, 6, 1, 1);
    state s, t;
    double r[192], r2[192], e1[4], e2[4], psi[3] = {1.3, -2.2, 0.7}, p[4], big = 0, gll[24];
    random_state(b->unique, 0.6, &s);
    spari_body_residual(b, s.q, s.v, s.a, 0, r, NULL);
    spari_body_energy(b, s.q, s.v, e1);
    spari_quat_exp(psi, p);
    spari_gll(5, gll, NULL, NULL);
    t = s;
    for (int i = 0; i < b->unique; i++) {
        int e = i > 4, l = i - 4 * e;
        double x0[3] = {1.1 * (2 * e + 1 + gll[l]), 0, 0}, x[3];
        for (int j = 0; j < 3; j++) {
            x[j] = x0[j] + s.q[7 * i + j];
        }
        spari_rotate(p, x, x);
        for (int j = 0; j < 3; j++) {
            t.q[7 * i + j] = x[j] - x0[j];
        }
        spari_quat_mul(p, s.q + 7 * i + 3, t.q + 7 * i + 3);
        for (int k = 0; k < 6; k += 3) {
            spari_rotate(p, s.v + 6 * i + k, t.v + 6 * i + k);
            spari_rotate(p, s.a + 6 * i + k, t.a + 6 * i + k);
        }
    }
    spari_body_residual(b, t.q, t.v, t.a, 0, r2, NULL);
    spari_body_energy(b, t.q, t.v, e2);
    for (int i = 0; i < 6 * b->unique; i++) {
        big = fmax(big, fabs(r[i]));
    }
    for (int i = 0; i < 6 * b->unique; i += 3) {
        double f[3];
        spari_rotate(p, r + i, f);
        for (int j = 0; j < 3; j++) {
            assert_true(fabs(f[j] - r2[i + j]) < 1e-12 * big);
        }
    }
    assert_true(fabs(e1[0] - e2[0]) < 1e-12 * e1[0]);
    assert_true(fabs(e1[1] - e2[1]) < 1e-12 * e1[1]);
    assert_true(fabs(e1[3] - e2[3]) < 1e-12 * e1[3]);
    spari_body_free(b);
}

/* the power of the forces is the rate of kinetic and strain energy plus what is dissipated: central difference in time,
 * 1e-6 */
static void test_power_balance(void **unused) {
    (void)unused;
    spari_body *b = random_body(1, 5, 7, 1, 0);
    state s, t;
    double r[192], e0[4], e1[4], e2[4], h = 1e-5, power = 0, *out[2] = {e1, e2};
    memset(b->gravity, 0, sizeof b->gravity);
    random_state(b->unique, 0.6, &s);
    spari_body_residual(b, s.q, s.v, s.a, 0, r, NULL);
    spari_body_energy(b, s.q, s.v, e0);
    for (int i = 0; i < 6 * b->unique; i++) {
        power += r[i] * s.v[i];
    }
    for (int side = 0; side < 2; side++) {
        double dt = side ? -h : h;
        t = s;
        for (int i = 0; i < b->unique; i++) {
            double turn[3], p[4];
            for (int j = 0; j < 3; j++) {
                t.q[7 * i + j] += dt * s.v[6 * i + j] + 0.5 * dt * dt * s.a[6 * i + j];
                turn[j] = dt * s.v[6 * i + 3 + j] + 0.5 * dt * dt * s.a[6 * i + 3 + j];
            }
            spari_quat_exp(turn, p);
            spari_quat_mul(p, s.q + 7 * i + 3, t.q + 7 * i + 3);
            for (int j = 0; j < 6; j++) {
                t.v[6 * i + j] += dt * s.a[6 * i + j];
            }
        }
        spari_body_energy(b, t.q, t.v, out[side]);
    }
    double rate = (e1[0] + e1[1] - e2[0] - e2[1]) / (2 * h) + e0[3];
    assert_true(fabs(rate - power) < 1e-6 * fabs(power));
    spari_body_free(b);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_tangent),
        cmocka_unit_test(test_forces_are_the_gradient_of_the_energy),
        cmocka_unit_test(test_frame_indifference),
        cmocka_unit_test(test_power_balance),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
