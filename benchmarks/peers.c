/* spar beside published codes that are installed here, in turns, on the same beam (peer_physics.h): processor time of a
   step, the error that Newton leaves and that of dt, and what each code at its best takes to an error.

   peers [nodes ...]   default 6 8 11

   Kynema-FMB: peers_kynema beside this program, which is built where cmake finds the package KynemaFMB. BeamDyn:
   beamdyn_driver on the PATH; its files are written here and what it writes is read back. Each code is compared with
   its own solution: Newton's error with the tightest tolerance at the same dt, that of dt with the limit dt -> 0 by
   Richardson. What is not here is said to be not here. */
#include "peer_physics.h"

#include <spar/spar.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum { TURNS = 5, DTS = 6, TOLERANCES = 3, TIGHTEST = TOLERANCES, FEWEST = 40, PATH = 512 };

/* Absolute, and relative; BeamDyn has the first alone. */
static const double absolute[TOLERANCES + 1] = {1e-5, 1e-7, 1e-9, 1e-12},
                                          relative[TOLERANCES + 1] = {1e-3, 1e-5, 1e-7, 1e-10};

/* One run: microseconds a step, and the tip's displacement at the end. */
typedef struct result {
    double us, u[3];
} result;

typedef struct peer {
    const char *name, *missing;
    int (*run)(int nodes, int steps, int tolerance, result *r); /* 0, or 1: it failed */
    int here;
} peer;

static char folder[PATH]; /* of BeamDyn's files */
static char beside[PATH]; /* where this program is */

/* ---- spar ---- */

static int run_spar(int nodes, int steps, int tolerance, result *r) {
    const double eta[2] = {0, 1}, line[6] = {0, 0, 0, peer_length, 0, 0}, load[6] = {0, 0, peer_force, 0, 0, 0};
    double mass[36] = {0}, q[7 * 64];
    spar_session *s = NULL;
    spar_member *b = NULL;
    struct timespec begin, end;
    for (int i = 0; i < 6; i++) {
        mass[7 * i] = peer_mass[i];
    }
    int bad = nodes > 64 || spar_session_create(&s) || spar_session_set_integrator(s, 0, 1) ||
              spar_session_set_newton(s, absolute[tolerance], relative[tolerance], 30) ||
              spar_beam_create(s, "box", 1, nodes, &b) || spar_beam_set_axis(b, 2, eta, line, NULL) ||
              spar_beam_set_sections(b, 1, eta, peer_stiffness[0], mass) ||
              spar_beam_set_quadrature(b, SPAR_QUADRATURE_GAUSS, nodes) || spar_member_commit(b) ||
              spar_member_set_load(b, nodes - 1, SPAR_LOAD_DEAD, load);
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &begin);
    for (int i = 0; i < steps && !bad; i++) {
        bad = spar_step_begin(s, peer_end / steps) || spar_step_solve(s) || spar_step_accept(s);
    }
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &end);
    bad = bad || spar_member_get_motion(b, q, NULL, NULL);
    if (bad) {
        fprintf(stderr, "spar: %s\n", s ? spar_session_message(s) : "no session");
    } else {
        r->us = (1e6 * (double)(end.tv_sec - begin.tv_sec) + 1e-3 * (double)(end.tv_nsec - begin.tv_nsec)) / steps;
        memcpy(r->u, q + 7 * (nodes - 1), sizeof r->u);
    }
    spar_session_destroy(&s);
    return bad;
}

/* ---- Kynema-FMB ---- */

static int run_kynema(int nodes, int steps, int tolerance, result *r) {
    char command[2 * PATH];
    (void)snprintf(command, sizeof command, "'%s/peers_kynema' %d %d %g %g", beside, nodes, steps, absolute[tolerance],
                   relative[tolerance]);
    FILE *f = popen(command, "r");
    int read = f ? fscanf(f, "%lf %lf %lf %lf", &r->us, r->u, r->u + 1, r->u + 2) : 0;
    return !f || pclose(f) != 0 || read != 4;
}

static int is_kynema_here(void) {
    char path[2 * PATH];
    (void)snprintf(path, sizeof path, "%s/peers_kynema", beside);
    return access(path, X_OK) == 0;
}

/* ---- BeamDyn ---- */

static FILE *open_file(const char *name, const char *mode) {
    char path[2 * PATH];
    (void)snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *f = fopen(path, mode);
    if (!f) {
        perror(path);
    }
    return f;
}

/* Its beam lies along z: its x, y, z are y, z, x here, and its rows those of shear, axial force, bending, torsion. */
static const int row_of[6] = {1, 2, 0, 4, 5, 3};

