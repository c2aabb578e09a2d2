/* Reads and writes the data of a session that are common to all ranks: see common_state.h. */
#include "common_state.h"

#include "../comm/comm.h"
#include "../coupling/coupling.h"
#include "../exchange/session_private.h"
#include "../member/added_mass.h"
#include "../member/added_mass_fit.h"
#include "../member/applied_loads.h"
#include "../member/check_arguments.h"
#include "../member/joint.h"
#include "../member/mean_acceleration.h"
#include "../session/settings.h"
#include "../solve/life.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

int spari_saved_broken(const spar_session *s) {
    return spari_fail(s, SPAR_ERR_IO, "the content of the file is invalid; use an older file");
}

int spari_saved_no_memory(const spar_session *s) {
    return spari_fail(s, SPAR_ERR_MEMORY, "no memory for the state of the session");
}

int spari_saved_check_call(const spar_session *s, const char *call, const char *path) {
    SPARI_TRY(spari_need_no_trial(s, call));
    SPARI_REQUIRE(s, !s->state.static_solution, SPAR_ERR_STATE,
                  "%s: a static solution or the initial accelerations are in progress; save or load after them", call);
    SPARI_REQUIRE(s, path && path[0], SPAR_ERR_ARGUMENT, "%s: the path is empty; give the name of a file", call);
    return spari_need_all_committed(s, call);
}

/* ---- the same code writes, checks and reads ---- */

typedef struct passage {
    spari_image *image;
    enum { WRITE, CHECK, READ } mode;
} passage;

static void pass(passage *t, void *words, int64_t n) {
    if (t->mode == WRITE) {
        spari_image_put(t->image, words, n);
    } else {
        const uint64_t *from = spari_image_get(t->image, n);
        if (t->mode == READ && words && from && n > 0) {
            memcpy(words, from, (size_t)n * sizeof *from);
        }
    }
}

static void pass_int(passage *t, int *x) {
    int64_t word = *x;
    pass(t, &word, 1);
    if (t->mode == READ) {
        *x = (int)word;
    }
}

/* A count of steps that continues. */
static void pass_count(passage *t, int *x) {
    enum { MOST = 1 << 30 };
    pass_int(t, x);
    if (t->mode == READ) {
        *x = *x < 0 ? 0 : *x > MOST ? MOST : *x;
    }
}

/* Numbers, checked to be finite. */
static void pass_numbers(passage *t, double *words, int64_t n) {
    const double *there = (const double *)(const void *)(t->image->word + t->image->at);
    pass(t, words, n);
    if (t->mode == CHECK && !t->image->failed) {
        t->image->failed = spari_first_nonfinite(there, n) >= 0;
    }
}

static void pass_clock(passage *t, spar_session *s) {
    int phase = (int)s->state.phase;
    spari_step_control *p = &s->own->step_control;
    pass(t, &s->clock.time, 1);
    pass(t, &s->clock.rest, 1);
    pass(t, &s->clock.dt, 1);
    pass(t, s->clock.dt_last, 2);
    pass_int(t, &s->clock.uneven[0]);
    pass_int(t, &s->clock.uneven[1]);
    pass(t, &s->clock.step, 1);
    pass_int(t, &s->state.iteration);
    pass_int(t, &s->state.iterating);
    pass_int(t, &s->state.failed);
    pass_int(t, &s->state.order);
    pass_int(t, &s->state.past);
    pass_int(t, &s->clock.started);
    pass_int(t, &phase);
    pass(t, s->gravity_before, 3);
    pass_numbers(t, &p->ratio, 1);
    pass_numbers(t, &p->last, 1);
    pass_numbers(t, &p->next, 1);
    pass_numbers(t, &p->cut, 1);
    pass(t, &p->rejected, 1);
    if (t->mode == READ) {
        s->state.phase = (spari_phase)phase;
        s->state.past = s->state.past < s->coupling.predictor ? s->state.past : s->coupling.predictor;
    }
}

/* Numbers that may be absent here or in the saved run: zeros in the file. */
static void pass_kept(passage *t, double *words, int64_t n) {
    double zero = 0;
    if (words) {
        pass(t, words, n);
    } else if (t->mode == WRITE) {
        for (int64_t i = 0; i < n; i++) {
            pass(t, &zero, 1);
        }
    } else {
        (void)spari_image_get(t->image, n);
    }
}

