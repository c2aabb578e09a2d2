/* A decomposed flow solver round a blade, on any number of ranks: the same printed figures on 1, 2 and 4, to the last
   bit. The host's boundary mesh is cut into pieces without regard for the blade. A face belongs to one rank, which
   pushes its force; vertices repeat on the ranks whose faces share them, and are moved alike there. Where a real host
   would advance its flow, the pressure of linear acoustics stands here: rho c times what the gust is faster than the
   wall, on its moved faces. */
#include <math.h>
#include <spar/spar.h>
#include <spar/spar_coupling.h>
#include <spar/spar_structure.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#ifdef SPAR_WITH_MPI
#include <spar/spar_mpi.h>
#endif

static const double span = 20, dt = 0.02;    /* m, s */
static const double impedance = 1.225 * 340; /* of air, kg/(m^2 s) */
enum { ALONG = 60, AROUND = 24, FACES = ALONG * AROUND, VERTICES = (ALONG + 1) * AROUND, STEPS = 100 };

/* This rank's piece: its faces, and the vertices that they need. */
typedef struct piece {
    int64_t faces, vertices;
    int corner[FACES][4];                         /* of a face: this rank's numbers */
    int number[VERTICES];                         /* of a vertex of the whole mesh: this rank's, -1: it has none */
    double vertex[VERTICES][3], centre[FACES][3]; /* in the reference */
    double x[VERTICES][3], v[VERTICES][3], force[FACES][3]; /* now */
} piece;

static void check(const spar_session *s, int status) {
    if (status != SPAR_OK) {
        fprintf(stderr, "mpi_host: %s: %s\n", spar_status_text(status), spar_session_message(s));
#ifdef SPAR_WITH_MPI
        MPI_Abort(MPI_COMM_WORLD, 1);
#endif
        exit(1);
    }
}

/* Vertex j of ring i: an ellipse that tapers and twists along the span. */
static void place(int i, int j, double x[3]) {
    const double turn = 2 * 3.14159265358979323846 / AROUND, eta = (double)i / ALONG;
    double chord = 2 - 1.4 * eta, twist = 0.2 * (1 - eta);
    double along = 0.5 * chord * cos(turn * j), across = 0.12 * chord * sin(turn * j);
    x[0] = span * eta;
    x[1] = along * cos(twist) - across * sin(twist);
    x[2] = along * sin(twist) + across * cos(twist);
}

static int take_vertex(piece *p, int i, int j) {
    int *number = &p->number[i * AROUND + j % AROUND];
    if (*number < 0) {
        *number = (int)p->vertices++;
        place(i, j % AROUND, p->vertex[*number]);
    }
    return *number;
}

/* Faces are dealt out along a helix, so that borders run through rings. */
static void take_faces(piece *p, int rank, int ranks) {
    memset(p->number, -1, sizeof p->number);
    for (int f = FACES * rank / ranks; f < FACES * (rank + 1) / ranks; f++) {
        int i = f / AROUND, j = (f + 7 * i) % AROUND, *corner = p->corner[p->faces];
        corner[0] = take_vertex(p, i, j);
        corner[1] = take_vertex(p, i + 1, j);
        corner[2] = take_vertex(p, i + 1, j + 1);
        corner[3] = take_vertex(p, i, j + 1);
        for (int k = 0; k < 4; k++) {
            for (int c = 0; c < 3; c++) {
                p->centre[p->faces][c] += 0.25 * p->vertex[corner[k]][c];
            }
        }
        p->faces++;
    }
}

/* What stands for the flow: a gust across the blade that comes and goes, against the moving wall. */
static void solve_flow(piece *p, double t) {
    double gust = t < 1 ? 6 * pow(sin(3.14159265358979323846 * t), 2) : 0;
    for (int64_t f = 0; f < p->faces; f++) {
        const int *at = p->corner[f];
        double a[3], b[3], faster[3] = {0, 0, gust};
        for (int c = 0; c < 3; c++) {
            a[c] = p->x[at[2]][c] - p->x[at[0]][c];
            b[c] = p->x[at[3]][c] - p->x[at[1]][c];
            for (int k = 0; k < 4; k++) {
                faster[c] -= 0.25 * p->v[at[k]][c];
            }
        }
        /* half the product of the diagonals is the area times the inner normal here */
        const double n[3] = {0.5 * (a[1] * b[2] - a[2] * b[1]), 0.5 * (a[2] * b[0] - a[0] * b[2]),
                             0.5 * (a[0] * b[1] - a[1] * b[0])};
        double area = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        double through = faster[0] * n[0] + faster[1] * n[1] + faster[2] * n[2];
        for (int c = 0; c < 3; c++) {
            p->force[f][c] = impedance * through / area * n[c];
        }
    }
}