static int write_sections(void) {
    FILE *f = open_file("peer_blade.inp", "w");
    if (!f) {
        return 1;
    }
    fprintf(f, "------- BEAMDYN INDIVIDUAL BLADE INPUT FILE ---\nComposite box\n---- Blade Parameters ----\n"
               "2  station_total\n0  damp_type\n---- Stiffness-Proportional Damping ----\nmu1 mu2 mu3 mu4 mu5 mu6\n"
               "(-) (-) (-) (-) (-) (-)\n0 0 0 0 0 0\n---- Modal Damping ----\n1  n_modes\n0  zeta\n"
               "---- Distributed Properties ----\n");
    for (int station = 0; station < 2; station++) {
        fprintf(f, "%d.0\n", station);
        for (int k = 0; k < 12; k++) {
            for (int j = 0; j < 6; j++) {
                int a = row_of[k % 6], b = row_of[j];
                fprintf(f, " %.10e", k < 6 ? peer_stiffness[a][b] : a == b ? peer_mass[a] : 0);
            }
            fprintf(f, k % 6 == 5 ? "\n\n" : "\n");
        }
    }
    return fclose(f) != 0;
}

static int write_primary(int nodes, int tolerance) {
    static const char *const defaults[] = {"tngt_stf_fd", "tngt_stf_comp", "tngt_stf_pert", "tngt_stf_difftol"};
    FILE *f = open_file("peer_primary.inp", "w");
    if (!f) {
        return 1;
    }
    fprintf(f, "--------- BEAMDYN INPUT FILE ---\nComposite box\n---- SIMULATION CONTROL ----\nFalse  Echo\n"
               "False  QuasiStaticInit\n0  rhoinf\n1  quadrature\n1  refine\n\"DEFAULT\"  n_fact\n\"DEFAULT\"  DTBeam\n"
               "\"DEFAULT\"  load_retries\n30  NRMax\n");
    fprintf(f, "%g  stop_tol\n", absolute[tolerance]);
    for (int i = 0; i < 4; i++) {
        fprintf(f, "\"DEFAULT\"  %s\n", defaults[i]);
    }
    fprintf(f, "True  RotStates\n---- GEOMETRY PARAMETER ----\n1  member_total\n3  kp_total\n1  3\n"
               "kp_xr kp_yr kp_zr initial_twist\n(m) (m) (m) (deg)\n");
    for (int i = 0; i < 3; i++) {
        fprintf(f, "0.0 0.0 %g 0.0\n", 0.5 * i * peer_length);
    }
    fprintf(f,
            "---- MESH PARAMETER ----\n%d  order_elem\n---- MATERIAL PARAMETER ----\n\"peer_blade.inp\"  BldFile\n"
            "---- PITCH ACTUATOR PARAMETERS ----\nFalse  UsePitchAct\n1  PitchJ\n1  PitchK\n1  PitchC\n"
            "---- OUTPUTS ----\nFalse  SumPrint\n\"ES20.11E2\"  OutFmt\n0  NNodeOuts\n1  OutNd\nOutList\n"
            "\"TipTDxr, TipTDyr, TipTDzr\"\nEND of input file\n---\n",
            nodes - 1);
    return fclose(f) != 0;
}

static int write_driver(double end, double dt) {
    FILE *f = open_file("peer_driver.inp", "w");
    if (!f) {
        return 1;
    }
    fprintf(f,
            "------- BEAMDYN Driver INPUT FILE ---\nComposite box\n---- SIMULATION CONTROL ----\nTrue  DynamicSolve\n"
            "0.0  t_initial\n%.12g  t_final\n%.12g  dt\n---- GRAVITY PARAMETER ----\n0 Gx\n0 Gy\n0 Gz\n"
            "---- FRAME PARAMETER ----\n0 GlbPos(1)\n0 GlbPos(2)\n0 GlbPos(3)\n---\n---\n1.0 0.0 0.0\n0.0 1.0 0.0\n"
            "0.0 0.0 1.0\nT  GlbRotBladeT0\n---- ROOT VELOCITY PARAMETER ----\n",
            end, dt);
    for (int i = 4; i < 7; i++) {
        fprintf(f, "0 RootVel(%d)\n", i);
    }
    fprintf(f, "---- APPLIED FORCE ----\n");
    for (int i = 1; i < 7; i++) {
        fprintf(f, "0 DistrLoad(%d)\n", i);
    }
    for (int i = 1; i < 7; i++) {
        fprintf(f, "%g TipLoad(%d)\n", i == 2 ? peer_force : 0, i);
    }
    fprintf(f, "0 NumPointLoads\neta Fx Fy Fz Mx My Mz\n(-) (N) (N) (N) (N-m) (N-m) (N-m)\n"
               "---- PRIMARY INPUT FILE ----\n\"peer_primary.inp\"  InputFile\n");
    return fclose(f) != 0;
}

