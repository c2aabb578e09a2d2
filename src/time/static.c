/* Static equilibrium by Newton with the exact tangent, in load steps. A load step is halved if Newton fails or
   leaves the path.

   From a stable state on, the equilibria under growing dead forces form a path. On this path the tangent, the second
   derivative of a potential, is positive definite up to a limit or bifurcation point. A load step is halved if it
   ends beyond such a point, or if its iterations pass a tangent of negative determinant (a jump to another branch).
   If it cannot be halved any more, the point has been found. Moments about fixed axes and follower loads have no
   potential, and their paths are not watched: for example, only symmetry keeps a beam rolled up by a moment in its
   plane. */
#include "../base/session.h"
#include "../math/rotation.h"
#include "../member/applied.h"
#include "body_solver.h"
#include "steady_rotation.h"

#include <float.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { STATIC_ITERATIONS = 50, STATIC_HALVINGS = 14 };

/* Data of a solution, apart from the solver's arrays. */
typedef struct loading {
    int rotating; /* the root rotates: equilibrium in its frame */
    spari_steady_rotation rotation, part;
    double *mass;  /* if rotating: an element's mass matrix */
    int guarded;   /* the path is watched */
    double *v, *a; /* rates of the steady rotation; NULL: at rest */
} loading;

/* Forces less loads at load factor f. Returns the size that rounding errors are relative to. */
static double balance_at(const spari_solver *s, const spar_member *m, loading *l, double f, const double *q,
                         double *r) {
    const spari_body body = spari_body_in_part(s->body, f);
    double scale;
    if (l->rotating) {
        l->part = spari_steady_rotation_part(&l->rotation, f);
        spari_steady_rotation_rates(m, &l->part, q, l->v, l->a);
        scale = spari_steady_rotation_residual(&body, q, l->v, l->a, f, r);
    } else {
        scale = spari_body_residual(&body, q, NULL, NULL, f, r, NULL);
    }
    for (int i = 0; i < 6 * s->n; i++) {
        r[i] -= f * s->steps.load[i];
        scale = fmax(scale, fabs(f * s->steps.load[i]));
    }
    if (spari_carries_loads(m)) {
        scale = fmax(scale, spari_applied_residual(m, q, f, r));
    }
    return scale;
}

/* The tangent at a state for which `balance_at` has been called, not yet factored. */
static void form_static_tangent(const spari_solver *s, const spar_member *m, loading *l, double f, const double *q) {
    const spari_body body = spari_body_in_part(s->body, f);
    spari_linear_zero(s->linear);
    for (int e = 0; e < s->body->elements; e++) {
        if (l->rotating) {
            spari_steady_rotation_tangent(&body, &l->part, e, q, l->v, l->a, f, s->body->matrix, l->mass);
        } else {
            spari_body_tangent(&body, e, q, NULL, NULL, f, 0, 0, NULL, s->body->matrix);
        }
        if (spari_carries_loads(m)) {
            spari_applied_tangent(m, e, q, f, s->body->matrix);
        }
        spari_linear_add(s->linear, e, s->body->matrix);
    }
    for (int i = 0; i < spari_member_constrained(m); i++) {
        spari_linear_fix(s->linear, i);
    }
}

void spari_static_shift(int n, double cut, const double *dx, double *q) {
    for (int i = 0; i < n; i++) {
        double rotation[3], p[4];
        for (int k = 0; k < 3; k++) {
            q[7 * i + k] -= cut * dx[6 * i + k];
            rotation[k] = -cut * dx[6 * i + 3 + k];
        }
        spari_quat_exp(rotation, p);
        spari_quat_mul(p, q + 7 * i + 3, q + 7 * i + 3);
        spari_quat_normalise(q + 7 * i + 3);
    }
}

typedef enum outcome { FOUND, FAILED, LOST, LONG } outcome;

/* Whether a state in equilibrium, with the rates of the last `balance_at`, is on the path or beyond its end. */
static outcome judge(const spari_solver *s, const spar_member *m, loading *l, double f, const double *q) {
    if (!l->guarded) {
        return FOUND;
    }
    form_static_tangent(s, m, l, f, q);
    return spari_linear_definite(s->linear) == 0 ? LOST : FOUND;
}

