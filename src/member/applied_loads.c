/* Applied loads of a member beside dead nodal loads: description, forces and tangent. See applied_loads.h. */
#include "applied_loads.h"
#include "../base/environment.h"

#include "../math/basis.h"
#include "../math/resample.h"
#include "../math/rotation.h"
#include "beam.h"
#include "check_arguments.h"
#include "tangent.h"

#include <stdlib.h>
#include <string.h>

/* Kind of a line load beside SPAR_LOAD_DEAD and SPAR_LOAD_FOLLOWER. */
enum { SPARI_LINE_SPRINGS = 2 };
/* Maximum number of Gauss points of a load between two stations in an element. */
enum { LINE_POINTS = SPARI_MAX_NODES + 4 };

/* A distributed load, with its own quadrature points: it may jump where sections do not. */
typedef struct line_load {
    int *first;         /* [elements + 1] */
    double *phi;        /* [points][P] */
    double *load;       /* [points][6] times weight and Jacobian; global axes, at the reference if it follows */
    int64_t stations;   /* stations as given, for a rebuild with other nodes */
    double *eta, *said; /* [stations], [stations][6] */
} line_load;

struct spari_applied {
    double *follower;  /* [nodes][6], global axes at the reference; NULL: none */
    line_load line[2]; /* SPAR_LOAD_DEAD, SPAR_LOAD_FOLLOWER; first NULL: none */
};

/* Bits of loads that can be replaced. */
enum { RAMP_LINE = 1 << SPAR_LOAD_DEAD | 1 << SPAR_LOAD_FOLLOWER, RAMP_FOLLOWER = 4, RAMP_DEAD = 8, RAMP_ALL = 15 };

/* Loads at t^n of the kinds that the host has replaced since. */
struct spari_ramp {
    int changed;          /* RAMP_*, or 1 << kind of a line load */
    double left;          /* remaining fraction of the step at the current stage */
    double *dead;         /* [nodes][6]; NULL: never replaced */
    spari_applied before; /* of the kinds replaced; NULL there: none */
};

/* Springs to the ground along the line. The tangent is constant. Per element, for node pairs i <= j with j running:
   six entries (xx, xy, xz, yy, yz, zz) of the force on node i due to a displacement of node j, global axes. */
struct spari_foundation {
    double *pair; /* [elements][P (P + 1) / 2][6] */
};

static void line_free(line_load *line) {
    SPARI_FREE(line->first, line->phi, line->load, line->eta, line->said);
    memset(line, 0, sizeof *line);
}

static void empty(spari_applied *a) {
    free(a->follower);
    line_free(&a->line[0]);
    line_free(&a->line[1]);
}

void spari_applied_free(spari_applied *a) {
    if (a) {
        empty(a);
        free(a);
    }
}

void spari_ramp_free(spari_ramp *r) {
    if (r) {
        free(r->dead);
        empty(&r->before);
        free(r);
    }
}

/* ---- within a step ---- */

/* In the first step no earlier load exists. */
static int changes(const spar_member *m, int what) {
    return m->load.ramp && m->session->clock.step > 0 && (m->load.ramp->changed & what);
}

/* Weight of the loads at t^n. */
static double left_of(const spar_member *m, int what) {
    return changes(m, what) ? m->load.ramp->left : 0;
}

void spari_applied_at(const spar_member *m, double left) {
    if (m->load.ramp) {
        m->load.ramp->left = left;
    }
}

const double *spari_dead_before(const spar_member *m) {
    return changes(m, RAMP_DEAD) ? m->load.ramp->dead : m->load.dead;
}

/* ---- forces ---- */

/* Nodal quaternions of an element in one hemisphere; those of a linear member stay at the reference. */
static void element_field(const spar_member *m, const double *q, double z[][4]) {
    int linear = spari_member_is_linear_in_place(m);
    for (int l = 0; l < m->mesh.per_element; l++) {
        const double unit[4] = {1, 0, 0, 0}, *ql = linear ? unit : q + 7 * l + 3;
        double sign = l > 0 && spari_quat_dot(ql, z[l - 1]) < 0 ? -1 : 1;
        for (int i = 0; i < 4; i++) {
            z[l][i] = sign * ql[i];
        }
    }
}

/* Q/|Q| at a point; returns |Q|. */
static double point_rotation(int P, const double *phi, double z[][4], double r[4]) {
    double sum[4] = {0};
    for (int l = 0; l < P; l++) {
        for (int i = 0; i < 4; i++) {
            sum[i] += phi[l] * z[l][i];
        }
    }
    double N = sqrt(spari_quat_dot(sum, sum));
    for (int i = 0; i < 4; i++) {
        r[i] = sum[i] / N;
    }
    return N;
}

/* Present force and moment. */
static void load_now(const double *load, int follows, const double r[4], double f[3], double m[3]) {
    memcpy(f, load, 3 * sizeof *f);
    memcpy(m, load + 3, 3 * sizeof *m);
    if (follows) {
        spari_rotate(r, f, f);
        spari_rotate(r, m, m);
    }
}

static void pure_times(const double m[3], const double q[4], double c[4]) {
    double pure[4] = {0, m[0], m[1], m[2]};
    spari_quat_mul(pure, q, c);
}

/* g [P][7] += part * nodal forces and 4-vectors of one line load on element e */
SPARI_APART static void line_forces(const spar_member *m, const line_load *line, int follows, int e, double part,
                                    double z[][4], double *g) {
    int P = m->mesh.per_element;
    for (int k = line->first ? line->first[e] : 0; k < (line->first ? line->first[e + 1] : 0); k++) {
        const double *phi = line->phi + (int64_t)k * P;
        double r[4], f[3], c[3], m4[4], N = point_rotation(P, phi, z, r);
        load_now(line->load + 6 * (int64_t)k, follows, r, f, c);
        pure_times(c, r, m4);
        for (int l = 0; l < P; l++) {
            double w = part * phi[l];
            for (int i = 0; i < 3; i++) {
                g[7 * l + i] += w * f[i];
            }
            for (int i = 0; i < 4; i++) {
                g[7 * l + 3 + i] += 2 * w * m4[i] / N;
            }
        }
    }
}

