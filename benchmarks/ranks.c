/* What the ranks send each other in a coupling iteration (solve, push, check), counted by standing in for the
   collective calls (the profiling interface of MPI). No times: there may be more ranks than processors.

       mpiexec -np R ranks [--members M] [--nodes P] [--touch K] [--fluid F] [--scheme 0..3] [--reproducible]
                       [--steps S] [--header]
       mpiexec -np 2 ranks --ping

   M beams (default 1) of P nodes (default 10), each with F fluid nodes (default 1) on each of K ranks (default: all),
   from rank i K on for member i; the scheme a SPAR_COUPLING_*. One line of figures per iteration, each as its mean over
   the ranks and the most of any: collective calls; those of more than 64 bytes, which carry data and not a status
   alone; rounds, the sum of log2 of the ranks in each call, rounded up: the messages one after the other where a call
   is a tree; payload, bytes: what a rank gives to or takes from the calls. At the end the median of an iteration's
   seconds on rank 0, over S steps (default 3; times want more, and processors to themselves). Under callgrind the
   instructions of these steps are dumped, of each rank; run-ranks leaves out those within MPI, where ranks wait in a
   loop.

   --ping: seconds of a message of 8 bytes between ranks 0 and 1, and bytes a second of one of 4 MB: half of there and
   back, the least and the median of many. */
#include <spar/spar.h>
#include <spar/spar_coupling.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifndef SPAR_WITH_MPI
int main(void) {
    printf("ranks: this build has no MPI\n");
    return 0;
}
#else

#include <math.h>
#include <spar/spar_mpi.h>

#ifdef __has_include
#if __has_include(<valgrind/callgrind.h>)
#include <valgrind/callgrind.h>
#define COUNTS 1
#endif
#endif

enum { ITERATIONS = 4, MOST_MEMBERS = 10000, MOST_STEPS = 10000, MOST_FLUID = 1000000, STATUS = 64, KINDS = 4 };

/* ---- the calls ---- */

typedef struct tally {
    double calls, data, rounds, payload;
} tally;

static tally counted;

static void count(MPI_Comm comm, double items, MPI_Datatype type) {
    int size, bytes, rounds = 0;
    PMPI_Comm_size(comm, &size);
    PMPI_Type_size(type, &bytes);
    while (1 << rounds < size) {
        rounds++;
    }
    counted.calls++;
    counted.data += items * bytes > STATUS;
    counted.rounds += rounds;
    counted.payload += items * bytes;
}

static double total(const int counts[], MPI_Comm comm) {
    int size;
    double all = 0;
    PMPI_Comm_size(comm, &size);
    for (int r = 0; r < size; r++) {
        all += counts[r];
    }
    return all;
}

/* The library's call of that name comes here, is counted, and goes on to MPI's own. */
#define COUNTED(call, items, parameters, arguments)                                                                    \
    int MPI_##call parameters {                                                                                        \
        count(comm, items, type);                                                                                      \
        return PMPI_##call arguments;                                                                                  \
    }
COUNTED(Allreduce, n, (const void *from, void *to, int n, MPI_Datatype type, MPI_Op op, MPI_Comm comm),
        (from, to, n, type, op, comm))
COUNTED(Reduce, n, (const void *from, void *to, int n, MPI_Datatype type, MPI_Op op, int root, MPI_Comm comm),
        (from, to, n, type, op, root, comm))
COUNTED(Bcast, n, (void *x, int n, MPI_Datatype type, int root, MPI_Comm comm), (x, n, type, root, comm))
COUNTED(Allgatherv, total(counts, comm),
        (const void *from, int n, MPI_Datatype of, void *to, const int counts[], const int offsets[], MPI_Datatype type,
         MPI_Comm comm),
        (from, n, of, to, counts, offsets, type, comm))

/* ---- the scene ---- */

typedef struct options {
    int members, nodes, touch, fluid, scheme, steps, reproducible, header, ping;
} options;

/* A fluid and its nodes here: along the outer half of the beam. */
typedef struct wet {
    spar_fluid *fluid;
    int n;
    double *x, *force; /* [n][3] */
} wet;

static void check(const spar_session *s, int status) {
    if (status != SPAR_OK) {
        fprintf(stderr, "ranks: %s: %s\n", spar_status_text(status), spar_session_message(s));
        MPI_Abort(MPI_COMM_WORLD, 1);
    }
}

static void create_beam(spar_session *s, const options *o, int i, spar_member **beam) {
    static const double eta[2] = {0, 1};
    const double xyz[6] = {0, i, 0, 1, i, 0};
    double K[36] = {0}, M[36] = {0};
    char name[16];
    for (int k = 0; k < 6; k++) {
        K[7 * k] = k < 3 ? 1e6 : 1e3;
        M[7 * k] = k < 3 ? 10 : 0.1;
    }
    snprintf(name, sizeof name, "m%d", i);
    check(s, spar_beam_create(s, name, 1, o->nodes, beam));
    check(s, spar_beam_set_axis(*beam, 2, eta, xyz, NULL));
    check(s, spar_beam_set_sections(*beam, 1, eta, K, M));
    check(s, spar_member_set_root(*beam, SPAR_ROOT_FIXED));
    check(s, spar_member_commit(*beam));
}

