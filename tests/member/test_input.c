/* Bad input: each has its status and a message that names the member; the session goes on as if the call had not been
 * made. */
#include "scene.h"

static double K[36], M[36];

/* A small run with known answer: after any refusal the session must still do it. */
static void still_works(spar_session *s, const char *name) {
    double load[6] = {0, 0, 150, 0, 0, 0}, q[7];
    spar_member *b = scene_beam(s, name, 1, 12, 10, K, M);
    OK(s, spar_member_commit(b));
    OK(s, spar_member_set_load(b, 11, SPAR_LOAD_DEAD, load));
    OK(s, spar_member_solve_static(b, 1));
    scene_tip(b, q);
    NEAR(q[2], 1.2297364829237, 1e-10); /* composite box, see test_static.c */
}

static void test_null_handles(void **state) {
    (void)state;
    double x[3] = {0}, q[7] = {0};
    int done;
    int64_t n;
    spar_member *m = NULL;
    assert_int_equal(spar_session_create(NULL), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_session_set_gravity(NULL, x), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_session_set_integrator(NULL, 1, 1), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_session_set_option(NULL, "a", "b"), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_session_get_time(NULL, NULL, NULL, NULL), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_point_create(NULL, "p", x, NULL, &m), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_beam_create(NULL, "b", 1, 4, &m), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_rigid_create(NULL, "r", x, NULL, M, &m), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_beam_set_axis(NULL, 0, NULL, NULL, NULL), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_member_commit(NULL), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_member_get_count(NULL, &n), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_member_get_motion(NULL, q, NULL, NULL), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_member_solve_static(NULL, 1), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_step_begin(NULL, 1), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_step_solve(NULL), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_step_check(NULL, &done), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_step_accept(NULL), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_step_reject(NULL), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_step(NULL, 1, NULL, NULL, NULL), SPAR_ERR_ARGUMENT);
    assert_null(m);
    spar_session_destroy(NULL);
    spar_session *none = NULL;
    spar_session_destroy(&none);
}

/* No body has the moments 200, 300, 900, in any axes and about any point; rounded to two digits, or with moments left
   out, a body may have them. */
static void test_impossible_inertia(void **state) {
    (void)state;
    static const double J[6][3] = {{200, 300, 900}, {200, 900, 300}, {1, 1, 2.1},
                                   {900, 0, 0},     {300, 200, 500}, {0, 3, 3}};
    const double x[3] = {0}, straight[4] = {1, 0, 0, 0}, tip = 1;
    for (int k = 0; k < 6; k++) {
        double mass[36], c[3] = {0, k == 1 ? 0.4 : 0, 0};
        spar_session *s = scene_session();
        spar_member *b, *beam = scene_beam(s, "beam", 1, 12, 10, K, M);
        scene_mass(mass, 50, c, J[k]);
        if (k < 2) {
            REFUSED(s, SPAR_ERR_ARGUMENT, "no body has the moments of inertia",
                    spar_rigid_create(s, "body", x, straight, mass, &b));
            REFUSED(s, SPAR_ERR_ARGUMENT, "of body 0", spar_beam_set_masses(beam, 1, &tip, mass));
        } else {
            OK(s, spar_rigid_create(s, "body", x, straight, mass, &b));
            OK(s, spar_beam_set_masses(beam, 1, &tip, mass));
        }
        spar_session_destroy(&s);
    }
}

static void test_session_settings(void **state) {
    (void)state;
    spar_session *s = scene_session();
    double g[3] = {0, 0, NAN};
    REFUSED(s, SPAR_ERR_ARGUMENT, "gravity", spar_session_set_gravity(s, g));
    REFUSED(s, SPAR_ERR_ARGUMENT, "gravity", spar_session_set_gravity(s, NULL));
    REFUSED(s, SPAR_ERR_ARGUMENT, "rho_inf", spar_session_set_integrator(s, 1.1, 1));
    REFUSED(s, SPAR_ERR_ARGUMENT, "rho_inf", spar_session_set_integrator(s, NAN, 1));
    REFUSED(s, SPAR_ERR_ARGUMENT, "substeps", spar_session_set_integrator(s, 1, 0));
    REFUSED(s, SPAR_ERR_ARGUMENT, "atol is -1; give a finite number >= 0", spar_session_set_newton(s, -1, 0, 10));
    REFUSED(s, SPAR_ERR_ARGUMENT, "iterations", spar_session_set_newton(s, 0, 0, 0));
    REFUSED(s, SPAR_ERR_ARGUMENT, "order", spar_session_set_predictor(s, 3));
    REFUSED(s, SPAR_ERR_ARGUMENT, "scheme", spar_session_set_coupling(s, 9, 0, 0, 1));
    REFUSED(s, SPAR_ERR_ARGUMENT, "atol is nan", spar_session_set_coupling(s, 1, NAN, 0, 1));
    REFUSED(s, SPAR_ERR_ARGUMENT, "omega", spar_session_set_relaxation(s, 0));
    REFUSED(s, SPAR_ERR_ARGUMENT, "no option 'colour'; give one of newton.budget, coupling.",
            spar_session_set_option(s, "colour", "red"));
    REFUSED(s, SPAR_ERR_ARGUMENT, "does not accept", spar_session_set_option(s, "coupling.norm", "red"));
    REFUSED(s, SPAR_ERR_ARGUMENT, "NULL", spar_session_set_option(s, NULL, "red"));
    still_works(s, "after");
    spar_session_destroy(&s);
}