static void symmetric_times(const double k[6], const double u[3], double f[3]) {
    f[0] = k[0] * u[0] + k[1] * u[1] + k[2] * u[2];
    f[1] = k[1] * u[0] + k[3] * u[1] + k[4] * u[2];
    f[2] = k[2] * u[0] + k[4] * u[1] + k[5] * u[2];
}

/* Doubles per element for node pairs. */
static int64_t pairs_of(const spar_member *m) {
    return 3 * (int64_t)m->mesh.per_element * (m->mesh.per_element + 1);
}

/* out [P][6] -= factor * spring forces, q [P][7]; returns the work done on the springs. */
static double element_springs(const spar_member *m, int e, const double *q, double factor, double *out) {
    const double *k = m->load.foundation->pair + pairs_of(m) * e;
    int P = m->mesh.per_element;
    double work = 0, back[3 * SPARI_MAX_NODES] = {0};
    for (int i = 0; i < P; i++) {
        for (int j = i; j < P; j++, k += 6) {
            double f[3], g[3];
            symmetric_times(k, q + 7 * j, f);
            symmetric_times(k, q + 7 * i, g);
            for (int c = 0; c < 3; c++) {
                back[3 * i + c] += f[c];
                back[3 * j + c] += i == j ? 0 : g[c];
            }
        }
    }
    for (int l = 0; l < P; l++) {
        work += 0.5 * spari_dot(q + 7 * l, back + 3 * l);
        for (int c = 0; c < 3 && out; c++) {
            out[6 * l + c] -= factor * back[3 * l + c];
        }
    }
    return work;
}

/* block (3 x 3 of a matrix with rows of `stride`) += factor * k */
static void add_springs_of(const double k[6], double factor, int stride, double *block) {
    const double row[3][3] = {{k[0], k[1], k[2]}, {k[1], k[3], k[4]}, {k[2], k[4], k[5]}};
    for (int r = 0; r < 3; r++) {
        for (int c = 0; c < 3; c++) {
            block[stride * r + c] += factor * row[r][c];
        }
    }
}

void spari_foundation_tangent(const spar_member *m, int e, double factor, double *S) {
    const double *k = m->load.foundation->pair + pairs_of(m) * e;
    int P = m->mesh.per_element, stride = 6 * P;
    for (int i = 0; i < P; i++) {
        for (int j = i; j < P; j++, k += 6) {
            add_springs_of(k, factor, stride, S + 6 * (stride * i + j));
            if (j > i) {
                add_springs_of(k, factor, stride, S + 6 * (stride * j + i));
            }
        }
    }
}

/* Whether springs are separate forces: a linear member has them in its matrix. */
static int springs_apart(const spar_member *m) {
    return m->load.foundation && m->frame != SPARI_FRAME_LINEAR;
}

/* out [P][6] += factor * loads `follower` of element e, rotated with its nodes */
static void add_followers(const spar_member *m, int e, const double *follower, double factor, double z[][4],
                          double *out) {
    int P = m->mesh.per_element;
    for (int l = 0; l < P && follower && factor != 0; l++) {
        double f[3], t[3];
        load_now(follower + 6 * ((int64_t)e * P + l), 1, z[l], f, t);
        for (int i = 0; i < 3; i++) {
            out[6 * l + i] += factor * f[i];
            out[6 * l + 3 + i] += factor * t[i];
        }
    }
}

/* out [P][6] += factor * loads of element e for the state q [P][7] of its nodes, without springs; lines: with those
   along the line */
static void element_loads(const spar_member *m, int e, const double *q, int lines, double factor, double *out) {
    const spari_applied *a = m->load.applied;
    int P = m->mesh.per_element;
    double z[SPARI_MAX_NODES][4], g[7 * SPARI_MAX_NODES] = {0};
    if (!a) {
        return;
    }
    element_field(m, q, z);
    for (int k = 0; k < 2 && lines; k++) {
        double left = left_of(m, 1 << k);
        line_forces(m, &a->line[k], k == SPAR_LOAD_FOLLOWER, e, 1 - left, z, g);
        if (left > 0) {
            line_forces(m, &m->load.ramp->before.line[k], k == SPAR_LOAD_FOLLOWER, e, left, z, g);
        }
    }
    for (int l = 0; l < P; l++) {
        double c[4], p[4];
        spari_quat_conj(z[l], c);
        spari_quat_mul(g + 7 * l + 3, c, p); /* delta q . g = delta theta . 1/2 Im(g q*) */
        for (int i = 0; i < 3; i++) {
            out[6 * l + i] += factor * g[7 * l + i];
            out[6 * l + 3 + i] += factor * 0.5 * p[1 + i];
        }
    }
    double left = left_of(m, RAMP_FOLLOWER);
    add_followers(m, e, a->follower, (1 - left) * factor, z, out);
    if (left > 0) {
        add_followers(m, e, m->load.ramp->before.follower, left * factor, z, out);
    }
}

const double *spari_applied_follower(const spar_member *m) {
    return m->load.applied ? m->load.applied->follower : NULL;
}

double spari_applied_residual(const spar_member *m, const double *q, double factor, double *r) {
    int P = m->mesh.per_element;
    double largest = 0, out[6 * SPARI_MAX_NODES];
    for (int e = 0; e < m->mesh.elements; e++) {
        int64_t first = (int64_t)e * (P - 1);
        memset(out, 0, sizeof out);
        element_loads(m, e, q + 7 * first, 1, factor, out);
        if (springs_apart(m)) {
            (void)element_springs(m, e, q + 7 * first, factor, out);
        }
        for (int i = 0; i < 6 * P; i++) {
            r[6 * first + i] -= out[i];
            largest = fmax(largest, fabs(out[i]));
        }
    }
    return largest;
}

