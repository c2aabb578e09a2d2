/* What the ranks send each other in a coupling iteration (solve, push, check), counted by standing in for the
   collective calls (the profiling interface of MPI). No times: there may be more ranks than processors.

       mpiexec -np R ranks [--members M] [--nodes P] [--touch K] [--scheme 0..3] [--reproducible] [--touched]
                       [--header]

   M beams (default 1) of P nodes (default 10), each with one fluid node on K ranks (default: all), from rank i K on for
   member i; the scheme a SPAR_COUPLING_*; --touched: option ranks.state. One line of figures per iteration, each as its
   mean over the ranks and the most of any: collective calls; those of more than 64 bytes, which carry data and not a
   status alone; rounds, the sum of log2 of the ranks in each call, rounded up: the messages one after the other where a
   call is a tree; and payload, bytes: what a rank gives to or takes from the calls. */
#include <spar/spar.h>
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

enum { STEPS = 3, ITERATIONS = 4, MOST_MEMBERS = 10000, STATUS = 64, KINDS = 4 };

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
COUNTED(Ireduce, n,
        (const void *from, void *to, int n, MPI_Datatype type, MPI_Op op, int root, MPI_Comm comm,
         MPI_Request *request),
        (from, to, n, type, op, root, comm, request))
COUNTED(Iallreduce, n,
        (const void *from, void *to, int n, MPI_Datatype type, MPI_Op op, MPI_Comm comm, MPI_Request *request),
        (from, to, n, type, op, comm, request))
COUNTED(Ibcast, n, (void *x, int n, MPI_Datatype type, int root, MPI_Comm comm, MPI_Request *request),
        (x, n, type, root, comm, request))

/* ---- the scene ---- */

typedef struct options {
    int members, nodes, touch, scheme, reproducible, touched, header;
} options;

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

static void build(spar_session *s, const options *o, int rank, int size, spar_fluid **fluid) {
    for (int i = 0; i < o->members; i++) {
        const double tip[3] = {1, i, 0};
        spar_member *beam;
        int here = (rank - i * o->touch % size + size) % size < o->touch;
        create_beam(s, o, i, &beam);
        check(s, spar_fluid_create(beam, "tip", &fluid[i]));
        check(s, spar_fluid_set_motion_nodes(fluid[i], here, here ? tip : NULL));
        check(s, spar_fluid_set_force_nodes(fluid[i], here, here ? tip : NULL));
        check(s, spar_fluid_map(fluid[i]));
    }
}

/* Every iteration changes the loads, so a step has as many as it may. */
static void iterate(spar_session *s, const options *o, spar_fluid **fluid, int step) {
    int done = 0;
    for (int k = 0; k < ITERATIONS && !done; k++) {
        check(s, spar_step_solve(s));
        for (int i = 0; i < o->members; i++) {
            const double force[3] = {0, sin(i + step + 0.1 * k), cos(2.0 * i + 3 * k)};
            double x[3] = {0};
            check(s, spar_fluid_pull_motion(fluid[i], 1, x, NULL));
            check(s, spar_fluid_push_forces(fluid[i], force, NULL));
        }
        check(s, spar_step_check(s, &done));
        done = done && o->scheme != SPAR_COUPLING_EXPLICIT; /* an explicit step may be iterated by its host */
    }
}

static void measure(spar_session *s, const options *o, spar_fluid **fluid, double mine[KINDS]) {
    memset(mine, 0, KINDS * sizeof *mine);
    for (int step = 0; step < STEPS; step++) {
        check(s, spar_step_begin(s, 0.01));
        tally was = counted;
        iterate(s, o, fluid, step);
        tally now = counted;
        check(s, spar_step_accept(s));
        if (step > 0) { /* the first one may set up what the others use */
            const double of[KINDS] = {now.calls - was.calls, now.data - was.data, now.rounds - was.rounds,
                                      now.payload - was.payload};
            for (int k = 0; k < KINDS; k++) {
                mine[k] += of[k] / (ITERATIONS * (STEPS - 1));
            }
        }
    }
}

static void print(const options *o, int size, const double *sum, const double *most) {
    if (o->header) {
        printf("ranks,members,nodes,touch,scheme,reproducible,state,calls,calls most,data calls,data calls most,rounds,"
               "rounds most,payload,payload most\n");
    }
    printf("%d,%d,%d,%d,%d,%d,%s", size, o->members, o->nodes, o->touch, o->scheme, o->reproducible,
           o->touched ? "touched" : "all");
    for (int k = 0; k < KINDS; k++) {
        printf(",%.8g,%.8g", sum[k] / size, most[k]);
    }
    printf("\n");
}

static int read_options(int argc, char **argv, int size, options *o) {
    const struct {
        const char *name;
        int *value, least, most;
    } all[] = {{"--members", &o->members, 1, MOST_MEMBERS},
               {"--nodes", &o->nodes, 2, 64},
               {"--touch", &o->touch, 1, size},
               {"--scheme", &o->scheme, SPAR_COUPLING_EXPLICIT, SPAR_COUPLING_IQN_ILS}};
    const struct {
        const char *name;
        int *value;
    } flags[] = {{"--reproducible", &o->reproducible}, {"--touched", &o->touched}, {"--header", &o->header}};
    *o = (options){1, 10, size, SPAR_COUPLING_IQN_ILS, 0, 0, 0};
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

int main(int argc, char **argv) {
    int rank, size;
    options o;
    double mine[KINDS], sum[KINDS], most[KINDS];
    spar_session *s = NULL;
    MPI_Init(&argc, &argv);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    MPI_Comm_size(MPI_COMM_WORLD, &size);
    if (!read_options(argc, argv, size, &o)) {
        if (rank == 0) {
            fprintf(stderr,
                    "usage: ranks [--members 1..%d] [--nodes 2..64] [--touch 1..ranks] [--scheme 0..3] "
                    "[--reproducible] [--header]\n",
                    MOST_MEMBERS);
        }
        MPI_Finalize();
        return 1;
    }
    spar_fluid **fluid = calloc((size_t)o.members, sizeof *fluid);
    check(NULL, fluid ? spar_session_create_mpi(MPI_COMM_WORLD, &s) : SPAR_ERR_MEMORY);
    check(s, spar_session_set_coupling(s, o.scheme, 0, 0, ITERATIONS));
    check(s, spar_session_set_option(s, "coupling.unconverged", "accept"));
    check(s, spar_session_set_option(s, "coupling.patience", "1000000"));
    check(s, spar_session_set_option(s, "ranks.state", o.touched ? "touched" : "all"));
    check(s, spar_session_set_reproducible(s, o.reproducible));
    build(s, &o, rank, size, fluid);
    measure(s, &o, fluid, mine);
    PMPI_Reduce(mine, sum, KINDS, MPI_DOUBLE, MPI_SUM, 0, MPI_COMM_WORLD);
    PMPI_Reduce(mine, most, KINDS, MPI_DOUBLE, MPI_MAX, 0, MPI_COMM_WORLD);
    if (rank == 0) {
        print(&o, size, sum, most);
    }
    spar_session_destroy(&s);
    free(fluid);
    MPI_Finalize();
    return 0;
}
#endif
