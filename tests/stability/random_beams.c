/* Random beams: curved, twisted, of one to four elements of 3 to 10 nodes, one to six stations with coupled 6 x 6
   stiffness whose entries differ by up to 1e8, offset centres of mass, random loads. For each:
   - the tangent along a random direction against differences of the forces (order 4: h^4 and rounding / h);
   - the equilibrium under the loads: the root's reaction against the sum of forces, and of moments in the displaced
     places;
   - three time steps from there.
   A beam either passes or its call says why it failed and leaves its state; one that does neither fails the test.

   random_beams [count, default 300] [first, default 0]: the long form is 10000. */
#include "scene.h"

#include <float.h>
#include <stdio.h>

#include "member/body.h"
#include "member/structure.h"

enum { MOST_NODES = 40, AXIS = 24 };

static const double TANGENT = 1e-8, REACTION = 1e-10; /* tolerances, relative */
static unsigned long long seed;

static double uniform(double from, double to) {
    seed = seed * 6364136223846793005ULL + 1442695040888963407ULL;
    return from + (to - from) * (double)(seed >> 11) / 9007199254740992.0;
}

static int whole(int from, int to) {
    return from + (int)(uniform(0, 1) * (to - from + 1) * (1 - 1e-12));
}

static double decades(double from, double to) {
    return pow(10, uniform(from, to));
}

typedef struct beam {
    int elements, nodes, stations;
    double length, softest; /* of bending and torsion, over the length: moment of a turn of 1 rad */
    spar_session *session;
    spar_member *member;
} beam;

/* C = D^1/2 (0.5 I + 0.5 R) D^1/2 with R a random correlation matrix: positive definite, with every coupling */
static void random_stiffness(const double *diagonal, double *C) {
    double g[6][6], R[6][6];
    for (int i = 0; i < 6; i++) {
        double norm = 0;
        for (int j = 0; j < 6; j++) {
            g[i][j] = uniform(-1, 1);
            norm += g[i][j] * g[i][j];
        }
        for (int j = 0; j < 6; j++) {
            g[i][j] /= sqrt(norm);
        }
    }
    for (int i = 0; i < 6; i++) {
        for (int j = 0; j < 6; j++) {
            R[i][j] = 0;
            for (int k = 0; k < 6; k++) {
                R[i][j] += g[i][k] * g[j][k];
            }
        }
    }
    for (int i = 0; i < 6; i++) {
        for (int j = 0; j <= i; j++) {
            C[6 * i + j] = C[6 * j + i] = sqrt(diagonal[i] * diagonal[j]) * (i == j ? 1 : 0.5 * R[i][j]);
        }
    }
}

static void random_sections(beam *b, double *eta, double *K, double *M) {
    double base[6], span = uniform(0, 8), unit = decades(0, 6);
    for (int i = 0; i < 6; i++) {
        base[i] = unit * decades(0, span) * (i < 3 ? 1 : b->length * b->length);
    }
    b->softest = INFINITY;
    for (int k = 0; k < b->stations; k++) {
        double diagonal[6], c[3], J[3], m = unit * decades(-6, -4), r = b->length * uniform(0.02, 0.1);
        for (int i = 0; i < 6; i++) {
            diagonal[i] = base[i] * uniform(0.3, 1);
            b->softest = fmin(b->softest, i < 3 ? diagonal[i] * b->length : diagonal[i] / b->length);
        }
        eta[k] =
            b->stations == 1 ? 0 : (k + (k > 0 && k < b->stations - 1 ? uniform(-0.3, 0.3) : 0)) / (b->stations - 1);
        random_stiffness(diagonal, K + 36 * k);
        for (int i = 0; i < 3; i++) {
            c[i] = i == 0 ? 0 : r * uniform(-0.5, 0.5);
        }
        J[1] = m * r * r * uniform(0.3, 1), J[2] = m * r * r * uniform(0.3, 1);
        J[0] = J[1] + J[2];
        scene_mass(M + 36 * k, m, c, J);
    }
}

/* A curve whose tangent turns by up to 2 rad in both directions, twisted by up to 2 */
static void random_axis(const beam *b, double *eta, double *xyz, double *twist) {
    double ay = uniform(-2, 2), az = uniform(-1.4, 1.4), by = uniform(-1, 1), bz = uniform(-1, 1),
           wind = uniform(-2, 2);
    double x[3] = {uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)};
    enum { FINE = 40 };
    int straight = uniform(0, 1) < 0.15;
    for (int i = 0; i < AXIS; i++) {
        eta[i] = (double)i / (AXIS - 1);
        memcpy(xyz + 3 * i, x, sizeof x);
        twist[i] = wind * eta[i];
        for (int k = 0; k < FINE; k++) {
            double s = (i + (k + 0.5) / FINE) / (AXIS - 1), h = b->length / FINE / (AXIS - 1);
            double turn = straight ? ay : ay * s + by * s * s, rise = straight ? az : az * s + bz * s * (1 - s);
            x[0] += h * cos(turn) * cos(rise), x[1] += h * sin(turn) * cos(rise), x[2] += h * sin(rise);
        }
    }
}

