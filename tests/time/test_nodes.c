/* Nodes side by side: turns into the axes of the kept tangent, starting values, corrections, places, and what is seen
   from a driven root, at every width that the processor has.

   Oracles: the formulas node by node with the operations of math/rotation.h, whose exponential map and tangent operator
   are other code; 1e-14 of the largest number that goes in, for 1e2 operations of 1e-16. Widths among each other: the
   same bits. Turns of 0, 1e-9, 1e-3, 0.999 and 1.001 (series end at 1), pi, 5 pi / 2 (beyond a full turn) and of nodes
   that turn differently side by side; 1 to 19 nodes, so whole vectors and what remains of them. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#include "math/rotation.h"
#include "time/node_kinematics.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST = 19, WIDTHS = 4 };
static const int widths[WIDTHS] = {2, 4, 8, 0};
static const double angles[] = {0, 1e-9, 1e-3, 0.999, 1.001, 3.14159265358979312, 7.85398163397448310, -1};
enum { ANGLES = sizeof angles / sizeof *angles };

static double uniform(void) {
    return 2.0 * rand() / RAND_MAX - 1.0;
}

static void random_numbers(int n, double size, double *x) {
    for (int i = 0; i < n; i++) {
        x[i] = size * uniform();
    }
}

/* A rotation vector of this angle; less than 0: of any up to 3 pi. */
static void random_turn(double angle, double psi[3]) {
    random_numbers(3, 1, psi);
    double size = spari_norm(psi), wanted = angle < 0 ? 9.4 * fabs(uniform()) : angle;
    for (int k = 0; k < 3; k++) {
        psi[k] *= wanted / size;
    }
}

static void random_quaternions(int n, int stride, double *q) {
    for (int i = 0; i < n; i++) {
        random_numbers(4, 1, q + (ptrdiff_t)stride * i);
        spari_quat_normalise(q + (ptrdiff_t)stride * i);
    }
}

static void random_state(int n, spari_state *s, double *room) {
    s->q = room, s->v = s->q + 7 * MOST, s->a = s->v + 6 * MOST, s->b = s->a + 6 * MOST;
    random_numbers(25 * MOST, 1, room);
    random_quaternions(n, 7, s->q + 3);
}

static void assert_near(int n, const double *x, const double *exact, double tolerance, const char *what) {
    double most = 0;
    for (int i = 0; i < n; i++) {
        most = fmax(most, fabs(exact[i]));
    }
    for (int i = 0; i < n; i++) {
        if (!(fabs(x[i] - exact[i]) <= tolerance * most)) {
            print_error("%s: number %d of %d is %.17g, expected %.17g\n", what, i, n, x[i], exact[i]);
        }
        assert_true(fabs(x[i] - exact[i]) <= tolerance * most);
    }
}

/* What a width gave and the first one before it. */
static void assert_alike(int n, const double *x, double *first, int width, const char *what) {
    if (width == widths[0]) {
        memcpy(first, x, (size_t)n * sizeof *x);
    } else if (memcmp(first, x, (size_t)n * sizeof *x) != 0) {
        print_error("%s: width %d has other bits\n", what, width);
        fail();
    }
}

/* ---- to the kept tangent and back ---- */

