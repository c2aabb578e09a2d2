/* Workspace that is kept between calls: see workspace.h. */
#include "workspace.h"

#include "status.h"

#include <stdlib.h>

enum { LINE = 64 }; /* bytes of a cache line and of the widest vector */

int spari_workspace_reserve(spari_workspace *workspace, int64_t doubles) {
    if (doubles <= workspace->doubles) {
        return 0;
    }
    double *block = spari_zalloc(doubles + LINE / (int64_t)sizeof *block, sizeof *block);
    if (!block) {
        return 1;
    }
    free(workspace->block);
    *workspace = (spari_workspace){block, doubles};
    return 0;
}

void spari_workspace_free(spari_workspace *workspace) {
    free(workspace->block);
    *workspace = (spari_workspace){0};
}

double *spari_workspace_at(const spari_workspace *workspace, int64_t doubles) {
    if (!workspace->block || doubles > workspace->doubles) {
        return NULL;
    }
    return workspace->block + (LINE - (uintptr_t)workspace->block % LINE) % LINE / sizeof *workspace->block;
}
