/* spar_coupling.h: how steps are taken and coupled, and what fluids can have beside the basics of spar.h. The conventions are
   those of spar.h. */
#ifndef SPAR_COUPLING_H
#define SPAR_COUPLING_H

#include <spar/spar.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ---- time integration ---------------------------------------------------------------------------------------------- */

/* Generalised-alpha on the Lie group (Bruels, Cardona, Arnold 2012) while dt stays the same within 0.1 %. Steps of
   another length, and the one after them, are taken by TR-BDF2: two solutions with one tangent. dt may grow or shrink
   by any factor from step to step. What a step does not resolve is damped and feeds nothing. A substep without a
   solution, or whose solution gains energy that no load gives, is cut inside, down to 1/1024 of it (SPAR_ERR_NUMERIC).
     rho_inf: in, spectral radius of generalised-alpha at infinite frequency, in [0,1]; 1 keeps all, 0 damps most and
           has 5.4 times the error of dt that 0.9 has; default 0.9. An exact beam that spins at Omega without a driven
           root is taken by TR-BDF2 where 1 - rho_inf < 1.5 Omega dt
     substeps: in, structural steps per coupling step, >= 1, with loads interpolated linearly between t^n and t^{n+1};
           default 1. More than one: fluids pull means of accelerations (spar_fluid_pull_poses)
   SPAR_ERR_MEMORY: all is as before. */
SPAR_API int spar_session_set_integrator(spar_session *session, double rho_inf, int substeps);
SPAR_API int spar_session_get_integrator(const spar_session *session, double *rho_inf, int *substeps);
/* Tolerances of Newton's iteration. It stops when the estimated remaining correction is below atol + rtol times its
   scale: lengths relative to the member's length, rotations to 1. Static solutions always use these tolerances. Steps
   use them alone if the option newton.stop is strict. By default (balanced) a step's iteration may stop earlier, when
   its error is negligible compared with the time-step error and the coupling tolerance (docs/accuracy.md).
     atol, rtol: in, >= 0; defaults 1e-15, 1e-12
     max_iterations: in, >= 1, past which the answer is SPAR_ERR_NUMERIC; default 50 */
SPAR_API int spar_session_set_newton(spar_session *session, double atol, double rtol, int max_iterations);
SPAR_API int spar_session_get_newton(const spar_session *session, double *atol, double *rtol, int *max_iterations);
/* What Newton's iteration of a member takes and leaves, as the rank that solves it knows (spar_member_get_owner); zeros
   on the others, and of what is not solved by iteration. Each NULL: not wanted. Local.
     iterations: out, so far, since it was committed or made anew
     left: out, estimate of what the last solution in time left of the increments: of the member's length, or rad; of
           members that joints tie the largest of all */
SPAR_API int spar_member_get_iterations(const spar_member *member, int64_t *iterations, double *left);
/* Polynomial the loads are extrapolated with to t^{n+1} in part 1 of a step; no farther than ten times the last step,
   so that a much longer one does not start from its rounding. As many loads are kept as it needs: the first step uses
   0, the second 1 at most, and so do those after the order has been raised.
     order: in, 0, 1 (default, (T11)) or 2
   SPAR_ERR_MEMORY: the order is as before. */
SPAR_API int spar_session_set_predictor(spar_session *session, int order);
SPAR_API int spar_session_get_predictor(const spar_session *session, int *order);

/* ---- coupling ------------------------------------------------------------------------------------------------------ */

/* omega: in, part of the change of loads that is taken in an iteration, in (0,2]; default 1. */
SPAR_API int spar_session_set_relaxation(spar_session *session, double omega);
SPAR_API int spar_session_get_relaxation(const spar_session *session, double *omega);
/* All other settings, by name and text. key, value: in.
     newton.stop            balanced (default) | strict: where Newton's iteration of a step stops. Strict: at the
                            tolerances of spar_session_set_newton, for bitwise comparison of runs. Balanced: when its
                            error is a thousandth of the time-step error, (E4) of docs/theory.md, and of the coupling
                            tolerance, between rtol and 1e-7 of the increments. Where the time-step error is unknown
                            (first step, at rest, without inertia) balanced is strict
     coupling.unconverged   error (default) | accept: what spar_step_check does after max_iterations
     coupling.patience      1 to 1000000, default 3: with coupling.unconverged = accept, so many steps on end that have
                            not converged are an error all the same; each is told to the log
     coupling.norm          motion (default) | loads: what the stop test, Aitken's factor and the columns of IQN-ILS
                            weigh loads by: the motion that the structure answers them with in the step, so that a load
                            that moves nothing (drag on a stiff direction) counts nothing; or the loads themselves.
                            Members that joints tie answer together. With a member whose motion the host gives (points,
                            external), or a tied one with INERTIA off, it is loads in any case
     coupling.estimate      off (default) | on: explicit: spar_step_check also finds what another iteration would have
                            moved, SPAR_REPORT_MOTION_ERROR, by one back-substitution and no solution of the fluid: to
                            first order, of members that joints tie with all that they are tied to. Members whose
                            motion the host gives (points, external) count 0, and hold what is tied to them where it is:
                            how they would answer the loads they missed (pushed less those of spar_member_get_loads
                            before the check) is for the host's structure to say
     coupling.columns       1 to 10000, default 30: IQN-ILS, the most difference columns
     coupling.reuse         0 to 10000, default 5: IQN-ILS, accepted steps whose columns serve again
     coupling.filter        0 to 0.5, default 1e-4: IQN-ILS, part of a column that newer ones must not contain already
     coupling.motion_atol   >= 0, in m, default 0, and
     coupling.motion_rtol   0 to 1, default 0: if one is set, the iteration also goes on until the nodes move from one
                            iteration to the next by no more than atol + rtol times their way since t^n (root of the
                            sum of squares; turns count times the member's length)
     advise.dt, advise.nodes, advise.fidelity, advise.coupling
                            vary (default) | keep: what spar_session_advise may propose to change; with nodes go
                            elements
     advise.limit           >= 0, default 0 (none): what asking for advice may cost, counted, in trials with the session
                            as it is; SPAR_ERR_LIMIT where there is no advice by then
     advise.fluid_cost      >= 0, in s of processor time, all ranks, default 0: what a solution of the fluid costs. 0:
                            what its nodes lead one to expect; where those of the first run take more than
                            thirty times that, their time in powers of 900 of it */
