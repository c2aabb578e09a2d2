/* Ranks that disagree. Every collective call of the library, with every argument and setting unequal on one rank, with
   another call on one rank, from the callback of one rank, with every allocation failing on one rank, each rank in
   turn: all ranks answer what they should, nobody waits (a case of more than LIMIT seconds ends the program), and the
   next steps have the bits of a session beside it to which nothing has happened.

       mpiexec -np 2 ranks [seconds] [seed] [all|binned] [call]

   The short form takes a part of the cases, chosen by the seed, until the seconds are over; without seconds all of them
   are taken. binned: with reproducible sums, and advice that varies the nodes, so that the sums go over to other nodes.
   call: of the collective ones this alone. Library and tests are linked with --wrap=malloc,calloc,realloc, which is how
   an allocation fails here. */
#include "scene.h"

#include "torture/calls.h"

#include <mpi.h>
#include <signal.h>
#include <spar/spar_aero.h>
#include <spar/spar_mpi.h>
#include <stdio.h>
#include <time.h>
#include <unistd.h>

enum { LIMIT = 20, NODES = 4, STATE = 25 * NODES + 25 + 18 + 2, FAILURES = 20 };

static const double dt = 0.02;
static int rank, size; /* rank 0 has the fluid's nodes */
static int binned;
static const char *asked;             /* the call under test; NULL: all */
static char name[256];                /* of the case, for who has to look for it */
static char saved[64], elsewhere[64]; /* files: of all ranks, and never written */

/* ---- allocations ---- */

void *__real_malloc(size_t n);
void *__real_calloc(size_t n, size_t size);
void *__real_realloc(void *p, size_t n);
void *__wrap_malloc(size_t n);
void *__wrap_calloc(size_t n, size_t bytes);
void *__wrap_realloc(void *p, size_t n);

static long fails_at, allocations; /* 0: none fails */

static int fails(void) {
    return ++allocations == fails_at;
}

void *__wrap_malloc(size_t n) {
    return fails() ? NULL : __real_malloc(n);
}

void *__wrap_calloc(size_t n, size_t bytes) {
    return fails() ? NULL : __real_calloc(n, bytes);
}

void *__wrap_realloc(void *p, size_t n) {
    return fails() ? NULL : __real_realloc(p, n);
}

/* ---- the scene ---- */

typedef struct scene {
    spar_session *session;
    spar_trial *trial;
    spar_member *beam, *body;
    spar_joint *rope; /* between them, on a spring: one of the ranks moves its member to the other */
    spar_fluid *fluid;
    spar_aero *aero;
    double beginning[3]; /* where the body was at t^n; unused but by the fluid */
    int answer;          /* of that call */
    int inner;           /* this rank makes this call from its fluid solver, or, less 100, from before a step */
    int nan_at, user_at, calls;
} scene;

static void must(int status, const char *what, const spar_session *s) {
    if (status != SPAR_OK) {
        fprintf(stderr, "rank %d: %s: %s: %d: %s\n", rank, name, what, status, spar_session_message(s));
        MPI_Abort(MPI_COMM_WORLD, 2);
    }
}
#define MUST(s, call) must(call, #call, s)

static void describe(scene *c) {
    static const double q[4] = {1, 0, 0, 0}, where[3] = {0, 5, 0}, centre[3] = {0.1, 0, 0}, J[3] = {1, 2, 3};
    double K[36], M[36], mass[36], gravity[3] = {0, 0, -2};
    spar_session *s = c->session;
    scene_box(K, M);
    MUST(s, spar_session_set_gravity(s, gravity));
    MUST(s, spar_session_set_coupling(s, SPAR_COUPLING_IQN_ILS, 0, 1e-8, 60));
    MUST(s, spar_session_set_reproducible(s, binned));
    MUST(s, spar_trial_create(s, &c->trial));
    MUST(s, spar_trial_set_option(c->trial, "nodes", binned ? "vary" : "keep"));
    MUST(s, spar_trial_set_option(c->trial, "coupling", "keep"));
    MUST(s, spar_trial_set_motion(c->trial, 1, 0, 0));
    c->beam = scene_beam(s, "beam", 1, NODES, 10, K, M);
    scene_mass(mass, 3, centre, J);
    MUST(s, spar_rigid_create(s, "body", where, q, mass, &c->body));
    MUST(s, spar_member_set_root(c->body, SPAR_ROOT_FIXED)); /* or a static solution would have nothing to find */
}

static void ready(scene *c) {
    static const double tip[3] = {10, 0, 0};
    spar_session *s = c->session;
    MUST(s, spar_member_commit(c->beam));
    MUST(s, spar_member_commit(c->body));
    MUST(s, spar_link_create(s, "rope", c->beam, NODES - 1, tip, c->body, 0, (double[]){0, 5, 0}, &c->rope));
    MUST(s, spar_link_set_spring(c->rope, 2, 0.1, 9, 0));
    MUST(s, spar_fluid_create(c->beam, "tip", &c->fluid));
    MUST(s, spar_fluid_set_motion_nodes(c->fluid, rank == 0, rank == 0 ? tip : NULL));
    MUST(s, spar_fluid_set_force_nodes(c->fluid, rank == 0, rank == 0 ? tip : NULL));
    MUST(s, spar_fluid_map(c->fluid));
    MUST(s, spar_aero_create(0, NULL, &c->aero));
}

static void begin(scene *c) {
    memset(c, 0, sizeof *c);
    MUST(NULL, spar_session_create_mpi(MPI_COMM_WORLD, &c->session));
    describe(c);
}

static void end(scene *c) {
    spar_aero_destroy(&c->aero);
    spar_session_destroy(&c->session);
}

static int inner_call(scene *c);

/* A viscous medium at the tip with a load that comes and goes. */
static int solve(spar_session *s, double t, double step, int iteration, void *context) {
    scene *c = context;
    double v[3] = {0}, force[3];
    (void)iteration;
    c->calls++;
    if (c->inner > 0 && c->inner < 100) {
        c->answer = inner_call(c);
    }
    if (c->calls == c->user_at) {
        return 77;
    }
    if (spar_fluid_pull_motion(c->fluid, 1, NULL, rank == 0 ? v : NULL) != SPAR_OK) {
        return 1;
    }
    for (int k = 0; k < 3; k++) {
        force[k] = -0.5 * v[k] + (k == 1 ? sin(3 * (t + step)) : 0);
    }
    force[0] = c->calls == c->nan_at ? NAN : force[0];
    (void)spar_fluid_push_forces(c->fluid, rank == 0 ? force : NULL, NULL);
    (void)s;
    return 0;
}

