/* Members tied by joints on any number of ranks against the same on one process: two assemblies, whose members begin
   with different owners, a spring between nodes that move as they are told, and a fluid. With all of its nodes on the
   last rank everything is the same to the bit; where they are dealt out over the ranks loads are summed in another
   order. Then what a single rank can say otherwise, or fail at: all are told, none waits (ctest's time limit is the
   witness), and all is as it was. */
#include "scene.h"
#include "trials.h"

#include "ranks.h"
#include <spar/spar_mpi.h>
#include <stdio.h>

enum { NODES = 12, MEMBERS = 6, JOINTS = 7 };

static const double rest[4] = {1, 0, 0, 0}, step = 0.02;

typedef struct scene {
    spar_session *session;
    spar_member *member[MEMBERS];
    spar_joint *joint[JOINTS];
    spar_fluid *fluid;
    int64_t n; /* this rank's nodes */
    double x[NODES][3];
} scene;

static spar_member *body_at(spar_session *s, const char *name, const double x[3]) {
    const double c[3] = {0.5, 0, 0}, J[3] = {0.1, 0.2, 0.3};
    double mass[36];
    spar_member *b = NULL;
    scene_mass(mass, 2, c, J);
    OK(s, spar_rigid_create(s, name, x, rest, mass, &b));
    return b;
}

/* A wing with a flap on a sprung, damped and loaded hinge at its tip, from which a weight hangs on a rope; a rigid boom
   on a driven shaft; a point that the host drives, on a spring. */
static void describe(scene *c) {
    static const double tip[3] = {4, 0, 0}, hang[3] = {5, 0, -1}, far[3] = {0, 6, 0}, above[3] = {0, 0, 3},
                        eta[2] = {0, 1}, gravity[3] = {0, 0, -2}, boom[6] = {0, 6, 0, 2, 6, 0};
    double K[36], M[36], spring[36] = {0}, damper[36] = {0}, all[36] = {0};
    spar_session *s = c->session;
    OK(s, spar_session_set_gravity(s, gravity));
    OK(s, spar_session_set_coupling(s, SPAR_COUPLING_AITKEN, 0, 1e-8, 60));
    scene_diagonal(K, 4e4, 4e4, 4e4, 800, 600, 600);
    scene_diagonal(M, 1, 1, 1, 0.02, 0.01, 0.01);
    c->member[0] = scene_beam(s, "wing", 2, 4, 4, K, M);
    c->member[1] = body_at(s, "flap", tip);
    c->member[2] = body_at(s, "weight", hang);
    OK(s, spar_beam_create(s, "boom", 1, 4, &c->member[3]));
    OK(s, spar_beam_set_axis(c->member[3], 2, eta, boom, NULL));
    OK(s, spar_beam_set_sections(c->member[3], 1, eta, K, M));
    OK(s, spar_member_set_root(c->member[3], SPAR_ROOT_FREE));
    OK(s, spar_member_set_fidelity(c->member[3], SPAR_FIDELITY_RIGID, 0));
    c->member[4] = body_at(s, "end", (double[]){2, 6, 0});
    OK(s, spar_point_create(s, "buoy", above, NULL, &c->member[5]));
    spring[28] = 40, damper[28] = 0.5;
    for (int i = 0; i < 36; i += 7) {
        all[i] = 10;
    }
    c->joint[0] = scene_joint_at(s, "flap hinge", c->member[1], 0, c->member[0], 7, SPAR_FREE_RY, tip);
    OK(s, spar_joint_set_spring(c->joint[0], spring, damper, NULL));
    OK(s, spar_joint_set_load(c->joint[0], (double[]){0, 0, 0, 0, 0.7, 0}));
    OK(s, spar_link_create(s, "rope", c->member[2], 0, hang, c->member[1], 0, tip, &c->joint[1]));
    c->joint[2] = scene_joint_at(s, "shaft", c->member[3], 0, NULL, 0, SPAR_FREE_RZ, far);
    OK(s, spar_joint_set_driven(c->joint[2], SPAR_FREE_RZ));
    c->joint[3] = scene_joint_at(s, "weld", c->member[4], 0, c->member[3], 3, 0, (double[]){2, 6, 0});
    c->joint[4] = scene_joint_at(s, "tether", c->member[5], 0, NULL, 0, 63, above);
    OK(s, spar_joint_set_spring(c->joint[4], all, NULL, NULL));
    OK(s, spar_link_create(s, "stay", c->member[2], 0, hang, NULL, 0, above, &c->joint[5]));
    OK(s, spar_link_set_spring(c->joint[5], 5, 0.1, 4, 1));
    c->joint[6] =
        scene_joint_at(s, "moss", c->member[2], 0, NULL, 0, 63, hang); /* or a weight on a rope spins freely */
    OK(s, spar_joint_set_spring(c->joint[6], all, NULL, NULL));
}

