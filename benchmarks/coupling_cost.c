/* What the coupling layer costs by itself: microseconds of spar_step_check per iteration (loads of all fluids summed,
   residual, next loads) and memory of a session in step, over the number of members, for each scheme. Members are
   external beams of 10 nodes with one fluid node each, so that there is no structure to solve; the pushes are not
   counted.

   coupling_cost [iterations a step, default 10]      a table; the median over the steps */
#define _GNU_SOURCE
#include <malloc.h>
#include <math.h>
#include <spar/spar.h>
#include <spar/spar_coupling.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { STEPS = 9, NODES = 10 };

static void check(const spar_session *s, int status) {
    if (status != SPAR_OK) {
        fprintf(stderr, "coupling_cost: %s: %s\n", spar_status_text(status), spar_session_message(s));
        exit(1);
    }
}

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec * 1e6 + (double)t.tv_nsec * 1e-3;
}

static int ascending(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void build(spar_session *s, int members, spar_member **member, spar_fluid **fluid) {
    const double eta[2] = {0, 1};
    for (int i = 0; i < members; i++) {
        double xyz[6] = {0, i, 0, 1, i, 0}, x[3] = {0.7, i, 0.1};
        char name[16];
        snprintf(name, sizeof name, "m%d", i);
        check(s, spar_beam_create(s, name, 1, NODES, &member[i]));
        check(s, spar_beam_set_axis(member[i], 2, eta, xyz, NULL));
        check(s, spar_member_set_external(member[i], 1));
        check(s, spar_member_commit(member[i]));
        check(s, spar_fluid_create(member[i], name, &fluid[i]));
        check(s, spar_fluid_set_force_nodes(fluid[i], 1, x));
        check(s, spar_fluid_map(fluid[i]));
    }
}

/* Iterations that each change the loads; nothing converges, so that a step has as many as were asked for. */
static void measure(int members, int scheme, int iterations, double *us, double *kib) {
    spar_session *s = NULL;
    spar_member **member = calloc((size_t)members, sizeof *member);
    spar_fluid **fluid = calloc((size_t)members, sizeof *fluid);
    double took[STEPS];
    check(NULL, spar_session_create(&s));
    size_t before = mallinfo2().uordblks + mallinfo2().hblkhd;
    check(s, spar_session_set_coupling(s, scheme, 0, 0, iterations));
    check(s, spar_session_set_option(s, "coupling.unconverged", "accept"));
    check(s, spar_session_set_option(s, "coupling.patience", "1000000"));
    build(s, members, member, fluid);
    for (int step = 0; step < STEPS; step++) {
        int done = 0, count = 0;
        took[step] = 0;
        check(s, spar_step_begin(s, 0.01));
        while (!done) {
            check(s, spar_step_solve(s));
            for (int i = 0; i < members; i++) {
                double f[3] = {sin(1.0 * i + step + 0.1 * count), cos(2.0 * i + 3.0 * count), 0.5 * count};
                check(s, spar_fluid_push_forces(fluid[i], f, NULL));
            }
            double start = now();
            check(s, spar_step_check(s, &done));
            took[step] += now() - start;
            count++;
        }
        took[step] /= count;
        check(s, spar_step_accept(s));
    }
    qsort(took, STEPS, sizeof *took, ascending);
    *us = took[STEPS / 2];
    *kib = (double)(mallinfo2().uordblks + mallinfo2().hblkhd - before) / 1024;
    spar_session_destroy(&s);
    free(member);
    free(fluid);
}

int main(int argc, char **argv) {
    static const int counts[] = {1, 3, 10, 30, 100, 300, 1000};
    static const char *const name[] = {"explicit", "fixed point", "Aitken", "IQN-ILS"};
    int iterations = argc > 1 ? atoi(argv[1]) : 10;
    if (iterations < 1) {
        fprintf(stderr, "usage: coupling_cost [iterations a step, at least 1]\n");
        return 1;
    }
    printf("spar_step_check, %d iterations a step, members of %d nodes\n", iterations, NODES);
    printf("%8s", "members");
    for (int k = 0; k < 4; k++) {
        printf("%14s us%10s", name[k], "KiB");
    }
    printf("\n");
    for (size_t c = 0; c < sizeof counts / sizeof *counts; c++) {
        printf("%8d", counts[c]);
        for (int scheme = SPAR_COUPLING_EXPLICIT; scheme <= SPAR_COUPLING_IQN_ILS; scheme++) {
            double us, kib;
            measure(counts[c], scheme, iterations, &us, &kib);
            printf("%17.1f%10.0f", us, kib);
        }
        printf("\n");
        fflush(stdout);
    }
    return 0;
}
