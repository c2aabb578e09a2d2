/* The same scene in other units of length, mass and time, with the defaults of a session: steps of a beam and of a body
   in a fluid, the equilibrium of the beam, and the initial accelerations of both in a fluid with added mass. Results in
   these units must agree, however small the forces are: to 1e-9, since the coupling is iterated as often everywhere. */
#include "scene.h"

#include "member/body.h"
#include "member/structure.h"

typedef struct unit {
    double length, mass, time; /* m, kg, s */
} unit;

enum { NODES = 5, STEPS = 60, RESULTS = 4 };
enum kind { STEPPED, STATIC, INITIAL };

typedef struct scene {
    unit u;
    spar_session *session;
    spar_member *member;
    spar_fluid *fluid;
    int nodes, initial;
} scene;

static void create(scene *w, unit u, int beam) {
    const double L = u.length, F = u.mass * u.length / (u.time * u.time), m = u.mass / u.length;
    double K[36], M[36], x[3] = {L, 0, 0}, p[3] = {L, 0, 0.1 * L};
    static const double q[4] = {1, 0, 0, 0}, none[3] = {0, 0, 0};
    memset(w, 0, sizeof *w);
    w->u = u;
    OK(NULL, spar_session_create(&w->session));
    spar_session *s = w->session;
    if (beam) {
        scene_diagonal(K, 1000 * F, 400 * F, 400 * F, 2 * F * L * L, 2 * F * L * L, 3 * F * L * L);
        scene_diagonal(M, m, m, m, 0.02 * m * L * L, 0.01 * m * L * L, 0.01 * m * L * L);
        w->member = scene_beam(s, "beam", 1, NODES, L, K, M);
    } else {
        const double inertia[3] = {0.1 * u.mass * L * L, 0.1 * u.mass * L * L, 0.1 * u.mass * L * L};
        scene_mass(M, u.mass, none, inertia);
        OK(s, spar_rigid_create(s, "body", x, q, M, &w->member));
    }
    w->nodes = beam ? NODES : 1;
    OK(s, spar_member_commit(w->member));
    OK(s, spar_fluid_create(w->member, "fluid", &w->fluid));
    OK(s, spar_fluid_set_motion_nodes(w->fluid, 1, p));
    OK(s, spar_fluid_set_force_nodes(w->fluid, 1, p));
    OK(s, spar_fluid_map(w->fluid));
}

/* A drag, a spring and a force that grows; for initial accelerations also an added mass of twice the mass. */
static int solve_fluid(spar_session *s, double t, double dt, int iteration, void *context) {
    scene *w = context;
    const double L = w->u.length, T = w->u.time, F = w->u.mass * L / (T * T);
    double x[3], v[3], f[3], a[6 * NODES];
    (void)dt, (void)iteration;
    OK(s, spar_fluid_pull_motion(w->fluid, 1, x, v));
    OK(s, spar_member_get_motion(w->member, NULL, NULL, a));
    for (int k = 0; k < 3; k++) {
        f[k] = -0.3 * w->u.mass / T * v[k] - (w->initial ? 2 * w->u.mass * a[6 * (w->nodes - 1) + k] : 0);
    }
    f[1] += 0.5 * F * (t > 0);
    f[2] += F * (0.2 + 2 * sin(5 * t / T)) - 0.4 * F / L * x[2];
    return spar_fluid_push_forces(w->fluid, f, NULL);
}

/* Position of the fluid's node or acceleration of the last node, and evaluations of the fluid; all without units. */
static void play(unit u, int beam, enum kind kind, double result[RESULTS]) {
    scene w;
    double x[3], v[3], a[6 * NODES];
    int calls = 0, all = 0;
    create(&w, u, beam);
    w.initial = kind == INITIAL;
    if (kind == STATIC) {
        OK(w.session, spar_session_solve_static(w.session, 1, solve_fluid, &w, &all));
    } else if (kind == INITIAL) {
        OK(w.session, spar_session_solve_initial(w.session, 0.02 * u.time, solve_fluid, &w, &all));
    }
    for (int i = 0; i < STEPS && kind == STEPPED; i++) {
        OK(w.session, spar_step(w.session, 0.02 * u.time, solve_fluid, &w, &calls));
        all += calls;
    }
    OK(w.session, spar_fluid_pull_motion(w.fluid, 1, x, v));
    OK(w.session, spar_member_get_motion(w.member, NULL, NULL, a));
    for (int k = 0; k < 3; k++) {
        result[k] = kind == INITIAL ? a[6 * (w.nodes - 1) + k] * u.time * u.time / u.length : x[k] / u.length;
    }
    result[3] = all;
    spar_session_destroy(&w.session);
}

