#include "participant.h"

#include "case.h"
#include "precice_calls.h"

#include <math.h>
#include <spar/spar.h>
#include <spar/spar_coupling.h>
#include <spar/spar_mpi.h>
#include <spar/spar_structure.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* This rank's vertices of one mesh. */
typedef struct mesh {
    const char *name;
    int d;         /* dimensions */
    int n, *id;    /* [n] */
    double *x;     /* [n][3], reference positions */
    double box[6]; /* direct access: this rank's vertices are in it, upper bounds excluded */
} mesh;

typedef struct wet {
    spar_member *member;
    spar_fluid *fluid;
    mesh force, motion; /* of one name: both are the same */
    double *in, *out;   /* [n][6]: force and moment, or position and velocity; [n][3]: as preCICE has them */
} wet;

typedef struct run {
    spar_session *session;
    spar_case *scene;
    MPI_Comm comm;
    int rank, ranks, members, direct, saved;
    wet *wet;
    spar_fluid **fluid;
    const char *force, *moment, *displacement, *velocity; /* "": none */
    double level, reach, dt;                              /* dt 0: the window */
    char checkpoint[256];
    char *message;
    size_t size;
} run;

static int say(run *r, int status, const char *format, ...) {
    va_list list;
    va_start(list, format);
    vsnprintf(r->message, r->size, format, list);
    va_end(list);
    return status;
}

/* Calls of spar, and of the case file. */
static int told(run *r, int status) {
    return status == SPAR_OK ? SPAR_OK
                             : say(r, status, "%s: %s", spar_status_text(status), spar_session_message(r->session));
}
static int told_case(run *r, int status) {
    return status == SPAR_OK ? SPAR_OK : say(r, status, "%s", spar_case_message());
}

#define TRY(call)                                                                                                      \
    do {                                                                                                               \
        int status_ = (call);                                                                                          \
        if (status_ != SPAR_OK) {                                                                                      \
            return status_;                                                                                            \
        }                                                                                                              \
    } while (0)

static void *zeros(run *r, size_t n, size_t size) {
    void *all = calloc(n + 1, size);
    if (!all) {
        say(r, SPAR_ERR_MEMORY, "no memory");
    }
    return all;
}

/* What one rank has found wrong ends all of them. Collective. */
static int agree(run *r, int status) {
    int worst = SPAR_OK;
    MPI_Allreduce(&status, &worst, 1, MPI_INT, MPI_MAX, r->comm);
    if (status == SPAR_OK && worst != SPAR_OK) {
        say(r, worst, "another rank has failed and says why");
    }
    return status != SPAR_OK ? status : worst;
}

/* ---- the case ---- */

static int text(run *r, const char *key, const char *otherwise, const char **value) {
    return told_case(r, spar_case_get_text(r->scene, key, otherwise, value));
}
static int number(run *r, const char *key, const double *otherwise, double *value) {
    return told_case(r, spar_case_get_numbers(r->scene, key, 1, otherwise, value));
}

/* Value i of a list with one entry for each member. */
static int entry(run *r, const char *key, int i, const char **word) {
    int n = 0;
    TRY(told_case(r, spar_case_get_word(r->scene, key, i, &n, word)));
    return n == r->members
               ? SPAR_OK
               : say(r, SPAR_ERR_ARGUMENT, "%s: %d values for %d members; give one for each", key, n, r->members);
}

