/* Small-motion equations: see small_motions.h. A state at rest, or in steady rotation as one body, is described in a
   frame that rotates with it, where the coefficients are constant. Parts that rotate otherwise than the rest (a rotor
   on its tower) are allowed if they are isotropic about their axis: then nothing depends on their angle. */
#include "small_motions.h"
#include "small_motions_joints.h"

#include "../base/session.h"
#include "../math/rotation.h"
#include "../member/body.h"
#include "../member/plane.h"
#include "../time/fidelity.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* Angular velocities with a smaller relative difference are equal. */
static const double one_turn = 1e-4;
/* equilibrium: maximum force residual of an equilibrium state, relative to the largest forces. equilibrium_noise:
   the same relative to the largest stiffness, above the rounding of positions. */
static const double equilibrium = 1e-3, equilibrium_noise = 1e-9;

void spari_small_motions_free(spari_small_motions *w) {
    SPARI_FREE(w->part, w->workspace);
    spari_pencil_free(&w->pencil);
}

int spari_need_mass(const spar_member *m) {
    SPARI_REQUIRE(m->session, m->body && m->body->mass && (m->effects & SPAR_EFFECT_INERTIA), SPAR_ERR_UNSUPPORTED,
                  "'%s' has no mass in spar; give its sections mass", m->name);
    return SPAR_OK;
}

/* ---- connected members ---- */

static int add_motion_part(spari_small_motions *w, const spar_member *m) {
    SPARI_TRY(spari_need_mass(m));
    spari_motion_part *p = w->part + w->parts++;
    *p = (spari_motion_part){.member = m, .size = (int)m->row->unknowns(m)};
    memcpy(p->own, m->after.v + 3, sizeof p->own);
    return SPAR_OK;
}

/* A member and the number of one that it is connected to; the root of a tree has its own. */
typedef struct motion_tree {
    const spar_member *member;
    int to;
} motion_tree;

/* [count], by address */
typedef struct motion_trees {
    int count;
    motion_tree *of;
} motion_trees;

static int by_address(const void *a, const void *b) {
    uintptr_t x = (uintptr_t)((const motion_tree *)a)->member, y = (uintptr_t)((const motion_tree *)b)->member;
    return (x > y) - (x < y);
}

static int tree_of(motion_trees *t, const spar_member *m) {
    const motion_tree key = {m, 0}, *at = bsearch(&key, t->of, (size_t)t->count, sizeof *t->of, by_address);
    int i = (int)(at - t->of);
    while (t->of[i].to != i) {
        i = t->of[i].to = t->of[t->of[i].to].to;
    }
    return i;
}

/* Connects the members that joints connect and whose motion is unknown. The trees are freed by the caller in any case.
 */
static int grow_trees(motion_trees *t, const spar_session *s) {
    t->of = spari_zalloc(s->member_count, sizeof *t->of);
    if (!t->of) {
        return SPAR_ERR_MEMORY;
    }
    for (const spar_member *m = s->members; m; m = m->next) {
        t->of[t->count++].member = m;
    }
    qsort(t->of, (size_t)t->count, sizeof *t->of, by_address);
    for (int i = 0; i < t->count; i++) {
        t->of[i].to = i;
    }
    for (const spar_joint *j = s->joints; j; j = j->next) {
        const spar_member *a = j->member[0], *b = j->member[1];
        if (a && b && a->row && b->row && a->row->component && b->row->component) {
            t->of[tree_of(t, a)].to = tree_of(t, b);
        }
    }
    return SPAR_OK;
}

/* Adds the parts, in the order of creation. */
static int add_connected(spari_small_motions *w, const spar_member *first, motion_trees *t) {
    int root = first ? tree_of(t, first) : -1;
    for (const spar_member *m = w->session->members; m; m = m->next) {
        int wanted = first ? tree_of(t, m) == root : m->committed && m->row->solved && m->row->linearise;
        if (wanted) {
            SPARI_TRY(add_motion_part(w, m));
        }
    }
    return SPAR_OK;
}