static void nodal_loads(const spar_member *m, const double *q, int lines, double *load) {
    for (int e = 0; e < m->mesh.elements; e++) {
        int64_t first = (int64_t)e * m->mesh.per_element;
        element_loads(m, e, q + 7 * first, lines, 1, load + 6 * first);
    }
    if (m->load.foundation) {
        spari_foundation_nodal(m, q, 1, load);
    }
}

void spari_applied_nodal(const spar_member *m, const double *q, double *load) {
    nodal_loads(m, q, 1, load);
}

void spari_applied_nodal_but_lines(const spar_member *m, const double *q, double *load) {
    nodal_loads(m, q, 0, load);
}

/* ---- beyond a section ---- */

/* Part of element e between load stations i and i + 1, in its coordinate. Returns the number of its Gauss points. */
static int load_interval(const spar_member *m, int e, int64_t n, const double *eta, int64_t i, double *from,
                         double *to) {
    const double E = m->mesh.elements;
    *from = n == 1 ? -1 : fmax(2 * (eta[i] * E - e) - 1, -1);
    *to = n == 1 ? 1 : fmin(2 * (eta[i + 1] * E - e) - 1, 1);
    /* the whole element: degree 2 P + 1 */
    return *to - *from < 1e-12 ? 0 : 2 + (int)ceil(0.5 * (*to - *from) * (m->mesh.per_element - 1) - 1e-9);
}

/* Lagrange basis on n Gauss points. */
static void gauss_basis(int n, const double *x, double at, double *phi) {
    for (int k = 0; k < n; k++) {
        phi[k] = 1;
        for (int j = 0; j < n; j++) {
            phi[k] *= j == k ? 1 : (at - x[j]) / (x[k] - x[j]);
        }
    }
}

/* One element beyond a section, and the sum of forces and moments about the section. */
typedef struct beyond {
    int P;
    double gll[SPARI_MAX_NODES], bary[SPARI_MAX_NODES], xi, origin[3], sum[6];
    const double *x; /* [P][3] */
} beyond;

static void position_at(const beyond *b, const double *phi, double x[3]) {
    memset(x, 0, 3 * sizeof *x);
    for (int l = 0; l < b->P; l++) {
        for (int c = 0; c < 3; c++) {
            x[c] += phi[l] * b->x[3 * l + c];
        }
    }
}

static void add_at(beyond *b, const double *phi, double factor, const double force[6]) {
    double x[3], moment[3];
    position_at(b, phi, x);
    const double arm[3] = {x[0] - b->origin[0], x[1] - b->origin[1], x[2] - b->origin[2]};
    spari_cross(arm, force, moment);
    for (int c = 0; c < 3; c++) {
        b->sum[c] += factor * force[c];
        b->sum[3 + c] += factor * (force[3 + c] + moment[c]);
    }
}

/* Part of one line load. The interval in which the section lies has the polynomial through its Gauss points: from the
   beginning of the interval on, its integral is their sum. */
SPARI_APART static void line_beyond(const spar_member *m, const line_load *line, int follows, int e, double part,
                                    double z[][4], beyond *b) {
    const int64_t n = line->stations;
    double gx[LINE_POINTS], gw[LINE_POINTS], px[LINE_POINTS], pw[LINE_POINTS], load[LINE_POINTS][6], from, to;
    double shape[SPARI_MAX_NODES], on[LINE_POINTS], r[4];
    int k = line->first ? line->first[e] : 0;
    for (int64_t i = 0; line->first && i < (n == 1 ? 1 : n - 1); i++) {
        const int points = load_interval(m, e, n, line->eta, i, &from, &to);
        const double start = fmax(from, b->xi), half = 0.5 * (to - start);
        for (int g = 0; g < points; g++, k++) {
            const double *phi = line->phi + (int64_t)k * b->P;
            (void)point_rotation(b->P, phi, z, r);
            load_now(line->load + 6 * (int64_t)k, follows, r, load[g], load[g] + 3);
            if (start <= from) {
                add_at(b, phi, part, load[g]);
            }
        }
        if (points == 0 || start <= from || to <= start) {
            continue;
        }
        spari_gauss(points, gx, gw);
        spari_gauss(LINE_POINTS, px, pw); /* exact: the line and the load are polynomials */
        for (int p = 0; p < LINE_POINTS; p++) {
            const double at = start + half * (1 + px[p]);
            double force[6] = {0};
            gauss_basis(points, gx, (2 * at - from - to) / (to - from), on);
            for (int g = 0; g < points; g++) {
                for (int c = 0; c < 6; c++) {
                    force[c] += on[g] * load[g][c] / gw[g];
                }
            }
            spari_lagrange(b->P, b->gll, b->bary, at, shape, NULL);
            add_at(b, shape, part * 2 * half / (to - from) * pw[p], force);
        }
    }
}

void spari_applied_lines_beyond(const spar_member *m, const double *q, const double *x, int e, double xi,
                                double force[6]) {
    const spari_applied *a = m->load.applied;
    const int P = m->mesh.per_element;
    double z[SPARI_MAX_NODES][4], phi[SPARI_MAX_NODES];
    beyond b = {.P = P, .xi = xi, .x = x + 3 * (int64_t)e * P};
    if (!a) {
        return;
    }
    spari_gll(P, b.gll, NULL, b.bary);
    spari_lagrange(P, b.gll, b.bary, xi, phi, NULL);
    position_at(&b, phi, b.origin);
    element_field(m, q + 7 * (int64_t)e * P, z);
    for (int k = 0; k < 2; k++) {
        const double left = left_of(m, 1 << k);
        line_beyond(m, &a->line[k], k == SPAR_LOAD_FOLLOWER, e, 1 - left, z, &b);
        if (left > 0) {
            line_beyond(m, &m->load.ramp->before.line[k], k == SPAR_LOAD_FOLLOWER, e, left, z, &b);
        }
    }
    for (int k = 0; k < 6; k++) {
        force[k] += b.sum[k];
    }
}

