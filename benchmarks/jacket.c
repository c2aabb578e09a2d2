/* What many welded beams cost: a jacket of storeys of 12 beams (four legs, and two braces on each side that pass each
   other), fixed at the ground, pushed at its top.

   jacket [BEAMS, default 108]   CSV: beams, unknowns, seconds of the first step, microseconds a beam and step of the
                                 next ten, seconds of 20 modes; processor time */
#include <spar/spar.h>
#include <spar/spar_structure.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { NODES = 5, TIP = NODES - 1, BAY = 12, MODES = 20, STEPS = 10 };

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void need(const spar_session *s, int status) {
    if (status != SPAR_OK) {
        fprintf(stderr, "jacket: %s: %s\n", spar_status_text(status), spar_session_message(s));
        exit(1);
    }
}

/* A leg (k < 4) or brace of a storey: its corners below and above. */
static void corners(int k, int *from, int *to) {
    *from = k < 4 ? k : (k / 2 + k % 2) % 4;
    *to = k < 4 ? k : (k / 2 + 1 - k % 2) % 4;
}

static spar_member *add_beam(spar_session *s, int i) {
    static const double corner[4][2] = {{-5, -5}, {5, -5}, {5, 5}, {-5, 5}}, eta[2] = {0, 1}, height = 6;
    int from, to, bay = i / BAY;
    double leg = i % BAY < 4 ? 4e9 : 2e8, K[36] = {0}, M[36] = {0};
    const double stiffness[6] = {50, 10, 10, 0.8, 1, 1}, mass[6] = {200, 200, 200, 20, 10, 10};
    char name[32];
    spar_member *b = NULL;
    corners(i % BAY, &from, &to);
    const double xyz[6] = {corner[from][0], corner[from][1], height * bay,
                           corner[to][0],   corner[to][1],   height * bay + height};
    for (int k = 0; k < 6; k++) {
        K[7 * k] = stiffness[k] * leg, M[7 * k] = mass[k];
    }
    snprintf(name, sizeof name, "beam%d", i);
    need(s, spar_beam_create(s, name, 1, NODES, &b));
    need(s, spar_beam_set_axis(b, 2, eta, xyz, NULL));
    need(s, spar_beam_set_sections(b, 1, eta, K, M));
    need(s, spar_member_set_root(b, bay ? SPAR_ROOT_FREE : SPAR_ROOT_FIXED));
    need(s, spar_member_commit(b));
    return b;
}

static void weld(spar_session *s, int i, spar_member *b, int node, spar_member *to) {
    char name[32];
    spar_joint *j = NULL;
    snprintf(name, sizeof name, "weld%d.%d", i, node);
    need(s, spar_joint_create(s, name, b, node, to, TIP, 0, &j));
}

/* Returns the last leg. */
static spar_member *build(spar_session *s, int beams) {
    spar_member *below[4] = {NULL}, *leg[4] = {NULL};
    for (int i = 0; i < beams; i++) {
        int from, to, k = i % BAY;
        corners(k, &from, &to);
        spar_member *b = add_beam(s, i);
        if (k < 4) {
            leg[k] = b;
        } else {
            weld(s, i, b, TIP, leg[to]);
        }
        if (i >= BAY) {
            weld(s, i, b, 0, below[from]);
        }
        if (k == BAY - 1) {
            memcpy(below, leg, sizeof below);
        }
    }
    return leg[3];
}

int main(int argc, char **argv) {
    int beams = (argc > 1 ? atoi(argv[1]) : 108) / BAY * BAY;
    double push[6] = {1e4, 0, 0, 0, 0, 0}, hertz[MODES], took[3];
    spar_session *s = NULL;
    if (beams < BAY) {
        fprintf(stderr, "jacket: give a multiple of %d beams\n", BAY);
        return 1;
    }
    need(s, spar_session_create(&s));
    spar_member *leg = build(s, beams);
    double since = now();
    need(s, spar_member_solve_modes(leg, MODES, hertz, NULL));
    took[2] = now() - since;
    need(s, spar_member_set_load(leg, TIP, SPAR_LOAD_DEAD, push));
    since = now();
    need(s, spar_step(s, 0.01, NULL, NULL, NULL));
    took[0] = now() - since;
    since = now();
    for (int i = 0; i < STEPS; i++) {
        need(s, spar_step(s, 0.01, NULL, NULL, NULL));
    }
    took[1] = now() - since;
    printf("beams,unknowns,first step s,step us a beam,20 modes s\n");
    printf("%d,%d,%.4f,%.1f,%.3f\n", beams, 6 * NODES * beams - 6 * BAY, took[0], 1e6 * took[1] / STEPS / beams,
           took[2]);
    spar_session_destroy(&s);
    return 0;
}
