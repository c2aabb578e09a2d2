/* A farm of turbines: one session per turbine, each on a communicator of its own (docs/evidence/scaling.md). Each
   turbine of a farm must have the bits of the same turbine alone in a session without MPI, with reproducible sums, on
   a communicator of one rank and of several. With plain sums it must have the bits of the same run on the same
   communicator without the other turbine. A failure in one turbine must leave the other turbine as it is. */
#include "scene.h"

#include "ranks.h"
#include <spar/spar_mpi.h>
#include <stdio.h>

enum { NODES = 11, POINTS = 5, STEPS = 6, TURBINES = 2 };
enum { TOWER, BLADE, COUNTERWEIGHT, MAST, MEMBERS };
enum { HALVES, FIRST_ALONE, IN_TURN, SHARED, SPLITS }; /* how the ranks are divided over the turbines */

/* What differs from turbine to turbine. */
static const struct {
    int scheme, steps;
    double dt, speed, gust;
} kind[TURBINES] = {{SPAR_COUPLING_IQN_ILS, STEPS, 0.02, 3, 5}, {SPAR_COUPLING_AITKEN, STEPS - 2, 0.03, 2, 7}};

typedef struct turbine {
    int k, nan_at, calls; /* which turbine; the call of its fluid solver in which this rank pushes NaN; calls so far */
    MPI_Comm comm;        /* MPI_COMM_NULL: this rank is not in it, or the session has no communicator */
    spar_session *session;
    spar_member *member[MEMBERS];
    spar_joint *shaft;
    spar_fluid *fluid[2]; /* on the blade and on the mast */
    int n, number[NODES]; /* this rank's nodes of each fluid */
    double x[2][NODES][3];
    int iterations[STEPS];
} turbine;

static spar_member *beam(spar_session *s, const char *name, const double from[3], const double to[3]) {
    const double eta[2] = {0, 1}, line[6] = {from[0], from[1], from[2], to[0], to[1], to[2]};
    double K[36], M[36];
    spar_member *b = NULL;
    scene_diagonal(K, 4e4, 4e4, 4e4, 800, 600, 600);
    scene_diagonal(M, 1, 1, 1, 0.02, 0.01, 0.01);
    OK(s, spar_beam_create(s, name, 1, POINTS, &b));
    OK(s, spar_beam_set_axis(b, 2, eta, line, NULL));
    OK(s, spar_beam_set_sections(b, 1, eta, K, M));
    return b;
}

/* A tower whose top carries a blade and a counterweight on a driven shaft, and a mast beside it. */
static void describe(turbine *t) {
    static const double foot[3] = {0, 0, 0}, hub[3] = {0, 0, 6}, tip[3] = {0, 4, 6}, behind[3] = {0, -1, 6},
                        ground[3] = {9, 0, 0}, top[3] = {9, 0, 5}, gravity[3] = {0, 0, -2}, J[3] = {0.1, 0.1, 0.1};
    spar_session *s = t->session;
    OK(s, spar_session_set_gravity(s, gravity));
    OK(s, spar_session_set_coupling(s, kind[t->k].scheme, 0, 1e-8, 60));
    t->member[TOWER] = beam(s, "tower", foot, hub);
    t->member[BLADE] = beam(s, "blade", hub, tip);
    t->member[MAST] = beam(s, "mast", ground, top);
    OK(s, spar_member_set_root(t->member[BLADE], SPAR_ROOT_FREE));
    OK(s, spar_member_commit(t->member[TOWER]));
    OK(s, spar_member_commit(t->member[BLADE]));
    OK(s, spar_member_commit(t->member[MAST]));
    t->member[COUNTERWEIGHT] = scene_body(s, "counterweight", behind, 3 + t->k, J);
    t->shaft = scene_joint_at(s, "shaft", t->member[BLADE], 0, t->member[TOWER], POINTS - 1, SPAR_FREE_RX, hub);
    OK(s, spar_joint_set_driven(t->shaft, SPAR_FREE_RX));
    (void)scene_joint_at(s, "weld", t->member[COUNTERWEIGHT], 0, t->member[BLADE], 0, 0, behind);
}

