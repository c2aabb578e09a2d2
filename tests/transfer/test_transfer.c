/* The transfer kernels against the formulas written out node by node, for every vector width this processor has.
 * Tolerances are relative to the size of what is summed: 1e-13, some hundred roundings. */
#include "math/rotation.h"
#include "support/lines.h"
#include "transfer/transfer.h"
#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* cmocka's own compares floats */
#define CLOSE(a, b, tolerance) assert_true(fabs((a) - (b)) <= (tolerance))

static const int widths[] = {2, 4, 8}; /* those the processor lacks fall back to the next narrower */

/* ---- a scene: a member's nodes in motion and fluid nodes tied to them ---- */

enum {
    MOST = 6 * SPARI_MAX_NODES,
    WORK = (20 + SPARI_MAX_NODES) * SPARI_ROW + (7 * SPARI_MAX_NODES + 33) * 8 + MOST * 28 + 44
};

typedef struct scene {
    int elements, nodes; /* per element */
    double xr[MOST][3], q[MOST][7], v[MOST][6], a[MOST][6];
    double modal[SPARI_MAX_NODES * SPARI_MAX_NODES];
    double field[MOST * SPARI_FIELDS];
    int64_t n;
    int *element;
    double *xi, (*con)[3], (*force)[3], (*moment)[3];
    spari_nodes *set;
} scene;

/* Node motion at time t: every node moves and turns along smooth paths; `bend` radians along the line. */
typedef void (*history)(double eta, double t, double bend, double q[7]);

static void swing(double eta, double t, double bend, double q[7]) {
    double p[3] = {0.3 + bend * eta + 0.4 * t, 0.5 * bend * eta * eta - 0.2 * t * t, 0.9 * sin(t + bend * eta)}, r[4],
           s[3] = {0.2, 1.9 + t, 0.1};
    for (int i = 0; i < 3; i++) {
        q[i] = 3 * sin(i + 2 * t + bend * eta) + i * t;
    }
    spari_quat_exp(p, r);
    spari_quat_exp(s, q + 3);
    spari_quat_mul(q + 3, r, q + 3);
}

/* Velocities and accelerations by sixth order differences of the path: about 1e-10, enough where they are only inputs,
   and the same numbers everywhere. */
static void set_motion(scene *s, double t, double bend) {
    double gll[SPARI_MAX_NODES];
    spari_gll(s->nodes, gll, NULL, NULL);
    for (int l = 0; l < s->elements * s->nodes; l++) {
        swing((l / s->nodes + 0.5 * (1 + gll[l % s->nodes])) / s->elements, t, bend, s->q[l]);
    }
}

static void scene_start(scene *s, int elements, int nodes, int64_t n, unsigned long long *seed) {
    memset(s, 0, sizeof *s);
    s->elements = elements, s->nodes = nodes, s->n = n;
    double gll[SPARI_MAX_NODES];
    spari_gll(nodes, gll, NULL, NULL);
    for (int l = 0; l < elements * nodes; l++) {
        double eta = (l / nodes + 0.5 * (1 + gll[l % nodes])) / elements;
        s->xr[l][0] = 20 * eta, s->xr[l][1] = sin(2 * eta), s->xr[l][2] = eta * eta;
    }
    set_motion(s, 0.3, 0.8);
    for (int l = 0; l < elements * nodes; l++) {
        int joint = l > 0 && l % nodes == 0; /* joints stand twice and move once */
        for (int i = 0; i < 6; i++) {
            s->v[l][i] = joint ? s->v[l - 1][i] : line_random(seed);
            s->a[l][i] = joint ? s->a[l - 1][i] : line_random(seed);
        }
    }
    spari_modal_matrix(nodes, s->modal);
    size_t room = (size_t)(n > 0 ? n : 1);
    s->element = malloc(room * sizeof *s->element);
    s->xi = malloc(room * sizeof *s->xi);
    s->con = malloc(room * sizeof *s->con);
    s->force = malloc(room * sizeof *s->force);
    s->moment = malloc(room * sizeof *s->moment);
    uint8_t *flags = calloc(room, 1);
    for (int64_t j = 0; j < n; j++) {
        s->element[j] = (int)(0.4999 * (1 + line_random(seed)) * elements);
        s->xi[j] = nodes == 1 ? 0 : j % 11 == 0 ? -1 : j % 13 == 0 ? 1 : line_random(seed);
        for (int i = 0; i < 3; i++) {
            s->con[j][i] = 2 * line_random(seed);
            s->force[j][i] = line_random(seed) + 0.3;
            s->moment[j][i] = line_random(seed);
        }
    }
    s->set = spari_nodes_create(n, elements, nodes);
    spari_nodes_put(s->set, s->element, s->xi, n ? s->con[0] : NULL, flags);
    free(flags);
}

static void scene_end(scene *s) {
    free(s->element);
    free(s->xi);
    free(s->con);
    free(s->force);
    free(s->moment);
    spari_nodes_free(s->set);
}

static void fill(scene *s, int consistent, int upto) {
    spari_field_fill(s->elements, s->nodes, s->modal, consistent, upto, s->xr[0], s->q[0], s->v[0], s->a[0], s->field);
}

/* ---- the formulas, one fluid node at a time ---- */

