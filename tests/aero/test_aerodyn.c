/* Blades by AeroDyn's files (tests/data/aerodyn, written from the tables of examples/data/nrel5mw). */
#include "scene.h"

#include "aero/aero.h"
#include "aero/aerodyn.h"
#include "nrel5mw.h"
#include <stdio.h>
#include <unistd.h>

#define DATA SPAR_SOURCE_DIR "/tests/data/aerodyn/"
#define PRIMARY DATA "primary.dat"

static const double pi = 3.14159265358979323846;
/* From AeroDyn's axes to those of examples/nrel5mw.h, which have y to the trailing edge and z upwind. */
static const double to_edge[4] = {0.70710678118654752, -0.70710678118654752, 0, 0};

static nrel5mw data;

static int load(void **state) {
    (void)state;
    return nrel5mw_load(&data, SPAR_DATA_DIR "/nrel5mw");
}

static int unload(void **state) {
    (void)state;
    nrel5mw_free(&data);
    return 0;
}

static spar_fluid *fluid_of(spar_session *s, spar_member *m) {
    spar_fluid *f = NULL;
    OK(s, spar_fluid_create(m, "sections", &f));
    return f;
}

/* The reference blade, committed. */
static spar_member *reference_blade(spar_session *s, const nrel5mw_rotor *rotor, int blade) {
    spar_member *m = NULL;
    OK(s, nrel5mw_create_blade(&data, rotor, s, blade, 2, 6, &m));
    OK(s, spar_member_commit(m));
    return m;
}

/* The whole rotor by examples/nrel5mw.c from its tables, and by the files: sections at the same places (1e-12 m), and
   in a wind of 8 m/s at 9.16 rev/min the same loads, to 1e-9 of the largest, which is what the momentum equation's
   roots are found to. */
static void test_rotor(void **state) {
    (void)state;
    enum { BLADES = 3 };
    spar_session *s = scene_session();
    spar_fluid *fluid[2][BLADES] = {{NULL}};
    spar_aero *aero[2] = {NULL, NULL};
    nrel5mw_rotor rotor;
    double twist[64], speed = 9.16 * pi / 30;
    nrel5mw_rotor_default(&data, &rotor);
    int64_t n = data.aero_n, all = BLADES * n;
    assert_true(n <= 64);
    for (int b = 0; b < BLADES; b++) {
        double spin[3] = {speed * rotor.axis[0], speed * rotor.axis[1], speed * rotor.axis[2]};
        spar_member *m = reference_blade(s, &rotor, b);
        OK(s, spar_member_set_initial_velocity(m, rotor.hub, NULL, spin));
        OK(s, nrel5mw_create_sections(&data, &rotor, b, m, &fluid[0][b], twist));
        fluid[1][b] = fluid_of(s, m);
        OK(s, spar_fluid_read_aerodyn(fluid[1][b], PRIMARY, NULL, to_edge, 0, NULL));
        OK(s, spar_fluid_map(fluid[1][b]));
        double x[2][3 * 64], arm[2][3 * 64];
        for (int k = 0; k < 2; k++) {
            OK(s, spar_fluid_get_nearest(fluid[k][b], SPAR_NODES_MOTION, x[k], NULL, arm[k]));
        }
        for (int64_t i = 0; i < 3 * n; i++) {
            NEAR(x[1][i] + arm[1][i], x[0][i] + arm[0][i], 1e-12);
        }
    }
    OK(s, nrel5mw_create_aero(&data, &rotor, BLADES, fluid[0], twist, &aero[0]));
    OK(s, spar_aero_create(BLADES, fluid[1], &aero[1]));
    OK(s, spar_aero_read_aerodyn(aero[1], PRIMARY, NULL, to_edge, NULL));
    double chord[64], read_twist[64]; /* by the file, and as the tables of the example have them */
    OK(s, spar_aero_get_chord(aero[1], chord, read_twist));
    for (int64_t i = 0; i < n; i++) {
        NEAR(chord[i], data.chord[i], 1e-12);
        NEAR(read_twist[i], twist[i], 1e-12);
    }
    OK(s, spar_aero_set_rotor(aero[1], rotor.hub, rotor.axis, cos(rotor.precone) * data.hub_radius,
                              cos(rotor.precone) * data.tip_radius));
    double *inflow = calloc((size_t)(3 * all), sizeof *inflow), *force[2], *moment[2], largest = 0;
    for (int64_t i = 0; i < all; i++) {
        inflow[3 * i] = 8;
    }
    for (int k = 0; k < 2; k++) {
        force[k] = calloc((size_t)(3 * all), sizeof(double));
        moment[k] = calloc((size_t)(3 * all), sizeof(double));
        OK(s, spar_aero_solve(aero[k], 1.225, inflow, 0));
        OK(s, spar_aero_get_loads(aero[k], NULL, force[k], moment[k]));
    }
    for (int64_t i = 0; i < 3 * all; i++) {
        largest = fmax(largest, fabs(force[0][i]));
    }
    assert_true(largest > 1000);
    for (int64_t i = 0; i < 3 * all; i++) {
        NEAR(force[1][i], force[0][i], 1e-11 * largest);
        NEAR(moment[1][i], moment[0][i], 1e-11 * largest);
    }
    free(inflow);
    for (int k = 0; k < 2; k++) {
        free(force[k]);
        free(moment[k]);
        spar_aero_destroy(&aero[k]);
    }
    spar_session_destroy(&s);
}

