/* The codes that benchmarks/peers compares (peer_codes.h). Kynema-FMB: peers_kynema beside the program, which is built
   where cmake is told of Kynema-FMB, and reads the file written here. BeamDyn: beamdyn_driver of OpenFAST 5 on the
   PATH, whose files are written here and whose table is read back. */
#include "peer_codes.h"

#include "math/basis.h"
#include "member/beam.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum { PATH = 512, MOST_BLADES = 3, MOST_NODES = 24 };

static const double pi = 3.14159265358979323846;

static char folder[PATH] = "/tmp/peersXXXXXX";
static char beside[PATH]; /* where this program is */

static FILE *open_file(const char *name, const char *mode) {
    char path[2 * PATH];
    (void)snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *f = fopen(path, mode);
    if (!f) {
        perror(path);
    }
    return f;
}

/* ---- spar ---- */

/* The root of blade k when the hub has turned by some angle. */
static void root_of(const peer_scene *scene, int k, double angle, double x[3], double q[4]) {
    double all = 2 * pi * k / scene->blades + angle;
    x[0] = scene->hub * cos(all), x[1] = 0, x[2] = -scene->hub * sin(all);
    q[0] = cos(0.5 * all), q[1] = q[3] = 0, q[2] = sin(0.5 * all);
}

/* The part that force and speed have reached, and the angle in units of the speed times seconds. */
static double part_at(const peer_scene *scene, double t) {
    double s = sin(0.5 * pi * t / scene->end);
    return scene->smoothly ? s * s : 1;
}
static double angle_at(const peer_scene *scene, double t) {
    return scene->smoothly ? 0.5 * t - 0.5 * scene->end / pi * sin(pi * t / scene->end) : t;
}

/* A blade and, of scenes that ask for it, the joint about the hub that drives its root. */
typedef struct blade {
    spar_member *beam;
    spar_joint *root;
} blade;

static int make_joint(spar_session *s, const char *name, blade *b) {
    const double x[3] = {0}, q[4] = {1, 0, 0, 0};
    return spar_joint_create(s, name, b->beam, 0, NULL, 0, 63, &b->root) || spar_joint_set_frame(b->root, x, q) ||
           spar_joint_set_driven(b->root, 63);
}

static int make_blade(spar_session *s, const peer_scene *scene, int k, blade *b) {
    const double part = part_at(scene, 0);
    const double omega[3] = {0, part * scene->turning, 0}, force[6] = {0, 0, part * scene->force, 0, 0, 0};
    double x[3], q[4];
    char name[16];
    int root = scene->joints ? SPAR_ROOT_FREE : scene->turning > 0 ? SPAR_ROOT_DRIVEN : SPAR_ROOT_FIXED;
    (void)snprintf(name, sizeof name, "blade%d", k + 1);
    root_of(scene, k, 0, x, q);
    return spar_beam_create(s, name, 1, scene->nodes, &b->beam) || scene->describe(b->beam, scene->of) ||
           spar_beam_set_quadrature(b->beam, scene->rule, scene->points) || spar_member_set_placement(b->beam, x, q) ||
           spar_member_set_root(b->beam, root) || spar_member_set_initial_velocity(b->beam, NULL, NULL, omega) ||
           spar_member_commit(b->beam) || spar_member_set_load(b->beam, scene->nodes - 1, SPAR_LOAD_DEAD, force) ||
           (scene->joints && make_joint(s, name, b));
}

static int make_blades(const peer_scene *scene, spar_session **s, blade *b) {
    const double gravity[3] = {0, 0, -scene->gravity};
    int bad = spar_session_create(s) || spar_session_set_integrator(*s, scene->rho_inf, 1) ||
              spar_session_set_gravity(*s, gravity);
    for (int k = 0; k < scene->blades && !bad; k++) {
        bad = make_blade(*s, scene, k, b + k);
    }
    if (bad) {
        fprintf(stderr, "peers: %s\n", *s ? spar_session_message(*s) : "no session");
    }
    return bad;
}

