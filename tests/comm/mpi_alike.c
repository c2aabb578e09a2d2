/* What the ranks must say alike: an argument, a setting or a call that differs on one of them is SPAR_ERR_COMM on all,
   the message names it, nobody waits (ctest's time limit is the witness) and the run goes on as if nothing had been.
   The instrument tests/torture/ranks goes through all calls; here are those that were found to wait or to be accepted.
 */
#include "scene.h"
#include "trials.h"

#include "ranks.h"
#include <spar/spar_aero.h>
#include <spar/spar_mpi.h>
#include <stdio.h>

static int last; /* last: this is the rank that differs */
static const double dt = 0.02;

typedef struct scene {
    spar_session *session;
    spar_member *beam;
    spar_fluid *fluid;
} scene;

static void create(scene *c) {
    static const double tip[3] = {10, 0, 0};
    double K[36], M[36];
    memset(c, 0, sizeof *c);
    OK(NULL, spar_session_create_mpi(MPI_COMM_WORLD, &c->session));
    scene_box(K, M);
    c->beam = scene_beam(c->session, "beam", 1, 4, 10, K, M);
    OK(c->session, spar_member_commit(c->beam));
    OK(c->session, spar_fluid_create(c->beam, "tip", &c->fluid));
    OK(c->session, spar_fluid_set_force_nodes(c->fluid, rank == 0, rank == 0 ? tip : NULL));
    OK(c->session, spar_fluid_map(c->fluid));
}

static int solve(spar_session *s, double t, double step, int iteration, void *context) {
    scene *c = context;
    double force[3] = {0, sin(3 * (t + step)), 0};
    (void)iteration;
    OK(s, spar_fluid_push_forces(c->fluid, rank == 0 ? force : NULL, NULL));
    return 0;
}

static int before(spar_session *s, double t, double step, void *context) {
    (void)s, (void)t, (void)step, (void)context;
    return 0;
}

/* One rank alone takes it; several refuse it with the name of what differs. */
static void differs(const scene *c, int status, const char *name) {
    assert_int_equal(status, size == 1 ? SPAR_OK : SPAR_ERR_COMM);
    if (size > 1) {
        assert_non_null(strstr(spar_session_message(c->session), name));
    }
}

/* A run goes on like one that nothing has happened to. */
static void goes_on(scene *c) {
    scene other;
    double a[28], b[28];
    create(&other);
    for (int i = 0; i < 2; i++) {
        OK(c->session, spar_step(c->session, dt, solve, c, NULL));
        OK(other.session, spar_step(other.session, dt, solve, &other, NULL));
    }
    OK(c->session, spar_member_get_motion(c->beam, a, NULL, NULL));
    OK(other.session, spar_member_get_motion(other.beam, b, NULL, NULL));
    assert_memory_equal(a, b, sizeof a);
    spar_session_destroy(&other.session);
    spar_session_destroy(&c->session);
}

static void trials(void **state) {
    (void)state;
    scene c;
    double r[TRY_COUNT], table[SPAR_ROW_COUNT][COLUMN_COUNT];
    create(&c);
    spar_session *s = c.session;
    differs(&c, trial_run(s, dt, last ? 16 : 8, NULL, solve, &c, 0, r), "steps (here ");
    differs(&c, trial_run(s, last ? 2 * dt : dt, 8, NULL, solve, &c, 0, r), "dt (here ");
    differs(&c, trial_run(s, dt, 8, NULL, last ? NULL : solve, &c, 0, r), "solve (here ");
    differs(&c, trial_run(s, dt, 8, last ? NULL : before, solve, &c, 0, r), "before (here ");
    OK(s, trial_run(s, dt, 8, NULL, solve, &c, 0, r));
    differs(&c, trial_run(s, dt, 8, NULL, solve, &c, last, r), "compare (here ");
    differs(&c, trial_report_effects(s, dt, last ? 16 : 8, NULL, solve, &c, table[0]), "steps (here ");
    differs(&c, trial_report_effects(s, dt, 8, NULL, last ? NULL : solve, &c, table[0]), "solve (here ");
    goes_on(&c);
}

