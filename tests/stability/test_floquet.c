/* Stability of periodic states: multipliers of the map over a period, by trials. The oracles integrate the linear
   equations of their own by Runge and Kutta. */
#include "scene.h"
#include "trials.h"

#include <complex.h>

static const double pi = 3.14159265358979323846;
static const double at_origin[3] = {0}, upright[4] = {1, 0, 0, 0};

/* ---- the oracle ---- */

enum { MOST = 8 };
typedef void (*linear_law)(const void *of, double t, const double *x, double *rate);

/* The map of x' = f(t) x over a period, [n][n], by 20000 steps of fourth order. */
static void map_of(int n, linear_law law, const void *of, double period, double A[MOST][MOST]) {
    const int steps = 20000;
    double h = period / steps;
    for (int k = 0; k < n; k++) {
        double x[MOST] = {0}, y[MOST], r[4][MOST];
        x[k] = 1;
        for (int i = 0; i < steps; i++) {
            law(of, i * h, x, r[0]);
            for (int stage = 1; stage < 4; stage++) {
                double part = stage == 3 ? h : 0.5 * h;
                for (int j = 0; j < n; j++) {
                    y[j] = x[j] + part * r[stage - 1][j];
                }
                law(of, i * h + part, y, r[stage]);
            }
            for (int j = 0; j < n; j++) {
                x[j] += h / 6 * (r[0][j] + 2 * r[1][j] + 2 * r[2][j] + r[3][j]);
            }
        }
        for (int j = 0; j < n; j++) {
            A[j][k] = x[j];
        }
    }
}

/* |det(A - mu)|, over the size of its terms: 0 where mu is a multiplier. */
static double off_spectrum(int n, double A[MOST][MOST], double complex mu) {
    double complex M[MOST][MOST], det = 1;
    double size = 1;
    for (int i = 0; i < n; i++) {
        double row = 0;
        for (int j = 0; j < n; j++) {
            M[i][j] = A[i][j] - (i == j ? mu : 0);
            row += fabs(A[i][j]);
        }
        size *= row + cabs(mu);
    }
    for (int k = 0; k < n; k++) {
        int p = k;
        for (int i = k; i < n; i++) {
            p = cabs(M[i][k]) > cabs(M[p][k]) ? i : p;
        }
        for (int j = 0; j < n; j++) {
            double complex x = M[k][j];
            M[k][j] = M[p][j], M[p][j] = x;
        }
        det *= M[k][k];
        for (int i = k + 1; i < n && cabs(M[k][k]) > 0; i++) {
            double complex f = M[i][k] / M[k][k];
            for (int j = k; j < n; j++) {
                M[i][j] -= f * M[k][j];
            }
        }
    }
    return cabs(det) / size;
}

static double complex multiplier_of(const double value[2], double period) {
    return cexp((value[0] + value[1] * I) * period);
}

/* ---- scenes ---- */

static spar_member *body_of(spar_session *s, const char *name, double m, int root) {
    const double c[3] = {0}, J[3] = {1, 1, 1};
    double M[36];
    spar_member *b = NULL;
    scene_mass(M, m, c, J);
    OK(s, spar_rigid_create(s, name, at_origin, upright, M, &b));
    OK(s, spar_member_set_root(b, root));
    return b;
}

typedef struct host {
    spar_member *hub;
    double W, height; /* it turns; or its place goes up and down */
    spar_fluid *air;
    double k, dk, c; /* spring of the air along y, its part that swings with W, and damper */
    spar_member *body;
    int calls;
} host;

static int drive(spar_session *s, double t, double dt, void *context) {
    const host *h = context;
    double end = t + dt, angle = h->height > 0 ? 0 : h->W * end, wave = h->W * end;
    const double q[7] = {0, 0, h->height * (cos(wave) - 1), cos(0.5 * angle), 0, 0, sin(0.5 * angle)};
    const double v[6] = {0, 0, -h->height * h->W * sin(wave), 0, 0, h->height > 0 ? 0 : h->W};
    const double a[6] = {0, 0, -h->height * h->W * h->W * cos(wave), 0, 0, 0};
    (void)s;
    return h->hub ? spar_member_drive(h->hub, q, v, a) : SPAR_OK;
}

