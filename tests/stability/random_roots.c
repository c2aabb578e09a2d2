/* Linear and modal beams beside the exact beam at small deflection, under every motion of the root. Random slender
   beams with twist, coupled sections, point masses; all that bends them is of size e: the curvature of the line,
   offsets of the centres of mass, loads, transverse accelerations. What acts along them is of size 1, so that it
   stiffens or softens them in first order:
   - hub: the root turns about an axis at a distance, which may lie beyond it;
   - pushed: the root is driven along the beam, periodically, and turned a little about an axis far from it;
   - spun: the root turns about the beam's own axis, and accelerates;
   - standing: the root is fixed, the beam stands or hangs in its weight;
   - hanging: the same, pinned; its weight grows from nothing.
   Linearisation neglects what is of second order. So the difference of tips, reactions and section forces in statics
   and steps, and of modes and eigenvalues, has to fall with the square of e, or to be as small as the stretch and the
   error of the steps, FLOOR of the quantity. What is missing in the equations falls with e alone.

   random_roots [count, default 40] [first, default 0]: the long form is 2000. */
#include "scene.h"

#include <stdio.h>

enum { ELEMENTS = 2, PER_ELEMENT = 7, NODES = 14, POINTS = 9, STEPS = 60, MODES = 4, FIGURES = 6 };
typedef enum root_motion { HUB, PUSHED, SPUN, STANDING, HANGING, ROOTS } root_motion;

static const double FLOOR = 4e-3, COARSE = 0.04, FINE = 0.01, DT = 4e-3;
static const char *const root_name[] = {"hub", "pushed", "spun", "standing", "hanging"};
static const char *const figure_name[FIGURES] = {"static tip",  "static root moment",  "modes",
                                                 "eigenvalues", "tip after the steps", "root moment after the steps"};
static unsigned long long seed;
static int beams = 40, first_beam;

static double uniform(double from, double to) {
    seed = seed * 6364136223846793005ULL + 1442695040888963407ULL;
    return from + (to - from) * (double)(seed >> 11) / 9007199254740992.0;
}

/* A scene; lengths, mass and the softest bending stiffness are about 1. */
typedef struct scene {
    root_motion root;
    double K[36], M[36], twist, bow[4], centre[2], mass, at; /* point mass */
    double R[9];                                             /* axes of the root: the beam is along the first */
    double axis[3], hub[3], spin, spin_up, push, frequency, drift[3], swing; /* of the root, in its axes */
    double gravity[3], load[6];                                              /* likewise */
} scene;

static void direction(double x[3]) {
    double size = 0;
    for (int k = 0; k < 3; k++) {
        x[k] = uniform(-1, 1);
        size += x[k] * x[k];
    }
    for (int k = 0; k < 3; k++) {
        x[k] /= sqrt(size);
    }
}

static void random_sections(scene *s) {
    const double EI = uniform(1, 2), slender = pow(10, uniform(6.5, 8));
    scene_diagonal(s->K, slender, 0.4 * slender, 0.3 * slender, uniform(0.5, 1), EI, EI * uniform(1, 3));
    const double c = uniform(-0.3, 0.3) * sqrt(s->K[21] * s->K[28]);
    s->K[6 * 3 + 4] = s->K[6 * 4 + 3] = c;
    s->twist = uniform(-1, 1);
    s->mass = uniform(0, 1) < 0.5 ? uniform(0.1, 0.5) : 0;
    s->at = uniform(0, 1) < 0.5 ? 0.5 : 1; /* an element boundary: nodes do not resolve the jump of the axial force */
    for (int k = 0; k < 4; k++) {
        s->bow[k] = uniform(-1, 1);
    }
    s->centre[0] = uniform(-0.1, 0.1), s->centre[1] = uniform(-0.1, 0.1);
}

