/* Input files of AeroDyn and InflowWind (OpenFAST 4.2 to 5.0) of the turbine of examples/nrel5mw.h: blade element
   momentum theory with the losses of tip and hub, quasi-steady airfoils, no drag in the inductions, no dynamic wake, no
   skew model, no tower; a steady uniform wind. */
#ifndef DECK_H
#define DECK_H

#include "nrel5mw.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Writes folder/AeroDyn.dat, blade.dat, a file for each polar, and InflowWind.dat; the folder is made where there is
   none. wind: m/s. Returns a spar status; data->message says what went wrong. */
int deck_write(nrel5mw *data, const char *folder, double wind);

#ifdef __cplusplus
}
#endif

#endif
