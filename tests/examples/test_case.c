/* The structure from a text file (examples/hosts/common): the same bits as the calls by hand, and every mistake with
   its file, line and cure. */
#include "scene.h"

#include "case.h"
#include "nrel5mw.h"
#include <locale.h>
#include <math.h>
#include <spar/spar_aero.h>
#include <spar/spar_output.h>
#include <stdio.h>
#include <unistd.h>

#define CASES SPAR_SOURCE_DIR "/examples/hosts/cases/"

static char path[64];

static const char *written(const char *text) {
    (void)snprintf(path, sizeof path, "test_case_%ld.case", (long)getpid());
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    assert_int_equal(fputs(text, file) >= 0, 1);
    assert_int_equal(fclose(file), 0);
    return path;
}

/* The call must succeed; else the case's message says why. */
#define GOOD(call)                                                                                                     \
    do {                                                                                                               \
        if ((call) != SPAR_OK) {                                                                                       \
            fail_msg("%s: %s", #call, spar_case_message());                                                            \
        }                                                                                                              \
    } while (0)

static spar_case *read_text(spar_session *s, const char *host, const char *text) {
    spar_case *c = NULL;
    GOOD(spar_case_read(written(text), host, s, &c));
    (void)remove(path);
    return c;
}

/* n steps of both sessions; their members' motion and loads then are equal to the bit. */
static void same_run(spar_session *a, spar_session *b, spar_member *const *x, spar_member *const *y, int members,
                     int steps) {
    enum { MOST = 64 };
    for (int i = 0; i < steps; i++) {
        OK(a, spar_step(a, 0.01, NULL, NULL, NULL));
        OK(b, spar_step(b, 0.01, NULL, NULL, NULL));
    }
    for (int m = 0; m < members; m++) {
        double q[2][7 * MOST] = {{0}}, v[2][6 * MOST] = {{0}}, acc[2][6 * MOST] = {{0}}, load[2][6 * MOST] = {{0}};
        int64_t n;
        OK(a, spar_member_get_count(x[m], &n));
        assert_true(n <= MOST);
        assert_string_equal(spar_member_get_name(x[m]), spar_member_get_name(y[m]));
        for (int k = 0; k < 2; k++) {
            const spar_member *one = k ? y[m] : x[m];
            OK(k ? b : a, spar_member_get_motion(one, q[k], v[k], acc[k]));
            OK(k ? b : a, spar_member_get_loads(one, load[k]));
        }
        if (memcmp(q[0], q[1], sizeof q[0]) != 0) {
            fail_msg("motion of %s", spar_member_get_name(x[m]));
        }
        assert_memory_equal(v[0], v[1], sizeof v[0]);
        assert_memory_equal(acc[0], acc[1], sizeof acc[0]);
        assert_memory_equal(load[0], load[1], sizeof load[0]);
    }
}

/* ---- every key, against the calls ---- */

static const char everything[] =
    "\xef\xbb\xbf# all there is\r\n"
    "[session]  # of all hosts\r\n"
    "gravity 0 0.5 -9.81\nrho_inf 0.7\nsubsteps 2\nnewton 1e-14 1e-11 40\nscheme aitken\natol 1e-8\nrtol 1e-5\n"
    "max_iterations 33\nrelaxation 0.6\npredictor 2\nreproducible on\noption coupling.reuse 7\n"
    "option coupling.filter 0.02\n"
    "[session mine]\nrho_inf 0.8\nmax_iterations 44\n[session other]\nrho_inf 0\n"
    "[beam wing]\nelements 2\nnodes 5\nquadrature lobatto 6\n"
    "axis 0 0 0 0 0\naxis 0.5 1 0 0.1 5\naxis 1 2 0.25 0.125 10\ntwist_scale -0.017453292519943295\n"
    "section 0 4e4 0 0 0 0 0  4e4 0 0 0 0  4e4 0 0 0  800 12 0  600 0  500   1 0 0 0 0 0  1 0 0 0 0  1 0 0 0  .02 0 0 "
    " .01 0  .01\n"
    "section 1 3e4 0 0 0 0 0  3e4 0 0 0 0  3e4 0 0 0  600 10 0  400 0  300   2 0 0 0 0 0  2 0 0 0 0  2 0 0 0  .04 0 0 "
    " .02 0  .02\n"
    "damping 1e-3 1e-3 1e-3 2e-3 2e-3 2e-3\nplace 1 2 3\norientation 0.8 0 0 0.6\neffects_on work\nowner 0\n"
    "load last dead 0 1 2 0.1 0.2 0.3\nload 3 follower 0 0.5 0 0 0 0\n"
    "line_load dead 0 1 0 0 0 0 0\nline_load follower 0.5 0 1 0 0 0 0\nline_load dead 1 0 0 3 0 0 0\n"
    "[beam mast]\nnode 0 0 0 1 0 0 0\nnode 0.5 0 0 1 0 0 0\nnode 1 0 0 1 0 0 0\nnodes 3\n"
    "section 0.5 1e4 1e4 1e4 100 100 100\nquadrature gauss 3\nfidelity prescribed\nroot driven\n"
    "[beam boom]\nnodes 4\naxis 0 0 6 0\naxis 1 2 6 0\n"
    "section 0 4e4 4e4 4e4 800 600 600 1 1 1 .02 .01 .01\nfidelity rigid\nroot free\n"
    "[beam modes]\nnodes 6\naxis 0 0 9 0\naxis 1 2 9 0\nsection 0 4e4 4e4 4e4 800 600 600 1 1 1 .02 .01 .01\n"
    "fidelity modal 4\n[beam damped]\nnodes 6\naxis 0 0 9 0\naxis 1 2 9 0\n"
    "section 0 4e4 4e4 4e4 800 600 600 1 1 1 .02 .01 .01\nmodal_damping 0 0.02 1 0.03\n"
    "[rigid weight]\nplace 5 0 -1\nmass 2 2 2 .3 .4 .5\nabout 5 0 0\nvelocity 0 .1 0\nspin 0 0 .2\n"
    "[rigid host's own]\nmass 1 1 1 1 1 1\nexternal on\nroot free\n"
    "[point buoy]\nplace 0 0 3\n"
    "[joint shaft]\na boom first\nb ground\nfree rz\nplace 0 6 0\naxes 1 0 0 0\ndriven rz\n";

static const char joints[] =
    "[joint tether]\na buoy 0\nb ground\nfree all\nstiffness 10 10 10 10 10 10\n"
    "[line rope]\na weight first 5 0 -1\nb wing last 3 2 3\nstiffness 50\ndamping 0.5\nlength 4\n"
    "[line stay]\na weight 0 5 0 -1\nb ground 0 0 3\nstiffness 5\ntension_only on\nlength 4\n"
    "[joint moss]\na weight first\nb ground\nfree x y z rx ry rz\nstiffness 10 10 10 10 10 10\n"
    "damping .1 .1 .1 .1 .1 .1\npreload 0 0 1 0 0 0\nload 0 0 .5 0 0 0\n"
    "[joint tip]\na weight first\nb wing last\nfree all\nplace 5 0 -1\nstiffness 1 1 1 1 1 1\n";

enum { MEMBERS = 8 };

static void matrix(const double *upper, double m[36]) {
    for (int i = 0, k = 0; i < 6; i++) {
        for (int j = i; j < 6; j++) {
            m[6 * i + j] = m[6 * j + i] = upper[k++];
        }
    }
}

static void wing_by_hand(spar_session *s, spar_member **wing) {
    const double degree = -0.017453292519943295, eta[3] = {0, 0.5, 1}, xyz[9] = {0, 0, 0, 1, 0, 0.1, 2, 0.25, 0.125},
                 twist[3] = {0 * degree, 5 * degree, 10 * degree}, mu[6] = {1e-3, 1e-3, 1e-3, 2e-3, 2e-3, 2e-3},
                 ends[2] = {0, 1}, x[3] = {1, 2, 3}, q[4] = {0.8, 0, 0, 0.6};
    const double k[2][21] = {{4e4, 0, 0, 0, 0, 0, 4e4, 0, 0, 0, 0, 4e4, 0, 0, 0, 800, 12, 0, 600, 0, 500},
                             {3e4, 0, 0, 0, 0, 0, 3e4, 0, 0, 0, 0, 3e4, 0, 0, 0, 600, 10, 0, 400, 0, 300}};
    double K[2][36], M[2][36];
    for (int i = 0; i < 2; i++) {
        matrix(k[i], K[i]);
        scene_diagonal(M[i], 1 + i, 1 + i, 1 + i, i ? .04 : .02, i ? .02 : .01, i ? .02 : .01);
    }
    OK(s, spar_beam_create(s, "wing", 2, 5, wing));
    OK(s, spar_beam_set_axis(*wing, 3, eta, xyz, twist));
    OK(s, spar_beam_set_sections(*wing, 2, ends, K[0], M[0]));
    OK(s, spar_beam_set_quadrature(*wing, SPAR_QUADRATURE_LOBATTO, 6));
    OK(s, spar_beam_set_damping(*wing, mu));
    OK(s, spar_member_set_placement(*wing, x, q));
    OK(s, spar_member_set_effects(*wing, SPAR_EFFECT_WORK, 0));
    OK(s, spar_member_set_owner(*wing, 0));
}

static void others_by_hand(spar_session *s, spar_member **m) {
    const double nodes[9] = {0, 0, 0, 0.5, 0, 0, 1, 0, 0}, q[12] = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0},
                 middle[1] = {0.5}, ends[2] = {0, 1}, zero[1] = {0}, boom[6] = {0, 6, 0, 2, 6, 0},
                 modes[6] = {0, 9, 0, 2, 9, 0}, at[3] = {5, 0, -1}, about[3] = {5, 0, 0}, v[3] = {0, .1, 0},
                 spin[3] = {0, 0, .2}, up[3] = {0, 0, 3};
    double K[36], M[36];
    scene_diagonal(K, 1e4, 1e4, 1e4, 100, 100, 100);
    OK(s, spar_beam_create(s, "mast", 1, 3, &m[1]));
    OK(s, spar_beam_set_nodes(m[1], 3, nodes, q));
    OK(s, spar_beam_set_sections(m[1], 1, middle, K, NULL));
    OK(s, spar_beam_set_quadrature(m[1], SPAR_QUADRATURE_GAUSS, 3));
    OK(s, spar_member_set_fidelity(m[1], SPAR_FIDELITY_PRESCRIBED, 0));
    OK(s, spar_member_set_root(m[1], SPAR_ROOT_DRIVEN));
    scene_diagonal(K, 4e4, 4e4, 4e4, 800, 600, 600);
    scene_diagonal(M, 1, 1, 1, .02, .01, .01);
    for (int i = 2; i < 5; i++) {
        static const char *const name[] = {"boom", "modes", "damped"};
        OK(s, spar_beam_create(s, name[i - 2], 1, i == 2 ? 4 : 6, &m[i]));
        OK(s, spar_beam_set_axis(m[i], 2, ends, i == 2 ? boom : modes, NULL));
        OK(s, spar_beam_set_sections(m[i], 1, zero, K, M));
    }
    OK(s, spar_member_set_fidelity(m[2], SPAR_FIDELITY_RIGID, 0));
    OK(s, spar_member_set_fidelity(m[3], SPAR_FIDELITY_MODAL, 4));
    OK(s, spar_member_set_root(m[2], SPAR_ROOT_FREE));
    scene_diagonal(M, 2, 2, 2, .3, .4, .5);
    OK(s, spar_rigid_create(s, "weight", at, NULL, M, &m[5]));
    OK(s, spar_member_set_initial_velocity(m[5], about, v, spin));
    scene_diagonal(M, 1, 1, 1, 1, 1, 1);
    OK(s, spar_rigid_create(s, "host's own", NULL, NULL, M, &m[6]));
    OK(s, spar_member_set_external(m[6], 1));
    OK(s, spar_point_create(s, "buoy", up, NULL, &m[7]));
}

