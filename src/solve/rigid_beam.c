/* Members below the exact ones: what carries them, from a line that follows its root to frames and rigid beams. */
#include "rigid_beam.h"

#include "../comm/comm.h"
#include "../math/rotation.h"
#include "../member/applied.h"
#include "../member/beam.h"
#include "../member/body.h"
#include "frame.h"
#include "solver.h"

#include <stdlib.h>
#include <string.h>

/* ---- what a rung can serve ---- */

int spari_rung_check(const spar_member *m) {
    const char *call = "spar_member_commit";
    if (m->fidelity == SPAR_FIDELITY_EXACT) {
        return SPAR_OK;
    }
    SPARI_REQUIRE(m->session, m->kind == SPARI_BEAM && !m->external, SPAR_ERR_STATE,
                  "%s: '%s': a fidelity below exact is for beams that spar solves for", call, m->name);
    SPARI_REQUIRE(m->session, m->fidelity != SPAR_FIDELITY_PRESCRIBED || spari_member_root_is_given(m), SPAR_ERR_STATE,
                  "%s: '%s' is prescribed and its root is free or pinned: nothing says where it goes; fix or drive its "
                  "root, or make it rigid",
                  call, m->name);
    SPARI_REQUIRE(m->session,
                  m->beam->mass || (m->fidelity != SPAR_FIDELITY_RIGID && m->fidelity != SPAR_FIDELITY_MODAL),
                  SPAR_ERR_STATE, "%s: '%s' has no mass, which a rigid or modal member needs; give its sections mass",
                  call, m->name);
    int first, held;
    spari_solver_fixed(m, &first, &held);
    int64_t most = 6 * ((int64_t)m->elements * (m->per_element - 1) + 1) - held, least = 6 - held;
    SPARI_REQUIRE(m->session, m->fidelity != SPAR_FIDELITY_MODAL || m->modes <= most, SPAR_ERR_ARGUMENT,
                  "%s: '%s': %lld modes; its nodes have %lld", call, m->name, (long long)m->modes, (long long)most);
    SPARI_REQUIRE(m->session, m->fidelity != SPAR_FIDELITY_MODAL || m->modes >= least, SPAR_ERR_ARGUMENT,
                  "%s: '%s': %lld modes; its first %lld move it as a rigid body, give as many at least", call, m->name,
                  (long long)m->modes, (long long)least);
    return SPAR_OK;
}

int spari_rung_effects(const spar_member *m, int effects) {
    switch (m->fidelity) {
    case SPAR_FIDELITY_PRESCRIBED:
        return effects & ~(SPAR_EFFECT_INERTIA | SPAR_EFFECT_GYROSCOPIC | SPAR_EFFECT_GRAVITY | SPAR_EFFECT_DAMPING);
    case SPAR_FIDELITY_RIGID:
        return effects & ~SPAR_EFFECT_DAMPING;
    case SPAR_FIDELITY_LINEAR:
    case SPAR_FIDELITY_MODAL: /* the rotation of a root that is given is large all the same */
        return spari_member_root_is_given(m) ? effects : effects & ~SPAR_EFFECT_LARGE_ROTATION;
    default:
        return effects;
    }
}

/* ---- the body that carries a rigid member ---- */

static double *next_part(double **at, int64_t n) {
    double *here = *at;
    *at += n;
    return here;
}

/* Mass, first and second moments about the root, from the quadrature of the beam. */
static void whole_mass(const spari_body *beam, const double root[3], double out[10]) {
    int points = beam->first[beam->elements];
    memset(out, 0, 10 * sizeof *out);
    for (int k = 0; k < points; k++) {
        const double *m = beam->mass + 10 * (int64_t)k, *x = beam->place + 3 * (int64_t)k;
        double w = beam->weight[k], a[3] = {x[0] - root[0], x[1] - root[1], x[2] - root[2]}, ac = spari_dot(a, m + 1),
               aa = spari_dot(a, a);
        out[0] += w * m[0];
        for (int i = 0; i < 3; i++) {
            out[1 + i] += w * (m[0] * a[i] + m[1 + i]);
        }
        /* J + (m a.a + 2 a.mc) I - m a a^T - a mc^T - mc a^T */
        static const int row[6] = {0, 0, 0, 1, 1, 2}, col[6] = {0, 1, 2, 1, 2, 2};
        for (int t = 0; t < 6; t++) {
            int i = row[t], j = col[t];
            out[4 + t] += w * (m[4 + t] + (i == j ? m[0] * aa + 2 * ac : 0) - m[0] * a[i] * a[j] - a[i] * m[1 + j] -
                               m[1 + i] * a[j]);
        }
    }
}

