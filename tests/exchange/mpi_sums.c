/* Reproducible sums over the ranks (spar_session_set_reproducible): a coupled run has the same bits on any number of
   ranks. Each run on ranks is compared, bit by bit, with the same run in a session of this process alone, so that runs
   on 1, 2, 3, 4 and 7 ranks (ctest has them all) are the same too. A flexible beam and a rigid piston, two fluids on
   the beam, whose nodes are dealt out in turn with a rank that has none, all to one rank, at random, or one to a rank;
   forces that nearly cancel, of sizes from 1e-6 to 1e3 N. */
#include "scene.h"
#include "trials.h"

#include "ranks.h"
#include <spar/spar_mpi.h>
#include <stdio.h>
#include <stdlib.h>

enum { NODES = 61, STEPS = 6, POINTS = 10 };
enum { IN_TURN, ALL_ON_ONE, AT_RANDOM, ONE_EACH, DEALS };

typedef struct half {
    spar_fluid *fluid;
    int n, number[NODES]; /* this rank's nodes, by their number in the scene */
    double x[NODES][3];
} half;

typedef struct scene {
    spar_session *session;
    spar_member *beam, *piston;
    half half[2];
    spar_fluid *added;
    int piston_here;
    int parts;           /* pushes of a step, 0: one at its end; every third step has one in any case */
    double pushed_until; /* [s] the second fluid on the beam falls silent: its last loads stay */
} scene;

static int learns; /* the added mass is learned, at one station */

static void place_of(int i, double x[3]) {
    double angle = 0.7 * i;
    x[0] = 10.0 * i / (NODES - 1), x[1] = 0.3 * cos(angle), x[2] = 0.3 * sin(angle);
}

/* Which of `ranks` has node i. */
static int owner_of(int i, int deal, int ranks) {
    switch (deal) {
    case IN_TURN:
        return ranks > 1 ? i % (ranks - 1) : 0;
    case ALL_ON_ONE:
        return ranks - 1;
    case AT_RANDOM:
        return (int)((unsigned)i * 2654435761u >> 8) % ranks;
    default: /* one to each but the last, which has the rest */
        return i < ranks ? i : ranks - 1;
    }
}

/* comm NULL: this process alone. */
static void create(scene *c, const MPI_Comm *comm, int deal, int scheme) {
    static const double q[4] = {1, 0, 0, 0}, where[3] = {0, 5, 0}, centre[3] = {0, 0, 0}, J[3] = {1, 1, 1};
    double K[36], M[36], mass[36], gravity[3] = {0, 0, -2};
    int me = 0, ranks = 1;
    memset(c, 0, sizeof *c);
    if (comm) {
        MPI_Comm_rank(*comm, &me);
        MPI_Comm_size(*comm, &ranks);
        OK(NULL, spar_session_create_mpi(*comm, &c->session));
    } else {
        OK(NULL, spar_session_create(&c->session));
    }
    spar_session *s = c->session;
    scene_box(K, M);
    OK(s, spar_session_set_reproducible(s, 1));
    OK(s, spar_session_set_gravity(s, gravity));
    OK(s, spar_session_set_coupling(s, scheme, 0, 1e-9, 200));
    OK(s, spar_session_set_relaxation(s, 0.4));
    c->beam = scene_beam(s, "beam", 2, POINTS / 2, 10, K, M);
    OK(s, spar_member_set_root(c->beam, SPAR_ROOT_FIXED));
    OK(s, spar_member_set_effects(c->beam, SPAR_EFFECT_FLUID_HISTORY, 0));
    OK(s, spar_member_learn_added_mass(c->beam, learns, (double[]){0}));
    OK(s, spar_member_commit(c->beam));
    scene_mass(mass, 3, centre, J);
    OK(s, spar_rigid_create(s, "piston", where, q, mass, &c->piston));
    OK(s, spar_member_learn_added_mass(c->piston, learns, NULL));
    OK(s, spar_member_commit(c->piston));
    for (int k = 0; k < NODES; k++) {
        int i = deal == AT_RANDOM ? k * 17 % NODES : k; /* 61 is prime: in another order */
        half *h = c->half + i % 2;
        if (owner_of(i, deal, ranks) == me) {
            h->number[h->n] = i;
            place_of(i, h->x[h->n++]);
        }
    }
    for (int k = 0; k < 2; k++) {
        half *h = c->half + k;
        OK(s, spar_fluid_create(c->beam, k ? "odd" : "even", &h->fluid));
        OK(s, spar_fluid_set_interpolation(h->fluid, k ? SPAR_INTERPOLATE_CONSISTENT : SPAR_INTERPOLATE_NODAL));
        OK(s, spar_fluid_set_motion_nodes(h->fluid, h->n, h->n ? h->x[0] : NULL));
        OK(s, spar_fluid_set_force_nodes(h->fluid, h->n, h->n ? h->x[0] : NULL));
        OK(s, spar_fluid_map(h->fluid));
    }
    c->piston_here = me == ranks / 2;
    OK(s, spar_fluid_create(c->piston, "added", &c->added));
    OK(s, spar_fluid_set_force_nodes(c->added, c->piston_here, c->piston_here ? where : NULL));
    OK(s, spar_fluid_map(c->added));
    c->pushed_until = 1e9;
}

