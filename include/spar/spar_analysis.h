/* spar_analysis.h: experimental, may change in any release. Trial runs, effects, advice, eigenvalues with the fluid, error
   estimates. The conventions are those of spar.h. */
#ifndef SPAR_ANALYSIS_H
#define SPAR_ANALYSIS_H

#include <spar/spar_coupling.h>
#include <spar/spar_structure.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ---- error estimates and learned added mass ------------------------------------------------------------------------ */

/* What the numbers of a member leave of error in its motion now: root of the mean square over its nodes, m. In the mean
   over a run that of steps is true to a factor of 3, that of nodes to a factor of 4 where the run forgets within some
   periods (docs/advice.md has what that was measured on); a single one may be off by more. Too few nodes also have
   frequencies that are a little off: where nothing damps that adds up as phase, and only trials see it
   (spar_session_advise). Each NULL: not wanted. Local, the same on all ranks.
     step: out, what the last step added, or what the step under way adds once it is solved, as the tolerance takes it:
           SPAR_ERR_STATE where none is set
     nodes: out, how far the motion between steps, and the loads there, would take a beam with four more nodes an
   element from the shape it has: its equations with their tangent, solved up to five times in this call. 0 for what has
           no shape; -1: not known (fidelity linear or modal, 24 nodes an element, a root that is free before the first
           step, no solution)
   SPAR_ERR_STATE too in trials, statics and starts, and of the nodes within a step. */
SPAR_API int spar_member_estimate_error(spar_member *member, double *step, double *nodes);
/* The fluid's added mass learned while steps are iterated, from the differences of their iterations: loads that came
   back against accelerations, with any scheme that iterates. From the step on in which it is known well enough, and as
   long as it is, it stands in the equations in place of the guess that was given (none, or the last run's); then few
   iterations, fixed points or explicit steps do, in which nothing more is learned. It is what comes back within a step:
   of a fluid that takes accelerations from the velocities at both ends of the step half the added mass, which is what
   belongs there. The converged answer does not change. On all ranks; none of it happens in a trial. Default: off, which
   costs nothing. Before commit; replaces an earlier call. Local.
     n: in, stations of a beam at which it is found, linear in eta between them, at most 20: 1 if it is the same all
        along; 1 of a rigid body; 0: learn nothing
     eta[n]: in, of a beam, strictly increasing in [0,1]; else not looked at
   SPAR_ERR_UNSUPPORTED: as spar_member_set_added_mass. */
SPAR_API int spar_member_learn_added_mass(spar_member *member, int64_t n, const double *eta);
/* What has been learned, of steps accepted; a host may give it as the guess at the start of the next run. Local, and
   the same on every rank.
     used: out, whether it stands in the equations (from the next step on)
     spread: out, the part of a change of the loads that it has left, of differences before it knew them, root of the
             mean of the squares: iterations will contract by about as much. Used below 1/4, and not any more beyond
             1/2. 1: there have been less than two and a half
     n: out, stations, 0: nothing is to be learned; capacity: in, of the arrays; eta[capacity], mass[capacity][36]: out,
        as spar_member_set_added_mass takes them, 0 behind the last, and as long as nothing is known
   Each out may be NULL: not wanted. */
SPAR_API int spar_member_get_learned_added_mass(const spar_member *member, int *used, double *spread, int64_t *n,
                                                int64_t capacity, double *eta, double *mass);

/* ---- trials -------------------------------------------------------------------------------------------------------- */

/* ---- what if ----------------------------------------------------------------------------------------------------- */

/* Trial runs: the session runs some steps from where it stands and goes back, to the last bit: what an effect is worth,
   or what settings do, is found by trying. They are the host's own steps, with its own fluid: `solve` as in spar_step,
   and `before`, called ahead of each step for what the host does there (drive roots, set loads, keep what its fluid had
   at t^n). Both must be repeatable: the same motion and time give the same loads, whatever ran before, and nothing else
   of the host's is changed for good. They may use members and fluids in all ways, but not create or map them;
   where nodes are varied (spar_session_advise), they ask for counts anew (spar_member_get_count). A trial begins with
   accelerations from the balance of forces. All calls here are collective, between steps; before and
   solve are given on all ranks or on none; SPAR_ERR_STATE within a trial. steps: in, a multiple of 8. Runs are
   compared at 128 times, evenly spread, between steps by cubics. The seconds of a run are the processor time of its
   steps, the fluid's included, on all ranks; advice goes by counted work, not by them. */

