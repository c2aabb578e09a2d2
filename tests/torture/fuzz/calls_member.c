/* The calls on members. */
#include "fuzz.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- create ---- */

static live_member *free_member(call *c) {
    for (int i = 0; i < MEMBERS; i++) {
        if (!c->w->member[i].m) {
            return c->w->member + i;
        }
    }
    return NULL;
}

static void made(call *c, live_member *at, spar_member *m, int kind, int elements, int per_element) {
    if ((c->status == SPAR_OK) != (m != NULL)) {
        fuzz_finding("handle", "%s answers %d and %s a handle", c->what->name, c->status, m ? "writes" : "writes no");
    }
    if (m) {
        *at = (live_member){m, c->session, kind, elements, per_element, 0, ++c->w->clock};
    }
}

void do_spar_point_create(call *c) {
    live_member *at = free_member(c);
    if (!at) {
        return;
    }
    live_session *l = arg_session(c);
    const char *name = arg_name(c, "p");
    double *x = arg_reals_or_null(c, 3, -1, 1), *q = arg_quaternions(c, 1, 1);
    spar_member *m = NULL;
    int nowhere = odd(c);
    text(c, nowhere ? ", NULL" : ", &m%d", (int)(at - c->w->member));
    RUN(c, spar_point_create(l->s, name, x, q, nowhere ? NULL : &m));
    made(c, at, m, KIND_POINT, 1, 1);
}

void do_spar_rigid_create(call *c) {
    live_member *at = free_member(c);
    if (!at) {
        return;
    }
    live_session *l = arg_session(c);
    const char *name = arg_name(c, "r");
    double *x = arg_reals_or_null(c, 3, -1, 1), *q = arg_quaternions(c, 1, 1), *mass = arg_mass(c, 1, 0);
    spar_member *m = NULL;
    int nowhere = odd(c);
    text(c, nowhere ? ", NULL" : ", &m%d", (int)(at - c->w->member));
    RUN(c, spar_rigid_create(l->s, name, x, q, mass, nowhere ? NULL : &m));
    made(c, at, m, KIND_RIGID, 1, 1);
}

void do_spar_beam_create(call *c) {
    live_member *at = free_member(c);
    if (!at) {
        return;
    }
    static const int strange[] = {0, -1, INT_MIN, INT_MAX, 1, 25, 100};
    live_session *l = arg_session(c);
    const char *name = arg_name(c, "b");
    int elements = odd(c) ? strange[below(c, 5)] : 1 + (below(c, 3) == 0), nodes = odd(c) ? strange[below(c, 7)]
                                                                                   : below(c, 200) == 0
                                                                                       ? 2 + below(c, 23)
                                                                                       : 2 + below(c, 3);
    spar_member *m = NULL;
    int nowhere = odd(c);
    text(c, ", %d, %d, %s%d", elements, nowhere ? 0 : nodes, nowhere ? "NULL or " : "&m", (int)(at - c->w->member));
    RUN(c, spar_beam_create(l->s, name, elements, nodes, nowhere ? NULL : &m));
    made(c, at, m, KIND_BEAM, elements, nodes);
}

/* ---- describe ---- */

void do_spar_beam_set_axis(call *c) {
    live_member *b = arg_member(c, KIND_BEAM);
    int64_t n = arg_count(c, 2, 4), room = length(n);
    double *eta = arg_rising(c, room, 0, 1), line[3 * 4] = {0}, length = uniform(c, 0.5, 2), bend = uniform(c, 0, 0.3);
    for (int64_t i = 0; i < room; i++) {
        double s = room > 1 ? (double)i / (double)(room - 1) : 0;
        line[3 * i] = length * s;
        line[3 * i + 1] = bend * s * s;
        line[3 * i + 2] = -0.5 * bend * s;
    }
    double *xyz = arg_given(c, line, 3 * room), *twist = arg_reals_or_null(c, room, -0.5, 0.5);
    RUN(c, spar_beam_set_axis(b->m, n, eta, xyz, twist));
}

