/* Who solves what: members go to the rank that has least to do, the dearest first. Expected: the rule of the longest
   processing time first, worked out here from what spar_session_sum_balance says of each member by itself; no rank has
   more than 2 - 1/R of the mean, or of the dearest member where that is more (Graham 1966, any list); the same steps as
   in a session of this process alone, to the last bit; owners that the host gives stand, ranks without fluid nodes
   solve too. */
#include "scene.h"

#include "ranks.h"
#include <spar/spar_mpi.h>
#include <stdio.h>

enum { MEMBERS = 9, TIED = 2, STEPS = 3, MOST = 64, POINTS = 12 };

/* Nodes of the members: rigid bodies are 1. Unequal, and not in order. */
static const int nodes_of[MEMBERS] = {3, 12, 1, 6, 4, 9, 1, 5, 7};

static spar_member *create_member(spar_session *s, int i, int given) {
    static const double q[4] = {1, 0, 0, 0}, centre[3] = {0, 0, 0}, J[3] = {1, 2, 3};
    double K[36], M[36], mass[36], where[3] = {0, i, 0};
    char name[8];
    spar_member *m = NULL;
    snprintf(name, sizeof name, "m%d", i);
    if (nodes_of[i] == 1) {
        scene_mass(mass, 3, centre, J);
        OK(s, spar_rigid_create(s, name, where, q, mass, &m));
    } else {
        scene_box(K, M);
        m = scene_beam(s, name, 1, nodes_of[i], 10, K, M);
        OK(s, spar_member_set_root(m, SPAR_ROOT_FIXED));
        if (i == 3) {
            OK(s, spar_member_set_fidelity(m, SPAR_FIDELITY_LINEAR, 0));
        }
    }
    if (given >= 0) {
        OK(s, spar_member_set_owner(m, given));
    }
    OK(s, spar_member_commit(m));
    return m;
}

/* given: the owner of the first member, -1: none. The last TIED members hang on a spring, if tied. */
static spar_session *create(const MPI_Comm *comm, int given, int tied, spar_member *member[MEMBERS]) {
    spar_session *s = NULL;
    const double gravity[3] = {0, 0, -2};
    if (comm) {
        OK(NULL, spar_session_create_mpi(*comm, &s));
    } else {
        OK(NULL, spar_session_create(&s));
    }
    OK(s, spar_session_set_gravity(s, gravity));
    for (int i = 0; i < MEMBERS; i++) {
        member[i] = create_member(s, i, comm && i == 0 ? given : -1);
    }
    if (tied) {
        static const double tip[3] = {10, 0, 0}, beside[3] = {10, 1, 0};
        spar_joint *spring = NULL;
        OK(s, spar_link_create(s, "spring", member[MEMBERS - 1], nodes_of[MEMBERS - 1] - 1, tip, member[MEMBERS - 2],
                               nodes_of[MEMBERS - 2] - 1, beside, &spring));
        OK(s, spar_link_set_spring(spring, 5, 0.1, 1, 0));
    }
    return s;
}

/* What a member by itself is expected to take: of a session that has it alone. */
static double expected_of(int i) {
    spar_session *s = scene_session();
    double expected[1] = {0};
    (void)create_member(s, i, -1);
    OK(s, spar_session_sum_balance(s, 1, NULL, expected, NULL));
    spar_session_destroy(&s);
    return expected[0];
}

static void same_motion(spar_member *const a[MEMBERS], spar_member *const b[MEMBERS]) {
    for (int i = 0; i < MEMBERS; i++) {
        double x[2][19 * POINTS] = {{0}};
        for (int k = 0; k < 2; k++) {
            const spar_member *m = k ? b[i] : a[i];
            int n = nodes_of[i];
            assert_int_equal(spar_member_get_motion(m, x[k], x[k] + 7 * n, x[k] + 13 * n), SPAR_OK);
        }
        assert_memory_equal(x[0], x[1], sizeof x[0]);
    }
}

/* Longest first to the least busy, of equals the first; the member of the host's owner counts beforehand. */
static void spread(const double cost[MEMBERS], int given, int owner[MEMBERS], double busy[MOST]) {
    memset(busy, 0, MOST * sizeof *busy);
    for (int i = 0; i < MEMBERS; i++) {
        owner[i] = -1;
    }
    if (given >= 0) {
        owner[0] = given;
        busy[given] += cost[0];
    }
    for (int turn = given >= 0; turn < MEMBERS; turn++) {
        int dearest = -1, least = 0;
        for (int i = 0; i < MEMBERS; i++) {
            dearest = owner[i] < 0 && (dearest < 0 || cost[i] > cost[dearest]) ? i : dearest;
        }
        for (int r = 1; r < size; r++) {
            least = busy[r] < busy[least] ? r : least;
        }
        owner[dearest] = least;
        busy[least] += cost[dearest];
    }
}

