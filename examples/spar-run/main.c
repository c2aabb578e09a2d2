/* spar-run: what a case file describes, without a flow solver: static solution, modes, Campbell diagram, and a run
   under its loads or in its wind. */
#if !defined(_XOPEN_SOURCE) && !defined(_POSIX_C_SOURCE)
#define _POSIX_C_SOURCE 200809L
#endif
#include "run.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { LONGEST = 1024, USAGE = 2 };

static const char usage[] = "Usage: spar-run FILE.case [OPTIONS]\n"
                            "Solves the structure of a case file: static solution, modes, Campbell diagram, a run\n"
                            "under its loads or in the wind of its blade elements. [host run] in the file says what.\n"
                            "\n"
                            "  --do TASK,...   static, modes, campbell, run; instead of the file's\n"
                            "  --out DIR       folder of the results; default FILE.out in the working folder\n"
                            "  --no-plots      no pictures (they need gnuplot)\n"
                            "  --quiet         no table and no progress\n"
                            "  --explain       all headings and keys of a case file, with units and defaults\n"
                            "  --version, --help\n";

typedef struct arguments {
    const char *path, *out;
    int tasks, quiet, no_plots;
} arguments;

static int refuse(const char *format, const char *what) {
    (void)fprintf(stderr, "spar-run: ");
    (void)fprintf(stderr, format, what); /* NOLINT: one of the literals below */
    (void)fprintf(stderr, "; spar-run --help lists the options\n");
    return USAGE;
}

/* 0: go on; -1: the answer was given; otherwise the exit status. */
static int read_arguments(int count, char **word, arguments *a) {
    for (int i = 1; i < count; i++) {
        int takes = strcmp(word[i], "--do") == 0 || strcmp(word[i], "--out") == 0;
        if (takes && i + 1 >= count) {
            return refuse("%s needs a value", word[i]);
        }
        if (strcmp(word[i], "--help") == 0) {
            (void)fputs(usage, stdout);
            return -1;
        } else if (strcmp(word[i], "--version") == 0) {
            (void)printf("spar-run %s\n", spar_version());
            return -1;
        } else if (strcmp(word[i], "--explain") == 0) {
            spar_case_explain(stdout);
            run_explain(stdout);
            return -1;
        } else if (strcmp(word[i], "--do") == 0) {
            if (run_read_tasks("--do", word[++i], &a->tasks) != SPAR_OK) {
                return refuse("%s", run_message(&(const run){0}));
            }
        } else if (strcmp(word[i], "--out") == 0) {
            a->out = word[++i];
        } else if (strcmp(word[i], "--quiet") == 0) {
            a->quiet = 1;
        } else if (strcmp(word[i], "--no-plots") == 0) {
            a->no_plots = 1;
        } else if (word[i][0] == '-') {
            return refuse("no option %s", word[i]);
        } else if (a->path) {
            return refuse("one case file, not also %s", word[i]);
        } else {
            a->path = word[i];
        }
    }
    return a->path ? 0 : refuse("%s", "no case file");
}

/* FILE.out for folder/FILE.case. */
static void name_folder(const char *path, char folder[LONGEST]) {
    const char *slash = strrchr(path, '/'), *base = slash ? slash + 1 : path;
    const char *dot = strrchr(base, '.');
    size_t length = dot && dot > base ? (size_t)(dot - base) : strlen(base);
    (void)snprintf(folder, LONGEST, "%.*s.out", (int)length, base);
}

static int make_folder(const char *folder) {
    struct stat there;
    if (mkdir(folder, 0777) == 0 || (stat(folder, &there) == 0 && S_ISDIR(there.st_mode))) {
        return SPAR_OK;
    }
    return run_fail(SPAR_ERR_IO, "cannot make the folder %.300s: %s; make it, or name another by --out", folder,
                    strerror(errno));
}

static int read_scene(run *r, const arguments *a) {
    RUN_TRY(spar_session_create(&r->session));
    RUN_TRY(spar_case_read(a->path, "run", r->session, &r->scene));
    RUN_TRY(run_read_keys(r, a->tasks));
    if (spar_case_member_count(r->scene) == 0) {
        return run_fail(SPAR_ERR_ARGUMENT, "%s describes nothing; give [beam NAME], [rigid NAME] or [point NAME]",
                        a->path);
    }
    RUN_TRY(spar_case_make_aero(r->scene, 0));
    RUN_TRY(spar_case_restart(r->scene, NULL));
    RUN_TRY(spar_case_check_own(r->scene));
    RUN_TRY(run_check_keys(r));
    return make_folder(r->out);
}

static int do_tasks(run *r) {
    RUN_TRY(r->tasks & RUN_STATIC ? run_static(r) : SPAR_OK);
    RUN_TRY(r->tasks & RUN_MODES ? run_modes(r) : SPAR_OK);
    RUN_TRY(r->tasks & RUN_CAMPBELL ? run_campbell(r) : SPAR_OK);
    return r->tasks & RUN_STEPS ? run_steps(r) : SPAR_OK;
}

int main(int count, char **word) {
    arguments a = {0};
    char folder[LONGEST];
    int status = read_arguments(count, word, &a);
    if (status) {
        return status < 0 ? 0 : status;
    }
    name_folder(a.path, folder);
    run r = {.out = a.out ? a.out : folder, .quiet = a.quiet, .plots = !a.no_plots};
    status = read_scene(&r, &a);
    status = status == SPAR_OK ? do_tasks(&r) : status;
    if (status != SPAR_OK) {
        (void)fprintf(stderr, "spar-run: %s\n", run_message(&r));
    } else if (!r.quiet) {
        (void)printf("results in %s\n", r.out);
    }
    spar_case_free(&r.scene);
    spar_session_destroy(&r.session);
    return status == SPAR_OK ? 0 : 1;
}
