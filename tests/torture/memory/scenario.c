#include "scenario.h"

#include "alloc.h"
#include "scene.h"

#include <spar/spar_aero.h>
#include <spar/spar_output.h>
#include <stdio.h>

#ifdef SPARI_HAVE_MPI
#include <spar/spar_mpi.h>
#endif

/* ---- the harness: of each thread ---- */

enum { FUNCTIONS = 256, NODES = 12, MANY = 64 };

static _Thread_local struct {
    int rank, ranks, injecting, complaints;
    const char *folder;
    uint64_t digest;
    const char *called[FUNCTIONS];
    int calls;
    spar_session *session; /* of the act */
} run = {.ranks = 1, .folder = "."};

void scenario_set(int rank, int ranks, const char *folder) {
    run.rank = rank;
    run.ranks = ranks;
    run.folder = folder;
}

void scenario_injecting(int on) {
    run.injecting = on;
}

void scenario_begin(void) {
    run.digest = UINT64_C(1469598103934665603);
    run.complaints = 0;
    run.session = NULL;
}

uint64_t scenario_digest(void) {
    return run.digest;
}

int scenario_complaints(void) {
    return run.complaints;
}

void scenario_complain(const char *what, const char *detail) {
    run.complaints++;
    printf("  rank %d: %s: %s\n", run.rank, what, detail);
    (void)fflush(stdout);
}

int scenario_has_called(const char *function) {
    for (int i = 0; i < run.calls; i++) {
        if (strcmp(run.called[i], function) == 0) {
            return 1;
        }
    }
    return 0;
}

static void called(const char *function) {
    if (!scenario_has_called(function) && run.calls < FUNCTIONS) {
        run.called[run.calls++] = function;
    }
}

static void note(const void *bytes, size_t n) {
    const unsigned char *b = bytes;
    for (size_t i = 0; i < n; i++) {
        run.digest = (run.digest ^ b[i]) * UINT64_C(1099511628211);
    }
}

/* Judges what a call answered; 1: it has been refused as it may be, once, and is to be made again. */
static int again(const char *function, int status, int hit, int attempt) {
    char text[200];
    if (status == SPAR_OK) {
        return 0;
    }
    const char *own = spar_session_message(run.session), *of_thread = spar_session_message(NULL);
    const char *message =
        strncmp(function, "spar_polar", 10) == 0 || strncmp(function, "spar_vtk", 8) == 0 || !run.session ? of_thread
                                                                                                          : own;
    int expected = run.injecting && attempt == 0 && (hit ? status == SPAR_ERR_MEMORY : status == SPAR_ERR_PEER);
    if (!expected) {
        (void)snprintf(text, sizeof text, "answered %d after attempt %d, %s; message: %.120s", status, attempt,
                       hit ? "its allocation failed" : "no allocation failed here", message);
        scenario_complain(function, text);
    } else if (status == SPAR_ERR_MEMORY && !strstr(message, "memory")) {
        (void)snprintf(text, sizeof text, "no word of memory in its message: %.120s", message);
        scenario_complain(function, text);
    }
    return expected;
}

