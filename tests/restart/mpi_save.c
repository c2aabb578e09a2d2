/* Save and load on several ranks, by which no rank has the file in memory: a rank that can open no file changes
   nothing, and a run goes on from it with the same bits; what fails on the first rank is told on all, and the file that
   was there stays. Oracles: the same file by ranks that all can, the uninterrupted run. */
#include "scene.h"

#include "ranks.h"
#include <signal.h>
#include <spar/spar_mpi.h>
#include <stdio.h>
#include <sys/resource.h>
#include <unistd.h>

/* NODES of each rank; many, so that what is not there lies beyond the file. STATES: numbers of the host's at each; with
   them as many of a node stand in the file as BY_NODE. */
enum { NODES = 200, STATES = 3, BY_NODE = 15 + 2 * STATES };

typedef struct run {
    spar_session *session;
    spar_member *beam, *second;
    spar_fluid *fluid;
    int64_t n;
} run;

static char file[2][40];

/* Nodes of ranks first, first + 1, ... of a row of them along a beam. KEPT: forces, and numbers of the host's. */
enum { KEPT, PLACES, SECTIONS };
static void create(run *r, spar_session *s, int first, int ranks, int nodes, int kind) {
    double K[36], M[36];
    *r = (run){.session = s, .n = (int64_t)nodes * ranks};
    double *x = calloc((size_t)(3 * r->n) + 1, sizeof *x), *eta = calloc((size_t)r->n + 1, sizeof *eta);
    scene_box(K, M);
    r->beam = scene_beam(s, "beam", 1, 4, 10, K, M);
    OK(s, spar_member_set_effects(r->beam, kind == KEPT ? SPAR_EFFECT_FLUID_HISTORY : 0, 0));
    OK(s, spar_member_commit(r->beam));
    r->second = scene_beam(s, "second", 1, 4, 10, K, M); /* solved on the second rank, if there is one */
    OK(s, spar_member_commit(r->second));
    for (int64_t i = 0; i < r->n; i++) {
        x[3 * i] = 10.0 * (double)(first * nodes + i) / (nodes * size);
        x[3 * i + 1] = 0.1;
        eta[i] = 0.1 * x[3 * i];
    }
    OK(s, spar_fluid_create(r->beam, "nodes", &r->fluid));
    if (kind == SECTIONS) {
        OK(s, spar_fluid_set_stations(r->fluid, r->n, eta, NULL));
    } else {
        OK(s, spar_fluid_set_motion_nodes(r->fluid, r->n, x));
        OK(s, spar_fluid_set_force_nodes(r->fluid, r->n, x));
    }
    OK(s, spar_fluid_map(r->fluid));
    OK(s, spar_fluid_set_states(r->fluid, kind == KEPT ? STATES : 0));
    free(x);
    free(eta);
}

static spar_session *on_all(void) {
    spar_session *s = NULL;
    OK(NULL, spar_session_create_mpi(MPI_COMM_WORLD, &s));
    scene_strict(s);
    return s;
}

/* Forces by velocities, by those at t^n, and by three numbers a node that follow the velocities slowly. */
static void step(run *r, int count) {
    double *z = calloc((size_t)(STATES * r->n) + 1, sizeof *z), *v = calloc((size_t)(3 * r->n) + 1, sizeof *v),
           *f = calloc((size_t)(3 * r->n) + 1, sizeof *f);
    for (int k = 0, done; k < count; k++) {
        OK(r->session, spar_step_begin(r->session, 0.02));
        OK(r->session, spar_step_solve(r->session));
        OK(r->session, spar_fluid_pull_motion(r->fluid, 1, NULL, v));
        OK(r->session, spar_fluid_pull_forces(r->fluid, 0, f));
        OK(r->session, spar_fluid_pull_states(r->fluid, STATES, z));
        for (int64_t i = 0; i < 3 * r->n; i++) {
            z[i] = 0.8 * z[i] + 0.2 * v[i];
            f[i] = 0.5 * f[i] - 0.1 * v[i] - 0.2 * z[i] + 0.01 * (double)(i % 3);
        }
        OK(r->session, spar_fluid_push_states(r->fluid, STATES, z));
        OK(r->session, spar_fluid_push_forces(r->fluid, f, NULL));
        OK(r->session, spar_step_check(r->session, &done));
        OK(r->session, spar_step_accept(r->session));
    }
    free(v);
    free(f);
    free(z);
}

static void look(const run *r, double seen[52]) {
    OK(r->session, spar_member_get_motion(r->beam, seen, seen + 28, NULL));
}

