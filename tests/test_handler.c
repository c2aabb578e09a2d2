/* A GSL error handler that the host set before its first session stays in force (its own process: the guard acts once).
 */
#include <spar/spar.h>

#include <cmocka.h>
#include <gsl/gsl_errno.h>

static int heard;

static void host_handler(const char *reason, const char *file, int line, int code) {
    (void)reason, (void)file, (void)line, (void)code;
    heard++;
}

static void test_kept(void **state) {
    (void)state;
    spar_session *session = NULL;
    gsl_set_error_handler(host_handler);
    assert_int_equal(spar_session_create(&session), SPAR_OK);
    gsl_error("for the host", __FILE__, __LINE__, GSL_EDOM);
    assert_int_equal(heard, 1);
    spar_session_destroy(&session);
    assert_ptr_equal(gsl_set_error_handler(NULL), host_handler);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_kept)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