static void build(spar_session *s, const options *o, int rank, int size, wet *all) {
    for (int i = 0; i < o->members; i++) {
        spar_member *beam;
        wet *w = all + i;
        w->n = (rank - i * o->touch % size + size) % size < o->touch ? o->fluid : 0;
        w->x = calloc(6 * (size_t)w->n + 1, sizeof *w->x);
        w->force = w->x ? w->x + 3 * w->n : NULL;
        check(NULL, w->x ? SPAR_OK : SPAR_ERR_MEMORY);
        for (int k = 0; k < w->n; k++) {
            w->x[3 * k] = 1 - 0.5 * k / o->fluid, w->x[3 * k + 1] = i;
        }
        create_beam(s, o, i, &beam);
        check(s, spar_fluid_create(beam, "tip", &w->fluid));
        check(s, spar_fluid_set_motion_nodes(w->fluid, w->n, w->x));
        check(s, spar_fluid_set_force_nodes(w->fluid, w->n, w->x));
        check(s, spar_fluid_map(w->fluid));
    }
}

/* Every iteration changes the loads, so a step has as many as it may. */
static void iterate(spar_session *s, const options *o, wet *all, int step) {
    int done = 0;
    for (int k = 0; k < ITERATIONS && !done; k++) {
        check(s, spar_step_solve(s));
        for (int i = 0; i < o->members; i++) {
            wet *w = all + i;
            check(s, spar_fluid_pull_motion(w->fluid, 1, w->x, NULL));
            for (int j = 0; j < w->n; j++) {
                w->force[3 * j + 1] = sin(i + step + 0.1 * k) / o->fluid;
                w->force[3 * j + 2] = cos(2.0 * i + 3 * k) / o->fluid;
            }
            check(s, spar_fluid_push_forces(w->fluid, w->force, NULL));
        }
        check(s, spar_step_check(s, &done));
        done = done && o->scheme != SPAR_COUPLING_EXPLICIT; /* an explicit step may be iterated by its host */
    }
}

