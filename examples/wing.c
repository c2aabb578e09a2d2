/* The least a CFD host has to do, alone or under mpirun: a flexible wing (Goland's) in a steady wind of 50 m/s at 2
   degrees. The host has a surface mesh, cut into slabs over the ranks: its vertices move with the wing, its panels give
   forces. Where a real host would advance its flow, thin-aerofoil theory stands here: the pressure jump
   4 q alpha sqrt((1 - s)/s) over the chord, alpha by the moved mesh and its velocity. */
#include <math.h>
#include <spar/spar.h>
#include <spar/spar_coupling.h>
#include <spar/spar_structure.h>
#include <stdio.h>
#include <stdlib.h>
#ifdef SPAR_WITH_MPI
#include <spar/spar_mpi.h>
#endif

static const double pi = 3.14159265358979323846;
static const double span = 6.096, chord = 1.8288, torsion = 0.987e6; /* m, m, N m^2; the line at a third of the chord */
static const double density = 1.225, wind = 50, incidence = 2 * 3.14159265358979323846 / 180;
enum { STRIPS = 48, PANELS = 12, ACROSS = PANELS + 1, STEPS = 800 };
static const double dt = 0.005;

/* The host's own mesh: strips first .. last - 1 of the wing, vertices [last - first + 1][ACROSS]. */
typedef struct mesh {
    int first, last;
    int64_t vertices, panels;
    double *vertex, *centre; /* reference places */
    double *x, *v, *force;   /* now */
} mesh;

/* Every call has a status; spar_session_message says what was wrong, where, and the cure. */
static void check(const spar_session *s, int status) {
    if (status != SPAR_OK) {
        fprintf(stderr, "wing: %s: %s\n", spar_status_text(status), spar_session_message(s));
        exit(1);
    }
}

/* Place along the chord of vertex k: dense at the edges. */
static double chord_at(int k) {
    return 0.5 * (1 - cos(pi * k / PANELS));
}

/* Integrals of the pressure jump's shape over panel k: of sqrt((1 - s)/s), and of s times that. */
static void panel_load(int k, double *load, double *moment) {
    double a = pi * k / PANELS, b = pi * (k + 1) / PANELS;
    *load = 0.5 * (b - a + sin(b) - sin(a));
    *moment = 0.125 * (b - a - 0.5 * (sin(2 * b) - sin(2 * a)));
}

static int mesh_create(mesh *m, int rank, int ranks) {
    m->first = STRIPS * rank / ranks;
    m->last = STRIPS * (rank + 1) / ranks;
    int64_t strips = m->last - m->first;
    m->panels = strips * PANELS;
    m->vertices = strips > 0 ? (strips + 1) * ACROSS : 0;
    m->vertex = calloc((size_t)(9 * m->vertices + 6 * m->panels + 1), sizeof *m->vertex);
    if (!m->vertex) {
        return 1;
    }
    m->x = m->vertex + 3 * m->vertices;
    m->v = m->x + 3 * m->vertices;
    m->centre = m->v + 3 * m->vertices;
    m->force = m->centre + 3 * m->panels;
    for (int64_t i = 0; i < m->vertices;
         i++) { /* span along x, chord along y from the leading edge, the line at y = 0 */
        int64_t station = m->first + i / ACROSS;
        m->vertex[3 * i] = span * (double)station / STRIPS;
        m->vertex[3 * i + 1] = chord * (chord_at((int)(i % ACROSS)) - 0.33);
    }
    for (int64_t p = 0; p < m->panels; p++) {
        double load, moment; /* a panel's force stands at its centre of pressure */
        panel_load((int)(p % PANELS), &load, &moment);
        int64_t strip = m->first + p / PANELS;
        m->centre[3 * p] = span * ((double)strip + 0.5) / STRIPS;
        m->centre[3 * p + 1] = chord * (moment / load - 0.33);
    }
    return 0;
}

/* What stands for the flow: forces of the panels from the places and velocities of the vertices. */
static void solve_flow(const mesh *m) {
    double pressure = 0.5 * density * wind * wind, width = span / STRIPS;
    for (int64_t p = 0; p < m->panels; p++) {
        double share, moment;
        const double *lead = m->x + 3 * (p / PANELS * ACROSS), *trail = lead + 3 * PANELS;
        int64_t control = p / PANELS * ACROSS + 2 * PANELS / 3; /* alpha is that of 3/4 of the chord */
        double slope = atan2(lead[2] - trail[2], trail[1] - lead[1]);
        double alpha = incidence + slope - m->v[3 * control + 2] / wind;
        panel_load((int)(p % PANELS), &share, &moment);
        double lift = 4 * pressure * alpha * width * chord * share;
        m->force[3 * p] = 0;
        m->force[3 * p + 1] = -lift * sin(slope);
        m->force[3 * p + 2] = lift * cos(slope);
    }
}

