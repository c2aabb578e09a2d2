/* Every allocation of the process passes here: those that the library asks for (itself, or GSL in its name) are
   counted, one of them may be failed, and those that are not yet freed are known. The caller's address says who asks:
   MPI's own memory, the host's and the system's are left alone. In a build with sanitizers only the library's calls are
   seen, by the linker's --wrap. */
#ifndef TORTURE_ALLOC_H
#define TORTURE_ALLOC_H

#include <stdint.h>

/* Who asks for memory */
enum { ALLOC_NOBODY = 0, ALLOC_OWN = 1, ALLOC_GSL = 2, ALLOC_LIBC = 3, ALLOC_ASKERS = 4 };

/* Counting is on between these, in this thread; answers what it was before. */
int alloc_arm(int on);
/* Counts anew; the k-th allocation (from 1) is failed, 0: none. */
void alloc_begin(int64_t k);
int64_t alloc_counted(void);
/* Who asked for the one that was to fail; ALLOC_NOBODY: it has not come by. */
int alloc_hit(void);
/* Blocks asked for since alloc_begin and not freed yet. */
int64_t alloc_live(int who);
/* The number of the first of them. */
int64_t alloc_oldest(void);
/* Prints from where the k-th is asked for. */
void alloc_show(int64_t k);
/* Whether memory asked for by the C library in the name of the library counts too (files). */
void alloc_with_libc(int on);

#endif
