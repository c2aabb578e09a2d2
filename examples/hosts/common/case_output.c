/* What a case writes: pictures of members and fluids for ParaView, and a history, a line a step. */
#if !defined(_XOPEN_SOURCE) && !defined(_POSIX_C_SOURCE)
#define _POSIX_C_SOURCE 200809L
#endif
#include "case_parts.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <spar/spar_output.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { LONGEST_PATH = 1024, WATCHED = 9 };

/* Two clocks that add the same steps differ less, relatively. */
static const double SAME_TIME = 1e-9;

/* A call of spar that no line of the file stands for. */
#define DO(c, call) CASE_TRY(case_told(c, 0, call))

/* ---- what is asked for ---- */

static int read_watches(spar_case *c, const case_block *block) {
    case_output *o = &c->output;
    const case_line *line;
    int64_t most = 0, nodes;
    o->watch = calloc((size_t)block->n + 1, sizeof *o->watch);
    if (!o->watch) {
        return case_no_memory(c);
    }
    for (int64_t at = 0; (line = case_next(block, "watch", &at)); o->watches++) {
        case_watch *w = o->watch + o->watches;
        CASE_TRY(case_find_member(c, line, 1, &w->member));
        CASE_TRY(case_find_node(c, line, 2, w->member, &w->node));
        CASE_TRY(case_told(c, line->number, spar_member_get_count(w->member, &w->nodes)));
        nodes = w->nodes;
        most = nodes > most ? nodes : most;
    }
    o->q = calloc(7 * (size_t)most + 1, sizeof *o->q);
    o->v = calloc(6 * (size_t)most + 1, sizeof *o->v);
    o->load = calloc(6 * (size_t)most + 1, sizeof *o->load);
    return o->q && o->v && o->load ? SPAR_OK : case_no_memory(c);
}

static int read_block(spar_case *c, const case_block *block) {
    const case_line *folder = case_find(block, "folder"), *every = case_find(block, "every"),
                    *fluids = case_find(block, "fluids"), *history = case_find(block, "history"),
                    *watch = case_find(block, "watch"), *save = case_find(block, "save");
    case_output *o = &c->output;
    o->save_every = 1;
    CASE_TRY(save && save->n > 1 ? case_whole(&c->text, save, 2, 1, INT32_MAX, &o->save_every) : SPAR_OK);
    o->save_path = save ? save->word[1] : NULL;
    CASE_TRY(every ? case_whole(&c->text, every, 1, 0, INT32_MAX, &o->every) : SPAR_OK);
    CASE_TRY(fluids ? case_on_or_off(c, fluids, &o->fluids) : SPAR_OK);
    o->folder = folder ? folder->word[1] : ".";
    o->history_path = history ? history->word[1] : NULL;
    if (strlen(o->folder) > LONGEST_PATH / 2) {
        return case_fail(&c->text, folder->number, SPAR_ERR_ARGUMENT, "folder has a path of more than %d characters",
                         LONGEST_PATH / 2);
    }
    if (watch && !history) {
        return case_fail(&c->text, watch->number, SPAR_ERR_ARGUMENT, "watch needs a history; give history FILE");
    }
    return read_watches(c, block);
}

int case_output_read(spar_case *c) {
    const case_block *common = NULL, *own = NULL;
    for (int64_t b = 0; b < c->text.n; b++) {
        const case_block *block = c->text.block + b;
        if (case_is(block, "output") && case_is_for(block, c->host)) {
            *(block->name[0] ? &own : &common) = block;
        }
    }
    return own ? read_block(c, own) : common ? read_block(c, common) : SPAR_OK;
}

void case_output_free(case_output *output) {
    if (output->history) {
        (void)fclose(output->history);
    }
    free(output->watch);
    free(output->q);
    free(output->v);
    free(output->load);
}

/* ---- pictures ---- */

static int need_folder(const spar_case *c) {
    struct stat there;
    if (mkdir(c->output.folder, 0777) == 0 || (stat(c->output.folder, &there) == 0 && S_ISDIR(there.st_mode))) {
        return SPAR_OK;
    }
    return case_fail(&c->text, 0, SPAR_ERR_IO, "cannot make the folder %.300s: %s; make it, or name another",
                     c->output.folder, strerror(errno));
}

/* Names of members and fluids may have what a file name must not. */
static void file_name(char to[LONGEST_PATH], const char *name, const char *more) {
    (void)snprintf(to, LONGEST_PATH, "%.200s%s", name, more);
    for (char *at = to; *at; at++) {
        *at = *at == '/' || *at == '\\' ? '_' : *at;
    }
}

