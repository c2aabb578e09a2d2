/* What flies freely keeps its momentum, its angular momentum about its centre of mass and its energy: random beams,
   rigid bodies and mechanisms (random_scenes.h), some of which a pair of moments bends for a while, which changes
   neither momentum. The momenta are found from the motion of the nodes alone, by quadrature of the beam's field (as in
   tests/assembly/test_angular_momentum.c). Each scene is run with the defaults, with the strictest tolerances, and with
   these in half the steps. Two things hold, relative to the momenta of the parts:
   - With the defaults a momentum drifts by no more than twice as far as with the strictest tolerances and a tenth of
   the scheme's own error, 4/3 of what half the steps change.
   - Linear momentum has no error of the scheme: with the strictest tolerances it drifts by rounding alone.

   invariants [seed, default 1 [scenes, default 12 [steps, default 600]]]: the long form is 100 scenes of 100000.
   invariants seed 0 [steps] runs one scene, by the seed that the table names. */
#include "random_scenes.h"

#include <gsl/gsl_integration.h>

static const double part = 0.1, floor_of = 1e-10;
static scene_plan plan = {1, 12, 600};

enum { LOOKS = 50 };

/* ---- momenta from the motion of the nodes ---- */

/* mass, first moment, momentum, angular momentum about the origin */
typedef struct momenta {
    double mass, moment[3], linear[3], angular[3];
} momenta;

static void add_section(const double x[3], const double v[3], const double q[4], const double omega[3], double mass,
                        const double J[3], momenta *p) {
    double body[3], h[3];
    spari_rotate_back(q, omega, body);
    for (int k = 0; k < 3; k++) {
        body[k] *= J[k];
    }
    spari_rotate(q, body, body);
    spari_cross(x, v, h);
    p->mass += mass;
    for (int k = 0; k < 3; k++) {
        p->moment[k] += mass * x[k];
        p->linear[k] += mass * v[k];
        p->angular[k] += mass * h[k] + body[k];
    }
}

/* The beam's field at a point of an element of P nodes: sums by Lagrange's basis; the quaternion is a sum of those of
   the nodes, with qd = w q / 2. */
static void add_point(const motion_scene *c, const double *X, const double *q, const double *v, double at,
                      double weight, momenta *p) {
    const int P = c->nodes;
    const double I = c->mass * c->length * c->length / c->slenderness * weight,
                 J[3] = {I * (1 + c->strip), I, I * c->strip};
    double x[3] = {0}, rate[3] = {0}, Q[4] = {0}, Qd[4] = {0}, back[4], spin[4], size = 0;
    for (int l = 0; l < P; l++) {
        const double w[4] = {0, v[6 * l + 3], v[6 * l + 4], v[6 * l + 5]};
        double qd[4], phi = 1;
        for (int k = 0; k < P; k++) {
            phi *= k == l ? 1 : (at - X[3 * k]) / (X[3 * l] - X[3 * k]);
        }
        spari_quat_mul(w, q + 7 * l + 3, qd);
        for (int k = 0; k < 4; k++) {
            Q[k] += phi * q[7 * l + 3 + k], Qd[k] += 0.5 * phi * qd[k];
        }
        for (int k = 0; k < 3; k++) {
            x[k] += phi * (X[3 * l + k] + q[7 * l + k]), rate[k] += phi * v[6 * l + k];
        }
    }
    for (int k = 0; k < 4; k++) {
        size += Q[k] * Q[k];
    }
    spari_quat_conj(Q, back);
    spari_quat_mul(Qd, back, spin);
    for (int k = 0; k < 4; k++) {
        Q[k] /= sqrt(size);
    }
    const double omega[3] = {2 * spin[1] / size, 2 * spin[2] / size, 2 * spin[3] / size};
    add_section(x, rate, Q, omega, c->mass * weight, J, p);
}

