/* What a step of a beam costs, and what Newton leaves; benchmarks/peers has the published codes beside it.

   beam [runs]    microseconds, Newton iterations and factorisations a step: a table

   Figures are medians over runs of the mean over the steps of a run. */
#include "beam_scene.h"

enum { MOST_REPEATS = 64 };

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
        f->points = s.member->body->first[s.member->mesh.elements];
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

static void table(nrel5mw *turbine, int repeats) {
    static const struct {
        const char *title;
        deck deck;
    } row[] = {
        {"box beam, 6 nodes", {0, 6, 6, 101, 0.01, 1e-9, 1e-9}},
        {"box beam, 8 nodes", {0, 8, 8, 101, 0.01, 1e-9, 1e-9}},
        {"box beam, 11 nodes", {0, 11, 11, 101, 0.01, 1e-9, 1e-9}},
        {"NREL 5-MW, 6 nodes", {1, 6, 0, 501, 0.002, 1e-9, 1e-9}},
        {"NREL 5-MW, 8 nodes", {1, 8, 0, 501, 0.002, 1e-9, 1e-9}},
        {"NREL 5-MW, 10 nodes", {1, 10, 0, 501, 0.002, 1e-9, 1e-9}},
        {"NREL 5-MW, 12 nodes", {1, 12, 0, 501, 0.002, 1e-9, 1e-9}},
        {"blade, 11 nodes, 50 pts", {1, 11, 50, 101, 0.01, 1e-9, 1e-9}},
        {"loose: box, 8 nodes", {0, 8, 8, 101, 0.01, 1e-5, 1e-3}},
        {"loose: NREL, 8 nodes", {1, 8, 0, 501, 0.002, 1e-5, 1e-3}},
    };
    printf("rho_inf 0; Newton tolerance 1e-9 + 1e-9 |x| (loose: 1e-5 + 1e-3 |x|); medians of %d runs\n\n", repeats);
    printf("%-24s %6s %6s %9s %7s %7s %10s\n", "case", "points", "dt", "us/step", "Newton", "factor", "left");
    for (size_t i = 0; i < sizeof row / sizeof *row; i++) {
        figures f;
        measure(&row[i].deck, turbine, repeats, &f);
        printf("%-24s %6d %6g %9.1f %7.2f %7.3f %10.1e\n", row[i].title, f.points, row[i].deck.dt, f.us, f.newton,
               f.factors, left_by_tolerance(&row[i].deck, turbine, &f));
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
    table(&turbine, repeats);
    nrel5mw_free(&turbine);
    return 0;
}