static int create(beam *b, int k) {
    char name[32];
    double eta[AXIS], xyz[3 * AXIS], twist[AXIS], station[6], K[36 * 6], M[36 * 6], g[3];
    snprintf(name, sizeof name, "random %d", k);
    b->elements = whole(1, 4), b->nodes = whole(3, 10), b->stations = whole(1, 6);
    b->length = decades(-1, 2);
    random_axis(b, eta, xyz, twist);
    random_sections(b, station, K, M);
    OK(NULL, spar_session_create(&b->session));
    for (int i = 0; i < 3; i++) {
        g[i] = uniform(-10, 10);
    }
    OK(b->session, spar_session_set_gravity(b->session, g));
    OK(b->session, spar_session_set_integrator(b->session, uniform(0, 1), 1));
    OK(b->session, spar_beam_create(b->session, name, b->elements, b->nodes, &b->member));
    OK(b->session, spar_beam_set_axis(b->member, AXIS, eta, xyz, twist));
    OK(b->session, spar_beam_set_sections(b->member, b->stations, station, K, M));
    if (uniform(0, 1) < 0.3) {
        double mu[6];
        for (int i = 0; i < 6; i++) {
            mu[i] = decades(-5, -2);
        }
        OK(b->session, spar_beam_set_damping(b->member, mu));
    }
    return spar_member_commit(b->member);
}

/* ---- tangent ---- */

/* State moved by h along X, rates with it. */
static void move(int n, const double *q, const double *v, const double *a, const double *X, double h, double cm,
                 double cv, double *q1, double *v1, double *a1) {
    for (int i = 0; i < n; i++) {
        double turn[3], p[4];
        for (int k = 0; k < 3; k++) {
            q1[7 * i + k] = q[7 * i + k] + h * X[6 * i + k];
            turn[k] = h * X[6 * i + 3 + k];
        }
        spari_quat_exp(turn, p);
        spari_quat_mul(p, q + 7 * i + 3, q1 + 7 * i + 3);
    }
    for (int i = 0; i < 6 * n; i++) {
        v1[i] = v[i] + cv * h * X[i], a1[i] = a[i] + cm * h * X[i];
    }
}

/* Largest disagreement of S X with the differences, relative to the sizes that are summed in its row and to what
   rounding does to the differences. */
static double tangent_error(const beam *b) {
    const spari_body *body = b->member->body;
    int n = body->unique, N = 6 * n, P = b->nodes, m = 6 * P;
    double q[7 * MOST_NODES], v[6 * MOST_NODES], a[6 * MOST_NODES], X[6 * MOST_NODES],
        SX[6 * MOST_NODES] = {0}, size[6 * MOST_NODES] = {0}, r[4][6 * MOST_NODES], q1[7 * MOST_NODES],
               v1[6 * MOST_NODES], a1[6 * MOST_NODES];
    double rate = decades(-1, 1), cm = decades(0, 3), cv = decades(0, 1.5), rounding = 0, worst = 0, h = 1e-3;
    double *S = malloc((size_t)(m * m) * sizeof *S);
    for (int i = 0; i < n; i++) {
        double s = (double)i / n, turn[3];
        for (int k = 0; k < 3; k++) { /* smooth, with some noise: neighbours do not turn against each other */
            q[7 * i + k] = b->length * (0.2 * sin(2 * s + k) + 0.01 * uniform(-1, 1));
            turn[k] = 1.2 * sin(1.7 * s + 2 * k) + 0.05 * uniform(-1, 1);
            X[6 * i + k] = b->length * uniform(-1, 1);
            X[6 * i + 3 + k] = uniform(-1, 1);
        }
        spari_quat_exp(turn, q + 7 * i + 3);
        for (int k = 0; k < 6; k++) {
            v[6 * i + k] = rate * (k < 3 ? b->length : 1) * uniform(-1, 1);
            a[6 * i + k] = rate * rate * (k < 3 ? b->length : 1) * uniform(-1, 1);
        }
    }
    for (int e = 0; e < b->elements; e++) {
        spari_body_tangent(body, e, q, v, a, 1, cm, cv, NULL, S);
        int at = 6 * e * (P - 1);
        for (int i = 0; i < m; i++) {
            for (int j = 0; j < m; j++) {
                SX[at + i] += S[m * i + j] * X[at + j];
                size[at + i] += fabs(S[m * i + j] * X[at + j]);
            }
        }
    }
    free(S);
    const double step[4] = {-2, -1, 1, 2};
    for (int k = 0; k < 4; k++) {
        move(n, q, v, a, X, step[k] * h, cm, cv, q1, v1, a1);
        rounding = fmax(rounding, spari_body_residual(body, q1, v1, a1, 1, r[k], NULL));
    }
    double noise = 16 * DBL_EPSILON * rounding / h / TANGENT;
    for (int i = 0; i < N; i++) {
        double slope = (r[0][i] - 8 * r[1][i] + 8 * r[2][i] - r[3][i]) / (12 * h);
        double force = i % 6 < 3 ? 1 : b->length;
        worst = fmax(worst, fabs(slope - SX[i]) / (size[i] + noise * force));
    }
    return worst;
}