int spari_applied_potential(const spar_member *m) {
    const spari_applied *a = m->load.applied;
    if (!a) {
        return 1;
    }
    const line_load *dead = &a->line[SPAR_LOAD_DEAD];
    int moments = 0;
    for (int k = 0; dead->first && k < dead->first[m->mesh.elements]; k++) {
        moments |= spari_norm(dead->load + 6 * (int64_t)k + 3) > 0;
    }
    return !a->follower && !a->line[SPAR_LOAD_FOLLOWER].first && !moments;
}

int spari_applied_across(const spar_member *m, const double axis[3]) {
    const line_load *dead = m->load.applied ? &m->load.applied->line[SPAR_LOAD_DEAD] : NULL;
    int across = 0;
    for (int k = 0; dead && dead->first && k < 2 * dead->first[m->mesh.elements]; k++) {
        across = across || spari_across(axis, dead->load + 3 * (int64_t)k);
    }
    return across;
}

/* ---- tangent ---- */

/* S (rows at row, columns at col) += f * skew(a) */
static void add_skew(double *S, int stride, int row, int col, double f, const double a[3]) {
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        S[stride * (row + i) + col + j] -= f * a[k];
        S[stride * (row + i) + col + k] += f * a[j];
    }
}

/* X (7 x 4) = d (force, 4-vector) / dQ at a point, per phi_i phi_j */
static void point_tangent(const double *load, int follows, const double r[4], double N, double X[7][4]) {
    double f[3], m[3], conj[4], mr[4], rm[4];
    load_now(load, follows, r, f, m);
    pure_times(m, r, mr);
    double body[4] = {0, load[3], load[4], load[5]};
    spari_quat_mul(r, body, rm);
    spari_quat_conj(r, conj);
    for (int j = 0; j < 4; j++) {
        double d[4] = {0}, turn[4], df[3] = {0}, dm[4];
        d[j] = 1;
        if (follows) { /* d(R f) = d theta x R f; 2 Q m/N^2 */
            spari_quat_mul(d, conj, turn);
            spari_cross(turn + 1, f, df);
            spari_quat_mul(d, body, dm);
        } else { /* 2 m Q/N^2 */
            pure_times(m, d, dm);
        }
        const double *at = follows ? rm : mr;
        for (int i = 0; i < 3; i++) {
            X[i][j] = 2 * df[i] / N;
        }
        for (int i = 0; i < 4; i++) {
            X[3 + i][j] = (2 * dm[i] - 4 * at[i] * r[j]) / (N * N);
        }
    }
}

/* The forces of the load turn with its nodes. */
SPARI_APART static void turned_forces_tangent(const spar_member *m, const line_load *line, int follows, int e,
                                              double z[][4], double factor, double *S) {
    int P = m->mesh.per_element, stride = 6 * P;
    double g[7 * SPARI_MAX_NODES] = {0};
    line_forces(m, line, follows, e, 1, z, g);
    for (int l = 0; l < P; l++) {
        spari_turned_force(-factor, g + 7 * l + 3, z[l], S + (stride + 1) * (6 * l + 3), stride);
    }
}

/* Block S of nodes i and j -= w (force, E_i^T 4-vector) for the derivatives Y (7 x 3) with respect to node j. */
static void add_block(double w, double Y[7][3], double Ei[4][3], int stride, double *S) {
    for (int c = 0; c < 3; c++) {
        for (int r = 0; r < 3; r++) {
            double turn = 0;
            for (int k = 0; k < 4; k++) {
                turn += Ei[k][r] * Y[3 + k][c];
            }
            S[stride * r + 3 + c] -= w * Y[r][c];
            S[stride * (3 + r) + 3 + c] -= w * turn;
        }
    }
}

SPARI_APART static void line_tangent(const spar_member *m, const line_load *line, int follows, int e, double z[][4],
                                     double factor, double *S) {
    int P = m->mesh.per_element, stride = 6 * P;
    double E[SPARI_MAX_NODES][4][3];
    if (!line->first || factor == 0) {
        return;
    }
    for (int l = 0; l < P; l++) {
        spari_half_turns(z[l], E[l]);
    }
    for (int k = line->first[e]; k < line->first[e + 1]; k++) {
        const double *phi = line->phi + (int64_t)k * P;
        double r[4], X[7][4], Y[7][3], N = point_rotation(P, phi, z, r);
        point_tangent(line->load + 6 * (int64_t)k, follows, r, N, X);
        for (int j = 0; j < P; j++) {
            for (int i = 0; i < 21; i++) {
                const double *x = X[i / 3];
                int c = i % 3;
                Y[i / 3][c] = x[0] * E[j][0][c] + x[1] * E[j][1][c] + x[2] * E[j][2][c] + x[3] * E[j][3][c];
            }
            for (int i = 0; i < P; i++) {
                add_block(factor * phi[i] * phi[j], Y, E[i], stride, S + 6 * (stride * i + j));
            }
        }
    }
    turned_forces_tangent(m, line, follows, e, z, factor, S);
}

static void follower_tangent(const spar_member *m, int e, const double *follower, double factor, double z[][4],
                             double *S) {
    int P = m->mesh.per_element;
    for (int l = 0; l < P && follower && factor != 0; l++) {
        double f[3], t[3];
        load_now(follower + 6 * ((int64_t)e * P + l), 1, z[l], f, t);
        add_skew(S, 6 * P, 6 * l, 6 * l + 3, factor, f); /* -d(R f) = -dtheta x R f */
        add_skew(S, 6 * P, 6 * l + 3, 6 * l + 3, factor, t);
    }
}

