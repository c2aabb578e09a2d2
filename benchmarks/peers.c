/* spar beside published codes that are installed here, in turns, on the same beams: processor time of a step, the error
   that Newton leaves and that of dt, and what each code at its best takes to an error.

   peers [--curves | --errors] [--csv FILE] [--blade FILE] [--end SECONDS] [--rho-inf R] [--joints] [scene ...]
   default box6 box8 box11

   A scene is a name and the nodes of a blade:
     box    the composite box of Wang et al. (Wind Energy 20, 2017), 10 m, clamped, 150 N at the tip at once
     push   the same, the force growing smoothly
     nrel   a blade of the NREL 5-MW rotor, damped, turning from level at 1 rad/s under its weight; 2 points an interval
            of its table, for BeamDyn trapezoids half as wide as the intervals
     blade  one of --blade (BeamDyn's primary file; else of the NREL 5-MW rotor), undamped, set turning smoothly up to
            0.16 rad/s; 50 Gauss points
     rotor  three of them
   --curves: all dt and tolerances too. --errors: errors of dt alone, nothing timed. --end: how long, and how long
   forces and speeds of smooth scenes grow; dt stays. --rho-inf: of all codes, default 0. --joints: blades of spar that
   turn are on joints that drive them. Each code is compared with its own solution: Newton's error with the tightest
   tolerance at the same dt, that of dt with the limit dt -> 0 by Richardson. What is not here is said to be not here.
 */
#include "nrel5mw.h"
#include "peer_codes.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LOOSEST = 3, LEVELS = 12, TIGHTEST = 15, OWN = 5, MOST_DTS = 8, MOST_TURNS = 5 };

/* Newton at a level: 1e-5 + 1e-3 |x|, where Kynema-FMB and BeamDyn end by default, is 5. */
static peer_tolerance tolerance_at(int level) {
    return (peer_tolerance){pow(10, -level), pow(10, 2 - level)};
}

/* ---- scenes ---- */

static int describe_box(spar_member *b, const void *of) {
    const double eta[3] = {0, 0.5, 1}, line[9] = {0, 0, 0, 5, 0, 0, 10, 0, 0};
    const double k[6] = {1368.17e3, 88.56e3, 38.78e3, 16.96e3, 59.12e3, 141.47e3};
    const double m[6] = {8.538e-2, 8.538e-2, 8.538e-2, 1.4433e-2, 0.4097e-2, 1.0336e-2};
    double stiffness[36] = {0}, mass[36] = {0};
    (void)of;
    for (int i = 0; i < 6; i++) {
        stiffness[7 * i] = k[i], mass[7 * i] = m[i];
    }
    stiffness[6 * 3 + 4] = stiffness[6 * 4 + 3] = 17.61e3;
    stiffness[6 * 3 + 5] = stiffness[6 * 5 + 3] = -0.351e3;
    stiffness[6 * 4 + 5] = stiffness[6 * 5 + 4] = -0.370e3;
    return spar_beam_set_axis(b, 3, eta, line, NULL) || spar_beam_set_sections(b, 1, eta, stiffness, mass);
}

static int describe_undamped(spar_member *b, const void *of) {
    const nrel5mw *t = of;
    return spar_beam_set_axis(b, t->axis_n, t->axis_eta, t->axis_xyz, t->axis_twist) ||
           spar_beam_set_sections(b, t->section_n, t->section_eta, t->stiffness, t->mass);
}

static int describe_nrel(spar_member *b, const void *of) {
    return describe_undamped(b, of) || spar_beam_set_damping(b, ((const nrel5mw *)of)->damping);
}

static int describe_file(spar_member *b, const void *of) {
    static const double none[6];
    return spar_beam_read_beamdyn(b, of, NULL) || spar_beam_set_damping(b, none);
}

/* What the command line asks; end 0: each scene's own. */
typedef struct asked {
    const char *file, *table;
    int curves, errors, joints;
    double end, rho_inf;
} asked;

