/* The rotor program as a user runs it: its figures against AeroDyn's, its answers on several ranks against those on
   one, and what it says to bad input. It needs the examples; where they are not built, the tests are skipped. */
#include "scene.h"

#include <stdio.h>
#include <sys/wait.h>

#ifndef ROTOR_PROGRAM
#define ROTOR_PROGRAM ""
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

/* Runs the program; 0 ranks: without a launcher. Returns its exit status. */
static int run(int ranks, const char *arguments, const char *folder) {
    char command[2048], launcher[512] = "";
    if (ranks > 0) {
        snprintf(launcher, sizeof launcher, "%s %d ", ROTOR_LAUNCHER, ranks);
    }
    snprintf(command, sizeof command, "%s%s --quiet --no-plots --out %s %s >%s.log 2>&1", launcher, ROTOR_PROGRAM,
             folder, arguments, folder);
    int status = system(command);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
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
    const char *arguments = "--wind 11.4 --seconds 0.5 --dt 0.02 --shear 0.2 --vtk-every 0";
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
        cmocka_unit_test(test_bad_input),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