static void run(spar_session *s, host *h, double dt, int64_t steps, int64_t from) {
    for (int64_t i = 0; i < steps; i++) {
        OK(s, drive(s, dt * (double)(from + i), dt, h));
        scene_run(s, dt, 1);
    }
}

/* ---- tests ---- */

/* A damped oscillator: lambda = -c/2m + i omega, whatever the period; by steps that keep all energy, right to dt^2. */
static void test_constant(void **state) {
    (void)state;
    const double m = 2, k = 50, c = 3, decay = -0.5 * c / m, omega = sqrt(k / m - decay * decay);
    double error[2][2];
    for (int fine = 0; fine < 2; fine++) {
        double spring[36], damper[36], value[2];
        int64_t steps = fine ? 80 : 40;
        spar_joint *j = NULL;
        spar_session *s = scene_session();
        spar_member *b = body_of(s, "b", m, SPAR_ROOT_FREE);
        scene_diagonal(spring, 0, k, 0, 0, 0, 0);
        scene_diagonal(damper, 0, c, 0, 0, 0, 0);
        OK(s, spar_joint_create(s, "j", b, 0, NULL, 0, SPAR_FREE_Y, &j));
        OK(s, spar_joint_set_spring(j, spring, damper, NULL));
        OK(s, spar_member_commit(b));
        OK(s, spar_session_set_integrator(s, 1, 1));
        OK(s, trial_floquet(s, 0.5 / (double)steps, steps, 0, NULL, NULL, NULL, 1, 1, value));
        error[fine][0] = value[0] - decay;
        error[fine][1] = value[1] - omega;
        spar_session_destroy(&s);
    }
    for (int i = 0; i < 2; i++) {
        assert_true(fabs(error[1][i]) < 5e-3);
        NEAR(error[0][i] / error[1][i], 4, 0.1);
    }
}

typedef struct hill {
    double g, l, height, W;
} hill;

static void pendulum(const void *of, double t, const double *x, double *rate) {
    const hill *p = of;
    rate[0] = x[1];
    rate[1] = -(p->g - p->height * p->W * p->W * cos(p->W * t)) / p->l * x[0];
}

/* A pendulum whose pivot goes up and down (Mathieu): l x'' + (g - a W^2 cos W t) x = 0. Within the tongue of W = 2
   sqrt(g/l) it grows, with half the frequency of the pivot; beside it not; and upside down it stands where the pivot is
   fast enough (Kapitza: a W > sqrt(2 g l)), and falls where not. Against the exact multipliers, right to dt^2. */
static void test_mathieu(void **state) {
    (void)state;
    const hill cases[4] = {{9, 1, 0.1, 6}, {9, 1, 0.1, 7.5}, {-9, 1, 0.1, 55}, {-9, 1, 0.1, 30}};
    for (int i = 0; i < 4; i++) {
        const hill *p = cases + i;
        double A[MOST][MOST], period = 2 * pi / p->W, error[2];
        map_of(2, pendulum, p, period, A);
        double trace = A[0][0] + A[1][1];
        double complex root = csqrt(0.25 * trace * trace - 1);
        double complex exact = 0.5 * trace + (trace < 0 ? -root : root); /* the larger one, det = 1 */
        for (int fine = 0; fine < 2; fine++) {
            const double arm[3] = {0, 0, p->g > 0 ? -p->l : p->l}, J[3] = {1e-9, 1e-9, 1e-9},
                         g[3] = {0, 0, -fabs(p->g)};
            double M[36], value[2];
            int64_t steps = fine ? 400 : 200;
            host h = {.W = p->W, .height = p->height};
            spar_joint *j = NULL;
            spar_member *bob = NULL;
            spar_session *s = scene_session();
            h.hub = body_of(s, "pivot", 1, SPAR_ROOT_DRIVEN);
            scene_mass(M, 1, arm, J);
            OK(s, spar_rigid_create(s, "bob", at_origin, upright, M, &bob));
            OK(s, spar_member_set_root(bob, SPAR_ROOT_FREE));
            OK(s, spar_joint_create(s, "hinge", bob, 0, h.hub, 0, SPAR_FREE_RX, &j));
            OK(s, spar_member_commit(h.hub));
            OK(s, spar_member_commit(bob));
            OK(s, spar_session_set_gravity(s, g));
            OK(s, spar_session_set_integrator(s, 1, 1));
            run(s, &h, period / (double)steps, steps, 0);
            OK(s, trial_floquet(s, period / (double)steps, steps, 0, drive, NULL, &h, 1, 1, value));
            error[fine] = cabs(multiplier_of(value, period) - (creal(exact) + fabs(cimag(exact)) * I));
            assert_true((value[0] > 1e-2) == (i == 0 || i == 3));
            if (i == 0) {
                NEAR(value[1], 0.5 * p->W, 1e-6);
            }
            spar_session_destroy(&s);
        }
        assert_true(error[1] < 2e-3 * cabs(exact));
        NEAR(error[0] / error[1], 4, 0.6);
    }
}

