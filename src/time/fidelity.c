/* Which row of the table a member has: see fidelity.h. */
#include "fidelity.h"

#include "../member/beam.h"
#include "../member/check_arguments.h"
#include "../member/joint.h"
#include "../member/plane.h"

#define SPARI_FIDELITY_ENTRY(number, name) [SPAR_FIDELITY_##number] = &spari_fidelity_##name,
static const spari_fidelity *const table[] = {SPARI_FIDELITIES(SPARI_FIDELITY_ENTRY)};
#define SPARI_COUNT_FIDELITY(number, name) +1
enum { ROWS = 0 SPARI_FIDELITIES(SPARI_COUNT_FIDELITY) };

const spari_fidelity *spari_fidelity_row(int fidelity) {
    return table[fidelity];
}

const spari_fidelity *spari_fidelity_of(const spar_member *m) {
    return m->external || m->kind == SPARI_POINT ? &spari_fidelity_given : table[m->fidelity];
}

int spari_fidelity_check(const spar_member *m) {
    const spari_fidelity *row = table[m->fidelity];
    SPARI_REQUIRE(
        m->session, m->fidelity == SPAR_FIDELITY_EXACT || (m->kind == SPARI_BEAM && !m->external), SPAR_ERR_STATE,
        "member '%s': only beams that spar solves can have a fidelity below exact; keep SPAR_FIDELITY_EXACT", m->name);
    SPARI_REQUIRE(m->session, (m->guess.count == 0 && !m->learned) || spari_fidelity_of(m)->solved,
                  SPAR_ERR_UNSUPPORTED,
                  "member '%s' is external or prescribed: added mass does not apply to prescribed members; remove "
                  "spar_member_set_added_mass and spar_member_learn_added_mass",
                  m->name);
    SPARI_REQUIRE(m->session, !m->beam || m->beam->springs.count == 0 || (row->solved && !row->whole),
                  SPAR_ERR_UNSUPPORTED,
                  "member '%s' has a foundation (spar_beam_set_foundation), which needs fidelity exact, linear or "
                  "modal; choose one of these (spar_member_set_fidelity)",
                  m->name);
    SPARI_REQUIRE(m->session,
                  !m->beam || m->beam->springs.count == 0 || row->frame != SPARI_FRAME_LINEAR ||
                      m->root != SPAR_ROOT_DRIVEN,
                  SPAR_ERR_UNSUPPORTED,
                  "member '%s' is linear in the frame of a driven root, which moves relative to its foundation "
                  "(spar_beam_set_foundation); use SPAR_FIDELITY_EXACT, or fix the root",
                  m->name);
    const spar_joint *joint = row->frame == SPARI_FRAME_LINEAR && m->joint_count > 0 ? m->joints[0] : NULL;
    SPARI_REQUIRE(m->session, !joint, SPAR_ERR_UNSUPPORTED,
                  "member '%s' is a linear or modal beam, which joint '%s' cannot connect; use SPAR_FIDELITY_EXACT "
                  "(spar_member_set_fidelity), which costs about as much with joints",
                  m->name, joint->name);
    SPARI_REQUIRE(m->session, !spari_member_plane(m) || spari_fidelity_of(m) == &spari_fidelity_exact,
                  SPAR_ERR_UNSUPPORTED,
                  "member '%s' is held in a plane (spar_beam_set_plane), which needs fidelity exact; choose it "
                  "(spar_member_set_fidelity), or remove the plane",
                  m->name);
    return row->check ? row->check(m) : SPAR_OK;
}

int spar_member_set_fidelity(spar_member *member, int kind, int64_t modes) {
    SPARI_TRY(spari_need_open(member, __func__));
    spar_session *s = member->session;
    SPARI_REQUIRE(s, kind >= 0 && kind < ROWS && table[kind], SPAR_ERR_ARGUMENT,
                  "%s: '%s': fidelity %d is not known; see SPAR_FIDELITY_*", __func__, member->name, kind);
    SPARI_REQUIRE(s, kind == SPAR_FIDELITY_EXACT || member->kind == SPARI_BEAM, SPAR_ERR_ARGUMENT,
                  "%s: '%s' is not a beam; a point and a rigid body have one fidelity", __func__, member->name);
    SPARI_REQUIRE(s, !table[kind]->takes_modes || (modes >= 1 && modes <= INT32_MAX), SPAR_ERR_ARGUMENT,
                  "%s: '%s': %lld modes; give at least 1", __func__, member->name, (long long)modes);
    member->fidelity = kind;
    member->modes = table[kind]->takes_modes ? modes : 0;
    return SPAR_OK;
}
