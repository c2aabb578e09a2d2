/* What many joined members cost, in a system of their own each:
     jacket   storeys of 12 beams (four legs, and two braces on each side that pass each other), welded, fixed at the
              ground, pushed at the top
     grid     a square floor of beams welded at their crossings, fixed at its edge, under its weight
     hub      beams welded to one hub, a rigid body that gravity pulls down and a spring holds
     chain    rigid links of 0.1 m on ball joints, hung at one end, falling from the horizontal
     ring     the same, hung at both ends from a half circle
     windows  four-bar linkages in a row: upright bars of 1 m on hinges whose axes are parallel, which begin to fall;
              three constraints of each loop are redundant

   assemblies KIND MEMBERS [STEPS, default 10 [DT [FILE]]]
                                                 CSV: members, seconds of the first step, microseconds a member and step
                                                 of the next ones, memory in kB a member; processor time. The difference
                                                 of two such runs under `valgrind --tool=callgrind` is the cost of the
                                                 steps between (benchmarks/run-joints). FILE: a line for each member at
                                                 the end, displacement and rotation of its last node.
   assemblies modes MEMBERS                      the 20 lowest modes of a jacket: seconds */
#include <math.h>
#include <spar/spar.h>
#include <spar/spar_coupling.h>
#include <spar/spar_structure.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>

enum { NODES = 5, TIP = NODES - 1, BAY = 12, MODES = 20 };
static const double identity[4] = {1, 0, 0, 0};
static spar_member **built; /* all members, in the order of their creation */
static int count;

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static double memory(void) {
    struct rusage u;
    getrusage(RUSAGE_SELF, &u);
    return (double)u.ru_maxrss;
}

static void need(const spar_session *s, int status) {
    if (status != SPAR_OK) {
        fprintf(stderr, "assemblies: %s: %s\n", spar_status_text(status), spar_session_message(s));
        exit(1);
    }
}

static spar_joint *join(spar_session *s, spar_member *b, int node, spar_member *to, int other, int free_motions) {
    static int joints;
    char name[32];
    spar_joint *j = NULL;
    snprintf(name, sizeof name, "joint%d", joints++);
    need(s, spar_joint_create(s, name, b, node, to, other, free_motions, &j));
    return j;
}

static void keep(spar_member *b) {
    spar_member **more = realloc(built, sizeof *built * (size_t)(count + 1));
    if (!more) {
        exit(1);
    }
    built = more;
    built[count++] = b;
}

static spar_member *add_beam(spar_session *s, int i, const double xyz[6], double EA, int root) {
    static const double eta[2] = {0, 1}, stiffness[6] = {50, 10, 10, 0.8, 1, 1}, mass[6] = {200, 200, 200, 20, 10, 10};
    double K[36] = {0}, M[36] = {0};
    char name[32];
    spar_member *b = NULL;
    for (int k = 0; k < 6; k++) {
        K[7 * k] = stiffness[k] * EA, M[7 * k] = mass[k];
    }
    snprintf(name, sizeof name, "beam%d", i);
    need(s, spar_beam_create(s, name, 1, NODES, &b));
    need(s, spar_beam_set_axis(b, 2, eta, xyz, NULL));
    need(s, spar_beam_set_sections(b, 1, eta, K, M));
    need(s, spar_member_set_root(b, root));
    need(s, spar_member_commit(b));
    keep(b);
    return b;
}

/* A bar that begins at x and has its mass centre at x + arm. */
static spar_member *add_bar(spar_session *s, int i, const double x[3], const double arm[3], double m, double J) {
    double M[36] = {0}, square = arm[0] * arm[0] + arm[1] * arm[1] + arm[2] * arm[2];
    char name[32];
    spar_member *b = NULL;
    for (int k = 0; k < 3; k++) {
        int u = (k + 1) % 3, v = (k + 2) % 3;
        M[7 * k] = m;
        for (int l = 0; l < 3; l++) {
            M[6 * (3 + k) + 3 + l] = (k == l ? J + m * square : 0) - m * arm[k] * arm[l];
        }
        M[6 * k + 3 + u] = M[6 * (3 + u) + k] = m * arm[v];
        M[6 * k + 3 + v] = M[6 * (3 + v) + k] = -m * arm[u];
    }
    snprintf(name, sizeof name, "bar%d", i);
    need(s, spar_rigid_create(s, name, x, identity, M, &b));
    need(s, spar_member_commit(b));
    keep(b);
    return b;
}

/* A leg (k < 4) or brace of a storey: its corners below and above. */
static void corners(int k, int *from, int *to) {
    *from = k < 4 ? k : (k / 2 + k % 2) % 4;
    *to = k < 4 ? k : (k / 2 + 1 - k % 2) % 4;
}

