/* Any sequence of steps, as random_steps.c, of mechanisms: loops, links, universal joints, sliders, driven hinges, a
   chain, a turbine, beams of each fidelity on joints and on driven roots. Three things hold:
   - The energy of members and springs, less what drives and loads give and with what dampers take, stays below what it
     began with, but for the error of the step: with the scene's largest angular velocity W and its time T, an order of
     two leaves (W h)^2 (1/4 + 0.08 W T) of the largest kinetic energy. 0.08 is twice the error constant of TR-BDF2
     (0.0404, Hosea and Shampine 1996), for velocities and per radian; 1/4 what energy and the scheme's own one differ
     by within an oscillation. Of a spring that goes slack W is at least its frequency: a step of h that ends within it
     takes its force for up to h too long.
   - The largest force is within 1.5 of that of even steps.
   - Motion, velocities, accelerations and forces converge with order 2, with at most twice the error of even steps.
   SPAR_SEQUENCES=N runs 8 N random sequences of each scene in place of 8. */
#include "sequences.h"

enum {
    FOUR_BAR,
    BENDING_BAR,
    ROPES,
    RODS,
    UNIVERSAL,
    CART,
    DRIVEN,
    SLEEVE,
    BUSHING,
    CHAIN,
    TURBINE,
    HINGED,
    DRIVEN_LINEAR,
    DRIVEN_MODAL,
    DRIVEN_PINNED,
    SCENES
};

typedef struct scene {
    const char *name;
    double h, time;
    double frequency; /* of springs that go slack */
    int first;        /* forces: 0; moments: 3 */
    int energy;       /* 0: its members' energies do not sum up (linear and modal ones on a root that turns) */
} scene;

static const scene scenes[SCENES] = {
    [FOUR_BAR] = {"four-bar", 0.01, 0.8, 0, 0, 1},
    [BENDING_BAR] = {"four-bar that bends", 0.005, 0.6, 0, 0, 1},
    [ROPES] = {"ropes and a spring", 0.005, 0.8, 32, 0, 1},
    [RODS] = {"platform on rods", 0.01, 0.8, 0, 0, 1},
    [UNIVERSAL] = {"universal joint", 0.01, 0.8, 0, 0, 1},
    [CART] = {"slider with a spring", 0.01, 0.8, 0, 0, 1},
    [DRIVEN] = {"driven hinge", 0.01, 0.8, 0, 0, 1},
    [SLEEVE] = {"sleeve and plate", 0.01, 0.8, 0, 0, 1},
    [BUSHING] = {"stiff bushing", 0.01, 0.8, 0, 0, 1},
    [CHAIN] = {"chain of 10", 0.005, 0.4, 0, 0, 1},
    [TURBINE] = {"turbine", 0.02, 0.6, 0, 3, 1},
    [HINGED] = {"beam in two halves", 0.005, 0.4, 0, 0, 1},
    [DRIVEN_LINEAR] = {"linear beam, driven root", 0.002, 0.3, 0, 0, 0},
    [DRIVEN_MODAL] = {"modal beam, driven root", 0.002, 0.3, 0, 0, 0},
    [DRIVEN_PINNED] = {"arm on a driven point", 0.005, 0.4, 0, 0, 1},
};

/* ---- parts ---- */

static const double origin[3] = {0, 0, 0}, straight[4] = {1, 0, 0, 0};

/* A rigid body with its node at its centre. */
static spar_member *body(sequence_world *w, const char *name, const double x[3], double m, double a, double b,
                         double c) {
    double mass[36];
    spar_member *p = NULL;
    scene_mass(mass, m, origin, (double[]){a, b, c});
    OK(w->s, spar_rigid_create(w->s, name, x, straight, mass, &p));
    OK(w->s, spar_member_set_effects(p, SPAR_EFFECT_WORK, 0));
    OK(w->s, spar_member_commit(p));
    return w->m[w->members++] = p;
}

