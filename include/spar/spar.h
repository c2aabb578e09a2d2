/* spar.h: couples structures with fluid solvers. It has the calls that every host needs. Other headers have more:
   spar_structure.h, spar_coupling.h, spar_mpi.h, spar_output.h, and, experimental, spar_analysis.h and spar_aero.h.
   spar_all.h includes all of them but spar_mpi.h.

   spar advances structural members: beams, rigid bodies, points, or the host's own structure. A fluid solver registers
   its nodes, pulls their motion and pushes the loads on them:

       spar_session_create(&s);                          a session has one clock
       spar_beam_create(s, "wing", 4, 5, &wing);         a member, here a beam of 4 elements with 5 nodes each
       spar_beam_set_axis(wing, 2, eta, xyz, NULL);      its reference line
       spar_beam_set_sections(wing, 1, eta, K, M);       its 6x6 section matrices
       spar_member_commit(wing);
       spar_fluid_create(wing, "surface", &f);           this rank's nodes, attached to one member
       spar_fluid_set_motion_nodes(f, n, vertices);
       spar_fluid_set_force_nodes(f, m, centres);
       spar_fluid_map(f);                                finds each node's nearest point on the line
       while (t < end) {
           spar_step_begin(s, dt);                       part 1 of the step (below)
           do {
               spar_step_solve(s);                       part 2
               spar_fluid_pull_motion(f, 1, x, v);       parts 3 and 4
               ...                                       parts 5 and 6: the host
               spar_fluid_push_forces(f, force, NULL);   part 7
               spar_step_check(s, &done);                part 8
           } while (!done);
           spar_step_accept(s);                          or spar_step_reject(s)
       }
       spar_session_destroy(&s);

   The parts of a step from t^n to t^{n+1} = t^n + dt:
     1  predict the loads at t^{n+1}
     2  solve the structure to t^{n+1} under these loads
     3  find the motion of the fluid's nodes at t^{n+1}
     4  or, for the fluid's own time scheme, at t^n + theta dt
     5  the host advances its fluid with this motion
     6  the host computes the loads on its nodes
     7  move the loads to the member's nodes; force, moment and power are conserved
     8  compare these loads with those of part 2; accept the step, or go back to part 2

   Conventions
   - Units are SI, or any other consistent set. Angles are in radians.
   - Vectors are in one right-handed inertial frame, "global", unless a line says "own frame" or "section frame".
   - Arrays are contiguous: x[n][3] is the double array with component i of node j at 3 j + i, Fortran's x(3,n).
   - A size in brackets is a number, a constant, an argument of the call, or one of these counts: nodes, of the member
     (spar_member_get_count); motion_nodes and force_nodes, of the fluid on this rank (spar_fluid_get_count);
     which_nodes, of the set that the argument `which` names.
   - Quaternions are unit, scalar first, [w,x,y,z]. R(q) takes local components to global ones. q and -q are equal.
   - Motion of a member's nodes, in global axes, relative to the reference configuration: q[7] is the displacement and
     the quaternion of the rotation. v[6] is velocity and angular velocity, a[6] their rates. load[6] is force and
     moment.
   - 6x6 matrices are row-major, in the section frame, in the order axial, shear y, shear z, torsion, bending y,
     bending z. Axis x of the section frame is the tangent, y and z follow the rule at spar_beam_set_axis.
   - eta in [0,1] is the coordinate along a beam. Element e of E covers [e/E, (e+1)/E].
   - Counts are int64_t, enumerations and flags int. n = 0 with NULL arrays is legal.
   - Outputs marked "NULL: not wanted" may be NULL. Other pointers may not, unless their line says so.
   - The member's length, by which tolerances are scaled: the length of a beam's line; the radius of gyration of a rigid
     body; 1 of a point.
   - "Collective" calls are made on all ranks in the same order with the same arguments. "Local" calls communicate
     nothing. The end of this header has the full rules for errors, ranks, threads and memory. */
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
typedef struct spar_fluid spar_fluid;     /* a fluid's nodes on this rank; belongs to the session */

