#include "nrel5mw.h"
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

/* ---- small vector work ---- */

static void cross(const double a[3], const double b[3], double c[3]) {
    c[0] = a[1] * b[2] - a[2] * b[1];
    c[1] = a[2] * b[0] - a[0] * b[2];
    c[2] = a[0] * b[1] - a[1] * b[0];
}

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Columns of R(q): the frame's axes. */
static void frame_axes(const double q[4], double axis[3][3]) {
    double w = q[0], x = q[1], y = q[2], z = q[3];
    double column[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)},
                           {2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)},
                           {2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)}};
    memcpy(axis, column, sizeof column);
}

/* Unit quaternion of the frame with these axes (Shepperd: from the largest of the four). */
static void frame_quat(double axis[3][3], double q[4]) {
    double d[4] = {axis[0][0] + axis[1][1] + axis[2][2], axis[0][0], axis[1][1], axis[2][2]};
    int i = 0;
    for (int k = 1; k < 4; k++) {
        i = d[k] > d[i] ? k : i;
    }
    if (i == 0) {
        double r[4] = {1 + d[0], axis[1][2] - axis[2][1], axis[2][0] - axis[0][2], axis[0][1] - axis[1][0]};
        memcpy(q, r, sizeof r);
    } else {
        int a = i - 1, b = (a + 1) % 3, c = (a + 2) % 3;
        q[0] = axis[b][c] - axis[c][b];
        q[1 + a] = 1 + axis[a][a] - axis[b][b] - axis[c][c];
        q[1 + b] = axis[a][b] + axis[b][a];
        q[1 + c] = axis[a][c] + axis[c][a];
    }
    double size = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    for (int k = 0; k < 4; k++) {
        q[k] /= size;
    }
}

/* ---- reading ---- */

static void say(nrel5mw *data, const char *format, ...) {
    va_list list;
    va_start(list, format);
    vsnprintf(data->message, sizeof data->message, format, list);
    va_end(list);
}

/* The status, with its message written. */
#define FAIL(data, status, ...) (say(data, __VA_ARGS__), (status))

/* A table of numbers: rows of `columns` numbers, with a word after them where `words` is not NULL; '#' begins a
 * comment. */
typedef struct table {
    int64_t n;
    int columns;
    double *value;
    char (*word)[32];
} table;

static void table_free(table *t) {
    free(t->value);
    free(t->word);
    *t = (table){0};
}

static int read_row(nrel5mw *data, table *t, char *line, int words, const char *path, int number) {
    char *at = line;
    for (int c = 0; c < t->columns; c++) {
        char *end;
        t->value[t->n * t->columns + c] = strtod(at, &end);
        if (end == at) {
            return FAIL(data, SPAR_ERR_IO, "%s, line %d: %d numbers expected, %d found", path, number, t->columns, c);
        }
        at = end;
    }
    if (words && sscanf(at, "%31s", t->word[t->n]) != 1) {
        return FAIL(data, SPAR_ERR_IO, "%s, line %d: a name is missing after the numbers", path, number);
    }
    t->n++;
    return SPAR_OK;
}

static int table_read(nrel5mw *data, const char *directory, const char *name, int columns, int words, table *t) {
    char path[1024], line[4096];
    int64_t room = 512;
    snprintf(path, sizeof path, "%s/%s.txt", directory, name);
    FILE *file = fopen(path, "r");
    if (!file) {
        return FAIL(data, SPAR_ERR_IO, "%s: cannot be opened; give the directory of the tables (examples/data/nrel5mw)",
                    path);
    }
    *t = (table){.columns = columns,
                 .value = malloc((size_t)(room * columns) * sizeof(double)),
                 .word = words ? malloc((size_t)room * sizeof *t->word) : NULL};
    int status = SPAR_OK;
    if (!t->value || (words && !t->word)) {
        fclose(file);
        return FAIL(data, SPAR_ERR_MEMORY, "%s: no memory", path);
    }
    for (int number = 1; status == SPAR_OK && fgets(line, sizeof line, file); number++) {
        line[strcspn(line, "#\r\n")] = '\0';
        if (line[strspn(line, " \t")] == '\0') {
            continue;
        }
        status = t->n < room ? read_row(data, t, line, words, path, number)
                             : FAIL(data, SPAR_ERR_IO, "%s: more than %lld rows", path, (long long)room);
    }
    fclose(file);
    if (status == SPAR_OK && t->n < 2) {
        return FAIL(data, SPAR_ERR_IO, "%s: fewer than 2 rows", path);
    }
    return status;
}

