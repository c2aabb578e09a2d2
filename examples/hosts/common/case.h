/* case.h: the structure of a coupled run from a text file, so that a user with another wing writes no C. Made on the
   installed headers alone; an adapter compiles case.c and case_text.c (C11, POSIX) beside itself and calls, in C or
   C++,

       spar_session_create_mpi(comm, &session);
       spar_case_read("flag.case", "openfoam", session, &scene);   settings, members committed, joints
       spar_case_member(scene, "flag", &wet);                      then fluids on them, as in any host
       spar_case_get_numbers(scene, "near", 1, NULL, &near);       the adapter's own keys
       spar_case_check(scene);                                     no key that nobody has asked for
       ...
       spar_step_accept(session);
       spar_case_output(scene, rank, 1, &fluid);                   pictures and a history, as the file asks

   The file
   Lines of a key and its values, under headings in brackets; what follows a # is a comment; values are split by blanks
   and may stand in double quotes. Numbers have a point, whatever the locale. SI units, angles in radians, as in spar.h,
   which says what each value means; what is left out stays as the library has it. Files that it names are looked for
   beside it, those of [output] in the working folder. A key stands once but for those marked *, each line of which adds
   a row. 6x6 matrices have 6 numbers (the diagonal), 21 (the upper triangle, row by row) or 36.

   [session], [session HOST]: settings; the second is for one adapter and comes on top
     gravity x y z              rho_inf r               substeps n              newton atol rtol max_iterations
     scheme explicit|fixed-point|aitken|iqn-ils         atol a (N)              rtol r
     max_iterations n           relaxation omega        predictor 0|1|2         reproducible on|off
     option* KEY VALUE          as of spar_session_set_option
     restart FILE               that save has written: where a host can, the run goes on from it
   [beam NAME]
     elements n                 default 1
     nodes n                    of an element, default 8
     axis* eta x y z [twist]    or axis_file FILE, of the same rows
     twist_scale s              makes rad, right-handed about the tangent, of that column: default 1
     node* x y z [qw qx qy qz]  instead of an axis
     section* eta stiffness [mass]       or sections_file FILE, of the same rows; the mass in the stiffness's form
     beamdyn PRIMARY [BLADE]    instead of axis, sections and damping
     quadrature gauss|lobatto|sections n
     damping mu1 .. mu6         modal_damping mode ratio mode ratio
     fidelity exact|linear|rigid|prescribed, or modal n
     line_load* dead|follower eta fx fy fz mx my mz
     mass_damping alpha         1/s (spar_beam_set_mass_damping)
     plane nx ny nz             holds the beam in the plane with this normal (spar_beam_set_plane)
     body* eta mass             a rigid body that sits on it (spar_beam_set_masses)
     foundation* eta kx ky kz   springs to the ground along it, N/m^2 (spar_beam_set_foundation)
     pretension* eta n vy vz t my mz    section forces of the reference (spar_beam_set_pretension)
     added_mass* eta mass       a guess of the fluid's, per length (spar_member_set_added_mass)
   [rigid NAME]
     mass                       a 6x6 matrix            added_mass              likewise, a guess of the fluid's
   [point NAME]
   a beam or rigid body with an added mass
     added_mass_response acceleration|velocity      spar_member_set_added_mass_response
   these three
     place x y z                orientation qw qx qy qz
     root free|fixed|pinned|driven               external on|off          owner rank
     effects_on, effects_off inertia|gyroscopic|gravity|damping|fluid_moment|fluid_history|work|masses|
             foundation|pretension ...                  besides the defaults, and of the defaults
     velocity x y z             spin x y z      about x y z          the initial rigid motion
     load* NODE dead|follower fx fy fz mx my mz                      NODE: a number from 0, first or last
   [joint NAME]
     a MEMBER NODE              b MEMBER NODE, or b ground
     free none|all|x|y|z|rx|ry|rz ...                                default none
     place x y z                axes qw qx qy qz
     stiffness, damping         6x6 matrices    preload fx .. mz
     driven none|all|x|..       load fx .. mz
   [line NAME]
     a MEMBER NODE x y z        b MEMBER NODE x y z, or b ground x y z
     stiffness k                damping c       length l             tension_only on|off
     driven on|off
   [aero NAME]: blade elements in a steady wind, where a host has them (spar_case_make_aero); as of spar_aero.h
     blades MEMBER ...          alike, one fluid on each
     aerodyn PRIMARY [BLADE]    chord, twist and polars by AeroDyn's files
       axes qw qx qy qz         of the blade's axes there in the members' own
       stations n first last    n sections at even distances (m from the root); default: those of the file
     section* eta chord twist POLAR [y z]      instead; POLAR: a file of rows alpha cl cd [cm], rad
     rotor x y z  ax ay az  hub_radius tip_radius     a point of the shaft, its direction, the blades' ends
     turn 1|-1                  total n, blades of the whole rotor
     shear power|log|linear  x y z  ux uy uz  height parameter   ground, up, where the wind is that given, the law's own
     tower x y z  x y z  base_radius top_radius       its base, its top
     effects none|induction|tip_loss|hub_loss|swirl|drag|moment|shear|tower|inflow|stall|unsteady ...
     density rho                wind x y z
   [output], [output HOST]: what spar_case_output writes; the second is for one adapter and replaces the first
     folder DIR                 of the pictures, made if it is not there; default: the working folder
     every n                    steps from picture to picture (VTK, by spar_output.h); default 0: none
     fluids on|off              pictures of fluids too
     history FILE               a line a step: t, step, iterations, residual (N), loads (N), added mass / mass
     save FILE [n]              the session, to FILE.STEP, after every n-th step; default 1
     watch* MEMBER NODE         nine more columns: displacement, velocity, and the sum of the member's loads
   [host], [host HOST]: what the adapter asks for; any keys */
