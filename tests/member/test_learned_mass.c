/* The fluid's added mass learned from iterations (spar_member_learn_added_mass), and loads of fluids that take
   accelerations from velocities (spar_member_set_added_mass_response): docs/explanation/theory.md, (T19) to (T22).
   What is learned of an exact fluid is its mass to rounding, with what its springs add over the step. */
#include "buoy.h"
#include "pistons.h"

#include <stdio.h>

static const double ratios[] = {1, 10, 100};
enum { RATIOS = 3 };

/* All 21 numbers of a full mass, in the body's own axes as it turns, to 1e-6 of the largest (an acceleration is known
   to 1e-8 of itself where Newton leaves 1e-12 of the way), and fixed points contract by the 2 per cent that the mass in
   the equations may lag behind: 8 evaluations to 1e-7. What one has learned is taken as the guess of another, which is
   then used from its first step on. */
static void whole_of_a_body(void **state) {
    (void)state;
    for (int k = 0; k < RATIOS; k++) {
        double M[36], spread;
        int used = 0, steps = 0, most = 0;
        buoy b;
        buoy_create(&b, ratios[k], 1);
        OK(b.session, spar_member_get_learned_added_mass(b.body, &used, &spread, NULL, 1, NULL, M));
        assert_true(used == 0 && spread == 1 && M[0] == 0);
        for (; steps < 100; steps++) {
            (void)buoy_step(&b, 0.01);
        }
        OK(b.session, spar_member_get_learned_added_mass(b.body, &used, &spread, NULL, 1, NULL, M));
        print_message("added mass %g: used %d, spread %.1e, off by %.1e\n", ratios[k], used, spread,
                      largest_difference(M, b.added, 36));
        assert_true(used == 1 && spread < 1e-2);
        NEAR(largest_difference(M, b.added, 36), 0, 1e-5 * ratios[k]);
        OK(b.session, spar_session_set_coupling(b.session, SPAR_COUPLING_FIXED_POINT, 1e-9, 1e-7, 300));
        for (int i = 0; i < 20; i++) {
            int n = buoy_step(&b, 0.01);
            most = n > most ? n : most;
        }
        print_message("  fixed point: %d\n", most);
        assert_true(most <= 8);
        spar_session_destroy(&b.session);

        pistons p; /* any session, to see that the guess is taken */
        const double one = 1;
        pistons_create(&p, 1, &one);
        spar_member *other;
        double x[3] = {0, 5, 0}, q[4] = {1, 0, 0, 0}, c[3] = {0, 0, 0}, J[3] = {1, 1, 1}, mass[36];
        scene_mass(mass, 1, c, J);
        OK(p.session, spar_rigid_create(p.session, "next", x, q, mass, &other));
        OK(p.session, spar_member_set_added_mass(other, 1, NULL, M));
        pistons_destroy(&p);
    }
}

/* ---- pistons ---- */

static void learning_piston(pistons *p, double ratio, int scheme, double omega) {
    static const double q[4] = {1, 0, 0, 0}, centre[3] = {0, 0, 0}, inertia[3] = {1, 1, 1}, x[3] = {0, 0, 0};
    double mass[36];
    memset(p, 0, sizeof *p);
    p->session = scene_session();
    p->n = 1, p->mass[0] = 2, p->ratio[0] = ratio;
    scene_mass(mass, 2, centre, inertia);
    OK(p->session, spar_session_set_integrator(p->session, 1, 1));
    OK(p->session, spar_rigid_create(p->session, "p", x, q, mass, &p->body[0]));
    OK(p->session, spar_member_learn_added_mass(p->body[0], 1, NULL));
    OK(p->session, spar_member_commit(p->body[0]));
    OK(p->session, spar_fluid_create(p->body[0], "p", &p->fluid[0]));
    OK(p->session, spar_fluid_set_motion_nodes(p->fluid[0], 1, x));
    OK(p->session, spar_fluid_set_force_nodes(p->fluid[0], 1, x));
    OK(p->session, spar_fluid_map(p->fluid[0]));
    OK(p->session, spar_session_set_relaxation(p->session, omega));
    OK(p->session, spar_session_set_coupling(p->session, scheme, 1e-12, 1e-9, 2000));
    p->b[0] = 1, p->stiffness = 3;
}

