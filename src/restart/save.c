/* Saves the whole session in one file (base/saved_file.h): data common to all ranks (common_state.h), preceded by their
   number of words; the directories of all ranks, which count as common data; then the states that these name, rank by
   rank: of members and assemblies solved there, and of fluids. No rank holds more than its own states: rank 0 receives
   the others' piece by piece and writes them. */
#include "../assembly/assembly.h"
#include "../base/environment.h"
#include "../base/saved_file.h"
#include "../comm/enter.h"
#include "../exchange/rank_loads_and_motion.h"
#include "../fluid/fluid.h"
#include "../time/fidelity.h"
#include "common_state.h"

#include <stdlib.h>
#include <string.h>

/* Data of one rank: the directory names its states, in their order. */
enum { DIRECTORY, STATES, PARTS };

/* Names the next state, of n numbers, and makes room for it. NULL: it is not here, or no memory. */
static double *put_state(spari_image own[PARTS], int kind, int64_t number, int64_t n) {
    if (n <= 0) {
        return NULL;
    }
    spari_image_put_int(own + DIRECTORY, kind);
    spari_image_put_int(own + DIRECTORY, number);
    spari_image_put_int(own + DIRECTORY, n);
    return (double *)(void *)spari_image_add(own + STATES, n);
}

static int put_own(spari_image own[PARTS], const spar_session *s, const char *call) {
    int64_t k = 0;
    for (const spar_member *m = s->members; m; m = m->next) {
        double *state = put_state(own, SPARI_SAVED_MEMBER, m->number, spari_fidelity_state_size(m));
        if (state) {
            m->row->save(m, state);
        }
    }
    for (const spari_assembly *a = s->assemblies; a; a = spari_assembly_next(a)) {
        double *state = put_state(own, SPARI_SAVED_ASSEMBLY, k++, spari_assembly_state_size(a));
        if (state) {
            spari_assembly_save(a, state);
        }
    }
    for (const spar_fluid *f = s->fluids; f; f = spari_fluid_next(f)) {
        double *state = put_state(own, SPARI_SAVED_FLUID, spari_fluid_member(f)->number, spari_fluid_state_size(f));
        if (state) {
            SPARI_TRY(spari_fluid_save(f, call, state));
            spari_image_put_text(own + DIRECTORY, spar_fluid_get_name(f));
            spari_image_put(own + DIRECTORY, state, SPARI_FLUID_HEAD);
        }
    }
    spari_image_put_int(own + DIRECTORY, SPARI_SAVED_END);
    return SPAR_OK;
}

/* ---- the file ---- */

enum { PIECE = 1 << 13 }; /* words sent to rank 0 at once */

typedef struct save_plan {
    double *count;      /* [ranks][PARTS] number of words of each rank */
    spari_image common; /* on rank 0 */
    spari_saving file;  /* on rank 0 */
    char why[SPARI_MESSAGE_SIZE / 2];
    uint64_t piece[PIECE]; /* too large for a small stack */
} save_plan;

static int share_counts(spar_session *s, save_plan *p, const spari_image own[PARTS]) {
    int ranks = spari_comm_size(s->ranks.comm), rank = spari_comm_rank(s->ranks.comm);
    p->count = spari_zalloc((int64_t)PARTS * ranks + 1, sizeof *p->count);
    SPARI_TRY(spari_agree(s, p->count ? SPAR_OK : spari_saved_no_memory(s)));
    p->count[PARTS * rank + DIRECTORY] = (double)own[DIRECTORY].count;
    p->count[PARTS * rank + STATES] = (double)own[STATES].count;
    return spari_sum(s, p->count, (int64_t)PARTS * ranks);
}

/* A part of the other ranks' data: rank 0 appends the directories to its own, and writes the states. It receives also
   what it cannot write, and reports the failure at the end. */
