/* Nodes on a point: what a pull of places and velocities and a push of forces cost beside the loop of a rigid transfer.

     point count   "what|state|thousands of nodes|", as effects count. Valgrind's vectors are four doubles long; so are
                   those of the native loop. */
#include "plain.h"
#include "watch.h"
#include <math.h>
#include <spar/spar.h>
#include <spar/spar_coupling.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { N = 100000 };

static double node[N][3], force[N][3], x[N][3], v[N][3], y[N][3], u[N][3];
static const double rates[6] = {1, 2, 3, 0.1, 0.2, 1.2}, half = 0.4;
static spar_session *session;
static spar_fluid *fluid;
static plain_rigid rigid;

static void must(int status, const char *what) {
    if (status != SPAR_OK) {
        fprintf(stderr, "point: %s: %s\n", what, spar_session_message(session));
        exit(1);
    }
}
#define MUST(call) must(call, #call)

/* A point turned about z and moved, its nodes around it. */
static void make(void) {
    const double place[3] = {1, -2, 0.5}, q[7] = {0.3, 0.2, 0.1, cos(half), 0, 0, sin(half)};
    spar_member *member;
    for (int j = 0; j < N; j++) {
        double t = 0.01 * j;
        node[j][0] = place[0] + cos(t), node[j][1] = place[1] + sin(t), node[j][2] = place[2] + 1e-5 * j;
        force[j][0] = 1, force[j][1] = cos(3 * t), force[j][2] = sin(t);
    }
    MUST(spar_session_create(&session));
    MUST(spar_point_create(session, "point", place, NULL, &member));
    MUST(spar_member_commit(member));
    MUST(spar_member_set_motion(member, q, rates, NULL));
    MUST(spar_fluid_create(member, "around", &fluid));
    MUST(spar_fluid_set_option(fluid, "audit", "off"));
    MUST(spar_fluid_set_motion_nodes(fluid, N, node[0]));
    MUST(spar_fluid_set_force_nodes(fluid, N, node[0]));
    MUST(spar_fluid_map(fluid));
    double R[9] = {cos(2 * half), -sin(2 * half), 0, sin(2 * half), cos(2 * half), 0, 0, 0, 1};
    rigid = (plain_rigid){.n = N, .con = node[0]}; /* arms take the places' place */
    for (int i = 0; i < 3; i++) {
        rigid.x[i] = place[i] + q[i], rigid.v[i] = rates[i], rigid.omega[i] = rates[3 + i];
        for (int j = 0; j < N; j++) {
            node[j][i] -= place[i];
        }
    }
    memcpy(rigid.R, R, sizeof R);
}

static void say(const char *what, const char *state) {
    printf("%s|%s|%d|\n", what, state, N / 1000); /* a thousand nodes are a step */
}

static void count(void) {
    double load[2][6];
    count_begin();
    MUST(spar_fluid_pull_motion(fluid, 1, x[0], v[0]));
    count_end();
    say("pull", "library");
    count_begin();
    plain_rigid_motion_portable(&rigid, y[0], u[0]);
    count_end();
    say("pull", "loop, library flags");
    count_begin();
    plain_rigid_motion_native(&rigid, y[0], u[0]);
    count_end();
    say("pull", "loop, four lanes");
    count_begin();
    MUST(spar_fluid_push_forces(fluid, force[0], NULL));
    count_end();
    say("push", "library");
    count_begin();
    plain_rigid_loads_portable(&rigid, force[0], load[0]);
    count_end();
    say("push", "loop, library flags");
    count_begin();
    plain_rigid_loads_native(&rigid, force[0], load[1]);
    count_end();
    say("push", "loop, four lanes");
    for (int j = 0; j < N; j++) { /* or the comparison is worth nothing */
        for (int i = 0; i < 3; i++) {
            if (!(fabs(x[j][i] - y[j][i]) < 1e-13 && fabs(v[j][i] - u[j][i]) < 1e-13)) {
                fprintf(stderr, "point: the loop puts node %d elsewhere\n", j);
                exit(1);
            }
        }
    }
    if (!(fabs(load[0][3] - load[1][3]) < 1e-8 * N)) {
        fprintf(stderr, "point: the loops differ\n");
        exit(1);
    }
}

int main(int argc, char **argv) {
    if (argc != 2 || strcmp(argv[1], "count") != 0) {
        fprintf(stderr, "point count\n");
        return 2;
    }
    make();
    count();
    spar_session_destroy(&session);
    return 0;
}
