/* Mooring lines of MoorDyn (version 2) on a body of spar: the library is opened at run time, and its lines pull at
   points of one fluid's nodes. MoorDyn keeps states (its lines' nodes), which go back to t^n when a step is iterated.
 */
#ifndef EXAMPLE_MOORDYN_H
#define EXAMPLE_MOORDYN_H

#include <spar/spar_coupling.h>
#include <spar/spar_structure.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct moordyn moordyn;

/* Opens the library, reads MoorDyn's input file, and couples its n coupled points to the fluid's nodes, which it sets
   and maps; the lines start in their equilibrium.
     library, input: in, paths
     fluid: in, without nodes, on the body that the lines hold
     n: in, coupled points
     x[n][3]: in, their reference positions, in the order of the file, m
   Returns a spar status; the message is moordyn_message. */
int moordyn_open(const char *library, const char *input, spar_fluid *fluid, int n, const double *x, moordyn **lines);
/* The lines' forces at the fluid's latest motion, as a spar_fluid_solver; context: a moordyn. With dt = 0, in a static
   solution, the lines come to rest where the body is. */
int moordyn_pull(spar_session *session, double t, double dt, int iteration, void *context);
const char *moordyn_message(void);
/* NULL and a second call are legal. */
void moordyn_close(moordyn **lines);

#ifdef __cplusplus
}
#endif

#endif