static void add_beam(const motion_world *w, int i, momenta *p) {
    const motion_scene *c = w->c;
    const int P = c->nodes;
    double X[3 * SCENE_NODES], q[7 * SCENE_NODES], v[6 * SCENE_NODES];
    OK(w->s, spar_member_get_reference(w->m[i], X, NULL));
    OK(w->s, spar_member_get_motion(w->m[i], q, v, NULL));
    gsl_integration_glfixed_table *rule = gsl_integration_glfixed_table_alloc((size_t)P + 3);
    for (int e = 0; e < c->elements; e++) {
        const ptrdiff_t first = (ptrdiff_t)P * e;
        for (int k = 0; k < P + 3; k++) {
            double at, weight;
            gsl_integration_glfixed_point(X[3 * first], X[3 * (first + P - 1)], (size_t)k, &at, &weight, rule);
            add_point(c, X + 3 * first, q + 7 * first, v + 6 * first, at, weight, p);
        }
    }
    gsl_integration_glfixed_table_free(rule);
}

/* A rod: its node is at one end, its centre of mass half way. */
static void add_rod(const motion_world *w, int i, momenta *p) {
    const motion_scene *c = w->c;
    const double m = c->mass * c->length,
                 J[3] = {m * c->length * c->length / 240, m * c->length * c->length / 12,
                         m * c->length * c->length / 12},
                 arm[3] = {c->length / 2, 0, 0};
    double X[3], q[7], v[6], a[3], x[3], u[3];
    OK(w->s, spar_member_get_reference(w->m[i], X, NULL));
    OK(w->s, spar_member_get_motion(w->m[i], q, v, NULL));
    spari_rotate(q + 3, arm, a);
    spari_cross(v + 3, a, u);
    for (int k = 0; k < 3; k++) {
        x[k] = X[k] + q[k] + a[k], u[k] += v[k];
    }
    add_section(x, u, q + 3, v + 3, m, J, p);
}

/* Linear momentum, and angular momentum about the centre of mass. */
static void find(const motion_world *w, double now[6]) {
    momenta p = {0};
    double h[3];
    for (int i = 0; i < w->c->parts; i++) {
        if (w->c->rods) {
            add_rod(w, i, &p);
        } else {
            add_beam(w, i, &p);
        }
    }
    spari_cross(p.moment, p.linear, h);
    for (int k = 0; k < 3; k++) {
        now[k] = p.linear[k], now[3 + k] = p.angular[k] - h[k] / p.mass;
    }
}

/* ---- one scene ---- */

typedef struct flight {
    int status, slow;
    int64_t iterations;
    double at[LOOKS][6], drift[2], size[2]; /* momenta at the looks; largest drift and size of both kinds */
    char message[160];
} flight;

static double largest(const double *a, const double *b) {
    double square = 0;
    for (int k = 0; k < 3; k++) {
        square += (a[k] - b[k]) * (a[k] - b[k]);
    }
    return sqrt(square);
}

/* The moments end after a tenth of the run. */
static void run(const motion_scene *c, int strictest, int halves, flight *f) {
    motion_scene let_go = *c;
    motion_world w = scene_build(c, strictest);
    double first[6];
    *f = (flight){.status = w.status};
    if (w.status == SPAR_OK) {
        find(&w, first);
    }
    sequence_seed = c->seed;
    let_go.amplitude = 0;
    for (int k = 0; k < plan.steps && f->status == SPAR_OK; k++) {
        const double dt = sequence_step(c->pattern, k, c->dt, c->factor) / halves;
        w.c = k < plan.steps / 10 ? c : &let_go;
        for (int i = 0; i < halves && f->status == SPAR_OK; i++) {
            f->status = scene_step(&w, dt);
        }
        if (f->status == SPAR_OK && (k + 1) % (plan.steps / LOOKS) == 0 && k / (plan.steps / LOOKS) < LOOKS) {
            find(&w, f->at[k / (plan.steps / LOOKS)]);
        }
        f->slow = scene_is_slow(&w, plan.steps * halves);
        if (f->slow) {
            break;
        }
    }
    f->iterations = scene_iterations(&w);
    for (int k = 0; k < LOOKS && f->status == SPAR_OK; k++) {
        for (int i = 0; i < 2; i++) {
            f->drift[i] = fmax(f->drift[i], largest(f->at[k] + 3 * i, first + 3 * i));
        }
    }
    snprintf(f->message, sizeof f->message, "%.150s", spar_session_message(w.s));
    spar_session_destroy(&w.s);
}

