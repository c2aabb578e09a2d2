/* A body created, made linear, freed. */
#include "body.h"

#include "../base/status.h"

#include <stdlib.h>
#include <string.h>

spari_body *spari_body_create(int elements, int per_element, int points, int elastic, int damped, int massive) {
    spari_body *body = spari_zalloc(1, sizeof *body);
    if (!body) {
        return NULL;
    }
    int64_t P = per_element, n = points;
    body->elements = elements;
    body->per_element = per_element;
    body->unique = elements * (per_element - 1) + 1;
    body->gyroscopic = 1;
    int ok = (body->first = spari_zalloc(elements + 1, sizeof *body->first)) != NULL;
    ok = ok && (body->phi = spari_zalloc(n * P, sizeof *body->phi));
    ok = ok && (body->dphi = spari_zalloc(n * P, sizeof *body->dphi));
    ok = ok && (body->weight = spari_zalloc(n, sizeof *body->weight));
    ok = ok && (body->tangent = spari_zalloc(n * 3, sizeof *body->tangent));
    ok = ok && (body->place = spari_zalloc(n * 3, sizeof *body->place));
    ok = ok && (!elastic || (body->C = spari_zalloc(n * 36, sizeof *body->C)));
    ok = ok && (!damped || (body->D = spari_zalloc(n * 36, sizeof *body->D)));
    ok = ok && (!massive || (body->mass = spari_zalloc(n * 10, sizeof *body->mass)));
    ok = ok && (body->scratch = spari_zalloc(spari_body_scratch(per_element, points), sizeof *body->scratch));
    if (!ok) {
        spari_body_free(body);
        return NULL;
    }
    return body;
}

void spari_body_free(spari_body *body) {
    if (!body) {
        return;
    }
    free(body->first);
    free(body->phi);
    free(body->dphi);
    free(body->weight);
    free(body->tangent);
    free(body->place);
    free(body->C);
    free(body->D);
    free(body->mass);
    for (int k = 0; k < 3; k++) {
        free(body->linear[k]);
    }
    free(body->weights);
    free(body->at_rest);
    free(body->scratch);
    free(body);
}

void spari_body_gravity_changed(spari_body *body) {
    if (body->linear[0] && body->weights) { /* the exact forces at the reference are the weight */
        spari_body_exact_residual(body, body->at_rest, NULL, NULL, 1, body->weights, NULL);
    }
}

int spari_body_linearise(spari_body *body, int heavy) {
    int P = body->per_element;
    int64_t size = (int64_t)36 * P * P;
    const int there[3] = {1, body->D != NULL, body->mass != NULL};
    double *matrices[3] = {0}, *q = spari_zalloc((int64_t)body->unique * 7, sizeof *q), *weights = NULL;
    int ok = q && (!heavy || (weights = spari_zalloc((int64_t)body->unique * 6, sizeof *weights)));
    for (int k = 0; k < 3 && ok; k++) {
        ok = !there[k] || (matrices[k] = spari_zalloc(size * body->elements, sizeof *matrices[k]));
    }
    if (!ok) {
        free(q), free(weights);
        free(matrices[0]), free(matrices[1]), free(matrices[2]);
        return 1;
    }
    for (int i = 0; i < body->unique; i++) {
        q[7 * i + 3] = 1;
    }
    for (int e = 0; e < body->elements; e++) {
        double *K = matrices[0] + size * e; /* gravity stays out of it: first order */
        spari_body_tangent(body, e, q, NULL, NULL, 0, 0, 0, NULL, K);
        spari_body_rates(body, e, q, NULL, NULL, 0, K, there[1] ? matrices[1] + size * e : NULL,
                         there[2] ? matrices[2] + size * e : NULL);
    }
    body->at_rest = q;
    body->weights = weights;
    memcpy(body->linear, matrices, sizeof matrices);
    spari_body_gravity_changed(body);
    return 0;
}