static int collect(spar_session *s, save_plan *p, const spari_image own[PARTS], int part) {
    int rank = spari_comm_rank(s->ranks.comm);
    for (int r = 1; r < spari_comm_size(s->ranks.comm); r++) {
        int64_t count = (int64_t)p->count[PARTS * r + part];
        for (int64_t at = 0; at < count && (rank == 0 || rank == r); at += PIECE) {
            int64_t n = count - at < PIECE ? count - at : PIECE;
            SPARI_TRY(spari_comm_move(s->ranks.comm, r, 0, rank == r ? own[part].word + at : p->piece, 8 * n,
                                      s->message, sizeof s->message));
            if (rank == 0 && part == DIRECTORY) {
                spari_image_put(&p->common, p->piece, n);
            } else if (rank == 0) {
                spari_saving_put(&p->file, p->piece, n);
            }
        }
    }
    return SPAR_OK;
}

/* Writes the common data, preceded by their number of words, and rank 0's own. */
static int begin_file(spar_session *s, save_plan *p, const spari_image own[PARTS], const char *path) {
    if (p->common.failed) {
        return spari_saved_no_memory(s);
    }
    int64_t count = p->common.count;
    for (int r = 0; r < spari_comm_size(s->ranks.comm); r++) {
        count += (int64_t)p->count[PARTS * r + STATES];
    }
    int status = spari_saving_begin(&p->file, path, count, p->why, sizeof p->why);
    if (status != SPAR_OK) {
        return spari_fail(s, status, "%s", p->why);
    }
    p->common.word[0] = (uint64_t)(p->common.count - 1);
    spari_saving_put(&p->file, p->common.word, p->common.count);
    spari_saving_put(&p->file, own[STATES].word, own[STATES].count);
    return SPAR_OK;
}

static int write_file(spar_session *s, const spari_image own[PARTS], const char *path) {
    save_plan *p = spari_zalloc(1, sizeof *p);
    int root = spari_comm_rank(s->ranks.comm) == 0;
    int status = spari_agree(s, p ? SPAR_OK : spari_saved_no_memory(s));
    status = p && status == SPAR_OK ? share_counts(s, p, own) : status;
    if (p && status == SPAR_OK) {
        if (root) {
            spari_image_put_int(&p->common, 0);
            spari_saved_put(&p->common, s);
            spari_image_put(&p->common, own[DIRECTORY].word, own[DIRECTORY].count);
        }
        status = collect(s, p, own, DIRECTORY);
        status = status == SPAR_OK ? spari_agree(s, root ? begin_file(s, p, own, path) : SPAR_OK) : status;
        status = status == SPAR_OK ? collect(s, p, own, STATES) : status;
        if (p->file.file.stream && status == SPAR_OK) { /* to its final path, or nowhere */
            status = spari_saving_end(&p->file, p->why, sizeof p->why);
            status = status == SPAR_OK ? SPAR_OK : spari_fail(s, status, "%s", p->why);
        } else if (p->file.file.stream) {
            spari_file_drop(&p->file.file);
        }
        status = spari_agree(s, status);
    }
    if (p) {
        spari_image_free(&p->common);
        free(p->count);
    }
    free(p);
    return status;
}

int spar_session_save(const spar_session *session, const char *path) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_REQUIRE(NULL, session, SPAR_ERR_ARGUMENT, "%s: the session is NULL; create it first", __func__);
    spar_session *s = (spar_session *)(uintptr_t)session; /* writes its message; the state is not changed */
    spari_image own[PARTS] = {{0}};
    int status = spari_saved_check_call(s, __func__, path);
    status = status == SPAR_OK ? spari_session_pushes(s, __func__) : status;
    SPARI_TRY(spari_enter_agreed(s, __func__, NULL, 0, status));
    if (s->joints_stale) { /* the assemblies are those of the joints as they were */
        spari_assemblies_free(s);
    }
    status = put_own(own, s, __func__);
    int failed = own[DIRECTORY].failed || own[STATES].failed;
    status = spari_agree(s, status == SPAR_OK && failed ? spari_saved_no_memory(s) : status);
    status = status == SPAR_OK ? write_file(s, own, path) : status;
    spari_image_free(own + DIRECTORY);
    spari_image_free(own + STATES);
    return spari_named(s, __func__, status);
}