/* Gauss-Lobatto-Legendre points of up to 4 nodes; of more, places that are not far from them. */
static double place_in_element(int k, int nodes) {
    static const double four[4] = {-1, -0.44721359549995794, 0.44721359549995794, 1};
    return nodes == 4 ? four[k] : -cos(3.14159265358979323846 * k / (nodes - 1));
}

void do_spar_beam_set_nodes(call *c) {
    live_member *b = arg_member(c, KIND_BEAM);
    int P = b->per_element > 1 ? b->per_element : 2, E = b->elements > 0 ? b->elements : 1;
    int64_t n = (int64_t)E * P;
    if (n > 64) {
        return;
    }
    double line[3 * 64] = {0}, bend = uniform(c, 0, 0.2);
    for (int e = 0; e < E; e++) {
        for (int k = 0; k < P; k++) {
            double s = (e + 0.5 * (1 + place_in_element(k, P))) / E, *x = line + 3 * (e * P + k);
            x[0] = s;
            x[2] = bend * s * s;
        }
    }
    double *x = arg_given(c, line, 3 * n), *q = chance(c, 70) ? NULL : arg_quaternions(c, n, 1);
    n = odd(c) ? arg_count(c, 0, 1) : n;
    RUN(c, spar_beam_set_nodes(b->m, n, x, q));
}

void do_spar_beam_set_sections(call *c) {
    live_member *b = arg_member(c, KIND_BEAM);
    int64_t n = arg_count(c, 1, 3), room = length(n);
    double *eta = arg_rising(c, room, 0, 1), *K = arg_stiffness(c, room), *M = arg_mass(c, room, 1);
    c->wild |= !M;
    RUN(c, spar_beam_set_sections(b->m, n, eta, K, M));
}

void do_spar_beam_set_quadrature(call *c) {
    live_member *b = arg_member(c, KIND_BEAM);
    int rule = arg_int(c, SPAR_QUADRATURE_GAUSS, SPAR_QUADRATURE_SECTIONS);
    int points = odd(c) ? arg_int(c, 1, 512) : 4 + below(c, 4);
    text(c, ", %d", points);
    RUN(c, spar_beam_set_quadrature(b->m, rule, points));
}

void do_spar_beam_set_damping(call *c) {
    live_member *b = arg_member(c, KIND_BEAM);
    double *mu = arg_reals(c, 6, 0, 1e-3);
    RUN(c, spar_beam_set_damping(b->m, mu));
}

void do_spar_beam_read_beamdyn(call *c) {
    static const char *const files[] = {
        SPAR_SOURCE_DIR "/tests/data/bend_primary.inp", SPAR_SOURCE_DIR "/tests/data/blade_primary.inp",
        SPAR_SOURCE_DIR "/tests/data/bend_blade.inp", SPAR_SOURCE_DIR "/tests/data/blade_blade.inp", "nowhere.inp"};
    live_member *b = arg_member(c, KIND_BEAM);
    const char *primary = files[below(c, odd(c) ? 5 : 2)], *blade = odd(c)          ? files[below(c, 5)]
                                                                    : chance(c, 50) ? NULL
                                                                                    : files[2 + below(c, 2)];
    primary = odd(c) ? NULL : primary;
    text(c, ", %s, %s", primary ? primary : "NULL", blade ? blade : "NULL");
    c->wild = 1; /* as heavy and soft as they are */
    RUN(c, spar_beam_read_beamdyn(b->m, primary, blade));
}

void do_spar_member_set_placement(call *c) {
    live_member *m = arg_member(c, -1);
    double *x = arg_reals_or_null(c, 3, -2, 2), *q = arg_quaternions(c, 1, 1);
    RUN(c, spar_member_set_placement(m->m, x, q));
}

void do_spar_member_set_root(call *c) {
    live_member *m = arg_member(c, -1);
    int kind = arg_int(c, SPAR_ROOT_FREE, SPAR_ROOT_DRIVEN);
    RUN(c, spar_member_set_root(m->m, kind));
}