/* By every scheme that iterates: with r the added mass over the mass m and k the fluid's spring over the step, m r +
   k h^2 / 4 (rho_inf 1, where beta (1 - alpha_f)/(1 - alpha_m) = 1/4), to 1e-9 of it; in the equations after four steps
   with differences, of which the three last were foretold. From there on a fixed point without relaxation takes 2
   evaluations, and explicit coupling with every predictor, which explodes without, is as near as 1e-2 to 1e-5. */
static void piston(void **state) {
    (void)state;
    static const struct {
        int scheme;
        double omega;
    } by[] = {{SPAR_COUPLING_IQN_ILS, 1}, {SPAR_COUPLING_AITKEN, 0.5}, {SPAR_COUPLING_FIXED_POINT, 0.015}};
    static const double h = 0.05;
    for (int k = 0; k < RATIOS * 3; k++) {
        double r = ratios[k / 3], want = 2 * r + 3 * h * h / 4, M[36], spread;
        int used = 0, n;
        pistons p;
        learning_piston(&p, r, by[k % 3].scheme, by[k % 3].omega);
        for (int step = 1; step <= 4; step++) {
            assert_false(k % 3 == 0 && used);
            OK(p.session, spar_step(p.session, h, pistons_fluid, &p, NULL));
            OK(p.session, spar_member_get_learned_added_mass(p.body[0], &used, &spread, NULL, 1, NULL, M));
            NEAR(M[0], want, 1e-9 * want);
            assert_true(step == 4 || spread == 1 || k % 3 > 0); /* others need more differences a step */
        }
        assert_true(used && spread < 1e-8);
        OK(p.session, spar_session_set_relaxation(p.session, 1));
        OK(p.session, spar_session_set_coupling(p.session, SPAR_COUPLING_FIXED_POINT, 1e-12, 1e-9, 2000));
        for (int i = 0; i < 10; i++) {
            OK(p.session, spar_step(p.session, h, pistons_fluid, &p, &n));
            assert_int_equal(n, 2);
        }
        for (int order = 0; order <= 2; order++) {
            double a[6], q[7], most = 0;
            OK(p.session, spar_session_set_predictor(p.session, order));
            OK(p.session, spar_session_set_coupling(p.session, SPAR_COUPLING_EXPLICIT, 1e-12, 1e-9, 2000));
            for (int i = 0; i < 200; i++) {
                OK(p.session, spar_step(p.session, h, pistons_fluid, &p, NULL));
                OK(p.session, spar_member_get_motion(p.body[0], q, NULL, a));
                most = i > 2 ? fmax(most, fabs(p.force[0][0] - 2 * a[0])) : most; /* what the prediction missed */
            }
            print_message("added mass %g, order %d: missed %.1e\n", r, order, most);
            assert_true(most < (order == 0 ? 0.1 : order == 1 ? 5e-3 : 5e-4));
        }
        pistons_destroy(&p);
    }
}

/* The answer to the coupling's tolerance is that without learning: 40 steps at 1e-12 of the loads, 1e-9 of the way. */
static void answer_stays(void **state) {
    (void)state;
    for (int k = 0; k < RATIOS; k++) {
        double q[2][7];
        int sum[2] = {0, 0};
        for (int learn = 0; learn < 2; learn++) {
            buoy b;
            buoy_create(&b, ratios[k], learn);
            b.spring = 5;
            for (int i = 0; i < 40; i++) {
                sum[learn] += buoy_step(&b, 0.02);
            }
            OK(b.session, spar_member_get_motion(b.body, q[learn], NULL, NULL));
            spar_session_destroy(&b.session);
        }
        print_message("added mass %g: %d evaluations, learning %d\n", ratios[k], sum[0], sum[1]);
        NEAR(largest_difference(q[0], q[1], 7), 0, 1e-9);
        assert_true(sum[1] < 1.1 * sum[0]);
    }
}

/* Noise of 2 per cent of the loads, and a tolerance of 5 times that: the mass is right to the spread that is told,
   over the root of some ten differences, in the direction that moves most: half the spread times structure and fluid;
   it is used. Loads that are nothing but noise are never believed. */
