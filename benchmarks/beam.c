/* What a step of a beam costs beside published codes.

   beam [runs]    microseconds, Newton iterations and factorisations a step: a table

   Peers end Newton at 1e-5 + 1e-3 |x|, with a tangent for each iteration: what that leaves is four orders less than
   what a kept tangent leaves at those numbers. Errors are compared, so Newton goes to 1e-9 here: it leaves no more.

   Figures are medians over runs of the mean over the steps of a run. Peers are compared by the yardstick: a 60 x 60 LU
   factorisation by GSL over its own CBLAS, which took 39 us where the peers were measured. */
#include "beam_scene.h"

enum { MOST_REPEATS = 64 };

static const double yardstick_of_peers = 39; /* us */

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
        const spari_solver *solver = s.member->solution;
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
        {"box beam, 6 nodes", "Kynema-FMB", {0, 6, 6, 101, 0.01, 1e-9, 1e-9}, 76, 15},
        {"box beam, 8 nodes", "Kynema-FMB", {0, 8, 8, 101, 0.01, 1e-9, 1e-9}, 129, 18},
        {"box beam, 11 nodes", "Kynema-FMB", {0, 11, 11, 101, 0.01, 1e-9, 1e-9}, 284, 25},
        {"NREL 5-MW, 6 nodes", "BeamDyn", {1, 6, 0, 501, 0.002, 1e-9, 1e-9}, 930, 60},
        {"NREL 5-MW, 8 nodes", "BeamDyn", {1, 8, 0, 501, 0.002, 1e-9, 1e-9}, 1440, 80},
        {"NREL 5-MW, 10 nodes", "BeamDyn", {1, 10, 0, 501, 0.002, 1e-9, 1e-9}, 2100, 110},
        {"NREL 5-MW, 12 nodes", "BeamDyn", {1, 12, 0, 501, 0.002, 1e-9, 1e-9}, 2900, 150},
        {"blade, 11 nodes, 50 pts", "Kynema-FMB", {1, 11, 50, 101, 0.01, 1e-9, 1e-9}, 920, 20},
        {"loose: box, 8 nodes", "-", {0, 8, 8, 101, 0.01, 1e-5, 1e-3}, 0, 0},
        {"loose: NREL, 8 nodes", "-", {1, 8, 0, 501, 0.002, 1e-5, 1e-3}, 0, 0},
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
    printf("rho_inf 0; Newton tolerance 1e-9, which leaves what 1e-5 + 1e-3 |x| leaves to the peers (loose: those "
           "numbers); medians of %d runs\n\n",
           repeats);
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
    int repeats = argc > 1 ? atoi(argv[1]) : 15;
    if (repeats < 1 || repeats > MOST_REPEATS) {
        fprintf(stderr, "usage: beam [runs, 1 to %d]\n", MOST_REPEATS);
        return 2;
    }
    if (nrel5mw_load(&turbine, SPAR_DATA_DIR "/nrel5mw") != SPAR_OK) {
        fprintf(stderr, "beam: %s\n", turbine.message);
        return 1;
    }
    peers(&turbine, repeats);
    nrel5mw_free(&turbine);
    return 0;
}
