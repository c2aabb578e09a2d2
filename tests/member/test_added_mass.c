/* A guess of the fluid's added mass in the structure's equations (spar_member_set_added_mass): contraction and limits
   of stability in closed form, the converged answer as without it, energy, fidelities, joints, files. With m the mass,
   m_a the fluid's and M the guess the map of a load y has the derivative (M - m_a) / (m + M):
   docs/explanation/theory.md. */
#include "pistons.h"

#include <float.h>
#include <stdio.h>

static const double ratios[] = {1, 10, 100}, wrong_by[] = {0.5, 1, 2};
enum { RATIOS = 3 };

/* What is left of the added mass, over the mass with the guess; both in units of the mass. */
static double left_over(double ratio, double guess) {
    return (ratio - guess) / (1 + guess);
}

/* Fixed point iteration on one step: residuals fall by |left_over| from one to the next, to 1e-6 of it (rounding: the
   loads are 1, residuals above 1e-9 are looked at); the answer is b / (1 + r) whatever the guess is, to the tolerance
   of the coupling times 1 / (1 - |left_over|) = 51 at most. */
static void contraction(void **state) {
    (void)state;
    enum { MOST = 2000 };
    static double residual[MOST];
    for (int k = 0; k < RATIOS * RATIOS; k++) {
        double r = ratios[k / RATIOS], guess = r * wrong_by[k % RATIOS], want = fabs(left_over(r, guess)), a[6];
        int count;
        pistons p;
        pistons_create_with(&p, 1, &r, &guess);
        p.b[0] = 1;
        OK(p.session, spar_session_set_predictor(p.session, 0));
        OK(p.session, spar_session_set_coupling(p.session, SPAR_COUPLING_FIXED_POINT, 1e-13, 0, MOST));
        OK(p.session, spar_session_set_option(p.session, "coupling.norm", "loads"));
        OK(p.session, spar_step(p.session, 0.1, pistons_fluid, &p, NULL));
        OK(p.session, spar_session_get_iterations(p.session, &count, MOST, residual, NULL));
        NEAR(residual[0], 1, 1e-15); /* predicted: no load; the body does not move, and the fluid answers 1 */
        for (int i = 1; i < count && residual[i - 1] > 1e-9; i++) {
            NEAR(residual[i] / residual[i - 1], want, 1e-6);
        }
        OK(p.session, spar_member_get_motion(p.body[0], NULL, NULL, a));
        NEAR(a[0], 1 / (1 + r) / 2, 1e-11);
        NEAR(p.force[0][0], 1 / (1 + r), 1e-11);
        print_message("added mass %g, guess %g: %d iterations, contraction %.4f\n", r, guess, count, want);
        assert_true(wrong_by[k % RATIOS] != 1 || count == 2);
        pistons_destroy(&p);
    }
}

/* The largest root's modulus of z^{n+1} + mu E(z) = 0, E the extrapolation of this order, by the power of its companion
   matrix: an oracle that knows nothing of limits. */
static double growth_of(int order, double mu) {
    static const double weights[3][3] = {{1, 0, 0}, {2, -1, 0}, {3, -3, 1}};
    enum { STEPS = 20000 };
    double x[3] = {1, 0.3, -0.7}, sum = 0;
    for (int i = 0; i < STEPS; i++) {
        double next = 0, size = 0;
        for (int k = 0; k < 3; k++) {
            next -= mu * weights[order][k] * x[k];
        }
        x[2] = x[1], x[1] = x[0], x[0] = next;
        for (int k = 0; k < 3; k++) {
            size += x[k] * x[k];
        }
        size = sqrt(size);
        sum += size > 0 ? log(size) : -100;
        for (int k = 0; k < 3; k++) {
            x[k] /= size > 0 ? size : 1;
        }
    }
    return exp(sum / STEPS);
}

/* Factor a step by which the loads of an explicit run grow, from a load of 1 at t^0. */
static double explicit_growth(int order, double r, const double *guess, int steps) {
    pistons p;
    double one[3] = {1, 0, 0}, early = 0, late = 0;
    pistons_create_with(&p, 1, &r, guess);
    scene_explicit(p.session);
    OK(p.session, spar_session_set_option(p.session, "coupling.unstable", "accept"));
    OK(p.session, spar_session_set_predictor(p.session, order));
    OK(p.session, spar_fluid_push_forces(p.fluid[0], one, NULL));
    for (int i = 0; i < steps; i++) {
        OK(p.session, spar_step(p.session, 0.1, pistons_fluid, &p, NULL));
        double load = fabs(p.force[0][0]);
        early = i < steps / 2 ? fmax(0.5 * early, load) : early; /* of the last few: it oscillates */
        late = fmax(0.5 * late, load);
    }
    pistons_destroy(&p);
    return pow(late / early, 1.0 / (steps - steps / 2));
}

/* Explicit coupling with guesses wrong by a factor of 2 either way: as stable or not as the roots say, and at every
   ratio of 1 and more it blows up without one (the same roots). */
