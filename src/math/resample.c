/* Transfer between two meshes of a line: see resample.h. */
#include "resample.h"

#include "basis.h"
#include "rotation.h"

#include <math.h>
#include <string.h>

void spari_resample_basis(int P, double xi, double *phi) {
    double x[SPARI_MAX_NODES], bary[SPARI_MAX_NODES];
    phi[0] = 1;
    if (P > 1) {
        spari_gll(P, x, NULL, bary);
        spari_lagrange(P, x, bary, xi, phi, NULL);
    }
}

/* Coordinates of the n nodes of an element. */
static void places_of(int n, double *x) {
    x[0] = 0;
    if (n > 1) {
        spari_gll(n, x, NULL, NULL);
    }
}

int spari_resample_place(int from, int e, double x, int to, double *xi) {
    if (from == to) {
        *xi = x;
        return e;
    }
    int last = x >= 1; /* (e + x) / from of the line, in elements of `to`, in integers as far as possible */
    int64_t along = (int64_t)(e + last) * to, on = along / from;
    double rest = (double)(along % from);
    if (last && rest == 0) {
        *xi = 1;
        return (int)on - 1;
    }
    rest = (rest + (last || x <= -1 ? 0 : 0.5 * (1 + x) * to)) / from;
    on += (int64_t)floor(rest);
    rest -= floor(rest);
    *xi = on < to ? 2 * rest - 1 : 1;
    return on < to ? (int)on : to - 1;
}

int64_t spari_resample_end(int from, int e, int side, spari_mesh to) {
    double xi;
    int at = spari_resample_place(from, e, side ? 1 : -1, to.elements, &xi);
    return xi <= -1 ? (int64_t)at * to.per_element : xi >= 1 ? (int64_t)(at + 1) * to.per_element - 1 : -1;
}

/* Interpolates the nodes [P] of one element. */
static void interpolate_nodes(int P, const double *phi, int width, int rotation, const double *f, double *t) {
    memset(t, 0, (size_t)width * sizeof *t);
    for (int l = 0; l < P; l++) {
        const double *fl = f + width * l;
        double sign = rotation >= 0 && spari_quat_dot(f + rotation, fl + rotation) < 0 ? -1 : 1;
        for (int c = 0; c < width; c++) {
            t[c] += phi[l] * (rotation >= 0 && c >= rotation && c < rotation + 4 ? sign : 1) * fl[c];
        }
    }
    if (rotation >= 0) {
        spari_quat_normalise(t + rotation);
    }
}

void spari_resample_values(spari_mesh from, spari_mesh to, int width, int rotation, const double *values, double *out) {
    int P = from.per_element, n = to.per_element;
    double x[SPARI_MAX_NODES], phi[SPARI_MAX_NODES], xi;
    places_of(n, x);
    for (int k = 0; k < n; k++) {
        for (int e = 0; e < to.elements; e++) {
            int of = spari_resample_place(to.elements, e, x[k], from.elements, &xi);
            if (e == 0 || from.elements != to.elements) {
                spari_resample_basis(P, xi, phi);
            }
            interpolate_nodes(P, phi, width, rotation, values + (int64_t)width * of * P,
                              out + (int64_t)width * ((int64_t)e * n + k));
        }
    }
}

void spari_resample_loads(spari_mesh from, spari_mesh to, const double *loads, double *out) {
    int P = from.per_element, n = to.per_element;
    if (spari_mesh_is_equal(from, to)) {
        memcpy(out, loads, (size_t)(6 * (int64_t)from.elements * P) * sizeof *out);
        return;
    }
    double x[SPARI_MAX_NODES], phi[SPARI_MAX_NODES], xi;
    places_of(P, x);
    memset(out, 0, (size_t)(6 * (int64_t)to.elements * n) * sizeof *out);
    for (int l = 0; l < P; l++) {
        for (int e = 0; e < from.elements; e++) {
            int on = spari_resample_place(from.elements, e, x[l], to.elements, &xi);
            if (e == 0 || from.elements != to.elements) {
                spari_resample_basis(n, xi, phi);
            }
            for (int k = 0; k < n; k++) {
                for (int c = 0; c < 6; c++) {
                    out[6 * ((int64_t)on * n + k) + c] += phi[k] * loads[6 * ((int64_t)e * P + l) + c];
                }
            }
        }
    }
}
