#include "turbine_view.h"
#include "turbine_report.h"
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846;
enum { TOWER, NACELLE, SPINNER, BLADE, AROUND = 33, TOWER_ROWS = 25, BODY_ROWS = 13 };

/* ---- small vector work ---- */

static void turn_forth(const double q[4], const double v[3], double out[3]) {
    double t[3] = {q[2] * v[2] - q[3] * v[1], q[3] * v[0] - q[1] * v[2], q[1] * v[1] - q[2] * v[0]},
           u[3] = {q[2] * t[2] - q[3] * t[1], q[3] * t[0] - q[1] * t[2], q[1] * t[1] - q[2] * t[0]},
           from[3] = {v[0], v[1], v[2]};
    for (int i = 0; i < 3; i++) {
        out[i] = from[i] + 2 * (q[0] * t[i] + u[i]);
    }
}

void turbine_turn_back(const double q[4], const double v[3], double out[3]) {
    const double back[4] = {q[0], -q[1], -q[2], -q[3]};
    turn_forth(back, v, out);
}

/* ---- memory ---- */

int turbine_view_create(turbine_view *v, const turbine *t) {
    const int rows[TURBINE_PATCHES] = {TOWER_ROWS,       BODY_ROWS,        BODY_ROWS,
                                       (int)t->sections, (int)t->sections, (int)t->sections};
    *v = (turbine_view){0};
    int missing = 0;
    for (int k = 0; k < TURBINE_PATCHES; k++) {
        turbine_patch *p = v->patch + k;
        size_t n = (size_t)rows[k] * AROUND;
        *p = (turbine_patch){rows[k], AROUND, calloc(n, 3 * sizeof(double)), calloc(n, sizeof(double))};
        missing |= !p->x || !p->load;
    }
    size_t sections = (size_t)t->sections;
    v->place = calloc(sections, 3 * sizeof(double));
    v->turn = calloc(sections, 4 * sizeof(double));
    v->force = calloc(TURBINE_BLADES * sections, 6 * sizeof(double));
    v->motion = calloc((size_t)t->tower_nodes, 7 * sizeof(double));
    return missing || !v->place || !v->turn || !v->force || !v->motion ? SPAR_ERR_MEMORY : SPAR_OK;
}

void turbine_view_free(turbine_view *v) {
    for (int k = 0; k < TURBINE_PATCHES; k++) {
        free(v->patch[k].x);
        free(v->patch[k].load);
    }
    free(v->place);
    free(v->turn);
    free(v->force);
    free(v->motion);
    *v = (turbine_view){0};
}

/* ---- shapes ---- */

/* The tower's outline at height h, between the nodes of its line. */
static int look_at_tower(turbine_view *v, const turbine *t) {
    turbine_patch *p = v->patch + TOWER;
    double reference[3 * 64];
    if (t->tower_nodes > 64 || spar_member_get_motion(t->tower, v->motion, NULL, NULL) != SPAR_OK ||
        spar_member_get_reference(t->tower, reference, NULL) != SPAR_OK) {
        return SPAR_ERR_ARGUMENT;
    }
    for (int i = 0; i < p->rows; i++) {
        double h = turbine_tower_height * i / (p->rows - 1), outer, wall;
        int64_t k = 1;
        while (k + 1 < t->tower_nodes && reference[3 * k + 2] < h) {
            k++;
        }
        double f = (h - reference[3 * k - 1]) / (reference[3 * k + 2] - reference[3 * k - 1]);
        turbine_tower_tube(h, &outer, &wall);
        for (int j = 0; j < p->columns; j++) {
            double a = 2 * pi * j / (p->columns - 1), *x = p->x + 3 * (i * p->columns + j);
            const double *q[2] = {v->motion + 7 * (k - 1), v->motion + 7 * k};
            for (int c = 0; c < 3; c++) {
                x[c] = (1 - f) * q[0][c] + f * q[1][c];
            }
            x[0] += 0.5 * outer * cos(a), x[1] += 0.5 * outer * sin(a), x[2] += h;
        }
    }
    return SPAR_OK;
}

/* A rounded box (power 4) or an ellipsoid (power 2) about a centre; its first axis from `from` to `to`. */
static void look_at_body(turbine_patch *p, const double x0[3], const double q[4], const double place[3], double from,
                         double to, const double half[2], double power) {
    for (int i = 0; i < p->rows; i++) {
        double s = -cos(pi * i / (p->rows - 1)), wide = pow(fmax(1 - pow(fabs(s), power), 0), 1 / power);
        for (int j = 0; j < p->columns; j++) {
            double a = 2 * pi * j / (p->columns - 1), c = cos(a), d = sin(a);
            double round = wide / pow(pow(fabs(c), power) + pow(fabs(d), power), 1 / power);
            double arm[3] = {0.5 * (from + to) + 0.5 * (to - from) * s + place[0], half[0] * round * c + place[1],
                             half[1] * round * d + place[2]};
            double *x = p->x + 3 * (i * p->columns + j);
            turn_forth(q, arm, x);
            for (int k = 0; k < 3; k++) {
                x[k] += x0[k];
            }
        }
    }
}