/* ---- errors ------------------------------------------------------------------------------------------------------ */

/* Statuses. Every call answers one, except destroys and calls that answer a text. Their numbers never change. */
enum {
    SPAR_OK = 0,
    SPAR_ERR_ARGUMENT = 1,    /* an argument is not allowed */
    SPAR_ERR_STATE = 2,       /* the call is out of order */
    SPAR_ERR_MEMORY = 3,      /* out of memory */
    SPAR_ERR_NUMERIC = 4,     /* not converged, or singular */
    SPAR_ERR_MAPPING = 5,     /* a fluid node cannot be mapped */
    SPAR_ERR_COMM = 6,        /* communication failed, or the ranks made different calls */
    SPAR_ERR_PEER = 7,        /* another rank failed; the message is that rank's */
    SPAR_ERR_IO = 8,          /* a file cannot be read or written */
    SPAR_ERR_UNSUPPORTED = 9, /* not available in this build or for this member */
    SPAR_ERR_USER = 10,       /* a callback of the host failed */
    SPAR_ERR_LIMIT = 11       /* a limit of work that the host has set is reached */
};

/* Describes the last failure of the session: what is wrong, where, and what to do.
     session: in, NULL: the last failure in this thread that had no session (a create, a section, a NULL handle)
   A failure that was not read here, and had no log, stays in the messages of those after it: "...; an earlier failure:
   ...". The text belongs to the session and stands until the next failure. It is "" before the first one. Local. */
SPAR_API const char *spar_session_message(const spar_session *session);
/* Name and meaning of a status; static text, never NULL.
     status: in, any int */
SPAR_API const char *spar_status_text(int status);
/* The release, "major.minor.patch"; static text. */
SPAR_API const char *spar_version(void);
/* Answers 1 if this build has a feature, else 0.
     feature: in, "mpi", "fortran", "openblas", "lapack" or "gsl" */
SPAR_API int spar_has(const char *feature);

/* ---- session ----------------------------------------------------------------------------------------------------- */

/* Creates a session of this process alone. Local.
     session: out */
SPAR_API int spar_session_create(spar_session **session);
/* Creates a session on a communicator, which is duplicated. Every build has this call; without MPI it answers
   SPAR_ERR_UNSUPPORTED. In C use spar_session_create_mpi (spar_mpi.h). Collective over comm.
     comm: in, the Fortran integer of the communicator
     session: out
   SPAR_ERR_ARGUMENT: not a communicator; SPAR_ERR_COMM: MPI is not initialised, is finalised, or has failed. */
SPAR_API int spar_session_create_fcomm(int comm, spar_session **session);
/* Destroys the session with its members and fluids, whose handles become invalid. Call it before MPI_Finalize, and not
   in a callback of this session: the call in progress would go on in freed memory.
     session: in; out, NULL
   Collective: a rank that waits in another collective call gets SPAR_ERR_COMM there. */
SPAR_API void spar_session_destroy(spar_session **session);

/* ---- one coupling step ------------------------------------------------------------------------------------------- */

/* Begin, then solve, push and check until done, then accept or reject; another order is SPAR_ERR_STATE. After a
   failure reject the step: the state at t^n is untouched. A host may accept before done, or iterate after it: the
   motion is that of the last solve, the loads are those pushed last. All step calls are collective. */

/* Part 1: predicts the loads at t^{n+1} (option: spar_session_set_predictor).
     dt: in, s, >= 1e-100, >= 1e-12 of the last step, and large enough to change t; it may vary otherwise. Add a
           shorter rest of a window to the step before.
   Collective. */
SPAR_API int spar_step_begin(spar_session *session, double dt);
/* Part 2: solves all members from t^n to t^{n+1} under the current loads. Each call starts again from t^n.
   SPAR_ERR_NUMERIC: Newton did not converge, or singular tangent; SPAR_ERR_LIMIT: option newton.budget. Collective. */