void spari_applied_tangent(const spar_member *m, int e, const double *q, double factor, double *S) {
    const spari_applied *a = m->load.applied;
    int P = m->mesh.per_element;
    if (m->load.foundation) {
        spari_foundation_tangent(m, e, factor, S);
    }
    if (!a) {
        return;
    }
    double z[SPARI_MAX_NODES][4];
    element_field(m, q + 7 * (int64_t)e * (P - 1), z);
    for (int k = 0; k < 2; k++) {
        double left = left_of(m, 1 << k);
        line_tangent(m, &a->line[k], k == SPAR_LOAD_FOLLOWER, e, z, (1 - left) * factor, S);
        if (left > 0) {
            line_tangent(m, &m->load.ramp->before.line[k], k == SPAR_LOAD_FOLLOWER, e, z, left * factor, S);
        }
    }
    double left = left_of(m, RAMP_FOLLOWER);
    follower_tangent(m, e, a->follower, (1 - left) * factor, z, S);
    if (left > 0) {
        follower_tangent(m, e, m->load.ramp->before.follower, left * factor, z, S);
    }
}

/* Gauss points of element e, piecewise between load stations. s NULL: only counts. Eta and weight of a point are
   stored beside it. */
static int load_points(const spar_member *m, int e, int64_t n, const double *eta, spari_station *s, double *w,
                       double *at) {
    double gx[LINE_POINTS], gw[LINE_POINTS], from, to;
    int count = 0, whole = n == 1;
    for (int64_t i = 0; i < (whole ? 1 : n - 1); i++) {
        const int points = load_interval(m, e, n, eta, i, &from, &to);
        double half = 0.5 * (to - from);
        if (points == 0) {
            continue;
        }
        spari_gauss(points, gx, gw);
        for (int k = 0; k < points && s; k++) {
            s[count + k].element = e;
            s[count + k].xi = from + half * (1 + gx[k]);
            w[count + k] = half * gw[k];
            double where = 0.5 * (1 + spari_member_xi(m, e, s[count + k].xi));
            at[count + k] = whole ? 0 : (double)i + fmin(fmax((where - eta[i]) / (eta[i + 1] - eta[i]), 0), 1 - 1e-16);
        }
        count += points;
    }
    return count;
}

/* Converts stiffnesses along the section's axes, the columns of R, to the six entries of their matrix. */
static void rotate_springs(const double R[9], double k[6]) {
    const double own[3] = {k[0], k[1], k[2]};
    static const int row[6] = {0, 0, 0, 1, 1, 2}, column[6] = {0, 1, 2, 1, 2, 2};
    for (int i = 0; i < 6; i++) {
        const double *a = R + 3 * row[i], *b = R + 3 * column[i];
        k[i] = own[0] * a[0] * b[0] + own[1] * a[1] * b[1] + own[2] * a[2] * b[2];
    }
}

static int line_build(const spar_member *m, int kind, int64_t n, const double *eta, const double *load,
                      line_load *line) {
    int E = m->mesh.elements, P = m->mesh.per_element, points = 0;
    for (int e = 0; e < E; e++) {
        points += load_points(m, e, n, eta, NULL, NULL, NULL);
    }
    spari_station *s = spari_zalloc(points, sizeof *s);
    double *w = spari_zalloc(2 * (int64_t)points, sizeof *w), *at = w + points;
    line->first = spari_zalloc(E + 1, sizeof *line->first);
    line->phi = spari_zalloc((int64_t)points * P, sizeof *line->phi);
    line->load = spari_zalloc((int64_t)points * 6, sizeof *line->load);
    int ok = s && w && line->first && line->phi && line->load;
    for (int e = 0; e < E && ok; e++) {
        int k = line->first[e];
        line->first[e + 1] = k + load_points(m, e, n, eta, s + k, w + k, at + k);
    }
    ok = ok && spari_beam_stations(m, points, s) == SPAR_OK;
    for (int k = 0; k < points && ok; k++) {
        int64_t i = (int64_t)at[k];
        double f = at[k] - (double)i, *to = line->load + 6 * (int64_t)k;
        for (int c = 0; c < 6; c++) {
            to[c] = w[k] * s[k].jacobian * ((1 - f) * load[6 * i + c] + (f > 0 ? f * load[6 * (i + 1) + c] : 0));
        }
        if (kind == SPAR_LOAD_FOLLOWER) {
            spari_matrix_times(s[k].R, to, to);
            spari_matrix_times(s[k].R, to + 3, to + 3);
        } else if (kind == SPARI_LINE_SPRINGS) {
            rotate_springs(s[k].R, to);
        }
        memcpy(line->phi + (int64_t)k * P, s[k].phi, (size_t)P * sizeof *line->phi);
    }
    SPARI_FREE(s, w);
    if (!ok) {
        line_free(line);
        return spari_fail(m->session, SPAR_ERR_MEMORY, "no memory for the loads of '%s'", m->name);
    }
    return SPAR_OK;
}

/* The same, and keeps the stations as given. */
static int line_set(const spar_member *m, int kind, int64_t n, const double *eta, const double *load, line_load *line) {
    SPARI_TRY(line_build(m, kind, n, eta, load, line));
    line->stations = n;
    line->eta = spari_copy(eta, n);
    line->said = spari_copy(load, 6 * n);
    if (!line->eta || !line->said) {
        line_free(line);
        return spari_fail(m->session, SPAR_ERR_MEMORY, "no memory for the loads of '%s'", m->name);
    }
    return SPAR_OK;
}

/* ---- save and load ---- */