/* Column c of the table times scale, in memory of its own. */
static double *column(const table *t, int c, double scale) {
    double *x = calloc((size_t)t->n, sizeof *x);
    for (int64_t i = 0; x && i < t->n; i++) {
        x[i] = scale * t->value[i * t->columns + c];
    }
    return x;
}

/* rotor.txt: a name and its numbers per line. */
static int read_rotor(nrel5mw *data, const char *directory) {
    double blades = 0, precone = 0, tilt = 0, rpm = 0;
    struct {
        const char *name;
        double *value;
        int n, found;
    } key[] = {{"blades", &blades, 1, 0},
               {"length", &data->length, 1, 0},
               {"hub_radius", &data->hub_radius, 1, 0},
               {"tip_radius", &data->tip_radius, 1, 0},
               {"precone", &precone, 1, 0},
               {"tilt", &tilt, 1, 0},
               {"density", &data->density, 1, 0},
               {"rated_wind", &data->rated_wind, 1, 0},
               {"rated_rpm", &rpm, 1, 0},
               {"damping", data->damping, 6, 0}};
    char path[1024], line[1024];
    snprintf(path, sizeof path, "%s/rotor.txt", directory);
    FILE *file = fopen(path, "r");
    if (!file) {
        return FAIL(data, SPAR_ERR_IO, "%s: cannot be opened; give the directory of the tables (examples/data/nrel5mw)",
                    path);
    }
    while (fgets(line, sizeof line, file)) {
        char *at = line + strspn(line, " \t");
        size_t size = strcspn(at, " \t\r\n");
        for (size_t k = 0; k < sizeof key / sizeof key[0]; k++) {
            if (size == strlen(key[k].name) && strncmp(at, key[k].name, size) == 0) {
                char *number = at + size, *end;
                for (key[k].found = 0; key[k].found < key[k].n; key[k].found++) {
                    key[k].value[key[k].found] = strtod(number, &end);
                    if (end == number) {
                        break;
                    }
                    number = end;
                }
            }
        }
    }
    fclose(file);
    for (size_t k = 0; k < sizeof key / sizeof key[0]; k++) {
        if (key[k].found < key[k].n) {
            return FAIL(data, SPAR_ERR_IO, "%s: '%s' with %d number(s) is missing", path, key[k].name, key[k].n);
        }
    }
    data->blades = (int)blades;
    data->precone = precone * pi / 180;
    data->tilt = tilt * pi / 180;
    data->rated_speed = rpm * pi / 30;
    return SPAR_OK;
}

static int read_axis(nrel5mw *data, const char *directory) {
    table t = {0};
    int status = table_read(data, directory, "axis", 5, 0, &t);
    if (status == SPAR_OK) {
        data->axis_n = t.n;
        data->axis_eta = column(&t, 0, 1);
        data->axis_twist = column(&t, 4, -pi / 180); /* published: minus a right-handed turn */
        data->axis_xyz = calloc((size_t)t.n, 3 * sizeof(double));
        if (!data->axis_eta || !data->axis_twist || !data->axis_xyz) {
            status = FAIL(data, SPAR_ERR_MEMORY, "axis: no memory");
        }
        for (int64_t i = 0; status == SPAR_OK && i < t.n; i++) {
            memcpy(data->axis_xyz + 3 * i, t.value + 5 * i + 1, 3 * sizeof(double));
        }
    }
    table_free(&t);
    return status;
}

/* Full matrices from the upper triangles. */
static int read_sections(nrel5mw *data, const char *directory) {
    table t = {0};
    int status = table_read(data, directory, "sections", 43, 0, &t);
    if (status == SPAR_OK) {
        data->section_n = t.n;
        data->section_eta = column(&t, 0, 1);
        data->stiffness = calloc((size_t)t.n, 36 * sizeof(double));
        data->mass = calloc((size_t)t.n, 36 * sizeof(double));
        if (!data->section_eta || !data->stiffness || !data->mass) {
            status = FAIL(data, SPAR_ERR_MEMORY, "sections: no memory");
        }
        for (int64_t i = 0; status == SPAR_OK && i < t.n; i++) {
            const double *from = t.value + 43 * i + 1;
            for (int r = 0; r < 6; r++) {
                for (int c = r; c < 6; c++, from++) {
                    data->stiffness[36 * i + 6 * r + c] = data->stiffness[36 * i + 6 * c + r] = from[0];
                    data->mass[36 * i + 6 * r + c] = data->mass[36 * i + 6 * c + r] = from[21];
                }
            }
        }
    }
    table_free(&t);
    return status;
}

