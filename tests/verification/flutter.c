/* Flutter of wings as eigenvalues of structure and fluid, the fluid's answer found by trials (spar_aero: strips of thin
   airfoil with Jones' lags). Goland's wing: J. Appl. Mech. 12 (1945) and Goland & Luke 15 (1948): 137.2 m/s at 70.7
   rad/s by Theodorsen's function. The sixteen-metre wing, straight: Patil, Hodges & Cesnik, J. Aircraft 38
   (2001), 32.21 m/s at 22.61 rad/s, divergence at 37.29 m/s. Beside these, strips with the same lags on exact bending
   and torsion modes of a uniform cantilever, whose determinant is solved here. */
#include "trials.h"
#include "verification.h"

#include <complex.h>
#include <spar/spar_aero.h>

static const double pi = 3.14159265358979323846;
static const double jones_share[2] = {0.165, 0.335}, jones_rate[2] = {0.0455, 0.3};

/* axis, mass centre: parts of the chord behind its middle */
typedef struct wing_data {
    double span, chord, axis, centre, mass, inertia, flap, twist, lag, density;
} wing_data;
static const wing_data goland = {6.096,   1.8288, -0.17, -0.17 + 0.183 / 1.8288, 35.71, 8.64, 9.77e6,
                                 0.987e6, 9.77e8, 1.225};
static const wing_data hale = {16, 1, 0, 0, 0.75, 0.1, 2e4, 1e4, 4e6, 0.0889};

/* ---- by the library ---- */

enum { STRIPS = 33, NODES = 10 };
typedef struct wing {
    const wing_data *of;
    spar_session *s;
    spar_member *beam;
    spar_fluid *air;
    spar_polar *polar;
    spar_aero *aero;
    double speed, wind[STRIPS][3];
} wing;

static int blow(spar_session *s, double t, double dt, int iteration, void *context) {
    wing *w = context;
    (void)s, (void)t, (void)dt, (void)iteration;
    for (int i = 0; i < STRIPS; i++) {
        w->wind[i][1] = w->speed;
    }
    return spar_aero_solve(w->aero, w->of->density, w->wind[0], 1);
}

static void build(wing *w, const wing_data *of, double speed, double angle) {
    const double eta[2] = {0, 1}, xyz[6] = {0, 0, 0, of->span, 0, 0}, twist[2] = {angle, angle};
    const double centre[3] = {0, (of->centre - of->axis) * of->chord, 0};
    const double own = of->inertia - of->mass * centre[1] * centre[1], J[3] = {own, 1e-4 * own, own};
    const double alpha[2] = {-0.5, 0.5}, cl[2] = {-pi, pi}, cd[2] = {0, 0};
    double K[36], M[36], along[STRIPS], offset[STRIPS][3] = {{0}};
    *w = (wing){.of = of, .s = scene_session(), .speed = speed};
    scene_diagonal(K, 1e3 * of->flap, 1e3 * of->flap, 1e3 * of->flap, of->twist, of->flap, of->lag);
    scene_mass(M, of->mass, centre, J);
    OK(w->s, spar_beam_create(w->s, "wing", 1, NODES, &w->beam));
    OK(w->s, spar_beam_set_axis(w->beam, 2, eta, xyz, twist));
    OK(w->s, spar_beam_set_sections(w->beam, 1, eta, K, M));
    OK(w->s, spar_member_set_root(w->beam, SPAR_ROOT_FIXED));
    OK(w->s, spar_member_commit(w->beam));
    OK(w->s, spar_fluid_create(w->beam, "air", &w->air));
    for (int i = 0; i < STRIPS; i++) {
        along[i] = 1.0 * i / (STRIPS - 1);
        offset[i][1] = (-0.25 - of->axis) * of->chord;
    }
    OK(w->s, spar_fluid_set_stations(w->air, STRIPS, along, offset[0]));
    OK(w->s, spar_fluid_map(w->air));
    OK(w->s, spar_polar_create(2, alpha, cl, cd, NULL, &w->polar));
    OK(w->s, spar_aero_create(1, &w->air, &w->aero));
    for (int i = 0; i < STRIPS; i++) {
        OK(w->s, spar_aero_set_section(w->aero, i, of->chord, 0, w->polar));
    }
    OK(w->s, spar_aero_set_effects(w->aero, SPAR_AERO_UNSTEADY));
}

