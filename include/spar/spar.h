/* spar.h: structures coupled with fluids. This header is the specification; what is not here is not the interface.

   spar advances structural members (a geometrically exact beam, a rigid body, a massless point, or the host's own
   structure) and ties fluid models to them: it gives the fluid the motion of its nodes and takes the loads on them. A
   host's loop is

       spar_step_begin(s, dt);                      predicts the loads at t^{n+1}
       do {
           spar_step_solve(s);                      structure to t^{n+1}
           spar_fluid_pull_motion(f, 1.0, x, v);    where the fluid's nodes are, and how fast
           ...                                      the host advances its fluid and finds its loads
           spar_fluid_push_forces(f, force, 0);     loads at t^{n+1}
           spar_step_check(s, &done);               gathers them; again, or enough?
       } while (!done);
       spar_step_accept(s);                         or spar_step_reject(s)

   and spar_step runs it with a callback. docs/theory.md has the equations behind it, which are cited below as (T1) and
   so on, and the parts 1 to 8 of a step.

   Conventions
   - Units are SI; any consistent set works, gravity included. Angles are in radians.
   - One right-handed inertial frame, "global"; every vector is in it unless a line says "own frame" or "section
     frame".
   - Vectors stand in contiguous triples: x[n][3] is the double array of 3 n entries x[3 i + component], Fortran's
     x(3,n).
   - Quaternions are unit, scalar first, [w,x,y,z], the rotation R(q) that takes local components to global ones. q
     and -q are the same rotation; either may be given.
   - Node motion q[7] is displacement u from the reference place and the quaternion of the rotation *relative to the
     reference configuration*, in global axes: the orientation now is R(q) R(q_ref). Velocity v[6] is u-dot and the
     angular velocity, acceleration a[6] their rates, load[6] force and moment, all global.
   - 6x6 matrices are row-major, 36 doubles, in the order axial force N, shear y, shear z, torsion x, bending y,
     bending z (mass: the velocities in the same order), in the section frame: x is the tangent of the reference line.
     At no twist and no placement, y = unit(z_global x tangent), which a line along global x has in the global x-y
     plane. A line that comes within 10 degrees of global z at an axis point has its y carried along from the root
     with the least turn. There y is unit(z_global x tangent); if the root is within 0.001 rad of global z, it is
     global y less its part along the tangent. The axis points decide, never the number of nodes.
   - eta in [0,1] and xi = 2 eta - 1 in [-1,1] run along the whole beam; element e of E covers eta in [e/E, (e+1)/E]
     and is linear in its own xi. A beam's nodes are the Gauss-Lobatto-Legendre points of its elements, numbered from
     0, element by element: E*P nodes for P nodes per element. The joint of two elements stands twice; both copies
     carry the same motion, and their loads add.
   - Counts and indices are int64_t, flags and enums int. n = 0 with NULL arrays is legal everywhere.
   - Outputs marked "NULL: not wanted" may be NULL; any other pointer may not, unless its line says so.
   - Arrays whose entries have names (reports, tables, accounts) come with their capacity, since a later release may
     know more of them: as many entries as there is room for are written, and those that this release does not know are
     0. The enumerators that end in _COUNT say how many the header knows.

   Ownership. Every array is the caller's and is copied before the call returns; the library keeps no pointer of the
   host's except a callback and its context. Handles made by create are released by destroy; destroy takes NULL or a
   handle that is NULL already, and sets the handle to NULL. create writes the handle only when it succeeds.

   Ranks. "Collective" means: called on every rank of the session, in the same order and with the same arguments, but
   for outputs, contexts, fluid solvers of steps and static solutions and the paths of save and load. Members are
   described on every rank with the same arguments, and settings made alike; each rank's fluids are its own, and a rank
   may have none. A collective call compares, before it does anything, which call it is, its arguments and, between
   steps, all settings but the options fluid.far and fluid.audit: where the ranks differ it is SPAR_ERR_COMM on all of
   them, and the message names the first thing that does. "Local" calls send and wait for nothing. One that fails is
   known to its rank alone, and a NULL handle leads to no communicator: given to a collective call it is refused there
   while the others wait in theirs. So the ranks agree on how their creates have ended (MPI_Allreduce of the statuses,
   say) before the next collective call; or the rank that failed makes another one, such as spar_session_destroy, and
   the others get SPAR_ERR_COMM where they are. Once a rank has destroyed the session, the others can only do the same.

   Errors. Every function answers a status (SPAR_OK is 0) except the destroys and the getters of text; nothing aborts,
   exits or prints. spar_session_message says what went wrong, where, and the cure; where there is no session to ask
   (NULL handle, failed create), spar_session_message(NULL) has it. A refused call leaves everything as it was. In a
   collective call a failure on one rank is a failure on all: that rank answers its own status, the others
   SPAR_ERR_PEER with its message. Common to all calls and not repeated below: SPAR_ERR_ARGUMENT for a NULL handle or
   array, a number that is not finite, a negative count, a value out of its range; SPAR_ERR_STATE for a call out of
   order; SPAR_ERR_MEMORY.

   Threads. A session and all that is made from it is used by one thread at a time; different sessions may be used by
   different threads at once. The library has no state besides the message of each thread's failed creates (and a lock
   around BLAS, which may have some), so that sessions never meet; but the members and fluids of one session share its
   clock, its work arrays and its message. Sessions over several ranks need of MPI the thread level that the host's own
   use of it implies.

   Surroundings. A host may trap floating-point exceptions, round as it likes and set any locale. While the library
   computes, traps are held, so that what is not finite leads to a status and not to a signal; results are rounded to
   the nearest, so that they are the same whatever the host does; numbers in files, options and messages have a point;
   GSL's error handler, which may abort, is off. The host's own is in force again when a call returns and inside its
   callbacks. GSL's handler is one for the process: it is off as long as any thread is in a call, and a host changes it
   when none is. Flags raised meanwhile are not seen outside. The treatment of denormal numbers stays the host's. A
   stack of 128 kB is enough. (Built by another compiler than GCC or Clang, the library leaves all of this as it is.)

   Adding to the library (docs/adding.md):
   - a public call: header, cmake/make-map.sh, cmake/make-bindings.sh, the tables of tests/torture;
   - a setting: a field of the session (src/base/session.h) and a row of the table in src/session/settings.c;
   - a fidelity: a file with a row of operations in src/solve, its name in SPARI_FIDELITIES of src/time/fidelity.h;
   - a coupling scheme: its SPAR_COUPLING_*, its row in src/coupling/accelerator.c, its name in accelerate.h;
   - a projection: its SPAR_PROJECT_*, src/transfer/projection.c, the check in src/fluid/nodes.c.

   ABI. Structs are opaque, enumerators and codes never change their numbers, a function never changes its arguments:
   what must behave differently is a new function. The shared library's soname changes only if that rule is broken. */
#ifndef SPAR_SPAR_H
#define SPAR_SPAR_H

#include <stdint.h>

#if defined(__GNUC__)
#define SPAR_API __attribute__((visibility("default")))
#else
#define SPAR_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

typedef struct spar_session spar_session; /* one clock, its members, one communicator */
typedef struct spar_member spar_member;   /* a structure; belongs to its session */
typedef struct spar_joint spar_joint;     /* what ties two nodes; belongs to its session */
typedef struct spar_fluid
    spar_fluid; /* a fluid model's nodes on this rank, tied to one member; belongs to the session */

/* ---- status ------------------------------------------------------------------------------------------------------ */

/* Statuses. Their numbers never change. */
enum {
    SPAR_OK = 0,
    SPAR_ERR_ARGUMENT = 1,    /* a value is not allowed */
    SPAR_ERR_STATE = 2,       /* the call is out of order */
    SPAR_ERR_MEMORY = 3,      /* no memory */
    SPAR_ERR_NUMERIC = 4,     /* not converged, or singular */
    SPAR_ERR_MAPPING = 5,     /* a fluid node cannot be mapped */
    SPAR_ERR_COMM = 6,        /* the communication failed, or the ranks disagree about what they do */
    SPAR_ERR_PEER = 7,        /* another rank failed; the message is that rank's */
    SPAR_ERR_IO = 8,          /* a file */
    SPAR_ERR_UNSUPPORTED = 9, /* not in this build, or not there yet */
    SPAR_ERR_USER = 10,       /* the host's callback failed */
    SPAR_ERR_LIMIT = 11       /* a limit of work that the host has set is reached */
};

/* Name and text of a status, for any int; static storage, never NULL. */
SPAR_API const char *spar_status_text(int status);
/* Release, "major.minor.patch"; static storage. */
SPAR_API const char *spar_version(void);
/* 1 if this build has the feature, else 0 (NULL, unknown names): "mpi", "fortran", "openblas", "lapack", "gsl". */
SPAR_API int spar_has(const char *feature);

/* ---- session ----------------------------------------------------------------------------------------------------- */

/* Coupling schemes. */
enum {
    SPAR_COUPLING_EXPLICIT = 0,    /* one solution per step with predicted loads */
    SPAR_COUPLING_FIXED_POINT = 1, /* iterates on the nodal loads, with a constant relaxation */
    SPAR_COUPLING_AITKEN = 2,      /* the same, relaxation by Aitken's rule */
    SPAR_COUPLING_IQN_ILS = 3      /* interface quasi-Newton by least squares (Degroote, Bathe, Vierendeels 2009) */
};

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

