#include "turbine_report.h"
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

static const double pi = 3.14159265358979323846;

static const struct {
    const char *name, *unit, *column;
    double scale; /* of the table */
} columns[TURBINE_TIPS] = {{"time", "s", "time_s", 1},
                           {"wind", "m/s", "wind_m_s", 1},
                           {"rotor speed", "rev/min", "rotor_speed_rad_s", 30 / 3.14159265358979323846},
                           {"pitch", "deg", "pitch_rad", 180 / 3.14159265358979323846},
                           {"generator torque", "kN m", "generator_torque_Nm", 1e-3},
                           {"shaft power", "kW", "shaft_power_W", 1e-3},
                           {"electrical power", "kW", "power_W", 1e-3},
                           {"thrust", "kN", "thrust_N", 1e-3},
                           {"aerodynamic torque", "kN m", "air_torque_Nm", 1e-3},
                           {"tower top, downwind", "m", "tower_fore_m", 1},
                           {"tower top, sideways", "m", "tower_side_m", 1},
                           {"tower base, moment", "MN m", "base_moment_Nm", 1e-6},
                           {"drivetrain, twist", "deg", "twist_rad", 180 / 3.14159265358979323846},
                           {"azimuth", "deg", "azimuth_rad", 180 / 3.14159265358979323846},
                           {"coupling iterations", "", "iterations", 1}};

double *turbine_report_row(turbine_report *r) {
    if (r->rows == r->room) {
        int64_t room = r->room > 0 ? 2 * r->room : 1024;
        double(*more)[TURBINE_COLUMNS] = realloc(r->row, (size_t)room * sizeof *more);
        if (!more) {
            return NULL;
        }
        r->row = more;
        r->room = room;
    }
    memset(r->row[r->rows], 0, sizeof r->row[0]);
    return r->row[r->rows++];
}

void turbine_report_free(turbine_report *r) {
    free(r->row);
    *r = (turbine_report){0};
}

/* ---- the table ---- */

/* Mean, least and most of a column, and of those `stride` behind it (0: none), since t. */
static void statistics(const turbine_report *r, double since, int column, int stride, double out[3]) {
    double sum = 0, n = 0;
    out[1] = INFINITY, out[2] = -INFINITY;
    for (int64_t i = 0; i < r->rows; i++) {
        for (int c = column; r->row[i][TURBINE_TIME] >= since && c < TURBINE_COLUMNS; c += stride) {
            double x = r->row[i][c];
            sum += x, n += 1;
            out[1] = fmin(out[1], x), out[2] = fmax(out[2], x);
            if (stride == 0) {
                break;
            }
        }
    }
    out[0] = sum / n;
}

static void print_line(const turbine_report *r, double since, const char *name, const char *unit, int column,
                       int stride, double scale, FILE *file) {
    double s[3];
    statistics(r, since, column, stride, s);
    fprintf(file, "  %-24s %-8s", name, unit);
    for (int i = 0; i < 3; i++) {
        double x = s[i] * scale;
        fprintf(file, " %12.4f", fabs(x) < 5e-5 ? 0 : x); /* no zero with a sign */
    }
    fputc('\n', file);
}

void turbine_report_print(const turbine_report *r, double seconds, FILE *file) {
    double end = r->row[r->rows - 1][TURBINE_TIME], since = end - fmin(seconds, end);
    fprintf(file, "\n%s\n\n  from %.2f s to %.2f s %12s %12s %12s %12s\n", r->scene, since, end, "", "mean", "least",
            "most");
    for (int c = TURBINE_WIND; c < TURBINE_TIPS; c++) {
        if (c != TURBINE_AZIMUTH) {
            print_line(r, since, columns[c].name, columns[c].unit, c, 0, columns[c].scale, file);
        }
    }
    print_line(r, since, "tips, flap", "m", TURBINE_TIPS, 2, 1, file);
    print_line(r, since, "tips, edge", "m", TURBINE_TIPS + 1, 2, 1, file);
}

/* ---- files ---- */

static FILE *create(const turbine_report *r, const char *name) {
    char path[1024];
    snprintf(path, sizeof path, "%s/%s", r->out, name);
    FILE *file = fopen(path, "w");
    if (!file) {
        fprintf(stderr, "turbine: '%s' cannot be written: %s\n", path, strerror(errno));
    }
    return file;
}

static int finish(FILE *file, const char *name) {
    int bad = ferror(file);
    if (fclose(file) != 0 || bad) {
        fprintf(stderr, "turbine: %s could not be written whole: %s\n", name, strerror(errno));
        return 1;
    }
    return 0;
}

