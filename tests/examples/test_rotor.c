/* The rotor program as a user runs it: its figures against AeroDyn's, its answers on several ranks against those on
   one, and what it says to bad input. It needs the examples; where they are not built, the tests are skipped. */
#include "scene.h"

#include <stdio.h>
#include <sys/wait.h>

#ifndef ROTOR_PROGRAM
#define ROTOR_PROGRAM ""
#endif
#ifndef EFFECTS_PROGRAM
#define EFFECTS_PROGRAM ""
#endif
#ifndef ROTOR_LAUNCHER
#define ROTOR_LAUNCHER ""
#endif

/* A table of numbers with a line of names on top. */
typedef struct table {
    int rows, columns;
    char names[2048];
    double *value;
} table;

static table read_table(const char *path) {
    table t = {0};
    static char line[8192];
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    assert_non_null(fgets(t.names, sizeof t.names, file));
    t.columns = 1;
    for (const char *c = t.names; *c; c++) {
        t.columns += *c == ',';
    }
    while (fgets(line, sizeof line, file)) {
        t.value = realloc(t.value, (size_t)((t.rows + 1) * t.columns) * sizeof *t.value);
        char *at = line;
        for (int c = 0; c < t.columns; c++) {
            char *end;
            t.value[t.rows * t.columns + c] = strtod(at, &end);
            at = end + (*end == ',');
        }
        t.rows++;
    }
    fclose(file);
    return t;
}

static int column(const table *t, const char *name) {
    int c = 0;
    size_t size = strlen(name);
    for (const char *at = t->names; at; at = strchr(at, ',') ? strchr(at, ',') + 1 : NULL, c++) {
        if (strncmp(at, name, size) == 0 && strchr(",\n", at[size])) {
            return c;
        }
    }
    fail_msg("no column %s", name);
    return -1;
}

/* Mean of a column over the rows from a time on. */
static double mean(const table *t, const char *name, double from) {
    int c = column(t, name), n = 0;
    double sum = 0;
    for (int i = 0; i < t->rows; i++) {
        if (t->value[i * t->columns] > from) {
            sum += t->value[i * t->columns + c];
            n++;
        }
    }
    return sum / n;
}

