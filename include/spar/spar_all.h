/* spar_all.h: all headers but spar_mpi.h, which needs <mpi.h>. */
#ifndef SPAR_ALL_H
#define SPAR_ALL_H

#include <spar/spar.h>
#include <spar/spar_aero.h>
#include <spar/spar_analysis.h>
#include <spar/spar_coupling.h>
#include <spar/spar_output.h>
#include <spar/spar_structure.h>

#endif