static void put_applied(const spar_member *m, const spari_applied *a, spari_image *image) {
    spari_image_put_int(image, a->follower != NULL);
    spari_image_put(image, a->follower, a->follower ? 6 * m->nodes : 0);
    for (int k = 0; k < 2; k++) {
        const line_load *line = &a->line[k];
        spari_image_put_int(image, line->stations);
        spari_image_put(image, line->eta, line->stations);
        spari_image_put(image, line->said, 6 * line->stations);
    }
}

/* Words of the state, in order: whether follower loads exist; which kinds were replaced since t^n, with their dead
   loads and other loads at t^n; whether new loads exist, and these. Loads are: whether there are followers, and
   these; for each line load its stations (0: none), with eta and values. */
void spari_applied_save(const spar_member *m, spari_image *image) {
    int64_t at = image->count;
    int changed = changes(m, RAMP_ALL) ? m->load.ramp->changed : 0;
    spari_image_put_int(image, 0);
    if (m->load.applied || changed) {
        spari_image_put_int(image, changed);
        spari_image_put(image, changed & RAMP_DEAD ? m->load.ramp->dead : NULL, changed & RAMP_DEAD ? 6 * m->nodes : 0);
        if (changed & ~RAMP_DEAD) {
            put_applied(m, &m->load.ramp->before, image);
        }
        spari_image_put_int(image, m->load.applied != NULL);
        if (m->load.applied) {
            put_applied(m, m->load.applied, image);
        }
    }
    if (!image->failed) {
        image->word[at] = (uint64_t)(image->count - at - 1);
    }
}

/* Copies n doubles of the image; NULL if there are none, or no memory */
static double *take(spari_image *image, int64_t n) {
    const uint64_t *from = spari_image_get(image, n);
    double *x = from ? spari_zalloc(n, sizeof *x) : NULL;
    if (x && n > 0) {
        memcpy(x, from, (size_t)n * sizeof *x);
    }
    image->no_memory |= from && !x;
    image->failed |= !x;
    return x;
}

static void take_line(const spar_member *m, spari_image *image, int kind, line_load *line) {
    const double slack = 1e-9;
    int64_t n = spari_image_get_int(image);
    if (n == 0 || image->failed) {
        return;
    }
    image->failed = n < 0 || n > SPARI_MOST;
    double *eta = image->failed ? NULL : take(image, n), *load = image->failed ? NULL : take(image, 6 * n);
    for (int64_t i = 0; i < n && !image->failed; i++) {
        image->failed = !(eta[i] >= (i > 0 ? eta[i - 1] : -slack) && eta[i] <= 1 + slack);
    }
    if (!image->failed) {
        image->failed = image->no_memory = line_set(m, kind, n, eta, load, line) != SPAR_OK;
    }
    SPARI_FREE(eta, load);
}

static void take_applied(const spar_member *m, spari_image *image, spari_applied *a) {
    a->follower = spari_image_get_int(image) ? take(image, 6 * m->nodes) : NULL;
    for (int k = 0; k < 2 && !image->failed; k++) {
        take_line(m, image, k, &a->line[k]);
    }
}

static void take_ramp(spar_member *m, spari_image *image) {
    int64_t changed = spari_image_get_int(image);
    image->failed |= changed < 0 || changed > RAMP_ALL;
    if (changed == 0 || image->failed) {
        return;
    }
    spari_ramp *r = m->load.ramp_next = spari_zalloc(1, sizeof *r);
    if (!r) {
        image->failed = image->no_memory = 1;
        return;
    }
    r->changed = (int)changed;
    r->dead = changed & RAMP_DEAD ? take(image, 6 * m->nodes) : NULL;
    if ((changed & ~RAMP_DEAD) && !image->failed) {
        take_applied(m, image, &r->before);
    }
}

void spari_applied_check(spar_member *m, spari_image *image) {
    spari_applied_free(m->load.applied_next);
    spari_ramp_free(m->load.ramp_next);
    m->load.applied_next = NULL;
    m->load.ramp_next = NULL;
    int64_t count = spari_image_get_int(image), begin = image->at;
    if (count == 0 || image->failed) {
        return;
    }
    take_ramp(m, image);
    if (!image->failed && spari_image_get_int(image)) {
        m->load.applied_next = spari_zalloc(1, sizeof *m->load.applied_next);
        image->failed = image->no_memory = !m->load.applied_next;
    }
    if (m->load.applied_next) {
        take_applied(m, image, m->load.applied_next);
    }
    /* replaced loads must exist; the count also allows skipping them */
    image->failed |= (m->load.ramp_next && (m->load.ramp_next->changed & ~RAMP_DEAD) && !m->load.applied_next) ||
                     image->at - begin != count;
}

void spari_applied_load(spar_member *m, spari_image *image) {
    spari_image_get(image, spari_image_get_int(image));
    spari_applied_free(m->load.applied);
    spari_ramp_free(m->load.ramp);
    m->load.applied = m->load.applied_next;
    m->load.ramp = m->load.ramp_next;
    m->load.applied_next = NULL;
    m->load.ramp_next = NULL;
}

/* ---- set by the host ---- */

static int need_applied(spar_member *member, const char *call) {
    SPARI_TRY(spari_need_committed(member, call));
    if (!member->load.applied) {
        member->load.applied = spari_zalloc(1, sizeof *member->load.applied);
    }
    SPARI_REQUIRE(member->session, member->load.applied, SPAR_ERR_MEMORY, "%s: no memory for the loads of '%s'", call,
                  member->name);
    return SPAR_OK;
}

static int need_kind(const spar_member *m, const char *call, int kind) {
    SPARI_REQUIRE(m->session, kind == SPAR_LOAD_DEAD || kind == SPAR_LOAD_FOLLOWER, SPAR_ERR_ARGUMENT,
                  "%s: '%s': load kind %d is not known; see SPAR_LOAD_*", call, m->name, kind);
    return SPAR_OK;
}