static void test_turns(void **unused) {
    (void)unused;
    for (int n = 1; n <= MOST; n++) {
        double q[7 * MOST], kept[4 * MOST], r[6 * MOST], rotation[4 * MOST + 1], dx[6 * MOST + 1], most = 0;
        double exact_turn[4 * MOST], exact[6 * MOST], first[2][6 * MOST];
        random_numbers(7 * n, 1, q);
        random_quaternions(n, 7, q + 3);
        random_quaternions(n, 4, kept);
        random_numbers(6 * n, 3, r);
        for (int i = 0; i < n; i++) {
            double back[4];
            spari_quat_conj(kept + 4 * i, back);
            spari_quat_mul(q + 7 * i + 3, back, exact_turn + 4 * i);
            spari_rotate_back(exact_turn + 4 * i, r + 6 * i, exact + 6 * i);
            spari_rotate_back(exact_turn + 4 * i, r + 6 * i + 3, exact + 6 * i + 3);
        }
        for (int i = 0; i < 6 * n; i++) {
            most = fmax(most, fabs(i % 6 < 3 ? r[i] : 0.3 * r[i]));
        }
        for (int k = 0; k < WIDTHS; k++) {
            spari_node_work t = {.lanes = widths[k],
                                 .q = q,
                                 .tangent_q = kept,
                                 .r = r,
                                 .per_length = 0.3,
                                 .rotation = rotation,
                                 .dx = dx};
            rotation[4 * n] = dx[6 * n] = 77;
            assert_true(spari_nodes_rotate_back(&t, 0, n) == most);
            assert_near(4 * n, rotation, exact_turn, 1e-15, "a turn");
            assert_near(6 * n, dx, exact, 1e-15, "a force turned back");
            assert_alike(6 * n, dx, first[0], widths[k], "turned back");
            spari_nodes_rotate_forth(&t, 0, n);
            assert_near(6 * n, dx, r, 1e-15 * 8, "a force turned forth");
            assert_alike(6 * n, dx, first[1], widths[k], "turned forth");
            assert_true(rotation[4 * n] == 77 && dx[6 * n] == 77);
            for (int i = 0; i < 2 * n; i += 2) { /* one that is no number, wherever it stands */
                double was = r[3 * i];
                r[3 * i] = i % 4 ? NAN : -INFINITY;
                assert_true(spari_nodes_rotate_back(&t, 0, n) == INFINITY);
                r[3 * i] = was;
            }
        }
    }
}

/* ---- a substep ---- */

typedef struct substep {
    spari_scheme c;
    spari_state from, to;
    double room[2][25 * MOST], x[6 * MOST], dx[6 * MOST], rotation[4 * MOST], R[9];
} substep;

/* Increments whose rotation vectors, with the term of the rates, have this angle. */
static void random_substep(int n, double angle, int still, substep *s) {
    s->c = (spari_scheme){.h = 0.1, .span = 0.1, .cv = 30, .rate = 30, .cm = 400, .cb = 500, .still = still};
    random_state(n, &s->from, s->room[0]);
    random_state(n, &s->to, s->room[1]);
    random_numbers(6 * n, 1, s->x);
    random_numbers(6 * n, 1e-3, s->dx);
    random_quaternions(n, 4, s->rotation);
    double q[4];
    random_quaternions(1, 4, q);
    spari_quat_matrix(q, s->R);
    for (int i = 0; i < n; i++) {
        double cross[3];
        random_turn(angle, s->x + 6 * i + 3);
        spari_cross(s->to.v + 6 * i + 3, s->from.v + 6 * i + 3, cross);
        for (int k = 0; k < 3 && !still; k++) {
            s->x[6 * i + 3 + k] -= s->c.h * s->c.h / 12 * cross[k];
        }
    }
}

static void plain_psi(const substep *s, int i, double psi[3]) {
    spari_cross(s->to.v + 6 * i + 3, s->from.v + 6 * i + 3, psi);
    for (int k = 0; k < 3; k++) {
        psi[k] = s->x[6 * i + 3 + k] + (s->c.still ? 0 : s->c.h * s->c.h / 12 * psi[k]);
    }
}

/* (I - k w~) (T psi) y = x, solved by inverting the matrix of T in spari_tangent_inverse and, for the spin, by a series
   of (k w~)^n, which |k w| << 1 ends. */
static void plain_increment(const substep *s, int i, double d[3]) {
    double psi[3], T[9], y[3], term[3], k = s->c.still ? 0 : s->c.h * s->c.h * s->c.cv / 12;
    plain_psi(s, i, psi);
    spari_tangent_inverse(psi, T);
    spari_matrix_times(T, d, y);
    memcpy(term, y, sizeof y);
    for (int n = 0; n < 40; n++) {
        spari_cross(s->from.v + 6 * i + 3, term, term);
        for (int j = 0; j < 3; j++) {
            term[j] *= k;
            y[j] += term[j];
        }
    }
    memcpy(d, y, sizeof y);
}