/* The picture of a member or (member NULL) a fluid at this step, and its entry in its series. */
static int write_picture(const spar_case *c, const spar_member *member, const spar_fluid *fluid, int rank, double t,
                         int64_t step) {
    char part[64], stem[LONGEST_PATH], file[2 * LONGEST_PATH], path[4 * LONGEST_PATH], series[4 * LONGEST_PATH];
    (void)snprintf(part, sizeof part, ".%d", rank);
    part[0] = member ? '\0' : part[0];
    file_name(stem, member ? spar_member_get_name(member) : spar_fluid_get_name(fluid), part);
    (void)snprintf(file, sizeof file, "%s.%06" PRId64 ".vtp", stem, step);
    (void)snprintf(path, sizeof path, "%s/%s", c->output.folder, file);
    (void)snprintf(series, sizeof series, "%s/%s.pvd", c->output.folder, stem);
    DO(c, member ? spar_member_write_vtk(member, path) : spar_fluid_write_vtk(fluid, path));
    int status = spar_vtk_series_add(series, t, 0, file);
    return status == SPAR_OK ? SPAR_OK : case_fail(&c->text, 0, status, "%s", spar_session_message(NULL));
}

static int write_pictures(const spar_case *c, int rank, int fluids, spar_fluid *const *fluid, double t, int64_t step) {
    CASE_TRY(need_folder(c));
    for (int64_t m = 0; rank == 0 && m < c->members; m++) {
        CASE_TRY(write_picture(c, c->member[m], NULL, rank, t, step));
    }
    for (int f = 0; c->output.fluids && f < fluids; f++) {
        CASE_TRY(write_picture(c, NULL, fluid[f], rank, t, step));
    }
    return SPAR_OK;
}

/* ---- history ---- */

static int no_history(const char *path, const char *cure) {
    return case_fail(NULL, 0, SPAR_ERR_IO, "cannot write the history %.300s: %s; %s", path, strerror(errno), cure);
}

/* Where the first row after t begins; the length of the file: there is none. */
static long find_row_after(FILE *file, double t) {
    char start[64];
    long at = 0;
    int c = 0;
    for (; c != EOF; at = ftell(file)) {
        char *end;
        if (!fgets(start, sizeof start, file)) {
            break;
        }
        const double row = strtod(start, &end);
        if (end != start && row > t) {
            break;
        }
        for (c = strchr(start, '\n') ? '\n' : 0; c != '\n' && c != EOF;) {
            c = fgetc(file);
        }
    }
    return at;
}

int spar_case_cut_history(const char *path, double t) {
    if (!path || !(t >= 0)) {
        return case_fail(NULL, 0, SPAR_ERR_ARGUMENT, "spar_case_cut_history: path is NULL, or t below 0 or NaN");
    }
    case_quiet quiet;
    FILE *file = fopen(path, "r");
    if (!file) {
        return errno == ENOENT ? SPAR_OK : no_history(path, "check the folder and its permissions");
    }
    int status = case_quiet_begin(&quiet);
    if (status == SPAR_OK) {
        const long end = find_row_after(file, t * (1 + SAME_TIME));
        case_quiet_end(&quiet);
        status =
            end >= 0 && truncate(path, end) == 0 ? SPAR_OK : no_history(path, "check the folder and its permissions");
    }
    (void)fclose(file);
    return status;
}

/* A run that goes on from a saved one goes on in its file, behind the row of its first time. */
static int open_history(spar_case *c, double t, int64_t step) {
    case_output *o = &c->output;
    o->headed = step > 1;
    CASE_TRY(o->headed ? spar_case_cut_history(o->history_path, t * (1 - 2 * SAME_TIME)) : SPAR_OK);
    o->history = fopen(o->history_path, o->headed ? "a" : "w");
    return o->history ? SPAR_OK : no_history(o->history_path, "check the folder and its permissions");
}

static void write_heading(const case_output *o) {
    static const char *const column[WATCHED] = {"ux", "uy", "uz", "vx", "vy", "vz", "fx", "fy", "fz"};
    (void)fprintf(o->history, "# t step iterations residual loads added_mass");
    for (int64_t w = 0; w < o->watches; w++) {
        for (int k = 0; k < WATCHED; k++) {
            (void)fprintf(o->history, " %s.%" PRId64 ".%s", spar_member_get_name(o->watch[w].member), o->watch[w].node,
                          column[k]);
        }
    }
    (void)fprintf(o->history, "\n");
}

static int write_watch(const spar_case *c, const case_watch *w) {
    const case_output *o = &c->output;
    double row[WATCHED] = {0};
    DO(c, spar_member_get_motion(w->member, o->q, o->v, NULL));
    DO(c, spar_member_get_loads(w->member, o->load));
    for (int k = 0; k < 3; k++) {
        row[k] = o->q[7 * w->node + k];
        row[3 + k] = o->v[6 * w->node + k];
        for (int64_t i = 0; i < w->nodes; i++) {
            row[6 + k] += o->load[6 * i + k];
        }
    }
    for (int k = 0; k < WATCHED; k++) {
        (void)fprintf(o->history, " %.17g", row[k]);
    }
    return SPAR_OK;
}

