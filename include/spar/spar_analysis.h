/* spar_analysis.h: experimental, may change in any release. Error estimates, learned added mass, trial runs, effects,
   advice, eigenvalues with the fluid. The conventions of spar.h apply. */
#ifndef SPAR_ANALYSIS_H
#define SPAR_ANALYSIS_H

#include <spar/spar_coupling.h>
#include <spar/spar_structure.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ---- error estimates and learned added mass ---------------------------------------------------------------------- */

/* Estimates the present error of a member's motion, as the root of the mean square over its nodes. In the mean over
   a run the step's estimate is right to a factor of 3. The nodes' estimate is right to a factor of 4 if the run
   forgets its past within some periods; a single one may be farther off. Without damping, a frequency that is
   slightly wrong shifts the phase more and more; only trials show this (spar_trial_advise). See
   docs/explanation/advice.md. Local, the same on all ranks; the estimate of the nodes solves up to five systems.
     step: out, m, error of the last step, or of the step in progress once it is solved, NULL: not wanted
     nodes: out, m, displacement towards the shape of a beam with four more nodes per element, between steps; 0: the
           member has no shape; -1: not known (linear or modal, 24 nodes per element, a free root before the first step,
           no solution); NULL: not wanted
   SPAR_ERR_STATE: no tolerance is set (step), within a step (nodes), in trials, static solutions and initial steps. */
SPAR_API int spar_member_estimate_error(spar_member *member, double *step, double *nodes);
/* Learns the fluid's added mass during iterations, from the changes of loads and accelerations, with any scheme that
   iterates. Once it is known well enough, it replaces the given added mass in the equations. Then few iterations,
   fixed-point iterations or explicit steps are enough. It is the response within a step: half the added mass for a
   fluid that takes accelerations from the velocities at both ends of the step. The converged solution does not
   change. Trials do not learn. Default: off. Local, on all ranks, before the commit.
     n: in, stations of a beam, linear between them, at most 20; 1: constant along it, or a rigid body; 0: off
     eta[n]: in, of a beam, strictly increasing in [0,1]; else ignored
   SPAR_ERR_UNSUPPORTED: as spar_member_set_added_mass. */
SPAR_API int spar_member_learn_added_mass(spar_member *member, int64_t n, const double *eta);
/* The added mass learned so far. The next run may start with it (spar_member_set_added_mass). Local, the same on every
   rank.
     used: out, 1: it is in the equations from the next step on, NULL: not wanted
     spread: out, relative error of the predicted load change, measured before each update (root mean square); about the
           factor by which iterations will contract. Used below 1/4, no longer above 1/2. 1: too few measurements. NULL:
           not wanted
     n: out, stations, 0: nothing is to be learned, NULL: not wanted
     capacity: in, of the arrays; n is enough
     eta[capacity]: out, NULL: not wanted
     mass[capacity][36]: out, as spar_member_set_added_mass takes it, 0 while nothing is known, NULL: not wanted */
SPAR_API int spar_member_get_learned_added_mass(const spar_member *member, int *used, double *spread, int64_t *n,
                                                int64_t capacity, double *eta, double *mass);

/* ---- trials ------------------------------------------------------------------------------------------------------ */

/* A trial answers "what if". The session runs some steps from its present state, with other settings or without an
   effect. Then it returns to the present state, to the last bit. A trial holds the steps of such runs, the callbacks of
   the host, settings and results.

   The steps are the host's own, with its own fluid. The callbacks must be repeatable: the same motion and time give the
   same loads, whatever ran before. They may use members and fluids in all ways, but not create or map them. Nothing
   else of the host may change for good. Where spar_trial_advise varies nodes, the callbacks get the counts anew
   (spar_member_get_count). A run begins with accelerations from the balance of forces.

   All ranks create the same trials in the same order. A collective call compares the settings of its trial across the
   ranks (SPAR_ERR_COMM). It is made between steps, with all members committed, and not within a run of a trial
   (SPAR_ERR_STATE). The settings of a trial are fixed while it runs (SPAR_ERR_STATE). After a failure the session and
   the results of the trial are as before. */
typedef struct spar_trial spar_trial; /* runs of a session, which is restored after each */
/* Creates a trial of the session. The session destroys it at the latest when it is destroyed itself. Local.
     session: in, of the trial
     trial: out, handle */
SPAR_API int spar_trial_create(spar_session *session, spar_trial **trial);
/* Destroys a trial, and sets the handle to NULL. A trial that runs ends its run first; a library that still has the
   handle gets SPAR_ERR_STATE. Local.
     trial: in, out, NULL: nothing to do */
