/* Linearises a body: element matrices and weight from the exact forces and tangents at the reference. */
#include "body.h"

#include "../base/status.h"

#include <stdlib.h>
#include <string.h>

void spari_body_gravity_changed(spari_body *body) {
    if (body->linear[0] && body->weights) { /* the exact forces at the reference are weight and pretension */
        spari_body_exact_residual(body, body->at_rest, NULL, NULL, 1, body->weights, NULL);
        for (int64_t i = 0; i < 6 * (int64_t)body->unique && body->pull; i++) {
            body->weights[i] -= body->pull[i];
        }
    }
}

int spari_body_linearise(spari_body *body, int heavy) {
    int P = body->per_element;
    int64_t size = (int64_t)36 * P * P;
    const int there[3] = {1, body->D != NULL, body->mass != NULL};
    double *matrices[3] = {0}, *q = spari_zalloc((int64_t)body->unique * 7, sizeof *q), *weights = NULL, *pull = NULL;
    int ok = q && (!heavy || (weights = spari_zalloc((int64_t)body->unique * 6, sizeof *weights)));
    ok = ok && (!body->pre || (pull = spari_zalloc((int64_t)body->unique * 6, sizeof *pull)));
    for (int k = 0; k < 3 && ok; k++) {
        ok = !there[k] || (matrices[k] = spari_zalloc(size * body->elements, sizeof *matrices[k]));
    }
    if (!ok) {
        free(q), free(weights), free(pull);
        free(matrices[0]), free(matrices[1]), free(matrices[2]);
        return 1;
    }
    for (int i = 0; i < body->unique; i++) {
        q[7 * i + 3] = 1;
    }
    for (int e = 0; e < body->elements; e++) {
        double *K = matrices[0] + size * e; /* without gravity, whose change is of second order */
        spari_body_tangent(body, e, q, NULL, NULL, 0, 0, 0, NULL, K);
        spari_body_rates(body, e, q, NULL, NULL, 0, K, there[1] ? matrices[1] + size * e : NULL,
                         there[2] ? matrices[2] + size * e : NULL);
    }
    if (pull) {
        spari_body_exact_residual(body, q, NULL, NULL, 0, pull, NULL);
    }
    body->pull = pull;
    body->at_rest = q;
    body->weights = weights;
    memcpy(body->linear, matrices, sizeof matrices);
    spari_body_gravity_changed(body);
    return 0;
}