SPAR_API int spar_step_solve(spar_session *session);
/* Part 8: gathers the loads of all ranks, computes the residual and the loads of the next iteration.
     done: out, 1: accept the step, 0: solve, push and check again
   SPAR_ERR_NUMERIC: no convergence in max_iterations (spar_session_set_coupling); or the steps have one evaluation of
   the fluid each, and the error of the predicted loads grows from step to step (option coupling.unstable).
   Collective. */
SPAR_API int spar_step_check(spar_session *session, int *done);
/* Accepts the step: the clock moves to t^{n+1}. SPAR_ERR_STATE after a check that failed. Collective. */
SPAR_API int spar_step_accept(spar_session *session);
/* Rejects the step: state, loads and coupling are again those at t^n. A tangent formed in the step may be reused, so a
   repeated step agrees within Newton's tolerance, not to the bit. Collective. */
SPAR_API int spar_step_reject(spar_session *session);

/* Parts 3 and 4: motion of the motion nodes at t^n + theta dt; before the first step, the initial state. Local.
     theta: in, in [0,1]: 1 backward Euler, 1/2 Crank-Nicolson, 0 explicit
     x[motion_nodes][3]: out, position, m, NULL: not wanted
     v[motion_nodes][3]: out, velocity, m/s, NULL: not wanted
   SPAR_ERR_NUMERIC: the rotations at the nodes of an element cancel. */
SPAR_API int spar_fluid_pull_motion(spar_fluid *fluid, double theta, double *x, double *v);
/* Part 7: loads at t^{n+1} on the force nodes where they are now; before the first step, those at t = 0. Replaces what
   this fluid pushed before. Local.
     force[force_nodes][3]: in, N
     moment[force_nodes][3]: in, N m, about each node, NULL: none
   SPAR_ERR_ARGUMENT: a value is not finite. The loads stay as they were, and spar_step_check fails on all ranks unless
   a valid push follows. */
SPAR_API int spar_fluid_push_forces(spar_fluid *fluid, const double *force, const double *moment);
/* The host cannot compute the loads of this fluid. The next spar_step_check (or spar_step_begin before the first step)
   fails on all ranks unless a valid push follows, with this status and message here and SPAR_ERR_PEER elsewhere.
   Between steps it does nothing. Local.
     status: in, a SPAR_ERR_*
     message: in, what, where, what to do; not empty; copied */
SPAR_API int spar_fluid_fail(spar_fluid *fluid, int status, const char *message);

/* Callback for the host's parts 3 to 7: pull, advance the fluid from t to t + dt, push.
     iteration: from 0
     context: what the host gave beside the callback
   Answer 0 for success; anything else ends the call with SPAR_ERR_USER. The callback must return: no C++ exception and
   no longjmp may leave it. It must not call spar_step_*, or save, load or solve. If it moves an external member that
   joints connect, the connected members are solved again before the check. */
typedef int (*spar_fluid_solver)(spar_session *session, double t, double dt, int iteration, void *context);
/* Runs one whole step: begin, then solve, callback and check until done, then accept. After a failure it rejects the
   step and answers the failure.
     dt: in, s
     solve: in, NULL: this rank has no fluid
     context: in, handed to solve
     iterations: out, how many iterations were made, NULL: not wanted
   Collective. */
SPAR_API int spar_step(spar_session *session, double dt, spar_fluid_solver solve, void *context, int *iterations);

/* ---- settings of the session ------------------------------------------------------------------------------------- */

/* Settings are local calls, made with the same values on every rank, between steps only (SPAR_ERR_STATE during a step).
   The getter beside a setter answers at any time. */

/* Gravity at the end of the next step. Within a step gravity changes linearly, like an applied load
   (spar_member_set_load).
     g[3]: in, m/s^2, default 0 */
SPAR_API int spar_session_set_gravity(spar_session *session, const double g[3]);
/* g[3]: out */
SPAR_API int spar_session_get_gravity(const spar_session *session, double g[3]);

