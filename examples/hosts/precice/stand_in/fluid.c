#include "fluid.h"
#include "../adapter/precice_calls.h"

#include <math.h>
#include <mpi.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct vertices {
    int n, total, *at;      /* on this rank, on all; direct: numbers of the vertices in the region */
    double *x, *d, *v;      /* [n][3], as written */
    double *d0, *v0;        /* at the beginning of the window */
    double *force, *force0; /* read at the end of the window, and at its beginning */
    double box[6];
} vertices;

static fluid played;
static vertices all[FLUID_MESHES];
static double mean_d[FLUID_MESHES][FLUID_WINDOWS][3], mean_v[FLUID_MESHES][FLUID_WINDOWS][3];
static int iterations[FLUID_WINDOWS], windows, iteration, ongoing, complete, write_due, read_due, initialized;
static double elapsed;

static void need(int good, const char *what) {
    if (!good) {
        fprintf(stderr, "stand-in of preCICE: %s\n", what);
        MPI_Abort(MPI_COMM_WORLD, 1);
        exit(1);
    }
}

static int find(const char *name) {
    for (int i = 0; i < FLUID_MESHES; i++) {
        if (played.mesh[i].name && strcmp(played.mesh[i].name, name) == 0) {
            return i;
        }
    }
    need(0, "there is no such mesh");
    return 0;
}

static void allocate(vertices *v, int n) {
    double **part[] = {&v->x, &v->d, &v->v, &v->d0, &v->v0, &v->force, &v->force0};
    v->n = n;
    for (size_t i = 0; i < sizeof part / sizeof part[0]; i++) {
        *part[i] = calloc(3 * (size_t)n + 1, sizeof **part[i]);
        need(*part[i] != NULL, "no memory");
    }
}

static void release(void) {
    for (int i = 0; i < FLUID_MESHES; i++) {
        vertices *v = &all[i];
        double *part[] = {v->x, v->d, v->v, v->d0, v->v0, v->force, v->force0};
        for (size_t k = 0; k < sizeof part / sizeof part[0]; k++) {
            free(part[k]);
        }
        free(v->at);
        *v = (vertices){0};
    }
}

void fluid_play(const fluid *what) {
    played = *what;
    release();
    windows = iteration = ongoing = complete = write_due = read_due = initialized = 0;
    elapsed = 0;
}

const double *fluid_displacement(int mesh, int window) {
    return mean_d[mesh][window];
}
const double *fluid_velocity(int mesh, int window) {
    return mean_v[mesh][window];
}
int fluid_windows(void) {
    return windows;
}
int fluid_iterations(int window) {
    return iterations[window];
}
const double *fluid_vertex(int mesh, int i) {
    return all[mesh].d0 + 3 * i;
}
int fluid_vertices(int mesh) {
    return all[mesh].n;
}

/* ---- definition ---- */

void precicec_createParticipant(const char *participant, const char *config, int rank, int ranks) {
    int own, size;
    MPI_Comm_rank(MPI_COMM_WORLD, &own);
    MPI_Comm_size(MPI_COMM_WORLD, &size);
    need(strcmp(participant, "Solid") == 0 && strcmp(config, "stand-in.xml") == 0, "participant or configuration");
    need(rank == own && ranks == size, "rank or number of ranks");
}
int precicec_getMeshDimensions(const char *mesh) {
    find(mesh);
    return played.dimensions;
}
int precicec_getDataDimensions(const char *mesh, const char *data) {
    find(mesh);
    return strcmp(data, "Pressure") == 0 ? 1 : played.dimensions;
}
void precicec_setMeshVertices(const char *mesh, int n, const double *x, int *id) {
    const int i = find(mesh), dim = played.dimensions;
    need(!initialized && played.mesh[i].own, "vertices of a mesh that is not one's own, or too late");
    allocate(&all[i], n);
    for (int k = 0; k < n; k++) {
        memcpy(all[i].x + 3 * k, x + dim * k, (size_t)dim * sizeof *x);
        id[k] = 2 * k + 7; /* numbers are preCICE's own */
    }
}
void precicec_setMeshAccessRegion(const char *mesh, const double *box) {
    const int i = find(mesh);
    need(!initialized && !played.mesh[i].own, "a region of one's own mesh, or too late");
    memcpy(all[i].box, box, 2 * (size_t)played.dimensions * sizeof *box);
}
int precicec_getMeshVertexSize(const char *mesh) {
    return all[find(mesh)].n;
}
void precicec_getMeshVertexIDsAndCoordinates(const char *mesh, int n, int *id, double *x) {
    const int i = find(mesh), dim = played.dimensions;
    need(initialized && n == all[i].n, "vertices before initialize, or another number");
    for (int k = 0; k < n; k++) {
        memcpy(x + dim * k, all[i].x + 3 * k, (size_t)dim * sizeof *x);
        id[k] = 2 * k + 7;
    }
}
int precicec_requiresInitialData(void) {
    return 0;
}

/* The vertices in the region, bounds included. */
static void select_vertices(int i) {
    const fluid_mesh *m = &played.mesh[i];
    int n = 0, *in = calloc((size_t)m->n + 1, sizeof *in);
    need(in != NULL, "no memory");
    for (int k = 0; k < m->n; k++) {
        int inside = 1;
        for (int c = 0; c < played.dimensions; c++) {
            const double x = m->vertices[3 * k + c];
            inside = inside && x >= all[i].box[2 * c] && x <= all[i].box[2 * c + 1];
        }
        in[n] = k;
        n += inside;
    }
    allocate(&all[i], n);
    all[i].at = in;
    for (int k = 0; k < n; k++) {
        memcpy(all[i].x + 3 * k, m->vertices + 3 * in[k], (size_t)played.dimensions * sizeof(double));
    }
}

