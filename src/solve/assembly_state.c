/* What an assembly's owner tells the other ranks. */
#include "assembly.h"
#include "tied.h"

#include <string.h>

enum { RELATIVE = sizeof(spari_relative) / sizeof(double), DRIVEN = sizeof(spari_driven) / sizeof(double) };

/* Of a joint: the motion after, and in the first step what it began with at t^0. */
enum { SHARED = 1 + 2 * RELATIVE + DRIVEN };

int spari_assembly_owner(const spari_assembly *a) {
    return a->owner;
}

int64_t spari_assembly_share_size(const spari_assembly *a) {
    return (int64_t)SHARED * a->links;
}

void spari_assembly_pack(const spari_assembly *a, double *to) {
    for (int i = 0; i < a->links; i++, to += SHARED) {
        const spar_joint *j = a->link[i].joint;
        to[0] = j->balanced;
        memcpy(to + 1, &j->after, sizeof j->after);
        memcpy(to + 1 + RELATIVE, &j->now, sizeof j->now);
        memcpy(to + 1 + 2 * RELATIVE, &j->drive[0], sizeof j->drive[0]);
    }
}

void spari_assembly_unpack(spari_assembly *a, const double *from) {
    for (int i = 0; i < a->links; i++, from += SHARED) {
        spar_joint *j = a->link[i].joint;
        if (from[0] != 0 && !j->balanced) {
            memcpy(&j->after, from + 1 + RELATIVE, sizeof j->after);
            spari_joint_balance(j);
            memcpy(&j->drive[0], from + 1 + 2 * RELATIVE, sizeof j->drive[0]);
        }
        memcpy(&j->after, from + 1, sizeof j->after);
    }
}
