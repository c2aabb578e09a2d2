/* Preloaded: puts a host's surroundings in force before a program begins. SPAR_TORTURE_MODE:
     traps     invalid operations, divisions by zero and overflows raise a signal
     upward    results of the host's own are rounded up
     ftz       denormal numbers are zero, as operands and as results
     comma     a locale whose numbers have a comma */
#include <fenv.h>
#include <locale.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

enum { NO_SUCH_MODE = 125 };

static int set(const char *mode) {
    if (strcmp(mode, "traps") == 0) {
        return feenableexcept(FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW) != -1;
    }
    if (strcmp(mode, "upward") == 0) {
        return fesetround(FE_UPWARD) == 0;
    }
#if defined(__x86_64__)
    if (strcmp(mode, "ftz") == 0) {
        _mm_setcsr(_mm_getcsr() | 0x8040);
        return 1;
    }
#endif
    return strcmp(mode, "comma") == 0 && setlocale(LC_ALL, "de_DE.UTF-8");
}

__attribute__((constructor)) static void begin(void) {
    const char *mode = getenv("SPAR_TORTURE_MODE");
    if (mode && !set(mode)) {
        (void)fprintf(stderr, "this system has no mode '%s'\n", mode);
        exit(NO_SUCH_MODE);
    }
}
