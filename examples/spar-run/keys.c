/* The keys of [host run], files of results, and what went wrong. */
#if !defined(_XOPEN_SOURCE) && !defined(_POSIX_C_SOURCE)
#define _POSIX_C_SOURCE 200809L
#endif
#include "run.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

static char own_message[1024];

int run_fail(int status, const char *format, ...) {
    va_list list;
    va_start(list, format);
    (void)vsnprintf(own_message, sizeof own_message, format, list);
    va_end(list);
    return status;
}

const char *run_message(const run *r) {
    const char *session = spar_session_message(r->session);
    return own_message[0] ? own_message : spar_case_message()[0] ? spar_case_message() : session;
}

/* ---- keys ---- */

static const struct {
    const char *key, *text;
} keys[] = {
    {"do", "static modes campbell run: the tasks, in this order; default static modes"},
    {"rotation", "x y z  ax ay az  speed: driven roots turn about this axis; m, direction, rad/s; default: they stand"},
    {"load_steps", "n: equal parts in which the static solution applies the loads; default 1"},
    {"modes", "n: how many modes of each structure, and lines of the Campbell diagram; default 10"},
    {"campbell", "n fastest: so many speeds from 0 to the fastest, rad/s, about the axis of rotation"},
    {"dt", "s: the time step of run"},
    {"duration", "s: how long run lasts"},
};

void run_explain(FILE *to) {
    (void)fprintf(to, "\n[host run]: what spar-run does\n");
    for (size_t k = 0; k < sizeof keys / sizeof *keys; k++) {
        (void)fprintf(to, "  %-20s %s\n", keys[k].key, keys[k].text);
    }
}

static int read_whole(run *r, const char *key, double otherwise, int64_t *n) {
    double x;
    RUN_TRY(spar_case_get_numbers(r->scene, key, 1, &otherwise, &x));
    if (!(x >= 1 && x <= 100000) || x != floor(x)) {
        return run_fail(SPAR_ERR_ARGUMENT, "[host run]: %s is %g; give a whole number from 1 to 100000", key, x);
    }
    *n = (int64_t)x;
    return SPAR_OK;
}

static int read_rotation(run *r) {
    static const double still[7] = {0, 0, 0, 0, 0, 1, 0};
    double x[7];
    RUN_TRY(spar_case_get_numbers(r->scene, "rotation", 7, still, x));
    double length = sqrt(x[3] * x[3] + x[4] * x[4] + x[5] * x[5]);
    if (!(length > 0)) {
        return run_fail(SPAR_ERR_ARGUMENT,
                        "[host run]: the axis of rotation has no direction; give x y z ax ay az speed");
    }
    for (int i = 0; i < 3; i++) {
        r->place[i] = x[i];
        r->axis[i] = x[3 + i] / length;
    }
    r->speed = x[6];
    return SPAR_OK;
}

int run_read_tasks(const char *where, const char *list, int *tasks) {
    static const char *const names[] = {"static", "modes", "campbell", "run"};
    char copy[256], *rest = NULL;
    (void)snprintf(copy, sizeof copy, "%s", list);
    *tasks = 0;
    for (char *word = strtok_r(copy, ", ", &rest); word; word = strtok_r(NULL, ", ", &rest)) {
        int k = 0;
        while (k < 4 && strcmp(word, names[k]) != 0) {
            k++;
        }
        if (k == 4) {
            return run_fail(SPAR_ERR_ARGUMENT, "%s: no task '%.60s'; there are static, modes, campbell, run", where,
                            word);
        }
        *tasks |= 1 << k;
    }
    return *tasks ? SPAR_OK : run_fail(SPAR_ERR_ARGUMENT, "%s needs a task: static, modes, campbell, run", where);
}

static int read_do(run *r) {
    const char *text;
    int tasks;
    RUN_TRY(spar_case_get_text(r->scene, "do", "static modes", &text));
    RUN_TRY(run_read_tasks("[host run]: do", text, &tasks));
    r->tasks = r->tasks ? r->tasks : tasks;
    return SPAR_OK;
}

int run_read_keys(run *r, int tasks) {
    static const double unset = NAN, none[2] = {0, 0};
    r->tasks = tasks;
    RUN_TRY(read_do(r));
    RUN_TRY(read_rotation(r));
    RUN_TRY(read_whole(r, "load_steps", 1, &r->load_steps));
    RUN_TRY(read_whole(r, "modes", 10, &r->modes));
    RUN_TRY(spar_case_get_numbers(r->scene, "campbell", 2, none, r->campbell));
    RUN_TRY(spar_case_get_numbers(r->scene, "dt", 1, &unset, &r->dt));
    return spar_case_get_numbers(r->scene, "duration", 1, &unset, &r->duration);
}

int run_check_keys(const run *r) {
    double n = r->campbell[0];
    if ((r->tasks & RUN_STEPS) && !(r->dt > 0 && r->duration > 0)) {
        return run_fail(SPAR_ERR_ARGUMENT, "[host run]: a run needs dt and duration, s, above 0");
    }
    if ((r->tasks & RUN_CAMPBELL) && (!(n >= 2 && n <= 1000) || n != floor(n) || !(r->campbell[1] > 0))) {
        return run_fail(
            SPAR_ERR_ARGUMENT,
            "[host run]: campbell needs 2 to 1000 speeds and a fastest above 0, rad/s, as in: campbell 11 2");
    }
    return SPAR_OK;
}