static double square_of_largest(int n, int from, const double *x) {
    double most = 0;
    for (int i = 0; i < n; i++) {
        most = fmax(most, spari_dot(x + 6 * i + from, x + 6 * i + from));
    }
    return most;
}

static void check_corrections(int n, double angle, int still, int turned, int rooted) {
    substep s;
    double exact[6 * MOST], first[6 * MOST], dx[6 * MOST + 1];
    random_substep(n, angle, still, &s);
    memcpy(exact, s.dx, sizeof exact);
    for (int i = 0; i < n; i++) {
        for (int k = 0; k < 6; k += 3) {
            if (turned) {
                spari_rotate(s.rotation + 4 * i, exact + 6 * i + k, exact + 6 * i + k);
            }
            if (rooted) {
                spari_matrix_times_back(s.R, exact + 6 * i + k, exact + 6 * i + k);
            }
        }
        plain_increment(&s, i, exact + 6 * i + 3);
    }
    for (int k = 0; k < WIDTHS; k++) {
        memcpy(dx, s.dx, sizeof s.dx);
        dx[6 * n] = 77;
        spari_node_work t = {.lanes = widths[k], .c = &s.c, .from = &s.from, .to = &s.to, .x = s.x, .dx = dx};
        t.rotation = turned ? s.rotation : NULL, t.R = rooted ? s.R : NULL;
        spari_node_size size = spari_nodes_take(&t, 0, n);
        /* near 2 pi the operator has no inverse; 5 pi / 2 and less than 3 pi stay 0.1 away mostly */
        assert_near(6 * n, dx, exact, angle < 0 ? 1e-10 : 1e-14, "a correction");
        assert_alike(6 * n, dx, first, widths[k], "corrections");
        assert_true(dx[6 * n] == 77);
        assert_true(fabs(size.way - square_of_largest(n, 0, dx)) <= 1e-15 * size.way);
        assert_true(fabs(size.rotation - square_of_largest(n, 3, dx)) <= 1e-15 * size.rotation);
    }
}

static void test_corrections(void **unused) {
    (void)unused;
    for (int n = 1; n <= MOST; n++) {
        for (int k = 0; k < 8 * ANGLES; k++) {
            check_corrections(n, angles[k / 8], k & 1, k & 2, k & 4);
        }
    }
}

static void check_places(int n, double angle, int still) {
    substep s;
    double exact[7 * MOST], first[7 * MOST];
    random_substep(n, angle, still, &s);
    s.to.v = s.room[1] + 7 * MOST;
    for (int i = 0; i < n; i++) {
        double psi[3], p[4], *to = exact + 7 * i;
        const double *from = s.from.q + 7 * i;
        plain_psi(&s, i, psi);
        spari_quat_exp(psi, p);
        spari_quat_mul(p, from + 3, to + 3);
        spari_quat_normalise(to + 3);
        for (int k = 0; k < 3; k++) {
            to[k] = from[k] + s.x[6 * i + k];
        }
    }
    for (int k = 0; k < WIDTHS; k++) {
        substep own = s;
        spari_state to = {own.room[1], own.room[1] + 7 * MOST, own.room[1] + 13 * MOST, own.room[1] + 19 * MOST};
        spari_state from = {own.room[0], own.room[0] + 7 * MOST, own.room[0] + 13 * MOST, own.room[0] + 19 * MOST};
        spari_node_work t = {.lanes = widths[k], .c = &s.c, .from = &from, .to = &to, .x = own.x};
        spari_node_size size = spari_nodes_positions(&t, 0, n), alone = spari_nodes_size(&t, 0, n);
        assert_near(7 * n, to.q, exact, 2e-15, "a place");
        assert_alike(7 * n, to.q, first, widths[k], "places");
        assert_memory_equal(to.q + 7 * n, s.room[1] + 7 * n, sizeof(double) * (size_t)(7 * (MOST - n)));
        assert_true(fabs(size.way - square_of_largest(n, 0, s.x)) <= 1e-15 * size.way && size.way == alone.way);
        assert_true(fabs(size.rotation - square_of_largest(n, 3, s.x)) <= 1e-15 * size.rotation &&
                    size.rotation == alone.rotation);
        for (int i = 0; i < 6 * n; i++) {
            assert_true(still ? to.v[i] == s.x[i] / s.c.h && to.a[i] == 0 && to.b[i] == 0
                              : to.v[i] == s.room[1][7 * MOST + i]);
        }
    }
}