static void advice(void **state) {
    (void)state;
    static const char *const option[][2] = {{"dt", "keep"}, {"nodes", "keep"}, {"coupling", "keep"}, {"limit", "7"}};
    enum { OPTIONS = sizeof option / sizeof *option };
    double a[ADVICE_COUNT];
    for (int k = 0; k < OPTIONS + 4 && size > 1; k++) {
        scene c;
        create(&c);
        spar_session *s = c.session;
        if (k < OPTIONS) {
            char name[40];
            (void)snprintf(name, sizeof name, "option %s", option[k][0]);
            OK(s, spar_trial_set_option(trial_of(s), option[k][0], last ? option[k][1] : k < 3 ? "vary" : "5"));
            differs(&c, trial_advise(s, 0.1, dt, 8, 1, NULL, solve, &c, a), name);
        } else if (k == OPTIONS) {
            differs(&c, trial_advise(s, last ? 0.1 : 0.2, dt, 8, 1, NULL, solve, &c, a), "tolerance (here ");
        } else if (k == OPTIONS + 1) {
            differs(&c, trial_advise(s, 0.1, dt, last ? 16 : 8, 1, NULL, solve, &c, a), "steps (here ");
        } else if (k == OPTIONS + 2) {
            OK(s, spar_session_set_option(s, "coupling.motion_rtol", last ? "0.5" : "0.01"));
            differs(&c, trial_advise(s, 0.1, dt, 8, 1, NULL, solve, &c, a), "coupling.motion_rtol");
        } else {
            OK(s, spar_session_set_coupling(s, last ? SPAR_COUPLING_AITKEN : SPAR_COUPLING_EXPLICIT, 1e-9, 1e-6, 50));
            differs(&c, trial_advise(s, 0.1, dt, 8, 1, NULL, solve, &c, a), "scheme of spar_session_set_coupling");
        }
        spar_session_destroy(&c.session);
    }
}

static void aero(void **state) {
    (void)state;
    scene c;
    spar_aero *none = NULL;
    double table[SPAR_AERO_ROW_COUNT][COLUMN_COUNT];
    create(&c);
    OK(c.session, spar_aero_create(0, NULL, &none));
    differs(&c, trial_report_aero(none, c.session, dt, last ? 16 : 8, NULL, solve, &c, table[0]), "steps (here ");
    differs(&c, trial_report_aero(none, c.session, dt, 8, last ? NULL : before, solve, &c, table[0]), "before (here ");
    spar_aero_destroy(&none);
    goes_on(&c);
}

static void members(void **state) {
    (void)state;
    static const int64_t mode[2] = {0, 1}, other[2] = {1, 0};
    static const double ratio[2] = {0.01, 0.02}, more[2] = {0.01, 0.03};
    scene c;
    create(&c);
    if (size > 1) {
        differs(&c, spar_beam_set_modal_damping(c.beam, mode, last ? more : ratio, NULL), "ratio[1] (here ");
        differs(&c, spar_beam_set_modal_damping(c.beam, last ? other : mode, ratio, NULL), "mode[0] (here ");
        differs(&c, spar_member_solve_static(c.beam, last ? 2 : 1), "load_steps (here ");
        double g[3] = {0, 0, last ? -1 : 0};
        OK(c.session, spar_session_set_gravity(c.session, g));
        differs(&c, spar_member_solve_static(c.beam, 1), "gravity (z) (here ");
        g[2] = 0;
        OK(c.session, spar_session_set_gravity(c.session, g));
    }
    goes_on(&c);
}

