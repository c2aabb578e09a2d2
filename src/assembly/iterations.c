/* What Newton's iteration of a member has taken and left, for the host. */
#include "../base/environment.h"
#include "../base/session.h"
#include "assembly.h"
#include "../time/fidelity.h"

int spar_member_get_newton(const spar_member *member, int64_t *iterations, double *left) {
    SPARI_QUIET;
    SPARI_REQUIRE(NULL, member, SPAR_ERR_ARGUMENT, "%s: the member is NULL; create it first", __func__);
    spari_effort effort = {0};
    if (member->committed && member->row->effort && spari_fidelity_is_here(member)) {
        member->row->effort(member, &effort);
        effort.left = member->assembly ? spari_assembly_left(member->assembly) : effort.left;
    }
    if (iterations) {
        *iterations = effort.iterations;
    }
    if (left) {
        *left = effort.left;
    }
    return SPAR_OK;
}
