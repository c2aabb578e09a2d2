/* How the error of a beam falls, and how its cost grows; CSV on standard output.

   beam_curves nodes        static error over nodes: roll-up, elastica, 45-degree bend, composite box
   beam_curves dt           dynamic error over dt for four rho_inf: composite cantilever under a smooth load
   beam_curves points       error over quadrature points of a blade whose properties jump between its stations
   beam_curves pieces       the same blade, error over nodes, by the two rules
   beam_curves elements     microseconds a step and bytes, 1 to 256 elements */
#include "beam_scene.h"

#include <malloc.h>

static const double pi = 3.14159265358979323846;

static void diagonal(double m[36], double a, double b, double c, double d, double e, double f) {
    const double x[6] = {a, b, c, d, e, f};
    memset(m, 0, 36 * sizeof *m);
    for (int i = 0; i < 6; i++) {
        m[7 * i] = x[i];
    }
}

/* ---- nodes ---- */

/* displacement of the tip of a cantilever with this load there */
static void deflect(int64_t n, const double *eta, const double *xyz, const double K[36], int nodes,
                    const double load[6], double u[3]) {
    spar_session *s;
    spar_member *b;
    MUST(NULL, spar_session_create(&s));
    MUST(s, spar_beam_create(s, "beam", 1, nodes, &b));
    MUST(s, spar_beam_set_axis(b, n, eta, xyz, NULL));
    MUST(s, spar_beam_set_sections(b, 1, eta, K, NULL));
    MUST(s, spar_member_commit(b));
    MUST(s, spar_member_set_load(b, nodes - 1, SPAR_LOAD_DEAD, load));
    MUST(s, spar_member_solve_static(b, 4));
    tip(b, u);
    spar_session_destroy(&s);
}

static double distance(const double a[3], const double b[3]) {
    return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
}

static void over_nodes(void) {
    enum { ARC = 60 };
    const double line[2] = {0, 1}, straight[6] = {0, 0, 0, 10, 0, 0}, unit[6] = {0, 0, 0, 1, 0, 0};
    double eta[ARC], arc[3 * ARC], roll[36], elastic[36], bend[36], box[36];
    const double moment[6] = {0, 0, 0, 0, -2 * pi * 86.9e3 / 10, 0}, ten[6] = {0, 0, 10, 0, 0, 0},
                 up600[6] = {0, 0, 600, 0, 0, 0}, up150[6] = {0, 0, 150, 0, 0, 0};
    const double exact[4][3] = {{-10, 0, 0},
                                {-0.5549955977538, 0, 0.8106090248803 + 1e-9},
                                {-23.5612967857147, 13.6050230096446, 53.4761081402819},
                                {-0.0902726627566, -0.0647488486259, 1.2297364829237}};
    for (int i = 0; i < ARC; i++) {
        double a = pi / 4 * i / (ARC - 1);
        eta[i] = (double)i / (ARC - 1);
        arc[3 * i] = 100 * sin(a), arc[3 * i + 1] = -100 * (1 - cos(a)), arc[3 * i + 2] = 0;
    }
    diagonal(roll, 1.77e6, 1.77e6, 1.77e6, 8.16e3, 86.9e3, 215e3);
    diagonal(elastic, 1e10, 1e10, 1e10, 1, 1, 1);
    diagonal(bend, 1e7, 4.16667e6, 4.16667e6, 8.333e5, 8.333e5, 8.333e5);
    diagonal(box, 1368.17e3, 88.56e3, 38.78e3, 16.96e3, 59.12e3, 141.47e3);
    box[6 * 3 + 4] = box[6 * 4 + 3] = 17.61e3;
    box[6 * 3 + 5] = box[6 * 5 + 3] = -0.351e3;
    box[6 * 4 + 5] = box[6 * 5 + 4] = -0.370e3;
    printf("nodes,roll-up (full circle),elastica (P L^2/EI = 10),45-degree bend,composite box\n");
    for (int nodes = 4; nodes <= 22; nodes++) {
        double u[4][3];
        deflect(2, line, straight, roll, nodes, moment, u[0]);
        deflect(2, line, unit, elastic, nodes, ten, u[1]);
        deflect(ARC, eta, arc, bend, nodes, up600, u[2]);
        deflect(2, line, straight, box, nodes, up150, u[3]);
        const double length[4] = {10, 1, 78.5398163397, 10};
        printf("%d", nodes);
        for (int k = 0; k < 4; k++) {
            printf(",%.3e", fmax(distance(u[k], exact[k]) / length[k], 1e-16));
        }
        printf("\n");
    }
}

/* ---- dt ---- */