/* A thin rod of mass m from a to b, its node half way. */
static spar_member *rod(sequence_world *w, const char *name, const double a[3], const double b[3], double m) {
    double x[3], length = 0;
    for (int i = 0; i < 3; i++) {
        x[i] = 0.5 * (a[i] + b[i]);
        length += (b[i] - a[i]) * (b[i] - a[i]);
    }
    return body(w, name, x, m, 0.1 * m * length / 12, m * length / 12, m * length / 12);
}

/* A beam of 6 nodes from a to b; diameter of a steel tube's bending, or what K and M say. */
static spar_member *beam(sequence_world *w, const char *name, const double a[3], const double b[3], const double *K,
                         const double *M, int root, int fidelity, int modes) {
    const double eta[2] = {0, 1}, line[6] = {a[0], a[1], a[2], b[0], b[1], b[2]};
    spar_member *p = NULL;
    OK(w->s, spar_beam_create(w->s, name, 1, 6, &p));
    OK(w->s, spar_beam_set_axis(p, 2, eta, line, NULL));
    OK(w->s, spar_beam_set_sections(p, 1, eta, K, M));
    OK(w->s, spar_member_set_root(p, root));
    OK(w->s, spar_member_set_effects(p, SPAR_EFFECT_WORK, 0));
    OK(w->s, spar_member_set_fidelity(p, fidelity, fidelity == SPAR_FIDELITY_MODAL ? modes : 0));
    OK(w->s, spar_member_commit(p));
    return w->m[w->members++] = p;
}

static spar_joint *joint(sequence_world *w, const char *name, spar_member *a, int64_t node_a, spar_member *b,
                         int64_t node_b, int free_motions, const double x[3]) {
    return w->j[w->joints++] = scene_joint_at(w->s, name, a, node_a, b, node_b, free_motions, x);
}

/* Round steel of diameter d. */
static void steel(double d, double *K, double *M) {
    const double pi = 3.14159265358979323846, A = pi * d * d / 4, I = A * d * d / 16, E = 2.1e11, G = E / 2.6,
                 rho = 7850;
    scene_diagonal(K, E * A, 0.9 * G * A, 0.9 * G * A, 2 * G * I, E * I, E * I);
    scene_diagonal(M, rho * A, rho * A, rho * A, 2 * rho * I, rho * I, rho * I);
}

/* 1 kg/m, EI 1e3: clamped, 1 m, 18 Hz. */
static void soft(double *K, double *M) {
    scene_diagonal(K, 1e6, 1e6, 1e6, 1e3, 1e3, 1e3);
    scene_diagonal(M, 1, 1, 1, 2e-3, 1e-3, 1e-3);
}

/* ---- scenes ---- */

/* Crank, coupler and rocker on parallel hinges; falls from rest. bends: the coupler is a steel bar of 20 mm. */
static void four_bar(sequence_world *w, int bends) {
    const double A[3] = {0, 0, 0}, B[3] = {0.1, 0, 0.3}, C[3] = {0.8, 0, 0.5}, D[3] = {0.7, 0, 0};
    spar_member *crank = rod(w, "crank", A, B, 1), *rocker = rod(w, "rocker", D, C, 1.5), *coupler;
    int64_t last = 0;
    if (bends) {
        double K[36], M[36];
        steel(0.02, K, M);
        coupler = beam(w, "coupler", B, C, K, M, SPAR_ROOT_FREE, SPAR_FIDELITY_EXACT, 0);
        last = 5;
    } else {
        coupler = rod(w, "coupler", B, C, 2);
    }
    joint(w, "A", crank, 0, NULL, 0, SPAR_FREE_RY, A);
    joint(w, "B", coupler, 0, crank, 0, SPAR_FREE_RY, B);
    joint(w, "C", rocker, 0, coupler, last, SPAR_FREE_RY, C);
    joint(w, "D", rocker, 0, NULL, 0, SPAR_FREE_RY, D);
}

