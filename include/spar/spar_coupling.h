/* spar_coupling.h: how steps are integrated and coupled, and what fluids can have beyond the basics of spar.h. The
   defaults suit most hosts.

   The conventions of spar.h apply. Settings of a session are local calls, made with the same values on every rank,
   between steps. Getters are local. */
#ifndef SPAR_COUPLING_H
#define SPAR_COUPLING_H

#include <spar/spar.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ---- time integration of the structure --------------------------------------------------------------------------- */

/* The integrator. Steps of equal length use generalised-alpha on the Lie group (Bruels, Cardona, Arnold 2012). A step
   whose length differs by more than 0.1 % from one of the two before it uses TR-BDF2, with two solutions of one
   tangent. An exact beam that spins at Omega without a driven root uses TR-BDF2 where 1 - rho_inf < 1.5 Omega dt. A
   substep without a solution, or whose solution gains energy that no load supplies, is divided, down to 1/1024
   (SPAR_ERR_NUMERIC).
     rho_inf: in, spectral radius of generalised-alpha at infinite frequency, in [0,1]; default 0.9. Choose less to damp
           unresolved modes, 1 to conserve energy. 0 has 5.4 times the error of 0.9
     substeps: in, structural steps per coupling step, >= 1; default 1. Loads change linearly in them. Choose more
           if the structure is faster than the fluid */
SPAR_API int spar_session_set_integrator(spar_session *session, double rho_inf, int substeps);
/* rho_inf: out, NULL: not wanted
   substeps: out, NULL: not wanted */
SPAR_API int spar_session_get_integrator(const spar_session *session, double *rho_inf, int *substeps);
/* Tolerances of Newton's iteration in a step. It stops when the estimated remaining correction is below
   atol + rtol times the motion in the step, and the estimated unbalanced forces are below 100 rtol times the largest
   section force or force of inertia. Displacements are relative to the member's length, rotations are in rad. Both
   estimates follow from the iterations of the same solution. Choose rtol 1e-12 to compare runs to their last digits.
     atol: in, >= 0; default 1e-15
     rtol: in, >= 0; default 1e-8
     max_iterations: in, >= 1; after that many SPAR_ERR_NUMERIC; default 50 */
SPAR_API int spar_session_set_newton(spar_session *session, double atol, double rtol, int max_iterations);
/* atol: out, NULL: not wanted
   rtol: out, NULL: not wanted
   max_iterations: out, NULL: not wanted */
SPAR_API int spar_session_get_newton(const spar_session *session, double *atol, double *rtol, int *max_iterations);
/* Newton iterations of a member, as the rank that solves it knows them (spar_member_get_owner); zeros on other ranks.
     iterations: out, since the commit, NULL: not wanted
     left: out, estimated error of the last solution, relative to the member's length, or rad; of connected members the
           largest, NULL: not wanted */
SPAR_API int spar_member_get_iterations(const spar_member *member, int64_t *iterations, double *left);

/* Callback that is told how far a solution is, and may cancel it. Answer 0 to go on; anything else cancels the call.
     done: Newton iterations of this member, or of members connected to it, so far in this step or static solution
     expected: what done reaches at most: the budget (option newton.budget), in a static solution for each of its
           load_steps
     context: of spar_session_set_progress */
typedef int (*spar_progress)(spar_session *session, double done, double expected, void *context);
/* Sets the progress callback. It is called before each Newton iteration of spar_step_solve and of static solutions, in
   the calling thread, on the rank that solves the member. It must not call the session. If it cancels, the call answers
   SPAR_ERR_USER, on other ranks SPAR_ERR_PEER, and all is as before the call; a step that the host has begun can be
   solved again or rejected. In the runs of a trial it is not called; the trial has its own (spar_trial_set_progress).
   With a progress callback, threads share the work inside each member, not the members. Local, at any time but in
   callbacks; ranks may differ.
     progress: in, NULL: none (default)
     context: in, handed to progress, must live as long as the session uses it */
SPAR_API int spar_session_set_progress(spar_session *session, spar_progress progress, void *context);

/* ---- coupling iteration ------------------------------------------------------------------------------------------ */

/* Order of the polynomial that extrapolates the loads to t^{n+1}, (T11). The first steps use lower orders until enough
   loads are known. Extrapolation reaches at most ten times the last step.
     order: in, 0, 1 (default) or 2. Choose 0 for heavy fluids with explicit coupling */
SPAR_API int spar_session_set_predictor(spar_session *session, int order);
/* order: out */
SPAR_API int spar_session_get_predictor(const spar_session *session, int *order);
/* Relaxation of SPAR_COUPLING_FIXED_POINT, and the first factor of SPAR_COUPLING_AITKEN.
     omega: in, part of the change of loads that is applied, in (0,2]; default 1. Choose less for heavy fluids */
