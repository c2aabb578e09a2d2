/* spar_output.h: pictures of the state. */
#ifndef SPAR_OUTPUT_H
#define SPAR_OUTPUT_H

#include <spar/spar.h>

#ifdef __cplusplus
extern "C" {
#endif

SPAR_API int spar_member_write_vtk(const spar_member *member, const char *path);
SPAR_API int spar_fluid_write_vtk(const spar_fluid *fluid, const char *path);

#ifdef __cplusplus
}
#endif

#endif