static int look_at_bodies(turbine_view *v, const turbine *t) {
    double q[7], x[3], axis[3], turn[4], axes[4];
    const double roof[3] = {0, 0, 1.75}, none[3] = {0};
    int status = spar_member_get_motion(t->nacelle, q, NULL, NULL);
    if (status != SPAR_OK || (status = turbine_get_hub(t, x, axis, turn)) != SPAR_OK) {
        return status;
    }
    const double top[3] = {q[0], q[1], q[2] + turbine_tower_height}, *n = t->shaft_axes;
    look_at_body(v->patch + NACELLE, top, q + 3, roof, -3.2, 11, (const double[]){2.2, 2.2}, 4);
    axes[0] = turn[0] * n[0] - turn[1] * n[1] - turn[2] * n[2] - turn[3] * n[3]; /* the hub's axes now */
    axes[1] = turn[0] * n[1] + turn[1] * n[0] + turn[2] * n[3] - turn[3] * n[2];
    axes[2] = turn[0] * n[2] - turn[1] * n[3] + turn[2] * n[0] + turn[3] * n[1];
    axes[3] = turn[0] * n[3] + turn[1] * n[2] - turn[2] * n[1] + turn[3] * n[0];
    look_at_body(v->patch + SPINNER, x, axes, none, -2.6, 2.2, (const double[]){1.9, 1.9}, 2);
    return SPAR_OK;
}

/* Thickness over chord by the name of the polar: the digits of DU40 and the like, 0.18 of NACA64, 1 of a cylinder. */
static double thickness_of(const char *polar) {
    return strncmp(polar, "Cylinder", 8) == 0 ? 1 : strncmp(polar, "DU", 2) == 0 ? strtod(polar + 2, NULL) / 100 : 0.18;
}

/* Point j of an outline of unit chord: along the chord from the leading edge, and towards z. Thick ones are near
   circles, thin ones have the thickness of the NACA four-digit family. */
static void outline(double thickness, int j, double *along, double *up) {
    double a = 2 * pi * j / (AROUND - 1), s = 0.5 * (1 + cos(a)), round = fmin(fmax((thickness - 0.4) / 0.6, 0), 1);
    double foil =
        5 * thickness * (0.2969 * sqrt(s) - 0.1260 * s - 0.3516 * s * s + 0.2843 * s * s * s - 0.1036 * s * s * s * s);
    *along = s - (0.25 + 0.25 * round);
    *up = (sin(a) < 0 ? -1 : 1) * (round * sqrt(s * (1 - s)) + (1 - round) * foil);
}

static int look_at_blade(turbine_view *v, const turbine *t, int b) {
    turbine_patch *p = v->patch + BLADE + b;
    const double *force = v->force + 6 * b * t->sections;
    int status = spar_fluid_pull_poses(t->air[b], SPAR_NODES_MOTION, 1, v->place, v->turn, NULL, NULL, NULL, NULL);
    for (int i = 0; i < p->rows && status == SPAR_OK; i++) {
        double chord = t->data.chord[i], twist = t->twist[i], *f = (double *)(uintptr_t)(force + 6 * i);
        double thick = thickness_of(t->data.polar[t->data.polar_of[i]].name);
        for (int j = 0; j < p->columns; j++) {
            double along, up, *x = p->x + 3 * (i * p->columns + j);
            outline(thick, j, &along, &up);
            const double arm[3] = {0, chord * (along * cos(twist) + up * sin(twist)),
                                   chord * (up * cos(twist) - along * sin(twist))};
            turn_forth(v->turn + 4 * i, arm, x);
            for (int k = 0; k < 3; k++) {
                x[k] += v->place[3 * i + k];
            }
            p->load[i * p->columns + j] = sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]);
        }
    }
    return status;
}

int turbine_view_look(turbine_view *v, const turbine *t) {
    int status = look_at_tower(v, t);
    status = status == SPAR_OK ? look_at_bodies(v, t) : status;
    status = status == SPAR_OK ? spar_aero_get_loads(t->aero, v->force, NULL, NULL) : status;
    for (int b = 0; b < TURBINE_BLADES && status == SPAR_OK; b++) {
        status = look_at_blade(v, t, b);
    }
    return status;
}

/* ---- files ---- */

static int finish(FILE *file, const char *path) {
    int bad = ferror(file);
    if (fclose(file) != 0 || bad) {
        fprintf(stderr, "turbine: '%s' could not be written whole: %s\n", path, strerror(errno));
        return 1;
    }
    return 0;
}

static FILE *create(const char *path) {
    FILE *file = fopen(path, "w");
    if (!file) {
        fprintf(stderr, "turbine: '%s' cannot be written: %s\n", path, strerror(errno));
    }
    return file;
}

