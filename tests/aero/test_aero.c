/* The blade-element fluid through the whole library: the NREL 5-MW rotor against AeroDyn, invariance, bad input. */
#include "check.h"

#include <stdlib.h>

#include <nrel5mw.h>
#include <spar/spar_aero.h>

#define PI 3.14159265358979323846
enum { BLADES = 3, N = 19 };

/* The rotor with three blades in a session; axis, hub and up may be turned. */
typedef struct scene {
    nrel5mw data;
    nrel5mw_rotor rotor;
    spar_session *session;
    spar_member *blade[BLADES];
    spar_fluid *fluid[BLADES];
    spar_aero *aero;
    double speed, wind[BLADES * N][3];
} scene;

static void load_tables(nrel5mw *data) {
    if (nrel5mw_load(data, SPAR_DATA_DIR "/nrel5mw") != SPAR_OK) {
        print_error("%s\n", data->message);
        fail();
    }
    assert_int_equal(data->aero_n, N);
}

/* No tilt, no precone; elements 0: rigid blades. They begin turning. */
static void build(scene *s, int elements, int nodes) {
    OK(NULL, spar_session_create(&s->session));
    double twist[N], omega[3], still[3] = {0, 0, 0};
    for (int i = 0; i < 3; i++) {
        omega[i] = s->speed * s->rotor.axis[i];
    }
    for (int b = 0; b < BLADES; b++) {
        OK(s->session, nrel5mw_create_blade(&s->data, &s->rotor, s->session, b, elements, nodes, &s->blade[b]));
        OK(s->session, spar_member_set_initial_velocity(s->blade[b], s->rotor.hub, still, omega));
        OK(s->session, spar_member_commit(s->blade[b]));
        OK(s->session, nrel5mw_create_sections(&s->data, &s->rotor, b, s->blade[b], &s->fluid[b], twist));
    }
    OK(s->session, nrel5mw_create_aero(&s->data, &s->rotor, BLADES, s->fluid, twist, &s->aero));
}

static void begin(scene *s, double wind, double rpm) {
    *s = (scene){.speed = rpm * PI / 30.0};
    load_tables(&s->data);
    nrel5mw_rotor_default(&s->data, &s->rotor);
    s->rotor.precone = 0.0;
    memcpy(s->rotor.axis, (double[3]){1, 0, 0}, sizeof s->rotor.axis);
    for (int k = 0; k < BLADES * N; k++) {
        s->wind[k][0] = wind;
    }
}

static void end(scene *s) {
    spar_aero_destroy(&s->aero);
    spar_session_destroy(&s->session);
    nrel5mw_free(&s->data);
}

static int solve_aero(spar_session *session, double t, double dt, int iteration, void *context) {
    scene *s = context;
    (void)session, (void)t, (void)dt, (void)iteration;
    return spar_aero_solve(s->aero, s->data.density, s->wind[0], 1.0);
}

static void step(scene *s, double angle, double dt) {
    for (int b = 0; b < BLADES; b++) {
        double q[7], v[6], a[6];
        nrel5mw_root_motion(&s->data, &s->rotor, b, angle, s->speed, 0.0, q, v, a);
        OK(s->session, spar_member_drive(s->blade[b], q, v, a));
    }
    OK(s->session, spar_step(s->session, dt, solve_aero, s, NULL));
}

/* AeroDyn 5 (OpenFAST) on these tables: quasi-steady momentum theory, uniform wind along the shaft, rigid blades, no
   tilt, no precone, tip and hub loss, tangential induction, drag in no induction, linear polars; air 1.225 kg/m3.
   Printed to 5 or 6 digits. Here the same equations are solved, so what is asked for is 2e-5 of thrust, torque and
   power: the digits printed (1.3e-5 of the thrust at 8 m/s) and the tolerance of AeroDyn's root (5e-5 rad in the inflow
   angle is allowed there). */
typedef struct reference {
    double wind, rpm, thrust, torque, power;
} reference;
static const reference references[] = {{8.0, 9.16, 385.20e3, 1.97713e6, 1.89652e6},
                                       {11.4, 12.1, 744.28e3, 4.28728e6, 5.43245e6}};
/* Axial load per aerodynamic node of a blade at 8 m/s, N. Equal to 1 N but at the nodes 3, 5, 16 and 17, where the line
   of the aerodynamic centres bends: there AeroDyn's shares differ by 7 to 14 N, 0.1 % of the largest load, with the
   same sum. */
static const double reference_load[N] = {16.7,    141.7,   235.9,   619.1,   2592.4,  4171.4,  5077.0,
                                         6128.1,  7502.2,  8869.6,  10490.2, 11965.6, 12986.4, 14215.4,
                                         14063.3, 11994.9, 10138.5, 5925.4,  1265.9};

