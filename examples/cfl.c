/* A host whose dt follows a CFL condition: a traffic light hangs from a mast in a wind that speeds up and slows down,
   and each step is as long as the wind takes for a part of a cell. Steps are cut to meet the times of output, too. No
   step is as long as the one before it.

   The same wind in even steps, as many, and in steps 16 times shorter stand beside it. Printed: a table, and how far
   both are from the short steps. With a folder as argument: its cfl.csv has every step, cfl.gp draws it (gnuplot).

     cfl [folder] */
#include <math.h>
#include <spar/spar.h>
#include <spar/spar_coupling.h>
#include <spar/spar_structure.h>
#include <stdio.h>
#include <string.h>

static const double pi = 3.14159265358979323846;
static const double cell = 0.5, courant = 0.4;           /* m; part of a cell that the wind goes in a step */
static const double seconds = 12, output = 0.25;         /* s */
static const double height = 8, density = 1.225;         /* m, kg/m^3 */
static const double diameter = 0.1, wall = 0.003;        /* m, of the mast, a steel tube */
static const double mass = 20, below = 0.5, area = 0.48; /* kg; m below its hinge; drag coefficient times m^2 */
enum { NODES = 6, PLACES = 48, SHORTER = 16 };

/* Two gusts on 8 m/s, and a ripple. */
static double wind(double t) {
    double sum = 8 + 0.5 * sin(2 * pi * 1.3 * t);
    const double begins[2] = {1, 7}, lasts[2] = {4, 2}, high[2] = {22, 14};
    for (int i = 0; i < 2; i++) {
        double part = (t - begins[i]) / lasts[i];
        sum += part > 0 && part < 1 ? 0.5 * high[i] * (1 - cos(2 * pi * part)) : 0;
    }
    return sum;
}

typedef struct world {
    spar_session *session;
    spar_member *mast, *light;
    spar_joint *hinge;
    spar_fluid *along, *around; /* the mast, the light */
} world;

/* ---- the structure ---- */

static int create_mast(world *w) {
    const double E = 2.1e11, G = 8.1e10, steel = 7850, A = pi * diameter * wall, I = A * diameter * diameter / 8;
    const double stiff[6] = {E * A, 0.5 * G * A, 0.5 * G * A, 2 * G * I, E * I, E * I},
                 size[6] = {A, A, A, 2 * I, I, I};
    const double ends[2] = {0, 1}, line[6] = {0, 0, 0, 0, 0, height}, damping[6] = {1e-3, 1e-3, 1e-3, 1e-3, 1e-3, 1e-3};
    double K[36] = {0}, M[36] = {0};
    for (int i = 0; i < 6; i++) {
        K[7 * i] = stiff[i];
        M[7 * i] = steel * size[i];
    }
    int status = spar_beam_create(w->session, "mast", 1, NODES, &w->mast);
    status = status == SPAR_OK ? spar_beam_set_axis(w->mast, 2, ends, line, NULL) : status;
    status = status == SPAR_OK ? spar_beam_set_sections(w->mast, 1, ends, K, M) : status;
    status = status == SPAR_OK ? spar_beam_set_damping(w->mast, damping) : status;
    return status == SPAR_OK ? spar_member_commit(w->mast) : status;
}

static int create_light(world *w) {
    const double x[3] = {0, 0, height - below}, top[3] = {0, 0, height}, upright[4] = {1, 0, 0, 0},
                 J = mass * 0.04; /* 0.6 m high */
    const double m[36] = {[0] = mass, [7] = mass, [14] = mass, [21] = J, [28] = J, [35] = J};
    int status = spar_rigid_create(w->session, "light", x, upright, m, &w->light);
    status = status == SPAR_OK ? spar_member_commit(w->light) : status;
    status = status == SPAR_OK
                 ? spar_joint_create(w->session, "hinge", w->light, 0, w->mast, NODES - 1, SPAR_FREE_RY, &w->hinge)
                 : status;
    return status == SPAR_OK ? spar_joint_set_frame(w->hinge, top, upright) : status;
}

static int create_fluids(world *w) {
    double along[NODES][3] = {{0}}, light[3] = {0, 0, height - below};
    for (int i = 0; i < NODES; i++) {
        along[i][2] = height * i / (NODES - 1);
    }
    int status = spar_fluid_create(w->mast, "along", &w->along);
    status = status == SPAR_OK ? spar_fluid_set_motion_nodes(w->along, NODES, &along[0][0]) : status;
    status = status == SPAR_OK ? spar_fluid_set_force_nodes(w->along, NODES, &along[0][0]) : status;
    status = status == SPAR_OK ? spar_fluid_map(w->along) : status;
    status = status == SPAR_OK ? spar_fluid_create(w->light, "around", &w->around) : status;
    status = status == SPAR_OK ? spar_fluid_set_motion_nodes(w->around, 1, light) : status;
    status = status == SPAR_OK ? spar_fluid_set_force_nodes(w->around, 1, light) : status;
    return status == SPAR_OK ? spar_fluid_map(w->around) : status;
}