/* Its root and force at t. */
static int drive(const blade *b, const peer_scene *scene, int k, double t) {
    const double load[6] = {0, 0, part_at(scene, t) * scene->force, 0, 0, 0};
    double from[3], x[3], q[7] = {0}, v[6] = {0}, a[6] = {0};
    double turn = scene->turning * angle_at(scene, t), w = scene->turning * part_at(scene, t);
    double faster = scene->smoothly ? 0.5 * pi * scene->turning / scene->end * sin(pi * t / scene->end) : 0;
    root_of(scene, k, 0, from, q + 3);
    root_of(scene, k, turn, x, q + 3);
    for (int i = 0; i < 3; i++) {
        q[i] = x[i] - from[i];
        a[i] = -w * w * x[i];
    }
    q[3] = cos(0.5 * turn), q[4] = q[6] = 0, q[5] = sin(0.5 * turn);
    v[0] = w * x[2], v[2] = -w * x[0], v[4] = w;
    a[0] += faster * x[2], a[2] -= faster * x[0], a[4] = faster;
    if (b->root) {
        const double motion[6] = {0, 0, 0, 0, turn, 0}, rate[6] = {0, 0, 0, 0, w, 0},
                     rises[6] = {0, 0, 0, 0, faster, 0};
        return spar_joint_drive(b->root, motion, rate, rises);
    }
    return (scene->turning > 0 && spar_member_drive(b->beam, q, v, a)) ||
           (scene->smoothly && spar_member_set_load(b->beam, scene->nodes - 1, SPAR_LOAD_DEAD, load));
}

/* From where the tip is to its deflection in the frame of the hub. */
static void see_from_hub(const peer_scene *scene, const double reference[3], double u[3]) {
    double turn = scene->turning * angle_at(scene, scene->end), c = cos(turn), s = sin(turn);
    double x = reference[0] + u[0], z = reference[2] + u[2];
    u[0] = c * x - s * z - reference[0];
    u[2] = s * x + c * z - reference[2];
}

static int tip_of(const spar_member *b, const peer_scene *scene, double u[3]) {
    double q[7 * MOST_NODES], x[3 * MOST_NODES];
    int last = scene->nodes - 1;
    if (spar_member_get_motion(b, q, NULL, NULL) || spar_member_get_reference(b, x, NULL)) {
        return 1;
    }
    memcpy(u, q + 7 * last, 3 * sizeof *u);
    see_from_hub(scene, x + 3 * last, u);
    return 0;
}

static int move(spar_session *s, const blade *b, const peer_scene *scene, int steps) {
    double dt = scene->end / steps;
    int bad = 0;
    for (int i = 0; i < steps && !bad; i++) {
        for (int k = 0; k < scene->blades && !bad; k++) {
            bad = drive(b + k, scene, k, (i + 1) * dt);
        }
        bad = bad || spar_step_begin(s, dt) || spar_step_solve(s) || spar_step_accept(s);
    }
    return bad;
}

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return 1e6 * (double)t.tv_sec + 1e-3 * (double)t.tv_nsec;
}

static int run_once(const peer_scene *scene, int steps, peer_tolerance t, peer_run *r) {
    spar_session *s = NULL;
    blade b[MOST_BLADES] = {{NULL, NULL}};
    int bad = make_blades(scene, &s, b) || spar_session_set_newton(s, t.atol, t.rtol, 30);
    double since = now();
    bad = bad || move(s, b, scene, steps);
    r->us = (now() - since) / steps;
    bad = bad || tip_of(b[0].beam, scene, r->u);
    spar_session_destroy(&s);
    return bad;
}

/* The second of two: the first finds the caches cold. */
static int run_spar(const peer_scene *scene, int steps, peer_tolerance t, peer_run *r) {
    return run_once(scene, steps, t, r) || run_once(scene, steps, t, r);
}

static int is_spar_here(void) {
    return 1;
}

/* ---- Kynema-FMB ---- */

