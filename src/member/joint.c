/* Joints: description by the host, placement at commit, springs, dampers and drives. */
#include "joint.h"

#include "../base/environment.h"
#include "../math/rotation.h"
#include "beam.h"
#include "check_arguments.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char *const motion_name[6] = {
    "x", "y", "z", "the rotation about x", "the rotation about y", "the rotation about z"};
enum { ALL_FREE = 63 };

/* ---- create ---- */

static int check_node(const spar_session *s, const char *call, const char *name, const char *which,
                      const spar_member *m, int64_t node) {
    SPARI_REQUIRE(s, m->session == s, SPAR_ERR_ARGUMENT,
                  "%s: '%s': member %s, '%s', belongs to another session; connect members of the same session", call,
                  name, which, m->name);
    SPARI_REQUIRE(s, node >= 0 && node < m->nodes, SPAR_ERR_ARGUMENT,
                  "%s: '%s': '%s' has nodes 0 to %lld; there is no node %lld", call, name, m->name,
                  (long long)m->nodes - 1, (long long)node);
    return SPAR_OK;
}

/* A member that is not committed yet can still become exact; its commit checks it. */
static int check_fidelity(const spar_session *s, const char *call, const char *name, const spar_member *m) {
    SPARI_REQUIRE(s, !m->committed || m->frame != SPARI_FRAME_LINEAR, SPAR_ERR_UNSUPPORTED,
                  "%s: '%s': '%s' is a linear or modal beam, which no joint can connect; commit it with "
                  "SPAR_FIDELITY_EXACT (spar_member_set_fidelity), which costs about as much with joints",
                  call, name, m->name);
    return SPAR_OK;
}

/* Makes room for another joint of a member; NULL: the ground. 0, or 1: no memory. */
static int reserve_joint(spar_member *m) {
    if (!m || m->joint_count < m->joint_capacity) {
        return 0;
    }
    int capacity = 2 * m->joint_capacity + 2;
    /* NOLINTNEXTLINE(bugprone-sizeof-expression): an array of pointers */
    spar_joint **more = realloc(m->joints, (size_t)capacity * sizeof *more);
    if (!more) {
        return 1;
    }
    m->joints = more, m->joint_capacity = capacity;
    return 0;
}

/* Damping by ratios looks at the assembly as it is then; what comes later is told here, once. */
static void tell_damping(spar_member *m, const char *name) {
    if (m && m->beam && m->beam->damped_by_ratios) {
        m->beam->damped_by_ratios = 0;
        spari_warn(m->session,
                   "member '%s': its damping was chosen by the ratios of its modes before joint '%s' was created, and "
                   "connected members change the modes; choose the damping after the joints, or look at "
                   "spar_member_solve_eigenvalues",
                   m->name, name);
    }
}