static int read_polar(nrel5mw *data, const char *directory, const char *name, nrel5mw_polar *polar) {
    table t = {0};
    char file[48];
    snprintf(file, sizeof file, "polars/%s", name);
    snprintf(polar->name, sizeof polar->name, "%s", name);
    int status = table_read(data, directory, file, 4, 0, &t);
    if (status == SPAR_OK) {
        polar->n = t.n;
        polar->alpha = column(&t, 0, pi / 180);
        polar->cl = column(&t, 1, 1);
        polar->cd = column(&t, 2, 1);
        polar->cm = column(&t, 3, 1);
        if (!polar->alpha || !polar->cl || !polar->cd || !polar->cm) {
            status = FAIL(data, SPAR_ERR_MEMORY, "%s: no memory", file);
        }
    }
    table_free(&t);
    return status;
}

/* The polar of each section; each polar is read once. */
static int read_polars(nrel5mw *data, const char *directory, const table *t) {
    data->polar = calloc((size_t)t->n, sizeof *data->polar);
    data->polar_of = calloc((size_t)t->n, sizeof *data->polar_of);
    if (!data->polar || !data->polar_of) {
        return FAIL(data, SPAR_ERR_MEMORY, "polars: no memory");
    }
    for (int64_t i = 0; i < t->n; i++) {
        int p = 0;
        while (p < data->polar_n && strcmp(data->polar[p].name, t->word[i]) != 0) {
            p++;
        }
        data->polar_of[i] = p;
        if (p == data->polar_n) {
            data->polar_n++;
            int status = read_polar(data, directory, t->word[i], &data->polar[p]);
            if (status != SPAR_OK) {
                return status;
            }
        }
    }
    return SPAR_OK;
}

static int read_aero(nrel5mw *data, const char *directory) {
    table t = {0};
    int status = table_read(data, directory, "aero", 5, 1, &t);
    if (status == SPAR_OK) {
        data->aero_n = t.n;
        data->span = column(&t, 0, 1);
        data->curve = column(&t, 1, 1);
        data->sweep = column(&t, 2, 1);
        data->twist = column(&t, 3, pi / 180);
        data->chord = column(&t, 4, 1);
        status = data->span && data->curve && data->sweep && data->twist && data->chord
                     ? read_polars(data, directory, &t)
                     : FAIL(data, SPAR_ERR_MEMORY, "aero: no memory");
    }
    table_free(&t);
    return status;
}

int nrel5mw_load(nrel5mw *data, const char *directory) {
    int (*const part[])(nrel5mw *, const char *) = {read_rotor, read_axis, read_sections, read_aero};
    *data = (nrel5mw){0};
    for (size_t i = 0; i < sizeof part / sizeof part[0]; i++) {
        int status = part[i](data, directory);
        if (status != SPAR_OK) {
            return status;
        }
    }
    return SPAR_OK;
}

void nrel5mw_free(nrel5mw *data) {
    for (int p = 0; p < data->polar_n; p++) {
        free(data->polar[p].alpha);
        free(data->polar[p].cl);
        free(data->polar[p].cd);
        free(data->polar[p].cm);
    }
    void *all[] = {data->axis_eta, data->axis_xyz, data->axis_twist, data->section_eta, data->stiffness,
                   data->mass,     data->span,     data->curve,      data->sweep,       data->twist,
                   data->chord,    data->polar_of, data->polar};
    for (size_t i = 0; i < sizeof all / sizeof all[0]; i++) {
        free(all[i]);
    }
    *data = (nrel5mw){0};
}

/* ---- other sections than those of the table ---- */

static double mix(double a, double b, double t) {
    return a + t * (b - a);
}

