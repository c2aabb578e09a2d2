/* The mesh that moves: its worst corner, and a picture of it (mesh.RANK.txt, polygons) where the structure is farthest
   out. Of the faces in `sliding`, which show the cells of a slab. */
#include "cs_base.h"
#include "cs_headers.h"
#include "spar_saturne.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

static struct {
    cs_lnum_t n, *faces;
    double least, farthest;
    double *volume, least_part; /* of the cells at the start of the run; the least that one has kept of it */
    int warned;
} seen = {.least = 1, .least_part = 1};

void saturne_mesh_begin(void) {
    const cs_lnum_t cells = cs_glob_mesh->n_cells;
    BFT_MALLOC(seen.volume, cells, double);
    memcpy(seen.volume, cs_glob_mesh_quantities->cell_vol, (size_t)cells * sizeof *seen.volume);
    seen.n = saturne_faces("sliding", saturne_text("sliding", ""), &seen.faces);
}

static const double *corner(cs_lnum_t face, cs_lnum_t i) {
    const cs_mesh_t *mesh = cs_glob_mesh;
    const cs_lnum_t first = mesh->b_face_vtx_idx[face], n = mesh->b_face_vtx_idx[face + 1] - first;
    return mesh->vtx_coord + 3 * mesh->b_face_vtx_lst[first + (i + n) % n];
}

/* Sine of the angle at a corner, with the face's own sense: below 0 where it is folded. */
static double sine(cs_lnum_t face, cs_lnum_t i) {
    const double *a = corner(face, i - 1), *b = corner(face, i), *c = corner(face, i + 1);
    const double *normal = cs_glob_mesh_quantities->b_face_normal + 3 * face;
    const double u[3] = {c[0] - b[0], c[1] - b[1], c[2] - b[2]}, v[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
    const double w[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
    const double along = w[0] * normal[0] + w[1] * normal[1] + w[2] * normal[2];
    return along / (cs_math_3_norm(u) * cs_math_3_norm(v) * cs_math_3_norm(normal));
}

static void draw(void) {
    char name[32];
    snprintf(name, sizeof name, "mesh.%d.txt", CS_MAX(cs_glob_rank_id, 0));
    FILE *f = fopen(name, "w");
    if (f == NULL) {
        return; /* no picture then */
    }
    for (cs_lnum_t i = 0; i < seen.n; i++) {
        const cs_lnum_t face = seen.faces[i],
                        n = cs_glob_mesh->b_face_vtx_idx[face + 1] - cs_glob_mesh->b_face_vtx_idx[face];
        for (cs_lnum_t k = 0; cs_glob_mesh_quantities->b_face_normal[3 * face + 2] > 0 && k <= n; k++) {
            fprintf(f, "%.6g %.6g\n%s", corner(face, k)[0], corner(face, k)[1], k == n ? "\n" : "");
        }
    }
    fclose(f);
}

/* Least part of its volume that a cell has kept, and where it is. Collective. */
static double least_part(double where[3]) {
    const cs_mesh_quantities_t *q = cs_glob_mesh_quantities;
    double most = -1e300; /* of the negative: there is only the one for the largest */
    where[0] = where[1] = where[2] = 0;
    for (cs_lnum_t cell = 0; cell < cs_glob_mesh->n_cells; cell++) {
        const double part = -q->cell_vol[cell] / seen.volume[cell];
        if (part > most) {
            most = part;
            memcpy(where, q->cell_cen + 3 * cell, 3 * sizeof *where);
        }
    }
    cs_parall_max_loc_vals(3, &most, where);
    return -most;
}

static void watch_volumes(void) {
    double where[3];
    const double part = least_part(where);
    seen.least_part = CS_MIN(seen.least_part, part);
    if (part < 0.2 && !seen.warned) {
        char text[160];
        snprintf(text, sizeof text, "the cell at (%.4g %.4g %.4g) has %.3g of its volume at the start of the run",
                 where[0], where[1], where[2], part);
        saturne_tell(SPAR_LOG_WARNING, text);
        seen.warned = 1;
    }
}

void saturne_mesh_fold(void) {
    double where[3];
    char why[200];
    const double part = least_part(where);
    BFT_FREE(seen.volume);
    if (part <= 0) {
        snprintf(why, sizeof why,
                 "the mesh has folded at step %d: the cell at (%.4g %.4g %.4g) has %.3g of its volume at the start",
                 cs_glob_time_step->nt_cur, where[0], where[1], where[2], part);
        saturne_flow_broke(why);
    }
}

void saturne_mesh_step(double out) {
    watch_volumes();
    for (cs_lnum_t i = 0; i < seen.n; i++) {
        const cs_lnum_t face = seen.faces[i],
                        n = cs_glob_mesh->b_face_vtx_idx[face + 1] - cs_glob_mesh->b_face_vtx_idx[face];
        for (cs_lnum_t k = 0; k < n; k++) {
            seen.least = CS_MIN(seen.least, sine(face, k));
        }
    }
    if (out > 1.05 * seen.farthest) {
        seen.farthest = out;
        draw();
    }
}

double saturne_mesh_end(double *volume) {
    double least = seen.least;
    *volume = seen.least_part;
    cs_parall_min(1, CS_DOUBLE, &least);
    BFT_FREE(seen.faces);
    return least;
}