static void ready(scene *c, int me, int ranks, int spread) {
    spar_session *s = c->session;
    for (int k = 0; k < MEMBERS; k++) {
        OK(s, spar_member_commit(c->member[k]));
    }
    for (int i = 0; i < NODES; i++) {
        double place[3] = {4.0 * i / (NODES - 1), 0.2, 0.1};
        if ((spread ? i % ranks : ranks - 1) == me) {
            memcpy(c->x[c->n++], place, sizeof place);
        }
    }
    double *x = c->n ? c->x[0] : NULL;
    OK(s, spar_fluid_create(c->member[0], "air", &c->fluid));
    OK(s, spar_fluid_set_motion_nodes(c->fluid, c->n, x));
    OK(s, spar_fluid_set_force_nodes(c->fluid, c->n, x));
    OK(s, spar_fluid_map(c->fluid));
}

static void begin(scene *c, int ranks) {
    memset(c, 0, sizeof *c);
    OK(NULL, ranks > 1 ? spar_session_create_mpi(MPI_COMM_WORLD, &c->session) : spar_session_create(&c->session));
    describe(c);
}

static int solve(spar_session *s, double t, double dt, int iteration, void *context) {
    scene *c = context;
    double v[NODES][3], f[NODES][3];
    (void)iteration;
    OK(s, spar_fluid_pull_motion(c->fluid, 1, NULL, c->n ? v[0] : NULL));
    for (int64_t i = 0; i < c->n; i++) {
        for (int k = 0; k < 3; k++) {
            f[i][k] = -0.3 * v[i][k] + (k == 2 ? 0.4 * cos(3 * (t + dt)) : 0);
        }
    }
    return spar_fluid_push_forces(c->fluid, c->n ? f[0] : NULL, NULL);
}

static void drive(scene *c, int i) {
    double t = (i + 1) * step, z[6] = {0}, rate[6] = {0}, q[7] = {0.1 * sin(t), 0, 0, 1, 0, 0, 0},
           v[6] = {0.1 * cos(t)};
    z[5] = 4 * t, rate[5] = 4;
    OK(c->session, spar_joint_drive(c->joint[2], z, rate, NULL));
    OK(c->session, spar_member_drive(c->member[5], q, v, NULL));
}

enum { STATE = 25 * 16 * MEMBERS + 18 * JOINTS };

static void look(const scene *c, double *out) {
    memset(out, 0, STATE * sizeof *out);
    for (int k = 0; k < MEMBERS; k++, out += 25 * 16) {
        OK(c->session, spar_member_get_motion(c->member[k], out, out + 7 * 16, out + 13 * 16));
        OK(c->session, spar_member_get_loads(c->member[k], out + 19 * 16));
    }
    for (int k = 0; k < JOINTS; k++, out += 18) {
        OK(c->session, spar_joint_get_motion(c->joint[k], out, out + 6, NULL));
        OK(c->session, spar_joint_get_load(c->joint[k], out + 12));
    }
}