/* A stiff and viscous medium, and what nearly cancels between neighbours. */
static int push_at(scene *c, half *h, double t, double theta, int whole) {
    double x[NODES][3], v[NODES][3], f[NODES][3], moment[NODES][3];
    OK(c->session, spar_fluid_pull_motion(h->fluid, theta, h->n ? x[0] : NULL, h->n ? v[0] : NULL));
    for (int i = 0; i < h->n; i++) {
        int number = h->number[i];
        double large = (number / 2 % 2 ? 1e3 : -1e3) * (1 + 1e-3 * (number % 7)), small = 1e-6 * number;
        for (int k = 0; k < 3; k++) {
            f[i][k] = -20 * (x[i][k] - h->x[i][k]) - 3 * v[i][k] + (k == 1 ? 2 * sin(3 * t) + large : small);
            moment[i][k] = 0.1 * v[i][(k + 1) % 3];
        }
    }
    const double *force = h->n ? f[0] : NULL, *about = h->n ? moment[0] : NULL;
    return whole ? spar_fluid_push_forces(h->fluid, force, about)
                 : spar_fluid_push_forces_at(h->fluid, theta, force, about);
}

static void push_half(scene *c, half *h, double t, double dt) {
    int whole = c->parts == 0 || (int)(t / dt + 0.5) % 3 == 1, parts = whole ? 1 : c->parts;
    for (int k = 1; k <= parts; k++) {
        double theta = (double)k / parts;
        OK(c->session, push_at(c, h, t + theta * dt, theta, whole));
    }
}

static int solve(spar_session *s, double t, double dt, int iteration, void *context) {
    scene *c = context;
    double q[7], a[6], piston[3];
    (void)iteration;
    push_half(c, c->half, t, dt);
    if (t < c->pushed_until) {
        push_half(c, c->half + 1, t, dt);
    }
    OK(s, spar_member_get_motion(c->piston, q, NULL, a));
    for (int k = 0; k < 3; k++) {
        piston[k] = -1.5 * a[k] - 10 * q[k] + (k == 0);
    }
    return spar_fluid_push_forces(c->added, c->piston_here ? piston : NULL, NULL);
}

enum { STATE = 19 * POINTS + 25 + 6 * POINTS + 2 };