static void test_members(void **state) {
    (void)state;
    double x[3] = {0, 0, 0}, bad[3] = {0, INFINITY, 0}, q[4] = {1, 1, 0, 0}, mass[36], nan4[4] = {NAN, 0, 0, 0};
    spar_session *s = scene_session();
    spar_member *m = NULL, *b;
    scene_diagonal(mass, 1, 1, 1, 1, 1, 1);
    REFUSED(s, SPAR_ERR_ARGUMENT, "name", spar_point_create(s, NULL, x, NULL, &m));
    REFUSED(s, SPAR_ERR_ARGUMENT, "name", spar_point_create(s, "", x, NULL, &m));
    REFUSED(s, SPAR_ERR_ARGUMENT, "NULL", spar_point_create(s, "p", x, NULL, NULL));
    REFUSED(s, SPAR_ERR_ARGUMENT, "finite", spar_point_create(s, "p", bad, NULL, &m));
    REFUSED(s, SPAR_ERR_ARGUMENT, "unit", spar_point_create(s, "p", x, q, &m));
    REFUSED(s, SPAR_ERR_ARGUMENT, "finite", spar_point_create(s, "p", x, nan4, &m));
    REFUSED(s, SPAR_ERR_ARGUMENT, "NULL", spar_rigid_create(s, "r", x, NULL, NULL, &m));
    mass[0] = mass[7] = mass[14] = -1;
    REFUSED(s, SPAR_ERR_ARGUMENT, "negative", spar_rigid_create(s, "r", x, NULL, mass, &m));
    scene_diagonal(mass, 1, 2, 1, 1, 1, 1);
    REFUSED(s, SPAR_ERR_ARGUMENT, "identity", spar_rigid_create(s, "r", x, NULL, mass, &m));
    scene_diagonal(mass, 1, 1, 1, 1, -1, 1);
    REFUSED(s, SPAR_ERR_ARGUMENT, "inertia", spar_rigid_create(s, "r", x, NULL, mass, &m));
    scene_diagonal(mass, 1, 1, 1, 1, 1, 1);
    mass[1] = 0.5;
    REFUSED(s, SPAR_ERR_ARGUMENT, "symmetric", spar_rigid_create(s, "r", x, NULL, mass, &m));
    REFUSED(s, SPAR_ERR_ARGUMENT, "elements", spar_beam_create(s, "b", 0, 4, &m));
    REFUSED(s, SPAR_ERR_ARGUMENT, "nodes", spar_beam_create(s, "b", 1, 1, &m));
    REFUSED(s, SPAR_ERR_ARGUMENT, "nodes", spar_beam_create(s, "b", 1, 25, &m));
    assert_null(m);
    OK(s, spar_beam_create(s, "b", 1, 4, &b));
    REFUSED(s, SPAR_ERR_ARGUMENT, "'b'", spar_beam_create(s, "b", 1, 4, &m));
    REFUSED(s, SPAR_ERR_STATE, "no axis", spar_member_commit(b));
    REFUSED(s, SPAR_ERR_ARGUMENT, "root", spar_member_set_root(b, 7));
    REFUSED(s, SPAR_ERR_ARGUMENT, "effect", spar_member_set_effects(b, 1 << 20, 0));
    REFUSED(s, SPAR_ERR_ARGUMENT, "unknown effect bits 0x100", spar_member_set_effects(b, 0, 256));
    REFUSED(s, SPAR_ERR_ARGUMENT, "effect bits 0x4 are to be on and off",
            spar_member_set_effects(b, SPAR_EFFECT_GRAVITY | SPAR_EFFECT_WORK, SPAR_EFFECT_GRAVITY));
    REFUSED(s, SPAR_ERR_ARGUMENT, "use SPAR_FIDELITY_LINEAR", spar_member_set_effects(b, 0, SPAR_EFFECT_INERTIA | 16));
    REFUSED(s, SPAR_ERR_ARGUMENT, "rank", spar_member_set_owner(b, 1));
    REFUSED(s, SPAR_ERR_ARGUMENT, "rank", spar_member_set_owner(b, -1));
    REFUSED(s, SPAR_ERR_ARGUMENT, "unit", spar_member_set_placement(b, x, q));
    OK(s, spar_point_create(s, "point", x, NULL, &m));
    REFUSED(s, SPAR_ERR_ARGUMENT, "not a beam", spar_beam_set_damping(m, K));
    spar_session_destroy(&s);
    s = scene_session();
    still_works(s, "after");
    spar_session_destroy(&s);
}

