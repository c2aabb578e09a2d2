/* The surroundings that the library computes in, whatever those of the host are. Floating-point traps are held: a host
   that traps invalid operations, divisions by zero and overflows (usual in Fortran) gets a status where a signal would
   end it. Results are rounded to the nearest: rounded one way, what errors leave does not cancel, an iteration stalls
   far above its tolerance, and a run's bits would be those of its host. Numbers are read and written with a point.
   The treatment of denormal numbers stays the host's; flags raised inside are not seen outside. */
#ifndef SPARI_QUIET_H
#define SPARI_QUIET_H

#include <fenv.h>
#include <locale.h>
#include <stdint.h>

/* How a thread computes: modes, traps and flags. <fenv.h> saves and loads the whole state of the old coprocessor, which
   takes 100 ns a call; where the processor and its C library are known the few words that tell are looked at, and
   loaded only where they differ. */
#if defined(__x86_64__) && defined(__GNUC__) && defined(__GLIBC__)
#define SPARI_X86 1
typedef struct spari_environment {
    uint32_t sse;             /* MXCSR */
    uint16_t control, status; /* of the coprocessor, which long double computes with */
} spari_environment;
#else
typedef fenv_t spari_environment;
#endif

/* Of this thread; one within the other costs nothing. */
void spari_quiet_begin(void);
void spari_quiet_end(void);

/* The host's own surroundings, around a call of the host's from inside. */
typedef struct spari_host {
    int depth; /* public functions on the way */
    spari_environment environment;
    locale_t locale;
} spari_host;
void spari_host_begin(spari_host *inside);
void spari_host_end(const spari_host *inside);

static inline void spari_quiet_leave(const int *scope) {
    (void)scope;
    spari_quiet_end();
}

/* First in a public function that computes, or looks at numbers of the host: until it returns. Other compilers than GCC
   and Clang have no end of a scope to hang it on; their hosts must not trap. */
#if defined(__GNUC__)
#define SPARI_QUIET                                                                                                    \
    const int spari_quiet_ __attribute__((unused, cleanup(spari_quiet_leave))) = 0;                                    \
    spari_quiet_begin()
#else
#define SPARI_QUIET (void)0
#endif

#endif
