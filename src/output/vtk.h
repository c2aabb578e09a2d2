/* Writer of VTK files: points with fields, as XML for ParaView. Independent of member and fluid. */
#ifndef SPARI_VTK_H
#define SPARI_VTK_H

#include "../base/message.h"

typedef struct spari_vtk_field {
    const char *name;
    int components;
    const double *value; /* [points][components]; for a fact: [components] */
} spari_vtk_field;

typedef struct spari_vtk_picture {
    double time;
    int64_t points;
    const double *x;     /* [points][3] */
    int64_t verts;       /* points drawn as points */
    const int64_t *vert; /* their numbers; NULL: the first `verts` */
    int64_t lines;
    const int64_t *line_end; /* line k joins the points line_end[k - 1] (0 for the first) .. line_end[k] - 1 in order */
    const int64_t *line_point; /* point numbers in this order; NULL: 0, 1, 2, ... */
    int fields, facts;
    const spari_vtk_field *field; /* one value per point */
    const spari_vtk_field *fact;  /* one value for the whole file */
} spari_vtk_picture;

/* Writes the file under a temporary name and renames it, so that readers never see an incomplete file. A path ending
   in .vtu gives an unstructured grid, any other poly data (.vtp). Numbers are stored exactly (base64). After
   SPAR_ERR_IO the file at `path` is unchanged; the message, with the system's reason, goes to `session` (NULL: the
   thread's message). */
int spari_vtk_write(spar_session *session, const char *call, const char *path, const spari_vtk_picture *picture);

#endif