static int read_members(run *r) {
    const char *word;
    int apart = 0;
    TRY(told_case(r, spar_case_get_word(r->scene, "members", 0, &r->members, &word)));
    TRY(told_case(r, spar_case_get_word(r->scene, "force_meshes", 0, &apart, NULL)));
    r->wet = zeros(r, (size_t)r->members, sizeof *r->wet);
    r->fluid = zeros(r, (size_t)r->members, sizeof(spar_fluid *));
    if (!r->wet || !r->fluid) {
        return SPAR_ERR_MEMORY;
    }
    for (int i = 0; i < r->members; i++) {
        wet *w = &r->wet[i];
        TRY(told_case(r, spar_case_get_word(r->scene, "members", i, NULL, &word)));
        TRY(told_case(r, spar_case_member(r->scene, word, &w->member)));
        TRY(entry(r, apart ? "force_meshes" : "meshes", i, &w->force.name));
        TRY(entry(r, apart ? "motion_meshes" : "meshes", i, &w->motion.name));
        for (int k = 0; k < i; k++) {
            if (strcmp(r->wet[k].force.name, w->force.name) == 0 ||
                strcmp(r->wet[k].motion.name, w->motion.name) == 0) {
                return say(r, SPAR_ERR_ARGUMENT, "mesh %s has two members; give each member its own", w->force.name);
            }
        }
        TRY(told(r, spar_fluid_create(w->member, w->force.name, &w->fluid)));
        r->fluid[i] = w->fluid;
    }
    return SPAR_OK;
}

static int read_coupling(run *r) {
    const double none = 0;
    const char *access;
    TRY(text(r, "force", "Force", &r->force));
    TRY(text(r, "moment", "", &r->moment));
    TRY(text(r, "displacement", "Displacement", &r->displacement));
    TRY(text(r, "velocity", "", &r->velocity));
    TRY(number(r, "level", &none, &r->level));
    TRY(number(r, "dt", &none, &r->dt));
    TRY(text(r, "access", "own", &access));
    r->direct = strcmp(access, "direct") == 0;
    if (!r->direct && strcmp(access, "own") != 0) {
        return say(r, SPAR_ERR_ARGUMENT, "access %s: own or direct is wanted", access);
    }
    if (!(r->dt >= 0) || !isfinite(r->dt)) {
        return say(r, SPAR_ERR_ARGUMENT, "dt %g: give a number > 0, or leave it out", r->dt);
    }
    if (r->direct) {
        TRY(number(r, "reach", NULL, &r->reach));
    }
    return SPAR_OK;
}

/* preCICE iterates and accelerates; spar takes forces as they are read, one evaluation in each of its steps. */
static int open_case(run *r, const char *path) {
    const char *participant, *config;
    TRY(told_case(r, spar_case_read(path, "precice", r->session, &r->scene)));
    TRY(told(r, spar_session_set_coupling(r->session, SPAR_COUPLING_FIXED_POINT, 0, 1e-12, 1000)));
    TRY(told(r, spar_session_set_relaxation(r->session, 1)));
    TRY(told(r, spar_session_set_option(r->session, "coupling.unstable", "accept")));
    TRY(read_coupling(r));
    TRY(read_members(r));
    TRY(text(r, "participant", "Solid", &participant));
    TRY(text(r, "config", "precice-config.xml", &config));
    snprintf(r->checkpoint, sizeof r->checkpoint, "spar-precice.%.200s.checkpoint", participant);
    precicec_createParticipant(participant, config, r->rank, r->ranks);
    return SPAR_OK;
}

/* ---- meshes of our own ---- */

/* From the numbers of all vertices to those of this rank: one after the other. */
static void share(const run *r, int n, int *begin, int *end) {
    *begin = (int)((int64_t)n * r->rank / r->ranks);
    *end = (int)((int64_t)n * (r->rank + 1) / r->ranks);
}

static int read_points(run *r, const char *path, int *n, double **x) {
    FILE *file = fopen(path, "r");
    char line[256];
    double p[3];
    int room = 0, count = 0, row = 0;
    if (!file) {
        return say(r, SPAR_ERR_IO, "points %s cannot be read", path);
    }
    while (fgets(line, sizeof line, file)) {
        row++;
        if (line[strspn(line, " \t\r\n")] == '#' || line[strspn(line, " \t\r\n")] == 0) {
            continue;
        }
        if (sscanf(line, "%lf %lf %lf", p, p + 1, p + 2) != 3) { /* NOLINT */
            fclose(file);
            return say(r, SPAR_ERR_ARGUMENT, "%s:%d: three numbers are wanted", path, row);
        }
        if (count == room) {
            room = 2 * room + 64;
            double *more = realloc(*x, 3 * (size_t)room * sizeof *more);
            if (!more) {
                fclose(file);
                return say(r, SPAR_ERR_MEMORY, "no memory");
            }
            *x = more;
        }
        memcpy(*x + 3 * count++, p, sizeof p);
    }
    fclose(file);
    *n = count;
    return count > 0 ? SPAR_OK : say(r, SPAR_ERR_ARGUMENT, "%s has no points", path);
}