static void check_reference(scene *s, const reference *r) {
    double thrust, torque, power;
    OK(s->session, spar_aero_get_rotor(s->aero, &thrust, &torque, &power));
    print_message("%4.1f m/s: thrust %.3f kN (%+.1e), torque %.6f MN m (%+.1e), power %.6f MW (%+.1e)\n", r->wind,
                  thrust / 1e3, thrust / r->thrust - 1.0, torque / 1e6, torque / r->torque - 1.0, power / 1e6,
                  power / r->power - 1.0);
    assert_true(fabs(thrust / r->thrust - 1.0) < 2e-5);
    assert_true(fabs(torque / r->torque - 1.0) < 2e-5);
    assert_true(fabs(power / r->power - 1.0) < 2e-5);
    int64_t lost = -1;
    int flags[BLADES * N];
    OK(s->session, spar_aero_get_flags(s->aero, flags, &lost));
    assert_int_equal(lost, 0);
    for (int k = 0; k < BLADES * N; k++) { /* root and tip lie on the radii of the losses */
        assert_int_equal(flags[k], k % N == 0 || k % N == N - 1 ? SPAR_AERO_FLAG_END : 0);
    }
}

static void check_reference_load(scene *s) {
    double force[BLADES * N][3], sum = 0.0, worst = 0.0;
    OK(s->session, spar_aero_get_loads(s->aero, NULL, force[0], NULL));
    for (int i = 0; i < N; i++) {
        for (int b = 0; b < BLADES; b++) {
            double difference = fabs(force[b * N + i][0] - reference_load[i]);
            worst = fmax(worst, difference);
            sum += force[b * N + i][0] - reference_load[i];
        }
    }
    print_message("load along the span: largest difference %.1f N, %.2f %% of the largest load\n", worst,
                  100.0 * worst / 14215.4);
    assert_true(worst < 20.0 && fabs(sum) < 10.0);
}

/* Rigid blades whose roots are driven, after a step and after half a turn. */
static void test_aerodyn_rigid(void **state) {
    (void)state;
    for (int i = 0; i < 2; i++) {
        scene s;
        begin(&s, references[i].wind, references[i].rpm);
        build(&s, 0, 1);
        step(&s, s.speed * 0.05, 0.05);
        check_reference(&s, &references[i]);
        if (i == 0) {
            check_reference_load(&s);
        }
        double load[6], thrust, torque, sum[2] = {0.0, 0.0}, x[3];
        step(&s, s.speed * 0.1, 0.05);
        check_reference(&s, &references[i]);
        OK(s.session, spar_aero_get_rotor(s.aero, &thrust, &torque, NULL));
        for (int b = 0; b < BLADES; b++) { /* what the members got is what the rotor says, about the hub */
            double q[7];
            OK(s.session, spar_member_get_loads(s.blade[b], load));
            OK(s.session, spar_member_get_reference(s.blade[b], x, NULL));
            OK(s.session, spar_member_get_motion(s.blade[b], q, NULL, NULL));
            sum[0] += load[0];
            sum[1] += load[3] + (x[1] + q[1]) * load[2] - (x[2] + q[2]) * load[1];
        }
        assert_true(fabs(sum[0] / thrust - 1.0) < 1e-13 && fabs(sum[1] / torque - 1.0) < 1e-13);
        end(&s);
    }
}

/* The same blades as beams, twisted frames and all, before they bend: the fluid fits its sections into whatever frames
   the member has, and velocities of a rigid turn are interpolated exactly, so the rigid rotor's figures to rounding. */
static void test_aerodyn_beam(void **state) {
    (void)state;
    scene rigid, beam;
    double value[2][3];
    begin(&rigid, 8.0, 9.16);
    build(&rigid, 0, 1);
    OK(rigid.session, spar_aero_solve(rigid.aero, 1.225, rigid.wind[0], 1.0));
    OK(rigid.session, spar_aero_get_rotor(rigid.aero, &value[0][0], &value[0][1], &value[0][2]));
    for (int elements = 1; elements <= 2; elements++) {
        begin(&beam, 8.0, 9.16);
        build(&beam, elements, 8);
        OK(beam.session, spar_aero_solve(beam.aero, 1.225, beam.wind[0], 1.0));
        check_reference(&beam, &references[0]);
        check_reference_load(&beam);
        OK(beam.session, spar_aero_get_rotor(beam.aero, &value[1][0], &value[1][1], &value[1][2]));
        for (int i = 0; i < 3; i++) {
            assert_true(fabs(value[1][i] / value[0][i] - 1.0) < 1e-10);
        }
        end(&beam);
    }
    end(&rigid);
}

/* The reader: the rigid blade has the mass of the table. Turning about the hub its kinetic energy is Omega^2/2 int mu
   (1.5 + x)^2 dx; with mu linear between the table's points the integrals of mu, mu x, mu x^2 are 16844.75 kg, 345672.0
   kg m and 1.1188347e7 kg m^2 (summed apart, over 200 parts of each interval). The reader sums by the trapezium rule:
   2e-3. The sections' own inertia adds some 1e-4, beams integrate by Gauss: 5e-3. Bad directories are refused with the
   file's name. */