/* Column y of a polar at an angle within its rows. */
static double at_angle(const nrel5mw_polar *polar, const double *y, double alpha) {
    int64_t i = 1;
    while (i + 1 < polar->n && polar->alpha[i] < alpha) {
        i++;
    }
    return mix(y[i - 1], y[i], (alpha - polar->alpha[i - 1]) / (polar->alpha[i] - polar->alpha[i - 1]));
}

/* Between two polars of one range, at the angles of both. */
static int blend_polar(const nrel5mw_polar *a, const nrel5mw_polar *b, double t, nrel5mw_polar *out) {
    const size_t most = (size_t)(a->n + b->n);
    *out = (nrel5mw_polar){.alpha = calloc(most, sizeof(double)),
                           .cl = calloc(most, sizeof(double)),
                           .cd = calloc(most, sizeof(double)),
                           .cm = calloc(most, sizeof(double))};
    snprintf(out->name, sizeof out->name, "%.12s_%.12s", a->name, b->name);
    if (!out->alpha || !out->cl || !out->cd || !out->cm) {
        return SPAR_ERR_MEMORY;
    }
    for (int64_t i = 0, k = 0; i < a->n || k < b->n; out->n++) {
        const double to_a = i < a->n ? a->alpha[i] : INFINITY, to_b = k < b->n ? b->alpha[k] : INFINITY,
                     alpha = fmin(to_a, to_b);
        i += to_a <= alpha;
        k += to_b <= alpha;
        out->alpha[out->n] = alpha;
        out->cl[out->n] = mix(at_angle(a, a->cl, alpha), at_angle(b, b->cl, alpha), t);
        out->cd[out->n] = mix(at_angle(a, a->cd, alpha), at_angle(b, b->cd, alpha), t);
        out->cm[out->n] = mix(at_angle(a, a->cm, alpha), at_angle(b, b->cm, alpha), t);
    }
    return SPAR_OK;
}

/* Section i of the new ones, part t of the way from section k to k + 1 of the old. */
static int place_section(const nrel5mw *data, int64_t k, double t, nrel5mw *fine, int64_t i) {
    fine->span[i] = mix(data->span[k], data->span[k + 1], t);
    fine->curve[i] = mix(data->curve[k], data->curve[k + 1], t);
    fine->sweep[i] = mix(data->sweep[k], data->sweep[k + 1], t);
    fine->twist[i] = mix(data->twist[k], data->twist[k + 1], t);
    fine->chord[i] = mix(data->chord[k], data->chord[k + 1], t);
    fine->polar_of[i] = data->polar_of[k];
    if (data->polar_of[k] == data->polar_of[k + 1]) {
        return SPAR_OK;
    }
    fine->polar_of[i] = fine->polar_n++;
    return blend_polar(&data->polar[data->polar_of[k]], &data->polar[data->polar_of[k + 1]], t,
                       &fine->polar[fine->polar_of[i]]);
}

/* Memory of n sections and the polars they may need; the old polars keep their places. */
static int allocate_sections(const nrel5mw *data, int64_t n, nrel5mw *fine) {
    double **array[] = {&fine->span, &fine->curve, &fine->sweep, &fine->twist, &fine->chord};
    int good = 1;
    *fine = *data;
    fine->aero_n = n;
    fine->polar_of = calloc((size_t)n, sizeof *fine->polar_of);
    fine->polar = calloc((size_t)(data->polar_n + n), sizeof *fine->polar);
    for (size_t a = 0; a < sizeof array / sizeof array[0]; a++) {
        *array[a] = calloc((size_t)n, sizeof(double));
        good = good && *array[a];
    }
    return good && fine->polar_of && fine->polar;
}

static void free_sections(nrel5mw *data) {
    void *all[] = {data->span, data->curve, data->sweep, data->twist, data->chord, data->polar_of, data->polar};
    for (size_t i = 0; i < sizeof all / sizeof all[0]; i++) {
        free(all[i]);
    }
}