static int joint_create(spar_session *s, const char *call, const char *name, spar_member *a, int64_t node_a,
                        spar_member *b, int64_t node_b, spar_joint **out) {
    SPARI_REQUIRE(NULL, s, SPAR_ERR_ARGUMENT, "%s: the session is NULL; create it first", call);
    SPARI_REQUIRE(s, out, SPAR_ERR_ARGUMENT, "%s: the pointer to the new joint is NULL", call);
    SPARI_REQUIRE(s, name && name[0], SPAR_ERR_ARGUMENT,
                  "%s: a joint needs a name; give one that is unique in the session", call);
    SPARI_REQUIRE(s, !s->clock.started && !s->state.trial, SPAR_ERR_STATE,
                  "%s: '%s': the clock has started; create joints before the first step", call, name);
    SPARI_REQUIRE(s, a, SPAR_ERR_ARGUMENT, "%s: '%s': member a is NULL; only b can be the ground", call, name);
    SPARI_TRY(check_node(s, call, name, "a", a, node_a));
    SPARI_TRY(check_fidelity(s, call, name, a));
    if (b) {
        SPARI_TRY(check_node(s, call, name, "b", b, node_b));
        SPARI_TRY(check_fidelity(s, call, name, b));
        SPARI_REQUIRE(
            s, a != b || spari_member_unique(a, node_a) != spari_member_unique(b, node_b), SPAR_ERR_ARGUMENT,
            "%s: '%s' connects node %lld of '%s' to itself; give two different nodes, or b = NULL for the ground", call,
            name, (long long)node_a, a->name);
    }
    spar_joint *j = spari_zalloc(1, sizeof *j);
    char *own = strdup(name);
    int failed = j && own && !reserve_joint(a) && !reserve_joint(b) ? spari_names_add(&s->joint_names, own) : -1;
    if (failed) {
        free(j);
        free(own);
        SPARI_REQUIRE(s, failed < 0, SPAR_ERR_ARGUMENT,
                      "%s: joint '%s' already exists; use a unique name in the session", call, name);
        return spari_fail(s, SPAR_ERR_MEMORY, "%s: '%s': no memory for the joint", call, name);
    }
    j->name = own;
    j->session = s;
    j->member[0] = a, j->member[1] = b;
    j->node[0] = node_a, j->node[1] = b ? node_b : 0;
    j->axes[0] = 1;
    s->joint_count++;
    *(s->last_joint ? &s->last_joint->next : &s->joints) = j;
    s->last_joint = j;
    a->joints[a->joint_count++] = j;
    if (b && b != a) {
        b->joints[b->joint_count++] = j;
    }
    *out = j;
    s->joints_stale = 1;
    tell_damping(a, name);
    tell_damping(b, name);
    return SPAR_OK;
}

int spar_joint_create(spar_session *session, const char *name, spar_member *a, int64_t node_a, spar_member *b,
                      int64_t node_b, int free_motions, spar_joint **joint) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_REQUIRE(session, free_motions >= 0 && free_motions <= ALL_FREE, SPAR_ERR_ARGUMENT,
                  "%s: '%s': free is %d; give a combination of SPAR_FREE_* bits", __func__, name ? name : "",
                  free_motions);
    SPARI_TRY(joint_create(session, __func__, name, a, node_a, b, node_b, joint));
    spar_joint *j = *joint;
    j->kinematics.free = free_motions;
    return SPAR_OK;
}

int spar_link_create(spar_session *session, const char *name, spar_member *a, int64_t node_a, const double point_a[3],
                     spar_member *b, int64_t node_b, const double point_b[3], spar_joint **joint) {
    SPARI_GUARD_ENVIRONMENT;
    const char *label = name ? name : "";
    SPARI_REQUIRE(NULL, session, SPAR_ERR_ARGUMENT, "%s: the session is NULL; create it first", __func__);
    SPARI_TRY(spari_need_finite(session, __func__, label, "point_a", 3, point_a));
    SPARI_TRY(spari_need_finite(session, __func__, label, "point_b", 3, point_b));
    double way[3];
    for (int k = 0; k < 3; k++) {
        way[k] = point_a[k] - point_b[k];
    }
    SPARI_REQUIRE(
        session, spari_norm(way) > 0, SPAR_ERR_ARGUMENT,
        "%s: '%s': its two points coincide at (%g, %g, %g); give two distinct points in the reference position",
        __func__, label, point_a[0], point_a[1], point_a[2]);
    SPARI_TRY(joint_create(session, __func__, name, a, node_a, b, node_b, joint));
    spar_joint *j = *joint;
    memcpy(j->point[0], point_a, sizeof j->point[0]);
    memcpy(j->point[1], point_b, sizeof j->point[1]);
    j->kinematics.line = 1;
    j->kinematics.free = SPAR_FREE_X;
    j->length = spari_norm(way);
    j->drive[0].z[0] = j->drive[1].z[0] = j->now.z[0] = j->after.z[0] = j->length;
    return SPAR_OK;
}

void spari_joint_free(spar_joint *j) {
    if (j) {
        SPARI_FREE(j->name, j);
    }
}

/* ---- description ---- */

/* The joint must not be in use yet. */
static int need_joint(const spar_joint *j, const char *call) {
    SPARI_REQUIRE(NULL, j, SPAR_ERR_ARGUMENT, "%s: the joint is NULL; create it first", call);
    return SPAR_OK;
}