static void test_beam_description(void **state) {
    (void)state;
    double eta[3] = {0, 0.5, 1}, xyz[9] = {0, 0, 0, 5, 0, 0, 10, 0, 0}, twist[3] = {0, NAN, 0},
           mu[6] = {0, 0, -1, 0, 0, 0}, C[36], m[36];
    double back[3] = {0, 1, 0.5}, late[2] = {0.1, 1}, same[9] = {0},
           q[16] = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0};
    double x[12] = {0, 0, 0, 1, 0, 0, 2, 0, 0, 3, 0, 0};
    spar_session *s = scene_session();
    spar_member *b;
    OK(s, spar_beam_create(s, "b", 1, 4, &b));
    REFUSED(s, SPAR_ERR_ARGUMENT, "at least 2", spar_beam_set_axis(b, 1, eta, xyz, NULL));
    REFUSED(s, SPAR_ERR_ARGUMENT, "at least 2", spar_beam_set_axis(b, -3, eta, xyz, NULL));
    REFUSED(s, SPAR_ERR_ARGUMENT, "NULL", spar_beam_set_axis(b, 3, NULL, xyz, NULL));
    REFUSED(s, SPAR_ERR_ARGUMENT, "NULL", spar_beam_set_axis(b, 3, eta, NULL, NULL));
    REFUSED(s, SPAR_ERR_ARGUMENT, "not above the previous one", spar_beam_set_axis(b, 3, back, xyz, NULL));
    REFUSED(s, SPAR_ERR_ARGUMENT, "eta 0", spar_beam_set_axis(b, 2, late, xyz, NULL));
    REFUSED(s, SPAR_ERR_ARGUMENT, "twist", spar_beam_set_axis(b, 3, eta, xyz, twist));
    REFUSED(s, SPAR_ERR_ARGUMENT, "give 4", spar_beam_set_nodes(b, 3, x, NULL));
    q[4] = 0.9;
    REFUSED(s, SPAR_ERR_ARGUMENT, "unit", spar_beam_set_nodes(b, 4, x, q));
    memcpy(C, K, sizeof C);
    C[1] = 1e6;
    REFUSED(s, SPAR_ERR_ARGUMENT, "not symmetric", spar_beam_set_sections(b, 1, eta, C, M));
    scene_diagonal(C, 1, 1, 1, 1, 0, 1);
    REFUSED(s, SPAR_ERR_ARGUMENT, "positive definite", spar_beam_set_sections(b, 1, eta, C, M));
    scene_diagonal(C, 1, 1, 1, 1, 1, 1);
    C[1] = C[6] = 1.5;
    REFUSED(s, SPAR_ERR_ARGUMENT, "positive definite", spar_beam_set_sections(b, 1, eta, C, M));
    memcpy(m, M, sizeof m);
    m[0] = m[7] = m[14] = -1;
    REFUSED(s, SPAR_ERR_ARGUMENT, "negative", spar_beam_set_sections(b, 1, eta, K, m));
    REFUSED(s, SPAR_ERR_ARGUMENT, "at least 1", spar_beam_set_sections(b, 0, eta, K, M));
    REFUSED(s, SPAR_ERR_ARGUMENT, "negative", spar_beam_set_damping(b, mu));
    REFUSED(s, SPAR_ERR_ARGUMENT, "rule", spar_beam_set_quadrature(b, 5, 3));
    REFUSED(s, SPAR_ERR_ARGUMENT, "points", spar_beam_set_quadrature(b, SPAR_QUADRATURE_LOBATTO, 1));
    REFUSED(s, SPAR_ERR_ARGUMENT, "points", spar_beam_set_quadrature(b, SPAR_QUADRATURE_GAUSS, -1));
    OK(s, spar_beam_set_axis(b, 3, eta, xyz, NULL));
    REFUSED(s, SPAR_ERR_STATE, "no sections", spar_member_commit(b));
    OK(s, spar_beam_set_sections(b, 1, eta, K, M));
    OK(s, spar_beam_set_quadrature(b, SPAR_QUADRATURE_GAUSS, 2));
    REFUSED(s, SPAR_ERR_ARGUMENT, "singular", spar_member_commit(b));
    OK(s, spar_beam_set_quadrature(b, SPAR_QUADRATURE_GAUSS, 4));
    OK(s, spar_beam_set_axis(b, 3, eta, same, NULL));
    REFUSED(s, SPAR_ERR_ARGUMENT, "coincide", spar_member_commit(b));
    OK(s, spar_beam_set_axis(b, 3, eta, xyz, NULL));
    OK(s, spar_member_commit(b));
    REFUSED(s, SPAR_ERR_STATE, "committed", spar_member_commit(b));
    REFUSED(s, SPAR_ERR_STATE, "committed", spar_beam_set_axis(b, 3, eta, xyz, NULL));
    REFUSED(s, SPAR_ERR_STATE, "committed", spar_member_set_root(b, SPAR_ROOT_FREE));
    /* sections whose x axis does not run along the line */
    double z[16] = {0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5};
    spar_member *across;
    OK(s, spar_beam_create(s, "across", 1, 4, &across));
    OK(s, spar_beam_set_nodes(across, 4, x, z));
    OK(s, spar_beam_set_sections(across, 1, eta, K, M));
    REFUSED(s, SPAR_ERR_ARGUMENT, "90 degrees", spar_member_commit(across));
    spar_session_destroy(&s);
}

