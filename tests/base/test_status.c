/* Status codes, texts and messages; the check for non-finite numbers; GSL's error handler. The expected values are the
   interface itself (codes are fixed for ever) and the C standard's arithmetic. */
#include "base/session.h"

#include <cmocka.h>
#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

static const struct {
    int code;
    const char *name;
} codes[] = {
    {0, "SPAR_OK"},          {1, "SPAR_ERR_ARGUMENT"},    {2, "SPAR_ERR_STATE"}, {3, "SPAR_ERR_MEMORY"},
    {4, "SPAR_ERR_NUMERIC"}, {5, "SPAR_ERR_MAPPING"},     {6, "SPAR_ERR_COMM"},  {7, "SPAR_ERR_PEER"},
    {8, "SPAR_ERR_IO"},      {9, "SPAR_ERR_UNSUPPORTED"}, {10, "SPAR_ERR_USER"}, {11, "SPAR_ERR_LIMIT"},
};

/* Every code has a text of its own that begins with its name. */
static void test_texts(void **state) {
    (void)state;
    for (size_t i = 0; i < sizeof codes / sizeof codes[0]; i++) {
        const char *text = spar_status_text(codes[i].code);
        size_t length = strlen(codes[i].name);
        assert_memory_equal(text, codes[i].name, length);
        assert_int_equal(text[length], ':');
        assert_true(strlen(text) > length + 5);
    }
    for (int code = 12; code < 15; code++) {
        assert_string_equal(spar_status_text(code), "unknown status");
        assert_string_equal(spar_status_text(-code), "unknown status");
    }
}

static void test_features(void **state) {
    (void)state;
    assert_string_equal(spar_version(), SPAR_TEST_VERSION);
#ifdef SPARI_HAVE_MPI
    assert_int_equal(spar_has("mpi"), 1);
#else
    assert_int_equal(spar_has("mpi"), 0);
#endif
    assert_int_equal(spar_has("gsl") || spar_has("lapack"), 1);
    assert_int_equal(spar_has("magic"), 0);
    assert_int_equal(spar_has(""), 0);
    assert_int_equal(spar_has(NULL), 0);
}

typedef struct record {
    int calls, level;
    const spar_session *session;
    char text[64];
} record;

static void listen(const spar_session *session, int level, const char *text, void *context) {
    record *r = context;
    r->calls++;
    r->level = level;
    r->session = session;
    memcpy(r->text, text, strlen(text) < sizeof r->text ? strlen(text) + 1 : sizeof r->text);
}

/* A message stays with its session, reaches its log callback, may quote the message before it, and is cut, not overrun.
 */
static void test_messages(void **state) {
    (void)state;
    spar_session *session = NULL;
    record heard = {0, -1, NULL, ""};
    assert_int_equal(spar_session_create(&session), SPAR_OK);
    assert_string_equal(spar_session_message(session), "");
    assert_int_equal(spari_fail(session, SPAR_ERR_IO, "no %s, %d", "file", 7), SPAR_ERR_IO);
    assert_string_equal(spar_session_message(session), "no file, 7");
    assert_int_equal(spar_session_set_log(session, listen, &heard), SPAR_OK);
    assert_int_equal(spari_fail(session, SPAR_ERR_PEER, "rank 1: %s", session->message), SPAR_ERR_PEER);
    assert_string_equal(spar_session_message(session), "rank 1: no file, 7");
    assert_int_equal(heard.calls, 1);
    assert_int_equal(heard.level, SPAR_LOG_ERROR);
    assert_ptr_equal(heard.session, session);
    assert_string_equal(heard.text, "rank 1: no file, 7");

    char *text = malloc(2 * SPARI_MESSAGE_SIZE + 1);
    assert_non_null(text);
    memset(text, 'a', 2 * SPARI_MESSAGE_SIZE);
    text[2 * SPARI_MESSAGE_SIZE] = '\0';
    assert_int_equal(spar_session_set_log(session, NULL, NULL), SPAR_OK);
    spari_fail(session, SPAR_ERR_IO, "%s", text);
    assert_int_equal(strlen(spar_session_message(session)), SPARI_MESSAGE_SIZE - 1);
    spari_fail(session, SPAR_ERR_IO, "call: member '%s': do this", text); /* the cure stays */
    assert_int_equal(strlen(spar_session_message(session)), SPARI_MESSAGE_SIZE - 1);
    assert_non_null(strstr(spar_session_message(session), "aa ... aa"));
    assert_non_null(strstr(spar_session_message(session), "a': do this"));
    assert_int_equal(strncmp(spar_session_message(session), "call: member 'aa", 16), 0);
    assert_int_equal(spari_named(session, "call", SPAR_ERR_IO), SPAR_ERR_IO);
    assert_int_equal(strncmp(spar_session_message(session), "call: member 'aa", 16), 0);
    assert_int_equal(spari_named(session, "outer", SPAR_ERR_IO), SPAR_ERR_IO);
    assert_int_equal(strncmp(spar_session_message(session), "outer: call: member 'aa", 23), 0);
    spari_fail(session, SPAR_ERR_IO, "inner fails");
    assert_int_equal(spari_named(session, "outer", SPAR_OK), SPAR_OK);
    assert_string_equal(spar_session_message(session), "inner fails");
    assert_int_equal(spari_named(session, "outer", SPAR_ERR_IO), SPAR_ERR_IO);
    assert_string_equal(spar_session_message(session), "outer: inner fails");
    free(text);
    assert_int_equal(heard.calls, 1);
    spar_session_destroy(&session);
}

