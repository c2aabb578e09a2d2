/* Save and load: the whole session in one file (image.h), in this order:
     ranks; members and joints: name and description of each; the clock; the state of each member and joint; the
     coupling; then what is one rank's own, rank by rank: the solvers of its members, of its assemblies, its fluids.
   Every rank gets the whole image to load from, so that members and fluids may live on other ranks than before. A file
   is taken in two passes: the first checks and gets memory, and only when all ranks can load does the second change the
   session. */
#include "../base/image.h"
#include "../base/quiet.h"
#include "../fluid/fluid.h"
#include "coupling.h"
#include "exchange.h"
#include "own.h"
#include "settings.h"
#include "spread.h"

#include "../comm/enter.h"

#include "../member/added.h"
#include "../member/applied.h"
#include "../member/joint.h"
#include "../member/means.h"
#include "../solve/assembly.h"
#include "../solve/fidelity.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- what is there on every rank: the same code writes, checks and reads ---- */

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

/* Of steps, which go on being counted. */
static void pass_count(passage *t, int *x) {
    enum { MOST = 1 << 30 };
    pass_int(t, x);
    if (t->mode == READ) {
        *x = *x < 0 ? 0 : *x > MOST ? MOST : *x;
    }
}

static void pass_clock(passage *t, spar_session *s) {
    int phase = (int)s->phase;
    pass(t, &s->time, 1);
    pass(t, &s->dt, 1);
    pass(t, s->dt_last, 2);
    pass(t, &s->step, 1);
    pass_int(t, &s->iteration);
    pass_int(t, &s->iterating);
    pass_int(t, &s->failed);
    pass_int(t, &s->order);
    pass_int(t, &s->past);
    pass_int(t, &s->started);
    pass_int(t, &phase);
    if (t->mode == READ) {
        s->phase = (spari_phase)phase;
        s->past = s->past < s->predictor ? s->past : s->predictor;
    }
}

/* What may not be kept here, or was not there: zeros in the file. */
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

/* Of a motion that is only checked: numbers, and rotations where they are. */
static void check_pose_words(passage *t, const double *words, int width, int64_t n) {
    int ok = words && spari_first_nonfinite(words, width * n) < 0;
    for (int64_t i = 0; i < n && ok && width == 7; i++) {
        const double *q = words + 7 * i + 3;
        double size = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
        ok = size > 0.5 && size < 2;
    }
    t->image->failed |= !ok;
}

static void pass_motion(passage *t, double *words, int width, int64_t n) {
    const double *there = (const double *)(const void *)(t->image->word + t->image->at);
    pass(t, words, width * n);
    if (t->mode == CHECK) {
        check_pose_words(t, t->image->failed ? NULL : there, width, n);
    }
}

/* Numbers, checked to be some. */
static void pass_numbers(passage *t, double *words, int64_t n) {
    const double *there = (const double *)(const void *)(t->image->word + t->image->at);
    pass(t, words, n);
    if (t->mode == CHECK && !t->image->failed) {
        t->image->failed = spari_first_nonfinite(there, n) >= 0;
    }
}

static void pass_added(passage *t, spar_member *m) {
    for (int k = 0; k < 2; k++) {
        pass_numbers(t, m->added->past[k], 6 * m->nodes);
    }
    if (t->mode == READ) {
        spari_added_see(m);
    }
}