/* e: the size of what bends the beam */
static void random_scene(scene *s, double e) {
    double q[4], size = 0;
    *s = (scene){.root = (root_motion)(int)uniform(0, ROOTS - 1e-9)};
    random_sections(s);
    for (int k = 0; k < 4; k++) {
        q[k] = uniform(-1, 1);
        size += q[k] * q[k];
    }
    for (int k = 0; k < 4; k++) {
        q[k] /= sqrt(size);
    }
    spari_quat_matrix(q, s->R);
    double n[3], small[3], about = uniform(0, 6.28), other = uniform(-1, 1);
    direction(n), direction(small);
    const double weight = uniform(-2, 8), spin = uniform(1, 4), r0 = uniform(-0.2, 2), up = uniform(-2, 2);
    for (int k = 0; k < 3; k++) {
        s->gravity[k] = 2 * e * n[k];
        s->drift[k] = e * small[k] * other;
        s->hub[k] = e * uniform(-1, 1);
        s->axis[k] = k > 0 ? 0 : s->root == SPUN;
    }
    s->frequency = uniform(2, 6);
    if (s->root == HUB) {
        s->axis[0] = e * uniform(-0.5, 0.5), s->axis[1] = cos(about), s->axis[2] = sin(about);
        s->hub[0] = -r0, s->spin = spin, s->swing = 0.2 * e;
        for (int k = 0; k < 3; k++) { /* about the axis, so that there is an equilibrium */
            s->gravity[k] = 2 * e * s->axis[k];
        }
    } else if (s->root == PUSHED) {
        direction(s->axis);
        for (int k = 0; k < 3; k++) {
            s->hub[k] = uniform(-3, 3);
        }
        s->push = uniform(-1, 1), s->swing = 0.1 * e, s->gravity[0] += 0.5 * (weight + 2);
    } else if (s->root == SPUN) {
        s->axis[1] = e * uniform(-0.3, 0.3), s->spin = 0.3 * spin, s->spin_up = up;
        for (int k = 0; k < 3; k++) {
            s->gravity[k] = weight * s->axis[k];
        }
    } else {
        s->gravity[0] += s->root == HANGING ? 2 + fabs(weight) : weight;
    }
    for (int k = 1; k < 3; k++) {
        s->load[k] = e * uniform(-1, 1), s->load[3 + k] = 0.3 * e * uniform(-1, 1);
    }
    size = sqrt(spari_dot(s->axis, s->axis));
    for (int k = 0; k < 3 && size > 0; k++) {
        s->axis[k] /= size;
    }
}

static void to_global(const scene *s, const double x[3], double y[3]) {
    const double in[3] = {x[0], x[1], x[2]};
    spari_matrix_times(s->R, in, y);
}

/* q, v, a of the root at t: the angle about the axis through the hub, and a translation */
static void root_at(const scene *s, double t, double q[7], double v[6], double a[6]) {
    const double w = s->frequency, b = 1 - cos(w * t), d = w * sin(w * t), /* begins without acceleration */
        c = b * b, sn = 2 * b * d, cs = 2 * d * d + 2 * b * w * w * cos(w * t);
    const double angle = s->spin * t + 0.5 * s->spin_up * t * t + s->swing * c,
                 rate = s->spin + s->spin_up * t + s->swing * sn, up = s->spin_up + s->swing * cs;
    double n[3], hub[3], along[3], arm[3], turn[3], x[3], p[4];
    for (int k = 0; k < 3; k++) {
        along[k] = s->drift[k] + (k == 0 ? s->push / (w * w) : 0);
    }
    to_global(s, s->axis, n), to_global(s, s->hub, hub), to_global(s, along, along);
    for (int k = 0; k < 3; k++) {
        turn[k] = angle * n[k];
    }
    spari_quat_exp(turn, p);
    for (int k = 0; k < 3; k++) {
        x[k] = -hub[k];
    }
    spari_rotate(p, x, arm);
    spari_cross(n, arm, turn);
    spari_cross(n, turn, x);
    memcpy(q + 3, p, sizeof p);
    const double rest = s->root == HUB || s->root == SPUN ? 0 : 1; /* an equilibrium has no transverse acceleration */
    for (int k = 0; k < 3; k++) {
        q[k] = hub[k] + arm[k] + rest * along[k] * c;
        v[k] = rate * turn[k] + rest * along[k] * sn;
        a[k] = up * turn[k] + rate * rate * x[k] + rest * along[k] * cs;
        v[3 + k] = rate * n[k];
        a[3 + k] = up * n[k];
    }
}