/* The same members in another order: loads and motions would go to each other's. */
static void other_order(void **state) {
    (void)state;
    spar_session *s = NULL;
    spar_member *m[2];
    OK(NULL, spar_session_create_mpi(MPI_COMM_WORLD, &s));
    for (int k = 0; k < 2; k++) {
        int one = last ? 1 - k : k;
        OK(s, spar_point_create(s, one ? "one" : "other", NULL, NULL, m + one));
        OK(s, spar_member_set_owner(m[one], 0));
    }
    scene c = {.session = s};
    differs(&c, spar_member_commit(m[0]), "order of creation");
    spar_session_destroy(&s);
}

/* What the fluid's added mass responds to is part of a member's description; the options of a fluid are not compared.
 */
static void other_response(void **state) {
    (void)state;
    const double node[3] = {0, 0, 0};
    double mass[36] = {0};
    spar_session *s = NULL;
    spar_member *body = NULL;
    spar_fluid *fluid = NULL;
    OK(NULL, spar_session_create_mpi(MPI_COMM_WORLD, &s));
    for (int i = 0; i < 6; i++) {
        mass[7 * i] = 1;
    }
    OK(s, spar_rigid_create(s, "body", NULL, NULL, mass, &body));
    OK(s, spar_member_set_added_mass(body, 1, NULL, mass));
    scene c = {.session = s};
    if (size > 1) {
        OK(s, spar_member_set_added_mass_response(body, last ? SPAR_RESPONSE_VELOCITY : SPAR_RESPONSE_ACCELERATION));
        differs(&c, spar_member_commit(body), "descriptions of it");
    }
    OK(s, spar_member_set_added_mass_response(body, SPAR_RESPONSE_VELOCITY));
    OK(s, spar_member_commit(body));
    OK(s, spar_fluid_create(body, "fluid", &fluid));
    OK(s, spar_fluid_set_option(fluid, "theta", last ? "group" : "average"));
    OK(s, spar_fluid_set_option(fluid, "far", last ? "refuse" : "take"));
    OK(s, spar_fluid_set_option(fluid, "audit", last ? "off" : "on"));
    OK(s, spar_fluid_set_motion_nodes(fluid, 1, node));
    OK(s, spar_fluid_map(fluid));
    OK(s, spar_step_begin(s, dt));
    OK(s, spar_step_reject(s));
    spar_session_destroy(&s);
}

/* Nowhere to put the session on one rank: none on the others either. */
static void no_place(void **state) {
    (void)state;
    for (int bad = 0; bad < size; bad++) {
        spar_session *s = NULL;
        int status = spar_session_create_mpi(MPI_COMM_WORLD, rank == bad ? NULL : &s);
        assert_int_equal(status, rank == bad ? SPAR_ERR_ARGUMENT : SPAR_ERR_PEER);
        assert_non_null(strstr(spar_session_message(NULL), "the pointer to the new session is NULL"));
        assert_null(s);
    }
}

/* A rank that gives up and destroys its session does not leave the others waiting, nor wait itself. */
static void destroyed_on_one_rank(void **state) {
    (void)state;
    for (int bad = 0; bad < size && size > 1; bad++) {
        for (int when = 0; when < 3; when++) {
            scene c;
            int done = 0;
            create(&c);
            if (when > 0) {
                OK(c.session, spar_step_begin(c.session, dt));
            }
            if (when > 1) {
                OK(c.session, spar_step_solve(c.session));
            }
            for (int k = 0; k < 2 && rank != bad; k++) {
                int status = when == 0   ? spar_step(c.session, dt, solve, &c, NULL)
                             : when == 1 ? spar_step_solve(c.session)
                                         : spar_step_check(c.session, &done);
                assert_int_equal(status, SPAR_ERR_COMM);
                assert_non_null(strstr(spar_session_message(c.session), "has destroyed this session"));
            }
            spar_session_destroy(&c.session);
        }
    }
}

/* Sums are the same bits everywhere; a rank that has failed is known to all, with its message, and no number changes.
 */