/* Runs a program; 0 ranks: without a launcher. Returns its exit status. */
static int run_program(const char *program, int ranks, const char *arguments, const char *folder) {
    char command[2048], launcher[512] = "";
    if (ranks > 0) {
        snprintf(launcher, sizeof launcher, "%s %d ", ROTOR_LAUNCHER, ranks);
    }
    snprintf(command, sizeof command, "%s'%s' --quiet --no-plots --out %s %s >%s.log 2>&1", launcher, program, folder,
             arguments, folder);
    int status = system(command);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

static int run(int ranks, const char *arguments, const char *folder) {
    return run_program(ROTOR_PROGRAM, ranks, arguments, folder);
}

static int in_log(const char *folder, const char *text) {
    char path[256], line[1024];
    int found = 0;
    snprintf(path, sizeof path, "%s.log", folder);
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    while (fgets(line, sizeof line, file)) {
        found = found || strstr(line, text);
    }
    fclose(file);
    return found;
}

static void need_program(void) {
    if (ROTOR_PROGRAM[0] == '\0') {
        skip();
    }
}

/* AeroDyn 5's figures for rigid blades without tilt and precone, from examples/data/nrel5mw/aerodyn.txt's source:
   thrust, torque and power are given to 6 digits; the model is the same one, so 1e-4. The axial load of each section is
   given to 0.1 N; 2e-3 of the largest for the tip, where the offsets of the aerodynamic centres enter. */
static void test_rigid_as_aerodyn(void **state) {
    (void)state;
    static const double axial[] = {16.7,    141.7,   235.9,   619.1,   2592.4,  4171.4,  5077.0,
                                   6128.1,  7502.2,  8869.6,  10490.2, 11965.6, 12986.4, 14215.4,
                                   14063.3, 11994.9, 10138.5, 5925.4,  1265.9};
    need_program();
    const char *same = "--rigid --tilt 0 --precone 0 --seconds 1 --dt 0.05 --vtk-every 0 --wind ";
    char arguments[256];
    const double figures[2][5] = {{8, 9.16, 385.20e3, 1.97713e6, 1.89652e6},
                                  {11.4, 12.1, 744.28e3, 4.28728e6, 5.43245e6}};
    for (int k = 0; k < 2; k++) {
        snprintf(arguments, sizeof arguments, "%s%g --rpm %g", same, figures[k][0], figures[k][1]);
        assert_int_equal(run(0, arguments, "rotor_rigid"), 0);
        table t = read_table("rotor_rigid/history.csv");
        assert_int_equal(t.rows, 21);
        NEAR(mean(&t, "thrust_N", 0), figures[k][2], 1e-4 * figures[k][2]);
        NEAR(mean(&t, "torque_Nm", 0), figures[k][3], 1e-4 * figures[k][3]);
        NEAR(mean(&t, "power_W", 0), figures[k][4], 1e-4 * figures[k][4]);
        free(t.value);
        t = read_table("rotor_rigid/span.csv");
        assert_int_equal(t.rows, 19);
        for (int i = 0; i < 19 && k == 0; i++) {
            NEAR(t.value[i * t.columns + column(&t, "axial_lumped_N")], axial[i], 2e-3 * 14215.4);
        }
        free(t.value);
    }
}

/* Published OpenFAST and HAWC2 runs put the mean flapwise tip deflection at 11.4 m/s between 4.5 and 7 m. Gravity alone
   swings the edgewise one by some 0.9 m once a turn. The loads of bent blades are lower than those of rigid ones, by
   less than 5 per cent. Quaternions are unit to 1e-14. */
static void test_flexible(void **state) {
    (void)state;
    need_program();
    assert_int_equal(run(0, "--wind 11.4 --seconds 7.5 --dt 0.025 --vtk-every 1.75", "rotor_flexible"), 0);
    table t = read_table("rotor_flexible/history.csv");
    double turn = 60 / 12.1, flap = mean(&t, "tip_flap1_m", 7.5 - turn), thrust = mean(&t, "thrust_N", 7.5 - turn),
           low = 0, high = -10;
    assert_true(flap > 4.5 && flap < 7);
    assert_true(thrust > 0.95 * 744.28e3 && thrust < 744.28e3);
    for (int b = 2; b <= 3; b++) { /* the blades do the same one after the other */
        char name[32];
        snprintf(name, sizeof name, "tip_flap%d_m", b);
        NEAR(mean(&t, name, 7.5 - turn), flap, 0.02);
    }
    for (int i = 0; i < t.rows; i++) {
        double edge = t.value[i * t.columns + column(&t, "tip_edge1_m")];
        low = fmin(low, edge);
        high = fmax(high, edge);
        assert_true(t.value[i * t.columns + column(&t, "iterations")] <= 6);
    }
    assert_true(high - low > 0.7 && high - low < 1.4);
    free(t.value);
    assert_true(in_log("rotor_flexible", "unit quaternions to"));
    FILE *index = fopen("rotor_flexible/sections.pvd", "r"),
         *picture = fopen("rotor_flexible/vtk/blade3_00004.vtp", "r");
    assert_true(index && picture);
    fclose(index);
    fclose(picture);
}

/* Ranks sum the same numbers in another order: 1e-12 of the largest of each column. On four ranks one has no blade. */
static void test_ranks(void **state) {
    (void)state;
    need_program();
    if (ROTOR_LAUNCHER[0] == '\0') {
        skip();
    }
    const char *arguments = "--wind 11.4 --seconds 0.5 --dt 0.02 --shear 0.2 --newton 1e-12 --vtk-every 0";
    assert_int_equal(run(0, arguments, "rotor_np0"), 0);
    table one = read_table("rotor_np0/history.csv");
    for (int ranks = 2; ranks <= 4; ranks += 2) {
        assert_int_equal(run(ranks, arguments, "rotor_np"), 0);
        table t = read_table("rotor_np/history.csv");
        assert_true(t.rows == one.rows && t.columns == one.columns && strcmp(t.names, one.names) == 0);
        for (int c = 0; c < t.columns; c++) {
            double size = 0;
            for (int i = 0; i < t.rows; i++) {
                size = fmax(size, fabs(one.value[i * t.columns + c]));
            }
            for (int i = 0; i < t.rows; i++) {
                NEAR(t.value[i * t.columns + c], one.value[i * t.columns + c], 1e-12 * size);
            }
        }
        free(t.value);
    }
    free(one.value);
}

/* ---- trials ---- */

enum { VALUES = 5 };

/* Values of an effect that spar-effects --csv has written: in force, size, deflection, root loads, time. */
static void read_effect(const char *folder, const char *name, double value[VALUES]) {
    char path[256], line[1024];
    int found = 0;
    snprintf(path, sizeof path, "%s.log", folder);
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    while (fgets(line, sizeof line, file)) {
        char *at = strchr(line, ',');
        if (!at || (size_t)(at - line) != strlen(name) || strncmp(line, name, strlen(name)) != 0) {
            continue;
        }
        at = strchr(at + 1, ',');
        for (int c = 0; c < VALUES; c++) {
            value[c] = strtod(at + 1, &at);
        }
        found = 1;
    }
    fclose(file);
    assert_true(found);
}

/* Root of the mean square of the difference of two columns of all blades, each against its size, both over the rows
   from, from + every, ... */
static double difference(const table *a, const table *b, const char *const kinds[2], int from, int every) {
    double off = 0, size = 0;
    for (int blade = 1; blade <= 3; blade++) {
        for (int k = 0; k < 2; k++) {
            char name[32];
            snprintf(name, sizeof name, kinds[k][0] == 't' ? "tip_%s%d_m" : "root_%s%d_Nm", strchr(kinds[k], ' ') + 1,
                     blade);
            int c = column(a, name);
            for (int i = from; i < a->rows; i += every) {
                double x = a->value[i * a->columns + c], y = b->value[i * b->columns + c];
                off += (x - y) * (x - y);
                size += x * x;
            }
        }
    }
    return sqrt(off / size);
}

static const char *const tips[2] = {"tip flap", "tip edge"}, *const roots[2] = {"root flap", "root edge"};

/* What spar-effects says of gravity is what two runs show, one of them without it, from the same straight blades (one
   short step aside, after which it looks). Its deflection is the mean over 8 places of a blade, of which the tips move
   most: within a quarter of the tips'. Its root loads are forces, moments by the blade's length, and the centrifugal
   force is in them, so that gravity's part is less than of the bending moments; not by more than 5. */
static void test_gravity(void **state) {
    (void)state;
    double value[VALUES];
    need_program();
    const char *scene = "--straight --dt 0.05 --nodes 6 --coupling explicit --vtk-every 0";
    char arguments[256];
    snprintf(arguments, sizeof arguments, "%s --seconds 1e-6 --trial 0.8 --csv", scene);
    assert_int_equal(run_program(EFFECTS_PROGRAM, 0, arguments, "effects_gravity"), 0);
    read_effect("effects_gravity", "gravity", value);
    assert_true(value[0] == 1);
    snprintf(arguments, sizeof arguments, "%s --seconds 0.8", scene);
    assert_int_equal(run(0, arguments, "rotor_heavy"), 0);
    snprintf(arguments, sizeof arguments, "%s --seconds 0.8 --without gravity", scene);
    assert_int_equal(run(0, arguments, "rotor_weightless"), 0);
    table heavy = read_table("rotor_heavy/history.csv"), weightless = read_table("rotor_weightless/history.csv");
    double tip = difference(&heavy, &weightless, tips, 2, 2), root = difference(&heavy, &weightless, roots, 2, 2);
    print_message("gravity: deflection %.4f, tips %.4f; root loads %.4f, bending at the roots %.4f\n", value[2], tip,
                  value[3], root);
    NEAR(value[2], tip, 0.25 * tip);
    assert_true(value[3] < root && value[3] > root / 5);
    free(heavy.value);
    free(weightless.value);
    snprintf(arguments, sizeof arguments, "%s --seconds 1e-6 --trial 0.4 --without drag", scene);
    assert_int_equal(run_program(EFFECTS_PROGRAM, 0, arguments, "effects_words"), 0);
    assert_true(in_log("effects_words", "leave gravity out: "));
    assert_true(in_log("effects_words", "not in force: "));
    assert_false(in_log("effects_words", "leave drag out: "));
}

/* On four ranks, one of them without a blade, it says the same. */
static void test_effects_on_ranks(void **state) {
    (void)state;
    static const char *const names[] = {"gravity", "tip loss", "drag", "pitching moments", "fluid velocities"};
    need_program();
    if (ROTOR_LAUNCHER[0] == '\0') {
        skip();
    }
    const char *arguments = "--dt 0.05 --nodes 5 --seconds 0.1 --trial 0.4 --csv";
    assert_int_equal(run_program(EFFECTS_PROGRAM, 0, arguments, "effects_np0"), 0);
    assert_int_equal(run_program(EFFECTS_PROGRAM, 4, arguments, "effects_np4"), 0);
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        double one[VALUES], four[VALUES];
        read_effect("effects_np0", names[i], one);
        read_effect("effects_np4", names[i], four);
        assert_true(one[0] == 1 && four[0] == 1);
        for (int c = 1; c < VALUES - 1; c++) {
            NEAR(four[c], one[c], 1e-5 * fabs(one[c]) + 1e-9);
        }
    }
}

