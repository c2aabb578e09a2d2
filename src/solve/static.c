/* Static equilibrium by Newton with the exact tangent, in load steps that halve where Newton fails. */
#include "../math/rotation.h"
#include "../member/applied.h"
#include "../session/session.h"
#include "solver.h"

#include <float.h>
#include <string.h>

enum { STATIC_ITERATIONS = 50, STATIC_HALVINGS = 14 };

/* One Newton solution at load factor f, from and to state q. Returns 0, or 1 when it fails. */
static int equilibrium(spar_member *member, double f, double *q) {
    spari_solver *s = member->solver;
    int n = s->n, first, end;
    double last = 0, length = member->body->length;
    const double longest = 0.8; /* a correction turns no node by more (rad), nor moves it by more of the length */
    spari_solver_fixed(member, &first, &end);
    for (int it = 0; it < STATIC_ITERATIONS; it++) {
        double scale = spari_body_residual(member->body, q, NULL, NULL, f, s->r, NULL);
        for (int i = 0; i < 6 * n; i++) {
            s->r[i] -= f * s->load[i];
            scale = fmax(scale, fabs(f * s->load[i]));
        }
        if (member->applied) {
            scale = fmax(scale, spari_applied_residual(member, q, f, s->r));
        }
        memset(s->r + first, 0, (size_t)(end - first) * sizeof *s->r);
        double noise = 0;
        for (int i = 0; i < 6 * n; i++) {
            noise = fmax(noise, fabs(s->r[i]));
        }
        if (!isfinite(noise) || spari_solver_factor(member, q, NULL, NULL, f, 0, 0, NULL)) {
            return 1;
        }
        memcpy(s->dx, s->r, (size_t)(6 * n) * sizeof *s->dx);
        if (spari_linear_solve(s->linear, s->dx)) {
            return 1;
        }
        double largest = 0;
        for (int i = 0; i < n; i++) {
            largest = fmax(largest, fmax(spari_norm(s->dx + 6 * i) / length, spari_norm(s->dx + 6 * i + 3)));
        }
        double cut = largest > longest ? longest / largest : 1;
        for (int i = 0; i < n; i++) {
            double turn[3], p[4];
            for (int k = 0; k < 3; k++) {
                q[7 * i + k] -= cut * s->dx[6 * i + k];
                turn[k] = -cut * s->dx[6 * i + 3 + k];
            }
            spari_quat_exp(turn, p);
            spari_quat_mul(p, q + 7 * i + 3, q + 7 * i + 3);
            spari_quat_normalise(q + 7 * i + 3);
        }
        /* quadratic: a correction of 1e-8 leaves 1e-16; or the balance is as good as rounding lets it be */
        if (cut == 1 && (largest < 1e-9 || noise <= 16 * DBL_EPSILON * scale ||
                         (largest < 1e-7 && last > 0 && largest > 0.5 * last))) {
            return 0;
        }
        last = largest;
    }
    return 1;
}

/* A tangent that is not positive at equilibrium means that a limit or branching point has been passed: the state is not
   the one that loading leads to. Not asked here: the determinant's sign changes show it. */
int spari_solver_static(spar_member *member, int load_steps) {
    spari_solver *s = member->solver;
    int n = s->n;
    size_t bytes = (size_t)(7 * n) * sizeof(double);
    double done = 0, step = 1.0 / load_steps;
    int halvings = 0;
    spari_solver_gather(member, member->dead, s->load);
    spari_solver_gather(member, member->load_pushed, s->r);
    for (int i = 0; i < 6 * n; i++) {
        s->load[i] += s->r[i];
    }
    memcpy(s->to.q, s->begin.q, bytes);
    memcpy(s->best, s->begin.q, bytes);
    while (done < 1) {
        double f = done + step > 1 - 1e-12 ? 1 : done + step;
        if (equilibrium(member, f, s->to.q) == 0) {
            done = f;
            memcpy(s->best, s->to.q, bytes);
            continue;
        }
        memcpy(s->to.q, s->best, bytes);
        step *= 0.5;
        if (++halvings > STATIC_HALVINGS) {
            s->factored = 0;
            return spari_fail(member->session, SPAR_ERR_NUMERIC,
                              "spar_member_solve_static: '%s': no equilibrium found beyond %.6g of the loads (a limit "
                              "point, or a member that nothing "
                              "holds); the state is as it was",
                              member->name, done);
        }
    }
    s->factored = 0;
    memcpy(s->begin.q, s->best, bytes);
    memset(s->begin.v, 0, (size_t)(18 * n) * sizeof(double)); /* at rest */
    memcpy(s->to.q, s->begin.q, (size_t)(25 * n) * sizeof(double));
    spari_solver_publish(member, &s->begin, &member->now);
    spari_solver_publish(member, &s->begin, &member->after);
    return SPAR_OK;
}