static spar_member *add_leg_or_brace(spar_session *s, int i) {
    static const double corner[4][2] = {{-5, -5}, {5, -5}, {5, 5}, {-5, 5}}, height = 6;
    int from, to, bay = i / BAY;
    corners(i % BAY, &from, &to);
    const double xyz[6] = {corner[from][0], corner[from][1], height * bay,
                           corner[to][0],   corner[to][1],   height * bay + height};
    return add_beam(s, i, xyz, i % BAY < 4 ? 4e9 : 2e8, bay ? SPAR_ROOT_FREE : SPAR_ROOT_FIXED);
}

/* Returns the last leg. */
static spar_member *build_jacket(spar_session *s, int beams) {
    const double push[6] = {1e4, 0, 0, 0, 0, 0};
    spar_member *below[4] = {NULL}, *leg[4] = {NULL};
    for (int i = 0; i < beams; i++) {
        int from, to, k = i % BAY;
        corners(k, &from, &to);
        spar_member *b = add_leg_or_brace(s, i);
        if (k < 4) {
            leg[k] = b;
        } else {
            join(s, b, TIP, leg[to], TIP, 0);
        }
        if (i >= BAY) {
            join(s, b, 0, below[from], TIP, 0);
        }
        if (k == BAY - 1) {
            memcpy(below, leg, sizeof below);
        }
    }
    need(s, spar_member_set_load(leg[3], TIP, SPAR_LOAD_DEAD, push));
    return leg[3];
}

/* side x side crossings; beams of 4 m along x, then along y, from crossing to crossing. */
static void build_grid(spar_session *s, int beams) {
    int side = (int)floor(0.5 + sqrt(0.25 + 0.5 * beams)), made = 0;
    spar_member **at = calloc((size_t)(side * side), sizeof *at);
    int *node = calloc((size_t)(side * side), sizeof *node);
    if (!at || !node) {
        exit(1);
    }
    for (int i = 0; i < side * side; i++) {
        for (int along = 0; along < 2; along++) {
            int x = i % side, y = i / side, ends[2] = {i, i + (along ? side : 1)};
            if ((along ? y : x) == side - 1) {
                continue;
            }
            const double xyz[6] = {4. * x, 4. * y, 0, 4. * (x + !along), 4. * (y + along), 0};
            int fixed = made == 0;
            spar_member *b = add_beam(s, made++, xyz, 2e8, fixed ? SPAR_ROOT_FIXED : SPAR_ROOT_FREE);
            for (int e = 0; e < 2; e++) {
                int c = ends[e], edge = c % side == 0 || c / side == 0 || c % side == side - 1 || c / side == side - 1;
                if (fixed && e == 0) {
                    continue;
                }
                if (edge || at[c]) {
                    join(s, b, e * TIP, edge ? NULL : at[c], edge ? 0 : node[c], 0);
                }
                if (!edge && !at[c]) {
                    at[c] = b, node[c] = e * TIP;
                }
            }
        }
    }
    free(at);
    free(node);
}

static void build_hub(spar_session *s, int beams) {
    spar_member *hub = add_bar(s, 0, (double[]){0, 0, 0}, (double[]){0, 0, 0}, 1e4, 1e4);
    double K[36] = {0};
    spar_joint *spring = NULL;
    for (int k = 0; k < 6; k++) {
        K[7 * k] = 1e7;
    }
    need(s, spar_spring_create(s, "spring", hub, 0, 63, K, NULL, NULL, &spring));
    for (int i = 0; i < beams; i++) {
        double angle = 6.283185307179586 * i / beams, c = cos(angle), d = sin(angle);
        const double xyz[6] = {2 * c, 2 * d, 0, 12 * c, 12 * d, 0};
        need(s, spar_joint_set_frame(join(s, add_beam(s, i, xyz, 2e8, SPAR_ROOT_FREE), 0, hub, 0, 0), xyz, identity));
    }
}

/* Links on balls, from the origin along x; or along a half circle, whose end is hung up too. */
static void build_chain(spar_session *s, int links, int ring) {
    const double length = 0.1, m = 0.5;
    double x[3] = {0};
    spar_member *above = NULL;
    for (int i = 0; i < links; i++) {
        double angle = ring ? -1.5707963267948966 + 3.141592653589793 * (i + 0.5) / links : 0;
        const double step[3] = {length * cos(angle), 0, length * sin(angle)};
        const double arm[3] = {0.5 * step[0], 0, 0.5 * step[2]};
        spar_member *link = add_bar(s, i, x, arm, m, m * length * length / 12);
        spar_joint *ball = join(s, link, 0, above, 0, SPAR_FREE_RX | SPAR_FREE_RY | SPAR_FREE_RZ);
        need(s, spar_joint_set_frame(ball, x, identity));
        for (int k = 0; k < 3; k++) {
            x[k] += step[k];
        }
        above = link;
    }
    if (ring) {
        need(s,
             spar_joint_set_frame(join(s, above, 0, NULL, 0, SPAR_FREE_RX | SPAR_FREE_RY | SPAR_FREE_RZ), x, identity));
    }
}

