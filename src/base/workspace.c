/* Workspace that is kept between calls: see workspace.h. */
#include "workspace.h"

#include "status.h"

#include <stdlib.h>

enum { LINE = 64 }; /* bytes of a cache line and of the widest vector */

int spari_room_keep(spari_room *room, int64_t doubles) {
    if (doubles <= room->doubles) {
        return 0;
    }
    double *block = spari_zalloc(doubles + LINE / (int64_t)sizeof *block, sizeof *block);
    if (!block) {
        return 1;
    }
    free(room->block);
    *room = (spari_room){block, doubles};
    return 0;
}

void spari_room_free(spari_room *room) {
    free(room->block);
    *room = (spari_room){0};
}

double *spari_room_at(const spari_room *room, int64_t doubles) {
    if (!room->block || doubles > room->doubles) {
        return NULL;
    }
    return room->block + (LINE - (uintptr_t)room->block % LINE) % LINE / sizeof *room->block;
}