/* connected 0: the first member alone */
static int gather_motions(spari_small_motions *w, const spar_member *first, int connected) {
    spar_session *s = w->session;
    motion_trees t = {0};
    w->part = spari_zalloc(s->member_count, sizeof *w->part);
    int status = w->part && grow_trees(&t, s) == SPAR_OK ? SPAR_OK : SPAR_ERR_MEMORY;
    if (status == SPAR_OK) {
        status = connected ? add_connected(w, first, &t) : add_motion_part(w, first);
    } else {
        status = spari_fail(s, status, "no memory for eigenvalues");
    }
    free(t.of);
    SPARI_TRY(status);
    SPARI_REQUIRE(s, w->parts > 0, SPAR_ERR_UNSUPPORTED,
                  "the session has no member that spar solves; add one that is neither a point nor external");
    int64_t most = 0;
    for (int i = 0; i < w->parts; i++) {
        const spar_member *m = w->part[i].member;
        int64_t workspace = 2 * (int64_t)w->part[i].size + 6 * m->body->unique + 12 * m->nodes;
        w->part[i].at = w->size;
        w->size += w->part[i].size;
        most = workspace > most ? workspace : most;
    }
    w->workspace = spari_zalloc(most, sizeof *w->workspace);
    SPARI_REQUIRE(s, w->workspace, SPAR_ERR_MEMORY, "no memory for eigenvalues");
    return SPAR_OK;
}

/* ---- frame of reference ---- */

/* x := derivative of vectors that rotate with s */
static void rotate_vectors(int n, const double s[3], const double *x, double *y) {
    for (int i = 0; i < n; i += 3) {
        spari_cross(s, x + i, y + i);
    }
}

/* A part that rotates with s relative to the frame must be isotropic about this axis: its matrices X satisfy X T = T
   X, T the rotation of all vectors with s. Tested with one vector without symmetry. */
static int check_same(const spari_small_motions *w, const spari_motion_part *p, int64_t first) {
    double s[3] = {p->own[0] - w->w[0], p->own[1] - w->w[1], p->own[2] - w->w[2]};
    if (spari_norm(s) <= one_turn * fmax(spari_norm(p->own), spari_norm(w->w))) {
        return SPAR_OK;
    }
    double *x = spari_zalloc(5 * (int64_t)w->size, sizeof *x), *rotated = x + w->size, *y = rotated + w->size,
           *z = y + w->size, *last = z + w->size;
    SPARI_REQUIRE(w->session, x, SPAR_ERR_MEMORY, "no memory for eigenvalues");
    int same = p->size % 3 == 0, kinds = p->member->body->C ? 3 : 2; /* weight alone may have a direction */
    for (int i = 0; i < p->size; i++) {
        x[p->at + i] = sin(1 + 12.9898 * i);
    }
    for (int kind = 0; kind < kinds && same; kind++) {
        double change = 0, size = 0;
        memset(y, 0, 3 * (size_t)w->size * sizeof *y);
        rotate_vectors(p->size, s, x + p->at, rotated + p->at);
        spari_pencil_times(&w->pencil, first, kind == 2, kind == 1, kind == 0, rotated, y);
        spari_pencil_times(&w->pencil, first, kind == 2, kind == 1, kind == 0, x, z);
        rotate_vectors(p->size, s, z + p->at, last + p->at);
        for (int i = p->at; i < p->at + p->size; i++) {
            change = fmax(change, fabs(y[i] - last[i]));
            size = fmax(size, fabs(z[i]));
        }
        same = change <= 1e-6 * spari_norm(s) * size;
    }
    free(x);
    SPARI_REQUIRE(
        w->session, same, SPAR_ERR_UNSUPPORTED,
        "'%s' rotates relative to the parts it is connected to, and is not isotropic about its axis: the small-motion "
        "equations depend on time and have no eigenvalues; for a periodic state use spar_trial_solve_floquet",
        p->member->name);
    return SPAR_OK;
}

/* joints: those to add; NULL: none. */
static int fill_motions(spari_small_motions *w, const spar_joint *joints) {
    spar_session *s = w->session;
    int constraints = 0;
    spari_pencil_free(&w->pencil);
    SPARI_REQUIRE(s, spari_pencil_create(&w->pencil, w->size) == SPAR_OK, SPAR_ERR_MEMORY, "no memory for eigenvalues");
    w->pencil.cap = w->cap;
    for (int i = 0; i < w->parts; i++) {
        const spari_motion_part *p = w->part + i;
        int64_t first = w->pencil.entries;
        w->pencil.base = p->at;
        const spari_fidelity *row = p->member->row;
        int status = w->modes ? row->problem(p->member, &w->pencil)
                              : row->linearise(p->member, w->loose ? p->own : w->w, &w->pencil);
        SPARI_REQUIRE(s, status != SPAR_ERR_UNSUPPORTED, status,
                      "'%s' is linear in the frame of its root, which rotates relative to the parts it is connected "
                      "to; use SPAR_FIDELITY_EXACT",
                      p->member->name);
        SPARI_REQUIRE(s, status == SPAR_OK, status, "'%s': no memory for eigenvalues", p->member->name);
        SPARI_TRY(w->loose || w->modes ? SPAR_OK : check_same(w, p, first));
    }
    for (const spar_joint *j = joints; j; j = j->next) {
        SPARI_TRY(spari_small_motions_add_joint(w, j, &constraints));
    }
    w->pencil.constraints = constraints;
    SPARI_REQUIRE(s, !w->pencil.full, SPAR_ERR_MEMORY, "no memory for eigenvalues");
    return SPAR_OK;
}