static void test_use_before_commit_and_loads(void **state) {
    (void)state;
    double q[7] = {0, 0, 0, 1, 0, 0, 0}, load[6] = {0, 0, NAN, 0, 0, 0}, e[4], f[1];
    spar_session *s = scene_session();
    spar_member *b = scene_beam(s, "b", 1, 4, 10, K, M);
    REFUSED(s, SPAR_ERR_STATE, "not committed", spar_member_get_motion(b, q, NULL, NULL));
    REFUSED(s, SPAR_ERR_STATE, "not committed", spar_member_get_energy(b, 4, e));
    REFUSED(s, SPAR_ERR_STATE, "not committed", spar_member_set_load(b, 0, SPAR_LOAD_DEAD, load));
    REFUSED(s, SPAR_ERR_STATE, "not committed", spar_member_solve_static(b, 1));
    REFUSED(s, SPAR_ERR_STATE, "not committed", spar_member_solve_modes(b, 1, f, NULL));
    REFUSED(s, SPAR_ERR_STATE, "not committed", spar_step_begin(s, 0.1));
    OK(s, spar_member_commit(b));
    REFUSED(s, SPAR_ERR_ARGUMENT, "no node 4", spar_member_set_load(b, 4, SPAR_LOAD_DEAD, load));
    REFUSED(s, SPAR_ERR_ARGUMENT, "no node -1", spar_member_set_load(b, -1, SPAR_LOAD_DEAD, load));
    REFUSED(s, SPAR_ERR_ARGUMENT, "load kind 2", spar_member_set_load(b, 3, 2, load));
    REFUSED(s, SPAR_ERR_ARGUMENT, "finite", spar_member_set_load(b, 3, SPAR_LOAD_DEAD, load));
    REFUSED(s, SPAR_ERR_ARGUMENT, "NULL", spar_member_set_load(b, 3, SPAR_LOAD_DEAD, NULL));
    REFUSED(s, SPAR_ERR_STATE, "external", spar_member_set_motion(b, q, NULL, NULL));
    REFUSED(s, SPAR_ERR_STATE, "driven", spar_member_drive(b, q, NULL, NULL));
    REFUSED(s, SPAR_ERR_ARGUMENT, "modes", spar_member_solve_modes(b, 100, f, NULL));
    still_works(s, "after");
    spar_session_destroy(&s);
}

static void test_steps(void **state) {
    (void)state;
    int done;
    spar_session *s = scene_session();
    spar_member *b = scene_beam(s, "b", 1, 4, 10, K, M), *late;
    OK(s, spar_member_commit(b));
    REFUSED(s, SPAR_ERR_ARGUMENT, "dt", spar_step_begin(s, 0));
    REFUSED(s, SPAR_ERR_ARGUMENT, "dt", spar_step_begin(s, -1));
    REFUSED(s, SPAR_ERR_ARGUMENT, "dt", spar_step_begin(s, NAN));
    REFUSED(s, SPAR_ERR_ARGUMENT, "dt", spar_step_begin(s, INFINITY));
    REFUSED(s, SPAR_ERR_STATE, "begin", spar_step_solve(s));
    REFUSED(s, SPAR_ERR_STATE, "begin", spar_step_accept(s));
    REFUSED(s, SPAR_ERR_STATE, "no step is in progress to reject", spar_step_reject(s));
    REFUSED(s, SPAR_ERR_STATE, "solve", spar_step_check(s, &done));
    OK(s, spar_step_begin(s, 0.1));
    REFUSED(s, SPAR_ERR_STATE, "accept or reject", spar_step_begin(s, 0.1));
    REFUSED(s, SPAR_ERR_STATE, "solve", spar_step_check(s, &done));
    REFUSED(s, SPAR_ERR_STATE, "solve", spar_step_accept(s));
    REFUSED(s, SPAR_ERR_STATE, "step is in progress", spar_session_set_integrator(s, 1, 1));
    REFUSED(s, SPAR_ERR_STATE, "step is in progress", spar_member_solve_static(b, 1));
    OK(s, spar_step_solve(s));
    REFUSED(s, SPAR_ERR_ARGUMENT, "done", spar_step_check(s, NULL));
    OK(s, spar_step_check(s, &done));
    assert_int_equal(done, 1);
    OK(s, spar_step_accept(s));
    REFUSED(s, SPAR_ERR_STATE, "clock has started", spar_beam_create(s, "late", 1, 4, &late));
    REFUSED(s, SPAR_ERR_STATE, "clock has started", spar_member_set_initial_velocity(b, NULL, NULL, NULL));
    double t;
    int64_t step;
    OK(s, spar_session_get_time(s, &t, &step, NULL));
    NEAR(t, 0.1, 0);
    assert_int_equal(step, 1);
    spar_session_destroy(&s);
}