static spar_session *session_of(const scene *s, int fidelity, double e, spar_member **b) {
    static const int roots[ROOTS] = {SPAR_ROOT_DRIVEN, SPAR_ROOT_DRIVEN, SPAR_ROOT_DRIVEN, SPAR_ROOT_FIXED,
                                     SPAR_ROOT_PINNED};
    double eta[POINTS], x[3 * POINTS], twist[POINTS], g[3], section[36], J[3] = {1e-4, 1e-4, 1e-4};
    const double c[3] = {0, e * s->centre[0], e * s->centre[1]}, zero[2] = {0};
    spar_session *session = scene_session();
    for (int i = 0; i < POINTS; i++) {
        const double h = eta[i] = (double)i / (POINTS - 1);
        const double at[3] = {h, e * h * h * (s->bow[0] + s->bow[1] * h), e * h * h * (s->bow[2] + s->bow[3] * h)};
        to_global(s, at, x + 3 * i);
        twist[i] = s->twist * h;
    }
    to_global(s, s->gravity, g);
    scene_mass(section, 1, c, J);
    if (s->root != HANGING) {
        OK(session, spar_session_set_gravity(session, g));
    }
    OK(session, spar_beam_create(session, "b", ELEMENTS, PER_ELEMENT, b));
    OK(session, spar_beam_set_axis(*b, POINTS, eta, x, twist));
    OK(session, spar_beam_set_sections(*b, 1, zero, s->K, section));
    if (s->mass > 0) {
        double m[36];
        scene_mass(m, s->mass, c, J);
        OK(session, spar_beam_set_masses(*b, 1, &s->at, m));
    }
    OK(session, spar_member_set_root(*b, roots[s->root]));
    OK(session, spar_member_set_fidelity(*b, fidelity, 6 * (NODES - 2) + (s->root == HANGING ? 3 : 0)));
    OK(session, spar_member_commit(*b));
    return session;
}

/* The tip relative to the root, and the root's moment, in axes of the root. */
static void look(const scene *s, spar_member *b, double t, double tip[3], double moment[3]) {
    double q[7 * NODES], root[7], v[6], a[6], r[6], arm[3] = {1, 0, 0}, start[4];
    root_at(s, t, root, v, a);
    assert_int_equal(spar_member_get_motion(b, q, NULL, NULL), SPAR_OK);
    assert_int_equal(spar_member_get_reaction(b, r), SPAR_OK);
    memcpy(start, root + 3, sizeof start);
    to_global(s, arm, arm);
    for (int k = 0; k < 3; k++) {
        tip[k] = q[7 * (NODES - 1) + k] - q[k] + arm[k];
    }
    spari_rotate_back(start, tip, tip);
    spari_rotate_back(start, r + 3, moment);
    for (int k = 0; k < 3; k++) {
        tip[k] -= arm[k];
    }
}

typedef struct figures {
    double x[FIGURES][MODES > 3 ? MODES : 3];
} figures;

/* The root's moment is that of the part beyond. */
static void check_section(spar_session *session, spar_member *b) {
    double f[6], r[6], q[4], zero = 0, size = 0;
    OK(session, spar_member_get_reaction(b, r));
    OK(session, spar_beam_evaluate(b, 1, &zero, NULL, f, NULL, q));
    for (int k = 0; k < 6; k++) {
        size = fmax(size, fabs(r[k]));
    }
    for (int k = 0; k < 6; k += 3) {
        spari_rotate(q, f + k, f + k);
    }
    for (int k = 0; k < 6; k++) {
        NEAR(f[k], -r[k], 1e-9 * size);
    }
}

static void eigenvalues(spar_session *session, spar_member *b, double *x) {
    double lambda[2 * MODES];
    OK(session, spar_member_solve_eigenvalues(b, MODES, NULL, lambda, NULL, NULL));
    for (int k = 0; k < MODES; k++) {
        x[k] = lambda[2 * k + 1];
    }
    for (int k = 1; k < MODES; k++) { /* ascending */
        for (int j = k; j > 0 && x[j] < x[j - 1]; j--) {
            const double y = x[j];
            x[j] = x[j - 1], x[j - 1] = y;
        }
    }
}