typedef struct rotor {
    double m, k[2], ground, c, W;
} rotor;

/* In axes that stand: m r'' + c r' + (R diag(k) R^T + diag(ground, 0)) r = 0, R the turn with W. */
static void unlike_shaft(const void *of, double t, const double *x, double *rate) {
    const rotor *p = of;
    double cs = cos(p->W * t), sn = sin(p->W * t), u = cs * x[0] + sn * x[1], w = -sn * x[0] + cs * x[1];
    rate[0] = x[2], rate[1] = x[3];
    rate[2] = -(cs * p->k[0] * u - sn * p->k[1] * w + p->ground * x[0] + p->c * x[2]) / p->m;
    rate[3] = -(sn * p->k[0] * u + cs * p->k[1] * w + p->c * x[3]) / p->m;
}

/* A body on a shaft that is stiffer one way than the other, as a rotor of two blades is, and that the ground springs
   one way: no frame has constant coefficients, and eigenvalues are refused. All four multipliers, stable and not. */
static void test_unlike_shaft(void **state) {
    (void)state;
    for (int i = 0; i < 2; i++) {
        const rotor p = {2, {30, 70}, 40, 0.4, i ? 6.2 : 2.0};
        double A[MOST][MOST], period = 2 * pi / p.W, worst[2] = {0};
        map_of(4, unlike_shaft, &p, period, A);
        for (int fine = 0; fine < 2; fine++) {
            double shaft[36], spring[36], damper[36], value[2][2], before[7], after[7];
            int64_t steps = fine ? 400 : 200;
            const double w[3] = {0, 0, p.W};
            host h = {.W = p.W};
            spar_joint *j = NULL, *ground = NULL;
            spar_session *s = scene_session();
            h.hub = body_of(s, "hub", 1, SPAR_ROOT_DRIVEN);
            spar_member *b = body_of(s, "b", p.m, SPAR_ROOT_FREE);
            OK(s, spar_member_set_initial_velocity(h.hub, NULL, NULL, w));
            OK(s, spar_member_set_initial_velocity(b, NULL, NULL, w));
            scene_diagonal(shaft, p.k[0], p.k[1], 0, 0, 0, 0);
            scene_diagonal(spring, p.ground, 0, 0, 0, 0, 0);
            scene_diagonal(damper, p.c, p.c, 0, 0, 0, 0);
            OK(s, spar_joint_create(s, "shaft", b, 0, h.hub, 0, SPAR_FREE_X | SPAR_FREE_Y, &j));
            OK(s, spar_joint_set_spring(j, shaft, NULL, NULL));
            OK(s, spar_joint_create(s, "ground", b, 0, NULL, 0, 63, &ground));
            OK(s, spar_joint_set_spring(ground, spring, damper, NULL));
            OK(s, spar_member_commit(h.hub));
            OK(s, spar_member_commit(b));
            OK(s, spar_session_set_integrator(s, 1, 1));
            run(s, &h, period / (double)steps, steps, 0);
            REFUSED(s, SPAR_ERR_UNSUPPORTED, "is not isotropic",
                    spar_member_solve_eigenvalues(b, 1, NULL, value[0], NULL, NULL));
            scene_tip(b, before);
            OK(s, trial_floquet(s, period / (double)steps, steps, 0, drive, NULL, &h, 2, 2, value[0]));
            scene_tip(b, after);
            assert_memory_equal(before, after, sizeof before); /* to the bit */
            assert_true(value[0][0] >= value[1][0]);
            assert_true((value[0][0] > 0) == i);
            for (int k = 0; k < 2; k++) {
                worst[fine] = fmax(worst[fine], off_spectrum(4, A, multiplier_of(value[k], period)));
            }
            spar_session_destroy(&s);
        }
        assert_true(worst[1] < 1e-4);
        NEAR(worst[0] / worst[1], 4, 0.6);
    }
}