/* A motion: finite numbers, and unit quaternions. */
static void pass_motion(passage *t, double *words, int width, int64_t n) {
    const double *there = (const double *)(const void *)(t->image->word + t->image->at);
    pass_numbers(t, words, width * n);
    for (int64_t i = 0; i < n && t->mode == CHECK && !t->image->failed && width == 7; i++) {
        const double *q = there + 7 * i + 3;
        double size = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
        t->image->failed = !(size > 0.5 && size < 2);
    }
}

static void pass_learned(passage *t, spar_member *m) {
    int64_t n, last;
    double *state = spari_learned_state(m, &n), *nodal = spari_learned_last(m, &last);
    pass_numbers(t, state, n);
    pass_numbers(t, nodal, last);
    if (t->mode == READ) {
        spari_member_put_learned(m);
    }
}

static void pass_added(passage *t, spar_member *m) {
    const spari_added *d = m->added;
    double *const nodal[] = {d->past[0], d->past[1], d->mean[0], d->mean[1], d->mean[2], d->scheme};
    for (size_t k = 0; k < sizeof nodal / sizeof *nodal; k++) {
        pass_numbers(t, nodal[k], 6 * m->nodes);
    }
    if (m->learned) {
        pass_learned(t, m);
    }
    if (t->mode == READ) {
        spari_added_see(m);
    }
}

/* A flag, 0 or 1: as it is in the file, when one is read. */
static int pass_flag(passage *t, int here) {
    double flag = here;
    const double *in_file = (const double *)(const void *)(t->image->word + t->image->at);
    pass(t, &flag, 1);
    if (t->mode == CHECK && !t->image->failed) {
        flag = *in_file;
        t->image->failed = flag != 0 && flag != 1;
    }
    return flag != 0;
}

/* Mean accelerations, with substeps or changes of dt: in the file if they existed, read if they exist here. */
static void pass_means(passage *t, spar_member *m) {
    spari_means none = {0}, *k = m->means ? m->means : &none;
    int has[2];
    has[0] = pass_flag(t, k->has[0]);
    has[1] = pass_flag(t, k->has[1]);
    pass_numbers(t, &k->dt, 1);
    if (pass_flag(t, m->means != NULL) && t->mode == CHECK && !t->image->failed) {
        t->image->no_memory |= spari_means_make(m) != SPAR_OK;
    }
    if (has[0] || has[1]) {
        if (t->mode == CHECK) {
            pass_numbers(t, NULL, 18 * m->nodes);
        } else {
            pass_kept(t, k->mean, 18 * m->nodes);
        }
    }
    if (t->mode == READ) {
        memcpy(k->has, has, sizeof has);
    }
}

/* Initial accelerations of the first step after consistent initial conditions: in the file if there are any. */
static void pass_begun(passage *t, spar_member *m) {
    int has = pass_flag(t, m->initial.acceleration != NULL);
    if (t->mode == CHECK && has && !m->initial.acceleration_next) {
        m->initial.acceleration_next = spari_zalloc(6 * m->nodes, sizeof *m->initial.acceleration_next);
        t->image->no_memory |= !m->initial.acceleration_next;
    }
    if (t->mode == READ) {
        free(m->initial.acceleration);
        m->initial.acceleration = has ? m->initial.acceleration_next : NULL;
        m->initial.acceleration_next = has ? NULL : m->initial.acceleration_next;
    }
    if (has) {
        pass_numbers(t, t->mode == CHECK ? NULL : m->initial.acceleration, 6 * m->nodes);
    }
}

/* Halved substeps of a step in progress: in the file if there are any. */
static void pass_cuts(passage *t, spar_member *m) {
    enum { WORDS = sizeof m->state.cuts.given_up / sizeof(double) };
    const spar_session *s = m->session;
    const int under_way = s->state.phase != SPARI_IDLE && m->state.cuts.begun == s->clock.begun;
    int any = 0;
    for (size_t i = 0; i < sizeof m->state.cuts.given_up / sizeof *m->state.cuts.given_up && under_way; i++) {
        any = any || m->state.cuts.given_up[i] != 0;
    }
    int has = pass_flag(t, any);
    if (t->mode == READ) {
        m->state.cuts = (spari_cuts){.begun = s->clock.begun};
    }
    if (has) {
        pass(t, m->state.cuts.given_up, WORDS);
    }
}

