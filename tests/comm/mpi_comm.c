/* The ranks of a communicator: sums, shares, agreement, and failures on one rank that all are told of. Oracle: closed
   forms in the number of ranks. Any number of ranks; a rank that waits is caught by the time limit of ctest. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <mpi.h>

#include "comm/comm.h"
#include "comm/ranks.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static spari_comm *ranks;
static int rank, size;

static void identity(void **state) {
    (void)state;
    int r, n;
    MPI_Comm_rank(MPI_COMM_WORLD, &r);
    MPI_Comm_size(MPI_COMM_WORLD, &n);
    assert_int_equal(rank, r);
    assert_int_equal(size, n);
}

static void refused_communicators(void **state) {
    (void)state;
    spari_comm *c = NULL;
    char why[SPARI_MESSAGE_SIZE] = "";
    int null = (int)MPI_Comm_c2f(MPI_COMM_NULL);
    assert_int_equal(spari_comm_create_fortran(null, &c, SPAR_OK, why, sizeof why), SPAR_ERR_ARGUMENT);
    assert_non_null(strstr(why, "MPI_COMM_NULL"));
    assert_int_not_equal(spari_comm_create_fortran(123456789, &c, SPAR_OK, why, sizeof why), SPAR_OK);
    assert_int_not_equal(spari_comm_create_fortran(-7, &c, SPAR_OK, why, sizeof why), SPAR_OK);
    assert_null(c);
}

/* sum over ranks of (r + 1) * (i + 1) = n(n+1)/2 * (i+1): small integers, exact */
static void sums(void **state) {
    (void)state;
    double x[6], expected = 0.5 * size * (size + 1);
    char text[SPARI_MESSAGE_SIZE] = "";
    for (int i = 0; i < 5; i++) {
        x[i] = (rank + 1) * (i + 1);
    }
    assert_int_equal(spari_comm_sum(ranks, x, 5, SPAR_OK, text, sizeof text), SPAR_OK);
    for (int i = 0; i < 5; i++) {
        assert_true(x[i] == expected * (i + 1));
    }
    spari_bins bins[6];
    memset(bins, 0, sizeof bins);
    for (int i = 0; i < 5; i++) {
        spari_bins_add(bins + i, (rank + 1) * (i + 1));
    }
    assert_int_equal(spari_comm_prepare_bins(ranks, text, sizeof text), SPAR_OK);
    assert_int_equal(spari_comm_sum_bins(ranks, bins, 5, SPAR_OK, text, sizeof text), SPAR_OK);
    for (int i = 0; i < 5; i++) {
        assert_true(spari_bins_value(bins + i) == expected * (i + 1));
    }
    assert_int_equal(spari_comm_sum(ranks, x, 0, SPAR_OK, text, sizeof text), SPAR_OK); /* nothing but the status */
}

/* From each rank to each other in turn, in one message or several; who is neither of the two makes no call. */
static void moves(void **state) {
    (void)state;
    char text[SPARI_MESSAGE_SIZE] = "";
    int most = ranks->most;
    for (int k = 0; k < size * size; k++) {
        int from = k / size, to = k % size;
        int64_t data[3] = {10 * rank, 10 * rank + 1, 10 * rank + 2};
        ranks->most = k % 2 ? most : 7;
        if (rank == from || rank == to) {
            assert_int_equal(spari_comm_move(ranks, from, to, data, sizeof data, text, sizeof text), SPAR_OK);
        }
        for (int i = 0; i < 3; i++) {
            assert_int_equal(data[i], 10 * (rank == to ? from : rank) + i);
        }
    }
    ranks->most = most;
}

/* The bits of a sum that rounds are the same on all ranks. */
static void same_bits(void **state) {
    (void)state;
    double x[33];
    char text[SPARI_MESSAGE_SIZE] = "";
    srand(7 + (unsigned)rank);
    for (int i = 0; i < 32; i++) {
        x[i] = (2.0 * rand() / RAND_MAX - 1) * (i % 2 ? 1e9 : 1e-9);
    }
    assert_int_equal(spari_comm_sum(ranks, x, 32, SPAR_OK, text, sizeof text), SPAR_OK);
    for (int i = 0; i < 32; i++) {
        const spari_agreed must_agree = spari_real("sum", x[i]);
        assert_int_equal(spari_comm_enter(ranks, "sums", &must_agree, 1, SPAR_OK, text, sizeof text), SPAR_OK);
    }
}