static int core_create(spar_member *m) {
    spar_member *c = spari_zalloc(1, sizeof *c);
    double *block = spari_zalloc(2 * 19 + 4 * 6, sizeof *block);
    m->rung->core = c;
    if (!c || !block) {
        free(block);
        return SPAR_ERR_MEMORY;
    }
    c->xr = block; /* owns the block */
    c->now.q = next_part(&block, 7), c->now.v = next_part(&block, 6), c->now.a = next_part(&block, 6);
    c->after.q = next_part(&block, 7), c->after.v = next_part(&block, 6), c->after.a = next_part(&block, 6);
    c->dead = next_part(&block, 6), c->load_used = next_part(&block, 6), c->load_pushed = next_part(&block, 6);
    c->load_history[0] = next_part(&block, 6);
    c->session = m->session, c->name = m->name, c->kind = SPARI_RIGID, c->root = m->root, c->owner = m->owner;
    c->effects = m->effects;
    c->elements = c->per_element = 1;
    c->nodes = 1;
    c->now.q[3] = c->after.q[3] = 1;
    c->arms = spari_zalloc(1, sizeof *c->arms);
    c->body = spari_body_create(1, 1, 1, 0, 0, 1);
    if (!c->arms || !c->body) {
        return SPAR_ERR_MEMORY;
    }
    c->body->first[1] = 1;
    c->body->phi[0] = c->body->weight[0] = 1;
    c->body->gyroscopic = (m->effects & SPAR_EFFECT_GYROSCOPIC) != 0;
    c->body->length = m->body->length;
    memcpy(c->body->place, m->xr, 3 * sizeof(double));
    if (m->body->mass) { /* else neither inertia nor weight is in force */
        whole_mass(m->body, m->xr, c->body->mass);
    }
    c->solver = spari_solver_create(c);
    return c->solver ? SPAR_OK : SPAR_ERR_MEMORY;
}

static void core_free(spar_member *c) {
    if (c) {
        free(c->xr);
        free(c->arms);
        spari_body_free(c->body);
        spari_solver_free(c->solver);
        free(c);
    }
}

/* Nodal loads as force and moment on the root, and the first moments of the forces over the arms. */
static void sum_loads(const spar_member *m, const double *load, double sum[6], double Z[9]) {
    for (int64_t i = 0; i < m->nodes; i++) {
        const double *f = load + 6 * i;
        for (int k = 0; k < 6; k++) {
            sum[k] += f[k];
        }
        for (int r = 0; r < 3; r++) {
            double arm = m->xr[3 * i + r] - m->xr[r];
            for (int c = 0; c < 3; c++) {
                Z[3 * r + c] += arm * f[c];
            }
        }
    }
}

/* The nodes where a rigid motion of the root (q, v, a) takes them. */
static void move_nodes(const spar_member *m, const double *q, const double *v, const double *a, spari_motion *to) {
    for (int64_t i = 0; i < m->nodes; i++) {
        double arm[3], r[3], c1[3], c2[3], c3[3];
        for (int k = 0; k < 3; k++) {
            arm[k] = m->xr[3 * i + k] - m->xr[k];
        }
        spari_rotate(q + 3, arm, r);
        spari_cross(v + 3, r, c1);
        spari_cross(v + 3, c1, c2);
        spari_cross(a + 3, r, c3);
        for (int k = 0; k < 3; k++) {
            to->q[7 * i + k] = q[k] + r[k] - arm[k];
            to->v[6 * i + k] = v[k] + c1[k];
            to->a[6 * i + k] = a[k] + c2[k] + c3[k];
            to->v[6 * i + 3 + k] = v[3 + k];
            to->a[6 * i + 3 + k] = a[3 + k];
        }
        memcpy(to->q + 7 * i + 3, q + 3, 4 * sizeof *q);
    }
}