/* A body hangs from two ropes, one slack at first, and on a strut with a spring and a damper. 1 kg, 500 N/m. */
static void ropes(sequence_world *w) {
    spar_member *b = body(w, "body", origin, 1, 0.02, 0.03, 0.04);
    const double p[3][3] = {{-0.1, 0, 0.1}, {0.1, 0.05, 0.1}, {0, 0, -0.1}},
                 q[3][3] = {{-0.6, 0, 1}, {0.7, 0, 0.9}, {0.3, 0.4, -0.8}};
    static const char *const names[3] = {"rope", "slack rope", "strut"};
    for (int i = 0; i < 3; i++) {
        const double k = i < 2 ? 500 : 40, rest = i ? 1.05 : 1,
                     length = hypot(hypot(q[i][0] - p[i][0], q[i][1] - p[i][1]), q[i][2] - p[i][2]);
        OK(w->s, spar_link_create(w->s, names[i], b, 0, p[i], NULL, 0, q[i], &w->j[w->joints]));
        OK(w->s, spar_link_set_spring(w->j[w->joints++], k, i < 2 ? 0 : 1, rest, i < 2));
        w->stored += 0.5 * k * pow(i < 2 ? fmax(length - rest, 0) : length - rest, 2);
    }
    OK(w->s, spar_member_set_initial_velocity(b, origin, (double[]){0.5, 0.3, 1}, (double[]){0.5, 1, 0.3}));
}

/* A platform on two rods of unequal length: it swings as a loop without hinges does. */
static void rods(sequence_world *w) {
    spar_member *b = body(w, "platform", origin, 2, 0.02, 0.15, 0.15);
    const double p[2][3] = {{-0.4, 0, 0}, {0.4, 0.1, 0}}, q[2][3] = {{-0.7, 0, 0.6}, {0.3, 0.2, 0.9}};
    for (int i = 0; i < 2; i++) {
        OK(w->s, spar_link_create(w->s, i ? "long" : "short", b, 0, p[i], NULL, 0, q[i], &w->j[w->joints++]));
    }
}

/* An arm hangs from a universal joint, a second one from a universal joint at its end. */
static void universal(sequence_world *w) {
    const double x[3][3] = {{0, 0, 0}, {0.3, 0.1, -0.4}, {0.3, 0.3, -0.8}};
    spar_member *upper = rod(w, "upper", x[0], x[1], 1), *lower = rod(w, "lower", x[1], x[2], 1);
    joint(w, "above", upper, 0, NULL, 0, SPAR_FREE_RX | SPAR_FREE_RY, x[0]);
    joint(w, "between", lower, 0, upper, 0, SPAR_FREE_RX | SPAR_FREE_RY, x[1]);
    OK(w->s, spar_member_set_initial_velocity(upper, origin, NULL, (double[]){1, 1, 0}));
    OK(w->s, spar_member_set_initial_velocity(lower, origin, NULL, (double[]){1, 1, 0}));
}

/* A cart on a slope with a spring and a damper; a rod swings below it. */
static void cart(sequence_world *w) {
    const double q[4] = {cos(0.2), 0, sin(0.2), 0}, end[3] = {0.5, 0, -0.2}, k[36] = {[0] = 100}, c[36] = {[0] = 0.5};
    spar_member *b = body(w, "cart", origin, 1, 0.01, 0.01, 0.01), *r = rod(w, "rod", origin, end, 1);
    spar_joint *slide = joint(w, "slide", b, 0, NULL, 0, SPAR_FREE_X, origin);
    OK(w->s, spar_joint_set_frame(slide, origin, q));
    OK(w->s, spar_joint_set_spring(slide, k, c, NULL));
    joint(w, "pin", r, 0, b, 0, SPAR_FREE_RY, origin);
}