/* Straight blades let go in the wind, with settings for 3 per cent of the deflection: the tips of the run that is made
   with them against one with four times as many steps as given, more nodes and every step converged. The tolerance is
   that of the mean over the blade at eight times, this of the tips at all of them: half as much again is allowed. */
static void test_tolerance(void **state) {
    (void)state;
    need_program();
    const char *scene = "--straight --seconds 1.6 --vtk-every 0";
    char arguments[256];
    snprintf(arguments, sizeof arguments, "%s --tolerance 3e-2 --trial 1.6", scene);
    assert_int_equal(run(0, arguments, "rotor_advised"), 0);
    assert_true(in_log("rotor_advised", "Settings for a tolerance of 0.03"));
    assert_true(in_log("rotor_advised", "as options: --dt "));
    snprintf(arguments, sizeof arguments, "%s --dt 0.005 --nodes 14 --coupling iqn --coupling-tolerance 1e-8", scene);
    assert_int_equal(run(0, arguments, "rotor_fine"), 0);
    table advised = read_table("rotor_advised/history.csv"), fine = read_table("rotor_fine/history.csv");
    table there = fine; /* at the times of the other */
    there.rows = advised.rows;
    there.value = calloc((size_t)(there.rows * there.columns), sizeof(double));
    assert_int_equal(advised.columns, fine.columns);
    for (int i = 0; i < advised.rows; i++) {
        double place = fmin(advised.value[i * advised.columns] / 0.005, fine.rows - 1.0), whole = floor(place);
        const double *a = fine.value + (int)whole * fine.columns, *b = whole < place ? a + fine.columns : a;
        for (int c = 0; c < fine.columns; c++) {
            there.value[i * fine.columns + c] = a[c] + (place - whole) * (b[c] - a[c]);
        }
    }
    double off = difference(&there, &advised, tips, 1, 1);
    print_message("tolerance 0.03: the tips are off by %.4f of their way, in %d steps\n", off, advised.rows - 1);
    assert_true(off < 1.5 * 0.03);
    FILE *file =
        fopen("rotor_advised/advice.csv", "r"); /* a decade more accuracy has a smaller error, and costs more */
    assert_non_null(file);
    char line[256];
    double error[3] = {0, 0, 0}, cost[3] = {0, 0, 0};
    for (int row = -1; row < 3 && fgets(line, sizeof line, file); row++) {
        assert_true(row < 0 || sscanf(strchr(line, ','), ",%lf,%lf", error + row, cost + row) == 2);
    }
    fclose(file);
    assert_true(cost[0] == 1 && error[1] <= 0.03 && error[2] <= 0.003 && error[2] > 0);
    assert_true(cost[2] > cost[1] && cost[1] > 0);
    free(advised.value);
    free(fine.value);
    free(there.value);
}

static void test_bad_input(void **state) {
    (void)state;
    need_program();
    const char *bad[][2] = {{"--wnd 8", "'--wnd' is no option"},
                            {"--wind fast", "--wind fast"},
                            {"--nodes 1", "--nodes 1"},
                            {"--nodes 2.5", "a whole number"},
                            {"--coupling tight", "--coupling tight"},
                            {"--without friction", "'friction'"},
                            {"--dt", "--dt needs a value"},
                            {"--data no-such-folder", "no-such-folder"}};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        assert_int_equal(run(0, bad[i][0], "rotor_bad"), 1);
        assert_true(in_log("rotor_bad", bad[i][1]));
    }
    assert_int_equal(run(0, "--help", "rotor_bad"), 0);
    assert_true(in_log("rotor_bad", "--rho-inf"));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_rigid_as_aerodyn),
        cmocka_unit_test(test_flexible),
        cmocka_unit_test(test_ranks),
        cmocka_unit_test(test_gravity),
        cmocka_unit_test(test_effects_on_ranks),
        cmocka_unit_test(test_tolerance),
        cmocka_unit_test(test_bad_input),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