/* The last row of its table: the columns are named in the row that begins with Time. */
static int read_tip(double u[3]) {
    static const char *const column[3] = {"TipTDzr", "TipTDxr", "TipTDyr"};
    char line[4096], *rest;
    int at[3] = {-1, -1, -1}, found = 0;
    FILE *f = open_file("peer_driver.out", "r");
    while (f && fgets(line, sizeof line, f)) {
        int named = strncmp(line + strspn(line, " \t"), "Time", 4) == 0, k = 0;
        for (char *word = strtok_r(line, " \t\r\n", &rest); word; word = strtok_r(NULL, " \t\r\n", &rest), k++) {
            char *end;
            double x = strtod(word, &end);
            for (int i = 0; i < 3; i++) {
                at[i] = named && strcmp(word, column[i]) == 0 ? k : at[i];
                if (!named && *end == 0 && k == at[i]) {
                    u[i] = x;
                    found |= 1 << i;
                }
            }
        }
    }
    if (f) {
        (void)fclose(f);
    }
    return found != 7;
}

static double seconds_of_children(void) {
    struct rusage r;
    (void)getrusage(RUSAGE_CHILDREN, &r);
    return (double)(r.ru_utime.tv_sec + r.ru_stime.tv_sec) + 1e-6 * (double)(r.ru_utime.tv_usec + r.ru_stime.tv_usec);
}

static int drive_beamdyn(double end, double dt, double *seconds) {
    char command[2 * PATH];
    if (write_driver(end, dt)) {
        return 1;
    }
    (void)snprintf(command, sizeof command,
                   "cd '%s' && rm -f peer_driver.out && beamdyn_driver peer_driver.inp > log 2>&1", folder);
    double before = seconds_of_children();
    int status = system(command);
    *seconds = seconds_of_children() - before;
    return status != 0;
}

/* Less what it takes to begin, as a run of a tenth of the steps has it. */
static int run_beamdyn(int nodes, int steps, int tolerance, result *r) {
    double dt = peer_end / steps, few, all;
    int tenth = steps / 10;
    if (write_sections() || write_primary(nodes, tolerance) || drive_beamdyn(tenth * dt, dt, &few) ||
        drive_beamdyn(peer_end, dt, &all)) {
        return 1;
    }
    r->us = 1e6 * (all - few) / (steps - tenth);
    return read_tip(r->u);
}

static void remove_files(void) {
    static const char *const names[] = {"peer_blade.inp", "peer_primary.inp", "peer_driver.inp", "peer_driver.out",
                                        "log"};
    char path[2 * PATH];
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        (void)snprintf(path, sizeof path, "%s/%s", folder, names[i]);
        (void)remove(path);
    }
    (void)rmdir(folder);
}

static int is_beamdyn_here(void) {
    return system("command -v beamdyn_driver > /dev/null 2>&1") == 0;
}

/* ---- all of them ---- */

/* A setting of a code, and what it gives. */
typedef struct point {
    int steps, tolerance, failed;
    double us, left, of_dt, error;
} point;

static double distance(const double a[3], const double b[3]) {
    return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
}

/* The limit dt -> 0, of a scheme of second order. */
static int limit_of(const peer *p, int nodes, double u[3]) {
    result a, b;
    if (p->run(nodes, FEWEST << (DTS + 1), TIGHTEST, &a) || p->run(nodes, FEWEST << (DTS + 2), TIGHTEST, &b)) {
        return 1;
    }
    for (int i = 0; i < 3; i++) {
        u[i] = b.u[i] + (b.u[i] - a.u[i]) / 3;
    }
    return 0;
}

