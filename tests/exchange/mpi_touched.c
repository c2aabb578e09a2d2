/* Ranks that know what they touch and no more (option ranks.state = touched). A beam and a rigid body that a spring
   ties to its tip, which are solved as one, and a piston by itself; the beam's fluid nodes lie on the ranks that a deal
   names, the piston's on one. Expected: the bits of the same run in a session of this process alone, with reproducible
   sums, on every rank that knows a member (it solves something, or its fluids have nodes on it); a refusal on the
   others; 1e-13 of the largest value without reproducible sums. Failures are told to all ranks, and the run goes on as
   if they had not been. */
#include "scene.h"

#include "ranks.h"
#include <spar/spar_mpi.h>
#include <stdio.h>

enum { NODES = 23, STEPS = 4, POINTS = 6, MEMBERS = 3 };
enum { ON_ALL, ON_LAST, ON_FIRST_HALF, DEALS };
enum { BEAM, BODY, PISTON };

/* ---- data of more than a status that this rank gives or gets, by the calls of MPI itself ---- */

static double data_bytes;

static void count_data(int n, MPI_Datatype type) {
    int width;
    PMPI_Type_size(type, &width);
    data_bytes += (double)n * width > 64 ? (double)n * width : 0;
}

int MPI_Allreduce(const void *from, void *to, int n, MPI_Datatype type, MPI_Op op, MPI_Comm comm) {
    count_data(n, type);
    return PMPI_Allreduce(from, to, n, type, op, comm);
}

int MPI_Reduce(const void *from, void *to, int n, MPI_Datatype type, MPI_Op op, int root, MPI_Comm comm) {
    count_data(n, type);
    return PMPI_Reduce(from, to, n, type, op, root, comm);
}

int MPI_Bcast(void *x, int n, MPI_Datatype type, int root, MPI_Comm comm) {
    count_data(n, type);
    return PMPI_Bcast(x, n, type, root, comm);
}

int MPI_Ireduce(const void *from, void *to, int n, MPI_Datatype type, MPI_Op op, int root, MPI_Comm comm,
                MPI_Request *request) {
    count_data(n, type);
    return PMPI_Ireduce(from, to, n, type, op, root, comm, request);
}

int MPI_Ibcast(void *x, int n, MPI_Datatype type, int root, MPI_Comm comm, MPI_Request *request) {
    count_data(n, type);
    return PMPI_Ibcast(x, n, type, root, comm, request);
}

int MPI_Allgatherv(const void *from, int n, MPI_Datatype of, void *to, const int counts[], const int offsets[],
                   MPI_Datatype type, MPI_Comm comm) {
    count_data(1000, type);
    return PMPI_Allgatherv(from, n, of, to, counts, offsets, type, comm);
}

/* ---- the scene ---- */

typedef struct scene {
    spar_session *session;
    spar_member *member[MEMBERS];
    spar_joint *spring;
    spar_fluid *on_beam, *on_piston;
    int n, number[NODES], piston_here;
    double x[NODES][3];
    int resumed;                /* a rank may know a member for the loads that it has from the file */
    int nan_at, user_at, calls; /* this rank fails in that call of its fluid solver */
} scene;

static int learns; /* the added mass of the beam, at one station, and of the piston */

static int owner_of(int i, int deal, int ranks) {
    return deal == ON_ALL ? i % ranks : deal == ON_LAST ? ranks - 1 : i % ((ranks + 1) / 2);
}

static void place_of(int i, double x[3]) {
    x[0] = 10.0 * i / (NODES - 1), x[1] = 0.2 * cos(0.9 * i), x[2] = 0.2 * sin(0.9 * i);
}

static spar_member *create_body(spar_session *s, const char *name, const double where[3], double m, int learn) {
    static const double q[4] = {1, 0, 0, 0}, centre[3] = {0, 0, 0}, J[3] = {1, 2, 3};
    double mass[36];
    spar_member *body = NULL;
    scene_mass(mass, m, centre, J);
    OK(s, spar_rigid_create(s, name, where, q, mass, &body));
    OK(s, spar_member_learn_added_mass(body, learn, NULL));
    OK(s, spar_member_commit(body));
    return body;
}