static void write_quadrature(FILE *f, const peer_scene *scene, const spari_beam *beam) {
    double x[512], w[512];
    int pieces = scene->rule == SPAR_QUADRATURE_SECTIONS ? (int)beam->section_count - 1 : 1;
    spari_gauss(scene->points, x, w);
    fprintf(f, "%d\n", pieces * scene->points);
    for (int p = 0; p < pieces; p++) {
        double a = pieces > 1 ? beam->section_eta[p] : 0, b = pieces > 1 ? beam->section_eta[p + 1] : 1;
        for (int i = 0; i < scene->points; i++) {
            fprintf(f, "%.17g %.17g\n", a + b - 1 + (b - a) * x[i], (b - a) * w[i]);
        }
    }
}

static void write_matrix(FILE *f, const double *m) {
    for (int i = 0; i < 36; i++) {
        fprintf(f, "%.17g%c", m[i], i % 6 == 5 ? '\n' : ' ');
    }
}

/* At both ends too, where the one station of a uniform beam is not. */
static void write_sections(FILE *f, const spari_beam *beam) {
    int64_t n = beam->section_count;
    fprintf(f, "%d\n", (int)(n > 1 ? n : 2));
    for (int64_t i = 0; i < (n > 1 ? n : 2); i++) {
        int64_t k = n > 1 ? i : 0;
        fprintf(f, "%.17g\n", n > 1 ? beam->section_eta[i] : (double)i);
        write_matrix(f, beam->mass + 36 * k);
        write_matrix(f, beam->stiffness + 36 * k);
    }
}

static int write_kynema(const peer_scene *scene) {
    spar_session *s = NULL;
    blade b[MOST_BLADES] = {{NULL, NULL}};
    double xi[MOST_NODES], x[3 * MOST_NODES], q[4 * MOST_NODES], mu[6];
    FILE *f = NULL;
    spari_gll(scene->nodes, xi, NULL, NULL);
    int bad = make_blades(scene, &s, b) || spar_member_get_reference(b[0].beam, x, q) ||
              spar_beam_get_damping(b[0].beam, mu) || !(f = open_file("peer_kynema.txt", "w"));
    if (!bad) {
        fprintf(f, "%d %.17g %.17g %.17g %.17g %.17g %.17g %d\n", scene->blades, scene->hub, scene->turning,
                scene->gravity, scene->force, scene->end, scene->rho_inf, scene->smoothly);
        fprintf(f, "%.17g %.17g %.17g %.17g %.17g %.17g\n%d\n", mu[0], mu[1], mu[2], mu[3], mu[4], mu[5], scene->nodes);
        for (int i = 0; i < scene->nodes; i++) {
            const double *y = x + 3 * i, *p = q + 4 * i;
            fprintf(f, "%.17g %.17g %.17g %.17g %.17g %.17g %.17g %.17g\n", 0.5 * (1 + xi[i]), y[0], y[1], y[2], p[0],
                    p[1], p[2], p[3]);
        }
        write_quadrature(f, scene, b[0].beam->beam);
        write_sections(f, b[0].beam->beam);
        bad = fclose(f) != 0;
    }
    spar_session_destroy(&s);
    return bad;
}

static int run_kynema(const peer_scene *scene, int steps, peer_tolerance t, peer_run *r) {
    char command[5 * PATH];
    double x[3] = {0};
    *r = (peer_run){0};
    if (write_kynema(scene)) {
        return 1;
    }
    (void)snprintf(command, sizeof command, "'%s/peers_kynema' '%s/peer_kynema.txt' %d %g %g 2>> '%s/log'", beside,
                   folder, steps, t.atol, t.rtol, folder);
    FILE *f = popen(command, "r");
    int read = f ? fscanf(f, "%lf %lf %lf %lf %lf %lf %lf", &r->us, x, x + 1, x + 2, r->u, r->u + 1, r->u + 2) : 0;
    see_from_hub(scene, x, r->u);
    return !f || pclose(f) != 0 || read != 7;
}

static int is_kynema_here(void) {
    char path[2 * PATH];
    (void)snprintf(path, sizeof path, "%s/peers_kynema", beside);
    return access(path, X_OK) == 0;
}

/* ---- BeamDyn ---- */

/* Its beam lies along z: its x, y, z are y, z, x here, and its rows those of shear, axial force, bending, torsion. */
static const int row_of[6] = {1, 2, 0, 4, 5, 3};

