/* Reports how the cost of solving is distributed over ranks. */
#include "../assembly/assembly.h"
#include "../assembly/owners.h"
#include "../base/environment.h"
#include "../comm/enter.h"
#include "../time/fidelity.h"

#include <stdlib.h>

enum { BALANCE_MEMBERS, BALANCE_EXPECTED, BALANCE_COUNTED, BALANCE_COLUMNS };

/* This rank's cost, from what it solves. */
static void find_balance(const spar_session *s, double own[BALANCE_COLUMNS]) {
    int rank = spari_comm_rank(s->ranks.comm);
    for (const spar_member *m = s->members; m; m = m->next) {
        if (m->committed && m->row->solved && m->owner == rank) {
            own[BALANCE_MEMBERS]++;
            own[BALANCE_EXPECTED] += m->assembly ? 0 : spari_member_expected(m);
        }
    }
    for (const spari_assembly *a = s->assemblies; a; a = spari_assembly_next(a)) {
        own[BALANCE_EXPECTED] += spari_assembly_owner(a) == rank ? spari_assembly_expected(a) : 0;
    }
    for (const spar_member *m = s->members; m; m = m->next) {
        spari_effort effort = {0};
        if (m->committed && m->row->effort && spari_fidelity_is_here(m)) {
            m->row->effort(m, &effort);
        }
        own[BALANCE_COUNTED] += (double)effort.iterations * spari_member_expected(m);
    }
}

int spar_session_sum_balance(const spar_session *session, int64_t capacity, int64_t *members, double *expected,
                             double *counted) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_REQUIRE(NULL, session, SPAR_ERR_ARGUMENT, "%s: the session is NULL; create it first", __func__);
    spar_session *s = (spar_session *)(uintptr_t)session; /* writes its message; the state is not changed */
    int64_t ranks = spari_comm_size(s->ranks.comm);
    double *all = NULL;
    int status = spari_need_capacity(s, __func__, capacity);
    if (status == SPAR_OK) {
        all = spari_zalloc(BALANCE_COLUMNS * ranks + 1, sizeof *all);
        status = all ? SPAR_OK : spari_fail(s, SPAR_ERR_MEMORY, "%s: no memory for the cost of the ranks", __func__);
    }
    status = spari_enter(s, __func__, status);
    if (status == SPAR_OK && all) {
        find_balance(s, all + BALANCE_COLUMNS * spari_comm_rank(s->ranks.comm));
        status = spari_named(s, __func__, spari_sum(s, all, BALANCE_COLUMNS * ranks));
    }
    for (int64_t r = 0; r < capacity && status == SPAR_OK && all; r++) {
        const double *of = r < ranks ? all + BALANCE_COLUMNS * r : NULL;
        if (members) {
            members[r] = of ? (int64_t)of[BALANCE_MEMBERS] : 0;
        }
        if (expected) {
            expected[r] = of ? of[BALANCE_EXPECTED] : 0;
        }
        if (counted) {
            counted[r] = of ? of[BALANCE_COUNTED] : 0;
        }
    }
    free(all);
    return status;
}