SPAR_API int spar_session_set_option(spar_session *session, const char *key, const char *value);
/* The value of an option as a text that spar_session_set_option takes.
     key: in
     capacity: in, of the text, its end included; 32 is always enough, SPAR_ERR_ARGUMENT if it is too little
     text[capacity]: out */
SPAR_API int spar_session_get_option(const spar_session *session, const char *key, int64_t capacity, char *text);
/* The iterations of the step under way, or else of the last step or static solution; the same on all ranks. Local.
     iterations: out, how many there were, which may be more than the capacity
     capacity: in, of the two arrays; max_iterations of spar_session_set_coupling is always enough
     residual[capacity], size[capacity]: out, by iteration, the change of the loads and the loads, N: root of the sum of
           squares over all nodes of forces, and of moments divided by the member's length; 0 behind the last. Where
           loads are weighed by motion the change is the part of their size that it is of their motion; IQN-ILS takes
           it against what a fluid that answers in parts will have settled to
   Each NULL: not wanted. */
SPAR_API int spar_session_get_iterations(const spar_session *session, int *iterations, int64_t capacity,
                                         double *residual, double *size);
/* The last of them. residual, size: out, N, 0 before the first iteration, NULL: not wanted. Local. */
SPAR_API int spar_session_get_residual(const spar_session *session, double *residual, double *size);
/* Entries of the report of the coupling, spar_session_get_report. */
enum {
    SPAR_REPORT_CONTRACTION = 0, /* mean factor by which an iteration shrinks the residual; 0 after one iteration */
    SPAR_REPORT_ADDED_MASS = 1,  /* iterated only: (added mass) / (mass), as loads come back, in the directions iterated
                                    in, over this step and, fading, those before; 0: too few differences to tell */
    SPAR_REPORT_COLUMNS = 2,     /* IQN-ILS: columns in the last least-squares problem */
    SPAR_REPORT_DROPPED = 3,     /* IQN-ILS: nearly dependent columns filtered out in this step */
    SPAR_REPORT_ERROR = 4,       /* last accepted step: |final loads - predicted loads| / |final loads| */
    SPAR_REPORT_WORK_DEFECT = 5, /* last accepted step: work the fluid gave less the work the structure took, [J] */
    SPAR_REPORT_UNCONVERGED = 6, /* steps so far whose iteration ended at its limit (coupling.unconverged = accept) */
    SPAR_REPORT_ADDED_MASS_SPREAD = 7, /* standard deviation of SPAR_REPORT_ADDED_MASS, of a single difference */
    SPAR_REPORT_MOTION_ERROR = 8, /* explicit, option coupling.estimate: how far the loads pushed, in place of those
                                     predicted, would have moved the farthest node in this step, [m]; nodes that the
                                     host moves count 0 */
    SPAR_REPORT_COUNT = 9
};
/* What the coupling says of itself; the same on all ranks. report[capacity]: out, by SPAR_REPORT_*, NULL: not wanted.
   Local. */
SPAR_API int spar_session_get_report(const spar_session *session, int64_t capacity, double *report);
/* Where a step, or a static solution with the fluid, stands. */
enum {
    SPAR_PHASE_START = 0,   /* no step has begun yet; loads are those at t = 0 */
    SPAR_PHASE_BETWEEN = 1, /* between steps */
    SPAR_PHASE_BEGUN = 2,   /* begun and not solved */
    SPAR_PHASE_SOLVED = 3,  /* solved and not checked */
    SPAR_PHASE_CHECKED = 4  /* checked, to be solved again or accepted */
};
/* phase: out, SPAR_PHASE_*, NULL: not wanted. Local. */
SPAR_API int spar_session_get_phase(const spar_session *session, int *phase);

/* ---- added mass ---------------------------------------------------------------------------------------------------- */

