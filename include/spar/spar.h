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

/* ---- status -------------------------------------------------------------------------------------------------------- */

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

/* ---- session ------------------------------------------------------------------------------------------------------- */

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
/* Levels of the log. */
enum { SPAR_LOG_ERROR = 0, SPAR_LOG_WARNING = 1, SPAR_LOG_INFO = 2 };
/* Called with every message of the session, on the rank and in the thread where it arises; it must not call the
   session. */
typedef void (*spar_log)(const spar_session *session, int level, const char *text, void *context);
/* Who is told. Local, at any time.
     log: in, NULL: nobody (default)
     context: in, handed to log; must live as long as the session uses it */
SPAR_API int spar_session_set_log(spar_session *session, spar_log log, void *context);
/* The setters below are local, made alike on every rank (see "Ranks"), and allowed between steps only (SPAR_ERR_STATE
   during one). The getter beside each gives what is set, at any time: local, each output NULL: not wanted. */

/* Gravity at the end of the next step: within a step it goes linearly from that of the step before, as an applied load
   does (spar_member_set_load).
     g[3]: in, m/s^2. Default 0. */
SPAR_API int spar_session_set_gravity(spar_session *session, const double g[3]);
SPAR_API int spar_session_get_gravity(const spar_session *session, double g[3]);

/* ---- session ----------------------------------------------------------------------------------------------------- */

/* Coupling schemes. */
enum {
    SPAR_COUPLING_EXPLICIT = 0,    /* one solution per step with predicted loads */
    SPAR_COUPLING_FIXED_POINT = 1, /* iterates on the nodal loads, with a constant relaxation */
    SPAR_COUPLING_AITKEN = 2,      /* the same, relaxation by Aitken's rule */
    SPAR_COUPLING_IQN_ILS = 3      /* interface quasi-Newton by least squares (Degroote, Bathe, Vierendeels 2009) */
};

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
/* The clock. Each NULL: not wanted. Local.
     t: out, t^n in s, the time of the last accepted step, from 0
     step: out, steps accepted
     iteration: out, coupling iterations of the step under way, or of the last step or static solution */
SPAR_API int spar_session_get_time(const spar_session *session, double *t, int64_t *step, int *iteration);

/* ---- members ------------------------------------------------------------------------------------------------------- */

/* ---- members ----------------------------------------------------------------------------------------------------- */

/* Root conditions; the root is node 0. */
enum {
    SPAR_ROOT_FREE = 0,
    SPAR_ROOT_FIXED = 1,  /* stands still */
    SPAR_ROOT_PINNED = 2, /* turns freely about a fixed place */
    SPAR_ROOT_DRIVEN = 3  /* follows spar_member_drive */
};

/* Loads that are kept: in global axes, or in the section's, turning with it. */
enum { SPAR_LOAD_DEAD = 0, SPAR_LOAD_FOLLOWER = 1 };
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
/* The reference line by points, in the beam's own frame; the nodes are a least-squares fit, exact at both ends.
   Replaces an earlier line. Local.
     n: in, points, >= 2
     eta[n]: in, strictly increasing, the first 0, the last 1
     xyz[n][3]: in, m
     twist[n]: in, rad about the tangent, right-handed, linear between the points, NULL: 0 */
SPAR_API int spar_beam_set_axis(spar_member *beam, int64_t n, const double *eta, const double *xyz,
                                const double *twist);
/* Sections, linear in eta between their stations and constant beyond the first and last. Local.
     n: in, stations, >= 1
     eta[n]: in, strictly increasing in [0,1]
     stiffness[n][36]: in, N, N m, N m^2, symmetric and positive definite
     mass[n][36]: in, per length, kg/m, kg, kg m, of the form of a rigid section, NULL: massless */
SPAR_API int spar_beam_set_sections(spar_member *beam, int64_t n, const double *eta, const double *stiffness,
                                    const double *mass);
/* Takes the member from its own frame to its reference place: X -> R(q) X + x. For a point or a rigid body instead of
   those given to create. Local.
     x[3]: in, m, NULL: unchanged
     q[4]: in, NULL: unchanged */
SPAR_API int spar_member_set_placement(spar_member *member, const double x[3], const double q[4]);
/* kind: in, SPAR_ROOT_*. Local. */
SPAR_API int spar_member_set_root(spar_member *member, int kind);
/* on: in, 1: the host solves this member: motion by spar_member_set_motion, loads by spar_member_get_loads; a beam
   then needs no sections. Local. */
SPAR_API int spar_member_set_external(spar_member *member, int on);
/* Initial velocities of a rigid motion: v0 + omega x (x - x0) and omega. What the root condition holds has none. Before
   the first step, before or after commit. Local.
     x0[3]: in, m; v0[3]: in, m/s; omega[3]: in, rad/s; each NULL: 0 */
SPAR_API int spar_member_set_initial_velocity(spar_member *member, const double x0[3], const double v0[3],
                                              const double omega[3]);
/* Checks the description, that it is the same on every rank (SPAR_ERR_COMM if not), and takes all memory; nothing of
   it can be changed afterwards. Needed before anything below. Collective. */
SPAR_API int spar_member_commit(spar_member *member);
/* State. The getters are local and answer on every rank; n is the number of nodes. During a step they give the latest
   iterate at t^{n+1}, between steps the state at t^n. */

