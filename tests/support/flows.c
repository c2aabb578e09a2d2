/* Fluids with inner corrections, noise and memory: see flows.h. */
#include "flows.h"

#include <math.h>
#include <spar/spar.h>
#include <spar/spar_analysis.h>
#include <spar/spar_coupling.h>
#include <spar/spar_structure.h>
#include <stdlib.h>
#include <string.h>

enum { RINGS = 8, CELLS = 10, MOST_CELLS = 10 };

static const double pi = 3.14159265358979323846;

#define TRY(call)                                                                                                      \
    do {                                                                                                               \
        int status_ = (call);                                                                                          \
        if (status_ != SPAR_OK) {                                                                                      \
            return status_;                                                                                            \
        }                                                                                                              \
    } while (0)

typedef struct wake {
    double q, rate;
} wake;

typedef struct flow {
    const flow_case *c;
    flow_result *result;
    spar_session *session;
    spar_member *member;
    spar_fluid *fluid;
    int cells;
    double factor; /* of over-relaxation */
    double wall;   /* channel: density over height and the square of a cell; cylinder: width of a ring in log(r/R) */
    unsigned long long random;
    double axes[2][3]; /* in flow, across */

    /* at t^n, and of the last push in the step under way */
    double v0[MOST_CELLS][3], v[MOST_CELLS][3], x[MOST_CELLS][3];
    wake wake0, wake;
    double p[2][RINGS + 2 > CELLS + 2 ? RINGS + 2 : CELLS + 2];
    double viscous[2];
    double force[2];
} flow;

/* Uniform in [-1, 1] times the square root of 3: unit variance. */
static double draw(flow *f) {
    f->random = f->random * 6364136223846793005ULL + 1442695040888963407ULL;
    return sqrt(3.0) * ((double)(f->random >> 11) * 0x1p-52 - 1);
}

static int learn(const flow *f) {
    double eta[20] = {0};
    for (int k = 1; k < f->c->learn; k++) {
        eta[k] = (double)k / (f->c->learn - 1);
    }
    TRY(spar_member_set_added_mass_response(f->member, f->c->response));
    return spar_member_learn_added_mass(f->member, f->c->learn, eta);
}

/* ---- the cylinder ---- */

/* p'' = p over s = log(r/R) with p' = -a at the wall, p = 0 far away: one correction, a sweep out and one back. a:
   acceleration times density and radius. */
static void correct_rings(const flow *f, double a, double *p) {
    double h = f->wall;
    for (int k = 0; k < 2 * RINGS; k++) {
        int i = k < RINGS ? k : 2 * RINGS - 1 - k;
        double balanced = i == 0 ? (p[1] / h + a) / (1 / h + h / 2) : (p[i - 1] + p[i + 1]) / (2 + h * h);
        p[i] += f->factor * (balanced - p[i]);
    }
}

static int corrections(const flow *f) {
    return f->c->inner > 0 ? f->c->inner : 400;
}

static double stream(const flow *f, double t) {
    double over = f->c->ramp * (f->c->dt > 0 ? f->c->dt : 0.05);
    return over > 0 && t < over ? t / over : 1;
}

static void push_cylinder(flow *f, double t, double dt, double force[2]) {
    double v[2] = {0, 0}, a[2] = {0, 0}, U = stream(f, t + dt), radius = 0.5;
    for (int d = 0; d < 2; d++) {
        for (int k = 0; k < 3; k++) {
            v[d] += f->axes[d][k] * f->v[0][k];
            a[d] += f->axes[d][k] * (f->v[0][k] - f->v0[0][k]) / dt;
        }
    }
    double omega = 2 * pi * 0.2 * U, w[2] = {U - v[0], -v[1]}, speed = hypot(w[0], w[1]);
    f->wake.rate = f->wake0.rate + dt * (12 * a[1] - 0.3 * omega * (f->wake0.q * f->wake0.q - 1) * f->wake0.rate -
                                         omega * omega * f->wake0.q);
    f->wake.q = f->wake0.q + dt * f->wake.rate;
    for (int k = 0; k < corrections(f); k++) {
        for (int d = 0; d < 2; d++) {
            double target = 0.5 * f->c->drag * speed * w[d] + (d == 1 ? 0.25 * 0.3 * U * U * f->wake.q : 0);
            correct_rings(f, a[d] * radius, f->p[d]);
            f->viscous[d] += 0.6 * (target - f->viscous[d]);
        }
    }
    for (int d = 0; d < 2; d++) {
        force[d] = f->viscous[d] - pi * radius * f->p[d][0];
    }
}