static int before(spar_session *s, double t, double step, void *context) {
    scene *c = context;
    (void)s, (void)t, (void)step;
    c->answer = c->inner > 100 ? inner_call(c) : c->answer;
    return 0;
}

static void look(const scene *c, double *out) {
    int64_t steps = 0;
    memset(out, 0, STATE * sizeof *out);
    MUST(c->session, spar_member_get_motion(c->beam, out, out + 7 * NODES, out + 13 * NODES));
    MUST(c->session, spar_member_get_loads(c->beam, out + 19 * NODES));
    out += 25 * NODES;
    MUST(c->session, spar_member_get_motion(c->body, out, out + 7, out + 13));
    MUST(c->session, spar_member_get_loads(c->body, out + 19));
    MUST(c->session, spar_joint_get_motion(c->rope, out + 25, out + 31, NULL));
    MUST(c->session, spar_joint_get_load(c->rope, out + 37));
    MUST(c->session, spar_session_get_time(c->session, out + 43, &steps, NULL));
    out[44] = (double)steps;
}

/* ---- the collective calls ---- */

typedef struct arguments {
    double dt, tolerance, length, ratio[2], point[3];
    int64_t steps, mode[2];
    int load_steps, compare, no_out, no_modes, goals;
    const char *path, *limit;
    spar_before_step before;
    spar_fluid_solver solve;
} arguments;

static arguments good(void) {
    return (arguments){.dt = dt,
                       .tolerance = 0.3,
                       .length = 8 * dt,
                       .ratio = {0.01, 0.02},
                       .steps = 8,
                       .mode = {0, 1},
                       .load_steps = 1,
                       .goals = SPAR_GOAL_MOTION,
                       .path = saved,
                       .limit = "15",
                       .before = before,
                       .solve = solve};
}

static double out[256];
static int done;

static int make_create(scene *c, const arguments *a) {
    return spar_session_create_mpi(MPI_COMM_WORLD, a->no_out ? NULL : &c->session);
}
static int make_destroy(scene *c, const arguments *a) {
    (void)a;
    spar_session_destroy(&c->session);
    return SPAR_OK;
}
static int make_commit(scene *c, const arguments *a) {
    (void)a;
    return spar_member_commit(c->beam);
}
static int make_static(scene *c, const arguments *a) {
    return spar_member_solve_static(c->beam, a->load_steps);
}
static int make_damping(scene *c, const arguments *a) {
    return spar_beam_set_modal_damping(c->beam, a->no_modes ? NULL : a->mode, a->ratio, a->no_out ? NULL : out);
}
static int make_fit(scene *c, const arguments *a) {
    return spar_beam_fit_damping(c->beam, 2, a->no_modes ? NULL : a->mode, a->ratio, a->no_out ? NULL : out);
}
static int make_begin(scene *c, const arguments *a) {
    return spar_step_begin(c->session, a->dt);
}
static int make_solve(scene *c, const arguments *a) {
    (void)a;
    return spar_step_solve(c->session);
}
static int make_check(scene *c, const arguments *a) {
    return spar_step_check(c->session, a->no_out ? NULL : &done);
}
static int make_accept(scene *c, const arguments *a) {
    (void)a;
    return spar_step_accept(c->session);
}
static int make_reject(scene *c, const arguments *a) {
    (void)a;
    return spar_step_reject(c->session);
}
static int make_total(scene *c, const arguments *a) {
    return spar_fluid_sum_loads(c->fluid, a->point, out, out + 3);
}
static int make_check_total(scene *c, const arguments *a) {
    static const double force[3] = {1, 2, 3};
    return spar_fluid_check_loads(c->fluid, a->point, force, NULL, 1e300);
}
static int make_step(scene *c, const arguments *a) {
    return spar_step(c->session, a->dt, a->solve, c, NULL);
}
static int make_equilibrium(scene *c, const arguments *a) {
    return spar_session_solve_static(c->session, a->load_steps, a->solve, c, NULL);
}
static int make_start(scene *c, const arguments *a) {
    return spar_session_solve_initial(c->session, a->dt, a->solve, c, NULL);
}
static int make_within(scene *c, const arguments *a) {
    double step = a->dt; /* a tolerance that any step keeps, on all ranks that are here, and none afterwards */
    int set_now = spar_session_set_tolerance(c->session, 1e9, 0) == SPAR_OK; /* not within a step */
    int status = spar_step_adaptive(c->session, &step, NULL, a->solve, c, NULL);
    if (set_now) {
        (void)spar_session_set_tolerance(c->session, 0, 0);
    }
    return status;
}
static int make_begin_start(scene *c, const arguments *a) {
    return spar_step_begin_initial(c->session, a->dt);
}
static int make_save(scene *c, const arguments *a) {
    return spar_session_save(c->session, a->path);
}
static int make_load(scene *c, const arguments *a) {
    return spar_session_load(c->session, a->path);
}
/* The trial with these settings; refused while it runs. */
static spar_trial *trial_with(scene *c, const arguments *a, int64_t steps) {
    (void)spar_trial_set_steps(c->trial, a->dt, steps);
    (void)spar_trial_set_callbacks(c->trial, a->before, c, a->solve, c);
    (void)spar_trial_set_goals(c->trial, a->goals);
    (void)spar_trial_set_option(c->trial, "limit", a->limit);
    return c->trial;
}
static int make_try(scene *c, const arguments *a) {
    return spar_trial_run(trial_with(c, a, a->steps), a->compare);
}
static int make_effects(scene *c, const arguments *a) {
    return spar_trial_report_effects(trial_with(c, a, a->steps));
}
static int make_advise(scene *c, const arguments *a) {
    return spar_trial_advise(trial_with(c, a, a->steps), a->tolerance, a->length);
}
/* The scene is in no equilibrium, which is as good an answer as any: on all ranks. */
static int make_eigenvalues(scene *c, const arguments *a) {
    int status = spar_trial_solve_eigenvalues(trial_with(c, a, 8), 1, NULL, a->no_out ? NULL : out, 0, NULL, NULL);
    return status == SPAR_ERR_STATE && strstr(spar_session_message(c->session), "equilibrium") ? SPAR_OK : status;
}
static int make_floquet(scene *c, const arguments *a) {
    int status = spar_trial_solve_floquet(trial_with(c, a, 2), 1, a->no_out ? NULL : out);
    return status == SPAR_ERR_STATE && strstr(spar_session_message(c->session), "not periodic") ? SPAR_OK : status;
}
static int make_apply(scene *c, const arguments *a) {
    double advised;
    return spar_trial_apply(c->trial, a->no_out ? NULL : &advised);
}
static int make_sum(scene *c, const arguments *a) {
    double x[] = {1, 2};
    return spar_session_sum(c->session, SPAR_OK, 2, a->no_out ? NULL : x);
}
static int make_balance(scene *c, const arguments *a) {
    int64_t members[2];
    return spar_session_sum_balance(c->session, a->no_out ? -1 : 2, members, NULL, NULL);
}
static int make_aero(scene *c, const arguments *a) {
    return spar_aero_report_effects(c->aero, trial_with(c, a, a->steps));
}