/* A hinge about z drives an arm; from its end a rod swings on a ball. */
static void driven(sequence_world *w) {
    const double a[3] = {0.5, 0, 0}, b[3] = {0.9, 0, -0.1};
    spar_member *arm = rod(w, "arm", origin, a, 1), *end = rod(w, "end", a, b, 0.5);
    spar_joint *motor = joint(w, "motor", arm, 0, NULL, 0, SPAR_FREE_RZ, origin);
    OK(w->s, spar_joint_set_driven(motor, SPAR_FREE_RZ));
    joint(w, "ball", end, 0, arm, 0, SPAR_FREE_RX | SPAR_FREE_RY | SPAR_FREE_RZ, a);
}

/* A sleeve slides and turns on a shaft that slopes, and carries a plate that slides and turns in a plane. */
static void sleeve(sequence_world *w) {
    const double q[4] = {cos(0.2), 0, sin(0.2), 0}, x[3] = {0, 0.3, 0}, y[3] = {0.2, 0.5, 0.1};
    spar_member *a = body(w, "sleeve", x, 1, 0.02, 0.03, 0.04), *b = body(w, "plate", y, 0.5, 0.01, 0.01, 0.02);
    OK(w->s, spar_joint_set_frame(joint(w, "shaft", a, 0, NULL, 0, SPAR_FREE_X | SPAR_FREE_RX, origin), origin, q));
    joint(w, "plane", b, 0, a, 0, SPAR_FREE_X | SPAR_FREE_Y | SPAR_FREE_RZ, x);
}

/* A rod on a ball, and a second one on a bushing at its end: 1e8 N/m, 1e6 N m/rad. */
static void bushing(sequence_world *w) {
    const double a[3] = {0.5, 0, 0}, b[3] = {1, 0, 0},
                 k[36] = {[0] = 1e8, [7] = 1e8, [14] = 1e8, [21] = 1e6, [28] = 1e6, [35] = 1e6};
    spar_member *upper = rod(w, "upper", origin, a, 1), *lower = rod(w, "lower", a, b, 1);
    joint(w, "ball", upper, 0, NULL, 0, SPAR_FREE_RX | SPAR_FREE_RY | SPAR_FREE_RZ, origin);
    OK(w->s, spar_joint_set_spring(joint(w, "bushing", lower, 0, upper, 0, 63, a), k, NULL, NULL));
    for (int i = 0; i < 2; i++) {
        OK(w->s, spar_member_set_initial_velocity(w->m[i], origin, NULL, (double[]){0.5, 1, 3}));
    }
}

static void chain(sequence_world *w) {
    for (int i = 0; i < 10; i++) {
        char name[8] = {'l', (char)('0' + i), 0};
        const double a[3] = {0.2 * i, 0, 0}, b[3] = {0.2 * (i + 1), 0, 0};
        rod(w, name, a, b, 0.2);
        joint(w, name, w->m[i], 0, i ? w->m[i - 1] : NULL, 0, SPAR_FREE_RX | SPAR_FREE_RY | SPAR_FREE_RZ, a);
    }
}

/* 10 m of tower, a nacelle, a shaft that is driven, a hub and three blades of 4 m, which bend at 5 Hz. */
static void turbine(sequence_world *w) {
    double K[36], M[36];
    const double top[3] = {0, 0, 10}, hub[3] = {-1, 0, 10.2};
    scene_diagonal(K, 4e8, 1e8, 1e8, 8e7, 1e8, 1e8);
    scene_diagonal(M, 80, 80, 80, 20, 10, 10);
    spar_member *tower = beam(w, "tower", origin, top, K, M, SPAR_ROOT_FIXED, SPAR_FIDELITY_EXACT, 0);
    spar_member *nacelle = body(w, "nacelle", top, 400, 100, 200, 200), *rotor = body(w, "hub", hub, 100, 10, 8, 8);
    joint(w, "yaw", nacelle, 0, tower, 5, 0, top);
    spar_joint *shaft = joint(w, "shaft", rotor, 0, nacelle, 0, SPAR_FREE_RX, hub);
    OK(w->s, spar_joint_set_driven(shaft, SPAR_FREE_RX));
    scene_diagonal(K, 2e7, 5e6, 5e6, 1e5, 1e5, 2e5);
    scene_diagonal(M, 5, 5, 5, 0.04, 0.02, 0.02);
    for (int b = 0; b < 3; b++) {
        const double turn = 2 * 3.14159265358979323846 / 3 * b, c = cos(turn), s = sin(turn);
        const double near[3] = {hub[0], hub[1] - 0.3 * s, hub[2] + 0.3 * c},
                     far[3] = {hub[0] - 0.1, hub[1] - 4.3 * s, hub[2] + 4.3 * c};
        char name[8] = {'b', (char)('1' + b), 0};
        spar_member *blade = beam(w, name, near, far, K, M, SPAR_ROOT_FREE, SPAR_FIDELITY_EXACT, 0);
        joint(w, name, blade, 0, rotor, 0, 0, near);
    }
}