SPAR_API int spar_session_set_relaxation(spar_session *session, double omega);
/* omega: out */
SPAR_API int spar_session_get_relaxation(const spar_session *session, double *omega);
/* Sets an option by name.
     key: in
     value: in, a number or a word
   newton.budget          1 to 1000000000, default 100000: most Newton iterations of a member, or of connected members
                          together, in one step with all its coupling iterations and halvings, and for each of the
                          load_steps of a static solution; beyond, SPAR_ERR_LIMIT. spar_step_adaptive has a budget
                          for each of its tries
   coupling.unconverged   error (default) | accept: what spar_step_check does after max_iterations. Choose accept if the
                          host cannot repeat a step, and look at SPAR_REPORT_UNCONVERGED
   coupling.unstable      error (default) | accept: what spar_step_check does if the error of the predicted loads has
                          grown to the size of the loads, in steps with one evaluation of the fluid each: explicit, or
                          accepted before done. Choose accept to see an instability grow
   coupling.patience      1 to 1000000, default 3: with accept, so many consecutive unconverged steps are an error
   coupling.norm          motion (default) | loads: how the stop test, Aitken's factor and IQN-ILS weigh loads. Motion:
                          by the motion that they cause in the step, so a load on a stiff direction counts little.
                          Sessions with external members, points, or connected members without INERTIA use loads
   coupling.estimate      off (default) | on: with explicit coupling spar_step_check computes SPAR_REPORT_MOTION_ERROR,
                          by one back-substitution. Choose on to see what iterating would change
   coupling.columns       1 to 10000, default 30: IQN-ILS, largest number of difference columns
   coupling.reuse         0 to 10000, default 5: IQN-ILS, accepted steps whose columns are used again. Choose 0 for
                          fluids that change quickly
   coupling.filter        0 to 0.5, default 1e-4: IQN-ILS, a column is dropped if others contain all but this part
   coupling.motion_atol   >= 0, m, default 0, and
   coupling.motion_rtol   0 to 1, default 0: if one is set, the iteration also continues until the nodes move between
                          iterations by less than atol + rtol times their displacement in the step
   SPAR_ERR_ARGUMENT: no such key or value; the message lists them. */
SPAR_API int spar_session_set_option(spar_session *session, const char *key, const char *value);
/* The value of an option, as a text that spar_session_set_option takes.
     key: in
     capacity: in, of the text with its end; 32 is enough
     text[capacity]: out
   SPAR_ERR_ARGUMENT: no such key, or the capacity is too small. */
SPAR_API int spar_session_get_option(const spar_session *session, const char *key, int64_t capacity, char *text);
/* History of the iterations of the current step, or of the last step or static solution; the same on all ranks. Root of
   the sum of squares over all nodes; moments are divided by the member's length.
     iterations: out, how many there were, NULL: not wanted
     capacity: in, of the arrays; iterations is enough
     residual[capacity]: out, N, change of the loads in each iteration, weighed by motion (option coupling.norm), 0
           beyond the last, NULL: not wanted
     size[capacity]: out, N, size of the loads, NULL: not wanted */
SPAR_API int spar_session_get_iterations(const spar_session *session, int *iterations, int64_t capacity,
                                         double *residual, double *size);
/* The last of them.
     residual: out, N, 0 before the first iteration, NULL: not wanted
     size: out, N, NULL: not wanted */
SPAR_API int spar_session_get_residual(const spar_session *session, double *residual, double *size);
/* Entries of the report of the coupling. */
enum {
    SPAR_REPORT_CONTRACTION = 0, /* mean factor by which an iteration reduces the residual; 0 after one iteration */
    SPAR_REPORT_ADDED_MASS = 1, /* of iterations: added mass / mass in the directions that were iterated, over this step
                                   and, with decreasing weight, those before; 0: not known */
    SPAR_REPORT_COLUMNS = 2,    /* IQN-ILS: columns of the last least-squares problem */
    SPAR_REPORT_DROPPED = 3,    /* IQN-ILS: columns filtered out of this problem */
    SPAR_REPORT_ERROR = 4,      /* last accepted step: |final loads - predicted loads| / |final loads| */
    SPAR_REPORT_WORK_DEFECT = 5,       /* last accepted step: work of the fluid less work on the structure, J */
    SPAR_REPORT_UNCONVERGED = 6,       /* number of steps accepted without convergence (coupling.unconverged) */
    SPAR_REPORT_ADDED_MASS_SPREAD = 7, /* standard deviation of SPAR_REPORT_ADDED_MASS */
    SPAR_REPORT_MOTION_ERROR = 8, /* option coupling.estimate: largest displacement of a node if the pushed loads had
                                     been used in place of the predicted ones, m; to first order; nodes moved by the
                                     host count 0 */
    SPAR_REPORT_COUNT = 9
};
/* Report of the coupling; the same on all ranks.
     capacity: in
     report[capacity]: out, by SPAR_REPORT_*, NULL: not wanted */
SPAR_API int spar_session_get_report(const spar_session *session, int64_t capacity, double *report);
/* State of a step, or of a static solution with the fluid. */
enum {
    SPAR_PHASE_START = 0,   /* no step has begun yet; loads are those at t = 0 */
    SPAR_PHASE_BETWEEN = 1, /* between steps */
    SPAR_PHASE_BEGUN = 2,   /* begun, not solved */
    SPAR_PHASE_SOLVED = 3,  /* solved, not checked */
    SPAR_PHASE_CHECKED = 4  /* checked; to be solved again or accepted */
};
/* phase: out, SPAR_PHASE_* */
SPAR_API int spar_session_get_phase(const spar_session *session, int *phase);

/* ---- added mass -------------------------------------------------------------------------------------------------- */