static void test_reader(void **state) {
    (void)state;
    double inertia = 1.1188347e7 + 2.0 * 1.5 * 345672.0 + 1.5 * 1.5 * 16844.75;
    for (int elements = 0; elements <= 1; elements++) {
        scene s;
        double energy[4];
        begin(&s, 8.0, 9.16);
        build(&s, elements, elements > 0 ? 10 : 1);
        for (int b = 0; b < BLADES; b++) {
            OK(s.session, spar_member_get_energy(s.blade[b], 4, energy));
            double ratio = energy[0] / (0.5 * inertia * s.speed * s.speed);
            assert_true(fabs(ratio - 1.0) < (elements > 0 ? 5e-3 : 2e-3));
        }
        end(&s);
    }
    nrel5mw data;
    assert_int_equal(nrel5mw_load(&data, "/nowhere"), SPAR_ERR_IO);
    assert_non_null(strstr(data.message, "/nowhere/rotor.txt"));
    nrel5mw_free(&data);
}

/* Which effect is worth how much, and that each does what it says: against the same rotor with all of them. The signs
   are theory: tip loss, swirl and drag cost power, no induction gives a multiple; at the hub there are only
   cylinders, whose little torque does not tell. */
static void test_effects(void **state) {
    (void)state;
    enum { ALL = 63 };
    static const struct {
        int off, lower, upper; /* power with the effect off over power with all, per mille, within */
    } expected[] = {{0, 1000, 1000},
                    {SPAR_AERO_MOMENT, 1000, 1000},
                    {SPAR_AERO_TIP_LOSS, 1010, 1100},
                    {SPAR_AERO_HUB_LOSS, 999, 1001},
                    {SPAR_AERO_SWIRL, 1002, 1060},
                    {SPAR_AERO_DRAG, 1010, 1150},
                    {SPAR_AERO_INDUCTION, 2000, 6000}};
    scene s;
    begin(&s, 8.0, 9.16);
    build(&s, 0, 1);
    double full = 0.0, power;
    for (size_t i = 0; i < sizeof expected / sizeof expected[0]; i++) {
        OK(s.session, spar_aero_set_effects(s.aero, ALL & ~expected[i].off));
        OK(s.session, spar_aero_solve(s.aero, 1.225, s.wind[0], 1.0));
        OK(s.session, spar_aero_get_rotor(s.aero, NULL, NULL, &power));
        full = i == 0 ? power : full;
        print_message("without %2d: power x %.4f\n", expected[i].off, power / full);
        assert_true(power / full >= 1e-3 * expected[i].lower - 1e-9 && power / full <= 1e-3 * expected[i].upper + 1e-9);
    }
    double moment[BLADES * N][3], cd[BLADES * N];
    OK(s.session, spar_aero_set_effects(s.aero, 0));
    OK(s.session, spar_aero_solve(s.aero, 1.225, s.wind[0], 1.0));
    OK(s.session, spar_aero_get_loads(s.aero, NULL, NULL, moment[0]));
    OK(s.session, spar_aero_get_sections(s.aero, NULL, NULL, cd, NULL, NULL));
    for (int k = 0; k < BLADES * N; k++) {
        assert_true(cd[k] == 0.0 && moment[k][0] == 0.0 && moment[k][1] == 0.0 && moment[k][2] == 0.0);
    }
    end(&s);
}

static void rotate(const double psi[3], double x[3]) { /* Rodrigues */
    double angle = sqrt(psi[0] * psi[0] + psi[1] * psi[1] + psi[2] * psi[2]), k[3], c[3];
    for (int i = 0; i < 3; i++) {
        k[i] = psi[i] / angle;
    }
    double along = k[0] * x[0] + k[1] * x[1] + k[2] * x[2];
    c[0] = k[1] * x[2] - k[2] * x[1], c[1] = k[2] * x[0] - k[0] * x[2], c[2] = k[0] * x[1] - k[1] * x[0];
    for (int i = 0; i < 3; i++) {
        x[i] = cos(angle) * x[i] + sin(angle) * c[i] + (1.0 - cos(angle)) * along * k[i];
    }
}

/* The whole set-up turned (and set down elsewhere): thrust, torque, power the same, forces turned, to 1e-11 of their
   size. The wind has sideways parts and shear, so that no symmetry helps. */