static void noise(void **state) {
    (void)state;
    for (int k = 0; k < RATIOS; k++) {
        double M[36], spread;
        int used;
        pistons p;
        unsigned long long seed = 7;
        learning_piston(&p, ratios[k], SPAR_COUPLING_IQN_ILS, 1);
        OK(p.session, spar_session_set_coupling(p.session, SPAR_COUPLING_IQN_ILS, 1e-12, 0.1, 50));
        for (int step = 0; step < 40; step++) {
            int done = 0;
            p.b[0] = draw(&seed);
            OK(p.session, spar_step_begin(p.session, 0.05));
            while (!done) {
                double a[6], f[3] = {0, 0, 0};
                OK(p.session, spar_step_solve(p.session));
                OK(p.session, spar_member_get_motion(p.body[0], NULL, NULL, a));
                f[0] = (p.b[0] - 2 * ratios[k] * a[0]) * (1 + 0.02 * draw(&seed));
                OK(p.session, spar_fluid_push_forces(p.fluid[0], f, NULL));
                OK(p.session, spar_step_check(p.session, &done));
            }
            OK(p.session, spar_step_accept(p.session));
        }
        OK(p.session, spar_member_get_learned_added_mass(p.body[0], &used, &spread, NULL, 1, NULL, M));
        double off = fabs(M[0] / 2 - ratios[k]) / (1 + ratios[k]);
        print_message("added mass %g, noise: learned %g, off by %.3f of all, spread %.3f\n", ratios[k], M[0] / 2, off,
                      spread);
        assert_true(used && spread > 1e-3 && spread < 0.25 && off < 0.5 * spread);
        pistons_destroy(&p);
    }
    pistons p;
    unsigned long long seed = 9;
    learning_piston(&p, 1, SPAR_COUPLING_FIXED_POINT, 1);
    for (int step = 0; step < 60; step++) {
        int done = 0, used;
        OK(p.session, spar_step_begin(p.session, 0.05));
        for (int i = 0; i < 4; i++) {
            double f[3] = {draw(&seed), 0, 0};
            OK(p.session, spar_step_solve(p.session));
            OK(p.session, spar_fluid_push_forces(p.fluid[0], f, NULL));
            OK(p.session, spar_step_check(p.session, &done));
        }
        OK(p.session, spar_step_accept(p.session));
        OK(p.session, spar_member_get_learned_added_mass(p.body[0], &used, NULL, NULL, 0, NULL, NULL));
        assert_false(used);
    }
    pistons_destroy(&p);
}

/* A fluid whose mass falls to a tenth: what was learned is soon not believed any more, and then the new one is learned;
   the converged answer is right throughout, b / (1 + r). */
static void a_fluid_that_changes(void **state) {
    (void)state;
    pistons p;
    int used, dropped = 0;
    double M[36], a[6];
    unsigned long long seed = 3;
    learning_piston(&p, 10, SPAR_COUPLING_IQN_ILS, 1);
    p.stiffness = 0;
    for (int step = 0; step < 80; step++) {
        p.b[0] = draw(&seed);
        p.ratio[0] = step < 20 ? 10 : 1;
        OK(p.session, spar_step(p.session, 0.05, pistons_fluid, &p, NULL));
        OK(p.session, spar_member_get_motion(p.body[0], NULL, NULL, a));
        NEAR(2 * a[0], p.b[0] / (1 + p.ratio[0]), 1e-7);
        OK(p.session, spar_member_get_learned_added_mass(p.body[0], &used, NULL, NULL, 1, NULL, M));
        assert_true(step != 19 || (used && fabs(M[0] - 20) < 1e-6));
        dropped |= step >= 20 && !used;
    }
    print_message("changed from 20 to 2: learned %g, %s on the way\n", M[0], dropped ? "dropped" : "kept");
    assert_true(dropped && used && fabs(M[0] - 2) < 0.1);
    pistons_destroy(&p);
}

/* ---- beams ---- */

/* A cantilever of length 4, 1 kg/m, in a fluid of added mass across it, at five Gauss points an element, where its
   values are exactly those that a mass linear along the beam has; gusts that change from step to step. */
enum { STRIPS = 10 };
typedef struct fin {
    spar_session *session;
    spar_member *beam;
    spar_fluid *fluid;
    double weight[STRIPS], eta[STRIPS], ratio, taper, gust;
    int by_velocity;
    double before[3 * STRIPS], after[3 * STRIPS];
} fin;

