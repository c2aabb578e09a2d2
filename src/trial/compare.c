/* One run of a trial with the session as it is, compared with an earlier one. */
#include "handle.h"

#include "../base/environment.h"

static int check_comparison(spar_trial *t, const char *call, int compare) {
    spar_session *s = t->session;
    SPARI_TRY(spari_trial_ready_for_runs(t, call));
    SPARI_REQUIRE(s, !compare || (t->kept.value && t->kept.members == s->member_count), SPAR_ERR_STATE,
                  "%s: there is no earlier run of these members to compare with; call with compare = 0 first", call);
    return SPAR_OK;
}

static int run_once(spar_trial *t, int compare) {
    spar_session *s = t->session;
    spari_trial_settings trial_settings = {0};
    spari_record record = {0};
    spari_run run = spari_trial_run_of(t, NULL);
    run.goals = SPARI_GOAL(SPARI_OF_REACTION);
    int status = spari_trial_settings_create(s, &trial_settings);
    if (status == SPAR_OK) {
        (void)spari_trial_run(s, &run, &trial_settings, &record);
        status = record.own;
    }
    spari_trial_settings_free(&trial_settings);
    if (status == SPAR_OK) {
        t->ran = 1;
        t->motion = compare ? spari_record_distance(&record, &t->kept, SPARI_OF_MOTION) : 0;
        t->reaction = compare ? spari_record_distance(&record, &t->kept, SPARI_OF_REACTION) : 0;
        t->load = compare ? spari_record_load(&record, &t->kept) : 0;
        t->seconds = record.seconds, t->evaluations = record.solutions;
    }
    if (status == SPAR_OK && !compare) { /* for later comparisons */
        spari_record_free(&t->kept);
        t->kept = record;
        record = (spari_record){0};
    }
    spari_record_free(&record);
    return status;
}

int spar_trial_run(spar_trial *trial, int compare) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_REQUIRE(NULL, trial, SPAR_ERR_ARGUMENT, "%s: the trial is NULL; create it first", __func__);
    const spari_agreed arguments[] = {spari_whole("compare", compare != 0)};
    SPARI_TRY(spari_trial_enter(trial, __func__, arguments, 1, check_comparison(trial, __func__, compare)));
    return spari_trial_leave(trial, __func__, run_once(trial, compare));
}

static int check_result(const spar_trial *trial, const char *call) {
    SPARI_REQUIRE(NULL, trial, SPAR_ERR_ARGUMENT, "%s: the trial is NULL; create it first", call);
    SPARI_REQUIRE(trial->session, trial->ran, SPAR_ERR_STATE, "%s: there is no run; call spar_trial_run first", call);
    return SPAR_OK;
}

int spar_trial_get_errors(const spar_trial *trial, double *motion, double *reaction, double *load) {
    SPARI_TRY(check_result(trial, __func__));
    SPARI_GIVE(motion, trial->motion);
    SPARI_GIVE(reaction, trial->reaction);
    SPARI_GIVE(load, trial->load);
    return SPAR_OK;
}

int spar_trial_get_cost(const spar_trial *trial, double *seconds, int64_t *evaluations) {
    SPARI_TRY(check_result(trial, __func__));
    SPARI_GIVE(seconds, trial->seconds);
    SPARI_GIVE(evaluations, trial->evaluations);
    return SPAR_OK;
}