/* comm MPI_COMM_NULL: a session without MPI. */
static void create(turbine *t, int k, MPI_Comm comm, int reproducible) {
    static const double root[2][3] = {{0.1, 0, 6}, {9.1, 0, 0}}, way[2][3] = {{0, 4, 0}, {0, 0, 5}};
    int me = 0, ranks = 1;
    *t = (turbine){.k = k, .comm = comm};
    if (comm == MPI_COMM_NULL) {
        OK(NULL, spar_session_create(&t->session));
    } else {
        MPI_Comm_rank(comm, &me);
        MPI_Comm_size(comm, &ranks);
        OK(NULL, spar_session_create_mpi(comm, &t->session));
    }
    spar_session *s = t->session;
    OK(s, spar_session_set_reproducible(s, reproducible));
    describe(t);
    for (int i = me; i < NODES; i += ranks) {
        t->number[t->n] = i;
        for (int f = 0; f < 2; f++) {
            for (int j = 0; j < 3; j++) {
                t->x[f][t->n][j] = root[f][j] + way[f][j] * i / (NODES - 1);
            }
        }
        t->n++;
    }
    for (int f = 0; f < 2; f++) {
        const double *x = t->n ? t->x[f][0] : NULL;
        OK(s, spar_fluid_create(t->member[f ? MAST : BLADE], f ? "wind" : "air", &t->fluid[f]));
        OK(s, spar_fluid_set_motion_nodes(t->fluid[f], t->n, x));
        OK(s, spar_fluid_set_force_nodes(t->fluid[f], t->n, x));
        OK(s, spar_fluid_map(t->fluid[f]));
    }
}

/* A viscous medium that pushes each node by its number. */
static int solve(spar_session *s, double time, double dt, int iteration, void *context) {
    turbine *t = context;
    double v[NODES][3], force[NODES][3];
    (void)iteration;
    t->calls++;
    for (int f = 0; f < 2; f++) {
        OK(s, spar_fluid_pull_motion(t->fluid[f], 1, NULL, t->n ? v[0] : NULL));
        for (int i = 0; i < t->n; i++) {
            for (int j = 0; j < 3; j++) {
                force[i][j] = -0.4 * v[i][j] + 0.3 * (j == f) * sin(kind[t->k].gust * (time + dt) + t->number[i]);
            }
        }
        if (t->calls == t->nan_at && t->n) {
            force[0][0] = NAN;
        }
        (void)spar_fluid_push_forces(t->fluid[f], t->n ? force[0] : NULL, NULL);
    }
    return 0;
}

static void drive(turbine *t, int i) {
    double now = (i + 1) * kind[t->k].dt, motion[6] = {0}, rate[6] = {0};
    motion[3] = kind[t->k].speed * now, rate[3] = kind[t->k].speed;
    OK(t->session, spar_joint_drive(t->shaft, motion, rate, NULL));
}

/* Step i, from t = i dt. */
static int step(turbine *t, int i) {
    drive(t, i);
    return spar_step(t->session, kind[t->k].dt, solve, t, &t->iterations[i]);
}

static void advance(turbine *t, int from, int to) {
    for (int i = from; i < to && i < kind[t->k].steps; i++) {
        OK(t->session, step(t, i));
    }
}

enum { STATE = MEMBERS * 25 * POINTS + 18 + 2 };

static void look(const turbine *t, double out[STATE]) {
    memset(out, 0, STATE * sizeof *out);
    for (int k = 0; k < MEMBERS; k++, out += 25 * POINTS) {
        OK(t->session, spar_member_get_motion(t->member[k], out, out + 7 * POINTS, out + 13 * POINTS));
        OK(t->session, spar_member_get_loads(t->member[k], out + 19 * POINTS));
    }
    OK(t->session, spar_joint_get_motion(t->shaft, out, out + 6, NULL));
    OK(t->session, spar_joint_get_load(t->shaft, out + 12));
    OK(t->session, spar_session_get_residual(t->session, out + 18, out + 19));
}

