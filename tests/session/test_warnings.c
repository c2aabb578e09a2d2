/* Mistakes that are legal are told once, to the log and to spar_session_get_warning; what is right is not warned of. */
#include "scene.h"

#include <stdio.h>

enum { MOST = 64 };

/* Section of a solid steel circle of the diameter 0.1 m: E = 2.1e11 Pa, density 7850 kg/m^3. */
static void steel(double *K, double *M, double unit) {
    const double A = 7.853981633974483e-3, I = 4.908738521234052e-6, E = 2.1e11 * unit, G = 8e10 * unit;
    scene_diagonal(K, E * A, G * A, G * A, 2 * G * I, E * I, E * I);
    scene_diagonal(M, 7850 * A, 7850 * A, 7850 * A, 2 * 7850 * I, 7850 * I, 7850 * I);
}

typedef struct told {
    int warnings, infos;
    char info[1024];
} told;

static void listen(const spar_session *s, int level, const char *text, void *context) {
    told *t = context;
    (void)s;
    t->warnings += level == SPAR_LOG_WARNING;
    if (level == SPAR_LOG_INFO) {
        t->infos++;
        (void)strncpy(t->info, text, sizeof t->info - 1);
    }
}

static int count(const spar_session *s) {
    int n = 0;
    while (*spar_session_get_warning(s, n)) {
        n++;
    }
    return n;
}

/* One warning, which says text; the log, if there is one, has heard it. */
static void warned_of(const spar_session *s, const char *text) {
    if (count(s) != 1 || !strstr(spar_session_get_warning(s, 0), text)) {
        fail_msg("%d warnings, the first '%s'; expected one that says '%s'", count(s), spar_session_get_warning(s, 0),
                 text);
    }
}

static spar_member *beam_of(spar_session *s, double length, double unit, double weight) {
    double K[36], M[36];
    steel(K, M, unit);
    for (int i = 0; i < 36; i++) {
        M[i] *= weight;
    }
    return scene_beam(s, "beam", 1, 6, length, K, M);
}

/* f1 = 3.516 / (2 pi L^2) sqrt(EI / m) = 11.57 Hz for 2.7 m: the estimate is right to a factor of 2. */
static void description(void **state) {
    (void)state;
    told t = {0};
    spar_session *s = scene_session();
    OK(s, spar_session_set_log(s, listen, &t));
    OK(s, spar_member_commit(beam_of(s, 2.7, 1, 1)));
    assert_int_equal(count(s), 0);
    assert_int_equal(t.warnings, 0);
    assert_int_equal(t.infos, 1);
    const char *mass = strstr(t.info, "mass "), *length = strstr(t.info, "length "), *f = strstr(t.info, "about ");
    assert_true(mass && length && f);
    NEAR(atof(mass + 5), 7850 * 7.853981633974483e-3 * 2.7, 0.05);
    NEAR(atof(length + 7), 2.7, 1e-3);
    NEAR(log2(atof(f + 6) / 11.57), 0, 1);
    spar_session_destroy(&s);
}

/* Frequencies: 3e-5 Hz (E in 1e-12 of itself), 1.2e6 Hz (mass 1e-10 of itself); between 1e-4 and 1e5 Hz none. */
static void frequency(void **state) {
    (void)state;
    static const struct {
        double length, unit, weight;
        int warned;
    } rows[] = {{2.7, 1e-12, 1, 1}, {2.7, 1, 1e-11, 1}, {2.7, 1e-9, 1, 0}, {0.3, 1, 1e-3, 0}, {300, 1, 1, 0}};
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
        spar_session *s = scene_session();
        OK(s, spar_member_commit(beam_of(s, rows[k].length, rows[k].unit, rows[k].weight)));
        if (rows[k].warned) {
            warned_of(s, "first frequency is about");
        } else {
            assert_string_equal(spar_session_get_warning(s, 0), "");
        }
        spar_session_destroy(&s);
    }
}