static int fin_fluid(spar_session *s, double t, double dt, int iteration, void *context) {
    fin *f = context;
    double q[4 * STRIPS], a[3 * STRIPS], v[3 * STRIPS], force[3 * STRIPS];
    (void)iteration;
    OK(s, spar_fluid_pull_poses(f->fluid, SPAR_NODES_MOTION, 1, NULL, q, NULL, NULL, a, NULL));
    OK(s, spar_fluid_pull_motion(f->fluid, 1, NULL, v));
    memcpy(f->after, v, sizeof v);
    for (int k = 0; k < STRIPS; k++) {
        double own[3], mean[3], mass = f->ratio * (1 - f->taper * f->eta[k]) * f->weight[k];
        for (int i = 0; i < 3; i++) {
            mean[i] = f->by_velocity ? (v[3 * k + i] - f->before[3 * k + i]) / dt : a[3 * k + i];
        }
        spari_rotate_back(q + 4 * k, mean, own);
        double across[3] = {0, 0, -mass * own[2]};
        spari_rotate(q + 4 * k, across, force + 3 * k);
        force[3 * k + 2] += f->gust * f->weight[k] * (sin(3 * (t + dt)) + 0.5 * f->eta[k] * sin(7 * (t + dt)));
    }
    return spar_fluid_push_forces(f->fluid, force, NULL);
}

typedef struct fin_case {
    int fidelity, modes, learn, by_velocity;
    double ratio, taper, gust;
} fin_case;

static void fin_create(fin *f, const fin_case *c) {
    static const double gauss[5] = {-0.90617984593866399, -0.53846931010568309, 0, 0.53846931010568309,
                                    0.90617984593866399},
                        w[5] = {0.23692688505618909, 0.47862867049936647, 0.56888888888888889, 0.47862867049936647,
                                0.23692688505618909},
                        eta[2] = {0, 1};
    double K[36], M[36], place[3 * STRIPS] = {0};
    memset(f, 0, sizeof *f);
    f->session = scene_session();
    f->ratio = c->ratio, f->taper = c->taper, f->gust = c->gust, f->by_velocity = c->by_velocity;
    scene_diagonal(K, 1e4, 1e4, 1e4, 200, 60, 300);
    scene_diagonal(M, 1, 1, 1, 0.02, 0.01, 0.01);
    f->beam = scene_beam(f->session, "fin", 2, 4, 4, K, M);
    OK(f->session, spar_member_set_root(f->beam, SPAR_ROOT_FIXED));
    OK(f->session, spar_member_set_fidelity(f->beam, c->fidelity, c->modes));
    if (c->fidelity == SPAR_FIDELITY_RIGID) {
        OK(f->session, spar_member_set_root(f->beam, SPAR_ROOT_FREE));
    }
    OK(f->session, spar_member_learn_added_mass(f->beam, c->learn, eta));
    OK(f->session, spar_member_set_added_mass_response(f->beam, c->by_velocity ? SPAR_RESPONSE_VELOCITY
                                                                               : SPAR_RESPONSE_ACCELERATION));
    OK(f->session, spar_member_commit(f->beam));
    for (int k = 0; k < STRIPS; k++) {
        f->weight[k] = w[k % 5], f->eta[k] = 0.25 * (gauss[k % 5] + (k < 5 ? 1 : 3));
        place[3 * k] = 4 * f->eta[k];
    }
    OK(f->session, spar_fluid_create(f->beam, "strips", &f->fluid));
    OK(f->session, spar_fluid_set_stations(f->fluid, STRIPS, f->eta, NULL));
    OK(f->session, spar_fluid_set_motion_nodes(f->fluid, STRIPS, place));
    OK(f->session, spar_fluid_map(f->fluid));
    OK(f->session, spar_session_set_integrator(f->session, 0.9, 1));
    OK(f->session, spar_session_set_coupling(f->session, SPAR_COUPLING_IQN_ILS, 1e-12, 1e-9, 400));
}

/* Steps with the fluid; 0, or the status that ended them. */
static int fin_steps(fin *f, double dt, int steps, int *most) {
    for (int i = 0; i < steps; i++) {
        int n;
        int status = spar_step(f->session, dt, fin_fluid, f, &n);
        if (status != SPAR_OK) {
            return status;
        }
        *most = n > *most ? n : *most;
        memcpy(f->before, f->after, sizeof f->before);
    }
    return SPAR_OK;
}

/* By every fidelity the mass per length across the beam, at one station of a uniform fluid and at both ends of a
   tapered one, to 1e-4 of the largest (of deformed sections the nodes' and the points' axes differ); fixed points then
   take 8 evaluations at most to 1e-9, where without they diverge. */
