/* The fuzzer: random sequences of all public calls, with invariants after each.

   A sequence is a flat list of records (call, style, seed). What a record does is found when it is run: its arguments
   come from its own stream of random words, its handles from what is alive then, so that any part of a list is a list
   too. That is how a sequence that shows something is made shorter. */
#ifndef FUZZ_H
#define FUZZ_H

#include "calls_plain.h"

#include <spar/spar.h>
#include <spar/spar_aero.h>
#include <spar/spar_analysis.h>
#include <spar/spar_coupling.h>
#include <spar/spar_output.h>
#include <spar/spar_structure.h>

#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

/* ---- the calls ---- */

/* What a success may do; what a failure leaves as it was is found by the same. */
enum {
    FUZZ_CHANGES = 0,
    FUZZ_PURE = 1,     /* changes nothing that can be seen */
    FUZZ_TRIAL = 2,    /* the same, but for the results of a blade element's last solve */
    FUZZ_TEXT = 4,     /* cannot fail: destroys and getters of text */
    FUZZ_PUSH = 8,     /* loads of a fluid: what a callback may do in a trial */
    FUZZ_HARNESS = 16, /* not of the library */
    FUZZ_NEVER = 32    /* cannot succeed here */
};

/* call, weight among random calls (of 10000 or so), flags; calls that are not here are in calls_plain.h */
#define FUZZ_CALLS(CALL)                                                                                               \
    CALL(spar_status_text, 10, FUZZ_PURE | FUZZ_TEXT)                                                                  \
    CALL(spar_version, 5, FUZZ_PURE | FUZZ_TEXT)                                                                       \
    CALL(spar_has, 5, FUZZ_PURE | FUZZ_TEXT)                                                                           \
    CALL(spar_effect_name, 5, FUZZ_PURE | FUZZ_TEXT)                                                                   \
    CALL(spar_aero_effect_name, 5, FUZZ_PURE | FUZZ_TEXT)                                                              \
    CALL(spar_session_create, 10, FUZZ_CHANGES)                                                                        \
    CALL(spar_session_create_fcomm, 10, FUZZ_NEVER)                                                                    \
    CALL(spar_session_destroy, 4, FUZZ_TEXT)                                                                           \
    CALL(spar_session_message, 20, FUZZ_PURE | FUZZ_TEXT)                                                              \
    CALL(spar_session_get_warning, 20, FUZZ_PURE | FUZZ_TEXT)                                                          \
    CALL(spar_session_fail, 20, FUZZ_CHANGES)                                                                          \
    CALL(spar_session_set_gravity, 60, FUZZ_CHANGES)                                                                   \
    CALL(spar_session_set_integrator, 60, FUZZ_CHANGES)                                                                \
    CALL(spar_session_set_newton, 40, FUZZ_CHANGES)                                                                    \
    CALL(spar_session_set_predictor, 60, FUZZ_CHANGES)                                                                 \
    CALL(spar_session_set_coupling, 100, FUZZ_CHANGES)                                                                 \
    CALL(spar_session_set_relaxation, 40, FUZZ_CHANGES)                                                                \
    CALL(spar_session_set_reproducible, 20, FUZZ_CHANGES)                                                              \
    CALL(spar_session_set_threads, 20, FUZZ_CHANGES)                                                                   \
    CALL(spar_session_set_tolerance, 60, FUZZ_CHANGES)                                                                 \
    CALL(spar_session_get_step_control, 40, FUZZ_PURE)                                                                 \
    CALL(spar_session_set_option, 140, FUZZ_CHANGES)                                                                   \
    CALL(spar_member_get_placement, 20, FUZZ_PURE)                                                                     \
    CALL(spar_member_get_root, 20, FUZZ_PURE)                                                                          \
    CALL(spar_member_get_external, 20, FUZZ_PURE)                                                                      \
    CALL(spar_member_get_effects, 20, FUZZ_PURE)                                                                       \
    CALL(spar_member_get_fidelity, 20, FUZZ_PURE)                                                                      \
    CALL(spar_member_get_owner, 20, FUZZ_PURE)                                                                         \
    CALL(spar_member_get_iterations, 20, FUZZ_PURE)                                                                    \
    CALL(spar_beam_get_elements, 20, FUZZ_PURE)                                                                        \
    CALL(spar_beam_get_quadrature, 20, FUZZ_PURE)                                                                      \
    CALL(spar_beam_get_damping, 20, FUZZ_PURE)                                                                         \
    CALL(spar_fluid_get_projection, 20, FUZZ_PURE)                                                                     \
    CALL(spar_fluid_get_interpolation, 20, FUZZ_PURE)                                                                  \
    CALL(spar_session_get_phase, 20, FUZZ_PURE)                                                                        \
    CALL(spar_session_sum, 20, FUZZ_PURE)                                                                              \
    CALL(spar_session_sum_balance, 20, FUZZ_PURE)                                                                      \
    CALL(spar_member_get_session, 20, FUZZ_PURE)                                                                       \
    CALL(spar_member_get_name, 10, FUZZ_PURE | FUZZ_TEXT)                                                              \
    CALL(spar_fluid_get_member, 20, FUZZ_PURE)                                                                         \
    CALL(spar_fluid_get_name, 10, FUZZ_PURE | FUZZ_TEXT)                                                               \
    CALL(spar_fluid_fail, 30, FUZZ_PUSH)                                                                               \
    CALL(spar_session_get_option, 40, FUZZ_PURE)                                                                       \
    CALL(spar_session_get_iterations, 60, FUZZ_PURE)                                                                   \
    CALL(spar_session_get_report, 60, FUZZ_PURE)                                                                       \
    CALL(spar_session_set_log, 40, FUZZ_CHANGES)                                                                       \
    CALL(spar_log_stderr, 5, FUZZ_TEXT | FUZZ_PURE)                                                                    \
    CALL(spar_session_set_progress, 20, FUZZ_CHANGES)                                                                  \
    CALL(spar_point_create, 25, FUZZ_CHANGES)                                                                          \
    CALL(spar_rigid_create, 25, FUZZ_CHANGES)                                                                          \
    CALL(spar_beam_create, 30, FUZZ_CHANGES)                                                                           \
    CALL(spar_beam_set_axis, 50, FUZZ_CHANGES)                                                                         \
    CALL(spar_beam_set_nodes, 40, FUZZ_CHANGES)                                                                        \
    CALL(spar_beam_set_sections, 50, FUZZ_CHANGES)                                                                     \
    CALL(spar_beam_set_quadrature, 40, FUZZ_CHANGES)                                                                   \
    CALL(spar_beam_set_damping, 40, FUZZ_CHANGES)                                                                      \
    CALL(spar_beam_set_mass_damping, 30, FUZZ_CHANGES)                                                                 \
    CALL(spar_beam_get_mass_damping, 20, FUZZ_PURE)                                                                    \
    CALL(spar_beam_set_plane, 20, FUZZ_CHANGES)                                                                        \
    CALL(spar_beam_get_plane, 20, FUZZ_PURE)                                                                           \
    CALL(spar_beam_set_masses, 40, FUZZ_CHANGES)                                                                       \
    CALL(spar_beam_get_masses, 20, FUZZ_PURE)                                                                          \
    CALL(spar_beam_set_foundation, 40, FUZZ_CHANGES)                                                                   \
    CALL(spar_beam_get_foundation, 20, FUZZ_PURE)                                                                      \
    CALL(spar_beam_set_pretension, 40, FUZZ_CHANGES)                                                                   \
    CALL(spar_beam_get_pretension, 20, FUZZ_PURE)                                                                      \
    CALL(spar_beam_read_beamdyn, 15, FUZZ_CHANGES)                                                                     \
    CALL(spar_beam_set_line_load, 100, FUZZ_CHANGES)                                                                   \
    CALL(spar_beam_set_modal_damping, 30, FUZZ_CHANGES)                                                                \
    CALL(spar_beam_fit_damping, 30, FUZZ_CHANGES)                                                                      \
    CALL(spar_beam_evaluate, 100, FUZZ_PURE)                                                                           \
    CALL(spar_member_set_placement, 40, FUZZ_CHANGES)                                                                  \
    CALL(spar_member_set_root, 40, FUZZ_CHANGES)                                                                       \
    CALL(spar_member_set_external, 30, FUZZ_CHANGES)                                                                   \
    CALL(spar_member_set_effects, 40, FUZZ_CHANGES)                                                                    \
    CALL(spar_member_set_fidelity, 40, FUZZ_CHANGES)                                                                   \
    CALL(spar_member_set_added_mass, 40, FUZZ_CHANGES)                                                                 \
    CALL(spar_member_get_added_mass, 20, FUZZ_PURE)                                                                    \
    CALL(spar_member_set_added_mass_response, 20, FUZZ_CHANGES)                                                        \
    CALL(spar_member_get_added_mass_response, 20, FUZZ_PURE)                                                           \
    CALL(spar_member_learn_added_mass, 40, FUZZ_CHANGES)                                                               \
    CALL(spar_member_get_learned_added_mass, 20, FUZZ_PURE)                                                            \
    CALL(spar_member_set_initial_velocity, 60, FUZZ_CHANGES)                                                           \
    CALL(spar_member_set_owner, 20, FUZZ_CHANGES)                                                                      \
    CALL(spar_member_commit, 60, FUZZ_CHANGES)                                                                         \
    CALL(spar_member_get_count, 30, FUZZ_PURE)                                                                         \
    CALL(spar_member_get_reference, 60, FUZZ_PURE)                                                                     \
    CALL(spar_member_get_motion, 80, FUZZ_PURE)                                                                        \
    CALL(spar_member_set_motion, 100, FUZZ_CHANGES)                                                                    \
    CALL(spar_member_drive, 140, FUZZ_CHANGES)                                                                         \
    CALL(spar_member_set_load, 240, FUZZ_CHANGES)                                                                      \
    CALL(spar_member_get_loads, 60, FUZZ_PURE)                                                                         \
    CALL(spar_member_get_reaction, 60, FUZZ_PURE)                                                                      \
    CALL(spar_member_get_energy, 60, FUZZ_PURE)                                                                        \
    CALL(spar_member_get_work, 60, FUZZ_PURE)                                                                          \
    CALL(spar_member_solve_static, 30, FUZZ_CHANGES)                                                                   \
    CALL(spar_member_solve_modes, 60, FUZZ_PURE)                                                                       \
    CALL(spar_member_solve_eigenvalues, 60, FUZZ_PURE)                                                                 \
    CALL(spar_member_write_vtk, 10, FUZZ_PURE)                                                                         \
    CALL(spar_joint_create, 80, FUZZ_CHANGES)                                                                          \
    CALL(spar_link_create, 40, FUZZ_CHANGES)                                                                           \
    CALL(spar_joint_set_frame, 60, FUZZ_CHANGES)                                                                       \
    CALL(spar_joint_set_spring, 50, FUZZ_CHANGES)                                                                      \
    CALL(spar_spring_create, 30, FUZZ_CHANGES)                                                                         \
    CALL(spar_link_set_spring, 50, FUZZ_CHANGES)                                                                       \
    CALL(spar_joint_set_driven, 60, FUZZ_CHANGES)                                                                      \
    CALL(spar_joint_drive, 80, FUZZ_CHANGES)                                                                           \
    CALL(spar_joint_set_load, 30, FUZZ_CHANGES)                                                                        \
    CALL(spar_joint_get_motion, 20, FUZZ_PURE)                                                                         \
    CALL(spar_joint_get_load, 20, FUZZ_PURE)                                                                           \
    CALL(spar_joint_get_energy, 60, FUZZ_PURE)                                                                         \
    CALL(spar_fluid_create, 50, FUZZ_CHANGES)                                                                          \
    CALL(spar_fluid_destroy, 20, FUZZ_TEXT)                                                                            \
    CALL(spar_fluid_set_motion_nodes, 60, FUZZ_CHANGES)                                                                \
    CALL(spar_fluid_set_force_nodes, 60, FUZZ_CHANGES)                                                                 \
    CALL(spar_fluid_set_stations, 60, FUZZ_CHANGES)                                                                    \
    CALL(spar_fluid_set_motion_weights, 60, FUZZ_CHANGES)                                                              \
    CALL(spar_fluid_get_motion_weights, 20, FUZZ_PURE)                                                                 \
    CALL(spar_fluid_fade_motion, 40, FUZZ_CHANGES)                                                                     \
    CALL(spar_fluid_set_motion_stations, 60, FUZZ_CHANGES)                                                             \
    CALL(spar_fluid_get_kind, 20, FUZZ_PURE)                                                                           \
    CALL(spar_fluid_get_positions, 40, FUZZ_PURE)                                                                      \
    CALL(spar_fluid_get_forces, 30, FUZZ_PURE)                                                                         \
    CALL(spar_fluid_set_states, 60, FUZZ_CHANGES)                                                                      \
    CALL(spar_fluid_get_states, 20, FUZZ_PURE)                                                                         \
    CALL(spar_fluid_pull_states, 30, FUZZ_PURE)                                                                        \
    CALL(spar_fluid_push_states, 60, FUZZ_PUSH)                                                                        \
    CALL(spar_fluid_set_layout, 50, FUZZ_CHANGES)                                                                      \
    CALL(spar_fluid_get_layout, 20, FUZZ_PURE)                                                                         \
    CALL(spar_fluid_set_projection, 50, FUZZ_CHANGES)                                                                  \
    CALL(spar_fluid_set_interpolation, 50, FUZZ_CHANGES)                                                               \
    CALL(spar_fluid_set_option, 60, FUZZ_CHANGES)                                                                      \
    CALL(spar_fluid_get_option, 20, FUZZ_PURE)                                                                         \
    CALL(spar_fluid_map, 140, FUZZ_CHANGES)                                                                            \
    CALL(spar_fluid_get_count, 40, FUZZ_PURE)                                                                          \
    CALL(spar_fluid_get_flag_count, 40, FUZZ_PURE)                                                                     \
    CALL(spar_fluid_get_map, 60, FUZZ_PURE)                                                                            \
    CALL(spar_fluid_get_nearest, 60, FUZZ_PURE)                                                                        \
    CALL(spar_fluid_get_basis, 60, FUZZ_PURE)                                                                          \
    CALL(spar_fluid_pull_motion, 150, FUZZ_PURE)                                                                       \
    CALL(spar_fluid_pull_motion_f32, 60, FUZZ_PURE)                                                                    \
    CALL(spar_fluid_pull_poses_f32, 60, FUZZ_PURE)                                                                     \
    CALL(spar_fluid_pull_poses, 80, FUZZ_PURE)                                                                         \
    CALL(spar_fluid_pull_matrices, 80, FUZZ_PURE)                                                                      \
    CALL(spar_fluid_check_matrices, 60, FUZZ_PURE)                                                                     \
    CALL(spar_fluid_pull_forces, 80, FUZZ_PURE)                                                                        \
    CALL(spar_fluid_pull_forces_f32, 60, FUZZ_PURE)                                                                    \
    CALL(spar_fluid_push_forces, 200, FUZZ_PUSH)                                                                       \
    CALL(spar_fluid_push_forces_at, 120, FUZZ_PUSH)                                                                    \
    CALL(spar_fluid_push_forces_f32, 80, FUZZ_PUSH)                                                                    \
    CALL(spar_fluid_get_audit, 40, FUZZ_PURE)                                                                          \
    CALL(spar_fluid_check_loads, 20, FUZZ_PURE)                                                                        \
    CALL(spar_fluid_sum_loads, 40, FUZZ_PURE)                                                                          \
    CALL(spar_fluid_get_travel, 40, FUZZ_PURE)                                                                         \
    CALL(spar_fluid_write_vtk, 10, FUZZ_PURE)                                                                          \
    CALL(spar_step_begin, 350, FUZZ_CHANGES)                                                                           \
    CALL(spar_step_solve, 350, FUZZ_CHANGES)                                                                           \
    CALL(spar_step_check, 250, FUZZ_CHANGES)                                                                           \
    CALL(spar_step_accept, 250, FUZZ_CHANGES)                                                                          \
    CALL(spar_step_reject, 100, FUZZ_CHANGES)                                                                          \
    CALL(spar_step, 250, FUZZ_CHANGES)                                                                                 \
    CALL(spar_session_solve_initial, 60, FUZZ_CHANGES)                                                                 \
    CALL(spar_step_adaptive, 80, FUZZ_CHANGES)                                                                         \
    CALL(spar_member_estimate_error, 60, FUZZ_PURE)                                                                    \
    CALL(spar_step_begin_initial, 60, FUZZ_CHANGES)                                                                    \
    CALL(spar_session_solve_static, 60, FUZZ_CHANGES)                                                                  \
    CALL(spar_session_save, 20, FUZZ_PURE)                                                                             \
    CALL(spar_session_load, 20, FUZZ_CHANGES)                                                                          \
    CALL(spar_trial_create, 25, FUZZ_PURE)                                                                             \
    CALL(spar_trial_destroy, 5, FUZZ_TEXT)                                                                             \
    CALL(spar_trial_get_session, 10, FUZZ_PURE)                                                                        \
    CALL(spar_trial_set_steps, 60, FUZZ_PURE)                                                                          \
    CALL(spar_trial_get_steps, 10, FUZZ_PURE)                                                                          \
    CALL(spar_trial_set_callbacks, 40, FUZZ_PURE)                                                                      \
    CALL(spar_trial_set_progress, 10, FUZZ_PURE)                                                                       \
    CALL(spar_trial_set_goals, 20, FUZZ_PURE)                                                                          \
    CALL(spar_trial_get_goals, 10, FUZZ_PURE)                                                                          \
    CALL(spar_trial_push_numbers, 20, FUZZ_PURE)                                                                       \
    CALL(spar_trial_set_option, 40, FUZZ_PURE)                                                                         \
    CALL(spar_trial_get_option, 20, FUZZ_PURE)                                                                         \
    CALL(spar_trial_set_motion, 20, FUZZ_PURE)                                                                         \
    CALL(spar_trial_get_motion, 10, FUZZ_PURE)                                                                         \
    CALL(spar_trial_run, 16, FUZZ_TRIAL)                                                                               \
    CALL(spar_trial_get_errors, 20, FUZZ_PURE)                                                                         \
    CALL(spar_trial_get_cost, 20, FUZZ_PURE)                                                                           \
    CALL(spar_trial_report_effects, 5, FUZZ_TRIAL)                                                                     \
    CALL(spar_trial_get_effect, 30, FUZZ_PURE)                                                                         \
    CALL(spar_trial_solve_eigenvalues, 8, FUZZ_TRIAL)                                                                  \
    CALL(spar_trial_solve_floquet, 5, FUZZ_TRIAL)                                                                      \
    CALL(spar_trial_advise, 1, FUZZ_TRIAL)                                                                             \
    CALL(spar_trial_get_settings, 20, FUZZ_PURE)                                                                       \
    CALL(spar_trial_get_beam, 20, FUZZ_PURE)                                                                           \
    CALL(spar_trial_get_outcome, 20, FUZZ_PURE)                                                                        \
    CALL(spar_trial_get_search, 20, FUZZ_PURE)                                                                         \
    CALL(spar_trial_apply, 10, FUZZ_CHANGES)                                                                           \
    CALL(spar_vtk_series_add, 10, FUZZ_PURE)                                                                           \
    CALL(spar_section_report, 10, FUZZ_PURE)                                                                           \
    CALL(spar_polar_create, 25, FUZZ_CHANGES)                                                                          \
    CALL(spar_polar_set_interpolation, 25, FUZZ_CHANGES)                                                               \
    CALL(spar_polar_evaluate, 40, FUZZ_PURE)                                                                           \
    CALL(spar_polar_destroy, 10, FUZZ_TEXT)                                                                            \
    CALL(spar_aero_create, 30, FUZZ_CHANGES)                                                                           \
    CALL(spar_aero_destroy, 10, FUZZ_TEXT)                                                                             \
    CALL(spar_aero_set_section, 80, FUZZ_CHANGES)                                                                      \
    CALL(spar_fluid_read_aerodyn, 12, FUZZ_CHANGES)                                                                    \
    CALL(spar_aero_read_aerodyn, 20, FUZZ_CHANGES)                                                                     \
    CALL(spar_aero_set_rotor, 50, FUZZ_CHANGES)                                                                        \
    CALL(spar_aero_set_turn, 25, FUZZ_CHANGES)                                                                         \
    CALL(spar_aero_set_shear, 25, FUZZ_CHANGES)                                                                        \
    CALL(spar_aero_set_tower, 25, FUZZ_CHANGES)                                                                        \
    CALL(spar_aero_set_blades, 25, FUZZ_CHANGES)                                                                       \
    CALL(spar_aero_set_effects, 30, FUZZ_CHANGES)                                                                      \
    CALL(spar_aero_solve, 150, FUZZ_PUSH)                                                                              \
    CALL(spar_aero_get_rotor, 30, FUZZ_PURE)                                                                           \
    CALL(spar_aero_get_sections, 30, FUZZ_PURE)                                                                        \
    CALL(spar_aero_get_flags, 30, FUZZ_PURE)                                                                           \
    CALL(spar_aero_get_chord, 30, FUZZ_PURE)                                                                           \
    CALL(spar_aero_get_loads, 30, FUZZ_PURE)                                                                           \
    CALL(spar_aero_get_effect, 30, FUZZ_PURE)                                                                          \
    CALL(spar_aero_report_effects, 4, FUZZ_TRIAL)                                                                      \
    CALL(damage_file, 6, FUZZ_HARNESS)                                                                                 \
    FUZZ_PLAIN_CALLS(CALL)

