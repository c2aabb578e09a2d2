/* GSL's error handler is the host's: spar's own calls never reach it, although it may abort, and outside of spar's
   calls, in the host's callbacks too, it is in force, be it GSL's default one or one of the host's. */
#include "scene.h"

#include <gsl/gsl_errno.h>
#include <pthread.h>

static int heard;

static void host_handler(const char *reason, const char *file, int line, int code) {
    (void)reason, (void)file, (void)line, (void)code;
    heard++;
}

/* The host's own errors reach its handler. */
static int reaches_host(void) {
    int before = heard;
    gsl_error("for the host", __FILE__, __LINE__, GSL_EDOM);
    return heard == before + 1;
}

static void on_log(const spar_session *s, int level, const char *text, void *context) {
    (void)s, (void)level, (void)text;
    *(int *)context += reaches_host() ? 1 : 1000;
}

/* A section that is not positive definite and a mode search: both are found out by factorisations that GSL fails. */
static void provoke(spar_session *s) {
    double K[36], M[36], eta[2] = {0, 1}, bad[72], mass[72], frequency[2];
    spar_member *b = NULL;
    scene_box(K, M);
    for (int i = 0; i < 72; i++) {
        bad[i] = i == 7 ? -K[7] : K[i % 36];
        mass[i] = M[i % 36];
    }
    OK(s, spar_beam_create(s, "bad", 1, 5, &b));
    assert_int_not_equal(spar_beam_set_sections(b, 2, eta, bad, mass), SPAR_OK);
    spar_member *good = scene_beam(s, "good", 1, 5, 10, K, M);
    OK(s, spar_member_set_root(good, SPAR_ROOT_FREE));
    OK(s, spar_member_commit(good));
    (void)spar_member_solve_modes(good, 2, frequency, NULL);
}

static void test_kept(void **state) {
    (void)state;
    spar_session *s = NULL;
    gsl_set_error_handler(host_handler);
    OK(s, spar_session_create(&s));
    provoke(s);
    assert_int_equal(heard, 0);
    assert_true(reaches_host());
    spar_session_destroy(&s);
    assert_true(reaches_host());
    assert_ptr_equal(gsl_set_error_handler(NULL), host_handler);
}

static void test_default(void **state) {
    (void)state;
    spar_session *s = NULL;
    gsl_set_error_handler(NULL); /* aborts */
    OK(s, spar_session_create(&s));
    provoke(s);
    assert_null(gsl_set_error_handler(NULL));
    spar_session_destroy(&s);
}

static void test_callback(void **state) {
    (void)state;
    spar_session *s = NULL;
    int logged = 0;
    gsl_set_error_handler(host_handler);
    OK(s, spar_session_create(&s));
    OK(s, spar_session_set_log(s, on_log, &logged));
    provoke(s); /* two messages at least */
    assert_true(logged > 0 && logged < 1000);
    spar_session_destroy(&s);
    assert_ptr_equal(gsl_set_error_handler(NULL), host_handler);
}

static void *work(void *answer) {
    spar_session *s = NULL;
    int status = spar_session_create(&s);
    for (int i = 0; i < 2000 && status == SPAR_OK; i++) {
        status = spar_session_set_option(s, "coupling.filter", "0.05");
    }
    *(int *)answer = status;
    spar_session_destroy(&s);
    return NULL;
}

/* Threads go in and out as they like: after the last one the handler is the host's. */
static void test_threads(void **state) {
    (void)state;
    pthread_t thread[4];
    int answer[4];
    gsl_set_error_handler(host_handler);
    for (int i = 0; i < 4; i++) {
        assert_int_equal(pthread_create(&thread[i], NULL, work, &answer[i]), 0);
    }
    for (int i = 0; i < 4; i++) {
        assert_int_equal(pthread_join(thread[i], NULL), 0);
        assert_int_equal(answer[i], SPAR_OK);
    }
    assert_ptr_equal(gsl_set_error_handler(NULL), host_handler);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_kept), cmocka_unit_test(test_default),
                                       cmocka_unit_test(test_callback), cmocka_unit_test(test_threads)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
