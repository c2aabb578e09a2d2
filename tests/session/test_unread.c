/* A host that ignores statuses: failures that it has not read stay in the next message, or go to its log; nodes that
   are not mapped end the step. */
#include "scene.h"

#include <stdio.h>
#include <unistd.h>

static void set_up(spar_session *s, spar_member **mast) {
    double K[36], M[36];
    const double eta = 0;
    scene_box(K, M);
    OK(s, spar_beam_create(s, "mast", 1, 6, mast));
    OK(s, spar_beam_set_sections(*mast, 1, &eta, K, M));
}

static int says(const spar_session *s, const char *text) {
    return strstr(spar_session_message(s), text) != NULL;
}

/* eta in metres: the axis is refused, then the commit for want of it, then the step. Each message ends with the first;
   once it has been read, the next one stands alone. */
static void the_first_failure_stays(void **state) {
    (void)state;
    const double eta[2] = {0, 10}, axis[6] = {0, 0, 0, 0, 0, 10};
    for (int read = 0; read < 2; read++) {
        spar_session *s = scene_session();
        spar_member *mast = NULL;
        set_up(s, &mast);
        assert_int_equal(spar_beam_set_axis(mast, 2, eta, axis, NULL), SPAR_ERR_ARGUMENT);
        if (read) {
            assert_true(says(s, "spar_beam_set_axis"));
        }
        assert_int_equal(spar_member_commit(mast), SPAR_ERR_STATE);
        assert_int_equal(spar_step_begin(s, 0.1), SPAR_ERR_STATE);
        assert_int_equal(strstr(spar_session_message(s), "; an earlier failure: spar_beam_set_axis: ") != NULL, !read);
        assert_int_equal(spar_step_begin(s, 0.1), SPAR_ERR_STATE);
        assert_false(says(s, "an earlier failure"));
        spar_session_destroy(&s);
    }
}

/* Calls without a session: a section of impossible walls, and what is made of it. */
static void a_section_counts_too(void **state) {
    (void)state;
    const double wall[2] = {0.1, 0.2}, eta = 0;
    double property[SPAR_SECTION_COUNT] = {0}, K[36] = {0}, M[36] = {0};
    spar_session *s = scene_session();
    spar_member *mast = NULL;
    set_up(s, &mast);
    (void)spar_session_message(NULL);
    assert_int_not_equal(
        spar_section_from_shape(SPAR_SHAPE_TUBE, 2, wall, 70e9, 0.3, 2700, SPAR_SECTION_COUNT, property), SPAR_OK);
    assert_int_not_equal(spar_beam_set_sections(mast, 1, &eta, K, M), SPAR_OK);
    assert_true(says(s, "; an earlier failure: spar_section_from_shape"));
    assert_int_not_equal(spar_beam_set_sections(mast, 1, &eta, K, M), SPAR_OK);
    assert_false(says(s, "an earlier failure"));
    spar_session_destroy(&s);
}

/* With a log all failures have been told. It writes errors and warnings, each on a line. */
static void a_log_has_told(void **state) {
    (void)state;
    const double eta[2] = {0, 10}, axis[6] = {0, 0, 0, 0, 0, 10};
    spar_session *s = scene_session();
    spar_member *mast = NULL;
    char text[4096] = "";
    set_up(s, &mast);
    OK(s, spar_session_set_log(s, spar_log_stderr, NULL));
    FILE *file = tmpfile();
    assert_non_null(file);
    (void)fflush(stderr);
    const int before = dup(2);
    (void)dup2(fileno(file), 2);
    const int first = spar_beam_set_axis(mast, 2, eta, axis, NULL), second = spar_member_commit(mast);
    spar_log_stderr(s, SPAR_LOG_WARNING, "a warning", NULL);
    spar_log_stderr(s, SPAR_LOG_INFO, "not written", NULL);
    (void)fflush(stderr);
    (void)dup2(before, 2);
    (void)close(before);
    rewind(file);
    (void)fread(text, 1, sizeof text - 1, file);
    (void)fclose(file);
    assert_int_equal(first, SPAR_ERR_ARGUMENT);
    assert_int_equal(second, SPAR_ERR_STATE);
    assert_false(says(s, "an earlier failure"));
    assert_ptr_equal(strstr(text, "spar: error: spar_beam_set_axis: "), text);
    assert_non_null(strstr(text, "\nspar: error: member 'mast' has no axis"));
    assert_non_null(strstr(text, "\nspar: warning: a warning\n"));
    assert_null(strstr(text, "not written"));
    spar_session_destroy(&s);
}

/* Nodes that are set and not mapped: the step does not begin. A push on them is refused, and so is the step until the
   loads are pushed again. No nodes need no map. */
static void what_is_not_mapped_is_refused(void **state) {
    (void)state;
    const double x[3] = {0.5, 0, 0}, f[3] = {0, 1, 0};
    double K[36], M[36];
    spar_session *s = scene_session();
    scene_box(K, M);
    spar_member *mast = scene_beam(s, "mast", 1, 6, 1, K, M);
    spar_fluid *wind = NULL, *none = NULL;
    OK(s, spar_member_commit(mast));
    OK(s, spar_fluid_create(mast, "none", &none));
    OK(s, spar_fluid_set_motion_nodes(none, 0, NULL));
    OK(s, spar_fluid_create(mast, "wind", &wind));
    OK(s, spar_fluid_set_motion_nodes(wind, 1, x));
    REFUSED(s, SPAR_ERR_STATE, "the motion nodes are given but not mapped; call spar_fluid_map",
            spar_step_begin(s, 0.1));
    REFUSED(s, SPAR_ERR_STATE, "not mapped", spar_step_begin_initial(s, 0.1));
    OK(s, spar_fluid_set_force_nodes(wind, 1, x));
    REFUSED(s, SPAR_ERR_STATE, "the force nodes are given but not mapped", spar_fluid_push_forces(wind, f, NULL));
    OK(s, spar_fluid_map(wind));
    REFUSED(s, SPAR_ERR_STATE, "a push failed; push again", spar_step_begin(s, 0.1));
    OK(s, spar_fluid_push_forces(wind, f, NULL));
    OK(s, spar_step_begin(s, 0.1));
    OK(s, spar_step_reject(s));
    spar_session_destroy(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_first_failure_stays),
        cmocka_unit_test(a_section_counts_too),
        cmocka_unit_test(a_log_has_told),
        cmocka_unit_test(what_is_not_mapped_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
