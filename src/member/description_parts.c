/* The parts of a member's description: what is in force, not how it was said. */
#include "added_mass_fit.h"
#include "beam.h"
#include "digest.h"
#include "structure.h"

#include <string.h>

const char *const spari_member_part_name[SPARI_MEMBER_PARTS] = {"kind",
                                                                "fidelity",
                                                                "root",
                                                                "effects",
                                                                "elements and nodes",
                                                                "mass",
                                                                "added mass",
                                                                "line",
                                                                "quadrature",
                                                                "sections",
                                                                "damping",
                                                                "foundation",
                                                                "pretension",
                                                                "point masses",
                                                                "initial position",
                                                                "initial velocity"};

static int any_not_zero(int64_t n, const double *x) {
    int any = 0;
    for (int64_t i = 0; i < n && x; i++) {
        any |= x[i] != 0;
    }
    return any;
}

/* Points of a quadrature rule that are in force: those of an element by default, but where sections decide. */
static int points_in_force(const spar_member *m) {
    const spari_beam *b = m->beam;
    return b->points > 0 || spari_beam_rule(b) == SPAR_QUADRATURE_SECTIONS ? b->points : m->mesh.per_element;
}

static void add_table(spari_described *p, const spari_line_table *table, spari_number_kind kind, int width) {
    spari_described_exact(p, table->count);
    spari_described_add(p, SPARI_NUMBERS_PLAIN, table->count, 1, table->eta);
    spari_described_add(p, kind, table->count, width, table->value);
}

/* Without twist there are zeros. */
static void add_line(spari_described *p, const spar_member *m, const spari_beam *b) {
    spari_described_exact(p, b->axis_count);
    spari_described_exact(p, b->planar);
    spari_described_exact(p, b->node_x != NULL);
    spari_described_exact(p, b->node_q != NULL);
    spari_described_add(p, SPARI_NUMBERS_PLAIN, b->planar ? 1 : 0, 3, b->normal);
    spari_described_add(p, SPARI_NUMBERS_PLAIN, b->axis_count, 1, b->eta);
    if (b->node_x) {
        spari_described_add(p, SPARI_NUMBERS_LENGTH, m->nodes, 3, b->node_x);
        spari_described_add(p, SPARI_NUMBERS_PLAIN, b->node_q ? m->nodes : 0, 4, b->node_q);
    } else {
        spari_described_add(p, SPARI_NUMBERS_LENGTH, b->axis_count, 3, b->xyz);
        spari_described_add(p, SPARI_NUMBERS_PLAIN, b->axis_count, 1,
                            any_not_zero(b->axis_count, b->twist) ? b->twist : NULL);
    }
}

static void add_of_beam(spari_described *p, const spar_member *m, const spari_beam *b, int part) {
    switch (part) {
    case SPARI_PART_LINE:
        add_line(p, m, b);
        break;
    case SPARI_PART_QUADRATURE:
        spari_described_exact(p, spari_beam_rule(b));
        spari_described_exact(p, points_in_force(m));
        break;
    case SPARI_PART_SECTIONS:
        spari_described_exact(p, b->section_count);
        spari_described_exact(p, b->mass != NULL);
        spari_described_add(p, SPARI_NUMBERS_PLAIN, b->section_count, 1, b->section_eta);
        spari_described_add(p, SPARI_NUMBERS_MATRIX, b->section_count, 36, b->stiffness);
        spari_described_add(p, SPARI_NUMBERS_MATRIX, b->mass ? b->section_count : 0, 36, b->mass);
        break;
    case SPARI_PART_DAMPING:
        spari_described_add(p, SPARI_NUMBERS_ROW, 1, 6, b->mu);
        spari_described_add(p, SPARI_NUMBERS_ROW, 1, 1, &b->mass_damping);
        break;
    case SPARI_PART_FOUNDATION:
        add_table(p, &b->springs, SPARI_NUMBERS_ROW, 3);
        break;
    case SPARI_PART_PRETENSION:
        add_table(p, &b->pretension, SPARI_NUMBERS_ROW, 6);
        break;
    default:
        add_table(p, &b->point_masses, SPARI_NUMBERS_MATRIX, 36);
    }
}

static spari_described member_part(const spar_member *m, int part) {
    spari_described p = {.length = spari_member_length(m)};
    switch (part) {
    case SPARI_PART_KIND:
        spari_described_exact(&p, m->kind);
        spari_described_exact(&p, m->external);
        break;
    case SPARI_PART_FIDELITY:
        spari_described_exact(&p, m->fidelity);
        spari_described_exact(&p, m->fidelity == SPAR_FIDELITY_MODAL ? m->modes : 0);
        break;
    case SPARI_PART_ROOT:
        spari_described_exact(&p, m->root);
        break;
    case SPARI_PART_EFFECTS:
        spari_described_exact(&p, m->effects);
        break;
    case SPARI_PART_MESH:
        spari_described_exact(&p, m->mesh.elements);
        spari_described_exact(&p, m->mesh.per_element);
        break;
    case SPARI_PART_MASS:
        spari_described_add(&p, SPARI_NUMBERS_MATRIX, m->kind == SPARI_RIGID ? 1 : 0, 36, m->mass);
        break;
    case SPARI_PART_ADDED_MASS:
        spari_described_exact(&p, m->added_by_velocity);
        add_table(&p, &m->guess, SPARI_NUMBERS_MATRIX, 36);
        spari_learned_part(m, &p);
        break;
    case SPARI_PART_POSITION:
        spari_described_add(&p, SPARI_NUMBERS_POSITION, 1, 3, m->placement.x);
        spari_described_add(&p, SPARI_NUMBERS_PLAIN, 1, 4, m->placement.q);
        break;
    case SPARI_PART_VELOCITY:
        spari_described_add(&p, SPARI_NUMBERS_PLAIN, 3, 3,
                            any_not_zero(6, m->initial.velocity[1]) ? m->initial.velocity[0] : NULL);
        break;
    default:
        if (m->beam) {
            add_of_beam(&p, m, m->beam, part);
        }
    }
    return p;
}

static uint64_t hash_parts(const spar_member *m, uint64_t h, int end) {
    for (int part = 0; part < end; part++) {
        const spari_described p = member_part(m, part);
        h = spari_described_hash(h, &p);
    }
    return h;
}

uint64_t spari_member_copy_hash(const spar_member *m) {
    return hash_parts(m, SPARI_HASH_BEGIN, SPARI_PART_POSITION);
}

uint64_t spari_member_hash(const spar_member *m) {
    return hash_parts(m, spari_hash_bytes(SPARI_HASH_BEGIN, m->name, strlen(m->name)), SPARI_MEMBER_PARTS);
}

void spari_member_part_digest(const spar_member *m, int part, spari_digest *digest) {
    const spari_described p = member_part(m, part);
    spari_described_digest(&p, digest);
}
