/* The Newton iterations of a step or of a static solution, counted against the host's budget (option newton.budget).
   The host's progress callback is told of each, and may cancel. */
#ifndef SPARI_BUDGET_H
#define SPARI_BUDGET_H

#include "session.h"

/* What a member, or members that joints connect, have used. Whoever solves them counts, so the sum is the same with any
   number of threads and ranks. */
typedef struct spari_spent {
    int64_t call; /* session->clock.begun of the step or static solution */
    int64_t iterations;
} spari_spent;

/* A solution begins: no cancellation is known. */
void spari_budget_begin(spar_session *session);
/* Whether there may be one more iteration, which is counted; `most` in all. */
int spari_budget_allows(spar_session *session, spari_spent *spent, int64_t most);
/* After it has answered 0, until the next begin. */
int spari_budget_is_over(const spar_session *session, const spari_spent *spent, int64_t most);
/* SPAR_ERR_USER with its message if the host has cancelled; else SPAR_OK. name: of what was solved. */
int spari_budget_cancelled(const spar_session *session, const char *name, const spari_spent *spent);

#endif