/* Around the station at x with the axes of q: point k of four sides, or the two ends of h. */
static void around(const double x[3], const double q[4], double h, double w, int points, int k, double out[3]) {
    const double y[3] = {2 * (q[1] * q[2] - q[0] * q[3]), 1 - 2 * (q[1] * q[1] + q[3] * q[3]),
                         2 * (q[2] * q[3] + q[0] * q[1])},
                 z[3] = {2 * (q[1] * q[3] + q[0] * q[2]), 2 * (q[2] * q[3] - q[0] * q[1]),
                         1 - 2 * (q[1] * q[1] + q[2] * q[2])};
    double a = k == 0 ? 0.5 : -0.5, b = 0;
    if (w > 0) {
        const double along = (k % points + 0.5) / points - 0.5;
        const double sides[4][2] = {{0.5, along}, {along, -0.5}, {-0.5, -along}, {-along, 0.5}};
        a = sides[k / points][0];
        b = sides[k / points][1];
    }
    for (int i = 0; i < 3; i++) {
        out[i] = x[i] + a * h * y[i] + b * w * z[i];
    }
}

static int make_box(run *r, const wet *w, int *count, double **points) {
    double box[4];
    TRY(told_case(r, spar_case_get_numbers(r->scene, "box", 4, NULL, box)));
    const int n = (int)fmin(fmax(box[2], 0), 1e6), k = (int)fmin(fmax(box[3], 0), 1e4), each = box[1] > 0 ? 4 * k : 2;
    if (!(box[0] > 0) || !(box[1] >= 0) || n < 2 || each < 1) {
        return say(r, SPAR_ERR_ARGUMENT, "box: give h > 0, w >= 0, two stations or more, points on each side");
    }
    double *work = zeros(r, 8 * (size_t)n, sizeof *work), *eta = work, *x = work ? eta + n : NULL,
           *q = work ? x + 3 * n : NULL;
    *points = zeros(r, 3 * (size_t)(n * each), sizeof **points);
    if (!work || !*points) {
        free(work);
        return SPAR_ERR_MEMORY;
    }
    for (int i = 0; i < n; i++) {
        eta[i] = (double)i / (n - 1);
    }
    const int status = told(r, spar_beam_evaluate(w->member, n, eta, NULL, NULL, x, q));
    for (int i = 0; status == SPAR_OK && i < n * each; i++) {
        around(x + 3 * (i / each), q + 4 * (i / each), box[0], box[1], k, i % each, *points + 3 * i);
    }
    free(work);
    *count = n * each;
    return status;
}

/* The vertices of this rank, told to preCICE. */
static int set_vertices(run *r, mesh *m, int n, const double *x) {
    int begin, end;
    share(r, n, &begin, &end);
    m->n = end - begin;
    m->id = zeros(r, (size_t)m->n, sizeof *m->id);
    m->x = zeros(r, 3 * (size_t)m->n, sizeof *m->x);
    double *flat = zeros(r, 3 * (size_t)m->n, sizeof *flat);
    if (!m->id || !m->x || !flat) {
        free(flat);
        return SPAR_ERR_MEMORY;
    }
    memcpy(m->x, x + 3 * begin, 3 * (size_t)m->n * sizeof *m->x);
    for (int i = 0; i < m->n && m->d == 2; i++) {
        if (fabs(m->x[3 * i + 2] - r->level) > 1e-9 * (1 + fabs(r->level))) {
            free(flat);
            return say(r, SPAR_ERR_ARGUMENT, "mesh %s has two dimensions, but a point has z = %g; level is %g", m->name,
                       m->x[3 * i + 2], r->level);
        }
    }
    for (int i = 0; i < m->n * m->d; i++) {
        flat[i] = m->x[3 * (i / m->d) + i % m->d];
    }
    precicec_setMeshVertices(m->name, m->n, flat, m->id);
    free(flat);
    return SPAR_OK;
}