/* The fluid's spring swings: y'' + c y' + (k + dk cos W t) y = 0, all of it loads. */
static void blown(const void *of, double t, const double *x, double *rate) {
    const host *h = of;
    rate[0] = x[1];
    rate[1] = -(h->k + h->dk * cos(h->W * t)) * x[0] - h->c * x[1];
}

static int blow(spar_session *s, double t, double dt, int iteration, void *context) {
    host *h = context;
    double q[7], v[6];
    (void)dt, (void)iteration;
    h->calls++;
    OK(s, spar_member_get_motion(h->body, q, v, NULL));
    const double f[3] = {0, -(h->k + h->dk * cos(h->W * t)) * q[1] - h->c * v[1], 0}, m[3] = {0};
    return spar_fluid_push_forces(h->air, f, m);
}

static void test_fluid(void **state) {
    (void)state;
    host h = {.W = 6, .k = 9, .dk = 3, .c = 0.2};
    double A[MOST][MOST], period = 2 * pi / h.W, worst[2];
    map_of(2, blown, &h, period, A);
    for (int fine = 0; fine < 2; fine++) {
        double value[2];
        int64_t steps = fine ? 200 : 100;
        spar_joint *j = NULL;
        spar_session *s = scene_session();
        h.body = body_of(s, "b", 1, SPAR_ROOT_FREE);
        OK(s, spar_joint_create(s, "rail", h.body, 0, NULL, 0, SPAR_FREE_Y, &j));
        OK(s, spar_member_commit(h.body));
        OK(s, spar_fluid_create(h.body, "air", &h.air));
        OK(s, spar_fluid_set_force_nodes(h.air, 1, at_origin));
        OK(s, spar_fluid_map(h.air));
        OK(s, spar_session_set_integrator(s, 1, 1));
        OK(s, spar_session_set_coupling(s, SPAR_COUPLING_IQN_ILS, 1e-14, 1e-12, 50));
        OK(s, trial_floquet(s, period / (double)steps, steps, 0, NULL, blow, &h, 1, 1, value));
        assert_true(value[0] > 0.1); /* dk is large enough for c */
        worst[fine] = off_spectrum(2, A, multiplier_of(value, period));
        spar_session_destroy(&s);
    }
    assert_true(worst[1] < 1e-3);
    NEAR(worst[0] / worst[1], 4, 0.6);
}

/* A turning blade, whose coefficients are constant as seen from it: its multipliers are those of its eigenvalues, with
   frequencies up to multiples of W and their sign. */
static void test_blade(void **state) {
    (void)state;
    enum { N = 6, STEPS = 400 };
    const double W[3] = {0, 0, 4}, dt = 2 * pi / W[2] / STEPS;
    double K[36], M[36], value[3][2], floquet[6][2];
    spar_session *s = scene_session();
    host h = {.W = W[2]};
    scene_diagonal(K, 1e4, 1e4, 1e4, 1e2, 1, 2);
    scene_diagonal(M, 1, 1, 1, 2e-4, 1e-4, 1e-4);
    h.hub = scene_beam(s, "blade", 1, N, 1, K, M);
    OK(s, spar_member_set_root(h.hub, SPAR_ROOT_DRIVEN));
    OK(s, spar_beam_set_damping(h.hub, (const double[6]){0.01, 0.01, 0.01, 0.01, 0.01, 0.01}));
    OK(s, spar_member_set_initial_velocity(h.hub, NULL, NULL, W));
    OK(s, spar_member_commit(h.hub));
    OK(s, spar_member_solve_static(h.hub, 1));
    OK(s, spar_member_solve_eigenvalues(h.hub, 2, NULL, &value[0][0], NULL, NULL));
    OK(s, trial_floquet(s, dt, STEPS, 0, drive, NULL, &h, 6, 2, &floquet[0][0]));
    for (int i = 0; i < 2; i++) {
        double best = INFINITY;
        for (int k = 0; k < 2; k++) {
            double apart = fabs(remainder(value[i][1], W[2])) - floquet[k][1];
            best = fmin(best, hypot(apart, value[i][0] - floquet[k][0]));
        }
        NEAR(best, 0, 2e-3 * hypot(value[i][0], value[i][1]));
    }
    spar_session_destroy(&s);
}