enum {
#define FUZZ_ENUM(name, weight, flags) CALL_##name,
    FUZZ_CALLS(FUZZ_ENUM)
#undef FUZZ_ENUM
        CALL_COUNT
};

typedef struct call call;
typedef struct description {
    const char *name;
    void (*run)(call *c);
    int weight, flags;
} description;
extern const description fuzz_calls[CALL_COUNT];

/* ---- sequences ---- */

enum {
    STYLE_GOOD = 1,  /* no argument is odd */
    STYLE_RECENT = 2 /* handles: the latest of their kind */
};
typedef struct record {
    int call, style;
    uint64_t seed;
} record;

/* The sequence of a seed, into list[room]; answers its length. */
int fuzz_sequence(uint64_t seed, record *list, int room);

/* ---- random words ---- */

uint64_t fuzz_mix(uint64_t a, uint64_t b);
uint64_t fuzz_next(uint64_t *state);

/* ---- the world: what is alive ---- */

enum { SESSIONS = 3, MEMBERS = 10, JOINTS = 6, FLUIDS = 8, POLARS = 3, AEROS = 3, BLADES = 3, TRIALS = 4 };
enum { KIND_POINT, KIND_RIGID, KIND_BEAM };
typedef struct live_session {
    spar_session *s;
    int busy; /* a call on it is under way */
    int wild; /* an odd number has been accepted: solutions may not exist */
    int logs; /* it has a log */
    long logged;
    int tied; /* it has joints whose handles were not asked for */
} live_session;
typedef struct live_member {
    spar_member *m;
    int session, kind, elements, per_element, committed;
    int64_t made; /* when, to know the latest */
} live_member;
typedef struct live_joint {
    spar_joint *j;
    int session, line, free_motions, driven;
    int64_t made;
} live_joint;
typedef struct live_fluid {
    spar_fluid *f;
    int session, member;
    int64_t made;
} live_fluid;
typedef struct live_aero {
    spar_aero *a;
    int session, blades, fluid[BLADES], orphan, busy;
    int64_t n, made;
} live_aero;
typedef struct host {
    struct world *w;
    int session, mode, fail_at, count;
    uint64_t seed;
} host;
typedef struct live_trial {
    spar_trial *t;
    int session, busy; /* busy: a call of it is under way, which reads host */
    host host;         /* of its callbacks */
    int64_t made;
} live_trial;
typedef struct world {
    live_session session[SESSIONS];
    live_member member[MEMBERS];
    live_joint joint[JOINTS];
    live_fluid fluid[FLUIDS];
    live_aero aero[AEROS];
    live_trial trial[TRIALS];
    spar_polar *polar[POLARS];
    int64_t clock; /* counts what is made */
    int depth;     /* of calls within calls */
    int budget;    /* of calls within the present one */
    int taint;     /* changes made by callbacks */
    int failures;  /* within callbacks */
    int quiet;     /* the fuzzer's own questions */
    int verbose;
    int absurd; /* a polar with odd numbers has been made: loads from it are wild */
    int fault;  /* state of the injected fault */
    char folder[64];
    int64_t beams_files;
} world;