static void twist(void **state) {
    (void)state;
    static const double eta[3] = {0, 0.5, 1}, xyz[9] = {0, 0, 0, 1, 0, 0, 2, 0, 0};
    static const double right[3] = {0, 0.2, -0.1}, degrees[3] = {0, 13.3, 2};
    for (int wrong = 0; wrong < 2; wrong++) {
        spar_session *s = scene_session();
        spar_member *b = beam_of(s, 2, 1, 1);
        OK(s, spar_beam_set_axis(b, 3, eta, xyz, wrong ? degrees : right));
        OK(s, spar_member_commit(b));
        if (wrong) {
            warned_of(s, "twist is in radians");
        } else {
            assert_int_equal(count(s), 0);
        }
        spar_session_destroy(&s);
    }
}

/* Nodes in mm are 1000 times as far away; 3 m to the side of a line of 2 m is too far, 1.5 m is not. */
static void far_nodes(void **state) {
    (void)state;
    static const struct {
        double y;
        int warned;
    } rows[] = {{1.5, 0}, {3, 1}, {1500, 1}};
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
        spar_session *s = scene_session();
        spar_member *b = beam_of(s, 2, 1, 1);
        spar_fluid *f = NULL;
        const double x[6] = {1, 0.1, 0, 1, rows[k].y, 0};
        OK(s, spar_member_commit(b));
        OK(s, spar_fluid_create(b, "air", &f));
        OK(s, spar_fluid_set_motion_nodes(f, 2, x));
        OK(s, spar_fluid_set_force_nodes(f, 2, x));
        OK(s, spar_fluid_map(f));
        OK(s, spar_fluid_map(f)); /* once */
        if (rows[k].warned) {
            warned_of(s, "1 of 2 force nodes are farther from the line");
        } else {
            assert_int_equal(count(s), 0);
        }
        spar_session_destroy(&s);
    }
}

/* Forces for a fluid that has motion nodes alone have no effect, which is told once. An empty set of force nodes says
   that this is meant. */
static void forces_without_nodes(void **state) {
    (void)state;
    const double x[3] = {1, 0.1, 0}, force[3] = {0, 0, 1};
    for (int empty = 0; empty < 2; empty++) {
        spar_session *s = scene_session();
        spar_member *b = beam_of(s, 2, 1, 1);
        spar_fluid *f = NULL;
        OK(s, spar_member_commit(b));
        OK(s, spar_fluid_create(b, "air", &f));
        OK(s, spar_fluid_set_motion_nodes(f, 1, x));
        OK(s, empty ? spar_fluid_set_force_nodes(f, 0, NULL) : SPAR_OK);
        OK(s, spar_fluid_map(f));
        OK(s, spar_fluid_push_forces(f, NULL, NULL));
        assert_int_equal(count(s), 0);
        OK(s, spar_fluid_push_forces(f, force, NULL));
        OK(s, spar_fluid_push_forces(f, force, NULL));
        if (empty) {
            assert_int_equal(count(s), 0);
        } else {
            warned_of(s, "has motion nodes and no force nodes");
        }
        spar_session_destroy(&s);
    }
}

typedef struct host {
    spar_fluid *fluid;
    int pulls_position, pulls_velocity, pushes;
} host;

static int flow(spar_session *s, double t, double dt, int iteration, void *context) {
    host *h = context;
    double x[3], v[3], f[3] = {0, 1, 0};
    (void)s, (void)t, (void)dt, (void)iteration;
    if (spar_fluid_pull_motion(h->fluid, 1, h->pulls_position ? x : NULL, h->pulls_velocity ? v : NULL) != SPAR_OK) {
        return 1;
    }
    return h->pushes ? spar_fluid_push_forces(h->fluid, f, NULL) : 0;
}

