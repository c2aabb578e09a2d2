/* Writes a fluid's nodes on this rank as a VTK file: nodes, nearest points, and data of the map. */
#include "../base/environment.h"
#include "../base/status.h"
#include "../math/rotation.h"
#include "vtk.h"
#include <spar/spar_coupling.h>
#include <spar/spar_output.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Columns of the table of points, each field [points][components] at table + column * points. Nodes come first, then
   their nearest points in the same order. */
enum { X, V = 3, AXES = 6, FORCE = 15, SET = 18, ETA = 19, DISTANCE = 20, FLAGS = 21, COLUMNS = 22 };
static const struct {
    const char *name;
    int column, components;
} field_of[] = {{"velocity", V, 3},         {"section_x", AXES, 3}, {"section_y", AXES + 3, 3},
                {"section_z", AXES + 6, 3}, {"set", SET, 1},        {"eta", ETA, 1},
                {"distance", DISTANCE, 1},  {"flags", FLAGS, 1},    {"force", FORCE, 3}};
enum { FIELDS = sizeof field_of / sizeof field_of[0] };

typedef struct sketch {
    int64_t count[2], n; /* nodes of each set and in total; 0 for a second set that equals the first */
    int kind[2];         /* SPAR_KIND_* */
    double *table;       /* 2 n points */
    double *q;
    int *flags;
    int64_t *line_end, *line_point;
} sketch;

static double *at(const sketch *s, int column, int components, int64_t point) {
    return s->table + column * 2 * s->n + components * point;
}

/* Fills the nodes of one set, which begin at `first`. */
static int fill_set(const spar_fluid *fluid, int which, int64_t first, const sketch *s) {
    static const double unit[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    SPARI_TRY(spar_fluid_get_positions(fluid, which, at(s, X, 3, first), s->q + 4 * first, at(s, V, 3, first),
                                       at(s, X, 3, s->n + first)));
    SPARI_TRY(spar_fluid_get_map(fluid, which, at(s, ETA, 1, first), at(s, DISTANCE, 1, first), s->flags + first));
    if (s->kind[which] & SPAR_KIND_FORCES) {
        SPARI_TRY(spar_fluid_get_forces(fluid, at(s, FORCE, 3, first)));
    }
    for (int64_t i = first; i < first + s->count[which]; i++) {
        for (int k = 0; k < 3; k++) {
            spari_rotate(s->q + 4 * i, unit[k], at(s, AXES + 3 * k, 3, i));
        }
        *at(s, SET, 1, i) = which;
        *at(s, FLAGS, 1, i) = s->flags[i];
    }
    return SPAR_OK;
}

/* Nearest points get the data of their nodes, except position and set. */
static void copy_to_nearest_points(const sketch *s) {
    for (int f = 0; f < FIELDS; f++) {
        size_t size = (size_t)s->n * (size_t)field_of[f].components * sizeof(double);
        memcpy(at(s, field_of[f].column, field_of[f].components, s->n), at(s, field_of[f].column, 1, 0), size);
    }
    for (int64_t i = 0; i < s->n; i++) {
        *at(s, SET, 1, s->n + i) += 2;
    }
}

/* Connects sections in a row, then every node with its nearest point. Returns the number of lines. */
static int64_t draw_lines(const sketch *s) {
    int64_t lines = 0, end = 0, node = 0;
    for (int which = 0; which < 2; which++) {
        int row = (s->kind[which] & SPAR_KIND_STATIONS) && s->count[which] > 1;
        for (int64_t i = 0; i < s->count[which]; i++, node++) {
            if (row) {
                s->line_point[end++] = node;
            }
        }
        if (row) {
            s->line_end[lines++] = end;
        }
    }
    for (int64_t i = 0; i < s->n; i++) {
        s->line_point[end++] = i;
        s->line_point[end++] = s->n + i;
        s->line_end[lines++] = end;
    }
    return lines;
}

static int write_nodes(const sketch *s, spar_session *session, const char *path, const char *call) {
    spari_vtk_field field[FIELDS];
    for (int f = 0; f < FIELDS; f++) {
        field[f] = (spari_vtk_field){field_of[f].name, field_of[f].components, at(s, field_of[f].column, 1, 0)};
    }
    spari_vtk_picture picture = {.points = 2 * s->n,
                                 .x = at(s, X, 3, 0),
                                 .verts = s->n,
                                 .lines = draw_lines(s),
                                 .line_end = s->line_end,
                                 .line_point = s->line_point,
                                 .fields = (s->kind[0] | s->kind[1]) & SPAR_KIND_FORCES ? FIELDS : FIELDS - 1,
                                 .field = field};
    SPARI_TRY(spar_session_get_time(session, &picture.time, NULL, NULL));
    return spari_vtk_write(session, call, path, &picture);
}

/* Reports a failure of a nested call as that of this call. */
static int retell(spar_session *session, int status, const char *call) {
    char text[SPARI_MESSAGE_SIZE];
    if (status == SPAR_OK) {
        return SPAR_OK;
    }
    (void)snprintf(text, sizeof text, "%s", spar_session_message(session));
    return spari_fail(session, status, "%s: %s", call, text);
}

static int draw(const spar_fluid *fluid, const sketch *s, spar_session *session, const char *path, const char *call) {
    SPARI_TRY(retell(session, fill_set(fluid, SPAR_NODES_MOTION, 0, s), call));
    if (!(s->kind[0] & SPAR_KIND_SHARED)) {
        SPARI_TRY(retell(session, fill_set(fluid, SPAR_NODES_FORCE, s->count[0], s), call));
    }
    copy_to_nearest_points(s);
    return write_nodes(s, session, path, call);
}

int spar_fluid_write_vtk(const spar_fluid *fluid, const char *path) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_REQUIRE(NULL, fluid, SPAR_ERR_ARGUMENT, "%s: the fluid is NULL; create it first", __func__);
    sketch s = {0};
    spar_member *member;
    spar_session *session;
    SPARI_TRY(spar_fluid_get_member(fluid, &member));
    SPARI_TRY(spar_member_get_session(member, &session));
    for (int which = 0; which < 2 && !(s.kind[0] & SPAR_KIND_SHARED); which++) {
        SPARI_TRY(spar_fluid_get_count(fluid, which, &s.count[which]));
        SPARI_TRY(spar_fluid_get_kind(fluid, which, &s.kind[which]));
    }
    s.n = s.count[0] + s.count[1];
    s.table = spari_zalloc(2 * COLUMNS * s.n, sizeof *s.table);
    s.q = spari_zalloc(4 * s.n, sizeof *s.q);
    s.flags = spari_zalloc(s.n, sizeof *s.flags);
    s.line_end = spari_zalloc(s.n + 2, sizeof *s.line_end);
    s.line_point = spari_zalloc(3 * s.n, sizeof *s.line_point);
    int whole = s.table && s.q && s.flags && s.line_end && s.line_point;
    int status = whole ? draw(fluid, &s, session, path, __func__)
                       : spari_fail(session, SPAR_ERR_MEMORY, "%s: no memory for the %lld nodes of '%s'", __func__,
                                    (long long)s.n, spar_fluid_get_name(fluid));
    SPARI_FREE(s.table, s.q, s.flags, s.line_end, s.line_point);
    return status;
}