static int need_before_start(const spar_joint *j, const char *call) {
    SPARI_TRY(need_joint(j, call));
    SPARI_REQUIRE(j->session, !j->session->clock.started && !j->session->state.trial, SPAR_ERR_STATE,
                  "%s: '%s': the clock has started; describe joints before the first step", call, j->name);
    return SPAR_OK;
}

int spar_joint_set_frame(spar_joint *joint, const double x[3], const double q[4]) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_TRY(need_before_start(joint, __func__));
    spar_session *s = joint->session;
    SPARI_REQUIRE(s, !joint->kinematics.line, SPAR_ERR_STATE,
                  "%s: '%s' is a line, which has no frame; set its points when it is created", __func__, joint->name);
    SPARI_TRY(spari_need_finite(s, __func__, joint->name, "x", 3, x));
    if (q) {
        SPARI_TRY(spari_need_finite(s, __func__, joint->name, "q", 4, q));
        SPARI_TRY(spari_need_unit(s, __func__, joint->name, "q", 1, q, 4));
    }
    s->joints_stale = 1;
    memcpy(joint->position, x, sizeof joint->position);
    joint->frame_given = q ? 2 : 1;
    if (q) {
        memcpy(joint->axes, q, sizeof joint->axes);
        spari_quat_normalise(joint->axes);
    }
    return SPAR_OK;
}

/* Checks that a spring matrix is symmetric, without entries on constrained motions. */
static int check_spring(spar_session *s, const char *name, int free_motions, const char *call, const char *what,
                        const double *K) {
    double size = 0;
    if (!K) {
        return SPAR_OK;
    }
    SPARI_TRY(spari_need_finite(s, call, name, what, 36, K));
    for (int i = 0; i < 36; i++) {
        size = fmax(size, fabs(K[i]));
    }
    for (int i = 0; i < 6; i++) {
        for (int k = 0; k < 6; k++) {
            SPARI_REQUIRE(s, fabs(K[6 * i + k] - K[6 * k + i]) <= 1e-9 * size, SPAR_ERR_ARGUMENT,
                          "%s: '%s': %s is not symmetric: entries (%d,%d) and (%d,%d) are %g and %g", call, name, what,
                          i, k, k, i, K[6 * i + k], K[6 * k + i]);
            SPARI_REQUIRE(s, K[6 * i + k] == 0 || (free_motions >> i & 1), SPAR_ERR_ARGUMENT,
                          "%s: '%s': %s has %g on %s, which the joint constrains; springs act on free motions only",
                          call, name, what, K[6 * i + k], motion_name[i]);
        }
    }
    return SPAR_OK;
}

/* Checks all spring data of a joint. */
static int check_springs(spar_session *s, const char *name, int free_motions, const char *call, const double *stiffness,
                         const double *damping, const double *preload) {
    SPARI_TRY(check_spring(s, name, free_motions, call, "stiffness", stiffness));
    SPARI_TRY(check_spring(s, name, free_motions, call, "damping", damping));
    if (preload) {
        SPARI_TRY(spari_need_finite(s, call, name, "preload", 6, preload));
    }
    for (int i = 0; i < 6 && preload; i++) {
        SPARI_REQUIRE(s, preload[i] == 0 || (free_motions >> i & 1), SPAR_ERR_ARGUMENT,
                      "%s: '%s': preload has %g on %s, which the joint constrains", call, name, preload[i],
                      motion_name[i]);
    }
    return SPAR_OK;
}

static void take_springs(spar_joint *j, const double *stiffness, const double *damping, const double *preload) {
    static const double none[36] = {0};
    memcpy(j->stiffness, stiffness ? stiffness : none, sizeof j->stiffness);
    memcpy(j->damping, damping ? damping : none, sizeof j->damping);
    memcpy(j->preload, preload ? preload : none, sizeof j->preload);
    j->sprung = stiffness || damping || preload;
}

