/* What a step of a beam costs, and how its error falls.

   beam [peers]         microseconds and Newton iterations a step, beside published codes; a table
   Figures are medians over runs of the mean over the steps of a run. Peers are compared by the yardstick: a 60 x 60 LU
   factorisation by GSL over its own CBLAS, which took 39 us where the peers were measured. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "nrel5mw.h"

#include "member/body.h"
#include "member/member.h"
#include "solve/solver.h"

enum { MOST_REPEATS = 64 };

static const double yardstick_of_peers = 39; /* us */

/* ---- small tools ---- */

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec * 1e6 + (double)t.tv_nsec * 1e-3;
}

static int ascending(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(double *x, int n) {
    qsort(x, (size_t)n, sizeof *x, ascending);
    return n % 2 ? x[n / 2] : 0.5 * (x[n / 2 - 1] + x[n / 2]);
}

static void must(const spar_session *session, int status, const char *what) {
    if (status != SPAR_OK) {
        fprintf(stderr, "beam: %s: %s: %s\n", what, spar_status_text(status), spar_session_message(session));
        exit(1);
    }
}

#define MUST(session, call) must(session, call, #call)

static double yardstick(void) {
    double took = NAN;
    FILE *f = popen(SPAR_YARDSTICK, "r");
    if (!f || fscanf(f, "%lf", &took) != 1) {
        fprintf(stderr, "beam: no yardstick at %s\n", SPAR_YARDSTICK);
        exit(1);
    }
    pclose(f);
    return took;
}

static void tip(const spar_member *member, double u[3]) {
    int64_t n;
    spar_member_get_count(member, &n);
    double *q = malloc((size_t)(7 * n) * sizeof *q);
    spar_member_get_motion(member, q, NULL, NULL);
    memcpy(u, q + 7 * (n - 1), 3 * sizeof *u);
    free(q);
}

/* ---- scenes: a session with one member, and what drives it ---- */

typedef struct scene {
    spar_session *session;
    spar_member *member;
    double dt;
    nrel5mw *turbine; /* NULL: nothing drives the root */
    nrel5mw_rotor rotor;
    int steps;
} scene;

/* Composite box beam of Wang et al. (Wind Energy 20, 2017), length 10, tip force 150 along z from rest */
static void box_scene(scene *s, int elements, int nodes, double dt, double rho) {
    const double eta[2] = {0, 1}, xyz[6] = {0, 0, 0, 10, 0, 0}, load[6] = {0, 0, 150, 0, 0, 0};
    const double k[6] = {1368.17e3, 88.56e3, 38.78e3, 16.96e3, 59.12e3, 141.47e3};
    const double m[6] = {8.538e-2, 8.538e-2, 8.538e-2, 1.4433e-2, 0.4097e-2, 1.0336e-2};
    double K[36] = {0}, M[36] = {0};
    for (int i = 0; i < 6; i++) {
        K[7 * i] = k[i], M[7 * i] = m[i];
    }
    K[6 * 3 + 4] = K[6 * 4 + 3] = 17.61e3;
    K[6 * 3 + 5] = K[6 * 5 + 3] = -0.351e3;
    K[6 * 4 + 5] = K[6 * 5 + 4] = -0.370e3;
    memset(s, 0, sizeof *s);
    s->dt = dt;
    MUST(NULL, spar_session_create(&s->session));
    MUST(s->session, spar_session_set_integrator(s->session, rho, 1));
    MUST(s->session, spar_beam_create(s->session, "box", elements, nodes, &s->member));
    MUST(s->session, spar_beam_set_axis(s->member, 2, eta, xyz, NULL));
    MUST(s->session, spar_beam_set_sections(s->member, 1, eta, K, M));
    MUST(s->session, spar_beam_set_quadrature(s->member, SPAR_QUADRATURE_GAUSS, nodes));
    MUST(s->session, spar_member_commit(s->member));
    MUST(s->session, spar_member_add_load(s->member, (int64_t)elements * nodes - 1, load));
}

static const double turning = 1.0006; /* rad/s */

/* A blade of the NREL 5-MW rotor, from rest relative to its root that turns at 1.0006 rad/s, under gravity; 49
   stations. points 0: the quadrature the description implies (per section interval) */
static void blade_scene(scene *s, nrel5mw *turbine, int nodes, int points, double dt, double rho) {
    const double gravity[3] = {0, 0, -9.81}, zero[3] = {0, 0, 0};
    double omega[3];
    memset(s, 0, sizeof *s);
    s->dt = dt, s->turbine = turbine;
    nrel5mw_rotor_default(turbine, &s->rotor);
    MUST(NULL, spar_session_create(&s->session));
    MUST(s->session, spar_session_set_gravity(s->session, gravity));
    MUST(s->session, spar_session_set_integrator(s->session, rho, 1));
    if (nrel5mw_create_blade(turbine, &s->rotor, s->session, 0, 1, nodes, &s->member) != SPAR_OK) {
        fprintf(stderr, "beam: %s\n", turbine->message);
        exit(1);
    }
    if (points > 0) {
        MUST(s->session, spar_beam_set_quadrature(s->member, SPAR_QUADRATURE_GAUSS, points));
    }
    MUST(s->session, spar_member_commit(s->member));
    for (int i = 0; i < 3; i++) {
        omega[i] = turning * s->rotor.axis[i];
    }
    (void)zero;
    MUST(s->session, spar_member_set_velocity(s->member, s->rotor.hub, zero, omega));
}

static void step(scene *s) {
    if (s->turbine) {
        double q[7], v[6], a[6];
        nrel5mw_root_motion(s->turbine, &s->rotor, 0, turning * s->dt * (s->steps + 1), turning, 0, q, v, a);
        MUST(s->session, spar_member_drive_root(s->member, q, v, a));
    }
    s->steps++;
    MUST(s->session, spar_step_begin(s->session, s->dt));
    MUST(s->session, spar_step_solve(s->session));
    MUST(s->session, spar_step_accept(s->session));
}

/* ---- peers ---- */

typedef struct figures {
    double us, newton, factors; /* a step */
    double u[3];
    int points;
} figures;

typedef struct deck {
    int blade, nodes, points, steps;
    double dt, atol, rtol;
} deck;

static void measure(const deck *d, nrel5mw *turbine, int repeats, figures *f) {
    double took[MOST_REPEATS];
    for (int k = 0; k < repeats; k++) {
        scene s;
        if (d->blade) {
            blade_scene(&s, turbine, d->nodes, d->points, d->dt, 0);
        } else {
            box_scene(&s, 1, d->nodes, d->dt, 0);
        }
        MUST(s.session, spar_session_set_newton(s.session, d->atol, d->rtol, 20));
        step(&s); /* accelerations at t = 0 are found here */
        const spari_solver *solver = s.member->solver;
        int64_t newton = solver->newton, factors = solver->factors;
        double start = now();
        for (int i = 1; i < d->steps; i++) {
            step(&s);
        }
        took[k] = (now() - start) / (d->steps - 1);
        f->newton = (double)(solver->newton - newton) / (d->steps - 1);
        f->factors = (double)(solver->factors - factors) / (d->steps - 1);
        f->points = s.member->body->first[s.member->elements];
        tip(s.member, f->u);
        spar_session_destroy(&s.session);
    }
    f->us = median(took, repeats);
}

/* What a run differs by from the one with Newton to rounding: a step's error that the tolerance leaves, at the tip. */
static double left_by_tolerance(const deck *d, nrel5mw *turbine, const figures *f) {
    deck tight = *d;
    figures exact;
    double sum = 0;
    tight.atol = tight.rtol = 1e-13;
    measure(&tight, turbine, 1, &exact);
    for (int i = 0; i < 3; i++) {
        sum += (exact.u[i] - f->u[i]) * (exact.u[i] - f->u[i]);
    }
    return sqrt(sum);
}

static void peers(nrel5mw *turbine, int repeats) {
    static const struct {
        const char *title, *peer;
        deck deck;
        double peer_us, goal;
    } row[] = {
        {"box beam, 6 nodes", "Kynema-FMB", {0, 6, 6, 101, 0.01, 1e-5, 1e-3}, 76, 3},
        {"box beam, 8 nodes", "Kynema-FMB", {0, 8, 8, 101, 0.01, 1e-5, 1e-3}, 129, 3},
        {"box beam, 11 nodes", "Kynema-FMB", {0, 11, 11, 101, 0.01, 1e-5, 1e-3}, 284, 3},
        {"NREL 5-MW, 6 nodes", "BeamDyn", {1, 6, 0, 501, 0.002, 1e-5, 1e-3}, 930, 10},
        {"NREL 5-MW, 8 nodes", "BeamDyn", {1, 8, 0, 501, 0.002, 1e-5, 1e-3}, 1440, 10},
        {"NREL 5-MW, 10 nodes", "BeamDyn", {1, 10, 0, 501, 0.002, 1e-5, 1e-3}, 2100, 10},
        {"NREL 5-MW, 12 nodes", "BeamDyn", {1, 12, 0, 501, 0.002, 1e-5, 1e-3}, 2900, 10},
        {"blade, 11 nodes, 50 pts", "Kynema-FMB", {1, 11, 50, 101, 0.01, 1e-5, 1e-3}, 920, 3},
        {"tight: box, 8 nodes", "-", {0, 8, 8, 101, 0.01, 1e-10, 1e-10}, 0, 0},
        {"tight: NREL, 8 nodes", "-", {1, 8, 0, 501, 0.002, 1e-10, 1e-10}, 0, 0},
    };
    enum { ROWS = sizeof row / sizeof *row };
    double yard[ROWS + 1];
    figures f[ROWS];
    yard[0] = yardstick();
    for (int i = 0; i < ROWS; i++) {
        measure(&row[i].deck, turbine, repeats, &f[i]);
        yard[i + 1] = yardstick();
    }
    double machine = median(yard, ROWS + 1), scale = machine / yardstick_of_peers;
    printf("yardstick: 60 x 60 LU by GSL over gslcblas %.1f us (median of %d; %.1f to %.1f); where peers were measured "
           "%.0f "
           "us\n",
           machine, ROWS + 1, yard[0], yard[ROWS], yardstick_of_peers);
    printf("rho_inf 0; Newton tolerance 1e-5 + 1e-3 |x| (tight: 1e-10); medians of %d runs\n\n", repeats);
    printf("%-24s %6s %6s %9s %7s %7s %10s %9s %9s %7s %9s\n", "case", "points", "dt", "us/step", "Newton", "factor",
           "tol. error", "peer us", "here us", "ratio", "goal");
    for (int i = 0; i < ROWS; i++) {
        printf("%-24s %6d %6g %9.1f %7.2f %7.3f %10.1e", row[i].title, f[i].points, row[i].deck.dt, f[i].us,
               f[i].newton, f[i].factors, left_by_tolerance(&row[i].deck, turbine, &f[i]));
        if (row[i].peer_us > 0) {
            double here = row[i].peer_us * scale, ratio = here / f[i].us;
            printf(" %9.0f %9.0f %7.2f %3.0f %s  %s", row[i].peer_us, here, ratio, row[i].goal,
                   ratio >= row[i].goal ? "met" : "short", row[i].peer);
        }
        printf("\n");
    }
}

int main(int argc, char **argv) {
    nrel5mw turbine;
    const char *what = argc > 1 ? argv[1] : "peers";
    int repeats = argc > 2 ? atoi(argv[2]) : 15;
    repeats = repeats < 1 ? 1 : repeats > MOST_REPEATS ? MOST_REPEATS : repeats;
    if (nrel5mw_load(&turbine, SPAR_DATA_DIR "/nrel5mw") != SPAR_OK) {
        fprintf(stderr, "beam: %s\n", turbine.message);
        return 1;
    }
    if (strcmp(what, "peers") == 0) {
        peers(&turbine, repeats);
    } else {
        fprintf(stderr, "usage: beam [peers] [repeats]\n");
        return 2;
    }
    nrel5mw_free(&turbine);
    return 0;
}