/* Where a call belongs: nothing committed, before the first step, between steps, and within one. */
enum stage { OPEN, FIRST, IDLE, BEGUN, SOLVED, CHECKED };

enum { /* what a call has, as bits */
       DT = 1,
       STEPS = 2,
       CALLBACKS = 4,
       COMPARE = 8,
       TOLERANCE = 16,
       OUT = 32,
       PATH = 64,
       LOAD_STEPS = 128,
       MODES = 256,
       SETTINGS = 512, /* compares them */
       NEEDS_SOLVE = 1024,
       DESCRIPTION = 2048,
       POINT = 4096,
       GOALS = 16384,
       SET_DT = 8192, /* of the trial, set before */
       TRIAL_SETTINGS = SET_DT | CALLBACKS | GOALS | SETTINGS,
       TRIAL = TRIAL_SETTINGS | STEPS
};

static const struct call {
    const char *name;
    int (*make)(scene *c, const arguments *a);
    enum stage stage;
    int has;
} calls[] = {
    {"spar_session_create_fcomm", make_create, OPEN, OUT},
    {"spar_session_destroy", make_destroy, IDLE, 0},
    {"spar_member_commit", make_commit, OPEN, DESCRIPTION | SETTINGS},
    {"spar_member_solve_static", make_static, FIRST, LOAD_STEPS | SETTINGS},
    {"spar_beam_set_modal_damping", make_damping, FIRST, MODES | SETTINGS},
    {"spar_step_begin", make_begin, IDLE, DT | SETTINGS},
    {"spar_step_solve", make_solve, BEGUN, 0},
    {"spar_step_check", make_check, SOLVED, OUT},
    {"spar_step_accept", make_accept, CHECKED, 0},
    {"spar_step_reject", make_reject, CHECKED, 0},
    {"spar_fluid_sum_loads", make_total, IDLE, POINT | SETTINGS},
    {"spar_fluid_check_loads", make_check_total, IDLE, POINT | SETTINGS},
    {"spar_step", make_step, IDLE, DT | SETTINGS},
    {"spar_step_adaptive", make_within, IDLE, DT | SETTINGS},
    {"spar_session_solve_static", make_equilibrium, FIRST, LOAD_STEPS | SETTINGS},
    {"spar_session_solve_initial", make_start, FIRST, DT | SETTINGS},
    {"spar_step_begin_initial", make_begin_start, FIRST, DT | SETTINGS},
    {"spar_session_save", make_save, IDLE, PATH | SETTINGS},
    {"spar_session_load", make_load, IDLE, PATH | SETTINGS},
    {"spar_trial_run", make_try, IDLE, TRIAL | COMPARE},
    {"spar_trial_report_effects", make_effects, IDLE, TRIAL},
    {"spar_trial_advise", make_advise, IDLE, TRIAL | TOLERANCE | NEEDS_SOLVE},
    {"spar_trial_apply", make_apply, IDLE, SETTINGS},
    {"spar_aero_report_effects", make_aero, IDLE, TRIAL},
    {"spar_session_sum", make_sum, IDLE, OUT | SETTINGS},
    {"spar_session_sum_balance", make_balance, IDLE, OUT},
    {"spar_trial_solve_eigenvalues", make_eigenvalues, IDLE, TRIAL_SETTINGS | OUT | NEEDS_SOLVE},
    {"spar_trial_solve_floquet", make_floquet, IDLE, TRIAL_SETTINGS | OUT},
    {"spar_beam_fit_damping", make_fit, FIRST, MODES | SETTINGS},
};
enum {
    CREATE = 0,
    DESTROY = 1,
    COMMIT = 2,
    BEGIN = 5,
    STEP = 12,
    STATIC = 14,
    BEGIN_START = 16,
    TRY = 19,
    CALLS = sizeof calls / sizeof *calls
};

static int inner_call(scene *c) {
    const arguments a = good();
    const struct call *call = calls + (c->inner % 100 - 1);
    c->inner = 0;
    return call->make(c, &a);
}

/* ---- a case ---- */

static int failures, cases, kinds[8];
enum { UNEQUAL, SETTING, OTHER, INNER, FAILING, MEMORY, DIFFERENT, GONE };
static const char *const kind_name[] = {"unequal arguments",    "unequal settings",  "other calls",
                                        "calls from callbacks", "failing callbacks", "failing allocations",
                                        "other members",        "ranks that went"};
static double deadline; /* 0: none */
static uint64_t dice = 1;

static void too_long(int signal_number) {
    static const char text[] = "\nranks: waits: ";
    (void)signal_number;
    (void)!write(2, text, sizeof text - 1);
    (void)!write(2, name, strlen(name));
    (void)!write(2, "\n", 1);
    _exit(3);
}

static int roll(int n) {
    dice ^= dice << 13, dice ^= dice >> 7, dice ^= dice << 17;
    return (int)(dice % (uint64_t)n);
}

/* Whether a case is taken: all ranks decide alike. share: one of so many, in the short form on more than 2
   ranks. */
static int taken(int share) {
    int take = deadline == 0 || size == 2 || roll(share) == 0;
    if (deadline > 0 && take) {
        take = MPI_Wtime() < deadline;
        MPI_Bcast(&take, 1, MPI_INT, 0, MPI_COMM_WORLD);
    }
    return take;
}

/* The long form tells every ten seconds where it is. */
static void tell(void) {
    static double told;
    double now = MPI_Wtime();
    if (rank == 0 && deadline == 0 && now - told > 10) {
        printf("   %d cases on %d ranks: %s\n", cases, size, name);
        (void)fflush(stdout);
        told = now;
    }
}

static void start(int kind, const char *format, const char *a, const char *b, int bad) {
    (void)snprintf(name, sizeof name, format, a, b, bad);
    cases++;
    kinds[kind]++;
    tell();
    (void)alarm(LIMIT);
}

static void fail_case(const char *what, int status, const char *message) {
    fprintf(stderr, "rank %d of %d: %s: %s (status %d: %s)\n", rank, size, name, what, status, message);
    if (++failures > FAILURES) {
        MPI_Abort(MPI_COMM_WORLD, 1);
    }
}