/* Rank 0 solves beam and body, the second rank, if there is one, the piston; the others none. */
static void create_members(scene *c, int ranks) {
    static const double tip[3] = {10, 0, 0}, beyond[3] = {12, 0, 0}, aside[3] = {0, 5, 0};
    const double root[1] = {0};
    double K[36], M[36];
    spar_session *s = c->session;
    scene_box(K, M);
    c->member[BEAM] = scene_beam(s, "beam", 1, POINTS, 10, K, M);
    OK(s, spar_member_set_effects(c->member[BEAM], SPAR_EFFECT_DEFAULT | SPAR_EFFECT_WORK));
    OK(s, spar_member_set_owner(c->member[BEAM], 0));
    OK(s, spar_member_learn_added_mass(c->member[BEAM], learns, root));
    OK(s, spar_member_commit(c->member[BEAM]));
    c->member[BODY] = create_body(s, "body", beyond, 2, 0);
    c->member[PISTON] = create_body(s, "piston", aside, 3, learns);
    OK(s, spar_line_create(s, "spring", c->member[BEAM], POINTS - 1, tip, c->member[BODY], 0, beyond, &c->spring));
    OK(s, spar_line_set_spring(c->spring, 50, 0.5, 2, 0));
    (void)ranks;
}

/* comm NULL: this process alone. */
static void create(scene *c, const MPI_Comm *comm, int deal, int scheme, int reproducible) {
    static const double aside[3] = {0, 5, 0};
    double gravity[3] = {0, 0, -2};
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
    OK(s, spar_session_set_option(s, "ranks.state", comm ? "touched" : "all"));
    OK(s, spar_session_set_reproducible(s, reproducible));
    OK(s, spar_session_set_gravity(s, gravity));
    OK(s, spar_session_set_coupling(s, scheme, 0, 1e-9, 200));
    OK(s, spar_session_set_relaxation(s, 0.5));
    create_members(c, ranks);
    for (int i = 0; i < NODES; i++) {
        if (owner_of(i, deal, ranks) == me) {
            c->number[c->n] = i;
            place_of(i, c->x[c->n++]);
        }
    }
    OK(s, spar_fluid_create(c->member[BEAM], "air", &c->on_beam));
    OK(s, spar_fluid_set_motion_nodes(c->on_beam, c->n, c->n ? c->x[0] : NULL));
    OK(s, spar_fluid_set_force_nodes(c->on_beam, c->n, c->n ? c->x[0] : NULL));
    OK(s, spar_fluid_map(c->on_beam));
    c->piston_here = me == ranks / 2;
    OK(s, spar_fluid_create(c->member[PISTON], "water", &c->on_piston));
    OK(s, spar_fluid_set_motion_nodes(c->on_piston, c->piston_here, c->piston_here ? aside : NULL));
    OK(s, spar_fluid_set_force_nodes(c->on_piston, c->piston_here, c->piston_here ? aside : NULL));
    OK(s, spar_fluid_map(c->on_piston));
}

/* A stiff, viscous medium. */
static int solve(spar_session *s, double t, double dt, int iteration, void *context) {
    scene *c = context;
    double x[NODES][3], v[NODES][3], f[NODES][3], y[3], w[3], g[3];
    (void)iteration;
    c->calls++;
    if (c->calls == c->user_at) {
        return 77;
    }
    OK(s, spar_fluid_pull_motion(c->on_beam, 1, c->n ? x[0] : NULL, c->n ? v[0] : NULL));
    for (int i = 0; i < c->n; i++) {
        for (int k = 0; k < 3; k++) {
            f[i][k] = -20 * (x[i][k] - c->x[i][k]) - 3 * v[i][k] + (k == 1) * sin(3 * (t + dt) + c->number[i]);
        }
    }
    if (c->calls == c->nan_at && c->n) {
        f[0][0] = NAN;
    }
    (void)spar_fluid_push_forces(c->on_beam, c->n ? f[0] : NULL, NULL);
    OK(s, spar_fluid_pull_motion(c->on_piston, 1, c->piston_here ? y : NULL, c->piston_here ? w : NULL));
    for (int k = 0; k < 3 && c->piston_here; k++) {
        g[k] = -10 * (y[k] - (k == 1 ? 5 : 0)) - w[k] + (k == 0);
    }
    if (c->calls == c->nan_at && c->piston_here) {
        g[0] = NAN;
    }
    (void)spar_fluid_push_forces(c->on_piston, c->piston_here ? g : NULL, NULL);
    return 0;
}