static void test_turned(void **state) {
    (void)state;
    const double psi[3] = {0.7, -2.1, 1.3};
    scene one, two;
    double value[2][3], force[2][BLADES * N][3];
    begin(&one, 8.0, 9.16);
    begin(&two, 8.0, 9.16);
    rotate(psi, two.rotor.axis);
    rotate(psi, two.rotor.up);
    two.rotor.hub[0] = 12.0, two.rotor.hub[1] = -5.0, two.rotor.hub[2] = 90.0;
    for (int k = 0; k < BLADES * N; k++) {
        one.wind[k][1] = 1.5, one.wind[k][0] += 0.05 * k;
        memcpy(two.wind[k], one.wind[k], sizeof two.wind[k]);
        rotate(psi, two.wind[k]);
    }
    scene *both[] = {&one, &two};
    for (int i = 0; i < 2; i++) {
        build(both[i], 1, 7);
        OK(both[i]->session, spar_aero_solve(both[i]->aero, 1.225, both[i]->wind[0], 1.0));
        OK(both[i]->session, spar_aero_get_rotor(both[i]->aero, &value[i][0], &value[i][1], &value[i][2]));
        OK(both[i]->session, spar_aero_get_loads(both[i]->aero, NULL, force[i][0], NULL));
    }
    for (int i = 0; i < 3; i++) {
        assert_true(fabs(value[1][i] / value[0][i] - 1.0) < 1e-11);
    }
    for (int k = 0; k < BLADES * N; k++) {
        rotate(psi, force[0][k]);
        for (int i = 0; i < 3; i++) {
            assert_true(fabs(force[1][k][i] - force[0][k][i]) < 1e-11 * 14000.0);
        }
    }
    end(&one);
    end(&two);
}

/* A rotor whose blades are spread over three objects, as over three ranks, each told that there are three blades: their
   sums are the one object's figures. */
static void test_spread(void **state) {
    (void)state;
    scene s;
    begin(&s, 8.0, 9.16);
    build(&s, 0, 1);
    double whole[3], sum[3] = {0.0, 0.0, 0.0}, twist[N], power;
    OK(s.session, spar_aero_solve(s.aero, 1.225, s.wind[0], 1.0));
    OK(s.session, spar_aero_get_rotor(s.aero, &whole[0], &whole[1], &whole[2]));
    for (int b = 0; b <= BLADES; b++) { /* the last has none */
        spar_aero *part = NULL;
        spar_fluid *fluid = NULL;
        int n = b < BLADES;
        if (n) {
            OK(s.session, nrel5mw_create_sections(&s.data, &s.rotor, b, s.blade[b], &fluid, twist));
        }
        OK(s.session, nrel5mw_create_aero(&s.data, &s.rotor, n, n ? &fluid : NULL, twist, &part));
        OK(s.session,
           spar_aero_set_section(part, 0, 3.542, twist[0], NULL) == SPAR_ERR_ARGUMENT ? SPAR_OK : SPAR_ERR_USER);
        OK(s.session, spar_aero_solve(part, 1.225, n ? s.wind[0] : NULL, 1.0));
        double value[3];
        OK(s.session, spar_aero_get_rotor(part, &value[0], &value[1], &power));
        value[2] = power;
        for (int i = 0; i < 3; i++) {
            sum[i] += value[i];
        }
        spar_aero_destroy(&part);
        spar_fluid_destroy(&fluid);
    }
    for (int i = 0; i < 3; i++) {
        assert_true(fabs(sum[i] / whole[i] - 1.0) < 1e-13);
    }
    end(&s);
}

/* A host of its own loop whose wind is broken on this rank: the step's check says so, the step can be gone back on and
 * done anew. */
static void test_broken_step(void **state) {
    (void)state;
    scene s;
    int done;
    double thrust[2];
    begin(&s, 8.0, 9.16);
    build(&s, 0, 1);
    for (int broken = 1; broken >= 0; broken--) {
        for (int b = 0; b < BLADES; b++) {
            double q[7], v[6], a[6];
            nrel5mw_root_motion(&s.data, &s.rotor, b, 0.05 * s.speed, s.speed, 0.0, q, v, a);
            OK(s.session, spar_member_drive(s.blade[b], q, v, a));
        }
        OK(s.session, spar_step_begin(s.session, 0.05));
        OK(s.session, spar_step_solve(s.session));
        s.wind[N + 2][0] = broken ? NAN : 8.0;
        assert_int_equal(spar_aero_solve(s.aero, 1.225, s.wind[0], 1.0), broken ? SPAR_ERR_ARGUMENT : SPAR_OK);
        assert_non_null(strstr(spar_session_message(s.session), "section 2"));
        assert_int_equal(spar_step_check(s.session, &done), broken ? SPAR_ERR_ARGUMENT : SPAR_OK);
        OK(s.session, broken ? spar_step_reject(s.session) : spar_step_accept(s.session));
    }
    OK(s.session, spar_aero_get_rotor(s.aero, &thrust[0], NULL, NULL));
    end(&s);
    begin(&s, 8.0, 9.16);
    build(&s, 0, 1);
    step(&s, 0.05 * s.speed, 0.05);
    OK(s.session, spar_aero_get_rotor(s.aero, &thrust[1], NULL, NULL));
    assert_true(thrust[0] == thrust[1]);
    end(&s);
}

