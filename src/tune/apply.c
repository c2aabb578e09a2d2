/* Puts advice in force: settings, and members rebuilt in place as in trials, permanently. */
#include "apply.h"

#include "../base/environment.h"
#include "../comm/enter.h"
#include "../exchange/rank_loads_and_motion.h"
#include "../exchange/session_private.h"
#include "../fluid/fluid.h"
#include "../math/predictor.h"
#include "../member/beam.h"
#include "../member/check_arguments.h"
#include "../member/joint.h"
#include "../member/mean_acceleration.h"
#include "../solve/work.h"
#include "../trial/handle.h"
#include "../trial/move_joints.h"
#include "../trial/move_loads.h"
#include "../trial/rebuild.h"

#include <stdlib.h>
#include <string.h>

uint64_t spari_advised_of(const spar_session *s) {
    uint64_t h = SPARI_HASH_BEGIN;
    for (const spar_member *m = s->members; m; m = m->next) {
        uint64_t one = spari_member_hash(m);
        h = spari_hash_bytes(h, &one, sizeof one);
    }
    return h;
}

/* ---- apply, and undo after a failure ---- */

/* A rebuilt member or fluid, and the old one. */
typedef struct anew {
    spar_member *member, was;
    spar_fluid *fluid, *fluid_was;
} anew;

typedef struct change {
    double before[SPARI_MOST_VARIED]; /* old settings */
    int past;
    spari_exchange exchange; /* likewise */
    anew *made;              /* [count] in order */
    int64_t count;
    spari_moved_loads *carried;          /* [count] room for the fluids with other nodes */
    spari_joint_snapshot joint_snapshot; /* of the members; copied if a connected one is rebuilt */
} change;

static int change_create(spar_session *s, change *c) {
    int64_t n = s->member_count;
    for (const spar_fluid *f = s->fluids; f; f = spari_fluid_next(f)) {
        n++;
    }
    *c = (change){.made = spari_zalloc(n, sizeof *c->made), .carried = spari_zalloc(n, sizeof *c->carried)};
    SPARI_REQUIRE(s, c->made && c->carried, SPAR_ERR_MEMORY, "no memory to apply the advice");
    return SPAR_OK;
}

static void put_settings(spar_session *s, const double *values, int past) {
    spari_settings_vary(s, values);
    s->state.past = past < s->coupling.predictor ? past : s->coupling.predictor;
}

static int is_as_advised(const spar_member *m, const spari_rebuild *to) {
    return (to->per_element == m->mesh.per_element && (to->elements == 0 || to->elements == m->mesh.elements) &&
            to->fidelity == m->fidelity && to->modes == m->modes && (to->points == 0 || to->points == m->beam->points));
}

/* to [members] */
static int rebuild_members(spar_session *s, const spari_rebuild *to, change *c) {
    int joints_moved = 0; /* members that are tied begin anew together: whether one of them has to */
    const spari_rebuild *each = to;
    for (const spar_member *m = s->members; m && s->joints; m = m->next, each++) {
        joints_moved = joints_moved || (!is_as_advised(m, each) && m->joint_count > 0);
    }
    if (joints_moved) {
        SPARI_TRY(spari_joints_save_snapshot(s, &c->joint_snapshot));
    }
    for (spar_member *m = s->members; m; m = m->next, to++) {
        if (is_as_advised(m, to) && !(joints_moved && m->joint_count > 0)) {
            SPARI_REQUIRE(s, spari_history_keep(m->load.history, 6 * m->nodes, s->coupling.predictor) == SPAR_OK,
                          SPAR_ERR_MEMORY, "no memory for the loads of '%s'", m->name);
            SPARI_TRY(spari_means_keep(m));
            continue;
        }
        anew *a = &c->made[c->count++];
        a->member = m;
        SPARI_TRY(spari_member_rebuild(m, to, &a->was));
        SPARI_TRY(spari_joints_follow_rebuild(m, &a->was));
        spari_work_carry(&a->was, m);
    }
    return SPAR_OK;
}

static int rebuild_fluids(spar_session *s, change *c) {
    int64_t members = c->count;
    for (spar_fluid *f = s->fluids; f; f = spari_fluid_next(f)) {
        const anew *of = NULL;
        for (int64_t k = 0; k < members; k++) {
            of = c->made[k].member == spari_fluid_member(f) ? &c->made[k] : of;
        }
        if (!of) {
            SPARI_REQUIRE(s, spari_fluid_keep(f, s->coupling.predictor) == SPAR_OK, SPAR_ERR_MEMORY,
                          "no memory for the forces of '%s'", spar_fluid_get_name(f));
            continue;
        }
        anew *a = &c->made[c->count];
        int status = spari_fluid_rebuild(f, &of->was, &a->fluid_was);
        a->fluid = f;
        c->count += a->fluid_was != NULL;
        SPARI_TRY(status);
    }
    return SPAR_OK;
}