static void commit_by_hand(spar_session *s, spar_member **m) {
    const double tip[6] = {0, 1, 2, 0.1, 0.2, 0.3}, three[6] = {0, 0.5, 0, 0, 0, 0}, ends[2] = {0, 1},
                 dead[12] = {1, 0, 0, 0, 0, 0, 0, 0, 3, 0, 0, 0}, half[1] = {0.5}, follower[6] = {0, 1, 0, 0, 0, 0},
                 ratio[2] = {0.02, 0.03};
    const int64_t mode[2] = {0, 1};
    for (int i = 0; i < MEMBERS; i++) {
        OK(s, spar_member_commit(m[i]));
    }
    OK(s, spar_beam_set_modal_damping(m[4], mode, ratio, NULL));
    OK(s, spar_member_set_load(m[0], 9, SPAR_LOAD_DEAD, tip));
    OK(s, spar_member_set_load(m[0], 3, SPAR_LOAD_FOLLOWER, three));
    OK(s, spar_beam_set_line_load(m[0], SPAR_LOAD_DEAD, 2, ends, dead));
    OK(s, spar_beam_set_line_load(m[0], SPAR_LOAD_FOLLOWER, 1, half, follower));
}

static void joints_by_hand(spar_session *s, spar_member **m) {
    const double far[3] = {0, 6, 0}, rest[4] = {1, 0, 0, 0}, hang[3] = {5, 0, -1}, tip[3] = {3, 2, 3},
                 above[3] = {0, 0, 3}, preload[6] = {0, 0, 1, 0, 0, 0}, load[6] = {0, 0, .5, 0, 0, 0};
    double k[36], d[36];
    spar_joint *j = NULL;
    OK(s, spar_joint_create(s, "shaft", m[2], 0, NULL, 0, SPAR_FREE_RZ, &j));
    OK(s, spar_joint_set_frame(j, far, rest));
    OK(s, spar_joint_set_driven(j, SPAR_FREE_RZ));
    scene_diagonal(k, 10, 10, 10, 10, 10, 10);
    OK(s, spar_joint_create(s, "tether", m[7], 0, NULL, 0, 63, &j));
    OK(s, spar_joint_set_spring(j, k, NULL, NULL));
    OK(s, spar_link_create(s, "rope", m[5], 0, hang, m[0], 9, tip, &j));
    OK(s, spar_link_set_spring(j, 50, 0.5, 4, 0));
    OK(s, spar_link_create(s, "stay", m[5], 0, hang, NULL, 0, above, &j));
    OK(s, spar_link_set_spring(j, 5, 0, 4, 1));
    scene_diagonal(d, .1, .1, .1, .1, .1, .1);
    OK(s, spar_joint_create(s, "moss", m[5], 0, NULL, 0, 63, &j));
    OK(s, spar_joint_set_spring(j, k, d, preload));
    OK(s, spar_joint_set_load(j, load));
    scene_diagonal(k, 1, 1, 1, 1, 1, 1);
    OK(s, spar_joint_create(s, "tip", m[5], 0, m[0], 9, 63, &j));
    OK(s, spar_joint_set_frame(j, hang, NULL));
    OK(s, spar_joint_set_spring(j, k, NULL, NULL));
}

static void settings_by_hand(spar_session *s) {
    const double g[3] = {0, 0.5, -9.81};
    OK(s, spar_session_set_gravity(s, g));
    OK(s, spar_session_set_integrator(s, 0.8, 2));
    OK(s, spar_session_set_newton(s, 1e-14, 1e-11, 40));
    OK(s, spar_session_set_coupling(s, SPAR_COUPLING_AITKEN, 1e-8, 1e-5, 44));
    OK(s, spar_session_set_relaxation(s, 0.6));
    OK(s, spar_session_set_predictor(s, 2));
    OK(s, spar_session_set_reproducible(s, 1));
    OK(s, spar_session_set_option(s, "coupling.reuse", "7"));
    OK(s, spar_session_set_option(s, "coupling.filter", "0.02"));
}