static void forget(const char *path) {
    MPI_Barrier(MPI_COMM_WORLD);
    if (rank == 0) {
        remove(path);
    }
}

static long get(const char *path, unsigned char **bytes) {
    FILE *f = fopen(path, "rb");
    assert_non_null(f);
    fseek(f, 0, SEEK_END);
    long n = ftell(f);
    rewind(f);
    *bytes = malloc((size_t)n);
    assert_int_equal(fread(*bytes, 1, (size_t)n, f), n);
    fclose(f);
    return n;
}

/* A file from ranks of which only the first kept its node forces, loaded where all nodes are on one process: the forces
   of the others are not in it, which is said; nothing is read that is not there (the sanitizers are the witness). */
static void kept_on_one_rank(void **state) {
    (void)state;
    run all, alone;
    create(&all, on_all(), rank, 1, NODES, rank == 0 ? SECTIONS : PLACES);
    create(&alone, scene_session(), 0, size, NODES, SECTIONS);
    scene_run(all.session, 0.02, 2);
    OK(all.session, spar_session_save(all.session, file[0]));
    int status = spar_session_load(alone.session, file[0]);
    if (size == 1) {
        OK(alone.session, status);
    } else {
        assert_int_equal(status, SPAR_ERR_ARGUMENT);
        assert_non_null(strstr(spar_session_message(alone.session), "force node 200 is not in the saved run"));
    }
    OK(all.session, spar_session_load(all.session, file[0]));
    scene_run(all.session, 0.02, 1);
    spar_session_destroy(&all.session);
    spar_session_destroy(&alone.session);
    forget(file[0]);
}

/* No file can be opened on this rank from here on, or again. */
static void blind(int on) {
    static struct rlimit old;
    if (on) {
        assert_int_equal(getrlimit(RLIMIT_NOFILE, &old), 0);
        assert_int_equal(setrlimit(RLIMIT_NOFILE, &(struct rlimit){0, old.rlim_max}), 0);
    } else {
        assert_int_equal(setrlimit(RLIMIT_NOFILE, &old), 0);
    }
}

static void expect_end(run *r, const double *end) {
    double seen[52] = {0};
    step(r, 3);
    look(r, seen);
    assert_memory_equal(seen, end, sizeof seen);
}

/* Written and read with all ranks able to open files, and with the last unable. The forces and states that the file
   keeps move the beam afterwards. */
static void same_file(void **state) {
    (void)state;
    run r;
    double end[52] = {0};
    unsigned char *bytes[2] = {NULL, NULL};
    long n[2];
    create(&r, on_all(), rank, 1, NODES, KEPT);
    step(&r, 2);
    OK(r.session, spar_session_save(r.session, file[0]));
    if (rank == size - 1 && rank > 0) {
        blind(1);
    }
    OK(r.session, spar_session_save(r.session, file[1]));
    if (rank == size - 1 && rank > 0) {
        blind(0);
    }
    for (int k = 0; k < 2; k++) {
        n[k] = get(file[k], bytes + k);
    }
    assert_int_equal(n[0], n[1]);
    assert_memory_equal(bytes[0], bytes[1], (size_t)n[0]);
    assert_true(n[0] > 8L * BY_NODE * NODES * size); /* places, forces and states of all nodes are in it */
    step(&r, 3);
    look(&r, end);
    for (int blinded = 0; blinded < 2; blinded++) {
        int cannot = blinded && rank == size - 1 && rank > 0;
        if (cannot) {
            blind(1);
        }
        OK(r.session, spar_session_load(r.session, file[0]));
        if (cannot) {
            blind(0);
        }
        expect_end(&r, end);
    }
    spar_session_destroy(&r.session);
    free(bytes[0]);
    free(bytes[1]);
    forget(file[1]);
}

/* The last file on other ranks: all nodes on the last rank, or on one process. Sums over nodes are rounded otherwise.
 */
static void other_ranks(void **state) {
    (void)state;
    for (int alone = 0; alone < 2; alone++) {
        run r, base;
        double seen[52] = {0}, end[52] = {0};
        int mine = alone ? size : rank == size - 1 ? size : 0;
        create(&base, on_all(), rank, 1, NODES, KEPT);
        OK(base.session, spar_session_load(base.session, file[0]));
        step(&base, 3);
        look(&base, end);
        create(&r, alone ? scene_session() : on_all(), 0, mine, NODES, KEPT);
        OK(r.session, spar_session_load(r.session, file[0]));
        step(&r, 3);
        look(&r, seen);
        for (int i = 0; i < 52; i++) {
            NEAR(seen[i], end[i], 1e-13);
        }
        assert_true(end[8] != 0 && end[9] != 0);
        spar_session_destroy(&r.session);
        spar_session_destroy(&base.session);
    }
    forget(file[0]);
}