int spar_joint_set_spring(spar_joint *joint, const double stiffness[36], const double damping[36],
                          const double preload[6]) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_TRY(need_joint(joint, __func__));
    SPARI_REQUIRE(joint->session, !joint->kinematics.line, SPAR_ERR_STATE,
                  "%s: '%s' is a line; call spar_link_set_spring", __func__, joint->name);
    SPARI_TRY(
        check_springs(joint->session, joint->name, joint->kinematics.free, __func__, stiffness, damping, preload));
    take_springs(joint, stiffness, damping, preload);
    return SPAR_OK;
}

int spar_spring_create(spar_session *session, const char *name, spar_member *member, int64_t node, int free_motions,
                       const double stiffness[36], const double damping[36], const double preload[6],
                       spar_joint **joint) {
    SPARI_GUARD_ENVIRONMENT;
    const char *label = name ? name : "";
    spar_joint *j = NULL;
    SPARI_REQUIRE(NULL, session, SPAR_ERR_ARGUMENT, "%s: the session is NULL; create it first", __func__);
    SPARI_REQUIRE(session, member, SPAR_ERR_ARGUMENT, "%s: '%s': the member is NULL; create it first", __func__, label);
    SPARI_REQUIRE(session, free_motions >= 0 && free_motions <= ALL_FREE, SPAR_ERR_ARGUMENT,
                  "%s: '%s': free is %d; give a combination of SPAR_FREE_* bits", __func__, label, free_motions);
    SPARI_TRY(check_springs(session, label, free_motions, __func__, stiffness, damping, preload));
    SPARI_TRY(joint_create(session, __func__, name, member, node, NULL, 0, &j));
    j->kinematics.free = free_motions;
    take_springs(j, stiffness, damping, preload);
    SPARI_GIVE(joint, j);
    return SPAR_OK;
}

int spar_link_set_spring(spar_joint *joint, double stiffness, double damping, double length, int tension_only) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_TRY(need_before_start(joint, __func__));
    spar_session *s = joint->session;
    SPARI_REQUIRE(s, joint->kinematics.line, SPAR_ERR_STATE, "%s: '%s' is not a line; call spar_joint_set_spring",
                  __func__, joint->name);
    const double in[3] = {stiffness, damping, length};
    static const char *const name[3] = {"stiffness", "damping", "length"};
    for (int k = 0; k < 3; k++) {
        SPARI_REQUIRE(s, isfinite(in[k]) && in[k] >= 0, SPAR_ERR_ARGUMENT, "%s: '%s': %s is %g; give 0 or more",
                      __func__, joint->name, name[k], in[k]);
    }
    s->joints_stale = 1;
    joint->stiffness[0] = stiffness;
    joint->damping[0] = damping;
    joint->length = length;
    joint->sprung = 1;
    joint->slack = tension_only != 0;
    return SPAR_OK;
}

int spar_joint_set_driven(spar_joint *joint, int mask) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_TRY(need_before_start(joint, __func__));
    SPARI_REQUIRE(joint->session, mask >= 0 && mask <= ALL_FREE && (mask & ~joint->kinematics.free) == 0,
                  SPAR_ERR_ARGUMENT,
                  "%s: '%s': mask is %d, free is %d: only free motions can be driven; add the driven bits to free",
                  __func__, joint->name, mask, joint->kinematics.free);
    joint->session->joints_stale = 1;
    joint->driven = mask;
    return SPAR_OK;
}

/* Three free rotations form a rotation vector, which is not unique from half a revolution on. */
static int need_below_half_a_turn(const spar_joint *j, const double motion[6], const char *call) {
    double turn[3];
    for (int k = 0; k < 3; k++) {
        turn[k] = j->driven >> (3 + k) & 1 ? motion[3 + k] : 0;
    }
    SPARI_REQUIRE(j->session,
                  j->kinematics.line || spari_kinematics_angles(j->kinematics.free) || spari_norm(turn) < M_PI,
                  SPAR_ERR_ARGUMENT,
                  "%s: '%s': a rotation of %.4g rad; with three free rotations the rotation vector must stay below pi. "
                  "Drive a hinge or a universal joint, whose angles are unlimited, or the root of the member",
                  call, j->name, spari_norm(turn));
    return SPAR_OK;
}