/* What a session is set to, as a text: two that are alike give one text. */
static void settings_text(const spar_session *s, char *to, size_t size) {
    static const char *const option[] = {"coupling.reuse", "coupling.columns", "coupling.filter"};
    double g[3], rho, newton[2], tolerance[2], omega;
    int sub, most, scheme, limit, order, bins;
    char text[3][32];
    OK(s, spar_session_get_gravity(s, g));
    OK(s, spar_session_get_integrator(s, &rho, &sub));
    OK(s, spar_session_get_newton(s, newton, newton + 1, &most));
    OK(s, spar_session_get_coupling(s, &scheme, tolerance, tolerance + 1, &limit));
    OK(s, spar_session_get_relaxation(s, &omega));
    OK(s, spar_session_get_predictor(s, &order));
    OK(s, spar_session_get_reproducible(s, &bins));
    for (int i = 0; i < 3; i++) {
        OK(s, spar_session_get_option(s, option[i], 32, text[i]));
    }
    (void)snprintf(to, size, "%a %a %a %a %d %a %a %d %d %a %a %d %a %d %d %s %s %s", g[0], g[1], g[2], rho, sub,
                   newton[0], newton[1], most, scheme, tolerance[0], tolerance[1], limit, omega, order, bins, text[0],
                   text[1], text[2]);
}

/* Everything that a file can say, and the same by hand: settings alike, members in the file's order, and 20 steps with
   the same bits (memcmp). Sections of other hosts hold nothing. */
static void test_everything(void **state) {
    (void)state;
    char text[8192], set[2][512];
    spar_session *s[2] = {scene_session(), scene_session()};
    spar_member *m[2][MEMBERS] = {{NULL}};
    spar_joint *moss = NULL;
    (void)snprintf(text, sizeof text, "%s%s", everything, joints);
    spar_case *c = read_text(s[0], "mine", text);
    settings_by_hand(s[1]);
    wing_by_hand(s[1], &m[1][0]);
    others_by_hand(s[1], m[1]);
    commit_by_hand(s[1], m[1]);
    joints_by_hand(s[1], m[1]);
    assert_int_equal(spar_case_member_count(c), MEMBERS);
    for (int i = 0; i < MEMBERS; i++) {
        m[0][i] = spar_case_member_at(c, i);
    }
    assert_null(spar_case_member_at(c, MEMBERS));
    settings_text(s[0], set[0], sizeof set[0]);
    settings_text(s[1], set[1], sizeof set[1]);
    assert_string_equal(set[0], set[1]);
    GOOD(spar_case_joint(c, "moss", &moss));
    same_run(s[0], s[1], m[0], m[1], MEMBERS, 20);
    spar_case_free(&c);
    assert_null(c);
    spar_case_free(&c);
    spar_session_destroy(&s[0]);
    spar_session_destroy(&s[1]);
}

/* A file that says nothing, or only what a host asks for, has no members. */
static void test_nothing(void **state) {
    (void)state;
    const char *const texts[] = {"", "# nothing\n\n", "[session]\n", "[host]\ndt 0.1"};
    for (int i = 0; i < 4; i++) {
        spar_session *s = scene_session();
        spar_case *c = read_text(s, NULL, texts[i]);
        spar_member *member = NULL;
        assert_int_equal(spar_case_member_count(c), 0);
        assert_int_equal(spar_case_member(c, "wing", &member), SPAR_ERR_ARGUMENT);
        assert_non_null(strstr(spar_case_message(), "the case has none"));
        GOOD(spar_case_output(c, 0, 0, NULL));
        OK(s, spar_step(s, 0.1, NULL, NULL, NULL));
        spar_case_free(&c);
        spar_session_destroy(&s);
    }
}

/* ---- the examples ---- */

static void read_example(spar_session *s, const char *file, const char *name, spar_case **c, spar_member **m) {
    char whole[512];
    (void)snprintf(whole, sizeof whole, CASES "%s", file);
    GOOD(spar_case_read(whole, NULL, s, c));
    GOOD(spar_case_member(*c, name, m));
}

/* The cylinder, alone, swings at its reduced velocity: period 4, so that after a quarter of it the push of 0.05 has
   become 0.05 * 4 / (2 pi) of way and no speed; 1e-4 of it for dt = 0.005. It does not leave its line. */
static void test_cylinder(void **state) {
    (void)state;
    spar_session *s = scene_session();
    spar_case *c = NULL;
    spar_member *m = NULL;
    double q[7], v[6];
    read_example(s, "cylinder.case", "cylinder", &c, &m);
    for (int i = 0; i < 200; i++) {
        OK(s, spar_step(s, 0.005, NULL, NULL, NULL));
    }
    OK(s, spar_member_get_motion(m, q, v, NULL));
    NEAR(q[1], 0.05 * 4 / (2 * 3.14159265358979323846), 1e-4 * 0.05);
    NEAR(v[1], 0, 1e-4);
    assert_true(q[0] == 0 && q[2] == 0);
    spar_case_free(&c);
    spar_session_destroy(&s);
}

/* The flag is the beam of CSM2 in tests/verification/turek_hron_flag.c, a slab of 0.01: its deflection under gravity 2
   is that one's, (-0.46604, -16.9240) mm to its digits. */
static void test_flag(void **state) {
    (void)state;
    const double g[3] = {0, -2, 0};
    spar_session *s = scene_session();
    spar_case *c = NULL;
    spar_member *m = NULL;
    double q[7];
    read_example(s, "flag.case", "flag", &c, &m);
    OK(s, spar_session_set_gravity(s, g));
    OK(s, spar_member_solve_static(m, 1));
    scene_tip(m, q);
    NEAR(1e3 * q[0], -0.46604, 6e-6);
    NEAR(1e3 * q[1], -16.9240, 6e-5);
    spar_case_free(&c);
    spar_session_destroy(&s);
}

/* The blade by tables against the same tables by examples/nrel5mw.c: the same bits. */
static void test_blade(void **state) {
    (void)state;
    const double g[3] = {0, 0, -9.81}, x[3] = {0, 0, 91.5}, q[4] = {0.7071067811865476, 0, -0.7071067811865476, 0};
    spar_session *s[2] = {scene_session(), scene_session()};
    spar_case *c = NULL;
    spar_member *m[2] = {NULL, NULL};
    nrel5mw data;
    nrel5mw_rotor rotor;
    double density;
    read_example(s[0], "blade.case", "blade", &c, &m[0]);
    GOOD(spar_case_get_numbers(c, "density", 1, NULL, &density));
    assert_true(density == 1.225);
    OK(NULL, nrel5mw_load(&data, SPAR_DATA_DIR "/nrel5mw"));
    nrel5mw_rotor_default(&data, &rotor);
    OK(s[1], spar_session_set_gravity(s[1], g));
    OK(s[1], nrel5mw_create_blade(&data, &rotor, s[1], 0, 1, 10, &m[1]));
    OK(s[1], spar_member_set_placement(m[1], x, q));
    OK(s[1], spar_member_commit(m[1]));
    for (int k = 0; k < 2; k++) {
        double motion[7] = {0, 0, 0, cos(0.01), 0, 0, sin(0.01)};
        OK(s[k], spar_member_drive(m[k], motion, NULL, NULL));
        OK(s[k], spar_step(s[k], 0.01, NULL, NULL, NULL));
    }
    double motion[2][7 * 10];
    OK(s[0], spar_member_get_motion(m[0], motion[0], NULL, NULL));
    OK(s[1], spar_member_get_motion(m[1], motion[1], NULL, NULL));
    assert_memory_equal(motion[0], motion[1], sizeof motion[0]);
    assert_true(motion[0][7 * 9] != 0);
    nrel5mw_free(&data);
    spar_case_free(&c);
    spar_session_destroy(&s[0]);
    spar_session_destroy(&s[1]);
}