/* Linear between the rows of a table. */
static double interpolated(int64_t n, const double *x, const double *y, double at) {
    int64_t i = 1;
    while (i + 1 < n && x[i] < at) {
        i++;
    }
    return y[i - 1] + (y[i] - y[i - 1]) * (at - x[i - 1]) / (x[i] - x[i - 1]);
}

/* Sections between the stations, as fine as a grid wants them: chord, twist and place of the centre are linear in the
   span, coefficients between two airfoils linear too (DU40 at 10.25 m, DU35 at 14.35 m), by the tables themselves, to
   1e-12. The beam is straight and its own frames carry the structural twist. */
static void test_between(void **state) {
    (void)state;
    enum { N = 7 };
    const double span[N] = {0, 10.25, 11.48, 14.35, 20, 40.2, 61.5};
    const int p[2] = {3, 4};
    const double alpha[4] = {-2.5, -0.05, 0.123, 1.4};
    spar_session *s = scene_session();
    spar_aero *aero = NULL;
    nrel5mw_rotor rotor;
    nrel5mw_rotor_default(&data, &rotor);
    rotor.precone = 0;
    spar_member *m = reference_blade(s, &rotor, 0);
    spar_fluid *f = fluid_of(s, m);
    double last = data.span[data.aero_n - 1];
    double at[N], x[3 * N], q[4 * N], arm[3 * N], root[3], axes[4];
    memcpy(at, span, sizeof at);
    at[N - 1] = last;
    OK(s, spar_fluid_read_aerodyn(f, PRIMARY, DATA "blade.dat", to_edge, N, at));
    OK(s, spar_fluid_map(f));
    OK(s, spar_aero_create(1, &f, &aero));
    OK(s, spar_aero_read_aerodyn(aero, PRIMARY, DATA "blade.dat", to_edge, at));
    OK(s, spar_fluid_get_nearest(f, SPAR_NODES_MOTION, x, q, arm));
    OK(s, spar_member_get_placement(m, root, axes));
    for (int i = 0; i < N; i++) {
        const spari_section *section = aero->section + i;
        double place[3] = {at[i], interpolated(data.aero_n, data.span, data.sweep, at[i]),
                           -interpolated(data.aero_n, data.span, data.curve, at[i])};
        double y[3] = {0, 1, 0}, line[4], own = 0;
        spari_rotate(axes, place, place);
        for (int c = 0; c < 3; c++) {
            NEAR(x[3 * i + c] + arm[3 * i + c], root[c] + place[c], 1e-12);
        }
        spari_quat_conj(axes, line); /* the frame's own turn about the line */
        spari_rotate(q + 4 * i, y, y);
        spari_rotate(line, y, y);
        own = atan2(y[2], y[1]);
        double twist = interpolated(data.aero_n, data.span, data.twist, at[i]) + own;
        NEAR(section->chord, interpolated(data.aero_n, data.span, data.chord, at[i]), 1e-12);
        NEAR(section->cos_twist, cos(twist), 1e-12);
        NEAR(section->sin_twist, sin(twist), 1e-12);
    }
    for (int k = 0; k < 4; k++) { /* 11.48 m: 0.3 of the way */
        double a[2][3];
        int64_t row = 0;
        for (int j = 0; j < 2; j++) {
            const nrel5mw_polar *t = &data.polar[data.polar_of[p[j] + 1]];
            assert_string_equal(t->name, j ? "DU35_A17" : "DU40_A17");
            a[j][0] = interpolated(t->n, t->alpha, t->cl, alpha[k]);
            a[j][1] = interpolated(t->n, t->alpha, t->cd, alpha[k]);
            a[j][2] = interpolated(t->n, t->alpha, t->cm, alpha[k]);
        }
        NEAR(spari_table_lift(aero->section[2].table, alpha[k], &row), 0.7 * a[0][0] + 0.3 * a[1][0], 1e-12);
        NEAR(spari_table_drag(aero->section[2].table, alpha[k], &row), 0.7 * a[0][1] + 0.3 * a[1][1], 1e-12);
        NEAR(spari_table_moment(aero->section[2].table, alpha[k], &row), 0.7 * a[0][2] + 0.3 * a[1][2], 1e-12);
    }
    spar_aero_destroy(&aero);
    spar_session_destroy(&s);
}

