/* Rebuilds a fluid for a trial, in which its member may have other nodes. The rebuilt fluid owns what the trial
   changes and shares what it only reads (the map, if the line's nodes are the same). */
#include "../math/resample.h"
#include "../math/rotation.h"
#include "state.h"

#include <stdlib.h>
#include <string.h>

static int no_memory_for_trial(const spar_fluid *fluid) {
    return spari_fluid_refuse(fluid, SPAR_ERR_MEMORY, "trial", "no memory for a trial run");
}

/* Restores the host's description of a mapped set: positions, or coordinates and offsets in the section frame. */
static int unmap(const spar_fluid *old, int which, spari_node_set *set) {
    const spari_node_set *from = &old->set[which];
    const spari_nodes *s = from->nodes;
    if (!s) {
        return SPAR_OK;
    }
    *set = (spari_node_set){.pending = 1, .sections = from->sections, .n = s->n};
    if (!from->sections) {
        set->x = spari_fluid_positions(old, s);
        return set->x ? SPAR_OK : no_memory_for_trial(old);
    }
    set->x = spari_zalloc(3 * s->n, sizeof *set->x);
    set->eta = spari_zalloc(s->n, sizeof *set->eta);
    if (!set->x || !set->eta) {
        return no_memory_for_trial(old);
    }
    for (int64_t p = 0; p < s->n; p++) {
        int64_t j = spari_nodes_node(s, p);
        double nearest[3], q[4], con[3] = {s->con[0][p], s->con[1][p], s->con[2][p]};
        spari_fluid_frame(old, from, p, nearest, q);
        spari_rotate_back(q, con, set->x + 3 * j);
        set->eta[j] = fmin(fmax(spari_member_eta(old->member, spari_nodes_element(s, p), spari_nodes_xi(s, p)), 0), 1);
    }
    return SPAR_OK;
}

/* Sections keep their positions and frames, as parts fixed to a body, because the host knows them so. The line
   through other nodes passes beside their projection points with another orientation. */
static int keep_frames(spar_fluid *f, const spar_fluid *old, int which) {
    const spari_node_set *from = &old->set[which];
    spari_node_set *to = &f->set[which];
    if (!from->sections || !from->nodes) {
        return SPAR_OK;
    }
    double *position = spari_fluid_positions(old, from->nodes);
    to->frame = spari_zalloc(4 * to->n, sizeof *to->frame);
    if (!position || !to->frame) {
        free(position);
        return no_memory_for_trial(f);
    }
    for (int64_t p = 0; p < to->n; p++) {
        double x[3];
        spari_fluid_frame(old, from, p, x, to->frame + 4 * spari_nodes_node(from->nodes, p));
    }
    for (int64_t p = 0; p < to->n; p++) {
        int64_t j = spari_nodes_node(to->nodes, p);
        double nearest[3], q[4];
        spari_fluid_reference(f, spari_nodes_element(to->nodes, p), spari_nodes_xi(to->nodes, p), nearest, q);
        for (int i = 0; i < 3; i++) {
            to->nodes->con[i][p] = position[3 * j + i] - nearest[i];
        }
    }
    free(position);
    return SPAR_OK;
}

/* Weights and reference positions belong to fluid nodes, so they are valid for the new line too. */
static int keep_weights(spar_fluid *f, const spar_fluid *old) {
    const spari_node_set *from = &old->set[SPAR_NODES_MOTION];
    spari_node_set *to = &f->set[SPAR_NODES_MOTION];
    if (!from->weight) {
        return SPAR_OK;
    }
    to->weight = spari_copy(from->weight, from->n);
    to->home = spari_copy(from->home, 3 * from->n);
    to->fade = from->fade ? spari_fade_copy(from->fade, from->n) : NULL;
    int fades = !from->fade || (to->fade && !spari_fade_map(to->fade, to->nodes));
    return to->weight && to->home && fades ? SPAR_OK : no_memory_for_trial(f);
}

