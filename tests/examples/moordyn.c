/* Stands in for the library of MoorDyn in tests/examples/moorings: massless taut lines between the points of the input
   file. Its only state is its clock: a step that does not begin where the last one ended, without a state brought back,
   fails, and so does one of another length of the state. */
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void *MoorDyn_Create(const char *input);
int MoorDyn_SetVerbosity(void *system, int level);
int MoorDyn_NCoupledDOF(void *system, unsigned int *n);
int MoorDyn_Init(void *system, const double *x, const double *v);
int MoorDyn_Step(void *system, const double *x, const double *v, double *force, double *t, double *dt);
int MoorDyn_Serialize(void *system, size_t *bytes, uint64_t *data);
int MoorDyn_Deserialize(void *system, const uint64_t *data);
int MoorDyn_Close(void *system);

enum { MOST = 16 };

typedef struct line {
    int a, b; /* points, from 0 */
    double length;
} line;

typedef struct lines {
    int points, coupled, n;
    double stiffness, x[MOST][3], clock;
    line line[MOST];
} lines;

void *MoorDyn_Create(const char *input) {
    FILE *file = fopen(input, "r");
    lines *s = calloc(1, sizeof *s);
    char row[256], word[32];
    int id, a, b;
    double x[3], mass, diameter;
    while (s && file && fgets(row, sizeof row, file)) {
        if (sscanf(row, "taut %lg %lg %lg", &diameter, &mass, &s->stiffness) == 3) {
            continue;
        }
        if (s->points < MOST && sscanf(row, "%d %31s %lg %lg %lg", &id, word, x, x + 1, x + 2) == 5) {
            s->coupled += strcmp(word, "Coupled") == 0;
            memcpy(s->x[s->points++], x, sizeof x);
        }
        if (s->n < MOST && sscanf(row, "%d taut %d %d %lg", &id, &a, &b, &s->line[s->n].length) == 4) {
            s->points--; /* it looked like a point */
            s->line[s->n].a = a - 1;
            s->line[s->n++].b = b - 1;
        }
    }
    if (file) {
        (void)fclose(file);
    }
    return s;
}

int MoorDyn_SetVerbosity(void *system, int level) {
    (void)system, (void)level;
    return 0;
}

int MoorDyn_NCoupledDOF(void *system, unsigned int *n) {
    *n = 3U * (unsigned int)((lines *)system)->coupled;
    return 0;
}

int MoorDyn_Init(void *system, const double *x, const double *v) {
    (void)v;
    memcpy(((lines *)system)->x, x, 3 * sizeof *x * (size_t)((lines *)system)->coupled);
    return 0;
}

int MoorDyn_Step(void *system, const double *x, const double *v, double *force, double *t, double *dt) {
    lines *s = system;
    (void)v;
    if (fabs(*t - s->clock) > 1e-9) {
        (void)fprintf(stderr, "stand-in for MoorDyn: a step from %g s, and its lines are at %g s\n", *t, s->clock);
        return -1;
    }
    s->clock = *t + *dt;
    memcpy(s->x, x, 3 * sizeof *x * (size_t)s->coupled);
    memset(force, 0, 3 * sizeof *force * (size_t)s->coupled);
    for (int k = 0; k < s->n; k++) {
        const double *a = s->x[s->line[k].a], *b = s->x[s->line[k].b];
        double d[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]}, size = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
        double pull = s->stiffness / s->line[k].length * fmax(size - s->line[k].length, 0);
        for (int i = 0; i < 3; i++) { /* on the coupled end, b */
            force[3 * s->line[k].b + i] += pull * d[i] / size;
        }
    }
    return 0;
}

int MoorDyn_Serialize(void *system, size_t *bytes, uint64_t *data) {
    if (bytes) {
        *bytes = sizeof(uint64_t);
    }
    if (data) {
        memcpy(data, &((lines *)system)->clock, sizeof *data);
    }
    return 0;
}

int MoorDyn_Deserialize(void *system, const uint64_t *data) {
    memcpy(&((lines *)system)->clock, data, sizeof *data);
    return 0;
}

int MoorDyn_Close(void *system) {
    free(system);
    return 0;
}