/* Coupling schemes. */
enum {
    SPAR_COUPLING_EXPLICIT = 0,    /* one solution per step, with predicted loads */
    SPAR_COUPLING_FIXED_POINT = 1, /* fixed-point iteration with constant relaxation */
    SPAR_COUPLING_AITKEN = 2,      /* fixed-point iteration with Aitken's relaxation */
    SPAR_COUPLING_IQN_ILS = 3      /* interface quasi-Newton, least squares (Degroote, Bathe, Vierendeels 2009) */
};
/* A host whose loop cannot repeat a step chooses SPAR_COUPLING_EXPLICIT; others keep the default, IQN-ILS, which is
   stable with fluids of any added mass. Explicit coupling has one evaluation of the fluid per step. It is stable while
   the added mass is below 1, 1/3, 1/7 of the mass (predictor order 0, 1, 2); above that spar_step_check refuses the
   step (option coupling.unstable) unless the added mass is given (spar_member_set_added_mass).
   A step is iterated until the change of the fluid's loads is below atol + rtol |loads|. Both are weighed by the motion
   that they cause (option coupling.norm), moments by the member's length.
     scheme: in, SPAR_COUPLING_*; default SPAR_COUPLING_IQN_ILS
     atol: in, N, >= 0; default 1e-9. Where spar knows the flexibility, the default counts only if the remaining loads
           move nothing (1e-12 of a member's length); another value counts always
     rtol: in, >= 0; default 1e-6
     max_iterations: in, >= 1; after that many spar_step_check answers SPAR_ERR_NUMERIC, or accepts (option
           coupling.unconverged); default 50 */
SPAR_API int spar_session_set_coupling(spar_session *session, int scheme, double atol, double rtol, int max_iterations);
/* scheme: out, NULL: not wanted
   atol: out, NULL: not wanted
   rtol: out, NULL: not wanted
   max_iterations: out, NULL: not wanted */
SPAR_API int spar_session_get_coupling(const spar_session *session, int *scheme, double *atol, double *rtol,
                                       int *max_iterations);
/* The clock. Local.
     t: out, s, time of the last accepted step, NULL: not wanted
     step: out, number of accepted steps, NULL: not wanted
     iteration: out, coupling iterations of the current step, or of the last step or static solution, NULL: not
           wanted */
SPAR_API int spar_session_get_time(const spar_session *session, double *t, int64_t *step, int *iteration);

/* Levels of the log. */
enum { SPAR_LOG_ERROR = 0, SPAR_LOG_WARNING = 1, SPAR_LOG_INFO = 2 };
/* Receives every message of the session, on the rank and in the thread where it arises. It must not call the session.
     level: SPAR_LOG_* */
typedef void (*spar_log)(const spar_session *session, int level, const char *text, void *context);
/* Sets the log. Warnings are also kept for spar_session_get_warning. Local, at any time.
     log: in, NULL: none (default)
     context: in, handed to log; must live as long as the session uses it */
SPAR_API int spar_session_set_log(spar_session *session, spar_log log, void *context);
/* A log for spar_session_set_log: writes errors and warnings to stderr, a line each. The library writes nothing by
   itself.
     session: in, not used
     level: in, SPAR_LOG_*
     text: in
     context: in, not used */
SPAR_API void spar_log_stderr(const spar_session *session, int level, const char *text, void *context);
/* Warnings of this session on this rank, with or without a log: descriptions and runs that are legal and probably
   wrong. Warnings about members are given on rank 0, about fluids on their rank. The text belongs to the session;
   "" for i beyond the last. The first 32 are kept. Local, at any time.
     i: in, from 0 */
SPAR_API const char *spar_session_get_warning(const spar_session *session, int64_t i);

/* ---- members ----------------------------------------------------------------------------------------------------- */

/* Members are created, described and committed on every rank, with the same arguments in the same order, before the
   first step. They belong to their session. Names are not empty, unique in the session, and copied. The calls are
   local, except the commit. */