static void explicit_with_wrong_guesses(void **state) {
    (void)state;
    for (int order = 0; order <= 2; order++) {
        for (int k = 0; k < RATIOS * RATIOS; k++) {
            double r = ratios[k / RATIOS], guess = r * wrong_by[k % RATIOS];
            double want = growth_of(order, left_over(r, guess)), got = explicit_growth(order, r, &guess, 60);
            double bare = growth_of(order, r), seen = explicit_growth(order, r, NULL, 60);
            print_message("order %d, added mass %g, guess %g: factor %.3f (%.3f), without %.3f (%.3f)\n", order, r,
                          guess, got, want, seen, bare);
            assert_true(bare >= 1 && (order == 0 && r == 1 ? fabs(seen - 1) < 0.02 : seen > 1.02));
            NEAR(got, fmax(want, 0.5), 0.04 * want + 0.01); /* 0.5: the memory of what is looked at */
        }
    }
}

/* The limits, sharp to one per cent: 1, 1/3, 1/7 from below, and -1/2 of order 2, where the guess is m + 2 m_a. */
static void explicit_limits(void **state) {
    (void)state;
    static const struct {
        int order;
        double limit;
    } all[] = {{0, 1}, {1, 1.0 / 3}, {2, 1.0 / 7}, {2, -0.5}};
    for (size_t k = 0; k < sizeof all / sizeof *all; k++) {
        for (int i = 0; i < RATIOS; i++) {
            for (int beyond = 0; beyond < 2; beyond++) {
                double mu = all[k].limit * (beyond ? 1.01 : 0.99), r = ratios[i], guess = (r - mu) / (1 + mu);
                if (guess < 0) {
                    continue;
                }
                double growth = explicit_growth(all[k].order, r, &guess, 2000);
                assert_true(beyond ? growth > 1 + 1e-4 : growth < 1 - 1e-4);
            }
        }
    }
}

/* An oscillator, m and m_a on a spring that the fluid is, from rest at speed 1: with every scheme and every guess the
   way of one body of mass m (1 + r) and no added mass, which has the same equations step by step. Tolerance: what is
   left of the iteration, 1e-12 of the loads at most 51 times, through 40 steps. */
static void oscillator(void **state) {
    (void)state;
    static const double v0[3] = {1, 0, 0};
    for (int k = 0; k < RATIOS * RATIOS; k++) {
        double r = ratios[k / RATIOS], guess = r * wrong_by[k % RATIOS], none = 0;
        for (int scheme = SPAR_COUPLING_FIXED_POINT; scheme <= SPAR_COUPLING_IQN_ILS; scheme++) {
            pistons p[2];
            int iterations = 0, most = 0;
            pistons_create_with(&p[0], 1, &r, &guess);
            pistons_create(&p[1], 1, &none);
            p[0].stiffness = 3;
            p[1].stiffness = 3 / (1 + r);
            for (int side = 0; side < 2; side++) {
                OK(p[side].session, spar_member_set_initial_velocity(p[side].body[0], NULL, v0, NULL));
                OK(p[side].session, spar_session_set_coupling(p[side].session, side ? SPAR_COUPLING_IQN_ILS : scheme,
                                                              1e-13, 1e-12, 3000));
            }
            for (int step = 0; step < 40; step++) {
                double q[2][7];
                for (int side = 0; side < 2; side++) {
                    OK(p[side].session,
                       spar_step(p[side].session, 0.1, pistons_fluid, &p[side], side ? NULL : &iterations));
                    OK(p[side].session, spar_member_get_motion(p[side].body[0], q[side], NULL, NULL));
                }
                most = iterations > most ? iterations : most;
                NEAR(q[0][0], q[1][0], 1e-10);
            }
            assert_true(wrong_by[k % RATIOS] != 1 || most <= 8);
            pistons_destroy(&p[0]);
            pistons_destroy(&p[1]);
        }
    }
}

/* Generalised-alpha and the extrapolation of one degree of freedom, as the papers have them: m a + k x = F with F =
   -m_a a of the fluid and the guess M taken to the left and, extrapolated, to the right. x after each step, from x = 0
   at speed 1. */
static void scalar_run(int order, double rho, double h, double k, double m, double m_a, double M, int steps,
                       double *x) {
    static const double weights[3][3] = {{1, 0, 0}, {2, -1, 0}, {3, -3, 1}};
    double am = (2 * rho - 1) / (rho + 1), af = rho / (rho + 1), gamma = 0.5 + af - am,
           beta = 0.25 * (0.5 + gamma) * (0.5 + gamma), v = 1, b = 0, at = 0, a[3] = {0};
    for (int n = 0; n < steps; n++) {
        int o = n < order ? n : order; /* as far back as there is something */
        double y = 0, c = (1 - af) / (1 - am), b0 = (af * a[0] - am * b) / (1 - am);
        for (int i = 0; i < 3; i++) {
            y += (M - m_a) * weights[o][i] * a[i];
        }
        double known = at + h * v + h * h * ((0.5 - beta) * b + beta * b0),
               next = (y - k * known) / (m + M + k * h * h * beta * c), b1 = b0 + c * next;
        at = known + h * h * beta * c * next;
        v += h * ((1 - gamma) * b + gamma * b1);
        b = b1;
        a[2] = a[1], a[1] = a[0], a[0] = next;
        x[n] = at;
    }
}