/* A public call that answers a status: where it is refused for want of memory it is made again, and must succeed. */
#define CALL(function, ...)                                                                                            \
    do {                                                                                                               \
        int status_, hit_, attempt_ = 0;                                                                               \
        called(#function);                                                                                             \
        do {                                                                                                           \
            hit_ = alloc_hit();                                                                                        \
            int was_ = alloc_arm(1);                                                                                   \
            status_ = function(__VA_ARGS__);                                                                           \
            (void)alloc_arm(was_);                                                                                     \
        } while (again(#function, status_, alloc_hit() && !hit_, attempt_++));                                         \
    } while (0)

/* One that answers nothing, or a text. */
#define PLAIN(function, ...)                                                                                           \
    do {                                                                                                               \
        called(#function);                                                                                             \
        int was_ = alloc_arm(1);                                                                                       \
        (void)function(__VA_ARGS__);                                                                                   \
        (void)alloc_arm(was_);                                                                                         \
    } while (0)

#define PLAIN_0(function)                                                                                              \
    do {                                                                                                               \
        called(#function);                                                                                             \
        (void)function();                                                                                              \
    } while (0)

#define NOTE(x) note(x, sizeof(x))

/* ---- parts of scenes ---- */

static const double unit_q[4] = {1, 0, 0, 0}, origin[3];

static spar_session *begin_session(void) {
    spar_session *s = NULL;
    run.session = NULL;
#ifdef SPARI_HAVE_MPI
    if (run.ranks > 1) {
        CALL(spar_session_create_fcomm, (int)MPI_Comm_c2f(MPI_COMM_WORLD), &s);
    } else {
        CALL(spar_session_create, &s);
    }
#else
    CALL(spar_session_create, &s);
#endif
    run.session = s;
    return s;
}

static void end_session(spar_session **s) {
    run.session = NULL;
    PLAIN(spar_session_destroy, s);
}

static spar_member *begin_beam(spar_session *s, const char *name, int elements, int nodes, int owner) {
    static const double eta[3] = {0, 0.5, 1}, xyz[9] = {0, 0, 0, 5, 0, 0.1, 10, 0, 0}, twist[3] = {0.1, 0.05, 0};
    double K[2 * 36], M[2 * 36], mu[6] = {1e-3, 1e-3, 1e-3, 1e-3, 2e-3, 3e-3};
    static const double ends[2] = {0, 1};
    spar_member *b = NULL;
    scene_box(K, M);
    scene_box(K + 36, M + 36);
    CALL(spar_beam_create, s, name, elements, nodes, &b);
    CALL(spar_beam_set_axis, b, 3, eta, xyz, twist);
    CALL(spar_beam_set_sections, b, 2, ends, K, M);
    CALL(spar_beam_set_damping, b, mu);
    CALL(spar_member_set_owner, b, owner % run.ranks);
    return b;
}

/* A fluid of loose nodes around a line along x, some on every rank; the last rank of several has none. */
static spar_fluid *begin_fluid(spar_member *m, const char *name, double length, int64_t *n, double x[NODES][3]) {
    spar_fluid *f = NULL;
    *n = run.ranks > 1 && run.rank == run.ranks - 1 ? 0 : NODES;
    for (int i = 0; i < NODES; i++) {
        double angle = 0.7 * i + run.rank, place[3] = {length * i / (NODES - 1), 0.3 * cos(angle), 0.3 * sin(angle)};
        memcpy(x[i], place, sizeof place);
    }
    CALL(spar_fluid_create, m, name, &f);
    CALL(spar_fluid_set_motion_nodes, f, *n, *n ? x[0] : NULL);
    CALL(spar_fluid_set_force_nodes, f, *n, *n ? x[0] : NULL);
    return f;
}

static void note_member(const spar_member *m) {
    double q[7 * MANY], v[6 * MANY], a[6 * MANY], load[6];
    int64_t n = 0;
    CALL(spar_member_get_count, m, &n);
    CALL(spar_member_get_motion, m, q, v, a);
    note(q, (size_t)(7 * n) * sizeof *q);
    note(v, (size_t)(6 * n) * sizeof *v);
    note(a, (size_t)(6 * n) * sizeof *a);
    CALL(spar_member_get_reaction, m, load);
    NOTE(load);
}

typedef struct host {
    spar_session *session;
    spar_member *member[4];
    spar_fluid *fluid[4];
    int members, fluids;
    int64_t n[4];
    double x[4][NODES][3];
    int at;    /* pushes with a theta */
    int steps; /* made since anything was described */
} host;

/* A viscous medium with a load that comes and goes. */
static int solve(spar_session *s, double t, double dt, int iteration, void *context) {
    host *h = context;
    int was = alloc_arm(0);
    double v[NODES][3], f[NODES][3], moment[NODES][3];
    (void)s, (void)iteration;
    for (int k = 0; k < h->fluids; k++) {
        double *at = h->n[k] ? v[0] : NULL, *force = h->n[k] ? f[0] : NULL, *m = h->n[k] ? moment[0] : NULL;
        CALL(spar_fluid_pull_motion, h->fluid[k], 1, NULL, at);
        for (int64_t i = 0; i < h->n[k]; i++) {
            for (int c = 0; c < 3; c++) {
                f[i][c] = -0.5 * v[i][c] + (c == 1 ? 2 * sin(3 * (t + dt)) : 0);
                moment[i][c] = c == 0 ? 0.1 : 0;
            }
        }
        if (h->at) {
            CALL(spar_fluid_push_forces_at, h->fluid[k], 1, force, m);
        } else {
            CALL(spar_fluid_push_forces, h->fluid[k], force, m);
        }
    }
    (void)alloc_arm(was);
    return 0;
}

static int before_step(spar_session *s, double t, double dt, void *context) {
    (void)s, (void)t, (void)dt, (void)context;
    return 0;
}

/* Nothing in a step takes memory, from the third on: the first two may find what predictors and accelerators keep. */
static void expect_none(const host *h, int64_t before) {
    if (h->steps > 2 && !run.injecting && alloc_counted() != before) {
        scenario_complain("a step", "takes memory");
    }
}

static void go(host *h, int steps) {
    for (int i = 0; i < steps; i++) {
        int iterations = 0;
        int64_t before = alloc_counted();
        CALL(spar_step, h->session, 0.02, solve, h, &iterations);
        h->steps++;
        expect_none(h, before);
        note(&iterations, sizeof iterations);
    }
    for (int k = 0; k < h->members; k++) {
        note_member(h->member[k]);
    }
}

static int hear_progress(spar_session *session, double done, double expected, void *context) {
    (void)session, (void)context;
    return expected < done;
}

/* ---- acts ---- */

static void settings(spar_session *s) {
    static const double g[3] = {0, 0, -2};
    static const char *const option[][2] = {{"newton.budget", "5000"},       {"coupling.unconverged", "accept"},
                                            {"coupling.unstable", "accept"}, {"coupling.patience", "100"},
                                            {"coupling.norm", "motion"},     {"coupling.estimate", "on"},
                                            {"coupling.columns", "10"},      {"coupling.reuse", "2"},
                                            {"coupling.filter", "1e-5"},     {"coupling.motion_rtol", "1e-3"}};
    CALL(spar_session_set_gravity, s, g);
    CALL(spar_session_set_integrator, s, 0.8, 1);
    CALL(spar_session_set_newton, s, 1e-10, 1e-9, 30);
    CALL(spar_session_set_predictor, s, 2);
    CALL(spar_session_set_tolerance, s, 1e9, 0);
    CALL(spar_session_set_coupling, s, SPAR_COUPLING_IQN_ILS, 1e-9, 1e-7, 40);
    CALL(spar_session_set_relaxation, s, 0.9);
    if (run.ranks == 1) {
        CALL(spar_session_set_reproducible, s, 1);
        CALL(spar_session_set_threads, s, 3);
    }
    for (size_t i = 0; i < sizeof option / sizeof *option; i++) {
        CALL(spar_session_set_option, s, option[i][0], option[i][1]);
    }
}

/* All that can be said of members, and asked after commit. */
static void act_describe(void) {
    static const double place[3] = {0, 1, 0}, v0[3] = {0.1, 0, 0}, omega[3] = {0, 0, 0.2}, centre[3] = {0.1, 0, 0},
                        J[3] = {1, 2, 3};
    double nodes[4][3] = {{0}}, mass[36], x[3 * MANY], q[4 * MANY], energy[4];
    spar_session *s = begin_session();
    settings(s);
    spar_member *b = begin_beam(s, "beam", 2, 5, 0), *given = begin_beam(s, "given", 1, 4, 1), *body = NULL,
                *point = NULL;
    CALL(spar_beam_set_quadrature, b, SPAR_QUADRATURE_SECTIONS, 4);
    CALL(spar_member_set_placement, b, place, unit_q);
    CALL(spar_member_set_initial_velocity, b, place, v0, omega);
    CALL(spar_member_set_root, b, SPAR_ROOT_FREE);
    CALL(spar_member_set_effects, b, 0, SPAR_EFFECT_DAMPING | SPAR_EFFECT_GYROSCOPIC);
    CALL(spar_member_commit, b);
    for (int i = 0; i < 4; i++) {
        nodes[i][0] = 10.0 * i / 3;
    }
    CALL(spar_beam_set_nodes, given, 4, nodes[0], NULL);
    CALL(spar_member_set_external, given, 1);
    CALL(spar_member_commit, given);
    scene_mass(mass, 3, centre, J);
    CALL(spar_rigid_create, s, "body", place, unit_q, mass, &body);
    CALL(spar_member_commit, body);
    CALL(spar_point_create, s, "point", origin, unit_q, &point);
    CALL(spar_member_commit, point);
    memset(q, 0, sizeof q), memset(x, 0, sizeof x);
    q[3] = 1;
    CALL(spar_member_set_motion, point, q, x, x);
    CALL(spar_member_get_reference, b, x, q);
    note(x, 30 * sizeof *x);
    CALL(spar_member_get_energy, b, 4, energy);
    NOTE(energy);
    note_member(b);
    PLAIN_0(spar_version);
    PLAIN(spar_has, "mpi");
    PLAIN(spar_status_text, 3);
    PLAIN(spar_session_message, s);
    PLAIN(spar_session_get_warning, s, 0);
    PLAIN(spar_log_stderr, s, SPAR_LOG_INFO, "", NULL);
    PLAIN(spar_effect_name, 3);
    end_session(&s);
}

static void quiet(const spar_session *s, int level, const char *text, void *context) {
    (void)s, (void)level, (void)text, (void)context;
}

/* What has been set is read. */
static void read_back(const spar_session *s, const spar_member *b, const spar_fluid *f) {
    double number[32];
    int whole[32];
    int64_t many;
    char word[32];
    CALL(spar_session_get_gravity, s, number + 0);
    CALL(spar_session_get_integrator, s, number + 0, whole + 8);
    CALL(spar_session_get_newton, s, number + 0, number + 8, whole + 16);
    CALL(spar_session_get_predictor, s, whole + 0);
    CALL(spar_session_get_tolerance, s, number + 0, number + 8);
    CALL(spar_session_get_coupling, s, whole + 0, number + 8, number + 16, whole + 24);
    CALL(spar_session_get_relaxation, s, number + 0);
    CALL(spar_session_get_reproducible, s, whole + 0);
    CALL(spar_session_get_threads, s, whole + 0);
    CALL(spar_member_get_placement, b, number + 0, number + 8);
    CALL(spar_member_get_root, b, whole + 0);
    CALL(spar_member_get_external, b, whole + 0);
    CALL(spar_member_get_effects, b, whole + 0);
    CALL(spar_member_get_fidelity, b, whole + 0, &many);
    CALL(spar_member_get_owner, b, whole + 0);
    CALL(spar_beam_get_elements, b, whole + 0, whole + 8);
    CALL(spar_beam_get_quadrature, b, whole + 0, whole + 8);
    CALL(spar_beam_get_damping, b, number + 0);
    CALL(spar_fluid_get_projection, f, whole + 0, number + 8);
    CALL(spar_fluid_get_interpolation, f, whole + 0);
    CALL(spar_fluid_get_option, f, "theta", (int64_t)sizeof word, word);
    CALL(spar_session_get_phase, s, whole + 0);
    PLAIN(spar_member_get_name, b);
    PLAIN(spar_fluid_get_name, f);
    CALL(spar_session_get_option, s, "coupling.columns", (int64_t)sizeof word, word);
}

/* An exact beam with all its loads under the calls of one step, and what a step can be asked. */
static void act_step(void) {
    host h = {.fluids = 1, .members = 1, .at = 1};
    int64_t solved[2];
    double load[6] = {0, 1, 2, 0, 0.1, 0}, along[2][6] = {{0, 0, 1}, {0, 0.5}}, work[3], t, residual[64], size[64],
           report[SPAR_REPORT_COUNT], audit[8], total[6], all[6 * MANY], strain[12], force[12];
    static const double eta[2] = {0.2, 0.9};
    int64_t taken;
    double left, accuracy[4], ground[6] = {1, 2, 3, 4, 5, 6}, tension[12] = {1, 0, 0, 0, 0, 0, 2};
    int64_t step, node;
    int done = 0, iteration;
    spar_member *owner;
    spar_session *whole, *s = h.session = begin_session();
    settings(s);
    CALL(spar_session_set_log, s, quiet, NULL);
    CALL(spar_session_set_progress, s, hear_progress, NULL);
    spar_member *b = h.member[0] = begin_beam(s, "beam", 1, 6, 1);
    CALL(spar_member_set_root, b, SPAR_ROOT_DRIVEN);
    CALL(spar_member_set_effects, b, SPAR_EFFECT_WORK, 0);
    CALL(spar_beam_set_foundation, b, 2, eta, ground);
    CALL(spar_beam_get_foundation, b, &node, 2, NULL, ground);
    CALL(spar_beam_set_pretension, b, 2, eta, tension);
    CALL(spar_beam_get_pretension, b, &node, 2, NULL, tension);
    CALL(spar_beam_get_axis, b, &node, 0, NULL, NULL, NULL);
    CALL(spar_beam_get_sections, b, &node, 0, NULL, NULL, NULL);
    CALL(spar_member_commit, b);
    h.fluid[0] = begin_fluid(b, "air", 10, &h.n[0], h.x[0]);
    CALL(spar_fluid_map, h.fluid[0]);
    CALL(spar_fluid_map_current, h.fluid[0]);
    CALL(spar_member_set_load, b, 5, SPAR_LOAD_DEAD, load);
    CALL(spar_member_set_load, b, 4, SPAR_LOAD_FOLLOWER, load);
    CALL(spar_beam_set_line_load, b, SPAR_LOAD_DEAD, 2, eta, along[0]);
    CALL(spar_beam_set_line_load, b, SPAR_LOAD_FOLLOWER, 2, eta, along[0]);
    CALL(spar_member_get_work, b, 3, work);
    for (int i = 1; i <= 5; i++) {
        double turn = 0.02 * i, q[7] = {0, 0, 0, cos(0.5 * turn), sin(0.5 * turn), 0, 0}, v[6] = {0, 0, 0, 1},
               a[6] = {0};
        CALL(spar_member_drive, b, q, v, a);
        int64_t before = alloc_counted();
        CALL(spar_step_begin, s, 0.02);
        done = 0;
        for (int k = 0; !done && k < 60; k++) {
            CALL(spar_step_solve, s);
            (void)solve(s, 0.02 * i, 0.02, k, &h);
            CALL(spar_step_check, s, &done);
        }
        if (i == 2) {
            CALL(spar_step_reject, s);
        } else {
            CALL(spar_step_accept, s);
        }
        h.steps++;
        expect_none(&h, before);
        note_member(b);
    }
    CALL(spar_session_get_iterations, s, &iteration, (int64_t)(sizeof residual / sizeof *residual), residual, size);
    CALL(spar_session_get_residual, s, residual, size);
    CALL(spar_session_get_report, s, SPAR_REPORT_COUNT, report);
    NOTE(report);
    CALL(spar_session_get_step_control, s, accuracy + 2, accuracy + 3, &iteration, &taken);
    CALL(spar_member_estimate_error, b, accuracy, accuracy + 1);
    CALL(spar_member_get_iterations, b, &taken, &left);
    NOTE(accuracy);
    CALL(spar_session_get_time, s, &t, &step, &iteration);
    CALL(spar_fluid_get_audit, h.fluid[0], 8, audit);
    CALL(spar_fluid_sum_loads, h.fluid[0], NULL, total, total + 3);
    CALL(spar_fluid_check_loads, h.fluid[0], NULL, total, total + 3, 1e-9);
    CALL(spar_fluid_get_travel, h.fluid[0], total, &node);
    read_back(s, b, h.fluid[0]);
    CALL(spar_fluid_get_member, h.fluid[0], &owner);
    CALL(spar_member_get_session, owner, &whole);
    CALL(spar_session_sum, whole, SPAR_OK, 6, load);
    CALL(spar_session_sum_balance, whole, 2, solved, load, NULL);
    CALL(spar_fluid_fail, h.fluid[0], SPAR_ERR_NUMERIC, "between steps nobody waits for it");
    CALL(spar_session_fail, whole, SPAR_ERR_USER, "the message takes no memory");
    NOTE(audit);
    CALL(spar_member_get_loads, b, all);
    note(all, 36 * sizeof *all);
    CALL(spar_member_get_work, b, 3, work);
    NOTE(work);
    CALL(spar_beam_evaluate, b, 2, eta, strain, force, NULL, NULL);
    NOTE(force);
    end_session(&s);
}

/* Members below the exact ones, some driven, with loads that they carry to their root, and the other couplings. */
static void act_fidelities(void) {
    static const struct {
        int kind, modes, root, elements, nodes;
    } what[4] = {{SPAR_FIDELITY_RIGID, 0, SPAR_ROOT_FREE, 2, 3},
                 {SPAR_FIDELITY_LINEAR, 0, SPAR_ROOT_DRIVEN, 2, 4},
                 {SPAR_FIDELITY_MODAL, 4, SPAR_ROOT_FIXED, 1, 5},
                 {SPAR_FIDELITY_PRESCRIBED, 0, SPAR_ROOT_DRIVEN, 1, 3}};
    static const char *const name[4] = {"rigid", "linear", "modal", "prescribed"};
    host h = {.fluids = 4, .members = 4};
    double load[6] = {0, 1, 2, 0, 0.1, 0}, frequency[3], shapes[3 * 6 * MANY], work[3], guess[72] = {0}, body[72] = {0},
           eta[2] = {0, 1};
    int64_t stations;
    int response;
    guess[7] = guess[14] = guess[36 + 7] = 0.1;
    body[0] = body[7] = body[14] = body[36] = body[43] = body[50] = 0.1;
    spar_session *s = h.session = begin_session();
    CALL(spar_session_set_coupling, s, SPAR_COUPLING_AITKEN, 1e-9, 1e-7, 40);
    for (int k = 0; k < 4; k++) {
        spar_member *m = h.member[k] = begin_beam(s, name[k], what[k].elements, what[k].nodes, k);
        CALL(spar_member_set_root, m, what[k].root);
        CALL(spar_member_set_fidelity, m, what[k].kind, what[k].modes);
        CALL(spar_member_set_effects, m, SPAR_EFFECT_WORK, 0);
        CALL(spar_beam_set_pretension, m, 1, eta, load);
        CALL(spar_beam_set_foundation, m, what[k].kind == SPAR_FIDELITY_MODAL, eta, load);
        if (k != 3) {
            CALL(spar_member_set_added_mass, m, 2, eta, guess);
            CALL(spar_member_get_added_mass, m, &stations, 2, NULL, guess);
            CALL(spar_member_set_added_mass_response, m, SPAR_RESPONSE_VELOCITY);
            CALL(spar_member_get_added_mass_response, m, &response);
            CALL(spar_beam_set_mass_damping, m, what[k].root == SPAR_ROOT_FIXED ? 0.1 : 0);
            CALL(spar_beam_get_mass_damping, m, work);
            CALL(spar_beam_set_plane, m, NULL);
            CALL(spar_beam_get_plane, m, work);
            CALL(spar_beam_set_masses, m, 2, eta, body);
            CALL(spar_beam_get_masses, m, &stations, 2, NULL, body);
            CALL(spar_member_learn_added_mass, m, 2, eta);
            CALL(spar_member_get_learned_added_mass, m, NULL, NULL, &stations, 2, NULL, guess);
        }
        CALL(spar_member_commit, m);
        h.fluid[k] = begin_fluid(m, name[k], 10, &h.n[k], h.x[k]);
        CALL(spar_fluid_map, h.fluid[k]);
        if (k != 3) {
            CALL(spar_member_get_work, m, 3, work);
        }
        CALL(spar_member_set_load, m, 1, SPAR_LOAD_DEAD, load);
        if (k == 0) {
            CALL(spar_member_set_load, m, 1, SPAR_LOAD_FOLLOWER, load);
        }
    }
    go(&h, 4);
    CALL(spar_member_solve_modes, h.member[2], 3, frequency, shapes);
    NOTE(frequency);
    if (run.ranks == 1) {
        CALL(spar_member_solve_modes, h.member[0], 2, frequency, shapes);
    }
    end_session(&s);
}

/* A fluid of every kind, and all that can be pulled and pushed. */
static void act_fluids(void) {
    host h = {.fluids = 1, .members = 1};
    double eta[5] = {0, 0.25, 0.5, 0.75, 1}, out[16 * NODES], q[4 * NODES], w[3 * NODES], audit[8];
    float x32[3 * NODES], v32[3 * NODES], q32[4 * NODES];
    int flags[NODES];
    int64_t count, first[NODES];
    spar_fluid *sections = NULL;
    spar_session *s = h.session = begin_session();
    spar_member *b = h.member[0] = begin_beam(s, "beam", 2, 3, 0);
    CALL(spar_member_set_effects, b, SPAR_EFFECT_FLUID_HISTORY, 0);
    CALL(spar_member_commit, b);
    spar_fluid *f = h.fluid[0] = begin_fluid(b, "loose", 10, &h.n[0], h.x[0]);
    int64_t n = h.n[0];
    CALL(spar_fluid_fade_motion, f, 0.1, 2, n, NULL, NULL);
    CALL(spar_fluid_get_motion_weights, f, out);
    CALL(spar_fluid_set_motion_weights, f, n, n > 0 ? out : NULL);
    CALL(spar_fluid_set_projection, f, SPAR_PROJECT_RPOLY, 1.0);
    CALL(spar_fluid_set_interpolation, f, SPAR_INTERPOLATE_CONSISTENT);
    CALL(spar_fluid_set_option, f, "theta", "group");
    CALL(spar_fluid_map, f);
    CALL(spar_fluid_create, b, "sections", &sections);
    CALL(spar_fluid_set_stations, sections, 5, eta, NULL);
    CALL(spar_fluid_map, sections);
    CALL(spar_fluid_set_motion_stations, sections, 5, eta, NULL);
    CALL(spar_fluid_map, sections);
    CALL(spar_fluid_get_kind, sections, SPAR_NODES_FORCE, flags);
    CALL(spar_fluid_set_layout, sections, SPAR_NODES_FORCE, 3, 1);
    CALL(spar_fluid_get_layout, sections, SPAR_NODES_FORCE, &count, NULL);
    CALL(spar_fluid_get_count, f, SPAR_NODES_FORCE, &count);
    CALL(spar_fluid_get_flag_count, f, SPAR_NODES_FORCE, SPAR_MAP_END, &count);
    CALL(spar_fluid_get_map, f, SPAR_NODES_MOTION, out, w, flags);
    CALL(spar_fluid_get_nearest, f, SPAR_NODES_MOTION, out, q, w);
    if (n > 0) {
        CALL(spar_fluid_get_basis, sections, SPAR_NODES_FORCE, first, out);
    }
    go(&h, 1);
    CALL(spar_fluid_pull_poses, sections, SPAR_NODES_MOTION, 1, NULL, q, NULL, w, NULL, NULL);
    CALL(spar_fluid_pull_poses, sections, SPAR_NODES_MOTION, 0.5, NULL, q, NULL, w, out, NULL);
    CALL(spar_fluid_pull_poses, sections, SPAR_NODES_FORCE, 0.5, out, q, w, NULL, NULL, NULL);
    CALL(spar_fluid_get_positions, sections, SPAR_NODES_FORCE, out, q, w, NULL);
    CALL(spar_fluid_get_forces, sections, w);
    CALL(spar_fluid_set_states, sections, 2);
    CALL(spar_fluid_get_states, sections, &count, NULL);
    CALL(spar_fluid_pull_states, sections, 2, out);
    CALL(spar_fluid_pull_poses, sections, SPAR_NODES_MOTION, 1, out, q, w, w, w, w);
    CALL(spar_fluid_pull_matrices, sections, 1, SPAR_MATRIX_LOCAL_TO_GLOBAL, out);
    CALL(spar_fluid_check_matrices, sections, SPAR_MATRIX_LOCAL_TO_GLOBAL, out);
    CALL(spar_fluid_pull_motion_f32, f, 1, n ? x32 : NULL, n ? v32 : NULL);
    CALL(spar_fluid_pull_poses_f32, sections, SPAR_NODES_MOTION, 1, NULL, q32, NULL, x32, v32, NULL);
    for (int i = 0; i < 3 * NODES; i++) {
        w[i] = 0.01 * i;
        x32[i] = 0.25F * (float)i;
    }
    CALL(spar_step_begin, s, 0.02);
    CALL(spar_step_solve, s);
    CALL(spar_fluid_push_states, sections, 2, out);
    (void)solve(s, 0, 0.02, 0, &h);
    CALL(spar_fluid_push_forces, sections, w, NULL);
    CALL(spar_fluid_push_forces_f32, sections, x32, NULL);
    CALL(spar_fluid_pull_forces, f, 1, n ? out : NULL);
    note(out, (size_t)(3 * n) * sizeof *out);
    CALL(spar_fluid_pull_forces_f32, f, 1, n ? x32 : NULL);
    CALL(spar_fluid_get_audit, sections, 8, audit);
    CALL(spar_step_reject, s);
    go(&h, 2);
    CALL(spar_fluid_set_stations, sections, 3, eta, NULL); /* mapped again */
    CALL(spar_fluid_map, sections);
    h.steps = 0;
    go(&h, 1);
    PLAIN(spar_fluid_destroy, &sections);
    go(&h, 1);
    end_session(&s);
}

/* Statics, modes and the damping from them. */
static void act_static(void) {
    double load[6] = {0, 0, 5}, frequency[4], mu[6], shapes[4 * 6 * 9];
    static const int64_t mode[2] = {0, 1};
    static const double ratio[2] = {0.005, 0.006}, g[3] = {0, 0, -1}, still[6];
    spar_session *s = begin_session();
    CALL(spar_session_set_gravity, s, g);
    for (int k = 0; k < 2; k++) {
        spar_member *b = begin_beam(s, k ? "two" : "one", k + 1, 4, k);
        CALL(spar_member_set_root, b, k ? SPAR_ROOT_DRIVEN : SPAR_ROOT_FIXED);
        CALL(spar_member_commit, b);
        CALL(spar_beam_set_modal_damping, b, mode, ratio, mu);
        NOTE(mu);
        CALL(spar_beam_fit_damping, b, 2, mode, ratio, mu);
        NOTE(mu);
        CALL(spar_member_set_load, b, 3, SPAR_LOAD_DEAD, load);
        if (k == 1) {
            double turned[7] = {0, 0, 0, 1}, rate[6] = {0, 0, 0, 0.5};
            CALL(spar_member_drive, b, turned, rate, still);
        }
        CALL(spar_member_solve_static, b, 2);
        note_member(b);
        CALL(spar_member_solve_modes, b, 4, frequency, shapes);
        NOTE(frequency);
        double eigenvalue[3][2], frame[3], shift[2] = {0, 2};
        CALL(spar_member_solve_eigenvalues, b, 3, shift, &eigenvalue[0][0], NULL, frame);
        NOTE(eigenvalue);
    }
    end_session(&s);
}

static void describe_saved(host *h) {
    double load[6] = {0, 1, 2, 0, 0.1, 0}, along[2][6] = {{0, 0, 1}, {0, 0.5}};
    static const double eta[2] = {0.2, 0.9};
    spar_session *s = h->session = begin_session();
    h->members = h->fluids = 2;
    CALL(spar_session_set_coupling, s, SPAR_COUPLING_IQN_ILS, 1e-9, 1e-6, 40);
    for (int k = 0; k < 2; k++) {
        spar_member *b = h->member[k] = begin_beam(s, k ? "modal" : "exact", 1 + k, 4, k);
        if (k == 1) {
            CALL(spar_member_set_fidelity, b, SPAR_FIDELITY_MODAL, 3);
        }
        CALL(spar_member_set_root, b, SPAR_ROOT_FIXED);
        CALL(spar_member_commit, b);
        h->fluid[k] = begin_fluid(b, k ? "m" : "e", 10, &h->n[k], h->x[k]);
        CALL(spar_fluid_map, h->fluid[k]);
        CALL(spar_member_set_load, b, 2, SPAR_LOAD_FOLLOWER, load);
        CALL(spar_beam_set_line_load, b, SPAR_LOAD_FOLLOWER, 2, eta, along[0]);
    }
}

/* With the fluid: before the first step and after it, of each scheme. */
static void act_equilibrium(void) {
    for (int scheme = SPAR_COUPLING_EXPLICIT; scheme <= SPAR_COUPLING_IQN_ILS; scheme++) {
        host h = {0};
        spar_session *s = h.session = begin_session();
        h.members = h.fluids = 2;
        CALL(spar_session_set_coupling, s, scheme, 1e-8, 1e-4, 40);
        for (int k = 0; k < 2; k++) {
            spar_member *b = h.member[k] = begin_beam(s, k ? "linear" : "exact", 1, 3, k);
            if (k == 1) {
                CALL(spar_member_set_fidelity, b, SPAR_FIDELITY_LINEAR, 0);
            }
            CALL(spar_member_commit, b);
            h.fluid[k] = begin_fluid(b, k ? "m" : "e", 10, &h.n[k], h.x[k]);
            CALL(spar_fluid_map, h.fluid[k]);
        }
        int calls = 0;
        CALL(spar_session_solve_initial, s, 0.02, solve, &h, &calls);
        note(&calls, sizeof calls);
        CALL(spar_step_begin_initial, s, 0.02);
        CALL(spar_step_solve, s);
        CALL(spar_step_reject, s);
        for (int k = 0; k < 2; k++) {
            int iterations = 0;
            CALL(spar_session_solve_static, s, 2, solve, &h, &iterations);
            note(&iterations, sizeof iterations);
            go(&h, 1);
        }
        end_session(&h.session);
    }
}

/* Two bodies on a hinge, a spring and a line; redundant holds in the loop they make. */
static void act_joints(void) {
    const double here[3] = {0, 0, 0}, there[3] = {0.5, 0, 0}, load[6] = {0, 0, 1, 0, 0, 0}, none[6] = {0};
    double stiffness[36] = {0}, x[6];
    host h = {0};
    if (run.ranks > 1) { /* not there yet */
        return;
    }
    spar_session *s = h.session = begin_session();
    spar_member *b[2];
    spar_joint *hinge = NULL, *spring = NULL, *line = NULL;
    stiffness[0] = stiffness[7] = stiffness[14] = 100;
    for (int k = 0; k < 2; k++) {
        b[k] = begin_beam(s, k ? "second" : "first", 1, 3, k);
        CALL(spar_member_set_root, b[k], k ? SPAR_ROOT_FREE : SPAR_ROOT_FIXED);
        CALL(spar_member_set_effects, b[k], SPAR_EFFECT_WORK, 0);
        CALL(spar_member_commit, b[k]);
    }
    CALL(spar_joint_create, s, "hinge", b[1], 0, b[0], 2, SPAR_FREE_RY, &hinge);
    CALL(spar_joint_set_frame, hinge, there, NULL);
    CALL(spar_joint_set_driven, hinge, SPAR_FREE_RY);
    CALL(spar_joint_create, s, "spring", b[1], 2, NULL, 0, 7, &spring);
    CALL(spar_joint_set_frame, spring, there, NULL);
    CALL(spar_joint_set_spring, spring, stiffness, NULL, NULL);
    CALL(spar_spring_create, s, "tie", b[0], 2, SPAR_FREE_X | SPAR_FREE_Y | SPAR_FREE_Z, stiffness, NULL, NULL, NULL);
    CALL(spar_link_create, s, "line", b[1], 1, there, NULL, 0, here, &line);
    CALL(spar_link_set_spring, line, 100, 1, 0.5, 1);
    CALL(spar_joint_set_load, spring, load);
    CALL(spar_member_solve_static, b[1], 2);
    for (int k = 0; k < 2; k++) {
        CALL(spar_joint_drive, hinge, none, NULL, NULL);
        CALL(spar_step, s, 1e-3, NULL, NULL, NULL);
        CALL(spar_joint_get_motion, hinge, x, NULL, NULL);
        note(x, sizeof x);
        CALL(spar_joint_get_load, hinge, x);
        note(x, sizeof x);
        CALL(spar_joint_get_energy, hinge, SPAR_JOINT_ENERGY_COUNT, x);
    }
    end_session(&h.session);
}

static void act_save(void) {
    char path[400];
    host h = {0}, other = {0};
    (void)snprintf(path, sizeof path, "%s/state", run.folder);
    describe_saved(&h);
    go(&h, 2);
    CALL(spar_session_save, h.session, path);
    go(&h, 1);
    end_session(&h.session);
    describe_saved(&other);
    CALL(spar_session_load, other.session, path);
    go(&other, 1);
    end_session(&other.session);
}

static void act_output(void) {
    char path[400];
    host h = {0};
    describe_saved(&h);
    go(&h, 1);
    for (int k = 0; k < 2; k++) {
        (void)snprintf(path, sizeof path, "%s/member%d_%d.vtp", run.folder, k, run.rank);
        CALL(spar_member_write_vtk, h.member[k], path);
        (void)snprintf(path, sizeof path, "%s/fluid%d_%d.vtu", run.folder, k, run.rank);
        CALL(spar_fluid_write_vtk, h.fluid[k], path);
        (void)snprintf(path, sizeof path, "%s/series_%d.pvd", run.folder, run.rank);
        CALL(spar_vtk_series_add, path, 0.1 * k, k, "member.vtp");
    }
    const double diameter = 0.1;
    double property[SPAR_SECTION_COUNT], K[36], M[36];
    char text[1000];
    int findings;
    CALL(spar_section_from_shape, SPAR_SHAPE_CIRCLE, 1, &diameter, 2e11, 0.3, 7850, SPAR_SECTION_COUNT, property);
    CALL(spar_section_build, SPAR_SECTION_COUNT, property, K, M);
    CALL(spar_section_transform, K, 0.1, 0, 0, K);
    CALL(spar_section_describe, K, M, SPAR_SECTION_COUNT, property, &findings);
    CALL(spar_section_report, K, M, (int64_t)sizeof text, text);
    NOTE(property);
    end_session(&h.session);
}

/* Two members, one of them below the exact ones; loads along the line; fluids of both kinds. */
static void describe_trial(host *h) {
    double load[6] = {0, 1, 2};
    spar_session *s = h->session = begin_session();
    h->members = h->fluids = 2;
    CALL(spar_session_set_coupling, s, SPAR_COUPLING_IQN_ILS, 1e-8, 1e-4, 40);
    for (int k = 0; k < 2; k++) {
        spar_member *b = h->member[k] = begin_beam(s, k ? "rigid" : "exact", 1, 3, k);
        if (k == 1) {
            CALL(spar_member_set_fidelity, b, SPAR_FIDELITY_RIGID, 0);
        }
        CALL(spar_member_set_root, b, SPAR_ROOT_PINNED);
        CALL(spar_member_commit, b);
        h->fluid[k] = begin_fluid(b, k ? "m" : "e", 10, &h->n[k], h->x[k]);
        CALL(spar_fluid_map, h->fluid[k]);
        CALL(spar_member_set_load, b, 2, SPAR_LOAD_FOLLOWER, load);
    }
}

/* A trial of the host, with steps and callbacks. */
static spar_trial *begin_trial(host *of, double dt, int64_t steps, spar_fluid_solver fluid) {
    spar_trial *trial = NULL;
    CALL(spar_trial_create, of->session, &trial);
    CALL(spar_trial_set_steps, trial, dt, steps);
    CALL(spar_trial_set_callbacks, trial, before_step, of, fluid, of);
    return trial;
}

static void act_try(void) {
    host h = {0};
    double error[3], seconds;
    int64_t evaluations;
    describe_trial(&h);
    go(&h, 1);
    spar_trial *trial = begin_trial(&h, 0.02, 8, solve);
    for (int compare = 0; compare < 2; compare++) {
        CALL(spar_trial_run, trial, compare);
        CALL(spar_trial_get_errors, trial, error, error + 1, error + 2);
        CALL(spar_trial_get_cost, trial, &seconds, &evaluations);
        note(error, sizeof error);
    }
    spar_session *of = NULL;
    int64_t steps;
    CALL(spar_trial_get_session, trial, &of);
    CALL(spar_trial_get_steps, trial, &seconds, &steps);
    PLAIN(spar_trial_destroy, &trial);
    double next = 0.02, taken;
    CALL(spar_session_set_tolerance, h.session, 1, 0.1);
    CALL(spar_step_adaptive, h.session, &next, before_step, solve, &h, &taken);
    note(&next, sizeof next);
    CALL(spar_session_set_tolerance, h.session, 0, 0);
    go(&h, 1);
    end_session(&h.session);
}

/* A viscous medium that lags behind. */
static int solve_flutter(spar_session *s, double t, double dt, int iteration, void *context) {
    host *h = context;
    int was = alloc_arm(0);
    double v[NODES][3], y[NODES][3];
    (void)s, (void)t, (void)dt, (void)iteration;
    CALL(spar_fluid_pull_motion, h->fluid[0], 1, NULL, h->n[0] ? v[0] : NULL);
    int64_t width = 0;
    memset(y, 0, sizeof y);
    CALL(spar_fluid_get_states, h->fluid[0], &width, NULL);
    CALL(spar_fluid_pull_states, h->fluid[0], width, h->n[0] ? y[0] : NULL);
    for (int64_t i = 0; i < h->n[0]; i++) {
        for (int c = 0; c < 3; c++) {
            y[i][c] = 0.5 * y[i][c] - 0.2 * v[i][c];
        }
    }
    CALL(spar_fluid_push_states, h->fluid[0], width, h->n[0] ? y[0] : NULL);
    CALL(spar_fluid_push_forces, h->fluid[0], h->n[0] ? y[0] : NULL, NULL);
    (void)alloc_arm(was);
    return 0;
}

static void act_flutter(void) {
    host h = {0};
    spar_session *s = begin_session();
    h.session = s;
    double value[2][2], shift[2] = {0, 1}, frame[3];
    spar_member *b = begin_beam(s, "wing", 1, 3, 0);
    CALL(spar_member_set_root, b, SPAR_ROOT_FIXED);
    CALL(spar_member_commit, b);
    h.fluid[0] = begin_fluid(b, "air", 10, &h.n[0], h.x[0]);
    CALL(spar_fluid_map, h.fluid[0]);
    spar_trial *trial = begin_trial(&h, 0.02, 8, solve_flutter);
    for (int64_t memory = 0; memory < 7; memory += 6) {
        CALL(spar_fluid_set_states, h.fluid[0], memory > 0 ? 3 : 0);
        CALL(spar_trial_set_motion, trial, 3, 0, memory);
        CALL(spar_trial_solve_eigenvalues, trial, 2, shift, &value[0][0], 0, NULL, frame);
        note(value, sizeof value);
    }
    int64_t modes, memory;
    double amplitude;
    CALL(spar_trial_set_motion, trial, 2, 0, 0);
    CALL(spar_trial_get_motion, trial, &modes, &amplitude, &memory);
    CALL(spar_trial_solve_floquet, trial, 2, &value[0][0]);
    note(value, sizeof value);
    end_session(&h.session);
}

static void act_effects(void) {
    host h = {0};
    int in_force, fails;
    double x[4];
    describe_trial(&h);
    spar_trial *trial = begin_trial(&h, 0.02, 8, solve);
    CALL(spar_trial_set_progress, trial, hear_progress, NULL);
    CALL(spar_trial_report_effects, trial);
    CALL(spar_trial_get_effect, trial, SPAR_ROW_INERTIA, &in_force, &fails, x, x + 1, x + 2, x + 3);
    note(x, 3 * sizeof *x);
    go(&h, 1);
    end_session(&h.session);
}

static void act_advise(void) {
    host h = {0};
    double dt, x[4];
    int fidelity, elements, nodes, points, goals, substeps, scheme, predictor, fails;
    int64_t modes, runs;
    char text[32];
    describe_trial(&h);
    spar_trial *trial = begin_trial(&h, 0.01, 8, solve);
    CALL(spar_trial_set_option, trial, "dt", "keep");
    CALL(spar_trial_set_option, trial, "coupling", "keep");
    CALL(spar_trial_get_option, trial, "coupling", sizeof text, text);
    CALL(spar_trial_set_goals, trial, SPAR_GOAL_MOTION | SPAR_GOAL_SECTION | SPAR_GOAL_NUMBERS);
    CALL(spar_trial_get_goals, trial, &goals);
    CALL(spar_trial_push_numbers, trial, 1, (const double[]){1});
    CALL(spar_trial_set_progress, trial, hear_progress, NULL);
    CALL(spar_trial_advise, trial, 0.5, 0.08);
    CALL(spar_trial_get_beam, trial, h.member[0], &fidelity, &modes, &elements, &nodes, &points);
    CALL(spar_trial_get_settings, trial, &dt, &substeps, &scheme, x, &predictor, x + 1);
    CALL(spar_trial_get_outcome, trial, x, x + 1, &fails, x + 2);
    CALL(spar_trial_get_search, trial, &runs, x);
    go(&h, 1);
    CALL(spar_trial_apply, trial, &dt);
    go(&h, 1);
    end_session(&h.session);
}

static void act_beamdyn(void) {
    static const char *const file[2][2] = {
        {SPAR_SOURCE_DIR "/tests/data/bend_primary.inp", NULL},
        {SPAR_SOURCE_DIR "/tests/data/blade_primary.inp", SPAR_SOURCE_DIR "/tests/data/blade_blade.inp"}};
    spar_session *s = begin_session();
    for (int k = 0; k < 2; k++) {
        spar_member *b = NULL;
        double q[4 * MANY], x[3 * MANY];
        CALL(spar_beam_create, s, k ? "blade" : "bend", k + 1, 5, &b);
        CALL(spar_beam_read_beamdyn, b, file[k][0], file[k][1]);
        CALL(spar_member_commit, b);
        CALL(spar_member_get_reference, b, x, q);
        note(x, 15 * sizeof *x);
    }
    end_session(&s);
}

typedef struct wind {
    spar_aero *aero;
    double inflow[5][3];
} wind;

static int blow(spar_session *s, double t, double dt, int iteration, void *context) {
    wind *w = context;
    int was = alloc_arm(0);
    (void)s, (void)t, (void)dt, (void)iteration;
    CALL(spar_aero_solve, w->aero, 1.225, w->inflow[0], 1);
    (void)alloc_arm(was);
    return 0;
}

/* One blade of a rotor, by blade elements; the fluid lives on rank 0. */
static void act_aero(void) {
    enum { N = 5 };
    static const double pi = 3.14159265358979323846, hub[3], axis[3] = {0, 1, 0}, ground[3] = {0, 9, -90},
                        up[3] = {0, 0, 1};
    double alpha[7], cl[7], cd[7], cm[7], eta[N], a[N], b[N], c[N], force[3 * N], thrust, torque, power;
    int flags[N];
    int64_t none, rows;
    int here = run.rank == 0;
    wind w = {0};
    spar_polar *polar = NULL;
    spar_fluid *f = NULL;
    spar_session *s = begin_session();
    spar_member *blade = begin_beam(s, "blade", 1, 4, 0);
    CALL(spar_member_commit, blade);
    CALL(spar_fluid_create, blade, "air", &f);
    for (int i = 0; i < N; i++) {
        eta[i] = 0.05 + 0.9 * i / (N - 1);
        w.inflow[i][1] = 10;
    }
    for (int i = 0; i < 7; i++) {
        alpha[i] = -pi + i * pi / 3;
        cl[i] = i == 6 ? sin(2 * alpha[0]) : sin(2 * alpha[i]), cd[i] = 0.02, cm[i] = -0.01;
    }
    CALL(spar_fluid_set_stations, f, here ? N : 0, here ? eta : NULL, NULL);
    CALL(spar_fluid_map, f);
    if (here) {
        CALL(spar_polar_create, 7, alpha, cl, cd, cm, &polar);
        CALL(spar_polar_set_interpolation, polar, SPAR_POLAR_CUBIC);
        CALL(spar_polar_set_interpolation, polar, SPAR_POLAR_AKIMA);
        CALL(spar_polar_evaluate, polar, 0.1, a, b, c);
        CALL(spar_aero_create, 1, &f, &w.aero);
        for (int i = 0; i < N; i++) {
            CALL(spar_aero_set_section, w.aero, i, 0.2, 0.1, polar);
        }
        CALL(spar_aero_set_rotor, w.aero, hub, axis, 0.5, 11);
        CALL(spar_aero_set_turn, w.aero, 1);
        CALL(spar_aero_set_blades, w.aero, 3);
        CALL(spar_aero_set_shear, w.aero, SPAR_SHEAR_POWER, ground, up, 90, 0.2);
        CALL(spar_aero_set_tower, w.aero, ground, hub, 3, 2);
        CALL(spar_aero_set_effects, w.aero, 2 * SPAR_AERO_UNSTEADY - 1);
        CALL(spar_aero_solve, w.aero, 1.225, w.inflow[0], 1);
        CALL(spar_aero_get_rotor, w.aero, &thrust, &torque, &power);
        note(&thrust, sizeof thrust);
        CALL(spar_aero_get_sections, w.aero, a, b, c, NULL, NULL);
        NOTE(a);
        CALL(spar_aero_get_flags, w.aero, flags, &none);
        CALL(spar_aero_get_chord, w.aero, a, b);
        CALL(spar_aero_get_polar, w.aero, 0, &rows, 1, a, b, NULL, NULL, NULL);
        CALL(spar_aero_get_loads, w.aero, NULL, force, NULL);
        NOTE(force);
        PLAIN(spar_aero_effect_name, 0);
        if (run.ranks == 1) {
            spar_trial *trial = NULL;
            int in_force, fails;
            CALL(spar_trial_create, s, &trial);
            CALL(spar_trial_set_steps, trial, 0.01, 8);
            CALL(spar_trial_set_callbacks, trial, NULL, NULL, blow, &w);
            CALL(spar_aero_report_effects, w.aero, trial);
            CALL(spar_aero_get_effect, w.aero, SPAR_AERO_ROW_DRAG, &in_force, &fails, a, a + 1, a + 2, a + 3);
            CALL(spar_step, s, 0.01, blow, &w, NULL);
            note_member(blade);
        }
        PLAIN(spar_aero_destroy, &w.aero);
        PLAIN(spar_polar_destroy, &polar);
    }
    end_session(&s);
}

/* A blade by AeroDyn's files, at its stations and between them. */
static void act_aerodyn(void) {
    static const char primary[] = SPAR_SOURCE_DIR "/tests/data/aerodyn/primary.dat";
    static const double q[4] = {0.8, -0.6, 0, 0}, span[3] = {5, 12, 33};
    spar_session *s = begin_session();
    spar_member *blade = begin_beam(s, "blade", 1, 4, 0);
    CALL(spar_member_commit, blade);
    for (int k = 0; k < 2 && run.rank == 0; k++) {
        spar_fluid *f = NULL;
        spar_aero *aero = NULL;
        double x[3 * 19] = {0}, arm[3 * 19] = {0};
        CALL(spar_fluid_create, blade, k ? "fine" : "stations", &f);
        CALL(spar_fluid_read_aerodyn, f, primary, NULL, k ? q : NULL, k ? 3 : 0, k ? span : NULL);
        CALL(spar_fluid_map, f);
        CALL(spar_fluid_get_nearest, f, SPAR_NODES_MOTION, x, NULL, arm);
        NOTE(arm);
        CALL(spar_aero_create, 1, &f, &aero);
        CALL(spar_aero_read_aerodyn, aero, primary, NULL, k ? q : NULL, k ? span : NULL);
        PLAIN(spar_aero_destroy, &aero);
    }
    end_session(&s);
}

const act acts[] = {{"describe", act_describe, 1},     {"step", act_step, 1},
                    {"fidelities", act_fidelities, 1}, {"fluids", act_fluids, 1},
                    {"static", act_static, 1},         {"save", act_save, 1},
                    {"output", act_output, 1},         {"try", act_try, 1},
                    {"effects", act_effects, 1},       {"beamdyn", act_beamdyn, 1},
                    {"aerodyn", act_aerodyn, 1},       {"aero", act_aero, 1},
                    {"advise", act_advise, 0},         {"equilibrium", act_equilibrium, 1},
                    {"joints", act_joints, 1},         {"flutter", act_flutter, 1}};
const int act_count = (int)(sizeof acts / sizeof *acts);
