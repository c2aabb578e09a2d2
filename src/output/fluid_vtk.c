/* A picture of a fluid's nodes on this rank. */
#include "../fluid/fluid.h"
#include "../math/rotation.h"
#include "vtk.h"
#include <spar/spar_output.h>
#include <stdlib.h>
#include <string.h>

/* Columns of the table of nodes, each field [n][components] at table + column * n. */
enum { X, V = 3, AXES = 6, FORCE = 15, SET = 18, QUATERNION = 19, COLUMNS = 23 };

/* Fills the columns of one set's nodes, which stand at `first` of all n. */
static int fill_set(const spar_fluid *fluid, int which, int64_t first, int64_t count, int64_t n, double *table) {
    static const double unit[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    double *q = table + QUATERNION * n + 4 * first;
    SPARI_TRY(spari_fluid_look(fluid, which, table + X * n + 3 * first, table + V * n + 3 * first, q));
    for (int64_t i = 0; i < count; i++) {
        for (int k = 0; k < 3; k++) {
            spari_rotate(q + 4 * i, unit[k], table + (AXES + 3 * k) * n + 3 * (first + i));
        }
        table[SET * n + first + i] = which;
    }
    const double *force = spari_fluid_forces(fluid);
    if (force && (which == SPAR_NODES_FORCE || spari_fluid_has_sections(fluid))) {
        memcpy(table + FORCE * n + 3 * first, force, (size_t)(3 * count) * sizeof *force);
    }
    return SPAR_OK;
}

static int write_picture(const spar_fluid *fluid, int64_t n, const double *table, const char *path) {
    spari_vtk_field field[] = {{"velocity", 3, table + V * n},
                               {"section_x", 3, table + AXES * n},
                               {"section_y", 3, table + (AXES + 3) * n},
                               {"section_z", 3, table + (AXES + 6) * n},
                               {"set", 1, table + SET * n},
                               {"force", 3, table + FORCE * n}};
    spari_vtk_picture picture = {.points = n,
                                 .x = table + X * n,
                                 .verts = n,
                                 .lines = spari_fluid_has_sections(fluid) && n > 1,
                                 .line_end = &n,
                                 .fields = spari_fluid_forces(fluid) ? 6 : 5,
                                 .field = field};
    spar_session *session = spari_fluid_session(fluid);
    SPARI_TRY(spar_session_get_time(session, &picture.time, NULL, NULL));
    return spari_vtk_write(session, "spar_fluid_write_vtk", path, &picture);
}

int spar_fluid_write_vtk(const spar_fluid *fluid, const char *path) {
    SPARI_REQUIRE(NULL, fluid, SPAR_ERR_ARGUMENT, "spar_fluid_write_vtk: the fluid is NULL; create it first");
    int64_t count[2] = {0, 0};
    SPARI_TRY(spar_fluid_get_count(fluid, SPAR_NODES_MOTION, &count[0]));
    if (!spari_fluid_has_sections(fluid)) {
        SPARI_TRY(spar_fluid_get_count(fluid, SPAR_NODES_FORCE, &count[1]));
    }
    int64_t n = count[0] + count[1];
    double *table = spari_zalloc(COLUMNS * n, sizeof *table);
    SPARI_REQUIRE(spari_fluid_session(fluid), table, SPAR_ERR_MEMORY,
                  "spar_fluid_write_vtk: no memory for the %lld nodes of '%s'", (long long)n, spari_fluid_name(fluid));
    int status = fill_set(fluid, SPAR_NODES_MOTION, 0, count[0], n, table);
    if (status == SPAR_OK && !spari_fluid_has_sections(fluid)) {
        status = fill_set(fluid, SPAR_NODES_FORCE, count[0], count[1], n, table);
    }
    if (status == SPAR_OK) {
        status = write_picture(fluid, n, table, path);
    }
    free(table);
    return status;
}