static int has_other_nodes(const anew *a) {
    return !spari_mesh_is_equal(a->member->mesh, a->was.mesh);
}

/* Collective. */
static int carry_change(spar_session *s, const change *c, const char *call) {
    int64_t count = 0;
    int any = 0;
    for (int64_t k = 0; k < c->count; k++) {
        const anew *a = &c->made[k];
        any = any || (a->member && has_other_nodes(a));
        for (int64_t j = 0; j < c->count && a->fluid; j++) {
            const anew *of = &c->made[j];
            if (of->member && of->member == spari_fluid_member(a->fluid) && has_other_nodes(of)) {
                c->carried[count++] = (spari_moved_loads){a->fluid, a->fluid_was, &of->was};
            }
        }
    }
    return spari_move_loads(s, call, any, c->carried, count);
}

/* Keeps what has been made, or restores what was. */
static void end_made(const change *c, int keep) {
    for (int64_t k = c->count - 1; k >= 0; k--) {
        anew *a = &c->made[k];
        if (a->fluid) {
            (keep ? spari_fluid_adopt : spari_fluid_restore)(a->fluid, a->fluid_was);
        } else if (keep) {
            spari_member_adopt(a->member, &a->was);
        } else {
            spari_member_restore(a->member, &a->was);
        }
    }
}

/* ---- public call ---- */

static int check_apply(spar_trial *t, const char *call) {
    spar_session *s = t->session;
    SPARI_TRY(spari_need_no_trial(s, call));
    SPARI_TRY(spari_need_idle(s, call));
    SPARI_REQUIRE(s, t->advised.given, SPAR_ERR_STATE, "%s: there is no advice yet; call %s first", call,
                  "spar_trial_advise");
    SPARI_REQUIRE(s, t->advised.of == spari_advised_of(s), SPAR_ERR_STATE,
                  "%s: members were added or changed after the advice; request the advice again", call);
    for (const spar_fluid *f = s->fluids; f; f = spari_fluid_next(f)) {
        SPARI_REQUIRE(s, !spari_fluid_is_pending(f), SPAR_ERR_STATE,
                      "%s: fluid '%s' has nodes that are not mapped; call spar_fluid_map first", call,
                      spar_fluid_get_name(f));
    }
    return SPAR_OK;
}

int spar_trial_apply(spar_trial *trial, double *dt) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_REQUIRE(NULL, trial, SPAR_ERR_ARGUMENT, "%s: the trial is NULL; create it first", __func__);
    spar_session *s = trial->session;
    spari_advised *advised = &trial->advised;
    change c = {0};
    SPARI_TRY(spari_trial_enter(trial, __func__, NULL, 0, check_apply(trial, __func__)));
    int status = change_create(s, &c), begun = status == SPAR_OK;
    if (begun) {
        c.exchange = s->own->exchange;
        s->own->exchange = (spari_exchange){0}; /* made anew by the seal below */
        (void)spari_settings_varied(s, c.before);
        c.past = s->state.past;
        put_settings(s, advised->setting, s->state.past);
        status = rebuild_members(s, advised->beam, &c);
        status = status == SPAR_OK ? rebuild_fluids(s, &c) : status;
    }
    if (s->joints) { /* whether there are joints agrees on all ranks; they change only on success */
        status = spari_enter(s, "advice", status);
        status = status == SPAR_OK ? spari_assemblies_make(s, __func__) : status;
    }
    status = spari_session_seal(s, status);
    status = status == SPAR_OK ? carry_change(s, &c, __func__) : status;
    spari_exchange unused = c.exchange;
    if (status == SPAR_OK) {
        end_made(&c, 1);
        spari_joints_drop_snapshot(s, &c.joint_snapshot);
        s->coupling.stale = 1;
        advised->of = spari_advised_of(s);
    } else if (begun) { /* the message of the failure stays */
        end_made(&c, 0);
        spari_joints_restore_snapshot(s, &c.joint_snapshot);
        put_settings(s, c.before, c.past);
        unused = s->own->exchange;
        s->own->exchange = c.exchange;
    }
    SPARI_FREE(unused.pack, unused.motion, unused.first, c.made, c.carried);
    if (status == SPAR_OK) {
        SPARI_GIVE(dt, advised->dt);
    }
    return spari_trial_leave(trial, __func__, status);
}