/* What the momenta are measured by: the parts' own, at the speed that they have or that the load gives them. */
static void sizes(const motion_scene *c, double size[2]) {
    const double m = c->parts * c->mass * c->length, r = c->parts * c->length / 3.46,
                 bend = c->loading == LET_GO ? 0 : c->amplitude * c->length / c->period,
                 v = sqrt(spari_dot(c->velocity, c->velocity)) + bend,
                 omega = sqrt(spari_dot(c->spin, c->spin)) + bend / c->length;
    size[0] = m * (v + omega * c->parts * c->length), size[1] = m * r * r * omega + m * r * bend;
}

static int check(const motion_scene *c, int k) {
    static flight usual, strict, half;
    double size[2], error[2] = {0, 0};
    int failed = 0;
    sizes(c, size);
    run(c, 0, 1, &usual), run(c, 1, 1, &strict), run(c, 1, 2, &half);
    if (usual.slow || strict.slow || half.slow) {
        print_message("%3d: stopped for its iterations%s\n", k, usual.slow ? "" : " with the strictest tolerances");
        failed = usual.slow;
    } else if (strict.status != SPAR_OK || half.status != SPAR_OK || usual.status != SPAR_OK) {
        print_message("%3d: refused: %s%s\n", k, usual.message, strict.status == SPAR_OK ? " with the defaults" : "");
        failed = strict.status == SPAR_OK && half.status == SPAR_OK;
    } else {
        for (int l = 0; l < LOOKS; l++) {
            for (int i = 0; i < 2; i++) {
                error[i] = fmax(error[i], 4.0 / 3 * largest(strict.at[l] + 3 * i, half.at[l] + 3 * i));
            }
        }
        print_message(
            "%3d: momentum %.1e (strictest %.1e), angular %.1e (strictest %.1e, scheme %.1e); iterations a step "
            "%.2f, strictest %.2f\n",
            k, usual.drift[0] / size[0], strict.drift[0] / size[0], usual.drift[1] / size[1], strict.drift[1] / size[1],
            error[1] / size[1], (double)usual.iterations / plan.steps, (double)strict.iterations / plan.steps);
        const double own = fmax(error[0] / size[0], error[1] / size[1]),
                     linear = 2 * strict.drift[0] + (part * own + floor_of) * size[0],
                     angular = 2 * strict.drift[1] + part * error[1] + floor_of * size[1];
        const int beam = c->parts == 1 && c->fidelity == SPAR_FIDELITY_EXACT;
        failed = !(usual.drift[0] <= linear) || !(usual.drift[1] <= angular) ||
                 (beam && !(strict.drift[0] <= 1e-9 * size[0]));
    }
    if (failed) {
        print_message("  FAILED\n");
        scene_print(c);
    }
    return failed;
}

static motion_scene draw(uint64_t at) {
    scene_seed_by(at);
    const int parts = scene_whole(0, 1), uneven = scene_whole(0, 3) == 0;
    motion_scene c = scene_draw(at, parts ? FLIGHT : FREE, scene_whole(0, 1) ? LET_GO : AT_ONCE, uneven);
    /* linear and modal members are linear about the reference: they do not turn with their momenta */
    c.fidelity = c.fidelity == SPAR_FIDELITY_RIGID ? c.fidelity : SPAR_FIDELITY_EXACT;
    c.elements = c.nodes > 8 ? 1 : c.elements, c.nodes = 3 + c.nodes % 6;
    return c;
}

static void test_invariants(void **state) {
    (void)state;
    scene_check_all(&plan, 0, draw, check);
}

int main(int argc, char **argv) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_invariants)};
    scene_take_arguments(argc, argv, &plan);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