/* tolerance 0: to the bit; else of the largest number there is, as of what Newton and the coupling leave. */
static void same(const scene *a, const scene *b, double tolerance) {
    static double x[STATE], y[STATE];
    double size_of_all = 1;
    look(a, x);
    look(b, y);
    for (int i = 0; i < STATE && tolerance > 0; i++) {
        size_of_all = fmax(size_of_all, fabs(y[i]));
    }
    for (int i = 0; i < STATE && tolerance > 0; i++) {
        NEAR(x[i], y[i], tolerance * size_of_all);
    }
    if (tolerance == 0) {
        assert_memory_equal(x, y, sizeof x);
    }
}

/* The pair of sessions, over all ranks and here alone, some steps later. */
static void run_both(scene *all, scene *alone, int first, int steps, double tolerance) {
    for (int i = first; i < first + steps; i++) {
        drive(all, i);
        drive(alone, i);
        OK(all->session, spar_step(all->session, step, solve, all, NULL));
        OK(alone->session, spar_step(alone->session, step, solve, alone, NULL));
        same(all, alone, tolerance);
    }
}

static void begin_both(scene *all, scene *alone, int spread) {
    begin(all, size);
    ready(all, rank, size, spread);
    begin(alone, 1);
    ready(alone, 0, 1, 0);
}

static void end_both(scene *all, scene *alone) {
    spar_session_destroy(&all->session);
    spar_session_destroy(&alone->session);
}

/* The tied ones of an assembly have one owner, the dearest has gone to another rank than the other one; a load of the
   point shows its spring. */
static void same_bits(void **state) {
    (void)state;
    scene all, alone;
    int owner[MEMBERS];
    double load[6], z[6];
    begin_both(&all, &alone, 0);
    run_both(&all, &alone, 0, 20, 0);
    for (int k = 0; k < MEMBERS; k++) {
        OK(all.session, spar_member_get_owner(all.member[k], &owner[k]));
    }
    assert_int_equal(owner[0], owner[1]);
    assert_int_equal(owner[0], owner[2]);
    assert_int_equal(owner[3], owner[4]);
    assert_true(size == 1 || owner[0] != owner[3]);
    OK(all.session, spar_joint_get_motion(all.joint[2], z, NULL, NULL));
    NEAR(z[5], 4 * 20 * step, 1e-12);
    OK(all.session,
       spar_joint_get_load(all.joint[4], load)); /* 10 N/m times 0.1 sin t, the spring's at rest elsewhere */
    NEAR(load[0], -10 * 0.1 * sin(20 * step), 1e-12);
    end_both(&all, &alone);
}

static void nearly_the_same(void **state) {
    (void)state;
    scene all, alone;
    begin_both(&all, &alone, 1);
    run_both(&all, &alone, 0, 10, 1e-8);
    end_both(&all, &alone);
}

/* Equilibrium of an assembly, and steps on from it. */
static void at_rest(void **state) {
    (void)state;
    scene all, alone;
    begin_both(&all, &alone, 0);
    OK(all.session, spar_member_solve_static(all.member[3], 1));
    OK(alone.session, spar_member_solve_static(alone.member[3], 1));
    same(&all, &alone, 0);
    run_both(&all, &alone, 0, 5, 0);
    end_both(&all, &alone);
}

/* Equilibrium of all, under the fluid's loads. */
static void all_at_rest(void **state) {
    (void)state;
    scene all, alone;
    begin_both(&all, &alone, 0);
    OK(all.session, spar_session_solve_static(all.session, 2, solve, &all, NULL));
    OK(alone.session, spar_session_solve_static(alone.session, 2, solve, &alone, NULL));
    same(&all, &alone, 0);
    run_both(&all, &alone, 0, 5, 0);
    end_both(&all, &alone);
}