static void *other_thread(void *mine) {
    *(int *)mine = strcmp(spar_session_message(NULL), "") == 0;
    spari_fail(NULL, SPAR_ERR_STATE, "there");
    *(int *)mine &= strcmp(spar_session_message(NULL), "there") == 0;
    return NULL;
}

/* Without a session the message belongs to the thread. */
static void test_thread_message(void **state) {
    (void)state;
    pthread_t thread;
    int own = 0;
    spari_fail(NULL, SPAR_ERR_STATE, "here");
    assert_int_equal(pthread_create(&thread, NULL, other_thread, &own), 0);
    assert_int_equal(pthread_join(thread, NULL), 0);
    assert_int_equal(own, 1);
    assert_string_equal(spar_session_message(NULL), "here");
    assert_int_equal(spar_session_create(NULL), SPAR_ERR_ARGUMENT);
    assert_non_null(strstr(spar_session_message(NULL), "spar_session_create"));
}

/* Finds the first bad entry wherever it stands; numbers at the ends of the range are good ones, whatever their sum. */
static void test_nonfinite(void **state) {
    (void)state;
    enum { N = 37 };
    double x[N] = {0};
    const double bad[] = {NAN, INFINITY, -INFINITY};
    for (int64_t n = 0; n <= N; n++) {
        for (int64_t i = 0; i < n; i++) {
            x[i] = i % 2 ? 1.7976931348623157e308 : 4.9e-324;
        }
        assert_int_equal(spari_first_nonfinite(x, n), -1);
        for (int64_t at = 0; at < n; at++) {
            double keep = x[at];
            for (int k = 0; k < 3; k++) {
                x[at] = bad[k];
                assert_int_equal(spari_first_nonfinite(x, n), at);
                double last = x[n - 1];
                x[n - 1] = NAN;
                assert_int_equal(spari_first_nonfinite(x, n), at);
                x[n - 1] = last;
            }
            x[at] = keep;
        }
    }
    assert_int_equal(spari_first_nonfinite(NULL, 0), -1);
}

static void test_memory(void **state) {
    (void)state;
    double *x = spari_zalloc(5, sizeof *x);
    assert_non_null(x);
    for (int i = 0; i < 5; i++) {
        assert_true(x[i] == 0.0);
    }
    free(x);
    void *empty = spari_zalloc(0, sizeof *x);
    assert_non_null(empty);
    free(empty);
    assert_null(spari_zalloc(-1, 1));
    assert_null(spari_zalloc(INT64_MAX, 64)); /* the product overflows */
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_texts),          cmocka_unit_test(test_features),  cmocka_unit_test(test_messages),
        cmocka_unit_test(test_thread_message), cmocka_unit_test(test_nonfinite), cmocka_unit_test(test_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
