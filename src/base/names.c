/* A set of names: see names.h. */
#include "names.h"

#include "status.h"

#include <stdlib.h>
#include <string.h>

/* The slot of a name, or the free one for it. */
static const char **slot_of(const spari_names *n, const char *name) {
    uint64_t at = spari_hash_bytes(SPARI_HASH_BEGIN, name, strlen(name)) % (uint64_t)n->slots;
    while (n->slot[at] && strcmp(n->slot[at], name) != 0) {
        at = (at + 1) % (uint64_t)n->slots;
    }
    return n->slot + at;
}

static int double_slots(spari_names *n) {
    spari_names more = {.slots = n->slots ? 2 * n->slots : 16, .count = n->count};
    if (!(more.slot = spari_zalloc(more.slots, sizeof *more.slot))) {
        return 1;
    }
    for (int64_t i = 0; i < n->slots; i++) {
        if (n->slot[i]) {
            *slot_of(&more, n->slot[i]) = n->slot[i];
        }
    }
    free(n->slot);
    *n = more;
    return 0;
}

int spari_names_add(spari_names *n, const char *name) {
    if (2 * n->count >= n->slots && double_slots(n)) {
        return -1;
    }
    const char **slot = slot_of(n, name);
    if (*slot) {
        return 1;
    }
    *slot = name;
    n->count++;
    return 0;
}

void spari_names_free(spari_names *n) {
    free(n->slot);
    *n = (spari_names){0};
}