int nrel5mw_resample(nrel5mw *data, int64_t n) {
    nrel5mw fine;
    const int64_t last = data->aero_n - 1;
    int status = SPAR_OK;
    if (n < 2) {
        return FAIL(data, SPAR_ERR_ARGUMENT, "%lld sections: at least 2 are wanted", (long long)n);
    }
    if (!allocate_sections(data, n, &fine)) {
        free_sections(&fine);
        return FAIL(data, SPAR_ERR_MEMORY, "sections: no memory");
    }
    memcpy(fine.polar, data->polar, (size_t)data->polar_n * sizeof *fine.polar);
    for (int64_t i = 0, k = 0; i < n && status == SPAR_OK; i++) {
        const double span = mix(data->span[0], data->span[last], (double)i / (double)(n - 1));
        while (k + 1 < last && data->span[k + 1] <= span) {
            k++;
        }
        status = place_section(data, k, (span - data->span[k]) / (data->span[k + 1] - data->span[k]), &fine, i);
    }
    free_sections(data);
    *data = fine;
    return status == SPAR_OK ? SPAR_OK : FAIL(data, status, "sections: no memory");
}

/* ---- where the rotor stands ---- */

void nrel5mw_rotor_default(const nrel5mw *data, nrel5mw_rotor *rotor) {
    *rotor = (nrel5mw_rotor){.blades = data->blades,
                             .axis = {cos(data->tilt), 0, -sin(data->tilt)},
                             .up = {0, 0, 1},
                             .precone = data->precone};
}

void nrel5mw_root(const nrel5mw *data, const nrel5mw_rotor *rotor, int blade, double angle, double x[3], double q[4]) {
    const double *n = rotor->axis;
    double psi = angle + 2 * pi * blade / rotor->blades, along = dot(rotor->up, n), up[3], side[3], frame[3][3], size;
    for (int i = 0; i < 3; i++) {
        up[i] = rotor->up[i] - along * n[i];
    }
    size = sqrt(dot(up, up));
    for (int i = 0; i < 3; i++) {
        up[i] /= size;
    }
    cross(n, up, side);
    double radial[3], aft[3], face[3]; /* outwards, against the motion, upwind and across the blade */
    for (int i = 0; i < 3; i++) {
        radial[i] = cos(psi) * up[i] + sin(psi) * side[i];
        aft[i] = sin(psi) * up[i] - cos(psi) * side[i];
        frame[0][i] = cos(rotor->precone) * radial[i] - sin(rotor->precone) * n[i];
    }
    cross(frame[0], aft, face);
    for (int i = 0; i < 3; i++) { /* pitch: minus a right-handed turn about the span */
        frame[1][i] = cos(rotor->pitch) * aft[i] - sin(rotor->pitch) * face[i];
        frame[2][i] = sin(rotor->pitch) * aft[i] + cos(rotor->pitch) * face[i];
        x[i] = rotor->hub[i] + data->hub_radius * frame[0][i];
    }
    frame_quat(frame, q);
}

void nrel5mw_root_motion(const nrel5mw *data, const nrel5mw_rotor *rotor, int blade, double angle, double speed,
                         double acceleration, double q[7], double v[6], double a[6]) {
    double x0[3], x[3], reference[4], arm[3], swirl[3], inwards[3], turn[4] = {cos(angle / 2)};
    nrel5mw_root(data, rotor, blade, 0, x0, reference);
    nrel5mw_root(data, rotor, blade, angle, x, reference);
    for (int i = 0; i < 3; i++) {
        turn[1 + i] = sin(angle / 2) * rotor->axis[i];
        arm[i] = x[i] - rotor->hub[i];
        q[i] = x[i] - x0[i];
        v[3 + i] = speed * rotor->axis[i];
        a[3 + i] = acceleration * rotor->axis[i];
    }
    memcpy(q + 3, turn, sizeof turn);
    cross(rotor->axis, arm, swirl);
    cross(rotor->axis, swirl, inwards);
    for (int i = 0; i < 3; i++) {
        v[i] = speed * swirl[i];
        a[i] = acceleration * swirl[i] + speed * speed * inwards[i];
    }
}

/* ---- blades ---- */

/* Twist of the reference line at eta, right-handed, linear between the points. */
static double twist_at(const nrel5mw *data, double eta) {
    int64_t i = 1;
    while (i + 1 < data->axis_n && data->axis_eta[i] < eta) {
        i++;
    }
    double t = (eta - data->axis_eta[i - 1]) / (data->axis_eta[i] - data->axis_eta[i - 1]);
    return data->axis_twist[i - 1] + t * (data->axis_twist[i] - data->axis_twist[i - 1]);
}