/* The host's own sum of its forces, over its faces and ranks. */
static void sum_forces(const piece *p, double sum[3]) {
    memset(sum, 0, 3 * sizeof *sum);
    for (int64_t f = 0; f < p->faces; f++) {
        for (int c = 0; c < 3; c++) {
            sum[c] += p->force[f][c];
        }
    }
#ifdef SPAR_WITH_MPI
    MPI_Allreduce(MPI_IN_PLACE, sum, 3, MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
#endif
}

static spar_member *create_blade(spar_session *s) {
    const double eta[2] = {0, 1}, axis[6] = {0, 0, 0, span, 0, 0}, damping[6] = {1e-3, 1e-3, 1e-3, 1e-3, 1e-3, 1e-3};
    const double stiffness[2][6] = {{3e9, 5e8, 5e8, 6e7, 1.2e8, 4e8}, {3e8, 5e7, 5e7, 4e5, 8e5, 3e6}};
    const double inertia[2][6] = {{200, 200, 200, 50, 10, 40}, {40, 40, 40, 1, 0.2, 0.8}};
    double K[2][36] = {{0}}, M[2][36] = {{0}};
    for (int end = 0; end < 2; end++) {
        for (int i = 0; i < 6; i++) {
            K[end][7 * i] = stiffness[end][i];
            M[end][7 * i] = inertia[end][i];
        }
    }
    spar_member *blade = NULL;
    check(s, spar_beam_create(s, "blade", 2, 6, &blade));
    check(s, spar_beam_set_axis(blade, 2, eta, axis, NULL));
    check(s, spar_beam_set_sections(blade, 2, eta, K[0], M[0]));
    check(s, spar_beam_set_damping(blade, damping));
    check(s, spar_member_set_root(blade, SPAR_ROOT_FIXED));
    check(s, spar_member_commit(blade));
    return blade;
}

/* One step; every rank makes every call. Returns the iterations. */
static int step(spar_session *s, spar_fluid *surface, piece *p, double t) {
    int done = 0, iterations = 0;
    double sum[3];
    check(s, spar_step_begin(s, dt));
    while (!done) {
        check(s, spar_step_solve(s));
        check(s, spar_fluid_pull_motion(surface, 1, p->x[0], p->v[0]));
        solve_flow(p, t + dt);
        check(s, spar_fluid_push_forces(surface, p->force[0], NULL));
        check(s, spar_step_check(s, &done));
        iterations++;
    }
    sum_forces(p, sum);
    check(s, spar_fluid_check_loads(surface, NULL, sum, NULL, 1e-12)); /* no face is pushed twice, and none left out */
    check(s, spar_step_accept(s));
    return iterations;
}

static void run(spar_session *s, spar_fluid *surface, spar_member *blade, piece *p, int speaks) {
    for (int i = 1; i <= STEPS; i++) {
        double q[12][7], force[3];
        int iterations = step(s, surface, p, (i - 1) * dt);
        check(s, spar_fluid_sum_loads(surface, NULL, force, NULL));
        check(s, spar_member_get_motion(blade, q[0], NULL, NULL));
        if (speaks && i % 10 == 0) {
            printf("%7.2f %24.16e %24.16e %12.5g %11d\n", i * dt, q[11][2], 2 * asin(q[11][5]), force[2], iterations);
        }
    }
}

int main(int argc, char **argv) {
    int rank = 0, ranks = 1;
    spar_session *s = NULL;
    spar_fluid *surface = NULL;
#ifdef SPAR_WITH_MPI
    MPI_Init(&argc, &argv);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    MPI_Comm_size(MPI_COMM_WORLD, &ranks);
    check(NULL, spar_session_create_mpi(MPI_COMM_WORLD, &s));
#else
    (void)argc, (void)argv;
    check(NULL, spar_session_create(&s));
#endif
    piece *p = calloc(1, sizeof *p);
    if (!p) {
        return 1;
    }
    take_faces(p, rank, ranks);
    check(s, spar_session_set_reproducible(s, 1)); /* the same bits however the faces are dealt out */
    check(s, spar_session_set_coupling(s, SPAR_COUPLING_IQN_ILS, 1e-6, 1e-8, 30));
    spar_member *blade = create_blade(s);
    check(s, spar_fluid_create(blade, "surface", &surface));
    check(s, spar_fluid_set_motion_nodes(surface, p->vertices, p->vertex[0])); /* those on borders on each rank */
    check(s, spar_fluid_set_force_nodes(surface, p->faces, p->centre[0]));     /* each on one */
    check(s, spar_fluid_map(surface));
    fprintf(stderr, "rank %d of %d: %lld faces, %lld vertices\n", rank, ranks, (long long)p->faces,
            (long long)p->vertices);
    if (rank == 0) {
        printf("time, s    tip along the gust, m    turn of the tip, rad     force, N  iterations\n");
    }
    run(s, surface, blade, p, rank == 0);
    spar_session_destroy(&s);
    free(p);
#ifdef SPAR_WITH_MPI
    MPI_Finalize();
#endif
    return 0;
}