/* One beam of 8 nodes; x along the span, y along the chord. */
static spar_member *create_wing(spar_session *s) {
    const double eta[2] = {0, 1}, axis[6] = {0, 0, 0, span, 0, 0}, damping[6] = {2e-3, 2e-3, 2e-3, 2e-3, 2e-3, 2e-3};
    const double m = 35.71, aft = 0.1 * chord; /* the mass centre lies behind the line */
    const double section[SPAR_SECTION_COUNT] = {
        [SPAR_SECTION_EA] = 1e9,        [SPAR_SECTION_GA_Y] = 2e8,
        [SPAR_SECTION_GA_Z] = 2e8,      [SPAR_SECTION_GJ] = torsion,
        [SPAR_SECTION_EI_Y] = 9.77e6,   [SPAR_SECTION_EI_Z] = 1e9,
        [SPAR_SECTION_MASS] = m,        [SPAR_SECTION_MASS_Y] = aft,
        [SPAR_SECTION_INERTIA_Y] = 0.1, [SPAR_SECTION_INERTIA_Z] = 8.54 - m * aft * aft};
    double K[36], M[36];
    check(NULL, spar_section_build(SPAR_SECTION_COUNT, section, K, M));
    spar_member *wing = NULL;
    check(s, spar_beam_create(s, "wing", 1, 8, &wing));
    check(s, spar_beam_set_axis(wing, 2, eta, axis, NULL));
    check(s, spar_beam_set_sections(wing, 1, eta, K, M));
    check(s, spar_beam_set_damping(wing, damping));
    check(s, spar_member_set_root(wing, SPAR_ROOT_FIXED));
    check(s, spar_member_commit(wing));
    return wing;
}

/* One step, call by call; spar_step does the same with the flow as a callback. Returns the iterations. */
static int step(spar_session *s, spar_fluid *surface, const mesh *m) {
    int done = 0, iterations = 0;
    check(s, spar_step_begin(s, dt)); /* predicts the loads */
    while (!done) {
        check(s, spar_step_solve(s));                              /* moves the structure to the end of the step */
        check(s, spar_fluid_pull_motion(surface, 1, m->x, m->v));  /* the mesh follows */
        solve_flow(m);                                             /* the host's own work */
        check(s, spar_fluid_push_forces(surface, m->force, NULL)); /* its answer */
        check(s, spar_step_check(s, &done));                       /* agreed? */
        iterations++;
    }
    check(s, spar_step_accept(s));
    return iterations;
}

/* The flow as spar_step and spar_session_solve_static call it. */
typedef struct host {
    spar_fluid *surface;
    const mesh *m;
} host;

static int steady_flow(spar_session *s, double t, double step_dt, int iteration, void *context) {
    const host *h = context;
    (void)t, (void)step_dt, (void)iteration;
    check(s, spar_fluid_pull_motion(h->surface, 1, h->m->x, h->m->v));
    solve_flow(h->m);
    return spar_fluid_push_forces(h->surface, h->m->force, NULL);
}

static void report(const spar_session *s, const spar_member *wing, int iterations) {
    double q[8][7], t;
    check(s, spar_member_get_motion(wing, q[0], NULL, NULL));
    check(s, spar_session_get_time(s, &t, NULL, NULL));
    printf("%8.2f %14.6f %14.6f %8d\n", t, q[7][2], -2 * atan2(q[7][4], q[7][3]) * 180 / pi, iterations);
}

int main(int argc, char **argv) {
    int rank = 0, ranks = 1;
    spar_session *s = NULL;
    spar_fluid *surface = NULL;
    mesh m = {0};
#ifdef SPAR_WITH_MPI
    MPI_Init(&argc, &argv);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    MPI_Comm_size(MPI_COMM_WORLD, &ranks);
    check(NULL, spar_session_create_mpi(MPI_COMM_WORLD, &s));
#else
    (void)argc, (void)argv;
    check(NULL, spar_session_create(&s));
#endif
    check(s, spar_session_set_coupling(s, SPAR_COUPLING_FIXED_POINT, 0, 1e-8, 30));
    spar_member *wing = create_wing(s);
    if (mesh_create(&m, rank, ranks) != 0) {
        return 1;
    }
    check(s, spar_fluid_create(wing, "surface", &surface));
    check(s, spar_fluid_set_motion_nodes(surface, m.vertices, m.vertex));
    check(s, spar_fluid_set_force_nodes(surface, m.panels, m.centre));
    check(s, spar_fluid_map(surface)); /* finds each node's nearest point on the line, once */
    if (rank == 0) {
        printf("  time s    tip up m   nose up deg   iterations\n");
    }
    for (int i = 1; i <= STEPS; i++) {
        int iterations = step(s, surface, &m);
        if (rank == 0 && (i % 80 == 0 || i == 8 || i == 24)) {
            report(s, wing, iterations);
        }
    }
    host h = {surface, &m};
    int iterations = 0;
    check(s, spar_session_solve_static(s, 1, steady_flow, &h, &iterations)); /* where the run is heading, at once */
    if (rank == 0) {
        printf("equilibrium, found by %d solutions of the flow:\n", iterations);
        report(s, wing, iterations);
    }
    if (rank == 0) { /* uniform wing, lift at a quarter: theta(tip) = alpha (1/cos(lambda) - 1) */
        double pressure = 0.5 * density * wind * wind, arm = (0.33 - 0.25) * chord;
        double lambda = span * sqrt(pressure * chord * arm * 2 * pi / torsion);
        printf("strip theory, at rest:  %14.6f deg at the tip\n", incidence * (1 / cos(lambda) - 1) * 180 / pi);
    }
    spar_session_destroy(&s); /* the wing and the surface go with it */
    free(m.vertex);
#ifdef SPAR_WITH_MPI
    MPI_Finalize();
#endif
    return 0;
}
