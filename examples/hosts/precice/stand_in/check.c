/* The participant against the stand-in of preCICE and a fluid: what comes out is compared with closed forms. On any
   number of ranks; files in the working folder. */
#include "../adapter/participant.h"
#include "fluid.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static int failures, rank;

static void expect(int good, const char *what, double value) {
    int all = good;
    double worst = value;
    MPI_Allreduce(MPI_IN_PLACE, &all, 1, MPI_INT, MPI_MIN, MPI_COMM_WORLD);
    MPI_Allreduce(MPI_IN_PLACE, &worst, 1, MPI_DOUBLE, MPI_MAX, MPI_COMM_WORLD);
    if (rank == 0) {
        printf("  %-88s %12.4e %s\n", what, worst, all ? "" : "WRONG");
    }
    failures += !all;
}

static void write_file(const char *name, const char *text) {
    MPI_Barrier(MPI_COMM_WORLD);
    if (rank == 0) {
        FILE *file = fopen(name, "w");
        if (!file || fputs(text, file) < 0 || fclose(file) != 0) {
            MPI_Abort(MPI_COMM_WORLD, 1);
        }
    }
    MPI_Barrier(MPI_COMM_WORLD);
}

/* A run of a case: the fluid's part, and the text of the case. */
static int run(const fluid *f, const char *text, char *message) {
    char none[1024];
    write_file("check.case", text);
    fluid_play(f);
    return participant_run("check.case", MPI_COMM_WORLD, message ? message : none, 1024);
}

/* ---- a floating body ---- */

/* A body of 2 kg that starts at 1 m/s along y, held by the fluid: y = sin(w t) / w, w^2 = spring / (2 + the fluid's
 * mass). */
static const char body[] = "[session]\nrho_inf 1\n%s\n[rigid buoy]\nmass 2 2 2 0.1 0.1 0.1\nvelocity 0 1 0\n"
                           "[host precice]\nconfig stand-in.xml\nmembers buoy\nmeshes buoy-mesh\n%s\n";
static const char points[] = "# around the body\n1 0 0\n-1 0 0\n0 0 0.5\n0 0 -0.5\n0 0.25 0\n0 -0.25 0\n";
static const char flat_points[] = "1 0 0\n-1 0 0\n0 0.25 0\n0 -0.25 0\n";
static const double vertices[7][3] = {{1, 0, 0},    {-1, 0, 0},    {0, 0, 0.5}, {0, 0, -0.5},
                                      {0, 0.25, 0}, {0, -0.25, 0}, {9, 0, 0}}; /* the last one is another body's */

static fluid spring_fluid(double window, double mass) {
    return (fluid){.implicit = 1,
                   .dimensions = 3,
                   .window = window,
                   .relaxation = mass > 0 ? 0.3 : 1,
                   .tolerance = 1e-11,
                   .windows = (int)lround(1 / window),
                   .most = 200,
                   .mesh = {{.name = "buoy-mesh", .own = 1, .spring = 50, .mass = mass}}};
}

static double exact(double t, double spring, double mass) {
    const double w = sqrt(spring / (2 + mass));
    return sin(w * t) / w;
}

/* Largest error of y over a run of 1 s, relative to the amplitude. */
static double error_of(const fluid *f, const char *session, const char *host) {
    char text[1024];
    double worst = 0;
    snprintf(text, sizeof text, body, session, host);
    if (run(f, text, NULL) != 0 || fluid_windows() != f->windows) {
        return 1e9;
    }
    for (int i = 0; i < f->windows; i++) {
        const double t = (i + 1) * f->window, w = sqrt(f->mesh[0].spring / (2 + f->mesh[0].mass));
        worst = fmax(worst, fabs(fluid_displacement(0, i)[1] - exact(t, f->mesh[0].spring, f->mesh[0].mass)) * w);
    }
    return worst;
}

static void test_implicit(void) {
    fluid f = spring_fluid(0.02, 0);
    const double coarse = error_of(&f, "", "points points.txt");
    expect(fluid_iterations(10) > 1 && fluid_iterations(10) < 20, "implicit: iterations of a window",
           fluid_iterations(10));
    f = spring_fluid(0.01, 0);
    const double fine = error_of(&f, "", "points points.txt");
    expect(fine < 1e-3, "implicit: error of the motion in 1 s, relative to the amplitude", fine);
    expect(fabs(coarse / fine - 4) < 0.3, "implicit: of second order, error at dt 0.02 over dt 0.01", coarse / fine);
}

