/* Beams held in a plane: see plane.h. */
#include "plane.h"

#include "../base/environment.h"
#include "../math/rotation.h"
#include "beam.h"
#include "check_arguments.h"

#include <float.h>
#include <math.h>
#include <string.h>

int spar_beam_set_plane(spar_member *beam, const double normal[3]) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_TRY(spari_need_beam(beam, __func__));
    const double none[3] = {0, 0, 0}, *n = normal ? normal : none;
    SPARI_TRY(spari_need_finite(beam->session, __func__, beam->name, "normal", 3, n));
    double length = spari_norm(n);
    int unit = fabs(length - 1) <= 4 * DBL_EPSILON; /* what was read is set to the bit */
    SPARI_REQUIRE(beam->session, isfinite(length), SPAR_ERR_ARGUMENT,
                  "%s: '%s': the normal is too long; give a direction, of any ordinary length", __func__, beam->name);
    beam->beam->planar = length > 0;
    for (int i = 0; i < 3; i++) {
        beam->beam->normal[i] = length > 0 && !unit ? n[i] / length : n[i];
    }
    return SPAR_OK;
}

int spar_beam_get_plane(const spar_member *beam, double normal[3]) {
    SPARI_TRY(spari_need_any_beam(beam, __func__));
    spari_give(normal, beam->beam->normal, 3);
    return SPAR_OK;
}

const double *spari_member_plane(const spar_member *m) {
    return m->beam && m->beam->planar ? m->beam->normal : NULL;
}

void spari_plane_project(const double normal[3], int64_t n, double *x) {
    for (int64_t i = 0; i < n; i++, x += 6) {
        double along = spari_dot(normal, x), about = spari_dot(normal, x + 3);
        for (int k = 0; k < 3; k++) {
            x[k] -= along * normal[k];
            x[3 + k] = about * normal[k];
        }
    }
}

void spari_member_constrain(const spar_member *m, int64_t unique, double *r) {
    const double *normal = spari_member_plane(m);
    memset(r, 0, (size_t)spari_member_constrained(m) * sizeof *r);
    if (normal) {
        spari_plane_project(normal, unique, r);
    }
}

/* Largest diagonal entry of the displacements (half 0) or rotations (1); 1 if there is none. */
static double largest_diagonal(int n, const double *S, int half) {
    double most = 0;
    for (int64_t i = 0; i < n; i++) {
        for (int64_t k = 6 * i + 3 * half; k < 6 * i + 3 * half + 3; k++) {
            most = fmax(most, fabs(S[k * 6 * n + k]));
        }
    }
    return most > 0 ? most : 1;
}

void spari_plane_tangent(const double normal[3], int n, double *S) {
    const double own[2] = {largest_diagonal(n, S, 0), largest_diagonal(n, S, 1)};
    const int64_t size = 6 * (int64_t)n;
    double column[6];
    for (int64_t row = 0; row < size; row++) {
        spari_plane_project(normal, n, S + row * size);
    }
    for (int64_t k = 0; k < size; k++) {
        for (int64_t i = 0; i < size; i += 6) {
            for (int c = 0; c < 6; c++) {
                column[c] = S[(i + c) * size + k];
            }
            spari_plane_project(normal, 1, column);
            for (int c = 0; c < 6; c++) {
                S[(i + c) * size + k] = column[c];
            }
        }
    }
    for (int64_t i = 0; i < size; i += 6) {
        for (int c = 0; c < 3; c++) {
            for (int k = 0; k < 3; k++) {
                double out = normal[c] * normal[k];
                S[(i + c) * size + i + k] += own[0] * out;
                S[(i + 3 + c) * size + i + 3 + k] += own[1] * ((c == k) - out);
            }
        }
    }
}

/* How far x, scaled by `size`, is from the part of it that the plane leaves. */
static double leaves_by(const double normal[3], const double x[6]) {
    double in[6], size = fmax(spari_norm(x), spari_norm(x + 3)), out = 0;
    memcpy(in, x, sizeof in);
    spari_plane_project(normal, 1, in);
    for (int k = 0; k < 6; k++) {
        out = fmax(out, fabs(x[k] - in[k]));
    }
    return size > 0 ? out / size : 0;
}