/* Loads that follow the nodes are taken where the last pass has put them; a few passes find them. */
enum { PASSES = 20 };

static int core_advance(spar_member *m, double dt) {
    spar_member *c = m->rung->core;
    double *extra = m->applied ? spari_applied_room(m->applied) : NULL, before[7];
    int status = SPAR_OK;
    memcpy(c->drive, m->drive, sizeof c->drive);
    memcpy(c->body->gravity, m->body->gravity, sizeof c->body->gravity);
    memcpy(c->after.q, c->now.q, 7 * sizeof(double));
    for (int pass = 0; pass < PASSES && status == SPAR_OK; pass++) {
        double dead[9] = {0};
        memset(c->dead, 0, 6 * sizeof(double));
        memset(c->load_history[0], 0, 6 * sizeof(double));
        memset(c->load_used, 0, 6 * sizeof(double));
        memset(c->arms->begin, 0, sizeof c->arms->begin);
        memset(c->arms->end, 0, sizeof c->arms->end);
        sum_loads(m, m->dead, c->dead, dead);
        sum_loads(m, m->load_history[0], c->load_history[0], c->arms->begin);
        sum_loads(m, m->load_used, c->load_used, c->arms->end);
        if (extra) {
            memset(extra, 0, (size_t)(6 * m->nodes) * sizeof *extra);
            spari_applied_nodal(m, m->now.q, extra);
            sum_loads(m, extra, c->load_history[0], c->arms->begin);
            memset(extra, 0, (size_t)(6 * m->nodes) * sizeof *extra);
            move_nodes(m, c->after.q, c->after.v, c->after.a, &m->after);
            spari_applied_nodal(m, m->after.q, extra);
            sum_loads(m, extra, c->load_used, c->arms->end);
        }
        for (int k = 0; k < 9; k++) {
            c->arms->begin[k] += dead[k];
            c->arms->end[k] += dead[k];
        }
        memcpy(before, c->after.q, sizeof before);
        status = spari_solver_advance(c, dt);
        double change = 0;
        for (int k = 0; k < 7; k++) {
            change = fmax(change, fabs(c->after.q[k] - before[k]));
        }
        if (!extra || change < 1e-13) {
            break;
        }
    }
    if (status == SPAR_OK) {
        move_nodes(m, c->after.q, c->after.v, c->after.a, &m->after);
    }
    return status;
}

int spari_rung_core(const spar_member *m, spar_member **core) {
    spar_member *c = m->rung->core;
    double *load = spari_zalloc(6 * m->nodes, sizeof *load), sum[6] = {0};
    *core = c;
    if (!load) {
        return SPAR_ERR_MEMORY;
    }
    memcpy(c->after.q, m->after.q, 7 * sizeof(double));
    memcpy(c->after.v, m->after.v, 6 * sizeof(double));
    memcpy(c->after.a, m->after.a, 6 * sizeof(double));
    memcpy(c->body->gravity, m->body->gravity, sizeof c->body->gravity);
    memset(c->arms->Z, 0, sizeof c->arms->Z);
    int status = spar_member_get_loads(m, load);
    sum_loads(m, load, sum, c->arms->Z);
    free(load);
    return status;
}

void spari_rung_carry(const spar_member *m, const double root[6], double *nodes) {
    for (int64_t i = 0; i < m->nodes; i++) {
        double *x = nodes + 6 * i, r[3];
        for (int k = 0; k < 3; k++) {
            r[k] = m->xr[3 * i + k] + m->after.q[7 * i + k] - m->xr[k] - m->after.q[k];
        }
        spari_cross(root + 3, r, x);
        for (int k = 0; k < 3; k++) {
            x[k] += root[k];
            x[3 + k] = root[3 + k];
        }
    }
}

/* ---- members without a solution ---- */

static void prescribed_advance(spar_member *m) {
    double q[7], v[6] = {0}, a[6] = {0};
    memcpy(q, m->now.q, sizeof q);
    if (m->root == SPAR_ROOT_DRIVEN) {
        memcpy(q, m->drive[1], sizeof q);
        memcpy(v, m->drive[1] + 7, sizeof v);
        memcpy(a, m->drive[1] + 13, sizeof a);
    }
    move_nodes(m, q, v, a, &m->after);
}