/* ---- rotation of the roots, loads of the blade elements ---- */

/* to = the vector turned about the axis by the angle (Rodrigues). */
static void turn(const double axis[3], double angle, const double x[3], double to[3]) {
    double c = cos(angle), s = sin(angle), along = axis[0] * x[0] + axis[1] * x[1] + axis[2] * x[2];
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        to[i] = c * x[i] + s * (axis[j] * x[k] - axis[k] * x[j]) + (1 - c) * along * axis[i];
    }
}

/* The reference position of the root. */
static int find_root(const spar_member *member, double x[3]) {
    int64_t nodes;
    RUN_TRY(spar_member_get_count(member, &nodes));
    double *all = calloc(3 * (size_t)nodes, sizeof *all);
    if (!all) {
        return run_fail(SPAR_ERR_MEMORY, "no memory for %lld nodes", (long long)nodes);
    }
    int status = spar_member_get_reference(member, all, NULL);
    memcpy(x, all, 3 * sizeof *x);
    free(all);
    return status;
}

static int drive_root(const run *r, spar_member *member, double angle, double speed) {
    double place[3] = {0}, arm[3], now[3], q[7], v[6], a[6] = {0};
    RUN_TRY(find_root(member, place));
    for (int i = 0; i < 3; i++) {
        arm[i] = place[i] - r->place[i];
    }
    turn(r->axis, angle, arm, now);
    q[3] = cos(angle / 2);
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        q[i] = now[i] - arm[i];
        q[4 + i] = sin(angle / 2) * r->axis[i];
        v[i] = speed * (r->axis[j] * now[k] - r->axis[k] * now[j]);
        v[3 + i] = speed * r->axis[i];
    }
    for (int i = 0; i < 3; i++) { /* omega x v */
        int j = (i + 1) % 3, k = (i + 2) % 3;
        a[i] = speed * (r->axis[j] * v[k] - r->axis[k] * v[j]);
    }
    return spar_member_drive(member, q, v, a);
}

int run_drive(const run *r, double angle, double speed) {
    for (int64_t m = 0; m < spar_case_member_count(r->scene); m++) {
        spar_member *member = spar_case_member_at(r->scene, m);
        int root = 0;
        RUN_TRY(spar_member_get_root(member, &root));
        RUN_TRY(root == SPAR_ROOT_DRIVEN ? drive_root(r, member, angle, speed) : SPAR_OK);
    }
    return SPAR_OK;
}

int run_spin(const run *r, double speed) {
    double omega[3];
    for (int i = 0; i < 3; i++) {
        omega[i] = speed * r->axis[i];
    }
    for (int64_t m = 0; m < spar_case_member_count(r->scene); m++) {
        spar_member *member = spar_case_member_at(r->scene, m);
        int root = 0;
        RUN_TRY(spar_member_get_root(member, &root));
        RUN_TRY(root == SPAR_ROOT_DRIVEN ? spar_member_set_initial_velocity(member, r->place, NULL, omega) : SPAR_OK);
    }
    return SPAR_OK;
}

int run_blow(spar_session *session, double t, double dt, int iteration, void *context) {
    run *r = context;
    (void)session, (void)t, (void)dt, (void)iteration;
    return spar_case_blow(r->scene);
}

/* ---- files ---- */

FILE *run_open(const run *r, const char *name) {
    char path[2048];
    (void)snprintf(path, sizeof path, "%.1000s/%.1000s", r->out, name);
    FILE *file = fopen(path, "w");
    if (!file) {
        (void)run_fail(SPAR_ERR_IO, "cannot write %.600s: %s; check the folder and its permissions", path,
                       strerror(errno));
    }
    return file;
}

int run_close(FILE *file, const char *name) {
    int failed = ferror(file);
    return fclose(file) != 0 || failed ? run_fail(SPAR_ERR_IO, "cannot write %.300s; is the disk full?", name)
                                       : SPAR_OK;
}

int run_plot(const run *r, const char *name, const char *script) {
    char file_name[256], command[2600];
    if (!r->plots) {
        return SPAR_OK;
    }
    (void)snprintf(file_name, sizeof file_name, "%.200s.gp", name);
    FILE *file = run_open(r, file_name);
    if (!file) {
        return SPAR_ERR_IO;
    }
    (void)fprintf(file,
                  "# gnuplot %s, in this folder\nset terminal pngcairo size 1000,600\nset output '%.200s.png'\n"
                  "set datafile separator ','\nset grid\nset key outside right top\n%s",
                  file_name, name, script);
    RUN_TRY(run_close(file, file_name));
    /* the folder's name may have any character but a quote */
    if (strchr(r->out, '\'')) {
        return SPAR_OK;
    }
    (void)snprintf(command, sizeof command, "cd '%.1000s' && gnuplot '%.200s' >/dev/null 2>&1", r->out, file_name);
    if (system(command) != 0 && !r->quiet) { /* NOLINT(cert-env33-c): gnuplot is a program */
        (void)printf("no picture: gnuplot failed or is not there; later: cd %s && gnuplot %s\n", r->out, file_name);
    }
    return SPAR_OK;
}