/* An estimate of the fluid's added mass, for fluids that are heavy compared with the structure. spar adds it to the
   member's equations and corrects the pushed loads by the same mass times the acceleration. The converged solution,
   weight, energies, modes and statics do not contain it. With mass m and added mass m_a, iterations contract by
   |m_a - estimate| / (m + estimate) instead of m_a / m; an overestimate is safe there. Explicit coupling is stable
   while (m_a - estimate) / (m + estimate) is below 1, 1/3 or 1/7 for predictor order 0, 1 or 2. With explicit
   coupling an overestimate destabilises the structure's modes: when in doubt, underestimate. With substeps the
   answer differs by dt^2 from that without an estimate. Without INERTIA it has no effect. Before the commit.
   Default: none.
     n: in, stations of a beam, linear between, constant beyond; 1 for a rigid body; 0: none
     eta[n]: in, of a beam, strictly increasing in [0,1]; else ignored
     mass[n][36]: in, symmetric, positive semidefinite; of a beam per length in section axes, kg/m, kg, kg m; of a rigid
           body about its node in its own axes, kg, kg m, kg m^2
   SPAR_ERR_UNSUPPORTED: a point; at the commit: external and prescribed members. */
SPAR_API int spar_member_set_added_mass(spar_member *member, int64_t n, const double *eta, const double *mass);
/* n: out, stations, NULL: not wanted
   capacity: in, of the arrays; n is enough
   eta[capacity]: out, NULL: not wanted
   mass[capacity][36]: out, NULL: not wanted */
SPAR_API int spar_member_get_added_mass(const spar_member *member, int64_t *n, int64_t capacity, double *eta,
                                        double *mass);
/* What the added mass of a member's fluids responds to. */
enum {
    SPAR_RESPONSE_ACCELERATION = 0, /* the acceleration at t^{n+1}, as it is pulled */
    SPAR_RESPONSE_VELOCITY = 1      /* the change of the velocity over the step, as in flow solvers with moving walls */
};
/* Says what the fluid's added mass responds to, given or learned. The prediction of the loads depends on it, so
   explicit coupling with a heavy fluid needs the right one. The loads of all fluids on a member are predicted with
   one added mass, on all ranks alike: hence this belongs to the member. Steps with substeps take accelerations in
   any case.
     response: in, SPAR_RESPONSE_*, default SPAR_RESPONSE_ACCELERATION
   Local, before commit; the ranks must agree, which spar_member_commit checks. SPAR_ERR_UNSUPPORTED: a point. */
SPAR_API int spar_member_set_added_mass_response(spar_member *member, int response);
/* response: out. Local. */
SPAR_API int spar_member_get_added_mass_response(const spar_member *member, int *response);

/* ---- initial conditions and static solution with the fluid ------------------------------------------------------- */

/* Computes consistent initial accelerations and fluid loads at t = 0. Positions and velocities stay. Use it before the
   first step with a fluid that has added mass: without it the run is of first order in dt. solve is called as in
   spar_step, with dt = 0, and iterated by the session's scheme (explicit: by IQN-ILS). Added mass that was given has no
   part in it. Repeat the call after a change of loads or initial velocities. After a failure all is as it was.
   Collective, before the first step.
     dt: in, s, > 0, length of the first step; parts that it does not resolve get the accelerations of such a step
     solve: in, NULL: no fluid on this rank
     context: in, handed to solve
     iterations: out, calls of solve, also after a failure, NULL: not wanted
   SPAR_ERR_STATE: a step has been accepted; SPAR_ERR_NUMERIC: no convergence, or a singular mass. */
SPAR_API int spar_session_solve_initial(spar_session *session, double dt, spar_fluid_solver solve, void *context,
                                        int *iterations);
/* The same for a host with its own loop, in place of spar_step_begin before the first step: then spar_step_solve, pull,
   push, spar_step_check until done, spar_step_accept. The clock stays at t = 0. Collective.
     dt: in, s, > 0 */
SPAR_API int spar_step_begin_initial(spar_session *session, double dt);
/* Static equilibrium of all members with the fluid's loads at their deformed shape: the trim of a wing, a flag in
   steady flow. solve is called as in spar_step, with dt = 0, and iterated by the session's scheme until the loads agree
   (explicit: once). Each iteration solves the members as spar_member_solve_static does. Afterwards steps begin at rest
   from this state. Collective, between steps.
     load_steps: in, 1 to 100000, parts of the loads in the first iteration
     solve: in, NULL: no fluid on this rank; pushed loads stay
     context: in, handed to solve
     iterations: out, calls of solve, also after a failure, NULL: not wanted
   Points and external members stay, or move where solve puts them. The log is warned if Aitken or IQN-ILS found an
   equilibrium that a run would leave (static divergence). Failures as of spar_member_solve_static; SPAR_ERR_NUMERIC: no
   convergence in max_iterations. After a failure all is as it was. */
SPAR_API int spar_session_solve_static(spar_session *session, int load_steps, spar_fluid_solver solve, void *context,
                                       int *iterations);

/* ---- step-size control ------------------------------------------------------------------------------------------- */

/* Callback before a step of dt from t, where the library makes the steps: drive roots, set loads, save the fluid's
   state. It must not change settings, threads or steps (SPAR_ERR_STATE). Answer 0 for success; anything else ends the
   call with SPAR_ERR_USER. */
