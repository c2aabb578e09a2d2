/* The work that loads and the root have done on a member. */
#include "work.h"
#include "../base/environment.h"

#include "../math/rotation.h"
#include "../member/applied_loads.h"
#include "../member/check_arguments.h"
#include "reaction.h"

#include <stdlib.h>
#include <string.h>

struct spari_work {
    double sum[SPAR_WORK_COUNT];
    double reaction[6]; /* at t^n, of a driven root */
    int reaction_lacks; /* 1: it was found before the fluids' loads at t = 0 were known */
    double *fluid;      /* [nodes][6] fluid loads at t^n */
    double *load;       /* [nodes][6] scratch */
    double *workspace;  /* for the reaction */
};

void spari_work_free(spari_work *work) {
    if (work) {
        SPARI_FREE(work->fluid, work->load, work->workspace, work);
    }
}

/* Displacement and rotation vector of node i over the step; linearly: the change of its rotation vector. */
static void increment(const spar_member *m, int64_t i, int linearly, double d[6]) {
    const double *from = m->now.q + 7 * i, *to = m->after.q + 7 * i;
    double rotation[4];
    for (int c = 0; c < 3; c++) {
        d[c] = to[c] - from[c];
    }
    if (linearly) {
        double before[3];
        spari_quat_log(from + 3, before);
        spari_quat_log(to + 3, rotation);
        for (int c = 0; c < 3; c++) {
            d[3 + c] = rotation[c] - before[c];
        }
        return;
    }
    spari_quat_between(from + 3, to + 3, rotation);
    spari_quat_log(rotation, d + 3);
}

static double dot6(const double *a, const double *b) {
    return spari_dot(a, b) + spari_dot(a + 3, b + 3);
}

/* Adds the applied loads without the foundation, whose energy is stored (SPAR_ENERGY_FOUNDATION). */
static void add_applied(const spar_member *m, const double *q, double *load) {
    spari_applied_nodal(m, q, load);
    if (m->load.foundation) {
        spari_foundation_nodal(m, q, -1, load);
    }
}

void spari_work_step(spar_member *m) {
    spari_work *w = m->work;
    int64_t n = m->nodes;
    double d[6], reaction[6] = {0};
    const double *dead = spari_dead_before(m);
    memset(w->load, 0, (size_t)(6 * n) * sizeof *w->load);
    if (m->load.applied) {
        spari_applied_at(m, 1);
        add_applied(m, m->now.q, w->load);
        spari_applied_at(m, 0);
        add_applied(m, m->after.q, w->load);
    }
    for (int64_t i = 0; i < n; i++) {
        double fluid[6], kept[6],
            joint_load[6] = {0}; /* of an external member the loads it is solved with have the joints' */
        if (m->external) {
            spari_joints_on(m, i, joint_load);
        }
        for (int c = 0; c < 6; c++) {
            double now = m->load.solved[1][6 * i + c] - m->load.dead[6 * i + c] - joint_load[c];
            fluid[c] = 0.5 * (w->fluid[6 * i + c] + now);
            kept[c] = 0.5 * (dead[6 * i + c] + m->load.dead[6 * i + c] + w->load[6 * i + c]);
            w->fluid[6 * i + c] = now;
        }
        increment(m, i, spari_member_is_linear_at_rest(m), d);
        w->sum[SPAR_WORK_LOADS] += dot6(kept, d);
        w->sum[SPAR_WORK_FLUID] += dot6(fluid, d);
    }
    if (m->root == SPAR_ROOT_DRIVEN) {
        spari_member_reaction_in(m, w->workspace, reaction);
        if (w->reaction_lacks) { /* that of the first step's end stands for it: of second order in dt, once */
            memcpy(w->reaction, reaction, sizeof reaction);
            w->reaction_lacks = 0;
        }
        increment(m, 0, spari_member_is_linear_at_rest(m), d);
        w->sum[SPAR_WORK_ROOT] += 0.5 * (dot6(w->reaction, d) + dot6(reaction, d));
        memcpy(w->reaction, reaction, sizeof reaction);
    }
}

/* ---- joints ---- */

static int keeps_account(const spar_joint *j) {
    return j->member[0]->work || (j->member[1] && j->member[1]->work);
}

/* The coordinates of a joint and its forces on its two nodes, f[12], at t^n or (at the end) at t^{n+1}. */
static void joint_at(const spar_joint *j, int end, double z[6], double f[12]) {
    const spari_relative *at = end ? &j->after : &j->now;
    spari_node_pose pose[2];
    double B[6][12];
    for (int side = 0; side < 2; side++) {
        const spar_member *m = j->member[side];
        pose[side] = (spari_node_pose){.q = {1, 0, 0, 0}};
        if (m) {
            const double *q = (end ? m->after.q : m->now.q) + 7 * j->seat[side];
            for (int k = 0; k < 3; k++) {
                pose[side].x[k] = m->xr[3 * j->seat[side] + k] + q[k];
            }
            memcpy(pose[side].q, q + 3, sizeof pose[side].q);
        }
    }
    spari_kinematics_motion(&j->kinematics, &pose[0], &pose[1], z, B);
    spari_joint_count_turns(j, at->z, z);
    spari_kinematics_forces(B, at->load, f);
}

/* The part of a line's pull that its spring does not account for. */
static double damper_of_line(const spar_joint *j, const spari_relative *at) {
    double stretch = at->z[0] - j->length;
    return spari_joint_pull(j, at->z, at->rate, INFINITY) - j->stiffness[0] * (j->slack ? fmax(stretch, 0) : stretch);
}

/* The work over the step that dampers absorb, and that drives and the host's load supply, by the trapezoidal rule in
   the joint's coordinates. */