/* What the host knows, or guesses, of the fluid's added mass, for a fluid that is heavy against the structure. It
   stands in the member's equations beside its own mass, and the loads that fluids push are corrected by as much at
   the acceleration that they answer to, so that it has no part in the converged answer, in weight, energies, modes,
   statics or reactions. With mass m and the fluid's m_a iterations contract by |m_a - guess| / (m + guess) in place of
   m_a / m, so that a guess too large is safe. Explicit coupling bears (m_a - guess) / (m + guess) below 1, 1/3 and 1/7
   with a predictor of order 0, 1, 2; there a guess too large feeds the structure's modes, one too small damps them
   (docs/theory.md): give rather too little, and order 0 where it is known to a half only. What the coupling reports of
   an added mass is the same ratio. What explicit coupling leaves is told as always (SPAR_REPORT_WORK_DEFECT); the loads
   of spar_member_get_loads within a step are those that move the structure. With substeps the part of the loads that
   the guess accounts for follows the acceleration of each: the answer differs by dt^2 from that without a guess, as do
   the velocities of members that joints tie. With INERTIA off it does nothing. Default: none, which costs nothing.
   Before commit; replaces an earlier one. Local.
     n: in, stations of a beam, linear in eta between them and constant beyond; 1 of a rigid body; 0: no guess
     eta[n]: in, of a beam, strictly increasing in [0,1]; else not looked at
     mass[n][36]: in, symmetric and positive semidefinite; it turns with the member. Of a beam per length, in section
           axes: kg/m, kg, kg m; of a rigid body about its node, in its own axes: kg, kg m, kg m^2
   SPAR_ERR_UNSUPPORTED: a point; at commit: external or prescribed, which move as they are told. */
SPAR_API int spar_member_set_added_mass(spar_member *member, int64_t n, const double *eta, const double *mass);
/* The guess that was given. n: out, stations, NULL: not wanted; capacity: in, of the arrays; eta[capacity],
   mass[capacity][36]: out, 0 behind the last, NULL: not wanted. Local. */
SPAR_API int spar_member_get_added_mass(const spar_member *member, int64_t *n, int64_t capacity, double *eta,
                                        double *mass);
/* What the added mass of a member's fluids responds to. */
enum {
    SPAR_RESPONSE_ACCELERATION = 0, /* the acceleration at t^{n+1}, as it is pulled */
    SPAR_RESPONSE_VELOCITY = 1      /* the change of the velocity over the step, as in flow solvers with moving walls */
};
/* Says what the fluid's added mass responds to, given or learned. The prediction of the loads depends on it, so explicit
   coupling with a heavy fluid needs the right one. The loads of all fluids on a member are predicted with one added
   mass, on all ranks alike: hence this belongs to the member. Steps with substeps take accelerations in any case.
     response: in, SPAR_RESPONSE_*, default SPAR_RESPONSE_ACCELERATION
   Local, before commit; the ranks must agree, which spar_member_commit checks. SPAR_ERR_UNSUPPORTED: a point. */
SPAR_API int spar_member_set_added_mass_response(spar_member *member, int response);
/* response: out. Local. */
SPAR_API int spar_member_get_added_mass_response(const spar_member *member, int *response);

/* ---- initial conditions and statics -------------------------------------------------------------------------------- */

/* The balanced start: accelerations at t = 0 of all members, and the fluid's loads there that answer to them. Places
   and velocities stay. A fluid that has an added mass gives loads by accelerations, and these follow from the loads:
   pushed for the accelerations of 0 that there are before a run, or not at all, loads at t = 0 make it first order in
   dt; after this call it is second order from the first step on. The fluid solver is called as in spar_step, iterated
   by the session's coupling scheme (explicit: by IQN-ILS) until the loads agree within its tolerances, weighed by
   themselves. From then on the accelerations are those that fluids pull and spar_member_get_motion gives, the loads
   those at t^n, and joints carry theirs. Loads pushed between this and the first step take the place of those found.
     dt: in, s, > 0, that of the first step: parts so light or stiff that it does not resolve their motion get the
           accelerations that such a step gives them
     solve: in, NULL: no fluid on this rank, loads pushed stay. In it t is the clock, dt 0 and iteration from 0; pulls
           give the motion at t = 0 at any theta, and the host finds its loads in the flow as it stands. What it may not
           call in a step it may not call here
     context: in, handed to solve
     iterations: out, calls of solve on each rank, also after a failure; NULL: not wanted
   The place and velocity of a point or an external member are those that it has; its acceleration is what
   spar_member_set_motion gave before, or gives in solve (under spar_member_get_loads, which have the joints' loads in
   them). A guess of the added mass (spar_member_set_added_mass) has no part in it. Before the first step, again after
   what changes the state there (loads kept, initial velocities). After a failure all is as it was. Collective.
   SPAR_ERR_STATE: the clock has run; SPAR_ERR_NUMERIC: no convergence in max_iterations, or the mass is singular. */
SPAR_API int spar_session_solve_initial(spar_session *session, double dt, spar_fluid_solver solve, void *context,
                                int *iterations);
/* Its beginning, for a host whose own loop runs the fluid: in place of spar_step_begin, before the first step. Then as
   in a step: spar_step_solve finds the accelerations under the loads in use, pull, push, spar_step_check, until it is
   done; spar_step_accept ends it, with the clock at t = 0 still, or spar_step_reject. dt: in, s, > 0. */