/* A body on a spring of its own, so that it is solved with its joint, step by step as the recurrence above has it
   (1e-9 of the largest way: rounding, enlarged where it grows). Under a guess that is too large a structure that the
   step resolves gains energy, with order 1 by (omega h)^4 (M - m_a) / (m + m_a) / 2 a step, under one that is too small
   it loses it: of omega h = 0.5 to a factor of 1.5, what the next terms make. */
static void explicit_oscillator(void **state) {
    (void)state;
    enum { STEPS = 150 };
    static const double mass_of[] = {0.8, 1, 1.25}, m = 2, h = 0.1;
    double x[STEPS];
    for (int n = 0; n < RATIOS * RATIOS * 2; n++) {
        int order = n / (RATIOS * RATIOS);
        double r = ratios[n / RATIOS % RATIOS], guess = r * mass_of[n % RATIOS], k = 25 * m * (1 + r), largest = 0,
               K[36], v0[3] = {1, 0, 0}, q[7], early = 0, late = 0;
        pistons p;
        pistons_create_with(&p, 1, &r, &guess);
        scene_explicit(p.session);
        scene_diagonal(K, k, 0, 0, 0, 0, 0);
        OK(p.session, spar_session_set_integrator(p.session, 0.99, 1));
        OK(p.session, spar_spring_create(p.session, "spring", p.body[0], 0, SPAR_FREE_X, K, NULL, NULL, NULL));
        OK(p.session, spar_member_set_initial_velocity(p.body[0], NULL, v0, NULL));
        OK(p.session, spar_session_set_predictor(p.session, order));
        OK(p.session, spar_fluid_push_forces(p.fluid[0], (double[3]){0}, NULL));
        scalar_run(order, 0.99, h, k, m, m * r, m * guess, STEPS, x);
        for (int i = 0; i < STEPS; i++) {
            OK(p.session, spar_step(p.session, h, pistons_fluid, &p, NULL));
            OK(p.session, spar_member_get_motion(p.body[0], q, NULL, NULL));
            largest = fmax(largest, fabs(x[i]));
            NEAR(q[0], x[i], 1e-9 * largest);
            early = i < 40 ? fmax(early, fabs(x[i])) : early;
            late = i >= STEPS - 40 ? fmax(late, fabs(x[i])) : late;
        }
        double rate = log(late / early) / (STEPS - 40), left = (guess - r) / (1 + r);
        double want = order == 0 ? left * 0.25 / 2 : left * 0.0625 / 2;
        print_message("order %d, added mass %g, guess %g: grows by %.5f a step (%.5f)\n", order, r, guess, rate, want);
        assert_true(mass_of[n % RATIOS] == 1 ? fabs(rate) < 1e-3 : rate / want > 0.5 && rate / want < 1.5);
        pistons_destroy(&p);
    }
}

/* Work and energy. Iterated: kinetic energy and work as without a guess, to 1e-10. Explicit: what the loads that moved
   the body (spar_member_get_loads) did is its energy to rounding, since without numerical damping the trapezoidal rule
   is the scheme's own, while the fluid holds that it has done another work: the guess took no part in either. */
static void energy(void **state) {
    (void)state;
    static const double v0[3] = {1, 0, 0};
    const double r = 10, guess = 20;
    double E[3][SPAR_ENERGY_COUNT], W[3][SPAR_WORK_COUNT];
    for (int way = 0; way < 3; way++) { /* without a guess, with, and explicit */
        pistons p;
        double held = 0, before[2] = {0, 0};
        memset(&p, 0, sizeof p);
        p.session = scene_session();
        p.n = 1, p.mass[0] = 2, p.ratio[0] = r, p.stiffness = 3;
        double mass[36], x[3] = {0, 0, 0}, q[4] = {1, 0, 0, 0}, J[3] = {1, 1, 1};
        scene_mass(mass, 2, x, J);
        OK(p.session, spar_session_set_integrator(p.session, 1, 1));
        OK(p.session, spar_rigid_create(p.session, "body", x, q, mass, &p.body[0]));
        OK(p.session, spar_member_set_effects(p.body[0], SPAR_EFFECT_WORK, 0));
        scene_diagonal(mass, 2 * guess, 0, 0, 0, 0, 0);
        if (way > 0) {
            OK(p.session, spar_member_set_added_mass(p.body[0], 1, NULL, mass));
        }
        OK(p.session, spar_member_commit(p.body[0]));
        OK(p.session, spar_fluid_create(p.body[0], "fluid", &p.fluid[0]));
        OK(p.session, spar_fluid_set_motion_nodes(p.fluid[0], 1, x));
        OK(p.session, spar_fluid_set_force_nodes(p.fluid[0], 1, x));
        OK(p.session, spar_fluid_map(p.fluid[0]));
        OK(p.session, spar_member_set_initial_velocity(p.body[0], NULL, v0, NULL));
        OK(p.session, spar_session_set_coupling(p.session, way < 2 ? SPAR_COUPLING_IQN_ILS : SPAR_COUPLING_EXPLICIT,
                                                1e-14, 1e-13, 50));
        for (int step = 0; step < 50; step++) {
            double at[7];
            OK(p.session, spar_step(p.session, 0.1, pistons_fluid, &p, NULL));
            OK(p.session, spar_member_get_motion(p.body[0], at, NULL, NULL));
            held += 0.5 * (p.force[0][0] + before[0]) * (at[0] - before[1]);
            before[0] = p.force[0][0], before[1] = at[0];
        }
        OK(p.session, spar_member_get_energy(p.body[0], SPAR_ENERGY_COUNT, E[way]));
        OK(p.session, spar_member_get_work(p.body[0], SPAR_WORK_COUNT, W[way]));
        NEAR(E[way][SPAR_ENERGY_KINETIC] - 1, W[way][SPAR_WORK_FLUID], 1e-12);
        if (way < 2) {
            NEAR(W[way][SPAR_WORK_FLUID], held, 1e-10);
        }
        print_message("kinetic %g, work %g, as the fluid holds %g\n", E[way][SPAR_ENERGY_KINETIC],
                      W[way][SPAR_WORK_FLUID], held);
        pistons_destroy(&p);
    }
    NEAR(E[1][SPAR_ENERGY_KINETIC], E[0][SPAR_ENERGY_KINETIC], 1e-10);
    NEAR(W[1][SPAR_WORK_FLUID], W[0][SPAR_WORK_FLUID], 1e-10);
}

