/* A whole turbine (peers_turbine_scene.h) in spar and in Kynema-FMB, in turns: the error of dt, the first step, and
   processor time of the others.

   peers_turbine [--end SECONDS] [--rounds N] [steps ...]     default 2 s, 5 rounds, 50 100 200 400 steps
   peers_turbine spar DT STEPS                                spar alone, for callgrind

   Both codes have as many Gauss points as nodes. Kynema-FMB: peers_kynema_turbine beside this program, with its default
   tolerances (1e-5 and 1e-3) and with its fastest (1e-3 and 1e-1). spar: its defaults. The error is that of the first
   blade's tip at the end, relative to the limit dt -> 0 of the same code. Errors fall with the square of dt, so the
   last column, the time to one error, scales the steps by the root of the ratio of the errors. */
#include "peers_turbine_scene.h"

#include <spar/spar_all.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

enum { CODES = 3, MOST_ROUNDS = 99, PATH = 512, FINEST = 1600 };

static const char *const code_name[CODES] = {"spar", "Kynema-FMB", "fastest"};
static const double tolerance[CODES][2] = {{0, 0}, {1e-5, 1e-3}, {1e-3, 1e-1}};

static char beside[PATH]; /* where this program is */

typedef struct peer_run {
    double first, us, u[3]; /* ms; us; m */
} peer_run;

typedef struct machine {
    spar_session *session;
    spar_member *tower, *hub, *blade[BLADE_COUNT];
    spar_joint *shaft, *bearing[BLADE_COUNT];
} machine;

/* ---- spar ---- */

static void diagonal(const double d[6], double m[36]) {
    memset(m, 0, 36 * sizeof *m);
    for (int i = 0; i < 6; i++) {
        m[7 * i] = d[i];
    }
}

static int make_beam(machine *t, const char *name, int nodes, double length, const double x[3], const double q[4],
                     const double k[6], const double m[6], spar_member **beam) {
    const double eta[2] = {0, 1}, line[6] = {0, 0, 0, length, 0, 0};
    double stiffness[36], mass[36];
    diagonal(k, stiffness);
    diagonal(m, mass);
    return spar_beam_create(t->session, name, 1, nodes, beam) || spar_beam_set_axis(*beam, 2, eta, line, NULL) ||
           spar_beam_set_sections(*beam, 1, eta, stiffness, mass) ||
           spar_beam_set_quadrature(*beam, SPAR_QUADRATURE_GAUSS, nodes) || spar_member_set_placement(*beam, x, q);
}

static int make_blade(machine *t, int k) {
    double x[3], q[4], along[3];
    char name[16];
    (void)snprintf(name, sizeof name, "blade%d", k + 1);
    blade_at(k, x, q, along);
    return make_beam(t, name, BLADE_NODES, blade_length, x, q, blade_stiffness, blade_mass, &t->blade[k]) ||
           spar_member_set_root(t->blade[k], SPAR_ROOT_FREE) || spar_member_commit(t->blade[k]) ||
           spar_joint_create(t->session, name, t->blade[k], 0, t->hub, 0, SPAR_FREE_RX, &t->bearing[k]) ||
           spar_joint_set_frame(t->bearing[k], x, q) || spar_joint_set_driven(t->bearing[k], SPAR_FREE_RX);
}

static int make_machine(machine *t) {
    const double origin[3] = {0}, q[4] = {sqrt(0.5), 0, -sqrt(0.5), 0}, level[4] = {1, 0, 0, 0}, top = 1;
    double nacelle[36], hub[36];
    diagonal(nacelle_mass, nacelle);
    diagonal(hub_mass, hub);
    int bad = spar_session_create(&t->session) || spar_session_set_integrator(t->session, radius_at_inf, 1) ||
              make_beam(t, "tower", TOWER_NODES, tower_height, origin, q, tower_stiffness, tower_mass, &t->tower) ||
              spar_beam_set_masses(t->tower, 1, &top, nacelle) || spar_member_commit(t->tower) ||
              spar_rigid_create(t->session, "hub", hub_at, NULL, hub, &t->hub) || spar_member_commit(t->hub) ||
              spar_joint_create(t->session, "shaft", t->hub, 0, t->tower, TOWER_NODES - 1, SPAR_FREE_RX, &t->shaft) ||
              spar_joint_set_frame(t->shaft, hub_at, level) || spar_joint_set_driven(t->shaft, SPAR_FREE_RX);
    for (int k = 0; k < BLADE_COUNT && !bad; k++) {
        bad = make_blade(t, k);
    }
    return bad;
}