/* A session of this process alone. session: out. Local. */
SPAR_API int spar_session_create(spar_session **session);
/* A session over a communicator, which is duplicated and stays the caller's. Every build has this call; one without MPI
   answers SPAR_ERR_UNSUPPORTED. Collective over comm: all ranks get a session, or none.
     comm: in, the Fortran integer of it (C: see spar_mpi.h), the same communicator on all ranks of it
     session: out
   SPAR_ERR_ARGUMENT: not a communicator; SPAR_ERR_COMM: MPI is not initialised, or finalised already, or failed. */
SPAR_API int spar_session_create_fcomm(int comm, spar_session **session);
/* Releases the session with its members and fluids; their handles are dead then. Collective: before MPI_Finalize; it
   waits for the others to make a collective call of this session, and whichever that is it ends there. */
SPAR_API void spar_session_destroy(spar_session **session);
/* What went wrong last in this session, where, and the cure; "" if nothing ever did. Stands until the next failure;
   the text belongs to the session. NULL: the last failure in this thread that had no session. Local. */
SPAR_API const char *spar_session_message(const spar_session *session);

/* The setters below are local, made alike on every rank (see "Ranks"), and allowed between steps only (SPAR_ERR_STATE
   during one). The getter beside each gives what is set, at any time: local, each output NULL: not wanted. */

/* Gravity at the end of the next step: within a step it goes linearly from that of the step before, as an applied load
   does (spar_member_set_load).
     g[3]: in, m/s^2. Default 0. */
SPAR_API int spar_session_set_gravity(spar_session *session, const double g[3]);
SPAR_API int spar_session_get_gravity(const spar_session *session, double g[3]);
/* Generalised-alpha on the Lie group (Bruels, Cardona, Arnold 2012) while dt stays the same within 0.1 %. Steps of
   another length, and the one after them, are taken by TR-BDF2: two solutions with one tangent. dt may grow or shrink
   by any factor from step to step. What a step does not resolve is damped and feeds nothing. A substep without a
   solution, or whose solution gains energy that no load gives, is cut inside, down to 1/1024 of it (SPAR_ERR_NUMERIC).
     rho_inf: in, spectral radius of generalised-alpha at infinite frequency, in [0,1]; 1 keeps all, 0 damps most and
           has 5.4 times the error of dt that 0.9 has; default 0.9. An exact beam that spins at Omega without a driven
           root is taken by TR-BDF2 where 1 - rho_inf < 1.5 Omega dt
     substeps: in, structural steps per coupling step, >= 1, with loads interpolated linearly between t^n and t^{n+1};
           default 1. More than one: fluids pull means of accelerations (spar_fluid_pull_sections)
   SPAR_ERR_MEMORY: all is as before. */
SPAR_API int spar_session_set_integrator(spar_session *session, double rho_inf, int substeps);
SPAR_API int spar_session_get_integrator(const spar_session *session, double *rho_inf, int *substeps);
/* When Newton's iteration has converged: what is left of the increments, by the contraction that is seen, is below
   atol + rtol times their scale (lengths by the member's, rotations by 1). In steps of exact and rigid members and of
   those that joints tie that is so only after this call, or with the option newton.stop = strict: by default Newton
   ends as soon as what it leaves does not count beside the error of the step and what the coupling is iterated to
   (docs/accuracy.md), never before 1e-7 of the scale; strict is for comparisons to the last digits. Statics always take
   these tolerances.
     atol, rtol: in, >= 0; defaults 1e-15, 1e-12
     max_iterations: in, >= 1, past which the answer is SPAR_ERR_NUMERIC; default 50 */
SPAR_API int spar_session_set_newton(spar_session *session, double atol, double rtol, int max_iterations);
SPAR_API int spar_session_get_newton(const spar_session *session, double *atol, double *rtol, int *max_iterations);
/* Polynomial the loads are extrapolated with to t^{n+1} in part 1 of a step; no farther than ten times the last step,
   so that a much longer one does not start from its rounding. As many loads are kept as it needs: the first step uses
   0, the second 1 at most, and so do those after the order has been raised.
     order: in, 0, 1 (default, (T11)) or 2
   SPAR_ERR_MEMORY: the order is as before. */
SPAR_API int spar_session_set_predictor(spar_session *session, int order);
SPAR_API int spar_session_get_predictor(const spar_session *session, int *order);
/* How a step is iterated: until the change of the fluid's nodal loads is below atol + rtol |loads|, moments by the
   member's length; the change being that part of |loads| that it has in the motion (option coupling.norm).
     scheme: in, SPAR_COUPLING_*; default explicit
     atol: in, N, >= 0; default 1e-9
     rtol: in, >= 0; default 1e-6
     max_iterations: in, >= 1, past which spar_step_check answers SPAR_ERR_NUMERIC (or accepts, see the option
           coupling.unconverged); default 50 */
SPAR_API int spar_session_set_coupling(spar_session *session, int scheme, double atol, double rtol, int max_iterations);
SPAR_API int spar_session_get_coupling(const spar_session *session, int *scheme, double *atol, double *rtol,
                                       int *max_iterations);
/* omega: in, part of the change of loads that is taken in an iteration, in (0,2]; default 1. */
SPAR_API int spar_session_set_relaxation(spar_session *session, double omega);
SPAR_API int spar_session_get_relaxation(const spar_session *session, double *omega);
/* on: in, 1: nodal loads come out the same to the last bit however many ranks there are, however the fluid nodes are
   spread over them and over fluids, in whatever order they are given and whatever vectors the processor has; 0
   (default): to rounding. A run that is saved and goes on with other ranks stays the same too, if it is on in both. It
   has to be on when forces are pushed; with up to 2^31 force nodes of a member, rounding to the nearest, and what the
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
/* All other settings, by name and text. key, value: in.
     newton.stop            tied (default) | strict: where Newton's iteration of a step ends: tied, when what it leaves
                            is a thousandth of the error of the step, by (E1) of docs/theory.md in the steps before, as
                            a change of velocities that lasts, and of what the coupling is iterated to, by the
                            motion; within 1e-7 and rtol of the increments. Strict at atol and rtol: the first step, at
                            rest, without inertia. Strict: always there. spar_session_set_newton makes it strict.
                            spar_member_get_iterations tells what is left
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
     fluid.theta            average (default) | group: pull at 0 < theta < 1 gives the average of the two states,
                            (T12), or the node motion interpolated on the group (does not cut corners)
     fluid.added_mass       acceleration (default) | velocity: what the fluids' added mass answers to, for loads that
                            are predicted of members with one that is given or learned: accelerations as they are
                            pulled at t^{n+1}, or the change of the velocity over the step, as flow solvers with
                            moving walls have it; explicit coupling with heavy fluids of that kind needs it. With one
                            substep
     fluid.far              take (default) | refuse: fluid nodes beyond max_distance are flagged, or SPAR_ERR_MAPPING
     fluid.audit            on (default) | off: whether push keeps the figures of spar_fluid_get_audit
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
/* What the coupling says of itself; the same on all ranks. report[capacity]: out, by SPAR_REPORT_*, NULL: not wanted.
   Local. */
SPAR_API int spar_session_get_report(const spar_session *session, int64_t capacity, double *report);
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
/* The clock. Each NULL: not wanted. Local.
     t: out, t^n in s, the time of the last accepted step, from 0
     step: out, steps accepted
     iteration: out, coupling iterations of the step under way, or of the last step or static solution */
SPAR_API int spar_session_get_time(const spar_session *session, double *t, int64_t *step, int *iteration);
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
/* Sums numbers over the ranks of the session, so that what is built on one (a blade element model, a load report) needs
   no MPI of its own; with n = 0 the ranks agree on a status. At any time. Collective.
     status: in, SPAR_OK, or what this rank has failed with: it is answered here, and the others answer SPAR_ERR_PEER
           with this rank's spar_session_message; the numbers then stay as they are
     n: in, how many, the same on all ranks
     x[n]: in, this rank's; out, the sums, the same bits on all ranks */
SPAR_API int spar_session_sum(spar_session *session, int status, int64_t n, double *x);

/* Levels of the log. */
enum { SPAR_LOG_ERROR = 0, SPAR_LOG_WARNING = 1, SPAR_LOG_INFO = 2 };
/* Called with every message of the session, on the rank and in the thread where it arises; it must not call the
   session. */
typedef void (*spar_log)(const spar_session *session, int level, const char *text, void *context);
/* Who is told. Local, at any time.
     log: in, NULL: nobody (default)
     context: in, handed to log; must live as long as the session uses it */
SPAR_API int spar_session_set_log(spar_session *session, spar_log log, void *context);

/* ---- members ----------------------------------------------------------------------------------------------------- */

