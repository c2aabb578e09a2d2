/* Getters of the last advice. */
#include "../member/structure.h"
#include "../trial/handle.h"

static int check_advised(const spar_trial *trial, const char *call) {
    SPARI_REQUIRE(NULL, trial, SPAR_ERR_ARGUMENT, "%s: the trial is NULL; create it first", call);
    SPARI_REQUIRE(trial->session, trial->advised.given, SPAR_ERR_STATE,
                  "%s: there is no advice yet; call spar_trial_advise first", call);
    return SPAR_OK;
}

int spar_trial_get_settings(const spar_trial *trial, double *dt, int *substeps, int *scheme, double *coupling_rtol,
                            int *predictor, double *newton_rtol) {
    SPARI_TRY(check_advised(trial, __func__));
    SPARI_GIVE(dt, trial->advised.dt);
    SPARI_GIVE(substeps, trial->advised.substeps);
    SPARI_GIVE(scheme, trial->advised.scheme);
    SPARI_GIVE(coupling_rtol, trial->advised.coupling_rtol);
    SPARI_GIVE(predictor, trial->advised.predictor);
    SPARI_GIVE(newton_rtol, trial->advised.newton_rtol);
    return SPAR_OK;
}

int spar_trial_get_beam(const spar_trial *trial, const spar_member *member, int *fidelity, int64_t *modes,
                        int *elements, int *nodes_per_element, int *points) {
    SPARI_TRY(check_advised(trial, __func__));
    SPARI_REQUIRE(trial->session, member && member->session == trial->session, SPAR_ERR_ARGUMENT,
                  "%s: the member is %s; give a member of the trial's session", __func__,
                  member ? "of another session" : "NULL");
    const int64_t k = member->number;
    SPARI_REQUIRE(trial->session, k < trial->advised.members, SPAR_ERR_STATE,
                  "%s: '%s' was created after the advice; call spar_trial_advise again", __func__, member->name);
    const spari_rebuild *a = trial->advised.beam + k;
    SPARI_GIVE(fidelity, a->fidelity);
    SPARI_GIVE(modes, a->modes);
    SPARI_GIVE(elements, a->elements);
    SPARI_GIVE(nodes_per_element, a->per_element);
    SPARI_GIVE(points, a->points);
    return SPAR_OK;
}

int spar_trial_get_outcome(const spar_trial *trial, double *error, double *cost, int *present_fails,
                           double *present_error) {
    SPARI_TRY(check_advised(trial, __func__));
    SPARI_GIVE(error, trial->advised.error);
    SPARI_GIVE(cost, trial->advised.cost);
    SPARI_GIVE(present_fails, trial->advised.present_fails);
    SPARI_GIVE(present_error, trial->advised.present_error);
    return SPAR_OK;
}

int spar_trial_get_search(const spar_trial *trial, int64_t *runs, double *work) {
    SPARI_TRY(check_advised(trial, __func__));
    SPARI_GIVE(runs, trial->advised.runs);
    SPARI_GIVE(work, trial->advised.work);
    return SPAR_OK;
}
