/* The rotor seen through trial runs: what each effect is worth, and which settings keep a tolerance. */
#ifndef ROTOR_VIEW_H
#define ROTOR_VIEW_H

#include "rotor_options.h"
#include <spar/spar_aero.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The scene as it stands: a trial with steps and callbacks. */
typedef struct rotor_trial {
    spar_trial *trial;
    spar_aero *aero;
    spar_member *blade; /* one of them: they are described alike */
} rotor_trial;

/* Steps of dt for trials that last about so long: a multiple of 8. */
int64_t rotor_trial_steps(double seconds, double dt);
/* Prints what leaving out each effect changes and saves, the largest error first; as a table, or for a spreadsheet.
   show: 1 on the rank that prints. Collective; returns a spar status. */
int rotor_view_effects(const rotor_trial *trial, int csv, int show);
/* Asks for the cheapest settings that keep the tolerance, says them in words, and puts them into the options.
   Collective; returns a spar status. */
int rotor_view_advice(const rotor_trial *trial, rotor_options *options, int show);

#ifdef __cplusplus
}
#endif

#endif