/* Frees the loads if none is applied any more, now or at t^n. */
static void drop_empty(spar_member *m) {
    spari_applied *a = m->load.applied;
    int any = a->line[0].first || a->line[1].first || changes(m, RAMP_LINE | RAMP_FOLLOWER);
    for (int64_t i = 0; a->follower && i < 6 * m->nodes && !any; i++) {
        any = a->follower[i] != 0;
    }
    if (!any) {
        spari_applied_free(a);
        m->load.applied = NULL;
    }
}

/* Copies `from` [nodes][6] to *to, which is allocated if NULL; from NULL: zeros. */
static int keep_loads(const spar_member *m, const char *call, const double *from, double **to) {
    size_t size = (size_t)(6 * m->nodes) * sizeof **to;
    *to = *to ? *to : spari_zalloc(6 * m->nodes, sizeof **to);
    SPARI_REQUIRE(m->session, *to, SPAR_ERR_MEMORY, "%s: no memory for the loads of '%s'", call, m->name);
    if (from) {
        memcpy(*to, from, size);
    } else {
        memset(*to, 0, size);
    }
    return SPAR_OK;
}

/* Keeps the loads of a kind at t^n before they are replaced, except before the first step. After a failure nothing
   has changed. */
static int keep_before(spar_member *m, const char *call, int what) {
    if (m->session->clock.step == 0 || changes(m, what)) {
        return SPAR_OK;
    }
    spari_ramp *r = m->load.ramp = m->load.ramp ? m->load.ramp : spari_zalloc(1, sizeof *m->load.ramp);
    SPARI_REQUIRE(m->session, r, SPAR_ERR_MEMORY, "%s: no memory for the loads of '%s'", call, m->name);
    if (what == RAMP_DEAD) {
        SPARI_TRY(keep_loads(m, call, m->load.dead, &r->dead));
    } else if (what == RAMP_FOLLOWER) {
        SPARI_TRY(keep_loads(m, call, m->load.applied ? m->load.applied->follower : NULL, &r->before.follower));
    } else {
        line_free(&r->before.line[what >> 1]);
    }
    r->changed |= what;
    return SPAR_OK;
}

void spari_applied_accept(spar_member *m) {
    spari_ramp *r = m->load.ramp;
    if (!r || !r->changed) {
        return;
    }
    r->changed = 0;
    r->left = 0;
    line_free(&r->before.line[0]);
    line_free(&r->before.line[1]);
    if (m->load.applied) {
        drop_empty(m);
    }
}

static int set_follower(spar_member *member, const char *call, int64_t node, const double load[6]) {
    SPARI_TRY(need_applied(member, call));
    spari_applied *a = member->load.applied;
    double turned[6];
    spari_rotate(member->qr + 4 * node, load, turned);
    spari_rotate(member->qr + 4 * node, load + 3, turned + 3);
    int same = a->follower && memcmp(a->follower + 6 * node, turned, sizeof turned) == 0;
    int status = same ? SPAR_OK : keep_before(member, call, RAMP_FOLLOWER);
    status = status == SPAR_OK && !a->follower ? keep_loads(member, call, NULL, &a->follower) : status;
    if (status == SPAR_OK) {
        memcpy(a->follower + 6 * node, turned, sizeof turned);
    }
    drop_empty(member);
    return status;
}

int spar_member_set_load(spar_member *member, int64_t node, int kind, const double load[6]) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_TRY(spari_need_committed(member, __func__));
    SPARI_REQUIRE(member->session, node >= 0 && node < member->nodes, SPAR_ERR_ARGUMENT,
                  "%s: '%s' has nodes 0 to %lld; there is no node %lld", __func__, member->name,
                  (long long)member->nodes - 1, (long long)node);
    SPARI_TRY(need_kind(member, __func__, kind));
    SPARI_TRY(spari_need_finite(member->session, __func__, member->name, "load", 6, load));
    if (kind == SPAR_LOAD_FOLLOWER) {
        return set_follower(member, __func__, node, load);
    }
    if (memcmp(member->load.dead + 6 * node, load, 6 * sizeof *load) != 0) {
        SPARI_TRY(keep_before(member, __func__, RAMP_DEAD));
        memcpy(member->load.dead + 6 * node, load, 6 * sizeof *load);
    }
    return SPAR_OK;
}

/* ---- rebuild with other nodes ---- */

static int rebuild_loads(const spar_member *from, const spar_member *m, const double *was, double **is) {
    *is = was ? spari_zalloc(6 * m->nodes, sizeof **is) : NULL;
    if (*is) {
        spari_resample_loads(from->mesh, m->mesh, was, *is);
    }
    return *is || !was ? SPAR_OK : SPAR_ERR_MEMORY;
}

static int rebuild(const spar_member *from, const spar_member *m, const spari_applied *a, spari_applied *b) {
    SPARI_TRY(rebuild_loads(from, m, a->follower, &b->follower));
    for (int k = 0; k < 2; k++) {
        const line_load *line = a->line + k;
        SPARI_TRY(line->first ? line_set(m, k, line->stations, line->eta, line->said, &b->line[k]) : SPAR_OK);
    }
    return SPAR_OK;
}

static int rebuild_ramp(const spar_member *from, spar_member *m) {
    spari_ramp *r = m->load.ramp = spari_zalloc(1, sizeof *r);
    SPARI_TRY(r ? rebuild_loads(from, m, from->load.ramp->dead, &r->dead) : SPAR_ERR_MEMORY);
    r->changed = from->load.ramp->changed;
    return rebuild(from, m, &from->load.ramp->before, &r->before);
}

