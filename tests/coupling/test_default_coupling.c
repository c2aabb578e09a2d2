/* All defaults with a heavy fluid. Set-up: a body of 2 kg on a spring that holds it to the ground, in a fluid that
   pushes a load b(t) and the load of its added mass. The oracles know nothing of the coupling: a body with both masses
   under b(t) alone, by the same time integration, and the closed form of the same equation. Expected: within 1e-6 of
   the first for any added mass. */
#include "scene.h"

#include <stdio.h>

enum { STEPS = 200 };

typedef struct sprung {
    spar_session *s;
    spar_member *body;
    spar_fluid *fluid;
    double mass, added;                 /* of the body, of the fluid, kg */
    int by_velocity;                    /* the fluid takes accelerations from the velocities at both ends of the step */
    double v[3];                        /* velocity at t^n */
    double (*load)(double t, void *of); /* b(t) */
    void *of;
    int calls;
} sprung;

static const double body_mass = 2, period = 1, pi = 3.14159265358979323846;

/* Stiffness for the period of body and fluid together. */
static double stiffness_of(double mass) {
    return mass * (2 * pi / period) * (2 * pi / period);
}

/* mass: of the body; added: of the fluid; the spring belongs to both together. strict: settings of the oracle */
static void create(sprung *w, double mass, double added) {
    static const double x[3] = {0}, box[3] = {1, 1, 1};
    double M[36], K[36];
    const double k = stiffness_of(mass + added);
    memset(w, 0, sizeof *w);
    OK(NULL, spar_session_create(&w->s));
    w->mass = mass, w->added = added;
    scene_mass(M, mass, x, box);
    scene_diagonal(K, k, k, k, 1, 1, 1);
    OK(w->s, spar_rigid_create(w->s, "body", x, NULL, M, &w->body));
    OK(w->s, spar_member_commit(w->body));
    spar_joint *spring = scene_joint(w->s, "spring", w->body, 0, NULL, 0, 63);
    OK(w->s, spar_joint_set_spring(spring, K, NULL, NULL));
    OK(w->s, spar_fluid_create(w->body, "water", &w->fluid));
    OK(w->s, spar_fluid_set_motion_nodes(w->fluid, 1, x));
    OK(w->s, spar_fluid_set_force_nodes(w->fluid, 1, x));
    OK(w->s, spar_fluid_map(w->fluid));
}

static int solve(spar_session *s, double t, double dt, int iteration, void *context) {
    sprung *w = context;
    double q[7], v[6], a[6], b = w->load(t + dt, w->of);
    w->calls++;
    OK(s, spar_member_get_motion(w->body, q, v, a));
    if (iteration == 0) {
        OK(s, spar_fluid_pull_motion(w->fluid, 0, NULL, w->v));
    }
    for (int k = 0; k < 3; k++) {
        a[k] = w->by_velocity ? (v[k] - w->v[k]) / dt : a[k];
    }
    const double force[3] = {b - w->added * a[0], 0.5 * b - w->added * a[1], -w->added * a[2]};
    return spar_fluid_push_forces(w->fluid, force, NULL);
}

static void place(const sprung *w, double x[3]) {
    double q[7];
    OK(w->s, spar_member_get_motion(w->body, q, NULL, NULL));
    memcpy(x, q, 3 * sizeof *x);
}

static double slow(double t, void *of) {
    (void)of;
    return sin(4 * t);
}

/* ---- all defaults ---- */

static void test_heavy_body(void **state) {
    (void)state;
    static const double ratios[] = {0.2, 0.5, 1, 4, 100};
    const double dt = 0.02, omega = 2 * pi / period;
    for (size_t r = 0; r < sizeof ratios / sizeof *ratios; r++) {
        sprung w, whole;
        double off = 0, form = 0, most = 0;
        create(&w, body_mass, ratios[r] * body_mass);
        create(&whole, (1 + ratios[r]) * body_mass, 0);
        OK(whole.s, spar_session_set_option(whole.s, "newton.stop", "strict"));
        /* its loads do not depend on the motion: the second evaluation confirms the first */
        OK(whole.s, spar_session_set_coupling(whole.s, SPAR_COUPLING_FIXED_POINT, 0, 1e-14, 2));
        w.load = whole.load = slow;
        for (int i = 0; i < STEPS; i++) {
            double x[3], y[3], t = (i + 1) * dt;
            OK(w.s, spar_step(w.s, dt, solve, &w, NULL));
            OK(whole.s, spar_step(whole.s, dt, solve, &whole, NULL));
            place(&w, x), place(&whole, y);
            /* M x'' + k x = sin(4 t) from rest */
            double exact = (sin(4 * t) - 4 / omega * sin(omega * t)) / (whole.mass * (omega * omega - 16));
            for (int k = 0; k < 3; k++) {
                off = fmax(off, fabs(x[k] - y[k]));
                most = fmax(most, fabs(y[k]));
            }
            form = fmax(form, fabs(x[0] - exact));
        }
        print_message("added mass %g: off by %.1e of the oracle, %.1e of the closed form; %.2f evaluations a step\n",
                      ratios[r], off / most, form / most, (double)w.calls / STEPS);
        assert_true(off <= 1e-6 * most);
        assert_true(form <= 2e-2 * most); /* dt */
        spar_session_destroy(&w.s), spar_session_destroy(&whole.s);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_heavy_body)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