/* ---- equilibrium ---- */

/* Loads of a size that turns the softest section by up to some radians, put on random nodes */
static void load(const beam *b, int64_t n) {
    double size = b->softest * decades(-2, 0.5);
    for (int k = 0; k < 3; k++) {
        double f[6];
        for (int i = 0; i < 6; i++) {
            f[i] = size * uniform(-1, 1) * (i < 3 ? 1 / b->length : 1) * 0.5;
        }
        OK(b->session,
           spar_member_set_load(b->member, k == 0 ? n - 1 : (int64_t)whole(0, (int)n - 1), SPAR_LOAD_DEAD, f));
    }
}

/* Reaction against loads and weight, relative: forces, and moments about the root of the displaced beam. The weight of
   the discrete beam is its residual at rest with gravity less the one without. */
static double reaction_error(const beam *b, int64_t n) {
    const spari_body *body = b->member->body;
    double *q = malloc((size_t)(n * 16) * sizeof *q), *x = q + 7 * n, *loads = x + 3 * n;
    double sum[6] = {0}, reaction[6], size[2] = {0, 0}, error[2] = {0, 0};
    OK(b->session, spar_member_get_motion(b->member, q, NULL, NULL));
    OK(b->session, spar_member_get_reference(b->member, x, NULL));
    OK(b->session, spar_member_get_loads(b->member, loads));
    OK(b->session, spar_member_get_reaction(b->member, reaction));
    int unique = body->unique;
    double state[7 * MOST_NODES], weight[6 * MOST_NODES], internal[6 * MOST_NODES], place[3 * MOST_NODES];
    spari_member_to_unique(b->member, 7, q, state);
    spari_member_to_unique(b->member, 3, x, place);
    double scale = spari_body_residual(body, state, NULL, NULL, 1, weight, NULL);
    spari_body_residual(body, state, NULL, NULL, 0, internal, NULL);
    for (int64_t i = 0; i < n + unique; i++) {
        double f[6], at[3], c[3];
        for (int k = 0; k < 6; k++) {
            f[k] = i < n ? loads[6 * i + k] : internal[6 * (i - n) + k] - weight[6 * (i - n) + k];
        }
        for (int k = 0; k < 3; k++) {
            at[k] = i < n ? x[3 * i + k] + q[7 * i + k] - x[k] - q[k]
                          : place[3 * (i - n) + k] + state[7 * (i - n) + k] - x[k] - q[k];
        }
        spari_cross(at, f, c);
        for (int k = 0; k < 3; k++) {
            sum[k] += f[k], sum[3 + k] += c[k] + f[3 + k];
        }
        size[0] += spari_norm(f);
        size[1] += spari_norm(f) * b->length + spari_norm(f + 3);
    }
    for (int k = 0; k < 3; k++) {
        error[0] = fmax(error[0], fabs(sum[k] + reaction[k]));
        error[1] = fmax(error[1], fabs(sum[3 + k] + reaction[3 + k]));
    }
    free(q);
    /* a change of the places in their last bits changes a force by DBL_EPSILON times the largest stiffness */
    double noise = (scale + 64 * body->stiffest) * DBL_EPSILON / REACTION;
    return fmax(error[0] / (size[0] + noise), error[1] / (size[1] + noise * b->length));
}

/* ---- all ---- */

typedef struct count {
    int tried, tangents, statics, refused_static, dynamics, refused_dynamic, refused_commit;
    double worst_tangent, worst_reaction;
    int at_tangent, at_reaction;
} count;

static int finite_motion(const spar_member *m, int64_t n) {
    double q[7 * MOST_NODES], v[6 * MOST_NODES];
    if (spar_member_get_motion(m, q, v, NULL) != SPAR_OK) {
        return 0;
    }
    double sum = 0;
    for (int64_t i = 0; i < 7 * n; i++) {
        sum += fabs(q[i]) + (i < 6 * n ? fabs(v[i]) : 0);
    }
    return isfinite(sum);
}