static int answer_cylinder(flow *f, double t, double dt) {
    double force[2], global[3] = {0, 0, 0};
    push_cylinder(f, t, dt, force);
    for (int d = 0; d < 2; d++) {
        force[d] *= 1 + f->c->noise * draw(f);
        f->force[d] = force[d];
        for (int k = 0; k < 3; k++) {
            global[k] += force[d] * f->axes[d][k];
        }
    }
    return spar_fluid_push_forces(f->fluid, global, NULL);
}

/* A rod along the lift, stiff across, with half its mass at its tip: a spring that moves in one direction. */
static int make_rod(flow *f, double mass, double k) {
    const double eta[2] = {0, 1}, *up = f->axes[1], xyz[6] = {0, 0, 0, up[0], up[1], up[2]};
    double K[36] = {0}, M[36] = {0};
    for (int i = 0; i < 6; i++) {
        K[7 * i] = 1e8 * k;
        M[7 * i] = 2 * mass;
    }
    K[0] = k;
    TRY(spar_beam_create(f->session, "cylinder", 1, 2, &f->member));
    TRY(spar_beam_set_axis(f->member, 2, eta, xyz, NULL));
    TRY(spar_beam_set_sections(f->member, 1, eta, K, M));
    TRY(spar_beam_set_quadrature(f->member, SPAR_QUADRATURE_LOBATTO, 2));
    TRY(spar_member_set_root(f->member, SPAR_ROOT_FIXED));
    TRY(learn(f));
    return spar_member_commit(f->member);
}

/* The same mass on a joint with that spring along the lift. */
static int make_slider(flow *f, double mass, double k) {
    const double half = 0.5 * f->c->angle, q[4] = {cos(half), 0, 0, sin(half)};
    double M[36] = {0}, K[36] = {0};
    spar_joint *joint = NULL;
    for (int i = 0; i < 6; i++) {
        M[7 * i] = mass;
    }
    K[7] = k;
    TRY(spar_rigid_create(f->session, "cylinder", f->axes[1], q, M, &f->member));
    TRY(learn(f));
    TRY(spar_member_commit(f->member));
    TRY(spar_joint_create(f->session, "guide", f->member, 0, NULL, 0, SPAR_FREE_Y, &joint));
    TRY(spar_joint_set_frame(joint, f->axes[1], q));
    return spar_joint_set_spring(joint, K, NULL, NULL);
}

static int build_cylinder(flow *f) {
    const double radius = 0.5, c = cos(f->c->angle), s = sin(f->c->angle);
    const double axes[2][3] = {{c, s, 0}, {-s, c, 0}};
    memcpy(f->axes, axes, sizeof axes);
    f->cells = 1;
    f->wall = log(20.0) / RINGS;
    double jacobi = 2 / (2 + f->wall * f->wall);
    f->factor = 2 / (1 + sqrt(1 - jacobi * jacobi));
    for (int k = 0; k < 400; k++) {
        correct_rings(f, radius, f->p[0]);
    }
    double added = pi * radius * f->p[0][0], mass = added / f->c->added;
    memset(f->p, 0, sizeof f->p);
    double k = (mass + added) * pow(2 * pi / 4, 2);
    TRY(f->c->tied ? make_slider(f, mass, k) : make_rod(f, mass, k));
    TRY(spar_fluid_create(f->member, "stream", &f->fluid));
    TRY(spar_fluid_set_motion_nodes(f->fluid, 1, f->axes[1]));
    TRY(spar_fluid_set_force_nodes(f->fluid, 1, f->axes[1]));
    f->wake0.q = 0.5;
    return spar_fluid_map(f->fluid);
}

/* ---- the channel ---- */

static double inlet(const flow *f, double t) {
    double T = 0.2;
    if (f->c->scene == FLOW_FLAG) {
        return f->c->swing * fmin(t, 1) * sin(2.6 * pi * t);
    }
    return t <= 0 ? 0 : t < T ? pow(sin(pi * t / T), 2) : 0;
}