/* What a trial says. Errors are roots of the mean square over members, places along them and the times. */
enum {
    SPAR_TRY_MOTION = 0,   /* change of the motion, relative to the motion beyond that of a fixed or driven root (else
                              since the beginning of the run) */
    SPAR_TRY_REACTION = 1, /* change of what the roots give the members, moments by their lengths, relative to that */
    SPAR_TRY_LOAD = 2,     /* change of the fluid's loads, after the first step and at 8 even times, relative to them */
    SPAR_TRY_SECONDS = 3,  /* processor time of the steps, s */
    SPAR_TRY_SOLUTIONS = 4, /* solutions of the fluid */
    SPAR_TRY_COUNT = 5
};

/* How far a call that makes many trials is (spar_session_advise, spar_session_report_effects,
   spar_session_solve_eigenvalues, spar_session_solve_floquet): called before each of its runs, between which the
   session is as it was. It may read the session, and changes nothing of it. Answer 0 to go on; anything else ends the
   call: SPAR_ERR_USER, and all is as it was.
     done: what has been run so far, from 0, in trials with the session as it is: of advice counted, as
           SPAR_ADVICE_WORK, or runs where the session as it is fails; of effects, eigenvalues and multipliers runs
     expected: what it will come to, at first by what such calls have come to, later by what the runs show; never below
           done, nor, unless done is, above the option advise.limit */
typedef int (*spar_progress)(spar_session *session, double done, double expected, void *context);
/* Who is told. Local, at any time; from within a call it holds for the next.
     progress: in, NULL: nobody (default). On all ranks or on none; where one rank stops the others answer
           SPAR_ERR_PEER
     context: in, handed to progress; must live as long as the session uses it */
SPAR_API int spar_session_set_progress(spar_session *session, spar_progress progress, void *context);
/* One trial with the session as it is, for hosts that compare settings of their own. Failures as of spar_step.
     dt: in, s
     steps: in, a multiple of 8
     before, solve: in, NULL: none (without solve the loads stay as they are)
     context: in, handed to both
     compare: in, 0: what later trials are compared with (errors come out 0); 1: compared with that run, over the same
           time, with any dt
     capacity: in, of the report
     report[capacity]: out, by SPAR_TRY_*, NULL: not wanted
   SPAR_ERR_STATE: nothing to compare with. */
SPAR_API int spar_session_try(spar_session *session, double dt, int64_t steps, spar_before_step before,
                              spar_fluid_solver solve, void *context, int compare, int64_t capacity, double *report);
/* Eigenvalues of structure and fluid together: those of spar_member_solve_eigenvalues with the fluid's answer to small
   motions about the present state, one of equilibrium with the loads in use (spar_session_solve_static, or a run that
   has come to rest or turns steadily). A wing flutters where the largest growth rate, over the speed of the wind,
   passes 0, with no run in time. All that spar solves for is seen in its lowest undamped modes; along each of these the
   members are moved in trials, with an amplitude and its opposite, and nothing is solved: the host's solver gives the
   loads. The session goes back after each, to the last bit. A fluid without a memory is called 6 modes times, once a
   trial: its loads by displacements, velocities and accelerations, which it may also make of the places at both ends of
   the step. One with a memory is called 2 modes (22 + memory) times: the motion is a pulse of a few steps, the loads
   are watched until so many steps behind it, and what they do beyond is the decay of the linear system that they show.
   What joints hold or drive stands still; what `before` drives or loads does not move (docs/stability.md).
     dt: in, s, of the trials' steps, as the fluid is run; with a memory eigenvalues are found up to |lambda| dt = 1
     memory: in, steps that loads answer for once the motion has ended, 0 to 1000000, until they are on their way to
           rest; 0: none, and no fluid has states (spar_fluid_set_states)
     amplitude: in, of the motion: displacement of a node over its member's length, and turn, rad, to 0.1; 0: 1e-5. A
           fluid that is solved to r of its loads needs about sqrt(r)
     before, solve, context: in, as of spar_session_try, repeatable; called with this dt
     modes: in, 1 to 200: more until the answer stays
     n: in, how many eigenvalues, at most 2 modes
     shift[2]: in, growth rate, 1/s, and angular frequency, rad/s: those nearest to it are found; NULL: zero, the lowest
     eigenvalue[n][2]: out, growth rate and angular frequency, >= 0, by their distance from the shift. Those of the
           fluid alone (its wake's) are left out unless they grow
     nodes: in, of the array shapes: those of all members; 0 where it is NULL
     shapes[n][nodes][6][2]: out, displacement and rotation of the nodes, member by member as they were created, real
           and imaginary part, of unit x^H M x, NULL: not wanted
     frame[3]: out, rad/s, as of spar_member_solve_eigenvalues, NULL: not wanted
   The structure is exact in time: steps show these growth rates to the order of their integrator. A rotor's eigenvalues
   are those in a fluid that is steady as seen from it. Collective. SPAR_ERR_STATE: no equilibrium, or one with other
   loads; SPAR_ERR_NUMERIC: the fluid does not come to rest in this memory, or fewer than n were found;
   SPAR_ERR_UNSUPPORTED: as of members. */