/* ---- the flow: drag by the wind relative to what it meets; a flow solver would stand in its place ---- */

static int push_drag(spar_fluid *fluid, int n, const double *face, double speed) {
    double v[NODES][3], force[NODES][3];
    int status = spar_fluid_pull_motion(fluid, 1, NULL, &v[0][0]);
    for (int i = 0; i < n; i++) {
        const double u[3] = {speed - v[i][0], -v[i][1], -v[i][2]}, size = sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
        for (int k = 0; k < 3; k++) {
            force[i][k] = 0.5 * density * face[i] * size * u[k];
        }
    }
    return status == SPAR_OK ? spar_fluid_push_forces(fluid, &force[0][0], NULL) : status;
}

static int solve_flow(spar_session *session, double t, double dt, int iteration, void *context) {
    world *w = context;
    double face[NODES];
    (void)session, (void)iteration;
    for (int i = 0; i < NODES; i++) { /* drag coefficient 1 */
        face[i] = diameter * height / (NODES - 1) * (i == 0 || i == NODES - 1 ? 0.5 : 1);
    }
    int status = push_drag(w->along, NODES, face, wind(t + dt));
    return status == SPAR_OK ? push_drag(w->around, 1, &area, wind(t + dt)) : status;
}

/* ---- runs ---- */

enum { TIP, ANGLE, FORCE, FIGURES };

typedef struct history {
    double at[PLACES + 1][FIGURES], most[FIGURES]; /* at the times of output; the largest of all steps */
    double shortest, longest;
    int steps;
} history;

static int create(world *w) {
    int status = spar_session_create(&w->session);
    status = status == SPAR_OK ? spar_session_set_gravity(w->session, (const double[]){0, 0, -9.81}) : status;
    status = status == SPAR_OK ? spar_session_set_coupling(w->session, SPAR_COUPLING_IQN_ILS, 1e-9, 1e-7, 50) : status;
    status = status == SPAR_OK ? create_mast(w) : status;
    status = status == SPAR_OK ? create_light(w) : status;
    return status == SPAR_OK ? create_fluids(w) : status;
}

static int look(const world *w, double out[FIGURES]) {
    double q[7 * NODES], z[6], f[6];
    int status = spar_member_get_motion(w->mast, q, NULL, NULL);
    status = status == SPAR_OK ? spar_joint_get_motion(w->hinge, z, NULL, NULL) : status;
    status = status == SPAR_OK ? spar_joint_get_load(w->hinge, f) : status;
    if (status == SPAR_OK) {
        out[TIP] = q[7 * (NODES - 1)];
        out[ANGLE] = -z[4] * 180 / pi;
        out[FORCE] = sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]);
    }
    return status;
}

/* even: s, the length of all steps; 0: what the wind allows, cut to meet the next output. file: NULL, or for each
   step. */
static int run(double even, history *h, FILE *file) {
    world w = {NULL};
    int status = create(&w);
    *h = (history){.shortest = HUGE_VAL};
    double t = 0;
    for (int k = 0; k < PLACES && status == SPAR_OK; k++) {
        const double end = (k + 1) * output;
        status = k == 0 ? spar_session_solve_initial(w.session, 1e-3, solve_flow, &w, NULL) : status;
        while (t < end && status == SPAR_OK) {
            double dt = even > 0 ? even : courant * cell / wind(t), now[FIGURES];
            int last = t + dt * (1 + 1e-9) >= end;
            dt = last ? end - t : dt;
            status = spar_step(w.session, dt, solve_flow, &w, NULL);
            t = last ? end : t + dt;
            status = status == SPAR_OK ? look(&w, now) : status;
            for (int i = 0; i < FIGURES && status == SPAR_OK; i++) {
                h->at[k + 1][i] = now[i];
                h->most[i] = fmax(h->most[i], fabs(now[i]));
            }
            h->shortest = fmin(h->shortest, dt), h->longest = fmax(h->longest, dt);
            h->steps++;
            if (file && status == SPAR_OK) {
                fprintf(file, "%.9g,%.9g,%.9g,%.9g,%.9g,%.9g\n", t, dt, wind(t), now[TIP], now[ANGLE], now[FORCE]);
            }
        }
    }
    if (status != SPAR_OK) {
        fprintf(stderr, "cfl: %s\n", w.session ? spar_session_message(w.session) : spar_status_text(status));
    }
    spar_session_destroy(&w.session);
    return status;
}