#ifndef SPAR_CASE_H
#define SPAR_CASE_H

#include <spar/spar_aero.h>
#include <stdio.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct spar_case spar_case;

/* Reads the file on every rank and does what it says: settings, members, which are committed, joints. Collective.
     path: in
     host: in, name of the adapter, whose own sections hold besides; NULL: none
     session: in, new
     scene: out, to be freed; it does not own members and joints, which are the session's
   SPAR_ERR_IO: the file, or one that it names, cannot be read; SPAR_ERR_ARGUMENT: what stands in it is not right; or
   what a call of spar has answered. spar_case_message has file, line, and the cure. The session then has some of the
   members and is to be destroyed. */
int spar_case_read(const char *path, const char *host, spar_session *session, spar_case **scene);
/* NULL and a second call are legal. Before or after the session goes. */
void spar_case_free(spar_case **scene);
/* What went wrong last in a call of this header in this thread; "" if nothing ever did. */
const char *spar_case_message(void);

/* Members and joints in the order of the file, and by name. i: in, from 0. A name that is not there is
   SPAR_ERR_ARGUMENT, and the message has the nearest one. */
int64_t spar_case_member_count(const spar_case *scene);
spar_member *spar_case_member_at(const spar_case *scene, int64_t i);
int spar_case_member(const spar_case *scene, const char *name, spar_member **member);
int spar_case_joint(const spar_case *scene, const char *name, spar_joint **joint);

/* What [host HOST] and, where it is not there, [host] say of a key.
     otherwise: in, what holds where neither has it; NULL: it has to be there
     text: out, the values of the line, joined by blanks; belongs to the scene or is `otherwise`
     n: in; x[n]: out */
int spar_case_get_text(spar_case *scene, const char *key, const char *otherwise, const char **text);
int spar_case_get_numbers(spar_case *scene, const char *key, int n, const double *otherwise, double *x);
/* One value of a key whose line is a list, as the file has it: "6 or 7" in quotes is one value.
     n: out, number of values, 0: no such key, NULL: not wanted
     i: in, from 0
     word: out, belongs to the scene, NULL: not wanted; SPAR_ERR_ARGUMENT if there is no value i */
int spar_case_get_word(spar_case *scene, const char *key, int i, int *n, const char **word);
/* Refuses a key of [host] or [host HOST] that has not been asked for: it was misspelt; and a heading whose host is
   HOST but for a letter or two. To be called when all keys were asked for. */
int spar_case_check(const spar_case *scene);
/* Headings that are for other hosts, with their lines, "" if there are none: for the adapter to tell once, so that a
   user who put a key there learns why it does nothing. Belongs to the scene. */
const char *spar_case_others(const spar_case *scene);
/* The same for [host HOST] alone: for a program that reads files of other hosts too. */
int spar_case_check_own(const spar_case *scene);

/* Makes what [aero] describes, once, on rank 0, whose fluids they are; the members may be solved anywhere. Collective.
     rank: in, of this process */
int spar_case_make_aero(spar_case *scene, int rank);
/* The loads of all [aero] in their winds, from the latest motion: in every iteration, after spar_step_solve. Local. */
int spar_case_blow(spar_case *scene);
/* One of them, on rank 0, for spar_aero_get_*. */
int spar_case_aero(const spar_case *scene, const char *name, spar_aero **aero);

/* How many [aero] there are; and one of them, on rank 0, after spar_case_make_aero.
     i: in, from 0
     name: out, NULL: not wanted
   NULL: there are not so many. */
int64_t spar_case_aero_count(const spar_case *scene);
spar_aero *spar_case_aero_at(const spar_case *scene, int64_t i, const char **name);

/* Prints all headings and keys, with units and defaults. */
void spar_case_explain(FILE *to);

/* Goes on from the file that `restart` names, if it names one: after all fluids are mapped, before the first step.
   Collective.
     restarted: out, NULL: not wanted */
int spar_case_restart(spar_case *scene, int *restarted);

/* The same for a flow that has checkpoints of its own: the structure goes on where the flow does. After all fluids are
   mapped, at their first positions, before the first step. Collective.
     path: in, the structure's file that was written with the flow's checkpoint; `restart` of the case file replaces it;
       NULL: the flow starts anew
     t: in, s, the flow's time
     step: in, number of steps that the flow has behind it; -1: the flow does not count them
   SPAR_ERR_IO: the flow goes on and the file is not there or cannot be read; SPAR_ERR_ARGUMENT: the file is of another
   time or step, or of another structure. The session is then to be destroyed. */
int spar_case_resume(spar_case *scene, const char *path, double t, int64_t step);
/* Removes the rows after the time t from a history, so that a run that goes on from t adds its own. Rows begin with
   their time; lines that do not begin with a number stay. No file is legal. Local; for the rank that writes it.
     path: in
     t: in, s */
int spar_case_cut_history(const char *path, double t);

/* After spar_step_accept: pictures and the history line that are due at this step, and the session where the file has
   `save`. Called by all ranks; local but where the session is saved. Members and history are written by rank 0, fluids
   by their ranks. rank: in, of this process fluids: in, how many; fluid[fluids]: in, this rank's */
int spar_case_output(spar_case *scene, int rank, int fluids, spar_fluid *const *fluid);

#ifdef __cplusplus
}
#endif

#endif