typedef int (*spar_before_step)(spar_session *session, double t, double dt, void *context);
/* Tolerance of the time integration. The local error of a step divided by dt, as a velocity (root mean square over the
   member's nodes, relative to a driven root), is kept below drift + rtol * (largest velocity so far). It is estimated
   from the change of acceleration. It does not accumulate over the run, and contains neither jumps of loads nor the
   error of explicit coupling (SPAR_REPORT_ERROR). Members without inertia, or moved by the host, have no error.
     drift: in, m/s, >= 0; 0 with rtol 0 (default): no tolerance
     rtol: in, 0 to 1; > 0 only with drift > 0; about the part of the amplitude lost in one radian of motion */
SPAR_API int spar_session_set_tolerance(spar_session *session, double drift, double rtol);
/* drift: out, NULL: not wanted
   rtol: out, NULL: not wanted */
SPAR_API int spar_session_get_tolerance(const spar_session *session, double *drift, double *rtol);
/* What step-size control says. Between solve and accept it is about the step in progress: reject the step if `reject`
   is 1, otherwise accept it. Then begin the next step with next_dt, or a smaller dt. Between steps it is about the last
   accepted step.
     ratio: out, error over tolerance, the largest of all members; 0 in a first step without
           spar_session_solve_initial, where the initial accelerations are not known, NULL: not wanted
     next_dt: out, s, dt of the next step, or of the next try if the step is rejected: 0.2 to 2 times this step's, by a
           PI controller. Small changes are not proposed, because they would only cost new tangents, NULL: not wanted
     reject: out, 1: the step in progress exceeds the tolerance, NULL: not wanted
     rejected: out, number of steps rejected so far because of their error, NULL: not wanted
   Local, the same on every rank. SPAR_ERR_STATE: no tolerance is set, or no step was solved since. */
SPAR_API int spar_session_get_step_control(const spar_session *session, double *ratio, double *next_dt, int *reject,
                                           int64_t *rejected);
/* Makes one step that keeps the tolerance: it tries dt, and smaller ones while the error is too large. before and solve
   are called again for the same t with another dt, so the fluid must be able to return to t^n. Collective.
     dt: in, s, to try; out, for the next step
     before: in, called before each try, on all ranks or none, NULL: nothing to do
     solve: in, as of spar_step
     context: in, handed to both
     taken: out, s, length of the accepted step, NULL: not wanted
   To meet a given time, pass the smaller of the two dt. After a failure the session is at t^n and dt is unchanged.
   SPAR_ERR_STATE: no tolerance; SPAR_ERR_NUMERIC: 12 tries failed, or 7 without progress; the message names the
   limit. */
SPAR_API int spar_step_adaptive(spar_session *session, double *dt, spar_before_step before, spar_fluid_solver solve,
                                void *context, double *taken);

/* ---- ranks and threads ------------------------------------------------------------------------------------------- */

/* Reproducible sums: nodal loads have the same bits for any number of ranks, any distribution and order of the fluid
   nodes, and any vector width. Choose them to compare runs on different numbers of ranks. They must be on before forces
   are pushed, for up to 2^28 force nodes of a member. docs/explanation/accuracy.md has the cost.
     on: in, 1 or 0 (default) */
SPAR_API int spar_session_set_reproducible(spar_session *session, int on);
/* on: out */
SPAR_API int spar_session_get_reproducible(const spar_session *session, int *on);
/* Threads of this rank, which share the work inside solve, map, pull and push. Results have the same bits with any
   number. Callbacks and MPI calls stay in the calling thread (MPI_THREAD_FUNNELED is enough). After a fork the
   child has one thread until it sets more. Between steps; ranks may differ.
     threads: in, 1 (default) to 64; at most cores / ranks
   SPAR_ERR_MEMORY: the system gives no more threads; all is as before. */
SPAR_API int spar_session_set_threads(spar_session *session, int threads);
/* threads: out */
SPAR_API int spar_session_get_threads(const spar_session *session, int *threads);
/* Chooses the rank that solves the member; it needs no fluid nodes. Default: at the first step members are assigned to
   the least loaded rank, most expensive first, by estimated cost. Connected members are solved by one rank.
     rank: in */
SPAR_API int spar_member_set_owner(spar_member *member, int rank);
/* rank: out, who solves the member, or would before the first step */
SPAR_API int spar_member_get_owner(const spar_member *member, int *rank);
/* How the work is distributed over the ranks. Collective; ranks may ask for different outputs.
     capacity: in, of the arrays; ranks is enough, their number; entries beyond are 0
     members[capacity]: out, members solved by each rank, NULL: not wanted
     expected[capacity]: out, estimated instructions per iteration, NULL: not wanted
     counted[capacity]: out, Newton's iterations so far, each weighed by what is expected of its member, without joints;
           NULL: not wanted */
SPAR_API int spar_session_sum_balance(const spar_session *session, int64_t capacity, int64_t *members, double *expected,
                                      double *counted);
/* Sums numbers over the ranks, for models built on the library; with n = 0 the ranks agree on a status. Collective,
   at any time.
     status: in, SPAR_OK, or this rank's failure: answered here; other ranks answer SPAR_ERR_PEER with its message
     n: in, the same on all ranks
     x[n]: in, this rank's; out, the sums, the same bits on all ranks; unchanged after a failure */
SPAR_API int spar_session_sum(spar_session *session, int status, int64_t n, double *x);

/* ---- failures outside the library -------------------------------------------------------------------------------- */

