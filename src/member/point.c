/* One quadrature point: see point.h. */
#include "point.h"

/* ---- fields ---- */

int64_t spari_body_scratch(int P, int points) {
    int64_t p = P, n = points;
    return p * (ROW + BACK) + n * (POINT_ROW + BACK_ROW) + 4 * p * p * 49 + 2 * n * p * 2 * 49 + n * 2 * p;
}

/* Nodal 4-vectors and their rates: q' = 1/2 w q, q'' = 1/2 alpha q + 1/2 w q'. Neighbours are brought into one
   hemisphere, so that an element may turn by more than half a revolution from end to end. */
void spari_point_gather(const spari_body *body, int e, const double *q, const double *v, const double *a, double *z) {
    int P = body->per_element;
    for (int l = 0; l < P; l++) {
        int64_t node = (int64_t)e * (P - 1) + l;
        const double *qn = q + 7 * node;
        double *zn = z + ROW * l, *ql = zn + Q;
        memset(zn, 0, ROW * sizeof *zn);
        memcpy(zn + U, qn, 3 * sizeof *zn);
        double sign = l > 0 && spari_quat_dot(qn + 3, ql - ROW) < 0 ? -1.0 : 1.0;
        for (int i = 0; i < 4; i++) {
            ql[i] = sign * qn[3 + i];
        }
        if (v) {
            const double *vn = v + 6 * node;
            double half[4] = {0, 0.5 * vn[3], 0.5 * vn[4], 0.5 * vn[5]};
            memcpy(zn + UD, vn, 3 * sizeof *zn);
            spari_quat_mul(half, ql, zn + QD);
            if (a) {
                const double *an = a + 6 * node;
                double half_rate[4] = {0, 0.5 * an[3], 0.5 * an[4], 0.5 * an[5]}, spin[4];
                memcpy(zn + UDD, an, 3 * sizeof *zn);
                spari_quat_mul(half_rate, ql, zn + QDD);
                spari_quat_mul(half, zn + QD, spin);
                for (int i = 0; i < 4; i++) {
                    zn[QDD + i] += spin[i];
                }
            }
        }
    }
}

/* ---- sums over nodes and over points, the two loops that grow with P times points ---- */

#if defined(__GNUC__)
#define SPARI_ALWAYS_INLINE __attribute__((always_inline)) inline
#else
#define SPARI_ALWAYS_INLINE inline
#endif

/* f[n][POINT_ROW]: the first `width` fields and the first `slopes` derivatives at n points. */
static SPARI_ALWAYS_INLINE void interpolate_rows(int P, int n, const double *phi, const double *dphi, int width,
                                                 int slopes, const double *z, double *f) {
    for (int k = 0; k < n; k++) {
        double row[POINT_ROW] = {0};
        for (int l = 0; l < P; l++) {
            double a = phi[(int64_t)k * P + l], b = dphi[(int64_t)k * P + l];
            const double *zl = z + ROW * l;
            for (int i = 0; i < width; i++) {
                row[i] += a * zl[i];
            }
            for (int i = 0; i < slopes; i++) {
                row[ROW + i] += b * zl[i];
            }
        }
        memcpy(f + (int64_t)POINT_ROW * k, row, sizeof row);
    }
}

/* g[P][BACK] = sum over points of phi_l times the first half of each row and phi'_l times the second. */
static SPARI_ALWAYS_INLINE void collect_rows(int P, int n, const double *phi, const double *dphi, const double *back,
                                             double *g) {
    for (int l = 0; l < P; l++) {
        double sum[BACK] = {0};
        for (int k = 0; k < n; k++) {
            double a = phi[(int64_t)k * P + l], b = dphi[(int64_t)k * P + l];
            const double *row = back + (int64_t)BACK_ROW * k;
            for (int i = 0; i < BACK; i++) {
                sum[i] += a * row[i];
            }
            for (int i = 0; i < BACK; i++) {
                sum[i] += b * row[BACK + i];
            }
        }
        memcpy(g + BACK * l, sum, sizeof sum);
    }
}