static void release(wing *w) {
    spar_aero_destroy(&w->aero);
    spar_polar_destroy(&w->polar);
    spar_session_destroy(&w->s);
}

/* The eigenvalue of the library nearest to the shift. */
static double complex by_trials(wing *w, double dt, int64_t memory, int64_t modes, double complex shift) {
    const double at[2] = {creal(shift), cimag(shift)};
    double value[2];
    OK(w->s, trial_eigenvalues(w->s, dt, memory, 0, NULL, blow, w, modes, 1, at, value, 0, NULL, NULL));
    return value[0] + value[1] * I;
}

/* ---- by strips on bending and torsion modes ---- */

enum { BENDING = 4, ALL = 2 * BENDING, POINTS = 400 };
typedef struct strip_modes {
    double mass[ALL][ALL], stiff[ALL], along[BENDING][BENDING]; /* along: of a bending and a torsion mode */
} strip_modes;

/* Bending mode k of a cantilever at x in [0, 1], of unit square; *root: its wave number */
static double bending(int k, double x, double *root) {
    double b = k == 0 ? 1.875104068711961 : k == 1 ? 4.694091132974175 : (k + 0.5) * pi;
    for (int i = 0; i < 20; i++) {
        b -= (cos(b) * cosh(b) + 1) / (cos(b) * sinh(b) - sin(b) * cosh(b));
    }
    *root = b;
    double s = (sinh(b) - sin(b)) / (cosh(b) + cos(b));
    return cosh(b * x) - cos(b * x) - s * (sinh(b * x) - sin(b * x));
}

static double torsion(int k, double x) {
    return sqrt(2) * sin((k + 0.5) * pi * x);
}

static void find_modes(const wing_data *d, strip_modes *m) {
    double b, offset = (d->centre - d->axis) * d->chord;
    memset(m, 0, sizeof *m);
    for (int i = 0; i < BENDING; i++) {
        (void)bending(i, 0, &b);
        m->stiff[i] = d->flap * pow(b / d->span, 4) * d->span;
        m->stiff[BENDING + i] = d->twist * pow((i + 0.5) * pi / d->span, 2) * d->span;
        for (int j = 0; j < BENDING; j++) {
            for (int p = 0; p < POINTS; p++) {
                double x = (p + 0.5) / POINTS;
                m->along[i][j] += bending(i, x, &b) * torsion(j, x) * d->span / POINTS;
            }
            m->mass[i][BENDING + j] = m->mass[BENDING + j][i] = d->mass * offset * m->along[i][j];
        }
        m->mass[i][i] = d->mass * d->span;
        m->mass[BENDING + i][BENDING + i] = d->inertia * d->span;
    }
}