static void write_turned(FILE *f, const double *m) {
    for (int k = 0; k < 36; k++) {
        fprintf(f, " %.15e%s", m[6 * row_of[k / 6] + row_of[k % 6]], k % 6 == 5 ? "\n" : "");
    }
    fprintf(f, "\n");
}

static int write_blade(const spari_beam *beam) {
    FILE *f = open_file("peer_blade.inp", "w");
    int n = beam->section_count > 1 ? (int)beam->section_count : 2;
    if (!f) {
        return 1;
    }
    fprintf(f,
            "------- BEAMDYN INDIVIDUAL BLADE INPUT FILE ---\n---\n---- Blade Parameters ----\n"
            "%d  station_total\n%d  damp_type\n---- Stiffness-Proportional Damping ----\nmu1 mu2 mu3 mu4 mu5 mu6\n"
            "(-) (-) (-) (-) (-) (-)\n",
            n, beam->damped);
    for (int i = 0; i < 6; i++) {
        fprintf(f, " %g", beam->mu[row_of[i]]);
    }
    fprintf(f, "\n---- Modal Damping ----\n1  n_modes\n0  zeta\n---- Distributed Properties ----\n");
    for (int i = 0; i < n; i++) {
        int k = beam->section_count > 1 ? i : 0;
        fprintf(f, "%.15g\n", beam->section_count > 1 ? beam->section_eta[i] : i);
        write_turned(f, beam->stiffness + 36 * (int64_t)k);
        write_turned(f, beam->mass + 36 * (int64_t)k);
    }
    return fclose(f) != 0;
}

/* Its twist turns the other way round, and is in degrees. */
static int write_primary(const peer_scene *scene, const spari_beam *beam, double tolerance) {
    FILE *f = open_file("peer_primary.inp", "w");
    int n = (int)beam->axis_count;
    if (!f) {
        return 1;
    }
    fprintf(f,
            "--------- BEAMDYN INPUT FILE ---\n---\n---- SIMULATION CONTROL ----\nFalse  Echo\n"
            "False  QuasiStaticInit\n%g  rhoinf\n%d  quadrature\n%d  refine\n\"DEFAULT\"  n_fact\n\"DEFAULT\"  DTBeam\n"
            "\"DEFAULT\"  load_retries\n30  NRMax\n%g  stop_tol\n\"DEFAULT\"  tngt_stf_fd\n"
            "\"DEFAULT\"  tngt_stf_comp\n\"DEFAULT\"  tngt_stf_pert\n\"DEFAULT\"  tngt_stf_difftol\nTrue  RotStates\n",
            scene->rho_inf, scene->refine > 0 ? 2 : 1, scene->refine > 0 ? scene->refine : 1, tolerance);
    fprintf(f,
            "---- GEOMETRY PARAMETER ----\n1  member_total\n%d  kp_total\n1  %d\n"
            "kp_xr kp_yr kp_zr initial_twist\n(m) (m) (m) (deg)\n",
            n, n);
    for (int i = 0; i < n; i++) {
        const double *x = beam->xyz + 3 * i;
        fprintf(f, "%.15g %.15g %.15g %.15g\n", x[1], x[2], x[0], beam->twist ? -180 / pi * beam->twist[i] : 0);
    }
    fprintf(f,
            "---- MESH PARAMETER ----\n%d  order_elem\n---- MATERIAL PARAMETER ----\n\"peer_blade.inp\"  BldFile\n"
            "---- OUTPUTS ----\nFalse  SumPrint\n\"ES20.11E2\"  OutFmt\n0  NNodeOuts\n1  OutNd\nOutList\n"
            "\"TipTDxr, TipTDyr, TipTDzr\"\nEND of input file\n---\n",
            scene->nodes - 1);
    return fclose(f) != 0;
}