/* The widths that occur, as constants, so that the inner loops are whole vectors. */
#define SPARI_SUMS(NAME, TARGET)                                                                                       \
    TARGET static void interpolate_##NAME(int P, int n, const double *phi, const double *dphi, int moving, int slopes, \
                                          const double *z, double *f) {                                                \
        if (moving && slopes == UDD) {                                                                                 \
            interpolate_rows(P, n, phi, dphi, ROW, 16, z, f);                                                          \
        } else if (moving && slopes) {                                                                                 \
            interpolate_rows(P, n, phi, dphi, ROW, 8, z, f);                                                           \
        } else if (moving) {                                                                                           \
            interpolate_rows(P, n, phi, dphi, ROW, 0, z, f);                                                           \
        } else {                                                                                                       \
            interpolate_rows(P, n, phi, dphi, 8, 8, z, f);                                                             \
        }                                                                                                              \
    }                                                                                                                  \
    TARGET static void collect_##NAME(int P, int n, const double *phi, const double *dphi, const double *back,         \
                                      double *g) {                                                                     \
        collect_rows(P, n, phi, dphi, back, g);                                                                        \
    }

SPARI_SUMS(plain, )
#if defined(__GNUC__) && defined(__x86_64__)
SPARI_SUMS(avx2, __attribute__((target("avx2"))))
#define SPARI_CHOOSE(name) (__builtin_cpu_supports("avx2") ? name##_avx2 : name##_plain)
#else
#define SPARI_CHOOSE(name) name##_plain
#endif

void spari_point_interpolate(const spari_body *body, int e, const double *z, int moving, double *f) {
    int P = body->per_element, first = body->first[e];
    int slopes = !body->C ? 0 : body->D && moving ? UDD : UD;
    SPARI_CHOOSE(interpolate)
    (P, body->first[e + 1] - first, body->phi + (int64_t)first * P, body->dphi + (int64_t)first * P, moving, slopes, z,
     f);
}

void spari_point_collect(const spari_body *body, int e, const double *back, double *g) {
    int P = body->per_element, first = body->first[e];
    SPARI_CHOOSE(collect)
    (P, body->first[e + 1] - first, body->phi + (int64_t)first * P, body->dphi + (int64_t)first * P, back, g);
}

/* ---- one point ---- */

void spari_point_fields(const double *f, spari_point *s) {
    s->f = f;
    s->N = sqrt(spari_quat_dot(f + Q, f + Q));
    double inv = 1 / s->N;
    for (int i = 0; i < 4; i++) {
        s->r[i] = f[Q + i] * inv;
        s->p[i] = f[DQ + i] * inv;
        s->d[i] = f[QD + i] * inv;
        s->z[i] = f[DQD + i] * inv;
    }
    s->b = spari_quat_dot(s->r, s->d);
    imag_conj_mul(s->r, s->d, s->omega);
    for (int i = 0; i < 3; i++) {
        s->omega[i] *= 2;
    }
}

void spari_point_strain(const spari_body *body, int k, int moving, spari_point *s) {
    double t[3], kappa[3];
    const double *t0 = body->tangent + 3 * (int64_t)k;
    for (int i = 0; i < 3; i++) {
        t[i] = t0[i] + s->f[DU + i];
    }
    spari_rotate_back(s->r, t, s->T);
    imag_conj_mul(s->r, s->p, kappa);
    for (int i = 0; i < 3; i++) {
        s->e[i] = s->T[i] - t0[i];
        s->e[3 + i] = 2 * kappa[i];
    }
    matrix6_times(body->C + 36 * (int64_t)k, s->e, s->s);
    if (body->D && moving) {
        double turn[3], a[3], b[3], sd[6];
        spari_rotate_back(s->r, s->f + DUD, s->t_rate);
        spari_cross(s->T, s->omega, turn);
        imag_conj_mul(s->d, s->p, a);
        imag_conj_mul(s->r, s->z, b);
        for (int i = 0; i < 3; i++) {
            s->kd0[i] = 2 * (a[i] + b[i]);
            s->ed[i] = s->t_rate[i] + turn[i];
            s->ed[3 + i] = s->kd0[i] - 2 * s->e[3 + i] * s->b;
        }
        matrix6_times(body->D + 36 * (int64_t)k, s->ed, sd);
        s->damped = 0;
        for (int i = 0; i < 6; i++) {
            s->s[i] += sd[i];
            s->damped += sd[i] * s->ed[i];
        }
    }
}