/* Root conditions; the root is node 0. */
enum {
    SPAR_ROOT_FREE = 0,
    SPAR_ROOT_FIXED = 1,  /* stands still */
    SPAR_ROOT_PINNED = 2, /* turns freely about a fixed place */
    SPAR_ROOT_DRIVEN = 3  /* follows spar_member_drive */
};
/* Relative motions of a joint that are free, in its own axes; or-ed. */
enum { SPAR_FREE_X = 1, SPAR_FREE_Y = 2, SPAR_FREE_Z = 4, SPAR_FREE_RX = 8, SPAR_FREE_RY = 16, SPAR_FREE_RZ = 32 };
/* Loads that are kept: in global axes, or in the section's, turning with it. */
enum { SPAR_LOAD_DEAD = 0, SPAR_LOAD_FOLLOWER = 1 };
/* Rules of integration along an element, spar_beam_set_quadrature. */
enum { SPAR_QUADRATURE_GAUSS = 0, SPAR_QUADRATURE_LOBATTO = 1, SPAR_QUADRATURE_SECTIONS = 2 };
/* Effects: what is off is not computed, stored or sent. */
enum {
    SPAR_EFFECT_INERTIA = 1,        /* off: each step is a static equilibrium */
    SPAR_EFFECT_GYROSCOPIC = 2,     /* forces quadratic in the angular velocity */
    SPAR_EFFECT_GRAVITY = 4,        /* weight */
    SPAR_EFFECT_DAMPING = 8,        /* spar_beam_set_damping, spar_beam_set_mass_damping */
    SPAR_EFFECT_FLUID_MOMENT = 32,  /* moments given to spar_fluid_push_forces */
    SPAR_EFFECT_FLUID_HISTORY = 64, /* node forces kept for spar_fluid_pull_forces */
    SPAR_EFFECT_WORK = 128,         /* the account of spar_member_get_work */
    SPAR_EFFECT_DEFAULT = 256,      /* all that is on where nothing is set; or-ed with what is wanted besides */
    SPAR_EFFECT_MASSES = 512,       /* bodies of spar_beam_set_masses */
    SPAR_EFFECT_FOUNDATION = 1024,  /* springs of spar_beam_set_foundation */
    SPAR_EFFECT_PRETENSION = 2048   /* section forces of spar_beam_set_pretension */
};

/* How much of a beam's mechanics is kept; each is the limit of those below it in this list for small deformation. */
enum {
    SPAR_FIDELITY_PRESCRIBED = 0, /* follows the root as one rigid body, without mass; nothing is solved */
    SPAR_FIDELITY_RIGID = 1,      /* one rigid body of the whole mass; 6 unknowns at most */
    SPAR_FIDELITY_LINEAR = 2,     /* small deformation in the frame of the root; factored once */
    SPAR_FIDELITY_MODAL = 3,      /* the same in its lowest modes */
    SPAR_FIDELITY_EXACT = 4
};

/* The creates: name in, unique in the session, not empty, copied. Before the first step. Members go with their
   session. Local, but made on every rank alike and in the same order. member: out. */

/* A massless node with 6 degrees of freedom that follows spar_member_set_motion or spar_member_drive.
     x[3]: in, reference place, m, NULL: the origin
     q[4]: in, reference orientation, NULL: none */
SPAR_API int spar_point_create(spar_session *session, const char *name, const double x[3], const double q[4],
                               spar_member **member);
/* A rigid body of one node. Default root: free.
     x[3], q[4]: in, as for a point
     mass[36]: in, about the node and in the frame q: m I, m c~ and J as of a rigid body with its centre of mass at c;
           any other form is refused */
SPAR_API int spar_rigid_create(spar_session *session, const char *name, const double x[3], const double q[4],
                               const double mass[36], spar_member **member);
/* A geometrically exact (Simo-Reissner) beam of Legendre spectral elements. Needs a line (axis or nodes) and sections
   before the commit. Default root: fixed.
     elements: in, >= 1
     nodes_per_element: in, 2 to 24. Fewer than 5 lock where axial or shear stiffness times length squared is large
           beside bending stiffness: the commit tells the log (SPAR_LOG_WARNING), with the number that avoids it */
SPAR_API int spar_beam_create(spar_session *session, const char *name, int elements, int nodes_per_element,
                              spar_member **member);
/* What it was created with, or, within a trial that varies nodes, has now. elements, nodes_per_element: out, NULL: not
   wanted. Local. */
SPAR_API int spar_beam_get_elements(const spar_member *beam, int *elements, int *nodes_per_element);
/* The reference line by points, in the beam's own frame; the nodes are a least-squares fit, exact at both ends.
   Replaces an earlier line. Local.
     n: in, points, >= 2
     eta[n]: in, strictly increasing, the first 0, the last 1
     xyz[n][3]: in, m
     twist[n]: in, rad about the tangent, right-handed, linear between the points, NULL: 0 */
SPAR_API int spar_beam_set_axis(spar_member *beam, int64_t n, const double *eta, const double *xyz,
                                const double *twist);
/* The nodes themselves, instead of an axis, in the beam's own frame. Local.
     n: in, elements*nodes_per_element, element by element (a joint stands twice, at the same place; its two
           orientations may differ: a kink)
     x[n][3]: in, m
     q[n][4]: in, section frames, NULL: tangent and the rule of the conventions
   The commit refuses nodes that coincide or go back: they stand at their elements' Gauss-Lobatto-Legendre points. */
SPAR_API int spar_beam_set_nodes(spar_member *beam, int64_t n, const double *x, const double *q);
/* Sections, linear in eta between their stations and constant beyond the first and last. Local.
     n: in, stations, >= 1
     eta[n]: in, strictly increasing in [0,1]
     stiffness[n][36]: in, N, N m, N m^2, symmetric and positive definite
     mass[n][36]: in, per length, kg/m, kg, kg m, of the form of a rigid section, NULL: massless */
SPAR_API int spar_beam_set_sections(spar_member *beam, int64_t n, const double *eta, const double *stiffness,
                                    const double *mass);
/* Rigid bodies, or points of mass, that sit on a beam and go with its line and its sections: a nacelle, an engine, a
   float, an instrument. Their inertia, gyroscopic terms and weight are the beam's, in all that is made of these: steps,
   statics on turning roots, modes, energies, reactions; every fidelity that has mass has them. Replaces what was set
   before. Local, before commit.
     n: in, 0 to 10000, 0: none any more
     eta[n]: in, in [0,1], in any order; several may be at one place
     mass[n][36]: in, about the line at eta and in the section's axes there: m I, m c~ and J as of a rigid body with its
           centre of mass at c; any other form is refused
   A body belongs to the place of the line and not to a node: between nodes it moves as the field between them does, and
   where its weight or inertia is large an end of an element there takes the kink that it makes in the section forces.
   SPAR_ERR_STATE at commit: the sections have no mass. */
SPAR_API int spar_beam_set_masses(spar_member *beam, int64_t n, const double *eta, const double *mass);
/* n: out, how many there are, NULL: not wanted; capacity: in, of the arrays; eta[capacity], mass[capacity][36]: out, 0
   behind the last, NULL: not wanted. Local. */
SPAR_API int spar_beam_get_masses(const spar_member *beam, int64_t *n, int64_t capacity, double *eta, double *mass);
/* A foundation: springs to the ground all along a beam, soil about a pile or a rail's bed. They pull the line back to
   where it is in the reference configuration, with a force per unit length of stiffness times displacement, along axes
   that stay; their tangent is exact. They take part in steps, statics, modes and eigenvalues, and are loads in what
   spar_member_get_loads gives, in reactions and in the account of work; what they store is in
   spar_member_get_energy. Replaces what was set before. Local, before commit.
     n: in, stations, 0 to 10000, 0: none (default)
     eta[n]: in, not decreasing in [0, 1], two stations at one eta are a jump
     stiffness[n][3]: in, N/m^2, >= 0, along the section's axes in the reference configuration (x tangent, y, z); linear
           in eta between stations, zero before the first and behind the last; n = 1: the same all along
   SPAR_ERR_UNSUPPORTED at commit: the member is prescribed, rigid or external, or linear or modal with a root that is
   driven; or at the step, when joints move the root of a linear or modal one (its frame then moves against the ground).
   Modes of a modal member are those on its springs. */
SPAR_API int spar_beam_set_foundation(spar_member *beam, int64_t n, const double *eta, const double *stiffness);
/* n: out, stations, NULL: not wanted; capacity: in, of the arrays; eta[capacity], stiffness[capacity][3]: out, 0 behind
   the last, NULL: not wanted. Local. */
SPAR_API int spar_beam_get_foundation(const spar_member *beam, int64_t *n, int64_t capacity, double *eta,
                                      double *stiffness);
/* Pretension: section forces that the beam carries in its reference configuration, where no strain is: of a cable, a
   string, a shaft that was pulled, a section with tendons. They stay what they are in the section's axes, which turn,
   and those of the strains are added to them: straight under a tension N a beam has the bending stiffness of EI and the
   string's N besides, under -N it buckles. In steps, statics, modes and eigenvalues, section forces and energies. Where
   neither roots, joints nor loads balance it, the beam takes the shape that does: an end that nothing holds lets the
   tension go. A linear or modal member has the stiffness of what is given, balanced or not; a rigid or prescribed one,
   which does not deform, leaves it out. Replaces what was set before. Local, before commit.
     n: in, stations, 0 to 10000, 0: none (default)
     eta[n]: in, strictly increasing in [0,1]
     force[n][6]: in, N and N m: axial (> 0: tension), shear y, z, torsion, bending y, z, as of the stiffness; linear in
           eta between stations, constant before the first and behind the last */