/* ---- what is compared ---- */

enum { MOTION = 19 * POINTS, STATE = MOTION + 6 + 6 * POINTS };

/* This rank solves something, or is rank 0. */
static int is_core(const scene *c) {
    int core = rank == 0;
    for (int k = 0; k < MEMBERS; k++) {
        int owner = 0;
        OK(c->session, spar_member_get_owner(c->member[k], &owner));
        core = core || owner == rank;
    }
    return core;
}

/* Beam and body are one: the beam's nodes touch both. */
static int knows(const scene *c, int k) {
    return is_core(c) || (k == PISTON ? c->piston_here : c->n > 0);
}

static void look(const scene *c, int k, int loads, double out[STATE]) {
    int64_t n;
    memset(out, 0, STATE * sizeof *out);
    OK(c->session, spar_member_get_count(c->member[k], &n));
    OK(c->session, spar_member_get_motion(c->member[k], out, out + 7 * n, out + 13 * n));
    if (loads) {
        OK(c->session, spar_member_get_reaction(c->member[k], out + MOTION));
        OK(c->session, spar_member_get_loads(c->member[k], out + MOTION + 6));
    }
}

static void compare(const scene *all, const scene *alone, int bits) {
    double x[2][STATE], r[2][2];
    for (int k = 0; k < MEMBERS; k++) {
        int status = spar_member_get_motion(all->member[k], x[0], NULL, NULL);
        if (!knows(all, k) && !(all->resumed && status == SPAR_OK)) {
            assert_int_equal(status, SPAR_ERR_STATE);
            continue;
        }
        look(all, k, is_core(all), x[0]);
        look(alone, k, is_core(all), x[1]);
        for (int i = 0; i < STATE; i++) {
            double allowed = bits ? 0 : 1e-13 * fmax(1, fabs(x[1][i])) * (i >= 13 * POINTS ? 1e3 : 1);
            assert_true(fabs(x[0][i] - x[1][i]) <= allowed);
        }
        if (bits) {
            assert_memory_equal(x[0], x[1], sizeof x[0]);
        }
    }
    if (!is_core(all)) {
        double load[6 * POINTS], work[SPAR_WORK_COUNT], report[SPAR_REPORT_COUNT];
        assert_int_equal(spar_member_get_loads(all->member[BEAM], load), SPAR_ERR_STATE);
        assert_int_equal(spar_member_get_work(all->member[BEAM], SPAR_WORK_COUNT, work), SPAR_ERR_STATE);
        assert_int_equal(spar_session_get_report(all->session, SPAR_REPORT_COUNT, report), SPAR_ERR_STATE);
    }
    OK(all->session, spar_session_get_residual(all->session, &r[0][0], &r[0][1]));
    OK(alone->session, spar_session_get_residual(alone->session, &r[1][0], &r[1][1]));
    if (bits) {
        assert_memory_equal(r[0], r[1], sizeof r[0]);
    }
}

static void advance(scene *c, int steps, int *iterations) {
    for (int i = 0; i < steps; i++) {
        OK(c->session, spar_step(c->session, 0.02, solve, c, iterations + i));
    }
}

/* ---- the tests ---- */

static void same_run(int scheme, int deal, int bits) {
    const MPI_Comm world = MPI_COMM_WORLD;
    scene alone, all;
    int turns[2][STEPS];
    create(&alone, NULL, deal, scheme, bits);
    create(&all, &world, deal, scheme, bits);
    advance(&alone, STEPS, turns[0]);
    advance(&all, STEPS, turns[1]);
    assert_memory_equal(turns[0], turns[1], sizeof turns[0]);
    if (size > 1) {
        compare(&all, &alone, bits);
    }
    spar_session_destroy(&all.session);
    spar_session_destroy(&alone.session);
}