/* ---- a body that turns ---- */

/* A body of mass 1 with a full 6x6 added mass in its own axes, spinning about an axis that is none of its own. The
   fluid answers -R A R^T a, with R the turn at the end of the step, less a spring that keeps it near. It begins without
   accelerations, so that the first step, too, is of second order. */
typedef struct spinner {
    spar_session *session;
    spar_member *body;
    spar_fluid *fluid;
    double added[36];
} spinner;

/* Symmetric, positive definite: a diagonal of `size` and less, with couplings of all kinds. */
static void full_matrix(double size, double A[36]) {
    scene_diagonal(A, size, 0.6 * size, 0.8 * size, 0.5 * size, 0.7 * size, 0.4 * size);
    for (int i = 0; i < 6; i++) {
        for (int j = 0; j < i; j++) {
            A[6 * i + j] = A[6 * j + i] = 0.05 * size * ((i * 7 + j * 3) % 5 - 2);
        }
    }
}

static int spinner_fluid(spar_session *s, double t, double dt, int iteration, void *context) {
    spinner *b = context;
    double q[7], a[6], own[6], f[6] = {0};
    (void)t, (void)dt, (void)iteration;
    OK(s, spar_member_get_motion(b->body, q, NULL, a));
    spari_rotate_back(q + 3, a, own);
    spari_rotate_back(q + 3, a + 3, own + 3);
    for (int i = 0; i < 36; i++) {
        f[i / 6] -= b->added[i] * own[i % 6];
    }
    spari_rotate(q + 3, f, f);
    spari_rotate(q + 3, f + 3, f + 3);
    for (int k = 0; k < 3; k++) {
        f[k] -= 2 * q[k];
    }
    return spar_fluid_push_forces(b->fluid, f, f + 3);
}

static void spinner_create(spinner *b, double size, double guess) {
    static const double x[3] = {0, 0, 0}, q[4] = {1, 0, 0, 0}, c[3] = {0, 0, 0}, J[3] = {1, 1, 1},
                        v0[3] = {0.3, -0.2, 0.1}, omega[3] = {1, 2, -1.5};
    double mass[36], A[36];
    b->session = scene_session();
    full_matrix(size, b->added);
    scene_mass(mass, 1, c, J);
    OK(b->session, spar_rigid_create(b->session, "spinner", x, q, mass, &b->body));
    for (int i = 0; i < 36; i++) {
        A[i] = guess * b->added[i];
    }
    OK(b->session, spar_member_set_added_mass(b->body, guess > 0, NULL, A));
    OK(b->session, spar_member_commit(b->body));
    OK(b->session, spar_fluid_create(b->body, "fluid", &b->fluid));
    OK(b->session, spar_fluid_set_motion_nodes(b->fluid, 1, x));
    OK(b->session, spar_fluid_set_force_nodes(b->fluid, 1, x));
    OK(b->session, spar_fluid_map(b->fluid));
    OK(b->session, spar_member_set_initial_velocity(b->body, x, v0, omega));
}

/* To t = 1 in `steps`; the pose there, and the mean of the iterations. */
static double spinner_run(double size, double guess, int scheme, int steps, double q[7]) {
    spinner b;
    int n, sum = 0;
    spinner_create(&b, size, guess);
    OK(b.session, spar_session_set_coupling(b.session, scheme, 1e-13, 1e-12, 300));
    for (int i = 0; i < steps; i++) {
        OK(b.session, spar_step(b.session, 1.0 / steps, spinner_fluid, &b, &n));
        sum += n;
    }
    OK(b.session, spar_member_get_motion(b.body, q, NULL, NULL));
    spar_session_destroy(&b.session);
    return (double)sum / steps;
}

