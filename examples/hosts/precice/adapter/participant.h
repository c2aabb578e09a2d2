/* A structure of spar as a participant of a coupled run with preCICE 3: the case file (../common/case.h) describes the
   structure, its section [host precice] the coupling. Per window or step: forces in, displacements out. preCICE owns
   the iteration and its acceleration; spar solves the structure with the forces as they are read.

   [host precice]
     participant NAME           as preCICE's configuration has it; default Solid
     config FILE                preCICE's configuration; default precice-config.xml
     members MEMBER ...         that take part
     meshes MESH ...            one for each member, for forces and motion; or
       force_meshes MESH ...    apart, as a fluid's face centres and
       motion_meshes MESH ...   its nodes
     access own|direct          own (default): the meshes are this program's; direct: they are the fluid's
       points FILE ...          own: one for each member, rows x y z
       box h w n k              own, of beams: a rectangle around the line, h along the section's y, w along its z; n
                                stations, k points on each of four sides; w 0: two sides, for two dimensions
       reach r                  direct: vertices up to r, m, beyond the box around a member's nodes belong to it
     force NAME                 data that are read, N; default Force
     moment NAME                data that are read, N m; default none
     displacement NAME          data that are written, m; default Displacement
     velocity NAME              data that are written, m/s; default none
     level z                    where two-dimensional meshes lie, m; default 0
     dt s                       steps within a window; default: one step, with the substeps of [session] */
#ifndef PARTICIPANT_H
#define PARTICIPANT_H

#include <mpi.h>
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Runs a case from beginning to end. Collective over comm; what fails on one rank is told here and ends all of them.
     message[size]: out, "" or what was wrong
   Answers a spar status. After a failure the caller ends the program on all ranks: preCICE's partner waits. */
int participant_run(const char *path, MPI_Comm comm, char *message, size_t size);

#ifdef __cplusplus
}
#endif

#endif
