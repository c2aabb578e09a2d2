/* Data of a solved member that are sent between ranks: see motion_block.h. */
#include "motion_block.h"

#include "../member/body.h"

/* For a damped member the dissipated energy of the step is included. */
static int is_damped(const spar_member *m) {
    return (m->effects & SPAR_EFFECT_DAMPING) != 0;
}

int64_t spari_block_size(const spar_member *m) {
    return m->body ? 19 * (int64_t)m->body->unique + is_damped(m) : 0;
}

/* Block of one member: q, v, a of the unknowns; dissipation. */
int64_t spari_block_pack(const spar_member *m, double *to) {
    int64_t n = m->body ? m->body->unique : 0;
    if (n > 0) {
        spari_member_to_unique(m, 7, m->after.q, to);
        spari_member_to_unique(m, 6, m->after.v, to + 7 * n);
        spari_member_to_unique(m, 6, m->after.a, to + 13 * n);
        if (is_damped(m)) {
            to[19 * n] = m->dissipated_step;
        }
    }
    return spari_block_size(m);
}

int64_t spari_block_unpack(spar_member *m, const double *from) {
    int64_t n = m->body ? m->body->unique : 0;
    if (n > 0) {
        spari_member_from_unique(m, 7, from, m->after.q);
        spari_member_from_unique(m, 6, from + 7 * n, m->after.v);
        spari_member_from_unique(m, 6, from + 13 * n, m->after.a);
        m->dissipated_step = is_damped(m) ? from[19 * n] : 0;
    }
    return spari_block_size(m);
}