static int make_own(run *r, int i) {
    wet *w = &r->wet[i];
    const char *file;
    double *x = NULL;
    int listed = 0, n = 0;
    TRY(told_case(r, spar_case_get_word(r->scene, "points", 0, &listed, NULL)));
    if (listed) {
        TRY(entry(r, "points", i, &file));
    }
    int status = listed ? read_points(r, file, &n, &x) : make_box(r, w, &n, &x);
    status = status ? status : set_vertices(r, &w->force, n, x);
    if (status == SPAR_OK && strcmp(w->force.name, w->motion.name) != 0) {
        status = set_vertices(r, &w->motion, n, x);
    }
    free(x);
    return status;
}

/* ---- meshes of the fluid ---- */

/* The box around a member's nodes, and this rank's slab of it. Slabs end where no vertex is likely to be. */
static int set_region(run *r, const wet *w, mesh *m) {
    int64_t nodes;
    double bound[6], precice[6];
    TRY(told(r, spar_member_get_count(w->member, &nodes)));
    double *x = zeros(r, 3 * (size_t)nodes, sizeof *x);
    if (!x) {
        return SPAR_ERR_MEMORY;
    }
    const int status = told(r, spar_member_get_reference(w->member, x, NULL));
    for (int k = 0; k < 3; k++) {
        bound[2 * k] = bound[2 * k + 1] = x[k];
        for (int64_t i = 1; i < nodes; i++) {
            bound[2 * k] = fmin(bound[2 * k], x[3 * i + k]);
            bound[2 * k + 1] = fmax(bound[2 * k + 1], x[3 * i + k]);
        }
        bound[2 * k] -= r->reach;
        bound[2 * k + 1] += r->reach;
    }
    free(x);
    int axis = 0;
    for (int k = 1; k < m->d; k++) {
        axis = bound[2 * k + 1] - bound[2 * k] > bound[2 * axis + 1] - bound[2 * axis] ? k : axis;
    }
    const double low = bound[2 * axis], length = bound[2 * axis + 1] - low, off = 0.0123456789;
    bound[2 * axis] = r->rank > 0 ? low + length * (r->rank + off) / r->ranks : low;
    bound[2 * axis + 1] = r->rank + 1 < r->ranks ? low + length * (r->rank + 1 + off) / r->ranks : low + length;
    memcpy(m->box, bound, sizeof bound);
    memcpy(precice, bound, sizeof bound);
    precicec_setMeshAccessRegion(m->name, precice);
    return status;
}

/* After preCICE's initialisation: the vertices in the region. */
static int get_vertices(run *r, mesh *m) {
    const int all = precicec_getMeshVertexSize(m->name);
    m->id = zeros(r, (size_t)all, sizeof *m->id);
    m->x = zeros(r, 3 * (size_t)all, sizeof *m->x);
    double *flat = zeros(r, 3 * (size_t)all, sizeof *flat);
    if (!m->id || !m->x || !flat) {
        free(flat);
        return SPAR_ERR_MEMORY;
    }
    precicec_getMeshVertexIDsAndCoordinates(m->name, all, m->id, flat);
    for (int i = 0; i < all; i++) {
        int inside = 1;
        for (int k = 0; k < m->d; k++) {
            const double at = flat[m->d * i + k];
            inside = inside && at >= m->box[2 * k] && at < m->box[2 * k + 1];
            m->x[3 * m->n + k] = at;
        }
        m->x[3 * m->n + 2] = m->d == 3 ? m->x[3 * m->n + 2] : r->level;
        m->id[m->n] = m->id[i];
        m->n += inside;
    }
    free(flat);
    return SPAR_OK;
}

/* ---- both ---- */

static int check_data(run *r, const mesh *m, const char *data) {
    if (data[0] != 0 && precicec_getDataDimensions(m->name, data) != m->d) {
        return say(r, SPAR_ERR_ARGUMENT,
                   "data %s of mesh %s have %d components, the mesh has %d dimensions; a vector is wanted", data,
                   m->name, precicec_getDataDimensions(m->name, data), m->d);
    }
    return SPAR_OK;
}