typedef struct state {
    double x[3], v[3], omega[3], accel[3], alpha[3], r[3], q[4];
} state;

static void basis_at(const scene *s, double xi, double *phi) {
    double gll[SPARI_MAX_NODES], bary[SPARI_MAX_NODES];
    spari_gll(s->nodes, gll, NULL, bary);
    spari_lagrange(s->nodes, gll, bary, xi, phi, NULL);
}

/* Nodal: the sums (T4). Consistent: p_l = q_l Q* / |Q|^2 = (s_l, w_l), omega = sum phi_l (s_l I - [w_l]x) omega_l.
   Its acceleration is differentiated from that: with z = sum phi_l 2 q_l'' Q* / |Q|^2, alpha = vec z - omega d ln |Q|^2
   / dt. */
static void state_at(const scene *s, int64_t j, int consistent, state *o) {
    double phi[SPARI_MAX_NODES], sum[4] = {0}, u[3] = {0}, du[3] = {0}, ddu[3] = {0}, square = 0, growth = 0;
    int first = s->element[j] * s->nodes;
    const double *last = s->q[first] + 3;
    double sign[SPARI_MAX_NODES];
    basis_at(s, s->xi[j], phi);
    for (int l = 0; l < s->nodes; l++) {
        const double *q = s->q[first + l] + 3;
        sign[l] = l == 0 ? 1 : spari_quat_dot(q, last) < 0 ? -sign[l - 1] : sign[l - 1];
        last = q;
        for (int i = 0; i < 4; i++) {
            sum[i] += phi[l] * sign[l] * q[i];
        }
        for (int i = 0; i < 3; i++) {
            u[i] += phi[l] * (s->xr[first + l][i] + s->q[first + l][i]);
            du[i] += phi[l] * s->v[first + l][i];
            ddu[i] += phi[l] * s->a[first + l][i];
        }
    }
    square = spari_quat_dot(sum, sum);
    memset(o, 0, sizeof *o);
    for (int l = 0; l < s->nodes; l++) {
        const double *w = s->v[first + l] + 3, *al = s->a[first + l] + 3, *q = s->q[first + l] + 3;
        if (!consistent) {
            for (int i = 0; i < 3; i++) {
                o->omega[i] += phi[l] * w[i], o->alpha[i] += phi[l] * al[i];
            }
            continue;
        }
        double back[4], p[4], c[3], twist[4] = {-0.5 * spari_dot(w, w), al[0], al[1], al[2]}, z[4];
        spari_quat_conj(sum, back);
        spari_quat_mul(q, back, p);
        for (int i = 0; i < 4; i++) {
            p[i] *= sign[l] / square;
        }
        spari_cross(p + 1, w, c);
        growth += phi[l] * -spari_dot(w, p + 1);
        spari_quat_mul(twist, p, z);
        for (int i = 0; i < 3; i++) {
            o->omega[i] += phi[l] * (p[0] * w[i] - c[i]);
            o->alpha[i] += phi[l] * z[i + 1];
        }
    }
    for (int i = 0; i < 3 && consistent; i++) {
        o->alpha[i] -= o->omega[i] * growth;
    }
    memcpy(o->q, sum, sizeof sum);
    spari_quat_normalise(o->q);
    spari_rotate(o->q, s->con[j], o->r);
    double wr[3], wwr[3], ar[3];
    spari_cross(o->omega, o->r, wr);
    spari_cross(o->omega, wr, wwr);
    spari_cross(o->alpha, o->r, ar);
    for (int i = 0; i < 3; i++) {
        o->x[i] = u[i] + o->r[i];
        o->v[i] = du[i] + wr[i];
        o->accel[i] = ddu[i] + ar[i] + wwr[i];
    }
}

/* ---- motion out ---- */

static void expect(const double *got, const double *want, int n, double tolerance) {
    for (int i = 0; i < n; i++) {
        CLOSE(got[i], want[i], tolerance);
    }
}

/* Reads row `row` of every tile into out [n][3], offset by one double from any alignment, with guards round it. */
static void collect(const scene *s, int consistent, int upto, int row, double (*out)[3]) {
    static double buf[SPARI_ROWS][SPARI_ROW];
    size_t n = 3 * (size_t)s->n;
    char *raw = malloc((n + 3) * sizeof(double) + 4);
    double *x = (double *)(void *)(raw + 4); /* unaligned on purpose: hosts' arrays are what they are */
    double guard = -7.5;
    memcpy((char *)x, &guard, sizeof guard);
    memcpy((char *)x + (n + 1) * sizeof guard, &guard, sizeof guard);
    for (int64_t first = 0; first < s->n; first += SPARI_TILE) {
        spari_tile_motion(s->set, first, s->field, consistent, upto, buf);
        spari_tile_store(s->set, first, buf + row, (double *)(void *)((char *)x + sizeof guard));
    }
    assert_memory_equal((char *)x, &guard, sizeof guard);
    assert_memory_equal((char *)x + (n + 1) * sizeof guard, &guard, sizeof guard);
    memcpy(out, (char *)x + sizeof guard, n * sizeof(double));
    free(raw);
}