static void test_explicit(void) {
    double error[2];
    for (int k = 0; k < 2; k++) {
        fluid f = spring_fluid(k == 0 ? 0.02 : 0.01, 0);
        f.implicit = 0;
        error[k] = error_of(&f, "", "points points.txt");
    }
    expect(fluid_iterations(10) == 1, "explicit: one iteration a window", fluid_iterations(10));
    /* forces a window late are a negative damping, of w^2 dt / 2 = 0.125 a second */
    expect(error[1] < 0.2 && fabs(error[0] / error[1] - 2) < 0.4,
           "explicit: of first order, error at dt 0.02 over dt 0.01", error[0] / error[1]);
}

/* From rest under a force of 8 N, with a fluid of five times the body's mass: y = F/k (1 - cos w t), w^2 = k / (2 +
   10). The stand-in takes accelerations by backward differences, to first order. */
static double heavy_error(double window, int implicit) {
    const char *text =
        "[session]\nrho_inf 0\n[rigid buoy]\nmass 2 2 2 0.1 0.1 0.1\n[host precice]\nconfig stand-in.xml\n"
        "members buoy\nmeshes buoy-mesh\npoints points.txt\n";
    fluid f = spring_fluid(window, 10);
    double worst = 0;
    f.implicit = implicit;
    f.mesh[0].force[1] = 8;
    if (run(&f, text, NULL) != 0) {
        return 1e9;
    }
    for (int i = 0; i < f.windows; i++) {
        worst = fmax(worst, fabs(fluid_displacement(0, i)[1] / 0.16 - 1 + cos(sqrt(50. / 12) * (i + 1) * window)));
    }
    return worst;
}

static void test_added_mass(void) {
    const double coarse = heavy_error(0.02, 1), fine = heavy_error(0.01, 1);
    expect(fine < 0.05, "a heavy fluid, implicit: error of the motion, relative to the amplitude", fine);
    expect(fabs(coarse / fine - 2) < 0.4, "the same: of first order, as the fluid is", coarse / fine);
    expect(heavy_error(0.01, 0) > 100, "the same, explicit: diverges, as it must", 0);
}

/* Steps within a window: the participant's own go back to a file, spar's substeps do not leave the step. Both have the
   forces linear in the window. */
static void test_subcycling(void) {
    fluid f = spring_fluid(0.02, 0);
    double own[50];
    const double error = error_of(&f, "", "points points.txt\ndt 0.005");
    for (int i = 0; i < 50; i++) {
        own[i] = fluid_displacement(0, i)[1];
    }
    expect(error < 2e-3, "subcycling by dt: error of the motion", error);
    double worst = error_of(&f, "substeps 4", "points points.txt") > 1 ? 1e9 : 0;
    for (int i = 0; i < 50; i++) {
        worst = fmax(worst, fabs(own[i] - fluid_displacement(0, i)[1]));
    }
    expect(worst < 1e-8, "four steps of dt in a window as four substeps: difference, m", worst);
    /* 0.0067 three times in 0.02 leave a sliver of -1e-4: the last step ends with the window */
    expect(error_of(&f, "", "points points.txt\ndt 0.0067") < 2e-3, "a dt that does not divide the window", 0);
    f.implicit = 0;
    expect(error_of(&f, "", "points points.txt\ndt 0.005") < 0.2, "subcycling in an explicit scheme", 0);
}

static void test_direct(void) {
    fluid f = spring_fluid(0.02, 0);
    double own[50], worst = 0;
    error_of(&f, "", "points points.txt");
    for (int i = 0; i < 50; i++) {
        own[i] = fluid_displacement(0, i)[1];
    }
    f.mesh[0].own = 0;
    f.mesh[0].n = 7;
    f.mesh[0].vertices = vertices[0];
    const double error = error_of(&f, "", "access direct\nreach 1.5");
    int here = fluid_vertices(0), n = 0;
    MPI_Allreduce(&here, &n, 1, MPI_INT, MPI_SUM, MPI_COMM_WORLD);
    for (int i = 0; i < 50; i++) {
        worst = fmax(worst, fabs(own[i] - fluid_displacement(0, i)[1]));
    }
    expect(error < 4e-3 && n == 6, "direct access: the vertices within reach", n);
    expect(worst < 1e-12, "direct access as one's own mesh of the same vertices: difference, m", worst);
}

