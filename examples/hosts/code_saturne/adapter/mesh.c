/* The mesh that moves: its worst corner, and a picture of it (mesh.RANK.txt, polygons) where the structure is farthest
   out. Of the faces in `sliding`, which show the cells of a slab. */
#include "cs_base.h"
#include "cs_headers.h"
#include "spar_saturne.h"
#include <math.h>
#include <stdio.h>

static struct {
    cs_lnum_t n, *faces;
    double least, farthest;
} seen = {.least = 1};

void saturne_mesh_begin(void) {
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

void saturne_mesh_step(double out) {
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

double saturne_mesh_end(void) {
    double least = seen.least;
    cs_parall_min(1, CS_DOUBLE, &least);
    BFT_FREE(seen.faces);
    return least;
}