/* To the bit. */
static void same(const turbine *a, const turbine *b) {
    double x[STATE], y[STATE];
    look(a, x);
    look(b, y);
    assert_memory_equal(x, y, sizeof x);
    assert_memory_equal(a->iterations, b->iterations, sizeof a->iterations);
}

static void same_as_without_mpi(const turbine *t) {
    turbine alone;
    create(&alone, t->k, MPI_COMM_NULL, 1);
    advance(&alone, 0, STEPS);
    same(t, &alone);
    spar_session_destroy(&alone.session);
}

/* Whether this rank is in turbine k, where all ranks are divided over the turbines, or each rank is in both. */
static int is_in(int split, int k) {
    return split == SHARED || k == (split == HALVES ? 2 * rank >= size : split == FIRST_ALONE ? rank > 0 : rank % 2);
}

/* The recipe: split, then one session for each of this rank's turbines. One rank alone has both turbines. */
static int create_farm(turbine t[TURBINES], int split, int reproducible) {
    int n = 0;
    for (int k = 0; k < TURBINES; k++) {
        MPI_Comm comm;
        int in = size == 1 || is_in(split, k);
        MPI_Comm_split(MPI_COMM_WORLD, in ? 0 : MPI_UNDEFINED, rank, &comm);
        if (in) {
            create(&t[n++], k, comm, reproducible);
        }
    }
    return n;
}

static void destroy_farm(turbine *t, int n) {
    for (int i = 0; i < n; i++) {
        spar_session_destroy(&t[i].session);
        MPI_Comm_free(&t[i].comm);
    }
}

/* A rank that has several turbines takes their steps in the order of the turbines, as all ranks do. */
static void advance_farm(turbine *t, int n, int from, int to) {
    for (int i = from; i < to; i++) {
        for (int k = 0; k < n; k++) {
            advance(t + k, i, i + 1);
        }
    }
}

/* ---- the tests ---- */

static void each_as_without_mpi(void **state) {
    (void)state;
    for (int split = 0; split < SPLITS; split++) {
        turbine t[TURBINES];
        int n = create_farm(t, split, 1);
        advance_farm(t, n, 0, STEPS);
        for (int i = 0; i < n; i++) {
            same_as_without_mpi(t + i);
        }
        destroy_farm(t, n);
    }
}

/* Plain sums depend on the ranks. The other turbine must not matter all the same. */
static void each_as_without_the_other(void **state) {
    (void)state;
    for (int split = 0; split < SPLITS; split++) {
        turbine t[TURBINES], single;
        int n = create_farm(t, split, 0);
        advance_farm(t, n, 0, STEPS);
        for (int k = 0; k < TURBINES; k++) {
            for (int i = 0; i < n; i++) {
                if (t[i].k == k) {
                    create(&single, k, t[i].comm, 0);
                    advance(&single, 0, STEPS);
                    same(t + i, &single);
                    spar_session_destroy(&single.session);
                }
            }
            MPI_Barrier(MPI_COMM_WORLD);
        }
        destroy_farm(t, n);
    }
}

/* Turbine 1 fails in a step on one rank, which only the ranks of turbine 1 are told, and takes the step again. */
static void a_failure_stays_in_its_turbine(void **state) {
    (void)state;
    for (int split = 0; split < SPLITS; split++) {
        turbine t[TURBINES];
        int n = create_farm(t, split, 1);
        advance_farm(t, n, 0, 2);
        for (int i = 0; i < n; i++) {
            int me;
            MPI_Comm_rank(t[i].comm, &me);
            if (t[i].k == 1) {
                t[i].nan_at = me == 0 ? t[i].calls + 1 : 0;
                assert_int_equal(step(t + i, 2), me == 0 ? SPAR_ERR_ARGUMENT : SPAR_ERR_PEER);
            }
        }
        advance_farm(t, n, 2, STEPS);
        for (int i = 0; i < n; i++) {
            same_as_without_mpi(t + i);
        }
        destroy_farm(t, n);
    }
}

static void begin_step(turbine *t, int i) {
    drive(t, i);
    OK(t->session, spar_step_begin(t->session, kind[0].dt));
}

