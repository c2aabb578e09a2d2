#include "rotor_report.h"
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

static const double pi = 3.14159265358979323846;

/* ---- gathering ---- */

int rotor_report_begin(rotor_report *r) {
    double end = r->options->seconds, turn = r->speed > 0 ? 2 * pi / r->speed : INFINITY;
    r->revolutions = floor(0.5 * end / turn); /* what comes before is for the transients */
    r->mean_from = end - (r->revolutions > 0 ? r->revolutions * turn : 0.5 * end);
    r->columns = ROTOR_BLADES + ROTOR_PER_BLADE * r->rotor->blades;
    int64_t n = ROTOR_SPAN * r->turbine->aero_n;
    r->sum = calloc((size_t)n, sizeof *r->sum);
    r->least = malloc((size_t)n * sizeof *r->least);
    r->most = malloc((size_t)n * sizeof *r->most);
    if (!r->sum || !r->least || !r->most) {
        return 1;
    }
    for (int64_t i = 0; i < n; i++) {
        r->least[i] = INFINITY;
        r->most[i] = -INFINITY;
    }
    return 0;
}

void rotor_report_free(rotor_report *r) {
    free(r->history);
    free(r->sum);
    free(r->least);
    free(r->most);
    *r = (rotor_report){0};
}

double *rotor_report_row(rotor_report *r) {
    if (r->rows == r->room) {
        int64_t room = r->room > 0 ? 2 * r->room : 1024;
        double *more = realloc(r->history, (size_t)(room * r->columns) * sizeof *more);
        if (!more) {
            return NULL;
        }
        r->history = more;
        r->room = room;
    }
    return r->history + r->columns * r->rows++;
}

double rotor_report_weight(const rotor_report *r, double t, double dt) {
    double part = (t - r->mean_from) / dt;
    return part < 0 ? 0 : part > 1 ? 1 : part;
}

void rotor_report_span(rotor_report *r, const double *value, double weight) {
    for (int64_t i = 0; i < ROTOR_SPAN * r->turbine->aero_n; i++) {
        r->sum[i] += weight * value[i];
        r->least[i] = fmin(r->least[i], value[i]);
        r->most[i] = fmax(r->most[i], value[i]);
    }
    r->weight += weight;
}

/* Mean, least and most over the last revolutions of the columns first, first + stride, ... of every row. */
static void statistics(const rotor_report *r, int first, int stride, double out[3]) {
    double weights = 0, sum = 0;
    out[1] = INFINITY;
    out[2] = -INFINITY;
    for (int64_t i = 1; i < r->rows; i++) {
        const double *row = r->history + i * r->columns;
        double w = rotor_report_weight(r, row[ROTOR_TIME], row[ROTOR_TIME] - row[ROTOR_TIME - r->columns]);
        for (int c = first; w > 0 && c<(stride > 0 ? r->columns : first + 1); c += stride> 0 ? stride : 1) {
            weights += w;
            sum += w * row[c];
            out[1] = fmin(out[1], row[c]);
            out[2] = fmax(out[2], row[c]);
        }
    }
    out[0] = weights > 0 ? sum / weights : NAN;
}

/* ---- AeroDyn's figures ---- */

typedef struct figures {
    int found, same; /* a case of this wind and speed; and with these blades and this shaft too */
    double thrust, torque, power;
    int axial;
    double lumped[64];
} figures;

static int near(double a, double b) {
    return fabs(a - b) < 1e-6 * (1 + fabs(b));
}

