/* The flexible NREL 5-MW rotor with its blades' sections on several ranks, some of them without any, against the same
   rotor in a session of this process alone; and a broken wind on one rank, which all ranks are told of. */
#include <math.h>
#include <string.h>

#include "ranks.h"
#include <nrel5mw.h>
#include <spar/spar_mpi.h>
#include <stdio.h>

#define PI 3.14159265358979323846
#define OK(call) assert_int_equal(call, SPAR_OK)
enum { BLADES = 3, N = 19, NODES = 6, STEPS = 8 };
static const double dt = 0.05;

typedef struct scene {
    nrel5mw data;
    nrel5mw_rotor rotor;
    spar_session *session;
    spar_member *blade[BLADES];
    spar_fluid *fluid[BLADES]; /* this rank's */
    spar_aero *aero;
    int here, broken;
    double speed, wind[BLADES * N][3];
} scene;

/* Blade b is at home on rank b modulo size; alone: all of them here. */
static void begin(scene *s, int alone) {
    int me = alone ? 0 : rank, ranks = alone ? 1 : size;
    double twist[N] = {0}, still[3] = {0, 0, 0}, omega[3], gravity[3] = {0, 0, -9.81};
    *s = (scene){.speed = 12.1 * PI / 30.0};
    if (alone) {
        OK(spar_session_create(&s->session));
    } else {
        OK(spar_session_create_mpi(MPI_COMM_WORLD, &s->session));
    }
    OK(nrel5mw_load(&s->data, SPAR_DATA_DIR "/nrel5mw"));
    nrel5mw_rotor_default(&s->data, &s->rotor);
    OK(spar_session_set_gravity(s->session, gravity));
    OK(spar_session_set_coupling(s->session, SPAR_COUPLING_FIXED_POINT, 1e-3, 1e-9, 30));
    for (int i = 0; i < 3; i++) {
        omega[i] = s->speed * s->rotor.axis[i];
    }
    for (int b = 0; b < BLADES; b++) {
        OK(nrel5mw_create_blade(&s->data, &s->rotor, s->session, b, 1, NODES, &s->blade[b]));
        OK(spar_member_set_initial_velocity(s->blade[b], s->rotor.hub, still, omega));
        OK(spar_member_commit(s->blade[b]));
        if (b % ranks == me) {
            OK(nrel5mw_create_sections(&s->data, &s->rotor, b, s->blade[b], &s->fluid[s->here], twist));
            for (int i = 0; i < N; i++) { /* sheared, by the blade and not by where it is */
                s->wind[s->here * N + i][0] = 11.4 + 0.5 * b + 0.02 * i;
            }
            s->here++;
        }
    }
    OK(nrel5mw_create_aero(&s->data, &s->rotor, s->here, s->fluid, twist, &s->aero));
    OK(spar_aero_set_effects(s->aero, (2 * SPAR_AERO_UNSTEADY - 1) & ~(SPAR_AERO_SHEAR | SPAR_AERO_TOWER)));
}

static void end(scene *s) {
    spar_aero_destroy(&s->aero);
    spar_session_destroy(&s->session);
    nrel5mw_free(&s->data);
}

static int solve_aero(spar_session *session, double t, double step, int iteration, void *context) {
    scene *s = context;
    (void)session, (void)t, (void)step, (void)iteration;
    return spar_aero_solve(s->aero, s->data.density, s->here > 0 ? s->wind[0] : NULL, 1.0);
}

static void drive(scene *s, int step) {
    for (int b = 0; b < BLADES; b++) {
        double q[7], v[6], a[6];
        nrel5mw_root_motion(&s->data, &s->rotor, b, s->speed * dt * step, s->speed, 0.0, q, v, a);
        OK(spar_member_drive(s->blade[b], q, v, a));
    }
}

static void expect_rotor(const scene *one, const scene *other, int shared) {
    double value[2][3];
    OK(spar_aero_get_rotor(one->aero, &value[0][0], &value[0][1], &value[0][2]));
    OK(spar_aero_get_rotor(other->aero, &value[1][0], &value[1][1], &value[1][2]));
    if (shared) {
        MPI_Allreduce(MPI_IN_PLACE, value[1], 3, MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
    }
    for (int i = 0; i < 3; i++) {
        assert_true(fabs(value[1][i] / value[0][i] - 1.0) < 1e-12);
    }
}

static void advance(scene *s, int from, int to) {
    for (int step = from + 1; step <= to; step++) {
        drive(s, step);
        OK(spar_step(s->session, dt, solve_aero, s, NULL));
    }
}

/* Eight steps of a strongly coupled rotor whose elements remember (inflow, stall, wake): places of all nodes to 1e-12
   of the blade's length, thrust, torque and power (summed over the ranks by the host) to 1e-12 of themselves; so from a
   file on, which the ranks write half way and one process reads. */
static void test_spread_rotor(void **state) {
    (void)state;
    scene one, many, again;
    char file[40];
    (void)snprintf(file, sizeof file, "mpi_aero_%d.spar", size);
    begin(&one, 1);
    begin(&many, 0);
    begin(&again, 1);
    advance(&one, 0, STEPS);
    advance(&many, 0, STEPS / 2);
    OK(spar_session_save(many.session, file));
    OK(spar_session_load(again.session, file));
    advance(&many, STEPS / 2, STEPS);
    advance(&again, STEPS / 2, STEPS);
    expect_rotor(&one, &many, 1);
    expect_rotor(&one, &again, 0);
    for (int b = 0; b < BLADES; b++) {
        double q[2][NODES][7];
        OK(spar_member_get_motion(one.blade[b], q[0][0], NULL, NULL));
        OK(spar_member_get_motion(many.blade[b], q[1][0], NULL, NULL));
        for (int i = 0; i < NODES; i++) {
            for (int c = 0; c < 7; c++) {
                assert_true(fabs(q[0][i][c] - q[1][i][c]) < 1e-12 * (c < 3 ? 61.5 : 1.0));
            }
        }
    }
    end(&one);
    end(&many);
    end(&again);
    MPI_Barrier(MPI_COMM_WORLD);
    if (rank == 0) {
        remove(file);
    }
}

/* The wind of blade 1 broken on the rank that has it: the step fails on all, nobody waits; then it can be done. */
static void test_broken_wind(void **state) {
    (void)state;
    scene s;
    begin(&s, 0);
    int mine = 1 % size == rank, slot = size == 1 ? 1 : 0;
    for (int broken = 1; broken >= 0; broken--) {
        int done;
        drive(&s, 1);
        if (mine) {
            s.wind[slot * N + 4][2] = broken ? NAN : 0.0;
        }
        OK(spar_step_begin(s.session, dt));
        OK(spar_step_solve(s.session));
        int status = solve_aero(s.session, dt, dt, 0, &s);
        assert_int_equal(status, broken && mine ? SPAR_ERR_ARGUMENT : SPAR_OK);
        status = spar_step_check(s.session, &done);
        if (broken) {
            assert_int_equal(status, mine ? SPAR_ERR_ARGUMENT : SPAR_ERR_PEER);
            assert_non_null(strstr(spar_session_message(s.session), "'sections2'"));
            OK(spar_step_reject(s.session));
        } else {
            assert_int_equal(status, SPAR_OK);
            OK(spar_step_reject(s.session));
        }
    }
    end(&s);
}

int main(int argc, char **argv) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_spread_rotor), cmocka_unit_test(test_broken_wind)};
    return RANKS_RUN(argc, argv, tests);
}