/* What is prescribed at the end of a step. */
static int drive(const machine *t, double time) {
    const double angle[6] = {0, 0, 0, full_speed * integral_at(time)}, speed[6] = {0, 0, 0, full_speed * part_at(time)},
                 faster[6] = {0, 0, 0, full_speed * rate_at(time)};
    const double pitch[6] = {0, 0, 0, full_pitch * part_at(time)}, rate[6] = {0, 0, 0, full_pitch * rate_at(time)},
                 rises[6] = {0, 0, 0, full_pitch * curve_at(time)};
    const double gravity[3] = {0, 0, -full_gravity * part_at(time)};
    int bad = spar_session_set_gravity(t->session, gravity) || spar_joint_drive(t->shaft, angle, speed, faster);
    for (int k = 0; k < BLADE_COUNT && !bad; k++) {
        bad = spar_joint_drive(t->bearing[k], pitch, rate, rises);
    }
    return bad;
}

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return 1e6 * (double)t.tv_sec + 1e-3 * (double)t.tv_nsec;
}

static int run_spar(double end, int steps, int strict, peer_run *r) {
    machine t = {.session = NULL};
    double q[7 * BLADE_NODES], dt = end / steps;
    int bad = make_machine(&t) || (strict && spar_session_set_newton(t.session, 1e-15, 1e-12, 50));
    double since = now();
    for (int i = 1; i <= steps && !bad; i++) {
        bad = drive(&t, i * dt) || spar_step_begin(t.session, dt) || spar_step_solve(t.session) ||
              spar_step_accept(t.session);
        if (i == 1) {
            double then = now();
            r->first = 1e-3 * (then - since);
            since = then;
        }
    }
    r->us = (now() - since) / (steps - 1);
    if (bad || spar_member_get_motion(t.blade[0], q, NULL, NULL)) {
        fprintf(stderr, "peers_turbine: %s\n", t.session ? spar_session_message(t.session) : "no session");
        bad = 1;
    } else {
        memcpy(r->u, q + 7 * (BLADE_NODES - 1), sizeof r->u);
    }
    spar_session_destroy(&t.session);
    return bad;
}

/* ---- both ---- */

static int run_kynema(double end, int steps, double atol, double rtol, peer_run *r) {
    char command[2 * PATH];
    (void)snprintf(command, sizeof command, "'%s/peers_kynema_turbine' %g %d %g %g", beside, end, steps, atol, rtol);
    FILE *f = popen(command, "r");
    int read = f ? fscanf(f, "%lf %lf %lf %lf %lf", &r->first, &r->us, r->u, r->u + 1, r->u + 2) : 0;
    return !f || pclose(f) != 0 || read != 5;
}

/* The second of two runs: the first finds the caches cold. peers_kynema_turbine has its own two. */
static int run_code(int code, double end, int steps, peer_run *r) {
    return code > 0 ? run_kynema(end, steps, tolerance[code][0], tolerance[code][1], r)
                    : run_spar(end, steps, 0, r) || run_spar(end, steps, 0, r);
}

static int run_tight(int code, double end, int steps, peer_run *r) {
    return code > 0 ? run_kynema(end, steps, tolerance[2][0], tolerance[2][1], r) : run_spar(end, steps, 1, r);
}

static int limit_of(int code, double end, double u[3]) {
    peer_run coarse, fine;
    int steps = (int)(FINEST * end / 2);
    if (run_tight(code, end, steps / 2, &coarse) || run_tight(code, end, steps, &fine)) {
        return 1;
    }
    for (int i = 0; i < 3; i++) {
        u[i] = fine.u[i] + (fine.u[i] - coarse.u[i]) / 3;
    }
    return 0;
}

