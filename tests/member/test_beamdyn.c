/* Blades read from BeamDyn's files. */
#include "scene.h"

#include "member/beam.h"
#include "member/structure.h"

#include <stdio.h>
#include <unistd.h>

#define DATA SPAR_SOURCE_DIR "/tests/data/"

/* The 45-degree bend by three key points, tip force 600: the converged answer published with BeamDyn and Kynema-FMB,
   (-23.6459716009, 13.7208006041, 53.5776450627) along, across and up, which belongs to the parabola through the points
   (a circle differs by 0.1). 14 nodes: 1e-8. */
static void test_bend(void **state) {
    (void)state;
    double q[7], load[6] = {0, 0, 600, 0, 0, 0};
    spar_session *s = scene_session();
    spar_member *b = NULL;
    OK(s, spar_beam_create(s, "b", 1, 14, &b));
    OK(s, spar_beam_read_beamdyn(b, DATA "bend_primary.inp", NULL));
    OK(s, spar_member_commit(b));
    OK(s, spar_member_set_load(b, 13, SPAR_LOAD_DEAD, load));
    OK(s, spar_member_solve_static(b, 2));
    scene_tip(b, q);
    NEAR(q[0], -23.6459716009, 1e-8);
    NEAR(q[1], 13.7208006041, 1e-8);
    NEAR(q[2], 53.5776450627, 1e-8);
    spar_session_destroy(&s);
}

/* Entry by entry: (axial, shear y, shear z, torsion, bending y, bending z) are BeamDyn's (z, x, y) of both triples. */
static void test_frame(void **state) {
    (void)state;
    const double K[36] = {103, 2, 6, 12,  10, 11, 2,  101, 1, 5,  3,   4,  6,  1, 102, 9,  7,  8,
                          12,  5, 9, 206, 14, 15, 10, 3,   7, 14, 204, 13, 11, 4, 8,   15, 13, 205};
    const double mu[6] = {3e-3, 1e-3, 2e-3, 6e-3, 4e-3, 5e-3}, degree = 3.14159265358979323846 / 180;
    double x[3 * 8], q[4 * 8], m, c[3], J[6];
    spar_session *s = scene_session();
    spar_member *b = NULL;
    OK(s, spar_beam_create(s, "b", 2, 4, &b));
    OK(s, spar_beam_read_beamdyn(b, DATA "blade_primary.inp", DATA "blade_blade.inp"));
    assert_int_equal(b->beam->section_count, 2);
    for (int i = 0; i < 72; i++) {
        assert_true(b->beam->stiffness[i] == K[i % 36]);
    }
    for (int i = 0; i < 6; i++) {
        assert_true(b->beam->mu[i] == mu[i]);
    }
    assert_null(spari_mass_split(b->beam->mass, &m, c, J)); /* centre of mass 3 along x, 2 along y of BeamDyn */
    NEAR(m, 30, 0);
    NEAR(c[0], 0, 0);
    NEAR(c[1], 3, 1e-14);
    NEAR(c[2], 2, 1e-14);
    OK(s, spar_member_commit(b));
    OK(s, spar_member_get_reference(b, x, q));
    for (int i = 0; i < 8; i++) { /* twist 12 degrees to mid-span, then linear to 0, about minus the tangent */
        double eta = x[3 * i] / 8, twist = -degree * 12 * fmin(1, 2 * (1 - eta));
        NEAR(x[3 * i + 1], 0, 1e-12);
        NEAR(q[4 * i], cos(0.5 * twist), 1e-12);
        NEAR(q[4 * i + 1], sin(0.5 * twist), 1e-12);
    }
    NEAR(x[21], 8, 1e-12);
    spar_session_destroy(&s);
}

/* A copy of the file of which one piece is replaced; the file is cut where `with` is NULL. */
static void spoil(const char *from, const char *to, const char *what, const char *with) {
    char text[8192];
    FILE *f = fopen(from, "r");
    assert_non_null(f);
    size_t n = fread(text, 1, sizeof text - 1, f);
    fclose(f);
    text[n] = 0;
    char *at = strstr(text, what);
    assert_non_null(at);
    f = fopen(to, "w");
    assert_non_null(f);
    fwrite(text, 1, (size_t)(at - text), f);
    if (with) {
        fputs(with, f);
        fputs(at + strlen(what), f);
    }
    fclose(f);
}