/* ---- small files ---- */

static char folder[64];

static const char primary_text[] = "heading\nheading\n 1 AFTabMod - model\n1 InCol_Alfa\n2 InCol_Cl\n3 InCol_Cd\n"
                                   "4 InCol_Cm\n2 NumAFfiles\n\"a.dat\" AFNames\n'b.dat'\nTrue UseBlCm\n"
                                   "\"blade.dat\" ADBlFile(1)\n",
                  blade_text[] = "heading\nheading\n3 NumBlNds - nodes\nBlSpn\n(m)\n0, 0 0 0 10 2.0D0 1\n"
                                 "1 0.1 0.2 3 20 3 1\n3 0 0 0 0 1 2\n",
                  airfoil_text[] = "! comment\n\"DEFAULT\" InterpOrd ! order\n@\"coordinates.txt\" NumCoords\n"
                                   "1 NumTabs ! tables\n0.75 Re\n 3 NumAlf ! rows\n-90 -1 0.5 0.1\n! comment\n\n"
                                   "0 0 0.01 0.2 # another\n90 1 0.5 0.3\n";

static void put(const char *name, const char *text) {
    char path[128];
    (void)snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    assert_true(fputs(text, file) >= 0);
    assert_int_equal(fclose(file), 0);
}

/* The four files, with one part of one of them replaced. */
static const char *deck(const char *name, const char *old, const char *new_text) {
    static const char *const names[] = {"primary.dat", "blade.dat", "a.dat", "b.dat"};
    static const char *const texts[] = {primary_text, blade_text, airfoil_text, airfoil_text};
    static char path[128];
    (void)snprintf(folder, sizeof folder, "aerodyn_%ld", (long)getpid());
    (void)snprintf(path, sizeof path, "mkdir -p %s", folder);
    assert_int_equal(system(path), 0);
    for (int i = 0; i < 4; i++) {
        char text[2048];
        const char *at = name && strcmp(name, names[i]) == 0 ? strstr(texts[i], old) : NULL;
        assert_true(at || !name || strcmp(name, names[i]) != 0);
        (void)snprintf(text, sizeof text, "%.*s%s%s", (int)(at ? at - texts[i] : 0), texts[i], at ? new_text : "",
                       at ? at + strlen(old) : texts[i]);
        put(names[i], text);
    }
    (void)snprintf(path, sizeof path, "%s/primary.dat", folder);
    return path;
}

static void no_deck(void) {
    char command[128];
    (void)snprintf(command, sizeof command, "rm -r %s", folder);
    assert_int_equal(system(command), 0);
}

/* A straight blade of 3 m along x in the frame that spar_beam_read_beamdyn gives one: y downwind, z to the trailing
   edge; here global y and z. */
typedef struct wing {
    spar_session *s;
    spar_member *m;
    spar_fluid *f;
    spar_aero *aero;
} wing;