void do_spar_member_set_external(call *c) {
    live_member *m = arg_member(c, -1);
    int on = arg_int(c, 0, 1);
    RUN(c, spar_member_set_external(m->m, on));
}

void do_spar_member_set_effects(call *c) {
    live_member *m = arg_member(c, -1);
    int on = chance(c, 30) ? 0 : arg_flags(c, 4095 & ~(16 | 256)), off = arg_flags(c, 4095 & ~(16 | 256));
    off &= chance(c, 95) ? ~on : ~0;
    c->wild |= off & SPAR_EFFECT_INERTIA; /* nothing may hold it */
    RUN(c, spar_member_set_effects(m->m, on, off));
}

void do_spar_beam_set_mass_damping(call *c) {
    live_member *m = arg_member(c, -1);
    double alpha = chance(c, 30) ? 0 : arg_real(c, 0, 2);
    RUN(c, spar_beam_set_mass_damping(m->m, alpha));
}

void do_spar_beam_get_mass_damping(call *c) {
    live_member *m = arg_member(c, -1);
    double *alpha = OUT_OR_NULL(c, 1);
    RUN(c, spar_beam_get_mass_damping(m->m, alpha));
}

void do_spar_beam_set_plane(call *c) {
    live_member *m = arg_member(c, -1);
    const double normal[3] = {arg_real(c, -1, 1), arg_real(c, -1, 1), arg_real(c, -1, 1)};
    RUN(c, spar_beam_set_plane(m->m, chance(c, 50) ? NULL : normal));
}

void do_spar_beam_get_plane(call *c) {
    live_member *m = arg_member(c, -1);
    double *normal = OUT_OR_NULL(c, 3);
    RUN(c, spar_beam_get_plane(m->m, normal));
}

void do_spar_beam_set_masses(call *c) {
    live_member *m = arg_member(c, -1);
    int64_t n = chance(c, 10) ? 0 : arg_count(c, 1, 3), room = length(n);
    double *eta = arg_rising(c, room, 0, 1), *M = arg_mass(c, room, 1);
    RUN(c, spar_beam_set_masses(m->m, n, eta, M));
}

void do_spar_beam_set_foundation(call *c) {
    live_member *m = arg_member(c, -1);
    int64_t n = chance(c, 20) ? 0 : arg_count(c, 1, 3), room = length(n);
    double *eta = arg_rising(c, room, 0, 1), *k = arg_reals(c, 3 * room, 0, 100);
    RUN(c, spar_beam_set_foundation(m->m, n, eta, k));
}

void do_spar_beam_get_foundation(call *c) {
    live_member *m = arg_member(c, -1);
    int64_t *n = arg_out(c, (int64_t)sizeof *n, 1), capacity = arg_count(c, 0, 3);
    double *eta = OUT_OR_NULL(c, length(capacity)), *k = OUT_OR_NULL(c, 3 * length(capacity));
    RUN(c, spar_beam_get_foundation(m->m, n, capacity, eta, k));
}

void do_spar_beam_set_pretension(call *c) {
    live_member *m = arg_member(c, -1);
    int64_t n = chance(c, 20) ? 0 : arg_count(c, 1, 3), room = length(n);
    double *eta = arg_rising(c, room, 0, 1), *force = arg_reals(c, 6 * room, -10, 100);
    RUN(c, spar_beam_set_pretension(m->m, n, eta, force));
}

void do_spar_beam_get_pretension(call *c) {
    live_member *m = arg_member(c, -1);
    int64_t *n = arg_out(c, (int64_t)sizeof *n, 1), capacity = arg_count(c, 0, 3);
    double *eta = OUT_OR_NULL(c, length(capacity)), *force = OUT_OR_NULL(c, 6 * length(capacity));
    RUN(c, spar_beam_get_pretension(m->m, n, capacity, eta, force));
}

