/* Scenes that together call every public function: each can be run again and again, with the same numbers every time.
 */
#ifndef TORTURE_SCENARIO_H
#define TORTURE_SCENARIO_H

#include <stdint.h>

typedef struct act {
    const char *name;
    void (*run)(void);
    int repeats; /* 0: takes decisions by the clock, so that its allocations are not the same every time */
} act;

extern const act acts[];
extern const int act_count;

/* Before any run: this rank and how many, a folder for files, whether a failure is being injected somewhere. */
void scenario_set(int rank, int ranks, const char *folder);
void scenario_injecting(int on);
/* The act begins: numbers and complaints are counted anew. */
void scenario_begin(void);
/* What the act's numbers came out as, all of them to the last bit. */
uint64_t scenario_digest(void);
/* Complaints so far (each has been printed). */
int scenario_complaints(void);
void scenario_complain(const char *what, const char *detail);
/* Whether a public function has been called. */
int scenario_has_called(const char *function);

#endif