/* The rotating frame if all rotate as one; otherwise, or if the ground is not isotropic about this axis, the
   inertial frame. */
static int find_frame(spari_small_motions *w) {
    int same = 1;
    for (int i = 1; i < w->parts; i++) {
        const double *a = w->part[0].own, *b = w->part[i].own, apart[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
        same = same && spari_norm(apart) <= one_turn * fmax(spari_norm(a), spari_norm(b));
    }
    if (same && w->parts > 0 && spari_norm(w->part[0].own) > 0) {
        char message[SPARI_MESSAGE_SIZE];
        memcpy(w->w, w->part[0].own, sizeof w->w);
        (void)spari_messages_redirect(message); /* a frame that does not fit is no failure */
        int status = fill_motions(w, w->session->joints);
        (void)spari_messages_redirect(NULL);
        if (status != SPAR_ERR_UNSUPPORTED) {
            SPARI_REQUIRE(w->session, status == SPAR_OK, status, "%s", message);
            return SPAR_OK;
        }
    }
    memset(w->w, 0, sizeof w->w);
    return fill_motions(w, w->session->joints);
}

/* The largest unbalanced force of a part; moments count over the member's length. Its nodes end with a rotation. */
static double largest_unbalanced(const spari_pencil *p, const spari_motion_part *part) {
    const int plane = spari_member_plane(part->member) != NULL, node = plane ? 3 : 6, rotations = plane ? 1 : 3;
    const double length = spari_member_length(part->member);
    double most = 0;
    for (int i = 0; i < part->size; i++) {
        int rotation = (part->size - 1 - i) % node < rotations;
        most = fmax(most, fabs(p->left[part->at + i]) / (rotation ? length : 1));
    }
    return most;
}

static int check_motions(const spari_small_motions *w) {
    const spari_pencil *p = &w->pencil;
    double most = 0, size = 0;
    for (int i = 0; i < w->parts; i++) {
        most = fmax(most, largest_unbalanced(p, w->part + i));
    }
    for (int64_t i = 0; i < p->entries; i++) {
        size += fabs(p->entry[i].k) + fabs(p->entry[i].c) + fabs(p->entry[i].m);
    }
    SPARI_REQUIRE(w->session, isfinite(size) && isfinite(most), SPAR_ERR_NUMERIC,
                  "'%s': stiffness in the present state is not finite; check loads, sections and their units",
                  w->part[0].member->name);
    SPARI_REQUIRE(w->session, most <= equilibrium * p->scale + equilibrium_noise * p->noise, SPAR_ERR_STATE,
                  "'%s' is not in equilibrium, at rest or in steady rotation: forces of %.3g are unbalanced, compared "
                  "with forces of %.3g; compute the static solution first",
                  w->part[0].member->name, most, p->scale);
    return SPAR_OK;
}

int spari_small_motions_create(spari_small_motions *w, spar_session *s, const spar_member *first) {
    *w = (spari_small_motions){.session = s};
    SPARI_TRY(gather_motions(w, first, 1));
    SPARI_TRY(find_frame(w));
    return check_motions(w);
}

int spari_small_motions_create_loose(spari_small_motions *w, spar_session *s) {
    *w = (spari_small_motions){.session = s, .loose = 1};
    SPARI_TRY(gather_motions(w, NULL, 1));
    return fill_motions(w, s->joints);
}

int spari_small_motions_create_modes(spari_small_motions *w, const spar_member *first, int connected) {
    *w = (spari_small_motions){.session = first->session, .modes = 1};
    SPARI_TRY(gather_motions(w, first, connected));
    w->alone = !connected;
    return fill_motions(w, connected ? w->session->joints : NULL);
}

int spari_small_motions_cap(spari_small_motions *w, double ratio) {
    w->cap = ratio;
    return fill_motions(w, w->alone ? NULL : w->session->joints);
}

void spari_small_motions_energy(const spari_small_motions *w, const double *x, double *energy, double *terms) {
    for (int64_t i = 0; i < w->pencil.entries; i++) {
        const spari_pencil_entry *e = w->pencil.entry + i;
        double part = x[e->row] * e->k * x[e->column];
        *energy += part, *terms += fabs(part);
    }
}