static void beams(void **state) {
    (void)state;
    static const fin_case cases[] = {
        {SPAR_FIDELITY_EXACT, 0, 1, 0, 0, 0, 0},    {SPAR_FIDELITY_LINEAR, 0, 1, 0, 0, 0, 0},
        {SPAR_FIDELITY_MODAL, 8, 1, 0, 0, 0, 0},    {SPAR_FIDELITY_RIGID, 0, 1, 0, 0, 0, 0},
        {SPAR_FIDELITY_EXACT, 0, 2, 0, 0, 0.6, 0},  {SPAR_FIDELITY_LINEAR, 0, 2, 0, 0, 0.6, 0},
        {SPAR_FIDELITY_MODAL, 12, 2, 0, 0, 0.6, 0}, {SPAR_FIDELITY_RIGID, 0, 2, 0, 0, 0.6, 0}};
    for (size_t n = 0; n < sizeof cases / sizeof *cases * RATIOS; n++) {
        fin_case c = cases[n / RATIOS];
        double M[2][36], eta[2], spread;
        int64_t stations;
        int used, most = 0;
        fin f;
        c.ratio = ratios[n % RATIOS], c.gust = 0.02;
        fin_create(&f, &c);
        OK(f.session, fin_steps(&f, 0.02, 60, &most));
        OK(f.session, spar_member_get_learned_added_mass(f.beam, &used, &spread, &stations, 2, eta, M[0]));
        most = 0;
        OK(f.session, spar_session_set_coupling(f.session, SPAR_COUPLING_FIXED_POINT, 1e-12, 1e-9, 400));
        OK(f.session, fin_steps(&f, 0.02, 10, &most));
        print_message("fidelity %d, added mass %g at %d: %g %g, spread %.1e, fixed point %d\n", c.fidelity, c.ratio,
                      (int)stations, M[0][14], M[1][14], spread, most);
        assert_true(used && stations == c.learn && eta[0] == 0);
        NEAR(M[0][14], c.ratio, 1e-3 * c.ratio);
        if (c.learn > 1) {
            NEAR(M[1][14], 0.4 * c.ratio, 1e-2 * c.ratio);
        }
        assert_true(most <= 8);
        spar_session_destroy(&f.session);
    }
}

static double distance(const double a[7], const double b[7]) {
    double sum = 0;
    for (int k = 0; k < 3; k++) {
        sum += (a[k] - b[k]) * (a[k] - b[k]);
    }
    return sqrt(sum);
}

/* Ten iterated steps, and then explicit ones: the tip stays within 3 per cent of the iterated run's, with order 1 and
   fluids that take accelerations as they are or from velocities at both ends of the step, where without what was
   learned it is lost within 60 steps. */
static void explicit_after(void **state) {
    (void)state;
    for (int n = 0; n < RATIOS * 2; n++) {
        fin_case c = {SPAR_FIDELITY_EXACT, 0, 1, n / RATIOS, ratios[n % RATIOS], 0, 2};
        double tip[3][7];
        int status[3], most = 0;
        for (int way = 0; way < 3; way++) { /* iterated; learned; without */
            fin f;
            c.learn = way < 2;
            fin_create(&f, &c);
            OK(f.session, fin_steps(&f, 0.02, 10, &most));
            if (way > 0) {
                OK(f.session, spar_session_set_coupling(f.session, SPAR_COUPLING_EXPLICIT, 1e-12, 1e-9, 400));
            }
            status[way] = fin_steps(&f, 0.02, 90, &most);
            scene_tip(f.beam, tip[way]);
            spar_session_destroy(&f.session);
        }
        const double rest[7] = {0};
        double size = distance(tip[0], rest);
        print_message("added mass %g, by velocity %d: explicit off by %.2e of %.2e; without %.2e\n", c.ratio,
                      c.by_velocity, distance(tip[1], tip[0]), size, distance(tip[2], tip[0]));
        assert_true(status[1] == SPAR_OK && distance(tip[1], tip[0]) < 0.03 * size);
        assert_true(c.by_velocity || status[2] == SPAR_ERR_NUMERIC || distance(tip[2], tip[0]) > size);
    }
}

/* ---- accelerations from velocities ---- */

typedef struct vessel {
    spar_session *session;
    spar_member *body;
    spar_fluid *fluid;
    double added, v0;
} vessel;