int spari_plane_take(const spar_member *m, const char *caller, double q[7], double v[6], double a[6]) {
    const double *normal = spari_member_plane(m), rounding = 1e-9;
    if (!normal) {
        return SPAR_OK;
    }
    double x[6] = {0}, turn[3];
    if (q) { /* the vector part of the quaternion has the direction of the rotation */
        memcpy(x, q, 3 * sizeof *x);
        memcpy(x + 3, q + 4, 3 * sizeof *x);
    }
    SPARI_REQUIRE(m->session,
                  leaves_by(normal, x) <= rounding && (!v || leaves_by(normal, v) <= rounding) &&
                      (!a || leaves_by(normal, a) <= rounding),
                  SPAR_ERR_ARGUMENT,
                  "%s: '%s' is held in the plane with the normal (%g, %g, %g), and this motion leaves it; give "
                  "displacements in the plane and rotations about the normal, or remove spar_beam_set_plane",
                  caller, m->name, normal[0], normal[1], normal[2]);
    if (q) {
        spari_plane_project(normal, 1, x);
        memcpy(q, x, 3 * sizeof *x);
        memcpy(turn, x + 3, sizeof turn);
        memcpy(q + 4, turn, sizeof turn);
        spari_quat_normalise(q + 3);
    }
    if (v) {
        spari_plane_project(normal, 1, v);
    }
    if (a) {
        spari_plane_project(normal, 1, a);
    }
    return SPAR_OK;
}

/* ---- three unknowns a node ---- */

/* Two axes in the plane. */
static void plane_axes(const double normal[3], double axis[2][3]) {
    int least = 0;
    for (int i = 1; i < 3; i++) {
        least = fabs(normal[i]) < fabs(normal[least]) ? i : least;
    }
    double help[3] = {least == 0, least == 1, least == 2};
    spari_cross(normal, help, axis[0]);
    double length = spari_norm(axis[0]);
    for (int i = 0; i < 3; i++) {
        axis[0][i] /= length;
    }
    spari_cross(normal, axis[0], axis[1]);
}

void spari_plane_collect(const double normal[3], int64_t n, const double *x, double *y) {
    double axis[2][3];
    plane_axes(normal, axis);
    for (int64_t i = 0; i < n; i++, x += 6, y += 3) {
        const double in[3] = {spari_dot(axis[0], x), spari_dot(axis[1], x), spari_dot(normal, x + 3)};
        memcpy(y, in, sizeof in); /* y may be x */
    }
}

void spari_plane_spread(const double normal[3], int64_t n, const double *y, double *x) {
    double axis[2][3];
    plane_axes(normal, axis);
    for (int64_t i = n - 1; i >= 0; i--) {
        const double in[3] = {y[3 * i], y[3 * i + 1], y[3 * i + 2]};
        for (int k = 0; k < 3; k++) {
            x[6 * i + k] = in[0] * axis[0][k] + in[1] * axis[1][k];
            x[6 * i + 3 + k] = in[2] * normal[k];
        }
    }
}

void spari_plane_reduce(const double normal[3], int n, double *S) {
    const int64_t size = 6 * (int64_t)n, less = 3 * (int64_t)n;
    double axis[2][3];
    plane_axes(normal, axis);
    for (int64_t row = 0; row < size; row++) { /* columns: the rows move up, none over one that is still needed */
        spari_plane_collect(normal, n, S + row * size, S + row * less);
    }
    for (int64_t i = 0; i < n; i++) {
        for (int64_t k = 0; k < less; k++) {
            double column[6], in[3];
            for (int c = 0; c < 6; c++) {
                column[c] = S[(6 * i + c) * less + k];
            }
            spari_plane_collect(normal, 1, column, in);
            for (int c = 0; c < 3; c++) {
                S[(3 * i + c) * less + k] = in[c];
            }
        }
    }
}