/* A scene and what is asked of it: steps at its longest dt, halvings of dt, those to compare Newton at. */
typedef struct deck {
    char name[16];
    peer_scene scene;
    int fewest, dts, at[2], turns;
} deck;

static int read_deck(const char *name, const asked *a, const nrel5mw *tables, deck *d) {
    const char *file = a->file;
    size_t letters = strspn(name, "abcdefghijklmnopqrstuvwxyz");
    int nodes = atoi(name + letters), rotor = strncmp(name, "rotor", letters) == 0;
    const peer_scene box = {.describe = describe_box,
                            .nodes = nodes,
                            .rule = SPAR_QUADRATURE_GAUSS,
                            .points = nodes,
                            .blades = 1,
                            .force = 150,
                            .end = 0.4,
                            .smoothly = name[0] == 'p'};
    const peer_scene nrel = {.describe = describe_nrel,
                             .of = tables,
                             .nodes = nodes,
                             .rule = SPAR_QUADRATURE_SECTIONS,
                             .points = 2,
                             .refine = 2,
                             .blades = 1,
                             .hub = 1.5,
                             .turning = 1.0006,
                             .gravity = 9.80665,
                             .end = 0.4};
    const peer_scene blade = {.describe = file ? describe_file : describe_undamped,
                              .of = file ? (const void *)file : tables,
                              .nodes = nodes,
                              .rule = SPAR_QUADRATURE_GAUSS,
                              .points = 50,
                              .blades = rotor ? 3 : 1,
                              .hub = 3,
                              .turning = 0.16,
                              .end = 0.8,
                              .smoothly = 1};
    if (letters == 0 || nodes < 3 || nodes > 20 || strlen(name) >= sizeof d->name) {
        return 1;
    }
    (void)snprintf(d->name, sizeof d->name, "%s", name);
    if (strncmp(name, "box", letters) == 0 || strncmp(name, "push", letters) == 0) {
        d->scene = box, d->fewest = 40, d->dts = 6, d->at[0] = 0, d->at[1] = 1, d->turns = 5;
    } else if (strncmp(name, "nrel", letters) == 0) {
        d->scene = nrel, d->fewest = 25, d->dts = 4, d->at[0] = d->at[1] = 3, d->turns = 3;
    } else if (rotor || strncmp(name, "blade", letters) == 0) {
        d->scene = blade, d->fewest = 20, d->dts = 5, d->at[0] = d->at[1] = 2, d->turns = 3;
    } else {
        return 1;
    }
    d->scene.rho_inf = a->rho_inf;
    d->scene.joints = a->joints && d->scene.turning > 0;
    if (a->end > 0) {
        d->fewest = (int)fmax(1, round(d->fewest * a->end / d->scene.end));
        d->scene.end = a->end;
    }
    return 0;
}

/* ---- measurements ---- */

/* A setting of a code, and what it gives. */
typedef struct point {
    int steps, level, failed, skipped; /* peers have every other level */
    double us, left, of_dt, error;
} point;

static int here[PEER_CODES];

static double distance(const double a[3], const double b[3]) {
    return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
}

/* With the tightest tolerance that rounding lets it meet. */
static int run_tight(int code, const peer_scene *scene, int steps, double u[3]) {
    peer_run r;
    int bad = 1;
    for (int level = TIGHTEST; level >= TIGHTEST - 9 && bad; level -= 3) {
        bad = peer_codes[code].run(scene, steps, tolerance_at(level), &r);
    }
    memcpy(u, r.u, sizeof r.u);
    return bad;
}

/* The limit dt -> 0, by the order, 1 or 2, that three dt show: under a force that comes at once not all begin with the
   second. The least is a quarter of the least compared, or half of it where a code does not solve such short steps. */
static int limit_of(int code, const deck *d, double u[3]) {
    double of[3][3];
    int bad = 1;
    for (int least = d->dts - 1; least >= d->dts - 2 && bad; least--) {
        bad = 0;
        for (int i = 0; i < 3 && !bad; i++) {
            bad = run_tight(code, &d->scene, d->fewest << (least + i), of[i]);
        }
    }
    if (bad) {
        return 1;
    }
    int order = distance(of[0], of[1]) > sqrt(8) * distance(of[1], of[2]) ? 2 : 1;
    for (int i = 0; i < 3; i++) {
        u[i] = of[2][i] + (of[2][i] - of[1][i]) / ((1 << order) - 1);
    }
    return 0;
}