static double pose_distance(const double a[7], const double b[7]) {
    double sum = 0;
    for (int k = 0; k < 7; k++) {
        sum += (a[k] - b[k]) * (a[k] - b[k]);
    }
    return sqrt(sum);
}

/* The same converged motion whatever the guess is (1e-9: the coupling's 1e-12 over 40 steps), in fewer iterations with
   the right one: what is left then is that the guess turns with t^n and the fluid with t^{n+1}. Explicit, with the
   guess exact or half of it, the error against the converged run is of second order; without it blows up. */
static void turning_body(void **state) {
    (void)state;
    for (int k = 0; k < RATIOS; k++) {
        double want[7], got[7], coarse[7], fine[7], finest[7];
        double bare = spinner_run(ratios[k], 0, SPAR_COUPLING_IQN_ILS, 40, want);
        for (int w = 0; w < RATIOS; w++) {
            double mean = spinner_run(ratios[k], wrong_by[w], SPAR_COUPLING_IQN_ILS, 40, got);
            print_message("6x6 of %g, guess %g of it: %.2f iterations, without %.2f\n", ratios[k], wrong_by[w], mean,
                          bare);
            NEAR(pose_distance(got, want), 0, 1e-9);
            assert_true(wrong_by[w] != 1 || mean < bare);
        }
        (void)spinner_run(ratios[k], 1, SPAR_COUPLING_FIXED_POINT, 40, got);
        NEAR(pose_distance(got, want), 0, 1e-9);
        double error[3];
        (void)spinner_run(ratios[k], 1, SPAR_COUPLING_IQN_ILS, 1280, finest);
        (void)spinner_run(ratios[k], 1, SPAR_COUPLING_EXPLICIT, 80, coarse);
        (void)spinner_run(ratios[k], 1, SPAR_COUPLING_EXPLICIT, 160, fine);
        error[0] = pose_distance(coarse, finest), error[1] = pose_distance(fine, finest);
        (void)spinner_run(ratios[k], 1, SPAR_COUPLING_IQN_ILS, 160, fine);
        error[2] = pose_distance(fine, finest);
        print_message("explicit: error %.2e with 80 steps, %.2e with 160; iterated %.2e\n", error[0], error[1],
                      error[2]);
        assert_true(error[1] < error[0] / 3.3);
    }
}

/* ---- beams ---- */

/* A cantilever of length 4, 1 kg/m, in a fluid of `ratio` times its mass across it: -m_a times the acceleration of the
   section at five Gauss points an element, which is what the guess per length is integrated with. */
enum { STRIPS = 10 };
typedef struct fin {
    spar_session *session;
    spar_member *beam;
    spar_fluid *fluid;
    double weight[STRIPS], ratio, gust;
    double noise; /* of a force, of itself */
    unsigned long long seed;
} fin;

static double draw(unsigned long long *seed) {
    *seed = *seed * 6364136223846793005ULL + 1442695040888963407ULL;
    return (double)(*seed >> 11) * 0x1p-52 - 1;
}

static int fin_fluid(spar_session *s, double t, double dt, int iteration, void *context) {
    fin *f = context;
    double q[4 * STRIPS], a[3 * STRIPS], force[3 * STRIPS];
    (void)iteration;
    OK(s, spar_fluid_pull_poses(f->fluid, SPAR_NODES_MOTION, 1, NULL, q, NULL, NULL, a, NULL));
    for (int k = 0; k < STRIPS; k++) {
        double own[3];
        spari_rotate_back(q + 4 * k, a + 3 * k, own);
        double across[3] = {0, 0, -f->ratio * f->weight[k] * own[2]};
        spari_rotate(q + 4 * k, across, force + 3 * k);
        force[3 * k + 2] += f->gust * f->weight[k] * sin(3 * (t + dt));
        force[3 * k + 2] *= 1 + f->noise * draw(&f->seed);
    }
    return spar_fluid_push_forces(f->fluid, force, NULL);
}

typedef struct fin_case {
    int fidelity, modes, root;
    double ratio, guess; /* guess: times the added mass */
    int scheme, substeps, taper, order;
    double rtol; /* 0: 1e-12 */
} fin_case;