void spari_point_elastic_forces(const spari_point *s, double *value, double *slope) {
    double x[3], n4[4], k4[4], pk[4];
    spari_rotate(s->r, s->s, slope);
    spari_cross(s->s, s->T, x); /* moment of the section force about the section */
    quat_vec(s->r, x, n4);
    quat_vec(s->r, s->s + 3, k4);
    quat_vec(s->p, s->s + 3, pk);
    double dots = spari_dot(s->e + 3, s->s + 3);
    for (int i = 0; i < 4; i++) {
        slope[3 + i] = 2 * k4[i] / s->N;
        value[3 + i] = (2 * n4[i] - 2 * pk[i] - 2 * dots * s->r[i]) / s->N;
    }
}

spari_regime spari_point_regime(const spari_body *body, const double *v, const double *a, double factor) {
    spari_regime how = {.moving = v != NULL, .accelerated = a != NULL && body->mass};
    for (int i = 0; i < 3; i++) {
        how.weight[i] = factor * body->gravity[i];
        how.heavy = how.heavy || (how.weight[i] != 0 && body->mass);
    }
    return how;
}

void spari_point_weight(const spari_body *body, int k, const spari_regime *how, const spari_point *s,
                        spari_point_inertia *n) {
    double net[3];
    for (int i = 0; i < 3; i++) {
        net[i] = -how->weight[i];
        n->y[i] = 0;
    }
    spari_rotate_back(s->r, net, n->h);
    spari_cross(body->mass + 10 * (int64_t)k + 1, n->h, n->mb);
}

void spari_point_inertia_forces(const spari_body *body, int k, const spari_regime *how, const spari_point *s,
                                spari_point_inertia *n) {
    const double *mass = body->mass + 10 * (int64_t)k, *mc = mass + 1, *J = mass + 4;
    double net[3], rdd[4], JA[3], x[3];
    for (int i = 0; i < 3; i++) {
        net[i] = s->f[UDD + i];
    }
    if (how->heavy) {
        for (int i = 0; i < 3; i++) {
            net[i] -= how->weight[i];
        }
    }
    for (int i = 0; i < 4; i++) {
        rdd[i] = s->f[QDD + i] / s->N;
    }
    imag_conj_mul(s->r, rdd, n->A0);
    for (int i = 0; i < 3; i++) {
        n->A0[i] *= 2;
        n->A[i] = n->A0[i] - 2 * s->b * s->omega[i];
    }
    spari_rotate_back(s->r, net, n->h);
    symmetric_times(J, n->A, JA);
    spari_cross(n->A, mc, n->y);
    spari_cross(mc, n->h, n->mb);
    for (int i = 0; i < 3; i++) {
        n->mb[i] += JA[i];
    }
    if (body->gyroscopic) {
        symmetric_times(J, s->omega, n->JW);
        spari_cross(s->omega, mc, n->Wc);
        spari_cross(s->omega, n->Wc, x);
        for (int i = 0; i < 3; i++) {
            n->y[i] += x[i];
        }
        spari_cross(s->omega, n->JW, x);
        for (int i = 0; i < 3; i++) {
            n->mb[i] += x[i];
        }
    }
}