/* One Newton solution at load factor f, from and to state q; from_path: q is a point of the path. */
static outcome equilibrium(spari_solver *s, const spar_member *member, loading *l, double f, int from_path, double *q) {
    int n = s->n;
    double last = 0, length = s->body->length;
    const double longest = 0.8; /* a correction rotates no node by more (rad), and moves it by no more of the length */
    for (int it = 0; it < STATIC_ITERATIONS; it++) {
        double scale = balance_at(s, member, l, f, q, s->r), noise = 0;
        memset(s->r, 0, (size_t)spari_member_constrained(member) * sizeof *s->r);
        for (int i = 0; i < 6 * n; i++) {
            noise = fmax(noise, fabs(s->r[i]));
        }
        if (!isfinite(noise)) {
            return FAILED;
        }
        form_static_tangent(s, member, l, f, q);
        s->factors++;
        memcpy(s->dx, s->r, (size_t)(6 * n) * sizeof *s->dx);
        if (spari_linear_factor(s->linear) || spari_linear_solve(s->linear, s->dx)) {
            return FAILED;
        }
        if (l->guarded && from_path && spari_linear_sign(s->linear) < 0) {
            return LOST;
        }
        double largest = 0;
        for (int i = 0; i < n; i++) {
            largest = fmax(largest, fmax(spari_norm(s->dx + 6 * i) / length, spari_norm(s->dx + 6 * i + 3)));
        }
        double cut = largest > longest ? longest / largest : 1;
        spari_static_shift(n, cut, s->dx, q);
        /* quadratic: a correction of 1e-8 leaves 1e-16; or the balance is as good as rounding lets it be */
        if (cut == 1 && (largest < 1e-9 || noise <= 16 * DBL_EPSILON * scale ||
                         (largest < 1e-7 && last > 0 && largest > 0.5 * last))) {
            return judge(s, member, l, f, q);
        }
        last = largest;
    }
    return FAILED;
}

/* Whether the path can be watched: the loads have a potential, the root holds the member, and the member is not
   linear. */
static int has_path(const spari_solver *s, const spar_member *m) {
    int moments = 0;
    for (int i = 0; i < s->n; i++) {
        moments |= spari_norm(s->steps.load + 6 * i + 3) > 0;
    }
    return !moments && m->root != SPAR_ROOT_PINNED && (!m->load.applied || spari_applied_potential(m));
}

/* Whether the state without loads is in equilibrium: the path begins there. */
static int starts_on_path(const spari_solver *s, const spar_member *m, loading *l, const double *q) {
    if (!l->guarded) {
        return 0;
    }
    balance_at(s, m, l, 0, q, s->r);
    for (int i = spari_member_constrained(m); i < 6 * s->n; i++) {
        if (fabs(s->r[i]) > 1e-9 * s->body->stiffest) {
            return 0;
        }
    }
    return 1;
}

/* Load steps from 0 to the full load, s->to.q from `start`, which may be the same array. The last point is in
   s->best. Returns the part of the load that was reached. */
static double follow_path(spari_solver *s, const spar_member *member, loading *l, const double *start, int load_steps,
                          outcome *why) {
    size_t bytes = (size_t)(7 * s->n) * sizeof(double);
    double done = 0, step = 1.0 / load_steps;
    int halvings = 0, on_path = starts_on_path(s, member, l, start), left = load_steps + SPARI_STATIC_MORE;
    memcpy(s->best, start, bytes);
    memcpy(s->to.q, s->best, bytes);
    while (done < 1) {
        if (left-- == 0) {
            *why = LONG;
            break;
        }
        double f = done + step > 1 - 1e-12 ? 1 : done + step;
        outcome o = equilibrium(s, member, l, f, on_path, s->to.q);
        if (o == FOUND) {
            done = f;
            on_path = 1;
            memcpy(s->best, s->to.q, bytes);
            continue;
        }
        *why = o;
        memcpy(s->to.q, s->best, bytes);
        step *= 0.5;
        if (++halvings > STATIC_HALVINGS) {
            break;
        }
    }
    return done;
}

/* The largest rotation between neighbouring nodes of the state q, rad. */
static double largest_bend(const spari_solver *s, const double *q) {
    double largest = 0;
    for (int i = 1; i < s->n; i++) {
        double back[4], rotation[4], psi[3];
        spari_quat_conj(q + 7 * i - 4, back);
        spari_quat_mul(back, q + 7 * i + 3, rotation);
        spari_quat_log(rotation, psi);
        largest = fmax(largest, spari_norm(psi));
    }
    return largest;
}