static figures read_figures(const rotor_report *r) {
    const rotor_options *o = r->options;
    figures f = {0};
    char path[1024], line[1024];
    snprintf(path, sizeof path, "%s/aerodyn.txt", o->data);
    FILE *file = fopen(path, "r");
    while (file && fgets(line, sizeof line, file)) {
        double wind, rpm, thrust, torque, power;
        int used;
        if (sscanf(line, "case %lf %lf %lf %lf %lf", &wind, &rpm, &thrust, &torque, &power) == 5 &&
            near(wind, o->wind) && near(rpm, r->speed * 30 / pi)) {
            f = (figures){.found = 1, .thrust = thrust, .torque = torque, .power = power};
        } else if (sscanf(line, "axial %lf%n", &wind, &used) == 1 && f.found && near(wind, o->wind)) {
            char *at = line + used, *end;
            for (double x = strtod(at, &end); end != at && f.axial < 64; x = strtod(at, &end)) {
                f.lumped[f.axial++] = x;
                at = end;
            }
        }
    }
    if (file) {
        fclose(file);
    }
    f.found = f.found && o->shear == 0 && o->gust == 0 && o->yaw == 0 && r->rotor->pitch == 0 && !o->aero_effects_given;
    f.axial = f.axial == r->turbine->aero_n ? f.axial : 0;
    f.same = o->rigid && r->turbine->tilt == 0 && r->rotor->precone == 0;
    return f;
}

/* Loads per length whose consistent lumping is f: the tridiagonal system of the hat functions' mass matrix. */
static void spread(int64_t n, const double *span, const double *f, double *density) {
    double diagonal[64];
    for (int64_t i = 0; i < n; i++) {
        double before = i > 0 ? span[i] - span[i - 1] : 0, after = i + 1 < n ? span[i + 1] - span[i] : 0;
        double factor = i > 0 ? before / 6 / diagonal[i - 1] : 0;
        diagonal[i] = (before + after) / 3 - factor * before / 6;
        density[i] = f[i] - (i > 0 ? factor * density[i - 1] : 0);
    }
    for (int64_t i = n - 1; i >= 0; i--) {
        double after = i + 1 < n ? (span[i + 1] - span[i]) / 6 * density[i + 1] : 0;
        density[i] = (density[i] - after) / diagonal[i];
    }
}

/* ---- the table ---- */

static void print_row(FILE *file, const char *name, const char *unit, double scale, const double s[3]) {
    fprintf(file, "  %-24s %-6s", name, unit);
    for (int i = 0; i < 3; i++) { /* no zero with a sign */
        double x = s[i] * scale;
        fprintf(file, " %12.4f", fabs(x) < 5e-5 ? 0 : x);
    }
    fputc('\n', file);
}

static void print_scene(const rotor_report *r, FILE *file) {
    const rotor_options *o = r->options;
    fprintf(file, "\nNREL 5-MW rotor in %g m/s", o->wind);
    if (o->shear != 0) {
        fprintf(file, ", shear %g", o->shear);
    }
    if (o->gust != 0) {
        fprintf(file, ", gust of %g m/s", o->gust);
    }
    fprintf(file, "; %.4g rev/min, pitch %.3g deg, tilt %.3g deg, precone %.3g deg\n", r->speed * 30 / pi,
            r->rotor->pitch * 180 / pi, r->turbine->tilt * 180 / pi, r->rotor->precone * 180 / pi);
    if (o->rigid) {
        fprintf(file, "%d rigid blades", r->rotor->blades);
    } else {
        fprintf(file, "%d flexible blades of %d element(s) with %d nodes", r->rotor->blades, o->elements, o->nodes);
    }
    fprintf(file, ", %lld sections each; %g s in steps of %g s; coupling %s; %d rank(s)\n",
            (long long)r->turbine->aero_n, o->seconds, o->dt, rotor_scheme_name(o->scheme), r->ranks);
}