/* Writes the message of a failure outside this library, so that it is found where the library's own are: for a solver
   that is called by spar_step, and for libraries on top of this one. It goes to the log as SPAR_LOG_ERROR.
     session: in, NULL: the message of this thread
     status: in, a SPAR_ERR_*; SPAR_OK: the message alone is written, as by who restores an earlier one
     message: in, what, where, the cure; copied, at most 1023 characters; empty with SPAR_OK alone
   Local. SPAR_ERR_ARGUMENT: no status, or no message. */
SPAR_API int spar_session_fail(spar_session *session, int status, const char *message);

/* ---- fluids: description ----------------------------------------------------------------------------------------- */

/* All calls on fluids are local, but spar_fluid_sum_loads and spar_fluid_check_loads. */

/* member: out, the member of the fluid */
SPAR_API int spar_fluid_get_member(const spar_fluid *fluid, spar_member **member);
/* The name given at creation; "" for NULL. */
SPAR_API const char *spar_fluid_get_name(const spar_fluid *fluid);
/* Sets the motion nodes alone by their coordinate along the line. The force nodes stay: those of
   spar_fluid_set_force_nodes, or of spar_fluid_set_stations with the forces that are kept. For actuator lines that
   sample velocities at fewer or other stations than they spread forces from (AMR-Wind), or at three quarters of the
   chord. Call spar_fluid_map afterwards.
     n: in
     eta[n]: in, in [0,1], as of spar_fluid_set_stations
     offset[n][3]: in, m, as of spar_fluid_set_stations, NULL: 0
   Local. SPAR_ERR_ARGUMENT: eta lies outside [0,1]. */
SPAR_API int spar_fluid_set_motion_stations(spar_fluid *fluid, int64_t n, const double *eta, const double *offset);
/* Weights of the motion nodes, with which a whole mesh can follow the structure: 1 on the wetted surface, less with the
   distance, 0 where the mesh is fixed. A node at X that the section moves to x is pulled at X + w (x - X), with
   velocity w v and acceleration w a. Two fluids whose weights add to 1 blend the motion of two members. Loads are
   not weighed. Weights set after spar_fluid_fade_motion replace the fade: lever arms rotate at full length, and the
   volumes of the mesh are not watched. While there are weights, pulls of orientation, angular velocity and angular
   acceleration are SPAR_ERR_UNSUPPORTED. New motion nodes remove the weights. Not for stations (SPAR_ERR_STATE). Not
   saved.
     n: in, 0: no weights (default), else motion_nodes
     w[n]: in, in [0,1], NULL: none, with n = 0 */
SPAR_API int spar_fluid_set_motion_weights(spar_fluid *fluid, int64_t n, const double *w);
/* w[motion_nodes]: out, 1 without weights */
SPAR_API int spar_fluid_get_motion_weights(const spar_fluid *fluid, double *w);
/* Sets weights that decrease with a distance d. With s = (d - within) / (beyond - within) the weight is 1 for s <= 0
   and 0 for s >= 1. Between 1/6 and 5/6 it is 1.1 - 1.2 s, before 1 - 43.2 s^3 + 129.6 s^4, behind the mirror image.
   If d is the distance from the reference line, two things are added. The section's rotation acts on a limited lever
   arm: the true arm up to `within`, twice `within` from 3 times `within` on. And each pull computes the least Jacobian
   of the motion: it warns, once, when cells keep less than a fifth of their volume, and where they fold the pull is
   SPAR_ERR_NUMERIC. Far from the line they fold when a section has rotated by a right angle.
     within: in, m, must contain the body's section if the distance is that from the line
     beyond: in, m, > within, some 1.5 times as far from it as the member moves, or more
     n: in, motion_nodes
     distance[n]: in, m, NULL: from the reference line of the committed member
     held[n]: in, not 0: weight 0, NULL: none */
SPAR_API int spar_fluid_fade_motion(spar_fluid *fluid, double within, double beyond, int64_t n, const double *distance,
                                    const int *held);
/* Layout of the arrays [motion_nodes][3] or [force_nodes][3] of this rank: component i of node j stands at
   j * node + i * component. It holds for positions, velocities and accelerations pulled at motion nodes and for what is
   pushed or pulled at force nodes, in both precisions. Quaternions, matrices, nodes and getters stay packed. New nodes
   reset it. Not saved. Not for fluids of spar_aero.
     which: in, SPAR_NODES_*
     node: in, 1 to 2^40, numbers between neighbouring nodes
     component: in, 1 to 2^40: (3, 1) packed (default), (1, n) by component, (8, 1) in records of eight
   SPAR_ERR_ARGUMENT: two numbers would share a position. */
SPAR_API int spar_fluid_set_layout(spar_fluid *fluid, int which, int64_t node, int64_t component);
/* which: in, SPAR_NODES_*
   node: out, NULL: not wanted
   component: out, NULL: not wanted */
SPAR_API int spar_fluid_get_layout(const spar_fluid *fluid, int which, int64_t *node, int64_t *component);

/* Methods of projection. */
enum {
    SPAR_PROJECT_BOUNDED = 0, /* bounds on the squared distance: always the global minimum */
    SPAR_PROJECT_RPOLY = 1    /* all roots of the derivative of the squared distance; slow: a second opinion */
};
/* How nearest points are found by the next spar_fluid_map.
     method: in, SPAR_PROJECT_*, default bounded
     max_distance: in, m; nodes farther away get SPAR_MAP_FAR, or are refused (option far of the fluid); <= 0: no limit
           (default) */