/* log of the determinant of s^2 M + K + loads of plunge (down) and pitch, as Theodorsen has them with Jones' lags. */
static double complex log_determinant(const wing_data *d, const strip_modes *m, double U, double complex s) {
    double b = 0.5 * d->chord, a = 2 * d->axis, air = pi * d->density * b * b;
    double complex T[ALL][ALL], part = 1, log_of = 0;
    for (int i = 0; i < 2; i++) {
        part += jones_share[i] * (jones_rate[i] * U / b / (s + jones_rate[i] * U / b) - 1);
    }
    double complex steady = 2 * pi * d->density * U * b * part, wash[2] = {s, U + b * (0.5 - a) * s};
    double complex lift[2] = {air * s * s + steady * wash[0], air * (U * s - b * a * s * s) + steady * wash[1]};
    double complex moment[2] = {air * b * a * s * s + steady * b * (a + 0.5) * wash[0],
                                air * (-U * b * (0.5 - a) * s - b * b * (0.125 + a * a) * s * s) +
                                    steady * b * (a + 0.5) * wash[1]};
    for (int i = 0; i < ALL; i++) {
        for (int j = 0; j < ALL; j++) {
            int up = i < BENDING, left = j < BENDING;
            double same = up == left ? (i == j) * d->span : m->along[up ? i : j][(up ? j : i) - BENDING];
            T[i][j] = s * s * m->mass[i][j] + (i == j) * m->stiff[i];
            T[i][j] += same * (up ? lift[!left] : -moment[!left]);
        }
    }
    for (int k = 0; k < ALL; k++) {
        log_of += clog(T[k][k]);
        for (int i = k + 1; i < ALL; i++) {
            double complex f = T[i][k] / T[k][k];
            for (int j = k; j < ALL; j++) {
                T[i][j] -= f * T[k][j];
            }
        }
    }
    return log_of;
}

/* Newton's method on it. */
static double complex by_strips(const wing_data *d, double U, double complex s) {
    strip_modes m;
    find_modes(d, &m);
    for (int i = 0; i < 40; i++) {
        double complex h = 1e-5 * cabs(s);
        double complex slope = (log_determinant(d, &m, U, s + h) - log_determinant(d, &m, U, s - h)) / (2 * h);
        s -= 1 / slope;
    }
    return s;
}

/* ---- speeds ---- */

/* Between two speeds, where the growth rate of what is next to `at` passes 0; real: a motion without frequency */
static double limit_between(const wing_data *of, double dt, double low, double high, double complex at, double *w) {
    while (high - low > 2e-4 * low) {
        double middle = 0.5 * (low + high);
        wing scene;
        build(&scene, of, middle, 0);
        double complex s = by_trials(&scene, dt, 60, 8, at);
        release(&scene);
        *(creal(s) > 0 ? &high : &low) = middle;
        *w = cimag(s);
    }
    return 0.5 * (low + high);
}

static double strips_limit(const wing_data *of, double low, double high, double complex at) {
    while (high - low > 1e-5 * low) {
        double middle = 0.5 * (low + high);
        *(creal(by_strips(of, middle, at)) > 0 ? &high : &low) = middle;
    }
    return 0.5 * (low + high);
}

/* 8 modes in and out of the plane; 33 strips with linear loads between them, dt 1/90 and 1/70 of the flutter's period,
   both of second order. */
static void test_goland(void **state) {
    (void)state;
    double w, speed = limit_between(&goland, 1e-3, 120, 150, 70 * I, &w);
    double same = strips_limit(&goland, 120, 150, -1 + 70 * I);
    verify("Goland: flutter speed", speed, 137.2, 0.01 * 137.2, "Goland & Luke 1948");
    verify("Goland: frequency there", w, 70.7, 0.02 * 70.7, "Goland & Luke 1948");
    verify("Goland: the same with Jones' lags", speed, same, 2e-3 * same, "strips on exact modes");
    for (double U = 100; U < 160; U += 50) {
        char what[64];
        wing scene;
        build(&scene, &goland, U, 0);
        double complex s = by_trials(&scene, 1e-3, 60, 8, 75 * I), exact = by_strips(&goland, U, s);
        release(&scene);
        (void)snprintf(what, sizeof what, "Goland at %g m/s: growth rate", U);
        verify(what, creal(s), creal(exact), 2e-3 * cabs(exact), "strips on exact modes");
        (void)snprintf(what, sizeof what, "Goland at %g m/s: frequency", U);
        verify(what, cimag(s), cimag(exact), 2e-3 * cabs(exact), "strips on exact modes");
    }
    verified();
}