static wing make_wing(void) {
    double K[36], M[36];
    wing w = {.s = scene_session()};
    scene_diagonal(K, 1e6, 1e6, 1e6, 1e6, 1e6, 1e6);
    scene_diagonal(M, 1, 1, 1, 1, 1, 1);
    w.m = scene_beam(w.s, "wing", 1, 4, 3, K, M);
    OK(w.s, spar_member_commit(w.m));
    w.f = fluid_of(w.s, w.m);
    return w;
}

static void read_wing(wing *w, const char *primary, int64_t n, const double *span) {
    OK(w->s, spar_fluid_read_aerodyn(w->f, primary, NULL, NULL, n, span));
    OK(w->s, spar_fluid_map(w->f));
    OK(w->s, spar_aero_create(1, &w->f, &w->aero));
    OK(w->s, spar_aero_read_aerodyn(w->aero, primary, NULL, NULL, span));
}

static void end_wing(wing *w) {
    spar_aero_destroy(&w->aero);
    spar_session_destroy(&w->s);
}

/* In that frame, standing in a wind from behind y (downwind): the chord lies across the wind at no twist and turns its
   leading edge into it, so the angle of attack is 90 degrees less the twist (1e-12). Centres are where the file has
   them, the moment is cm c^2 q of the pressure q = 0.5 density wind^2. */
static void test_frame(void **state) {
    (void)state;
    const double degrees[5] = {10, 15, 20, 10, 0}, chord[5] = {2, 2.5, 3, 2, 1}, span[5] = {0, 0.5, 1, 2, 3},
                 place[5][3] = {{0, 0, 0}, {0.5, 0.05, 0.1}, {1, 0.1, 0.2}, {2, 0.05, 0.1}, {3, 0, 0}};
    double alpha[5], inflow[15] = {0}, x[15], arm[15], load[30];
    wing w = make_wing();
    read_wing(&w, deck(NULL, NULL, NULL), 5, span);
    for (int i = 0; i < 5; i++) {
        inflow[3 * i + 1] = 4;
    }
    OK(w.s, spar_aero_solve(w.aero, 2, inflow, 0));
    OK(w.s, spar_aero_get_sections(w.aero, alpha, NULL, NULL, NULL, NULL));
    OK(w.s, spar_fluid_get_nearest(w.f, SPAR_NODES_MOTION, x, NULL, arm));
    OK(w.s, spar_aero_get_loads(w.aero, load, NULL, NULL));
    for (int i = 0; i < 5; i++) {
        double angle = (90 - degrees[i]) * pi / 180, cm = 0.2 + 0.1 * (90 - degrees[i]) / 90;
        NEAR(alpha[i], angle, 1e-12);
        for (int c = 0; c < 3; c++) {
            NEAR(x[3 * i + c] + arm[3 * i + c], place[i][c], 1e-12);
        }
        NEAR(fabs(load[6 * i + 3]), cm * chord[i] * chord[i] * 0.5 * 2 * 16, 1e-11);
    }
    end_wing(&w);
    no_deck();
}

/* What the files can say otherwise: no moments (UseBlCm, InCol_Cm), columns in another order, cubic splines, several
   tables of which the first counts, and a table of another airfoil with other angles. cl or cm at 45 degrees. */
static void test_variants(void **state) {
    (void)state;
    static const struct {
        const char *file, *old, *new_text;
        double cl, cm;
    } variant[] = {
        {NULL, NULL, NULL, 0.5, 0.25},
        {"primary.dat", " 1 AFTabMod", " 1 Skew_Mod", 0.5, 0.25}, /* files of OpenFAST 2 */
        {"primary.dat", "True UseBlCm", "F UseBlCm", 0.5, 0},
        {"primary.dat", "4 InCol_Cm", "0 InCol_Cm", 0.5, 0},
        {"primary.dat", "2 InCol_Cl\n3 InCol_Cd\n4", "4 InCol_Cl\n3 InCol_Cd\n2", 0.25, 0.5},
        {"a.dat", "\"DEFAULT\"", "3", 0.5, 0.25}, /* a line's spline is the line */
        {"a.dat", "0 0 0.01 0.2", "0 0.25 0.01 0.2", 0.625, 0.25},
        {"a.dat", "1 NumTabs", "2 NumTabs", 0.5, 0.25},
        {"a.dat", "90 1 0.5 0.3", "9d1 1 .5E0 3e-1", 0.5, 0.25},
    };
    for (size_t k = 0; k < sizeof variant / sizeof variant[0]; k++) {
        int64_t row = 0;
        wing w = make_wing();
        read_wing(&w, deck(variant[k].file, variant[k].old, variant[k].new_text), 0, NULL);
        assert_int_equal(w.aero->n, 3);
        NEAR(spari_table_lift(w.aero->section[0].table, pi / 4, &row), variant[k].cl, 1e-15);
        NEAR(spari_table_moment(w.aero->section[0].table, pi / 4, &row), variant[k].cm, 1e-15);
        end_wing(&w);
        no_deck();
    }
}

