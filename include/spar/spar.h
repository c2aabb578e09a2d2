/* spar: structures coupled with fluids. The public interface. */
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

typedef struct spar_session spar_session;
typedef struct spar_member spar_member;
typedef struct spar_fluid spar_fluid;

/* status: fixed for ever */
enum { SPAR_OK = 0, SPAR_ERR_ARGUMENT = 1, SPAR_ERR_STATE = 2, SPAR_ERR_MEMORY = 3, SPAR_ERR_NUMERIC = 4, SPAR_ERR_MAPPING = 5,
       SPAR_ERR_COMM = 6, SPAR_ERR_PEER = 7, SPAR_ERR_IO = 8, SPAR_ERR_UNSUPPORTED = 9, SPAR_ERR_USER = 10 };
/* coupling schemes, root conditions, quadrature rules, projection methods, interpolations, node sets, map flags */
enum { SPAR_COUPLING_EXPLICIT = 0, SPAR_COUPLING_FIXED_POINT = 1, SPAR_COUPLING_AITKEN = 2, SPAR_COUPLING_IQN_ILS = 3 };
enum { SPAR_ROOT_FREE = 0, SPAR_ROOT_FIXED = 1, SPAR_ROOT_PINNED = 2, SPAR_ROOT_DRIVEN = 3 };
enum { SPAR_QUADRATURE_GAUSS = 0, SPAR_QUADRATURE_LOBATTO = 1, SPAR_QUADRATURE_SECTIONS = 2 };
enum { SPAR_PROJECT_BOUNDED = 0, SPAR_PROJECT_RPOLY = 1 };
enum { SPAR_INTERPOLATE_NODAL = 0, SPAR_INTERPOLATE_CONSISTENT = 1 };
enum { SPAR_NODES_MOTION = 0, SPAR_NODES_FORCE = 1 };
enum { SPAR_MAP_END = 1, SPAR_MAP_AMBIGUOUS = 2, SPAR_MAP_FAR = 4 };
enum {
    SPAR_EFFECT_INERTIA = 1,
    SPAR_EFFECT_GYROSCOPIC = 2,
    SPAR_EFFECT_GRAVITY = 4,
    SPAR_EFFECT_DAMPING = 8,
    SPAR_EFFECT_LARGE_ROTATION = 16,
    SPAR_EFFECT_FLUID_MOMENT = 32,
    SPAR_EFFECT_FLUID_HISTORY = 64
};

SPAR_API const char *spar_status_text(int status);
SPAR_API const char *spar_version(void);
SPAR_API int spar_has(const char *feature); /* "mpi", ... */

/* session: one clock, its members, one communicator */
SPAR_API int spar_session_create(spar_session **session); /* this process alone */
SPAR_API int spar_session_create_fcomm(int comm, spar_session **session); /* Fortran integer communicator; every build has it */
SPAR_API void spar_session_destroy(spar_session **session); /* members and fluids go with it */
SPAR_API const char *spar_session_message(const spar_session *session); /* what went wrong last, where, and the cure */
SPAR_API int spar_session_set_gravity(spar_session *session, const double g[3]);
SPAR_API int spar_session_set_integrator(spar_session *session, double rho_inf, int substeps);
SPAR_API int spar_session_set_newton(spar_session *session, double atol, double rtol, int max_iterations);
SPAR_API int spar_session_set_predictor(spar_session *session, int order); /* 0, 1 (default), 2 */
SPAR_API int spar_session_set_coupling(spar_session *session, int scheme, double atol, double rtol, int max_iterations);
     /* scheme: SPAR_COUPLING_EXPLICIT, SPAR_COUPLING_FIXED_POINT, SPAR_COUPLING_AITKEN, SPAR_COUPLING_IQN_ILS */
SPAR_API int spar_session_set_relaxation(spar_session *session, double omega);
SPAR_API int spar_session_set_reproducible(spar_session *session, int on); /* same bits on any number of ranks */
SPAR_API int spar_session_set_option(spar_session *session, const char *key, const char *value); /* the long tail */
SPAR_API int spar_session_get_time(const spar_session *session, double *t, int64_t *step, int *iteration);