/* A beam of 1 m, of two halves, on a hinge falls. */
static void hinged(sequence_world *w) {
    const double half[3] = {0.5, 0, 0}, end[3] = {1, 0, 0};
    double K[36], M[36];
    soft(K, M);
    spar_member *inner = beam(w, "inner", origin, half, K, M, SPAR_ROOT_FREE, SPAR_FIDELITY_EXACT, 0);
    joint(w, "hinge", inner, 0, NULL, 0, SPAR_FREE_RY, origin);
    spar_member *outer = beam(w, "outer", half, end, K, M, SPAR_ROOT_FREE, SPAR_FIDELITY_EXACT, 0);
    joint(w, "weld", outer, 0, inner, 5, 0, half);
}

/* A point that is driven carries an arm on a hinge. */
static void pinned(sequence_world *w) {
    const double end[3] = {0.6, 0, 0};
    double K[36], M[36];
    soft(K, M);
    spar_member *a = beam(w, "carrier", origin, end, K, M, SPAR_ROOT_DRIVEN, SPAR_FIDELITY_EXACT, 0);
    spar_member *arm = rod(w, "arm", end, (double[]){1, 0, 0}, 0.3);
    joint(w, "hinge", arm, 0, a, 5, SPAR_FREE_RY, end);
}

static sequence_world make(int kind, double rho) {
    double K[36], M[36];
    sequence_world w = {.s = scene_session()};
    OK(w.s, spar_session_set_integrator(w.s, rho, 1));
    OK(w.s, spar_session_set_newton(w.s, 1e-15, 1e-8, 50));
    OK(w.s, spar_session_set_gravity(w.s, (double[]){0, 0, -9.81}));
    soft(K, M);
    switch (kind) {
    case FOUR_BAR:
    case BENDING_BAR:
        four_bar(&w, kind == BENDING_BAR);
        break;
    case ROPES:
        ropes(&w);
        break;
    case RODS:
        rods(&w);
        break;
    case UNIVERSAL:
        universal(&w);
        break;
    case CART:
        cart(&w);
        break;
    case DRIVEN:
        driven(&w);
        break;
    case SLEEVE:
        sleeve(&w);
        break;
    case BUSHING:
        bushing(&w);
        break;
    case CHAIN:
        chain(&w);
        break;
    case TURBINE:
        turbine(&w);
        break;
    case HINGED:
        hinged(&w);
        break;
    case DRIVEN_PINNED:
        pinned(&w);
        break;
    default:
        beam(&w, "beam", origin, (double[]){1, 0, 0}, K, M, SPAR_ROOT_DRIVEN,
             kind == DRIVEN_LINEAR ? SPAR_FIDELITY_LINEAR : SPAR_FIDELITY_MODAL, 8);
    }
    return w;
}