static void print_means(const rotor_report *r, FILE *file) {
    static const struct {
        const char *name, *unit;
        double scale;
        int column, blades;
    } row[] = {{"thrust", "kN", 1e-3, ROTOR_THRUST, 0},
               {"torque", "kN m", 1e-3, ROTOR_TORQUE, 0},
               {"power", "kW", 1e-3, ROTOR_POWER, 0},
               {"tip deflection, flap", "m", 1, ROTOR_BLADES + ROTOR_FLAP, 1},
               {"tip deflection, edge", "m", 1, ROTOR_BLADES + ROTOR_EDGE, 1},
               {"root bending, flap", "kN m", 1e-3, ROTOR_BLADES + ROTOR_FLAP_MOMENT, 1},
               {"root bending, edge", "kN m", 1e-3, ROTOR_BLADES + ROTOR_EDGE_MOMENT, 1},
               {"coupling iterations", "", 1, ROTOR_ITERATIONS, 0}};
    double s[3], disc = pi * r->turbine->tip_radius * r->turbine->tip_radius;
    double wind = r->options->wind, free_power = 0.5 * r->turbine->density * disc * wind * wind * wind;
    if (r->revolutions > 0) {
        fprintf(file, "\n  last %g revolution(s), from %.2f s", r->revolutions, r->mean_from);
    } else {
        fprintf(file, "\n  last half, from %.2f s%10s", r->mean_from, "");
    }
    fprintf(file, " %8s %12s %12s\n", "mean", "least", "most");
    for (size_t i = 0; i < sizeof row / sizeof row[0]; i++) {
        statistics(r, row[i].column, row[i].blades ? ROTOR_PER_BLADE : 0, s);
        print_row(file, row[i].name, row[i].unit, row[i].scale, s);
        if (row[i].column == ROTOR_POWER && free_power > 0) {
            print_row(file, "power coefficient", "", 1 / free_power, s);
        }
    }
    fprintf(file, "  flap: downwind; edge: towards the trailing edge; both in the frame that turns with the root\n");
    fprintf(file, "  unit quaternions to %.1e\n", r->quaternion_error);
}

static void print_figures(const rotor_report *r, FILE *file) {
    figures f = read_figures(r);
    if (!f.found) {
        return;
    }
    const double reference[] = {f.thrust, f.torque, f.power};
    static const char *const name[] = {"thrust, kN", "torque, kN m", "power, kW"};
    fprintf(file, "\n  %-31s %12s %12s %12s\n", f.same ? "against AeroDyn 5" : "beside a rigid, flat rotor", "spar",
            "AeroDyn 5", f.same ? "difference" : "effect");
    for (int i = 0; i < 3; i++) {
        double s[3];
        statistics(r, ROTOR_THRUST + i, 0, s);
        fprintf(file, "  %-31s %12.4f %12.4f %11.3f%%\n", name[i], s[0] * 1e-3, reference[i] * 1e-3,
                100 * (s[0] / reference[i] - 1));
    }
    double worst = 0, most = 0;
    for (int i = 0; i < f.axial; i++) {
        worst = fmax(worst, fabs(r->sum[ROTOR_LUMPED * r->turbine->aero_n + i] / r->weight - f.lumped[i]));
        most = fmax(most, f.lumped[i]);
    }
    if (f.axial > 0) {
        fprintf(file, "  axial load of the sections: %s by %.4f kN at most, %.3f%% of the largest\n",
                f.same ? "off" : "other", worst * 1e-3, 100 * worst / most);
    }
    if (!f.same) {
        fprintf(file, "  effect: what bending, tilt and cone change; like is compared with like by --rigid --tilt 0 "
                      "--precone 0\n");
    }
}

static void print_wall(const rotor_report *r, FILE *file) {
    static const char *const name[] = {"predict loads", "structure solve", "motion out", "aerodynamics",
                                       "loads in",      "check coupling",  "accept",     "record and pictures"};
    double known = 0;
    fprintf(file, "\n  wall time of rank 0                       s            %%\n");
    for (int i = 0; i < ROTOR_PHASES; i++) {
        fprintf(file, "  %-31s %12.3f %12.1f\n", name[i], r->phase[i], 100 * r->phase[i] / r->wall);
        known += r->phase[i];
    }
    fprintf(file, "  %-31s %12.3f %12.1f\n", "the rest", r->wall - known, 100 * (r->wall - known) / r->wall);
    fprintf(file, "  %-31s %12.3f %12s  %.3g x real time\n", "all", r->wall, "", r->options->seconds / r->wall);
}

