/* How the turbine looks: tower, nacelle, spinner and lofted blades as surfaces, for ParaView and for gnuplot. */
#ifndef TURBINE_VIEW_H
#define TURBINE_VIEW_H

#include "turbine_model.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { TURBINE_PATCHES = 3 + TURBINE_BLADES }; /* tower, nacelle, spinner, blades */

/* A surface of rows times columns points. */
typedef struct turbine_patch {
    int rows, columns;
    double *x, *load; /* [rows][columns][3]; [rows][columns], air's force per length of a blade, N/m */
} turbine_patch;

typedef struct turbine_view {
    turbine_patch patch[TURBINE_PATCHES];
    double *place, *turn, *force, *motion; /* of blades' sections [3], [4], [6]; of the tower's nodes [7] */
} turbine_view;

int turbine_view_create(turbine_view *view, const turbine *turbine);
void turbine_view_free(turbine_view *view);
/* The machine as it stands now. */
int turbine_view_look(turbine_view *view, const turbine *turbine);
/* One poly data file. Returns 0, or 1 with a line on stderr. */
int turbine_view_write_vtk(const turbine_view *view, const char *path, double time);
/* surface.txt and surface.gp in a folder and, if wanted, turbine.png by gnuplot. Returns 0, or 1 with a line on stderr.
 */
int turbine_view_draw(const turbine_view *view, const char *folder, int picture);
/* v in the axes of the frame q: R(q)^T v */
void turbine_turn_back(const double q[4], const double v[3], double out[3]);

#ifdef __cplusplus
}
#endif

#endif
