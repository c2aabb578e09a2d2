/* Work space that is kept from call to call, because hosts call from threads whose stacks are small. */
#ifndef SPARI_ROOM_H
#define SPARI_ROOM_H

#include <stdint.h>

typedef struct spari_room {
    double *block;
    int64_t doubles; /* that there is room for */
} spari_room;

/* So many doubles at least; what is in them is lost when they become more. 0, or 1: no memory, and all is as it was. */
int spari_room_keep(spari_room *room, int64_t doubles);
void spari_room_free(spari_room *room);
/* Where they begin, at a cache line's beginning. NULL: that much has not been kept. */
double *spari_room_at(const spari_room *room, int64_t doubles);

#endif