static figures run(const scene *s, int fidelity, double e) {
    spar_member *b = NULL;
    spar_session *session = session_of(s, fidelity, e, &b);
    figures is = {{{0}}};
    double q[7], v[6], a[6], load[6], turned[6], hub[3], f[MODES], g[3], weight[3];
    const int driven = s->root == HUB || s->root == PUSHED || s->root == SPUN;
    for (int k = 0; k < 6; k += 3) {
        to_global(s, s->load + k, load + k);
    }
    root_at(s, 0, q, v, a);
    to_global(s, s->hub, hub);
    to_global(s, s->gravity, weight);
    if (driven) { /* the rotation of the equilibrium */
        OK(session, spar_member_set_initial_velocity(b, hub, NULL, v + 3));
    }
    OK(session, spar_member_set_load(b, NODES - 1, SPAR_LOAD_DEAD, load));
    if (s->root != HANGING) { /* this one may spin about itself, so it has no equilibrium */
        OK(session, spar_member_solve_static(b, 4));
        look(s, b, 0, is.x[0], is.x[1]);
        check_section(session, b);
        OK(session, spar_member_solve_modes(b, MODES, f, NULL));
        memcpy(is.x[2], f, sizeof f);
        if (s->root != PUSHED) {
            eigenvalues(session, b, is.x[3]);
        }
    }
    for (int i = 1; i <= STEPS; i++) {
        root_at(s, i * DT, q, v, a);
        const double part = 1 + sin(M_PI * i / STEPS);
        for (int k = 0; k < 6; k++) {
            turned[k] = part * load[k];
        }
        for (int k = 0; k < 6 && driven; k += 3) { /* loads that turn with the root stay transverse */
            spari_rotate(q + 3, turned + k, turned + k);
        }
        if (driven) {
            OK(session, spar_member_drive(b, q, v, a));
        }
        OK(session, spar_member_set_load(b, NODES - 1, SPAR_LOAD_DEAD, turned));
        for (int k = 0; k < 3 && s->root == HANGING; k++) { /* at once it would make the beam ring along itself */
            g[k] = pow(sin(M_PI_2 * fmin(1, 2.0 * i / STEPS)), 2) * weight[k];
        }
        if (s->root == HANGING) {
            OK(session, spar_session_set_gravity(session, g));
        }
        scene_run(session, DT, 1);
    }
    look(s, b, driven ? STEPS * DT : 0, is.x[4], is.x[5]);
    if (s->root != HANGING) { /* its root's section turns */
        check_section(session, b);
    }
    spar_session_destroy(&session);
    return is;
}

static double size_of(const double *a, const double *b) {
    double sum = 0;
    for (int i = 0; i < (MODES > 3 ? MODES : 3); i++) {
        sum += (a[i] - (b ? b[i] : 0)) * (a[i] - (b ? b[i] : 0));
    }
    return sqrt(sum);
}

static void test_random_roots(void **state) {
    (void)state;
    static const int fidelities[] = {SPAR_FIDELITY_LINEAR, SPAR_FIDELITY_MODAL};
    double worst[ROOTS][FIGURES] = {{0}};
    int failures = 0;
    for (int k = first_beam; k < first_beam + beams; k++) {
        double error[2][2][FIGURES], size[FIGURES];
        scene s;
        for (int fine = 0; fine < 2; fine++) {
            const double e = fine ? FINE : COARSE;
            seed = 77777 + (unsigned long long)k * 7919;
            random_scene(&s, e);
            const figures exact = run(&s, SPAR_FIDELITY_EXACT, e);
            for (int way = 0; way < 2; way++) {
                const figures is = run(&s, fidelities[way], e);
                for (int i = 0; i < FIGURES; i++) {
                    size[i] = size_of(exact.x[i], NULL);
                    error[fine][way][i] = size_of(is.x[i], exact.x[i]);
                }
            }
        }
        for (int way = 0; way < 2; way++) {
            for (int i = 0; i < FIGURES; i++) {
                const double e = error[1][way][i], part = size[i] > 0 ? e / size[i] : 0;
                worst[s.root][i] = fmax(worst[s.root][i], part);
                if (!(e <= fmax(error[0][way][i] / 8, FLOOR * size[i]))) {
                    failures++;
                    print_error("beam %d (%s), fidelity %d, %s: differs by %.3g, then %.3g, of %.3g\n", k,
                                root_name[s.root], fidelities[way], figure_name[i], error[0][way][i], e, size[i]);
                }
            }
        }
    }
    for (int r = 0; r < ROOTS; r++) {
        print_message("%-9s", root_name[r]);
        for (int i = 0; i < FIGURES; i++) {
            print_message("  %s %.1e", figure_name[i], worst[r][i]);
        }
        print_message("\n");
    }
    assert_int_equal(failures, 0);
}

int main(int argc, char **argv) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_random_roots)};
    beams = argc > 1 ? atoi(argv[1]) : beams;
    first_beam = argc > 2 ? atoi(argv[2]) : first_beam;
    return cmocka_run_group_tests(tests, NULL, NULL);
}