static void compare_motion(scene *s, int consistent) {
    enum { ROWS = 5 };
    static const int row[ROWS] = {SPARI_R_POSITION, SPARI_R_RATE, SPARI_R_OMEGA, SPARI_R_ACCEL, SPARI_R_ALPHA};
    double(*got)[3] = malloc(sizeof *got * (size_t)(s->n + 1));
    fill(s, consistent, SPARI_UPTO_ACCEL);
    for (size_t w = 0; w < sizeof widths / sizeof *widths; w++) {
        s->set->lanes = widths[w];
        for (int k = 0; k < ROWS; k++) {
            collect(s, consistent, SPARI_UPTO_ACCEL, row[k], got);
            for (int64_t j = 0; j < s->n; j++) {
                state o;
                state_at(s, j, consistent, &o);
                const double *want[ROWS] = {o.x, o.v, o.omega, o.accel, o.alpha};
                expect(got[j], want[k], 3, k == 0 ? 4e-13 : 2e-13); /* places reach 30 */
            }
        }
    }
    free(got);
}

/* What goes straight to the host has the bits of what goes through tiles, wherever the host's array begins, from any
   node on, and nothing beside it is touched. */
static void compare_straight(scene *s, int consistent, int single, int64_t first) {
    enum { FEW = 1200, EDGE = 80 };
    static double buf[SPARI_ROWS][SPARI_ROW], tiles[2][3 * FEW], straight[2][3 * FEW + EDGE], want[3 * FEW + EDGE];
    static float floats[2][3 * FEW];
    const size_t size = single ? sizeof(float) : sizeof(double), skip = 3 * (size_t)first * size;
    const size_t bytes = 3 * (size_t)(s->n - first) * size;
    assert_true(s->n <= FEW);
    for (int64_t at = 0; at < s->n; at += SPARI_TILE) {
        spari_tile_motion(s->set, at, s->field, consistent, SPARI_UPTO_RATE, buf);
        for (int k = 0; k < 2; k++) {
            spari_tile_store(s->set, at, buf + (k ? SPARI_R_RATE : SPARI_R_POSITION), tiles[k]);
            spari_tile_store_f32(s->set, at, buf + (k ? SPARI_R_RATE : SPARI_R_POSITION), floats[k]);
        }
    }
    for (int begin = 0; begin < 64;
         begin += begin % 8 == 4 ? 3 : 4) { /* 0, 4, 7, 11, 15, ...: at numbers and between */
        for (int asked = 1; asked < 4; asked++) {
            char *to[2];
            memset(straight, 0xa5, sizeof straight);
            for (int k = 0; k < 2; k++) {
                to[k] = (char *)straight[k] + (64 - (uintptr_t)straight[k] % 64) % 64 + (k ? 63 - begin : begin);
            }
            spari_move_to(s->set, first, s->n - first, s->field, consistent, single, asked & 1 ? to[0] : NULL,
                          asked & 2 ? to[1] : NULL);
            for (int k = 0; k < 2; k++) {
                memset(want, 0xa5, sizeof want);
                if (asked & (k + 1)) {
                    const char *all = single ? (const char *)floats[k] : (const char *)tiles[k];
                    memcpy((char *)want + (to[k] - (char *)straight[k]) + skip, all + skip, bytes);
                }
                assert_memory_equal(straight[k], want, sizeof want);
            }
        }
    }
}

static void straight_as_by_tiles(void **unused) {
    (void)unused;
    static const int64_t counts[] = {1, 7, 15, 16, 17, 33, 64, 255, 513, 1100};
    unsigned long long seed = 17;
    static scene s;
    for (size_t k = 0; k < 2 * sizeof counts / sizeof *counts; k++) {
        const int64_t n = counts[k / 2];
        const int elements = k % 2 ? 3 : 1;
        scene_start(&s, elements, 4 + (int)(k % 3), n, &seed);
        uint8_t *flags = calloc((size_t)n, 1);
        spari_nodes_free(s.set);
        for (int64_t j = 0; j < n; j++) { /* along the line, as they have to come */
            s.element[j] = (int)(j * elements / n);
        }
        s.set = spari_nodes_create(n, elements, s.nodes);
        spari_nodes_put(s.set, s.element, s.xi, s.con[0], flags);
        free(flags);
        for (size_t w = 0; w < sizeof widths / sizeof *widths; w++) {
            s.set->lanes = widths[w];
            for (int how = 0; how < 4; how++) {
                assert_true(how > 1 || spari_can_move_to(s.set, 0));
                fill(&s, how % 2, SPARI_UPTO_RATE);
                compare_straight(&s, how % 2, how / 2, 0);
                compare_straight(&s, how % 2, how / 2, n / 3);
            }
        }
        scene_end(&s);
    }
}

static void motion_is_the_formula(void **unused) {
    (void)unused;
    unsigned long long seed = 99;
    static scene s;
    for (int nodes = 1; nodes <= SPARI_MAX_NODES; nodes += nodes < 6 ? 1 : 3) {
        for (int elements = 1; elements <= 4; elements += 3) {
            if (nodes == 1 && elements > 1) {
                continue;
            }
            scene_start(&s, elements, nodes, 61, &seed);
            compare_motion(&s, 0);
            compare_motion(&s, 1);
            scene_end(&s);
        }
    }
}