SPAR_API int spar_fluid_set_projection(spar_fluid *fluid, int method, double max_distance);
/* method: out, NULL: not wanted
   max_distance: out, NULL: not wanted */
SPAR_API int spar_fluid_get_projection(const spar_fluid *fluid, int *method, double *max_distance);
/* Interpolation of rotations between the nodes of an element. Force, moment and power are conserved in both. */
enum {
    SPAR_INTERPOLATE_NODAL = 0,     /* (T4): normalised sum of quaternions, sums of velocities */
    SPAR_INTERPOLATE_CONSISTENT = 1 /* velocities are the exact derivatives of positions; moments the transpose */
};
/* kind: in, SPAR_INTERPOLATE_*, default nodal. Choose consistent if the fluid integrates velocities itself */
SPAR_API int spar_fluid_set_interpolation(spar_fluid *fluid, int kind);
/* kind: out */
SPAR_API int spar_fluid_get_interpolation(const spar_fluid *fluid, int *kind);
/* Options of a fluid, by name. Each concerns the nodes of this rank alone; ranks may differ.
     key: in
     value: in
   theta    average (default) | group: a pull at 0 < theta < 1 gives the average of the states at both ends (T12), or
            the motion of the member's nodes interpolated on the group. The average cuts the corner of a rotation
   far      take (default) | refuse: spar_fluid_map flags nodes beyond max_distance (spar_fluid_set_projection), or is
            SPAR_ERR_MAPPING
   audit    on (default) | off: whether a push computes the figures of spar_fluid_get_audit
   velocity pulled (default) | own: own: the fluid needs no velocities, or finds them from its moving mesh; there is no
            warning if positions are pulled and velocities are not
   ramp     0 (default) | seconds: all pushed forces and moments are multiplied by a factor that rises linearly from 0
            to 1 over this time, or falls from 1 to 0 over -ramp if it is negative. The product is what spar knows as
            the loads of the fluid, in sums and in spar_fluid_pull_forces too. Two fluids with ramps T and -T blend
            from one source of loads to another
   ramp.start 0 (default) | seconds: time of the session at which the ramp begins
   Local, between steps and not in a trial. SPAR_ERR_ARGUMENT: no such key or value; the message lists them. */
SPAR_API int spar_fluid_set_option(spar_fluid *fluid, const char *key, const char *value);
/* The value of an option, as a text that spar_fluid_set_option takes.
     key: in
     capacity: in, of the text with its end; 32 is enough
     text[capacity]: out
   Local. SPAR_ERR_ARGUMENT: no such key, or the capacity is too small. */
SPAR_API int spar_fluid_get_option(const spar_fluid *fluid, const char *key, int64_t capacity, char *text);

/* ---- fluids: the map --------------------------------------------------------------------------------------------- */

/* As spar_fluid_map, but positions that are new are those of the present configuration, of the member as
   spar_fluid_get_positions has it between steps: for a flow that meshes the deformed shape anew, or restarts from a
   deformed mesh. Each node gets the reference position that the present motion moves where it is; from then on it is as
   if that had been given. Stations mean what they mean to spar_fluid_map. Loads stay until the next push.

   Motion nodes with weights have no such position in general. A node that follows a section by a part w stands at
   X + w (x - X), so that several X may lead there, or none; and fading weights depend on X, which is wanted. The host
   gives reference positions of such a mesh, and spar_fluid_map: it moves its own mesh from them.
   SPAR_ERR_UNSUPPORTED: motion nodes with weights; SPAR_ERR_MAPPING: as of spar_fluid_map, or a node has no such
   reference position, because the member is folded there. */
SPAR_API int spar_fluid_map_current(spar_fluid *fluid);
/* which: in, SPAR_NODES_*
   n: out, nodes of the set on this rank */
SPAR_API int spar_fluid_get_count(const spar_fluid *fluid, int which, int64_t *n);
/* Properties of a set of nodes, to be combined with |. */
enum {
    SPAR_KIND_STATIONS = 1, /* given by eta, not by position */
    SPAR_KIND_SHARED = 2,   /* motion nodes and force nodes at once */
    SPAR_KIND_WEIGHTS = 4,  /* they have weights (spar_fluid_set_motion_weights) */
    SPAR_KIND_FORCES = 8    /* their forces are kept (SPAR_EFFECT_FLUID_HISTORY) and known */
};
/* which: in, SPAR_NODES_*
   kind: out, SPAR_KIND_* combined */
SPAR_API int spar_fluid_get_kind(const spar_fluid *fluid, int which, int *kind);
/* Flags of a mapped node. */
enum {
    SPAR_MAP_END = 1,       /* beyond an end of the line, which is its nearest point */
    SPAR_MAP_AMBIGUOUS = 2, /* two points are equally near; the first along the line is taken */
    SPAR_MAP_FAR = 4        /* farther than max_distance */
};
/* which: in, SPAR_NODES_*
   flag: in, one SPAR_MAP_*
   n: out, how many nodes of the set have it */
SPAR_API int spar_fluid_get_flag_count(const spar_fluid *fluid, int which, int flag, int64_t *n);
/* The nearest point of each node on the line, as spar_fluid_map has found it.
     which: in, SPAR_NODES_*
     eta[which_nodes]: out, of the nearest point, in [0,1]; 0.5 on a point or rigid body, NULL: not wanted
     distance[which_nodes]: out, m, from the nearest point to the node, NULL: not wanted
     flags[which_nodes]: out, SPAR_MAP_* or-ed, NULL: not wanted
   Local. SPAR_ERR_STATE: the nodes are not mapped. */