void rotor_report_print(const rotor_report *r, FILE *file) {
    print_scene(r, file);
    print_means(r, file);
    print_figures(r, file);
    print_wall(r, file);
}

/* ---- files ---- */

int rotor_make_folder(const char *path) {
    char part[1024];
    if (snprintf(part, sizeof part, "%s", path) >= (int)sizeof part) {
        fprintf(stderr, "rotor: the folder's name is too long\n");
        return 1;
    }
    for (char *at = part + 1;; at++) {
        if (*at == '/' || *at == '\0') {
            char kept = *at;
            *at = '\0';
            if (mkdir(part, 0777) != 0 && errno != EEXIST) {
                fprintf(stderr, "rotor: the folder '%s' cannot be made: %s\n", part, strerror(errno));
                return 1;
            }
            *at = kept;
            if (kept == '\0') {
                return 0;
            }
        }
    }
}

static FILE *create(const rotor_report *r, const char *name) {
    char path[1024];
    snprintf(path, sizeof path, "%s/%s", r->options->out, name);
    FILE *file = fopen(path, "w");
    if (!file) {
        fprintf(stderr, "rotor: '%s' cannot be written: %s\n", path, strerror(errno));
    }
    return file;
}

static int finish(FILE *file, const char *name) {
    int bad = ferror(file);
    if (fclose(file) != 0 || bad) {
        fprintf(stderr, "rotor: %s could not be written whole: %s\n", name, strerror(errno));
        return 1;
    }
    return 0;
}

static int write_history(const rotor_report *r) {
    FILE *file = create(r, "history.csv");
    if (!file) {
        return 1;
    }
    fprintf(file, "time_s,azimuth_deg,wind_m_s,thrust_N,torque_Nm,power_W,iterations");
    for (int b = 1; b <= r->rotor->blades; b++) {
        fprintf(file, ",tip_flap%d_m,tip_edge%d_m,root_flap%d_Nm,root_edge%d_Nm", b, b, b, b);
    }
    for (int64_t i = 0; i < r->rows; i++) {
        for (int c = 0; c < r->columns; c++) {
            fprintf(file, "%s%.15g", c == 0 ? "\n" : ",", r->history[i * r->columns + c]);
        }
    }
    fputc('\n', file);
    return finish(file, "history.csv");
}

static int write_span(const rotor_report *r, const figures *f) {
    FILE *file = create(r, "span.csv");
    if (!file) {
        return 1;
    }
    int64_t n = r->turbine->aero_n;
    double reference[64];
    spread(f->axial, r->turbine->span, f->lumped, reference);
    fprintf(file, "radius_m");
    static const char *const name[] = {"axial_N_m", "tangential_N_m", "axial_lumped_N", "alpha_rad", "axial_induction"};
    for (int k = 0; k < ROTOR_SPAN; k++) {
        fprintf(file, ",%s,%s_least,%s_most", name[k], name[k], name[k]);
    }
    fprintf(file, ",aerodyn_axial_N_m,aerodyn_axial_lumped_N");
    for (int64_t i = 0; i < n; i++) {
        fprintf(file, "\n%.10g", r->turbine->hub_radius + r->turbine->span[i]);
        for (int k = 0; k < ROTOR_SPAN; k++) {
            int64_t at = k * n + i;
            fprintf(file, ",%.15g,%.15g,%.15g", r->sum[at] / r->weight, r->least[at], r->most[at]);
        }
        if (f->axial > 0) {
            fprintf(file, ",%.10g,%.10g", reference[i], f->lumped[i]);
        } else {
            fprintf(file, ",,");
        }
    }
    fputc('\n', file);
    return finish(file, "span.csv");
}

/* One of two panels over time. */
static void put_panel(const rotor_report *r, FILE *file, int lower, const char *label) {
    fprintf(file, "set xlabel '%s'\nset ylabel '%s'\n%s\nplot [0:%g] \\\n", lower ? "time (s)" : "", label,
            lower ? "unset key" : "set key outside top right horizontal samplen 2 font ',12'", r->options->seconds);
}