int spari_applied_rebuild(const spar_member *from, spar_member *m) {
    int status = SPAR_OK;
    if (from->load.applied) {
        m->load.applied = spari_zalloc(1, sizeof *m->load.applied);
        status = m->load.applied ? rebuild(from, m, from->load.applied, m->load.applied) : SPAR_ERR_MEMORY;
    }
    if (status == SPAR_OK && from->load.ramp && from->load.ramp->changed) {
        status = rebuild_ramp(from, m);
    }
    SPARI_REQUIRE(m->session, status == SPAR_OK, status, "no memory for the loads of a trial of '%s'", m->name);
    return SPAR_OK;
}

/* ---- foundation ---- */

void spari_foundation_free(spari_foundation *f) {
    if (f) {
        free(f->pair);
    }
    free(f);
}

void spari_foundation_nodal(const spar_member *m, const double *q, double factor, double *load) {
    for (int e = 0; e < m->mesh.elements; e++) {
        int64_t first = (int64_t)e * m->mesh.per_element;
        (void)element_springs(m, e, q + 7 * first, factor, load + 6 * first);
    }
}

double spari_foundation_energy(const spar_member *m, const double *q) {
    double sum = 0;
    for (int e = 0; e < m->mesh.elements; e++) {
        sum += element_springs(m, e, q + 7 * (int64_t)e * m->mesh.per_element, 0, NULL);
    }
    return sum;
}

/* Converts stiffness at points to node pairs. */
static void gather_pairs(const spar_member *m, const line_load *line, double *pair) {
    int P = m->mesh.per_element;
    for (int e = 0; e < m->mesh.elements; e++) {
        for (int k = line->first[e]; k < line->first[e + 1]; k++) {
            const double *phi = line->phi + (int64_t)k * P, *stiffness = line->load + 6 * (int64_t)k;
            double *to = pair + pairs_of(m) * e;
            for (int i = 0; i < P; i++) {
                for (int j = i; j < P; j++, to += 6) {
                    for (int c = 0; c < 6; c++) {
                        to[c] += phi[i] * phi[j] * stiffness[c];
                    }
                }
            }
        }
    }
}

int spari_foundation_build(spar_member *m) {
    const spari_beam *b = m->kind == SPARI_BEAM ? m->beam : NULL;
    spari_foundation_free(m->load.foundation);
    m->load.foundation = NULL;
    if (!b || b->springs.count == 0 || !(m->effects & SPAR_EFFECT_FOUNDATION)) {
        return SPAR_OK;
    }
    line_load line = {0};
    double *load = spari_zalloc(6 * b->springs.count, sizeof *load);
    m->load.foundation = spari_zalloc(1, sizeof *m->load.foundation);
    int status = load && m->load.foundation &&
                         (m->load.foundation->pair = spari_zalloc(pairs_of(m) * m->mesh.elements, sizeof *load))
                     ? SPAR_OK
                     : SPAR_ERR_MEMORY;
    for (int64_t i = 0; status == SPAR_OK && i < b->springs.count; i++) {
        memcpy(load + 6 * i, b->springs.value + 3 * i, 3 * sizeof *load);
    }
    status = status == SPAR_OK ? line_build(m, SPARI_LINE_SPRINGS, b->springs.count, b->springs.eta, load, &line)
                               : spari_fail(m->session, status, "no memory for the foundation of '%s'", m->name);
    free(load);
    if (status == SPAR_OK) {
        gather_pairs(m, &line, m->load.foundation->pair);
        line_free(&line);
    } else {
        spari_foundation_free(m->load.foundation);
        m->load.foundation = NULL;
    }
    return status;
}

int spar_beam_set_foundation(spar_member *beam, int64_t n, const double *eta, const double *stiffness) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_TRY(spari_need_beam(beam, __func__));
    SPARI_TRY(
        spari_need_stations(beam, __func__, n, SPARI_MOST_STATIONS, eta, SPARI_WITH_JUMPS, "stiffness", 3, stiffness));
    for (int64_t i = 0; i < 3 * n; i++) {
        SPARI_REQUIRE(beam->session, stiffness[i] >= 0, SPAR_ERR_ARGUMENT,
                      "%s: '%s': a stiffness of station %lld is below 0; give numbers >= 0, N/m^2", __func__,
                      beam->name, (long long)(i / 3));
    }
    return spari_line_table_set(beam, __func__, "springs", n, 3, eta, stiffness, &beam->beam->springs);
}

int spar_beam_get_foundation(const spar_member *beam, int64_t *n, int64_t capacity, double *eta, double *stiffness) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_TRY(spari_need_any_beam(beam, __func__));
    return spari_line_table_get(beam, __func__, 3, &beam->beam->springs, capacity, n, eta, stiffness);
}

int spar_beam_set_line_load(spar_member *beam, int kind, int64_t n, const double *eta, const double *load) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_TRY(need_applied(beam, __func__));
    line_load line = {0};
    int status = spari_need_any_beam(beam, __func__);
    status = status == SPAR_OK ? need_kind(beam, __func__, kind) : status;
    status = status == SPAR_OK
                 ? spari_need_stations(beam, __func__, n, SPARI_MOST, eta, SPARI_WITH_JUMPS, "load", 6, load)
                 : status;
    status = status == SPAR_OK && n > 0 ? line_set(beam, kind, n, eta, load, &line) : status;
    const int again = status == SPAR_OK && changes(beam, 1 << kind); /* a kind that exists already */
    if (status == SPAR_OK && (status = keep_before(beam, __func__, 1 << kind)) != SPAR_OK) {
        line_free(&line);
    }
    if (status == SPAR_OK) {
        line_load *now = &beam->load.applied->line[kind];
        if (changes(beam, 1 << kind) && !again) { /* the present loads become those of t^n */
            beam->load.ramp->before.line[kind] = *now;
        } else {
            line_free(now);
        }
        *now = line;
    }
    drop_empty(beam);
    return spari_named(beam->session, __func__, status);
}
