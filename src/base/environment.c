/* Saves, replaces and restores the host's floating-point traps, rounding mode, locale and GSL error handler. */
#include "environment.h"

#include <pthread.h>
#ifdef SPARI_MXCSR
#include <xmmintrin.h>
#endif

static _Thread_local spari_host host;

static locale_t c_locale;

static void make_locale(void) {
    c_locale = newlocale(LC_ALL_MASK, "C", (locale_t)0);
}

#ifdef SPARI_MXCSR
/* Intel 64 and IA-32 Architectures Software Developer's Manual, volume 1, 8.1.3, 8.1.5, 10.2.3. */
enum { FLAGS = 0x3f, SSE_MASKED = 0x1f80, SSE_ROUNDING = 0x6000, X87_MASKED = 0x3f, X87_ROUNDING = 0x0c00 };

static uint16_t x87_status(void) {
    uint16_t status;
    __asm__ volatile("fnstsw %0" : "=m"(status));
    return status;
}

static uint32_t guarded_sse(uint32_t sse) {
    return (sse & ~(uint32_t)SSE_ROUNDING) | SSE_MASKED;
}

static uint16_t guarded_x87(uint16_t control) {
    return (uint16_t)((control & ~X87_ROUNDING) | X87_MASKED);
}

static void load_x87_control(uint16_t control) {
    __asm__ volatile("fldcw %0" : : "m"(control));
}

static void hold_environment(spari_environment *e) {
    e->sse = _mm_getcsr();
    e->status = x87_status();
    __asm__ volatile("fnstcw %0" : "=m"(e->control));
    if (guarded_sse(e->sse) != e->sse) {
        _mm_setcsr(guarded_sse(e->sse));
    }
    if (guarded_x87(e->control) != e->control) {
        load_x87_control(guarded_x87(e->control));
    }
}

static void give_environment_back(const spari_environment *e) {
    if ((x87_status() ^ e->status) & FLAGS) { /* before a host's trap is enabled again, which would see these flags */
        fenv_t all;
        (void)fegetenv(&all);
        all.__status_word = (uint16_t)((all.__status_word & ~FLAGS) | (e->status & FLAGS));
        (void)fesetenv(&all);
    }
    if (guarded_x87(e->control) != e->control) {
        load_x87_control(e->control);
    }
    if (_mm_getcsr() != e->sse) {
        _mm_setcsr(e->sse);
    }
}
#else
static void hold_environment(spari_environment *e) {
    (void)feholdexcept(e);
    if (fegetround() != FE_TONEAREST) {
        (void)fesetround(FE_TONEAREST);
    }
}

static void give_environment_back(const spari_environment *e) {
    (void)fesetenv(e);
}
#endif

static void hold(void) {
    static pthread_once_t once = PTHREAD_ONCE_INIT;
    hold_environment(&host.environment);
    pthread_once(&once, make_locale);
    host.locale = uselocale(c_locale); /* without one: it stays */
}

static void give_back(void) {
    (void)uselocale(host.locale);
    give_environment_back(&host.environment);
}

void spari_environment_begin(void) {
    if (host.depth++ == 0) {
        hold();
    }
}

void spari_environment_end(void) {
    if (--host.depth == 0) {
        give_back();
    }
}

void spari_host_begin(spari_host *inside) {
    *inside = host;
    host.depth = 0;
    if (inside->depth > 0) {
        give_back();
    }
}

void spari_host_end(const spari_host *inside) {
    if (inside->depth > 0) { /* changes made by the host are kept */
        hold();
    }
    host.depth = inside->depth;
}