/* Any count of nodes, any alignment: 0, 1, round a vector, round a tile. ASan and valgrind see the rest. */
static void any_count_of_nodes(void **unused) {
    (void)unused;
    static const int64_t counts[] = {0, 1, 7, 8, 9, 15, 16, 17, 255, 256, 257, 513};
    unsigned long long seed = 3;
    static scene s;
    for (size_t k = 0; k < sizeof counts / sizeof *counts; k++) {
        for (int elements = 1; elements <= 3; elements += 2) {
            scene_start(&s, elements, 5, counts[k], &seed);
            compare_motion(&s, (int)(k % 2));
            scene_end(&s);
        }
    }
}

/* A rigid turn by 0 to 179 degrees, and by 7 whole turns and a bit, about an axis through c: x = c + R (X - c) + a t,
   velocity a + omega x (x - c - a t). Places are about 50, velocities about 100. */
static void rigid_motion_is_exact(void **unused) {
    (void)unused;
    unsigned long long seed = 21;
    static scene s;
    static double x[40][3], v[40][3];
    const double angles[] = {0, 1e-9, 0.5, 1.5707963267948966, 3.0, 179 * M_PI / 180, 14 * M_PI + 0.4};
    const double axis[3] = {2. / 7, 3. / 7, 6. / 7}, c[3] = {1, -2, 3}, a[3] = {4, 5, -6};
    for (int nodes = 1; nodes <= 24; nodes += 23) {
        for (size_t k = 0; k < sizeof angles / sizeof *angles; k++) {
            scene_start(&s, 1, nodes, 40, &seed);
            double psi[3], q[4], omega[3], d[3], t[3];
            for (int i = 0; i < 3; i++) {
                psi[i] = angles[k] * axis[i], omega[i] = 3 * axis[i] - i;
            }
            spari_quat_exp(psi, q);
            for (int l = 0; l < nodes; l++) {
                for (int i = 0; i < 3; i++) {
                    d[i] = s.xr[l][i] - c[i];
                }
                spari_rotate(q, d, t);
                for (int i = 0; i < 3; i++) {
                    s.q[l][i] = c[i] + t[i] + a[i] - s.xr[l][i];
                }
                memcpy(s.q[l] + 3, q, sizeof q);
                spari_cross(omega, t, d);
                for (int i = 0; i < 3; i++) {
                    s.v[l][i] = a[i] + d[i], s.v[l][3 + i] = omega[i];
                }
            }
            for (int consistent = 0; consistent < 2; consistent++) {
                fill(&s, consistent, SPARI_UPTO_RATE);
                collect(&s, consistent, SPARI_UPTO_RATE, SPARI_R_POSITION, x);
                collect(&s, consistent, SPARI_UPTO_RATE, SPARI_R_RATE, v);
                for (int j = 0; j < 40; j++) {
                    double phi[SPARI_MAX_NODES], X[3] = {0};
                    basis_at(&s, s.xi[j], phi);
                    for (int i = 0; i < 3; i++) {
                        for (int l = 0; l < nodes; l++) {
                            X[i] += phi[l] * s.xr[l][i];
                        }
                        d[i] = X[i] + s.con[j][i] - c[i];
                    }
                    spari_rotate(q, d, t);
                    spari_cross(omega, t, d);
                    for (int i = 0; i < 3; i++) {
                        CLOSE(x[j][i], c[i] + t[i] + a[i], 50 * 1e-13);
                        CLOSE(v[j][i], a[i] + d[i], 100 * 1e-13);
                    }
                }
            }
            scene_end(&s);
        }
    }
}

/* The sign of a quaternion means nothing: flipped at random, every result has the same bits. */
static void signs_do_not_matter(void **unused) {
    (void)unused;
    unsigned long long seed = 4;
    static scene s;
    static double x[2][3][50][3], load[2][MOST][6], work[WORK];
    static const int row[] = {SPARI_R_POSITION, SPARI_R_RATE, SPARI_R_ACCEL};
    for (int consistent = 0; consistent < 2; consistent++) {
        scene_start(&s, 2, 9, 50, &seed);
        for (int turn = 0; turn < 20; turn++) {
            fill(&s, consistent, SPARI_UPTO_ACCEL);
            for (int k = 0; k < 3; k++) {
                collect(&s, consistent, SPARI_UPTO_ACCEL, row[k], x[turn > 0][k]);
            }
            spari_gather_loads(s.set, s.modal, s.field, consistent, s.q[0], (spari_source){.d = s.force[0]},
                               (spari_source){.d = s.moment[0]}, work, load[turn > 0][0], NULL);
            if (turn > 0) {
                assert_memory_equal(x[0], x[1], sizeof x[0]);
                assert_memory_equal(load[0], load[1], sizeof(double) * 6 * 18);
            }
            for (int l = 0; l < 18; l++) {
                double sign = line_random(&seed) < 0 ? -1 : 1;
                for (int i = 3; i < 7; i++) {
                    s.q[l][i] *= sign;
                }
            }
        }
        scene_end(&s);
    }
}

/* ---- consistency in time ---- */