static void put_array(FILE *file, const turbine_view *v, const char *name, int parts) {
    fprintf(file, "<DataArray type=\"Float32\" Name=\"%s\" NumberOfComponents=\"%d\" format=\"ascii\">\n", name, parts);
    for (int k = 0; k < TURBINE_PATCHES; k++) {
        const turbine_patch *p = v->patch + k;
        for (int i = 0; i < p->rows * p->columns; i++) {
            if (parts == 3) {
                fprintf(file, "%.6g %.6g %.6g\n", p->x[3 * i], p->x[3 * i + 1], p->x[3 * i + 2]);
            } else {
                fprintf(file, "%.5g\n", strcmp(name, "part") == 0 ? k : p->load[i]);
            }
        }
    }
    fprintf(file, "</DataArray>\n");
}

int turbine_view_write_vtk(const turbine_view *v, const char *path, double time) {
    int points = 0, quads = 0, first = 0;
    FILE *file = create(path);
    for (int k = 0; k < TURBINE_PATCHES; k++) {
        points += v->patch[k].rows * v->patch[k].columns;
        quads += (v->patch[k].rows - 1) * (v->patch[k].columns - 1);
    }
    if (!file) {
        return 1;
    }
    fprintf(
        file,
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"0.1\" byte_order=\"LittleEndian\">\n<PolyData>\n"
        "<FieldData><DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" format=\"ascii\">%.15g"
        "</DataArray></FieldData>\n"
        "<Piece NumberOfPoints=\"%d\" NumberOfPolys=\"%d\">\n<PointData Scalars=\"load\">\n",
        time, points, quads);
    put_array(file, v, "load", 1);
    put_array(file, v, "part", 1);
    fprintf(file, "</PointData>\n<Points>\n");
    put_array(file, v, "points", 3);
    fprintf(file, "</Points>\n<Polys>\n<DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">\n");
    for (int k = 0; k < TURBINE_PATCHES; k++) {
        const turbine_patch *p = v->patch + k;
        for (int i = 0; i < (p->rows - 1) * (p->columns - 1); i++) {
            int at = first + i / (p->columns - 1) * p->columns + i % (p->columns - 1);
            fprintf(file, "%d %d %d %d\n", at, at + 1, at + p->columns + 1, at + p->columns);
        }
        first += p->rows * p->columns;
    }
    fprintf(file, "</DataArray>\n<DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">\n");
    for (int i = 1; i <= quads; i++) {
        fprintf(file, "%d\n", 4 * i);
    }
    fprintf(file, "</DataArray>\n</Polys>\n</Piece>\n</PolyData>\n</VTKFile>\n");
    return finish(file, path);
}

/* ---- a picture without ParaView ---- */

/* Blocks of rows, as gnuplot takes a grid; a blank line twice between surfaces. */
static int write_surface(const turbine_view *v, const char *folder) {
    char path[1024];
    snprintf(path, sizeof path, "%s/surface.txt", folder);
    FILE *file = create(path);
    if (!file) {
        return 1;
    }
    fprintf(file, "# x y z, m; force of the air per length, kN/m\n");
    for (int k = 0; k < TURBINE_PATCHES; k++) {
        const turbine_patch *p = v->patch + k;
        for (int i = 0; i < p->rows * p->columns; i++) {
            fprintf(file, "%s%.5f %.5f %.5f %.5f\n", i > 0 && i % p->columns == 0 ? "\n" : "", p->x[3 * i],
                    p->x[3 * i + 1], p->x[3 * i + 2], 1e-3 * p->load[i]);
        }
        fprintf(file, "\n\n");
    }
    return finish(file, path);
}

int turbine_view_draw(const turbine_view *v, const char *folder, int picture) {
    char path[1024];
    snprintf(path, sizeof path, "%s/surface.gp", folder);
    if (write_surface(v, folder) != 0) {
        return 1;
    }
    FILE *file = create(path);
    if (!file) {
        return 1;
    }
    fprintf(file, "set terminal pngcairo size 900,1100 font 'sans,12'\nset output 'turbine.png'\n"
                  "set view 86,38,1.75\nset view equal xyz\nunset border\nunset tics\nunset key\n"
                  "set xrange [-45:45]\nset yrange [-66:66]\nset zrange [0:156]\nset xyplane at 0\n"
                  "set pm3d depthorder lighting primary 0.5 specular 0.15\n"
                  "set palette defined (0 '#e8edf2', 2 '#bcd3e6', 4 '#f3c489', 8 '#d1603d')\nset cbrange [0:8]\n"
                  "set colorbox user origin 0.84,0.12 size 0.02,0.30\n"
                  "set cblabel 'force of the air on the blades (kN/m)' offset 1\n"
                  "set cbtics 2 out\nset arrow from 0,-48,0 to 0,-48,50 heads size 1.5,90 lw 1.5 lc '#555555'\n"
                  "set label '50 m' at 0,-52,25 center rotate by 90 tc '#555555'\n"
                  "splot 'surface.txt' using 1:2:3:4 with pm3d\n");
    if (finish(file, path) != 0) {
        return 1;
    }
    printf("  %s/surface.txt\n", folder);
    if (picture && turbine_draw(folder, "surface.gp") == 0) {
        printf("  %s/turbine.png\n", folder);
    }
    return 0;
}