SPAR_API int spar_beam_set_pretension(spar_member *beam, int64_t n, const double *eta, const double *force);
/* n: out, stations, NULL: not wanted; capacity: in, of the arrays; eta[capacity], force[capacity][6]: out, 0 behind the
   last, NULL: not wanted. Local. */
SPAR_API int spar_beam_get_pretension(const spar_member *beam, int64_t *n, int64_t capacity, double *eta,
                                      double *force);
/* Integration along an element. Default: sections if there are more than two stations, else Gauss with as many points
   as nodes. Commit refuses a rule too coarse for the element. Local.
     rule: in, SPAR_QUADRATURE_GAUSS or _LOBATTO with `points` in an element, _SECTIONS with `points` Gauss points in
           each piece between section stations
     points: in, 1 (Lobatto 2) to 512 */
SPAR_API int spar_beam_set_quadrature(spar_member *beam, int rule, int points);
/* rule: out, the one in force; points: out, 0 if they were not set: as many as nodes, or in each piece between sections
   as many as its length asks for. NULL: not wanted. Local. */
SPAR_API int spar_beam_get_quadrature(const spar_member *beam, int *rule, int *points);
/* Stiffness-proportional damping: stress = C (strain + mu strain rate), per strain component in the order of the
   stiffness. mu[6]: in, s, >= 0. Local. */
SPAR_API int spar_beam_set_damping(spar_member *beam, const double mu[6]);
/* Mass-proportional damping, the other half of Rayleigh's: mass times alpha times the velocity that the root sees, with
   its own motion and turn taken off, so that a blade that turns as a whole is not braked. Where the root is free or
   pinned, or joints move it, it is the velocity as it is, seen from axes that stand: a beam that flies is braked as by
   a fluid about it, its momenta go down as exp(-alpha t). A mode at omega at rest has alpha / (2 omega) of critical
   damping, and what spar_beam_set_damping gives it besides. As an outer force it takes part in the root's reaction. Of
   a rigid or prescribed beam on a root that is fixed or driven, which does not deform, and of one with INERTIA off it
   does nothing. SPAR_ERR_UNSUPPORTED at commit: the beam is rigid and its root free or pinned; at the step: it is
   linear or modal and joints move its root. Part of SPAR_EFFECT_DAMPING. Local, before commit.
     alpha: in, 1/s, >= 0; 0 (default): none */
SPAR_API int spar_beam_set_mass_damping(spar_member *beam, double alpha);
/* alpha: out, 1/s, NULL: not wanted. Local. */
SPAR_API int spar_beam_get_mass_damping(const spar_member *beam, double *alpha);
/* mu[6]: out, s, also those of spar_beam_set_modal_damping; 0: none. Local. */
SPAR_API int spar_beam_get_damping(const spar_member *beam, double mu[6]);
/* Axis, sections and damping of a beam from BeamDyn's files: the primary file's members, key points and twist, the
   blade file's stations. BeamDyn's z axis, along the blade, becomes the beam's x axis, its x and y axes y and z.
   Elements, nodes and quadrature are those of the beam, not of the files; where elements join is eta, not where members
   do. Every rank reads the files. Local, before commit.
     primary_path: in
     blade_path: in, NULL: the file that the primary one names, beside it
   SPAR_ERR_IO: a file cannot be read, or a field cannot; the message names file, line and field, and the beam is as it
   was. SPAR_ERR_ARGUMENT: a matrix is not allowed. SPAR_ERR_UNSUPPORTED: damp_type beyond 1. */
SPAR_API int spar_beam_read_beamdyn(spar_member *beam, const char *primary_path, const char *blade_path);
/* Takes the member from its own frame to its reference place: X -> R(q) X + x. For a point or a rigid body instead of
   those given to create. Local.
     x[3]: in, m, NULL: unchanged
     q[4]: in, NULL: unchanged */
SPAR_API int spar_member_set_placement(spar_member *member, const double x[3], const double q[4]);
/* x[3], q[4]: out, NULL: not wanted. Local. */
SPAR_API int spar_member_get_placement(const spar_member *member, double x[3], double q[4]);
/* kind: in, SPAR_ROOT_*. Local. */
SPAR_API int spar_member_set_root(spar_member *member, int kind);
/* kind: out. Local. */
SPAR_API int spar_member_get_root(const spar_member *member, int *kind);
/* on: in, 1: the host solves this member: motion by spar_member_set_motion, loads by spar_member_get_loads; a beam
   then needs no sections. Local. */
SPAR_API int spar_member_set_external(spar_member *member, int on);
/* on: out. Local. */
SPAR_API int spar_member_get_external(const spar_member *member, int *on);
/* effects: in, SPAR_EFFECT_* or-ed. Default: what the description implies (no damping given, none computed), without
   WORK, and with FLUID_HISTORY for the fluids that are made of sections. Asking for what the description has nothing
   for is legal and has no effect. Local. */
SPAR_API int spar_member_set_effects(spar_member *member, int effects);
/* effects: out, those in force: of what was asked for, or of all, what the description has something for. After commit.
   Local. */
SPAR_API int spar_member_get_effects(const spar_member *member, int *effects);
/* How a beam is solved. kind: in, SPAR_FIDELITY_*, default exact; modes: in, of a modal member, >= 1, else unused.
     prescribed  needs a fixed or driven root; its support takes the loads (get_reaction), it has neither inertia nor
                 weight
     rigid       any root; mass, centre and inertia from the sections. solve_static leaves it where it is
     linear      fixed or driven root: the root's motion is exact, the deformation seen from the root is linear, with
                 Coriolis, gyroscopic and centrifugal terms and the stiffening by centrifugal forces. Neglected: terms
                 of second order in the deformation (shortening of a bent beam; moments of loads on displaced arms),
                 stiffening by other loads. One factorisation as long as dt and the root's turning speed, in its own
                 axes, do not change. Free or pinned root: linear about the reference; nothing holds such a beam for
                 solve_static. A node that turns by half a turn against root or reference ends the step:
                 SPAR_ERR_NUMERIC. Where joints tie it the root may be free or pinned and turn as far as it likes: the
                 deformation is linear as seen from the root's node, wherever that goes; of the stiffening that along
                 the line counts, by the member's own inertia
     modal       as linear, with the lowest `modes` modes of the beam with its root held; of a free or pinned beam those
                 it has so, of which the first 6 or 3 move it as a rigid body. Initial deformation is brought to the
                 nearest one that the modes have. Where joints tie it: the 6 or 3 rigid motions of its root, and modes
                 with the root and all other tied nodes held; each of these other nodes brings six shapes of its own, in
                 which it moves and the rest follows statically (Craig and Bampton), beside the `modes`; more modes than
                 the other nodes leave are not taken
   Beams only, before commit. Local. At commit SPAR_ERR_ARGUMENT: more modes than the nodes have, or fewer than those 6
   or 3; SPAR_ERR_STATE: linear or modal, free or pinned, with INERTIA off; SPAR_ERR_NUMERIC: fewer modes with mass. */
SPAR_API int spar_member_set_fidelity(spar_member *member, int kind, int64_t modes);
/* kind: out; modes: out, of a modal member, else 0. NULL: not wanted. Local. */
SPAR_API int spar_member_get_fidelity(const spar_member *member, int *kind, int64_t *modes);
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
/* Initial velocities of a rigid motion: v0 + omega x (x - x0) and omega. What the root condition holds has none. Before
   the first step, before or after commit. Local.
     x0[3]: in, m; v0[3]: in, m/s; omega[3]: in, rad/s; each NULL: 0 */
SPAR_API int spar_member_set_initial_velocity(spar_member *member, const double x0[3], const double v0[3],
                                              const double omega[3]);
/* rank: in, who solves the member; it needs no fluid nodes. Default: at the first step or static solution members go to
   the rank that has least to do by then, the dearest first, by what nodes, fidelity and joints lead one to expect
   (spar_session_sum_balance); those that joints tie are solved by one rank, and an owner given here is that of all of
   them. Local. */
SPAR_API int spar_member_set_owner(spar_member *member, int rank);
/* rank: out, who solves it; before the first step, or static solution, who would. Local. */
SPAR_API int spar_member_get_owner(const spar_member *member, int *rank);
/* Checks the description, that it is the same on every rank (SPAR_ERR_COMM if not), and takes all memory; nothing of
   it can be changed afterwards. Needed before anything below. Collective. */
SPAR_API int spar_member_commit(spar_member *member);

/* State. The getters are local and answer on every rank; n is the number of nodes. During a step they give the latest
   iterate at t^{n+1}, between steps the state at t^n. */

/* nodes: out. Before commit too. */
SPAR_API int spar_member_get_count(const spar_member *member, int64_t *nodes);
/* session: out, that the member was created in. Before commit too. */
SPAR_API int spar_member_get_session(const spar_member *member, spar_session **session);
/* The name it was created with, as long as its session lives; "" of NULL. */
SPAR_API const char *spar_member_get_name(const spar_member *member);
/* Reference configuration, placed. Each NULL: not wanted.
     x[n][3]: out, m
     q[n][4]: out, section frames */
SPAR_API int spar_member_get_reference(const spar_member *member, double *x, double *q);
/* A fluid that answers to accelerations pulls them (spar_fluid_pull_sections): in uneven steps and in substeps it must
   not answer to these. Each NULL: not wanted.
     q[n][7], v[n][6], a[n][6]: out */