/* What is set is read: the defaults of spar.h, and all that setters have been given, also options as text. */
static void test_read_back(void **state) {
    (void)state;
    static const char *const option[][3] = {{"newton.budget", "100000", "7"},
                                            {"coupling.unconverged", "error", "accept"},
                                            {"coupling.unstable", "error", "accept"},
                                            {"coupling.patience", "3", "1000000"},
                                            {"coupling.norm", "motion", "loads"},
                                            {"coupling.estimate", "off", "on"},
                                            {"coupling.columns", "30", "7"},
                                            {"coupling.reuse", "5", "0"},
                                            {"coupling.filter", "0.0001", "0.12345678901234566"},
                                            {"coupling.motion_atol", "0", "1e-09"},
                                            {"coupling.motion_rtol", "0", "0.1"}};
    const double g[3] = {1, -2, 3};
    double rho, atol, rtol, omega, now[3];
    int substeps, most, order, scheme, on;
    char word[32];
    spar_session *s = NULL;
    OK(NULL, spar_session_create(&s));
    OK(s, spar_session_get_integrator(s, &rho, &substeps));
    assert_true(rho == 0.9 && substeps == 1);
    OK(s, spar_session_get_newton(s, &atol, &rtol, &most));
    assert_true(atol == 1e-15 && rtol == 1e-8 && most == 50);
    OK(s, spar_session_get_coupling(s, &scheme, &atol, &rtol, &most));
    assert_true(scheme == SPAR_COUPLING_IQN_ILS && atol == 1e-9 && rtol == 1e-6 && most == 50);
    OK(s, spar_session_get_relaxation(s, &omega));
    OK(s, spar_session_get_predictor(s, &order));
    OK(s, spar_session_get_reproducible(s, &on));
    assert_true(omega == 1 && order == 1 && on == 0);
    OK(s, spar_session_set_gravity(s, g));
    OK(s, spar_session_set_integrator(s, 0.25, 3));
    OK(s, spar_session_set_newton(s, 1e-3, 1e-4, 5));
    OK(s, spar_session_set_predictor(s, 2));
    OK(s, spar_session_set_coupling(s, SPAR_COUPLING_AITKEN, 1e-5, 1e-7, 9));
    OK(s, spar_session_set_relaxation(s, 0.3));
    OK(s, spar_session_set_reproducible(s, 7));
    OK(s, spar_session_get_gravity(s, now));
    OK(s, spar_session_get_integrator(s, &rho, &substeps));
    assert_true(memcmp(g, now, sizeof g) == 0 && rho == 0.25 && substeps == 3);
    OK(s, spar_session_get_newton(s, &atol, &rtol, &most));
    assert_true(atol == 1e-3 && rtol == 1e-4 && most == 5);
    OK(s, spar_session_get_coupling(s, &scheme, NULL, &rtol, NULL));
    assert_true(scheme == SPAR_COUPLING_AITKEN && rtol == 1e-7);
    OK(s, spar_session_get_relaxation(s, &omega));
    OK(s, spar_session_get_predictor(s, &order));
    OK(s, spar_session_get_reproducible(s, &on));
    assert_true(omega == 0.3 && order == 2 && on == 1);
    for (size_t i = 0; i < sizeof option / sizeof *option; i++) {
        OK(s, spar_session_get_option(s, option[i][0], sizeof word, word));
        assert_string_equal(word, option[i][1]);
        OK(s, spar_session_set_option(s, option[i][0], option[i][2]));
        OK(s, spar_session_get_option(s, option[i][0], (int64_t)strlen(option[i][2]) + 1, word));
        assert_string_equal(word, option[i][2]);
    }
    REFUSED(s, SPAR_ERR_ARGUMENT, "needs 6 characters; the buffer has 5",
            spar_session_get_option(s, "coupling.norm", 5, word));
    REFUSED(s, SPAR_ERR_ARGUMENT, "no option", spar_session_get_option(s, "far", 32, word));
    REFUSED(s, SPAR_ERR_ARGUMENT, "give motion or loads", spar_session_set_option(s, "coupling.norm", "red"));
    assert_int_equal(spar_session_get_newton(NULL, NULL, NULL, NULL), SPAR_ERR_ARGUMENT);
    spar_session_destroy(&s);
}