static void same_bits(const scene *a, const scene *b) {
    double x[2][STATE];
    for (int i = 0; i < 2; i++) {
        const scene *c = i ? b : a;
        double *out = x[i];
        OK(c->session, spar_member_get_motion(c->beam, out, out + 7 * POINTS, out + 13 * POINTS));
        out += 19 * POINTS;
        OK(c->session, spar_member_get_motion(c->piston, out, out + 7, out + 13));
        OK(c->session, spar_member_get_reaction(c->beam, out + 19));
        OK(c->session, spar_member_get_loads(c->beam, out + 25));
        OK(c->session, spar_session_get_residual(c->session, out + 25 + 6 * POINTS, out + 26 + 6 * POINTS));
    }
    assert_memory_equal(x[0], x[1], sizeof x[0]);
}

static void advance(scene *c, int steps, int *iterations) {
    for (int i = 0; i < steps; i++) {
        OK(c->session, spar_step(c->session, 0.02, solve, c, iterations + i));
    }
}

/* Loads at t = 0, odd numbers of them on each node of the line. */
static void push_first(scene *c) {
    for (int k = 0; k < 2; k++) {
        OK(c->session, push_at(c, c->half + k, 0, 1, 1));
    }
}

static void same_as_alone(void **state) {
    (void)state;
    const MPI_Comm world = MPI_COMM_WORLD;
    int turns[2][STEPS];
    for (int scheme = SPAR_COUPLING_EXPLICIT; scheme <= SPAR_COUPLING_IQN_ILS; scheme++) {
        scene alone;
        create(&alone, NULL, IN_TURN, scheme);
        advance(&alone, STEPS, turns[0]);
        for (int deal = scheme == SPAR_COUPLING_EXPLICIT ? 0 : scheme % 2; deal < DEALS; deal += scheme ? 2 : 1) {
            scene all;
            create(&all, &world, deal, scheme);
            advance(&all, STEPS, turns[1]);
            assert_memory_equal(turns[0], turns[1], sizeof turns[0]);
            same_bits(&all, &alone);
            spar_session_destroy(&all.session);
        }
        spar_session_destroy(&alone.session);
    }
}

/* Saved by all ranks but the last, resumed by all, with the nodes elsewhere (so 2 and 3 ranks on 3); one fluid pushes
   no more then, and its loads are those of the file. Expected: the run of
   one process that was not interrupted. */
static void resume(int scheme, int parts) {
    const MPI_Comm world = MPI_COMM_WORLD;
    MPI_Comm few;
    int turns[STEPS], in = size == 1 || rank < size - 1;
    char file[32];
    scene alone, all;
    snprintf(file, sizeof file, "mpi_sums_%d.spar", size);
    MPI_Comm_split(world, in, rank, &few);
    create(&alone, NULL, IN_TURN, scheme);
    alone.pushed_until = 0.02 * (STEPS / 2) - 0.01;
    alone.parts = parts;
    advance(&alone, STEPS, turns);
    if (in) {
        scene first;
        create(&first, &few, AT_RANDOM, scheme);
        first.parts = parts;
        advance(&first, STEPS / 2, turns);
        OK(first.session, spar_session_save(first.session, file));
        spar_session_destroy(&first.session);
    }
    MPI_Barrier(world);
    create(&all, &world, ONE_EACH, scheme);
    all.pushed_until = alone.pushed_until;
    all.parts = parts;
    OK(all.session, spar_session_load(all.session, file));
    advance(&all, STEPS - STEPS / 2, turns);
    same_bits(&all, &alone);
    spar_session_destroy(&all.session);
    spar_session_destroy(&alone.session);
    MPI_Comm_free(&few);
    MPI_Barrier(world);
    if (rank == 0) {
        remove(file);
    }
}

static void resumed_on_other_ranks(void **state) {
    (void)state;
    for (int scheme = SPAR_COUPLING_EXPLICIT; scheme <= SPAR_COUPLING_IQN_ILS; scheme++) {
        resume(scheme, 0);
    }
}

/* Loads over three parts of a step, of which (T13) halves some; what was pushed before the first step and in every
   third one is of the whole step. The bits of one process; the run is another than that of whole steps, and is resumed.
 */