SPAR_API void spar_trial_destroy(spar_trial **trial);
/* Local.
     session: out, of the trial */
SPAR_API int spar_trial_get_session(const spar_trial *trial, spar_session **session);

/* Sets the steps of a run. Without them the collective calls are SPAR_ERR_STATE. Local.
     dt: in, s, length of a step, >= 1e-100; 0 with steps 0: not set (default)
     steps: in, number of steps, >= 1; spar_trial_run, _report_effects and _advise take multiples of 8 */
SPAR_API int spar_trial_set_steps(spar_trial *trial, double dt, int64_t steps);
/* Local.
     dt: out, s, 0: not set, NULL: not wanted
     steps: out, 0: not set, NULL: not wanted */
SPAR_API int spar_trial_get_steps(const spar_trial *trial, double *dt, int64_t *steps);
/* Sets the callbacks of the host, on all ranks or on none. Each has a context of its own. Local.
     before: in, called before each step from t: drives roots, sets loads, keeps the fluid's state at t^n; NULL: none
     before_context: in, handed to before, must live as long as the trial uses it
     solve: in, the fluid solver, as in spar_step; NULL: no fluid, the present loads stay
     solve_context: in, handed to solve, must live as long as the trial uses it */
SPAR_API int spar_trial_set_callbacks(spar_trial *trial, spar_before_step before, void *before_context,
                                      spar_fluid_solver solve, void *solve_context);
/* Sets the progress callback of a trial, on all ranks or on none. It is told how many runs a call with many runs has
   made, before each run (spar_trial_advise, _report_effects, _solve_eigenvalues, _solve_floquet). Between the runs the
   session is in its present state. The callback may read the session, and changes nothing. If it answers other than 0,
   the call ends with SPAR_ERR_USER, on other ranks with SPAR_ERR_PEER. A run whose step exceeds its budget (option
   newton.budget) counts as one that fails. Local.
     progress: in, as of spar_session_set_progress, but with runs in place of iterations; for advice `expected` is the
           option limit of the trial. NULL: none (default)
     context: in, handed to progress, must live as long as the trial uses it */
SPAR_API int spar_trial_set_progress(spar_trial *trial, spar_progress progress, void *context);

/* One run with the session as it is, for hosts that compare settings of their own. Collective. Failures as of
   spar_step.
     compare: in, 0: later runs of this trial are compared with this one, and its own errors are 0; 1: compared with
           that run over the same time, with any dt. SPAR_ERR_STATE: no run of the present members to compare with */
SPAR_API int spar_trial_run(spar_trial *trial, int compare);
/* Differences of the last run from the run it was compared with. Each is the root mean square over members, positions
   and time, relative to that of the other run. Runs are compared at 128 even times; between steps by cubic
   interpolation. Local. SPAR_ERR_STATE: no run so far.
     motion: out, relative to the motion beyond that of a fixed or driven root, else since the start, NULL: not wanted
     reaction: out, of the reactions at the roots, moments by the members' lengths, NULL: not wanted
     load: out, of the fluid's loads, after the first step and at 8 even times, NULL: not wanted */
SPAR_API int spar_trial_get_errors(const spar_trial *trial, double *motion, double *reaction, double *load);
/* Cost of the last run. Local. SPAR_ERR_STATE: no run so far.
     seconds: out, s, processor time of the steps and the fluid, on all ranks, NULL: not wanted
     evaluations: out, calls of the fluid solver, NULL: not wanted */
SPAR_API int spar_trial_get_cost(const spar_trial *trial, double *seconds, int64_t *evaluations);

/* ---- effects ----------------------------------------------------------------------------------------------------- */