/* A column of each blade, and the one after it, over time. */
static void put_blades(const rotor_report *r, FILE *file, const char *name, const char *title, int column, double scale,
                       const char *unit) {
    static const char *const direction[] = {"flap, downwind", "edge, to the trailing edge"};
    fprintf(file, "\nset output '%s.png'\nset multiplot layout 2,1 title '%s: '.scene font ',15'\n", name, title);
    for (int k = 0; k < 2; k++) {
        char label[64];
        snprintf(label, sizeof label, "%s (%s)", direction[k], unit);
        put_panel(r, file, k, label);
        for (int b = 0; b < r->rotor->blades; b++) {
            fprintf(file,
                    "  'history.csv' using 1:($%d*%g) with lines linecolor rgb word(shade,%d) title 'blade %d'%s\n",
                    ROTOR_BLADES + b * ROTOR_PER_BLADE + column + k + 1, scale, b % 3 + 1, b + 1,
                    b + 1 < r->rotor->blades ? ", \\" : "");
        }
    }
    fprintf(file, "unset multiplot\n");
}

/* A panel's range of a column: what it spans, and a twentieth of its mean either way at least, so that ripples look
 * small. */
static void put_range(FILE *file, const char *name, int column, double scale) {
    fprintf(file,
            "stats 'history.csv' every ::1 using ($%d*%g) nooutput name 's'\n"
            "wide = 0.05 * abs(s_mean) + 1e-3\n"
            "%s_low = s_min < s_mean - wide ? s_min : s_mean - wide\n"
            "%s_high = s_max > s_mean + wide ? s_max : s_mean + wide\n",
            column + 1, scale, name, name);
}

static void put_power(const rotor_report *r, FILE *file) {
    put_range(file, "thrust", ROTOR_THRUST, 1e-3);
    put_range(file, "power", ROTOR_POWER, 1e-6);
    fprintf(file, "\nset output 'power.png'\nset multiplot layout 2,1 title 'Thrust and power: '.scene font ',15'\n"
                  "set yrange [thrust_low:thrust_high]\n");
    put_panel(r, file, 0, "thrust (kN)");
    fprintf(file, "  'history.csv' using 1:($%d*1e-3) with lines linecolor rgb word(shade,1) notitle\n",
            ROTOR_THRUST + 1);
    fprintf(file, "set yrange [power_low:power_high]\n");
    put_panel(r, file, 1, "power (MW)");
    fprintf(file,
            "  'history.csv' using 1:($%d*1e-6) with lines linecolor rgb word(shade,2) notitle\nunset multiplot\n"
            "set autoscale y\n",
            ROTOR_POWER + 1);
}

/* Mean of a span load over the radius and the band between least and most. */
static void put_band(FILE *file, int load, int shade, const char *pale, const char *title) {
    int column = 2 + 3 * load;
    fprintf(file,
            "  'span.csv' using 1:($%d*1e-3):($%d*1e-3) with filledcurves fillcolor rgb '%s' notitle, \\\n"
            "  'span.csv' using 1:($%d*1e-3) with linespoints pointtype 7 pointsize 0.8 linecolor rgb word(shade,%d) "
            "title '%s (mean; band: range)'",
            column + 1, column + 2, pale, column, shade, title);
}