/* Place, velocity and acceleration of all fluid nodes when the member follows `swing`, its node velocities taken from
   Q(t) by differences so small in step (6th order, h = 1e-2: h^6 ~ 1e-12 times a seventh derivative) that they count as
   exact. */
static void at_time(scene *s, double t, double bend, int consistent, double (*x)[3], double (*v)[3], double (*a)[3]) {
    static double path[7][MOST][7];
    const double h = 1e-2;
    for (int k = 0; k < 7; k++) {
        set_motion(s, t + (k - 3) * h, bend);
        memcpy(path[k], s->q, sizeof s->q);
    }
    memcpy(s->q, path[3], sizeof s->q);
    static const double first[] = {-1. / 60, 3. / 20, -3. / 4, 0, 3. / 4, -3. / 20, 1. / 60};
    static const double second[] = {1. / 90, -3. / 20, 3. / 2, -49. / 18, 3. / 2, -3. / 20, 1. / 90};
    for (int l = 0; l < s->elements * s->nodes; l++) {
        double d[7] = {0}, dd[7] = {0}, back[4], w[4], z[4];
        for (int k = 0; k < 7; k++) {
            for (int i = 0; i < 7; i++) {
                d[i] += first[k] * path[k][l][i] / h, dd[i] += second[k] * path[k][l][i] / (h * h);
            }
        }
        spari_quat_conj(s->q[l] + 3, back);
        spari_quat_mul(d + 3, back, w);  /* omega = 2 vec(q' q*) */
        spari_quat_mul(dd + 3, back, z); /* alpha = 2 vec(q'' q*) */
        for (int i = 0; i < 3; i++) {
            s->v[l][i] = d[i], s->v[l][3 + i] = 2 * w[1 + i];
            s->a[l][i] = dd[i], s->a[l][3 + i] = 2 * z[1 + i];
        }
    }
    fill(s, consistent, SPARI_UPTO_ACCEL);
    collect(s, consistent, SPARI_UPTO_ACCEL, SPARI_R_POSITION, x);
    collect(s, consistent, SPARI_UPTO_ACCEL, SPARI_R_RATE, v);
    collect(s, consistent, SPARI_UPTO_ACCEL, SPARI_R_ACCEL, a);
}

/* Largest difference between (f(t+dt) - f(t-dt)) / 2 dt and g(t): of velocity to place, and acceleration to velocity.
 */
static void defects(scene *s, double dt, double bend, int consistent, double out[2]) {
    enum { N = 30 };
    static double x[3][N][3], v[3][N][3], a[3][N][3];
    for (int k = 0; k < 3; k++) {
        at_time(s, 0.3 + (k - 1) * dt, bend, consistent, x[k], v[k], a[k]);
    }
    out[0] = out[1] = 0;
    for (int j = 0; j < N; j++) {
        for (int i = 0; i < 3; i++) {
            out[0] = fmax(out[0], fabs((x[2][j][i] - x[0][j][i]) / (2 * dt) - v[1][j][i]));
            out[1] = fmax(out[1], fabs((v[2][j][i] - v[0][j][i]) / (2 * dt) - a[1][j][i]));
        }
    }
}

/* Consistent: the defects fall as dt^2, to nothing. Nodal: they stay, as normalising is not linear; how large they are
   for this bend is printed. One element of 4 nodes bends by 1.2 rad, so that interpolation has something to do. */
static void velocity_is_the_derivative_of_place(void **unused) {
    (void)unused;
    unsigned long long seed = 8;
    static scene s;
    scene_start(&s, 1, 4, 30, &seed);
    double coarse[2], fine[2], nodal[2];
    defects(&s, 0.02, 1.2, 1, coarse);
    defects(&s, 0.01, 1.2, 1, fine);
    for (int k = 0; k < 2; k++) {
        CLOSE(coarse[k] / fine[k], 4, 0.1);
    }
    defects(&s, 1e-4, 1.2, 1, fine);
    defects(&s, 1e-4, 1.2, 0, nodal);
    print_message(
        "bend 1.2 rad, 4 nodes: defect of velocity (of acceleration) consistent %.1e (%.1e), nodal %.1e (%.1e)\n",
        fine[0], fine[1], nodal[0], nodal[1]);
    assert_true(fine[0] < 1e-6 && fine[1] < 1e-6);
    assert_true(nodal[0] > 1e-5);
    scene_end(&s);
}

/* ---- loads in ---- */