/* Angle W (t - sin t), from rest without a jump of its acceleration, of motor, shaft or root. */
static void step(sequence_world *w, int kind, double dt) {
    const double t = w->t += dt, W = kind == TURBINE || kind == DRIVEN_LINEAR || kind == DRIVEN_MODAL ? 30 : 4,
                 turn = W * (t - sin(t)), rate = W * (1 - cos(t)), acceleration = W * sin(t);
    if (kind == DRIVEN || kind == TURBINE) {
        int axis = kind == DRIVEN ? 5 : 3;
        double z[6] = {0}, zt[6] = {0}, ztt[6] = {0};
        z[axis] = turn, zt[axis] = rate, ztt[axis] = acceleration;
        OK(w->s, spar_joint_drive(w->j[kind == DRIVEN ? 0 : 1], z, zt, ztt));
    }
    if (kind >= DRIVEN_LINEAR) {
        const double q[7] = {0, 0, 0, cos(turn / 2), 0, 0, sin(turn / 2)}, v[6] = {0, 0, 0, 0, 0, rate},
                     a[6] = {0, 0, 0, 0, 0, acceleration};
        OK(w->s, spar_member_drive(w->m[0], q, v, a));
    }
    OK(w->s, spar_step(w->s, dt, NULL, NULL, NULL));
}

/* ---- sequences ---- */

typedef struct found {
    double force, gain, spin; /* the largest; gain by the largest kinetic energy, or the first */
} found;

static found run(int kind, double rho, int pattern, double h, double factor) {
    sequence_world w = make(kind, rho);
    double size, first = w.stored + sequence_energy(&w, &size), gain = 0, most = fabs(first);
    found f = {0, 0, 0};
    for (int k = 0; w.t < scenes[kind].time; k++) {
        double kinetic;
        step(&w, kind, sequence_step(pattern, k, h, factor));
        f.force = fmax(f.force, sequence_force(&w, scenes[kind].first));
        gain = fmax(gain, sequence_energy(&w, &kinetic) - first);
        most = fmax(most, kinetic);
        f.spin = fmax(f.spin, sequence_spin(&w));
    }
    f.gain = scenes[kind].energy ? gain / most : 0;
    spar_session_destroy(&w.s);
    return f;
}

typedef struct tally {
    int sequences, failed;
    double gain, force; /* the worst: gain, and ratio of the force to that of even steps */
} tally;

static void check(int kind, double rho, int pattern, double factor, const found *even, tally *sum) {
    const scene *s = scenes + kind;
    double W = fmax(even->spin, s->frequency), h = 1.5 * s->h,
           bound = W * h * W * h * (0.25 + 0.08 * W * s->time) + 1e-3, most = 1.5;
    found f = run(kind, rho, pattern, s->h, factor);
    sum->sequences++;
    sum->gain = fmax(sum->gain, f.gain);
    sum->force = fmax(sum->force, f.force / even->force);
    if (!(f.force < most * even->force) || !(f.gain < bound)) {
        print_message("%s, rho_inf %g, sequence %d over %g: force %g for %g, gain %.1e, at most %.1e\n", s->name, rho,
                      pattern, factor, f.force, even->force, f.gain, bound);
        sum->failed++;
    }
}

static void test_energy_and_forces(void **state) {
    (void)state;
    int failed = 0;
    for (int kind = 0; kind < SCENES; kind++) {
        const found even = run(kind, 0.9, EVEN, scenes[kind].h, 1);
        tally sum = {0};
        for (int pattern = ONE_PERCENT; pattern < RANDOM; pattern++) {
            check(kind, 0.9, pattern, 1, &even, &sum);
            check(kind, 0, pattern, 1, &even, &sum);
        }
        for (int k = 0; k < sequence_count(1); k++) {
            int pattern;
            double factor, rho;
            sequence_take(kind, k, &pattern, &factor, &rho);
            check(kind, rho, pattern, factor, &even, &sum);
        }
        print_message("%-26s %5d sequences: worst gain %.1e, force %.3f (even %.4g, spin %.3g)\n", scenes[kind].name,
                      sum.sequences, sum.gain, sum.force, even.force, even.spin);
        failed += sum.failed;
    }
    assert_int_equal(failed, 0);
}

/* ---- order ---- */

enum { FIGURES = 25, GROUPS = 4, SEEDS = 4, PARTS = 4, MOST_STEPS = 1000 };
static const int groups[GROUPS + 1] = {0, 7, 13, 19, 25};
static double exact[PARTS][FIGURES], found_by[PARTS][FIGURES];