static int by_size(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(double *x, int n) {
    qsort(x, (size_t)n, sizeof *x, by_size);
    return n % 2 ? x[n / 2] : 0.5 * (x[n / 2 - 1] + x[n / 2]);
}

/* The first step may set up what the others use. Returns the median of an iteration's seconds. */
static double measure(spar_session *s, const options *o, wet *all, double mine[KINDS]) {
    double *seconds = calloc((size_t)o->steps, sizeof *seconds);
    check(NULL, seconds ? SPAR_OK : SPAR_ERR_MEMORY);
    memset(mine, 0, KINDS * sizeof *mine);
    for (int step = 0; step <= o->steps; step++) {
#ifdef COUNTS
        if (step == 1) {
            CALLGRIND_ZERO_STATS;
        }
#endif
        check(s, spar_step_begin(s, 0.01));
        tally was = counted;
        double since = MPI_Wtime();
        iterate(s, o, all, step);
        since = MPI_Wtime() - since;
        tally now = counted;
        check(s, spar_step_accept(s));
        if (step > 0) {
            const double of[KINDS] = {now.calls - was.calls, now.data - was.data, now.rounds - was.rounds,
                                      now.payload - was.payload};
            for (int k = 0; k < KINDS; k++) {
                mine[k] += of[k] / (ITERATIONS * o->steps);
            }
            seconds[step - 1] = since / ITERATIONS;
        }
    }
#ifdef COUNTS
    CALLGRIND_DUMP_STATS_AT("steps");
#endif
    double middle = median(seconds, o->steps);
    free(seconds);
    return middle;
}

/* ---- a message there and back ---- */

/* Least and median of `count` times of a message of so many bytes, one way. */
static void bounce(int rank, char *data, int bytes, int count, double found[2]) {
    double *seconds = calloc((size_t)count, sizeof *seconds);
    check(NULL, seconds ? SPAR_OK : SPAR_ERR_MEMORY);
    for (int k = -10; k < count && rank < 2; k++) { /* the first ones set up */
        double since = MPI_Wtime();
        for (int way = 0; way < 2; way++) {
            if (way == rank) {
                MPI_Send(data, bytes, MPI_CHAR, 1 - rank, 0, MPI_COMM_WORLD);
            } else {
                MPI_Recv(data, bytes, MPI_CHAR, 1 - rank, 0, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
            }
        }
        if (k >= 0) {
            seconds[k] = 0.5 * (MPI_Wtime() - since);
        }
    }
    found[1] = median(seconds, count);
    found[0] = seconds[0];
    free(seconds);
}

static void ping(int rank) {
    enum { LARGE = 4 << 20, SMALL = 8 };
    double few[2], many[2];
    char *data = calloc(LARGE, 1);
    check(NULL, data ? SPAR_OK : SPAR_ERR_MEMORY);
    bounce(rank, data, SMALL, 10000, few);
    bounce(rank, data, LARGE, 200, many);
    free(data);
    if (rank == 0) {
        printf("%d bytes: %.3g us at least, %.3g us median\n", SMALL, 1e6 * few[0], 1e6 * few[1]);
        printf("%d MB: %.3g GB/s at most, %.3g GB/s median\n", LARGE >> 20, 1e-9 * LARGE / many[0],
               1e-9 * LARGE / many[1]);
    }
}

static void print(const options *o, int size, const double *sum, const double *most, double seconds) {
    if (o->header) {
        printf("ranks,members,nodes,touch,fluid,scheme,reproducible,calls,calls most,data calls,data calls most,"
               "rounds,rounds most,payload,payload most,seconds\n");
    }
    printf("%d,%d,%d,%d,%d,%d,%d", size, o->members, o->nodes, o->touch, o->fluid, o->scheme, o->reproducible);
    for (int k = 0; k < KINDS; k++) {
        printf(",%.8g,%.8g", sum[k] / size, most[k]);
    }
    printf(",%.3g\n", seconds);
}

static int read_options(int argc, char **argv, int size, options *o) {
    const struct {
        const char *name;
        int *value, least, most;
    } all[] = {{"--members", &o->members, 1, MOST_MEMBERS},
               {"--nodes", &o->nodes, 2, 64},
               {"--touch", &o->touch, 1, size},
               {"--fluid", &o->fluid, 1, MOST_FLUID},
               {"--steps", &o->steps, 1, MOST_STEPS},
               {"--scheme", &o->scheme, SPAR_COUPLING_EXPLICIT, SPAR_COUPLING_IQN_ILS}};
    const struct {
        const char *name;
        int *value;
    } flags[] = {{"--reproducible", &o->reproducible}, {"--header", &o->header}, {"--ping", &o->ping}};
    *o = (options){.members = 1, .nodes = 10, .touch = size, .fluid = 1, .scheme = SPAR_COUPLING_IQN_ILS, .steps = 3};
    for (int i = 1; i < argc; i++) {
        int known = 0;
        for (size_t k = 0; k < sizeof all / sizeof *all && i + 1 < argc; k++) {
            if (strcmp(argv[i], all[k].name) == 0) {
                *all[k].value = atoi(argv[++i]);
                known = *all[k].value >= all[k].least && *all[k].value <= all[k].most;
                break;
            }
        }
        for (size_t k = 0; k < sizeof flags / sizeof *flags && !known; k++) {
            if (strcmp(argv[i], flags[k].name) == 0) {
                known = *flags[k].value = 1;
            }
        }
        if (!known) {
            return 0;
        }
    }
    return 1;
}

static void play(const options *o, int rank, int size) {
    double mine[KINDS], sum[KINDS], most[KINDS];
    spar_session *s = NULL;
    wet *all = calloc((size_t)o->members, sizeof *all);
    check(NULL, all ? spar_session_create_mpi(MPI_COMM_WORLD, &s) : SPAR_ERR_MEMORY);
    check(s, spar_session_set_coupling(s, o->scheme, 0, 0, ITERATIONS));
    check(s, spar_session_set_option(s, "coupling.unconverged", "accept"));
    check(s, spar_session_set_option(s, "coupling.patience", "1000000"));
    check(s, spar_session_set_reproducible(s, o->reproducible));
    build(s, o, rank, size, all);
    double seconds = measure(s, o, all, mine);
    PMPI_Reduce(mine, sum, KINDS, MPI_DOUBLE, MPI_SUM, 0, MPI_COMM_WORLD);
    PMPI_Reduce(mine, most, KINDS, MPI_DOUBLE, MPI_MAX, 0, MPI_COMM_WORLD);
    if (rank == 0) {
        print(o, size, sum, most, seconds);
    }
    spar_session_destroy(&s);
    for (int i = 0; i < o->members; i++) {
        free(all[i].x);
    }
    free(all);
}

int main(int argc, char **argv) {
    int rank, size;
    options o;
    MPI_Init(&argc, &argv);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    MPI_Comm_size(MPI_COMM_WORLD, &size);
    int known = read_options(argc, argv, size, &o) && (!o.ping || size > 1);
    if (!known && rank == 0) {
        fprintf(stderr,
                "usage: ranks [--members 1..%d] [--nodes 2..64] [--touch 1..ranks] [--fluid 1..%d] [--scheme 0..3] "
                "[--reproducible] [--steps 1..%d] [--header]; or, on 2 ranks: --ping\n",
                MOST_MEMBERS, MOST_FLUID, MOST_STEPS);
    } else if (known && o.ping) {
        ping(rank);
    } else if (known) {
        play(&o, rank, size);
    }
    MPI_Finalize();
    return !known;
}
#endif