/* nodes: out. Before commit too. */
SPAR_API int spar_member_get_count(const spar_member *member, int64_t *nodes);
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
/* load[n][6]: out, N, N m, dead, follower, line and fluid loads in use, global axes, line loads as the nodal loads that
   do the same work: those the structure is to be solved with. After spar_step_begin these are predicted; after a
   spar_step_check that was not done they are the accelerated ones of the next solution (an external member is solved
   with these); after one that was done, and between steps, those pushed last. Of an external member they have what
   joints put on it, predicted and accelerated with the rest; of a point the joints' at the latest iterate. */
SPAR_API int spar_member_get_loads(const spar_member *member, double *load);

/* ---- fluids -------------------------------------------------------------------------------------------------------- */

/* The two sets of nodes of a fluid: those that move with the member, and those that forces are pushed at. */
enum { SPAR_NODES_MOTION = 0, SPAR_NODES_FORCE = 1 };
/* All calls on fluids but spar_fluid_sum_loads and spar_fluid_check_loads are local: a fluid is this rank's. A member
   can have many, from any of its ranks. n is the number of nodes of the set in question. Nodes and maps change between
   steps only. Where ranks share a border, motion nodes may repeat on them (each is moved alike); a force node belongs
   to one rank, for loads of all ranks add up. */

/* name: in, not empty, for the messages. fluid: out. */
SPAR_API int spar_fluid_create(spar_member *member, const char *name, spar_fluid **fluid);
/* A fluid may go before its session; its loads go with it. Within a trial run too: the trial goes on without it, and it
   stays gone when the trial has gone back. */
SPAR_API void spar_fluid_destroy(spar_fluid **fluid);
/* Nodes that are moved, by their places in the reference configuration. To be mapped.
     n: in
     x[n][3]: in, m */
SPAR_API int spar_fluid_set_motion_nodes(spar_fluid *fluid, int64_t n, const double *x);
/* Nodes that loads come from. As above. */
SPAR_API int spar_fluid_set_force_nodes(spar_fluid *fluid, int64_t n, const double *x);
/* Sections of a blade element model, instead: motion nodes and force nodes at given places of the line. Keeps the node
   forces, unless spar_member_set_effects has left SPAR_EFFECT_FLUID_HISTORY out. To be mapped.
     n: in
     xi[n]: in, in [-1,1] over the whole beam
     offset[n][3]: in, m, from the line to the node in the section frame (x tangent, y, z), NULL: 0 */
SPAR_API int spar_fluid_set_stations(spar_fluid *fluid, int64_t n, const double *xi, const double *offset);
/* Finds the foot of every node on the reference line, (T1) to (T3): the nearest place of all, of equally near ones
   the first along the line. The member must be committed; the feet of a point or rigid body are its node. A joint
   belongs to the lower element. To be called after nodes are set or replaced; sets that were not replaced are mapped
   again where they were. A map is not saved with a session: it is found again, a million nodes in half a second.
   SPAR_ERR_MAPPING: see fluid.far; the nodes then stay unmapped. */
SPAR_API int spar_fluid_map(spar_fluid *fluid);
/* Motion nodes at t^n + theta dt (parts 3 and 4 of a step, (T4) to (T6)); before the first step: the initial state.
   Each output NULL: not wanted.
     theta: in, in [0,1]: 1 backward Euler, 1/2 Crank-Nicolson, 0 explicit
     x[n][3]: out, places, m
     v[n][3]: out, m/s
   SPAR_ERR_NUMERIC: the rotations of an element's nodes cancel. */
SPAR_API int spar_fluid_pull_motion(spar_fluid *fluid, double theta, double *x, double *v);
/* All of a section's motion at once, for blade element hosts, at the motion nodes. Each NULL: not wanted.
     x[n][3]: out, m
     q[n][4]: out, as above
     v[n][3]: out, m/s
     omega[n][3]: out, rad/s
     accel[n][3]: out, m/s^2
     alpha[n][3]: out, rad/s^2 */
SPAR_API int spar_fluid_pull_poses(spar_fluid *fluid, double theta, double *x, double *q, double *v, double *omega,
                                   double *accel, double *alpha);
/* Loads at t^{n+1} on the force nodes where they are now (part 7 of a step, (T8) to (T10)); before the first step those
   at t = 0. Replaces what the fluid pushed before.
     force[n][3]: in, N
     moment[n][3]: in, N m, about each node, NULL: none
   A refused push (NaN) leaves the loads as they were, and spar_step_check then fails on all ranks unless a good push
   follows. */
SPAR_API int spar_fluid_push_forces(spar_fluid *fluid, const double *force, const double *moment);
/* The host's model has failed on this rank: there are no loads of this fluid, for the reason given. spar_step_check (or
   the call that runs the step, or the first spar_step_begin) then fails on all ranks unless a good push follows, with
   this status and message on this rank. Between steps nobody waits for loads, and nothing is done.
     status: in, a SPAR_ERR_*
     message: in, what, where, the cure; not empty, copied */
SPAR_API int spar_fluid_fail(spar_fluid *fluid, int status, const char *message);

/* ---- one coupling step --------------------------------------------------------------------------------------------- */

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

/* ---- save and load ------------------------------------------------------------------------------------------------- */

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

#ifdef __cplusplus
}
#endif

#endif