/* With a larger rotation between nodes, the shape between them is not determined: a circle of 5 turns on 24 nodes
   (2.1 rad) is accurate to 5e-4, one of 7 turns (3 rad) is another curve. If Newton has failed, 1 rad suffices for
   this message: 10 nodes of an element fail at 1.7 rad. */
static const double most_bend = 2.2, suspect_bend = 1;

static int refuse(const spari_solver *s, const spar_member *member, double done, outcome why) {
    double bend = largest_bend(s, s->best);
    char text[200] = "a limit point, or a member free to move as a rigid body";
    if (why == LOST) {
        (void)snprintf(text, sizeof text, "a limit or bifurcation point: the stiffness is not positive definite");
    } else if (why == LONG) {
        (void)snprintf(text, sizeof text, "it needs more than %d additional load steps; request more load steps",
                       SPARI_STATIC_MORE);
    } else if (bend > suspect_bend) {
        (void)snprintf(text, sizeof text,
                       "neighbouring nodes are rotated by %.2g rad relative to each other, more than the elements "
                       "resolve; give the beam more nodes or elements",
                       bend);
    }
    return spari_fail(member->session, SPAR_ERR_NUMERIC,
                      "member '%s': no %sequilibrium found beyond %.6g of the loads (%s); the state is unchanged. "
                      "Apply smaller loads, or run time steps",
                      member->name, why == LOST ? "stable " : "", done, text);
}

/* Refuses an equilibrium of the nodes that is not one of the beam. */
static void warn_of_bend(const spari_solver *s, const spar_member *m) {
    char text[SPARI_MESSAGE_SIZE];
    double bend = m->session->callbacks.log ? largest_bend(s, s->best) : 0;
    if (bend <= most_bend) {
        return;
    }
    (void)snprintf(text, sizeof text,
                   "static equilibrium of '%s': neighbouring nodes are rotated by %.2g rad relative to each other, "
                   "more than the elements resolve; the result may be wrong; give the beam more nodes or elements",
                   m->name, bend);
    spari_log(m->session, SPAR_LOG_WARNING, text);
}

static int no_memory_to_balance(const spar_member *member) {
    return spari_fail(member->session, SPAR_ERR_MEMORY, "member '%s': no memory for its equilibrium", member->name);
}

/* Stores the shape that was found, at rest or in steady rotation. */
static void give_equilibrium(spari_solver *s, const spar_member *member, const loading *l) {
    memcpy(s->to.q, s->best, (size_t)(7 * s->n) * sizeof *s->best);
    memset(s->to.v, 0, (size_t)(18 * s->n) * sizeof(double));
    if (l->rotating) {
        spari_steady_rotation_rates(member, &l->rotation, s->to.q, s->to.v, s->to.a);
    }
}

int spari_solver_static(spari_solver *s, const spar_member *member, int load_steps, int onward) {
    int n = s->n;
    loading l = {0};
    outcome why = FAILED;
    l.rotating =
        member->root == SPAR_ROOT_DRIVEN && spari_steady_rotation_of(member, member->now.v, member->now.a, &l.rotation);
    l.v = s->to.v, l.a = s->to.a;
    if (l.rotating) {
        l.mass = spari_zalloc(36 * (int64_t)member->mesh.per_element * member->mesh.per_element, sizeof *l.mass);
        if (!l.mass) {
            return no_memory_to_balance(member);
        }
    }
    l.guarded = has_path(s, member);
    if (l.guarded && spari_linear_watch(s->linear)) {
        free(l.mass);
        return no_memory_to_balance(member);
    }
    double done = onward ? follow_path(s, member, &l, s->to.q, 1, &why) : 0;
    done = done < 1 ? follow_path(s, member, &l, s->begin.q, load_steps, &why) : done;
    free(l.mass);
    spari_linear_unwatch(s->linear);
    s->factored = 0;
    spari_snapshot_close(&s->before);
    if (done < 1) {
        memcpy(s->to.q, s->begin.q, (size_t)(25 * n) * sizeof *s->to.q);
        return refuse(s, member, done, why);
    }
    warn_of_bend(s, member);
    give_equilibrium(s, member, &l);
    return SPAR_OK;
}