/* ---- life and time ---- */

int spari_rung_create(spar_member *m) {
    if (m->fidelity == SPAR_FIDELITY_EXACT) {
        return SPAR_OK;
    }
    SPARI_REQUIRE(m->session,
                  spari_member_root_is_given(m) || m->fidelity == SPAR_FIDELITY_RIGID ||
                      (m->effects & SPAR_EFFECT_INERTIA),
                  SPAR_ERR_STATE,
                  "spar_member_commit: '%s' is linear without inertia and nothing holds it: fix or drive its root, or "
                  "leave INERTIA on",
                  m->name);
    m->rung = spari_zalloc(1, sizeof *m->rung);
    int status = m->rung ? SPAR_OK : SPAR_ERR_MEMORY;
    if (status == SPAR_OK && m->fidelity == SPAR_FIDELITY_RIGID) {
        status = core_create(m);
    } else if (status == SPAR_OK && m->fidelity != SPAR_FIDELITY_PRESCRIBED) {
        return spari_frame_create(m, m->fidelity == SPAR_FIDELITY_MODAL ? m->modes : 0, &m->rung->frame);
    }
    SPARI_REQUIRE(m->session, status == SPAR_OK, status, "spar_member_commit: no memory for '%s'", m->name);
    return SPAR_OK;
}

void spari_rung_free(spari_rung *rung) {
    if (rung) {
        core_free(rung->core);
        spari_frame_free(rung->frame);
        free(rung);
    }
}

void spari_rung_restart(spar_member *m) {
    spar_member *c = m->rung->core;
    if (c) {
        memcpy(c->now.q, m->now.q, 7 * sizeof(double));
        memcpy(c->now.v, m->now.v, 6 * sizeof(double));
        memcpy(c->now.a, m->now.a, 6 * sizeof(double));
        spari_solver_restart(c->solver, c);
    } else if (m->rung->frame) {
        spari_frame_restart(m->rung->frame, m);
    }
}

int spari_rung_advance(spar_member *m, double dt) {
    if (spari_member_is_prescribed(m)) {
        prescribed_advance(m);
        return SPAR_OK;
    }
    if (m->owner != spari_comm_rank(m->session->comm)) {
        return SPAR_OK;
    }
    return m->rung->core ? core_advance(m, dt) : spari_frame_advance(m->rung->frame, m, dt);
}

void spari_rung_accept(spar_member *m) {
    spar_member *c = m->rung->core;
    if (m->owner != spari_comm_rank(m->session->comm)) {
        return;
    }
    if (c) {
        memcpy(c->now.q, c->after.q, 7 * sizeof(double));
        memcpy(c->now.v, c->after.v, 6 * sizeof(double));
        memcpy(c->now.a, c->after.a, 6 * sizeof(double));
        spari_solver_accept(c->solver);
    } else if (m->rung->frame) {
        spari_frame_accept(m->rung->frame);
    }
}

int spari_rung_static(spar_member *m, const double *fluid) {
    if (m->rung->frame) {
        return m->owner == spari_comm_rank(m->session->comm) ? spari_frame_static(m->rung->frame, m, fluid) : SPAR_OK;
    }
    double v[6] = {0}, a[6] = {0};
    if (m->root == SPAR_ROOT_DRIVEN && (spari_norm(m->now.v + 3) > 0 || spari_norm(m->now.a) > 0)) {
        memcpy(v, m->now.v, sizeof v); /* turning steadily, as the members that are solved for */
        memcpy(a, m->now.a, 3 * sizeof *a);
    }
    move_nodes(m, m->now.q, v, a, &m->after);
    return SPAR_OK;
}

int64_t spari_rung_state_size(const spar_member *m) {
    if (m->solver) {
        return spari_solver_state_size(m->solver);
    }
    if (!m->rung || spari_member_is_prescribed(m) || m->owner != spari_comm_rank(m->session->comm)) {
        return 0;
    }
    return m->rung->core ? 19 + spari_solver_state_size(m->rung->core->solver) : spari_frame_state_size(m->rung->frame);
}