/* The status each rank should answer, and that the message says which call it was. */
static void expect(const scene *c, int status, int expected, const char *call) {
    const char *message = spar_session_message(c->session);
    if (status != expected) {
        fail_case("answers otherwise", status, message);
    } else if (status != SPAR_OK && call && !strstr(message, call)) {
        fail_case("does not name the call", status, message);
    }
}

static int of_one(int bad, int own) {
    return rank == bad ? own : SPAR_ERR_PEER;
}

/* All succeed or none. */
static int must_agree(int status, const char *message) {
    int mine[2] = {status == SPAR_OK, status != SPAR_OK}, most[2];
    MPI_Allreduce(mine, most, 2, MPI_INT, MPI_MAX, MPI_COMM_WORLD);
    if (most[0] && most[1]) {
        fail_case("some succeed, some do not", status, message);
    }
    return !most[1];
}

static void same(const scene *a, const scene *b) {
    double x[STATE], y[STATE];
    look(a, x);
    look(b, y);
    if (memcmp(x, y, sizeof x) != 0) {
        fail_case("the run is another one now", 0, "");
    }
}

/* Through a step by hand, up to a stage. */
static void walk(scene *c, enum stage stage) {
    const arguments a = good();
    if (stage >= BEGUN) {
        MUST(c->session, make_begin(c, &a));
    }
    if (stage >= SOLVED) {
        MUST(c->session, make_solve(c, &a));
    }
    if (stage >= CHECKED) {
        (void)solve(c->session, 0, dt, 0, c);
        MUST(c->session, make_check(c, &a));
    }
}

/* From there on to its end. */
static void walk_on(scene *c, enum stage stage) {
    const arguments a = good();
    if (stage == BEGUN) {
        MUST(c->session, make_solve(c, &a));
    }
    if (stage == BEGUN || stage == SOLVED) {
        (void)solve(c->session, 0, dt, 0, c);
        MUST(c->session, make_check(c, &a));
    }
    if (stage >= BEGUN) {
        MUST(c->session, make_accept(c, &a));
    }
}

/* Nothing has happened: the step that was under way, and another, go as they do beside it. */
static void goes_on(scene *hit, scene *calm, enum stage stage) {
    const arguments a = good();
    hit->calls = hit->nan_at = hit->user_at = hit->inner = calm->calls = 0;
    walk_on(hit, stage);
    walk_on(calm, stage);
    MUST(hit->session, make_step(hit, &a));
    MUST(calm->session, make_step(calm, &a));
    same(hit, calm);
    (void)alarm(0);
}

static void begin_both(scene *hit, scene *calm, enum stage stage) {
    const arguments a = good();
    begin(hit);
    begin(calm);
    if (stage > OPEN) {
        ready(hit);
        ready(calm);
    }
    if (stage > FIRST) {
        for (int i = 0; i < 3; i++) {
            MUST(hit->session, make_step(hit, &a));
            MUST(calm->session, make_step(calm, &a));
        }
        MUST(hit->session, make_save(hit, &a));
        MUST(hit->session, make_try(hit, &a));
        MUST(hit->session, make_advise(hit, &a));
        MUST(calm->session, make_advise(calm, &a));
    }
}

static void end_both(scene *hit, scene *calm) {
    end(hit);
    end(calm);
}

/* These scenes are in no equilibrium, which each rank finds for itself: its failure stands beside that of the rank
   under test, and the fluid is never called. tests/stability/mpi_eigenvalues.c has both from a state of rest. */
static int wants_rest(const struct call *call) {
    return call->make == make_eigenvalues;
}

static int is_left_out(const struct call *call) {
    return asked && strcmp(call->name, asked) != 0;
}

/* ---- unequal arguments ---- */

enum { PEERS = -1, FINE = -2 }; /* expected: SPAR_ERR_COMM on all; nothing wrong; else what the rank answers itself */

static const struct spoiler {
    const char *name, *word; /* word: what the message says */
    int of, expected;
} spoilers[] = {
    {"another dt", "dt", DT | SET_DT, PEERS},
    {"dt NaN", NULL, DT, SPAR_ERR_ARGUMENT},
    {"another number of steps", "steps", STEPS, PEERS},
    {"7 steps", NULL, STEPS, SPAR_ERR_ARGUMENT},
    {"no call before", "before", CALLBACKS, PEERS},
    {"no solver", "solve", CALLBACKS, PEERS},
    {"compares", "compare", COMPARE, PEERS},
    {"another tolerance", "tolerance", TOLERANCE, PEERS},
    {"tolerance 2", NULL, TOLERANCE, SPAR_ERR_ARGUMENT},
    {"no place for the answer", NULL, OUT, SPAR_ERR_ARGUMENT},
    {"no path", NULL, PATH, SPAR_ERR_ARGUMENT},
    {"an empty path", NULL, PATH, SPAR_ERR_ARGUMENT},
    {"another path", NULL, PATH, FINE},
    {"two load steps", "load_steps", LOAD_STEPS, PEERS},
    {"no load steps", NULL, LOAD_STEPS, SPAR_ERR_ARGUMENT},
    {"other modes", "different mode", MODES, PEERS},
    {"another second mode", "different mode", MODES, PEERS},
    {"another ratio", "different ratio", MODES, PEERS},
    {"another second ratio", "different ratio", MODES, PEERS},
    {"no modes", NULL, MODES, SPAR_ERR_ARGUMENT},
    {"a negative ratio", NULL, MODES, SPAR_ERR_ARGUMENT},
    {"no mu wanted", NULL, MODES, FINE},
    {"another point", "point (y)", POINT, PEERS},
    {"a point that is none", NULL, POINT, SPAR_ERR_ARGUMENT},
    {"another length", "length", TOLERANCE, PEERS},
    {"no length", NULL, TOLERANCE, SPAR_ERR_ARGUMENT},
    {"other goals", "goals", GOALS, PEERS},
    {"another limit", "option limit", GOALS, PEERS},
};
enum { SPOILERS = sizeof spoilers / sizeof *spoilers };