/* Load 25 (1 - cos 10 t)^2: it and three derivatives start at zero, so that no mode of the mesh rings. */
static void swing(double dt, double rho, double u[3]) {
    scene s;
    box_scene(&s, 1, 8, dt, rho);
    MUST(s.session, spar_session_set_newton(s.session, 1e-12, 1e-12, 30));
    int n = (int)(0.4 / dt + 0.5);
    for (int k = 1; k <= n; k++) {
        double load[6] = {0, 0, 25 * pow(1 - cos(10 * k * dt), 2), 0, 0, 0};
        MUST(s.session, spar_member_set_load(s.member, 7, SPAR_LOAD_DEAD, load));
        step(&s);
    }
    tip(s.member, u);
    spar_session_destroy(&s.session);
}

static void over_dt(void) {
    const double rho[4] = {0, 0.5, 0.8, 1};
    double a[3], b[3], c[3], exact[3];
    swing(2.5e-5, 0.8, a);
    swing(1.25e-5, 0.8, b);
    for (int i = 0; i < 3; i++) {
        exact[i] = b[i] + (b[i] - a[i]) / 3;
    }
    printf("dt,rho_inf = 0,rho_inf = 0.5,rho_inf = 0.8,rho_inf = 1\n");
    for (double dt = 1.6e-2; dt > 1e-4; dt /= 2) {
        printf("%g", dt);
        for (int k = 0; k < 4; k++) {
            swing(dt, rho[k], c);
            printf(",%.3e", distance(c, exact) / 10);
        }
        printf("\n");
    }
}

/* ---- quadrature ---- */

/* A cantilever of length 10 whose bending stiffness jumps (over 1e-6 of the length) at five stations by factors of 2 to
   8, under a small tip force; statically determined: the deflection is P int (L - x)^2 / EI + 1 / GA dx in closed form.
 */
enum { PIECES = 6 };
static const double joint[PIECES + 1] = {0, 0.137, 0.31, 0.472, 0.55, 0.83, 1};
static const double rigidity[PIECES] = {5e4, 3.5e4, 4.4e4, 2.5e4, 3.1e4, 2e4};
static const double shear_rigidity = 1e7, jump_width = 1e-6;

/* relative error of the tip's deflection; points: in an element, or in a section interval; used: points in all */
static double jumping(int nodes, int rule, int points, int *used) {
    double eta[2 * PIECES], K[36 * 2 * PIECES], load[6] = {0, 0, 1e-3, 0, 0, 0}, u[3], exact = 10 / shear_rigidity;
    const double line[2] = {0, 1}, xyz[6] = {0, 0, 0, 10, 0, 0};
    spar_session *s;
    spar_member *b;
    for (int i = 0; i < PIECES; i++) {
        double from = 10 * (1 - joint[i]), to = 10 * (1 - joint[i + 1]);
        eta[2 * i] = i == 0 ? 0 : joint[i] + jump_width / 2;
        eta[2 * i + 1] = i == PIECES - 1 ? 1 : joint[i + 1] - jump_width / 2;
        for (int k = 0; k < 2; k++) {
            diagonal(K + 36 * (2 * i + k), 1e7, shear_rigidity, shear_rigidity, 1e5, rigidity[i], 1e5);
        }
        exact += (from * from * from - to * to * to) / 3 / rigidity[i];
    }
    MUST(NULL, spar_session_create(&s));
    MUST(s, spar_beam_create(s, "blade", 1, nodes, &b));
    MUST(s, spar_beam_set_axis(b, 2, line, xyz, NULL));
    MUST(s, spar_beam_set_sections(b, 2 * PIECES, eta, K, NULL));
    MUST(s, spar_beam_set_quadrature(b, rule, points));
    MUST(s, spar_member_commit(b));
    MUST(s, spar_member_set_load(b, nodes - 1, SPAR_LOAD_DEAD, load));
    MUST(s, spar_member_solve_static(b, 1));
    tip(b, u);
    *used = b->body->first[1];
    spar_session_destroy(&s);
    return u[2] / (exact * 1e-3) - 1;
}

/* Tip of an NREL 5-MW blade under its own weight, across its chord; points 0: the finest per-section rule */
static double blade_tip(nrel5mw *turbine, int nodes, int rule, int points, int *used) {
    const double gravity[3] = {-9.81, 0, 0};
    nrel5mw_rotor rotor;
    spar_session *s;
    spar_member *b;
    double u[3];
    nrel5mw_rotor_default(turbine, &rotor);
    MUST(NULL, spar_session_create(&s));
    MUST(s, spar_session_set_gravity(s, gravity));
    MUST(s, nrel5mw_create_blade(turbine, &rotor, s, 0, 1, nodes, &b));
    MUST(s, spar_beam_set_quadrature(b, rule, points));
    MUST(s, spar_member_commit(b));
    MUST(s, spar_member_solve_static(b, 1));
    tip(b, u);
    *used = b->body->first[1];
    spar_session_destroy(&s);
    return u[0];
}