static int vessel_fluid(spar_session *s, double t, double dt, int iteration, void *context) {
    const vessel *b = context;
    double v[6], f[3] = {0, 0, 0};
    (void)t, (void)iteration;
    OK(s, spar_member_get_motion(b->body, NULL, v, NULL));
    f[0] = -b->added * (v[0] - b->v0) / dt;
    return spar_fluid_push_forces(b->fluid, f, NULL);
}

/* A body of 2 kg on a spring of its own in a fluid that is an added mass times the change of the velocity over the
   step. With the guess that belongs to it, gamma (1 - alpha_f) / (1 - alpha_m) of the mass, what is extrapolated is
   nothing: explicit coupling with every predictor is the iterated one, to what that leaves (1e-11 of the loads through
   100 steps: 1e-9 of the largest way), at all ratios and any numerical damping, with a step that changes once. */
static void explicit_is_iterated(void **state) {
    (void)state;
    static const double damping[] = {0.2, 0.9, 1};
    for (int n = 0; n < RATIOS * 9; n++) {
        double ratio = ratios[n % RATIOS], rho = damping[n / RATIOS % 3], am = (2 * rho - 1) / (rho + 1),
               af = rho / (rho + 1), answer = (0.5 + af - am) * (1 - af) / (1 - am), x[2][100], largest = 0;
        for (int way = 0; way < 2; way++) {
            static const double origin[3] = {0, 0, 0}, q[4] = {1, 0, 0, 0}, J[3] = {1, 1, 1}, v0[3] = {1, 0, 0};
            double mass[36], K[36], pose[7], v[6];
            vessel b = {.session = scene_session(), .added = 2 * ratio, .v0 = 1};
            scene_mass(mass, 2, origin, J);
            OK(b.session, spar_rigid_create(b.session, "vessel", origin, q, mass, &b.body));
            scene_diagonal(mass, answer * b.added, 0, 0, 0, 0, 0);
            OK(b.session, spar_member_set_added_mass(b.body, 1, NULL, mass));
            OK(b.session,
               spar_member_set_added_mass_response(b.body, way ? SPAR_RESPONSE_VELOCITY : SPAR_RESPONSE_ACCELERATION));
            OK(b.session, spar_member_commit(b.body));
            OK(b.session, spar_fluid_create(b.body, "fluid", &b.fluid));
            OK(b.session, spar_fluid_set_motion_nodes(b.fluid, 1, origin));
            OK(b.session, spar_fluid_set_force_nodes(b.fluid, 1, origin));
            OK(b.session, spar_fluid_map(b.fluid));
            scene_diagonal(K, 20 * (1 + ratio), 0, 0, 0, 0, 0);
            OK(b.session, spar_spring_create(b.session, "spring", b.body, 0, SPAR_FREE_X, K, NULL, NULL, NULL));
            OK(b.session, spar_member_set_initial_velocity(b.body, NULL, v0, NULL));
            OK(b.session, spar_session_set_integrator(b.session, rho, 1));
            OK(b.session, spar_session_set_predictor(b.session, n / (RATIOS * 3)));
            OK(b.session, spar_session_set_coupling(b.session, way ? SPAR_COUPLING_EXPLICIT : SPAR_COUPLING_IQN_ILS,
                                                    1e-13, 1e-11, 100));
            for (int i = 0; i < 100; i++) {
                OK(b.session, spar_step(b.session, i < 50 ? 0.05 : 0.03, vessel_fluid, &b, NULL));
                OK(b.session, spar_member_get_motion(b.body, pose, v, NULL));
                x[way][i] = pose[0], b.v0 = v[0];
                largest = fmax(largest, fabs(pose[0]));
            }
            spar_session_destroy(&b.session);
        }
        double off = largest_difference(x[0], x[1], 100);
        print_message("order %d, rho_inf %g, added mass %g: off by %.1e of %.1e\n", n / (RATIOS * 3), rho, ratio, off,
                      largest);
        double before = largest_difference(x[0], x[1], 50);
        NEAR(before, 0, 1e-9 * largest);
        NEAR(off, 0, 1e-3 * largest);
    }
}

/* ---- what is refused ---- */