void do_spar_beam_get_masses(call *c) {
    live_member *m = arg_member(c, -1);
    int64_t *n = arg_out(c, (int64_t)sizeof *n, 1), capacity = arg_count(c, 0, 3);
    double *eta = OUT_OR_NULL(c, length(capacity)), *M = OUT_OR_NULL(c, 36 * length(capacity));
    RUN(c, spar_beam_get_masses(m->m, n, capacity, eta, M));
}

void do_spar_member_set_added_mass(call *c) {
    live_member *m = arg_member(c, -1);
    int64_t n = chance(c, 10) ? 0 : m->kind == KIND_BEAM ? arg_count(c, 1, 3) : arg_count(c, 1, 1), room = length(n);
    double *eta = arg_rising(c, room, 0, 1), *M = arg_mass(c, room, 1);
    c->wild |= n > 0; /* the fluid has no such mass: extrapolated over unequal steps the difference may grow */
    RUN(c, spar_member_set_added_mass(m->m, n, eta, M));
}

void do_spar_member_get_added_mass(call *c) {
    live_member *m = arg_member(c, -1);
    int64_t *n = arg_out(c, (int64_t)sizeof *n, 1), capacity = arg_count(c, 0, 3);
    double *eta = OUT_OR_NULL(c, length(capacity)), *M = OUT_OR_NULL(c, 36 * length(capacity));
    RUN(c, spar_member_get_added_mass(m->m, n, capacity, eta, M));
}

void do_spar_member_set_added_mass_response(call *c) {
    live_member *m = arg_member(c, -1);
    int response = arg_int(c, 0, 1);
    RUN(c, spar_member_set_added_mass_response(m->m, response));
}

void do_spar_member_get_added_mass_response(call *c) {
    live_member *m = arg_member(c, -1);
    int *response = arg_out(c, (int64_t)sizeof *response, 0);
    RUN(c, spar_member_get_added_mass_response(m->m, response));
}

void do_spar_member_learn_added_mass(call *c) {
    live_member *m = arg_member(c, -1);
    int64_t n = chance(c, 10) ? 0 : m->kind == KIND_BEAM ? arg_count(c, 1, 3) : arg_count(c, 1, 1), room = length(n);
    double *eta = arg_rising(c, room, 0, 1);
    c->wild |= n > 0;
    RUN(c, spar_member_learn_added_mass(m->m, n, eta));
}

void do_spar_member_get_learned_added_mass(call *c) {
    live_member *m = arg_member(c, -1);
    int *used = arg_out(c, (int64_t)sizeof *used, 1);
    int64_t *n = arg_out(c, (int64_t)sizeof *n, 1), capacity = arg_count(c, 0, 3);
    double *spread = OUT_OR_NULL(c, 1), *eta = OUT_OR_NULL(c, length(capacity)),
           *M = OUT_OR_NULL(c, 36 * length(capacity));
    RUN(c, spar_member_get_learned_added_mass(m->m, used, spread, n, capacity, eta, M));
}

void do_spar_member_set_fidelity(call *c) {
    live_member *m = arg_member(c, KIND_BEAM);
    int kind = arg_int(c, SPAR_FIDELITY_PRESCRIBED, SPAR_FIDELITY_EXACT);
    int64_t modes = chance(c, 10) ? arg_count(c, 1, 60) : 1 + below(c, 9);
    text(c, ", %lld", (long long)modes);
    RUN(c, spar_member_set_fidelity(m->m, kind, modes));
}

void do_spar_member_set_initial_velocity(call *c) {
    live_member *m = arg_member(c, -1);
    double *x0 = arg_reals_or_null(c, 3, -1, 1), *v0 = arg_reals_or_null(c, 3, -0.1, 0.1),
           *omega = arg_reals_or_null(c, 3, -1, 1);
    RUN(c, spar_member_set_initial_velocity(m->m, x0, v0, omega));
}

void do_spar_member_set_owner(call *c) {
    live_member *m = arg_member(c, -1);
    int rank = arg_int(c, 0, 0);
    RUN(c, spar_member_set_owner(m->m, rank));
}