SPAR_API int spar_session_solve_eigenvalues(spar_session *session, double dt, int64_t memory, double amplitude,
                                            spar_before_step before, spar_fluid_solver solve, void *context,
                                            int64_t modes, int64_t n, const double shift[2], double *eigenvalue,
                                            int64_t nodes, double *shapes, double frame[3]);
/* Stability of a state that is periodic in time: a rotor of two blades, or on a tower, or under its weight, whose small
   motions have coefficients that change with the angle. The eigenvalues of the map of small motions over one period
   (Floquet's multipliers mu), found by trials: beyond the present state, which has to repeat, all that spar solves for
   is moved along each of its lowest undamped modes, and given the velocity of it, to and fro, and the session goes
   through the period with the host's own steps and fluid; 4 modes + 1 runs of a period and a step, after each of which
   it goes back, to the last bit. Run until the state repeats, then call. Newton is strict in them.
     dt: in, s, of the steps, as the run is stepped: multipliers are those of the steps, right to dt^2
     steps: in, of the period, >= 1: a turn of the rotor, or so many that all is where it was
     amplitude: in, of what is moved: displacement of a node over its member's length, and turn, rad, to 0.1; 0: 1e-4.
           Errors are its square, and what the coupling leaves over it
     before, solve, context: in, as of spar_session_try, repeatable: what drives roots and joints moves by the time.
           Each run begins with a balanced start, where solve is called with dt 0 (spar_session_solve_initial)
     modes: in, 1 to 200, at most the unknowns less what is held: more until the answer stays
     n: in, how many, at most 2 modes
     eigenvalue[n][2]: out, growth rate, 1/s, and angular frequency, rad/s, of log(mu) over the period, the least damped
           first; one of each conjugate pair, its frequency from 0 to pi over the period: it is known up to multiples of
           2 pi over the period, and up to its sign. A growth rate > 0 is an instability
   The fluid begins each run with the state it has (spar_fluid_set_states): what it remembers for longer than a period
   is not seen. Collective. SPAR_ERR_STATE: the state does not repeat: the message says by how much; SPAR_ERR_NUMERIC:
   fewer than n; SPAR_ERR_UNSUPPORTED: nothing is solved for. Failures as of spar_step. */
SPAR_API int spar_session_solve_floquet(spar_session *session, double dt, int64_t steps, double amplitude,
                                        spar_before_step before, spar_fluid_solver solve, void *context, int64_t modes,
                                        int64_t n, double *eigenvalue);

/* ---- effects ------------------------------------------------------------------------------------------------------- */

