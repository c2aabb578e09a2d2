/* The floating-point environment in which the library computes, whatever the host has set.
   - Traps are off. A host that traps invalid operations, divisions by zero or overflows (usual in Fortran) gets a
     status, not a signal.
   - Rounding is to nearest. With directed rounding, errors do not cancel, iterations stall far above their
     tolerance, and results depend on the host.
   - The locale is "C", so numbers are read and written with a decimal point.
   - GSL's error handler, which may abort, is off while any thread is inside the library.
   The treatment of denormal numbers stays the host's. Exception flags raised inside are not visible outside. */
#ifndef SPARI_ENVIRONMENT_H
#define SPARI_ENVIRONMENT_H

#include <fenv.h>
#include <locale.h>
#include <stdint.h>

/* Modes, traps and flags of a thread. <fenv.h> saves and loads the whole x87 state, which takes 100 ns a call. On
   x86-64 with GCC and glibc only the relevant words are read, and loaded only if they differ. */
#if defined(__x86_64__) && defined(__GNUC__) && defined(__GLIBC__)
#define SPARI_MXCSR 1 /* its registers are read and written directly */
typedef struct spari_environment {
    uint32_t sse;             /* MXCSR */
    uint16_t control, status; /* of the x87 unit, used by long double */
} spari_environment;
#else
typedef fenv_t spari_environment;
#endif

/* For this thread. Calls may be nested; inner calls cost nothing. */
void spari_environment_begin(void);
void spari_environment_end(void);

/* Restores the host's environment while the library calls the host. */
typedef struct spari_host {
    int depth; /* nesting depth of public functions */
    spari_environment environment;
    locale_t locale;
} spari_host;
void spari_host_begin(spari_host *inside);
void spari_host_end(const spari_host *inside);

static inline void spari_environment_leave(const int *scope) {
    (void)scope;
    spari_environment_end();
}

/* First statement of every public function that computes or reads the host's numbers. Restores the host's
   environment when the function returns. Compilers other than GCC and Clang have no scope cleanup: their hosts must
   not trap, and must switch GSL's handler off themselves. */
#if defined(__GNUC__)
#define SPARI_GUARD_ENVIRONMENT                                                                                        \
    const int spari_guard_ __attribute__((unused, cleanup(spari_environment_leave))) = 0;                              \
    spari_environment_begin()
#else
#define SPARI_GUARD_ENVIRONMENT (void)0
#endif

#endif