/* Forces that follow the time and the velocities. */
static int push_drag(spar_session *s, double t, double dt, int iteration, void *context) {
    const run *r = context;
    double *v = calloc((size_t)(3 * r->n) + 1, sizeof *v);
    (void)iteration;
    OK(s, spar_fluid_pull_motion(r->fluid, 1, NULL, v));
    for (int64_t i = 0; i < 3 * r->n; i++) {
        v[i] = (double)(i % 3) * pow(sin(3 * (t + dt)), 4) - 0.1 * v[i];
    }
    int status = spar_fluid_push_forces(r->fluid, v, NULL);
    free(v);
    return status;
}

/* For 0.4 s, in steps of dt/2 and 3 dt/2 by turns. */
static void go_uneven(run *r, double dt) {
    const int steps = (int)(0.4 / dt + 0.5);
    for (int k = 0; k < steps; k++) {
        OK(r->session, spar_step(r->session, k % 2 ? 1.5 * dt : 0.5 * dt, push_drag, r, NULL));
    }
}

enum { FEW = 4 };

/* The motion at t = 0.8. elsewhere: saved at t = 0.4, and gone on with from there on one process alone. */
static void end_of_uneven(double dt, int elsewhere, double seen[52]) {
    run r, other;
    create(&r, on_all(), rank, 1, FEW, PLACES);
    OK(r.session, spar_session_set_coupling(r.session, SPAR_COUPLING_IQN_ILS, 0, 1e-10, 50));
    go_uneven(&r, dt);
    if (elsewhere) {
        OK(r.session, spar_session_save(r.session, file[1]));
        create(&other, scene_session(), 0, size, FEW, PLACES);
        OK(other.session, spar_session_set_coupling(other.session, SPAR_COUPLING_IQN_ILS, 0, 1e-10, 50));
        OK(other.session, spar_session_load(other.session, file[1]));
        spar_session_destroy(&r.session);
        r = other;
        MPI_Barrier(MPI_COMM_WORLD);
        forget(file[1]);
    }
    go_uneven(&r, dt);
    look(&r, seen);
    spar_session_destroy(&r.session);
}

/* A save in the middle of uneven steps keeps order 2, on another number of ranks too. The error at t = 0.8 is taken
   against steps of an eighth that are not interrupted. Expected: it falls with an order of 2 within 0.5 (the order
   still changes with dt: 1.9 to 2.4 here), and is that of the run that is not saved to 1e-3. */
static void order_in_uneven_steps(void **state) {
    (void)state;
    if (size > 2) { /* thousands of steps, and more ranks than processors */
        skip();
    }
    double fine[52] = {0}, at[2][2][52] = {{{0}}}, error[2][2] = {{0}};
    end_of_uneven(0.000625, 0, fine);
    for (int i = 0; i < 4; i++) {
        double *seen = at[i / 2][i % 2];
        end_of_uneven(i % 2 ? 0.0025 : 0.005, i / 2, seen);
        for (int k = 0; k < 28; k++) {
            error[i / 2][i % 2] = fmax(error[i / 2][i % 2], fabs(seen[k] - fine[k]));
        }
    }
    for (int i = 0; i < 2; i++) {
        NEAR(log2(error[i][0] / error[i][1]), 2, 0.5);
        NEAR(error[1][i], error[0][i], 1e-3 * error[0][i]);
    }
}

/* No room on the disc where one rank writes, each in turn. The first writes for all: told on all ranks, nothing is
   left, and what was there stays. What the others could write changes nothing. */
static void no_room(void **state) {
    (void)state;
    run r;
    unsigned char *before = NULL, *after = NULL;
    struct rlimit old;
    char left[60];
    snprintf(left, sizeof left, "%s.new", file[0]);
    (void)signal(SIGXFSZ, SIG_IGN);
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &old), 0);
    create(&r, on_all(), rank, 1, NODES, KEPT);
    step(&r, 1);
    OK(r.session, spar_session_save(r.session, file[0]));
    long n = get(file[0], &before);
    step(&r, 1);
    MPI_Barrier(MPI_COMM_WORLD);
    for (int bad = 0; bad < size; bad++) {
        if (rank == bad) {
            assert_int_equal(setrlimit(RLIMIT_FSIZE, &(struct rlimit){64, old.rlim_max}), 0);
        }
        int status = spar_session_save(r.session, file[0]);
        assert_int_equal(setrlimit(RLIMIT_FSIZE, &old), 0);
        assert_int_equal(status, bad > 0 ? SPAR_OK : rank == 0 ? SPAR_ERR_IO : SPAR_ERR_PEER);
        long now = get(file[0], &after); /* the second step has added a column */
        assert_true(bad == 0 ? now == n : now > n);
        if (bad == 0) {
            assert_non_null(strstr(spar_session_message(r.session), "cannot write"));
            assert_memory_equal(before, after, (size_t)n);
        }
        assert_int_not_equal(access(left, F_OK), 0);
        free(after);
        MPI_Barrier(MPI_COMM_WORLD);
    }
    OK(r.session, spar_session_save(r.session, file[0]));
    OK(r.session, spar_session_load(r.session, file[0]));
    step(&r, 1);
    spar_session_destroy(&r.session);
    free(before);
}