/* BeamDyn's files by name: the blade file that the primary one names, or another. */
static void test_beamdyn(void **state) {
    (void)state;
    static const char primary[] = SPAR_SOURCE_DIR "/tests/data/bend_primary.inp",
                      blade[] = SPAR_SOURCE_DIR "/tests/data/bend_blade.inp",
                      quoted[] = "\"" SPAR_SOURCE_DIR "/tests/data/bend_blade.inp\"";
    for (int named = 0; named < 2; named++) {
        char text[2048];
        spar_session *s[2] = {scene_session(), scene_session()};
        spar_member *m[2] = {NULL, NULL};
        (void)snprintf(text, sizeof text, "[session]\ngravity 0 0 -9\n[beam b]\nnodes 9\nbeamdyn \"%s\" %s\n", primary,
                       named ? quoted : "");
        spar_case *c = read_text(s[0], NULL, text);
        GOOD(spar_case_member(c, "b", &m[0]));
        OK(s[1], spar_session_set_gravity(s[1], (double[]){0, 0, -9}));
        OK(s[1], spar_beam_create(s[1], "b", 1, 9, &m[1]));
        OK(s[1], spar_beam_read_beamdyn(m[1], primary, named ? blade : NULL));
        OK(s[1], spar_member_commit(m[1]));
        same_run(s[0], s[1], &m[0], &m[1], 1, 3);
        spar_case_free(&c);
        spar_session_destroy(&s[0]);
        spar_session_destroy(&s[1]);
    }
}

/* ---- the host's keys ---- */

static void test_host(void **state) {
    (void)state;
    const double otherwise[2] = {7, 8};
    double x[2] = {0, 0};
    const char *text = NULL;
    spar_session *s = scene_session();
    spar_case *c = read_text(s, "mine",
                             "[host]\npatch \"left wall\" right # two\nnear 0.04\nsize 1 2\n[host mine]\nnear 0.05\n"
                             "[host other]\nfar 3\n");
    GOOD(spar_case_get_text(c, "patch", NULL, &text));
    assert_string_equal(text, "left wall right");
    GOOD(spar_case_get_numbers(c, "near", 1, otherwise, x));
    assert_true(x[0] == 0.05);
    assert_int_equal(spar_case_check(c), SPAR_ERR_ARGUMENT);
    assert_non_null(strstr(spar_case_message(), "line 4: the host has not asked for 'size'"));
    assert_int_equal(spar_case_get_numbers(c, "size", 1, NULL, x), SPAR_ERR_ARGUMENT);
    assert_non_null(strstr(spar_case_message(), "size has 2 values; give 1"));
    GOOD(spar_case_get_numbers(c, "size", 2, NULL, x));
    assert_true(x[0] == 1 && x[1] == 2);
    GOOD(spar_case_check(c));
    GOOD(spar_case_get_numbers(c, "far", 2, otherwise, x));
    assert_true(x[0] == 7 && x[1] == 8);
    assert_int_equal(spar_case_get_numbers(c, "far", 1, NULL, x), SPAR_ERR_ARGUMENT);
    assert_non_null(strstr(spar_case_message(), "[host mine]"));
    assert_int_equal(spar_case_get_numbers(c, "patch", 2, NULL, x), SPAR_ERR_ARGUMENT);
    assert_true(x[0] == 7 && x[1] == 8);
    assert_string_equal(spar_case_others(c), "[host other] (line 7)");
    assert_string_equal(spar_case_others(NULL), "");
    int values = -1;
    GOOD(spar_case_get_word(c, "patch", 1, &values, &text));
    assert_true(values == 2 && strcmp(text, "right") == 0);
    GOOD(spar_case_get_word(c, "nothing", 0, &values, NULL));
    assert_int_equal(values, 0);
    assert_int_equal(spar_case_get_word(c, "patch", 2, NULL, &text), SPAR_ERR_ARGUMENT);
    assert_non_null(strstr(spar_case_message(), "patch has 2 values; give 3"));
    assert_int_equal(spar_case_get_word(c, "nothing", 0, NULL, &text), SPAR_ERR_ARGUMENT);
    GOOD(spar_case_get_text(c, "solver", "none", &text));
    assert_string_equal(text, "none");
    spar_case_free(&c);
    spar_session_destroy(&s);
    s = scene_session();
    c = read_text(s, "openfoam", "[session]\nrho_inf 0.9\n[session opnfoam]\nrtol 1e-3\n");
    assert_int_equal(spar_case_check(c), SPAR_ERR_ARGUMENT);
    assert_non_null(strstr(spar_case_message(), "line 3: [session opnfoam] is for another host than 'openfoam'"));
    spar_case_free(&c);
    spar_session_destroy(&s);
}

/* ---- mistakes ---- */