int spar_joint_drive(spar_joint *joint, const double motion[6], const double rate[6], const double acceleration[6]) {
    SPARI_GUARD_ENVIRONMENT;
    static const double rest[6] = {0};
    SPARI_TRY(need_joint(joint, __func__));
    spar_session *s = joint->session;
    SPARI_REQUIRE(s, joint->driven, SPAR_ERR_STATE,
                  "%s: '%s' is not driven; call spar_joint_set_driven before the first step", __func__, joint->name);
    SPARI_REQUIRE(s, s->state.phase == SPARI_IDLE, SPAR_ERR_STATE,
                  "%s: '%s': a step is in progress; give the motion at its end before spar_step_begin", __func__,
                  joint->name);
    const double *in[3] = {motion, rate ? rate : rest, acceleration ? acceleration : rest};
    static const char *const name[3] = {"motion", "rate", "acceleration"};
    for (int k = 0; k < 3; k++) {
        SPARI_TRY(spari_need_finite(s, __func__, joint->name, name[k], 6, in[k]));
    }
    SPARI_TRY(need_below_half_a_turn(joint, motion, __func__));
    memcpy(joint->drive[1].z, in[0], 6 * sizeof **in);
    memcpy(joint->drive[1].rate, in[1], 6 * sizeof **in);
    memcpy(joint->drive[1].acceleration, in[2], 6 * sizeof **in);
    joint->drive_given = 1;
    return SPAR_OK;
}

int spar_joint_set_load(spar_joint *joint, const double load[6]) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_TRY(need_joint(joint, __func__));
    SPARI_TRY(spari_need_finite(joint->session, __func__, joint->name, "load", 6, load));
    for (int i = 0; i < 6; i++) {
        SPARI_REQUIRE(joint->session, load[i] == 0 || (joint->kinematics.free >> i & 1), SPAR_ERR_ARGUMENT,
                      "%s: '%s': load has %g on %s, which the joint constrains", __func__, joint->name, load[i],
                      motion_name[i]);
    }
    memcpy(joint->given, load, sizeof joint->given);
    return SPAR_OK;
}

/* ---- getters ---- */

int spar_joint_get_motion(const spar_joint *joint, double motion[6], double rate[6], double acceleration[6]) {
    SPARI_TRY(need_joint(joint, __func__));
    spari_give(motion, joint->after.z, 6);
    spari_give(rate, joint->after.rate, 6);
    if (acceleration) {
        spari_joint_acceleration(joint, acceleration);
    }
    return SPAR_OK;
}

int spar_joint_get_load(const spar_joint *joint, double load[6]) {
    SPARI_TRY(need_joint(joint, __func__));
    spari_give(load, joint->after.load, 6);
    return SPAR_OK;
}

/* ---- for the solution ---- */

double spari_joint_pull(const spar_joint *j, const double z[6], const double rate[6], double speed) {
    double stretch = z[0] - j->length, fastest = rate[0];
    if (j->slack && !(stretch > 0)) {
        return 0;
    }
    if (j->slack) {
        fastest = fmin(fastest, speed * stretch);
    }
    double pull = j->stiffness[0] * stretch + j->damping[0] * fastest;
    return j->slack ? fmax(pull, 0) : pull;
}

int spari_member_unique(const spar_member *m, int64_t node) {
    return (int)(m->mesh.elements == 1 ? node : node - node / m->mesh.per_element);
}

static spari_described description_of(const spar_joint *j) {
    static const double unit[4] = {1};
    const int spring = j->kinematics.line ? 1 : 0; /* springs of a joint may be replaced at any time */
    const int64_t exact[] = {j->member[0]->number,
                             j->member[1] ? j->member[1]->number : -1,
                             j->node[0],
                             j->node[1],
                             j->kinematics.free,
                             j->kinematics.line,
                             j->driven,
                             j->frame_given,
                             j->kinematics.line && j->sprung,
                             j->slack};
    spari_described p = {.length = spari_member_length(j->member[0])};
    for (size_t i = 0; i < sizeof exact / sizeof *exact; i++) {
        spari_described_exact(&p, exact[i]);
    }
    spari_described_add(&p, SPARI_NUMBERS_POSITION, 1, 3, j->position);
    spari_described_add(&p, SPARI_NUMBERS_PLAIN, 1, 4, j->frame_given < 2 ? unit : j->axes);
    spari_described_add(&p, SPARI_NUMBERS_POSITION, 2, 3, j->point[0]);
    spari_described_add(&p, SPARI_NUMBERS_ROW, spring, 1, j->stiffness);
    spari_described_add(&p, SPARI_NUMBERS_ROW, spring, 1, j->damping);
    spari_described_add(&p, SPARI_NUMBERS_ROW, spring, 1, &j->length);
    return p;
}