/* Motion, velocity and acceleration of the last member, and the load of the first joint, after each quarter of the
   time. The steps of a quarter are scaled to end with it. */
static void figures(int kind, int pattern, double h, double time, double out[PARTS][FIGURES]) {
    static double dt[MOST_STEPS];
    const int n = (int)(time / PARTS / h + 0.5);
    sequence_world w = make(kind, 0.9);
    assert_true(n <= MOST_STEPS);
    OK(w.s, spar_session_set_newton(w.s, 1e-15, 1e-13, 50));
    for (int p = 0; p < PARTS; p++) {
        double *x = out[p], sum = 0;
        for (int k = 0; k < n; k++) {
            sum += dt[k] = sequence_step(pattern, p * n + k, h, 2);
        }
        for (int k = 0; k < n; k++) {
            step(&w, kind, pattern == EVEN ? h : dt[k] * time / PARTS / sum);
        }
        OK(w.s, spar_member_get_motion(w.m[w.members - 1], x, x + 7, x + 13));
        OK(w.s, spar_joint_get_load(w.j[0], x + 19));
    }
    spar_session_destroy(&w.s);
}

/* Errors of position, velocity, acceleration and load: root of the mean square over the quarters and, of random steps,
   over four runs. */
static void errors(int kind, int pattern, double h, double time, double error[GROUPS]) {
    const int runs = pattern == RANDOM ? SEEDS : 1;
    double sum[GROUPS] = {0};
    for (int r = 0; r < runs * PARTS; r++) {
        if (r % PARTS == 0) {
            sequence_seed = (uint64_t)(r + 1);
            figures(kind, pattern, h, time, found_by);
        }
        for (int g = 0; g < GROUPS; g++) {
            double most = 0;
            for (int k = groups[g]; k < groups[g + 1]; k++) {
                most = fmax(most, fabs(found_by[r % PARTS][k] - exact[r % PARTS][k]));
            }
            sum[g] += most * most / runs / PARTS;
        }
    }
    for (int g = 0; g < GROUPS; g++) {
        error[g] = sqrt(sum[g]);
    }
}

/* Against what even steps 8 and 16 times shorter extrapolate to. Over two halvings of h the errors fall by 16, and they
   are at most twice what even steps leave. */
static void test_order(void **state) {
    (void)state;
    static const int kinds[] = {FOUR_BAR, RODS, UNIVERSAL, CART, DRIVEN, CHAIN},
                     patterns[] = {EVEN, ONE_TO_THREE, RANDOM, SMOOTH};
    static const char *const names[] = {"even", "1:3", "random", "smooth"};
    int failed = 0;
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
        double even[GROUPS], error[GROUPS], coarse[GROUPS], time = 0.4;
        const double h = (kinds[i] == CHAIN ? 1 : 0.5) * scenes[kinds[i]].h;
        figures(kinds[i], EVEN, h / 8, time, found_by);
        figures(kinds[i], EVEN, h / 16, time, exact);
        for (int r = 0; r < PARTS; r++) {
            for (int k = 0; k < FIGURES; k++) {
                exact[r][k] += (exact[r][k] - found_by[r][k]) / 3;
            }
        }
        for (int p = 0; p < 4; p++) {
            errors(kinds[i], patterns[p], h, time, coarse);
            errors(kinds[i], patterns[p], h / 4, time, error);
            print_message("%-22s %-7s", scenes[kinds[i]].name, names[p]);
            for (int g = 0; g < GROUPS; g++) {
                double order = log2(coarse[g] / error[g]) / 2;
                even[g] = p ? even[g] : error[g];
                print_message("  %.1e (%.2f)", error[g], order);
                failed += !(order > 1.7) || !(error[g] < 2 * even[g]);
            }
            print_message("\n");
        }
    }
    assert_int_equal(failed, 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_energy_and_forces), cmocka_unit_test(test_order)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