static void same_as_alone(void **state) {
    (void)state;
    for (int deal = 0; deal < DEALS; deal++) {
        same_run(SPAR_COUPLING_EXPLICIT, deal, 1);
        same_run(SPAR_COUPLING_IQN_ILS, deal, deal != ON_LAST);
    }
    same_run(SPAR_COUPLING_FIXED_POINT, ON_FIRST_HALF, 1);
    same_run(SPAR_COUPLING_AITKEN, ON_FIRST_HALF, 1);
}

/* What is learned by the ranks that solve something is that of one process, in the same bits, and so is the motion that
   it leads to on all that know it; the others are told that they do not know. With substeps it is refused, where there
   are others, as long as no guess is given, and the step can be taken with one substep after that. */
static void learned_by_those_that_solve(void **state) {
    (void)state;
    const MPI_Comm world = MPI_COMM_WORLD;
    enum { LONGER = 12 };
    for (int deal = 0; deal < DEALS; deal++) {
        scene alone, all;
        int turns[2][LONGER], used, any = 0;
        learns = 1;
        create(&alone, NULL, deal, SPAR_COUPLING_AITKEN, 1);
        create(&all, &world, deal, SPAR_COUPLING_AITKEN, 1);
        learns = 0;
        advance(&alone, LONGER, turns[0]);
        advance(&all, LONGER, turns[1]);
        assert_memory_equal(turns[0], turns[1], sizeof turns[0]);
        if (size > 1) {
            compare(&all, &alone, 1);
        }
        for (int k = BEAM; k <= PISTON; k += PISTON - BEAM) {
            double M[2][36], spread[2];
            int status = spar_member_get_learned_added_mass(all.member[k], &used, &spread[0], NULL, 1, NULL, M[0]);
            assert_int_equal(status, size == 1 || is_core(&all) ? SPAR_OK : SPAR_ERR_STATE);
            if (status == SPAR_OK) {
                OK(alone.session,
                   spar_member_get_learned_added_mass(alone.member[k], &any, &spread[1], NULL, 1, NULL, M[1]));
                assert_int_equal(used, any);
                assert_true(used && spread[0] == spread[1]);
                assert_memory_equal(M[0], M[1], sizeof M[0]);
            }
        }
        OK(all.session, spar_session_set_integrator(all.session, 0.9, 2));
        assert_int_equal(spar_step_begin(all.session, 0.02), size > 1 ? SPAR_ERR_UNSUPPORTED : SPAR_OK);
        if (size > 1) {
            assert_non_null(strstr(spar_session_message(all.session), "substeps"));
            OK(all.session, spar_session_set_integrator(all.session, 0.9, 1));
            advance(&all, 1, turns[1]);
        }
        spar_session_destroy(&all.session);
        spar_session_destroy(&alone.session);
    }
}

/* A rank that solves nothing and touches nothing: no message of more than 64 bytes in the steps. */
static void bystanders_get_no_data(void **state) {
    (void)state;
    const MPI_Comm world = MPI_COMM_WORLD;
    scene all;
    int turns[STEPS];
    create(&all, &world, ON_FIRST_HALF, SPAR_COUPLING_IQN_ILS, 0);
    advance(&all, 1, turns);
    data_bytes = 0;
    advance(&all, STEPS - 1, turns);
    int bystander = !is_core(&all) && all.n == 0 && !all.piston_here;
    assert_true(bystander ? data_bytes == 0 : size == 1 || data_bytes > 0);
    if (size == 7) { /* owners 0, 1, 2; beam on 0 to 3; piston on 3 */
        assert_int_equal(bystander, rank > 3);
    }
    spar_session_destroy(&all.session);
}