static void pass_member(passage *t, spar_member *m) {
    for (int k = 0; k < SPARI_NODAL_COUNT; k++) {
        const spari_nodal *row = spari_nodal_table + k;
        if (row->kind == SPARI_NODAL_MOTION) {
            pass_motion(t, *spari_nodal_array(m, k), row->width, m->nodes);
        } else if (row->kind == SPARI_NODAL_LOAD) {
            pass_kept(t, *spari_nodal_array(m, k), row->width * m->nodes);
        }
    }
    pass(t, m->drive, 2 * (int64_t)(sizeof *m->drive / sizeof(double)));
    pass(t, &m->state.dissipated, 1);
    pass(t, &m->state.dissipated_step, 1);
    pass_numbers(t, &m->accuracy.step_error, 1);
    pass_numbers(t, &m->accuracy.speed, 1);
    pass_int(t, &m->state.balanced[0]);
    pass_int(t, &m->state.balanced[1]);
    pass_int(t, &m->state.motion_given);
    pass_int(t, &m->state.drive_given);
    if (m->added) {
        pass_added(t, m);
    }
    pass_means(t, m);
    pass_begun(t, m);
    pass_cuts(t, m);
    if (t->mode == WRITE) {
        spari_applied_save(m, t->image);
    } else if (t->mode == CHECK) {
        spari_applied_check(m, t->image);
    } else {
        spari_applied_load(m, t->image);
    }
}

/* Springs of joints, if they may be replaced at any time; a link's are part of its description. */
static void pass_joint(passage *t, spar_joint *j) {
    enum { SPRING = 3 };
    const struct {
        void *words;
        size_t size;
    } all[] = {{j->stiffness, sizeof j->stiffness}, {j->damping, sizeof j->damping},
               {j->preload, sizeof j->preload},     {&j->now, sizeof j->now},
               {&j->after, sizeof j->after},        {&j->described, sizeof j->described},
               {j->drive, sizeof j->drive},         {j->given, sizeof j->given},
               {j->before, sizeof j->before}};
    for (size_t k = j->kinematics.line ? SPRING : 0; k < sizeof all / sizeof *all; k++) {
        pass_numbers(t, all[k].words, (int64_t)(all[k].size / sizeof(double)));
    }
    if (!j->kinematics.line) {
        pass_int(t, &j->sprung);
    }
    pass_int(t, &j->drive_given);
    pass_int(t, &j->balanced);
}

static void pass_growth(passage *t, spari_growth *g) {
    pass_count(t, &g->count);
    pass(t, &g->log_sum, 1);
    pass(t, &g->log_square, 1);
    pass(t, &g->log_last, 1);
}

static void pass_accelerator(passage *t, const spar_session *s, spari_coupling *c) {
    int64_t n = t->mode == WRITE ? spari_accelerator_state_size(c->accelerator) : 0;
    pass(t, &n, 1);
    if (t->mode == WRITE) {
        double *state = (double *)(void *)spari_image_add(t->image, n);
        if (state) {
            spari_accelerator_save(c->accelerator, state);
        }
    } else {
        const double *state = (const double *)(const void *)spari_image_get(t->image, n);
        t->image->failed |= !state || !spari_accelerator_load(c->accelerator, state, n);
    }
    pass(t, c->predicted, c->n);
    pass(t, c->motion, spari_coupling_wants_motion(s) ? 7 * (c->n / 6) : 0);
    pass(t, c->before, c->settled ? 7 * (c->n / 6) : 0);
}

/* c: created with the settings of the image; never only checked */
static void pass_coupling(passage *t, const spar_session *s, spari_coupling *c) {
    pass_int(t, &c->iterations);
    c->iterations = c->iterations < 0 ? 0 : c->iterations > c->most ? c->most : c->iterations;
    pass(t, c->residual, c->iterations);
    pass(t, c->size, c->iterations);
    pass_int(t, &c->idle);
    pass(t, &c->moved, 1);
    pass(t, &c->travelled, 1);
    pass(t, c->report, SPAR_REPORT_COUNT);
    pass(t, &c->defect, 1);
    pass_count(t, &c->grown);
    pass_int(t, &c->warned);
    pass_count(t, &c->steps_unwarned);
    pass_int(t, &c->unconverged);
    pass_count(t, &c->in_row);
    pass(t, c->missed, c->n);
    pass_int(t, &c->was_explicit);
    pass_growth(t, &c->stability.steps);
    pass_count(t, &c->stability.opposed);
    pass(t, &c->stability.error, 1);
    pass(t, &c->stability.size, 1);
    for (int k = 0; k < SPARI_GROWTH_BLOCKS; k++) {
        spari_growth_block *b = &c->stability.block[k];
        pass_count(t, &b->steps);
        pass(t, &b->error, 1);
        pass(t, &b->size, 1);
        pass(t, &b->cosine, 1);
        pass(t, &b->last, 1);
        pass(t, &b->part, 1);
        pass_growth(t, &b->growth);
    }
    if (c->accelerator) {
        pass_accelerator(t, s, c);
    }
}