/* Tables of flap angles (AFTabMod 3): that of 0 where there is one, else linear between its neighbours, else the
   nearest; without a flap AeroDyn takes 0. At 45 degrees the tables have the lift coefficients 1, 2 and 4. */
static void test_flaps(void **state) {
    (void)state;
    static const struct {
        double setting[3], cl;
    } flap[] = {{{-10, 0, 10}, 2}, {{-10, 5, 10}, 1 + 10.0 / 15}, {{2, 5, 10}, 1}, {{-9, -5, -2}, 4}};
    char text[1024];
    for (size_t k = 0; k < sizeof flap / sizeof flap[0]; k++) {
        int n = snprintf(text, sizeof text, "3 NumTabs\n");
        for (int i = 0; i < 3; i++) {
            n += snprintf(text + n, sizeof text - (size_t)n, "0.5 Re\n%g UserProp\n2 NumAlf\n0 0 0 0\n90 %d 0 0.5\n",
                          flap[k].setting[i], 2 << i);
        }
        const char *primary = deck("primary.dat", " 1 AFTabMod", " 3 AFTabMod");
        double alpha[2], cl[2], cd[2], cm[2];
        int64_t rows = 0, row = 0;
        int kind = -1;
        wing w = make_wing();
        put("a.dat", text);
        read_wing(&w, primary, 0, NULL);
        NEAR(spari_table_lift(w.aero->section[0].table, pi / 4, &row), flap[k].cl, 1e-15);
        OK(w.s, spar_aero_get_polar(w.aero, 0, &rows, 2, alpha, cl, cd, cm, &kind));
        assert_true(rows == 2 && kind == SPAR_POLAR_LINEAR && alpha[0] == 0 && cl[0] == 0 && cm[1] == 0.5);
        NEAR(cl[1], 2 * flap[k].cl, 1e-15);
        assert_int_equal(spar_aero_get_polar(w.aero, 3, &rows, 2, alpha, cl, cd, cm, &kind), SPAR_ERR_ARGUMENT);
        end_wing(&w);
        w = make_wing();
        memcpy(strstr(text, "UserProp\n2"), "UserProb", 8);
        put("a.dat", text);
        OK(w.s, spar_fluid_read_aerodyn(w.f, primary, NULL, NULL, 0, NULL));
        OK(w.s, spar_fluid_map(w.f));
        OK(w.s, spar_aero_create(1, &w.f, &w.aero));
        assert_int_equal(spar_aero_read_aerodyn(w.aero, primary, NULL, NULL, NULL), SPAR_ERR_IO);
        assert_non_null(strstr(spar_session_message(w.s), "UserProp is missing"));
        end_wing(&w);
        no_deck();
    }
}

/* Tables of other angles on the way from one airfoil to the next: where one ends, its end's value goes on; where one
   goes round and the other is shifted by some degrees, the blend goes round. */
static void test_blends(void **state) {
    (void)state;
    static const char *const table[] = {"3 NumAlf ! rows\n-45 3 0 0\n! comment\n\n0 1 0 0 # another\n45 5 0 0\n",
                                        "4 NumAlf\n-170 2 0 0\n-10 1 0 0\n10 3 0 0\n190 2 0 0\n"};
    const double middle[1] = {2};
    for (int k = 0; k < 2; k++) {
        int64_t row = 0, other = 0;
        wing w = make_wing();
        const double span[3] = {1, middle[0], 3};
        read_wing(&w,
                  deck("b.dat", "3 NumAlf ! rows\n-90 -1 0.5 0.1\n! comment\n\n0 0 0.01 0.2 # another\n90 1 0.5 0.3\n",
                       table[k]),
                  3, span);
        const spari_table *mean = w.aero->section[1].table;
        int beyond = 0;
        double at = spari_table_wrap(mean, 80 * pi / 180, &beyond);
        assert_int_equal(beyond, 0);
        double of_a = 80.0 / 90, of_b = k == 0 ? 5 : 3 - 70.0 / 180;
        NEAR(spari_table_lift(mean, at, &row), 0.5 * (of_a + of_b), 1e-14);
        NEAR(spari_table_lift(w.aero->section[0].table, at, &other), of_a, 1e-14);
        end_wing(&w);
        no_deck();
    }
}