/* ---- a rotor of two blades on a soft support ---- */

enum { TURN = 160 };
static const double rotor_speed = 5;

typedef struct two_blades {
    spar_session *s;
    spar_member *nacelle, *blade[2];
    spar_joint *shaft, *support;
} two_blades;

static int turn_shaft(spar_session *s, double t, double dt, void *context) {
    const two_blades *r = context;
    const double angle[6] = {0, 0, 0, 0, 0, rotor_speed * (t + dt)}, rate[6] = {0, 0, 0, 0, 0, rotor_speed};
    (void)s;
    return spar_joint_drive(r->shaft, angle, rate, NULL);
}

/* Stiff blades on hinges in the plane of rotation, the axis along z, gravity across it, a nacelle that is softer one
 * way. */
static void make_two_blades(two_blades *r) {
    const double c[3] = {0.9, 0, 0}, J[3] = {0.01, 0.3, 0.3}, g[3] = {0, -9.81, 0}, w[3] = {0, 0, rotor_speed};
    double M[36], spring[36], damper[36];
    spar_session *s = r->s = scene_session();
    spar_member *hub = body_of(s, "hub", 1, SPAR_ROOT_FREE);
    r->nacelle = body_of(s, "nacelle", 12, SPAR_ROOT_FREE);
    OK(s, spar_member_set_initial_velocity(hub, NULL, NULL, w));
    OK(s, spar_joint_create(s, "support", r->nacelle, 0, NULL, 0, SPAR_FREE_X | SPAR_FREE_Y, &r->support));
    scene_diagonal(spring, 900, 1500, 0, 0, 0, 0);
    scene_diagonal(damper, 12, 12, 0, 0, 0, 0);
    OK(s, spar_joint_set_spring(r->support, spring, damper, NULL));
    OK(s, spar_joint_create(s, "shaft", hub, 0, r->nacelle, 0, SPAR_FREE_RZ, &r->shaft));
    OK(s, spar_joint_set_driven(r->shaft, SPAR_FREE_RZ));
    OK(s, spar_member_commit(r->nacelle));
    OK(s, spar_member_commit(hub));
    scene_mass(M, 1.5, c, J);
    for (int i = 0; i < 2; i++) {
        const double x[3] = {i ? -0.2 : 0.2, 0, 0}, q[4] = {i ? 0 : 1, 0, 0, i ? 1 : 0};
        spar_joint *hinge = NULL;
        OK(s, spar_rigid_create(s, i ? "blade 2" : "blade 1", x, q, M, &r->blade[i]));
        OK(s, spar_member_set_root(r->blade[i], SPAR_ROOT_FREE));
        OK(s, spar_member_set_initial_velocity(r->blade[i], NULL, NULL, w));
        OK(s, spar_joint_create(s, i ? "lag 2" : "lag 1", r->blade[i], 0, hub, 0, SPAR_FREE_RZ, &hinge));
        OK(s, spar_joint_set_frame(hinge, x, upright));
        scene_diagonal(spring, 0, 0, 0, 0, 0, 20);
        scene_diagonal(damper, 0, 0, 0, 0, 0, 0.8);
        OK(s, spar_joint_set_spring(hinge, spring, damper, NULL));
        OK(s, spar_member_commit(r->blade[i]));
    }
    OK(s, spar_session_set_gravity(s, g));
    OK(s, spar_session_set_integrator(s, 0.8, 1));
}

static void turn_on(two_blades *r, int from, int turns) {
    const double dt = 2 * pi / rotor_speed / TURN;
    for (int i = from * TURN; i < (from + turns) * TURN; i++) {
        OK(r->s, turn_shaft(r->s, dt * i, dt, r));
        scene_run(r->s, dt, 1);
    }
}

/* Where it is after each turn: the nacelle, and a blade. */
static void see_two_blades(const two_blades *r, double y[2]) {
    double q[7];
    scene_tip(r->nacelle, q);
    y[0] = q[0];
    scene_tip(r->blade[0], q);
    y[1] = q[3] * q[6]; /* whatever the sign of the quaternion */
}