SPAR_API int spar_member_get_motion(const spar_member *member, double *q, double *v, double *a);
/* For external members and points. During a step: the motion at t^{n+1}, may be given again in every iteration; before
   the first step: the initial motion. Local, the same on every rank.
     q[n][7], v[n][6], a[n][6]: in, NULL: unchanged */
SPAR_API int spar_member_set_motion(spar_member *member, const double *q, const double *v, const double *a);
/* Motion of a driven root, or of a point, at the end of the step begun next; within it the motion is interpolated.
   Between steps only; not driven anew, the root stays where it is. Local, the same on every rank.
     q[7]: in
     v[6], a[6]: in, NULL: 0 */
SPAR_API int spar_member_drive(spar_member *member, const double q[7], const double v[6], const double a[6]);
/* A load on a node, which replaces the node's earlier one of that kind and is kept; zeros take it away. A node bears
   the sum of its two kinds. An exact member has the exact tangent of followers (unsymmetric). On a linear or modal
   beam with a free or pinned root that no joint ties, a follower keeps its direction of the reference. After commit.
   The load given before a step is that at the step's end, t^{n+1}. Within the step, with any number of substeps, the
   load goes linearly from its value in the step before; a load given for the first time goes from 0. The first step has
   no step before it: its loads act from t = 0 on. A load that is taken off there, after a static solution, is gone at
   once. For a jump later in a run take one short step with the new load. A static solution in the run counts as a step.
     node: in, 0 to n-1
     kind: in, SPAR_LOAD_DEAD: in global axes, does not turn; _FOLLOWER: in the node's section axes (x tangent, y, z; a
           rigid body's own axes), turns with it
     load[6]: in, N, N m
   Local, the same on every rank. */
SPAR_API int spar_member_set_load(spar_member *member, int64_t node, int kind, const double load[6]);
/* Loads along a beam, per unit length of the reference line, which replace the earlier ones of that kind and are kept.
   They are those at the end of the next step, linear in the step as those of spar_member_set_load.
     kind: in, SPAR_LOAD_DEAD (global axes) or _FOLLOWER (section axes, turning with the section)
     n: in, stations, 0: none any more
     eta[n]: in, not decreasing in [0, 1], two stations at one eta are a jump
     load[n][6]: in, N/m, N m/m, linear in eta between stations, zero before the first and behind the last; n = 1: the
           same all along
   They work at quadrature points of their own, so that they may change where sections do not, through the virtual work
   of the beam's displacement and rotation field. After commit. Local, the same on every rank. SPAR_ERR_ARGUMENT: no
   beam, or eta or load not allowed. */
SPAR_API int spar_beam_set_line_load(spar_member *beam, int kind, int64_t n, const double *eta, const double *load);
/* load[n][6]: out, N, N m, dead, follower, line and fluid loads in use, global axes, line loads as the nodal loads that
   do the same work: those the structure is to be solved with. After spar_step_begin these are predicted; after a
   spar_step_check that was not done they are the accelerated ones of the next solution (an external member is solved
   with these); after one that was done, and between steps, those pushed last. Of an external member they have what
   joints put on it, predicted and accelerated with the rest; of a point the joints' at the latest iterate. */
SPAR_API int spar_member_get_loads(const spar_member *member, double *load);
/* load[6]: out, what the support gives the root, moment about the root; 0 where it is free. */
SPAR_API int spar_member_get_reaction(const spar_member *member, double load[6]);
/* Sections of a beam now. Local. Each output NULL: not wanted.
     n: in, places
     eta[n]: in, in [0, 1]; a joint belongs to the element before it
     strain[n][6]: out, stretch, shears, twist, curvatures beyond the reference (1, 1/m)
     force[n][6]: out, N, N m, what the part beyond gives
     x[n][3]: out, place, m
     q[n][4]: out, orientation
   Strain and force are in section axes (x tangent, y, z), in the order axial, shear y, shear z, torsion, bending y,
   bending z. force is the balance of the part beyond: its loads, what joints put on it, less its inertia. It is as
   exact as the reaction, and at the root it is the reaction less the loads at that node. A load at a node within the
   line counts in the section there. Strains converge one order behind the displacements; stiffness and damping times
   them is force only in the limit. force is made of them for a beam that is rigid, prescribed or external, and until a
   first step or static solution has found a balance. The strains of a linear or modal member are those of linear
   theory, as in its strain energy: of the displacement and rotation vector seen from the root where that is fixed or
   driven or joints tie the beam, else from the reference; of a rigid or prescribed one 0. Its forces have the arms and
   axes of the reference where its equations stand there: fixed, pinned or free roots, without pretension. SPAR_ERR_UNSUPPORTED: force of a beam without
   sections. */
SPAR_API int spar_beam_evaluate(const spar_member *beam, int64_t n, const double *eta, double *strain, double *force,
                                   double *x, double *q);
/* Energies of a member, J. */
enum {
    SPAR_ENERGY_KINETIC = 0,
    SPAR_ENERGY_STRAIN = 1,     /* 0 in the reference configuration; with pretension it may fall below */
    SPAR_ENERGY_GRAVITY = 2,    /* potential, 0 in the reference configuration */
    SPAR_ENERGY_DISSIPATED = 3, /* by damping since t = 0, up to t^n */
    SPAR_ENERGY_FOUNDATION = 4, /* stored in the springs of spar_beam_set_foundation */
    SPAR_ENERGY_COUNT = 5
};
/* energy[capacity]: out, by SPAR_ENERGY_*, NULL: not wanted. Members spar does not solve for give zeros. Linear
   and modal members give the quadratic forms of their equations; on a driven root only the strain energy, the others
   are those of the motion. A modal member that joints tie gets its shapes for that from
   the first call that steps, solves, saves or tries, and its energies are of those from then on. */
SPAR_API int spar_member_get_energy(const spar_member *member, int64_t capacity, double *energy);
/* Work done on a member, J. */
enum {
    SPAR_WORK_LOADS = 0,  /* by the loads kept: dead, follower, line */
    SPAR_WORK_FLUID = 1,  /* by the fluids */
    SPAR_WORK_ROOT = 2,   /* by a driven root */
    SPAR_WORK_JOINTS = 3, /* by joints: what they give its nodes */
    SPAR_WORK_COUNT = 4
};
/* work[capacity]: out, by SPAR_WORK_*, NULL: not wanted. Of the accepted steps since the motion was set last (commit,
   static solution, initial velocity, load). Kinetic + strain + potential + dissipated energy less the sum of the four
   stays constant to the order of the integrator; of a linear or modal member on a root that turns but for the
   shortening of the bent beam, which they neglect. Local. SPAR_ERR_STATE: SPAR_EFFECT_WORK was not asked for. */
SPAR_API int spar_member_get_work(const spar_member *member, int64_t capacity, double *work);
/* Static equilibrium of one member under gravity, all kept loads and the fluid loads in use, from the present state;
   velocities become 0. With the fluid's answer: spar_session_solve_static. Between steps. Collective.
     load_steps: in, 1 to 100000, in how many parts the loads come on together; a part is halved and tried again where it
           fails. No more than 5000 parts are taken besides (SPAR_ERR_NUMERIC)
   A driven root that turns (spar_member_set_initial_velocity, or driven so far): equilibrium in the frame that turns
   with it, under the centrifugal loads of its angular velocity and the acceleration of its place; velocities and
   accelerations become those of the deformed shape turning steadily. Members that joints tie to such a root, to a node
   that is told to turn, or to a hinge that is driven with a rate against what stands, turn with it as one; there
   gravity and dead loads across the axis, parts that turn or are driven against each other, and joints to what stands
   that are not alike all around are SPAR_ERR_UNSUPPORTED. Under dead forces (no moments, no followers) the result is
   the stable equilibrium that growing loads lead to: past a limit or branching point there is none, and it is refused.
   Where neighbouring nodes are turned by more than 2.2 rad against each other, more than they can follow, a log is
   warned. Members that joints tie may be held by their loads alone, as a body that hangs on a hinge is: the solution goes
   downhill from the present state to a stable equilibrium. SPAR_ERR_NUMERIC: not found, the message says which part of
   the loads was reached and what is in the way: a motion that nothing holds, or one that would leave an unstable
   equilibrium (a body that stands on its hinge); SPAR_ERR_STATE: nothing holds the member; SPAR_ERR_UNSUPPORTED: spar
   does not solve for it. */
SPAR_API int spar_member_solve_static(spar_member *member, int load_steps);
/* The lowest modes about the present state, the root held as it is, in the frame that turns with the root's present
   angular velocity: geometric stiffness of the stress, centrifugal stiffening and spin softening included, Coriolis'
   terms left out; of unsymmetric load stiffness (followers) the symmetric part. Of a linear or modal
   member: those of its equations, with the root's present turn, without load stiffness; of a rigid one those of the
   rigid body. A rotor: set_root DRIVEN, set_initial_velocity, commit, solve_static, solve_modes.
   Of a member that joints tie to others: the modes of them all, on which they agree to the bit whichever is asked, and
   the member's part of the shapes; what joints hold or drive stands still, their springs and the turning of their loads
   are in the stiffness (solve statically first, so that the loads are known), their dampers are left out. Parts that
   turn are seen as said above, each from its root's frame, which means most where all turn alike. Local.
     n: in, modes, at most the number of free unknowns less what joints hold
     frequency_hz[n]: out, ascending, negative where the stiffness is, infinite where there is no mass
     shapes[n][nodes][6]: out, displacement and rotation, normalised to unit modal mass, of an assembly that of all its
           members together, NULL: not wanted */