/* A pulled fluid whose forces never come, and one that looks at positions alone; 15 steps each. */
static void habits(void **state) {
    (void)state;
    static const struct {
        host h;
        const char *text;
    } rows[] = {
        {{NULL, 1, 1, 1}, NULL}, {{NULL, 1, 1, 0}, "no forces were pushed in 2 steps"},
        {{NULL, 0, 0, 0}, NULL}, /* not in use */
        {{NULL, 0, 1, 1}, NULL}, {{NULL, 1, 0, 1}, "pulls positions and no velocities"},
        {{NULL, 1, 0, 2}, NULL}, /* velocity = own */
    };
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
        for (int logs = 0; logs < 2; logs++) {
            const double x[3] = {2, 0, 0};
            told t = {0};
            host h = rows[k].h;
            spar_session *s = scene_session();
            spar_member *b = beam_of(s, 2, 1, 1);
            OK(s, spar_session_set_log(s, logs ? listen : NULL, &t));
            OK(s, spar_member_commit(b));
            OK(s, spar_fluid_create(b, "air", &h.fluid));
            OK(s, spar_fluid_set_motion_nodes(h.fluid, 1, x));
            OK(s, spar_fluid_set_force_nodes(h.fluid, 1, x));
            OK(s, spar_fluid_map(h.fluid));
            OK(s, spar_fluid_set_option(h.fluid, "velocity", h.pushes == 2 ? "own" : "pulled"));
            for (int n = 0; n < 15; n++) {
                OK(s, spar_step(s, 0.01, flow, &h, NULL));
            }
            if (rows[k].text) {
                warned_of(s, rows[k].text);
            } else {
                assert_int_equal(count(s), 0);
            }
            assert_int_equal(t.warnings, logs && rows[k].text ? 1 : 0);
            spar_session_destroy(&s);
        }
    }
}

/* More than 32 warnings: the first stay, and the log has them all. */
static void many(void **state) {
    (void)state;
    told t = {0};
    spar_session *s = scene_session();
    OK(s, spar_session_set_log(s, listen, &t));
    for (int k = 0; k < MOST; k++) {
        char name[16];
        double K[36], M[36];
        steel(K, M, 1e-12);
        (void)snprintf(name, sizeof name, "beam%d", k);
        OK(s, spar_member_commit(scene_beam(s, name, 1, 6, 2, K, M)));
    }
    assert_int_equal(count(s), 32);
    assert_int_equal(t.warnings, MOST);
    assert_non_null(strstr(spar_session_get_warning(s, 31), "beam31"));
    assert_string_equal(spar_session_get_warning(s, 32), "");
    assert_string_equal(spar_session_get_warning(s, -1), "");
    assert_string_equal(spar_session_get_warning(NULL, 0), "");
    spar_session_destroy(&s);
}

/* A prebent blade of 60 m by nine key points spaced as cosines, and one a millimetre after the fifth. To ten digits
   the curve through them is a parabola; to millimetres the pair is 45 degrees steep, or not at all, and the curve
   swings through all of the blade. A quarter of a circle by five points bends as much and is meant. */
static void key_points(void **state) {
    (void)state;
    enum { N = 10, PAIR = 5 };
    for (int run = 0; run < 3; run++) {
        const double digit = run == 1 ? 1e-3 : 1e-10;
        double eta[N], xyz[3 * N], K[36], M[36];
        for (int i = 0; i < N; i++) {
            const int k = i < PAIR ? i : i - 1;
            const double x = 60 * (0.5 - 0.5 * cos(3.141592653589793 * k / (N - 2))) + (i == PAIR ? 1e-3 : 0);
            eta[i] = i == N - 1 ? 1 : x / 60;
            xyz[3 * i] = round(x / digit) * digit;
            xyz[3 * i + 1] = 0;
            xyz[3 * i + 2] = round(3 * x * x / 3600 / digit) * digit;
        }
        for (int i = 0; i < 5 && run == 2; i++) {
            const double turn = 1.5707963267948966 * i / 4;
            eta[i] = i / 4.0;
            xyz[3 * i] = 60 * sin(turn), xyz[3 * i + 2] = 60 * (1 - cos(turn));
        }
        spar_session *s = scene_session();
        steel(K, M, 1e6);
        spar_member *b = scene_beam(s, "blade", 1, 10, 60, K, M);
        OK(s, spar_beam_set_axis(b, run == 2 ? 5 : N, eta, xyz, NULL));
        OK(s, spar_member_commit(b));
        if (run == 1) {
            warned_of(s, "points 4 and 5 are only 0.001 m apart");
        } else {
            assert_string_equal(spar_session_get_warning(s, 0), "");
        }
        spar_session_destroy(&s);
    }
}

