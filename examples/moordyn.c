#if !defined(_XOPEN_SOURCE) && !defined(_POSIX_C_SOURCE)
#define _POSIX_C_SOURCE 200809L
#endif
#include "moordyn.h"

#include <dlfcn.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ours, by the manual of MoorDyn 2 (C interface): a system is an opaque pointer, 0 is success */
typedef struct api {
    void *(*create)(const char *input);
    int (*verbosity)(void *system, int level);
    int (*count)(void *system, unsigned int *n);
    int (*init)(void *system, const double *x, const double *v);
    int (*step)(void *system, const double *x, const double *v, double *force, double *t, double *dt);
    int (*save)(void *system, size_t *bytes, uint64_t *data);
    int (*load)(void *system, const uint64_t *data);
    int (*close)(void *system);
} api;

struct moordyn {
    void *library, *system;
    api call;
    spar_fluid *fluid;
    int n;
    double *x, *v, *force; /* [n][3] */
    double begun;          /* s, t of the step whose beginning is in `state` */
    uint64_t *state;
    size_t bytes;
};

static char message[1024];

const char *moordyn_message(void) {
    return message;
}

static int refuse(int status, const char *what, const char *why) {
    (void)snprintf(message, sizeof message, "MoorDyn: %.400s: %.500s", what, why);
    return status;
}

/* All functions of the interface; an object pointer is no function pointer in ISO C, hence the copies. */
static int find_functions(moordyn *m, const char *path) {
    const struct {
        const char *name;
        void *to;
    } wanted[] = {{"MoorDyn_Create", &m->call.create},     {"MoorDyn_SetVerbosity", &m->call.verbosity},
                  {"MoorDyn_NCoupledDOF", &m->call.count}, {"MoorDyn_Init", &m->call.init},
                  {"MoorDyn_Step", &m->call.step},         {"MoorDyn_Serialize", &m->call.save},
                  {"MoorDyn_Deserialize", &m->call.load},  {"MoorDyn_Close", &m->call.close}};
    m->library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    if (!m->library) {
        const char *why = dlerror();
        return refuse(SPAR_ERR_IO, path, why ? why : "cannot be opened");
    }
    for (size_t i = 0; i < sizeof wanted / sizeof *wanted; i++) {
        void *found = dlsym(m->library, wanted[i].name);
        if (!found) {
            (void)snprintf(message, sizeof message, "MoorDyn: %.400s has no %s; version 2 of MoorDyn is wanted", path,
                           wanted[i].name);
            return SPAR_ERR_UNSUPPORTED;
        }
        memcpy(wanted[i].to, &found, sizeof found);
    }
    return SPAR_OK;
}

static int start(moordyn *m, const char *input, const double *x) {
    unsigned int degrees = 0;
    m->system = m->call.create(input);
    if (!m->system) {
        return refuse(SPAR_ERR_IO, input, "cannot be read, or is wrong; MoorDyn has printed why");
    }
    (void)m->call.verbosity(m->system, 3); /* errors alone */
    if (m->call.count(m->system, &degrees) != 0 || degrees != 3U * (unsigned int)m->n) {
        return refuse(SPAR_ERR_ARGUMENT, input, "has another number of coupled points than the body");
    }
    memcpy(m->x, x, 3 * (size_t)m->n * sizeof *x);
    if (m->call.init(m->system, m->x, m->v) != 0) {
        return refuse(SPAR_ERR_NUMERIC, input, "MoorDyn finds no equilibrium of the lines");
    }
    if (m->call.save(m->system, &m->bytes, NULL) != 0 || !(m->state = malloc(m->bytes + 1))) {
        return refuse(SPAR_ERR_MEMORY, input, "no memory for the lines' states");
    }
    return SPAR_OK;
}

static int told(spar_fluid *fluid, int status) {
    spar_member *member = NULL;
    spar_session *session = NULL;
    if (status != SPAR_OK && spar_fluid_get_member(fluid, &member) == SPAR_OK &&
        spar_member_get_session(member, &session) == SPAR_OK) {
        (void)snprintf(message, sizeof message, "%s", spar_session_message(session));
    }
    return status;
}

static int couple(spar_fluid *fluid, int n, const double *x) {
    int status = spar_fluid_set_motion_nodes(fluid, n, x);
    status = status == SPAR_OK ? spar_fluid_set_force_nodes(fluid, n, x) : status;
    return told(fluid, status == SPAR_OK ? spar_fluid_map(fluid) : status);
}

int moordyn_open(const char *library, const char *input, spar_fluid *fluid, int n, const double *x, moordyn **lines) {
    moordyn *m = calloc(1, sizeof *m);
    if (!m) {
        return refuse(SPAR_ERR_MEMORY, input, "no memory");
    }
    m->fluid = fluid;
    m->n = n;
    m->begun = NAN;
    m->x = calloc(3 * (size_t)n + 1, sizeof *m->x);
    m->v = calloc(3 * (size_t)n + 1, sizeof *m->v);
    m->force = calloc(3 * (size_t)n + 1, sizeof *m->force);
    int status = m->x && m->v && m->force ? find_functions(m, library) : refuse(SPAR_ERR_MEMORY, input, "no memory");
    status = status == SPAR_OK ? start(m, input, x) : status;
    status = status == SPAR_OK ? couple(fluid, n, x) : status;
    if (status != SPAR_OK) {
        moordyn_close(&m);
        return status;
    }
    *lines = m;
    return SPAR_OK;
}

/* States of t^n: kept at the first iteration of a step, brought back at the others. */
static int go_to_begin(moordyn *m, double t) {
    if (t == m->begun) {
        return m->call.load(m->system, m->state);
    }
    m->begun = t;
    return m->call.save(m->system, NULL, m->state);
}

int moordyn_pull(spar_session *session, double t, double dt, int iteration, void *context) {
    moordyn *m = context;
    const double settling = 20; /* s, in which lines come to rest where the body is held */
    double from = t, by = dt > 0 ? dt : settling;
    (void)iteration;
    int status = spar_fluid_pull_motion(m->fluid, 1, m->x, m->v);
    if (status != SPAR_OK) {
        return status;
    }
    if (dt > 0 && go_to_begin(m, t) != 0) {
        return spar_session_fail(session, SPAR_ERR_USER, "MoorDyn cannot save or restore the states of its lines");
    }
    if (m->call.step(m->system, m->x, m->v, m->force, &from, &by) != 0) {
        return spar_session_fail(session, SPAR_ERR_USER, "MoorDyn fails in its step; its own dtM may be too large");
    }
    return spar_fluid_push_forces(m->fluid, m->force, NULL);
}

void moordyn_close(moordyn **lines) {
    moordyn *m = lines ? *lines : NULL;
    if (!m) {
        return;
    }
    if (m->system) {
        (void)m->call.close(m->system);
    }
    if (m->library) {
        (void)dlclose(m->library);
    }
    free(m->x);
    free(m->v);
    free(m->force);
    free(m->state);
    free(m);
    *lines = NULL;
}