static void test_places(void **unused) {
    (void)unused;
    for (int n = 1; n <= MOST; n++) {
        for (int k = 0; k < 2 * ANGLES; k++) {
            check_places(n, angles[k / 2], k % 2);
        }
    }
}

/* A place that is no number stays one, beside others that are right. */
static void test_no_number(void **unused) {
    (void)unused;
    for (int k = 0; k < WIDTHS; k++) {
        substep s;
        random_substep(9, 0.3, 0, &s);
        spari_node_work t = {.lanes = widths[k], .c = &s.c, .from = &s.from, .to = &s.to, .x = s.x};
        s.x[6 * 4 + 3] = NAN;
        s.x[6 * 7 + 4] = INFINITY;
        spari_nodes_positions(&t, 0, 9);
        for (int i = 0; i < 9; i++) {
            assert_true((i == 4 || i == 7) ==
                        !(fabs(spari_quat_dot(s.to.q + 7 * i + 3, s.to.q + 7 * i + 3) - 1) < 1e-15));
        }
    }
}

/* Starting values keep the scheme's equations, of Bruls, Cardona & Arnold (2012), (1 - alpha_m) b' + alpha_m b =
   (1 - alpha_f) a' + alpha_f a and Newmark's, with what stays over the step; and have the bits of one unknown. */
static void check_prediction(const substep *s, const substep *own, spari_guess stays, int n) {
    const spari_scheme *c = &s->c;
    const double *v = s->room[0] + 7 * MOST, *a = v + 6 * MOST, *b = a + 6 * MOST;
    const double *v1 = own->room[1] + 7 * MOST, *a1 = v1 + 6 * MOST, *b1 = a1 + 6 * MOST, h = c->h;
    for (int i = 0; i < 6 * n; i++) {
        double one[4], mean = (1 - c->alpha_m) * b1[i] + c->alpha_m * b[i];
        assert_true(fabs(mean - (1 - c->alpha_f) * a1[i] - c->alpha_f * a[i]) <= 1e-12);
        assert_true(fabs(own->x[i] - h * v[i] - h * h * ((0.5 - c->beta) * b[i] + c->beta * b1[i])) <= 1e-14);
        assert_true(fabs(v1[i] - v[i] - h * ((1 - c->gamma) * b[i] + c->gamma * b1[i])) <= 1e-14);
        assert_true(stays != SPARI_KEEP_ACCELERATION || a1[i] == a[i]);
        assert_true(stays != SPARI_KEEP_VELOCITY || fabs(own->x[i] - h * v[i]) <= 1e-14);
        assert_true(stays != SPARI_KEEP_POSITION || fabs(own->x[i]) <= 1e-14);
        spari_rates from = {s->from.v + i, s->from.a + i, s->from.b + i, NULL}, to = {one, one + 1, one + 2, NULL};
        spari_scheme_predict(c, stays, 1, from, one + 3, to);
        assert_true(one[0] == v1[i] && one[1] == a1[i] && one[2] == b1[i] && one[3] == own->x[i]);
    }
    assert_true(memcmp(own->x + 6 * n, s->x + 6 * n, sizeof s->x - (size_t)(6 * n) * sizeof *s->x) == 0);
}

static void test_starting_values(void **unused) {
    (void)unused;
    const spari_guess guesses[] = {SPARI_KEEP_ACCELERATION, SPARI_KEEP_VELOCITY, SPARI_KEEP_POSITION};
    for (int n = 1; n <= MOST; n++) {
        substep s, own;
        random_substep(n, 0.3, 0, &s);
        s.c.alpha_m = 0.3, s.c.alpha_f = 0.4, s.c.gamma = 0.6, s.c.beta = 0.3025;
        for (int k = 0; k < WIDTHS; k++) {
            for (int g = 0; g < 3; g++) {
                own = s;
                spari_state to = {own.room[1], own.room[1] + 7 * MOST, own.room[1] + 13 * MOST,
                                  own.room[1] + 19 * MOST};
                spari_node_work t = {.lanes = widths[k], .c = &s.c, .from = &s.from, .to = &to, .x = own.x};
                spari_nodes_predict(&t, guesses[g], 0, n);
                check_prediction(&s, &own, guesses[g], n);
            }
        }
    }
}