/* ---- mistakes ---- */

/* Each is refused with its status and a message that names file, line and what; the fluid's sections and those of the
   object stay as they were. */
static void test_mistakes(void **state) {
    (void)state;
    static const struct {
        const char *file, *old, *new_text;
        int status;
        const char *what;
    } wrong[] = {
        {"primary.dat", "InCol_Alfa", "InColAlfa", SPAR_ERR_IO, "primary.dat ends at line 12; InCol_Alfa is missing"},
        {"primary.dat", " 1 AFTabMod", " x AFTabMod", SPAR_ERR_IO, "primary.dat, line 3: AFTabMod: 'x'"},
        {"primary.dat", "2 InCol_Cl", "0 InCol_Cl", SPAR_ERR_IO, "primary.dat, line 5: InCol_Cl is 0"},
        {"primary.dat", "4 InCol_Cm", "40 InCol_Cm", SPAR_ERR_IO, "primary.dat, line 7: InCol_Cm is 40"},
        {"primary.dat", "2 NumAFfiles", "1.5 NumAFfiles", SPAR_ERR_IO, "primary.dat, line 8: NumAFfiles is 1.5"},
        {"primary.dat", "'b.dat'", "", SPAR_ERR_IO, "primary.dat, line 10: the name of an airfoil file is missing"},
        {"primary.dat", "True UseBlCm", "Yes UseBlCm", SPAR_ERR_IO, "primary.dat, line 11: UseBlCm is 'Yes'"},
        {"primary.dat", "ADBlFile(1)", "Blade", SPAR_ERR_IO, "ADBlFile(1) is missing"},
        {"primary.dat", "\"blade.dat\"", "nowhere.dat", SPAR_ERR_IO, "cannot open aerodyn_"},
        {"primary.dat", " 1 AFTabMod", " 4 AFTabMod", SPAR_ERR_IO, "primary.dat, line 3: AFTabMod is 4"},
        {"blade.dat", "3 NumBlNds", "2 NumBlNds", SPAR_ERR_IO, "line 8: a row follows the last one; NumBlNds is 2"},
        {"blade.dat", "\n0, ", "\n0.5, ", SPAR_ERR_IO, "line 6: BlSpn of the first station is 0.5"},
        {"a.dat", "3 NumAlf", "2 NumAlf", SPAR_ERR_IO, "line 11: a row follows the last one; NumAlf is 2"},
        {"blade.dat", "3 NumBlNds", "1 NumBlNds", SPAR_ERR_IO, "blade.dat, line 3: NumBlNds is 1"},
        {"blade.dat", "3 NumBlNds", "4 NumBlNds", SPAR_ERR_IO, "blade.dat ends at line 8; a station of the blade"},
        {"blade.dat", "1 0.1 0.2 3 20 3 1", "1 0.1 0.2 3 20 3", SPAR_ERR_IO, "line 7: BlSpn, BlCrvAC"},
        {"blade.dat", "1 0.1 0.2 3 20 3 1", "0 0.1 0.2 3 20 3 1", SPAR_ERR_IO, "line 7: BlSpn is 0 and is not above"},
        {"blade.dat", "1 0.1 0.2 3 20 3 1", "1 0.1 0.2 3 20 -3 1", SPAR_ERR_IO, "line 7: BlChord is -3"},
        {"blade.dat", "1 0.1 0.2 3 20 3 1", "1 0.1 0.2 3 20 3 3", SPAR_ERR_IO, "line 7: BlAFID is 3; the primary"},
        {"blade.dat", "1 0.1 0.2 3 20 3 1", "1 0.1 0.2 3 20 3 1.5", SPAR_ERR_IO, "line 7: BlAFID is 1.5"},
        {"blade.dat", "1 0.1 0.2 3 20 3 1", "1 nan 0.2 3 20 3 1", SPAR_ERR_IO, "line 7: BlSpn, BlCrvAC"},
        {"a.dat", "1 NumTabs", "0 NumTabs", SPAR_ERR_IO, "a.dat, line 4: NumTabs is 0"},
        {"a.dat", "NumTabs", "Tables", SPAR_ERR_IO, "a.dat ends at line 11; NumTabs is missing"},
        {"a.dat", "3 NumAlf", "5 NumAlf", SPAR_ERR_IO, "a.dat ends at line 11; a row of the table"},
        {"a.dat", "90 1 0.5 0.3", "90 1 0.5", SPAR_ERR_IO, "a.dat, line 11: a row of the table"},
        {"a.dat", "90 1 0.5 0.3", "0 1 0.5 0.3", SPAR_ERR_IO, "a.dat, line 11: alpha is 0 deg"},
        {"a.dat", "90 1 0.5 0.3", "300 1 0.5 0.3", SPAR_ERR_ARGUMENT, "a.dat, line 11: the table that ends here"},
        {"a.dat", "90 1 0.5 0.3", "270 1 0.5 0.3", SPAR_ERR_ARGUMENT, "one revolution apart"},
    };
    double before[9], after[9];
    wing w = make_wing();
    read_wing(&w, deck(NULL, NULL, NULL), 0, NULL);
    OK(w.s, spar_fluid_get_nearest(w.f, SPAR_NODES_MOTION, before, NULL, NULL));
    for (size_t k = 0; k < sizeof wrong / sizeof wrong[0]; k++) {
        const char *path = deck(wrong[k].file, wrong[k].old, wrong[k].new_text);
        spari_section old = w.aero->section[0];
        int status = spar_aero_read_aerodyn(w.aero, path, NULL, NULL, NULL);
        const char *message = spar_session_message(w.s);
        if (status != wrong[k].status || !strstr(message, wrong[k].what) ||
            strncmp(message, "spar_aero_read_aerodyn: ", 24) != 0) {
            fail_msg("'%s' gave %d: %s", wrong[k].new_text, status, message);
        }
        assert_memory_equal(&old, &w.aero->section[0], sizeof old);
        if (wrong[k].file[0] != 'a') {
            assert_int_equal(spar_fluid_read_aerodyn(w.f, path, NULL, NULL, 0, NULL), wrong[k].status);
            OK(w.s, spar_fluid_get_nearest(w.f, SPAR_NODES_MOTION, after, NULL, NULL));
            assert_memory_equal(before, after, sizeof before);
        }
    }
    no_deck();
    end_wing(&w);
}

