/* Eigenvalues of small motions, as curves; CSV on standard output.

   stability campbell   angular frequencies of a turning uniform blade over its speed, units of sqrt(EI / m L^4)
   stability beck       growth rate and frequency of a column over the follower force at its tip, units of EI / L^2
   stability goland     growth rates, 1/s, and frequencies, rad/s, of Goland's wing over the speed of the wind, m/s
   stability bent       the same of the sixteen-metre wing at 0 and 1 degree, bent by its lift: the least stable one */
#include "beam_scene.h"

#include <spar/spar_aero.h>
#include <stdio.h>

enum { NODES = 14, FIRST = 5 };

static void diagonal(double m[36], double a, double d, double b) {
    const double x[6] = {a, a, a, d, b, b};
    memset(m, 0, 36 * sizeof *m);
    for (int i = 0; i < 6; i++) {
        m[7 * i] = x[i];
    }
}

/* A slender beam of unit length, bending stiffness and mass. */
static spar_member *slender(spar_session *s, int root, double speed) {
    const double eta[2] = {0, 1}, xyz[6] = {0, 0, 0, 1, 0, 0}, w[3] = {0, 0, speed};
    double K[36], M[36];
    spar_member *b;
    diagonal(K, 1e7, 1e4, 1);
    diagonal(M, 1, 2e-8, 1e-8);
    MUST(s, spar_beam_create(s, "beam", 1, NODES, &b));
    MUST(s, spar_beam_set_axis(b, 2, eta, xyz, NULL));
    MUST(s, spar_beam_set_sections(b, 1, eta, K, M));
    MUST(s, spar_member_set_root(b, root));
    MUST(s, spar_member_set_initial_velocity(b, NULL, NULL, w));
    MUST(s, spar_member_commit(b));
    return b;
}

static void campbell(void) {
    printf("speed,first,second,third,fourth,fifth\n");
    for (double speed = 0; speed <= 12.01; speed += 0.25) {
        double value[FIRST][2];
        spar_session *s;
        MUST(NULL, spar_session_create(&s));
        spar_member *b = slender(s, SPAR_ROOT_DRIVEN, speed);
        MUST(s, spar_member_solve_static(b, 1));
        MUST(s, spar_member_solve_eigenvalues(b, FIRST, NULL, &value[0][0], NULL, NULL));
        printf("%g", speed);
        for (int i = 0; i < FIRST; i++) {
            printf(",%.8g", value[i][1]);
        }
        printf("\n");
        spar_session_destroy(&s);
    }
}

/* The four lowest: each of two planes alike, in one of which the growing and the decaying motion are a pair. */
static void beck(void) {
    printf("force,growth,frequency,symmetric\n");
    for (double force = 0; force <= 30.01; force += 0.25) {
        const double load[6] = {-force, 0, 0, 0, 0, 0};
        double value[4][2], mode[1];
        spar_session *s;
        MUST(NULL, spar_session_create(&s));
        spar_member *b = slender(s, SPAR_ROOT_FIXED, 0);
        MUST(s, spar_member_set_load(b, NODES - 1, SPAR_LOAD_FOLLOWER, load));
        MUST(s, spar_member_solve_static(b, 1));
        MUST(s, spar_member_solve_eigenvalues(b, 4, NULL, &value[0][0], NULL, NULL));
        MUST(s, spar_member_solve_modes(b, 1, mode, NULL));
        for (int i = 0; i < 4; i++) {
            printf("%g,%.8g,%.8g,%.8g\n", force, value[i][0], value[i][1], 6.283185307179586 * mode[0]);
        }
        spar_session_destroy(&s);
    }
}

/* ---- wings in the wind: strips of thin airfoil, spar_aero ---- */

enum { STRIPS = 33, POINTS = 10, BRANCHES = 3 };
/* axis, mass centre: parts of the chord behind its middle */
typedef struct wing_data {
    double span, chord, axis, centre, mass, inertia, flap, twist, lag, density;
} wing_data;

typedef struct wing {
    const wing_data *of;
    spar_session *s;
    spar_member *beam;
    spar_fluid *air;
    spar_polar *polar;
    spar_aero *aero;
    double wind[STRIPS][3];
} wing;

static int blow(spar_session *s, double t, double dt, int iteration, void *context) {
    wing *w = context;
    (void)s, (void)t, (void)dt, (void)iteration;
    return spar_aero_solve(w->aero, w->of->density, w->wind[0], 1);
}

static void describe_wing(wing *w, double angle) {
    const wing_data *of = w->of;
    const double eta[2] = {0, 1}, xyz[6] = {0, 0, 0, of->span, 0, 0}, twist[2] = {angle, angle};
    double c = (of->centre - of->axis) * of->chord, own = of->inertia - of->mass * c * c, K[36], M[36];
    diagonal(K, 1e3 * of->flap, of->twist, of->flap);
    K[35] = of->lag;
    diagonal(M, of->mass, of->inertia, 1e-4 * own);
    M[35] = of->inertia;
    M[5] = M[30] = -of->mass * c; /* the mass centre at y = c */
    M[15] = M[20] = of->mass * c;
    MUST(w->s, spar_beam_create(w->s, "wing", 1, POINTS, &w->beam));
    MUST(w->s, spar_beam_set_axis(w->beam, 2, eta, xyz, twist));
    MUST(w->s, spar_beam_set_sections(w->beam, 1, eta, K, M));
    MUST(w->s, spar_member_set_root(w->beam, SPAR_ROOT_FIXED));
    MUST(w->s, spar_member_commit(w->beam));
}

