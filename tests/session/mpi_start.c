/* The balanced start on any number of ranks, against the same on one process: two beams solved for by different ranks
   and a body hinged to one of them, in a heavy fluid whose nodes are dealt out over all ranks but the last. Numbers
   agree to 1e-9 of theirs: loads are iterated to 1e-12, of an added mass four times the beams'. Then what a single rank
   can do wrong: all are told, none waits (ctest's time limit is the witness), and all is as it was. */
#include "scene.h"

#include "ranks.h"
#include <spar/spar_mpi.h>

enum { POINTS = 5, NODES = 24, MEMBERS = 3, MOTION = 6 * (2 * POINTS + 1) };

typedef struct scene {
    spar_session *session;
    spar_member *member[MEMBERS];
    spar_joint *hinge;
    spar_fluid *fluid[2];
    int64_t n; /* this rank's nodes of each */
    int calls, bad_call, user_call;
} scene;

static void create_beam(scene *c, int k, int me, int ranks, int carriers) {
    static const double eta[2] = {0, 1};
    double K[36], M[36], xyz[6] = {0, k, 0, 4, k, 0}, x[NODES][3];
    spar_session *s = c->session;
    scene_diagonal(K, 4e3, 4e3, 4e3, 80, 60, 60);
    scene_diagonal(M, 1, 1, 1, 0.02, 0.01, 0.01);
    OK(s, spar_beam_create(s, k ? "front" : "rear", 1, POINTS, &c->member[k]));
    OK(s, spar_beam_set_axis(c->member[k], 2, eta, xyz, NULL));
    OK(s, spar_beam_set_sections(c->member[k], 1, eta, K, M));
    OK(s, spar_member_set_owner(c->member[k], k % ranks));
    OK(s, spar_member_commit(c->member[k]));
    for (int i = 0, mine = 0; i < NODES; i++) {
        double place[3] = {4.0 * i / (NODES - 1), k + 0.2, 0.1};
        if (i % carriers == me) {
            memcpy(x[mine++], place, sizeof place);
        }
    }
    OK(s, spar_fluid_create(c->member[k], "water", &c->fluid[k]));
    OK(s, spar_fluid_set_motion_nodes(c->fluid[k], c->n, c->n ? x[0] : NULL));
    OK(s, spar_fluid_set_force_nodes(c->fluid[k], c->n, c->n ? x[0] : NULL));
    OK(s, spar_fluid_map(c->fluid[k]));
}

/* Rank `me` of `ranks` gets its share of the nodes. */
static void create(scene *c, int me, int ranks) {
    static const double gravity[3] = {0, 0, -2}, centre[3] = {0.3, 0, 0}, J[3] = {1, 1, 1}, tip[3] = {4, 1, 0};
    double mass[36];
    int carriers = ranks > 1 ? ranks - 1 : 1;
    memset(c, 0, sizeof *c);
    OK(NULL, ranks > 1 ? spar_session_create_mpi(MPI_COMM_WORLD, &c->session) : spar_session_create(&c->session));
    spar_session *s = c->session;
    OK(s, spar_session_set_gravity(s, gravity));
    OK(s, spar_session_set_coupling(s, SPAR_COUPLING_EXPLICIT, 0, 1e-12, 200));
    for (int i = 0; i < NODES; i++) {
        c->n += i % carriers == me;
    }
    for (int k = 0; k < 2; k++) {
        create_beam(c, k, me, ranks, carriers);
    }
    scene_mass(mass, 2, centre, J);
    OK(s, spar_rigid_create(s, "flap", tip, NULL, mass, &c->member[2]));
    OK(s, spar_member_commit(c->member[2]));
    OK(s, spar_joint_create(s, "hinge", c->member[2], 0, c->member[1], POINTS - 1, SPAR_FREE_RY, &c->hinge));
}