/* Forces on one mesh, motion on another. */
static void test_two_meshes(void) {
    fluid f = spring_fluid(0.02, 0);
    char text[1024];
    f.mesh[0].force[1] = 8; /* constant: with no spring y = t + F t^2 / (2 m) */
    f.mesh[0].spring = 0;
    f.mesh[1] = (fluid_mesh){.name = "nodes", .own = 1};
    snprintf(text, sizeof text, body, "", "points points.txt\nforce_meshes buoy-mesh\nmotion_meshes nodes");
    char *line = strstr(text, "meshes buoy-mesh\npoints");
    memset(line, ' ', strlen("meshes buoy-mesh"));
    expect(run(&f, text, NULL) == 0, "forces on one mesh, motion on another", 0);
    const double error = fabs(fluid_displacement(1, 49)[1] - (1 + 8 / 2. / 2));
    expect(error < 1e-10, "under a constant force: error of the distance after 1 s, m", error);
}

/* A moment of 0.3 N m about z on 0.1 kg m^2: the angle is 1.5 t^2, the vertex at (1, 0, 0) is at its cosine. */
static void test_moment(void) {
    fluid f = spring_fluid(0.02, 0);
    f.mesh[0].moment[2] = 0.3;
    f.mesh[0].spring = 0;
    char text[1024];
    snprintf(text, sizeof text, body, "", "points points.txt\nmoment Moment\nvelocity Velocity");
    expect(run(&f, text, NULL) == 0, "moments are read, velocities written", 0);
    double error = 0;
    if (rank == 0) {
        error = fmax(fabs(fluid_vertex(0, 0)[0] - (cos(1.5) - 1)), fabs(fluid_vertex(0, 0)[1] - (1 + sin(1.5))));
    }
    expect(error < 1e-3, "under a constant moment: error of a vertex after 1 s, m", error);
    expect(fabs(fluid_velocity(0, 49)[1] - 1) < 1e-9, "mean velocity that is written, m/s", fluid_velocity(0, 49)[1]);
}

static void test_two_dimensions(void) {
    fluid f = spring_fluid(0.02, 0);
    double error, first = error_of(&f, "", "points flat.txt");
    f.dimensions = 2;
    error = error_of(&f, "", "points flat.txt");
    expect(fabs(error - first) < 1e-12 && error < 4e-3, "two dimensions as three: change of the error",
           fabs(error - first));
}

/* Two bodies on springs of 50 and 100 N/m, each as if it were alone. */
static void test_members(void) {
    fluid f = spring_fluid(0.01, 0);
    f.mesh[1] = (fluid_mesh){.name = "float-mesh", .own = 1, .spring = 100};
    const char *text = "[session]\nrho_inf 1\n[rigid buoy]\nmass 2 2 2 0.1 0.1 0.1\nvelocity 0 1 0\n"
                       "[rigid float]\nmass 2 2 2 0.1 0.1 0.1\nvelocity 0 1 0\n[host precice]\nconfig stand-in.xml\n"
                       "members buoy float\nmeshes buoy-mesh float-mesh\npoints points.txt points.txt\n";
    double worst = run(&f, text, NULL) == 0 ? 0 : 1e9;
    /* the trapezoidal rule lengthens a period by (w dt)^2 / 12: 3e-3 after 7 rad */
    for (int i = 0; i < 100; i++) {
        for (int k = 0; k < 2; k++) {
            const double spring = k == 0 ? 50 : 100;
            worst =
                fmax(worst, fabs(fluid_displacement(k, i)[1] - exact(0.01 * (i + 1), spring, 0)) * sqrt(spring / 2));
        }
    }
    expect(worst < 5e-3, "two members on two meshes: error of the motion", worst);
}

/* ---- a flap ---- */

/* A cantilever of 1 m along y, EI 100, kGA 1e4, a dead force on the points of its sides: F at each station a, in the
   end sum F a^2 (3 - a) / (6 EI) + F a / kGA at the tip. Small: 1e-3 m. The fluid's dampers and the integrator bring it
   to rest. */