/* Effects of the report. "Without" says what the run without the effect has instead. */
enum {
    SPAR_ROW_INERTIA = 0,
    SPAR_ROW_GYROSCOPIC = 1,
    SPAR_ROW_GRAVITY = 2,
    SPAR_ROW_DAMPING = 3,
    SPAR_ROW_FLUID_MOMENT = 4,   /* moments pushed by the fluid */
    SPAR_ROW_FLUID_VELOCITY = 5, /* velocities pulled; without: zero */
    SPAR_ROW_FLUID_POSES = 6,    /* orientations, angular velocities, accelerations pulled; without: the reference's */
    SPAR_ROW_FLUID_HISTORY = 7,  /* node forces pulled back; without: zero */
    SPAR_ROW_PREDICTOR = 8,      /* extrapolation of the loads; without: order 0 */
    SPAR_ROW_ITERATION = 9,      /* iteration of the coupling; without: explicit */
    SPAR_ROW_HALF_STEP = 10,     /* pulls at 0 < theta < 1; without: theta 1 */
    SPAR_ROW_MASSES = 11,        /* bodies on beams: their weight and inertia */
    SPAR_ROW_FOUNDATION = 12,    /* springs along beams */
    SPAR_ROW_PRETENSION = 13,    /* section forces of the reference */
    SPAR_ROW_COUNT = 14
};
/* Name of an effect, such as "gravity", in static storage; "" for any other number. */
SPAR_API const char *spar_effect_name(int row);
/* Finds what each effect contributes, by runs with the effect and without it in all members. Collective. */
SPAR_API int spar_trial_report_effects(spar_trial *trial);
/* One effect in the last report. Figures of an effect that is not in force are 0. Local. SPAR_ERR_STATE: no report.
     row: in, SPAR_ROW_*
     in_force: out, 1: the session has this effect, 0: not, NULL: not wanted
     fails: out, 1: the run fails without it, and motion, reaction and share are 0; a log is told why, at
           SPAR_LOG_INFO; 0: it does not; NULL: not wanted
     size: out, NULL: not wanted. Inertia to damping, masses, foundation, pretension: nodal forces relative to the
           largest term of the equations, root of the sum of squares over nodes, the present state and the steps.
           Fluid: change of its loads, as load of spar_trial_get_errors. Predictor: |predicted - final| / |final|
           loads of the last step. Iteration: added mass over mass, as the coupling sees it. Half step: (Omega dt)^2 / 8
     motion: out, error of the motion without it, as of spar_trial_get_errors, NULL: not wanted
     reaction: out, error of the reactions without it, likewise, NULL: not wanted
     share: out, part of the time of a solution that is saved without it, below 0: it costs more; for predictor and
           iteration of the time of the run; NULL: not wanted */
SPAR_API int spar_trial_get_effect(const spar_trial *trial, int row, int *in_force, int *fails, double *size,
                                   double *motion, double *reaction, double *share);

/* ---- advice ------------------------------------------------------------------------------------------------------ */

/* What the tolerance of the advice holds for. Each goal is relative to its own root mean square. */
enum {
    SPAR_GOAL_MOTION = 1,   /* motion, as of spar_trial_get_errors */
    SPAR_GOAL_REACTION = 2, /* reactions of roots and joints, moments by the members' lengths */
    SPAR_GOAL_SECTION = 4,  /* section forces at nine positions of each beam, as of spar_beam_evaluate; moments by the
                               lengths */
    SPAR_GOAL_LOAD = 8,     /* the fluid's loads on each member: their sum, and their moment about its root */
    SPAR_GOAL_NUMBERS = 16  /* each number of spar_trial_push_numbers */
};
/* Sets the goals of the advice. Local.
     goals: in, SPAR_GOAL_* combined with or, the tolerance holds for each of them; default SPAR_GOAL_MOTION */
SPAR_API int spar_trial_set_goals(spar_trial *trial, int goals);
/* Local.
     goals: out, SPAR_GOAL_* combined with or */
SPAR_API int spar_trial_get_goals(const spar_trial *trial, int *goals);
/* Gives numbers of the host that the advice keeps, such as thrust, power or lift. The callbacks push them in each
   iteration or before a step; the last numbers of a step count. On several ranks their sum counts: each rank gives its
   part, or one rank gives them all. Local, at any time.
     n: in, 0 to 32
     numbers[n]: in, any unit */
SPAR_API int spar_trial_push_numbers(spar_trial *trial, int64_t n, const double *numbers);
/* Sets an option of the advice. Local.
     key: in, "dt", "nodes", "coupling": vary (default) or keep it as it is
           "limit": most trials, 4 to 1000 (default 15)
     value: in, as text */
SPAR_API int spar_trial_set_option(spar_trial *trial, const char *key, const char *value);
/* Reads an option of the advice. Local.
     key: in, of spar_trial_set_option
     capacity: in, of the text with its end; 32 is enough
     text[capacity]: out, the value; SPAR_ERR_ARGUMENT if it does not fit */