static void fin_create(fin *f, const fin_case *c) {
    static const double gauss[5] = {-0.90617984593866399, -0.53846931010568309, 0, 0.53846931010568309,
                                    0.90617984593866399},
                        w[5] = {0.23692688505618909, 0.47862867049936647, 0.56888888888888889, 0.47862867049936647,
                                0.23692688505618909};
    const double eta[2] = {0, 1};
    double K[36], M[36], A[72] = {0}, along[STRIPS];
    memset(f, 0, sizeof *f);
    f->session = scene_session();
    f->ratio = c->ratio, f->gust = 2;
    scene_diagonal(K, 1e4, 1e4, 1e4, 200, 60, 300);
    scene_diagonal(M, 1, 1, 1, 0.02, 0.01, 0.01);
    f->beam = scene_beam(f->session, "fin", 2, 4, 4, K, M);
    OK(f->session, spar_member_set_root(f->beam, c->root));
    if (c->fidelity >= 0) {
        OK(f->session, spar_member_set_fidelity(f->beam, c->fidelity, c->modes));
    }
    A[14] = c->ratio * c->guess;
    A[36 + 14] = c->taper ? 0 : A[14];
    OK(f->session, spar_member_set_added_mass(f->beam, c->guess > 0 ? 2 : 0, eta, A));
    OK(f->session, spar_member_commit(f->beam));
    for (int k = 0; k < STRIPS; k++) {
        along[k] = 0.25 * (gauss[k % 5] + (k < 5 ? 1 : 3));
        f->weight[k] = w[k % 5];
    }
    OK(f->session, spar_fluid_create(f->beam, "strips", &f->fluid));
    OK(f->session, spar_fluid_set_stations(f->fluid, STRIPS, along, NULL));
    OK(f->session, spar_fluid_map(f->fluid));
    OK(f->session, spar_session_set_integrator(f->session, 0.9, c->substeps > 0 ? c->substeps : 1));
    OK(f->session, spar_session_set_predictor(f->session, c->order));
    OK(f->session, spar_session_set_coupling(f->session, c->scheme, 1e-13, c->rtol > 0 ? c->rtol : 1e-12, 400));
}

/* The root turns about z and shakes. */
static void fin_drive(const fin *f, double t) {
    const double w = 0.8, psi[3] = {0, 0, w * t}, v[6] = {0.2 * cos(t), 0, 0, 0, 0, w},
                 a[6] = {-0.2 * sin(t), 0, 0, 0, 0, 0};
    double q[7] = {0.2 * sin(t), 0, 0};
    spari_quat_exp(psi, q + 3);
    OK(f->session, spar_member_drive(f->beam, q, v, a));
}

/* Steps with the fluid; 0, or the status that ended them. */
static int fin_steps(fin *f, const fin_case *c, double dt, int steps, int *iterations) {
    for (int i = 0; i < steps; i++) {
        double t;
        int n;
        OK(f->session, spar_session_get_time(f->session, &t, NULL, NULL));
        if (c->root == SPAR_ROOT_DRIVEN) {
            fin_drive(f, t + dt);
        }
        int status = spar_step(f->session, dt, fin_fluid, f, &n);
        if (status != SPAR_OK) {
            return status;
        }
        *iterations += n;
    }
    return SPAR_OK;
}

static double fin_run(const fin_case *c, double dt, int steps, double tip[7]) {
    fin f;
    int sum = 0;
    fin_create(&f, c);
    OK(f.session, fin_steps(&f, c, dt, steps, &sum));
    scene_tip(f.beam, tip);
    spar_session_destroy(&f.session);
    return (double)sum / steps;
}

/* Every fidelity that moves by equations, on a fixed and on a driven root: the converged tip is that without a guess
   (of motions of 0.1 and more, 1e-8: what the coupling's 1e-12 leaves, enlarged where the heaviest fluid contracts
   slowest). A beam whose line the guess is exact for iterates like a solution with no added mass at all: fixed point,
   which without a guess diverges, takes at most 8 evaluations. */
static void beams(void **state) {
    (void)state;
    static const struct {
        int fidelity, modes;
    } kinds[] = {
        {SPAR_FIDELITY_EXACT, 0}, {SPAR_FIDELITY_LINEAR, 0}, {SPAR_FIDELITY_MODAL, 8}, {SPAR_FIDELITY_RIGID, 0}};
    static const int roots[] = {SPAR_ROOT_FIXED, SPAR_ROOT_DRIVEN, SPAR_ROOT_FREE};
    for (int n = 0; n < 12; n++) {
        for (int k = 0; k < RATIOS; k++) {
            double want[7], got[7];
            fin_case c = {.fidelity = kinds[n / 3].fidelity,
                          .modes = kinds[n / 3].modes,
                          .root = roots[n % 3],
                          .ratio = ratios[k],
                          .scheme = SPAR_COUPLING_IQN_ILS,
                          .order = 1};
            if (c.fidelity == SPAR_FIDELITY_RIGID && c.root != SPAR_ROOT_FREE) {
                continue; /* it moves as it is told */
            }
            double bare = fin_run(&c, 0.02, 15, want);
            for (int w = 0; w < RATIOS; w++) {
                c.guess = wrong_by[w];
                double mean = fin_run(&c, 0.02, 15, got);
                print_message("fidelity %d, root %d, added mass %g, guess %g: %.2f iterations, without %.2f; %.1e\n",
                              c.fidelity, c.root, c.ratio, c.guess, mean, bare, pose_distance(got, want));
                NEAR(pose_distance(got, want), 0, 1e-8);
            }
            c.guess = 1, c.scheme = SPAR_COUPLING_FIXED_POINT;
            double mean = fin_run(&c, 0.02, 15, got);
            print_message("  fixed point, guess exact: %.2f\n", mean);
            NEAR(pose_distance(got, want), 0, 1e-8);
            assert_true(mean <= 8);
        }
    }
}