/* Every refusal has its status and names the place, and the object goes on as before. */
static void test_refused(void **state) {
    (void)state;
    scene s;
    begin(&s, 8.0, 9.16);
    build(&s, 0, 1);
    double before, after, twist[N], hub[3] = {0, 0, 0}, axis[3] = {1, 0, 0}, none[3] = {0, 0, 0}, bad[3] = {0, NAN, 0};
    spar_aero *aero = NULL;
    REFUSED(s.session, SPAR_ERR_STATE, "spar_aero_solve", spar_aero_get_rotor(s.aero, NULL, NULL, NULL));
    REFUSED(s.session, SPAR_ERR_STATE, "spar_aero_solve", spar_aero_get_sections(s.aero, NULL, NULL, NULL, NULL, NULL));
    OK(s.session, spar_aero_solve(s.aero, 1.225, s.wind[0], 1.0));
    OK(s.session, spar_aero_get_rotor(s.aero, &before, NULL, NULL));
    s.wind[2 * N + 5][1] = NAN;
    REFUSED(s.session, SPAR_ERR_ARGUMENT, "'sections3', blade 2, section 5",
            spar_aero_solve(s.aero, 1.225, s.wind[0], 1.0));
    s.wind[2 * N + 5][1] = 0.0;
    REFUSED(s.session, SPAR_ERR_ARGUMENT, "density", spar_aero_solve(s.aero, NAN, s.wind[0], 1.0));
    REFUSED(s.session, SPAR_ERR_ARGUMENT, "density", spar_aero_solve(s.aero, -1.0, s.wind[0], 1.0));
    REFUSED(s.session, SPAR_ERR_ARGUMENT, "inflow", spar_aero_solve(s.aero, 1.225, NULL, 1.0));
    assert_int_equal(spar_aero_solve(s.aero, 1.225, s.wind[0], 1.5), SPAR_ERR_ARGUMENT);
    REFUSED(s.session, SPAR_ERR_ARGUMENT, "no section 19", spar_aero_set_section(s.aero, N, 1.0, 0.0, NULL));
    REFUSED(s.session, SPAR_ERR_ARGUMENT, "no section -1", spar_aero_set_section(s.aero, -1, 1.0, 0.0, NULL));
    REFUSED(s.session, SPAR_ERR_ARGUMENT, "chord", spar_aero_set_section(s.aero, 3, -1.0, 0.0, NULL));
    REFUSED(s.session, SPAR_ERR_ARGUMENT, "twist", spar_aero_set_section(s.aero, 3, 1.0, NAN, NULL));
    REFUSED(s.session, SPAR_ERR_ARGUMENT, "polar is NULL", spar_aero_set_section(s.aero, 3, 1.0, 0.0, NULL));
    REFUSED(s.session, SPAR_ERR_ARGUMENT, "axis has length 0", spar_aero_set_rotor(s.aero, hub, none, 1.5, 63.0));
    REFUSED(s.session, SPAR_ERR_ARGUMENT, "not finite", spar_aero_set_rotor(s.aero, bad, axis, 1.5, 63.0));
    REFUSED(s.session, SPAR_ERR_ARGUMENT, "tip radius", spar_aero_set_rotor(s.aero, hub, axis, 63.0, 63.0));
    REFUSED(s.session, SPAR_ERR_ARGUMENT, "hub radius", spar_aero_set_rotor(s.aero, hub, axis, NAN, 63.0));
    REFUSED(s.session, SPAR_ERR_ARGUMENT, "2048", spar_aero_set_effects(s.aero, 2048));
    REFUSED(s.session, SPAR_ERR_ARGUMENT, "right-handed", spar_aero_set_turn(s.aero, 0));
    REFUSED(s.session, SPAR_ERR_ARGUMENT, "2 blades in total", spar_aero_set_blades(s.aero, 2));
    REFUSED(s.session, SPAR_ERR_ARGUMENT, "blade 1 is NULL",
            spar_aero_create(2, (spar_fluid *[]){s.fluid[0], NULL}, &aero));
    assert_int_equal(spar_aero_create(-1, NULL, &aero), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_aero_create(3, NULL, &aero), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_aero_create(3, s.fluid, NULL), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_aero_solve(NULL, 1.225, NULL, 1.0), SPAR_ERR_ARGUMENT);
    spar_fluid *fluid = NULL;
    OK(s.session, spar_fluid_create(s.blade[0], "other", &fluid));
    OK(s.session, spar_fluid_set_stations(fluid, 1, (double[]){0.0}, NULL));
    OK(s.session, spar_fluid_map(fluid));
    REFUSED(s.session, SPAR_ERR_ARGUMENT, "at least 2", spar_aero_create(1, &fluid, &aero));
    OK(s.session, spar_fluid_set_stations(fluid, 2, (double[]){0.0, 0.0}, NULL));
    REFUSED(s.session, SPAR_ERR_STATE, "spar_fluid_map", spar_aero_create(1, &fluid, &aero));
    OK(s.session, spar_fluid_map(fluid));
    REFUSED(s.session, SPAR_ERR_ARGUMENT, "the same position", spar_aero_create(1, &fluid, &aero));
    REFUSED(s.session, SPAR_ERR_ARGUMENT, "blade 0 has 19",
            spar_aero_create(2, (spar_fluid *[]){s.fluid[0], fluid}, &aero));
    assert_null(aero);
    OK(s.session, spar_aero_create(1, &s.fluid[0], &aero));
    REFUSED(s.session, SPAR_ERR_STATE, "section 0 has no chord", spar_aero_solve(aero, 1.225, s.wind[0], 1.0));
    OK(s.session, spar_aero_set_effects(aero, SPAR_AERO_INDUCTION));
    REFUSED(s.session, SPAR_ERR_STATE, "spar_aero_set_rotor", spar_aero_solve(aero, 1.225, s.wind[0], 1.0));
    spar_aero_destroy(&aero);
    assert_null(aero);
    spar_aero_destroy(&aero);
    spar_aero_destroy(NULL);
    spar_fluid_destroy(&fluid);
    OK(s.session, nrel5mw_create_sections(&s.data, &s.rotor, 0, s.blade[0], &fluid, twist));
    OK(s.session, spar_aero_solve(s.aero, 1.225, s.wind[0], 1.0));
    OK(s.session, spar_aero_get_rotor(s.aero, &after, NULL, NULL));
    assert_true(before == after);
    end(&s);
}