SPAR_API int spar_fluid_get_map(const spar_fluid *fluid, int which, double *eta, double *distance, int *flags);
/* The nearest points.
     which: in, SPAR_NODES_*
     x_map[which_nodes][3]: out, position in the reference configuration, m, NULL: not wanted
     q_map[which_nodes][4]: out, section frame there, NULL: not wanted
     con[which_nodes][3]: out, lever arm c of (T3), from the nearest point to the node, m, NULL: not wanted */
SPAR_API int spar_fluid_get_nearest(const spar_fluid *fluid, int which, double *x_map, double *q_map, double *con);
/* The interpolation at the nearest points.
     which: in, SPAR_NODES_*
     first_node[which_nodes]: out, node of the member at which the basis values begin, NULL: not wanted
     phi[which_nodes][P]: out, basis values, P the nodes per element; 1 on a point or rigid body, NULL: not wanted */
SPAR_API int spar_fluid_get_basis(const spar_fluid *fluid, int which, int64_t *first_node, double *phi);

/* ---- fluids: motion ---------------------------------------------------------------------------------------------- */

/* Largest displacement of this rank's motion nodes since t^n, in the latest iterate; 0 between steps.
     largest: out, m, NULL: not wanted
     node: out, which node, the first of equals, -1: there are none, NULL: not wanted */
SPAR_API int spar_fluid_get_travel(spar_fluid *fluid, double *largest, int64_t *node);
/* The nodes of one set at t^{n+1} in the latest iterate, between steps at t^n: for pictures and post-processing. A
   getter: it does not count as a pull, and a trial that switches effects off does not change it.
     which: in, SPAR_NODES_*
     x[which_nodes][3]: out, m, position, NULL: not wanted; nodes with weights follow in part, as in pulls
     q[which_nodes][4]: out, orientation of the section at the nearest point, scalar part >= 0, NULL: not wanted
     v[which_nodes][3]: out, m/s, NULL: not wanted
     nearest[which_nodes][3]: out, m, position of the nearest point on the line, NULL: not wanted
   Local. */
SPAR_API int spar_fluid_get_positions(const spar_fluid *fluid, int which, double *x, double *q, double *v,
                                      double *nearest);
/* Direction cosines of the sections, row by row. A Fortran array m(3,3,n) filled so holds the transpose. */
enum {
    SPAR_MATRIX_LOCAL_TO_GLOBAL = 0, /* columns are the section's axes */
    SPAR_MATRIX_GLOBAL_TO_LOCAL = 1  /* rows are the section's axes (OpenFAST's) */
};
/* Orientations of the motion nodes as matrices at t^n + theta dt.
     theta: in, in [0,1]
     convention: in, SPAR_MATRIX_*
     matrix[motion_nodes][9]: out */
SPAR_API int spar_fluid_pull_matrices(spar_fluid *fluid, double theta, int convention, double *matrix);
/* Compares a host's own matrices with those that spar_fluid_pull_matrices gives at t^{n+1}, to 1e-5. For start-up; it
   allocates.
     convention: in, SPAR_MATRIX_*
     matrix[motion_nodes][9]: in
   SPAR_ERR_ARGUMENT: they differ. The message names a transposed matrix, a determinant of -1, a matrix that is no
   rotation, or the angle between both. */
SPAR_API int spar_fluid_check_matrices(spar_fluid *fluid, int convention, const double *matrix);

/* ---- fluids: loads and states ------------------------------------------------------------------------------------ */

/* The fluid's own node forces at t^n + theta dt, for actuator lines. At t^{n+1} they are the pushed ones, or predicted
   before the first push of the step; 0 before the first push of all. As many stations given anew keep the forces of
   those before. For other nodes given anew the forces pushed first count at t^n too.
     theta: in, in [0,1]
     force[force_nodes][3]: out, N
   SPAR_ERR_STATE: they are not kept (SPAR_EFFECT_FLUID_HISTORY), or the nodes are new, the fluid has loads, and no
   forces of these nodes have been pushed yet. */
SPAR_API int spar_fluid_pull_forces(spar_fluid *fluid, double theta, double *force);
/* The same at t^{n+1} as a getter, for output.
     force[force_nodes][3]: out, N
   SPAR_ERR_STATE: they are not kept, or not known (SPAR_KIND_FORCES). */
SPAR_API int spar_fluid_get_forces(const spar_fluid *fluid, double *force);
/* Pushes loads of a fluid that makes several steps within dt: the mean loads over the part of the step that ends at
   t^n + theta dt. The loads in use at t^{n+1} are m + (e - e^n) / 2, (T13). m is the mean of the parts so far. e and
   e^n are the ends of the least-squares lines through the parts of this step and of the step before. This is of
   second order in dt and keeps the impulse. Use spar_fluid_push_forces for loads known at t^{n+1}. Not before the
   first step.
     theta: in, in (0, 1], increasing; a smaller one begins a new iteration
     force[force_nodes][3]: in, N
     moment[force_nodes][3]: in, N m, about each node, NULL: none */
