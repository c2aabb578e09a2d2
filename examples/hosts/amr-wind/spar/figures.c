/* The turbine's figures: one line a step, for people and plots. */
#include "machine.h"
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

enum {
    THRUST,
    AERO_POWER,
    GENERATOR_POWER,
    ROTOR_SPEED,
    PITCH,
    AZIMUTH,
    TIPS,                       /* of each blade: flap, edge */
    ROOTS = TIPS + 6,           /* of each blade: flap, edge */
    TOWER_TOP = ROOTS + 6,      /* fore, side */
    TOWER_BASE = TOWER_TOP + 2, /* fore, side */
    ITERATIONS = TOWER_BASE + 2,
    PARTS,
    UNBALANCED,
    FIGURES
};

/* Flap: downwind across the cone of the blades; edge: to the trailing edge. Tips against a straight blade, in axes that
   turn with the rotor; root moments in axes that turn with the pitch too. Fore: downwind; side: across, to the left of
   one who looks downwind. Moments are those that bend blade or tower that way. */
static const char *const columns[FIGURES] = {
    "thrust_N",           "aero_power_W",       "generator_power_W", "rotor_speed_rpm",
    "pitch_deg",          "azimuth_deg",        "tip1_flap_m",       "tip1_edge_m",
    "tip2_flap_m",        "tip2_edge_m",        "tip3_flap_m",       "tip3_edge_m",
    "root1_flap_Nm",      "root1_edge_Nm",      "root2_flap_Nm",     "root2_edge_Nm",
    "root3_flap_Nm",      "root3_edge_Nm",      "tower_top_fore_m",  "tower_top_side_m",
    "tower_base_fore_Nm", "tower_base_side_Nm", "iterations",        "parts",
    "unbalanced_power_W"};

/* v in the axes that q turns to. */
static void turn_back(const double q[4], const double v[3], double out[3]) {
    double axes[9];
    const double from[3] = {v[0], v[1], v[2]};
    actuator_matrix(q, axes);
    for (int i = 0; i < 3; i++) {
        out[i] = axes[i] * from[0] + axes[3 + i] * from[1] + axes[6 + i] * from[2];
    }
}

static int get_tip(actuator_machine *a, int b, double out[2]) {
    turbine *t = &a->model;
    const int64_t tip = t->blade_nodes - 1;
    double hub[3], turn[4], x0[3], root[4], here[3], then[3];
    TRY(actuator_rotor_pose(a, hub, turn));
    TRY(spar_member_get_motion(t->blade[b], a->motion, NULL, NULL));
    TRY(spar_member_get_reference(t->blade[b], a->reference, NULL));
    nrel5mw_rotor level = t->rotor;
    level.pitch = 0;
    nrel5mw_root(&t->data, &level, b, 0, x0, root);
    for (int i = 0; i < 3; i++) {
        here[i] = a->reference[3 * tip + i] + a->motion[7 * tip + i] - hub[i];
        then[i] = a->reference[3 * tip + i] - t->rotor.hub[i];
    }
    turn_back(turn, here, here);
    turn_back(root, here, here);
    turn_back(root, then, then);
    out[0] = -(here[2] - then[2]); /* z of a root is upwind */
    out[1] = here[1] - then[1];
    return SPAR_OK;
}

static int get_root(actuator_machine *a, int b, double out[2]) {
    turbine *t = &a->model;
    const double eta = 0;
    double force[6], q[4], axes[9], moment[3], x[3], frame[4], root[4];
    TRY(spar_beam_evaluate(t->blade[b], 1, &eta, NULL, force, NULL, q));
    TRY(spar_member_get_placement(t->blade[b], x, frame));
    TRY(spar_member_get_motion(t->blade[b], a->motion, NULL, NULL));
    actuator_matrix(q, axes);
    for (int i = 0; i < 3; i++) {
        moment[i] = axes[3 * i] * force[3] + axes[3 * i + 1] * force[4] + axes[3 * i + 2] * force[5];
    }
    actuator_product(a->motion + 3, frame, root);
    turn_back(root, moment, moment);
    out[0] = moment[1];
    out[1] = moment[2];
    return SPAR_OK;
}

static int get_tower(actuator_machine *a, double top[2], double base[2]) {
    turbine *t = &a->model;
    double support[6];
    top[0] = top[1] = base[0] = base[1] = NAN;
    if (!t->tower) {
        return SPAR_OK;
    }
    TRY(spar_member_get_motion(t->tower, a->motion, NULL, NULL));
    TRY(spar_member_get_reaction(t->tower, support));
    top[0] = a->motion[7 * (t->tower_nodes - 1)];
    top[1] = a->motion[7 * (t->tower_nodes - 1) + 1];
    base[0] = -support[4]; /* the support's, against the tower's */
    base[1] = support[3];
    return SPAR_OK;
}

static int get_figures(actuator_machine *a, double row[FIGURES]) {
    double torque, speed = a->speed, angle = a->angle, twist;
    TRY(actuator_get_rotor(a, &row[THRUST], &torque, NULL, NULL));
    row[GENERATOR_POWER] = NAN;
    row[PITCH] = a->options.pitch * 180 / pi;
    if (a->options.whole) {
        TRY(turbine_get_shaft(&a->model, &angle, &speed, &twist));
        row[GENERATOR_POWER] = turbine_efficiency * turbine_gear * a->control.torque * speed;
        row[PITCH] = a->control.pitch * 180 / pi;
    }
    row[AERO_POWER] = torque * speed;
    row[ROTOR_SPEED] = speed * 30 / pi;
    row[AZIMUTH] = fmod(fmod(angle, 2 * pi) + 2 * pi, 2 * pi) * 180 / pi;
    for (int b = 0; b < TURBINE_BLADES; b++) {
        TRY(get_tip(a, b, row + TIPS + 2 * b));
        TRY(get_root(a, b, row + ROOTS + 2 * b));
    }
    row[ITERATIONS] = a->iterations;
    row[PARTS] = a->parts;
    row[UNBALANCED] = a->options.whole ? a->unbalanced : NAN;
    return get_tower(a, row + TOWER_TOP, row + TOWER_BASE);
}