void do_spar_member_commit(call *c) {
    live_member *m = arg_member(c, -1);
    RUN(c, spar_member_commit(m->m));
    if (c->status == SPAR_OK) {
        m->committed = 1;
    }
}

/* ---- the state ---- */

static void is_finite(const call *c, const double *x, int64_t n) {
    for (int64_t i = 0; x && c->status == SPAR_OK && i < n; i++) {
        if (!isfinite(x[i])) {
            fuzz_finding("finite", "%s gives %g", c->what->name, x[i]);
        }
    }
}

void do_spar_member_get_count(call *c) {
    live_member *m = arg_member(c, -1);
    int64_t *n = arg_out(c, sizeof *n, 0);
    RUN(c, spar_member_get_count(m->m, n));
}

void do_spar_member_get_reference(call *c) {
    live_member *m = arg_member(c, -1);
    int64_t n = nodes_of(m);
    double *x = OUT_OR_NULL(c, 3 * n), *q = OUT_OR_NULL(c, 4 * n);
    RUN(c, spar_member_get_reference(m->m, x, q));
    is_finite(c, x, 3 * n);
}

void do_spar_member_get_motion(call *c) {
    live_member *m = arg_member(c, -1);
    int64_t n = nodes_of(m);
    double *q = OUT_OR_NULL(c, 7 * n), *v = OUT_OR_NULL(c, 6 * n), *a = OUT_OR_NULL(c, 6 * n);
    RUN(c, spar_member_get_motion(m->m, q, v, a));
    is_finite(c, q, 7 * n);
    is_finite(c, v, 6 * n);
    is_finite(c, a, 6 * n);
}

void do_spar_member_set_motion(call *c) {
    live_member *m = arg_member(c, chance(c, 70) ? KIND_POINT : -1);
    int64_t n = nodes_of(m);
    double *q = chance(c, 30) ? NULL : arg_motions(c, n), *v = arg_reals_or_null(c, 6 * n, -0.1, 0.1),
           *a = arg_reals_or_null(c, 6 * n, -1, 1);
    RUN(c, spar_member_set_motion(m->m, q, v, a));
}

void do_spar_member_drive(call *c) {
    live_member *m = arg_member(c, -1);
    double *q = arg_motions(c, 1), *v = arg_reals_or_null(c, 6, -0.1, 0.1), *a = arg_reals_or_null(c, 6, -1, 1);
    RUN(c, spar_member_drive(m->m, q, v, a));
}

static int64_t arg_node(call *c, const live_member *m) {
    static const int64_t list[] = {-1, INT64_MIN, INT64_MAX, 100, INT64_C(1) << 32, INT64_C(1) << 61};
    int64_t n = nodes_of(m), node = odd(c) ? list[below(c, 6)] : n > 0 ? below(c, (int)n) : 0;
    text(c, ", %lld", (long long)node);
    return node;
}

void do_spar_member_set_load(call *c) {
    live_member *m = arg_member(c, -1);
    int64_t node = arg_node(c, m);
    int kind = arg_int(c, SPAR_LOAD_DEAD, SPAR_LOAD_FOLLOWER);
    double *load = arg_reals(c, 6, -1, 1);
    RUN(c, spar_member_set_load(m->m, node, kind, load));
}

void do_spar_beam_set_line_load(call *c) {
    live_member *b = arg_member(c, KIND_BEAM);
    int64_t n = chance(c, 10) ? 0 : arg_count(c, 1, 3), room = length(n);
    double *eta = arg_rising(c, room, 0, 1), *load = arg_reals(c, 6 * room, -1, 1);
    int kind = arg_int(c, SPAR_LOAD_DEAD, SPAR_LOAD_FOLLOWER);
    RUN(c, spar_beam_set_line_load(b->m, kind, n, eta, load));
}