SPAR_API int spar_trial_get_option(const spar_trial *trial, const char *key, int64_t capacity, char *text);
/* Finds cheap settings whose error stays below a tolerance. A trial with the session as it is gives estimates of the
   errors of steps and nodes; these propose a dt. Trials with a smaller dt, more nodes and a tight coupling confirm
   it: the error of each trial is its distance from the finest, and no less than finer trials lead one to expect.
   Errors are extrapolated to the length of the run. Where several settings are as good, the session's own are advised.
   The session stays as it is. A log is told of each trial at SPAR_LOG_INFO.

   Varied are dt, the nodes per element of solved beams, the coupling and its rtol, and Newton's rtol. Costs are
   counted (solutions, weighed by the nodes) and not timed: the same session gets the same advice each time.
   Collective.
     tolerance: in, in (0, 1), of each goal
     length: in, s, > 0, duration of the run that the advice is for. If it is longer than the trial's steps, their
           errors are extrapolated by their growth in time. What only happens later, such as a gust, is not seen
   SPAR_ERR_UNSUPPORTED: no fluid solver. SPAR_ERR_NUMERIC: the trials do not converge, or no settings keep the
   tolerance; or the trials cover neither a steady state nor a full period, and so cannot be extrapolated. The message
   says what error was reached, and what would tell more. SPAR_ERR_LIMIT: the option limit was reached first. */
SPAR_API int spar_trial_advise(spar_trial *trial, double tolerance, double length);
/* The advised settings of the session. Local. SPAR_ERR_STATE: no advice.
     dt: out, s, NULL: not wanted
     substeps: out, as of spar_session_set_integrator, NULL: not wanted
     scheme: out, SPAR_COUPLING_*, NULL: not wanted
     coupling_rtol: out, of an iterated scheme, NULL: not wanted
     predictor: out, order, NULL: not wanted
     newton_rtol: out, NULL: not wanted */
SPAR_API int spar_trial_get_settings(const spar_trial *trial, double *dt, int *substeps, int *scheme,
                                     double *coupling_rtol, int *predictor, double *newton_rtol);
/* The advised settings of a beam. Local. SPAR_ERR_STATE: no advice for this member.
     member: in, of the session
     fidelity: out, SPAR_FIDELITY_*, NULL: not wanted
     modes: out, of a modal beam, else 0, NULL: not wanted
     elements: out, NULL: not wanted
     nodes_per_element: out, NULL: not wanted
     points: out, for spar_beam_set_quadrature with the rule in force, 0: as described, NULL: not wanted */
SPAR_API int spar_trial_get_beam(const spar_trial *trial, const spar_member *member, int *fidelity, int64_t *modes,
                                 int *elements, int *nodes_per_element, int *points);
/* Errors and cost that the advice expects. Local. SPAR_ERR_STATE: no advice.
     error: out, with the advised settings, of the goal with the largest one, NULL: not wanted
     cost: out, of a second of the run, relative to the session as it is; 0: not known, since that fails; NULL: not
           wanted
     present_fails: out, 1: a run with the session as it is fails, or its dt does not resolve the motion; 0: not, NULL:
           not wanted
     present_error: out, of the session as it is, 0 if that fails, NULL: not wanted */
SPAR_API int spar_trial_get_outcome(const spar_trial *trial, double *error, double *cost, int *present_fails,
                                    double *present_error);
/* What the search for the advice has cost. Local. SPAR_ERR_STATE: no advice.
     runs: out, trials made, NULL: not wanted
     work: out, their counted cost, in trials with the session as it is; 0 if that fails; NULL: not wanted */
SPAR_API int spar_trial_get_search(const spar_trial *trial, int64_t *runs, double *work);
/* Puts the advice in force: coupling scheme and its rtol, predictor, Newton's rtol, and the nodes per element of beams.
   The host takes the advised dt itself.

   Beams with other settings are rebuilt in place. They keep handle, name, placement, root, loads and the work done on
   them. Their motion is transferred by the interpolation of the elements, loads by its transpose, so that their sum
   stays. Accelerations follow from the balance of forces. Fluids keep handles and nodes, and are mapped again. Counts
   change (spar_member_get_count); the host gives node numbers anew, for example of loads that it sets. Everything else
   stays to the last bit, among it rho_inf, atol of coupling and Newton, limits, options and effects. A beam whose nodes
   the host has given has its line through the new nodes. To apply the same advice again changes nothing. Collective.
     dt: out, s, advised, NULL: not wanted
   SPAR_ERR_STATE: no advice; members were added or described otherwise since; or a fluid has nodes that are not
   mapped. After a failure all is as before. */
SPAR_API int spar_trial_apply(spar_trial *trial, double *dt);

/* ---- stability with the fluid ------------------------------------------------------------------------------------ */

/* Sets the small motions for spar_trial_solve_eigenvalues and spar_trial_solve_floquet. Local.
     modes: in, 1 to 200 lowest undamped modes; give more until the result stays; 0: not set (default)
     amplitude: in, >= 0, to 0.1: displacement of a node over the length of its member, or rotation in rad; 0: 1e-5 for
           eigenvalues, 1e-4 for Floquet (default). A fluid that is solved to r of its loads needs about sqrt(r)
     memory: in, for eigenvalues: 0 to 1000000 steps until the loads decay after a motion has ended; 0: the fluid has no
           memory (default) */