/* Two tables between which AFTabMod 2 interpolates, a mirrored rotor, spans off the blade, blades that are not alike.
 */
static void test_refusals(void **state) {
    (void)state;
    const double off[2] = {0, 3.1}, none[2] = {0, NAN}, turned[4] = {0.8, 0.6, 0, 0}, long_q[4] = {1, 1, 0, 0};
    spar_aero *pair = NULL;
    wing w = make_wing();
    const char *path = deck("primary.dat", " 1 AFTabMod", " 2 AFTabMod");
    read_wing(&w, path, 0, NULL); /* one table: nothing to interpolate */
    put("a.dat", "2 NumTabs\n3 NumAlf\n-90 0 0 0\n0 0 0 0\n90 0 0 0\n");
    REFUSED(w.s, SPAR_ERR_UNSUPPORTED, "AFTabMod 2", spar_aero_read_aerodyn(w.aero, path, NULL, NULL, NULL));
    path = deck(NULL, NULL, NULL);
    OK(w.s, spar_aero_set_turn(w.aero, -1));
    REFUSED(w.s, SPAR_ERR_UNSUPPORTED, "spar_aero_set_turn", spar_aero_read_aerodyn(w.aero, path, NULL, NULL, NULL));
    OK(w.s, spar_aero_set_turn(w.aero, 1));
    REFUSED(w.s, SPAR_ERR_ARGUMENT, "a unit quaternion", spar_aero_read_aerodyn(w.aero, path, NULL, long_q, NULL));
    REFUSED(w.s, SPAR_ERR_ARGUMENT, "primary_path is NULL", spar_aero_read_aerodyn(w.aero, NULL, NULL, NULL, NULL));
    REFUSED(w.s, SPAR_ERR_ARGUMENT, "span 3.1; the blade file covers",
            spar_fluid_read_aerodyn(w.f, path, NULL, NULL, 2, off));
    REFUSED(w.s, SPAR_ERR_ARGUMENT, "section 1", spar_fluid_read_aerodyn(w.f, path, NULL, NULL, 2, none));
    REFUSED(w.s, SPAR_ERR_ARGUMENT, "span is NULL", spar_fluid_read_aerodyn(w.f, path, NULL, NULL, 2, NULL));
    REFUSED(w.s, SPAR_ERR_ARGUMENT, "-1 sections", spar_fluid_read_aerodyn(w.f, path, NULL, NULL, -1, off));
    assert_int_equal(spar_fluid_read_aerodyn(NULL, path, NULL, NULL, 0, NULL), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_aero_read_aerodyn(NULL, path, NULL, NULL, NULL), SPAR_ERR_ARGUMENT);
    double K[36];
    spar_member *other = NULL;
    scene_diagonal(K, 1e6, 1e6, 1e6, 1e6, 1e6, 1e6);
    other = scene_beam(w.s, "turned", 1, 4, 3, K, NULL);
    OK(w.s, spar_member_set_placement(other, NULL, turned)); /* the frames turn with the placement: alike */
    OK(w.s, spar_member_commit(other));
    spar_fluid *both[2] = {w.f, fluid_of(w.s, other)};
    OK(w.s, spar_fluid_read_aerodyn(both[1], path, NULL, NULL, 0, NULL));
    OK(w.s, spar_fluid_map(both[1]));
    OK(w.s, spar_aero_create(2, both, &pair));
    OK(w.s, spar_aero_read_aerodyn(pair, path, NULL, NULL, NULL));
    spar_aero_destroy(&pair);
    const double eta[2] = {0, 1}, xyz[6] = {0, 0, 0, 3, 0, 0}, twist[2] = {0.1, 0.1};
    OK(w.s, spar_beam_create(w.s, "twisted", 1, 4, &other)); /* a frame that carries some twist */
    OK(w.s, spar_beam_set_axis(other, 2, eta, xyz, twist));
    OK(w.s, spar_beam_set_sections(other, 1, eta, K, NULL));
    OK(w.s, spar_member_commit(other));
    both[1] = fluid_of(w.s, other);
    OK(w.s, spar_fluid_read_aerodyn(both[1], path, NULL, NULL, 0, NULL));
    OK(w.s, spar_fluid_map(both[1]));
    OK(w.s, spar_aero_create(2, both, &pair));
    REFUSED(w.s, SPAR_ERR_ARGUMENT, "blade 1 ('sections')", spar_aero_read_aerodyn(pair, path, NULL, NULL, NULL));
    spar_aero_destroy(&pair);
    REFUSED(w.s, SPAR_ERR_ARGUMENT, "the spans of the sections",
            spar_aero_read_aerodyn(w.aero, PRIMARY, NULL, NULL, NULL));
    OK(w.s, spar_fluid_set_motion_nodes(w.f, 4, (double[12]){0}));
    OK(w.s, spar_fluid_map(w.f));
    REFUSED(w.s, SPAR_ERR_STATE, "had 3 sections", spar_aero_read_aerodyn(w.aero, path, NULL, NULL, NULL));
    OK(NULL, spar_aero_create(0, NULL, &pair)); /* a rank without blades reads all the same */
    OK(NULL, spar_aero_read_aerodyn(pair, path, NULL, NULL, NULL));
    assert_int_equal(spar_aero_read_aerodyn(pair, "nowhere.dat", NULL, NULL, NULL), SPAR_ERR_IO);
    assert_non_null(strstr(spar_session_message(NULL), "nowhere.dat"));
    spar_aero_destroy(&pair);
    no_deck();
    end_wing(&w);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_rotor),    cmocka_unit_test(test_between),  cmocka_unit_test(test_frame),
        cmocka_unit_test(test_variants), cmocka_unit_test(test_flaps),    cmocka_unit_test(test_blends),
        cmocka_unit_test(test_mistakes), cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests(tests, load, unload);
}