static int write_history(const turbine_report *r) {
    FILE *file = create(r, "history.csv");
    if (!file) {
        return 1;
    }
    for (int c = 0; c < TURBINE_TIPS; c++) {
        fprintf(file, "%s%s", c ? "," : "", columns[c].column);
    }
    for (int b = 1; b <= 3; b++) {
        fprintf(file, ",tip_flap%d_m,tip_edge%d_m", b, b);
    }
    for (int64_t i = 0; i < r->rows; i++) {
        for (int c = 0; c < TURBINE_COLUMNS; c++) {
            fprintf(file, "%s%.15g", c ? "," : "\n", r->row[i][c]);
        }
    }
    fputc('\n', file);
    return finish(file, "history.csv");
}

/* One panel of a picture: up to two columns over time. */
typedef struct panel {
    const char *label;
    int column, count, stride;
    double scale;
    const char *title[3];
} panel;

static void put_panel(const turbine_report *r, FILE *file, const panel *p, int last) {
    double s[3];
    statistics(r, 0, p->column, 0, s);
    if (p->count == 1 && s[1] == s[2]) { /* gnuplot needs a range */
        fprintf(file, "set yrange [%.6g:%.6g]\n", p->scale * s[0] - 1, p->scale * s[0] + 1);
    } else {
        fprintf(file, "set autoscale y\n");
    }
    fprintf(file, "set xlabel '%s'\nset ylabel '%s'\n%s\nplot", last ? "time (s)" : "", p->label,
            p->title[0] ? "set key inside top right horizontal samplen 2 font ',11'" : "unset key");
    for (int k = 0; k < p->count; k++) {
        fprintf(file, "%s 'history.csv' using 1:($%d*%.17g) with lines linecolor rgb word(shade,%d)", k ? "," : "",
                p->column + k * p->stride + 1, p->scale, k + 1);
        if (p->title[k]) {
            fprintf(file, " title '%s'", p->title[k]);
        }
    }
    fputc('\n', file);
}

static void put_picture(const turbine_report *r, FILE *file, const char *name, const panel *panels, int n) {
    fprintf(file, "\nset output '%s.png'\nset multiplot layout %d,1 title '%s' font ',14'\n", name, n, r->scene);
    for (int k = 0; k < n; k++) {
        put_panel(r, file, panels + k, k + 1 == n);
    }
    fprintf(file, "unset multiplot\n");
}

static int write_script(const turbine_report *r) {
    const panel machine[] = {
        {"wind (m/s)", TURBINE_WIND, 1, 0, 1, {NULL}},
        {"rotor (rev/min)", TURBINE_ROTOR_SPEED, 1, 0, 30 / pi, {NULL}},
        {"pitch (deg)", TURBINE_PITCH, 1, 0, 180 / pi, {NULL}},
        {"power (MW)", TURBINE_SHAFT_POWER, 2, 1, 1e-6, {"shaft", "electrical", NULL}},
    };
    const panel motion[] = {
        {"tower top (m)", TURBINE_TOP_FORE, 2, 1, 1, {"downwind", "sideways", NULL}},
        {"tips, flap (m)", TURBINE_TIPS, 3, 2, 1, {"blade 1", "blade 2", "blade 3"}},
        {"tips, edge (m)", TURBINE_TIPS + 1, 3, 2, 1, {NULL}},
        {"drivetrain (deg)", TURBINE_TWIST, 1, 0, 180 / pi, {NULL}},
    };
    FILE *file = create(r, "plots.gp");
    if (!file) {
        return 1;
    }
    fprintf(file, "set terminal pngcairo size 1200,1000 font 'sans,12' linewidth 1.5\nset datafile separator ','\n"
                  "set grid linecolor rgb '#cccccc' linewidth 0.6\nset border 3 linecolor rgb '#555555'\n"
                  "set tics nomirror\nset lmargin 11\nset rmargin 3\nshade = '#0b5fa5 #d1603d #3c8d5a'\n");
    put_picture(r, file, "machine", machine, 4);
    put_picture(r, file, "motion", motion, 4);
    return finish(file, "plots.gp");
}

int turbine_draw(const char *folder, const char *script) {
    fflush(NULL);
    pid_t child = fork();
    if (child == 0) {
        if (chdir(folder) == 0) {
            execlp("gnuplot", "gnuplot", script, (char *)NULL);
        }
        _exit(127);
    }
    int status = 1;
    return child < 0 || waitpid(child, &status, 0) != child || !WIFEXITED(status) || WEXITSTATUS(status) != 0;
}

int turbine_report_write(const turbine_report *r, int plots) {
    if (write_history(r) != 0 || write_script(r) != 0) {
        return 1;
    }
    printf("\n  %s/history.csv\n", r->out);
    if (plots && turbine_draw(r->out, "plots.gp") == 0) {
        printf("  %s/machine.png, motion.png\n", r->out);
    } else if (plots) {
        printf("  no plots: gnuplot is not there (apt-get install gnuplot-nox), then: cd %s && gnuplot plots.gp\n",
               r->out);
    }
    return 0;
}