/* The sums (T8) and (T9), and for the consistent kind the transpose phi_l (s_l I + [w_l]x) M_j. */
static void loads_by_formula(const scene *s, int consistent, int has_moment, double (*load)[6]) {
    memset(load, 0, sizeof *load * (size_t)(s->elements * s->nodes));
    for (int64_t j = 0; j < s->n; j++) {
        double phi[SPARI_MAX_NODES], m[3];
        state o;
        int first = s->element[j] * s->nodes;
        state_at(s, j, consistent, &o);
        basis_at(s, s->xi[j], phi);
        spari_cross(o.r, s->force[j], m);
        for (int i = 0; i < 3 && has_moment; i++) {
            m[i] += s->moment[j][i];
        }
        double sum[4] = {0}, sign[SPARI_MAX_NODES] = {1}, back[4];
        for (int l = 0; l < s->nodes; l++) {
            const double *q = s->q[first + l] + 3;
            sign[l] = l == 0 ? 1 : sign[l - 1] * (spari_quat_dot(q, s->q[first + l - 1] + 3) < 0 ? -1 : 1);
            for (int i = 0; i < 4; i++) {
                sum[i] += phi[l] * sign[l] * q[i];
            }
        }
        spari_quat_conj(sum, back);
        for (int l = 0; l < s->nodes; l++) {
            double p[4], c[3], square = spari_quat_dot(sum, sum);
            spari_quat_mul(s->q[first + l] + 3, back, p);
            for (int i = 0; i < 4; i++) {
                p[i] *= sign[l] / square;
            }
            spari_cross(p + 1, m, c);
            for (int i = 0; i < 3; i++) {
                load[first + l][i] += phi[l] * s->force[j][i];
                load[first + l][3 + i] += phi[l] * (consistent ? p[0] * m[i] + c[i] : m[i]);
            }
        }
    }
}

static void loads_are_the_formula(void **unused) {
    (void)unused;
    unsigned long long seed = 31;
    static scene s;
    static double want[MOST][6], got[MOST][6], work[WORK];
    for (int nodes = 1; nodes <= SPARI_MAX_NODES; nodes += nodes < 5 ? 1 : 5) {
        for (int n = 0; n <= 300; n += n < 18 ? 1 : 94) {
            int elements = nodes == 1 ? 1 : 1 + n % 3;
            scene_start(&s, elements, nodes, n, &seed);
            for (int kind = 0; kind < 4; kind++) {
                int consistent = kind % 2, has_moment = kind / 2;
                fill(&s, consistent, SPARI_UPTO_POSITION);
                loads_by_formula(&s, consistent, has_moment, want);
                for (size_t w = 0; w < sizeof widths / sizeof *widths; w++) {
                    s.set->lanes = widths[w];
                    spari_gather_loads(s.set, s.modal, s.field, consistent, s.q[0], (spari_source){.d = s.force[0]},
                                       (spari_source){.d = has_moment ? s.moment[0] : NULL}, work, got[0], NULL);
                    expect(got[0], want[0], 6 * elements * nodes, 1e-13 * (1 + n) * 10);
                }
            }
            scene_end(&s);
        }
    }
}

/* One node's shares in the line's nodes as kernel_bins.h has them, operation by operation: bits, not only numbers. */
static void shares_of(const scene *s, int64_t j, int consistent, int has_moment, double (*share)[6]) {
    double phi[SPARI_MAX_NODES], chained[4 * SPARI_MAX_NODES], t[SPARI_MAX_NODES] = {1, s->xi[j]}, Q[4], r[3], a[3],
                                                               b[3], m[3], w = 0;
    int P = s->nodes, few = consistent && P > 1;
    spari_chain(P, s->q[s->element[j] * P] + 3, 7, chained);
    for (int k = 2; k < P; k++) {
        t[k] = 2 * s->xi[j] * t[k - 1] - t[k - 2];
    }
    for (int l = 0; l < P; l++) {
        phi[l] = s->modal[l];
        for (int k = 1; k < P; k++) {
            phi[l] += t[k] * s->modal[k * P + l];
        }
    }
    for (int i = 0; i < 4; i++) {
        Q[i] = phi[0] * chained[i];
        for (int l = 1; l < P; l++) {
            Q[i] += phi[l] * chained[4 * l + i];
        }
    }
    double over = 1 / ((Q[0] * Q[0] + Q[1] * Q[1]) + (Q[2] * Q[2] + Q[3] * Q[3]));
    spari_cross(Q + 1, s->con[j], a);
    spari_cross(Q + 1, a, b);
    for (int i = 0; i < 3; i++) {
        r[i] = s->con[j][i] + 2 * over * (Q[0] * a[i] + b[i]);
    }
    spari_cross(r, s->force[j], m);
    for (int i = 0; i < 3 && has_moment; i++) {
        m[i] += s->moment[j][i];
    }
    if (few) {
        spari_cross(m, Q + 1, b);
        w = -(m[0] * Q[1] + m[1] * Q[2] + m[2] * Q[3]) * over;
        for (int i = 0; i < 3; i++) {
            m[i] = (m[i] * Q[0] + b[i]) * over;
        }
    }
    for (int l = 0; l < P; l++) {
        const double *q = chained + 4 * l;
        spari_cross(m, q + 1, b);
        for (int i = 0; i < 3; i++) {
            share[l][i] = phi[l] * s->force[j][i];
            share[l][3 + i] = phi[l] * (few ? (m[i] * q[0] - w * q[1 + i]) - b[i] : m[i]);
        }
    }
}

/* The nodes in another order. */
static void reorder(scene *s, unsigned long long *seed) {
    uint8_t *flags = calloc((size_t)s->n + 1, 1);
    for (int64_t i = s->n - 1; i > 0; i--) {
        int64_t j = (int64_t)(0.49999 * (1 + line_random(seed)) * (double)(i + 1));
        int e = s->element[i];
        double x = s->xi[i], t[3];
        s->element[i] = s->element[j], s->element[j] = e;
        s->xi[i] = s->xi[j], s->xi[j] = x;
        double(*all[])[3] = {s->con, s->force, s->moment};
        for (int k = 0; k < 3; k++) {
            memcpy(t, all[k][i], sizeof t);
            memcpy(all[k][i], all[k][j], sizeof t);
            memcpy(all[k][j], t, sizeof t);
        }
    }
    spari_nodes_free(s->set);
    s->set = spari_nodes_create(s->n, s->elements, s->nodes);
    spari_nodes_put(s->set, s->element, s->xi, s->n ? s->con[0] : NULL, flags);
    free(flags);
}