SPAR_API int spar_fluid_push_forces_at(spar_fluid *fluid, double theta, const double *force, const double *moment);
/* States of the host's model at each force node: wakes, stall, friction. Pull returns the states at t^n. When the
   step is accepted, the states pushed last become the new t^n states; when it is rejected, they are discarded. They
   are saved, loaded (matched by position, on any ranks) and restored after trials. They are 0 at first and after a
   new map. Between steps.
     width: in, numbers per node, 0 to 1000, 0: none (default) */
SPAR_API int spar_fluid_set_states(spar_fluid *fluid, int64_t width);
/* width: out, numbers per node, NULL: not wanted
   dt: out, s, from the states that are pulled to those pushed now; 0 between steps and where time stands (static
           solution, initial conditions): push a steady state there; NULL: not wanted */
SPAR_API int spar_fluid_get_states(const spar_fluid *fluid, int64_t *width, double *dt);
/* width: in, as set
   states[force_nodes][width]: out, at t^n, by force node */
SPAR_API int spar_fluid_pull_states(const spar_fluid *fluid, int64_t width, double *states);
/* Without a push the states at t^n stay.
     width: in, as set
     states[force_nodes][width]: in, at t^{n+1}, or at t = 0 before the first step */
SPAR_API int spar_fluid_push_states(spar_fluid *fluid, int64_t width, const double *states);
/* The calls of each iteration for hosts in single precision. Numbers are converted on the way in and out; all sums
   are in double precision. Numbers beyond single precision are refused, SPAR_ERR_NUMERIC; arrays may then be partly
   written. spar_fluid_pull_motion:
     theta: in, in [0,1]
     x[motion_nodes][3]: out, m, NULL: not wanted
     v[motion_nodes][3]: out, m/s, NULL: not wanted */
SPAR_API int spar_fluid_pull_motion_f32(spar_fluid *fluid, double theta, float *x, float *v);
/* spar_fluid_pull_poses in single precision.
     which: in, SPAR_NODES_*
     theta: in, in [0,1]
     x[which_nodes][3]: out, m, NULL: not wanted
     q[which_nodes][4]: out, NULL: not wanted
     v[which_nodes][3]: out, m/s, NULL: not wanted
     omega[which_nodes][3]: out, rad/s, NULL: not wanted
     accel[which_nodes][3]: out, m/s^2, NULL: not wanted
     alpha[which_nodes][3]: out, rad/s^2, NULL: not wanted */
SPAR_API int spar_fluid_pull_poses_f32(spar_fluid *fluid, int which, double theta, float *x, float *q, float *v,
                                       float *omega, float *accel, float *alpha);
/* spar_fluid_pull_forces in single precision.
     theta: in, in [0,1]
     force[force_nodes][3]: out, N */
SPAR_API int spar_fluid_pull_forces_f32(spar_fluid *fluid, double theta, float *force);
/* spar_fluid_push_forces in single precision.
     force[force_nodes][3]: in, N
     moment[force_nodes][3]: in, N m, NULL: none */
SPAR_API int spar_fluid_push_forces_f32(spar_fluid *fluid, const float *force, const float *moment);
/* Figures of the last push. */
enum {
    SPAR_AUDIT_FORCE = 0,        /* magnitude of the sum of node forces, N */
    SPAR_AUDIT_MOMENT = 1,       /* of their moment about the origin, N m */
    SPAR_AUDIT_POWER = 2,        /* their power, W */
    SPAR_AUDIT_FORCE_ERROR = 3,  /* error of the force after the transfer, relative to the sum of magnitudes */
    SPAR_AUDIT_MOMENT_ERROR = 4, /* the same of the moment */
    SPAR_AUDIT_POWER_ERROR = 5,  /* the same of the power */
    SPAR_AUDIT_FARTHEST = 6,     /* largest distance of a node from the origin, m */
    SPAR_AUDIT_NODES = 7,        /* number of nodes */
    SPAR_AUDIT_COUNT = 8
};
/* Conservation of the last push.
     capacity: in
     audit[capacity]: out, by SPAR_AUDIT_* */
SPAR_API int spar_fluid_get_audit(const spar_fluid *fluid, int64_t capacity, double *audit);
/* Force and moment of the loads pushed last, on the structure where it is now, summed over all ranks. Each rank
   gives its own fluid of this name and member, one without nodes if it has none. Zero before the first push.
   Collective, but not in a fluid solver that the library calls (SPAR_ERR_STATE).
     point[3]: in, m, global, reference of the moment, NULL: the origin
     force[3]: out, N, NULL: not wanted
     moment[3]: out, N m, NULL: not wanted */
SPAR_API int spar_fluid_sum_loads(const spar_fluid *fluid, const double point[3], double force[3], double moment[3]);
/* Compares these sums with the host's own: finds force nodes at rank borders that were pushed twice or not at all.
   Collective, as spar_fluid_sum_loads, with the same values on every rank.
     point[3]: in, m, NULL: the origin
     force[3]: in, N, the host's total over all ranks
     moment[3]: in, N m, NULL: not compared
     rtol: in, > 0, allowed difference relative to the sum of the magnitudes of all nodal loads
   SPAR_ERR_ARGUMENT: they differ; the message says by how much. */
SPAR_API int spar_fluid_check_loads(const spar_fluid *fluid, const double point[3], const double force[3],
                                    const double moment[3], double rtol);

#ifdef __cplusplus
}
#endif

#endif
