/* Getters of the last advice. */
#include "../member/structure.h"
#include "../trial/handle.h"

static int check_advised(const spar_trial *trial, const char *call) {
    SPARI_REQUIRE(NULL, trial, SPAR_ERR_ARGUMENT, "%s: the trial is NULL; create it first", call);
    SPARI_REQUIRE(trial->session, trial->advised.given, SPAR_ERR_STATE,
                  "%s: there is no advice yet; call spar_trial_advise first", call);
    return SPAR_OK;
}

static void give_int(int *to, int x) {
    if (to) {
        *to = x;
    }
}

static void give_whole(int64_t *to, int64_t x) {
    if (to) {
        *to = x;
    }
}

static void give_real(double *to, double x) {
    if (to) {
        *to = x;
    }
}

int spar_trial_get_settings(const spar_trial *trial, double *dt, int *substeps, int *scheme, double *coupling_rtol,
                            int *predictor, double *newton_rtol) {
    SPARI_TRY(check_advised(trial, __func__));
    give_real(dt, trial->advised.dt);
    give_int(substeps, trial->advised.substeps);
    give_int(scheme, trial->advised.scheme);
    give_real(coupling_rtol, trial->advised.coupling_rtol);
    give_int(predictor, trial->advised.predictor);
    give_real(newton_rtol, trial->advised.newton_rtol);
    return SPAR_OK;
}

int spar_trial_get_beam(const spar_trial *trial, const spar_member *member, int *fidelity, int64_t *modes,
                        int *elements, int *nodes_per_element, int *points) {
    SPARI_TRY(check_advised(trial, __func__));
    SPARI_REQUIRE(trial->session, member && member->session == trial->session, SPAR_ERR_ARGUMENT,
                  "%s: the member is %s; give a member of the trial's session", __func__,
                  member ? "of another session" : "NULL");
    int64_t k = 0;
    for (const spar_member *m = trial->session->members; m != member; m = m->next) {
        k++;
    }
    SPARI_REQUIRE(trial->session, k < trial->advised.members, SPAR_ERR_STATE,
                  "%s: '%s' was created after the advice; call spar_trial_advise again", __func__, member->name);
    const spari_rebuild *a = trial->advised.beam + k;
    give_int(fidelity, a->fidelity);
    give_whole(modes, a->modes);
    give_int(elements, a->elements);
    give_int(nodes_per_element, a->per_element);
    give_int(points, a->points);
    return SPAR_OK;
}

int spar_trial_get_outcome(const spar_trial *trial, double *error, double *cost, int *present_fails,
                           double *present_error) {
    SPARI_TRY(check_advised(trial, __func__));
    give_real(error, trial->advised.error);
    give_real(cost, trial->advised.cost);
    give_int(present_fails, trial->advised.present_fails);
    give_real(present_error, trial->advised.present_error);
    return SPAR_OK;
}

int spar_trial_get_search(const spar_trial *trial, int64_t *runs, double *work) {
    SPARI_TRY(check_advised(trial, __func__));
    give_whole(runs, trial->advised.runs);
    give_real(work, trial->advised.work);
    return SPAR_OK;
}