/* Rows of the report of effects. */
enum {
    SPAR_ROW_INERTIA = 0, /* size: its nodal forces relative to the largest of all terms, roots of the sums of squares
                             over nodes, the present state and the trial's steps; the next three likewise */
    SPAR_ROW_GYROSCOPIC = 1,
    SPAR_ROW_GRAVITY = 2,
    SPAR_ROW_DAMPING = 3,
    SPAR_ROW_FLUID_MOMENT = 4,   /* size, as of the next three: change of the fluid's loads, as SPAR_TRY_LOAD */
    SPAR_ROW_FLUID_VELOCITY = 5, /* velocities pulled; without: a fluid that sees them as zero */
    SPAR_ROW_FLUID_POSES = 6,    /* orientations, angular velocities, accelerations pulled; without: the reference's */
    SPAR_ROW_FLUID_HISTORY = 7,  /* node forces pulled back; without: zeros */
    SPAR_ROW_PREDICTOR = 8,      /* size: |predicted - final| / |final| loads of the last step; without: order 0 */
    SPAR_ROW_ITERATION = 9,      /* size: added mass over mass, as the coupling sees it; without: explicit */
    SPAR_ROW_HALF_STEP = 10,     /* pulls at 0 < theta < 1; size: (Omega dt)^2 / 8, the cut corner; without: theta 1 */
    SPAR_ROW_MASSES = 11,        /* bodies on beams; size as of gravity: their weight and inertia */
    SPAR_ROW_FOUNDATION = 12,    /* springs along beams; size as of gravity */
    SPAR_ROW_PRETENSION = 13,    /* section forces of the reference; size as of gravity */
    SPAR_ROW_COUNT = 14
};
/* Columns of the same. */
enum {
    SPAR_COLUMN_IN_FORCE = 0, /* 1; 0: the scene has it not, and the rest of the row is 0 */
    SPAR_COLUMN_SIZE = 1,     /* relative to the leading term, over the trial: a scene at rest may be about to move */
    SPAR_COLUMN_MOTION = 2,   /* error of the motion without it, as SPAR_TRY_MOTION; -1: the run fails without it (a log
                                 is told why, at SPAR_LOG_INFO) */
    SPAR_COLUMN_REACTION = 3, /* the same of the roots' reactions */
    SPAR_COLUMN_SHARE = 4, /* of the time, that leaving it out saves: of a solution's, but for predictor and iteration,
                              which change how many there are; below 0: it then costs more */
    SPAR_COLUMN_COUNT = 5
};
/* Name of a row, "gravity"; static storage; "" for what is no row. */
SPAR_API const char *spar_effect_name(int row);
/* What each effect is worth in the scene as it stands: sizes, errors and savings from trials, with the effect and
   without it, all members at once.
     dt: in, s
     steps: in, of dt in each trial, a multiple of 8
     before, solve, context: in, as of spar_session_try; solve NULL: under the present loads, rows of the fluid not in
           force
     rows, columns: in, the capacity of the table
     table[rows][columns]: out, by SPAR_ROW_* and SPAR_COLUMN_*, Fortran (columns, rows), NULL: not wanted */
SPAR_API int spar_session_report_effects(spar_session *session, double dt, int64_t steps, spar_before_step before,
                                         spar_fluid_solver solve, void *context, int64_t rows, int64_t columns,
                                         double *table);

/* ---- advice -------------------------------------------------------------------------------------------------------- */

/* What the tolerance of advice is for. Each is relative to its own root of the mean square, and compared by itself. */
enum {
    SPAR_GOAL_MOTION = 1,   /* motion, as SPAR_TRY_MOTION */
    SPAR_GOAL_REACTION = 2, /* what roots and joints give the members, moments by their lengths */
    SPAR_GOAL_SECTION = 4,  /* section forces at nine places, eta 0 to 1, of the beams that have sections, as
                               spar_beam_evaluate; moments by the lengths */
    SPAR_GOAL_LOAD = 8,     /* the fluid's loads on each member: their sum and moment about its root */
    SPAR_GOAL_NUMBERS = 16  /* each number of spar_session_push_numbers */
};
/* Local, alike on all ranks, between steps.
     goals: in, SPAR_GOAL_* or-ed; the tolerance holds for each; default SPAR_GOAL_MOTION */
SPAR_API int spar_session_set_goal(spar_session *session, int goals);
/* goals: out */
SPAR_API int spar_session_get_goal(const spar_session *session, int *goals);
/* Numbers of the host's own that advice is to keep, as they are now (thrust, power, lift): pushed by the fluid solver
   in each iteration, or before a step; the last ones of a step count. Nothing else is done with them. Local, at any
   time; on several ranks their sum counts, so that each gives its part, or one of them all. n: in, 0 to 32 numbers[n]:
   in */