SPAR_API int spar_member_solve_modes(spar_member *member, int64_t n, double *frequency_hz, double *shapes);
/* Eigenvalues of the small motions x e^(lambda t) about the present state, at rest or turning steadily, with all that
   spar_member_solve_modes leaves out: damping, Coriolis' and gyroscopic terms and the unsymmetric stiffness of loads
   that follow are in the equations M x'' + C x' + K x = 0 (docs/theory.md). lambda = growth rate, 1/s, + i times
   angular frequency, rad/s: a growth rate > 0 is an instability, with a frequency flutter or whirl, without one
   buckling. Of the conjugate pairs of eigenvalues the one with frequency >= 0 counts alone; a motion without stiffness
   (a free body's) has zero twice, which counts once. Fluid loads stay as they are: the fluid's answer is not there. Of
   a member that joints tie to others: those of them all, dampers included, the same whichever is asked. Linear and
   modal members: of their equations, as for modes. Local.
     n: in, how many, at most the number of unknowns that the roots leave free
     shift[2]: in, growth rate, 1/s, and angular frequency, rad/s: those nearest to it are found; NULL: zero, the lowest
     eigenvalue[n][2]: out, growth rate and angular frequency, by their distance from the shift
     shapes[n][nodes][6][2]: out, displacement and rotation, real and imaginary part, of unit x^H M x (of all parts
           together), the phase such that its largest part is real; NULL: not wanted
     frame[3]: out, rad/s, how the frame turns that x is seen from: as the whole where all turns as one (a whirl of w in
           axes that stand is seen as w +- that), else 0; NULL: not wanted
   Up to 90 unknowns are solved as one dense problem, more by restarted shift-and-invert Arnoldi iterations; what is
   handed out has been tried in the equations. SPAR_ERR_STATE: the state is no equilibrium; SPAR_ERR_UNSUPPORTED: parts
   turn against each other and are not alike all around, so that the equations change with time; SPAR_ERR_NUMERIC: fewer
   than n were found, the others having no mass or not converging. */
SPAR_API int spar_member_solve_eigenvalues(spar_member *member, int64_t n, const double shift[2], double *eigenvalue,
                                           double *shapes, double frame[3]);
/* Stiffness-proportional damping that gives two modes their damping ratios, in place of spar_beam_set_damping's and
   beside spar_beam_set_mass_damping's: each
   mode sets the mu of the strains that hold most of its energy (bending about y with shear z, bending about z with
   shear y, torsion with stretch), the third group gets the geometric mean. Between commit and the first step.
   Collective.
     mode[2]: in, from 0, as spar_member_solve_modes gives them now; of the member by itself where joints tie it
     ratio[2]: in, of critical, > 0
     mu[6]: out, s, what has been set, NULL: not wanted
   SPAR_ERR_ARGUMENT: both modes are of one kind; SPAR_ERR_NUMERIC: no mu gives these ratios (as of a mode that moves a
   free or pinned beam as a rigid body). */
SPAR_API int spar_beam_set_modal_damping(spar_member *beam, const int64_t mode[2], const double ratio[2], double mu[6]);

/* ---- joints ------------------------------------------------------------------------------------------------------ */

/* A joint ties node a of a member to node b of another (or of the same), or to the ground. In axes of its own it has
   six motions, of a relative to b, each held, free, driven, or on a spring and damper: displacements x, y, z of a's end
   in b's axes, and rotations. These are, to first order, turns about x, y, z.
   - None free: twice the vector part of the relative quaternion.
   - One free, a hinge: its angle, which counts its turns. The other two are how far a's axis leaves b's.
   - Two free, a universal joint: the angles about the two arms of its cross, which count their turns. The first free
     axis, in the order x, y, z, is fixed in b, the second in a. They stay perpendicular: the held coordinate is the sine
     of what they are off. The shafts of Hooke's joint lie along the held axis.
   - Three free, a ball: the rotation vector, below half a turn.
   Members that joints tie are solved together, as one system, on one rank (spar_member_set_owner); members without
   joints are solved as if there were none. Constraints hold in place and velocity at the end of every step, whatever dt
   is. A hold that follows from others in a loop (four parallel hinges of a four-bar) is left out, and named to the log.
   Joints tie rigid bodies, beams of any fidelity (spar_member_set_fidelity says what a linear or modal one is there),
   points and external members (points, external members and prescribed beams move as they are told, and
   spar_member_get_loads adds what joints put on them). In a trial, and with advice in force, a beam may have other
   nodes: its joints stay where they are, at ends of elements; a beam held within an element keeps its nodes.
   spar_member_solve_static solves for all that a member is tied to, at rest or turning as one; where nothing holds an
   assembly, the message names the motion that is free. */

/* A joint of two nodes. It goes with its session. Before the first step.
     name: in, unique in the session, not empty, copied
     a, node_a: in
     b, node_b: in, b NULL: the ground, node_b unused
     free_motions: in, SPAR_FREE_* or-ed: 0 a weld, RX a hinge, RX|RY a universal joint, RX|RY|RZ a ball, X a slider,
           X|RX a cylinder, X|Y|RZ a plane, all six for springs alone
     joint: out
   Local, but made on every rank alike and in the same order. SPAR_ERR_ARGUMENT: a node that is not there, or tied to
   itself; members of two sessions. */
SPAR_API int spar_joint_create(spar_session *session, const char *name, spar_member *a, int64_t node_a, spar_member *b,
                               int64_t node_b, int free_motions, spar_joint **joint);
/* Where the joint is. By default it is where node a is, where node b must be too, in the section axes of node a. Before
   the first step.
     x[3]: in, m, its place in the reference, to which rigid arms lead from both nodes
     q[4]: in, unit, its axes there, NULL: the section axes of node a
   Local. */
SPAR_API int spar_joint_set_frame(spar_joint *joint, const double x[3], const double q[4]);
/* Spring and damper between a and b on the free motions z: load on a = preload - stiffness z - damping dz/dt. Replaces
   what was set before.
     stiffness[36], damping[36]: in, symmetric, N/m, N, N m/rad (times s), 0 on what is held, NULL: 0
     preload[6]: in, N, N m, NULL: 0
   Local, the same on every rank. */
SPAR_API int spar_joint_set_spring(spar_joint *joint, const double stiffness[36], const double damping[36],
                                   const double preload[6]);
/* The short form: a joint of one node with the ground, at the node and in its section axes (a rigid body's own). What
   spar_joint_create, with the name "MEMBER.NODE", and spar_joint_set_spring do in one call. Before the first step.
     node: in
     free_motions: in, SPAR_FREE_* or-ed; the others are held: a cylinder in a stream has SPAR_FREE_Y
     stiffness, damping, preload: in, as in spar_joint_set_spring
     joint: out, NULL: not wanted
   Local, the same on every rank. */
SPAR_API int spar_member_set_spring(spar_member *member, int64_t node, int free_motions, const double stiffness[36],
                                    const double damping[36], const double preload[6], spar_joint **joint);
/* Which of the free motions spar_joint_drive moves. They begin as the members do. Before the first step.
     mask: in, SPAR_FREE_* or-ed, of the free ones
   Local. */
SPAR_API int spar_joint_set_driven(spar_joint *joint, int mask);
/* Driven motions at the end of the step begun next; not driven anew, they stay where they are. Entries of what is not
   driven are not looked at. Between steps.
     motion[6]: in, m, rad; angles of a hinge or universal joint with their turns; of a ball the rotation vector, which
           is below half a turn (SPAR_ERR_ARGUMENT)
     rate[6], acceleration[6]: in, of them, NULL: 0
   Local, the same on every rank. */
SPAR_API int spar_joint_drive(spar_joint *joint, const double motion[6], const double rate[6],
                              const double acceleration[6]);
/* A load between the two nodes, kept until it is set anew: a motor, a generator, a brake. It is the load at the end of
   the next step, linear in the step as that of spar_member_set_load.
     load[6]: in, N, N m, on a from b, on the free motions
   Local, the same on every rank. */
SPAR_API int spar_joint_set_load(spar_joint *joint, const double load[6]);
/* A joint whose one motion, the first of six, is the distance of two points, which their nodes carry. It is held (a
   rod), or driven (an actuator, motion[0] its length), or on a spring. Else as spar_joint_create.
     point_a[3], point_b[3]: in, m, global, in the reference; not the same
     b NULL: the ground carries point_b */
SPAR_API int spar_link_create(spar_session *session, const char *name, spar_member *a, int64_t node_a,
                              const double point_a[3], spar_member *b, int64_t node_b, const double point_b[3],
                              spar_joint **joint);
/* The spring of a line. Before the first step.
     stiffness: in, N/m, >= 0
     damping: in, N s/m, >= 0
     length: in, m, unstretched, >= 0
     tension_only: in, 1: it pulls or is slack (a taut mooring, a rope), 0: both ways (a strut). Up to its length it is
           slack, without load. Beyond it the pull is max(0, k (d - l) + c d'). In the step in which it comes taut, d' is
           at most the rate at which the stretch can have grown within the step
   Local. */