/* Creates a massless node with 6 degrees of freedom. It follows spar_member_set_motion or spar_member_drive.
     name: in
     x[3]: in, reference position, m, NULL: the origin
     q[4]: in, reference orientation, NULL: none
     member: out */
SPAR_API int spar_point_create(spar_session *session, const char *name, const double x[3], const double q[4],
                               spar_member **member);
/* Creates a rigid body of one node. Default root condition: free.
     name: in
     x[3]: in, reference position of the node, m, NULL: the origin
     q[4]: in, reference orientation, NULL: none
     mass[36]: in, about the node, in its own frame, [m I, -m c~; m c~, J] with the centre of mass at c; kg, kg m,
           kg m^2
     member: out
   SPAR_ERR_ARGUMENT: no body has such moments of inertia: the largest exceeds the sum of the others. */
SPAR_API int spar_rigid_create(spar_session *session, const char *name, const double x[3], const double q[4],
                               const double mass[36], spar_member **member);
/* Creates a geometrically exact (Simo-Reissner) beam of Legendre spectral elements. It needs a line and sections before
   the commit. Default root condition: fixed.
     name: in
     elements: in, 1 to 1000000
     nodes_per_element: in, 2 to 24; see below
     member: out
   Nodes are the Gauss-Lobatto-Legendre points, numbered from 0, element by element. At an element boundary two nodes
   stand at one position; they move alike, and their loads add.
   Elements of few nodes lock if their axial or shear stiffness is large beside bending stiffness / length^2: they bend
   too little. Equilibria are right with 5 nodes, motions with 7, for any stiffness. With fewer nodes, the commit warns
   of stiffnesses for which equilibria are wrong, and a step warns of an element of 5 or 6 nodes that is bent so far
   that its motion may be wrong. More nodes or more elements cure both. */
SPAR_API int spar_beam_create(spar_session *session, const char *name, int elements, int nodes_per_element,
                              spar_member **member);
/* Reference line by points, in the beam's own frame. Replaces an earlier line.
   Between its corners the line is smooth: the polynomial through the points if they are at most nodes_per_element,
   otherwise fitted by least squares, exactly at both ends. A corner is an axis point on an element boundary (eta a
   multiple of 1 / elements) where the line turns by more than 40 degrees, or by 1 degree or more and more than three
   times what the curvature at its neighbours explains; a turn of more than 40 degrees inside an element is refused.
     n: in, points, >= 2
     eta[n]: in, strictly increasing from 0 to 1
     xyz[n][3]: in, m
     twist[n]: in, rad about the tangent, linear between the points, NULL: 0
   Section frames at twist 0 have y = unit(z_global x tangent). If the line comes within 10 degrees of global z at
   an axis point, y is transported along the line from the root with the least rotation. A root within 0.001 rad of
   global z has y = global y, less its part along the tangent. */
SPAR_API int spar_beam_set_axis(spar_member *beam, int64_t n, const double *eta, const double *xyz,
                                const double *twist);
/* Sections, linear in eta between the stations, constant beyond the first and the last.
     n: in, stations, >= 1
     eta[n]: in, strictly increasing in [0,1]
     stiffness[n][36]: in, N, N m, N m^2, symmetric and positive definite
     mass[n][36]: in, per length, kg/m, kg, kg m, of the form of a rigid body's (spar_rigid_create), NULL: massless */
SPAR_API int spar_beam_set_sections(spar_member *beam, int64_t n, const double *eta, const double *stiffness,
                                    const double *mass);
/* Moves the member from its own frame to its reference position: X -> R(q) X + x. It replaces the position given at the
   creation of a point or rigid body.
     x[3]: in, m, NULL: unchanged
     q[4]: in, NULL: unchanged */
SPAR_API int spar_member_set_placement(spar_member *member, const double x[3], const double q[4]);

