/* What a link of a chain costs: rigid links of 0.1 m on ball joints, hung at one end, fall from the horizontal; all of
   them are one system, solved in a band.
     chain                processor time a link and step of 10, 100 and 1000 links, and the system solutions a step
     chain LINKS STEPS    steps so many: the difference of two such runs under `valgrind --tool=callgrind` is the cost
                          of the steps between (benchmarks/run-joints does that) */
#include <math.h>
#include <spar/spar.h>
#include <spar/spar_coupling.h>
#include <spar/spar_structure.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

static const double length = 0.1, link_mass = 0.5, step = 2e-3;

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static int hang(spar_session *s, int links) {
    const double half = 0.5 * length, J = link_mass * length * length / 12, upright[4] = {1, 0, 0, 0};
    double mass[36] = {[16] = -link_mass * half, [11] = link_mass * half, [26] = -link_mass * half};
    spar_member *above = NULL;
    int status = SPAR_OK;
    mass[31] = mass[11];
    for (int i = 0; i < 3; i++) {
        mass[7 * i] = link_mass;
        mass[7 * (3 + i)] = i == 0 ? 0.1 * J : J + link_mass * half * half;
    }
    for (int i = 0; i < links && status == SPAR_OK; i++) {
        const double x[3] = {i * length, 0, 0};
        char name[32];
        spar_member *link = NULL;
        spar_joint *ball = NULL;
        snprintf(name, sizeof name, "link%d", i);
        status = spar_rigid_create(s, name, x, upright, mass, &link);
        status = status == SPAR_OK ? spar_member_commit(link) : status;
        status = status == SPAR_OK
                     ? spar_joint_create(s, name, link, 0, above, 0, SPAR_FREE_RX | SPAR_FREE_RY | SPAR_FREE_RZ, &ball)
                     : status;
        status = status == SPAR_OK ? spar_joint_set_frame(ball, x, upright) : status;
        above = link;
    }
    return status;
}

/* Processor time of a step. */
static int run(int links, int steps, double *seconds) {
    spar_session *s = NULL;
    int status = spar_session_create(&s);
    if (status == SPAR_OK && (status = spar_session_set_gravity(s, (double[]){0, 0, -9.81})) == SPAR_OK &&
        (status = spar_session_set_integrator(s, 0.9, 1)) == SPAR_OK) {
        status = hang(s, links);
    }
    status = status == SPAR_OK ? spar_step(s, step, NULL, NULL, NULL) : status; /* finds what is tied */
    double since = now();
    for (int i = 1; i < steps && status == SPAR_OK; i++) {
        status = spar_step(s, step, NULL, NULL, NULL);
    }
    *seconds = (now() - since) / (steps > 1 ? steps - 1 : 1);
    if (status != SPAR_OK) {
        fprintf(stderr, "chain: %s\n", spar_session_message(s));
    }
    spar_session_destroy(&s);
    return status;
}

int main(int argc, char **argv) {
    static const int links[3] = {10, 100, 1000}, steps[3] = {201, 101, 21};
    double seconds;
    if (argc == 3) {
        return run(atoi(argv[1]), atoi(argv[2]), &seconds) != SPAR_OK;
    }
    printf("links   microseconds a link and step\n");
    for (int k = 0; k < 3; k++) {
        if (run(links[k], steps[k], &seconds) != SPAR_OK) {
            return 1;
        }
        printf("%5d   %10.2f\n", links[k], 1e6 * seconds / links[k]);
    }
    return 0;
}