void spari_rung_save(const spar_member *m, double *state) {
    if (m->solver) {
        spari_solver_save(m->solver, state);
    } else if (m->rung->core) {
        const spar_member *c = m->rung->core;
        memcpy(state, c->now.q, 7 * sizeof *state);
        memcpy(state + 7, c->now.v, 6 * sizeof *state);
        memcpy(state + 13, c->now.a, 6 * sizeof *state);
        spari_solver_save(c->solver, state + 19);
    } else {
        spari_frame_save(m->rung->frame, state);
    }
}

int spari_rung_is_state(const spar_member *m, const double *state, int64_t count) {
    if (m->solver) {
        return spari_solver_is_state(m->solver, state, count);
    }
    return m->rung->core ? count > 19 && spari_solver_is_state(m->rung->core->solver, state + 19, count - 19)
                         : spari_frame_is_state(m->rung->frame, state, count);
}

void spari_rung_load(spar_member *m, const double *state) {
    if (m->solver) {
        spari_solver_load(m->solver, state);
    } else if (m->rung->core) {
        spar_member *c = m->rung->core;
        memcpy(c->now.q, state, 7 * sizeof *state);
        memcpy(c->now.v, state + 7, 6 * sizeof *state);
        memcpy(c->now.a, state + 13, 6 * sizeof *state);
        spari_solver_load(c->solver, state + 19);
    } else {
        spari_frame_load(m->rung->frame, state);
    }
}

/* With that of followers and line loads, which a host may give while the room stands. */
int64_t spari_rung_reaction_room(const spar_member *m) {
    return (m->body ? 25 * (int64_t)m->body->unique : 0) + 12 * m->nodes;
}

void spari_rung_reaction(const spar_member *m, double *room, double load[6]) {
    int64_t n = m->body ? m->body->unique : 0;
    int still = !(m->effects & SPAR_EFFECT_INERTIA);
    double *q = room, *v = q + 7 * n, *a = v + 6 * n, *r = a + 6 * n, *sum = r + 6 * n, *extra = sum + 6 * m->nodes;
    memset(load, 0, 6 * sizeof *load);
    memset(room, 0, (size_t)spari_rung_reaction_room(m) * sizeof *room);
    int standing = m->rung->frame && m->root != SPAR_ROOT_DRIVEN;
    if (m->body) {
        for (int64_t i = 0; i < n; i++) {
            q[7 * i + 3] = 1;
        }
        if (!standing) {
            spari_member_to_unique(m, 7, m->after.q, q);
            spari_member_to_unique(m, 6, m->after.v, v);
        }
        spari_member_to_unique(m, 6, m->after.a, a);
        spari_body_residual(m->body, q, still ? NULL : v, still ? NULL : a, 1, r, NULL);
        spari_member_from_unique(m, 6, r, sum);
        for (int64_t i = m->per_element; i < m->nodes; i += m->per_element) {
            memset(sum + 6 * i, 0, 6 * sizeof *sum); /* a joint counts once */
        }
    }
    if (m->applied) {
        spari_applied_nodal(m, m->after.q, extra);
        for (int64_t i = 0; i < 6 * m->nodes; i++) {
            sum[i] -= extra[i];
        }
    }
    for (int64_t i = 0; i < m->nodes; i++) {
        double r_i[3], moment[3], f[6];
        for (int k = 0; k < 6; k++) {
            f[k] = sum[6 * i + k] - m->load_solved[1][6 * i + k];
        }
        for (int k = 0; k < 3; k++) {
            r_i[k] = m->xr[3 * i + k] - m->xr[k] + (standing ? 0 : m->after.q[7 * i + k] - m->after.q[k]);
        }
        spari_cross(r_i, f, moment);
        for (int k = 0; k < 3; k++) {
            load[k] += f[k];
            load[3 + k] += f[3 + k] + moment[k];
        }
    }
    int held = m->root == SPAR_ROOT_FREE ? 0 : m->root == SPAR_ROOT_PINNED ? 3 : 6;
    memset(load + held, 0, (size_t)(6 - held) * sizeof *load);
}

int spari_rung_energy(const spar_member *m, double energy[4]) {
    energy[1] = 0;
    return m->rung->frame ? spari_frame_energy(m->rung->frame, m, energy) : SPAR_OK;
}