/* Each text is refused, and the message has both parts: line and what, and the cure. */
static void test_mistakes(void **state) {
    (void)state;
    static const struct {
        const char *text, *what, *cure;
    } wrong[] = {
        {"gravity 0 0 1\n", "line 1: is before the first heading", "[beam wing]"},
        {"[session\n", "line 1: the heading is not complete", "alone on its line"},
        {"[session] gravity 0 0 1\n", "line 1: the heading is not complete", "alone on its line"},
        {"[]\n", "line 1: no heading []", "did you mean"},
        {"\n[baem wing]\n", "line 2: no heading [baem]", "did you mean [beam]?"},
        {"[beam]\n", "line 1: [beam] needs a name", "[beam wing]"},
        {"[session]\n\n[session]\n", "line 3: [session ] has the name of the block in line 1", "merge the two"},
        {"[point a]\n[rigid a]\nmass 1 1 1 1 1 1\n", "line 2: [rigid a] has the name of the block in line 1",
         "rename it"},
        {"[session]\ngarvity 0 0 1\n", "line 2: [session] has no key 'garvity'", "did you mean 'gravity'?"},
        {"[point a]\nelements 3\n", "line 2: [point] has no key 'elements'", "did you mean"},
        {"[session]\ngravity 0 0\n", "line 2: gravity has 2 values", "give 3"},
        {"[session]\ngravity 0 0 0 0\n", "line 2: gravity has 4 values", "give 3"},
        {"[session]\ngravity 0 0 1\ngravity 0 0 1\n", "line 3: gravity is given twice", "first in line 2"},
        {"[session]\ngravity 0 0 \"1\n", "line 2: a quote is not closed", "close it"},
        {"[session]\ngravity 0 0 1,5\n", "line 2: gravity: '1,5' is not a number", "write it as 1, -0.5 or 2e-3"},
        {"[session]\ngravity 0 0 nan\n", "line 2: gravity: 'nan' is not a number", "write it"},
        {"[session]\ngravity 0 0 1e999\n", "line 2: gravity: '1e999' is not a number", "write it"},
        {"[session]\npredictor 1.5\n", "line 2: predictor: 1.5", "a whole number from 0 to 2"},
        {"[session]\nscheme iqnils\n", "line 2: scheme: 'iqnils' is not known", "did you mean iqn-ils?"},
        {"[session]\nreproducible yes\n", "line 2: reproducible: 'yes' is not known", "(off, on)"},
        {"[session]\nrho_inf 2\n", "line 2: spar_session_set_integrator", "rho_inf"},
        {"[session]\noption coupling.reus 3\n", "line 2: spar_session_set_option", "coupling.reus"},
        {"[rigid a]\n", "line 1: [rigid a] has no mass", "m m m Jx Jy Jz"},
        {"[rigid a]\nmass 1 1 1 1 1 1 1\n", "line 2: mass: a 6x6 matrix of 7 numbers", "21 (the upper triangle"},
        {"[rigid a]\nmass 1 2 1 1 1 1\n", "line 2: spar_rigid_create", "a"},
        {"[beam a]\n", "line 1: spar_member_commit: ", "a"},
        {"[beam a]\nnodes 1\n", "line 2: spar_beam_create", "nodes"},
        {"[beam a]\naxis 0 0 0 0\naxis 1 1 0 0 5\n", "line 3: axis has 5 numbers where the first one, in line 2, has 4",
         "give all the same number"},
        {"[beam a]\naxis 0 0 0 0\naxis 0 1 0 0\n", "line 2: spar_beam_set_axis", "eta"},
        {"[beam a]\naxis 0 0 0 0\naxis 1 1 0 0\nnode 0 0 0\n", "line 4: nodes and an axis (line 2)", "keep one"},
        {"[beam a]\nnode 0 0 0 1\n", "line 2: a node has 4 numbers", "qw qx qy qz"},
        {"[beam a]\nsection 0 1 1 1 1 1 1 1\n", "line 2: a row of the sections has 8 numbers", "6, 21 or 36"},
        {"[beam a]\nsection 0 1 1 1 1 1 -1\n", "line 2: spar_beam_set_sections", "a"},
        {"[beam a]\naxis_file nowhere.txt\n", "nowhere.txt: cannot be read", "check the path and its permissions"},
        {"[beam a]\naxis 0 0 0 0\naxis_file nowhere.txt\n", "line 2: axis and axis_file (line 3) are both", "keep one"},
        {"[beam a]\nbeamdyn nowhere.inp\n", "line 2: spar_beam_read_beamdyn", "nowhere.inp"},
        {"[beam a]\nfidelity modal\n", "line 2: fidelity modal", "its number of modes"},
        {"[beam a]\nfidelity exact 3\n", "line 2: fidelity exact", "its number of modes"},
        {"[beam a]\nquadrature simpson 3\n", "line 2: quadrature: 'simpson' is not known", "gauss, lobatto, sections"},
        {"[point a]\nload last dead 0 0 0 0 0\n", "line 2: load has 7 values", "give 8"},
        {"[point a]\nload 1 dead 0 0 0 0 0 0\n", "line 2: load: 1", "a whole number from 0 to 0"},
        {"[point a]\neffects_on inertia wrok\n", "line 2: effects_on: 'wrok' is not known", "did you mean work?"},
        {"[point a]\neffects_off inertia large_rotation\n", "line 2: spar_member_set_effects",
         "use SPAR_FIDELITY_LINEAR"},
        {"[point a]\norientation 0 0 0 0\n", "line 2: spar_member_set_placement", "a"},
        {"[joint j]\n", "line 1: [joint j] has no end a", "a MEMBER NODE"},
        {"[joint j]\na wing 0\n", "line 2: there is no member 'wing'", "the case has none"},
        {"[point tip]\n[joint j]\na tap 0\nb ground\n", "line 3: there is no member 'tap'", "did you mean 'tip'?"},
        {"[point tip]\n[joint j]\na tip 0\nb tip\n", "line 4: b: 'tip' has 1 nodes", "first, last, or a number"},
        {"[point tip]\n[joint j]\na tip 0\nb ground\nfree q\n", "line 5: free: 'q' is not known", "rx, ry, rz"},
        {"[point tip]\n[joint j]\na tip 0\nb ground\nfree y\nstiffness 1 1 1 1 1 1\n", "line 6: spar_joint_set_spring",
         "j"},
        {"[point tip]\n[line j]\na tip 0 0 0 0\nb ground 0 0 0\n", "line 2: spar_link_create", "j"},
        {"[point tip]\n[line j]\na tip 0 0 0 0\nb ground 0 0 1 1 1\n", "line 4: b has 6 values", "give 4 to 5"},
        {"[point tip]\n[output]\nwatch tip 0\n", "line 3: watch needs a history", "give history FILE"},
        {"[point tip]\n[output]\nhistory h\nwatch top 0\n", "line 4: there is no member 'top'", "'tip'"},
    };
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        spar_session *s = scene_session();
        spar_case *c = NULL;
        int status = spar_case_read(written(wrong[i].text), NULL, s, &c);
        const char *message = spar_case_message();
        if (status == SPAR_OK || !strstr(message, wrong[i].what) || !strstr(message, wrong[i].cure)) {
            fail_msg("\"%s\" gave %d: %s\nexpected: %s ... %s", wrong[i].text, status, message, wrong[i].what,
                     wrong[i].cure);
        }
        assert_null(c);
        (void)remove(path);
        spar_session_destroy(&s);
    }
}

/* Files that are none: not there, a folder, with a byte 0. */
static void test_files(void **state) {
    (void)state;
    spar_session *s = scene_session();
    spar_case *c = NULL;
    FILE *file = fopen(written(""), "w");
    assert_int_equal(spar_case_read("nowhere.case", NULL, s, &c), SPAR_ERR_IO);
    assert_non_null(strstr(spar_case_message(), "nowhere.case: cannot be read: No such file"));
    assert_int_equal(spar_case_read(".", NULL, s, &c), SPAR_ERR_IO);
    assert_non_null(file);
    assert_int_equal(fwrite("[session]\n\0gravity", 1, 18, file), 18);
    assert_int_equal(fclose(file), 0);
    assert_int_equal(spar_case_read(path, NULL, s, &c), SPAR_ERR_IO);
    assert_non_null(strstr(spar_case_message(), "not a text"));
    assert_int_equal(spar_case_read(NULL, NULL, s, &c), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_case_read(path, NULL, NULL, &c), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_case_read(path, NULL, s, NULL), SPAR_ERR_ARGUMENT);
    assert_null(c);
    (void)remove(path);
    spar_session_destroy(&s);
}

/* Under a locale with a comma (tests/torture/traps makes one) the same bits, and a history with points. */
static void test_comma(void **state) {
    (void)state;
    const char *const locale[] = {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8", "de_DE"};
    size_t k = 0;
    while (k < 4 && !setlocale(LC_ALL, locale[k])) {
        k++;
    }
    if (k == 4) {
        skip();
    }
    char row[512], number[8];
    double t, x;
    spar_session *s = scene_session();
    spar_case *c = read_text(s, NULL,
                             "[session]\ngravity 0 0 -9.81\n[point p]\nplace .5 0 0\n"
                             "[output]\nhistory test_case_comma.txt\n[host]\nx 1.5\n");
    GOOD(spar_case_get_numbers(c, "x", 1, NULL, &x));
    assert_true(x == 1.5);
    OK(s, spar_step(s, 0.25, NULL, NULL, NULL));
    GOOD(spar_case_output(c, 0, 0, NULL));
    (void)snprintf(number, sizeof number, "%.1f", 0.5);
    assert_string_equal(number, "0,5"); /* the host's is as it was */
    spar_case_free(&c);
    spar_session_destroy(&s);
    (void)setlocale(LC_ALL, "C");
    FILE *file = fopen("test_case_comma.txt", "r");
    assert_non_null(file);
    assert_non_null(fgets(row, sizeof row, file));
    assert_int_equal(fscanf(file, "%lf", &t), 1);
    assert_true(t == 0.25);
    (void)fclose(file);
    (void)remove("test_case_comma.txt");
}

/* ---- what is written ---- */

static int exists(const char *file) {
    return access(file, R_OK) == 0;
}

/* A history line a step with the tip of a swinging body, pictures every second step, those of the fluid for its rank;
   the own [output] replaces the common one. */
static void test_output(void **state) {
    (void)state;
    const double at[3] = {0, 0, 0};
    char line[2][1024];
    double t, value[15], q[7], v[6];
    spar_fluid *fluid = NULL;
    spar_session *s = scene_session();
    (void)remove("test_case_history.txt"); /* of a run that was killed */
    spar_case *c = read_text(s, "mine",
                             "[rigid body/one]\nmass 2 2 2 1 1 1\nvelocity 0 1 0\n[joint k]\na body/one 0\nb ground\n"
                             "free y\nstiffness 0 3 0 0 0 0\n[output]\nhistory never.txt\n[output mine]\n"
                             "folder test_case_vtk\nevery 2\nfluids on\nhistory test_case_history.txt\n"
                             "watch body/one last\n");
    spar_member *body = spar_case_member_at(c, 0);
    OK(s, spar_fluid_create(body, "air", &fluid));
    OK(s, spar_fluid_set_motion_nodes(fluid, 1, at));
    OK(s, spar_fluid_map(fluid));
    for (int i = 0; i < 2; i++) {
        OK(s, spar_step(s, 0.125, NULL, NULL, NULL));
        GOOD(spar_case_output(c, 3, 1, &fluid)); /* of another rank: its fluid only */
        assert_int_equal(exists("test_case_history.txt"), i);
        GOOD(spar_case_output(c, 0, 1, &fluid));
    }
    OK(s, spar_member_get_motion(body, q, v, NULL));
    FILE *file = fopen("test_case_history.txt", "r");
    assert_non_null(file);
    assert_non_null(fgets(line[0], sizeof line[0], file));
    assert_non_null(strstr(line[0], "body/one.0.uy"));
    for (int i = 0; i < 2; i++) {
        assert_int_equal(fscanf(file, "%lf", &t), 1);
        for (int k = 0; k < 14; k++) {
            assert_int_equal(fscanf(file, "%lf", value + k), 1);
        }
    }
    (void)fclose(file);
    assert_true(t == 0.25 && value[0] == 2);
    assert_true(value[6] == q[1] && value[9] == v[1]); /* 17 digits are the number */
    static const char *const files[] = {
        "test_case_vtk/body_one.000002.vtp",
        "test_case_vtk/body_one.pvd",
        "test_case_vtk/air.0.000002.vtp",
        "test_case_vtk/air.0.pvd",
        "test_case_vtk/air.3.000002.vtp",
        "test_case_vtk/air.3.pvd",
        "test_case_history.txt",
    };
    assert_false(exists("never.txt") || exists("test_case_vtk/body_one.000001.vtp"));
    for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
        assert_true(exists(files[i]));
        (void)remove(files[i]);
    }
    (void)rmdir("test_case_vtk");
    spar_case_free(&c);
    spar_session_destroy(&s);
}