SPAR_API int spar_step_begin_initial(spar_session *session, double dt);
/* Static equilibrium of all members with the fluid's answer: the shape under gravity, all kept loads and the loads that
   the fluid has on that shape (a wing's trim, a flag in steady flow). The fluid solver is called as in spar_step, and
   iterated by the session's coupling scheme until the loads agree within its tolerances; explicit: it is called once.
   Each iteration begins with the members' static solutions, as spar_member_solve_static makes them; the last one is
   under the loads that came last, so that shape and loads are in balance to rounding. From then on these are the motion
   and the loads at t^n: steps begin at rest, and with loads extrapolated from there on. What is extrapolated, and what
   IQN-ILS has learned in earlier steps, is forgotten.
     load_steps: in, 1 to 100000, parts that the loads of the first iteration come on in
     solve: in, NULL: no fluid on this rank, loads pushed stay. In it t is the clock, dt 0 and iteration from 0; pulls
       give the shape at any theta; it settles its flow around it. What it may not call in a step it may not call here
     context: in, handed to solve
     iterations: out, calls of solve on each rank, also after a failure; NULL: not wanted
   Points and external members stand where they are, or where solve puts them (spar_member_set_motion), which finds an
   external member's equilibrium under spar_member_get_loads; rigid and prescribed ones as spar_member_solve_static has
   them. spar_session_get_iterations and _get_report tell of its iterations; the option coupling.unconverged does not
   matter here. A log is warned where Aitken or IQN-ILS has found an equilibrium beyond static divergence, which a run
   leaves. Between steps or before the first one. Collective. SPAR_ERR_STATE: nothing holds a member; SPAR_ERR_NUMERIC:
   no equilibrium of a member, or none with the fluid in max_iterations: the message names the member whose loads change
   most, and says whether and how fast they grow. */
SPAR_API int spar_session_solve_static(spar_session *session, int load_steps, spar_fluid_solver solve, void *context,
                                       int *iterations);

/* ---- step-size control --------------------------------------------------------------------------------------------- */

/* What a host does ahead of a step of dt from t, where the library makes the steps (spar_step_adaptive, trials): drive
   roots, set loads, keep what its fluid had at t^n. Answer 0 for success; anything else ends the call with
   SPAR_ERR_USER. */
typedef int (*spar_before_step)(spar_session *session, double t, double dt, void *context);
/* Steps to a tolerance: dt is chosen step by step, by what the time integration of the members adds to the error of
   their motion in each step, as the accelerations at its ends show it: the error of the step by itself, not that of the
   run, in which those of many steps add up or cancel. Loads that change in jumps within a step, and what explicit
   coupling leaves (SPAR_REPORT_ERROR, SPAR_REPORT_MOTION_ERROR), are not in it. A member's error in a step over dt, the
   speed at which the computed motion drifts from the true one (root of the mean square over its nodes, seen from a
   driven root), is to be at most
           drift + rtol * (the largest speed of its nodes so far, likewise),
   where rtol is about the part of the amplitude that is lost in a radian of the motion. Members whose motion the host
   gives, and those without inertia, have none. Alike on all ranks; between steps.
     drift: in, m/s, >= 0; 0 with rtol 0 (default): no tolerance, nothing is found or kept; out
     rtol: in, 0 to 1, > 0 only with a drift > 0, as what begins at rest has no speed; out */
SPAR_API int spar_session_set_tolerance(spar_session *session, double drift, double rtol);
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
/* One step that keeps the tolerance: tried with dt, and again with a smaller one while its error is too large. For
   fluids that can go back to t^n: before and solve are called again with another dt, for the same t.
     dt: in, s, to try with; out, to go on with
     before: in, called ahead of each try, on all ranks or on none; NULL: nothing to do
     solve, context: in, as of spar_step; context goes to before too
     taken: out, s, of the step that was accepted, NULL: not wanted
   A host that has to meet a time (of output, of a given dt) gives the smaller of the two. Collective. SPAR_ERR_STATE:
   no tolerance. SPAR_ERR_NUMERIC: 12 tries did not keep it, or 7 in turn whose error did not fall. The message says what
   limits it: the motion, a velocity that jumps, or rounding. After a failure the session is at t^n, dt as it was given.
 */
SPAR_API int spar_step_adaptive(spar_session *session, double *dt, spar_before_step before, spar_fluid_solver solve,
                              void *context, double *taken);

/* ---- ranks and threads --------------------------------------------------------------------------------------------- */

/* on: in, 1: nodal loads come out the same to the last bit however many ranks there are, however the fluid nodes are
   spread over them and over fluids, in whatever order they are given and whatever vectors the processor has; 0
   (default): to rounding. A run that is saved and goes on with other ranks stays the same too, if it is on in both. It
   has to be on when forces are pushed; with up to 2^28 force nodes of a member, rounding to the nearest, and what the
   host pushes for a node independent of the ranks. What it costs: docs/accuracy.md. */