/* The length of the coupling comes first, so that it can be skipped. */
static void put_coupling(passage *t, const spar_session *s) {
    double settings[SPARI_MOST_OF_COUPLING];
    spari_image *image = t->image;
    int64_t at = image->count;
    spari_image_put_int(image, 0);
    if (spari_coupling_fits(s)) {
        spari_image_put(image, settings, spari_settings_of_coupling(s, settings));
        pass_coupling(t, s, s->own->coupling);
    }
    if (!image->failed) {
        image->word[at] = (uint64_t)(image->count - at - 1);
    }
}

/* The name of a member or joint, in the order of the file. */
static int pass_name(passage *t, const spar_session *s, const char *what, const char *name) {
    if (t->mode == WRITE) {
        spari_image_put_text(t->image, name);
        return SPAR_OK;
    }
    SPARI_REQUIRE(s, spari_image_is_text(t->image, name), SPAR_ERR_ARGUMENT,
                  "the file does not match this session: %s '%s' is out of order; create members and joints in the "
                  "order of the saved run",
                  what, name);
    return SPAR_OK;
}

/* A description, which must be that of the file: its numbers to rounding (member/digest.h). Returns whether it is. */
static int pass_digest(passage *t, const spari_digest *digest) {
    if (t->mode == WRITE) {
        spari_image_put(t->image, &digest->exact, 1);
        spari_image_put(t->image, digest->sum, digest->count);
        return 1;
    }
    int same = (uint64_t)spari_image_get_int(t->image) == digest->exact;
    const double *in_file = (const double *)(const void *)spari_image_get(t->image, same ? digest->count : 0);
    for (int i = 0; i < digest->count && same && in_file; i++) {
        same = fabs(in_file[i] - digest->sum[i]) <= digest->tolerance[i];
    }
    return same;
}

static int pass_description(passage *t, const spar_session *s, const spar_member *m) {
    spari_digest digest;
    SPARI_TRY(pass_name(t, s, "member", m->name));
    for (int part = 0; part < SPARI_SAVED_PARTS; part++) {
        spari_member_part_digest(m, part, &digest);
        SPARI_REQUIRE(s, pass_digest(t, &digest), SPAR_ERR_ARGUMENT,
                      "the file does not match this session: it has a different description of member '%s': its %s",
                      m->name, spari_member_part_name[part]);
    }
    return SPAR_OK;
}

static int pass_joint_description(passage *t, const spar_session *s, const spar_joint *j) {
    spari_digest digest;
    SPARI_TRY(pass_name(t, s, "joint", j->name));
    spari_joint_digest(j, &digest);
    SPARI_REQUIRE(s, pass_digest(t, &digest), SPAR_ERR_ARGUMENT,
                  "the file does not match this session: it has a different description of joint '%s'", j->name);
    return SPAR_OK;
}

/* The number of ranks, and the names and descriptions of members and joints. */
static int pass_names(passage *t, const spar_session *s, int *ranks) {
    int members = s->member_count, joints = s->joint_count;
    pass_int(t, ranks);
    pass_int(t, &members);
    SPARI_REQUIRE(s, members == s->member_count, SPAR_ERR_ARGUMENT,
                  "the file does not match this session: it has %d members, this session has %d", members,
                  s->member_count);
    for (const spar_member *m = s->members; m; m = m->next) {
        SPARI_TRY(pass_description(t, s, m));
    }
    pass_int(t, &joints);
    SPARI_REQUIRE(s, joints == s->joint_count || t->image->failed, SPAR_ERR_ARGUMENT,
                  "the file does not match this session: it has %d joints, this session has %d", joints,
                  s->joint_count);
    for (const spar_joint *j = s->joints; j; j = j->next) {
        SPARI_TRY(pass_joint_description(t, s, j));
    }
    return SPAR_OK;
}

static void pass_structure(passage *t, const spar_session *s) {
    for (spar_member *m = s->members; m; m = m->next) {
        pass_member(t, m);
    }
    for (spar_joint *j = s->joints; j; j = j->next) {
        pass_joint(t, j);
    }
}