/* Root conditions. The root is node 0. */
enum {
    SPAR_ROOT_FREE = 0,
    SPAR_ROOT_FIXED = 1,  /* does not move */
    SPAR_ROOT_PINNED = 2, /* rotates freely about a fixed position */
    SPAR_ROOT_DRIVEN = 3  /* follows spar_member_drive */
};
/* Sets the root condition.
     kind: in, SPAR_ROOT_* */
SPAR_API int spar_member_set_root(spar_member *member, int kind);
/* Makes the host solve this member. The host reads spar_member_get_loads and gives spar_member_set_motion. A beam then
   needs no sections.
     on: in, 1 or 0 */
SPAR_API int spar_member_set_external(spar_member *member, int on);
/* Initial velocities of a rigid motion: v0 + omega x (x - x0), and omega. Constrained motions of the root have
   none. Before or after the commit, before the first step.
     x0[3]: in, m, NULL: 0
     v0[3]: in, m/s, NULL: 0
     omega[3]: in, rad/s, NULL: 0 */
SPAR_API int spar_member_set_initial_velocity(spar_member *member, const double x0[3], const double v0[3],
                                              const double omega[3]);
/* Checks the description, compares it across the ranks and allocates all memory. Afterwards the description is fixed.
   Collective. SPAR_ERR_COMM: the ranks described different members. */
SPAR_API int spar_member_commit(spar_member *member);

/* State of a committed member. During a step getters answer the latest iterate at t^{n+1}, between steps the state at
   t^n. They are local and answer on every rank. Values that are set must be the same on every rank. */

/* nodes: out, number of nodes; before the commit too */
SPAR_API int spar_member_get_count(const spar_member *member, int64_t *nodes);
/* Reference configuration.
     x[nodes][3]: out, m, NULL: not wanted
     q[nodes][4]: out, section frames, NULL: not wanted */
SPAR_API int spar_member_get_reference(const spar_member *member, double *x, double *q);
/* Motion of the nodes. A fluid whose loads depend on the acceleration must pull it (spar_fluid_pull_poses), not read it
   here.
     q[nodes][7]: out, NULL: not wanted
     v[nodes][6]: out, NULL: not wanted
     a[nodes][6]: out, NULL: not wanted */
SPAR_API int spar_member_get_motion(const spar_member *member, double *q, double *v, double *a);
/* Sets the motion of a point or an external member: during a step that at t^{n+1}, in every iteration if needed; before
   the first step the initial motion.
     q[nodes][7]: in, NULL: unchanged
     v[nodes][6]: in, NULL: unchanged
     a[nodes][6]: in, NULL: unchanged */
SPAR_API int spar_member_set_motion(spar_member *member, const double *q, const double *v, const double *a);
/* Prescribes the motion of a driven root, or of a point, at the end of the next step. It is interpolated within the
   step. Between steps only. Without a new call the root stays where it is. A static solution does not use it: steady
   rotation comes from spar_member_set_initial_velocity.
     q[7]: in
     v[6]: in, NULL: 0
     a[6]: in, NULL: 0 */
SPAR_API int spar_member_drive(spar_member *member, const double q[7], const double v[6], const double a[6]);

/* Applied loads: in global axes, or in the section's axes. */
enum { SPAR_LOAD_DEAD = 0, SPAR_LOAD_FOLLOWER = 1 };
/* Applies a load to a node. It replaces the node's earlier load of this kind and stays until replaced. A node bears the
   sum of both kinds.
     node: in, 0 to nodes - 1
     kind: in, SPAR_LOAD_DEAD: fixed direction; SPAR_LOAD_FOLLOWER: in the node's section axes, rotating with them
     load[6]: in, N, N m
   The load is the one at the end of the next step. Within a step it changes linearly, from 0 if it is new. Before the
   first step it acts from t = 0 on. For a jump during a run, take one short step with the new load. A linear or modal
   beam with a free or pinned root and no joints keeps the follower's reference direction. */