SPAR_API int spar_session_set_reproducible(spar_session *session, int on);
SPAR_API int spar_session_get_reproducible(const spar_session *session, int *on);
/* Threads of this rank, the calling one with them, which work together inside the calls that solve (members and
   assemblies at once; of a single long beam its elements), map, pull and push (nodes, from some thousands on). The bits
   are the same with any number; with reproducible sums the nodes are summed by one. None is made unless asked for, and
   none but the calling one ever runs code of the host, or talks to other ranks: MPI_THREAD_FUNNELED is enough.
   Between calls the others sleep. They are counted in a host's plans: ranks times threads should be no more than there
   are cores. A child of the process (fork) has the sessions of one rank, each with one thread until it asks for more.
   Local, between steps; ranks may differ.
     threads: in, 1 (default) to 64; out
   SPAR_ERR_MEMORY: the system gives no more threads, or there is no work space for them; all is as before. */
SPAR_API int spar_session_set_threads(spar_session *session, int threads);
SPAR_API int spar_session_get_threads(const spar_session *session, int *threads);
/* rank: in, who solves the member; it needs no fluid nodes. Default: at the first step or static solution members go to
   the rank that has least to do by then, the dearest first, by what nodes, fidelity and joints lead one to expect
   (spar_session_sum_balance); those that joints tie are solved by one rank, and an owner given here is that of all of
   them. Local. */
SPAR_API int spar_member_set_owner(spar_member *member, int rank);
/* rank: out, who solves it; before the first step, or static solution, who would. Local. */
SPAR_API int spar_member_get_owner(const spar_member *member, int *rank);
/* Who solves how much, by rank (spar_member_set_owner). Collective; ranks may want different things of it.
     capacity: in, of the arrays; as many as there are ranks are filled, 0 behind them
     members[capacity]: out, how many members each rank solves
     expected[capacity]: out, what an iteration of all of these is expected to take, instructions, by nodes,
           fidelity and joints: owners are spread by it
     counted[capacity]: out, what solving them has taken since they were made, instructions, by counted iterations
           and tangents at the prices of advice; of joints it has nothing
   Each NULL: not wanted. */
SPAR_API int spar_session_sum_balance(const spar_session *session, int64_t capacity, int64_t *members, double *expected,
                                      double *counted);
/* Sums numbers over the ranks of the session, so that what is built on one (a blade element model, a load report) needs
   no MPI of its own; with n = 0 the ranks agree on a status. At any time. Collective.
     status: in, SPAR_OK, or what this rank has failed with: it is answered here, and the others answer SPAR_ERR_PEER
           with this rank's spar_session_message; the numbers then stay as they are
     n: in, how many, the same on all ranks
     x[n]: in, this rank's; out, the sums, the same bits on all ranks */
SPAR_API int spar_session_sum(spar_session *session, int status, int64_t n, double *x);

/* ---- fluids: nodes and maps ---------------------------------------------------------------------------------------- */

/* ---- fluids ------------------------------------------------------------------------------------------------------ */

enum {
    SPAR_PROJECT_BOUNDED = 0, /* nearest point by bounds on the squared distance: always the global one */
    SPAR_PROJECT_RPOLY = 1    /* all roots of the derivative of the squared distance, by Jenkins and Traub */
};

/* How rotations are interpolated between the nodes of an element. Force, moment and power are conserved in both. */
enum {
    SPAR_INTERPOLATE_NODAL = 0,     /* (T4): normalised sum of quaternions, sums of velocities */
    SPAR_INTERPOLATE_CONSISTENT = 1 /* the same places; velocities are their exact derivative, moments the transpose */
};
/* Flags of a mapped node. */
enum {
    SPAR_MAP_END = 1,       /* it lies beyond an end of the line, which is its foot */
    SPAR_MAP_AMBIGUOUS = 2, /* two places are equally near: smallest eta taken */
    SPAR_MAP_FAR = 4        /* farther than max_distance */
};
/* member: out, that the fluid was created for. */
SPAR_API int spar_fluid_get_member(const spar_fluid *fluid, spar_member **member);
/* The name it was created with, as long as it lives; "" of NULL. */
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
/* How much of the section's motion each motion node takes, so that a fluid's whole mesh can move with the structure,
   a function of its motion alone, without memory or solution: 1 on the wetted surface, less with the distance, 0 where
   the mesh is held. A node with reference place X that the section takes to x, at v and acceleration a, is pulled at
   X + w (x - X), w v, w a, in every pull and in spar_fluid_get_travel; 1 gives the same bits as without weights, 0
   stays at X. Two fluids whose weights add to 1 at each node blend two members' motions (a blade's into its hub's rigid
   one): X + (x_1 - X) + (x_2 - X). Part of a rotation has no section frame: pulls of q, omega, alpha and matrices are
   refused (SPAR_ERR_UNSUPPORTED) as long as there are weights. Loads are not weighed; force nodes belong on what has
   weight 1. Given between spar_fluid_set_motion_nodes, which takes them away, and spar_fluid_map they hold the host's
   places to the bit; after the map, to rounding. Not saved with a session, as nodes are not; a trial keeps them. Not
   for sections (SPAR_ERR_STATE). n: in, as many as motion nodes w[n]: in, in [0,1]. n = 0 and NULL: no weights
   (default) */