/* What cannot be written is told, with the cure. */
static void test_no_output(void **state) {
    (void)state;
    spar_session *s = scene_session();
    spar_case *c = read_text(s, NULL, "[point p]\n[output]\nfolder /dev/null/pictures\nevery 1\n");
    OK(s, spar_step(s, 0.1, NULL, NULL, NULL));
    assert_int_equal(spar_case_output(c, 0, 0, NULL), SPAR_ERR_IO);
    assert_non_null(strstr(spar_case_message(), "/dev/null/pictures"));
    assert_non_null(strstr(spar_case_message(), "make it, or name another"));
    assert_int_equal(spar_case_output(c, 0, 1, NULL), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_case_output(NULL, 0, 0, NULL), SPAR_ERR_ARGUMENT);
    spar_case_free(&c);
    spar_session_destroy(&s);
}

/* ---- what fluids bring ---- */

/* Guesses of the added mass, of a beam by stations and of a rigid body, are those of the file. */
static void test_added_mass(void **state) {
    (void)state;
    spar_session *s = scene_session();
    spar_case *c = read_text(
        s, NULL,
        "[beam wing]\nnodes 4\naxis 0 0 0 0\naxis 1 2 0 0\nsection 0 4e4 4e4 4e4 800 600 600 1 1 1 "
        ".02 .01 .01\nadded_mass 0 1 2 3 .4 .5 .6\nadded_mass 1 2 4 6 .8 1 1.2\nadded_mass_response velocity\n"
        "mass_damping .25\nbody 1 5 5 5 .1 .1 .2\nbody .5 3 3 3 .1 .1 .1\n"
        "[rigid body]\nplace 5 0 0\nmass 2 2 2 1 1 1\nadded_mass 7 8 9 .7 .8 .9\nroot free\n");
    const double given[6] = {1, 2, 3, .4, .5, .6};
    double eta[2], mass[2][36];
    int64_t n = 0;
    OK(s, spar_member_get_added_mass(spar_case_member_at(c, 0), &n, 2, eta, mass[0]));
    assert_true(n == 2 && eta[0] == 0 && eta[1] == 1);
    for (int i = 0; i < 6; i++) {
        assert_true(mass[0][7 * i] == given[i] && mass[1][7 * i] == 2 * given[i]);
    }
    assert_true(mass[0][1] == 0);
    OK(s, spar_beam_get_mass_damping(spar_case_member_at(c, 0), eta));
    assert_true(eta[0] == .25);
    OK(s, spar_beam_get_masses(spar_case_member_at(c, 0), &n, 2, eta, mass[0]));
    assert_true(n == 2 && eta[0] == 1 && eta[1] == .5 && mass[0][7] == 5 && mass[0][35] == .2 && mass[1][0] == 3);
    OK(s, spar_member_get_added_mass(spar_case_member_at(c, 1), &n, 1, NULL, mass[0]));
    assert_true(n == 1 && mass[0][0] == 7 && mass[0][7] == 8 && mass[0][35] == .9);
    for (int i = 0; i < 2; i++) {
        int response;
        OK(s, spar_member_get_added_mass_response(spar_case_member_at(c, i), &response));
        assert_int_equal(response, i == 0 ? SPAR_RESPONSE_VELOCITY : SPAR_RESPONSE_ACCELERATION);
    }
    spar_case_free(&c);
    spar_session_destroy(&s);
}

/* Springs along a beam, section forces of its reference, and its plane; effects by name, each the bit it is. */
static void test_stations(void **state) {
    (void)state;
    spar_session *s = scene_session();
    spar_case *c =
        read_text(s, NULL,
                  "[beam pile]\nnodes 4\naxis 0 0 0 0\naxis 1 2 0 0\nsection 0 4e4 4e4 4e4 800 600 600 1 1 1 "
                  ".02 .01 .01\nfoundation .2 1 2 3\nfoundation .2 4 5 6\npretension 0 100 0 0 1 2 3\nplane 0 2 0\n"
                  "effects_off gravity gyroscopic fluid_moment\neffects_on work\nroot fixed\n");
    double eta[2], k[2][3], force[6], normal[3];
    int64_t n = 0;
    int effects = 0;
    OK(s, spar_beam_get_foundation(spar_case_member_at(c, 0), &n, 2, eta, k[0]));
    assert_true(n == 2 && eta[0] == .2 && eta[1] == .2 && k[0][0] == 1 && k[0][2] == 3 && k[1][1] == 5);
    OK(s, spar_beam_get_pretension(spar_case_member_at(c, 0), &n, 1, eta, force));
    assert_true(n == 1 && eta[0] == 0 && force[0] == 100 && force[3] == 1 && force[5] == 3);
    OK(s, spar_beam_get_plane(spar_case_member_at(c, 0), normal));
    assert_true(normal[0] == 0 && normal[1] == 1 && normal[2] == 0);
    OK(s, spar_member_get_effects(spar_case_member_at(c, 0), &effects));
    assert_int_equal(effects, SPAR_EFFECT_INERTIA | SPAR_EFFECT_FOUNDATION | SPAR_EFFECT_PRETENSION | SPAR_EFFECT_WORK);
    spar_case_free(&c);
    spar_session_destroy(&s);
}

static const char wing_text[] = "[beam wing]\nnodes 5\naxis 0 0 0 0\naxis 1 4 0 0\n"
                                "section 0 4e6 4e6 4e6 3e4 2e4 2e4 5 5 5 .2 .1 .1\n";

static int blow_case(spar_session *s, double t, double dt, int iteration, void *scene) {
    (void)s, (void)t, (void)dt, (void)iteration;
    return spar_case_blow(scene);
}

typedef struct by_hand {
    spar_aero *aero;
    double wind[9];
} by_hand;