/* Adds weight times the mass matrix of section i, taken about the root in the root frame: with T from root to section
   velocities, T^t M T. The line is straight along x. */
static void add_section_mass(const nrel5mw *data, int64_t i, double weight, double total[36]) {
    double eta = data->section_eta[i], turn = twist_at(data, eta), x = eta * data->length, t[6][6] = {{0}};
    double r[3][3] = {{1, 0, 0}, {0, cos(turn), sin(turn)}, {0, -sin(turn), cos(turn)}}; /* root to section */
    double lever[3][3] = {{0, 0, 0}, {0, 0, x}, {0, -x, 0}}; /* velocity at x: omega x (x,0,0) */
    for (int a = 0; a < 3; a++) {
        for (int b = 0; b < 3; b++) {
            t[a][b] = t[3 + a][3 + b] = r[a][b];
            for (int c = 0; c < 3; c++) {
                t[a][3 + b] += r[a][c] * lever[c][b];
            }
        }
    }
    const double *m = data->mass + 36 * i;
    for (int a = 0; a < 6; a++) {
        for (int b = 0; b < 6; b++) {
            for (int c = 0; c < 36; c++) {
                total[6 * a + b] += weight * t[c / 6][a] * m[c] * t[c % 6][b];
            }
        }
    }
}

/* Mass of the whole blade about its root, by the trapezium rule over the table, in exact rigid form. */
static void blade_mass(const nrel5mw *data, double total[36]) {
    memset(total, 0, 36 * sizeof *total);
    for (int64_t i = 0; i + 1 < data->section_n; i++) {
        double half = 0.5 * data->length * (data->section_eta[i + 1] - data->section_eta[i]);
        add_section_mass(data, i, half, total);
        add_section_mass(data, i + 1, half, total);
    }
    double m = (total[0] + total[7] + total[14]) / 3;
    /* m c from the antisymmetric part of the coupling block, which is -m c~ */
    double s[3] = {0.5 * (total[6 * 1 + 5] - total[6 * 2 + 4]), 0.5 * (total[6 * 2 + 3] - total[6 * 0 + 5]),
                   0.5 * (total[6 * 0 + 4] - total[6 * 1 + 3])};
    double coupling[3][3] = {{0, s[2], -s[1]}, {-s[2], 0, s[0]}, {s[1], -s[0], 0}}; /* -m c~ */
    for (int a = 0; a < 3; a++) {
        for (int b = 0; b < 3; b++) {
            double j = 0.5 * (total[6 * (3 + a) + 3 + b] + total[6 * (3 + b) + 3 + a]);
            total[6 * a + b] = a == b ? m : 0;
            total[6 * a + 3 + b] = total[6 * (3 + b) + a] = coupling[a][b];
            total[6 * (3 + a) + 3 + b] = total[6 * (3 + b) + 3 + a] = j;
        }
    }
}

static int create_rigid(const nrel5mw *data, const nrel5mw_rotor *rotor, spar_session *session, int blade,
                        const char *name, spar_member **member) {
    double x[3], q[4], mass[36];
    nrel5mw_root(data, rotor, blade, 0, x, q);
    blade_mass(data, mass);
    return spar_rigid_create(session, name, x, q, mass, member);
}

static int create_beam(const nrel5mw *data, const nrel5mw_rotor *rotor, spar_session *session, int blade,
                       const char *name, int elements, int nodes, spar_member **member) {
    double x[3], q[4];
    int status = spar_beam_create(session, name, elements, nodes, member);
    nrel5mw_root(data, rotor, blade, 0, x, q);
    if (status == SPAR_OK) {
        status = spar_beam_set_axis(*member, data->axis_n, data->axis_eta, data->axis_xyz, data->axis_twist);
    }
    if (status == SPAR_OK) {
        status = spar_beam_set_sections(*member, data->section_n, data->section_eta, data->stiffness, data->mass);
    }
    if (status == SPAR_OK) {
        status = spar_beam_set_damping(*member, data->damping);
    }
    return status == SPAR_OK ? spar_member_set_placement(*member, x, q) : status;
}