/* p_{i-1} - 2 p_i + p_{i+1} = source_i, cells between inlet and outlet: one correction */
static void correct_cells(const flow *f, const double *source, double *p) {
    for (int k = 0; k < 2 * CELLS; k++) {
        int i = k < CELLS ? k + 1 : 2 * CELLS - k;
        p[i] += f->factor * (0.5 * (p[i - 1] + p[i + 1] - source[i]) - p[i]);
    }
}

/* Along the wall in cell i, its length; of the channel as it was built. */
static void tangent(const flow *f, int i, double along[2]) {
    int a = i > 0 ? i - 1 : i, b = i < CELLS - 1 ? i + 1 : i;
    for (int k = 0; k < 2; k++) {
        along[k] = f->c->scene == FLOW_FLAG ? (f->x[b][k] - f->x[a][k]) / (b - a) : (k == 0) * (1.0 / CELLS);
    }
}

static int answer_channel(flow *f, double t, double dt) {
    const double friction = 1, drag = f->c->scene == FLOW_FLAG ? f->c->drag : 0;
    double source[CELLS + 2] = {0}, force[CELLS][3], size = 0, along[2];
    for (int i = 0; i < CELLS; i++) {
        tangent(f, i, along);
        double length = hypot(along[0], along[1]), v = 0, a = 0;
        for (int k = 0; k < 2; k++) {
            double normal = (k == 0 ? -along[1] : along[0]) / length;
            v += f->v[i][k] * normal;
            a += (f->v[i][k] - f->v0[i][k]) / dt * normal;
        }
        source[i + 1] = f->wall * (a + friction * v);
    }
    f->p[0][0] = inlet(f, t + dt);
    for (int k = 0; k < corrections(f); k++) {
        correct_cells(f, source, f->p[0]);
    }
    for (int i = 1; i <= CELLS; i++) {
        size += f->p[0][i] * f->p[0][i] / CELLS;
    }
    f->force[0] = 0, f->force[1] = 0;
    for (int i = 0; i < CELLS; i++) {
        double p = f->p[0][i + 1] + f->c->noise * sqrt(size) * draw(f);
        tangent(f, i, along);
        force[i][0] = drag * along[0] - p * along[1];
        force[i][1] = drag * along[1] + p * along[0];
        force[i][2] = 0;
        f->force[1] += force[i][1];
    }
    return spar_fluid_push_forces(f->fluid, &force[0][0], NULL);
}

enum { WALL_PARTS = 10, MOST_NODES = 3 * (WALL_PARTS + 1) };

static void fill_wall(const flow *f, double EI, double mass, double K[36], double M[36]) {
    memset(K, 0, 36 * sizeof *K);
    memset(M, 0, 36 * sizeof *M);
    for (int i = 0; i < 6; i++) {
        K[7 * i] = i < 3 ? (f->c->scene == FLOW_FLAG ? 3e4 : 1e4) * EI : EI;
        M[7 * i] = i < 3 ? mass : 1e-4 * mass;
    }
}

/* A beam of length 1; with a body at its tip that is no body longer by a tenth, ten thousand times as stiff there. */
static int make_wall(flow *f, double mass, double EI) {
    int longer = f->c->tip > 0 && !f->c->tied, parts = f->c->tip > 0 ? WALL_PARTS + longer : 1;
    const double length = longer ? 1.1 : 1, ends[2] = {0, 1}, xyz[6] = {0, 0, 0, length, 0, 0},
                 eta[4] = {0, (1 - 1e-9) / length, (1 + 1e-9) / length, 1};
    double K[4][36], M[4][36];
    for (int k = 0; k < 4; k++) {
        fill_wall(f, (k > 1 ? 1e4 : 1) * EI, (k > 1 ? WALL_PARTS * f->c->tip : 1) * mass, K[k], M[k]);
    }
    TRY(spar_beam_create(f->session, "wall", parts, parts > 1 ? 3 : 8, &f->member));
    TRY(spar_beam_set_axis(f->member, 2, ends, xyz, NULL));
    TRY(spar_beam_set_sections(f->member, longer ? 4 : 1, eta, K[0], M[0]));
    TRY(spar_member_set_root(f->member, f->c->tied ? SPAR_ROOT_FREE : SPAR_ROOT_FIXED));
    TRY(learn(f));
    return spar_member_commit(f->member);
}

