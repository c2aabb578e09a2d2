/* Saves the whole session in one file (base/saved_file.h): data common to all ranks (common_state.h); then the data of
   each rank, preceded by their number of words: solvers of its members and assemblies, its fluids. No rank holds more
   than its own data: rank 0 receives the others' piece by piece and writes them. */
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

/* ---- data of one rank ---- */

/* Makes room for the n numbers of a state, preceded by their count. */
static double *put_reserved(spari_image *image, int64_t n) {
    spari_image_put_int(image, n);
    return (double *)(void *)spari_image_add(image, n);
}

/* States of the assemblies solved here, with their positions in the list, which agrees across ranks. */
static void put_assemblies(spari_image *image, const spar_session *s) {
    int64_t count = 0, k = 0;
    for (const spari_assembly *a = s->assemblies; a; a = spari_assembly_next(a)) {
        count += spari_assembly_state_size(a) > 0;
    }
    spari_image_put_int(image, count);
    for (const spari_assembly *a = s->assemblies; a; a = spari_assembly_next(a), k++) {
        int64_t n = spari_assembly_state_size(a);
        if (n > 0) {
            spari_image_put_int(image, k);
            double *state = put_reserved(image, n);
            if (state) {
                spari_assembly_save(a, state);
            }
        }
    }
}

static int put_own(spari_image *image, const spar_session *s, const char *call) {
    int64_t solvers = 0, fluids = 0;
    int k = 0;
    spari_image_put_int(image, 0); /* number of words that follow */
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
            spari_image_put_int(image, k);
            double *state = put_reserved(image, n);
            if (state) {
                m->row->save(m, state);
            }
        }
    }
    put_assemblies(image, s);
    spari_image_put_int(image, fluids);
    for (const spar_fluid *f = s->fluids; f; f = spari_fluid_next(f)) {
        spari_image_put_int(image, spari_fluid_member(f)->number);
        spari_image_put_text(image, spar_fluid_get_name(f));
        double *state = put_reserved(image, spari_fluid_state_size(f));
        if (state) {
            SPARI_TRY(spari_fluid_save(f, call, state));
        }
    }
    if (!image->failed) {
        image->word[0] = (uint64_t)(image->count - 1);
    }
    return SPAR_OK;
}

/* ---- the file ---- */

enum { PIECE = 1 << 13 }; /* words sent to rank 0 at once */

typedef struct save_plan {
    double *part;       /* [ranks][PART_WORDS] number of words of each rank */
    spari_image common; /* on rank 0 */
    int64_t count;      /* words of the file, on rank 0 */
    spari_saving file;  /* on rank 0 */
    char why[SPARI_MESSAGE_SIZE / 2];
    uint64_t piece[PIECE]; /* too large for a small stack */
} save_plan;
enum { PART_COUNT, PART_STATUS, PART_WORDS };

static int64_t part_count(const save_plan *p, int rank) {
    return (int64_t)p->part[rank * PART_WORDS + PART_COUNT];
}

static int share_counts(spar_session *s, save_plan *p, const spari_image *own) {
    int ranks = spari_comm_size(s->ranks.comm);
    int64_t *first = spari_zalloc(ranks + 1, sizeof *first);
    p->part = spari_zalloc((int64_t)PART_WORDS * ranks, sizeof *p->part);
    int status = spari_agree(s, first && p->part ? SPAR_OK : spari_saved_no_memory(s));
    if (first && p->part && status == SPAR_OK) {
        p->part[spari_comm_rank(s->ranks.comm) * PART_WORDS + PART_COUNT] = (double)own->count;
        for (int r = 0; r < ranks; r++) {
            first[r + 1] = first[r] + PART_WORDS;
        }
        status = spari_comm_share(s->ranks.comm, p->part, first, SPAR_OK, s->message, sizeof s->message);
    }
    free(first);
    return status;
}

/* Writes the common data and rank 0's own. */
static int begin_file(spar_session *s, save_plan *p, const spari_image *own, const char *path) {
    spari_saved_put(&p->common, s);
    if (p->common.failed) {
        return spari_saved_no_memory(s);
    }
    p->count = p->common.count;
    for (int r = 0; r < spari_comm_size(s->ranks.comm); r++) {
        p->count += part_count(p, r);
    }
    int status = spari_saving_begin(&p->file, path, p->count, p->why, sizeof p->why);
    if (status != SPAR_OK) {
        return spari_fail(s, status, "%s", p->why);
    }
    spari_saving_put(&p->file, p->common.word, p->common.count);
    spari_saving_put(&p->file, own->word, own->count);
    return SPAR_OK;
}

/* Rank 0 receives also what it cannot write, and reports the failure at the end. */
static int send_parts(spar_session *s, save_plan *p, const spari_image *own) {
    int rank = spari_comm_rank(s->ranks.comm);
    for (int r = 1; r < spari_comm_size(s->ranks.comm); r++) {
        for (int64_t at = 0; at < part_count(p, r) && (rank == 0 || rank == r); at += PIECE) {
            int64_t n = part_count(p, r) - at < PIECE ? part_count(p, r) - at : PIECE;
            SPARI_TRY(spari_comm_move(s->ranks.comm, r, 0, rank == r ? own->word + at : p->piece, 8 * n, s->message,
                                      sizeof s->message));
            if (rank == 0) {
                spari_saving_put(&p->file, p->piece, n);
            }
        }
    }
    return SPAR_OK;
}

/* Rank 0 moves the file to its final path, or removes it. */
static int end_file(spar_session *s, save_plan *p, int status) {
    if (status != SPAR_OK) {
        spari_file_drop(&p->file.file);
        return status;
    }
    status = spari_saving_end(&p->file, p->why, sizeof p->why);
    return status == SPAR_OK ? SPAR_OK : spari_fail(s, status, "%s", p->why);
}

static int write_file(spar_session *s, const spari_image *own, const char *path) {
    save_plan *p = spari_zalloc(1, sizeof *p);
    int root = spari_comm_rank(s->ranks.comm) == 0;
    int status = spari_agree(s, p ? SPAR_OK : spari_saved_no_memory(s));
    status = p && status == SPAR_OK ? share_counts(s, p, own) : status;
    if (p && status == SPAR_OK) {
        status = spari_agree(s, root ? begin_file(s, p, own, path) : SPAR_OK);
        status = status == SPAR_OK ? send_parts(s, p, own) : status;
        status = p->file.file.stream ? end_file(s, p, status) : status;
        status = spari_agree(s, status);
    }
    if (p) {
        spari_image_free(&p->common);
        free(p->part);
    }
    free(p);
    return status;
}

int spar_session_save(const spar_session *session, const char *path) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_REQUIRE(NULL, session, SPAR_ERR_ARGUMENT, "%s: the session is NULL; create it first", __func__);
    spar_session *s = (spar_session *)(uintptr_t)session; /* writes its message; the state is not changed */
    spari_image own = {0};
    int status = spari_saved_check_call(s, __func__, path);
    status = status == SPAR_OK ? spari_session_pushes(s, __func__) : status;
    SPARI_TRY(spari_enter_agreed(s, __func__, NULL, 0, status));
    if (s->joints_stale) { /* the assemblies are those of the joints as they were */
        spari_assemblies_free(s);
    }
    status = put_own(&own, s, __func__);
    status = spari_agree(s, status == SPAR_OK && own.failed ? spari_saved_no_memory(s) : status);
    status = status == SPAR_OK ? write_file(s, &own, path) : status;
    spari_image_free(&own);
    return spari_named(s, __func__, status);
}