static int copy_history(const spari_history *from, int order, spari_history **to) {
    *to = NULL;
    if (!from) {
        return SPAR_OK;
    }
    spari_history *h = *to = spari_history_create(from->n, order);
    if (!h) {
        return SPAR_ERR_MEMORY;
    }
    h->pushed = from->pushed, h->known = from->known, h->sections = from->sections;
    size_t size = 3 * (size_t)h->n * sizeof *h->after;
    if (size > 0) {
        memcpy(h->after, from->after, size);
        for (int k = 0; k < 3 && h->past[k] && from->past[k]; k++) {
            memcpy(h->past[k], from->past[k], size);
        }
    }
    return SPAR_OK;
}

/* The fluid as if the host had just described it. */
static int begin(spar_fluid *f, const spar_fluid *old, int same_nodes) {
    f->parts = NULL;
    f->load = f->load_new = f->load_accepted = NULL;
    memset(f->bins, 0, sizeof f->bins);
    f->history = NULL;
    f->states = NULL;
    f->taking = NULL;
    if (same_nodes) {
        int64_t n = 6 * f->member->nodes;
        f->load = spari_zalloc(n, sizeof(double));
        f->load_new = spari_zalloc(n, sizeof(double));
        f->load_accepted = spari_zalloc(n, sizeof(double));
        if (!f->load || !f->load_new || !f->load_accepted) {
            return no_memory_for_trial(f);
        }
    } else {
        f->modal = f->reference = f->field[0] = f->field[1] = NULL;
        f->set[0] = f->set[1] =
            (spari_node_set){0}; /* both, before anything can fail, so that shared parts are not freed */
        for (int which = 0; which < 2; which++) {
            SPARI_TRY(unmap(old, which, &f->set[which]));
        }
        SPARI_TRY(spari_fluid_map(f, 0, "trial"));
        for (int which = 0; which < 2; which++) {
            SPARI_TRY(keep_frames(f, old, which));
        }
        SPARI_TRY(keep_weights(f, old));
        spari_history_free(f->history); /* the map has created it with zeros */
    }
    if (old->parts && spari_parts_prepare(f) != SPAR_OK) {
        return no_memory_for_trial(f);
    }
    f->states = old->states ? spari_states_copy(old->states) : NULL;
    if (old->states && !f->states) {
        return no_memory_for_trial(f);
    }
    int order = f->member->session->coupling.predictor;
    return copy_history(old->history, order, &f->history) == SPAR_OK ? SPAR_OK : no_memory_for_trial(f);
}

/* With the same nodes, copies the sums. Sums made from the values alone would be rounded on each rank and depend on
   the distribution of nodes. */
static int copy_bins(spar_fluid *f, const spar_fluid *old) {
    static const int kinds[] = {SPARI_OF_PUSHED, SPARI_OF_ACCEPTED, SPARI_OF_BEGIN};
    if (!old->bins[SPARI_OF_PUSHED]) {
        return SPAR_OK;
    }
    if (spari_fluid_make_bins(f) != SPAR_OK) {
        return no_memory_for_trial(f);
    }
    for (int k = 0; k < 3; k++) {
        if (f->bins[kinds[k]] && old->bins[kinds[k]]) {
            memcpy(f->bins[kinds[k]], old->bins[kinds[k]], 6 * (size_t)f->member->nodes * sizeof *f->bins[0]);
        }
    }
    return SPAR_OK;
}

int spari_fluid_rebuild(spar_fluid *fluid, const spar_member *before, spar_fluid **old) {
    spar_fluid *copy = spari_zalloc(1, sizeof *copy), was;
    *old = NULL;
    if (!copy) {
        return no_memory_for_trial(fluid);
    }
    *old = copy;
    *copy = *fluid;
    fluid->asked = 0;
    fluid->why = NULL;   /* stays with the copy */
    if (!fluid->modal) { /* never mapped: has only the host's description */
        return SPAR_OK;
    }
    was = *fluid;
    spar_member as_it_was = *before;
    was.member = &as_it_was; /* the map was made on this line */
    const spari_mesh from = before->mesh, to = fluid->member->mesh;
    SPARI_TRY(begin(fluid, &was, spari_mesh_is_equal(from, to)));
    spari_resample_loads(from, to, was.load, fluid->load);
    spari_resample_loads(from, to, was.load_accepted, fluid->load_accepted);
    if (was.parts && fluid->parts) {
        fluid->parts->ended = was.parts->ended;
        spari_resample_loads(from, to, was.parts->end[0], fluid->parts->end[0]);
    }
    return spari_mesh_is_equal(from, to) ? copy_bins(fluid, &was) : SPAR_OK;
}

