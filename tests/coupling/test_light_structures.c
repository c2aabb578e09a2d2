/* Light structures that bend and turn in an exact fluid without memory: added mass normal to the section, 10 to 1000
   times the mass. The fluid is linear in the accelerations of the section, so nothing but the structure is difficult.
   Every step must end, and the motion must be that of Aitken's relaxation, which has no columns. */
#include "support/links.h"

enum { NODES = 8, LINKS = 8 };

typedef struct flow {
    spar_session *session;
    spar_member *member[LINKS];
    spar_fluid *fluid[LINKS];
    int links;                /* 0: the flap */
    double added, drag, push; /* of each node */
} flow;

/* Added mass and drag along the normal of each section, and a push along z, on the nodes of one fluid. */
static int push(const flow *w, spar_fluid *fluid, int nodes) {
    double v[NODES][3], a[NODES][3], q[NODES][4], f[NODES][3];
    const double up[3] = {0, 0, 1};
    int status = spar_fluid_pull_poses(fluid, SPAR_NODES_MOTION, 1, NULL, q[0], v[0], NULL, a[0], NULL);
    for (int i = 0; i < nodes && status == SPAR_OK; i++) {
        double n[3];
        spari_rotate(q[i], up, n);
        double load = -w->added * spari_dot(a[i], n) - w->drag * spari_dot(v[i], n);
        for (int k = 0; k < 3; k++) {
            f[i][k] = load * n[k] + (k == 2 ? w->push : 0);
        }
    }
    return status == SPAR_OK ? spar_fluid_push_forces(fluid, f[0], NULL) : status;
}

static int water(spar_session *s, double t, double dt, int iteration, void *context) {
    const flow *w = context;
    int status = SPAR_OK;
    (void)s, (void)t, (void)dt, (void)iteration;
    for (int j = 0; j < (w->links > 0 ? w->links : 1) && status == SPAR_OK; j++) {
        status = push(w, w->fluid[j], w->links > 0 ? 3 : NODES);
    }
    return status;
}

/* A clamped beam of 1 m and EI = 20 N m^2 in a fluid of 1 kg/m. */
static void create_flap(flow *w, double ratio) {
    double K[36], M[36], x[3 * NODES] = {0}, mu = 1 / ratio;
    *w = (flow){.session = scene_session(), .added = 1.0 / NODES, .push = 10.0 / NODES};
    scene_diagonal(K, 1e5, 1e4, 1e4, 20, 20, 20);
    scene_diagonal(M, mu, mu, mu, mu * 1e-3, mu * 5e-4, mu * 5e-4);
    w->member[0] = scene_beam(w->session, "flap", 1, 6, 1, K, M);
    OK(w->session, spar_member_set_root(w->member[0], SPAR_ROOT_FIXED));
    OK(w->session, spar_member_commit(w->member[0]));
    for (int i = 0; i < NODES; i++) {
        x[3 * i] = (i + 0.5) / NODES;
    }
    w->fluid[0] = links_wet(w->session, w->member[0], NODES, x);
}

/* A chain of rigid links on hinges, 1 m in all, inclined by 1 rad and buoyant, on the ground; added mass a hundred
   times the mass. */
static void create_chain(flow *w, int links) {
    const double L = 1.0 / links;
    *w = (flow){.session = scene_session(), .links = links, .added = L / 3, .drag = 0.5 / 3, .push = 10 * L / 3};
    links_create(w->session, links, 0.01 * L, 1, w->member, w->fluid);
}

/* Runs and returns evaluations a step; *most of one step; x: the last node. */
static double run(flow *w, int scheme, int steps, int *most, double x[3]) {
    double all[3 * NODES];
    int total = 0, calls, last = w->links > 0 ? w->links - 1 : 0, end = 3 * (w->links > 0 ? 2 : NODES - 1);
    *most = 0;
    OK(w->session, spar_session_set_coupling(w->session, scheme, 1e-9, 1e-6, 200));
    OK(w->session, spar_session_solve_initial(w->session, 0.01, water, w, &calls));
    for (int i = 0; i < steps; i++) {
        OK(w->session, spar_step(w->session, 0.01, water, w, &calls));
        total += calls;
        *most = calls > *most ? calls : *most;
    }
    OK(w->session, spar_fluid_get_positions(w->fluid[last], SPAR_NODES_MOTION, all, NULL, NULL, NULL));
    memcpy(x, all + end, 3 * sizeof *x);
    spar_session_destroy(&w->session);
    return total / (double)steps;
}

/* 600 steps of T/40. The tip moves by a tenth of the length. Evaluations: 3.4, 3.5, 3.7; Aitken 19, 20, 24. The tip is
   where Aitken leaves it, to 1e-4 of the length: rtol times the ratio of the masses. */
static void flap(void **state) {
    static const double ratio[] = {40, 100, 1000};
    (void)state;
    for (size_t k = 0; k < sizeof ratio / sizeof *ratio; k++) {
        flow w;
        double x[2][3];
        int most[2];
        create_flap(&w, ratio[k]);
        double mean = run(&w, SPAR_COUPLING_IQN_ILS, 600, &most[0], x[0]);
        create_flap(&w, ratio[k]);
        double aitken = run(&w, SPAR_COUPLING_AITKEN, 600, &most[1], x[1]);
        print_message("flap, ratio %g: %.2f evaluations a step, %d at most; Aitken %.2f, %d\n", ratio[k], mean, most[0],
                      aitken, most[1]);
        assert_true(mean < 4 && most[0] <= 12);
        NEAR(x[0][2], x[1][2], 1e-4);
    }
}

/* Chains of 1 to 8 links. */
static void chains(void **state) {
    (void)state;
    for (int links = 1; links <= LINKS; links *= 2) {
        flow w;
        double x[2][3];
        int most[2];
        create_chain(&w, links);
        double mean = run(&w, SPAR_COUPLING_IQN_ILS, 300, &most[0], x[0]);
        create_chain(&w, links);
        double aitken = run(&w, SPAR_COUPLING_AITKEN, 300, &most[1], x[1]);
        print_message("%d links: %.2f evaluations a step, %d at most; Aitken %.2f, %d\n", links, mean, most[0], aitken,
                      most[1]);
        assert_true(mean < 6 && most[0] <= 20);
        for (int k = 0; k < 3; k++) {
            NEAR(x[0][k], x[1][k], 1e-4);
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(flap), cmocka_unit_test(chains)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
