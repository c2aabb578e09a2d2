/* A stand-in for preCICE 3 and a fluid behind it, for tests: the calls of adapter/precice_calls.h, in one process a
   rank. It keeps preCICE's rules (what must be called before what, how long a step may be) and ends the program where
   they are broken. The fluid on a mesh: springs, dampers and added mass of its vertices, evenly shared, and a dead
   force; loads at the end of a window follow from the displacements there. */
#ifndef FLUID_H
#define FLUID_H

#ifdef __cplusplus
extern "C" {
#endif

enum { FLUID_MESHES = 4, FLUID_WINDOWS = 4000 };

typedef struct fluid_mesh {
    const char *name; /* NULL: none */
    int own;          /* 1: the participant sets its vertices; 0: it gets those below */
    int n;            /* [n][3] below; own 0 */
    const double *vertices;
    double spring, damper, mass; /* N/m, N s/m, kg, of all vertices along each direction */
    double force[3], moment[3];  /* N, N m, in all */
} fluid_mesh;

typedef struct fluid {
    int implicit, dimensions;
    double window, relaxation, tolerance;
    int windows, most; /* iterations of a window */
    fluid_mesh mesh[FLUID_MESHES];
} fluid;

/* What is played from the next precicec_createParticipant on. */
void fluid_play(const fluid *what);
/* After it: mean displacement and velocity of a mesh's vertices over all ranks at the end of each window, how many
   iterations it took, and the most that a written velocity differed from the change of the displacement over the
   window. */
const double *fluid_displacement(int mesh, int window);
const double *fluid_velocity(int mesh, int window);
int fluid_windows(void);
int fluid_iterations(int window);
/* Displacement of vertex i of this rank in the last window. */
const double *fluid_vertex(int mesh, int i);
int fluid_vertices(int mesh);

#ifdef __cplusplus
}
#endif

#endif