static void test_steps(void **unused) {
    (void)unused;
    for (int n = 1; n <= MOST; n++) {
        substep s, own;
        random_substep(n, 0.3, 0, &s);
        for (int k = 0; k < WIDTHS; k++) {
            own = s;
            spari_state to = {own.room[1], own.room[1] + 7 * MOST, own.room[1] + 13 * MOST, own.room[1] + 19 * MOST};
            spari_node_work t = {.lanes = widths[k], .c = &s.c, .to = &to, .x = own.x, .dx = own.dx, .cut = 0.7};
            spari_nodes_correct(&t, 0, n);
            for (int i = 0; i < 6 * MOST; i++) {
                double step = i < 6 * n ? -0.7 * s.dx[i] : 0;
                assert_true(own.x[i] == s.x[i] + step || i >= 6 * n);
                assert_true(to.v[i] == s.room[1][7 * MOST + i] + s.c.rate * step);
                assert_true(to.a[i] == s.room[1][13 * MOST + i] + s.c.cm * step);
                assert_true(to.b[i] == s.room[1][19 * MOST + i] + s.c.cb * step);
            }
        }
    }
}

/* All of a correction at once has the bits that its parts have one after the other. */
static void check_at_once(int n, double angle, int turned, int rooted) {
    substep s;
    random_substep(n, angle, 0, &s);
    for (int k = 0; k < WIDTHS; k++) {
        substep own[2] = {s, s};
        spari_node_size size[2][2];
        for (int j = 0; j < 2; j++) {
            double *room = own[j].room[1];
            spari_state from = {s.room[0], s.room[0] + 7 * MOST, s.room[0] + 13 * MOST, s.room[0] + 19 * MOST};
            spari_state to = {room, room + 7 * MOST, room + 13 * MOST, room + 19 * MOST};
            spari_node_work t = {.lanes = widths[k], .c = &s.c, .from = &from, .to = &to, .cut = 1};
            t.x = own[j].x, t.dx = own[j].dx, t.rotation = turned ? s.rotation : NULL, t.R = rooted ? s.R : NULL;
            if (j == 0) {
                size[j][0] = spari_nodes_take(&t, 0, n);
                spari_nodes_correct(&t, 0, n);
                size[j][1] = spari_nodes_positions(&t, 0, n);
            } else {
                spari_nodes_advance(&t, 0, n, &size[j][0], &size[j][1]);
            }
        }
        assert_memory_equal(own[0].room[1], own[1].room[1], sizeof s.room[1]);
        assert_memory_equal(own[0].x, own[1].x, sizeof s.x);
        assert_memory_equal(own[0].dx, own[1].dx, sizeof s.dx);
        assert_memory_equal(size[0], size[1], sizeof size[0]);
    }
}

static void test_at_once(void **unused) {
    (void)unused;
    for (int n = 1; n <= MOST; n++) {
        for (int k = 0; k < 4 * ANGLES; k++) {
            check_at_once(n, angles[k / 4], k & 1, k & 2);
        }
    }
}

/* ---- seen from outside ---- */

