/* Workspace that is kept between calls, because hosts may call from threads with small stacks. */
#ifndef SPARI_ROOM_H
#define SPARI_ROOM_H

#include <stdint.h>

typedef struct spari_room {
    double *block;
    int64_t doubles; /* allocated size */
} spari_room;

/* Allocates at least this size; the contents are lost when it grows. 0, or 1: no memory, and nothing has changed. */
int spari_room_keep(spari_room *room, int64_t doubles);
void spari_room_free(spari_room *room);
/* Start of the workspace, aligned to a cache line. NULL: that much has not been allocated. */
double *spari_room_at(const spari_room *room, int64_t doubles);

#endif