uint64_t spari_joint_hash(const spar_joint *j) {
    const spari_described p = description_of(j);
    return spari_described_hash(spari_hash_bytes(SPARI_HASH_BEGIN, j->name, strlen(j->name)), &p);
}

void spari_joint_digest(const spar_joint *j, spari_digest *digest) {
    const spari_described p = description_of(j);
    spari_described_digest(&p, digest);
}

uint64_t spari_joint_setting(const spar_joint *j) {
    uint64_t h = spari_hash_bytes(SPARI_HASH_BEGIN, j->given, sizeof j->given);
    if (!j->kinematics.line) {
        h = spari_hash_bytes(h, j->stiffness, sizeof j->stiffness);
        h = spari_hash_bytes(h, j->damping, sizeof j->damping);
        h = spari_hash_bytes(h, j->preload, sizeof j->preload);
    }
    h = spari_hash_bytes(h, &j->drive_given, sizeof j->drive_given);
    return j->drive_given ? spari_hash_bytes(h, &j->drive[1], sizeof j->drive[1]) : h;
}

uint64_t spari_joints_setting(const spar_session *s) {
    int many = spari_comm_size(s->ranks.comm) > 1 && !s->joints_stale;
    uint64_t h = 0;
    for (const spar_joint *j = many ? s->joints : NULL; j; j = j->next) {
        uint64_t of = spari_joint_setting(j);
        h = spari_hash_bytes(h, &of, sizeof of);
    }
    return h;
}

int spari_joint_constrained(const spar_joint *j) {
    return j->kinematics.line ? !j->sprung || j->driven : (~j->kinematics.free & ALL_FREE) | j->driven;
}

double spari_joint_load_at(const spar_joint *j, int k, double left) {
    return j->session->clock.step > 0 && left > 0 ? j->given[k] + left * (j->before[k] - j->given[k]) : j->given[k];
}

int spari_joint_spring(const spar_joint *j, const double z[6], const double rate[6], double speed, double factor,
                       double load[6]) {
    int given = spari_joint_constrained(j);
    if (j->kinematics.line && !given) {
        double pull = spari_joint_pull(j, z, rate, speed);
        load[0] = factor * spari_joint_load_at(j, 0, j->left) - pull;
        return j->sprung && !(j->slack && pull == 0);
    }
    if (j->kinematics.line) {
        return 0;
    }
    for (int i = 0; i < 6; i++) {
        if (given >> i & 1) {
            continue;
        }
        load[i] = factor * (spari_joint_load_at(j, i, j->left) + j->preload[i]);
        for (int k = 0; k < 6 && j->sprung; k++) {
            load[i] -= j->stiffness[6 * i + k] * z[k] + j->damping[6 * i + k] * rate[k];
        }
    }
    return j->sprung;
}

int spari_joint_check_place(const spar_joint *j) {
    const spar_member *a = j->member[0], *b = j->member[1];
    double apart = 0, size = 0;
    for (int k = 0; k < 3 && b && !j->kinematics.line && !j->frame_given; k++) {
        double x = a->xr[3 * j->node[0] + k];
        apart = hypot(apart, b->xr[3 * j->node[1] + k] - x);
        size = fmax(size, fabs(x));
    }
    SPARI_REQUIRE(
        j->session, apart <= 1e-6 * fmax(spari_member_length(a), size), SPAR_ERR_ARGUMENT,
        "joint '%s': node %lld of '%s' and node %lld of '%s' are %g m apart in the reference; move them together, or "
        "set the joint's position with spar_joint_set_frame; rigid offsets then connect the nodes to it",
        j->name, (long long)j->node[0], a->name, (long long)j->node[1], b ? b->name : "", apart);
    return SPAR_OK;
}