static void parts_of_a_step(void **state) {
    (void)state;
    const MPI_Comm world = MPI_COMM_WORLD;
    int turns[2][STEPS];
    for (int scheme = SPAR_COUPLING_EXPLICIT; scheme <= SPAR_COUPLING_IQN_ILS; scheme += SPAR_COUPLING_IQN_ILS) {
        scene alone, whole;
        create(&alone, NULL, IN_TURN, scheme);
        create(&whole, NULL, IN_TURN, scheme);
        alone.parts = 3;
        push_first(&alone);
        push_first(&whole);
        advance(&alone, STEPS, turns[0]);
        advance(&whole, STEPS, turns[1]);
        double q[2][7 * POINTS];
        OK(alone.session, spar_member_get_motion(alone.beam, q[0], NULL, NULL));
        OK(whole.session, spar_member_get_motion(whole.beam, q[1], NULL, NULL));
        assert_memory_not_equal(q[0], q[1], sizeof q[0]);
        for (int deal = 0; deal < DEALS; deal++) {
            scene all;
            create(&all, &world, deal, scheme);
            all.parts = 3;
            push_first(&all);
            advance(&all, STEPS, turns[1]);
            assert_memory_equal(turns[0], turns[1], sizeof turns[0]);
            same_bits(&all, &alone);
            spar_session_destroy(&all.session);
        }
        spar_session_destroy(&alone.session);
        spar_session_destroy(&whole.session);
        resume(scheme, 3);
    }
}

/* With other nodes, or other elements too, in the middle of a run in which one fluid on the beam has fallen silent: its
   loads go over, whoever had them, and the run has the bits of one process. So have the errors that trials on as many
   nodes find. */
static void other_nodes(void **state) {
    (void)state;
    const MPI_Comm world = MPI_COMM_WORLD;
    int turns[STEPS];
    for (int parts = 0; parts <= 3; parts += 3) {
        for (int deal = -1; deal < DEALS; deal += parts ? AT_RANDOM + 1 : 1) { /* -1: alone */
            static double before[7], q[7 * POINTS], loads[6 * POINTS], error[TRY_LOAD + 1];
            double tip[7], x[7 * POINTS], y[6 * POINTS], report[TRY_COUNT];
            int64_t n;
            scene c;
            create(&c, deal < 0 ? NULL : &world, deal < 0 ? IN_TURN : deal, SPAR_COUPLING_IQN_ILS);
            c.parts = parts;
            c.pushed_until = 0.02 * 2 - 0.01;
            advance(&c, 3, turns);
            OK(c.session, trial_run(c.session, 0.02, 8, NULL, solve, &c, 0, report));
            OK(c.session, trial_run(c.session, 0.01, 16, NULL, solve, &c, 1, report));
            scene_tip(c.beam, tip);
            OK(c.session, trial_give_elements(c.session, c.beam, parts ? 3 : 2, parts ? 3 : 4));
            OK(c.session, spar_member_get_count(c.beam, &n));
            assert_int_equal(n, parts ? 9 : 8);
            advance(&c, 3, turns);
            OK(c.session, spar_member_get_motion(c.beam, x, NULL, NULL));
            OK(c.session, spar_member_get_loads(c.beam, y));
            if (deal < 0) {
                memcpy(before, tip, sizeof tip);
                memcpy(q, x, 7 * (size_t)n * sizeof *x);
                memcpy(loads, y, 6 * (size_t)n * sizeof *y);
                memcpy(error, report, sizeof error);
                assert_true(error[TRY_MOTION] > 0);
            }
            assert_memory_equal(error, report, sizeof error);
            assert_memory_equal(before, tip, sizeof tip);
            assert_memory_equal(q, x, 7 * (size_t)n * sizeof *x);
            assert_memory_equal(loads, y, 6 * (size_t)n * sizeof *y);
            spar_session_destroy(&c.session);
        }
    }
}

/* Where one rank has a fluid that the others have not, its sums would be nobody's: refused on all, and the run goes on
   with the nodes and the bits that it had. */