/* Every error names file, line and field; the beam stays as it was. */
static void test_errors(void **state) {
    (void)state;
    const struct {
        int primary; /* which file is spoilt */
        const char *what, *with, *says[2];
        int status;
    } cases[] = {
        {1, "    -7.61205", "    -7.6x205", {"line 15", "kp_xr"}, SPAR_ERR_IO},
        {1, "38.2683        0.0", "38.2683", {"line 15", "number 4"}, SPAR_ERR_IO},
        {1, "38.2683", "98.2683", {"line 16", "kp_zr"}, SPAR_ERR_IO},
        {1, "3   kp_total", "4   kp_total", {"line 11", "kp_total"}, SPAR_ERR_IO},
        {1, "1   member_total", "1.5   member_total", {"line 9", "member_total"}, SPAR_ERR_IO},
        {1, "   -29.2893d0", NULL, {"ends at line 1", "key point"}, SPAR_ERR_IO},
        {1, "-7.61205 ", "-1e300 ", {"finite length", "key points"}, SPAR_ERR_ARGUMENT},
        {1, "BldFile", "NoFile", {"BldFile", "missing"}, SPAR_ERR_IO},
        {0, "0   damp_type", "3   damp_type", {"line 5", "damp_type"}, SPAR_ERR_UNSUPPORTED},
        {0, "0   damp_type", "2   damp_type", {"ends at line 39", "n_modes"}, SPAR_ERR_IO},
        {0, "0   damp_type", "2   damp_type\n3 n_modes - n\n0.01 0.02", {"line 7", "number 3 of 3"}, SPAR_ERR_IO},
        {0, "0   damp_type", "2   damp_type\n2 n_modes - n\n0.01 2.0", {"line 7", "mode 2 is 2"}, SPAR_ERR_IO},
        {0, "1.0E-3", "nan", {"line 9", "mu1"}, SPAR_ERR_IO},
        {0, "1.0E-3", "-1", {"line 9", "mu1"}, SPAR_ERR_IO},
        {0, "  1.000000\n", "  0.0\n", {"line 26", "station 2 of 2 is at 0;"}, SPAR_ERR_IO},
        {0, "  0.000000\n", "  0.1\n", {"line 11", "station 1 of 2 is at 0.1;"}, SPAR_ERR_IO},
        {0, "  1.000000\n", "  0.5\n", {"line 26", "station 2 of 2 is at 0.5;"}, SPAR_ERR_IO},
        {0, "2   station_total", "1   station_total", {"line 4", "station_total is 1"}, SPAR_ERR_IO},
        {1,
         "   -29.2893d0     0.0       70.7107        0.0\n",
         "   -29.2893d0     0.0       70.7107        0.0\n -30 0 80 0\n",
         {"line 17", "kp_total is 3"},
         SPAR_ERR_IO},
        {0, " ------- BEAM", "\xff\xfe----BEAM", {"line 1", "UTF-16"}, SPAR_ERR_IO},
        {0,
         " ------- BEAM",
         "version https://git-lfs.github.com/spec/v1\noid",
         {"line 1", "git lfs pull"},
         SPAR_ERR_IO},
        {0, "0.0833 0 0", "0.0833 0", {"line 22", "mass matrix"}, SPAR_ERR_IO},
        {0, "8.333E5   0 0", "-8.333E5   0 0", {"line 11", "stiffness"}, SPAR_ERR_ARGUMENT},
        {0, "   1 0 0 0 0 0", "   2 0 0 0 0 0", {"line 11", "mass"}, SPAR_ERR_ARGUMENT},
    };
    char bad[64];
    snprintf(bad, sizeof bad, "beamdyn_bad_%d.inp", (int)getpid());
    spar_session *s = scene_session();
    double K[36];
    scene_diagonal(K, 1, 2, 3, 4, 5, 6);
    spar_member *b = scene_beam(s, "b", 1, 5, 2, K, NULL);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        spoil(cases[i].primary ? DATA "bend_primary.inp" : DATA "bend_blade.inp", bad, cases[i].what, cases[i].with);
        int status = cases[i].primary ? spar_beam_read_beamdyn(b, bad, DATA "bend_blade.inp")
                                      : spar_beam_read_beamdyn(b, DATA "bend_primary.inp", bad);
        const char *message = spar_session_message(s);
        if (status != cases[i].status || !strstr(message, cases[i].says[0]) || !strstr(message, cases[i].says[1]) ||
            !strstr(message, bad)) {
            fail_msg("case %d: status %d, message: %s", (int)i, status, message);
        }
        assert_true(b->beam->axis_count == 2 && b->beam->section_count == 1 && b->beam->stiffness[7] == 2);
    }
    remove(bad);
    assert_int_equal(spar_beam_read_beamdyn(b, DATA "blade_primary.inp", NULL), SPAR_ERR_IO);
    assert_non_null(strstr(spar_session_message(s), DATA "nowhere.inp"));
    assert_int_equal(spar_beam_read_beamdyn(b, NULL, NULL), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_beam_read_beamdyn(NULL, "x", NULL), SPAR_ERR_ARGUMENT);
    OK(s, spar_member_commit(b));
    assert_int_equal(spar_beam_read_beamdyn(b, DATA "bend_primary.inp", NULL), SPAR_ERR_STATE);
    spar_session_destroy(&s);
}