/* A free beam in 8 modes and a fluid a hundred times as heavy, iterated to 1e-12: the first answer overshoots a
   hundredfold, most of it along loads that no mode feels, and what rounding leaves of it is above that tolerance. Of 40
   runs that differ by noise of rounding's size each gets through, in some 5 evaluations a step; where the columns
   carried loads that move nothing three in forty ended with loads of 1e20 N. */
static void modes_to_rounding(void **state) {
    (void)state;
    const fin_case c = {.fidelity = SPAR_FIDELITY_MODAL,
                        .modes = 8,
                        .root = SPAR_ROOT_FREE,
                        .ratio = 100,
                        .scheme = SPAR_COUPLING_IQN_ILS,
                        .order = 1};
    for (unsigned long long seed = 0; seed < 40; seed++) {
        fin f;
        int sum = 0;
        fin_create(&f, &c);
        f.noise = 1e-15, f.seed = seed;
        assert_int_equal(fin_steps(&f, &c, 0.02, 15, &sum), SPAR_OK);
        assert_true(sum <= 15 * 15);
        spar_session_destroy(&f.session);
    }
}

/* The same of beams on a pin: of a linear one the guess does not turn. */
static void beams_held_otherwise(void **state) {
    (void)state;
    for (int n = 0; n < 2; n++) {
        double want[7], got[7];
        fin_case c = {.fidelity = n ? SPAR_FIDELITY_EXACT : SPAR_FIDELITY_LINEAR,
                      .root = SPAR_ROOT_PINNED,
                      .ratio = 10,
                      .order = 1,
                      .scheme = SPAR_COUPLING_IQN_ILS};
        (void)fin_run(&c, 0.02, 15, want);
        for (int w = 0; w < RATIOS; w++) {
            c.guess = wrong_by[w];
            (void)fin_run(&c, 0.02, 15, got);
            NEAR(pose_distance(got, want), 0, 1e-8);
        }
        c.guess = 1, c.scheme = SPAR_COUPLING_FIXED_POINT;
        assert_true(fin_run(&c, 0.02, 15, got) <= 8);
        NEAR(pose_distance(got, want), 0, 1e-8);
    }
}

/* Explicit coupling of the fin: without a guess the load is beyond numbers within 60 steps at every ratio (the solver
   says so, or the tip is off by its own size); with it it stays within 5 per cent of the iterated tip: exact, or 0.8 of
   it with order 1, half of it with order 0. */
static void explicit_beam(void **state) {
    (void)state;
    for (int k = 0; k < RATIOS; k++) {
        double want[7], got[7], rest[7] = {0, 0, 0, 1, 0, 0, 0};
        int sum = 0;
        fin f;
        fin_case c = {.root = SPAR_ROOT_FIXED,
                      .fidelity = SPAR_FIDELITY_EXACT,
                      .ratio = ratios[k],
                      .scheme = SPAR_COUPLING_IQN_ILS,
                      .order = 1};
        (void)fin_run(&c, 0.02, 60, want);
        c.scheme = SPAR_COUPLING_EXPLICIT;
        fin_create(&f, &c);
        int status = fin_steps(&f, &c, 0.02, 60, &sum);
        scene_tip(f.beam, got);
        assert_true(status == SPAR_ERR_NUMERIC || pose_distance(got, want) > pose_distance(want, rest));
        spar_session_destroy(&f.session);
        for (int w = 0; w < 3; w++) {
            c.guess = w == 0 ? 1 : w == 1 ? 0.8 : 0.5;
            c.order = w < 2;
            (void)fin_run(&c, 0.02, 60, got);
            double off = pose_distance(got, want) / pose_distance(want, rest);
            print_message("explicit fin, added mass %g, guess %g: off by %.2e of %.2e\n", c.ratio, c.guess, off,
                          pose_distance(want, rest));
            assert_true(off < 0.05);
        }
    }
}

/* With substeps the part of the loads that the guess accounts for follows each of them: the difference from the answer
   without one goes with dt^2: over a factor of 8 in dt by 64, at least 30 here. */
static void substeps(void **state) {
    (void)state;
    double off[4];
    for (int k = 0; k < 4; k++) {
        double want[7], got[7];
        fin_case c = {.root = SPAR_ROOT_FIXED,
                      .fidelity = SPAR_FIDELITY_EXACT,
                      .ratio = 0.2,
                      .substeps = 3,
                      .rtol = 1e-9,
                      .scheme = SPAR_COUPLING_IQN_ILS,
                      .order = 1};
        (void)fin_run(&c, 0.02 / (1 << k), 20 << k, want);
        c.guess = 1;
        (void)fin_run(&c, 0.02 / (1 << k), 20 << k, got);
        off[k] = pose_distance(got, want);
    }
    print_message("substeps: off by %.2e, with an eighth of the step %.2e\n", off[0], off[3]);
    assert_true(off[0] > 0 && off[3] < off[0] / 30);
}