/* Saved in the middle, by ranks that know parts, and resumed by ranks that know all or parts. */
static void saved_and_resumed(void **state) {
    (void)state;
    const MPI_Comm world = MPI_COMM_WORLD;
    char file[32];
    snprintf(file, sizeof file, "mpi_touched_%d.spar", size);
    for (int touched = 0; touched < 2; touched++) {
        scene alone, first, all;
        int turns[STEPS];
        create(&alone, NULL, ON_ALL, SPAR_COUPLING_IQN_ILS, 1);
        advance(&alone, STEPS, turns);
        create(&first, &world, ON_FIRST_HALF, SPAR_COUPLING_IQN_ILS, 1);
        advance(&first, 2, turns);
        OK(first.session, spar_session_save(first.session, file));
        spar_session_destroy(&first.session);
        create(&all, &world, ON_LAST, SPAR_COUPLING_IQN_ILS, 1);
        OK(all.session, spar_session_set_option(all.session, "ranks.state", touched ? "touched" : "all"));
        OK(all.session, spar_session_load(all.session, file));
        all.resumed = 1;
        double q[7 * POINTS];
        OK(all.session, spar_member_get_motion(all.member[BEAM], q, NULL, NULL)); /* all know all until they step */
        advance(&all, STEPS - 2, turns);
        if (touched && size > 1) {
            compare(&all, &alone, 1);
        } else {
            double x[2][STATE];
            look(&all, BEAM, 1, x[0]);
            look(&alone, BEAM, 1, x[1]);
            assert_memory_equal(x[0], x[1], sizeof x[0]);
        }
        spar_session_destroy(&all.session);
        spar_session_destroy(&alone.session);
        MPI_Barrier(world);
        if (rank == 0) {
            remove(file);
        }
        MPI_Barrier(world);
    }
}

/* Each rank in turn fails in its fluid solver, in the first step or a later one: all are told, and after that the run
   has the bits of one to which nothing has happened. */
static void failures(void **state) {
    (void)state;
    const MPI_Comm world = MPI_COMM_WORLD;
    for (int kind = 0; kind < 2; kind++) {
        for (int bad = 0; bad < size; bad++) {
            const int late = (bad + kind) % 2;
            scene alone, all;
            int turns[STEPS], once = 0, had, any;
            create(&alone, NULL, ON_ALL, SPAR_COUPLING_IQN_ILS, 1);
            create(&all, &world, ON_ALL, SPAR_COUPLING_IQN_ILS, 1);
            advance(&alone, 3, turns);
            advance(&all, late, turns);
            *(kind ? &all.nan_at : &all.user_at) = rank == bad ? all.calls + 2 : 0;
            had = rank == bad && (!kind || all.n > 0 || all.piston_here);
            MPI_Allreduce(&had, &any, 1, MPI_INT, MPI_MAX, world);
            int status = spar_step(all.session, 0.02, solve, &all, &once);
            int own = kind ? SPAR_ERR_NUMERIC : SPAR_ERR_USER;
            if (any) {
                assert_true(rank == bad ? status == own || (kind && status == SPAR_ERR_ARGUMENT)
                                        : status == SPAR_ERR_PEER);
                advance(&all, 1, turns);
            } else {
                assert_int_equal(status, SPAR_OK);
            }
            advance(&all, 2 - late, turns);
            if (size > 1) {
                compare(&all, &alone, 1);
            }
            spar_session_destroy(&all.session);
            spar_session_destroy(&alone.session);
        }
    }
}

/* What the ranks that compare the loads find, or the rank that solves, all are told. */
static void no_convergence_and_no_solution(void **state) {
    (void)state;
    const MPI_Comm world = MPI_COMM_WORLD;
    scene all;
    int turns[STEPS], iterations = 0;
    create(&all, &world, ON_ALL, SPAR_COUPLING_FIXED_POINT, 1);
    spar_session *s = all.session;
    advance(&all, 1, turns);
    OK(s, spar_session_set_coupling(s, SPAR_COUPLING_FIXED_POINT, 0, 1e-9, 2));
    assert_int_equal(spar_step(s, 0.02, solve, &all, &iterations), SPAR_ERR_NUMERIC);
    assert_non_null(strstr(spar_session_message(s), "has not converged in 2 iterations"));
    OK(s, spar_session_set_coupling(s, SPAR_COUPLING_FIXED_POINT, 0, 1e-9, 200));
    OK(s, spar_session_set_newton(s, 0, 1e-15, 1));
    int status = spar_step(s, 0.02, solve, &all, &iterations);
    assert_int_equal(status, is_core(&all) ? SPAR_ERR_NUMERIC : SPAR_ERR_PEER); /* all that solve fail */
    OK(s, spar_session_set_newton(s, 1e-15, 1e-12, 50));
    advance(&all, 1, turns);
    spar_session_destroy(&all.session);
}

