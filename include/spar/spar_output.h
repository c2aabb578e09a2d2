/* spar_output.h: writes the state as VTK XML files, for ParaView and other readers.

   All calls are local. Write a member on one rank, because every rank knows it. Write a fluid on each rank that has
   nodes of it.

   - The extension chooses the format: .vtu gives an unstructured grid, which meshio reads too. Any other path gives
     poly data; use .vtp, by which ParaView finds its reader.
   - Numbers are stored exactly. Each file contains the time of the session.
   - A file is written as path.part and then renamed. Readers never meet half a file, and a failure leaves the old file.
     The same holds for the index of a series.
   - If the path is a symbolic link, its target is written and the link stays. A file with several hard links is
     replaced under this name only. Mode and owner stay as far as the system allows.
   - A path that exists and is no file (a pipe, a device, a folder) is refused and stays.
   - SPAR_ERR_IO: the file cannot be written; the message gives the reason. */
#ifndef SPAR_OUTPUT_H
#define SPAR_OUTPUT_H

#include <spar/spar.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Writes the present state of a committed member: its nodes as points, and the line through them in finer pieces.
     path: in
   Fields of every point, in global axes:
   - displacement;
   - deflection: displacement from the position that a rigid motion of the root would give, which leaves out the
     rotation of a rotor;
   - rotation: rotation vector from the reference, of less than half a revolution;
   - section_x, section_y, section_z: axes of the section;
   - velocity, angular_velocity, acceleration, angular_acceleration;
   - node: number of the node, -1 between nodes;
   - nodal_force, nodal_moment: lumped loads in use at the nodes, 0 between nodes.
   A beam that spar solves also has section_force and section_moment in section axes (spar_beam_evaluate). The file as a
   whole has reaction_force and reaction_moment. Local. */
SPAR_API int spar_member_write_vtk(const spar_member *member, const char *path);
/* Writes the present nodes of a mapped fluid on this rank. A line connects each node with its nearest point on the
   member, so a wrong map is visible at once. Stations are also connected by a line in their order.
     path: in
   Fields of every point:
   - velocity, and section_x, section_y, section_z: the rotated axes of the line at the nearest point;
   - eta, distance, flags (SPAR_MAP_*) of the map;
   - set: 0 for the nodes, or for the motion nodes if the force nodes are another set; 1 for the force nodes;
   - force: as pushed last, 0 at motion nodes. Stations have it; nodes have it with SPAR_EFFECT_FLUID_HISTORY.
   Two sets follow each other: motion nodes, then force nodes. After all nodes come their nearest points in the same
   order, with the values of the node and 2 more in set. Local. */
SPAR_API int spar_fluid_write_vtk(const spar_fluid *fluid, const char *path);
/* Adds a file to an index of files in time (.pvd), which ParaView opens as an animation. Creates the index if there is
   none. The index is complete after every call. The message of a refusal is spar_session_message(NULL).
     path: in, the index
     time: in, s
     part: in, 0, 1, ... if several files show one time
     file: in, relative to the index
   Local. */
SPAR_API int spar_vtk_series_add(const char *path, double time, int part, const char *file);

#ifdef __cplusplus
}
#endif

#endif