/* The same of members and fluids; effects and quadrature are those in force. */
static void test_read_members(void **state) {
    (void)state;
    const double place[3] = {1, 2, 3}, q[4] = {0.6, 0, 0.8, 0}, mu[6] = {1e-3, 2e-3, 3e-3, 4e-3, 5e-3, 6e-3};
    static const char *const option[][3] = {{"theta", "average", "group"},
                                            {"far", "take", "refuse"},
                                            {"audit", "on", "off"},
                                            {"velocity", "pulled", "own"}};
    double C[36], J[36], x[3], r[4], found[6], far;
    char word[32];
    int kind, on, rank, elements, nodes, rule, points, effects, method;
    int64_t modes;
    scene_diagonal(C, 1, 1, 1, 1, 1, 1);
    scene_diagonal(J, 1, 1, 1, 1, 1, 1);
    spar_session *s = scene_session();
    spar_member *b = scene_beam(s, "beam", 3, 4, 1, C, J);
    spar_fluid *f;
    OK(s, spar_beam_get_elements(b, &elements, &nodes));
    OK(s, spar_beam_get_quadrature(b, &rule, &points));
    OK(s, spar_member_get_root(b, &kind));
    assert_true(elements == 3 && nodes == 4 && rule == SPAR_QUADRATURE_GAUSS && points == 0);
    assert_int_equal(kind, SPAR_ROOT_FIXED);
    REFUSED(s, SPAR_ERR_STATE, "not committed", spar_member_get_effects(b, &effects));
    OK(s, spar_beam_set_quadrature(b, SPAR_QUADRATURE_LOBATTO, 6));
    OK(s, spar_beam_set_damping(b, mu));
    OK(s, spar_member_set_placement(b, place, q));
    OK(s, spar_member_set_root(b, SPAR_ROOT_DRIVEN));
    OK(s, spar_member_set_fidelity(b, SPAR_FIDELITY_MODAL, 5));
    OK(s,
       spar_member_set_effects(b, EFFECTS_ONLY(SPAR_EFFECT_INERTIA | SPAR_EFFECT_DAMPING | SPAR_EFFECT_FLUID_MOMENT)));
    OK(s, spar_member_commit(b));
    OK(s, spar_beam_get_quadrature(b, &rule, &points));
    OK(s, spar_beam_get_damping(b, found));
    OK(s, spar_member_get_placement(b, x, r));
    assert_true(rule == SPAR_QUADRATURE_LOBATTO && points == 6 && memcmp(found, mu, sizeof mu) == 0);
    assert_true(memcmp(x, place, sizeof x) == 0 && fabs(r[0] - 0.6) < 1e-15 && fabs(r[2] - 0.8) < 1e-15);
    OK(s, spar_member_get_root(b, &kind));
    assert_int_equal(kind, SPAR_ROOT_DRIVEN);
    OK(s, spar_member_get_fidelity(b, &kind, &modes));
    OK(s, spar_member_get_external(b, &on));
    OK(s, spar_member_get_owner(b, &rank));
    OK(s, spar_member_get_effects(b, &effects));
    assert_true(kind == SPAR_FIDELITY_MODAL && modes == 5 && on == 0 && rank == 0);
    assert_int_equal(effects, SPAR_EFFECT_INERTIA | SPAR_EFFECT_DAMPING | SPAR_EFFECT_FLUID_MOMENT);
    OK(s, spar_fluid_create(b, "air", &f));
    OK(s, spar_fluid_get_projection(f, &method, &far));
    OK(s, spar_fluid_get_interpolation(f, &kind));
    assert_true(method == SPAR_PROJECT_BOUNDED && far <= 0 && kind == SPAR_INTERPOLATE_NODAL);
    for (size_t i = 0; i < sizeof option / sizeof *option; i++) {
        OK(s, spar_fluid_get_option(f, option[i][0], sizeof word, word));
        assert_string_equal(word, option[i][1]);
        OK(s, spar_fluid_set_option(f, option[i][0], option[i][2]));
        OK(s, spar_fluid_get_option(f, option[i][0], (int64_t)strlen(option[i][2]) + 1, word));
        assert_string_equal(word, option[i][2]);
    }
    REFUSED(s, SPAR_ERR_ARGUMENT, "needs 7 characters; the buffer has 6", spar_fluid_get_option(f, "far", 6, word));
    REFUSED(s, SPAR_ERR_ARGUMENT, "no option 'fluid.far'; give one of theta, far, audit, velocity, ramp, ramp.start",
            spar_fluid_get_option(f, "fluid.far", 32, word));
    REFUSED(s, SPAR_ERR_ARGUMENT, "no option", spar_fluid_set_option(f, "fluid.far", "take"));
    REFUSED(s, SPAR_ERR_ARGUMENT,
            "fluid 'air' of member 'beam': option 'theta' does not accept 'red'; give average or group",
            spar_fluid_set_option(f, "theta", "red"));
    REFUSED(s, SPAR_ERR_ARGUMENT, "NULL", spar_fluid_set_option(f, "theta", NULL));
    REFUSED(s, SPAR_ERR_ARGUMENT, "NULL", spar_fluid_get_option(f, "theta", 32, NULL));
    REFUSED(s, SPAR_ERR_ARGUMENT, "no option", spar_session_set_option(s, "fluid.theta", "group"));
    OK(s, spar_step_begin(s, 0.1));
    REFUSED(s, SPAR_ERR_STATE, "in progress", spar_fluid_set_option(f, "theta", "average"));
    OK(s, spar_step_reject(s));
    OK(s, spar_fluid_get_option(f, "theta", sizeof word, word));
    assert_string_equal(word, "group");
    OK(s, spar_fluid_set_projection(f, SPAR_PROJECT_RPOLY, 0.25));
    OK(s, spar_fluid_set_interpolation(f, SPAR_INTERPOLATE_CONSISTENT));
    OK(s, spar_fluid_get_projection(f, &method, &far));
    OK(s, spar_fluid_get_interpolation(f, &kind));
    assert_true(method == SPAR_PROJECT_RPOLY && far == 0.25 && kind == SPAR_INTERPOLATE_CONSISTENT);
    spar_session_destroy(&s);
}

/* What a layer above a session goes by: from a fluid to its member and session, their names, where a step stands, sums;
   and a fluid that has failed. The step cannot be checked until loads are pushed, and tells what failed. */