/* What is refused when other blades could have had their loads already leaves those, and what the last solve found. */
static void test_all_or_none(void **state) {
    (void)state;
    scene s;
    double before[4][8], after[4][8], thrust[2];
    begin(&s, 8.0, 9.16);
    build(&s, 0, 1);
    OK(s.session, spar_aero_solve(s.aero, 1.225, s.wind[0], 1.0));
    OK(s.session, spar_aero_get_rotor(s.aero, thrust, NULL, NULL));
    for (int k = 0; k < 3; k++) {
        OK(s.session, spar_fluid_get_audit(s.fluid[k], 8, before[k]));
    }
    scene other; /* what is wrong with a blade of another session is told in that of blade 0 */
    spar_aero *mixed = NULL;
    begin(&other, 8.0, 9.16);
    build(&other, 0, 1);
    REFUSED(s.session, SPAR_ERR_ARGUMENT, "to another session",
            spar_aero_create(2, (spar_fluid *[]){s.fluid[0], other.fluid[0]}, &mixed));
    end(&other);
    s.wind[0][0] += 1;            /* other loads on blade 0, */
    s.wind[2 * N + 5][1] = 1e308; /* none that can be taken on blade 2 */
    REFUSED(s.session, SPAR_ERR_NUMERIC, "blade 2, section ", spar_aero_solve(s.aero, 1.225, s.wind[0], 1.0));
    s.wind[2 * N + 5][1] = 0;
    for (int k = 0; k < 3; k++) {
        OK(s.session, spar_fluid_get_audit(s.fluid[k], 8, after[k]));
        assert_memory_equal(before[k], after[k], sizeof before[k]);
    }
    s.wind[0][0] -= 1;
    OK(s.session, spar_aero_solve(s.aero, 1.225, s.wind[0], 1.0));
    OK(s.session, spar_step(s.session, 0.05, NULL, NULL, NULL));
    OK(s.session, spar_fluid_get_audit(s.fluid[0], 8, before[0]));
    REFUSED(s.session, SPAR_ERR_STATE, "spar_aero_solve: no step is in progress",
            spar_aero_solve(s.aero, 2, s.wind[0], 1.0));
    OK(s.session, spar_fluid_get_audit(s.fluid[0], 8, after[0]));
    assert_memory_equal(before[0], after[0], sizeof before[0]);
    OK(s.session, spar_aero_get_rotor(s.aero, thrust + 1, NULL, NULL));
    assert_true(thrust[0] == thrust[1]);
    end(&s);
}

/* A fluid mapped anew with more sections than the object was made for, or with none: refused, and so is a step begun
   on it; nothing is read beyond what there is. */
static void test_mapped_anew(void **state) {
    (void)state;
    static const int64_t count[] = {40 * N, 0};
    for (int k = 0; k < 2; k++) {
        scene s;
        int done;
        double *eta = calloc((size_t)count[k] + 1, sizeof *eta);
        begin(&s, 8.0, 9.16);
        build(&s, 0, 1);
        OK(s.session, spar_fluid_set_stations(s.fluid[0], count[k], eta, NULL));
        OK(s.session, spar_fluid_map(s.fluid[0]));
        OK(s.session, spar_step_begin(s.session, 0.05));
        OK(s.session, spar_step_solve(s.session));
        REFUSED(s.session, SPAR_ERR_STATE, "make a new one", spar_aero_solve(s.aero, 1.225, s.wind[0], 1.0));
        REFUSED(s.session, SPAR_ERR_STATE, "make a new one", spar_step_check(s.session, &done));
        OK(s.session, spar_step_reject(s.session));
        free(eta);
        end(&s);
    }
}