static void spread_by_cost(void **state) {
    (void)state;
    const MPI_Comm world = MPI_COMM_WORLD;
    double cost[MEMBERS], sum = 0, dearest = 0;
    for (int i = 0; i < MEMBERS; i++) {
        cost[i] = expected_of(i);
        assert_true(cost[i] > 0);
        sum += cost[i];
        dearest = fmax(dearest, cost[i]);
    }
    assert_true(cost[1] > cost[5] && cost[5] > cost[7] && cost[7] > cost[0] && cost[0] > cost[2]); /* exact, by nodes */
    assert_true(cost[3] < cost[7]); /* 6 nodes, linear, against 5, exact */
    for (int given = -1; given < size; given++) {
        spar_member *all[MEMBERS], *alone[MEMBERS];
        int owner[MEMBERS], got;
        double busy[MOST], expected[MOST], counted[MOST], one[1], most = 0, total = 0;
        int64_t members[MOST], count[MOST] = {0};
        spar_session *s = create(&world, given, 0, all), *t = create(NULL, -1, 0, alone);
        spread(cost, given, owner, busy);
        scene_run(s, 0.01, STEPS);
        scene_run(t, 0.01, STEPS);
        OK(s, spar_session_sum_balance(s, size, members, expected, counted));
        OK(t, spar_session_sum_balance(t, 1, NULL, NULL, one));
        for (int i = 0; i < MEMBERS; i++) {
            OK(s, spar_member_get_owner(all[i], &got));
            assert_int_equal(got, owner[i]);
            count[got]++;
        }
        for (int r = 0; r < size; r++) {
            assert_int_equal(members[r], count[r]);
            NEAR(expected[r], busy[r], 1e-9 * sum);
            most = fmax(most, expected[r]);
            total += counted[r];
        }
        assert_true(total > 0);
        NEAR(total, one[0], 1e-14 * total); /* whole numbers of iterations; the same work, wherever it is done */
        if (given < 0) {
            assert_true(most <= (2 - 1.0 / size) * fmax(sum / size, dearest)); /* any list schedule */
        }
        same_motion(all, alone);
        spar_session_destroy(&s);
        spar_session_destroy(&t);
    }
}

/* Tied members stay together and count as one, with their joint; a static solution settles owners as a step does. */
static void with_joints_and_statics(void **state) {
    (void)state;
    const MPI_Comm world = MPI_COMM_WORLD;
    spar_member *all[MEMBERS], *alone[MEMBERS];
    int owner[MEMBERS], later;
    double expected[MOST + 1], untied = 0, sum = 0;
    int64_t members[MOST + 1], count = 0;
    spar_session *s = create(&world, -1, 1, all), *t = create(NULL, -1, 1, alone);
    OK(s, spar_member_solve_static(all[1], 1));
    OK(t, spar_member_solve_static(alone[1], 1));
    for (int i = 0; i < MEMBERS; i++) {
        OK(s, spar_member_get_owner(all[i], &owner[i]));
        untied += expected_of(i);
    }
    assert_int_equal(owner[MEMBERS - 1], owner[MEMBERS - 2]);
    scene_run(s, 0.01, STEPS);
    scene_run(t, 0.01, STEPS);
    OK(s, spar_session_sum_balance(s, size + 1, members, expected, NULL));
    for (int r = 0; r < size; r++) {
        sum += expected[r];
        count += members[r];
    }
    assert_int_equal(count, MEMBERS);
    assert_true(sum > untied); /* by the joint */
    assert_true(expected[size] == 0 && members[size] == 0);
    for (int i = 0; i < MEMBERS; i++) {
        OK(s, spar_member_get_owner(all[i], &later));
        assert_int_equal(later, owner[i]);
    }
    same_motion(all, alone);
    assert_int_equal(spar_session_sum_balance(s, rank == size - 1 ? -1 : 1, members, NULL, NULL),
                     rank == size - 1 ? SPAR_ERR_ARGUMENT : SPAR_ERR_PEER);
    spar_session_destroy(&s);
    spar_session_destroy(&t);
}

/* A member that is not committed is nobody's yet. */
static void not_committed(void **state) {
    (void)state;
    spar_session *s = scene_session();
    spar_member *m = NULL;
    int64_t members[1] = {7};
    double expected[1] = {7}, counted[1] = {7};
    OK(s, spar_beam_create(s, "b", 1, 3, &m));
    OK(s, spar_session_sum_balance(s, 1, members, expected, counted));
    assert_true(members[0] == 0 && expected[0] == 0 && counted[0] == 0);
    spar_session_destroy(&s);
}

int main(int argc, char **argv) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(spread_by_cost),
        cmocka_unit_test(with_joints_and_statics),
        cmocka_unit_test(not_committed),
    };
    return RANKS_RUN(argc, argv, tests);
}