static void test_layers_above(void **state) {
    (void)state;
    const double tip[3] = {1, 0, 0}, force[3] = {0, 1, 0};
    double x[2] = {1.5, -2};
    int phase = -1, done;
    spar_session *s = scene_session(), *found = NULL;
    spar_member *b = scene_beam(s, "beam", 1, 4, 1, K, M), *member = NULL;
    spar_fluid *f;
    OK(s, spar_member_get_session(b, &found));
    assert_ptr_equal(found, s);
    assert_string_equal(spar_member_get_name(b), "beam");
    OK(s, spar_member_commit(b));
    OK(s, spar_fluid_create(b, "air", &f));
    OK(s, spar_fluid_get_member(f, &member));
    assert_ptr_equal(member, b);
    assert_string_equal(spar_fluid_get_name(f), "air");
    assert_true(spar_member_get_name(NULL)[0] == '\0' && spar_fluid_get_name(NULL)[0] == '\0');
    REFUSED(s, SPAR_ERR_ARGUMENT, "pointer to the member", spar_fluid_get_member(f, NULL));
    REFUSED(s, SPAR_ERR_ARGUMENT, "pointer to the session", spar_member_get_session(b, NULL));

    OK(s, spar_session_sum(s, SPAR_OK, 2, x)); /* of one rank */
    OK(s, spar_session_sum(s, SPAR_OK, 0, NULL));
    assert_true(x[0] == 1.5 && x[1] == -2);
    for (int status = SPAR_ERR_ARGUMENT; status <= SPAR_ERR_LIMIT; status++) { /* each can be handed on */
        assert_int_equal(spar_session_sum(s, status, 2, x), status);
        assert_true(x[0] == 1.5 && x[1] == -2);
    }
    REFUSED(s, SPAR_ERR_ARGUMENT, "status is 12", spar_session_sum(s, SPAR_ERR_LIMIT + 1, 0, NULL));
    REFUSED(s, SPAR_ERR_ARGUMENT, "status is -1", spar_session_sum(s, -1, 0, NULL));
    REFUSED(s, SPAR_ERR_ARGUMENT, "NULL", spar_session_sum(s, SPAR_OK, 2, NULL));
    REFUSED(s, SPAR_ERR_ARGUMENT, "status is 99", spar_session_sum(s, 99, 0, NULL));
    REFUSED(s, SPAR_ERR_ARGUMENT, "-1 numbers", spar_session_sum(s, SPAR_OK, -1, x));

    OK(s, spar_fluid_set_force_nodes(f, 1, tip));
    OK(s, spar_fluid_map(f));
    REFUSED(s, SPAR_ERR_ARGUMENT, "give a SPAR_ERR_", spar_fluid_fail(f, SPAR_OK, "all is well"));
    REFUSED(s, SPAR_ERR_ARGUMENT, "describes the failure", spar_fluid_fail(f, SPAR_ERR_USER, ""));
    OK(s, spar_session_get_phase(s, &phase));
    assert_int_equal(phase, SPAR_PHASE_START);
    REFUSED(s, SPAR_ERR_ARGUMENT, "give a SPAR_ERR_", spar_fluid_fail(f, SPAR_ERR_LIMIT + 1, "no such status"));
    for (int status = SPAR_ERR_ARGUMENT; status <= SPAR_ERR_LIMIT; status++) {
        OK(s, spar_fluid_fail(f, status, "no mesh"));
        REFUSED(s, status, "no mesh", spar_step_begin(s, 0.01));
    }
    OK(s, spar_fluid_push_forces(f, force, NULL));
    OK(s, spar_step_begin(s, 0.01));
    OK(s, spar_session_get_phase(s, &phase));
    assert_int_equal(phase, SPAR_PHASE_BEGUN);
    OK(s, spar_step_solve(s));
    OK(s, spar_session_get_phase(s, &phase));
    assert_int_equal(phase, SPAR_PHASE_SOLVED);
    OK(s, spar_fluid_fail(f, SPAR_ERR_NUMERIC, "the pressure diverges"));
    REFUSED(s, SPAR_ERR_NUMERIC, "the pressure diverges", spar_step_check(s, &done));
    OK(s, spar_fluid_push_forces(f, force, NULL));
    OK(s, spar_step_check(s, &done));
    OK(s, spar_session_get_phase(s, &phase));
    assert_int_equal(phase, SPAR_PHASE_CHECKED);
    OK(s, spar_step_accept(s));
    OK(s, spar_session_get_phase(s, &phase));
    assert_int_equal(phase, SPAR_PHASE_BETWEEN);
    OK(s, spar_fluid_fail(f, SPAR_ERR_USER, "nobody waits")); /* between steps */
    OK(s, spar_step_begin(s, 0.01));
    OK(s, spar_step_reject(s));
    spar_session_destroy(&s);
}