/* x = X + R (r + u), its velocity and acceleration by the rules for a frame that moves, in global axes. */
static void plain_show(const double *reference, const spari_pose *root, const spari_state *own, int i, double q[7],
                       double v[6], double a[6]) {
    double arm[3], d[3], u[3], w[3], au[3], aw[3], t[3], s[3], turned[4];
    for (int k = 0; k < 3; k++) {
        arm[k] = reference[3 * i + k] - reference[k];
        d[k] = arm[k] + own->q[7 * i + k];
    }
    spari_rotate(root->q + 3, d, d);
    spari_rotate(root->q + 3, own->v + 6 * i, u);
    spari_rotate(root->q + 3, own->v + 6 * i + 3, w);
    spari_rotate(root->q + 3, own->a + 6 * i, au);
    spari_rotate(root->q + 3, own->a + 6 * i + 3, aw);
    for (int k = 0; k < 3; k++) {
        q[k] = root->q[k] + d[k] - arm[k];
    }
    spari_quat_mul(root->q + 3, own->q + 7 * i + 3, turned);
    spari_quat_normalise(turned);
    memcpy(q + 3, turned, sizeof turned);
    spari_cross(root->v + 3, d, t); /* v = V + w x d + u */
    for (int k = 0; k < 3; k++) {
        v[k] = root->v[k] + t[k] + u[k];
        v[3 + k] = root->v[3 + k] + w[k];
        a[k] = root->a[k] + au[k];
        a[3 + k] = root->a[3 + k] + aw[k];
    }
    spari_cross(root->a + 3, d, s); /* a = A + alpha x d + w x (w x d) + 2 w x u + u' */
    for (int k = 0; k < 3; k++) {
        a[k] += s[k];
    }
    spari_cross(root->v + 3, t, s);
    for (int k = 0; k < 3; k++) {
        a[k] += s[k];
    }
    spari_cross(root->v + 3, u, s);
    for (int k = 0; k < 3; k++) {
        a[k] += 2 * s[k];
    }
    spari_cross(root->v + 3, w, s);
    for (int k = 0; k < 3; k++) {
        a[3 + k] += s[k];
    }
}

/* A root looks at what is seen from outside, and finds its own again; b stays. */
static void check_look(const spari_root_view *shown, int n, double *first) {
    double room[25 * MOST], out[19 * MOST], exact[19 * MOST];
    const spari_state *s = shown->own;
    spari_state own;
    random_state(n, &own, room);
    spari_root_view t = *shown;
    t.own = &own, t.R = NULL;
    spari_nodes_look(&t, 0, n);
    const double *const parts[2][3] = {{own.q, own.v, own.a}, {s->q, s->v, s->a}};
    for (int k = 0; k < 2; k++) {
        double *to = k ? exact : out;
        memcpy(to, parts[k][0], sizeof(double) * (size_t)(7 * n));
        memcpy(to + 7 * n, parts[k][1], sizeof(double) * (size_t)(6 * n));
        memcpy(to + 13 * n, parts[k][2], sizeof(double) * (size_t)(6 * n));
    }
    assert_near(19 * n, out, exact, 1e-13, "what a root sees"); /* 1e2 of the acceleration goes in and out */
    assert_alike(19 * n, out, first, t.lanes, "what a root sees");
    assert_memory_equal(own.b, shown->absolute->b, sizeof(double) * (size_t)(6 * n));
}

/* x + u goes back by what a small rigid motion E takes it, u-dot by what the rates J take it; the turn by exp(-E). */
static void plain_lose(const spari_root_jump *t, const double *arm, double q[7], double v[6]) {
    const double less[3] = {-t->position[3], -t->position[4], -t->position[5]};
    double d[3], way[3], rate[3], rotation[4];
    for (int k = 0; k < 3; k++) {
        d[k] = arm[k] + q[k];
    }
    spari_cross(t->position + 3, d, way);
    spari_cross(t->velocity + 3, d, rate);
    for (int k = 0; k < 3; k++) {
        q[k] -= t->position[k] + way[k];
        v[k] -= t->velocity[k] + rate[k];
        v[3 + k] -= t->velocity[3 + k];
    }
    spari_quat_exp(less, rotation);
    spari_quat_mul(rotation, q + 3, q + 3);
}