static void spoil(arguments *a, int k) {
    switch (k) {
    case 0:
        a->dt = 1.5 * dt;
        break;
    case 1:
        a->dt = NAN;
        break;
    case 2:
        a->steps = 16;
        break;
    case 3:
        a->steps = 7;
        break;
    case 4:
        a->before = NULL;
        break;
    case 5:
        a->solve = NULL;
        break;
    case 6:
        a->compare = 1;
        break;
    case 7:
        a->tolerance = 0.1;
        break;
    case 8:
        a->tolerance = 2;
        break;
    case 9:
        a->no_out = 1;
        break;
    case 10:
        a->path = NULL;
        break;
    case 11:
        a->path = "";
        break;
    case 12:
        a->path = rank == 0 ? a->path : elsewhere;
        break;
    case 13:
        a->load_steps = 2;
        break;
    case 14:
        a->load_steps = 0;
        break;
    case 15:
        a->mode[0] = 1, a->mode[1] = 0;
        break;
    case 16:
        a->mode[1] = 3;
        break;
    case 17:
        a->ratio[0] = 0.011;
        break;
    case 18:
        a->ratio[1] = 0.021;
        break;
    case 19:
        a->no_modes = 1;
        break;
    case 20:
        a->ratio[0] = -1;
        break;
    case 22:
        a->point[1] = 1;
        break;
    case 23:
        a->point[2] = NAN;
        break;
    case 24:
        a->length = 80 * dt;
        break;
    case 25:
        a->length = 0;
        break;
    case 26:
        a->goals = SPAR_GOAL_REACTION;
        break;
    case 27:
        a->limit = "90";
        break;
    default:
        a->no_out = 1;
        break;
    }
}

static int expected_of(const struct call *call, int k, int bad) {
    int expected = spoilers[k].expected;
    if (k == 5 && call->has & NEEDS_SOLVE) { /* refused by itself before it is compared */
        expected = SPAR_ERR_UNSUPPORTED;
    }
    return expected == PEERS ? SPAR_ERR_COMM : expected == FINE ? SPAR_OK : of_one(bad, expected);
}

static void unequal_argument(const struct call *call, int k, int bad, scene *hit, scene *calm) {
    arguments a = good();
    start(UNEQUAL, "%s with %s on rank %d", call->name, spoilers[k].name, bad);
    walk(hit, call->stage);
    walk(calm, call->stage);
    if (rank == bad) {
        spoil(&a, k);
    }
    int expected = expected_of(call, k, bad);
    if (call->make == make_load && expected == SPAR_OK) { /* what is there is loaded */
        MUST(hit->session, spar_session_save(hit->session, saved));
    }
    int status = call->make(hit, &a);
    expect(hit, status, expected, expected == SPAR_ERR_COMM ? spoilers[k].word : call->name);
    if (status == SPAR_OK && call->stage == FIRST) {
        a = good();
        MUST(calm->session, call->make(calm, &a));
    }
    goes_on(hit, calm, call->stage);
}

static void unequal_arguments(void) {
    for (int i = COMMIT; i < CALLS; i++) {
        const struct call *call = calls + i;
        scene hit, calm;
        begin_both(&hit, &calm, call->stage == OPEN ? FIRST : call->stage == FIRST ? FIRST : IDLE);
        for (int k = 0; k < SPOILERS; k++) {
            for (int bad = 0; bad < size; bad++) {
                if ((call->has & spoilers[k].of) == 0 || is_left_out(call) || !taken(2)) {
                    continue;
                }
                if (call->stage == FIRST) { /* the clock has run after a case */
                    end_both(&hit, &calm);
                    begin_both(&hit, &calm, FIRST);
                }
                unequal_argument(call, k, bad, &hit, &calm);
            }
        }
        end_both(&hit, &calm);
    }
}

static void no_place(void) {
    for (int bad = 0; bad < size; bad++) {
        scene c = {0};
        arguments a = good();
        start(UNEQUAL, "%s with %s on rank %d", calls[CREATE].name, "no place for the session", bad);
        a.no_out = rank == bad;
        expect(&c, make_create(&c, &a), of_one(bad, SPAR_ERR_ARGUMENT), calls[CREATE].name);
        if (c.session) {
            fail_case("a session on some ranks", 0, "");
        }
        (void)alarm(0);
    }
}

/* ---- unequal settings ---- */

static int set_option(spar_session *s, const char *key, const char *value) {
    return spar_session_set_option(s, key, value);
}

/* word: of the message. other: 1: otherwise, 0: as the scene has it */
static const struct setting {
    const char *word, *key, *value, *as_it_was;
} set[] = {
    {"gravity (x)", NULL, NULL, NULL},
    {"gravity (y)", NULL, NULL, NULL},
    {"gravity (z)", NULL, NULL, NULL},
    {"rho_inf", NULL, NULL, NULL},
    {"substeps", NULL, NULL, NULL},
    {"atol of spar_session_set_newton", NULL, NULL, NULL},
    {"rtol of spar_session_set_newton", NULL, NULL, NULL},
    {"max_iterations of spar_session_set_newton", NULL, NULL, NULL},
    {"order of spar_session_set_predictor", NULL, NULL, NULL},
    {"scheme", NULL, NULL, NULL},
    {"atol of spar_session_set_coupling", NULL, NULL, NULL},
    {"rtol of spar_session_set_coupling", NULL, NULL, NULL},
    {"max_iterations of spar_session_set_coupling", NULL, NULL, NULL},
    {"omega", NULL, NULL, NULL},
    {"drift of spar_session_set_tolerance", NULL, NULL, NULL},
    {"newton.budget", "newton.budget", "1234", "100000"},
    {"coupling.unconverged", "coupling.unconverged", "accept", "error"},
    {"coupling.unstable", "coupling.unstable", "accept", "error"},
    {"coupling.patience", "coupling.patience", "9", "3"},
    {"coupling.norm", "coupling.norm", "loads", "motion"},
    {"coupling.estimate", "coupling.estimate", "on", "off"},
    {"coupling.columns", "coupling.columns", "7", "30"},
    {"coupling.reuse", "coupling.reuse", "2", "5"},
    {"coupling.filter", "coupling.filter", "0.1", "1e-4"},
    {"coupling.motion_atol", "coupling.motion_atol", "1", "0"},
    {"coupling.motion_rtol", "coupling.motion_rtol", "1", "0"},
};
enum { SET = sizeof set / sizeof *set };

static int apply_number(spar_session *s, int k, int other) {
    double g[3] = {0, 0, -2};
    switch (k) {
    case 0:
    case 1:
    case 2:
        g[k] += other;
        return spar_session_set_gravity(s, g);
    case 3:
        return spar_session_set_integrator(s, other ? 0.8 : 0.9, 1);
    case 4:
        return spar_session_set_integrator(s, 0.9, other ? 2 : 1);
    case 5:
    case 6:
    case 7:
        return spar_session_set_newton(s, other && k == 5 ? 1e-14 : 1e-15, other && k == 6 ? 1e-9 : 1e-8,
                                       other && k == 7 ? 40 : 50);
    case 8:
        return spar_session_set_predictor(s, other ? 0 : 1);
    case 13:
        return spar_session_set_relaxation(s, other ? 0.9 : 1);
    case 14:
        return spar_session_set_tolerance(s, other ? 1e9 : 0, 0);
    default:
        return spar_session_set_coupling(s, other && k == 9 ? SPAR_COUPLING_AITKEN : SPAR_COUPLING_IQN_ILS,
                                         other && k == 10 ? 1e-9 : 0, other && k == 11 ? 1e-7 : 1e-8,
                                         other && k == 12 ? 70 : 60);
    }
}