/* What the quadrature does to the answer of one mesh, whose own error is there however well it is integrated: against
   the finest per-section rule. */
static void over_points(void) {
    enum { NODES = 12 };
    int used;
    nrel5mw turbine;
    if (nrel5mw_load(&turbine, SPAR_DATA_DIR "/nrel5mw") != SPAR_OK) {
        fprintf(stderr, "beam_curves: %s\n", turbine.message);
        exit(1);
    }
    double exact = jumping(NODES, SPAR_QUADRATURE_SECTIONS, 16, &used);
    double blade = blade_tip(&turbine, NODES, SPAR_QUADRATURE_SECTIONS, 8, &used);
    printf("points,scene,rule,error\n");
    for (int points = 2; points <= 10; points++) {
        double error = jumping(NODES, SPAR_QUADRATURE_SECTIONS, points, &used) - exact;
        printf("%d,jumps,sections,%.3e\n", used, fmax(fabs(error), 1e-16));
    }
    for (int points = 1; points <= 5; points++) {
        double error = blade_tip(&turbine, NODES, SPAR_QUADRATURE_SECTIONS, points, &used) / blade - 1;
        printf("%d,nrel5mw,sections,%.3e\n", used, fmax(fabs(error), 1e-16));
    }
    for (int points = NODES; points <= 240; points += points < 40 ? 1 : 5) {
        double error = jumping(NODES, SPAR_QUADRATURE_GAUSS, points, &used) - exact;
        printf("%d,jumps,gauss,%.3e\n", used, fmax(fabs(error), 1e-16));
        error = blade_tip(&turbine, NODES, SPAR_QUADRATURE_GAUSS, points, &used) / blade - 1;
        printf("%d,nrel5mw,gauss,%.3e\n", used, fmax(fabs(error), 1e-16));
    }
    nrel5mw_free(&turbine);
}

static void over_pieces(void) {
    int used;
    printf("nodes,per section,Gauss over the beam with as many points as nodes\n");
    for (int nodes = 4; nodes <= 24; nodes++) {
        printf("%d,%.3e", nodes, fabs(jumping(nodes, SPAR_QUADRATURE_SECTIONS, 8, &used)));
        printf(",%.3e\n", fabs(jumping(nodes, SPAR_QUADRATURE_GAUSS, nodes, &used)));
    }
}

/* ---- elements ---- */

static double bytes(void) {
    struct mallinfo2 m = mallinfo2();
    return (double)m.uordblks + (double)m.hblkhd;
}

static void over_elements(void) {
    enum { RUNS = 5 };
    printf("elements,us,newton,factors,us a newton,bytes\n");
    for (int elements = 1; elements <= 256; elements *= 2) {
        double took[RUNS], newton = 0, factors = 0, size = 0;
        int steps = 40 + 2000 / elements;
        for (int k = 0; k < RUNS; k++) {
            scene s;
            double before = bytes();
            box_scene(&s, elements, 6, 1e-3, 0);
            step(&s);
            size = bytes() - before;
            const spari_solver *solver = s.member->solution;
            int64_t newton0 = solver->newton, factors0 = solver->factors;
            double start = now();
            for (int i = 0; i < steps; i++) {
                step(&s);
            }
            took[k] = (now() - start) / steps;
            newton = (double)(solver->newton - newton0) / steps;
            factors = (double)(solver->factors - factors0) / steps;
            spar_session_destroy(&s.session);
        }
        double us = median(took, RUNS);
        printf("%d,%.2f,%.3f,%.3f,%.2f,%.0f\n", elements, us, newton, factors, us / newton, size);
    }
}

int main(int argc, char **argv) {
    static const struct {
        const char *name;
        void (*run)(void);
    } curve[] = {{"nodes", over_nodes},
                 {"dt", over_dt},
                 {"points", over_points},
                 {"pieces", over_pieces},
                 {"elements", over_elements}};
    for (size_t i = 0; i < sizeof curve / sizeof *curve; i++) {
        if (argc == 2 && strcmp(argv[1], curve[i].name) == 0) {
            curve[i].run();
            return 0;
        }
    }
    fprintf(stderr, "usage: beam_curves nodes | dt | points | pieces | elements\n");
    return 2;
}
