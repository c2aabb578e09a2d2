/* A copy of a body whose sections are no stiffer in any strain than a multiple of the softest one: see capped.h. */
#include "capped.h"

#include "../algebra/eigen.h"
#include "../base/status.h"
#include "quadrature_point.h"

#include <stdlib.h>
#include <string.h>

/* Eigenvalues mu, ascending, and eigenvectors as rows of V, of a section in which curvatures count at `length`. */
static int stiffnesses_of_strains(const double C[36], double length, double V[36], double mu[6]) {
    double workspace[SPARI_SYMMETRIC_ROOM(6)];
    for (int i = 0; i < 36; i++) {
        V[i] = 0.5 * (C[i] + C[i % 6 * 6 + i / 6]) / ((i / 6 < 3 ? 1 : length) * (i % 6 < 3 ? 1 : length));
    }
    return spari_symmetric(6, V, mu, workspace);
}

/* The least positive stiffness of all points of `blocks`; 0: none, or not known. */
static double softest(const spari_body *body, const double *blocks) {
    double least = INFINITY;
    for (int64_t slot = 0; slot < body->slot[body->elements]; slot++) {
        double C[36], V[36], mu[6];
        spari_slot_get(blocks, 36, slot, C);
        if (stiffnesses_of_strains(C, body->length, V, mu)) {
            return 0;
        }
        for (int k = 0; k < 6; k++) {
            least = mu[k] > 0 ? fmin(least, mu[k]) : least;
        }
    }
    return isfinite(least) ? least : 0;
}

/* to := blocks, with no stiffness above `most`. */
static void cap_sections(const spari_body *body, const double *blocks, double most, double *to) {
    const double length = body->length;
    for (int64_t slot = 0; slot < body->slot[body->elements]; slot++) {
        double C[36], V[36], mu[6];
        spari_slot_get(blocks, 36, slot, C);
        int known = stiffnesses_of_strains(C, length, V, mu) == SPAR_OK && mu[5] > most;
        for (int i = 0; i < 36 && known; i++) {
            C[i] = 0;
            for (int k = 0; k < 6; k++) {
                C[i] += fmin(mu[k], most) * V[6 * k + i / 6] * V[6 * k + i % 6];
            }
            C[i] *= (i / 6 < 3 ? 1 : length) * (i % 6 < 3 ? 1 : length);
        }
        spari_slot_put(to, 36, slot, C);
    }
}

/* The section forces of the state beyond those of the capped stiffness, as pretension. */
static void keep_section_forces(const spari_body *body, const double *q, double *z, double *f, spari_body *capped) {
    for (int e = 0; e < body->elements; e++) {
        spari_point_gather(body, e, q, NULL, NULL, z);
        spari_lanes_interpolate(body, e, SPARI_ROTATIONS | SPARI_SLOPES, z, f);
        for (int k = 0; k < body->slot[e + 1] - body->slot[e]; k++) {
            const int64_t slot = body->slot[e] + k;
            double pre[6] = {0}, s[6];
            point_one p;
            fields_one(0, SPARI_BLOCK(f, POINT_ROWS, k), &p);
            strain_one(SPARI_BLOCK(body->tangent, 3, slot), SPARI_BLOCK(capped->C, 36, slot), &p);
            memcpy(s, p.s, sizeof s);
            strain_one(SPARI_BLOCK(body->tangent, 3, slot), SPARI_BLOCK(body->C, 36, slot), &p);
            if (body->pre) {
                spari_slot_get(body->pre, 6, slot, pre);
            }
            for (int i = 0; i < 6; i++) {
                pre[i] = body->pre_part * pre[i] + p.s[i] - s[i];
            }
            spari_slot_put(capped->pre, 6, slot, pre);
        }
    }
}

int spari_body_cap(const spari_body *body, const double *q, double ratio, spari_body *capped) {
    const int64_t slots = body->slot[body->elements];
    *capped = *body;
    if (!body->C || !(ratio > 0)) {
        return SPAR_OK;
    }
    int64_t widest = 0;
    for (int e = 0; e < body->elements; e++) {
        widest = body->slot[e + 1] - body->slot[e] > widest ? body->slot[e + 1] - body->slot[e] : widest;
    }
    double *memory = spari_zalloc(78 * slots + POINT_ROWS * widest + ROW * SPARI_MAX_NODES, sizeof *memory);
    if (!memory) {
        return SPAR_ERR_MEMORY;
    }
    capped->C = memory;
    capped->pre = memory + 36 * slots;
    capped->pre_part = 1;
    double *D = capped->pre + 6 * slots, *f = D + 36 * slots, *z = f + POINT_ROWS * widest;
    const double least = softest(body, body->C), least_of_D = body->D ? softest(body, body->D) : 0;
    cap_sections(body, body->C, least > 0 ? ratio * least : INFINITY, capped->C);
    if (body->D) {
        cap_sections(body, body->D, least_of_D > 0 ? ratio * least_of_D : INFINITY, D);
        capped->D = D;
    }
    keep_section_forces(body, q, z, f, capped);
    return SPAR_OK;
}

void spari_body_uncap(const spari_body *body, spari_body *capped) {
    if (capped->C != body->C) {
        free(capped->C);
    }
}
