/* spar_output.h: pictures of the state for ParaView and other readers of VTK's XML files.

   Files, the index of a series too, are written under a temporary name (path.part) and renamed, so a reader never meets
   half a file, and a failure leaves what stood at the path. Where the path is a symbolic link, all this happens where
   it leads, and the link stays; a file with several hard links is replaced under this name only; mode and owner stay as
   far as the system allows. What is no file (a pipe, a device, a folder) is refused and stays. Numbers are stored
   exactly. A path that ends in .vtu gives an unstructured grid, which meshio reads too, any other poly data; end it in
   .vtp, by which ParaView finds its reader. The time of the session goes with each file. All calls are local: write a
   member on one rank, where it is known on all; write a fluid on the rank that has it. A file that cannot be written is
   SPAR_ERR_IO, and the message says why. */
#ifndef SPAR_OUTPUT_H
#define SPAR_OUTPUT_H

#include <spar/spar.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A committed member where it is now: its nodes as points, its line through them drawn in finer pieces. At every
   point displacement; deflection, the way from where the root, moving as one rigid body, would have carried the place
   (a rotor's blades without the rotor's turn; in global axes); rotation (vector, from the reference, below half a
   turn), section_x, _y, _z (axes of the section), velocity, angular_velocity, acceleration, angular_acceleration; node
   (its number, -1 between nodes); at the nodes nodal_force and nodal_moment (lumped loads in use; 0 between nodes). Of
   a beam that spar solves for section_force and section_moment (spar_beam_evaluate, in section axes). For the whole:
   reaction_force, _moment. */
SPAR_API int spar_member_write_vtk(const spar_member *member, const char *path);
/* This rank's nodes of a mapped fluid where they are now, each joined to its foot on the line by a connector, so that a
   wrong map is seen at once. At every node velocity, section_x, _y, _z (the turned axes of the line at the foot), eta,
   distance and flags (SPAR_MAP_*) of the map. Sections are also joined by a line in the order given, and have force, as
   pushed last. Where one set does not serve both, the motion nodes come first, then the force nodes: set is 0 and 1,
   and force (0 at motion nodes) is there if node forces are kept (SPAR_EFFECT_FLUID_HISTORY). After the nodes come
   their feet in the same order, with the node's values and 2 more in set. */
SPAR_API int spar_fluid_write_vtk(const spar_fluid *fluid, const char *path);
/* Adds a file to an index of files in time (.pvd), which is made when it is not there; open that in ParaView. part:
   0, 1, ... where several files show one time. file is relative to the index. The index is whole after every call.
   The message of a refusal is spar_session_message(NULL). */
SPAR_API int spar_vtk_series_add(const char *path, double time, int part, const char *file);

#ifdef __cplusplus
}
#endif

#endif