static int ascending(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* One setting, the codes taking turns. */
static void measure(const peer *peers, int count, int nodes, double (*limit)[3], point *points) {
    for (int k = 0; k < count; k++) {
        result exact;
        point *p = points + k;
        p->failed = !peers[k].here || peers[k].run(nodes, p->steps, TIGHTEST, &exact);
        p->of_dt = p->failed ? NAN : distance(exact.u, limit[k]);
        p->left = p->failed ? NAN : 0;
        for (int i = 0; i < 3 && !p->failed; i++) {
            limit[count + k][i] = exact.u[i];
        }
    }
    double us[3][TURNS];
    for (int turn = 0; turn < TURNS; turn++) {
        for (int k = 0; k < count; k++) {
            result r;
            point *p = points + k;
            p->failed = p->failed || peers[k].run(nodes, p->steps, p->tolerance, &r);
            if (!p->failed) {
                us[k][turn] = r.us;
                p->left = distance(r.u, limit[count + k]);
                p->error = distance(r.u, limit[k]);
            }
        }
    }
    for (int k = 0; k < count; k++) {
        qsort(us[k], TURNS, sizeof us[k][0], ascending);
        points[k].us = us[k][TURNS / 2];
    }
}

/* The least milliseconds of the run with an error up to `most`; 0: none has it. */
static double cheapest(const point *points, int count, double most, const point **best) {
    double least = 0;
    for (const point *p = points; p < points + count; p++) {
        double ms = 1e-3 * p->us * p->steps;
        if (!p->failed && p->error <= most && (least <= 0 || ms < least)) {
            least = ms;
            *best = p;
        }
    }
    return least;
}

static void compare(const peer *peers, int count, point (*points)[DTS * TOLERANCES]) {
    printf("\nleast milliseconds to an error of the tip at %g s, each code at its best dt and tolerance\n", peer_end);
    for (double most = 1e-1; most > 5e-5; most /= 10) {
        const point *best = NULL;
        double own = cheapest(points[0], DTS * TOLERANCES, most, &best);
        int any = 0;
        printf("%8.0e m", most);
        for (int k = 0; k < count; k++) {
            double ms = peers[k].here ? cheapest(points[k], DTS * TOLERANCES, most, &best) : 0;
            any = any || ms > 0;
            if (ms > 0) {
                printf("   %s %.3f (dt %g, %g)", peers[k].name, ms, peer_end / best->steps, absolute[best->tolerance]);
                if (k > 0 && own > 0) {
                    printf(": %.1f times", ms / own);
                }
            }
        }
        printf(any ? "\n" : "   none has it\n");
    }
}

static void play(peer *peers, int count, int nodes) {
    double limit[6][3];
    static point points[3][DTS * TOLERANCES];
    printf("\n%d nodes\n%-12s %9s %9s %10s %12s %12s\n", nodes, "code", "dt, s", "Newton", "us a step", "left, m",
           "of dt, m");
    for (int k = 0; k < count; k++) {
        if (peers[k].here && limit_of(peers + k, nodes, limit[k])) {
            printf("%s: failed at the tightest tolerance\n", peers[k].name);
            peers[k].here = 0;
        }
    }
    for (int i = 0; i < DTS * TOLERANCES; i++) {
        point now[3];
        for (int k = 0; k < count; k++) {
            now[k] = (point){.steps = FEWEST << (i / TOLERANCES), .tolerance = i % TOLERANCES};
        }
        measure(peers, count, nodes, limit, now);
        for (int k = 0; k < count; k++) {
            const point *p = now + k;
            points[k][i] = *p;
            if (peers[k].here && p->failed) {
                printf("%-12s %9g %9g fails\n", peers[k].name, peer_end / p->steps, absolute[p->tolerance]);
            } else if (peers[k].here) {
                printf("%-12s %9g %9g %10.2f %12.1e %12.1e\n", peers[k].name, peer_end / p->steps,
                       absolute[p->tolerance], p->us, p->left, p->of_dt);
            }
        }
    }
    compare(peers, count, points);
}

int main(int argc, char **argv) {
    static const int usual[] = {6, 8, 11};
    peer peers[] = {{"spar", NULL, run_spar, 1},
                    {"Kynema-FMB", "cmake found no package KynemaFMB (-D KynemaFMB_DIR=...)", run_kynema, 0},
                    {"BeamDyn", "there is no beamdyn_driver on the PATH", run_beamdyn, 0}};
    char own[] = "/tmp/peersXXXXXX", *slash;
    enum { COUNT = sizeof peers / sizeof *peers };
    (void)snprintf(beside, sizeof beside, "%s", argv[0]);
    slash = strrchr(beside, '/');
    (void)snprintf(slash ? slash : beside, 2, "%s", slash ? "" : ".");
    peers[1].here = is_kynema_here();
    peers[2].here = is_beamdyn_here() && mkdtemp(own);
    (void)snprintf(folder, sizeof folder, "%s", own);
    for (int k = 1; k < COUNT; k++) {
        printf("%s: %s%s\n", peers[k].name, peers[k].here ? "here" : "not here, ",
               peers[k].here ? "" : peers[k].missing);
    }
    for (int i = 0; i < (argc > 1 ? argc - 1 : 3); i++) {
        int nodes = argc > 1 ? atoi(argv[i + 1]) : usual[i];
        if (nodes < 3 || nodes > 30) {
            fprintf(stderr, "usage: peers [nodes ...], 3 to 30 of them\n");
            return 2;
        }
        play(peers, COUNT, nodes);
    }
    if (peers[2].here) {
        remove_files(); /* where it failed they stay, with its log */
    }
    return 0;
}