/* A call that fails has to say why, name the member, and leave the motion. */
static void must_say_why(const beam *b, int k, const char *call, int status, const double *before, int64_t n) {
    double after[7 * MOST_NODES];
    const char *why = spar_session_message(b->session);
    OK(b->session, spar_member_get_motion(b->member, after, NULL, NULL));
    if (status != SPAR_ERR_NUMERIC || !strstr(why, "random") ||
        memcmp(before, after, (size_t)(7 * n) * sizeof *before) != 0) {
        fail_msg("beam %d: %s failed without a word or touched the state: %s: %s", k, call, spar_status_text(status),
                 why);
    }
}

static void try_beam(int k, count *c) {
    beam b;
    int64_t n;
    double before[7 * MOST_NODES];
    seed = 2862933555777941757ULL * (unsigned long long)(k + 1) + 3037000493ULL;
    for (int i = 0; i < 10; i++) {
        uniform(0, 1);
    }
    c->tried++;
    int status = create(&b, k);
    if (status != SPAR_OK) {
        if (strlen(spar_session_message(b.session)) == 0) {
            fail_msg("beam %d: the commit failed without a word", k);
        }
        printf("beam %d: commit: %s\n", k, spar_session_message(b.session));
        c->refused_commit++;
        spar_session_destroy(&b.session);
        return;
    }
    OK(b.session, spar_member_get_count(b.member, &n));
    double error = tangent_error(&b);
    if (!(error < TANGENT)) {
        fail_msg("beam %d: tangent off by %g", k, error);
    }
    c->tangents++;
    if (error > c->worst_tangent) {
        c->worst_tangent = error, c->at_tangent = k;
    }
    load(&b, n);
    OK(b.session, spar_member_get_motion(b.member, before, NULL, NULL));
    status = spar_member_solve_static(b.member, 1);
    if (status != SPAR_OK) {
        must_say_why(&b, k, "solve_static", status, before, n);
        printf("%s\n", spar_session_message(b.session));
        c->refused_static++;
    } else {
        c->statics++;
        error = reaction_error(&b, n);
        if (!(error < REACTION)) {
            fail_msg("beam %d: reaction off by %g", k, error);
        }
        if (error > c->worst_reaction) {
            c->worst_reaction = error, c->at_reaction = k;
        }
    }
    double dt = decades(-4, -1);
    status = SPAR_OK;
    for (int i = 0; i < 3 && status == SPAR_OK; i++) {
        OK(b.session, spar_member_get_motion(b.member, before, NULL, NULL));
        OK(b.session, spar_step_begin(b.session, dt));
        status = spar_step_solve(b.session);
        if (status == SPAR_OK) {
            OK(b.session, spar_step_accept(b.session));
        } else {
            const char *why = spar_session_message(b.session);
            if (status != SPAR_ERR_NUMERIC || !strstr(why, "random")) {
                fail_msg("beam %d: a step failed without a word: %s", k, why);
            }
            OK(b.session, spar_step_reject(b.session));
            must_say_why(&b, k, "step", status, before, n);
            printf("%s\n", why);
        }
    }
    if (!finite_motion(b.member, n)) {
        fail_msg("beam %d: motion is not finite", k);
    }
    *(status == SPAR_OK ? &c->dynamics : &c->refused_dynamic) += 1;
    spar_session_destroy(&b.session);
}

static int beams = 300, first_beam = 0;

static void test_random_beams(void **state) {
    (void)state;
    count c;
    memset(&c, 0, sizeof c);
    for (int k = first_beam; k < first_beam + beams; k++) {
        try_beam(k, &c);
    }
    printf("%d beams; refused at commit %d; tangents %d, worst %.1e (beam %d); statics %d, refused with a reason %d; "
           "worst "
           "reaction %.1e (beam %d); three steps %d, refused with a reason %d\n",
           c.tried, c.refused_commit, c.tangents, c.worst_tangent, c.at_tangent, c.statics, c.refused_static,
           c.worst_reaction, c.at_reaction, c.dynamics, c.refused_dynamic);
    assert_int_equal(c.refused_commit, 0);
    /* refusals have to stay the exception */
    assert_true(c.refused_static <= beams / 50 + 1);
    assert_true(c.refused_dynamic <= beams / 50 + 1);
}

int main(int argc, char **argv) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_random_beams)};
    beams = argc > 1 ? atoi(argv[1]) : beams;
    first_beam = argc > 2 ? atoi(argv[2]) : first_beam;
    return cmocka_run_group_tests(tests, NULL, NULL);
}