/* ---- the fluid ---- */

static void find_forces(int i, double *force) {
    const fluid_mesh *m = &played.mesh[i];
    const vertices *v = &all[i];
    for (int k = 0; k < 3 * v->n; k++) {
        const double speed = (v->d[k] - v->d0[k]) / played.window, gain = (speed - v->v0[k]) / played.window;
        force[k] = (m->force[k % 3] - m->spring * v->d[k] - m->damper * speed - m->mass * gain) / v->total;
    }
}

void precicec_initialize(void) {
    for (int i = 0; i < FLUID_MESHES; i++) {
        if (played.mesh[i].name) {
            if (!played.mesh[i].own) {
                select_vertices(i);
            }
            MPI_Allreduce(&all[i].n, &all[i].total, 1, MPI_INT, MPI_SUM, MPI_COMM_WORLD);
            for (int k = 0; k < 3 * all[i].n; k++) {
                all[i].force[k] = all[i].force0[k] = played.mesh[i].force[k % 3] / all[i].total;
            }
        }
    }
    initialized = ongoing = 1;
    write_due = played.implicit;
}

/* Relaxes the forces towards the fluid's; 1: they agree. */
static int relax(void) {
    double sum[2] = {0, 0};
    for (int i = 0; i < FLUID_MESHES; i++) {
        double *force = calloc(3 * (size_t)all[i].n + 1, sizeof *force);
        need(force != NULL, "no memory");
        find_forces(i, force);
        const double part = played.implicit ? played.relaxation : 1;
        for (int k = 0; k < 3 * all[i].n; k++) {
            sum[0] += pow(force[k] - all[i].force[k], 2);
            sum[1] += pow(force[k], 2);
            all[i].force[k] += part * (force[k] - all[i].force[k]);
        }
        free(force);
    }
    MPI_Allreduce(MPI_IN_PLACE, sum, 2, MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
    return !played.implicit || sum[0] <= pow(played.tolerance, 2) * sum[1] || iteration >= played.most;
}

static void end_window(void) {
    for (int i = 0; i < FLUID_MESHES; i++) {
        vertices *v = &all[i];
        double sum[6] = {0};
        for (int k = 0; k < 3 * v->n; k++) {
            sum[k % 3] += v->d[k] / v->total;
            sum[3 + k % 3] += v->v[k] / v->total;
            v->v0[k] = (v->d[k] - v->d0[k]) / played.window;
            v->d0[k] = v->d[k];
            v->force0[k] = v->force[k];
        }
        MPI_Allreduce(MPI_IN_PLACE, sum, 6, MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
        memcpy(mean_d[i][windows], sum, sizeof mean_d[i][windows]);
        memcpy(mean_v[i][windows], sum + 3, sizeof mean_v[i][windows]);
    }
    iterations[windows++] = iteration;
    iteration = 0;
    complete = 1;
    ongoing = windows < played.windows;
    write_due = played.implicit && ongoing;
}

/* ---- steering ---- */

int precicec_isCouplingOngoing(void) {
    return ongoing;
}
int precicec_isTimeWindowComplete(void) {
    return complete;
}
double precicec_getMaxTimeStepSize(void) {
    return played.window - elapsed;
}
int precicec_requiresWritingCheckpoint(void) {
    const int due = write_due;
    write_due = 0;
    return due;
}
int precicec_requiresReadingCheckpoint(void) {
    const int due = read_due;
    read_due = 0;
    return due;
}
void precicec_advance(double dt) {
    need(initialized && ongoing, "advance after the end");
    need(!write_due && !read_due, "a checkpoint was not asked for");
    need(dt > 0 && dt <= (played.window - elapsed) * (1 + 1e-12), "a step beyond the window");
    complete = 0;
    elapsed += dt;
    if (elapsed < played.window * (1 - 1e-12)) {
        return;
    }
    elapsed = 0;
    iteration++;
    if (relax()) {
        end_window();
    } else {
        read_due = 1;
    }
}
void precicec_finalize(void) {
    need(initialized && !read_due, "finalize before initialize, or in a window");
}

/* ---- data ---- */

void precicec_writeData(const char *mesh, const char *data, int n, const int *id, const double *values) {
    vertices *v = &all[find(mesh)];
    double *to = strcmp(data, "Displacement") == 0 ? v->d : v->v;
    need(n <= v->n && (to == v->d || strcmp(data, "Velocity") == 0), "data that is not written");
    for (int i = 0; i < n; i++) {
        need(id[i] >= 7 && id[i] % 2 == 1 && (id[i] - 7) / 2 < v->n, "a vertex that is not there");
        memcpy(to + 3 * ((id[i] - 7) / 2), values + played.dimensions * i, (size_t)played.dimensions * sizeof *values);
    }
}
/* Between the forces at both ends of the window; in an explicit scheme there are those of its beginning alone. */
void precicec_readData(const char *mesh, const char *data, int n, const int *id, double relative_time, double *values) {
    const int i = find(mesh), dim = played.dimensions, moment = strcmp(data, "Moment") == 0;
    const vertices *v = &all[i];
    need(moment || strcmp(data, "Force") == 0, "data that is not read");
    need(relative_time >= 0 && elapsed + relative_time <= played.window * (1 + 1e-12), "a time beyond the window");
    const double part = played.implicit ? (elapsed + relative_time) / played.window : 1;
    for (int k = 0; k < n * dim; k++) {
        const int at = 3 * ((id[k / dim] - 7) / 2) + k % dim;
        values[k] =
            moment ? played.mesh[i].moment[k % dim] / v->total : v->force0[at] + part * (v->force[at] - v->force0[at]);
    }
}
