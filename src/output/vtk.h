/* The one writer of VTK files: points with fields, as XML that ParaView opens. Knows no member and no fluid. */
#ifndef SPARI_VTK_H
#define SPARI_VTK_H

#include "../base/message.h"

typedef struct spari_vtk_field {
    const char *name;
    int components;
    const double *value; /* [points][components]; of a fact: [components] */
} spari_vtk_field;

typedef struct spari_vtk_picture {
    double time;
    int64_t points;
    const double *x;     /* [points][3] */
    int64_t verts;       /* points drawn as points */
    const int64_t *vert; /* their numbers; NULL: the first `verts` */
    int64_t lines;
    const int64_t *line_end; /* line k joins the points line_end[k - 1] (0 for the first) .. line_end[k] - 1 in order */
    const int64_t *line_point; /* the points' numbers in that order; NULL: 0, 1, 2, ... */
    int fields, facts;
    const spari_vtk_field *field; /* one value per point */
    const spari_vtk_field *fact;  /* one value for the whole picture */
} spari_vtk_picture;

/* Writes the picture under a temporary name beside `path` and renames it, so that a reader never meets half a file. A
   path that ends in .vtu becomes an unstructured grid, any other poly data (.vtp). Numbers are stored exactly (base64).
   SPAR_ERR_IO with the system's reason, told to `session` (NULL: this thread's message), leaves what stood at `path`.
 */
int spari_vtk_write(spar_session *session, const char *call, const char *path, const spari_vtk_picture *picture);

#endif