/* Under its weight the rotor swings with its turns; let go from there with a kick, its way back is that of the least
   damped multipliers: y_(k+2) = (mu + mu*) y_(k+1) - |mu|^2 y_k of its difference from a run that was not kicked, once
   the others have gone. Both are of the same steps: the same to what is left of the others, and of the amplitude. */
static void test_two_blades(void **state) {
    (void)state;
    enum { SETTLE = 60, GONE = 45, WATCH = 7 };
    const double dt = 2 * pi / rotor_speed / TURN, period = dt * TURN, kick[6] = {1e-1, 2e-1, 0, 0, 0, 0};
    const double none[6] = {0};
    double value[4][2], y[WATCH][2], before[7], after[7], a11 = 0, a12 = 0, a22 = 0, b1 = 0, b2 = 0;
    two_blades run[2];
    for (int k = 0; k < 2; k++) {
        make_two_blades(&run[k]);
        turn_on(&run[k], 0, SETTLE);
    }
    spar_session *s = run[0].s;
    scene_tip(run[0].blade[1], before);
    OK(s, trial_floquet(s, dt, TURN, 0, turn_shaft, NULL, &run[0], 4, 4, &value[0][0]));
    scene_tip(run[0].blade[1], after);
    assert_memory_equal(before, after, sizeof before);
    OK(run[1].s, spar_joint_set_load(run[1].support, kick));
    for (int k = 0; k < 2; k++) {
        turn_on(&run[k], SETTLE, 1);
        OK(run[k].s, spar_joint_set_load(run[k].support, none));
        turn_on(&run[k], SETTLE + 1, GONE);
    }
    for (int i = 0; i < WATCH; i++) {
        double at[2][2];
        for (int k = 0; k < 2; k++) {
            see_two_blades(&run[k], at[k]);
            turn_on(&run[k], SETTLE + 1 + GONE + i, 1);
        }
        y[i][0] = at[1][0] - at[0][0];
        y[i][1] = at[1][1] - at[0][1];
    }
    for (int i = 0; i < 2 * (WATCH - 2); i++) { /* least squares */
        const double *x = &y[i / 2][i % 2];
        a11 += x[2] * x[2], a12 += x[2] * x[0], a22 += x[0] * x[0];
        b1 += x[2] * x[4], b2 += x[0] * x[4];
    }
    double sum = (a22 * b1 - a12 * b2) / (a11 * a22 - a12 * a12),
           less = (a11 * b2 - a12 * b1) / (a11 * a22 - a12 * a12);
    double complex seen = 0.5 * sum + csqrt(0.25 * sum * sum + less), found = multiplier_of(value[0], period);
    NEAR(cabs(creal(seen) + fabs(cimag(seen)) * I - found), 0, 1e-4);
    for (int k = 0; k < 2; k++) {
        spar_session_destroy(&run[k].s);
    }
}

/* Coleman's rotor: a hub of mass M on springs k and dampers c along x and y, and two blades on hinges at e: mass m at r
   from the hinge, inertia J about it, spring and damper of the lag. */
typedef struct coleman {
    double M, k[2], c, m, e, r, J, spring, damper, W;
    spar_joint *bearing;
} coleman;

/* Small motions (x, y, lag 1, lag 2) and their rates; u along a blade, n across:
   (m r^2 + J) z'' + damper z' + (spring + m e r W^2) z + m r (x'' . n) = 0
   (M + 2 m) x'' + c x' + k x + sum of m r (z'' n - 2 W z' u - W^2 z n) = 0 */
