/* spar_saturne.h: code_saturne 6.0 as a host of spar. What a case gives, and what the parts of the adapter share. */
#ifndef SPAR_SATURNE_H
#define SPAR_SATURNE_H

#include "cs_defs.h"
#include <spar/spar.h>

/* Given by each case, alike on every rank. */
typedef struct saturne_case {
    const char *wetted; /* code_saturne's criterion of the faces that the structure moves */
    const char *loaded; /* of the faces whose force the history has: those and rigid ones beside them */
    double span;        /* m, of the slab of fluid; the history's forces are per metre of it */
    /* Makes and commits the members. wet: out, the one that the wetted faces hang on; its last node is watched. */
    int (*describe)(spar_session *session, spar_member **wet);
} saturne_case;
extern const saturne_case saturne_this_case;

/* code_saturne's Fortran user routines that cases write in C. */
void CS_PROCF(usalcl, USALCL)(const int *itrale, const int *nvar, const int *nscal, int *icodcl, int *itypfb,
                              int *ialtyb, int *impale, const cs_real_t *dt, cs_real_t *rcodcl, const cs_real_t *xyzno0,
                              cs_real_t *disale);
void CS_PROCF(usaste, USASTE)(int *idfstr);
void CS_PROCF(cs_f_user_boundary_conditions, CS_F_USER_BOUNDARY_CONDITIONS)(void);

/* A number or a text that the run script has set in the environment, or else what is given. */
double saturne_number(const char *name, double otherwise);
const char *saturne_text(const char *name, const char *otherwise);

/* A status that is not SPAR_OK ends the run on all ranks, with the session's message. */
void saturne_check(int status, const spar_session *session);
/* Coupling scheme, tolerances and integrator, from the environment. */
void saturne_settings(spar_session *session);

/* Forces of the fluid on boundary faces, from the pressure and velocity as they are now: what astfor_ is given has the
   pressure of the iteration before. Collective. n: faces; faces[n]; force[n][3]: out, N. */
void saturne_wall_forces(cs_lnum_t n, const cs_lnum_t *faces, double *force);

/* Processor time that goes to spar: between begin and end, of this rank. */
void saturne_clock_begin(void);
void saturne_clock_end(void);
/* A line of history.csv, after a step was accepted. Collective. */
void saturne_report_step(spar_session *session, spar_member *wet, spar_fluid *surface);
/* summary.txt, at the end of the run. Collective. */
void saturne_report_run(void);

#endif
