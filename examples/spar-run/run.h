/* What the files of spar-run share: the scene of a case file, what is to be done with it, and where it is written. */
#ifndef SPAR_RUN_H
#define SPAR_RUN_H

#include "case.h"

#include <spar/spar_all.h>
#include <stdio.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { RUN_STATIC = 1, RUN_MODES = 2, RUN_CAMPBELL = 4, RUN_STEPS = 8 };

typedef struct run {
    spar_session *session;
    spar_case *scene;
    const char *out; /* folder of the results */
    int tasks;       /* RUN_* */
    int quiet, plots;
    double place[3];    /* m, a point of the axis about which driven roots turn, */
    double axis[3];     /* its direction, of length 1, */
    double speed;       /* rad/s, and the speed; 0: they stand still */
    int64_t load_steps; /* of the static solution */
    int64_t modes;      /* how many */
    double campbell[2]; /* how many speeds, and the fastest, rad/s */
    double dt, duration;
} run;

/* The tasks of a list of words as RUN_*. where: of the list, for the message. */
int run_read_tasks(const char *where, const char *list, int *tasks);
/* Reads the keys of [host run]. tasks: from the command line, 0: those of the file. Returns a spar status; a failure's
   message is in run_message. */
int run_read_keys(run *r, int tasks);
/* Whether they are what the tasks need: after keys that nobody asks for were refused. */
int run_check_keys(const run *r);
/* Prints the keys of [host run] as `spar_case_explain` prints the others. */
void run_explain(FILE *to);

/* The tasks. Each returns a spar status. */
int run_static(run *r);
int run_modes(run *r);
int run_campbell(run *r);
int run_steps(run *r);

/* Lets the members whose root is driven rotate at the speed, as they are bent: before the first step. */
int run_spin(const run *r, double speed);
/* Drives these roots: turned by the angle, at the speed, at the end of the next step. */
int run_drive(const run *r, double angle, double speed);
/* The loads of the blade elements, as a spar_fluid_solver; context: the run. */
int run_blow(spar_session *session, double t, double dt, int iteration, void *context);
/* Opens a file of the folder of the results; NULL, with a message: it cannot be written. */
FILE *run_open(const run *r, const char *name);
/* Closes what was written; a failure says that the disk may be full. */
int run_close(FILE *file, const char *name);
/* Writes a gnuplot script beside the results and runs gnuplot if it is there: NAME.gp, NAME.png. */
int run_plot(const run *r, const char *name, const char *script);

/* What went wrong last: of the case file, of spar, or of this program. */
const char *run_message(const run *r);
int run_fail(int status, const char *format, ...)
#if defined(__GNUC__)
    __attribute__((format(printf, 2, 3)))
#endif
    ;

#define RUN_TRY(call)                                                                                                  \
    do {                                                                                                               \
        int status_ = (call);                                                                                          \
        if (status_ != SPAR_OK) {                                                                                      \
            return status_;                                                                                            \
        }                                                                                                              \
    } while (0)

#ifdef __cplusplus
}
#endif

#endif