/* What rank `failing` says is SPAR_ERR_NUMERIC there and SPAR_ERR_PEER with its text elsewhere. */
static void check_told(int failing, int status, const char *text) {
    char expected[64];
    snprintf(expected, sizeof expected, "rank %d: wings fell off at %d", failing, failing);
    assert_int_equal(status, rank == failing ? SPAR_ERR_NUMERIC : SPAR_ERR_PEER);
    assert_string_equal(text, rank == failing ? strchr(expected, 'w') : expected);
}

static void failures(void **state) {
    (void)state;
    int64_t *first = calloc((size_t)size + 1, sizeof *first);
    double *y = calloc((size_t)size, sizeof *y), x[4];
    for (int r = 0; r < size; r++) {
        first[r + 1] = first[r] + 1;
    }
    for (int failing = 0; failing < size; failing++) {
        char text[SPARI_MESSAGE_SIZE] = "";
        int status = rank == failing ? SPAR_ERR_NUMERIC : SPAR_OK;
        if (status) {
            snprintf(text, sizeof text, "wings fell off at %d", rank);
        }
        check_told(failing, spari_comm_agree(ranks, status, text, sizeof text), text);
        if (!status) {
            text[0] = '\0';
        }
        check_told(failing, spari_comm_sum(ranks, x, 3, status, text, sizeof text), text);
        if (!status) {
            text[0] = '\0';
        }
        check_told(failing, spari_comm_share(ranks, y, first, status, text, sizeof text), text);
        if (!status) {
            text[0] = '\0';
        }
        check_told(failing, spari_comm_enter(ranks, "spar_step_solve", NULL, 0, status, text, sizeof text), text);
    }
    free(first);
    free(y);
}

/* All fail: each keeps its own, nobody is told of a peer. */
static void all_fail(void **state) {
    (void)state;
    char text[SPARI_MESSAGE_SIZE], own[64];
    snprintf(own, sizeof own, "own %d", rank);
    snprintf(text, sizeof text, "%s", own);
    assert_int_equal(spari_comm_agree(ranks, SPAR_ERR_IO, text, sizeof text), SPAR_ERR_IO);
    assert_string_equal(text, own);
}

/* A rank in another collective call is found at the entry, on all ranks. */
static void different_calls(void **state) {
    (void)state;
    char text[SPARI_MESSAGE_SIZE] = "";
    const char *call = rank == size - 1 ? "spar_step_check" : "spar_step_solve";
    int status = spari_comm_enter(ranks, call, NULL, 0, SPAR_OK, text, sizeof text);
    assert_int_equal(status, size == 1 ? SPAR_OK : SPAR_ERR_COMM);
    assert_true(size == 1 || strstr(text, call) == text);
    assert_int_equal(spari_comm_enter(ranks, "spar_step_check", NULL, 0, SPAR_OK, text, sizeof text), SPAR_OK);
}

/* blocks of 2 r + 1 numbers, the last of which is the status: rank 0 has nothing to share */
static void shares(void **state) {
    (void)state;
    int64_t *first = calloc((size_t)size + 1, sizeof *first);
    for (int r = 0; r < size; r++) {
        first[r + 1] = first[r] + 2 * r + 1;
    }
    double *x = calloc((size_t)first[size], sizeof *x);
    char text[SPARI_MESSAGE_SIZE] = "";
    for (int64_t i = first[rank]; i < first[rank + 1] - 1; i++) {
        x[i] = 0.1 * (double)i + rank;
    }
    assert_int_equal(spari_comm_share(ranks, x, first, SPAR_OK, text, sizeof text), SPAR_OK);
    for (int r = 0; r < size; r++) {
        for (int64_t i = first[r]; i < first[r + 1] - 1; i++) {
            assert_true(x[i] == 0.1 * (double)i + r);
        }
    }
    free(first);
    free(x);
}

/* Sums, shares and broadcasts in messages of 3 numbers, as where they are more than 2^31: the same. */
static void pieces(void **state) {
    ranks->most = 3;
    sums(state);
    shares(state);
    char text[SPARI_MESSAGE_SIZE] = "", word[] = "a word of rank 0", other[sizeof word] = "";
    assert_int_equal(spari_comm_broadcast(ranks, rank == 0 ? word : other, sizeof word, text, sizeof text), SPAR_OK);
    assert_true(rank == 0 || strcmp(other, word) == 0);
    failures(state);
    ranks->most = INT_MAX;
}

/* What a call is given is compared, whatever else is the same, and the first thing that differs is named; a rank that
   fails is told of before that. */