static int ascending(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* One setting, the codes taking turns; exact: what each gives at this dt with the tightest tolerance. */
static void measure(const deck *d, const double (*exact)[3], const double (*limit)[3], point *points) {
    double us[PEER_CODES][MOST_TURNS];
    for (int turn = 0; turn < d->turns; turn++) {
        for (int k = 0; k < PEER_CODES; k++) {
            peer_run r;
            point *p = points + k;
            p->failed = p->failed || peer_codes[k].run(&d->scene, p->steps, tolerance_at(p->level), &r);
            if (!p->failed) {
                us[k][turn] = r.us;
                p->left = distance(r.u, exact[k]);
                p->error = distance(r.u, limit[k]);
            }
        }
    }
    for (int k = 0; k < PEER_CODES; k++) {
        if (!points[k].failed) {
            qsort(us[k], (size_t)d->turns, sizeof us[k][0], ascending);
            points[k].us = us[k][d->turns / 2];
        }
    }
}

/* All levels at one dt: points [level][code]. */
static void measure_levels(const deck *d, int dt, int each, const double (*limit)[3], point (*points)[PEER_CODES]) {
    double exact[PEER_CODES][3];
    int failed[PEER_CODES];
    for (int k = 0; k < PEER_CODES; k++) {
        failed[k] = !here[k] || run_tight(k, &d->scene, d->fewest << dt, exact[k]);
    }
    for (int i = 0; i < LEVELS; i += each) {
        for (int k = 0; k < PEER_CODES; k++) {
            int skipped = k > 0 && i % 2 == 1;
            points[i][k] = (point){
                .steps = d->fewest << dt, .level = LOOSEST + i, .failed = failed[k] || skipped, .skipped = skipped};
            points[i][k].of_dt = failed[k] ? NAN : distance(exact[k], limit[k]);
        }
        measure(d, (const double(*)[3])exact, limit, points[i]);
    }
}

/* ---- tables ---- */

/* The fastest setting that leaves no more; NULL: none does. */
static const point *fastest(point (*points)[PEER_CODES], int code, double most) {
    const point *best = NULL;
    for (int i = 0; i < LEVELS; i++) {
        const point *p = &points[i][code];
        if (!p->failed && p->left <= most && (!best || p->us < best->us)) {
            best = p;
        }
    }
    return best;
}

static void print_equal(point (*points)[PEER_CODES], int code, double most, const char *what) {
    const point *p = fastest(points, code, most), *own = fastest(points, 0, most);
    if (p && own) {
        printf("  %s %.1e m: %s %.1f us (%.0e), spar %.1f us (%.0e): %.1f times\n", what, most, peer_codes[code].name,
               p->us, pow(10, -p->level), own->us, pow(10, -own->level), p->us / own->us);
    }
}

static void compare_newton(const deck *d, int at, const double (*limit)[3]) {
    point points[LEVELS][PEER_CODES];
    measure_levels(d, at, 1, limit, points);
    printf("\n%s, dt %g s: us a step, and what Newton leaves at the tip, m\n%-10s", d->name,
           d->scene.end / (d->fewest << at), "tolerance");
    for (int k = 0; k < PEER_CODES; k++) {
        printf(here[k] ? " %21s" : "", peer_codes[k].name);
    }
    for (int i = 0; i < LEVELS; i++) {
        printf("\n%-10.0e", pow(10, -LOOSEST - i));
        for (int k = 0; k < PEER_CODES; k++) {
            const point *p = &points[i][k];
            printf(!here[k]     ? ""
                   : p->skipped ? "                     -"
                   : p->failed  ? "                 fails"
                                : " %11.2f %9.1e",
                   p->us, p->left);
        }
    }
    printf("\n");
    for (int k = 1; k < PEER_CODES; k++) {
        const point *p = &points[OWN - LOOSEST][k];
        if (!p->failed) {
            printf("%s: of dt %.1e m, spar %.1e m\n", peer_codes[k].name, p->of_dt, points[0][0].of_dt);
            print_equal(points, k, p->left, "as by default, left");
        }
        for (double most = 1e-3; most > 1e-10; most /= 100) {
            print_equal(points, k, most, "left");
        }
    }
}

/* The setting with the least milliseconds to an error up to `most`; NULL: none has it. */
static const point *cheapest(point (*points)[LEVELS][PEER_CODES], const deck *d, int code, double most) {
    const point *best = NULL;
    for (int dt = 0; dt < d->dts; dt++) {
        for (int i = 0; i < LEVELS; i += 2) {
            const point *p = &points[dt][i][code];
            if (!p->failed && p->error <= most && (!best || p->us * p->steps < best->us * best->steps)) {
                best = p;
            }
        }
    }
    return best;
}

static double ms_of(const point *p) {
    return 1e-3 * p->us * p->steps;
}

static void write_points(FILE *csv, const deck *d, point (*points)[LEVELS][PEER_CODES]) {
    for (int k = 0; k < PEER_CODES && csv; k++) {
        for (int i = 0; i < d->dts * LEVELS; i++) {
            const point *p = &points[i / LEVELS][i % LEVELS][k];
            if (i % LEVELS % 2 == 0 && !p->failed) {
                fprintf(csv, "%s,%s,%g,%g,%.4g,%.3g,%.3g,%.3g,%.4g\n", d->name, peer_codes[k].name,
                        d->scene.end / p->steps, pow(10, -p->level), p->us, p->left, p->of_dt, p->error, ms_of(p));
            }
        }
    }
}

static void print_least(const deck *d, point (*points)[LEVELS][PEER_CODES], double most) {
    const point *own = cheapest(points, d, 0, most);
    printf("%8.0e m", most);
    for (int k = 0; k < PEER_CODES; k++) {
        const point *p = here[k] ? cheapest(points, d, k, most) : NULL;
        if (p) {
            printf("   %s %.3f (dt %g, %.0e)", peer_codes[k].name, ms_of(p), d->scene.end / p->steps,
                   pow(10, -p->level));
        }
        if (p && k > 0 && own) {
            printf(": %.1f times", ms_of(p) / ms_of(own));
        }
    }
    printf(own ? "\n" : "   spar does not have it\n");
}

static void print_errors(const deck *d, const double (*limit)[3]) {
    printf("\n%s, error of dt from %g s on, halved each time, m\n", d->name, d->scene.end / d->fewest);
    for (int k = 0; k < PEER_CODES; k++) {
        printf(here[k] ? "  %-12s" : "", peer_codes[k].name);
        for (int dt = 0; dt < d->dts && here[k]; dt++) {
            double u[3];
            int bad = run_tight(k, &d->scene, d->fewest << dt, u);
            printf(" %.2e%s", bad ? NAN : distance(u, limit[k]), dt == d->dts - 1 ? "\n" : "");
        }
    }
}

static void compare_curves(const deck *d, const double (*limit)[3], FILE *csv) {
    static point points[MOST_DTS][LEVELS][PEER_CODES];
    for (int dt = 0; dt < d->dts; dt++) {
        measure_levels(d, dt, 2, limit, points[dt]);
    }
    write_points(csv, d, points);
    print_errors(d, limit);
    printf("least milliseconds to an error of the tip at %g s, each code at its best dt and tolerance\n", d->scene.end);
    for (double most = 1e-1; most > 5e-5; most /= sqrt(10)) {
        print_least(d, points, most);
    }
}

static void play(const deck *d, const asked *a, FILE *csv) {
    double limit[PEER_CODES][3];
    int were[PEER_CODES];
    memcpy(were, here, sizeof here);
    printf("\n%s: %d blade(s), %d nodes; the tip at %g s, as dt goes to 0, m\n", d->name, d->scene.blades,
           d->scene.nodes, d->scene.end);
    for (int k = 0; k < PEER_CODES; k++) {
        if (here[k] && limit_of(k, d, limit[k])) {
            printf("  %-12s cannot\n", peer_codes[k].name);
            here[k] = 0;
        } else if (here[k]) {
            printf("  %-12s %11.7f %11.7f %11.7f   %.1e from spar's\n", peer_codes[k].name, limit[k][0], limit[k][1],
                   limit[k][2], distance(limit[k], limit[0]));
        }
    }
    (void)fflush(stdout);
    for (int i = 0; i < 2 && (i == 0 || d->at[i] != d->at[0]) && !a->errors; i++) {
        compare_newton(d, d->at[i], (const double(*)[3])limit);
    }
    if (a->errors) {
        print_errors(d, (const double(*)[3])limit);
    } else if (a->curves) {
        compare_curves(d, (const double(*)[3])limit, csv);
    }
    (void)fflush(stdout);
    memcpy(here, were, sizeof here);
}

/* ---- the program ---- */

static int play_all(int count, char **names, const asked *a, FILE *csv, const nrel5mw *tables) {
    deck d;
    for (int i = 0; i < count; i++) {
        if (read_deck(names[i], a, tables, &d)) {
            fprintf(stderr, "peers: no scene '%s': box, push, nrel, blade or rotor, and 3 to 20 nodes\n", names[i]);
            return 2;
        }
        play(&d, a, csv);
    }
    return 0;
}

/* Where scenes begin among the arguments; -1: one is not known. */
static int read_arguments(int argc, char **argv, asked *a) {
    int at = 1;
    for (; at < argc && argv[at][0] == '-'; at++) {
        int two = at + 1 < argc;
        if (strcmp(argv[at], "--curves") == 0) {
            a->curves = 1;
        } else if (strcmp(argv[at], "--errors") == 0) {
            a->errors = 1;
        } else if (strcmp(argv[at], "--joints") == 0) {
            a->joints = 1;
        } else if (two && strcmp(argv[at], "--csv") == 0) {
            a->table = argv[++at];
        } else if (two && strcmp(argv[at], "--blade") == 0) {
            a->file = argv[++at];
        } else if (two && strcmp(argv[at], "--end") == 0) {
            a->end = atof(argv[++at]);
        } else if (two && strcmp(argv[at], "--rho-inf") == 0) {
            a->rho_inf = atof(argv[++at]);
        } else {
            return -1;
        }
    }
    return at;
}

int main(int argc, char **argv) {
    static char *usual[] = {"box6", "box8", "box11"};
    asked a = {0};
    nrel5mw tables;
    int at = read_arguments(argc, argv, &a);
    if (at < 0) {
        fprintf(stderr, "usage: peers [--curves | --errors] [--csv FILE] [--blade FILE] [--end SECONDS] [--rho-inf R] "
                        "[--joints] [scene ...]\n");
        return 2;
    }
    FILE *csv = a.table ? fopen(a.table, "w") : NULL;
    if ((a.table && !csv) || peer_codes_begin(argv[0]) || nrel5mw_load(&tables, SPAR_DATA_DIR "/nrel5mw") != SPAR_OK) {
        fprintf(stderr, "peers: cannot write, or no tables of the NREL 5-MW rotor\n");
        return 1;
    }
    for (int k = 0; k < PEER_CODES; k++) {
        here[k] = peer_codes[k].here();
        printf(k == 0 ? "" : here[k] ? "%s: here\n" : "%s: not here, %s\n", peer_codes[k].name, peer_codes[k].missing);
    }
    if (csv) {
        fprintf(csv, "scene,code,dt,tolerance,us,left,of_dt,error,ms\n");
    }
    int status = argc > at ? play_all(argc - at, argv + at, &a, csv, &tables) : play_all(3, usual, &a, csv, &tables);
    nrel5mw_free(&tables);
    peer_codes_end();
    return csv && fclose(csv) != 0 ? 1 : status;
}