/* Solution, fluid and check. Returns whether the step is done. */
static int iterate(turbine *t) {
    int done = 0;
    OK(t->session, spar_step_solve(t->session));
    assert_int_equal(solve(t->session, 0, kind[0].dt, 0, t), 0);
    OK(t->session, spar_step_check(t->session, &done));
    return done;
}

/* One flow solver serves all turbines: all of them iterate until the step of each turbine is done. */
static void one_flow_solver(void **state) {
    (void)state;
    for (int split = 0; split < SPLITS; split++) {
        turbine t[TURBINES];
        int n = create_farm(t, split, 1), turns[2] = {0, 0};
        for (int i = 0; i < 2; i++) {
            for (int k = 0; k < n; k++) {
                begin_step(t + k, i);
            }
            for (int all = 0; !all; turns[i]++) {
                int done = 1;
                for (int k = 0; k < n; k++) {
                    done = iterate(t + k) && done;
                }
                MPI_Allreduce(&done, &all, 1, MPI_INT, MPI_MIN, MPI_COMM_WORLD);
            }
            for (int k = 0; k < n; k++) {
                OK(t[k].session, spar_step_accept(t[k].session));
            }
        }
        for (int k = 0; k < n; k++) {
            turbine alone;
            create(&alone, t[k].k, MPI_COMM_NULL, 1);
            for (int i = 0; i < 2; i++) {
                begin_step(&alone, i);
                for (int turn = 0; turn < turns[i]; turn++) {
                    (void)iterate(&alone);
                }
                OK(alone.session, spar_step_accept(alone.session));
            }
            same(t + k, &alone);
            spar_session_destroy(&alone.session);
        }
        destroy_farm(t, n);
    }
}

/* One turbine ends before the other. */
static void one_ends_first(void **state) {
    (void)state;
    turbine t[TURBINES];
    int n = create_farm(t, SHARED, 1);
    advance_farm(t, n, 0, 2);
    destroy_farm(t + 1, 1);
    advance(t, 2, STEPS);
    same_as_without_mpi(t);
    destroy_farm(t, 1);
}

/* One file per turbine; the ranks are divided otherwise after the restart. */
static void saved_and_loaded(void **state) {
    (void)state;
    for (int split = 0; split < SPLITS; split++) {
        turbine t[TURBINES];
        char file[32];
        int n = create_farm(t, split, 1);
        advance_farm(t, n, 0, 2);
        for (int i = 0; i < n; i++) {
            (void)snprintf(file, sizeof file, "mpi_farm_%d_%d.spar", size, t[i].k);
            OK(t[i].session, spar_session_save(t[i].session, file));
        }
        destroy_farm(t, n);
        MPI_Barrier(MPI_COMM_WORLD);
        n = create_farm(t, (split + 1) % SPLITS, 1);
        for (int i = 0; i < n; i++) {
            turbine whole;
            (void)snprintf(file, sizeof file, "mpi_farm_%d_%d.spar", size, t[i].k);
            OK(t[i].session, spar_session_load(t[i].session, file));
            advance(t + i, 2, STEPS);
            create(&whole, t[i].k, MPI_COMM_NULL, 1);
            advance(&whole, 0, STEPS);
            memcpy(t[i].iterations, whole.iterations, 2 * sizeof *t[i].iterations); /* of the steps before the file */
            same(t + i, &whole);
            spar_session_destroy(&whole.session);
        }
        destroy_farm(t, n);
        MPI_Barrier(MPI_COMM_WORLD);
        for (int k = 0; k < TURBINES && rank == 0; k++) {
            (void)snprintf(file, sizeof file, "mpi_farm_%d_%d.spar", size, k);
            remove(file);
        }
        MPI_Barrier(MPI_COMM_WORLD);
    }
}

int main(int argc, char **argv) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(each_as_without_mpi),
                                       cmocka_unit_test(each_as_without_the_other),
                                       cmocka_unit_test(a_failure_stays_in_its_turbine),
                                       cmocka_unit_test(one_flow_solver),
                                       cmocka_unit_test(one_ends_first),
                                       cmocka_unit_test(saved_and_loaded)};
    return RANKS_RUN(argc, argv, tests);
}