/* Bodies with an added mass and no fluid at all fall freely: the acceleration is gravity's. The loads are zero, so the
   relative tolerance is too; the correction for added mass has rounding errors of 8 eps (1 + |x| / (dt^2 |a|)) of its
   size, far above the absolute tolerance of 1e-9 N. */
static void no_loads(void **state) {
    (void)state;
    static const double masses[] = {1, 1e9, 1e12}, places[] = {0, 1e3}, q[4] = {1, 0, 0, 0}, none[3] = {0, 0, 0},
                        gravity[3] = {0.3, 0.1, -9.81}, spin[3] = {0.5, 0.4, -1};
    for (int n = 0; n < 12; n++) {
        double m = masses[n % 3], dt = n < 6 ? 0.1 : 0.001, mass[36], a[6], x[3] = {places[n / 3 % 2], 1, 0};
        const double inertia[3] = {m, m, m}; /* of a ball: the spin does not change */
        spar_session *s = scene_session();
        spar_member *body;
        OK(s, spar_session_set_gravity(s, gravity));
        scene_mass(mass, m, none, inertia);
        OK(s, spar_rigid_create(s, "body", x, q, mass, &body));
        scene_mass(mass, 10 * m, none, inertia);
        OK(s, spar_member_set_added_mass(body, 1, NULL, mass));
        OK(s, spar_member_set_initial_velocity(body, NULL, NULL, spin));
        OK(s, spar_member_commit(body));
        for (int step = 0; step < 50; step++) {
            int done = 0;
            OK(s, spar_step_begin(s, dt));
            while (!done) {
                OK(s, spar_step_solve(s));
                OK(s, spar_step_check(s, &done));
            }
            OK(s, spar_step_accept(s));
        }
        OK(s, spar_member_get_motion(body, NULL, NULL, a));
        for (int k = 0; k < 3; k++) {
            NEAR(a[k], gravity[k], 100 * DBL_EPSILON * (10 + x[0] / (dt * dt)));
        }
        spar_session_destroy(&s);
    }
}

/* First step of a clamped beam without fluid, let go from where a force at its tip has bent it to. The step is longer
   than most periods, so accelerations have errors far above the rounding of positions. An added mass changes the
   answer by no more than the error it may leave, 1e-9 of its correction. */
static void no_loads_on_a_bent_beam(void **state) {
    (void)state;
    const double eta[1] = {0}, force[6] = {0, 0, 1000, 0, 0, 0}, none[6] = {0};
    double K[36], M[36], added[36];
    scene_diagonal(K, 1e9, 4e8, 4e8, 1e6, 1e6, 1.5e6);
    scene_diagonal(M, 50, 50, 50, 1, 0.5, 0.5);
    scene_diagonal(added, 80, 80, 80, 0.5, 0.5, 0.5);
    for (int n = 0; n < 6; n++) {
        double dt = n % 2 ? 0.01 : 0.1, reaction[2][6];
        for (int with = 0; with < 2; with++) {
            spar_session *s = NULL;
            OK(NULL, spar_session_create(&s));
            spar_member *b = scene_beam(s, "beam", 4, 5, 10, K, M);
            int fidelity = (int[]){SPAR_FIDELITY_LINEAR, SPAR_FIDELITY_MODAL, SPAR_FIDELITY_EXACT}[n / 2];
            OK(s, spar_member_set_fidelity(b, fidelity, fidelity == SPAR_FIDELITY_MODAL ? 8 : 0));
            OK(s, spar_member_set_added_mass(b, with, eta, added));
            OK(s, spar_member_commit(b));
            OK(s, spar_member_set_load(b, 19, SPAR_LOAD_DEAD, force));
            OK(s, spar_session_solve_static(s, 1, NULL, NULL, NULL));
            OK(s, spar_member_set_load(b, 19, SPAR_LOAD_DEAD, none));
            OK(s, spar_session_solve_initial(s, dt, NULL, NULL, NULL));
            OK(s, spar_step(s, dt, NULL, NULL, NULL));
            OK(s, spar_member_get_reaction(b, reaction[with]));
            spar_session_destroy(&s);
        }
        NEAR(reaction[1][2], reaction[0][2], 1e-6 * 1000);
        NEAR(reaction[1][4], reaction[0][4], 1e-6 * 10000);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(contraction),
        cmocka_unit_test(explicit_with_wrong_guesses),
        cmocka_unit_test(explicit_limits),
        cmocka_unit_test(oscillator),
        cmocka_unit_test(explicit_oscillator),
        cmocka_unit_test(energy),
        cmocka_unit_test(turning_body),
        cmocka_unit_test(beams),
        cmocka_unit_test(modes_to_rounding),
        cmocka_unit_test(beams_held_otherwise),
        cmocka_unit_test(explicit_beam),
        cmocka_unit_test(substeps),
        cmocka_unit_test(no_loads),
        cmocka_unit_test(no_loads_on_a_bent_beam),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