static void sums(void **state) {
    (void)state;
    scene c;
    double x[3], sum[2] = {0};
    create(&c);
    for (int r = 0; r < size; r++) {
        sum[0] += r + 1;
        sum[1] += 0.5 * r;
    }
    x[0] = rank + 1, x[1] = 0.5 * rank, x[2] = 7;
    OK(c.session, spar_session_sum(c.session, SPAR_OK, 2, x)); /* whole numbers and halves: no rounding */
    assert_true(x[0] == sum[0] && x[1] == sum[1] && x[2] == 7);
    int mine = last ? spar_fluid_set_force_nodes(c.fluid, -1, NULL) : SPAR_OK;
    assert_int_equal(spar_session_sum(c.session, mine, 1, x), last       ? SPAR_ERR_ARGUMENT
                                                              : size > 1 ? SPAR_ERR_PEER
                                                                         : SPAR_OK);
    assert_true(size == 1 || strstr(spar_session_message(c.session), "-1 nodes"));
    assert_true(x[0] == sum[0]);
    for (int failed = SPAR_ERR_ARGUMENT; failed <= SPAR_ERR_LIMIT; failed++) { /* each status can be handed on */
        int status = spar_session_sum(c.session, last ? failed : SPAR_OK, 1, x);
        assert_int_equal(status, last ? failed : size > 1 ? SPAR_ERR_PEER : SPAR_OK);
        assert_true(x[0] == sum[0]);
    }
    differs(&c, spar_session_sum(c.session, SPAR_OK, last ? 2 : 3, x), "n");
    spar_session_destroy(&c.session);
}

static int calls_the_others(spar_session *s, double t, double step, int iteration, void *context) {
    if (last) {
        (void)spar_session_save(s, "never written");
    }
    return solve(s, t, step, iteration, context);
}

static int calls_them_before(spar_session *s, double t, double step, void *context) {
    (void)t, (void)step, (void)context;
    return last ? spar_session_save(s, "never written") : 0;
}

/* A collective call from one rank's callback: the others are elsewhere, all are told, all have left the step. */
static void calls_from_callbacks(void **state) {
    (void)state;
    scene c;
    double report[TRY_COUNT];
    if (size == 1) {
        return;
    }
    create(&c);
    differs(&c, spar_step(c.session, dt, calls_the_others, &c, NULL), "another call");
    MPI_Barrier(MPI_COMM_WORLD); /* nobody is left behind in the step */
    differs(&c, trial_run(c.session, dt, 8, NULL, calls_the_others, &c, 0, report), "");
    MPI_Barrier(MPI_COMM_WORLD);
    differs(&c, trial_run(c.session, dt, 8, calls_them_before, solve, &c, 0, report), "another call");
    MPI_Barrier(MPI_COMM_WORLD);
    goes_on(&c);
}

int main(int argc, char **argv) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(trials),      cmocka_unit_test(advice),
        cmocka_unit_test(aero),        cmocka_unit_test(members),
        cmocka_unit_test(other_order), cmocka_unit_test(other_response),
        cmocka_unit_test(no_place),    cmocka_unit_test(destroyed_on_one_rank),
        cmocka_unit_test(sums),        cmocka_unit_test(calls_from_callbacks),
    };
    spar_session *s = NULL;
    int early = spar_session_create_mpi(MPI_COMM_WORLD, &s);
    ranks_begin(argc, argv);
    last = rank == size - 1 && size > 1;
    int worst = ranks_end(cmocka_run_group_tests(tests, NULL, NULL));
    int late = spar_session_create_mpi(MPI_COMM_WORLD, &s);
    if (early != SPAR_ERR_COMM || late != SPAR_ERR_COMM || s ||
        !strstr(spar_session_message(NULL), "MPI is not running")) {
        fprintf(stderr, "a session before MPI_Init or after MPI_Finalize was not refused: %d, %d\n", early, late);
        worst = 1;
    }
    return worst;
}