static void begin_wing(wing *w, const wing_data *of, double speed, double angle) {
    const double pi = 3.14159265358979323846, alpha[2] = {-0.5, 0.5}, cl[2] = {-pi, pi}, cd[2] = {0, 0};
    double along[STRIPS], offset[STRIPS][3] = {{0}};
    *w = (wing){.of = of};
    MUST(NULL, spar_session_create(&w->s));
    MUST(w->s, spar_session_set_coupling(w->s, SPAR_COUPLING_IQN_ILS, 0, 1e-9, 60));
    describe_wing(w, angle);
    MUST(w->s, spar_fluid_create(w->beam, "air", &w->air));
    for (int i = 0; i < STRIPS; i++) {
        along[i] = 1.0 * i / (STRIPS - 1);
        offset[i][1] = (-0.25 - of->axis) * of->chord;
        w->wind[i][1] = speed;
    }
    MUST(w->s, spar_fluid_set_stations(w->air, STRIPS, along, offset[0]));
    MUST(w->s, spar_fluid_map(w->air));
    MUST(w->s, spar_polar_create(2, alpha, cl, cd, NULL, &w->polar));
    MUST(w->s, spar_aero_create(1, &w->air, &w->aero));
    for (int i = 0; i < STRIPS; i++) {
        MUST(w->s, spar_aero_set_section(w->aero, i, of->chord, 0, w->polar));
    }
    MUST(w->s, spar_aero_set_effects(w->aero, SPAR_AERO_UNSTEADY));
}

static void end_wing(wing *w) {
    spar_aero_destroy(&w->aero);
    spar_polar_destroy(&w->polar);
    spar_session_destroy(&w->s);
}

/* Trials of the wing's small motions in its wind. */
static spar_trial *begin_trial(wing *w, double dt, int64_t modes, int64_t memory) {
    spar_trial *trial = NULL;
    MUST(w->s, spar_trial_create(w->s, &trial));
    MUST(w->s, spar_trial_set_steps(trial, dt, 1));
    MUST(w->s, spar_trial_set_callbacks(trial, NULL, NULL, blow, w));
    MUST(w->s, spar_trial_set_motion(trial, modes, 0, memory));
    return trial;
}

static void goland(void) {
    static const wing_data data = {6.096,   1.8288, -0.17, -0.17 + 0.183 / 1.8288, 35.71, 8.64, 9.77e6,
                                   0.987e6, 9.77e8, 1.225};
    printf("speed,growth,frequency\n");
    for (double speed = 10; speed <= 180.01; speed += 2) {
        double value[BRANCHES][2];
        wing w;
        begin_wing(&w, &data, speed, 0);
        spar_trial *trial = begin_trial(&w, 1e-3, 8, 60);
        MUST(w.s, spar_trial_solve_eigenvalues(trial, BRANCHES, NULL, &value[0][0], 0, NULL, NULL));
        for (int i = 0; i < BRANCHES; i++) {
            if (value[i][1] > 0 && value[i][1] < 150) {
                printf("%g,%.8g,%.8g\n", speed, value[i][0], value[i][1]);
            }
        }
        end_wing(&w);
    }
}

static void bent(void) {
    static const wing_data data = {16, 1, 0, 0, 0.75, 0.1, 2e4, 1e4, 4e6, 0.0889};
    const double angle[4] = {0, 0.5, 1, 2}, shift[2] = {0, 20};
    printf("angle,speed,tip,growth,frequency\n");
    for (int k = 0; k < 4; k++) {
        for (double speed = 14; speed <= 36.01; speed += 0.5) {
            double value[4][2], q[7 * POINTS];
            int most = -1;
            wing w;
            begin_wing(&w, &data, speed, angle[k] * 3.14159265358979323846 / 180);
            MUST(w.s, spar_session_solve_static(w.s, 4, blow, &w, NULL));
            MUST(w.s, spar_member_get_motion(w.beam, q, NULL, NULL));
            spar_trial *trial = begin_trial(&w, 4e-3, 12, 80);
            MUST(w.s, spar_trial_solve_eigenvalues(trial, 4, shift, &value[0][0], 0, NULL, NULL));
            for (int i = 0; i < 4; i++) { /* what moves along the chord alone is not in the air */
                int flies = value[i][1] > 1 && !(angle[k] == 0 && fabs(value[i][1] - 31.62) < 0.01);
                most = flies && (most < 0 || value[i][0] > value[most][0]) ? i : most;
            }
            if (most >= 0) {
                printf("%g,%g,%.8g,%.8g,%.8g\n", angle[k], speed, -q[7 * (POINTS - 1) + 2], value[most][0],
                       value[most][1]);
            }
            end_wing(&w);
        }
        printf("\n\n");
    }
}

int main(int argc, char **argv) {
    if (argc == 2 && strcmp(argv[1], "goland") == 0) {
        goland();
    } else if (argc == 2 && strcmp(argv[1], "bent") == 0) {
        bent();
    } else if (argc == 2 && strcmp(argv[1], "campbell") == 0) {
        campbell();
    } else if (argc == 2 && strcmp(argv[1], "beck") == 0) {
        beck();
    } else {
        fprintf(stderr, "stability campbell | beck | goland | bent\n");
        return 2;
    }
    return 0;
}
