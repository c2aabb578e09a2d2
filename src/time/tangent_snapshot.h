/* A snapshot of the reused tangent at the beginning of a step. A rejected step restores it. The numbers are copied
   only before the step overwrites them. */
#ifndef SPARI_TANGENT_SNAPSHOT_H
#define SPARI_TANGENT_SNAPSHOT_H

#include <stdint.h>

typedef struct spari_snapshot {
    int open;      /* a step has begun, and its initial tangent is of use */
    int saved;     /* the step has overwritten it: `data` has it; -1: there was no memory for a copy */
    int64_t count; /* number of doubles */
    double *data;
    int64_t capacity;
} spari_snapshot;

/* A step begins. useful: there is a tangent to restore. */
void spari_snapshot_open(spari_snapshot *s, int useful);
/* Before the first change: where to copy `count` doubles. NULL: nothing is to be copied. */
double *spari_snapshot_take(spari_snapshot *s, int64_t count);
void spari_snapshot_close(spari_snapshot *s);
void spari_snapshot_free(spari_snapshot *s);

/* The same as doubles, for save and load: these three, and the numbers. is: whether they begin with one of the length
   `count` that has `expected` numbers, or none. there: load has found
   the numbers that are not copied yet; else they cannot be restored. */
enum { SPARI_SNAPSHOT_HEAD = 3 };
int64_t spari_snapshot_size(const spari_snapshot *s);
void spari_snapshot_save(const spari_snapshot *s, double *state);
int spari_snapshot_is(const double *state, int64_t count, int64_t expected);
void spari_snapshot_load(spari_snapshot *s, const double *state, int there);

#endif
