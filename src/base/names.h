/* A set of names, to find one that is there already among many. */
#ifndef SPARI_NAMES_H
#define SPARI_NAMES_H

#include <stdint.h>

typedef struct spari_names {
    const char **slot; /* open addressing; NULL: free */
    int64_t slots, count;
} spari_names;

/* Adds a name, whose text must stay. Returns 0, 1 if it is there already, or -1 if there is no memory. */
int spari_names_add(spari_names *names, const char *name);
void spari_names_free(spari_names *names);

#endif