int actuator_get_figure(actuator_machine *a, const char *column, double *value) {
    double row[FIGURES];
    for (int i = 0; i < FIGURES; i++) {
        if (strcmp(column, columns[i]) == 0) {
            TRY(get_figures(a, row));
            *value = row[i];
            return SPAR_OK;
        }
    }
    return actuator_say(a, SPAR_ERR_ARGUMENT, "there is no column '%s'", column);
}

/* ---- the file ---- */

static void write_names(FILE *file) {
    fputs("step,time_s", file);
    for (int i = 0; i < FIGURES; i++) {
        fprintf(file, ",%s", columns[i]);
    }
    fputc('\n', file);
}

/* Where the lines up to a time end. */
static long end_of_lines(FILE *file, double time) {
    char line[4096];
    long end = ftell(file);
    while (fgets(line, sizeof line, file) && strchr(line, '\n')) {
        const char *comma = strchr(line, ',');
        if (comma && strtod(comma + 1, NULL) <= time + 1e-9 * fmax(1, fabs(time))) {
            end = ftell(file);
        }
    }
    return end;
}

/* A file of an earlier run with the same columns goes on after its line of that time. */
static int keep_lines(actuator_machine *a, const char *path, FILE *file, double time, FILE *out) {
    char names[1024] = "", line[1024];
    FILE *expected = tmpfile();
    if (!expected) {
        return actuator_say(a, SPAR_ERR_IO, "no temporary file: %s", strerror(errno));
    }
    write_names(expected);
    rewind(expected);
    const int known =
        fgets(names, sizeof names, expected) && fgets(line, sizeof line, file) && strcmp(names, line) == 0;
    fclose(expected);
    if (!known) {
        return actuator_say(a, SPAR_ERR_IO, "%s has other columns than this turbine's: move it away", path);
    }
    const long end = end_of_lines(file, time);
    rewind(file);
    for (long i = 0; i < end; i++) {
        putc(getc(file), out);
    }
    return SPAR_OK;
}

static void format_line(const double row[FIGURES], int step, double time, char *line, size_t size) {
    int at = snprintf(line, size, "%d,%.9g", step, time);
    for (int i = 0; i < FIGURES && at > 0 && (size_t)at < size; i++) {
        at += snprintf(line + at, size - (size_t)at, ",%.8g", row[i]);
    }
}

int actuator_begin_figures(actuator_machine *a, const char *path, int keep, int step, double time) {
    double row[FIGURES];
    a->message[0] = '\0';
    const int length = snprintf(a->figures_path, sizeof a->figures_path, "%s", path);
    if (length < 1 || (size_t)length + 16 > sizeof a->figures_path) {
        return actuator_say(a, SPAR_ERR_ARGUMENT, "the path of the figures has %d letters", length);
    }
    a->figures_keep = keep;
    a->figures_time = time;
    TRY(get_figures(a, row));
    format_line(row, step, time, a->first_line, sizeof a->first_line);
    return SPAR_OK;
}

static int is_there(const char *path) {
    FILE *file = fopen(path, "r");
    return file && fclose(file) == 0;
}

/* Renames an older file to the first free name. */
static int keep_aside(actuator_machine *a) {
    char name[1100];
    int n = 0;
    do {
        snprintf(name, sizeof name, "%s.%d", a->figures_path, ++n);
    } while (is_there(name));
    return !is_there(a->figures_path) || rename(a->figures_path, name) == 0
               ? SPAR_OK
               : actuator_say(a, SPAR_ERR_IO, "%s cannot be renamed: %s", a->figures_path, strerror(errno));
}

/* The new file takes the old one's name when it is complete. */
static int open_figures(actuator_machine *a) {
    char name[1100];
    const char *path = a->figures_path;
    snprintf(name, sizeof name, "%s.new", path);
    FILE *old = a->figures_keep ? fopen(path, "r") : NULL;
    FILE *file = fopen(name, "w");
    int status = file ? SPAR_OK : actuator_say(a, SPAR_ERR_IO, "%s cannot be written: %s", name, strerror(errno));
    if (status == SPAR_OK && old) {
        status = keep_lines(a, path, old, a->figures_time, file);
    } else if (status == SPAR_OK) {
        write_names(file);
        if (!a->figures_keep) {
            fprintf(file, "%s\n", a->first_line);
        }
    }
    if (old) {
        fclose(old);
    }
    status = status || a->figures_keep ? status : keep_aside(a);
    if (status == SPAR_OK && (fflush(file) != 0 || rename(name, path) != 0)) {
        status = actuator_say(a, SPAR_ERR_IO, "%s cannot be written: %s", path, strerror(errno));
    }
    if (status != SPAR_OK) {
        if (file) {
            fclose(file);
            remove(name);
        }
        return status;
    }
    a->figures = file;
    return SPAR_OK;
}

int actuator_write_figures(actuator_machine *a, int step, double time) {
    double row[FIGURES];
    char line[1024];
    a->message[0] = '\0';
    TRY(a->figures ? SPAR_OK : open_figures(a));
    TRY(get_figures(a, row));
    format_line(row, step, time, line, sizeof line);
    fprintf(a->figures, "%s\n", line);
    return fflush(a->figures) == 0 ? SPAR_OK : actuator_say(a, SPAR_ERR_IO, "the figures: %s", strerror(errno));
}