/* members */
SPAR_API int spar_point_create(spar_session *session, const char *name, const double x[3], const double q[4], spar_member **member);
SPAR_API int spar_rigid_create(spar_session *session, const char *name, const double x[3], const double q[4], const double mass[36], spar_member **member);
SPAR_API int spar_beam_create(spar_session *session, const char *name, int elements, int nodes_per_element, spar_member **member);
SPAR_API int spar_beam_set_axis(spar_member *beam, int64_t n, const double *eta, const double *xyz, const double *twist); /* rad about the tangent, right-handed, linear between points; NULL: 0 */
SPAR_API int spar_beam_set_nodes(spar_member *beam, int64_t n, const double *x, const double *q); /* instead of an axis: n = elements*nodes_per_element, element by
     element; a joint stands twice, same place, and its two orientations may differ (a kink) */
SPAR_API int spar_beam_set_sections(spar_member *beam, int64_t n, const double *eta, const double *stiffness, const double *mass); /* n x 36 each */
SPAR_API int spar_beam_set_quadrature(spar_member *beam, int rule, int points); /* SPAR_QUADRATURE_GAUSS, _LOBATTO, _SECTIONS (points per section interval) */
SPAR_API int spar_beam_set_damping(spar_member *beam, const double mu[6]); /* stiffness-proportional, per strain component */
SPAR_API int spar_member_set_placement(spar_member *member, const double x[3], const double q[4]); /* from its own frame to the reference place */
SPAR_API int spar_member_set_root(spar_member *member, int kind); /* SPAR_ROOT_FREE, _FIXED, _PINNED (turns freely about a fixed place), _DRIVEN */
SPAR_API int spar_member_set_external(spar_member *member, int on); /* the host solves it: set_motion in, get_loads out */
SPAR_API int spar_member_set_effects(spar_member *member, int effects); /* SPAR_EFFECT_* or-ed; see Effects */
SPAR_API int spar_member_set_velocity(spar_member *member, const double x0[3], const double v0[3], const double omega[3]); /* initial rigid-body field */
SPAR_API int spar_member_set_owner(spar_member *member, int rank); /* default: spread over the ranks */
SPAR_API int spar_member_commit(spar_member *member); /* collective: checks everything, allocates everything */
SPAR_API int spar_member_get_count(const spar_member *member, int64_t *nodes);
SPAR_API int spar_member_get_reference(const spar_member *member, double *x, double *q);
SPAR_API int spar_member_get_motion(const spar_member *member, double *q, double *v, double *a); /* [n][7], [n][6], [n][6]; any may be NULL */
SPAR_API int spar_member_set_motion(spar_member *member, const double *q, const double *v, const double *a); /* external members and points */
SPAR_API int spar_member_drive_root(spar_member *member, const double q[7], const double v[6], const double a[6]); /* root motion at the end of the step begun next */
SPAR_API int spar_member_add_load(spar_member *member, int64_t node, const double load[6]); /* dead load, kept until changed */
SPAR_API int spar_member_get_loads(const spar_member *member, double *load); /* [n][6] nodal loads in use */
SPAR_API int spar_member_get_reaction(const spar_member *member, double load[6]); /* what the root gives the member */
SPAR_API int spar_member_get_energy(const spar_member *member, double energy[4]); /* kinetic, strain, gravity potential, dissipated */
SPAR_API int spar_member_solve_static(spar_member *member, int load_steps);
SPAR_API int spar_member_get_modes(spar_member *member, int64_t n, double *frequency_hz, double *shapes); /* about the present state; shapes [n][nodes][6] or NULL */