/* ---- reproducible sums on other nodes ---- */

enum { CARRIED = 3 }; /* load, load_accepted, end[0] of parts */

int64_t spari_fluid_moved_size(const spar_member *before) {
    return CARRIED * 6 * before->nodes;
}

void spari_fluid_add_moved(const spar_fluid *old, const spar_member *before, spari_bins *sums) {
    const double *value[CARRIED] = {old->load, old->load_accepted, old->parts ? old->parts->end[0] : NULL};
    const spari_bins *bins[CARRIED] = {old->bins[SPARI_OF_PUSHED], old->bins[SPARI_OF_ACCEPTED],
                                       old->parts ? old->bins[SPARI_OF_BEGIN] : NULL};
    int64_t n = 6 * before->nodes;
    for (int k = 0; k < CARRIED; k++) {
        for (int64_t i = 0; i < n && value[k]; i++) {
            if (bins[k]) {
                spari_bins_merge(sums + k * n + i, bins[k] + i);
            } else {
                spari_fluid_add_twice(sums + k * n + i, value[k][i]);
            }
        }
    }
}

void spari_fluid_put_moved(spar_fluid *f, const spar_member *before, const double *values) {
    double *to[CARRIED] = {f->load, f->load_accepted, f->parts ? f->parts->end[0] : NULL};
    int64_t n = 6 * before->nodes;
    for (int k = 0; k < CARRIED; k++) {
        if (to[k] && values) {
            spari_resample_loads(before->mesh, f->member->mesh, values + k * n, to[k]);
        } else if (to[k]) {
            memset(to[k], 0, 6 * (size_t)f->member->nodes * sizeof *to[k]);
        }
    }
}

void spari_fluid_mute(spar_fluid *fluid, int mute) {
    fluid->mute = mute;
}

int spari_fluid_asked(const spar_fluid *fluid) {
    return fluid->asked;
}

static void drop_copy(double *made, const double *was) {
    if (made != was) {
        free(made);
    }
}

/* Frees what f owns and the other does not share. */
static void drop_own(spar_fluid *f, const spar_fluid *old) {
    if (f->set[0].nodes != old->set[0].nodes || f->set[1].nodes != old->set[1].nodes) {
        for (int which = 0; which < 2; which++) {
            spari_node_set_clear(&f->set[which]);
        }
    }
    drop_copy(f->modal, old->modal);
    drop_copy(f->reference, old->reference);
    for (int k = 0; k < 2; k++) {
        drop_copy(f->field[k], old->field[k]);
    }
    drop_copy(f->load, old->load);
    drop_copy(f->load_new, old->load_new);
    drop_copy(f->load_accepted, old->load_accepted);
    if (f->bins[0] != old->bins[0]) {
        spari_fluid_drop_bins(f);
    }
    if (f->parts != old->parts) {
        spari_parts_free(f->parts);
    }
    if (f->history != old->history) {
        spari_history_free(f->history);
    }
    if (f->states != old->states) {
        spari_states_free(f->states);
    }
}

void spari_fluid_restore(spar_fluid *f, spar_fluid *old) {
    drop_own(f, old);
    free(f->why);
    old->gone = f->gone;
    *f = *old;
    free(old);
}

void spari_fluid_adopt(spar_fluid *f, spar_fluid *old) {
    drop_own(old, f);
    f->asked = old->asked;
    f->why = old->why;
    free(old);
}
