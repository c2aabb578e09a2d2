/* Rebuilds members with other elements or fidelity for a trial, and restores them: see rebuild.h. */
#include "rebuild.h"

#include "../math/resample.h"
#include "../member/added_mass.h"
#include "../member/applied_loads.h"
#include "../member/beam.h"
#include "../member/mean_acceleration.h"
#include "../solve/life.h"
#include "../time/fidelity.h"

#include <stdlib.h>
#include <string.h>

spari_rebuild spari_rebuild_of(const spar_member *m) {
    return (spari_rebuild){
        .per_element = m->mesh.per_element, .fidelity = m->fidelity, .modes = m->modes, .elements = m->mesh.elements};
}

/* ---- description and state ---- */

/* The description with another quadrature rule, or other nodes if nodes were given; a copy that shares the rest. */
static int describe_again(spar_member *m, const spari_rebuild *settings, const spar_member *old) {
    if (m->kind != SPARI_BEAM) {
        return SPAR_OK;
    }
    spari_beam *b = spari_zalloc(1, sizeof *b);
    SPARI_REQUIRE(m->session, b, SPAR_ERR_MEMORY, "no memory for a trial of '%s'", m->name);
    *b = *old->beam;
    b->node_x = b->node_q = NULL;
    m->beam = b;
    b->rule = spari_beam_rule(old->beam);
    if (settings->points > 0) {
        b->points = settings->points;
    } else if (b->points > 0 && b->rule != SPAR_QUADRATURE_SECTIONS) { /* as many as an element with more nodes needs */
        int least = settings->per_element + (b->rule == SPAR_QUADRATURE_LOBATTO);
        b->points = b->points < least ? least : b->points;
    }
    m->mesh.per_element = settings->per_element;
    m->mesh.elements = settings->elements > 0 ? settings->elements : m->mesh.elements;
    SPARI_REQUIRE(m->session, m->mesh.elements == old->mesh.elements || !old->beam->node_x, SPAR_ERR_STATE,
                  "the nodes of '%s' were set by the host, so it cannot have %d elements instead of %d; describe its "
                  "axis, or keep the elements",
                  m->name, m->mesh.elements, old->mesh.elements);
    m->nodes = (int64_t)m->mesh.elements * m->mesh.per_element;
    if (old->beam->node_x) { /* given nodes are replaced by the line through them */
        const spari_beam *given = old->beam;
        b->node_x = spari_zalloc(3 * m->nodes, sizeof *b->node_x);
        b->node_q = given->node_q ? spari_zalloc(4 * m->nodes, sizeof *b->node_q) : NULL;
        SPARI_REQUIRE(m->session, b->node_x && (b->node_q || !given->node_q), SPAR_ERR_MEMORY,
                      "no memory for a trial of '%s'", m->name);
        spari_resample_values(old->mesh, m->mesh, 3, -1, given->node_x, b->node_x);
        if (b->node_q) {
            spari_resample_values(old->mesh, m->mesh, 4, 0, given->node_q, b->node_q);
        }
    }
    return SPAR_OK;
}

/* Past loads are kept as far as both predictors need. */
static void carry_state(spar_member *old, spar_member *m) {
    const spari_mesh was = old->mesh, is = m->mesh;
    for (int k = 0; k < SPARI_NODAL_COUNT; k++) {
        const spari_nodal *row = spari_nodal_table + k;
        const double *from = *spari_nodal_array(old, k);
        double *to = *spari_nodal_array(m, k);
        if (row->kind == SPARI_NODAL_MOTION) {
            spari_resample_values(was, is, row->width, row->width == 7 ? 3 : -1, from, to);
        } else if (row->kind == SPARI_NODAL_LOAD && from && to) {
            spari_resample_loads(was, is, from, to);
        }
    }
    if (old->initial.acceleration) {
        spari_resample_values(was, is, 6, -1, old->initial.acceleration, m->now.a);
    }
    spari_member_restart(m);
    spari_added_carry(old, m);
    spari_means_carry(old, m);
    memcpy(m->drive, old->drive, sizeof m->drive);
}

int spari_member_rebuild(spar_member *m, const spari_rebuild *settings, spar_member *old) {
    spari_member_detach(m, old);
    m->fidelity = settings->fidelity;
    m->modes = spari_fidelity_row(settings->fidelity)->takes_modes ? settings->modes : 0;
    SPARI_TRY(describe_again(m, settings, old));
    SPARI_TRY(spari_fidelity_check(m));
    m->effects = spari_member_effects(m) & ~settings->left_out;
    if (!(m->effects & SPAR_EFFECT_INERTIA)) {
        m->effects &= ~SPAR_EFFECT_GYROSCOPIC;
    }
    SPARI_TRY(spari_member_build(m));
    SPARI_TRY(spari_applied_rebuild(old, m));
    carry_state(old, m);
    return SPAR_OK;
}

/* Frees a copy made by describe_again, except what the other member shares. */
static void drop_description(spari_beam *beam, const spari_beam *stays) {
    if (beam != stays) {
        SPARI_FREE(beam->node_x, beam->node_q, beam);
    }
}

void spari_member_restore(spar_member *m, const spar_member *old) {
    spari_beam *made = m->beam;
    spari_member_take_back(m, old);
    drop_description(made, m->beam);
}

void spari_member_adopt(spar_member *m, spar_member *old) {
    spari_member_release(old);
    drop_description(old->beam, m->beam);
}