SPAR_API int spar_link_set_spring(spar_joint *joint, double stiffness, double damping, double length, int tension_only);
/* Relative motion of the latest iterate, t^n between steps; 0 before the first step or static solution.
     motion[6], rate[6], acceleration[6]: out, m, rad, and their rates (1/s, 1/s^2), NULL: not wanted; a line has its
           distance in the first. acceleration is that of the nodes' accelerations
   Local, the same on every rank. */
SPAR_API int spar_joint_get_motion(const spar_joint *joint, double motion[6], double rate[6], double acceleration[6]);
/* The load that the joint puts on a, in its axes and at a's end of it; b takes the opposite.
     load[6]: out, N, N m: of what is held the constraint's, of what is free those of spring, damper and
           spar_joint_set_load
   Local, the same on every rank. */
SPAR_API int spar_joint_get_load(const spar_joint *joint, double load[6]);
/* Energies of a joint, J. */
enum {
    SPAR_JOINT_ENERGY_SPRING = 0, /* stored in its springs, less what the preload has given; of the latest iterate; 0
                                     before the first step or static solution */
    SPAR_JOINT_ENERGY_DAMPER = 1, /* taken by its dampers, up to t^n, as the next two */
    SPAR_JOINT_ENERGY_DRIVE = 2,  /* given by what drives it */
    SPAR_JOINT_ENERGY_LOAD = 3,   /* given by spar_joint_set_load */
    SPAR_JOINT_ENERGY_COUNT = 4
};
/* energy[capacity]: out, by SPAR_JOINT_ENERGY_*, NULL: not wanted. The account is kept where one of its members has
   SPAR_EFFECT_WORK, and begins anew with that member's (spar_member_get_work). The work that it does on its two nodes
   (SPAR_WORK_JOINTS; the ground takes none) is what drive and load give less what the damper takes and the spring
   stores, to the order of the integrator. Local. SPAR_ERR_STATE: no account is kept. */
SPAR_API int spar_joint_get_energy(const spar_joint *joint, int64_t capacity, double *energy);

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
/* The two sets of nodes of a fluid: those that move with the member, and those that forces are pushed at. */
enum { SPAR_NODES_MOTION = 0, SPAR_NODES_FORCE = 1 };
/* Flags of a mapped node. */
enum {
    SPAR_MAP_END = 1,       /* it lies beyond an end of the line, which is its foot */
    SPAR_MAP_AMBIGUOUS = 2, /* two places are equally near: smallest xi taken */
    SPAR_MAP_FAR = 4        /* farther than max_distance */
};

/* All calls on fluids but spar_fluid_sum_loads and spar_fluid_check_loads are local: a fluid is this rank's. A member
   can have many, from any of its ranks. n is the number of nodes of the set in question. Nodes and maps change between
   steps only. Where ranks share a border, motion nodes may repeat on them (each is moved alike); a force node belongs
   to one rank, for loads of all ranks add up. */

/* name: in, not empty, for the messages. fluid: out. */
SPAR_API int spar_fluid_create(spar_member *member, const char *name, spar_fluid **fluid);
/* member: out, that the fluid was created for. */
SPAR_API int spar_fluid_get_member(const spar_fluid *fluid, spar_member **member);
/* The name it was created with, as long as it lives; "" of NULL. */
SPAR_API const char *spar_fluid_get_name(const spar_fluid *fluid);
/* A fluid may go before its session; its loads go with it. Within a trial run too: the trial goes on without it, and it
   stays gone when the trial has gone back. */
SPAR_API void spar_fluid_destroy(spar_fluid **fluid);
/* Nodes that are moved, by their places in the reference configuration. To be mapped.
     n: in
     x[n][3]: in, m */
SPAR_API int spar_fluid_set_motion_nodes(spar_fluid *fluid, int64_t n, const double *x);
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
/* Nodes that loads come from. As above. */
SPAR_API int spar_fluid_set_force_nodes(spar_fluid *fluid, int64_t n, const double *x);
/* Sections of a blade element model, instead: motion nodes and force nodes at given places of the line. Keeps the node
   forces, unless spar_member_set_effects has left SPAR_EFFECT_FLUID_HISTORY out. To be mapped.
     n: in
     xi[n]: in, in [-1,1] over the whole beam
     offset[n][3]: in, m, from the line to the node in the section frame (x tangent, y, z), NULL: 0 */
SPAR_API int spar_fluid_set_stations(spar_fluid *fluid, int64_t n, const double *xi, const double *offset);
/* Motion nodes alone as sections, beside force nodes at other places: those of spar_fluid_set_stations, which stay
   where they are with the forces that are kept, or of spar_fluid_set_force_nodes. For actuator lines whose velocities
   are sampled at fewer or other sections than forces are spread from (AMR-Wind), or at three quarters of the chord.
   Forces are pushed to, and pulled at (spar_fluid_pull_forces, spar_fluid_pull_force_places), the force nodes; all
   other pulls are at the motion nodes. To be mapped. n, xi[n]: in, as above; offset[n][3]: in, as above, NULL: 0. */
SPAR_API int spar_fluid_set_motion_stations(spar_fluid *fluid, int64_t n, const double *xi, const double *offset);
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
     max_distance: in, m, beyond which a node is flagged SPAR_MAP_FAR (and refused under the option fluid.far = refuse);
           <= 0: no limit (default) */
SPAR_API int spar_fluid_set_projection(spar_fluid *fluid, int method, double max_distance);
/* method, max_distance: out, NULL: not wanted. */
SPAR_API int spar_fluid_get_projection(const spar_fluid *fluid, int *method, double *max_distance);
/* kind: in, SPAR_INTERPOLATE_*, default nodal. */
SPAR_API int spar_fluid_set_interpolation(spar_fluid *fluid, int kind);
/* kind: out. */
SPAR_API int spar_fluid_get_interpolation(const spar_fluid *fluid, int *kind);
/* Finds the foot of every node on the reference line, (T1) to (T3): the nearest place of all, of equally near ones
   the first along the line. The member must be committed; the feet of a point or rigid body are its node. A joint
   belongs to the lower element. To be called after nodes are set or replaced; sets that were not replaced are mapped
   again where they were. A map is not saved with a session: it is found again, a million nodes in half a second.
   SPAR_ERR_MAPPING: see fluid.far; the nodes then stay unmapped. */
SPAR_API int spar_fluid_map(spar_fluid *fluid);
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
/* Where the nodes are mapped to. Each NULL: not wanted.
     xi[n]: out, of the foot, over the whole beam
     distance[n]: out, m
     flags[n]: out, SPAR_MAP_* or-ed */
SPAR_API int spar_fluid_get_map(const spar_fluid *fluid, int which, double *xi, double *distance, int *flags);
/* The feet. Each NULL: not wanted.
     x_map[n][3]: out, foot in the reference configuration, m
     q_map[n][4]: out, its section frame
     con[n][3]: out, from the foot to the node, the arm c of (T3), m */
SPAR_API int spar_fluid_get_feet(const spar_fluid *fluid, int which, double *x_map, double *q_map, double *con);
/* The interpolation behind the map. Each NULL: not wanted.
     first_node[n]: out, node of the member that the P = nodes_per_element basis values begin at
     phi[n][P]: out */
SPAR_API int spar_fluid_get_basis(const spar_fluid *fluid, int which, int64_t *first_node, double *phi);
/* Motion nodes at t^n + theta dt (parts 3 and 4 of a step, (T4) to (T6)); before the first step: the initial state.
   Each output NULL: not wanted.
     theta: in, in [0,1]: 1 backward Euler, 1/2 Crank-Nicolson, 0 explicit
     x[n][3]: out, places, m
     v[n][3]: out, m/s
   SPAR_ERR_NUMERIC: the rotations of an element's nodes cancel. */
SPAR_API int spar_fluid_pull_motion(spar_fluid *fluid, double theta, double *x, double *v);
/* At the same nodes and time. Each NULL: not wanted.
     q[n][4]: out, orientation of the section now, scalar part >= 0
     omega[n][3]: out, rad/s
     accel[n][3]: out, acceleration of the node, m/s^2. Of a member without a guess of the added mass, with substeps and
           from the first step of another length on, the mean over the step carried on to its end by the mean before,
           (T15): of second order too, and one that an added mass may answer to */
SPAR_API int spar_fluid_pull_sections(spar_fluid *fluid, double theta, double *q, double *omega, double *accel);
/* All of a section's motion at once, for blade element hosts, at the motion nodes. Each NULL: not wanted.
     x[n][3]: out, m
     q[n][4]: out, as above
     v[n][3]: out, m/s
     omega[n][3]: out, rad/s
     accel[n][3]: out, m/s^2
     alpha[n][3]: out, rad/s^2 */
SPAR_API int spar_fluid_pull_poses(spar_fluid *fluid, double theta, double *x, double *q, double *v, double *omega,
                                   double *accel, double *alpha);
/* How far the motion nodes of this rank have gone since t^n, in the latest iterate: what a mesh has to follow. Between
   steps 0.
     largest: out, m, of all of them
     node: out, which, the first of equals; -1: there are none
   Each NULL: not wanted. */