/* It takes a step more than t_final holds. */
static int write_driver(const peer_scene *scene, int steps, double dt) {
    FILE *f = open_file("peer_driver.inp", "w");
    if (!f) {
        return 1;
    }
    fprintf(f,
            "------- BEAMDYN Driver INPUT FILE ---\n---\n---- SIMULATION CONTROL ----\nTrue  DynamicSolve\n"
            "0.0  t_initial\n%.15g  t_final\n%.15g  dt\n---- GRAVITY PARAMETER ----\n0 Gx\n%g Gy\n0 Gz\n"
            "---- FRAME PARAMETER ----\n0 GlbPos(1)\n0 GlbPos(2)\n%g GlbPos(3)\n---\n---\n1.0 0.0 0.0\n0.0 1.0 0.0\n"
            "0.0 0.0 1.0\nT  GlbRotBladeT0\n---- ROOT VELOCITY PARAMETER ----\n%.15g RootVel(4)\n0 RootVel(5)\n"
            "0 RootVel(6)\n---- APPLIED FORCE ----\n",
            (steps - 0.5) * dt, dt, -scene->gravity, scene->hub, scene->turning);
    for (int i = 1; i < 7; i++) {
        fprintf(f, "0 DistrLoad(%d)\n", i);
    }
    for (int i = 1; i < 7; i++) {
        fprintf(f, "%g TipLoad(%d)\n", i == 2 ? scene->force : 0, i);
    }
    fprintf(f,
            "0 NumPointLoads\neta Fx Fy Fz Mx My Mz\n(-) (N) (N) (N) (N-m) (N-m) (N-m)\n"
            "---- PRIMARY INPUT FILE ----\n\"peer_primary.inp\"  InputFile\n---- OUTPUTS ----\n0 WrVTK\n15 VTK_fps\n");
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

static int drive_beamdyn(const peer_scene *scene, int steps, double dt, double *seconds) {
    char command[2 * PATH];
    if (write_driver(scene, steps, dt)) {
        return 1;
    }
    (void)snprintf(command, sizeof command,
                   "cd '%s' && rm -f peer_driver.out && beamdyn_driver peer_driver.inp > log 2>&1", folder);
    double before = seconds_of_children();
    int status = system(command);
    *seconds = seconds_of_children() - before;
    return status != 0;
}

/* Less what it takes to begin, as a run of a tenth of the steps has it. Its driver has one blade, and forces and speeds
   that stay as they are. */
static int run_beamdyn(const peer_scene *scene, int steps, peer_tolerance t, peer_run *r) {
    spar_session *s = NULL;
    blade b[MOST_BLADES] = {{NULL, NULL}};
    double few, all;
    int tenth = steps / 10;
    int bad = scene->blades > 1 || scene->smoothly || make_blades(scene, &s, b) || write_blade(b[0].beam->beam) ||
              write_primary(scene, b[0].beam->beam, t.atol);
    spar_session_destroy(&s);
    if (bad || drive_beamdyn(scene, tenth, scene->end / steps, &few) ||
        drive_beamdyn(scene, steps, scene->end / steps, &all)) {
        return 1;
    }
    r->us = 1e6 * (all - few) / (steps - tenth);
    return read_tip(r->u);
}

static int is_beamdyn_here(void) {
    return system("command -v beamdyn_driver > /dev/null 2>&1") == 0;
}

/* ---- all of them ---- */

const peer_code peer_codes[PEER_CODES] = {
    {"spar", NULL, is_spar_here, run_spar},
    {"Kynema-FMB", "it has not been built with it (cmake -D KynemaFMB_ROOT=...)", is_kynema_here, run_kynema},
    {"BeamDyn", "there is no beamdyn_driver on the PATH", is_beamdyn_here, run_beamdyn},
};

int peer_codes_begin(const char *program) {
    (void)snprintf(beside, sizeof beside, "%s", program);
    char *slash = strrchr(beside, '/');
    (void)snprintf(slash ? slash : beside, 2, "%s", slash ? "" : ".");
    return !mkdtemp(folder);
}

void peer_codes_end(void) {
    static const char *const names[] = {"peer_kynema.txt", "peer_blade.inp",  "peer_primary.inp",
                                        "peer_driver.inp", "peer_driver.out", "log"};
    char path[2 * PATH];
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        (void)snprintf(path, sizeof path, "%s/%s", folder, names[i]);
        (void)remove(path);
    }
    (void)rmdir(folder);
}