/* A file of all ranks is loaded by one process, and one of a process by all ranks. */
static void from_file(void **state) {
    (void)state;
    for (int way = 0; way < 2; way++) {
        scene all, alone;
        char file[32];
        snprintf(file, sizeof file, "mpi_joint_%d.spar", size);
        begin_both(&all, &alone, 0);
        scene *from = way ? &alone : &all, *to = way ? &all : &alone;
        for (int i = 0; i < 6; i++) {
            drive(from, i);
            OK(from->session, spar_step(from->session, step, solve, from, NULL));
        }
        if (way == 0 || rank == 0) {
            OK(from->session, spar_session_save(from->session, file));
        }
        MPI_Barrier(MPI_COMM_WORLD);
        OK(to->session, spar_session_load(to->session, file));
        same(&all, &alone, 0);
        run_both(&all, &alone, 6, 6, 0);
        end_both(&all, &alone);
        MPI_Barrier(MPI_COMM_WORLD);
        if (rank == 0) {
            remove(file);
        }
    }
}

static int drive_next(spar_session *s, double t, double dt, void *context) {
    (void)s, (void)dt;
    drive(context, (int)lround(t / step));
    return 0;
}

/* Trials over all ranks leave nothing behind, before the first step and after some. */
static void trials(void **state) {
    (void)state;
    for (int first = 0; first <= 4; first += 4) {
        scene all, alone;
        double seen[TRY_COUNT];
        begin_both(&all, &alone, 0);
        run_both(&all, &alone, 0, first, 0);
        OK(all.session, trial_run(all.session, step, 8, drive_next, solve, &all, 0, seen));
        same(&all, &alone, 0);
        run_both(&all, &alone, first, 3, 0);
        end_both(&all, &alone);
    }
}

/* Advice within a run comes into force on all ranks: tied members are made anew on their owner, joints hold and know
   their turns. */
static void advised(void **state) {
    (void)state;
    scene all;
    double advice[ADVICE_COUNT], z[6];
    int64_t nodes = 8;
    begin(&all, size);
    ready(&all, rank, size, 1);
    spar_session *s = all.session;
    for (int i = 0; i < 12; i++) {
        drive(&all, i);
        OK(s, spar_step(s, step, solve, &all, NULL));
        if (i == 3) {
            OK(s, spar_trial_set_option(trial_of(s), "dt", "keep"));
            OK(s, spar_trial_set_option(trial_of(s), "coupling", "keep"));
            OK(s, trial_advise(s, 0.3, step, 8, 8 * step, drive_next, solve, &all, advice));
            OK(s, trial_give_elements(s, all.member[0], all.member[0]->mesh.elements, 3));
        }
    }
    OK(s, spar_member_get_count(all.member[0], &nodes));
    assert_true(nodes < 8);
    OK(s, spar_joint_get_motion(all.joint[0], z, NULL, NULL));
    for (int k = 0; k < 6; k++) {
        assert_true(k == 4 || fabs(z[k]) < fmax(1e-11, advice[ADVICE_NEWTON_RTOL]));
    }
    OK(s, spar_joint_get_motion(all.joint[2], z, NULL, NULL));
    NEAR(z[5], 4 * 12 * step, 1e-11);
    spar_session_destroy(&all.session);
}

/* The host's owner stands; two of them in one assembly are refused on all ranks, and it goes on with other members. */
static void given_owners(void **state) {
    (void)state;
    scene c;
    int owner = -1;
    begin(&c, size);
    OK(c.session, spar_member_set_owner(c.member[4], size - 1));
    ready(&c, rank, size, 1);
    OK(c.session, spar_step_begin(c.session, step));
    OK(c.session, spar_member_get_owner(c.member[3], &owner));
    assert_int_equal(owner, size - 1);
    spar_session_destroy(&c.session);
    if (size > 1) {
        begin(&c, size);
        OK(c.session, spar_member_set_owner(c.member[0], 0));
        OK(c.session, spar_member_set_owner(c.member[2], 1));
        ready(&c, rank, size, 1);
        assert_int_equal(spar_step_begin(c.session, step), SPAR_ERR_ARGUMENT);
        assert_non_null(strstr(spar_session_message(c.session), "their owners are ranks"));
        OK(c.session, spar_member_get_owner(c.member[3], &owner));
        assert_int_equal(owner, 3 % size);
        spar_session_destroy(&c.session);
    }
}