SPAR_API int spar_fluid_get_travel(spar_fluid *fluid, double *largest, int64_t *node);
/* Force nodes at t^n + theta dt, where an actuator line spreads what spar_fluid_pull_forces gives at the same theta.
   Each output NULL: not wanted. x[n][3], v[n][3]: out, m, m/s q[n][4]: out, orientation of the section now, scalar part
   >= 0 */
SPAR_API int spar_fluid_pull_force_places(spar_fluid *fluid, double theta, double *x, double *v, double *q);
/* Either set at t^{n+1} as it stands in the latest iterate, between steps now: for pictures and post-processing. A
   getter: it counts as no pull, and a trial leaves nothing out. Each output NULL: not wanted.
     which: in, SPAR_NODES_*
     x[n][3], v[n][3]: out, m, m/s, of nodes with weights the part they take
     q[n][4]: out, orientation of the section at the foot, scalar part >= 0
     foot[n][3]: out, m, where the foot is */
SPAR_API int spar_fluid_get_positions(const spar_fluid *fluid, int which, double *x, double *v, double *q, double *foot);
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
/* Loads at t^{n+1} on the force nodes where they are now (part 7 of a step, (T8) to (T10)); before the first step those
   at t = 0. Replaces what the fluid pushed before.
     force[n][3]: in, N
     moment[n][3]: in, N m, about each node, NULL: none
   A refused push (NaN) leaves the loads as they were, and spar_step_check then fails on all ranks unless a good push
   follows. */
SPAR_API int spar_fluid_push_forces(spar_fluid *fluid, const double *force, const double *moment);
/* For a fluid that takes several steps within dt: its mean loads over the part of the step that ends at t^n + theta dt
   (it pulls at any theta). In use at t^{n+1} is m + (e - e^n) / 2: m the mean of the parts over the step so far, e
   where the line of least squares through them ends, e^n where that of the step before did (T13): of second order in
   dt, and the parts' impulse is kept. Loads that are known at t^{n+1} itself: spar_fluid_push_forces. Not before the
   first step; otherwise as that. theta: in, in (0, 1], rising from push to push; one that does not rise begins anew
   (the next iteration) */
SPAR_API int spar_fluid_push_forces_at(spar_fluid *fluid, double theta, const double *force, const double *moment);
/* The host's model has failed on this rank: there are no loads of this fluid, for the reason given. spar_step_check (or
   the call that runs the step, or the first spar_step_begin) then fails on all ranks unless a good push follows, with
   this status and message on this rank. Between steps nobody waits for loads, and nothing is done.
     status: in, a SPAR_ERR_*
     message: in, what, where, the cure; not empty, copied */
SPAR_API int spar_fluid_fail(spar_fluid *fluid, int status, const char *message);
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
/* The same calls for hosts in single precision: numbers are converted at the edge, all sums are double. */
SPAR_API int spar_fluid_pull_motion_f32(spar_fluid *fluid, double theta, float *x, float *v);
SPAR_API int spar_fluid_pull_sections_f32(spar_fluid *fluid, double theta, float *q, float *omega, float *accel);
SPAR_API int spar_fluid_pull_forces_f32(spar_fluid *fluid, double theta, float *force);
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

/* ---- one coupling step ------------------------------------------------------------------------------------------- */

/* All collective. A step is begun, solved, checked, as often as it takes, and accepted or rejected; a call out of
   this order is SPAR_ERR_STATE. After a failure the state at t^n is untouched: reject the step, and begin another.
   A loop of the host's own may accept before spar_step_check was done, or solve, push and check again after it was: the
   motion is that of the last solution, the loads those pushed last (docs/coupling.md). */

/* Step 1: predicts the loads at t^{n+1} = t^n + dt. dt: in, s, >= 1e-100, the same on every rank; may differ from step
   to step. */
SPAR_API int spar_step_begin(spar_session *session, double dt);
/* Step 2: the structure from t^n to t^{n+1} under the loads in use, in substeps; from t^n every time it is called.
   SPAR_ERR_NUMERIC: Newton did not converge, or the tangent is singular. */
SPAR_API int spar_step_solve(spar_session *session);
/* Step 8: gathers the loads pushed on all ranks, forms the residual and the next loads. done: out, 1: accept, 0:
   solve again. SPAR_ERR_NUMERIC: no convergence in max_iterations. */
SPAR_API int spar_step_check(spar_session *session, int *done);
/* The clock moves to t^{n+1}. SPAR_ERR_STATE after a check that failed: its loads and the motion do not belong together
   (to accept what has not converged, see the option coupling.unconverged). */
SPAR_API int spar_step_accept(spar_session *session);
/* Back to t^n, as if the step had not begun: state, loads, coupling. A tangent that was formed in it may serve on, so
   that what follows is the same within Newton's tolerance and not to the bit. */
SPAR_API int spar_step_reject(spar_session *session);
/* The host's part of an iteration: pull, advance the fluid from t to t + dt, push. iteration: from 0. Answer 0 for
   success; anything else ends the step with SPAR_ERR_USER. This and any other callback must return: a C++ exception or a
   longjmp that leaves it leaves the session inside the call for good, and all that can be done is to destroy it. Catch
   the exception in the callback, answer a number, and throw again when the call has returned.
   Where it moves an external member or a point that joints tie, the members are solved again before the check, so that
   joints' loads are those of that motion; pull from the others gives their motion of before, and a fluid on these
   converges better in the host's own loop (move, spar_step_solve, pull). The step stays spar_step's: the calls that
   begin, solve, check, accept and reject one are SPAR_ERR_STATE from here, on the rank that makes them. */
typedef int (*spar_fluid_solver)(spar_session *session, double t, double dt, int iteration, void *context);
/* The whole step. Accepts, or after a failure of any part rejects and answers that part's status.
     dt: in, s
     solve: in, NULL: no fluid (on this rank: others may have one)
     context: in, handed to solve
     iterations: out, how many it took, NULL: not wanted */
SPAR_API int spar_step(spar_session *session, double dt, spar_fluid_solver solve, void *context, int *iterations);

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
/* Entries of the pace of steps, spar_session_get_step_control. */
enum {
    SPAR_PACE_RATIO = 0,    /* error over tolerance, the largest of all members; 0 in a first step that began without
                               spar_session_solve_initial, whose accelerations nobody knows */
    SPAR_PACE_NEXT_DT = 1,  /* s, 0.2 to 2 of this step's: to go on with; or, if it is rejected, to try again with. By a
                               PI controller; small changes, which would only cost new tangents, are not proposed */
    SPAR_PACE_REJECT = 2,   /* 1: the step under way is to be rejected */
    SPAR_PACE_REJECTED = 3, /* steps given up so far whose error was too large */
    SPAR_PACE_COUNT = 4
};
/* What the tolerance says: between solve and accept of the step under way (the host then calls spar_step_accept or
   spar_step_reject, and begins the next step with the dt named here, or a smaller one), between steps of the last
   accepted one. The same on all ranks. Local. pace[capacity]: out, by SPAR_PACE_*, NULL: not wanted. SPAR_ERR_STATE: no
   tolerance, or no step since it was set. */
SPAR_API int spar_session_get_step_control(const spar_session *session, int64_t capacity, double *pace);
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

/* What Newton's iteration of a member takes and leaves, as the rank that solves it knows (spar_member_get_owner); zeros
   on the others, and of what is not solved by iteration. Each NULL: not wanted. Local.
     iterations: out, so far, since it was committed or made anew
     left: out, estimate of what the last solution in time left of the increments: of the member's length, or rad; of
           members that joints tie the largest of all */
SPAR_API int spar_member_get_iterations(const spar_member *member, int64_t *iterations, double *left);

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

/* The whole state of the run to and from one file, between steps or within one: clock, histories, members, joints with
   their springs, solvers, the fluids' loads, node forces and states, quasi-Newton columns. A run that goes on from it
   ends with the same bits. Collective.
     path: in, rank 0's; on the other ranks it must be given and is not used. Ranks that see rank 0's file write and
           read their own parts of it, all at the same time; if any does not, all goes through rank 0, piece by piece,
           to the same bytes. No rank has more in memory than what is its own, twice
   save: the file is written under path.new, flushed and renamed: there is always a whole one, and what a killed process
   has left at path.new goes with the next save. Where path is a symbolic link, all this happens where it leads, and the
   link stays; a file with several hard links is replaced under this name only; mode and owner stay as far as the system
   allows. What is no file (a pipe, a device, a folder) is SPAR_ERR_IO and stays; so is a file that another process is
   writing. While a refused push waits for a good one, save is refused with the status of that push, as spar_step_check
   is: push again, or destroy the fluid. load: into a session with the same members, committed, the same joints, and the same fluids, mapped, by
   name, no step under way, on any number of ranks: nodes may be spread over the ranks otherwise, node forces find them
   by their reference places, to 1e-9 of the member's length. What the host sets (gravity, integrator, tolerances) it
   sets as before. A file that is cut off or damaged or cannot be read: SPAR_ERR_IO; one of another session:
   SPAR_ERR_ARGUMENT; the session is then as it was. */
SPAR_API int spar_session_save(const spar_session *session, const char *path);
SPAR_API int spar_session_load(spar_session *session, const char *path);

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