static int64_t *arg_modes(call *c, int64_t n) {
    static const int64_t odds[] = {-1, INT64_MIN, INT64_MAX, 5, 1000};
    int64_t *mode = arg_out(c, n * (int64_t)sizeof *mode, 0);
    for (int k = 0; mode && k < n; k++) {
        mode[k] = odd(c) ? odds[below(c, 5)] : below(c, 4);
        text(c, ", %lld", (long long)mode[k]);
    }
    return mode;
}

void do_spar_beam_fit_damping(call *c) {
    live_member *b = arg_member(c, KIND_BEAM);
    int64_t n = arg_count(c, 1, 5), *mode = arg_modes(c, length(n));
    double *ratio = arg_reals(c, length(n), 0.001, 0.05), *achieved = OUT_OR_NULL(c, length(n));
    RUN(c, spar_beam_fit_damping(b->m, n, mode, ratio, achieved));
}

void do_spar_beam_set_modal_damping(call *c) {
    live_member *b = arg_member(c, KIND_BEAM);
    int64_t *mode = arg_modes(c, 2);
    double *ratio = arg_reals(c, 2, 0.001, 0.05), *mu = OUT_OR_NULL(c, 6);
    RUN(c, spar_beam_set_modal_damping(b->m, mode, ratio, mu));
}

void do_spar_member_get_placement(call *c) {
    live_member *m = arg_member(c, -1);
    double *x = arg_out(c, 3 * (int64_t)sizeof *x, 1);
    double *q = arg_out(c, 4 * (int64_t)sizeof *q, 1);
    RUN(c, spar_member_get_placement(m->m, x, q));
}

void do_spar_member_get_session(call *c) {
    live_member *m = arg_member(c, -1);
    spar_session **session = arg_out(c, (int64_t)sizeof(spar_session *), 1);
    RUN(c, spar_member_get_session(m->m, session));
    if (c->status == SPAR_OK && *session != c->w->session[m->session].s) {
        fuzz_finding("handle", "another session");
    }
}

void do_spar_member_get_name(call *c) {
    live_member *m = arg_member(c, -1);
    RUN_VOID(c, is_name(spar_member_get_name(m->m)));
}

void do_spar_member_get_root(call *c) {
    live_member *m = arg_member(c, -1);
    int *kind = arg_out(c, (int64_t)sizeof *kind, 1);
    RUN(c, spar_member_get_root(m->m, kind));
}

void do_spar_member_get_external(call *c) {
    live_member *m = arg_member(c, -1);
    int *on = arg_out(c, (int64_t)sizeof *on, 1);
    RUN(c, spar_member_get_external(m->m, on));
}

void do_spar_member_get_effects(call *c) {
    live_member *m = arg_member(c, -1);
    int *effects = arg_out(c, (int64_t)sizeof *effects, 1);
    RUN(c, spar_member_get_effects(m->m, effects));
}

void do_spar_member_get_fidelity(call *c) {
    live_member *m = arg_member(c, -1);
    int *kind = arg_out(c, (int64_t)sizeof *kind, 1);
    int64_t *modes = arg_out(c, (int64_t)sizeof *modes, 1);
    RUN(c, spar_member_get_fidelity(m->m, kind, modes));
}

void do_spar_member_get_owner(call *c) {
    live_member *m = arg_member(c, -1);
    int *rank = arg_out(c, (int64_t)sizeof *rank, 1);
    RUN(c, spar_member_get_owner(m->m, rank));
}

void do_spar_beam_get_elements(call *c) {
    live_member *m = arg_member(c, KIND_BEAM);
    int *elements = arg_out(c, (int64_t)sizeof *elements, 1);
    int *nodes_per_element = arg_out(c, (int64_t)sizeof *nodes_per_element, 1);
    RUN(c, spar_beam_get_elements(m->m, elements, nodes_per_element));
}

void do_spar_beam_get_quadrature(call *c) {
    live_member *m = arg_member(c, KIND_BEAM);
    int *rule = arg_out(c, (int64_t)sizeof *rule, 1);
    int *points = arg_out(c, (int64_t)sizeof *points, 1);
    RUN(c, spar_beam_get_quadrature(m->m, rule, points));
}