static void hinge(spar_session *s, spar_member *b, spar_member *to, const double x[3]) {
    need(s, spar_joint_set_frame(join(s, b, 0, to, 0, SPAR_FREE_RY), x, identity));
}

/* An upright, then a beam and an upright a window. */
static void build_windows(spar_session *s, int bars) {
    spar_member *upright = NULL;
    for (int i = 0; i <= bars / 2; i++) {
        const double foot[3] = {i, 0, 0}, head[3] = {i, 0, 1}, before[3] = {i - 1, 0, 1};
        spar_member *next = add_bar(s, 2 * i, foot, (double[]){0, 0, 0.5}, 1, 1. / 12);
        hinge(s, next, NULL, foot);
        if (upright) {
            spar_member *lintel = add_bar(s, 2 * i - 1, before, (double[]){0.5, 0, 0}, 1, 1. / 12);
            hinge(s, lintel, upright, before);
            hinge(s, lintel, next, head);
        }
        upright = next;
    }
}

static void write_motion(const spar_session *s, const char *path) {
    FILE *f = fopen(path, "w");
    if (!f) {
        fprintf(stderr, "assemblies: cannot write '%s'\n", path);
        exit(1);
    }
    for (int i = 0; i < count; i++) {
        int64_t nodes;
        double q[NODES][7];
        need(s, spar_member_get_count(built[i], &nodes));
        need(s, spar_member_get_motion(built[i], q[0], NULL, NULL));
        for (int k = 0; k < 7; k++) {
            fprintf(f, k < 6 ? "%.16g " : "%.16g\n", q[nodes - 1][k]);
        }
    }
    fclose(f);
}

int main(int argc, char **argv) {
    const char *kind = argc > 1 ? argv[1] : "jacket";
    int n = argc > 2 ? atoi(argv[2]) : 108, steps = argc > 3 ? atoi(argv[3]) : 10;
    double hertz[MODES], before = memory(), dt = 2e-3;
    spar_session *s = NULL;
    spar_member *leg = NULL;
    if (n < 1 || steps < 1) {
        fprintf(stderr, "assemblies: give a kind, a number of members and a number of steps\n");
        return 1;
    }
    need(s, spar_session_create(&s));
    need(s, spar_session_set_gravity(s, (double[]){0, 0, -9.81}));
    if (!strcmp(kind, "jacket") || !strcmp(kind, "modes")) {
        need(s, spar_session_set_gravity(s, (double[]){0, 0, 0}));
        n = n < BAY ? BAY : n / BAY * BAY;
        leg = build_jacket(s, n);
        dt = 0.01;
    } else if (!strcmp(kind, "grid")) {
        build_grid(s, n);
    } else if (!strcmp(kind, "hub")) {
        build_hub(s, n);
    } else if (!strcmp(kind, "chain") || !strcmp(kind, "ring")) {
        build_chain(s, n, kind[0] == 'r');
    } else if (!strcmp(kind, "windows")) {
        need(s, spar_session_set_gravity(s, (double[]){2, 0, -9.6}));
        build_windows(s, n);
    } else {
        fprintf(stderr, "assemblies: '%s' is not known: jacket, grid, hub, chain, ring, windows, modes\n", kind);
        return 1;
    }
    dt = argc > 4 ? atof(argv[4]) : dt;
    double since = now();
    if (!strcmp(kind, "modes")) {
        need(s, spar_member_solve_modes(leg, MODES, hertz, NULL));
        printf("members,20 modes s\n%d,%.3f\n", n, now() - since);
    } else {
        need(s, spar_step(s, dt, NULL, NULL, NULL));
        double first = now() - since;
        since = now();
        for (int i = 0; i < steps; i++) {
            need(s, spar_step(s, dt, NULL, NULL, NULL));
        }
        printf("members,first step s,step us a member,memory kB a member\n%d,%.4f,%.1f,%.1f\n", n, first,
               1e6 * (now() - since) / steps / n, (memory() - before) / n);
        if (argc > 5) {
            write_motion(s, argv[5]);
        }
    }
    spar_session_destroy(&s);
    free(built);
    return 0;
}