extern world fuzz_world;

/* ---- a call ---- */

enum { CALL_HOLDS = 24, CALL_TEXT = 8192 };
struct call {
    world *w;
    const description *what;
    uint64_t random;
    int style, index;
    int odds;                     /* of 256: that an argument is odd */
    int wild;                     /* an odd number was drawn */
    int session;                  /* index of its session, -1: none */
    const spar_session *where[2]; /* who may have the message */
    int asked;                    /* entries of `where` */
    int status, watched;
    void *hold[CALL_HOLDS];
    int held;
    uint64_t before[3];
    int taint, failures;
    size_t used;
    char text[CALL_TEXT];
};

void fuzz_run(world *w, const record *r);
void fuzz_before(call *c);
void fuzz_after(call *c, int status);
#define RUN(c, expression)                                                                                             \
    do {                                                                                                               \
        fuzz_before(c);                                                                                                \
        fuzz_after(c, expression);                                                                                     \
    } while (0)
#define RUN_VOID(c, expression)                                                                                        \
    do {                                                                                                               \
        fuzz_before(c);                                                                                                \
        expression;                                                                                                    \
        fuzz_after(c, SPAR_OK);                                                                                        \
    } while (0)

/* What is wrong: told to the process that watches; does not return. */
_Noreturn void fuzz_finding(const char *kind, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* To the terminal, whatever the standard output is now. */
void fuzz_say(const char *format, ...) __attribute__((format(printf, 1, 2)));
/* Of the call under way, for who watches. */
void fuzz_count(int index, int status);

/* The end of a sequence: every session still steps; then all is destroyed. */
void fuzz_world_begin(world *w, int verbose);
void fuzz_world_end(world *w);

/* state, reports (coupling, audit), blade elements: what can be seen of a session */
void fuzz_digest(world *w, int session, uint64_t digest[3]);

/* ---- arguments ---- */

uint64_t word(call *c);
int below(call *c, int n);        /* 0 to n-1 */
int chance(call *c, int percent); /* of anything */
double uniform(call *c, double lo, double hi);
int odd(call *c);                 /* is this argument to be odd? */
void is_text(const char *answer); /* is read to its end */
void is_name(const char *answer); /* the same */
void text(call *c, const char *format, ...) __attribute__((format(printf, 2, 3)));

live_session *arg_session(call *c);
live_member *arg_member(call *c, int kind); /* kind -1: any; .m NULL: none */
enum { JOINT_ANY, JOINT_PLAIN, JOINT_LINE, JOINT_DRIVEN };
live_joint *arg_joint(call *c, int kind); /* .j NULL: none */
live_fluid *arg_fluid(call *c);
live_aero *arg_aero(call *c);
live_trial *arg_trial(call *c);
spar_polar *arg_polar(call *c);
int arg_int(call *c, int lo, int hi);
int arg_flags(call *c, int all);
int arg_limit(call *c, int lo, int hi); /* odd: too low only, as it is a number of things to do */
int64_t arg_count(call *c, int64_t lo, int64_t hi);
int64_t length(int64_t n);
double arg_real(call *c, double lo, double hi);
double *arg_reals(call *c, int64_t n, double lo, double hi);
double *arg_reals_or_null(call *c, int64_t n, double lo, double hi);
double *arg_given(call *c, const double *x, int64_t n); /* a copy, or odd */
float *arg_floats(call *c, int64_t n, double lo, double hi, int may_be_null);
double *arg_rising(call *c, int64_t n, double lo, double hi);
double *arg_quaternions(call *c, int64_t n, int may_be_null);
enum { FUZZ_ENOUGH = 4096 };             /* for what is said of all nodes of any object */
double *arg_motions(call *c, int64_t n); /* [n][7], small */
double *arg_mass(call *c, int64_t n, int may_be_null);
double *arg_stiffness(call *c, int64_t n);
void *arg_out(call *c, int64_t bytes, int may_be_null); /* filled with 0xff */
#define OUT(c, n) ((double *)arg_out(c, (n) * (int64_t)sizeof(double), 0))
#define OUT_OR_NULL(c, n) ((double *)arg_out(c, (n) * (int64_t)sizeof(double), 1))
const char *arg_name(call *c, const char *letter);
const char *arg_path(call *c, const char *ending);
double arg_dt(call *c);
int64_t nodes_of(const live_member *m);
int64_t fluid_count(const live_fluid *f, int which);
/* Numbers of its arrays of triples, as they are laid out. */
int64_t fluid_room(const live_fluid *f, int which);

/* ---- the host's callbacks ---- */

enum { HOST_PLAIN, HOST_FAILS, HOST_CHAOS, HOST_NOTHING, HOST_MODES };
host *arg_host(call *c, spar_fluid_solver *solve, spar_before_step *before);
int fuzz_iterations(spar_session *session, double done, double expected, void *context);
int fuzz_progress(spar_session *session, double done, double expected, void *context);
void fuzz_log(const spar_session *session, int level, const char *message, void *context);

#define FUZZ_DECLARE(name, weight, flags) void do_##name(call *c);
FUZZ_CALLS(FUZZ_DECLARE)
#undef FUZZ_DECLARE

#endif