/* Welded to the ground, and the body, a rod of a tenth of the length, to its tip. */
static int weld_wall(flow *f, double mass) {
    const double end[3] = {1, 0, 0}, q[4] = {1, 0, 0, 0}, m = f->c->tip * mass, half = 0.05;
    const double turning[3] = {1e-4 * m, 1e-4 * m + m * 4 * half * half / 3, 1e-4 * m + m * 4 * half * half / 3};
    double M[36] = {m};
    spar_joint *joint = NULL;
    spar_member *body = NULL;
    TRY(spar_joint_create(f->session, "foot", f->member, 0, NULL, 0, 0, &joint));
    if (f->c->tip <= 0) {
        return SPAR_OK;
    }
    for (int i = 0; i < 3; i++) {
        M[7 * i] = m;
        M[7 * (3 + i)] = turning[i];
    }
    M[6 * 1 + 5] = M[6 * 5 + 1] = half * m; /* its centre is half its length ahead of the node */
    M[6 * 2 + 4] = M[6 * 4 + 2] = -half * m;
    TRY(spar_rigid_create(f->session, "tip", end, q, M, &body));
    TRY(spar_member_commit(body));
    return spar_joint_create(f->session, "weld", body, 0, f->member, 3 * WALL_PARTS - 1, 0, &joint);
}

static int build_channel(flow *f) {
    const double height = 0.1, dx = 1.0 / CELLS;
    double place[CELLS][3];
    double added = pow(2 / pi, 2) / height, mass = added / f->c->added;
    double EI = (mass + added) * pow(2 * pi / 1, 2) / pow(1.8751, 4);
    f->cells = CELLS;
    f->wall = dx * dx / height;
    f->factor = 2 / (1 + sin(pi / (CELLS + 1)));
    for (int i = 0; i < CELLS; i++) {
        place[i][0] = (i + 0.5) * dx, place[i][1] = place[i][2] = 0;
    }
    TRY(make_wall(f, mass, EI));
    TRY(f->c->tied ? weld_wall(f, mass) : SPAR_OK);
    TRY(spar_fluid_create(f->member, "channel", &f->fluid));
    TRY(spar_fluid_set_motion_nodes(f->fluid, CELLS, &place[0][0]));
    TRY(spar_fluid_set_force_nodes(f->fluid, CELLS, &place[0][0]));
    f->axes[1][1] = 1;
    return spar_fluid_map(f->fluid);
}

/* ---- the run ---- */

static int answer(spar_session *s, double t, double dt, int iteration, void *context) {
    flow *f = context;
    (void)s;
    (void)iteration;
    TRY(spar_fluid_pull_motion(f->fluid, 1, &f->x[0][0], &f->v[0][0]));
    return f->c->scene == FLOW_CYLINDER ? answer_cylinder(f, t, dt) : answer_channel(f, t, dt);
}

static void listen(const spar_session *s, int level, const char *text, void *context) {
    flow *f = context;
    (void)s;
    if (level == SPAR_LOG_WARNING) {
        f->result->complaints++;
        if (f->result->warned == 0 && strstr(text, "unstable")) {
            f->result->warned = f->result->steps + 1;
        }
    }
}

static int set_up(flow *f) {
    const flow_case *c = f->c;
    spar_session *s = f->session;
    TRY(spar_session_set_log(s, listen, f));
    TRY(spar_session_set_coupling(s, c->scheme, 1e-12, c->rtol, c->most > 0 ? c->most : 50));
    if (c->predictor >= 0) {
        TRY(spar_session_set_predictor(s, c->predictor));
    }
    if (c->omega > 0) {
        TRY(spar_session_set_relaxation(s, c->omega));
    }
    TRY(c->newton > 0 ? spar_session_set_newton(s, 1e-15, c->newton, 50) : SPAR_OK);
    for (int k = 0; k < FLOW_OPTIONS && c->option[k][0]; k++) {
        TRY(spar_session_set_option(s, c->option[k][0], c->option[k][1]));
    }
    return SPAR_OK;
}