static void arguments(void **state) {
    (void)state;
    for (int bad = 0; bad < 4; bad++) {
        int here = rank == size - 1;
        const spari_agreed must_agree[] = {
            spari_real("dt", here && bad == 0 ? nextafter(0.1, 1) : 0.1),
            spari_whole("steps", here && bad == 1 ? INT64_MIN : INT64_MAX),
            spari_given("solve", here && bad == 2 ? 0 : 1),
            spari_hash("settings", here && bad <= 3 ? UINT64_MAX : 1),
        };
        static const char *const name[] = {"dt (here 0.1", "steps (here ", "solve (here ", "settings; make"};
        char text[SPARI_MESSAGE_SIZE] = "";
        int status = spari_comm_enter(ranks, "call", must_agree, 4, SPAR_OK, text, sizeof text);
        assert_int_equal(status, size == 1 ? SPAR_OK : SPAR_ERR_COMM);
        assert_true(size == 1 || strstr(text, name[bad]));
        (void)snprintf(text, sizeof text, "wings fell off at %d", rank);
        status =
            spari_comm_enter(ranks, "call", must_agree, 4, rank == 0 ? SPAR_ERR_NUMERIC : SPAR_OK, text, sizeof text);
        check_told(0, status, text);
        text[0] = '\0';
        assert_int_equal(spari_comm_enter(ranks, "call", must_agree, 0, SPAR_OK, text, sizeof text), SPAR_OK);
    }
    const spari_agreed zero = spari_real("zero", rank == 0 ? 0.0 : -0.0);
    char text[64];
    assert_int_equal(spari_comm_enter(ranks, "call", &zero, 1, SPAR_OK, text, sizeof text), SPAR_OK);
}

/* A rank that cannot make its part has the others told, and nobody gets a communicator. */
static void refused_on_one_rank(void **state) {
    (void)state;
    for (int failing = 0; failing < size; failing++) {
        spari_comm *c = NULL;
        char text[SPARI_MESSAGE_SIZE] = "";
        (void)snprintf(text, sizeof text, "wings fell off at %d", rank);
        int status = spari_comm_create_fortran((int)MPI_Comm_c2f(MPI_COMM_WORLD), &c,
                                               rank == failing ? SPAR_ERR_NUMERIC : SPAR_OK, text, sizeof text);
        check_told(failing, status, text);
        assert_null(c);
    }
}

/* A rank that has gone is not waited for, and does not wait: the others are told in whatever call they are. */
static void gone(void **state) {
    (void)state;
    for (int leaving = 0; leaving < size && size > 1; leaving++) {
        spari_comm *c = NULL;
        char text[SPARI_MESSAGE_SIZE] = "";
        assert_int_equal(spari_comm_create_fortran((int)MPI_Comm_c2f(MPI_COMM_WORLD), &c, SPAR_OK, text, sizeof text),
                         SPAR_OK);
        for (int k = 0; k < 3 && rank != leaving; k++) {
            double x[2] = {1, 0};
            int status = k == 1 ? spari_comm_sum(c, x, 1, SPAR_OK, text, sizeof text)
                                : spari_comm_enter(c, "call", NULL, 0, SPAR_OK, text, sizeof text);
            assert_int_equal(status, SPAR_ERR_COMM);
            assert_non_null(strstr(text, "has destroyed this session"));
        }
        spari_comm_destroy(&c);
    }
}

int main(int argc, char **argv) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(identity),  cmocka_unit_test(refused_communicators),
        cmocka_unit_test(sums),      cmocka_unit_test(same_bits),
        cmocka_unit_test(failures),  cmocka_unit_test(all_fail),
        cmocka_unit_test(shares),    cmocka_unit_test(different_calls),
        cmocka_unit_test(arguments), cmocka_unit_test(refused_on_one_rank),
        cmocka_unit_test(gone),      cmocka_unit_test(pieces),
        cmocka_unit_test(moves),
    };
    char text[SPARI_MESSAGE_SIZE] = "";
    int failed, worst = 0;
    MPI_Init(&argc, &argv);
    if (spari_comm_create_fortran((int)MPI_Comm_c2f(MPI_COMM_WORLD), &ranks, SPAR_OK, text, sizeof text) != SPAR_OK) {
        fprintf(stderr, "%s\n", text);
        MPI_Abort(MPI_COMM_WORLD, 1);
    }
    rank = spari_comm_rank(ranks);
    size = spari_comm_size(ranks);
    failed = cmocka_run_group_tests(tests, NULL, NULL);
    MPI_Allreduce(&failed, &worst, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD);
    MPI_Finalize();
    /* after MPI_Finalize: refused, and destroy only frees */
    if (spari_comm_agree(ranks, SPAR_OK, text, sizeof text) != SPAR_ERR_COMM || !strstr(text, "MPI_Finalize")) {
        fprintf(stderr, "a call after MPI_Finalize was not refused\n");
        worst = 1;
    }
    spari_comm_destroy(&ranks);
    return worst;
}