static void lagging(const void *of, double t, const double *x, double *rate) {
    const coleman *p = of;
    double A[4][5] = {{0}};
    for (int i = 0; i < 2; i++) {
        A[i][i] = p->M + 2 * p->m;
        A[i][4] = -p->k[i] * x[i] - p->c * x[4 + i];
    }
    for (int b = 0; b < 2; b++) {
        double psi = p->W * t + pi * b, u[2] = {cos(psi), sin(psi)}, n[2] = {-sin(psi), cos(psi)}, z = x[2 + b],
               zd = x[6 + b];
        A[2 + b][2 + b] = p->m * p->r * p->r + p->J;
        A[2 + b][4] = -p->damper * zd - (p->spring + p->m * p->e * p->r * p->W * p->W) * z;
        for (int i = 0; i < 2; i++) {
            A[i][2 + b] = A[2 + b][i] = p->m * p->r * n[i];
            A[i][4] += p->m * p->r * (2 * p->W * zd * u[i] + p->W * p->W * z * n[i]);
        }
    }
    for (int k = 0; k < 4; k++) { /* positive definite: no pivots */
        for (int i = 0; i < 4; i++) {
            double f = i == k ? 0 : A[i][k] / A[k][k];
            for (int j = k; j < 5; j++) {
                A[i][j] -= f * A[k][j];
            }
        }
    }
    for (int i = 0; i < 4; i++) {
        rate[i] = x[4 + i];
        rate[4 + i] = A[i][4] / A[i][i];
    }
}

static int turn_bearing(spar_session *s, double t, double dt, void *context) {
    const coleman *p = context;
    const double at[6] = {0, 0, 0, 0, 0, p->W * (t + dt)}, rate[6] = {0, 0, 0, 0, 0, p->W};
    (void)s;
    return spar_joint_drive(p->bearing, at, rate, NULL);
}

static void coleman_scene(spar_session *s, coleman *p) {
    static const char *const blade[2] = {"blade 1", "blade 2"}, *const hinge[2] = {"hinge 1", "hinge 2"};
    const double w[3] = {0, 0, p->W};
    double spring[36], damper[36];
    spar_member *hub = body_of(s, "hub", p->M, SPAR_ROOT_FREE);
    OK(s, spar_member_set_initial_velocity(hub, NULL, NULL, w));
    OK(s, spar_member_commit(hub));
    OK(s, spar_joint_create(s, "bearing", hub, 0, NULL, 0, SPAR_FREE_X | SPAR_FREE_Y | SPAR_FREE_RZ, &p->bearing));
    OK(s, spar_joint_set_driven(p->bearing, SPAR_FREE_RZ));
    scene_diagonal(spring, p->k[0], p->k[1], 0, 0, 0, 0);
    scene_diagonal(damper, p->c, p->c, 0, 0, 0, 0);
    OK(s, spar_joint_set_spring(p->bearing, spring, damper, NULL));
    scene_diagonal(spring, 0, 0, 0, 0, 0, p->spring);
    scene_diagonal(damper, 0, 0, 0, 0, 0, p->damper);
    for (int b = 0; b < 2; b++) {
        const double side = b ? -1 : 1, c[3] = {0}, J[3] = {p->J, p->J, p->J}, at[3] = {side * p->e, 0, 0},
                     x[3] = {side * (p->e + p->r), 0, 0}, v[3] = {0, p->W * x[0], 0};
        double M[36];
        spar_member *m = NULL;
        spar_joint *j = NULL;
        scene_mass(M, p->m, c, J);
        OK(s, spar_rigid_create(s, blade[b], x, upright, M, &m));
        OK(s, spar_member_set_root(m, SPAR_ROOT_FREE));
        OK(s, spar_member_set_initial_velocity(m, x, v, w));
        OK(s, spar_member_commit(m));
        OK(s, spar_joint_create(s, hinge[b], m, 0, hub, 0, SPAR_FREE_RZ, &j));
        OK(s, spar_joint_set_frame(j, at, upright));
        OK(s, spar_joint_set_spring(j, spring, damper, NULL));
    }
}

/* Ground resonance of two blades on a support that is not isotropic, of 8.5 and 12 rad/s: turning below these
   frequencies, between them, where it grows, and above, where the springs are less than what the turn takes off, and
   where it grows again. All multipliers, against the periodic equations of the linear motion. */
static void test_coleman(void **state) {
    (void)state;
    const double speed[4] = {4, 10, 18, 35};
    for (int i = 0; i < 4; i++) {
        coleman p = {10, {1000, 2000}, 1, 2, 0.2, 1, 0.3, 20, 0.05, speed[i], NULL};
        double A[MOST][MOST], period = 2 * pi / p.W, worst[2] = {0};
        map_of(8, lagging, &p, period, A);
        for (int fine = 0; fine < 2; fine++) {
            double value[4][2];
            int64_t steps = fine ? 400 : 200;
            spar_session *s = scene_session();
            coleman_scene(s, &p);
            OK(s, spar_session_set_integrator(s, 1, 1));
            OK(s, trial_floquet(s, period / (double)steps, steps, 0, turn_bearing, NULL, &p, 4, 4, value[0]));
            for (int k = 0; k < 4; k++) {
                worst[fine] = fmax(worst[fine], off_spectrum(8, A, multiplier_of(value[k], period)));
            }
            assert_true((value[0][0] > 0.1) == (i == 1 || i == 3));
            spar_session_destroy(&s);
        }
        NEAR(worst[0] / worst[1], 4, 0.6);
    }
}