static int define_mesh(run *r, int i) {
    wet *w = &r->wet[i];
    w->force.d = precicec_getMeshDimensions(w->force.name);
    w->motion.d = precicec_getMeshDimensions(w->motion.name);
    TRY(check_data(r, &w->force, r->force));
    TRY(check_data(r, &w->motion, r->displacement));
    TRY(check_data(r, &w->motion, r->velocity));
    if (r->moment[0] != 0 && w->force.d != 3) {
        return say(r, SPAR_ERR_ARGUMENT, "moment %s: mesh %s has two dimensions; leave the moment out", r->moment,
                   w->force.name);
    }
    if (!r->direct) {
        return make_own(r, i);
    }
    TRY(set_region(r, w, &w->force));
    return strcmp(w->force.name, w->motion.name) != 0 ? set_region(r, w, &w->motion) : SPAR_OK;
}

static int define_meshes(run *r) {
    for (int i = 0; i < r->members; i++) {
        TRY(agree(r, define_mesh(r, i)));
    }
    return told_case(r, spar_case_check(r->scene));
}

/* The meshes of preCICE become the nodes of the members' fluids. */
static int map_mesh(run *r, wet *w) {
    const int one = strcmp(w->force.name, w->motion.name) == 0;
    if (r->direct) {
        TRY(get_vertices(r, &w->force));
        TRY(one ? SPAR_OK : get_vertices(r, &w->motion));
    }
    const mesh *m = one ? &w->force : &w->motion;
    const int most = m->n > w->force.n ? m->n : w->force.n;
    w->in = zeros(r, 6 * (size_t)most, sizeof *w->in);
    w->out = zeros(r, 3 * (size_t)most, sizeof *w->out);
    if (!w->in || !w->out) {
        return SPAR_ERR_MEMORY;
    }
    TRY(told(r, spar_fluid_set_motion_nodes(w->fluid, m->n, m->x)));
    TRY(told(r, spar_fluid_set_force_nodes(w->fluid, w->force.n, w->force.x)));
    return told(r, spar_fluid_map(w->fluid));
}

static int map_meshes(run *r) {
    for (int i = 0; i < r->members; i++) {
        wet *w = &r->wet[i];
        TRY(agree(r, map_mesh(r, w)));
        int count = 0;
        MPI_Allreduce(&w->force.n, &count, 1, MPI_INT, MPI_SUM, r->comm);
        if (count == 0) {
            return say(r, SPAR_ERR_ARGUMENT, "mesh %s has no vertex near its member; give a larger reach",
                       w->force.name);
        }
    }
    return SPAR_OK;
}

/* ---- a step ---- */

static int write_motion(run *r) {
    for (int i = 0; i < r->members; i++) {
        wet *w = &r->wet[i];
        const mesh *m = strcmp(w->force.name, w->motion.name) == 0 ? &w->force : &w->motion;
        double *x = w->in, *v = w->in + 3 * m->n;
        TRY(told(r, spar_fluid_pull_motion(w->fluid, 1, x, v)));
        for (int k = 0; k < m->n * m->d; k++) {
            const int at = 3 * (k / m->d) + k % m->d;
            w->out[k] = x[at] - m->x[at];
        }
        precicec_writeData(m->name, r->displacement, m->n, m->id, w->out);
        if (r->velocity[0] != 0) {
            for (int k = 0; k < m->n * m->d; k++) {
                w->out[k] = v[3 * (k / m->d) + k % m->d];
            }
            precicec_writeData(m->name, r->velocity, m->n, m->id, w->out);
        }
    }
    return SPAR_OK;
}

