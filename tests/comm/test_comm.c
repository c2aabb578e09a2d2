/* One process alone: every call answers at once and changes nothing. Oracle: the statements of src/comm/comm.h. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#include "comm/comm.h"

#include <string.h>

static void alone(void **state) {
    (void)state;
    spari_comm *c = NULL;
    char text[64] = "own text";
    double x[4] = {1, 2, 3, 0};
    int64_t first[2] = {0, 4};
    assert_int_equal(spari_comm_create_self(&c), SPAR_OK);
    assert_int_equal(spari_comm_rank(c), 0);
    assert_int_equal(spari_comm_size(c), 1);
    assert_int_equal(spari_comm_agree(c, SPAR_OK, text, sizeof text), SPAR_OK);
    assert_int_equal(spari_comm_agree(c, SPAR_ERR_NUMERIC, text, sizeof text), SPAR_ERR_NUMERIC);
    assert_int_equal(spari_comm_enter(c, "spar_step_check", NULL, 0, SPAR_ERR_STATE, text, sizeof text),
                     SPAR_ERR_STATE);
    assert_int_equal(spari_comm_sum(c, x, 3, SPAR_OK, text, sizeof text), SPAR_OK);
    assert_int_equal(spari_comm_share(c, x, first, SPAR_OK, text, sizeof text), SPAR_OK);
    assert_true(x[0] == 1 && x[1] == 2 && x[2] == 3);
    assert_int_equal(spari_comm_sum(c, x, 3, SPAR_ERR_USER, text, sizeof text), SPAR_ERR_USER);
    assert_int_equal(spari_comm_share(c, x, first, SPAR_ERR_USER, text, sizeof text), SPAR_ERR_USER);
    assert_int_equal(spari_comm_move(c, 0, 0, x, sizeof x, text, sizeof text), SPAR_OK);
    assert_string_equal(text, "own text");
    spari_comm_destroy(&c);
    assert_null(c);
    spari_comm_destroy(&c);
    spari_comm_destroy(NULL);
}

/* A communicator before MPI_Init, or without MPI at all, is refused with the reason. */
static void no_mpi(void **state) {
    (void)state;
    spari_comm *c = NULL;
    char why[256] = "";
    int status = spari_comm_create_fortran(0, &c, SPAR_OK, why, sizeof why);
    assert_true(status == SPAR_ERR_COMM || status == SPAR_ERR_UNSUPPORTED);
    assert_non_null(strstr(why, "MPI"));
    assert_null(c);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(alone), cmocka_unit_test(no_mpi)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