/* Counts that no memory holds: three times n, or its bytes, would pass 2^63. */
static void test_counts_beyond_memory(void **state) {
    (void)state;
    const double x[6] = {0, 0, 0, 1, 0, 0}, eta[2] = {0, 1};
    double out[6];
    static const int64_t huge[] = {INT64_MAX, INT64_MAX / 3 + 1, (INT64_C(1) << 62) / 3 * 2 + 1, INT64_C(1) << 61,
                                   (INT64_C(1) << 40) + 1};
    spar_session *s = scene_session();
    spar_member *open = scene_beam(s, "open", 1, 2, 1, K, M), *b = scene_beam(s, "b", 1, 2, 1, K, M);
    spar_fluid *f = NULL;
    OK(s, spar_member_commit(b));
    OK(s, spar_fluid_create(b, "f", &f));
    for (size_t k = 0; k < sizeof huge / sizeof *huge; k++) {
        int64_t n = huge[k];
        assert_int_equal(spar_fluid_set_motion_nodes(f, n, x), SPAR_ERR_ARGUMENT);
        assert_int_equal(spar_fluid_set_force_nodes(f, n, x), SPAR_ERR_ARGUMENT);
        assert_int_equal(spar_fluid_set_stations(f, n, eta, NULL), SPAR_ERR_ARGUMENT);
        assert_int_equal(spar_beam_set_axis(open, n, eta, x, NULL), SPAR_ERR_ARGUMENT);
        assert_int_equal(spar_beam_set_nodes(open, n, x, NULL), SPAR_ERR_ARGUMENT);
        assert_int_equal(spar_beam_set_sections(open, n, eta, K, M), SPAR_ERR_ARGUMENT);
        assert_int_equal(spar_beam_set_line_load(b, SPAR_LOAD_DEAD, n, eta, x), SPAR_ERR_ARGUMENT);
        assert_int_equal(spar_beam_evaluate(b, n, eta, out, NULL, NULL, NULL), SPAR_ERR_ARGUMENT);
        assert_int_equal(spar_member_solve_modes(b, n, out, NULL), SPAR_ERR_ARGUMENT);
    }
    spar_session_destroy(&s);
}

/* Numbers near the largest: a status, and the state as it was, for every fidelity and for what a root is driven with.
 */
static void test_loads_beyond_numbers(void **state) {
    (void)state;
    const double huge[6] = {0, 1e200, 0, 0, 0, 1e200}, heavy[3] = {0, 0, -1e200}, none[6] = {0}, no_g[3] = {0};
    for (int fidelity = SPAR_FIDELITY_PRESCRIBED; fidelity <= SPAR_FIDELITY_EXACT; fidelity++) {
        double tip[7], after[7];
        spar_session *s = scene_session();
        spar_member *b = scene_beam(s, "beam", 1, 4, 10, K, M);
        OK(s, spar_member_set_root(b, SPAR_ROOT_DRIVEN));
        OK(s, spar_member_set_fidelity(b, fidelity, 5));
        OK(s, spar_member_commit(b));
        scene_run(s, 0.1, 2);
        scene_tip(b, tip);
        int elastic = fidelity >= SPAR_FIDELITY_LINEAR;
        for (int k = 0; k < 3; k++) {
            const double q[7] = {0, 0, 0, 1, 0, 0, 0}, fast[6] = {0, 0, 0, 1e200, 0, 1e200};
            OK(s, k == 0   ? spar_member_set_load(b, 3, SPAR_LOAD_DEAD, huge)
                  : k == 1 ? spar_session_set_gravity(s, heavy)
                           : spar_member_drive(b, q, fast, NULL));
            int status = spar_step(s, 0.1, NULL, NULL, NULL);
            int bears = fidelity == SPAR_FIDELITY_PRESCRIBED || (fidelity == SPAR_FIDELITY_RIGID && k == 0);
            assert_int_equal(status, k < 2 && bears ? SPAR_OK : SPAR_ERR_NUMERIC);
            if (elastic && k < 2) {
                assert_int_equal(spar_member_solve_static(b, 1), SPAR_ERR_NUMERIC);
                assert_non_null(strstr(spar_session_message(s), "'beam'"));
            }
            scene_tip(b, after);
            assert_memory_equal(tip, after, sizeof tip);
            OK(s, spar_member_set_load(b, 3, SPAR_LOAD_DEAD, none));
            OK(s, spar_session_set_gravity(s, no_g));
            OK(s, spar_member_drive(b, q, NULL, NULL));
            scene_run(s, 0.1, 1);
            scene_tip(b, tip);
        }
        spar_session_destroy(&s);
    }
}

static void test_velocities_beyond_numbers(void **state) {
    (void)state;
    const double wild[3] = {0, 0, 1e200};
    double v[24];
    spar_session *s = scene_session();
    spar_member *b = scene_beam(s, "beam", 1, 4, 10, K, M), *late = scene_beam(s, "late", 1, 4, 10, K, M);
    OK(s, spar_member_commit(b));
    assert_int_equal(spar_member_set_initial_velocity(b, NULL, NULL, wild), SPAR_ERR_ARGUMENT);
    OK(s, spar_member_get_motion(b, NULL, v, NULL));
    for (int i = 0; i < 24; i++) {
        assert_true(v[i] == 0);
    }
    OK(s, spar_member_set_initial_velocity(late, NULL, NULL, wild));
    assert_int_equal(spar_member_commit(late), SPAR_ERR_ARGUMENT);
    spar_session_destroy(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_read_back),
        cmocka_unit_test(test_read_members),
        cmocka_unit_test(test_layers_above),
        cmocka_unit_test(test_null_handles),
        cmocka_unit_test(test_impossible_inertia),
        cmocka_unit_test(test_session_settings),
        cmocka_unit_test(test_members),
        cmocka_unit_test(test_beam_description),
        cmocka_unit_test(test_use_before_commit_and_loads),
        cmocka_unit_test(test_steps),
        cmocka_unit_test(test_counts_beyond_memory),
        cmocka_unit_test(test_loads_beyond_numbers),
        cmocka_unit_test(test_velocities_beyond_numbers),
    };
    scene_box(K, M);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