SPAR_API int spar_fluid_set_motion_weights(spar_fluid *fluid, int64_t n, const double *w);
/* w[n]: out, 1 where none were given. */
SPAR_API int spar_fluid_get_motion_weights(const spar_fluid *fluid, double *w);
/* Sets weights that fade with a distance d: with s = (d - within) / (beyond - within) 1 for s <= 0, 0 for s >= 1 and
   1 - 10 s^3 + 15 s^4 - 6 s^5 between, twice differentiable everywhere. Nothing is searched over ranks: distances are
   the host's, from the wetted surface (a solver's wall distance) or along whatever it wants to fade, or from the
   reference line, which every rank knows. From the line `within` must cover the body's own section, and the curve's
   least radius be larger than `beyond`: farther off two feet can be equally near, and the mesh tears between them.
     within, beyond: in, m, within < beyond
     n: in, as many as motion nodes
     distance[n]: in, m, NULL: from the reference line (the member must be committed)
     held[n]: in, not 0: weight 0 whatever the distance, NULL: none */
SPAR_API int spar_fluid_fade_motion(spar_fluid *fluid, double within, double beyond, int64_t n, const double *distance,
                                    const int *held);
/* Where this rank's arrays [n][3] have their numbers, for hosts that keep structures of arrays or wider records:
   component i of node j at number j * node + i * component. Holds for what is pulled at motion nodes (places,
   velocities, accelerations, angular ones) or pushed to and pulled at force nodes (forces, moments, their places), in
   double and single precision; what lies between is not touched. Quaternions, matrices, nodes as they are set and what
   getters give stay packed. Allowed between calls at any time but in a trial; goes when nodes of the set are set anew.
   Not saved. Fluids of spar_aero stay packed.
     which: in, SPAR_NODES_*; of sections that serve both, each has its own
     node, component: in, numbers between neighbours, 1 to 2^40: (3, 1) packed (default), (1, n) by component, (8, 1) in
           records of eight. SPAR_ERR_ARGUMENT: two numbers would share a place */
SPAR_API int spar_fluid_set_layout(spar_fluid *fluid, int which, int64_t node, int64_t component);
/* node, component: out, NULL: not wanted. */
SPAR_API int spar_fluid_get_layout(const spar_fluid *fluid, int which, int64_t *node, int64_t *component);
/* How feet are found, for the next spar_fluid_map.
     method: in, SPAR_PROJECT_*, default bounded
     max_distance: in, m, beyond which a node is flagged SPAR_MAP_FAR (and refused under the option far = refuse);
           <= 0: no limit (default) */
SPAR_API int spar_fluid_set_projection(spar_fluid *fluid, int method, double max_distance);
/* method, max_distance: out, NULL: not wanted. */
SPAR_API int spar_fluid_get_projection(const spar_fluid *fluid, int *method, double *max_distance);
/* Options of a fluid, by name. Each concerns the nodes of this rank alone; ranks may differ.
     key: in
     value: in
   theta    average (default) | group: a pull at 0 < theta < 1 gives the average of the states at both ends (T12), or the
            motion of the member's nodes interpolated on the group. The average cuts the corner of a rotation
   far      take (default) | refuse: spar_fluid_map flags nodes beyond max_distance (spar_fluid_set_projection), or is
            SPAR_ERR_MAPPING
   audit    on (default) | off: whether a push computes the figures of spar_fluid_get_audit
   Local, between steps and not in a trial. SPAR_ERR_ARGUMENT: no such key or value; the message lists them. */
SPAR_API int spar_fluid_set_option(spar_fluid *fluid, const char *key, const char *value);
/* The value of an option, as a text that spar_fluid_set_option takes.
     key: in
     capacity: in, of the text with its end; 32 is always enough
     text[capacity]: out
   Local. SPAR_ERR_ARGUMENT: no such key, or the capacity is too small. */
SPAR_API int spar_fluid_get_option(const spar_fluid *fluid, const char *key, int64_t capacity, char *text);
/* kind: in, SPAR_INTERPOLATE_*, default nodal. */
SPAR_API int spar_fluid_set_interpolation(spar_fluid *fluid, int kind);
/* kind: out. */
SPAR_API int spar_fluid_get_interpolation(const spar_fluid *fluid, int *kind);
/* which: in, SPAR_NODES_*; n: out, its nodes on this rank. */
SPAR_API int spar_fluid_get_count(const spar_fluid *fluid, int which, int64_t *n);
/* What the nodes of a set are. */
enum {
    SPAR_KIND_STATIONS = 1, /* given by coordinate along the line, not by place */
    SPAR_KIND_SHARED = 2,   /* they are motion nodes and force nodes at once */
    SPAR_KIND_WEIGHTS = 4,  /* they take part of the motion (spar_fluid_set_motion_weights) */
    SPAR_KIND_FORCES = 8    /* their node forces are kept (SPAR_EFFECT_FLUID_HISTORY) */
};
/* which: in, SPAR_NODES_*; kind: out, SPAR_KIND_* or-ed. */
SPAR_API int spar_fluid_get_kind(const spar_fluid *fluid, int which, int *kind);
/* flag: in, one SPAR_MAP_*; n: out, how many mapped nodes of the set bear it. */
SPAR_API int spar_fluid_get_flag_count(const spar_fluid *fluid, int which, int flag, int64_t *n);
/* The nearest point of each node on the line, as spar_fluid_map has found it.
     which: in, SPAR_NODES_*
     eta[n]: out, of the nearest point, in [0,1]; 0.5 on a point or rigid body, NULL: not wanted
     distance[n]: out, m, from the nearest point to the node, NULL: not wanted
     flags[n]: out, SPAR_MAP_* or-ed, NULL: not wanted
   Local. SPAR_ERR_STATE: the nodes are not mapped. */