static int write_history(spar_case *c, double t, int64_t step, int iteration) {
    case_output *o = &c->output;
    double report[SPAR_REPORT_COUNT], residual, size;
    CASE_TRY(o->history ? SPAR_OK : open_history(c, t, step));
    if (!o->headed) {
        write_heading(o);
        o->headed = 1;
    }
    DO(c, spar_session_get_report(c->session, SPAR_REPORT_COUNT, report));
    DO(c, spar_session_get_residual(c->session, &residual, &size));
    (void)fprintf(o->history, "%.17g %" PRId64 " %d %.6g %.6g %.6g", t, step, iteration, residual, size,
                  report[SPAR_REPORT_ADDED_MASS]);
    for (int64_t w = 0; w < o->watches; w++) {
        CASE_TRY(write_watch(c, o->watch + w));
    }
    (void)fprintf(o->history, "\n");
    if (fflush(o->history) != 0) {
        return no_history(o->history_path, "is the disk full?");
    }
    return SPAR_OK;
}

/* The session under the step's name, by all ranks: also by those whose picture could not be written. */
static int save_session(const spar_case *c, int status, int64_t step) {
    char path[LONGEST_PATH + 32];
    (void)snprintf(path, sizeof path, "%.*s.%06" PRId64, LONGEST_PATH, c->output.save_path, step);
    int saved = spar_session_save(c->session, path);
    return status == SPAR_OK ? case_told(c, 0, saved) : status;
}

int spar_case_output(spar_case *scene, int rank, int fluids, spar_fluid *const *fluid) {
    if (!scene || rank < 0 || fluids < 0 || (fluids > 0 && !fluid)) {
        return case_fail(NULL, 0, SPAR_ERR_ARGUMENT,
                         "spar_case_output: scene is NULL, rank below 0, or fluids without "
                         "an array");
    }
    double t;
    int64_t step;
    int iteration;
    case_quiet quiet;
    DO(scene, spar_session_get_time(scene->session, &t, &step, &iteration));
    CASE_TRY(case_quiet_begin(&quiet));
    int status = SPAR_OK;
    if (scene->output.history_path && rank == 0) {
        status = write_history(scene, t, step, iteration);
    }
    if (status == SPAR_OK && scene->output.every > 0 && step % scene->output.every == 0) {
        status = write_pictures(scene, rank, fluids, fluid, t, step);
    }
    case_quiet_end(&quiet);
    if (scene->output.save_path && step % scene->output.save_every == 0) {
        return save_session(scene, status, step);
    }
    return status;
}

/* ---- a run that goes on ---- */

/* The line that holds, what is this host's before what is all hosts'; NULL: none. */
static const case_line *restart_line(const spar_case *c) {
    const case_line *line = NULL;
    for (int own = 0; own < 2; own++) {
        for (int64_t b = 0; b < c->text.n; b++) {
            const case_block *block = c->text.block + b;
            if (case_is(block, "session") && case_is_for(block, c->host) && own == (block->name[0] != '\0')) {
                const case_line *found = case_find(block, "restart");
                line = found ? found : line;
            }
        }
    }
    return line;
}

int spar_case_restart(spar_case *scene, int *restarted) {
    if (!scene) {
        return case_fail(NULL, 0, SPAR_ERR_ARGUMENT, "spar_case_restart: scene is NULL");
    }
    const case_line *line = restart_line(scene);
    scene->restarts = 1;
    if (line) {
        CASE_TRY(case_told(scene, line->number, spar_session_load(scene->session, line->word[1])));
    }
    if (restarted) {
        *restarted = line != NULL;
    }
    return SPAR_OK;
}

int spar_case_resume(spar_case *scene, const char *path, double t, int64_t step) {
    if (!scene || !(t >= 0)) {
        return case_fail(NULL, 0, SPAR_ERR_ARGUMENT, "spar_case_resume: scene is NULL, or t below 0 or NaN");
    }
    const case_line *line = restart_line(scene);
    const char *file = line ? line->word[1] : path;
    const int number = line ? line->number : 0;
    double saved_t = 0;
    int64_t saved_step = 0;
    char flow[96];
    scene->restarts = 1;
    if (!file && t == 0 && step < 1) {
        return SPAR_OK;
    }
    (void)snprintf(flow, sizeof flow, path ? "the flow continues from t = %.10g s" : "the flow starts at t = %.10g s",
                   t);
    if (!file) {
        return case_fail(&scene->text, 0, SPAR_ERR_ARGUMENT, "%s and the structure at 0; give restart FILE", flow);
    }
    const int status = spar_session_load(scene->session, file);
    if (status != SPAR_OK) {
        return case_fail(&scene->text, number, status,
                         "%s, and the structure cannot: %.300s; the file of that time was saved with the flow's own "
                         "checkpoint",
                         flow, spar_session_message(scene->session));
    }
    DO(scene, spar_session_get_time(scene->session, &saved_t, &saved_step, NULL));
    if (!(fabs(saved_t - t) <= SAME_TIME * fmax(t, saved_t)) || (step >= 0 && saved_step != step)) {
        return case_fail(&scene->text, number, SPAR_ERR_ARGUMENT,
                         "%s (step %" PRId64 "), and the structure in %.200s from %.10g s (step %" PRId64
                         "); give the file that was saved with the flow's own checkpoint",
                         flow, step, file, saved_t, saved_step);
    }
    return SPAR_OK;
}