static int one_step(flow *f, double dt, int *iterations) {
    int done = 0, most = f->c->fixed, n = (int)f->result->steps;
    double t, loads[6 * MOST_NODES];
    TRY(spar_session_get_time(f->session, &t, NULL, NULL));
    TRY(spar_step_begin(f->session, dt));
    TRY(spar_member_get_loads(f->member, loads));
    for (*iterations = 0; most > 0 ? *iterations < most : !done;) {
        TRY(spar_step_solve(f->session));
        TRY(answer(f->session, t, dt, *iterations, f));
        TRY(spar_step_check(f->session, &done));
        ++*iterations;
    }
    if (n == 1 && f->c->scene == FLOW_CYLINDER) {
        const double *load = loads + (f->c->tied ? 0 : 6);
        f->result->predicted[0] = load[0] * f->axes[0][0] + load[1] * f->axes[0][1];
        f->result->predicted[1] = f->force[0];
    }
    return spar_step_accept(f->session);
}

static int record(flow *f, int iterations) {
    flow_result *r = f->result;
    double q[7 * MOST_NODES] = {0}, report[SPAR_REPORT_COUNT];
    int n = r->steps, wall = 7 * (f->c->tip > 0 ? 3 * WALL_PARTS - 1 : 7);
    int last = f->c->scene == FLOW_CHANNEL ? wall : f->c->tied ? 0 : 7;
    TRY(spar_member_get_motion(f->member, q, NULL, NULL));
    TRY(spar_session_get_report(f->session, SPAR_REPORT_COUNT, report));
    r->y[n] = q[last] * f->axes[1][0] + q[last + 1] * f->axes[1][1];
    r->force[n][0] = f->force[0], r->force[n][1] = f->force[1];
    TRY(spar_member_get_learned_added_mass(f->member, &r->used, &r->spread, NULL, 0, NULL, NULL));
    r->used_at = r->used_at == 0 && r->used ? n + 1 : r->used_at;
    r->added[n] = report[SPAR_REPORT_ADDED_MASS];
    r->count[n] = iterations;
    r->iterations += iterations;
    r->most = iterations > r->most ? iterations : r->most;
    r->unconverged = (int)report[SPAR_REPORT_UNCONVERGED];
    r->steps++;
    return SPAR_OK;
}

static int march(flow *f) {
    double dt = f->c->dt > 0 ? f->c->dt : f->c->scene == FLOW_CYLINDER ? 0.05 : 0.02;
    int steps = f->c->steps < FLOW_STEPS ? f->c->steps : FLOW_STEPS, iterations;
    if (f->c->pushed) {
        TRY(answer(f->session, -dt, dt, 0, f));
    }
    for (int i = 0; i < steps; i++) {
        if (f->c->change_at > 0 && i == f->c->change_at) {
            TRY(spar_session_set_predictor(f->session, f->c->then_predictor));
            TRY(spar_session_set_coupling(f->session, f->c->then, 1e-12, f->c->rtol, f->c->most > 0 ? f->c->most : 50));
        }
        int status = one_step(f, dt, &iterations);
        if (status != SPAR_OK) {
            f->result->status = status;
            strncpy(f->result->message, spar_session_message(f->session), sizeof f->result->message - 1);
            break;
        }
        TRY(record(f, iterations));
        f->wake0 = f->wake;
        memcpy(f->v0, f->v, sizeof f->v);
    }
    f->result->iterations /= f->result->steps > 0 ? f->result->steps : 1;
    return SPAR_OK;
}

int flow_run(const flow_case *c, flow_result *result) {
    flow f = {.c = c, .result = result, .random = 88172645463325252ULL + c->seed};
    memset(result, 0, sizeof *result);
    int status = spar_session_create(&f.session);
    status = status == SPAR_OK ? set_up(&f) : status;
    status = status == SPAR_OK ? c->scene == FLOW_CYLINDER ? build_cylinder(&f) : build_channel(&f) : status;
    status = status == SPAR_OK ? march(&f) : status;
    if (status != SPAR_OK) {
        result->status = status;
        strncpy(result->message, spar_session_message(f.session), sizeof result->message - 1);
    }
    spar_session_destroy(&f.session);
    return status;
}

double flow_distance(const flow_result *a, const flow_result *b) {
    int n = a->steps < b->steps ? a->steps : b->steps;
    double d = 0, size = 0;
    for (int i = 0; i < n; i++) {
        d = fmax(d, fabs(a->y[i] - b->y[i]));
        size = fmax(size, fabs(b->y[i]));
    }
    return size > 0 ? d / size : 0;
}