/* The last file with one byte turned, in the part of each rank and in what all share. */
static void damaged(void **state) {
    (void)state;
    run r;
    unsigned char *bytes = NULL;
    double seen[52] = {0}, after[52] = {0};
    create(&r, on_all(), rank, 1, NODES, KEPT);
    OK(r.session, spar_session_load(r.session, file[0]));
    look(&r, seen);
    long n = get(file[0], &bytes);
    for (int part = 0; part <= size; part++) {
        MPI_Barrier(MPI_COMM_WORLD);
        if (rank == 0) {
            FILE *f = fopen(file[1], "wb");
            long at = part < size ? n - 400 - part * ((n - 800) / size) : 300;
            bytes[at] ^= 4;
            assert_int_equal(fwrite(bytes, 1, (size_t)n, f), n);
            assert_int_equal(fclose(f), 0);
            bytes[at] ^= 4;
        }
        MPI_Barrier(MPI_COMM_WORLD);
        assert_int_equal(spar_session_load(r.session, file[1]), rank == 0 ? SPAR_ERR_IO : SPAR_ERR_PEER);
        assert_non_null(strstr(spar_session_message(r.session), "is damaged"));
    }
    look(&r, after);
    assert_memory_equal(seen, after, sizeof seen);
    spar_session_destroy(&r.session);
    free(bytes);
    forget(file[0]);
    forget(file[1]);
}

/* The most memory that this process has had since the last call, bytes; where the system cannot forget it, ever. */
static double most_memory(void) {
    struct rusage use;
    getrusage(RUSAGE_SELF, &use);
    FILE *f = fopen("/proc/self/clear_refs", "w");
    if (f) {
        (void)fputs("5", f);
        (void)fclose(f);
    }
    return 1024.0 * (double)use.ru_maxrss;
}

static int load(const spar_session *s, const char *path) {
    return spar_session_load((spar_session *)(uintptr_t)s, path);
}

/* Each rank has a part of 21 doubles a node in the file. To save takes no more of a rank than two of its own parts, and
   some buffers; to load likewise, also where a rank has nothing. The sanitizers keep what is freed. */
static void memory(void **state) {
    (void)state;
    enum { MANY = 150000 };
    run r;
    double own = 8.0 * BY_NODE * MANY, before, took[2], most[2];
    create(&r, on_all(), rank, 1, MANY, KEPT);
    step(&r, 1);
    for (int k = 0; k < 2; k++) {
        (void)most_memory();
        before = most_memory();
        OK(r.session, (k == 0 ? spar_session_save : load)(r.session, file[0]));
        took[k] = most_memory() - before;
    }
    MPI_Allreduce(took, most, 2, MPI_DOUBLE, MPI_MAX, MPI_COMM_WORLD);
    if (rank == 0) {
        print_message("%d ranks, %.1f MB of each in the file: save took %.1f MB more, load %.1f MB\n", size, own / 1e6,
                      most[0] / 1e6, most[1] / 1e6);
    }
#ifndef __SANITIZE_ADDRESS__
    assert_true(most[0] < 2 * own + 8e6 && most[1] < 2 * own + 8e6);
#endif
    spar_session_destroy(&r.session);
    forget(file[0]);
}

int main(int argc, char **argv) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(kept_on_one_rank),
                                       cmocka_unit_test(same_file),
                                       cmocka_unit_test(other_ranks),
                                       cmocka_unit_test(order_in_uneven_steps),
                                       cmocka_unit_test(no_room),
                                       cmocka_unit_test(damaged),
                                       cmocka_unit_test(memory)};
    ranks_begin(argc, argv);
    for (int k = 0; k < 2; k++) {
        snprintf(file[k], sizeof file[k], "mpi_save_%d_%d.spar", size, k);
    }
    return ranks_end(cmocka_run_group_tests(tests, NULL, NULL));
}