static void add_to_account(spar_joint *j, const double from[6], const double z[6]) {
    const spari_relative *now = &j->now, *to = &j->after;
    int given = spari_joint_constrained(j), most = j->kinematics.line ? 1 : 6;
    for (int k = 0; k < most; k++) {
        double way = z[k] - from[k], damper = 0;
        if (j->driven >> k & 1) {
            j->account[1] += 0.5 * (now->load[k] + to->load[k]) * way;
        }
        if (given >> k & 1) {
            continue;
        }
        for (int i = 0; i < most && j->sprung && !j->kinematics.line; i++) {
            damper += 0.5 * j->damping[6 * k + i] * (now->rate[i] + to->rate[i]);
        }
        if (j->kinematics.line && j->sprung) {
            damper = 0.5 * (damper_of_line(j, now) + damper_of_line(j, to));
        }
        j->account[0] += damper * way;
        j->account[2] += 0.5 * (spari_joint_load_at(j, k, 1) + j->given[k]) * way;
    }
}

void spari_work_of_joint(spar_joint *j) {
    double f[2][12], z[2][6], d[6];
    if (!keeps_account(j)) {
        return;
    }
    joint_at(j, 0, z[0], f[0]);
    joint_at(j, 1, z[1], f[1]);
    for (int side = 0; side < 2; side++) {
        const spar_member *m = j->member[side];
        if (m && m->work) {
            increment(m, j->seat[side], 0, d);
            m->work->sum[SPAR_WORK_JOINTS] += 0.5 * (dot6(f[0] + 6 * side, d) + dot6(f[1] + 6 * side, d));
        }
    }
    add_to_account(j, z[0], z[1]);
}

/* Stored in its springs, preload included. */
static double spring_energy(const spar_joint *j) {
    const double *z = j->after.z;
    double sum = 0;
    if (j->kinematics.line) {
        double stretch = z[0] - j->length;
        return spari_joint_constrained(j) || (j->slack && stretch < 0) ? 0 : 0.5 * j->stiffness[0] * stretch * stretch;
    }
    int given = spari_joint_constrained(j);
    for (int i = 0; i < 6; i++) {
        for (int k = 0; k < 6 && !(given >> i & 1); k++) {
            sum += given >> k & 1 ? 0 : 0.5 * j->stiffness[6 * i + k] * z[i] * z[k];
        }
        sum -= given >> i & 1 ? 0 : j->preload[i] * z[i];
    }
    return sum;
}

int spar_joint_get_energy(const spar_joint *joint, int64_t capacity, double *energy) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_REQUIRE(NULL, joint, SPAR_ERR_ARGUMENT, "%s: the joint is NULL; create it first", __func__);
    SPARI_TRY(spari_need_capacity(joint->session, __func__, capacity));
    SPARI_REQUIRE(joint->session, keeps_account(joint), SPAR_ERR_STATE,
                  "%s: work of '%s' is not recorded; request SPAR_EFFECT_WORK of a member that it connects, with "
                  "spar_member_set_effects before the commit",
                  __func__, joint->name);
    const double *a = joint->account,
                 all[SPAR_JOINT_ENERGY_COUNT] = {joint->after.found != 0 ? spring_energy(joint) : 0, a[0], a[1], a[2]};
    spari_fill(capacity, energy, SPAR_JOINT_ENERGY_COUNT, all);
    return SPAR_OK;
}

/* ---- life ---- */

void spari_work_restart(spar_member *m) {
    spari_work *w = m->work;
    for (int k = 0; k < m->joint_count; k++) {
        memset(m->joints[k]->account, 0, sizeof m->joints[k]->account);
    }
    memset(w->sum, 0, sizeof w->sum);
    w->reaction_lacks = 0;
    memcpy(w->fluid, m->load.history[0], (size_t)(6 * m->nodes) * sizeof *w->fluid);
    spari_member_reaction_in(m, w->workspace, w->reaction);
}

void spari_work_begin(spar_member *m) {
    spari_work *w = m->work;
    for (int64_t i = 0; i < 6 * m->nodes; i++) {
        w->reaction_lacks = w->reaction_lacks || w->fluid[i] != m->load.history[0][i];
        w->fluid[i] = m->load.history[0][i];
    }
}

int spari_work_create(spar_member *m) {
    spari_work *w = m->work = spari_zalloc(1, sizeof *w); /* loads along the line may come later: room for them too */
    int ok = w && (w->fluid = spari_zalloc(6 * m->nodes, sizeof *w->fluid)) &&
             (w->load = spari_zalloc(6 * m->nodes, sizeof *w->load)) &&
             (w->workspace = spari_zalloc(spari_member_reaction_size(m) + 6 * m->nodes, sizeof *w->workspace));
    SPARI_REQUIRE(m->session, ok, SPAR_ERR_MEMORY, "no memory for the work of '%s'", m->name);
    return SPAR_OK;
}

void spari_work_carry(const spar_member *from, spar_member *m) {
    if (from->work && m->work) {
        memcpy(m->work->sum, from->work->sum, sizeof m->work->sum);
    }
}

int spar_member_get_work(const spar_member *member, int64_t capacity, double *work) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_TRY(spari_need_committed(member, __func__));
    SPARI_TRY(spari_need_capacity(member->session, __func__, capacity));
    SPARI_REQUIRE(member->session, member->work, SPAR_ERR_STATE,
                  "%s: work of '%s' is not recorded; request SPAR_EFFECT_WORK with spar_member_set_effects before the "
                  "member is committed",
                  __func__, member->name);
    spari_fill(capacity, work, SPAR_WORK_COUNT, member->work->sum);
    return SPAR_OK;
}
