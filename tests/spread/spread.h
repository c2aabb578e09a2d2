/* Serial tests on several ranks: included before anything else, it puts calls of its own in the place of those of spar
   that a test's fluid makes. All ranks run the same test in a session over them all; a fluid's nodes are dealt out over
   the ranks, each gives and gets its own alone, and what was pulled is put together again, so that the test sees what
   it would see on one process. run says how the nodes are dealt out and what must come out the same. */
#ifndef SPREAD_H
#define SPREAD_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

#include <spar/spar.h>
#include <spar/spar_analysis.h>
#include <spar/spar_coupling.h>
#include <spar/spar_structure.h>

int spread_run(const struct CMUnitTest *tests, size_t count, CMFixtureFunction setup, CMFixtureFunction teardown);
int spread_session_create(spar_session **session);
int spread_create(spar_member *member, const char *name, spar_fluid **fluid);
int spread_set_motion_nodes(spar_fluid *fluid, int64_t n, const double *x);
int spread_set_force_nodes(spar_fluid *fluid, int64_t n, const double *x);
int spread_set_sections(spar_fluid *fluid, int64_t n, const double *eta, const double *offset);
int spread_set_motion_sections(spar_fluid *fluid, int64_t n, const double *eta, const double *offset);
int spread_set_motion_weights(spar_fluid *fluid, int64_t n, const double *w);
int spread_get_count(const spar_fluid *fluid, int which, int64_t *n);
int spread_get_flag_count(const spar_fluid *fluid, int which, int flag, int64_t *n);
int spread_get_map(const spar_fluid *fluid, int which, double *eta, double *distance, int *flags);
int spread_get_nearest(const spar_fluid *fluid, int which, double *x_map, double *q_map, double *con);
int spread_get_positions(const spar_fluid *fluid, int which, double *x, double *q, double *v, double *nearest);
int spread_pull_motion(spar_fluid *fluid, double theta, double *x, double *v);
int spread_pull_poses(spar_fluid *fluid, int which, double theta, double *x, double *q, double *v, double *omega,
                      double *accel, double *alpha);
int spread_pull_forces(spar_fluid *fluid, double theta, double *force);
int spread_get_forces(const spar_fluid *fluid, double *force);
int spread_pull_motion_f32(spar_fluid *fluid, double theta, float *x, float *v);
int spread_pull_poses_f32(spar_fluid *fluid, int which, double theta, float *x, float *q, float *v, float *omega,
                          float *accel, float *alpha);
int spread_pull_forces_f32(spar_fluid *fluid, double theta, float *force);
int spread_push_forces_f32(spar_fluid *fluid, const float *force, const float *moment);
int spread_get_travel(spar_fluid *fluid, double *largest, int64_t *node);
int spread_push_forces(spar_fluid *fluid, const double *force, const double *moment);
int spread_push_forces_at(spar_fluid *fluid, double theta, const double *force, const double *moment);
int spread_commit(spar_member *member);
int spread_member_solve_static(spar_member *member, int load_steps);
int spread_solve_static(spar_session *session, int load_steps, spar_fluid_solver solve, void *context, int *iterations);
int spread_start(spar_session *session, double dt, spar_fluid_solver solve, void *context, int *iterations);
int spread_step(spar_session *session, double dt, spar_fluid_solver solve, void *context, int *iterations);
int spread_step_begin(spar_session *session, double dt);
int spread_step_solve(spar_session *session);
int spread_step_check(spar_session *session, int *done);
int spread_step_accept(spar_session *session);
int spread_get_motion(const spar_member *member, double *q, double *v, double *a);
int spread_get_loads(const spar_member *member, double *load);
int spread_get_reaction(const spar_member *member, double *load);
int spread_trial_run(spar_trial *trial, int compare);
int spread_trial_report_effects(spar_trial *trial);
int spread_trial_advise(spar_trial *trial, double tolerance, double length);
int spread_trial_apply(spar_trial *trial, double *dt);
int spread_set_coupling(spar_session *session, int scheme, double atol, double rtol, int max_iterations);
int spread_remove(const char *path);

#ifndef SPREAD_ITSELF
#undef cmocka_run_group_tests
#define cmocka_run_group_tests(tests, setup, teardown)                                                                 \
    spread_run(tests, sizeof(tests) / sizeof *(tests), setup, teardown)
#define spar_session_create spread_session_create
#define spar_fluid_create spread_create
#define spar_fluid_set_motion_nodes spread_set_motion_nodes
#define spar_fluid_set_force_nodes spread_set_force_nodes
#define spar_fluid_set_stations spread_set_sections
#define spar_fluid_set_motion_stations spread_set_motion_sections
#define spar_fluid_set_motion_weights spread_set_motion_weights
#define spar_fluid_get_count spread_get_count
#define spar_fluid_get_flag_count spread_get_flag_count
#define spar_fluid_get_map spread_get_map
#define spar_fluid_get_nearest spread_get_nearest
#define spar_fluid_get_positions spread_get_positions
#define spar_fluid_pull_motion spread_pull_motion
#define spar_fluid_pull_poses spread_pull_poses
#define spar_fluid_pull_forces spread_pull_forces
#define spar_fluid_get_forces spread_get_forces
#define spar_fluid_pull_motion_f32 spread_pull_motion_f32
#define spar_fluid_pull_poses_f32 spread_pull_poses_f32
#define spar_fluid_pull_forces_f32 spread_pull_forces_f32
#define spar_fluid_push_forces_f32 spread_push_forces_f32
#define spar_fluid_get_travel spread_get_travel
#define spar_fluid_push_forces spread_push_forces
#define spar_fluid_push_forces_at spread_push_forces_at
#define spar_member_commit spread_commit
#define spar_member_solve_static spread_member_solve_static
#define spar_session_solve_static spread_solve_static
#define spar_session_solve_initial spread_start
#define spar_step spread_step
#define spar_step_begin spread_step_begin
#define spar_step_solve spread_step_solve
#define spar_step_check spread_step_check
#define spar_step_accept spread_step_accept
#define spar_member_get_motion spread_get_motion
#define spar_member_get_loads spread_get_loads
#define spar_member_get_reaction spread_get_reaction
#define spar_trial_run spread_trial_run
#define spar_trial_report_effects spread_trial_report_effects
#define spar_trial_advise spread_trial_advise
#define spar_trial_apply spread_trial_apply
#define spar_session_set_coupling spread_set_coupling
#define remove spread_remove
#endif

#endif