SPAR_API int spar_trial_set_motion(spar_trial *trial, int64_t modes, double amplitude, int64_t memory);
/* Local.
     modes: out, 0: not set, NULL: not wanted
     amplitude: out, as set, NULL: not wanted
     memory: out, NULL: not wanted */
SPAR_API int spar_trial_get_motion(const spar_trial *trial, int64_t *modes, double *amplitude, int64_t *memory);
/* Eigenvalues of structure and fluid together: those of spar_member_solve_eigenvalues, with the fluid's response to
   small motions about the present state. That state is an equilibrium with the loads in use (spar_session_solve_static,
   or a run that has come to rest or rotates steadily). A wing flutters where the largest growth rate, over the wind
   speed, passes 0.

   Members move in runs along each of the lowest undamped modes, to and fro. Nothing is solved: the fluid solver gives
   the loads. A fluid without memory is called 6 modes times, once in a run, for displacement, velocity and
   acceleration; it may make them from the positions at both ends of the step. A fluid with memory is called
   2 modes (22 + memory) times: the motion is a pulse of a few steps, and the loads are recorded until so many steps
   after it. Their later decay is that of the linear system that they show. Joints that constrain or drive do not move;
   neither does what the callback before a step drives or loads (docs/explanation/stability.md).

   The structure is exact in time: steps show these growth rates to the order of their integrator. Of the trial's steps
   only dt is used. With memory, eigenvalues are found up to |lambda| dt = 1. A rotor's eigenvalues are those in a fluid
   that is steady in the rotating frame. Collective.
     n: in, number of eigenvalues, 0 to 2 modes
     shift[2]: in, 1/s and rad/s: growth rate and angular frequency; the eigenvalues nearest to it are found; NULL: zero
     eigenvalue[n][2]: out, 1/s and rad/s: growth rate and angular frequency >= 0, by their distance from the shift.
           Those of the fluid alone are left out unless they grow
     nodes: in, all_nodes, of all members of the session; 0 without shapes
     shapes[n][nodes][6][2]: out, displacement and rotation of the nodes, member by member as created, real and
           imaginary part, of unit x^H M x, NULL: not wanted
     frame[3]: out, rad/s, as of spar_member_solve_eigenvalues, NULL: not wanted
   SPAR_ERR_STATE: no equilibrium, or other loads there. SPAR_ERR_NUMERIC: the fluid does not come to rest within the
   memory, or fewer than n were found. SPAR_ERR_ARGUMENT: memory 0 of a fluid with states. SPAR_ERR_UNSUPPORTED: no
   fluid solver, or as of members. */
SPAR_API int spar_trial_solve_eigenvalues(spar_trial *trial, int64_t n, const double shift[2], double *eigenvalue,
                                          int64_t nodes, double *shapes, double frame[3]);
/* Stability of a periodic state: a rotor of two blades, or on a tower, or under its weight. Finds the eigenvalues of
   the map of small motions over one period, Floquet's multipliers mu. The trial's steps are those of the period. Run
   until the state repeats, then call.

   Runs go through the period with the host's own steps and fluid: 4 modes + 1 runs of a period and a step. Everything
   that spar solves for is displaced along each of its lowest undamped modes, and given a velocity along it, to and fro.
   The multipliers are those of the steps, right to dt^2. Errors are the square of the amplitude, and the coupling's
   error over the amplitude. Each run begins with consistent initial accelerations, for which the solver is called with
   dt 0 (spar_session_solve_initial). Newton's rtol is 1e-12 at most. The callback before each step drives roots and
   joints by the time. The fluid begins each run with its present states: what it remembers for longer than a period is
   not seen. Collective.
     n: in, number of multipliers, 0 to 2 modes
     eigenvalue[n][2]: out, 1/s and rad/s: growth rate and angular frequency of log(mu) over the period, the least
           damped first. Of a conjugate pair one is given, with a frequency from 0 to pi over the period. It is known
           up to multiples of 2 pi over the period, and up to its sign. A growth rate > 0 is an instability
   SPAR_ERR_STATE: the state does not repeat; the message says by how much. SPAR_ERR_NUMERIC: fewer than n were found.
   SPAR_ERR_UNSUPPORTED: spar solves for nothing. Failures as of spar_step. */
SPAR_API int spar_trial_solve_floquet(spar_trial *trial, int64_t n, double *eigenvalue);

#ifdef __cplusplus
}
#endif

#endif