/* fluids: a fluid model tied to one member on this rank; a member can have many */
SPAR_API int spar_fluid_create(spar_member *member, const char *name, spar_fluid **fluid);
SPAR_API void spar_fluid_destroy(spar_fluid **fluid); /* polars, aero objects and fluids can go before the session */
SPAR_API int spar_fluid_set_motion_nodes(spar_fluid *fluid, int64_t n, const double *x); /* reference places, [n][3] */
SPAR_API int spar_fluid_set_force_nodes(spar_fluid *fluid, int64_t n, const double *x);
SPAR_API int spar_fluid_set_sections(spar_fluid *fluid, int64_t n, const double *xi, const double *offset);
     /* BE/BEMT: motion nodes = force nodes; offset [n][3] in the local section frame (x tangent, y, z), NULL: 0 */
SPAR_API int spar_fluid_set_projection(spar_fluid *fluid, int method, double max_distance); /* SPAR_PROJECT_BOUNDED (default), SPAR_PROJECT_RPOLY; <= 0: no limit */
SPAR_API int spar_fluid_set_interpolation(spar_fluid *fluid, int kind); /* SPAR_INTERPOLATE_NODAL (spec), SPAR_INTERPOLATE_CONSISTENT */
SPAR_API int spar_fluid_map(spar_fluid *fluid); /* local */
SPAR_API int spar_fluid_get_count(const spar_fluid *fluid, int which, int64_t *n); /* local; how many nodes of SPAR_NODES_MOTION / _FORCE this fluid has on this rank */
SPAR_API int spar_fluid_get_map(const spar_fluid *fluid, int which, double *xi, double *distance, int *flags); /* SPAR_NODES_MOTION / _FORCE; SPAR_MAP_END, _AMBIGUOUS, _FAR */
SPAR_API int spar_fluid_get_feet(const spar_fluid *fluid, int which, double *x_map, double *q_map, double *con); /* reference foot [n][3], its orientation [n][4], foot-to-node vector [n][3] (the
     spec's motion-con; force-con is its negative); any NULL */
SPAR_API int spar_fluid_get_basis(const spar_fluid *fluid, int which, int64_t *first_node, double *phi); /* node the P basis values [n][P] of each fluid node begin at */
SPAR_API int spar_fluid_pull_motion(spar_fluid *fluid, double theta, double *x, double *v); /* at t^n + theta dt, theta in [0,1]; [n][3] each, any may be NULL */
SPAR_API int spar_fluid_pull_sections(spar_fluid *fluid, double theta, double *q, double *omega, double *accel); /* orientation now [n][4], omega [n][3], linear acceleration [n][3] */
SPAR_API int spar_fluid_pull_forces(spar_fluid *fluid, double theta, double *force); /* the fluid's own node forces at theta (actuator line) */
SPAR_API int spar_fluid_push_forces(spar_fluid *fluid, const double *force, const double *moment); /* at t^{n+1}; moment NULL: none */
SPAR_API int spar_fluid_get_audit(const spar_fluid *fluid, double audit[8]); /* force, moment, power in; their relative errors after transfer; |x| scale; n */

/* one coupling step; all collective over the session */
SPAR_API int spar_step_begin(spar_session *session, double dt); /* predict the loads at t^{n+1} */
SPAR_API int spar_step_solve(spar_session *session); /* structure to t^{n+1}, in substeps, from t^n every time it is called */
SPAR_API int spar_step_check(spar_session *session, int *done); /* loads pushed -> nodes -> residual -> next loads */
SPAR_API int spar_step_accept(spar_session *session);
SPAR_API int spar_step_reject(spar_session *session); /* back to t^n, as if the step had not begun */
typedef int (*spar_fluid_solver)(spar_session *session, double t, double dt, int iteration, void *context);
SPAR_API int spar_step(spar_session *session, double dt, spar_fluid_solver solve, void *context, int *iterations);
SPAR_API int spar_session_save(const spar_session *session, const char *path);
SPAR_API int spar_session_load(spar_session *session, const char *path);
/* log: silent by default */
typedef void (*spar_log)(const spar_session *session, int level, const char *text, void *context);
SPAR_API int spar_session_set_log(spar_session *session, spar_log log, void *context);

#ifdef __cplusplus
}
#endif

#endif