static void test_hale(void **state) {
    (void)state;
    double w, still, speed = limit_between(&hale, 4e-3, 28, 36, 22.5 * I, &w);
    double same = strips_limit(&hale, 28, 36, 22.5 * I), diverges = limit_between(&hale, 4e-3, 36, 39, 0, &still);
    verify("sixteen-metre wing: flutter speed", speed, 32.21, 0.015 * 32.21, "Patil et al. 2001");
    verify("sixteen-metre wing: frequency there", w, 22.61, 0.025 * 22.61, "Patil et al. 2001");
    verify("sixteen-metre wing: divergence", diverges, 37.29, 0.01 * 37.29, "Patil et al. 2001");
    verify("sixteen-metre wing: flutter with Jones' lags", speed, same, 2e-3 * same, "strips on exact modes");
    verified();
}

/* ---- against steps of time ---- */

/* Growth, 1/s, of the tip's motion along the chord about where it is at rest, by its largest sizes in half a second
   (more than a period) from `from` on and up to `to`. */
static double grows(wing *w, double dt, double rest, double from, double to) {
    double largest[2] = {0, 0}, q[7 * NODES];
    int64_t steps = (int64_t)(to / dt + 0.5), wait = (int64_t)(from / dt + 0.5), part = (int64_t)(0.5 / dt);
    for (int64_t i = 0; i < steps; i++) {
        OK(w->s, spar_step(w->s, dt, blow, w, NULL));
        OK(w->s, spar_member_get_motion(w->beam, q, NULL, NULL));
        double size = fabs(q[7 * (NODES - 1) + 1] - rest);
        int late = i >= steps - part, early = i >= wait && i < wait + part;
        if (late || early) {
            largest[late] = fmax(largest[late], size);
        }
    }
    return log(largest[1] / largest[0]) / (to - from - 0.5);
}

/* The sixteen-metre wing bent by its lift, 1 degree at the root, no weight: flutter between 22 and 26 m/s, where the
   straight one flutters at 32.7. Steps of time, the integrator damping what is
   fast, dt 1/90 of the period: below and above,
   the tip pushed along the chord by 5 N for one step, decay and growth from 4 s to 14 s are those of the eigenvalue to
   0.02 % of its frequency. */
static void test_bent(void **state) {
    (void)state;
    const double speeds[2] = {22, 26}, dt = 4e-3, guess[2] = {18.3, 13.2};
    for (int k = 0; k < 2; k++) {
        wing w;
        char what[64];
        double q[7 * NODES], push[6] = {0, 5}, none[6] = {0};
        build(&w, &hale, speeds[k], pi / 180);
        OK(w.s, spar_session_set_integrator(w.s, 0.5, 1));
        OK(w.s, spar_session_set_coupling(w.s, SPAR_COUPLING_IQN_ILS, 0, 1e-9, 60));
        OK(w.s, spar_session_solve_static(w.s, 4, blow, &w, NULL));
        OK(w.s, spar_member_get_motion(w.beam, q, NULL, NULL));
        double complex s = by_trials(&w, dt, 80, 12, guess[k] * I);
        OK(w.s, spar_member_set_load(w.beam, NODES - 1, SPAR_LOAD_DEAD, push));
        OK(w.s, spar_step(w.s, dt, blow, &w, NULL));
        OK(w.s, spar_member_set_load(w.beam, NODES - 1, SPAR_LOAD_DEAD, none));
        double marched = grows(&w, dt, q[7 * (NODES - 1) + 1], 4, 14);
        (void)snprintf(what, sizeof what, "bent wing at %g m/s: growth rate", speeds[k]);
        verify(what, creal(s), marched, 2e-4 * cabs(s), "steps of time");
        release(&w);
    }
    verified();
}

VERIFICATION_MAIN("Flutter of wings by eigenvalues", cmocka_unit_test(test_goland), cmocka_unit_test(test_hale),
                  cmocka_unit_test(test_bent))