static double distance(const double a[3], const double b[3]) {
    return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
}

static int ascending(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static int compare(double end, int steps, int rounds, int codes, double (*limit)[3]) {
    static double us[CODES][MOST_ROUNDS], first[CODES][MOST_ROUNDS];
    double error[CODES];
    for (int round = 0; round < rounds; round++) {
        for (int k = 0; k < codes; k++) {
            peer_run r;
            if (run_code(k, end, steps, &r)) {
                return 1;
            }
            us[k][round] = r.us, first[k][round] = r.first;
            error[k] = distance(r.u, limit[k]);
        }
    }
    for (int k = 0; k < codes; k++) {
        qsort(us[k], (size_t)rounds, sizeof us[k][0], ascending);
        qsort(first[k], (size_t)rounds, sizeof first[k][0], ascending);
        double more = sqrt(error[k] / error[0]);
        printf("%-8g %-12s %10.2e m %8.2f, %6.2f ms %9.1f, %7.1f us", end / steps, code_name[k], error[k], first[k][0],
               first[k][rounds / 2], us[k][0], us[k][rounds / 2]);
        printf(k == 0 ? "\n" : "   times %6.1f, %6.1f; at equal error %6.1f, %6.1f\n", us[k][0] / us[0][0],
               us[k][rounds / 2] / us[0][rounds / 2], more * us[k][0] / us[0][0],
               more * us[k][rounds / 2] / us[0][rounds / 2]);
    }
    (void)fflush(stdout);
    return 0;
}

static int is_kynema_here(void) {
    char path[2 * PATH];
    (void)snprintf(path, sizeof path, "%s/peers_kynema_turbine", beside);
    return access(path, X_OK) == 0;
}

int main(int argc, char **argv) {
    static const int usual[] = {50, 100, 200, 400};
    double end = growth_time, limit[CODES][3];
    int rounds = 5, at = 1, bad = 0;
    peer_run r;
    if (argc == 4 && strcmp(argv[1], "spar") == 0) {
        return run_spar(atof(argv[2]) * atoi(argv[3]), atoi(argv[3]), 0, &r);
    }
    for (; at + 1 < argc && argv[at][0] == '-'; at += 2) {
        end = strcmp(argv[at], "--end") == 0 ? atof(argv[at + 1]) : end;
        rounds = strcmp(argv[at], "--rounds") == 0 ? atoi(argv[at + 1]) : rounds;
    }
    if (rounds < 1 || rounds > MOST_ROUNDS || !(end > 0)) {
        fprintf(stderr, "usage: peers_turbine [--end SECONDS] [--rounds N] [steps ...] | spar DT STEPS\n");
        return 2;
    }
    (void)snprintf(beside, sizeof beside, "%s", argv[0]);
    char *slash = strrchr(beside, '/');
    (void)snprintf(slash ? slash : beside, 2, "%s", slash ? "" : ".");
    int codes = is_kynema_here() ? CODES : 1;
    printf("Kynema-FMB: %s\n",
           codes > 1 ? "here" : "not here, it has not been built with it (cmake -D KynemaFMB_ROOT=...)");
    for (int k = 0; k < codes && !bad; k++) {
        bad = k == 2 ? 0 : limit_of(k, end, limit[k]);
        memcpy(limit[2], limit[1], sizeof limit[1]);
        printf("%-12s the tip at %g s, as dt goes to 0: %.8f %.8f %.8f\n", code_name[k], end, limit[k][0], limit[k][1],
               limit[k][2]);
    }
    printf("dt, s    code              error          first step              a step (least, median)\n");
    for (int i = 0; i < (argc > at ? argc - at : 4) && !bad; i++) {
        int steps = argc > at ? atoi(argv[at + i]) : (int)(usual[i] * end / growth_time);
        bad = steps < 2 || compare(end, steps, rounds, codes, limit);
    }
    return bad;
}
