/* spar_saturne.h: code_saturne as a host of spar. What the parts of the adapter share, and what a case's flow may
   ask the case file for.

   Keys of [host code_saturne]; criteria are code_saturne's, which knows gmsh's numbers of faces and no names:
     flow NAME            folder of flow.c, mesh and comparison, for the run script
     dt S, steps N        the run's; precision R: that of its linear solvers [1e-8]
     later T S            from the time T on steps of S seconds, of a mesh that moves; steps N counts all
     member NAME ...      members in the flow, and wetted CRITERION ..., the faces that each of them moves: as many; a
                          member that stands twice has both groups. The last node of each is in the history.
     loaded CRITERION     faces whose force the history has, per metre of span S; default: the first member's, 1 m
     fixed CRITERION      faces whose vertices stand still; sliding CRITERION: faces that vertices stay in
     fade WITHIN BEYOND   spar moves all vertices: as the structure up to WITHIN metres from its line, not at all from
                          BEYOND metres on. Without it code_saturne's own equation moves what is not wetted. Between
                          two members the vertices follow the nearer one more.
   A criterion that selects no face, or names a group that the mesh does not have, ends the run.

   Restart: the structure's file is checkpoint/spar, written with each of code_saturne's checkpoints, and restart/spar
   is read when code_saturne goes on from its own. */
#ifndef SPAR_SATURNE_H
#define SPAR_SATURNE_H

#include "case.h"
#include "cs_defs.h"
#include "cs_domain.h"
#include "versions.h"
#include <stdio.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The session, with what the case file structure.case in the folder of the run describes: made at the first call, by
   all ranks together. */
spar_session *saturne_session(void);
spar_case *saturne_scene(void);
/* A key of the case file; without `otherwise` (NULL) it has to be there. */
double saturne_number(const char *key, const double *otherwise);
const char *saturne_text(const char *key, const char *otherwise);
/* When all keys have been asked for: one that was not was misspelt. */
void saturne_check_keys(void);
/* Frees session and scene. Collective. */
void saturne_end(void);

/* A status that is not SPAR_OK ends the run on all ranks, with the session's or the case's message. */
void saturne_check(int status);
void saturne_check_case(int status);

/* A message in run_solver.log, on rank 0. level: SPAR_LOG_*. */
void saturne_tell(int level, const char *text);

/* Boundary faces that meet a criterion, numbered from 0; to be freed by BFT_FREE. Collective: a criterion that selects
   none ends the run; "" is legal and has none. what: the key, for the message. */
cs_lnum_t saturne_faces(const char *what, const char *criterion, cs_lnum_t **faces);
/* types[face] = type for these. */
void saturne_mark(const char *what, const char *criterion, int type, int *types);

/* The members in the flow. reference: [n_vertices][3], the vertices at the start of the first run. */
typedef struct saturne_body {
    const char *name;
    spar_member *member;
    spar_fluid *surface;
    cs_lnum_t n_faces, n_vertices, *faces, *vertices; /* of this rank, from 0; faces are the wetted ones */
    double *x0, *x;                                   /* [n_vertices][3], at the start and now */
    double *force;                                    /* [n_faces][3] */
} saturne_body;
/* First the members and their faces, types[face] = mark for these; then the fluids. */
void saturne_bodies_select(int mark, int *types);
void saturne_bodies_create(const double *reference);
/* follows[vertex] = 1 where the members give the displacement; before saturne_bodies_create nowhere. */
void saturne_bodies_follow(int *follows);
int saturne_body_count(void);
const saturne_body *saturne_body_at(int i);
/* displacement: out, [n_vertices][3], since the start; of vertices that follow no member it stays. */
void saturne_bodies_pull(cs_real_3_t *displacement);
void saturne_bodies_push(void);
/* What the case file wants written of an accepted step. */
void saturne_bodies_output(void);
void saturne_bodies_free(void);
/* Total force pushed last, in units of the largest of the accepted steps. */
double saturne_bodies_growth(void);

/* Where the vertices are at the start of the first run, [n_vertices][3]; kept, not copied. */
void saturne_set_reference(const double *vertices);

/* Ends the run, and says what the flow is like. Collective. */
void saturne_flow_broke(const char *why);

/* From now on spar's file goes with code_saturne's checkpoints; and the structure goes on where the flow does. After
   the fluids are mapped. Collective. reference: as of saturne_bodies_create, NULL: the mesh does not move. */
void saturne_resume(const double *reference);
/* Whether this run goes on from another one. */
int saturne_resumed(void);
/* history.csv, on the rank that writes it; a run that goes on goes on in it, from the row of the time t, s. */
FILE *saturne_open_history(double t, const char *columns);

/* Forces of the fluid on boundary faces, from the pressure and velocity as they are now: what astfor_ is given has the
   pressure of the iteration before. Collective. n: faces; faces[n]; force[n][3]: out, N. */
void saturne_wall_forces(cs_lnum_t n, const cs_lnum_t *faces, double *force);

/* Puts dt, steps and precision in force, in cs_user_parameters. */
void saturne_steps(cs_domain_t *domain);
/* Centred differences for the velocity, likewise; without the slope test, which switches, so that loads jump. */
void saturne_centre(void);
/* From 0 at t = 0 smoothly to 1 at t = over, s. */
double saturne_ramp(double t, double over);

/* Processor time that goes to spar: between begin and end, of this rank. */
void saturne_clock_begin(void);
void saturne_clock_end(void);
/* seconds[2]: out, of spar and of the whole run so far, summed over the ranks. Collective. */
void saturne_clock_read(double seconds[2]);
/* What the history is about. */
void saturne_report_begin(void);
/* A line of history.csv, after a step was accepted. Collective. */
void saturne_report_step(void);
/* summary.txt, at the end of the run. Collective. */
void saturne_report_run(void);

/* The mesh, mesh.c. Collective.
     out: how far the structure is out, m
     volume: out, the least part of its volume at the start that a cell has had
   end: the least sine of a corner in the run.
   fold, last: an error if a cell has no volume now, on which code_saturne ends a run without a word and with status 0.
 */
void saturne_mesh_begin(void);
void saturne_mesh_step(double out);
double saturne_mesh_end(double *volume);
void saturne_mesh_fold(void);

#if SATURNE_VERSION < 80
/* code_saturne's Fortran user routines that are written in C here. */
void CS_PROCF(usalcl, USALCL)(const int *itrale, const int *nvar, const int *nscal, int *icodcl, int *itypfb,
                              int *ialtyb, int *impale, const cs_real_t *dt, cs_real_t *rcodcl, const cs_real_t *xyzno0,
                              cs_real_t *disale);
void CS_PROCF(usaste, USASTE)(int *idfstr);
void CS_PROCF(cs_f_user_boundary_conditions, CS_F_USER_BOUNDARY_CONDITIONS)(void);
#endif

#ifdef __cplusplus
}
#endif

#endif