void do_spar_beam_get_damping(call *c) {
    live_member *m = arg_member(c, KIND_BEAM);
    double *mu = arg_out(c, 6 * (int64_t)sizeof *mu, 1);
    RUN(c, spar_beam_get_damping(m->m, mu));
}

void do_spar_member_get_loads(call *c) {
    live_member *m = arg_member(c, -1);
    double *load = OUT(c, 6 * nodes_of(m));
    RUN(c, spar_member_get_loads(m->m, load));
}

void do_spar_member_get_reaction(call *c) {
    live_member *m = arg_member(c, -1);
    double *load = OUT(c, 6);
    RUN(c, spar_member_get_reaction(m->m, load));
}

void do_spar_beam_evaluate(call *c) {
    live_member *b = arg_member(c, KIND_BEAM);
    int64_t n = arg_count(c, 0, 4), room = length(n);
    double *eta = arg_reals(c, room, 0, 1), *strain = OUT_OR_NULL(c, 6 * room), *force = OUT_OR_NULL(c, 6 * room),
           *x = OUT_OR_NULL(c, 3 * room), *q = OUT_OR_NULL(c, 4 * room);
    RUN(c, spar_beam_evaluate(b->m, n, eta, strain, force, x, q));
}

void do_spar_member_get_energy(call *c) {
    live_member *m = arg_member(c, -1);
    int64_t n = arg_count(c, 0, SPAR_ENERGY_COUNT + 2);
    double *energy = OUT_OR_NULL(c, length(n));
    RUN(c, spar_member_get_energy(m->m, n, energy));
}

void do_spar_member_estimate_error(call *c) {
    live_member *m = arg_member(c, -1);
    double *step = OUT_OR_NULL(c, 1), *nodes = OUT_OR_NULL(c, 1);
    RUN(c, spar_member_estimate_error(m->m, step, nodes));
}

void do_spar_member_get_iterations(call *c) {
    live_member *m = arg_member(c, -1);
    int64_t *iterations = arg_out(c, (int64_t)sizeof *iterations, 1);
    double *left = OUT_OR_NULL(c, 1);
    RUN(c, spar_member_get_iterations(m->m, iterations, left));
}

void do_spar_member_get_work(call *c) {
    live_member *m = arg_member(c, -1);
    int64_t n = arg_count(c, 0, SPAR_WORK_COUNT + 2);
    double *work = OUT_OR_NULL(c, length(n));
    RUN(c, spar_member_get_work(m->m, n, work));
}

void do_spar_member_solve_static(call *c) {
    live_member *m = arg_member(c, -1);
    int steps = arg_limit(c, 1, 3);
    RUN(c, spar_member_solve_static(m->m, steps));
}

void do_spar_member_solve_modes(call *c) {
    live_member *m = arg_member(c, -1);
    int64_t nodes = nodes_of(m), n = arg_count(c, 0, 8), room = length(n);
    double *frequency = OUT(c, room), *shapes = OUT_OR_NULL(c, room * nodes * 6);
    RUN(c, spar_member_solve_modes(m->m, n, frequency, shapes));
}

void do_spar_member_solve_eigenvalues(call *c) {
    live_member *m = arg_member(c, -1);
    int64_t nodes = nodes_of(m), n = arg_count(c, 0, 8), room = length(n);
    double *shift = arg_reals_or_null(c, 2, -30, 100), *eigenvalue = OUT(c, 2 * room),
           *shapes = OUT_OR_NULL(c, room * nodes * 12), *frame = OUT_OR_NULL(c, 3);
    RUN(c, spar_member_solve_eigenvalues(m->m, n, shift, eigenvalue, shapes, frame));
}

void do_spar_member_write_vtk(call *c) {
    live_member *m = arg_member(c, -1);
    const char *path = arg_path(c, chance(c, 50) ? ".vtu" : ".vtp");
    RUN(c, spar_member_write_vtk(m->m, path));
}