static void check_lose(const spar_member *m, int n) {
    double room[25 * MOST], first[13 * MOST], before[25 * MOST], less[3];
    spari_root_jump t = {.member = m};
    spari_state own;
    random_state(n, &own, before);
    t.own = &own;
    random_numbers(6, 1, t.velocity);
    random_numbers(6, 0.1, t.position);
    for (int k = 0; k < 3; k++) {
        less[k] = -t.position[3 + k];
    }
    spari_quat_exp(less, t.back);
    for (int k = 0; k < WIDTHS; k++) {
        double exact[13 * MOST], out[13 * MOST];
        memcpy(room, before, sizeof room);
        own = (spari_state){room, room + 7 * MOST, room + 13 * MOST, room + 19 * MOST};
        for (int i = 0; i < n; i++) {
            double arm[3];
            spari_member_arm(m, i, arm);
            memcpy(exact + 7 * i, own.q + 7 * i, 7 * sizeof *exact);
            memcpy(exact + 7 * n + 6 * i, own.v + 6 * i, 6 * sizeof *exact);
            if (i > 0) {
                plain_lose(&t, arm, exact + 7 * i, exact + 7 * n + 6 * i);
            }
        }
        t.lanes = widths[k];
        spari_nodes_lose(&t, 1, n);
        memcpy(out, own.q, sizeof(double) * (size_t)(7 * n));
        memcpy(out + 7 * n, own.v, sizeof(double) * (size_t)(6 * n));
        assert_near(13 * n, out, exact, 1e-14, "what a jump leaves");
        assert_alike(13 * n, out, first, widths[k], "what a jump leaves");
        assert_memory_equal(room + 7 * n, before + 7 * n, sizeof(double) * (size_t)(7 * (MOST - n)));
        assert_memory_equal(room + 13 * MOST, before + 13 * MOST, sizeof(double) * 12 * MOST);
    }
}

/* One element of n nodes, and elements of 3, whose joints the reference has twice. */
static void check_show(int n, int elements) {
    spar_member m = {.mesh = {elements, (n - 1) / elements + 1}};
    double place[3 * 2 * MOST], room[2][25 * MOST], exact[19 * MOST], first[2][19 * MOST], R[9];
    double omega[3], alpha[3];
    spari_pose root;
    spari_state own, seen;
    m.xr = place;
    random_numbers(3 * 2 * MOST, 5, place);
    for (int i = 2; i < n && elements > 1; i += 2) { /* a joint of elements of 3: nodes 2, 5, 8 stand twice */
        memcpy(place + 3 * (3 * i / 2), place + 3 * (3 * i / 2 - 1), 3 * sizeof *place);
    }
    random_state(n, &own, room[0]);
    random_numbers(7, 2, root.q);
    random_quaternions(1, 4, root.q + 3);
    random_numbers(6, 2, root.v);
    random_numbers(6, 2, root.a);
    spari_quat_matrix(root.q + 3, R);
    spari_matrix_times_back(R, root.v + 3, omega);
    spari_matrix_times_back(R, root.a + 3, alpha);
    double nodes[3 * MOST];
    for (int i = 0; i < n; i++) {
        memcpy(nodes + 3 * i, spari_member_position(&m, i), 3 * sizeof *nodes);
    }
    for (int i = 0; i < n; i++) {
        plain_show(nodes, &root, &own, i, exact + 7 * i, exact + 7 * n + 6 * i, exact + 13 * n + 6 * i);
    }
    for (int k = 0; k < WIDTHS; k++) {
        double out[19 * MOST];
        random_state(n, &seen, room[1]);
        spari_root_view t = {widths[k], &m, &root, R, omega, alpha, &own, &seen};
        spari_nodes_show(&t, 0, n);
        memcpy(out, seen.q, sizeof(double) * (size_t)(7 * n));
        memcpy(out + 7 * n, seen.v, sizeof(double) * (size_t)(6 * n));
        memcpy(out + 13 * n, seen.a, sizeof(double) * (size_t)(6 * n));
        assert_near(19 * n, out, exact, 1e-14, "what is seen");
        assert_alike(19 * n, out, first[0], widths[k], "what is seen");
        assert_memory_equal(seen.b, own.b, sizeof(double) * (size_t)(6 * n));
        check_look(&t, n, first[1]);
    }
    check_lose(&m, n);
}

static void test_show(void **unused) {
    (void)unused;
    for (int n = 1; n <= MOST; n++) {
        check_show(n, 1);
    }
    check_show(9, 4);
    check_show(19, 9);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_turns),           cmocka_unit_test(test_corrections), cmocka_unit_test(test_places),
        cmocka_unit_test(test_no_number),       cmocka_unit_test(test_steps),       cmocka_unit_test(test_show),
        cmocka_unit_test(test_starting_values), cmocka_unit_test(test_at_once),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