/* Motion sections that are given anew and not mapped: refused, and the last solution stays, to the bit. */
static void test_motion_sections_not_mapped(void **state) {
    (void)state;
    static const double eta[N] = {0};
    double before[3][N] = {{0}}, after[3][N] = {{0}};
    scene s;
    begin(&s, 8.0, 9.16);
    build(&s, 0, 1);
    OK(s.session, spar_aero_solve(s.aero, 1.225, s.wind[0], 1.0));
    OK(s.session, spar_aero_get_sections(s.aero, before[0], NULL, NULL, NULL, NULL));
    OK(s.session, spar_fluid_set_motion_stations(s.fluid[0], N, eta, NULL));
    s.wind[0][0] += 1;
    REFUSED(s.session, SPAR_ERR_STATE, "not mapped", spar_aero_solve(s.aero, 1.225, s.wind[0], 1.0));
    OK(s.session, spar_aero_get_sections(s.aero, after[0], NULL, NULL, NULL, NULL));
    assert_memory_equal(before, after, sizeof before);
    end(&s);
}

/* A wing in steady flow, no rotor: closed form of lift and of the lumped shares. Straight along x from 0 to 4 m, chord
   1 m, flow (0, 20, 0) across it from the leading edge; z = x cross y is the pressure side, so lift points along -z.
   Constant cl 0.8, three sections 1 m and 3 m apart: per length f = rho/2 V^2 c cl; shares f/2, f/2 + 3f/2, 3f/2
   exactly. */
static void test_wing(void **state) {
    (void)state;
    double x[3] = {0, 0, 0}, q[4] = {1, 0, 0, 0}, alpha[] = {-PI, 0.0, PI}, cl[] = {0.8, 0.8, 0.8},
           cd[] = {0.0, 0.0, 0.0}, cm[] = {-0.1, -0.1, -0.1};
    double offset[3][3] = {{0, 0, 0}, {1, 0, 0}, {4, 0, 0}}, eta[3] = {0, 0, 0},
           wind[3][3] = {{0, 20, 0}, {0, 20, 0}, {0, 20, 0}};
    double force[3][3], moment[3][3], f = 0.5 * 1.2 * 400.0 * 0.8, m = -0.1 * 0.5 * 1.2 * 400.0,
                                      share[3] = {0.5, 2.0, 1.5};
    spar_session *session;
    spar_member *body;
    spar_fluid *fluid;
    spar_polar *polar;
    spar_aero *aero;
    OK(NULL, spar_session_create(&session));
    OK(session, spar_point_create(session, "wing", x, q, &body));
    OK(session, spar_member_commit(body));
    OK(session, spar_fluid_create(body, "air", &fluid));
    OK(session, spar_fluid_set_stations(fluid, 3, eta, offset[0]));
    OK(session, spar_fluid_map(fluid));
    OK(session, spar_aero_create(1, &fluid, &aero));
    OK(session, spar_polar_create(3, alpha, cl, cd, cm, &polar));
    double chord[3] = {7.0, 7.0, 7.0}, twist[3];
    OK(session, spar_aero_set_section(aero, 0, 1.0, 0.0, polar));
    assert_int_equal(spar_aero_get_chord(aero, chord, twist), SPAR_ERR_STATE); /* two have none */
    assert_true(chord[0] == 7.0);
    for (int i = 0; i < 3; i++) {
        OK(session, spar_aero_set_section(aero, i, 1.0, 0.0, polar));
    }
    spar_polar_destroy(&polar); /* the sections keep it */
    OK(session, spar_aero_solve(aero, 1.2, wind[0], 1.0));
    OK(session, spar_aero_get_loads(aero, NULL, force[0], moment[0]));
    for (int i = 0; i < 3; i++) {
        assert_true(fabs(force[i][2] + share[i] * f) < 1e-12 * f && fabs(force[i][0]) + fabs(force[i][1]) < 1e-12 * f);
        assert_true(fabs(moment[i][0] - share[i] * m) < 1e-12 * f);
    }
    assert_int_equal(spar_aero_get_rotor(aero, NULL, NULL, NULL), SPAR_ERR_STATE);
    /* What reaches the member: the moment of the forces about the root, about y, and 4 m of pitching moment about x;
       with the effect off the first alone. */
    double audit[8], bending = (2.0 + 4.0 * 1.5) * f;
    OK(session, spar_fluid_get_audit(fluid, 8, audit));
    assert_true(fabs(audit[1] - hypot(bending, 4.0 * m)) < 1e-11 * f);
    OK(session, spar_aero_set_effects(aero, SPAR_AERO_DRAG));
    OK(session, spar_aero_solve(aero, 1.2, wind[0], 1.0));
    OK(session, spar_aero_get_loads(aero, NULL, force[0], moment[0]));
    OK(session, spar_fluid_get_audit(fluid, 8, audit));
    assert_true(fabs(audit[1] - bending) < 1e-11 * f);
    for (int i = 0; i < 3; i++) {
        assert_true(fabs(force[i][2] + share[i] * f) < 1e-12 * f);
        assert_true(moment[i][0] == 0.0 && moment[i][1] == 0.0 && moment[i][2] == 0.0);
    }
    /* A polar of 0.1 rad on the middle section, flow from below at 0.2 rad: its end value, and a flag. */
    int flags[3];
    double lift[3];
    OK(session, spar_polar_create(2, (double[]){0.0, 0.1}, (double[]){0.0, 0.5}, (double[]){0.0, 0.0}, NULL, &polar));
    OK(session, spar_aero_set_section(aero, 1, 1.0, 0.0, polar));
    spar_polar_destroy(&polar);
    for (int i = 0; i < 3; i++) {
        wind[i][2] = -20.0 * tan(0.2);
    }
    OK(session, spar_aero_solve(aero, 1.2, wind[0], 1.0));
    OK(session, spar_aero_get_flags(aero, flags, NULL));
    OK(session, spar_aero_get_sections(aero, NULL, lift, NULL, NULL, NULL));
    assert_true(flags[0] == 0 && flags[1] == SPAR_AERO_FLAG_BEYOND_POLAR && flags[2] == 0);
    assert_true(lift[0] == 0.8 && lift[1] == 0.5);
    /* What was set is read, the twist within a turn; a refused section stays as it was. */
    OK(session, spar_polar_create(3, alpha, cl, cd, cm, &polar));
    OK(session, spar_aero_set_section(aero, 1, 2.5, -0.3, polar));
    OK(session, spar_aero_set_section(aero, 2, 0.0, 4.0, polar));
    assert_int_equal(spar_aero_set_section(aero, 0, -1.0, 0.2, polar), SPAR_ERR_ARGUMENT);
    spar_polar_destroy(&polar);
    OK(session, spar_aero_get_chord(aero, chord, NULL));
    OK(session, spar_aero_get_chord(aero, NULL, twist));
    assert_true(chord[0] == 1.0 && chord[1] == 2.5 && chord[2] == 0.0);
    assert_true(twist[0] == 0.0 && fabs(twist[1] + 0.3) < 1e-15);
    assert_true(fabs(twist[2] - (4.0 - 2.0 * acos(-1.0))) < 1e-15);
    assert_int_equal(spar_aero_get_chord(NULL, chord, twist), SPAR_ERR_ARGUMENT);
    spar_aero_destroy(&aero);
    spar_session_destroy(&session);
}

