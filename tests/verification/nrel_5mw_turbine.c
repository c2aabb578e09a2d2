/* The NREL 5-MW turbine of examples/turbine_model.c under its published controller in steady wind, against the steady
   states of its report (Jonkman, Butterfield, Musial, Scott, NREL/TP-500-38060, 2009, figure 9-1), found with FAST,
   whose blades bend and do not twist.
   - Rigid blades: speed to the digits given, 0.01 rev/min; pitch to 0.15 degrees (bending left out). At 11.4 m/s, where
   the wind just gives the rated power, the speed alone.
   - Flexible blades twist towards feather: speed 0.05 rev/min below at 8 m/s and 0.2 at 11.4 m/s, a degree less pitch
   at 18 m/s.
   - The shaft's power above rated, 5296.61 kW, is the controller's; in the mean the air's torque is the generator's, to
   1e-3. Means of the last 6 s of 48, step 0.04 s, blades of 6 nodes: from finer ones they differ by 0.002 rev/min and
   0.01 deg. A rotor under constant torque, one body on a hinge: its acceleration is torque over inertia, its turn
   counts up. */
#include "verification.h"

#include "turbine_control.h"
#include "turbine_model.h"

static const double pi = 3.14159265358979323846;

typedef struct steady {
    double speed, pitch, power,
        balance; /* rev/min, deg, kW; torque of the air, less what speeds the rotor up, over the generator's */
} steady;

typedef struct stand {
    turbine machine;
    double wind;
} stand;

static void wind_at(const double x[3], double t, void *context, double wind[3]) {
    (void)x, (void)t;
    wind[0] = ((stand *)context)->wind;
    wind[1] = wind[2] = 0;
}

static int solve_air(spar_session *s, double t, double dt, int iteration, void *context) {
    (void)s, (void)iteration;
    return turbine_blow(&((stand *)context)->machine, wind_at, context, t + dt);
}

static steady run(int elements, double wind, double rpm, double degrees) {
    const turbine_options how = {SPAR_DATA_DIR "/nrel5mw", elements, 6, 1, 6, degrees * pi / 180, 0, 1, 0, 0};
    const double dt = 0.04;
    stand st = {.wind = wind};
    turbine_control c;
    steady mean = {0, 0, 0, 0};
    const double inertia = 36.87e6 + 534.116 * 97 * 97; /* of rotor (these blades') and generator */
    double air = 0, generator = 0, first = 0, last = 0;
    spar_session *s = scene_session();
    OK(s, spar_session_set_gravity(s, (double[]){0, 0, -9.80665}));
    OK(s, spar_session_set_integrator(s, 0.8, 1));
    OK(s, spar_session_set_coupling(s, SPAR_COUPLING_FIXED_POINT, 0, 1e-5, 30));
    OK(s, turbine_create(&st.machine, s, &how));
    OK(s, turbine_start(&st.machine, rpm * pi / 30, wind_at, &st, 4));
    turbine_control_begin(&c, turbine_gear * rpm * pi / 30, how.pitch);
    for (int i = 0; i < 1200; i++) {
        double angle, speed, twist, torque;
        OK(s, turbine_get_shaft(&st.machine, &angle, &speed, &twist));
        turbine_control_step(&c, turbine_gear * speed, dt);
        OK(s, turbine_set_torque(&st.machine, turbine_gear * c.torque));
        OK(s, turbine_set_pitch(&st.machine, c.pitch, c.rate));
        OK(s, spar_step(s, dt, solve_air, &st, NULL));
        OK(s, spar_aero_get_rotor(st.machine.aero, NULL, &torque, NULL));
        if (i >= 1050) {
            mean.speed += speed * 30 / pi / 150;
            mean.pitch += c.pitch * 180 / pi / 150;
            mean.power += 1e-3 * turbine_gear * c.torque * speed / 150;
            air += torque, generator += turbine_gear * c.torque;
            first = i == 1050 ? speed : first, last = speed;
        }
    }
    mean.balance = (air / 150 - inertia * (last - first) / (149 * dt)) / (generator / 150);
    turbine_free(&st.machine);
    spar_session_destroy(&s);
    return mean;
}

