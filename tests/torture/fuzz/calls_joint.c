/* The calls on joints. */
#include "fuzz.h"

#include <string.h>

static live_joint *free_joint(call *c) {
    for (int i = 0; i < JOINTS; i++) {
        if (!c->w->joint[i].j) {
            return c->w->joint + i;
        }
    }
    return NULL;
}

static void joint_made(call *c, live_joint *at, spar_joint *j, int session, int line, int free_motions) {
    if ((c->status == SPAR_OK) != (j != NULL)) {
        fuzz_finding("handle", "%s answers %d and %s a handle", c->what->name, c->status, j ? "writes" : "writes no");
    }
    if (j) {
        *at = (live_joint){j, session, line, free_motions, 0, ++c->w->clock};
    }
}

/* Two members of one session, seldom of two, or one and the ground; nodes that they have, but where that is odd. */
typedef struct ends {
    live_session *session;
    spar_member *a, *b;
    int64_t node_a, node_b;
} ends;

static int64_t arg_node(call *c, const live_member *m) {
    int64_t n = nodes_of(m);
    return odd(c) ? arg_count(c, -1, 70) : n > 0 && chance(c, 50) ? n - 1 : 0;
}

static ends arg_ends(call *c) {
    ends e = {0};
    live_member *a = arg_member(c, -1), *b = arg_member(c, -1);
    e.session = a->m && !odd(c) ? c->w->session + a->session : arg_session(c);
    c->where[0] = e.session->s, c->asked = 1; /* which has the message, whatever the members are of */
    c->session = e.session->s ? (int)(e.session - c->w->session) : -1;
    int ground = chance(c, 40) || (b->session != a->session && !odd(c));
    e.a = a->m, e.b = ground ? NULL : b->m;
    e.node_a = arg_node(c, a), e.node_b = arg_node(c, b);
    text(c, ", nodes %lld and %lld%s", (long long)e.node_a, (long long)e.node_b, ground ? " (ground)" : "");
    return e;
}

void do_spar_joint_create(call *c) {
    static const int masks[] = {0, 8, 16, 32, 56, 1, 63, 35};
    live_joint *at = free_joint(c);
    if (!at) {
        return;
    }
    ends e = arg_ends(c);
    const char *name = arg_name(c, "j");
    int mask = odd(c) ? arg_int(c, -1, 64) : masks[below(c, 8)], nowhere = odd(c);
    spar_joint *j = NULL;
    text(c, ", %d, %s", mask, nowhere ? "NULL" : "&j");
    RUN(c, spar_joint_create(e.session->s, name, e.a, e.node_a, e.b, e.node_b, mask, nowhere ? NULL : &j));
    joint_made(c, at, j, (int)(e.session - c->w->session), 0, mask);
}

void do_spar_link_create(call *c) {
    live_joint *at = free_joint(c);
    if (!at) {
        return;
    }
    ends e = arg_ends(c);
    const char *name = arg_name(c, "l");
    double *from = arg_reals(c, 3, -1, 1), *to = arg_reals(c, 3, -1, 1);
    int nowhere = odd(c);
    spar_joint *j = NULL;
    RUN(c, spar_link_create(e.session->s, name, e.a, e.node_a, from, e.b, e.node_b, to, nowhere ? NULL : &j));
    joint_made(c, at, j, (int)(e.session - c->w->session), 1, 1);
}

void do_spar_joint_set_frame(call *c) {
    live_joint *j = arg_joint(c, JOINT_PLAIN);
    double *x = arg_reals(c, 3, -1, 1), *q = arg_quaternions(c, 1, 1);
    RUN(c, spar_joint_set_frame(j->j, x, q));
}

/* Diagonal on what is free, a little of it on all else when odd. */
static double *arg_spring(call *c, const live_joint *j, double size) {
    double K[36] = {0};
    for (int k = 0; k < 6; k++) {
        K[7 * k] = j->free_motions >> k & 1 || odd(c) ? uniform(c, 0, size) : 0;
    }
    return chance(c, 30) ? NULL : arg_given(c, K, 36);
}