static void agrees(int beam, enum kind kind) {
    static const unit all[] = {{1, 1, 1},    {1e-4, 1e-9, 1e-5}, {1e-6, 1e-15, 1e-6}, {1, 1e-6, 1},
                               {1e-6, 1, 1}, {1, 1, 1e3},        {1e3, 1e9, 1},       {1e-9, 1e-20, 1e-9}};
    double want[RESULTS], got[RESULTS];
    play(all[0], beam, kind, want);
    for (size_t i = 1; i < sizeof all / sizeof *all; i++) {
        play(all[i], beam, kind, got);
        for (int k = 0; k < RESULTS; k++) {
            NEAR(got[k], want[k], 1e-9);
        }
    }
}

static void steps(void **state) {
    (void)state;
    agrees(1, STEPPED);
    agrees(0, STEPPED);
}

static void equilibrium(void **state) {
    (void)state;
    agrees(1, STATIC);
}

static void initial_accelerations(void **state) {
    (void)state;
    agrees(1, INITIAL);
    agrees(0, INITIAL);
}

/* A cantilever of steel with a body welded to its tip, in SI; only its length changes. F L^2 / (3 EI) = 1/300; its own
   shear adds 2e-4 of this. */
static void small_assemblies(void **state) {
    (void)state;
    double first = 0;
    for (double L = 1e4; L > 5e-13; L /= 10) {
        const double d[2] = {L / 60, L / 20}, end[3] = {L, 0, 0};
        double p[SPAR_SECTION_COUNT], K[36], M[36], q[7];
        spar_session *s = scene_session();
        OK(s, spar_section_from_shape(SPAR_SHAPE_RECTANGLE, 2, d, 2e11, 0.3, 7800, SPAR_SECTION_COUNT, p));
        OK(s, spar_section_build(SPAR_SECTION_COUNT, p, K, M));
        const double m = p[SPAR_SECTION_MASS] * L, J[3] = {0.01 * m * L * L, 0.01 * m * L * L, 0.01 * m * L * L},
                     F[6] = {0, 0.01 * p[SPAR_SECTION_EI_Z] / (L * L)};
        spar_member *b = scene_beam(s, "beam", 2, 7, L, K, M);
        OK(s, spar_member_commit(b));
        spar_member *t = scene_body(s, "tip", end, m, J);
        (void)scene_joint(s, "weld", t, 0, b, 13, 0);
        OK(s, spar_member_set_load(t, 0, SPAR_LOAD_DEAD, F));
        OK(s, spar_member_solve_static(b, 1));
        scene_tip(b, q);
        first = first > 0 ? first : q[1] / L;
        NEAR(q[1] / L, 1. / 300, 1e-6);
        NEAR(q[1] / L, first, 1e-9);
        spar_session_destroy(&s);
    }
}

/* The force that rounding errors of Newton are relative to: EA here, in millimetres and kilometres too. */
static void rounding(void **state) {
    (void)state;
    static const unit all[] = {{1, 1, 1}, {1e3, 1e-3, 1}, {1e-3, 1, 1}};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) {
        scene w;
        create(&w, all[i], 1);
        NEAR(w.member->body->stiffest * all[i].time * all[i].time / (all[i].mass * all[i].length), 1000, 1e-9);
        spar_session_destroy(&w.session);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(steps),
        cmocka_unit_test(equilibrium),
        cmocka_unit_test(initial_accelerations),
        cmocka_unit_test(small_assemblies),
        cmocka_unit_test(rounding),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