static void apply(scene *c, int k, int other) {
    MUST(c->session, set[k].key ? set_option(c->session, set[k].key, other ? set[k].value : set[k].as_it_was)
                                : apply_number(c->session, k, other));
}

static void unequal_setting(const struct call *call, int k, int bad, scene *hit, scene *calm) {
    const arguments a = good();
    start(SETTING, "%s with another %s on rank %d", call->name, set[k].word, bad);
    if (rank == bad) {
        apply(hit, k, 1);
    }
    expect(hit, call->make(hit, &a), SPAR_ERR_COMM, set[k].word);
    apply(hit, k, 1); /* as all ranks would have to do to be alike again: setting it may have an effect of its own */
    apply(hit, k, 0);
    apply(calm, k, 1);
    apply(calm, k, 0);
    goes_on(hit, calm, IDLE);
}

/* The same of a call that belongs before the first step: with a scene of its own. */
static void unequal_at_first(const struct call *call, int k, int bad) {
    const arguments a = good();
    scene hit, calm;
    begin_both(&hit, &calm, call->stage);
    start(SETTING, "%s with another %s on rank %d", call->name, set[k].word, bad);
    if (rank == bad) {
        apply(&hit, k, 1);
    }
    expect(&hit, call->make(&hit, &a), SPAR_ERR_COMM, set[k].word);
    if (call->stage == OPEN) {
        (void)alarm(0);
    } else {
        apply(&hit, k, 1);
        apply(&hit, k, 0);
        apply(&calm, k, 1);
        apply(&calm, k, 0);
        goes_on(&hit, &calm, FIRST);
    }
    end_both(&hit, &calm);
}

/* Set and set back on one rank alone: the settings are alike, what setting them has done is not. */
static void set_and_back(int k, int bad, scene *hit, scene *calm) {
    const arguments a = good();
    start(SETTING, "%s after setting %s and back on rank %d", calls[STEP].name, set[k].word, bad);
    if (rank == bad) {
        apply(hit, k, 1);
        apply(hit, k, 0);
    }
    int status = make_step(hit, &a);
    if (must_agree(status, spar_session_message(hit->session))) {
        MUST(calm->session, make_step(calm, &a));
    } else {
        expect(hit, status, SPAR_ERR_COMM, "calls ");
        apply(hit, k, 1);
        apply(hit, k, 0);
        apply(calm, k, 1);
        apply(calm, k, 0);
    }
    goes_on(hit, calm, IDLE);
}

static void unequal_settings(void) {
    scene hit, calm;
    begin_both(&hit, &calm, IDLE);
    for (int i = COMMIT; i < CALLS; i++) {
        for (int k = 0; k < SET; k++) {
            for (int bad = 0; bad < size; bad++) {
                int sets_it = calls[i].make == make_within && strncmp(set[k].word, "drift", 5) == 0; /* alike, itself */
                if ((calls[i].has & SETTINGS) == 0 || sets_it || is_left_out(calls + i) || !taken(6)) {
                    continue;
                }
                if (calls[i].stage == IDLE) {
                    unequal_setting(calls + i, k, bad, &hit, &calm);
                } else {
                    unequal_at_first(calls + i, k, bad);
                }
            }
        }
    }
    for (int k = 0; k < SET; k++) {
        for (int bad = 0; bad < size; bad++) {
            if (taken(2)) {
                set_and_back(k, bad, &hit, &calm);
            }
        }
    }
    end_both(&hit, &calm);
}

/* ---- other calls on one rank ---- */

static int is_call(const struct call *c, const char *call) {
    return strcmp(c->name, call) == 0;
}

/* The report of effects is made on public calls: with one of these it meets in that one. */
static const char *what_is_told(const struct call *a, const struct call *b) {
    int meet = (is_call(a, "spar_session_sum") && is_call(b, "spar_aero_report_effects")) ||
               (is_call(b, "spar_session_sum") && is_call(a, "spar_aero_report_effects"));
    return meet ? "spar_session_sum: the ranks have different n" : "another call";
}

static void other_call(const struct call *theirs, const struct call *mine, int bad, enum stage stage, scene *hit,
                       scene *calm) {
    const arguments a = good();
    start(OTHER, "%s, and %s on rank %d", theirs->name, mine->name, bad);
    walk(hit, stage);
    walk(calm, stage);
    int status = (rank == bad ? mine : theirs)->make(hit, &a);
    expect(hit, status, SPAR_ERR_COMM, what_is_told(theirs, mine));
    goes_on(hit, calm, stage);
}

static void other_calls(void) {
    scene hit, calm;
    begin_both(&hit, &calm, IDLE);
    for (enum stage stage = IDLE; stage <= CHECKED; stage++) {
        for (int i = COMMIT; i < CALLS; i++) {
            for (int k = COMMIT; k < CALLS; k++) {
                int begins = i * k == BEGIN * STEP; /* spar_step begins with the same call */
                int skip = is_left_out(calls + i);
                for (int bad = 0; bad < size && i != k && !begins && !skip; bad++) {
                    if (taken(12)) {
                        other_call(calls + i, calls + k, bad, stage, &hit, &calm);
                    }
                }
            }
        }
    }
    end_both(&hit, &calm);
}

/* One rank has destroyed its session: the others are told wherever they are, and can only do the same. */
static void gone(void) {
    for (int i = COMMIT; i < CALLS; i++) {
        for (int bad = 0; bad < size; bad++) {
            if (is_left_out(calls + i) || !taken(2)) {
                continue;
            }
            scene c;
            const arguments a = good();
            begin(&c);
            ready(&c);
            start(GONE, "%s, and %s on rank %d", calls[i].name, calls[DESTROY].name, bad);
            walk(&c, calls[i].stage);
            for (int k = 0; k < 2 && rank != bad; k++) {
                expect(&c, calls[i].make(&c, &a), SPAR_ERR_COMM, "has destroyed this session");
            }
            end(&c);
            (void)alarm(0);
        }
    }
}

/* ---- from the callback of one rank ---- */