/* Loads at the end of a step of dt. */
static int read_loads(run *r, double dt) {
    for (int i = 0; i < r->members; i++) {
        wet *w = &r->wet[i];
        const mesh *m = &w->force;
        double *part[2] = {w->in, w->in + 3 * m->n};
        const char *data[2] = {r->force, r->moment};
        for (int k = 0; k < 2 && data[k][0] != 0; k++) {
            memset(part[k], 0, 3 * (size_t)m->n * sizeof *w->in);
            precicec_readData(m->name, data[k], m->n, m->id, dt, w->out);
            for (int j = 0; j < m->n * m->d; j++) {
                part[k][3 * (j / m->d) + j % m->d] = w->out[j];
            }
        }
        /* one that is refused (not a number) fails on all ranks in the next check */
        spar_fluid_push_forces(w->fluid, part[0], r->moment[0] != 0 ? part[1] : NULL);
    }
    return SPAR_OK;
}

static int solve(run *r, double dt) {
    int done;
    TRY(told(r, spar_step_begin(r->session, dt)));
    TRY(told(r, spar_step_solve(r->session)));
    TRY(read_loads(r, dt));
    TRY(told(r, spar_step_check(r->session, &done)));
    return told(r, spar_step_solve(r->session));
}

/* What is left of the window, or a step of the case file's; no step is a sliver. */
static double step_size(const run *r) {
    const double left = precicec_getMaxTimeStepSize();
    return r->dt > 0 && r->dt < left * (1 - 1e-6) ? r->dt : left;
}

/* A window of one step is repeated by reject and begin; of several, from a file. */
static int take_step(run *r) {
    const double dt = step_size(r);
    if (precicec_requiresWritingCheckpoint()) {
        r->saved = dt < precicec_getMaxTimeStepSize();
        TRY(r->saved ? told(r, spar_session_save(r->session, r->checkpoint)) : SPAR_OK);
    }
    TRY(solve(r, dt));
    TRY(write_motion(r));
    precicec_advance(dt);
    if (precicec_requiresReadingCheckpoint()) {
        TRY(told(r, spar_step_reject(r->session)));
        return r->saved ? told(r, spar_session_load(r->session, r->checkpoint)) : SPAR_OK;
    }
    TRY(told(r, spar_step_accept(r->session)));
    return precicec_isTimeWindowComplete() ? told_case(r, spar_case_output(r->scene, r->rank, r->members, r->fluid))
                                           : SPAR_OK;
}

static int run_case(run *r, const char *path) {
    TRY(open_case(r, path));
    TRY(define_meshes(r));
    if (precicec_requiresInitialData()) { /* of a mesh that is not known yet there are none */
        for (int i = 0; i < r->members && !r->direct; i++) {
            const wet *w = &r->wet[i];
            const mesh *m = strcmp(w->force.name, w->motion.name) == 0 ? &w->force : &w->motion;
            double *zero = zeros(r, 3 * (size_t)m->n, sizeof *zero);
            if (!zero) {
                return SPAR_ERR_MEMORY;
            }
            precicec_writeData(m->name, r->displacement, m->n, m->id, zero);
            free(zero);
        }
    }
    precicec_initialize();
    TRY(map_meshes(r));
    TRY(read_loads(r, 0)); /* at t = 0: the initial data, or zeros */
    while (precicec_isCouplingOngoing()) {
        TRY(take_step(r));
    }
    precicec_finalize();
    return SPAR_OK;
}

static void free_run(run *r) {
    for (int i = 0; i < r->members && r->wet; i++) {
        wet *w = &r->wet[i];
        free(w->force.id);
        free(w->force.x);
        free(w->motion.id);
        free(w->motion.x);
        free(w->in);
        free(w->out);
    }
    free(r->wet);
    free(r->fluid);
    spar_case_free(&r->scene);
    spar_session_destroy(&r->session);
    if (r->rank == 0 && r->checkpoint[0] != 0) {
        remove(r->checkpoint);
    }
}

int participant_run(const char *path, MPI_Comm comm, char *message, size_t size) {
    run r = {.comm = comm, .message = message, .size = size};
    message[0] = 0;
    MPI_Comm_rank(comm, &r.rank);
    MPI_Comm_size(comm, &r.ranks);
    int status = spar_session_create_mpi(comm, &r.session);
    status = status ? say(&r, status, "%s", spar_session_message(NULL)) : run_case(&r, path);
    free_run(&r);
    return status;
}