/* Where there are substeps: in the file if there were any, and taken if there are here. */
static void pass_means(passage *t, spar_member *m) {
    spari_means none = {0}, *k = m->means ? m->means : &none;
    double head[3] = {k->has[0], k->has[1], k->dt};
    const double *in_file = (const double *)(const void *)(t->image->word + t->image->at);
    pass(t, head, 3);
    if (t->mode == CHECK && !t->image->failed) {
        memcpy(head, in_file, sizeof head);
        t->image->failed = (head[0] != 0 && head[0] != 1) || (head[1] != 0 && head[1] != 1) || !isfinite(head[2]);
    }
    if (head[0] != 0 || head[1] != 0) {
        if (t->mode == CHECK) {
            pass_numbers(t, NULL, 18 * m->nodes);
        } else {
            pass_kept(t, k->mean, 18 * m->nodes);
        }
    }
    if (t->mode == READ) {
        k->has[0] = head[0] != 0, k->has[1] = head[1] != 0;
        k->dt = head[2];
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
    pass(t, &m->dissipated, 1);
    pass(t, &m->dissipated_step, 1);
    pass_int(t, &m->motion_given);
    pass_int(t, &m->drive_given);
    if (m->added) {
        pass_added(t, m);
    }
    pass_means(t, m);
    if (t->mode == WRITE) {
        spari_applied_save(m, t->image);
    } else if (t->mode == CHECK) {
        spari_applied_check(m, t->image);
    } else {
        spari_applied_load(m, t->image);
    }
}

/* Springs are there where they may be given anew at any time; a line's are part of its description. */
static void pass_joint(passage *t, spar_joint *j) {
    enum { SPRING = 3 };
    const struct {
        void *words;
        size_t size;
    } all[] = {{j->stiffness, sizeof j->stiffness}, {j->damping, sizeof j->damping},
               {j->preload, sizeof j->preload},     {&j->now, sizeof j->now},
               {&j->after, sizeof j->after},        {&j->described, sizeof j->described},
               {j->drive, sizeof j->drive},         {j->given, sizeof j->given}};
    for (size_t k = j->tie.line ? SPRING : 0; k < sizeof all / sizeof *all; k++) {
        pass_numbers(t, all[k].words, (int64_t)(all[k].size / sizeof(double)));
    }
    if (!j->tie.line) {
        pass_int(t, &j->sprung);
    }
    pass_int(t, &j->drive_given);
    pass_int(t, &j->balanced);
}

/* c: of the settings in the image; never only checked */
static void pass_coupling(passage *t, spari_coupling *c) {
    pass_int(t, &c->iterations);
    c->iterations = c->iterations < 0 ? 0 : c->iterations > c->most ? c->most : c->iterations;
    pass(t, c->residual, c->iterations);
    pass(t, c->size, c->iterations);
    pass(t, &c->moved, 1);
    pass(t, &c->travelled, 1);
    pass(t, c->report, SPAR_REPORT_COUNT);
    pass(t, &c->defect, 1);
    pass_count(t, &c->grown);
    pass_int(t, &c->warned);
    pass_count(t, &c->turns);
    pass_count(t, &c->calm);
    pass_int(t, &c->unconverged);
    pass_count(t, &c->in_row);
    pass(t, &c->log_growth, 1);
    pass(t, &c->log_growth2, 1);
    pass(t, &c->bound, 1);
    pass_int(t, &c->bound_order);
    pass(t, c->missed, c->missed ? c->n : 0);
}

static void put_accelerator(spari_image *image, const spari_coupling *c) {
    int64_t n = spari_accelerator_state_size(c->accelerator);
    double *state = spari_zalloc(n, sizeof *state);
    if (!state) {
        image->failed = 1;
        return;
    }
    spari_accelerator_save(c->accelerator, state);
    spari_image_put_int(image, n);
    spari_image_put(image, state, n);
    spari_image_put(image, c->predicted, c->n);
    free(state);
}

static int64_t motion_words(const spar_session *s, const spari_coupling *c) {
    return c->accelerator && spari_coupling_wants_motion(s) ? 7 * (c->n / 6) : 0;
}

/* The length of the coupling comes first: it may have to be passed over. */
static void put_coupling(spari_image *image, spar_session *s) {
    double settings[SPARI_MOST_OF_COUPLING];
    int64_t at = image->count;
    spari_image_put_int(image, 0);
    if (spari_coupling_fits(s)) {
        passage t = {image, WRITE};
        spari_image_put(image, settings, spari_settings_of_coupling(s, settings));
        pass_coupling(&t, s->own->coupling);
        if (s->own->coupling->accelerator) {
            put_accelerator(image, s->own->coupling);
            spari_image_put(image, s->own->coupling->motion, motion_words(s, s->own->coupling));
        }
    }
    if (!image->failed) {
        image->word[at] = (uint64_t)(image->count - at - 1);
    }
}

/* ---- what is one rank's own ---- */

static int member_index(const spar_session *s, const spar_member *member) {
    int k = 0;
    for (const spar_member *m = s->members; m != member; m = m->next) {
        k++;
    }
    return k;
}

static double *put_room(spari_image *image, int64_t n) {
    double *room = spari_zalloc(n, sizeof *room);
    image->failed |= !room;
    return room;
}

/* What the assemblies that are solved here keep, each by its place in the list, which is alike on all ranks. */
static void put_assemblies(spari_image *image, const spar_session *s) {
    int64_t count = 0, k = 0;
    for (const spari_assembly *a = s->assemblies; a; a = spari_assembly_next(a)) {
        count += spari_assembly_state_size(a) > 0;
    }
    spari_image_put_int(image, count);
    for (const spari_assembly *a = s->assemblies; a; a = spari_assembly_next(a), k++) {
        int64_t n = spari_assembly_state_size(a);
        double *state = n > 0 ? put_room(image, n) : NULL;
        if (state) {
            spari_assembly_save(a, state);
            spari_image_put_int(image, k);
            spari_image_put_int(image, n);
            spari_image_put(image, state, n);
            free(state);
        }
    }
}

static int put_own(spari_image *image, const spar_session *s, const char *call) {
    int64_t solvers = 0, fluids = 0;
    int k = 0;
    for (const spar_member *m = s->members; m; m = m->next) {
        solvers += spari_fidelity_state_size(m) > 0;
    }
    for (const spar_fluid *f = s->fluids; f; f = spari_fluid_next(f)) {
        fluids++;
    }
    spari_image_put_int(image, solvers);
    for (const spar_member *m = s->members; m; m = m->next, k++) {
        int64_t n = spari_fidelity_state_size(m);
        if (n > 0) {
            double *state = put_room(image, n);
            if (state) {
                m->row->save(m, state);
                spari_image_put_int(image, k);
                spari_image_put_int(image, n);
                spari_image_put(image, state, n);
                free(state);
            }
        }
    }
    put_assemblies(image, s);
    spari_image_put_int(image, fluids);
    for (const spar_fluid *f = s->fluids; f; f = spari_fluid_next(f)) {
        int64_t n = spari_fluid_state_size(f);
        double *state = put_room(image, n);
        if (state) {
            int status = spari_fluid_save(f, call, state);
            spari_image_put_int(image, member_index(s, spari_fluid_member(f)));
            spari_image_put_text(image, spar_fluid_get_name(f));
            spari_image_put_int(image, n);
            spari_image_put(image, state, n);
            free(state);
            SPARI_TRY(status);
        }
    }
    return SPAR_OK;
}

/* ---- between the ranks ---- */

static int agree(spar_session *s, int status) {
    return spari_comm_agree(s->comm, status, s->message, sizeof s->message);
}

static int no_memory_for_state(spar_session *s) {
    return spari_fail(s, SPAR_ERR_MEMORY, "no memory for the state of the session");
}

/* The words of all ranks, rank by rank, each followed by a word of the exchange: rank r has all[first[r]] to
   all[first[r + 1] - 2]. */
static int gather_images(spar_session *s, const spari_image *mine, double **all, int64_t **first) {
    int ranks = spari_comm_size(s->comm), rank = spari_comm_rank(s->comm);
    double *sizes = spari_zalloc(2 * ranks, sizeof *sizes);
    *first = spari_zalloc(ranks + 1, sizeof **first);
    int status = agree(s, sizes && *first ? SPAR_OK : no_memory_for_state(s));
    if (status == SPAR_OK) {
        for (int r = 0; r < ranks; r++) {
            (*first)[r + 1] = 2 * (r + 1);
        }
        sizes[2 * rank] = (double)mine->count;
        status = spari_comm_share(s->comm, sizes, *first, SPAR_OK, s->message, sizeof s->message);
    }
    if (status == SPAR_OK) {
        for (int r = 0; r < ranks; r++) {
            (*first)[r + 1] = (*first)[r] + (int64_t)sizes[2 * r] + 1;
        }
        *all = spari_zalloc((*first)[ranks], sizeof **all);
        status = agree(s, *all ? SPAR_OK : no_memory_for_state(s));
    }
    free(sizes);
    SPARI_TRY(status);
    memcpy(*all + (*first)[rank], mine->word, (size_t)mine->count * sizeof **all);
    return spari_comm_share(s->comm, *all, *first, SPAR_OK, s->message, sizeof s->message);
}

/* ---- save ---- */

static void put_common(spari_image *image, spar_session *s) {
    passage t = {image, WRITE};
    spari_image_put_int(image, spari_comm_size(s->comm));
    spari_image_put_int(image, s->member_count);
    for (const spar_member *m = s->members; m; m = m->next) {
        uint64_t hash = spari_member_hash(m);
        spari_image_put_text(image, m->name);
        spari_image_put(image, &hash, 1);
    }
    spari_image_put_int(image, s->joint_count);
    for (const spar_joint *j = s->joints; j; j = j->next) {
        uint64_t hash = spari_joint_hash(j);
        spari_image_put_text(image, j->name);
        spari_image_put(image, &hash, 1);
    }
    pass_clock(&t, s);
    for (spar_member *m = s->members; m; m = m->next) {
        pass_member(&t, m);
    }
    for (spar_joint *j = s->joints; j; j = j->next) {
        pass_joint(&t, j);
    }
    put_coupling(image, s);
}

static int write_file(spar_session *s, const double *all, const int64_t *first, const char *path) {
    char why[SPARI_MESSAGE_SIZE / 2] = "";
    spari_image image = {0};
    put_common(&image, s);
    for (int r = 0; r < spari_comm_size(s->comm); r++) {
        int64_t n = first[r + 1] - first[r] - 1;
        spari_image_put_int(&image, n);
        spari_image_put(&image, all + first[r], n);
    }
    int status = image.failed ? no_memory_for_state(s) : SPAR_OK;
    if (status == SPAR_OK) {
        status = spari_image_write(&image, path, why, sizeof why);
        if (status != SPAR_OK) {
            (void)spari_fail(s, status, "%s", why);
        }
    }
    spari_image_free(&image);
    return status;
}

static int check_call(spar_session *s, const char *call, const char *path) {
    SPARI_REQUIRE(s, !s->trial, SPAR_ERR_STATE, "%s: a trial run is under way", call);
    SPARI_REQUIRE(s, !s->standing, SPAR_ERR_STATE,
                  "%s: a static solution or a start is under way; save or load "
                  "after it",
                  call);
    SPARI_REQUIRE(s, path && path[0], SPAR_ERR_ARGUMENT, "%s: the path is empty; give the name of a file", call);
    for (const spar_member *m = s->members; m; m = m->next) {
        SPARI_REQUIRE(s, m->committed, SPAR_ERR_STATE,
                      "%s: member '%s' is not committed; call spar_member_commit first", call, m->name);
    }
    return SPAR_OK;
}

int spar_session_save(const spar_session *session, const char *path) {
    SPARI_QUIET;
    SPARI_REQUIRE(NULL, session, SPAR_ERR_ARGUMENT, "%s: the session is NULL; create it first", __func__);
    spar_session *s = (spar_session *)(uintptr_t)session; /* its message is written; its state is not touched */
    spari_image own = {0};
    double *all = NULL;
    int64_t *first = NULL;
    int status = check_call(s, __func__, path);
    status = status == SPAR_OK ? spari_session_pushes(s, __func__) : status;
    SPARI_TRY(spari_enter_alike(s, __func__, NULL, 0, status));
    status = spari_members_retie(s);
    status = status == SPAR_OK ? put_own(&own, s, __func__) : status;
    status = agree(s, status == SPAR_OK && own.failed ? no_memory_for_state(s) : status);
    if (status == SPAR_OK) {
        status = gather_images(s, &own, &all, &first);
    }
    if (status == SPAR_OK) {
        status = agree(s, spari_comm_rank(s->comm) == 0 ? write_file(s, all, first, path) : SPAR_OK);
    }
    spari_image_free(&own);
    free(all);
    free(first);
    return spari_named(s, __func__, status);
}

/* ---- load: first pass ---- */

/* A fluid of the saved run */
typedef struct record {
    int rank, member;
    int64_t name; /* where its name begins */
    const double *state;
    int64_t count;
} record;

typedef struct reading {
    const char *call; /* that reads */
    spari_image image;
    int64_t common;          /* where the clock begins */
    int phase;               /* where the step stood */
    int ranks;               /* of the saved run */
    const double **solution; /* [members] state of each that is solved for here; NULL: not here */
    const double **tied;     /* [joints] the same of the assemblies, as many as there are; NULL: nothing is kept */
    record *records;         /* fluids of all ranks */
    int64_t record_count;
    const double **states;    /* of the records that make up each fluid here, one after the other */
    int *state_count;         /* [fluids here] */
    int *takes_loads;         /* [fluids here] */
    int64_t fluid_count;      /* here */
    spari_coupling *coupling; /* made from the image; NULL: none that fits */
} reading;

static void end_loading(reading *l) {
    spari_image_free(&l->image);
    free(l->solution);
    free(l->tied);
    free(l->records);
    free(l->states);
    free(l->state_count);
    free(l->takes_loads);
    spari_coupling_free(&l->coupling);
}

static int broken(spar_session *s) {
    return spari_fail(s, SPAR_ERR_IO, "the file does not hold what it should; take an older file");
}

static int compare_scene(spar_session *s, reading *l) {
    l->ranks = (int)spari_image_get_int(&l->image);
    int64_t members = spari_image_get_int(&l->image);
    SPARI_REQUIRE(s, members == s->member_count, SPAR_ERR_ARGUMENT,
                  "the file is of another session: it has %lld members, this one %d", (long long)members,
                  s->member_count);
    for (const spar_member *m = s->members; m; m = m->next) {
        SPARI_REQUIRE(s, spari_image_is_text(&l->image, m->name), SPAR_ERR_ARGUMENT,
                      "the file is of another session: member '%s' is not where it should be; create the same "
                      "members in the same order",
                      m->name);
        SPARI_REQUIRE(s, (uint64_t)spari_image_get_int(&l->image) == spari_member_hash(m), SPAR_ERR_ARGUMENT,
                      "the file is of another session: member '%s' is described otherwise there", m->name);
    }
    int64_t joints = spari_image_get_int(&l->image);
    SPARI_REQUIRE(s, joints == s->joint_count || l->image.failed, SPAR_ERR_ARGUMENT,
                  "the file is of another session: it has %lld joints, this one %d", (long long)joints, s->joint_count);
    for (const spar_joint *j = s->joints; j; j = j->next) {
        SPARI_REQUIRE(s, spari_image_is_text(&l->image, j->name), SPAR_ERR_ARGUMENT,
                      "the file is of another session: joint '%s' is not where it should be; create the same joints in "
                      "the same order",
                      j->name);
        SPARI_REQUIRE(s, (uint64_t)spari_image_get_int(&l->image) == spari_joint_hash(j), SPAR_ERR_ARGUMENT,
                      "the file is of another session: joint '%s' is described otherwise there", j->name);
    }
    return l->image.failed || l->ranks < 1 ? broken(s) : SPAR_OK;
}

/* Where the next count words end, if there are as many. */
static int find_end(const spari_image *image, int64_t count, int64_t *end) {
    int there = !image->failed && count >= 0 && count <= image->count - image->at;
    *end = there ? image->at + count : image->at;
    return there;
}

static int is_within(int64_t x, int64_t least, int64_t most) {
    return x >= least && x <= most;
}

/* A clock that can go on, read into a copy of the session. */
static int check_clock(spar_session *s, reading *l) {
    passage t = {&l->image, READ};
    spar_session then = *s;
    pass_clock(&t, &then);
    int phase = (int)then.phase, within = phase > SPARI_IDLE;
    int ok = !l->image.failed && isfinite(then.time) && isfinite(then.dt) && then.dt >= 0 && (!within || then.dt > 0) &&
             is_within(then.step, 0, INT64_C(1) << 53) && is_within(then.iteration, 0, 1 << 30) &&
             is_within(phase, SPARI_IDLE, SPARI_CHECKED) && is_within(then.order, 0, 2) &&
             is_within(then.past, within && then.step == 0 ? -1 : 0, then.predictor) &&
             then.started == (within || then.step > 0);
    for (int k = 0; k < 2; k++) { /* what a prediction divides by */
        int used = then.past > k || (within && then.order > k);
        ok = ok && isfinite(then.dt_last[k]) && then.dt_last[k] >= 0 && (!used || then.dt_last[k] > 0);
    }
    l->phase = phase;
    return ok ? SPAR_OK : broken(s);
}

/* What of the coupling fits the settings in force, in memory of its own. */
static int check_coupling(spar_session *s, reading *l) {
    int64_t count = spari_image_get_int(&l->image), end;
    if (count == 0 && !l->image.failed) {
        return SPAR_OK;
    }
    if (!find_end(&l->image, count, &end)) {
        return broken(s);
    }
    double settings[SPARI_MOST_OF_COUPLING];
    int own = spari_settings_of_coupling(s, settings);
    const uint64_t *saved = spari_image_get(&l->image, own);
    if (saved && memcmp(saved, settings, (size_t)own * sizeof *settings) == 0) {
        SPARI_TRY(spari_coupling_create(s, s->scheme, 0, &l->coupling));
        passage t = {&l->image, READ};
        pass_coupling(&t, l->coupling);
        if (l->coupling->accelerator) {
            int64_t n = spari_image_get_int(&l->image);
            const double *state = (const double *)(const void *)spari_image_get(&l->image, n);
            if (!state || !spari_accelerator_load(l->coupling->accelerator, state, n)) {
                return broken(s);
            }
            pass(&t, l->coupling->predicted, l->coupling->n);
            pass(&t, l->coupling->motion, motion_words(s, l->coupling));
        }
        return l->image.failed || l->image.at != end ? broken(s) : SPAR_OK;
    }
    SPARI_REQUIRE(s, l->phase == SPARI_IDLE, SPAR_ERR_STATE,
                  "the file is from the middle of a step and the coupling is set otherwise here; make "
                  "the same settings first (they may be changed when the step is accepted)");
    l->image.at = end;
    return SPAR_OK;
}

static int check_solvers(spar_session *s, reading *l) {
    int64_t solvers = spari_image_get_int(&l->image);
    for (int64_t i = 0; i < solvers && !l->image.failed; i++) {
        int64_t k = spari_image_get_int(&l->image), n = spari_image_get_int(&l->image);
        const double *state = (const double *)(const void *)spari_image_get(&l->image, n);
        const spar_member *m = s->members;
        for (int64_t j = 0; j < k && m; j++) {
            m = m->next;
        }
        if (!m || k < 0 || !state) {
            return broken(s);
        }
        if (spari_fidelity_state_size(m) > 0) {
            if (!m->row->is_state(m, state, n)) {
                return broken(s);
            }
            l->solution[k] = state;
        }
    }
    return SPAR_OK;
}

static int check_assemblies(spar_session *s, reading *l) {
    int64_t count = spari_image_get_int(&l->image);
    for (int64_t i = 0; i < count && !l->image.failed; i++) {
        int64_t k = spari_image_get_int(&l->image), n = spari_image_get_int(&l->image);
        const double *state = (const double *)(const void *)spari_image_get(&l->image, n);
        const spari_assembly *a = s->assemblies;
        for (int64_t j = 0; j < k && a; j++) {
            a = spari_assembly_next(a);
        }
        if (!a || k < 0 || !state) {
            return broken(s);
        }
        if (spari_assembly_state_size(a) > 0) {
            if (!spari_assembly_is_state(a, state, n)) {
                return broken(s);
            }
            l->tied[k] = state;
        }
    }
    return SPAR_OK;
}

static int compare_fluids(spar_session *s, reading *l, int rank) {
    int64_t fluids = spari_image_get_int(&l->image);
    for (int64_t i = 0; i < fluids && !l->image.failed; i++) {
        record *more = realloc(l->records, (size_t)(l->record_count + 1) * sizeof *more);
        if (!more) {
            return no_memory_for_state(s);
        }
        l->records = more;
        record *r = more + l->record_count++;
        r->rank = rank;
        r->member = (int)spari_image_get_int(&l->image);
        r->name = l->image.at;
        (void)spari_image_is_text(&l->image, "");
        r->count = spari_image_get_int(&l->image);
        r->state = (const double *)(const void *)spari_image_get(&l->image, r->count);
    }
    return l->image.failed ? broken(s) : SPAR_OK;
}

static int check_own(spar_session *s, reading *l) {
    l->solution = spari_zalloc(s->member_count, sizeof *l->solution);
    l->tied = spari_zalloc(s->joint_count, sizeof *l->tied);
    if (!l->solution || !l->tied) {
        return no_memory_for_state(s);
    }
    for (int rank = 0; rank < l->ranks; rank++) {
        int64_t count = spari_image_get_int(&l->image), end;
        if (!find_end(&l->image, count, &end)) {
            return broken(s);
        }
        SPARI_TRY(check_solvers(s, l));
        SPARI_TRY(check_assemblies(s, l));
        SPARI_TRY(compare_fluids(s, l, rank));
        if (l->image.at != end) {
            return broken(s);
        }
    }
    int k = 0;
    for (const spar_member *m = s->members; m; m = m->next, k++) {
        if (spari_fidelity_state_size(m) > 0 && !l->solution[k]) {
            return broken(s);
        }
    }
    return l->image.at == l->image.count ? SPAR_OK : broken(s);
}

static int check_image(spar_session *s, reading *l) {
    passage t = {&l->image, CHECK};
    SPARI_TRY(compare_scene(s, l));
    l->common = l->image.at;
    SPARI_TRY(check_clock(s, l));
    for (spar_member *m = s->members; m; m = m->next) {
        pass_member(&t, m);
        if (l->image.no_memory) {
            return no_memory_for_state(s);
        }
    }
    for (spar_joint *j = s->joints; j; j = j->next) {
        pass_joint(&t, j);
    }
    if (l->image.failed) {
        return broken(s);
    }
    SPARI_TRY(check_coupling(s, l));
    return check_own(s, l);
}

static int is_record_of(reading *l, const record *r, const spar_session *s, const spar_fluid *f) {
    l->image.at = r->name;
    return r->member == member_index(s, spari_fluid_member(f)) &&
           spari_image_is_text(&l->image, spar_fluid_get_name(f));
}

/* Whether the fluids here are those of this rank in the file, one by one. */
static int same_fluids(const spar_session *s, reading *l) {
    int rank = spari_comm_rank(s->comm);
    const spar_fluid *f = s->fluids;
    for (int64_t i = 0; i < l->record_count; i++) {
        if (l->records[i].rank == rank) {
            if (!f || !is_record_of(l, l->records + i, s, f)) {
                return 0;
            }
            f = spari_fluid_next(f);
        }
    }
    return !f && l->ranks == spari_comm_size(s->comm);
}

/* Which ranks have a fluid like each record's: what is a sum goes to the first of them. [records][ranks], and one more.
 */
static int find_takers(spar_session *s, reading *l, double **takers) {
    int ranks = spari_comm_size(s->comm), rank = spari_comm_rank(s->comm);
    *takers = spari_zalloc(l->record_count * ranks + 1, sizeof **takers);
    SPARI_TRY(agree(s, *takers ? SPAR_OK : no_memory_for_state(s)));
    for (int64_t i = 0; i < l->record_count; i++) {
        for (const spar_fluid *f = s->fluids; f; f = spari_fluid_next(f)) {
            if (is_record_of(l, l->records + i, s, f)) {
                (*takers)[i * ranks + rank] = 1;
            }
        }
    }
    SPARI_TRY(spari_comm_sum(s->comm, *takers, l->record_count * ranks, SPAR_OK, s->message, sizeof s->message));
    for (int64_t i = 0; i < l->record_count; i++) {
        int taker = 0;
        while (taker < ranks && (*takers)[i * ranks + taker] == 0) {
            taker++;
        }
        SPARI_REQUIRE(s, taker < ranks, SPAR_ERR_ARGUMENT,
                      "fluid %lld of the file has none of its name and member here; create the fluids "
                      "of the saved run first",
                      (long long)i);
        (*takers)[i * ranks] = taker; /* of all the row is for, the first entry is left */
    }
    return SPAR_OK;
}

/* The records that make up each fluid here. exact: this rank's, in their order. */
static int assign_records(spar_session *s, reading *l, int exact, const double *takers) {
    int ranks = spari_comm_size(s->comm), rank = spari_comm_rank(s->comm);
    int64_t k = 0, own = 0, at = 0;
    for (spar_fluid *f = s->fluids; f; f = spari_fluid_next(f)) {
        l->fluid_count++;
    }
    l->states = spari_zalloc(l->record_count * (exact ? 1 : l->fluid_count), sizeof *l->states);
    l->state_count = spari_zalloc(l->fluid_count, sizeof *l->state_count);
    l->takes_loads = spari_zalloc(l->fluid_count, sizeof *l->takes_loads);
    if (!l->states || !l->state_count || !l->takes_loads) {
        return no_memory_for_state(s);
    }
    for (spar_fluid *f = s->fluids; f; f = spari_fluid_next(f), k++) {
        l->takes_loads[k] = exact;
        for (int64_t i = 0; i < l->record_count; i++) {
            const record *r = l->records + i;
            int mine = exact ? r->rank == rank && i >= own : is_record_of(l, r, s, f);
            if (!mine || (exact && l->state_count[k] > 0)) {
                continue;
            }
            if (!spari_fluid_is_state(f, r->state, r->count)) {
                return broken(s);
            }
            l->states[at + l->state_count[k]++] = r->state;
            l->takes_loads[k] |= !exact && takers[i * ranks] == rank;
            own = exact ? i + 1 : own;
        }
        SPARI_REQUIRE(s, l->state_count[k] > 0, SPAR_ERR_ARGUMENT, "fluid '%s' of member '%s' is not in the file",
                      spar_fluid_get_name(f), spari_fluid_member(f)->name);
        SPARI_TRY(spari_fluid_ready(f, l->call, l->state_count[k], l->states + at));
        at += l->state_count[k];
    }
    return SPAR_OK;
}

static int check_all_fluids(spar_session *s, reading *l) {
    double other[2] = {!same_fluids(s, l), 0}, *takers = NULL;
    SPARI_TRY(spari_comm_sum(s->comm, other, 1, SPAR_OK, s->message, sizeof s->message));
    int exact = other[0] == 0;
    int status = exact ? SPAR_OK : find_takers(s, l, &takers);
    if (status == SPAR_OK) {
        status = agree(s, assign_records(s, l, exact, takers));
    }
    free(takers);
    return status;
}

/* ---- load: second pass ---- */

static void put_in_force(spar_session *s, reading *l) {
    passage t = {&l->image, READ};
    int64_t at = 0, k = 0;
    spari_spread_end(s);
    l->image.at = l->common;
    pass_clock(&t, s);
    for (spar_member *m = s->members; m; m = m->next, k++) {
        pass_member(&t, m);
        if (spari_fidelity_state_size(m) > 0) {
            m->row->load(m, l->solution[k]);
        }
    }
    for (spar_joint *j = s->joints; j; j = j->next) {
        pass_joint(&t, j);
    }
    k = 0;
    for (spari_assembly *a = s->assemblies; a; a = spari_assembly_next(a), k++) {
        spari_assembly_load(a, l->tied[k]);
    }
    k = 0;
    for (spar_fluid *f = s->fluids; f; f = spari_fluid_next(f), k++) {
        spari_fluid_load(f, l->state_count[k], l->states + at, l->takes_loads[k]);
        at += l->state_count[k];
    }
    s->coupling_stale = !l->coupling;
    if (l->coupling) {
        spari_coupling_free(&s->own->coupling);
        s->own->coupling = l->coupling;
        l->coupling = NULL;
    }
}

/* Rank 0 reads, all get the words. */
static int fetch(spar_session *s, reading *l, const char *path) {
    char why[SPARI_MESSAGE_SIZE / 2] = "";
    int root = spari_comm_rank(s->comm) == 0, status = SPAR_OK;
    if (root) {
        status = spari_image_read(&l->image, path, why, sizeof why);
        if (status != SPAR_OK) {
            (void)spari_fail(s, status, "%s", why);
        }
    }
    SPARI_TRY(agree(s, status));
    SPARI_TRY(spari_comm_broadcast(s->comm, &l->image.count, sizeof l->image.count, s->message, sizeof s->message));
    if (!root) {
        l->image.word = spari_zalloc(l->image.count, sizeof *l->image.word);
    }
    SPARI_TRY(agree(s, l->image.word ? SPAR_OK : no_memory_for_state(s)));
    return spari_comm_broadcast(s->comm, l->image.word, 8 * l->image.count, s->message, sizeof s->message);
}

int spar_session_load(spar_session *session, const char *path) {
    SPARI_QUIET;
    SPARI_REQUIRE(NULL, session, SPAR_ERR_ARGUMENT, "%s: the session is NULL; create it first", __func__);
    spar_session *s = session;
    reading l = {.call = __func__};
    int status = check_call(s, __func__, path);
    if (status == SPAR_OK && s->phase != SPARI_IDLE) {
        status = spari_fail(s, SPAR_ERR_STATE, "%s: a step is under way; accept or reject it first", __func__);
    }
    SPARI_TRY(spari_enter_alike(s, __func__, NULL, 0, status));
    status = spari_solvers_place(s, __func__);
    status = status == SPAR_OK ? fetch(s, &l, path) : status;
    if (status == SPAR_OK) {
        status = agree(s, check_image(s, &l));
    }
    if (status == SPAR_OK) {
        status = check_all_fluids(s, &l);
    }
    if (status == SPAR_OK) {
        status = spari_session_seal(s, SPAR_OK);
    }
    if (status == SPAR_OK) {
        put_in_force(s, &l);
    }
    end_loading(&l);
    return spari_named(s, __func__, status);
}