static int blow_by_hand(spar_session *s, double t, double dt, int iteration, void *context) {
    (void)s, (void)t, (void)dt, (void)iteration;
    by_hand *h = context;
    return spar_aero_solve(h->aero, 1.2, h->wind, 1.0);
}

static const double wing_chord[3] = {1, .8, .5};

static void air_by_hand(spar_session *s, spar_member *wing, by_hand *h) {
    const double eta[3] = {0, 0.5, 1}, offset[9] = {0, 0, 0, 0, .1, .02, 0, 0, 0}, twist[3] = {.05, 0, -.05};
    const double alpha[2] = {-.5, .5}, cl[2] = {-2.5, 2.5}, cd[2] = {.1, .1}, cm[2] = {0, -.05};
    spar_fluid *fluid = NULL;
    spar_polar *polar = NULL;
    OK(s, spar_fluid_create(wing, "air", &fluid));
    OK(s, spar_fluid_set_stations(fluid, 3, eta, offset));
    OK(s, spar_fluid_map(fluid));
    OK(s, spar_aero_create(1, &fluid, &h->aero));
    OK(NULL, spar_polar_create(2, alpha, cl, cd, cm, &polar));
    for (int i = 0; i < 3; i++) {
        OK(s, spar_aero_set_section(h->aero, i, wing_chord[i], twist[i], polar));
    }
    spar_polar_destroy(&polar);
    OK(s, spar_aero_set_shear(h->aero, SPAR_SHEAR_LOG, (double[3]){0, 0, -9}, (double[3]){0, 0, 2}, 10, .03));
    OK(s, spar_aero_set_tower(h->aero, (double[3]){1, 3, -9}, (double[3]){1, 3, 5}, .7, .5));
    OK(s, spar_aero_set_effects(h->aero, SPAR_AERO_DRAG | SPAR_AERO_SHEAR | SPAR_AERO_TOWER | SPAR_AERO_UNSTEADY));
}

static spar_case *air_by_text(spar_session *s) {
    char text[2048];
    FILE *file = fopen("test_case_polar.txt", "w");
    assert_non_null(file);
    assert_true(fputs("# alpha cl cd cm\n-0.5 -2.5 0.1 0\n0.5 2.5 0.1 -.05\n", file) >= 0);
    assert_int_equal(fclose(file), 0);
    (void)snprintf(text, sizeof text,
                   "%s[aero air]\nblades wing\nsection 0 1 .05 test_case_polar.txt\n"
                   "section .5 .8 0 test_case_polar.txt 0.1 0.02\nsection 1 .5 -.05 test_case_polar.txt\n"
                   "density 1.2\nwind 0 30 -3\nshear log 0 0 -9 0 0 2 10 .03\ntower 1 3 -9 1 3 5 .7 .5\n"
                   "effects drag shear tower unsteady\n",
                   wing_text);
    spar_case *c = read_text(s, NULL, text);
    assert_int_equal(spar_case_check(c), SPAR_ERR_ARGUMENT);
    assert_non_null(strstr(spar_case_message(), "this host has no blade elements; remove [aero air]"));
    GOOD(spar_case_make_aero(c, 0));
    GOOD(spar_case_check(c));
    assert_int_equal(spar_case_make_aero(c, 0), SPAR_ERR_STATE);
    (void)remove("test_case_polar.txt");
    return c;
}

/* A wing in a wind, by a file with its polar and by the calls: ten steps with the same bits, in which the wind moves
   it. A host without blade elements refuses the file. */
static void test_aero(void **state) {
    (void)state;
    by_hand h = {.wind = {0, 30, -3, 0, 30, -3, 0, 30, -3}};
    spar_session *s[2] = {scene_session(), scene_session()};
    spar_case *c[2] = {air_by_text(s[0]), read_text(s[1], NULL, wing_text)};
    double q[2][7 * 5], chord[3];
    spar_aero *aero = NULL;
    air_by_hand(s[1], spar_case_member_at(c[1], 0), &h);
    GOOD(spar_case_aero(c[0], "air", &aero));
    OK(s[0], spar_aero_get_chord(aero, chord, NULL));
    assert_memory_equal(chord, wing_chord, sizeof chord);
    assert_int_equal(spar_case_aero(c[0], "water", &aero), SPAR_ERR_ARGUMENT);
    for (int i = 0; i < 10; i++) {
        OK(s[0], spar_step(s[0], 0.01, blow_case, c[0], NULL));
        OK(s[1], spar_step(s[1], 0.01, blow_by_hand, &h, NULL));
    }
    for (int k = 0; k < 2; k++) {
        OK(s[k], spar_member_get_motion(spar_case_member_at(c[k], 0), q[k], NULL, NULL));
    }
    assert_memory_equal(q[0], q[1], sizeof q[0]);
    assert_true(fabs(q[0][7 * 4 + 2]) > 1e-3);
    spar_aero_destroy(&h.aero);
    for (int k = 0; k < 2; k++) {
        spar_case_free(&c[k]);
        spar_session_destroy(&s[k]);
    }
}

/* AeroDyn's files, at as many sections as are wanted: chords between those of the stations, from the cylinder's 3.542 m
   at the root, 4.652 at most; on other ranks nothing. */
static void test_aero_files(void **state) {
    (void)state;
    const char *const text =
        "[beam blade]\nnodes 6\naxis 0 0 0 0\naxis 1 61.5 0 0\n"
        "section 0 4e9 4e9 4e9 3e9 2e9 2e9 500 500 500 20 10 10\n"
        "[aero rotor]\nblades blade\naerodyn \"" SPAR_SOURCE_DIR "/tests/data/aerodyn/primary.dat\"\n"
        "stations 12 0 61.4\nrotor 0 0 0 0 0 1 1.5 63\ndensity 1.225\nwind 0 0 8\ntotal 3\n";
    double chord[12], least = 10, most = 0;
    for (int rank = 0; rank < 2; rank++) {
        spar_session *s = scene_session();
        spar_case *c = read_text(s, NULL, text);
        spar_aero *aero = NULL;
        GOOD(spar_case_make_aero(c, rank));
        assert_int_equal(spar_case_aero(c, "rotor", &aero), rank ? SPAR_ERR_ARGUMENT : SPAR_OK);
        if (rank == 0) {
            OK(s, spar_aero_get_chord(aero, chord, NULL));
            for (int i = 0; i < 12; i++) {
                least = fmin(least, chord[i]);
                most = fmax(most, chord[i]);
            }
            assert_true(fabs(chord[0] - 3.542) < 1e-12 && least > 1 && most > 4.4 && most <= 4.652);
        }
        spar_case_free(&c);
        spar_session_destroy(&s);
    }
}

/* What is wrong about [aero] is told when it is made. */
static void test_aero_mistakes(void **state) {
    (void)state;
    static const struct {
        const char *text, *what;
    } wrong[] = {
        {"[aero a]\nblades wing\n", "line 8: [aero a] needs blades MEMBER ..., and either"},
        {"[aero a]\nblades wnig\nsection 0 1 0 p\n", "line 9: there is no member 'wnig'; did you mean 'wing'?"},
        {"[aero a]\nblades wing\nsection 0 1 0 none.txt\nsection 1 1 0 none.txt\n", "none.txt: cannot be read"},
        {"[aero a]\nblades wing\nsection 0 1 0 p 1\n", "line 10: section has 5 values"},
        {"[aero a]\nblades wing\naerodyn none.dat\n", "line 10: spar_fluid_read_aerodyn: "},
        {"[aero a]\nblades wing\nstations 3 0 1\nsection 0 1 0 p\n",
         "line 10: stations applies to AeroDyn's files alone"},
        {"[aero a]\nblades wing\nsection 0 1 0 p\naerodyn p\n", "line 8: [aero a] needs blades"},
        {"[aero a]\nblades wing\naerodyn \"" SPAR_SOURCE_DIR "/tests/data/aerodyn/primary.dat\"\n"
         "stations 3 0 4\nshear exp 0 0 0 0 0 1 90 .2\n",
         "line 12: "},
    };
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        char text[1024];
        (void)snprintf(text, sizeof text, "%s\n\n%s", wing_text, wrong[i].text);
        spar_session *s = scene_session();
        spar_case *c = read_text(s, NULL, text);
        if (spar_case_make_aero(c, 0) == SPAR_OK || !strstr(spar_case_message(), wrong[i].what)) {
            fail_msg("\"%s\" gave: %s\nexpected: %s", wrong[i].text, spar_case_message(), wrong[i].what);
        }
        spar_case_free(&c);
        spar_session_destroy(&s);
    }
}

