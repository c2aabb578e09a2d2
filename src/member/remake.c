#include "remake.h"

#include "../base/scene.h"
#include "../math/basis.h"
#include "../math/rotation.h"
#include "applied.h"
#include "beam.h"
#include "rung.h"

#include <stdlib.h>
#include <string.h>

spari_remake spari_remake_of(const spar_member *m) {
    return (spari_remake){.per_element = m->per_element, .fidelity = m->fidelity, .modes = m->modes};
}

/* ---- between two sets of nodes ---- */

void spari_remake_basis(int P, double xi, double *phi) {
    double x[SPARI_MAX_NODES], bary[SPARI_MAX_NODES];
    phi[0] = 1;
    if (P > 1) {
        spari_gll(P, x, NULL, bary);
        spari_lagrange(P, x, bary, xi, phi, NULL);
    }
}

/* B [n][P]: the basis of P nodes at the n nodes of another element. */
static void basis_at_nodes(int P, int n, double B[][SPARI_MAX_NODES]) {
    double x[SPARI_MAX_NODES] = {0};
    if (n > 1) {
        spari_gll(n, x, NULL, NULL);
    }
    for (int k = 0; k < n; k++) {
        spari_remake_basis(P, x[k], B[k]);
    }
}

/* Nodal values [nodes][width] of one member at the nodes of the other; quaternions stand from column `turn` on (-1:
   there are none) and are brought into one hemisphere and back to unit length. */
static void interpolate(int elements, int P, int n, int width, int turn, const double *from, double *to) {
    double B[SPARI_MAX_NODES][SPARI_MAX_NODES];
    basis_at_nodes(P, n, B);
    for (int e = 0; e < elements; e++) {
        const double *f = from + (int64_t)width * e * P;
        for (int k = 0; k < n; k++) {
            double *t = to + (int64_t)width * ((int64_t)e * n + k);
            memset(t, 0, (size_t)width * sizeof *t);
            for (int l = 0; l < P; l++) {
                const double *fl = f + width * l;
                double sign = turn >= 0 && spari_quat_dot(f + turn, fl + turn) < 0 ? -1 : 1;
                for (int c = 0; c < width; c++) {
                    t[c] += B[k][l] * (turn >= 0 && c >= turn && c < turn + 4 ? sign : 1) * fl[c];
                }
            }
            if (turn >= 0) {
                spari_quat_normalise(t + turn);
            }
        }
    }
}

void spari_remake_loads(const spar_member *from, const spar_member *to, const double *loads, double *out) {
    int P = from->per_element, n = to->per_element;
    if (P == n) {
        memcpy(out, loads, (size_t)(6 * from->nodes) * sizeof *out);
        return;
    }
    double B[SPARI_MAX_NODES][SPARI_MAX_NODES];
    basis_at_nodes(n, P, B);
    memset(out, 0, (size_t)(6 * to->nodes) * sizeof *out);
    for (int e = 0; e < from->elements; e++) {
        for (int l = 0; l < P; l++) {
            for (int k = 0; k < n; k++) {
                for (int c = 0; c < 6; c++) {
                    out[6 * ((int64_t)e * n + k) + c] += B[l][k] * loads[6 * ((int64_t)e * P + l) + c];
                }
            }
        }
    }
}

/* ---- description and state ---- */

/* The description with another rule, or other nodes where they were given; a copy that shares the rest. */
static int describe(spar_member *m, const spari_remake *wish, const spar_member *old) {
    if (m->kind != SPARI_BEAM) {
        return SPAR_OK;
    }
    spari_beam *b = spari_zalloc(1, sizeof *b);
    SPARI_REQUIRE(m->session, b, SPAR_ERR_MEMORY, "no memory for a trial of '%s'", m->name);
    *b = *old->beam;
    b->node_x = b->node_q = NULL;
    m->beam = b;
    b->rule = spari_beam_rule(old->beam);
    if (wish->points > 0) {
        b->points = wish->points;
    } else if (b->points > 0 && b->rule != SPAR_QUADRATURE_SECTIONS) { /* as many as an element of more nodes needs */
        int least = wish->per_element + (b->rule == SPAR_QUADRATURE_LOBATTO);
        b->points = b->points < least ? least : b->points;
    }
    m->per_element = wish->per_element;
    m->nodes = (int64_t)m->elements * m->per_element;
    if (old->beam->node_x) { /* the nodes given stand for the line between them */
        const spari_beam *given = old->beam;
        b->node_x = spari_zalloc(3 * m->nodes, sizeof *b->node_x);
        b->node_q = given->node_q ? spari_zalloc(4 * m->nodes, sizeof *b->node_q) : NULL;
        SPARI_REQUIRE(m->session, b->node_x && (b->node_q || !given->node_q), SPAR_ERR_MEMORY,
                      "no memory for a trial of '%s'", m->name);
        interpolate(m->elements, old->per_element, m->per_element, 3, -1, given->node_x, b->node_x);
        if (b->node_q) {
            interpolate(m->elements, old->per_element, m->per_element, 4, 0, given->node_q, b->node_q);
        }
    }
    return SPAR_OK;
}

static void carry_state(const spar_member *old, spar_member *m) {
    const double *loads[] = {old->dead,
                             old->load_used,
                             old->load_pushed,
                             old->load_before,
                             old->load_history[0],
                             old->load_history[1],
                             old->load_history[2],
                             old->load_solved[0],
                             old->load_solved[1]};
    double *to[] = {m->dead,
                    m->load_used,
                    m->load_pushed,
                    m->load_before,
                    m->load_history[0],
                    m->load_history[1],
                    m->load_history[2],
                    m->load_solved[0],
                    m->load_solved[1]};
    int E = m->elements, P = old->per_element, n = m->per_element;
    interpolate(E, P, n, 7, 3, old->now.q, m->now.q);
    interpolate(E, P, n, 6, -1, old->now.v, m->now.v);
    interpolate(E, P, n, 6, -1, old->now.a, m->now.a);
    for (size_t k = 0; k < sizeof to / sizeof *to; k++) {
        if (loads[k] && to[k]) { /* past loads are kept as far as either predictor looks */
            spari_remake_loads(old, m, loads[k], to[k]);
        }
    }
    spari_member_restart(m);
    memcpy(m->drive, old->drive, sizeof m->drive);
}

int spari_member_remake(spar_member *m, const spari_remake *wish, spar_member *old) {
    *old = *m;
    spari_member_disown(m);
    m->fidelity = wish->fidelity;
    m->modes = wish->fidelity == SPAR_FIDELITY_MODAL ? wish->modes : 0;
    SPARI_TRY(describe(m, wish, old));
    SPARI_TRY(spari_rung_check(m));
    m->effects = spari_member_effects(m) & ~wish->left_out;
    if (!(m->effects & SPAR_EFFECT_INERTIA)) {
        m->effects &= ~SPAR_EFFECT_GYROSCOPIC;
    }
    SPARI_TRY(spari_member_build(m));
    SPARI_TRY(spari_applied_remake(old, m));
    carry_state(old, m);
    return SPAR_OK;
}

void spari_member_restore(spar_member *m, const spar_member *old) {
    spari_member_release(m);
    if (m->beam != old->beam) {
        free(m->beam->node_x);
        free(m->beam->node_q);
        free(m->beam);
    }
    *m = *old;
}
