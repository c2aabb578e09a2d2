/* Every allocation of the scenes (scenario.c) failed once: the call that meets it answers SPAR_ERR_MEMORY with a
   message, the other ranks SPAR_ERR_PEER, or it does without; made again it succeeds; the numbers at the end are those
   of the run without failure to the last bit; nothing is left over. No step takes memory, but the first two. Each
   public function must be part of a scene.

     memory [short | shortest | long] [act]      short: some of the allocations only, evenly spread, 40 of each act;
                                                 shortest: 12. Under mpirun each rank in turn
 */
#include "alloc.h"
#include "scenario.h"
#include "torture/calls.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#ifdef SPARI_HAVE_MPI
#include <mpi.h>
#endif

static int rank, ranks = 1;

static int64_t sum_of(int64_t x) {
#ifdef SPARI_HAVE_MPI
    if (ranks > 1) {
        int64_t all = 0;
        MPI_Allreduce(&x, &all, 1, MPI_INT64_T, MPI_SUM, MPI_COMM_WORLD);
        return all;
    }
#endif
    return x;
}

/* That of one rank, on all. */
static int64_t told_by(int who, int64_t x) {
    return sum_of(rank == who ? x : 0);
}

static int play(const act *a, int64_t fail_at, uint64_t *digest) {
    scenario_begin();
    alloc_begin(fail_at);
    a->run();
    *digest = scenario_digest();
    /* what GSL 2.7 forgets where its own second allocation fails (gsl_matrix_alloc and others) is not ours */
    int64_t left =
        alloc_live(ALLOC_OWN) + alloc_live(ALLOC_LIBC) + (alloc_hit() == ALLOC_GSL ? 0 : alloc_live(ALLOC_GSL));
    if (left > 0) {
        char text[120];
        (void)snprintf(text, sizeof text, "%lld blocks are left over, the first is number %lld", (long long)left,
                       (long long)alloc_oldest());
        scenario_complain(a->name, text);
    }
    return scenario_complaints();
}

/* One act, every stride-th allocation of one rank failed; answers the number of faults. */
static int64_t torture(const act *a, int victim, int64_t stride, int64_t most) {
    uint64_t wanted, got;
    int64_t faults = 0, tried = 0;
    scenario_injecting(0);
    (void)play(a, 0, &wanted); /* what is set up once for all happens here */
    faults += sum_of(play(a, 0, &wanted));
    int64_t count = told_by(victim, alloc_counted());
    scenario_injecting(1);
    clock_t since = clock();
    for (int64_t k = 1; k <= count && (most == 0 || tried < most) && faults < 20; k += stride, tried++) {
        int own = play(a, rank == victim ? k : 0, &got);
        if (a->repeats && got != wanted) {
            scenario_complain(a->name, "the numbers are not those of a run without failure");
            own++;
        }
        if (sum_of(own) > 0) {
            faults++;
            if (rank == 0) {
                printf("  %s: allocation %lld of %lld on rank %d\n", a->name, (long long)k, (long long)count, victim);
            }
        }
    }
    if (rank == 0) {
        printf("%-9s rank %d: %5lld of %5lld allocations failed, %lld faults, %.1f s\n", a->name, victim,
               (long long)tried, (long long)count, (long long)faults, (double)(clock() - since) / CLOCKS_PER_SEC);
        (void)fflush(stdout);
    }
    return faults;
}

/* Number of public functions that no scene calls. A call that takes memory must be in one, and nothing else shows which
   do: so all must, but the one that needs MPI. */
static int missing(void) {
    int count = 0;
#define NAME(name) #name,
    static const char *const names[] = {SPAR_LOCAL_CALLS(NAME) SPAR_COLLECTIVE_CALLS(NAME)};
#undef NAME
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        if (!scenario_has_called(names[i]) && strcmp(names[i], "spar_session_create_fcomm") != 0) {
            printf("%s is part of no scene (tests/torture/memory/scenario.c)\n", names[i]);
            count++;
        }
    }
    return count;
}

static int64_t all_acts(int64_t brief, const char *only) {
    int64_t faults = 0;
    for (int i = 0; i < act_count; i++) {
        if (only && strcmp(only, acts[i].name) != 0) {
            continue;
        }
        for (int victim = 0; victim < ranks; victim++) {
            uint64_t digest;
            scenario_injecting(0);
            (void)play(&acts[i], 0, &digest);
            int64_t count = told_by(victim, alloc_counted()), few = ranks > 1 ? 8 : brief;
            /* the clock decides how many an act without repeats has: its beginning, then some */
            int64_t stride = brief && count > few ? count / few : acts[i].repeats ? 1 : count / 200 + 1;
            faults += torture(&acts[i], victim, stride, 0);
        }
    }
    return faults;
}

static int64_t one(const char *name, int64_t k, int victim, int64_t show) {
    uint64_t digest;
    int64_t faults = 0;
    for (int i = 0; i < act_count; i++) {
        if (strcmp(name, acts[i].name) == 0) {
            scenario_injecting(0);
            (void)play(&acts[i], 0, &digest);
            scenario_injecting(1);
            alloc_show(rank != victim ? 0 : show ? show : k);
            faults = sum_of(play(&acts[i], rank == victim ? k : 0, &digest));
        }
    }
    return faults;
}

int main(int argc, char **argv) {
    char folder[] = "/tmp/spar-memory-XXXXXX", command[80];
#ifdef SPARI_HAVE_MPI
    if (getenv("OMPI_COMM_WORLD_SIZE")) {
        MPI_Init(&argc, &argv);
        MPI_Comm_rank(MPI_COMM_WORLD, &rank);
        MPI_Comm_size(MPI_COMM_WORLD, &ranks);
    }
#endif
    int64_t brief = argc < 2 ? 0 : strcmp(argv[1], "short") == 0 ? 40 : strcmp(argv[1], "shortest") == 0 ? 12 : 0;
    if (!mkdtemp(folder)) {
        return 2;
    }
#ifdef SPARI_HAVE_MPI
    if (ranks > 1) { /* one folder for all: rank 0 writes what all read */
        MPI_Bcast(folder, (int)sizeof folder, MPI_CHAR, 0, MPI_COMM_WORLD);
    }
#endif
    alloc_with_libc(ranks == 1);
    scenario_set(rank, ranks, folder);
    int64_t faults = argc > 3
                         ? one(argv[2], atoll(argv[3]), argc > 4 ? atoi(argv[4]) : 0, argc > 5 ? atoll(argv[5]) : 0)
                         : all_acts(brief, argc > 2 ? argv[2] : NULL);
    if (rank == 0 && ranks == 1 && argc <= 2) {
        faults += missing();
    }
    (void)snprintf(command, sizeof command, "rm -rf %s", folder);
    if (rank == 0 && system(command) != 0) {
        printf("%s stays\n", folder);
    }
#ifdef SPARI_HAVE_MPI
    if (getenv("OMPI_COMM_WORLD_SIZE")) {
        MPI_Finalize();
    }
#endif
    return faults > 0;
}