int nrel5mw_create_blade(nrel5mw *data, const nrel5mw_rotor *rotor, spar_session *session, int blade, int elements,
                         int nodes, spar_member **member) {
    char name[32];
    snprintf(name, sizeof name, "blade%d", blade + 1);
    int status = elements > 0 ? create_beam(data, rotor, session, blade, name, elements, nodes, member)
                              : create_rigid(data, rotor, session, blade, name, member);
    return status == SPAR_OK ? spar_member_set_root(*member, SPAR_ROOT_DRIVEN) : status;
}

/* ---- aerodynamics ---- */

/* Offsets of the aerodynamic centres in the frames the feet have, and the twist those frames lack. */
static void fit_sections(const nrel5mw *data, const nrel5mw_rotor *rotor, int blade, const double *x_map,
                         const double *q_map, double *offset, double *twist) {
    double root_x[3], root_q[4], root[3][3];
    nrel5mw_root(data, rotor, blade, 0, root_x, root_q);
    frame_axes(root_q, root);
    for (int64_t i = 0; i < data->aero_n; i++) {
        double own[3][3], arm[3];
        frame_axes(q_map + 4 * i, own);
        for (int k = 0; k < 3; k++) { /* curve is downwind: -z */
            arm[k] = root_x[k] + data->span[i] * root[0][k] + data->sweep[i] * root[1][k] -
                     data->curve[i] * root[2][k] - x_map[3 * i + k];
        }
        for (int k = 0; k < 3; k++) {
            offset[3 * i + k] = dot(own[k], arm);
        }
        twist[i] = data->twist[i] + atan2(dot(own[1], root[2]), dot(own[1], root[1]));
    }
}

int nrel5mw_create_sections(nrel5mw *data, const nrel5mw_rotor *rotor, int blade, spar_member *member,
                            spar_fluid **fluid, double *twist) {
    int64_t n = data->aero_n;
    char name[32];
    snprintf(name, sizeof name, "sections%d", blade + 1);
    double *work = malloc((size_t)(11 * n) * sizeof *work);
    if (!work) {
        return FAIL(data, SPAR_ERR_MEMORY, "sections: no memory");
    }
    double *eta = work, *x_map = eta + n, *q_map = x_map + 3 * n, *offset = q_map + 4 * n;
    for (int64_t i = 0; i < n; i++) {
        eta[i] = data->span[i] / data->length;
    }
    int status = spar_fluid_create(member, name, fluid);
    if (status == SPAR_OK) { /* once on the line itself, to learn the frames there */
        status = spar_fluid_set_stations(*fluid, n, eta, NULL);
    }
    if (status == SPAR_OK) {
        status = spar_fluid_map(*fluid);
    }
    if (status == SPAR_OK) {
        status = spar_fluid_get_nearest(*fluid, SPAR_NODES_MOTION, x_map, q_map, NULL);
    }
    if (status == SPAR_OK) {
        fit_sections(data, rotor, blade, x_map, q_map, offset, twist);
        status = spar_fluid_set_stations(*fluid, n, eta, offset);
    }
    if (status == SPAR_OK) {
        status = spar_fluid_map(*fluid);
    }
    free(work);
    return status;
}

/* The section keeps the polar's table, so that the polar itself can go at once. */
static int set_section(const nrel5mw *data, int64_t i, double twist, spar_aero *aero) {
    const nrel5mw_polar *from = &data->polar[data->polar_of[i]];
    spar_polar *polar = NULL;
    int status = spar_polar_create(from->n, from->alpha, from->cl, from->cd, from->cm, &polar);
    if (status == SPAR_OK) {
        status = spar_aero_set_section(aero, i, data->chord[i], twist, polar);
    }
    spar_polar_destroy(&polar);
    return status;
}

int nrel5mw_create_aero(nrel5mw *data, const nrel5mw_rotor *rotor, int n, spar_fluid *const *fluids,
                        const double *twist, spar_aero **aero) {
    double shrink = cos(rotor->precone); /* radii are measured from the shaft axis */
    int status = spar_aero_create(n, fluids, aero);
    for (int64_t i = 0; n > 0 && i < data->aero_n && status == SPAR_OK; i++) {
        status = set_section(data, i, twist[i], *aero);
    }
    if (status == SPAR_OK) {
        status = spar_aero_set_blades(*aero, rotor->blades);
    }
    if (status == SPAR_OK) {
        status =
            spar_aero_set_rotor(*aero, rotor->hub, rotor->axis, shrink * data->hub_radius, shrink * data->tip_radius);
    }
    return status;
}
