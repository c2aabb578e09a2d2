/* Workspace that is kept between calls, because hosts may call from threads with small stacks. */
#ifndef SPARI_WORKSPACE_H
#define SPARI_WORKSPACE_H

#include <stdint.h>

typedef struct spari_workspace {
    double *block;
    int64_t doubles; /* allocated size */
} spari_workspace;

/* Allocates at least this size; the contents are lost when it grows. 0, or 1: no memory, and nothing has changed. */
int spari_workspace_reserve(spari_workspace *workspace, int64_t doubles);
void spari_workspace_free(spari_workspace *workspace);
/* Start of the workspace, aligned to a cache line. NULL: that much has not been allocated. */
double *spari_workspace_at(const spari_workspace *workspace, int64_t doubles);

#endif
