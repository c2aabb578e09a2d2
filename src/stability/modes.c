/* Modes about the present state, in the frame that rotates with the root: K x = omega^2 M x over the unknowns that
   the root and the joints leave free. K is the tangent in this frame (time/steady_rotation.h). Coriolis forces are left
   out, so the problem is symmetric. */
#include "modes.h"

#include "../algebra/lowest_modes.h"
#include "../assembly/assembly.h"
#include "../base/environment.h"
#include "../base/session.h"
#include "../member/check_arguments.h"
#include "../time/fidelity.h"
#include "rounding.h"

#include <math.h>
#include <stdlib.h>

static const char *subject(int connected) {
    return connected ? "the assembly of" : "member";
}

static int check_found(const spari_small_motions *w, const spar_member *m, int connected, int64_t n, int available,
                       int status) {
    spar_session *s = w->session;
    const char *who = subject(connected);
    SPARI_REQUIRE(s, status != SPAR_ERR_MEMORY, status, "no memory for the modes of %s '%s'", who, m->name);
    SPARI_REQUIRE(s, status != SPAR_ERR_ARGUMENT, status, "%s '%s': %lld modes; %s has %d", who, m->name, (long long)n,
                  connected ? "the assembly" : "it", available);
    SPARI_REQUIRE(s, status != SPAR_ERR_STATE, SPAR_ERR_NUMERIC,
                  "%s '%s': no shift makes the stiffness positive definite in the present state: a free motion has "
                  "neither mass nor stiffness; constrain it or give it mass",
                  who, m->name);
    SPARI_REQUIRE(s, status == SPAR_OK, status,
                  "%s '%s': the modes have not converged: ratios of stiffness to mass differ too much; check the "
                  "sections, or request fewer modes",
                  who, m->name);
    return SPAR_OK;
}

/* Blocks of at most 6 unknowns, from the last of each part on, so that each node has its own. */
static void find_blocks(const spari_small_motions *w, int *block) {
    int count = 0;
    for (int i = 0; i < w->parts; i++) {
        const spari_motion_part *p = w->part + i;
        for (int k = 0; k < p->size; k++) {
            count += k > 0 && (p->size - k) % 6 == 0;
            block[p->at + k] = count;
        }
        count++;
    }
}

/* The modes sought: the member, and the frequencies as the value of a pair. */
typedef struct modes_search {
    spari_small_motions *motions;
    const spar_member *member;
    int connected;
} modes_search;

static int solve_described(void *context, spari_pairs *pairs) {
    const modes_search *of = context;
    const spari_small_motions *w = of->motions;
    int available = w->size, status = SPAR_ERR_MEMORY;
    double sum = 0;
    for (int64_t i = 0; i < w->pencil.entries; i++) {
        sum += 0 * (w->pencil.entry[i].k + w->pencil.entry[i].m);
    }
    SPARI_REQUIRE(w->session, isfinite(sum), SPAR_ERR_NUMERIC,
                  "%s '%s': stiffness in the present state is not finite; check loads, sections and their units",
                  subject(of->connected), of->member->name);
    int *block = spari_zalloc(w->size, sizeof *block);
    if (block) {
        find_blocks(w, block);
        const spari_modes_problem problem = {.pencil = &w->pencil, .block = block};
        status = spari_lowest_modes(&problem, pairs->n, pairs->value, pairs->x, &available);
    }
    free(block);
    for (int k = 0; k < pairs->n && status == SPAR_OK; k++) {
        pairs->square[k] = fabs(pairs->value[k]);
    }
    return check_found(w, of->member, of->connected, pairs->n, available, status);
}

static int solve_modes(spari_small_motions *w, const spar_member *m, int connected, int64_t n, double *frequency,
                       double *shapes) {
    if (n > w->size) {
        return check_found(w, m, connected, n, w->size, SPAR_ERR_ARGUMENT);
    }
    modes_search of = {w, m, connected};
    spari_pairs p = {.n = (int)n, .width = 1, .vectors = 1, .solve = solve_described, .context = &of};
    p.square = spari_zalloc(n * (3 + (int64_t)w->size), sizeof *p.square);
    p.value = p.square + n, p.error = p.value + n, p.x = p.error + n;
    int status = p.square ? spari_pairs_solve(w, &p, 1) : check_found(w, m, connected, n, 0, SPAR_ERR_MEMORY);
    const spari_motion_part *own = spari_small_motions_part(w, m);
    for (int64_t k = 0; k < n && status == SPAR_OK; k++) {
        frequency[k] = copysign(sqrt(p.square[k]), p.value[k]) / 6.283185307179586;
        if (shapes) {
            m->row->shape(m, p.x + w->size * k + own->at, w->workspace, shapes + 6 * m->nodes * k);
        }
    }
    free(p.square);
    return status;
}

int spari_modes(const spar_member *m, int connected, int64_t n, double *frequency, double *shapes) {
    spari_small_motions w;
    SPARI_TRY(spari_need_mass(m));
    int status = spari_small_motions_create_modes(&w, m, connected);
    status = status == SPAR_OK ? solve_modes(&w, m, connected, n, frequency, shapes) : status;
    spari_small_motions_free(&w);
    return status;
}

int spar_member_solve_modes(spar_member *member, int64_t n, double *frequency_hz, double *shapes) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_TRY(spari_need_committed(member, __func__));
    spar_session *s = member->session;
    SPARI_TRY(spari_named(s, __func__, spari_need_mass(member)));
    SPARI_REQUIRE(s, n >= 0, SPAR_ERR_ARGUMENT, "%s: '%s': %lld modes", __func__, member->name, (long long)n);
    SPARI_REQUIRE(s, frequency_hz || n == 0, SPAR_ERR_ARGUMENT, "%s: '%s': frequency_hz is NULL", __func__,
                  member->name);
    int connected = member->joint_count > 0;
    int status = connected ? spari_joints_place(s) : SPAR_OK;
    status = status == SPAR_OK ? spari_modes(member, connected, n, frequency_hz, shapes) : status;
    return spari_named(s, __func__, status);
}