/* Reproducible loads: bit by bit the sums of the shares, whatever the width of the vectors and the order of the nodes;
   rounded, the loads above to the rounding of these. */
static void reproducible_loads(void **unused) {
    (void)unused;
    unsigned long long seed = 41;
    static scene s;
    static spari_bins want[MOST][6], got[MOST][6];
    static double plain[MOST][6], work[WORK], share[SPARI_MAX_NODES][6];
    for (int nodes = 1; nodes <= SPARI_MAX_NODES; nodes += nodes < 5 ? 1 : 5) {
        for (int n = 0; n <= 600; n += n < 18 ? 1 : 194) {
            int elements = nodes == 1 ? 1 : 1 + n % 3;
            scene_start(&s, elements, nodes, n, &seed);
            for (int64_t j = 0; j < n && n % 2; j++) { /* of all sizes */
                for (int i = 0; i < 3; i++) {
                    s.force[j][i] = ldexp(s.force[j][i], (int)(60 * line_random(&seed)));
                }
            }
            for (int kind = 0; kind < 4; kind++) {
                int consistent = kind % 2, has_moment = kind / 2, finite, size = 6 * elements * nodes;
                const spari_source force = {.d = s.force[0]}, moment = {.d = has_moment ? s.moment[0] : NULL};
                memset(want, 0, sizeof want);
                for (int64_t j = 0; j < n; j++) {
                    shares_of(&s, j, consistent, has_moment, share);
                    for (int l = 0; l < 6 * nodes; l++) {
                        spari_bins_add(want[s.element[j] * nodes + l / 6] + l % 6, share[l / 6][l % 6]);
                    }
                }
                for (size_t w = 0; w < sizeof widths / sizeof *widths; w++) {
                    s.set->lanes = widths[w];
                    spari_bin_loads(s.set, s.modal, consistent, s.q[0], force, moment, work, got[0], &finite);
                    assert_true(finite);
                    assert_memory_equal(got, want, (size_t)size * sizeof got[0][0]);
                    reorder(&s, &seed);
                }
                fill(&s, consistent, SPARI_UPTO_POSITION);
                spari_gather_loads(s.set, s.modal, s.field, consistent, s.q[0], (spari_source){.d = s.force[0]}, moment,
                                   work, plain[0], NULL);
                double most = 1;
                for (int64_t j = 0; j < 3 * n; j++) {
                    most = fmax(most, fabs(s.force[j / 3][j % 3]));
                }
                for (int i = 0; i < size; i++) {
                    CLOSE(spari_bins_value(&got[i / 6][i % 6]), plain[i / 6][i % 6], 1e-12 * (1 + n) * most);
                }
            }
            scene_end(&s);
        }
    }
}

/* A number that is none, or a share that is too large, is seen wherever it stands; lanes past the end are not. */
static void reproducible_loads_tell(void **unused) {
    (void)unused;
    enum { N = 300 };
    static const double bad[] = {NAN, INFINITY, -INFINITY, 1.7e308};
    unsigned long long seed = 42;
    static scene s;
    static spari_bins load[MOST][6];
    static double work[WORK];
    int finite;
    scene_start(&s, 2, 4, N, &seed);
    for (int j = 0; j < N; j++) {
        s.con[j][0] = s.con[j][1] = s.con[j][2] = 40 + j;
    }
    reorder(&s, &seed);
    for (int64_t j = 0; j < N; j += 7) {
        for (int k = 0; k < 4; k++) {
            s.set->lanes = widths[k % 3];
            double was = s.force[j][1];
            s.force[j][1] = bad[k];
            spari_bin_loads(s.set, s.modal, k % 2, s.q[0], (spari_source){.d = s.force[0]}, (spari_source){0}, work,
                            load[0], &finite);
            assert_false(finite);
            s.force[j][1] = was;
        }
        spari_bin_loads(s.set, s.modal, 0, s.q[0], (spari_source){.d = s.force[0]}, (spari_source){0}, work, load[0],
                        &finite);
        assert_true(finite);
    }
    scene_end(&s);
}

/* Force, moment about the origin and power on either side of the map, in the current configuration, relative to the
   sums of the sizes of their terms: nothing is lost but rounding. */