SPAR_API int spar_fluid_get_map(const spar_fluid *fluid, int which, double *eta, double *distance, int *flags);
/* The feet. Each NULL: not wanted.
     x_map[n][3]: out, foot in the reference configuration, m
     q_map[n][4]: out, its section frame
     con[n][3]: out, from the foot to the node, the arm c of (T3), m */
SPAR_API int spar_fluid_get_feet(const spar_fluid *fluid, int which, double *x_map, double *q_map, double *con);
/* The interpolation behind the map. Each NULL: not wanted.
     first_node[n]: out, node of the member that the P = nodes_per_element basis values begin at
     phi[n][P]: out */
SPAR_API int spar_fluid_get_basis(const spar_fluid *fluid, int which, int64_t *first_node, double *phi);

/* ---- fluids: motion and loads -------------------------------------------------------------------------------------- */

/* How far the motion nodes of this rank have gone since t^n, in the latest iterate: what a mesh has to follow. Between
   steps 0.
     largest: out, m, of all of them
     node: out, which, the first of equals; -1: there are none
   Each NULL: not wanted. */
SPAR_API int spar_fluid_get_travel(spar_fluid *fluid, double *largest, int64_t *node);
/* The nodes of one set at t^{n+1} in the latest iterate, between steps at t^n: for pictures and post-processing. A
   getter: it does not count as a pull, and a trial that switches effects off does not change it.
     which: in, SPAR_NODES_*
     x[n][3]: out, m, position, NULL: not wanted; nodes with weights follow in part, as in pulls
     q[n][4]: out, orientation of the section at the nearest point, scalar part >= 0, NULL: not wanted
     v[n][3]: out, m/s, NULL: not wanted
     nearest[n][3]: out, m, position of the nearest point on the line, NULL: not wanted
   Local. */
SPAR_API int spar_fluid_get_positions(const spar_fluid *fluid, int which, double *x, double *q, double *v,
                                      double *nearest);
/* Direction cosines of the sections instead of quaternions. Row by row in C; a Fortran array m(3,3,n) so filled holds
   m(column, row, n), that is the transpose. */
enum {
    SPAR_MATRIX_LOCAL_TO_GLOBAL = 0, /* times local components gives global ones: columns are the section's axes */
    SPAR_MATRIX_GLOBAL_TO_LOCAL = 1  /* its transpose: rows are the section's axes (OpenFAST's) */
};
/* convention: in, SPAR_MATRIX_*; matrix[n][9]: out. */
SPAR_API int spar_fluid_pull_matrices(spar_fluid *fluid, double theta, int convention, double *matrix);
/* Self-test for a host that keeps matrices of its own. Allocates; not for every step.
     convention: in, SPAR_MATRIX_*
     matrix[n][9]: in, what it holds for the motion nodes at t^{n+1}
   SPAR_ERR_ARGUMENT if one is not what pull_matrices gives (to 1e-5); the message tells a transposed matrix, one with
   determinant -1, one that is no rotation, and one that is another rotation apart. */
SPAR_API int spar_fluid_check_matrices(spar_fluid *fluid, int convention, const double *matrix);
/* The fluid's own node forces at t^n + theta dt, for an actuator line: pushed at t^n; at t^{n+1} pushed, or predicted
   as long as nothing was. force[n][3]: out, N, by force node. Zeros before the first push. SPAR_ERR_STATE: they are
   not kept (SPAR_EFFECT_FLUID_HISTORY). */
SPAR_API int spar_fluid_pull_forces(spar_fluid *fluid, double theta, double *force);
/* The same at t^{n+1} as a getter: it counts as no pull. force[n][3]: out. SPAR_ERR_STATE: they are not kept
   (SPAR_KIND_FORCES). */
SPAR_API int spar_fluid_get_forces(const spar_fluid *fluid, double *force);
/* For a fluid that takes several steps within dt: its mean loads over the part of the step that ends at t^n + theta dt
   (it pulls at any theta). In use at t^{n+1} is m + (e - e^n) / 2: m the mean of the parts over the step so far, e
   where the line of least squares through them ends, e^n where that of the step before did (T13): of second order in
   dt, and the parts' impulse is kept. Loads that are known at t^{n+1} itself: spar_fluid_push_forces. Not before the
   first step; otherwise as that.
     theta: in, in (0, 1], rising from push to push; one that does not rise begins anew (the next iteration)
     force[n][3]: in, N
     moment[n][3]: in, N m, about each node, NULL: none */
SPAR_API int spar_fluid_push_forces_at(spar_fluid *fluid, double theta, const double *force, const double *moment);
/* Numbers of the host's own at each force node, for a model that remembers (wakes, stall, a friction): they go with the
   run as loads do. Pulled are those at t^n, in every iteration the same; those pushed last become them when the step is
   accepted, and are forgotten when it is rejected. They are saved and loaded (found by the nodes' places, also on other
   ranks), and a trial leaves them as they were. Zeros at first, and when the nodes are mapped anew.
     width: in, numbers a node, 0 to 1000, 0: none (default). As many as there are: they stay as they are
   Between steps. */