SPAR_API int spar_member_set_load(spar_member *member, int64_t node, int kind, const double load[6]);
/* All nodal loads in use: applied loads and the fluid's, in global axes. After spar_step_begin those are predicted;
   after a spar_step_check with done = 0, the loads of the next iteration; otherwise the ones pushed last. An
   external member is to be solved with these; they include the loads of joints.
     load[nodes][6]: out, N, N m */
SPAR_API int spar_member_get_loads(const spar_member *member, double *load);

/* ---- fluids ------------------------------------------------------------------------------------------------------ */

/* A fluid is local to its rank. A member may have many, on any ranks, or none. Nodes are set and mapped between
   steps. If ranks share a border, motion nodes may appear on several ranks; each force node belongs to one rank,
   because loads of all ranks are added. All calls are local. */

/* The two sets of nodes. */
enum {
    SPAR_NODES_MOTION = 0, /* move with the member */
    SPAR_NODES_FORCE = 1   /* carry the loads */
};
/* Creates a fluid.
     member: in, what its nodes are attached to
     name: in, not empty, for messages; copied
     fluid: out */
SPAR_API int spar_fluid_create(spar_member *member, const char *name, spar_fluid **fluid);
/* Destroys a fluid before its session; its loads disappear with it.
     fluid: in; out, NULL */
SPAR_API void spar_fluid_destroy(spar_fluid **fluid);
/* Sets the motion nodes. Map afterwards.
     n: in
     x[n][3]: in, position in the reference configuration, m */
SPAR_API int spar_fluid_set_motion_nodes(spar_fluid *fluid, int64_t n, const double *x);
/* Sets the force nodes. Map afterwards.
     n: in
     x[n][3]: in, position in the reference configuration, m */
SPAR_API int spar_fluid_set_force_nodes(spar_fluid *fluid, int64_t n, const double *x);
/* Sets nodes by their coordinate along the line, for blade element models. Each node is a motion node and a force node
   at once. The fluid keeps the node forces, unless spar_member_set_effects has switched SPAR_EFFECT_FLUID_HISTORY off.
   Call spar_fluid_map afterwards.
     n: in
     eta[n]: in, in [0,1], 0 at the root and 1 at the tip; a point or rigid body ignores it
     offset[n][3]: in, m, from the line to the node in the section frame (x tangent, y, z), NULL: 0
   Local. SPAR_ERR_ARGUMENT: eta lies outside [0,1]. */
SPAR_API int spar_fluid_set_stations(spar_fluid *fluid, int64_t n, const double *eta, const double *offset);
/* Finds the nearest point of the reference line for every node of the sets that are new. The member must be committed.
   Of equally near points the first along the line is taken. Nodes of a point or rigid body are mapped to its node.
   SPAR_ERR_MAPPING: a node is too far (spar_fluid_set_projection); the nodes stay unmapped. */
SPAR_API int spar_fluid_map(spar_fluid *fluid);
/* The whole motion of the nodes of one set at t^n + theta dt, for blade elements, actuator lines and fluids that need
   accelerations. What is not wanted costs nothing.
     which: in, SPAR_NODES_MOTION, or SPAR_NODES_FORCE: where an actuator line spreads what spar_fluid_pull_forces gives
           at the same theta
     theta: in, in [0,1], as of spar_fluid_pull_motion
     x[which_nodes][3]: out, m, position, NULL: not wanted
     q[which_nodes][4]: out, orientation of the section, scalar part >= 0, NULL: not wanted
     v[which_nodes][3]: out, m/s, NULL: not wanted
     omega[which_nodes][3]: out, rad/s, angular velocity, NULL: not wanted
     accel[which_nodes][3]: out, m/s^2, acceleration of the node, NULL: not wanted
     alpha[which_nodes][3]: out, rad/s^2, angular acceleration, NULL: not wanted
   Steps with substeps, and steps from the first change of dt on, give mean accelerations: the mean over the step,
   extrapolated to the end of the step with the mean of the step before (T15). They are of second order too, and an
   added mass may respond to them. A member with an added mass of its own (spar_member_set_added_mass) always gives the
   accelerations at the time itself.
   Local. SPAR_ERR_UNSUPPORTED: a rotation of motion nodes with weights; SPAR_ERR_NUMERIC: as of
   spar_fluid_pull_motion. */