/* ---- to a file ---- */

void spari_saved_put(spari_image *image, spar_session *s) {
    passage t = {image, WRITE};
    int ranks = spari_comm_size(s->ranks.comm);
    (void)pass_names(&t, s, &ranks);
    pass_clock(&t, s);
    pass_structure(&t, s);
    put_coupling(&t, s);
}

/* ---- from a file ---- */

static int is_within(int64_t x, int64_t least, int64_t most) {
    return x >= least && x <= most;
}

/* Reads a valid clock into a copy of the session. */
static int check_clock(spar_session *s, spari_saved *l) {
    passage t = {&l->image, READ};
    spar_session then = *s;
    pass_clock(&t, &then);
    int phase = (int)then.state.phase, within = phase > SPARI_IDLE;
    int ok = !l->image.failed && isfinite(then.clock.time) && isfinite(then.clock.rest) && isfinite(then.clock.dt) &&
             then.clock.dt >= 0 && (!within || then.clock.dt > 0) && is_within(then.clock.step, 0, INT64_C(1) << 53) &&
             is_within(then.state.iteration, 0, 1 << 30) && is_within(phase, SPARI_IDLE, SPARI_CHECKED) &&
             is_within(then.state.order, 0, 2) &&
             is_within(then.state.past, within && then.clock.step == 0 ? -1 : 0, then.coupling.predictor) &&
             then.clock.started == (within || then.clock.step > 0) && spari_first_nonfinite(then.gravity_before, 3) < 0;
    for (int k = 0; k < 2; k++) { /* divisors of a prediction */
        int used = then.state.past > k || (within && then.state.order > k);
        ok =
            ok && isfinite(then.clock.dt_last[k]) && then.clock.dt_last[k] >= 0 && (!used || then.clock.dt_last[k] > 0);
    }
    l->phase = phase;
    return ok ? SPAR_OK : spari_saved_broken(s);
}

/* Creates a coupling from the data that fit the present settings. */
static int check_coupling(spar_session *s, spari_saved *l) {
    int64_t count = spari_image_get_int(&l->image);
    if (count == 0 && !l->image.failed) {
        return SPAR_OK;
    }
    if (l->image.failed || count < 0 || count > l->image.count - l->image.at) {
        return spari_saved_broken(s);
    }
    const int64_t end = l->image.at + count;
    double settings[SPARI_MOST_OF_COUPLING];
    int own = spari_settings_of_coupling(s, settings);
    const uint64_t *saved = spari_image_get(&l->image, own);
    if (saved && memcmp(saved, settings, (size_t)own * sizeof *settings) == 0) {
        SPARI_TRY(spari_coupling_create(s, s->coupling.scheme, 0, &l->coupling));
        passage t = {&l->image, READ};
        pass_coupling(&t, s, l->coupling);
        return l->image.failed || l->image.at != end ? spari_saved_broken(s) : SPAR_OK;
    }
    SPARI_REQUIRE(s, l->phase == SPARI_IDLE, SPAR_ERR_STATE,
                  "the file was saved during a step with other coupling settings; use the same settings first (change "
                  "them after the step is accepted)");
    l->image.at = end;
    return SPAR_OK;
}

int spari_saved_check(spar_session *s, spari_saved *l) {
    passage names = {&l->image, READ}, t = {&l->image, CHECK};
    SPARI_TRY(pass_names(&names, s, &l->ranks));
    if (l->image.failed || l->ranks < 1) {
        return spari_saved_broken(s);
    }
    l->clock = l->image.at;
    SPARI_TRY(check_clock(s, l));
    pass_structure(&t, s);
    if (l->image.no_memory) {
        return spari_saved_no_memory(s);
    }
    return l->image.failed ? spari_saved_broken(s) : check_coupling(s, l);
}

void spari_saved_load(spar_session *s, spari_saved *l) {
    passage t = {&l->image, READ};
    l->image.at = l->clock;
    pass_clock(&t, s);
    pass_structure(&t, s);
    s->coupling.stale = !l->coupling;
    if (l->coupling) {
        spari_coupling_free(&s->own->coupling);
        s->own->coupling = l->coupling;
        l->coupling = NULL;
    }
}

void spari_saved_free(spari_saved *l) {
    spari_image_free(&l->image);
    spari_coupling_free(&l->coupling);
}