/* What needs the whole state on each rank, after the first step; and it changes nothing. */
static void refused(void **state) {
    (void)state;
    const MPI_Comm world = MPI_COMM_WORLD;
    static const double tip[3] = {10, 0, 0};
    scene all, alone;
    int turns[STEPS], apart = size > 1;
    create(&alone, NULL, ON_LAST, SPAR_COUPLING_EXPLICIT, 1);
    create(&all, &world, ON_LAST, SPAR_COUPLING_EXPLICIT, 1);
    spar_session *s = all.session;
    advance(&alone, 2, turns);
    advance(&all, 1, turns);
    if (apart) {
        assert_int_equal(spar_session_try(s, 0.02, 1, NULL, solve, &all, 0, 0, NULL), SPAR_ERR_STATE);
        assert_non_null(strstr(spar_session_message(s), "ranks.state"));
        assert_int_equal(spar_member_solve_static(all.member[PISTON], 1), SPAR_ERR_STATE);
        OK(s, spar_session_set_option(s, "ranks.state", "all"));
        assert_int_equal(spar_step_begin(s, 0.02), SPAR_ERR_STATE);
        OK(s, spar_session_set_option(s, "ranks.state", "touched"));
        spar_fluid *late = NULL;
        OK(s, spar_fluid_create(all.member[BEAM], "late", &late));
        OK(s, spar_fluid_set_motion_nodes(late, 1, tip));
        assert_int_equal(spar_fluid_map(late), knows(&all, BEAM) ? SPAR_OK : SPAR_ERR_STATE);
        spar_fluid_destroy(&late);
        advance(&all, 1, turns);
        compare(&all, &alone, 1);
    }
    spar_session_destroy(&all.session);
    spar_session_destroy(&alone.session);
}

/* Before the first step all ranks know all: equilibrium under the start's loads, trials and advice are those of one
   process, and leave no trace in the run that follows. */
static void before_the_first_step(void **state) {
    (void)state;
    const MPI_Comm world = MPI_COMM_WORLD;
    scene both[2];
    double tried[2][SPAR_TRY_COUNT], advice[2][SPAR_ADVICE_COUNT];
    int turns[2][STEPS], iterations[2] = {0, 0};
    create(both, NULL, ON_ALL, SPAR_COUPLING_IQN_ILS, 1);
    create(both + 1, &world, ON_ALL, SPAR_COUPLING_IQN_ILS, 1);
    for (int k = 0; k < 2; k++) {
        spar_session *s = both[k].session;
        OK(s, spar_session_set_option(s, "advise.nodes", "keep"));
        OK(s, spar_session_set_option(s, "advise.fidelity", "keep"));
        OK(s, spar_session_start(s, 0.02, solve, both + k, iterations + k));
        OK(s, spar_session_try(s, 0.02, 8, NULL, solve, both + k, 0, SPAR_TRY_COUNT, tried[k]));
        OK(s, spar_session_advise(s, 0.3, 0.02, 8, 8 * 0.02, NULL, solve, both + k, SPAR_ADVICE_COUNT, advice[k]));
        advance(both + k, STEPS, turns[k]);
    }
    assert_int_equal(iterations[0], iterations[1]);
    assert_true(tried[0][SPAR_TRY_SOLUTIONS] > 0 && tried[0][SPAR_TRY_SOLUTIONS] == tried[1][SPAR_TRY_SOLUTIONS]);
    assert_true(advice[0][SPAR_ADVICE_DT] == advice[1][SPAR_ADVICE_DT]);
    assert_memory_equal(turns[0], turns[1], sizeof turns[0]);
    if (size > 1) {
        compare(both + 1, both, 1);
    }
    spar_session_destroy(&both[0].session);
    spar_session_destroy(&both[1].session);
}

int main(int argc, char **argv) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(same_as_alone),
        cmocka_unit_test(learned_by_those_that_solve),
        cmocka_unit_test(bystanders_get_no_data),
        cmocka_unit_test(saved_and_resumed),
        cmocka_unit_test(failures),
        cmocka_unit_test(refused),
        cmocka_unit_test(no_convergence_and_no_solution),
        cmocka_unit_test(before_the_first_step),
    };
    return RANKS_RUN(argc, argv, tests);
}