/* A joint that one rank describes otherwise, or alone. */
static void otherwise(void **state) {
    (void)state;
    for (int way = 0; way < 4 && size > 1; way++) {
        scene c;
        spar_joint *more = NULL;
        begin(&c, size);
        ready(&c, rank, size, 1);
        if (rank == size - 1) {
            switch (way) {
            case 0:
                OK(c.session, spar_joint_set_frame(c.joint[0], (double[]){4, 0.1, 0}, rest));
                break;
            case 1:
                OK(c.session, spar_link_set_spring(c.joint[5], 6, 0.1, 4, 1));
                break;
            case 2:
                OK(c.session, spar_joint_set_driven(c.joint[2], 0));
                break;
            default:
                OK(c.session, spar_joint_create(c.session, "one more", c.member[2], 0, NULL, 0, 63, &more));
                break;
            }
        }
        static const char *const said[] = {"joint 'flap hinge'", "joint 'stay'", "joint 'shaft'", "numbers of joints"};
        assert_int_equal(spar_step_begin(c.session, step), SPAR_ERR_COMM);
        assert_non_null(strstr(spar_session_message(c.session), said[way]));
        spar_session_destroy(&c.session);
    }
}

/* What may be given at any time, and is given otherwise on one rank: a spring, a load, a drive. Said before the first
   step, between steps and for a solution at rest; given alike again, the run goes on. (A spring went unseen: the
   owner's was solved with, and other ranks said another energy.) */
static void given_otherwise(void **state) {
    (void)state;
    double spring[36] = {0}, damper[36] = {0};
    damper[28] = 0.5;
    for (int way = 0; way < 9 && size > 1; way++) {
        scene c;
        double last = rank == size - 1 ? 1e-9 : 0;
        begin(&c, size);
        ready(&c, rank, size, 1);
        for (int again = 0; again < 2; again++, last = 0) {
            drive(&c, 0);
            if (way / 3 == 1 && again == 0) {
                OK(c.session, spar_step(c.session, step, solve, &c, NULL));
                drive(&c, 1);
            }
            spring[28] = 40 + (way % 3 == 0 ? last : 0);
            OK(c.session, spar_joint_set_spring(c.joint[0], spring, damper, NULL));
            OK(c.session, spar_joint_set_load(c.joint[0], (double[]){0, 0, 0, 0, 0.7 + (way % 3 == 1 ? last : 0), 0}));
            if (way % 3 == 2) {
                OK(c.session, spar_joint_drive(c.joint[2], (double[]){0, 0, 0, 0, 0, 0.1 + last}, NULL, NULL));
            }
            int status = way / 3 == 2 ? spar_session_solve_static(c.session, 1, NULL, NULL, NULL)
                                      : spar_step(c.session, step, solve, &c, NULL);
            assert_int_equal(status, again ? SPAR_OK : SPAR_ERR_COMM);
            if (!again) {
                assert_non_null(strstr(spar_session_message(c.session), "springs, loads or drives of "));
            }
        }
        spar_session_destroy(&c.session);
    }
}

/* A load beyond the range of numbers fails on the owner alone: all know, the step can be rejected, and the run goes on
   as if nothing had been. */
static void fails_on_owner(void **state) {
    (void)state;
    scene all, alone;
    int owner = 0;
    double load[6] = {0, 0, 0, 0, 1e308, 0};
    begin_both(&all, &alone, 0);
    run_both(&all, &alone, 0, 3, 0);
    OK(all.session, spar_member_get_owner(all.member[0], &owner));
    drive(&all, 3);
    OK(all.session, spar_joint_set_load(all.joint[0], load));
    int status = spar_step(all.session, step, solve, &all, NULL);
    assert_int_equal(status, rank == owner ? SPAR_ERR_NUMERIC : SPAR_ERR_PEER);
    same(&all, &alone, 0);
    OK(all.session, spar_joint_set_load(all.joint[0], (double[]){0, 0, 0, 0, 0.7, 0}));
    run_both(&all, &alone, 3, 5, 1e-8); /* tangents are formed anew after a failure */
    end_both(&all, &alone);
}