static void put_span(const rotor_report *r, FILE *file, const figures *f) {
    fprintf(file,
            "\nset output 'span.png'\nset title 'Loads along the span of blade 1: '.scene font ',15'\n"
            "set key inside top left vertical reverse Left font ',12'\nset xlabel 'radius (m)'\n"
            "set ylabel 'force per length (kN/m)'\nset offsets 0,0,graph 0.05,0\nplot [0:%g] \\\n",
            r->turbine->tip_radius);
    put_band(file, ROTOR_AXIAL, 1, "#c6dbef", "along the shaft, downwind");
    fprintf(file, ", \\\n");
    put_band(file, ROTOR_TANGENTIAL, 2, "#f6d5c9", "in the disc, driving");
    if (f->axial > 0) {
        fprintf(file,
                ", \\\n  'span.csv' using 1:($%d*1e-3) with points pointtype 6 pointsize 1.8 linecolor rgb '#222222' "
                "title 'AeroDyn 5, along the shaft%s'",
                2 + 3 * ROTOR_SPAN, f->same ? "" : " (rigid, no tilt, no precone)");
    }
    fputc('\n', file);
}

static void put_advice(FILE *file) {
    fprintf(file, "\nset output 'advice.png'\nset title 'What accuracy costs' font ',15'\nset key off\n"
                  "set xlabel 'error of the deflection'\nset ylabel 'cost of the run, as given: 1'\nset logscale xy\n"
                  "set xrange [*:*]\nset offsets 0,0,0,0\nset xrange [] reverse\n"
                  "stats 'advice.csv' skip 1 using 2:3 nooutput\n"
                  "set xrange [5*STATS_max_x:STATS_min_x/5]\nset yrange [STATS_min_y/3:STATS_max_y*3]\n"
                  "plot 'advice.csv' skip 1 using 2:3 with points pointtype 7 pointsize 2 linecolor rgb '#0b5fa5', \\\n"
                  "  '' skip 1 using 2:3:1 with labels offset 0,1.3\n");
}

static int write_script(const rotor_report *r, const figures *f) {
    FILE *file = create(r, "plots.gp");
    if (!file) {
        return 1;
    }
    fprintf(file,
            "set terminal pngcairo size 1200,720 font 'sans,13' linewidth 1.6\nset datafile separator ','\n"
            "set grid linecolor rgb '#cccccc' linewidth 0.6\nset border 3 linecolor rgb '#555555'\nset tics nomirror\n"
            "set lmargin 12\nset rmargin 4\nshade = '#0b5fa5 #d1603d #3c8d5a'\n"
            "scene = 'NREL 5-MW, %g m/s, %.4g rev/min, %s blades'\n",
            r->options->wind, r->speed * 30 / pi, r->options->rigid ? "rigid" : "flexible");
    put_blades(r, file, "tip", "Tip deflection", ROTOR_FLAP, 1, "m");
    put_blades(r, file, "root", "Bending moment at the root", ROTOR_FLAP_MOMENT, 1e-6, "MN m");
    put_power(r, file);
    put_span(r, file, f);
    if (isfinite(r->options->tolerance)) {
        put_advice(file);
    }
    return finish(file, "plots.gp");
}

/* Runs gnuplot in the folder. Returns 0 when it drew. */
static int draw(const char *folder) {
    fflush(NULL);
    pid_t child = fork();
    if (child == 0) {
        if (chdir(folder) == 0) {
            execlp("gnuplot", "gnuplot", "plots.gp", (char *)NULL);
        }
        _exit(127);
    }
    int status = 1;
    return child < 0 || waitpid(child, &status, 0) != child || !WIFEXITED(status) || WEXITSTATUS(status) != 0;
}

int rotor_report_write(const rotor_report *r) {
    figures f = read_figures(r);
    const char *out = r->options->out;
    f.axial = f.found ? f.axial : 0;
    if (write_history(r) != 0 || write_span(r, &f) != 0 || write_script(r, &f) != 0) {
        return 1;
    }
    printf("\n  %s/history.csv, span.csv\n", out);
    if (!r->options->no_plots) {
        if (draw(out) == 0) {
            printf("  %s/tip.png, root.png, power.png, span.png%s\n", out,
                   isfinite(r->options->tolerance) ? ", advice.png" : "");
        } else {
            printf("  no plots: gnuplot is not there (apt-get install gnuplot-nox), then: cd %s && gnuplot plots.gp\n",
                   out);
        }
    }
    return 0;
}