/* Stiffness alone in BeamDyn's order (shears, axial, bendings, torsion), the mass in spar's: told. A section whose
   largest moment of inertia is more than the sum of the others: told; rounded, a slice, or with moments left out: not.
 */
static void sections(void **state) {
    (void)state;
    static const double J[5][3] = {{0.2, 0.3, 0.9}, {2.1, 1, 1}, {0.9, 0, 0}, {0.5, 0.2, 0.3}, {0.5, 0.5, 0.5}};
    for (int run = 0; run < 6; run++) {
        double K[36], M[36];
        spar_session *s = scene_session();
        scene_diagonal(K, 2e9, 6e8, 5e8, 1e9, 2e9, 3e9);
        scene_diagonal(M, 80, 80, 80, J[run % 5][0], J[run % 5][1], J[run % 5][2]);
        if (run == 5) {
            scene_diagonal(K, 6e8, 5e8, 2e9, 2e9, 3e9, 1e9);
            scene_diagonal(M, 80, 80, 80, 0.5, 0.2, 0.3);
        }
        spar_member *b = scene_beam(s, "beam", 1, 6, 20, K, M);
        OK(s, spar_member_commit(b));
        if (run == 0 || run == 5) {
            warned_of(s, run ? "BeamDyn's order" : "no section has the moments of inertia 0.2, 0.3, 0.9");
        } else {
            assert_string_equal(spar_session_get_warning(s, 0), "");
        }
        spar_session_destroy(&s);
    }
}

/* A root that is driven with a rate before the static solution stays at rest in it, which is told once; after
   spar_member_set_initial_velocity with this rate the solution has it, and nothing is told. */
static void drive_before_static(void **state) {
    (void)state;
    const double omega[3] = {0, 0, 2}, v[6] = {0, 0, 0, 0, 0, 2}, q[7] = {0, 0, 0, 1, 0, 0, 0};
    for (int given = 0; given < 2; given++) {
        for (int all = 0; all < 2; all++) {
            double tip[7];
            spar_session *s = scene_session();
            spar_member *b = beam_of(s, 2.7, 1, 1);
            OK(s, spar_member_set_root(b, SPAR_ROOT_DRIVEN));
            OK(s, given ? spar_member_set_initial_velocity(b, NULL, NULL, omega) : SPAR_OK);
            OK(s, spar_member_commit(b));
            OK(s, spar_member_drive(b, q, v, NULL));
            for (int twice = 0; twice < 2; twice++) {
                OK(s, all ? spar_session_solve_static(s, 1, NULL, NULL, NULL) : spar_member_solve_static(b, 1));
            }
            scene_tip(b, tip);
            assert_int_equal(tip[0] > 1e-9, given); /* m omega^2 L^3 / (3 EA) = 1e-6 m */
            if (given) {
                assert_string_equal(spar_session_get_warning(s, 0), "");
            } else {
                warned_of(s, "'beam' was driven before, which counts from the next step on");
            }
            spar_session_destroy(&s);
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(description),
        cmocka_unit_test(frequency),
        cmocka_unit_test(twist),
        cmocka_unit_test(far_nodes),
        cmocka_unit_test(habits),
        cmocka_unit_test(many),
        cmocka_unit_test(key_points),
        cmocka_unit_test(sections),
        cmocka_unit_test(drive_before_static),
        cmocka_unit_test(forces_without_nodes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