/* What another iteration would move, of the tied ones: on every rank the bits of one process, and the run's as they
   are without. The wing's loads are missed by what its motion and the cosine change. */
static void estimated(void **state) {
    (void)state;
    scene all, alone;
    double x[SPAR_REPORT_COUNT], y[SPAR_REPORT_COUNT];
    begin_both(&all, &alone, 0);
    for (int k = 0; k < 2; k++) {
        OK(k ? alone.session : all.session,
           spar_session_set_coupling(k ? alone.session : all.session, SPAR_COUPLING_EXPLICIT, 0, 1e-8, 60));
    }
    OK(all.session, spar_session_set_option(all.session, "coupling.estimate", "on"));
    run_both(&all, &alone, 0, 3, 0);
    OK(alone.session, spar_session_set_option(alone.session, "coupling.estimate", "on"));
    run_both(&all, &alone, 3, 5, 0);
    OK(all.session, spar_session_get_report(all.session, SPAR_REPORT_COUNT, x));
    OK(alone.session, spar_session_get_report(alone.session, SPAR_REPORT_COUNT, y));
    assert_true(y[SPAR_REPORT_MOTION_ERROR] > 1e-9);
    assert_memory_equal(x + SPAR_REPORT_MOTION_ERROR, y + SPAR_REPORT_MOTION_ERROR, sizeof *x);
    end_both(&all, &alone);
}

/* A modal beam that a joint connects: every rank gets the status and the text, wherever the beam is solved, and an
   exact one takes its place. */
static void modal_refused(void **state) {
    (void)state;
    for (int committed = 0; committed < 2; committed++) {
        double K[36], M[36];
        spar_session *s = NULL;
        spar_joint *j = NULL;
        OK(NULL, spar_session_create_mpi(MPI_COMM_WORLD, &s));
        scene_diagonal(K, 4e4, 4e4, 4e4, 800, 600, 600);
        scene_diagonal(M, 1, 1, 1, 0.02, 0.01, 0.01);
        spar_member *b = scene_beam(s, "wing", 2, 4, 4, K, M);
        OK(s, spar_member_set_fidelity(b, SPAR_FIDELITY_MODAL, 8));
        if (committed) {
            OK(s, spar_member_commit(b));
        }
        int status = spar_joint_create(s, "tip", b, 7, NULL, 0, SPAR_FREE_RY, &j);
        status = committed ? status : spar_member_commit(b);
        assert_int_equal(status, SPAR_ERR_UNSUPPORTED);
        assert_non_null(strstr(spar_session_message(s), "'wing' is a linear or modal beam"));
        if (!committed) {
            OK(s, spar_member_set_fidelity(b, SPAR_FIDELITY_EXACT, 0));
            OK(s, spar_member_commit(b));
        }
        OK(s, spar_step(s, step, NULL, NULL, NULL));
        spar_session_destroy(&s);
    }
}

int main(int argc, char **argv) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(same_bits),      cmocka_unit_test(nearly_the_same), cmocka_unit_test(at_rest),
        cmocka_unit_test(from_file),      cmocka_unit_test(trials),          cmocka_unit_test(advised),
        cmocka_unit_test(all_at_rest),    cmocka_unit_test(given_owners),    cmocka_unit_test(otherwise),
        cmocka_unit_test(fails_on_owner), cmocka_unit_test(estimated),       cmocka_unit_test(given_otherwise),
        cmocka_unit_test(modal_refused)};
    return RANKS_RUN(argc, argv, tests);
}
