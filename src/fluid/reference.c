/* The reference configuration of a fluid: poses of the line at nearest points, positions of mapped nodes. */
#include "../math/rotation.h"
#include "state.h"
#include <string.h>

void spari_fluid_series(const double *c, int modes, int offset, int n, double xi, double *out) {
    double t0 = 1, t1 = xi;
    memset(out, 0, sizeof *out * (size_t)n);
    for (int k = 0; k < modes; k++) {
        for (int f = 0; f < n; f++) {
            out[f] += t0 * c[k * SPARI_FIELDS + offset + f];
        }
        double t2 = 2 * xi * t1 - t0;
        t0 = t1, t1 = t2;
    }
}

/* Reference position and orientation of a nearest point (T2). */
void spari_fluid_reference(const spar_fluid *fluid, int element, double xi, double x[3], double q[4]) {
    int modes = fluid->member->mesh.per_element;
    const double *c = fluid->reference + (ptrdiff_t)element * modes * SPARI_FIELDS;
    spari_fluid_series(c, modes, SPARI_F_POSITION, 3, xi, x);
    spari_fluid_series(c, modes, SPARI_F_QUAT, 4, xi, q);
    spari_quat_normalise(q);
}

void spari_fluid_frame(const spar_fluid *fluid, const spari_node_set *set, int64_t p, double x[3], double q[4]) {
    const spari_nodes *s = set->nodes;
    spari_fluid_reference(fluid, spari_nodes_element(s, p), spari_nodes_xi(s, p), x, q);
    if (set->frame) {
        memcpy(q, set->frame + 4 * spari_nodes_node(s, p), 4 * sizeof *q);
    }
}

double *spari_fluid_positions(const spar_fluid *fluid, const spari_nodes *s) {
    double *x = spari_zalloc(3 * s->n, sizeof *x);
    for (int64_t p = 0; x && p < s->n; p++) {
        double nearest[3], q[4];
        spari_fluid_reference(fluid, spari_nodes_element(s, p), spari_nodes_xi(s, p), nearest, q);
        for (int i = 0; i < 3; i++) {
            x[3 * spari_nodes_node(s, p) + i] = nearest[i] + s->con[i][p];
        }
    }
    return x;
}