static void inner_calls(void) {
    scene hit, calm;
    begin_both(&hit, &calm, IDLE);
    for (int outer = STEP; outer < CALLS; outer++) {
        for (int i = COMMIT; i < CALLS; i++) {
            for (int bad = 0; bad < size; bad++) {
                for (int where = 1; where <= 101; where += 100) {
                    const arguments a = good();
                    int one = outer == STEP || outer == STATIC; /* solve, and no other callback */
                    if (!(calls[outer].has & CALLBACKS || one) || (where == 101 && one) || is_left_out(calls + outer) ||
                        wants_rest(calls + outer) || !taken(4)) {
                        continue;
                    }
                    start(INNER, "%s from a callback of %s on rank %d", calls[i].name, calls[outer].name, bad);
                    hit.inner = rank == bad ? where + i : 0;
                    int status = calls[outer].make(&hit, &a), own = BEGIN <= i && i <= BEGIN_START;
                    (void)must_agree(status, spar_session_message(hit.session));
                    if (own && rank == bad && hit.answer != SPAR_ERR_STATE) {
                        fail_case("does to what is under way what is its lender's", hit.answer, "");
                    }
                    if ((status == SPAR_OK) != own) {
                        fail_case(own ? "disturbs the others" : "goes unnoticed", status, "");
                    }
                    if (own && one) {
                        MUST(calm.session, calls[outer].make(&calm, &a));
                    }
                    goes_on(&hit, &calm, IDLE);
                }
            }
        }
    }
    end_both(&hit, &calm);
}

/* ---- failures on one rank ---- */

static void failing_callbacks(void) {
    scene hit, calm;
    begin_both(&hit, &calm, IDLE);
    for (int i = STEP; i < CALLS; i++) {
        for (int bad = 0; bad < size; bad++) {
            for (int at = 1; at < 40; at += 1 + at / 2) {
                for (int nan = 0; nan < 2; nan++) {
                    const arguments a = good();
                    if (!(calls[i].has & CALLBACKS || i == STEP || i == STATIC) || (nan && bad != 0) ||
                        is_left_out(calls + i) || !taken(2)) {
                        continue;
                    }
                    start(FAILING, "%s with %s on rank %d", calls[i].name, nan ? "NaN pushed" : "a callback that fails",
                          bad);
                    hit.calls = 0;
                    *(nan ? &hit.nan_at : &hit.user_at) = rank == bad ? at : 0;
                    int status = calls[i].make(&hit, &a);
                    int all = must_agree(status, spar_session_message(hit.session));
                    hit.nan_at = hit.user_at = 0;
                    if (all && (i == STEP || i == STATIC)) {
                        MUST(calm.session, calls[i].make(&calm, &a));
                    }
                    if (!all && i <= TRY) {
                        expect(&hit, status, of_one(bad, nan ? SPAR_ERR_ARGUMENT : SPAR_ERR_USER), NULL);
                    }
                    goes_on(&hit, &calm, IDLE);
                }
            }
        }
    }
    end_both(&hit, &calm);
}

/* The next allocation to fail: one after the other, and the later ones of a long call ever fewer. */
static long after(long at) {
    return at + 1 + (deadline == 0 ? at / 60 : at / 3);
}

/* Makes a call with one allocation failing, ever later, until it needs no more. again: what is to be made anew after.
 */
static void failing_memory(const struct call *call, int bad, scene *hit, scene *calm) {
    const arguments a = good();
    for (long at = 1;; at = after(at)) {
        start(MEMORY, "%s without %s on rank %d", call->name, "memory", bad);
        (void)snprintf(name + strlen(name), sizeof name - strlen(name), ", allocation %ld", at);
        allocations = 0;
        fails_at = rank == bad ? at : 0;
        int status = call->make(hit, &a), failed = rank == bad && allocations >= at;
        fails_at = 0;
        MPI_Bcast(&failed, 1, MPI_INT, bad, MPI_COMM_WORLD);
        int all = must_agree(status, spar_session_message(hit->session));
        (void)alarm(0);
        if (!all) {
            expect(hit, status, of_one(bad, SPAR_ERR_MEMORY), NULL);
        }
        if (all) {
            if (call->stage != OPEN && (call->stage != IDLE || call->make == make_begin || call->make == make_step ||
                                        call->make == make_within || call->make == make_apply)) {
                MUST(calm->session, call->make(calm, &a));
            }
            return;
        }
        if (!failed) {
            fail_case("fails with all the memory it wants", status, spar_session_message(hit->session));
            return;
        }
    }
}

/* Of scenes that have got as far as `made`. */
static void failing_memory_from(const struct call *call, enum stage made, int bad) {
    enum stage stage = call->stage;
    scene hit, calm;
    begin_both(&hit, &calm, made);
    if (stage == OPEN) {
        failing_memory(call, bad, &hit, NULL);
        MUST(hit.session, spar_member_commit(hit.body));
        end_both(&hit, &calm);
        return;
    }
    walk(&hit, stage);
    walk(&calm, stage);
    failing_memory(call, bad, &hit, &calm);
    stage = call->make == make_begin || call->make == make_begin_start ? BEGUN
            : call->make == make_solve                                 ? SOLVED
            : call->make == make_check                                 ? CHECKED
            : stage == CHECKED                                         ? IDLE
                                                                       : stage;
    goes_on(&hit, &calm, stage);
    end_both(&hit, &calm);
}

static void failing_allocations(void) {
    for (int i = COMMIT; i < CALLS; i++) {
        for (int bad = 0; bad < size; bad++) {
            enum stage stage = calls[i].stage;
            if (!is_left_out(calls + i) && !wants_rest(calls + i) && taken(1)) {
                failing_memory_from(calls + i, stage > IDLE ? IDLE : stage, bad);
            }
            if ((i == BEGIN || i == STEP) && !is_left_out(calls + i) && taken(1)) { /* the first step has more to get */
                failing_memory_from(calls + i, FIRST, bad);
            }
        }
    }
    for (int bad = 0; bad < size; bad++) {
        scene hit = {0};
        failing_memory(calls + CREATE, bad, &hit, NULL);
        spar_session_destroy(&hit.session);
    }
}

/* ---- members described otherwise ---- */

enum { WAYS = 14 };