/* ---- what it prints and writes ---- */

/* The largest difference over the times of output, over the largest that the figure becomes. */
static double distance(const history *a, const history *b, int figure) {
    double most = 0;
    for (int k = 1; k <= PLACES; k++) {
        most = fmax(most, fabs(a->at[k][figure] - b->at[k][figure]));
    }
    return most / b->most[figure];
}

static void print(const history *cfl, const history *even, const history *fine) {
    static const char *const names[FIGURES] = {"tip of the mast", "angle of the light", "force of the hinge"};
    printf("   t   wind |  tip, m: CFL    even |  angle, deg: CFL    even |  hinge, N: CFL    even\n");
    for (int k = 2; k <= PLACES; k += 2) {
        const double *a = cfl->at[k], *b = even->at[k];
        printf("%4.1f  %5.2f |     %8.5f %8.5f |         %8.3f %8.3f |       %8.2f %8.2f\n", k * output,
               wind(k * output), a[TIP], b[TIP], a[ANGLE], b[ANGLE], a[FORCE], b[FORCE]);
    }
    printf("\nsteps: CFL %d of %.2g to %.2g s, even %d of %.4g s\n", cfl->steps, cfl->shortest, cfl->longest,
           even->steps, even->longest);
    printf("from %d times shorter steps, of the largest:\n", SHORTER);
    for (int i = 0; i < FIGURES; i++) {
        printf("  %-18s  CFL %.1e, even %.1e\n", names[i], distance(cfl, fine, i), distance(even, fine, i));
    }
    printf("largest force of the hinge: CFL %.1f N, even %.1f N, shorter %.1f N\n", cfl->most[FORCE], even->most[FORCE],
           fine->most[FORCE]);
}

static FILE *create_file(const char *folder, const char *name) {
    char path[1024];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "w");
    if (!file) {
        fprintf(stderr, "cfl: '%s' cannot be written\n", path);
    }
    return file;
}

static int write_script(const char *folder) {
    FILE *file = create_file(folder, "cfl.gp");
    if (!file) {
        return 1;
    }
    fprintf(file, "set terminal pngcairo size 1000,900 font 'sans,12'\nset output 'cfl.png'\n"
                  "set datafile separator ','\nset grid linecolor rgb '#dddddd'\nset lmargin 11\n"
                  "set key top right opaque box lc rgb '#cccccc'\n"
                  "set multiplot layout 4,1\nset ylabel 'wind (m/s)'\n"
                  "plot 'cfl.csv' index 0 using 1:3 with lines lw 2 lc rgb '#555555' notitle\n"
                  "set ylabel 'dt (s)'\nset logscale y\nset format y '%%g'\n");
    const char *const labels[3] = {"angle (deg)", "hinge (N)", NULL};
    for (int i = -1; i < 2; i++) {
        const int column = i < 0 ? 2 : 5 + i;
        if (i >= 0) {
            fprintf(file, "unset logscale y\nset ylabel '%s'\n%s", labels[i], i ? "set xlabel 'time (s)'\n" : "");
        }
        fprintf(file,
                "plot 'cfl.csv' index 0 using 1:%d with lines lw 2 lc rgb '#1b6ca8' title 'dt by CFL', "
                "'' index 1 using 1:%d with lines dt 2 lw 2 lc rgb '#d1495b' title 'even'\n",
                column, column);
    }
    fprintf(file, "unset multiplot\n");
    return fclose(file) != 0;
}

int main(int argc, char **argv) {
    static history cfl, even, fine;
    FILE *file = NULL;
    if (argc > 2 || (argc == 2 && (argv[1][0] == '-' || write_script(argv[1]) != 0))) {
        fprintf(stderr, "usage: cfl [folder]\n");
        return 1;
    }
    if (argc == 2 && !(file = create_file(argv[1], "cfl.csv"))) {
        return 1;
    }
    int failed = run(0, &cfl, file) != SPAR_OK;
    if (!failed) {
        const double mean = output / ceil(output / (seconds / cfl.steps) - 1e-9); /* a whole number in an output's */
        if (file) {
            fprintf(file, "\n\n");
        }
        failed = run(mean, &even, file) != SPAR_OK || run(mean / SHORTER, &fine, NULL) != SPAR_OK;
    }
    if (file && fclose(file) != 0) {
        failed = 1;
    }
    if (!failed) {
        print(&cfl, &even, &fine);
    }
    return failed;
}