/* A report whose callbacks destroy what it is about: it is refused, and the session goes on. */
typedef struct ending {
    scene s;
    spar_trial *trial;
    int which, steps; /* 0: the trial, 1: the aero object; calls until then */
} ending;

static int end_something(spar_session *session, double t, double dt, void *context) {
    ending *e = context;
    (void)session, (void)t, (void)dt;
    if (--e->steps == 0 && e->which == 0) {
        spar_trial_destroy(&e->trial);
    } else if (e->steps == 0) {
        spar_aero_destroy(&e->s.aero);
    }
    return 0;
}

static int solve_ending(spar_session *session, double t, double dt, int iteration, void *context) {
    ending *e = context;
    return e->s.aero ? solve_aero(session, t, dt, iteration, &e->s) : 0;
}

static void test_destroyed_in_report(void **state) {
    (void)state;
    for (int k = 0; k < 6; k++) {
        ending e = {.which = k % 2, .steps = 1 + 10 * (k / 2)}; /* in the first, second and third run of 8 steps */
        begin(&e.s, 8.0, 9.16);
        build(&e.s, 0, 0);
        step(&e.s, 0.01, 0.01);
        OK(e.s.session, spar_trial_create(e.s.session, &e.trial));
        OK(e.s.session, spar_trial_set_steps(e.trial, 0.01, 8));
        OK(e.s.session, spar_trial_set_callbacks(e.trial, end_something, &e, solve_ending, &e));
        REFUSED(e.s.session, SPAR_ERR_STATE, k < 2 ? "spar_aero_report_effects" : "destroyed the",
                spar_aero_report_effects(e.s.aero, e.trial));
        assert_true((e.which ? (void *)e.s.aero : (void *)e.trial) == NULL);
        OK(e.s.session, spar_step(e.s.session, 0.01, NULL, NULL, NULL));
        end(&e.s);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_destroyed_in_report),
                                       cmocka_unit_test(test_aerodyn_rigid),
                                       cmocka_unit_test(test_aerodyn_beam),
                                       cmocka_unit_test(test_reader),
                                       cmocka_unit_test(test_effects),
                                       cmocka_unit_test(test_turned),
                                       cmocka_unit_test(test_spread),
                                       cmocka_unit_test(test_broken_step),
                                       cmocka_unit_test(test_refused),
                                       cmocka_unit_test(test_mapped_anew),
                                       cmocka_unit_test(test_motion_sections_not_mapped),
                                       cmocka_unit_test(test_wing),
                                       cmocka_unit_test(test_all_or_none)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
