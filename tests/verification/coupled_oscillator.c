/* A coupled oscillator with a closed form: mass 1 on a spring of 4 (the rod of integrator.c), in a fluid with added
   mass 0.1 and damping 0.3: f = -0.1 a - 0.3 v. From rest under a step load of 1: x = 1/k (1 - exp(-d t)(cos w t + d/w
   sin w t)), d = c / 2(m + m_a), w^2 = k/(m + m_a) - d^2. The order in dt is the slope between dt and dt/2, at t = 4.
 */
#include "verification.h"

static const double mass = 1, added = 0.1, stiffness = 4, damping = 0.3, load = 1, end = 4;

typedef struct host {
    spar_member *rod;
    spar_fluid *fluid;
} host;

static double exact(double t) {
    double d = damping / (2 * (mass + added)), w = sqrt(stiffness / (mass + added) - d * d);
    return load / stiffness * (1 - exp(-d * t) * (cos(w * t) + d / w * sin(w * t)));
}

static int fluid(spar_session *s, double t, double dt, int iteration, void *context) {
    host *h = context;
    double q[14], v[12], a[12], f[3] = {0};
    (void)t;
    (void)dt;
    (void)iteration;
    OK(s, spar_member_get_motion(h->rod, q, v, a));
    f[0] = -added * a[6] - damping * v[6];
    return spar_fluid_push_forces(h->fluid, f, NULL);
}

/* x(end); *defect: the largest of a step's work defects, relative to the work of one step at full speed */
static double run(double dt, int scheme, int order, int substeps, double *defect) {
    double K[36], M[36], f0[3] = {-added * load / (mass + added), 0, 0}, tip[6] = {load, 0, 0, 0, 0, 0}, q[14];
    double report[SPAR_REPORT_COUNT];
    const double place[3] = {1, 0, 0};
    host h = {0};
    spar_session *s = scene_session();
    OK(s, spar_session_set_integrator(s, 1, substeps));
    OK(s, spar_session_set_predictor(s, order));
    OK(s, spar_session_set_coupling(s, scheme, 0, 1e-13, 60));
    scene_diagonal(K, stiffness, 1, 1, 1, 1, 1);
    scene_diagonal(M, 2 * mass, 2 * mass, 2 * mass, 1, 1, 1);
    h.rod = scene_beam(s, "rod", 1, 2, 1, K, M);
    OK(s, spar_beam_set_quadrature(h.rod, SPAR_QUADRATURE_LOBATTO, 2));
    OK(s, spar_member_set_root(h.rod, SPAR_ROOT_FIXED));
    OK(s, spar_member_commit(h.rod));
    OK(s, spar_member_set_load(h.rod, 1, SPAR_LOAD_DEAD, tip));
    OK(s, spar_fluid_create(h.rod, "medium", &h.fluid));
    OK(s, spar_fluid_set_force_nodes(h.fluid, 1, place));
    OK(s, spar_fluid_map(h.fluid));
    OK(s, spar_fluid_push_forces(h.fluid, f0, NULL)); /* what the fluid answers to the first acceleration */
    *defect = 0;
    for (int64_t n = (int64_t)(end / dt + 0.5); n > 0; n--) {
        OK(s, spar_step(s, dt, fluid, &h, NULL));
        OK(s, spar_session_get_report(s, SPAR_REPORT_COUNT, report));
        *defect = fmax(*defect, fabs(report[SPAR_REPORT_WORK_DEFECT]) / (load * 0.5 * dt));
    }
    OK(s, spar_member_get_motion(h.rod, q, NULL, NULL));
    spar_session_destroy(&s);
    return q[7];
}

static double order_of(int scheme, int predictor, int substeps) {
    double defect, error[2];
    for (int k = 0; k < 2; k++) {
        error[k] = fabs(run(0.02 / (1 << k), scheme, predictor, substeps, &defect) - exact(end));
    }
    return log2(error[0] / error[1]);
}

static void verify_order(const char *scheme, int kind, int predictor, int substeps, double expected, double tolerance) {
    char what[80];
    (void)snprintf(what, sizeof what, "order in dt, %s, predictor %d, substeps %d", scheme, predictor, substeps);
    verify(what, order_of(kind, predictor, substeps), expected, tolerance, "closed form");
}

/* 1 without predictor, 2 with the linear one or a converged iteration; substeps, with loads that are linear between the
   ends of the step, keep it. */
static void test_order(void **state) {
    (void)state;
    verify_order("explicit", SPAR_COUPLING_EXPLICIT, 0, 1, 1, 0.1);
    verify_order("explicit", SPAR_COUPLING_EXPLICIT, 1, 1, 2, 0.1);
    verify_order("fixed point", SPAR_COUPLING_FIXED_POINT, 0, 1, 2, 0.1);
    verify_order("Aitken", SPAR_COUPLING_AITKEN, 0, 1, 2, 0.1);
    verify_order("IQN-ILS", SPAR_COUPLING_IQN_ILS, 0, 1, 2, 0.1);
    for (int substeps = 2; substeps <= 8; substeps *= 2) {
        verify_order("explicit", SPAR_COUPLING_EXPLICIT, 1, substeps, 2, 0.15);
        verify_order("IQN-ILS", SPAR_COUPLING_IQN_ILS, 1, substeps, 2, 0.15);
    }
    verified();
}

/* Work given by the fluid is work taken by the structure, to the tolerance of the iteration (1e-13 of the load). That
   of the explicit scheme differs by the error of the predicted load: of order 1 without predictor, 2 with the linear
   one. */
static void test_work(void **state) {
    (void)state;
    static const char *const name[] = {"", "fixed point", "Aitken", "IQN-ILS"};
    char what[80];
    double defect[2];
    for (int scheme = SPAR_COUPLING_FIXED_POINT; scheme <= SPAR_COUPLING_IQN_ILS; scheme++) {
        run(0.02, scheme, 1, 1, defect);
        (void)snprintf(what, sizeof what, "work defect of a step, %s", name[scheme]);
        verify(what, defect[0], 0, 1e-13, "f dx = f dx");
    }
    for (int predictor = 0; predictor <= 1; predictor++) {
        run(0.02, SPAR_COUPLING_EXPLICIT, predictor, 1, &defect[0]);
        run(0.01, SPAR_COUPLING_EXPLICIT, predictor, 1, &defect[1]);
        (void)snprintf(what, sizeof what, "order of the work defect, explicit, predictor %d", predictor);
        verify(what, log2(defect[0] / defect[1]), predictor + 1, 0.1, "Piperno & Farhat 2001");
    }
    verified();
}

VERIFICATION_MAIN("Coupled oscillator", cmocka_unit_test(test_order), cmocka_unit_test(test_work))