SPAR_API int spar_fluid_pull_poses(spar_fluid *fluid, int which, double theta, double *x, double *q, double *v,
                                   double *omega, double *accel, double *alpha);

/* ---- save and load ----------------------------------------------------------------------------------------------- */

/* Writes the state of the session to a file, or reads it. A run that continues from the file has the same bits.
   Collective, load between steps.
     path: in, that of rank 0; other ranks may give any text
   save is legal within a step too: a run that loads the file goes on within it, so the flow must have its state of
   then. save writes path.new and renames it, so path is always a whole file. Rank 0 writes and reads for all; other
   ranks need not see the file. What is not a regular file is SPAR_ERR_IO. load needs the same members and joints,
   committed, and the same mapped fluids by name, on any number of ranks. Numbers of a description agree to rounding:
   positions to 1e-9 of the member's length, stiffness and mass to 1e-8, damping, springs and forces to 1e-6. Initial
   velocities need not agree. Nodes are matched by their reference position, to 1e-9 of the member's length. Settings
   are not in the file; the host makes them as before. After a failure the session is as it was. SPAR_ERR_IO: the file
   cannot be read, or is damaged; SPAR_ERR_ARGUMENT: it does not match the session. */
SPAR_API int spar_session_save(const spar_session *session, const char *path);
/* Reads a saved state into the session. Collective.
     path: in */
SPAR_API int spar_session_load(spar_session *session, const char *path);

#ifdef __cplusplus
}
#endif

/* ---- the contract in detail --------------------------------------------------------------------------------------

   Memory. Arrays are the caller's and are copied before a call returns. The library keeps no pointer of the host's
   except callbacks and their contexts. Destroy takes the address of a handle and sets the handle to NULL; a NULL handle
   is legal. Create writes the handle only if it succeeds. Arrays whose length may grow in a later release come with
   their capacity: entries beyond those that this release knows are set to 0.

   Errors. Nothing aborts, exits or prints. A refused call leaves everything as it was. If one rank fails in a
   collective call, all fail: that rank answers its own status, the others SPAR_ERR_PEER with its message. Every
   call may answer these, which are not repeated at each call: SPAR_ERR_ARGUMENT for a NULL handle or array, a value
   that is not finite, a negative count or a value out of range; SPAR_ERR_STATE for a call out of order;
   SPAR_ERR_MEMORY.

   Ranks. A collective call first compares across the ranks which call it is, its arguments, and, between steps, all
   settings that must agree. Outputs, contexts, fluid solvers and paths may differ. If ranks differ, all answer
   SPAR_ERR_COMM, and the message names the first difference. A local call that fails is known to its rank alone. A NULL
   handle has no communicator: a rank whose create failed must tell the others (for example by MPI_Allreduce of the
   statuses), or call spar_session_destroy, which ends the others' collective calls with SPAR_ERR_COMM. Once a rank has
   destroyed the session, the others can only destroy it too.

   Threads. A session and everything made from it is used by one thread at a time. Different sessions may be used by
   different threads at once. A session on several ranks needs the MPI thread level of the host's own use.

   Floating point. A host may trap floating-point exceptions, set any rounding mode and any locale. During a call
   exceptions are masked, rounding is to the nearest, and numbers in texts have a decimal point. In callbacks and after
   the call the host's settings hold again. GSL's error handler is off while any thread is in a call of the library;
   change it only between calls. The treatment of denormal numbers stays the host's. With compilers other than GCC and
   Clang none of this is changed. A stack of 128 kB is enough.

   ABI. Structs are opaque. From 1.0 on numbers of constants and arguments of calls never change; a different behaviour
   is a new call, or a new soname. */

#endif