static void other_nodes_and_fluids(void **state) {
    (void)state;
    const MPI_Comm world = MPI_COMM_WORLD;
    int turns[STEPS];
    int64_t n;
    scene alone, all;
    spar_fluid *mine;
    create(&alone, NULL, IN_TURN, SPAR_COUPLING_IQN_ILS);
    create(&all, &world, IN_TURN, SPAR_COUPLING_IQN_ILS);
    if (rank == 0) {
        OK(all.session, spar_fluid_create(all.beam, "mine", &mine));
    }
    advance(&alone, 3, turns);
    advance(&all, 2, turns);
    if (size > 1) {
        REFUSED(all.session, SPAR_ERR_COMM, "list of fluids", trial_give_elements(all.session, all.beam, 2, 4));
    }
    OK(all.session, spar_member_get_count(all.beam, &n));
    assert_int_equal(n, POINTS);
    advance(&all, 1, turns);
    same_bits(&all, &alone);
    spar_session_destroy(&all.session);
    spar_session_destroy(&alone.session);
}

/* In the middle of a run, and off again: the run goes on; switched on by one rank alone it is refused on all. */
static void switched_between_steps(void **state) {
    (void)state;
    const MPI_Comm world = MPI_COMM_WORLD;
    int turns[STEPS];
    scene all;
    create(&all, &world, IN_TURN, SPAR_COUPLING_FIXED_POINT);
    for (int i = 0; i < STEPS; i++) {
        OK(all.session, spar_session_set_reproducible(all.session, i % 3 != 0));
        advance(&all, 1, turns);
    }
    OK(all.session, spar_session_set_reproducible(all.session, rank == size - 1));
    int status = spar_step_begin(all.session, 0.02);
    assert_int_equal(status, size == 1 ? SPAR_OK : SPAR_ERR_COMM);
    spar_session_destroy(&all.session);
}

/* What the coupling and the members have learned of the fluid has the same bits too, and so has what follows from it.
 */
static void learned_alike(void **state) {
    (void)state;
    const MPI_Comm world = MPI_COMM_WORLD;
    int turns[2][3 * STEPS];
    scene alone, all;
    learns = 1;
    create(&alone, NULL, IN_TURN, SPAR_COUPLING_IQN_ILS);
    advance(&alone, 3 * STEPS, turns[0]);
    for (int deal = 0; deal < DEALS; deal++) {
        create(&all, &world, deal, SPAR_COUPLING_IQN_ILS);
        advance(&all, 3 * STEPS, turns[1]);
        assert_memory_equal(turns[0], turns[1], sizeof turns[0]);
        same_bits(&all, &alone);
        for (int k = 0; k < 2; k++) {
            const spar_member *m[2] = {k ? alone.piston : alone.beam, k ? all.piston : all.beam};
            double spread[2], mass[2][36], report[2][SPAR_REPORT_COUNT];
            for (int i = 0; i < 2; i++) {
                OK(alone.session, spar_member_get_learned_added_mass(m[i], NULL, spread + i, NULL, 1, NULL, mass[i]));
                OK(alone.session,
                   spar_session_get_report(i ? all.session : alone.session, SPAR_REPORT_COUNT, report[i]));
            }
            assert_true(mass[0][0] != 0);
            assert_memory_equal(spread, spread + 1, sizeof *spread);
            assert_memory_equal(mass[0], mass[1], sizeof mass[0]);
            assert_memory_equal(report[0], report[1], sizeof report[0]);
        }
        spar_session_destroy(&all.session);
    }
    spar_session_destroy(&alone.session);
    learns = 0;
}

int main(int argc, char **argv) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(learned_alike),
        cmocka_unit_test(same_as_alone),
        cmocka_unit_test(resumed_on_other_ranks),
        cmocka_unit_test(parts_of_a_step),
        cmocka_unit_test(other_nodes),
        cmocka_unit_test(other_nodes_and_fluids),
        cmocka_unit_test(switched_between_steps),
    };
    return RANKS_RUN(argc, argv, tests);
}