static double *arg_on_free(call *c, const live_joint *j) {
    double x[6] = {0};
    for (int k = 0; k < 6; k++) {
        x[k] = j->free_motions >> k & 1 || odd(c) ? uniform(c, -1, 1) : 0;
    }
    return arg_given(c, x, 6);
}

void do_spar_joint_set_spring(call *c) {
    live_joint *j = arg_joint(c, JOINT_PLAIN);
    double *K = arg_spring(c, j, 100), *D = arg_spring(c, j, 5), *preload = chance(c, 50) ? NULL : arg_on_free(c, j);
    RUN(c, spar_joint_set_spring(j->j, K, D, preload));
}

void do_spar_link_set_spring(call *c) {
    live_joint *j = arg_joint(c, JOINT_LINE);
    double k = arg_real(c, 0, 100), d = arg_real(c, 0, 5), length = arg_real(c, 0, 2);
    int slack = arg_int(c, 0, 1);
    RUN(c, spar_link_set_spring(j->j, k, d, length, slack));
}

void do_spar_spring_create(call *c) {
    static const int masks[] = {2, 16, 63, 7};
    live_joint *at = free_joint(c);
    if (!at) {
        return;
    }
    live_member *m = arg_member(c, -1);
    live_session *l = m->m && !odd(c) ? c->w->session + m->session : arg_session(c);
    c->where[0] = l->s, c->asked = 1; /* as in arg_ends */
    c->session = l->s ? (int)(l - c->w->session) : -1;
    const char *name = arg_name(c, "s");
    int64_t node = arg_node(c, m);
    int mask = odd(c) ? arg_int(c, -1, 64) : masks[below(c, 4)], nowhere = chance(c, 20);
    const live_joint as = {.free_motions = mask};
    text(c, ", %lld, %d", (long long)node, mask);
    double *K = arg_spring(c, &as, 100), *D = arg_spring(c, &as, 5);
    spar_joint *j = NULL;
    text(c, ", NULL, %s", nowhere ? "NULL" : "&j");
    RUN(c, spar_spring_create(l->s, name, m->m, node, mask, K, D, NULL, nowhere ? NULL : &j));
    if (!nowhere) {
        joint_made(c, at, j, (int)(l - c->w->session), 0, mask);
    } else if (c->status == SPAR_OK) {
        l->tied = 1;
    }
}

void do_spar_joint_set_driven(call *c) {
    live_joint *j = arg_joint(c, JOINT_ANY);
    int mask = odd(c) ? arg_int(c, -1, 64) : j->free_motions & (int)(word(c) & 63);
    text(c, ", %d", mask);
    RUN(c, spar_joint_set_driven(j->j, mask));
    j->driven = c->status == SPAR_OK ? mask : j->driven;
}

void do_spar_joint_drive(call *c) {
    live_joint *j = arg_joint(c, JOINT_DRIVEN);
    double *z = arg_reals(c, 6, -0.1, 0.1), *rate = arg_reals_or_null(c, 6, -0.1, 0.1),
           *acceleration = arg_reals_or_null(c, 6, -0.1, 0.1);
    RUN(c, spar_joint_drive(j->j, z, rate, acceleration));
}

void do_spar_joint_set_load(call *c) {
    live_joint *j = arg_joint(c, JOINT_ANY);
    double *load = arg_on_free(c, j);
    RUN(c, spar_joint_set_load(j->j, load));
}

void do_spar_joint_get_motion(call *c) {
    live_joint *j = arg_joint(c, JOINT_ANY);
    double *z = OUT_OR_NULL(c, 6), *rate = OUT_OR_NULL(c, 6), *acceleration = OUT_OR_NULL(c, 6);
    RUN(c, spar_joint_get_motion(j->j, z, rate, acceleration));
}

void do_spar_joint_get_load(call *c) {
    live_joint *j = arg_joint(c, JOINT_ANY);
    double *load = OUT(c, 6);
    RUN(c, spar_joint_get_load(j->j, load));
}

void do_spar_joint_get_energy(call *c) {
    live_joint *j = arg_joint(c, JOINT_ANY);
    int64_t n = arg_count(c, 0, SPAR_JOINT_ENERGY_COUNT + 2);
    double *energy = OUT_OR_NULL(c, length(n));
    RUN(c, spar_joint_get_energy(j->j, n, energy));
}