static int solve(spar_session *s, double t, double dt, int iteration, void *context) {
    scene *c = context;
    (void)t, (void)iteration, (void)dt;
    c->calls++;
    for (int k = 0; k < 2; k++) {
        double a[NODES][3];
        OK(s,
           spar_fluid_pull_poses(c->fluid[k], SPAR_NODES_MOTION, 1, NULL, NULL, NULL, NULL, c->n ? a[0] : NULL, NULL));
        for (int64_t i = 0; i < c->n; i++) {
            for (int d = 0; d < 3; d++) {
                a[i][d] *= -4 * 4.0 / NODES;
            }
        }
        if (c->calls == c->bad_call && k == 1) {
            a[c->n - 1][1] = NAN;
        }
        int status = spar_fluid_push_forces(c->fluid[k], c->n ? a[0] : NULL, NULL);
        if (status != SPAR_OK && c->calls != c->bad_call) {
            return status;
        }
    }
    return c->calls == c->user_call ? 77 : 0;
}

static void look(const scene *c, double a[MOTION], double load[6]) {
    for (int k = 0; k < MEMBERS; k++) {
        OK(c->session, spar_member_get_motion(c->member[k], NULL, NULL, a + 6 * POINTS * k));
    }
    OK(c->session, spar_joint_get_load(c->hinge, load));
}

static void compare(const scene *a, const scene *b, double tolerance) {
    double x[MOTION], y[MOTION], f[6], g[6];
    look(a, x, f);
    look(b, y, g);
    for (int i = 0; i < MOTION; i++) {
        NEAR(x[i], y[i], tolerance);
    }
    for (int i = 0; i < 6; i++) {
        NEAR(f[i], g[i], tolerance);
    }
}

/* And nothing is 0 that should not be: the tip falls, and the hinge bears. */
static void as_one_process_has_it(void **state) {
    (void)state;
    scene c, alone;
    int n[2];
    double a[MOTION], load[6];
    create(&c, rank, size);
    create(&alone, 0, 1);
    OK(c.session, spar_session_solve_initial(c.session, 0.01, solve, &c, &n[0]));
    OK(alone.session, spar_session_solve_initial(alone.session, 0.01, solve, &alone, &n[1]));
    assert_int_equal(c.calls, n[0]);
    assert_true(abs(n[0] - n[1]) <= 1); /* the last one may be rounding's */
    compare(&c, &alone, 1e-8);
    look(&c, a, load);
    assert_true(a[6 * POINTS - 4] < -0.1 && fabs(load[2]) > 0.1);
    for (int i = 0; i < 2; i++) { /* without the fluid, whose mass is too much for an explicit scheme */
        OK(c.session, spar_step(c.session, 0.01, NULL, NULL, NULL));
        OK(alone.session, spar_step(alone.session, 0.01, NULL, NULL, NULL));
    }
    compare(&c, &alone, 1e-7);
    spar_session_destroy(&c.session);
    spar_session_destroy(&alone.session);
}

static int of_one(int bad, int own) {
    return rank == bad ? own : size > 1 ? SPAR_ERR_PEER : SPAR_OK;
}

static void a_failure_is_everybodys(void **state) {
    (void)state;
    scene hit, calm;
    double a[MOTION], load[6];
    create(&hit, rank, size);
    create(&calm, rank, size);
    hit.user_call = rank == size - 1 ? 3 : 0;
    int status = spar_session_solve_initial(hit.session, 0.01, solve, &hit, NULL);
    assert_int_equal(status, of_one(size - 1, SPAR_ERR_USER));
    hit.user_call = hit.calls = 0;
    hit.bad_call = rank == 0 ? 2 : 0;
    status = spar_session_solve_initial(hit.session, 0.01, solve, &hit, NULL);
    assert_int_equal(status, of_one(0, SPAR_ERR_ARGUMENT));
    hit.bad_call = 0;
    if (size > 1) {
        status = spar_session_solve_initial(hit.session, rank == 0 ? 0.01 : 0.02, solve, &hit, NULL);
        assert_int_equal(status, SPAR_ERR_COMM);
    }
    look(&hit, a, load);
    assert_true(a[6 * POINTS - 4] == 0 && load[2] == 0);
    OK(hit.session, spar_session_solve_initial(hit.session, 0.01, solve, &hit, NULL));
    OK(calm.session, spar_session_solve_initial(calm.session, 0.01, solve, &calm, NULL));
    compare(&hit, &calm, 0);
    spar_session_destroy(&hit.session);
    spar_session_destroy(&calm.session);
}

int main(int argc, char **argv) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(as_one_process_has_it),
        cmocka_unit_test(a_failure_is_everybodys),
    };
    return RANKS_RUN(argc, argv, tests);
}