/* What was read comes back by the getters, in spar's order; n says how much room it needs. Three stations that
   station_total promises two of are refused: the rest of the blade would be lost without a word. */
static void test_getters(void **state) {
    (void)state;
    double eta[2], K[72], M[72], along[801], x[3 * 801], twist[801];
    int64_t n, points;
    spar_session *s = scene_session();
    spar_member *b = NULL;
    OK(s, spar_beam_create(s, "b", 2, 4, &b));
    OK(s, spar_beam_get_axis(b, &n, 0, NULL, NULL, NULL));
    assert_int_equal(n, 0);
    OK(s, spar_beam_get_sections(b, &n, 0, NULL, NULL, NULL));
    assert_int_equal(n, 0);
    OK(s, spar_beam_read_beamdyn(b, DATA "blade_primary.inp", DATA "blade_blade.inp"));
    OK(s, spar_beam_get_sections(b, &n, 2, eta, K, M));
    assert_int_equal(n, 2);
    assert_true(eta[0] == 0 && eta[1] == 1 && K[0] == 103 && K[36 + 7] == 101 && K[1] == 2 && M[0] == 30 && M[4] == 60);
    OK(s, spar_beam_get_axis(b, &points, 801, along, x, twist));
    assert_true(points > 10 && points <= 801 && along[0] == 0 && along[points - 1] == 1);
    NEAR(x[3 * (points - 1)], 8, 1e-12);
    NEAR(twist[0], -12 * 3.14159265358979323846 / 180, 1e-15);
    K[0] = 7;
    OK(s, spar_beam_get_sections(b, NULL, 0, NULL, K, NULL)); /* no room: nothing is written */
    assert_true(K[0] == 7);
    assert_int_equal(spar_beam_get_axis(b, &n, -1, NULL, NULL, NULL), SPAR_ERR_ARGUMENT);
    spar_session_destroy(&s);
}

/* Lines that end with CR alone, and a mark of UTF-8 before the first, are the same file; a byte 0 is not read over.
   Ratios of modes are told, not put in force. */
static void test_texts(void **state) {
    (void)state;
    char name[64], text[8192];
    double mu[6];
    snprintf(name, sizeof name, "beamdyn_text_%d.inp", (int)getpid());
    spoil(DATA "bend_blade.inp", name, " 0   damp_type", " 2   damp_type\n2 n_modes - n\n0.01, 0.02 zeta - r\n - old");
    for (int kind = 0; kind < 3; kind++) {
        spar_session *s = scene_session();
        spar_member *b = NULL;
        FILE *f = fopen(name, "r");
        assert_non_null(f);
        size_t n = fread(text, 1, sizeof text, f);
        fclose(f);
        f = fopen(name, "w");
        fputs(kind == 1 ? "\xef\xbb\xbf" : "", f);
        for (size_t i = 0; i < n; i++) {
            fputc(kind == 1 && text[i] == '\n' ? '\r' : kind == 2 && i == 10 ? 0 : text[i], f);
        }
        fclose(f);
        OK(s, spar_beam_create(s, "b", 1, 5, &b));
        int status = spar_beam_read_beamdyn(b, DATA "bend_primary.inp", name);
        if (kind == 2) {
            assert_int_equal(status, SPAR_ERR_IO);
            assert_non_null(strstr(spar_session_message(s), "line 1: the file is UTF-16 or no text"));
        } else {
            OK(s, status);
            assert_int_equal(b->beam->section_count, 2);
            OK(s, spar_beam_get_damping(b, mu));
            assert_true(mu[0] == 0 && strstr(spar_session_get_warning(s, 0), "damping ratios of 2 modes"));
        }
        spar_session_destroy(&s);
    }
    remove(name);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_bend),    cmocka_unit_test(test_frame), cmocka_unit_test(test_errors),
        cmocka_unit_test(test_getters), cmocka_unit_test(test_texts),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