static int stop(spar_session *s, double done, double expected, void *context) {
    (void)s, (void)context;
    assert_true(expected >= 5);
    return done > 1;
}

static void test_refused(void **state) {
    (void)state;
    double spring[36], value[2], q[7], before[7];
    spar_joint *j = NULL;
    spar_session *s = scene_session();
    spar_member *b = body_of(s, "b", 2, SPAR_ROOT_FREE);
    scene_diagonal(spring, 0, 50, 0, 0, 0, 0);
    OK(s, spar_joint_create(s, "j", b, 0, NULL, 0, SPAR_FREE_Y, &j));
    OK(s, spar_joint_set_spring(j, spring, NULL, NULL));
    OK(s, spar_member_commit(b));
    scene_tip(b, before);
    assert_int_equal(trial_floquet(NULL, 0.1, 8, 0, NULL, NULL, NULL, 1, 1, value), SPAR_ERR_ARGUMENT);
    REFUSED(s, SPAR_ERR_ARGUMENT, "dt is 0", trial_floquet(s, 0, 8, 0, NULL, NULL, NULL, 1, 1, value));
    REFUSED(s, SPAR_ERR_ARGUMENT, "0 steps", trial_floquet(s, 0.1, 0, 0, NULL, NULL, NULL, 1, 1, value));
    REFUSED(s, SPAR_ERR_ARGUMENT, "an amplitude of 0.2", trial_floquet(s, 0.1, 8, 0.2, NULL, NULL, NULL, 1, 1, value));
    REFUSED(s, SPAR_ERR_STATE, "the number of modes is not set",
            trial_floquet(s, 0.1, 8, 0, NULL, NULL, NULL, 0, 0, NULL));
    REFUSED(s, SPAR_ERR_ARGUMENT, "3 multipliers", trial_floquet(s, 0.1, 8, 0, NULL, NULL, NULL, 1, 3, value));
    REFUSED(s, SPAR_ERR_ARGUMENT, "eigenvalue is NULL", trial_floquet(s, 0.1, 8, 0, NULL, NULL, NULL, 1, 1, NULL));
    REFUSED(s, SPAR_ERR_ARGUMENT, "7 modes", trial_floquet(s, 0.1, 8, 0, NULL, NULL, NULL, 7, 1, value));
    REFUSED(s, SPAR_ERR_NUMERIC, "multipliers", trial_floquet(s, 0.1, 8, 0, NULL, NULL, NULL, 1, 2, value));
    OK(s, spar_trial_set_progress(trial_of(s), stop, NULL));
    REFUSED(s, SPAR_ERR_USER, "", trial_floquet(s, 0.1, 8, 0, NULL, NULL, NULL, 1, 1, value));
    OK(s, spar_trial_set_progress(trial_of(s), NULL, NULL));
    OK(s, trial_floquet(s, 0.1, 8, 0, NULL, NULL, NULL, 1, 0, NULL));
    scene_tip(b, q);
    assert_memory_equal(q, before, sizeof q);
    /* let go: a swing of 5 rad/s does not repeat in 0.8 s */
    OK(s, spar_member_set_initial_velocity(b, NULL, (const double[3]){0, 1, 0}, NULL));
    REFUSED(s, SPAR_ERR_STATE, "the state is not periodic with 8 steps of 0.1 s",
            trial_floquet(s, 0.1, 8, 0, NULL, NULL, NULL, 1, 1, value));
    spar_session_destroy(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_constant), cmocka_unit_test(test_mathieu),    cmocka_unit_test(test_unlike_shaft),
        cmocka_unit_test(test_fluid),    cmocka_unit_test(test_blade),      cmocka_unit_test(test_coleman),
        cmocka_unit_test(test_refused),  cmocka_unit_test(test_two_blades),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