SPAR_API int spar_fluid_set_states(spar_fluid *fluid, int64_t width);
/* Each NULL: not wanted.
     width: out, numbers a node
     dt: out, s, from those pulled to those pushed now: the step's, 0 between steps, before the first one, and where
           time stands (a static solution, a balanced start): what is pushed there is a steady state */
SPAR_API int spar_fluid_get_states(const spar_fluid *fluid, int64_t *width, double *dt);
/* Those at t^n; before the first step, and where time stands, those there.
     width: in, as set
     states[n][width]: out, by force node */
SPAR_API int spar_fluid_pull_states(const spar_fluid *fluid, int64_t width, double *states);
/* Those at t^{n+1}, before the first step those at t = 0. Without a push those at t^n stay.
     width: in, as set
     states[n][width]: in, by force node */
SPAR_API int spar_fluid_push_states(spar_fluid *fluid, int64_t width, const double *states);
/* The calls of each iteration for hosts in single precision. Numbers are converted on the way in and out; all sums are in
   double precision. spar_fluid_pull_motion:
     theta: in, in [0,1]
     x[n][3]: out, m, NULL: not wanted
     v[n][3]: out, m/s, NULL: not wanted */
SPAR_API int spar_fluid_pull_motion_f32(spar_fluid *fluid, double theta, float *x, float *v);
/* spar_fluid_pull_poses in single precision.
     which: in, SPAR_NODES_*
     theta: in, in [0,1]
     x[n][3]: out, m, NULL: not wanted
     q[n][4]: out, NULL: not wanted
     v[n][3]: out, m/s, NULL: not wanted
     omega[n][3]: out, rad/s, NULL: not wanted
     accel[n][3]: out, m/s^2, NULL: not wanted
     alpha[n][3]: out, rad/s^2, NULL: not wanted */
SPAR_API int spar_fluid_pull_poses_f32(spar_fluid *fluid, int which, double theta, float *x, float *q, float *v,
                                       float *omega, float *accel, float *alpha);
/* spar_fluid_pull_forces in single precision.
     theta: in, in [0,1]
     force[n][3]: out, N */
SPAR_API int spar_fluid_pull_forces_f32(spar_fluid *fluid, double theta, float *force);
/* spar_fluid_push_forces in single precision.
     force[n][3]: in, N
     moment[n][3]: in, N m, NULL: none */
SPAR_API int spar_fluid_push_forces_f32(spar_fluid *fluid, const float *force, const float *moment);
/* Figures of the last push. */
enum {
    SPAR_AUDIT_FORCE = 0,        /* size of the sum that came in from the nodes, N */
    SPAR_AUDIT_MOMENT = 1,       /* the same of the moment about the origin, N m */
    SPAR_AUDIT_POWER = 2,        /* and the power, W */
    SPAR_AUDIT_FORCE_ERROR = 3,  /* their errors after the transfer, relative to the sum of their parts' sizes */
    SPAR_AUDIT_MOMENT_ERROR = 4, /* the same of the moment */
    SPAR_AUDIT_POWER_ERROR = 5,  /* and of the power */
    SPAR_AUDIT_FARTHEST = 6,     /* largest distance of a node from the origin, m */
    SPAR_AUDIT_NODES = 7,        /* how many nodes there are */
    SPAR_AUDIT_COUNT = 8
};
/* audit[capacity]: out, by SPAR_AUDIT_*, NULL: not wanted. */
SPAR_API int spar_fluid_get_audit(const spar_fluid *fluid, int64_t capacity, double *audit);
/* Force and moment of the whole fluid: of the loads last pushed, on the structure where it is now, summed over the
   ranks, each of which gives its own fluid of this name and member, one without nodes where it has none. Collective, at
   any time but in a fluid solver that spar_step or a static solution calls (SPAR_ERR_STATE). 0 before the first push.
     point[3]: in, m, that the moment is about, global, the same on every rank, NULL: the origin
     force[3]: out, N
     moment[3]: out, N m
   Each output NULL: not wanted; the same on all ranks. */
SPAR_API int spar_fluid_sum_loads(const spar_fluid *fluid, const double point[3], double force[3], double moment[3]);
/* Whether these sums are what the host knows them to be, from its own sum over its faces: finds force nodes of rank
   borders that two ranks have pushed, or none. Nothing changes. Collective, as above.
     point[3]: in, as above
     force[3]: in, N, the host's total over all ranks
     moment[3]: in, N m, about the point, NULL: not compared
     rtol: in, > 0, of the difference over the sum of the sizes of the loads' parts on the structure's nodes; what the
           transfer leaves is some 1e-15 of the sum over the fluid's nodes
   All alike on every rank. SPAR_ERR_ARGUMENT: they differ, the message says by how much. */
SPAR_API int spar_fluid_check_loads(const spar_fluid *fluid, const double point[3], const double force[3],
                                    const double moment[3], double rtol);

#ifdef __cplusplus
}
#endif

#endif