static void force_moment_and_power_are_kept(void **unused) {
    (void)unused;
    unsigned long long seed = 77;
    static scene s;
    static double load[MOST][6], work[WORK];
    for (int nodes = 1; nodes <= SPARI_MAX_NODES; nodes += nodes < 6 ? 1 : 3) {
        for (int kind = 0; kind < 12; kind++) {
            int consistent = kind % 2, elements = nodes == 1 ? 1 : 1 + kind % 5, n = 40 + 150 * (kind % 3);
            scene_start(&s, elements, nodes, n, &seed);
            s.set->lanes = widths[kind % 3];
            set_motion(&s, 0.1 * kind, 0.2 * kind); /* bent by up to 2.4 rad */
            fill(&s, consistent, SPARI_UPTO_RATE);
            spari_audit audit;
            spari_gather_loads(s.set, s.modal, s.field, consistent, s.q[0], (spari_source){.d = s.force[0]},
                               (spari_source){.d = s.moment[0]}, work, load[0], &audit);
            double in[7] = {0}, out[7] = {0}, size[3] = {0}, t[3];
            for (int64_t j = 0; j < n; j++) {
                state o;
                state_at(&s, j, consistent, &o);
                spari_cross(o.x, s.force[j], t);
                for (int i = 0; i < 3; i++) {
                    in[i] += s.force[j][i];
                    in[3 + i] += t[i] + s.moment[j][i];
                    in[6] += s.force[j][i] * o.v[i] + s.moment[j][i] * o.omega[i];
                }
                size[0] += spari_norm(s.force[j]);
                size[1] += spari_norm(s.force[j]) * (1 + spari_norm(o.x)) + spari_norm(s.moment[j]);
                size[2] += spari_norm(s.force[j]) * spari_norm(o.v) + spari_norm(s.moment[j]) * spari_norm(o.omega);
            }
            for (int l = 0; l < elements * nodes; l++) {
                double x[3] = {s.xr[l][0] + s.q[l][0], s.xr[l][1] + s.q[l][1], s.xr[l][2] + s.q[l][2]};
                spari_cross(x, load[l], t);
                for (int i = 0; i < 3; i++) {
                    out[i] += load[l][i];
                    out[3 + i] += t[i] + load[l][3 + i];
                    out[6] += load[l][i] * s.v[l][i] + load[l][3 + i] * s.v[l][3 + i];
                }
            }
            for (int i = 0; i < 7; i++) {
                double tolerance = 1e-13 * size[i < 3 ? 0 : i < 6 ? 1 : 2];
                CLOSE(out[i], in[i], tolerance);
                double seen = i < 3 ? audit.force[i] : i < 6 ? audit.moment[i - 3] : audit.power;
                CLOSE(seen, in[i], tolerance);
            }
            scene_end(&s);
        }
    }
}

/* Two nodes turned half a turn apart: halfway the quaternions cancel, and the kernel says so. */
static void rotations_that_cancel_are_seen(void **unused) {
    (void)unused;
    unsigned long long seed = 1;
    static scene s;
    static double buf[SPARI_ROWS][SPARI_ROW];
    scene_start(&s, 1, 2, 9, &seed);
    memset(s.q, 0, sizeof s.q);
    s.q[0][3] = 1, s.q[1][4] = 1;
    s.set->xi[4] = 0;
    fill(&s, 0, SPARI_UPTO_POSITION);
    double least = spari_tile_motion(s.set, 0, s.field, 0, SPARI_UPTO_POSITION, buf);
    CLOSE(least, 0.5, 1e-15); /* |(1,1,0,0)/2|^2: a half turn apart is still defined */
    s.q[1][3] = -1, s.q[1][4] = 0;
    s.field[SPARI_F_QUAT] = 0,
    s.field[SPARI_FIELDS + SPARI_F_QUAT] = 1; /* 1 at one end, -1 at the other, as no chain gives */
    for (int i = 1; i < 4; i++) {
        s.field[SPARI_F_QUAT + i] = s.field[SPARI_FIELDS + SPARI_F_QUAT + i] = 0;
    }
    least = spari_tile_motion(s.set, 0, s.field, 0, SPARI_UPTO_POSITION, buf);
    assert_true(least == 0);
    scene_end(&s);
}

/* Nodal values of a polynomial of degree P - 1 give its Chebyshev coefficients; T_k has the k-th unit vector. */
static void modal_matrix_knows_chebyshev(void **unused) {
    (void)unused;
    for (int n = 1; n <= SPARI_MAX_NODES; n++) {
        double m[SPARI_MAX_NODES * SPARI_MAX_NODES], x[SPARI_MAX_NODES];
        spari_modal_matrix(n, m);
        spari_gll(n, x, NULL, NULL);
        for (int k = 0; k < n; k++) {
            for (int j = 0; j < n; j++) {
                double c = 0;
                for (int l = 0; l < n; l++) {
                    c += m[j * n + l] * cos(k * acos(x[l]));
                }
                CLOSE(c, j == k, 1e-13);
            }
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(modal_matrix_knows_chebyshev),
        cmocka_unit_test(motion_is_the_formula),
        cmocka_unit_test(straight_as_by_tiles),
        cmocka_unit_test(any_count_of_nodes),
        cmocka_unit_test(rigid_motion_is_exact),
        cmocka_unit_test(signs_do_not_matter),
        cmocka_unit_test(velocity_is_the_derivative_of_place),
        cmocka_unit_test(loads_are_the_formula),
        cmocka_unit_test(reproducible_loads),
        cmocka_unit_test(reproducible_loads_tell),
        cmocka_unit_test(force_moment_and_power_are_kept),
        cmocka_unit_test(rotations_that_cancel_are_seen),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