static void describe_otherwise(scene *c, int k) {
    static const double at[3] = {1, 0, 0}, q[4] = {1, 0, 0, 0}, mu[6] = {1e-3, 0, 0, 0, 0, 0}, v[3] = {0, 1, 0},
                        eta[2] = {0, 1}, xyz[6] = {0, 0, 0, 9, 0, 0}, bent[2] = {0, 0.1};
    double K[36], M[36];
    spar_session *s = c->session;
    spar_member *b = c->beam;
    scene_box(K, M);
    switch (k) {
    case 0:
        MUST(s, spar_member_set_root(b, SPAR_ROOT_PINNED));
        break;
    case 1:
        MUST(s, spar_member_set_effects(b, 0, SPAR_EFFECT_GYROSCOPIC));
        break;
    case 2:
        MUST(s, spar_member_set_fidelity(b, SPAR_FIDELITY_LINEAR, 0));
        break;
    case 3:
        MUST(s, spar_member_set_owner(b, size - 1));
        break;
    case 4:
        MUST(s, spar_member_set_placement(b, at, NULL));
        break;
    case 5:
        MUST(s, spar_member_set_initial_velocity(b, NULL, v, NULL));
        break;
    case 6:
        MUST(s, spar_beam_set_axis(b, 2, eta, xyz, NULL));
        break;
    case 7:
        MUST(s, spar_beam_set_axis(b, 2, eta, (double[6]){0, 0, 0, 10, 0, 0}, bent));
        break;
    case 8:
        MUST(s, spar_beam_set_sections(b, 1, eta, K, NULL));
        break;
    case 9:
        K[0] *= 2;
        MUST(s, spar_beam_set_sections(b, 1, eta, K, M));
        break;
    case 10:
        MUST(s, spar_beam_set_quadrature(b, SPAR_QUADRATURE_GAUSS, 7));
        break;
    case 11:
        MUST(s, spar_beam_set_damping(b, mu));
        break;
    case 12:
        MUST(s, spar_member_set_external(b, 1));
        break;
    default:
        MUST(s, spar_member_set_fidelity(b, SPAR_FIDELITY_MODAL, 3));
        break;
    }
    (void)q;
}

static void other_members(void) {
    static const char *const way[WAYS] = {
        "another root",       "other effects", "another fidelity", "another owner", "another place",
        "a velocity",         "another axis",  "a twist",          "no mass",       "another stiffness",
        "another quadrature", "damping",       "external",         "modes"};
    for (int k = 0; k < WAYS; k++) {
        for (int bad = 0; bad < size; bad++) {
            if (!taken(1)) {
                continue;
            }
            scene hit;
            const arguments a = good();
            begin(&hit);
            start(DIFFERENT, "%s with %s on rank %d", calls[COMMIT].name, way[k], bad);
            if (rank == bad) {
                describe_otherwise(&hit, k);
            }
            int status = make_commit(&hit, &a), owner_is_the_same = k == 3 && size == 1;
            expect(&hit, status, owner_is_the_same ? SPAR_OK : SPAR_ERR_COMM, calls[COMMIT].name);
            MUST(hit.session, spar_member_commit(hit.body)); /* the other member is alike */
            end(&hit);
            (void)alarm(0);
        }
    }
}

/* A create that fails on one rank: it has no handle, so it leaves, and the others do not wait. */
static void failed_create(void) {
    for (int bad = 0; bad < size; bad++) {
        scene c;
        const arguments a = good();
        spar_member *more = NULL;
        begin(&c);
        start(DIFFERENT, "%s after %s on rank %d", calls[COMMIT].name, "a create that failed", bad);
        int created = spar_point_create(c.session, rank == bad ? "beam" : "point", NULL, NULL, &more);
        if (rank == bad) {
            expect(&c, created, SPAR_ERR_ARGUMENT, "spar_point_create");
            expect(&c, make_begin(&c, &a), SPAR_ERR_COMM, "another call"); /* any other collective call will do */
        } else {
            expect(&c, spar_member_commit(more), SPAR_ERR_COMM, "another call");
        }
        expect(&c, make_commit(&c, &a), SPAR_ERR_COMM, "numbers of members");
        end(&c);
        (void)alarm(0);
    }
}

/* ---- that no call is missing ---- */

/* Every call whose comment says "Collective" has a row above, and no other. */
static void all_calls(void) {
#define NAME(name) #name,
    static const char *const collective[] = {SPAR_COLLECTIVE_CALLS(NAME)};
#undef NAME
    enum { COLLECTIVE = sizeof collective / sizeof *collective };
    for (int k = 0; k < COLLECTIVE; k++) {
        int i = 0;
        while (i < CALLS && strcmp(calls[i].name, collective[k]) != 0) {
            i++;
        }
        if (i == CALLS) {
            fprintf(stderr, "ranks: %s is collective and has no row in the table of calls\n", collective[k]);
            failures++;
        }
    }
    for (int i = 0; i < CALLS; i++) {
        int k = 0;
        while (k < COLLECTIVE && strcmp(calls[i].name, collective[k]) != 0) {
            k++;
        }
        if (k == COLLECTIVE) {
            fprintf(stderr,
                    "ranks: %s has a row in the table of calls, but its comment does not say that it is collective\n",
                    calls[i].name);
            failures++;
        }
    }
}

/* ---- all of it ---- */

static void say(void) {
    if (rank == 0) {
        printf("ranks: %d cases on %d ranks", cases, size);
        for (int k = 0; k < 8; k++) {
            printf("%s %d %s", k ? "," : ":", kinds[k], kind_name[k]);
        }
        printf("\n");
    }
}

int main(int argc, char **argv) {
    int most = 0;
    MPI_Init(&argc, &argv);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    MPI_Comm_size(MPI_COMM_WORLD, &size);
    binned = argc > 3 && strcmp(argv[3], "binned") == 0;
    asked = argc > 4 ? argv[4] : NULL;
    (void)signal(SIGALRM, too_long);
    double seconds = argc > 1 ? strtod(argv[1], NULL) : 0;
    dice = argc > 2 ? strtoull(argv[2], NULL, 0) : (uint64_t)time(NULL);
    MPI_Bcast(&dice, 1, MPI_UINT64_T, 0, MPI_COMM_WORLD);
    dice += dice == 0;
    if (rank == 0) {
        printf("ranks: seed %llu\n", (unsigned long long)dice);
        fflush(stdout);
    }
    dice = dice * UINT64_C(0x9E3779B97F4A7C15) | 1;
    (void)snprintf(saved, sizeof saved, "torture_ranks_%d.spar", size);
    (void)snprintf(elsewhere, sizeof elsewhere, "no/such/folder/%d", rank);
    static void (*const parts[])(void) = {
        no_place,          failed_create,     other_members,    gone,       failing_allocations, inner_calls,
        failing_callbacks, unequal_arguments, unequal_settings, other_calls};
    enum { PARTS = sizeof parts / sizeof *parts };
    all_calls();
    for (int k = 0; k < PARTS; k++) {
        if (seconds > 0) { /* what is left is shared by the parts that are left */
            static double until;
            until = k ? until : MPI_Wtime() + seconds;
            deadline = MPI_Wtime() + (until - MPI_Wtime()) / (PARTS - k);
        }
        parts[k]();
    }
    MPI_Allreduce(&failures, &most, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD);
    (void)remove(rank == 0 ? saved : elsewhere);
    say();
    MPI_Finalize();
    return most > 0;
}