static void test_steady(void **state) {
    (void)state;
    static const double report[3][3] = {{8, 9.16, 0}, {11.4, 12.1, 0}, {18, 12.1, 14.92}}; /* m/s, rev/min, deg */
    static const double slower[3] = {0.05, 0.2, 0.01};                                     /* flexible */
    for (int flexible = 0; flexible <= 1; flexible++) {
        for (int k = 0; k < 3; k++) {
            const double *r = report[k];
            char what[96], start[48];
            steady m = run(flexible, r[0], r[1], r[2]);
            snprintf(start, sizeof start, "%g m/s, %s blades", r[0], flexible ? "flexible" : "rigid");
            snprintf(what, sizeof what, "%s: speed, rev/min", start);
            verify(what, m.speed, r[1], flexible ? slower[k] : 0.01, "NREL/TP-500-38060");
            if (k != 1) {
                snprintf(what, sizeof what, "%s: pitch, deg", start);
                verify(what, m.pitch, r[2], flexible ? 1.1 : 0.15, "NREL/TP-500-38060");
            }
            if (k == 2) {
                snprintf(what, sizeof what, "%s: shaft power, kW", start);
                verify(what, m.power, 5296.61, 0.5, "NREL/TP-500-38060");
            }
            snprintf(what, sizeof what, "%s: torque, air / generator", start);
            verify(what, m.balance, 1, 1e-3, "balance");
        }
    }
    verified();
}

/* Parked with the generator's brake on, without wind and weight. Index 11 is left out: the collective edge of the
   blades with the tower's second side to side, which the report's table does not have. */
static void test_frequencies(void **state) {
    (void)state;
    static const struct {
        const char *name;
        int index;
        double fast, adams;
    } report[13] = {{"1st tower, side to side", 0, 0.3120, 0.3164}, {"1st tower, fore and aft", 1, 0.3240, 0.3195},
                    {"1st drivetrain torsion", 2, 0.6205, 0.6094},  {"1st flap, yaw", 3, 0.6664, 0.6296},
                    {"1st flap, pitch", 4, 0.6675, 0.6686},         {"1st flap, collective", 5, 0.6993, 0.7019},
                    {"1st edge, pitch", 6, 1.0793, 1.0740},         {"1st edge, yaw", 7, 1.0898, 1.0877},
                    {"2nd flap, yaw", 8, 1.9337, 1.6507},           {"2nd flap, pitch", 9, 1.9223, 1.8558},
                    {"2nd flap, collective", 10, 2.0205, 1.9601},   {"2nd tower, fore and aft", 12, 2.9003, 2.8590},
                    {"2nd tower, side to side", 13, 2.9361, 2.9408}};
    const turbine_options how = {SPAR_DATA_DIR "/nrel5mw", 1, 10, 1, 8, 0, 0, 1, 0, 0};
    const double brake[36] = {[21] = 1e12};
    turbine t;
    double f[14];
    spar_session *s = scene_session();
    OK(s, turbine_create(&t, s, &how));
    OK(s, spar_joint_set_spring(t.shaft, brake, NULL, NULL));
    OK(s, spar_member_solve_modes(t.tower, 14, f, NULL));
    for (int k = 0; k < 13; k++) {
        char what[64];
        snprintf(what, sizeof what, "parked: %s, Hz", report[k].name);
        verify(what, f[report[k].index], report[k].fast,
               fabs(report[k].fast - report[k].adams) + 0.035 * report[k].fast, "FAST, table 9-1");
    }
    turbine_free(&t);
    spar_session_destroy(&s);
    verified();
}

/* 12 000 N m on 38 759 236 kg m^2, 500 kg at 0.4 m of it off the shaft, without weight. */
static void test_free_rotor(void **state) {
    (void)state;
    const double I = 38759236, torque = 12000, m = 500, c[3] = {0, 0.4, 0}, J[3] = {I - m * 0.16, 2e7, 2e7},
                 zero[3] = {0}, straight[4] = {1, 0, 0, 0}, dt = 0.5;
    double M[36], z[6], rate[6];
    spar_session *s = scene_session();
    spar_member *rotor = NULL;
    spar_joint *shaft = NULL;
    scene_mass(M, m, c, J);
    OK(s, spar_rigid_create(s, "rotor", zero, straight, M, &rotor));
    OK(s, spar_member_commit(rotor));
    OK(s, spar_joint_create(s, "shaft", rotor, 0, NULL, 0, SPAR_FREE_RX, &shaft));
    OK(s, spar_joint_set_load(shaft, (double[]){0, 0, 0, torque, 0, 0}));
    for (int i = 0; i < 1000; i++) {
        OK(s, spar_step(s, dt, NULL, NULL, NULL));
    }
    OK(s, spar_joint_get_motion(shaft, z, rate, NULL));
    verify("free rotor after 500 s: speed, rad/s", rate[3], torque / I * 500, 1e-12, "torque / inertia");
    verify("free rotor after 500 s: angle, rad", z[3], torque / I * 500 * 500 / 2, 1e-9, "torque / inertia");
    spar_session_destroy(&s);
    verified();
}

VERIFICATION_MAIN("NREL 5-MW turbine", cmocka_unit_test(test_steady), cmocka_unit_test(test_free_rotor),
                  cmocka_unit_test(test_frequencies))