SPAR_API int spar_session_push_numbers(spar_session *session, int64_t n, const double *numbers);
/* Advice for a session. */
enum {
    SPAR_ADVICE_DT = 0, /* s */
    SPAR_ADVICE_SUBSTEPS = 1,
    SPAR_ADVICE_SCHEME = 2,        /* SPAR_COUPLING_* */
    SPAR_ADVICE_COUPLING_RTOL = 3, /* of an iterated scheme; its atol is the session's */
    SPAR_ADVICE_PREDICTOR = 4,
    SPAR_ADVICE_NEWTON_RTOL = 5,   /* its atol is the session's */
    SPAR_ADVICE_ERROR = 6,         /* estimated, of the goal that is off farthest */
    SPAR_ADVICE_COST = 7,          /* of a second of the run, counted, relative to the session as it is with dt given */
    SPAR_ADVICE_PRESENT_ERROR = 8, /* of the session as it is; -1: it fails */
    SPAR_ADVICE_TRIALS = 9,        /* runs made */
    SPAR_ADVICE_WORK = 10,    /* what asking has cost, counted, in trials with the session as it is; -1: it fails */
    SPAR_ADVICE_SHOWING = 11, /* of that, what it took to know what keeps the tolerance: the session as it is, the
                                 reference, and the longer look */
    SPAR_ADVICE_SAVES = 12, /* what the rest brings, in the same unit: what a run as long as was asked for, and no less
                               than ten times the trials, saves against the cheapest settings that were known then to
                               keep the tolerance: the session as it is, or with dt fine enough */
    SPAR_ADVICE_SKIPPED = 13,  /* trials not made because they could not save as much as they would have cost: what they
                                  would have varied stays */
    SPAR_ADVICE_ELEMENTS = 14, /* of all beams together; of each: spar_beam_get_elements, once it is in force */
    SPAR_ADVICE_COUNT = 15
};
/* The cheapest settings whose error stays below a tolerance, by trials against a run that is converged in dt, nodes and
   coupling; nothing is changed. A log is told of each trial at SPAR_LOG_INFO.
     tolerance: in, in (0, 1): of each goal (spar_session_set_goal), by default of the motion, as SPAR_TRY_MOTION
     dt, steps: in, the host's dt in s, and how many of it the trials last, a multiple of 8
     length: in, > 0: how long the run will be that the advice is for, s. If it is longer than the trials, their errors
           count for as much more as they grow with time; SPAR_ERR_NUMERIC if the trials do not tell what comes after
           them: the motion neither settles in them nor turns as often as a period does. What only happens later (a
           gust) is not seen
     before, solve, context: in, as of spar_session_try, called with other dt too
     capacity: in, of the advice
     advice[capacity]: out, by SPAR_ADVICE_*, NULL: not wanted; what it says of beams: spar_member_get_advice
   Beams of one make (all that is described but name, placement and initial velocity) get one advice. Elements are
   kept where the host has given the nodes, or where a joint or a kept load is at a node that would not end one. Costs
   are counted (iterations of Newton, tangents, nodes, unknowns, solutions of the fluid) and not timed, so that the
   same scene gets the same advice each time; what a solution of the fluid counts for: the option advise.fluid_cost
   (unsaid its time, in classes; SPAR_LOG_WARNING where that is near to a border of two). No trial is made that could
   not save, in a run of SPAR_ADVICE_SAVES' length, what it costs; but for those that show what keeps the tolerance.
   Where the session as it is keeps it and nothing cheaper pays, it is what is advised. What is kept as it is: the
   options advise.dt, advise.nodes, advise.fidelity, advise.coupling = keep. SPAR_ERR_UNSUPPORTED:
   solve is NULL; SPAR_ERR_NUMERIC: no settings do, or nothing converges; the message says what error was reached;
   SPAR_ERR_LIMIT: the option advise.limit. After a failure all is as it was. */
SPAR_API int spar_session_advise(spar_session *session, double tolerance, double dt, int64_t steps, double length,
                                 spar_before_step before, spar_fluid_solver solve, void *context, int64_t capacity,
                                 double *advice);
/* Puts the last advice in force between steps: substeps, coupling scheme and its rtol, predictor, Newton's rtol, and
   of beams fidelity, modes, elements, nodes per element and quadrature points. dt stays the host's to take. Beams for
   which something is advised otherwise are made anew in place: they keep handle, name, place, root, loads and the
   work done on them, and their motion, which goes over by the elements' own interpolation (loads by its transpose:
   their sum stays); accelerations begin from the balance of forces. Their fluids keep handles and nodes and are
   mapped again. Counts change: spar_member_get_count; what depends on the nodes' numbers, as the nodes of loads set
   from now on, is the host's to say anew. All else stays to the last bit. What the advice does not have stays:
   rho_inf, the coupling's atol, limits and options, Newton's atol, effects asked for. A beam whose nodes the host has
   given has its line through the new ones from then on; of the motion a lower fidelity keeps what it can show.
   Sections of fluids keep places and frames. Called again it does nothing.
     dt: out, SPAR_ADVICE_DT, s; NULL: not wanted
   Collective. SPAR_ERR_STATE: a step or a trial is under way, there is no advice, members have been added or described
   otherwise since, or a fluid has nodes that are not mapped. After a failure all is as it was. */
SPAR_API int spar_session_apply_advice(spar_session *session, double *dt);
/* What the last advice says of a beam. Each NULL: not wanted. Local. SPAR_ERR_STATE: no advice yet.
     fidelity: out, SPAR_FIDELITY_*
     modes: out, of a modal one, else 0
     nodes_per_element: out
     points: out, for spar_beam_set_quadrature with the rule in force; 0: as described */
SPAR_API int spar_member_get_advice(const spar_member *member, int *fidelity, int64_t *modes, int *nodes_per_element,
                                    int *points);

#ifdef __cplusplus
}
#endif

#endif