void spari_joint_place(spar_joint *j) {
    const spar_member *a = j->member[0], *b = j->member[1];
    static const double origin[3] = {0};
    const double *x[2] = {a->xr + 3 * j->node[0], b ? b->xr + 3 * j->node[1] : origin};
    for (int side = 0; side < 2; side++) {
        j->seat[side] = j->node[side];
        j->unique[side] = j->member[side] ? spari_member_unique(j->member[side], j->node[side]) : 0;
    }
    if (!j->kinematics.line && j->frame_given < 2) {
        memcpy(j->axes, a->qr + 4 * j->node[0], sizeof j->axes);
    }
    if (!j->kinematics.line && !j->frame_given) {
        memcpy(j->position, x[0], sizeof j->position);
    }
    for (int side = 0; side < 2; side++) {
        const double *to = j->kinematics.line ? j->point[side] : j->position;
        for (int k = 0; k < 3; k++) {
            j->kinematics.arm[side][k] = to[k] - x[side][k];
        }
        memcpy(j->kinematics.axes[side], j->axes, sizeof j->axes);
    }
    j->placed = 1;
}

void spari_joint_count_turns(const spar_joint *j, const double near[6], double z[6]) {
    int angles = j->kinematics.line ? 0 : spari_kinematics_angles(j->kinematics.free);
    const double turn = 6.283185307179586476925;
    for (int k = 0; k < 3; k++) {
        z[3 + k] += angles >> k & 1 ? turn * round((near[3 + k] - z[3 + k]) / turn) : 0;
    }
}

void spari_joint_drive_at(const spar_joint *j, double s, double dt, spari_driven *at) {
    const spari_driven *a = &j->drive[0], *b = &j->drive[1];
    if (s >= 1) {
        *at = *b;
        return;
    }
    double h01 = s * s * (3 - 2 * s), h00 = 1 - h01, h10 = s * (1 - s) * (1 - s), h11 = -s * s * (1 - s);
    for (int k = 0; k < 6; k++) {
        double way = b->z[k] - a->z[k] - 0.5 * dt * (a->rate[k] + b->rate[k]),
               most = fmax(fabs(a->z[k]), fabs(b->z[k]));
        way = fabs(way) <= 8 * DBL_EPSILON * most ? 0 : way; /* divided by a short dt, rounding would become a rate */
        at->z[k] = h00 * a->z[k] + h01 * b->z[k] + dt * (h10 * a->rate[k] + h11 * b->rate[k]);
        at->rate[k] = (1 - s) * a->rate[k] + s * b->rate[k] + 6 * s * (1 - s) * way / dt;
        at->acceleration[k] = (1 - s) * a->acceleration[k] + s * b->acceleration[k];
    }
}

void spari_joint_hold(spar_joint *j) {
    if (j->driven && !j->drive_given) {
        memcpy(j->drive[1].z, j->drive[0].z, sizeof j->drive[1].z);
        memset(j->drive[1].rate, 0, sizeof j->drive[1].rate);
        memset(j->drive[1].acceleration, 0, sizeof j->drive[1].acceleration);
    }
}

void spari_joint_accept(spar_joint *j) {
    memcpy(j->before, j->given, sizeof j->before);
    j->now = j->after;
    j->drive[0] = j->drive[1];
    j->drive_given = 0;
    j->balanced = 0;
}

void spari_joint_balance(spar_joint *j) {
    j->described = j->now;
    j->balanced = 1;
    j->now = j->after;
}

void spari_joint_end_start(spar_joint *j) {
    j->now = j->after;
    j->balanced = 0;
}

void spari_joint_reject(spar_joint *j) {
    if (j->balanced) {
        j->now = j->described;
        j->balanced = 0;
    }
    j->after = j->now;
    j->left = 0;
}