/* ---- a run that goes on ---- */

/* Saved after the third step of six, loaded, three more: the same bits. A host that cannot refuses `restart`. */
static void test_restart(void **state) {
    (void)state;
    char text[1024];
    double q[2][7 * 5];
    int restarted = -1;
    for (int k = 0; k < 2; k++) {
        (void)snprintf(text, sizeof text, "%s[session]\ngravity 0 0 -9.81\n%s", wing_text,
                       k ? "restart test_case_save.000003\n" : "[output]\nsave test_case_save 3\n");
        spar_session *s = scene_session();
        spar_case *c = read_text(s, NULL, text);
        assert_int_equal(spar_case_check(c), k ? SPAR_ERR_ARGUMENT : SPAR_OK);
        assert_true(!k || strstr(spar_case_message(), "cannot continue a saved run; remove restart"));
        GOOD(spar_case_restart(c, &restarted));
        GOOD(spar_case_check(c));
        assert_int_equal(restarted, k);
        for (int i = 0; i < (k ? 3 : 6); i++) {
            OK(s, spar_step(s, 0.01, NULL, NULL, NULL));
            GOOD(spar_case_output(c, 0, 0, NULL));
            assert_true(k || exists("test_case_save.000003") == (i >= 2));
        }
        OK(s, spar_member_get_motion(spar_case_member_at(c, 0), q[k], NULL, NULL));
        spar_case_free(&c);
        spar_session_destroy(&s);
    }
    assert_memory_equal(q[0], q[1], sizeof q[0]);
    assert_true(exists("test_case_save.000006") && !exists("test_case_save.000004"));
    (void)remove("test_case_save.000003");
    (void)remove("test_case_save.000006");
    spar_session *s = scene_session();
    spar_case *c = read_text(s, NULL, "[session]\nrestart nowhere.spar\n");
    assert_int_equal(spar_case_restart(c, NULL), SPAR_ERR_IO);
    assert_non_null(strstr(spar_case_message(), "line 2: spar_session_load"));
    spar_case_free(&c);
    spar_session_destroy(&s);
}

/* A flow that goes on: the structure with it, from the file of that time and step, or not at all. */
static void test_resume(void **state) {
    (void)state;
    static const struct {
        const char *text, *file; /* more of the case; the file beside the flow's checkpoint, NULL: the flow starts */
        double t;
        int64_t step;
        int status;
        const char *message;
    } run[] = {
        {"", NULL, 0, 0, SPAR_OK, ""},
        {"", "test_case_resume.000003", 0.03, 3, SPAR_OK, ""},
        {"", "test_case_resume.000003", 0.03 * (1 + 1e-12), -1, SPAR_OK, ""},
        {"[session]\nrestart test_case_resume.000003\n", "nowhere", 0.03, 3, SPAR_OK, ""},
        {"", "nowhere", 0.03, 3, SPAR_ERR_IO, "the flow continues from t = 0.03 s, and the structure cannot"},
        {"", NULL, 0.03, 3, SPAR_ERR_ARGUMENT, "the flow starts at t = 0.03 s and the structure at 0"},
        {"", "test_case_resume.000003", 0.04, 3, SPAR_ERR_ARGUMENT, "from 0.03 s (step 3)"},
        {"", "test_case_resume.000003", 0.03, 4, SPAR_ERR_ARGUMENT, "from t = 0.03 s (step 4)"},
        {"[session]\nrestart test_case_resume.000003\n", NULL, 0, 0, SPAR_ERR_ARGUMENT, "line "},
        {"", NULL, -1, 0, SPAR_ERR_ARGUMENT, "t below 0"},
    };
    char text[1024];
    (void)snprintf(text, sizeof text, "%s[output]\nsave test_case_resume 3\n", wing_text);
    spar_session *s = scene_session();
    spar_case *c = read_text(s, NULL, text);
    for (int i = 0; i < 3; i++) {
        OK(s, spar_step(s, 0.01, NULL, NULL, NULL));
        GOOD(spar_case_output(c, 0, 0, NULL));
    }
    spar_case_free(&c);
    spar_session_destroy(&s);
    for (size_t i = 0; i < sizeof run / sizeof *run; i++) {
        double t = -1;
        s = scene_session();
        (void)snprintf(text, sizeof text, "%s%s", wing_text, run[i].text);
        c = read_text(s, NULL, text);
        const int status = spar_case_resume(c, run[i].file, run[i].t, run[i].step);
        if (status != run[i].status || (status != SPAR_OK && !strstr(spar_case_message(), run[i].message))) {
            fail_msg("run %d: %d, %s", (int)i, status, spar_case_message());
        }
        OK(s, spar_session_get_time(s, &t, NULL, NULL));
        assert_true(status != SPAR_OK || fabs(t - run[i].t) < 1e-12);
        spar_case_free(&c);
        spar_session_destroy(&s);
    }
    (void)remove("test_case_resume.000003");
}

/* Rows up to the time stay, whatever their length, and so do headings. */
static void test_cut(void **state) {
    (void)state;
    static const struct {
        double t;
        size_t left;
    } cut[] = {{9, 120}, {0.2, 120}, {0.15, 26 + 85}, {0.1, 26 + 85}, {0.05, 26}, {0, 26}};
    char text[200];
    (void)snprintf(text, sizeof text, "# t and more of a heading\n0.1,%080d\n0.2,5e-1\n", 0);
    for (size_t i = 0; i < sizeof cut / sizeof *cut; i++) {
        char got[200] = "";
        FILE *file = fopen("test_case_cut.csv", "w");
        assert_non_null(file);
        (void)fputs(text, file);
        (void)fclose(file);
        GOOD(spar_case_cut_history("test_case_cut.csv", cut[i].t));
        file = fopen("test_case_cut.csv", "r");
        assert_non_null(file);
        const size_t left = fread(got, 1, sizeof got, file);
        (void)fclose(file);
        assert_int_equal(left, cut[i].left);
        assert_memory_equal(got, text, left);
    }
    (void)remove("test_case_cut.csv");
    GOOD(spar_case_cut_history("test_case_cut.csv", 1));
    assert_int_equal(spar_case_cut_history("test_case_cut.csv", NAN), SPAR_ERR_ARGUMENT);
}

int main(void) {
    (void)setlocale(LC_ALL, "C"); /* examples/nrel5mw.c and what is read back below keep to it */
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_everything), cmocka_unit_test(test_nothing),       cmocka_unit_test(test_cylinder),
        cmocka_unit_test(test_flag),       cmocka_unit_test(test_blade),         cmocka_unit_test(test_beamdyn),
        cmocka_unit_test(test_host),       cmocka_unit_test(test_mistakes),      cmocka_unit_test(test_files),
        cmocka_unit_test(test_comma),      cmocka_unit_test(test_output),        cmocka_unit_test(test_no_output),
        cmocka_unit_test(test_added_mass), cmocka_unit_test(test_stations),      cmocka_unit_test(test_aero),
        cmocka_unit_test(test_aero_files), cmocka_unit_test(test_aero_mistakes), cmocka_unit_test(test_restart),
        cmocka_unit_test(test_resume),     cmocka_unit_test(test_cut),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
