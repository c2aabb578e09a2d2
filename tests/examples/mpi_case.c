/* A structure from a text file on several ranks: what one rank cannot read, all refuse, and nobody waits. */
#include "scene.h"

#include "case.h"
#include "ranks.h"
#include <spar/spar_mpi.h>
#include <stdio.h>
#include <unistd.h>

static const char text[] = "[session]\ngravity 0 0 -9.81\n[beam wing]\nnodes 5\naxis 0 0 0 0\naxis 1 2 0 0\n"
                           "section 0 4e4 4e4 4e4 600 600 600 1 1 1 .02 .01 .01\n"
                           "[rigid weight]\nplace 2 0 0\nmass 1 1 1 .1 .1 .1\n"
                           "[joint weld]\na weight first\nb wing last\n";

static void write_case(const char *path, const char *more) {
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    (void)fprintf(file, "%s%s", text, more);
    assert_int_equal(fclose(file), 0);
}

/* Each rank its own copy, alike: they agree, and the wing bends alike everywhere. */
static void test_alike(void **state) {
    (void)state;
    char path[64];
    double q[7], least[7], most[7];
    spar_session *s = NULL;
    spar_case *c = NULL;
    spar_member *wing = NULL;
    (void)snprintf(path, sizeof path, "mpi_case_%ld_%d.case", (long)getpid(), rank);
    write_case(path, "");
    OK(NULL, spar_session_create_mpi(MPI_COMM_WORLD, &s));
    if (spar_case_read(path, "host", s, &c) != SPAR_OK) {
        fail_msg("%s", spar_case_message());
    }
    assert_int_equal(spar_case_member(c, "wing", &wing), SPAR_OK);
    OK(s, spar_step(s, 0.01, NULL, NULL, NULL));
    scene_tip(wing, q);
    assert_true(q[2] < 0);
    MPI_Allreduce(q, least, 7, MPI_DOUBLE, MPI_MIN, MPI_COMM_WORLD);
    MPI_Allreduce(q, most, 7, MPI_DOUBLE, MPI_MAX, MPI_COMM_WORLD);
    assert_memory_equal(least, most, sizeof least);
    spar_case_free(&c);
    spar_session_destroy(&s);
    (void)remove(path);
}

/* The last rank's file is not there, has a mistake, or says something else: it answers its own status, the others
   SPAR_ERR_PEER, or all SPAR_ERR_COMM. */
static void test_odd_one(void **state) {
    (void)state;
    static const char *const more[] = {NULL, "[beam]\n", "[joint top]\na weight 1\nb ground\n",
                                       "[rigid b]\nmass 1 1 1 1 1 1\n"};
    static const int own[] = {SPAR_ERR_IO, SPAR_ERR_ARGUMENT, SPAR_ERR_ARGUMENT, SPAR_ERR_COMM};
    char path[64];
    (void)snprintf(path, sizeof path, "mpi_case_%ld_%d.case", (long)getpid(), rank);
    for (int k = 0; k < 4 && size > 1; k++) {
        spar_session *s = NULL;
        spar_case *c = NULL;
        int odd = rank == size - 1;
        (void)remove(path);
        if (!odd || more[k]) {
            write_case(path, odd ? more[k] : "");
        }
        OK(NULL, spar_session_create_mpi(MPI_COMM_WORLD, &s));
        assert_int_equal(spar_case_read(path, NULL, s, &c), odd || own[k] == SPAR_ERR_COMM ? own[k] : SPAR_ERR_PEER);
        assert_true(strlen(spar_case_message()) > 20);
        assert_null(c);
        spar_session_destroy(&s);
    }
    (void)remove(path);
}

int main(int argc, char **argv) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_alike), cmocka_unit_test(test_odd_one)};
    return RANKS_RUN(argc, argv, tests);
}