static void test_flap(void) {
    fluid f = {.implicit = 1,
               .dimensions = 2,
               .window = 0.5,
               .relaxation = 1,
               .tolerance = 1e-11,
               .windows = 60,
               .most = 100,
               .mesh = {{.name = "flap-mesh", .own = 1, .damper = 2, .force = {0.1, 0, 0}}}};
    const char *text = "[session]\nrho_inf 0\n[beam flap]\nnodes 6\naxis 0 0 0 0\naxis 1 0 1 0\n"
                       "section 0 1e5 1e4 1e4 100 100 100 1 1 1 0.1 0.1 0.1\n[host precice]\nconfig stand-in.xml\n"
                       "members flap\nmeshes flap-mesh\nbox 0.1 0 11 1\n[output]\nhistory flap.txt\n";
    char message[1024];
    const int status = run(&f, text, message);
    double sum = 0, tip = 0;
    for (int i = 0; i < 11; i++) {
        const double a = 0.1 * i, force = 0.1 / 11;
        sum += force * a * a * (3 - a) / 600 + force * a / 1e4;
    }
    for (int i = 0; i < fluid_vertices(0); i++) {
        tip = fmax(tip, fluid_vertex(0, i)[0]);
    }
    MPI_Allreduce(MPI_IN_PLACE, &tip, 1, MPI_DOUBLE, MPI_MAX, MPI_COMM_WORLD);
    if (status != 0) {
        printf("    %s\n", message);
    }
    expect(status == 0 && fabs(tip / sum - 1) < 1e-4, "a flap in two dimensions: deflection over the closed form's",
           tip / sum);
    int rows = 0;
    MPI_Barrier(MPI_COMM_WORLD);
    FILE *file = fopen("flap.txt", "r");
    for (int c = file ? fgetc(file) : EOF; c != EOF; c = fgetc(file)) {
        rows += c == '\n';
    }
    if (file) {
        fclose(file);
    }
    expect(rows >= 60, "its history has a row for each window", rows);
}

/* ---- refusals ---- */

static void refused(const char *what, const char *words, const fluid *f, const char *text) {
    char message[1024];
    const int status = run(f, text, message);
    const int said = strstr(message, words) != NULL, peer = strstr(message, "another rank") != NULL;
    int any = 0;
    MPI_Allreduce(&said, &any, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD);
    expect(status != 0 && any && (said || peer), what, status);
    if (!said && !peer) {
        printf("    rank %d: %s\n", rank, message);
    }
}

static void test_refusals(void) {
    char text[1024];
    fluid f = spring_fluid(0.02, 0);
    snprintf(text, sizeof text, body, "", "points points.txt\nforcee Force");
    refused("a misspelt key", "forcee", &f, text);
    snprintf(text, sizeof text, body, "", "points points.txt two.txt");
    refused("two files of points for one member", "2 values for 1 members", &f, text);
    snprintf(text, sizeof text, body, "", "points none.txt");
    refused("points that are missing", "none.txt cannot be read", &f, text);
    snprintf(text, sizeof text, body, "", "access shared");
    refused("another access", "own or direct", &f, text);
    snprintf(text, sizeof text, body, "", "points points.txt\nforce Pressure");
    refused("forces that are no vectors", "a vector is wanted", &f, text);
    f.dimensions = 2;
    snprintf(text, sizeof text, body, "", "points points.txt");
    refused("points beside the plane of a mesh of two dimensions", "level is 0", &f, text);
    snprintf(text, sizeof text, body, "", "points flat.txt\nmoment Moment");
    refused("moments in two dimensions", "leave the moment out", &f, text);
    f = spring_fluid(0.02, 0);
    f.mesh[0].own = 0;
    f.mesh[0].n = 1;
    f.mesh[0].vertices = vertices[6];
    snprintf(text, sizeof text, body, "", "access direct\nreach 1.5");
    refused("direct access without a vertex in reach", "give a larger reach", &f, text);
}

int main(int argc, char **argv) {
    MPI_Init(&argc, &argv);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    write_file("points.txt", points);
    write_file("flat.txt", flat_points);
    test_implicit();
    test_explicit();
    test_added_mass();
    test_subcycling();
    test_direct();
    test_two_meshes();
    test_moment();
    test_two_dimensions();
    test_members();
    test_flap();
    test_refusals();
    MPI_Finalize();
    return failures == 0 ? 0 : 1;
}