/* What is given is read; what cannot be is refused with its reason. */
static void refusals(void **state) {
    (void)state;
    static const double x[3] = {0, 0, 0}, q[4] = {1, 0, 0, 0}, J[3] = {1, 1, 1}, eta[3] = {0, 0.5, 1},
                        back[2] = {0.5, 0.2};
    double mass[36], K[36], got[4], M[4 * 36], spread;
    int64_t n;
    int used;
    spar_session *s = scene_session();
    spar_member *body, *beam, *point;
    scene_mass(mass, 1, x, J);
    scene_diagonal(K, 1, 1, 1, 1, 1, 1);
    OK(s, spar_rigid_create(s, "body", x, q, mass, &body));
    OK(s, spar_point_create(s, "point", x, q, &point));
    beam = scene_beam(s, "beam", 1, 3, 1, K, K);
    OK(s, spar_member_get_learned_added_mass(beam, &used, &spread, &n, 1, got, M));
    assert_true(n == 0 && used == 0 && spread == 1 && got[0] == 0 && M[0] == 0);
    OK(s, spar_member_learn_added_mass(beam, 3, eta));
    OK(s, spar_member_get_learned_added_mass(beam, &used, &spread, &n, 4, got, M));
    assert_true(n == 3 && got[1] == 0.5 && got[3] == 0 && used == 0);
    const struct {
        spar_member *m;
        int64_t n;
        const double *eta;
        int status;
        const char *why;
    } bad[] = {{beam, -1, eta, SPAR_ERR_ARGUMENT, "stations"}, {beam, 21, eta, SPAR_ERR_ARGUMENT, "stations"},
               {body, 2, eta, SPAR_ERR_ARGUMENT, "stations"},  {beam, 1, NULL, SPAR_ERR_ARGUMENT, "eta is NULL"},
               {beam, 2, back, SPAR_ERR_ARGUMENT, "eta"},      {point, 1, eta, SPAR_ERR_UNSUPPORTED, "point"},
               {NULL, 1, eta, SPAR_ERR_ARGUMENT, NULL}};
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        assert_int_equal(spar_member_learn_added_mass(bad[k].m, bad[k].n, bad[k].eta), bad[k].status);
        assert_true(!bad[k].why || strstr(spar_session_message(s), bad[k].why));
    }
    OK(s, spar_member_get_learned_added_mass(beam, NULL, NULL, &n, 0, NULL, NULL));
    assert_int_equal(n, 3);
    assert_int_equal(spar_member_get_learned_added_mass(beam, NULL, NULL, &n, -1, NULL, NULL), SPAR_ERR_ARGUMENT);
    int response;
    OK(s, spar_member_get_added_mass_response(beam, &response));
    assert_int_equal(response, SPAR_RESPONSE_ACCELERATION);
    OK(s, spar_member_set_added_mass_response(beam, SPAR_RESPONSE_VELOCITY));
    REFUSED(s, SPAR_ERR_ARGUMENT, "response 2", spar_member_set_added_mass_response(beam, 2));
    REFUSED(s, SPAR_ERR_UNSUPPORTED, "point", spar_member_set_added_mass_response(point, SPAR_RESPONSE_VELOCITY));
    REFUSED(s, SPAR_ERR_ARGUMENT, "NULL", spar_member_get_added_mass_response(beam, NULL));
    OK(s, spar_member_get_added_mass_response(beam, &response));
    assert_int_equal(response, SPAR_RESPONSE_VELOCITY);
    OK(s, spar_member_set_external(beam, 1));
    assert_int_equal(spar_member_commit(beam), SPAR_ERR_UNSUPPORTED);
    assert_non_null(strstr(spar_session_message(s), "does not apply to prescribed members"));
    OK(s, spar_member_learn_added_mass(beam, 0, NULL));
    OK(s, spar_member_commit(beam));
    OK(s, spar_member_commit(body));
    assert_int_equal(spar_member_learn_added_mass(body, 1, NULL), SPAR_ERR_STATE);
    REFUSED(s, SPAR_ERR_STATE, "committed", spar_member_set_added_mass_response(body, SPAR_RESPONSE_VELOCITY));
    spar_session_destroy(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(whole_of_a_body),
        cmocka_unit_test(piston),
        cmocka_unit_test(answer_stays),
        cmocka_unit_test(noise),
        cmocka_unit_test(a_fluid_that_changes),
        cmocka_unit_test(beams),
        cmocka_unit_test(explicit_after),
        cmocka_unit_test(explicit_is_iterated),
        cmocka_unit_test(refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
